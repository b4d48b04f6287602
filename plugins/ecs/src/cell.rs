use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use bevy::mesh::{MeshTag, MeshVertexAttribute, VertexFormat};
use bevy::prelude::*;
use veduta_city::{CellShell, FacadeSheet, GridPos, Level, Levels, PictureFile};

/// A cell of the open city that is wanted or loaded; one entity each, at the cell's origin.
#[derive(Component, Debug, Clone, Copy, PartialEq, Eq)]
#[require(Transform, Visibility, CellMemory)]
pub struct Cell(
    /// Index in the city.
    pub u32,
);

/// Bytes of memory of what was made of each of a cell's levels ([`Level::index`]): meshes and pictures, as the engine gets them. Kept by
/// whoever builds, for whoever holds a cap.
#[derive(Component, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CellMemory(
    /// By level.
    pub [u64; 4],
);

/// Memory of the meshes that show cells from afar. Kept by whoever builds.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DistrictMemory {
    /// Bytes of all.
    pub bytes: u64,
    /// How many parts of the overview they were made of.
    pub parts: usize,
}

/// What has arrived of a cell.
#[derive(Component, Debug, Clone)]
pub struct CellContent {
    /// Level 1: ground, houses, objects.
    pub shell: Arc<CellShell>,
    /// Level 2: openings.
    pub sheet: Option<Arc<FacadeSheet>>,
    /// Level 3: pictures of painted walls.
    pub pictures: Option<Arc<[PictureFile]>>,
}

/// Pictures of a cell's painted walls as textures, a layer for each of their sections. Kept by whoever builds, for whoever provides
/// materials.
#[derive(Component, Debug, Clone, PartialEq, Eq)]
pub struct CellPictures {
    /// Level 2.
    pub coarse: Handle<Image>,
    /// Level 3, once it is here.
    pub fine: Option<Handle<Image>>,
}

/// Of meshes in relief: the normal (x, z) of the wall that a vertex belongs to, and how far before the wall it lies, metres. Whoever provides
/// materials flattens it by that. Zero of what is never flattened.
pub const ATTRIBUTE_RELIEF: MeshVertexAttribute =
    MeshVertexAttribute::new("Veduta_Relief", 0x5665_6475_7461_0001, VertexFormat::Float32x3);

/// What a mesh of a cell shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CellMeshKind {
    /// The cell from afar, made of the overview: shown as long as the cell does not stand. No child of the cell.
    District,
    /// Ground with its paint, bridges, and the coverings of roofs: shown at every distance.
    Base,
    /// Walls of one level, or its monuments: a mesh each.
    Walls(Level),
    /// Walls that somebody painted, flat (level 2) or in relief (level 4). Their texture coordinates lie on the layers of the cell's
    /// [`CellPictures`].
    Painted(Level),
    /// What is there from the first and shown as near as level 2: chimneys, dormers and eaves; standing objects but trees.
    Fittings,
    /// Trees. With [`MaterialsProvided`] cards at level 1 and bodies from level 2 on; else bodies at level 1.
    Trees(Level),
}

impl CellMeshKind {
    /// The level that it belongs to; `None` of what stands with the cell whatever its levels.
    #[must_use]
    pub const fn level(self) -> Option<Level> {
        match self {
            Self::District | Self::Base | Self::Fittings => None,
            Self::Walls(level) | Self::Painted(level) | Self::Trees(level) => Some(level),
        }
    }
}

/// A mesh of a cell; a child of its [`Cell`], but for a [district](CellMeshKind::District). Whoever provides materials answers its arrival,
/// and hands the cell's fades to the shader in the mesh's tag.
#[derive(Component, Debug, Clone, Copy, PartialEq, Eq)]
#[require(MeshTag)]
pub struct CellMesh {
    /// Index of the cell.
    pub cell: u32,
    /// What it shows.
    pub kind: CellMeshKind,
}

/// How far each level of a cell has faded in, 0 to 1; level n at index n − 1. Zero for a level that is not there.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq, Default)]
#[reflect(Component)]
pub struct LevelFade(
    /// One for each level.
    pub [f32; 4],
);

/// Present where a plugin gives cell meshes their materials; else whoever spawns them gives plain ones. Its materials switch levels, cut
/// cards out by their tiles and show of a tree's cards the one that looks towards the eye.
#[derive(Resource, Debug, Default, Clone, Copy)]
pub struct MaterialsProvided {
    /// Whether the materials can be given yet. Cells stand only when they can: nobody would see them.
    pub are_made: bool,
    /// Whether the GPU is to be given textures in blocks (BC).
    pub reads_blocks: bool,
}

/// The viewer has crossed into another cell, or out of every cell.
#[derive(Message, Debug, Clone, Copy, PartialEq, Eq)]
pub struct CellEntered {
    /// The viewer.
    pub viewer: Entity,
    /// The cell; `None` outside of every cell.
    pub cell: Option<u32>,
}

/// The packet of a cell's level is here and verified; its content is on the entity.
#[derive(Message, Debug, Clone, Copy, PartialEq, Eq)]
pub struct CellReady {
    /// The cell's entity.
    pub entity: Entity,
    /// The cell.
    pub cell: u32,
    /// The level.
    pub level: Level,
}

