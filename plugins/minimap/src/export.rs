use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_cartography::{Colours, Layers};

/// Formats in which a map is saved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Reflect)]
pub enum MapFormat {
    /// Shapes and text.
    Svg,
    /// Pixels.
    Png,
}

/// Asks for what the large map shows to be saved, by whoever may write files: a game.
#[derive(Message, Debug, Clone, PartialEq)]
pub struct ExportMap {
    /// How.
    pub format: MapFormat,
    /// Its middle, plan metres.
    pub middle: DVec2,
    /// What it shows across and up, metres.
    pub size_m: DVec2,
    /// Heading that points up, degrees clockwise from north.
    pub up_deg: f64,
    /// What it shows.
    pub layers: Layers,
    /// In which inks.
    pub colours: Colours,
}
