//! Pictures that must be refused.

use super::*;

/// A picture that must be refused, and whether its header lies or is over the cap: then it is to cost nothing.
pub struct Bad {
    pub name: String,
    pub bytes: Vec<u8>,
    pub is_lie: bool,
}

fn bad(name: impl Into<String>, bytes: Vec<u8>) -> Bad {
    Bad { name: name.into(), bytes, is_lie: false }
}

fn lie(name: impl Into<String>, bytes: Vec<u8>) -> Bad {
    Bad { name: name.into(), bytes, is_lie: true }
}

/// Shades without a pattern, so that packed data are long.
pub fn shades(count: usize) -> Vec<u8> {
    let mut state = 1u32;
    let next = |_| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    (0..count).map(next).collect()
}

pub fn good_webp(width: u32, height: u32) -> Vec<u8> {
    let mut file = Vec::new();
    let pixels = shades((3 * width * height) as usize);
    image_webp::WebPEncoder::new(&mut file).encode(&pixels, width, height, image_webp::ColorType::Rgb8).expect("to memory");
    file
}

pub fn corpus() -> Vec<Bad> {
    [strangers(), pngs(), jpegs(), tiffs(), webps(), cuts(), flips()].into_iter().flatten().collect()
}

fn strangers() -> Vec<Bad> {
    let files: [(&str, &[u8]); 12] = [
        ("empty", b""),
        ("one byte", b"\x89"),
        ("text", b"Once upon a time"),
        ("GIF", b"GIF89a\x01\0\x01\0\0\0\0"),
        ("BMP", b"BM\x3a\0\0\0\0\0"),
        ("PDF", b"%PDF-1.7"),
        ("HEIC", b"\0\0\0\x18ftypheic\0\0\0\0"),
        ("JPEG XL", b"\xff\x0a\xfa\x1f"),
        ("JPEG 2000", b"\0\0\0\x0cjP  \r\n\x87\n"),
        ("SVG", b"<svg xmlns='http://www.w3.org/2000/svg'/>"),
        ("Photoshop", b"8BPS\0\x01"),
        ("RIFF of sound", b"RIFF\x04\0\0\0WAVE"),
    ];
    files.map(|(name, bytes)| bad(name, bytes.to_vec())).into()
}

fn pngs() -> Vec<Bad> {
    let data = chunk(b"IDAT", &zlib(&unfiltered(&shades(3 * 64 * 48), 3 * 64)));
    let megabyte: Vec<u8> = unfiltered(&shades(1 << 20), 3 * 16_384);
    let of = |width, height, bits, colours| png(&[ihdr(width, height, bits, colours, 0), data.clone()]);
    let mut wrong_sum = of(64, 48, 8, 2);
    wrong_sum[30] ^= 1;
    let mut long_chunk = of(64, 48, 8, 2);
    long_chunk[33..37].copy_from_slice(&[0xff; 4]);
    let mut text_mode = of(64, 48, 8, 2);
    text_mode.remove(4);
    vec![
        lie("png: 100,000 wide", of(100_000, 48, 8, 2)),
        lie("png: 100,000 high", of(64, 100_000, 8, 2)),
        lie("png: 2³¹-1 both ways", of(i32::MAX as u32, i32::MAX as u32, 16, 6)),
        lie("png: 16,384² of a few rows", of(16_384, 16_384, 8, 2)),
        lie("png: 16,384² of 16 bits and alpha", of(16_384, 16_384, 16, 6)),
        lie("png: 16,384² of one bit", of(16_384, 16_384, 1, 0)),
        lie("png: 16,384² interlaced", png(&[ihdr(16_384, 16_384, 8, 2, 1), data.clone()])),
        lie("png: 16,384² and no data", png(&[ihdr(16_384, 16_384, 8, 2, 0)])),
        lie("png: 16,384² of a megabyte", png(&[ihdr(16_384, 16_384, 8, 2, 0), chunk(b"IDAT", &zlib(&megabyte))])),
        lie("png: 16,384² of a megabyte, interlaced", png(&[ihdr(16_384, 16_384, 8, 2, 1), chunk(b"IDAT", &zlib(&megabyte))])),
        lie("png: zeros of 30,000²", png(&[ihdr(30_000, 30_000, 8, 0, 0), chunk(b"IDAT", &zlib_zeros(900_030_000))])),
        bad("png: no columns", of(0, 48, 8, 2)),
        bad("png: no rows", of(64, 0, 8, 2)),
        bad("png: more rows than data", of(64, 60, 8, 2)),
        bad("png: three bits", of(64, 48, 3, 0)),
        bad("png: colour type 5", of(64, 48, 8, 5)),
        bad("png: interlacing 2", png(&[ihdr(64, 48, 8, 2, 2), data.clone()])),
        bad("png: no palette", of(64, 48, 8, 3)),
        bad("png: palette of half a colour", png(&[ihdr(64, 48, 8, 3, 0), chunk(b"PLTE", &[1, 2, 3, 4]), data.clone()])),
        bad("png: palette of 16 MiB", png(&[ihdr(64, 48, 8, 3, 0), chunk(b"PLTE", &vec![7; 3 << 22]), data.clone()])),
        bad("png: no header", png(core::slice::from_ref(&data))),
        bad("png: no data", png(&[ihdr(64, 48, 8, 2, 0)])),
        bad("png: data that are not packed", png(&[ihdr(64, 48, 8, 2, 0), chunk(b"IDAT", &shades(3000))])),
        bad("png: filter 9", png(&[ihdr(64, 48, 8, 0, 0), chunk(b"IDAT", &zlib(&[9; 65 * 48]))])),
        bad("png: wrong checksum", wrong_sum),
        bad("png: a chunk of 4 GiB", long_chunk),
        bad("png: sent in text mode", text_mode),
    ]
}

