use std::path::Path;

use proptest::{prelude::*, sample::Index};

use super::*;
use crate::{Ease, LookAt, Where};

fn read(text: &str) -> TourText {
    TourText::parse(text, "t").unwrap_or_else(|e| panic!("{e}"))
}

fn sample(name: &str) -> TourText {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/old_prague").join(name);
    TourText::read(&path).unwrap_or_else(|e| panic!("{e}"))
}

const SAMPLES: [&str; 3] = ["royal_route.tour.ron", "royal_route_long.tour.ron", "to_the_clock.tour.ron"];

/// A text without its comments and blank lines.
fn bare(text: &str) -> String {
    let mut bare = text.to_owned();
    for comment in syntax::comments(text, 0..text.len()).into_iter().rev() {
        bare.replace_range(comment, "");
    }
    bare.lines().map(str::trim_end).filter(|line| !line.is_empty()).map(|line| format!("{line}\n")).collect()
}

#[test]
fn a_tour_is_written_as_the_sample_tours_are() {
    for name in SAMPLES {
        let tour = sample(name);
        let written = TourText::new(tour.tour()).expect("plain numbers");
        // Where a person wrote otherwise than the writer: a decimal that says nothing, and what is taken for granted.
        let by_hand = bare(tour.text()).replace("speed: 2.0", "speed: 2").replace(", look: Ahead", "").replace("1.6,   ", "1.6,");
        assert_eq!(written.text(), by_hand, "{name}");
    }
}

#[test]
fn a_step_that_stays_as_it_is_stays_byte_for_byte() {
    for name in SAMPLES {
        let mut tour = sample(name);
        let before = tour.text().to_owned();
        for (i, step) in tour.tour().steps.clone().iter().enumerate() {
            tour.replace(i, step).expect("its own step");
        }
        let own = tour.tour().clone();
        for setting in [TourSetting::Title(own.title), TourSetting::Translations(own.translations), TourSetting::Speed(own.speed)] {
            tour.set(setting).expect("its own setting");
        }
        assert_eq!(tour.text(), before, "{name}");
    }
}

#[test]
fn what_is_changed_in_a_step_is_all_that_is_written_anew() {
    let mut tour = read(
        "(title: \"x\", city: \"y\", steps: [
    Start(
        at: At(0, 0.0), // where we stand
        look : Ahead /* on */,
    ),
    Fly(through: [(1, 2, 3), /* up */ (4, 5, 6)], speed: 9.0),
])",
    );
    let look = LookAt::Heading { deg: 90.0, pitch_deg: 0.0 };
    tour.replace(0, &Step::Start { at: Where::At(0.0, 0.0), eye_m: Some(2.0), look }).expect("a step");
    let through = vec![(1.0, 2.0, 3.0), (4.0, 5.0, 7.0), (0.5, 0.0, 0.0)];
    tour.replace(1, &Step::Fly { through, speed: 9.0, look: LookAt::Ahead, ease: Ease::InOut }).expect("a step");
    assert_eq!(
        tour.text(),
        "(title: \"x\", city: \"y\", steps: [
    Start(
        at: At(0, 0.0), // where we stand
        eye_m: 2,
        look : Heading(deg: 90) /* on */,
    ),
    Fly(through: [(1, 2, 3), /* up */ (4, 5, 7), (0.5, 0, 0)], speed: 9.0),
])"
    );
}

#[test]
fn a_step_of_another_kind_keeps_the_comments_of_the_one_before() {
    let mut tour =
        read("(title: \"x\", city: \"y\", steps: [\n  // a\n  Walk(to: At(1, 1), // there\n    speed: 2), // b\n\n  // c\n])");
    tour.replace(0, &Step::Wait { seconds: 3.0 }).expect("a step");
    assert_eq!(tour.text(), "(title: \"x\", city: \"y\", steps: [\n  // a\n  // there\n  Wait(seconds: 3), // b\n\n  // c\n])");
}

