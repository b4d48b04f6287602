use std::path::PathBuf;

use veduta_city::file::FileError;
use veduta_city::{GraphError, OverrideError};
use veduta_growth::plan::StockError;

/// A bake that came to nothing. What stood at the output's place before still stands.
#[derive(Debug, thiserror::Error)]
pub enum BakeError {
    /// The input could not be read.
    #[error("{path}: {source}")]
    Read {
        /// Which file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The input is larger than any map this version takes.
    #[error("{path}: {bytes} bytes are more than the {limit} that a map may have; cut out a smaller area first")]
    TooLarge {
        /// Which file.
        path: PathBuf,
        /// Its size.
        bytes: u64,
        /// The most.
        limit: u64,
    },
    /// The input is of no known kind.
    #[error(
        "{0}: not a map that can be baked; give an OpenStreetMap extract (.osm, .osm.gz, .osm.pbf, Overpass .json), a vector map (.geojson, .shp, .map.ron), a picture of a street map (.png, .jpg, .tif, .webp), a city graph (.graph.ron), a plan (.plan.ron), a description (.words.ron) or a folder with a .graph.ron"
    )]
    UnknownKind(PathBuf),
    /// A plan whose ground is none.
    #[error("{path}: the terrain: {reason}")]
    Terrain {
        /// Which file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// Elevations for a plan.
    #[error("{0}: a plan has its ground already; give elevations with the map or graph that it is grown from")]
    HeightsOfPlan(PathBuf),
    /// A scene folder without a graph or map, or with several.
    #[error("{path}: a scene folder holds exactly one .graph.ron or .map.ron, or the layers of one vector map; this one holds {n}")]
    Scene {
        /// Which folder.
        path: PathBuf,
        /// How many graphs it holds.
        n: usize,
    },
    /// Something was said of an input that cannot be meant.
    #[error("{path}: {detail}")]
    Option {
        /// Which file.
        path: PathBuf,
        /// What is wrong, and what to do.
        detail: String,
    },
    /// A RON file has a mistake.
    #[error(transparent)]
    File(#[from] FileError),
    /// The map could not be surveyed.
    #[error("{0}")]
    Survey(#[from] veduta_survey::SurveyError),
    /// The picture could not be decoded.
    #[error("{0}")]
    Picture(#[from] veduta_survey::raster::PictureError),
    /// The legend of a raster map has a mistake.
    #[error("{0}")]
    Legend(#[from] veduta_survey::raster::LegendError),
    /// The graph is not one that can be grown, or, where the file is one of overrides, not any more after its edits.
    #[error("{path}: {}", list(.errors))]
    Graph {
        /// Which file.
        path: PathBuf,
        /// What is wrong.
        errors: Vec<GraphError>,
    },
    /// The overrides have edits that cannot be meant.
    #[error("{path}: {}", list(.errors))]
    Overrides {
        /// Which file.
        path: PathBuf,
        /// What is wrong.
        errors: Vec<OverrideError>,
    },
    /// The styles cannot be drawn from, or the monuments cannot be built.
    #[error("{path}: {}", list(.errors))]
    Stock {
        /// Which file.
        path: PathBuf,
        /// What is wrong.
        errors: Vec<StockError>,
    },
    /// A model cannot be taken.
    #[error("{path}: {reason}")]
    Model {
        /// Which file.
        path: PathBuf,
        /// What is wrong, and what to do.
        reason: String,
    },
    /// A façade cannot be cut out of its picture.
    #[error("{path}: {reason}")]
    Facade {
        /// Which file.
        path: PathBuf,
        /// What is wrong, and what to do.
        reason: String,
    },
    /// The graph could not be grown.
    #[error("{0}")]
    Grow(#[from] veduta_growth::plan::GrowthError),
    /// The city could not be written.
    #[error("{0}")]
    Store(#[from] veduta_store::StoreError),
    /// The map holds nothing that could be walked.
    #[error("{0}: nothing to walk in: no street or square is left of this map; see the findings above")]
    Empty(PathBuf),
}

/// The first few of several mistakes, and how many more there are.
fn list<E: core::fmt::Display>(errors: &[E]) -> String {
    let mut text: Vec<String> = errors.iter().take(5).map(ToString::to_string).collect();
    if errors.len() > 5 {
        text.push(format!("and {} more", errors.len() - 5));
    }
    text.join("; ")
}
