//! Squares of ground, by which is told what is seen farther away than visible sets reach.

use std::collections::BTreeMap;

use veduta_city::{Cells, CityPlan, GRID_PER_METRE, GridPos};

use crate::directions::Directions;
use crate::lines::Frame;

/// Bits of a Morton code that tell where in a square of 128 m a place lies: no larger than the smallest regions of a stored city, so
/// that none is missed of which something is seen.
const WITHIN: u32 = 2 * (7 + GRID_PER_METRE.ilog2());

/// What is drawn with the cells whose middles lie in one square of 128 m.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Square {
    /// The first of the cells.
    pub(crate) cell: u32,
    /// Least and greatest corner of all.
    pub(crate) bounds: (GridPos, GridPos),
}

impl Square {
    /// Whether lines through a frame's portal in some of the directions in which they leave the sight may reach something of it: something
    /// beyond the sight, and no farther away than one sees.
    pub(crate) fn is_reached(&self, frame: &Frame, leaving: &[Directions], (sight_m, far_m): (f64, f64)) -> bool {
        if !self.is_about(frame.origin(), GridPos::steps(far_m + frame.width_m())) {
            return false;
        }
        let corners = self.corners().map(|corner| frame.local(corner));
        let half_m = 0.5 * frame.width_m();
        let off_m = |corner: (f64, f64)| libm::hypot(corner.0, corner.1 - half_m);
        let farthest_m = corners.into_iter().map(off_m).fold(0.0, f64::max);
        let across_m = libm::hypot(corners[0].0 - corners[2].0, corners[0].1 - corners[2].1);
        let is_beyond = farthest_m + half_m > sight_m && farthest_m - across_m - half_m <= far_m;
        is_beyond && leaving.iter().any(|slopes| slopes.reach(frame, corners))
    }

    /// Whether something of it may lie within so many grid steps of a place.
    fn is_about(&self, at: GridPos, reach: i32) -> bool {
        let (lo, hi) = self.bounds;
        let along = |lo: i32, hi: i32, at: i32| lo.saturating_sub(reach) <= at && at <= hi.saturating_add(reach);
        along(lo.0, hi.0, at.0) && along(lo.1, hi.1, at.1)
    }

    /// Corners of its bounds, around.
    pub(crate) const fn corners(&self) -> [GridPos; 4] {
        let (lo, hi) = self.bounds;
        [lo, GridPos(hi.0, lo.1), hi, GridPos(lo.0, hi.1)]
    }
}

/// All squares in which the middles of cells lie, by their first cells.
pub(crate) fn squares(plan: &CityPlan, cells: &Cells) -> Vec<Square> {
    let mut squares: BTreeMap<u64, Square> = BTreeMap::new();
    for (number, cell) in (0..).zip(&cells.cells) {
        let houses = cell.houses.iter().chain(cell.walls.iter().map(|(house, ..)| house));
        let volumes = houses.filter_map(|&house| plan.houses.get(house as usize)).flat_map(|house| &house.volumes);
        let spans = cell.spans.iter().filter_map(|&span| plan.spans.get(span as usize)).map(|span| span.outline());
        let spans: Vec<_> = spans.collect();
        let drawn = core::iter::once(&cell.outline).chain(&cell.yards).chain(volumes.map(|volume| &volume.footprint)).chain(&spans);
        for (lo, hi) in drawn.filter_map(|polygon| polygon.bounds()) {
            let square = squares.entry(cell.outline.middle().morton() >> WITHIN);
            let square = square.or_insert(Square { cell: number, bounds: (lo, hi) });
            let (low, high) = square.bounds;
            square.bounds = (GridPos(low.0.min(lo.0), low.1.min(lo.1)), GridPos(high.0.max(hi.0), high.1.max(hi.1)));
        }
    }
    let mut squares: Vec<Square> = squares.into_values().collect();
    squares.sort_unstable_by_key(|square| square.cell);
    squares
}
