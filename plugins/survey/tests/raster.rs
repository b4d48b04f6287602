//! Pictures of towns, drawn here, whose streets are known; and the real maps of the shared test data.

use std::path::PathBuf;

use glam::DVec2;
use veduta_city::{Anchor, BlockKind, CityGraph, LinkKind, NodeKind, StreetClass};
use veduta_survey::raster::{Legend, Picture, PictureLimits, RasterSettings, guess_legend, scale_by_streets, survey_raster};
use veduta_survey::{Georeference, KnownPoint};

const SIZE: usize = 640;
const METRES: f64 = 0.5;

const STREET: [u8; 3] = [255, 254, 248];
const BUILT: [u8; 3] = [226, 211, 190];
const PARK: [u8; 3] = [181, 213, 158];
const WATER: [u8; 3] = [157, 198, 226];
const INK: [u8; 3] = [38, 34, 36];

const LEGEND: &str = r#"{ "metres_per_pixel": 0.5, "classes": { "street": [[255, 254, 248]], "built": [[226, 211, 190]],
    "park": [[181, 213, 158]], "water": [[157, 198, 226]], "railroad": [[112, 78, 140]], "label": [[38, 34, 36]] } }"#;

/// Streets of a picture, in pixels with y down: ends and width.
const STREETS: &[([f64; 2], [f64; 2], f64)] = &[
    // Two avenues through the picture, two streets across them, one at a slant.
    ([0.0, 160.0], [640.0, 160.0], 24.0),
    ([0.0, 480.0], [640.0, 480.0], 24.0),
    ([160.0, 0.0], [160.0, 640.0], 16.0),
    ([420.0, 0.0], [420.0, 640.0], 12.0),
    ([160.0, 160.0], [420.0, 480.0], 14.0),
    // A blind alley from the first street.
    ([160.0, 330.0], [70.0, 330.0], 9.0),
];

fn distance(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let t = ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    p.distance(a + along * t)
}

/// A town with a square of 64 × 56 m about (540, 330), a park in the upper right corner and a pond in the lower left one.
fn town() -> Picture {
    let mut pixels = Vec::with_capacity(SIZE * SIZE * 3);
    for y in 0..SIZE {
        for x in 0..SIZE {
            let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            let is_street = STREETS.iter().any(|(a, b, width)| distance(p, DVec2::from(*a), DVec2::from(*b)) < width / 2.0);
            let is_square = (476.0..604.0).contains(&p.x) && (274.0..386.0).contains(&p.y);
            let to_square = (p.y - 330.0).abs() < 5.0 && (420.0..480.0).contains(&p.x);
            let colour = if is_street || is_square || to_square {
                STREET
            } else if p.x > 420.0 && p.y < 160.0 {
                PARK
            } else if p.x < 100.0 && p.y > 560.0 {
                WATER
            } else {
                BUILT
            };
            pixels.extend(colour);
        }
    }
    Picture { width: SIZE, height: SIZE, pixels }
}

/// Ink over a box of a picture, but for every fifth column: letters.
fn write_over(picture: &mut Picture, low: [usize; 2], high: [usize; 2]) {
    for y in low[1]..high[1] {
        for x in (low[0]..high[0]).filter(|x| x % 5 != 0) {
            picture.pixels[(y * SIZE + x) * 3..][..3].copy_from_slice(&INK);
        }
    }
}

fn surveyed(picture: &Picture, threads: usize) -> CityGraph {
    let legend = Legend::parse(LEGEND, "legend.json").unwrap_or_else(|e| panic!("{e}"));
    let settings = RasterSettings { georeference: scale(picture, METRES), threads, keeps_margin: false };
    survey_raster(picture, &legend, &settings, "town.png", &mut |_| ()).unwrap_or_else(|e| panic!("{e}")).graph
}