#[test]
fn a_step_is_moved_with_its_comments() {
    let mut tour = read(
        "(title: \"x\", city: \"y\", steps: [ // list
    Start(at: At(0, 0)),

    // first
    /* of two */
    Wait(seconds: 1), // short

    // alone

    // second
    Wait(seconds: 2) // long
  ])",
    );
    tour.move_step(2, 0).expect("there are three");
    let moved = "(title: \"x\", city: \"y\", steps: [ // list
    // second
    Wait(seconds: 2), // long
    Start(at: At(0, 0)),

    // first
    /* of two */
    Wait(seconds: 1), // short

    // alone
  ])";
    assert_eq!(tour.text(), moved);
    let taken = tour.remove(2).expect("there are three");
    assert_eq!(taken, "    // first\n    /* of two */\n    Wait(seconds: 1), // short\n");
    tour.insert_text(2, &taken).expect("what was taken out");
    assert_eq!(tour.tour().steps[2], Step::Wait { seconds: 1.0 });
    assert!(tour.text().contains("    // alone\n"), "{}", tour.text());
}

#[test]
fn steps_of_one_line_and_lines_that_end_as_elsewhere_are_edited_too() {
    let mut tour = read("\u{feff}(title: \"x\", city: \"y\", steps: [Start(at: At(0, 0)), Wait(seconds: 1)])\r\n");
    tour.insert(1, &[Step::Wait { seconds: 9.0 }]).expect("a step");
    assert_eq!(
        tour.text(),
        "\u{feff}(title: \"x\", city: \"y\", steps: [Start(at: At(0, 0)),\r\n  Wait(seconds: 9),\r\n  Wait(seconds: 1)])\r\n"
    );
    assert_eq!(&tour.text()[tour.step_span(1).expect("three steps")], "Wait(seconds: 9)");
    let mut none = read("(title: \"x\", city: \"y\", steps: [])");
    none.insert(0, &[Step::Wait { seconds: 9.0 }]).expect("a step");
    assert_eq!(none.text(), "(title: \"x\", city: \"y\", steps: [\n  Wait(seconds: 9),\n])");
}

#[test]
fn settings_come_change_and_go() {
    let mut tour = sample("royal_route.tour.ron");
    let before = tour.text().to_owned();
    tour.set(TourSetting::Day(200)).expect("a day");
    assert_eq!(tour.text(), before.replacen("  hour: 9,\n", "  hour: 9,\n  day: 200,\n", 1));
    tour.set(TourSetting::Translations(BTreeMap::new())).expect("none");
    tour.set(TourSetting::Title("“Way” \\ \"Cesta\"\n".to_owned())).expect("a title");
    assert!(tour.text().contains("  title: \"“Way” \\\\ \\\"Cesta\\\"\\n\",\n  city:"), "{}", tour.text());
}

#[test]
fn what_cannot_be_done_leaves_the_text() {
    let mut tour = sample("to_the_clock.tour.ron");
    let before = tour.clone();
    assert_eq!(tour.set(TourSetting::Speed(f64::NAN)), Err(TourEditError::Unwritable));
    assert_eq!(tour.remove(99), Err(TourEditError::NoStep { index: 99, steps: 13 }));
    assert_eq!(tour.insert_text(0, "Wait(seconds: 1)"), Err(TourEditError::Unwritable));
    assert_eq!(tour.insert_text(0, "Wait(seconds: 1), // x"), Err(TourEditError::Unwritable));
    assert_eq!(tour, before);
}

#[test]
fn a_mistake_shows_where_its_step_stands() {
    let tour = sample("to_the_clock.tour.ron");
    let shown = tour.mistake(Some(2), "a.tour.ron", "too far".to_owned()).to_string();
    assert!(shown.starts_with("a.tour.ron:12:5: too far\n12 |     Walk(to: At(58, 2.4)),"), "{shown}");
    let shown = tour.setting_mistake("speed", "a.tour.ron", "too fast".to_owned()).to_string();
    assert!(shown.starts_with("a.tour.ron:5:3: too fast\n"), "{shown}");
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![(-400i32..400).prop_map(f64::from), -1e6..1e6, Just(1e-9), Just(1e21)]
}

/// Numbers of which six have room on a line.
fn short() -> impl Strategy<Value = f64> {
    (-400_000i32..400_000).prop_map(|thousandths| f64::from(thousandths) / 1000.0)
}

fn words() -> impl Strategy<Value = String> {
    prop_oneof!["[a-zé“\"\\\\\n\t/*,()\\[\\]{}#:' \u{2028}]{0,12}", "[a-z ]{100,150}"]
}

