//! Roof coverings; all are coloured by the vertex. The image's bottom is towards the eaves.

use glam::Vec3;
use veduta_city::draw::Draw;

use crate::canvas::{Canvas, Texel, srgb};
use crate::noise::{Fractal, Pebbles, falloff, floor, hash, mix, smoothstep, word};

/// A covering of small pieces in rows that overlap towards the eaves, each row shifted by half a piece.
struct Shingles {
    columns: i32,
    rows: i32,
    size_m: (f32, f32),
    /// How far the corners of the lower edge are drawn up, in rows.
    bow: f32,
    /// 2 gives a round tail, more a squarer one.
    power: i32,
    key: u64,
}

/// A place on a piece.
struct OnShingle {
    bits: u64,
    /// Metres above its lower edge.
    above: f32,
    /// Metres to the nearest side joint.
    side: f32,
    /// From its middle, −1 to 1.
    across: f32,
}

impl Shingles {
    fn at(&self, u: f32, v: f32) -> OnShingle {
        let row_m = self.size_m.1 / self.rows as f32;
        let row = floor(v * self.rows as f32);
        let up = v * self.rows as f32 - row as f32;
        // The piece that starts in this row lies over the one that started a row further down; where this one's tail is
        // rounded away, that one shows.
        let upper = self.piece(u, row);
        let tail = self.bow * upper.1.abs().powi(self.power) + 0.05 * (word(upper.0, 3) - 0.5);
        let ((bits, across), above) =
            if up >= tail { (upper, up - tail) } else { (self.piece(u, row - 1), up + 1.0 - self.bow * 0.5) };
        let column_m = self.size_m.0 / self.columns as f32;
        OnShingle { bits, above: above * row_m, side: (1.0 - across.abs()) * column_m / 2.0, across }
    }

    /// Hash of the piece of a row over a place, and the place across it.
    fn piece(&self, u: f32, row: i32) -> (u64, f32) {
        let row = row.rem_euclid(self.rows);
        let x = u * self.columns as f32 + 0.5 * (row % 2) as f32 + 0.05 * (word(hash(self.key, row, -9), 0) - 0.5);
        let column = floor(x);
        (hash(self.key, column.rem_euclid(self.columns), row), (x - column as f32) * 2.0 - 1.0)
    }
}

/// Beaver-tail clay tiles: eleven to the row, twelve rows on two metres, lichen and soot.
pub(crate) fn clay_tiles(size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    let tiles = Shingles { columns: 11, rows: 12, size_m, bow: 0.36, power: 2, key: draw.bits("tiles") };
    let grain = Fractal::new(draw.bits("grain"), 48, 48, 2, 0.7);
    let clouds = Fractal::new(draw.bits("clouds"), 3, 3, 4, 0.6);
    let spots = Pebbles::new(draw.bits("lichen"), 26, 26, 0.9);
    let (lichen, dust) = (srgb(0x008E_8B68), srgb(0x0086_7A6C));
    Canvas::fine_tiling(size, size_m, |u, v| {
        let (grain, cloud) = (grain.at(u, v), clouds.at(u, v));
        let tile = tiles.at(u, v);
        let age = word(tile.bits, 0) - 0.5;
        let odd = smoothstep(0.9, 0.95, word(tile.bits, 1));
        let joint = falloff(tile.side, 0.007);
        let shadow = falloff(0.155 - tile.above, 0.045);
        let lip = falloff(tile.above, 0.014);
        let shade = 0.93 + 0.3 * age - 0.28 * odd + 0.07 * grain + 0.1 * cloud + 0.12 * lip - 0.06 * tile.across * tile.across;
        let light = shade * (1.0 - 0.5 * joint) * (1.0 - 0.5 * shadow);
        let warm = word(tile.bits, 2) - 0.5;
        let tint = Vec3::new(1.0 + 0.05 * warm, 1.0 - 0.06 * warm - 0.04 * cloud, 1.0 - 0.22 * warm) * light;
        let spot = spots.at(u, v);
        let grown = word(spot.bits, 0) * 0.75 + 0.25 * cloud - 0.5;
        let reach = 0.1 + 0.3 * word(spot.bits, 1) * word(spot.bits, 2) + 0.09 * grain;
        let bloom = smoothstep(reach + 0.08, reach - 0.04, spot.near) * smoothstep(0.0, 0.25, grown) * 0.38 * (1.0 - 0.6 * shadow);
        let height = 0.014 * (1.0 - tile.above / 0.2).max(0.0) - 0.006 * joint + 0.001 * grain;
        // A film of dust greys the clay, more on old tiles.
        let film = 0.1 + 0.12 * (0.5 - age) + 0.05 * cloud;
        let clay = Texel { own: dust * (film * light), tint: tint * (1.0 - 0.8 * film), height, rough: 0.85 };
        clay.lerp(Texel { own: lichen * light * 0.9, tint: Vec3::splat(0.15), height: height + 0.002, rough: 0.95 }, bloom)
    })
}

