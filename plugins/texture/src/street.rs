//! The ground floor's other life: shop fronts and arcades.

use glam::Vec3;
use veduta_city::Opening;
use veduta_city::draw::Draw;

use crate::bay::{BAY, MIDDLE};
use crate::canvas::{Canvas, Rect, Texel, disc, srgb};
use crate::hole::{Head, Hole, shade_recess};
use crate::moulding::{console, cornice, keystone, panel};
use crate::noise::{falloff, floor, hash, mix, smoothstep, word};
use crate::stone::{Sandstone, stone_ring};
use crate::timber::{Timber, boards};

/// Paint of the shop front.
const FRONT: u32 = 0x002F_4A41;
/// Gold of letters.
const GOLD: u32 = 0x00C2_A158;

/// Shop front of painted timber: stall riser, display window, fascia board under a cornice.
pub(crate) fn shop(canvas: &mut Canvas, draw: Draw) {
    let front = Rect::standing(MIDDLE, 0.0, 2.5, 3.06);
    let timber = Timber::new(FRONT, draw, BAY);
    let paint = Texel::solid(srgb(FRONT), 0.52);
    canvas.cast(front, |x, y| front.distance(x, y), 0.09, 0.45);
    boards(canvas, front, |x, y| front.distance(x, y), &timber, 0.06);
    let window = Hole::of(Opening::Shop).rect;
    display(canvas, window, draw);
    mullions(canvas, window, paint);
    for i in 0..3 {
        let field = Rect::standing(MIDDLE + (i as f32 - 1.0) * 0.7, 0.16, 0.58, 0.36);
        panel(canvas, field, 0.03, paint.times(0.95).at(0.06), 0.02);
    }
    canvas.slab(Rect::standing(MIDDLE, 0.58, 2.22, 0.08), paint.times(1.2).at(0.06), 0.06);
    canvas.shade(front, |_, y| 1.0 - 0.35 * falloff(y, 0.12));
    for side in [-1.0, 1.0] {
        let pilaster = Rect::standing(MIDDLE + side * 1.14, 0.0, 0.2, 2.46);
        canvas.slab(pilaster, paint.times(1.1).at(0.06), 0.03);
        panel(canvas, Rect::standing(MIDDLE + side * 1.14, 0.62, 0.1, 1.7), 0.02, paint.times(1.05).at(0.09), 0.012);
        canvas.slab(Rect::standing(MIDDLE + side * 1.14, 0.0, 0.24, 0.5), paint.times(0.9).at(0.06), 0.04);
    }
    fascia(canvas, paint);
    for side in [-1.0, 1.0] {
        console(canvas, Rect::standing(MIDDLE + side * 1.14, 2.4, 0.19, 0.56), paint.times(1.25).at(0.08));
    }
    cornice(canvas, Rect::standing(MIDDLE, 2.94, 2.42, 0.14), 0.16, paint.times(1.2));
}

/// The fascia: a gilt line around a field left free for a name, and an ornament in its middle.
fn fascia(canvas: &mut Canvas, paint: Texel) {
    let board = Rect::standing(MIDDLE, 2.46, 2.5, 0.48);
    canvas.slab(board, paint.times(0.9).at(0.06), 0.03);
    let gold = Texel::solid(srgb(GOLD) * 0.9, 0.42).at(0.095);
    let line = Rect::standing(MIDDLE, 2.54, 1.9, 0.32);
    canvas.paint(line, |x, y| line.distance(x, y).abs() - 0.008, |_, _| gold);
    let cy = (line.y0 + line.y1) / 2.0;
    let lozenge = |half_x: f32, half_y: f32, x: f32, y: f32| {
        (((x - MIDDLE).abs() / half_x + (y - cy).abs() / half_y) - 1.0) * half_x.min(half_y)
    };
    let area = Rect::standing(MIDDLE, line.y0, 1.0, 0.32);
    canvas.paint(area, |x, y| lozenge(0.42, 0.032, x, y).min(lozenge(0.085, 0.1, x, y)), |_, _| gold);
    canvas.paint(area, |x, y| lozenge(0.05, 0.06, x, y), |_, _| paint.times(1.1).at(0.095));
    for side in [-1.0, 1.0] {
        let at = MIDDLE + side * 0.19;
        canvas.paint(area, |x, y| disc(at, cy, 0.036, x, y).abs() - 0.009, |_, _| gold);
    }
}

