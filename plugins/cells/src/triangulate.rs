//! Constrained Delaunay triangulation of free space.

use std::collections::HashMap;

use rstar::{PointDistance, RTree, primitives::Line};
use spade::handles::{FixedDirectedEdgeHandle, FixedVertexHandle};
use spade::{ConstrainedDelaunayTriangulation, Point2, PositionInTriangulation, Triangulation};
use veduta_city::{Finding, GRID_PER_METRE, GridPolygon, GridPos, Id, Severity};

use crate::overlay::edges;
use crate::partition::PartitionSettings;

/// A triangle: its corners counter-clockwise, and the triangle beyond each edge (edge i runs from corner i to corner i + 1).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Triangle {
    pub(crate) corners: [GridPos; 3],
    pub(crate) beyond: [Option<u32>; 3],
}

impl Triangle {
    /// The ends of an edge.
    pub(crate) fn edge(&self, i: usize) -> (GridPos, GridPos) {
        (self.corners[i], self.corners[(i + 1) % 3])
    }

    /// Its centroid, to the grid step below.
    pub(crate) fn middle(&self) -> GridPos {
        let mean = |of: fn(&GridPos) -> i32| self.corners.iter().map(|p| i64::from(of(p))).sum::<i64>().div_euclid(3) as i32;
        GridPos(mean(|p| p.0), mean(|p| p.1))
    }

    /// Twice its area, grid steps squared.
    pub(crate) fn area_2(&self) -> i64 {
        self.corners[0].cross(self.corners[1], self.corners[2])
    }
}

type Cdt = ConstrainedDelaunayTriangulation<Point2<f64>>;

fn point(p: GridPos) -> Point2<f64> {
    Point2::new(f64::from(p.0), f64::from(p.1))
}

/// Triangles of all shapes.
pub(crate) fn triangulate(shapes: &[GridPolygon], settings: &PartitionSettings, findings: &mut Vec<Finding>) -> Vec<Triangle> {
    let mut borders: Vec<Vec<GridPos>> = shapes
        .iter()
        .flat_map(GridPolygon::rings)
        .flat_map(|ring| edges(ring))
        .filter(|(a, b)| a != b)
        .map(|(a, b)| cut_up(a, b, settings.max_diameter_m))
        .collect();
    // Those that stay straight first: a cut one that would cross them stays straight as well.
    borders.sort_by_key(Vec::len);
    let mut positions: Vec<GridPos> = borders.iter().flatten().copied().collect();
    positions.sort_unstable();
    positions.dedup();
    let Ok(mut cdt) = Cdt::bulk_load(positions.into_iter().map(point).collect()) else { return Vec::new() };
    let borders = add_borders(&mut cdt, &borders, findings);
    add_lattice(&mut cdt, shapes, &borders, settings);
    triangles(&cdt, &inside_faces(&cdt, &borders))
}

/// An edge, cut where it is longer than most cells may be, so that no triangle is as long as a long wall. Cuts lie on the grid,
/// less than a step off the line and on its right, the solid side: ground reaches under the wall rather than stopping short.
fn cut_up(a: GridPos, b: GridPos, max_diameter_m: f64) -> Vec<GridPos> {
    let length_m = libm::sqrt((b.to_metres() - a.to_metres()).length_squared());
    let step_m = (max_diameter_m / 2.0).max(1.0);
    let pieces = if length_m > 1.5 * step_m { libm::ceil(length_m / step_m).min(10_000.0) as i64 } else { 1 };
    let cut = |i: i64| {
        let floor = |from: i32, to: i32| from + ((i64::from(to) - i64::from(from)) * i).div_euclid(pieces) as i32;
        let (x, y) = (floor(a.0, b.0), floor(a.1, b.1));
        let around = [GridPos(x, y), GridPos(x + 1, y), GridPos(x, y + 1), GridPos(x + 1, y + 1)];
        around.into_iter().filter(|&p| a.cross(b, p) <= 0).max_by_key(|&p| (a.cross(b, p), p)).unwrap_or(a)
    };
    core::iter::once(a).chain((1..pieces).map(cut)).chain([b]).collect()
}

