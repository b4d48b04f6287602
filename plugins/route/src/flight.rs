//! A flown curve: centripetal Catmull-Rom (Yuksel, Schaefer and Keyser 2011), which passes through its points without loops
//! or cusps between them.

use glam::DVec3;

use crate::path::{Knot, Mark, Path};

/// Points nearer to each other than this are one, in metres.
const SAME_M: f64 = 0.01;
/// Where the flight turns by more than this about a point it stops there: cosine of 150°.
const REVERSAL_COS: f64 = -0.866_025_403_784_438_6;

/// The curve through the marks, cut where it turns back on itself.
pub(crate) fn fly(marks: &[Mark]) -> Vec<Path> {
    let mut points: Vec<Mark> = Vec::with_capacity(marks.len());
    for &mark in marks {
        if points.last().is_none_or(|last| last.at.distance(mark.at) >= SAME_M) {
            points.push(mark);
        }
    }
    let mut paths = Vec::new();
    let mut first = 0;
    for i in 1..points.len() {
        let turns_back = || {
            let (into, out) = (points[i].at - points[i - 1].at, points[i + 1].at - points[i].at);
            into.normalize().dot(out.normalize()) < REVERSAL_COS
        };
        if i + 1 == points.len() || turns_back() {
            paths.extend(curve(&points[first..=i]));
            first = i;
        }
    }
    paths
}

fn curve(points: &[Mark]) -> Option<Path> {
    let mut knots: Vec<Knot> = Vec::new();
    for i in 1..points.len() {
        let span =
            Span::new(points.get(i.wrapping_sub(2)).map(|m| m.at), points[i - 1].at, points[i].at, points.get(i + 1).map(|m| m.at));
        span.sample(points[i].leg, &mut knots);
    }
    Path::new(knots)
}

/// One cubic between two points, with derivatives by a parameter from 0 to 1.
struct Span {
    a: DVec3,
    b: DVec3,
    da: DVec3,
    db: DVec3,
}

/// Derivative of the spline at the middle of three points, by the parameter whose steps are the roots of the distances.
fn slope(before: DVec3, at: DVec3, after: DVec3) -> DVec3 {
    let (s, t) = ((at - before).length().sqrt(), (after - at).length().sqrt());
    (at - before) / s - (after - before) / (s + t) + (after - at) / t
}

impl Span {
    fn new(before: Option<DVec3>, a: DVec3, b: DVec3, after: Option<DVec3>) -> Self {
        let scale = (b - a).length().sqrt();
        let straight = (b - a) / scale;
        let da = before.map_or(straight, |p| slope(p, a, b)) * scale;
        let db = after.map_or(straight, |p| slope(a, b, p)) * scale;
        Self { a, b, da, db }
    }

    fn at(&self, x: f64) -> DVec3 {
        let (x2, x3) = (x * x, x * x * x);
        self.a + (self.b - self.a) * (3.0 * x2 - 2.0 * x3) + self.da * (x3 - 2.0 * x2 + x) + self.db * (x3 - x2)
    }

    fn first(&self, x: f64) -> DVec3 {
        let x2 = x * x;
        (self.b - self.a) * (6.0 * (x - x2)) + self.da * (3.0 * x2 - 4.0 * x + 1.0) + self.db * (3.0 * x2 - 2.0 * x)
    }

    fn second(&self, x: f64) -> DVec3 {
        (self.b - self.a) * (6.0 - 12.0 * x) + self.da * (6.0 * x - 4.0) + self.db * (6.0 * x - 2.0)
    }

    /// Curvature, 1/metres.
    fn bend(&self, x: f64) -> f64 {
        let (first, second) = (self.first(x), self.second(x));
        let speed = first.length();
        if speed > 1e-9 { first.cross(second).length() / (speed * speed * speed) } else { 1e3 }
    }

    /// Length from `x` to `y` by Gauss and Legendre's rule of three points.
    fn length(&self, x: f64, y: f64) -> f64 {
        let (middle, half) = ((x + y) / 2.0, (y - x) / 2.0);
        let side = 0.774_596_669_241_483_4 * half;
        let speed = |x: f64| self.first(x).length();
        half * (5.0 * speed(middle - side) + 8.0 * speed(middle) + 5.0 * speed(middle + side)) / 9.0
    }

    fn sample(&self, leg: u32, knots: &mut Vec<Knot>) {
        let pieces = libm::ceil(self.a.distance(self.b)).clamp(16.0, 256.0);
        let chord = (self.b - self.a).normalize_or_zero();
        let mut s = knots.pop().map_or(0.0, |k| k.s);
        for i in 0..=pieces as u32 {
            let x = f64::from(i) / pieces;
            let next = (x + 1.0 / pieces).min(1.0);
            let dir = self.first(x).normalize_or(chord);
            knots.push(Knot { s, at: self.at(x), dir, bend: self.bend(x).max(self.bend(next)), leg });
            s += self.length(x, next);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn marks(points: &[(f64, f64, f64)]) -> Vec<Mark> {
        points.iter().map(|&(x, y, z)| Mark { at: DVec3::new(x, y, z), leg: 0 }).collect()
    }

    #[test]
    fn two_points_are_a_straight_line_at_even_pace() {
        let path = &fly(&marks(&[(0.0, 0.0, 2.0), (30.0, 40.0, 2.0)]))[0];
        assert!((path.length() - 50.0).abs() < 1e-9);
        assert!(path.at(10.0).distance(DVec3::new(6.0, 8.0, 2.0)) < 1e-9);
    }

    #[test]
    fn a_flight_there_and_back_stops_where_it_turns() {
        assert_eq!(fly(&marks(&[(0.0, 0.0, 2.0), (30.0, 0.0, 2.0), (0.0, 0.0, 2.0)])).len(), 2);
        assert_eq!(fly(&marks(&[(0.0, 0.0, 2.0), (30.0, 0.0, 2.0), (30.0, 30.0, 2.0)])).len(), 1);
        assert!(fly(&marks(&[(0.0, 0.0, 2.0), (0.0, 0.0, 2.0)])).is_empty());
    }

    proptest! {
        #[test]
        fn a_flight_passes_its_points_and_its_length_is_true(
            points in proptest::collection::vec((-90.0..90.0, -90.0..90.0, 2.0..60.0f64), 2..7),
        ) {
            let points = marks(&points);
            let paths = fly(&points);
            for p in &points {
                let on = |path: &Path| path.knots().iter().map(|k| k.at.distance(p.at)).fold(f64::INFINITY, f64::min);
                prop_assert!(paths.iter().map(on).fold(f64::INFINITY, f64::min) < 0.02);
            }
            for path in &paths {
                // Pieces of 16 a span are short against any bend that centripetal curves make.
                let n = 2000;
                let step = path.length() / f64::from(n);
                for i in 0..n {
                    let moved = path.at(f64::from(i) * step).distance(path.at(f64::from(i + 1) * step));
                    prop_assert!(moved <= step * 1.02, "{moved} in {step}");
                }
                let walked: f64 = (0..n).map(|i| {
                    path.at(f64::from(i) * step).distance(path.at(f64::from(i + 1) * step))
                }).sum();
                prop_assert!((walked / path.length() - 1.0).abs() < 2e-3, "{walked} of {}", path.length());
            }
        }
    }
}
