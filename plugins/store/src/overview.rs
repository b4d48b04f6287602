use veduta_city::Overview;

use crate::blob::{BlobKind, pack, unpack};
use crate::wire::{WireOverview, from_bytes, to_bytes};
use crate::{BlobRef, StoreError, valid};

/// Stored form of an overview.
#[must_use]
pub fn encode_overview(overview: &Overview) -> Vec<u8> {
    press(WireOverview::from(overview))
}

/// Stored form of an overview's columns, which go as soon as they are written.
pub(crate) fn press(wire: WireOverview) -> Vec<u8> {
    let content = to_bytes(&wire);
    drop(wire);
    pack(BlobKind::Overview, &content)
}

/// The overview of stored bytes that the reference stands for.
///
/// # Errors
/// If the bytes are not those, cannot be decoded, or contradict themselves.
pub fn decode_overview(stored: &[u8], blob: &BlobRef) -> Result<Overview, StoreError> {
    let what = BlobKind::Overview.words();
    let wire: WireOverview = from_bytes(what, &unpack(BlobKind::Overview, stored, blob)?)?;
    let overview = Overview::try_from(wire).map_err(|malformed| malformed.of(what))?;
    valid::check_overview(&overview).map_err(|reason| StoreError::Invalid { what, reason })?;
    Ok(overview)
}
