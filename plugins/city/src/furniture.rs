//! What growth furnishes streets, squares, parks and yards with where a map says nothing, as a person writes it.
//!
//! ```
//! use veduta_city::{FurnitureRule, file, furniture::validate};
//! let rules: Vec<FurnitureRule> = file::parse(
//!     r#"[
//!         (name: "benches", put: [(kind: Bench)], place: Rim(of: Squares, every_m: 12, inset_m: 1.5), chance: 0.4),
//!         (name: "street trees", put: [(kind: Tree, height_m: (6, 8))],
//!          place: Along(streets: [Main], every_m: 12, side: Both, at: Kerb(0.8)), clear_m: 1.2),
//!     ]"#,
//!     "mine.furniture.ron",
//! )?;
//! assert_eq!(validate(&rules), []);
//! # Ok::<(), veduta_city::file::SyntaxError>(())
//! ```
//!
//! Rules are followed in their order; what comes later keeps clear of what stands. Nothing is put in a doorway, into a house or
//! onto a carriageway.

use serde::{Deserialize, Serialize};

use crate::{ObjectKind, Range, StreetClass};

/// A rule by which growth puts things.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FurnitureRule {
    /// Name; a rule of a stock rule's name takes its place.
    pub name: String,
    /// What is put, drawn by share; nothing if empty, which turns a stock rule off.
    pub put: Vec<Furnishing>,
    /// Where.
    #[serde(default)]
    pub place: Placement,
    /// Share of these places where something is put, 0 to 1.
    #[serde(default = "one")]
    pub chance: f64,
    /// Radius about it that is clear of houses, metres.
    #[serde(default = "little")]
    pub clear_m: f64,
    /// Whether it holds also where the map tells of furniture itself: what no map knows.
    #[serde(default)]
    pub always: bool,
}

/// What a rule puts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Furnishing {
    /// What it is.
    pub kind: ObjectKind,
    /// Name of the monument that it is seen as, in place of what its kind looks like.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub monument: String,
    /// Metres; its kind's own if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_m: Option<Range>,
    /// How often it is drawn against the others.
    #[serde(default = "one")]
    pub share: f64,
    /// Latitudes where it is put, north or south, degrees; everywhere if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lat_deg: Option<Range>,
}

/// Where a rule puts things.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Placement {
    /// In rows along streets, but not beside zebras and stop lines; they look across the street.
    Along {
        /// Streets of these classes.
        streets: Vec<StreetClass>,
        /// Distance between them, metres.
        every_m: f64,
        /// On which side, as the street was drawn.
        side: Side,
        /// How far out.
        at: Offset,
    },
    /// Beside the street where vehicles wait at a crossroads, on the side on which they drive; they look at the drivers.
    Crossings {
        /// At crossroads of this kind.
        control: Control,
        /// From the kerb onto the pavement, or from the street's edge where there is none; metres.
        inset_m: f64,
    },
    /// In a row along the border of an area, within; they look into it.
    Rim {
        /// Which areas.
        of: AreaKind,
        /// Distance between them, metres.
        every_m: f64,
        /// From the border, metres.
        inset_m: f64,
        /// Length of rows and of the gaps between them, metres; no gaps if not given.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        rows_m: Option<(f64, f64)>,
    },
    /// In the middle of areas, about which there is most room: one thing, which looks where the compass has it, or several in a ring about it
    /// that look at it, but in nobody's way to it.
    Middle {
        /// Of these areas.
        of: AreaKind,
        /// Least room about the middle, metres.
        least_m: f64,
        /// How many in the ring, and its radius in metres.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        ring: Option<(u8, f64)>,
    },
    /// Anywhere in an area, one in a square of a side at most.
    Scatter {
        /// Which areas.
        of: AreaKind,
        /// Side of the squares, metres.
        every_m: f64,
    },
}

/// Sides of a street.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Side {
    /// On both.
    Both,
    /// Once on one, once on the other.
    Alternating,
}

/// How far from the middle of a street; metres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Offset {
    /// So far in from the edge of the whole street, where houses stand.
    Edge(f64),
    /// So far out from the kerb; only in streets with pavements.
    Kerb(f64),
}

/// How traffic is controlled at a crossroads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Control {
    /// Those that do not come on a main street wait.
    Stop,
    /// Main streets cross: all wait for lights.
    Signals,
}

/// Areas that are furnished.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum AreaKind {
    /// Squares.
    Squares,
    /// Lawns of parks.
    Parks,
    /// Yards of built blocks.
    Yards,
}

impl Default for Placement {
    /// Along no streets.
    fn default() -> Self {
        Self::Along { streets: Vec::new(), every_m: 1.0, side: Side::Both, at: Offset::Edge(0.0) }
    }
}

const fn one() -> f64 {
    1.0
}

const fn little() -> f64 {
    0.3
}

/// What is wrong with a rule.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FurnitureError {
    /// Two rules share a name.
    #[error("two furniture rules are called `{0}`")]
    Twice(String),
    /// A number is out of bounds.
    #[error("furniture rule `{rule}`: `{field}` is {value}; it needs to be within {least} to {most}")]
    Number {
        /// Which rule.
        rule: String,
        /// Which field.
        field: &'static str,
        /// What it is.
        value: f64,
        /// Least that it may be.
        least: f64,
        /// Most.
        most: f64,
    },
    /// It puts a monument that is not there.
    #[error("furniture rule `{rule}`: there is no monument `{monument}`")]
    Monument {
        /// Which rule.
        rule: String,
        /// What it names.
        monument: String,
    },
}

