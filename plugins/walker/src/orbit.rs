use bevy::math::DVec3;
use veduta_ecs::{Eye, Sights};

use crate::Intent;

/// Going round a point of the city that the eye looks at: drags turn, the wheel nears.
///
/// The eye stands on the line from the point against its gaze, before whatever stands in that line: so it is never below ground,
/// and never in a house. Where there is no room left before a wall, it does not turn that way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Orbit {
    /// The point, plan metres and elevation.
    pub focus: DVec3,
    now: Stand,
    goal: Stand,
}

/// Where the eye stands about the point.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stand {
    heading_deg: f64,
    pitch_deg: f64,
    /// As far off as is wished, and as there is room for.
    wished_m: f64,
    away_m: f64,
}

/// What can be looked at is no farther off than this, metres, and one goes no farther from it than this.
const REACH_M: f64 = 220.0;
const MOST_M: f64 = 300.0;
/// So near one comes, and so much room there has to be to turn somewhere; metres.
const LEAST_M: f64 = 1.5;
/// The eye keeps so far from what it has behind it, and from the ground below; metres.
const GAP_M: f64 = 0.5;
const OVER_GROUND_M: f64 = 1.0;
/// Pitches within which one goes round, degrees: from nearly straight above to looking up a tower.
const PITCH_DEG: (f64, f64) = (-85.0, 60.0);
/// Where the eye looks at nothing it looks down until it looks at something, in steps of so many degrees.
const DOWN_DEG: f64 = 4.0;
/// The eye follows what is wished at this rate, a second.
const RATE_HZ: f64 = 9.0;

/// The direction of a gaze.
fn gaze(heading_deg: f64, pitch_deg: f64) -> DVec3 {
    let (heading, pitch) = (heading_deg.to_radians(), pitch_deg.to_radians());
    DVec3::new(heading.sin() * pitch.cos(), heading.cos() * pitch.cos(), pitch.sin())
}

/// What stands about the point: asked for by the orbit, answered by the city or by a test.
pub(crate) trait Surroundings {
    /// How far a line of length 1 a metre is free.
    fn free_m(&self, from: DVec3, way: DVec3, reach_m: f64) -> f64;
    /// Whether a point lies in a house.
    fn is_solid(&self, at: DVec3) -> bool;
    /// Height of the ground, metres.
    fn ground_m(&self, at: DVec3) -> f64;
}

/// The city as it is known.
pub(crate) struct InCity<'a, 'w> {
    pub sights: &'a Sights<'w>,
    pub ground: &'a veduta_ecs::Ground<'w>,
}

impl Surroundings for InCity<'_, '_> {
    fn free_m(&self, from: DVec3, way: DVec3, reach_m: f64) -> f64 {
        self.sights.along(from, way, reach_m, from.z).map_or(f64::INFINITY, |met| met.along)
    }

    fn is_solid(&self, at: DVec3) -> bool {
        self.sights.is_in_a_house(at)
    }

    fn ground_m(&self, at: DVec3) -> f64 {
        self.ground.at(at.truncate(), at.z)
    }
}

impl Orbit {
    #[cfg(test)]
    pub fn about_for_test() -> Self {
        let stand = Stand { heading_deg: 0.0, pitch_deg: 0.0, wished_m: 10.0, away_m: 10.0 };
        Self { focus: DVec3::ZERO, now: stand, goal: stand }
    }

    /// Begins where the eye is, about what it looks at; looking into the sky, about the first thing below. `None` where there is nothing at all.
    pub fn begin(eye: &Eye, city: &impl Surroundings) -> Option<Self> {
        let from = eye.plan_pos.extend(eye.z_m());
        let mut pitch_deg = eye.pitch_deg.clamp(PITCH_DEG.0, PITCH_DEG.1);
        let away_m = loop {
            let free_m = city.free_m(from, gaze(eye.heading_deg, pitch_deg), REACH_M);
            if free_m <= REACH_M {
                break free_m;
            }
            if pitch_deg <= PITCH_DEG.0 {
                return None;
            }
            pitch_deg = (pitch_deg - DOWN_DEG).max(PITCH_DEG.0);
        };
        let focus = from + gaze(eye.heading_deg, pitch_deg) * away_m;
        let goal = Stand { heading_deg: eye.heading_deg, pitch_deg, wished_m: away_m.max(LEAST_M), away_m: away_m.max(LEAST_M) };
        // The head turns down to it, and does not leap.
        let now = Stand { pitch_deg: eye.pitch_deg, away_m, ..goal };
        Some(Self { focus, now, goal })
    }

