//! What a tour says and tells beside its movements: captions, chapters, marks.

use std::collections::BTreeMap;

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

/// What a tour says and tells, each in order of time.
#[derive(Debug, Clone, Default)]
pub(crate) struct Script {
    pub captions: Vec<Caption>,
    pub chapters: Vec<Chapter>,
    pub marks: Vec<Mark>,
}

impl Script {
    /// The caption at a moment.
    pub fn caption(&self, t_s: f64) -> Option<&Spoken> {
        let begun = self.captions.partition_point(|c| c.start_s <= t_s);
        let latest = self.captions.get(begun.checked_sub(1)?)?;
        (t_s < latest.end_s && !latest.text.text.is_empty()).then_some(&latest.text)
    }

    /// The marks after one moment and up to another.
    pub fn marks(&self, after_s: f64, until_s: f64) -> &[Mark] {
        let index = |t_s: f64| self.marks.partition_point(|mark| mark.at_s <= t_s);
        self.marks.get(index(after_s)..index(until_s)).unwrap_or(&[])
    }
}
