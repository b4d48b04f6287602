//! The eye on what moves.

use std::collections::BTreeMap;

use glam::{DVec3, swizzles::Vec3Swizzles};
use veduta_city::{LookAt, Step};

use crate::{
    CompiledTour, Pose, TURN_DEG_S,
    pose::{Facing, smoothstep, turn_deg},
};

/// How fast the view comes after what moves: the rate of a critically damped spring, 1/s.
const RATE: f64 = 4.0;
/// The spring pulls no harder than from so far off, degrees: with it the view comes after at [`TURN_DEG_S`] at most.
const PULL_DEG: f64 = 2.0 * TURN_DEG_S / RATE;
/// The spring's own steps a second, so that what it does does not depend on the frames that are shown.
const STEPS_S: f64 = 240.0;
/// A longer frame counts as one of this length, seconds.
const LONGEST_S: f64 = 0.25;
/// What comes nearer than this to the eye, metres, is followed less, and hardly from half as near: it would turn it about.
const NEAR_M: f64 = 3.0;

/// What a tour follows at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Followed<'a> {
    /// Its name.
    pub name: &'a str,
    /// How far the view has turned there, 0 to 1.
    pub share: f64,
}

impl CompiledTour {
    /// What the eye follows at a moment.
    #[must_use]
    pub fn followed(&self, t_s: f64) -> Option<Followed<'_>> {
        let (step, share) = self.timeline.followed(t_s.clamp(0.0, self.duration_s()))?;
        Some(Followed { name: self.subjects.get(&step)?, share })
    }
}

/// What steps follow, by their index.
pub(crate) fn subjects(steps: &[Step]) -> BTreeMap<usize, String> {
    let follows = |(i, step): (usize, &Step)| match step.look() {
        Some(LookAt::Spot { follow: Some(name), .. }) => Some((i, name.clone())),
        _ => None,
    };
    steps.iter().enumerate().filter_map(follows).collect()
}

/// Leads a tour's view to what moves, and back when it is gone: how far off the tour's own view it is, and how fast that grows.
///
/// Positions stay the tour's own. The view is led at [`TURN_DEG_S`] at most, beside what the tour itself turns.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Follow {
    heading: Spring,
    pitch: Spring,
}

#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Spring {
    at: f64,
    speed: f64,
}

impl Spring {
    /// So many seconds on, at most one of the steps.
    fn pull(&mut self, to: f64, seconds: f64) {
        let away = (self.at - to).clamp(-PULL_DEG, PULL_DEG);
        let (rest, fall) = (self.at - away, libm::exp(-RATE * seconds));
        let gain = self.speed + RATE * away;
        self.at = rest + (away + gain * seconds) * fall;
        self.speed = (self.speed - RATE * gain * seconds) * fall;
    }
}

impl Follow {
    /// A pose of the tour, with the view led to what is followed, so many seconds after the last one. `to` is where that is from the eye,
    /// metres east, north and up, and the share of the turn that is done; nothing while it is not about.
    #[must_use]
    pub fn lead(&mut self, pose: Pose, to: Option<(DVec3, f64)>, seconds: f64) -> Pose {
        let wanted = wanted(&pose, to);
        let seconds = if seconds > 0.0 { seconds.min(LONGEST_S) } else { 0.0 };
        let steps = libm::ceil(seconds * STEPS_S);
        for _ in 0..steps as u32 {
            self.heading.pull(wanted.heading, seconds / steps);
            self.pitch.pull(wanted.pitch, seconds / steps);
        }
        self.led(pose)
    }

    /// The same at once: where nobody sees the view jump, behind a fade.
    #[must_use]
    pub fn leap(&mut self, pose: Pose, to: Option<(DVec3, f64)>) -> Pose {
        let Facing { heading, pitch } = wanted(&pose, to);
        *self = Self { heading: Spring { at: heading, speed: 0.0 }, pitch: Spring { at: pitch, speed: 0.0 } };
        self.led(pose)
    }

    fn led(&self, pose: Pose) -> Pose {
        Pose {
            heading_deg: (pose.heading_deg + self.heading.at).rem_euclid(360.0),
            pitch_deg: (pose.pitch_deg + self.pitch.at).clamp(-90.0, 90.0),
            ..pose
        }
    }
}

/// How far off the tour's own view the view is to be.
fn wanted(pose: &Pose, to: Option<(DVec3, f64)>) -> Facing {
    let Some((away, share)) = to.filter(|(away, share)| away.is_finite() && share.is_finite()) else { return Facing::default() };
    let own = pose.facing();
    let there = Facing::along(away, own);
    let share = share.clamp(0.0, 1.0) * smoothstep(2.0 * away.xy().length() / NEAR_M - 1.0);
    Facing { heading: turn_deg(own.heading, there.heading) * share, pitch: (there.pitch - own.pitch) * share }
}

#[cfg(test)]
mod tests {
    use veduta_city::{Tour, file};

    use super::*;
    use crate::{Gazetteer, StreetNet, compile};

