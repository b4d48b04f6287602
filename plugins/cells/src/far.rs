//! Squares of ground, by which is told what is seen farther away than visible sets reach.

use std::collections::BTreeMap;

use veduta_city::bounds::{self, Bounds};
use veduta_city::{Cells, CityPlan, GridPos};

/// What is drawn with the cells whose middles lie in one [square](GridPos::square). None is larger than the smallest regions of a stored
/// city, so that no region is missed of which something is seen.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Square {
    /// The first of the cells.
    pub(crate) cell: u32,
    /// Least and greatest corner of all.
    bounds: Bounds,
}

impl Square {
    /// Whether something of it may lie within so many grid steps of a place.
    pub(crate) fn is_about(&self, at: GridPos, reach: i32) -> bool {
        bounds::holds(bounds::grown(self.bounds, reach), at)
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
        for bounds in drawn.filter_map(|polygon| polygon.bounds()) {
            let square = squares.entry(cell.outline.middle().square()).or_insert(Square { cell: number, bounds });
            square.bounds = bounds::joined(square.bounds, bounds);
        }
    }
    let mut squares: Vec<Square> = squares.into_values().collect();
    squares.sort_unstable_by_key(|square| square.cell);
    squares
}
