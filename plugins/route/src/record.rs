//! What a visitor's own walk becomes as a tour: few steps that can be edited, in place of many samples.
//!
//! ```text
//!  samples ─ leaps ─► shots ─ standing or not ─► stands ───────────────────────► Look, Wait
//!                                            └─► movements ─ gaze, height ─► walks ─► Walk, the fewest spots along streets
//!                                                                        └─► flights ─► Fly, the fewest points of the curve
//! ```

mod flown;
mod gaze;
mod stand;
#[cfg(test)]
mod tests;
mod walked;

use glam::{DVec2, DVec3};
use veduta_city::{LookAt, Step, Tour, Where};

use crate::{Gazetteer, Pose, StreetNet, WALK_EYE_M, pose::Facing, turn_deg};

/// So far a played tour leaves a walk that was recorded, metres in plan. Streets are followed along their middle.
pub const RECORDED_WALK_M: f64 = 2.5;
/// So far it leaves a flight, metres.
pub const RECORDED_FLIGHT_M: f64 = 1.0;
/// So far its direction of view is from the one recorded where it stands, or looks at a spot or in a direction, degrees; ahead along the
/// way it is as far as a walker's eyes wander.
pub const RECORDED_GAZE_DEG: f64 = 12.0;
/// The longest recording, seconds.
pub const LONGEST_RECORDING_S: f64 = 3600.0;

/// Samples are kept at least so long after one another, seconds.
const SAMPLE_S: f64 = 0.1;
/// Who is farther away all at once has leapt, metres.
const LEAP_M: f64 = 25.0;
/// Who goes more slowly stands, metres a second; who stands more briefly goes on, seconds; who goes less far stands, metres.
const STILL_M_S: f64 = 0.15;
const PAUSE_S: f64 = 0.7;
const STIR_M: f64 = 0.4;
/// Eyes this much higher or lower than a walker's fly, metres.
const ALOFT_M: f64 = 0.35;
/// The field of view is told where it has changed by more, degrees.
const FOV_DEG: f64 = 2.0;

/// Where somebody was and looked, when.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sample {
    pub t_s: f64,
    /// Plan metres, and metres above the ground.
    pub at: DVec3,
    /// Headings go on beyond a full turn.
    pub facing: Facing,
    pub fov_deg: f64,
}

/// A walk as it is being recorded.
#[derive(Debug, Clone, Default)]
pub struct Recording {
    samples: Vec<Sample>,
}

impl Recording {
    /// Notes where somebody is at a moment, seconds from any beginning. What comes too soon after the last, in the dark of a leap, or after
    /// [`LONGEST_RECORDING_S`] is not kept.
    pub fn note(&mut self, t_s: f64, pose: &Pose) {
        if !(t_s.is_finite() && pose.is_finite()) || pose.fade > 0.5 || self.duration_s() > LONGEST_RECORDING_S {
            return;
        }
        let mut facing = pose.facing();
        if let Some(last) = self.samples.last() {
            if t_s < last.t_s + SAMPLE_S {
                return;
            }
            facing.heading = last.facing.heading + turn_deg(last.facing.heading, facing.heading);
        }
        let next = Sample { t_s, at: pose.at(), facing, fov_deg: pose.fov_deg };
        let is_same = |a: &Sample| Sample { t_s, ..*a } == next;
        // Who stands long is there once at the beginning and once at the end.
        if let [.., before, last] = self.samples.as_mut_slice()
            && is_same(before)
            && is_same(last)
        {
            last.t_s = t_s;
            return;
        }
        self.samples.push(next);
    }

