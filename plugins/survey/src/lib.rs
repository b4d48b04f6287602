//! Maps to city graph: OpenStreetMap extracts, vector maps of other sources (GeoJSON, Shapefiles), pictures of street maps
//! ([`raster`]), and towns described in words ([`survey_words`]).
//!
//! ```text
//!  bytes ──osm──► nodes, ways, relations ──extent──► plan metres ─┬─ lines, network ──► nodes, links
//!  (XML, gzip,    (raw, by id)                                    ├─ rings, shapes ───► areas ─┬─ squares, parks, waters
//!   PBF, JSON)      ▲                                             │                            └─ buildings, parts
//!                   │                                             ├─ objects, places
//!        ──vector──► joined lines, tags by a mapping                └─ faces, plots ────► blocks for growth to fill
//!  (GeoJSON, Shapefile)                                                                                 graph ──geojson_out──► GeoJSON
//! ```
//!
//! # Use
//! ```
//! let map = br#"<osm version="0.6">
//!   <node id="1" lat="50.0870" lon="14.4200"/> <node id="2" lat="50.0870" lon="14.4210"/>
//!   <way id="7"><nd ref="1"/><nd ref="2"/><tag k="highway" v="pedestrian"/><tag k="name" v="Melantrichova"/></way>
//! </osm>"#;
//! let survey = veduta_survey::survey_osm(map, "old_town.osm")?;
//! assert_eq!(survey.graph.links[0].name, "Melantrichova");
//! for finding in &survey.findings {
//!     println!("{finding}");
//! }
//! # Ok::<(), veduta_survey::SurveyError>(())
//! ```
//!
//! Vector maps go by [`survey_vector`], with a [`Mapping`] where attributes have names of their own.
//!
//! # What it promises
//! - A file is told by its content, not its name; one that is cut off, broken or not whole gives an error that says where,
//!   never part of a city. (A PBF file cut exactly between two blobs cannot be told from a whole one: the format has no end
//!   mark. It then lacks ways, and fails for having no streets.)
//! - Whatever a file holds that does not come out is told in a [`Finding`] with place and reason; what repeats is told once.
//! - Rings are simple, outlines counter-clockwise, holes clockwise, without a repeated vertex, larger than 1 m².
//! - Ids are OSM's own (a way split into links gives its id to the first; the others are named by place). Things of sources
//!   that have no ids of OSM are named by kind and place.
//! - The same bytes give the same graph: elements are taken in order of ids, and no hash map's order is ever looked at.
//!
//! # Limits
//! One extent of up to 50 km; files of up to 1 GiB unpacked and 40 million elements and references. Storeys inside buildings
//! (`indoor=*`), turn restrictions and one-way streets have no place in a city graph. Where a building stands on two
//! layers, all its parts are taken. Plots of a cadastre have no place in a city graph either: those that touch are taken
//! together as a block, up to its building line. Widths of vector maps' streets are one a link.
//!
//! # Rejected
//! The `osmpbf` crate for reading (see `osm/pbf.rs`; tests compare with it). Trusting roles of multipolygon members (wrong
//! too often; nesting follows from the geometry). Guessing heights here: what a tag leaves open, growth decides by seed and
//! style.

mod body;
mod buildings;
mod coast;
mod crs;
mod elevation;
mod error;
mod extent;
mod faces;
mod geojson_out;
mod georeference;
mod grounds;
mod length;
mod lines;
mod log;
mod network;
mod objects;
mod osm;
mod places;
mod plots;
mod polygon;
pub mod raster;
mod rings;
mod shapes;
mod start;
#[cfg(test)]
mod testing;
mod vector;
mod words;

pub use crs::{Crs, CrsError};
pub use elevation::{ElevationGrid, Spike, drape, heights_from_surface};
pub use error::SurveyError;
pub use geojson_out::{GeoJsonSettings, to_geojson};
pub use georeference::{Georeference, KnownPoint};
pub use vector::{Date, Kind, Layer, LayerRule, Mapping, ParseDateError, looks_like_geojson, looks_like_shapefile, survey_vector};
use veduta_city::{CityGraph, Finding, Id, LinkKind, Severity};
pub use words::{CityWords, District, Outside, Part, Passes, Plan, River, TownEdge, WordsError, survey_words};

use crate::extent::Extent;
use crate::log::Log;
use crate::osm::OsmData;

/// What a survey of a map gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    /// The city graph; [`CityGraph::validate`] finds nothing in it.
    pub graph: CityGraph,
    /// What was dropped, repaired or worth a note, with place and reason.
    pub findings: Vec<Finding>,
}

