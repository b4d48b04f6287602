#![no_main]

use libfuzzer_sys::fuzz_target;
use veduta_city::{GridPolygon, GridPos};
use veduta_fuzz::{Bounded, blob, bounded};
use veduta_store::{BlobRef, CellEntry, HousesContext, decode_houses, decode_leaf, encode_houses, encode_leaf};

#[global_allocator]
static ALLOCATOR: Bounded = Bounded;

fuzz_target!(|bytes: &[u8]| {
    // How many cells the region has, and whether the bytes are a leaf of the index.
    let Some((&told, content)) = bytes.split_first() else { return };
    let count = usize::from(told % 4);
    if told >> 7 == 1 {
        let stored = blob(21, content);
        let Ok(regions) = bounded(content, || decode_leaf(&stored, &BlobRef::of(&stored), count)) else { return };
        let again = encode_leaf(&regions);
        assert_eq!(decode_leaf(&again, &BlobRef::of(&again), count), Ok(regions));
        return;
    }
    let corners = [(0, 0), (20_480, 0), (20_480, 10_240), (0, 10_240)].map(|(x, y)| GridPos(x, y));
    let cell = CellEntry { outline: GridPolygon::simple(corners.to_vec()), ..CellEntry::default() };
    let cells = vec![cell; count];
    let context = HousesContext { cells: &cells, palettes: &[] };
    let stored = blob(20, content);
    let Ok(houses) = bounded(content, || decode_houses(&stored, &BlobRef::of(&stored), context)) else { return };
    assert_eq!((0..count).map(|place| houses.of_cell(place).len()).sum::<usize>(), houses.parts().len());
    // What was read is written as something that reads back the same.
    let again = encode_houses(&houses, context);
    assert_eq!(decode_houses(&again, &BlobRef::of(&again), context), Ok(houses));
});
