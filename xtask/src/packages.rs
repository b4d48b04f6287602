//! Which system packages to install and how: pure decisions, apart from looking and doing.

use std::fmt;

/// Something of the system that the build or the program needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Need {
    /// Finds the headers for build scripts.
    PkgConfig,
    /// libudev's headers: gamepads.
    Udev,
    /// ALSA's headers: sound.
    Alsa,
    /// libwayland's headers: windows.
    Wayland,
    /// libxkbcommon's headers: keyboards.
    Xkbcommon,
    /// Keyboards under X11, loaded when a window opens.
    XkbcommonX11,
    /// Windows under X11, loaded when a window opens; needed only where there is an X display.
    X11,
    /// The Vulkan loader.
    VulkanLoader,
    /// A Vulkan driver: the graphics card's, else Mesa's.
    VulkanDriver,
    /// A C++ compiler: tests build FLIP, which measures what is seen of a difference. Nothing else needs one.
    Cxx,
    /// A display that is none, and hands for it: a test visits the city in a real window.
    TestDisplay,
}

impl Need {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::PkgConfig,
        Self::Udev,
        Self::Alsa,
        Self::Wayland,
        Self::Xkbcommon,
        Self::XkbcommonX11,
        Self::X11,
        Self::VulkanLoader,
        Self::VulkanDriver,
        Self::Cxx,
        Self::TestDisplay,
    ];

    /// Whether only tests need it.
    pub const fn is_for_tests(self) -> bool {
        matches!(self, Self::Cxx | Self::TestDisplay)
    }

    /// What to tell people who must find the package themselves.
    pub const fn name(self) -> &'static str {
        match self {
            Self::PkgConfig => "pkg-config",
            Self::Udev => "libudev with headers",
            Self::Alsa => "ALSA with headers",
            Self::Wayland => "wayland-client with headers",
            Self::Xkbcommon => "libxkbcommon with headers",
            Self::XkbcommonX11 => "libxkbcommon-x11",
            Self::X11 => "libX11, libX11-xcb, libXcursor, libXi, libXrandr",
            Self::VulkanLoader => "the Vulkan loader (libvulkan.so.1)",
            Self::VulkanDriver => "a Vulkan driver (Mesa's software driver will do)",
            Self::Cxx => "a C++ compiler",
            Self::TestDisplay => "Xvfb, xdotool, libX11, libX11-xcb, libXcursor, libXi, libXrandr",
        }
    }
}

/// A package manager that we know.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Manager {
    /// Debian, Ubuntu and their kin.
    Apt,
    /// Fedora and its kin.
    Dnf,
    /// Arch and its kin.
    Pacman,
}

