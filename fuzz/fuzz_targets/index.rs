#![no_main]

use libfuzzer_sys::fuzz_target;
use veduta_city::GridPos;
use veduta_fuzz::{Bounded, bounded, index};
use veduta_store::decode_index;

#[global_allocator]
static ALLOCATOR: Bounded = Bounded;

fuzz_target!(|content: &[u8]| {
    let stored = index(content);
    let Ok(index) = bounded(content, || decode_index(&stored)) else { return };
    assert_eq!(index.region_of(index.cell_count()), None);
    for region in index.regions.iter() {
        for cell in region.numbers().take(2) {
            assert!(index.region_of(cell).is_some());
        }
    }
    let _anywhere = (index.locate(GridPos(0, 0)), index.regions_at(GridPos(9, -9)).count());
});
