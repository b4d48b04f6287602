//! What `check` tells of a tour: every mistake at its place, notes, and how long it lasts.

use std::fmt::Write;
use std::path::Path;

use veduta_city::{Step, TourText, file::FileError, file::SyntaxError, language_mistake};
use veduta_route::{CompiledTour, Gazetteer, StepKind, StepProblem, StreetNet, TourError, TourMistake, mistakes};

use super::beside::{living_in, picture_beside, recording_beside};
use super::city_named::{Named, named_city};
use super::tour_notes::notes;
use super::town::{Town, Towns};

/// What is told of a tour.
#[derive(Default)]
pub(super) struct TourReport {
    /// What it is, in a line.
    pub words: String,
    /// What is wrong with it.
    pub mistakes: Vec<String>,
    /// What can be played and is hardly meant.
    pub notes: Vec<String>,
}

/// Checks a tour's file; `steps` asks for the seconds of each step.
pub(super) fn check_tour(path: &Path, towns: &mut Towns, steps: bool) -> TourReport {
    match TourText::read(path) {
        Ok(text) => Check { path, text: &text, file: path.display().to_string() }.all(towns, steps),
        Err(error) => TourReport { mistakes: unreadable(path, &error), ..TourReport::default() },
    }
}

/// Every mistake that keeps a tour from being read, and that reading ended there.
fn unreadable(path: &Path, error: &FileError) -> Vec<String> {
    let file = path.display().to_string();
    // What the system refuses and what is no text is one mistake.
    let text = match (error, std::fs::read_to_string(path)) {
        (FileError::Syntax(_), Ok(text)) => text,
        _ => return vec![error.to_string()],
    };
    let found = TourText::mistakes(&text, &file);
    let mut told: Vec<String> =
        if found.is_empty() { vec![error.to_string()] } else { found.iter().map(ToString::to_string).collect() };
    told.push(format!(
        "{file}: what else may be wrong, and whether the places are there, is told once {} mended",
        if told.len() == 1 { "this is" } else { "these are" }
    ));
    told
}

struct Check<'a> {
    path: &'a Path,
    text: &'a TourText,
    file: String,
}

impl Check<'_> {
    fn all(&self, towns: &mut Towns, steps: bool) -> TourReport {
        let tour = self.text.tour();
        let mut report =
            TourReport { words: format!("“{}”, {} steps", printable(&tour.title), tour.steps.len()), ..TourReport::default() };
        let mut wrong = self.wrong_languages();
        wrong.extend(self.wrong_files());
        let named = named_city(self.path, &tour.city);
        let (town, untold) = match &named {
            Named::OnTheWeb => (None, None),
            Named::Wrong(why) => (None, Some(why.clone())),
            Named::Here(city) => match towns.of(city) {
                Ok(town) => (Some(town), None),
                Err(error) => (None, Some(format!("its city cannot be opened: {error}"))),
            },
        };
        wrong.extend(untold.map(|why| self.text.mistake_at(None, "city", &self.file, why)));
        let compiled = self.compiled(town, &mut wrong);
        match &compiled {
            Some(compiled) => report.words.push_str(&lengths(compiled, steps)),
            None if town.is_none() => report.words.push_str("; places and ways were not looked at, for the city lies on the web"),
            None => {}
        }
        let living = if let Named::Here(city) = &named { living_in(city) } else { Vec::new() };
        let noted = notes(self.text, town, compiled.as_ref(), &living);
        let noted = noted
            .into_iter()
            .map(|note| self.text.mistake_at(note.step, &note.part, &self.file, format!("note: {}", note.message)));
        report.notes = in_order(noted.collect());
        report.mistakes = in_order(wrong);
        report
    }

    /// The tour as it is played in its city, or what keeps it from that; without a city only what is wrong with it in any.
    fn compiled(&self, town: Option<&Town>, wrong: &mut Vec<SyntaxError>) -> Option<CompiledTour> {
        let (no_net, no_places) = (StreetNet::new(&[]), Gazetteer::new(&[]));
        let (net, places) = town.map_or((&no_net, &no_places), |town| (&town.net, &town.places));
        match mistakes(self.text.tour(), net, places) {
            Ok(compiled) => town.map(|_| compiled),
            Err(found) => {
                let own = found.iter().filter(|one| !is_of_file(&one.error) && (town.is_some() || is_own(&one.error)));
                wrong.extend(own.map(|one| self.shown(one, town)));
                None
            }
        }
    }

    /// A mistake at its place.
    fn shown(&self, mistake: &TourMistake, town: Option<&Town>) -> SyntaxError {
        let mut message = mistake.error.to_string();
        if let (TourError::Step { problem: StepProblem::UnknownPlace { name, near }, .. }, Some(town)) = (&mistake.error, town) {
            message.push_str(&town.hint(name, near));
        }
        self.text.mistake_at(mistake.step, &mistake.part, &self.file, message)
    }

    /// Codes of translations that are none.
    fn wrong_languages(&self) -> Vec<SyntaxError> {
        let own = self.text.tour().translations.keys().map(|code| (None, "translations", code));
        let steps = self.text.tour().steps.iter().enumerate();
        let of_steps = steps.flat_map(|(i, step)| by_language(step).into_iter().map(move |(part, code)| (Some(i), part, code)));
        let shown = |(step, part, code): (Option<usize>, &str, &String)| {
            let message = self.prefixed(step, &language_mistake(code)?);
            Some(self.text.mistake_at(step, &format!("{part}.{code}"), &self.file, message))
        };
        own.chain(of_steps).filter_map(shown).collect()
    }

    /// Files that are played or shown and are not there, or cannot be played or shown.
    fn wrong_files(&self) -> Vec<SyntaxError> {
        let mut wrong = Vec::new();
        for (i, step) in self.text.tour().steps.iter().enumerate() {
            for (part, file) in files(step) {
                let is_picture = matches!(step, Step::Picture { .. });
                let why = if is_picture { picture_beside(self.path, file).err() } else { recording_beside(self.path, file).err() };
                let shown = |why: String| self.text.mistake_at(Some(i), &part, &self.file, self.prefixed(Some(i), &why));
                wrong.extend(why.map(shown));
            }
        }
        wrong
    }

    fn prefixed(&self, step: Option<usize>, message: &str) -> String {
        let kind = step.and_then(|i| self.text.tour().steps.get(i)).map(StepKind::of);
        match (step, kind) {
            (Some(i), Some(kind)) => format!("step {} ({kind}): {message}", i + 1),
            _ => message.to_owned(),
        }
    }
}

