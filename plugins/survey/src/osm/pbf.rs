//! OSM's binary format (<https://wiki.openstreetmap.org/wiki/PBF_Format>).
//!
//! Decoded here rather than by the `osmpbf` crate (which the tests compare with): that one ends in silence on a file cut
//! inside a blob's length, panics on crafted differences where overflow is checked, drops tags with bad indices unseen and
//! brings threads and memory maps that a browser lacks.

use std::io::Read;

use flate2::read::ZlibDecoder;

use super::MOST_BYTES;
use super::elements::{Bounds, Member, MemberKind, OsmData, Relation, Tags, Way};
use super::wire::{Value, Wire, WireFault, sums};
use crate::SurveyError;

/// Most bytes of a blob's header, and of its content, as the format lays down.
const MOST_HEADER: usize = 64 * 1024;
const MOST_BLOB: u64 = 32 * 1024 * 1024;

/// What is wrong with a blob.
enum Fault {
    Wire(WireFault),
    Zlib(String),
    Size,
    Missing(&'static str),
    Survey(SurveyError),
}

impl From<WireFault> for Fault {
    fn from(fault: WireFault) -> Self {
        Self::Wire(fault)
    }
}

impl From<SurveyError> for Fault {
    fn from(error: SurveyError) -> Self {
        Self::Survey(error)
    }
}

/// Whether the file opens with the header that the format begins with.
pub(crate) fn is_pbf(bytes: &[u8]) -> bool {
    bytes.get(4..15) == Some(b"\x0A\x09OSMHeader")
}

/// Reads a whole file.
pub(crate) fn read(bytes: &[u8], name: &str) -> Result<OsmData, SurveyError> {
    let (mut data, mut rest, mut unpacked, mut blob) = (OsmData::default(), bytes, 0_u64, 0_usize);
    while !rest.is_empty() {
        blob += 1;
        let cut = || SurveyError::Cut {
            name: name.to_owned(),
            format: "PBF",
            place: format!("inside blob {blob}, which begins at byte {}", bytes.len() - rest.len()),
        };
        let (length, tail) = rest.split_first_chunk::<4>().ok_or_else(cut)?;
        let length = u32::from_be_bytes(*length) as usize;
        let broken = |fault: Fault| named(fault, name, blob);
        if length > MOST_HEADER {
            return Err(broken(Fault::Size));
        }
        let (header, tail) = tail.split_at_checked(length).ok_or_else(cut)?;
        let (kind, size) = blob_header(header).map_err(broken)?;
        let (body, tail) = tail.split_at_checked(size).ok_or_else(cut)?;
        let content = blob_content(body, name).map_err(broken)?;
        unpacked += content.len() as u64;
        if unpacked > MOST_BYTES {
            return Err(SurveyError::TooLarge { name: name.to_owned(), what: "unpacked bytes", limit: MOST_BYTES });
        }
        match kind {
            b"OSMHeader" => header_block(&content, &mut data, name).map_err(broken)?,
            b"OSMData" => primitive_block(&content, &mut data, name).map_err(broken)?,
            _ => {}
        }
        rest = tail;
    }
    Ok(data)
}

fn named(fault: Fault, name: &str, blob: usize) -> SurveyError {
    let detail = match fault {
        Fault::Survey(error) => return error,
        Fault::Wire(fault) => fault.words().to_owned(),
        Fault::Zlib(words) => words,
        Fault::Size => "it is larger than the format allows".to_owned(),
        Fault::Missing(what) => format!("it has no {what}"),
    };
    SurveyError::Broken { name: name.to_owned(), format: "PBF", detail: format!("blob {blob}: {detail}") }
}

fn blob_header(bytes: &[u8]) -> Result<(&[u8], usize), Fault> {
    let (mut wire, mut kind, mut size) = (Wire(bytes), None, None);
    while let Some((field, value)) = wire.field()? {
        match field {
            1 => kind = Some(value.bytes()?),
            3 => size = Some(value.number()?),
            _ => {}
        }
    }
    let (kind, size) = (kind.ok_or(Fault::Missing("type"))?, size.ok_or(Fault::Missing("size"))?);
    if size > MOST_BLOB {
        return Err(Fault::Size);
    }
    Ok((kind, size as usize))
}

fn blob_content(bytes: &[u8], name: &str) -> Result<Vec<u8>, Fault> {
    let mut wire = Wire(bytes);
    while let Some((field, value)) = wire.field()? {
        match field {
            1 => return Ok(value.bytes()?.to_vec()),
            3 => {
                let mut out = Vec::new();
                let mut decoder = ZlibDecoder::new(value.bytes()?).take(MOST_BLOB + 1);
                decoder.read_to_end(&mut out).map_err(|e| Fault::Zlib(format!("its zlib stream fails: {e}")))?;
                return if out.len() as u64 > MOST_BLOB { Err(Fault::Size) } else { Ok(out) };
            }
            4..=7 => {
                let kind = ["LZMA", "bzip2", "LZ4", "zstd"].get(field as usize - 4).unwrap_or(&"unknown");
                return Err(Fault::Survey(SurveyError::Unsupported {
                    name: name.to_owned(),
                    feature: format!("{kind} compression"),
                    fix: "rewrite it with `osmium cat -f pbf`",
                }));
            }
            _ => {}
        }
    }
    Err(Fault::Missing("content"))
}

fn header_block(bytes: &[u8], data: &mut OsmData, name: &str) -> Result<(), Fault> {
    let mut wire = Wire(bytes);
    while let Some((field, value)) = wire.field()? {
        match field {
            1 => {
                let (mut inner, mut sides) = (Wire(value.bytes()?), [0.0; 4]);
                while let Some((side, value)) = inner.field()? {
                    if let Some(slot) = (side as usize).checked_sub(1).and_then(|i| sides.get_mut(i)) {
                        *slot = value.signed()? as f64 * 1e-9;
                    }
                }
                let [west, east, north, south] = sides;
                data.bounds = Some(Bounds { south, west, north, east });
            }
            4 => {
                let feature = value.bytes()?;
                if feature != b"OsmSchema-V0.6" && feature != b"DenseNodes" {
                    return Err(Fault::Survey(SurveyError::Unsupported {
                        name: name.to_owned(),
                        feature: format!("the feature {}", String::from_utf8_lossy(feature)),
                        fix: "give an extract of one moment, made with `osmium extract` or `osmium time-filter`",
                    }));
                }
            }
            _ => {}
        }
    }
    Ok(())
}

/// Table of strings and scale of coordinates of a block.
struct Block<'a> {
    strings: Vec<&'a [u8]>,
    granularity: i64,
    lat_offset: i64,
    lon_offset: i64,
}

