//! How wide a street is from place to place, where it varies by more than a drawing's noise.
//!
//! ```text
//!  a street's line ─► stations across it ─► running median ─► straight stretches ─► (share, width) …
//!                     (less those that look             (as wide at a crossroads as
//!                      into another street)              the nearest of them)
//! ```
//!
//! Few streets of a map vary, so the spread of the widths that were measured before tells which are looked at again, on the
//! line as it came out at last: its ends are tied and clipped then, and shares of its length hold.

use glam::DVec2;
use veduta_city::WidthAt;

use super::bitmap::Bitmap;
use super::measure::{is_clear, median, ray};
use super::sketch::length;

/// Widths that differ by less than this do not differ: metres …
const EVEN_M: f64 = 0.5;
/// … pixels …
const EVEN_PX: f64 = 1.0;
/// … and shares of the width.
const EVEN_SHARE: f64 = 0.06;
/// A street varies if its widths are so many times that apart …
const VARIES: f64 = 2.0;
/// … and may do if the range of those first measured is this share of it.
const RANGE_SHARE: f64 = 0.75;
/// Pixels between places where a width is measured.
const STEP_PX: f64 = 3.0;
/// Pixels ahead and back that tell a line's direction.
const CHORD_PX: f64 = 6.0;
/// The least number of stations of which a median is taken.
const WINDOW: usize = 5;

/// How far apart widths of a street may lie and be one width, pixels. `mpp`: metres a pixel.
fn even_px(width_px: f64, mpp: f64) -> f64 {
    (EVEN_M / mpp).max(EVEN_PX).max(EVEN_SHARE * width_px)
}

/// The least and the greatest of half widths measured one after the other, single ones aside: of the medians of five. Nothing
/// of fewer.
pub(crate) fn range(halves: &[f64]) -> Option<[f64; 2]> {
    let medians = halves.as_chunks::<WINDOW>().0.iter().filter_map(|five| median(&mut five.clone()));
    medians.map(|m| [m, m]).reduce(|[low, high], [m, _]| [low.min(m), high.max(m)])
}

/// A width, and how far along the line it was measured; pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Station {
    at: f64,
    width: f64,
}

/// The widths of a street along its line, where they vary; nothing where they do not. Line in pixels, widths in metres;
/// `half` and `range`: half the width that it mostly has, the least and the greatest, pixels; `mouths`: the radius
/// of the largest disc of street about its first and its last point, if other streets or a square meet it there; `mpp`: metres a
/// pixel. Where a label hides a wall, nothing is known of the width.
///
/// Close to a crossroads the way across leads into the other street, so the width there is that of the nearest station beyond
/// its mouth. The half disc of the papers, grown at the crossroads away from it until it meets a wall on either side, was
/// tried on drawn streets that widen or narrow into crossings of 90°, 60° and 45°. Taken as it is (the sum of its two reaches)
/// it was off by 0.6 to 3.8 m within the mouth in the mean; by what of them lies square to the street alone, by 0.4 to 2.9 m;
/// the nearest station by 0.3 to 1.1 m. A half disc reaches the corners of the blocks, not the walls, and at a slant one of
/// them is far off. To carry the first stretch's slope on was no better (0.4 to 0.9 m; worse where a street hardly varies).
pub(crate) fn profile(
    line: &[DVec2],
    (half, range): (f64, [f64; 2]),
    mouths: [Option<f64>; 2],
    [paved, hidden]: [&Bitmap; 2],
    mpp: f64,
) -> Vec<WidthAt> {
    let even = even_px(2.0 * half, mpp);
    if 2.0 * (range[1] - range[0]) < RANGE_SHARE * VARIES * even {
        return Vec::new();
    }
    let length = length(line);
    let mut stations = stations(line, length, half, [paved, hidden]);
    for (node, radius) in [0.0, length].into_iter().zip(mouths) {
        if let Some(radius) = radius {
            stations.drain(..mouth(&stations, node, radius, even));
        }
        // The other end's turn; the second time, back again.
        stations.reverse();
    }
    if stations.len() < WINDOW {
        return Vec::new();
    }
    smooth(&mut stations);
    let mut kept = straightened(&stations, even);
    fit(&mut kept, &stations);
    let (low, high) = kept.iter().fold((f64::MAX, f64::MIN), |(low, high), s| (low.min(s.width), high.max(s.width)));
    if high - low < VARIES * even {
        return Vec::new();
    }
    kept.into_iter().map(|s| WidthAt { share: s.at / length, width_m: s.width * mpp }).collect()
}