/// Places of nodes of a kind, in pixels with y down.
fn nodes(graph: &CityGraph, kind: NodeKind) -> Vec<DVec2> {
    let mut degree = std::collections::BTreeMap::new();
    for link in &graph.links {
        *degree.entry(link.from).or_insert(0) += 1;
        *degree.entry(link.to).or_insert(0) += 1;
    }
    let is_kind = |n: usize| match kind {
        NodeKind::BlindAlley => n == 1,
        NodeKind::Crossroads => n > 2,
        _ => false,
    };
    let of_kind = graph.nodes.iter().filter(|node| is_kind(degree.get(&node.id).copied().unwrap_or(0)));
    of_kind.map(|node| DVec2::new(node.pos.x / METRES, SIZE as f64 - node.pos.y / METRES)).collect()
}

/// The width of the link nearest to a place, metres.
fn width_at(graph: &CityGraph, pixel: DVec2) -> f64 {
    let p = DVec2::new(pixel.x, SIZE as f64 - pixel.y) * METRES;
    let at = graph.node_positions();
    let reach = |link: &veduta_city::Link| {
        let line: Vec<DVec2> = core::iter::once(at[&link.from]).chain(link.via.iter().copied()).chain([at[&link.to]]).collect();
        line.windows(2).map(|w| distance(p, w[0], w[1])).fold(f64::MAX, f64::min)
    };
    graph.links.iter().min_by(|a, b| reach(a).total_cmp(&reach(b))).map_or(0.0, |link| link.width_m)
}

#[test]
fn a_town_is_read_as_it_was_drawn() {
    let graph = surveyed(&town(), 1);
    for crossroads in [[160.0, 160.0], [420.0, 160.0], [160.0, 480.0], [420.0, 480.0], [160.0, 330.0], [420.0, 330.0]] {
        let nearest =
            nodes(&graph, NodeKind::Crossroads).iter().map(|p| p.distance(DVec2::from(crossroads))).fold(f64::MAX, f64::min);
        assert!(nearest < 4.0, "crossroads {crossroads:?} is {nearest:.1} pixels off: {:?}", nodes(&graph, NodeKind::Crossroads));
    }
    assert_eq!(nodes(&graph, NodeKind::Crossroads).len(), 6);
    let inner = |p: &DVec2| p.min_element() > 20.0 && p.max_element() < 620.0;
    let blind: Vec<DVec2> = nodes(&graph, NodeKind::BlindAlley).into_iter().filter(inner).collect();
    let alley = DVec2::new(70.0 - 4.5, 330.0);
    assert!(blind.iter().any(|p| p.distance(alley) < 3.0), "the blind alley ends at {alley}: {blind:?}");

    for (at, width) in
        [([300.0, 160.0], 12.0), ([160.0, 250.0], 8.0), ([420.0, 60.0], 6.0), ([300.0, 332.0], 7.0), ([110.0, 330.0], 4.0)]
    {
        let found = width_at(&graph, DVec2::from(at));
        assert!((found - width).abs() < 0.5, "street at {at:?} is {width} m wide, found {found}");
    }
    assert!(graph.links.iter().any(|l| l.kind == LinkKind::Street(StreetClass::Street)));

    assert_eq!(graph.squares.len(), 1);
    let square = &graph.squares[0].outline;
    let (low, high) = square.iter().fold((DVec2::MAX, DVec2::MIN), |(l, h), p| (l.min(*p), h.max(*p)));
    let (want_low, want_high) = (DVec2::new(238.0, 127.0), DVec2::new(302.0, 183.0));
    assert!(low.distance(want_low) < 4.0 && high.distance(want_high) < 4.0, "square from {low} to {high}");

    let of = |kind: BlockKind| graph.blocks.iter().filter(|b| b.kind == kind).count();
    assert_eq!(of(BlockKind::Park), 1);
    assert!(of(BlockKind::Built) >= 8, "{} built blocks", of(BlockKind::Built));
}

#[test]
fn any_number_of_threads_reads_the_same() {
    assert_eq!(surveyed(&town(), 1), surveyed(&town(), 3));
}

