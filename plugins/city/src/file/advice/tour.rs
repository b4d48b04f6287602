//! What tours are made of, for advice: the steps with their fields, and what each field wants.

use super::around::Around;

/// What a field wants.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wanted {
    Number,
    Text,
    /// `Place("…")` or `At(x, y)`.
    Spot,
    /// `Ahead`, `Spot(…)` or `Heading(…)`.
    Gaze,
    Ease,
    /// A list or pairs.
    Many,
}

use Wanted::{Ease, Gaze, Many, Number, Spot, Text};

/// A step, or what a tour has in round brackets besides, with its fields: the one that matters most is the first.
pub(super) struct Made {
    pub name: &'static str,
    pub fields: &'static [(&'static str, Wanted)],
    /// How it is written, with what must be given.
    pub example: &'static str,
}

pub(super) const MADE: [Made; 18] = [
    made("Start", &[("at", Spot), ("eye_m", Number), ("look", Gaze)], "Start(at: Place(\"…\"))"),
    made("Walk", &[("to", Spot), ("via", Many), ("speed", Number), ("look", Gaze), ("ease", Ease)], "Walk(to: Place(\"…\"))"),
    made(
        "Fly",
        &[("through", Many), ("speed", Number), ("look", Gaze), ("ease", Ease)],
        "Fly(through: [(12.5, -3, 20)], speed: 9)",
    ),
    made("Track", &[("keys", Many)], "Track(keys: [(2, 12.5, -3, 1.65, 90, 0)])"),
    made("Look", &[("at", Gaze), ("seconds", Number)], "Look(at: Heading(deg: 90), seconds: 2)"),
    made("Wait", &[("seconds", Number)], "Wait(seconds: 3)"),
    made("Say", &[("text", Text), ("translations", Many), ("seconds", Number)], "Say(text: \"…\")"),
    made(
        "Narrate",
        &[("file", Text), ("files", Many), ("text", Text), ("translations", Many), ("seconds", Number)],
        "Narrate(file: \"….ogg\", text: \"…\")",
    ),
    made("Sound", &[("file", Text)], "Sound(file: \"….ogg\")"),
    made(
        "Picture",
        &[("file", Text), ("caption", Text), ("translations", Many), ("seconds", Number)],
        "Picture(file: \"….jpg\", seconds: 8)",
    ),
    made("Chapter", &[("title", Text), ("translations", Many)], "Chapter(title: \"…\")"),
    made("Mark", &[("name", Text)], "Mark(name: \"…\")"),
    made("Rain", &[("wet", Number), ("seconds", Number)], "Rain(wet: 1, seconds: 10)"),
    made("Fov", &[("deg", Number), ("seconds", Number)], "Fov(deg: 60, seconds: 2)"),
    made("Time", &[("hour", Number), ("seconds", Number)], "Time(hour: 17.5, seconds: 20)"),
    made("Cut", &[("to", Spot), ("eye_m", Number), ("look", Gaze), ("seconds", Number)], "Cut(to: Place(\"…\"))"),
    made("Spot", &[("at", Spot), ("height_m", Number), ("follow", Text)], "Spot(at: Place(\"…\"))"),
    made("Heading", &[("deg", Number), ("pitch_deg", Number)], "Heading(deg: 90)"),
];

