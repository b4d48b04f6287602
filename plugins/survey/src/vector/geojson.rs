//! GeoJSON: RFC 7946, and what was written before it with a `crs` member (<https://geojson.org/geojson-spec.html>); also one
//! feature a line.

use core::fmt;
use std::collections::BTreeMap;

use glam::DVec2;
use serde::Deserialize;
use serde::de::{self, Deserializer, IgnoredAny, SeqAccess, Visitor};
use serde_json::Value;
use veduta_city::Anchor;

use super::feature::{Content, Feature, Line, Named, Shape};
use crate::SurveyError;
use crate::osm::MOST_ITEMS;

/// How far into a file its first words are looked for.
const HEAD: usize = 16 * 1024;

/// Names of objects that a GeoJSON file may consist of.
const TYPES: [&str; 9] = [
    "FeatureCollection",
    "Feature",
    "GeometryCollection",
    "Point",
    "MultiPoint",
    "LineString",
    "MultiLineString",
    "Polygon",
    "MultiPolygon",
];

/// Whether bytes look like GeoJSON.
pub(super) fn looks_like_geojson(bytes: &[u8]) -> bool {
    let head = bytes.get(..HEAD).unwrap_or(bytes);
    let head = head.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(head).trim_ascii_start();
    let text = String::from_utf8_lossy(head);
    let is_type = |t: &str| text.contains(&format!("\"{t}\""));
    text.starts_with('{') && text.contains("\"type\"") && !text.contains("\"elements\"") && TYPES.iter().any(|t| is_type(t))
}

/// Any object of a file: members that its type does not have are simply not there.
#[derive(Deserialize)]
struct Object {
    #[serde(rename = "type")]
    kind: String,
    #[serde(default)]
    features: Option<Vec<Object>>,
    #[serde(default)]
    geometry: Option<Geometry>,
    #[serde(default)]
    properties: Option<BTreeMap<String, Value>>,
    #[serde(default)]
    id: Option<Value>,
    #[serde(default)]
    coordinates: Option<Coordinates>,
    #[serde(default)]
    geometries: Option<Vec<Geometry>>,
    #[serde(default)]
    crs: Option<Value>,
    #[serde(default)]
    map: Option<Value>,
    #[serde(default)]
    attribution: Option<Value>,
}

#[derive(Deserialize)]
struct Geometry {
    #[serde(rename = "type")]
    kind: String,
    #[serde(default)]
    coordinates: Option<Coordinates>,
    #[serde(default)]
    geometries: Option<Vec<Geometry>>,
}

/// Nested arrays of numbers; a position is an array that begins with numbers, of which height and measure are passed over.
#[derive(Debug)]
enum Coordinates {
    Number(f64),
    Position(DVec2),
    List(Vec<Coordinates>),
}

impl<'de> Deserialize<'de> for Coordinates {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(CoordinatesVisitor)
    }
}

struct CoordinatesVisitor;

impl<'de> Visitor<'de> for CoordinatesVisitor {
    type Value = Coordinates;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("coordinates: numbers in nested arrays")
    }

    fn visit_f64<E: de::Error>(self, number: f64) -> Result<Coordinates, E> {
        Ok(Coordinates::Number(number))
    }

    fn visit_i64<E: de::Error>(self, number: i64) -> Result<Coordinates, E> {
        Ok(Coordinates::Number(number as f64))
    }

    fn visit_u64<E: de::Error>(self, number: u64) -> Result<Coordinates, E> {
        Ok(Coordinates::Number(number as f64))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Coordinates, A::Error> {
        let Some(first) = seq.next_element::<Coordinates>()? else { return Ok(Coordinates::List(Vec::new())) };
        let Coordinates::Number(x) = first else {
            let mut list = vec![first];
            while let Some(next) = seq.next_element::<Coordinates>()? {
                if matches!(next, Coordinates::Number(_)) {
                    return Err(de::Error::custom("a number among arrays of coordinates"));
                }
                list.push(next);
            }
            return Ok(Coordinates::List(list));
        };
        let y: Option<f64> = seq.next_element()?;
        while seq.next_element::<IgnoredAny>()?.is_some() {}
        y.map(|y| Coordinates::Position(DVec2::new(x, y))).ok_or_else(|| de::Error::custom("a position of one number"))
    }
}

