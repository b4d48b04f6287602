//! `cargo verify`: every check, one after another, up to the first that fails.

use std::process::{Command, Stdio};
use std::time::Instant;

use crate::{cargo, run, setup};

/// The crates that need no engine: their tests are built in seconds.
pub const CORE: [&str; 9] = [
    "veduta-city",
    "veduta-survey",
    "veduta-growth",
    "veduta-texture",
    "veduta-cells",
    "veduta-route",
    "veduta-store",
    "veduta-bake",
    "xtask",
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
    let doc = Check::new(&["doc", "--workspace", "--no-deps"]);
    vec![
        Check::new(&["fmt", "--all", "--check"]).with(rustfmt),
        Check::new(&["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]).with(clippy),
        Check::new(&["test", "--workspace"]),
        Check { env: &[("RUSTDOCFLAGS", "-D warnings")], ..doc },
        Check::new(&["deny", "--all-features", "check", "licenses", "bans", "sources"]).with(Tool::Own { subcommand: "deny" }),
    ]
}

/// Runs every check; the exit code of the first that fails, else 0.
pub fn everything() -> u8 {
    match setup::prepare() {
        Ok(()) => in_order(&checks()),
        Err(code) => code,
    }
}

/// Runs the tests of the crates that need no engine, and no set-up.
pub fn core() -> u8 {
    let packages = CORE.iter().flat_map(|&name| ["--package", name]);
    in_order(&[Check::new(&["test"].into_iter().chain(packages).collect::<Vec<_>>())])
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
    fn the_checks_are_those_that_the_readme_promises() {
        let titles: Vec<String> = checks().iter().map(Check::title).collect();
        assert_eq!(
            titles,
            [
                "cargo fmt --all --check",
                "cargo clippy --workspace --all-targets -- -D warnings",
                "cargo test --workspace",
                "RUSTDOCFLAGS=\"-D warnings\" cargo doc --workspace --no-deps",
                "cargo deny --all-features check licenses bans sources",
            ]
        );
    }

    #[test]
    fn the_tests_themselves_are_never_skipped() {
        let tests = checks().into_iter().find(|check| check.args[0] == "test").expect("it is in the list");
        assert!(tests.tool.is_none());
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
