//! From the canvas to bytes: normals from relief, mip chains averaged in linear light, encoding.

use std::sync::LazyLock;

use glam::{Vec3, Vec3A};
use veduta_city::Rgb;

use crate::canvas::{Canvas, Texel};

/// Bytes of a colour stay off pure black and pure white by this much.
pub(crate) const MARGIN: u8 = 8;

/// Steepest slope that a normal shows; reveals are walls that a picture can only hint at.
const STEEPEST: f32 = 1.4;

/// Relief that jumps by more than this across the repeat (metres) is an opening on the tile's foot, not a slope.
const STEP: f32 = 0.015;

/// Linear light to sRGB bytes by a table: 16,384 steps are finer than a byte at every level.
pub(crate) struct Encoder {
    table: Vec<u8>,
}

const STEPS: f32 = 16_383.0;

impl Encoder {
    pub(crate) fn new() -> Self {
        let encode = |i: u32| {
            let c = i as f32 / STEPS;
            let s = if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * libm::powf(c, 1.0 / 2.4) - 0.055 };
            ((s * 255.0 + 0.5) as u8).clamp(MARGIN, 255 - MARGIN)
        };
        Self { table: (0..=STEPS as u32).map(encode).collect() }
    }

    fn byte(&self, linear: f32) -> u8 {
        self.table[(linear.clamp(0.0, 1.0) * STEPS + 0.5) as usize]
    }

    /// Colour and share of the wall's colour. With `C = own + tint / 2` and `A` the share of the tinted part in its
    /// luminance, `mix(C, 2 C × wall, A)` gives back `own + tint × wall`: exactly where both parts have one hue.
    pub(crate) fn colour(&self, texel: &Texel) -> [u8; 4] {
        let half = texel.tint * 0.5;
        let sum = texel.own + half;
        let share = luminance(half) / luminance(sum).max(1e-6);
        [self.byte(sum.x), self.byte(sum.y), self.byte(sum.z), (share * 255.0 + 0.5) as u8]
    }
}

/// Linear light in sixteen bits: finer than any step of sRGB, and told by tables both ways.
pub(crate) struct Light {
    linear: [u16; 256],
    srgb: Vec<u8>,
}

impl Light {
    /// The tables, made when they are asked for first.
    pub(crate) fn tables() -> &'static Self {
        static TABLES: LazyLock<Light> = LazyLock::new(|| Light {
            linear: core::array::from_fn(|c| (Rgb(c as u8, 0, 0).to_linear()[0] * 65_535.0 + 0.5) as u16),
            srgb: (0..=u16::MAX).map(|light| Rgb::from_linear([f32::from(light) / 65_535.0; 3]).0).collect(),
        });
        &TABLES
    }

    pub(crate) fn linear(&self, Rgb(r, g, b): Rgb) -> [u16; 3] {
        let of = |c: u8| self.linear[usize::from(c)];
        [of(r), of(g), of(b)]
    }

    /// From 0 to 1.
    pub(crate) fn linear_of(&self, colour: Rgb) -> Vec3A {
        Vec3A::from_array(self.linear(colour).map(f32::from)) / 65_535.0
    }

    pub(crate) fn srgb(&self, [r, g, b]: [u16; 3]) -> Rgb {
        let of = |c: u16| self.srgb[usize::from(c)];
        Rgb(of(r), of(g), of(b))
    }

    /// Of light from 0 to 1; what is beyond is bounded.
    pub(crate) fn srgb_of(&self, light: Vec3A) -> Rgb {
        self.srgb((light * 65_535.0 + 0.5).to_array().map(|c| c as u16))
    }
}

/// The mean of four colours in linear light.
pub(crate) fn mean_light(four: [[u16; 3]; 4]) -> [u16; 3] {
    let [p, q, r, s] = four;
    let mean = |c: usize| ((u32::from(p[c]) + u32::from(q[c]) + u32::from(r[c]) + u32::from(s[c]) + 2) / 4) as u16;
    [mean(0), mean(1), mean(2)]
}

fn luminance(c: Vec3) -> f32 {
    0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z
}

/// A part of a unit normal as a byte.
pub(crate) fn signed(c: f32) -> u8 {
    (128.0 + c * 127.0 + 0.5).clamp(1.0, 255.0) as u8
}

/// A share of one as a byte.
pub(crate) fn share(c: f32) -> u8 {
    (c * 255.0 + 0.5) as u8
}

/// A pixel's normal (unit length at mip 0, shorter where averaged) and roughness.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Facet {
    normal: Vec3,
    rough: f32,
}

impl Facet {
    /// Normal and roughness in bytes. What averaging took from the normal's length is added to the roughness (after
    /// Toksvig 2005), so that far walls do not glint.
    pub(crate) fn bytes(&self) -> [u8; 4] {
        let length = self.normal.length().max(1e-3);
        let n = self.normal / length;
        let spread = ((1.0 - length) / length).clamp(0.0, 1.0);
        let rough = (self.rough * self.rough + 0.5 * spread).sqrt();
        [share(rough.clamp(0.04, 1.0)), signed(n.y), signed(n.y), signed(n.x)]
    }
}

