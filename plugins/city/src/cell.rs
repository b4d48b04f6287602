use serde::{Deserialize, Serialize};

use crate::{GridPolygon, GridPos, Id};

/// Walkable space cut into cells that are joined by portals, with what belongs to each and what can be seen from it.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cells {
    /// Cells; others refer to them by index.
    pub cells: Vec<Cell>,
    /// Portals; cells refer to them by index.
    pub portals: Vec<Portal>,
    /// Visible set of each cell: indices of cells that can be seen from somewhere in it, itself included, ascending.
    pub visible: Vec<Vec<u32>>,
    /// Of each cell, what is seen from somewhere in it farther away than visible sets reach, along the ground or, in hills, over the roofs:
    /// one cell of each square of 128 m ([`GridPos::square`]) in which something is, ascending.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub far: Vec<Vec<u32>>,
    /// Cells whose tallest things rise above the roofs, and are seen over them from far away, ascending.
    #[serde(default)]
    pub skyline: Vec<u32>,
}

/// A polygon of walkable space on one floor.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cell {
    /// Stable id, hashed from the cell's place.
    pub id: Id,
    /// Name (of its square or street), may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Its space.
    pub outline: GridPolygon,
    /// Lowest and highest ground above the city's zero, grid steps; on slopes by the posts of the terrain about it.
    pub floor: (i32, i32),
    /// Portals on its border, ascending.
    pub portals: Vec<u32>,
    /// Walls that face it, as (house, volume, wall) indices of the plan, ascending. Every wall of every house belongs to
    /// exactly one cell.
    pub walls: Vec<(u32, u16, u16)>,
    /// Houses whose roofs it carries: those whose first wall is here, ascending.
    pub houses: Vec<u32>,
    /// Standing objects in it, as indices of the plan, ascending.
    pub objects: Vec<u32>,
    /// Markings whose middles lie in it, as indices of the plan, ascending.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub markings: Vec<u32>,
    /// Spans of ways whose middles lie in it, as indices of the plan, ascending.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub spans: Vec<u32>,
    /// Free space that nobody can reach (enclosed courtyards), nearer to this cell than to any other: its ground comes with the
    /// cell, so that nothing is missing from above.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub yards: Vec<GridPolygon>,
}

/// What lies beyond a portal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum PortalSide {
    /// Another cell: the portal can be crossed.
    Cell(u32),
    /// The edge of the modelled city: a blind portal, visible but not crossable.
    Edge,
}

/// An opening between a cell and what lies beyond, a straight line in plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Portal {
    /// Ends; the cell `cell` lies to the left of the way from the first to the second.
    pub ends: (GridPos, GridPos),
    /// The cell on the left.
    pub cell: u32,
    /// What lies on the right.
    pub beyond: PortalSide,
}

impl Portal {
    /// The cell on the other side, seen from one of its two cells.
    #[must_use]
    pub fn other(&self, from: u32) -> Option<u32> {
        match self.beyond {
            PortalSide::Edge => None,
            PortalSide::Cell(right) => Some(if from == self.cell { right } else { self.cell }),
        }
    }

    /// Whether it is the edge of the modelled city.
    #[must_use]
    pub const fn is_blind(&self) -> bool {
        matches!(self.beyond, PortalSide::Edge)
    }
}

impl Cells {
    /// The cell in which a position lies, by looking at all; `None` outside of every cell. Streaming follows portals
    /// instead and comes here only after a jump.
    #[must_use]
    pub fn locate(&self, pos: GridPos) -> Option<u32> {
        self.cells
            .iter()
            .position(|cell| {
                cell.outline.bounds().is_some_and(|(lo, hi)| lo.0 <= pos.0 && pos.0 <= hi.0 && lo.1 <= pos.1 && pos.1 <= hi.1)
                    && cell.outline.contains(pos)
            })
            .map(|i| i as u32)
    }
}
