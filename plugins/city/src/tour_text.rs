//! A tour's file, edited without losing what a person wrote in it.
//!
//! ```text
//!  text ── reader ──► Tour ──────────────┐
//!    └──── scan ───► spans of values ────┴── edit: the difference as a value ──► laid out, spliced in ──► text
//! ```
//!
//! Values are read as everywhere; a scanner of brackets, strings and comments says where they stand. An edit writes anew only
//! what differs, and is checked by reading the whole text again.
//!
//! # Rejected
//! Writing the tour anew from its values: comments, order and layout are a person's work. A library for RON that keeps them
//! does not exist.

use core::ops::Range;
use std::{collections::BTreeMap, path::Path};

use crate::{
    Step, Tour,
    file::{self, FileError, SyntaxError},
};
use layout::laid_out;
use merge::Piece;
use syntax::{Group, Item, Node};
use value::{Field, Value};

mod every;
mod layout;
mod merge;
mod part;
mod steps;
pub(crate) mod syntax;
#[cfg(test)]
mod tests;
mod value;

/// A tour and the text that tells it.
///
/// Comments, order, blank lines and the layout of all that is not edited stay byte for byte. A step's own comments are those
/// directly above it and those that follow it on its line: they move with it and go with it.
///
/// ```
/// use veduta_city::{Step, TourSetting, TourText};
///
/// let text = "(title: \"A walk\", city: \"x.city\", // ours\n steps: [\n  // Stand\n  Start(at: At(0, 0)),\n ])";
/// let mut tour = TourText::parse(text, "a.tour.ron")?;
/// tour.set(TourSetting::Speed(1.2))?;
/// tour.insert(1, &[Step::Wait { seconds: 2.0 }])?;
/// assert_eq!(
///     tour.text(),
///     "(title: \"A walk\", city: \"x.city\", speed: 1.2, // ours\n steps: [\n  // Stand\n  Start(at: At(0, 0)),\n  Wait(seconds: 2),\n ])"
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct TourText {
    text: String,
    tour: Tour,
    /// Bytes of a mark before the text proper.
    mark: usize,
    root: Node,
}

/// One of a tour's own settings, to be changed.
#[derive(Debug, Clone, PartialEq)]
pub enum TourSetting {
    /// [`Tour::title`].
    Title(String),
    /// [`Tour::translations`].
    Translations(BTreeMap<String, String>),
    /// [`Tour::city`].
    City(String),
    /// [`Tour::speed`].
    Speed(f64),
    /// [`Tour::eye_m`].
    EyeM(f64),
    /// [`Tour::fov_deg`].
    FovDeg(f64),
    /// [`Tour::hour`].
    Hour(f64),
    /// [`Tour::day`].
    Day(u16),
}

/// An edit that was not made; the text is as before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum TourEditError {
    /// There is no such step.
    #[error("the tour has {steps} steps; there is none at {index}, counted from 0")]
    NoStep {
        /// The step asked for, from 0.
        index: usize,
        /// How many there are.
        steps: usize,
    },
    /// A value that no text tells, as a number that is none.
    #[error("the step or setting has a value that cannot be written, such as a number that is not a number")]
    Unwritable,
}

impl TourSetting {
    /// Makes a tour have it; says the field's name.
    fn put(self, tour: &mut Tour) -> &'static str {
        match self {
            Self::Title(title) => {
                tour.title = title;
                "title"
            }
            Self::Translations(translations) => {
                tour.translations = translations;
                "translations"
            }
            Self::City(city) => {
                tour.city = city;
                "city"
            }
            Self::Speed(speed) => {
                tour.speed = speed;
                "speed"
            }
            Self::EyeM(eye_m) => {
                tour.eye_m = eye_m;
                "eye_m"
            }
            Self::FovDeg(fov_deg) => {
                tour.fov_deg = fov_deg;
                "fov_deg"
            }
            Self::Hour(hour) => {
                tour.hour = hour;
                "hour"
            }
            Self::Day(day) => {
                tour.day = day;
                "day"
            }
        }
    }
}

