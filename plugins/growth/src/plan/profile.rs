//! How a way comes down to what it has to keep under: where its ramps begin, where it is covered, and how high it lies in between.

use core::ops::Range;

/// Ramps begin so far from what lies across, metres.
const MARGIN_M: f64 = 1.5;
/// What lies across where a map says that a tunnel begins reaches no farther into it than this; metres.
const ENTRY_M: f64 = 16.0;
/// So far before a tunnel a street is level across for sure, metres.
const LEVEL_M: f64 = 6.0;
/// A mouth farther in is worth it if the ramp is shorter by more than this; metres.
const WORTH_M: f64 = 2.0;
/// Shorter bores are none, metres.
const LEAST_M: f64 = 2.0;
/// Ramps begin so far above the ground, metres.
const LIFT_M: f64 = 0.02;

/// A place along a way.
#[derive(Clone, Copy)]
pub(super) struct Sample {
    pub s: f64,
    /// The ground in its middle, and the lowest ground or water bed across it, metres above the city's zero.
    pub ground_m: f64,
    pub low_m: f64,
    /// How much the way may climb to here from where it begins.
    pub climb_m: f64,
    /// Whether something stands or leads across.
    pub is_blocked: bool,
}

/// Where a ramp begins and ends, as numbers of samples.
#[derive(Clone, Copy)]
pub(super) struct Ramp {
    pub top: usize,
    pub mouth: usize,
}

/// Where the ramps of a tunnel begin and end. `mapped`: what a map says lies below the ground.
pub(super) fn ramps(samples: &[Sample], mapped: &Range<f64>, is_wall: [bool; 2], depth_m: f64) -> Result<[Ramp; 2], &'static str> {
    let first = samples.partition_point(|sample| sample.s < mapped.start - 1e-6);
    let last = samples.partition_point(|sample| sample.s <= mapped.end + 1e-6) - 1;
    let blocked = |range: core::ops::RangeInclusive<usize>| range.filter(|&i| samples[i].is_blocked).collect::<Vec<_>>();
    // What lies across the ends themselves is the street that the tunnel comes out to.
    let entry = |end: usize, i: usize| (samples[end].s - samples[i].s).abs() < ENTRY_M;
    let is_clear = |i: &usize| !samples[*i].is_blocked;
    let from = if is_wall[0] { Some(first) } else { (first..=last).find(is_clear) }
        .filter(|&i| entry(first, i))
        .ok_or("something stands where it begins")?;
    let to = if is_wall[1] { Some(last) } else { (first..=last).rev().find(is_clear) }
        .filter(|&i| entry(last, i))
        .ok_or("something stands where it ends")?;
    if from >= to {
        return Err("it is too short");
    }
    let above = blocked(from..=to);
    let middle = (from + to) / 2;
    let least = above.first().map_or(middle, |i| i.saturating_sub(1).max(from));
    let most = above.last().map_or(middle + 1, |i| (i + 1).min(to));
    let count = samples.len();
    let end = samples[count - 1];
    let turn = |sample: &Sample| Sample { s: end.s - sample.s, climb_m: end.climb_m - sample.climb_m, ..*sample };
    let turned: Vec<Sample> = samples.iter().rev().map(turn).collect();
    let back = |i: usize| count - 1 - i;
    let none = |i: usize| Ramp { top: i, mouth: i };
    let far = if is_wall[1] { last } else { most };
    let near = if is_wall[0] { first } else { least };
    let start =
        if is_wall[0] { none(first) } else { ramp(samples, from, least, far, depth_m).ok_or("its first ramp has no room")? };
    let stop = if is_wall[1] {
        none(last)
    } else {
        let Ramp { top, mouth } = ramp(&turned, back(to), back(most), back(near), depth_m).ok_or("its last ramp has no room")?;
        Ramp { top: back(top), mouth: back(mouth) }
    };
    if samples[stop.mouth].s - samples[start.mouth].s < LEAST_M {
        return Err("it is too short");
    }
    Ok([start, stop])
}