fn jpegs() -> Vec<Bad> {
    let data = shades(400).iter().map(|s| s & 0x7f).collect::<Vec<u8>>();
    let of = |kind, bits, width, height, sampling: &[u8]| jpeg(&jpeg_head(kind, bits, width, height, sampling), &data);
    let head = jpeg_head(0xc0, 8, 64, 48, &[0x11]);
    let tail = |head: &[u8]| jpeg(head, &data);
    let mut vast_tables = jpeg_head(0xc0, 8, 64, 48, &[0x11]);
    let at = vast_tables.windows(2).position(|w| w == [0xff, 0xc4]).expect("tables") + 5;
    vast_tables[at..at + 16].fill(255);
    let mut grown = grey_jpeg(2000, 2000, &|x, y| i32::from((x * 7 + y * 13) % 100));
    let at = grown.windows(2).position(|w| w == [0xff, 0xc0]).expect("a frame") + 5;
    grown[at..at + 4].copy_from_slice(&[0x40, 0, 0x40, 0]);
    let mut four_times = grown.clone();
    four_times[at..at + 4].copy_from_slice(&[0x0f, 0xa0, 0x07, 0xd0]);
    vec![
        lie("jpeg: 2,000² that says 16,384²", grown),
        bad("jpeg: 2,000² that says 2,000 × 4,000", four_times),
        lie("jpeg: 65,535² of little", of(0xc0, 8, 65_535, 65_535, &[0x11])),
        lie("jpeg: 16,384² of little", of(0xc0, 8, 16_384, 16_384, &[0x11])),
        lie("jpeg: 16,384² of three components", of(0xc0, 8, 16_384, 16_384, &[0x22, 0x11, 0x11])),
        lie("jpeg: 16,384² progressive", of(0xc2, 8, 16_384, 16_384, &[0x11, 0x11, 0x11])),
        lie("jpeg: 16,384² of four components", of(0xc2, 8, 16_384, 16_384, &[0x44, 0x11, 0x11, 0x44])),
        lie("jpeg: 4,000² of little", of(0xc0, 8, 4000, 4000, &[0x11])),
        bad("jpeg: no columns", of(0xc0, 8, 0, 48, &[0x11])),
        bad("jpeg: no rows", of(0xc0, 8, 64, 0, &[0x11])),
        bad("jpeg: 12 bits", of(0xc1, 12, 64, 48, &[0x11])),
        bad("jpeg: lossless", of(0xc3, 8, 64, 48, &[0x11])),
        bad("jpeg: arithmetic", of(0xc9, 8, 64, 48, &[0x11])),
        bad("jpeg: hierarchical", of(0xc5, 8, 64, 48, &[0x11])),
        bad("jpeg: two components", of(0xc0, 8, 64, 48, &[0x11, 0x11])),
        bad("jpeg: no components", of(0xc0, 8, 64, 48, &[])),
        bad("jpeg: sampled 0 times", of(0xc0, 8, 64, 48, &[0x10, 0x11, 0x11])),
        bad("jpeg: sampled 5 times", of(0xc0, 8, 64, 48, &[0x51, 0x11, 0x11])),
        bad("jpeg: two frames", tail(&[head.clone(), head.clone()].concat())),
        bad("jpeg: no frame", tail(&segment(0xdb, &[[0].as_slice(), &[8; 64]].concat()))),
        bad("jpeg: no scan", [&[0xff, 0xd8], head.as_slice(), &[0xff, 0xd9]].concat()),
        bad("jpeg: only its marks", vec![0xff, 0xd8, 0xff, 0xd9]),
        bad("jpeg: no tables", tail(&segment(0xc0, &[8, 0, 48, 0, 64, 1, 1, 0x11, 0]))),
        bad("jpeg: tables too long", tail(&vast_tables)),
        bad("jpeg: a segment beyond the file", [&[0xff, 0xd8, 0xff, 0xe0, 0xff, 0xff], head.as_slice()].concat()),
        bad("jpeg: a frame header of three bytes", tail(&segment(0xc0, &[8, 0, 48]))),
        bad("jpeg: rubbish between segments", tail(&[shades(40), head.clone()].concat())),
        bad("jpeg: a scan without bits", jpeg(&head, &[])),
    ]
}

