//! A visit in a real window, with real keys and a real mouse: from a first start to the next.
//!
//! It needs a display of its own (Xvfb) and xdotool, which `cargo verify` installs on Linux; elsewhere it says that it did not run. Stills of
//! every panel lie in the target directory, in `visit/`. `VEDUTA_VISIT_SIZE=3840x2160` takes them in another size.

#![cfg(target_os = "linux")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// What is waited for longer than this does not come.
const PATIENCE: Duration = Duration::from_secs(180);

/// A display of our own, and the program in it.
struct Visit {
    display: String,
    _screen: Ended,
    game: Option<Ended>,
    log: PathBuf,
    home: PathBuf,
    stills: PathBuf,
    size: (u32, u32),
}

/// A process that does not outlive the test.
struct Ended(Child);

impl Drop for Ended {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn is_there(program: &str) -> bool {
    Command::new(program).arg("-help").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}

/// The program, as cargo built it for this test.
const PROGRAM: &str = env!("CARGO_BIN_EXE_veduta");

/// A folder of this test's own.
fn workplace() -> PathBuf {
    let dir = std::env::temp_dir().join(format!("veduta-visit-{}", std::process::id()));
    let _ = fs::remove_dir_all(&dir);
    fs::create_dir_all(&dir).unwrap_or_else(|e| panic!("{}: {e}", dir.display()));
    dir
}

impl Visit {
    fn new() -> Self {
        let told = std::env::var("VEDUTA_VISIT_SIZE").unwrap_or_else(|_| "960x540".to_owned());
        let size = told.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?))).expect("WIDTHxHEIGHT");
        let home = workplace();
        let stills = Path::new(PROGRAM).with_file_name("visit").join(&told);
        let _ = fs::remove_dir_all(&stills);
        fs::create_dir_all(&stills).expect("room for stills");
        // The screen finds a number for itself and tells it.
        let mut command = Command::new("Xvfb");
        command.args(["-displayfd", "1", "-nolisten", "tcp", "-screen", "0", &format!("{told}x24")]);
        let mut screen = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect("Xvfb starts");
        let mut number = String::new();
        let out = screen.stdout.take().expect("piped");
        std::io::BufRead::read_line(&mut std::io::BufReader::new(out), &mut number).expect("Xvfb tells its number");
        let (display, log) = (format!(":{}", number.trim()), home.join("log"));
        Self { display, _screen: Ended(screen), game: None, log, home, stills, size }
    }

    /// Starts the program, and waits until the city stands about the visitor.
    fn start(&mut self, city: &Path) {
        let log = fs::OpenOptions::new().create(true).append(true).open(&self.log).expect("room for a log");
        let (width, height) = self.size;
        let mut command = Command::new(PROGRAM);
        command
            .args(["walk", &city.display().to_string(), "--size", &format!("{width}x{height}")])
            .arg("--stills")
            .arg(&self.stills)
            .env("DISPLAY", &self.display)
            .env_remove("WAYLAND_DISPLAY")
            .env("XDG_RUNTIME_DIR", &self.home)
            .env("XDG_CONFIG_HOME", &self.home)
            .env_remove("LC_ALL")
            .env_remove("LC_MESSAGES")
            .env("LANG", "C")
            .env("NO_COLOR", "1")
            .stdout(log.try_clone().expect("a second handle"))
            .stderr(log);
        self.game = Some(Ended(command.spawn().expect("veduta starts")));
        self.until("visit: arrived");
        let window = self.xdotool(&["search", "--name", "Veduta"]);
        let window = window.lines().next().expect("a window").to_owned();
        self.xdotool(&["windowfocus", &window]);
    }

    fn xdotool(&self, args: &[&str]) -> String {
        let out = Command::new("xdotool").args(args).env("DISPLAY", &self.display).output().expect("xdotool runs");
        String::from_utf8_lossy(&out.stdout).into_owned()
    }

    fn told(&self) -> String {
        fs::read_to_string(&self.log).unwrap_or_default()
    }

    /// Waits until the program has said something.
    fn until(&mut self, what: &str) {
        let began = Instant::now();
        while !self.told().contains(what) {
            let ended = self.game.as_mut().and_then(|game| game.0.try_wait().ok().flatten());
            assert!(ended.is_none() && began.elapsed() < PATIENCE, "`{what}` was never said ({ended:?}):\n{}", self.told());
            std::thread::sleep(Duration::from_millis(100));
        }
    }

    /// Forgets what was said so far.
    fn forget(&self) {
        // Truncated, not made anew: the program goes on adding to it.
        fs::OpenOptions::new().write(true).truncate(true).open(&self.log).expect("the log is there");
    }

    /// Presses a key for as long as a slow frame may take.
    fn press(&self, key: &str) {
        self.xdotool(&["keydown", key]);
        std::thread::sleep(Duration::from_millis(700));
        self.xdotool(&["keyup", key]);
        std::thread::sleep(Duration::from_millis(500));
    }

    fn hold_until(&mut self, key: &str, what: &str) {
        self.xdotool(&["keydown", key]);
        self.until(what);
        self.xdotool(&["keyup", key]);
    }

    fn hold(&self, key: &str, seconds: u64) {
        self.xdotool(&["keydown", key]);
        std::thread::sleep(Duration::from_secs(seconds));
        self.xdotool(&["keyup", key]);
    }

    fn write(&self, text: &str) {
        for letter in text.chars() {
            self.xdotool(&["key", "--delay", "300", &letter.to_string()]);
            std::thread::sleep(Duration::from_millis(500));
        }
    }

    /// Takes a still by the program's own key.
    fn still(&mut self, name: &str) {
        std::thread::sleep(Duration::from_millis(1_500));
        self.forget();
        self.press("F12");
        self.until("visit: still ");
        let told = self.told();
        let path = told.lines().find_map(|line| line.split_once("visit: still ")).map(|(_, path)| PathBuf::from(path.trim()));
        let path = path.expect("its path was said");
        let kept = self.stills.join(format!("{name}.png"));
        let began = Instant::now();
        while image::open(&path).is_err() {
            assert!(began.elapsed() < PATIENCE, "{} is no picture", path.display());
            std::thread::sleep(Duration::from_millis(200));
        }
        fs::rename(&path, &kept).expect("stills lie in one folder");
        let picture = image::open(&kept).expect("it was one").to_rgb8();
        assert_eq!(picture.dimensions(), self.size, "{name}");
        // The city is seen on the left, between the line above and the bar below: what always stands about it is not in question.
        let (width, height) = self.size;
        let city = image::imageops::crop_imm(&picture, 0, height / 9, width / 4, height * 3 / 4).to_image();
        let (least, most) = city.pixels().fold((255, 0), |(least, most), p| (p.0[1].min(least), p.0[1].max(most)));
        assert!(most - least > 80, "{name} is blank: {}", kept.display());
    }

    fn quit(&mut self) {
        self.forget();
        self.press("ctrl+q");
        let mut game = self.game.take().expect("it runs");
        let began = Instant::now();
        while game.0.try_wait().expect("a child").is_none() {
            assert!(began.elapsed() < PATIENCE, "it does not quit:\n{}", self.told());
            std::thread::sleep(Duration::from_millis(100));
        }
    }
}

