//! House at the Minute: sgraffito of about 1600, cream scratched out of dark plaster.

use crate::age;
use crate::easel::{Easel, line, mix};
use crate::joinery::Sash;

const CREAM: u32 = 0xe4_d8bc;
const DARK: u32 = 0x78_634b;
const STONE: u32 = 0xb4_a184;

pub fn paint() -> Easel {
    let (width, height) = (13.8, 15.5);
    let mut easel = Easel::new((width, height), 2048, DARK);
    let sash = Sash { frame: 0x5a_3a26, columns: 2, rows: 3, look: 0 };
    // Rusticated foot, as of stones cut like diamonds: sixteen in a course, three from one arch to the next.
    for row in 0..8 {
        for stone in 0..17 {
            let (w, h) = (width / 16.0, 0.48);
            let (x, y) = (stone as f32 * w - if row % 2 == 0 { 0.0 } else { w / 2.0 }, row as f32 * h);
            let (cx, cy) = (x + w / 2.0, y + h / 2.0);
            easel.polygon(&[(x, y), (x + w, y), (cx, cy)], mix(DARK, 0x00_0000, 0.18));
            easel.polygon(&[(x, y + h), (x, y), (cx, cy)], mix(CREAM, DARK, 0.35));
            easel.polygon(&[(x + w, y + h), (x, y + h), (cx, cy)], CREAM);
            easel.polygon(&[(x + w, y), (x + w, y + h), (cx, cy)], mix(CREAM, DARK, 0.62));
        }
    }
    // Friezes between the storeys.
    for y in [3.84, 7.34, 10.84] {
        band(&mut easel, width, y, 0.86);
        easel.scrolls(0.2, width - 0.2, y + 0.43, 0.8, CREAM);
    }
    // Candelabra between the windows, garlands over them.
    for row in [4.85, 8.35] {
        for n in 0..6 {
            easel.candelabrum(0.4 + 2.6 * n as f32, row, 2.2, CREAM, DARK);
        }
    }
    for row in [5.0, 8.5] {
        for n in 0..5 {
            let x = 1.125 + 2.6 * n as f32;
            surround(&mut easel, x, row, 1.15, 1.9);
            easel.window((x, row, 1.15, 1.9), 0.0, Sash { look: n % 2, ..sash });
            easel.sill(x, row, 1.15, STONE);
        }
    }
    // Lunettes under the eaves, with a window in every second.
    for n in 0..11 {
        let x = 0.05 + 1.2454 * (n as f32 + 0.5);
        let arc: Vec<(f32, f32)> = (0..=16)
            .map(|i| (i as f32 / 16.0 * std::f32::consts::PI).sin_cos())
            .map(|(s, c)| (x - 0.56 * c, 14.2 + 0.56 * s))
            .collect();
        if let Some(path) = line(&arc, false) {
            easel.stroke(&path, 0.07, CREAM);
        }
        for petal in 0..5 {
            easel.leaf(x, 14.22, 0.35 + petal as f32 * 0.61, 0.42, CREAM);
        }
    }
    for n in 0..5 {
        let x = 1.2 + 2.6 * n as f32;
        surround(&mut easel, x, 12.15, 1.0, 1.25);
        easel.window((x, 12.15, 1.0, 1.25), 0.0, Sash { rows: 2, look: n % 2, ..sash });
        easel.sill(x, 12.15, 1.0, STONE);
    }
    for n in 0..6 {
        let x = 0.4 + 2.6 * n as f32;
        easel.spiral((x, 12.75), 0.42, 1.6, 1.0, CREAM);
    }
    // Ground floor: shops and the door under segmental arches.
    for (n, x) in [0.7, 3.2875, 8.4625, 11.05].into_iter().enumerate() {
        arch(&mut easel, x, 2.05, 3.0);
        easel.shop((x, 0.0, 2.05, 3.0), 0.41, 0x43_3126, n as u32 / 2 * 31);
    }
    arch(&mut easel, 6.15, 1.5, 3.2);
    easel.door((6.15, 0.0, 1.5, 3.2), 0.75, 0x54_2e22);
    easel.moulding(0.0, height - 0.42, width, 0.42, STONE);
    age(&mut easel, 1.0);
    easel
}

fn band(easel: &mut Easel, width: f32, y: f32, height: f32) {
    easel.rect(0.0, y, width, height, mix(DARK, 0x00_0000, 0.12));
    for edge in [y, y + height - 0.07] {
        easel.rect(0.0, edge, width, 0.07, CREAM);
    }
    // Sixteen from window to window.
    for n in 0..85 {
        easel.disc(0.075 + 0.1625 * n as f32, y + height + 0.05, 0.035, CREAM);
    }
}

/// A painted frame with a small pediment.
fn surround(easel: &mut Easel, x: f32, y: f32, w: f32, h: f32) {
    easel.rect(x - 0.17, y - 0.02, w + 0.34, h + 0.2, CREAM);
    easel.rect(x - 0.11, y, w + 0.22, h + 0.12, mix(CREAM, DARK, 0.45));
    easel.rect(x - 0.07, y, w + 0.14, h + 0.08, CREAM);
    easel.polygon(&[(x - 0.24, y + h + 0.18), (x + w + 0.24, y + h + 0.18), (x + w / 2.0, y + h + 0.52)], CREAM);
    easel.polygon(&[(x + 0.05, y + h + 0.23), (x + w - 0.05, y + h + 0.23), (x + w / 2.0, y + h + 0.42)], DARK);
}

/// Voussoirs about an opening on the ground.
fn arch(easel: &mut Easel, x: f32, w: f32, h: f32) {
    easel.rect(x - 0.24, 0.0, w + 0.48, h - 0.3, STONE);
    let middle = x + w / 2.0;
    for n in 0..9 {
        let (a, b) = (n as f32 / 9.0 * std::f32::consts::PI, (n + 1) as f32 / 9.0 * std::f32::consts::PI);
        let at = |angle: f32, out: f32| (middle - (w / 2.0 + out) * angle.cos(), h - 0.45 + (0.45 + out) * angle.sin());
        let tone = mix(STONE, if n % 2 == 0 { 0xff_f4dc } else { 0x40_3020 }, 0.14);
        easel.polygon(&[at(a, 0.0), at(b, 0.0), at(b, 0.26), at(a, 0.26)], tone);
    }
}
