//! How a map of a city looks, on paper and on the screen.
//!
//! ```text
//!  Overview ──► Named: streets joined, places, landmarks ──┐
//!  Frame: how plan metres lie on paper or screen ──────────┴─ lay_out ──► Layout: names, signs, pictures ──► screen
//!  Overview + Detail ──► draw: ground, houses, ways, Layout, margin ──► Drawing ──┬─ to_svg ──► text
//!                                                                                └─ to_png ──► bytes
//! ```
//!
//! One cartography serves both: the same inks, kinds of names and their sizes, the same rule for what has room, the same signs, the
//! same little pictures of landmarks. The minimap takes [`Inks`], [`Named`], [`lay_out`] and [`Picture`]; paper takes all of it.
//!
//! # What is decided here
//! | question | answer |
//! |---|---|
//! | where does a street's name stand | along the middle of the street, rounded; at the straightest free place, repeated on long streets |
//! | which name has room | by [kind](NameKind), streets of a kind by length; nothing overlaps, nothing reaches over the edge |
//! | when does a name appear | from a [scale](NameStyle::from_scale) on that is told in ems a metre, alike for paper and any screen |
//! | how is a landmark drawn | its own houses raised from their outlines, seen from the lower edge of the map |
//! | do names flicker | a layout knows where names [stood](Layout::stood) before and keeps them there while it can |
//!
//! # Use
//! ```
//! use veduta_cartography::{Colours, Detail, Layers, MapWords, Order, Paper, Ways, draw, to_svg};
//! use veduta_city::{GridPos, Id, Overview, PlanStreet};
//!
//! let line = [(0.0, 0.0), (200.0, 0.0)].map(|p: (f64, f64)| GridPos::from_metres(p.into())).to_vec();
//! let street = PlanStreet { id: Id(1), name: "Celetná".into(), line, width: 8 * 1024, walkable: true, ..Default::default() };
//! let drawn = draw(&Order {
//!     overview: &Overview { streets: vec![street], ..Overview::default() },
//!     detail: &Detail::default(),
//!     extent: None,
//!     title: "A street",
//!     credit: "",
//!     date: None,
//!     paper: Paper::a(4),
//!     denominator: None,
//!     middle: None,
//!     up_deg: 0.0,
//!     layers: Layers::ALL,
//!     colours: Colours::Paper,
//!     has_index: false,
//!     ways: &Ways::default(),
//!     words: &MapWords::of("en")?,
//!     written: &str::to_owned,
//!     sorted_by: &str::to_lowercase,
//! })?;
//! assert_eq!(drawn.denominator, 750.0);
//! assert!(to_svg(&drawn.drawing).contains("Celetná</textPath>"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Limits
//! The font has Latin, Greek and Cyrillic letters: names in others are text in SVG and gaps in pictures, and [`Drawn::lacking`] tells
//! which. Letters are set without kerning. Contour lines, house numbers and one-way arrows are not drawn.
//!
//! # Rejected
//! `resvg` for pictures: a second reader of what we have just written, with a shaper and a list of fonts, where the letters' places are known
//! already. Icons of landmarks from a list: no city but those in the list would have any. Simulated annealing for names: a
//! little more room used, and another map at every change.

mod body;
mod clash;
mod detail;
mod drawing;
mod frame;
mod gazette;
mod ink;
mod landmark;
mod layout;
mod letters;
mod map;
mod margin;
mod name;
mod named;
mod raster;
mod ribbon;
mod sheet;
mod street;
mod svg;
mod symbol;
mod words;

pub use clash::{Slab, Taken};
pub use detail::Detail;
pub use drawing::{Align, Baseline, Drawing, Group, Item, SLANT, Stroke, Text};
pub use frame::{Area, Frame};
pub use gazette::{Entry, Fields};
pub use ink::{Colours, Inks, Tone};
pub use landmark::{Facet, LANDMARK_M, Landmark, Picture, landmarks};
pub use layout::{Course, LEADING, Layout, Mark, Name, SIGN, Setting, Shown, Sign, Stood, Wanted, lay_out};
pub use letters::{CAPITAL, Letters, SMALL, Step};
pub use map::{Drawn, MapError, Order, Ways, draw};
pub use name::{NameKind, NameStyle};
pub use named::{Layers, Named, tones};
pub use raster::{MOST_PIXELS, RasterError, paint, to_png};
pub use ribbon::{Ribbon, beside};
pub use sheet::{DENOMINATORS, Paper, PaperError, SIDES_MM, Sheet};
pub use street::{StreetLine, join_streets};
pub use svg::to_svg;
pub use symbol::Symbol;
pub use words::{MapWords, UnknownLanguage};