    /// How long it is, seconds.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.samples.last().zip(self.samples.first()).map_or(0.0, |(last, first)| last.t_s - first.t_s)
    }

    /// Length of the way, metres; leaps do not count.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.samples.windows(2).map(|w| w[0].at.distance(w[1].at)).filter(|d| *d < LEAP_M).sum()
    }

    /// Whether nothing was noted.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// The recording as steps, of which the first stands where it begins. Played with the settings of `tour` among the same streets and
    /// places they follow it to within [`RECORDED_WALK_M`], [`RECORDED_FLIGHT_M`] and [`RECORDED_GAZE_DEG`]. A place is named where a leg
    /// ends at its stand.
    #[must_use]
    pub fn steps(&self, tour: &Tour, net: &StreetNet, places: &Gazetteer) -> Vec<Step> {
        let Some(first) = self.samples.first() else { return Vec::new() };
        let eye_m = if first.at.z <= WALK_EYE_M { first.at.z } else { tour.eye_m };
        let mut scribe = Scribe { tour, net, places, eye_m, steps: Vec::new(), facing: Facing::default(), fov_deg: tour.fov_deg };
        let mut from = 0;
        for i in 1..=self.samples.len() {
            let leaps = self.samples.get(i).is_none_or(|next| next.at.distance(self.samples[i - 1].at) >= LEAP_M);
            if leaps {
                scribe.shot(&self.samples[from..i]);
                from = i;
            }
        }
        scribe.steps
    }
}

/// Steps in the making.
struct Scribe<'a> {
    tour: &'a Tour,
    net: &'a StreetNet,
    places: &'a Gazetteer,
    /// Eye height of a walker.
    eye_m: f64,
    steps: Vec<Step>,
    /// Where the tour looks that far.
    facing: Facing,
    fov_deg: f64,
}

/// A stretch of samples, from one to another, both included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Stretch {
    from: usize,
    to: usize,
}

impl Scribe<'_> {
    /// What lies between two leaps.
    fn shot(&mut self, samples: &[Sample]) {
        let Some(first) = samples.first() else { return };
        let at = spot(first.at.truncate());
        let eye_m = ((first.at.z - self.tour.eye_m).abs() > 0.02).then(|| hundredth(first.at.z));
        let look = heading(first.facing);
        self.facing = facing_of(&look);
        let step =
            if self.steps.is_empty() { Step::Start { at, eye_m, look } } else { Step::Cut { to: at, eye_m, look, seconds: CUT_S } };
        self.steps.push(step);
        for (stretch, moves) in stretches(samples) {
            self.fov(samples[stretch.from].fov_deg);
            let part = &samples[stretch.from..=stretch.to];
            if moves { self.movement(part) } else { stand::tell(part, &mut self.facing, &mut self.steps) }
        }
        self.fov(samples[samples.len() - 1].fov_deg);
    }

    fn fov(&mut self, fov_deg: f64) {
        if (fov_deg - self.fov_deg).abs() > FOV_DEG {
            self.fov_deg = fov_deg.round();
            let seconds = if self.steps.len() < 2 { 0.0 } else { 0.5 };
            self.steps.push(Step::Fov { deg: self.fov_deg, seconds });
        }
    }

    /// Walks and flies, in turn.
    fn movement(&mut self, samples: &[Sample]) {
        for (stretch, is_flight) in by_height(samples, self.eye_m) {
            let part = &samples[stretch.from..=stretch.to];
            let legs = gaze::legs(part, &self.net.terrain, is_flight);
            if is_flight {
                flown::tell(part, &legs, &mut self.steps);
            } else {
                walked::tell(part, &legs, self.net, self.places, self.tour.speed, &mut self.steps);
            }
            if let (Some(leg), Some(last)) = (legs.last(), part.last()) {
                self.facing = gaze::at_the_end(&leg.look, part, &self.net.terrain).unwrap_or(last.facing);
            }
        }
    }
}

/// Fade of a cut, seconds.
const CUT_S: f64 = 1.6;

/// Where samples stand and where they move, in turn.
fn stretches(samples: &[Sample]) -> Vec<(Stretch, bool)> {
    let moves = |w: &[Sample]| w[0].at.distance(w[1].at) > STILL_M_S * (w[1].t_s - w[0].t_s);
    let mut parts = runs(samples.windows(2).map(moves));
    let lasts_s = |part: &Stretch| samples[part.to].t_s - samples[part.from].t_s;
    let length_m = |part: &Stretch| samples[part.from..=part.to].windows(2).map(|w| w[0].at.distance(w[1].at)).sum::<f64>();
    // Short stops first: steps seen between few frames stop and go.
    merge(&mut parts, |part, moves| !moves && lasts_s(part) < PAUSE_S);
    merge(&mut parts, |part, moves| moves && length_m(part) < STIR_M);
    parts
}

