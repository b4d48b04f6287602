//! What somebody who moves looks at: ahead, at a spot, or in a direction.

use glam::{DMat3, DVec3, swizzles::Vec3Swizzles};
use veduta_city::{LookAt, PlanTerrain, Where};

use super::{RECORDED_GAZE_DEG, Sample, apart_deg, farthest, heading, tenth};
use crate::{pose::Facing, turn_deg};

/// A part of a movement with one gaze: samples from one to another, both included.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Leg {
    pub from: usize,
    pub to: usize,
    pub look: LookAt,
}

/// So far from the way ahead eyes wander that look ahead, degrees to the sides and up and down.
const AHEAD_DEG: f64 = 20.0;
const AHEAD_PITCH_DEG: f64 = 14.0;
/// So far ahead walkers look, metres, and flights, seconds.
const AHEAD_M: f64 = 4.0;
const AHEAD_S: f64 = 1.5;
/// A gaze is kept at least so long, seconds.
const LEAST_S: f64 = 1.2;
/// A spot is looked at from so far, metres.
const NEAREST_M: f64 = 3.0;
const FARTHEST_M: f64 = 400.0;

/// The parts of a movement, in order; each begins where the one before ends.
pub(super) fn legs(samples: &[Sample], terrain: &PlanTerrain, is_flight: bool) -> Vec<Leg> {
    let end = samples.len().saturating_sub(1);
    let ahead: Vec<[Facing; 3]> = (0..samples.len()).map(|i| way_ahead(samples, i, is_flight)).collect();
    let mut legs: Vec<Leg> = Vec::new();
    let mut from = 0;
    while from < end {
        let looks_ahead = |to: usize| (from..=to).all(|i| is_ahead(samples[i].facing, ahead[i]));
        let mut best = (LookAt::Ahead, farthest_if(from, end, looks_ahead));
        let direction = farthest_if(from, end, |to| fixed(&samples[from..=to]).is_some());
        if direction > best.1
            && let Some(look) = fixed(&samples[from..=direction])
        {
            best = (look, direction);
        }
        // Lines of sight meet somewhere only after a while.
        let spot = farthest_if(best.1, end, |to| spot(&samples[from..=to], terrain).is_some());
        if spot > best.1
            && let Some(look) = self::spot(&samples[from..=spot], terrain)
        {
            best = (look, spot);
        }
        let least = (from + 1..end).find(|&i| samples[i].t_s - samples[from].t_s >= LEAST_S).unwrap_or(end);
        if best.1 < least {
            best = (heading(samples[least].facing), least);
        }
        match legs.last_mut() {
            Some(last) if last.look == best.0 => last.to = best.1,
            _ => legs.push(Leg { from, to: best.1, look: best.0 }),
        }
        from = best.1;
    }
    legs
}

/// As [`farthest`], but `from` itself where not even the next fits, or there is none.
fn farthest_if(from: usize, end: usize, fits: impl Fn(usize) -> bool) -> usize {
    if from < end && fits(from + 1) { farthest(from, end, fits) } else { from }
}

/// The direction of a way at a sample: just before, right there, and as far ahead as one looks.
fn way_ahead(samples: &[Sample], i: usize, is_flight: bool) -> [Facing; 3] {
    const NEAR_M: f64 = 0.5;
    let here = samples[i];
    let reach_m = if is_flight { (AHEAD_S * speed(samples)).max(AHEAD_M) } else { AHEAD_M };
    let mut gone_m = 0.0;
    let (mut near, mut far) = (None, None);
    for w in samples[i..].windows(2) {
        gone_m += w[0].at.distance(w[1].at);
        if near.is_none() && gone_m >= NEAR_M {
            near = Some(w[1].at);
        }
        far = Some(w[1].at);
        if gone_m >= reach_m {
            break;
        }
    }
    // At its end a way goes on straight.
    let back = || samples[..i].iter().rev().find(|s| s.at.distance(here.at) >= NEAR_M).map(|s| here.at - s.at);
    let direction = |to: Option<DVec3>| to.map(|to| to - here.at).filter(|d| d.length() > 0.2).or_else(back);
    let facing = |d: Option<DVec3>| {
        let facing = d.map_or(here.facing, |d| Facing::along(d, here.facing));
        Facing { pitch: if is_flight { (0.6 * facing.pitch).clamp(-35.0, 35.0) } else { 0.0 }, ..facing }
    };
    let near = direction(near.or(far));
    [facing(back().or(near)), facing(near), facing(direction(far))]
}

