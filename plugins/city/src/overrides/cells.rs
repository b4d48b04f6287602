//! A person's edits to the cells that a plan is cut into.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::OverrideError;
use super::check::{check_place, check_target};
use super::target::Target;

/// A person's edits to a city's cells, in a file of their own (`X.cells.overrides.ron`), so that they survive a new survey. They change
/// nothing but the cells that they name: all others stay as they were cut.
///
/// ```
/// use veduta_city::{CellsOverrides, file};
///
/// let overrides: CellsOverrides = file::parse(r#"(edits: [
///     Cut(from: (-98.5, 12), to: (-98.5, 19)),
///     Join(target: (at: (20, 4)), with: (at: (48, 4))),
///     Name(target: (at: (20, 4)), name: "Market"),
///     Cut(from: (7, 7), to: (7, 7)),
/// ])"#, "town.cells.overrides.ron")?;
/// let mistakes: Vec<String> = overrides.validate().iter().map(ToString::to_string).collect();
/// assert_eq!(mistakes, ["edit 4 (Cut): the line from (7.0, 7.0) to (7.0, 7.0) is shorter than 0.5 m"]);
/// # Ok::<(), veduta_city::file::SyntaxError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CellsOverrides {
    /// Edits, applied in order; each sees what those before it did.
    #[serde(default)]
    pub edits: Vec<CellOverride>,
}

/// One edit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum CellOverride {
    /// Make one cell of two with a portal between them, however large it becomes. It keeps the name that an edit gave to the first, else to
    /// the second.
    Join {
        /// The one.
        target: Target,
        /// The other.
        with: Target,
    },
    /// Cut every cell that a line leads through, so that a portal lies along it: from wall to wall, as a gate does. Where the line meets a
    /// wall or a portal within half a metre of a corner, it goes to that corner.
    Cut {
        /// Where the line begins, plan metres: in a wall, or at most a metre before one.
        from: DVec2,
        /// Where it ends, likewise.
        to: DVec2,
    },
    /// Name a cell. An empty name is one, too: that of no square or street.
    Name {
        /// Which.
        target: Target,
        /// The name.
        name: String,
    },
}

/// Shortest line that may cut cells, metres.
const SHORTEST_M: f64 = 0.5;

impl CellOverride {
    /// Name of the kind of edit, as the file calls it.
    #[must_use]
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Join { .. } => "Join",
            Self::Cut { .. } => "Cut",
            Self::Name { .. } => "Name",
        }
    }

    fn check(&self, reasons: &mut Vec<String>) {
        match self {
            Self::Join { target, with } => {
                check_target(target, reasons);
                check_place("with.at", with.at, reasons);
                if target.at == with.at {
                    reasons.push("`target` and `with` are one place; name a place in each of two cells".to_owned());
                }
            }
            Self::Cut { from, to } => {
                check_place("from", *from, reasons);
                check_place("to", *to, reasons);
                if from.distance(*to) < SHORTEST_M {
                    let ([x, y], [to_x, to_y]) = (from.to_array(), to.to_array());
                    reasons.push(format!("the line from ({x:?}, {y:?}) to ({to_x:?}, {to_y:?}) is shorter than {SHORTEST_M} m"));
                }
            }
            Self::Name { target, .. } => check_target(target, reasons),
        }
    }
}

impl CellsOverrides {
    /// Everything wrong with the edits by themselves, in order; whether their cells are there is told when a plan is cut.
    #[must_use]
    pub fn validate(&self) -> Vec<OverrideError> {
        let mut errors = Vec::new();
        for (i, edit) in self.edits.iter().enumerate() {
            let mut reasons = Vec::new();
            edit.check(&mut reasons);
            errors.extend(reasons.into_iter().map(|reason| OverrideError { edit: i + 1, kind: edit.kind(), reason }));
        }
        errors
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file;

    fn told(edits: &str) -> Vec<String> {
        let overrides: CellsOverrides = file::parse(&format!("(edits: [{edits}])"), "t").unwrap_or_else(|e| panic!("{e}"));
        overrides.validate().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn an_edit_that_cannot_be_meant_is_told_by_its_number() {
        let wrong = [
            ("Join(target: (at: (0, NaN)), with: (at: (1, 1)))", "(Join): `at` is (0.0, NaN);"),
            ("Join(target: (at: (0, 0)), with: (at: (1e7, 1)))", "(Join): `with.at` is (10000000.0, 1.0);"),
            ("Join(target: (at: (3, 4)), with: (at: (3, 4)))", "(Join): `target` and `with` are one place;"),
            ("Cut(from: (inf, 0), to: (1, 1))", "(Cut): `from` is (inf, 0.0);"),
            ("Cut(from: (0, 0), to: (-1e9, 1))", "(Cut): `to` is (-1000000000.0, 1.0);"),
            ("Cut(from: (0, 0), to: (0.1, 0))", "(Cut): the line from (0.0, 0.0) to (0.1, 0.0) is shorter than 0.5 m"),
            ("Name(target: (at: (NaN, 0)), name: \"x\")", "(Name): `at` is (NaN, 0.0);"),
        ];
        for (edit, reason) in wrong {
            let told = told(&format!("Name(target: (at: (0, 0)), name: \"\"), {edit}"));
            assert_eq!(told.len(), 1, "{edit}: {told:?}");
            assert!(told[0].starts_with("edit 2 (") && told[0].contains(reason), "{edit}: {told:?}");
        }
    }

    #[test]
    fn edits_survive_writing_and_reading() {
        let text = "(edits: [Join(target: (id: 7, at: (1, 2)), with: (at: (3, 4))), Cut(from: (0, 0), to: (5, 0)), Name(target: (at: (1, 2)), name: \"x\")])";
        let read: CellsOverrides = file::parse(text, "t").unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(read.validate(), []);
        let again: CellsOverrides =
            file::parse(&file::to_text(&read).expect("plain values"), "again").unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(read, again);
        for (wrong, field) in
            [("Cut(from: (0, 0), to: (5, 0), width: 3)", "width"), ("Join(target: (at: (0, 0)), wiht: (at: (1, 1)))", "wiht")]
        {
            let error = file::parse::<CellsOverrides>(&format!("(edits: [{wrong}])"), "t").expect_err("an unknown field");
            assert!(error.to_string().contains(field), "{error}");
        }
    }
}
