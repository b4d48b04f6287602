#![no_main]

use libfuzzer_sys::fuzz_target;
use veduta_city::Level;
use veduta_fuzz::{Bounded, blob, bounded};
use veduta_store::{BlobRef, Packet, decode_packet, encode_packet, wall_count};

#[global_allocator]
static ALLOCATOR: Bounded = Bounded;

fuzz_target!(|bytes: &[u8]| {
    let Some((&first, content)) = bytes.split_first() else { return };
    let level = if first % 2 == 0 { Level::One } else { Level::Two };
    let stored = blob(level as u8, content);
    let Ok(packet) = bounded(content.len(), || decode_packet(&stored, &BlobRef::of(&stored), level)) else { return };
    if let Packet::Shell(shell) = &packet {
        let _walls = wall_count(shell);
        let _sums = shell.outline.outer.iter().map(|&pos| pos + shell.origin).max();
    }
    // What was read is written as something that reads back the same.
    let again = encode_packet(&packet);
    assert_eq!(decode_packet(&again, &BlobRef::of(&again), level).as_ref(), Ok(&packet));
});
