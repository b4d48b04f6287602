//! Timber: its grain, planks, panelled leaves of doors.

use glam::Vec3;
use veduta_city::draw::Draw;

use crate::canvas::{Canvas, Rect, Texel, srgb};
use crate::moulding::panel;
use crate::noise::{Fractal, falloff, floor, hash, word};

/// Painted or oiled wood with upright grain.
pub(crate) struct Timber {
    colour: Vec3,
    grain: Fractal,
    wear: Fractal,
    size_m: (f32, f32),
}

impl Timber {
    pub(crate) fn new(hex: u32, draw: Draw, size_m: (f32, f32)) -> Self {
        Self {
            colour: srgb(hex),
            grain: Fractal::new(draw.bits("timber grain"), 70, 4, 2, 0.7),
            wear: Fractal::new(draw.bits("timber wear"), 7, 9, 3, 0.6),
            size_m,
        }
    }

    /// The wood at a place.
    pub(crate) fn texel(&self, x: f32, y: f32) -> Texel {
        let (u, v) = (x / self.size_m.0, y / self.size_m.1);
        let (grain, wear) = (self.grain.at(u, v), self.wear.at(u, v));
        let shade = 1.0 + 0.1 * grain + 0.1 * wear;
        Texel { own: self.colour * shade, tint: Vec3::ZERO, height: 0.0015 * grain, rough: 0.58 + 0.06 * wear }
    }
}

/// Paints a shape with wood at a depth.
pub(crate) fn boards(canvas: &mut Canvas, area: Rect, shape: impl Fn(f32, f32) -> f32, timber: &Timber, depth: f32) {
    canvas.paint(area, shape, |x, y| timber.texel(x, y).at(depth));
}

/// A leaf of a door with a stack of sunk panels, given as shares of its height from the foot (low, high).
pub(crate) fn leaf(canvas: &mut Canvas, rect: Rect, timber: &Timber, panels: &[(f32, f32)], columns: u32, depth: f32) {
    canvas.paint_rect(rect, |x, y| {
        let seam = 0.35 * falloff((x - rect.x0).min(rect.x1 - x), 0.014);
        timber.texel(x, y).times(1.0 - seam).at(depth)
    });
    let stile = 0.085_f32.min(rect.width() * 0.17);
    let clear = (rect.width() - stile * (columns + 1) as f32) / columns as f32;
    for &(low, high) in panels {
        for column in 0..columns {
            let x0 = rect.x0 + stile + (clear + stile) * column as f32;
            let field = Rect::new(x0, rect.y0 + rect.height() * low, x0 + clear, rect.y0 + rect.height() * high);
            let base = Texel::solid(timber.colour * 0.93, 0.58).at(depth);
            panel(canvas, field, 0.026, base, 0.02);
            // The raised middle of the panel.
            let middle = field.grow(-0.06, -0.06);
            if middle.width() > 0.06 {
                canvas.slab(middle, Texel::solid(timber.colour * 1.04, 0.55).at(depth - 0.02), 0.012);
            }
        }
    }
}

/// Upright planks that tile, 12.5 cm wide and 2 m long; coloured by the vertex.
pub(crate) fn planks(size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    const COUNT: f32 = 16.0;
    let grain = Fractal::new(draw.bits("grain"), 96, 5, 2, 0.7);
    let rings = Fractal::new(draw.bits("rings"), 32, 3, 2, 0.6);
    let wear = Fractal::new(draw.bits("wear"), 5, 5, 3, 0.6);
    let key = draw.bits("planks");
    Canvas::tiling(size, size_m, |u, v| {
        let plank = floor(u * COUNT);
        let bits = hash(key, plank, 0);
        let across = u * COUNT - plank as f32;
        let edge = across.min(1.0 - across) * size_m.0 / COUNT;
        let end = v + word(bits, 2);
        let butt = (end - floor(end) as f32 - 0.5).abs() * size_m.1;
        let gap = falloff(edge, 0.009).max(falloff(butt, 0.008));
        let lengthwise = v + word(bits, 1);
        let (grain, ring, wear) = (grain.at(u, lengthwise), rings.at(u, lengthwise), wear.at(u, v));
        let nail = falloff(((butt - 0.05).abs().powi(2) + (edge - 0.03).abs().powi(2)).sqrt(), 0.011);
        let shade = 1.06 + 0.24 * (word(bits, 0) - 0.5) + 0.09 * grain + 0.09 * ring + 0.07 * wear - 0.25 * nail;
        let hue = Vec3::new(1.0, 1.0 + 0.05 * (word(bits, 3) - 0.5), 1.0 + 0.14 * (word(bits, 3) - 0.5));
        let height = 0.0015 * grain - 0.01 * gap;
        Texel { own: Vec3::ZERO, tint: hue * (shade * (1.0 - 0.55 * gap)), height, rough: 0.78 + 0.06 * grain }
    })
}
