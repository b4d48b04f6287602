use serde::{Deserialize, Serialize};

use crate::{Opening, Rgb, RoofShape};

/// A range of numbers to draw from, both ends included as far as the draw goes; written `(low, high)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Range(
    /// Low end.
    pub f64,
    /// High end.
    pub f64,
);

/// How houses of a kind look: what growth draws from. Lengths are metres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Style {
    /// Name, as districts and overrides call it.
    pub name: String,
    /// Storeys below the eaves.
    pub storeys: (u8, u8),
    /// Height of the ground floor.
    pub ground_floor_m: Range,
    /// Height of the upper storeys.
    pub storey_m: Range,
    /// Distance between window axes.
    pub bay_m: Range,
    /// Frontage of grown lots.
    pub frontage_m: Range,
    /// Depth of grown houses.
    pub depth_m: Range,
    /// Wall colours to choose from.
    pub walls: Vec<Rgb>,
    /// Mouldings lighter than the wall by this factor.
    pub trim: f64,
    /// Roof shapes to choose from.
    pub roofs: Vec<RoofShape>,
    /// Pitch in degrees.
    pub pitch_deg: Range,
    /// Roof colours to choose from.
    pub roof_colours: Vec<Rgb>,
    /// Windows of the first floor to choose from.
    pub main_windows: Vec<Opening>,
    /// Windows of the other floors to choose from.
    pub windows: Vec<Opening>,
    /// Ground-floor windows to choose from.
    pub ground_windows: Vec<Opening>,
    /// Doors to choose from.
    pub doors: Vec<Opening>,
    /// Share of ground-floor bays that are shops, 0 to 1.
    pub shops: f64,
}

/// The styles of a city.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Styles(pub Vec<Style>);

/// What is wrong with a style.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StyleError {
    /// A list to choose from is empty.
    #[error("style `{style}`: `{field}` is empty; it needs at least one entry")]
    Empty {
        /// Which style.
        style: String,
        /// Which list.
        field: &'static str,
    },
    /// A range is not a range.
    #[error("style `{style}`: `{field}` is ({low}, {high}); it needs 0 < low ≤ high")]
    Range {
        /// Which style.
        style: String,
        /// Which range.
        field: &'static str,
        /// Its low end.
        low: f64,
        /// Its high end.
        high: f64,
    },
    /// Two styles share a name.
    #[error("two styles are called `{0}`")]
    Twice(String),
}

impl Styles {
    /// Index of a style by name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<usize> {
        self.0.iter().position(|style| style.name == name)
    }

    /// Everything wrong with the styles; empty if growth may draw from them.
    #[must_use]
    pub fn validate(&self) -> Vec<StyleError> {
        let mut errors = Vec::new();
        for (i, s) in self.0.iter().enumerate() {
            if self.find(&s.name) != Some(i) {
                errors.push(StyleError::Twice(s.name.clone()));
            }
            let lists = [
                ("walls", s.walls.is_empty()),
                ("roofs", s.roofs.is_empty()),
                ("roof_colours", s.roof_colours.is_empty()),
                ("main_windows", s.main_windows.is_empty()),
                ("windows", s.windows.is_empty()),
                ("ground_windows", s.ground_windows.is_empty()),
                ("doors", s.doors.is_empty()),
            ];
            for (field, empty) in lists {
                if empty {
                    errors.push(StyleError::Empty { style: s.name.clone(), field });
                }
            }
            let ranges = [
                ("storeys", Range(f64::from(s.storeys.0), f64::from(s.storeys.1))),
                ("ground_floor_m", s.ground_floor_m),
                ("storey_m", s.storey_m),
                ("bay_m", s.bay_m),
                ("frontage_m", s.frontage_m),
                ("depth_m", s.depth_m),
                ("pitch_deg", s.pitch_deg),
            ];
            for (field, Range(low, high)) in ranges {
                if !(low > 0.0 && low <= high && high < 1000.0) {
                    errors.push(StyleError::Range { style: s.name.clone(), field, low, high });
                }
            }
        }
        errors
    }
}
