//! Lines in a plane, with arcs drawn as chords.

use core::f64::consts::PI;

use glam::DVec2;
use veduta_city::monument::{Head, Hole, HoleShape, PathPoint};
use veduta_city::{GridPolygon, GridPos, metres};

use crate::mesh::outline::{Rings, area};
use crate::plan::boolean;

/// Ratios of a design are in these.
pub(super) const RATIO: f64 = 1024.0;

/// Fewest and most chords of a whole circle.
const CHORDS: (f64, f64) = (6.0, 48.0);

/// Number of chords of a circle that stay within a distance of it.
pub(super) fn chords(radius: f64, within_m: f64) -> usize {
    let ratio = (within_m / radius.abs().max(1e-9)).min(1.0);
    // An even number, so that both ends of a diameter are corners.
    let n = libm::ceil(PI / libm::acos(1.0 - ratio) / 2.0) * 2.0;
    n.clamp(CHORDS.0, CHORDS.1) as usize
}

/// A point of the design in metres.
pub(super) fn point(p: [i32; 2]) -> DVec2 {
    DVec2::new(metres(p[0]), metres(p[1]))
}

/// A line's points, arcs cut into chords; without the first again where it is closed.
pub(super) fn line(points: &[PathPoint<i32>], closed: bool, within_m: f64) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = Vec::with_capacity(points.len());
    for (i, p) in points.iter().enumerate() {
        let to = point(p.pos);
        let from = match i.checked_sub(1).or(closed.then(|| points.len() - 1)) {
            Some(before) => point(points[before].pos),
            None => to,
        };
        arc(from, to, f64::from(p.bulge.unwrap_or(0)) / RATIO, within_m, &mut out);
        out.push(to);
    }
    out.dedup_by(|a, b| a.distance_squared(*b) < 1e-8);
    if closed && out.len() > 1 && out[0].distance_squared(out[out.len() - 1]) < 1e-8 {
        out.pop();
    }
    out
}

/// The points between the ends of an arc.
fn arc(from: DVec2, to: DVec2, bulge: f64, within_m: f64, out: &mut Vec<DVec2>) {
    let chord = to - from;
    // Arcs that rise less than what chords may stay off are chords.
    if bulge.abs() * chord.length() / 2.0 < within_m.max(1e-6) {
        return;
    }
    let angle = 4.0 * libm::atan(bulge);
    let radius = chord.length() / (2.0 * libm::sin(angle / 2.0)).abs();
    // The middle lies on the left of the chord for arcs that turn left by less than half a circle.
    let middle = (from + to) / 2.0 + chord.perp() / chord.length() * radius * libm::cos(angle / 2.0) * bulge.signum();
    let n = libm::ceil(chords(radius, within_m) as f64 * angle.abs() / (2.0 * PI)).max(2.0) as usize;
    for i in 1..n {
        let turned = unit(angle * i as f64 / n as f64).rotate(from - middle);
        out.push(middle + turned);
    }
}

/// The unit vector at an angle from x towards y, radians.
pub(super) fn unit(radians: f64) -> DVec2 {
    DVec2::new(libm::cos(radians), libm::sin(radians))
}

/// An outline less the holes in it, and the holes: each with its outer ring counter-clockwise, those within it clockwise.
#[derive(Default)]
pub(super) struct Plate {
    pub(super) solid: Vec<Rings>,
    pub(super) open: Vec<Rings>,
}

/// Cuts holes out of an outline. They may overlap one another and reach over its edge.
pub(super) fn plate(outline: &[PathPoint<i32>], holes: &[Hole<i32>], within_m: f64) -> Plate {
    let mut outer = line(outline, true, within_m);
    if outer.len() < 3 || area(&outer).abs() < 1e-6 {
        return Plate::default();
    }
    if area(&outer) < 0.0 {
        outer.reverse();
    }
    let mut rings = vec![outer];
    for hole in holes {
        let mut ring = hole_outline(&hole.shape, within_m);
        if ring.len() < 3 || area(&ring).abs() < 1e-6 {
            continue;
        }
        if area(&ring) > 0.0 {
            ring.reverse();
        }
        each_place(hole, |place| rings.push(ring.iter().map(|&p| place.of(p)).collect()));
    }
    if are_apart(&rings) {
        let open = rings.iter().skip(1).map(|ring| vec![ring.iter().rev().copied().collect()]).collect();
        return Plate { solid: vec![rings], open };
    }
    let on_grid = |ring: &Vec<DVec2>| GridPolygon::simple(ring.iter().map(|&p| GridPos::from_metres(p)).collect());
    let grid: Vec<GridPolygon> = rings.iter().map(on_grid).collect();
    let (open, solid) = boolean::split(&boolean::rings(&grid[..1]), &boolean::rings(&grid[1..]));
    let metres = |polygons: Vec<GridPolygon>| polygons.iter().map(crate::mesh::outline::rings).filter(|r| !r.is_empty()).collect();
    Plate { solid: metres(solid), open: metres(open) }
}

