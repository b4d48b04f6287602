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

/// A set of lines among [`LineSets`]: a convex polygon, never empty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Lines {
    first: u32,
    end: u32,
}

impl Lines {
    const fn corners(self) -> core::ops::Range<usize> {
        self.first as usize..self.end as usize
    }
}

/// Sets of lines in one frame. The corners (s, m) of all polygons, each counter-clockwise, lie in one piece of memory, because a search
/// makes thousands of sets and forgets all of them together.
#[derive(Debug, Default)]
pub(crate) struct LineSets {
    corners: Vec<[f64; 2]>,
    /// What is left of a polygon after the first of two cuts.
    half: Vec<[f64; 2]>,
}

impl LineSets {
    /// Forgets all sets, before those in another frame are made.
    pub(crate) fn clear(&mut self) {
        self.corners.clear();
    }

    /// All lines through the frame's portal.
    pub(crate) fn all(&mut self, frame: &Frame) -> Lines {
        let (low, high) = (-SLACK_M, frame.width_m + SLACK_M);
        self.add(&[[low, -STEEPEST], [high, -STEEPEST], [high, STEEPEST], [low, STEEPEST]])
    }

    /// The set with these corners.
    fn add(&mut self, corners: &[[f64; 2]]) -> Lines {
        let first = self.corners.len();
        self.corners.extend_from_slice(corners);
        self.since(first)
    }

    /// The set whose corners have been added last.
    fn since(&self, first: usize) -> Lines {
        Lines { first: first as u32, end: self.corners.len() as u32 }
    }

    /// Those lines of a set that also cross a further portal, with its ends in the frame; `None` if there are none.
    pub(crate) fn through(&mut self, lines: Lines, left: (f64, f64), right: (f64, f64)) -> Option<Lines> {
        let corners = &self.corners[lines.corners()];
        let (above, below) = (|corner: &[f64; 2]| above(corner, left), |corner: &[f64; 2]| below(corner, right));
        if is_behind(left, right) || corners.iter().all(|c| above(c) > 0.0) || corners.iter().all(|c| below(c) > 0.0) {
            return None;
        }
        self.half.clear();
        cut(corners, above, &mut self.half);
        let first = self.corners.len();
        cut(&self.half, below, &mut self.corners);
        let through = self.since(first);
        (through.first < through.end).then_some(through)
    }

    /// Whether some lines of a set cross a further portal: whether [`Self::through`] gives any.
    pub(crate) fn meet(&mut self, lines: Lines, left: (f64, f64), right: (f64, f64)) -> bool {
        let passes = |corner: &[f64; 2]| above(corner, left) <= 0.0 && below(corner, right) <= 0.0;
        if !is_behind(left, right) && self.corners[lines.corners()].iter().any(passes) {
            return true;
        }
        let count = self.corners.len();
        let through = self.through(lines, left, right);
        self.corners.truncate(count);
        through.is_some()
    }

    /// Whether every line of a set is in another one (but for less than the slack).
    pub(crate) fn contains(&self, lines: Lines, inner: Lines) -> bool {
        let (corners, inner) = (&self.corners[lines.corners()], &self.corners[inner.corners()]);
        corners.iter().zip(corners[1..].iter().chain(&corners[..1])).all(|(a, b)| {
            let edge = [b[0] - a[0], b[1] - a[1]];
            let tolerance = 1e-12 * (edge[0].abs() + edge[1].abs());
            inner.iter().all(|p| {
                let to = [p[0] - a[0], p[1] - a[1]];
                edge[0] * to[1] - edge[1] * to[0] >= -tolerance * (1.0 + to[0].abs() + to[1].abs())
            })
        })
    }

    /// The smallest convex set that holds two.
    pub(crate) fn hull(&mut self, a: Lines, b: Lines) -> Lines {
        let mut points = [&self.corners[a.corners()], &self.corners[b.corners()]].concat();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        points.dedup();
        if points.len() < 3 {
            return self.add(&points);
        }
        let first = self.corners.len();
        let corners = &mut self.corners;
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
        self.since(first)
    }

