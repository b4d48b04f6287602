//! City graph to GeoJSON, so that any GIS program shows it over its map.
//!
//! One collection of features; `properties.feature` says what each is:
//!
//! | `feature` | geometry | properties |
//! |---|---|---|
//! | `node` | Point | `id`; `kind`: `blind_alley`, `crossroads`, `curve`, `square_vertex`; of streets alone |
//! | `link` | LineString | `id`, `kind`: `street`, `railroad`, `watercourse`; `class` of a street, `width` in metres, `width_profile` where it varies, `name`, `layer`, `from`, `to` |
//! | `square` | Polygon | `id`, `name` |
//! | `block` | Polygon | `id`, `kind`: `built`, `park`, `monument`, `water`; `name`, `district` |
//! | `building` | Polygon | `id`, `name`, `number`, `height`, `min_height`, `levels` |
//!
//! A `width_profile` is text, so that tables of a GIS show it: `0.05 8.2, 0.5 11, 1 16.4` is 8.2 m wide at a twentieth of the
//! line's length, 11 m half-way, 16.4 m at its end. What is not known is not written. In plan metres the file also has a `map` member with the anchor and the extent where it is
//! known; [`survey_vector`](crate::survey_vector) reads it back to where it was, with one width a street.

use std::collections::HashMap;

use glam::DVec2;
use veduta_city::{Anchor, BlockKind, CityGraph, Id, Link, LinkKind, Ring, StreetClass, WidthAt};

/// A node this near to a square's outline is one of its vertices, in metres.
const ON_SQUARE_M: f64 = 0.5;
/// Cosine of the least bend that is told as a curve node: 10°.
const CURVE_COS: f64 = 0.984_807_753_012_208;

/// How [`to_geojson`] writes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GeoJsonSettings {
    /// Width and height of the map in metres, where they are known.
    pub extent_m: Option<[f64; 2]>,
    /// Longitude and latitude as RFC 7946 has it, instead of plan metres.
    pub degrees: bool,
}

/// A city graph as GeoJSON; coordinates to a millimetre.
///
/// ```
/// let graph: veduta_city::CityGraph = veduta_city::file::parse(
///     "(name: \"T\", anchor: (lat: 50, lon: 14), nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (9.5, 0))],
///      links: [(id: 3, from: 1, to: 2, kind: Street(Lane))])", "t")?;
/// let text = veduta_survey::to_geojson(&graph, &veduta_survey::GeoJsonSettings::default());
/// assert!(text.contains(r#""type":"LineString","coordinates":[[0,0],[9.5,0]]"#), "{text}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn to_geojson(graph: &CityGraph, settings: &GeoJsonSettings) -> String {
    let mut writer = Writer { out: String::new(), anchor: settings.degrees.then_some(graph.anchor), is_first: true };
    writer.out.reserve(expected_bytes(graph));
    writer.head(graph, settings);
    let at = graph.node_positions();
    writer.nodes(graph, &at);
    for link in &graph.links {
        writer.link(link, &at);
    }
    for square in &graph.squares {
        writer.begin("square", square.id);
        writer.text("name", &square.name);
        writer.polygon(&square.outline, &square.holes);
    }
    for block in &graph.blocks {
        writer.begin("block", block.id);
        let kind = match block.kind {
            BlockKind::Built => "built",
            BlockKind::Park => "park",
            BlockKind::Monument => "monument",
            BlockKind::Water => "water",
        };
        writer.text("kind", kind);
        writer.text("name", &block.name);
        writer.text("district", &block.district);
        writer.polygon(&block.outline, &block.holes);
    }
    for building in &graph.buildings {
        writer.begin("building", building.id);
        writer.text("name", &building.name);
        writer.text("number", &building.number);
        writer.maybe("height", building.height_m);
        writer.maybe("min_height", Some(building.min_height_m).filter(|h| *h != 0.0));
        writer.maybe("levels", building.levels);
        writer.polygon(&building.outline, &building.holes);
    }
    writer.out.push_str("\n]}\n");
    writer.out
}

