//! A drawing as a picture, by [`tiny_skia`]: on a processor, with letters of the program's own font, so that it has the same pixels
//! everywhere but for rounding.

use std::collections::HashMap;

use glam::DVec2;
use tiny_skia::{FillRule, LineCap, LineJoin, Mask, Paint, Path, PathBuilder, Pixmap, Rect, Stroke as Pen, StrokeDash, Transform};
use veduta_city::Rgb;

use crate::drawing::{Align, Baseline, Drawing, Item, SLANT, Stroke, Text};
use crate::letters::Step;
use crate::ribbon::Ribbon;
use crate::{Area, Letters};

/// Most pixels of a picture: an A1 sheet at 400 a inch.
pub const MOST_PIXELS: u64 = 130_000_000;

/// Why there is no picture.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RasterError {
    /// It would be too large, or nothing at all.
    #[error("{width} × {height} pixels cannot be drawn: give fewer pixels an inch or smaller paper; {MOST_PIXELS} are the most")]
    Size {
        /// Pixels across.
        width: u64,
        /// Pixels down.
        height: u64,
    },
    /// The font or the picture's format failed.
    #[error("the picture could not be made: {0}")]
    Failed(String),
}

/// The drawing as a PNG of so many pixels an inch, which it tells.
///
/// # Errors
/// [`RasterError::Size`] if it would have no pixels or more than [`MOST_PIXELS`].
pub fn to_png(drawing: &Drawing, dpi: f64) -> Result<Vec<u8>, RasterError> {
    let pixmap = paint(drawing, dpi)?;
    let mut png = Vec::new();
    let failed = |error: png::EncodingError| RasterError::Failed(error.to_string());
    let mut encoder = png::Encoder::new(&mut png, pixmap.width(), pixmap.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let a_metre = libm::round(dpi / 0.0254) as u32;
    encoder.set_pixel_dims(Some(png::PixelDimensions { xppu: a_metre, yppu: a_metre, unit: png::Unit::Meter }));
    let mut writer = encoder.write_header().map_err(failed)?;
    // Nothing shines through: the paper is opaque.
    let pixels: Vec<u8> = pixmap.pixels().iter().flat_map(|p| [p.red(), p.green(), p.blue()]).collect();
    writer.write_image_data(&pixels).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(png)
}

/// The drawing as pixels, so many an inch.
///
/// # Errors
/// As [`to_png`].
pub fn paint(drawing: &Drawing, dpi: f64) -> Result<Pixmap, RasterError> {
    let scale = dpi / 25.4;
    let [width, height] = [drawing.size_mm.x, drawing.size_mm.y].map(|mm| (mm * scale).round().max(0.0) as u64);
    let too_large = RasterError::Size { width, height };
    if width.saturating_mul(height) > MOST_PIXELS {
        return Err(too_large);
    }
    let pixmap = u32::try_from(width).ok().zip(u32::try_from(height).ok()).and_then(|(w, h)| Pixmap::new(w, h));
    let mut pixmap = pixmap.ok_or(too_large)?;
    let letters = Letters::new().ok_or_else(|| RasterError::Failed("the font cannot be read".to_owned()))?;
    let Rgb(r, g, b) = drawing.paper;
    pixmap.fill(tiny_skia::Color::from_rgba8(r, g, b, u8::MAX));
    let transform = Transform::from_scale(scale as f32, scale as f32);
    let mut painter = Painter { pixmap, transform, mask: None, letters, outlines: HashMap::new() };
    let mut clip = None;
    for group in &drawing.groups {
        if group.clip != clip {
            clip = group.clip;
            painter.clip(clip);
        }
        for item in &group.items {
            painter.item(item);
        }
    }
    Ok(painter.pixmap)
}

struct Painter {
    pixmap: Pixmap,
    transform: Transform,
    mask: Option<Mask>,
    letters: Letters,
    /// Outlines of letters of size 1.
    outlines: HashMap<char, Option<Path>>,
}

fn solid(Rgb(r, g, b): Rgb) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(r, g, b, u8::MAX);
    paint.anti_alias = true;
    paint
}

fn pen(stroke: &Stroke) -> Pen {
    let (line_cap, line_join) = match stroke.is_round {
        true => (LineCap::Round, LineJoin::Round),
        false => (LineCap::Butt, LineJoin::Miter),
    };
    let dashes: Vec<f32> = stroke.dashes.iter().map(|&dash| dash as f32).collect();
    Pen { width: stroke.width as f32, line_cap, line_join, dash: StrokeDash::new(dashes, 0.0), ..Pen::default() }
}

