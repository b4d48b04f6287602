//! Storch House: a front painted all over in 1897, with a gable to the square. Here a stork stands in its middle, for the name.

use crate::age;
use crate::easel::{Easel, line, mix};
use crate::joinery::Sash;

const GROUND: u32 = 0xd3_ac6b;
const WHITE: u32 = 0xec_e2cb;
const GREEN: u32 = 0x5f_6f4b;
const RED: u32 = 0x9a_4a38;
const BLUE: u32 = 0x51_6d83;
const GOLD: u32 = 0xc9_9d45;
const UMBER: u32 = 0x5b_4430;

/// Height of the eaves and of the gable's top over the arcade, metres.
const EAVES: f32 = 10.7;
const TOP: f32 = 20.7;
const WIDTH: f32 = 10.05;

pub fn paint() -> Easel {
    let mut easel = Easel::new((WIDTH, TOP), 2048, GROUND);
    let sash = Sash { frame: 0xe6_dfcf, columns: 2, rows: 3, look: 0 };
    // Between arcade and first floor: a frieze of scrolls on blue.
    frieze(&mut easel, 0.0, 0.85, 0.73, BLUE);
    // Vines climb between the windows.
    for n in 0..5 {
        vine(&mut easel, 0.491 + 2.267 * n as f32, 0.95, EAVES - 0.62);
    }
    let columns: [f32; 4] = core::array::from_fn(|n| 1.05 + 2.267 * n as f32);
    for (y, h) in [(1.55, 2.05), (8.1, 1.75)] {
        for (n, &x) in (0..).zip(&columns) {
            easel.rect(x - 0.19, y - 0.04, 1.49, h + 0.23, WHITE);
            easel.rect(x - 0.12, y, 1.35, h + 0.12, mix(RED, WHITE, 0.25));
            easel.rect(x - 0.07, y, 1.25, h + 0.07, WHITE);
            cartouche(&mut easel, x + 0.55, y + h + 0.45);
            easel.window((x, y, 1.1, h), 0.0, Sash { look: n % 2, ..sash });
            easel.sill(x, y, 1.1, WHITE);
        }
    }
    for x in [columns[0], columns[3]] {
        easel.rect(x - 0.19, 4.86, 1.49, 2.15, WHITE);
        easel.window((x, 4.9, 1.1, 1.95), 0.0, sash);
        easel.sill(x, 4.9, 1.1, WHITE);
    }
    panel(&mut easel, 3.0, 4.55, 4.05, 3.1);
    frieze(&mut easel, EAVES - 0.62, 0.62, 0.56, RED);
    gable(&mut easel, sash);
    age(&mut easel, 0.8);
    easel
}

fn frieze(easel: &mut Easel, y: f32, height: f32, scrolls: f32, colour: u32) {
    easel.rect(0.0, y, WIDTH, height, mix(colour, GROUND, 0.15));
    easel.scrolls(0.15, WIDTH - 0.15, y + height / 2.0, scrolls, mix(GOLD, WHITE, 0.35));
    for edge in [y, y + height - 0.06] {
        easel.rect(0.0, edge, WIDTH, 0.06, GOLD);
    }
}

/// A stem with leaves and fruit on both sides.
fn vine(easel: &mut Easel, x: f32, from: f32, to: f32) {
    // Four times the same.
    let at = |t: f32| (x + 0.08 * (t * 4.0 * std::f32::consts::TAU).sin(), from + (to - from) * t);
    let stem: Vec<(f32, f32)> = (0..=80).map(|i| at(i as f32 / 80.0)).collect();
    if let Some(path) = line(&stem, false) {
        easel.stroke(&path, 0.055, UMBER);
    }
    for i in 0..32 {
        let (px, py) = at(i as f32 / 32.0);
        let side = if i % 2 == 0 { 1.0 } else { -1.0 };
        let angle = if side > 0.0 { 0.5 } else { 2.64 };
        easel.leaf(px, py, angle, 0.28, mix(GREEN, if i % 4 == 0 { GOLD } else { 0x34_4630 }, 0.25));
        if i % 8 == 3 {
            for berry in 0..5 {
                let (dx, dy) = (0.05 * (berry % 3) as f32, -0.055 * (berry / 2) as f32);
                easel.disc(px - side * (0.12 + dx), py - 0.05 + dy, 0.035, mix(RED, 0x40_1830, 0.4));
            }
        }
    }
}

fn cartouche(easel: &mut Easel, x: f32, y: f32) {
    for side in [1.0, -1.0] {
        easel.spiral((x + side * 0.36, y), 0.17, if side > 0.0 { 2.6 } else { 0.5 }, side, RED);
    }
    easel.disc(x, y + 0.02, 0.17, GOLD);
    easel.disc(x, y + 0.02, 0.12, BLUE);
    for petal in 0..8 {
        easel.leaf(x, y + 0.02, petal as f32 * 0.785, 0.1, WHITE);
    }
}

