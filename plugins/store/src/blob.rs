//! Blobs: content-addressed, compressed pieces of a city.
//!
//! A blob as stored is one byte of kind, then the content as [`code`](crate::code) writes it. Its name is the beginning of the blake3 hash
//! of all that.

use core::fmt;

use serde::{Serialize, de::DeserializeOwned};

use crate::StoreError;
use crate::code::{Outlines, Prior, Source, Unread, press, unpress, unpress_with};

/// Most bytes that any one thing may have as stored.
pub(crate) const STORED_CAP: u64 = 64 << 20;
/// Most values that any one thing may have.
pub(crate) const VALUES_CAP: u64 = 16 << 20;
/// The same of a packet, a region or what is read with them: lower, because several are decoded at a time.
const PACKET_CAP: u64 = 16 << 20;
const PACKET_VALUES_CAP: u64 = 4 << 20;

/// A piece of a city by its content: where it lies, how long it is, how to know that it is whole.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct BlobRef {
    /// Beginning of the blake3 hash of the bytes as stored: nobody finds other bytes for a given one.
    pub hash: [u8; Self::HASH_BYTES],
    /// Bytes as stored, which is what travels. An index is refused in which a packet, a region, its houses or a leaf claims more than
    /// some 16 MiB, or the overview or the styles more than some 64 MiB.
    pub bytes: u32,
}

impl BlobRef {
    /// How many bytes of a hash are told.
    pub const HASH_BYTES: usize = 12;

    /// Reference to bytes as stored.
    #[must_use]
    pub fn of(stored: &[u8]) -> Self {
        Self { hash: hash(stored), bytes: u32::try_from(stored.len()).unwrap_or(u32::MAX) }
    }

    /// Its name: the hash in 24 hexadecimal digits.
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
        if hash(stored) != self.hash {
            return Err(StoreError::Checksum { what });
        }
        Ok(())
    }
}

/// What a blob of these bytes is called.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn name_of(stored: &[u8]) -> String {
    name_of_hash(hash(stored))
}

fn name_of_hash(hash: [u8; BlobRef::HASH_BYTES]) -> String {
    hash.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn hash(stored: &[u8]) -> [u8; BlobRef::HASH_BYTES] {
    let mut hash = [0; BlobRef::HASH_BYTES];
    blake3::Hasher::new().update(stored).finalize_xof().fill(&mut hash);
    hash
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
    Pictures = 4,
    Overview = 16,
    Styles = 17,
    Region = 18,
    File = 19,
    Houses = 20,
    Leaf = 21,
}

impl BlobKind {
    /// In words, for messages.
    pub(crate) const fn words(self) -> &'static str {
        match self {
            Self::Shell => "a packet of level 1",
            Self::Facades => "a packet of level 2",
            Self::Pictures => "a packet of level 3",
            Self::Overview => "the overview",
            Self::Styles => "the styles",
            Self::Region => "a region of the index",
            Self::File => "a file of the city",
            Self::Houses => "the houses of a region",
            Self::Leaf => "a leaf of the index",
        }
    }

    const fn is_piece(self) -> bool {
        matches!(self, Self::Shell | Self::Facades | Self::Pictures | Self::Region | Self::Houses | Self::Leaf)
    }

    /// Most values that a blob of the kind may have.
    const fn values_cap(self) -> u64 {
        if self.is_piece() { PACKET_VALUES_CAP } else { VALUES_CAP }
    }

    /// Most bytes that a blob of the kind may have as stored.
    pub(crate) const fn stored_cap(self) -> u64 {
        if self.is_piece() { PACKET_CAP } else { STORED_CAP }
    }

    const fn prior(self) -> Prior {
        match self {
            Self::Shell => Prior::Shell,
            Self::Facades => Prior::Sheet,
            Self::Overview => Prior::Overview,
            Self::Pictures | Self::Styles | Self::File | Self::Leaf => Prior::None,
            Self::Region => Prior::Region,
            Self::Houses => Prior::Houses,
        }
    }

    fn of(byte: u8) -> Option<Self> {
        let packets = [Self::Shell, Self::Facades, Self::Pictures];
        let all = packets.into_iter().chain([Self::Overview, Self::Styles, Self::Region, Self::File, Self::Houses, Self::Leaf]);
        all.into_iter().find(|&kind| kind as u8 == byte)
    }
}

