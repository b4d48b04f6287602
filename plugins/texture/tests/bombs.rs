//! Files that claim to be pictures: refused at once, whatever they say. A program of its own, so that its memory is its own.

use std::time::{Duration, Instant};

use veduta_texture::{PICTURE_STORED_CAP, PictureError, decode_picture};

/// Most memory that this process has had, bytes; `None` where the system does not say.
fn most_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? * 1024)
}

/// A picture that is stored as it should be.
fn stored() -> Vec<u8> {
    let bytes: Vec<u8> =
        (0..512 * 512).flat_map(|i: usize| [(i * 7919 % 251) as u8 / 8 + 100, (i / 2048) as u8, (i % 97) as u8]).collect();
    webp::Encoder::from_rgb(&bytes, 512, 512).encode(40.0).to_vec()
}

/// A hundred files that lie: about their size, their kind, or where they end.
fn bombs() -> Vec<(String, Vec<u8>)> {
    let good = stored();
    let with = |at: usize, bytes: &[u8]| {
        let mut bad = good.clone();
        bad[at..at + bytes.len()].copy_from_slice(bytes);
        bad
    };
    let mut bombs: Vec<(String, Vec<u8>)> = Vec::new();
    // Sizes that would take gigabytes, or nothing, or a little more than is there; in the frame, which begins with a tag and a mark.
    for side in [0_u16, 1, 8, 511, 513, 520, 1024, 4096, 8191, 16_383] {
        let [low, high] = side.to_le_bytes();
        bombs.push((format!("{side} wide"), with(26, &[low, high])));
        bombs.push((format!("{side} high"), with(28, &[low, high])));
        bombs.push((format!("{side} squared"), with(26, &[low, high, low, high])));
    }
    // Other kinds: lossless, extended, animated, with alpha, of a name that there is not.
    for kind in [b"VP8L", b"VP8X", b"ANIM", b"ANMF", b"ALPH", b"ICCP", b"EXIF", b"VP9 ", b"vp8 ", b"    "] {
        bombs.push((String::from_utf8_lossy(kind).into_owned(), with(12, kind)));
    }
    // Lengths of the whole and of the frame that are not theirs.
    for length in [0_u32, 1, 10, 1_000, 1 << 20, 1 << 30, u32::MAX] {
        bombs.push((format!("{length} B in all"), with(4, &length.to_le_bytes())));
        bombs.push((format!("a frame of {length} B"), with(16, &length.to_le_bytes())));
    }
    // A frame that changes another, of another mark, of a first part that is longer than it.
    bombs.push(("a change".to_owned(), with(20, &[good[20] | 1])));
    for mark in [[0, 0x01, 0x2A], [0x9D, 0, 0x2A], [0x9D, 0x01, 0]] {
        bombs.push((format!("mark {mark:?}"), with(23, &mark)));
    }
    bombs.push(("a long first part".to_owned(), with(20, &[good[20] | 0xE0, 0xFF, 0xFF])));
    // Flat colours that reach too far, are too many, broken or others.
    for (name, chunk) in [
        ("reach", [&b"FLAT\x04\0\0\0\x09"[..], &[0; 3]].concat()),
        ("many", [&b"FLAT\xC4\0\0\0\x02"[..], &[0; 195]].concat()),
        ("cut off", b"FLAT\x04\0\0\0\x02\0".to_vec()),
        ("long", b"FLAT\xFF\xFF\xFF\xFF\x02\0\0\0".to_vec()),
        ("other", b"EXIF\x04\0\0\0\x02\0\0\0".to_vec()),
    ] {
        let mut bad = [&good[..], &vec![0; good.len() % 2], &chunk].concat();
        let whole = (bad.len() - 8) as u32;
        bad[4..8].copy_from_slice(&whole.to_le_bytes());
        bombs.push((format!("flat colours: {name}"), bad));
    }
    // Cut off, and what it says with it.
    for part in 0..20 {
        let mut cut = good[..good.len() * part / 20].to_vec();
        bombs.push((format!("{part} twentieths"), cut.clone()));
        if cut.len() > 40 {
            let (whole, chunk) = ((cut.len() - 8) as u32, (cut.len() - 20) as u32);
            cut[4..8].copy_from_slice(&whole.to_le_bytes());
            cut[16..20].copy_from_slice(&chunk.to_le_bytes());
            bombs.push((format!("{part} twentieths that say so"), cut));
        }
    }
    // Other files, and bytes that follow nothing.
    bombs.push(("PNG".to_owned(), b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\x7f\xff\xff\xff\x7f\xff\xff\xff\x08\x02\0\0\0".to_vec()));
    bombs.push(("JPEG".to_owned(), [&b"\xFF\xD8\xFF\xC0\0\x11\x08\xFF\xFF\xFF\xFF"[..], &[0; 5_000]].concat()));
    bombs.push(("zeros".to_owned(), vec![0; 60_000]));
    for n in 0..100_usize.saturating_sub(bombs.len()) {
        bombs.push((format!("noise {n}"), (0..5_000).map(|i: usize| (i * i * (n + 3) / 7 % 256) as u8).collect()));
    }
    bombs
}

#[test]
fn a_hundred_pictures_that_lie_are_refused() {
    assert!(decode_picture(&stored()).is_ok());
    let bombs = bombs();
    assert!(bombs.len() >= 100, "{} files", bombs.len());
    let before = most_memory();
    let mut slowest = Duration::ZERO;
    for (name, file) in &bombs {
        let begun = Instant::now();
        let decoded = decode_picture(file);
        slowest = slowest.max(begun.elapsed());
        assert!(decoded.is_err(), "{name} is shown");
    }
    let grown = before.zip(most_memory()).map(|(before, after)| after - before);
    println!("{} files, the slowest took {slowest:?}, memory grew by {grown:?} B", bombs.len());
    assert!(grown.is_none_or(|bytes| bytes <= 64 << 20), "memory grew by {grown:?} B");
    assert_eq!(decode_picture(&vec![0xFF; PICTURE_STORED_CAP + 1]), Err(PictureError::TooLong(PICTURE_STORED_CAP + 1)));
}