impl<'a> Block<'a> {
    fn text(&self, index: u64) -> Result<&'a str, WireFault> {
        let bytes = usize::try_from(index).ok().and_then(|i| self.strings.get(i)).ok_or(WireFault::NoString)?;
        core::str::from_utf8(bytes).map_err(|_| WireFault::Text)
    }

    fn tags(&self, keys: &[u64], values: &[u64]) -> Result<Tags, WireFault> {
        if keys.len() != values.len() {
            return Err(WireFault::Uneven);
        }
        keys.iter().zip(values).map(|(&k, &v)| Ok((self.text(k)?, self.text(v)?))).collect()
    }

    fn degrees(&self, offset: i64, steps: i64) -> Result<f64, WireFault> {
        let nano = steps.checked_mul(self.granularity).and_then(|n| n.checked_add(offset)).ok_or(WireFault::Overflow)?;
        Ok(nano as f64 * 1e-9)
    }
}

fn primitive_block(bytes: &[u8], data: &mut OsmData, name: &str) -> Result<(), Fault> {
    let mut block = Block { strings: Vec::new(), granularity: 100, lat_offset: 0, lon_offset: 0 };
    let (mut wire, mut groups) = (Wire(bytes), Vec::new());
    while let Some((field, value)) = wire.field()? {
        match field {
            1 => {
                let mut table = Wire(value.bytes()?);
                while let Some((_, string)) = table.field()? {
                    block.strings.push(string.bytes()?);
                }
            }
            2 => groups.push(value.bytes()?),
            17 => block.granularity = value.number()? as i64,
            19 => block.lat_offset = value.number()? as i64,
            20 => block.lon_offset = value.number()? as i64,
            _ => {}
        }
    }
    for group in groups {
        let mut wire = Wire(group);
        while let Some((field, value)) = wire.field()? {
            match field {
                1 => node(&block, value, data, name)?,
                2 => dense_nodes(&block, value, data, name)?,
                3 => way(&block, value, data, name)?,
                4 => relation(&block, value, data, name)?,
                _ => {}
            }
        }
    }
    Ok(())
}

