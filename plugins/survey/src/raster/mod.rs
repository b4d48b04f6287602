//! Raster maps.

mod legend;
mod limits;
mod picture;

pub use legend::{Legend, LegendColour, LegendError, MapClass};
pub use limits::PictureLimits;
pub use picture::{Picture, PictureError};