    /// Turns and nears as is wished, as far as there is room.
    pub fn turn(&mut self, intent: &Intent, city: &impl Surroundings) {
        let Stand { heading_deg, pitch_deg, wished_m, .. } = self.goal;
        let wished_m = (wished_m * (-intent.near).exp()).clamp(LEAST_M, MOST_M);
        let (turned, tilted) = (heading_deg + intent.turn_deg, (pitch_deg + intent.tilt_deg).clamp(PITCH_DEG.0, PITCH_DEG.1));
        let ways = [(turned, tilted), (turned, pitch_deg), (heading_deg, tilted), (heading_deg, pitch_deg)];
        let open = ways.into_iter().find_map(|(heading_deg, pitch_deg)| {
            let room_m = self.room_m(heading_deg, pitch_deg, city);
            (room_m >= LEAST_M).then_some((heading_deg, pitch_deg, room_m))
        });
        if let Some((heading_deg, pitch_deg, room_m)) = open {
            self.goal = Stand { heading_deg, pitch_deg, wished_m, away_m: wished_m.min(room_m) };
        }
    }

    /// How far off there is room for an eye that looks so.
    fn room_m(&self, heading_deg: f64, pitch_deg: f64, city: &impl Surroundings) -> f64 {
        let back = -gaze(heading_deg, pitch_deg);
        // Off the wall, or the ground, that the point lies on.
        let from = self.focus + back * GAP_M;
        if city.is_solid(from) || from.z < city.ground_m(from) {
            return 0.0;
        }
        city.free_m(from, back, MOST_M).min(MOST_M)
    }

    /// Where the eye is after so many seconds; at once, where nothing is to glide.
    pub fn glide(&mut self, seconds: f64, at_once: bool, city: &impl Surroundings) -> (DVec3, f64, f64) {
        let share = if at_once { 1.0 } else { 1.0 - (-RATE_HZ * seconds).exp() };
        let Self { focus, now, goal } = self;
        now.heading_deg += (goal.heading_deg - now.heading_deg) * share;
        now.pitch_deg += (goal.pitch_deg - now.pitch_deg) * share;
        now.away_m += (goal.away_m - now.away_m) * share;
        let back = -gaze(now.heading_deg, now.pitch_deg);
        // What has come between is not looked through.
        let room_m = GAP_M + city.free_m(*focus + back * GAP_M, back, MOST_M);
        now.away_m = now.away_m.min((room_m - GAP_M).max(GAP_M));
        let mut at = *focus + back * now.away_m;
        let low = at;
        at.z = at.z.max(city.ground_m(at) + OVER_GROUND_M);
        // Held up by the ground, it looks down at the point all the same.
        let lifted = at.z > low.z;
        let flat_m = (*focus - at).truncate().length();
        let pitch_deg = if lifted { (focus.z - at.z).atan2(flat_m.max(1e-6)).to_degrees() } else { now.pitch_deg };
        (at, now.heading_deg.rem_euclid(360.0), pitch_deg)
    }
}

#[cfg(test)]
mod tests {
    use bevy::math::DVec2;

    use super::*;

    /// Level ground, and a house from x = 10 to 20 as long and as high as is told.
    struct House {
        half_m: f64,
        high_m: f64,
    }

    impl House {
        fn holds(&self, p: DVec3) -> bool {
            (10.0..20.0).contains(&p.x) && p.y.abs() < self.half_m && p.z < self.high_m
        }
    }

    impl Surroundings for House {
        fn free_m(&self, from: DVec3, way: DVec3, reach_m: f64) -> f64 {
            let steps = (0..(reach_m * 50.0) as u32).map(|n| f64::from(n) / 50.0);
            let mut met = steps.filter(|t| (from + way * *t).z < 0.0 || self.holds(from + way * *t));
            met.next().unwrap_or(f64::INFINITY)
        }