/// About how long the text becomes.
fn expected_bytes(graph: &CityGraph) -> usize {
    let vertices = graph.links.iter().map(|l| l.via.len() + 3).sum::<usize>()
        + graph.blocks.iter().map(|b| b.outline.len() + 1).sum::<usize>()
        + graph.buildings.iter().map(|b| b.outline.len() + 1).sum::<usize>();
    let curves = graph.links.iter().map(|l| l.via.len()).sum::<usize>();
    let features = graph.nodes.len() + curves + graph.links.len() + graph.blocks.len() + graph.buildings.len();
    256 + 24 * vertices + 200 * features
}

/// Pushes text; a tree of values of a large map would take longer than all of its survey.
struct Writer {
    out: String,
    /// Where plan (0, 0) lies, if degrees are to be written.
    anchor: Option<Anchor>,
    is_first: bool,
}

impl Writer {
    fn head(&mut self, graph: &CityGraph, settings: &GeoJsonSettings) {
        self.out.push_str("{\"type\":\"FeatureCollection\",");
        if !graph.attribution.is_empty() {
            self.out.push_str("\"attribution\":");
            push_string(&mut self.out, &graph.attribution);
            self.out.push(',');
        }
        if self.anchor.is_none() {
            self.out
                .push_str("\"crs\":{\"type\":\"name\",\"properties\":{\"name\":\"veduta:plan\"}},\"map\":{\"anchor\":{\"lat\":");
            self.out.push_str(&format!("{},\"lon\":{}}}", graph.anchor.lat, graph.anchor.lon));
            if let Some([width, height]) = settings.extent_m {
                self.out.push_str(",\"extent_m\":[");
                push_number(&mut self.out, width);
                self.out.push(',');
                push_number(&mut self.out, height);
                self.out.push(']');
            }
            self.out.push_str("},");
        }
        self.out.push_str("\"features\":[");
    }

    /// Begins a feature and its properties.
    fn begin(&mut self, feature: &str, id: Id) {
        self.out.push_str(if self.is_first { "\n" } else { ",\n" });
        self.is_first = false;
        self.out.push_str("{\"type\":\"Feature\",\"properties\":{\"feature\":\"");
        self.out.push_str(feature);
        self.out.push_str("\",\"id\":\"");
        push_id(&mut self.out, id);
        self.out.push('"');
    }

    fn key(&mut self, key: &str) {
        self.out.push_str(",\"");
        self.out.push_str(key);
        self.out.push_str("\":");
    }

    /// A property that is left out where it is empty.
    fn text(&mut self, key: &str, value: &str) {
        if !value.is_empty() {
            self.key(key);
            push_string(&mut self.out, value);
        }
    }

    fn maybe(&mut self, key: &str, value: Option<f64>) {
        if let Some(value) = value {
            self.key(key);
            push_number(&mut self.out, value);
        }
    }

    fn profile(&mut self, profile: &[WidthAt]) {
        for (i, entry) in profile.iter().enumerate() {
            if i == 0 {
                self.key("width_profile");
            }
            self.out.push_str(if i == 0 { "\"" } else { ", " });
            let mut digits = Digits::new();
            digits.number::<1_000>(entry.width_m);
            digits.byte(b' ');
            digits.number::<10_000>(entry.share);
            self.out.push_str(digits.text());
        }
        if !profile.is_empty() {
            self.out.push('"');
        }
    }

    fn geometry(&mut self, kind: &str) {
        self.out.push_str("},\"geometry\":{\"type\":\"");
        self.out.push_str(kind);
        self.out.push_str("\",\"coordinates\":");
    }

    fn position(&mut self, p: DVec2) {
        let mut digits = Digits::new();
        digits.byte(b']');
        match self.anchor {
            None => digits.pair::<1_000>(p.x, p.y),
            Some(anchor) => {
                let (lat, lon) = anchor.geo_from_plan(p);
                digits.pair::<100_000_000>(lon, lat);
            }
        }
        digits.byte(b'[');
        self.out.push_str(digits.text());
    }

