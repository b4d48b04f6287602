//! Rules of the survey on maps of a few elements, through the public interface.

use std::fmt::Write as _;
use std::io::Write as _;

use veduta_city::{BlockKind, Id, LinkKind, ObjectKind, PlaceKind, RoofShape, Severity, StreetClass, Surfacing};
use veduta_survey::{Survey, SurveyError, looks_like_osm, survey_osm};

/// A map in the making: nodes are given in metres around 50° N, 14° E.
#[derive(Default)]
struct Map {
    nodes: String,
    ways: String,
    relations: String,
    last: i64,
}

type Pairs<'a> = &'a [(&'a str, &'a str)];

fn tags(pairs: Pairs<'_>) -> String {
    pairs.iter().map(|(k, v)| format!("<tag k=\"{k}\" v=\"{v}\"/>")).collect()
}

impl Map {
    fn node(&mut self, (x, y): (f64, f64), pairs: Pairs<'_>) -> i64 {
        self.last += 1;
        let (lat, lon) = (50.0 + y / 111_229.0, 14.0 + x / 71_696.0);
        write!(self.nodes, "<node id=\"{}\" lat=\"{lat:.9}\" lon=\"{lon:.9}\">{}</node>", self.last, tags(pairs)).unwrap();
        self.last
    }

    fn way_of(&mut self, nodes: &[i64], pairs: Pairs<'_>) -> i64 {
        self.last += 1;
        let refs: String = nodes.iter().map(|n| format!("<nd ref=\"{n}\"/>")).collect();
        write!(self.ways, "<way id=\"{}\">{refs}{}</way>", self.last, tags(pairs)).unwrap();
        self.last
    }

    fn line(&mut self, points: &[(f64, f64)], pairs: Pairs<'_>) -> i64 {
        let nodes: Vec<i64> = points.iter().map(|&p| self.node(p, &[])).collect();
        self.way_of(&nodes, pairs)
    }

    fn square(&mut self, x: f64, y: f64, side: f64, pairs: Pairs<'_>) -> i64 {
        let mut nodes: Vec<i64> =
            [(x, y), (x + side, y), (x + side, y + side), (x, y + side)].iter().map(|&p| self.node(p, &[])).collect();
        nodes.push(nodes[0]);
        self.way_of(&nodes, pairs)
    }

    fn relation(&mut self, members: &[(i64, &str)], pairs: Pairs<'_>) -> i64 {
        self.last += 1;
        let all: String = members.iter().map(|(id, role)| format!("<member type=\"way\" ref=\"{id}\" role=\"{role}\"/>")).collect();
        write!(self.relations, "<relation id=\"{}\">{all}{}</relation>", self.last, tags(pairs)).unwrap();
        self.last
    }

    fn text(&self) -> String {
        format!("<osm version=\"0.6\">{}{}{}</osm>", self.nodes, self.ways, self.relations)
    }

    fn survey(&self) -> Survey {
        let survey = survey_osm(self.text().as_bytes(), "tiny.osm").unwrap();
        assert_eq!(survey.graph.validate(), []);
        survey
    }
}

fn way(id: i64) -> Id {
    Id::from_source(2, id as u64)
}

fn told(survey: &Survey, severity: Severity, words: &str) -> bool {
    survey.findings.iter().any(|f| f.severity == severity && f.message.contains(words))
}

const HOUSE: Pairs<'_> = &[("building", "yes")];

#[test]
fn a_house_keeps_its_name_number_height_and_roof() {
    let mut map = Map::default();
    let id = map.square(
        0.0,
        0.0,
        10.0,
        &[("building", "house"), ("name", "Zum Bären"), ("addr:housenumber", "7a"), ("height", "12 m"), ("roof:shape", "hipped")],
    );
    let survey = map.survey();
    let house = &survey.graph.buildings[0];
    assert_eq!((house.id, house.name.as_str(), house.number.as_str()), (way(id), "Zum Bären", "7a"));
    assert_eq!((house.height_m, house.roof.shape), (Some(12.0), Some(RoofShape::Hipped)));
    assert_eq!(house.outline.len(), 4);
    assert_eq!(survey.graph.places[0].kind, PlaceKind::House);
    assert_eq!(survey.graph.name, "tiny");
}

#[test]
fn the_lowest_address_point_inside_numbers_a_house() {
    let mut map = Map::default();
    map.square(0.0, 0.0, 20.0, HOUSE);
    for (x, number) in [(5.0, "12"), (8.0, "9"), (60.0, "1")] {
        map.node((x, 5.0), &[("addr:housenumber", number)]);
    }
    assert_eq!(map.survey().graph.buildings[0].number, "9");
}

