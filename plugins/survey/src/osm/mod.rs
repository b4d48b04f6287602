//! The raw layer: bytes to elements, told apart by content.

mod elements;
pub(crate) mod gzip;
mod overpass;
mod pbf;
mod wire;
mod xml;

pub(crate) use elements::{
    Bounds, MOST_ITEMS, Member, MemberKind, Node, OsmData, Relation, Tags, Way, number_from_place, relation_id, way_id,
};

use crate::SurveyError;

/// Most bytes that a file may unpack to.
pub(crate) const MOST_BYTES: u64 = 1 << 30;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Xml,
    Pbf,
    OverpassJson,
}

/// How far into a file its first words are looked for.
const HEAD: usize = 16 * 1024;

/// The format that the first bytes show.
fn format_of(bytes: &[u8]) -> Option<Format> {
    if pbf::is_pbf(bytes) {
        return Some(Format::Pbf);
    }
    let head = bytes.get(..HEAD).unwrap_or(bytes);
    let head = head.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(head).trim_ascii_start();
    let holds = |word: &[u8]| head.windows(word.len()).any(|w| w == word);
    match head.first() {
        Some(b'<') if holds(b"<osm ") || holds(b"<osm>") || holds(b"<osm\n") || holds(b"<osm\t") || holds(b"<osm\r") => {
            Some(Format::Xml)
        }
        Some(b'{') if holds(b"\"elements\"") && !holds(b"\"FeatureCollection\"") => Some(Format::OverpassJson),
        _ => None,
    }
}

/// Whether the first bytes look like one of the formats that [`decode`] reads.
pub(crate) fn looks_like_osm(bytes: &[u8]) -> bool {
    if gzip::is_gzip(bytes) { format_of(&gzip::head(bytes, HEAD)).is_some() } else { format_of(bytes).is_some() }
}

/// Reads any of the formats.
pub(crate) fn decode(bytes: &[u8], name: &str) -> Result<OsmData, SurveyError> {
    if gzip::is_gzip(bytes) {
        return decode_plain(&gzip::unpack(bytes, name)?, name);
    }
    if bytes.len() as u64 > MOST_BYTES {
        return Err(SurveyError::TooLarge { name: name.to_owned(), what: "bytes", limit: MOST_BYTES });
    }
    decode_plain(bytes, name)
}

fn decode_plain(bytes: &[u8], name: &str) -> Result<OsmData, SurveyError> {
    match format_of(bytes) {
        Some(Format::Xml) => xml::read(bytes, name),
        Some(Format::Pbf) => pbf::read(bytes, name),
        Some(Format::OverpassJson) => overpass::read(bytes, name),
        None => Err(SurveyError::NotOsm { name: name.to_owned() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_told_by_content() {
        assert_eq!(format_of(b"\xEF\xBB\xBF<?xml version='1.0'?>\n<osm version='0.6'/>"), Some(Format::Xml));
        assert_eq!(format_of(b"  {\"version\": 0.6, \"elements\": []}"), Some(Format::OverpassJson));
        assert_eq!(format_of(b"\0\0\0\x0D\x0A\x09OSMHeader\x18\x01"), Some(Format::Pbf));
        assert_eq!(format_of(b"{\"type\": \"FeatureCollection\", \"features\": []}"), None);
        assert_eq!(format_of(b"<osmChange version='0.6'/>"), None);
        assert_eq!(format_of(b""), None);
    }

    #[test]
    fn nothing_known_is_refused_by_name() {
        let error = decode(b"PK\x03\x04", "town.zip").unwrap_err();
        assert!(error.to_string().starts_with("town.zip is neither"), "{error}");
    }
}
