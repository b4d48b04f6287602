//! Walks: the fewest spots from which the shortest ways along streets lead as somebody went.

use glam::{DVec2, swizzles::Vec3Swizzles};
use veduta_city::{Ease, Step, Where};

use super::{RECORDED_WALK_M, Sample, farthest, gaze::Leg, simplified, spot, tenth};
use crate::{CORNER_M, Gazetteer, STRAIGHT_M, StreetNet, net::nearest_on, way};

/// Lines are simplified to within this before ways are sought, metres.
const DRAWN_M: f64 = 0.8;
/// A way may leave what was walked by so much: corners are rounded besides; metres.
const WAY_M: f64 = RECORDED_WALK_M - CORNER_M;
/// Speeds this much like the tour's own are not told.
const SPEED_SHARE: f64 = 0.12;

/// Adds the legs of a walk.
pub(super) fn tell(samples: &[Sample], legs: &[Leg], net: &StreetNet, places: &Gazetteer, tour_speed: f64, steps: &mut Vec<Step>) {
    let Some(mut here) = samples.first().map(|s| Spot::at(s.at.xy())) else { return };
    for leg in legs {
        let part: Vec<DVec2> = samples[leg.from..=leg.to].iter().map(|s| s.at.xy()).collect();
        let mut spots = spots(here.plan_pos, &part, net, places);
        let Some(to) = spots.pop() else { continue };
        here = to.clone();
        let speed = speed(&samples[leg.from..=leg.to]);
        let is_usual = speed.is_none_or(|speed| (speed / tour_speed - 1.0).abs() < SPEED_SHARE);
        steps.push(Step::Walk {
            to: to.name,
            via: spots.into_iter().map(|spot| spot.name).collect(),
            speed: speed.filter(|_| !is_usual),
            look: leg.look.clone(),
            ease: Ease::default(),
        });
    }
}

/// The speed that was held most of the time, metres a second.
fn speed(samples: &[Sample]) -> Option<f64> {
    let mut speeds: Vec<f64> = samples
        .windows(2)
        .filter(|w| w[1].t_s > w[0].t_s)
        .map(|w| w[0].at.xy().distance(w[1].at.xy()) / (w[1].t_s - w[0].t_s))
        .collect();
    speeds.sort_by(f64::total_cmp);
    speeds.get(speeds.len() / 2).map(|&speed| tenth(speed).clamp(0.1, 10.0))
}

/// A spot, and how the tour tells it.
#[derive(Debug, Clone)]
struct Spot {
    plan_pos: DVec2,
    name: Where,
}

impl Spot {
    fn at(plan_pos: DVec2) -> Self {
        let name = spot(plan_pos);
        Self { plan_pos: name.plan_pos().unwrap_or(plan_pos), name }
    }

    /// By the name of the place whose stand is there, if there is one.
    fn named(plan_pos: DVec2, places: &Gazetteer) -> Self {
        let here = Self::at(plan_pos);
        let Some((name, stand)) = places.standing_at(plan_pos, WAY_M / 2.0) else { return here };
        Self { plan_pos: stand, name: Where::Place(name.to_owned()) }
    }
}

/// The spots of a leg after its first: as few as the ways between them allow.
fn spots(from: DVec2, walked: &[DVec2], net: &StreetNet, places: &Gazetteer) -> Vec<Spot> {
    let candidates = candidates(walked);
    let end = candidates.len() - 1;
    let mut spots: Vec<Spot> = Vec::new();
    let mut here = from;
    let mut at = 0;
    while at < end {
        let fits = |to: usize| {
            let there = Spot::at(walked[candidates[to]]).plan_pos;
            follows(here, there, &walked[candidates[at]..=candidates[to]], net)
        };
        let next = farthest(at, end, fits);
        let stand = walked[candidates[next]];
        let named = Spot::named(stand, places);
        let is_named = next == end && follows(here, named.plan_pos, &walked[candidates[at]..=candidates[next]], net);
        let spot = if is_named { named } else { Spot::at(stand) };
        here = spot.plan_pos;
        spots.push(spot);
        at = next;
    }
    spots
}

/// Where a leg may have its spots: the corners of what was walked, none farther from the next than one goes straight.
fn candidates(walked: &[DVec2]) -> Vec<usize> {
    let off = |a: usize, b: usize, i: usize| nearest_on(walked[a], walked[b], walked[i]).0.distance(walked[i]);
    let corners = simplified(walked.len(), DRAWN_M, off);
    let mut candidates = vec![0];
    for pair in corners.windows(2) {
        let mut last = pair[0];
        for i in pair[0] + 1..pair[1] {
            if walked[last].distance(walked[i + 1]) > STRAIGHT_M - 1.0 {
                candidates.push(i);
                last = i;
            }
        }
        candidates.push(pair[1]);
    }
    candidates.dedup();
    candidates
}

/// Whether the way between two positions goes where somebody walked.
fn follows(from: DVec2, to: DVec2, walked: &[DVec2], net: &StreetNet) -> bool {
    const EVERY_M: f64 = 1.5;
    let Ok(way) = net.way(from, to) else { return false };
    let walked_m = way::length(walked);
    if (way::length(&way) - walked_m).abs() > 0.3 * walked_m + 2.0 * WAY_M {
        return false;
    }
    let near = |line: &[DVec2], p: DVec2| line.windows(2).any(|w| nearest_on(w[0], w[1], p).0.distance(p) <= WAY_M);
    let between = |w: &[DVec2]| {
        let (a, b) = (w[0], w[1]);
        let pieces = libm::ceil(a.distance(b) / EVERY_M).max(1.0);
        (0..=pieces as u32).map(move |i| a.lerp(b, f64::from(i) / pieces)).collect::<Vec<_>>()
    };
    walked.iter().all(|&p| near(&way, p)) && way.windows(2).flat_map(between).all(|p| near(walked, p))
}