fn tiffs() -> Vec<Bad> {
    let pixels = shades(64 * 48);
    let of = |changes: &[(u16, Option<Value>)]| tiff(&pixels, &with(grey_tags(64, 48), changes));
    let long = |n: u32| Some(Value::Long(vec![n]));
    let short = |n: u16| Some(Value::Short(vec![n]));
    let mut lost = of(&[]);
    lost[4..8].copy_from_slice(&u32::MAX.to_le_bytes());
    let big = [&b"II+\0\x08\0\0\0\x10\0\0\0\0\0\0\0"[..], &(1u64 << 60).to_le_bytes(), &[0; 40]].concat();
    let inner = jpeg(&jpeg_head(0xc0, 8, 60_000, 60_000, &[0x11]), &[0; 100]);
    let in_jpeg = with(grey_tags(64, 48), &[(259, short(7)), (279, long(inner.len() as u32))]);
    let vast = |changes: &[(u16, Option<Value>)]| {
        let size = [(256, long(16_384)), (257, long(16_384)), (278, long(16_384))];
        of(&[&size, changes].concat())
    };
    let tiles = |width: u32, height: u32| {
        of(&[(273, None), (278, None), (279, None), (322, long(width)), (323, long(height)), (324, long(8)), (325, long(3072))])
    };
    vec![
        lie("tiff: 2³² wide", of(&[(256, long(u32::MAX))])),
        lie("tiff: 2³² high", of(&[(257, long(u32::MAX))])),
        lie("tiff: 16,384² of little", vast(&[])),
        lie("tiff: 16,384² of little, deflated", vast(&[(259, short(8))])),
        lie("tiff: 16,384² of little, by LZW", vast(&[(259, short(5))])),
        lie("tiff: 16,384² of little, as runs", vast(&[(259, short(32_773))])),
        lie("tiff: a strip of 4 GiB", of(&[(279, long(u32::MAX))])),
        lie("tiff: a strip beyond the file", of(&[(273, long(1 << 30))])),
        lie("tiff: 2³² strips told", of(&[(273, Some(Value::Claimed(u32::MAX, 8)))])),
        lie("tiff: 2³² lengths told", of(&[(279, Some(Value::Claimed(u32::MAX, 8)))])),
        lie("tiff: one row a strip, one strip", vast(&[(278, long(1))])),
        lie("tiff: tiles of 2³⁰", tiles(1 << 30, 1 << 30)),
        lie("tiff: a JPEG of 60,000² for a strip", tiff(&inner, &in_jpeg)),
        lie("tiff: 2⁶⁰ tags", big),
        bad("tiff: tiles of no width", tiles(0, 64)),
        bad("tiff: tiles of 7 pixels", tiles(7, 7)),
        bad("tiff: no columns", of(&[(256, long(0))])),
        bad("tiff: no rows", of(&[(257, long(0))])),
        bad("tiff: no width told", of(&[(256, None)])),
        bad("tiff: no strips told", of(&[(273, None)])),
        bad("tiff: no lengths told", of(&[(279, None)])),
        bad("tiff: a directory beyond the file", lost),
        bad("tiff: no bits", of(&[(258, short(0))])),
        bad("tiff: 64 bits", of(&[(258, short(64))])),
        bad("tiff: no samples", of(&[(277, short(0))])),
        bad("tiff: 65,535 samples", of(&[(277, short(u16::MAX))])),
        bad("tiff: floating-point samples", of(&[(339, short(3)), (258, short(32))])),
        bad("tiff: compression 4711", of(&[(259, short(4711))])),
        bad("tiff: old JPEG", of(&[(259, short(6))])),
        bad("tiff: colours 77", of(&[(262, short(77))])),
        bad("tiff: no palette", of(&[(262, short(3))])),
        bad("tiff: half a palette", of(&[(262, short(3)), (320, Some(Value::Short(vec![9; 100])))])),
        bad("tiff: planes 3", of(&[(284, short(3)), (277, short(3)), (262, short(2)), (258, Some(Value::Short(vec![8; 3])))])),
        bad("tiff: predictor 99", of(&[(317, short(99)), (259, short(8))])),
        bad("tiff: strips of no rows", of(&[(278, long(0))])),
        bad("tiff: data that are not packed", of(&[(259, short(8))])),
    ]
}

