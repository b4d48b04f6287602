//! Real terrain models under real cities. `VEDUTA_DATA` names the folder of the shared data; without it `shared/data` beside
//! the workspace is looked for, and where there is none the tests say so and pass.

use std::path::PathBuf;

use veduta_city::{CityGraph, Severity};
use veduta_survey::{Crs, ElevationGrid, drape, heights_from_surface, survey_osm};

fn data() -> Option<PathBuf> {
    let beside = "../../../shared/data";
    let folder = std::env::var_os("VEDUTA_DATA").map_or_else(|| PathBuf::from(beside), PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: no shared data");
    None
}

fn read(file: &str) -> Option<Vec<u8>> {
    let path = data()?.join(file);
    Some(std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display())))
}

fn city(file: &str) -> Option<CityGraph> {
    Some(survey_osm(&read(file)?, file).unwrap_or_else(|e| panic!("{file}: {e}")).graph)
}

fn grid(file: &str, prj: Option<&str>) -> Option<ElevationGrid> {
    let bytes = read(file)?;
    let name = file.rsplit('/').next().unwrap_or(file);
    Some(ElevationGrid::read(&bytes, name, prj).unwrap_or_else(|e| panic!("{file}: {e}")))
}

/// Least and greatest elevation of a city's nodes.
fn range_m(graph: &CityGraph) -> (f64, f64) {
    let all = graph.nodes.iter().map(|n| graph.zero_m + n.z);
    all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)))
}

/// The elevation of every node that stands on the ground is the grid's.
fn share_on_ground(graph: &CityGraph, terrain: &ElevationGrid) -> f64 {
    let is_ground = |n: &&veduta_city::Node| {
        let ground = terrain.at_plan(graph.anchor, n.pos);
        ground.is_some_and(|g| (graph.zero_m + n.z - g).abs() < 0.006)
    };
    graph.nodes.iter().filter(is_ground).count() as f64 / graph.nodes.len() as f64
}

#[test]
fn lauf_lies_on_its_srtm_tile() {
    let Some(mut graph) = city("lauf_pegnitz/lauf_an_der_pegnitz_2020.osm.pbf") else { return };
    let Some(terrain) = grid("dem_srtm_n49e011/N49E011.hgt.zip", None) else { return };
    assert_eq!((terrain.size(), *terrain.crs()), ((1201, 1201), Crs::WGS84));
    let findings = drape(&mut graph, &terrain);
    findings.iter().for_each(|f| println!("{f}"));
    let (low, high) = range_m(&graph);
    println!("{} nodes, {low:.2} to {high:.2} m, zero {}", graph.nodes.len(), graph.zero_m);
    assert!((300.0..325.0).contains(&low) && (395.0..430.0).contains(&high), "{low} to {high}");
    assert!(graph.nodes.len() > 2000 && graph.zero_m == low.floor());
    assert!(share_on_ground(&graph, &terrain) > 0.97, "{}", share_on_ground(&graph, &terrain));
    assert!(graph.validate().is_empty());
    assert!(findings.iter().all(|f| f.severity != Severity::Dropped), "{findings:?}");
    // Posts as they stand in the file.
    for (lat, lon, expected) in [(49.51, 11.28, 322.0), (49.5175, 11.29, 332.0), (49.5, 11.25, 331.0)] {
        let height = terrain.at(lat, lon);
        assert!(height.is_some_and(|h| (h - expected).abs() < 1e-3), "({lat}, {lon}): {height:?}");
    }
}

#[test]
fn portland_lies_on_its_geotiff() {
    let Some(mut graph) = city("portland_dem/portland-central-filtered.osm.pbf") else { return };
    let Some(terrain) = grid("portland_dem/portland-ned.tif", None) else { return };
    assert_eq!((terrain.size(), terrain.crs().to_string().as_str()), ((864, 648), "EPSG:4269"));
    assert_eq!(terrain.range_m(), (0.0, f64::from(328.11182_f32)));
    // Values of the cells by another reader, at their middles.
    let cell = |column: f64, row: f64| {
        let step = 9.259_259_259_26e-5;
        terrain.at(45.55 - (row + 0.5) * step, -122.71 + (column + 0.5) * step).unwrap_or(f64::NAN)
    };
    for (column, row, expected) in [(0.0, 0.0, 11.406_761), (1.0, 0.0, 11.180_642), (0.0, 1.0, 11.875_786)] {
        assert!((cell(column, row) - expected).abs() < 1e-3, "({column}, {row}): {}", cell(column, row));
    }
    let findings = drape(&mut graph, &terrain);
    findings.iter().for_each(|f| println!("{f}"));
    let (low, high) = range_m(&graph);
    println!("{} nodes, {low:.2} to {high:.2} m, zero {}", graph.nodes.len(), graph.zero_m);
    assert!((-0.5..6.0).contains(&low) && (200.0..329.0).contains(&high), "{low} to {high}");
    assert!(share_on_ground(&graph, &terrain) > 0.75, "{}", share_on_ground(&graph, &terrain));
    assert!(graph.validate().is_empty());
}

