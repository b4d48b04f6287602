/// Why a map could not be surveyed. Every message names the file and what to do about it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurveyError {
    /// Not one of the formats read here.
    #[error("{name} is neither OSM XML, PBF nor Overpass JSON (plain or gzip): export the area as .osm, .osm.gz or .osm.pbf")]
    NotOsm {
        /// The file.
        name: String,
    },
    /// Neither GeoJSON nor a Shapefile.
    #[error("{name} is neither GeoJSON nor the .shp of a Shapefile: export the layer as one of them (ogr2ogr does)")]
    NotVector {
        /// The file.
        name: String,
    },
    /// A mapping of attributes that cannot be meant.
    #[error("the mapping of attributes cannot be meant: {detail}")]
    Mapping {
        /// What is wrong.
        detail: String,
    },
    /// The file ends before its format does.
    #[error("{name} is cut off: the {format} ends {place}; download or copy it again")]
    Cut {
        /// The file.
        name: String,
        /// Format as people call it.
        format: &'static str,
        /// Where it ends.
        place: String,
    },
    /// The file breaks the rules of its format.
    #[error("{name} is broken {format}: {detail}; download or export it again")]
    Broken {
        /// The file.
        name: String,
        /// Format as people call it.
        format: &'static str,
        /// What is wrong, and where.
        detail: String,
    },
    /// Well-formed, but of a kind that is not read here.
    #[error("{name} uses {feature}, which is not read here: {fix}")]
    Unsupported {
        /// The file.
        name: String,
        /// What it uses.
        feature: String,
        /// What to do.
        fix: &'static str,
    },
    /// More than a survey takes in one piece.
    #[error("{name} holds more than {limit} {what}: cut a smaller extract out of it (osmium extract, Overpass with a bbox)")]
    TooLarge {
        /// The file.
        name: String,
        /// Of what there is too much.
        what: &'static str,
        /// How much is taken.
        limit: u64,
    },
    /// Overpass says itself that its answer is not whole.
    #[error("{name} is not whole: Overpass remarked \"{remark}\"; ask for a smaller area or allow more time")]
    Incomplete {
        /// The file.
        name: String,
        /// Overpass' own words.
        remark: String,
    },
    /// Nothing to walk between or along.
    #[error("{name} has neither streets nor buildings inside its extent ({holds}){findings}: take a map of an inhabited place")]
    Empty {
        /// The file.
        name: String,
        /// What it has instead.
        holds: String,
        /// The first findings, each after a semicolon; may be empty.
        findings: String,
    },
    /// A picture that cannot be put on the ground.
    #[error("{name} cannot be placed: {detail}")]
    Unplaced {
        /// The picture, or the file that should place it.
        name: String,
        /// Why not, and what to do.
        detail: String,
    },
    /// Not one of the elevation formats read here.
    #[error(
        "{name} is neither an ESRI ASCII grid, a GeoTIFF nor an SRTM tile (.hgt), plain or in .zip or .gz: convert it with gdal_translate"
    )]
    NotElevation {
        /// The file.
        name: String,
    },
    /// More cells of elevation than a survey takes.
    #[error(
        "{name} has {columns} x {rows} cells, more than 16384 x 16384: cut the city out of it (gdalwarp -te) or make it coarser (-tr)"
    )]
    GridTooLarge {
        /// The file.
        name: String,
        /// Its columns.
        columns: u64,
        /// Its rows.
        rows: u64,
    },
    /// A grid of elevations that lies beside the city.
    #[error("{name} covers {covers}, and no node of the city, which lies around {city}: give the elevations of the same place")]
    Elsewhere {
        /// The file.
        name: String,
        /// What the grid covers.
        covers: String,
        /// Where the city is.
        city: String,
    },
    /// The graph made of it breaks the model's rules.
    #[error("{name} gives no valid city graph: {detail}")]
    Graph {
        /// The file.
        name: String,
        /// The first errors of the model's validation.
        detail: String,
    },
    /// A description in words that cannot be meant.
    #[error("{name}: {}", list(.mistakes))]
    Words {
        /// Name of the city.
        name: String,
        /// What is wrong, field by field; never empty.
        mistakes: Vec<crate::WordsError>,
    },
}

/// Several mistakes in one line.
fn list(mistakes: &[crate::WordsError]) -> String {
    mistakes.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}
