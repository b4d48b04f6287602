//! What streaming does and wants, in the visitor's language.

use veduta::buildings::BuildStats;
use veduta::city::Level;
use veduta::ecs::Words;
use veduta::streaming::{Event, Reason, What, Why};

/// A number of bytes as people read it. No line ends between a number and its unit.
pub(super) fn bytes(words: &Words, n: u64) -> String {
    match n {
        0..1_000 => format!("{n}\u{a0}B"),
        1_000..1_000_000 => format!("{}\u{a0}kB", words.number(n as f64 / 1e3, 1)),
        _ => format!("{}\u{a0}MB", words.number(n as f64 / 1e6, 2)),
    }
}

/// What was downloaded in so many seconds.
pub(super) fn downloaded(words: &Words, size: u64, seconds: f64) -> String {
    words.say_with("expert-downloaded", &[("bytes", bytes(words, size).into()), ("seconds", words.number(seconds, 0).into())])
}

/// A kind of what was downloaded: 0 for all but packets, then levels.
pub(super) fn of_kind(words: &Words, kind: usize, size: u64) -> String {
    let size = bytes(words, size);
    match kind {
        0 => words.say_with("expert-of-maps", &[("bytes", size.into())]),
        level => words.say_with("expert-of-level", &[("level", level.into()), ("bytes", size.into())]),
    }
}

/// What was made of what came, on the spot, beside ready meshes as they lie in memory, and from how many bits a second on these would come sooner.
/// Pressed ones would from less; `veduta-bake bench meshes` measures that.
pub(super) fn made(words: &Words, sent: u64, stats: &BuildStats) -> String {
    // The same line would bring ready meshes in their bytes' time, and packets in theirs and that of their making.
    let saved = stats.bytes.saturating_sub(sent) as f64;
    let megabits = saved * 8.0 / stats.seconds.max(1e-3) / 1e6;
    words.say_with(
        "expert-made",
        &[
            ("sent", bytes(words, sent).into()),
            ("made", bytes(words, stats.bytes).into()),
            ("seconds", words.number(stats.seconds, 1).into()),
            ("megabits", words.number(megabits, 0).into()),
        ],
    )
}

/// What the last cells cost, so many of them, and the dearest.
pub(super) fn by_cell(words: &Words, cells: usize, most: u64) -> String {
    words.say_with("expert-by-cell", &[("n", cells.into()), ("bytes", bytes(words, most).into())])
}

/// How much the plan of cells shows, and what can be done there.
pub(super) fn across(words: &Words, metres: f32) -> String {
    words.say_with("expert-across", &[("metres", (metres.round() as u32).into())])
}

/// A cell: its name, its houses, its level, and why it is there.
pub(super) fn cell_told(words: &Words, cell: u32, name: &str, houses: u32, level: Option<Level>, why: Option<Why>) -> String {
    let name = if name.is_empty() { words.say("expert-nameless") } else { name.to_owned() };
    let why = match why {
        None if level.is_some() => words.say("expert-why-kept"),
        why => because(words, why),
    };
    let level = match level {
        Some(level) => words.say_with("expert-level", &[("level", (level as u8).into())]),
        None => words.say("expert-level-none"),
    };
    words.say_with(
        "expert-cell",
        &[("cell", cell.into()), ("name", name.into()), ("houses", houses.into()), ("level", level.into()), ("why", why.into())],
    )
}

/// Why a cell is there.
fn because(words: &Words, why: Option<Why>) -> String {
    match why {
        None => words.say("expert-why-none"),
        Some(Why::Seen { from }) => words.say_with("expert-why-seen", &[("from", from.into())]),
        Some(Why::Ahead { from }) => words.say_with("expert-why-ahead", &[("from", from.into())]),
        Some(Why::OnTheWay) => words.say("expert-why-on-the-way"),
        Some(Why::Skyline) => words.say("expert-why-skyline"),
        Some(Why::Near) => words.say("expert-why-near"),
    }
}

