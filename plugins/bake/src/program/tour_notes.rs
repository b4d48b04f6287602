//! What a tour has that can be played and is hardly meant.

use std::collections::BTreeMap;

use glam::DVec2;
use veduta_city::{LookAt, Place, Step, TourText, Where, is_known_language, language_mistake};
use veduta_route::{CompiledTour, Gazetteer, StepKind, StepSpan, is_aside, reading_s, spots};

use super::beside::Living;
use super::town::Town;
use super::town_ground::Stand;

/// Something worth a note: the step's index, its part, and the words.
pub(super) struct Note {
    pub step: Option<usize>,
    pub part: String,
    pub message: String,
}

fn note(step: impl Into<Option<usize>>, part: &str, message: String) -> Note {
    Note { step: step.into(), part: part.to_owned(), message }
}

/// All notes on a tour; on its spots where its city is at hand, on its times where it can be played.
pub(super) fn notes(text: &TourText, town: Option<&Town>, compiled: Option<&CompiledTour>, living: &[Living]) -> Vec<Note> {
    let mut notes = of_words(text);
    notes.extend(of_order(text));
    notes.extend(of_hours(text));
    notes.extend(of_followed(text, living));
    notes.extend(town.into_iter().flat_map(|town| of_spots(text, town)));
    notes.extend(compiled.into_iter().flat_map(|compiled| of_times(text, compiled)));
    notes
}

/// Texts that are empty, and translations that nobody sees.
fn of_words(text: &TourText) -> Vec<Note> {
    let tour = text.tour();
    let mut notes = Vec::new();
    let empty = |words: &str| words.trim().is_empty();
    if empty(&tour.title) {
        notes.push(note(None, "title", "the title is empty".to_owned()));
    }
    notes.extend(of_languages(text, None, "translations", &tour.translations));
    for (i, step) in tour.steps.iter().enumerate() {
        let (own, translations) = match step {
            Step::Say { text, translations, .. } | Step::Narrate { text, translations, .. } => (Some(("text", text)), translations),
            Step::Chapter { title, translations } => (Some(("title", title)), translations),
            Step::Picture { translations, .. } => (None, translations),
            Step::Mark { name } if empty(name) => {
                notes.push(note(i, "name", "the mark's name is empty: nothing can know it by that".to_owned()));
                continue;
            }
            _ => continue,
        };
        // An empty caption is how one is taken away.
        if let Some((part, _)) = own.filter(|(_, words)| empty(words)) {
            let what = if matches!(step, Step::Say { .. }) { "; it takes the caption before it away" } else { "" };
            notes.push(note(i, part, format!("the {part} is empty and shows nothing{what}")));
        }
        notes.extend(of_languages(text, Some(i), "translations", translations));
        if let Step::Narrate { files, .. } = step {
            notes.extend(of_languages(text, Some(i), "files", files));
        }
    }
    notes
}

/// Pairs by language: codes told twice or of no language, and empty words.
fn of_languages(text: &TourText, step: Option<usize>, part: &str, pairs: &BTreeMap<String, String>) -> Vec<Note> {
    let keys = text.keys(step, part);
    let mut notes = Vec::new();
    for (code, words) in pairs {
        let at = format!("{part}.{code}");
        if keys.iter().filter(|key| *key == code).count() > 1 {
            notes.push(note(step, &at, format!("\"{code}\" stands there twice; only the last one counts")));
        }
        if words.trim().is_empty() {
            notes.push(note(
                step,
                &at,
                format!("what is told for \"{code}\" is empty; take the pair out, and the tour's own is taken"),
            ));
        }
        if language_mistake(code).is_none() && !is_known_language(code) {
            notes.push(note(step, &at, format!("no language has the code \"{code}\" (ISO 639-1): nobody will see it")));
        }
    }
    notes
}

/// Chapters and marks of the same name, and chapters in which nothing happens.
fn of_order(text: &TourText) -> Vec<Note> {
    let steps = &text.tour().steps;
    let mut notes = Vec::new();
    let mut known: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    for (i, step) in steps.iter().enumerate() {
        let (what, part, name) = match step {
            Step::Chapter { title, .. } => ("chapter", "title", title),
            Step::Mark { name } => ("mark", "name", name),
            _ => continue,
        };
        if let Some(first) = known.get(&(what, name.as_str())) {
            notes.push(note(i, part, format!("a {what} of this name is step {} already", first + 1)));
        }
        known.entry((what, name)).or_insert(i);
        let is_last = steps[i + 1..].iter().all(|step| matches!(step, Step::Chapter { .. } | Step::Mark { .. }));
        if what == "chapter" && is_last {
            notes.push(note(i, "", "nothing happens in this chapter: it ends with the tour".to_owned()));
        }
    }
    notes
}

