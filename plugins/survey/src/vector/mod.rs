//! Vector maps: GeoJSON and ESRI Shapefiles, several layers together.
//!
//! ```text
//!  bytes ──geojson, shapefile, dbf──► features ──space──► degrees ─┐
//!  mapping, layer names, dates ─────► tagging, date ──► tags ──────┴─ elements ──noding──► nodes, ways, relations
//! ```
//! Features become what a file of OpenStreetMap holds, and are then surveyed as such.
//!
//! Readers of its own, since both formats are small: counts in headers are checked against the bytes that are there before
//! anything is allocated, errors name record or line, and nothing is added to the tree of dependencies (the crate `shapefile`
//! would bring `dbase`, `geojson` another set of types to convert from).

mod codepage;
mod date;
mod dbf;
mod elements;
mod feature;
mod geojson;
mod mapping;
mod noding;
mod shapefile;
mod space;
mod succession;
mod tagging;

use veduta_city::Anchor;

pub use date::{Date, ParseDateError};
pub use mapping::{Kind, LayerRule, Mapping};

use crate::osm::MOST_BYTES;
use crate::{Survey, SurveyError, survey_elements};
use elements::Collector;
use feature::{Content, Named};
use space::Space;

/// A layer of a vector map: one GeoJSON file, or one Shapefile with the files beside it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Layer<'a> {
    /// The file's name with its ending; it stands in messages, and may tell what the layer holds.
    pub name: &'a str,
    /// The GeoJSON or `.shp` file, told by content.
    pub bytes: &'a [u8],
    /// The `.dbf` file of a Shapefile: attributes.
    pub dbf: Option<&'a [u8]>,
    /// Its `.prj` file: the coordinate system.
    pub prj: Option<&'a [u8]>,
    /// Its `.cpg` file: the code page of texts.
    pub cpg: Option<&'a [u8]>,
    /// What its features are where their attributes do not tell; stronger than what the mapping says by name.
    pub holds: Option<Kind>,
}

/// Whether bytes look like GeoJSON. Looks at the first kilobytes only; a broken file may pass and fail later.
#[must_use]
pub fn looks_like_geojson(bytes: &[u8]) -> bool {
    geojson::looks_like_geojson(bytes)
}

/// Whether bytes look like the `.shp` file of a Shapefile.
#[must_use]
pub fn looks_like_shapefile(bytes: &[u8]) -> bool {
    shapefile::looks_like_shapefile(bytes)
}

/// Makes a city graph of the layers of a vector map: GeoJSON (degrees as in RFC 7946, or with a `crs` member; plan metres with
/// the `map` member that [`to_geojson`](crate::to_geojson) writes) and ESRI Shapefiles. Of features with dates, those come
/// that stand at `date`; without one, those that have no end. `name` names the city where neither map nor mapping does.
///
/// Lines that touch, end on or cross one another in one plane are joined there; what lies on a bridge or in a tunnel (`layer`,
/// `bridge`, `tunnel`), and motorways (which others meet by ramps alone), pass without meeting.
///
/// ```
/// use veduta_survey::{Layer, Mapping, survey_vector};
///
/// let streets = br#"{"type": "FeatureCollection", "features": [
///   {"type": "Feature", "properties": {"NAZEV": "Long Street"}, "geometry": {"type": "LineString", "coordinates": [[14.0, 50.0], [14.002, 50.0]]}},
///   {"type": "Feature", "properties": {"NAZEV": "Cross Lane"}, "geometry": {"type": "LineString", "coordinates": [[14.001, 49.999], [14.001, 50.001]]}}]}"#;
/// let mapping: Mapping = veduta_city::file::parse("(name: [\"NAZEV\"])", "town.mapping.ron")?;
/// let layers = [Layer { name: "streets.geojson", bytes: streets, ..Layer::default() }];
/// let survey = survey_vector(&layers, &mapping, None, "town")?;
/// assert_eq!((survey.graph.links.len(), survey.graph.nodes.len()), (4, 5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SurveyError`] if a layer is none of the two formats, is broken, cut off or too large, lies in a coordinate system that is
/// not known; if the mapping cannot be meant; or if there is neither a street nor a house.
pub fn survey_vector(layers: &[Layer<'_>], mapping: &Mapping, date: Option<&Date>, name: &str) -> Result<Survey, SurveyError> {
    let wrong = mapping.validate();
    if !wrong.is_empty() {
        return Err(SurveyError::Mapping { detail: wrong.join("; ") });
    }
    let mut collector = Collector::new(mapping, date);
    let mut credits: Vec<String> = Vec::new();
    let mut anchors = Vec::new();
    for layer in layers {
        let content = read(layer)?;
        if !content.attribution.is_empty() && !credits.contains(&content.attribution) {
            credits.push(content.attribution.clone());
        }
        if let Some(Named::Plan(anchor)) = content.crs {
            anchors.push((layer.name, anchor));
        }
        let space = Space::of(&content, layer.name)?;
        collector.add(layer, &content, &space)?;
    }
    let (mut data, mut log) = collector.finish();
    data.anchor = common_anchor(&anchors, layers.len())?.or(data.anchor);
    noding::join(&mut data, mapping.snap_m, &mut log);
    if !mapping.attribution.is_empty() {
        credits = vec![mapping.attribution.clone()];
    } else if credits.is_empty() {
        log.note(
            veduta_city::Id::NONE,
            None,
            "the files name nobody to credit: `attribution` in a mapping does, if a licence asks",
        );
    }
    let mut survey = survey_elements(&data, name, &credits.join("; "), log)?;
    if !mapping.city.is_empty() {
        survey.graph.name.clone_from(&mapping.city);
    }
    Ok(survey)
}

/// The content of a layer, whatever its format.
fn read(layer: &Layer<'_>) -> Result<Content, SurveyError> {
    let files = [Some(layer.bytes), layer.dbf, layer.prj, layer.cpg];
    if files.iter().flatten().any(|bytes| bytes.len() as u64 > MOST_BYTES) {
        return Err(SurveyError::TooLarge { name: layer.name.to_owned(), what: "bytes", limit: MOST_BYTES });
    }
    if looks_like_shapefile(layer.bytes) {
        return shapefile::read(layer.bytes, layer.dbf, layer.prj, layer.cpg, layer.name);
    }
    if looks_like_geojson(layer.bytes) {
        return geojson::read(layer.bytes, layer.name);
    }
    Err(SurveyError::NotVector { name: layer.name.to_owned() })
}

/// The anchor of layers in plan metres, which must be one for all.
fn common_anchor(anchors: &[(&str, Option<Anchor>)], layers: usize) -> Result<Option<Anchor>, SurveyError> {
    let Some(&(name, first)) = anchors.first() else { return Ok(None) };
    let mixed = |name: &str, feature: &str| SurveyError::Unsupported {
        name: name.to_owned(),
        feature: feature.to_owned(),
        fix: "give all layers in one coordinate system",
    };
    if let Some((other, _)) = anchors.iter().find(|(_, anchor)| *anchor != first) {
        return Err(mixed(other, "plan metres about another anchor than the layer before"));
    }
    if first.is_none() && anchors.len() < layers {
        return Err(mixed(name, "plan metres without an anchor beside layers that lie on Earth"));
    }
    Ok(Some(first.unwrap_or_default()))
}
