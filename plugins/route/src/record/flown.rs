//! Flights: the fewest points whose curve goes where somebody flew.

use glam::DVec3;
use veduta_city::{Ease, Step};

use super::{RECORDED_FLIGHT_M, Sample, gaze::Leg, hundredth, tenth};
use crate::{flight::fly, path::Mark};

/// The curve may leave what was flown by so much: its points are rounded besides; metres.
const CURVE_M: f64 = RECORDED_FLIGHT_M * 0.8;
/// Rounds in which points are added, one a span.
const ROUNDS: usize = 24;

/// Adds the legs of a flight.
pub(super) fn tell(samples: &[Sample], legs: &[Leg], steps: &mut Vec<Step>) {
    let joints: Vec<usize> = legs.iter().map(|leg| leg.to).collect();
    let points = points(samples, &joints);
    for leg in legs {
        let through: Vec<(f64, f64, f64)> = points
            .iter()
            .filter(|&&i| i > leg.from && i <= leg.to)
            .map(|&i| rounded(samples[i].at))
            .map(|p| (p.x, p.y, p.z))
            .collect();
        if !through.is_empty() {
            steps.push(Step::Fly {
                through,
                speed: speed(&samples[leg.from..=leg.to]),
                look: leg.look.clone(),
                ease: Ease::default(),
            });
        }
    }
}

fn rounded(at: DVec3) -> DVec3 {
    DVec3::new(tenth(at.x), tenth(at.y), hundredth(at.z.max(0.2)))
}

/// Metres a second along the way, on the whole.
fn speed(samples: &[Sample]) -> f64 {
    let length_m: f64 = samples.windows(2).map(|w| w[0].at.distance(w[1].at)).sum();
    let seconds = samples.last().zip(samples.first()).map_or(0.0, |(b, a)| b.t_s - a.t_s);
    tenth(if seconds > 0.0 { length_m / seconds } else { 1.0 }).clamp(0.3, 200.0)
}

/// Which samples the curve is led through: the first, the joints, and as many more as it takes.
fn points(samples: &[Sample], joints: &[usize]) -> Vec<usize> {
    let mut points: Vec<usize> = core::iter::once(0).chain(joints.iter().copied()).collect();
    for _ in 0..ROUNDS {
        let worst = worst(samples, &points);
        if worst.is_empty() {
            break;
        }
        points.extend(worst);
        points.sort_unstable();
        points.dedup();
    }
    points
}

/// The sample farthest from the curve in every span that leaves what was flown by too much.
fn worst(samples: &[Sample], points: &[usize]) -> Vec<usize> {
    let marks: Vec<Mark> =
        points.iter().enumerate().map(|(leg, &i)| Mark { at: rounded(samples[i].at), leg: leg as u32 }).collect();
    let mut curve: Vec<Vec<DVec3>> = vec![Vec::new(); points.len()];
    for path in fly(&marks) {
        for w in path.knots().windows(2) {
            // A knot bears the number of the span that begins there.
            if let Some(span) = curve.get_mut(w[0].leg as usize) {
                span.extend([w[0].at, w[1].at]);
            }
        }
    }
    let off = |span: &[DVec3], p: DVec3| {
        let apart = |w: &[DVec3]| {
            let d = w[1] - w[0];
            let along = if d.length_squared() > 0.0 { ((p - w[0]).dot(d) / d.length_squared()).clamp(0.0, 1.0) } else { 0.0 };
            (w[0] + d * along).distance(p)
        };
        span.windows(2).map(apart).fold(f64::INFINITY, f64::min)
    };
    let spans = points.windows(2).zip(curve.iter().skip(1));
    spans
        .filter_map(|(ends, span)| {
            let inner = (ends[0] + 1..ends[1]).map(|i| (off(span, samples[i].at), i));
            inner.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(off, _)| *off > CURVE_M).map(|(_, i)| i)
        })
        .collect()
}
