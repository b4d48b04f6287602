//! Bodies of flags, signs, figures and fountains. In the frame of a thing x runs to the right of who looks at its front, y up, z to its front.

use core::f32::consts::TAU;

use bevy::math::{Vec2, Vec3, Vec4};
use bevy::prelude::*;
use veduta_city::{Jet, Rgb, SignShape};

use crate::sculpt::{Paint, Point, Sculpt};
use crate::water::{Throw, throws};

const IRON: Rgb = Rgb(0x33, 0x35, 0x38);
const ASH: Rgb = Rgb(0xB9, 0xB2, 0xA4);
const GILT: Rgb = Rgb(0xC9, 0xA9, 0x4E);

/// A flag on its pole: `size` is along the pole and away from it, `phase` (0 to 1) keeps neighbours apart.
pub(crate) fn flag(pole_m: f64, tilt_deg: f64, size: (f64, f64), fields: &[Rgb], wedge: Option<Rgb>, phase: f32) -> Sculpt {
    let mut sculpt = Sculpt::default();
    let tilt = tilt_deg.to_radians() as f32;
    let axis = Vec3::new(0.0, tilt.cos(), tilt.sin());
    let pole = pole_m as f32;
    sculpt.turned(Vec3::ZERO, axis * pole, 8, &[(0.0, 0.032), (1.0, 0.02)], Paint::plain(ASH));
    let gilt = Paint { colour: GILT, shine: 1.0, lit: 0.0 };
    sculpt.turned(
        axis * (pole - 0.01),
        axis * (pole + 0.14),
        8,
        &[(0.0, 0.0), (0.15, 0.045), (0.5, 0.055), (0.8, 0.03), (1.0, 0.0)],
        gilt,
    );
    let (drop, wide) = (size.0 as f32, size.1 as f32);
    let top = axis * (pole - 0.06);
    let uv_b = Vec2::new(wide, drop);
    let point = |u: f32, v: f32, colour: Rgb| {
        let [r, g, b] = colour.to_linear();
        Point { at: top, normal: axis, uv: Vec2::new(u, v), uv_b, colour: Vec4::new(r, g, b, phase) }
    };
    let stripe = 1.0 / fields.len().max(1) as f32;
    let rows = (10 / fields.len().max(1)).max(2);
    for (n, &field) in fields.iter().enumerate() {
        let v = |row: usize| (n as f32 + row as f32 / rows as f32) * stripe;
        // Where the wedge ends in a row: in the middle of the flag at half its height.
        let edge = |row: usize| if wedge.is_some() { 0.5 * (1.0 - (2.0 * v(row) - 1.0).abs()) } else { 0.0 };
        let columns = |from: usize, to: usize, colour: Rgb, between: &dyn Fn(usize, f32) -> f32| {
            let row_of =
                |row: usize| (from..=to).map(move |column| (row, (column - from) as f32 / (to - from) as f32)).collect::<Vec<_>>();
            let rows_up = (0..=rows).rev().flat_map(row_of);
            rows_up.map(|(row, share)| point(between(row, share), v(row), colour)).collect::<Vec<_>>()
        };
        if let Some(wedge) = wedge {
            sculpt.grid(7, columns(0, 6, wedge, &|row, share| share * edge(row)));
        }
        sculpt.grid(15, columns(0, 14, field, &|row, share| edge(row) + share * (1.0 - edge(row))));
    }
    sculpt
}

