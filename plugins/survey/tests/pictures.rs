//! Pictures that are whole come out pixel by pixel; pictures that are not are refused, each in a process of its own whose
//! memory is looked at.

mod made;

use std::path::PathBuf;
use std::process::Command;
use std::time::Instant;

use made::corpus::{Bad, corpus, good_webp, shades};
use made::*;
use veduta_survey::raster::{Picture, PictureError, PictureLimits};

const MIB: u64 = 1 << 20;
/// What a picture whose header lies may take, with the process around it.
const LIE_MIB: u64 = 64;

fn decoded(bytes: &[u8]) -> Picture {
    Picture::decode(bytes, "made", &PictureLimits::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn grey(pixels: &[u8]) -> Vec<u8> {
    pixels.iter().flat_map(|&p| [p; 3]).collect()
}

/// Most memory that this process has had, bytes; `None` where the system does not say.
fn most_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? * 1024)
}

/// Not a test of its own: what [`child`] runs.
#[test]
#[ignore = "runs in a process of its own"]
fn decode_one() {
    let Some(path) = std::env::var_os("VEDUTA_PICTURE") else { return };
    let bytes = std::fs::read(path).expect("written by the test");
    let began = Instant::now();
    let decoded = Picture::decode(&bytes, "x", &PictureLimits::default());
    let micros = began.elapsed().as_micros();
    let said = decoded.as_ref().map_or_else(ToString::to_string, |p| format!("decoded {} × {}", p.width, p.height));
    println!("RESULT {} {micros} {} {said}", u8::from(decoded.is_ok()), most_memory().unwrap_or(0));
}

struct Outcome {
    is_ok: bool,
    micros: u64,
    memory: u64,
    said: String,
}

/// Decodes a picture in a process of its own.
fn child(name: &str, bytes: &[u8]) -> Outcome {
    let letters: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let path: PathBuf = std::env::temp_dir().join(format!("veduta-pictures-{}-{letters}", std::process::id()));
    std::fs::write(&path, bytes).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let program = std::env::current_exe().expect("this test");
    let run = Command::new(program)
        .args(["--ignored", "--exact", "decode_one", "--nocapture", "--test-threads=1"])
        .env("VEDUTA_PICTURE", &path)
        .output()
        .expect("this test again");
    std::fs::remove_file(&path).expect("ours");
    let text = String::from_utf8_lossy(&run.stdout);
    let line = text.lines().find_map(|l| l.find("RESULT ").map(|at| &l[at + 7..]));
    let line = line.unwrap_or_else(|| panic!("{name}: it ended badly:\n{text}\n{}", String::from_utf8_lossy(&run.stderr)));
    let mut words = line.splitn(4, ' ');
    let mut next = || words.next().unwrap_or_default();
    let number = |word: &str| word.parse().unwrap_or_else(|_| panic!("{name}: {line}"));
    Outcome { is_ok: next() == "1", micros: number(next()), memory: number(next()), said: next().to_owned() }
}

