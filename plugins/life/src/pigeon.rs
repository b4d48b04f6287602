//! The body of a pigeon, and a flock of them as one mesh.

use core::f32::consts::{PI, TAU};

use bevy::math::{Vec2, Vec3, Vec4};
use bevy::prelude::*;
use veduta_city::Rgb;

use crate::bird::Pose;
use crate::sculpt::{Point, Sculpt};

/// A ring of the body: along it and up, metres; half its width and height; how much it belongs to the head.
struct Ring {
    z: f32,
    y: f32,
    half: Vec2,
    head: f32,
    colour: Rgb,
}

const BLUE: Rgb = Rgb(0x8C, 0x94, 0xA0);
const SLATE: Rgb = Rgb(0x55, 0x5E, 0x6C);
const NECK: Rgb = Rgb(0x4C, 0x56, 0x5C);
const HORN: Rgb = Rgb(0x3A, 0x38, 0x38);
const CORAL: Rgb = Rgb(0xB4, 0x4A, 0x42);
const WING: Rgb = Rgb(0x98, 0xA0, 0xAB);
const TAIL: Rgb = Rgb(0x6C, 0x73, 0x7F);
const AMBER: Rgb = Rgb(0xD8, 0x7A, 0x2A);

/// From the rump to the tip of the beak.
const fn rings() -> [Ring; 13] {
    const fn ring(z: f32, y: f32, (x, h): (f32, f32), head: f32, colour: Rgb) -> Ring {
        Ring { z, y, half: Vec2::new(x, h), head, colour }
    }
    [
        ring(-0.125, 0.081, (0.012, 0.008), 0.0, TAIL),
        ring(-0.100, 0.085, (0.027, 0.021), 0.0, BLUE),
        ring(-0.060, 0.092, (0.046, 0.040), 0.0, BLUE),
        ring(-0.020, 0.099, (0.057, 0.053), 0.0, BLUE),
        ring(0.020, 0.107, (0.060, 0.058), 0.0, BLUE),
        ring(0.055, 0.121, (0.051, 0.052), 0.05, SLATE),
        ring(0.075, 0.145, (0.036, 0.038), 0.30, NECK),
        ring(0.084, 0.172, (0.026, 0.027), 0.70, NECK),
        ring(0.091, 0.194, (0.0245, 0.0245), 1.0, SLATE),
        ring(0.103, 0.212, (0.024, 0.021), 1.0, SLATE),
        ring(0.122, 0.215, (0.017, 0.016), 1.0, SLATE),
        ring(0.133, 0.209, (0.007, 0.008), 1.0, HORN),
        ring(0.153, 0.201, (0.001, 0.002), 1.0, HORN),
    ]
}

const SIDES: usize = 9;
/// Parts as the shader knows them.
const BODY: f32 = 0.0;
const WINGS: [(f32, f32); 2] = [(1.0, 1.0), (2.0, -1.0)];
const LEGS: [(f32, f32); 2] = [(3.0, 1.0), (4.0, -1.0)];

fn linear(colour: Rgb, plumage: f32) -> Vec4 {
    let [r, g, b] = colour.to_linear();
    Vec4::new(r, g, b, plumage)
}

/// Adds a pigeon that takes the pose of a number.
fn add(sculpt: &mut Sculpt, number: f32) {
    body(sculpt, number);
    tail(sculpt, number);
    for (part, side) in WINGS {
        wing(sculpt, Vec2::new(number, part), side);
    }
    for (part, side) in LEGS {
        leg(sculpt, Vec2::new(number, part), side);
    }
    eyes(sculpt, number);
}