/// Whether all holes lie within the outline, and none meets another.
fn are_apart(rings: &Rings) -> bool {
    let bounds = |ring: &Vec<DVec2>| ring.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |b, &p| (b.0.min(p), b.1.max(p)));
    let boxes: Vec<(DVec2, DVec2)> = rings.iter().map(bounds).collect();
    rings.iter().enumerate().skip(1).all(|(i, ring)| {
        let apart = |j: usize| {
            let (a, b) = (boxes[i], boxes[j]);
            let boxes_meet = a.0.cmple(b.1).all() && b.0.cmple(a.1).all();
            !boxes_meet || !do_meet(ring, &rings[j])
        };
        let is_inside = ring.first().is_some_and(|&p| crate::mesh::outline::contains(&rings[..1], p));
        is_inside && (0..i).all(apart) && (1..i).all(|j| !contains_any(&rings[j], ring) && !contains_any(ring, &rings[j]))
    })
}

fn contains_any(ring: &[DVec2], of: &[DVec2]) -> bool {
    of.first().is_some_and(|&p| crate::mesh::outline::contains(&[ring.to_vec()], p))
}

/// Whether two rings cross or touch.
fn do_meet(a: &[DVec2], b: &[DVec2]) -> bool {
    let edges =
        |ring: &[DVec2]| -> Vec<(DVec2, DVec2)> { (0..ring.len()).map(|i| (ring[i], ring[(i + 1) % ring.len()])).collect() };
    let side = |(p, q): (DVec2, DVec2), r: DVec2| (q - p).perp_dot(r - p);
    let others = edges(b);
    edges(a).into_iter().any(|e| {
        others.iter().any(|&f| {
            let grain = 1e-6;
            let (e0, e1, f0, f1) = (side(f, e.0), side(f, e.1), side(e, f.0), side(e, f.1));
            e0.min(e1) <= grain && e0.max(e1) >= -grain && f0.min(f1) <= grain && f0.max(f1) >= -grain && {
                let (lo, hi) = (e.0.min(e.1), e.0.max(e.1));
                let (flo, fhi) = (f.0.min(f.1), f.0.max(f.1));
                (lo - fhi).max_element() <= grain && (flo - hi).max_element() <= grain
            }
        })
    })
}

/// Where one of the holes of a repetition lies.
struct HolePlace {
    at: DVec2,
    /// The way its top looks: the image of (0, 1).
    up: DVec2,
}

impl HolePlace {
    fn of(&self, p: DVec2) -> DVec2 {
        self.at + DVec2::new(self.up.y, -self.up.x) * p.x + self.up * p.y
    }
}

fn each_place(hole: &Hole<i32>, mut each: impl FnMut(HolePlace)) {
    let (count, step) = hole.row.map_or((1, DVec2::ZERO), |(count, step)| (count, point(step)));
    for i in 0..count {
        let at = point(hole.at) + step * f64::from(i);
        let Some((count, radius)) = hole.around else {
            each(HolePlace { at, up: DVec2::Y });
            continue;
        };
        for k in 0..count {
            let up = unit(PI / 2.0 - 2.0 * PI * f64::from(k) / f64::from(count));
            each(HolePlace { at: at + up * metres(radius), up });
        }
    }
}

/// A hole's outline about its origin, counter-clockwise.
fn hole_outline(shape: &HoleShape<i32>, within_m: f64) -> Vec<DVec2> {
    match shape {
        HoleShape::Rect(width, height) => {
            let (half, height) = (metres(*width) / 2.0, metres(*height));
            vec![DVec2::new(-half, 0.0), DVec2::new(half, 0.0), DVec2::new(half, height), DVec2::new(-half, height)]
        }
        HoleShape::Arch(width, height, head) => arched(metres(*width), metres(*height), *head, within_m),
        HoleShape::Circle(radius) => {
            let n = chords(metres(*radius), within_m);
            (0..n).map(|i| unit(2.0 * PI * (i as f64 + 0.5) / n as f64) * metres(*radius)).collect()
        }
        HoleShape::Foil(radius, lobes) => foil(metres(*radius), (*lobes).max(2), within_m),
        HoleShape::Outline(outline) => line(outline, true, within_m),
    }
}

