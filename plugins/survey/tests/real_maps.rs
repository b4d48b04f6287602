//! Every OpenStreetMap extract of the shared test data, through the public interface. `VEDUTA_DATA` names the folder; without
//! it `shared/data` beside the workspace is looked for, and where there is none the tests say so and pass.

use std::collections::{BTreeSet, HashMap};
use std::path::PathBuf;
use std::time::Instant;

use glam::DVec2;
use veduta_city::{BlockKind, CityGraph, Finding, Id, LinkKind};
use veduta_survey::{Survey, SurveyError, looks_like_osm, survey_osm};

/// A file and the least that must come out of it: links, named streets, buildings, parts, squares, objects, places, blocks
/// to build on.
struct Expected {
    file: &'static str,
    links: usize,
    named: usize,
    buildings: usize,
    parts: usize,
    squares: usize,
    objects: usize,
    places: usize,
    to_build: usize,
}

const fn least(file: &'static str, counts: [usize; 8]) -> Expected {
    let [links, named, buildings, parts, squares, objects, places, to_build] = counts;
    Expected { file, links, named, buildings, parts, squares, objects, places, to_build }
}

const CITIES: &[Expected] = &[
    least("munich_altstadt/munich_altstadt.osm.gz", [850, 80, 470, 100, 35, 450, 850, 0]),
    least("krems_donau/krems_2013.osm.gz", [1700, 150, 1180, 0, 0, 70, 240, 60]),
    least("lauf_pegnitz/lauf_an_der_pegnitz_2020.osm.pbf", [4800, 330, 6450, 25, 5, 370, 580, 0]),
    least("helsinki_centre/helsinki_centre_2019.osm.pbf", [10900, 205, 1390, 320, 95, 3200, 2900, 0]),
    least("rome_esquilino/rome_piazza_vittorio.osm.pbf", [2100, 70, 690, 50, 22, 280, 550, 0]),
    least("valletta/valletta_2016.osm.pbf", [1000, 140, 280, 0, 14, 180, 230, 80]),
    least("new_york_greenwich/nyc_greenwich_village_2015.osm.pbf", [285, 34, 1520, 45, 1, 1, 90, 0]),
    least("frederiksted_grid/frederiksted.osm.pbf", [100, 20, 320, 0, 0, 1, 25, 0]),
    least("marrakech_koutoubia/marrakech.osm.gz", [580, 17, 270, 40, 6, 110, 65, 5]),
    least("berlin_neukoelln/neukoelln.osm", [370, 7, 125, 80, 2, 290, 80, 0]),
    least("heidelberg_altstadt_roads/heidelberg_altstadt_roads.osm.pbf", [3800, 195, 3, 10, 25, 60, 70, 240]),
    least("prague_new_town_roads/prague_new_town_roads_2017.osm", [760, 165, 0, 0, 0, 15, 4, 150]),
    least("prague_karlovo_namesti_tiny/karlovo_namesti_2011.osm", [85, 2, 10, 0, 0, 3, 7, 2]),
    least("portland_dem/portland-central-filtered.osm.pbf", [14500, 600, 1, 0, 22, 70, 10, 2200]),
    least("osm_tiny/berlin_siegessaeule.osm.gz", [280, 7, 5, 20, 10, 250, 9, 1]),
    least("osm_tiny/tiny_roundabout.osm", [4, 1, 18, 0, 0, 0, 0, 0]),
    least("roof_shapes/roof_shapes_real.osm", [0, 0, 20, 0, 0, 0, 1, 0]),
];

fn data() -> Option<PathBuf> {
    let beside = "../../../shared/data";
    let folder = std::env::var_os("VEDUTA_DATA").map_or_else(|| PathBuf::from(beside), PathBuf::from);
    if !folder.is_dir() {
        println!("skipped: no shared data");
        return None;
    }
    Some(folder)
}

fn bytes(folder: &std::path::Path, file: &str) -> Vec<u8> {
    std::fs::read(folder.join(file)).unwrap_or_else(|e| panic!("{file}: {e}"))
}

fn named_streets(graph: &CityGraph) -> usize {
    let streets = graph.links.iter().filter(|l| matches!(l.kind, LinkKind::Street(_)) && !l.name.is_empty());
    streets.map(|l| l.name.as_str()).collect::<BTreeSet<_>>().len()
}

/// A row of the table that the test prints.
fn row(file: &str, survey: &Survey, ms: f64) -> String {
    let Survey { graph, findings } = survey;
    let count = |kind| graph.blocks.iter().filter(|b| b.kind == kind).count();
    format!(
        "| {} | {} | {} | {} | {} | {} | {}+{}+{} | {} | {} | {} | {ms:.0} |",
        file.split('/').next().unwrap_or(file),
        graph.links.len(),
        named_streets(graph),
        graph.buildings.len(),
        graph.buildings.iter().map(|b| b.parts.len()).sum::<usize>(),
        graph.squares.len(),
        count(BlockKind::Built),
        count(BlockKind::Park),
        count(BlockKind::Water),
        graph.objects.len(),
        graph.places.len(),
        findings.len(),
    )
}