/// The painting: a stork before a sun, in a frame.
fn panel(easel: &mut Easel, x: f32, y: f32, w: f32, h: f32) {
    easel.rect(x, y, w, h, GOLD);
    easel.rect(x + 0.09, y + 0.09, w - 0.18, h - 0.18, UMBER);
    easel.rect(x + 0.15, y + 0.15, w - 0.3, h - 0.3, mix(BLUE, WHITE, 0.35));
    let (cx, cy) = (x + w / 2.0, y + h * 0.56);
    for (radius, colour) in [(1.22, mix(GOLD, RED, 0.25)), (1.02, GOLD), (0.8, mix(GOLD, WHITE, 0.25))] {
        easel.disc(cx, cy, radius, colour);
    }
    for ray in 0..24 {
        let angle = ray as f32 * std::f32::consts::TAU / 24.0;
        let (rx, ry) = (cx + 1.06 * angle.cos(), cy + 1.06 * angle.sin());
        easel.leaf(rx, ry, angle, 0.14, mix(GOLD, RED, 0.35));
    }
    // Meadow and reeds.
    easel.rect(x + 0.15, y + 0.15, w - 0.3, 0.42, mix(GREEN, 0x2c_3a28, 0.25));
    for n in 0..26 {
        let rx = x + 0.3 + (w - 0.6) * n as f32 / 25.0;
        easel.leaf(
            rx,
            y + 0.4,
            1.2 + 0.6 * crate::easel::hash(n, 5),
            0.45 + 0.3 * crate::easel::hash(n, 9),
            mix(GREEN, GOLD, 0.3 * crate::easel::hash(n, 2)),
        );
    }
    // The stork: legs, body, folded wing, neck, head and beak.
    for (dx, bend) in [(-0.06, 0.03), (0.1, -0.02)] {
        if let Some(path) = line(&[(cx + dx, y + 1.35), (cx + dx + bend, y + 0.9), (cx + dx, y + 0.42)], false) {
            easel.stroke(&path, 0.05, RED);
        }
    }
    let body = [(0.62, 0.0), (0.35, 0.24), (0.0, 0.3), (-0.38, 0.2), (-0.66, -0.12), (-0.3, -0.2), (0.1, -0.22), (0.42, -0.16)];
    let by = y + 1.58;
    easel.polygon(&body.map(|(dx, dy)| (cx + dx * 0.9, by + dy)), WHITE);
    for feather in 0..6 {
        easel.leaf(
            cx + 0.1 - 0.09 * feather as f32,
            by + 0.06 - 0.02 * feather as f32,
            3.5,
            0.5,
            mix(0x2c_2a2c, WHITE, 0.06 * feather as f32),
        );
    }
    let neck: Vec<(f32, f32)> =
        [(0.46, 0.08), (0.62, 0.26), (0.58, 0.46), (0.5, 0.6), (0.54, 0.74)].map(|(dx, dy)| (cx + dx, by + dy)).to_vec();
    if let Some(path) = line(&neck, false) {
        easel.stroke(&path, 0.17, WHITE);
    }
    easel.disc(cx + 0.56, by + 0.78, 0.12, WHITE);
    easel.disc(cx + 0.59, by + 0.8, 0.025, 0x20_1a18);
    easel.polygon(&[(cx + 0.65, by + 0.83), (cx + 0.65, by + 0.74), (cx + 1.12, by + 0.68)], RED);
}

/// Above the eaves: two windows, a sun at the top, scrolls along the slopes.
fn gable(easel: &mut Easel, sash: Sash) {
    for x in [3.15, 5.8] {
        easel.rect(x - 0.16, 11.66, 1.42, 1.75, WHITE);
        easel.window((x, 11.7, 1.1, 1.55), 0.0, Sash { rows: 2, ..sash });
        easel.sill(x, 11.7, 1.1, WHITE);
    }
    easel.candelabrum(WIDTH / 2.0, 11.2, 2.6, mix(RED, GOLD, 0.25), GROUND);
    let middle = WIDTH / 2.0;
    easel.disc(middle, 15.1, 0.98, mix(BLUE, GROUND, 0.15));
    easel.disc(middle, 15.1, 0.6, GOLD);
    for ray in 0..16 {
        let angle = ray as f32 * std::f32::consts::TAU / 16.0;
        easel.leaf(middle + 0.55 * angle.cos(), 15.1 + 0.55 * angle.sin(), angle, 0.4, GOLD);
    }
    for side in [1.0, -1.0] {
        for (up, out, radius) in [(14.3, 1.5, 0.42), (13.2, 2.5, 0.5), (11.9, 3.2, 0.6), (16.6, 0.5, 0.4)] {
            easel.spiral((middle + side * out, up), radius, if side > 0.0 { 3.4 } else { -0.3 }, -side, mix(RED, GROUND, 0.2));
        }
    }
    easel.candelabrum(middle, 16.8, 2.4, mix(BLUE, UMBER, 0.2), GROUND);
    for side in [1.0, -1.0] {
        let slope = (TOP - EAVES) / (WIDTH / 2.0);
        // A band along the slopes.
        let (foot, top) = ((0.0, EAVES), (WIDTH / 2.0, TOP));
        let lower = [foot, top, (top.0, top.1 - 0.75), (foot.0 + 0.38, foot.1)];
        easel.polygon(&lower.map(|(x, y)| (if side > 0.0 { x } else { WIDTH - x }, y)), mix(GREEN, GROUND, 0.25));
        for n in 0..14 {
            let x = 0.42 + 0.31 * n as f32;
            let y = EAVES + x * slope - 0.58;
            let px = if side > 0.0 { x } else { WIDTH - x };
            easel.leaf(px, y, if side > 0.0 { 1.1 } else { 2.04 }, 0.36, mix(GOLD, WHITE, 0.3));
        }
    }
}
