//! Soft ground, water and leaves: what is not laid stone by stone.

use glam::Vec3;
use veduta_city::draw::Draw;

use crate::canvas::{Canvas, Texel, srgb};
use crate::noise::{Fractal, Nearest, Noise, Pebbles, falloff, mix, smoothstep, word};

/// A pebble's light: round, darker at its foot.
fn pebble_light(pebble: &Nearest) -> f32 {
    let foot = smoothstep(0.0, 0.22, pebble.margin);
    (0.62 + 0.38 * foot) * (1.0 + 0.25 * (pebble.offset.1 - pebble.offset.0))
}

/// Raked gravel.
pub(crate) fn gravel(size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    let coarse = Pebbles::new(draw.bits("coarse"), 64, 64, 0.95);
    let fine = Pebbles::new(draw.bits("fine"), 128, 128, 0.95);
    let clouds = Fractal::new(draw.bits("clouds"), 3, 3, 4, 0.6);
    let tones = [srgb(0x00A8_9C86), srgb(0x0093_8876), srgb(0x00B5_AD9C), srgb(0x0086_8178), srgb(0x00A5_8F74)];
    Canvas::tiling(size, size_m, |u, v| {
        let (big, small, cloud) = (coarse.at(u, v), fine.at(u, v), clouds.at(u, v));
        let show = smoothstep(0.42, 0.3, big.near) * smoothstep(0.35, 0.45, word(big.bits, 1));
        let tone =
            |p: &Nearest| tones[(word(p.bits, 0) * tones.len() as f32) as usize] * (0.8 + 0.25 * word(p.bits, 2)) * pebble_light(p);
        let own = (tone(&small) * 0.92).lerp(tone(&big) * 1.04, show) * (1.0 + 0.09 * cloud);
        let height = mix(0.004 * (1.0 - small.near), 0.012 * (1.0 - big.near), show) + 0.004 * cloud;
        Texel { own, tint: Vec3::ZERO, height, rough: 0.92 }
    })
}

/// Lawn: blades in tufts, some clover, some straw.
pub(crate) fn grass(size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    let blades = [Noise::new(draw.bits("blades a"), 110, 34), Noise::new(draw.bits("blades b"), 90, 40)];
    let tufts = Fractal::new(draw.bits("tufts"), 16, 16, 2, 0.6);
    let clouds = Fractal::new(draw.bits("clouds"), 3, 3, 3, 0.6);
    let clover = Pebbles::new(draw.bits("clover"), 30, 30, 0.95);
    let (green, deep, straw, flower) = (srgb(0x0066_7A40), srgb(0x0038_4A28), srgb(0x0096_9058), srgb(0x00D5_D2BE));
    Canvas::tiling(size, size_m, |u, v| {
        let (tuft, cloud) = (tufts.at(u, v), clouds.at(u, v));
        let (lean_u, lean_v) = (u + 0.012 * tuft, v + 0.006 * cloud);
        let blade = blades[0].at(lean_u, lean_v).max(blades[1].at(lean_u + 0.3, lean_v));
        let plant = clover.at(u, v);
        let leaf = smoothstep(0.32, 0.16, plant.near) * smoothstep(0.72, 0.8, word(plant.bits, 0));
        let daisy = smoothstep(0.13, 0.06, plant.near) * smoothstep(0.93, 0.95, word(plant.bits, 0));
        let light = 0.5 + 0.42 * blade + 0.16 * tuft;
        let lush = deep.lerp(green, light.clamp(0.0, 1.0)).lerp(straw, (0.2 + 0.14 * cloud + 0.25 * (blade - 0.5)).clamp(0.0, 0.5));
        let own = lush.lerp(green * 0.72, leaf * 0.7).lerp(flower, daisy * 0.9) * (1.0 + 0.04 * cloud);
        Texel { own, tint: Vec3::ZERO, height: 0.012 * blade + 0.012 * tuft, rough: 0.93 }
    })
}

/// A yard: trodden earth, old cobbles that show through, weeds along them.
pub(crate) fn yard(size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    let stones = Pebbles::new(draw.bits("stones"), 22, 22, 0.55);
    let grit = Fractal::new(draw.bits("grit"), 60, 60, 1, 0.7);
    let cover = Fractal::new(draw.bits("cover"), 3, 3, 4, 0.6);
    let growth = Fractal::new(draw.bits("growth"), 5, 5, 5, 0.7);
    let (earth, light_earth, stone, weed) = (srgb(0x006E_6450), srgb(0x0086_7B62), srgb(0x007F_7C73), srgb(0x0052_653A));
    Canvas::tiling(size, size_m, |u, v| {
        let (grit, cover, growth) = (grit.at(u, v), cover.at(u, v), growth.at(u, v));
        let cobble = stones.at(u, v);
        let bare = smoothstep(-0.3, 0.35, cover + 0.12 * grit) * smoothstep(0.05, 0.2, cobble.margin);
        let ground = earth.lerp(light_earth, (0.5 + 0.5 * cover - 0.2 * grit).clamp(0.0, 1.0)) * (1.0 + 0.14 * grit);
        let top = stone * (0.78 + 0.4 * word(cobble.bits, 0)) * (0.85 + 0.2 * smoothstep(0.1, 0.4, cobble.margin) + 0.08 * grit);
        let weeds = smoothstep(-0.15, 0.4, growth + 0.25 * grit) * (1.0 - 0.75 * bare);
        let own = ground.lerp(top, bare).lerp(weed * (0.8 + 0.35 * grit.max(-1.0)), weeds * 0.8);
        let height = 0.014 * bare * smoothstep(0.05, 0.45, cobble.margin) + 0.003 * grit + 0.01 * weeds;
        Texel { own, tint: Vec3::ZERO, height, rough: mix(0.95, 0.78, bare) }
    })
}

