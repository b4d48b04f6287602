//! OSM XML (<https://wiki.openstreetmap.org/wiki/OSM_XML>), as the API, Overpass, JOSM and osmium write it.

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

use super::elements::{Bounds, Member, MemberKind, OsmData, Relation, Tags, Way};
use crate::SurveyError;

/// The element that is being read.
enum Open {
    Node { id: i64, lat: f64, lon: f64, tags: Tags },
    Way { id: i64, way: Way },
    Relation { id: i64, relation: Relation },
}

impl Open {
    fn tags(&mut self) -> &mut Tags {
        match self {
            Self::Node { tags, .. } => tags,
            Self::Way { way, .. } => &mut way.tags,
            Self::Relation { relation, .. } => &mut relation.tags,
        }
    }
}

/// Attributes that matter, of any element. Names of people are passed over.
#[derive(Default)]
struct Attributes {
    id: Option<i64>,
    reference: Option<i64>,
    lat: Option<f64>,
    lon: Option<f64>,
    sides: [Option<f64>; 4],
    key: String,
    value: String,
    kind: String,
    role: String,
    is_deleted: bool,
}

struct XmlReader<'n> {
    name: &'n str,
    data: OsmData,
    open: Option<Open>,
    /// Way members of relations that bring their own geometry (`out geom`), being read.
    member_way: Option<(i64, Way)>,
    in_remark: bool,
}

/// Reads a whole file.
pub(crate) fn read(bytes: &[u8], name: &str) -> Result<OsmData, SurveyError> {
    let text = text_of(bytes, name)?;
    let mut source = Reader::from_str(text);
    let mut reader = XmlReader { name, data: OsmData::default(), open: None, member_way: None, in_remark: false };
    let (mut depth, mut is_root_closed) = (0_usize, false);
    loop {
        let at = |source: &Reader<&[u8]>| line_of(text, source.error_position().max(source.buffer_position()));
        match source.read_event() {
            Ok(Event::Start(element)) => {
                if depth == 0 {
                    reader.check_root(&element)?;
                }
                depth += 1;
                let line = line_of_later(text, &source);
                reader.start(&element, line)?;
            }
            Ok(Event::Empty(element)) => {
                if depth == 0 {
                    reader.check_root(&element)?;
                    is_root_closed = true;
                }
                let line = line_of_later(text, &source);
                reader.start(&element, line)?;
                reader.end(element.name().0)?;
            }
            Ok(Event::End(element)) => {
                depth = depth.saturating_sub(1);
                is_root_closed |= depth == 0;
                reader.end(element.name().0)?;
            }
            Ok(Event::Text(words)) if reader.in_remark => reader.remark(&words)?,
            Ok(Event::Eof) if is_root_closed && depth == 0 => return Ok(reader.data),
            Ok(Event::Eof) => return Err(reader.cut(line_of(text, text.len() as u64))),
            Ok(_) => {}
            Err(quick_xml::Error::Syntax(fault)) if source.buffer_position() >= text.len() as u64 => {
                return Err(reader.cut(format!("{}: {fault}", line_of(text, text.len() as u64))));
            }
            Err(fault) => return Err(reader.broken(at(&source), &fault.to_string())),
        }
    }
}

/// The file as text, without a byte-order mark.
fn text_of<'b>(bytes: &'b [u8], name: &str) -> Result<&'b str, SurveyError> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    core::str::from_utf8(bytes).map_err(|e| match e.error_len() {
        None => {
            SurveyError::Cut { name: name.to_owned(), format: "XML", place: format!("inside a letter at byte {}", e.valid_up_to()) }
        }
        Some(_) => {
            SurveyError::Broken { name: name.to_owned(), format: "XML", detail: format!("byte {} is not UTF-8", e.valid_up_to()) }
        }
    })
}

fn line_of(text: &str, at: u64) -> String {
    let before = text.as_bytes().get(..at as usize).unwrap_or(text.as_bytes());
    format!("line {}", 1 + before.iter().filter(|&&b| b == b'\n').count())
}

/// The line, told only when it is asked for: counting lines for every element would take quadratic time.
fn line_of_later<'t>(text: &'t str, source: &Reader<&[u8]>) -> impl Fn() -> String + use<'t> {
    let at = source.buffer_position();
    move || line_of(text, at)
}

