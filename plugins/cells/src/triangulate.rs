//! Constrained Delaunay triangulation of free space.

use std::collections::HashMap;

use rstar::{PointDistance, RTree, primitives::Line};
use spade::handles::{FixedDirectedEdgeHandle, FixedVertexHandle};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};
use veduta_city::{Finding, GRID_PER_METRE, GridPolygon, GridPos, Id, PLAN_STEP, Severity};

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

/// Triangles of all shapes, which go as soon as their borders are known.
pub(crate) fn triangulate(shapes: Vec<GridPolygon>, settings: &PartitionSettings, findings: &mut Vec<Finding>) -> Vec<Triangle> {
    let rings = shapes.iter().flat_map(GridPolygon::rings);
    let mut borders: Vec<(GridPos, GridPos)> = rings.flat_map(|ring| edges(ring)).filter(|(a, b)| a != b).collect();
    // Those that stay straight first: a cut one that would cross them stays straight as well.
    borders.sort_by_key(|&(a, b)| pieces(a, b, settings.max_diameter_m));
    let mut positions = lattice(&shapes, &borders, settings);
    drop(shapes);
    positions.extend(borders.iter().flat_map(|&(a, b)| cut_up(a, b, settings.max_diameter_m)));
    positions.sort_unstable();
    positions.dedup();
    let Ok(mut cdt) = Cdt::bulk_load(positions.into_iter().map(point).collect()) else { return Vec::new() };
    let borders = add_borders(&mut cdt, borders, settings, findings);
    triangles(&cdt, &inside_faces(&cdt, &borders))
}

/// How many pieces an edge is cut into: more than one where it is longer than most cells may be, so that no triangle is as long as
/// a long wall.
fn pieces(a: GridPos, b: GridPos, max_diameter_m: f64) -> i64 {
    let length_m = libm::sqrt((b.to_metres() - a.to_metres()).length_squared());
    let step_m = (max_diameter_m / 2.0).max(1.0);
    if length_m > 1.5 * step_m { libm::ceil(length_m / step_m).min(10_000.0) as i64 } else { 1 }
}

/// The ends of an edge's pieces. Cuts lie less than a step of the plan (of the grid, if an end is not on the plan) off the line and on its
/// right, the solid side: ground reaches under the wall rather than stopping short.
fn cut_up(a: GridPos, b: GridPos, max_diameter_m: f64) -> impl Iterator<Item = GridPos> + Clone {
    let pieces = pieces(a, b, max_diameter_m);
    let step = GridPos::common_step([&a, &b]);
    let cut = move |i: i64| {
        let floor = |from: i32, to: i32| {
            let at = i64::from(from) + ((i64::from(to) - i64::from(from)) * i).div_euclid(pieces);
            (at.div_euclid(i64::from(step)) * i64::from(step)) as i32
        };
        let (x, y) = (floor(a.0, b.0), floor(a.1, b.1));
        let around = [GridPos(x, y), GridPos(x + step, y), GridPos(x, y + step), GridPos(x + step, y + step)];
        around.into_iter().filter(|&p| a.cross(b, p) <= 0).max_by_key(|&p| (a.cross(b, p), p)).unwrap_or(a)
    };
    core::iter::once(a).chain((1..pieces).map(cut)).chain([b])
}

/// Triangles of the space that some borders enclose on their left, and the piece of it that each lies in, as lines from border to border
/// part it; `None` if a border or a line would cross another border.
pub(crate) fn triangulate_within(
    mut positions: Vec<GridPos>,
    borders: &[(GridPos, GridPos)],
    lines: &[(GridPos, GridPos)],
) -> Option<(Vec<Triangle>, Vec<u32>)> {
    positions.sort_unstable();
    positions.dedup();
    let mut cdt = Cdt::bulk_load(positions.into_iter().map(point).collect()).ok()?;
    let handles: HashMap<GridPos, FixedVertexHandle> = cdt.vertices().map(|v| (grid(v.position()), v.fix())).collect();
    let mut laid = Vec::with_capacity(borders.len() + 2 * lines.len());
    for (n, (a, b)) in borders.iter().chain(lines).enumerate() {
        let (a, b) = (*handles.get(a)?, *handles.get(b)?);
        let parts = if a != b && cdt.can_add_constraint(a, b) { cdt.try_add_constraint(a, b) } else { return None };
        if n >= borders.len() {
            laid.extend(parts.iter().map(|part| part.rev()));
        } else if parts.len() != 1 {
            return None;
        }
        laid.extend(parts);
    }
    let inside = inside_faces(&cdt, &laid);
    let piece = pieces_between(&cdt, &inside);
    let piece = cdt.inner_faces().filter(|face| inside[face.index()]).map(|face| piece[face.index()]).collect();
    Some((triangles(&cdt, &inside), piece))
}