/// What is followed and does not live in the city. A game may have put it there.
fn of_followed(text: &TourText, living: &[Living]) -> Vec<Note> {
    let names = living.iter().flat_map(|life| &life.names);
    let places: Vec<Place> = names.map(|name| Place { name: name.clone(), ..Place::default() }).collect();
    let known = Gazetteer::new(&places);
    let steps = text.tour().steps.iter().enumerate();
    let of_step = |(i, step): (usize, &Step)| {
        let Some(LookAt::Spot { follow: Some(name), .. }) = step.look() else { return None };
        if name.trim().is_empty() {
            return Some(note(
                i,
                &format!("{}.follow", look_part(step)),
                "the name of what is followed is empty: nothing has it".to_owned(),
            ));
        }
        let file = &living.first()?.file;
        if places.iter().any(|place| place.name == *name) {
            return None;
        }
        let near: Vec<String> = known.suggest(name).into_iter().map(|near| format!("{near:?}")).collect();
        let meant =
            if near.is_empty() { "; the".to_owned() } else { format!("; did you mean {}? Otherwise the", near.join(" or ")) };
        let message = format!("nothing that moves in {file} is named {name:?}{meant} game itself has to move it there");
        Some(note(i, &format!("{}.follow", look_part(step)), message))
    };
    steps.filter_map(of_step).collect()
}

/// The part of a step that says where the eye turns.
const fn look_part(step: &Step) -> &'static str {
    if let Step::Look { .. } = step { "at" } else { "look" }
}

/// Hours that look like hours and minutes.
fn of_hours(text: &TourText) -> Vec<Note> {
    let steps = text.tour().steps.iter().enumerate().filter(|(_, step)| matches!(step, Step::Time { .. })).map(|(i, _)| Some(i));
    let of_hour = |step: Option<usize>| {
        let written = text.written_part(step, "hour")?;
        let (hour, minutes) = written.split_once('.').filter(|(_, minutes)| matches!(*minutes, "15" | "30" | "45"))?;
        let (hour, minutes): (f64, f64) = (hour.parse().ok()?, minutes.parse().ok()?);
        let (told, meant) = ((minutes * 0.6).round(), hour + minutes / 60.0);
        Some(note(
            step,
            "hour",
            format!("hours are decimal: `{written}` is {told} minutes past {hour}; {hour}:{minutes} is {meant}"),
        ))
    };
    core::iter::once(None).chain(steps).filter_map(of_hour).collect()
}

/// Spots that lie where nobody stands, or is hardly meant to look.
fn of_spots(text: &TourText, town: &Town) -> Vec<Note> {
    let mut notes = Vec::new();
    for (i, step) in text.tour().steps.iter().enumerate() {
        for (part, spot) in spots(step) {
            let Where::At(x, y) = *spot else { continue };
            let pos = DVec2::new(x, y);
            let looks = part.ends_with(".at") || (part == "at" && matches!(step, Step::Look { .. }));
            let message = match town.degrees(pos) {
                Some(metres) => Some(format!(
                    "this looks like degrees of latitude and longitude, and is metres to the east and north; what lies there is At({:.1}, {:.1})",
                    metres.x, metres.y
                )),
                None if looks => town.looked_at(pos),
                None => town.stood_at(pos, if matches!(step, Step::Walk { .. }) { Stand::Walked } else { Stand::Placed }),
            };
            notes.extend(message.map(|message| note(i, &part, message)));
        }
        notes.extend(of_depth(i, step));
        if let Step::Fly { through, .. } = step {
            let flown = |(j, &(x, y, height)): (usize, &(f64, f64, f64))| {
                Some(note(i, &format!("through.{j}"), town.flown_through(DVec2::new(x, y), height)?))
            };
            notes.extend(through.iter().enumerate().filter_map(flown));
        }
    }
    notes
}

