use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::Id;

/// What a [`Place`] is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum PlaceKind {
    /// A spot with a view.
    Viewpoint,
    /// A named or numbered house.
    House,
    /// A shop, inn or office.
    Shop,
    /// A monument, church, tower or fountain.
    Monument,
    /// A square.
    Square,
    /// A street.
    Street,
    /// Anything else with a name.
    #[default]
    Other,
}

/// Something with a name.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Place {
    /// Stable id; hashed from kind and position when not given.
    #[serde(default)]
    pub id: Id,
    /// Name as people say it.
    pub name: String,
    /// What it is.
    #[serde(default)]
    pub kind: PlaceKind,
    /// Where, in plan metres.
    pub pos: DVec2,
    /// How far away its information is shown, in metres.
    #[serde(default = "Place::default_radius_m")]
    pub radius_m: f64,
    /// A few sentences about it; may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub text: String,
    /// The stand from which to look at it, if one was chosen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub view: Option<Viewpoint>,
}

impl Place {
    /// Radius of places that give none, in metres.
    #[must_use]
    pub const fn default_radius_m() -> f64 {
        25.0
    }

    /// As overviews tell it: to whole centimetres and hundredths of degrees.
    #[must_use]
    pub fn rounded(&self) -> Self {
        Self {
            pos: self.pos.map(hundredth),
            radius_m: hundredth(self.radius_m),
            view: self.view.map(|view| Viewpoint {
                pos: view.pos.map(hundredth),
                eye_m: hundredth(view.eye_m),
                heading_deg: hundredth(view.heading_deg),
                pitch_deg: hundredth(view.pitch_deg),
            }),
            ..self.clone()
        }
    }
}

fn hundredth(n: f64) -> f64 {
    libm::round(n * 100.0) / 100.0
}

/// A stand and a direction of view.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Viewpoint {
    /// Plan metres.
    pub pos: DVec2,
    /// Metres above the ground.
    #[serde(default = "Viewpoint::default_eye_m")]
    pub eye_m: f64,
    /// Degrees clockwise from north.
    #[serde(default)]
    pub heading_deg: f64,
    /// Degrees, up is positive.
    #[serde(default)]
    pub pitch_deg: f64,
}

impl Viewpoint {
    /// Eye height of a standing person in metres.
    #[must_use]
    pub const fn default_eye_m() -> f64 {
        1.65
    }
}

impl Default for Viewpoint {
    fn default() -> Self {
        Self { pos: DVec2::ZERO, eye_m: Self::default_eye_m(), heading_deg: 0.0, pitch_deg: 0.0 }
    }
}