/// Numbers the faces inside, alike where no constraint lies between.
fn pieces_between(cdt: &Cdt, inside: &[bool]) -> Vec<u32> {
    let mut piece = vec![u32::MAX; inside.len()];
    let mut count = 0;
    for start in cdt.inner_faces().filter(|face| inside[face.index()]) {
        if piece[start.index()] != u32::MAX {
            continue;
        }
        let mut stack = vec![start];
        while let Some(face) = stack.pop() {
            if core::mem::replace(&mut piece[face.index()], count) == u32::MAX {
                let onward = face.adjacent_edges().into_iter().filter(|edge| !edge.is_constraint_edge());
                let beyond = onward.filter_map(|edge| edge.rev().face().as_inner());
                stack.extend(beyond.filter(|next| inside[next.index()] && piece[next.index()] == u32::MAX));
            }
        }
        count += 1;
    }
    piece
}

/// Adds borders as constraints; returns their pieces, free space on the left.
fn add_borders(
    cdt: &mut Cdt,
    borders: Vec<(GridPos, GridPos)>,
    settings: &PartitionSettings,
    findings: &mut Vec<Finding>,
) -> Vec<FixedDirectedEdgeHandle> {
    // A sorted list is half as large as a map.
    let mut handles: Vec<(GridPos, FixedVertexHandle)> = cdt.vertices().map(|v| (grid(v.position()), v.fix())).collect();
    handles.sort_unstable_by_key(|&(pos, _)| pos);
    let handle = |pos: GridPos| handles.binary_search_by_key(&pos, |&(pos, _)| pos).ok().map(|at| handles[at].1);
    let mut added = Vec::with_capacity(borders.len());
    let mut ends: Vec<FixedVertexHandle> = Vec::new();
    for (a, b) in borders {
        ends.clear();
        ends.extend(cut_up(a, b, settings.max_diameter_m).filter_map(handle));
        let (Some(&first), Some(&last)) = (ends.first(), ends.last()) else { continue };
        let can_be_cut = ends.windows(2).all(|pair| pair[0] != pair[1] && cdt.can_add_constraint(pair[0], pair[1]));
        let straight = [first, last];
        let ends = if can_be_cut { ends.as_slice() } else { &straight };
        for pair in ends.windows(2) {
            let pieces = cdt.try_add_constraint(pair[0], pair[1]);
            if pieces.is_empty() {
                let message = "two borders of free space cross; one was left out of the cut";
                findings.push(Finding::new(Severity::Repaired, Id::NONE, Some(a.to_metres()), message));
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

/// Points in the open so that no triangle there exceeds the limits: a lattice that is fixed to the plan's zero and keeps clear of
/// borders.
fn lattice(shapes: &[GridPolygon], borders: &[(GridPos, GridPos)], settings: &PartitionSettings) -> Vec<GridPos> {
    let side_m = libm::sqrt(settings.max_area_m2.max(1.0)).min(settings.max_diameter_m.max(1.0) / core::f64::consts::SQRT_2);
    let pitch = i64::from((0.9 * side_m * f64::from(GRID_PER_METRE)) as i32 / PLAN_STEP * PLAN_STEP).max(i64::from(PLAN_STEP));
    let clear = pitch as f64 / 4.0;
    let xy = |p: GridPos| [f64::from(p.0), f64::from(p.1)];
    let walls = RTree::bulk_load(borders.iter().map(|&(a, b)| Line::new(xy(a), xy(b))).collect());
    let is_clear = |p: &GridPos| walls.nearest_neighbor(&xy(*p)).is_none_or(|wall| wall.distance_2(&xy(*p)) > clear * clear);
    let mut points = Vec::new();
    for shape in shapes {
        let Some((lo, hi)) = shape.bounds() else { continue };
        // Very wide shapes get a coarser lattice rather than a million points.
        let widest = (i64::from(hi.0) - i64::from(lo.0)).max(i64::from(hi.1) - i64::from(lo.1));
        points.extend(lattice_within(shape, pitch * (1 + widest / (pitch * 1000))).into_iter().filter(is_clear));
    }
    points
}

/// The points of a lattice within a shape, row by row.
fn lattice_within(shape: &GridPolygon, step: i64) -> Vec<GridPos> {
    let within = |lo: i64, hi: i64| (lo.div_euclid(step) + 1..=hi.div_euclid(step)).map(move |i| i * step);
    // Where the shape's edges cross the lattice's rows.
    let mut crossings: Vec<(i64, i64)> = Vec::new();
    for (a, b) in shape.rings().flat_map(|ring| edges(ring)) {
        let (low, high) = if a.1 <= b.1 { (a, b) } else { (b, a) };
        let [x, y, end_x, end_y] = [low.0, low.1, high.0, high.1].map(i64::from);
        crossings.extend(within(y, end_y).map(|row| (row, x + ((end_x - x) * (row - y)).div_euclid(end_y - y))));
    }
    crossings.sort_unstable();
    let pairs = crossings.chunk_by(|p, q| p.0 == q.0).flat_map(|row| row.chunks_exact(2));
    pairs.flat_map(|pair| within(pair[0].1, pair[1].1).map(|x| GridPos(x as i32, pair[0].0 as i32))).collect()
}

fn triangles(cdt: &Cdt, inside: &[bool]) -> Vec<Triangle> {
    let faces = || cdt.inner_faces().filter(|face| inside[face.index()]);
    let mut index: Vec<Option<u32>> = vec![None; inside.len()];
    let mut count = 0;
    for face in faces() {
        index[face.index()] = Some(count);
        count += 1;
    }
    // Of a known size: a list that grows takes half as much again.
    let mut triangles = Vec::with_capacity(count as usize);
    triangles.extend(faces().map(|face| {
        let edges = face.adjacent_edges();
        Triangle { corners: edges.map(|e| grid(e.from().position())), beyond: edges.map(|e| index[e.rev().face().index()]) }
    }));
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lattice_fills_a_shape_and_spares_its_holes() {
        let ring = |corners: &[(i32, i32)]| corners.iter().map(|&(x, y)| GridPos(x, y)).collect::<Vec<_>>();
        let outer = ring(&[(0, 0), (100, 0), (100, 60), (50, 60), (0, 100)]);
        let shape = GridPolygon { outer, holes: vec![ring(&[(35, 15), (35, 45), (65, 45), (65, 15)])] };
        let mut found = lattice_within(&shape, 20);
        found.sort_unstable();
        let all = (-1..=6).flat_map(|x| (-1..=6).map(move |y| GridPos(20 * x, 20 * y)));
        let (inside, outside): (Vec<_>, Vec<_>) = all.filter(|p| !is_on(&shape, *p)).partition(|&p| shape.contains(p));
        assert!(inside.len() == 7 && inside.iter().all(|p| found.contains(p)), "{found:?}");
        assert!(outside.iter().all(|p| !found.contains(p)), "{found:?}");
    }

    /// Whether a position lies on a shape's edge.
    fn is_on(shape: &GridPolygon, p: GridPos) -> bool {
        let along = |v: i32, a: i32, b: i32| (a.min(b)..=a.max(b)).contains(&v);
        shape.rings().flat_map(|ring| edges(ring)).any(|(a, b)| a.cross(b, p) == 0 && along(p.0, a.0, b.0) && along(p.1, a.1, b.1))
    }

    #[test]
    fn long_edges_are_cut_on_the_grid_and_never_into_the_open() {
        let (a, b) = (GridPos(0, 0), GridPos(200_001, 70_003));
        let ends: Vec<GridPos> = cut_up(a, b, 70.0).collect();
        assert_eq!(ends.len() as i64, pieces(a, b, 70.0) + 1);
        assert!(ends.len() > 4 && ends.first() == Some(&a) && ends.last() == Some(&b));
        assert!(ends.iter().all(|&p| a.cross(b, p) <= 0), "on the line or on its right");
        assert_eq!(cut_up(a, GridPos(30_000, 0), 70.0).count(), 2, "a short one stays whole");
    }
}
