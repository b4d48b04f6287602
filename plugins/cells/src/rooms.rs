//! Rooms: all open space that one looks into, the cells and the yards that nobody walks to.

use veduta_city::{Cells, GRID_PER_METRE, GridPolygon, GridPos, metres};

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

/// Squares by which edges are found, grid steps: a wall lies in one or two of them.
const SQUARE: i32 = 32 * GRID_PER_METRE;
/// Reach about an edge in which others are looked for: more than [`NEAR_M`], grid steps.
const NEAR: i32 = 32;

/// Edges in plan with something that they carry.
pub(crate) struct Edges<T> {
    edges: Vec<((GridPos, GridPos), T)>,
    /// Each square with the edges whose boxes touch it, ascending.
    squares: Vec<((i32, i32), u32)>,
    /// Edges whose boxes touch so many squares that they are looked at every time.
    large: Vec<u32>,
}

impl<T: Copy> Edges<T> {
    pub(crate) fn new(edges: impl Iterator<Item = ((GridPos, GridPos), T)>) -> Self {
        let edges: Vec<_> = edges.collect();
        let (mut squares, mut large) = (Vec::new(), Vec::new());
        for (n, &((a, b), _)) in (0..).zip(&edges) {
            match squares_of(a, b, 0) {
                Some(touched) => squares.extend(touched.map(|square| (square, n))),
                None => large.push(n),
            }
        }
        squares.sort_unstable();
        Self { edges, squares, large }
    }

    /// What those carry that run along an edge against its way, with the ends of the stretch on which they do, in the order of the edge.
    pub(crate) fn along(&self, a: GridPos, b: GridPos) -> impl Iterator<Item = (T, (GridPos, GridPos))> {
        let ([ax, ay], [bx, by]) = (point(a), point(b));
        let length = libm::hypot(bx - ax, by - ay);
        let (x, y) = ((bx - ax) / length, (by - ay) / length);
        let of_square = move |square: (i32, i32)| {
            let first = self.squares.partition_point(|(other, _)| *other < square);
            let here = self.squares[first..].iter().take_while(move |(other, _)| *other == square);
            here.map(|&(_, n)| &self.edges[n as usize]).filter(move |((from, to), _)| {
                // Of the squares that both boxes touch, the first counts.
                let corner = |axis: fn(&GridPos) -> i32| {
                    axis(from).min(axis(to)).max(axis(&a).min(axis(&b)).saturating_sub(NEAR)).div_euclid(SQUARE)
                };
                (corner(|p| p.0), corner(|p| p.1)) == square
            })
        };
        let touched = squares_of(a, b, NEAR);
        // A box that touches many squares meets so many edges that all may be looked at.
        let all = if touched.is_none() { &self.edges[..] } else { &[] };
        let large = if touched.is_none() { &[][..] } else { &self.large[..] };
        let near = touched.into_iter().flatten().flat_map(of_square);
        let near = near.chain(all).chain(large.iter().map(|&n| &self.edges[n as usize]));
        near.filter_map(move |&((from, to), data)| {
            let along = |[px, py]: [f64; 2]| ((px - ax) * x + (py - ay) * y, (px - ax) * y - (py - ay) * x);
            let ((s0, d0), (s1, d1)) = (along(point(from)), along(point(to)));
            let is_along = d0.abs() < NEAR_M && d1.abs() < NEAR_M && s0 > SHORTEST_M && s1 < length - SHORTEST_M && s0 > s1;
            is_along.then_some((data, (if s1 > 0.0 { to } else { a }, if s0 < length { from } else { b })))
        })
    }
}

/// More squares than this are not gone through one by one.
const MOST_SQUARES: i64 = 256;

/// The squares that the box about an edge touches, and so far around it; `None` if there are too many.
fn squares_of(a: GridPos, b: GridPos, reach: i32) -> Option<impl Iterator<Item = (i32, i32)>> {
    let along = |a: i32, b: i32| {
        let square = |steps: i32| steps.div_euclid(SQUARE);
        (square(a.min(b).saturating_sub(reach)), square(a.max(b).saturating_add(reach)))
    };
    let ((west, east), (south, north)) = (along(a.0, b.0), along(a.1, b.1));
    let count = i64::from(east - west + 1) * i64::from(north - south + 1);
    (count <= MOST_SQUARES).then(|| (west..=east).flat_map(move |x| (south..=north).map(move |y| (x, y))))
}

fn point(p: GridPos) -> [f64; 2] {
    [metres(p.0), metres(p.1)]
}
