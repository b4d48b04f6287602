//! Streets that a label interrupts, led through in the graph.

use glam::DVec2;

use super::bitmap::{Bitmap, pixel_of};
use super::morphology::band;
use super::sketch::{Sketch, SketchStreet};

/// Longest stretch that is led through, metres.
const REACH_M: f64 = 70.0;
/// Cosine of the most that either end may turn away.
const FACING: f64 = 0.8;
/// The same for ends closer together than so many pixels.
const NEARLY_FACING: f64 = 0.3;
const NEAR_PX: f64 = 26.0;
/// Share of what lies between that must be hidden.
const HIDDEN: f64 = 0.5;
/// Between nearby ends, the same of the way from so many pixels before them.
const NEARBY_HIDDEN: f64 = 0.25;
const BACK_PX: f64 = 12.0;
/// Pixels before its end that tell where a street was going.
const COURSE_PX: usize = 14;

/// A street's blind end.
#[derive(Debug, Clone, Copy)]
struct Tip {
    node: usize,
    street: usize,
    at: DVec2,
    ahead: DVec2,
}

/// Joins blind ends that face each other across what is hidden, in the graph and in what is `paved`.
pub(crate) fn lead_through(sketch: &mut Sketch, paved: &mut Bitmap, hidden: &Bitmap, mpp: f64) {
    let tips = tips(sketch);
    let reach = REACH_M / mpp;
    let mut pairs = Vec::new();
    for (i, a) in tips.iter().enumerate() {
        // They are in order from the left.
        for (j, b) in tips.iter().enumerate().skip(i + 1).take_while(|(_, b)| b.at.x - a.at.x <= reach) {
            let gap = b.at - a.at;
            let length = gap.length();
            if length > reach || a.street == b.street || length < 1.0 {
                continue;
            }
            // Nearby ends need not face each other so well: their last pixels may lead aside.
            let facing = if length < NEAR_PX { NEARLY_FACING } else { FACING };
            let is_facing = length < 8.0 || (a.ahead.dot(gap) > facing * length && b.ahead.dot(-gap) > facing * length);
            // What shows between two words may be too little to be known for street.
            let by_words = || {
                let (from, to) = (a.at - a.ahead * BACK_PX, b.at - b.ahead * BACK_PX);
                length < NEAR_PX && share_hidden(hidden, from, to, |_, _| true) > NEARBY_HIDDEN
            };
            if is_facing && (share_hidden(hidden, a.at, b.at, |x, y| !paved.get(x, y)) > HIDDEN || by_words()) {
                pairs.push((length, i, j));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut joined = vec![false; tips.len()];
    for (length, i, j) in pairs {
        if joined[i] || joined[j] {
            continue;
        }
        (joined[i], joined[j]) = (true, true);
        let (a, b) = (tips[i], tips[j]);
        let n = (length as usize).max(2);
        let line = (0..=n).map(|k| a.at.lerp(b.at, k as f64 / n as f64)).collect();
        let half = sketch.streets[a.street].half.min(sketch.streets[b.street].half);
        band(paved, a.at, b.at, half.max(1.0));
        sketch.streets.push(SketchStreet { ends: [a.node, b.node], line, half, range: [half; 2] });
    }
}

/// The blind ends, from the left to the right.
fn tips(sketch: &Sketch) -> Vec<Tip> {
    let at = sketch.ends();
    let mut tips = Vec::new();
    for (node, ends) in at.iter().enumerate() {
        let &[(street, end)] = &ends[..] else { continue };
        let line = &sketch.streets[street];
        let mut points = line.seen_from(end);
        let Some(tip) = points.next() else { continue };
        let back = points.nth(COURSE_PX.min(line.line.len().saturating_sub(2)).saturating_sub(1)).unwrap_or(tip);
        if let Some(ahead) = (tip - back).try_normalize() {
            tips.push(Tip { node, street, at: tip, ahead });
        }
    }
    tips.sort_by(|a, b| a.at.x.total_cmp(&b.at.x).then(a.node.cmp(&b.node)));
    tips
}

/// Of the pixels on the way between two points that `count`, the share that is hidden; all, where none counts.
fn share_hidden(hidden: &Bitmap, a: DVec2, b: DVec2, counts: impl Fn(isize, isize) -> bool) -> f64 {
    let n = (a.distance(b) as usize).max(2);
    let (mut all, mut covered) = (0.0, 0.0);
    for k in 0..=n {
        let p = a.lerp(b, k as f64 / n as f64);
        let (x, y) = pixel_of(p);
        if counts(x, y) {
            all += 1.0;
            covered += f64::from(u8::from(hidden.get(x, y)));
        }
    }
    if all > 0.0 { covered / all } else { 1.0 }
}
