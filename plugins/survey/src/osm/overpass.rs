//! Overpass JSON (<https://wiki.openstreetmap.org/wiki/OSM_JSON>), with and without `out geom`.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::elements::{Bounds, Member, MemberKind, OsmData, Relation, Tags, Way};
use crate::SurveyError;

#[derive(Deserialize)]
struct Document {
    elements: Vec<Element>,
    remark: Option<String>,
    bounds: Option<Corners>,
}

#[derive(Deserialize)]
struct Corners {
    minlat: f64,
    minlon: f64,
    maxlat: f64,
    maxlon: f64,
}

#[derive(Deserialize, Clone, Copy)]
struct Position {
    lat: f64,
    lon: f64,
}

#[derive(Deserialize)]
struct Element {
    #[serde(rename = "type")]
    kind: String,
    id: i64,
    lat: Option<f64>,
    lon: Option<f64>,
    #[serde(default)]
    nodes: Vec<i64>,
    #[serde(default)]
    geometry: Vec<Option<Position>>,
    #[serde(default)]
    members: Vec<JsonMember>,
    #[serde(default)]
    tags: BTreeMap<String, String>,
}

#[derive(Deserialize)]
struct JsonMember {
    #[serde(rename = "type")]
    kind: String,
    #[serde(rename = "ref")]
    id: i64,
    #[serde(default)]
    role: String,
    #[serde(default)]
    geometry: Vec<Option<Position>>,
}

/// Reads a whole answer.
pub(crate) fn read(bytes: &[u8], name: &str) -> Result<OsmData, SurveyError> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let document: Document = serde_json::from_slice(bytes).map_err(|e| match e.classify() {
        serde_json::error::Category::Eof => {
            SurveyError::Cut { name: name.to_owned(), format: "JSON", place: format!("at line {} column {}", e.line(), e.column()) }
        }
        _ => SurveyError::Broken { name: name.to_owned(), format: "Overpass JSON", detail: e.to_string() },
    })?;
    if let Some(remark) = document.remark.filter(|r| r.contains("error")) {
        return Err(SurveyError::Incomplete { name: name.to_owned(), remark });
    }
    let mut data = OsmData {
        bounds: document.bounds.map(|b| Bounds { south: b.minlat, west: b.minlon, north: b.maxlat, east: b.maxlon }),
        ..OsmData::default()
    };
    for element in document.elements {
        add(element, &mut data, name)?;
    }
    Ok(data)
}

fn add(element: Element, data: &mut OsmData, name: &str) -> Result<(), SurveyError> {
    data.admit(1 + element.nodes.len() + element.geometry.len() + element.members.len(), name)?;
    let tags: Tags = element.tags.iter().map(|(k, v)| (k.as_str(), v.as_str())).collect();
    match element.kind.as_str() {
        "node" => {
            let (lat, lon) = (element.lat.unwrap_or(f64::NAN), element.lon.unwrap_or(f64::NAN));
            data.add_node(element.id, lat, lon, tags);
        }
        "way" => {
            let nodes = vertices(element.nodes, &element.geometry, data);
            data.ways.insert(element.id, Way { nodes, tags });
        }
        "relation" => {
            let mut members = Vec::with_capacity(element.members.len());
            for member in element.members {
                data.admit(member.geometry.len(), name)?;
                let kind = match member.kind.as_str() {
                    "node" => MemberKind::Node,
                    "way" => MemberKind::Way,
                    "relation" => MemberKind::Relation,
                    other => return Err(unknown(name, element.id, other)),
                };
                if kind == MemberKind::Way && !member.geometry.is_empty() && !data.ways.contains_key(&member.id) {
                    let nodes = vertices(Vec::new(), &member.geometry, data);
                    data.ways.insert(member.id, Way { nodes, tags: Tags::default() });
                }
                members.push(Member { kind, id: member.id, role: member.role.into() });
            }
            data.relations.insert(element.id, Relation { members, tags });
        }
        // What Overpass derives (counts, areas, timelines) has no geometry.
        "count" | "area" | "timeline" => {}
        other => return Err(unknown(name, element.id, other)),
    }
    Ok(())
}

fn unknown(name: &str, id: i64, kind: &str) -> SurveyError {
    let detail = format!("element {id} has the unknown type `{kind}`");
    SurveyError::Broken { name: name.to_owned(), format: "Overpass JSON", detail }
}

/// Nodes of a way: by id, their positions from the geometry where the nodes themselves were left out; by position where
/// ids were left out. A vertex outside the box asked for (`null`) becomes a reference to a node that is not there.
fn vertices(ids: Vec<i64>, geometry: &[Option<Position>], data: &mut OsmData) -> Vec<i64> {
    if ids.is_empty() {
        let missing = |i: usize| i64::MIN + i as i64;
        let at = |(i, p): (usize, &Option<Position>)| p.and_then(|p| data.node_at(p.lat, p.lon)).unwrap_or(missing(i));
        return geometry.iter().enumerate().map(at).collect();
    }
    for (&id, position) in ids.iter().zip(geometry) {
        if let (Some(p), false) = (position, data.nodes.contains_key(&id)) {
            data.add_node(id, p.lat, p.lon, Tags::default());
        }
    }
    ids
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_and_ways_are_read() {
        let text = r#"{"version": 0.6, "osm3s": {"copyright": "x"}, "elements": [
            {"type": "node", "id": 1, "lat": 1.0, "lon": 2.0, "user": "someone", "tags": {"name": "A"}},
            {"type": "way", "id": 2, "nodes": [1, 3], "geometry": [{"lat": 1.0, "lon": 2.0}, {"lat": 1.1, "lon": 2.0}]},
            {"type": "way", "id": 4, "geometry": [{"lat": 1.0, "lon": 2.0}, null, {"lat": 1.2, "lon": 2.0}]}]}"#;
        let data = read(text.as_bytes(), "a.json").unwrap();
        assert_eq!(data.ways[&2].nodes, [1, 3]);
        assert_eq!(data.nodes[&3].lat, 1.1);
        let seen: Vec<bool> = data.ways[&4].nodes.iter().map(|id| data.nodes.contains_key(id)).collect();
        assert_eq!(seen, [true, false, true]);
    }

    #[test]
    fn a_cut_answer_and_wrong_json_are_told_apart() {
        let text = r#"{"elements": [{"type": "node", "id": 1, "lat": 1.0, "lon": 2.0}]}"#;
        assert!(matches!(read(&text.as_bytes()[..40], "a.json"), Err(SurveyError::Cut { .. })));
        let text = text.replace("\"id\": 1", "\"id\": \"one\"");
        let error = read(text.as_bytes(), "a.json").unwrap_err().to_string();
        assert!(error.contains("a.json is broken Overpass JSON: invalid type: string"), "{error}");
    }

    #[test]
    fn a_remark_of_failure_is_an_error() {
        let text = r#"{"elements": [], "remark": "runtime error: Query run out of memory"}"#;
        assert!(matches!(read(text.as_bytes(), "a.json"), Err(SurveyError::Incomplete { .. })));
    }
}
