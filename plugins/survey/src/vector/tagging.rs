//! From attributes to tags: what a feature is, in the words of OpenStreetMap, which all that follows reads.

use veduta_city::{Id, LinkKind, StreetClass};

use super::feature::Feature;
use super::mapping::{Family, Kind, Mapping, in_any_case, roof_word, stock_holds, stock_kind, surface_word};
use crate::lines::line_of;
use crate::log::Log;
use crate::osm::Tags;
use crate::shapes::{Use, use_of};
use crate::{length, objects, places};

/// How a feature is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Drawn {
    Point,
    Line,
    /// A line that ends where it begins: a loop, or the outline of an area.
    ClosedLine,
    Area,
}

/// Keys that say what a thing is; they give way where a mapping says otherwise.
const KIND_KEYS: [&str; 11] = [
    "building",
    "building:part",
    "highway",
    "area:highway",
    "railway",
    "waterway",
    "natural",
    "landuse",
    "leisure",
    "place",
    "boundary",
];

/// A feature in the words of OpenStreetMap.
#[derive(Debug, PartialEq)]
pub(super) enum Tagged {
    As(Tags),
    /// The mapping says to pass it over.
    Ignored,
    /// Nothing says what it is, or it is nothing that a city graph holds.
    Unknown,
}

/// The layer that a feature is in, as far as it says what features are.
#[derive(Debug, Clone, Copy)]
pub(super) struct LayerName<'a> {
    pub name: &'a str,
    pub holds: Option<Kind>,
}

/// Finds out what a feature is and gives it the tags that say so. In this order: the mapping's own table, what the layer is
/// said to hold, its own tags, the stock table, what the layer's name says.
pub(super) fn tagged(feature: &Feature, layer: LayerName<'_>, drawn: Drawn, mapping: &Mapping) -> Tagged {
    let mut pairs: Vec<(String, String)> = Vec::new();
    if mapping.osm_tags {
        pairs.extend(feature.attributes.iter().map(|(k, v)| (k.to_lowercase(), v.trim().to_owned())));
        pairs.retain(|(key, value)| !value.is_empty() && !matches!(key.as_str(), "id" | "@id"));
    }
    let own = Native::of(&tags(&pairs), drawn);
    let kind = match decide(feature, layer, drawn, mapping, own) {
        Some(Kind::Ignore) => return Tagged::Ignored,
        kind => kind,
    };
    if let Some(kind) = kind {
        pairs.retain(|(key, _)| !KIND_KEYS.contains(&key.as_str()) && key != crate::shapes::BLOCK_KEY);
        pairs.extend(kind.tags().iter().map(|&(k, v)| (k.to_owned(), v.to_owned())));
    } else if own == Native::Nothing {
        return Tagged::Unknown;
    }
    describe(feature, drawn, mapping, &mut pairs);
    if drawn == Drawn::Area {
        pairs.push(("area".to_owned(), "yes".to_owned()));
    }
    Tagged::As(tags(&pairs))
}

fn tags(pairs: &[(String, String)]) -> Tags {
    pairs.iter().map(|(k, v)| (k.as_str(), v.as_str())).collect()
}

/// What a feature's own tags say of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Native {
    Nothing,
    /// Something that may stand beside what it is: a school may be a yard or a house.
    Weak,
    Is(Family),
}

impl Native {
    fn of(tags: &Tags, drawn: Drawn) -> Self {
        let line = || {
            // What the log says is said again when the line is read.
            let line = line_of(tags, Id::NONE, &mut Log::default())?;
            Some(match line.kind {
                LinkKind::Street(_) => Family::Street,
                LinkKind::Railway { .. } => Family::Rails,
                LinkKind::Watercourse => Family::Stream,
            })
        };
        let area = || {
            Some(match use_of(tags)? {
                Use::Building | Use::Part => Self::Is(Family::House),
                Use::Water | Use::Park => Self::Is(Family::Ground),
                Use::Square | Use::Plot | Use::Block => Self::Is(Family::Other),
                Use::Open | Use::Thing => Self::Weak,
            })
        };
        let point = || {
            let is_known = objects::kind_of(tags).is_some()
                || places::kind_of(tags).is_some()
                || tags.has("addr:housenumber")
                || tags.has("place");
            is_known.then_some(Self::Is(Family::Other))
        };
        let found = match drawn {
            Drawn::Point => point(),
            Drawn::Line => line().map(Self::Is),
            Drawn::ClosedLine => area().or_else(|| line().map(Self::Is)),
            Drawn::Area => area(),
        };
        found.unwrap_or(Self::Nothing)
    }
}

