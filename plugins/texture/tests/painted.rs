//! Façades given as pictures: cut, stored and shown; and files that claim to be pictures.

use std::time::{Duration, Instant};

use glam::DVec2;
use veduta_city::{FacadeDraft, FacadeObject, FacadeObjectKind, ObjectHead, ObjectRepeat, Rgb};
use veduta_texture::{
    CutError, PICTURE_SIDE, PICTURE_STORED_CAP, PictureError, PictureLayer, Pixels, decode_picture, encode_picture, paint_facade,
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
    FacadeDraft { name: "test".into(), picture: "test.png".into(), size_m: DVec2::new(8.0, 10.0), outline: vec![], objects: vec![windows] }
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

#[test]
fn a_facade_is_cut_into_colour_small_textures_and_sections() {
    let (painted, pictures) = paint_facade(&draft(), &picture()).expect("it can be cut");
    assert_eq!((painted.check(), painted.colour, painted.sections), (Ok(()), WALL, 1));
    let window = &painted.textures[0];
    assert_eq!((window.width, window.height()), (10, 20));
    assert!(window.palette.len() <= 16 && window.palette.contains(&GLASS));
    assert_eq!((window.at(5, 3), window.at(5, 9)), (GLASS, Rgb(250, 250, 250)), "row 0 is the upper one");
    let shown = decode_picture(&pictures[0].0).expect("it is whole");
    let at = |x_m: f64, y_m: f64| {
        let (x, y) = ((x_m / 8.0 * 512.0) as usize, ((1.0 - y_m / 10.0) * 512.0) as usize);
        shown.texels[y * PICTURE_SIDE + x]
    };
    for (x, y, colour) in [(4.0, 5.0, WALL), (1.5, 4.3, GLASS), (6.5, 5.7, GLASS), (1.5, 5.0, Rgb(250, 250, 250))] {
        let Rgb(r, g, b) = at(x, y);
        assert!(r.abs_diff(colour.0) < 12 && g.abs_diff(colour.1) < 12 && b.abs_diff(colour.2) < 12, "{:?} at ({x}, {y})", at(x, y));
    }
}

#[test]
fn small_textures_are_put_together_where_they_were_cut() {
    let (painted, _) = paint_facade(&draft(), &picture()).expect("it can be cut");
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
    let (painted, pictures) = paint_facade(&long, &picture()).expect("it can be cut");
    assert_eq!((painted.sections, pictures.len()), (3, 3));
    assert_eq!(put_together(&painted).map(|sections| sections.len()), Some(3));
    let endless = FacadeDraft { size_m: DVec2::new(199.0, 10.0), objects: vec![], ..draft() };
    assert!(paint_facade(&endless, &picture()).is_ok());
    let bare = FacadeDraft {
        objects: vec![FacadeObject { low: DVec2::ZERO, size: DVec2::new(8.0, 10.0), repeat: ObjectRepeat::default(), ..draft().objects[0] }],
        ..draft()
    };
    assert_eq!(paint_facade(&bare, &picture()), Err(CutError::Covered));
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
    let noisy = |i: usize| Rgb((i * 7919 % 251) as u8, (i / 512 % 256) as u8, (i % 97) as u8);
    encode_picture(&Pixels { width: 512, texels: (0..512 * 512).map(noisy).collect() }, 60_000).expect("it fits")
}

/// A hundred files that lie: about their size, their kind, or where they end.
fn bombs() -> Vec<(String, Vec<u8>)> {
    let good = stored();
    let frame = good.windows(2).position(|pair| pair == [0xFF, 0xC0]).expect("a frame");
    let with = |at: usize, bytes: &[u8]| {
        let mut bad = good.clone();
        bad[at..at + bytes.len()].copy_from_slice(bytes);
        bad
    };
    let mut bombs: Vec<(String, Vec<u8>)> = Vec::new();
    // Sizes that would take gigabytes, or nothing, or a little more than is there.
    for side in [0_u16, 1, 8, 511, 513, 520, 1024, 4096, 30_000, 65_535] {
        let [high, low] = side.to_be_bytes();
        bombs.push((format!("{side} high"), with(frame + 5, &[high, low])));
        bombs.push((format!("{side} wide"), with(frame + 7, &[high, low])));
        bombs.push((format!("{side} squared"), with(frame + 5, &[high, low, high, low])));
    }
    // Other kinds of frame: extended, progressive, lossless, arithmetic, hierarchical.
    for kind in [0xC1, 0xC2, 0xC3, 0xC5, 0xC6, 0xC7, 0xC8, 0xC9, 0xCA, 0xCB, 0xCC, 0xCD, 0xCE, 0xCF, 0xDC, 0xD0, 0xD8, 0x01] {
        bombs.push((format!("frame {kind:X}"), with(frame + 1, &[kind])));
    }
    for components in [0_u8, 1, 2, 4, 200, 255] {
        bombs.push((format!("{components} components"), with(frame + 9, &[components])));
    }
    bombs.push(("12 bits".to_owned(), with(frame + 4, &[12])));
    for sampling in [0x00_u8, 0x01, 0xFF, 0x88] {
        bombs.push((format!("sampling {sampling:X}"), with(frame + 11, &[sampling])));
    }
    // Segments that reach beyond the end, or into themselves.
    for length in [0_u8, 1, 255] {
        bombs.push((format!("a segment of {length}…"), with(frame + 2, &[length, if length == 255 { 255 } else { 0 }])));
    }
    // Cut off.
    for part in 0..20 {
        bombs.push((format!("{part} twentieths"), good[..good.len() * part / 20].to_vec()));
    }
    // Twice the frame, no scan, other files, longer than any picture.
    let twice = [&good[..frame], &good[frame..frame + 19], &good[frame..]].concat();
    bombs.push(("two frames".to_owned(), twice));
    bombs.push(("PNG".to_owned(), b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\x7f\xff\xff\xff\x7f\xff\xff\xff\x08\x02\0\0\0".to_vec()));
    bombs.push(("GIF".to_owned(), b"GIF89a\xff\xff\xff\xff\0\0\0".to_vec()));
    bombs.push(("zeros".to_owned(), vec![0; 60_000]));
    bombs.push(("comments".to_owned(), [&good[..2], &[0xFF, 0xFE, 0, 2].repeat(16_000)].concat()));
    let long = [&good[..2], &[&[0xFF, 0xFE, 0xFF, 0xFF][..], &[0; 65_533]].concat(), &good[2..]].concat();
    bombs.push(("a long comment".to_owned(), long));
    for n in 0..100_usize.saturating_sub(bombs.len()) {
        // Bytes that follow nothing.
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
