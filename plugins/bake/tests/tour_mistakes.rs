//! The likeliest mistakes of somebody who has never seen RON: each message names file, line and column, shows the line, and says
//! what to write instead.

use std::process::Command;

#[path = "shared/folder.rs"]
mod folder;

use folder::Folder;

const TOWN: &str = "(name: \"T\", anchor: (lat: 50, lon: 14), nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (90, 0))],
    links: [(id: 9, from: 1, to: 2, kind: Street(Lane))],
    places: [(name: \"Týn\", pos: (60, 1))],
    buildings: [(id: 4, outline: [(0, 5), (12, 5), (12, 15), (0, 15)])])";

/// A tour without a mistake; its lines are counted on by the table.
const GOOD: &str = r#"(
  title: "A walk",
  translations: {"cs": "Cesta"},
  city: "t.graph.ron",
  speed: 1.4,
  steps: [
    Start(at: At(0, 0)),
    Walk(to: Place("Týn"), speed: 1.2),
    Look(at: Heading(deg: 90, pitch_deg: 5), seconds: 3),
    Say(text: "Here we are", translations: {"cs": "Tady"}),
    Wait(seconds: 2),
  ],
)
"#;

/// What is written in place of what, where the message points (line and column), and what it says.
const MISTAKES: &[(&str, &str, &str, &[&str])] = &[
    ("speed: 1.4,\n", "speed: 1.4\n", "5:13", &["a comma is missing here"]),
    ("At(0, 0)),\n", "At(0, 0))\n", "7:24", &["a comma is missing here"]),
    ("Start(at: At(0, 0)),", "Start(at: At(0, 0),", "8:5", &["`Walk(…)` stands among fields", "`)`", "missing"]),
    ("  ],\n)\n", "  ],\n", "1:1", &["this `(` is never closed", "put a `)`"]),
    ("  ],\n)\n", ")\n", "12:1", &["`)` does not close the `[` of line 6"]),
    ("Place(\"Týn\")", "Týn", "8:", &["`Týn` is no spot", "Place(\"Týn\")"]),
    ("Place(\"Týn\")", "\"Týn\"", "8:14", &["a place is written `Place(\"Týn\")`"]),
    ("Place(\"Týn\")", "Place(Týn)", "8:20", &["a text is wanted here, in straight quotation marks", "write \"Týn\""]),
    ("Place(\"Týn\")", "Place(\"Tin\")", "8:20", &["there is no place named \"Tin\"", "did you mean \"Týn\"?"]),
    ("Place(\"Týn\")", "60, 1", "8:14", &["a spot in metres is written `At("]),
    ("Walk(", "Wlak(", "8:", &["`Wlak` is not known here", "did you mean `Walk`?"]),
    ("Walk(", "walk(", "8:", &["`walk` is not known here", "did you mean `Walk`?"]),
    ("Walk(", "Run(", "8:", &["`Run` is not known here", "did you mean `Walk`?"]),
    ("Walk(", "Sing(", "8:", &["`Sing` is not known here", "known are `Start`, `Walk`"]),
    ("pitch_deg: 5", "pitch: 5", "9:", &["no field `pitch`", "with its unit it is `pitch_deg`"]),
    ("Wait(seconds: 2)", "Wait(second: 2)", "11:", &["no field `second`", "did you mean `seconds`?"]),
    ("Wait(seconds: 2)", "Wait(2)", "11:10", &["write `Wait(seconds: 2)`"]),
    ("Wait(seconds: 2)", "Wait()", "11:", &["`seconds` is missing"]),
    ("Wait(seconds: 2)", "Wait", "11:", &["`(` is wanted here"]),
    ("seconds: 2)", "seconds: 2s)", "11:19", &["a number stands alone", "`2`, not `2s`"]),
    ("seconds: 2)", "seconds: \"2\")", "11:19", &["a number is wanted here, without quotation marks"]),
    ("seconds: 2)", "seconds: -2)", "11:19", &["the time in seconds is -2", "between 0 and"]),
    ("seconds: 2)", "seconds = 2)", "11:18", &["stands `:`, not `=`"]),
    ("seconds: 2)", "seconds: 2, seconds: 3)", "11:", &["`seconds` stands there twice"]),
    ("seconds: 2)", "seconds: [2])", "11:19", &["a number is wanted here"]),
    ("speed: 1.4,", "speed: 1,4,", "5:12", &["a point parts them: 1.5, not 1,5"]),
    ("speed: 1.4,", "speed: 50,", "5:10", &["speed in metres a second is 50", "between 0.1 and 10"]),
    ("speed: 1.2)", "speed: 20)", "8:35", &["speed in metres a second is 20"]),
    ("\"A walk\"", "“A walk”", "2:10", &["a printer's", "straight one"]),
    ("\"A walk\",", "\"A walk,", "2:", &["`\"`"]),
    ("\"A walk\"", "A walk", "2:10", &["a text is wanted here, in straight quotation marks"]),
    ("\"A walk\"", "\"C:\\walk\"", "2:13", &["in a path write `/`"]),
    ("{\"cs\": \"Cesta\"}", "{\"cz\": \"Cesta\"}", "3:18", &["\"cz\" is no language's code; write \"cs\""]),
    ("{\"cs\": \"Tady\"}", "{\"czech\": \"Tady\"}", "10:45", &["step 4", "\"czech\" is no language's code; write \"cs\""]),
    ("{\"cs\": \"Cesta\"}", "[\"Cesta\"]", "3:17", &["pairs are wanted here, in curly brackets"]),
    ("{\"cs\": \"Cesta\"}", "\"Cesta\"", "3:17", &["pairs are wanted here"]),
    ("Place(\"Týn\"), speed: 1.2", "Place(\"Týn\"), via: At(3, 0)", "8:33", &["a list is wanted here", "even if it has one item"]),
    ("to: Place(\"Týn\")", "to: [Place(\"Týn\")]", "8:14", &["one value is wanted here, not a list"]),
    ("steps: [", "steps: (", "6:10", &["a list is wanted here, in square brackets", "`(` stands there"]),
    ("At(0, 0)", "At(0)", "7:", &["takes two numbers", "1 is given"]),
    ("\"t.graph.ron\"", "\"town.graph.ron\"", "4:9", &["there is no city at `town.graph.ron`", "beside it lies \"t.graph.ron\""]),
    ("    Start(at: At(0, 0)),\n", "", "7:5", &["the tour stands nowhere yet", "put `Start(at: ...)`"]),
    ("    Start(at", "    # first\n    Start(at", "7:5", &["a name is wanted here", "`#` stands there"]),
];

