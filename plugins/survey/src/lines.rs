//! What ways that are lines mean: class, width, layer and paving of streets, railways and watercourses.

use veduta_city::{Id, LinkKind, Severity, StreetClass, Surfacing};

use crate::length;
use crate::log::Log;
use crate::osm::Tags;

/// A way as a link is made of it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Line {
    pub kind: LinkKind,
    /// Metres; 0 is the class's default.
    pub width_m: f64,
    pub name: String,
    pub layer: i8,
    pub surfacing: Option<Surfacing>,
    pub bounding: Bounding,
}

/// How a line bounds the blocks between streets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Bounding {
    /// Houses may stand along it.
    Block,
    /// Houses stand on its outside alone.
    Roundabout,
    /// It runs beside or across a street, above or below the ground, or is no street.
    Nothing,
}

/// Metres that a lane takes, and a pavement at each side of a carriageway.
const LANE_M: f64 = 3.0;
const PAVEMENT_M: f64 = 2.0;

/// The line that tags describe; `None` for everything else. What looks like a way but is not built is told.
pub(crate) fn line_of(tags: &Tags, id: Id, log: &mut Log) -> Option<Line> {
    if let Some(highway) = tags.get("highway") {
        return street(highway, tags, id, log);
    }
    if let Some(railway) = tags.get("railway") {
        return railway_line(railway, tags, id, log);
    }
    tags.get("waterway").and_then(|waterway| watercourse(waterway, tags))
}

fn street(highway: &str, tags: &Tags, id: Id, log: &mut Log) -> Option<Line> {
    use StreetClass::{Lane, Main, Motorway, Path, Service, Steps, Street};
    let class = match highway {
        "motorway" | "trunk" | "motorway_link" | "trunk_link" => Motorway,
        "primary" | "secondary" | "primary_link" | "secondary_link" => Main,
        "tertiary" | "tertiary_link" | "unclassified" | "residential" | "road" | "busway" | "bus_guideway" => Street,
        "living_street" | "pedestrian" => Lane,
        "service" | "track" => Service,
        "footway" | "path" | "cycleway" | "bridleway" | "corridor" => Path,
        "steps" => Steps,
        "construction" | "proposed" | "abandoned" | "razed" | "disused" | "raceway" | "no" => {
            log.tally(Severity::Dropped, id, None, format!("highway={highway} is no way to walk on"));
            return None;
        }
        // Drawn as lines but not ways: platforms, stops, lifts, rest areas.
        "platform" | "bus_stop" | "elevator" | "rest_area" | "services" | "emergency_bay" | "street_lamp" | "crossing" => {
            return None;
        }
        other => {
            log.tally(Severity::Dropped, id, None, format!("highway={} is not known here", short(other)));
            return None;
        }
    };
    if highway == "corridor" || tags.is("indoor", "yes") {
        log.tally(Severity::Dropped, id, None, "ways inside buildings are left out");
        return None;
    }
    let is_beside_a_street = tags.is_any("footway", &["sidewalk", "crossing", "traffic_island", "link", "access_aisle"])
        || tags.is_any("cycleway", &["sidewalk", "crossing", "lane"])
        || tags.is_any("path", &["sidewalk", "crossing"]);
    let layer = layer_of(tags, id, log);
    Some(Line {
        kind: LinkKind::Street(class),
        width_m: street_width(class, highway.ends_with("_link"), tags, id, log),
        name: tags.text("name"),
        layer,
        surfacing: surfacing(tags, id, log),
        bounding: match () {
            () if layer != 0 || is_beside_a_street => Bounding::Nothing,
            () if tags.is_any("junction", &["roundabout", "circular"]) => Bounding::Roundabout,
            () => Bounding::Block,
        },
    })
}

