//! What a tour says, shows and tells beside its movements: captions, recordings, pictures, chapters, marks.

use std::collections::BTreeMap;

use crate::{CompiledTour, StepProblem};

/// Words in a tour's own language and in others.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Spoken {
    pub(crate) text: String,
    pub(crate) translations: BTreeMap<String, String>,
}

impl Spoken {
    pub(crate) fn new(text: &str, translations: &BTreeMap<String, String>) -> Self {
        Self { text: text.to_owned(), translations: translations.clone() }
    }

    /// The words in a language, told by its code; in the tour's own where there are none in it.
    #[must_use]
    pub fn within(&self, language: &str) -> &str {
        self.translations.get(language).map_or(&self.text, String::as_str)
    }

    /// The words in the tour's own language.
    #[must_use]
    pub fn own(&self) -> &str {
        &self.text
    }
}

/// A caption and when it is shown.
#[derive(Debug, Clone)]
pub(crate) struct Caption {
    pub start_s: f64,
    pub end_s: f64,
    pub text: Spoken,
}

/// A part of a tour that a visitor can go to.
#[derive(Debug, Clone, PartialEq)]
pub struct Chapter {
    /// When it begins, seconds from the tour's start.
    pub start_s: f64,
    /// Its title.
    pub title: Spoken,
}

/// A moment that a game is told of.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// When, seconds from the tour's start.
    pub at_s: f64,
    /// What the game knows it by.
    pub name: String,
}

/// A recording that tells something.
#[derive(Debug, Clone, PartialEq)]
pub struct Narration {
    /// When it begins, seconds from the tour's start.
    pub at_s: f64,
    file: String,
    files: BTreeMap<String, String>,
}

impl Narration {
    pub(crate) fn new(at_s: f64, file: &str, files: &BTreeMap<String, String>) -> Self {
        Self { at_s, file: file.to_owned(), files: files.clone() }
    }

    /// The recording in a language, told by its code; in the tour's own where there is none in it. A path beside the tour's file.
    #[must_use]
    pub fn within(&self, language: &str) -> &str {
        self.files.get(language).map_or(&self.file, String::as_str)
    }
}

/// A recording that is heard beneath all else from a moment on, or none.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ambience {
    pub at_s: f64,
    pub file: Option<String>,
}

/// A picture and when it is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct TourPicture {
    /// From when, seconds from the tour's start.
    pub start_s: f64,
    /// Until when.
    pub end_s: f64,
    /// A path beside the tour's file.
    pub file: String,
    /// What it shows.
    pub caption: Spoken,
}

/// What a tour says and tells, each in order of time.
#[derive(Debug, Clone, Default)]
pub(crate) struct Script {
    pub captions: Vec<Caption>,
    pub chapters: Vec<Chapter>,
    pub marks: Vec<Mark>,
    pub narrations: Vec<Narration>,
    pub ambiences: Vec<Ambience>,
    pub pictures: Vec<TourPicture>,
}

impl Script {
    /// The caption at a moment.
    pub fn caption(&self, t_s: f64) -> Option<&Spoken> {
        let begun = self.captions.partition_point(|c| c.start_s <= t_s);
        let latest = self.captions.get(begun.checked_sub(1)?)?;
        (t_s < latest.end_s && !latest.text.text.is_empty()).then_some(&latest.text)
    }

    /// The narrations after one moment and up to another.
    pub fn narrations(&self, after_s: f64, until_s: f64) -> &[Narration] {
        let index = |t_s: f64| self.narrations.partition_point(|narration| narration.at_s <= t_s);
        self.narrations.get(index(after_s)..index(until_s)).unwrap_or(&[])
    }

    /// The recording that is heard beneath all else at a moment.
    pub fn ambience(&self, t_s: f64) -> Option<&str> {
        let begun = self.ambiences.partition_point(|ambience| ambience.at_s <= t_s);
        self.ambiences.get(begun.checked_sub(1)?)?.file.as_deref()
    }

    /// The picture of a moment: the one shown last.
    pub fn picture(&self, t_s: f64) -> Option<&TourPicture> {
        let begun = self.pictures.partition_point(|picture| picture.start_s <= t_s);
        self.pictures.get(begun.checked_sub(1)?).filter(|picture| t_s < picture.end_s)
    }

    /// The marks after one moment and up to another.
    pub fn marks(&self, after_s: f64, until_s: f64) -> &[Mark] {
        let index = |t_s: f64| self.marks.partition_point(|mark| mark.at_s <= t_s);
        self.marks.get(index(after_s)..index(until_s)).unwrap_or(&[])
    }
}

/// How recordings and pictures end.
pub(crate) const RECORDINGS: &str = ".ogg";
pub(crate) const PICTURES: &str = ".png, .jpg, .jpeg or .webp";

/// Whether a file can be beside the tour and of its kind; whether it is there, whoever plays the tour finds out.
pub(crate) fn beside(file: &str, endings: &'static str) -> Result<(), StepProblem> {
    let name = file.to_ascii_lowercase();
    let is_of_kind = endings.split([',', ' ']).filter(|part| part.starts_with('.')).any(|ending| name.ends_with(ending));
    if is_of_kind && veduta_city::is_beside(file) { Ok(()) } else { Err(StepProblem::File { file: file.to_owned(), endings }) }
}

impl CompiledTour {
    /// The recordings that begin after one time and up to another; seconds.
    #[must_use]
    pub fn narrations(&self, after_s: f64, until_s: f64) -> &[Narration] {
        self.script.narrations(after_s, until_s)
    }

    /// The recording that is heard beneath all else at a moment: a path beside the tour's file.
    #[must_use]
    pub fn ambience(&self, t_s: f64) -> Option<&str> {
        self.script.ambience(t_s)
    }

    /// The picture that is shown at a moment.
    #[must_use]
    pub fn picture(&self, t_s: f64) -> Option<&TourPicture> {
        self.script.picture(t_s)
    }

    /// All its recordings, as they are heard in a language, in order.
    pub fn recordings<'a>(&'a self, language: &'a str) -> impl Iterator<Item = &'a str> {
        let told = self.script.narrations.iter().map(|narration| narration.within(language));
        told.chain(self.script.ambiences.iter().filter_map(|ambience| ambience.file.as_deref()))
    }

    /// All its pictures, in order.
    #[must_use]
    pub fn pictures(&self) -> &[TourPicture] {
        &self.script.pictures
    }
}
