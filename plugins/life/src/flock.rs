//! What a flock does, tick by tick: who flies up, when, and where to. Ticks lie on a grid of their own, so that a flock does the same at
//! any frame rate.

use bevy::math::{DVec2, DVec3};
use veduta_city::Id;
use veduta_city::draw::Draw;

use crate::bird::{Flight, Perch, Pose, Spot};

/// Ticks a second.
pub(crate) const TICKS_S: f64 = 5.0;
/// More ticks are not made up for after a pause.
const MOST_TICKS: i64 = 64;
/// Who goes slower than this, metres a second, hardly frightens birds; who goes so fast frightens them from afar.
const CALM_M_S: f64 = 0.3;
const WALK_M_S: f64 = 1.4;
/// Share of the distance within which even one who stands still is too near.
const LEAST_SHARE: f64 = 0.22;
/// Nobody goes so far in a tick, metres: who does has been put there.
const LEAP_M: f64 = 6.0;
/// Fright runs through a flock at this speed, metres a second, and so far beyond the first bird that took it, as a share.
const FRIGHT_M_S: f64 = 16.0;
const CONTAGION: f64 = 1.7;
/// Birds fly up for no reason anybody knows once in so many ticks.
const WHIM_TICKS: u64 = 600;
/// A bell so near is a fright, metres.
const NOISE_M: f64 = 55.0;
/// Birds do not come down nearer to one another than this, metres.
const ELBOW_M: f64 = 0.55;

/// Birds on a square.
#[derive(Debug, Clone)]
pub(crate) struct Flock {
    draw: Draw,
    middle: DVec2,
    startle_m: f64,
    /// Where birds may come down.
    spots: Vec<Spot>,
    birds: Vec<Bird>,
    /// The last tick that was done, and where a viewer was then.
    tick: i64,
    eyes: Vec<DVec3>,
    /// When the flock was frightened last, seconds.
    pub frightened_s: Option<f64>,
}

#[derive(Debug, Clone, Copy)]
struct Bird {
    draw: Draw,
    stay: Perch,
    /// The flight to that stay, if it came by one.
    flight: Option<(Perch, Flight)>,
    flights: u64,
}

impl Bird {
    fn pose(&self, time_s: f64) -> Pose {
        match &self.flight {
            Some((before, flight)) if time_s < flight.start_s => before.pose(time_s),
            Some((_, flight)) if time_s < self.stay.since_s => flight.pose(time_s),
            _ => self.stay.pose(time_s),
        }
    }

    fn is_down(&self, time_s: f64) -> bool {
        time_s >= self.stay.since_s
    }
}

/// What birds notice between two frames.
#[derive(Debug, Clone, Default)]
pub(crate) struct Notice<'a> {
    /// Where viewers were at the last frame and are now: plan metres with the elevation.
    pub eyes: &'a [(DVec3, DVec3)],
    /// When and where something made a noise.
    pub noises: &'a [(f64, DVec2)],
}

impl Flock {
    /// So many birds about a middle, each on a spot of its own, as long as there are spots; they have been there since ever.
    pub(crate) fn new(id: Id, middle: DVec2, count: usize, startle_m: f64, spots: Vec<Spot>, time_s: f64) -> Self {
        let draw = Draw::new(0, id, "flock");
        let mut free: Vec<usize> = (0..spots.len()).collect();
        let birds = (0..count.min(spots.len())).map(|n| {
            let own = draw.part(n as u64);
            let spot = spots[free.swap_remove(own.below("spot", free.len()))];
            let heading = own.between("heading", 0.0, core::f64::consts::TAU);
            // Each has stood for another while, counted from the whole minute: which second a flock appears in tells nothing.
            let since_s = (time_s / 60.0).floor() * 60.0 - own.between("since", 10.0, 40.0);
            let stay = Perch { spot, draw: own.part(0), since_s, heading };
            Bird { draw: own, stay, flight: None, flights: 0 }
        });
        let birds = birds.collect();
        let tick = (time_s * TICKS_S).floor() as i64;
        Self { draw, middle, startle_m, spots, birds, tick, eyes: Vec::new(), frightened_s: None }
    }

    /// How many birds there are.
    pub(crate) fn len(&self) -> usize {
        self.birds.len()
    }

    /// The birds at a time that has been [gone to](Self::advance).
    pub(crate) fn poses(&self, time_s: f64) -> impl Iterator<Item = Pose> {
        self.birds.iter().map(move |bird| bird.pose(time_s))
    }

