use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::Id;

/// Kind of a [`StandingObject`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum ObjectKind {
    /// Street lamp.
    Lamp,
    /// Broad-leaved tree: linden, maple, plane, chestnut.
    Tree,
    /// Conifer.
    Conifer,
    /// Bench.
    Bench,
    /// Fountain.
    Fountain,
    /// Statue or small monument on a plinth.
    Statue,
    /// Tram or bus stop: sign and shelter.
    TramStop,
    /// Bollard.
    Bollard,
    /// Kiosk, market stall.
    Kiosk,
    /// Well, pump.
    Well,
    /// Advertising column.
    Column,
    /// Waste bin.
    Bin,
    /// Traffic lights.
    Signals,
    /// Stop sign.
    Sign,
    /// Two metres of a clipped hedge.
    Hedge,
    /// Tub with flowers.
    Planter,
    /// Shrub.
    Shrub,
    /// Columnar tree: Lombardy poplar, hornbeam, cypress oak.
    Poplar,
    /// Birch.
    Birch,
    /// Weeping willow.
    Willow,
    /// Small tree that blossoms: cherry, apple, hawthorn.
    FruitTree,
    /// Palm.
    Palm,
    /// A café's table with its chairs under a parasol.
    Parasol,
}

impl ObjectKind {
    /// All of them.
    pub const ALL: [Self; 23] = [
        Self::Lamp,
        Self::Tree,
        Self::Conifer,
        Self::Bench,
        Self::Fountain,
        Self::Statue,
        Self::TramStop,
        Self::Bollard,
        Self::Kiosk,
        Self::Well,
        Self::Column,
        Self::Bin,
        Self::Signals,
        Self::Sign,
        Self::Hedge,
        Self::Planter,
        Self::Shrub,
        Self::Poplar,
        Self::Birch,
        Self::Willow,
        Self::FruitTree,
        Self::Palm,
        Self::Parasol,
    ];

    /// Those that are trees.
    pub const TREES: [Self; 7] = [Self::Tree, Self::Conifer, Self::Poplar, Self::Birch, Self::Willow, Self::FruitTree, Self::Palm];

    /// Whether it is a tree.
    #[must_use]
    pub const fn is_tree(self) -> bool {
        matches!(self, Self::Tree | Self::Conifer | Self::Poplar | Self::Birch | Self::Willow | Self::FruitTree | Self::Palm)
    }

    /// Radius of the ground on which one of its usual size stands, metres.
    #[must_use]
    pub const fn radius_m(self) -> f64 {
        match self {
            Self::Lamp | Self::Signals => 0.18,
            Self::Tree | Self::Conifer | Self::Poplar => 0.3,
            Self::Birch | Self::Palm => 0.22,
            Self::FruitTree => 0.18,
            Self::Willow => 0.4,
            Self::Bench | Self::Hedge | Self::Planter => 0.5,
            Self::Fountain => 1.9,
            Self::Statue => 0.95,
            Self::TramStop => 0.8,
            Self::Bollard => 0.16,
            Self::Kiosk => 1.3,
            Self::Parasol => 1.2,
            Self::Well => 0.85,
            Self::Column => 0.65,
            Self::Bin => 0.26,
            Self::Sign => 0.06,
            Self::Shrub => 0.7,
        }
    }
}

/// Something that stands in a street or square.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StandingObject {
    /// Stable id; hashed from kind and position when not given.
    #[serde(default)]
    pub id: Id,
    /// What it is.
    pub kind: ObjectKind,
    /// Plan metres.
    pub pos: DVec2,
    /// Where its front looks, degrees clockwise from north.
    #[serde(default)]
    pub heading_deg: f64,
    /// Height in metres; 0 means the kind's own.
    #[serde(default)]
    pub height_m: f64,
    /// Name, may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Name of the monument that it is seen as, in place of what its kind looks like; may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub monument: String,
}