const fn made(name: &'static str, fields: &'static [(&'static str, Wanted)], example: &'static str) -> Made {
    Made { name, fields, example }
}

pub(super) fn of(name: &str) -> Option<&'static Made> {
    MADE.iter().find(|made| made.name == name)
}

/// What a tour's value wants that stands here, if it is known.
pub(super) fn wanted(here: &Around<'_>) -> Option<Wanted> {
    match here.name() {
        "via" if here.bracket() == Some('[') => Some(Spot),
        name => of(name)?.fields.iter().find(|(field, _)| *field == here.field).map(|(_, wanted)| *wanted),
    }
}

/// Whether one is in a list of steps.
pub(super) fn is_step(here: &Around<'_>) -> bool {
    here.bracket() == Some('[') && here.name() == "steps"
}

/// A value that stands without its field's name: how it is written with it.
pub(super) fn named(here: &Around<'_>) -> Option<String> {
    let made = of(here.name()).filter(|_| here.bracket() == Some('(') && here.field.is_empty() && here.is_first())?;
    let &(field, wanted) = made.fields.first()?;
    let thing = here.thing();
    let is_number = thing.parse::<f64>().is_ok();
    let meant = match wanted {
        Number if is_number => format!("{}({field}: {thing})", made.name),
        Text if is_text(thing) => format!("{}({field}: {thing})", made.name),
        Spot if is_text(thing) => format!("{}({field}: Place({thing}))", made.name),
        Spot if is_number => format!("{}({field}: At(12.5, -3))", made.name),
        _ => made.example.to_owned(),
    };
    // What else must be given.
    let more = match made.name {
        "Picture" if meant != made.example => ", seconds: 8)",
        "Narrate" if meant != made.example => ", text: \"…\")",
        _ => ")",
    };
    let meant = format!("{}{more}", meant.strip_suffix(')').unwrap_or(&meant));
    Some(format!("every value of `{}` stands after its field's name: write `{meant}`", made.name))
}

fn is_text(thing: &str) -> bool {
    thing.len() > 1 && thing.starts_with('"') && thing.ends_with('"')
}

/// How a spot or a direction of view is written that stands here as something else.
pub(super) fn spelled(here: &Around<'_>) -> Option<String> {
    let wanted = wanted(here)?;
    let thing = here.thing();
    let word = thing.trim_matches('"');
    match wanted {
        Gaze if word == "Ahead" => Some("`Ahead` stands without quotation marks".to_owned()),
        Gaze if is_text(thing) => Some(format!("where to look is written `Spot(at: Place({thing}))`")),
        Gaze if thing.parse::<f64>().is_ok() => Some(format!("a direction in degrees is written `Heading(deg: {thing})`")),
        Gaze if thing.starts_with('(') => Some(format!("where to look is written `Spot(at: At{thing})`")),
        Ease if is_text(thing) => Some(format!("`{word}` stands without quotation marks")),
        Spot if is_text(thing) => Some(format!("a place is written `Place({thing})`")),
        Spot if thing.starts_with('(') && !thing.contains(':') => Some(format!("a spot in metres is written `At{thing}`")),
        Spot if thing.parse::<f64>().is_ok() => {
            Some("a spot in metres is written `At(12.5, -3)`, x to the east and y to the north".to_owned())
        }
        _ => None,
    }
}

/// The field of what encloses the innermost bracket, if a name is known there and not here.
pub(super) fn belongs_outside<'a>(here: &Around<'a>, field: &str) -> Option<(&'a str, &'a str)> {
    let (inner, outer) = here.open.split_last()?;
    let around =
        outer.iter().rev().find(|open| of(open.name).is_some_and(|made| made.fields.iter().any(|(known, _)| *known == field)))?;
    (inner.bracket == '(').then_some((inner.name, around.name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LookAt, Step, Tour};

    /// The names that a reader's message tells between back quotes after `here`.
    fn known(message: &str) -> Vec<String> {
        let list = message.split_once(" here").expect(message).0.len();
        message[list..].split('`').skip(1).step_by(2).map(str::to_owned).collect()
    }

    #[test]
    fn what_is_known_of_steps_is_what_the_reader_knows() {
        let told = |text: &str| crate::file::parse::<Step>(text, "x").expect_err(text).message;
        let steps = known(&told("Zzzzzzzzz()"));
        let ours: Vec<&str> = MADE.iter().map(|made| made.name).filter(|name| !["Spot", "Heading"].contains(name)).collect();
        assert_eq!(steps, ours);
        for made in &MADE {
            let text = format!("{}(zzzzzzzzz: 1)", made.name);
            let message = match made.name {
                "Spot" | "Heading" => crate::file::parse::<LookAt>(&text, "x").expect_err(&text).message,
                _ => told(&text),
            };
            let (mut fields, mut ours) = (known(&message), made.fields.iter().map(|field| field.0.to_owned()).collect::<Vec<_>>());
            fields.sort();
            ours.sort();
            assert_eq!(fields, ours, "{}: {message}", made.name);
        }
    }

    #[test]
    fn examples_are_what_the_reader_takes() {
        for made in MADE.iter().filter(|made| !["Spot", "Heading"].contains(&made.name)) {
            let text = format!("(title: \"\", city: \"\", steps: [{}])", made.example);
            assert!(crate::file::parse::<Tour>(&text, "x").is_ok(), "{text}");
        }
    }
}
