use bevy::math::Vec3;
use veduta_city::Jet;

pub(crate) const GRAVITY: f32 = 9.81;

/// A thread of water that flies: from where, how fast, and for how long, in a frame whose y points up; metres and seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Throw {
    pub from: Vec3,
    pub speed: Vec3,
    pub flight_s: f32,
}

impl Throw {
    /// Where it is after so many seconds: a parabola.
    #[cfg(test)]
    pub fn at(&self, age_s: f32) -> Vec3 {
        self.from + self.speed * age_s - Vec3::Y * (0.5 * GRAVITY * age_s * age_s)
    }
}

/// The threads of a ring of openings: each rises as high as is told, and falls as far out. Water that only runs over a rim begins with
/// nothing but its way outwards.
pub(crate) fn throws(jet: &Jet, water_m: f64) -> impl Iterator<Item = Throw> {
    let rise = jet.rise_m.max(0.0) as f32;
    let (low, high) = (jet.lands_m.unwrap_or(water_m) as f32, jet.height_m as f32);
    let up = (2.0 * GRAVITY * rise).sqrt();
    let flight_s = up / GRAVITY + (2.0 * (high + rise - low).max(0.01) / GRAVITY).sqrt();
    let (out, count) = (jet.reach_m as f32 / flight_s, jet.count.max(1));
    let radius = jet.radius_m as f32;
    (0..count).map(move |n| {
        let (sin, cos) = (core::f32::consts::TAU * n as f32 / count as f32).sin_cos();
        let way = Vec3::new(cos, 0.0, sin);
        Throw { from: way * radius + Vec3::Y * high, speed: way * out + Vec3::Y * up, flight_s }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn water_rises_as_high_and_falls_as_far_as_it_is_told() {
        let jet = Jet { count: 8, radius_m: 0.5, height_m: 2.0, rise_m: 1.2, reach_m: 0.9, lands_m: None, width_m: 0.02 };
        let all: Vec<Throw> = throws(&jet, 0.6).collect();
        assert_eq!(all.len(), 8);
        for throw in &all {
            let steps = (0..=400).map(|n| throw.at(throw.flight_s * n as f32 / 400.0));
            let top = steps.map(|p| p.y).fold(f32::NEG_INFINITY, f32::max);
            assert!((top - 3.2).abs() < 1e-3, "{top}");
            let end = throw.at(throw.flight_s);
            assert!((end.y - 0.6).abs() < 1e-4 && (end.with_y(0.0).length() - 1.4).abs() < 1e-4, "{end}");
        }
        assert!(all[0].from.distance(all[4].from) > 0.99, "they stand round the middle");
        let rim = Jet { rise_m: 0.0, lands_m: Some(1.0), ..jet };
        let throw = throws(&rim, 0.0).next().expect("one at least");
        assert!(throw.speed.y == 0.0 && (throw.at(throw.flight_s).y - 1.0).abs() < 1e-4);
    }
}
