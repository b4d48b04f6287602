//! Files that travel with a city as they are: what people wrote of its places, its tours, pictures and sounds.

use std::io::Read;

use flate2::Compression;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;

use crate::blob::{BlobKind, open};
use crate::reader::check_path;
use crate::{BlobRef, StoreError};

/// A file that travels with a city.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CityFile {
    /// By which others name it, relative to where the city was baked from: `old_prague.guide.ron`, `pictures/tyn.jpg`. Of ASCII letters, digits,
    /// `.`, `_`, `-` and `/`.
    pub path: String,
    /// Its content.
    pub blob: BlobRef,
}

/// Most bytes that a file may have.
pub const FILE_CAP: u64 = 16 << 20;
/// Most files of a city.
pub(crate) const FILES_CAP: usize = 4_096;

/// How the bytes behind the kind stand: as they are, or deflated.
const PLAIN: u8 = 0;
const DEFLATED: u8 = 1;

/// Stored form of a file: deflated where that is shorter.
///
/// # Errors
/// [`StoreError::TooLarge`] if it has more than [`FILE_CAP`] bytes.
pub fn encode_file(content: &[u8]) -> Result<Vec<u8>, StoreError> {
    let size = content.len() as u64;
    if size > FILE_CAP {
        return Err(too_large(size));
    }
    let mut stored = vec![BlobKind::File as u8, DEFLATED];
    stored.extend((size as u32).to_le_bytes());
    let header = stored.len();
    let mut encoder = DeflateEncoder::new(stored, Compression::best());
    // Writing to memory does not fail; if it did, the file would stand as it is.
    let deflated = std::io::Write::write_all(&mut encoder, content).and_then(|()| encoder.finish());
    match deflated {
        Ok(deflated) if deflated.len() < header + content.len() => Ok(deflated),
        _ => {
            let mut plain = vec![BlobKind::File as u8, PLAIN];
            plain.extend((size as u32).to_le_bytes());
            plain.extend(content);
            Ok(plain)
        }
    }
}

/// A file of stored bytes. Memory is taken for no more than [`FILE_CAP`].
///
/// # Errors
/// If the bytes are not those that the reference stands for, or do not make the file that they claim to be.
pub fn decode_file(stored: &[u8], blob: &BlobRef) -> Result<Vec<u8>, StoreError> {
    let what = BlobKind::File.words();
    let malformed = |reason: &str| StoreError::Malformed { what, reason: reason.to_owned() };
    let rest = open(BlobKind::File, stored, blob)?;
    let Some((&[form, a, b, c, d], body)) = rest.split_first_chunk::<5>() else { return Err(malformed("it ends too early")) };
    let size = u64::from(u32::from_le_bytes([a, b, c, d]));
    if size > FILE_CAP {
        return Err(too_large(size));
    }
    let content = match form {
        PLAIN => body.to_vec(),
        DEFLATED => {
            let mut content = Vec::new();
            // One more than it claims, to find that there is more.
            let read = DeflateDecoder::new(body).take(size + 1).read_to_end(&mut content);
            read.map_err(|_| malformed("it cannot be inflated"))?;
            content
        }
        _ => return Err(malformed("it is stored in a way that is not known")),
    };
    if content.len() as u64 != size {
        return Err(malformed("it is longer or shorter than it says"));
    }
    Ok(content)
}

fn too_large(size: u64) -> StoreError {
    StoreError::TooLarge { what: BlobKind::File.words(), claimed: size, cap: FILE_CAP }
}

/// Fails unless files are in the order of their paths, each once, and none could lead elsewhere.
pub(crate) fn check_files(files: &[CityFile]) -> Result<(), String> {
    if files.len() > FILES_CAP {
        return Err(format!("there are {} files, and no more than {FILES_CAP} are allowed", files.len()));
    }
    for file in files {
        check_path(&file.path).map_err(|error| error.to_string())?;
    }
    match files.windows(2).find(|pair| pair[0].path >= pair[1].path) {
        Some(pair) => Err(format!("the file {} does not come after {}", pair[1].path, pair[0].path)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(stored: &[u8]) -> Result<Vec<u8>, StoreError> {
        decode_file(stored, &BlobRef::of(stored))
    }

    #[test]
    fn files_survive_and_words_become_shorter() {
        let words = "It is said that ".repeat(500);
        let noise: Vec<u8> = (0..5_000_u64).map(|i| blake3::hash(&i.to_le_bytes()).as_bytes()[0]).collect();
        for content in [b"".as_slice(), b"x", words.as_bytes(), &noise] {
            let stored = encode_file(content).expect("small");
            assert!(stored.len() <= content.len() + 6);
            assert_eq!(read(&stored).as_deref(), Ok(content));
        }
        assert!(encode_file(words.as_bytes()).expect("small").len() < 200);
        assert!(matches!(encode_file(&vec![0; FILE_CAP as usize + 1]), Err(StoreError::TooLarge { .. })));
    }

    #[test]
    fn files_that_lie_about_their_size_are_refused_before_they_take_memory() {
        let stored = encode_file(&[0; 100_000]).expect("small");
        assert!(stored.len() < 300);
        let claim = |size: u32| [&stored[..2], &size.to_le_bytes(), &stored[6..]].concat();
        assert!(matches!(read(&claim(u32::MAX)), Err(StoreError::TooLarge { .. })));
        for size in [0, 99_999, 100_001] {
            assert!(matches!(read(&claim(size)), Err(StoreError::Malformed { .. })), "{size}");
        }
        for end in 0..stored.len() {
            assert!(read(&stored[..end]).is_err(), "cut after {end}");
        }
        assert!(matches!(read(&[BlobKind::File as u8, 9, 0, 0, 0, 0]), Err(StoreError::Malformed { .. })));
    }

    #[test]
    fn paths_of_files_lead_nowhere_else_and_come_in_order() {
        let files = |paths: &[&str]| -> Vec<CityFile> {
            paths.iter().map(|path| CityFile { path: (*path).to_owned(), blob: BlobRef::default() }).collect()
        };
        assert_eq!(check_files(&files(&["a.guide.ron", "pictures/tyn.jpg"])), Ok(()));
        for bad in [&["../a"][..], &["/a"], &["b", "a"], &["a", "a"], &[""], &["a\\b"]] {
            assert!(check_files(&files(bad)).is_err(), "{bad:?}");
        }
    }
}
