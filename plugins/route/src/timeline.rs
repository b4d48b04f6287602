//! Positions and directions of view over time.
//!
//! Positions come from the paths and paces themselves. The direction wanted at each moment (a spot, a heading, along the
//! way) jumps where steps meet; it is followed at a bounded angular speed sixty times a second, averaged over half a
//! second twice (to both sides, so nothing lags), and read through a cubic B-spline. All three keep the bound, and the last
//! two bound the angular acceleration and make it continuous. Nothing is averaged across a cut. A track's directions are its own:
//! it is left as it was made, and what comes before and after it is led to its ends.

use glam::{DVec2, DVec3, swizzles::Vec3Swizzles};
use veduta_city::PlanTerrain;

use crate::{
    pace::Pace,
    path::Path,
    pose::{Facing, smoothstep, turn_deg},
    track::{Key, Track},
};

/// Greatest angular speed, degrees a second.
pub const TURN_DEG_S: f64 = 60.0;
/// Entries of the table of directions, a second.
const RATE_HZ: f64 = 60.0;
/// Entries averaged to either side, twice.
const AVERAGED: usize = 15;
/// The view begins to turn so much before a movement that asks for it, and is still so much after, in seconds.
pub(crate) const SETTLE_S: f64 = (2 * AVERAGED + 2) as f64 / RATE_HZ;

/// What the eye turns to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Gaze {
    /// Nothing else than before.
    Hold,
    /// A direction.
    Direction(Facing),
    /// A spot.
    Spot {
        /// Plan metres and height above the ground.
        at: DVec3,
        /// The step that names what is followed from there.
        follow: Option<usize>,
    },
    /// Along the path.
    Ahead,
}

impl Gaze {
    /// The direction from a standing eye, on the ground of a city.
    pub fn from(self, at: DVec3, now: Facing, terrain: &PlanTerrain) -> Facing {
        match self {
            Self::Hold | Self::Ahead => now,
            Self::Direction(facing) => facing,
            Self::Spot { at: spot, .. } => {
                let rise = terrain.height_m(spot.xy()) - terrain.height_m(at.xy());
                Facing::along((spot - at) + DVec3::Z * rise, now)
            }
        }
    }
}

/// A movement along a path.
#[derive(Debug, Clone)]
pub(crate) struct Run {
    pub path: Path,
    pub pace: Pace,
    /// How far ahead the eye looks, in metres.
    pub reach_m: f64,
    pub is_walk: bool,
}

impl Run {
    /// Direction of view along the path, a walker's level, a flight's leaning a little into climbs and falls.
    pub fn facing(&self, s: f64, now: Facing) -> Facing {
        let facing = Facing::along(self.path.ahead(s, self.reach_m), now);
        if self.is_walk {
            return Facing { pitch: 0.0, ..facing };
        }
        Facing { pitch: (0.6 * facing.pitch).clamp(-35.0, 35.0), ..facing }
    }
}

#[derive(Debug, Clone)]
enum Motion {
    Stand(DVec3),
    Run(Box<Run>),
    Track(Track),
}

#[derive(Debug, Clone)]
struct Clip {
    start_s: f64,
    motion: Motion,
}

impl Clip {
    fn at(&self, t: f64) -> DVec3 {
        match &self.motion {
            Motion::Stand(at) => *at,
            Motion::Run(run) => run.path.at(run.pace.travelled(t - self.start_s)),
            Motion::Track(track) => track.at(t - self.start_s),
        }
    }

    /// The direction at a moment, if a track says it.
    fn tracked(&self, t: f64) -> Option<Facing> {
        match &self.motion {
            Motion::Track(track) if t <= self.start_s + track.duration_s() => Some(track.facing(t - self.start_s)),
            _ => None,
        }
    }
}

/// From a moment on, what the eye turns to, and how slowly.
#[derive(Debug, Clone, Copy)]
struct Cue {
    start_s: f64,
    gaze: Gaze,
    turn_s: f64,
}

/// What lies between two cuts: directions at [`RATE_HZ`].
#[derive(Debug, Clone)]
struct Shot {
    start_s: f64,
    first: Facing,
    table: Vec<Facing>,
}

/// A timeline in the making.
#[derive(Debug)]
pub(crate) struct Draft<'a> {
    pub terrain: &'a PlanTerrain,
    pub now_s: f64,
    pub here: DVec3,
    /// The direction wanted now.
    pub facing: Facing,
    clips: Vec<Clip>,
    cues: Vec<Cue>,
    shots: Vec<Shot>,
    /// Since when nothing asks the eye to turn, and when the last track ended.
    still_s: f64,
    track_s: f64,
}

