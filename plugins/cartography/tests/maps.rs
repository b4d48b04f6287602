//! Whole maps: a golden of a hamlet in SVG, and what their bytes hold.
//!
//! `VEDUTA_BLESS=1` writes the golden anew; where another map comes out, it is left beside it as `*.actual`.

use glam::DVec2;
use quick_xml::events::Event;
use veduta_cartography::{Colours, Detail, Drawn, Layers, MapError, MapWords, Order, Paper, Ways, draw, to_png, to_svg};
use veduta_city::{
    GridPolygon, GridPos, GroundPatch, HouseName, Id, Massing, Overview, Place, PlaceKind, PlanRoof, PlanStreet, Rgb, RoofShape,
    StreetClass, SurfaceKind,
};

fn rectangle(x: f64, y: f64, width: f64, height: f64) -> GridPolygon {
    let at = |dx: f64, dy: f64| GridPos::from_metres(DVec2::new(x + dx, y + dy));
    GridPolygon::simple(vec![at(0.0, 0.0), at(width, 0.0), at(width, height), at(0.0, height)])
}

/// A street, a lane, stairs, a pond, a green, houses, a tower.
fn hamlet() -> Overview {
    let street = |id, name: &str, line: &[(f64, f64)], width: i32, class| PlanStreet {
        id: Id(id),
        name: name.into(),
        line: line.iter().map(|&p| GridPos::from_metres(p.into())).collect(),
        width: width * 1024,
        walkable: true,
        class,
        ..PlanStreet::default()
    };
    let patch = |surface, outline| GroundPatch { surface, outline, z: 0, course: None };
    let house = |x: f64, y: f64, size: f64, height: i32, shape| Massing {
        outline: rectangle(x, y, size, size),
        height: height * 1024,
        roof: PlanRoof { shape, height: height * 400, direction: 90, colour: Rgb(140, 62, 44) },
        colour: Rgb(234, 215, 160),
    };
    let place = |id, name: &str, kind, x: f64, y: f64| Place {
        id: Id(id),
        name: name.into(),
        kind,
        pos: DVec2::new(x, y),
        ..Place::default()
    };
    Overview {
        streets: vec![
            street(1, "Long & Winding", &[(-120.0, 0.0), (-20.0, 4.0), (60.0, -6.0), (120.0, 20.0)], 9, StreetClass::Street),
            street(2, "Pond Lane", &[(-20.0, 4.0), (-24.0, 80.0)], 5, StreetClass::Lane),
            street(3, "Steps", &[(60.0, -6.0), (62.0, -60.0)], 3, StreetClass::Steps),
        ],
        ground: vec![
            patch(SurfaceKind::Cobbles, rectangle(-120.0, -5.0, 240.0, 12.0)),
            patch(SurfaceKind::Water, rectangle(-110.0, 30.0, 60.0, 40.0)),
            patch(SurfaceKind::Grass, rectangle(0.0, 30.0, 80.0, 50.0)),
        ],
        houses: vec![
            house(-80.0, -30.0, 14.0, 11, RoofShape::Gabled),
            house(-50.0, -32.0, 16.0, 12, RoofShape::Hipped),
            house(10.0, -34.0, 12.0, 42, RoofShape::Pyramidal),
        ],
        names: vec![HouseName { house: 2, name: "Tower <of> Stone".into(), number: String::new(), parts: 1 }],
        places: vec![
            place(1, "Green", PlaceKind::Other, 40.0, 55.0),
            place(2, "Well", PlaceKind::Monument, -60.0, 12.0),
            place(3, "Over the pond", PlaceKind::Viewpoint, -80.0, 24.0),
        ],
        ..Overview::default()
    }
}

fn order<'a>(overview: &'a Overview, ways: &'a Ways, words: &'a MapWords, detail: &'a Detail) -> Order<'a> {
    Order {
        overview,
        detail,
        extent: None,
        title: "A hamlet",
        credit: "© nobody, CC0",
        date: Some("1787"),
        paper: Paper::a(5),
        denominator: None,
        middle: None,
        up_deg: 0.0,
        layers: Layers::ALL,
        colours: Colours::Paper,
        has_index: true,
        ways,
        words,
        written: &str::to_owned,
        sorted_by: &str::to_lowercase,
    }
}

