//! Which attributes of a vector map mean what.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use veduta_city::{RoofShape, StreetClass, Surfacing};

/// What a feature of a vector map is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    /// A house's footprint (polygon).
    Building,
    /// Part of a building with a height of its own (polygon).
    Part,
    /// A street of a class, by its middle line.
    Street(StreetClass),
    /// A ramp between motorways and streets (line).
    Ramp,
    /// A railway with a bed of its own (line).
    Railway,
    /// Rails in a street (line).
    Tram,
    /// A river (line).
    River,
    /// A stream or ditch (line).
    Stream,
    /// Open water (polygon).
    Water,
    /// A park or another green (polygon).
    Park,
    /// A square (polygon).
    Square,
    /// A parcel of the cadastre (polygon).
    Plot,
    /// A block that is built on, from wall to wall of the streets around it (polygon).
    Block,
    /// Land that is no building ground: a field, a yard, a car park (polygon).
    Open,
    /// A tree (point).
    Tree,
    /// Nothing to be taken in.
    Ignore,
}

/// Kinds that stand for one another when a layer is said to hold one of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Family {
    Street,
    Rails,
    Stream,
    House,
    Ground,
    Other,
}

impl Kind {
    pub(super) fn family(self) -> Family {
        match self {
            Self::Street(_) | Self::Ramp => Family::Street,
            Self::Railway | Self::Tram => Family::Rails,
            Self::River | Self::Stream => Family::Stream,
            Self::Building | Self::Part => Family::House,
            Self::Water | Self::Park | Self::Open => Family::Ground,
            Self::Square | Self::Plot | Self::Block | Self::Tree | Self::Ignore => Family::Other,
        }
    }

    /// The tags of OpenStreetMap that say the same.
    pub(super) fn tags(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Self::Building => &[("building", "yes")],
            Self::Part => &[("building:part", "yes")],
            Self::Street(StreetClass::Motorway) => &[("highway", "motorway")],
            Self::Street(StreetClass::Main) => &[("highway", "primary")],
            Self::Street(StreetClass::Street) => &[("highway", "residential")],
            Self::Street(StreetClass::Lane) => &[("highway", "living_street")],
            Self::Street(StreetClass::Service) => &[("highway", "service")],
            Self::Street(StreetClass::Path) => &[("highway", "path")],
            Self::Street(StreetClass::Steps) => &[("highway", "steps")],
            Self::Ramp => &[("highway", "motorway_link")],
            Self::Railway => &[("railway", "rail")],
            Self::Tram => &[("railway", "tram")],
            Self::River => &[("waterway", "river")],
            Self::Stream => &[("waterway", "stream")],
            Self::Water => &[("natural", "water")],
            Self::Park => &[("leisure", "park")],
            Self::Square => &[("place", "square")],
            Self::Plot => &[("boundary", "lot")],
            Self::Block => &[(crate::shapes::BLOCK_KEY, "built")],
            Self::Open => &[("landuse", "greenfield")],
            Self::Tree => &[("natural", "tree")],
            Self::Ignore => &[],
        }
    }
}

/// What the features of a layer are where their attributes do not tell.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayerRule {
    /// Part of the layer's file name, in any case: `buildings` is in `bubenec_buildings.geojson`.
    pub name: String,
    /// What its features are. Attributes still tell classes apart: of a layer that holds `Street(Street)`, one with
    /// `highway=steps` is steps.
    pub holds: Kind,
}