fn translations() -> impl Strategy<Value = BTreeMap<String, String>> {
    proptest::collection::btree_map("cs|it|d\"e", words(), 0..3)
}

fn spot() -> impl Strategy<Value = Where> {
    prop_oneof![words().prop_map(Where::Place), (number(), number()).prop_map(|(x, y)| Where::At(x, y))]
}

fn look() -> impl Strategy<Value = LookAt> {
    prop_oneof![
        Just(LookAt::Ahead),
        (spot(), prop_oneof![Just(1.65), number()], proptest::option::of(words()))
            .prop_map(|(at, height_m, follow)| LookAt::Spot { at, height_m, follow }),
        (number(), prop_oneof![Just(0.0), number()]).prop_map(|(deg, pitch_deg)| LookAt::Heading { deg, pitch_deg }),
    ]
}

fn ease() -> impl Strategy<Value = Ease> {
    prop_oneof![Just(Ease::InOut), Just(Ease::Linear), Just(Ease::In), Just(Ease::Out)]
}

fn step() -> impl Strategy<Value = Step> {
    let maybe = || proptest::option::of(number());
    prop_oneof![
        (spot(), maybe(), look()).prop_map(|(at, eye_m, look)| Step::Start { at, eye_m, look }),
        (spot(), proptest::collection::vec(spot(), 0..4), maybe(), look(), ease())
            .prop_map(|(to, via, speed, look, ease)| Step::Walk { to, via, speed, look, ease }),
        (proptest::collection::vec((number(), number(), number()), 0..12), number(), look(), ease())
            .prop_map(|(through, speed, look, ease)| Step::Fly { through, speed, look, ease }),
        proptest::collection::vec((short(), short(), short(), short(), short(), short()), 0..6)
            .prop_map(|keys| Step::Track { keys }),
        (look(), number()).prop_map(|(at, seconds)| Step::Look { at, seconds }),
        number().prop_map(|seconds| Step::Wait { seconds }),
        (words(), translations(), maybe()).prop_map(|(text, translations, seconds)| Step::Say { text, translations, seconds }),
        (words(), translations(), words(), translations(), maybe())
            .prop_map(|(file, files, text, translations, seconds)| Step::Narrate { file, files, text, translations, seconds }),
        proptest::option::of(words()).prop_map(|file| Step::Sound { file }),
        (words(), words(), translations(), number()).prop_map(|(file, caption, translations, seconds)| Step::Picture {
            file,
            caption,
            translations,
            seconds
        }),
        (words(), translations()).prop_map(|(title, translations)| Step::Chapter { title, translations }),
        words().prop_map(|name| Step::Mark { name }),
        (number(), number()).prop_map(|(wet, seconds)| Step::Rain { wet, seconds }),
        (number(), number()).prop_map(|(deg, seconds)| Step::Fov { deg, seconds }),
        (number(), number()).prop_map(|(hour, seconds)| Step::Time { hour, seconds }),
        (spot(), maybe(), look(), number()).prop_map(|(to, eye_m, look, seconds)| Step::Cut { to, eye_m, look, seconds }),
    ]
}

fn tour() -> impl Strategy<Value = Tour> {
    let steps = proptest::collection::vec(step(), 0..7);
    (words(), translations(), words(), [number(), number(), number(), number()], 0u16..400, steps).prop_map(
        |(title, translations, city, [speed, eye_m, fov_deg, hour], day, steps)| Tour {
            title,
            translations,
            city,
            speed,
            eye_m,
            fov_deg,
            hour,
            day,
            steps,
        },
    )
}

#[derive(Debug, Clone)]
enum Edit {
    Set(TourSetting),
    Insert(Index, Vec<Step>),
    Replace(Index, Step),
    /// Another step of the same kind, as an editor makes it.
    Touch(Index, f64),
    Remove(Index),
    Move(Index, Index),
}

fn setting() -> impl Strategy<Value = TourSetting> {
    prop_oneof![
        words().prop_map(TourSetting::Title),
        translations().prop_map(TourSetting::Translations),
        words().prop_map(TourSetting::City),
        number().prop_map(TourSetting::Speed),
        number().prop_map(TourSetting::EyeM),
        number().prop_map(TourSetting::FovDeg),
        number().prop_map(TourSetting::Hour),
        (0u16..400).prop_map(TourSetting::Day),
    ]
}

