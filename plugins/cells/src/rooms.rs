//! Rooms: all open space that one looks into, the cells and the yards that nobody walks to.

use veduta_city::{Cells, GridPolygon, GridPos, bounds, metres};

use crate::buckets::Buckets;
use crate::overlay::edges;

/// Open space.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Room<'a> {
    pub(crate) outline: &'a GridPolygon,
    /// The cell that its ground is drawn with: for a cell itself.
    pub(crate) owner: u32,
}

/// All rooms: the cells by number, then the yards of each.
pub(crate) fn rooms(cells: &Cells) -> Vec<Room<'_>> {
    let halls = cells.cells.iter().zip(0..).map(|(cell, owner)| Room { outline: &cell.outline, owner });
    let yards = cells.cells.iter().zip(0..).flat_map(|(cell, owner)| cell.yards.iter().map(move |outline| Room { outline, owner }));
    halls.chain(yards).collect()
}

/// Edges of a cell's border that are no portals. The cell lies on their left.
pub(crate) fn exits(cells: &Cells, cell: u32) -> Vec<(GridPos, GridPos)> {
    let cell = &cells.cells[cell as usize];
    let sorted = |(a, b): (GridPos, GridPos)| (a.min(b), a.max(b));
    let open: Vec<(GridPos, GridPos)> =
        cell.portals.iter().filter_map(|&p| cells.portals.get(p as usize)).map(|portal| sorted(portal.ends)).collect();
    cell.outline.rings().flat_map(|ring| edges(ring)).filter(|&edge| !open.contains(&sorted(edge))).collect()
}

/// Where one looks from a cell into a yard: the cell on the left of the way from the first end to the second, the yard on the right.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Mouth {
    pub(crate) ends: (GridPos, GridPos),
    pub(crate) cell: u32,
    pub(crate) room: u32,
}

/// The mouths of all yards.
pub(crate) fn mouths(cells: &Cells, rooms: &[Room<'_>]) -> Vec<Mouth> {
    let count = cells.cells.len();
    let of_cell = |cell: u32| exits(cells, cell).into_iter().map(move |edge| (edge, cell));
    let tree = Edges::new((0..count as u32).flat_map(of_cell));
    let mut mouths = Vec::new();
    for (yard, room) in rooms.iter().zip(0..).skip(count) {
        for (a, b) in yard.outline.rings().flat_map(|ring| edges(ring)) {
            mouths.extend(tree.along(a, b).map(|(cell, ends)| Mouth { ends: (ends.1, ends.0), cell, room }));
        }
    }
    mouths.sort_unstable_by_key(|mouth| (mouth.room, mouth.cell, mouth.ends));
    mouths
}

/// How close to each other edges run to be one, metres.
const NEAR_M: f64 = 0.02;
/// Shorter stretches are no more than a corner, metres.
const SHORTEST_M: f64 = 0.01;

/// Reach about an edge in which others are looked for: more than [`NEAR_M`], grid steps.
const NEAR: i32 = 32;

/// Edges in plan with something that they carry.
pub(crate) struct Edges<T> {
    edges: Vec<((GridPos, GridPos), T)>,
    buckets: Buckets,
}

impl<T: Copy> Edges<T> {
    pub(crate) fn new(edges: impl Iterator<Item = ((GridPos, GridPos), T)>) -> Self {
        let edges: Vec<_> = edges.collect();
        let buckets = Buckets::new(edges.iter().map(|&((a, b), _)| Some(bounds::about(a, b))).collect());
        Self { edges, buckets }
    }

    /// What those carry that run along an edge against its way, with the ends of the stretch on which they do, in the order of the edge.
    pub(crate) fn along(&self, a: GridPos, b: GridPos) -> impl Iterator<Item = (T, (GridPos, GridPos))> {
        let ([ax, ay], [bx, by]) = (point(a), point(b));
        let length = libm::sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay));
        let (x, y) = ((bx - ax) / length, (by - ay) / length);
        let near = self.buckets.meeting(bounds::grown(bounds::about(a, b), NEAR)).map(|n| &self.edges[n as usize]);
        near.filter_map(move |&((from, to), data)| {
            let along = |[px, py]: [f64; 2]| ((px - ax) * x + (py - ay) * y, (px - ax) * y - (py - ay) * x);
            let ((s0, d0), (s1, d1)) = (along(point(from)), along(point(to)));
            let is_along = d0.abs() < NEAR_M && d1.abs() < NEAR_M && s0 > SHORTEST_M && s1 < length - SHORTEST_M && s0 > s1;
            is_along.then_some((data, (if s1 > 0.0 { to } else { a }, if s0 < length { from } else { b })))
        })
    }
}

fn point(p: GridPos) -> [f64; 2] {
    [metres(p.0), metres(p.1)]
}