/// Something that happened.
pub(super) fn happened(words: &Words, event: &Event) -> String {
    let of = |message: &str, what: What| words.say_with(message, &[("what", thing(words, what).into())]);
    let sized = |message: &str, what: What, size: u64| {
        words.say_with(message, &[("what", thing(words, what).into()), ("bytes", bytes(words, size).into())])
    };
    match event {
        Event::Opened { place } => words.say_with("expert-opened", &[("place", place.clone().into())]),
        Event::Entered { cell: Some(cell), .. } => words.say_with("expert-entered", &[("cell", (*cell).into())]),
        Event::Entered { cell: None, .. } => words.say("expert-left"),
        Event::Asked { what, bytes: size, .. } => sized("expert-asked", *what, *size),
        Event::Arrived { what, bytes: size } => sized("expert-arrived", *what, *size),
        Event::Failed { what, again_in_s: Some(s), .. } => {
            words.say_with("expert-failed", &[("what", thing(words, *what).into()), ("seconds", words.number(*s, 1).into())])
        }
        Event::Failed { what, again_in_s: None, .. } => of("expert-failed-for-good", *what),
        Event::Cancelled { what } => of("expert-cancelled", *what),
        Event::Released { cell, from, why } => words.say_with(
            "expert-released",
            &[("cell", (*cell).into()), ("level", (*from as u8).into()), ("why", released(words, *why).into())],
        ),
    }
}

/// What a request asks for.
fn thing(words: &Words, what: What) -> String {
    let numbered = |message: &str, n: u32| words.say_with(message, &[("n", n.into())]);
    match what {
        What::Index => words.say("expert-index"),
        What::Leaf(n) => numbered("expert-leaf", n),
        What::Region(n) => numbered("expert-region", n),
        What::Overview(n) => numbered("expert-overview", n),
        What::Houses(n) => numbered("expert-houses", n),
        What::File(n) => numbered("expert-file", n),
        What::Packet { cell, level } => words.say_with("expert-packet", &[("cell", cell.into()), ("level", (level as u8).into())]),
    }
}

