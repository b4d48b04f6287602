//! Set-up: looks, decides, installs or asks.

use std::process::Command;

use crate::packages::{Decision, Line, Need, decide, one_line};
use crate::{probe, run};

/// Makes sure that the system has what the build and the program need, and tests where they are to be run.
///
/// # Errors
/// The exit code to end with, if something is missing that we may not or could not install; the person has been told.
pub fn prepare(for_tests: bool) -> Result<(), u8> {
    if std::env::var_os("VEDUTA_SKIP_SETUP").is_some_and(|value| value == "1") {
        return Ok(());
    }
    match decide(&probe::machine(for_tests)) {
        Decision::Ready => Ok(()),
        Decision::Install(lines) => install(&lines, for_tests),
        Decision::Ask(line) => {
            eprintln!("System packages are missing. Run this, then try again:");
            println!("{line}");
            Err(1)
        }
        Decision::Name(missing) => {
            eprintln!("Install with your system's package manager, then try again: {}", names(&missing));
            Err(1)
        }
    }
}

fn install(lines: &[Line], for_tests: bool) -> Result<(), u8> {
    eprintln!("xtask: installing system packages");
    for line in lines {
        eprintln!("xtask: {line}");
        let Some((program, args)) = line.words.split_first() else { continue };
        let mut command = Command::new(program);
        command.args(args);
        if run(command) != 0 && !line.may_fail {
            eprintln!("That failed. When it is mended, this does it by hand:");
            println!("{}", one_line(lines.to_vec()));
            return Err(1);
        }
    }
    let still = probe::machine(for_tests).missing;
    if still.is_empty() {
        return Ok(());
    }
    eprintln!("The packages are installed, and these are still not found: {}", names(&still));
    Err(1)
}

fn names(needs: &[Need]) -> String {
    needs.iter().map(|need| need.name()).collect::<Vec<_>>().join("; ")
}