/// An opening with its foot on the origin.
fn arched(width: f64, height: f64, head: Head, within_m: f64) -> Vec<DVec2> {
    let half = width / 2.0;
    let spring = (height - head_rise(head) * half).max(0.0);
    let mut out = vec![DVec2::new(-half, 0.0), DVec2::new(half, 0.0)];
    // An even number, so that the crown is a corner.
    let n = (chords(half, within_m).max(8) / 2).next_multiple_of(2);
    if head == Head::Flat {
        out.extend([DVec2::new(half, height), DVec2::new(-half, height)]);
        return out;
    }
    let rise = height - spring;
    out.extend((0..=n).map(|i| {
        let t = libm::cos(PI * i as f64 / n as f64);
        DVec2::new(half * t, spring + rise * head_curve(head, t))
    }));
    // A head that springs from the foot begins and ends with its corners.
    let is_one = |a: DVec2, b: DVec2| a.distance_squared(b) < 1e-8;
    out.dedup_by(|a, b| is_one(*a, *b));
    if out.first().zip(out.last()).is_some_and(|(&a, &b)| is_one(a, b)) {
        out.pop();
    }
    out
}

/// Rise of a head over half its width.
const fn head_rise(head: Head) -> f64 {
    match head {
        Head::Flat => 0.0,
        Head::Round => 1.0,
        Head::Pointed => 1.732_050_807_568_877_2,
        Head::Segmental => 1.0 / 3.0,
    }
}

/// Height of a head's curve from 0 to 1 over −1 to 1.
pub(super) fn head_curve(head: Head, t: f64) -> f64 {
    let t = t.abs().min(1.0);
    match head {
        Head::Flat => 1.0,
        Head::Round => libm::sqrt(1.0 - t * t),
        Head::Pointed => libm::sqrt(4.0 - (1.0 + t) * (1.0 + t)) / head_rise(Head::Pointed),
        // A circle through (±1, 0) and (0, 1/3) has the radius 5/3.
        Head::Segmental => (libm::sqrt(25.0 / 9.0 - t * t) - 4.0 / 3.0) * 3.0,
    }
}

