use crate::TourText;

/// A step with a mistake, the column of its line where the message points, and what it says.
const STEPS: &[(&str, usize, &[&str])] = &[
    // Names and brackets.
    ("Pause(seconds: 3)", 3, &["`Pause` is not known", "did you mean `Wait`?"]),
    ("GoTo(place: \"x\")", 3, &["`GoTo` is not known", "did you mean `Walk`?"]),
    ("Fvo(deg: 60)", 3, &["`Fvo` is not known", "did you mean `Fov`?"]),
    ("Wait,", 7, &["with the fields of `Wait`: write `Wait(seconds: 3)`"]),
    ("Cut,", 6, &["write `Cut(to: Place(\"…\"))`"]),
    ("Walk[to: Place(\"x\")],", 7, &["as in `Walk(to: Place(\"…\"))`", "`[to: Place(\"x\")]` stands there"]),
    ("Say(text: \"Hi\")),", 18, &["one `)` too many", "take it away"]),
    ("Wait(seconds: 3),,", 20, &["one comma too many"]),
    ("Wait(seconds: 3);", 19, &["stands a comma, not `;`"]),
    ("Wait(seconds: 3)，", 19, &["the comma ， is of another script"]),
    ("\"Wait\",", 3, &["a step is wanted here", "`\"Wait\"` stands there"]),
    ("3,", 3, &["a step is wanted here", "`3` stands there"]),
    ("- Wait(seconds: 3),", 3, &["take the dash away"]),
    ("/* now", 3, &["the comment that begins with `/*` never ends"]),
    // Values without their field's name.
    ("Walk(\"The Clock\"),", 8, &["write `Walk(to: Place(\"The Clock\"))`"]),
    ("Walk(58, 2.4),", 8, &["write `Walk(to: At(12.5, -3))`"]),
    ("Wait(3),", 8, &["write `Wait(seconds: 3)`"]),
    ("Say(\"Hello\"),", 7, &["write `Say(text: \"Hello\")`"]),
    ("Fov(70),", 7, &["write `Fov(deg: 70)`"]),
    ("Picture(\"a.png\"),", 11, &["write `Picture(file: \"a.png\", seconds: 8)`"]),
    ("Look(at: Heading(90), seconds: 2),", 20, &["write `Heading(deg: 90)`"]),
    // Spots and directions.
    ("Look(at: Place(\"x\"), seconds: 2),", 12, &["write `Spot(at: Place(\"x\"))`"]),
    ("Look(at: At(8.5, 3), seconds: 2),", 12, &["write `Spot(at: At(8.5, 3))`"]),
    ("Look(at: 90, seconds: 2),", 12, &["`Heading(deg: 90)`"]),
    ("Look(at: \"x\", seconds: 2),", 12, &["`Spot(at: Place(\"x\"))`"]),
    ("Cut(to: At(0, 0), look: \"Ahead\"),", 27, &["`Ahead` stands without quotation marks"]),
    ("Cut(to: At(0, 0), look: Some(Ahead)),", 27, &["without `Some(…)`: write `Ahead`"]),
    ("Walk(to: At(0, 0), ease: None),", 28, &["take the field away"]),
    ("Walk(to: place(\"x\")),", 12, &["`place` is not known", "did you mean `Place`?"]),
    ("Walk(to: Spot(at: Place(\"x\"))),", 12, &["`Spot` tells only where to look"]),
    ("Walk(to: Old Town Square),", 12, &["`Old Town Square` is no spot", "Place(\"Old Town Square\")"]),
    ("Walk(to: (58, 2.4)),", 12, &["`At(58, 2.4)`"]),
    ("Walk(to: At(58)),", 17, &["takes two numbers", "1 is given"]),
    ("Walk(to: At(58, 2.4, 0)),", 24, &["takes two numbers", "`0` is too much"]),
    ("Walk(to: At(1,234, 5)),", 22, &["a point for decimals"]),
    ("Walk(to: At((58, 2.4))),", 15, &["write `At(58, 2.4)`"]),
    ("Walk(to: At(x: 58, y: 2.4)),", 15, &["without names"]),
    ("Walk(to: At(58, −2.4)),", 19, &["write the minus sign of the keyboard"]),
    ("Walk(to: At(0, 0), via: (58, 2.4)),", 27, &["write `[At(58, 2.4)]`"]),
    ("Walk(to: Place(name: \"x\")),", 18, &["stands alone, without a field"]),
    ("Fly(through: [(46, -1), (26, -6)], speed: 9),", 24, &["has three numbers", "2 are given"]),
    ("Fly(through: [[46, -1, 5]], speed: 9),", 17, &["write `(46, -1, 5)`"]),
    ("Fly(to: Place(\"x\"), speed: 9),", 7, &["told by its points"]),
    // Fields.
    ("Look(at: Spot(at: At(0, 0), height_m: 9, seconds: 2),", 44, &["it belongs to `Look`", "is the `)` missing"]),
    ("Look(at: Spot(at: Place(\"x\", height_m: 9)), seconds: 2),", 32, &["the `)` that ends `Place(` is missing"]),
    ("Look(at: Spot(at: At(0, 0), height-m: 9), seconds: 2),", 31, &["write `height_m`"]),
    ("Wait(duration: 3),", 8, &["did you mean `seconds`?"]),
    ("Time(time: 18),", 8, &["did you mean `hour`?"]),
    ("Fov(angle: 60),", 7, &["did you mean `deg`?"]),
    ("Cut(at: Place(\"x\")),", 7, &["did you mean `to`?"]),
    ("Say(en: \"Hi\", cs: \"Ahoj\"),", 7, &["translations: {\"en\": \"…\"}"]),
    ("Walk(from: Place(\"x\"), to: At(0, 0)),", 8, &["a walk begins where the tour stands"]),
    ("Start(at: At(0, 0), heading: 90),", 23, &["look: Heading(deg: 90)"]),
    ("Chapter(title: \"A\", steps: []),", 23, &["its steps simply follow it"]),
    ("Look(at: Ahead),", 17, &["`seconds` is missing", "as in `Look("]),
    // Numbers.
    ("Time(hour: 12:00),", 14, &["hours are decimal", "write `12`, not `12:00`"]),
    ("Time(hour: \"17:30\"),", 14, &["write `17.5`, not `17:30`"]),
    ("Time(hour: 5pm),", 14, &["write `17`, not `5pm`"]),
    ("Time(hour: 5 pm),", 14, &["write `17`"]),
    ("Wait(seconds: 1/2),", 17, &["numbers are decimal: write `0.5`, not `1/2`"]),
    ("Wait(seconds: 3 s),", 17, &["`3`, not `3 s`"]),
    ("Wait(seconds: \"3\"),", 17, &["write `3`"]),
    ("Fov(deg: \"90°\"),", 12, &["write `90`"]),
    ("Wait(seconds: Some(3)),", 17, &["without `Some(…)`: write `3`"]),
    ("Say(text: \"x\", seconds: null),", 27, &["`null` is none", "left out"]),
    ("Wait(seconds: three),", 17, &["`three` stands there"]),
    ("Wait(seconds:\u{a0}3),", 16, &["a space of another kind"]),
    // Texts.
    ("Say(text: Hello there),", 13, &["write \"Hello there\""]),
    ("Say(text: 'Hello'),", 13, &["not '…'"]),
    ("Say(text: \"the \"old\" clock\"),", 18, &["within a text write \\\""]),
    ("Say(text: \"the \\\"clock\\\" \\z\"),", 28, &["write it twice"]),
    ("Sound(file: \"C:\\sounds\\a.ogg\"),", 18, &["in a path write `/` instead"]),
    ("Say(text: {\"en\": \"Hi\"}),", 13, &["translations: {\"en\": \"Hi\"}"]),
    ("Say(text: \"Hi\", translations: {cs: \"Ahoj\"}),", 34, &["write \"cs\": \"…\""]),
];