fn edit() -> impl Strategy<Value = Edit> {
    let any = || any::<Index>();
    prop_oneof![
        setting().prop_map(Edit::Set),
        (any(), proptest::collection::vec(step(), 0..3)).prop_map(|(at, steps)| Edit::Insert(at, steps)),
        (any(), step()).prop_map(|(at, step)| Edit::Replace(at, step)),
        (any(), number()).prop_map(|(at, number)| Edit::Touch(at, number)),
        any().prop_map(Edit::Remove),
        (any(), any()).prop_map(|(from, to)| Edit::Move(from, to)),
    ]
}

/// A step of the same kind with something else in it.
fn touched(step: &Step, number: f64) -> Step {
    let mut step = step.clone();
    match &mut step {
        Step::Start { eye_m, look, .. } | Step::Cut { eye_m, look, .. } => {
            *eye_m = eye_m.is_none().then_some(number);
            *look = LookAt::Heading { deg: number, pitch_deg: 1.0 };
        }
        Step::Walk { via, speed, ease, .. } => {
            (*speed, *ease) = (speed.is_none().then_some(number), Ease::Linear);
            if via.pop().is_none() {
                via.push(Where::At(number, 0.0));
            }
        }
        Step::Fly { through, .. } => through.insert(through.len() / 2, (number, number, 1.0)),
        Step::Track { keys } => keys.extend([(number, 0.0, 1.0, 2.0, 3.0, 4.0)]),
        Step::Look { seconds, .. } | Step::Wait { seconds } | Step::Rain { seconds, .. } => *seconds = number,
        Step::Fov { seconds, .. } | Step::Time { seconds, .. } => *seconds = 0.0,
        Step::Say { translations, seconds, .. } => {
            translations.insert("fr".to_owned(), "mot".to_owned());
            *seconds = None;
        }
        Step::Narrate { files, seconds, .. } => {
            files.insert("fr".to_owned(), "mot.ogg".to_owned());
            *seconds = Some(number);
        }
        Step::Sound { file } => *file = file.take().xor(Some("river.ogg".to_owned())),
        Step::Picture { caption, seconds, .. } => {
            caption.clear();
            *seconds = number;
        }
        Step::Chapter { translations, .. } => {
            translations.pop_first();
        }
        Step::Mark { name } => name.push('x'),
    }
    step
}

/// What may be written between the signs of a text.
const BETWEEN: [&str; 9] = ["", "", "", " ", "\n", "\n\n", " // c%\n", " /* c% /* ( */ */ ", "\n\n    // c%\n    /* c%b */\n"];

/// A text with comments and white space strewn in, and some commas left out; the comments are told from one another.
fn strewn(text: &str, between: &[usize], newline: &str) -> String {
    let (mut strewn, mut in_string, mut is_escaped, mut at) = (String::new(), false, false, 0);
    for (i, c) in text.char_indices() {
        let ends_group = c == ',' && text[i + 1..].trim_start().starts_with([')', ']', '}']) && !in_string;
        if !(ends_group && between[at % between.len()] % 2 == 1) {
            strewn.push(c);
        }
        match c {
            '"' if !is_escaped => in_string = !in_string,
            ',' | ':' | '(' | ')' | '[' | ']' | '{' | '}' if !in_string => {
                at += 1;
                strewn.push_str(&BETWEEN[between[at % between.len()] % BETWEEN.len()].replace('%', &at.to_string()));
            }
            _ => {}
        }
        is_escaped = in_string && c == '\\' && !is_escaped;
    }
    strewn.replace('\n', newline)
}

fn all_comments(text: &str) -> Vec<&str> {
    // What ends a line is no part of a comment.
    let mut found: Vec<&str> = syntax::comments(text, 0..text.len()).into_iter().map(|range| text[range].trim_end()).collect();
    found.sort_unstable();
    found
}

fn step_texts(tour: &TourText) -> Vec<String> {
    (0..tour.tour().steps.len()).filter_map(|i| Some(tour.text()[tour.step_span(i)?].to_owned())).collect()
}

