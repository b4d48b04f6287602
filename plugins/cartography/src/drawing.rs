use glam::DVec2;
use veduta_city::Rgb;

use crate::Area;

/// A map as it is drawn: shapes and letters in millimetres, y downwards from the upper edge.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Drawing {
    /// Width and height, millimetres.
    pub size_mm: DVec2,
    /// What it is a map of.
    pub title: String,
    /// Whom to credit.
    pub credit: String,
    /// Colour of the paper.
    pub paper: Rgb,
    /// In the order in which they are painted.
    pub groups: Vec<Group>,
}

/// What is drawn of one kind.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Group {
    /// What it is: letters and `-`, so that an illustrator finds it again as a layer.
    pub name: &'static str,
    /// Nothing is drawn beyond it.
    pub clip: Option<Area>,
    /// In the order in which they are painted.
    pub items: Vec<Item>,
}

impl Group {
    /// One without anything in it.
    #[must_use]
    pub const fn new(name: &'static str, clip: Option<Area>) -> Self {
        Self { name, clip, items: Vec::new() }
    }
}

/// A pen.
#[derive(Debug, Clone, PartialEq)]
pub struct Stroke {
    /// Colour.
    pub ink: Rgb,
    /// Width, millimetres.
    pub width: f64,
    /// Lengths of dashes and gaps, millimetres; empty: none.
    pub dashes: Vec<f64>,
    /// Whether ends and corners are round; else ends are cut off.
    pub is_round: bool,
}

impl Stroke {
    /// A whole line with cut ends.
    #[must_use]
    pub const fn plain(ink: Rgb, width: f64) -> Self {
        Self { ink, width, dashes: Vec::new(), is_round: false }
    }

    /// A whole line with round ends.
    #[must_use]
    pub const fn round(ink: Rgb, width: f64) -> Self {
        Self { ink, width, dashes: Vec::new(), is_round: true }
    }
}

/// Something that is drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum Item {
    /// An area: rings by the even–odd rule.
    Area {
        /// Its rings; the last vertex joins the first.
        rings: Vec<Vec<DVec2>>,
        /// What it is filled with.
        fill: Option<Rgb>,
        /// What goes round it.
        edge: Option<Stroke>,
    },
    /// A line.
    Line {
        /// Its vertices.
        points: Vec<DVec2>,
        /// Its pen.
        stroke: Stroke,
    },
    /// Letters.
    Text(Text),
}

/// How a line of letters lies about its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Align {
    /// It begins there.
    #[default]
    Start,
    /// Its middle is there.
    Middle,
    /// It ends there.
    End,
}

/// What letters stand on.
#[derive(Debug, Clone, PartialEq)]
pub enum Baseline {
    /// A level line at a place.
    At(DVec2, Align),
    /// A curve; they stand about its middle.
    Along(Vec<DVec2>),
}

/// A line of letters.
#[derive(Debug, Clone, PartialEq)]
pub struct Text {
    /// What is written.
    pub words: String,
    /// Size of the letters, millimetres.
    pub size: f64,
    /// Their colour.
    pub ink: Rgb,
    /// What goes round them, and how far, millimetres.
    pub halo: Option<(Rgb, f64)>,
    /// How much thicker strokes are than the font's, in parts of the size.
    pub weight: f64,
    /// Whether letters lean.
    pub is_slanted: bool,
    /// Room between letters, in parts of the size.
    pub spacing: f64,
    /// What they stand on.
    pub on: Baseline,
}

/// How far a letter that leans does so to the right, as a share of its height.
pub const SLANT: f64 = 0.2;

impl Text {
    /// Upright letters at a place, without a halo.
    #[must_use]
    pub fn plain(words: impl Into<String>, size: f64, ink: Rgb, at: DVec2, align: Align) -> Self {
        let on = Baseline::At(at, align);
        Self { words: words.into(), size, ink, halo: None, weight: 0.025, is_slanted: false, spacing: 0.0, on }
    }

    /// The same, of thicker strokes.
    #[must_use]
    pub fn bold(self) -> Self {
        Self { weight: 0.06, ..self }
    }
}
