//! A canvas in metres, and what façades are painted with.

use tiny_skia::{FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Rect, Stroke, Transform};

/// A picture in the painting: metres from the lower left corner, y up.
pub struct Easel {
    pub pixmap: Pixmap,
    pub scale: f32,
    pub size_m: (f32, f32),
}

/// A colour as 0xRRGGBB.
pub type Colour = u32;

pub fn channels(colour: Colour) -> [u8; 3] {
    [(colour >> 16) as u8, (colour >> 8) as u8, colour as u8]
}

/// Between two colours.
pub fn mix(a: Colour, b: Colour, share: f32) -> Colour {
    let (a, b) = (channels(a), channels(b));
    let [r, g, b] = [0, 1, 2].map(|c| (f32::from(a[c]) + (f32::from(b[c]) - f32::from(a[c])) * share).round() as u32);
    r << 16 | g << 8 | b
}

/// A number from 0 to 1 that follows from a place.
pub fn hash(x: i32, y: i32) -> f32 {
    let mut n = (x as u32).wrapping_mul(0x9E37_79B1) ^ (y as u32).wrapping_mul(0x85EB_CA77);
    n = (n ^ n >> 15).wrapping_mul(0x2C1B_3C6D);
    n = (n ^ n >> 12).wrapping_mul(0x297A_2D39);
    (n ^ n >> 15) as f32 / u32::MAX as f32
}

impl Easel {
    pub fn new(size_m: (f32, f32), longest: u32, ground: Colour) -> Self {
        let scale = longest as f32 / size_m.0.max(size_m.1);
        let side = |m: f32| (m * scale).round() as u32;
        let mut pixmap = Pixmap::new(side(size_m.0), side(size_m.1)).expect("a picture has pixels");
        let [r, g, b] = channels(ground);
        pixmap.fill(tiny_skia::Color::from_rgba8(r, g, b, 255));
        Self { pixmap, scale, size_m }
    }

    fn place(&self) -> Transform {
        Transform::from_row(self.scale, 0.0, 0.0, -self.scale, 0.0, self.size_m.1 * self.scale)
    }