impl Painter {
    fn clip(&mut self, area: Option<Area>) {
        self.mask = area.and_then(|area| {
            let rect = Rect::from_ltrb(area.min.x as f32, area.min.y as f32, area.max.x as f32, area.max.y as f32)?;
            let mut mask = Mask::new(self.pixmap.width(), self.pixmap.height())?;
            mask.fill_path(&PathBuilder::from_rect(rect), FillRule::Winding, true, self.transform);
            Some(mask)
        });
    }

    fn item(&mut self, item: &Item) {
        match item {
            Item::Area { rings, fill, edge } => {
                let Some(path) = path(rings, true) else { return };
                if let Some(fill) = fill {
                    let mask = self.mask.as_ref();
                    self.pixmap.fill_path(&path, &solid(*fill), FillRule::EvenOdd, self.transform, mask);
                }
                if let Some(edge) = edge {
                    self.stroke(&path, edge);
                }
            }
            Item::Line { points, stroke } => {
                if let Some(path) = path(core::slice::from_ref(points), false) {
                    self.stroke(&path, stroke);
                }
            }
            Item::Text(text) => self.text(text),
        }
    }

    fn stroke(&mut self, path: &Path, stroke: &Stroke) {
        self.pixmap.stroke_path(path, &solid(stroke.ink), &pen(stroke), self.transform, self.mask.as_ref());
    }

    fn text(&mut self, text: &Text) {
        let advance = |letter: char| (self.letters.advance(letter) + text.spacing) * text.size;
        let letters: Vec<(char, f64)> = text.words.chars().map(|letter| (letter, advance(letter))).collect();
        let length: f64 = letters.iter().map(|(_, advance)| advance).sum::<f64>() - text.spacing * text.size;
        let (ribbon, mut upto) = match &text.on {
            Baseline::At(at, align) => {
                let share = match align {
                    Align::Start => 0.0,
                    Align::Middle => 0.5,
                    Align::End => 1.0,
                };
                let start = *at - DVec2::new(length * share, 0.0);
                (Ribbon::new(vec![start, start + DVec2::new(length.max(1e-3), 0.0)]), 0.0)
            }
            Baseline::Along(line) => {
                let ribbon = Ribbon::new(line.clone());
                let start = ribbon.as_ref().map_or(0.0, |ribbon| (ribbon.length() - length) / 2.0);
                (ribbon, start)
            }
        };
        let Some(ribbon) = ribbon else { return };
        let mut placed = Vec::with_capacity(letters.len());
        for (letter, advance) in letters {
            // A letter stands on the tangent at its middle.
            let own = advance - text.spacing * text.size;
            let (middle, along) = ribbon.at(upto + own / 2.0);
            placed.push((letter, middle - along * (own / 2.0), along));
            upto += advance;
        }
        if let Some((ink, width)) = text.halo {
            self.letters(&placed, text, ink, Some(2.0 * width / text.size));
        }
        self.letters(&placed, text, text.ink, None);
    }

    fn letters(&mut self, placed: &[(char, DVec2, DVec2)], text: &Text, ink: Rgb, halo: Option<f64>) {
        let slant = if text.is_slanted { -SLANT } else { 0.0 };
        let width = halo.unwrap_or(0.0) + text.weight;
        let round = Stroke { width, ..Stroke::round(ink, 0.0) };
        for &(letter, at, along) in placed {
            let letters = &self.letters;
            let Some(path) = self.outlines.entry(letter).or_insert_with(|| outline(letters, letter)).clone() else { continue };
            let (x, y) = (along * text.size, along.perp() * text.size);
            let leaning = y + x * slant;
            let [xx, xy, yx, yy, tx, ty] = [x.x, x.y, leaning.x, leaning.y, at.x, at.y].map(|v| v as f32);
            let transform = self.transform.pre_concat(Transform::from_row(xx, xy, yx, yy, tx, ty));
            let mask = self.mask.as_ref();
            self.pixmap.fill_path(&path, &solid(ink), FillRule::Winding, transform, mask);
            if width > 0.0 {
                self.pixmap.stroke_path(&path, &solid(ink), &pen(&round), transform, mask);
            }
        }
    }
}

