use crate::blob::{BlobKind, pack, unpack};
use crate::wire::WireBlobs;
use crate::{BlobRef, StoreError, valid};

/// Regions whose blobs are told together. A city of no more tells them in its index.
pub(crate) const LEAF: usize = 64;

/// Stored form of a leaf of the index: where some regions are stored.
#[must_use]
pub fn encode_leaf(regions: &[BlobRef]) -> Vec<u8> {
    pack(BlobKind::Leaf, &WireBlobs::of(regions))
}

/// Where so many regions are stored, by the stored bytes of the leaf that the reference stands for.
///
/// # Errors
/// If the bytes are not those, cannot be decoded, or tell of another number of regions.
pub fn decode_leaf(stored: &[u8], blob: &BlobRef, count: usize) -> Result<Vec<BlobRef>, StoreError> {
    let what = BlobKind::Leaf.words();
    let wire: WireBlobs = unpack(BlobKind::Leaf, stored, blob)?;
    let regions = wire.all("regions of a leaf").map_err(|malformed| malformed.of(what))?;
    valid::check_leaf(&regions, count).map_err(|reason| StoreError::Invalid { what, reason })?;
    Ok(regions)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leaf_tells_of_as_many_regions_as_it_should() {
        let regions: Vec<BlobRef> = (0..3_u8).map(|n| BlobRef { hash: [n; 12], bytes: 900 + u32::from(n) }).collect();
        let stored = encode_leaf(&regions);
        let read = |count| decode_leaf(&stored, &BlobRef::of(&stored), count);
        assert_eq!(read(3).as_ref(), Ok(&regions));
        let error = read(64).expect_err("three").to_string();
        assert!(error.contains("it tells of 3 regions in place of 64"), "{error}");
        let stored = encode_leaf(&[BlobRef { bytes: 17 << 20, ..regions[0] }]);
        let error = decode_leaf(&stored, &BlobRef::of(&stored), 1).expect_err("large").to_string();
        assert!(error.contains("a region of the index claims 17825792 bytes"), "{error}");
    }
}