/// What `check` tells of tours that can be read: what is written in place of what, whether the tour may be played nevertheless, and all that is told,
/// each by its place and words.
const TOLD: &[(&str, &str, bool, &[(&str, &str)])] = &[
    // The city.
    ("\"t.graph.ron\"", "\"\"", false, &[("4:9", "the city is empty"), ("4:9", "beside it lies \"t.graph.ron\"")]),
    ("\"t.graph.ron\"", "\"Old Town\"", false, &[("4:9", "a path is wanted here, such as \"town.graph.ron\", not a name")]),
    ("\"t.graph.ron\"", "\"a.tour.ron\"", false, &[("4:9", "`a.tour.ron` is a tour")]),
    ("\"t.graph.ron\"", "\"sub/t.graph.ron\"", false, &[("4:9", "there is no city at `sub/t.graph.ron`")]),
    ("\"t.graph.ron\"", "\"ftp://x/t.city\"", false, &[("4:9", "is no address of a city")]),
    // Every mistake, each at its place.
    (
        "    Wait(seconds: 2),",
        "    Fov(deg: 500, seconds: -2),\n    Walk(to: Place(\"Nowhere\"), via: [Place(\"Tin\")], speed: 0),\n    Look(at: Spot(at: Place(\"X\")), seconds: 1),",
        false,
        &[
            ("11:14", "step 5 (Fov): the field of view in degrees is 500; it must lie between 5 and 140"),
            ("11:28", "the time in seconds is -2"),
            ("12:20", "there is no place named \"Nowhere\"; `veduta-bake places "),
            ("12:44", "there is no place named \"Tin\"; did you mean \"Týn\"?"),
            ("12:60", "step 6 (Walk): the speed in metres a second is 0"),
            ("13:29", "there is no place named \"X\""),
        ],
    ),
    (
        "    Wait(seconds: 2),",
        "    Wait(second: 2),\n    Fvo(deg: 60),",
        false,
        &[("11:10", "did you mean `seconds`?"), ("12:5", "`Fvo` is not known here"), ("", "is told once these are mended")],
    ),
    ("    Start(at: At(0, 0)),\n", "", false, &[("7:5", "the tour stands nowhere yet")]),
    ("Place(\"Týn\")", "Place(\"Teynkirche\")", false, &[("8:20", "tours go by the map's names, and there it is \"Týn\"")]),
    ("Place(\"Týn\")", "At(5000, 0)", false, &[("8:14", "lies outside of the city: 4910 m from the nearest street")]),
    // Files.
    ("Wait(seconds: 2)", "Sound(file: \"no.ogg\")", false, &[("11:17", "there is no file `no.ogg` in the folder of this file")]),
    (
        "Wait(seconds: 2)",
        "Picture(file: \"A.PNG\", seconds: 1)",
        false,
        &[("11:19", "did you mean \"a.png\"? Capital letters count")],
    ),
    ("Wait(seconds: 2)", "Picture(file: \"a.png\", seconds: 1)", false, &[("11:19", "`a.png` is called a picture and is none")]),
    ("Wait(seconds: 2)", "Picture(file: \"a.ogg\", seconds: 1)", false, &[("11:19", "is no picture by its name")]),
    ("Wait(seconds: 2)", "Sound(file: \"a.wav\")", false, &[("11:17", "`ffmpeg -i a.wav -c:a libvorbis a.ogg`")]),
    ("Wait(seconds: 2)", "Sound(file: \"../a.ogg\")", false, &[("11:17", "must lie in or below the folder of this file")]),
    ("Wait(seconds: 2)", "Sound(file: \"b\\river.ogg\")", false, &[("11:17", "in a path write `/`")]),
    ("Wait(seconds: 2)", "Sound(file: \"https://x/a.ogg\")", false, &[("11:17", "is not fetched from the web")]),
    // What can be played, with notes.
    ("At(0, 0)", "At(6, 10)", true, &[("7:15", "note: this lies within a house")]),
    (
        "Wait(seconds: 2)",
        "Cut(to: At(0, 900))",
        true,
        &[("11:13", "note: this lies outside of the city, 900 m from the nearest street")],
    ),
    ("At(0, 0)", "At(50.00012, 14.00034)", true, &[("7:15", "note: this looks like degrees of latitude and longitude")]),
    ("Wait(seconds: 2)", "Fly(through: [(6, 10, 2)], speed: 2)", true, &[("11:19", "note: the flight goes through a house")]),
    ("Wait(seconds: 2)", "Fly(through: [(9, 0, 2)], speed: 99)", true, &[("11:38", "note: the flight comes to")]),
    ("Wait(seconds: 2)", "Look(at: Heading(deg: 270), seconds: 1)", true, &[("11:42", "note: the turn takes 4.5 s")]),
    (
        "Wait(seconds: 2)",
        "Look(at: Spot(at: At(0, 9000), height_m: -50), seconds: 9)",
        true,
        &[("11:23", "km outside of the city"), ("11:46", "50 m below the ground")],
    ),
    (
        "Wait(seconds: 2)",
        "Time(hour: 17.30)",
        true,
        &[("11:16", "note: hours are decimal: `17.30` is 18 minutes past 17; 17:30 is 17.5")],
    ),
    (
        "{\"cs\": \"Tady\"}",
        "{\"cs\": \"\", \"cs\": \"\", \"xx\": \"y\"}",
        true,
        &[
            ("10:45", "note: \"cs\" stands there twice"),
            ("10:45", "note: what is told for \"cs\" is empty"),
            ("10:65", "note: no language has the code \"xx\""),
        ],
    ),
    ("\"A walk\"", "\"\"", true, &[("2:10", "note: the title is empty")]),
    (
        "Wait(seconds: 2)",
        "Look(at: Spot(at: At(0, 9), follow: \"Hay carts\"), seconds: 9)",
        true,
        &[("11:41", "note: nothing that moves in t.life.ron is named \"Hay carts\"; did you mean \"Hay cart\"?")],
    ),
    (
        "Wait(seconds: 2)",
        "Look(at: Spot(at: At(0, 9), follow: \"\"), seconds: 9)",
        true,
        &[("11:41", "note: the name of what is followed is empty")],
    ),
    (
        "Wait(seconds: 2)",
        "Say(text: \"And here, as you see, is where all of it came to its end\", seconds: 0.5)",
        true,
        &[("10:15", "note: these words are shown for 0.0 s"), ("11:84", "note: these words are shown for 0.5 s")],
    ),
    (
        "Wait(seconds: 2)",
        "Mark(name: \"a\"), Mark(name: \"a\"), Chapter(title: \"Z\")",
        true,
        &[("11:33", "note: a mark of this name is step 5 already"), ("11:39", "note: nothing happens in this chapter")],
    ),
];

