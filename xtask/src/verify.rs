//! `cargo verify`: every check, one after another, up to the first that fails.

use std::process::{Command, Stdio};
use std::time::Instant;

use crate::{cargo, run, setup, wasm};

/// The crates that need no engine: their tests are built in seconds.
pub const CORE: [&str; 12] = [
    "veduta-city",
    "veduta-survey",
    "veduta-growth",
    "veduta-texture",
    "veduta-cells",
    "veduta-route",
    "veduta-synth",
    "veduta-cartography",
    "veduta-store",
    "veduta-bake",
    "veduta-digests",
    "xtask",
];

/// The crates that need the engine. They are checked apart from the core: the core's test libraries turn on features of
/// small crates under the engine, and together with them the engine would be built a second time for `cargo play`.
pub const ENGINE: [&str; 16] = [
    "veduta-ecs",
    "veduta-ui",
    "veduta-controls",
    "veduta-streaming",
    "veduta-buildings",
    "veduta-facade",
    "veduta-tour",
    "veduta-minimap",
    "veduta-guide",
    "veduta-walker",
    "veduta-sky",
    "veduta-sound",
    "veduta-life",
    "veduta",
    "veduta-game",
    "veduta-tests",
];

/// One check.
struct Check {
    /// Arguments for cargo.
    args: Vec<&'static str>,
    /// Variables set for it.
    env: &'static [(&'static str, &'static str)],
    /// What it needs that a machine may lack.
    tool: Option<Tool>,
}

/// A subcommand of cargo that is installed apart from it.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Tool {
    /// A component of the toolchain, by rustup's name; set-up adds it where rustup is there.
    Component { subcommand: &'static str, name: &'static str },
    /// A program of its own: used where it is installed.
    Own { subcommand: &'static str },
}

