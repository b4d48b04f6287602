use bevy::math::DVec3;
use veduta_city::GridPos;
use veduta_ecs::{Eye, Ground, Sights, house_key};

use crate::Intent;

/// Going round a point of the city that the eye looks at: drags turn, the wheel nears.
///
/// The eye stands on the line from the point against its gaze, between the house that the point is on and whatever else stands in that
/// line: so it goes round what stands free, is never below ground, and never in a house. Where there is no room it does not turn that way, and
/// where there is less than it has it first draws in, or out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Orbit {
    /// The point, plan metres and elevation.
    focus: DVec3,
    /// The house that it is on.
    own: Option<GridPos>,
    /// How far off one wants to be, metres.
    wished_m: f64,
    /// So much higher than at the point the eye still looks, degrees.
    above_deg: f64,
    now: Stand,
    goal: Stand,
}

/// Where the eye stands about the point.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stand {
    heading_deg: f64,
    pitch_deg: f64,
    away_m: f64,
}

/// What can be looked at is no farther off than this, metres, and one goes no farther from it than this.
const REACH_M: f64 = 220.0;
const MOST_M: f64 = 300.0;
/// So near one comes, and so much room there has to be to stand somewhere; metres.
const LEAST_M: f64 = 1.5;
/// The eye keeps so far from what is before and behind it, and from the ground below; metres.
const GAP_M: f64 = 0.5;
/// The eye keeps so far from what it goes past, metres: lines that graze a wall are free.
const BESIDE_M: f64 = 0.2;
const OVER_GROUND_M: f64 = 1.0;
/// Pitches within which one goes round, degrees: from nearly straight above to looking up a tower.
const PITCH_DEG: (f64, f64) = (-85.0, 60.0);
/// Where the eye looks at nothing it looks down until it looks at something, in steps of so many degrees.
const DOWN_DEG: f64 = 4.0;
/// The eye follows what is wished at this rate, a second.
const RATE_HZ: f64 = 9.0;
/// It is no farther behind than this, degrees, and goes in or out no faster than by this share of its distance, a second.
const LEAD_DEG: f64 = 25.0;
const DRAWS_HZ: f64 = 4.0;

/// The direction of a gaze.
fn gaze(heading_deg: f64, pitch_deg: f64) -> DVec3 {
    let (heading, pitch) = (heading_deg.to_radians(), pitch_deg.to_radians());
    DVec3::new(heading.sin() * pitch.cos(), heading.cos() * pitch.cos(), pitch.sin())
}

/// What stands about the point: asked for by the orbit, answered by the city or by a test.
pub(crate) trait Surroundings {
    /// What a line of length 1 a metre meets: how far off, and what house it is.
    fn meet(&self, from: DVec3, way: DVec3, reach_m: f64) -> Option<(f64, Option<GridPos>)>;
    /// From where on, and up to where, such a line is free that may lead out of one house.
    fn room_m(&self, from: DVec3, way: DVec3, own: Option<GridPos>) -> (f64, f64);
    /// Height of the ground, metres.
    fn ground_m(&self, at: DVec3) -> f64;
    /// Whether an eye can be there: in no house, nor so near a wall beside it that it is seen through.
    fn is_free(&self, at: DVec3) -> bool;
}

/// The city as it is known.
pub(crate) struct InCity<'a, 'w> {
    pub sights: &'a Sights<'w>,
    pub ground: &'a Ground<'w>,
}

impl Surroundings for InCity<'_, '_> {
    fn meet(&self, from: DVec3, way: DVec3, reach_m: f64) -> Option<(f64, Option<GridPos>)> {
        self.sights.along(from, way, reach_m, from.z).map(|met| (met.along, met.house.and_then(house_key)))
    }

    fn room_m(&self, from: DVec3, way: DVec3, own: Option<GridPos>) -> (f64, f64) {
        self.sights.room(from, way, MOST_M, own)
    }

    fn ground_m(&self, at: DVec3) -> f64 {
        self.ground.at(at.truncate(), at.z)
    }

    fn is_free(&self, at: DVec3) -> bool {
        self.sights.is_free(at, BESIDE_M)
    }
}

