#![no_main]

use libfuzzer_sys::fuzz_target;
use veduta_city::{Guide, file};

fuzz_target!(|bytes: &[u8]| {
    let Ok(guide) = file::parse_bytes::<Guide>(bytes, "fuzz") else { return };
    let _ = guide.validate();
    for place in &guide.places {
        assert!(guide.of(&place.name).is_some());
    }
    let text = file::to_text(&guide).expect("what is read can be written");
    assert_eq!(file::parse::<Guide>(&text, "again").expect("what is written can be read"), guide);
});