impl Check {
    fn new(args: &[&'static str]) -> Self {
        Self { args: args.to_vec(), env: &[], tool: None }
    }

    /// A subcommand over some packages, with what follows them.
    fn of(subcommand: &'static str, packages: &[&'static str], rest: &[&'static str]) -> Self {
        let packages = packages.iter().flat_map(|&name| ["--package", name]);
        Self::new(&[subcommand].into_iter().chain(packages).chain(rest.iter().copied()).collect::<Vec<_>>())
    }

    fn with(self, tool: Tool) -> Self {
        Self { tool: Some(tool), ..self }
    }

    fn title(&self) -> String {
        let env = self.env.iter().map(|(name, value)| format!("{name}=\"{value}\" ")).collect::<String>();
        format!("{env}cargo {}", self.args.join(" "))
    }
}

fn checks() -> Vec<Check> {
    let rustfmt = Tool::Component { subcommand: "fmt", name: "rustfmt" };
    let clippy = Tool::Component { subcommand: "clippy", name: "clippy" };
    let doc = |packages| Check { env: &[("RUSTDOCFLAGS", "-D warnings")], ..Check::of("doc", packages, &["--no-deps"]) };
    vec![
        Check::new(&["fmt", "--all", "--check"]).with(rustfmt),
        Check::of("clippy", &CORE, &["--all-targets", "--", "-D", "warnings"]).with(clippy),
        Check::of("clippy", &ENGINE, &["--all-targets", "--", "-D", "warnings"]).with(clippy),
        Check::of("test", &CORE, &[]),
        // What a visit needs is there by now: it is made, not left out.
        Check { env: &[("VEDUTA_VISIT", "1")], ..Check::of("test", &ENGINE, &[]) },
        doc(&CORE),
        doc(&ENGINE),
        Check::new(&["deny", "--all-features", "check", "licenses", "bans", "sources"]).with(Tool::Own { subcommand: "deny" }),
    ]
}

/// Runs every check; the exit code of the first that fails, else 0.
pub fn everything() -> u8 {
    match setup::prepare(true) {
        Ok(()) => match in_order(&checks()) {
            0 => wasm(false),
            code => code,
        },
        Err(code) => code,
    }
}

/// Runs the tests of the crates that need no engine, and no set-up.
pub fn core() -> u8 {
    in_order(&[Check::of("test", &CORE, &[])])
}

/// Compares plans grown here with plans grown on wasm32. Where there is no toolchain for it, that is a failure only if it was asked for.
pub fn wasm(is_asked: bool) -> u8 {
    eprintln!("verify: plans on wasm32");
    if let Some(reason) = wasm::lacks() {
        eprintln!("verify: {}, {reason}", if is_asked { "FAILED" } else { "skipped" });
        return u8::from(is_asked);
    }
    match wasm::compare() {
        Ok(()) => 0,
        Err(told) => {
            eprintln!("verify: FAILED: {told}");
            1
        }
    }
}

fn in_order(checks: &[Check]) -> u8 {
    let began = Instant::now();
    let mut skipped = Vec::new();
    for (i, check) in checks.iter().enumerate() {
        eprintln!("verify {}/{}: {}", i + 1, checks.len(), check.title());
        if let Some(reason) = check.tool.and_then(lacks) {
            eprintln!("verify: skipped, {reason}");
            skipped.push(reason);
            continue;
        }
        let started = Instant::now();
        let mut command = cargo();
        command.args(&check.args).envs(check.env.iter().copied());
        let code = run(command);
        if code != 0 {
            eprintln!("verify: FAILED ({code}): {}", check.title());
            return code;
        }
        eprintln!("verify: passed in {:.0} s", started.elapsed().as_secs_f64());
    }
    eprintln!("verify: all passed in {:.0} s", began.elapsed().as_secs_f64());
    for reason in skipped {
        eprintln!("verify: but skipped: {reason}");
    }
    0
}

/// Why a tool cannot be used here; `None` if it can. Missing components of the toolchain are added first.
fn lacks(tool: Tool) -> Option<String> {
    match tool {
        Tool::Own { subcommand } if is_there(subcommand) => {
            eprintln!("verify: advisories need the network and are left to `cargo {subcommand} check advisories`");
            None
        }
        Tool::Own { subcommand } => {
            Some(format!("cargo-{subcommand} is not installed: licences, sources and advisories are not checked"))
        }
        Tool::Component { subcommand, name } => {
            if !is_there(subcommand) {
                eprintln!("verify: rustup component add {name}");
                let mut rustup = Command::new("rustup");
                rustup.args(["component", "add", name]);
                run(rustup);
            }
            (!is_there(subcommand)).then(|| format!("{name} is not installed and rustup cannot add it"))
        }
    }
}

fn is_there(subcommand: &str) -> bool {
    let mut command = cargo();
    command.args([subcommand, "--version"]).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_crate_is_checked_in_every_way() {
        // Tests run in their package's folder; a path from build time may be that of another clone with the same target directory.
        let root = std::path::Path::new("..");
        let mut crates = ["veduta-game", "veduta-tests", "veduta-digests", "xtask"].map(str::to_owned).to_vec();
        for entry in std::fs::read_dir(root.join("plugins")).expect("the project's plugins") {
            let name = entry.expect("a folder").file_name().into_string().expect("plain names");
            crates.push(if name == "veduta" { name } else { format!("veduta-{name}") });
        }
        for subcommand in ["clippy", "test", "doc"] {
            let mut checked: Vec<String> = checks()
                .iter()
                .filter(|check| check.args[0] == subcommand)
                .flat_map(|check| check.args.windows(2).filter(|w| w[0] == "--package").map(|w| w[1].to_owned()))
                .collect();
            checked.sort();
            crates.sort();
            assert_eq!(checked, crates, "by cargo {subcommand}");
        }
    }

    #[test]
    fn the_tests_themselves_are_never_skipped() {
        assert!(checks().iter().filter(|check| check.args[0] == "test").all(|check| check.tool.is_none()));
    }

    #[test]
    fn checks_stop_at_the_first_failure_with_its_code() {
        let fails = Check::new(&["no-such-subcommand-of-cargo"]);
        let never = Check::new(&["--version"]);
        assert_eq!(in_order(&[fails, never]), 101);
        assert_eq!(in_order(&[Check::new(&["--version"])]), 0);
    }

    #[test]
    fn a_tool_that_is_not_installed_is_told_and_left_out() {
        let tool = Tool::Own { subcommand: "no-such-subcommand-of-cargo" };
        assert!(lacks(tool).is_some_and(|reason| reason.contains("not installed")));
        assert_eq!(in_order(&[Check::new(&["no-such-subcommand-of-cargo"]).with(tool)]), 0);
    }
}