/// Adds borders as constraints; returns their pieces, free space on the left.
fn add_borders(cdt: &mut Cdt, borders: &[Vec<GridPos>], findings: &mut Vec<Finding>) -> Vec<FixedDirectedEdgeHandle> {
    let handle: HashMap<GridPos, FixedVertexHandle> = cdt.vertices().map(|v| (grid(v.position()), v.fix())).collect();
    let mut added = Vec::new();
    for border in borders {
        let ends: Vec<FixedVertexHandle> = border.iter().filter_map(|p| handle.get(p).copied()).collect();
        let (Some(&first), Some(&last)) = (ends.first(), ends.last()) else { continue };
        let can_be_cut = ends.windows(2).all(|pair| pair[0] != pair[1] && cdt.can_add_constraint(pair[0], pair[1]));
        let straight = [first, last];
        let ends = if can_be_cut { ends.as_slice() } else { &straight };
        for pair in ends.windows(2) {
            let pieces = cdt.try_add_constraint(pair[0], pair[1]);
            if pieces.is_empty() {
                let message = "two borders of free space cross; one was left out of the cut";
                findings.push(Finding::new(Severity::Repaired, Id::NONE, border.first().map(|p| p.to_metres()), message));
            }
            added.extend(pieces);
        }
    }
    added
}

fn grid(p: Point2<f64>) -> GridPos {
    GridPos(p.x as i32, p.y as i32)
}

/// For each face whether it is free space: flooded from the left of the borders.
fn inside_faces(cdt: &Cdt, borders: &[FixedDirectedEdgeHandle]) -> Vec<bool> {
    let mut inside = vec![false; cdt.num_all_faces()];
    let mut stack: Vec<_> = borders.iter().filter_map(|&e| cdt.directed_edge(e).face().as_inner().map(|f| f.fix())).collect();
    while let Some(face) = stack.pop() {
        if core::mem::replace(&mut inside[face.index()], true) {
            continue;
        }
        for edge in cdt.face(face).adjacent_edges() {
            if !edge.is_constraint_edge()
                && let Some(next) = edge.rev().face().as_inner()
            {
                stack.push(next.fix());
            }
        }
    }
    inside
}

/// Adds points in the open so that no triangle there exceeds the limits: a lattice that is fixed to the plan's zero.
fn add_lattice(cdt: &mut Cdt, shapes: &[GridPolygon], borders: &[FixedDirectedEdgeHandle], settings: &PartitionSettings) {
    let side_m = libm::sqrt(settings.max_area_m2.max(1.0)).min(settings.max_diameter_m.max(1.0) / core::f64::consts::SQRT_2);
    let pitch = (0.9 * side_m * f64::from(GRID_PER_METRE)) as i32;
    let clear = f64::from(pitch) / 4.0;
    let inside = inside_faces(cdt, borders);
    let walls = borders.iter().map(|&e| {
        let [a, b] = cdt.directed_edge(e).positions();
        Line::new([a.x, a.y], [b.x, b.y])
    });
    let walls = RTree::bulk_load(walls.collect());
    let mut points = Vec::new();
    for (lo, hi) in shapes.iter().filter_map(GridPolygon::bounds) {
        // Very wide shapes get a coarser lattice rather than a million points.
        let widest = (i64::from(hi.0) - i64::from(lo.0)).max(i64::from(hi.1) - i64::from(lo.1));
        let step = i64::from(pitch) * (1 + widest / (i64::from(pitch) * 1000));
        let range = |lo: i32, hi: i32| (i64::from(lo).div_euclid(step) + 1..=i64::from(hi).div_euclid(step)).map(move |i| i * step);
        for y in range(lo.1, hi.1) {
            for x in range(lo.0, hi.0) {
                let p = [x as f64, y as f64];
                let is_free = matches!(cdt.locate(Point2::new(p[0], p[1])),
                    PositionInTriangulation::OnFace(face) if inside[face.index()])
                    || matches!(cdt.locate(Point2::new(p[0], p[1])),
                    PositionInTriangulation::OnEdge(edge)
                        if cdt.directed_edge(edge).face().as_inner().is_some_and(|f| inside[f.index()]));
                if is_free && walls.nearest_neighbor(&p).is_none_or(|wall| wall.distance_2(&p) > clear * clear) {
                    points.push(p);
                }
            }
        }
    }
    points.sort_by(|a, b| a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0])));
    points.dedup();
    for [x, y] in points {
        // Only fails for numbers that are none; those of the grid are fine.
        let _ = cdt.insert(Point2::new(x, y));
    }
}

fn triangles(cdt: &Cdt, inside: &[bool]) -> Vec<Triangle> {
    let mut index: Vec<Option<u32>> = vec![None; inside.len()];
    let faces: Vec<_> = cdt.inner_faces().filter(|face| inside[face.index()]).collect();
    for (i, face) in (0..).zip(&faces) {
        index[face.index()] = Some(i);
    }
    let triangle = |face: &spade::handles::FaceHandle<'_, spade::handles::InnerTag, _, _, _, _>| {
        let edges = face.adjacent_edges();
        Triangle { corners: edges.map(|e| grid(e.from().position())), beyond: edges.map(|e| index[e.rev().face().index()]) }
    };
    faces.iter().map(triangle).collect()
}
