//! The project's own commands: `cargo play` and `cargo verify`.
//!
//! ```text
//!  cargo play [ARGS…]    set-up ─► cargo run -p veduta-game -- ARGS…
//!  cargo verify [core]   set-up ─► fmt ─► clippy ─► test ─► doc ─► deny ─► wasm
//!
//!  set-up: probe (what is there) ─► packages::decide (pure) ─► install, or one line to run
//! ```
//!
//! Standard library only, so that it is built in a second on a machine that has nothing yet.
//!
//! # Limits
//! Set-up knows apt, dnf and pacman; elsewhere it names what is missing and stops. `VEDUTA_SKIP_SETUP=1` leaves it out.
//!
//! # Rejected
//! A shell script (Windows has none), a container (no display, no graphics card), and a makefile (one more thing to install).

mod packages;
mod probe;
mod setup;
mod verify;
mod wasm;

use std::process::{Command, ExitCode};

const USAGE: &str = "\
usage: cargo play [ARGS…]     walk through the sample city; without a display, film the sample tour
                              (ARGS go to the `veduta` program: cargo play --help)
       cargo verify           formatting, lints, all tests, documentation, licences
       cargo verify core      only the tests of the crates that need no engine; seconds
       cargo verify wasm      only whether plans are the same bytes on wasm32";

/// Exit code of wrong usage.
const WRONG_USAGE: u8 = 2;

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let code = match args.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["play", rest @ ..] => play(rest),
        ["verify"] => verify::everything(),
        ["verify", "core"] => verify::core(),
        ["verify", "wasm"] => verify::wasm(true),
        ["verify", "--help" | "-h"] | ["--help" | "-h"] => {
            println!("{USAGE}");
            0
        }
        _ => {
            eprintln!("{USAGE}");
            WRONG_USAGE
        }
    };
    ExitCode::from(code)
}

/// Runs the game with these arguments.
fn play(args: &[&str]) -> u8 {
    if let Err(code) = setup::prepare(false) {
        return code;
    }
    let mut command = cargo();
    command.args(["run", "--package", "veduta-game", "--"]).args(args);
    run(command)
}

/// The cargo that runs this program, without what it tells this program of its package: build scripts of others would be run again for it.
fn cargo() -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    let names = std::env::vars_os().filter_map(|(name, _)| name.into_string().ok());
    for name in names.filter(|name| name.starts_with("CARGO_PKG_") || name.starts_with("CARGO_MANIFEST_")) {
        command.env_remove(name);
    }
    command
}

/// Runs a command to its end and gives its exit code; 1 if it could not be started or was killed.
fn run(mut command: Command) -> u8 {
    match command.status() {
        Ok(status) => status.code().map_or(1, |code| u8::try_from(code).unwrap_or(1)),
        Err(error) => {
            eprintln!("{}: {error}", command.get_program().to_string_lossy());
            1
        }
    }
}