/// A sign's iron arm, and its board, which hangs from the origin and swings about z.
pub(crate) fn sign(shape: SignShape, size: (f64, f64), arm_m: f64, colours: (Rgb, Rgb)) -> (Sculpt, Sculpt) {
    let (arm, wide, high) = (arm_m as f32, size.0 as f32, size.1 as f32);
    let iron = Paint { colour: IRON, shine: 0.35, lit: 0.0 };
    let mut bracket = Sculpt::default();
    let bar = |sculpt: &mut Sculpt, from: Vec3, to: Vec3, r: f32| sculpt.turned(from, to, 6, &[(0.0, r), (1.0, r)], iron);
    bar(&mut bracket, Vec3::ZERO, Vec3::Z * (arm + 0.06), 0.016);
    bracket.block(Vec3::new(0.0, -0.08, 0.01), [Vec3::X * 0.045, Vec3::Y * 0.19, Vec3::Z * 0.012], iron);
    // A scroll that carries the arm, and one at its end.
    let curl = |sculpt: &mut Sculpt, middle: Vec3, radius: f32, from: f32, to: f32, shrink: f32| {
        let at = |n: usize| {
            let share = n as f32 / 10.0;
            let (sin, cos) = (from + (to - from) * share).sin_cos();
            middle + Vec3::new(0.0, sin, cos) * radius * (1.0 - shrink * share)
        };
        (0..10).for_each(|n| bar(sculpt, at(n), at(n + 1), 0.009));
    };
    curl(&mut bracket, Vec3::new(0.0, -0.26, arm * 0.62), arm * 0.62, TAU * 0.45, TAU * 0.24, 0.0);
    curl(&mut bracket, Vec3::new(0.0, -0.12, arm * 0.26), 0.12, TAU * 0.25, TAU * 1.2, 0.75);
    curl(&mut bracket, Vec3::new(0.0, 0.05, arm + 0.06), 0.05, -TAU * 0.25, TAU * 0.75, 0.6);
    (bracket, board(shape, Vec2::new(wide, high), colours, iron))
}

fn board(shape: SignShape, size: Vec2, (colour, trim): (Rgb, Rgb), iron: Paint) -> Sculpt {
    let mut board = Sculpt::default();
    let half = size / 2.0;
    let outline: Vec<Vec2> = match shape {
        SignShape::Board => [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec2::new(x, y) * half).to_vec(),
        SignShape::Round => (0..28).map(|n| Vec2::from_angle(TAU * n as f32 / 28.0) * half).collect(),
        SignShape::Shield => {
            let bow = |n: usize| {
                let t = n as f32 / 8.0;
                Vec2::new((1.0 - t * t).max(0.0), -0.1 - 0.9 * t)
            };
            let right = (0..=8).map(bow).rev();
            let left = (1..8).map(bow).map(|p| p * Vec2::new(-1.0, 1.0)).rev();
            let tip = left.rev().collect::<Vec<_>>();
            let mut all: Vec<Vec2> = vec![Vec2::new(-1.0, 1.0), Vec2::new(-1.0, -0.1)];
            all.extend(tip);
            all.extend(right);
            all.push(Vec2::new(1.0, 1.0));
            all.into_iter().map(|p| p * half).collect()
        }
    };
    // Chains, then the board below the arm, across x; its width lies along z.
    let hang = 0.12;
    let middle = Vec3::new(0.0, -hang - half.y, 0.0);
    for end in [-0.6, 0.6] {
        let z = Vec3::Z * half.x * end;
        board.turned(z, z - Vec3::Y * (hang + 0.02), 5, &[(0.0, 0.008), (1.0, 0.008)], iron);
    }
    let thick = 0.022;
    for side in [1.0, -1.0_f32] {
        let at = |p: Vec2, out: f32| middle + Vec3::new(side * (thick + out), p.y, -side * p.x);
        let faces = |sculpt: &mut Sculpt, scale: f32, out: f32, colour: Rgb| {
            let corners: Vec<Vec3> = outline.iter().map(|&p| at(p * scale, out)).collect();
            sculpt.face(&corners, Paint::plain(colour));
        };
        faces(&mut board, 1.0, 0.0, trim);
        faces(&mut board, 0.90, 0.004, colour);
        // Its device: a star.
        let star: Vec<Vec2> = (0..16)
            .map(|n| Vec2::from_angle(TAU * (n as f32 + 4.0) / 16.0) * half.min_element() * if n % 2 == 0 { 0.56 } else { 0.25 })
            .collect();
        for n in 0..8 {
            let [a, b, c] = [2 * n + 15, 2 * n + 16, 2 * n + 17].map(|k| at(star[k % 16], 0.008));
            let core = at(Vec2::ZERO, 0.008);
            board.face(&[core, a, b, c], Paint { colour: trim, shine: 0.7, lit: 0.0 });
        }
    }
    for n in 0..outline.len() {
        let (a, b) = (outline[n], outline[(n + 1) % outline.len()]);
        let at = |p: Vec2, x: f32| middle + Vec3::new(x, p.y, -p.x);
        board.face(&[at(a, -thick), at(b, -thick), at(b, thick), at(a, thick)], Paint::plain(trim));
    }
    board
}

