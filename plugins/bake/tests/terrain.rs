//! `veduta-bake survey` with a terrain and a surface model: what is written, and what is refused.

use std::path::{Path, PathBuf};
use std::process::Command;

use veduta_city::{CityGraph, file};

#[path = "shared/folder.rs"]
mod folder;

use folder::Folder;

fn survey(out: &Path, models: &[(&str, &Path)]) -> (i32, String) {
    let map = PathBuf::from("tests/places/crossroads/crossroads.osm");
    let mut command = Command::new(env!("CARGO_BIN_EXE_veduta-bake"));
    command.arg("survey").arg(map).arg("-o").arg(out);
    for (option, path) in models {
        command.arg(option).arg(path);
    }
    let output = command.output().unwrap_or_else(|e| panic!("{e}"));
    (output.status.code().unwrap_or(-1), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// A grid of 0.2 x 0.2 degrees around the map that rises to the east, raised.
fn grid(graph: &CityGraph, raised_m: f64) -> String {
    let (south, west) = (graph.anchor.lat - 0.1, graph.anchor.lon - 0.1);
    let mut text = format!("ncols 2000\nnrows 20\nxllcorner {west}\nyllcorner {south}\ndx 0.0001\ndy 0.01\n");
    for _ in 0..20 {
        (0..2000).for_each(|i| text += &format!("{:.2} ", 300.0 + raised_m + 0.1 * f64::from(i)));
        text += "\n";
    }
    text
}

#[test]
fn the_graph_that_is_written_has_elevations() {
    let folder = Folder::new("drape");
    let out = folder.0.join("a.graph.ron");
    let (code, err) = survey(&out, &[]);
    assert_eq!(code, 0, "{err}");
    let flat: CityGraph = file::read(&out).unwrap_or_else(|e| panic!("{e}"));
    assert!(flat.zero_m == 0.0 && flat.nodes.iter().all(|n| n.z == 0.0));

    let hill = folder.write("hill.asc", &grid(&flat, 0.0));
    let (code, err) = survey(&out, &[("--terrain", &hill)]);
    assert!(code == 1 && err.contains("hill.asc cannot be placed") && err.contains(".prj"), "{code}: {err}");
    folder.write("hill.prj", "EPSG:4326\n");
    let (code, err) = survey(&out, &[("--terrain", &hill)]);
    assert_eq!(code, 0, "{err}");
    let draped: CityGraph = file::read(&out).unwrap_or_else(|e| panic!("{e}"));
    // The anchor lies in the middle: a thousand columns of a tenth of a metre each from the western edge.
    let column_m = flat.anchor.plan_from_geo(flat.anchor.lat, flat.anchor.lon + 0.0001).x;
    for node in &draped.nodes {
        let expected = 300.0 + 0.1 * (999.5 + node.pos.x / column_m);
        assert!((draped.zero_m + node.z - expected).abs() < 0.02, "{node:?}: {expected}");
    }
    assert!(draped.nodes.iter().any(|n| n.z > 0.5) && draped.nodes.iter().all(|n| n.z >= 0.0));
}

#[test]
fn models_of_elsewhere_and_of_nothing_are_refused() {
    let folder = Folder::new("refused");
    let out = folder.0.join("a.graph.ron");
    folder.write("far.prj", "EPSG:4326");
    let far = folder.write("far.asc", "ncols 2\nnrows 2\nxllcorner 100\nyllcorner 10\ncellsize 0.01\n1 2\n3 4\n");
    for option in ["--terrain", "--surface"] {
        let (code, err) = survey(&out, &[(option, &far)]);
        assert!(code == 1 && err.contains("far.asc covers latitudes 10.0000 to 10.0200"), "{code}: {err}");
    }
    let text = folder.write("letter.txt", "Dear all");
    let (code, err) = survey(&out, &[("--terrain", &text)]);
    assert!(code == 1 && err.contains("letter.txt is neither an ESRI ASCII grid"), "{code}: {err}");
    let (code, err) = survey(&out, &[("--terrain", &folder.0.join("none.tif"))]);
    assert!(code == 1 && err.contains("none.tif"), "{code}: {err}");
    assert!(!out.exists(), "nothing is written");
}