fn check(folder: &Folder, text: &str) -> (bool, String) {
    let tour = folder.write("a.tour.ron", text);
    let out = Command::new(env!("CARGO_BIN_EXE_veduta-bake")).arg("check").arg(&tour).output().expect("the program runs");
    (out.status.success(), format!("{}{}", String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr)))
}

#[test]
fn every_mistake_is_shown_in_its_line_with_what_to_do() {
    let folder = Folder::new("tour-mistakes");
    folder.write("t.graph.ron", TOWN);
    let (is_good, told) = check(&folder, GOOD);
    assert!(is_good && told.contains("5 steps"), "{told}");
    let mut wrong = Vec::new();
    for (good, bad, place, words) in MISTAKES {
        assert_eq!(GOOD.matches(good).count(), 1, "{good:?} stands once in the tour");
        let text = GOOD.replacen(good, bad, 1);
        let (is_good, told) = check(&folder, &text);
        let line: usize = place.split(':').next().and_then(|line| line.parse().ok()).expect("a line");
        let shown = text.lines().nth(line - 1).unwrap_or_default();
        let is_told = told.contains(&format!("a.tour.ron:{place}"))
            && told.contains(&format!("{line} | {shown}"))
            && words.iter().all(|word| told.contains(word));
        if is_good || !is_told {
            wrong.push(format!("{bad:?} should be told at {place} with {words:?}, and is told so:\n{told}"));
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), MISTAKES.len(), wrong.join("\n"));
}

