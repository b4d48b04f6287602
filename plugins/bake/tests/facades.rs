//! What the painted fronts of the sample city cost, and how near they come to their pictures.

use std::path::{Path, PathBuf};

use glam::DVec2;
use image::{ExtendedColorType, ImageEncoder};
use veduta_bake::{files_of_overrides, read_facade};
use veduta_city::{FacadeDraft, FacadeFile, GraphOverrides, file};
use veduta_survey::raster::{Picture, PictureLimits};
use veduta_texture::{PICTURE_SIDE, PictureLayer, Pixels, compose, cut_facade, decode_picture};

const FOLDER: &str = "../../scenes/old_prague/facades";

fn facades() -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(FOLDER).expect("the folder").map(|entry| entry.expect("an entry").path()).collect();
    files.retain(|path| path.to_string_lossy().ends_with(".facade.ron"));
    files.sort();
    files
}

#[test]
fn painted_fronts_take_few_bytes_and_look_like_their_pictures() {
    let side = PICTURE_SIDE as u32;
    assert!(facades().len() >= 3);
    for path in facades() {
        let facade = read_facade(&path, DVec2::ZERO).unwrap_or_else(|error| panic!("{error}"));
        let draft: FacadeDraft = file::read(&path).expect("read above");
        let bytes = std::fs::read(path.with_file_name(&draft.picture)).expect("read above");
        let Picture { width, height, pixels } = Picture::decode(&bytes, "picture", &PictureLimits::default()).expect("read above");
        assert!(width.max(height) >= 2048, "{} is {width} × {height}", draft.picture);
        // One section: the picture at the size that is shown.
        assert_eq!(facade.painted.sections, 1, "{} has several sections", draft.name);
        let stored: usize = facade.pictures.iter().map(|file| file.0.len()).sum();
        // As the cutter makes it smaller, with nothing cut out.
        let pixels = Pixels::of_rgb(width, &pixels).expect("a picture");
        let bare = cut_facade(&FacadeDraft { objects: Vec::new(), ..draft.clone() }, &pixels).expect("it was cut");
        let given = bare.pictures[0].bytes();
        let decoded: Vec<_> = facade.pictures.iter().map(|file| decode_picture(&file.0).expect("it was just made")).collect();
        let [section] = &compose(&facade.painted, &decoded).expect("it was just made")[..] else { panic!("one section") };
        let shown = section.bytes();
        let mut png = Vec::new();
        let encoder = image::codecs::png::PngEncoder::new_with_quality(
            &mut png,
            image::codecs::png::CompressionType::Best,
            image::codecs::png::FilterType::Adaptive,
        );
        encoder.write_image(&given, side, side, ExtendedColorType::Rgb8).expect("a PNG");
        let flip = |a: &[u8], b: &[u8]| {
            let of = |bytes| nv_flip::FlipImageRgb8::with_data(side, side, bytes);
            nv_flip::FlipPool::from_image(&nv_flip::flip(of(a), of(b), nv_flip::DEFAULT_PIXELS_PER_DEGREE)).mean()
        };
        let difference = flip(&given, &shown);
        let blocks = PictureLayer::new(section).expect("a square").in_blocks();
        println!("{}: {stored} B, {} B as PNG, FLIP {difference:.4}, {} B in blocks", draft.name, png.len(), blocks.len());
        assert!(stored <= 20_000 && stored * 5 <= png.len());
        assert!(difference <= 0.05, "{}: FLIP {difference}", draft.name);
        assert!(blocks.len() * 4 <= PICTURE_SIDE * PICTURE_SIDE * 4);
    }
}

#[test]
fn mistakes_in_facades_are_told_with_their_file() {
    let told = |path: &str, text: &str| {
        let folder = std::env::temp_dir().join(format!("veduta-facade-{}-{path}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let path = folder.join("a.facade.ron");
        std::fs::write(&path, text).expect("a file");
        let error = read_facade(&path, DVec2::ZERO).expect_err("it has a mistake").to_string();
        std::fs::remove_dir_all(&folder).expect("made above");
        error
    };
    let away = told("away", r#"(name: "a", picture: "../a.png", size_m: (9, 9))"#);
    assert!(away.contains("a.facade.ron") && away.contains("leads down"), "{away}");
    let missing = told("missing", r#"(name: "a", picture: "a.png", size_m: (9, 9))"#);
    assert!(missing.contains("a.png"), "{missing}");
    let typo = told("typo", r#"(name: "a", picture: "a.png", size: (9, 9))"#);
    assert!(typo.contains("a.facade.ron:1:"), "{typo}");
}

#[test]
fn a_cache_knows_all_files_that_overrides_name() {
    let file = FacadeFile { file: "minute.facade.ron".to_owned(), at: DVec2::ZERO };
    let gone = FacadeFile { file: "gone.facade.ron".to_owned(), at: DVec2::ZERO };
    let overrides = GraphOverrides { facades: vec![file, gone], ..GraphOverrides::default() };
    let files = files_of_overrides(&overrides, &Path::new(FOLDER).join("x.graph.overrides.ron"));
    let names: Vec<_> = files.iter().map(|path| path.file_name().unwrap_or_default().to_string_lossy()).collect();
    assert_eq!(names, ["minute.facade.ron", "minute.jpg"]);
}