/// Circles side by side about a middle, within a radius.
fn foil(radius: f64, lobes: i32, within_m: f64) -> Vec<DVec2> {
    let step = 2.0 * PI / f64::from(lobes);
    // Cusps lie at 0.45 of the radius, or farther out where so many circles side by side would cross again.
    let (sin, cos) = (libm::sin(step / 2.0), libm::cos(step / 2.0));
    let out = (cos / (1.0 + sin) + 0.01).max(0.45);
    let cusp = |k: i32| unit(PI / 2.0 + step * (f64::from(k) - 0.5)) * radius * out;
    let half_chord = cusp(0).distance(cusp(1)) / 2.0;
    let middle = (cusp(0) + cusp(1)).length() / 2.0;
    let bulge = (radius - middle) / half_chord.max(1e-6);
    let mut out = Vec::new();
    for k in 0..lobes {
        arc(cusp(k), cusp(k + 1), bulge, within_m, &mut out);
        out.push(cusp(k + 1));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64, bulge: f64) -> PathPoint<i32> {
        let pos = [x, y].map(|n| (n * 1024.0) as i32);
        PathPoint { pos, bulge: (bulge != 0.0).then_some((bulge * RATIO) as i32) }
    }

    #[test]
    fn half_a_circle_bulges_out_of_the_outline() {
        // Counter-clockwise: the right side bulges to the right.
        let points = line(&[at(0.0, 0.0, 0.0), at(2.0, 0.0, 0.0), at(2.0, 4.0, 1.0), at(0.0, 4.0, 0.0)], true, 0.01);
        let right = points.iter().map(|p| p.x).fold(0.0, f64::max);
        assert!((right - 4.0).abs() < 0.02, "{right}");
        let expected = 8.0 + PI * 4.0 / 2.0;
        assert!((area(&points) - expected).abs() < 0.05, "{} for {expected}", area(&points));
    }

    #[test]
    fn the_first_point_of_a_ring_may_come_in_an_arc() {
        let points = line(&[at(1.0, 0.0, 1.0), at(-1.0, 0.0, 1.0)], true, 0.001);
        assert!((area(&points) - PI).abs() < 0.02, "{}", area(&points));
    }

    #[test]
    fn heads_begin_at_their_springs_and_end_at_the_crown() {
        for head in [Head::Round, Head::Pointed, Head::Segmental] {
            assert!((head_curve(head, 0.0) - 1.0).abs() < 1e-9 && head_curve(head, 1.0).abs() < 1e-9, "{head:?}");
            for width in [0.3, 0.5, 0.6, 1.0, 1.5, 2.0, 7.0] {
                let outline = arched(width, 5.0, head, 0.01);
                let top = outline.iter().copied().fold(DVec2::ZERO, |top, p| if p.y > top.y { p } else { top });
                assert!((top - DVec2::new(0.0, 5.0)).length() < 1e-9, "{head:?} {width}: {top}");
                // Foot to spring, and no corner twice.
                let spring = 5.0 - head_rise(head) * width / 2.0;
                assert!(area(&outline) > width * spring.max(0.0), "{head:?} {width}: {}", area(&outline));
                assert!(edges(&outline).all(|(a, b)| a.distance(b) > 1e-4), "{head:?} {width}");
            }
        }
    }

    #[test]
    fn foils_do_not_cross_themselves() {
        for lobes in 2..=24 {
            let outline = foil(1.0, lobes, 0.005);
            let all: Vec<(DVec2, DVec2)> = edges(&outline).collect();
            for (i, &(a, b)) in all.iter().enumerate() {
                let apart = all.iter().enumerate().skip(i + 2).filter(|(j, _)| (j + 1) % all.len() != i);
                for (_, &(c, d)) in apart {
                    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p) > 0.0;
                    let do_cross = side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b);
                    assert!(!do_cross, "{lobes} lobes: {a} to {b} crosses {c} to {d}");
                }
            }
            let reach = outline.iter().map(|p| p.length()).fold(0.0, f64::max);
            assert!(area(&outline) > 0.9 && (reach - 1.0).abs() < 0.01, "{lobes} lobes: {} {reach}", area(&outline));
        }
    }

    fn edges(ring: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> {
        ring.iter().copied().zip(ring.iter().copied().cycle().skip(1))
    }

    #[test]
    fn holes_go_round_with_their_tops_outwards() {
        let hole = Hole { at: [0, 0], shape: HoleShape::Arch(512, 1024, Head::Pointed), row: None, around: Some((4, 2048)) };
        let outline = [at(-5.0, -5.0, 0.0), at(5.0, -5.0, 0.0), at(5.0, 5.0, 0.0), at(-5.0, 5.0, 0.0)];
        let plate = plate(&outline, &[hole], 0.01);
        assert_eq!((plate.solid.len(), plate.solid[0].len(), plate.open.len()), (1, 5, 4));
        for ring in &plate.solid[0][1..] {
            let (near, far) = ring.iter().fold((9.0, 0.0), |(n, f): (f64, f64), p| (n.min(p.length()), f.max(p.length())));
            assert!(area(ring) < 0.0 && (near - 2.0).abs() < 0.1 && (far - 3.0).abs() < 0.01, "{near} {far}");
        }
    }

    #[test]
    fn holes_may_meet_each_other_and_the_edge() {
        let outline = [at(0.0, 0.0, 0.0), at(6.0, 0.0, 0.0), at(6.0, 4.0, 0.0), at(0.0, 4.0, 0.0)];
        let rect = |x: f64, z: f64, w: i32, h: i32| Hole {
            at: [(x * 1024.0) as i32, (z * 1024.0) as i32],
            shape: HoleShape::Rect(w * 1024, h * 1024),
            row: None,
            around: None,
        };
        // A door on the ground, two windows that overlap, and one within another.
        let holes = [rect(1.0, 0.0, 1, 2), rect(3.0, 1.0, 1, 1), rect(3.5, 1.0, 1, 1), rect(5.0, 1.0, 1, 2), rect(5.0, 1.5, 1, 1)];
        let plate = plate(&outline, &holes, 0.01);
        let sum = |all: &[Rings]| all.iter().flatten().map(|ring| area(ring)).sum::<f64>();
        assert!((sum(&plate.open) - (2.0 + 1.5 + 2.0)).abs() < 1e-9, "{}", sum(&plate.open));
        assert!((sum(&plate.solid) - (24.0 - 5.5)).abs() < 1e-9, "{}", sum(&plate.solid));
    }
}