/// Slates: narrower, squarer, bluish and violet by turns, with a faint sheen.
pub(crate) fn slates(size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    let tiles = Shingles { columns: 12, rows: 16, size_m, bow: 0.12, power: 6, key: draw.bits("slates") };
    let grain = Fractal::new(draw.bits("grain"), 30, 60, 2, 0.7);
    let clouds = Fractal::new(draw.bits("clouds"), 3, 3, 3, 0.6);
    Canvas::fine_tiling(size, size_m, |u, v| {
        let (grain, cloud) = (grain.at(u, v), clouds.at(u, v));
        let slate = tiles.at(u, v);
        let joint = falloff(slate.side, 0.006);
        let shadow = falloff(0.123 - slate.above, 0.03);
        let lip = falloff(slate.above, 0.01);
        let shade = 1.05 + 0.34 * (word(slate.bits, 0) - 0.5) + 0.09 * grain + 0.08 * cloud + 0.16 * lip;
        let light = shade * (1.0 - 0.5 * joint) * (1.0 - 0.45 * shadow);
        let blue = word(slate.bits, 1) - 0.5;
        let tint = Vec3::new(1.0 - 0.1 * blue, 1.0, 1.0 + 0.14 * blue) * light;
        let tilt = (word(slate.bits, 2) - 0.5) * 0.06 * slate.across * 0.08;
        let height = 0.009 * (1.0 - slate.above / 0.15).max(0.0) - 0.005 * joint + 0.0012 * grain + tilt;
        Texel { own: Vec3::ZERO, tint, height, rough: 0.55 + 0.12 * word(slate.bits, 3) }
    })
}

/// Sheets with a standing seam every half metre and folded cross joints, dented a little, streaked by rain.
pub(crate) fn sheet_metal(size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    const SHEETS: f32 = 4.0;
    let dents = Fractal::new(draw.bits("dents"), 6, 4, 2, 0.5);
    let runs = Fractal::new(draw.bits("runs"), 44, 2, 3, 0.6);
    let patina = Fractal::new(draw.bits("patina"), 5, 5, 5, 0.62);
    let key = draw.bits("sheets");
    Canvas::tiling(size, size_m, |u, v| {
        let sheet = floor(u * SHEETS);
        let across = u * SHEETS - sheet as f32;
        let edge = across.min(1.0 - across) * size_m.0 / SHEETS;
        let bits = hash(key, sheet, 0);
        let up = v + if sheet % 2 == 0 { 0.2 } else { 0.7 };
        let fold = (up - floor(up) as f32) * size_m.1;
        let seam = falloff(edge, 0.02);
        let beside = falloff((across - 0.05).abs() * size_m.0 / SHEETS, 0.03);
        let (dent, run, patina) = (dents.at(u, v), runs.at(u, v), patina.at(u, v));
        let shade = 1.0 + 0.07 * (word(bits, 0) - 0.5) + 0.05 * dent + 0.08 * run + 0.1 * patina;
        let light = shade * (1.0 + 0.14 * seam) * (1.0 - 0.28 * beside) * (1.0 - 0.28 * falloff(fold, 0.025));
        let hue = Vec3::new(1.0 - 0.07 * patina - 0.04 * run, 1.0 + 0.02 * patina, 1.0 + 0.03 * patina + 0.02 * run);
        let height = 0.028 * seam + 0.012 * dent + 0.006 * falloff((fold - 0.02).abs(), 0.02);
        Texel { own: Vec3::ZERO, tint: hue * light, height, rough: mix(0.48, 0.66, 0.5 + 0.5 * patina) }
    })
}