/// Where a walker flies and where not, in turn.
fn by_height(samples: &[Sample], eye_m: f64) -> Vec<(Stretch, bool)> {
    const SHORT_M: f64 = 2.0;
    let is_high = |s: &Sample| s.at.z > WALK_EYE_M || (s.at.z - eye_m).abs() > ALOFT_M;
    let mut parts = runs(samples.windows(2).map(|w| is_high(&w[0]) || is_high(&w[1])));
    let length_m = |part: &Stretch| samples[part.from].at.distance(samples[part.to].at);
    merge(&mut parts, |part, flies| !flies && length_m(part) < SHORT_M);
    parts
}

/// Runs of steps between samples that are alike.
fn runs(alike: impl Iterator<Item = bool>) -> Vec<(Stretch, bool)> {
    let mut parts: Vec<(Stretch, bool)> = Vec::new();
    for (i, is) in alike.enumerate() {
        match parts.last_mut() {
            Some((part, was)) if *was == is => part.to = i + 1,
            _ => parts.push((Stretch { from: i, to: i + 1 }, is)),
        }
    }
    parts
}

/// Counts some stretches among their neighbours; one that is alone stays.
fn merge(parts: &mut Vec<(Stretch, bool)>, belongs_elsewhere: impl Fn(&Stretch, bool) -> bool) {
    if parts.len() < 2 {
        return;
    }
    for (part, is) in parts.iter_mut() {
        if belongs_elsewhere(part, *is) {
            *is = !*is;
        }
    }
    parts.dedup_by(|next, part| {
        let alike = next.1 == part.1;
        if alike {
            part.0.to = next.0.to;
        }
        alike
    });
}

fn tenth(n: f64) -> f64 {
    libm::round(n * 10.0) / 10.0
}

fn hundredth(n: f64) -> f64 {
    libm::round(n * 100.0) / 100.0
}

/// A spot as a person would write it.
fn spot(plan_pos: DVec2) -> Where {
    Where::At(tenth(plan_pos.x), tenth(plan_pos.y))
}

/// A direction in whole degrees.
fn heading(facing: Facing) -> LookAt {
    let deg = libm::round(facing.heading.rem_euclid(360.0)).rem_euclid(360.0);
    LookAt::Heading { deg, pitch_deg: libm::round(facing.pitch) }
}

fn facing_of(look: &LookAt) -> Facing {
    match *look {
        LookAt::Heading { deg, pitch_deg } => Facing { heading: deg, pitch: pitch_deg },
        _ => Facing::default(),
    }
}

/// Between two directions, degrees: the greater of turn and tilt.
fn apart_deg(a: Facing, b: Facing) -> f64 {
    turn_deg(a.heading, b.heading).abs().max((a.pitch - b.pitch).abs())
}

/// The farthest end up to which a stretch from `from` fits: by doubling, then by halves. `from + 1` counts as fitting.
fn farthest(from: usize, end: usize, fits: impl Fn(usize) -> bool) -> usize {
    let (mut good, mut step) = ((from + 1).min(end), 1);
    let mut bad = end + 1;
    while good < end {
        let next = (good + step).min(end);
        if !fits(next) {
            bad = next;
            break;
        }
        (good, step) = (next, step * 2);
    }
    while bad - good > 1 && bad <= end {
        let middle = good.midpoint(bad);
        if fits(middle) { good = middle } else { bad = middle }
    }
    good
}

/// Douglas and Peucker (1973): the indices of those that matter, first and last among them. `off` tells how far one is from what lies
/// between two others.
fn simplified(count: usize, most: f64, off: impl Fn(usize, usize, usize) -> f64) -> Vec<usize> {
    let mut kept = vec![0, count.saturating_sub(1)];
    let mut open = vec![(0, count.saturating_sub(1))];
    while let Some((a, b)) = open.pop() {
        let worst = (a + 1..b).map(|i| (off(a, b, i), i)).max_by(|x, y| x.0.total_cmp(&y.0));
        if let Some((_, i)) = worst.filter(|(off, _)| *off > most) {
            kept.push(i);
            open.extend([(a, i), (i, b)]);
        }
    }
    kept.sort_unstable();
    kept.dedup();
    kept
}