impl Manager {
    /// The packages that satisfy a need.
    pub const fn packages(self, need: Need) -> &'static [&'static str] {
        match (self, need) {
            (Self::Apt, Need::PkgConfig) => &["pkg-config"],
            (Self::Apt, Need::Udev) => &["libudev-dev"],
            (Self::Apt, Need::Alsa) => &["libasound2-dev"],
            (Self::Apt, Need::Wayland) => &["libwayland-dev"],
            (Self::Apt, Need::Xkbcommon) => &["libxkbcommon-dev"],
            (Self::Apt, Need::XkbcommonX11) => &["libxkbcommon-x11-0"],
            (Self::Apt, Need::X11) => &["libx11-6", "libx11-xcb1", "libxcursor1", "libxi6", "libxrandr2"],
            (Self::Apt, Need::VulkanLoader) => &["libvulkan1"],
            (Self::Apt, Need::VulkanDriver) => &["mesa-vulkan-drivers"],
            (Self::Apt, Need::Cxx) => &["g++"],
            (Self::Apt, Need::TestDisplay) => {
                &["xvfb", "xdotool", "libx11-6", "libx11-xcb1", "libxcursor1", "libxi6", "libxrandr2"]
            }
            (Self::Dnf, Need::PkgConfig) => &["pkgconf-pkg-config"],
            (Self::Dnf, Need::Udev) => &["systemd-devel"],
            (Self::Dnf, Need::Alsa) => &["alsa-lib-devel"],
            (Self::Dnf, Need::Wayland) => &["wayland-devel"],
            (Self::Dnf, Need::Xkbcommon) => &["libxkbcommon-devel"],
            (Self::Dnf, Need::XkbcommonX11) => &["libxkbcommon-x11"],
            (Self::Dnf, Need::X11) => &["libX11", "libX11-xcb", "libXcursor", "libXi", "libXrandr"],
            (Self::Dnf, Need::VulkanLoader) => &["vulkan-loader"],
            (Self::Dnf, Need::VulkanDriver) => &["mesa-vulkan-drivers"],
            (Self::Dnf, Need::Cxx) => &["gcc-c++"],
            (Self::Dnf, Need::TestDisplay) => {
                &["xorg-x11-server-Xvfb", "xdotool", "libX11", "libX11-xcb", "libXcursor", "libXi", "libXrandr"]
            }
            (Self::Pacman, Need::PkgConfig) => &["pkgconf"],
            (Self::Pacman, Need::Udev) => &["systemd-libs"],
            (Self::Pacman, Need::Alsa) => &["alsa-lib"],
            (Self::Pacman, Need::Wayland) => &["wayland"],
            (Self::Pacman, Need::Xkbcommon) => &["libxkbcommon"],
            (Self::Pacman, Need::XkbcommonX11) => &["libxkbcommon-x11"],
            (Self::Pacman, Need::X11) => &["libx11", "libxcursor", "libxi", "libxrandr"],
            (Self::Pacman, Need::VulkanLoader) => &["vulkan-icd-loader"],
            (Self::Pacman, Need::VulkanDriver) => &["vulkan-swrast"],
            (Self::Pacman, Need::Cxx) => &["gcc"],
            (Self::Pacman, Need::TestDisplay) => &["xorg-server-xvfb", "xdotool", "libx11", "libxcursor", "libxi", "libxrandr"],
        }
    }

    /// The commands that install packages, without rights asked for.
    fn commands(self, packages: &[&str]) -> Vec<Line> {
        let line = |fixed: &[&str]| Line { words: fixed.iter().chain(packages).map(|&w| w.to_owned()).collect(), may_fail: false };
        match self {
            Self::Apt => vec![
                // An unreachable extra source must not stop us: whether the packages are there, the second line tells.
                Line { words: ["apt-get", "update"].map(str::to_owned).to_vec(), may_fail: true },
                line(&[
                    "env",
                    "DEBIAN_FRONTEND=noninteractive",
                    "apt-get",
                    "-o",
                    "DPkg::Lock::Timeout=300",
                    "install",
                    "-y",
                    "--no-install-recommends",
                ]),
            ],
            Self::Dnf => vec![line(&["dnf", "install", "-y", "--setopt=install_weak_deps=False"])],
            Self::Pacman => vec![line(&["pacman", "-Sy", "--needed", "--noconfirm"])],
        }
    }
}

/// What we may do to the system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rights {
    /// Everything.
    Root,
    /// Everything through `sudo`, which asks for no password.
    Sudo,
    /// Nothing without asking.
    None,
}

/// What is there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Machine {
    /// What is needed and not there.
    pub missing: Vec<Need>,
    /// The package manager, if it is one that we know.
    pub manager: Option<Manager>,
    /// What we may do.
    pub rights: Rights,
}

/// One command: program and arguments.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line {
    /// Program and arguments; none holds a space.
    pub words: Vec<String>,
    /// Whether to go on if it fails.
    pub may_fail: bool,
}

impl Line {
    fn with_sudo(mut self, ask: bool) -> Self {
        let sudo: &[&str] = if ask { &["sudo"] } else { &["sudo", "-n"] };
        self.words.splice(0..0, sudo.iter().map(|&w| w.to_owned()));
        self
    }
}

impl fmt::Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words.join(" "))
    }
}

/// What to do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Decision {
    /// All is there.
    Ready,
    /// Run these, in order.
    Install(Vec<Line>),
    /// Not ours to do: show this one line and stop.
    Ask(String),
    /// No package manager that we know: name what is missing and stop.
    Name(Vec<Need>),
}

/// Decides from what is there.
pub fn decide(machine: &Machine) -> Decision {
    if machine.missing.is_empty() {
        return Decision::Ready;
    }
    let Some(manager) = machine.manager else { return Decision::Name(machine.missing.clone()) };
    let packages: Vec<&str> = machine.missing.iter().flat_map(|&need| manager.packages(need)).copied().collect();
    let lines = manager.commands(&packages);
    match machine.rights {
        Rights::Root => Decision::Install(lines),
        Rights::Sudo => Decision::Install(lines.into_iter().map(|line| line.with_sudo(false)).collect()),
        Rights::None => Decision::Ask(one_line(lines.into_iter().map(|line| line.with_sudo(true)))),
    }
}

