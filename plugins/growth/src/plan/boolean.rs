//! Boolean operations on the grid. They run on integers from end to end (`i_overlay`), so that what comes out lies on the
//! grid, does not depend on the platform, and needs no snapping afterwards.

use glam::DVec2;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay, ShapeType};
use i_overlay::core::solver::Solver;
use i_overlay::i_float::int::point::IntPoint;
use i_overlay::vector::edge::{CLIP_LEFT, CLIP_RIGHT, SUBJ_LEFT, SUBJ_RIGHT, VectorEdge};
use veduta_city::{BorderEdge, GridPolygon, GridPos, connected_faces, ring_edges};

use super::relation::{is_apart, is_convex};
use veduta_city::bounds::{Bounds, do_meet};

/// An overlay that is being filled. Coordinates inside are relative to `origin`, so that products stay far from the ends of
/// 64 bits, and in steps of as many of the grid as all of them are multiples of: what is on the plan stays on it.
struct Frame {
    overlay: Overlay,
    origin: GridPos,
    step: i32,
}

/// Farthest that a vertex may lie from the first one, grid steps (about 500 km).
const FARTHEST: i32 = 1 << 29;

/// Edges up to which the engine's own choice of solver is sound. It sorts more by columns, and misses that edges lie on each other where they
/// begin in different columns (4.5.2; mended in 9.0).
const MOST_WITHOUT_COLUMNS: usize = 16_000;

impl Frame {
    /// For so many edges.
    fn new(origin: GridPos, step: i32, edges: usize) -> Self {
        let solver = if edges > MOST_WITHOUT_COLUMNS { Solver::LIST } else { Solver::AUTO };
        Self { overlay: Overlay::new_custom(64, IntOverlayOptions::keep_all_points(), solver), origin, step }
    }

    fn local(&self, p: GridPos) -> IntPoint {
        let axis = |v: i32, o: i32| v.saturating_sub(o).clamp(-FARTHEST, FARTHEST) / self.step;
        IntPoint::new(axis(p.0, self.origin.0), axis(p.1, self.origin.1))
    }

    fn add<'a>(&mut self, rings: impl IntoIterator<Item = &'a [GridPos]>, role: ShapeType) {
        for ring in rings {
            let path: Vec<IntPoint> = ring.iter().map(|&p| self.local(p)).collect();
            self.overlay.add_contour(&path, role);
        }
    }

    /// All edges of the arrangement. Only these are used of the engine: its ways of tracing shapes may go in circles for ever
    /// where many rings touch.
    fn edges(&mut self) -> Vec<VectorEdge> {
        self.overlay.build_separate_vectors(FillRule::NonZero)
    }

    /// The faces of an arrangement that are kept, by whether subject and clip cover them.
    fn faces(&self, edges: &[VectorEdge], keep: impl Fn(bool, bool) -> bool) -> Vec<GridPolygon> {
        let plan = |p: IntPoint| {
            let axis = |v: i32, o: i32| v.saturating_mul(self.step).saturating_add(o);
            GridPos(axis(p.x, self.origin.0), axis(p.y, self.origin.1))
        };
        let border = |edge: &VectorEdge| -> Option<BorderEdge> {
            let has = |bit: u8| edge.fill & bit != 0;
            let left = keep(has(SUBJ_LEFT), has(CLIP_LEFT));
            let right = keep(has(SUBJ_RIGHT), has(CLIP_RIGHT));
            let (a, b) = (plan(edge.a), plan(edge.b));
            (left != right).then_some(if left { (a, b) } else { (b, a) })
        };
        connected_faces(edges.iter().filter_map(border).collect(), false)
    }
}

fn first(rings: &[&[GridPos]]) -> Option<GridPos> {
    rings.iter().find_map(|ring| ring.first().copied())
}

