use core::fmt;

use serde::{Deserialize, Serialize};

use crate::{
    Arcade, Course, Design, Gable, GridPolygon, GridPos, GroundPatch, Marking, ObjectKind, PaintedWall, PlacedMonument, PlanObject,
    PlanRoof, PlanTerrain, Rgb, Volume, Wall, WaySpan,
};

/// Urban level of detail of a façade.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[repr(u8)]
pub enum Level {
    /// Coloured outline.
    One = 1,
    /// With small repeated textures for windows, doors, paintings.
    Two = 2,
    /// With one full façade texture.
    Three = 3,
    /// Textured 3D model.
    Four = 4,
}

impl Level {
    /// All levels, coarsest first.
    pub const ALL: [Self; 4] = [Self::One, Self::Two, Self::Three, Self::Four];

    /// 0 for level 1, … 3 for level 4.
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize - 1
    }

    /// The level with an index, 0 to 3.
    #[must_use]
    pub const fn from_index(index: usize) -> Option<Self> {
        match index {
            0 => Some(Self::One),
            1 => Some(Self::Two),
            2 => Some(Self::Three),
            3 => Some(Self::Four),
            _ => None,
        }
    }
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "level {}", *self as u8)
    }
}

/// A set of levels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Levels(u8);

impl Levels {
    /// No level.
    pub const NONE: Self = Self(0);
    /// Every level.
    pub const ALL: Self = Self(0b1111);

    /// Whether a level is in the set.
    #[must_use]
    pub const fn has(self, level: Level) -> bool {
        self.0 >> level.index() & 1 == 1
    }

    /// The set with a level added.
    #[must_use]
    pub const fn with(self, level: Level) -> Self {
        Self(self.0 | 1 << level.index())
    }

    /// The set with a level taken out.
    #[must_use]
    pub const fn without(self, level: Level) -> Self {
        Self(self.0 & !(1 << level.index()))
    }

    /// The finest level in the set.
    #[must_use]
    pub fn finest(self) -> Option<Level> {
        Level::ALL.into_iter().rev().find(|&level| self.has(level))
    }
}

/// Content of a level-1 packet: all that stands and lies in a cell, walls as coloured outlines. Positions are relative to
/// [`CellShell::origin`] in plan, heights to the city's zero; those of ground and markings to the terrain.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CellShell {
    /// Plan position that the others are relative to.
    pub origin: GridPos,
    /// The cell's space.
    pub outline: GridPolygon,
    /// Elevations of the ground, yards and houses included.
    #[serde(default, skip_serializing_if = "PlanTerrain::is_level")]
    pub terrain: PlanTerrain,
    /// Ground, yards included.
    pub ground: Vec<GroundPatch>,
    /// What patches are laid along, as much as is needed here.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub courses: Vec<Course>,
    /// Houses with at least one wall or roof here.
    pub houses: Vec<HouseShell>,
    /// Standing objects.
    pub objects: Vec<ObjectShell>,
    /// Ends of the blind portals on the cell's border, where walking ends: the cell lies to the left of the way from the first to the second.
    pub blind: Vec<(GridPos, GridPos)>,
    /// Paint and rails on the ground.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub markings: Vec<Marking>,
    /// Spans of ways that lie over or under the cell, or end at it: first those that it draws.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub spans: Vec<WaySpan>,
    /// How many of them it draws.
    #[serde(default)]
    pub drawn_spans: u32,
    /// Designs of the monuments.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub designs: Vec<Design>,
    /// Monuments that this cell draws, by index of [`CellShell::designs`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub monuments: Vec<PlacedMonument>,
}

/// A house, or that part of it which faces the cell.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HouseShell {
    /// Index of its style in the city.
    pub style: u16,
    /// Its lowest floor above the city's zero, grid steps: what begins there stands on the ground.
    pub floor: i32,
    /// Its volumes that have something here.
    pub volumes: Vec<VolumeShell>,
    /// Whether a monument is seen in place of its walls and roofs, which only stop people then.
    pub is_monument: bool,
}

