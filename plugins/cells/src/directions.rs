//! Directions of the lines that pass through a portal: the coarse brother of [`crate::lines::LineSets`], two numbers a set.
//!
//! Where a line crosses the first portal is forgotten, only its slope is kept: an interval that holds the slopes of all lines
//! through the first portal, the present one, and all between. It never lacks one, but may hold some of no line.

use crate::lines::{Frame, SLACK_M, STEEPEST};

/// An interval of slopes in a portal's frame, least and greatest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Directions {
    low: f64,
    high: f64,
}

impl Directions {
    /// Every slope.
    pub(crate) const ALL: Self = Self { low: -STEEPEST, high: STEEPEST };

    /// From the least slope to the greatest.
    pub(crate) const fn within((low, high): (f64, f64)) -> Self {
        Self { low, high }
    }

    /// The slopes that lines through the frame's portal and a further one may have, the ends of which are given in the frame;
    /// `None` if there is no such line.
    pub(crate) fn between(frame: &Frame, left: (f64, f64), right: (f64, f64)) -> Option<Self> {
        if left.0 < -SLACK_M && right.0 < -SLACK_M {
            return None; // Behind the first portal.
        }
        let (least, most) = (-SLACK_M, frame.width_m() + SLACK_M);
        let mut slopes = Self::ALL;
        // s + m·x ≤ y at the left end and ≥ y at the right one, for some s from least to most.
        slopes.bound(left.0, left.1 + SLACK_M - least);
        slopes.bound(-right.0, most + SLACK_M - right.1);
        slopes.is_any().then_some(slopes)
    }

    /// Keeps the slopes m with m·x ≤ y.
    fn bound(&mut self, x: f64, y: f64) {
        if x > 0.0 {
            self.high = self.high.min(y / x);
        } else if x < 0.0 {
            self.low = self.low.max(y / x);
        } else if y < 0.0 {
            self.high = f64::NEG_INFINITY;
        }
    }

    /// The slopes in both; `None` if there are none.
    pub(crate) fn both(self, other: Self) -> Option<Self> {
        let both = Self { low: self.low.max(other.low), high: self.high.min(other.high) };
        both.is_any().then_some(both)
    }

    /// The smallest interval that holds two.
    pub(crate) fn hull(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Whether every slope of another interval is in this one.
    pub(crate) fn contains(self, other: Self) -> bool {
        self.low <= other.low && other.high <= self.high
    }

    /// By the least slope.
    pub(crate) fn order(&self, other: &Self) -> core::cmp::Ordering {
        self.low.total_cmp(&other.low)
    }

    /// Whether a line through the frame's portal in one of them may reach a convex polygon, whose corners are given in the frame.
    pub(crate) fn reach(self, frame: &Frame, corners: [(f64, f64); 4]) -> bool {
        let (least, most) = (-SLACK_M, frame.width_m() + SLACK_M);
        let lies = |is_so: fn(f64, f64) -> bool, s: f64, m: f64| corners.iter().all(|&(x, y)| is_so(y, s + m * x));
        let is_behind = corners.iter().all(|corner| corner.0 < -SLACK_M);
        !is_behind && !lies(|y, line| y < line, least, self.low) && !lies(|y, line| y > line, most, self.high)
    }

    fn is_any(self) -> bool {
        self.low <= self.high
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use veduta_city::GridPos;

    use super::*;
    use crate::lines::LineSets;

    fn at(x: i32, y: i32) -> GridPos {
        GridPos(x * 512, y * 512)
    }

    #[test]
    fn straight_on_but_not_beyond_the_wedge() {
        let frame = Frame::new(at(0, 10), at(0, 0)).unwrap();
        let to = |left, right| Directions::between(&frame, frame.local(left), frame.local(right));
        let ahead = to(at(30, 10), at(30, 0)).unwrap();
        assert!(ahead.both(to(at(60, 20), at(60, 11)).unwrap()).is_some());
        assert!(ahead.both(to(at(60, 60), at(60, 41)).unwrap()).is_none());
        assert!(to(at(-5, 0), at(-5, 10)).is_none(), "behind");
        assert!(Directions::ALL.contains(ahead) && !ahead.contains(Directions::ALL));
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn whatever_lines_pass_directions_pass(
            portals in proptest::collection::vec((-60..60_i32, -60..60_i32, -60..60_i32, -60..60_i32), 1..5), width in 1..30_i32,
        ) {
            let frame = Frame::new(at(0, width), at(0, 0)).unwrap();
            let mut sets = LineSets::default();
            let mut lines = Some(sets.all(&frame));
            let mut slopes = Some(Directions::ALL);
            for (a, b, c, d) in portals {
                let (left, right) = (frame.local(at(a, b)), frame.local(at(c, d)));
                lines = lines.and_then(|lines| sets.through(lines, left, right));
                slopes = slopes.and_then(|slopes| slopes.both(Directions::between(&frame, left, right)?));
                prop_assert!(lines.is_none() || slopes.is_some());
            }
        }
    }
}
