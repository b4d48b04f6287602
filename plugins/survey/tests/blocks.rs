//! Blocks, courtyards, houses, and classes by colour, in pictures that are drawn here.

use glam::DVec2;
use veduta_city::{Block, BlockKind, CityGraph, LinkKind, Ring, StreetClass};
use veduta_survey::Georeference;
use veduta_survey::raster::{Legend, Picture, RasterSettings, survey_raster};

const SIZE: usize = 640;
const METRES: f64 = 0.5;

const STREET: [u8; 3] = [255, 254, 248];
const MAIN: [u8; 3] = [252, 221, 128];
const BUILT: [u8; 3] = [200, 180, 150];
const HOUSE: [u8; 3] = [150, 60, 40];
const PARK: [u8; 3] = [150, 200, 120];
const WATER: [u8; 3] = [120, 170, 220];
const SQUARE: [u8; 3] = [235, 200, 225];

const LEGEND: &str = r#"{ "classes": { "street": [[255, 254, 248]], "street:main": [[252, 221, 128]], "built": [[200, 180, 150]],
    "house": [[150, 60, 40]], "park": [[150, 200, 120]], "water": [[120, 170, 220]], "square": [[235, 200, 225]] } }"#;

/// Whether a pixel lies in a box, from its upper left corner to before its lower right one.
fn is_in(p: [usize; 2], low: [usize; 2], high: [usize; 2]) -> bool {
    (0..2).all(|i| (low[i]..high[i]).contains(&p[i]))
}

/// Streets 16 pixels wide about a block of 528 × 528 pixels from (56, 56) on.
fn is_frame(p: [usize; 2]) -> bool {
    p.iter().any(|c| (40..56).contains(c) || (584..600).contains(c))
}

/// A picture of a frame of streets, with what `inside` says within the block.
fn framed(inside: impl Fn([usize; 2]) -> [u8; 3]) -> Picture {
    let pixel = |i: usize| {
        let p = [i % SIZE, i / SIZE];
        if is_frame(p) { STREET } else { inside(p) }
    };
    Picture { width: SIZE, height: SIZE, pixels: (0..SIZE * SIZE).flat_map(pixel).collect() }
}

fn surveyed_by(picture: &Picture, legend: &str) -> CityGraph {
    let legend = Legend::parse(legend, "legend.json").unwrap_or_else(|e| panic!("{e}"));
    let place =
        Georeference::from_metres_per_pixel("town.png", (SIZE as u32, SIZE as u32), METRES).unwrap_or_else(|e| panic!("{e}"));
    let settings = RasterSettings { georeference: place, threads: 1, keeps_margin: false };
    let survey = survey_raster(picture, &legend, &settings, "town.png", &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(survey.findings, [], "nothing had to be mended");
    survey.graph
}

fn surveyed(picture: &Picture) -> CityGraph {
    surveyed_by(picture, LEGEND)
}

fn area(ring: &Ring) -> f64 {
    let next = ring.iter().cycle().skip(1);
    ring.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>() / 2.0
}

/// A block's area without its holes.
fn net_area(block: &Block) -> f64 {
    area(&block.outline) + block.holes.iter().map(area).sum::<f64>()
}

/// Plan metres of a pixel.
fn plan(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, SIZE as f64 - y) * METRES
}

fn contains(ring: &Ring, p: DVec2) -> bool {
    let edges = ring.iter().zip(ring.iter().cycle().skip(1));
    edges.filter(|(a, b)| (a.y > p.y) != (b.y > p.y) && (p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x))).count() % 2 == 1
}

/// The only block at a pixel.
fn block_at(graph: &CityGraph, x: f64, y: f64) -> &Block {
    let p = plan(x, y);
    let holds = |b: &&Block| contains(&b.outline, p) && !b.holes.iter().any(|h| contains(h, p));
    let all: Vec<&Block> = graph.blocks.iter().filter(holds).collect();
    assert_eq!(all.len(), 1, "blocks at {x}, {y}");
    all[0]
}

/// How far the nearest street is from a pixel, metres, and its class.
fn street_at(graph: &CityGraph, x: f64, y: f64) -> (f64, StreetClass) {
    let (p, at) = (plan(x, y), graph.node_positions());
    let mut best = (f64::MAX, StreetClass::Street);
    for link in &graph.links {
        let LinkKind::Street(class) = link.kind else { continue };
        let line: Vec<DVec2> = core::iter::once(at[&link.from]).chain(link.via.iter().copied()).chain([at[&link.to]]).collect();
        for w in line.windows(2) {
            let along = w[1] - w[0];
            let t = ((p - w[0]).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            let off = p.distance(w[0] + along * t);
            if off < best.0 {
                best = (off, class);
            }
        }
    }
    best
}

#[track_caller]
fn assert_near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() < within, "{found:.1}, not {expected:.1}");
}

