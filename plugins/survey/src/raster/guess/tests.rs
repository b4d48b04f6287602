use super::*;
use crate::raster::PictureLimits;
use crate::raster::quantise::oklab;
use crate::testing::data;
use MapClass::{Built, House, Label, Park, Railway, Street, Water};
use veduta_city::draw::Draw;

const SIDE: usize = 400;
const PAPER: [u8; 3] = [255, 254, 248];
const MAIN: [u8; 3] = [252, 221, 128];
const HOUSES: [u8; 3] = [226, 211, 190];
const GREEN: [u8; 3] = [181, 213, 158];
const BLUE: [u8; 3] = [157, 198, 226];
const RAILS: [u8; 3] = [112, 78, 140];
const INK: [u8; 3] = [38, 34, 36];

/// What lies at a place of a town of square blocks 40 wide, with a main street, a park, a river, a railway and lettering.
fn town(x: usize, y: usize) -> [u8; 3] {
    let (block, within) = ((x / 40, y / 40), (x % 40, y % 40));
    let is_street = within.0 < 8 || within.1 < 8;
    let is_letter = is_street && block.1 % 3 == 1 && within.1 == 4 && x % 7 < 3;
    match () {
        () if is_letter => INK,
        () if block.0 == 4 && within.0 < 12 => MAIN,
        () if (140..145).contains(&(x / 3 + y / 2)) => RAILS,
        () if is_street => PAPER,
        () if block.1 == 7 && within.1 > 10 => BLUE,
        () if block == (2, 3) || block == (7, 8) || block == (6, 2) => GREEN,
        () => HOUSES,
    }
}

fn drawn(at: impl Fn(usize, usize) -> [u8; 3]) -> Picture {
    let pixels = (0..SIDE * SIDE).flat_map(|i| at(i % SIDE, i / SIDE)).collect();
    Picture { width: SIDE, height: SIDE, pixels }
}

/// On yellowed paper, with grain.
fn scanned(at: impl Fn(usize, usize) -> [u8; 3]) -> Picture {
    let mut picture = drawn(at);
    let draw = Draw::new(7, veduta_city::Id(1), "grain");
    for (i, pixel) in picture.pixels.chunks_exact_mut(3).enumerate() {
        let draw = draw.part(i as u64);
        let grain = draw.between("grey", -8.0, 8.0);
        for (channel, paper) in pixel.iter_mut().zip([246.0, 238.0, 216.0]) {
            let printed = 30.0 + f64::from(*channel) * (paper - 30.0) / 255.0;
            *channel = (printed
                + grain
                + draw.between(
                    if paper > 240.0 {
                        "red"
                    } else if paper > 220.0 {
                        "green"
                    } else {
                        "blue"
                    },
                    -4.0,
                    4.0,
                ))
            .clamp(0.0, 255.0) as u8;
        }
    }
    picture
}

/// The class of the colour of a legend that is nearest to one on the map.
fn class_of(legend: &Legend, colour: [u8; 3]) -> MapClass {
    let apart = |c: &LegendColour| apart(oklab(c.colour), oklab(colour));
    let nearest = legend.colours.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)));
    nearest.unwrap_or_else(|| panic!("an empty legend")).class
}

#[test]
fn light_streets_between_coloured_blocks() {
    let (legend, findings) = guess_legend(&drawn(town), None);
    let found = [PAPER, HOUSES, GREEN, BLUE, RAILS, INK].map(|c| class_of(&legend, c));
    assert_eq!(found, [Street(None), Built, Park, Water, Railway, Label], "{legend:?}");
    assert_eq!(class_of(&legend, MAIN), Street(Some(StreetClass::Main)), "{legend:?}");
    let says = |what: &str| findings.iter().any(|f| f.message.contains(what));
    assert!(says("#FCDD80 is taken for main streets") && says("taken for railways"), "{findings:?}");
    let text = legend.to_ron_with(&findings);
    assert!(text.contains("the scale is not known"), "{text}");
    assert_eq!(Legend::parse(&text, "guessed").unwrap_or_else(|e| panic!("{e}")), legend, "{text}");
}

#[test]
fn the_same_on_yellowed_paper_with_grain() {
    let print =
        |c: [u8; 3]| [(c[0], 246.0), (c[1], 238.0), (c[2], 216.0)].map(|(c, p)| (30.0 + f64::from(c) * (p - 30.0) / 255.0) as u8);
    let (legend, _) = guess_legend(&scanned(town), None);
    let found = [PAPER, HOUSES, GREEN, BLUE, RAILS].map(|c| class_of(&legend, print(c)));
    assert_eq!(found, [Street(None), Built, Park, Water, Railway], "{legend:?}");
}

#[test]
fn light_streets_between_dark_blocks_and_dark_streets_on_white() {
    let streets = |x: usize, y: usize| town(x, y) == PAPER;
    for (street, block) in [([244, 239, 226], [54, 50, 48]), ([0; 3], [255; 3]), ([90, 90, 90], [240, 240, 235])] {
        let picture = drawn(|x, y| if streets(x, y) { street } else { block });
        let (legend, _) = guess_legend(&picture, None);
        let found = [street, block].map(|c| class_of(&legend, c));
        assert_eq!((found, legend.is_outlined), ([Street(None), Built], false), "{street:?} {block:?}: {:?}", legend);
    }
}