/// Normals of a canvas from the slope of its relief, which repeats in both directions.
pub(crate) fn facets(canvas: &Canvas) -> Vec<Facet> {
    let n = canvas.size;
    let slope_x = n as f32 / (2.0 * canvas.size_m.0);
    let slope_y = n as f32 / (2.0 * canvas.size_m.1);
    let height = |row: usize, column: usize| canvas.texels[row * n + column].height;
    let mut facets = Vec::with_capacity(n * n);
    for row in 0..n {
        let (above, below) = ((row + n - 1) % n, (row + 1) % n);
        for column in 0..n {
            let here = canvas.texels[row * n + column];
            let across = |beyond: f32, wraps: bool| if wraps && (beyond - here.height).abs() > STEP { here.height } else { beyond };
            let dx = height(row, (column + 1) % n) - height(row, (column + n - 1) % n);
            let dy = across(height(above, column), row == 0) - across(height(below, column), row + 1 == n);
            let (mut sx, mut sy) = (dx * slope_x, dy * slope_y);
            let steep = (sx * sx + sy * sy).sqrt();
            if steep > STEEPEST {
                (sx, sy) = (sx * STEEPEST / steep, sy * STEEPEST / steep);
            }
            let normal = Vec3::new(-sx, -sy, 1.0);
            facets.push(Facet { normal: normal / normal.length(), rough: here.rough });
        }
    }
    facets
}

/// The next smaller picture: means of two by two.
pub(crate) fn halve<T: Copy, U>(size: usize, from: &[T], mean: impl Fn([T; 4]) -> U) -> Vec<U> {
    let half = size / 2;
    let mut to = Vec::with_capacity(half * half);
    for row in 0..half {
        let (upper, lower) = from[2 * row * size..(2 * row + 2) * size].split_at(size);
        to.extend(upper.chunks_exact(2).zip(lower.chunks_exact(2)).map(|(a, b)| mean([a[0], a[1], b[0], b[1]])));
    }
    to
}

/// The mean of four texels; both parts of the albedo are linear, so this is the albedo seen from afar.
pub(crate) fn mean_texel(four: [Texel; 4]) -> Texel {
    let [a, b, c, d] = four;
    a.lerp(b, 0.5).lerp(c.lerp(d, 0.5), 0.5)
}

pub(crate) fn mean_facet(four: [Facet; 4]) -> Facet {
    Facet { normal: four.iter().map(|f| f.normal).sum::<Vec3>() * 0.25, rough: four.iter().map(|f| f.rough).sum::<f32>() * 0.25 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::srgb;

    fn decoded([r, g, b, a]: [u8; 4], wall: Vec3) -> Vec3 {
        let c = Vec3::from_array(veduta_city::Rgb(r, g, b).to_linear());
        c * (1.0 - f32::from(a) / 255.0) + c * 2.0 * wall * (f32::from(a) / 255.0)
    }

    #[test]
    fn the_shader_gets_back_own_and_tinted_parts() {
        let (encoder, wall) = (Encoder::new(), srgb(0x00D9_B36C));
        for texel in [Texel::tinted(1.0, 0.9), Texel::trim(1.1), Texel::solid(srgb(0x002B_3238), 0.1)] {
            let want = texel.own + texel.tint * wall;
            let got = decoded(encoder.colour(&texel), wall);
            assert!((got - want).abs().max_element() < 0.02, "{texel:?}: wanted {want}, shader sees {got}");
        }
    }

    #[test]
    fn a_wall_half_of_glass_keeps_its_hue_from_afar() {
        let (encoder, wall) = (Encoder::new(), srgb(0x00D9_B36C));
        let (plaster, glass) = (Texel::tinted(1.0, 0.9), Texel::solid(srgb(0x002B_3238), 0.1));
        let want = (wall + glass.own) * 0.5;
        let got = decoded(encoder.colour(&mean_texel([plaster, glass, glass, plaster])), wall);
        assert!((got - want).abs().max_element() < 0.02, "wanted {want}, shader sees {got}");
    }

    #[test]
    fn slopes_become_normals_that_face_away_from_the_rise() {
        let canvas =
            Canvas::tiling(32, (1.0, 1.0), |u, v| Texel::tinted(1.0, 0.5).at(if u < 0.5 { u } else { 1.0 - u } * 0.5 + v * 0.0));
        let left = facets(&canvas)[16 * 32 + 8].bytes();
        let right = facets(&canvas)[16 * 32 + 24].bytes();
        assert!(left[3] < 90 && right[3] > 166 && left[1] == 128, "{left:?} {right:?}");
    }
}
