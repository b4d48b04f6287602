//! Streets and squares: setts in arcs, mosaic pavement, flagstones, asphalt. All stand in their own colours.

use glam::Vec3;
use veduta_city::draw::Draw;

use crate::canvas::{Canvas, Texel, srgb};
use crate::noise::{Fractal, Noise, falloff, floor, hash, mix, smoothstep, word};
use crate::stone::Courses;

/// Granite of a sett: grey, a few bluish, rosy or yellowish.
fn granite(bits: u64) -> Vec3 {
    let base = srgb(0x008B_8D90);
    let (hue, light) = (word(bits, 0), 0.84 + 0.32 * word(bits, 1));
    let cast = if hue < 0.14 {
        Vec3::new(1.07, 0.98, 0.93)
    } else if hue < 0.26 {
        Vec3::new(0.95, 0.99, 1.04)
    } else if hue < 0.36 {
        Vec3::new(1.04, 1.01, 0.92)
    } else {
        Vec3::ONE
    };
    base * cast * light
}

/// An arc of setts: a parabola over the tile's width.
struct Arcs {
    width_m: f32,
    rise_m: f32,
    rows: i32,
    setts: i32,
    key: u64,
}

/// A place on a sett: metres to its rim, how far it swells there (0 to 1), its hash, breadth of its joint.
struct OnSett {
    rim: f32,
    swell: f32,
    bits: u64,
    joint: f32,
}

impl Arcs {
    /// Length of the parabola from the crown to a place `x` (−1 to 1 of the half width) by the first terms of its series.
    fn length(&self, x: f32) -> f32 {
        let slope = 4.0 * self.rise_m / self.width_m;
        let s = slope * x;
        let s2 = s * s;
        x * (1.0 + s2 / 6.0 - s2 * s2 / 40.0)
    }

    fn at(&self, u: f32, v: f32) -> OnSett {
        let row_m = self.width_m / self.rows as f32;
        let x = (u - floor(u) as f32) * 2.0 - 1.0;
        let slope = -4.0 * self.rise_m / self.width_m * x;
        let steep = 1.0 / (1.0 + slope * slope).sqrt();
        let y = v * self.width_m - self.rise_m * (1.0 - x * x);
        let row = floor(y / row_m);
        let from_middle = y - (row as f32 + 0.5) * row_m;
        // Turn into the sett's own axes: along the arc and across it.
        let along = self.length(x) + from_middle * slope * steep / (self.width_m / 2.0);
        let total = self.length(1.0) * 2.0;
        let row_key = row.rem_euclid(self.rows);
        let at = (along + total / 2.0) / total * self.setts as f32 + 0.5 * (row_key % 2) as f32;
        let (sett, part) = self.sett(row_key, at);
        let piece_m = total * self.width_m / 2.0 / self.setts as f32;
        let side = part.0.min(part.1) * piece_m;
        let end = (row_m / 2.0 - from_middle.abs()) * steep;
        // Corners are rounded: distance to a rounded box.
        let round = 0.02;
        let (cx, cy) = ((round - side).max(0.0), (round - end).max(0.0));
        let rim = if cx > 0.0 && cy > 0.0 { round - (cx * cx + cy * cy).sqrt() } else { side.min(end) };
        let curve = |share: f32| 1.0 - (1.0 - share.clamp(0.0, 1.0)).powi(3);
        let swell = curve(2.0 * side / piece_m) * curve(2.0 * end / row_m);
        OnSett { rim, swell, bits: hash(self.key, sett, row_key), joint: 0.008 + 0.004 * word(hash(self.key, sett, row_key), 3) }
    }

    /// Number of the sett at a place along a row and the shares to its two ends; joints wander by a tenth.
    fn sett(&self, row: i32, at: f32) -> (i32, (f32, f32)) {
        let shift = |joint: i32| joint as f32 + 0.34 * (word(hash(self.key, joint, row + 5000), 2) - 0.5);
        let whole = floor(at);
        let first = if at < shift(whole) {
            whole - 1
        } else if at >= shift(whole + 1) {
            whole + 1
        } else {
            whole
        };
        (first, (at - shift(first), shift(first + 1) - at))
    }
}