#[test]
fn all_that_is_wrong_or_odd_is_told_once_at_its_place() {
    let folder = Folder::new("tour-told");
    folder.write("t.graph.ron", TOWN);
    folder.write("t.guide.ron", "(places: [(name: \"Týn\", names: {\"de\": \"Teynkirche\"})])");
    folder.write("a.png", "no picture at all");
    let cart = "(name: \"Hay cart\", at: At(0, 9), kind: Flock(radius_m: 4, count: 3))";
    folder.write("t.life.ron", &format!("(things: [{cart}])"));
    // What lives in another city does not live here.
    folder.write("other.life.ron", &format!("(things: [{}])", cart.replace("cart", "carts")));
    let mut wrong = Vec::new();
    for (good, bad, may_be_played, all) in TOLD {
        assert_eq!(GOOD.matches(good).count(), 1, "{good:?} stands once in the tour");
        let (is_good, told) = check(&folder, &GOOD.replacen(good, bad, 1));
        let heads: Vec<&str> = told.lines().filter(|line| line.contains("a.tour.ron:") && !line.contains("“")).collect();
        let is_told = |(place, words): &(&str, &str)| {
            heads.iter().any(|head| head.contains(&format!("a.tour.ron:{place}")) && head.contains(words))
        };
        let places: std::collections::BTreeSet<&str> = all.iter().map(|(place, _)| *place).collect();
        if is_good != *may_be_played || !all.iter().all(is_told) || heads.len() < places.len() || heads.len() > all.len() {
            wrong.push(format!("{bad:?} should be told as {all:?}, and is told so:\n{told}"));
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), TOLD.len(), wrong.join("\n"));
}