impl Orbit {
    #[cfg(test)]
    pub fn about_for_test() -> Self {
        let stand = Stand { heading_deg: 0.0, pitch_deg: 0.0, away_m: 10.0 };
        Self { focus: DVec3::ZERO, own: None, wished_m: 10.0, above_deg: 0.0, now: stand, goal: stand }
    }

    /// Begins where the eye is, about what it looks at; looking into the sky, about the first thing below. `None` where there is nothing at all.
    pub fn begin(eye: &Eye, city: &impl Surroundings) -> Option<Self> {
        let from = eye.plan_pos.extend(eye.z_m());
        let mut pitch_deg = eye.pitch_deg.clamp(PITCH_DEG.0, PITCH_DEG.1);
        let (away_m, own) = loop {
            if let Some(met) = city.meet(from, gaze(eye.heading_deg, pitch_deg), REACH_M).filter(|(away_m, _)| *away_m <= REACH_M) {
                break met;
            }
            if pitch_deg <= PITCH_DEG.0 {
                return None;
            }
            pitch_deg = (pitch_deg - DOWN_DEG).max(PITCH_DEG.0);
        };
        let focus = from + gaze(eye.heading_deg, pitch_deg) * away_m;
        // The eye stays where it is, and the head turns down to the point without a leap.
        let stand = Stand { heading_deg: eye.heading_deg, pitch_deg, away_m };
        Some(Self { focus, own, wished_m: away_m.max(LEAST_M), above_deg: eye.pitch_deg - pitch_deg, now: stand, goal: stand })
    }

    /// Turns and nears as is wished, as far as there is room.
    pub fn turn(&mut self, intent: &Intent, city: &impl Surroundings) {
        let Stand { heading_deg, pitch_deg, .. } = self.goal;
        self.wished_m = (self.wished_m * (-intent.near).exp()).clamp(LEAST_M, MOST_M);
        // The eye is not left far behind.
        let lead = |goal: f64, by: f64, now: f64| if (goal + by - now).abs() < LEAD_DEG { goal + by } else { goal };
        let turned = lead(heading_deg, intent.turn_deg, self.now.heading_deg);
        let tilted = lead(pitch_deg, intent.tilt_deg, self.now.pitch_deg).clamp(PITCH_DEG.0, PITCH_DEG.1);
        let ways = [(turned, tilted), (turned, pitch_deg), (heading_deg, tilted), (heading_deg, pitch_deg)];
        let open = ways.into_iter().find_map(|(heading_deg, pitch_deg)| {
            let (least_m, most_m) = self.room_m(heading_deg, pitch_deg, city)?;
            Some(Stand { heading_deg, pitch_deg, away_m: self.wished_m.clamp(least_m, most_m) })
        });
        self.goal = open.unwrap_or(self.goal);
    }

    /// How near and how far off an eye that looks so can stand; `None` where it cannot.
    fn room_m(&self, heading_deg: f64, pitch_deg: f64, city: &impl Surroundings) -> Option<(f64, f64)> {
        let back = -gaze(heading_deg, pitch_deg);
        // Off the wall, or the ground, that the point lies on.
        let (least_m, most_m) = city.room_m(self.focus + back * GAP_M, back, self.own);
        (most_m - least_m >= LEAST_M).then_some((least_m + 2.0 * GAP_M, most_m.min(MOST_M)))
    }