fn webps() -> Vec<Bad> {
    let file = good_webp(64, 48);
    let mut long = file.clone();
    long[4..8].copy_from_slice(&(1u32 << 30).to_le_bytes());
    let picture = file[20..].to_vec();
    vec![
        lie("webp: a canvas of 16,777,216²", webp(&[(b"VP8X", vp8x(0, 1 << 24, 1 << 24)), (b"VP8L", picture.clone())])),
        lie("webp: a canvas of 16,384² about 64 × 48", webp(&[(b"VP8X", vp8x(0, 16_384, 16_384)), (b"VP8L", picture.clone())])),
        lie("webp: lossy 16,383² of little", webp(&[(b"VP8 ", vp8(16_383, 16_383, 20, &shades(100)))])),
        lie("webp: lossless 16,383² of little", webp(&[(b"VP8L", vp8l(16_383, 16_383, &shades(100)))])),
        lie("webp: lossless 16,384²", webp(&[(b"VP8L", vp8l(16_384, 16_384, &picture[5..]))])),
        lie("webp: a file of 1 GiB, it says", long),
        lie("webp: a canvas of 16,384² and nothing", webp(&[(b"VP8X", vp8x(0, 16_384, 16_384))])),
        bad("webp: an animation", webp(&[(b"VP8X", vp8x(2, 64, 48)), (b"ANIM", vec![0; 6]), (b"ANMF", vec![0; 24])])),
        bad("webp: a first part longer than all", webp(&[(b"VP8 ", vp8(64, 48, 100_000, &shades(100)))])),
        bad("webp: lossy rubbish", webp(&[(b"VP8 ", vp8(640, 480, 50, &shades(60)))])),
        bad("webp: no columns", webp(&[(b"VP8 ", vp8(0, 48, 50, &shades(60)))])),
        bad("webp: no picture", webp(&[(b"EXIF", vec![0; 8])])),
        bad("webp: nothing in it", webp(&[])),
        bad("webp: lossless of version 7", webp(&[(b"VP8L", vp8l(64, 48, &[]).into_iter().chain([0xff; 40]).collect())])),
    ]
}

/// Files cut off at several places, never within what may be missing.
fn cuts() -> Vec<Bad> {
    let whole = [
        ("png", grey_png(64, 48, &shades(64 * 48))),
        ("jpeg", grey_jpeg(640, 480, &|x, y| i32::from((x * 7 + y * 13) % 100))),
        ("tiff", tiff(&shades(64 * 48), &grey_tags(64, 48))),
        ("webp", good_webp(64, 48)),
    ];
    let cut = |(kind, file): (&str, Vec<u8>)| {
        let at = [0.02, 0.1, 0.3, 0.5, 0.8, 0.95].map(|share| (file.len() as f64 * share) as usize);
        let ends = at.into_iter().chain([file.len() - 9, file.len() - 5]);
        ends.map(|end| bad(format!("{kind}: cut off at {end}"), file[..end].to_vec())).collect::<Vec<Bad>>()
    };
    whole.into_iter().flat_map(cut).collect()
}

/// PNGs with one byte of their data changed: checksums find them all.
fn flips() -> Vec<Bad> {
    let file = grey_png(64, 48, &shades(64 * 48));
    let flipped = |i: usize| {
        let mut bytes = file.clone();
        let at = 41 + i * (bytes.len() - 41 - 16) / 12;
        bytes[at] ^= 0x10;
        bad(format!("png: byte {at} changed"), bytes)
    };
    (0..12).map(flipped).collect()
}
