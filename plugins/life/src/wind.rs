use core::f64::consts::TAU;

use bevy::math::DVec2;
use veduta_ecs::Weather;

/// The wind's gusts are a sum of swells, each so many radians a second and so large a share of the mean. Their periods have no common
/// measure, so that it never seems to repeat; and it is the same at any time for every frame rate.
pub(crate) const GUSTS: [(f64, f64); 4] = [(0.41, 0.34), (0.97, 0.24), (2.13, 0.15), (4.71, 0.08)];

/// The wind of a moment at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wind {
    /// Where it blows to, a unit vector in plan.
    pub toward: DVec2,
    /// Mean speed, metres a second.
    pub mean_m_s: f64,
}

impl Wind {
    /// As the weather tells it.
    #[must_use]
    pub fn of(weather: &Weather) -> Self {
        let from = f64::from(weather.wind_from_deg).to_radians();
        Self { toward: -DVec2::new(from.sin(), from.cos()), mean_m_s: f64::from(weather.wind_m_s).clamp(0.0, 40.0) }
    }

    /// How late gusts are at a place, seconds: they travel with the wind, and meet a whole square one after another.
    #[must_use]
    pub fn lag_s(&self, plan_pos: DVec2) -> f64 {
        self.toward.dot(plan_pos) / self.mean_m_s.max(1.0)
    }

    /// Speed at a time (seconds) at a place, metres a second; never negative.
    #[must_use]
    pub fn speed_m_s(&self, plan_pos: DVec2, time_s: f64) -> f64 {
        let late = time_s - self.lag_s(plan_pos);
        let gusts: f64 = GUSTS.iter().map(|(rate, share)| share * (rate * late).sin()).sum();
        (self.mean_m_s * (1.0 + gusts)).max(0.0)
    }
}

/// A board on a hinge: a damped pendulum that the wind pushes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pendulum {
    /// Its own swing, radians a second.
    rate: f64,
}

/// Share of critical damping: the hinge is rusty.
const DAMPING: f64 = 0.09;
/// Angle at which a wind of 1 m/s holds a board, radians.
const LEAN: f64 = 0.012;
const MOST_LEAN: f64 = 0.75;
const GRAVITY: f64 = 9.81;

impl Pendulum {
    /// One whose middle hangs so far below its hinge, metres.
    pub(crate) fn hanging(length_m: f64) -> Self {
        Self { rate: (GRAVITY / length_m.max(0.02)).sqrt() }
    }

    /// Its angle from upright at a time, radians, in a wind that strikes its face with a share of its speed, −1 to 1. Every swell of the wind
    /// drives it on its own (the equation is linear), with the amplitude and the delay of a driven oscillator: so any moment can be
    /// asked for, and there is nothing to run.
    pub(crate) fn angle(&self, wind: &Wind, plan_pos: DVec2, face: f64, time_s: f64) -> f64 {
        let late = time_s - wind.lag_s(plan_pos);
        let swing = |&(rate, share): &(f64, f64)| {
            let (still, drag) = (self.rate * self.rate - rate * rate, 2.0 * DAMPING * self.rate * rate);
            let gain = self.rate * self.rate / still.hypot(drag);
            share * gain * (rate * late - drag.atan2(still)).sin()
        };
        // What a swell of the speed does to the push: the push goes by its square, to first order twice the swell.
        let gusts: f64 = GUSTS.iter().chain(&[(self.rate, 0.02)]).map(swing).sum();
        let mean = LEAN * wind.mean_m_s * wind.mean_m_s * 0.35;
        let still_air = 0.006 * (self.rate * late + TAU * 0.13).sin();
        (face * mean * (1.0 + 2.0 * gusts) + still_air * face.abs()).clamp(-MOST_LEAN, MOST_LEAN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WEST: Weather = Weather { clouds: 0.0, wet: 0.0, wind_m_s: 4.0, wind_from_deg: 270.0 };

    #[test]
    fn a_west_wind_blows_east_in_gusts_about_its_mean() {
        let wind = Wind::of(&WEST);
        assert!((wind.toward - DVec2::X).length() < 1e-9);
        let speeds: Vec<f64> = (0..20_000).map(|n| wind.speed_m_s(DVec2::ZERO, f64::from(n) * 0.05)).collect();
        let mean = speeds.iter().sum::<f64>() / speeds.len() as f64;
        assert!((mean - 4.0).abs() < 0.1, "{mean}");
        let (least, most) = speeds.iter().fold((9e9_f64, 0.0_f64), |(l, m), &s| (l.min(s), m.max(s)));
        assert!(least < 2.5 && most > 5.5 && least >= 0.0, "{least} to {most}");
        let (here, there) = (wind.speed_m_s(DVec2::ZERO, 10.0), wind.speed_m_s(DVec2::new(8.0, 3.0), 12.0));
        assert!((here - there).abs() < 1e-9, "a gust takes two seconds for eight metres");
    }

    #[test]
    fn a_board_swings_about_where_the_wind_holds_it_and_solves_its_equation() {
        let (wind, board) = (Wind::of(&WEST), Pendulum::hanging(0.5));
        let at = |t: f64| board.angle(&wind, DVec2::ZERO, 1.0, t);
        let (h, lean) = (1e-3, LEAN * 16.0 * 0.35);
        for n in 0..400 {
            let t = f64::from(n) * 0.173;
            let (speed, turn) = ((at(t + h) - at(t - h)) / (2.0 * h), (at(t + h) - 2.0 * at(t) + at(t - h)) / (h * h));
            let inertia = turn + 2.0 * DAMPING * board.rate * speed + board.rate * board.rate * at(t);
            let gusts: f64 = GUSTS.iter().chain(&[(board.rate, 0.02)]).map(|(rate, share)| share * (rate * t).sin()).sum();
            let push = board.rate * board.rate * lean * (1.0 + 2.0 * gusts);
            // What it does in still air is beside the equation, and small.
            assert!((inertia - push).abs() < 0.1 * board.rate * board.rate * lean + 0.05, "{t}: {inertia} and {push}");
        }
        assert!(at(3.0).abs() < MOST_LEAN);
        let still = Wind { mean_m_s: 0.0, ..wind };
        assert!((0..100).all(|n| board.angle(&still, DVec2::ZERO, 1.0, f64::from(n)).abs() < 0.01), "it hardly moves in still air");
        assert_eq!(board.angle(&wind, DVec2::ZERO, 0.0, 5.0), 0.0, "wind along the board moves nothing");
    }
}