#[test]
fn bubenec_lies_in_prague() {
    let Some(prj) = read("prague_bubenec/bubenec_dtm_1m.prj") else { return };
    let Some(terrain) = grid("prague_bubenec/bubenec_dtm_1m.asc", std::str::from_utf8(&prj).ok()) else { return };
    assert_eq!((terrain.size(), terrain.crs().to_string().as_str()), ((592, 647), "EPSG:5514"));
    let (low, high) = terrain.range_m();
    assert!((187.0..190.0).contains(&low) && (220.0..223.0).contains(&high), "{low} to {high}");
    assert!((terrain.cell_m() - 1.0).abs() < 1e-3);
    // As PROJ and another interpolation have it; half a metre aside the terrain is a few centimetres higher or lower.
    for (lat, lon, expected) in [(50.1035, 14.4025, 211.845), (50.102, 14.405, 215.759), (50.1045, 14.4005, 211.201)] {
        let height = terrain.at(lat, lon);
        assert!(height.is_some_and(|h| (h - expected).abs() < 0.01), "({lat}, {lon}): {height:?}");
    }
    // Every vertex of the streets, which come from another source, lies on the terrain.
    let streets: serde_json::Value = serde_json::from_slice(&read("prague_bubenec/bubenec_streets.geojson").unwrap_or_default())
        .unwrap_or_else(|e| panic!("{e}"));
    let mut count = 0;
    for feature in streets["features"].as_array().into_iter().flatten() {
        let lines = &feature["geometry"]["coordinates"];
        let flat = if feature["geometry"]["type"] == "LineString" {
            vec![lines]
        } else {
            lines.as_array().into_iter().flatten().collect()
        };
        for pos in flat.into_iter().filter_map(|l| l.as_array()).flatten() {
            let (lon, lat) = (pos[0].as_f64().unwrap_or(f64::NAN), pos[1].as_f64().unwrap_or(f64::NAN));
            let height = terrain.at(lat, lon).unwrap_or_else(|| panic!("({lat}, {lon}) lies beside the terrain"));
            assert!((188.0..222.0).contains(&height), "({lat}, {lon}): {height}");
            count += 1;
        }
    }
    assert!(count > 100, "{count} vertices");
    let spikes = terrain.spikes((0, 0), terrain.size());
    println!("{count} vertices, {} spikes in {} cells", spikes.len(), 592 * 647);
    assert!(spikes.len() < 20, "{} cells of good terrain are called faults: {:?}", spikes.len(), spikes.first());
}

#[test]
fn a_city_elsewhere_is_refused_with_both_places() {
    let Some(graph) = city("portland_dem/portland-central-filtered.osm.pbf") else { return };
    let Some(terrain) = grid("dem_srtm_n49e011/N49E011.hgt.zip", None) else { return };
    let error = terrain.check_covers(&graph).unwrap_err().to_string();
    assert!(
        error.contains("N49E011.hgt") && error.contains("latitudes 48.9996 to 50.0004") && error.contains("latitude 45.5"),
        "{error}"
    );
}

#[test]
fn a_surface_of_bare_ground_gives_no_heights() {
    let Some(mut graph) = city("lauf_pegnitz/lauf_an_der_pegnitz_2020.osm.pbf") else { return };
    let Some(terrain) = grid("dem_srtm_n49e011/N49E011.hgt.zip", None) else { return };
    let given = graph.buildings.iter().filter(|b| b.height_m.is_some()).count();
    let findings = heights_from_surface(&mut graph, &terrain, Some(&terrain));
    assert!(
        findings.iter().any(|f| f.message.contains("fewer than 4 cells")),
        "cells of 75 m are too coarse for houses: {findings:?}"
    );
    assert!(graph.buildings.iter().filter(|b| b.height_m.is_some()).count() <= given + 5);
}
