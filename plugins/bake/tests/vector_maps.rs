//! Vector maps by the program: several files as layers, a folder of them, a `.map.ron`, dates and GeoJSON out.

use std::path::Path;
use std::process::Command;

use veduta_bake::{BakeError, Input, InputKind, survey_bare};

#[path = "shared/folder.rs"]
mod folder;

use folder::Folder;

fn run(arguments: &[&Path]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_veduta-bake")).args(arguments).output().unwrap_or_else(|e| panic!("{e}"));
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    (output.status.code().unwrap_or(-1), text(output.stdout), text(output.stderr))
}

const STREETS: &str = r#"{"type":"FeatureCollection","features":[
 {"type":"Feature","properties":{"NAZEV":"Dlouhá"},"geometry":{"type":"LineString","coordinates":[[14.4,50.0],[14.402,50.0]]}},
 {"type":"Feature","properties":{"NAZEV":"Krátká"},"geometry":{"type":"LineString","coordinates":[[14.401,49.9995],[14.401,50.0005]]}}]}"#;
const BUILDINGS: &str = r#"{"type":"FeatureCollection","features":[
 {"type":"Feature","properties":{"end_date":"1900"},"geometry":{"type":"Polygon","coordinates":[[[14.4002,50.0001],[14.4004,50.0001],[14.4004,50.0002],[14.4002,50.0002],[14.4002,50.0001]]]}},
 {"type":"Feature","properties":{"start_date":"1901"},"geometry":{"type":"Polygon","coordinates":[[[14.4002,50.0001],[14.4004,50.0001],[14.4004,50.0003],[14.4002,50.0003],[14.4002,50.0001]]]}},
 {"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[[[14.4012,50.0001],[14.4014,50.0001],[14.4014,50.0002],[14.4012,50.0002],[14.4012,50.0001]]]}}]}"#;

#[test]
fn files_a_folder_and_a_map_file_are_one_city() {
    let folder = Folder::new("layers");
    let (streets, buildings) = (folder.write("streets.geojson", STREETS), folder.write("buildings.geojson", BUILDINGS));
    let graph = |input: Result<Input, BakeError>| {
        let input = input.unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(input.kind, InputKind::Vector);
        (survey_bare(&input).unwrap_or_else(|e| panic!("{e}")).0, input.files())
    };
    let (of_files, files) = graph(Input::of_all(&[streets.clone(), buildings.clone()]));
    assert_eq!((of_files.links.len(), of_files.buildings.len(), files.len()), (4, 2, 2));
    let (of_folder, _) = graph(Input::of(&folder.0));
    assert_eq!((of_folder.links.clone(), of_folder.buildings.clone()), (of_files.links, of_files.buildings));
    let text = "(layers: [(file: \"streets.geojson\", holds: Street(Main)), (file: \"buildings.geojson\")],\n \
                mapping: (city: \"Ves\", name: [\"NAZEV\"]), date: \"1876\")";
    let map = folder.write("ves.map.ron", text);
    let (of_map, files) = graph(Input::of(&map));
    assert_eq!((of_map.name.as_str(), of_map.buildings.len(), files.len()), ("Ves", 2, 3));
    assert!(of_map.links.iter().any(|l| l.name == "Dlouhá" && l.width() == 14.0), "{:?}", of_map.links);
    assert_eq!(Input::of(&folder.0).unwrap_or_else(|e| panic!("{e}")).path, map, "a folder's map file is its map");
}

#[test]
fn the_program_takes_layers_a_mapping_and_a_date_and_writes_geojson() {
    let folder = Folder::new("program");
    let (streets, buildings) = (folder.write("streets.geojson", STREETS), folder.write("buildings.geojson", BUILDINGS));
    let mapping = folder.write("ves.mapping.ron", "(name: [\"NAZEV\"])");
    let [graph, geojson, city] = ["ves.graph.ron", "out.json", "ves.city"].map(|name| folder.0.join(name));
    let word = Path::new;
    let (code, out, err) = run(&[
        word("survey"),
        &streets,
        &buildings,
        word("--mapping"),
        &mapping,
        word("--date"),
        word("1876-05"),
        word("-o"),
        &graph,
        word("--geojson"),
        &geojson,
    ]);
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("4 links, 2 buildings"), "{out}");
    assert!(err.contains("did not stand yet"), "{err}");
    let written = std::fs::read_to_string(&geojson).unwrap_or_else(|e| panic!("{e}"));
    assert!(written.contains("\"kind\":\"crossroads\"") && written.contains("\"name\":\"Krátká\""), "{written}");
    let (code, out, err) = run(&[word("bake"), &geojson, word("-o"), &city]);
    assert_eq!((code, out.contains("2 houses")), (0, true), "{out}{err}");
}

#[test]
fn mistakes_name_the_file_and_the_fix() {
    let folder = Folder::new("mistakes");
    let streets = folder.write("streets.geojson", STREETS);
    let error = |input: Result<Input, BakeError>| input.err().map(|e| e.to_string()).unwrap_or_default();
    let graph = folder.write("x.graph.ron", "(name: \"T\", anchor: (lat: 50, lon: 14))");
    assert!(error(Input::of_all(&[streets.clone(), graph.clone()])).contains("x.graph.ron: several inputs are the layers"));
    let bad = folder.write("bad.map.ron", "(\n layers: [(file: \"a\", hold: Plot)],\n)");
    assert!(error(Input::of(&bad)).contains("bad.map.ron:2:"), "{}", error(Input::of(&bad)));
    let empty = folder.write("empty.map.ron", "(layers: [])");
    assert!(error(Input::of(&empty)).contains("names no file"));
    let odd = folder.write("odd.map.ron", "(layers: [(file: \"streets.geojson\")], date: \"soon\")");
    assert!(error(Input::of(&odd)).contains("`soon` is no date"));
    let mut input = Input::of(&graph).unwrap_or_else(|e| panic!("{e}"));
    let date = "1876".parse().unwrap_or_else(|e| panic!("{e}"));
    assert!(input.set_date(date).is_err_and(|e| e.to_string().contains("for vector maps")));
    let missing = folder.write("missing.map.ron", "(layers: [(file: \"nowhere.shp\")])");
    let read = survey_bare(&Input::of(&missing).unwrap_or_else(|e| panic!("{e}")));
    assert!(read.is_err_and(|e| e.to_string().contains("nowhere.shp")));
}
