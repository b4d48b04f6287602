//! Façades given as pictures: cut, stored and shown.

use glam::DVec2;
use veduta_city::{FacadeDraft, FacadeObject, FacadeObjectKind, ObjectHead, ObjectRepeat, Rgb};
use veduta_texture::{
    CutError, CutFacade, PICTURE_SIDE, PictureLayer, Pixels, compose, cut_facade, decode_picture, keep_flats, put_together,
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
    assert!((5_000..40_000).contains(&glass), "{glass} texels of glass: one window of both, and what is filled about it");
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
fn windows_lie_on_paintings_and_what_repeats_is_cut_where_nothing_lies_on_it() {
    // Both windows have a surround of a quarter of a metre; the left one's lintel is hidden by a sign that stands once.
    const STONE: Rgb = Rgb(160, 160, 150);
    const SIGN: Rgb = Rgb(20, 90, 30);
    let picture = Pixels {
        texels: (picture().texels.iter().enumerate())
            .map(|(i, &texel)| {
                let (x, y) = (i % 640, 799 - i / 640);
                let is_stone = |left: usize| (left - 20..left + 100).contains(&x) && (300..500).contains(&y);
                match texel {
                    _ if (60..180).contains(&x) && (485..560).contains(&y) => SIGN,
                    WALL if is_stone(80) || is_stone(480) => STONE,
                    _ => texel,
                }
            })
            .collect(),
        ..picture()
    };
    let window = draft().objects[0];
    let painting = FacadeObject { kind: FacadeObjectKind::Painting, ..window };
    let surround = FacadeObject { low: DVec2::new(0.75, 3.75), size: DVec2::new(1.5, 2.5), ..painting };
    let sign =
        FacadeObject { low: DVec2::new(0.75, 6.0625), size: DVec2::new(1.5, 0.9375), repeat: ObjectRepeat::default(), ..painting };
    let draft = FacadeDraft { objects: vec![surround, window, sign], ..draft() };
    assert_eq!(draft.validate(), [], "paintings may be covered");
    let CutFacade { painted, pictures } = cut_facade(&draft, &picture).expect("it can be cut");
    let sections = compose(&painted, &pictures).expect("it can be composed");
    let bare = cut_facade(&FacadeDraft { objects: Vec::new(), ..draft }, &picture).expect("it can be cut");
    let alike = sections[0].texels.iter().zip(&bare.pictures[0].texels).filter(|&(&a, &b)| apart(a, b) < 24).count();
    assert!(alike * 1_000 > PICTURE_SIDE * PICTURE_SIDE * 999, "{alike} texels as in the picture");
    assert!(!pictures[1].texels.iter().any(|&texel| apart(texel, SIGN) < 24), "the sign stays in the wall's picture");
    // What a window lies on is nowhere seen, and as plain as its surround.
    assert!(painted.textures[0].palette.iter().all(|&colour| apart(colour, GLASS) > 24), "{:?}", painted.textures[0].palette);
}

#[test]
fn flat_colours_travel_with_a_picture_that_any_reader_shows() {
    let picture = Pixels { width: 512, texels: (0..512 * 512).map(|i| if i % 512 < 200 { WALL } else { GLASS }).collect() };
    let plain = webp::Encoder::from_rgb(&picture.bytes(), 512, 512).encode(60.0).to_vec();
    let kept = keep_flats(plain.clone(), &picture).expect("it was just made");
    assert!(kept.len() <= plain.len() + 24, "{} of {} bytes", kept.len(), plain.len());
    let exact = |pixels: &Pixels| pixels.texels.iter().zip(&picture.texels).filter(|(a, b)| a == b).count();
    let (before, after) = (exact(&decode_picture(&plain).unwrap()), exact(&decode_picture(&kept).unwrap()));
    assert!(after * 10 > 512 * 512 * 8 && after > 2 * before, "{before} and {after} exact texels");
    let others = webp::Decoder::new(&kept).decode().expect("others pass over what they do not know");
    assert_eq!((others.width(), others.height()), (512, 512));
}

#[test]
fn small_textures_are_put_together_where_they_were_cut() {
    let CutFacade { painted, .. } = cut_facade(&draft(), &picture()).expect("it can be cut");
    let [coarse] = &put_together(&painted).expect("it can be drawn")[..] else { panic!("one section") };
    let (mut right, count, picture) = (0, coarse.width * coarse.height(), picture());
    for i in 0..count {
        let (x, y) = ((i % coarse.width) as f64 + 0.5, (i / coarse.width) as f64 + 0.5);
        let pixel = (y / coarse.height() as f64 * 800.0) as usize * 640 + (x / coarse.width as f64 * 640.0) as usize;
        right += usize::from(coarse.texels[i] == picture.texels[pixel]);
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