#[test]
fn a_block_has_a_street_that_leads_nowhere_as_its_hole() {
    let ring = |p| is_in(p, [200, 200], [440, 440]) && !is_in(p, [214, 214], [426, 426]);
    let graph = surveyed(&framed(|p| if ring(p) { STREET } else { BUILT }));
    let around = block_at(&graph, 120.0, 320.0);
    assert_eq!(around.holes.len(), 1);
    assert!(area(&around.holes[0]) < 0.0, "holes run clockwise");
    assert_near(net_area(around), (528.0 * 528.0 - 240.0 * 240.0) * 0.25, 200.0);
    assert_near(net_area(block_at(&graph, 320.0, 320.0)), 212.0 * 212.0 * 0.25, 100.0);
    assert!(street_at(&graph, 207.0, 320.0).0 < 1.0, "the street is one all the same");
}

#[test]
fn a_court_is_a_hole_unless_a_street_leads_there() {
    let court = |p| is_in(p, [140, 200], [220, 300]);
    let behind_a_gate = |p| is_in(p, [340, 200], [420, 300]) || is_in(p, [376, 40], [388, 210]);
    let speck = |p| is_in(p, [300, 400], [318, 418]);
    let graph = surveyed(&framed(|p| if court(p) || behind_a_gate(p) || speck(p) { STREET } else { BUILT }));
    let block = block_at(&graph, 280.0, 500.0);
    assert_eq!(block.holes.len(), 1);
    assert_near(area(&block.holes[0]), -80.0 * 100.0 * 0.25, 40.0);
    let open = 12.0 * 144.0 + 80.0 * 100.0;
    assert_near(net_area(block), (528.0 * 528.0 - 80.0 * 100.0 - open) * 0.25, 250.0);
    assert!(street_at(&graph, 180.0, 250.0).0 > 20.0, "no street in the courtyard");
    assert!(street_at(&graph, 382.0, 120.0).0 < 1.0 && street_at(&graph, 309.0, 409.0).0 > 20.0);
    assert!(graph.squares.iter().all(|s| !contains(&s.outline, plan(180.0, 250.0))), "nor a square");
}

#[test]
fn a_square_that_no_street_leads_to_is_one_by_its_colour() {
    let square = |p| is_in(p, [200, 200], [280, 260]);
    let graph = surveyed(&framed(|p| if square(p) { SQUARE } else { BUILT }));
    assert_eq!(graph.squares.len(), 1);
    assert_near(area(&graph.squares[0].outline), 80.0 * 60.0 * 0.25, 30.0);
    let block = block_at(&graph, 400.0, 400.0);
    assert_eq!(block.holes.len(), 1);
    assert_near(net_area(block), (528.0 * 528.0 - 80.0 * 60.0) * 0.25, 200.0);
}

#[test]
fn a_widening_is_a_square_where_its_colour_says_so() {
    // A place of 12 × 16 m beside a street, too small to be told by its room.
    let place = |p: [usize; 2]| is_in(p, [56, 300], [88, 324]);
    let of = |colour: [u8; 3]| surveyed(&framed(|p| if place(p) { colour } else { BUILT }));
    assert_eq!(of(STREET).squares.len(), 0);
    let graph = of(SQUARE);
    assert_eq!(graph.squares.len(), 1);
    assert_near(area(&graph.squares[0].outline), 32.0 * 24.0 * 0.25, 20.0);
    assert!(street_at(&graph, 48.0, 312.0).0 < 1.0, "the street beside it goes on");
    // Streets end where they enter one.
    let crossing = |p: [usize; 2]| is_in(p, [260, 260], [340, 330]);
    let graph = surveyed(&framed(|p| match p {
        p if crossing(p) => SQUARE,
        p if (294..306).contains(&p[0]) => STREET,
        _ => BUILT,
    }));
    assert_eq!(graph.squares.len(), 1);
    assert_near(area(&graph.squares[0].outline), 80.0 * 70.0 * 0.25, 30.0);
    assert!(street_at(&graph, 300.0, 200.0).0 < 1.0 && street_at(&graph, 300.0, 400.0).0 < 1.0);
    assert!(street_at(&graph, 300.0, 295.0).0 > 15.0, "they end at its border");
}

#[test]
fn a_street_is_of_the_class_that_its_colour_says() {
    // Narrow main streets across and down, and a wide one in the colour of ordinary ones.
    let paint = |p: [usize; 2]| match p {
        p if (314..324).contains(&p[1]) => MAIN,
        p if (180..220).contains(&p[0]) => STREET,
        p if (414..422).contains(&p[0]) => MAIN,
        _ => BUILT,
    };
    let classes = |legend: &str| {
        let graph = surveyed_by(&framed(paint), legend);
        [[120.0, 319.0], [300.0, 319.0], [200.0, 250.0], [418.0, 450.0], [300.0, 48.0]].map(|[x, y]| {
            let (off, class) = street_at(&graph, x, y);
            assert!(off < 1.5, "no street at {x}, {y}");
            class
        })
    };
    use StreetClass::{Lane, Main, Path, Street};
    assert_eq!(classes(LEGEND), [Main, Main, Main, Main, Street], "by colour; else by width");
    assert_eq!(classes(&LEGEND.replace("street:main", "street:path")), [Path, Path, Main, Path, Street]);
    let plain = LEGEND
        .replace("\"street:main\": [[252, 221, 128]],", "")
        .replace("[[255, 254, 248]]", "[[255, 254, 248], [252, 221, 128]]");
    assert_eq!(classes(&plain), [Lane, Lane, Main, Lane, Street], "by width alone");
}