#[test]
fn a_multipolygon_house_has_its_courtyard_and_its_outer_way_is_no_second_house() {
    for is_old in [false, true] {
        let mut map = Map::default();
        let outer = map.square(0.0, 0.0, 30.0, HOUSE);
        let inner = map.square(10.0, 10.0, 10.0, &[]);
        let tags: Pairs<'_> = if is_old { &[("type", "multipolygon")] } else { &[("type", "multipolygon"), ("building", "yes")] };
        map.relation(&[(outer, "outer"), (inner, "inner")], tags);
        let survey = map.survey();
        assert_eq!(survey.graph.buildings.len(), 1, "old style: {is_old}");
        assert_eq!(survey.graph.buildings[0].holes.len(), 1);
        assert_eq!(told(&survey, Severity::Note, "before 2017"), is_old);
    }
}

#[test]
fn a_house_drawn_twice_is_one_and_told() {
    let mut map = Map::default();
    let first = map.square(0.0, 0.0, 10.0, HOUSE);
    map.square(0.0, 0.0, 10.0, HOUSE);
    let survey = map.survey();
    assert_eq!(survey.graph.buildings.len(), 1);
    assert!(told(&survey, Severity::Dropped, &format!("the very outline of way/{first}")), "{:?}", survey.findings);
}

#[test]
fn a_house_inside_another_is_kept_and_told() {
    let mut map = Map::default();
    map.square(0.0, 0.0, 30.0, HOUSE);
    map.square(5.0, 5.0, 8.0, HOUSE);
    let survey = map.survey();
    assert_eq!(survey.graph.buildings.len(), 2);
    assert!(told(&survey, Severity::Note, "stands inside"));
}

#[test]
fn a_house_with_a_vertex_outside_the_file_is_dropped_and_told() {
    let mut map = Map::default();
    map.square(0.0, 0.0, 10.0, HOUSE);
    let nodes = [(50.0, 0.0), (60.0, 0.0), (60.0, 10.0)].map(|p| map.node(p, &[]));
    map.way_of(&[nodes[0], nodes[1], nodes[2], 999_999, nodes[0]], HOUSE);
    let survey = map.survey();
    assert_eq!(survey.graph.buildings.len(), 1);
    assert!(told(&survey, Severity::Dropped, "outside the file"), "{:?}", survey.findings);
}

#[test]
fn parts_find_their_house_by_place_and_the_rest_keeps_its_body() {
    let mut map = Map::default();
    map.square(0.0, 0.0, 30.0, &[("building", "church"), ("height", "15"), ("building:colour", "white")]);
    let tower = map.square(0.0, 0.0, 8.0, &[("building:part", "yes"), ("height", "45"), ("roof:shape", "pyramidal")]);
    let survey = map.survey();
    let church = &survey.graph.buildings[0];
    assert_eq!(church.parts.len(), 2, "the tower and what is left");
    let [body, part] = [&church.parts[0], &church.parts[1]];
    assert_eq!((part.id, part.height_m, part.roof.shape), (way(tower), Some(45.0), Some(RoofShape::Pyramidal)));
    assert_eq!((body.height_m, part.colour), (Some(15.0), church.colour));
    assert!(told(&survey, Severity::Repaired, "its own body fills the rest"));
}

#[test]
fn parts_that_cover_a_house_stand_alone() {
    let mut map = Map::default();
    map.square(0.0, 0.0, 20.0, HOUSE);
    for (x, y) in [(0.0, 0.0), (10.0, 0.0), (0.0, 10.0), (10.0, 10.0)] {
        map.square(x, y, 10.0, &[("building:part", "yes"), ("building:levels", "3")]);
    }
    let survey = map.survey();
    assert_eq!(survey.graph.buildings[0].parts.len(), 4);
    assert!(!told(&survey, Severity::Repaired, "fills the rest"));
}

#[test]
fn a_relation_tells_the_house_of_a_part_beside_it() {
    let mut map = Map::default();
    let hall = map.square(0.0, 0.0, 20.0, HOUSE);
    let porch = map.square(20.0, 5.0, 6.0, &[("building:part", "yes")]);
    map.relation(&[(hall, "outline"), (porch, "part")], &[("type", "building")]);
    let survey = map.survey();
    assert_eq!(survey.graph.buildings.len(), 1);
    assert!(survey.graph.buildings[0].parts.iter().any(|p| p.id == way(porch)));
}

