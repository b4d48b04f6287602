//! Reading and writing the project's RON files, with errors that show file, line, column and the offending line.

use core::fmt;
use std::path::{Path, PathBuf};

use serde::{Serialize, de::DeserializeOwned};

mod advice;

/// Files larger than this are refused before they are read; bytes.
pub const LARGEST_FILE: u64 = 1 << 30;

/// A file that could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The system said no.
    #[error("{path}: {source}")]
    Io {
        /// Which file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is larger than [`LARGEST_FILE`].
    #[error("{path}: {bytes} bytes is more than the {LARGEST_FILE} that such a file may have")]
    TooLarge {
        /// Which file.
        path: PathBuf,
        /// Its size.
        bytes: u64,
    },
    /// The text is not what it should be.
    #[error("{0}")]
    Syntax(#[from] SyntaxError),
    /// The value cannot be written as RON.
    #[error("{path}: {source}")]
    Write {
        /// Which file.
        path: PathBuf,
        /// What the writer said.
        source: ron::Error,
    },
}

/// A mistake in a text, with its place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SyntaxError {
    /// File, or another name of the text.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// The offending line, cut to 120 characters about the place.
    pub text: String,
    /// Column of the caret within `text`, from 0.
    pub caret: usize,
    /// What is wrong.
    pub message: String,
}

impl fmt::Display for SyntaxError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}:{}:{}: {}", self.file, self.line, self.column, self.message)?;
        let number = self.line.to_string();
        writeln!(f, "{number} | {}", self.text)?;
        write!(f, "{:width$} | {:caret$}^", "", "", width = number.len(), caret = self.caret)
    }
}

impl std::error::Error for SyntaxError {}

/// Most characters of an offending line that are shown.
const SHOWN: usize = 120;

/// RON as the project writes it: `Some(x)` may be left out.
fn options() -> ron::Options {
    ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
}

/// Reads a value from RON text; `file` names it in errors.
///
/// # Errors
/// A [`SyntaxError`] with the place of the first mistake.
pub fn parse<T: DeserializeOwned>(text: &str, file: &str) -> Result<T, SyntaxError> {
    options().from_str(text).map_err(|error| {
        let [start, end] = [error.span.start, error.span.end].map(|at| byte_of(text, at.line.max(1), at.col.max(1)));
        let (at, message) = advice::advice(&error.code, text, (start, end), file.ends_with(".tour.ron"));
        SyntaxError::at(text, file, at, message)
    })
}

/// The byte of a line and column, both from 1.
pub(crate) fn byte_of(text: &str, line: usize, column: usize) -> usize {
    let start = text.split_inclusive('\n').take(line - 1).map(str::len).sum::<usize>();
    let within = text[start..].char_indices().nth(column - 1).map_or(text.len() - start, |(at, _)| at);
    start + within
}

/// A mistake at a line and column, both from 1.
fn mistake(text: &str, file: &str, (line, column): (usize, usize), message: String) -> SyntaxError {
    let whole: Vec<char> = text.lines().nth(line - 1).unwrap_or("").chars().collect();
    let from = (column - 1).saturating_sub(SHOWN / 2).min(whole.len());
    let shown = &whole[from..whole.len().min(from + SHOWN)];
    SyntaxError {
        file: file.to_owned(),
        line,
        column,
        text: shown.iter().map(|&c| if c.is_control() { ' ' } else { c }).collect(),
        caret: column - 1 - from.min(column - 1),
        message,
    }
}

/// Line and column of a byte of a text, both from 1; the column is counted in characters.
#[must_use]
pub fn line_and_column(text: &str, at: usize) -> (usize, usize) {
    let before = &text[..text.floor_char_boundary(at)];
    let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
    (before.matches('\n').count() + 1, column)
}

impl SyntaxError {
    /// A mistake at a byte of a text, also one that is not RON; `file` names it.
    #[must_use]
    pub fn at(text: &str, file: &str, at: usize, message: impl Into<String>) -> Self {
        mistake(text, file, line_and_column(text, at), message.into())
    }
}

