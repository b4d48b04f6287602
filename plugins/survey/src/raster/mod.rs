//! Raster maps: from a picture of streets to a city graph.
//!
//! ```text
//!  bytes ──Picture::decode──► RGB ──swatches──► its few colours ──guess──► Legend + findings ──► a person corrects it
//!  (PNG, JPEG, TIFF, WebP)     │                                  or Legend::parse ◄──────────── (RON, or JSON)
//!                              ▼                                            │
//!    ┌──────────────────── classify ◄───────────────────────────────────────┘
//!    │                     (a bitmap a class; of a sheet what is within its neatline; where blocks are only outlined, streets
//!    │                     are what is not enclosed)
//!    │
//!    ├─► clean ─ yards ──► skeleton ─► trace ──► sketch ──┬─ squares  ─┐
//!    │   (labels looked    (Zhang–     (nodes,   (pruned, ├─ crossing ─┼─► links, squares ─┐
//!    │    through, noise    Suen)       lines)   measured)└─ ends ─────┘                   ├─► CityGraph
//!    │    absorbed) ─────► blocks: what is left between streets and courses, ─────────────┤
//!    │                     with courtyards; houses in a colour of their own               │
//!    └─► courses: rivers and railways, at a quarter of the resolution ────────────────────┘
//! ```
//!
//! Everything is done on bitmaps of one bit a pixel, 64 pixels a word, or on the few pixels of the skeleton; a distance is
//! measured where it is asked for and nowhere else.
//!
//! # How true
//! On drawn maps of 2048 × 2048 pixels whose streets are known, eight seeds for each of four styles of towns; hard maps have
//! labels, water, railways and parks, and are scanned. The peer is a chain of OpenCV, scikit-image, sknw and shapely.
//! `veduta-bake bench survey --peers DIR --seed 201 --figure-ground` prints this table, and the seconds of every step beside
//! the peer's; a map on which the peer fails is left out of its row.
//!
//! | maps | reader | crossroads F1 | blind alleys F1 | links F1 | topology | width error m | squares F1 | blocks F1 |
//! |---|---|---|---|---|---|---|---|---|
//! | plain | veduta | 0.991 | 0.999 | 0.998 | 0.988 | 0.097 | 0.923 | 1.000 |
//! | plain | peer | 0.967 | 0.989 | 0.994 | 0.971 | 0.123 | 0.790 | 1.000 |
//! | hard | veduta | 0.977 | 0.946 | 0.993 | 0.966 | 0.140 | 0.886 | 0.986 |
//! | hard | peer, 31 of 32 maps | 0.917 | 0.866 | 0.982 | 0.930 | 0.306 | 0.712 | 0.959 |
//! | plain, figure-ground | veduta | 0.991 | 0.999 | 0.998 | 0.988 | 0.096 | 0.917 | 1.000 |
//! | plain, figure-ground | peer | 0.967 | 0.988 | 0.994 | 0.970 | 0.122 | 0.794 | 1.000 |
//! | hard, figure-ground | veduta | 0.980 | 0.951 | 0.994 | 0.959 | 0.110 | 0.883 | 0.985 |
//! | hard, figure-ground | peer | 0.915 | 0.867 | 0.985 | 0.928 | 0.223 | 0.709 | 0.963 |
//!
//! # Limits
//! Of a map of outlines alone, whose streets and blocks are both bare paper ([`Legend::is_outlined`]), the lines must close
//! around the blocks but for gaps narrower than a street, and streets full of rails, or with a house beside them that is drawn
//! open, may be missed; what is wide and lies open to streets is a square or, if it is large, a park, also where it is a river
//! or gardens. The margin of a sheet is left out where a frame ends the map on all four sides; otherwise it must be cut off.
//! Where most streets are one or two pixels wide the picture is read at twice or four times its size; where only some
//! are, those are taken for noise. Squares of more than 160 pixels from the middle to the wall are not found, unless they
//! have a colour of their own. A street has one class where colours tell classes, and one whose edge a label has eaten into
//! may be told narrower there than it is. A courtyard about a house of its own is taken for a street about a block, and one
//! that a gate leads to for a blind alley. Blocks that show houses of their own are built ones like any other: that nothing
//! is to be built between the houses is not said in a graph.
//!
//! # Rejected
//! The `image` crate as a front to the same decoders: it copies JPEG and TIFF once more, takes neither palettes nor JPEG in
//! TIFF, lets cut-off JPEG pass, and cannot say what a decoder will need. Guessing by hue alone: black streets on white and
//! white streets on black differ in nothing else than in how they lie. A distance transform of the whole map: widths are
//! asked for at a few places only. Squares as hulls of loops of short streets, as the papers have them: a region of the
//! picture keeps its shape. Telling houses from blocks by their size: see [`MapClass::House`].

