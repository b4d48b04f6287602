//! From a picture of a map to what its colours stand for.
//!
//! ```text
//!  bytes ──Picture::decode──► RGB ──swatches──► its few colours ──guess──► Legend + findings ──► a person corrects it
//!  (PNG, JPEG, TIFF, WebP)                                        or Legend::parse ◄──────────── (RON, or JSON)
//! ```
//!
//! # Rejected
//! The `image` crate as a front to the same decoders: it copies JPEG and TIFF once more, takes neither palettes nor JPEG in
//! TIFF, lets cut-off JPEG pass, and cannot say what a decoder will need. Guessing by hue alone: black streets on white and
//! white streets on black differ in nothing else than in how they lie.

mod guess;
mod legend;
mod limits;
mod picture;
mod quantise;

pub use guess::{Guess, guess, guess_legend};
pub use legend::{Legend, LegendColour, LegendError, MapClass};
pub use limits::PictureLimits;
pub use picture::{Picture, PictureError};
pub use quantise::{MOST_SWATCHES, Swatch, nearest_table, swatches, table_index};
