//! Where streets meet: what fills the outside of the bend between two of them, and the rounding of kerbs.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec2;
use veduta_city::{GridPolygon, GridPos};

use super::band::{LEAST_PIECE_M, arc};

/// Largest radius of a kerb at a corner, metres.
const KERB_RADIUS_M: f64 = 6.0;
/// Kerbs are rounded at corners between these angles.
const ROUNDED: core::ops::Range<f64> = 20.0 * PI / 180.0..150.0 * PI / 180.0;
/// Share of the pavement's depth at a corner that the rounding of the kerb may take.
const MOST_OF_PAVEMENT: f64 = 0.5;
/// Share of an arm's first straight piece along which its kerbs may be rounded.
const MOST_OF_ARM: f64 = 0.45;
/// Roundings that begin less far from the corner are left out, metres.
const LEAST_ROUNDING_M: f64 = 0.25;

/// A band that leaves a node.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arm<T> {
    /// Away from the node.
    pub angle: f64,
    /// The same, of length 1.
    pub along: DVec2,
    /// Half-width at the node, metres.
    pub half_m: f64,
    /// Length of its first straight piece, metres.
    pub straight_m: f64,
    /// Width of the pavement beside it, metres.
    pub pavement_m: f64,
    /// What it is.
    pub what: T,
}

impl<T> Arm<T> {
    /// `None` if the line has no length.
    pub fn new(line: impl IntoIterator<Item = DVec2>, half_m: f64, pavement_m: f64, what: T) -> Option<Self> {
        let mut line = line.into_iter();
        let start = line.next()?;
        let (straight_m, along) =
            line.map(|p| p - start).find(|way| way.length() > LEAST_PIECE_M).map(|way| (way.length(), way.normalize()))?;
        Some(Self { angle: libm::atan2(along.y, along.x), along, half_m, straight_m, pavement_m, what })
    }

    fn left(&self) -> DVec2 {
        self.along.perp() * self.half_m
    }
}

/// The gaps between the arms of a node, counter-clockwise: the arm before, the one after, and the angle from one to the other
/// (more than half a turn: the outside of a bend). None for a single arm.
pub(super) fn gaps<T>(arms: &mut [Arm<T>]) -> impl Iterator<Item = (&Arm<T>, &Arm<T>, f64)> {
    arms.sort_by(|a, b| a.angle.total_cmp(&b.angle));
    let count = if arms.len() < 2 { 0 } else { arms.len() };
    let arms = &*arms;
    (0..count).map(move |i| {
        let (before, after) = (&arms[i], &arms[(i + 1) % arms.len()]);
        let turn = after.angle - before.angle;
        (before, after, if i + 1 == arms.len() { turn + TAU } else { turn })
    })
}

/// What fills the outside of the bend between two arms, from one's half-width to the other's; `None` where there is none.
pub(super) fn wedge<T>(node: DVec2, before: &Arm<T>, after: &Arm<T>, gap: f64) -> Option<GridPolygon> {
    if gap <= PI {
        return None;
    }
    let from = before.angle + FRAC_PI_2;
    let mut ring = vec![node];
    ring.extend(arc(node, (from, gap - PI), [before.half_m, after.half_m]));
    Some(snapped(ring))
}

