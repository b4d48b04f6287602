//! Windows, doors and shop fronts.

use tiny_skia::PathBuilder;

use crate::easel::{Colour, Easel, hash, mix};

/// How a window is made.
#[derive(Clone, Copy)]
pub struct Sash {
    pub frame: Colour,
    pub columns: u8,
    pub rows: u8,
    /// Which of its curtains it has: windows that are repeated have the same.
    pub look: i32,
}

/// An opening whose head is an arc that rises so far over its sides; 0 is straight.
fn outline(x: f32, y: f32, w: f32, h: f32, rise: f32) -> tiny_skia::Path {
    let mut path = PathBuilder::new();
    path.move_to(x, y);
    path.line_to(x + w, y);
    path.line_to(x + w, y + h - rise);
    if rise > 0.0 {
        let (half, k) = (w / 2.0, 0.5523);
        path.cubic_to(x + w, y + h - rise * (1.0 - k), x + half + half * k, y + h, x + half, y + h);
        path.cubic_to(x + half - half * k, y + h, x, y + h - rise * (1.0 - k), x, y + h - rise);
    } else {
        path.line_to(x, y + h);
    }
    path.close();
    path.finish().expect("a window has corners")
}

impl Easel {
    /// A hole in the wall with its shaded reveal.
    pub fn hole(&mut self, (x, y, w, h): (f32, f32, f32, f32), rise: f32, jamb: Colour) {
        self.fill(&outline(x, y, w, h, rise), jamb, 1.0);
        self.fill(&outline(x + 0.03, y, w - 0.03, h - 0.05, (rise - 0.02).max(0.0)), mix(jamb, 0x00_0000, 0.35), 1.0);
    }

    /// A window in its hole: frame, panes, curtains, each a little different.
    pub fn window(&mut self, (x, y, w, h): (f32, f32, f32, f32), rise: f32, sash: Sash) {
        let own = hash((w * 970.0) as i32 + (h * 89.0) as i32, sash.look);
        self.hole((x, y, w, h), rise, 0x6b_6156);
        let (bx, by, bw, bh) = (x + 0.07, y + 0.06, w - 0.14, h - 0.13);
        let brise = (rise - 0.05).max(0.0);
        self.fill(&outline(bx, by, bw, bh, brise), sash.frame, 1.0);
        let (columns, rows) = (f32::from(sash.columns), f32::from(sash.rows));
        let (pw, ph) = (bw / columns, bh / rows);
        for column in 0..sash.columns {
            for row in 0..sash.rows {
                let (px, py) = (bx + pw * f32::from(column) + 0.045, by + ph * f32::from(row) + 0.045);
                let (gw, gh) = (pw - 0.09, ph - 0.09);
                let tilt = hash(i32::from(column) + 7 * sash.look, i32::from(row) + (h * 31.0) as i32);
                // Panes under an arch are cut by it.
                let prise = if row + 1 == sash.rows && sash.columns == 1 { (brise - 0.05).max(0.0) } else { 0.0 };
                let is_under_arch = rise > 0.0 && row + 1 == sash.rows && sash.columns > 1;
                let gh = if is_under_arch { (gh - 0.75 * rise).max(0.1) } else { gh };
                self.fill(&outline(px, py, gw, gh, prise), mix(0x1f_262b, 0x34_3f47, tilt), 1.0);
                // Sky in the upper part, houses across the street in the lower.
                let sky = 0.25 + 0.3 * tilt;
                self.shade(px, py + gh * (1.0 - sky), gw, gh * sky - prise, 0x9f_b2bd, 0.30 + 0.25 * tilt);
                if own > 0.45 {
                    let cloth = if own > 0.8 { 0xd8_d0bd } else { 0xb9_b3a4 };
                    let drop = gh * (0.35 + 0.6 * hash((own * 900.0) as i32, 3));
                    let drawn = if column * 2 < sash.columns { 0.0 } else { gw * 0.35 };
                    self.shade(px + drawn, py + gh - drop, gw * 0.65, drop - prise, cloth, 0.42);
                }
            }
        }
        self.shade(x, y + h - rise - 0.16, w, 0.16, 0x10_0c08, 0.38);
        self.shade(x, y, 0.06, h - rise, 0x10_0c08, 0.30);
    }

