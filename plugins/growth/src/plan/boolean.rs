//! Boolean operations on the grid. They run on integers from end to end (`i_overlay`), so that what comes out lies on the
//! grid, does not depend on the platform, and needs no snapping afterwards.

use i_overlay::core::extract::BooleanExtractionBuffer;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::core::solver::Solver;
use i_overlay::i_float::int::point::IntPoint;
use i_overlay::i_shape::int::shape::IntShapes;
use veduta_city::{GridPolygon, GridPos, connected_faces};

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

    fn polygons(&self, shapes: IntShapes) -> Vec<GridPolygon> {
        let ring = |contour: Vec<IntPoint>| -> Vec<GridPos> {
            contour.into_iter().map(|p| GridPos(p.x.saturating_add(self.origin.0), p.y.saturating_add(self.origin.1))).collect()
        };
        // The engine's own way to connected interiors (`ogc`) may go in circles for ever where many rings touch.
        let faces = |shape: Vec<Vec<IntPoint>>| connected_faces(&shape.into_iter().map(ring).collect::<Vec<_>>(), false);
        shapes.into_iter().flat_map(faces).collect()
    }
}

fn first(rings: &[&[GridPos]]) -> Option<GridPos> {
    rings.iter().find_map(|ring| ring.first().copied())
}

fn combine(subject: &[&[GridPos]], clip: &[&[GridPos]], rule: OverlayRule) -> Vec<GridPolygon> {
    let Some(origin) = first(subject).or_else(|| first(clip)) else { return Vec::new() };
    let mut frame = Frame::new(origin);
    frame.add(subject.iter().copied(), ShapeType::Subject);
    frame.add(clip.iter().copied(), ShapeType::Clip);
    let shapes = frame.overlay.overlay(rule, FillRule::NonZero);
    frame.polygons(shapes)
}

/// All rings of polygons, ready to be an operand.
pub(super) fn rings<'a>(polygons: impl IntoIterator<Item = &'a GridPolygon>) -> Vec<&'a [GridPos]> {
    polygons.into_iter().flat_map(GridPolygon::rings).map(Vec::as_slice).collect()
}

/// What all the rings cover together: outer rings counter-clockwise, holes clockwise.
pub(super) fn union(subject: &[&[GridPos]]) -> Vec<GridPolygon> {
    combine(subject, &[], OverlayRule::Subject)
}

/// What `subject` covers and `clip` does not.
pub(super) fn difference(subject: &[&[GridPos]], clip: &[&[GridPos]]) -> Vec<GridPolygon> {
    combine(subject, clip, OverlayRule::Difference)
}

/// What both cover.
pub(super) fn intersection(subject: &[&[GridPos]], clip: &[&[GridPos]]) -> Vec<GridPolygon> {
    combine(subject, clip, OverlayRule::Intersect)
}

/// What `clip` covers of `subject`, and what it leaves of it. Both come from one arrangement of edges and fit exactly.
pub(super) fn split(subject: &[&[GridPos]], clip: &[&[GridPos]]) -> (Vec<GridPolygon>, Vec<GridPolygon>) {
    let Some(origin) = first(subject) else { return (Vec::new(), Vec::new()) };
    let mut frame = Frame::new(origin);
    frame.add(subject.iter().copied(), ShapeType::Subject);
    frame.add(clip.iter().copied(), ShapeType::Clip);
    let mut buffer = BooleanExtractionBuffer::default();
    let both = frame.overlay.build_graph_view(FillRule::NonZero).map(|graph| {
        let inside = graph.extract_shapes(OverlayRule::Intersect, &mut buffer);
        (inside, graph.extract_shapes(OverlayRule::Difference, &mut buffer))
    });
    both.map_or_else(Default::default, |(inside, outside)| (frame.polygons(inside), frame.polygons(outside)))
}

/// Area of the intersection in square metres.
pub(super) fn overlap_m2(a: &GridPolygon, b: &GridPolygon) -> f64 {
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