#[test]
fn parts_without_a_house_that_touch_become_one_house() {
    let mut map = Map::default();
    map.square(0.0, 0.0, 10.0, &[("building:part", "yes"), ("height", "5")]);
    map.square(2.0, 2.0, 6.0, &[("building:part", "yes"), ("min_height", "5"), ("height", "9")]);
    map.square(100.0, 0.0, 6.0, &[("building:part", "yes")]);
    let survey = map.survey();
    let counts: Vec<usize> = survey.graph.buildings.iter().map(|b| b.parts.len()).collect();
    assert_eq!(counts, [2, 1]);
    assert_eq!(survey.graph.buildings[0].height_m, Some(9.0));
    assert!(told(&survey, Severity::Note, "without a building around them"));
}

#[test]
fn what_lies_under_the_ground_is_left_out() {
    let mut map = Map::default();
    map.square(0.0, 0.0, 10.0, HOUSE);
    map.square(20.0, 0.0, 10.0, &[("building", "garage"), ("location", "underground")]);
    map.square(40.0, 0.0, 20.0, &[("highway", "pedestrian"), ("area", "yes"), ("layer", "-1")]);
    let survey = map.survey();
    assert_eq!((survey.graph.buildings.len(), survey.graph.squares.len()), (1, 0));
    assert!(told(&survey, Severity::Dropped, "buildings under the ground"));
    assert!(told(&survey, Severity::Dropped, "squares under the ground"));
}

#[test]
fn a_crossing_outline_is_redrawn_and_a_line_is_no_house() {
    let mut map = Map::default();
    let nodes = [(0.0, 0.0), (20.0, 20.0), (20.0, 0.0), (0.0, 20.0)].map(|p| map.node(p, &[]));
    map.way_of(&[nodes[0], nodes[1], nodes[2], nodes[3], nodes[0]], HOUSE);
    map.line(&[(50.0, 0.0), (60.0, 0.0), (60.0, 9.0)], HOUSE);
    let survey = map.survey();
    assert_eq!(survey.graph.buildings.len(), 2, "the two halves of a bow tie");
    assert!(told(&survey, Severity::Repaired, "crosses, touches or repeats itself"));
    assert!(told(&survey, Severity::Dropped, "a line that does not close"));
}

#[test]
fn squares_parks_and_waters_are_told_apart() {
    let mut map = Map::default();
    map.square(0.0, 0.0, 40.0, &[("highway", "pedestrian"), ("area", "yes"), ("name", "Markt"), ("surface", "asphalt")]);
    map.square(50.0, 0.0, 30.0, &[("leisure", "park"), ("name", "Stadtpark")]);
    map.square(90.0, 0.0, 30.0, &[("natural", "water")]);
    map.line(&[(0.0, 50.0), (120.0, 50.0)], &[("highway", "residential")]);
    let survey = map.survey();
    let square = &survey.graph.squares[0];
    assert_eq!((square.name.as_str(), square.surfacing), ("Markt", Surfacing::Asphalt));
    let kinds: Vec<BlockKind> = survey.graph.blocks.iter().map(|b| b.kind).collect();
    assert_eq!(kinds, [BlockKind::Park, BlockKind::Water]);
    let start = survey.graph.start.unwrap();
    assert!((start.pos - square.outline.iter().copied().sum::<glam::DVec2>() / 4.0).length() < 0.01, "in the square's middle");
    assert!((start.heading_deg - 90.0).abs() < 1.0 || (start.heading_deg - 270.0).abs() < 1.0, "along the street: {start:?}");
}

/// A grid of three by three streets, 60 m apart.
fn grid(map: &mut Map) {
    let nodes: Vec<i64> = (0..16).map(|i| map.node((f64::from(i % 4) * 60.0, f64::from(i / 4) * 60.0), &[])).collect();
    for i in 0..4 {
        map.way_of(&nodes[i * 4..i * 4 + 4], &[("highway", "residential"), ("name", &format!("Row {i}"))]);
        let column: Vec<i64> = (0..4).map(|j| nodes[j * 4 + i]).collect();
        map.way_of(&column, &[("highway", "residential")]);
    }
}

#[test]
fn streets_without_houses_enclose_blocks_to_build_on() {
    let mut map = Map::default();
    grid(&mut map);
    map.square(65.0, 65.0, 50.0, &[("leisure", "park")]);
    map.square(5.0, 5.0, 30.0, HOUSE);
    let survey = map.survey();
    let built: Vec<_> = survey.graph.blocks.iter().filter(|b| b.kind == BlockKind::Built).collect();
    assert_eq!(built.len(), 7, "nine, less the park and the one with a house");
    assert_eq!(survey.graph.links.len(), 24);
    assert!(told(&survey, Severity::Note, "7 of 9 blocks"));
}

#[test]
fn a_map_with_its_houses_gets_no_more() {
    let mut map = Map::default();
    grid(&mut map);
    for i in 0..5 {
        map.square(f64::from(i % 3) * 60.0 + 10.0, f64::from(i / 3) * 60.0 + 10.0, 30.0, HOUSE);
    }
    assert!(map.survey().graph.blocks.is_empty());
}

