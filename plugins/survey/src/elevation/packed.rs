//! Terrain as it is handed out: one file in a gzip stream or a zip archive.

use std::io::Read;

use flate2::Crc;
use flate2::read::DeflateDecoder;

use crate::SurveyError;
use crate::osm::gzip;

/// Most bytes that a file may unpack to: the largest grid in 32-bit numbers, and a quarter more for what stands around them.
const MOST_BYTES: u64 = 5 << 28;
/// Most entries of an archive that are looked at.
const MOST_ENTRIES: usize = 256;
/// Endings of what is read, the likeliest first.
const ENDINGS: &[&str] = &[".hgt", ".asc", ".tif", ".tiff", ".grd", ".txt"];

/// The content of a packed file.
#[derive(Debug)]
pub(super) struct Unpacked {
    pub bytes: Vec<u8>,
    /// The file's own name, where the package tells one.
    pub name: String,
    /// The `.prj` that lies beside it in the package.
    pub prj: Option<String>,
}

/// What is packed in a file; `None` if it is not packed.
pub(super) fn unpack(bytes: &[u8], name: &str) -> Result<Option<Unpacked>, SurveyError> {
    if gzip::is_gzip(bytes) {
        let inner = name.strip_suffix(".gz").unwrap_or(name).to_owned();
        let bytes = gzip::unpack_at_most(bytes, name, MOST_BYTES)?;
        return Ok(Some(Unpacked { bytes, name: inner, prj: None }));
    }
    if !bytes.starts_with(b"PK\x03\x04") {
        return Ok(None);
    }
    let entries = entries(bytes, name)?;
    let ends = |entry: &&Entry, ending: &str| entry.name.to_ascii_lowercase().ends_with(ending);
    let wanted = ENDINGS.iter().find_map(|ending| entries.iter().find(|e| ends(e, ending)));
    let Some(entry) = wanted else {
        let names: Vec<&str> = entries.iter().take(5).map(|e| e.name.as_str()).collect();
        return Err(SurveyError::Unsupported {
            name: name.to_owned(),
            feature: format!("an archive without elevations (it holds: {})", names.join(", ")),
            fix: "give the file with the elevations alone",
        });
    };
    let prj = entries.iter().find(|e| ends(e, ".prj")).map(|e| content(bytes, name, e)).transpose()?;
    let prj = prj.map(|text| String::from_utf8_lossy(&text).into_owned());
    Ok(Some(Unpacked { bytes: content(bytes, name, entry)?, name: entry.name.clone(), prj }))
}

/// A file in the archive's directory.
#[derive(Debug)]
struct Entry {
    name: String,
    method: u16,
    flags: u16,
    crc: u32,
    packed: u32,
    size: u32,
    /// Where its local header begins.
    at: u32,
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    bytes.get(at..)?.first_chunk().map(|b| u16::from_le_bytes(*b))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|b| u32::from_le_bytes(*b))
}

fn broken(name: &str, detail: String) -> SurveyError {
    SurveyError::Broken { name: name.to_owned(), format: "zip archive", detail }
}

/// The archive's directory of files; it stands at its end.
fn entries(bytes: &[u8], name: &str) -> Result<Vec<Entry>, SurveyError> {
    const END: &[u8] = b"PK\x05\x06";
    let cut = || SurveyError::Cut {
        name: name.to_owned(),
        format: "zip archive",
        place: format!("after {} bytes, before its directory", bytes.len()),
    };
    // The end mark is followed by 18 bytes and a comment of at most 64 KiB.
    let from = bytes.len().saturating_sub(22 + 65_535);
    let tail = bytes.get(from..).unwrap_or_default();
    let end = from + tail.windows(4).rposition(|w| w == END).ok_or_else(cut)?;
    let count = usize::from(u16_at(bytes, end + 10).ok_or_else(cut)?);
    let mut at = u32_at(bytes, end + 16).ok_or_else(cut)? as usize;
    let mut out = Vec::new();
    for i in 0..count.min(MOST_ENTRIES) {
        let (entry, next) =
            entry(bytes, at).ok_or_else(|| broken(name, format!("its directory breaks off at entry {i} of {count}")))?;
        at = next;
        out.extend((!entry.name.ends_with('/')).then_some(entry));
    }
    Ok(out)
}

fn entry(bytes: &[u8], at: usize) -> Option<(Entry, usize)> {
    if !bytes.get(at..)?.starts_with(b"PK\x01\x02") {
        return None;
    }
    let short = |i: usize| u16_at(bytes, at + i);
    let long = |i: usize| u32_at(bytes, at + i);
    let (name, extra, comment) = (usize::from(short(28)?), usize::from(short(30)?), usize::from(short(32)?));
    let entry = Entry {
        name: String::from_utf8_lossy(bytes.get(at + 46..at + 46 + name)?).into_owned(),
        flags: short(8)?,
        method: short(10)?,
        crc: long(16)?,
        packed: long(20)?,
        size: long(24)?,
        at: long(42)?,
    };
    Some((entry, at + 46 + name + extra + comment))
}