    fn positions(&mut self, line: impl Iterator<Item = DVec2>) {
        self.out.push('[');
        for (i, p) in line.enumerate() {
            if i > 0 {
                self.out.push(',');
            }
            self.position(p);
        }
        self.out.push(']');
    }

    fn polygon(&mut self, outline: &Ring, holes: &[Ring]) {
        self.geometry("Polygon");
        self.out.push('[');
        for (i, ring) in core::iter::once(outline).chain(holes).enumerate() {
            if i > 0 {
                self.out.push(',');
            }
            self.positions(ring.iter().chain(ring.first()).copied());
        }
        self.out.push_str("]}}");
    }

    fn nodes(&mut self, graph: &CityGraph, at: &HashMap<Id, DVec2>) {
        let mut ends: HashMap<Id, usize> = HashMap::with_capacity(graph.nodes.len());
        for link in graph.links.iter().filter(|l| matches!(l.kind, LinkKind::Street(_))) {
            *ends.entry(link.from).or_default() += 1;
            *ends.entry(link.to).or_default() += 1;
        }
        let squares: Vec<(DVec2, DVec2, &Ring)> = graph.squares.iter().map(|s| with_bounds(&s.outline)).collect();
        for node in &graph.nodes {
            let kind = match ends.get(&node.id) {
                None => continue,
                Some(_) if is_on_square(node.pos, &squares) => "square_vertex",
                Some(1) => "blind_alley",
                Some(2) => "curve",
                Some(_) => "crossroads",
            };
            self.node(node.id, None, kind, node.pos);
        }
        // The curve nodes that links have inside.
        for link in graph.links.iter().filter(|l| matches!(l.kind, LinkKind::Street(_))) {
            let (Some(&from), Some(&to)) = (at.get(&link.from), at.get(&link.to)) else { continue };
            for (i, &p) in link.via.iter().enumerate() {
                let before = i.checked_sub(1).and_then(|b| link.via.get(b)).copied().unwrap_or(from);
                let after = link.via.get(i + 1).copied().unwrap_or(to);
                if is_bend(before, p, after) {
                    self.node(link.id, Some(i), "curve", p);
                }
            }
        }
    }

    fn node(&mut self, id: Id, inner: Option<usize>, kind: &str, p: DVec2) {
        self.begin("node", id);
        if let Some(i) = inner {
            // The quote of the id makes way for the vertex's place in its link.
            self.out.pop();
            self.out.push_str(&format!(".{i}\""));
        }
        self.text("kind", kind);
        self.geometry("Point");
        self.position(p);
        self.out.push_str("}}");
    }

    fn link(&mut self, link: &Link, at: &HashMap<Id, DVec2>) {
        let (Some(&from), Some(&to)) = (at.get(&link.from), at.get(&link.to)) else { return };
        self.begin("link", link.id);
        match link.kind {
            LinkKind::Street(class) => {
                self.text("kind", "street");
                self.text("class", class_word(class));
            }
            LinkKind::Railway { tram } => {
                self.text("kind", "railroad");
                self.text("class", if tram { "tram" } else { "rail" });
            }
            LinkKind::Watercourse => self.text("kind", "watercourse"),
        }
        self.maybe("width", Some(link.width()));
        self.profile(&link.profile);
        self.text("name", &link.name);
        self.maybe("layer", Some(f64::from(link.layer)).filter(|l| *l != 0.0));
        for (key, id) in [("from", link.from), ("to", link.to)] {
            self.key(key);
            self.out.push('"');
            push_id(&mut self.out, id);
            self.out.push('"');
        }
        self.geometry("LineString");
        self.positions(core::iter::once(from).chain(link.via.iter().copied()).chain(core::iter::once(to)));
        self.out.push_str("}}");
    }
}

