#![no_main]

use std::sync::Arc;

use libfuzzer_sys::fuzz_target;
use veduta_city::GridPos;
use veduta_fuzz::{Bounded, blob, bounded};
use veduta_store::{BlobRef, RegionEntry, RegionKey, decode_region};

#[global_allocator]
static ALLOCATOR: Bounded = Bounded;

fuzz_target!(|content: &[u8]| {
    let stored = blob(18, content);
    let entry = |key, first, cells, blob| RegionEntry {
        key: RegionKey(key),
        first,
        cells,
        skyline: 0,
        bounds: (GridPos(-1024, -1024), GridPos(1024, 1024)),
        blob,
    };
    // As many cells as the content says at its beginning, so that some fit.
    let cells = u32::from(content.first().copied().unwrap_or(0) % 4);
    let regions: Arc<[RegionEntry]> =
        [entry(0b1_11_00, 0, cells, BlobRef::of(&stored)), entry(0b1_11_01, cells, 3, BlobRef::default())].into();
    let content = content.get(1..).unwrap_or_default();
    let stored = blob(18, content);
    let mut regions = regions.to_vec();
    regions[0].blob = BlobRef::of(&stored);
    let Ok(region) = bounded(content.len(), || decode_region(&stored, 0, &regions)) else { return };
    let most = cells + 3;
    for cell in &region.cells {
        assert!(cell.visible.iter().all(|&cell| cell < most));
        assert!(cell.portals.iter().all(|&portal| (portal as usize) < region.portals.len()));
        let _anywhere = cell.outline.contains(GridPos(5, 5));
    }
    assert!(region.portals.iter().all(|portal| portal.cell < most && portal.other(portal.cell).is_none_or(|cell| cell < most)));
});
