//! Boolean operations on the grid. They run on integers from end to end (`i_overlay`), so that what comes out lies on the
//! grid, does not depend on the platform, and needs no snapping afterwards.

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay, ShapeType};
use i_overlay::core::solver::Solver;
use i_overlay::i_float::int::point::IntPoint;
use i_overlay::vector::edge::{CLIP_LEFT, CLIP_RIGHT, SUBJ_LEFT, SUBJ_RIGHT, VectorEdge};
use veduta_city::{BorderEdge, GridPolygon, GridPos, connected_faces};

use super::relation::is_apart;

/// An overlay that is being filled. Coordinates inside are relative to `origin`, so that products stay far from the ends of
/// 64 bits.
struct Frame {
    overlay: Overlay,
    origin: GridPos,
}

/// Farthest that a vertex may lie from the first one, grid steps (about 500 km).
const FARTHEST: i32 = 1 << 29;

impl Frame {
    fn new(origin: GridPos) -> Self {
        Self { overlay: Overlay::new_custom(64, IntOverlayOptions::keep_all_points(), Solver::AUTO), origin }
    }

    fn local(&self, p: GridPos) -> IntPoint {
        let axis = |v: i32, o: i32| v.saturating_sub(o).clamp(-FARTHEST, FARTHEST);
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
        let plan = |p: IntPoint| GridPos(p.x.saturating_add(self.origin.0), p.y.saturating_add(self.origin.1));
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
    let mut frame = Frame::new(first(subject).or_else(|| first(clip))?);
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

/// Area of the intersection in square metres.
pub(super) fn overlap_m2(a: &GridPolygon, b: &GridPolygon) -> f64 {
    if is_apart(&a.outer, &b.outer) || is_apart(&b.outer, &a.outer) {
        return 0.0;
    }
    intersection(&rings([a]), &rings([b])).iter().map(GridPolygon::area_m2).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle(x: i32, y: i32, w: i32, h: i32) -> Vec<GridPos> {
        [(x, y), (x + w, y), (x + w, y + h), (x, y + h)].map(|(x, y)| GridPos(x * 1024, y * 1024)).to_vec()
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
    fn far_from_the_anchor_it_works_as_near_it() {
        let far = |ring: Vec<GridPos>| ring.into_iter().map(|p| p + GridPos(2_000_000_000, -2_000_000_000)).collect::<Vec<_>>();
        let (a, b) = (far(rectangle(0, 0, 10, 10)), far(rectangle(5, 5, 10, 10)));
        assert_eq!(intersection(&[&a], &[&b])[0].area_m2(), 25.0);
        assert_eq!(union(&[&a, &b])[0].area_m2(), 175.0);
    }
}