        fn is_solid(&self, at: DVec3) -> bool {
            self.holds(at)
        }

        fn ground_m(&self, _: DVec3) -> f64 {
            0.0
        }
    }

    const TOWN: House = House { half_m: 30.0, high_m: 12.0 };

    fn eye(heading_deg: f64, pitch_deg: f64) -> Eye {
        Eye { plan_pos: DVec2::ZERO, heading_deg, pitch_deg, ..Eye::default() }
    }

    #[test]
    fn it_begins_where_the_eye_is_about_what_it_looks_at() {
        let eye = eye(90.0, 10.0);
        let mut orbit = Orbit::begin(&eye, &TOWN).expect("a wall");
        assert!((orbit.focus.x - 10.0).abs() < 0.1 && orbit.focus.z > 3.0, "{orbit:?}");
        let (at, heading_deg, pitch_deg) = orbit.glide(0.1, false, &TOWN);
        assert!(at.distance(DVec3::new(0.0, 0.0, eye.z_m())) < 0.01 && heading_deg == 90.0 && pitch_deg == 10.0, "{at}");
    }

    #[test]
    fn who_looks_into_the_sky_is_led_down_to_something() {
        let looks_up = eye(270.0, 40.0);
        let mut orbit = Orbit::begin(&looks_up, &TOWN).expect("the ground");
        let mut before = looks_up.plan_pos.extend(looks_up.z_m());
        let mut last = 0.0;
        for n in 0..120 {
            let (at, _, pitch_deg) = orbit.glide(1.0 / 60.0, false, &TOWN);
            assert!(n == 0 || at.distance(before) < 25.0, "it glides: {at} after {before}");
            (before, last) = (at, pitch_deg);
        }
        assert!(last < 0.0 && before.distance(DVec3::new(0.0, 0.0, 1.65)) < 1.0, "in the end it stands where it stood: {before}");
        let nothing = House { half_m: 0.0, high_m: 0.0 };
        assert!(
            Orbit::begin(&Eye { eye_m: 900.0, ..eye(0.0, 0.0) }, &nothing).is_none(),
            "higher than it reaches there is nothing"
        );
    }

    #[test]
    fn it_is_never_below_ground_nor_in_the_house() {
        let mut orbit = Orbit::begin(&eye(90.0, 10.0), &TOWN).expect("a wall");
        let mut least_m = f64::INFINITY;
        for n in 0_u32..4_000 {
            let (turn_deg, tilt_deg) = (if n % 900 < 450 { 2.0 } else { -2.0 }, if n % 700 < 350 { 1.5 } else { -1.5 });
            let near = if n % 500 < 250 { -0.03 } else { 0.03 };
            orbit.turn(&Intent { turn_deg, tilt_deg, near, ..Intent::default() }, &TOWN);
            let (at, _, _) = orbit.glide(1.0 / 30.0, false, &TOWN);
            assert!(!TOWN.holds(at), "in the house at {at}, frame {n}");
            assert!(at.z >= OVER_GROUND_M, "below ground at {at}, frame {n}");
            assert!(at.distance(orbit.focus) <= MOST_M + 2.0, "into nothing at {at}");
            least_m = least_m.min(at.distance(orbit.focus));
        }
        assert!(least_m < 4.0, "it does come near: {least_m}");
    }

    #[test]
    fn it_goes_all_round_a_thing_that_stands_free() {
        let statue = House { half_m: 0.6, high_m: 4.0 };
        let mut orbit = Orbit::begin(&eye(90.0, 4.0), &statue).expect("a wall");
        // From above nothing stands in the way.
        for _ in 0..60 {
            orbit.turn(&Intent { tilt_deg: -1.5, ..Intent::default() }, &statue);
        }
        for _ in 0..180 {
            orbit.turn(&Intent { turn_deg: 2.0, ..Intent::default() }, &statue);
            orbit.glide(0.05, false, &statue);
        }
        assert!((orbit.goal.heading_deg - 450.0).abs() < 1e-6, "{orbit:?}");
    }
}