/// The files that a step names, each with the part that names it.
fn files(step: &Step) -> Vec<(String, &String)> {
    match step {
        Step::Narrate { file, files, .. } => {
            let others = files.iter().map(|(code, file)| (format!("files.{code}"), file));
            core::iter::once(("file".to_owned(), file)).chain(others).collect()
        }
        Step::Sound { file } => file.iter().map(|file| ("file".to_owned(), file)).collect(),
        Step::Picture { file, .. } => vec![("file".to_owned(), file)],
        _ => Vec::new(),
    }
}

/// The codes of languages that a step has, each with the part that has them.
fn by_language(step: &Step) -> Vec<(&'static str, &String)> {
    match step {
        Step::Say { translations, .. } | Step::Chapter { translations, .. } | Step::Picture { translations, .. } => {
            translations.keys().map(|code| ("translations", code)).collect()
        }
        Step::Narrate { translations, files, .. } => {
            translations.keys().map(|code| ("translations", code)).chain(files.keys().map(|code| ("files", code))).collect()
        }
        _ => Vec::new(),
    }
}

/// A name without what a terminal would take for orders.
fn printable(name: &str) -> String {
    name.replace(char::is_control, " ")
}

/// Messages in the order of their places, each once.
fn in_order(mut told: Vec<SyntaxError>) -> Vec<String> {
    told.sort_by_key(|one| (one.line, one.column));
    told.dedup();
    told.iter().map(ToString::to_string).collect()
}

/// How long a tour lasts, its chapters, and, if asked for, each of its steps.
fn lengths(compiled: &CompiledTour, steps: bool) -> String {
    let end_s = compiled.duration_s();
    let mut words = format!(", {end_s:.0} s");
    let starts: Vec<f64> = compiled.chapters().iter().map(|chapter| chapter.start_s).chain([end_s]).collect();
    let chapters = compiled.chapters().iter().zip(starts.windows(2));
    let chapters: Vec<String> =
        chapters.map(|(chapter, of)| format!("“{}” {:.0} s", printable(chapter.title.own()), of[1] - of[0])).collect();
    if !chapters.is_empty() {
        let _ = write!(words, "; chapters {}", chapters.join(", "));
    }
    let mut spans = compiled.steps().to_vec();
    spans.sort_by_key(|span| span.index);
    for span in spans.iter().filter(|_| steps) {
        let _ = write!(
            words,
            "\n{:>5}  {:<8}{:>7.1} s from {:.1} s",
            span.index + 1,
            span.kind.to_string(),
            span.end_s - span.start_s,
            span.start_s
        );
    }
    words
}

/// A tour's mistake at its place, for whoever wants the first alone.
pub(super) fn first_mistake(text: &TourText, net: &StreetNet, places: &Gazetteer, file: &str) -> Option<String> {
    let first = mistakes(text.tour(), net, places).err()?.into_iter().next()?;
    Some(text.mistake_at(first.step, &first.part, file, first.error.to_string()).to_string())
}

/// Whether a mistake is about a file's name: these are told with what lies there.
const fn is_of_file(error: &TourError) -> bool {
    matches!(error, TourError::Step { problem: StepProblem::File { .. }, .. })
}

/// Whether a mistake is the tour's own, whatever city it is played in.
const fn is_own(error: &TourError) -> bool {
    match error {
        TourError::Empty | TourError::TooManySteps(_) | TourError::Setting(_) => true,
        TourError::Step { problem, .. } => !matches!(
            problem,
            StepProblem::UnknownPlace { .. }
                | StepProblem::NoWay(_)
                | StepProblem::TooLong { .. }
                | StepProblem::TooLate
                | StepProblem::FromAbove { .. }
        ),
    }
}
