#![no_main]

use libfuzzer_sys::fuzz_target;
use veduta_city::GridPos;
use veduta_fuzz::{Bounded, blob, bounded};
use veduta_store::{BlobRef, RegionEntry, RegionKey, decode_region};

#[global_allocator]
static ALLOCATOR: Bounded = Bounded;

fuzz_target!(|bytes: &[u8]| {
    // What the index says of the region, so that something fits: its cells, its skyline, whether it is the first or the second.
    let Some((&told, content)) = bytes.split_first() else { return };
    let (cells, skyline, number) = (u32::from(told % 4), u32::from(told >> 2 & 1), usize::from(told >> 3 & 1));
    let stored = blob(18, content);
    let bounds = (GridPos(-1024, -1024), GridPos(1024, 1024));
    let key = |square| RegionKey::new(square, 4).expect("a square of 16");
    let entry = |square, first, cells| RegionEntry { key: key(square), first, cells, skyline: 0, top: 0, bounds, blob: None };
    let mut regions = if number == 0 {
        [entry(0b11_00, 0, cells), entry(0b11_01, cells, 3)]
    } else {
        [entry(0b11_00, 0, 3), entry(0b11_01, 3, cells)]
    };
    (regions[number].skyline, regions[number].blob) = (skyline, Some(BlobRef::of(&stored)));
    let Ok(region) = bounded(content, || decode_region(&stored, number as u32, &regions)) else { return };
    let most = cells + 3;
    for cell in &region.cells {
        assert!(cell.visible.iter().all(|&cell| cell < most));
        assert!(cell.portals.iter().all(|&portal| (portal as usize) < region.portals.len()));
        let _anywhere = cell.outline.contains(GridPos(5, 5));
    }
    assert!(region.vistas.iter().all(|&number| number < 2));
    assert!(region.skyline.iter().all(|cell| regions[number].numbers().contains(cell)));
    assert!(region.portals.iter().all(|portal| portal.cell < most && portal.other(portal.cell).is_none_or(|cell| cell < most)));
});
