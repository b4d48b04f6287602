//! Windows' insides: timber sashes, panes that mirror sky and roofs each at its own tilt, curtains behind them.

use glam::Vec3;
use veduta_city::draw::Draw;

use crate::canvas::{Canvas, Rect, Texel, srgb};
use crate::hole::Hole;
use crate::noise::{Noise, falloff, floor, hash, mix, smoothstep, word};

/// What hangs behind the panes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Cloth {
    /// Nothing.
    None,
    /// Drawn to both sides, each covering this share of the width.
    Sides(f32),
    /// Across the lower part up to this share of the height.
    Half(f32),
    /// A blind let down from the top by this share.
    Blind(f32),
}

/// How a window is divided. Lengths are metres.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sash {
    /// Casements side by side.
    pub(crate) leaves: u32,
    /// Panes above one another in each casement.
    pub(crate) rows: u32,
    /// Height of the transom's middle above the window's foot.
    pub(crate) transom: Option<f32>,
    /// Colour of the timber.
    pub(crate) timber: u32,
    /// Breadth of frame and stiles.
    pub(crate) frame: f32,
    /// Curtains.
    pub(crate) cloth: Cloth,
}

/// Depth of the glass behind the wall.
const DEPTH: f32 = -0.14;

/// Fills an opening with a window.
pub(crate) fn sash(canvas: &mut Canvas, hole: &Hole, sash: &Sash, draw: Draw) {
    let timber = Texel::solid(srgb(sash.timber), 0.62).at(DEPTH + 0.04);
    canvas.paint(hole.rect, |x, y| hole.distance(x, y), |_, _| timber.times(0.86));
    let inner = hole.rect.grow(-sash.frame * 0.8, -sash.frame * 0.8);
    let mut lights = Vec::new();
    match sash.transom {
        Some(at) => {
            let (below, above) = (inner.y0 + at - sash.frame * 0.7, inner.y0 + at + sash.frame * 0.7);
            lights.push((Rect { y1: below, ..inner }, sash.rows));
            lights.push((Rect { y0: above, ..inner }, 1));
        }
        None => lights.push((inner, sash.rows)),
    }
    let mut pane = 0;
    for (light, rows) in lights {
        let (width, gap) = (light.width() / sash.leaves as f32, 0.006);
        for leaf in 0..sash.leaves {
            let x0 = light.x0 + width * leaf as f32;
            let casement = Rect::new(x0 + gap, light.y0, x0 + width - gap, light.y1);
            canvas.paint(
                casement,
                |x, y| casement.distance(x, y).max(hole.distance(x, y) + sash.frame * 0.7),
                |x, y| {
                    let lit = 0.12 * falloff((casement.y1 - y).min(x - casement.x0), 0.012);
                    let dim = 0.22 * falloff((y - casement.y0).min(casement.x1 - x), 0.012);
                    timber.times(1.0 + lit - dim).at(DEPTH + 0.05)
                },
            );
            pane = casement_panes(canvas, hole, sash, casement, rows, pane, draw);
        }
    }
}

/// The panes of one casement; returns the number of the next pane.
fn casement_panes(canvas: &mut Canvas, hole: &Hole, sash: &Sash, casement: Rect, rows: u32, first: u64, draw: Draw) -> u64 {
    let (stile, bar) = (sash.frame * 0.72, 0.026);
    let field = casement.grow(-stile, -stile);
    let clear = (field.height() - bar * (rows - 1) as f32) / rows as f32;
    for row in 0..rows {
        let y0 = field.y0 + (clear + bar) * row as f32;
        let pane = Rect { y0, y1: y0 + clear, ..field };
        let rim = sash.frame * 0.7 + stile;
        glaze(
            canvas,
            pane,
            |x, y| pane.distance(x, y).max(hole.distance(x, y) + rim),
            hole.rect,
            sash.cloth,
            draw.part(first + u64::from(row)),
        );
    }
    first + u64::from(rows)
}

/// A wave between 0 and 1 with rounded crests.
fn wave(x: f32) -> f32 {
    let t = x - floor(x) as f32;
    let hump = 4.0 * t * (1.0 - t);
    hump * hump
}

