//! House at the Golden Snake: a Baroque front with white mouldings, and the snake that it is called after.

use crate::age;
use crate::easel::{Easel, line, mix};
use crate::joinery::Sash;

const WALL: u32 = 0xd9_a45c;
const WHITE: u32 = 0xee_e6d4;
const SANDSTONE: u32 = 0xb7_9f79;
const GOLD: u32 = 0xc8_9b3a;
/// From one lesene to the next, metres.
const BAY: f32 = 3.9625;

pub fn paint() -> Easel {
    let (width, height) = (16.6, 13.0);
    let mut easel = Easel::new((width, height), 2048, WALL);
    let sash = Sash { frame: 0xe9_e4d8, columns: 2, rows: 3, look: 0 };
    // Ground floor in courses of plaster.
    for course in 0..8 {
        let y = 0.7 + 0.42 * course as f32;
        easel.rect(0.0, y, width, 0.37, mix(WALL, 0xff_f0d8, 0.22));
        easel.rect(0.0, y, width, 0.03, mix(WALL, 0x30_2010, 0.35));
    }
    easel.rect(0.0, 0.0, width, 0.7, mix(SANDSTONE, 0x40_3828, 0.3));
    easel.moulding(0.0, 4.05, width, 0.28, WHITE);
    // Lesenes from there to the cornice.
    for n in 0..5 {
        let x = 0.05 + BAY * n as f32;
        easel.shade(x - 0.04, 4.33, 0.78, 8.0, 0x30_2818, 0.16);
        easel.rect(x, 4.33, 0.65, 8.0, WHITE);
        easel.rect(x + 0.1, 4.55, 0.45, 7.3, mix(WHITE, WALL, 0.35));
        easel.moulding(x - 0.08, 12.0, 0.81, 0.22, WHITE);
        for side in [0.1, 0.55] {
            easel.spiral((x + side, 11.83), 0.13, 1.6, if side < 0.3 { 1.0 } else { -1.0 }, mix(WHITE, 0x60_5030, 0.25));
        }
    }
    // Two windows between lesenes.
    let columns: Vec<f32> = (0..8).map(|n| 1.015 + BAY * (n / 2) as f32 + 1.63 * (n % 2) as f32).collect();
    for (row, (y, h)) in [(5.25, 2.05), (8.95, 1.85)].into_iter().enumerate() {
        for (n, &x) in columns.iter().enumerate() {
            let w = 1.05;
            surround(&mut easel, x, y, w, h, row == 0, n);
            easel.window((x, y, w, h), 0.0, Sash { look: n as i32 % 2, ..sash });
            easel.sill(x, y, w, WHITE);
        }
    }
    // Garlands under the upper windows.
    for &x in &columns {
        for leaf in 0..15 {
            let t = leaf as f32 / 14.0 * 2.0 - 1.0;
            let (lx, ly) = (x + 0.525 + 0.5 * t, 8.62 - 0.26 * (1.0 - t * t));
            let along = (0.52 * t).atan2(0.5);
            for side in [0.5, -0.5] {
                easel.leaf(lx, ly, along + side, 0.17, mix(WHITE, 0x70_6040, 0.14 * (leaf % 3) as f32));
            }
        }
        for side in [0.0, 1.0] {
            easel.disc(x + 0.025 + side, 8.66, 0.06, WHITE);
            easel.leaf(x + 0.025 + side, 8.64, -1.57, 0.3, mix(WHITE, 0x70_6040, 0.1));
        }
    }
    // Doors and shops.
    for (n, x) in [0.4, 3.8, 10.6, 14.0].into_iter().enumerate() {
        frame(&mut easel, x, 2.2, 3.0);
        easel.shop((x, 0.0, 2.2, 3.0), 0.44, [0x2f_4237, 0x4a_2620, 0x33_3b4a, 0x4b_3a22][n], n as u32 * 17 + 5);
    }
    frame(&mut easel, 7.575, 1.45, 3.1);
    easel.door((7.575, 0.0, 1.45, 3.1), 0.725, 0x3c_2a1c);
    snake(&mut easel);
    easel.moulding(0.0, height - 0.62, width, 0.22, WHITE);
    easel.moulding(0.0, height - 0.4, width, 0.4, WHITE);
    age(&mut easel, 0.75);
    easel
}

