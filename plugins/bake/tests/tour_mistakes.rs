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
    ("Place(\"Týn\")", "\"Týn\"", "8:14", &["a name without quotation marks is wanted", "Place(\"…\")"]),
    ("Place(\"Týn\")", "Place(Týn)", "8:20", &["a text is wanted here, in straight quotation marks", "`T` stands there"]),
    ("Place(\"Týn\")", "Place(\"Tin\")", "8:20", &["there is no place named \"Tin\"", "did you mean \"Týn\"?"]),
    ("Place(\"Týn\")", "60, 1", "8:14", &["a spot in metres stands as At("]),
    ("Walk(", "Wlak(", "8:", &["`Wlak` is not known here", "did you mean `Walk`?"]),
    ("Walk(", "walk(", "8:", &["`walk` is not known here", "did you mean `Walk`?"]),
    ("Walk(", "Run(", "8:", &["`Run` is not known here", "known are `Start`, `Walk`"]),
    ("pitch_deg: 5", "pitch: 5", "9:", &["no field `pitch`", "with its unit it is `pitch_deg`"]),
    ("Wait(seconds: 2)", "Wait(second: 2)", "11:", &["no field `second`", "did you mean `seconds`?"]),
    ("Wait(seconds: 2)", "Wait(2)", "11:10", &["a name is wanted here"]),
    ("Wait(seconds: 2)", "Wait()", "11:", &["`seconds` is missing"]),
    ("Wait(seconds: 2)", "Wait", "11:", &["`(` is wanted here"]),
    ("seconds: 2)", "seconds: 2s)", "11:19", &["a number stands alone", "`2`, not `2s`"]),
    ("seconds: 2)", "seconds: \"2\")", "11:19", &["a number is wanted here, without quotation marks"]),
    ("seconds: 2)", "seconds: -2)", "11:10", &["the time in seconds is -2", "between 0 and"]),
    ("seconds: 2)", "seconds = 2)", "11:18", &["stands `:`, not `=`"]),
    ("seconds: 2)", "seconds: 2, seconds: 3)", "11:", &["`seconds` stands there twice"]),
    ("seconds: 2)", "seconds: [2])", "11:19", &["a number is wanted here"]),
    ("speed: 1.4,", "speed: 1,4,", "5:12", &["a point parts them: 1.5, not 1,5"]),
    ("speed: 1.4,", "speed: 50,", "5:3", &["speed in metres a second is 50", "between 0.1 and 10"]),
    ("speed: 1.2)", "speed: 20)", "8:28", &["speed in metres a second is 20"]),
    ("\"A walk\"", "“A walk”", "2:10", &["a printer's", "straight one"]),
    ("\"A walk\",", "\"A walk,", "2:", &["`\"`"]),
    ("\"A walk\"", "A walk", "2:10", &["a text is wanted here, in straight quotation marks"]),
    ("\"A walk\"", "\"C:\\walk\"", "2:", &["write it twice"]),
    ("{\"cs\": \"Cesta\"}", "{\"cz\": \"Cesta\"}", "3:3", &["\"cz\" is no language's code; write \"cs\""]),
    ("{\"cs\": \"Tady\"}", "{\"czech\": \"Tady\"}", "10:45", &["step 4", "\"czech\" is no language's code; write \"cs\""]),
    ("{\"cs\": \"Cesta\"}", "[\"Cesta\"]", "3:17", &["pairs are wanted here, in curly brackets"]),
    ("{\"cs\": \"Cesta\"}", "\"Cesta\"", "3:17", &["pairs are wanted here"]),
    ("Place(\"Týn\"), speed: 1.2", "Place(\"Týn\"), via: At(3, 0)", "8:33", &["a list is wanted here", "even if it has one item"]),
    ("to: Place(\"Týn\")", "to: [Place(\"Týn\")]", "8:14", &["one value is wanted here, not a list"]),
    ("steps: [", "steps: (", "6:10", &["a list is wanted here, in square brackets", "`(` stands there"]),
    ("At(0, 0)", "At(0)", "7:", &["2", "1"]),
    ("\"t.graph.ron\"", "\"town.graph.ron\"", "4:3", &["there is no city at `town.graph.ron`", "beside it lies \"t.graph.ron\""]),
    ("    Start(at: At(0, 0)),\n", "", "7:5", &["the tour stands nowhere yet", "put `Start(at: ...)`"]),
    ("    Start(at", "    # first\n    Start(at", "7:5", &["a name is wanted here", "`#` stands there"]),
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