/// Width in metres from tags, from wall to wall as far as they let one know; 0 where they say nothing.
fn street_width(class: StreetClass, is_ramp: bool, tags: &Tags, id: Id, log: &mut Log) -> f64 {
    let pavements = |if_untold: f64| match tags.first_of(&["sidewalk", "sidewalk:both"]) {
        _ if !class.has_carriageway() => 0.0,
        Some("both" | "yes") => 2.0,
        Some("left" | "right") => 1.0,
        Some("no" | "none" | "separate") => 0.0,
        _ => if_untold,
    };
    if let Some(text) = tags.first_of(&["width", "est_width", "width:carriageway"]) {
        match length::metres(text).filter(|w| (0.5..=80.0).contains(w)) {
            Some(width) => return width + pavements(0.0) * PAVEMENT_M,
            None => log.tally(Severity::Note, id, None, format!("a width of \"{}\" is not believed", short(text))),
        }
    }
    if let Some(text) = tags.get("lanes").filter(|_| class.has_carriageway() || class == StreetClass::Service) {
        match length::number(text).filter(|n| (1.0..=12.0).contains(n)) {
            Some(lanes) => return lanes * LANE_M + pavements(if is_ramp { 0.0 } else { 2.0 }) * PAVEMENT_M,
            None => log.tally(Severity::Note, id, None, format!("a number of lanes of \"{}\" is not believed", short(text))),
        }
    }
    if is_ramp { 6.0 } else { 0.0 }
}

fn layer_of(tags: &Tags, id: Id, log: &mut Log) -> i8 {
    let is_passage = tags.is_any("tunnel", &["building_passage", "no", "covered"]);
    if let Some(text) = tags.get("layer") {
        match length::number(text).filter(|n| n.abs() <= 20.0) {
            Some(layer) => return layer as i8,
            None => log.tally(Severity::Note, id, None, format!("a layer of \"{}\" is not believed", short(text))),
        }
    }
    match () {
        () if tags.has("bridge") => 1,
        () if tags.has("tunnel") && !is_passage => -1,
        () => 0,
    }
}

/// Paving in the words of `surface`.
pub(crate) fn surfacing(tags: &Tags, id: Id, log: &mut Log) -> Option<Surfacing> {
    let surface = tags.get("surface")?.split([';', ':']).next()?.trim();
    Some(match surface {
        "asphalt" | "paved" | "chipseal" | "tartan" | "acrylic" | "rubber" | "metal" | "metal_grid" => Surfacing::Asphalt,
        "sett" | "cobblestone" | "unhewn_cobblestone" | "bricks" | "brick" => Surfacing::Cobbles,
        "mosaic" | "tiles" => Surfacing::Mosaic,
        "paving_stones" | "concrete" | "flagstones" | "stone" | "granite" | "wood" | "stepping_stones" | "interlock" => {
            Surfacing::Flagstones
        }
        "gravel" | "fine_gravel" | "compacted" | "unpaved" | "dirt" | "ground" | "earth" | "sand" | "pebblestone" | "mud"
        | "clay" | "soil" | "woodchips" | "rock" | "shells" => Surfacing::Gravel,
        "grass" | "grass_paver" | "artificial_turf" => Surfacing::Grass,
        other => {
            log.tally(Severity::Note, id, None, format!("surface={} is not known here", short(other)));
            return None;
        }
    })
}

fn railway_line(railway: &str, tags: &Tags, id: Id, log: &mut Log) -> Option<Line> {
    let tram = match railway {
        "tram" => true,
        "rail" | "light_rail" | "narrow_gauge" | "subway" | "funicular" | "monorail" | "preserved" | "miniature" => false,
        "abandoned" | "disused" | "razed" | "dismantled" | "construction" | "proposed" => {
            log.tally(Severity::Dropped, id, None, format!("railway={railway} has no rails"));
            return None;
        }
        // Platforms, stations, turntables: no rails either, and told elsewhere if they have names.
        _ => return None,
    };
    Some(Line {
        kind: LinkKind::Railway { tram },
        width_m: 0.0,
        name: tags.text("name"),
        layer: layer_of(tags, id, log),
        surfacing: None,
        bounding: Bounding::Nothing,
    })
}

fn watercourse(waterway: &str, tags: &Tags) -> Option<Line> {
    let usual = match waterway {
        "river" => 8.0,
        "canal" | "tidal_channel" => 6.0,
        "stream" => 2.0,
        "ditch" | "drain" => 1.5,
        _ => return None,
    };
    let stated = tags.first_of(&["width", "est_width"]).and_then(length::metres).filter(|w| (0.2..=3000.0).contains(w));
    let is_covered = tags.has("tunnel") && !tags.has("layer");
    Some(Line {
        kind: LinkKind::Watercourse,
        width_m: stated.unwrap_or(usual),
        name: tags.text("name"),
        layer: if is_covered { -1 } else { layer_of(tags, Id::NONE, &mut Log::default()) },
        surfacing: None,
        bounding: Bounding::Nothing,
    })
}

