//! Squares of ground, by which is told what is seen farther away than visible sets reach.

use std::collections::BTreeMap;

use rstar::{
    AABB, RTree, SelectionFunction,
    primitives::{GeomWithData, Rectangle},
};
use veduta_city::bounds::{self, Bounds};
use veduta_city::{Cells, CityPlan, GridPolygon, GridPos, House};

use crate::directions::Directions;
use crate::lines::Frame;
use crate::patches::corner;

/// What is drawn with the cells whose middles lie in one [square](GridPos::square). None is larger than the smallest regions of a stored
/// city, so that no region is missed of which something is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Square {
    /// The first of the cells.
    pub(crate) cell: u32,
    /// Least and greatest corner of all.
    pub(crate) bounds: Bounds,
}

impl Square {
    /// Whether lines through a frame's portal in some of the directions in which they leave the sight may reach something of it: something
    /// beyond the sight, and no farther away than one sees.
    pub(crate) fn is_reached(&self, frame: &Frame, leaving: &[Directions], (sight_m, far_m): (f64, f64)) -> bool {
        if !is_about(self.bounds, frame, far_m) {
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

    /// Corners of its bounds, around.
    pub(crate) const fn corners(&self) -> [GridPos; 4] {
        around(self.bounds)
    }
}

const fn around((lo, hi): Bounds) -> [GridPos; 4] {
    [lo, GridPos(hi.0, lo.1), hi, GridPos(lo.0, hi.1)]
}

/// Whether something of a box may lie so far from some line through a frame's portal.
fn is_about(bounds: Bounds, frame: &Frame, far_m: f64) -> bool {
    bounds::holds(bounds::grown(bounds, GridPos::steps(far_m + frame.width_m())), frame.origin())
}

/// Squares, which are told by their numbers, found by where lines lead.
pub(crate) struct Squares {
    pub(crate) all: Vec<Square>,
    tree: RTree<Numbered>,
}

type Numbered = GeomWithData<Rectangle<[f64; 2]>, u32>;

impl Squares {
    pub(crate) fn new(all: Vec<Square>) -> Self {
        let numbered = (0..)
            .zip(&all)
            .map(|(n, &Square { bounds: (lo, hi), .. })| GeomWithData::new(Rectangle::from_corners(corner(lo), corner(hi)), n));
        let tree = RTree::bulk_load(numbered.collect());
        Self { all, tree }
    }

    /// Those that [are reached](Square::is_reached), but for some that need not be looked at.
    pub(crate) fn reached<'a>(
        &'a self,
        frame: &'a Frame,
        leaving: &'a [Directions],
        range: (f64, f64),
        but: &'a [bool],
    ) -> impl Iterator<Item = u32> + 'a {
        self.tree.locate_with_selection_function(Reach { squares: &self.all, frame, leaving, range, but }).map(|square| square.data)
    }
}

/// Looks for what is reached: of what holds many squares, whether any direction leads there tells whether to look on.
struct Reach<'a> {
    squares: &'a [Square],
    frame: &'a Frame,
    leaving: &'a [Directions],
    range: (f64, f64),
    but: &'a [bool],
}

impl SelectionFunction<Numbered> for Reach<'_> {
    fn should_unpack_parent(&self, envelope: &AABB<[f64; 2]>) -> bool {
        let whole = |[x, y]: [f64; 2]| GridPos(x as i32, y as i32);
        let bounds = (whole(envelope.lower()), whole(envelope.upper()));
        let corners = around(bounds).map(|corner| self.frame.local(corner));
        is_about(bounds, self.frame, self.range.1) && self.leaving.iter().any(|slopes| slopes.reach(self.frame, corners))
    }

    fn should_unpack_leaf(&self, square: &Numbered) -> bool {
        let n = square.data as usize;
        !self.but[n] && self.squares[n].is_reached(self.frame, self.leaving, self.range)
    }
}

/// All squares in which the middles of cells lie, by their first cells.
pub(crate) fn squares(plan: &CityPlan, cells: &Cells) -> Vec<Square> {
    let about = |polygon: &GridPolygon| polygon.bounds();
    let about_house = |house: &House| house.volumes.iter().filter_map(|volume| about(&volume.footprint)).reduce(bounds::joined);
    let houses: Vec<Option<Bounds>> = plan.houses.iter().map(about_house).collect();
    let mut squares: BTreeMap<u64, Square> = BTreeMap::new();
    for (number, cell) in (0..).zip(&cells.cells) {
        let faced = cell.walls.chunk_by(|a, b| a.0 == b.0).map(|walls| &walls[0].0);
        let houses = cell.houses.iter().chain(faced).filter_map(|&house| *houses.get(house as usize)?);
        let spans = cell.spans.iter().filter_map(|&span| about(&plan.spans.get(span as usize)?.outline()));
        let ground = core::iter::once(&cell.outline).chain(&cell.yards).filter_map(about);
        let Some(bounds) = ground.chain(houses).chain(spans).reduce(bounds::joined) else { continue };
        let square = squares.entry(cell.outline.middle().square()).or_insert(Square { cell: number, bounds });
        square.bounds = bounds::joined(square.bounds, bounds);
    }
    let mut squares: Vec<Square> = squares.into_values().collect();
    squares.sort_unstable_by_key(|square| square.cell);
    squares
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn place() -> impl Strategy<Value = GridPos> {
        (-4_000..4_000_i32, -4_000..4_000_i32).prop_map(|(x, y)| GridPos(x * 1024, y * 1024))
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn the_tree_finds_what_is_reached_square_by_square(
            boxes in proptest::collection::vec((place(), 1..200_i32, 1..200_i32), 1..300), portal in (place(), 1..30_i32, -30..30_i32),
            slopes in proptest::collection::vec((-3.0..3.0_f64, 0.0..0.3_f64), 1..6), far_m in 500.0..4_000.0_f64,
        ) {
            let square = |(lo, width, depth): (GridPos, i32, i32)| Square { cell: 0, bounds: (lo, lo + GridPos(width * 1024, depth * 1024)) };
            let squares = Squares::new(boxes.into_iter().map(square).collect());
            let (right, x, y) = portal;
            let frame = Frame::new(right + GridPos(x * 1024, y * 1024), right).unwrap();
            let leaving: Vec<Directions> = slopes.into_iter().map(|(low, more)| Directions::within((low, low + more))).collect();
            let but: Vec<bool> = (0..squares.all.len()).map(|n| n % 5 == 0).collect();
            let range = (300.0, far_m);
            let mut reached: Vec<u32> = squares.reached(&frame, &leaving, range, &but).collect();
            reached.sort_unstable();
            let each = (0..).zip(&squares.all).filter(|&(n, square)| !but[n as usize] && square.is_reached(&frame, &leaving, range));
            prop_assert_eq!(reached, each.map(|(n, _)| n).collect::<Vec<u32>>());
        }
    }
}
