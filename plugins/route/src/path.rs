//! A smooth path in space, measured along its own length.

use glam::{DVec2, DVec3, swizzles::Vec3Swizzles};

use crate::FreeLine;

/// Furthest that a rounded corner leaves the corner, in metres.
pub const CORNER_M: f64 = 0.6;
/// Greatest radius of a rounded corner, in metres.
const RADIUS_M: f64 = 8.0;
/// Vertices of a way that lie within this of the line through their neighbours are left out, in metres.
const STRAIGHTEN_M: f64 = 0.2;
/// Turns sharper than this (150°) are made standing: radians.
const REVERSAL: f64 = 150.0 * core::f64::consts::PI / 180.0;

/// A point of a path.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Knot {
    /// Distance along the path, metres.
    pub s: f64,
    /// Plan metres and eye height.
    pub at: DVec3,
    /// Unit tangent.
    pub dir: DVec3,
    /// Curvature from here to the next knot, 1/metres.
    pub bend: f64,
    /// The leg from here on.
    pub leg: u32,
}

/// A curve through knots, between them a cubic whose parameter is the length along it (to about 1e-5).
#[derive(Debug, Clone)]
pub(crate) struct Path {
    knots: Vec<Knot>,
}

/// A vertex of a way, and the leg that leads to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mark {
    pub at: DVec3,
    pub leg: u32,
}

impl Path {
    /// A path of at least two knots in order; `None` if there are fewer or it has no length.
    pub fn new(knots: Vec<Knot>) -> Option<Self> {
        let path = Self { knots };
        (path.length() > 0.0 && path.length().is_finite()).then_some(path)
    }

    pub fn length(&self) -> f64 {
        self.knots.last().map_or(0.0, |k| k.s)
    }

    pub fn knots(&self) -> &[Knot] {
        &self.knots
    }

    fn around(&self, s: f64) -> Option<(&Knot, &Knot)> {
        let after = self.knots.partition_point(|k| k.s <= s).clamp(1, self.knots.len().saturating_sub(1).max(1));
        self.knots.get(after - 1).zip(self.knots.get(after))
    }

    /// The point at a distance along the path; clamps.
    pub fn at(&self, s: f64) -> DVec3 {
        let Some((a, b)) = self.around(s) else { return DVec3::ZERO };
        let span = b.s - a.s;
        let x = if span > 0.0 { ((s - a.s) / span).clamp(0.0, 1.0) } else { 1.0 };
        let (x2, x3) = (x * x, x * x * x);
        let rise = (x3 - 2.0 * x2 + x) * span;
        let fall = (x3 - x2) * span;
        a.at + (b.at - a.at) * (3.0 * x2 - 2.0 * x3) + a.dir * rise + b.dir * fall
    }

    /// The unit tangent at the path's end.
    pub fn end_dir(&self) -> DVec3 {
        self.knots.last().map_or(DVec3::Y, |k| k.dir)
    }

    /// From the point at `s` to the point `reach` further on; the path goes on straight beyond its end.
    pub fn ahead(&self, s: f64, reach: f64) -> DVec3 {
        let beyond = (s + reach - self.length()).max(0.0);
        self.at(s + reach) + self.end_dir() * beyond - self.at(s)
    }
}

/// Rounds a walked polyline: arcs in place of corners, at most [`CORNER_M`] away from them; about 1.4 m in radius at right
/// angles. Where the way turns back on itself the path ends and another begins. Corners are cut less where that would not be
/// free.
pub(crate) fn round_corners(marks: &[Mark], free: Option<FreeLine<'_>>) -> Vec<Path> {
    let marks = straighten(marks);
    let mut paths = Vec::new();
    let mut first = 0;
    for i in 1..marks.len() {
        let is_end = i + 1 == marks.len() || turn(&marks[i - 1..=i + 1]) > REVERSAL;
        if is_end {
            paths.extend(rounded(&marks[first..=i], free));
            first = i;
        }
    }
    paths
}

/// Leaves out repeated vertices, and those that make no difference; ends of legs stay.
fn straighten(marks: &[Mark]) -> Vec<Mark> {
    let mut different: Vec<Mark> = Vec::with_capacity(marks.len());
    for &mark in marks {
        match different.last_mut() {
            Some(last) if last.at.distance(mark.at) < 0.01 => {}
            _ => different.push(mark),
        }
    }
    let mut kept = Vec::with_capacity(different.len());
    let mut from = 0;
    for i in 0..different.len() {
        let leg_ends = different.get(i + 1).is_none_or(|next| next.leg != different[i].leg) && i > 0;
        if leg_ends {
            thin(&different[from..=i], &mut kept);
            from = i;
        }
    }
    kept.extend(different.last());
    kept
}