fn node(block: &Block<'_>, value: Value<'_>, data: &mut OsmData, name: &str) -> Result<(), Fault> {
    let (mut wire, mut id, mut lat, mut lon) = (Wire(value.bytes()?), 0, None, None);
    let (mut keys, mut values) = (Vec::new(), Vec::new());
    while let Some((field, value)) = wire.field()? {
        match field {
            1 => id = value.signed()?,
            2 => value.numbers(&mut keys)?,
            3 => value.numbers(&mut values)?,
            8 => lat = Some(value.signed()?),
            9 => lon = Some(value.signed()?),
            _ => {}
        }
    }
    data.admit(1, name)?;
    let (lat, lon) = (lat.ok_or(Fault::Missing("latitude"))?, lon.ok_or(Fault::Missing("longitude"))?);
    let tags = block.tags(&keys, &values)?;
    data.add_node(id, block.degrees(block.lat_offset, lat)?, block.degrees(block.lon_offset, lon)?, tags);
    Ok(())
}

fn dense_nodes(block: &Block<'_>, value: Value<'_>, data: &mut OsmData, name: &str) -> Result<(), Fault> {
    let (mut wire, mut ids, mut lats, mut lons, mut words) = (Wire(value.bytes()?), vec![], vec![], vec![], vec![]);
    while let Some((field, value)) = wire.field()? {
        match field {
            1 => value.numbers(&mut ids)?,
            8 => value.numbers(&mut lats)?,
            9 => value.numbers(&mut lons)?,
            10 => value.numbers(&mut words)?,
            _ => {}
        }
    }
    if ids.len() != lats.len() || ids.len() != lons.len() {
        return Err(WireFault::Uneven.into());
    }
    data.admit(ids.len(), name)?;
    let mut words = words.into_iter();
    for ((id, lat), lon) in sums(&ids).zip(sums(&lats)).zip(sums(&lons)) {
        let mut tags = Tags::default();
        // Key and value by turns; 0 ends a node's. A file without any tags leaves the whole list out.
        while let Some(key) = words.next().filter(|&k| k != 0) {
            tags.push(block.text(key)?, block.text(words.next().ok_or(WireFault::Uneven)?)?);
        }
        data.add_node(id?, block.degrees(block.lat_offset, lat?)?, block.degrees(block.lon_offset, lon?)?, tags);
    }
    Ok(())
}

fn way(block: &Block<'_>, value: Value<'_>, data: &mut OsmData, name: &str) -> Result<(), Fault> {
    let (mut wire, mut id) = (Wire(value.bytes()?), 0);
    let (mut keys, mut values, mut refs, mut lats, mut lons) = (vec![], vec![], vec![], vec![], vec![]);
    while let Some((field, value)) = wire.field()? {
        match field {
            1 => id = value.number()? as i64,
            2 => value.numbers(&mut keys)?,
            3 => value.numbers(&mut values)?,
            8 => value.numbers(&mut refs)?,
            9 => value.numbers(&mut lats)?,
            10 => value.numbers(&mut lons)?,
            _ => {}
        }
    }
    data.admit(1 + refs.len(), name)?;
    let nodes = sums(&refs).collect::<Result<Vec<_>, _>>()?;
    // Positions on ways: an option of the format that saves the nodes.
    if lats.len() == nodes.len() && lons.len() == nodes.len() {
        for ((&id, lat), lon) in nodes.iter().zip(sums(&lats)).zip(sums(&lons)) {
            let (lat, lon) = (block.degrees(block.lat_offset, lat?)?, block.degrees(block.lon_offset, lon?)?);
            if !data.nodes.contains_key(&id) {
                data.add_node(id, lat, lon, Tags::default());
            }
        }
    }
    data.ways.insert(id, Way { nodes, tags: block.tags(&keys, &values)? });
    Ok(())
}