mod bitmap;
mod blocks;
mod bridge;
mod classify;
mod clean;
mod course;
mod crossing;
mod enclosed;
mod ends;
mod filter;
mod graph;
mod ground;
mod guess;
mod house;
mod lanes;
mod legend;
mod limits;
mod measure;
mod morphology;
mod neatline;
mod outline;
mod over;
mod parts;
mod patches;
mod picture;
mod profile;
mod quantise;
mod read;
mod scale;
mod sight;
mod sketch;
mod square;
mod stage;
mod thinning;
mod tint;
mod trace;
mod yard;

pub use bitmap::Bitmap;
pub use guess::guess_legend;
pub use legend::{Legend, LegendColour, LegendError, MapClass};
pub use limits::PictureLimits;
pub use picture::{Picture, PictureError};
pub use quantise::{MOST_SWATCHES, Swatch, nearest_table, swatches, table_index};
pub use stage::{Stage, Stages};
pub use thinning::{thinned, thinned_portably};

use crate::log::Log;
use crate::raster::neatline::Neatline;
use crate::{Georeference, Survey, SurveyError};
use veduta_city::Id;

/// Most pixels a side.
const SIDE_PX: usize = 16_384;

/// Metres that a pixel of a street map may be wide.
pub const SCALES_M: core::ops::RangeInclusive<f64> = 0.02..=20.0;

/// What may be chosen of the survey of a raster map.
#[derive(Debug, Clone, PartialEq)]
pub struct RasterSettings {
    /// Where the picture lies, and how large its pixels are, in [`SCALES_M`].
    pub georeference: Georeference,
    /// Threads for thinning; the result is the same for any number.
    pub threads: usize,
    /// Reads what lies outside of the neatline of a scanned sheet too, the frame that its map ends at.
    pub keeps_margin: bool,
}

/// The metres a pixel by which a map's streets are as wide as streets are: half of their length at least 9 m. Nothing
/// where it shows no street, or has more pixels than are read.
#[must_use]
pub fn scale_by_streets(picture: &Picture, legend: &Legend) -> Option<f64> {
    const ORDINARY_M: f64 = 9.0;
    const FIRST_GUESS: f64 = 0.5;
    if picture.width.max(picture.height) > SIDE_PX {
        return None;
    }
    let neatline = Neatline::of(picture, legend);
    let reading = read::read_within(neatline.as_ref(), picture, legend, FIRST_GUESS, 1, &mut Stages::default(), &mut |_| ());
    let mut streets: Vec<(f64, f64)> = reading.streets.iter().map(|street| (street.width, sketch::length(&street.line))).collect();
    streets.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = streets.iter().map(|s| s.1).sum::<f64>() / 2.0;
    let mut gone = 0.0;
    let median = streets.iter().find(|street| {
        gone += street.1;
        gone >= half
    })?;
    (median.0 > 0.0).then(|| ORDINARY_M / (median.0 / FIRST_GUESS))
}

