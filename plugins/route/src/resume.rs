//! Back onto the tour after wandering off.

use crate::{
    CompiledTour, FreeLine, Pose, StreetNet, Walk,
    compile::hour_on,
    error::WALK_EYE_M,
    pose::{smoothstep, turn_deg},
    walk::HERE_M,
};

/// Longest way that is walked back, in metres; from further off the view fades.
pub const WALK_BACK_M: f64 = 40.0;
/// Speed of walking back, metres a second.
const SPEED: f64 = 1.8;
/// Fade out and in together, in seconds, and how long it stays dark between.
const FADE_S: f64 = 1.6;
const DARK_S: f64 = 0.1;
/// In so many seconds the tour comes up to its own speed again.
const TAIL_S: f64 = 1.2;
/// Poses kept of that, a second.
const TAIL_HZ: f64 = 240.0;

/// The way from where the visitor is back onto the tour: a short walk or a fade, and then the tour itself, coming up to
/// speed, so that nothing jumps at the joint.
#[derive(Debug, Clone)]
pub struct ResumeLeg {
    from: Pose,
    to: Pose,
    /// The walk back; without one the view fades.
    walk: Option<Walk>,
    back_s: f64,
    tail: Vec<Pose>,
    resumes_at_s: f64,
}

/// The leg from a visitor's pose onto the tour at a time. Walks along streets up to [`WALK_BACK_M`] if both are near the
/// ground; otherwise the view fades. A pose that is not finite counts as being on the tour already.
#[must_use]
pub fn resume(compiled: &CompiledTour, net: &StreetNet, from: Pose, t_s: f64) -> ResumeLeg {
    leg(compiled, net, from, t_s, None)
}

/// As [`resume`], walking straight only where `free` says that nothing stands in the way.
#[must_use]
pub fn resume_with(compiled: &CompiledTour, net: &StreetNet, from: Pose, t_s: f64, free: FreeLine<'_>) -> ResumeLeg {
    leg(compiled, net, from, t_s, Some(free))
}

fn leg(compiled: &CompiledTour, net: &StreetNet, from: Pose, t_s: f64, free: Option<FreeLine<'_>>) -> ResumeLeg {
    let t_s = if t_s > 0.0 { t_s.min(compiled.duration_s()) } else { 0.0 };
    let to = compiled.pose(t_s);
    let from = if from.is_finite() { from } else { to };
    let walk = walk_back(net, &from, &to, free);
    let back_s = walk.as_ref().map_or(FADE_S, Walk::duration_s);
    let tail_at = |i: u32| compiled.pose(t_s + tail_time(f64::from(i) / TAIL_HZ));
    let tail = (0..=libm::ceil(TAIL_S * TAIL_HZ) as u32).map(tail_at).collect();
    let resumes_at_s = (t_s + TAIL_S / 2.0).min(compiled.duration_s());
    ResumeLeg { from, to, walk, back_s, tail, resumes_at_s }
}

/// How far the tour has come while it comes up to speed, in seconds: the integral of a smooth step.
fn tail_time(t: f64) -> f64 {
    let x = (t / TAIL_S).clamp(0.0, 1.0);
    TAIL_S * (x * x * x - x * x * x * x / 2.0)
}

fn walk_back(net: &StreetNet, from: &Pose, to: &Pose, free: Option<FreeLine<'_>>) -> Option<Walk> {
    let sets_out = from.at().distance(to.at()) > HERE_M;
    if sets_out && (from.eye_m.max(to.eye_m) > WALK_EYE_M || from.plan_pos.distance(to.plan_pos) > WALK_BACK_M) {
        return None;
    }
    let walk = Walk::new(net, *from, *to, SPEED, free).ok()?;
    let is_blocked = free.is_some_and(|free| walk.way().len() == 2 && !free(from.plan_pos, to.plan_pos));
    (!is_blocked && walk.length_m() <= WALK_BACK_M).then_some(walk)
}

impl ResumeLeg {
    /// Length of the leg in seconds.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.back_s + TAIL_S
    }

    /// The tour's time at the leg's end: play on from here.
    #[must_use]
    pub fn resumes_at_s(&self) -> f64 {
        self.resumes_at_s
    }

    /// Whether the visitor walks back; otherwise the view fades.
    #[must_use]
    pub fn is_walk(&self) -> bool {
        self.walk.is_some()
    }

    /// The pose so many seconds into the leg; clamps.
    #[must_use]
    pub fn pose(&self, dt_s: f64) -> Pose {
        let dt = if dt_s > 0.0 { dt_s } else { 0.0 };
        if dt >= self.back_s {
            return self.tail_pose(dt - self.back_s);
        }
        match &self.walk {
            Some(walk) => walk.pose(dt),
            None => self.faded(dt),
        }
    }

    fn faded(&self, dt: f64) -> Pose {
        let ramp = (FADE_S - DARK_S) / 2.0;
        if dt < FADE_S / 2.0 {
            let fade = self.from.fade + (1.0 - self.from.fade) * smoothstep(dt / ramp);
            return Pose { fade, ..self.from };
        }
        let fade = 1.0 + (self.to.fade - 1.0) * smoothstep((dt - ramp - DARK_S) / ramp);
        Pose { fade, ..self.to }
    }

    fn tail_pose(&self, t: f64) -> Pose {
        let place = (t * TAIL_HZ).max(0.0);
        let last = self.tail.len().saturating_sub(1);
        let index = (libm::floor(place) as usize).min(last);
        let (Some(a), Some(b)) = (self.tail.get(index), self.tail.get((index + 1).min(last))) else { return self.to };
        let x = (place - index as f64).clamp(0.0, 1.0);
        let between = |a: f64, b: f64| a + (b - a) * x;
        if a.plan_pos.distance(b.plan_pos) > 1.0 {
            // A cut lies between.
            return if x < 0.5 { *a } else { *b };
        }
        Pose {
            plan_pos: a.plan_pos.lerp(b.plan_pos, x),
            eye_m: between(a.eye_m, b.eye_m),
            heading_deg: (a.heading_deg + turn_deg(a.heading_deg, b.heading_deg) * x).rem_euclid(360.0),
            pitch_deg: between(a.pitch_deg, b.pitch_deg),
            fov_deg: between(a.fov_deg, b.fov_deg),
            hour: between(a.hour, hour_on(a.hour, b.hour)).rem_euclid(24.0),
            fade: between(a.fade, b.fade),
        }
    }
}