#[test]
fn every_city_has_what_its_map_shows() {
    let Some(folder) = data() else { return };
    println!(
        "| file | links | named streets | buildings | parts | squares | blocks to build+parks+waters | objects | places | findings | ms |"
    );
    for expected in CITIES {
        let bytes = bytes(&folder, expected.file);
        assert!(looks_like_osm(&bytes), "{}", expected.file);
        let start = Instant::now();
        let survey = survey_osm(&bytes, expected.file).unwrap_or_else(|e| panic!("{e}"));
        println!("{}", row(expected.file, &survey, start.elapsed().as_secs_f64() * 1e3));
        check_counts(expected, &survey);
        check_graph(expected.file, &survey.graph);
        check_findings(expected.file, &survey.findings);
        check_dry_feet(expected.file, &survey.graph);
    }
}

fn check_counts(expected: &Expected, survey: &Survey) {
    let graph = &survey.graph;
    let to_build = graph.blocks.iter().filter(|b| b.kind == BlockKind::Built).count();
    let parts = graph.buildings.iter().map(|b| b.parts.len()).sum();
    for (what, got, least) in [
        ("links", graph.links.len(), expected.links),
        ("named streets", named_streets(graph), expected.named),
        ("buildings", graph.buildings.len(), expected.buildings),
        ("parts", parts, expected.parts),
        ("squares", graph.squares.len(), expected.squares),
        ("objects", graph.objects.len(), expected.objects),
        ("places", graph.places.len(), expected.places),
        ("blocks to build on", to_build, expected.to_build),
    ] {
        assert!(got >= least, "{}: {got} {what}, expected at least {least}", expected.file);
    }
    if expected.to_build == 0 {
        assert_eq!(to_build, 0, "{}: a map with its houses needs none grown", expected.file);
    }
}

fn check_graph(file: &str, graph: &CityGraph) {
    assert_eq!(graph.validate(), [], "{file}");
    assert!(graph.start.is_some() && !graph.name.is_empty(), "{file}");
    assert_eq!(graph.attribution, "© OpenStreetMap contributors, ODbL 1.0");
    for block in &graph.blocks {
        check_rings(file, block.id, &block.outline, &block.holes);
    }
    for square in &graph.squares {
        check_rings(file, square.id, &square.outline, &square.holes);
    }
    for building in &graph.buildings {
        check_rings(file, building.id, &building.outline, &building.holes);
        for part in &building.parts {
            check_rings(file, part.id, &part.outline, &part.holes);
        }
    }
    let at: HashMap<Id, DVec2> = graph.node_positions();
    for link in &graph.links {
        let line = graph.polyline(link, &at).expect("both ends are nodes");
        assert!(link.from != link.to && line.windows(2).all(|w| w[0] != w[1]), "{file}: {} repeats a vertex", link.id);
    }
}

/// Houses stand on land: a coast read the wrong way round would flood the town.
fn check_dry_feet(file: &str, graph: &CityGraph) {
    let waters: Vec<_> = graph.blocks.iter().filter(|b| b.kind == BlockKind::Water).collect();
    let inside = |ring: &[DVec2], p: DVec2| {
        let edges = ring.iter().zip(ring.iter().cycle().skip(1));
        edges.filter(|(a, b)| (a.y > p.y) != (b.y > p.y) && (p.y - a.y) / (b.y - a.y) * (b.x - a.x) + a.x > p.x).count() % 2 == 1
    };
    let is_wet = |p: DVec2| waters.iter().any(|w| inside(&w.outline, p) && !w.holes.iter().any(|h| inside(h, p)));
    let wet = graph.buildings.iter().filter(|b| is_wet(b.outline[0])).count();
    assert!(wet * 50 <= graph.buildings.len(), "{file}: {wet} of {} houses stand in water", graph.buildings.len());
}

fn signed_area(ring: &[DVec2]) -> f64 {
    let edges = ring.iter().zip(ring.iter().cycle().skip(1));
    edges.map(|(a, b)| (*a - ring[0]).perp_dot(*b - ring[0])).sum::<f64>() / 2.0
}

fn check_rings(file: &str, id: Id, outline: &[DVec2], holes: &[Vec<DVec2>]) {
    assert!(signed_area(outline) >= 1.0, "{file}: {id} is not counter-clockwise or smaller than a square metre");
    for ring in core::iter::once(outline).chain(holes.iter().map(Vec::as_slice)) {
        assert!(ring.len() >= 3 && ring.first() != ring.last(), "{file}: {id}");
        assert!(ring.windows(2).all(|w| w[0] != w[1]), "{file}: {id} repeats a vertex");
        assert!(!crosses_itself(ring), "{file}: {id} crosses itself");
    }
    for hole in holes {
        assert!(signed_area(hole) < 0.0, "{file}: a hole of {id} is not clockwise");
    }
}