/// Everything wrong with rules; empty if growth may follow them. That their monuments exist is not looked at.
#[must_use]
pub fn validate(rules: &[FurnitureRule]) -> Vec<FurnitureError> {
    let mut errors = Vec::new();
    for (i, rule) in rules.iter().enumerate() {
        if rules[..i].iter().any(|other| other.name == rule.name) {
            errors.push(FurnitureError::Twice(rule.name.clone()));
        }
        let mut within = |field, value: f64, least, most| {
            if !(least..=most).contains(&value) {
                errors.push(FurnitureError::Number { rule: rule.name.clone(), field, value, least, most });
            }
        };
        within("chance", rule.chance, 0.0, 1.0);
        within("clear_m", rule.clear_m, 0.0, 50.0);
        for furnishing in &rule.put {
            within("share", furnishing.share, 1e-6, 1e6);
            if let Some(Range(low, high)) = furnishing.height_m {
                within("height_m", low, 0.1, high.min(200.0));
                within("height_m", high, low.max(0.1), 200.0);
            }
            if let Some(Range(low, high)) = furnishing.lat_deg {
                within("lat_deg", low, 0.0, high.min(90.0));
                within("lat_deg", high, low.max(0.0), 90.0);
            }
        }
        match &rule.place {
            Placement::Along { every_m, at: Offset::Edge(m) | Offset::Kerb(m), .. } => {
                within("every_m", *every_m, 0.5, 10_000.0);
                within("at", *m, 0.0, 50.0);
            }
            Placement::Crossings { inset_m, .. } => within("inset_m", *inset_m, 0.0, 50.0),
            Placement::Rim { every_m, inset_m, rows_m, .. } => {
                within("every_m", *every_m, 0.5, 10_000.0);
                within("inset_m", *inset_m, 0.0, 50.0);
                let (row, gap) = rows_m.unwrap_or((1.0, 0.0));
                within("rows_m", row, 0.5, 10_000.0);
                within("rows_m", gap, 0.0, 10_000.0);
            }
            Placement::Scatter { every_m, .. } => within("every_m", *every_m, 1.0, 10_000.0),
            Placement::Middle { least_m, ring, .. } => {
                within("least_m", *least_m, 0.5, 10_000.0);
                if let Some((count, radius_m)) = *ring {
                    within("ring", f64::from(count), 1.0, 64.0);
                    within("ring", radius_m, 0.5, least_m.max(0.5));
                }
            }
        }
    }
    errors
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file;

    fn told(text: &str) -> Vec<String> {
        let rules: Vec<FurnitureRule> = file::parse(text, "test").unwrap_or_else(|e| panic!("{e}"));
        validate(&rules).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn numbers_that_cannot_be_meant_are_told() {
        let rule = |more: &str| format!("(name: \"r\", put: [(kind: Bin)], {more})");
        let scatter = "place: Scatter(of: Parks, every_m: 9)";
        assert_eq!(told(&format!("[{}]", rule(scatter))), [""; 0]);
        assert_eq!(told(&format!("[{0}, {0}]", rule(scatter))), ["two furniture rules are called `r`"]);
        for (more, field) in [
            ("place: Scatter(of: Parks, every_m: 0)", "every_m"),
            ("place: Scatter(of: Parks, every_m: 9), chance: 1.5", "chance"),
            ("place: Scatter(of: Parks, every_m: 9), clear_m: -1", "clear_m"),
            ("place: Along(streets: [Main], every_m: 0.1, side: Both, at: Edge(1))", "every_m"),
            ("place: Along(streets: [Main], every_m: 9, side: Both, at: Kerb(-1))", "at"),
            ("place: Crossings(control: Stop, inset_m: 99)", "inset_m"),
            ("place: Middle(of: Parks, least_m: 0)", "least_m"),
            ("place: Middle(of: Parks, least_m: 5, ring: (6, 7))", "ring"),
            ("place: Middle(of: Parks, least_m: 5, ring: (0, 4))", "ring"),
            ("place: Rim(of: Squares, every_m: 9, inset_m: 1, rows_m: (0, 4))", "rows_m"),
        ] {
            let found = told(&format!("[{}]", rule(more)));
            assert!(found.len() == 1 && found[0].contains(&format!("`{field}` is ")), "{more}: {found:?}");
        }
        let tall = "[(name: \"r\", put: [(kind: Tree, height_m: (9, 3))], place: Scatter(of: Yards, every_m: 9))]";
        assert!(told(tall).iter().all(|t| t.contains("`height_m`")) && !told(tall).is_empty());
        let polar = "[(name: \"r\", put: [(kind: Palm, lat_deg: (-36, 36))], place: Scatter(of: Yards, every_m: 9))]";
        assert!(told(polar).iter().all(|t| t.contains("`lat_deg`")) && !told(polar).is_empty());
    }
}