/// The kind to be put in place of what a feature's own tags say; `None` if they stand.
fn decide(feature: &Feature, layer: LayerName<'_>, drawn: Drawn, mapping: &Mapping, own: Native) -> Option<Kind> {
    let values = || mapping.kind.iter().filter_map(|name| feature.get(name));
    let fits = |kind: &Kind| fits(*kind, drawn);
    if let Some(kind) = values().filter_map(|v| mapping.own_kind(v)).find(fits) {
        return Some(kind);
    }
    let stock = || values().filter_map(stock_kind).find(fits);
    if let Some(rule) = layer.holds.or_else(|| mapping.holds(layer.name)).filter(fits) {
        let family = rule.family();
        // Attributes tell apart what the layer's rule leaves open; `Other` has nothing to tell apart.
        if own == Native::Is(family) && family != Family::Other {
            return None;
        }
        return stock().filter(|k| *k == Kind::Ignore || (k.family() == family && family != Family::Other)).or(Some(rule));
    }
    if matches!(own, Native::Is(_)) {
        return None;
    }
    stock().or_else(|| stock_holds(layer.name).iter().copied().find(fits))
}

/// Whether things of a kind are drawn like this.
fn fits(kind: Kind, drawn: Drawn) -> bool {
    match kind {
        Kind::Street(_) | Kind::Ramp | Kind::Railway | Kind::Tram | Kind::River | Kind::Stream => {
            matches!(drawn, Drawn::Line | Drawn::ClosedLine)
        }
        Kind::Building | Kind::Part | Kind::Water | Kind::Park | Kind::Square | Kind::Plot | Kind::Block | Kind::Open => {
            matches!(drawn, Drawn::Area | Drawn::ClosedLine)
        }
        Kind::Tree => drawn == Drawn::Point,
        Kind::Ignore => true,
    }
}

/// Adds what attributes say besides what a feature is.
fn describe(feature: &Feature, drawn: Drawn, mapping: &Mapping, pairs: &mut Vec<(String, String)>) {
    let metres = |text: &str| match length::number(text) {
        Some(number) if mapping.unit_m != 1.0 => (number * mapping.unit_m).to_string(),
        _ => text.to_owned(),
    };
    let same = |text: &str| text.to_owned();
    let roof = |text: &str| in_any_case(&mapping.roof_shapes, text).map_or_else(|| text.to_owned(), |s| roof_word(s).to_owned());
    let paving = |text: &str| in_any_case(&mapping.surfaces, text).map_or_else(|| text.to_owned(), |s| surface_word(s).to_owned());
    let mut say = |names: &[String], key: &str, value: &dyn Fn(&str) -> String| {
        if let Some((_, text)) = feature.first_of(names) {
            pairs.retain(|(k, _)| k != key);
            pairs.push((key.to_owned(), value(text)));
        }
    };
    say(&mapping.name, "name", &same);
    if matches!(drawn, Drawn::Line | Drawn::ClosedLine) {
        say(&mapping.width, "width", &metres);
        say(&mapping.lanes, "lanes", &same);
    }
    if drawn != Drawn::Line {
        say(&mapping.number, "addr:housenumber", &same);
        say(&mapping.height, "height", &metres);
        say(&mapping.min_height, "min_height", &metres);
        say(&mapping.levels, "building:levels", &same);
        say(&mapping.min_level, "building:min_level", &same);
        say(&mapping.colour, "building:colour", &same);
        say(&mapping.roof_shape, "roof:shape", &roof);
        say(&mapping.roof_height, "roof:height", &metres);
        say(&mapping.roof_direction, "roof:direction", &same);
        say(&mapping.roof_colour, "roof:colour", &same);
    }
    say(&mapping.surface, "surface", &paving);
    say(&mapping.layer, "layer", &same);
    if let Some((_, start)) = feature.first_of(&mapping.start) {
        pairs.retain(|(k, _)| k != "start_date");
        pairs.push(("start_date".to_owned(), start.to_owned()));
    }
}

/// Whether a street is one that others meet only by ramps.
pub(super) fn is_motorway(tags: &Tags) -> bool {
    tags.is("highway", "motorway")
}

/// Whether a line is a street that crosses a motorway above or below it.
pub(super) fn passes_motorways(kind: LinkKind, tags: &Tags) -> bool {
    matches!(kind, LinkKind::Street(class) if class != StreetClass::Motorway) && !tags.is("highway", "motorway_link")
}