/// The word for a class that the reader takes for the same class.
fn class_word(class: StreetClass) -> &'static str {
    match class {
        StreetClass::Motorway => "motorway",
        StreetClass::Main => "primary",
        StreetClass::Street => "residential",
        StreetClass::Lane => "living_street",
        StreetClass::Service => "service",
        StreetClass::Path => "path",
        StreetClass::Steps => "steps",
    }
}

fn with_bounds(ring: &Ring) -> (DVec2, DVec2, &Ring) {
    let (low, high) = ring.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    (low - ON_SQUARE_M, high + ON_SQUARE_M, ring)
}

fn is_on_square(p: DVec2, squares: &[(DVec2, DVec2, &Ring)]) -> bool {
    squares.iter().filter(|(low, high, _)| p.cmpge(*low).all() && p.cmple(*high).all()).any(|(_, _, ring)| {
        crate::polygon::edges(ring).any(|(a, b)| {
            let t = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-12)).clamp(0.0, 1.0);
            a.lerp(b, t).distance(p) <= ON_SQUARE_M
        })
    })
}

fn is_bend(before: DVec2, p: DVec2, after: DVec2) -> bool {
    let (a, b) = (p - before, after - p);
    a.dot(b) < CURVE_COS * a.length() * b.length()
}

fn push_id(out: &mut String, id: Id) {
    use core::fmt::Write;
    // Writing to a string does not fail.
    let _ = write!(out, "{id}");
}

/// A number to a thousandth, without zeros at the end.
fn push_number(out: &mut String, value: f64) {
    let mut digits = Digits::new();
    digits.number::<1_000>(value);
    out.push_str(digits.text());
}

/// Numbers as text by integer arithmetic, written from the end: many times as fast as the shortest text of a float, which a
/// map needs millions of.
struct Digits {
    bytes: [u8; 64],
    at: usize,
}

impl Digits {
    fn new() -> Self {
        Self { bytes: [0; 64], at: 64 }
    }

    fn byte(&mut self, byte: u8) {
        // Two numbers with their signs and points take up at most 48 bytes.
        self.at = self.at.saturating_sub(1);
        self.bytes[self.at] = byte;
    }

    fn pair<const PARTS: u64>(&mut self, x: f64, y: f64) {
        self.number::<PARTS>(y);
        self.byte(b',');
        self.number::<PARTS>(x);
    }

    /// A number to so many parts of one, a power of ten, without zeros at the end.
    fn number<const PARTS: u64>(&mut self, value: f64) {
        let parts = libm::round(value * PARTS as f64) as i64;
        let (mut whole, mut rest, mut ten) = (parts.unsigned_abs() / PARTS, parts.unsigned_abs() % PARTS, PARTS);
        if rest > 0 {
            while rest % 10 == 0 {
                (rest, ten) = (rest / 10, ten / 10);
            }
            while ten > 1 {
                self.byte(b'0' + (rest % 10) as u8);
                (rest, ten) = (rest / 10, ten / 10);
            }
            self.byte(b'.');
        }
        loop {
            self.byte(b'0' + (whole % 10) as u8);
            whole /= 10;
            if whole == 0 {
                break;
            }
        }
        if parts < 0 {
            self.byte(b'-');
        }
    }

    fn text(&self) -> &str {
        core::str::from_utf8(&self.bytes[self.at..]).unwrap_or_default()
    }
}

