//! Raster maps: from a picture of streets to a city graph.
//!
//! ```text
//!  picture ─ legend ─► classify ─► clean ────────────► skeleton ─► trace ─► sketch ─┬─ squares ─┐
//!  (RGB)               (a bitmap   (labels looked       (Zhang–     (nodes,  (pruned, │  crossing ├─► links, squares
//!                       a class)    through, noise      Suen)        lines)  measured)└─ ends ────┘
//!                          │        absorbed) ─► blocks: what is left between streets and courses
//!                          └─► courses: rivers and railways, at a quarter of the resolution
//! ```
//!
//! Everything is done on bitmaps of one bit a pixel, 64 pixels a word, or on the few pixels of the skeleton; a distance is
//! measured where it is asked for and nowhere else.

mod bitmap;
mod blocks;
mod bridge;
mod classify;
mod clean;
mod course;
mod crossing;
mod ends;
mod filter;
mod graph;
mod guess;
mod legend;
mod limits;
mod measure;
mod morphology;
mod outline;
mod picture;
mod quantise;
mod read;
mod sight;
mod sketch;
mod square;
mod thinning;
mod trace;

pub use bitmap::Bitmap;
pub use guess::{Guess, guess, guess_legend};
pub use legend::{Legend, LegendColour, LegendError, MapClass};
pub use limits::PictureLimits;
pub use picture::{Picture, PictureError};
pub use quantise::{MOST_SWATCHES, Swatch, nearest_table, swatches, table_index};
pub use thinning::{thinned, thinned_portably};

use crate::log::Log;
use crate::{Survey, SurveyError};

/// What may be chosen of the survey of a raster map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RasterSettings {
    /// Metres a pixel.
    pub metres_per_pixel: f64,
    /// Threads for thinning; the result is the same for any number.
    pub threads: usize,
}

/// Makes a city graph of a street map's picture. `name` is the file's name; `done` is told the name of each step as it
/// ends. Plan (0, 0) is the picture's lower left corner.
///
/// # Errors
/// [`SurveyError`] if the picture shows no street, or is wider than 16,384 pixels.
pub fn survey_raster(
    picture: &Picture,
    legend: &Legend,
    settings: &RasterSettings,
    name: &str,
    done: &mut dyn FnMut(&'static str),
) -> Result<Survey, SurveyError> {
    const SIDE_PX: usize = 16_384;
    if picture.width.max(picture.height) > SIDE_PX {
        return Err(SurveyError::TooLarge { name: name.to_owned(), what: "pixels a side", limit: SIDE_PX as u64 });
    }
    let mut log = Log::default();
    let reading = read::read_map(picture, legend, settings.metres_per_pixel, settings.threads, done);
    let mut graph = graph::graph_of(reading, &mut log);
    done("graph");
    if graph.links.is_empty() {
        let holds = format!("{} × {} pixels", picture.width, picture.height);
        return Err(SurveyError::Empty { name: name.to_owned(), holds, findings: String::new() });
    }
    graph.name = crate::stem(name);
    graph.fill_ids();
    let errors = graph.validate();
    if !errors.is_empty() {
        let detail = errors.iter().take(3).map(ToString::to_string).collect::<Vec<_>>().join("; ");
        return Err(SurveyError::Graph { name: name.to_owned(), detail });
    }
    Ok(Survey { graph, findings: log.finish() })
}