fn path(rings: &[Vec<DVec2>], is_closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for ring in rings {
        for (i, p) in ring.iter().enumerate() {
            let (x, y) = (p.x as f32, p.y as f32);
            if i == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
        }
        if is_closed && !ring.is_empty() {
            builder.close();
        }
    }
    builder.finish()
}

fn outline(letters: &Letters, letter: char) -> Option<Path> {
    let mut builder = PathBuilder::new();
    let xy = |p: DVec2| (p.x as f32, p.y as f32);
    for step in letters.outline(letter) {
        match step {
            Step::Move(p) => builder.move_to(xy(p).0, xy(p).1),
            Step::Line(p) => builder.line_to(xy(p).0, xy(p).1),
            Step::Quad(c, p) => builder.quad_to(xy(c).0, xy(c).1, xy(p).0, xy(p).1),
            Step::Cubic(a, b, p) => builder.cubic_to(xy(a).0, xy(a).1, xy(b).0, xy(b).1, xy(p).0, xy(p).1),
            Step::Close => builder.close(),
        }
    }
    builder.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::Group;

    fn drawing(items: Vec<Item>) -> Drawing {
        let clip = Some(Area::new(DVec2::ZERO, DVec2::new(20.0, 10.0)));
        let groups = vec![Group { name: "all", clip, items }];
        Drawing { size_mm: DVec2::new(25.4, 12.7), paper: Rgb(255, 255, 255), groups, ..Drawing::default() }
    }

    #[test]
    fn a_picture_has_as_many_pixels_as_its_paper_and_tells_how_many_an_inch() {
        let png = to_png(&drawing(Vec::new()), 100.0).expect("small");
        let reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().expect("a PNG");
        let info = reader.info();
        assert_eq!((info.width, info.height), (100, 50));
        assert_eq!(info.pixel_dims.map(|dims| dims.xppu), Some(3937));
        assert_eq!(to_png(&drawing(Vec::new()), 1e6), Err(RasterError::Size { width: 1_000_000, height: 500_000 }));
        assert!(matches!(to_png(&drawing(Vec::new()), 0.0), Err(RasterError::Size { .. })));
    }

    #[test]
    fn shapes_are_filled_clipped_and_holes_stay_free() {
        let square = |at: f64, size: f64| {
            [(0.0, 0.0), (size, 0.0), (size, size), (0.0, size)].map(|(x, y)| DVec2::new(at + x, at + y)).to_vec()
        };
        let area = Item::Area { rings: vec![square(-5.0, 60.0), square(2.0, 4.0)], fill: Some(Rgb(200, 0, 0)), edge: None };
        let pixmap = paint(&drawing(vec![area]), 254.0).expect("small");
        let at = |x: u32, y: u32| pixmap.pixel(x, y).map(|p| (p.red(), p.green()));
        assert_eq!(at(10, 10), Some((200, 0)));
        assert_eq!(at(40, 40), Some((255, 255)), "in the hole");
        assert_eq!(at(230, 50), Some((255, 255)), "beyond the clip");
    }

    #[test]
    fn letters_follow_their_line() {
        let text = |on| Item::Text(Text { on, ..Text::plain("III", 6.0, Rgb(0, 0, 0), DVec2::ZERO, Align::Start) });
        let ink = |item: Item| {
            let pixmap = paint(&drawing(vec![item]), 254.0).expect("small");
            let width = pixmap.width();
            let dark = pixmap
                .pixels()
                .iter()
                .enumerate()
                .filter(|(_, p)| p.red() < 128)
                .map(|(i, _)| (i as u32 % width, i as u32 / width));
            dark.fold((u32::MAX, u32::MAX, 0, 0), |(l, t, r, b), (x, y)| (l.min(x), t.min(y), r.max(x), b.max(y)))
        };
        let (left, top, right, bottom) = ink(text(Baseline::At(DVec2::new(10.0, 8.0), Align::Middle)));
        assert!(left < 100 && right > 100 && (right + left).abs_diff(200) < 6, "{left} {right}");
        assert!((78..=82).contains(&bottom) && (36..=41).contains(&top), "they stand on the line: {top} {bottom}");
        let (left, top, right, bottom) = ink(text(Baseline::Along(vec![DVec2::new(5.0, 1.0), DVec2::new(5.0, 9.0)])));
        assert!(bottom - top > 30 && right - left < 45 && left >= 48, "downwards: {left} {top} {right} {bottom}");
    }
}