#[test]
fn a_street_goes_on_under_its_name() {
    let bare = surveyed(&town(), 1);
    let mut lettered = town();
    // A name over all of a street's width, one on an avenue, one on a block.
    write_over(&mut lettered, [414, 200], [426, 290]);
    write_over(&mut lettered, [220, 154], [330, 166]);
    write_over(&mut lettered, [200, 560], [330, 574]);
    let graph = surveyed(&lettered, 1);
    assert_eq!(nodes(&graph, NodeKind::Crossroads).len(), nodes(&bare, NodeKind::Crossroads).len());
    let inner = |graph: &CityGraph| {
        nodes(graph, NodeKind::BlindAlley).into_iter().filter(|p| p.min_element() > 20.0 && p.max_element() < 620.0).count()
    };
    assert_eq!(inner(&graph), inner(&bare), "no street ends at a name");
}

/// A picture of which the scale is known.
fn scale(picture: &Picture, metres: f64) -> Georeference {
    Georeference::from_metres_per_pixel("town.png", (picture.width as u32, picture.height as u32), metres)
        .unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn a_placed_picture_gives_the_same_streets_where_it_lies() {
    let (town, legend) = (town(), Legend::parse(LEGEND, "legend.json").unwrap_or_else(|e| panic!("{e}")));
    let size = (town.width as u32, town.height as u32);
    // Half a metre a pixel, near Prague: the upper edge runs 30° north of east.
    let anchor = Anchor { lat: 50.09, lon: 14.42 };
    let along = DVec2::new(libm::cos(core::f64::consts::FRAC_PI_6), 0.5);
    let known = |column: f64| {
        let (lat, lon) = anchor.geo_from_plan(along * column * METRES);
        KnownPoint { pixel: DVec2::new(column, 0.0), lat, lon }
    };
    let place = Georeference::from_known_points("town.png", size, [known(0.0), known(f64::from(size.0))]);
    let place = place.unwrap_or_else(|e| panic!("{e}"));
    let settings = RasterSettings { georeference: place.clone(), threads: 1, keeps_margin: false };
    let placed = survey_raster(&town, &legend, &settings, "town.png", &mut |_| ()).unwrap_or_else(|e| panic!("{e}")).graph;
    let bare = surveyed(&town, 1);
    assert_eq!((placed.nodes.len(), placed.links.len()), (bare.nodes.len(), bare.links.len()));
    assert_eq!((placed.squares.len(), placed.blocks.len()), (bare.squares.len(), bare.blocks.len()));
    assert!((placed.anchor.lat - anchor.lat).abs() < 0.01, "{:?}", placed.anchor);
    for node in &bare.nodes {
        let pixel = DVec2::new(node.pos.x / METRES, f64::from(size.1) - node.pos.y / METRES);
        let goal = place.plan_pos(pixel);
        let off = placed.nodes.iter().map(|n| n.pos.distance(goal)).fold(f64::MAX, f64::min);
        assert!(off < 0.1, "the node at {} is {off} m from where it lies", node.pos);
    }
}

#[test]
fn a_place_of_another_picture_is_an_error() {
    let legend = Legend::parse(LEGEND, "legend.json").unwrap_or_else(|e| panic!("{e}"));
    let georeference = Georeference::from_metres_per_pixel("town.png", (10, 10), METRES).unwrap_or_else(|e| panic!("{e}"));
    let settings = RasterSettings { georeference, threads: 1, keeps_margin: false };
    let refused = survey_raster(&town(), &legend, &settings, "town.png", &mut |_| ());
    assert!(refused.is_err_and(|e| e.to_string().contains("10 × 10")));
}

#[test]
fn a_blank_picture_is_an_error() {
    let blank = Picture { width: 64, height: 64, pixels: BUILT.repeat(64 * 64) };
    let legend = Legend::parse(LEGEND, "legend.json").unwrap_or_else(|e| panic!("{e}"));
    let settings = RasterSettings { georeference: scale(&blank, METRES), threads: 1, keeps_margin: false };
    let refused = survey_raster(&blank, &legend, &settings, "blank.png", &mut |_| ());
    assert!(refused.is_err_and(|e| e.to_string().contains("blank.png")));
}

#[test]
fn a_picture_that_is_none_and_a_scale_that_is_none_are_errors() {
    let legend = Legend::parse(LEGEND, "legend.json").unwrap_or_else(|e| panic!("{e}"));
    let refused = |picture: &Picture, metres_per_pixel: f64| {
        let size = (picture.width as u32, picture.height as u32);
        let survey = Georeference::from_metres_per_pixel("odd.png", size, metres_per_pixel).and_then(|georeference| {
            let settings = RasterSettings { georeference, threads: 1, keeps_margin: false };
            survey_raster(picture, &legend, &settings, "odd.png", &mut |_| ())
        });
        survey.is_err_and(|e| e.to_string().contains("odd.png"))
    };
    for metres in [0.0, -1.0, 1e-9, 1e9, f64::NAN] {
        assert!(refused(&town(), metres), "{metres} metres a pixel");
    }
    for (width, height) in [(0, 0), (0, 5), (5, 0), (9, 9)] {
        assert!(refused(&Picture { width, height, pixels: Vec::new() }, METRES), "{width} × {height} without pixels");
    }
}

/// Streets of so many pixels every 40 pixels, in both directions, and one at a slant.
fn fine_grid(width: usize) -> Picture {
    let mut pixels = Vec::with_capacity(SIZE * SIZE * 3);
    for (x, y) in (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (x, y))) {
        let is_slanting = (x + 7).abs_diff(2 * y) < width;
        let is_street = x % 40 < width || y % 40 < width || is_slanting;
        pixels.extend(if is_street { STREET } else { BUILT });
    }
    Picture { width: SIZE, height: SIZE, pixels }
}