#[test]
fn houses_are_footprints_and_the_block_is_what_streets_enclose() {
    // One square to the picture, one turned, an L about a court that is none of its own, and one with a court.
    let turned = |p: [usize; 2]| {
        let q = DVec2::from_angle(0.35).rotate(DVec2::new(p[0] as f64 + 0.5, p[1] as f64 + 0.5) - DVec2::new(400.0, 160.0));
        q.x.abs() < 40.0 && q.y.abs() < 24.0
    };
    let is_house = |p: [usize; 2]| {
        is_in(p, [80, 80], [120, 110])
            || turned(p)
            || is_in(p, [100, 300], [200, 340])
            || is_in(p, [100, 300], [140, 420])
            || is_in(p, [350, 350], [470, 450]) && !is_in(p, [380, 380], [440, 420])
    };
    let with = surveyed(&framed(|p| if is_house(p) { HOUSE } else { BUILT }));
    let without = surveyed(&framed(|_| BUILT));
    assert_eq!(with.blocks, without.blocks, "blocks are houses and ground together");
    assert_eq!((with.buildings.len(), without.buildings.len()), (4, 0));
    let house_at = |x: f64, y: f64| {
        let house = with.buildings.iter().find(|b| contains(&b.outline, plan(x, y)));
        house.unwrap_or_else(|| panic!("no house at {x}, {y}"))
    };
    for (at, corners, pixels) in
        [([100.0, 95.0], 4, 40.0 * 30.0), ([400.0, 160.0], 4, 80.0 * 48.0), ([120.0, 380.0], 6, 100.0 * 40.0 + 40.0 * 80.0)]
    {
        let house = house_at(at[0], at[1]);
        assert_eq!((house.outline.len(), house.holes.len()), (corners, 0), "{at:?}");
        assert_near(area(&house.outline), pixels * 0.25, 12.0);
    }
    let court = house_at(360.0, 360.0);
    assert_eq!(court.holes.len(), 1);
    assert_near(area(&court.outline), 120.0 * 100.0 * 0.25, 10.0);
    assert_near(area(&court.holes[0]), -60.0 * 40.0 * 0.25, 10.0);
}

#[test]
fn a_block_half_park_half_built_is_two() {
    let graph = surveyed(&framed(|p| if p[0] + p[1] / 2 < 480 { PARK } else { BUILT }));
    let (park, built) = (block_at(&graph, 100.0, 300.0), block_at(&graph, 540.0, 300.0));
    assert_eq!((park.kind, built.kind), (BlockKind::Park, BlockKind::Built));
    let parks = 528.0 * (480.0 - 56.0 / 2.0 - 56.0 - 528.0 / 4.0);
    assert_near(area(&park.outline), parks * 0.25, 500.0);
    assert_near(area(&park.outline) + area(&built.outline), 528.0 * 528.0 * 0.25, 300.0);
}

#[test]
fn a_garden_or_pond_within_a_block_is_its_hole() {
    for (colour, kind) in [(PARK, BlockKind::Park), (WATER, BlockKind::Water)] {
        let graph = surveyed(&framed(|p| if is_in(p, [150, 150], [480, 480]) { colour } else { BUILT }));
        let (inner, outer) = (block_at(&graph, 300.0, 300.0), block_at(&graph, 80.0, 300.0));
        assert_eq!((inner.kind, outer.kind, outer.holes.len()), (kind, BlockKind::Built, 1));
        assert_near(area(&inner.outline), 330.0 * 330.0 * 0.25, 300.0);
        assert_near(net_area(outer), (528.0 * 528.0 - 330.0 * 330.0) * 0.25, 400.0);
    }
}

#[test]
fn what_is_no_clean_half_stays_with_the_block() {
    let small = |p| is_in(p, [56, 56], [300, 300]);
    let trees = |p: [usize; 2]| (p[0] / 9 + p[1] / 9).is_multiple_of(2);
    let patches = |p: [usize; 2]| p[0] % 40 < 22 && p[1] % 40 < 22;
    for (what, is_park) in [("a fifth", &small as &dyn Fn([usize; 2]) -> bool), ("trees", &trees), ("patches", &patches)] {
        let graph = surveyed(&framed(|p| if is_park(p) { PARK } else { BUILT }));
        let inner: Vec<&Block> = graph.blocks.iter().filter(|b| contains(&b.outline, plan(320.0, 320.0))).collect();
        assert_eq!((inner.len(), inner[0].kind, inner[0].holes.len()), (1, BlockKind::Built, 0), "{what}");
        assert_near(area(&inner[0].outline), 528.0 * 528.0 * 0.25, 300.0);
    }
}
