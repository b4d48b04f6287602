//! The canvas: a picture in metres that holds colour, relief and roughness, and shapes given as signed distances.
//!
//! Places are metres from the lower left corner, x right, y up. A shape is a signed distance in metres, negative inside; its
//! edge is blended over one pixel.

use glam::Vec3;
use veduta_city::Rgb;

use crate::noise::{falloff, smoothstep};

/// What lies at a pixel. Its albedo is `own + tint × wall colour`, all in linear light: linear in both parts, so that
/// blending and averaging are exact whatever the wall's colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Texel {
    /// The part that stands as it is.
    pub(crate) own: Vec3,
    /// The part that is multiplied by the wall's colour; 1 leaves it unchanged.
    pub(crate) tint: Vec3,
    /// Height above the wall in metres.
    pub(crate) height: f32,
    /// Perceptual roughness, 0 to 1.
    pub(crate) rough: f32,
}

/// A colour written as `0xRRGGBB` (sRGB), in linear light.
pub(crate) fn srgb(hex: u32) -> Vec3 {
    Vec3::from_array(Rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8).to_linear())
}

impl Texel {
    /// Coloured by the wall, `by` times as bright.
    pub(crate) fn tinted(by: f32, rough: f32) -> Self {
        Self { own: Vec3::ZERO, tint: Vec3::splat(by), height: 0.0, rough }
    }

    /// A stuff of its own colour (linear).
    pub(crate) fn solid(own: Vec3, rough: f32) -> Self {
        Self { own, tint: Vec3::ZERO, height: 0.0, rough }
    }

    /// Painted plaster of mouldings: the wall's colour drawn towards a warm white.
    pub(crate) fn trim(by: f32) -> Self {
        Self { own: Vec3::new(0.205, 0.192, 0.165) * by, tint: Vec3::splat(0.82 * by), height: 0.0, rough: 0.85 }
    }

    pub(crate) fn at(self, height: f32) -> Self {
        Self { height, ..self }
    }

    #[inline]
    pub(crate) fn times(self, by: f32) -> Self {
        Self { own: self.own * by, tint: self.tint * by, ..self }
    }

    #[inline]
    pub(crate) fn lerp(self, to: Self, t: f32) -> Self {
        Self {
            own: self.own + (to.own - self.own) * t,
            tint: self.tint + (to.tint - self.tint) * t,
            height: self.height + (to.height - self.height) * t,
            rough: self.rough + (to.rough - self.rough) * t,
        }
    }
}

/// An upright rectangle in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rect {
    pub(crate) x0: f32,
    pub(crate) y0: f32,
    pub(crate) x1: f32,
    pub(crate) y1: f32,
}

impl Rect {
    pub(crate) const fn new(x0: f32, y0: f32, x1: f32, y1: f32) -> Self {
        Self { x0, y0, x1, y1 }
    }

    /// By the middle of its foot, its width and its height.
    pub(crate) fn standing(cx: f32, y0: f32, width: f32, height: f32) -> Self {
        Self::new(cx - width / 2.0, y0, cx + width / 2.0, y0 + height)
    }

    pub(crate) fn cx(&self) -> f32 {
        (self.x0 + self.x1) / 2.0
    }

    pub(crate) fn width(&self) -> f32 {
        self.x1 - self.x0
    }

    pub(crate) fn height(&self) -> f32 {
        self.y1 - self.y0
    }

    /// Wider and taller by the given lengths on each side; negative lengths shrink it.
    pub(crate) fn grow(&self, x: f32, y: f32) -> Self {
        Self::new(self.x0 - x, self.y0 - y, self.x1 + x, self.y1 + y)
    }

    #[inline]
    pub(crate) fn distance(&self, x: f32, y: f32) -> f32 {
        let dx = (self.x0 - x).max(x - self.x1);
        let dy = (self.y0 - y).max(y - self.y1);
        if dx > 0.0 && dy > 0.0 { (dx * dx + dy * dy).sqrt() } else { dx.max(dy) }
    }
}

/// Distance to a line from `a` to `b` of the given half-width, round ends.
#[inline]
pub(crate) fn stroke(a: (f32, f32), b: (f32, f32), half: f32, x: f32, y: f32) -> f32 {
    let (px, py, dx, dy) = (x - a.0, y - a.1, b.0 - a.0, b.1 - a.1);
    let t = ((px * dx + py * dy) / (dx * dx + dy * dy).max(1e-9)).clamp(0.0, 1.0);
    let (ex, ey) = (px - dx * t, py - dy * t);
    (ex * ex + ey * ey).sqrt() - half
}

/// Distance to a disc.
#[inline]
pub(crate) fn disc(cx: f32, cy: f32, radius: f32, x: f32, y: f32) -> f32 {
    ((x - cx) * (x - cx) + (y - cy) * (y - cy)).sqrt() - radius
}

/// A picture of `size` × `size` pixels over `size_m` metres.
#[derive(Clone)]
pub(crate) struct Canvas {
    pub(crate) size: usize,
    pub(crate) size_m: (f32, f32),
    /// Rows from the top.
    pub(crate) texels: Vec<Texel>,
}

impl Canvas {
    /// A canvas painted by a function of the place in tiles (u right, v up, both 0 to 1).
    pub(crate) fn tiling(size: u32, size_m: (f32, f32), paint: impl Fn(f32, f32) -> Texel) -> Self {
        let (n, step) = (size as usize, 1.0 / size as f32);
        let mut texels = Vec::with_capacity(n * n);
        for row in 0..n {
            let v = 1.0 - (row as f32 + 0.5) * step;
            texels.extend((0..n).map(|column| paint((column as f32 + 0.5) * step, v)));
        }
        Self { size: n, size_m, texels }
    }

