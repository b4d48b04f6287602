//! Golden pictures of the sample city, drawn by Mesa's software renderer, and films that are the same bytes twice.
//!
//! `VEDUTA_BLESS=1` writes the goldens anew; a picture that differs is written beside its golden as `NAME.png.actual`.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use image::{DynamicImage, GenericImageView, Rgb, RgbImage};
use veduta_game::film::{FilmOrder, film};
use veduta_game::profile::Profile;
use veduta_game::shot::{At, ShotOrder, picture};
use veduta_game::studio::Size;
use veduta_tests::{hillside_city, riverside_city, root, sample_city, scene, workplace};

/// One renderer at a time: two cores share it.
static RENDERER: Mutex<()> = Mutex::new(());

const SIZE: Size = Size { width: 320, height: 180 };
/// Likeness of whole pictures, and of their worst block, that counts as the same: between processors the last bits of colours
/// and single pixels at edges differ.
const LIKE: (f64, f64) = (0.985, 0.93);
/// Blocks that are compared on their own, so that a small defect cannot hide in a large picture.
const BLOCK: (u32, u32) = (32, 36);

/// Likeness of two pictures of a size, 0 to 1: overall, and of the worst block.
fn likeness(a: &RgbImage, b: &RgbImage) -> (f64, f64) {
    let like = |a: &RgbImage, b: &RgbImage| image_compare::rgb_hybrid_compare(a, b).expect("pictures of one size").score;
    let mut worst = f64::INFINITY;
    for y in (0..a.height()).step_by(BLOCK.1 as usize) {
        for x in (0..a.width()).step_by(BLOCK.0 as usize) {
            worst = worst.min(like(&a.view(x, y, BLOCK.0, BLOCK.1).to_image(), &b.view(x, y, BLOCK.0, BLOCK.1).to_image()));
        }
    }
    (like(a, b), worst)
}

fn is_like((overall, worst): (f64, f64)) -> bool {
    overall >= LIKE.0 && worst >= LIKE.1
}

fn golden(name: &str) -> PathBuf {
    root().join("tests/pictures").join(format!("{name}.png"))
}

fn read(path: &Path) -> RgbImage {
    image::open(path).unwrap_or_else(|e| panic!("{}: {e}; VEDUTA_BLESS=1 writes it", path.display())).to_rgb8()
}

#[test]
fn stills_look_as_agreed() {
    let _alone = RENDERER.lock().unwrap_or_else(PoisonError::into_inner);
    let stills = [
        (sample_city(), "street", "300,-25,1.65,265,4", 9.0, 60.0),
        (sample_city(), "square", "40,-10,1.65,300,8", 16.0, 65.0),
        (sample_city(), "skyline", "-30,-44,62,75,-8", 18.0, 60.0),
        (hillside_city(), "hillside", "60,64,1.65,85,2", 11.0, 60.0),
        (riverside_city(), "riverside", "-20,-40,5,25,0", 14.0, 60.0),
    ];
    let mut unlike = Vec::new();
    for (city, name, at, hour, fov_deg) in stills {
        let at: Option<At> = Some(at.parse().expect("five numbers"));
        let city = city.display().to_string();
        let order = ShotOrder {
            city,
            at,
            out: PathBuf::new(),
            size: SIZE,
            hour,
            day: 160,
            wet: 0.0,
            fov_deg,
            profile: Profile::Medium,
            life: None,
        };
        let taken = picture(&order).unwrap_or_else(|e| panic!("{name}: {e}"));
        if !taken.is_software {
            println!("skipped: {} draws here, and the goldens are Mesa's software renderer's", taken.renderer);
            return;
        }
        let (path, now) = (golden(name), DynamicImage::ImageRgba8(taken.image).to_rgb8());
        if std::env::var_os("VEDUTA_BLESS").is_some() {
            now.save(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
            continue;
        }
        let found = likeness(&read(&path), &now);
        println!("{name}: {found:?}");
        if !is_like(found) {
            let actual = path.with_extension("png.actual");
            now.save_with_format(&actual, image::ImageFormat::Png).unwrap_or_else(|e| panic!("{}: {e}", actual.display()));
            unlike.push(format!("{name}: likeness {found:?}, see {}", actual.display()));
        }
    }
    assert!(unlike.is_empty(), "{unlike:#?}");
}

#[test]
fn a_defect_of_one_window_is_seen() {
    let good = read(&golden("street"));
    let mut bad = good.clone();
    for (x, y) in (40..52).flat_map(|x| (60..76).map(move |y| (x, y))) {
        bad.put_pixel(x, y, Rgb([255, 0, 255]));
    }
    assert!(is_like(likeness(&good, &good)));
    assert!(!is_like(likeness(&good, &bad)), "{:?}", likeness(&good, &bad));
    let shifted = image::imageops::crop_imm(&good, 2, 0, good.width() - 2, good.height()).to_image();
    let shifted = image::imageops::resize(&shifted, good.width(), good.height(), image::imageops::FilterType::Triangle);
    assert!(!is_like(likeness(&good, &shifted)), "a camera moved aside: {:?}", likeness(&good, &shifted));
}

#[test]
fn a_film_is_the_same_bytes_twice_and_shows_its_captions() {
    let _alone = RENDERER.lock().unwrap_or_else(PoisonError::into_inner);
    let dir = workplace("film");
    let shoot = |name: &str| {
        let order = FilmOrder {
            tour: scene().join("royal_route.tour.ron"),
            out: dir.join(name),
            size: Size { width: 480, height: 270 },
            fps: 4,
            profile: Profile::Low,
            from_s: 2.0,
            to_s: Some(4.0),
            json: false,
        };
        film(&order).unwrap_or_else(|e| panic!("{e}"));
        let mut frames: Vec<PathBuf> =
            std::fs::read_dir(dir.join(name)).expect("just written").map(|f| f.expect("a file").path()).collect();
        frames.sort();
        frames
    };
    let (first, second) = (shoot("first"), shoot("second"));
    assert_eq!((first.len(), second.len()), (8, 8));
    for (a, b) in first.iter().zip(&second) {
        assert!(std::fs::read(a).expect("a frame") == std::fs::read(b).expect("a frame"), "{} differs", a.display());
    }
    assert_ne!(std::fs::read(&first[0]).expect("a frame"), std::fs::read(&first[7]).expect("a frame"), "nothing moves");
    // The caption's letters are nearly white on a dark ground, low in the middle of the picture.
    let frame = read(&first[7]);
    let low = frame.view(90, 180, 300, 90).to_image();
    let letters = low.pixels().filter(|p| p.0.iter().all(|&c| c > 215)).count();
    let ground = low.pixels().filter(|p| p.0.iter().all(|&c| c < 70)).count();
    assert!(letters > 60 && ground > 600, "{letters} pixels of letters on {ground} of ground");
    let _ = std::fs::remove_dir_all(dir);
}