/// Makes a city graph of a street map's picture. `name` is the file's name; `done` is told the name of each step as it
/// ends. Plan (0, 0) is the picture's lower left corner where only its scale is known, else its middle.
///
/// # Errors
/// [`SurveyError`] if the picture shows no street, has no pixels or more than 16,384 a side, or if its georeference is of a
/// picture of another size, or of a scale that no street map has.
pub fn survey_raster(
    picture: &Picture,
    legend: &Legend,
    settings: &RasterSettings,
    name: &str,
    done: &mut dyn FnMut(&'static str),
) -> Result<Survey, SurveyError> {
    survey_raster_by_stages(picture, legend, settings, name, &mut Stages::default(), done)
}

/// As [`survey_raster`], with [stages](Stage) shown, or one of them given in place of what would be found.
///
/// # Errors
/// As there, and if a stage that is given is of another size than the map.
pub fn survey_raster_by_stages(
    picture: &Picture,
    legend: &Legend,
    settings: &RasterSettings,
    name: &str,
    stages: &mut Stages<'_>,
    done: &mut dyn FnMut(&'static str),
) -> Result<Survey, SurveyError> {
    if picture.width.max(picture.height) > SIDE_PX {
        return Err(SurveyError::TooLarge { name: name.to_owned(), what: "pixels a side", limit: SIDE_PX as u64 });
    }
    let holds = || format!("{} × {} pixels", picture.width, picture.height);
    let empty = || SurveyError::Empty { name: name.to_owned(), holds: holds(), findings: String::new() };
    if picture.width == 0 || picture.height == 0 || picture.pixels.len() != picture.width * picture.height * 3 {
        return Err(empty());
    }
    let (place, mpp) = (&settings.georeference, settings.georeference.metres_per_pixel());
    let unplaced = |detail: String| SurveyError::Unplaced { name: name.to_owned(), detail };
    if !SCALES_M.contains(&mpp) {
        let (low, high) = (SCALES_M.start(), SCALES_M.end());
        return Err(unplaced(format!("{mpp} metres a pixel is no scale of a street map: take one from {low} to {high}")));
    }
    let (width, height) = place.size();
    if (picture.width, picture.height) != (width as usize, height as usize) {
        return Err(unplaced(format!("its place is that of a picture of {width} × {height} pixels, but it has {}", holds())));
    }
    if let Some((stage, given)) = stages.given.filter(|(_, given)| (given.width, given.height) != (picture.width, picture.height)) {
        let detail = format!("its {stage} have {} × {} pixels, but the map has {}", given.width, given.height, holds());
        return Err(SurveyError::Broken { name: name.to_owned(), format: "survey stage", detail });
    }
    let mut log = Log::default();
    let sides = place.pixel_size_m();
    if sides.max_element() > 1.02 * sides.min_element() {
        let message = format!(
            "a pixel is {:.3} m wide and {:.3} m high: widths of streets are a mean of the two; resample the map to square pixels",
            sides.x, sides.y
        );
        log.note(Id::NONE, None, message);
    }
    let neatline = if settings.keeps_margin { None } else { Neatline::of(picture, legend) };
    if let Some(neatline) = &neatline {
        let [low, high] = neatline.extent();
        let message = format!(
            "the map is read within its neatline, columns {} to {} and rows {} to {} of {}; `--keep-margin` reads the margin too",
            low.x,
            high.x,
            low.y,
            high.y,
            holds()
        );
        log.note(Id::NONE, None, message);
        done("neatline");
    }
    let reading = read::read_within(neatline.as_ref(), picture, legend, mpp, settings.threads, stages, done);
    let reading = if place.is_placed() { reading.placed(place) } else { reading };
    let mut graph = graph::graph_of(reading, &mut log);
    done("graph");
    if graph.links.is_empty() {
        return Err(empty());
    }
    graph.anchor = place.anchor();
    graph.name = crate::stem(name);
    graph.fill_ids();
    let errors = graph.validate();
    if !errors.is_empty() {
        let detail = errors.iter().take(3).map(ToString::to_string).collect::<Vec<_>>().join("; ");
        return Err(SurveyError::Graph { name: name.to_owned(), detail });
    }
    Ok(Survey { graph, findings: log.finish() })
}