/// An arrangement of two sets of rings; `None` if both are empty.
fn arrange(subject: &[&[GridPos]], clip: &[&[GridPos]]) -> Option<(Frame, Vec<VectorEdge>)> {
    let step = GridPos::common_step(subject.iter().chain(clip).copied().flatten());
    let edges = subject.iter().chain(clip).map(|ring| ring.len()).sum();
    let mut frame = Frame::new(first(subject).or_else(|| first(clip))?, step, edges);
    frame.add(subject.iter().copied(), ShapeType::Subject);
    frame.add(clip.iter().copied(), ShapeType::Clip);
    let edges = frame.edges();
    Some((frame, edges))
}

fn combine(subject: &[&[GridPos]], clip: &[&[GridPos]], keep: impl Fn(bool, bool) -> bool) -> Vec<GridPolygon> {
    arrange(subject, clip).map_or_else(Vec::new, |(frame, edges)| frame.faces(&edges, keep))
}

/// All rings of polygons, ready to be an operand.
pub(crate) fn rings<'a>(polygons: impl IntoIterator<Item = &'a GridPolygon>) -> Vec<&'a [GridPos]> {
    polygons.into_iter().flat_map(GridPolygon::rings).map(Vec::as_slice).collect()
}

/// What all the rings cover together: outer rings counter-clockwise, holes clockwise.
pub(super) fn union(subject: &[&[GridPos]]) -> Vec<GridPolygon> {
    combine(subject, &[], |subject, _| subject)
}

/// What `subject` covers and `clip` does not.
pub(super) fn difference(subject: &[&[GridPos]], clip: &[&[GridPos]]) -> Vec<GridPolygon> {
    combine(subject, clip, |subject, clip| subject && !clip)
}

/// What both cover.
pub(super) fn intersection(subject: &[&[GridPos]], clip: &[&[GridPos]]) -> Vec<GridPolygon> {
    combine(subject, clip, |subject, clip| subject && clip)
}

/// What `clip` covers of `subject`, and what it leaves of it. Both come from one arrangement of edges and fit exactly.
pub(crate) fn split(subject: &[&[GridPos]], clip: &[&[GridPos]]) -> (Vec<GridPolygon>, Vec<GridPolygon>) {
    arrange(subject, clip).map_or_else(Default::default, |(frame, edges)| {
        (frame.faces(&edges, |subject, clip| subject && clip), frame.faces(&edges, |subject, clip| subject && !clip))
    })
}

/// Area of the intersection of two valid polygons in square metres.
pub(super) fn overlap_m2(a: &GridPolygon, b: &GridPolygon) -> f64 {
    let (Some(&origin), Some(a_box), Some(b_box)) = (a.outer.first(), a.bounds(), b.bounds()) else { return 0.0 };
    if !do_meet(a_box, b_box) || is_apart(&a.outer, &b.outer) || is_apart(&b.outer, &a.outer) {
        return 0.0;
    }
    let local = |ring: &Vec<GridPos>, other: Bounds| -> Vec<DVec2> {
        about_box(ring, other).into_iter().map(|p| (p - origin).to_metres()).collect()
    };
    let [a_rings, b_rings] =
        [(a, b_box), (b, a_box)].map(|(polygon, other)| polygon.rings().map(|ring| local(ring, other)).collect::<Vec<_>>());
    let held = |convex: &[DVec2], of: &[Vec<DVec2>]| of.iter().map(|ring| clipped_m2(ring, convex)).sum::<f64>();
    if a.holes.is_empty() && is_convex(&a.outer) {
        return held(&a_rings[0], &b_rings).max(0.0);
    }
    if b.holes.is_empty() && is_convex(&b.outer) {
        return held(&b_rings[0], &a_rings).max(0.0);
    }
    // A ring is the sum of the triangles that its edges have with any place, those that turn right taken off.
    let triangles = a_rings.iter().flat_map(|ring| ring_edges(ring));
    let of_triangle = |(p, q): (DVec2, DVec2)| {
        if p.perp_dot(q) >= 0.0 { held(&[DVec2::ZERO, p, q], &b_rings) } else { -held(&[DVec2::ZERO, q, p], &b_rings) }
    };
    triangles.map(of_triangle).sum::<f64>().max(0.0)
}