fn drawn(change: impl FnOnce(&mut Order<'_>)) -> Drawn {
    let (overview, words) = (hamlet(), MapWords::of("en").expect("there is English"));
    let ways = Ways { led: vec![vec![DVec2::new(-100.0, 0.0), DVec2::new(60.0, -6.0)]], ..Ways::default() };
    let detail = Detail {
        trees: vec![(DVec2::new(20.0, 50.0), 3.0)],
        arcades: vec![vec![DVec2::new(-80.0, -16.0), DVec2::new(-66.0, -16.0)]],
    };
    let mut order = order(&overview, &ways, &words, &detail);
    change(&mut order);
    draw(&order).expect("there is a hamlet")
}

#[test]
fn the_hamlet_is_drawn_as_ever() {
    let svg = to_svg(&drawn(|_| ()).drawing);
    let golden = std::path::Path::new("tests/hamlet.svg");
    if std::env::var_os("VEDUTA_BLESS").is_some_and(|v| v != "0" && !v.is_empty()) {
        std::fs::write(golden, &svg).expect("room");
    }
    let told = std::fs::read_to_string(golden).unwrap_or_default().replace("\r\n", "\n");
    let actual = golden.with_extension("svg.actual");
    if told == svg {
        let _ = std::fs::remove_file(actual);
        return;
    }
    std::fs::write(&actual, &svg).expect("room");
    let line = told.lines().zip(svg.lines()).position(|(a, b)| a != b).unwrap_or_default() + 1;
    panic!("{}: another map from line {line} on (see {}; VEDUTA_BLESS=1 writes it anew)", golden.display(), actual.display());
}

#[test]
fn a_map_is_well_formed_and_names_what_it_shows() {
    let svg = to_svg(&drawn(|_| ()).drawing);
    let mut reader = quick_xml::Reader::from_str(&svg);
    let (mut depth, mut layers, mut text) = (0, Vec::new(), String::new());
    loop {
        match reader.read_event().expect("well formed") {
            Event::Start(element) => {
                depth += 1;
                if element.name().0 == "g" {
                    let id = element.try_get_attribute("id").expect("well formed").expect("layers have names");
                    layers.push(id.value.into_owned());
                }
            }
            Event::End(_) => depth -= 1,
            Event::Text(words) => text.push_str(&words.into_inner()),
            Event::GeneralRef(entity) => text.push_str(&format!("&{};", entity.into_inner())),
            Event::Eof => break,
            _ => {}
        }
    }
    assert_eq!(depth, 0);
    for layer in ["land", "streets", "water", "parks", "stairs", "houses", "arcades", "ways", "landmarks", "names", "index"] {
        assert!(layers.iter().any(|name| name == layer), "{layer}: {layers:?}");
    }
    for name in [
        "Long &amp; Winding",
        "Pond Lane",
        "Tower &lt;of&gt; Stone",
        "Well",
        "Green",
        "A hamlet",
        "1787",
        "CC0",
        "Streets and places",
    ] {
        assert!(text.contains(name), "{name}: {text}");
    }
}

#[test]
fn layers_can_be_left_out() {
    let bare = drawn(|order| (order.layers, order.has_index) = (Layers::NONE, false));
    let full = drawn(|_| ());
    assert!(bare.layout.names.is_empty() && bare.layout.pictures.is_empty() && full.layout.pictures.len() == 1);
    let of = |drawn: &Drawn, name: &str| {
        drawn.drawing.groups.iter().find(|group| group.name == name).map_or(0, |group| group.items.len())
    };
    for layer in ["trees", "ways", "landmarks", "signs", "names"] {
        assert!(of(&bare, layer) == 0 && of(&full, layer) > 0, "{layer}");
    }
    assert_eq!(of(&bare, "houses"), of(&full, "houses"));
}

#[test]
fn pictures_have_the_size_of_their_paper() {
    let png = to_png(&drawn(|_| ()).drawing, 50.8).expect("small");
    let info = png::Decoder::new(std::io::Cursor::new(&png)).read_info().expect("a PNG");
    // A5 lies across, two pixels a millimetre.
    assert_eq!((info.info().width, info.info().height), (420, 296));
    assert_eq!(to_png(&drawn(|_| ()).drawing, 50.8), Ok(png), "the same again");
}

#[test]
fn a_city_without_anything_is_told_of() {
    let (nothing, words) = (Overview::default(), MapWords::of("it").expect("there is Italian"));
    let (ways, detail) = (Ways::default(), Detail::default());
    assert_eq!(draw(&order(&nothing, &ways, &words, &detail)).map(|drawn| drawn.denominator), Err(MapError::Empty));
}
