#![no_main]

use libfuzzer_sys::fuzz_target;
use veduta_fuzz::{Bounded, blob, bounded, houses};
use veduta_store::{BlobRef, OverviewContext, decode_overview, encode_overview};

#[global_allocator]
static ALLOCATOR: Bounded = Bounded;

fuzz_target!(|bytes: &[u8]| {
    // Whether houses are known.
    let Some((&first, content)) = bytes.split_first() else { return };
    let houses = houses();
    let context = OverviewContext { houses: (first % 2 == 1).then_some(&houses), ..OverviewContext::default() };
    let stored = blob(16, content);
    let Ok(overview) = bounded(content, || decode_overview(&stored, &BlobRef::of(&stored), context)) else { return };
    assert!(overview.names.iter().all(|name| (name.house as usize) < overview.houses.len()));
    let again = encode_overview(&overview, context);
    assert_eq!(decode_overview(&again, &BlobRef::of(&again), context).as_ref(), Ok(&overview));
});