/// Which attributes of a vector map mean what. Written in RON, every field may be left out:
///
/// ```ron
/// (
///     attribution: "© City of Example, CC BY 4.0",
///     // What layers hold, by part of their file names.
///     layers: [(name: "budovy", holds: Building), (name: "parcely", holds: Plot)],
///     // Attributes that may say what a feature is, and what their values mean.
///     kind: ["DRUH"],
///     kinds: {"ulice": Street(Street), "namesti": Square, "zrušeno": Ignore},
///     // Attributes in the order in which they are asked; the first that is there counts.
///     name: ["NAZEV"],
///     height: ["VYSKA_M"],
///     roof_shape: ["STRECHA"],
///     roof_shapes: {"1": Flat, "2": Gabled},
/// )
/// ```
///
/// Lists that are given replace the stock ones; tables (`kinds`, `roof_shapes`, `surfaces`, `layers`) are asked before the
/// stock ones, which know the tags of OpenStreetMap and OpenHistoricalMap, the classes of TIGER/Line (`MTFCC`) and the words of
/// Overture Maps. Names of attributes and values count in any case; members of nested objects have dotted names
/// (`names.primary`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Mapping {
    /// Name of the city; empty: as the map says, else the file's name.
    pub city: String,
    /// Whom to credit, as the licence of the data asks; empty: as the files say.
    pub attribution: String,
    /// What layers hold; the first whose name fits counts.
    pub layers: Vec<LayerRule>,
    /// Whether attributes named as OpenStreetMap's keys mean what they mean there.
    pub osm_tags: bool,
    /// Metres to one unit of plain numbers in heights and widths: 0.3048 where they are feet.
    pub unit_m: f64,
    /// Ends of lines are joined to lines this near to them, in metres, at most 5.
    pub snap_m: f64,
    /// Attributes that may say what a feature is.
    pub kind: Vec<String>,
    /// What their values mean.
    pub kinds: BTreeMap<String, Kind>,
    /// Name of a street, house or place.
    pub name: Vec<String>,
    /// House number.
    pub number: Vec<String>,
    /// Height of a house's top above the ground.
    pub height: Vec<String>,
    /// Height of its underside above the ground.
    pub min_height: Vec<String>,
    /// Number of storeys below the eaves.
    pub levels: Vec<String>,
    /// Number of storeys that are left out below a house's underside.
    pub min_level: Vec<String>,
    /// Colour of walls: `#RRGGBB` or a name.
    pub colour: Vec<String>,
    /// Shape of the roof.
    pub roof_shape: Vec<String>,
    /// What values of it mean, besides the words of OpenStreetMap.
    pub roof_shapes: BTreeMap<String, RoofShape>,
    /// Height of the roof from eaves to ridge.
    pub roof_height: Vec<String>,
    /// Direction in which the roof falls, degrees clockwise from north.
    pub roof_direction: Vec<String>,
    /// Colour of the roof.
    pub roof_colour: Vec<String>,
    /// Width of a street or watercourse.
    pub width: Vec<String>,
    /// Number of lanes of a street.
    pub lanes: Vec<String>,
    /// Paving of a street or square.
    pub surface: Vec<String>,
    /// What values of it mean, besides the words of OpenStreetMap.
    pub surfaces: BTreeMap<String, Surfacing>,
    /// Level of bridges (1 and more) and tunnels (-1 and less).
    pub layer: Vec<String>,
    /// When a thing was built.
    pub start: Vec<String>,
    /// When it went.
    pub end: Vec<String>,
}

impl Default for Mapping {
    fn default() -> Self {
        let list = |names: &[&str]| names.iter().map(ToString::to_string).collect();
        Self {
            city: String::new(),
            attribution: String::new(),
            layers: Vec::new(),
            osm_tags: true,
            unit_m: 1.0,
            snap_m: 0.25,
            kind: list(&["mtfcc", "feature", "kind", "class", "subtype", "type", "fclass", "subclass"]),
            kinds: BTreeMap::new(),
            name: list(&["name", "names.primary", "fullname", "street_name", "nazev", "label"]),
            number: list(&["addr:housenumber", "addr:conscriptionnumber", "housenumber", "house_number", "number"]),
            height: list(&["height", "building:height", "height_m", "bldg_height", "measuredheight", "vyska"]),
            min_height: list(&["min_height", "building:min_height"]),
            levels: list(&["building:levels", "num_floors", "levels", "storeys", "stories", "floors", "podlazi"]),
            min_level: list(&["building:min_level", "min_floor", "min_level"]),
            colour: list(&["building:colour", "building:color", "facade_color", "colour"]),
            roof_shape: list(&["roof:shape", "roof_shape", "building:roof:shape", "rooftype"]),
            roof_shapes: BTreeMap::new(),
            roof_height: list(&["roof:height", "roof_height"]),
            roof_direction: list(&["roof:direction", "roof_direction"]),
            roof_colour: list(&["roof:colour", "roof:color", "roof_color"]),
            width: list(&["width", "width_m", "est_width"]),
            lanes: list(&["lanes", "num_lanes"]),
            surface: list(&["surface", "road_surface"]),
            surfaces: BTreeMap::new(),
            layer: list(&["layer"]),
            start: list(&["start_date", "valid_from", "date_from"]),
            end: list(&["end_date", "valid_to", "date_to"]),
        }
    }
}

/// Furthest that ends of lines may be moved, in metres.
const MOST_SNAP_M: f64 = 5.0;

impl Mapping {
    /// What cannot be meant; empty if all is well.
    #[must_use]
    pub fn validate(&self) -> Vec<String> {
        let mut errors = Vec::new();
        if !(self.unit_m > 0.0 && self.unit_m <= 1000.0) {
            errors.push(format!("`unit_m` is {}: it must be above 0, and 0.3048 for feet", self.unit_m));
        }
        if !(0.0..=MOST_SNAP_M).contains(&self.snap_m) {
            errors.push(format!("`snap_m` is {}: it must be 0 to {MOST_SNAP_M}", self.snap_m));
        }
        if self.layers.iter().any(|rule| rule.name.trim().is_empty()) {
            errors.push("a name in `layers` is empty and would fit every layer".to_owned());
        }
        errors
    }

