//! Façades given as pictures: cut, stored and shown; and files that claim to be pictures.

use std::time::{Duration, Instant};

use glam::DVec2;
use veduta_city::{FacadeDraft, FacadeObject, FacadeObjectKind, ObjectHead, ObjectRepeat, Rgb};
use veduta_texture::{
    CutError, CutFacade, PICTURE_SIDE, PICTURE_STORED_CAP, PictureError, PictureLayer, Pixels, compose, cut_facade, decode_picture,
    put_together,
};

const WALL: Rgb = Rgb(200, 150, 100);
const GLASS: Rgb = Rgb(40, 50, 60);

/// A wall 8 m wide and 10 m high with two windows of 1 m × 2 m, of which each has a white bar.
fn draft() -> FacadeDraft {
    let windows = FacadeObject {
        kind: FacadeObjectKind::Window,
        low: DVec2::new(1.0, 4.0),
        size: DVec2::new(1.0, 2.0),
        head: ObjectHead::Flat,
        depth_m: None,
        repeat: ObjectRepeat { columns: 2, rows: 1, step: DVec2::new(5.0, 0.0) },
    };
    FacadeDraft {
        name: "test".into(),
        picture: "test.png".into(),
        size_m: DVec2::new(8.0, 10.0),
        outline: vec![],
        objects: vec![windows],
    }
}

fn picture() -> Pixels {
    let (width, height) = (640, 800);
    let texel = |i: usize| {
        let (x, y) = (i % width, height - 1 - i / width);
        let is_window = |left: usize| (left..left + 80).contains(&x) && (320..480).contains(&y);
        match (is_window(80) || is_window(480), (390..410).contains(&y)) {
            (true, true) => Rgb(250, 250, 250),
            (true, false) => GLASS,
            _ => WALL,
        }
    };
    Pixels { width, texels: (0..width * height).map(texel).collect() }
}

/// How far two colours are apart, at most.
fn apart(a: Rgb, b: Rgb) -> u8 {
    a.0.abs_diff(b.0).max(a.1.abs_diff(b.1)).max(a.2.abs_diff(b.2))
}

#[test]
fn a_facade_is_cut_into_colour_small_textures_and_pictures() {
    let CutFacade { painted, pictures } = cut_facade(&draft(), &picture()).expect("it can be cut");
    assert_eq!((painted.check(), painted.colour, painted.sections), (Ok(()), WALL, 1));
    let window = &painted.textures[0];
    assert_eq!((window.width, window.height()), (9, 18));
    assert!(window.palette.len() <= 16 && window.palette.contains(&GLASS));
    assert_eq!((window.at(4, 3), window.at(4, 8)), (GLASS, Rgb(250, 250, 250)), "row 0 is the upper one");
    let [wall, atlas] = &pictures[..] else { panic!("the wall of a section, and an atlas") };
    // But for rims of half a texel.
    let filled = wall.texels.iter().filter(|&&texel| apart(texel, WALL) < 3).count();
    assert!(filled * 1_000 > wall.texels.len() * 998, "windows are filled: {filled} texels of wall");
    let glass = atlas.texels.iter().filter(|&&texel| texel == GLASS).count();
    assert!((5_000..20_000).contains(&glass), "{glass} texels of glass: one window of both");
}

#[test]
fn what_was_cut_is_composed_as_it_was() {
    let CutFacade { painted, pictures } = cut_facade(&draft(), &picture()).expect("it can be cut");
    let [shown] = &compose(&painted, &pictures).expect("it can be composed")[..] else { panic!("one section") };
    let at = |x_m: f64, y_m: f64| shown.texels[((1.0 - y_m / 10.0) * 512.0) as usize * PICTURE_SIDE + (x_m / 8.0 * 512.0) as usize];
    for (x, y, colour) in [(4.0, 5.0, WALL), (1.5, 4.3, GLASS), (6.5, 5.7, GLASS), (1.5, 5.0, Rgb(250, 250, 250))] {
        assert!(apart(at(x, y), colour) < 3, "{:?} at ({x}, {y})", at(x, y));
    }
    assert_eq!(compose(&painted, &pictures[..1]), None, "without its atlas");
    assert_eq!(compose(&painted, &[pictures[0].clone(), Pixels { width: 4, texels: vec![WALL; 16] }]), None);
}

#[test]
fn small_textures_are_put_together_where_they_were_cut() {
    let CutFacade { painted, .. } = cut_facade(&draft(), &picture()).expect("it can be cut");
    let [coarse] = &put_together(&painted).expect("it can be drawn")[..] else { panic!("one section") };
    let (mut right, count) = (0, coarse.width * coarse.height());
    for i in 0..count {
        let (x, y) = ((i % coarse.width) as f64 + 0.5, (i / coarse.width) as f64 + 0.5);
        let pixel = (y / coarse.height() as f64 * 800.0) as usize * 640 + (x / coarse.width as f64 * 640.0) as usize;
        right += usize::from(coarse.texels[i] == picture().texels[pixel]);
    }
    // Edges of windows lie between texels.
    assert!(right * 100 >= count * 98, "{right} of {count} texels");
    let dark = coarse.texels.iter().filter(|&&texel| texel != WALL).count() as f64 / count as f64;
    assert!((dark - 4.0 / 80.0).abs() < 0.004, "windows have {dark} of the wall");
}

#[test]
fn long_facades_are_split_in_a_row() {
    let long = FacadeDraft { size_m: DVec2::new(40.0, 10.0), ..draft() };
    let CutFacade { painted, pictures } = cut_facade(&long, &picture()).expect("it can be cut");
    assert_eq!((painted.sections, painted.pictures(), pictures.len()), (3, 4, 4));
    assert_eq!(put_together(&painted).map(|sections| sections.len()), Some(3));
    assert_eq!(compose(&painted, &pictures).map(|sections| sections.len()), Some(3));
    let bare = FacadeDraft {
        objects: vec![FacadeObject {
            low: DVec2::ZERO,
            size: DVec2::new(8.0, 10.0),
            repeat: ObjectRepeat::default(),
            ..draft().objects[0]
        }],
        ..draft()
    };
    assert_eq!(cut_facade(&bare, &picture()), Err(CutError::Covered));
}

#[test]
fn layers_have_all_mips_and_blocks_an_eighth_of_the_bytes() {
    let picture = Pixels { width: 512, texels: (0..512 * 512).map(|i| Rgb((i % 512 / 2) as u8, (i / 1024) as u8, 90)).collect() };
    let layer = PictureLayer::new(&picture).expect("a square");
    assert_eq!((layer.mips(), layer.texels.len()), (10, (0..10).map(|mip| (512 >> mip) * (512 >> mip) * 4).sum::<usize>()));
    let whole: usize = (0..10).map(|mip| ((512_usize >> mip).div_ceil(4)).pow(2) * 8).sum();
    assert_eq!(layer.in_blocks().len(), whole);
    assert!(layer.in_blocks().len() * 7 < layer.texels.len());
    assert_eq!(PictureLayer::new(&Pixels { width: 3, texels: vec![WALL; 9] }), None);
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
    let mut slowest = Duration::ZERO;
    for (name, file) in &bombs {
        let begun = Instant::now();
        let decoded = decode_picture(file);
        slowest = slowest.max(begun.elapsed());
        assert!(decoded.is_err(), "{name} is shown");
    }
    println!("{} files, the slowest took {slowest:?}", bombs.len());
    assert_eq!(decode_picture(&vec![0xFF; PICTURE_STORED_CAP + 1]), Err(PictureError::TooLong(PICTURE_STORED_CAP + 1)));
}