    /// The same, from four samples a pixel: for patterns with hard edges of their own.
    pub(crate) fn fine_tiling(size: u32, size_m: (f32, f32), paint: impl Fn(f32, f32) -> Texel) -> Self {
        let twice = Self::tiling(size * 2, size_m, paint);
        Self { size: size as usize, size_m, texels: crate::mips::halve(twice.size, &twice.texels, crate::mips::mean_texel) }
    }

    /// Mean side of a pixel in metres.
    pub(crate) fn pixel_m(&self) -> f32 {
        (self.size_m.0 + self.size_m.1) / (2.0 * self.size as f32)
    }

    /// Visits the pixels whose centres lie in an area.
    pub(crate) fn each(&mut self, area: Rect, mut visit: impl FnMut(&mut Texel, f32, f32)) {
        let n = self.size;
        let (px, py) = (self.size_m.0 / n as f32, self.size_m.1 / n as f32);
        let index = |at: f32| (at.max(0.0) as usize).min(n);
        let (left, right) = (index(area.x0 / px), index(area.x1 / px + 1.0));
        let (top, bottom) = (index((self.size_m.1 - area.y1) / py), index((self.size_m.1 - area.y0) / py + 1.0));
        for row in top..bottom {
            let y = self.size_m.1 - (row as f32 + 0.5) * py;
            for (i, texel) in self.texels[row * n + left..row * n + right.max(left)].iter_mut().enumerate() {
                visit(texel, ((left + i) as f32 + 0.5) * px, y);
            }
        }
    }

    /// Lays a shape over what is there.
    pub(crate) fn paint(&mut self, area: Rect, distance: impl Fn(f32, f32) -> f32, fill: impl Fn(f32, f32) -> Texel) {
        let pixel = self.pixel_m();
        self.each(area.grow(pixel, pixel), |texel, x, y| {
            let cover = 0.5 - distance(x, y) / pixel;
            if cover >= 1.0 {
                *texel = fill(x, y);
            } else if cover > 0.0 {
                *texel = texel.lerp(fill(x, y), cover);
            }
        });
    }

    /// Lays a rectangle over what is there.
    pub(crate) fn paint_rect(&mut self, rect: Rect, fill: impl Fn(f32, f32) -> Texel) {
        self.paint(rect, |x, y| rect.distance(x, y), fill);
    }

    /// Multiplies the brightness.
    pub(crate) fn shade(&mut self, area: Rect, by: impl Fn(f32, f32) -> f32) {
        self.each(area, |texel, x, y| *texel = texel.times(by(x, y)));
    }

    /// The shadow that a shape standing `proud` metres before the wall throws on it, with light from the upper left, and the
    /// contact shade around it.
    pub(crate) fn cast(&mut self, area: Rect, distance: impl Fn(f32, f32) -> f32, proud: f32, strength: f32) {
        let (right, down, blur) = (0.35 * proud, 0.9 * proud, 0.35 * proud + 0.01);
        self.shade(area.grow(right + proud, down + proud), |x, y| {
            let thrown = smoothstep(blur, -blur * 0.6, distance(x - right, y + down));
            let contact = falloff(distance(x, y), proud * 0.9) * 0.35;
            1.0 - strength * thrown.max(contact)
        });
    }

    /// A block with its cast shadow, a lit upper edge and a shaded lower one.
    pub(crate) fn slab(&mut self, rect: Rect, fill: Texel, proud: f32) {
        self.cast(rect, |x, y| rect.distance(x, y), proud, 0.42);
        let edge = (rect.height() * 0.3).min(0.022).max(self.pixel_m() * 0.7);
        let base = fill.at(fill.height + proud);
        self.paint_rect(rect, |_, y| {
            let lit = 0.13 * falloff(rect.y1 - y, edge) - 0.2 * falloff(y - rect.y0, edge);
            base.times(1.0 + lit)
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_covers_its_area() {
        let mut canvas = Canvas::tiling(64, (2.0, 4.0), |_, _| Texel::tinted(0.0, 0.5));
        canvas.paint_rect(Rect::new(0.5, 1.0, 1.5, 3.0), |_, _| Texel::tinted(1.0, 0.5));
        let covered: f32 = canvas.texels.iter().map(|t| t.tint.x).sum();
        assert!((covered / 4096.0 - 0.25).abs() < 0.005, "a quarter, not {}", covered / 4096.0);
        assert_eq!(canvas.texels[32 * 64 + 32].tint.x, 1.0);
    }

    #[test]
    fn areas_off_the_canvas_are_clipped() {
        let mut canvas = Canvas::tiling(32, (1.0, 1.0), |_, _| Texel::tinted(1.0, 0.5));
        canvas.paint_rect(Rect::new(-5.0, -5.0, 9.0, 0.5), |_, _| Texel::tinted(0.0, 0.5));
        canvas.paint_rect(Rect::new(3.0, 3.0, 4.0, 4.0), |_, _| Texel::tinted(0.0, 0.5));
        assert_eq!(canvas.texels[0].tint.x, 1.0, "the top stays");
        assert_eq!(canvas.texels[31 * 32].tint.x, 0.0, "the foot is painted");
    }

    #[test]
    fn distances_are_signed() {
        let rect = Rect::new(0.0, 0.0, 2.0, 1.0);
        assert_eq!(rect.distance(1.0, 0.5), -0.5);
        assert_eq!(rect.distance(5.0, 5.0), 5.0);
        assert!(stroke((0.0, 0.0), (1.0, 0.0), 0.1, 0.5, 0.05) < 0.0);
        assert!((disc(0.0, 0.0, 1.0, 3.0, 4.0) - 4.0).abs() < 1e-6);
    }
}
