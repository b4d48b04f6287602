use glam::DVec2;
use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, GlyphId, MetadataProvider};

/// A step of a letter's outline, in parts of the letters' size: y downwards from the baseline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Step {
    /// Begins a contour.
    Move(DVec2),
    /// A straight line.
    Line(DVec2),
    /// A quadratic curve by its control point.
    Quad(DVec2, DVec2),
    /// A cubic curve by its control points.
    Cubic(DVec2, DVec2, DVec2),
    /// Closes the contour.
    Close,
}

/// The letters that maps are written in: Ubuntu Light, which interfaces are written in too (Ubuntu Font Licence 1.0). No font of the
/// system is used, so that the same map has the same letters everywhere.
#[derive(Clone)]
pub struct Letters {
    font: FontRef<'static>,
    em: f64,
}

/// Width of what has no letter, in parts of the size.
const UNKNOWN: f64 = 0.55;
/// Height of a capital in parts of the size.
pub const CAPITAL: f64 = 0.69;
/// Height of a small letter in parts of the size.
pub const SMALL: f64 = 0.52;

impl Letters {
    /// The font; `None` where it cannot be read, which no build of the program does.
    #[must_use]
    pub fn new() -> Option<Self> {
        let font = FontRef::new(epaint_default_fonts::UBUNTU_LIGHT).ok()?;
        let em = f64::from(font.metrics(Size::unscaled(), LocationRef::default()).units_per_em);
        (em > 0.0).then_some(Self { font, em })
    }

    fn glyph(&self, letter: char) -> Option<GlyphId> {
        self.font.charmap().map(letter)
    }

    /// Whether the font has a letter.
    #[must_use]
    pub fn has(&self, letter: char) -> bool {
        letter.is_whitespace() || self.glyph(letter).is_some()
    }

    /// How far a letter takes the pen, in parts of the size.
    #[must_use]
    pub fn advance(&self, letter: char) -> f64 {
        let metrics = self.font.glyph_metrics(Size::unscaled(), LocationRef::default());
        let known = self.glyph(letter).and_then(|glyph| metrics.advance_width(glyph));
        known.map_or(UNKNOWN, |units| f64::from(units) / self.em)
    }

    /// Width of a line of letters, in parts of the size.
    #[must_use]
    pub fn width(&self, text: &str) -> f64 {
        text.chars().map(|letter| self.advance(letter)).sum()
    }

    /// Outline of a letter; empty where it has none.
    #[must_use]
    pub fn outline(&self, letter: char) -> Vec<Step> {
        let outlines = self.font.outline_glyphs();
        let mut pen = Pen { em: self.em, steps: Vec::new() };
        if let Some(glyph) = self.glyph(letter).and_then(|glyph| outlines.get(glyph)) {
            let settings = DrawSettings::unhinted(Size::unscaled(), LocationRef::default());
            if glyph.draw(settings, &mut pen).is_err() {
                pen.steps.clear();
            }
        }
        pen.steps
    }
}

impl core::fmt::Debug for Letters {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Letters").field("em", &self.em).finish_non_exhaustive()
    }
}

struct Pen {
    em: f64,
    steps: Vec<Step>,
}

impl Pen {
    fn at(&self, x: f32, y: f32) -> DVec2 {
        DVec2::new(f64::from(x), -f64::from(y)) / self.em
    }
}

impl OutlinePen for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.steps.push(Step::Move(self.at(x, y)));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.steps.push(Step::Line(self.at(x, y)));
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        self.steps.push(Step::Quad(self.at(cx, cy), self.at(x, y)));
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        self.steps.push(Step::Cubic(self.at(ax, ay), self.at(bx, by), self.at(x, y)));
    }

    fn close(&mut self) {
        self.steps.push(Step::Close);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_have_widths_and_outlines_accents_too() {
        let letters = Letters::new().expect("the font is part of the program");
        for letter in "AáčďéěíňóřšťúůýžÀèìòùßöŁКΩ".chars() {
            assert!(letters.has(letter) && letters.outline(letter).len() > 3, "{letter}");
        }
        assert!(letters.advance('m') > 2.0 * letters.advance('i'));
        assert!((letters.width("Celetná") - "Celetná".chars().map(|c| letters.advance(c)).sum::<f64>()).abs() < 1e-12);
        assert!(!letters.has('م'), "there are no Arabic letters in it");
    }

    #[test]
    fn capitals_and_small_letters_are_as_high_as_is_said() {
        let letters = Letters::new().expect("the font is part of the program");
        for (letter, told) in [('H', CAPITAL), ('x', SMALL)] {
            let ends = letters.outline(letter).into_iter().filter_map(|step| match step {
                Step::Move(p) | Step::Line(p) | Step::Quad(_, p) | Step::Cubic(_, _, p) => Some(-p.y),
                Step::Close => None,
            });
            let top = ends.fold(0.0, f64::max);
            assert!((top - told).abs() < 0.02, "{letter}: {top}");
        }
    }
}