/// Why a cell was let go of.
fn released(words: &Words, why: Reason) -> String {
    words.say(match why {
        Reason::Idle => "expert-released-idle",
        Reason::OverTheCap => "expert-released-cap",
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::super::tongues;
    use super::*;

    const PACKET: What = What::Packet { cell: 3, level: Level::Two };

    fn events() -> Vec<Event> {
        vec![
            Event::Opened { place: "old_prague.city".to_owned() },
            Event::Entered { viewer: 7, cell: Some(3) },
            Event::Entered { viewer: 7, cell: None },
            Event::Asked { what: PACKET, bytes: 900, why: Some(Why::Near) },
            Event::Arrived { what: PACKET, bytes: 900 },
            Event::Failed { what: PACKET, error: "it is gone".to_owned(), again_in_s: Some(0.5) },
            Event::Failed { what: PACKET, error: "it is gone".to_owned(), again_in_s: None },
            Event::Cancelled { what: PACKET },
            Event::Released { cell: 3, from: Level::Two, why: Reason::Idle },
        ]
    }

    /// Which of [`events`] is of its kind: who adds a kind here adds it there.
    fn event_kind(event: &Event) -> usize {
        match event {
            Event::Opened { .. } => 0,
            Event::Entered { cell: Some(_), .. } => 1,
            Event::Entered { cell: None, .. } => 2,
            Event::Asked { .. } => 3,
            Event::Arrived { .. } => 4,
            Event::Failed { again_in_s: Some(_), .. } => 5,
            Event::Failed { again_in_s: None, .. } => 6,
            Event::Cancelled { .. } => 7,
            Event::Released { .. } => 8,
        }
    }

    const THINGS: [What; 7] =
        [What::Index, What::Leaf(2), What::Region(2), What::Overview(2), What::Houses(2), What::File(2), PACKET];

    fn thing_kind(what: &What) -> usize {
        match what {
            What::Index => 0,
            What::Leaf(_) => 1,
            What::Region(_) => 2,
            What::Overview(_) => 3,
            What::Houses(_) => 4,
            What::File(_) => 5,
            What::Packet { .. } => 6,
        }
    }

    const WHYS: [Option<Why>; 6] =
        [None, Some(Why::Seen { from: 4 }), Some(Why::Ahead { from: 4 }), Some(Why::OnTheWay), Some(Why::Skyline), Some(Why::Near)];

    fn why_kind(why: &Option<Why>) -> usize {
        match why {
            None => 0,
            Some(Why::Seen { .. }) => 1,
            Some(Why::Ahead { .. }) => 2,
            Some(Why::OnTheWay) => 3,
            Some(Why::Skyline) => 4,
            Some(Why::Near) => 5,
        }
    }

    const REASONS: [Reason; 2] = [Reason::Idle, Reason::OverTheCap];

    fn reason_kind(reason: &Reason) -> usize {
        match reason {
            Reason::Idle => 0,
            Reason::OverTheCap => 1,
        }
    }

    /// Whether a list has all kinds, in their order.
    fn is_whole<T>(all: &[T], kind: fn(&T) -> usize) -> bool {
        all.iter().map(kind).eq(0..all.len())
    }

    /// Nothing is said by the name of its message, and no two things alike.
    fn check(words: &Words, said: Vec<String>) {
        let lacking: Vec<&String> = said.iter().filter(|said| said.contains("expert-")).collect();
        assert_eq!(lacking, Vec::<&String>::new(), "{}", words.language());
        let unlike: BTreeSet<&String> = said.iter().collect();
        assert_eq!(unlike.len(), said.len(), "{}: {said:?}", words.language());
    }

    #[test]
    fn all_that_happens_is_said_in_every_language() {
        assert!(is_whole(&events(), event_kind) && is_whole(&THINGS, thing_kind));
        for words in tongues() {
            check(&words, events().iter().map(|event| happened(&words, event)).collect());
            check(&words, THINGS.iter().map(|what| happened(&words, &Event::Cancelled { what: *what })).collect());
        }
    }

    #[test]
    fn every_reason_is_said_in_every_language() {
        assert!(is_whole(&WHYS, why_kind) && is_whole(&REASONS, reason_kind));
        for words in tongues() {
            let told = |why: &Option<Why>| cell_told(&words, 3, "Ungelt", 5, Some(Level::Two), *why);
            check(&words, WHYS.iter().map(told).collect());
            let released = |why: &Reason| happened(&words, &Event::Released { cell: 3, from: Level::Two, why: *why });
            check(&words, REASONS.iter().map(released).collect());
            let of_no_use = [None, Some(Level::One)].map(|level| cell_told(&words, 3, "", 1, level, None));
            assert!(of_no_use[1].contains(&words.say("expert-why-kept")), "what is loaded has a reason: {}", of_no_use[1]);
            check(&words, of_no_use.to_vec());
        }
    }

    #[test]
    fn figures_are_said_in_every_language() {
        for words in tongues() {
            check(
                &words,
                vec![
                    downloaded(&words, 1_200, 7.0),
                    of_kind(&words, 0, 5),
                    of_kind(&words, 3, 5),
                    made(&words, 9, &BuildStats::default()),
                    by_cell(&words, 1, 90),
                    by_cell(&words, 60, 90),
                    across(&words, 440.0),
                ],
            );
        }
    }

    #[test]
    fn numbers_are_written_and_counted_as_the_language_does() {
        for words in tongues() {
            let point = if words.language() == "en" { '.' } else { ',' };
            assert_eq!(bytes(&words, 999), "999\u{a0}B");
            assert_eq!(bytes(&words, 1_500), format!("1{point}5\u{a0}kB"));
            assert_eq!(bytes(&words, 2_250_000), format!("2{point}25\u{a0}MB"));
            let told = |houses| cell_told(&words, 3, "Ungelt", houses, None, None);
            let forms: &[(u32, &str)] = match words.language() {
                "cs" => &[(1, ": 1 dům,"), (3, ": 3 domy,"), (5, ": 5 domů,")],
                "it" => &[(1, ": 1 casa,"), (3, ": 3 case,")],
                _ => &[(1, ": 1 house,"), (3, ": 3 houses,")],
            };
            for (houses, form) in forms {
                assert!(told(*houses).contains(*form), "{}", told(*houses));
            }
        }
    }
}