    fn paint(colour: Colour, alpha: f32) -> Paint<'static> {
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        let [r, g, b] = channels(colour);
        paint.set_color_rgba8(r, g, b, (alpha * 255.0).round() as u8);
        paint
    }

    pub fn fill(&mut self, path: &Path, colour: Colour, alpha: f32) {
        let place = self.place();
        self.pixmap.fill_path(path, &Self::paint(colour, alpha), FillRule::Winding, place, None);
    }

    pub fn stroke(&mut self, path: &Path, width: f32, colour: Colour) {
        let stroke = Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
        let place = self.place();
        self.pixmap.stroke_path(path, &Self::paint(colour, 1.0), &stroke, place, None);
    }

    pub fn rect(&mut self, x: f32, y: f32, w: f32, h: f32, colour: Colour) {
        self.shade(x, y, w, h, colour, 1.0);
    }

    pub fn shade(&mut self, x: f32, y: f32, w: f32, h: f32, colour: Colour, alpha: f32) {
        if let Some(rect) = Rect::from_xywh(x, y, w.max(1e-4), h.max(1e-4)) {
            self.fill(&PathBuilder::from_rect(rect), colour, alpha);
        }
    }

    pub fn disc(&mut self, x: f32, y: f32, r: f32, colour: Colour) {
        if let Some(path) = PathBuilder::from_circle(x, y, r) {
            self.fill(&path, colour, 1.0);
        }
    }

    pub fn polygon(&mut self, points: &[(f32, f32)], colour: Colour) {
        if let Some(path) = line(points, true) {
            self.fill(&path, colour, 1.0);
        }
    }

    /// A moulding that runs along: light above, its shadow below.
    pub fn moulding(&mut self, x: f32, y: f32, w: f32, h: f32, colour: Colour) {
        self.shade(x, y - 0.35 * h, w, 0.4 * h, 0x2a_2420, 0.28);
        self.rect(x, y, w, h, mix(colour, 0x00_0000, 0.12));
        self.rect(x, y + 0.35 * h, w, 0.4 * h, colour);
        self.rect(x, y + 0.75 * h, w, 0.25 * h, mix(colour, 0xff_fff8, 0.45));
    }

    /// A leaf from a place in a direction, so long.
    pub fn leaf(&mut self, x: f32, y: f32, angle: f32, length: f32, colour: Colour) {
        let (sin, cos) = angle.sin_cos();
        let at = |along: f32, across: f32| (x + length * (along * cos - across * sin), y + length * (along * sin + across * cos));
        let mut path = PathBuilder::new();
        let ((x0, y0), (xt, yt)) = (at(0.0, 0.0), at(1.0, 0.0));
        path.move_to(x0, y0);
        for side in [0.34, -0.34] {
            let (a, b) = (at(0.25, side), at(0.75, side * 0.8));
            let (to, a, b) = if side > 0.0 { ((xt, yt), a, b) } else { ((x0, y0), b, a) };
            path.cubic_to(a.0, a.1, b.0, b.1, to.0, to.1);
        }
        if let Some(path) = path.finish() {
            self.fill(&path, colour, 1.0);
        }
    }

    /// A spiral that winds inwards, with leaves on its outer side; `turn` is 1 or −1.
    pub fn spiral(&mut self, (x, y): (f32, f32), radius: f32, from: f32, turn: f32, colour: Colour) {
        let at = |t: f32| {
            let (r, angle) = (radius * (1.0 - 0.82 * t), from + turn * 8.2 * t);
            (x + r * angle.cos(), y + r * angle.sin())
        };
        let points: Vec<(f32, f32)> = (0..=60).map(|i| at(i as f32 / 60.0)).collect();
        if let Some(path) = line(&points, false) {
            self.stroke(&path, radius * 0.13, colour);
        }
        for i in [8, 17, 26, 36] {
            let t = i as f32 / 60.0;
            let (px, py) = at(t);
            let outward = (py - y).atan2(px - x);
            self.leaf(px, py, outward + turn * 0.7, radius * (0.55 - 0.35 * t), colour);
        }
        let (px, py) = at(1.0);
        for petal in 0..6 {
            self.leaf(px, py, petal as f32 * 1.047, radius * 0.26, colour);
        }
    }

    /// A frieze of scrolls between two places.
    pub fn scrolls(&mut self, x0: f32, x1: f32, y: f32, height: f32, colour: Colour) {
        let count = ((x1 - x0) / (height * 0.95)).round().max(1.0);
        let step = (x1 - x0) / count;
        let stem: Vec<(f32, f32)> = (0..=160)
            .map(|i| (x0 + (x1 - x0) * i as f32 / 160.0, i as f32 / 160.0 * count * std::f32::consts::PI))
            .map(|(x, a)| (x, y + 0.3 * height * a.cos()))
            .collect();
        if let Some(path) = line(&stem, false) {
            self.stroke(&path, height * 0.055, colour);
        }
        for n in 0..count as i32 {
            let side = if n % 2 == 0 { -1.0 } else { 1.0 };
            let middle = x0 + step * (n as f32 + 0.5);
            self.spiral((middle, y + side * -0.12 * height), height * 0.34, side * -1.4, side, colour);
            self.leaf(middle + 0.35 * step, y + side * 0.2 * height, side * -0.9, height * 0.28, colour);
        }
    }

    /// Vase, leaves and flowers above one another, alike on both sides.
    pub fn candelabrum(&mut self, x: f32, y: f32, height: f32, colour: Colour, ground: Colour) {
        let h = height;
        // Height and half the breadth.
        let knots = [
            (0.0, 0.15),
            (0.025, 0.15),
            (0.05, 0.07),
            (0.10, 0.03),
            (0.15, 0.10),
            (0.22, 0.135),
            (0.29, 0.11),
            (0.32, 0.05),
            (0.345, 0.08),
            (0.37, 0.04),
            (0.55, 0.022),
            (0.61, 0.06),
            (0.66, 0.02),
            (0.92, 0.012),
            (1.0, 0.0),
        ];
        // Turned, so without corners.
        let profile: Vec<(f32, f32)> = knots
            .windows(2)
            .flat_map(|pair| {
                (0..6).map(|i| i as f32 / 6.0).map(move |t| {
                    (pair[0].0 + (pair[1].0 - pair[0].0) * t, pair[0].1 + (pair[1].1 - pair[0].1) * t * t * (3.0 - 2.0 * t))
                })
            })
            .chain([(1.0, 0.0)])
            .collect();
        let right = profile.iter().map(|&(up, out)| (x + out * h, y + up * h));
        let left = profile.iter().rev().map(|&(up, out)| (x - out * h, y + up * h));
        self.polygon(&right.chain(left).collect::<Vec<_>>(), colour);
        for (up, reach, lift) in [(0.36, 0.26, 0.5), (0.42, 0.2, 0.9), (0.64, 0.2, 0.35), (0.68, 0.15, 0.9), (0.93, 0.09, 0.7)] {
            for side in [1.0, -1.0] {
                let angle = if side > 0.0 { lift } else { std::f32::consts::PI - lift };
                self.leaf(x, y + up * h, angle, reach * h, colour);
            }
        }
        for side in [1.0, -1.0] {
            self.spiral((x + side * 0.16 * h, y + 0.54 * h), 0.075 * h, if side > 0.0 { 3.6 } else { -0.4 }, -side, colour);
        }
        self.disc(x, y + 0.22 * h, 0.055 * h, ground);
        for petal in 0..8 {
            self.leaf(x, y + 0.22 * h, petal as f32 * 0.785, 0.05 * h, colour);
        }
    }

    /// All bytes: red, green, blue.
    pub fn bytes(&self) -> Vec<u8> {
        self.pixmap.pixels().iter().flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect()
    }

    /// Weather, by a tone of each place: its share of all three channels.
    pub fn weather(&mut self, tone: impl Fn(f32, f32) -> [f32; 3]) {
        let (width, scale, top) = (self.pixmap.width() as usize, self.scale, self.size_m.1);
        for (i, pixel) in self.pixmap.pixels_mut().iter_mut().enumerate() {
            let (x, y) = ((i % width) as f32 / scale, top - (i / width) as f32 / scale);
            let tone = tone(x, y);
            let [r, g, b] = [(pixel.red(), tone[0]), (pixel.green(), tone[1]), (pixel.blue(), tone[2])]
                .map(|(c, tone)| (f32::from(c) * tone).clamp(6.0, 249.0) as u8);
            *pixel = tiny_skia::ColorU8::from_rgba(r, g, b, 255).premultiply();
        }
    }
}

pub fn line(points: &[(f32, f32)], is_closed: bool) -> Option<Path> {
    let (&(x, y), rest) = points.split_first()?;
    let mut path = PathBuilder::new();
    path.move_to(x, y);
    rest.iter().for_each(|&(x, y)| path.line_to(x, y));
    if is_closed {
        path.close();
    }
    path.finish()
}