#[cfg(test)]
mod tests {
    use super::super::mapping::LayerRule;
    use super::*;

    fn feature(pairs: &[(&str, &str)]) -> Feature {
        let attributes = pairs.iter().map(|&(k, v)| (k.to_owned(), v.to_owned())).collect();
        Feature { attributes, ..Feature::default() }
    }

    fn tags_of(pairs: &[(&str, &str)], layer: &str, drawn: Drawn, mapping: &Mapping) -> Tags {
        match tagged(&feature(pairs), LayerName { name: layer, holds: None }, drawn, mapping) {
            Tagged::As(tags) => tags,
            other => panic!("{pairs:?} in {layer}: {other:?}"),
        }
    }

    #[test]
    fn tiger_roads_are_streets_by_class() {
        let stock = Mapping::default();
        let road = [("LINEARID", "1104475160384"), ("FULLNAME", "Strand St"), ("RTTYP", "M"), ("MTFCC", "S1400")];
        let tags = tags_of(&road, "tl_2023_78030_roads.shp", Drawn::Line, &stock);
        assert!(tags.is("highway", "residential") && tags.is("name", "Strand St"), "{tags:?}");
        let internal = feature(&[("MTFCC", "S1750")]);
        assert_eq!(tagged(&internal, LayerName { name: "roads", holds: None }, Drawn::Line, &stock), Tagged::Ignored);
    }

    #[test]
    fn tags_of_openstreetmap_stand_and_layers_tell_the_rest() {
        let stock = Mapping::default();
        assert!(tags_of(&[("highway", "steps")], "streets", Drawn::Line, &stock).is("highway", "steps"));
        assert!(tags_of(&[("fid", "1")], "bubenec_streets.geojson", Drawn::Line, &stock).is("highway", "residential"));
        assert!(tags_of(&[("fid", "1")], "bubenec_plots.geojson", Drawn::Area, &stock).is("boundary", "lot"));
        let school = tags_of(&[("amenity", "school")], "buildings", Drawn::Area, &stock);
        assert!(school.is("building", "yes") && school.is("amenity", "school"));
        let unknown = tagged(&feature(&[("fid", "1")]), LayerName { name: "stuff", holds: None }, Drawn::Area, &stock);
        assert_eq!(unknown, Tagged::Unknown);
        assert!(tags_of(&[("fid", "1")], "water.shp", Drawn::Line, &stock).is("waterway", "river"));
    }

    #[test]
    fn a_mapping_is_stronger_than_tags_and_names() {
        let mut mapping = Mapping::default();
        mapping.kinds.insert("Yard".into(), Kind::Open);
        mapping.layers.push(LayerRule { name: "Parcels".into(), holds: Kind::Plot });
        mapping.layers.push(LayerRule { name: "ways".into(), holds: Kind::Street(StreetClass::Lane) });
        assert!(tags_of(&[("kind", "yard"), ("building", "yes")], "x", Drawn::Area, &mapping).is("landuse", "greenfield"));
        let plot = tags_of(&[("building", "yes")], "my_parcels", Drawn::Area, &mapping);
        assert!(plot.is("boundary", "lot") && !plot.has("building"), "{plot:?}");
        assert!(tags_of(&[("highway", "primary")], "ways", Drawn::Line, &mapping).is("highway", "primary"));
        assert!(tags_of(&[("class", "steps")], "ways", Drawn::Line, &mapping).is("highway", "steps"));
        assert!(tags_of(&[("class", "odd")], "ways", Drawn::Line, &mapping).is("highway", "living_street"));
    }

    #[test]
    fn heights_are_in_the_mappings_unit_and_shapes_in_its_words() {
        let mut mapping = Mapping { unit_m: 0.5, ..Mapping::default() };
        mapping.roof_shapes.insert("3".into(), veduta_city::RoofShape::Hipped);
        let house = [("building", "yes"), ("HEIGHT_M", "20"), ("ROOFTYPE", "3"), ("num_floors", "4"), ("min_height", "6 ft")];
        let tags = tags_of(&house, "x", Drawn::Area, &mapping);
        assert!(tags.is("height", "10") && tags.is("roof:shape", "hipped") && tags.is("building:levels", "4"), "{tags:?}");
        assert!(tags.is("min_height", "6 ft"), "a unit that is written stands");
    }
}