/// Robes of figures that pass.
const ROBES: [(Rgb, Rgb); 6] = [
    (Rgb(0x8E, 0x2F, 0x2A), Rgb(0x35, 0x4C, 0x74)),
    (Rgb(0x3E, 0x5E, 0x43), Rgb(0xB9, 0x8B, 0x3B)),
    (Rgb(0x6B, 0x43, 0x6B), Rgb(0xC2, 0xB4, 0x92)),
    (Rgb(0x34, 0x50, 0x7C), Rgb(0x9A, 0x39, 0x2E)),
    (Rgb(0xA6, 0x6A, 0x2E), Rgb(0x3D, 0x59, 0x50)),
    (Rgb(0xC4, 0xB9, 0x9C), Rgb(0x72, 0x33, 0x30)),
];

/// A carved figure of a height, one of several: robe and cloak, beard, halo, and what it holds.
pub(crate) fn figure(number: usize, height: f32) -> Sculpt {
    let mut sculpt = Sculpt::default();
    let (robe, cloak) = ROBES[number % ROBES.len()];
    let (robe, cloak) = (Paint { lit: 1.0, ..Paint::plain(robe) }, Paint { lit: 1.0, ..Paint::plain(cloak) });
    let skin = Paint { lit: 1.0, ..Paint::plain(Rgb(0xD2, 0xA9, 0x84)) };
    let hair =
        Paint { lit: 1.0, ..Paint::plain([Rgb(0x5A, 0x40, 0x2B), Rgb(0xB9, 0xB4, 0xA8), Rgb(0x2E, 0x27, 0x22)][number % 3]) };
    let gilt = Paint { colour: GILT, shine: 1.0, lit: 1.0 };
    let h = height;
    let up = |y: f32| Vec3::Y * (h * y);
    sculpt.turned(
        up(0.0),
        up(0.78),
        12,
        &[(0.0, 0.155 * h), (0.45, 0.125 * h), (0.62, 0.105 * h), (0.86, 0.135 * h), (1.0, 0.05 * h)],
        robe,
    );
    // The cloak falls from one shoulder, in two folds.
    for (x, lean) in [(-0.075, 0.9), (0.055, 0.7)] {
        let top = Vec3::new(x * h, 0.74 * h, 0.03 * h);
        sculpt.turned(
            top,
            Vec3::new(x * 1.5 * h, 0.06 * h, 0.045 * h),
            9,
            &[(0.0, 0.05 * h), (0.5, 0.085 * h * lean), (1.0, 0.1 * h * lean)],
            cloak,
        );
    }
    sculpt.turned(
        up(0.76),
        up(0.98),
        10,
        &[(0.0, 0.035 * h), (0.2, 0.05 * h), (0.55, 0.072 * h), (0.85, 0.055 * h), (1.0, 0.0)],
        skin,
    );
    sculpt.turned(
        Vec3::new(0.0, 0.86 * h, 0.04 * h),
        Vec3::new(0.0, 0.73 * h, 0.06 * h),
        8,
        &[(0.0, 0.035 * h), (0.4, 0.048 * h), (1.0, 0.0)],
        hair,
    );
    sculpt.turned(
        Vec3::new(0.0, 0.87 * h, -0.015 * h),
        up(1.0) - Vec3::Z * 0.01 * h,
        9,
        &[(0.0, 0.075 * h), (0.6, 0.072 * h), (1.0, 0.0)],
        hair,
    );
    sculpt.turned(
        Vec3::new(0.0, 0.9 * h, -0.045 * h),
        Vec3::new(0.0, 0.9 * h, -0.055 * h),
        20,
        &[(0.0, 0.0), (0.01, 0.135 * h), (0.99, 0.135 * h), (1.0, 0.0)],
        gilt,
    );
    // Arms meet before the breast, about a staff, a key, a book …
    for side in [-1.0, 1.0] {
        let shoulder = Vec3::new(side * 0.11 * h, 0.68 * h, 0.02 * h);
        let hand = Vec3::new(side * 0.05 * h, 0.50 * h, 0.15 * h);
        sculpt.turned(
            shoulder,
            hand,
            8,
            &[(0.0, 0.05 * h), (0.7, 0.045 * h), (1.0, 0.05 * h)],
            if side < 0.0 { cloak } else { robe },
        );
        sculpt.turned(hand, hand + Vec3::new(0.0, 0.02 * h, 0.035 * h), 6, &[(0.0, 0.026 * h), (1.0, 0.012 * h)], skin);
    }
    let held = Vec3::new(0.06 * h, 0.5 * h, 0.18 * h);
    match number % 3 {
        0 => sculpt.turned(held - up(0.44), held + up(0.34), 6, &[(0.0, 0.012 * h), (1.0, 0.012 * h)], gilt),
        1 => sculpt.block(held - Vec3::X * 0.06 * h, [Vec3::X * 0.055 * h, Vec3::Y * 0.075 * h, Vec3::Z * 0.02 * h], cloak),
        _ => {
            sculpt.turned(held - up(0.1), held + up(0.16), 6, &[(0.0, 0.011 * h), (1.0, 0.011 * h)], gilt);
            sculpt.block(
                held + up(0.14) + Vec3::X * 0.035 * h,
                [Vec3::X * 0.03 * h, Vec3::Y * 0.022 * h, Vec3::Z * 0.008 * h],
                gilt,
            );
        }
    }
    sculpt
}