/// What stands in the window: shelves with goods in lamplight, the street mirrored faintly over them.
fn display(canvas: &mut Canvas, window: Rect, draw: Draw) {
    let (dark, lamp, sky) = (srgb(0x002C_2A28), srgb(0x00A8_8A5C), srgb(0x0066_7480));
    let goods = [srgb(0x008A_5A44), srgb(0x00B9_A27A), srgb(0x0058_6B5E), srgb(0x0070_4A52), srgb(0x00C0_B59E), srgb(0x004B_5A6B)];
    let key = draw.bits("goods");
    canvas.paint_rect(window, |x, y| {
        let (u, v) = ((x - window.x0) / window.width(), (y - window.y0) / window.height());
        let glow = smoothstep(1.1, 0.3, v) * (0.25 + 0.75 * falloff((u - 0.5).abs(), 0.75));
        let mut colour: Vec3 = dark.lerp(lamp, 0.4 * glow);
        let shelf = floor(v * 3.2).min(2);
        let on_shelf = v * 3.2 - shelf as f32;
        let slot = floor(u * 10.0 + shelf as f32 * 0.37);
        let across = u * 10.0 + shelf as f32 * 0.37 - slot as f32;
        let bits = hash(key, slot, shelf);
        let (tall, broad) = (0.25 + 0.45 * word(bits, 0), 0.28 + 0.2 * word(bits, 1));
        let off = (across - 0.5).abs();
        if word(bits, 3) > 0.15 {
            let round = smoothstep(broad + 0.04, broad - 0.04, off) * smoothstep(tall + 0.04, tall - 0.04, on_shelf);
            let body = goods[(word(bits, 2) * goods.len() as f32) as usize] * (0.3 + 0.5 * glow) * (1.1 - 1.2 * off);
            colour = colour.lerp(body, round);
        }
        colour *= 1.0 - 0.5 * falloff(on_shelf, 0.06);
        let mirror = smoothstep(0.45 + 0.5 * (u - 0.5), 1.25, v) * 0.4;
        let edge = 0.4 * falloff(-window.distance(x, y), 0.05);
        Texel::solid(colour.lerp(sky, mirror) * (1.0 - edge), 0.13).at(-0.02)
    });
    shade_recess(canvas, &Hole::new(window, Head::Flat), 0.14, 0.5);
}

/// Slender posts and a transom of the display window.
fn mullions(canvas: &mut Canvas, window: Rect, paint: Texel) {
    for at in [0.335, 0.665] {
        canvas.slab(
            Rect::standing(mix(window.x0, window.x1, at), window.y0, 0.045, window.height()),
            paint.times(1.25).at(0.02),
            0.02,
        );
    }
    canvas.slab(Rect::new(window.x0, window.y1 - 0.42, window.x1, window.y1 - 0.37), paint.times(1.25).at(0.02), 0.02);
}

/// Arch of an arcade: stone piers and archivolt around the dark of the vaulted walk, with a door's glow at its back.
pub(crate) fn arcade(canvas: &mut Canvas, draw: Draw) {
    let stone = Sandstone::new(draw, BAY);
    let hole = Hole::of(Opening::Arcade);
    stone_ring(canvas, &hole, 0.3, (0.45, 13.0), 0.04, &stone);
    keystone(canvas, MIDDLE, hole.rect.y1 - 0.02, hole.rect.y1 + 0.34, 0.22, stone.texel(MIDDLE, 3.0, (9, 9)).times(1.08));
    vault(canvas, &hole);
    for side in [-1.0, 1.0] {
        let at = MIDDLE + side * 1.12;
        stone.block(canvas, Rect::standing(at, hole.springing() - 0.09, 0.36, 0.14), 1.1, 0.08);
        stone.block(canvas, Rect::standing(at, 0.0, 0.36, 0.5), 0.88, 0.07);
    }
}

/// The walk behind the arch: groins of the vault, a lit wall at the back with a shop's door, light falling on the floor.
fn vault(canvas: &mut Canvas, hole: &Hole) {
    let (deep, plaster, glow, floor_stone) = (srgb(0x0030_2C29), srgb(0x008A_7C66), srgb(0x00B0_8A56), srgb(0x0078_7266));
    let back = Hole::new(Rect::standing(MIDDLE + 0.06, 0.32, 1.2, 1.95), Head::Round);
    let door = Rect::standing(MIDDLE + 0.22, 0.32, 0.56, 1.25);
    let shape = |x: f32, y: f32| hole.distance(x, y);
    canvas.paint(hole.rect, shape, |x, y| {
        let from_back = back.distance(x, y).max(0.0);
        let inward = falloff(from_back, 0.75);
        // The right side of the passage catches more daylight than the left.
        let side = 0.8 + 0.35 * (x - MIDDLE);
        let mut colour = deep.lerp(plaster, (0.2 + 0.22 * (1.0 - inward)) * side);
        let groin = (from_back * 3.4 - floor(from_back * 3.4) as f32 - 0.5).abs();
        colour *= 1.0 - 0.22 * falloff(groin, 0.14) * f32::from(u8::from(y > back.springing()));
        if back.distance(x, y) < 0.0 {
            colour = deep.lerp(plaster, 0.36) * (0.75 + 0.25 * smoothstep(2.3, 0.6, y));
            let pane = smoothstep(0.02, -0.02, door.distance(x, y));
            let bars = 1.0 - 0.6 * falloff(((x - door.cx()).abs()).min((y - 1.2).abs()), 0.03);
            colour = colour.lerp(glow * (0.5 * bars), pane);
            colour += glow * (0.12 * falloff(door.distance(x, y), 0.45));
        }
        let ground = (0.32 - y).max(0.0) / 0.32;
        if y < 0.32 + 0.1 * from_back.min(0.0) {
            colour = colour.lerp(floor_stone, 0.3 + 0.4 * ground);
        }
        Texel::solid(colour, 0.9).at(-0.13 + 0.05 * from_back.min(0.5))
    });
    shade_recess(canvas, hole, 0.34, 0.6);
}
