//! Outlines of cells and the portals between them, traced along the borders of labelled triangles.

use std::collections::HashMap;

use veduta_city::{GridPolygon, GridPos, GridRing, PLAN_STEP, Portal, PortalSide};

use crate::overlay::{edges, ring_area_2};
use crate::triangulate::Triangle;

/// What a piece of border is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Border {
    Wall,
    Edge,
    Cell(u32),
}

/// A vertex of a ring and what runs from it to the next.
type Corner = (GridPos, Border);

/// Outlines of all cells and their portals. Cells keep their numbers.
pub(crate) fn outlines(triangles: &[Triangle], label: &[u32], extent: &GridPolygon) -> (Vec<GridPolygon>, Vec<Portal>) {
    let count = label.iter().max().map_or(0, |&last| last as usize + 1);
    let mut rings: Vec<Vec<Vec<Corner>>> = vec![Vec::new(); count];
    let mut is_traced = vec![[false; 3]; triangles.len()];
    for t in 0..triangles.len() {
        for i in 0..3 {
            if !is_traced[t][i] && is_border(triangles, label, t, i) {
                let ring = trace(triangles, label, extent, (t, i), &mut is_traced);
                rings[label[t] as usize].extend(split(ring).into_iter().map(|ring| straighten(&ring)));
            }
        }
    }
    let portals = portals(&rings);
    (rings.into_iter().map(polygon).collect(), portals)
}

fn is_border(triangles: &[Triangle], label: &[u32], t: usize, i: usize) -> bool {
    triangles[t].beyond[i].is_none_or(|n| label[n as usize] != label[t])
}

/// Follows a border with its cell on the left, turning at each vertex through the fan of the cell's triangles.
fn trace(
    triangles: &[Triangle],
    label: &[u32],
    extent: &GridPolygon,
    start: (usize, usize),
    is_traced: &mut [[bool; 3]],
) -> Vec<Corner> {
    let mut ring = Vec::new();
    let (mut t, mut i) = start;
    while !is_traced[t][i] {
        is_traced[t][i] = true;
        let (a, b) = triangles[t].edge(i);
        let border = match triangles[t].beyond[i] {
            Some(n) => Border::Cell(label[n as usize]),
            None if lies_on(extent, a, b) => Border::Edge,
            None => Border::Wall,
        };
        ring.push((a, border));
        i = (i + 1) % 3;
        while !is_border(triangles, label, t, i) {
            let Some(next) = triangles[t].beyond[i] else { break };
            let back = triangles[next as usize].beyond.iter().position(|&n| n == Some(t as u32));
            let Some(back) = back else { break };
            t = next as usize;
            i = (back + 1) % 3;
        }
    }
    ring
}

/// Crossings are snapped: so far off lines they may lie, grid steps.
const NEAR: i32 = 2 * PLAN_STEP;

/// Whether a piece of border runs along the extent: both ends near one edge of it.
fn lies_on(extent: &GridPolygon, a: GridPos, b: GridPos) -> bool {
    extent.rings().any(|ring| edges(ring).any(|(p, q)| [a, b].iter().all(|&v| is_near_segment(v, p, q))))
}

fn is_near_segment(v: GridPos, p: GridPos, q: GridPos) -> bool {
    let within = |v: i32, a: i32, b: i32| v >= a.min(b) - NEAR && v <= a.max(b) + NEAR;
    if !within(v.0, p.0, q.0) || !within(v.1, p.1, q.1) {
        return false;
    }
    let length_2 = i128::from(crate::hull::distance_2(p, q));
    let off = i128::from(p.cross(q, v));
    off * off <= i128::from(NEAR * NEAR) * length_2
}

/// Cuts a ring that passes through a vertex twice into rings that do not.
fn split(ring: Vec<Corner>) -> Vec<Vec<Corner>> {
    let mut done = Vec::new();
    let mut open: Vec<Corner> = Vec::new();
    let mut at: HashMap<GridPos, usize> = HashMap::new();
    for corner in ring {
        if let Some(&first) = at.get(&corner.0) {
            let loose: Vec<Corner> = open.drain(first..).collect();
            for (p, _) in &loose {
                at.remove(p);
            }
            done.push(loose);
        }
        at.insert(corner.0, open.len());
        open.push(corner);
    }
    done.push(open);
    done.retain(|ring| ring.len() > 2);
    done
}

/// Drops vertices in the middle of straight borders of one kind.
fn straighten(ring: &[Corner]) -> Vec<Corner> {
    let n = ring.len();
    (0..n)
        .filter(|&i| {
            let (before, here, after) = (ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]);
            before.1 != here.1 || before.0.cross(here.0, after.0) != 0
        })
        .map(|i| ring[i])
        .collect()
}

/// Each straight border to a cell of higher number, and each straight piece of the extent, by cell and place.
fn portals(rings: &[Vec<Vec<Corner>>]) -> Vec<Portal> {
    let mut portals = Vec::new();
    for (cell, rings) in (0..).zip(rings) {
        for ring in rings {
            for (i, &(a, border)) in ring.iter().enumerate() {
                let ends = (a, ring[(i + 1) % ring.len()].0);
                match border {
                    Border::Cell(other) if cell < other => portals.push(Portal { ends, cell, beyond: PortalSide::Cell(other) }),
                    Border::Edge => portals.push(Portal { ends, cell, beyond: PortalSide::Edge }),
                    _ => {}
                }
            }
        }
    }
    let side = |p: &Portal| p.other(p.cell).unwrap_or(u32::MAX);
    portals.sort_by_key(|p| (p.cell, side(p), p.ends));
    portals
}

/// The one ring that runs counter-clockwise is the outer one, the others are holes.
fn polygon(rings: Vec<Vec<Corner>>) -> GridPolygon {
    let mut rings: Vec<GridRing> = rings.into_iter().map(|ring| from_lowest(ring.into_iter().map(|c| c.0).collect())).collect();
    rings.sort_by_key(|ring| (core::cmp::Reverse(ring_area_2(ring)), ring.first().copied()));
    let mut rings = rings.into_iter();
    let outer = rings.next().unwrap_or_default();
    let mut holes: Vec<GridRing> = rings.collect();
    holes.sort();
    GridPolygon { outer, holes }
}

/// Turns a ring so that it begins with its least vertex.
fn from_lowest(mut ring: GridRing) -> GridRing {
    let lowest = (0..ring.len()).min_by_key(|&i| ring[i]).unwrap_or(0);
    ring.rotate_left(lowest);
    ring
}