#[test]
fn every_bad_picture_is_refused_within_its_memory() {
    let corpus = corpus();
    assert!(corpus.len() >= 100, "{} pictures", corpus.len());
    let measures = most_memory().is_some();
    if !measures {
        println!("left out: this system does not tell a process's memory");
    }
    let (mut slowest, mut largest, mut lies) = ((0, ""), (0, ""), 0);
    let mut faults = Vec::new();
    for Bad { name, bytes, is_lie } in &corpus {
        let Outcome { is_ok, micros, memory, said } = child(name, bytes);
        println!("{name} ({micros} µs, {} MiB): {said}", memory / MIB);
        let most = if *is_lie { LIE_MIB * MIB } else { PictureLimits::default().bytes };
        let is_named = said.starts_with("x ") || said.starts_with("x, ");
        if is_ok || !is_named {
            faults.push(format!("{name} was taken, or refused without its name: {said}"));
        }
        if measures && memory > most + bytes.len() as u64 {
            faults.push(format!("{name} took {} MiB", memory / MIB));
        }
        // Ten milliseconds are meant; a busy machine may take more, a decoder that ran would take hundreds.
        if *is_lie && micros > 100_000 {
            faults.push(format!("{name} took {micros} µs"));
        }
        if *is_lie {
            lies += 1;
            slowest = slowest.max((micros, name));
        }
        largest = largest.max((memory, name));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    println!("{} pictures, {lies} with headers that lie or are over the cap", corpus.len());
    println!("slowest of those: {} µs ({}); most memory of all: {} MiB ({})", slowest.0, slowest.1, largest.0 / MIB, largest.1);
}

#[test]
fn bombs_beside_the_pixels_are_not_unpacked() {
    let pixels = shades(64 * 48);
    let data = chunk(b"IDAT", &zlib(&unfiltered(&pixels, 64)));
    let bomb = zlib_zeros(1 << 30);
    let text = chunk(b"zTXt", &[&b"Comment\0\0"[..], &bomb].concat());
    let more_text = chunk(b"iTXt", &[&b"Comment\0\x01\0\0\0"[..], &bomb].concat());
    let profile = chunk(b"iCCP", &[&b"sRGB\0\0"[..], &bomb].concat());
    let after = chunk(b"IDAT", &zlib(&[&unfiltered(&pixels, 64)[..], &vec![0; 1 << 20]].concat()));
    let head = || ihdr(64, 48, 8, 0, 0);
    for (name, chunks) in [
        ("zTXt", [head(), text.clone(), data.clone()]),
        ("iTXt", [head(), more_text, data.clone()]),
        ("iCCP", [head(), profile, data.clone()]),
        ("zTXt after", [head(), data.clone(), text]),
        ("rows after the last", [head(), after, chunk(b"tIME", &[7, 234, 1, 1, 0, 0, 0])]),
    ] {
        let outcome = child(name, &png(&chunks));
        assert!(outcome.is_ok, "{name}: {}", outcome.said);
        assert!(outcome.memory < LIE_MIB * MIB, "{name}: {} MiB", outcome.memory / MIB);
    }
}

#[test]
fn the_cap_holds_for_what_is_decoded() {
    // Zeros of 8,000²: a small file that is what it says.
    let file = png(&[ihdr(8000, 8000, 8, 0, 0), chunk(b"IDAT", &zlib_zeros(8001 * 8000))]);
    let outcome = child("zeros of 8,000 squared", &file);
    assert!(outcome.is_ok, "{}", outcome.said);
    assert!(outcome.memory < 3 * 8000 * 8000 + 48 * MIB, "{} MiB", outcome.memory / MIB);
    let tight = PictureLimits { bytes: 3 * 8000 * 8000, ..PictureLimits::default() };
    let refused = Picture::decode(&file, "x", &tight);
    assert!(matches!(refused, Err(PictureError::TooMuchMemory { limit, .. }) if limit == tight.bytes), "{refused:?}");
    let narrow = PictureLimits { side_px: 7999, ..PictureLimits::default() };
    assert!(matches!(Picture::decode(&file, "x", &narrow), Err(PictureError::TooLarge { width: 8000, .. })));
}

#[test]
fn png_of_every_kind() {
    let data = shades(12 * 9 * 8);
    let of = |bits: u8, colours: u8, row_bytes: usize, extra: Vec<Vec<u8>>| {
        let rows = chunk(b"IDAT", &zlib(&unfiltered(&data[..9 * row_bytes], row_bytes)));
        decoded(&png(&[vec![ihdr(12, 9, bits, colours, 0)], extra, vec![rows]].concat())).pixels
    };
    assert_eq!(of(8, 0, 12, vec![]), grey(&data[..108]));
    assert_eq!(of(8, 2, 36, vec![]), data[..324]);
    let high: Vec<u8> = data[..648].chunks(2).map(|b| b[0]).collect();
    assert_eq!(of(16, 2, 72, vec![]), high);
    let bits: Vec<u8> =
        (0..9).flat_map(|y| (0..12).map(move |x| (y, x))).map(|(y, x)| 255 * (data[2 * y + x / 8] >> (7 - x % 8) & 1)).collect();
    assert_eq!(of(1, 0, 2, vec![]), grey(&bits));
    let palette: Vec<u8> = shades(768).into_iter().rev().collect();
    let by_palette: Vec<u8> = data[..108].iter().flat_map(|&i| palette[3 * usize::from(i)..][..3].to_vec()).collect();
    assert_eq!(of(8, 3, 12, vec![chunk(b"PLTE", &palette)]), by_palette);
    let over = |p: &[u8]| [0, 1, 2].map(|i| 255.0 - (255.0 - f64::from(p[i])) * f64::from(p[3]) / 255.0);
    let blended: Vec<u8> = data[..432].chunks(4).flat_map(over).map(|v| v.round() as u8).collect();
    let near = |a: &[u8], b: &[u8]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.abs_diff(*b) <= 1);
    assert!(near(&of(8, 6, 48, vec![]), &blended), "transparent pixels lie over white");
    // A transparent entry of a palette shows paper.
    let clear = of(8, 3, 12, vec![chunk(b"PLTE", &palette), chunk(b"tRNS", &[0; 256])]);
    assert!(clear.iter().all(|&v| v == 255));
}