impl TourText {
    /// Reads a tour; `file` names the text in errors.
    ///
    /// # Errors
    /// A [`SyntaxError`] with the place of the first mistake: for the same texts as [`file::parse_bytes`], with the same words.
    pub fn parse(text: &str, file: &str) -> Result<Self, SyntaxError> {
        let tour: Tour = file::parse_bytes(text.as_bytes(), file)?;
        let mark = text.len() - text.trim_start_matches('\u{feff}').len();
        let found = Self::found(&text[mark..], tour.steps.len());
        let root = found
            .ok_or_else(|| SyntaxError::at(text, file, 0, "the tour can be read, but not where its steps stand".to_owned()))?;
        Ok(Self { text: text.to_owned(), tour, mark, root })
    }

    /// Reads a tour from its file.
    ///
    /// # Errors
    /// [`FileError`] if the file cannot be read, is too large, or has a mistake.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let name = path.display().to_string();
        let bytes = file::read_bytes(path)?;
        match core::str::from_utf8(&bytes) {
            Ok(text) => Ok(Self::parse(text, &name)?),
            // With the place of what is no text.
            Err(_) => Err(file::parse_bytes::<Tour>(&bytes, &name).map_or_else(FileError::from, |_| unreadable(&name).into())),
        }
    }

    /// Writes a tour that has no text yet.
    ///
    /// # Errors
    /// [`TourEditError::Unwritable`] for a number that is none.
    pub fn new(tour: &Tour) -> Result<Self, TourEditError> {
        let text = written(tour);
        Self::parse(&text, "").ok().filter(|found| found.tour == *tour).ok_or(TourEditError::Unwritable)
    }

    /// What the text tells.
    #[must_use]
    pub const fn tour(&self) -> &Tour {
        &self.tour
    }

    /// The text, to be written to a file as it is.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Bytes of the text in which a step stands, without its comments and its comma.
    #[must_use]
    pub fn step_span(&self, index: usize) -> Option<Range<usize>> {
        let span = self.steps().items.get(index)?.value.span.clone();
        Some(span.start + self.mark..span.end + self.mark)
    }

    /// A mistake in a step, from 0, or in the tour as a whole, with its place; `file` names the text.
    #[must_use]
    pub fn mistake(&self, step: Option<usize>, file: &str, message: String) -> SyntaxError {
        let at = step.and_then(|step| self.step_span(step)).map_or(self.root.span.start + self.mark, |span| span.start);
        SyntaxError::at(&self.text, file, at, message)
    }

    /// A mistake in one of the tour's own settings, by its field's name.
    #[must_use]
    pub fn setting_mistake(&self, field: &str, file: &str, message: String) -> SyntaxError {
        let at = self.field(field).map_or(self.root.span.start, Item::start) + self.mark;
        SyntaxError::at(&self.text, file, at, message)
    }

    /// Changes one of the tour's own settings.
    ///
    /// # Errors
    /// [`TourEditError::Unwritable`]; the text is as before then.
    pub fn set(&mut self, setting: TourSetting) -> Result<(), TourEditError> {
        let mut tour = self.tour.clone();
        let key = setting.put(&mut tour);
        let before = value::header(&self.tour);
        let mut fields = value::header(&tour);
        let told = |fields: &[Field]| fields.iter().find(|field| field.key == key).map(|field| field.value.clone());
        let (Some(old), Some(new)) = (told(&before), told(&fields)) else { return Err(TourEditError::Unwritable) };
        let body = match self.field(key) {
            Some(item) if !new.is_empty() => self.rewritten(item, &old, &new),
            _ => {
                // A field comes or goes; the others are left alone.
                fields.retain(|field| field.key == key || self.field(field.key).is_some());
                let untouched = |field: &Field| field.key != key;
                for field in fields.iter_mut().filter(|field| untouched(field)) {
                    field.is_told = true;
                }
                if let Some(field) = fields.iter_mut().find(|field| field.key == key) {
                    field.is_told = !new.is_empty();
                }
                let mut piece = self.piece(&self.root);
                piece.say_fields(&fields);
                let homeless = piece.homeless.clone();
                let body = format!("{}{}{}", &self.body()[..self.root.span.start], piece.text, &self.body()[self.root.span.end..]);
                self.housed(&body, self.root.span.start, &homeless)
            }
        };
        self.take(body, tour)
    }

    /// Puts steps before the one at `index`, or after all.
    ///
    /// # Errors
    /// [`TourEditError`]; the text is as before then.
    pub fn insert(&mut self, index: usize, steps: &[Step]) -> Result<(), TourEditError> {
        let indent = steps::list_indent(self.body(), self.steps());
        let line = |step: &Step| format!("{}{},\n", " ".repeat(indent), laid_out(&value::step(step), indent, indent, 1));
        let lines: String = steps.iter().map(line).collect();
        self.put(index, &lines.replace('\n', self.newline()), steps)
    }

    /// Puts steps as [`TourText::remove`] gave them, with their comments, before the one at `index`, or after all.
    ///
    /// # Errors
    /// [`TourEditError`]; also where the text is not one or more steps, each with a comma.
    pub fn insert_text(&mut self, index: usize, lines: &str) -> Result<(), TourEditError> {
        let list = format!("[\n{lines}\n]");
        let steps: Vec<Step> = file::parse(&list, "").map_err(|_| TourEditError::Unwritable)?;
        let ends_with_comma = syntax::scan(&list).and_then(|node| node.group?.items.pop()?.comma).is_some();
        if !ends_with_comma || !lines.ends_with('\n') {
            return Err(TourEditError::Unwritable);
        }
        self.put(index, lines, &steps)
    }

    /// Makes a step another one. Of a step that stays of its kind only what differs is written anew; the comments within it stay, or
    /// come to stand above it.
    ///
    /// # Errors
    /// [`TourEditError`]; the text is as before then.
    pub fn replace(&mut self, index: usize, step: &Step) -> Result<(), TourEditError> {
        let item = self.item(index)?;
        let body = self.rewritten(item, &value::step(&self.tour.steps[index]), &value::step(step));
        let mut tour = self.tour.clone();
        tour.steps[index] = step.clone();
        self.take(body, tour)
    }

    /// Takes a step out, with the comments directly above it and on its line. What is returned is what was taken out.
    ///
    /// # Errors
    /// [`TourEditError`]; the text is as before then.
    pub fn remove(&mut self, index: usize) -> Result<String, TourEditError> {
        self.item(index)?;
        let lines = steps::lines(self.body(), self.steps(), index, self.newline());
        let body = steps::without(self.body(), self.steps(), index);
        let mut tour = self.tour.clone();
        tour.steps.remove(index);
        self.take(body, tour)?;
        Ok(lines)
    }

    /// Takes a step with its comments elsewhere, so that it is then the one at `to`.
    ///
    /// # Errors
    /// [`TourEditError`]; the text is as before then.
    pub fn move_step(&mut self, from: usize, to: usize) -> Result<(), TourEditError> {
        self.item(to)?;
        let mut moved = self.clone();
        let lines = moved.remove(from)?;
        moved.insert_text(to, &lines)?;
        *self = moved;
        Ok(())
    }

    /// The value of the text and its fields, if all that an edit needs is found.
    fn found(body: &str, steps: usize) -> Option<Node> {
        let root = syntax::scan(body)?;
        let of_steps = |item: &&Item| merge::key(body, item.key.as_ref()) == Some("steps");
        let list = root.items('(')?.items.iter().find(of_steps)?.value.items('[')?;
        (list.items.len() == steps).then_some(root)
    }

    fn body(&self) -> &str {
        &self.text[self.mark..]
    }

    fn newline(&self) -> &'static str {
        if self.text.contains("\r\n") { "\r\n" } else { "\n" }
    }

    fn field(&self, key: &str) -> Option<&Item> {
        let fields = &self.root.items('(')?.items;
        fields.iter().find(|item| merge::key(self.body(), item.key.as_ref()) == Some(key))
    }

    fn steps(&self) -> &Group {
        static NONE: Group = Group { bracket: '[', open: 0, close: 0, items: Vec::new() };
        // That they are there was seen when the text was read.
        self.field("steps").and_then(|item| item.value.items('[')).unwrap_or(&NONE)
    }

    fn item(&self, index: usize) -> Result<&Item, TourEditError> {
        let steps = &self.steps().items;
        steps.get(index).ok_or(TourEditError::NoStep { index, steps: steps.len() })
    }

    fn piece(&self, node: &Node) -> Piece {
        let (body, start) = (self.body(), node.span.start);
        let line = body[..start].rfind('\n').map_or(0, |newline| newline + 1);
        Piece {
            text: body[node.span.clone()].to_owned(),
            column: body[line..start].chars().count(),
            indent: merge::indent(&body[line..]),
            newline: self.newline(),
            homeless: Vec::new(),
        }
    }

    /// The text with a field's or step's value made another.
    fn rewritten(&self, item: &Item, old: &Value, new: &Value) -> String {
        let mut piece = self.piece(&item.value);
        let laid_out = |value| laid_out(value, piece.column, piece.indent, 1).replace('\n', piece.newline);
        if laid_out(old) == piece.text {
            // No person's hand shows in it, so that no layout is lost.
            piece.text = laid_out(new);
        } else {
            piece.say(new);
        }
        let (body, span) = (self.body(), &item.value.span);
        let text = format!("{}{}{}", &body[..span.start], piece.text, &body[span.end..]);
        self.housed(&text, item.start(), &piece.homeless)
    }

    /// The text with comments put above what begins at `at`.
    fn housed(&self, text: &str, at: usize, comments: &[String]) -> String {
        if comments.is_empty() {
            return text.to_owned();
        }
        let line = text[..at].rfind('\n').map_or(0, |newline| newline + 1);
        let (set_in, newline) = (" ".repeat(merge::indent(&text[line..])), self.newline());
        let begins_line = merge::is_white(&text[line..at]);
        let before = if begins_line { String::new() } else { format!("{newline}{set_in}") };
        let comments: String = comments.iter().map(|comment| format!("{comment}{newline}{set_in}")).collect();
        format!("{}{before}{comments}{}", &text[..at], &text[at..])
    }

    fn put(&mut self, index: usize, lines: &str, steps: &[Step]) -> Result<(), TourEditError> {
        let many = self.tour.steps.len();
        if index > many {
            return Err(TourEditError::NoStep { index, steps: many });
        }
        if steps.is_empty() {
            return Ok(());
        }
        let mut tour = self.tour.clone();
        tour.steps.splice(index..index, steps.iter().cloned());
        self.take(steps::with(self.body(), self.steps(), index, lines, self.newline()), tour)
    }

    /// Takes a text that must tell this tour.
    fn take(&mut self, body: String, tour: Tour) -> Result<(), TourEditError> {
        let read: Tour = file::parse(&body, "").map_err(|_| TourEditError::Unwritable)?;
        let root = Self::found(&body, tour.steps.len()).filter(|_| read == tour).ok_or(TourEditError::Unwritable)?;
        self.text.replace_range(self.mark.., &body);
        (self.tour, self.root) = (tour, root);
        Ok(())
    }
}

fn unreadable(file: &str) -> SyntaxError {
    SyntaxError::at("", file, 0, "the text is not UTF-8; save it as UTF-8".to_owned())
}

/// A tour as text.
fn written(tour: &Tour) -> String {
    let header = value::header(tour);
    let told = header.iter().filter(|field| field.is_told);
    let fields: String = told.map(|field| format!("  {},\n", layout::entry(field.key, &field.value, 2))).collect();
    let steps: String = tour.steps.iter().map(|step| format!("    {},\n", laid_out(&value::step(step), 4, 4, 1))).collect();
    let steps = if steps.is_empty() { "[]".to_owned() } else { format!("[\n{steps}  ]") };
    format!("(\n{fields}  steps: {steps},\n)\n")
}