    /// Where the eye is after so many seconds, and where it looks; at once, where nothing is to glide.
    pub fn glide(&mut self, seconds: f64, at_once: bool, city: &impl Surroundings) -> (DVec3, f64, f64) {
        let share = if at_once { 1.0 } else { 1.0 - (-RATE_HZ * seconds).exp() };
        let toward = |now: f64, goal: f64| now + (goal - now) * share;
        let (now, goal) = (self.now, self.goal);
        let was_free = city.is_free(self.stand(city).0);
        self.above_deg = toward(self.above_deg, 0.0);
        let next = (toward(now.heading_deg, goal.heading_deg), toward(now.pitch_deg, goal.pitch_deg));
        let here = self.room_m(now.heading_deg, now.pitch_deg, city).unwrap_or((now.away_m, now.away_m));
        match self.room_m(next.0, next.1, city) {
            Some((least_m, most_m)) => {
                // Out or in first, as far as there is room here; then round.
                let step_m = if at_once { f64::INFINITY } else { (now.away_m + LEAST_M) * DRAWS_HZ * seconds };
                let drawn = toward(now.away_m, goal.away_m.clamp(least_m, most_m)).clamp(now.away_m - step_m, now.away_m + step_m);
                let away_m = drawn.clamp(here.0.min(now.away_m), here.1.max(now.away_m));
                self.now.away_m = away_m;
                if (least_m - 1e-3..=most_m + 1e-3).contains(&away_m) || at_once {
                    (self.now.heading_deg, self.now.pitch_deg) = next;
                    self.now.away_m = away_m.clamp(least_m, most_m);
                } else if (away_m - now.away_m).abs() < 1e-4 {
                    // It cannot get by.
                    (self.goal.heading_deg, self.goal.pitch_deg) = (now.heading_deg, now.pitch_deg);
                }
            }
            None => (self.goal.heading_deg, self.goal.pitch_deg) = (now.heading_deg, now.pitch_deg),
        }
        // Where a wall stands close beside the line it goes no farther.
        if was_free && !city.is_free(self.stand(city).0) {
            (self.now, self.goal) = (now, now);
        }
        self.stand(city)
    }

    /// The eye's place, heading and pitch.
    fn stand(&self, city: &impl Surroundings) -> (DVec3, f64, f64) {
        let Stand { heading_deg, pitch_deg, away_m } = self.now;
        let mut at = self.focus - gaze(heading_deg, pitch_deg) * away_m;
        let lowest_m = city.ground_m(at) + OVER_GROUND_M;
        if at.z >= lowest_m {
            return (at, heading_deg.rem_euclid(360.0), pitch_deg + self.above_deg);
        }
        // Held up by the ground, it looks down at the point all the same.
        at.z = lowest_m;
        let flat_m = (self.focus - at).truncate().length();
        (at, heading_deg.rem_euclid(360.0), (self.focus.z - at.z).atan2(flat_m.max(1e-6)).to_degrees() + self.above_deg)
    }
}

#[cfg(test)]
mod tests {
    use bevy::math::DVec2;

    use super::*;

    /// Level ground, and a house from x = 10 to 20, as long and as high as is told, with another behind it or not.
    struct Town {
        half_m: f64,
        high_m: f64,
        has_neighbour: bool,
    }

    const OWN: Option<GridPos> = Some(GridPos(1, 1));

    impl Town {
        fn own(&self, p: DVec3) -> bool {
            (10.0..20.0).contains(&p.x) && p.y.abs() < self.half_m && p.z < self.high_m
        }

        fn other(&self, p: DVec3) -> bool {
            self.has_neighbour && (20.0..40.0).contains(&p.x) && p.y.abs() < 60.0 && p.z < 15.0
        }

        fn steps(reach_m: f64) -> impl DoubleEndedIterator<Item = f64> {
            (1..(reach_m * 40.0) as u32).map(|n| f64::from(n) / 40.0)
        }
    }

    impl Surroundings for Town {
        fn meet(&self, from: DVec3, way: DVec3, reach_m: f64) -> Option<(f64, Option<GridPos>)> {
            let p = |t: f64| from + way * t;
            let t = Self::steps(reach_m).find(|t| p(*t).z < 0.0 || self.own(p(*t)) || self.other(p(*t)))?;
            Some((t, OWN.filter(|_| self.own(p(t)))))
        }

        fn room_m(&self, from: DVec3, way: DVec3, own: Option<GridPos>) -> (f64, f64) {
            let p = |t: f64| from + way * t;
            let blocks = |p: DVec3| p.z < 0.0 || self.other(p) || own.is_none() && self.own(p);
            if blocks(from) {
                return (0.0, 0.0);
            }
            let most = Self::steps(MOST_M).find(|t| blocks(p(*t))).unwrap_or(MOST_M);
            let least = Self::steps(60.0).rev().find(|t| own.is_some() && self.own(p(*t))).unwrap_or(0.0);
            (least, most)
        }

        fn ground_m(&self, _: DVec3) -> f64 {
            0.0
        }

        fn is_free(&self, at: DVec3) -> bool {
            !(self.own(at) || self.other(at))
        }
    }

    const TOWN: Town = Town { half_m: 30.0, high_m: 12.0, has_neighbour: true };

