//! Raster maps.

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