#[test]
fn a_file_in_another_encoding_is_told_where_it_stops_being_text() {
    let folder = Folder::new("tour-encoding");
    folder.write("t.graph.ron", TOWN);
    let tour = folder.write("a.tour.ron", "");
    let latin: Vec<u8> = GOOD.replace("Týn", "T#n").bytes().map(|byte| if byte == b'#' { 0xfd } else { byte }).collect();
    std::fs::write(&tour, latin).expect("room");
    let out = Command::new(env!("CARGO_BIN_EXE_veduta-bake")).arg("check").arg(&tour).output().expect("the program runs");
    let told = String::from_utf8_lossy(&out.stderr).into_owned();
    let shown = "a.tour.ron:8:22: the text is not UTF-8 from here on; save it as UTF-8\n8 |     Walk(to: Place(\"T\u{fffd}n\"), speed: 1.2),\n";
    assert!(!out.status.success() && told.contains(shown), "{told}");
}

#[test]
fn how_long_things_last_and_what_places_there_are_is_told_on_request() {
    let folder = Folder::new("tour-lengths");
    let graph = folder.write("t.graph.ron", TOWN);
    folder.write("t.guide.ron", "(places: [(name: \"Týn\", names: {\"de\": \"Teynkirche\"})])");
    let tour =
        folder.write("a.tour.ron", &GOOD.replace("    Wait(seconds: 2)", "    Chapter(title: \"End\"),\n    Wait(seconds: 2)"));
    let run = |arguments: &[&std::ffi::OsStr]| {
        let out = Command::new(env!("CARGO_BIN_EXE_veduta-bake")).args(arguments).output().expect("the program runs");
        String::from_utf8_lossy(&out.stdout).into_owned()
    };
    let told = run(&["check".as_ref(), "--steps".as_ref(), tour.as_os_str()]);
    assert!(
        told.contains("6 steps") && told.contains("chapters “End” ") && told.contains("\n    6  Wait        2.0 s from "),
        "{told}"
    );
    assert_eq!(run(&["places".as_ref(), graph.as_os_str()]), "Týn  At(60.0, 1.0)  (Teynkirche)\n");
}

#[test]
fn the_readmes_table_has_every_field_of_every_step() {
    let readme = std::fs::read_to_string("../../README.md").expect("there is a README");
    let step = |text: &str| veduta_city::file::parse::<veduta_city::Step>(text, "step").expect_err(text).message;
    let known = |message: &str| -> Vec<String> {
        let list = message.split_once(" here").expect("what is not known is told").1;
        list.split('`').skip(1).step_by(2).map(str::to_owned).collect()
    };
    let steps = known(&step("Zzzzzzzzz()"));
    assert_eq!(steps.len(), 16, "{steps:?}");
    for name in steps {
        let row = readme
            .lines()
            .find(|line| line.starts_with(&format!("| `{name}` |")))
            .unwrap_or_else(|| panic!("README.md tells nothing of `{name}`"));
        for field in known(&step(&format!("{name}(zzzzzzzzz: 1)"))) {
            assert!(row.contains(&format!("`{field}`")) || row.contains(&format!("`{field}: ")), "`{field}` is missing in {row}");
        }
    }
}