/// Stored form of some content.
pub(crate) fn pack<T: Serialize>(kind: BlobKind, content: &T) -> Vec<u8> {
    let mut stored = vec![kind as u8];
    press(content, None, kind.prior(), &mut stored);
    stored
}

/// Stored form of some content with lines.
pub(crate) fn pack_with<T: Serialize>(kind: BlobKind, (content, outlines): &(T, Outlines)) -> Vec<u8> {
    let mut stored = vec![kind as u8];
    press(content, Some(outlines), kind.prior(), &mut stored);
    stored
}

/// Content of stored bytes that the reference stands for.
pub(crate) fn unpack<T: DeserializeOwned>(kind: BlobKind, stored: &[u8], blob: &BlobRef) -> Result<T, StoreError> {
    unpress(kind.words(), open(kind, stored, blob)?, kind.prior(), kind.values_cap())
}

/// What is made of the content and lines of stored bytes that the reference stands for.
pub(crate) fn unpack_with<T: DeserializeOwned, O>(
    kind: BlobKind,
    stored: &[u8],
    blob: &BlobRef,
    make: impl FnOnce(T, &mut Source<'_, '_>) -> Result<O, Unread>,
) -> Result<O, StoreError> {
    unpress_with(kind.words(), open(kind, stored, blob)?, kind.prior(), kind.values_cap(), make)
}

/// What stands behind the kind of stored bytes that the reference stands for.
pub(crate) fn open<'a>(kind: BlobKind, stored: &'a [u8], blob: &BlobRef) -> Result<&'a [u8], StoreError> {
    let what = kind.words();
    blob.verify(what, stored)?;
    let (&first, rest) = stored.split_first().ok_or(StoreError::Length { what, expected: 2, found: 0 })?;
    if first != kind as u8 {
        let found =
            BlobKind::of(first).map_or_else(|| format!("something of unknown kind {first}"), |kind| kind.words().to_owned());
        return Err(StoreError::Kind { expected: what, found });
    }
    Ok(rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_survives_packing_at_every_size() {
        for n in [0_u64, 1, 127, 128, 5_000, 300_000] {
            let content: Vec<u64> = (0..n).map(|i| i * i % 251).collect();
            let stored = pack(BlobKind::Overview, &content);
            assert_eq!(unpack(BlobKind::Overview, &stored, &BlobRef::of(&stored)), Ok(content));
        }
    }

    #[test]
    fn a_bomb_is_refused_before_it_goes_off() {
        let read = |stored: &[u8]| unpack::<Vec<u8>>(BlobKind::Shell, stored, &BlobRef::of(stored));
        let zeros = pack(BlobKind::Shell, &vec![0_u8; 100_000]);
        assert_eq!((zeros.len() < 200, read(&zeros)), (true, Ok(vec![0; 100_000])));
        let claim = |size: &[u8]| [&zeros[..1], size, &zeros[4..]].concat();
        let error = read(&claim(&[0xFF, 0xFF, 0xFF, 0x7F]));
        assert!(matches!(error, Err(StoreError::TooLarge { .. })), "{error:?}");
        for (size, what) in [([0xA0, 0x8D, 0x06], "more than it says"), ([0xA2, 0x8D, 0x06], "fewer than it says")] {
            let error = read(&claim(&size));
            assert!(matches!(error, Err(StoreError::Malformed { .. })), "{what}: {error:?}");
        }
        assert_eq!(read(&claim(&[0xA1, 0x8D, 0x06])), Ok(vec![0; 100_000]));
    }

    #[test]
    fn a_blob_of_another_kind_is_named() {
        let stored = pack(BlobKind::Styles, &1_u8);
        let error = unpack::<u8>(BlobKind::Shell, &stored, &BlobRef::of(&stored)).expect_err("another kind");
        assert_eq!(error.to_string(), "expected a packet of level 1, found the styles");
    }

    #[test]
    fn blobs_lie_in_folders_by_their_first_two_digits() {
        let path = BlobRef::of(b"city").path();
        assert!(path.starts_with("blobs/") && path.ends_with(".bin"), "{path}");
        assert_eq!(path.get(6..8), path.get(9..11));
        assert_eq!(path.len(), "blobs/ab/".len() + 24 + ".bin".len());
    }
}