    fn tour(steps: &str) -> CompiledTour {
        let tour: Tour = file::parse(&format!("(title: \"t\", city: \"\", steps: [{steps}])"), "t").expect("a tour");
        compile(&tour, &StreetNet::new(&[]), &Gazetteer::default()).expect("it can be played")
    }

    /// A cart that goes by from west to east, 20 m north of the eye.
    fn cart(t: f64) -> DVec3 {
        DVec3::new(4.0 * t - 40.0, 20.0, -0.5)
    }

    /// The view of each frame of so many seconds.
    fn watched(hz: f64, seconds: f64) -> Vec<Pose> {
        let (mut follow, north) = (Follow::default(), Pose::default());
        (1..=(seconds * hz) as u32).map(|n| follow.lead(north, Some((cart(f64::from(n) / hz), 1.0)), 1.0 / hz)).collect()
    }

    #[test]
    fn the_eye_comes_after_what_moves_and_turns_no_faster_than_it_may() {
        let views = watched(240.0, 20.0);
        let off = |n: usize| turn_deg(views[n].heading_deg, Facing::along(cart((n + 1) as f64 / 240.0), Facing::default()).heading);
        // By the half second that a spring of this rate lags behind.
        assert!(
            (480..views.len()).all(|n| off(n).abs() < 8.0),
            "{:?}",
            (480..views.len()).map(off).fold(0.0, |a: f64, b| a.max(b.abs()))
        );
        let turns: Vec<f64> = views.windows(2).map(|w| turn_deg(w[0].heading_deg, w[1].heading_deg) * 240.0).collect();
        assert!(turns.iter().all(|turn| turn.abs() <= TURN_DEG_S), "{:?}", turns.iter().fold(0.0, |a: f64, b| a.max(b.abs())));
        assert!(turns.iter().any(|turn| turn.abs() > 20.0), "it sets out towards the cart");
        assert!(turns.windows(2).all(|w| (w[1] - w[0]).abs() * 240.0 <= RATE * RATE * PULL_DEG * 1.01), "no jerk");
    }

    #[test]
    fn it_does_the_same_at_30_and_144_frames_a_second() {
        let (slow, fast) = (watched(30.0, 10.0), watched(144.0, 10.0));
        for second in 1..=10 {
            let (a, b) = (slow[second * 30 - 1], fast[second * 144 - 1]);
            let away = turn_deg(a.heading_deg, b.heading_deg).abs().max((a.pitch_deg - b.pitch_deg).abs());
            assert!(away < 0.6, "{second} s: {away}°");
        }
    }

    #[test]
    fn what_is_gone_is_left_and_what_comes_too_near_does_not_turn_one_about() {
        let (mut follow, own) = (Follow::default(), Pose { heading_deg: 350.0, ..Pose::default() });
        let east = Some((DVec3::new(10.0, 0.0, 0.0), 1.0));
        let there = (0..600).map(|_| follow.lead(own, east, 0.01)).last().expect("a pose");
        assert!(turn_deg(there.heading_deg, 90.0).abs() < 0.01, "{there:?}");
        let back = (0..600).map(|_| follow.lead(own, None, 0.01)).last().expect("a pose");
        assert!(turn_deg(back.heading_deg, 350.0).abs() < 0.01, "{back:?}");
        assert_eq!(follow.leap(own, Some((DVec3::new(1.0, 0.0, 0.0), 1.0))), own, "it stands before one's nose");
        assert!(turn_deg(follow.leap(own, east).heading_deg, 90.0).abs() < 1e-9, "at once");
        for bad in [DVec3::NAN, DVec3::splat(f64::INFINITY)] {
            assert_eq!(follow.leap(own, Some((bad, 1.0))), own);
        }
    }

    #[test]
    fn a_tour_says_what_it_follows_and_when() {
        let tour = tour(
            r#"Start(at: At(0, 0)), Look(at: Spot(at: At(0, 50), follow: "cart"), seconds: 2), Wait(seconds: 3),
               Look(at: Heading(deg: 90), seconds: 2), Track(keys: [(2, 5, 0, 1.65, 90, 0)]),
               Cut(to: At(9, 9), look: Spot(at: At(50, 9), follow: "tram")), Wait(seconds: 1), Track(keys: [(2, 5, 0, 1.65, 90, 0)])"#,
        );
        let when = |index: usize| tour.steps().iter().find(|span| span.index == index).expect("it is played");
        assert_eq!(tour.followed(0.1), None);
        let turning = tour.followed((when(1).start_s + when(1).end_s) / 2.0).expect("it turns");
        assert!(turning.name == "cart" && (0.3..0.7).contains(&turning.share), "{turning:?}");
        assert_eq!(tour.followed(when(2).end_s - 0.1), Some(Followed { name: "cart", share: 1.0 }), "it stays with it");
        assert_eq!(tour.followed(when(3).end_s), None);
        assert_eq!(tour.followed(when(6).start_s + 0.1), Some(Followed { name: "tram", share: 1.0 }));
        assert_eq!(tour.followed(when(7).end_s - 0.1), None, "a track says itself where it looks");
    }
}