/// Widths square to a line, but where the way across leads into another street, or to a wall that a label hides.
fn stations(line: &[DVec2], length: f64, half: f64, [paved, hidden]: [&Bitmap; 2]) -> Vec<Station> {
    let count = (length / STEP_PX) as usize;
    let reach = 4.0 * half + 20.0;
    let across = |k: usize| {
        let at = (k as f64 + 0.5) * length / count as f64;
        let (p, ahead) = (point_at(line, at), direction_at(line, at, length)?);
        let sides = [ahead.perp(), -ahead.perp()].map(|side| ray(paved, p, side, reach));
        let width = sides[0] + sides[1];
        let middle = p + ahead.perp() * ((sides[0] - sides[1]) / 2.0);
        let is_told = [(ahead.perp(), sides[0]), (-ahead.perp(), sides[1])]
            .iter()
            .all(|(side, reach)| !hidden.get_at(p + side * (reach + 0.5)));
        let is_across = is_told && sides[0] > 0.0 && sides[1] > 0.0 && sides[0].max(sides[1]) < reach;
        (is_across && (width < 2.0 || is_clear(paved, middle, (width / 2.0 - 1.0) / 1.25))).then_some(Station { at, width })
    };
    (0..count).filter_map(across).collect()
}

/// The point so far along a line.
fn point_at(line: &[DVec2], at: f64) -> DVec2 {
    let mut left = at;
    for w in line.windows(2) {
        let piece = w[0].distance(w[1]);
        if left <= piece && piece > 0.0 {
            return w[0].lerp(w[1], (left / piece).max(0.0));
        }
        left -= piece;
    }
    line.last().copied().unwrap_or_default()
}

fn direction_at(line: &[DVec2], at: f64, length: f64) -> Option<DVec2> {
    (point_at(line, (at + CHORD_PX).min(length)) - point_at(line, (at - CHORD_PX).max(0.0))).try_normalize()
}

/// Puts the median of each and its neighbours in its place: of nine, towards the ends of as few as five.
fn smooth(stations: &mut [Station]) {
    const REACH: usize = WINDOW - 1;
    let raw: Vec<f64> = stations.iter().map(|s| s.width).collect();
    for (i, station) in stations.iter_mut().enumerate() {
        // As many on either side as far as can be, so that the ends of a street that widens are not drawn inwards.
        let reach = i.min(raw.len() - 1 - i).clamp(WINDOW / 2, REACH);
        let from = i.saturating_sub(reach).min(raw.len().saturating_sub(2 * reach + 1));
        let mut around = [0.0; 2 * REACH + 1];
        let around = &mut around[..2 * reach + 1];
        if let Some(raw) = raw.get(from..from + around.len()) {
            around.copy_from_slice(raw);
            station.width = median(around).unwrap_or(station.width);
        }
    }
}

/// How many stations at the beginning look into the mouth of another street or a square: up to the last one near the `node`
/// that is wider than those ahead of it.
fn mouth(stations: &[Station], node: f64, radius: f64, even: f64) -> usize {
    let reach = 1.5 * radius + 9.0;
    let near = stations.iter().take_while(|s| (s.at - node).abs() < reach).count();
    let is_mouth = |six: &[Station; WINDOW + 1]| {
        let [here, ahead @ ..] = six;
        median(&mut ahead.map(|s| s.width)).is_some_and(|m| here.width > m + even)
    };
    stations.array_windows().take(near).rposition(is_mouth).map_or(0, |i| i + 1)
}

/// The fewest of the stations (by Douglas and Peucker) between which straight lines pass all others within `even`.
fn straightened(stations: &[Station], even: f64) -> Vec<Station> {
    let mut keep = vec![false; stations.len()];
    let last = stations.len() - 1;
    (keep[0], keep[last]) = (true, true);
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let (a, b) = (stations[from], stations[to]);
        let off = |s: &Station| (s.width - a.width - (b.width - a.width) * (s.at - a.at) / (b.at - a.at)).abs();
        let farthest = (from + 1..to).max_by(|&i, &j| off(&stations[i]).total_cmp(&off(&stations[j])));
        if let Some(i) = farthest.filter(|&i| off(&stations[i]) > even) {
            keep[i] = true;
            open.extend([(from, i), (i, to)]);
        }
    }
    stations.iter().zip(keep).filter(|(_, keep)| *keep).map(|(s, _)| *s).collect()
}

