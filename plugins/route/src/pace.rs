//! How far along a path one has come by when: the wanted speed wherever it may be held, reached and left with bounded
//! acceleration, slower where the path bends too sharply for it.
//!
//! A profile of least time under limits of speed and acceleration (a pass forward and one backward) is averaged over a
//! short sliding window, which bounds the change of acceleration as well and alters neither distance nor cruising speed.

use crate::path::Path;

/// Window of the average, in seconds.
const WINDOW_S: f64 = 0.4;
/// Length of the pieces for which a speed is sought, in metres.
const CELL_M: f64 = 0.5;

/// Limits of acceleration, metres a second squared.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Haste {
    /// When gaining speed.
    pub up: f64,
    /// When losing it.
    pub down: f64,
    /// Across the path, in bends.
    pub side: f64,
}

/// A stretch of constant acceleration.
#[derive(Debug, Clone, Copy)]
struct Piece {
    t: f64,
    s: f64,
    v: f64,
    a: f64,
}

/// Distance over time along one path, from rest to rest.
#[derive(Debug, Clone)]
pub(crate) struct Pace {
    pieces: Vec<Piece>,
    /// Seconds before averaging.
    span_s: f64,
    length_m: f64,
}

impl Pace {
    /// The pace along a path, with a speed for each leg; speeds are positive.
    pub fn new(path: &Path, speed_of_leg: impl Fn(u32) -> f64, haste: Haste) -> Self {
        let cells = cells(path, speed_of_leg, haste.side);
        let mut speed = vec![0.0; cells.len() + 1];
        for i in 1..cells.len() {
            let top = cells[i - 1].top.min(cells[i].top);
            speed[i] = reached(speed[i - 1], haste.up, cells[i - 1].length).min(top);
        }
        for i in (1..cells.len()).rev() {
            speed[i] = reached(speed[i + 1], haste.down, cells[i].length).min(speed[i]);
        }
        let (mut t, mut s) = (0.0, 0.0);
        let mut pieces: Vec<Piece> = Vec::new();
        for (cell, v) in cells.iter().zip(speed.windows(2)) {
            let dt = 2.0 * cell.length / (v[0] + v[1]);
            let a = (v[1] - v[0]) / dt;
            let goes_on = pieces.last().is_some_and(|p| p.a == 0.0 && a == 0.0 && p.v == v[0]);
            if !goes_on {
                pieces.push(Piece { t, s, v: v[0], a });
            }
            t += dt;
            s += cell.length;
        }
        Self { pieces, span_s: t, length_m: path.length() }
    }

    /// Seconds from start to stop.
    pub fn duration_s(&self) -> f64 {
        self.span_s + WINDOW_S
    }

    /// Metres travelled after so many seconds; clamps.
    pub fn travelled(&self, t: f64) -> f64 {
        if t <= 0.0 {
            return 0.0;
        }
        if t >= self.duration_s() {
            return self.length_m;
        }
        let (from, to) = ((t - WINDOW_S).max(0.0), t.min(self.span_s));
        let mut sum = self.length_m * (t - to);
        let first = self.pieces.partition_point(|p| p.t <= from).saturating_sub(1);
        for (i, piece) in self.pieces.iter().enumerate().skip(first) {
            let (a, b) = (piece.t.max(from), self.pieces.get(i + 1).map_or(self.span_s, |next| next.t).min(to));
            if a >= to {
                break;
            }
            let at = |t: f64| piece.s + (piece.v + piece.a * (t - piece.t) / 2.0) * (t - piece.t);
            // Simpson's rule is exact here.
            sum += (b - a).max(0.0) / 6.0 * (at(a) + 4.0 * at((a + b) / 2.0) + at(b));
        }
        (sum / WINDOW_S).clamp(0.0, self.length_m)
    }