/// A value from a file, short enough for a message.
pub(crate) fn short(text: &str) -> String {
    let plain: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).take(40).collect();
    if text.chars().nth(40).is_some() { format!("{plain}…") } else { plain }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(pairs: &[(&str, &str)]) -> Option<Line> {
        let tags: Tags = pairs.iter().copied().collect();
        line_of(&tags, Id(1), &mut Log::default())
    }

    #[test]
    fn classes_follow_the_highway_tag() {
        for (value, class) in [
            ("trunk", StreetClass::Motorway),
            ("secondary_link", StreetClass::Main),
            ("residential", StreetClass::Street),
            ("pedestrian", StreetClass::Lane),
            ("service", StreetClass::Service),
            ("cycleway", StreetClass::Path),
            ("steps", StreetClass::Steps),
        ] {
            assert_eq!(line(&[("highway", value)]).unwrap().kind, LinkKind::Street(class), "{value}");
        }
        assert_eq!(line(&[("highway", "proposed")]), None);
    }

    #[test]
    fn widths_come_from_width_then_lanes_then_the_class() {
        let width = |pairs: &[(&str, &str)]| line(pairs).unwrap().width_m;
        assert_eq!(width(&[("highway", "pedestrian"), ("width", "7,5 m"), ("lanes", "2")]), 7.5);
        assert_eq!(width(&[("highway", "residential"), ("width", "6"), ("sidewalk", "both")]), 10.0);
        assert_eq!(width(&[("highway", "residential"), ("est_width", "8")]), 8.0);
        assert_eq!(width(&[("highway", "primary"), ("lanes", "3")]), 13.0);
        assert_eq!(width(&[("highway", "primary"), ("lanes", "3"), ("sidewalk", "none")]), 9.0);
        assert_eq!(width(&[("highway", "residential")]), 0.0);
    }

    #[test]
    fn an_absurd_width_is_told_and_not_used() {
        let tags: Tags = [("highway", "residential"), ("width", "600")].into_iter().collect();
        let mut log = Log::default();
        assert_eq!(line_of(&tags, Id(1), &mut log).unwrap().width_m, 0.0);
        assert!(log.finish()[0].message.contains("\"600\" is not believed"));
    }

    #[test]
    fn bridges_and_tunnels_have_layers_and_passages_none() {
        let layer = |key, value| line(&[("highway", "footway"), (key, value)]).unwrap().layer;
        assert_eq!(layer("bridge", "viaduct"), 1);
        assert_eq!(layer("bridge", "no"), 0);
        assert_eq!(layer("tunnel", "yes"), -1);
        assert_eq!(layer("tunnel", "building_passage"), 0);
        assert_eq!(layer("layer", "-2"), -2);
        assert_eq!(layer("layer", "high"), 0);
    }

    #[test]
    fn trams_rails_and_water_are_told_apart() {
        assert_eq!(line(&[("railway", "tram")]).unwrap().kind, LinkKind::Railway { tram: true });
        assert_eq!(line(&[("railway", "rail")]).unwrap().kind, LinkKind::Railway { tram: false });
        assert_eq!(line(&[("railway", "abandoned")]), None);
        let river = line(&[("waterway", "river"), ("width", "40")]).unwrap();
        assert_eq!((river.kind, river.width_m), (LinkKind::Watercourse, 40.0));
        assert_eq!(line(&[("waterway", "stream"), ("tunnel", "culvert")]).unwrap().layer, -1);
        assert_eq!(line(&[("waterway", "weir")]), None);
    }

    #[test]
    fn paving_follows_surface() {
        let paving = |value| line(&[("highway", "footway"), ("surface", value)]).unwrap().surfacing;
        assert_eq!(paving("concrete:plates"), Some(Surfacing::Flagstones));
        assert_eq!(paving("sett"), Some(Surfacing::Cobbles));
        assert_eq!(paving("cheese"), None);
    }

    #[test]
    fn sidewalks_bound_no_blocks() {
        let bounding = |pairs: &[(&str, &str)]| line(pairs).unwrap().bounding;
        assert_eq!(bounding(&[("highway", "footway"), ("footway", "sidewalk")]), Bounding::Nothing);
        assert_eq!(bounding(&[("highway", "residential")]), Bounding::Block);
        assert_eq!(bounding(&[("highway", "residential"), ("junction", "roundabout")]), Bounding::Roundabout);
        assert_eq!(bounding(&[("highway", "residential"), ("bridge", "yes")]), Bounding::Nothing);
    }
}
