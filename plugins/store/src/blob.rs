//! Blobs: content-addressed, compressed pieces of a city.
//!
//! A blob as stored is one byte of kind, the inflated size as a varint, then raw deflate of the content. Its name is half of the
//! blake3 hash of all that.

use core::fmt;

use flate2::{Compress, Compression, Decompress, FlushCompress, FlushDecompress, Status};

use crate::StoreError;

/// Most bytes that any one thing may have once inflated.
pub(crate) const INFLATED_CAP: u64 = 64 << 20;
/// Most bytes that a packet or a region may have once inflated. Lower than [`INFLATED_CAP`], because several are decoded at a time.
pub(crate) const PACKET_CAP: u64 = 16 << 20;
/// Deflate cannot shrink further than this.
const DEFLATE_RATIO: u64 = 1032;

/// A piece of a city by its content: where it lies, how long it is, how to know that it is whole.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct BlobRef {
    /// First half of the blake3 hash of the bytes as stored: nobody finds other bytes for a given one.
    pub hash: [u8; 16],
    /// Bytes as stored, which is what travels. An index is refused in which a packet or a region claims more than some 16 MiB, or
    /// the overview or the styles more than some 64 MiB.
    pub bytes: u32,
}

impl BlobRef {
    /// Reference to bytes as stored.
    #[must_use]
    pub fn of(stored: &[u8]) -> Self {
        Self { hash: half_hash(stored), bytes: u32::try_from(stored.len()).unwrap_or(u32::MAX) }
    }

    /// Its name: the hash in 32 hexadecimal digits.
    #[must_use]
    pub fn name(&self) -> String {
        name_of_hash(self.hash)
    }

    /// Path within the city: `blobs/ab/abcdef….bin`.
    #[must_use]
    pub fn path(&self) -> String {
        let name = self.name();
        format!("blobs/{}/{name}.bin", name.get(..2).unwrap_or_default())
    }

    /// Fails unless the bytes are those that the reference stands for.
    ///
    /// # Errors
    /// [`StoreError::Length`] or [`StoreError::Checksum`].
    pub fn verify(&self, what: &'static str, stored: &[u8]) -> Result<(), StoreError> {
        if stored.len() as u64 != u64::from(self.bytes) {
            return Err(StoreError::Length { what, expected: u64::from(self.bytes), found: stored.len() as u64 });
        }
        if half_hash(stored) != self.hash {
            return Err(StoreError::Checksum { what });
        }
        Ok(())
    }
}

/// What a blob of these bytes is called.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn name_of(stored: &[u8]) -> String {
    name_of_hash(half_hash(stored))
}

fn name_of_hash(hash: [u8; 16]) -> String {
    format!("{:032x}", u128::from_be_bytes(hash))
}

fn half_hash(stored: &[u8]) -> [u8; 16] {
    let mut half = [0; 16];
    blake3::Hasher::new().update(stored).finalize_xof().fill(&mut half);
    half
}

impl fmt::Debug for BlobRef {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.name();
        write!(f, "BlobRef({}…, {} B)", name.get(..8).unwrap_or_default(), self.bytes)
    }
}

/// What a blob holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum BlobKind {
    Shell = 1,
    Facades = 2,
    Overview = 16,
    Styles = 17,
    Region = 18,
}

impl BlobKind {
    /// In words, for messages.
    pub(crate) const fn words(self) -> &'static str {
        match self {
            Self::Shell => "a packet of level 1",
            Self::Facades => "a packet of level 2",
            Self::Overview => "the overview",
            Self::Styles => "the styles",
            Self::Region => "a region of the index",
        }
    }

    const fn cap(self) -> u64 {
        match self {
            Self::Shell | Self::Facades | Self::Region => PACKET_CAP,
            Self::Overview | Self::Styles => INFLATED_CAP,
        }
    }

    /// Most bytes that a blob of the kind may have as stored: a little more than inflated, for deflate adds five bytes to
    /// each block that it cannot shrink.
    pub(crate) const fn stored_cap(self) -> u64 {
        self.cap() + self.cap() / 1024 + 64
    }

    fn of(byte: u8) -> Option<Self> {
        [Self::Shell, Self::Facades, Self::Overview, Self::Styles, Self::Region].into_iter().find(|&kind| kind as u8 == byte)
    }
}

/// Stored form of some content.
pub(crate) fn pack(kind: BlobKind, content: &[u8]) -> Vec<u8> {
    let mut stored = vec![kind as u8];
    let mut size = content.len() as u64;
    while size >= 0x80 {
        stored.push(size as u8 | 0x80);
        size >>= 7;
    }
    stored.push(size as u8);
    deflate(content, &mut stored);
    stored
}