    /// When a distance is reached, in seconds from the start.
    pub fn when(&self, s: f64) -> f64 {
        let (mut early, mut late) = (0.0, self.duration_s());
        for _ in 0..60 {
            let middle = (early + late) / 2.0;
            if self.travelled(middle) < s { early = middle } else { late = middle }
        }
        late
    }
}

fn reached(v: f64, a: f64, length: f64) -> f64 {
    (v * v + 2.0 * a * length).sqrt()
}

/// A short piece of a path with its greatest speed.
struct Cell {
    length: f64,
    top: f64,
}

fn cells(path: &Path, speed_of_leg: impl Fn(u32) -> f64, side: f64) -> Vec<Cell> {
    // Even the shortest path has room to gain speed and to lose it.
    let longest = CELL_M.min(path.length() / 16.0);
    let mut cells = Vec::new();
    for w in path.knots().windows(2) {
        let span = w[1].s - w[0].s;
        let in_bends = if w[0].bend > 0.0 { (side / w[0].bend).sqrt() } else { f64::INFINITY };
        let top = speed_of_leg(w[0].leg).min(in_bends);
        let parts = libm::ceil(span / longest).max(1.0);
        cells.extend((0..parts as u32).map(|_| Cell { length: span / parts, top }));
    }
    cells
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::path::{Mark, round_corners};

    fn path(points: &[(f64, f64)]) -> Path {
        let marks: Vec<Mark> = points.iter().map(|&(x, y)| Mark { at: DVec3::new(x, y, 1.65), leg: 0 }).collect();
        round_corners(&marks, None).swap_remove(0)
    }

    const WALK: Haste = Haste { up: 1.2, down: 1.2, side: 3.0 };

    #[test]
    fn a_straight_walk_takes_what_newton_says() {
        let pace = Pace::new(&path(&[(0.0, 0.0), (100.0, 0.0)]), |_| 1.4, WALK);
        let ideal = 100.0 / 1.4 + 1.4 / 1.2 + WINDOW_S;
        assert!((pace.duration_s() - ideal).abs() < 0.25, "{} against {ideal}", pace.duration_s());
        let middle = pace.duration_s() / 2.0;
        assert!((pace.travelled(middle) - 50.0).abs() < 1e-6, "the same to both sides");
        assert!((pace.travelled(middle + 1.0) - pace.travelled(middle) - 1.4).abs() < 1e-9, "at the speed asked for");
    }

    #[test]
    fn when_is_the_inverse_of_travelled() {
        let pace = Pace::new(&path(&[(0.0, 0.0), (30.0, 0.0), (30.0, 9.0)]), |_| 2.0, WALK);
        for s in [0.5, 10.0, 31.0] {
            assert!((pace.travelled(pace.when(s)) - s).abs() < 1e-6);
        }
    }

    proptest! {
        #[test]
        fn speed_and_acceleration_keep_their_limits(
            points in proptest::collection::vec((-20.0..20.0, -20.0..20.0f64), 2..7),
            top in 0.3..6.0f64,
            up in 0.5..4.0f64,
        ) {
            let haste = Haste { up, down: 1.2, side: 3.0 };
            prop_assume!(points[0] != points[1]);
            let pace = Pace::new(&path(&points), |_| top, haste);
            let dt = 1.0 / 240.0;
            let steps = (pace.duration_s() / dt) as u32 + 2;
            let mut last_speed = 0.0;
            for i in 0..steps {
                let t = f64::from(i) * dt;
                let speed = (pace.travelled(t + dt) - pace.travelled(t)) / dt;
                prop_assert!(speed <= top * (1.0 + 1e-6) && speed >= -1e-6, "{speed} of {top}");
                let gained = (speed - last_speed) / dt;
                prop_assert!(gained <= up + 1e-4 && gained >= -1.2 - 1e-4, "{gained} m/s2");
                last_speed = speed;
            }
            prop_assert!(last_speed.abs() < 1e-9, "it ends at rest");
            prop_assert_eq!(pace.travelled(1e9), pace.length_m);
        }
    }
}