fn surround(easel: &mut Easel, x: f32, y: f32, w: f32, h: f32, is_noble: bool, n: usize) {
    easel.shade(x - 0.2, y - 0.06, w + 0.46, h + 0.22, 0x30_2010, 0.25);
    easel.rect(x - 0.2, y, w + 0.4, h + 0.2, WHITE);
    easel.rect(x - 0.13, y, w + 0.26, h + 0.13, mix(WHITE, 0x80_7050, 0.25));
    easel.rect(x - 0.08, y, w + 0.16, h + 0.08, WHITE);
    for ear in [x - 0.27, x + w + 0.2 - 0.13] {
        easel.rect(ear, y + h - 0.05, 0.2, 0.25, WHITE);
    }
    if is_noble {
        let (left, right, base) = (x - 0.3, x + w + 0.3, y + h + 0.28);
        let points: Vec<(f32, f32)> = if n.is_multiple_of(2) {
            (0..=14)
                .map(|i| i as f32 / 14.0)
                .map(|t| (right + (left - right) * t, base + 0.08 + 0.34 * (t * std::f32::consts::PI).sin()))
                .collect()
        } else {
            vec![(right, base + 0.06), ((left + right) / 2.0, base + 0.46), (left, base + 0.06)]
        };
        let mut outer = vec![(left, base), (right, base)];
        outer.extend(&points);
        easel.shade(left, base - 0.1, right - left, 0.12, 0x30_2010, 0.3);
        easel.polygon(&outer, WHITE);
        let inner: Vec<(f32, f32)> =
            outer.iter().map(|&(px, py)| (x + w / 2.0 + (px - x - w / 2.0) * 0.72, base + 0.05 + (py - base) * 0.62)).collect();
        easel.polygon(&inner, mix(WALL, 0x60_4820, 0.25));
        for petal in 0..7 {
            easel.leaf(x + w / 2.0, base + 0.09, 0.25 + petal as f32 * 0.44, 0.16, WHITE);
        }
    } else {
        easel.moulding(x - 0.28, y + h + 0.22, w + 0.56, 0.14, WHITE);
        easel.polygon(
            &[
                (x + w / 2.0 - 0.13, y + h + 0.02),
                (x + w / 2.0 + 0.13, y + h + 0.02),
                (x + w / 2.0 + 0.2, y + h + 0.34),
                (x + w / 2.0 - 0.2, y + h + 0.34),
            ],
            mix(WHITE, SANDSTONE, 0.3),
        );
    }
}

fn frame(easel: &mut Easel, x: f32, w: f32, h: f32) {
    easel.shade(x - 0.2, 0.0, w + 0.46, h + 0.1, 0x30_2010, 0.25);
    easel.rect(x - 0.22, 0.0, w + 0.44, h + 0.14, SANDSTONE);
    easel.rect(x - 0.1, 0.0, w + 0.2, h + 0.06, mix(SANDSTONE, 0xff_f4e0, 0.2));
    easel.moulding(x - 0.3, h + 0.14, w + 0.6, 0.16, SANDSTONE);
}

/// The gilded snake over the door, in its cartouche.
fn snake(easel: &mut Easel) {
    let (x, y) = (8.3, 3.62);
    let ring: Vec<(f32, f32)> =
        (0..48).map(|i| (i as f32 / 48.0 * std::f32::consts::TAU).sin_cos()).map(|(s, c)| (x + 0.62 * c, y + 0.30 * s)).collect();
    easel.polygon(&ring, mix(WHITE, SANDSTONE, 0.4));
    let inner: Vec<(f32, f32)> = ring.iter().map(|&(px, py)| (x + (px - x) * 0.88, y + (py - y) * 0.84)).collect();
    easel.polygon(&inner, 0x5b_2f24);
    let body: Vec<(f32, f32)> =
        (0..=60).map(|i| i as f32 / 60.0).map(|t| (x - 0.42 + 0.84 * t, y + 0.13 * (t * 14.0).sin() * (1.0 - 0.5 * t))).collect();
    if let Some(path) = line(&body, false) {
        easel.stroke(&path, 0.085, mix(GOLD, 0x30_1c00, 0.4));
        easel.stroke(&path, 0.06, GOLD);
    }
    easel.disc(x + 0.45, y + 0.05, 0.06, mix(GOLD, 0xff_f0b0, 0.3));
    easel.polygon(&[(x + 0.4, y + 0.1), (x + 0.44, y + 0.2), (x + 0.47, y + 0.12), (x + 0.5, y + 0.2), (x + 0.52, y + 0.09)], GOLD);
}
