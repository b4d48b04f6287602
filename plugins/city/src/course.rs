use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::{GRID_PER_METRE, GridPos, metres};

/// A line that ground is laid along: the middle of a street on its way through crossroads, or the front of a square.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Course {
    /// Two vertices or more.
    pub line: Vec<GridPos>,
    /// How much of the line lies before its first vertex, grid steps; whole [`Course::REPEAT`]s are left out.
    #[serde(default)]
    pub from: i32,
}

/// Mitres lean at most so far.
const STEEPEST: f64 = 1.5;
/// Inside of a bend, at least this share of a piece's length is left.
const LEAST_SHARE: f64 = 0.2;

impl Course {
    /// A whole number of repeats of every ground tile, grid steps.
    pub const REPEAT: i32 = 16 * GRID_PER_METRE;
    /// Most vertices of all courses of a cell.
    pub const MOST_VERTICES: usize = 1 << 13;

    /// Where a place lies along the line and to the left of it, metres: continuous also over bends, where both pieces have their mitre
    /// in common. `None` if the line has no length.
    #[must_use]
    pub fn place(&self, p: DVec2) -> Option<DVec2> {
        let i = self.nearest(p)?;
        let gone: f64 = self.line[..=i].windows(2).map(|pair| length(pair[0], pair[1])).sum();
        let (a, b) = (self.line[i].to_metres(), self.line[i + 1].to_metres());
        let (reach, along) = (a.distance(b), way(self.line[i], self.line[i + 1])?);
        let (x, aside) = (along.dot(p - a), along.perp_dot(p - a));
        // Where the mitres at both ends cut the parallel through the place.
        let start = aside * self.lean(i, along);
        let end = reach + aside * self.lean(i + 1, along);
        let share = (x - start) / (end - start).max(LEAST_SHARE * reach);
        Some(DVec2::new(metres(self.from) + gone + reach * share, aside))
    }

    /// The piece that lies nearest to a place, by the vertex before it; `None` if no piece has a length.
    #[must_use]
    pub fn nearest(&self, p: DVec2) -> Option<usize> {
        let distance = |pair: &[GridPos]| {
            let (a, b) = (pair[0].to_metres(), pair[1].to_metres());
            let share = ((p - a).dot(b - a) / a.distance_squared(b)).clamp(0.0, 1.0);
            p.distance_squared(a.lerp(b, share))
        };
        let pieces = self.line.windows(2).enumerate().filter(|(_, pair)| pair[0] != pair[1]);
        pieces.map(|(i, pair)| (i, distance(pair))).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
    }

    /// Its pieces from one to another, by the vertices before them, and one more on each side for the mitres there.
    #[must_use]
    pub fn part(&self, first: usize, last: usize) -> Self {
        let from = first.saturating_sub(1).min(self.line.len());
        let to = last.saturating_add(3).min(self.line.len()).max(from);
        let gone: f64 = self.line[..(from + 1).min(self.line.len())].windows(2).map(|pair| length(pair[0], pair[1])).sum();
        let repeat = metres(Self::REPEAT);
        let rest = gone - libm::floor(gone / repeat) * repeat;
        Self { line: self.line[from..to].to_vec(), from: (self.from + GridPos::steps(rest)).rem_euclid(Self::REPEAT) }
    }

    /// How far the mitre at a vertex leans along a piece that ends there, a metre to its left.
    fn lean(&self, vertex: usize, along: DVec2) -> f64 {
        let at = |i: usize| self.line.get(i).copied();
        let before = vertex.checked_sub(1).and_then(|before| way(at(before)?, at(vertex)?));
        let after = at(vertex).zip(at(vertex + 1)).and_then(|(a, b)| way(a, b));
        let (Some(before), Some(after)) = (before, after) else { return 0.0 };
        let mitre = before.perp() + after.perp();
        let out = along.perp().dot(mitre);
        if out.abs() < 1e-6 { 0.0 } else { (mitre.dot(along) / out).clamp(-STEEPEST, STEEPEST) }
    }
}

fn length(a: GridPos, b: GridPos) -> f64 {
    let way = b.to_metres() - a.to_metres();
    libm::sqrt(way.length_squared())
}

fn way(a: GridPos, b: GridPos) -> Option<DVec2> {
    let reach = length(a, b);
    (reach > 0.0).then(|| (b.to_metres() - a.to_metres()) / reach)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn course(points: &[(f64, f64)]) -> Course {
        Course { line: points.iter().map(|&(x, y)| GridPos::from_metres(DVec2::new(x, y))).collect(), from: 0 }
    }

    fn place(course: &Course, x: f64, y: f64) -> DVec2 {
        course.place(DVec2::new(x, y)).expect("it has length")
    }

    #[test]
    fn a_straight_course_is_measured_along_and_to_the_left() {
        let course = course(&[(10.0, 0.0), (10.0, 50.0)]);
        assert_eq!(place(&course, 7.0, 20.0), DVec2::new(20.0, 3.0));
        assert_eq!(place(&course, 12.0, -5.0), DVec2::new(-5.0, -2.0));
        assert_eq!(Course::default().place(DVec2::ZERO), None);
    }

    #[test]
    fn nothing_jumps_where_it_bends() {
        let course = course(&[(0.0, 0.0), (30.0, 0.0), (50.0, 12.0), (60.0, 40.0), (58.0, 60.0)]);
        for aside in [-4.0, -1.5, 0.0, 2.0, 4.0] {
            for (i, &corner) in course.line.iter().enumerate().skip(1).take(3) {
                let p = corner.to_metres();
                let [before, after] =
                    [way(course.line[i - 1], course.line[i]), way(course.line[i], course.line[i + 1])].map(Option::unwrap);
                let mitre = (before.perp() + after.perp()).normalize();
                let at = p + mitre * aside;
                let step = (before + after).normalize() * 0.001;
                let (low, high) = (course.place(at - step).unwrap(), course.place(at + step).unwrap());
                assert!(low.distance(high) < 0.01, "bend {i}, {aside} m aside: {low} {high}");
                assert!((low.x..=high.x).contains(&(place(&course, p.x, p.y).x)), "all of a mitre lies as far along");
            }
        }
    }

    #[test]
    fn a_part_tells_the_same_but_for_whole_repeats() {
        let whole = course(&[(0.0, 0.0), (30.0, 0.0), (50.0, 12.0), (60.0, 40.0), (58.0, 60.0), (40.0, 90.0)]);
        for (first, last) in [(0, 0), (1, 2), (2, 3), (4, 4)] {
            let part = whole.part(first, last);
            assert!(part.line.len() <= last - first + 4);
            for pair in whole.line[first..=last + 1].windows(2) {
                let p = pair[0].to_metres().lerp(pair[1].to_metres(), 0.4) + DVec2::new(0.6, -0.8);
                let (a, b) = (whole.place(p).unwrap(), part.place(p).unwrap());
                let repeat = f64::from(Course::REPEAT) / 1024.0;
                let apart = (a.x - b.x).rem_euclid(repeat);
                assert!(apart.min(repeat - apart) < 0.002 && (a.y - b.y).abs() < 1e-9, "{a} {b}");
            }
        }
    }
}