/// A view of what lies below the ground.
fn of_depth(i: usize, step: &Step) -> Option<Note> {
    const DEEP_M: f64 = -3.0;
    match step.look()? {
        LookAt::Spot { height_m, .. } if *height_m < DEEP_M => Some(note(
            i,
            &format!("{}.height_m", look_part(step)),
            format!("what is looked at lies {} m below the ground there", -height_m),
        )),
        _ => None,
    }
}

/// Turns that take longer than they are given, speeds that are never reached, and words that cannot be read in their time.
fn of_times(text: &TourText, compiled: &CompiledTour) -> Vec<Note> {
    let steps = &text.tour().steps;
    let mut spans = compiled.steps().to_vec();
    spans.sort_by_key(|span| span.index);
    let mut notes = of_captions(text, compiled, &spans);
    for span in &spans {
        let takes_s = span.end_s - span.start_s;
        match &steps[span.index] {
            Step::Look { seconds, .. } if takes_s > seconds + 0.1 && !follows_track(steps, span.index) => {
                let message =
                    format!("the turn takes {takes_s:.1} s, as a view turns by no more than 60° a second; it is given {seconds} s");
                notes.push(note(span.index, "seconds", message));
            }
            Step::Walk { speed, .. } => {
                let speed = speed.unwrap_or(text.tour().speed);
                notes.extend(never_reached(compiled, span, speed));
            }
            Step::Fly { speed, .. } => notes.extend(never_reached(compiled, span, *speed)),
            _ => {}
        }
    }
    notes
}

/// Whether what comes before a step is a track, after which the view comes to rest first.
fn follows_track(steps: &[Step], index: usize) -> bool {
    steps[..index].iter().rev().find(|step| !is_aside(step)).is_some_and(|step| matches!(step, Step::Track { .. }))
}

/// A speed that a movement comes nowhere near.
fn never_reached(compiled: &CompiledTour, span: &StepSpan, speed: f64) -> Option<Note> {
    const NEAR: f64 = 0.75;
    const SAMPLES: u32 = 400;
    let takes_s = span.end_s - span.start_s;
    let at = |n: u32| {
        let pose = compiled.pose(span.start_s + takes_s * f64::from(n) / f64::from(SAMPLES));
        pose.plan_pos.extend(pose.eye_m)
    };
    let lengths: Vec<f64> = (0..SAMPLES).map(|n| at(n).distance(at(n + 1))).collect();
    let fastest = lengths.iter().fold(0.0, |most: f64, length| most.max(*length)) * f64::from(SAMPLES) / takes_s;
    if lengths.iter().sum::<f64>() < 1.0 || fastest > NEAR * speed {
        return None;
    }
    let moves = if span.kind == StepKind::Walk { "the walk" } else { "the flight" };
    let message = format!(
        "{moves} comes to {fastest:.1} m/s at most, not to {speed}, as starts, stops and bends are eased; it takes {takes_s:.1} s"
    );
    Some(note(span.index, "speed", message))
}

/// Captions that are gone before they can be read once.
fn of_captions(text: &TourText, compiled: &CompiledTour, spans: &[StepSpan]) -> Vec<Note> {
    let shown = spans.iter().filter_map(|span| match &text.tour().steps[span.index] {
        Step::Say { text, translations, .. } | Step::Narrate { text, translations, .. } => {
            let longest = translations.values().chain([text]).max_by_key(|words| words.chars().count()).map_or("", String::as_str);
            Some((span, longest))
        }
        _ => None,
    });
    let shown: Vec<(&StepSpan, &str)> = shown.collect();
    let mut notes = Vec::new();
    for (n, (span, words)) in shown.iter().enumerate() {
        // Captions stay for twice as long as reading takes.
        let needed_s = reading_s(words) / 2.0;
        let next_s = shown.get(n + 1).map_or(compiled.duration_s(), |(next, _)| next.start_s);
        let until_s = span.end_s.min(next_s);
        if until_s - span.start_s >= needed_s - 0.5 || words.trim().is_empty() {
            continue;
        }
        let (part, why) = if next_s < span.end_s {
            ("text", ", for then the next words come; put a `Wait` between them")
        } else {
            ("seconds", "; leave `seconds` out, and they stay as long as they should")
        };
        let message =
            format!("these words are shown for {:.1} s, and reading them takes about {needed_s:.0} s{why}", until_s - span.start_s);
        notes.push(note(span.index, part, message));
    }
    notes
}
