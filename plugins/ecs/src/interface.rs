use std::collections::{BTreeMap, BTreeSet};

use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_city::Viewpoint;

/// How interfaces look and behave, whoever draws them. Live.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Resource)]
pub struct Interface {
    /// Size of letters and symbols: 1 as designed, 0.5 to 3.
    pub size: f32,
    /// Black and white, and nothing shines through.
    pub high_contrast: bool,
    /// Nothing slides, glides or grows.
    pub reduced_motion: bool,
    /// Whether keys belong to the interface: somebody types, or has chosen a control by the keyboard. Kept by whoever draws it.
    pub is_typing: bool,
}

impl Default for Interface {
    fn default() -> Self {
        Self { size: 1.0, high_contrast: false, reduced_motion: false, is_typing: false }
    }
}

/// How much of the window docks along its edges take, points: what lies over the picture keeps clear of them. Kept by whoever draws them.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Default)]
pub struct Docks {
    /// Along the left edge.
    pub left: f32,
    /// Along the right edge.
    pub right: f32,
    /// Along the lower edge.
    pub bottom: f32,
}

/// Runs where keys mean what they mean in the city, not letters that somebody types.
#[must_use]
pub fn keys_are_free(interface: Option<Res<Interface>>) -> bool {
    interface.is_none_or(|interface| !interface.is_typing)
}

/// Pointers that belong to the interface and mean nothing in the city. Kept by whoever draws it.
#[derive(Resource, Debug, Clone, PartialEq, Eq, Default)]
pub struct PointersTaken {
    /// Whether the mouse is over a window, or drags something of one.
    pub mouse: bool,
    /// Fingers that have begun over a window.
    pub touches: BTreeSet<u64>,
}

/// Asks for a walk by the shortest way along the streets, by whoever knows them (the guide).
#[derive(Message, Debug, Clone, PartialEq)]
pub struct WalkTo {
    /// Name of what lies there, as the visitor reads it.
    pub name: String,
    /// Where to stand and look in the end; the eye stays as high as it is.
    pub to: Viewpoint,
}

/// Names of places in the visitor's language, by their names in the map, where those differ. Kept by whoever knows them (the guide).
#[derive(Resource, Debug, Clone, PartialEq, Eq, Default)]
pub struct PlaceNames(
    /// By the name in the map.
    pub BTreeMap<String, String>,
);

impl PlaceNames {
    /// A name in the visitor's language.
    #[must_use]
    pub fn of<'a>(&'a self, name: &'a str) -> &'a str {
        self.0.get(name).map_or(name, String::as_str)
    }
}

/// Where the tour leads that is open, plan metres: a line for each part between cuts. Kept by whoever plays it; maps draw it.
#[derive(Resource, Debug, Clone, PartialEq, Default)]
pub struct TourPath(
    /// In the order in which they are gone.
    pub Vec<Vec<DVec2>>,
);

/// Asks maps to show a spot.
#[derive(Message, Debug, Clone, PartialEq)]
pub struct ShowOnMap {
    /// Name of what lies there, as the visitor reads it.
    pub name: String,
    /// Plan metres.
    pub plan_pos: DVec2,
}

/// A way that the visitor is led, or shown: maps and the ground draw it.
#[derive(Resource, Debug, Clone, PartialEq, Default)]
pub struct Route {
    /// Its corners, plan metres, in order; none where nobody is led.
    pub way: Vec<DVec2>,
    /// Where it leads, as the visitor reads it.
    pub name: String,
    /// Metres left to go.
    pub left_m: f64,
    /// Seconds left at the walk's speed.
    pub left_s: f64,
}