/// Kinds of pictures, as the shader knows them.
const PUFF: f32 = 0.0;
const THREAD: f32 = 1.0;
const DROP: f32 = 2.0;
const RING: f32 = 3.0;
const SHADE: f32 = 4.0;
const CORNERS: [(f32, f32); 4] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];

fn picture(sculpt: &mut Sculpt, of: Point) {
    sculpt.quad(CORNERS.map(|(x, y)| Point { uv: Vec2::new(x, y), ..of }));
}

/// A number from 0 to 1 that is spread evenly over whole numbers.
fn spread(n: usize) -> f32 {
    (n as f32 * 0.618_034 + 0.137).fract()
}

/// Water in the air and on the basin: threads from every opening, at most so many drops beside them, rings where they fall.
pub(crate) fn fountain(jets: &[Jet], (radius_m, water_m): (f64, f64), most_drops: usize) -> Sculpt {
    const PIECES: usize = 12;
    let mut sculpt = Sculpt::default();
    let all: Vec<(Throw, Jet)> = jets.iter().flat_map(|jet| throws(jet, water_m).map(move |throw| (throw, *jet))).collect();
    let drops = (most_drops / all.len().max(1)).min(16);
    let mut count = 0;
    for (n, (throw, jet)) in all.iter().enumerate() {
        let seed = spread(n);
        let width = jet.width_m as f32;
        let point = |side: f32, share: f32| Point {
            at: throw.from,
            normal: throw.speed,
            uv: Vec2::new(side, share),
            uv_b: Vec2::new(THREAD, throw.flight_s),
            colour: Vec4::new(width, seed, 0.0, 1.0),
        };
        sculpt.grid(2, (0..=PIECES).flat_map(|k| [-1.0, 1.0].map(|side| point(side, k as f32 / PIECES as f32))));
        for k in 0..drops {
            count += 1;
            let colour = Vec4::new(width * 0.55, spread(count * 7 + k), spread(count), 1.0);
            let (at, normal) = (throw.from, throw.speed);
            picture(&mut sculpt, Point { at, normal, uv: Vec2::ZERO, uv_b: Vec2::new(DROP, throw.flight_s), colour });
        }
        let lands = throw.from + throw.speed * throw.flight_s;
        let lands = Vec3::new(lands.x, jet.lands_m.unwrap_or(water_m) as f32 + 0.012, lands.z);
        for k in 0..2 {
            let colour = Vec4::new((0.10 + 0.55 * radius_m as f32 * 0.2).min(0.4), seed + 0.5 * k as f32, 0.9 + 0.5 * seed, 1.0);
            picture(&mut sculpt, Point { at: lands, normal: Vec3::Y, uv: Vec2::ZERO, uv_b: Vec2::new(RING, 0.0), colour });
        }
    }
    sculpt
}

