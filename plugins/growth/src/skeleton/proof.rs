//! Whether what was found is a straight skeleton.
//!
//! Arcs lie between two faces by the way they are made, and faces close, or there would be none. So what the faces cover,
//! counted with the way they run round, is what the rings enclose. It is covered once if each face is simple and runs
//! counter-clockwise. The face of an edge is met by every line square to that edge in one stretch; that is what is tried.

use glam::{DVec2, DVec3};

use super::wavefront::Wavefront;

/// How far a node may be from where it would have to be, metres.
const OFF_M: f64 = 1e-5;

/// Whether all faces of a wavefront that has come to its end are simple, run counter-clockwise and lie in their planes.
pub(super) fn holds(wavefront: &Wavefront, jitter: f64) -> bool {
    let off = OFF_M + jitter;
    wavefront.skeleton.faces().enumerate().all(|(edge, face)| {
        let edge = edge as u32;
        let along = wavefront.lines.along(edge);
        let origin = wavefront.node_at(face[0]).truncate();
        // Along the edge, and away from it.
        let flat = |node: u32| {
            let node: DVec3 = wavefront.node_at(node);
            (DVec2::new((node.truncate() - origin).dot(along), node.z), wavefront.lines.inside(edge, node.truncate()))
        };
        face.iter().all(|&node| {
            let (place, inside) = flat(node);
            (place.y - inside).abs() < off
        }) && is_simple(face.len(), |i| flat(face[i % face.len()]).0, off)
    })
}

/// Whether a polygon is met by every upright line in one stretch, its lower side running to the right and its upper one back.
fn is_simple(len: usize, at: impl Fn(usize) -> DVec2, off: f64) -> bool {
    // From its leftmost corner to its rightmost, and back.
    let by_x = |a: &usize, b: &usize| at(*a).x.total_cmp(&at(*b).x);
    let (Some(left), Some(right)) = ((0..len).min_by(by_x), (0..len).max_by(by_x)) else { return false };
    let there = (right + len - left) % len;
    let runs = |from: usize, steps: usize, way: f64| (0..steps).all(|i| (at(from + i + 1).x - at(from + i).x) * way > -off);
    if !runs(left, there, 1.0) || !runs(right, len - there, -1.0) {
        return false;
    }
    // Every corner of one side is on its own side of the other.
    let height = |from: usize, steps: usize, x: f64, way: f64| {
        let i = (0..steps).find(|&i| (at(from + i + 1).x - x) * way >= 0.0).unwrap_or(steps - 1);
        let (a, b) = (at(from + i), at(from + i + 1));
        let width = b.x - a.x;
        // On an upright stretch, what is least in the way.
        if width.abs() < off {
            if way > 0.0 { a.y.min(b.y) } else { a.y.max(b.y) }
        } else {
            a.y + (b.y - a.y) * ((x - a.x) / width).clamp(0.0, 1.0)
        }
    };
    let slack = 100.0 * off;
    (1..there).all(|i| {
        let low = at(left + i);
        low.y <= height(right, len - there, low.x, -1.0) + slack
    }) && (1..len - there).all(|i| {
        let high = at(right + i);
        high.y >= height(left, there, high.x, 1.0) - slack
    })
}