#[test]
fn a_visitor_finds_reads_jumps_tours_chooses_and_comes_back() {
    if !(is_there("Xvfb") && is_there("xdotool")) {
        assert!(std::env::var_os("VEDUTA_VISIT").is_none(), "the visit is to be made, and Xvfb and xdotool are not here");
        println!("the visit was not made: Xvfb and xdotool are not here");
        return;
    }
    let scene = std::path::absolute("../scenes/old_prague").expect("a path");
    let mut visit = Visit::new();
    visit.start(&scene);
    visit.still("01_first_minute");

    // The first step is learned by walking.
    visit.hold_until("w", "visit: first minute 2");
    visit.hold_until("Right", "visit: first minute 3");
    visit.still("02_first_minute_looking");

    // Finds Týn by search, walks there, reads its panel.
    visit.forget();
    visit.press("slash");
    visit.write("tyn");
    visit.still("03_search");
    visit.forget();
    visit.press("Return");
    visit.until("visit: led to Church of Our Lady before Týn");
    visit.still("04_led");
    visit.until("visit: arrived at Church of Our Lady before Týn");
    visit.still("05_place");

    // Opens the map, jumps to the Powder Tower.
    visit.press("m");
    visit.still("06_map");
    visit.press("m");
    visit.press("slash");
    visit.write("powder to");
    visit.forget();
    visit.press("shift+Return");
    visit.until("visit: at Powder Tower");
    visit.still("07_powder_tower");

    // Takes the tour, wanders off, resumes.
    visit.forget();
    visit.press("t");
    visit.until("visit: tour Playing");
    std::thread::sleep(Duration::from_secs(6));
    visit.still("08_tour");
    visit.forget();
    visit.hold("s", 3);
    visit.until("visit: tour Wandering");
    visit.still("09_wandering");
    visit.forget();
    visit.press("t");
    visit.until("visit: tour Playing");
    visit.press("t");
    visit.until("visit: tour Paused");

    // How a tour is edited, and what experts see.
    visit.press("e");
    visit.still("10_editor");
    visit.press("e");
    visit.press("F2");
    visit.still("11_expert");
    visit.press("F2");

    // Help, and by the search box the settings in another language and quality.
    visit.press("F1");
    visit.still("12_help");
    visit.press("F1");
    visit.press("F3");
    visit.still("13_settings");
    visit.press("F3");
    visit.press("slash");
    visit.write("cestina");
    visit.forget();
    visit.press("Return");
    visit.until("visit: language cs");
    visit.press("slash");
    visit.write("kvalita st");
    visit.forget();
    visit.press("Return");
    visit.until("visit: quality Medium");
    visit.press("F3");
    visit.still("14_settings_in_czech");
    visit.press("F3");
    visit.press("n");
    visit.quit();

    // All is kept at the next start.
    visit.start(&scene);
    let told = visit.told();
    assert!(told.contains("visit: language cs") && told.contains("visit: quality Medium"), "{told}");
    let kept = fs::read_to_string(visit.home.join("veduta/settings.ron")).expect("settings were kept");
    assert!(
        kept.contains("knows_the_way:true") || kept.contains("knows_the_way: true"),
        "the first minute was gone through: {kept}"
    );
    assert!(kept.contains("north_up:true") || kept.contains("north_up: true"), "{kept}");
    visit.still("15_the_next_start");
    visit.quit();
}