/// Douglas and Peucker (1973), without recursion: everything that matters but the last.
fn thin(line: &[Mark], kept: &mut Vec<Mark>) {
    let mut keep = vec![false; line.len()];
    let mut spans = vec![(0, line.len() - 1)];
    while let Some((a, b)) = spans.pop() {
        keep[a] = true;
        let off = |i: usize| {
            let (nearest, _) = crate::net::nearest_on(line[a].at.xy(), line[b].at.xy(), line[i].at.xy());
            nearest.distance(line[i].at.xy())
        };
        let furthest = (a + 1..b).map(|i| (off(i), i)).max_by(|x, y| x.0.total_cmp(&y.0));
        if let Some((off, i)) = furthest
            && off > STRAIGHTEN_M
        {
            spans.extend([(a, i), (i, b)]);
        }
    }
    kept.extend(line.iter().zip(&keep).take(line.len() - 1).filter(|(_, k)| **k).map(|(m, _)| *m));
}

/// The angle between the ways into and out of the middle one of three, radians, 0 to π.
fn turn(three: &[Mark]) -> f64 {
    let (into, out) = ((three[1].at - three[0].at).xy(), (three[2].at - three[1].at).xy());
    angle(into, out).abs()
}

fn angle(a: DVec2, b: DVec2) -> f64 {
    libm::atan2(a.perp_dot(b), a.dot(b))
}

/// A polyline without reversals as a path of straights and arcs.
fn rounded(marks: &[Mark], free: Option<FreeLine<'_>>) -> Option<Path> {
    let mut pen = Pen { knots: Vec::new(), free };
    let first = marks.first()?;
    let second = marks.get(1)?;
    pen.straight_to(first.at, (second.at - first.at).normalize_or_zero(), second.leg);
    for i in 1..marks.len() - 1 {
        let share = |a: usize, b: usize| {
            let whole = a == 0 || b + 1 == marks.len();
            marks[a].at.distance(marks[b].at) * if whole { 1.0 } else { 0.5 }
        };
        pen.corner(&marks[i - 1], &marks[i], &marks[i + 1], share(i - 1, i).min(share(i, i + 1)));
    }
    let last = marks[marks.len() - 1];
    let before = marks[marks.len() - 2];
    pen.straight_to(last.at, (last.at - before.at).normalize_or_zero(), last.leg);
    Path::new(pen.knots)
}

struct Pen<'a> {
    knots: Vec<Knot>,
    free: Option<FreeLine<'a>>,
}