/// A ring without the corners that do not matter within a box: those beyond the same side of it as the corners before and after
/// them. It winds about every place in the box as often as before, and a convex one stays convex.
fn about_box(ring: &[GridPos], (low, high): Bounds) -> Vec<GridPos> {
    let beyond =
        |p: GridPos| u8::from(p.0 < low.0) | u8::from(p.0 > high.0) << 1 | u8::from(p.1 < low.1) << 2 | u8::from(p.1 > high.1) << 3;
    let mut kept: Vec<GridPos> = Vec::with_capacity(ring.len());
    for (i, &p) in ring.iter().enumerate() {
        let before = kept.last().or(ring.last()).map_or(0, |&p| beyond(p));
        let after = ring.get(i + 1).or(kept.first()).map_or(0, |&p| beyond(p));
        if before & beyond(p) & after == 0 {
            kept.push(p);
        }
    }
    kept
}

/// Area of what a convex ring that runs counter-clockwise holds of another, negative if that one runs clockwise. (Sutherland and
/// Hodgman, *Reentrant polygon clipping*, 1974: where it leaves edges that run to and fro, they have no area.)
fn clipped_m2(ring: &[DVec2], convex: &[DVec2]) -> f64 {
    if convex.len() < 3 {
        return 0.0;
    }
    let mut rest = ring.to_vec();
    let mut next = Vec::with_capacity(rest.len() + convex.len());
    for (a, b) in ring_edges(convex) {
        let way = b - a;
        let Some(&last) = rest.last() else { break };
        let (mut before, mut side) = (last, way.perp_dot(last - a));
        next.clear();
        for &p in &rest {
            let own = way.perp_dot(p - a);
            if (own < 0.0) != (side < 0.0) {
                next.push(before + (p - before) * (side / (side - own)));
            }
            if own >= 0.0 {
                next.push(p);
            }
            (before, side) = (p, own);
        }
        core::mem::swap(&mut rest, &mut next);
    }
    let Some(&base) = rest.first() else { return 0.0 };
    rest.windows(2).map(|pair| (pair[0] - base).perp_dot(pair[1] - base)).sum::<f64>() / 2.0
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn rectangle(x: i32, y: i32, w: i32, h: i32) -> Vec<GridPos> {
        [(x, y), (x + w, y), (x + w, y + h), (x, y + h)].map(|(x, y)| GridPos(x * 1024, y * 1024)).to_vec()
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, cases: 1024, ..ProptestConfig::default() })]

        #[test]
        fn an_overlap_is_measured_as_an_intersection(
            (x, y, w, h, lean) in (-9..9_i32, -9..9_i32, 1..9_i32, 1..9_i32, -3..4_i32),
            others in proptest::collection::vec(proptest::collection::vec((-12..12_i32, -12..12_i32), 3..9), 2),
        ) {
            let quad = [(x, y), (x + w, y), (x + w + lean, y + h), (x + lean, y + h)];
            let quad = vec![GridPolygon::simple(quad.map(|(x, y)| GridPos(x * 1024, y * 1024 + x)).to_vec())];
            // Rings as they come make polygons with holes.
            let whole = |ring: Vec<(i32, i32)>| {
                let ring: Vec<GridPos> = ring.into_iter().map(|(x, y)| GridPos(x * 1024 - y, y * 1024)).collect();
                union(&[&ring])
            };
            let mut all: Vec<Vec<GridPolygon>> = others.into_iter().map(whole).collect();
            all.push(quad);
            for (a, b) in [(0, 1), (0, 2), (1, 2), (2, 0)].into_iter().flat_map(|(i, j)| {
                let (of, with) = (&all[i], &all[j]);
                of.iter().flat_map(move |a| with.iter().map(move |b| (a, b)))
            }) {
                let want: f64 = intersection(&rings([a]), &rings([b])).iter().map(GridPolygon::area_m2).sum();
                let found = overlap_m2(a, b);
                // Corners of the intersection are rounded to the grid.
                prop_assert!((found - want).abs() < 0.05, "{found} for {want}");
            }
        }
    }

    #[test]
    fn a_split_neither_loses_nor_doubles_ground() {
        let (whole, part) = (rectangle(0, 0, 10, 10), vec![GridPos(-5000, 3000), GridPos(7777, 1), GridPos(9001, 20_000)]);
        let (inside, outside) = split(&[&whole], &[&part]);
        let area = |of: &[GridPolygon]| of.iter().map(GridPolygon::area_m2).sum::<f64>();
        assert!((area(&inside) + area(&outside) - 100.0).abs() < 1e-9);
        assert!(inside.iter().all(|i| outside.iter().all(|o| overlap_m2(i, o) == 0.0)));
    }

    #[test]
    fn a_hole_that_touches_its_outer_ring_is_wound_as_a_hole() {
        let whole = rectangle(0, 0, 10, 10);
        let touching = vec![GridPos(0, 5120), GridPos(5120, 2000), GridPos(5120, 8000)];
        for (inside, outside) in
            [split(&[&whole], &[&touching]), split(&[&whole], &[&touching.iter().rev().copied().collect::<Vec<_>>()])]
        {
            let area = |of: &[GridPolygon]| of.iter().map(GridPolygon::area_m2).sum::<f64>();
            assert!((area(&inside) + area(&outside) - 100.0).abs() < 1e-9);
            let (again, _) = split(&rings(&outside), &[&touching]);
            assert_eq!(area(&again), 0.0, "what was taken is gone");
        }
    }

    #[test]
    fn edges_on_each_other_are_found_among_many() {
        // Bars, and the same with vertices in the middle of their sides, at which nothing else ends.
        let corner = |n: i32| (n % 10 * 400, n / 10 * 2);
        let whole: Vec<Vec<GridPos>> = (0..2_000).map(corner).map(|(x, y)| rectangle(x, y, 300, 1)).collect();
        let cut = |(x, y): (i32, i32)| {
            let sides = [(y, [0, 100, 200, 300]), (y + 1, [300, 200, 100, 0])];
            sides.into_iter().flat_map(|(y, along)| along.map(|off| GridPos((x + off) * 1024, y * 1024))).collect::<Vec<_>>()
        };
        let cut: Vec<Vec<GridPos>> = (0..2_000).map(corner).map(cut).collect();
        assert!(whole.iter().chain(&cut).map(Vec::len).sum::<usize>() > MOST_WITHOUT_COLUMNS);
        let [whole, cut] = [&whole, &cut].map(|rings| rings.iter().map(Vec::as_slice).collect::<Vec<_>>());
        for (subject, clip) in [(&whole, &cut), (&cut, &whole)] {
            let m2 = |of: Vec<GridPolygon>| of.iter().map(GridPolygon::area_m2).sum::<f64>();
            assert_eq!((m2(intersection(subject, clip)), m2(difference(subject, clip))), (2_000.0 * 300.0, 0.0));
        }
    }

    #[test]
    fn far_from_the_anchor_it_works_as_near_it() {
        let far = |ring: Vec<GridPos>| ring.into_iter().map(|p| p + GridPos(2_000_000_000, -2_000_000_000)).collect::<Vec<_>>();
        let (a, b) = (far(rectangle(0, 0, 10, 10)), far(rectangle(5, 5, 10, 10)));
        assert_eq!(intersection(&[&a], &[&b])[0].area_m2(), 25.0);
        assert_eq!(union(&[&a, &b])[0].area_m2(), 175.0);
    }
}