    /// Least and greatest slope of a set.
    pub(crate) fn slopes(&self, lines: Lines) -> (f64, f64) {
        let corners = self.corners[lines.corners()].iter();
        corners.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &[_, m]| (low.min(m), high.max(m)))
    }

    /// Area of a set in the dual plane: a measure of how many lines there are.
    pub(crate) fn measure(&self, lines: Lines) -> f64 {
        let corners = &self.corners[lines.corners()];
        corners.windows(2).map(|pair| cross(corners[0], pair[0], pair[1])).sum()
    }
}

/// Whether a further portal lies behind the first one.
fn is_behind(left: (f64, f64), right: (f64, f64)) -> bool {
    left.0 < -SLACK_M && right.0 < -SLACK_M
}

/// How far a line (s, m) passes a portal's left end on the wrong side, metres.
fn above(&[s, m]: &[f64; 2], left: (f64, f64)) -> f64 {
    s + m * left.0 - left.1 - SLACK_M
}

/// How far a line (s, m) passes a portal's right end on the wrong side, metres.
fn below(&[s, m]: &[f64; 2], right: (f64, f64)) -> f64 {
    right.1 - SLACK_M - s - m * right.0
}

fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Adds the corners of that part of a convex polygon where `excess` is not positive.
fn cut(corners: &[[f64; 2]], excess: impl Fn(&[f64; 2]) -> f64, kept: &mut Vec<[f64; 2]>) {
    let Some(mut a) = corners.first() else { return };
    let mut fa = excess(a);
    for b in corners[1..].iter().chain(&corners[..1]) {
        let fb = excess(b);
        if fa <= 0.0 {
            kept.push(*a);
        }
        if (fa < 0.0 && fb > 0.0) || (fa > 0.0 && fb < 0.0) {
            let t = fa / (fa - fb);
            kept.push([a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t]);
        }
        (a, fa) = (b, fb);
    }
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
        let mut sets = LineSets::default();
        let all = sets.all(&frame);
        let mut crossing = |lines, left, right| sets.through(lines, frame.local(left), frame.local(right));
        let ahead = crossing(all, at(30, 10), at(30, 0)).expect("straight on");
        assert!(crossing(ahead, at(60, 20), at(60, 11)).is_some(), "within the wedge");
        assert!(crossing(ahead, at(60, 40), at(60, 21)).is_none(), "beyond the wedge");
        assert!(crossing(ahead, at(60, 40), at(60, 20)).is_some(), "touching is seeing");
        assert!(crossing(all, at(-5, 0), at(-5, 10)).is_none(), "behind");
        assert!(sets.contains(all, ahead) && !sets.contains(ahead, all));
    }

    proptest! {
        #[test]
        fn lines_meet_what_they_lead_through(c in corners(), x in 1..40_i32, y in -40..40_i32, dx in -20..20_i32, dy in 1..40_i32) {
            let mut sets = LineSets::default();
            let lines = convex(&mut sets, c);
            let (left, right) = ((f64::from(x + dx), f64::from(y + dy)), (f64::from(x), f64::from(y)));
            prop_assert_eq!(sets.meet(lines, left, right), sets.through(lines, left, right).is_some());
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
            let mut sets = LineSets::default();
            let mut lines = sets.all(&frame);
            for i in 1..ys.len() {
                let (left, right) = frame_at(i);
                let next = sets.through(lines, frame.local(left), frame.local(right));
                prop_assert!(sets.meet(lines, frame.local(left), frame.local(right)));
                prop_assert!(next.is_some(), "lost at portal {}", i);
                lines = next.unwrap();
            }
        }

        #[test]
        fn a_hull_contains_both(a in corners(), b in corners()) {
            let mut sets = LineSets::default();
            let (a, b) = (convex(&mut sets, a), convex(&mut sets, b));
            let hull = sets.hull(a, b);
            prop_assert!(sets.contains(hull, a) && sets.contains(hull, b));
            prop_assert!(sets.measure(hull) >= sets.measure(a).max(sets.measure(b)) - 1e-9);
        }
    }

    fn convex(sets: &mut LineSets, points: Vec<[f64; 2]>) -> Lines {
        let points: Vec<Lines> = points.into_iter().map(|p| sets.add(&[p])).collect();
        points.into_iter().reduce(|a, b| sets.hull(a, b)).unwrap()
    }

    fn corners() -> impl Strategy<Value = Vec<[f64; 2]>> {
        proptest::collection::vec((-50.0..50.0_f64, -5.0..5.0_f64).prop_map(|(s, m)| [s, m]), 3..7)
    }
}
