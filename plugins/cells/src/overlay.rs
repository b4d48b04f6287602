//! Boolean operations on the integer grid, and the cheap cuts that keep their inputs small.

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay, ShapeType};
use i_overlay::core::solver::Solver;
use i_overlay::i_float::int::point::IntPoint;
use i_overlay::vector::edge::{CLIP_LEFT, CLIP_RIGHT, SUBJ_LEFT, SUBJ_RIGHT, VectorEdge};
pub(crate) use veduta_city::bounds::Bounds;
pub(crate) use veduta_city::ring_edges as edges;
use veduta_city::{BorderEdge, GridPolygon, GridPos, GridRing, connected_faces};

/// From one vertex to the next.
pub(crate) type Edge = (GridPos, GridPos);

/// Twice the signed area of a ring in grid steps squared: positive if it runs counter-clockwise.
pub(crate) fn ring_area_2(ring: &[GridPos]) -> i64 {
    let Some(&origin) = ring.first() else { return 0 };
    edges(ring).fold(0, |sum, (a, b)| sum.saturating_add(origin.cross(a, b)))
}

/// Square metres of several polygons.
pub(crate) fn total_m2(shapes: &[GridPolygon]) -> f64 {
    shapes.iter().map(GridPolygon::area_m2).sum()
}

/// The rings of a polygon turned as they should be: outer counter-clockwise, holes clockwise; those without area left out.
pub(crate) fn turned_rings(polygon: &GridPolygon) -> impl Iterator<Item = GridRing> + '_ {
    polygon.rings().enumerate().filter_map(|(i, ring)| {
        let area = ring_area_2(ring);
        if area == 0 {
            return None;
        }
        let mut ring = ring.clone();
        if (area > 0) != (i == 0) {
            ring.reverse();
        }
        Some(ring)
    })
}

/// Edges up to which the engine's own choice of solver is sound. It sorts more by columns, and misses that edges lie on each other where they
/// begin in different columns (4.5.2; mended in 9.0): whole houses then count as free space.
const MOST_WITHOUT_COLUMNS: usize = 16_000;

/// What of two sets of rings, each filled where it winds around, is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Keep {
    /// What the first covers.
    First,
    /// What both cover.
    Both,
    /// What the first covers and the second does not.
    FirstAlone,
}

impl Keep {
    const fn holds(self, first: bool, second: bool) -> bool {
        match self {
            Self::First => first,
            Self::Both => first && second,
            Self::FirstAlone => first && !second,
        }
    }

    /// An edge between what is kept and what is not, with the former on its left.
    fn border(self, edge: &VectorEdge) -> Option<BorderEdge> {
        let has = |bit: u8| edge.fill & bit != 0;
        let left = self.holds(has(SUBJ_LEFT), has(CLIP_LEFT));
        let right = self.holds(has(SUBJ_RIGHT), has(CLIP_RIGHT));
        let (a, b) = (GridPos(edge.a.x, edge.a.y), GridPos(edge.b.x, edge.b.y));
        (left != right).then_some(if left { (a, b) } else { (b, a) })
    }
}

/// Combines two sets of rings. Results are valid polygons: outer rings counter-clockwise, holes clockwise, interiors connected.
/// `keep_collinear` keeps vertices in the middle of straight lines.
pub(crate) fn combine(
    keep: Keep,
    first: impl IntoIterator<Item = GridRing>,
    second: impl IntoIterator<Item = GridRing>,
    keep_collinear: bool,
) -> Vec<GridPolygon> {
    // Only the engine's arrangement of edges is used: its ways of tracing shapes may go in circles for ever where many rings touch.
    let (first, second): (Vec<GridRing>, Vec<GridRing>) = (first.into_iter().collect(), second.into_iter().collect());
    let count: usize = first.iter().chain(&second).map(Vec::len).sum();
    let solver = if count > MOST_WITHOUT_COLUMNS { Solver::LIST } else { Solver::AUTO };
    let mut overlay = Overlay::new_custom(64, IntOverlayOptions::keep_all_points(), solver);
    let step = GridPos::common_step(first.iter().chain(&second).flatten());
    let to_int = |p: GridPos| IntPoint::new(p.0 / step, p.1 / step);
    for ring in first {
        overlay.add_path_iter(ring.into_iter().map(to_int), ShapeType::Subject);
    }
    for ring in second {
        overlay.add_path_iter(ring.into_iter().map(to_int), ShapeType::Clip);
    }
    let edges = overlay.build_separate_vectors(FillRule::NonZero);
    let out = |p: GridPos| GridPos(p.0.saturating_mul(step), p.1.saturating_mul(step));
    let borders = edges.iter().filter_map(|edge| keep.border(edge)).map(|(a, b)| (out(a), out(b))).collect();
    drop((overlay, edges));
    connected_faces(borders, keep_collinear)
}

/// The part of `patch` within `window`, whose bounds are given. Exact up to the snapping of crossings to the grid, and cheap
/// where a huge patch meets a small window.
pub(crate) fn clip_patch(patch: &GridPolygon, window: &GridPolygon, bounds: Bounds) -> Vec<GridPolygon> {
    let mut rings: Vec<GridRing> = turned_rings(patch).map(|ring| pull_in(&ring, bounds)).collect();
    rings.retain(|ring| ring.len() > 2 && ring_area_2(ring) != 0);
    match rings.as_slice() {
        [] => return Vec::new(),
        [ring] if ring_area_2(ring) > 0 && is_box(ring, bounds) => return vec![window.clone()],
        _ => {}
    }
    combine(Keep::Both, rings, turned_rings(window), true)
}

