#![no_main]

use libfuzzer_sys::fuzz_target;
use veduta_fuzz::{Bounded, blob, bounded};
use veduta_store::{BlobRef, OverviewContext, decode_overview, encode_overview};

#[global_allocator]
static ALLOCATOR: Bounded = Bounded;

fuzz_target!(|content: &[u8]| {
    let (stored, context) = (blob(16, content), OverviewContext::default());
    let Ok(overview) = bounded(content, || decode_overview(&stored, &BlobRef::of(&stored), context)) else { return };
    assert!(overview.names.iter().all(|name| (name.house as usize) < overview.houses.len()));
    let again = encode_overview(&overview, context);
    assert_eq!(decode_overview(&again, &BlobRef::of(&again), context).as_ref(), Ok(&overview));
});
