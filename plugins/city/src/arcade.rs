use serde::{Deserialize, Serialize};

/// A covered walk under a volume that hangs over it: arches between piers along a part of one of its walls, and behind them a vaulted
/// and paved ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Arcade {
    /// The wall above it: an index in the order of [`Volume::walls`](crate::Volume::walls).
    pub wall: u16,
    /// The part of the wall: distances from its start, grid steps.
    pub span: (i32, i32),
    /// How many arches, all of one breadth; 1 or more.
    pub arches: u8,
    /// Its paving above the city's zero, grid steps.
    pub floor: i32,
    /// Depth of the ground behind the wall's plane that it vaults and paves, grid steps; 0: arches alone, as where a walk ends.
    pub depth: i32,
}