/// Metres a second, on the whole.
fn speed(samples: &[Sample]) -> f64 {
    let length_m: f64 = samples.windows(2).map(|w| w[0].at.distance(w[1].at)).sum();
    let seconds = samples.last().zip(samples.first()).map_or(0.0, |(b, a)| b.t_s - a.t_s);
    if seconds > 0.0 { length_m / seconds } else { 0.0 }
}

/// Whether a view goes ahead: along the way or, at its bends, between where it comes from and where it leads, or not far from that.
fn is_ahead(facing: Facing, [before, near, far]: [Facing; 3]) -> bool {
    let is_between = |a: Facing, b: Facing| {
        let around = turn_deg(a.heading, facing.heading).abs() + turn_deg(facing.heading, b.heading).abs();
        around <= turn_deg(a.heading, b.heading).abs() + 2.0 * AHEAD_DEG
    };
    (is_between(before, near) || is_between(near, far)) && (facing.pitch - far.pitch).abs() <= AHEAD_PITCH_DEG
}

/// The one direction of samples, if they have one.
fn fixed(samples: &[Sample]) -> Option<LookAt> {
    let bounds = |value: fn(&Sample) -> f64| {
        let (lo, hi) = samples.iter().map(value).fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        (hi - lo <= 2.0 * (RECORDED_GAZE_DEG - 1.0)).then_some(f64::midpoint(lo, hi))
    };
    let facing = Facing { heading: bounds(|s| s.facing.heading)?, pitch: bounds(|s| s.facing.pitch)? };
    Some(heading(facing))
}

/// The one spot that samples look at, if there is one: the point nearest to all lines of sight, by least squares.
fn spot(samples: &[Sample], terrain: &PlanTerrain) -> Option<LookAt> {
    let eye = |s: &Sample| s.at + DVec3::Z * terrain.height_m(s.at.xy());
    let line = |s: &Sample| {
        let (sin, cos) = (libm::sin(s.facing.heading.to_radians()), libm::cos(s.facing.heading.to_radians()));
        let (rise, flat) = (libm::sin(s.facing.pitch.to_radians()), libm::cos(s.facing.pitch.to_radians()));
        DVec3::new(sin * flat, cos * flat, rise)
    };
    let middle = eye(samples.first()?);
    let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for s in samples {
        let d = line(s);
        let across = DMat3::IDENTITY - DMat3::from_cols(d * d.x, d * d.y, d * d.z);
        matrix += across;
        right += across * (eye(s) - middle);
    }
    // Lines that are nearly parallel meet nowhere in particular.
    let count = samples.len() as f64;
    if matrix.determinant() < 1e-4 * count * count * count {
        return None;
    }
    let at = middle + matrix.inverse() * right;
    let at = DVec3::new(tenth(at.x), tenth(at.y), tenth(at.z));
    let is_seen = samples.iter().all(|s| {
        let d = at - eye(s);
        (NEAREST_M..FARTHEST_M).contains(&d.length()) && apart_deg(Facing::along(d, s.facing), s.facing) <= RECORDED_GAZE_DEG / 2.0
    });
    let height_m = tenth(at.z - terrain.height_m(at.xy()));
    (is_seen && (-50.0..300.0).contains(&height_m)).then_some(LookAt::Spot { at: Where::At(at.x, at.y), height_m, follow: None })
}

/// Where a tour looks when a movement with such a gaze has ended.
pub(super) fn at_the_end(look: &LookAt, samples: &[Sample], terrain: &PlanTerrain) -> Option<Facing> {
    let last = samples.last()?;
    Some(match look {
        LookAt::Ahead => way_ahead(samples, samples.len() - 1, false)[2],
        LookAt::Heading { deg, pitch_deg } => Facing { heading: *deg, pitch: *pitch_deg },
        LookAt::Spot { at, height_m, .. } => {
            let at = at.plan_pos()?;
            let rise = terrain.height_m(at) - terrain.height_m(last.at.xy());
            Facing::along(at.extend(*height_m) - last.at + DVec3::Z * rise, last.facing)
        }
    })
}