/// A ring with the parts outside a box pulled onto its sides: inside the box nothing changes, not even by rounding, and how
/// often the ring winds around any point inside stays the same. (Each vertex moves straight to the nearest point of the box,
/// and only if both its edges stay beyond one side of the box all the way.)
pub(crate) fn pull_in(ring: &[GridPos], (lo, hi): Bounds) -> GridRing {
    let beyond =
        |p: GridPos| u8::from(p.0 <= lo.0) | u8::from(p.0 >= hi.0) << 1 | u8::from(p.1 <= lo.1) << 2 | u8::from(p.1 >= hi.1) << 3;
    let n = ring.len();
    let mut pulled: GridRing = Vec::new();
    for (i, &p) in ring.iter().enumerate() {
        let (before, after) = (ring[(i + n - 1) % n], ring[(i + 1) % n]);
        let is_clear = beyond(p) & beyond(before) != 0 && beyond(p) & beyond(after) != 0;
        let p = if is_clear { GridPos(p.0.clamp(lo.0, hi.0), p.1.clamp(lo.1, hi.1)) } else { p };
        push_straight(&mut pulled, p);
    }
    // The seam between last and first.
    while pulled.len() > 2 {
        let (first, second, last) = (pulled[0], pulled[1], pulled[pulled.len() - 1]);
        if is_straight(pulled[pulled.len() - 2], last, first) {
            pulled.pop();
        } else if is_straight(last, first, second) {
            pulled.remove(0);
        } else {
            break;
        }
    }
    pulled
}

fn push_straight(ring: &mut GridRing, p: GridPos) {
    while let [.., a, b] = ring.as_slice()
        && is_straight(*a, *b, p)
    {
        ring.pop();
    }
    if ring.last() != Some(&p) {
        ring.push(p);
    }
}

/// Whether three vertices lie on a line along an axis, so that the middle one can go.
fn is_straight(a: GridPos, b: GridPos, c: GridPos) -> bool {
    (a.0 == b.0 && b.0 == c.0) || (a.1 == b.1 && b.1 == c.1)
}

fn is_box(ring: &[GridPos], (lo, hi): Bounds) -> bool {
    ring.len() == 4 && ring.iter().all(|p| (p.0 == lo.0 || p.0 == hi.0) && (p.1 == lo.1 || p.1 == hi.1))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn rect(x: i32, y: i32, w: i32, h: i32) -> GridPolygon {
        GridPolygon::simple(vec![GridPos(x, y), GridPos(x + w, y), GridPos(x + w, y + h), GridPos(x, y + h)])
    }

    #[test]
    fn a_window_inside_a_patch_is_the_whole_window() {
        let window = GridPolygon::simple(vec![GridPos(10, 10), GridPos(30, 12), GridPos(20, 40)]);
        let bounds = window.bounds().unwrap();
        assert_eq!(clip_patch(&rect(0, 0, 100, 100), &window, bounds), core::slice::from_ref(&window));
        assert!(clip_patch(&rect(200, 0, 100, 100), &window, bounds).is_empty());
    }

    #[test]
    fn a_hole_that_touches_the_outer_ring_still_runs_clockwise() {
        let square = rect(0, 0, 120, 120);
        let houses = [rect(35, 61, 14, 5), rect(49, 66, 3, 11), rect(16, 97, 35, 23), rect(15, 67, 34, 30)];
        let free = combine(Keep::FirstAlone, turned_rings(&square), houses.iter().flat_map(turned_rings), true);
        let area: i64 = free.iter().flat_map(GridPolygon::rings).map(|ring| ring_area_2(ring)).sum();
        assert_eq!(area / 2, 120 * 120 - 14 * 5 - 3 * 11 - 35 * 23 - 34 * 30);
    }

    #[test]
    fn edges_on_each_other_are_found_among_many() {
        // Bars, and the same with vertices in the middle of their sides, at which nothing else ends.
        let corner = |n: i32| (n % 10 * 4_000, n / 10 * 20);
        let whole: Vec<GridRing> = (0..2_000).map(corner).map(|(x, y)| rect(x, y, 3_000, 10).outer).collect();
        let cut = |(x, y): (i32, i32)| {
            let sides = [(y, [0, 1_000, 2_000, 3_000]), (y + 10, [3_000, 2_000, 1_000, 0])];
            sides.into_iter().flat_map(|(y, along)| along.map(|off| GridPos(x + off, y))).collect::<GridRing>()
        };
        let cut: Vec<GridRing> = (0..2_000).map(corner).map(cut).collect();
        assert!(whole.iter().chain(&cut).map(Vec::len).sum::<usize>() > MOST_WITHOUT_COLUMNS);
        for (first, second) in [(&whole, &cut), (&cut, &whole)] {
            let area = |keep| -> i64 {
                let found = combine(keep, first.clone(), second.clone(), false);
                found.iter().flat_map(GridPolygon::rings).map(|ring| ring_area_2(ring)).sum::<i64>() / 2
            };
            let all = 2_000 * 3_000 * 10;
            assert_eq!([Keep::First, Keep::Both, Keep::FirstAlone].map(area), [all, all, 0]);
        }
    }

    proptest! {
        #[test]
        fn pulling_in_changes_nothing_inside(
            ring in proptest::collection::vec((0..200_i32, 0..200_i32).prop_map(|(x, y)| GridPos(x, y)), 3..12),
            p in (81..119_i32, 71..129_i32).prop_map(|(x, y)| GridPos(x, y)),
        ) {
            let bounds = (GridPos(80, 70), GridPos(120, 130));
            // Positions exactly on an edge may count either way.
            prop_assume!(edges(&ring).all(|(a, b)| a.cross(b, p) != 0));
            let pulled = pull_in(&ring, bounds);
            let inside = |ring: &GridRing| GridPolygon::simple(ring.clone()).contains(p);
            prop_assert_eq!(inside(&ring), inside(&pulled), "{:?}", pulled);
        }
    }
}