fn body(sculpt: &mut Sculpt, number: f32) {
    let rings = rings();
    let middle = |n: usize| Vec2::new(rings[n].z, rings[n].y);
    let points = (0..rings.len()).flat_map(|n| {
        let ring = &rings[n];
        let way = (middle((n + 1).min(rings.len() - 1)) - middle(n.saturating_sub(1))).normalize_or(Vec2::X);
        let taper = {
            let (a, b) = (&rings[n.saturating_sub(1)], &rings[(n + 1).min(rings.len() - 1)]);
            (b.half.x - a.half.x) / middle((n + 1).min(rings.len() - 1)).distance(middle(n.saturating_sub(1))).max(1e-3)
        };
        // Rings stand across the spine.
        let up = Vec3::new(0.0, way.x, -way.y);
        let along = Vec3::new(0.0, way.y, way.x);
        (0..=SIDES).map(move |side| {
            let (sin, cos) = (-TAU * side as f32 / SIDES as f32).sin_cos();
            let out = Vec3::X * sin * ring.half.x + up * cos * ring.half.y;
            let normal = (Vec3::X * sin / ring.half.x.max(1e-3) + up * cos / ring.half.y.max(1e-3)).normalize_or(up);
            let belly = if cos < -0.4 { 0.82 } else { 1.0 };
            Point {
                at: Vec3::new(0.0, ring.y, ring.z) + out,
                normal: (normal - along * taper.clamp(-2.0, 2.0)).normalize_or(normal),
                uv: Vec2::new(ring.head, 0.0),
                uv_b: Vec2::new(number, BODY),
                colour: linear(ring.colour.scaled(belly), if ring.colour == HORN { 0.0 } else { 1.0 }),
            }
        })
    });
    let points: Vec<Point> = points.collect();
    sculpt.grid(SIDES + 1, points);
}

fn tail(sculpt: &mut Sculpt, number: f32) {
    let feather = |x: f32, y: f32, z: f32, colour: Rgb| Point {
        at: Vec3::new(x, y, z),
        normal: Vec3::new(x * 3.0, 1.0, -0.2).normalize(),
        uv: Vec2::ZERO,
        uv_b: Vec2::new(number, BODY),
        colour: linear(colour, 1.0),
    };
    let row = |z: f32, y: f32, half: f32, colour: Rgb| {
        [-1.0, -0.5, 0.0, 0.5, 1.0].map(|x: f32| feather(x * half, y - 0.012 * x * x, z, colour))
    };
    let rows = [
        row(-0.085, 0.103, 0.024, TAIL),
        row(-0.130, 0.093, 0.029, TAIL),
        row(-0.175, 0.083, 0.034, SLATE),
        row(-0.176, 0.083, 0.034, HORN),
        row(-0.205, 0.077, 0.036, HORN),
    ];
    sculpt.grid(5, rows.into_iter().flatten());
}

