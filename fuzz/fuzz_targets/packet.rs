#![no_main]

use libfuzzer_sys::fuzz_target;
use veduta_city::Level;
use veduta_fuzz::{Bounded, blob, bounded, houses};
use veduta_store::{BlobRef, Packet, PacketContext, decode_packet, encode_packet, wall_count};

#[global_allocator]
static ALLOCATOR: Bounded = Bounded;

fuzz_target!(|bytes: &[u8]| {
    let Some((&first, content)) = bytes.split_first() else { return };
    let level = if first % 2 == 0 { Level::One } else { Level::Two };
    let stored = blob(level as u8, content);
    let houses = houses();
    let context = PacketContext { houses: (first / 2 % 2 == 1).then_some(&houses), place: 1, ..PacketContext::default() };
    let read = |stored: &[u8]| decode_packet(stored, &BlobRef::of(stored), level, context);
    let Ok(packet) = bounded(content, || read(&stored)) else { return };
    if let Packet::Shell(shell) = &packet {
        let _walls = wall_count(shell);
        let _sums = shell.outline.outer.iter().map(|&pos| pos + shell.origin).max();
    }
    // What was read is written as something that reads back the same.
    assert_eq!(read(&encode_packet(&packet, context)).as_ref(), Ok(&packet));
});