    /// What a value is said to mean by the mapping's own table.
    pub(super) fn own_kind(&self, value: &str) -> Option<Kind> {
        in_any_case(&self.kinds, value)
    }

    /// What a layer of this name is said to hold.
    pub(super) fn holds(&self, layer: &str) -> Option<Kind> {
        let layer = layer.to_lowercase();
        self.layers.iter().find(|rule| layer.contains(&rule.name.to_lowercase())).map(|rule| rule.holds)
    }
}

/// The value of a key, in any case.
pub(super) fn in_any_case<T: Copy>(table: &BTreeMap<String, T>, key: &str) -> Option<T> {
    let lower = || key.to_lowercase();
    table.get(key).or_else(|| table.iter().find(|(k, _)| k.to_lowercase() == lower()).map(|(_, v)| v)).copied()
}

/// What values mean where a mapping does not say: classes of TIGER/Line
/// (<https://www2.census.gov/geo/pdfs/reference/mtfccs.pdf>), words of Overture Maps, and of this project's GeoJSON.
pub(super) fn stock_kind(value: &str) -> Option<Kind> {
    use StreetClass::{Lane, Main, Motorway, Path, Service, Steps, Street};
    Some(match value.to_lowercase().as_str() {
        "s1100" | "motorway" | "trunk" => Kind::Street(Motorway),
        "s1200" | "primary" | "secondary" => Kind::Street(Main),
        // A service drive along a motorway has houses, a name and crossroads: it is a street.
        "s1400" | "s1640" | "street" | "tertiary" | "residential" | "unclassified" | "road" => Kind::Street(Street),
        "living_street" | "pedestrian" => Kind::Street(Lane),
        "s1500" | "s1730" | "s1740" | "s1780" | "service" | "track" | "alley" | "driveway" => Kind::Street(Service),
        "s1710" | "s1820" | "s1830" | "footway" | "path" | "cycleway" | "bridleway" => Kind::Street(Path),
        "s1720" | "steps" => Kind::Street(Steps),
        "s1630" => Kind::Ramp,
        // Internal use of the census, winter trails, medians; nodes are made from links.
        "s1750" | "s1810" | "s2000" | "node" => Kind::Ignore,
        "r1011" | "r1052" | "railroad" | "rail" | "railway" => Kind::Railway,
        "r1051" | "tram" | "light_rail" => Kind::Tram,
        "h3010" | "h3013" | "h3020" | "watercourse" | "river" | "canal" => Kind::River,
        "stream" | "ditch" | "drain" => Kind::Stream,
        "h2030" | "h2040" | "h2041" | "h2051" | "h2053" | "h2060" | "water" | "lake" | "pond" | "reservoir" | "ocean" => {
            Kind::Water
        }
        "k2180" | "k2181" | "k2182" | "k2183" | "k2184" | "k2185" | "k2186" | "k2187" | "k2188" | "k2189" | "k2190" | "k2582"
        | "park" | "cemetery" | "grass" | "garden" => Kind::Park,
        "square" | "plaza" => Kind::Square,
        "plot" | "parcel" | "lot" => Kind::Plot,
        "built" => Kind::Block,
        "building" => Kind::Building,
        "building_part" => Kind::Part,
        "tree" => Kind::Tree,
        _ => return None,
    })
}

/// What layers hold by their names, where nothing else tells: parts of names, the first that fits counts. More than one kind
/// where lines and polygons go by one name.
pub(super) fn stock_holds(layer: &str) -> &'static [Kind] {
    const WORDS: [(&[&str], &[Kind]); 10] = [
        (&["building", "budov", "footprint", "houses", "gebaeude", "batiment"], &[Kind::Building]),
        (&["plot", "parcel", "cadastr", "lots", "parcela"], &[Kind::Plot]),
        (&["street", "road", "ulic", "highway", "strassen"], &[Kind::Street(StreetClass::Street)]),
        (&["tram"], &[Kind::Tram]),
        (&["rail", "zeleznic"], &[Kind::Railway]),
        (&["river", "stream", "waterway", "linearwater"], &[Kind::River, Kind::Water]),
        (&["water", "hydro", "lake", "vodni"], &[Kind::Water, Kind::River]),
        (&["park", "green", "zelen"], &[Kind::Park]),
        (&["square", "namesti"], &[Kind::Square]),
        (&["tree", "strom"], &[Kind::Tree]),
    ];
    let layer = layer.to_lowercase();
    WORDS.iter().find(|(words, _)| words.iter().any(|w| layer.contains(w))).map_or(&[], |(_, kinds)| kinds)
}