/// Content of stored bytes that the reference stands for.
pub(crate) fn unpack(kind: BlobKind, stored: &[u8], blob: &BlobRef) -> Result<Vec<u8>, StoreError> {
    let what = kind.words();
    blob.verify(what, stored)?;
    let (&first, rest) = stored.split_first().ok_or(StoreError::Length { what, expected: 2, found: 0 })?;
    if first != kind as u8 {
        let found =
            BlobKind::of(first).map_or_else(|| format!("something of unknown kind {first}"), |kind| kind.words().to_owned());
        return Err(StoreError::Kind { expected: what, found });
    }
    let (size, deflated) =
        varint(rest).ok_or_else(|| StoreError::Malformed { what, reason: "its size is not a number".to_owned() })?;
    inflate(what, deflated, size, kind.cap())
}

/// A LEB128 number of at most five bytes at the head of some bytes, and what follows.
fn varint(bytes: &[u8]) -> Option<(u64, &[u8])> {
    let mut value = 0;
    for (i, &byte) in bytes.iter().enumerate().take(5) {
        value |= u64::from(byte & 0x7F) << (7 * i);
        if byte & 0x80 == 0 {
            return Some((value, bytes.get(i + 1..)?));
        }
    }
    None
}

/// Appends raw deflate of the content.
pub(crate) fn deflate(content: &[u8], out: &mut Vec<u8>) {
    let mut press = Compress::new(Compression::best(), false);
    loop {
        let done = usize::try_from(press.total_in()).unwrap_or(usize::MAX);
        out.reserve(content.len() / 3 + 64);
        let rest = content.get(done..).unwrap_or_default();
        // Deflating into memory has no way to fail; `reserve` above gives it room for progress each time round.
        match press.compress_vec(rest, out, FlushCompress::Finish) {
            Ok(Status::StreamEnd) => return,
            Ok(_) => {}
            Err(error) => unreachable!("deflate into memory: {error}"),
        }
    }
}

/// Inflates raw deflate that must give exactly `size` bytes and end where the input ends.
pub(crate) fn inflate(what: &'static str, deflated: &[u8], size: u64, cap: u64) -> Result<Vec<u8>, StoreError> {
    // A size that the input could not fill is refused before any memory is taken for it.
    let cap = cap.min(deflated.len() as u64 * DEFLATE_RATIO);
    if size > cap {
        return Err(StoreError::TooLarge { what, claimed: size, cap });
    }
    let bad = |reason: &str| StoreError::Malformed { what, reason: reason.to_owned() };
    let mut content = Vec::with_capacity(size as usize);
    let mut press = Decompress::new(false);
    let status =
        press.decompress_vec(deflated, &mut content, FlushDecompress::Finish).map_err(|_| bad("it is not a deflate stream"))?;
    if status != Status::StreamEnd || content.len() as u64 != size || press.total_in() != deflated.len() as u64 {
        return Err(bad("its inflated size is not what it says"));
    }
    Ok(content)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_survives_packing_at_every_size() {
        for n in [0_usize, 1, 127, 128, 5_000, 300_000] {
            let content: Vec<u8> = (0..n).map(|i| (i * i % 251) as u8).collect();
            let stored = pack(BlobKind::Overview, &content);
            assert_eq!(unpack(BlobKind::Overview, &stored, &BlobRef::of(&stored)), Ok(content));
        }
    }

    #[test]
    fn a_bomb_is_refused_before_it_goes_off() {
        let mut stored = vec![BlobKind::Shell as u8, 0xFF, 0xFF, 0xFF, 0x7F];
        deflate(&[0; 1000], &mut stored);
        let error = unpack(BlobKind::Shell, &stored, &BlobRef::of(&stored));
        assert!(matches!(error, Err(StoreError::TooLarge { .. })), "{error:?}");
        let mut honest = vec![BlobKind::Shell as u8, 10];
        deflate(&[0; 1 << 20], &mut honest);
        let error = unpack(BlobKind::Shell, &honest, &BlobRef::of(&honest));
        assert!(matches!(error, Err(StoreError::Malformed { .. })), "more than it says: {error:?}");
    }

    #[test]
    fn a_blob_of_another_kind_is_named() {
        let stored = pack(BlobKind::Styles, b"x");
        let error = unpack(BlobKind::Shell, &stored, &BlobRef::of(&stored)).expect_err("another kind");
        assert_eq!(error.to_string(), "expected a packet of level 1, found the styles");
    }

    #[test]
    fn blobs_lie_in_folders_by_their_first_two_digits() {
        let path = BlobRef::of(b"city").path();
        assert!(path.starts_with("blobs/") && path.ends_with(".bin"), "{path}");
        assert_eq!(path.get(6..8), path.get(9..11));
        assert_eq!(path.len(), "blobs/ab/".len() + 32 + ".bin".len());
    }
}
