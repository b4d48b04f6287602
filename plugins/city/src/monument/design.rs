use serde::{Deserialize, Serialize};

use super::shape::Shape;
use crate::{Rgb, Tile};

/// What a part of a monument is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// What the tile is multiplied by.
    pub colour: Rgb,
    /// Texture; a bay's tile is stretched over the front of what it covers.
    pub tile: Tile,
}

/// An axis of a part's frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Axis {
    /// Left and right change places.
    X,
    /// Front and back change places.
    Y,
}

/// How a part is repeated, in the frame of what it is part of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Repeat<N> {
    /// In a row.
    Row {
        /// How many, the first included.
        count: N,
        /// From one to the next, metres.
        step: [N; 3],
        /// Whether the row's middle stands where its first would.
        #[serde(default)]
        centred: bool,
    },
    /// About the upright axis.
    Around {
        /// How many, the first included.
        count: N,
        /// Degrees from the first to the last and one step on, clockwise seen from above; a whole turn without.
        #[serde(default = "whole_turn")]
        arc_deg: Option<N>,
        /// From one to the next, upwards; metres.
        #[serde(default = "whole_turn")]
        rise: Option<N>,
    },
}

/// A field that may be left out. (What serde would assume asks for `N: Default`.)
const fn whole_turn<N>() -> Option<N> {
    None
}

/// A monument with all its formulas worked out: what a plan and a packet carry. Lengths are grid steps, angles hundredths of a
/// degree, ratios 1/1024.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Design {
    /// Name of the monument.
    pub name: String,
    /// Pieces refer to them by index.
    pub materials: Vec<Material>,
    /// Drawn one after the other.
    pub pieces: Vec<Piece>,
}

/// A piece of a [`Design`]: a shape or a group, placed: scaled, rolled, tilted, turned, moved, mirrored and repeated, in this order.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Piece {
    /// Grid steps.
    pub at: [i32; 3],
    /// About x (its top leans back), about y (its top leans to the right), about z (clockwise seen from above).
    pub turn: [i32; 3],
    /// 1024 for 1.
    pub scale: [i32; 3],
    /// A second one, mirrored at the plane through the origin of what it is part of.
    pub mirror: Option<Axis>,
    /// More of it.
    pub repeat: Option<Repeat<i32>>,
    /// What it is made of; index of [`Design::materials`].
    pub paint: u8,
    /// What fills its holes or gables.
    pub infill: Option<u8>,
    /// What it is.
    pub content: Content,
}

/// What a [`Piece`] is.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Content {
    /// A solid.
    Shape(Shape<i32>),
    /// Several, placed together.
    Pieces(Vec<Piece>),
}

impl<N> Repeat<N> {
    /// How many.
    pub const fn count(&self) -> &N {
        match self {
            Self::Row { count, .. } | Self::Around { count, .. } => count,
        }
    }
}

impl Piece {
    /// How many shapes it stands for, repetitions counted.
    #[must_use]
    pub fn shape_count(&self) -> u64 {
        let copies = self.repeat.map_or(1, |repeat| u64::from((*repeat.count()).max(0).unsigned_abs()));
        let copies = if self.mirror.is_some() { copies.saturating_mul(2) } else { copies };
        let inner = match &self.content {
            Content::Shape(_) => 1,
            Content::Pieces(pieces) => pieces.iter().map(Self::shape_count).fold(0, u64::saturating_add),
        };
        copies.saturating_mul(inner)
    }
}

impl Design {
    /// How many shapes it stands for, repetitions counted.
    #[must_use]
    pub fn shape_count(&self) -> u64 {
        self.pieces.iter().map(Piece::shape_count).fold(0, u64::saturating_add)
    }
}