#[test]
fn what_is_wrong_with_a_step_is_told_at_its_place_with_what_to_write() {
    let mut wrong = Vec::new();
    for (step, column, words) in STEPS {
        let text = format!("(\n title: \"T\",\n city: \"x\",\n steps: [\n  {step}\n  Wait(seconds: 1),\n ],\n)\n");
        let error = TourText::parse(&text, "a.tour.ron").expect_err(step);
        if (error.line, error.column) != (5, *column) || !words.iter().all(|word| error.message.contains(word)) {
            wrong.push(format!("{step} should be told at 5:{column} with {words:?}, and is:\n{error}"));
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), STEPS.len(), wrong.join("\n"));
}

#[test]
fn what_is_no_tour_from_its_beginning_on_is_told_as_what_it_is() {
    for (text, place, words) in [
        ("", (1, 1), "there is nothing in this file"),
        ("// my tour\n\n", (1, 1), "there is nothing in this file"),
        ("{\n \"title\": \"T\"\n}", (1, 1), "this looks like JSON"),
        ("title: T\nsteps:\n  - Wait: 3\n", (1, 1), "this looks like YAML"),
        ("// mine\ntitle: \"T\",\ncity: \"x\",\nsteps: [],\n", (2, 1), "put `(` before this, and `)` at the end"),
        ("{\\rtf1\\ansi (", (1, 1), "a document of a word processor (RTF)"),
        ("{ title: \"T\" }", (1, 1), "stands in round brackets"),
        ("(\n \"title\": \"T\" )", (2, 2), "write `title: …`"),
        ("(title: \"T\", city: \"x\", steps: []) (", (1, 36), "another `(` does"),
        ("(title: \"T\", steps: [])", (1, 23), "write `city: \"town.graph.ron\"`"),
    ] {
        let error = TourText::parse(text, "a.tour.ron").expect_err(text);
        assert!((error.line, error.column) == place && error.message.contains(words), "{text}: {error}");
    }
    let error = crate::file::parse_bytes::<crate::Tour>(b"\xff\xfe(\0", "a.tour.ron").expect_err("UTF-16");
    assert!(error.message.contains("UTF-16"), "{error}");
}

#[test]
fn a_backslash_behind_letters_of_several_bytes_is_pointed_at() {
    let text = "(\n  title: \"$n  transla~~~~,\n ݢӾ\\x$$\")- 0),\n  ],\n)\n";
    let error = TourText::parse(text, "a.tour.ron").expect_err(text);
    assert!((error.line, error.column) == (3, 4) && error.message.contains('\\'), "{error}");
}

proptest::proptest! {
    #[test]
    fn advice_never_panics(text in "[\\[({:,;\"'/\\*# \\\\\nxé−1.=\\])}Wait]{0,40}") {
        let _ = TourText::parse(&text, "a.tour.ron");
        let _ = TourText::parse(&format!("(title: \"\", city: \"\", steps: [Wait({text}"), "a.tour.ron");
        let _ = TourText::parse(&format!("(title: \"\", city: \"\", steps: [Time(hour: {text}), Look(at: {text})])"), "a.tour.ron");
    }
}