    /// Does all ticks between a time and a later one. Viewers are taken to have gone straight from where they were to where they are.
    pub(crate) fn advance(&mut self, from_s: f64, to_s: f64, notice: &Notice<'_>) {
        let last = (to_s * TICKS_S).floor() as i64;
        self.tick = self.tick.max(last - MOST_TICKS).min(last);
        while self.tick < last {
            self.tick += 1;
            let time_s = self.tick as f64 / TICKS_S;
            let share = if to_s > from_s { ((time_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0) } else { 1.0 };
            let eyes: Vec<DVec3> = notice.eyes.iter().map(|(a, b)| a.lerp(*b, share)).collect();
            let heard = notice
                .noises
                .iter()
                .find(|(when, at)| (time_s - 1.0 / TICKS_S..=time_s).contains(when) && at.distance(self.middle) < NOISE_M);
            let whim = (self.tick as u64).is_multiple_of(WHIM_TICKS / 2) && self.draw.part(self.tick as u64).chance("whim", 0.5);
            match heard {
                Some(&(_, at)) => self.startle(time_s, at, f64::INFINITY),
                None if whim => self.startle(time_s, self.middle, f64::INFINITY),
                None => self.look_about(time_s, &eyes),
            }
            self.eyes = eyes;
        }
    }

    /// Flies up from whoever is too near.
    fn look_about(&mut self, time_s: f64, eyes: &[DVec3]) {
        for (n, &eye) in eyes.iter().enumerate() {
            let speed = self.eyes.get(n).map(|last| last.distance(eye)).filter(|moved| *moved < LEAP_M).unwrap_or(0.0) * TICKS_S;
            let share = ((speed - CALM_M_S) / (WALK_M_S - CALM_M_S)).clamp(LEAST_SHARE, 1.6);
            let reach_m = self.startle_m * share;
            if eye.truncate().distance(self.middle) > reach_m + 250.0 {
                continue;
            }
            // Eyes are above feet.
            let is_near = |bird: &Bird| {
                bird.is_down(time_s) && (bird.pose(time_s).pos - eye).length() < (reach_m * reach_m + 1.65 * 1.65).sqrt()
            };
            if reach_m > 0.0 && self.birds.iter().any(is_near) {
                self.startle(time_s, eye.truncate(), reach_m * CONTAGION);
            }
        }
    }

    /// All birds on the ground within a distance of a fright fly up, one after another.
    fn startle(&mut self, time_s: f64, from: DVec2, reach_m: f64) {
        self.frightened_s = Some(time_s);
        for n in 0..self.birds.len() {
            let bird = self.birds[n];
            let away = bird.pose(time_s).pos.truncate().distance(from);
            if !bird.is_down(time_s) || away > reach_m {
                continue;
            }
            let draw = bird.draw.part(bird.flights + 1);
            let near_m = if reach_m.is_finite() { away } else { draw.between("late", 0.0, 14.0) };
            let start_s = time_s + near_m / FRIGHT_M_S + draw.between("wits", 0.05, 0.45);
            let pose = bird.stay.pose(start_s);
            let Some(spot) = self.landing(n, draw, from) else { continue };
            let flight = Flight { from: pose.pos, heading: pose.heading, to: spot.pos, start_s, middle: self.middle, draw };
            let stay = Perch { spot, draw, since_s: flight.end_s(), heading: flight.last_heading() };
            self.birds[n] = Bird { stay, flight: Some((bird.stay, flight)), flights: bird.flights + 1, ..bird };
        }
    }

    /// Where a bird comes down: of some spots that nobody has, the first that is far from the fright, else the farthest.
    fn landing(&self, bird: usize, draw: Draw, from: DVec2) -> Option<Spot> {
        let far_m = self.startle_m * 2.5;
        let is_taken = |spot: &Spot| {
            let others = self.birds.iter().enumerate().filter(|(n, _)| *n != bird);
            others.into_iter().any(|(_, other)| other.stay.spot.pos.distance(spot.pos) < ELBOW_M)
        };
        let mut best: Option<(f64, Spot)> = None;
        for k in 0..10 {
            let spot = *self.spots.get(draw.part(k).below("landing", self.spots.len()))?;
            let away = spot.pos.truncate().distance(from);
            if is_taken(&spot) {
                continue;
            }
            if away > far_m {
                return Some(spot);
            }
            if best.is_none_or(|(farthest, _)| away > farthest) {
                best = Some((away, spot));
            }
        }
        Some(best.map_or(self.birds[bird].stay.spot, |(_, spot)| spot))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<Spot> {
        let at = |n: i32| DVec3::new(f64::from(n % 12) * 2.0 - 12.0, f64::from(n / 12) * 2.0 - 8.0, 1.0);
        (0..96).map(|n| Spot { pos: at(n), slope: DVec2::ZERO }).collect()
    }

    /// A walk eastwards from a place at a speed, seen at some frames a second; the flock at its end.
    fn walked(from_x: f64, speed: f64, fps: f64, seconds: f64) -> Flock {
        let mut flock = Flock::new(Id(7), DVec2::ZERO, 30, 4.0, square(), 0.0);
        let at = |t: f64| DVec3::new(from_x + speed * t, 0.3, 2.65);
        for n in 0..(seconds * fps) as u32 {
            let (from, to) = (f64::from(n) / fps, f64::from(n + 1) / fps);
            flock.advance(from, to, &Notice { eyes: &[(at(from), at(to))], noises: &[] });
        }
        flock
    }

    #[test]
    fn birds_do_the_same_at_30_and_144_frames_a_second() {
        let (slow, fast) = (walked(-40.0, 1.4, 30.0, 40.0), walked(-40.0, 1.4, 144.0, 40.0));
        assert!(slow.frightened_s.is_some());
        for t in [38.0, 39.0, 40.0] {
            for (a, b) in slow.poses(t).zip(fast.poses(t)) {
                assert!((a.pos - b.pos).length() < 1e-6 && (a.heading - b.heading).abs() < 1e-6, "{a:?}\n{b:?}");
            }
        }
    }

    #[test]
    fn they_fly_up_before_a_walker_and_let_one_come_near_who_goes_softly() {
        let frights = |from_x: f64, speed: f64, seconds: f64| {
            let flock = walked(from_x, speed, 60.0, seconds);
            flock.birds.iter().map(|bird| bird.flights).sum::<u64>()
        };
        // Before the walker is among them nothing happens; a flock has no whims so early.
        assert_eq!(frights(-40.0, 1.4, 15.0), 0);
        let (walking, softly) = (frights(-14.0, 1.4, 14.0), frights(-14.0, 0.25, 56.0));
        assert!(walking >= 10 && softly * 2 < walking, "{walking} fly up before a walker, {softly} before one who goes softly");
    }

    #[test]
    fn they_come_down_apart_and_away_from_the_fright() {
        let mut flock = Flock::new(Id(7), DVec2::ZERO, 30, 4.0, square(), 0.0);
        flock.advance(0.0, 1.0, &Notice { eyes: &[], noises: &[(0.5, DVec2::new(3.0, 0.0))] });
        assert!(flock.birds.iter().all(|bird| bird.flights == 1), "a bell drives up all of them");
        assert!(flock.poses(5.0).filter(|pose| pose.pos.z > 4.0).count() > 25);
        flock.advance(1.0, 40.0, &Notice::default());
        let down: Vec<Pose> = flock.poses(40.0).collect();
        assert!(down.iter().all(|pose| (pose.pos.z - 1.0).abs() < 1e-6));
        let spots: Vec<DVec3> = flock.birds.iter().map(|bird| bird.stay.spot.pos).collect();
        for (n, spot) in spots.iter().enumerate() {
            assert!(spots[..n].iter().all(|other| other.distance(*spot) >= ELBOW_M));
        }
        let far = spots.iter().filter(|spot| spot.truncate().distance(DVec2::new(3.0, 0.0)) > 9.0).count();
        assert!(far > 12, "{far} of 30");
        let other = Flock::new(Id(8), DVec2::ZERO, 30, 4.0, square(), 0.0);
        assert!(other.poses(0.0).zip(flock.poses(0.0)).any(|(a, b)| a.pos != b.pos), "each flock has draws of its own");
    }

    #[test]
    fn a_jump_of_the_viewer_frightens_nobody_and_pauses_cost_little() {
        let mut flock = Flock::new(Id(7), DVec2::ZERO, 30, 4.0, square(), 0.0);
        let (far, among) = (DVec3::new(300.0, 0.0, 2.6), DVec3::new(1.0, 1.0, 2.65));
        flock.advance(0.0, 0.2, &Notice { eyes: &[(far, far)], noises: &[] });
        flock.advance(0.2, 0.4, &Notice { eyes: &[(among, among)], noises: &[] });
        let flown = flock.birds.iter().filter(|bird| bird.flights > 0).count();
        assert!(flown <= 3, "{flown} were within arm's reach");
        flock.advance(0.4, 1e6, &Notice { eyes: &[(among, among)], noises: &[] });
        assert!(flock.poses(1e6).all(|pose| pose.pos.is_finite()));
        assert!(Flock::new(Id(1), DVec2::ZERO, 9, 4.0, Vec::new(), 0.0).len() == 0, "where there is no room there are none");
    }
}
