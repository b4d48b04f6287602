use veduta_city::Overview;

use crate::blob::{BlobKind, pack, unpack};
use crate::wire::WireOverview;
use crate::{BlobRef, CityIndex, Reader, StoreError, valid};

/// Stored form of an overview. Outlines and heights must be multiples of [`veduta_city::MAP_STEP`].
#[must_use]
pub fn encode_overview(overview: &Overview) -> Vec<u8> {
    pack(BlobKind::Overview, &WireOverview::from(overview))
}

/// The overview of a whole city, or of what its index tells so far, put together: waits for the reader. For tools; walkers read what they
/// come to.
///
/// # Errors
/// If a part of it cannot be read or understood; the error names the file.
pub fn read_overview(reader: &dyn Reader, index: &CityIndex) -> Result<Overview, StoreError> {
    let parts = index.regions_here().map(|(_, region)| {
        let stored = reader.read(&region.overview.path(), u64::from(region.overview.bytes))?;
        decode_overview(&stored, &region.overview).map_err(|error| error.in_file(reader.describe(), &region.overview.path()))
    });
    Ok(Overview::joined(&parts.collect::<Result<Vec<_>, _>>()?))
}

/// The overview of stored bytes that the reference stands for.
///
/// # Errors
/// If the bytes are not those, cannot be decoded, or contradict themselves.
pub fn decode_overview(stored: &[u8], blob: &BlobRef) -> Result<Overview, StoreError> {
    let what = BlobKind::Overview.words();
    let wire: WireOverview = unpack(BlobKind::Overview, stored, blob)?;
    let overview = Overview::try_from(wire).map_err(|malformed| malformed.of(what))?;
    valid::check_overview(&overview).map_err(|reason| StoreError::Invalid { what, reason })?;
    Ok(overview)
}