#[test]
fn streets_of_a_few_pixels_are_read() {
    const COARSE: f64 = 4.0;
    for width in [1, 2, 3] {
        let picture = fine_grid(width);
        let legend = Legend::parse(LEGEND, "legend.json").unwrap_or_else(|e| panic!("{e}"));
        let settings = RasterSettings { georeference: scale(&picture, COARSE), threads: 1, keeps_margin: false };
        let read = survey_raster(&picture, &legend, &settings, "fine.png", &mut |_| ());
        let graph = read.unwrap_or_else(|e| panic!("{width}: {e}")).graph;
        let at = graph.node_positions();
        // Where two streets of the grid cross, and not the slanting one.
        let crossings = (1..16usize).flat_map(|i| (1..16).map(move |k| (40 * i, 40 * k)));
        let middle = width as f64 / 2.0;
        for (x, y) in crossings.filter(|&(x, y)| (x + 7).abs_diff(2 * y) > 30) {
            let p = DVec2::new(x as f64 + middle, SIZE as f64 - y as f64 - middle) * COARSE;
            let nearest = at.values().map(|n| n.distance(p)).fold(f64::MAX, f64::min);
            assert!(nearest < COARSE, "{width}: the crossroads at ({x}, {y}) is {nearest:.1} m off");
        }
        let mut widths: Vec<f64> = graph.links.iter().map(|link| link.width_m).collect();
        widths.sort_by(f64::total_cmp);
        let (median, drawn) = (widths[widths.len() / 2], COARSE * width as f64);
        assert!((median - drawn).abs() < 0.5 * COARSE, "{width}: streets of {drawn} m are {median} m wide");
    }
}

/// The raster maps of the shared data, and how many links each has at least.
const REAL: &[(&str, usize)] = &[
    ("raster_prague_new_town_derived/prague_new_town_streets.png", 400),
    ("raster_heidelberg_derived/heidelberg_altstadt_streets.png", 400),
    ("raster_san_francisco_toner/sf_mission_toner_z15.png", 150),
    ("raster_figure_ground/portland_figure_ground.png", 300),
    // Its streets are two pixels wide.
    ("raster_figure_ground/port_au_prince_figure_ground.png", 300),
    ("raster_prettymaps/palmanova.png", 100),
    // Outlines alone; the first in a frame with a margin, and under a grid.
    ("raster_paris_1836/jacoubet_1836_champs_elysees.jpg", 45),
    ("raster_paris_1925/paris_1925_invalides.jpg", 45),
    ("raster_paris_1925/paris_1925_saint_germain.jpg", 150),
];