fn relation(block: &Block<'_>, value: Value<'_>, data: &mut OsmData, name: &str) -> Result<(), Fault> {
    let (mut wire, mut id) = (Wire(value.bytes()?), 0);
    let (mut keys, mut values, mut roles, mut ids, mut kinds) = (vec![], vec![], vec![], vec![], vec![]);
    while let Some((field, value)) = wire.field()? {
        match field {
            1 => id = value.number()? as i64,
            2 => value.numbers(&mut keys)?,
            3 => value.numbers(&mut values)?,
            8 => value.numbers(&mut roles)?,
            9 => value.numbers(&mut ids)?,
            10 => value.numbers(&mut kinds)?,
            _ => {}
        }
    }
    if ids.len() != roles.len() || ids.len() != kinds.len() {
        return Err(WireFault::Uneven.into());
    }
    data.admit(1 + ids.len(), name)?;
    let mut members = Vec::with_capacity(ids.len());
    for ((id, &role), &kind) in sums(&ids).zip(&roles).zip(&kinds) {
        let kind = match kind {
            0 => MemberKind::Node,
            1 => MemberKind::Way,
            2 => MemberKind::Relation,
            _ => return Err(WireFault::Type.into()),
        };
        members.push(Member { kind, id: id?, role: block.text(role)?.into() });
    }
    data.relations.insert(id, Relation { members, tags: block.tags(&keys, &values)? });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(mut n: u64) -> Vec<u8> {
        let mut out = Vec::new();
        while n >= 0x80 {
            out.push(n as u8 | 0x80);
            n >>= 7;
        }
        out.push(n as u8);
        out
    }

    fn zigzag(n: i64) -> u64 {
        (n << 1 ^ n >> 63) as u64
    }

    fn plain(field: u64, n: u64) -> Vec<u8> {
        [number(field << 3), number(n)].concat()
    }

    fn bytes(field: u64, content: &[u8]) -> Vec<u8> {
        [number(field << 3 | 2), number(content.len() as u64), content.to_vec()].concat()
    }

    fn packed(field: u64, all: impl IntoIterator<Item = i64>) -> Vec<u8> {
        bytes(field, &all.into_iter().flat_map(|n| number(zigzag(n))).collect::<Vec<_>>())
    }

    fn blob(kind: &str, body: &[u8]) -> Vec<u8> {
        let header = [bytes(1, kind.as_bytes()), plain(3, body.len() as u64)].concat();
        [(header.len() as u32).to_be_bytes().to_vec(), header, body.to_vec()].concat()
    }

    fn file(header: &[u8], group: &[u8]) -> Vec<u8> {
        let strings = bytes(1, &["", "highway", "steps"].iter().flat_map(|s| bytes(1, s.as_bytes())).collect::<Vec<_>>());
        let block = [strings, bytes(2, group)].concat();
        [blob("OSMHeader", &bytes(1, header)), blob("OSMData", &bytes(1, &block))].concat()
    }

    fn dense(ids: [i64; 2]) -> Vec<u8> {
        let words = bytes(10, &[1, 2, 0, 0]);
        bytes(2, &[packed(1, ids), packed(8, [500_000_000, 1000]), packed(9, [140_000_000, -1000]), words].concat())
    }

    fn way(key: u64) -> Vec<u8> {
        bytes(3, &[plain(1, 9), bytes(2, &number(key)), bytes(3, &[2]), packed(8, [7, 1])].concat())
    }

    fn header() -> Vec<u8> {
        [bytes(4, b"OsmSchema-V0.6"), bytes(4, b"DenseNodes")].concat()
    }

    #[test]
    fn a_block_by_hand_is_read() {
        let data = read(&file(&header(), &[dense([7, 1]), way(1)].concat()), "a.pbf").unwrap();
        assert_eq!((data.nodes[&7].lat, data.nodes[&7].tags.get("highway")), (50.0, Some("steps")));
        assert!((data.nodes[&8].lat - 50.0001).abs() < 1e-9 && data.nodes[&8].tags.is_empty());
        assert_eq!((data.ways[&9].nodes.as_slice(), data.ways[&9].tags.get("highway")), (&[7, 8][..], Some("steps")));
    }

    #[test]
    fn every_cut_but_between_blobs_is_an_error() {
        let whole = file(&header(), &dense([7, 1]));
        let first = blob("OSMHeader", &bytes(1, &header())).len();
        for cut in (1..whole.len()).filter(|&c| c != first) {
            let error = read(&whole[..cut], "a.pbf").err().unwrap_or_else(|| panic!("cut at {cut} passed"));
            assert!(matches!(error, SurveyError::Cut { .. }), "{cut}: {error}");
        }
    }

    #[test]
    fn differences_beyond_64_bits_and_strings_beyond_the_table_are_named() {
        let error = read(&file(&header(), &dense([i64::MAX, 1])), "a.pbf").unwrap_err().to_string();
        assert!(error.contains("blob 2: differences add up to more than 64 bits"), "{error}");
        let error = read(&file(&header(), &way(3)), "a.pbf").unwrap_err().to_string();
        assert!(error.contains("outside the table of strings"), "{error}");
    }

    #[test]
    fn histories_and_strange_compression_are_refused_with_the_fix() {
        let error = read(&file(&bytes(4, b"HistoricalInformation"), &[]), "a.pbf").unwrap_err().to_string();
        assert!(error.contains("HistoricalInformation") && error.contains("osmium"), "{error}");
        let packed = [blob("OSMHeader", &bytes(1, &header())), blob("OSMData", &bytes(7, b"zz"))].concat();
        let error = read(&packed, "a.pbf").unwrap_err().to_string();
        assert!(error.contains("zstd compression"), "{error}");
    }

    /// What the other reader makes of a file: nodes, ways, relations, references, members, tags.
    fn peer_counts(bytes: &[u8]) -> [usize; 6] {
        use osmpbf::Element;
        let mut c = [0; 6];
        let count = |element: Element<'_>| match element {
            Element::Node(n) => (c[0], c[5]) = (c[0] + 1, c[5] + n.tags().count()),
            Element::DenseNode(n) => (c[0], c[5]) = (c[0] + 1, c[5] + n.tags().count()),
            Element::Way(w) => (c[1], c[3], c[5]) = (c[1] + 1, c[3] + w.refs().count(), c[5] + w.tags().count()),
            Element::Relation(r) => (c[2], c[4], c[5]) = (c[2] + 1, c[4] + r.members().count(), c[5] + r.tags().count()),
        };
        osmpbf::ElementReader::new(bytes).for_each(count).unwrap();
        c
    }

    #[test]
    fn real_files_read_as_osmpbf_reads_them() {
        let Some(folder) = crate::testing::data() else { return };
        for file in [
            "lauf_pegnitz/lauf_an_der_pegnitz_2020.osm.pbf",
            "helsinki_centre/helsinki_centre_2019.osm.pbf",
            "portland_dem/portland-central-filtered.osm.pbf",
            "valletta/valletta_2016.osm.pbf",
        ] {
            let bytes = std::fs::read(folder.join(file)).unwrap();
            let data = read(&bytes, file).unwrap();
            let refs = data.ways.values().map(|w| w.nodes.len()).sum();
            let members = data.relations.values().map(|r| r.members.len()).sum();
            let tags = data.nodes.values().map(|n| &n.tags).chain(data.ways.values().map(|w| &w.tags));
            let tags = tags.chain(data.relations.values().map(|r| &r.tags)).map(Tags::len).sum();
            let ours = [data.nodes.len(), data.ways.len(), data.relations.len(), refs, members, tags];
            assert_eq!(ours, peer_counts(&bytes), "{file}");
        }
    }
}
