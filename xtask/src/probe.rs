//! Looks at the machine: what the build and the program need, and what we may do about it.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::packages::{Machine, Manager, Need, Rights};

/// What this machine lacks, for tests too or without them, and who could help. Linux only: elsewhere nothing is needed.
pub fn machine(for_tests: bool) -> Machine {
    let missing = missing(for_tests);
    if missing.is_empty() {
        return Machine { missing, manager: None, rights: Rights::None };
    }
    Machine { missing, manager: manager(), rights: rights() }
}

/// What is needed and not there.
fn missing(for_tests: bool) -> Vec<Need> {
    if !cfg!(target_os = "linux") {
        return Vec::new();
    }
    let pkg_config = pkg_config();
    let libraries = Libraries::look();
    let needs = Need::ALL.into_iter().filter(|need| for_tests || !need.is_for_tests());
    needs.filter(|&need| !is_there(need, pkg_config.as_ref(), &libraries)).collect()
}

/// What windows under X11 load.
const X11: [&str; 5] = ["libX11.so.6", "libX11-xcb.so.1", "libXcursor.so.1", "libXi.so.6", "libXrandr.so.2"];

fn is_there(need: Need, pkg_config: Option<&OsString>, libraries: &Libraries) -> bool {
    // Without pkg-config no build script finds its headers, whether they are there or not.
    let headers = |module: &str| pkg_config.is_some_and(|program| quietly(program, &["--exists", module]));
    match need {
        Need::PkgConfig => pkg_config.is_some(),
        Need::Udev => headers("libudev"),
        Need::Alsa => headers("alsa"),
        Need::Wayland => headers("wayland-client"),
        Need::Xkbcommon => headers("xkbcommon"),
        Need::XkbcommonX11 => libraries.have("libxkbcommon-x11.so.0"),
        Need::X11 => !is_set("DISPLAY") || X11.iter().all(|name| libraries.have(name)),
        Need::VulkanLoader => libraries.have("libvulkan.so.1"),
        Need::VulkanDriver => is_set("VK_ICD_FILENAMES") || is_set("VK_DRIVER_FILES") || has_driver(&driver_dirs()),
        // As the build script finds it.
        Need::Cxx => is_set("CXX") || quietly("c++", &["--version"]),
        Need::TestDisplay => {
            ["Xvfb", "xdotool"].iter().all(|program| in_path(program)) && X11.iter().all(|name| libraries.have(name))
        }
    }
}

fn is_set(name: &str) -> bool {
    std::env::var_os(name).is_some_and(|value| !value.is_empty())
}

/// The program that build scripts will ask.
fn pkg_config() -> Option<OsString> {
    let named = std::env::var_os("PKG_CONFIG").filter(|name| !name.is_empty());
    let names = named.into_iter().chain(["pkg-config".into(), "pkgconf".into()]);
    names.into_iter().find(|name| quietly(name, &["--version"]))
}

/// Whether there is a program of a name.
fn in_path(program: &str) -> bool {
    std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default()).any(|dir| dir.join(program).is_file())
}