/// The word of OpenStreetMap for a roof's shape.
pub(super) fn roof_word(shape: RoofShape) -> &'static str {
    match shape {
        RoofShape::Flat => "flat",
        RoofShape::Gabled => "gabled",
        RoofShape::Hipped => "hipped",
        RoofShape::HalfHipped => "half-hipped",
        RoofShape::Pyramidal => "pyramidal",
        RoofShape::Skillion => "skillion",
        RoofShape::Mansard => "mansard",
        RoofShape::Gambrel => "gambrel",
        RoofShape::Dome => "dome",
        RoofShape::Onion => "onion",
        RoofShape::Cone => "cone",
        RoofShape::Round => "round",
        RoofShape::SawTooth => "sawtooth",
    }
}

/// The word of OpenStreetMap for a paving.
pub(super) fn surface_word(surfacing: Surfacing) -> &'static str {
    match surfacing {
        Surfacing::Asphalt => "asphalt",
        Surfacing::Cobbles => "sett",
        Surfacing::Mosaic => "mosaic",
        Surfacing::Flagstones => "paving_stones",
        Surfacing::Gravel => "gravel",
        Surfacing::Grass => "grass",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use veduta_city::file;

    #[test]
    fn a_mapping_is_read_with_the_stock_for_what_it_leaves_out() {
        let text = "(layers: [(name: \"budovy\", holds: Building)], kinds: {\"ulice\": Street(Lane)}, height: [\"VYSKA_M\"])";
        let mapping: Mapping = file::parse(text, "town.mapping.ron").unwrap();
        assert_eq!((mapping.own_kind("ULICE"), mapping.own_kind("most")), (Some(Kind::Street(StreetClass::Lane)), None));
        assert_eq!((mapping.holds("Praha_BUDOVY.shp"), mapping.holds("x")), (Some(Kind::Building), None));
        assert_eq!((mapping.height.as_slice(), mapping.name.len() > 3), (&["VYSKA_M".to_owned()][..], true));
        let written = file::to_text(&mapping).unwrap();
        assert_eq!(file::parse::<Mapping>(&written, "again").unwrap(), mapping);
    }

    #[test]
    fn a_mistake_is_told_with_its_line() {
        let error = file::parse::<Mapping>("(\n  hight: [\"H\"],\n)", "town.mapping.ron").unwrap_err().to_string();
        assert!(error.starts_with("town.mapping.ron:2:") && error.contains("hight"), "{error}");
        let error = file::parse::<Mapping>("(\n  kinds: {\"x\": Streat},\n)", "m").unwrap_err().to_string();
        assert!(error.contains("m:2:") && error.contains("Streat"), "{error}");
        let mapping = Mapping { snap_m: 20.0, unit_m: f64::NAN, ..Mapping::default() };
        assert_eq!(mapping.validate().len(), 2);
        assert!(Mapping::default().validate().is_empty());
    }

    #[test]
    fn the_classes_of_tiger_are_streets() {
        for (code, kind) in [
            ("S1100", Kind::Street(StreetClass::Motorway)),
            ("S1200", Kind::Street(StreetClass::Main)),
            ("S1400", Kind::Street(StreetClass::Street)),
            ("S1500", Kind::Street(StreetClass::Service)),
            ("S1630", Kind::Ramp),
            ("S1640", Kind::Street(StreetClass::Street)),
            ("S1710", Kind::Street(StreetClass::Path)),
            ("S1720", Kind::Street(StreetClass::Steps)),
            ("S1730", Kind::Street(StreetClass::Service)),
            ("S1740", Kind::Street(StreetClass::Service)),
            ("S1750", Kind::Ignore),
            ("S1780", Kind::Street(StreetClass::Service)),
            ("S1820", Kind::Street(StreetClass::Path)),
        ] {
            assert_eq!(stock_kind(code), Some(kind), "{code}");
        }
    }

    #[test]
    fn the_words_for_roofs_and_pavings_come_back_as_what_they_were() {
        use RoofShape::*;
        for shape in [Flat, Gabled, Hipped, HalfHipped, Pyramidal, Skillion, Mansard, Gambrel, Dome, Onion, Cone, Round, SawTooth] {
            assert_eq!(crate::body::roof_shape(roof_word(shape)), (Some(shape), None));
        }
        for surfacing in
            [Surfacing::Asphalt, Surfacing::Cobbles, Surfacing::Mosaic, Surfacing::Flagstones, Surfacing::Gravel, Surfacing::Grass]
        {
            let tags = [("surface", surface_word(surfacing))].into_iter().collect();
            assert_eq!(crate::lines::surfacing(&tags, veduta_city::Id(1), &mut crate::log::Log::default()), Some(surfacing));
        }
    }
}
