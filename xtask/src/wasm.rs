//! `cargo verify wasm`: plans are the same bytes on wasm32 as on this machine.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use crate::cargo;

const TARGET: &str = "wasm32-unknown-unknown";
const PACKAGE: &str = "veduta-digests";
/// Prints what the exported function says of each town, as the program does.
const RUN: &str = "WebAssembly.instantiate(require('fs').readFileSync(process.argv[1])).then(({ instance }) => { \
    for (let i = 0, d; (d = instance.exports.plan_digest(i)) !== 0n; i++) \
    console.log(BigInt.asUintN(64, d).toString(16).padStart(16, '0')) })";
/// Optimised lightly, without debug information: it runs once.
const PROFILE: [&str; 4] = ["--config", "profile.dev.opt-level=1", "--config", "profile.dev.debug=false"];

/// A toolchain that builds for the web.
enum Toolchain {
    /// rustup's, with the target added.
    Rustup,
    /// A distribution's compiler, which builds the standard library from its own sources.
    FromSource { rustc: PathBuf, linker: String },
}

/// Why it cannot be checked here; `None` if it can.
pub fn lacks() -> Option<String> {
    if !succeeds(Command::new("node").arg("--version")) {
        return Some("node is not installed: plans on wasm32 are not compared".to_owned());
    }
    toolchain().is_none().then(|| {
        format!(
            "no toolchain for wasm32 (`rustup target add {TARGET}`; on Debian `apt-get install rustc-web rust-web-src lld-22`): \
             plans on wasm32 are not compared"
        )
    })
}

/// Grows the project's towns here and on wasm32, and compares the plans.
///
/// # Errors
/// What failed, or which towns differ.
pub fn compare() -> Result<(), String> {
    let toolchain = toolchain().ok_or("no toolchain for wasm32")?;
    let mut native = cargo();
    native.args(["run", "--quiet", "--package", PACKAGE]);
    let native = output(native)?;
    let mut build = cargo();
    build.args(["build", "--package", PACKAGE, "--target", TARGET]).args(PROFILE);
    if let Toolchain::FromSource { rustc, linker } = toolchain {
        build.arg("-Zbuild-std=std,panic_abort").env("RUSTC", rustc).env("RUSTC_BOOTSTRAP", "1");
        build.env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", linker);
    }
    if crate::run(build) != 0 {
        return Err(format!("{PACKAGE} does not build for {TARGET}"));
    }
    let mut node = Command::new("node");
    node.args(["-e", RUN]).arg(target_dir()?.join(TARGET).join("debug").join(format!("{PACKAGE}.wasm")));
    same(&native, &output(node)?)
}

/// Whether two lists of digests are equal, and not empty.
fn same(native: &str, wasm: &str) -> Result<(), String> {
    if native.lines().count() == 0 {
        return Err("no towns were grown".to_owned());
    }
    if native == wasm {
        eprintln!("verify: {} plans are the same bytes here and on wasm32", native.lines().count());
        return Ok(());
    }
    Err(format!("plans differ; digests here:\n{native}on wasm32:\n{wasm}"))
}

fn toolchain() -> Option<Toolchain> {
    let installed = Command::new("rustup").args(["target", "list", "--installed"]).output();
    if installed.is_ok_and(|list| String::from_utf8_lossy(&list.stdout).lines().any(|line| line == TARGET)) {
        return Some(Toolchain::Rustup);
    }
    let rustc = PathBuf::from("/usr/bin/rustc");
    let sysroot = Command::new(&rustc).args(["--print", "sysroot"]).output().ok()?;
    let sysroot = PathBuf::from(String::from_utf8_lossy(&sysroot.stdout).trim());
    let has_source = sysroot.join("lib/rustlib/src/rust/library/Cargo.lock").exists();
    let names = ["wasm-ld".to_owned()].into_iter().chain((14..30).rev().map(|version| format!("wasm-ld-{version}")));
    let linker = names.into_iter().find(|linker| succeeds(Command::new(linker).arg("--version")))?;
    has_source.then_some(Toolchain::FromSource { rustc, linker })
}

/// The directory that cargo builds into.
fn target_dir() -> Result<PathBuf, String> {
    let mut command = cargo();
    command.args(["metadata", "--no-deps", "--format-version", "1"]);
    let metadata = output(command)?;
    let (_, rest) = metadata.split_once("\"target_directory\":\"").ok_or("cargo names no target directory")?;
    let path = rest.split('"').next().unwrap_or_default();
    Ok(PathBuf::from(path.replace("\\\\", "\\")))
}

fn succeeds(command: &mut Command) -> bool {
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
}

/// What a program prints.
fn output(mut command: Command) -> Result<String, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command.stderr(Stdio::inherit()).output().map_err(|error| format!("{name}: {error}"))?;
    if !output.status.success() {
        return Err(format!("{name} failed: {}", output.status));
    }
    String::from_utf8(output.stdout).map_err(|error| format!("{name}: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_equal_digests_of_some_town_pass() {
        assert!(same("1\n2\n", "1\n2\n").is_ok());
        assert!(same("1\n2\n", "1\n3\n").is_err_and(|told| told.contains("differ")));
        assert!(same("1\n2\n", "1\n").is_err() && same("", "").is_err());
    }

    #[test]
    fn cargo_names_its_target_directory() {
        assert!(target_dir().is_ok_and(|dir| dir.is_absolute()));
    }
}
