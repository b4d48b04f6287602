#![no_main]

use libfuzzer_sys::fuzz_target;
use veduta_fuzz::{Bounded, blob, bounded};
use veduta_store::{BlobRef, decode_overview, encode_overview};

#[global_allocator]
static ALLOCATOR: Bounded = Bounded;

fuzz_target!(|content: &[u8]| {
    let stored = blob(16, content);
    let Ok(overview) = bounded(content, || decode_overview(&stored, &BlobRef::of(&stored))) else { return };
    assert!(overview.names.iter().all(|name| (name.house as usize) < overview.houses.len()));
    let again = encode_overview(&overview);
    assert_eq!(decode_overview(&again, &BlobRef::of(&again)).as_ref(), Ok(&overview));
});