    fn eye(heading_deg: f64, pitch_deg: f64) -> Eye {
        Eye { plan_pos: DVec2::ZERO, heading_deg, pitch_deg, ..Eye::default() }
    }

    #[test]
    fn it_begins_where_the_eye_is_about_what_it_looks_at() {
        let eye = eye(90.0, 10.0);
        let mut orbit = Orbit::begin(&eye, &TOWN).expect("a wall");
        assert!((orbit.focus.x - 10.0).abs() < 0.1 && orbit.focus.z > 3.0 && orbit.own == OWN, "{orbit:?}");
        let (at, heading_deg, pitch_deg) = orbit.glide(0.1, false, &TOWN);
        assert!(at.distance(DVec3::new(0.0, 0.0, eye.z_m())) < 0.01 && heading_deg == 90.0 && pitch_deg == 10.0, "{at}");
    }

    #[test]
    fn who_looks_into_the_sky_examines_what_lies_below() {
        let mut orbit = Orbit::begin(&eye(270.0, 40.0), &TOWN).expect("the ground");
        let mut before_deg = 40.0;
        for _ in 0..90 {
            let (at, _, pitch_deg) = orbit.glide(1.0 / 60.0, false, &TOWN);
            assert!(at.distance(DVec3::new(0.0, 0.0, 1.65)) < 0.01, "it stands where it stood: {at}");
            assert!((pitch_deg - before_deg).abs() < 8.0, "the head turns: {pitch_deg} after {before_deg}");
            before_deg = pitch_deg;
        }
        assert!(before_deg < 0.0, "it looks down: {before_deg}");
        let nothing = Town { half_m: 0.0, high_m: 0.0, has_neighbour: false };
        assert!(
            Orbit::begin(&Eye { eye_m: 900.0, ..eye(0.0, 0.0) }, &nothing).is_none(),
            "higher than it reaches there is nothing"
        );
    }

    /// Goes about at a rate a frame, and back; every step is held to what holds always.
    fn wander(orbit: &mut Orbit, town: &Town, frames: u32) {
        let mut before = orbit.stand(town).0;
        for n in 0..frames {
            let (turn_deg, tilt_deg) = (if n % 900 < 450 { 2.0 } else { -2.0 }, if n % 700 < 350 { 1.5 } else { -1.5 });
            let near = if n % 500 < 250 { -0.02 } else { 0.02 };
            orbit.turn(&Intent { turn_deg, tilt_deg, near, ..Intent::default() }, town);
            let (at, _, _) = orbit.glide(1.0 / 30.0, false, town);
            assert!(!town.own(at) && !town.other(at), "in a house at {at}, frame {n}");
            assert!(at.z >= OVER_GROUND_M, "below ground at {at}, frame {n}");
            let away_m = at.distance(orbit.focus);
            assert!(away_m <= MOST_M + 2.0, "into nothing at {at}");
            assert!(at.distance(before) < 0.5 + away_m * 0.3, "the head leaps from {before} to {at}, frame {n}");
            before = at;
        }
    }

    #[test]
    fn it_is_never_below_ground_nor_in_a_house_and_never_leaps() {
        let mut orbit = Orbit::begin(&eye(90.0, 10.0), &TOWN).expect("a wall");
        wander(&mut orbit, &TOWN, 1_500);
        let statue = Town { half_m: 0.6, high_m: 4.0, has_neighbour: false };
        let mut orbit = Orbit::begin(&eye(90.0, 4.0), &statue).expect("a wall");
        wander(&mut orbit, &statue, 1_500);
    }

    #[test]
    fn it_goes_all_round_what_stands_free_and_along_a_row_only_as_far_as_there_is_room() {
        let round = |town: &Town| {
            let mut orbit = Orbit::begin(&eye(90.0, 4.0), town).expect("a wall");
            for _ in 0..400 {
                orbit.turn(&Intent { turn_deg: 1.0, ..Intent::default() }, town);
                orbit.glide(0.05, false, town);
            }
            orbit.now.heading_deg
        };
        let free = Town { half_m: 5.0, high_m: 8.0, has_neighbour: false };
        assert!(round(&free) > 440.0, "{}", round(&free));
        let row = Town { half_m: 60.0, ..TOWN };
        assert!(round(&row) < 185.0, "{}", round(&row));
    }
}