impl<'a> Draft<'a> {
    pub fn new(here: DVec3, facing: Facing, terrain: &'a PlanTerrain) -> Self {
        let (clips, cues, shots) = (Vec::new(), Vec::new(), Vec::new());
        let mut draft =
            Self { terrain, now_s: 0.0, here, facing, clips, cues, shots, still_s: f64::NEG_INFINITY, track_s: f64::NEG_INFINITY };
        draft.place(here, facing);
        draft
    }

    /// Stands somewhere else from now on.
    pub fn place(&mut self, here: DVec3, facing: Facing) {
        (self.here, self.facing) = (here, facing);
        self.shots.push(Shot { start_s: self.now_s, first: facing, table: Vec::new() });
        self.clips.push(Clip { start_s: self.now_s, motion: Motion::Stand(here) });
        self.cue(self.now_s, Gaze::Hold, 0.0);
        self.still_s = f64::NEG_INFINITY;
    }

    /// Stays until the view is at rest.
    pub fn settle(&mut self) {
        self.stand((self.still_s + SETTLE_S - self.now_s).min(SETTLE_S));
    }

    /// Stays after a track until the view may turn again without a jerk.
    pub fn settle_after_track(&mut self) {
        self.stand((self.track_s + SETTLE_S - self.now_s).min(SETTLE_S));
    }

    /// Moves by keys, each after the one before, from the present pose.
    pub fn track(&mut self, keys: &[Key]) {
        self.cue(self.now_s, Gaze::Hold, 0.0);
        let first = Key { seconds: 0.0, at: self.here, facing: self.facing };
        let track = Track::new(core::iter::once(first).chain(keys.iter().copied()));
        (self.here, self.facing) = (track.at(track.duration_s()), track.facing(track.duration_s()));
        let seconds = track.duration_s();
        self.clips.push(Clip { start_s: self.now_s, motion: Motion::Track(track) });
        self.now_s += seconds;
        self.cue(self.now_s, Gaze::Hold, 0.0);
        (self.still_s, self.track_s) = (f64::NEG_INFINITY, self.now_s);
    }

    /// From a moment on, turns the eye; in so many seconds, or as fast as it may.
    pub fn cue(&mut self, start_s: f64, gaze: Gaze, turn_s: f64) {
        self.cues.push(Cue { start_s, gaze, turn_s });
    }

    /// Stays.
    pub fn stand(&mut self, seconds: f64) {
        if seconds > 0.0 {
            self.clips.push(Clip { start_s: self.now_s, motion: Motion::Stand(self.here) });
            self.now_s += seconds;
        }
    }

    /// Turns on the spot in so many seconds, or as many as the bound on angular speed asks for.
    pub fn turn(&mut self, gaze: Gaze, seconds: f64) {
        let to = gaze.from(self.here, self.facing, self.terrain);
        let angle = turn_deg(self.facing.heading, to.heading).abs().max((to.pitch - self.facing.pitch).abs());
        let seconds = seconds.max(1.5 * angle / TURN_DEG_S);
        self.cue(self.now_s, gaze, seconds);
        self.facing = to;
        self.stand(seconds);
        self.still_s = self.now_s;
    }

    /// Turns towards a path that is to be followed with the eyes, until little of the turn is left for the way.
    pub fn set_off(&mut self, run: &Run, gaze: Gaze) {
        const LEFT_FOR_THE_WAY_DEG: f64 = 60.0;
        if gaze != Gaze::Ahead {
            self.cue(self.now_s, gaze, 0.0);
            return;
        }
        let ahead = run.facing(0.0, self.facing);
        let turn = turn_deg(self.facing.heading, ahead.heading).abs();
        self.cue(self.now_s, Gaze::Direction(ahead), 0.0);
        self.stand((turn - LEFT_FOR_THE_WAY_DEG) / TURN_DEG_S);
        self.cue(self.now_s, Gaze::Ahead, 0.0);
    }

    /// Moves.
    pub fn run(&mut self, run: Run) {
        self.clips.push(Clip { start_s: self.now_s, motion: Motion::Run(Box::new(run.clone())) });
        self.now_s += run.pace.duration_s();
        self.here = run.path.at(run.path.length());
        self.still_s = self.now_s;
    }

    /// Works out the directions of view. The timeline ends when all is said and done and the view is still.
    pub fn finish(mut self, end_s: f64) -> Timeline {
        self.clips.push(Clip { start_s: self.now_s, motion: Motion::Stand(self.here) });
        let ends: Vec<f64> = self.shots.iter().skip(1).map(|s| s.start_s).chain([f64::INFINITY]).collect();
        let mut end = end_s;
        for (shot, cut_s) in self.shots.iter_mut().zip(ends) {
            let least = libm::ceil((end_s.min(cut_s) - shot.start_s).max(0.0) * RATE_HZ) as usize + 1;
            shot.table = look_along(self.terrain, &self.clips, &self.cues, shot, cut_s, least);
            if shot.table.len() > least {
                end = end.max(shot.start_s + (shot.table.len() - 1) as f64 / RATE_HZ);
            }
        }
        Timeline { clips: self.clips, cues: self.cues, shots: self.shots, end_s: end }
    }
}

