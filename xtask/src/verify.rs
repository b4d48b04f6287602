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

    /// With these arguments, too.
    fn and(mut self, args: &[&'static str]) -> Self {
        self.args.extend(args);
        self
    }

    fn under(self, env: &'static [(&'static str, &'static str)]) -> Self {
        Self { env, ..self }
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
    // All but this program in one selection, so that every crate is built once and as `cargo play` builds it, and this one
    // apart: what reads the manifests in its tests would turn on features of small crates under the engine.
    let all = |subcommand| Check::new(&[subcommand, "--workspace", "--exclude", "xtask"]);
    let own = |subcommand| Check::new(&[subcommand, "--package", "xtask"]);
    let mut checks = vec![Check::new(&["fmt", "--all", "--check"]).with(rustfmt)];
    let lints = ["--all-targets", "--", "-D", "warnings"];
    checks.extend([own("clippy"), all("clippy")].map(|check| check.and(&lints).with(clippy)));
    // What a visit needs is there by now: it is made, not left out.
    checks.extend([own("test"), all("test").under(&[("VEDUTA_VISIT", "1")])]);
    checks.extend([own("doc"), all("doc")].map(|check| check.and(&["--no-deps"]).under(&[("RUSTDOCFLAGS", "-D warnings")])));
    checks.push(
        Check::new(&["deny", "--all-features", "check", "licenses", "bans", "sources"]).with(Tool::Own { subcommand: "deny" }),
    );
    checks
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
    let packages: Vec<_> = CORE.iter().flat_map(|&name| ["--package", name]).collect();
    in_order(&[Check::new(&["test"]).and(&packages)])
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
