//! What a step is called in lists.

use veduta_city::{LookAt, Step, Where};
use veduta_ecs::WordsValue;
use veduta_route::StepKind;

use super::bench::{Bench, kind_name};

/// Places so near give a spot its name, metres.
const NEAR_M: f64 = 60.0;
/// So many letters of a text stand in a list.
const LETTERS: usize = 48;

/// A step in a few words: what it does, and where or what.
pub(super) fn of(bench: &Bench<'_>, step: &Step) -> String {
    let about = about(bench, step);
    let kind = bench.say(kind_name(StepKind::of(step)));
    if about.is_empty() { kind } else { format!("{kind} · {about}") }
}

/// How many key frames a recorded camera has.
pub(super) fn key_frames(bench: &Bench<'_>, count: usize) -> String {
    bench.words.say_with("track-keys", &[("count", WordsValue::from(count))])
}

fn about(bench: &Bench<'_>, step: &Step) -> String {
    let number = |value: f64, digits: usize, unit: &str| format!("{} {}", bench.words.number(value, digits), bench.say(unit));
    match step {
        Step::Start { at, .. } => place(bench, at),
        Step::Walk { to, .. } | Step::Cut { to, .. } => place(bench, to),
        Step::Fly { through, .. } => through.last().map_or_else(String::new, |&(x, y, height)| {
            format!("{}, {}", place(bench, &Where::At(x, y)), number(height, 0, "unit-m"))
        }),
        Step::Track { keys } => key_frames(bench, keys.len()),
        Step::Look { at, .. } => look(bench, at),
        Step::Wait { .. } => String::new(),
        Step::Say { text, .. } | Step::Narrate { text, .. } => format!("“{}”", short(text)),
        Step::Sound { file } => short(file.as_deref().unwrap_or("–")),
        Step::Picture { file, .. } => short(file),
        Step::Chapter { title, .. } => short(title),
        Step::Mark { name, .. } => short(name),
        Step::Rain { wet, .. } => format!("{} %", bench.words.number(wet * 100.0, 0)),
        Step::Fov { deg, .. } => number(*deg, 0, "unit-deg"),
        Step::Time { hour, .. } => clock(*hour),
    }
}

/// Hours and minutes.
pub(super) fn clock(hour: f64) -> String {
    let minutes = (hour.clamp(0.0, 24.0) * 60.0).round() as u32;
    format!("{}:{:02}", minutes / 60, minutes % 60)
}

/// Minutes, seconds and tenths.
pub(super) fn time(t_s: f64) -> String {
    let tenths = (t_s.max(0.0) * 10.0).round() as u64;
    format!("{}:{:02}.{}", tenths / 600, tenths / 10 % 60, tenths % 10)
}

fn short(text: &str) -> String {
    let line: String = text.split_whitespace().collect::<Vec<_>>().join(" ");
    if line.chars().count() <= LETTERS { line } else { line.chars().take(LETTERS - 1).chain(['…']).collect() }
}

/// A spot by its name, by what is near, or by its numbers.
fn place(bench: &Bench<'_>, at: &Where) -> String {
    match at {
        Where::Place(name) => bench.names.of(name).to_owned(),
        Where::At(x, y) => {
            let near = bench.streets.and_then(|streets| streets.places.nearest((*x, *y).into(), NEAR_M));
            match near {
                Some((name, _)) => {
                    let name = bench.names.of(name).to_owned();
                    bench.words.say_with("where-near", &[("name", name.into())])
                }
                None => format!("{}; {}", bench.words.number(*x, 0), bench.words.number(*y, 0)),
            }
        }
    }
}

fn look(bench: &Bench<'_>, at: &LookAt) -> String {
    match at {
        LookAt::Ahead => bench.say("look-ahead"),
        LookAt::Spot { at, .. } => place(bench, at),
        LookAt::Heading { deg, .. } => {
            // Eight winds, from north clockwise.
            const WINDS: [&str; 8] = ["wind-n", "wind-ne", "wind-e", "wind-se", "wind-s", "wind-sw", "wind-w", "wind-nw"];
            let wind = WINDS[(deg.rem_euclid(360.0) / 45.0).round() as usize % WINDS.len()];
            format!("{}, {} {}", bench.say(wind), bench.words.number(*deg, 0), bench.say("unit-deg"))
        }
    }
}