/// Credit that the licence of OpenStreetMap's data asks for.
const ATTRIBUTION: &str = "© OpenStreetMap contributors, ODbL 1.0";

/// Whether bytes look like a map that [`survey_osm`] reads: OSM XML, gzip of it, PBF or Overpass JSON. Looks at the first
/// kilobytes only; a broken file may pass and fail later.
#[must_use]
pub fn looks_like_osm(bytes: &[u8]) -> bool {
    osm::looks_like_osm(bytes)
}

/// Makes a city graph of an OpenStreetMap extract: OSM XML, PBF or Overpass JSON, also packed by gzip, told by content.
/// `name` is the file's name: it stands in messages, and names the city where the map does not.
///
/// # Errors
/// [`SurveyError`] if the bytes are no such file, are cut off or broken, are too many, or show neither a street nor a house.
pub fn survey_osm(bytes: &[u8], name: &str) -> Result<Survey, SurveyError> {
    let data = osm::decode(bytes, name)?;
    survey_elements(&data, name, ATTRIBUTION, Log::default())
}

/// The city of nodes, ways and relations, wherever they come from.
fn survey_elements(data: &OsmData, name: &str, attribution: &str, mut log: Log) -> Result<Survey, SurveyError> {
    tell_unplaced(data, &mut log);
    let Some(extent) = Extent::of(data, &mut log) else { return Err(empty(name, data, log.finish())) };
    let mut graph = graph_of(data, &extent, &mut log);
    attribution.clone_into(&mut graph.attribution);
    let is_empty = graph.buildings.is_empty() && !graph.links.iter().any(|l| matches!(l.kind, LinkKind::Street(_)));
    if is_empty {
        return Err(empty(name, data, log.finish()));
    }
    if graph.name.is_empty() {
        graph.name = stem(name);
    }
    graph.fill_ids();
    let errors = graph.validate();
    if !errors.is_empty() {
        let detail = errors.iter().take(3).map(ToString::to_string).collect::<Vec<_>>().join("; ");
        return Err(SurveyError::Graph { name: name.to_owned(), detail });
    }
    Ok(Survey { graph, findings: log.finish() })
}

fn graph_of(data: &OsmData, extent: &Extent, log: &mut Log) -> CityGraph {
    let network = network::network(data, extent, log);
    let areas = shapes::areas(data, extent, log);
    let buildings = buildings::buildings(&areas, data, extent, log);
    let mut blocks = grounds::greens_and_waters(&areas, log);
    blocks.extend(coast::sea(data, extent, log));
    let built = grounds::built_blocks(&network, &buildings, &areas, &blocks, log);
    blocks.extend(built);
    let mut graph = CityGraph {
        name: places::settlement(data, extent).unwrap_or_default(),
        anchor: extent.anchor,
        margin_m: CityGraph::default_margin_m(),
        squares: grounds::squares(&areas, log),
        blocks,
        objects: objects::objects(data, &areas, &buildings, extent, log),
        places: places::places(data, &areas, extent, log),
        nodes: network.nodes,
        links: network.links,
        buildings,
        ..CityGraph::default()
    };
    graph.start = start::start(&graph);
    graph
}

fn tell_unplaced(data: &OsmData, log: &mut Log) {
    for &number in &data.unplaced {
        log.tally(Severity::Dropped, Id::from_source(1, number as u64), None, "nodes have no position on Earth");
    }
    for (&number, way) in data.ways.iter().filter(|(_, w)| w.tags.has("area:highway")) {
        if !way.tags.is_any("area:highway", &["pedestrian", "footway"]) {
            let id = osm::way_id(number);
            log.tally(Severity::Note, id, None, "area:highway is passed over: streets get their width from their line");
        }
    }
}

fn empty(name: &str, data: &OsmData, findings: Vec<Finding>) -> SurveyError {
    let holds = format!("{} nodes, {} ways, {} relations", data.nodes.len(), data.ways.len(), data.relations.len());
    let findings = findings.iter().take(5).map(|f| format!("; {f}")).collect();
    SurveyError::Empty { name: name.to_owned(), holds, findings }
}

/// A file's name without folders and endings.
fn stem(name: &str) -> String {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let mut stem = file;
    for ending in [".gz", ".pbf", ".osm", ".xml", ".geojson", ".json", ".shp", ".map.ron"] {
        stem = stem.strip_suffix(ending).unwrap_or(stem);
    }
    if stem.is_empty() { file.to_owned() } else { stem.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stem_names_the_city_where_the_map_does_not() {
        assert_eq!(stem("maps/old_town.osm.gz"), "old_town");
        assert_eq!(stem("C:\\krems.osm.pbf"), "krems");
        assert_eq!(stem(".osm"), ".osm");
    }
}