impl XmlReader<'_> {
    fn cut(&self, place: String) -> SurveyError {
        SurveyError::Cut { name: self.name.to_owned(), format: "XML", place: format!("before its last element, at {place}") }
    }

    fn broken(&self, line: String, words: &str) -> SurveyError {
        SurveyError::Broken { name: self.name.to_owned(), format: "XML", detail: format!("{line}: {words}") }
    }

    fn check_root(&self, element: &BytesStart<'_>) -> Result<(), SurveyError> {
        if element.name().0 == "osm" { Ok(()) } else { Err(SurveyError::NotOsm { name: self.name.to_owned() }) }
    }

    fn attributes(&self, element: &BytesStart<'_>, line: &impl Fn() -> String) -> Result<Attributes, SurveyError> {
        let mut out = Attributes::default();
        for attribute in element.attributes() {
            let attribute = attribute.map_err(|e| self.broken(line(), &e.to_string()))?;
            let key = attribute.key.0;
            if matches!(key, "user" | "uid" | "timestamp" | "changeset" | "version") {
                continue;
            }
            let value = attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|e| self.broken(line(), &e.to_string()))?;
            let words = || self.broken(line(), &format!("`{value}` is no number for `{key}`"));
            match key {
                "id" => out.id = Some(value.parse().map_err(|_| words())?),
                "ref" => out.reference = value.parse().ok(),
                "lat" => out.lat = Some(value.parse().map_err(|_| words())?),
                "lon" => out.lon = Some(value.parse().map_err(|_| words())?),
                "minlat" => out.sides[0] = value.parse().ok(),
                "minlon" => out.sides[1] = value.parse().ok(),
                "maxlat" => out.sides[2] = value.parse().ok(),
                "maxlon" => out.sides[3] = value.parse().ok(),
                "k" => out.key = value.into_owned(),
                "v" => out.value = value.into_owned(),
                "type" => out.kind = value.into_owned(),
                "role" => out.role = value.into_owned(),
                "visible" => out.is_deleted |= value == "false",
                "action" => out.is_deleted |= value == "delete",
                _ => {}
            }
        }
        Ok(out)
    }

    fn start(&mut self, element: &BytesStart<'_>, line: impl Fn() -> String) -> Result<(), SurveyError> {
        let kind = element.name();
        let a = match kind.0 {
            "node" | "way" | "relation" | "bounds" | "nd" | "tag" | "member" => self.attributes(element, &line)?,
            "remark" => {
                self.in_remark = true;
                return Ok(());
            }
            _ => return Ok(()),
        };
        if let ("node" | "way" | "relation", None) = (kind.0, a.id) {
            return Err(self.broken(line(), &format!("a {} has no id", kind.0)));
        }
        let id = a.id.unwrap_or_default();
        match kind.0 {
            _ if a.is_deleted => {}
            "node" => {
                let (lat, lon) = (a.lat.unwrap_or(f64::NAN), a.lon.unwrap_or(f64::NAN));
                self.open = Some(Open::Node { id, lat, lon, tags: Tags::default() });
            }
            "way" => self.open = Some(Open::Way { id, way: Way::default() }),
            "relation" => self.open = Some(Open::Relation { id, relation: Relation::default() }),
            "bounds" if self.open.is_none() => {
                if let [Some(south), Some(west), Some(north), Some(east)] = a.sides {
                    self.data.bounds = Some(Bounds { south, west, north, east });
                }
            }
            "tag" => {
                if let Some(open) = &mut self.open {
                    open.tags().push(&a.key, &a.value);
                }
            }
            "nd" => self.vertex(&a)?,
            "member" => self.member(a, &line)?,
            _ => {}
        }
        Ok(())
    }

    /// A vertex of a way, or of a member that brings its geometry along.
    fn vertex(&mut self, a: &Attributes) -> Result<(), SurveyError> {
        self.data.admit(1, self.name)?;
        let id = match (a.reference, a.lat, a.lon) {
            (Some(id), Some(lat), Some(lon)) => {
                if !self.data.nodes.contains_key(&id) {
                    self.data.add_node(id, lat, lon, Tags::default());
                }
                Some(id)
            }
            (Some(id), ..) => Some(id),
            (None, Some(lat), Some(lon)) => self.data.node_at(lat, lon),
            _ => None,
        };
        let way = match (&mut self.member_way, &mut self.open) {
            (Some((_, way)), _) | (None, Some(Open::Way { way, .. })) => way,
            _ => return Ok(()),
        };
        way.nodes.extend(id);
        Ok(())
    }

    fn member(&mut self, a: Attributes, line: &impl Fn() -> String) -> Result<(), SurveyError> {
        self.data.admit(1, self.name)?;
        let Some(Open::Relation { relation, .. }) = &mut self.open else { return Ok(()) };
        // A bare member without a type, as some tools write it, is a way in a multipolygon.
        let kind = match a.kind.as_str() {
            "node" => MemberKind::Node,
            "way" | "" => MemberKind::Way,
            "relation" => MemberKind::Relation,
            other => return Err(self.broken(line(), &format!("a member has the unknown type `{other}`"))),
        };
        let Some(id) = a.reference else { return Err(self.broken(line(), "a member has no `ref`")) };
        relation.members.push(Member { kind, id, role: a.role.into() });
        if kind == MemberKind::Way {
            self.member_way = Some((id, Way::default()));
        }
        Ok(())
    }

    fn end(&mut self, kind: &str) -> Result<(), SurveyError> {
        match kind {
            "node" | "way" | "relation" => {}
            "member" => {
                if let Some((id, way)) = self.member_way.take().filter(|(_, way)| !way.nodes.is_empty()) {
                    self.data.ways.entry(id).or_insert(way);
                }
                return Ok(());
            }
            "remark" => {
                self.in_remark = false;
                return Ok(());
            }
            _ => return Ok(()),
        }
        if self.open.is_some() {
            self.data.admit(1, self.name)?;
        }
        match self.open.take() {
            Some(Open::Node { id, lat, lon, tags }) => self.data.add_node(id, lat, lon, tags),
            Some(Open::Way { id, way }) => {
                self.data.ways.insert(id, way);
            }
            Some(Open::Relation { id, relation }) => {
                self.data.relations.insert(id, relation);
            }
            None => {}
        }
        Ok(())
    }

    /// Overpass reports that it ran out of time or memory in a remark, after a seemingly whole answer.
    fn remark(&self, words: &str) -> Result<(), SurveyError> {
        if words.contains("error") {
            return Err(SurveyError::Incomplete { name: self.name.to_owned(), remark: words.trim().to_owned() });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TINY: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<osm version="0.6"><note>words</note>
 <bounds minlat="1" minlon="2" maxlat="3" maxlon="4"/>
 <node id="1" lat="1.5" lon="2.5" user="A. Mapper"/>
 <node id="2" lat="1.6" lon="2.5" visible="true"><tag k="name" v="A &amp; B"/></node>
 <node id="3" visible="false"/>
 <way id="9"><nd ref="1"/><nd ref="2"/><nd ref="77"/><tag k="highway" v="steps"/></way>
 <relation id="5"><member type="way" ref="9" role="outer"/><tag k="type" v="multipolygon"/></relation>
</osm>"#;

    #[test]
    fn elements_are_read() {
        let data = read(TINY.as_bytes(), "tiny.osm").unwrap();
        assert_eq!(data.bounds, Some(Bounds { south: 1.0, west: 2.0, north: 3.0, east: 4.0 }));
        assert_eq!(data.nodes.keys().copied().collect::<Vec<_>>(), [1, 2], "a deleted node is no node");
        assert_eq!(data.nodes[&2].tags.get("name"), Some("A & B"));
        assert_eq!(data.ways[&9].nodes, [1, 2, 77]);
        assert_eq!(data.relations[&5].members[0].id, 9);
        assert!(!format!("{data:?}").contains("Mapper"), "names of mappers stay outside");
    }

    #[test]
    fn every_cut_is_an_error() {
        let end = TINY.len();
        for cut in 60..end {
            let result = read(&TINY.as_bytes()[..cut], "tiny.osm");
            let error = result.err().unwrap_or_else(|| panic!("cut at {cut} of {end} passed"));
            assert!(matches!(error, SurveyError::Cut { .. } | SurveyError::Broken { .. }), "{cut}: {error}");
        }
    }

    #[test]
    fn mistakes_name_their_line() {
        let text = TINY.replace("lat=\"1.6\"", "lat=\"north\"");
        let error = read(text.as_bytes(), "tiny.osm").unwrap_err().to_string();
        assert!(error.contains("line 5: `north` is no number for `lat`"), "{error}");
        let text = TINY.replace("</way>", "</wya>");
        let error = read(text.as_bytes(), "tiny.osm").unwrap_err();
        assert!(matches!(error, SurveyError::Broken { .. }), "{error}");
    }

    #[test]
    fn overpass_running_out_of_time_is_an_error() {
        let text = "<osm><remark> runtime error: Query timed out </remark></osm>";
        let error = read(text.as_bytes(), "a.osm").unwrap_err();
        assert_eq!(error, SurveyError::Incomplete { name: "a.osm".into(), remark: "runtime error: Query timed out".into() });
    }

    #[test]
    fn geometry_without_nodes_is_taken() {
        let text = r#"<osm><way id="1"><bounds minlat="9" minlon="9" maxlat="9" maxlon="9"/><nd ref="4" lat="1" lon="2"/>
            <nd lat="1" lon="3"/></way><relation id="2"><member type="way" ref="8" role="outer"><nd lat="5" lon="6"/>
            <nd lat="5" lon="7"/></member></relation></osm>"#;
        let data = read(text.as_bytes(), "a.osm").unwrap();
        assert_eq!((data.nodes.len(), data.ways[&1].nodes.len(), data.ways[&8].nodes.len()), (4, 2, 2));
        assert_eq!(data.bounds, None, "bounds of a way are not those of the file");
    }
}
