//! Sets of straight lines that pass through a portal, as convex polygons in the dual plane.
//!
//! In a portal's frame x runs forward through it and y to the left along it, both in metres. A line is y = s + m·x: it crosses
//! the portal at s and leaves it with slope m. All lines below a point (x, y) form the half-plane s + m·x ≤ y of the (s, m)
//! plane, so each end of a further portal cuts the set once.

use veduta_city::{GridPos, metres};

/// Lines that pass a portal's end this far on the wrong side still count: touching is seeing, and rounding loses nothing. Metres.
pub(crate) const SLACK_M: f64 = 1e-3;
/// Steepest slope: a line this close to the portal's own direction is off by less than the slack within a kilometre, and by 6 mm in six.
pub(crate) const STEEPEST: f64 = 1e6;

/// The frame of a portal that is crossed forward.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Frame {
    origin: GridPos,
    /// Unit vector from the right end to the left one.
    left: (f64, f64),
    width_m: f64,
}

impl Frame {
    /// Frame of a portal with its two ends as seen by who crosses it; `None` if they are one point.
    pub(crate) fn new(left: GridPos, right: GridPos) -> Option<Self> {
        let (x, y) = offset(right, left);
        let width_m = libm::sqrt(x * x + y * y);
        (width_m > 0.0).then(|| Self { origin: right, left: (x / width_m, y / width_m), width_m })
    }

    /// The portal's right end.
    pub(crate) const fn origin(&self) -> GridPos {
        self.origin
    }

    /// Distance between the portal's ends.
    pub(crate) const fn width_m(&self) -> f64 {
        self.width_m
    }

    /// Metres forward of the portal and to the left of its right end.
    pub(crate) fn local(&self, p: GridPos) -> (f64, f64) {
        let (x, y) = offset(self.origin, p);
        (x * self.left.1 - y * self.left.0, x * self.left.0 + y * self.left.1)
    }
}

fn offset(from: GridPos, to: GridPos) -> (f64, f64) {
    (metres(to.0) - metres(from.0), metres(to.1) - metres(from.1))
}

/// A set of lines: corners (s, m) of a convex polygon, counter-clockwise, never empty.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Lines(Vec<[f64; 2]>);

impl Lines {
    /// All lines through the frame's portal.
    pub(crate) fn all(frame: &Frame) -> Self {
        let (low, high) = (-SLACK_M, frame.width_m + SLACK_M);
        Self(vec![[low, -STEEPEST], [high, -STEEPEST], [high, STEEPEST], [low, STEEPEST]])
    }

    /// Those that also cross a further portal, with its ends in the frame; `None` if there are none.
    pub(crate) fn through(&self, left: (f64, f64), right: (f64, f64)) -> Option<Self> {
        if left.0 < -SLACK_M && right.0 < -SLACK_M {
            return None; // Behind the first portal.
        }
        let below = cut(&self.0, |s, m| s + m * left.0 - left.1 - SLACK_M)?;
        cut(&below, |s, m| right.1 - SLACK_M - s - m * right.0).map(Self)
    }

    /// Whether some of them cross a further portal: whether [`Self::through`] gives any.
    pub(crate) fn meet(&self, left: (f64, f64), right: (f64, f64)) -> bool {
        let passes = |&[s, m]: &[f64; 2]| s + m * left.0 - left.1 <= SLACK_M && right.1 - s - m * right.0 <= SLACK_M;
        let is_behind = left.0 < -SLACK_M && right.0 < -SLACK_M;
        !is_behind && (self.0.iter().any(passes) || self.through(left, right).is_some())
    }

    /// Whether every line of another set is in this one (but for less than the slack).
    pub(crate) fn contains(&self, other: &Self) -> bool {
        let n = self.0.len();
        (0..n).all(|i| {
            let (a, b) = (self.0[i], self.0[(i + 1) % n]);
            let edge = [b[0] - a[0], b[1] - a[1]];
            let tolerance = 1e-12 * (edge[0].abs() + edge[1].abs());
            other.0.iter().all(|p| {
                let to = [p[0] - a[0], p[1] - a[1]];
                edge[0] * to[1] - edge[1] * to[0] >= -tolerance * (1.0 + to[0].abs() + to[1].abs())
            })
        })
    }

    /// The smallest convex set that holds two.
    pub(crate) fn hull(&self, other: &Self) -> Self {
        let mut points: Vec<[f64; 2]> = self.0.iter().chain(&other.0).copied().collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        points.dedup();
        if points.len() < 3 {
            return Self(points);
        }
        let mut corners: Vec<[f64; 2]> = Vec::with_capacity(points.len() + 1);
        for round in 0..2 {
            let start = corners.len();
            for &p in &points {
                while corners.len() >= start + 2 && cross(corners[corners.len() - 2], corners[corners.len() - 1], p) <= 0.0 {
                    corners.pop();
                }
                corners.push(p);
            }
            corners.pop();
            if round == 0 {
                points.reverse();
            }
        }
        Self(corners)
    }

