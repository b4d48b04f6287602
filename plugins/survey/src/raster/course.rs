//! Rivers and railways: broad strokes, read at a quarter of the resolution.

use glam::DVec2;

use super::bitmap::Bitmap;
use super::ends::clipped;
use super::measure::{median, ray};
use super::morphology::{Sweep, swept};
use super::outline::{Corners, outlines, simplified};
use super::sketch::{Sketch, length};
use super::thinning::thinned;
use super::trace::traced;

/// Pixels of a side that become one.
const SCALE: usize = 4;
/// Pixels, of those, that the picture is continued by on every side.
const MARGIN: usize = 64;
/// Bridges up to twice so wide do not end a course, metres.
const BRIDGE_M: f64 = 15.0;
/// Shorter pieces are none, metres.
const LEAST_M: f64 = 80.0;
/// Pieces that fill more of the square of their extent are ponds …
const COMPACT: f64 = 0.25;
/// … and so are those that fill this much of it and lie wholly in the picture: a course comes from somewhere.
const COMPACT_INSIDE: f64 = 0.1;

/// A river or railway as found.
#[derive(Debug, Clone)]
pub(crate) struct FoundCourse {
    /// Its line in pixels, y down.
    pub line: Vec<DVec2>,
    /// Half its width, pixels.
    pub half: f64,
}

/// Finds courses, and clears of `mask` what is none of them (ponds).
pub(crate) fn courses(mask: &mut Bitmap, mpp: f64, tolerance_px: f64) -> Vec<FoundCourse> {
    let small = mask.quartered();
    let bridge = (BRIDGE_M / (mpp * SCALE as f64)) as usize + 1;
    let wide = small.with_margin(MARGIN);
    let mut closed = swept(&wide, &[Sweep::Grow(bridge), Sweep::Shrink(bridge)]);
    closed.add(&wide);
    let least = LEAST_M / (mpp * SCALE as f64);
    let found = outlines(&closed, Corners::Join);
    for outline in found.iter().filter(|o| !o.is_hole()) {
        let (low, high) = outline.extent();
        let extent = (high - low).as_dvec2().length();
        let is_inside = low.min_element() > 0 && high.x < closed.width() as i32 && high.y < closed.height() as i32;
        let compact = if is_inside { COMPACT_INSIDE } else { COMPACT };
        if extent < least || outline.area_px as f64 > compact * extent * extent {
            outline.paint(&mut closed, false);
            outline.scaled(SCALE as i32, -((MARGIN * SCALE) as i32)).paint(mask, false);
        }
    }
    let mut sketch = Sketch::of(traced(&thinned(&closed, 1)), &closed);
    for _ in 0..2 {
        sketch.prune();
        sketch.join_chains();
    }
    let size = DVec2::new(mask.width() as f64, mask.height() as f64);
    let mut found = Vec::new();
    for street in &sketch.streets {
        let line: Vec<DVec2> = smooth(&street.line).iter().map(|p| (*p - MARGIN as f64) * SCALE as f64).collect();
        let half = half_width(&line, mask);
        for piece in clipped(&line, DVec2::ZERO, size) {
            if length(&piece) * mpp > LEAST_M / 2.0 {
                found.push(FoundCourse { line: simplified(&piece, tolerance_px), half });
            }
        }
    }
    found
}

/// A line without the steps of its pixels.
fn smooth(line: &[DVec2]) -> Vec<DVec2> {
    const REACH: usize = 5;
    let n = line.len();
    let mean = |i: usize| {
        let reach = REACH.min(i).min(n - 1 - i);
        line[i - reach..=i + reach].iter().copied().sum::<DVec2>() / (2 * reach + 1) as f64
    };
    (0..n).map(mean).collect()
}

fn half_width(line: &[DVec2], mask: &Bitmap) -> f64 {
    let at = |i: usize| {
        let normal = (line[(i + 3).min(line.len() - 1)] - line[i.saturating_sub(3)]).try_normalize()?.perp();
        let sides = [normal, -normal].map(|n| ray(mask, line[i], n, 600.0));
        (sides[0] + sides[1] > 0.0 && sides[0].max(sides[1]) < 600.0).then_some((sides[0] + sides[1]) / 2.0)
    };
    let mut halves: Vec<f64> = (0..line.len()).filter_map(at).filter(|h| *h > 0.5).collect();
    median(&mut halves).unwrap_or(0.0)
}