/// One pane of glass: it mirrors dark houses below and sky above, its skyline shifted by the pane's own tilt; daylight falls
/// on cloth behind it.
pub(crate) fn glaze(canvas: &mut Canvas, area: Rect, shape: impl Fn(f32, f32) -> f32, window: Rect, cloth: Cloth, draw: Draw) {
    let (dark, sky, haze) = (srgb(0x0029_2F35), srgb(0x0078_8C9C), srgb(0x0054_6069));
    let fabric = srgb(0x00B8_AD98);
    let tilt = draw.between("tilt", -0.13, 0.13) as f32;
    let lean = draw.between("lean", -0.35, 0.35) as f32;
    let bright = draw.between("bright", 0.75, 1.15) as f32;
    let (swell_x, swell_y) = (draw.between("swell x", -0.03, 0.03) as f32, draw.between("swell y", -0.03, 0.03) as f32);
    canvas.paint(area, &shape, |x, y| {
        let (u, v) = ((x - window.x0) / window.width(), (y - window.y0) / window.height());
        let skyline = 0.56 + tilt + lean * (x - area.cx());
        let open = smoothstep(skyline - 0.05, skyline + 0.16, v);
        let mirrored = dark + (haze - dark) * (open * 0.55 * bright) + (sky - haze) * (open * smoothstep(skyline, 1.15, v) * 0.6);
        let room = mirrored + dark * (0.35 * (1.0 - v));
        let (cover, fold) = drape(cloth, u, v);
        let seen = fabric * mix(0.34, 0.62, fold) * (0.75 + 0.3 * v);
        let edge = 0.4 * falloff(-shape(x, y), 0.022);
        let colour: Vec3 = room.lerp(seen + mirrored * 0.25, cover * 0.8) * (1.0 - edge);
        let swell = swell_x * (x - area.cx()) + swell_y * (y - area.y0);
        Texel::solid(colour, 0.12 + 0.1 * cover).at(DEPTH + swell)
    });
}

/// How far cloth covers a place of the window (0 to 1), and the light on its folds.
fn drape(cloth: Cloth, u: f32, v: f32) -> (f32, f32) {
    match cloth {
        Cloth::None => (0.0, 0.0),
        Cloth::Sides(share) => {
            let from_side = u.min(1.0 - u);
            let edge = share * (0.62 + 0.38 * (v - 0.45).abs() * 2.0);
            (smoothstep(edge + 0.015, edge - 0.015, from_side), wave(from_side * 21.0 + v * 0.6))
        }
        Cloth::Half(height) => {
            let hem = height + 0.01 * wave(u * 11.0);
            (smoothstep(hem + 0.012, hem - 0.012, v) * 0.9, 0.25 + 0.75 * wave(u * 17.0))
        }
        Cloth::Blind(down) => (smoothstep(1.0 - down - 0.008, 1.0 - down + 0.008, v), 0.7 + 0.2 * wave(v * 24.0)),
    }
}

/// Opal glass that tiles: milky, a little cloudy, coloured by the vertex.
pub(crate) fn opal(size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    let clouds = Noise::new(draw.bits("clouds"), 3, 3);
    Canvas::tiling(size, size_m, |u, v| {
        let cloud = clouds.at(u, v);
        Texel { own: Vec3::ZERO, tint: Vec3::splat(0.9 + 0.1 * cloud), height: 0.0005 * cloud, rough: 0.35 }
    })
}

/// Leaded glass that tiles: lozenges of old glass, each at its own tilt, between cames of lead and upright bars; coloured by the
/// vertex.
pub(crate) fn leaded(size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    /// Lozenges a side of the tile.
    const ACROSS: f32 = 8.0;
    let waves = Noise::new(draw.bits("waves"), 9, 13);
    let key = draw.bits("panes");
    Canvas::tiling(size, size_m, |u, v| {
        // Half as high as wide would be squat: lozenges are one and a third times as high.
        let (x, y) = (u * ACROSS, v * ACROSS * 0.75);
        let (a, b) = (x + y, x - y);
        let (i, j) = (floor(a), floor(b));
        let (fa, fb) = (a - i as f32, b - j as f32);
        let came = fa.min(1.0 - fa).min(fb.min(1.0 - fb)) * size_m.0 / ACROSS * 0.8;
        // Lattice steps (1, 1) and (1, −1) are a whole tile after so many.
        let (column, row) = (i + j, i - j);
        let bits = hash(key, column.rem_euclid(2 * ACROSS as i32), row.rem_euclid((1.5 * ACROSS) as i32));
        let bar = (v * 3.0 - (v * 3.0 + 0.5).floor()).abs() * size_m.1 / 3.0;
        let wave = waves.at(u, v);
        let pane = 1.0 + 0.5 * (word(bits, 0) - 0.5) + 0.1 * wave;
        let hue = Vec3::new(1.0 - 0.1 * (word(bits, 1) - 0.5), 1.0, 1.0 + 0.14 * (word(bits, 1) - 0.5));
        let lead = falloff(came - 0.006, 0.006).max(falloff(bar - 0.012, 0.006));
        let tilt = 0.004 * ((word(bits, 2) - 0.5) * (fa - 0.5) + (word(bits, 3) - 0.5) * (fb - 0.5));
        Texel {
            own: Vec3::ZERO,
            tint: hue * mix(pane, 0.35, lead),
            height: 0.006 * lead + tilt + 0.0006 * wave,
            rough: mix(0.16, 0.6, lead),
        }
    })
}
