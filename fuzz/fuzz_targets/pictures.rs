#![no_main]

use libfuzzer_sys::fuzz_target;
use veduta_city::Level;
use veduta_fuzz::{Bounded, blob, bounded};
use veduta_store::{BlobRef, PacketContext, decode_file, decode_packet, encode_file, encode_packet};

#[global_allocator]
static ALLOCATOR: Bounded = Bounded;

fuzz_target!(|bytes: &[u8]| {
    let Some((&first, content)) = bytes.split_first() else { return };
    if first % 2 == 0 {
        let read = |stored: &[u8]| decode_packet(stored, &BlobRef::of(stored), Level::Three, PacketContext::default());
        let stored = blob(4, content);
        let Ok(packet) = bounded(content, || read(&stored)) else { return };
        assert_eq!(read(&encode_packet(&packet, PacketContext::default())).as_ref(), Ok(&packet));
        return;
    }
    // What is deflated may be larger than it is stored, up to a file's cap: nothing is said of memory.
    let read = |stored: &[u8]| decode_file(stored, &BlobRef::of(stored));
    let Ok(file) = read(&blob(19, content)) else { return };
    let Ok(stored) = encode_file(&file) else { panic!("{} bytes are a file, and cannot be written as one", file.len()) };
    assert_eq!(read(&stored), Ok(file));
});
