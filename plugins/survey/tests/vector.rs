//! Vector maps through the public interface: rules on maps of a few features, and the shared data.

use std::path::PathBuf;

use veduta_city::{BlockKind, CityGraph, Finding, LinkKind, NodeKind, Severity, StreetClass};
use veduta_survey::{Date, GeoJsonSettings, Kind, Layer, Mapping, Survey, SurveyError, survey_vector, to_geojson};

/// A feature of GeoJSON.
fn feature(properties: &str, kind: &str, coordinates: &str) -> String {
    format!(r#"{{"type":"Feature","properties":{{{properties}}},"geometry":{{"type":"{kind}","coordinates":{coordinates}}}}}"#)
}

fn collection(features: &[String]) -> String {
    format!(r#"{{"type":"FeatureCollection","attribution":"A & B","features":[{}]}}"#, features.join(","))
}

fn layer<'a>(name: &'a str, text: &'a str) -> Layer<'a> {
    Layer { name, bytes: text.as_bytes(), ..Layer::default() }
}

fn surveyed(layers: &[Layer<'_>], date: Option<&str>) -> Survey {
    let date: Option<Date> = date.map(|d| d.parse().unwrap());
    survey_vector(layers, &Mapping::default(), date.as_ref(), "town").unwrap_or_else(|e| panic!("{e}"))
}

fn told(findings: &[Finding], words: &str) -> bool {
    findings.iter().any(|f| f.message.contains(words))
}

/// Plan coordinates about no anchor, so that positions can be read off.
fn plan(features: &[String]) -> String {
    let all = features.join(",");
    format!(r#"{{"type":"FeatureCollection","map":{{"extent_m":[300,300]}},"features":[{all}]}}"#)
}

const SQUARE_OF_STREETS: [&str; 4] = ["[[0,0],[0,80]]", "[[-10,70],[110,70]]", "[[100,0],[100,80]]", "[[-10,10],[110,10]]"];

fn ring_of_streets() -> Vec<String> {
    SQUARE_OF_STREETS.iter().map(|line| feature(r#""highway":"residential""#, "LineString", line)).collect()
}

#[test]
fn streets_in_plan_metres_stay_where_they_are_and_enclose_a_block() {
    let text = plan(&ring_of_streets());
    let Survey { graph, .. } = surveyed(&[layer("streets.geojson", &text)], None);
    let kinds = graph.node_kinds();
    let count = |kind: NodeKind| graph.nodes.iter().filter(|n| kinds[&n.id] == kind).count();
    assert_eq!((count(NodeKind::Crossroads), count(NodeKind::BlindAlley), graph.links.len()), (4, 8, 12));
    let crossing = graph.nodes.iter().map(|n| n.pos).find(|p| p.distance(glam::DVec2::new(100.0, 70.0)) < 1e-3);
    assert!(crossing.is_some(), "{:?}", graph.nodes);
    assert_eq!(graph.blocks.iter().filter(|b| b.kind == BlockKind::Built).count(), 1);
}

#[test]
fn plots_make_blocks_up_to_the_building_line() {
    let streets = plan(&ring_of_streets());
    let plots = plan(&[
        feature(r#""fid":1"#, "Polygon", "[[[5,15],[50,15],[50,65],[5,65],[5,15]]]"),
        feature(r#""fid":2"#, "Polygon", "[[[50,15],[95,15],[95,65],[50,65],[50,15]]]"),
        feature(r#""fid":3"#, "Polygon", "[[[-5,-5],[5,-5],[5,85],[-5,85],[-5,-5]]]"),
    ]);
    let Survey { graph, findings } = surveyed(&[layer("streets.geojson", &streets), layer("plots.geojson", &plots)], None);
    let [block] = graph.blocks.as_slice() else { panic!("{:?}", graph.blocks) };
    let (low, high) =
        block.outline.iter().fold((glam::DVec2::INFINITY, glam::DVec2::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    assert!(low.distance(glam::DVec2::new(5.0, 15.0)) < 0.05 && high.distance(glam::DVec2::new(95.0, 65.0)) < 0.05, "{low} {high}");
    assert!(told(&findings, "3 plots: 1 are streets, 2 hold no house"), "{findings:?}");
}

#[test]
fn houses_without_streets_are_a_city() {
    let houses = collection(&[
        feature(
            r#""height":12.5,"names":{"primary":"Town Hall"}"#,
            "Polygon",
            "[[[14,50],[14.0002,50],[14.0002,50.0001],[14,50.0001],[14,50]]]",
        ),
        feature(r#""num_floors":3"#, "Polygon", "[[[14.001,50],[14.0012,50],[14.0012,50.0001],[14.001,50.0001],[14.001,50]]]"),
    ]);
    let Survey { graph, .. } = surveyed(&[layer("buildings.geojson", &houses)], None);
    assert_eq!((graph.buildings.len(), graph.links.len(), graph.attribution.as_str()), (2, 0, "A & B"));
    let mut told: Vec<_> = graph.buildings.iter().map(|b| (b.name.as_str(), b.height_m, b.levels)).collect();
    told.sort_by_key(|(name, ..)| *name);
    assert_eq!(told, [("", None, Some(3.0)), ("Town Hall", Some(12.5), None)]);
}

#[test]
fn a_date_chooses_what_stands() {
    let house = |x: u32, dates: &str| {
        let ring = format!("[[[14.{x:03},50],[14.{x:03}2,50],[14.{x:03}2,50.0001],[14.{x:03},50.0001],[14.{x:03},50]]]");
        feature(&format!(r#""building":"yes"{dates}"#), "Polygon", &ring)
    };
    let town = collection(&[
        house(1, r#","start_date":"1841","end_date":"1876""#),
        house(2, r#","start_date":"1877""#),
        house(3, r#","start_date":"~1850/1860","end_date":"..""#),
        house(4, r#","start_date":"once upon a time""#),
        house(5, ""),
    ]);
    let successor = town.replace("1877", "1876").replace("14.002", "14.001");
    let both: Survey = surveyed(&[layer("town.geojson", &successor)], Some("1876"));
    assert_eq!(both.graph.buildings.len(), 4, "the house of 1876 stands in place of that which went in 1876");
    let count = |date: Option<&str>| surveyed(&[layer("town.geojson", &town)], date).graph.buildings.len();
    assert_eq!((count(Some("1840")), count(Some("1876")), count(Some("1877-05")), count(None)), (2, 4, 4, 4));
    let findings = surveyed(&[layer("town.geojson", &town)], Some("1840")).findings;
    assert!(told(&findings, "start_date=\"once upon a time\" is no date"), "{findings:?}");
    assert!(told(&findings, "of 3 features with dates 3 did not stand yet and 0 stood no more in 1840"), "{findings:?}");
}

#[test]
fn what_says_nothing_is_told_and_a_layer_may_be_named() {
    let town = collection(&[feature(r#""class":"zoning""#, "Polygon", "[[[14,50],[14.0002,50],[14.0002,50.0001],[14,50]]]")]);
    let error = survey_vector(&[layer("stuff.geojson", &town)], &Mapping::default(), None, "town").unwrap_err().to_string();
    assert!(error.contains("class=\"zoning\"") && error.contains("mapping"), "{error}");
    let holds = Layer { holds: Some(Kind::Building), ..layer("stuff.geojson", &town) };
    assert_eq!(surveyed(&[holds], None).graph.buildings.len(), 1);
}

#[test]
fn a_layer_that_is_no_map_is_refused_by_name() {
    let error = |layer: Layer<'_>| survey_vector(&[layer], &Mapping::default(), None, "x").unwrap_err();
    assert!(matches!(error(layer("a.zip", "PK")), SurveyError::NotVector { name } if name == "a.zip"));
    assert!(matches!(error(layer("a.geojson", "{\"type\":\"FeatureCollection\",\"features\":[")), SurveyError::Cut { .. }));
    let mapping = Mapping { snap_m: -1.0, ..Mapping::default() };
    assert!(matches!(survey_vector(&[], &mapping, None, "x"), Err(SurveyError::Mapping { .. })));
    assert!(matches!(survey_vector(&[], &Mapping::default(), None, "x"), Err(SurveyError::Empty { .. })));
}

#[test]
fn a_graph_comes_back_from_its_own_geojson() {
    let streets = plan(&ring_of_streets());
    let first = surveyed(&[layer("streets.geojson", &streets)], None).graph;
    let text = to_geojson(&first, &GeoJsonSettings::default());
    let again = surveyed(&[layer("again.geojson", &text)], None).graph;
    let ends = |g: &CityGraph| {
        let mut all: Vec<[i64; 2]> = g.nodes.iter().map(|n| [n.pos.x, n.pos.y].map(|v| (v * 100.0).round() as i64)).collect();
        all.sort_unstable();
        all
    };
    assert_eq!((ends(&first), first.links.len(), first.blocks.len()), (ends(&again), again.links.len(), again.blocks.len()));
    assert!(again.links.iter().all(|l| l.kind == LinkKind::Street(StreetClass::Street)));
    let degrees = to_geojson(&first, &GeoJsonSettings { degrees: true, ..GeoJsonSettings::default() });
    assert_eq!(surveyed(&[layer("again.geojson", &degrees)], None).graph.links.len(), first.links.len());
}

#[test]
fn the_order_of_features_changes_nothing() {
    let mut features = ring_of_streets();
    let first = surveyed(&[layer("a.geojson", &plan(&features))], None).graph;
    features.reverse();
    let again = surveyed(&[layer("a.geojson", &plan(&features))], None).graph;
    let ids = |g: &CityGraph| {
        let mut ids: Vec<_> = g.links.iter().map(|l| l.id).collect();
        ids.sort_unstable();
        ids
    };
    assert_eq!(ids(&first), ids(&again));
}

/// Folder of the shared test data; says so if there is none.
fn data() -> Option<PathBuf> {
    let beside = "../../../shared/data";
    let folder = std::env::var_os("VEDUTA_DATA").map_or_else(|| PathBuf::from(beside), PathBuf::from);
    if !folder.is_dir() {
        println!("skipped: no shared data");
        return None;
    }
    Some(folder)
}

fn real(files: &[&str], date: Option<&str>) -> Option<Survey> {
    let folder = data()?;
    let read = |file: &&str| (file.rsplit('/').next().unwrap_or(file).to_owned(), std::fs::read(folder.join(file)).unwrap());
    let content: Vec<(String, Vec<u8>)> = files.iter().map(read).collect();
    let layers: Vec<Layer<'_>> = content.iter().map(|(name, bytes)| Layer { name, bytes, ..Layer::default() }).collect();
    let survey = surveyed(&layers, date);
    for finding in survey.findings.iter().filter(|f| f.severity != Severity::Repaired).take(40) {
        println!("{finding}");
    }
    assert!(survey.graph.validate().is_empty());
    Some(survey)
}

#[test]
fn bubenec_has_its_houses_streets_and_plots() {
    let files = ["buildings", "streets", "plots"].map(|l| format!("prague_bubenec/bubenec_{l}.geojson"));
    let Some(Survey { graph, findings }) = real(&files.each_ref().map(String::as_str), None) else { return };
    println!("{} nodes, {} links, {} blocks", graph.nodes.len(), graph.links.len(), graph.blocks.len());
    assert_eq!((graph.buildings.len(), graph.links.len() >= 35), (144, true));
    let kinds = graph.node_kinds();
    assert!(graph.nodes.iter().filter(|n| kinds[&n.id] == NodeKind::Crossroads).count() >= 10);
    // The houses are those of eight blocks; what else the plots make up is to be built on.
    assert!((12..=18).contains(&graph.blocks.len()));
    assert!(told(&findings, "404 plots"), "{findings:?}");
}

#[test]
fn towns_of_bohemia_stand_as_they_did() {
    for (file, then, now) in [
        ("kolin/kolin_ohm_historic", ("1876", 500..620), 580..640),
        ("boskovice/boskovice_ohm_historic", ("1870", 650..720), 670..710),
        ("pribor/pribor_ohm_historic", ("1850", 620..660), 640..660),
    ] {
        let file = format!("bohemian_town_{file}.geojson");
        let Some(old) = real(&[&file], Some(then.0)) else { return };
        let Some(new) = real(&[&file], None) else { return };
        println!("{file}: {} in {}, {} now", old.graph.buildings.len(), then.0, new.graph.buildings.len());
        assert!(then.1.contains(&old.graph.buildings.len()), "{file} in {}: {}", then.0, old.graph.buildings.len());
        assert!(now.contains(&new.graph.buildings.len()), "{file} now: {}", new.graph.buildings.len());
        assert!(!new.graph.links.is_empty());
    }
}