/// The ground between two kerbs that a rounding with them as tangents cuts off their corner; `None` where there is no room for
/// one.
pub(super) fn rounding<T>(node: DVec2, before: &Arm<T>, after: &Arm<T>, gap: f64) -> Option<GridPolygon> {
    if !ROUNDED.contains(&gap) {
        return None;
    }
    // Where the left kerb of one meets the right kerb of the other: that far along either.
    let (sin, cos) = (libm::sin(gap), libm::cos(gap));
    let before_m = (after.half_m + before.half_m * cos) / sin;
    let after_m = (before.half_m + after.half_m * cos) / sin;
    let corner = node + before.left() + before.along * before_m;
    let half = libm::sin(gap / 2.0);
    let pavement_m = before.pavement_m.min(after.pavement_m);
    let radius_m = (MOST_OF_PAVEMENT * pavement_m / (1.0 - half)).min(KERB_RADIUS_M);
    let room = |arm: &Arm<T>, corner_m: f64| MOST_OF_ARM * arm.straight_m - corner_m;
    let tangent = libm::tan(gap / 2.0);
    let tangent_m = (radius_m / tangent).min(room(before, before_m)).min(room(after, after_m));
    if before_m < 0.0 || after_m < 0.0 || tangent_m < LEAST_ROUNDING_M {
        return None;
    }
    let radius_m = tangent_m * tangent;
    let centre = corner + (before.along + after.along).try_normalize()? * (radius_m / half);
    let mut ring = vec![corner];
    // From the tangent of one, clockwise about the centre.
    ring.extend(arc(centre, (before.angle - FRAC_PI_2, gap - PI), [radius_m; 2]));
    Some(snapped(ring))
}

fn snapped(ring: Vec<DVec2>) -> GridPolygon {
    let mut ring: Vec<GridPos> = ring.into_iter().map(GridPos::on_plan).collect();
    ring.dedup();
    GridPolygon::simple(ring)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arm(degrees: f64, half_m: f64) -> Arm<()> {
        let end = DVec2::from_angle(degrees.to_radians()) * 50.0;
        Arm::new([DVec2::ZERO, end], half_m, 2.0, ()).expect("it has length")
    }

    #[test]
    fn only_the_outside_of_a_bend_is_filled() {
        let mut arms = [arm(90.0, 3.0), arm(0.0, 3.0)];
        let wedges: Vec<_> = gaps(&mut arms).filter_map(|(a, b, gap)| wedge(DVec2::ZERO, a, b, gap)).collect();
        assert_eq!(wedges.len(), 1);
        let area = wedges[0].area_m2();
        assert!((0.9..1.0).contains(&(area / (PI * 9.0 / 4.0))), "a quarter of a disc: {area}");
        let mut arms = [arm(0.0, 3.0), arm(120.0, 2.0), arm(240.0, 5.0)];
        assert_eq!(gaps(&mut arms).filter_map(|(a, b, gap)| wedge(DVec2::ZERO, a, b, gap)).count(), 0);
        assert_eq!(gaps(&mut [arm(5.0, 3.0)]).count(), 0, "a blind alley ends flat");
    }

    #[test]
    fn a_rounding_touches_both_kerbs_and_leaves_half_of_the_pavement() {
        for gap in [25.0, 60.0, 90.0, 120.0, 145.0_f64] {
            let (a, b) = (arm(10.0, 3.0), arm(10.0 + gap, if gap > 130.0 { 3.0 } else { 4.0 }));
            let shape = rounding(DVec2::ZERO, &a, &b, gap.to_radians()).expect("there is room");
            assert!(shape.area_m2() > 0.0, "counter-clockwise at {gap}");
            let aside = |p: GridPos, arm: &Arm<()>, side: f64| arm.along.perp().dot(p.to_metres()) * side - arm.half_m;
            for &p in &shape.outer {
                let (by_a, by_b) = (aside(p, &a, 1.0), aside(p, &b, -1.0));
                assert!(by_a > -0.01 && by_b > -0.01, "it lies between the kerbs at {gap}: {by_a} {by_b}");
                assert!(by_a < 1.01 || by_b < 1.01, "pavement is left at {gap}: {by_a} {by_b}");
            }
            let on = |arm: &Arm<()>, side: f64| shape.outer.iter().filter(|&&p| aside(p, arm, side).abs() < 0.01).count();
            assert_eq!((on(&a, 1.0), on(&b, -1.0)), (2, 2), "corner and tangent at {gap}");
        }
        let mut short = arm(0.0, 3.0);
        short.straight_m = 6.0;
        assert_eq!(rounding(DVec2::ZERO, &short, &arm(90.0, 3.0), FRAC_PI_2), None);
    }
}
