use std::io::Read;

use flate2::read::MultiGzDecoder;

use super::MOST_BYTES;
use crate::SurveyError;

pub(crate) fn is_gzip(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x1F, 0x8B])
}

/// The first bytes of what is packed, as far as they can be had.
pub(crate) fn head(bytes: &[u8], most: usize) -> Vec<u8> {
    let (mut out, mut buffer, mut decoder) = (Vec::new(), [0; 4096], MultiGzDecoder::new(bytes));
    while out.len() < most {
        match decoder.read(&mut buffer) {
            Ok(n) if n > 0 => out.extend_from_slice(buffer.get(..n).unwrap_or_default()),
            _ => break,
        }
    }
    out
}

/// Unpacks a whole file.
pub(crate) fn unpack(bytes: &[u8], name: &str) -> Result<Vec<u8>, SurveyError> {
    unpack_at_most(bytes, name, MOST_BYTES)
}

/// Unpacks a whole file of at most so many bytes.
pub(crate) fn unpack_at_most(bytes: &[u8], name: &str, limit: u64) -> Result<Vec<u8>, SurveyError> {
    let mut out = Vec::new();
    let result = MultiGzDecoder::new(bytes).take(limit + 1).read_to_end(&mut out);
    if out.len() as u64 > limit {
        return Err(SurveyError::TooLarge { name: name.to_owned(), what: "unpacked bytes", limit });
    }
    match result {
        Ok(_) => Ok(out),
        Err(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => Err(SurveyError::Cut {
            name: name.to_owned(),
            format: "gzip stream",
            place: format!("after {} packed bytes ({} unpacked)", bytes.len(), out.len()),
        }),
        Err(e) => Err(SurveyError::Broken {
            name: name.to_owned(),
            format: "gzip",
            detail: format!("{e} after {} unpacked bytes", out.len()),
        }),
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn packed(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn a_cut_stream_is_named_as_cut() {
        let whole = packed(&(0..50_000_u32).flat_map(u32::to_le_bytes).collect::<Vec<_>>());
        let error = unpack(&whole[..whole.len() / 2], "a.osm.gz").unwrap_err();
        assert!(matches!(error, SurveyError::Cut { .. }), "{error}");
        let error = unpack(&whole[..whole.len() - 4], "a.osm.gz").unwrap_err();
        assert!(matches!(error, SurveyError::Cut { .. }), "only the trailer is missing: {error}");
    }

    #[test]
    fn a_bomb_ends_at_the_limit() {
        let error = unpack_at_most(&packed(&[0; 100_000]), "a.osm.gz", 1000).unwrap_err();
        assert_eq!(error, SurveyError::TooLarge { name: "a.osm.gz".into(), what: "unpacked bytes", limit: 1000 });
    }

    #[test]
    fn a_wrong_checksum_is_broken() {
        let mut whole = packed(b"hello");
        let at = whole.len() - 6;
        whole[at] ^= 1;
        assert!(matches!(unpack(&whole, "a.gz"), Err(SurveyError::Broken { .. })));
    }
}