fn data() -> PathBuf {
    std::env::var_os("VEDUTA_DATA").map_or_else(|| PathBuf::from("../../../shared/data"), PathBuf::from)
}

#[test]
fn real_maps_give_valid_graphs() {
    if !data().is_dir() {
        eprintln!("left out: no test data at {}; VEDUTA_DATA names another place", data().display());
        return;
    }
    for (file, least) in REAL {
        let bytes = std::fs::read(data().join(file)).unwrap_or_else(|e| panic!("{file}: {e}"));
        let picture = Picture::decode(&bytes, file, &PictureLimits::default()).unwrap_or_else(|e| panic!("{e}"));
        let (legend, _) = guess_legend(&picture, None);
        let metres_per_pixel = scale_by_streets(&picture, &legend).unwrap_or_else(|| panic!("{file} shows streets"));
        assert!((0.15..6.0).contains(&metres_per_pixel), "{file}: {metres_per_pixel} metres a pixel");
        let settings = RasterSettings { georeference: scale(&picture, metres_per_pixel), threads: 1, keeps_margin: false };
        let survey = survey_raster(&picture, &legend, &settings, file, &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
        assert!(survey.graph.links.len() >= *least, "{file}: {} links", survey.graph.links.len());
        assert!(!survey.graph.blocks.is_empty(), "{file} has blocks");
    }
}

/// The town in a frame on a sheet with a margin: the frame begins so far from the sheet's lower left corner.
fn town_on_sheet() -> (Picture, DVec2) {
    const MARGIN: usize = 90;
    const FRAME: usize = 3;
    let (town, side) = (town(), SIZE + 2 * MARGIN);
    let mut pixels = Vec::with_capacity(side * side * 3);
    for y in 0..side {
        for x in 0..side {
            let [u, v] = [x, y].map(|at| at.checked_sub(MARGIN));
            let is_line = |at: usize| at + FRAME >= MARGIN && at < MARGIN + SIZE + FRAME;
            let of_town = u.zip(v).and_then(|(u, v)| town.at(u, v));
            pixels.extend(of_town.unwrap_or(if is_line(x) && is_line(y) { INK } else { STREET }));
        }
    }
    (Picture { width: side, height: side, pixels }, DVec2::splat(MARGIN as f64))
}

#[test]
fn the_margin_of_a_sheet_is_left_out_unless_it_is_asked_for() {
    let (sheet, margin) = town_on_sheet();
    let legend = Legend::parse(LEGEND, "legend.json").unwrap_or_else(|e| panic!("{e}"));
    let read = |keeps_margin: bool| {
        let settings = RasterSettings { georeference: scale(&sheet, METRES), threads: 1, keeps_margin };
        survey_raster(&sheet, &legend, &settings, "sheet.png", &mut |_| ()).unwrap_or_else(|e| panic!("{e}"))
    };
    let (within, town) = (read(false), surveyed(&town(), 1));
    assert!(within.findings.iter().any(|f| f.message.contains("neatline")), "{:?}", within.findings);
    assert_eq!(within.graph.links.len(), town.links.len());
    assert_eq!(within.graph.blocks.len(), town.blocks.len());
    for kind in [NodeKind::Crossroads, NodeKind::BlindAlley] {
        let [found, drawn] = [nodes(&within.graph, kind), nodes(&town, kind)];
        assert_eq!(found.len(), drawn.len(), "{kind:?}");
        for place in drawn {
            // `nodes` measures from the top of a town without a margin.
            let place = DVec2::new(place.x + margin.x, place.y - margin.y);
            assert!(found.iter().any(|node| node.distance(place) < 3.0), "{kind:?} at {place}: {found:?}");
        }
    }
    let whole = read(true);
    assert!(!whole.findings.iter().any(|f| f.message.contains("neatline")), "{:?}", whole.findings);
    let is_outside = |p: DVec2| (p / METRES - margin).min_element() < -10.0;
    let has_outside = |graph: &CityGraph| graph.nodes.iter().any(|node| is_outside(node.pos));
    assert_eq!([has_outside(&within.graph), has_outside(&whole.graph)], [false, true], "the margin is as light as streets");
}