/// Follows the cues through a shot for at least so many entries; through the last one until the view is still.
fn look_along(terrain: &PlanTerrain, clips: &[Clip], cues: &[Cue], shot: &Shot, cut_s: f64, least: usize) -> Vec<Facing> {
    /// Half a turn, and time to spare.
    const LONGEST: usize = 5 * RATE_HZ as usize;
    let before = |start_s: f64| start_s < shot.start_s;
    let (mut clip, mut cue) = (clips.partition_point(|c| before(c.start_s)), cues.partition_point(|c| before(c.start_s)));
    let (mut state, mut from) = (shot.first, shot.first);
    let mut still = 0;
    let mut followed = Vec::with_capacity(least);
    let mut are_tracked = Vec::with_capacity(least);
    while followed.len() < least || (cut_s.is_infinite() && still < 2 * AVERAGED + 2 && followed.len() < least + LONGEST) {
        let t = shot.start_s + followed.len() as f64 / RATE_HZ;
        // The last entry may lie beyond the shot, where the next one's clips begin.
        let goes_on = |start_s: f64| start_s <= t && start_s < cut_s;
        while clips.get(clip + 1).is_some_and(|c| goes_on(c.start_s)) {
            clip += 1;
        }
        while cues.get(cue + 1).is_some_and(|c| goes_on(c.start_s)) {
            cue += 1;
            from = state;
        }
        let last = state;
        if let (Some(clip), Some(cue)) = (clips.get(clip), cues.get(cue)) {
            let tracked = clip.tracked(t);
            are_tracked.push(tracked.is_some());
            state = match tracked {
                Some(facing) => Facing { heading: state.heading + turn_deg(state.heading, facing.heading), ..facing },
                None => follow(state, wanted(terrain, clip, cue, t, from, state)),
            };
        }
        let is_still = (state.heading - last.heading).abs().max((state.pitch - last.pitch).abs()) < 1e-9;
        still = if is_still { still + 1 } else { 0 };
        followed.push(state);
    }
    smoothed(&followed, &are_tracked)
}

/// The directions averaged where no track says them; beside a track they are led to its ends.
fn smoothed(followed: &[Facing], are_tracked: &[bool]) -> Vec<Facing> {
    const LED: f64 = (2 * AVERAGED + 2) as f64;
    let mut smoothed = Vec::with_capacity(followed.len());
    for run in are_tracked.chunk_by(|a, b| a == b) {
        let (start, end) = (smoothed.len(), smoothed.len() + run.len());
        let own = &followed[start..end];
        if run.first() == Some(&true) {
            smoothed.extend_from_slice(own);
            continue;
        }
        let before = start.checked_sub(1).map(|i| followed[i]);
        let after = followed.get(end);
        for (i, facing) in averaged(&averaged(own)).into_iter().enumerate() {
            let led = |to: Option<Facing>, away: usize, facing: Facing| {
                to.map_or(facing, |to| to.towards(facing, smoothstep((away + 1) as f64 / LED)))
            };
            smoothed.push(led(after.copied(), run.len() - 1 - i, led(before, i, facing)));
        }
    }
    smoothed
}

fn wanted(terrain: &PlanTerrain, clip: &Clip, cue: &Cue, t: f64, from: Facing, state: Facing) -> Facing {
    let to = match (cue.gaze, &clip.motion) {
        (Gaze::Ahead, Motion::Run(run)) => run.facing(run.pace.travelled(t - clip.start_s), state),
        (gaze, _) => gaze.from(clip.at(t), state, terrain),
    };
    if cue.turn_s <= 0.0 {
        return to;
    }
    let share = smoothstep((t - cue.start_s) / cue.turn_s);
    Facing {
        heading: from.heading + turn_deg(from.heading, to.heading) * share,
        pitch: from.pitch + (to.pitch - from.pitch) * share,
    }
}

/// One entry's turn towards the direction wanted.
fn follow(state: Facing, wanted: Facing) -> Facing {
    const MOST: f64 = TURN_DEG_S / RATE_HZ;
    let heading = state.heading + turn_deg(state.heading, wanted.heading).clamp(-MOST, MOST);
    let pitch = (state.pitch + (wanted.pitch - state.pitch).clamp(-MOST, MOST)).clamp(-90.0, 90.0);
    Facing { heading, pitch }
}