/// The unpacked bytes of an entry, checked by length and checksum.
fn content(bytes: &[u8], name: &str, entry: &Entry) -> Result<Vec<u8>, SurveyError> {
    let inner = &entry.name;
    let unsupported = |feature: &str| SurveyError::Unsupported {
        name: name.to_owned(),
        feature: format!("{feature} for {inner}"),
        fix: "unpack it and give the file inside",
    };
    if entry.flags & 1 != 0 {
        return Err(unsupported("a password"));
    }
    if entry.size == u32::MAX || entry.packed == u32::MAX || entry.at == u32::MAX {
        return Err(unsupported("ZIP64"));
    }
    let size = u64::from(entry.size);
    if size > MOST_BYTES {
        return Err(SurveyError::TooLarge { name: name.to_owned(), what: "unpacked bytes", limit: MOST_BYTES });
    }
    let (at, length) = (entry.at as usize, entry.packed as usize);
    let data = || {
        let (inner_name, extra) = (u16_at(bytes, at + 26)?, u16_at(bytes, at + 28)?);
        let from = at + 30 + usize::from(inner_name) + usize::from(extra);
        bytes.get(at..)?.starts_with(b"PK\x03\x04").then(|| bytes.get(from..from + length)).flatten()
    };
    let data = data().ok_or_else(|| broken(name, format!("{inner} lies outside of it")))?;
    let mut out = Vec::new();
    let result = match entry.method {
        0 => data.take(size + 1).read_to_end(&mut out),
        8 => DeflateDecoder::new(data).take(size + 1).read_to_end(&mut out),
        _ => return Err(unsupported("an unusual compression")),
    };
    if let Err(error) = result {
        return Err(broken(name, format!("{inner}: {error} after {} unpacked bytes", out.len())));
    }
    let mut crc = Crc::new();
    crc.update(&out);
    if out.len() as u64 != size || crc.sum() != entry.crc {
        return Err(broken(name, format!("{inner} does not come out as its directory says ({} bytes of {size})", out.len())));
    }
    Ok(out)
}

#[cfg(test)]
pub(super) mod tests {
    use std::io::Write;

    use super::*;

    /// An archive of deflated files.
    pub(in super::super) fn zip(files: &[(&str, &[u8])]) -> Vec<u8> {
        let (mut out, mut directory) = (Vec::new(), Vec::new());
        for &(name, bytes) in files {
            let mut encoder = flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::fast());
            encoder.write_all(bytes).unwrap();
            let packed = encoder.finish().unwrap();
            let mut crc = Crc::new();
            crc.update(bytes);
            let at = out.len() as u32;
            let mut common = vec![20, 0, 0, 0, 8, 0, 0, 0, 0, 0];
            for value in [crc.sum(), packed.len() as u32, bytes.len() as u32] {
                common.extend(value.to_le_bytes());
            }
            common.extend((name.len() as u16).to_le_bytes());
            common.extend([0, 0]);
            out.extend(b"PK\x03\x04".iter().chain(&common).chain(name.as_bytes()).chain(&packed));
            directory.extend(b"PK\x01\x02\x14\0".iter().chain(&common));
            directory.extend([0; 10]);
            directory.extend(at.to_le_bytes().iter().chain(name.as_bytes()));
        }
        let (at, size, count) = (out.len() as u32, directory.len() as u32, files.len() as u16);
        out.extend(directory);
        out.extend(b"PK\x05\x06\0\0\0\0");
        out.extend(count.to_le_bytes().iter().chain(&count.to_le_bytes()));
        out.extend(size.to_le_bytes().iter().chain(&at.to_le_bytes()).chain(&[0, 0]));
        out
    }

    #[test]
    fn the_file_with_elevations_is_found_with_its_system() {
        let archive = zip(&[("readme.pdf", b"x"), ("d/a.asc", b"ncols 1"), ("d/a.prj", b"EPSG:5514")]);
        let found = unpack(&archive, "a.zip").unwrap().unwrap();
        assert_eq!(
            (found.name.as_str(), found.bytes.as_slice(), found.prj.as_deref()),
            ("d/a.asc", &b"ncols 1"[..], Some("EPSG:5514"))
        );
        let error = unpack(&zip(&[("readme.pdf", b"x")]), "a.zip").unwrap_err();
        assert!(error.to_string().contains("it holds: readme.pdf"), "{error}");
        assert!(unpack(b"ncols 1", "a.asc").unwrap().is_none());
    }

    #[test]
    fn damage_is_told() {
        let archive = zip(&[("a.asc", &[b'7'; 5000])]);
        assert!(matches!(unpack(&archive[..archive.len() - 30], "a.zip"), Err(SurveyError::Cut { .. })));
        let at = archive.windows(4).position(|w| w == b"PK\x01\x02").unwrap();
        for (offset, what) in [(16, "checksum"), (24, "size"), (42, "place")] {
            let mut wrong = archive.clone();
            wrong[at + offset] ^= 1;
            assert!(matches!(unpack(&wrong, "a.zip"), Err(SurveyError::Broken { .. })), "a wrong {what} passed");
        }
        let mut bomb = archive;
        bomb[at + 24..at + 28].copy_from_slice(&0xF000_0000_u32.to_le_bytes());
        assert!(matches!(unpack(&bomb, "a.zip"), Err(SurveyError::TooLarge { .. })));
    }
}