/// A wing as it lies folded; the shader spreads it by span and chord.
fn wing(sculpt: &mut Sculpt, uv_b: Vec2, side: f32) {
    const SPAN: [f32; 6] = [0.0, 0.2, 0.42, 0.65, 0.85, 1.0];
    const CHORD: [f32; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
    let rows = SPAN.iter().flat_map(|&span| {
        CHORD.iter().map(move |&chord| {
            // Wrapped about the flank from the back to the belly, its tip over the tail.
            let angle = 1.08 - 1.12 * chord;
            let around = Vec3::new(side * angle.cos(), angle.sin(), 0.0);
            let radius = 0.0635 * (1.0 - 0.72 * span * span) * (0.93 + 0.07 * (PI * span).sin());
            let lies = Vec3::new(0.0, 0.107 - 0.022 * span, 0.058 - 0.235 * span - 0.022 * chord * (1.0 - span));
            Point { at: lies + around * radius, normal: around, uv: Vec2::new(span, chord), uv_b, colour: linear(WING, 1.0) }
        })
    });
    let rows: Vec<Point> = rows.collect();
    sculpt.grid(CHORD.len(), rows);
}

fn leg(sculpt: &mut Sculpt, uv_b: Vec2, side: f32) {
    let colour = linear(CORAL, 0.0);
    let at = |x: f32, y: f32, z: f32, normal: Vec3| Point {
        at: Vec3::new(side * 0.022 + x, y, z),
        normal,
        uv: Vec2::ZERO,
        uv_b,
        colour,
    };
    let r = 0.0045;
    for (a, b) in [((-r, 0.0), (r, 0.0)), ((0.0, -r), (0.0, r))] {
        let normal = Vec3::new(b.1 - a.1, 0.0, b.0 - a.0).normalize_or(Vec3::Z);
        sculpt.quad([
            at(a.0, 0.0, a.1, normal),
            at(b.0, 0.0, b.1, normal),
            at(b.0, 0.067, b.1, normal),
            at(a.0, 0.067, a.1, normal),
        ]);
    }
    // Three toes ahead, one behind.
    for turn in [-0.55_f32, 0.0, 0.55, PI] {
        let length = if turn == PI { 0.014 } else { 0.03 };
        let (sin, cos) = turn.sin_cos();
        let (tip, across) = (Vec2::new(sin, cos) * length, Vec2::new(cos, -sin) * 0.0035);
        let corner = |p: Vec2| at(p.x, 0.004, p.y, Vec3::Y);
        sculpt.quad([corner(across), corner(-across), corner(tip - across * 0.6), corner(tip + across * 0.6)]);
    }
}

fn eyes(sculpt: &mut Sculpt, number: f32) {
    for side in [-1.0, 1.0] {
        for (radius, out, colour) in [(0.0058, 0.0236, AMBER), (0.0030, 0.0244, HORN)] {
            let middle = Vec3::new(side * out, 0.216, 0.108);
            let corner = |a: f32| Point {
                at: middle + Vec3::new(0.0, a.sin(), a.cos()) * radius,
                normal: Vec3::X * side,
                uv: Vec2::X,
                uv_b: Vec2::new(number, BODY),
                colour: linear(colour, 0.0),
            };
            let quad = [0.4, 1.97, 3.54, 5.11].map(corner);
            sculpt.quad(quad);
        }
    }
}

/// So many pigeons, each with the pose of its number.
pub(crate) fn flock(count: usize) -> Sculpt {
    let mut sculpt = Sculpt::default();
    (0..count).for_each(|number| add(&mut sculpt, number as f32));
    sculpt
}

/// Vertices of one pigeon: what it costs.
pub(crate) fn vertices() -> usize {
    flock(1).vertices()
}

/// A pose as the shader reads it: its place from the mesh's origin, in the engine's axes, and how it is coloured.
pub(crate) fn told(pose: &Pose, place: Vec3, hue: f32) -> [Vec4; 3] {
    [
        place.extend(pose.heading as f32),
        Vec4::new(pose.pitch as f32, pose.roll as f32, pose.spread as f32, pose.beat as f32),
        Vec4::new(pose.stride as f32, pose.peck as f32, pose.nod as f32, hue),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pigeon_is_as_large_as_one_and_stands_on_its_feet() {
        let one = flock(1);
        let (low, high) = one.points().fold((Vec3::splat(9.0), Vec3::splat(-9.0)), |(l, h), (p, _)| (l.min(p), h.max(p)));
        let size = high - low;
        assert!((0.3..0.38).contains(&size.z) && (0.21..0.26).contains(&size.y) && (0.11..0.15).contains(&size.x), "{size}");
        assert!(low.y.abs() < 1e-6, "its feet are at {}", low.y);
        assert!(one.points().all(|(_, normal)| (normal.length() - 1.0).abs() < 1e-3));
        assert!(vertices() < 290, "{}", vertices());
        assert_eq!(flock(5).vertices(), 5 * vertices());
    }

    #[test]
    fn its_body_faces_outwards() {
        let mut one = Sculpt::default();
        body(&mut one, 0.0);
        // The trunk alone: neck and head bend.
        for (at, normal) in one.points().filter(|(at, _)| at.z < 0.03 && at.z > -0.11) {
            let spine = Vec3::new(0.0, 0.099, at.z);
            assert!((at - spine).dot(normal) > 0.0, "{at} {normal}");
        }
        for [a, b, c] in one.triangles().filter(|t| t.iter().all(|p| p.z < 0.03 && p.z > -0.11)) {
            let middle = (a + b + c) / 3.0;
            assert!((b - a).cross(c - a).dot(middle - Vec3::new(0.0, 0.099, middle.z)) > 0.0);
        }
    }
}