/// Reads a value from bytes of RON text.
///
/// # Errors
/// A [`SyntaxError`]; also where the bytes are not UTF-8.
pub fn parse_bytes<T: DeserializeOwned>(bytes: &[u8], file: &str) -> Result<T, SyntaxError> {
    match core::str::from_utf8(bytes) {
        Ok(text) => parse(text.strip_prefix('\u{feff}').unwrap_or(text), file),
        Err(_) if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") => {
            Err(SyntaxError::at("", file, 0, "the text is UTF-16, as some editors save it; save it as UTF-8"))
        }
        Err(error) => {
            let message = "the text is not UTF-8 from here on; save it as UTF-8";
            Err(SyntaxError::at(&String::from_utf8_lossy(bytes), file, error.valid_up_to(), message))
        }
    }
}

/// Reads a value from a RON file.
///
/// # Errors
/// [`FileError`] if the file cannot be read, is too large, or has a mistake.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<T, FileError> {
    Ok(parse_bytes(&read_bytes(path)?, &path.display().to_string())?)
}

/// The bytes of a file that is not too large.
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>, FileError> {
    let io = |source| FileError::Io { path: path.to_owned(), source };
    let bytes = std::fs::metadata(path).map_err(io)?.len();
    if bytes > LARGEST_FILE {
        return Err(FileError::TooLarge { path: path.to_owned(), bytes });
    }
    std::fs::read(path).map_err(io)
}

/// A value as RON text, the same on every platform.
///
/// # Errors
/// What the writer says; a value of this crate always succeeds.
pub fn to_text<T: Serialize>(value: &T) -> Result<String, ron::Error> {
    let pretty = ron::ser::PrettyConfig::new()
        .new_line("\n")
        .indentor(" ")
        .depth_limit(3)
        .struct_names(false)
        .extensions(ron::extensions::Extensions::empty());
    let mut text = options().to_string_pretty(value, pretty)?;
    text.push('\n');
    Ok(text)
}

/// Writes a value to a RON file, whole or not at all.
///
/// # Errors
/// [`FileError`] if the system says no; nothing is left behind then.
pub fn write<T: Serialize>(value: &T, path: &Path) -> Result<(), FileError> {
    let text = to_text(value).map_err(|source| FileError::Write { path: path.to_owned(), source })?;
    write_text(&text, path)
}

/// Writes a file, whole or not at all: first beside it, then renamed.
///
/// # Errors
/// [`FileError::Io`] if the system says no; nothing is left behind then.
pub fn write_text(text: &str, path: &Path) -> Result<(), FileError> {
    write_bytes(text.as_bytes(), path)
}