/// Puffs of each chimney.
pub(crate) const PUFFS: usize = 22;

/// Smoke of so many chimneys, each with the place of its number.
pub(crate) fn smoke(chimneys: usize) -> Sculpt {
    let mut sculpt = Sculpt::default();
    for n in 0..chimneys {
        for k in 0..PUFFS {
            // Evenly in time, so that the plume has no gaps.
            let phase = (k as f32 + 0.6 * spread(k + 3 * n)) / PUFFS as f32;
            let normal = Vec3::new(n as f32, phase, spread(k * 5 + n * 11));
            picture(&mut sculpt, Point { normal, uv_b: Vec2::new(PUFF, 0.0), colour: Vec4::ONE, ..default() });
        }
    }
    sculpt
}

/// The shade under so many birds.
pub(crate) fn shades(birds: usize) -> Sculpt {
    let mut sculpt = Sculpt::default();
    for n in 0..birds {
        picture(&mut sculpt, Point { normal: Vec3::X * n as f32, uv_b: Vec2::new(SHADE, 0.0), colour: Vec4::ONE, ..default() });
    }
    sculpt
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flag_has_its_stripes_and_wedge() {
        let (white, red, blue) = (Rgb(255, 255, 255), Rgb(215, 20, 26), Rgb(17, 69, 126));
        let plain = flag(3.0, 0.0, (1.0, 1.5), &[white, red], None, 0.0);
        let wedged = flag(3.0, 0.0, (1.0, 1.5), &[white, red], Some(blue), 0.0);
        assert!(wedged.vertices() > plain.vertices());
        assert!(wedged.vertices() < 900, "{}", wedged.vertices());
    }

    #[test]
    fn bodies_are_as_large_as_told_and_hang_where_they_should() {
        let (bracket, hung) = sign(SignShape::Shield, (0.6, 0.8), 1.0, (Rgb(9, 9, 9), Rgb(99, 99, 9)));
        assert!(bracket.points().all(|(p, _)| p.z > -0.05 && p.z < 1.2));
        let (low, high) = hung.points().fold((Vec3::splat(9.0), Vec3::splat(-9.0)), |(l, h), (p, _)| (l.min(p), h.max(p)));
        assert!((high.y - low.y - 0.92).abs() < 0.03 && (high.z - low.z - 0.6).abs() < 0.02 && high.y < 0.02, "{low} {high}");
        for number in 0..6 {
            let saint = figure(number, 1.0);
            assert!(saint.points().all(|(p, _)| (-0.01..1.06).contains(&p.y) && p.x.abs() < 0.25 && p.z.abs() < 0.25), "{number}");
        }
    }

    #[test]
    fn drops_and_puffs_keep_their_cap() {
        let jet = Jet { count: 8, radius_m: 1.0, height_m: 2.0, rise_m: 0.5, reach_m: 0.5, lands_m: None, width_m: 0.02 };
        let (few, many) = (fountain(&[jet], (2.0, 0.6), 16), fountain(&[jet], (2.0, 0.6), 10_000));
        let drops = |sculpt: &Sculpt| (sculpt.vertices() - 8 * 26) / 4 - 16;
        assert_eq!(drops(&few), 16);
        assert_eq!(drops(&many), 128);
        assert_eq!(smoke(3).vertices(), 3 * PUFFS * 4);
        assert_eq!(shades(5).vertices(), 20);
    }
}
