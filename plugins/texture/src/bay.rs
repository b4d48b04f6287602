//! The wall itself: plaster of a bare wall and of a bay, and the dirt that weather leaves on it.

use glam::Vec3;
use veduta_city::draw::Draw;

use crate::canvas::{Canvas, Rect, Texel};
use crate::noise::{Fractal, Noise, falloff, hash, smoothstep, word};

/// Width and height of a bay in metres, as [`veduta_city::Tile::size_m`] says.
pub(crate) const BAY: (f32, f32) = (2.8, 3.4);

/// Middle of a bay.
pub(crate) const MIDDLE: f32 = BAY.0 / 2.0;

/// Plaster: mottled, brushed, grainy. The strength is that of the large mottling.
fn plaster(size: u32, size_m: (f32, f32), draw: Draw, strength: f32) -> Canvas {
    let clouds = Fractal::new(draw.bits("clouds"), 3, 3, 3, 0.55);
    let brush = Fractal::new(draw.bits("brush"), 30, 9, 2, 0.6);
    let runs = Noise::new(draw.bits("runs"), 34, 2);
    let float = Fractal::new(draw.bits("float"), 9, 11, 3, 0.6);
    let patches = Fractal::new(draw.bits("patches"), 4, 4, 4, 0.6);
    let grain = draw.bits("grain");
    Canvas::tiling(size, size_m, |u, v| {
        let cloud = clouds.at(u, v);
        let fine = word(hash(grain, (u * size as f32) as i32, (v * size as f32) as i32), 0) - 0.5;
        let (brushed, worn) = (brush.at(u, v), float.at(u, v));
        let run = runs.at(u, v);
        // Where the top coat has weathered away, an older and paler one shows with a ragged edge.
        let patch = smoothstep(0.42, 0.52, patches.at(u, v) + 0.15 * worn) - 0.13;
        let soft = strength * (cloud + 0.45 * run + 0.9 * patch);
        let light = 1.0 + soft + 0.02 * brushed + 0.024 * worn + 0.04 * fine;
        // Where it is darker it is a little greyer and greener: damp and soot, not shadow.
        let hue = Vec3::new(1.0, 1.0 + 0.1 * strength * (cloud - brushed), 1.0 - 0.6 * soft + 0.8 * strength * patch);
        Texel {
            own: Vec3::ZERO,
            tint: hue * light,
            height: 0.003 * worn + 0.0012 * brushed + 0.0012 * fine - 0.0015 * patch,
            rough: 0.9 + 0.04 * brushed,
        }
    })
}

/// The wall of a bay. All bays share it, whatever opens in them, so that neighbours meet without a seam; its large mottling
/// is faint, because it comes back every bay.
pub(crate) fn bay_wall(size: u32, seed: u64) -> Canvas {
    plaster(size, BAY, Draw::new(seed, veduta_city::Id(0), "bay wall"), 0.03)
}

/// Lays the common wall back over a bay's border, where shade and mouldings faded out against it: the two outermost pixels,
/// from which the border's normals come too, are the wall's own. What stands on the ground keeps its foot.
pub(crate) fn join(canvas: &mut Canvas, wall: &Canvas, stands_on_foot: bool) {
    let n = canvas.size;
    let (px, py) = (BAY.0 / n as f32, BAY.1 / n as f32);
    for (i, (texel, common)) in canvas.texels.iter_mut().zip(&wall.texels).enumerate() {
        let (row, column) = (i / n, i % n);
        let across = column.min(n - 1 - column).saturating_sub(1) as f32 * px;
        let above = row.saturating_sub(1) as f32 * py;
        let below = if stands_on_foot { f32::MAX } else { (n - 1 - row).saturating_sub(1) as f32 * py };
        let back = falloff(across.min(above).min(below), 0.05);
        if back > 0.0 {
            *texel = texel.lerp(*common, back);
        }
    }
}

/// Bare plaster, four metres of it, with hairlines and patches mended in another year.
pub(crate) fn bare_plaster(size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    let mut canvas = plaster(size, size_m, draw, 0.05);
    for i in 0..5 {
        hairline(&mut canvas, draw.part(i));
    }
    canvas
}

/// A crack that wanders for a metre or so, inside of the canvas.
fn hairline(canvas: &mut Canvas, draw: Draw) {
    let mut x = draw.between("x", 0.6, f64::from(canvas.size_m.0) - 0.6) as f32;
    let mut y = draw.between("y", 1.2, f64::from(canvas.size_m.1) - 0.3) as f32;
    let lean = draw.between("lean", -0.05, 0.05) as f32;
    let half = canvas.pixel_m() * 0.3;
    for i in 0..14 {
        let step = draw.part(i);
        let to = (x + lean + step.between("dx", -0.05, 0.05) as f32, y - step.between("dy", 0.03, 0.09) as f32);
        let fade = 0.11 * (1.0 - i as f32 / 14.0);
        let (from, pixel) = ((x, y), half * 4.0);
        let area = Rect::new(x.min(to.0), to.1, x.max(to.0), y).grow(pixel, pixel);
        canvas.each(area, |texel, px, py| {
            let inside = smoothstep(pixel, 0.0, crate::canvas::stroke(from, to, half, px, py));
            *texel = texel.times(1.0 - fade * inside);
            texel.height -= 0.001 * inside;
        });
        (x, y) = to;
    }
}

/// Streaks of dirt that run down from (x, y): `length` metres, wider and fainter as they go.
pub(crate) fn streaks(canvas: &mut Canvas, x: f32, y: f32, width: f32, length: f32, draw: Draw) {
    let threads = Noise::new(draw.bits("threads"), 96, 5);
    let size_m = canvas.size_m;
    canvas.each(Rect::new(x - width, y - length, x + width, y), |texel, px, py| {
        let down = (y - py) / length;
        let reach = width * (0.45 + 0.5 * down);
        let thread = 0.65 + 0.5 * threads.at(px / size_m.0, py / size_m.1);
        let dirt = 0.38 * falloff((px - x).abs(), reach) * (1.0 - down) * thread;
        let dirt = dirt.clamp(0.0, 0.45);
        *texel = texel.times(1.0 - dirt);
        texel.tint *= Vec3::new(1.0, 1.0 + 0.06 * dirt, 1.0 + 0.22 * dirt);
    });
}
