//! A tour's header and steps as RON values, in the order in which they are written.

use std::collections::BTreeMap;

use crate::{Ease, LookAt, Step, Tour, Where};

/// A RON value as far as tours have them.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    /// What an optional field has if it is not told.
    Nothing,
    Number(f64),
    Text(String),
    Word(&'static str),
    /// Fields, after a name that may be empty.
    Struct(&'static str, Vec<Field>),
    /// Values without names, after a name that may be empty.
    Tuple(&'static str, Vec<Value>),
    List(Vec<Value>),
    Map(BTreeMap<String, String>),
}

/// A field of a struct.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Field {
    pub key: &'static str,
    pub value: Value,
    /// Whether it is written; what a reader would take for it anyway is not.
    pub is_told: bool,
}

impl Value {
    /// Whether a field of this value is rather left out than written.
    pub fn is_empty(&self) -> bool {
        match self {
            Self::Nothing => true,
            Self::List(items) => items.is_empty(),
            Self::Map(entries) => entries.is_empty(),
            _ => false,
        }
    }
}

const fn told(key: &'static str, value: Value) -> Field {
    Field { key, value, is_told: true }
}

fn unless(key: &'static str, value: Value, default: &Value) -> Field {
    let is_told = value != *default;
    Field { key, value, is_told }
}

fn optional(key: &'static str, number: Option<f64>) -> Field {
    unless(key, number.map_or(Value::Nothing, Value::Number), &Value::Nothing)
}

fn translated(translations: &BTreeMap<String, String>) -> Field {
    by_language("translations", translations)
}

fn by_language(key: &'static str, entries: &BTreeMap<String, String>) -> Field {
    Field { key, value: Value::Map(entries.clone()), is_told: !entries.is_empty() }
}

fn number(key: &'static str, value: f64) -> Field {
    told(key, Value::Number(value))
}

fn text(key: &'static str, value: &str) -> Field {
    told(key, Value::Text(value.to_owned()))
}

/// What stands before a tour's steps.
pub(super) fn header(tour: &Tour) -> Vec<Field> {
    let Tour { title, translations, city, speed, eye_m, fov_deg, hour, day, steps: _ } = tour;
    vec![
        text("title", title),
        translated(translations),
        text("city", city),
        // What a person who opens the file will want to change first is told though it were the default.
        number("speed", *speed),
        unless("eye_m", Value::Number(*eye_m), &Value::Number(Tour::default_eye_m())),
        number("fov_deg", *fov_deg),
        number("hour", *hour),
        unless("day", Value::Number(f64::from(*day)), &Value::Number(f64::from(Tour::default_day()))),
    ]
}

fn place(at: &Where) -> Value {
    match at {
        Where::Place(name) => Value::Tuple("Place", vec![Value::Text(name.clone())]),
        Where::At(x, y) => Value::Tuple("At", vec![Value::Number(*x), Value::Number(*y)]),
    }
}

fn gaze(look: &LookAt) -> Value {
    match look {
        LookAt::Ahead => Value::Word("Ahead"),
        LookAt::Spot { at, height_m, follow } => {
            let height_m = unless("height_m", Value::Number(*height_m), &Value::Number(Tour::default_eye_m()));
            let follow = follow.clone().map_or(Value::Nothing, Value::Text);
            Value::Struct("Spot", vec![told("at", place(at)), height_m, unless("follow", follow, &Value::Nothing)])
        }
        LookAt::Heading { deg, pitch_deg } => {
            let pitch = unless("pitch_deg", Value::Number(*pitch_deg), &Value::Number(0.0));
            Value::Struct("Heading", vec![number("deg", *deg), pitch])
        }
    }
}

fn look(look: &LookAt) -> Field {
    unless("look", gaze(look), &Value::Word("Ahead"))
}

fn ease(ease: Ease) -> Field {
    let word = match ease {
        Ease::InOut => "InOut",
        Ease::In => "In",
        Ease::Out => "Out",
        Ease::Linear => "Linear",
    };
    unless("ease", Value::Word(word), &Value::Word("InOut"))
}

/// The seconds that a change takes, at once if not told.
fn within(seconds: f64) -> Field {
    unless("seconds", Value::Number(seconds), &Value::Number(0.0))
}

/// A step.
pub(super) fn step(step: &Step) -> Value {
    let (name, fields) = match step {
        Step::Start { at, eye_m, look: gaze } => ("Start", vec![told("at", place(at)), optional("eye_m", *eye_m), look(gaze)]),
        Step::Walk { to, via, speed, look: gaze, ease: how } => {
            let via = unless("via", Value::List(via.iter().map(place).collect()), &Value::List(Vec::new()));
            ("Walk", vec![told("to", place(to)), via, optional("speed", *speed), look(gaze), ease(*how)])
        }
        Step::Fly { through, speed, look: gaze, ease: how } => {
            let point = |&(x, y, z): &(f64, f64, f64)| Value::Tuple("", [x, y, z].map(Value::Number).to_vec());
            let through = Value::List(through.iter().map(point).collect());
            ("Fly", vec![told("through", through), number("speed", *speed), look(gaze), ease(*how)])
        }
        Step::Track { keys } => {
            let key = |&(s, x, y, z, heading, pitch): &(f64, f64, f64, f64, f64, f64)| {
                Value::Tuple("", [s, x, y, z, heading, pitch].map(Value::Number).to_vec())
            };
            ("Track", vec![told("keys", Value::List(keys.iter().map(key).collect()))])
        }
        Step::Look { at, seconds } => ("Look", vec![told("at", gaze(at)), number("seconds", *seconds)]),
        Step::Wait { seconds } => ("Wait", vec![number("seconds", *seconds)]),
        Step::Say { text: words, translations, seconds } => {
            ("Say", vec![text("text", words), translated(translations), optional("seconds", *seconds)])
        }
        Step::Narrate { file, files, text: words, translations, seconds } => {
            let files = by_language("files", files);
            let seconds = optional("seconds", *seconds);
            ("Narrate", vec![text("file", file), files, text("text", words), translated(translations), seconds])
        }
        Step::Sound { file } => {
            let file = file.clone().map_or(Value::Nothing, Value::Text);
            ("Sound", vec![unless("file", file, &Value::Nothing)])
        }
        Step::Picture { file, caption, translations, seconds } => {
            let caption = unless("caption", Value::Text(caption.clone()), &Value::Text(String::new()));
            ("Picture", vec![text("file", file), caption, translated(translations), number("seconds", *seconds)])
        }
        Step::Chapter { title, translations } => ("Chapter", vec![text("title", title), translated(translations)]),
        Step::Mark { name } => ("Mark", vec![text("name", name)]),
        Step::Rain { wet, seconds } => ("Rain", vec![number("wet", *wet), within(*seconds)]),
        Step::Fov { deg, seconds } => ("Fov", vec![number("deg", *deg), within(*seconds)]),
        Step::Time { hour, seconds } => ("Time", vec![number("hour", *hour), within(*seconds)]),
        Step::Cut { to, eye_m, look: gaze, seconds } => {
            let seconds = unless("seconds", Value::Number(*seconds), &Value::Number(Step::default_fade_s()));
            ("Cut", vec![told("to", place(to)), optional("eye_m", *eye_m), look(gaze), seconds])
        }
    };
    Value::Struct(name, fields)
}