/// Reads a whole file.
pub(super) fn read(bytes: &[u8], name: &str) -> Result<Content, SurveyError> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let mut content = Content::default();
    let mut count = 0_u64;
    let mut any = false;
    for object in serde_json::Deserializer::from_slice(bytes).into_iter::<Object>() {
        let object = object.map_err(|e| match e.classify() {
            serde_json::error::Category::Eof => {
                let place = format!("at line {} column {}", e.line(), e.column());
                SurveyError::Cut { name: name.to_owned(), format: "GeoJSON", place }
            }
            _ => broken(name, e.to_string()),
        })?;
        any = true;
        take(object, &mut content, &mut count, name)?;
    }
    if any { Ok(content) } else { Err(broken(name, "it holds nothing".to_owned())) }
}

fn broken(name: &str, detail: String) -> SurveyError {
    SurveyError::Broken { name: name.to_owned(), format: "GeoJSON", detail }
}

/// Takes in a collection, a feature or a bare geometry.
fn take(object: Object, content: &mut Content, count: &mut u64, name: &str) -> Result<(), SurveyError> {
    content.crs = content.crs.take().or_else(|| crs_of(object.crs.as_ref(), object.map.as_ref()));
    let text = |value: Option<Value>| value.as_ref().and_then(Value::as_str).unwrap_or_default().to_owned();
    match object.kind.as_str() {
        "FeatureCollection" => {
            content.attribution = text(object.attribution);
            for feature in object.features.unwrap_or_default() {
                if feature.kind != "Feature" {
                    return Err(broken(name, format!("a feature of the type `{}`", crate::lines::short(&feature.kind))));
                }
                content.features.push(feature_of(feature, count, name)?);
            }
        }
        "Feature" => content.features.push(feature_of(object, count, name)?),
        _ => {
            let geometry = Geometry { kind: object.kind, coordinates: object.coordinates, geometries: object.geometries };
            let mut feature = Feature::default();
            shapes_of(geometry, &mut feature.shapes, count, name)?;
            content.features.push(feature);
        }
    }
    Ok(())
}

fn feature_of(object: Object, count: &mut u64, name: &str) -> Result<Feature, SurveyError> {
    let mut feature = Feature::default();
    for (key, value) in object.properties.unwrap_or_default() {
        flatten(key, value, &mut feature.attributes);
    }
    let id = object.id.map(|id| match id {
        Value::String(text) => text,
        other => other.to_string(),
    });
    feature.id = id.or_else(|| feature.get("@id").or_else(|| feature.get("id")).map(str::to_owned)).unwrap_or_default();
    if let Some(geometry) = object.geometry {
        shapes_of(geometry, &mut feature.shapes, count, name)?;
    }
    admit(count, 1 + feature.attributes.len(), name)?;
    Ok(feature)
}

/// Counts what is taken in; an error once it is too much.
fn admit(count: &mut u64, more: usize, name: &str) -> Result<(), SurveyError> {
    *count = count.saturating_add(more as u64);
    let is_too_much = *count > MOST_ITEMS;
    let error = || SurveyError::TooLarge { name: name.to_owned(), what: "features, vertices and attributes", limit: MOST_ITEMS };
    if is_too_much { Err(error()) } else { Ok(()) }
}

/// Plain values by their names; members of objects by dotted names. Lists are joined by semicolons, as OpenStreetMap does.
fn flatten(key: String, value: Value, out: &mut Vec<(String, String)>) {
    match value {
        Value::Null => {}
        Value::String(text) => out.push((key, text)),
        Value::Object(members) => members.into_iter().for_each(|(k, v)| flatten(format!("{key}.{k}"), v, out)),
        Value::Array(items) => {
            let plain =
                items.iter().filter_map(|v| v.as_str().map(str::to_owned).or_else(|| v.as_number().map(ToString::to_string)));
            let joined = plain.collect::<Vec<_>>().join(";");
            if !joined.is_empty() {
                out.push((key, joined));
            }
        }
        // OpenStreetMap's words for the two.
        Value::Bool(truth) => out.push((key, if truth { "yes" } else { "no" }.to_owned())),
        Value::Number(number) => out.push((key, number.to_string())),
    }
}