    /// A sill below an opening.
    pub fn sill(&mut self, x: f32, y: f32, w: f32, colour: Colour) {
        self.moulding(x - 0.14, y - 0.11, w + 0.28, 0.11, colour);
    }

    /// A door of two leaves with panels, a fanlight above.
    pub fn door(&mut self, (x, y, w, h): (f32, f32, f32, f32), rise: f32, timber: Colour) {
        self.hole((x, y, w, h), rise, 0x5d_5348);
        let (bx, bw) = (x + 0.09, w - 0.18);
        let leaf = h - rise - 0.12;
        self.fill(&outline(bx, y, bw, h - 0.1, (rise - 0.06).max(0.0)), mix(timber, 0x00_0000, 0.3), 1.0);
        for side in [0.0, 0.5] {
            let (lx, lw) = (bx + bw * side + 0.02, bw / 2.0 - 0.04);
            self.rect(lx, y + 0.03, lw, leaf, timber);
            for (from, to) in [(0.06, 0.32), (0.37, 0.63), (0.68, 0.94)] {
                let (py, ph) = (y + leaf * from, leaf * (to - from));
                self.rect(lx + 0.09, py, lw - 0.18, ph, mix(timber, 0x00_0000, 0.38));
                self.rect(lx + 0.12, py + 0.03, lw - 0.22, ph - 0.05, mix(timber, 0xff_ffff, 0.10));
            }
        }
        let middle = x + w / 2.0;
        self.disc(middle - 0.07, y + leaf * 0.48, 0.035, 0xb8_9650);
        if rise > 0.0 {
            for spoke in 1..6 {
                let angle = spoke as f32 * std::f32::consts::PI / 6.0;
                let path = crate::easel::line(
                    &[(middle, y + leaf + 0.03), (middle + 0.44 * w * angle.cos(), y + leaf + 0.03 + (rise - 0.1) * angle.sin())],
                    false,
                );
                if let Some(path) = path {
                    self.stroke(&path, 0.03, mix(timber, 0xff_ffff, 0.2));
                }
            }
        }
        self.shade(x, y + h - rise - 0.12, w, 0.14, 0x0c_0806, 0.4);
    }

    /// A shop's window in a timber front.
    pub fn shop(&mut self, (x, y, w, h): (f32, f32, f32, f32), rise: f32, timber: Colour, wares: u32) {
        self.hole((x, y, w, h), rise, 0x5d_5348);
        self.fill(&outline(x + 0.06, y, w - 0.12, h - 0.1, (rise - 0.04).max(0.0)), timber, 1.0);
        self.rect(x + 0.06, y, w - 0.12, 0.45, mix(timber, 0x00_0000, 0.15));
        let (gx, gy, gw, gh) = (x + 0.16, y + 0.52, w - 0.32, h - rise - 0.72);
        self.rect(gx, gy, gw, gh, 0x2b_2a28);
        self.shade(gx, gy + gh * 0.55, gw, gh * 0.45, 0x8fa0a8, 0.35);
        for n in 0..7 {
            let own = hash(wares as i32 + n, 11);
            let (wx, wh) = (gx + gw * (n as f32 + 0.2) / 7.0, gh * (0.18 + 0.3 * own));
            self.rect(wx, gy, gw / 7.0 * 0.7, wh, [0xb0_6a3c, 0x9a_8f5a, 0x7a_3a34, 0xd2_c29a, 0x56_6d5c][(own * 4.99) as usize]);
        }
        for bar in [1.0 / 3.0, 2.0 / 3.0] {
            self.rect(gx + gw * bar - 0.03, gy, 0.06, gh, timber);
        }
        self.rect(x + 0.06, y + h - rise - 0.24, w - 0.12, 0.2, mix(timber, 0xff_ffff, 0.08));
        if rise > 0.0 {
            self.fill(&outline(x + 0.2, y + h - rise, w - 0.4, rise - 0.14, rise - 0.15), 0x3a_4347, 1.0);
        }
        self.shade(x, y + h - rise - 0.1, w, 0.12, 0x0c_0806, 0.35);
    }
}