/// Whether a program starts and ends well.
fn quietly(program: impl AsRef<std::ffi::OsStr>, args: &[&str]) -> bool {
    let mut command = Command::new(program);
    command.args(args).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

/// Shared libraries that the dynamic linker finds.
struct Libraries {
    cached: String,
    dirs: Vec<PathBuf>,
}

impl Libraries {
    fn look() -> Self {
        // People who are not root do not have ldconfig's directory in their path.
        let cached = ["ldconfig", "/sbin/ldconfig", "/usr/sbin/ldconfig"].iter().find_map(|program| {
            let output = Command::new(program).arg("-p").stderr(Stdio::null()).output().ok()?;
            output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
        });
        let path = std::env::var_os("LD_LIBRARY_PATH").unwrap_or_default();
        let arch = std::env::consts::ARCH;
        let usual = ["/usr/lib", "/usr/lib64", "/lib", "/lib64", "/usr/local/lib"].map(PathBuf::from);
        let multiarch = PathBuf::from(format!("/usr/lib/{arch}-linux-gnu"));
        let dirs = std::env::split_paths(&path).filter(|p| !p.as_os_str().is_empty()).chain(usual).chain([multiarch]).collect();
        Self { cached: cached.unwrap_or_default(), dirs }
    }

    fn have(&self, name: &str) -> bool {
        in_cache(&self.cached, name) || self.dirs.iter().any(|dir| dir.join(name).exists())
    }
}

/// Whether a listing of `ldconfig -p` names a library.
fn in_cache(listing: &str, name: &str) -> bool {
    listing.lines().any(|line| line.split_whitespace().next() == Some(name))
}

/// Where Vulkan's loader looks for drivers.
fn driver_dirs() -> Vec<PathBuf> {
    let mut bases = ["/usr/share", "/usr/local/share", "/etc", "/usr/local/etc"].map(PathBuf::from).to_vec();
    for name in ["XDG_DATA_DIRS", "XDG_CONFIG_DIRS", "XDG_DATA_HOME"] {
        bases.extend(std::env::split_paths(&std::env::var_os(name).unwrap_or_default()).filter(|p| p.is_absolute()));
    }
    bases.extend(std::env::var_os("HOME").map(|home| Path::new(&home).join(".local/share")));
    bases.into_iter().map(|base| base.join("vulkan/icd.d")).collect()
}

/// Whether one of these directories describes a driver.
fn has_driver(dirs: &[PathBuf]) -> bool {
    let is_json = |path: PathBuf| path.extension().is_some_and(|ending| ending == "json");
    dirs.iter().filter_map(|dir| std::fs::read_dir(dir).ok()).flatten().flatten().any(|entry| is_json(entry.path()))
}

fn manager() -> Option<Manager> {
    let known = [("apt-get", Manager::Apt), ("dnf", Manager::Dnf), ("pacman", Manager::Pacman)];
    known.into_iter().find(|(program, _)| quietly(program, &["--version"])).map(|(_, manager)| manager)
}

fn rights() -> Rights {
    let id = Command::new("id").arg("-u").output();
    if id.is_ok_and(|output| output.stdout.trim_ascii() == b"0") {
        Rights::Root
    } else if quietly("sudo", &["-n", "true"]) {
        Rights::Sudo
    } else {
        Rights::None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_linkers_listing_is_read_by_whole_names() {
        let listing =
            "2 libs found in cache\n\tlibvulkan.so.1 (libc6,x86-64) => /lib/libvulkan.so.1\n\tlibX11.so.6.4 (libc6) => /x\n";
        assert!(in_cache(listing, "libvulkan.so.1"));
        assert!(!in_cache(listing, "libvulkan.so"), "a development link alone does not run programs");
        assert!(!in_cache(listing, "libX11.so.6") && !in_cache("", "libvulkan.so.1"));
    }

    #[test]
    fn a_driver_is_a_json_file_in_one_of_the_directories() {
        let base = std::env::temp_dir().join(format!("veduta-xtask-drivers-{}", std::process::id()));
        let (empty, full) = (base.join("empty"), base.join("full"));
        std::fs::create_dir_all(&empty).expect("the temporary directory can be written");
        std::fs::create_dir_all(&full).expect("the temporary directory can be written");
        std::fs::write(full.join("README"), "").expect("the temporary directory can be written");
        let dirs = [base.join("missing"), empty, full.clone()];
        assert!(!has_driver(&dirs));
        std::fs::write(full.join("lvp_icd.json"), "{}").expect("the temporary directory can be written");
        assert!(has_driver(&dirs));
        std::fs::remove_dir_all(&base).expect("it was made above");
    }

    #[test]
    fn without_pkg_config_headers_count_as_missing() {
        let nothing = Libraries { cached: String::new(), dirs: Vec::new() };
        for need in [Need::PkgConfig, Need::Udev, Need::Wayland, Need::Xkbcommon, Need::XkbcommonX11, Need::VulkanLoader] {
            assert!(!is_there(need, None, &nothing), "{need:?}");
        }
        let loader = Libraries { cached: "\tlibvulkan.so.1 (libc6) => /x".to_owned(), dirs: Vec::new() };
        assert!(is_there(Need::VulkanLoader, None, &loader));
    }
}