#[test]
fn interlaced_png_is_as_the_plain_one() {
    for (width, height) in [(1, 1), (3, 2), (12, 9), (17, 33)] {
        let pixels = shades(3 * width * height);
        let mut passes = Vec::new();
        for [x0, y0, dx, dy] in [[0, 0, 8, 8], [4, 0, 8, 8], [0, 4, 4, 8], [2, 0, 4, 4], [0, 2, 2, 4], [1, 0, 2, 2], [0, 1, 1, 2]] {
            for y in (y0..height).step_by(dy).filter(|_| x0 < width) {
                passes.push(0);
                (x0..width).step_by(dx).for_each(|x| passes.extend(&pixels[3 * (y * width + x)..][..3]));
            }
        }
        let file = png(&[ihdr(width as u32, height as u32, 8, 2, 1), chunk(b"IDAT", &zlib(&passes))]);
        assert_eq!(decoded(&file).pixels, pixels, "{width} × {height}");
    }
}

#[test]
fn jpeg_blocks_come_out_in_their_shade() {
    let shade = |x: u16, y: u16| i32::from((x * 31 + y * 17) % 200) - 100;
    let picture = decoded(&grey_jpeg(45, 30, &shade));
    assert_eq!((picture.width, picture.height), (45, 30));
    for (x, y) in [(0, 0), (44, 29), (20, 11), (7, 8)] {
        let expected = (128 + shade(x as u16 / 8, y as u16 / 8)) as u8;
        let found = picture.at(x, y).expect("inside");
        assert!(found.iter().all(|c| c.abs_diff(expected) <= 1), "({x}, {y}): {found:?}, not {expected}");
    }
}

#[test]
fn tiff_of_every_kind() {
    let data = shades(20 * 14 * 8);
    let (long, short) = (|n: u32| Some(Value::Long(vec![n])), |n: u16| Some(Value::Short(vec![n])));
    let of = |strips: &[u8], changes: &[(u16, Option<Value>)]| {
        let size = [(279, long(strips.len() as u32))];
        decoded(&tiff(strips, &with(with(grey_tags(20, 14), &size), changes))).pixels
    };
    assert_eq!(of(&data[..280], &[]), grey(&data[..280]));
    assert_eq!(of(&zlib(&data[..280]), &[(259, short(8))]), grey(&data[..280]));
    let inverse: Vec<u8> = data[..280].iter().map(|v| 255 - v).collect();
    assert_eq!(of(&data[..280], &[(262, short(0))]), grey(&inverse), "white is zero");
    let rgb = [(262, short(2)), (277, short(3)), (258, Some(Value::Short(vec![8; 3])))];
    assert_eq!(of(&data[..840], &rgb), data[..840]);
    let deep = [(262, short(2)), (277, short(3)), (258, Some(Value::Short(vec![16; 3])))];
    assert_eq!(of(&data[..1680], &deep), data[..1680].chunks(2).map(|b| b[1]).collect::<Vec<u8>>());
    // Strips of five rows, the last of four.
    let strips =
        [(278, long(5)), (273, Some(Value::Long(vec![8, 8 + 300, 8 + 600]))), (279, Some(Value::Long(vec![300, 300, 240])))];
    assert_eq!(of(&data[..840], &[&rgb[..], &strips].concat()), data[..840]);
    // Planes: all reds, all greens, all blues.
    let planes: Vec<u8> = (0..3).flat_map(|c| data[..840].chunks(3).map(move |p| p[c])).collect();
    let apart = [(284, short(2)), (273, Some(Value::Long(vec![8, 288, 568]))), (279, Some(Value::Long(vec![280; 3])))];
    assert_eq!(of(&planes, &[&rgb[..], &apart].concat()), data[..840]);
    // Bits, each row to a whole byte.
    let bit = |y: usize, x: usize| 255 * (data[3 * y + x / 8] >> (7 - x % 8) & 1);
    let bits: Vec<u8> = (0..14).flat_map(|y| (0..20).map(move |x| bit(y, x))).collect();
    assert_eq!(of(&data[..42], &[(258, short(1))]), grey(&bits));
    // A palette of 16 bits: all reds, greens, blues.
    let map: Vec<u16> = (0..768u16).map(|i| i * 85).collect();
    let colour = |i: u8| [0, 256, 512].map(|c| (map[usize::from(i) + c] >> 8) as u8);
    let by_palette: Vec<u8> = data[..280].iter().flat_map(|&i| colour(i)).collect();
    assert_eq!(of(&data[..280], &[(262, short(3)), (320, Some(Value::Short(map.clone())))]), by_palette);
    // Alpha that is multiplied in already: no paint at all is paper.
    let alpha = [(262, short(2)), (277, short(4)), (258, Some(Value::Short(vec![8; 4]))), (338, short(1))];
    assert!(of(&[0; 1120], &alpha).iter().all(|&v| v == 255));
}