fn shapes_of(geometry: Geometry, out: &mut Vec<Shape>, count: &mut u64, name: &str) -> Result<(), SurveyError> {
    if geometry.kind == "GeometryCollection" {
        for member in geometry.geometries.unwrap_or_default() {
            shapes_of(member, out, count, name)?;
        }
        return Ok(());
    }
    let kind = geometry.kind.as_str();
    let coordinates = geometry.coordinates.unwrap_or(Coordinates::List(Vec::new()));
    let wrong = || broken(name, format!("coordinates that are no {}", crate::lines::short(kind)));
    let shape = match kind {
        // A position of no numbers is how some programs write an empty geometry.
        "Point" => Shape::Points(match coordinates {
            Coordinates::List(none) if none.is_empty() => Vec::new(),
            one => vec![position(&one).ok_or_else(wrong)?],
        }),
        "MultiPoint" => Shape::Points(line(coordinates).ok_or_else(wrong)?),
        "LineString" => Shape::Lines(vec![line(coordinates).ok_or_else(wrong)?]),
        "MultiLineString" => Shape::Lines(lines(coordinates).ok_or_else(wrong)?),
        "Polygon" => Shape::Rings(rings(coordinates).ok_or_else(wrong)?),
        "MultiPolygon" => {
            let Coordinates::List(polygons) = coordinates else { return Err(wrong()) };
            let mut all = Vec::new();
            for polygon in polygons {
                all.extend(rings(polygon).ok_or_else(wrong)?);
            }
            Shape::Rings(all)
        }
        other => return Err(broken(name, format!("a geometry of the type `{}`", crate::lines::short(other)))),
    };
    admit(count, 1 + shape.positions().count(), name)?;
    out.push(shape);
    Ok(())
}

fn position(coordinates: &Coordinates) -> Option<DVec2> {
    if let Coordinates::Position(p) = coordinates { Some(*p) } else { None }
}

fn line(coordinates: Coordinates) -> Option<Line> {
    let Coordinates::List(positions) = coordinates else { return None };
    positions.iter().map(position).collect()
}

fn lines(coordinates: Coordinates) -> Option<Vec<Line>> {
    let Coordinates::List(all) = coordinates else { return None };
    all.into_iter().map(line).collect()
}

fn rings(coordinates: Coordinates) -> Option<Vec<(Line, bool)>> {
    Some(lines(coordinates)?.into_iter().enumerate().map(|(i, ring)| (ring, i > 0)).collect())
}

/// The coordinate system that a file tells: a `crs` of before RFC 7946, or the `map` member of plan coordinates.
fn crs_of(crs: Option<&Value>, map: Option<&Value>) -> Option<Named> {
    let anchor = map.and_then(|m| m.get("anchor")).and_then(|a| {
        let number = |key: &str| a.get(key).and_then(Value::as_f64);
        Some(Anchor { lat: number("lat")?, lon: number("lon")? })
    });
    let name = crs.and_then(|c| {
        let properties = c.get("properties")?;
        let code = || properties.get("code").map(|code| format!("EPSG:{}", code.to_string().trim_matches('"')));
        properties.get("name").and_then(Value::as_str).map(str::to_owned).or_else(code)
    });
    match name {
        Some(name) if is_plan(&name) => Some(Named::Plan(anchor)),
        Some(name) => Some(Named::Text(name)),
        None if map.is_some_and(|m| m.get("extent_m").is_some() || m.get("anchor").is_some()) => Some(Named::Plan(anchor)),
        None => None,
    }
}