#[test]
fn houses_upon_the_ground_of_blocks() {
    // Four houses in each block, 6 from the streets and from one another; blocks of the same two colours, one each, are none.
    let houses = |x: usize, y: usize| [x % 40, y % 40].iter().all(|c| (12..22).contains(c) || (27..36).contains(c));
    let tones = |x: usize, y: usize| (x / 40 + y / 40).is_multiple_of(3);
    let of = |is_dark: &dyn Fn(usize, usize) -> bool| {
        let street = |x: usize, y: usize| x % 40 < 8 || y % 40 < 8;
        let picture = drawn(|x, y| match () {
            () if street(x, y) => PAPER,
            () if is_dark(x, y) => [150, 60, 40],
            () => HOUSES,
        });
        let (legend, findings) = guess_legend(&picture, None);
        let found = [PAPER, HOUSES, [150, 60, 40]].map(|c| class_of(&legend, c));
        (found, findings.iter().any(|f| f.message.contains("single houses")))
    };
    assert_eq!(of(&houses), ([Street(None), Built, House], true));
    assert_eq!(of(&tones), ([Street(None), Built, Built], false));
}

#[test]
fn outlined_blocks_are_a_finding() {
    let ink = |x: usize, y: usize| {
        let edge = |n: usize| n % 40 == 8 || n % 40 == 39;
        let inside = |n: usize| n % 40 >= 8;
        edge(x) && inside(y) || edge(y) && inside(x)
    };
    let (legend, findings) = guess_legend(&drawn(|x, y| if ink(x, y) { [40, 38, 30] } else { [228, 220, 190] }), None);
    assert!(legend.is_outlined && findings.iter().any(|f| f.message.contains("both bare paper")), "{legend:?} {findings:?}");
    assert_eq!(class_of(&legend, [228, 220, 190]), Street(None), "{:?}", legend);
}

#[test]
fn as_many_colours_as_asked_for() {
    let picture = drawn(town);
    for asked in [1, 2, 4, 6] {
        let (legend, findings) = guess_legend(&picture, Some(asked));
        assert!(legend.colours.len() <= asked, "{asked}: {legend:?}");
        assert!(!findings.iter().any(|f| f.message.contains("asked for")), "{findings:?}");
    }
    let (legend, findings) = guess_legend(&picture, Some(20));
    assert!(legend.colours.len() < 20 && findings.iter().any(|f| f.message.contains("20 colours were asked for")), "{findings:?}");
}

#[test]
fn a_picture_of_nothing_gives_a_legend_all_the_same() {
    for (width, height) in [(0, 0), (1, 1), (5, 1), (1, 7)] {
        let picture = Picture { width, height, pixels: vec![200; 3 * width * height] };
        let (legend, _) = guess_legend(&picture, None);
        assert_eq!(legend.colours.is_empty(), width == 0, "{width} × {height}: {:?}", legend);
    }
}

/// Real maps, looked at: a colour, and what it stands for.
const REAL: &[(&str, bool, &[([u8; 3], MapClass)])] = &[
    (
        "raster_figure_ground/port_au_prince_figure_ground.png",
        false,
        &[([255; 3], Street(None)), ([51; 3], Built), ([255, 165, 0], House)],
    ),
    (
        "raster_figure_ground/portland_figure_ground.png",
        false,
        &[([255; 3], Street(None)), ([51; 3], Built), ([255, 165, 0], Built)],
    ),
    ("raster_heidelberg_derived/heidelberg_altstadt_streets.png", false, &[([0; 3], Street(None)), ([255; 3], Built)]),
    ("raster_prague_new_town_derived/prague_new_town_streets.png", false, &[([0; 3], Street(None)), ([255; 3], Built)]),
    ("raster_san_francisco_toner/sf_mission_toner_z15.png", false, &[([0; 3], Street(None)), ([255; 3], Built)]),
    (
        "raster_prettymaps/palmanova.png",
        false,
        &[
            ([49, 57, 57], Street(None)),
            ([232, 234, 199], Built),
            ([254, 199, 87], Built),
            ([194, 41, 61], Built),
            ([232, 114, 76], Built),
            ([129, 204, 129], Park),
            ([198, 230, 182], Park),
            ([161, 226, 254], Water),
        ],
    ),
    ("raster_paris_1925/paris_1925_invalides.jpg", true, &[([227, 219, 188], Street(None)), ([60, 56, 40], Label)]),
    ("raster_paris_1925/paris_1925_saint_germain.jpg", true, &[([230, 221, 190], Street(None)), ([190, 80, 60], Label)]),
    ("raster_paris_1836/jacoubet_1836_champs_elysees.jpg", true, &[([203, 180, 149], Street(None)), ([20, 6, 2], Label)]),
];

#[test]
fn real_maps_are_read_as_a_person_would() {
    let Some(data) = data() else { return };
    for (name, is_outlined, colours) in REAL {
        let Ok(bytes) = std::fs::read(data.join(name)) else {
            println!("skipped: no {name}");
            continue;
        };
        let picture = Picture::decode(&bytes, name, &PictureLimits::default()).unwrap_or_else(|e| panic!("{e}"));
        let (legend, _) = guess_legend(&picture, None);
        assert_eq!(legend.is_outlined, *is_outlined, "{name}: {:?}", legend);
        for (colour, class) in *colours {
            assert_eq!(class_of(&legend, *colour), *class, "{name}: {colour:?} {:?}", legend);
        }
    }
}