/// Granite setts of ten centimetres in segmental arcs, 1.6 metres wide.
pub(crate) fn setts(size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    let arcs = Arcs { width_m: size_m.0, rise_m: 0.3, rows: 16, setts: 17, key: draw.bits("setts") };
    let warp = Fractal::new(draw.bits("warp"), 12, 12, 2, 0.6);
    let warp_y = Fractal::new(draw.bits("warp y"), 12, 12, 2, 0.6);
    let grain = Fractal::new(draw.bits("grain"), 64, 64, 1, 0.7);
    let dirt = Fractal::new(draw.bits("dirt"), 4, 4, 3, 0.6);
    let (sand, moss) = (srgb(0x0063_5D54), srgb(0x0058_5C4C));
    let speck = draw.bits("speck");
    Canvas::tiling(size, size_m, |u, v| {
        let (wu, wv) = (u + 0.0035 * warp.at(u, v), v + 0.0035 * warp_y.at(u, v));
        let sett = arcs.at(wu, wv);
        let (grain, dirt) = (grain.at(u, v), dirt.at(u, v));
        let speck = word(hash(speck, (u * size as f32) as i32, (v * size as f32) as i32), 0) - 0.5;
        let stone = smoothstep(sett.joint - 0.004, sett.joint + 0.005, sett.rim);
        let dome = sett.swell;
        let light = 0.76 + 0.28 * dome + 0.06 * grain + 0.14 * speck + 0.05 * dirt;
        let joint = sand.lerp(moss, smoothstep(0.1, 0.6, dirt)) * (0.72 + 0.2 * speck);
        let own = joint.lerp(granite(sett.bits) * light, stone);
        let height = 0.016 * dome + 0.004 * (word(sett.bits, 2) - 0.5) * stone + 0.0012 * grain;
        Texel { own, tint: Vec3::ZERO, height, rough: mix(0.95, 0.62 + 0.06 * grain, stone * dome) }
    })
}

/// What of the mosaic's motif a stone belongs to: dark squares, and crosses midway between them.
fn is_dark(column: i32, row: i32) -> bool {
    let (x, y) = (column.rem_euclid(12), row.rem_euclid(12));
    let (dx, dy) = ((2 * x - 11).abs(), (2 * y - 11).abs());
    let square = dx.max(dy) <= 3;
    let (cx, cy) = (11 - dx, 11 - dy);
    let cross = (cx == 0 && cy <= 4) || (cy == 0 && cx <= 4);
    square || cross
}

/// Mosaic pavement: stones of 6 to 7 cm, white with dark squares and crosses.
pub(crate) fn mosaic(size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    const STONES: f32 = 24.0;
    let warp = Fractal::new(draw.bits("warp"), 12, 12, 2, 0.6);
    let warp_y = Fractal::new(draw.bits("warp y"), 12, 12, 2, 0.6);
    let grain = Fractal::new(draw.bits("grain"), 60, 60, 1, 0.7);
    let dirt = Fractal::new(draw.bits("dirt"), 4, 4, 4, 0.6);
    let (white, dark, sand) = (srgb(0x00CF_C8BB), srgb(0x005E_5A57), srgb(0x007C_7467));
    let key = draw.bits("stones");
    Canvas::tiling(size, size_m, |u, v| {
        let (x, y) = ((u + 0.006 * warp.at(u, v)) * STONES, (v + 0.006 * warp_y.at(u, v)) * STONES);
        let (column, row) = (floor(x), floor(y));
        let (fx, fy) = (x - column as f32, y - row as f32);
        let cell = |c: i32, r: i32| hash(key, c.rem_euclid(24), r.rem_euclid(24));
        let bits = cell(column, row);
        // Every stone is cut a little skew and to its own size.
        let skew = |which| (word(bits, which) - 0.5) * 0.22;
        let (px, py) = (fx - 0.5 + skew(0) * (fy - 0.5), fy - 0.5 + skew(1) * (fx - 0.5));
        let half = 0.5 - 0.045 - 0.05 * word(bits, 2);
        let (qx, qy) = (px.abs() - half + 0.14, py.abs() - half + 0.14);
        let outside = (qx.max(0.0) * qx.max(0.0) + qy.max(0.0) * qy.max(0.0)).sqrt() + qx.max(qy).min(0.0) - 0.14;
        let rim = -outside * size_m.0 / STONES;
        let (grain, dirt) = (grain.at(u, v), dirt.at(u, v));
        let stone = smoothstep(-0.003, 0.004, rim);
        let dome = smoothstep(0.0, 0.022, rim);
        let light = 0.9 + 0.24 * (word(bits, 3) - 0.5) + 0.07 * grain + 0.06 * dirt + 0.06 * dome;
        let base = if is_dark(column, row) { dark } else { white * 0.86 };
        let warm = Vec3::new(1.0, 1.0, 1.0 + 0.12 * (word(bits, 0) - 0.5));
        let own = (sand * (0.62 + 0.08 * grain)).lerp(base * warm * light, stone);
        let height = 0.008 * dome + 0.003 * (word(bits, 1) - 0.5) * stone + 0.0008 * grain;
        Texel { own, tint: Vec3::ZERO, height, rough: mix(0.95, 0.68, stone) }
    })
}