/// Moves the widths of the stations that were kept so that the straight lines between them pass all as near as can be (least
/// squares): those that were kept are the ones that lie farthest off.
fn fit(kept: &mut [Station], all: &[Station]) {
    // The normal equations: each of the kept meets its neighbours alone.
    let mut diagonal = vec![0.0; kept.len()];
    let (mut beside, mut right) = (diagonal.clone(), diagonal.clone());
    let mut i = 0;
    for station in all {
        while i + 2 < kept.len() && kept[i + 1].at <= station.at {
            i += 1;
        }
        let t = (station.at - kept[i].at) / (kept[i + 1].at - kept[i].at);
        diagonal[i] += (1.0 - t) * (1.0 - t);
        diagonal[i + 1] += t * t;
        beside[i] += t * (1.0 - t);
        right[i] += (1.0 - t) * station.width;
        right[i + 1] += t * station.width;
    }
    for i in 1..kept.len() {
        let share = beside[i - 1] / diagonal[i - 1];
        diagonal[i] -= share * beside[i - 1];
        right[i] -= share * right[i - 1];
    }
    let mut after = 0.0;
    for (i, station) in kept.iter_mut().enumerate().rev() {
        station.width = (right[i] - beside[i] * after) / diagonal[i];
        after = station.width;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A street from (300, 300) on, 200 pixels long, whose width goes from the first to the last given, and another across
    /// its beginning; walls waver by up to `noise` pixels. Its line with it.
    fn drawn(angle_deg: f64, cross: f64, widths: [f64; 2], turn: f64, noise: f64) -> (Bitmap, Vec<DVec2>) {
        let unit = |angle: f64| DVec2::new(libm::cos(angle), libm::sin(angle));
        let (from, along, across) = (DVec2::splat(300.0), unit(turn), unit(turn + angle_deg.to_radians()));
        let waver = |x: usize, y: usize| {
            let n = (x as u64 / 2).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ (y as u64 / 2).wrapping_mul(0xC2B2_AE3D_27D4_EB4F);
            (((n ^ n >> 29).wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 40) as f64 / (1u64 << 23) as f64 - 1.0) * noise
        };
        let bitmap = Bitmap::from_fn(600, 600, |x, y| {
            let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) - from;
            let gone = p.dot(along);
            let width = widths[0] + (widths[1] - widths[0]) * (gone / 200.0).clamp(0.0, 1.0);
            let within = |aside: f64, width: f64| aside.abs() + waver(x, y) < width / 2.0;
            gone > 0.0 && within(p.perp_dot(along), width) || within(p.perp_dot(across), cross)
        });
        (bitmap, vec![from, from + along * 200.0])
    }

    /// The width that a profile has at a share, in metres.
    fn width_m(profile: &[WidthAt], share: f64) -> f64 {
        WidthAt::between(profile, share).expect("the street varies")
    }

    #[test]
    fn a_street_that_widens_is_known_at_every_place() {
        for turn in 0..12 {
            for (cross, angle) in [(14.0, 90.0), (24.0, 90.0), (20.0, 60.0)] {
                let (bitmap, line) = drawn(angle, cross, [16.0, 32.0], f64::from(turn) * 0.5, 0.0);
                let found = profile(
                    &line,
                    (12.0, [8.0, 16.0]),
                    [Some(12.0), None],
                    [&bitmap, &Bitmap::new(bitmap.width(), bitmap.height())],
                    0.5,
                );
                for k in 0..=100 {
                    let share = f64::from(k) / 100.0;
                    let truth = 8.0 + 8.0 * share;
                    let is_mouth = share * 200.0 < cross;
                    let off = (width_m(&found, share) - truth).abs();
                    assert!(off < if is_mouth { 1.6 } else { 0.5 }, "turn {turn}, {angle}°: {off:.2} m off at {share}: {found:?}");
                }
            }
        }
    }

    #[test]
    fn a_street_of_one_width_has_no_profile_however_rough_it_is_drawn() {
        for turn in 0..12 {
            let (bitmap, line) = drawn(70.0, 20.0, [20.0, 20.0], f64::from(turn) * 0.5, 1.2);
            // Looked at though nothing says that it varies.
            let found = profile(
                &line,
                (10.0, [5.0, 15.0]),
                [Some(12.0), None],
                [&bitmap, &Bitmap::new(bitmap.width(), bitmap.height())],
                0.5,
            );
            assert_eq!(found, [], "turn {turn}");
        }
    }

    #[test]
    fn a_place_within_a_street_is_in_its_profile() {
        let bitmap = Bitmap::from_fn(400, 100, |x, y| y.abs_diff(50) < if (150..220).contains(&x) { 16 } else { 8 });
        let line = [DVec2::new(10.0, 50.0), DVec2::new(390.0, 50.0)];
        let found = profile(&line, (7.5, [7.5, 15.5]), [None; 2], [&bitmap, &Bitmap::new(bitmap.width(), bitmap.height())], 0.5);
        for (x, width) in [(20.0, 7.5), (135.0, 7.5), (165.0, 15.5), (205.0, 15.5), (235.0, 7.5), (380.0, 7.5)] {
            let found = width_m(&found, (x - 10.0) / 380.0);
            assert!((found - width).abs() < 0.5, "{found} m for {width} m at {x}");
        }
    }

    #[test]
    fn a_label_over_a_wall_makes_no_street_narrower() {
        // Letters that were taken for a block stand into the street.
        let is_label = |x: usize, y: usize| (150..220).contains(&x) && (50..70).contains(&y);
        let bitmap = Bitmap::from_fn(400, 100, |x, y| y.abs_diff(50) < 12 && !(is_label(x, y) && y > 54));
        let line = [DVec2::new(10.0, 50.0), DVec2::new(390.0, 50.0)];
        let found = |hidden: &Bitmap| profile(&line, (11.5, [8.0, 11.5]), [None; 2], [&bitmap, hidden], 0.5);
        assert!(!found(&Bitmap::new(400, 100)).is_empty());
        assert_eq!(found(&Bitmap::from_fn(400, 100, is_label)), []);
    }

    #[test]
    fn a_range_is_of_medians() {
        assert_eq!(range(&[4.0, 4.0, 30.0, 4.0, 5.0, 7.0, 7.0, 1.0, 8.0, 7.0, 99.0]), Some([4.0, 7.0]));
        assert_eq!(range(&[4.0; 4]), None);
    }
}