/// The commands as one line for a shell.
pub fn one_line(lines: impl IntoIterator<Item = Line>) -> String {
    let mut text = String::new();
    let mut joint = "";
    for line in lines {
        text.push_str(joint);
        text.push_str(&line.to_string());
        joint = if line.may_fail { "; " } else { " && " };
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn machine(missing: &[Need], manager: Option<Manager>, rights: Rights) -> Machine {
        Machine { missing: missing.to_vec(), manager, rights }
    }

    fn installed(decision: Decision) -> Vec<String> {
        match decision {
            Decision::Install(lines) => lines.iter().map(ToString::to_string).collect(),
            other => panic!("expected an installation, got {other:?}"),
        }
    }

    #[test]
    fn a_machine_that_has_all_is_left_alone() {
        for manager in [None, Some(Manager::Apt), Some(Manager::Dnf), Some(Manager::Pacman)] {
            for rights in [Rights::Root, Rights::Sudo, Rights::None] {
                assert_eq!(decide(&machine(&[], manager, rights)), Decision::Ready);
            }
        }
    }

    #[test]
    fn a_bare_debian_is_set_up_by_root() {
        let bare: Vec<Need> = Need::ALL.into_iter().filter(|&n| n != Need::X11).collect();
        let lines = installed(decide(&machine(&bare, Some(Manager::Apt), Rights::Root)));
        assert_eq!(
            lines,
            [
                "apt-get update",
                "env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 install -y --no-install-recommends \
                 pkg-config libudev-dev libasound2-dev libwayland-dev libxkbcommon-dev libxkbcommon-x11-0 libvulkan1 \
                 mesa-vulkan-drivers g++ xvfb xdotool libx11-6 libx11-xcb1 libxcursor1 libxi6 libxrandr2",
            ]
        );
    }

    #[test]
    fn only_what_is_missing_is_installed() {
        let lines = installed(decide(&machine(&[Need::Udev, Need::VulkanDriver], Some(Manager::Dnf), Rights::Root)));
        assert_eq!(lines, ["dnf install -y --setopt=install_weak_deps=False systemd-devel mesa-vulkan-drivers"]);
    }

    #[test]
    fn sudo_never_waits_for_a_password() {
        let lines = installed(decide(&machine(&[Need::PkgConfig], Some(Manager::Pacman), Rights::Sudo)));
        assert_eq!(lines, ["sudo -n pacman -Sy --needed --noconfirm pkgconf"]);
        let lines = installed(decide(&machine(&[Need::PkgConfig], Some(Manager::Apt), Rights::Sudo)));
        assert!(lines.iter().all(|line| line.starts_with("sudo -n ")), "{lines:?}");
    }

    #[test]
    fn without_rights_one_line_is_shown() {
        let asked = decide(&machine(&[Need::PkgConfig, Need::Wayland], Some(Manager::Apt), Rights::None));
        let Decision::Ask(line) = asked else { panic!("expected a line to show, got {asked:?}") };
        assert_eq!(
            line,
            "sudo apt-get update; sudo env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 install -y \
             --no-install-recommends pkg-config libwayland-dev"
        );
        assert_eq!(line.lines().count(), 1);
    }

    #[test]
    fn without_a_known_manager_the_missing_things_are_named_whatever_the_rights() {
        for rights in [Rights::Root, Rights::Sudo, Rights::None] {
            let decision = decide(&machine(&[Need::VulkanLoader], None, rights));
            assert_eq!(decision, Decision::Name(vec![Need::VulkanLoader]));
        }
    }

    #[test]
    fn every_manager_has_a_package_for_every_need() {
        for manager in [Manager::Apt, Manager::Dnf, Manager::Pacman] {
            for need in Need::ALL {
                let packages = manager.packages(need);
                assert!(!packages.is_empty(), "{manager:?} has nothing for {need:?}");
                assert!(packages.iter().all(|p| !p.contains(char::is_whitespace)), "one word a package: {packages:?}");
            }
        }
    }
}