/// Names under which metres of a plan of its own go.
fn is_plan(name: &str) -> bool {
    let name = name.to_lowercase();
    ["plan", "local", "engineering"].iter().any(|word| name.contains(word))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TOWN: &str = r#"{"type": "FeatureCollection", "name": "Town", "features": [
        {"type": "Feature", "id": "way/7", "properties": {"highway": "residential", "names": {"primary": "Long Street"}, "lanes": 2,
         "oneway": true, "none": null, "list": ["a", 3]},
         "geometry": {"type": "LineString", "coordinates": [[14.0, 50.0, 200.5], [14.001, 50.0]]}},
        {"type": "Feature", "properties": null, "geometry": {"type": "MultiPolygon", "coordinates":
         [[[[14,50],[14.1,50],[14.1,50.1],[14,50]], [[14.01,50.01],[14.02,50.01],[14.02,50.02],[14.01,50.01]]]]}},
        {"type": "Feature", "properties": {}, "geometry": null}]}"#;

    #[test]
    fn features_are_read_with_nested_attributes() {
        let content = read(TOWN.as_bytes(), "town.geojson").unwrap();
        let [street, area, nothing] = content.features.as_slice() else { panic!("{content:?}") };
        assert_eq!(
            (street.id.as_str(), street.get("NAMES.primary"), street.get("lanes")),
            ("way/7", Some("Long Street"), Some("2"))
        );
        assert_eq!((street.get("oneway"), street.get("none"), street.get("list")), (Some("yes"), None, Some("a;3")));
        assert_eq!(street.shapes, [Shape::Lines(vec![vec![DVec2::new(14.0, 50.0), DVec2::new(14.001, 50.0)]])]);
        let Shape::Rings(rings) = &area.shapes[0] else { panic!("{area:?}") };
        assert_eq!(rings.iter().map(|(r, inner)| (r.len(), *inner)).collect::<Vec<_>>(), [(4, false), (4, true)]);
        assert!(nothing.shapes.is_empty());
        assert_eq!(content.crs, None);
    }

    #[test]
    fn bare_geometries_and_a_feature_a_line_are_read() {
        let lines = "{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"Point\",\"coordinates\":[1,2]}}\n".repeat(3);
        assert_eq!(read(lines.as_bytes(), "a.geojsonl").unwrap().features.len(), 3);
        let bare = br#"{"type":"GeometryCollection","geometries":[{"type":"Point","coordinates":[1,2]},{"type":"MultiPoint","coordinates":[[3,4]]}]}"#;
        assert_eq!(read(bare, "a.geojson").unwrap().features[0].shapes.len(), 2);
    }

    #[test]
    fn a_crs_member_is_heard() {
        let crs = |text: &str| read(text.as_bytes(), "a").unwrap().crs;
        let named = |name: &str| {
            format!(r#"{{"type":"FeatureCollection","features":[],"crs":{{"type":"name","properties":{{"name":"{name}"}}}}}}"#)
        };
        assert_eq!(crs(&named("urn:ogc:def:crs:EPSG::5514")), Some(Named::Text("urn:ogc:def:crs:EPSG::5514".into())));
        assert_eq!(crs(&named("veduta:plan")), Some(Named::Plan(None)));
        let anchored = r#"{"type":"FeatureCollection","features":[],"map":{"extent_m":[9,9],"anchor":{"lat":50,"lon":14}}}"#;
        assert_eq!(crs(anchored), Some(Named::Plan(Some(Anchor { lat: 50.0, lon: 14.0 }))));
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        let error = |text: &str| read(text.as_bytes(), "a.geojson").unwrap_err().to_string();
        assert!(error(&TOWN[..300]).contains("a.geojson is cut off: the GeoJSON ends at line 4"), "{}", error(&TOWN[..300]));
        assert!(error(&TOWN.replace("[14.001, 50.0]", "[14.001]")).contains("a position of one number at line 4"));
        assert!(error(&TOWN.replace("LineString", "Polygon")).contains("coordinates that are no Polygon"));
        assert!(error(&TOWN.replace("LineString", "CircularString")).contains("`CircularString`"));
        assert!(error(&TOWN.replace("50.0, 200.5", "1e999")).contains("number out of range"));
        assert!(error("").contains("it holds nothing"));
        assert!(error(&format!("{{\"type\":\"Point\",\"coordinates\":{}", "[".repeat(100_000))).contains("recursion limit"));
    }

    #[test]
    fn geojson_is_told_from_other_json() {
        assert!(looks_like_geojson(TOWN.as_bytes()));
        assert!(!looks_like_geojson(br#"{"version": 0.6, "elements": [{"type": "node"}]}"#));
        assert!(!looks_like_geojson(b"<osm/>"));
        assert!(!looks_like_geojson(br#"{"metres_per_pixel": 0.5}"#));
    }

    proptest! {
        #[test]
        fn mutated_bytes_never_panic(at in prop::collection::vec((0..TOWN.len(), any::<u8>()), 1..8), cut in 0..TOWN.len()) {
            let mut bytes = TOWN.as_bytes().to_vec();
            for (i, byte) in at {
                bytes[i] = byte;
            }
            let _ = read(&bytes, "a");
            let _ = read(&bytes[..cut], "a");
        }
    }
}