#[test]
fn objects_stand_where_they_are_and_not_in_houses() {
    let mut map = Map::default();
    map.square(0.0, 0.0, 20.0, HOUSE);
    map.node((5.0, 5.0), &[("amenity", "bench")]);
    map.node((30.0, 5.0), &[("amenity", "bench"), ("direction", "W")]);
    let nodes = [(0.0, 50.0), (50.0, 50.0)].map(|p| map.node(p, &[]));
    let stop = map.node((100.0, 50.0), &[("railway", "tram_stop"), ("name", "Markt")]);
    map.way_of(&[nodes[0], nodes[1], stop], &[("railway", "tram")]);
    let survey = map.survey();
    let kinds: Vec<ObjectKind> = survey.graph.objects.iter().map(|o| o.kind).collect();
    assert_eq!(kinds, [ObjectKind::Bench, ObjectKind::TramStop]);
    assert_eq!(survey.graph.objects[0].heading_deg, 270.0);
    let (shelter, track) = (&survey.graph.objects[1], &survey.graph.links[0]);
    assert_eq!(track.kind, LinkKind::Railway { tram: true });
    let end = survey.graph.nodes.iter().find(|n| n.id == track.to).unwrap().pos;
    assert!(
        (end.y - shelter.pos.y - 2.8).abs() < 0.01 && shelter.heading_deg.abs() < 0.5,
        "beside the track, facing it: {shelter:?}"
    );
    assert!(told(&survey, Severity::Dropped, "Bench lie inside a building"));
}

#[test]
fn area_highway_is_passed_over_with_a_note() {
    let mut map = Map::default();
    map.line(&[(0.0, 0.0), (50.0, 0.0)], &[("highway", "residential")]);
    map.square(0.0, -5.0, 10.0, &[("area:highway", "residential")]);
    map.square(60.0, -5.0, 10.0, &[("area:highway", "pedestrian")]);
    let survey = map.survey();
    assert_eq!((survey.graph.links[0].kind, survey.graph.squares.len()), (LinkKind::Street(StreetClass::Street), 1));
    assert!(told(&survey, Severity::Note, "area:highway is passed over"));
}

#[test]
fn a_map_of_nothing_fails_and_says_what_it_held() {
    let mut map = Map::default();
    map.square(0.0, 0.0, 50.0, &[("natural", "water")]);
    let error = survey_osm(map.text().as_bytes(), "lake.osm").unwrap_err();
    assert!(matches!(error, SurveyError::Empty { .. }));
    assert!(error.to_string().starts_with("lake.osm has neither streets nor buildings"), "{error}");
    assert!(error.to_string().contains("4 nodes, 1 ways"), "{error}");
    assert!(matches!(survey_osm(b"<osm/>", "none.osm"), Err(SurveyError::NotOsm { .. } | SurveyError::Empty { .. })));
}

#[test]
fn xml_gzip_and_json_of_one_map_give_one_graph() {
    let mut map = Map::default();
    let house = map.square(0.0, 0.0, 10.0, HOUSE);
    let xml = map.text();
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packer.write_all(xml.as_bytes()).unwrap();
    let packed = packer.finish().unwrap();
    let number = |s: &str, key: &str| s.split_once(&format!("{key}=\"")).and_then(|(_, r)| r.split_once('"')).unwrap().0.to_owned();
    let nodes: Vec<String> = xml
        .split("<node ")
        .skip(1)
        .map(|n| format!(r#"{{"type":"node","id":{},"lat":{},"lon":{}}}"#, number(n, "id"), number(n, "lat"), number(n, "lon")))
        .collect();
    let json = format!(
        r#"{{"version":0.6,"elements":[{},{{"type":"way","id":{house},"nodes":[1,2,3,4,1],"tags":{{"building":"yes"}}}}]}}"#,
        nodes.join(",")
    );
    let expected = map.survey();
    for bytes in [packed.as_slice(), json.as_bytes()] {
        assert!(looks_like_osm(bytes));
        assert_eq!(survey_osm(bytes, "tiny.osm").unwrap(), expected);
    }
}

#[test]
fn far_vertices_do_not_matter_but_are_told() {
    let mut map = Map::default();
    grid(&mut map);
    map.line(&[(60.0, 60.0), (40_000.0, 9_000.0)], &[("highway", "service")]);
    let survey = map.survey();
    let far = survey.graph.nodes.iter().map(|n| n.pos.abs().max_element()).fold(0.0, f64::max);
    assert!(far < 400.0, "{far}");
    assert!(told(&survey, Severity::Repaired, "cut off at the extent's border"), "{:?}", survey.findings);
}