/// Something that stands in the cell. See [`PlanObject`] for the fields.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectShell {
    /// What it is.
    pub kind: ObjectKind,
    /// Where.
    pub pos: GridPos,
    /// Its foot above the city's zero, grid steps.
    pub z: i32,
    /// Where its front looks, whole degrees clockwise from north, 0 to 359.
    pub heading: u16,
    /// Height, grid steps; never 0.
    pub height: i32,
    /// Index of [`CellShell::designs`], if it is seen as one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub monument: Option<u16>,
}

impl ObjectShell {
    /// An object of the plan, in its coordinates, by the kind that it is.
    #[must_use]
    pub const fn of(object: &PlanObject) -> Self {
        let &PlanObject { kind, pos, z, heading, height, .. } = object;
        Self { kind, pos, z, heading, height, monument: None }
    }
}

/// A volume, or that part of it which faces the cell.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VolumeShell {
    /// Whole outline.
    pub footprint: GridPolygon,
    /// Foot of the walls above the city's zero, grid steps.
    pub bottom: i32,
    /// Eaves above the city's zero, grid steps.
    pub eaves: i32,
    /// Colour of the walls.
    pub colour: Rgb,
    /// Colour of mouldings.
    pub trim: Rgb,
    /// The roof. Always told, so that gables can be built; drawn with the cell that has `has_roof`.
    pub roof: PlanRoof,
    /// Shape of its gables.
    pub gable: Gable,
    /// Whether this cell draws the roof (and the underside, where the volume hangs in the air).
    pub has_roof: bool,
    /// Which edges' walls this cell draws: indices in the order of [`crate::Volume::walls`], ascending.
    pub walls: Vec<u16>,
    /// Walks under those walls.
    pub arcades: Vec<Arcade>,
}

impl VolumeShell {
    /// A volume as a cell tells it that draws some of its walls and perhaps its roof, if it has one, in the plan's coordinates.
    #[must_use]
    pub fn of(volume: &Volume, walls: Vec<u16>, has_roof: bool) -> Self {
        let arcades = volume.arcades.iter().filter(|arcade| walls.contains(&arcade.wall));
        Self {
            arcades: arcades.copied().collect(),
            footprint: volume.footprint.clone(),
            bottom: volume.bottom,
            eaves: volume.eaves,
            colour: volume.colour,
            trim: volume.trim,
            roof: volume.roof,
            gable: volume.gable,
            has_roof: has_roof && volume.roof.is_there(),
            walls,
        }
    }
}

/// Content of a level-2 packet: the openings of every wall of the cell, in the order in which [`CellShell`] lists them
/// (house by house, volume by volume, wall by wall).
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FacadeSheet {
    /// One for each wall.
    pub walls: Vec<Wall>,
    /// Those of them that somebody painted, ascending. Their pictures are the level-3 packet: those of
    /// each of them ([`PaintedFacade::pictures`](crate::PaintedFacade::pictures)), in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub painted: Vec<PaintedWall>,
}

impl FacadeSheet {
    /// Most sections of all painted walls of a cell: so many layers of a texture, 45 MB without blocks.
    pub const MOST_SECTIONS: usize = 32;

    /// A sheet without painted walls.
    #[must_use]
    pub const fn of(walls: Vec<Wall>) -> Self {
        Self { walls, painted: Vec::new() }
    }

    /// How many pictures its level-3 packet has.
    #[must_use]
    pub fn pictures(&self) -> usize {
        self.painted.iter().map(|wall| wall.painted.pictures()).sum()
    }

    /// How many sections its painted walls have together.
    #[must_use]
    pub fn sections(&self) -> usize {
        self.painted.iter().map(|wall| usize::from(wall.painted.sections)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_count_from_coarse_to_fine() {
        let some = Levels::NONE.with(Level::One).with(Level::Three);
        assert_eq!(some.finest(), Some(Level::Three));
        assert!(!some.has(Level::Two));
        assert_eq!(some.without(Level::Three).finest(), Some(Level::One));
        for level in Level::ALL {
            assert_eq!(Level::from_index(level.index()), Some(level));
        }
    }
}