/// Track ballast: broken stone, rusty brown between.
pub(crate) fn ballast(size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    let lumps = Pebbles::new(draw.bits("lumps"), 50, 50, 0.95);
    let under = Pebbles::new(draw.bits("under"), 46, 46, 0.95);
    let grain = Fractal::new(draw.bits("grain"), 70, 70, 1, 0.7);
    let rust = Fractal::new(draw.bits("rust"), 3, 3, 3, 0.6);
    let (stone, brown) = (srgb(0x0086_817A), srgb(0x0074_5E4C));
    Canvas::tiling(size, size_m, |u, v| {
        let (top, below, grain, rust) = (lumps.at(u, v), under.at(u, v), grain.at(u, v), rust.at(u, v));
        let show = smoothstep(0.02, 0.1, top.margin) * smoothstep(0.2, 0.3, word(top.bits, 3));
        // Broken faces: each lump is lit by its own tilt.
        let facet = |p: &Nearest| 1.0 + 0.9 * ((word(p.bits, 0) - 0.5) * p.offset.0 + (word(p.bits, 1) - 0.3) * p.offset.1);
        let lump = |p: &Nearest| {
            let tone = stone.lerp(brown, (0.35 + 0.5 * (word(p.bits, 2) - 0.5) + 0.1 * rust).clamp(0.0, 0.8));
            tone * (facet(p) * (0.84 + 0.3 * word(p.bits, 1)) * (0.6 + 0.4 * smoothstep(0.0, 0.2, p.margin)) + 0.07 * grain)
        };
        let own = (lump(&below) * 0.62).lerp(lump(&top), show);
        let height = mix(0.0, 0.024 * smoothstep(0.0, 0.5, top.margin) + 0.01 * facet(&top), show) + 0.002 * grain;
        Texel { own, tint: Vec3::ZERO, height, rough: 0.92 }
    })
}

/// Calm river water: dark blue-green, ripples for the light to play on.
pub(crate) fn water(size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    let swell = Fractal::new(draw.bits("swell"), 4, 6, 2, 0.5);
    let ripple = Fractal::new(draw.bits("ripple"), 14, 22, 3, 0.55);
    let silt = Fractal::new(draw.bits("silt"), 2, 2, 3, 0.6);
    let (deep, shallow) = (srgb(0x0028_3F41), srgb(0x0043_5A50));
    Canvas::tiling(size, size_m, |u, v| {
        let (swell, silt) = (swell.at(u, v), silt.at(u, v));
        let ripple = ripple.at(u + 0.02 * swell, v + 0.02 * silt);
        let crest = 1.0 - ripple.abs();
        let own = deep.lerp(shallow, (0.4 + 0.3 * silt + 0.12 * swell).clamp(0.0, 1.0)) * (1.0 + 0.1 * ripple + 0.06 * crest);
        Texel { own, tint: Vec3::ZERO, height: 0.05 * swell + 0.022 * ripple, rough: 0.1 + 0.04 * crest }
    })
}

/// Foliage: leaves in clumps, light above and dark between; coloured by the vertex.
pub(crate) fn leaves(size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    let layers = [
        Pebbles::new(draw.bits("leaves a"), 20, 20, 0.95),
        Pebbles::new(draw.bits("leaves b"), 23, 23, 0.95),
        Pebbles::new(draw.bits("leaves c"), 26, 26, 0.95),
    ];
    let clumps = Pebbles::new(draw.bits("clumps"), 5, 5, 0.9);
    let warp = Fractal::new(draw.bits("warp"), 8, 8, 2, 0.6);
    let clouds = Fractal::new(draw.bits("clouds"), 4, 4, 3, 0.6);
    Canvas::tiling(size, size_m, |u, v| {
        let (warp, cloud) = (warp.at(u, v), clouds.at(u, v));
        let clump = clumps.at(u + 0.02 * warp, v + 0.02 * cloud);
        let round = smoothstep(0.75, 0.1, clump.near);
        let sunny = 0.85 + 0.5 * round + 0.25 * (clump.offset.1 - 0.5 * clump.offset.0);
        let (mut light, mut hue, mut height) = (0.5, 0.0, 0.0);
        for (i, layer) in layers.iter().enumerate() {
            let leaf = layer.at(u, v);
            let (turn, depth) = (word(leaf.bits, 0) - 0.5, 0.62 + 0.26 * i as f32);
            // A leaf is an ellipse turned at random, with a paler rib.
            let (dx, dy) = (leaf.offset.0 + 1.4 * turn * leaf.offset.1, leaf.offset.1 - 1.4 * turn * leaf.offset.0);
            let reach = (dx * dx * 3.2 + dy * dy * 1.1).sqrt();
            let cover = smoothstep(0.56, 0.48, reach) * smoothstep(0.18, 0.22, word(leaf.bits, 2));
            let blade =
                depth * (0.8 + 0.45 * word(leaf.bits, 1)) * (1.0 + 0.5 * dx + 0.22 * dy) * (1.0 + 0.12 * falloff(dx.abs(), 0.05));
            light = mix(light * (1.0 - 0.25 * smoothstep(0.8, 0.5, reach)), blade, cover);
            hue = mix(hue, word(leaf.bits, 3) - 0.5, cover);
            height = mix(height, 0.02 + 0.02 * i as f32 + 0.02 * dx * turn, cover);
        }
        let light = light * sunny * (1.0 + 0.08 * cloud);
        let tint = Vec3::new(1.0 + 0.28 * hue, 1.0 + 0.06 * hue, 1.0 - 0.2 * hue) * light;
        Texel { own: Vec3::ZERO, tint, height: height + 0.05 * round, rough: 0.8 }
    })
}
