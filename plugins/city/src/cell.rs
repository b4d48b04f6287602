use glam::DVec2;
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

    /// Where a way from a place meets it, both in plan metres: which share of the way, which may be more than all of it, and which share
    /// of the portal from its first end. `None` behind the place, beside the portal, and along it.
    #[must_use]
    pub fn meets(&self, from: DVec2, way: DVec2) -> Option<(f64, f64)> {
        let a = self.ends.0.to_metres();
        let edge = self.ends.1.to_metres() - a;
        let across = way.perp_dot(edge);
        if across.abs() < 1e-9 {
            return None;
        }
        let (t, u) = ((a - from).perp_dot(edge) / across, (a - from).perp_dot(way) / across);
        (t > 0.0 && (0.0..=1.0).contains(&u)).then_some((t, u))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_meets_the_portal_before_it() {
        let ends = (GridPos(10 * 1024, -5 * 1024), GridPos(10 * 1024, 5 * 1024));
        let portal = Portal { ends, cell: 0, beyond: PortalSide::Cell(1) };
        assert_eq!(portal.meets(DVec2::ZERO, DVec2::X), Some((10.0, 0.5)));
        assert_eq!(portal.meets(DVec2::new(0.0, 4.0), DVec2::X * 20.0), Some((0.5, 0.9)));
        assert_eq!(portal.meets(DVec2::ZERO, -DVec2::X), None, "it lies behind");
        assert_eq!(portal.meets(DVec2::new(0.0, 6.0), DVec2::X), None, "beside");
        assert_eq!(portal.meets(DVec2::ZERO, DVec2::Y), None, "along");
    }
}
