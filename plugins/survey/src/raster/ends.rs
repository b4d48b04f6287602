//! Where streets end: at walls, and at the map's border.

use glam::DVec2;

use super::bitmap::Bitmap;
use super::crossing::line_through;
use super::measure::ray;
use super::sketch::length;

/// Runs a street's end on to the wall.
pub(crate) fn run_on(line: &mut Vec<DVec2>, end: usize, half: f64, paved: &Bitmap) {
    if end == 1 {
        line.reverse();
    }
    // The last of it may lead to a corner: how it came is told by what is before.
    let (mut gone, mut points, mut cut) = (0.0, Vec::new(), 0);
    let from = (1.3 * half + 1.0).min(0.4 * length(line));
    for (i, w) in line.windows(2).enumerate() {
        gone += w[0].distance(w[1]);
        if gone > from + (4.0 * half).max(12.0) {
            break;
        }
        if gone >= from {
            if points.is_empty() {
                cut = i + 1;
            }
            points.push(w[1]);
        }
    }
    // Not what is beyond a bend.
    while points.len() > 6 && line_through(&points, from).is_some_and(|arm| arm.farthest(&points) > 1.0) {
        points.truncate(points.len() * 2 / 3);
    }
    if let (Some(arm), Some(&first)) = (line_through(&points, from), points.first()) {
        let back = points[points.len() - 1];
        let ahead = if arm.along.dot(first - back) < 0.0 { -arm.along } else { arm.along };
        let start = arm.through + arm.along * arm.along.dot(first - arm.through);
        let far = from + 6.0 * half + 20.0;
        let reach = ray(paved, start, ahead, far);
        if reach < far {
            line.drain(..cut);
            line.insert(0, start + ahead * reach);
        }
    }
    if end == 1 {
        line.reverse();
    }
}

/// The pieces of a line inside of a box.
pub(crate) fn clipped(line: &[DVec2], low: DVec2, high: DVec2) -> Vec<Vec<DVec2>> {
    let inside = |p: DVec2| p.cmpge(low).all() && p.cmple(high).all();
    if line.iter().all(|&p| inside(p)) {
        return vec![line.to_vec()];
    }
    let mut pieces: Vec<Vec<DVec2>> = Vec::new();
    let mut open = false;
    for w in line.windows(2) {
        let along = w[1] - w[0];
        let (mut t0, mut t1) = (0.0f64, 1.0f64);
        for axis in 0..2 {
            let (d, from) = (along[axis], w[0][axis]);
            if d.abs() < 1e-12 {
                if from < low[axis] || from > high[axis] {
                    t1 = -1.0;
                }
                continue;
            }
            let (a, b) = ((low[axis] - from) / d, (high[axis] - from) / d);
            t0 = t0.max(a.min(b));
            t1 = t1.min(a.max(b));
        }
        if t0 >= t1 {
            open = false;
            continue;
        }
        let at = |t: f64| (w[0] + along * t).clamp(low, high);
        if !open || t0 > 0.0 {
            pieces.push(vec![at(t0)]);
        }
        if let Some(piece) = pieces.last_mut() {
            piece.push(if t1 < 1.0 { at(t1) } else { w[1] });
        }
        open = t1 >= 1.0;
    }
    pieces
}