/// Writes a file that is no text, whole or not at all.
///
/// # Errors
/// As [`write_text`].
pub fn write_bytes(bytes: &[u8], path: &Path) -> Result<(), FileError> {
    let io = |source| FileError::Io { path: path.to_owned(), source };
    let mut beside = path.as_os_str().to_owned();
    beside.push(".part");
    let beside = PathBuf::from(beside);
    let written = std::fs::write(&beside, bytes).and_then(|()| std::fs::rename(&beside, path));
    if written.is_err() {
        // The first error is the one to tell.
        let _ = std::fs::remove_file(&beside);
    }
    written.map_err(io)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CityGraph, CityPlan, GraphOverrides, Style, Tour};

    #[test]
    fn a_mistake_shows_its_line_and_column() {
        let text = "(\n  title: \"x\",\n  city: \"y\",\n  steps: [\n    Wait(second: 3),\n  ],\n)";
        let error = parse::<Tour>(text, "a.tour.ron").expect_err("`second` is not a field");
        assert_eq!((error.line, error.file.as_str()), (5, "a.tour.ron"));
        let shown = error.to_string();
        assert!(shown.contains("5 |     Wait(second: 3),"), "{shown}");
        assert!(shown.contains("second"), "{shown}");
    }

    /// That a text is refused for a field that its type does not have.
    fn refuses<T: DeserializeOwned + fmt::Debug>(text: &str, field: &str) {
        let error = parse::<T>(text, "typo").expect_err(text);
        assert!(error.message.contains(&format!("`{field}`")), "{text}: {error}");
    }

    #[test]
    fn a_misspelt_field_is_refused_though_it_might_be_left_out() {
        let steps = [
            ("Start(at: At(0, 0), eye_mm: 2)", "eye_mm"),
            ("Walk(to: At(0, 0), sped: 2)", "sped"),
            ("Fly(through: [(0, 0, 9)], speed: 2, eas: Linear)", "eas"),
            ("Look(at: Heading(deg: 4, pitch: 2), seconds: 1)", "pitch"),
            ("Look(at: Spot(at: At(0, 0), height: 2), seconds: 1)", "height"),
            ("Wait(seconds: 1, second: 2)", "second"),
            ("Say(text: \"x\", second: 2)", "second"),
            ("Fov(deg: 50, second: 2)", "second"),
            ("Time(hour: 9, second: 2)", "second"),
            ("Cut(to: At(0, 0), second: 2)", "second"),
        ];
        for (step, field) in steps {
            refuses::<Tour>(&format!("(title: \"\", city: \"\", steps: [{step}])"), field);
        }
        refuses::<Tour>("(title: \"\", city: \"\", steps: [], sped: 2)", "sped");
        let edits = [
            ("Building(target: (at: (0, 0)), color: \"#FFFFFF\")", "color"),
            ("Building(target: (at: (0, 0), idd: 4))", "idd"),
            ("Building(target: (at: (0, 0)), roof: (shap: Flat))", "shap"),
            ("Block(target: (at: (0, 0)), distrikt: \"x\")", "distrikt"),
            ("Width(target: (at: (0, 0)), width_m: 3, widht: 3)", "widht"),
            ("AddObject((kind: Bench, pos: (0, 0), heading: 3))", "heading"),
            ("AddPlace((name: \"x\", pos: (0, 0), radius: 3))", "radius"),
            ("AddPlace((name: \"x\", pos: (0, 0), view: (pos: (0, 0), heading: 3)))", "heading"),
        ];
        for (edit, field) in edits {
            refuses::<GraphOverrides>(&format!("(edits: [{edit}])"), field);
        }
        let things = [
            ("places: [(name: \"x\", pos: (0, 0), txt: \"\")]", "txt"),
            ("links: [(from: 1, to: 2, kind: Railway(tram: true, gauge: 1))]", "gauge"),
            ("start: (pos: (0, 0), heading: 4)", "heading"),
            ("atribution: \"x\"", "atribution"),
        ];
        for (thing, field) in things {
            refuses::<CityGraph>(&format!("(name: \"T\", anchor: (lat: 50, lon: 14), {thing})"), field);
        }
        refuses::<CityGraph>("(name: \"T\", anchor: (lat: 50, lon: 14, alt: 3))", "alt");
        refuses::<CityPlan>("(extent: (outer: [], hole: []))", "hole");
        refuses::<Style>("(nam: \"x\")", "nam");
    }

    #[test]
    fn a_file_that_cannot_be_written_leaves_nothing() {
        let dir = std::env::temp_dir().join(format!("veduta-city-file-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&dir);
        std::fs::create_dir_all(dir.join("taken")).expect("a folder");
        let names = || std::fs::read_dir(&dir).expect("a folder").count();
        let error = write_text("x", &dir.join("taken")).expect_err("a folder is there");
        assert!(error.to_string().contains("taken"), "{error}");
        assert_eq!(names(), 1, "only what stood there");
        write_text("x", &dir.join("free")).expect("nothing is there");
        write_text("y", &dir.join("free")).expect("a file is replaced");
        assert_eq!((names(), std::fs::read_to_string(dir.join("free")).expect("a file").as_str()), (2, "y"));
        std::fs::remove_dir_all(&dir).expect("ours");
    }

    #[test]
    fn bytes_that_are_no_text_are_an_error_with_a_place() {
        let error = parse_bytes::<Tour>(b"(\n title: \"\xff\"", "t").expect_err("not UTF-8");
        assert_eq!(error.line, 2);
    }

    #[test]
    fn a_graph_survives_writing_and_reading() {
        let text = "(name: \"T\", anchor: (lat: 50, lon: 14), nodes: [(id: 1, pos: (0, 1.5)), (id: 2, pos: (9, 9))],
            links: [(from: 1, to: 2, kind: Street(Lane), name: \"Karlova\")],
            buildings: [(outline: [(0,0),(4,0),(4,4)], colour: \"#D9B36C\", levels: 3, roof: (shape: Gabled))])";
        let mut graph: CityGraph = parse(text, "t").unwrap_or_else(|e| panic!("{e}"));
        graph.fill_ids();
        let again: CityGraph = parse(&to_text(&graph).expect("plain values"), "again").unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(graph, again);
    }

    proptest::proptest! {
        #[test]
        fn no_text_makes_the_reader_panic(bytes in proptest::collection::vec(proptest::prelude::any::<u8>(), 0..200)) {
            let _ = parse_bytes::<CityGraph>(&bytes, "fuzz");
        }
    }
}