    /// Least and greatest slope.
    pub(crate) fn slopes(&self) -> (f64, f64) {
        self.0.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &[_, m]| (low.min(m), high.max(m)))
    }

    /// Area in the dual plane: a measure of how many lines there are.
    pub(crate) fn measure(&self) -> f64 {
        let first = self.0[0];
        self.0.windows(2).map(|pair| cross(first, pair[0], pair[1])).sum()
    }
}

fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The part of a convex polygon where `excess` is not positive.
fn cut(corners: &[[f64; 2]], excess: impl Fn(f64, f64) -> f64) -> Option<Vec<[f64; 2]>> {
    if corners.iter().all(|&[s, m]| excess(s, m) > 0.0) {
        return None;
    }
    let n = corners.len();
    let mut kept = Vec::with_capacity(n + 1);
    for i in 0..n {
        let (a, b) = (corners[i], corners[(i + 1) % n]);
        let (fa, fb) = (excess(a[0], a[1]), excess(b[0], b[1]));
        if fa <= 0.0 {
            kept.push(a);
        }
        if (fa < 0.0 && fb > 0.0) || (fa > 0.0 && fb < 0.0) {
            let t = fa / (fa - fb);
            kept.push([a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t]);
        }
    }
    (!kept.is_empty()).then_some(kept)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn at(x: i32, y: i32) -> GridPos {
        GridPos(x * 1024, y * 1024)
    }

    #[test]
    fn through_two_portals_in_a_row_but_not_round_a_corner() {
        // Going east through a portal from (0, 0) to (0, 10).
        let frame = Frame::new(at(0, 10), at(0, 0)).unwrap();
        let crossing = |lines: &Lines, left, right| lines.through(frame.local(left), frame.local(right));
        let all = Lines::all(&frame);
        let ahead = crossing(&all, at(30, 10), at(30, 0)).expect("straight on");
        assert!(crossing(&ahead, at(60, 20), at(60, 11)).is_some(), "within the wedge");
        assert!(crossing(&ahead, at(60, 40), at(60, 21)).is_none(), "beyond the wedge");
        assert!(crossing(&ahead, at(60, 40), at(60, 20)).is_some(), "touching is seeing");
        assert!(crossing(&all, at(-5, 0), at(-5, 10)).is_none(), "behind");
        assert!(all.contains(&ahead) && !ahead.contains(&all));
    }

    proptest! {
        #[test]
        fn lines_meet_what_they_lead_through(c in corners(), x in 1..40_i32, y in -40..40_i32, dx in -20..20_i32, dy in 1..40_i32) {
            let lines = c.into_iter().map(|p| Lines(vec![p])).reduce(|a, b| a.hull(&b)).unwrap();
            let (left, right) = ((f64::from(x + dx), f64::from(y + dy)), (f64::from(x), f64::from(y)));
            prop_assert_eq!(lines.meet(left, right), lines.through(left, right).is_some());
        }

        #[test]
        fn a_line_that_crosses_all_portals_is_kept(
            ys in proptest::collection::vec((-50..50_i32, 1..40_i32, 0..=100_i32), 2..6), slope in -3..=3_i32,
        ) {
            // Portals at x = 0, 10, 20 …, each placed around a line of the given slope.
            let frame_at = |i: usize| {
                let (_, width, share) = ys[i];
                let y = slope * 10 * i as i32;
                let right = y - width * share / 100;
                (at(10 * i as i32, right + width), at(10 * i as i32, right))
            };
            let (left, right) = frame_at(0);
            let frame = Frame::new(left, right).unwrap();
            let mut lines = Lines::all(&frame);
            for i in 1..ys.len() {
                let (left, right) = frame_at(i);
                let next = lines.through(frame.local(left), frame.local(right));
                prop_assert!(lines.meet(frame.local(left), frame.local(right)));
                prop_assert!(next.is_some(), "lost at portal {}", i);
                lines = next.unwrap();
            }
        }

        #[test]
        fn a_hull_contains_both(a in corners(), b in corners()) {
            let point = |p: [f64; 2]| Lines(vec![p]);
            let set = |c: Vec<[f64; 2]>| c.into_iter().map(point).reduce(|x, y| x.hull(&y)).unwrap();
            let (a, b) = (set(a), set(b));
            let hull = a.hull(&b);
            prop_assert!(hull.contains(&a) && hull.contains(&b));
            prop_assert!(hull.measure() >= a.measure().max(b.measure()) - 1e-9);
        }
    }

    fn corners() -> impl Strategy<Value = Vec<[f64; 2]>> {
        proptest::collection::vec((-50.0..50.0_f64, -5.0..5.0_f64).prop_map(|(s, m)| [s, m]), 3..7)
    }
}