/// Flagstones in irregular courses, worn hollow, a few cracked.
pub(crate) fn flagstones(size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    let courses = Courses::new(draw.bits("flags"), size_m, 6, 4, 0.75);
    let warp = Noise::new(draw.bits("warp"), 16, 16);
    let grain = Fractal::new(draw.bits("grain"), 64, 64, 1, 0.7);
    let worn = Fractal::new(draw.bits("worn"), 9, 9, 3, 0.6);
    let stain = Fractal::new(draw.bits("stain"), 3, 3, 4, 0.6);
    let (base, sand) = (srgb(0x009A_9488), srgb(0x0055_4F45));
    Canvas::tiling(size, size_m, |u, v| {
        let (warp, grain, worn, stain) = (warp.at(u, v), grain.at(u, v), worn.at(u, v), stain.at(u, v));
        let flag = courses.at(u + 0.0016 * warp, v + 0.0016 * worn);
        let stone = smoothstep(0.004, 0.014, flag.edge);
        let rounded = smoothstep(0.0, 0.05, flag.edge);
        let light = 0.97 + 0.28 * (word(flag.bits, 0) - 0.5) + 0.05 * grain + 0.06 * worn + 0.07 * stain - 0.1 * (1.0 - rounded);
        let warm = word(flag.bits, 1) - 0.5;
        let own =
            (base * Vec3::new(1.0 + 0.06 * warm, 1.0, 1.0 - 0.14 * warm) * light).lerp(sand * (0.8 + 0.1 * grain), 1.0 - stone);
        let tilt = (word(flag.bits, 2) - 0.5) * 0.012 * (flag.at.0 - 0.5) + (word(flag.bits, 3) - 0.5) * 0.012 * (flag.at.1 - 0.5);
        let height = 0.008 * rounded + tilt * stone + 0.0025 * worn + 0.001 * grain;
        Texel { own, tint: Vec3::ZERO, height, rough: mix(0.95, 0.7 + 0.05 * worn, stone) }
    })
}

/// Worn asphalt: grit, a mended trench, tarred cracks.
pub(crate) fn asphalt(size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    let grit = Fractal::new(draw.bits("grit"), 80, 80, 1, 0.7);
    let clouds = Fractal::new(draw.bits("clouds"), 3, 3, 4, 0.6);
    let crack = Fractal::new(draw.bits("crack"), 3, 3, 4, 0.55);
    let (base, chip, tar) = (srgb(0x0064_6361), srgb(0x0095_918A), srgb(0x0039_3838));
    let speck = draw.bits("speck");
    Canvas::tiling(size, size_m, |u, v| {
        let (grit, cloud) = (grit.at(u, v), clouds.at(u, v));
        let dot = word(hash(speck, (u * size as f32) as i32, (v * size as f32) as i32), 0);
        let stone = smoothstep(0.82, 0.98, dot) * 0.5;
        let line = falloff(crack.at(u, v).abs(), 0.013) * smoothstep(0.1, 0.5, cloud);
        let light = 1.0 + 0.1 * cloud + 0.07 * grit + 0.14 * (dot - 0.5);
        let own = (base * light).lerp(chip, stone * 0.6).lerp(tar, line * 0.8);
        Texel { own, tint: Vec3::ZERO, height: 0.003 * grit + 0.002 * dot - 0.003 * line, rough: 0.92 - 0.25 * line }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_motif_of_the_mosaic_repeats_within_the_tile_and_is_mostly_white() {
        let dark = (0..24 * 24).filter(|i| is_dark(i % 24, i / 24)).count();
        assert!((100..200).contains(&dark), "{dark} dark stones of 576");
        assert!((0..24).all(|i| is_dark(i, 3) == is_dark(i + 12, 15)));
    }

    #[test]
    fn setts_are_about_ten_centimetres() {
        let arcs = Arcs { width_m: 1.6, rise_m: 0.3, rows: 16, setts: 17, key: 4 };
        let mut seen = std::collections::BTreeSet::new();
        for i in 0..160 * 160 {
            seen.insert(arcs.at((i % 160) as f32 / 160.0, (i / 160) as f32 / 160.0).bits);
        }
        assert!((256..340).contains(&seen.len()), "{} setts on 2.56 m²", seen.len());
    }
}