/// The meshes of a cell's level have been spawned.
#[derive(Message, Debug, Clone, Copy, PartialEq, Eq)]
pub struct CellStands {
    /// The cell's entity.
    pub entity: Entity,
    /// The cell.
    pub cell: u32,
    /// The level.
    pub level: Level,
}

/// A cell is gone, with all its levels.
#[derive(Message, Debug, Clone, Copy, PartialEq, Eq)]
pub struct CellReleased {
    /// The cell.
    pub cell: u32,
}

/// What viewers wait for: level 1 of cells, and what is to tell of them. What cannot be had is not waited for. Streaming counts
/// what nobody has built ([`CellStands`]); without it nothing is awaited.
#[derive(Resource, Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Awaited {
    /// How many that are in sight of a viewer do not stand. Who puts a viewer somewhere keeps it dark until there are none.
    pub cells: usize,
    /// How many would be in sight, and do not stand, from the first stop of a viewer's [`Itinerary`](crate::Itinerary). Who leads a viewer stands
    /// still until there are none. Above the roofs districts stand for cells, and nothing is waited for.
    pub ahead: usize,
}

/// Cells that may be walked into: those from which nothing would be missing. The portals of all others are shut. Streaming keeps it;
/// without it every cell is open.
#[derive(Resource, Debug, Default, Clone, PartialEq, Eq)]
pub struct OpenCells {
    /// Those of the viewers and those next to them that are open; `None` as long as nobody keeps it.
    pub cells: Option<BTreeSet<u32>>,
}

impl OpenCells {
    /// Whether one may walk from one cell into another.
    #[must_use]
    pub fn lead(&self, from: u32, to: u32) -> bool {
        from == to || self.cells.as_ref().is_none_or(|cells| cells.contains(&to))
    }
}

/// Cells that stand at level 1 or better, by index: what can be walked on. Kept by whoever builds.
#[derive(Resource, Debug, Default, Clone)]
pub struct StandingCells {
    cells: BTreeMap<u32, (Levels, Arc<CellShell>)>,
}

impl StandingCells {
    /// A level of a cell stands.
    pub fn add(&mut self, cell: u32, level: Level, shell: &Arc<CellShell>) {
        let entry = self.cells.entry(cell).or_insert_with(|| (Levels::NONE, Arc::clone(shell)));
        entry.0 = entry.0.with(level);
    }

    /// A level of a cell is gone; the cell stands on with the others.
    pub fn remove_level(&mut self, cell: u32, level: Level) {
        if let Some(entry) = self.cells.get_mut(&cell) {
            entry.0 = entry.0.without(level);
        }
    }

    /// A cell is gone.
    pub fn remove(&mut self, cell: u32) {
        self.cells.remove(&cell);
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.cells.clear();
    }

    /// The levels of a cell that stand.
    #[must_use]
    pub fn levels(&self, cell: u32) -> Levels {
        self.cells.get(&cell).map_or(Levels::NONE, |entry| entry.0)
    }

    /// Standing cells from one index to another in order, with their levels; none if the first is the larger.
    pub fn within(&self, first: u32, last: u32) -> impl Iterator<Item = (u32, Levels)> {
        let range = (first <= last).then(|| self.cells.range(first..=last));
        range.into_iter().flatten().map(|(&cell, &(levels, _))| (cell, levels))
    }

    /// Whether a plan position lies in a cell that stands: walking ends elsewhere.
    #[must_use]
    pub fn hold(&self, pos: GridPos) -> bool {
        self.cells.values().any(|(_, shell)| shell.outline.contains(pos - shell.origin))
    }

    /// Number of cells that stand.
    #[must_use]
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// Whether none stands.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// All standing cells in order, with their levels and content.
    pub fn iter(&self) -> impl Iterator<Item = (u32, Levels, &Arc<CellShell>)> {
        self.cells.iter().map(|(&cell, (levels, shell))| (cell, *levels, shell))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use veduta_city::GridPolygon;

    #[test]
    fn only_standing_cells_hold() {
        let outline = GridPolygon::simple(vec![GridPos(0, 0), GridPos(2048, 0), GridPos(2048, 2048), GridPos(0, 2048)]);
        let shell = Arc::new(CellShell { origin: GridPos(10_240, 0), outline, ..CellShell::default() });
        let mut standing = StandingCells::default();
        assert!(!standing.hold(GridPos(11_000, 100)));
        standing.add(4, Level::One, &shell);
        assert!(standing.hold(GridPos(11_000, 100)) && !standing.hold(GridPos(100, 100)));
        assert!(standing.levels(4).has(Level::One) && !standing.levels(4).has(Level::Two));
        standing.add(9, Level::One, &shell);
        let within = |first, last| standing.within(first, last).map(|(cell, _)| cell).collect::<Vec<_>>();
        assert_eq!((within(0, 4), within(4, 9), within(5, 8), within(9, 4)), (vec![4], vec![4, 9], vec![], vec![]));
        standing.remove(9);
        standing.remove(4);
        assert!(standing.is_empty() && !standing.hold(GridPos(11_000, 100)));
    }
}