/// A string of JSON.
fn push_string(out: &mut String, text: &str) {
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c.is_control() => out.push_str(&format!("\\u{:04x}", u32::from(c))),
            c => out.push(c),
        }
    }
    out.push('"');
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::Value;

    fn written(graph: &str, settings: GeoJsonSettings) -> Value {
        let graph: CityGraph = veduta_city::file::parse(graph, "t").unwrap_or_else(|e| panic!("{e}"));
        let text = to_geojson(&graph, &settings);
        serde_json::from_str(&text).unwrap_or_else(|e| panic!("{e}: {text}"))
    }

    fn kinds(value: &Value, feature: &str) -> Vec<String> {
        let all = value["features"].as_array().unwrap().iter().map(|f| &f["properties"]);
        all.filter(|p| p["feature"] == feature).map(|p| p["kind"].as_str().unwrap_or_default().to_owned()).collect()
    }

    const TOWN: &str = "(name: \"T\", anchor: (lat: 50, lon: 14), attribution: \"a \\\"b\\\"\",
        nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (100, 0)), (id: 3, pos: (0, 80)), (id: 4, pos: (-60, 0.25)), (id: 5, pos: (0, -90)),
                (id: 6, pos: (1, 1)), (id: 7, pos: (2, 300))],
        links: [(id: 11, from: 1, to: 2, kind: Street(Main), width_m: 12.5, via: [(50, 0.001), (60, 30)]), (from: 1, to: 3, kind: Street(Lane), profile: [(share: 0.05, width_m: 6), (share: 1, width_m: 8.25)]),
                (from: 1, to: 5, kind: Street(Path)), (from: 1, to: 4, kind: Street(Lane), name: \"Ulička\"), (from: 6, to: 7, kind: Railway(tram: false), layer: 1)],
        squares: [(outline: [(-100, -20), (-60, -20), (-60, 20), (-100, 20)])],
        blocks: [(outline: [(5, 5), (90, 5), (90, 70)], kind: Park)],
        buildings: [(outline: [(-5, -5), (-9, -5), (-9, -9)], height_m: 9)])";

    #[test]
    fn kinds_of_nodes_follow_the_streets_and_squares() {
        let value = written(TOWN, GeoJsonSettings { extent_m: Some([300.0, 400.5]), degrees: false });
        assert_eq!(
            kinds(&value, "node"),
            ["crossroads", "blind_alley", "blind_alley", "square_vertex", "blind_alley", "curve", "curve"],
            "nodes of rails alone are none"
        );
        assert_eq!(kinds(&value, "link"), ["street", "street", "street", "street", "railroad"]);
        assert_eq!(kinds(&value, "block"), ["park"]);
        assert_eq!((&value["map"]["extent_m"][1], &value["attribution"]), (&400.5.into(), &"a \"b\"".into()));
        let link = &value["features"][7];
        assert_eq!((&link["properties"]["width"], &link["geometry"]["coordinates"][1][1]), (&12.5.into(), &0.001.into()));
        assert!(link["properties"].get("width_profile").is_none());
        assert_eq!(value["features"][8]["properties"]["width_profile"], "0.05 6, 1 8.25");
        assert_eq!(value["features"][10]["properties"]["width"], 6.5, "the class's own width, where none is given");
    }

    #[test]
    fn degrees_are_those_of_rfc_7946() {
        let value = written(TOWN, GeoJsonSettings { degrees: true, ..GeoJsonSettings::default() });
        assert!(value.get("crs").is_none() && value.get("map").is_none());
        let at = &value["features"][0]["geometry"]["coordinates"];
        assert_eq!((at[0].as_f64(), at[1].as_f64()), (Some(14.0), Some(50.0)));
    }

    proptest! {
        #[test]
        fn numbers_are_right_to_a_thousandth(value in -1e7_f64..1e7) {
            let mut text = String::new();
            push_number(&mut text, value);
            prop_assert!((text.parse::<f64>().unwrap() - value).abs() <= 0.000_501, "{text} {value}");
        }

        #[test]
        fn every_number_is_one_of_json(bits in any::<u64>()) {
            let mut digits = Digits::new();
            digits.pair::<100_000_000>(f64::from_bits(bits), f64::from_bits(!bits));
            let text = format!("[{}]", digits.text());
            prop_assert!(serde_json::from_str::<[f64; 2]>(&text).is_ok(), "{text}");
        }

        #[test]
        fn strings_come_back(text in "\\PC{0,8}|[\"\\\\\n\u{1}é ]{0,8}") {
            let mut out = String::new();
            push_string(&mut out, &text);
            prop_assert_eq!(serde_json::from_str::<String>(&out).unwrap(), text);
        }
    }
}