impl Pen<'_> {
    fn straight_to(&mut self, at: DVec3, dir: DVec3, leg: u32) {
        let s = self.knots.last().map_or(0.0, |k| k.s + k.at.distance(at));
        self.push(Knot { s, at, dir, bend: 0.0, leg });
    }

    /// Two knots at one place would be a cubic without length.
    fn push(&mut self, knot: Knot) {
        match self.knots.last_mut() {
            Some(last) if knot.s - last.s < 1e-6 => {
                *last = Knot { s: last.s, ..knot };
            }
            _ => self.knots.push(knot),
        }
    }

    /// An arc that touches both lines, at most `room` metres from the corner.
    fn corner(&mut self, before: &Mark, corner: &Mark, after: &Mark, room: f64) {
        let into = (corner.at - before.at).xy().normalize_or_zero();
        let out = (after.at - corner.at).xy().normalize_or_zero();
        let turn = angle(into, out);
        let half = turn.abs() / 2.0;
        let cos = libm::cos(half);
        if half < 5e-4 || cos <= 0.0 {
            return self.straight_to(corner.at, ((into + out) / 2.0).normalize_or(into).extend(0.0), after.leg);
        }
        let widest = (CORNER_M * cos / (1.0 - cos)).min(RADIUS_M).min(room / libm::tan(half));
        let reach = |radius: f64| radius * libm::tan(half);
        let is_free = |radius: &f64| {
            let (from, to) = (corner.at.xy() - into * reach(*radius), corner.at.xy() + out * reach(*radius));
            self.free.is_none_or(|free| free(from, to))
        };
        // The arc lies between the corner and the line that cuts it off.
        let radius = [1.0, 0.5, 0.25].map(|share| widest * share).into_iter().find(is_free).unwrap_or(widest / 8.0);
        let touch = corner.at.xy() - into * reach(radius);
        let side = into.perp() * turn.signum();
        let centre = touch + side * radius;
        let pieces = 2 * libm::ceil(half / 0.2).max(1.0) as u32;
        self.straight_to(touch.extend(corner.at.z), into.extend(0.0), corner.leg);
        let begin = self.knots.last().map_or(0.0, |k| k.s);
        if let Some(last) = self.knots.last_mut() {
            last.bend = 1.0 / radius;
        }
        for piece in 1..=pieces {
            let share = f64::from(piece) / f64::from(pieces);
            let along = turn * share;
            let (sin, cos) = (libm::sin(along), libm::cos(along));
            let dir = into * cos + into.perp() * sin;
            let at = centre - (side * cos - into * (sin * turn.signum())) * radius;
            let bend = if piece == pieces { 0.0 } else { 1.0 / radius };
            let leg = if 2 * piece >= pieces { after.leg } else { corner.leg };
            let s = begin + radius * turn.abs() * share;
            self.push(Knot { s, at: at.extend(corner.at.z), dir: dir.extend(0.0), bend, leg });
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn marks(points: &[(f64, f64)]) -> Vec<Mark> {
        points.iter().map(|&(x, y)| Mark { at: DVec3::new(x, y, 1.65), leg: 0 }).collect()
    }

    fn distance_to(line: &[Mark], p: DVec2) -> f64 {
        let near = |w: &[Mark]| crate::net::nearest_on(w[0].at.xy(), w[1].at.xy(), p).0.distance(p);
        line.windows(2).map(near).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn a_right_angle_becomes_an_arc_of_about_a_metre_and_a_half() {
        let paths = round_corners(&marks(&[(0.0, 0.0), (20.0, 0.0), (20.0, 20.0)]), None);
        let [path] = paths.as_slice() else { panic!("one path, not {}", paths.len()) };
        let bend = path.knots().iter().map(|k| k.bend).fold(0.0, f64::max);
        assert!((1.0 / bend - 1.448).abs() < 1e-3, "radius {}", 1.0 / bend);
        let nearest = (0..4000).map(|i| path.at(f64::from(i) * 0.01).xy().distance(DVec2::new(20.0, 0.0)));
        assert!((nearest.fold(f64::INFINITY, f64::min) - CORNER_M).abs() < 1e-3);
        assert_eq!(path.at(0.0), DVec3::new(0.0, 0.0, 1.65));
        assert!(path.at(1e9).distance(DVec3::new(20.0, 20.0, 1.65)) < 1e-9, "clamps");
    }

    #[test]
    fn a_corner_is_cut_less_where_a_wall_stands_in_it() {
        let line = marks(&[(0.0, 0.0), (20.0, 0.0), (20.0, 20.0)]);
        // Free only within 0.6 m of the corner; the widest arc's chord passes 1.02 m from it, half as wide a one's 0.51 m.
        let free = |a: DVec2, b: DVec2| ((a + b) / 2.0).distance(DVec2::new(20.0, 0.0)) < 0.6;
        let path = &round_corners(&line, Some(&free))[0];
        let nearest = path.knots().iter().map(|k| k.at.xy().distance(DVec2::new(20.0, 0.0)));
        assert!((nearest.fold(f64::INFINITY, f64::min) - CORNER_M / 2.0).abs() < 1e-3);
    }

    #[test]
    fn a_way_that_turns_back_is_cut_there() {
        let paths = round_corners(&marks(&[(0.0, 0.0), (10.0, 0.0), (1.0, 0.5), (1.0, 9.0)]), None);
        assert_eq!(paths.len(), 2);
        assert_eq!(paths[0].at(99.0), paths[1].at(0.0));
    }

    #[test]
    fn nothing_to_walk_is_no_path() {
        assert!(round_corners(&[], None).is_empty());
        assert!(round_corners(&marks(&[(1.0, 1.0)]), None).is_empty());
        assert!(round_corners(&marks(&[(1.0, 1.0), (1.0, 1.0)]), None).is_empty());
    }

    #[test]
    fn a_leg_changes_at_the_middle_of_its_corner() {
        let mut line = marks(&[(0.0, 0.0), (20.0, 0.0), (20.0, 20.0)]);
        line[2].leg = 1;
        let path = &round_corners(&line, None)[0];
        let change = path.knots().iter().find(|k| k.leg == 1).expect("two legs");
        assert!((change.s - path.length() / 2.0).abs() < 1e-9);
    }

    proptest! {
        #[test]
        fn a_rounded_way_keeps_to_the_way_and_runs_at_unit_speed(
            points in proptest::collection::vec((-60.0..60.0, -60.0..60.0f64), 2..9),
        ) {
            let line = marks(&points);
            for path in round_corners(&line, None) {
                let n = 400;
                let step = path.length() / f64::from(n);
                for i in 0..n {
                    let s = f64::from(i) * step;
                    let (a, b) = (path.at(s), path.at(s + step));
                    let off = distance_to(&line, a.xy());
                    prop_assert!(off <= CORNER_M + STRAIGHTEN_M + 0.01, "{off} m off the way");
                    prop_assert!(a.distance(b) <= step * (1.0 + 1e-4), "{} in {step}", a.distance(b));
                }
                for w in path.knots().windows(2) {
                    prop_assert!(w[1].s > w[0].s);
                    prop_assert!((w[1].dir.length() - 1.0).abs() < 1e-9);
                    prop_assert!(w[0].dir.dot(w[1].dir) > 0.9, "no kink: {:?} {:?}", w[0], w[1]);
                }
            }
        }
    }
}