/// Makes an edit in the text, and in a tour and the texts of its steps; says what was taken out of the text.
fn make(edit: Edit, text: &mut TourText, tour: &mut Tour, texts: &mut Vec<Option<String>>) -> Option<String> {
    let many = tour.steps.len();
    match edit {
        Edit::Set(setting) => {
            text.set(setting.clone()).expect("plain values");
            setting.put(tour);
        }
        Edit::Insert(at, steps) => {
            let at = at.index(many + 1);
            text.insert(at, &steps).expect("plain values");
            texts.splice(at..at, steps.iter().map(|_| None));
            tour.steps.splice(at..at, steps);
        }
        _ if many == 0 => {}
        Edit::Replace(at, step) => {
            let at = at.index(many);
            text.replace(at, &step).expect("plain values");
            (tour.steps[at], texts[at]) = (step, None);
        }
        Edit::Touch(at, number) => {
            let at = at.index(many);
            let step = touched(&tour.steps[at], number);
            text.replace(at, &step).expect("plain values");
            (tour.steps[at], texts[at]) = (step, None);
        }
        Edit::Remove(at) => {
            let at = at.index(many);
            tour.steps.remove(at);
            texts.remove(at);
            return Some(text.remove(at).expect("it is there"));
        }
        Edit::Move(from, to) => {
            let (from, to) = (from.index(many), to.index(many));
            text.move_step(from, to).expect("both are there");
            let step = tour.steps.remove(from);
            tour.steps.insert(to, step);
            let step = texts.remove(from);
            texts.insert(to, step);
        }
    }
    None
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn a_tour_that_is_written_is_read_again(tour in tour()) {
        let text = TourText::new(&tour).expect("plain values");
        prop_assert_eq!(text.tour(), &tour);
        let longest = text.text().lines().filter(|line| !line.contains('"')).map(|line| line.chars().count()).max();
        prop_assert!(longest <= Some(130), "{}", text.text());
    }

    #[test]
    fn edits_change_what_they_name_and_nothing_else(
        tour in tour(),
        between in proptest::collection::vec(0usize..18, 1..60),
        edits in proptest::collection::vec(edit(), 1..6),
        has_returns in any::<bool>(),
    ) {
        let written = TourText::new(&tour).expect("plain values");
        let strewn = strewn(written.text(), &between, if has_returns { "\r\n" } else { "\n" });
        let mut text = TourText::parse(&strewn, "t").map_err(|e| TestCaseError::fail(format!("{e}\n{strewn}")))?;
        let mut tour = tour;
        prop_assert_eq!(text.tour(), &tour);
        for edit in edits {
            let mut texts: Vec<Option<String>> = step_texts(&text).into_iter().map(Some).collect();
            let before = text.clone();
            let told = format!("{edit:?}");
            let taken = make(edit, &mut text, &mut tour, &mut texts);
            prop_assert_eq!(text.tour(), &tour);
            for (is, was) in step_texts(&text).iter().zip(&texts) {
                prop_assert!(was.as_ref().is_none_or(|was| is == was), "{is} was {was:?} before {told}\n{}", before.text());
            }
            let now = format!("{}\n{}", text.text(), taken.unwrap_or_default());
            prop_assert_eq!(all_comments(before.text()), all_comments(&now), "{}\n{}\n---\n{}", told, before.text(), text.text());
            if has_returns {
                prop_assert!(!text.text().replace("\r\n", "").contains('\n'), "{}", text.text());
            }
        }
    }

    #[test]
    fn what_the_reader_takes_is_taken_here_and_nothing_else(
        tour in tour(),
        between in proptest::collection::vec(0usize..18, 1..60),
        at in any::<Index>(),
        with in "[\\[({:,\"'/*# \\\\rb\nx5é\\])}]{0,3}",
        gone in 0usize..3,
    ) {
        let written = TourText::new(&tour).expect("plain values");
        let mut text: Vec<char> = strewn(written.text(), &between, "\n").chars().collect();
        let at = at.index(text.len());
        let end = (at + gone).min(text.len());
        text.splice(at..end, with.chars());
        let text: String = text.into_iter().collect();
        let read = file::parse_bytes::<Tour>(text.as_bytes(), "t");
        let taken = TourText::parse(&text, "t");
        prop_assert_eq!(read, taken.map(|text| text.tour().clone()));
    }
}