/// The ramp at the start of a tunnel whose mouth lies between two samples and which is covered from there to a third.
fn ramp(samples: &[Sample], from: usize, to: usize, covered: usize, depth_m: f64) -> Option<Ramp> {
    let mut lowest = from;
    while lowest > 0 && !samples[lowest - 1].is_blocked {
        lowest -= 1;
    }
    let edge = samples[lowest].s + if lowest > 0 { MARGIN_M } else { 0.0 };
    let lowest = samples.partition_point(|sample| sample.s < edge);
    // Streets are level across as far as the map says that they lie on the ground, and not much farther.
    let is_level = |i: &usize| lowest >= from || *i == lowest || samples[*i].s <= samples[from].s - LEVEL_M;
    // As high as the way may be at its start so that it is low enough from each place on to where it is covered for sure.
    let bound = |i: usize| samples[i].low_m - depth_m + samples[i].climb_m;
    let mut bounds: Vec<f64> = (from..=covered)
        .rev()
        .scan(f64::INFINITY, |least, i| {
            *least = least.min(bound(i));
            Some(*least)
        })
        .collect();
    bounds.reverse();
    let mut best: Option<Ramp> = None;
    let length = |ramp: &Ramp| samples[ramp.mouth].s - samples[ramp.top].s;
    for mouth in from..=to.min(covered) {
        let bound = bounds[mouth - from];
        let top = (lowest..=mouth).rev().filter(is_level).find(|&i| samples[i].ground_m + LIFT_M + samples[i].climb_m <= bound);
        let found = top.map(|top| Ramp { top, mouth });
        if let Some(ramp) = found.filter(|ramp| best.is_none_or(|best| length(ramp) < length(&best) - WORTH_M)) {
            best = Some(ramp);
        }
    }
    best
}

/// Heights along a way, metres above the city's zero: straight between two or more places along it.
pub(super) struct Floor(pub Vec<(f64, f64)>);

impl Floor {
    /// Where it begins and where it ends.
    pub fn ends(&self) -> [(f64, f64); 2] {
        [self.0[0], self.0[self.0.len() - 1]]
    }

    pub fn at(&self, s: f64) -> f64 {
        let i = self.0.partition_point(|(at, _)| *at <= s).clamp(1, self.0.len() - 1);
        let ((from, low), (to, high)) = (self.0[i - 1], self.0[i]);
        low + (high - low) * ((s - from) / (to - from).max(1e-9)).clamp(0.0, 1.0)
    }
}

/// The highest way that lies below everything and never turns down again: the lower hull of what it may not rise above.
pub(super) fn floor(samples: &[Sample], ramps: [Ramp; 2], is_wall: [bool; 2], depth_m: f64) -> Result<Floor, &'static str> {
    let [start, stop] = ramps;
    let most = |i: usize| {
        let Sample { s, ground_m, low_m, climb_m, .. } = samples[i];
        let is_end = (i == start.top && !is_wall[0]) || (i == stop.top && !is_wall[1]);
        let is_bore = (start.mouth..=stop.mouth).contains(&i);
        let height = if is_end {
            ground_m + LIFT_M
        } else if is_bore {
            low_m - depth_m
        } else {
            ground_m
        };
        (s, height, climb_m)
    };
    let mut hull: Vec<(f64, f64, f64)> = Vec::new();
    for next in (start.top..=stop.top).map(most) {
        let is_above = |[a, b]: [(f64, f64, f64); 2]| (b.1 - a.1) * (next.0 - a.0) >= (next.1 - a.1) * (b.0 - a.0);
        while hull.len() > 1 && is_above([hull[hull.len() - 2], hull[hull.len() - 1]]) {
            hull.pop();
        }
        hull.push(next);
    }
    let is_steep = |pair: &[(f64, f64, f64)]| (pair[1].1 - pair[0].1).abs() > (pair[1].2 - pair[0].2) * 1.05 + 0.1;
    if hull.len() < 2 || hull.windows(2).any(is_steep) {
        return Err("its ramps would be too steep");
    }
    Ok(Floor(hull.into_iter().map(|(s, height, _)| (s, height)).collect()))
}