#[test]
fn tiles_of_tiff_are_put_in_place() {
    let (width, height) = (40, 25);
    let pixels = shades(3 * width * height);
    let mut tiles = Vec::new();
    for (top, left) in (0..2).flat_map(|r| (0..3).map(move |c| (16 * r, 16 * c))) {
        for (y, x) in (top..top + 16).flat_map(|y| (left..left + 16).map(move |x| (y, x))) {
            let inside = x < width && y < height;
            tiles.extend(if inside { &pixels[3 * (y * width + x)..][..3] } else { &[7, 7, 7] });
        }
    }
    let long = |n: Vec<u32>| Some(Value::Long(n));
    let tags = with(
        grey_tags(width as u32, height as u32),
        &[
            (273, None),
            (278, None),
            (279, None),
            (262, Some(Value::Short(vec![2]))),
            (277, Some(Value::Short(vec![3]))),
            (258, Some(Value::Short(vec![8; 3]))),
            (322, long(vec![16])),
            (323, long(vec![16])),
            (324, long((0..6).map(|i| 8 + i * 768).collect())),
            (325, long(vec![768; 6])),
        ],
    );
    assert_eq!(decoded(&tiff(&tiles, &tags)).pixels, pixels);
}

#[test]
fn jpeg_in_tiff_is_read_with_shared_tables() {
    let shade = |x: u16, y: u16| i32::from((x * 31 + y * 17) % 200) - 100;
    let file = grey_jpeg(64, 48, &shade);
    let long = |n: u32| Some(Value::Long(vec![n]));
    let whole = with(grey_tags(64, 48), &[(259, Some(Value::Short(vec![7]))), (279, long(file.len() as u32))]);
    let plain = decoded(&file).pixels;
    assert_eq!(decoded(&tiff(&file, &whole)).pixels, plain);
    // Tables apart: everything before the frame, and the Huffman tables after it.
    let at = |marker: u8| file.windows(2).position(|w| w == [0xff, marker]).expect("there");
    let (frame, huffman, scan) = (at(0xc0), at(0xc4), at(0xda));
    let tables = [&file[..frame], &file[huffman..scan], &[0xff, 0xd9]].concat();
    let strip = [&[0xff, 0xd8], &file[frame..huffman], &file[scan..]].concat();
    let shared = with(whole, &[(347, Some(Value::Bytes(tables))), (279, long(strip.len() as u32))]);
    assert_eq!(decoded(&tiff(&strip, &shared)).pixels, plain);
}

#[test]
fn webp_with_and_without_alpha() {
    let picture = decoded(&good_webp(33, 21));
    assert_eq!(picture.pixels, shades(3 * 33 * 21));
    let mut file = Vec::new();
    let pixels: Vec<u8> = shades(33 * 21).iter().flat_map(|&s| [s, 0, 255, if s < 128 { 0 } else { 255 }]).collect();
    image_webp::WebPEncoder::new(&mut file).encode(&pixels, 33, 21, image_webp::ColorType::Rgba8).expect("to memory");
    let expected: Vec<u8> = pixels.chunks(4).flat_map(|p| if p[3] == 0 { [255; 3] } else { [p[0], p[1], p[2]] }).collect();
    assert_eq!(decoded(&file).pixels, expected);
}

#[test]
fn errors_say_what_to_do() {
    let says = |bytes: &[u8]| Picture::decode(bytes, "old.png", &PictureLimits::default()).expect_err("refused").to_string();
    assert_eq!(says(b"hello"), "old.png is neither PNG, JPEG, TIFF nor WebP: save the map as PNG");
    assert!(
        says(b"GIF89a").contains("old.png uses GIF, which is not read here: open it in a paint program"),
        "{}",
        says(b"GIF89a")
    );
    let cut = says(&grey_png(64, 48, &shades(64 * 48))[..500]);
    assert!(cut.starts_with("old.png is cut off") && cut.ends_with("download or copy it again"), "{cut}");
    let lie = says(&png(&[ihdr(16_000, 16_000, 8, 2, 0), chunk(b"IDAT", &zlib(&[0; 99]))]));
    assert!(lie.contains("16000 × 16000 pixels cannot come out of"), "{lie}");
}

#[test]
fn colours_one_after_another_are_refused_and_not_lost() {
    let stored = |tables_of_its_own: bool| {
        let mut stored = Vec::new();
        let mut encoder = jpeg_encoder::Encoder::new(&mut stored, 90);
        // So this encoder parts the colours into scans.
        encoder.set_optimized_huffman_tables(tables_of_its_own);
        encoder.encode(&[200, 40, 30].repeat(32 * 32), 32, 32, jpeg_encoder::ColorType::Rgb).expect("a picture");
        stored
    };
    let [r, g, b] = decoded(&stored(false)).at(9, 9).expect("a pixel");
    assert!(r > 180 && g < 60 && b < 60, "{r} {g} {b}");
    let refused = Picture::decode(&stored(true), "made", &PictureLimits::default()).expect_err("its decoder loses colours");
    assert!(refused.to_string().contains("colours one after another"), "{refused}");
}