/// Each entry's mean with its neighbours; the first and last entries go on for ever.
fn averaged(table: &[Facing]) -> Vec<Facing> {
    let (Some(&first), Some(&last)) = (table.first(), table.last()) else { return Vec::new() };
    let padded = core::iter::repeat_n(first, AVERAGED).chain(table.iter().copied()).chain(core::iter::repeat_n(last, AVERAGED));
    let mut sums = vec![Facing::default()];
    let mut sum = Facing::default();
    for entry in padded {
        sum = Facing { heading: sum.heading + (entry.heading - first.heading), pitch: sum.pitch + entry.pitch };
        sums.push(sum);
    }
    let width = 2 * AVERAGED + 1;
    let mean = |a: &Facing, b: &Facing| Facing {
        heading: first.heading + (b.heading - a.heading) / width as f64,
        pitch: (b.pitch - a.pitch) / width as f64,
    };
    sums.iter().zip(sums.iter().skip(width)).map(|(a, b)| mean(a, b)).collect()
}

/// Positions and directions of view over time.
#[derive(Debug, Clone)]
pub(crate) struct Timeline {
    clips: Vec<Clip>,
    cues: Vec<Cue>,
    shots: Vec<Shot>,
    end_s: f64,
}

impl Timeline {
    pub fn end_s(&self) -> f64 {
        self.end_s
    }

    /// Where the eye is; clamps.
    pub fn at(&self, t: f64) -> DVec3 {
        let clip = self.clips.partition_point(|c| c.start_s <= t).saturating_sub(1);
        self.clips.get(clip).map_or(DVec3::ZERO, |c| c.at(t.min(self.end_s)))
    }

    /// The step that names what the eye follows, and how far it has turned there, 0 to 1.
    pub fn followed(&self, t: f64) -> Option<(usize, f64)> {
        let cue = self.cues.partition_point(|c| c.start_s <= t).checked_sub(1).and_then(|i| self.cues.get(i))?;
        let Gaze::Spot { follow, .. } = cue.gaze else { return None };
        let share = if cue.turn_s > 0.0 { smoothstep((t - cue.start_s) / cue.turn_s) } else { 1.0 };
        Some((follow?, share))
    }

    /// Where it looks; clamps. The heading is within 0 to 360.
    pub fn facing(&self, t: f64) -> Facing {
        let shot = self.shots.partition_point(|s| s.start_s <= t).saturating_sub(1);
        let Some(shot) = self.shots.get(shot) else { return Facing::default() };
        let place = ((t.min(self.end_s) - shot.start_s) * RATE_HZ).max(0.0);
        let (whole, x) = (libm::floor(place), place - libm::floor(place));
        let last = shot.table.len().saturating_sub(1);
        let entry = |offset: usize| {
            let index = (whole as usize + offset).saturating_sub(1).min(last);
            shot.table.get(index).copied().unwrap_or(shot.first)
        };
        let weights = [
            (1.0 - x) * (1.0 - x) * (1.0 - x) / 6.0,
            (3.0 * x * x * x - 6.0 * x * x + 4.0) / 6.0,
            (-3.0 * x * x * x + 3.0 * x * x + 3.0 * x + 1.0) / 6.0,
            x * x * x / 6.0,
        ];
        let (mut heading, mut pitch) = (0.0, 0.0);
        for (offset, weight) in weights.into_iter().enumerate() {
            let entry = entry(offset);
            heading += weight * entry.heading;
            pitch += weight * entry.pitch;
        }
        // A tiny negative heading would be rounded up to 360.
        let heading = heading.rem_euclid(360.0);
        Facing { heading: if heading < 360.0 { heading } else { 0.0 }, pitch: pitch.clamp(-90.0, 90.0) }
    }

    /// When each shot begins, seconds: the first at 0, each other where the tour is cut.
    pub fn cuts(&self) -> Vec<f64> {
        self.shots.iter().map(|shot| shot.start_s).collect()
    }

    /// The ways gone on the ground between two cuts, plan metres; standing still is one position.
    pub fn ways(&self) -> Vec<Vec<DVec2>> {
        let mut ways: Vec<Vec<DVec2>> = Vec::new();
        let mut shots = self.shots.iter().map(|s| s.start_s).peekable();
        for clip in &self.clips {
            if shots.next_if(|&start_s| start_s <= clip.start_s).is_some() {
                while shots.next_if(|&start_s| start_s <= clip.start_s).is_some() {}
                ways.push(Vec::new());
            }
            let Some(way) = ways.last_mut() else { continue };
            let points: Vec<DVec2> = match &clip.motion {
                Motion::Stand(at) => vec![at.xy()],
                Motion::Run(run) => run.path.knots().iter().map(|k| k.at.xy()).collect(),
                Motion::Track(track) => track.keys().iter().map(|key| key.at.xy()).collect(),
            };
            way.extend(points);
            way.dedup();
        }
        ways
    }
}