/// Whether two edges cross in their inside, by more than rounding.
fn crosses_itself(ring: &[DVec2]) -> bool {
    let edges: Vec<(DVec2, DVec2)> = ring.iter().copied().zip(ring.iter().copied().cycle().skip(1)).collect();
    let side = |a: DVec2, b: DVec2, p: DVec2| (b - a).perp_dot(p - a) / (b - a).length();
    let apart = |x: f64, y: f64| x.min(y) < -1e-4 && x.max(y) > 1e-4;
    edges.iter().enumerate().any(|(i, &(a, b))| {
        let (low, high) = (a.min(b), a.max(b));
        edges[i + 1..].iter().any(|&(c, d)| {
            c.max(d).cmpge(low).all()
                && c.min(d).cmple(high).all()
                && apart(side(a, b, c), side(a, b, d))
                && apart(side(c, d, a), side(c, d, b))
        })
    })
}

fn check_findings(file: &str, findings: &[Finding]) {
    for finding in findings {
        assert!(finding.message.len() > 12 && !finding.message.ends_with('.'), "{file}: {finding}");
        assert!(finding.message.chars().all(|c| !c.is_control()), "{file}: {finding:?}");
    }
    let all: BTreeSet<String> = findings.iter().map(ToString::to_string).collect();
    assert_eq!(all.len(), findings.len(), "{file}: a finding is told twice");
}

#[test]
fn the_same_bytes_give_the_same_survey() {
    let Some(folder) = data() else { return };
    let bytes = bytes(&folder, "munich_altstadt/munich_altstadt.osm.gz");
    let [a, b] = [(); 2].map(|()| survey_osm(&bytes, "munich.osm.gz").expect("it is whole"));
    assert_eq!(a, b);
}

#[test]
fn a_file_cut_anywhere_fails_by_name() {
    let Some(folder) = data() else { return };
    for Expected { file, .. } in CITIES {
        let bytes = bytes(&folder, file);
        for part in [2, 5, 9] {
            let cut = &bytes[..bytes.len() * part / 10 + usize::from(part == 2)];
            let error = survey_osm(cut, file).err().unwrap_or_else(|| panic!("{file} passed with {part} tenths"));
            assert!(matches!(error, SurveyError::Cut { .. } | SurveyError::Broken { .. }), "{error}");
            assert!(error.to_string().starts_with(file), "{error}");
        }
        let error = survey_osm(&bytes[..bytes.len() - 1], file);
        assert!(file.ends_with(".osm") || error.is_err(), "{file} passed without its last byte");
    }
}

#[test]
fn bytes_turned_over_never_panic() {
    let Some(folder) = data() else { return };
    for file in [
        "frederiksted_grid/frederiksted.osm.pbf",
        "prague_karlovo_namesti_tiny/karlovo_namesti_2011.osm",
        "marrakech_koutoubia/marrakech.osm.gz",
    ] {
        let whole = bytes(&folder, file);
        for i in 0..40_usize {
            let mut damaged = whole.clone();
            let at = (i * 7919 + 13) * 104_729 % whole.len();
            damaged[at] ^= 1 << (i % 8);
            if let Ok(survey) = survey_osm(&damaged, file) {
                assert_eq!(survey.graph.validate(), [], "{file} with byte {at} turned over");
            }
        }
    }
}

#[test]
fn single_buildings_are_models_and_broken_outlines_are_findings() {
    let Some(folder) = data() else { return };
    let mut seen = 0;
    for entry in std::fs::read_dir(folder.join("roof_shapes/osmbuilding_tests")).expect("the folder is there") {
        let path = entry.expect("it can be read").path();
        let name = path.file_name().and_then(|n| n.to_str()).expect("a plain name").to_owned();
        let bytes = std::fs::read(&path).expect("it can be read");
        let survey = survey_osm(&bytes, &name).unwrap_or_else(|e| panic!("{e}"));
        check_graph(&name, &survey.graph);
        assert!(!survey.graph.buildings.is_empty(), "{name}");
        seen += 1;
    }
    assert!(seen >= 15, "{seen} files");
    // Test cases 11 km apart are no city: one of them may be, and the rest are told.
    match survey_osm(&bytes(&folder, "osm_tiny/osm_testdata_grid_all.osm"), "grid.osm") {
        Ok(grid) => assert!(grid.findings.iter().any(|f| f.message.contains("scattered"))),
        Err(error) => assert!(matches!(&error, SurveyError::Empty { .. }) && error.to_string().contains("scattered"), "{error}"),
    }
    let tests = bytes(&folder, "osm_tiny/osm_testdata_grid_tests.json");
    assert!(matches!(survey_osm(&tests, "tests.json"), Err(SurveyError::NotOsm { .. })));
}
