#![no_main]

use libfuzzer_sys::fuzz_target;
use veduta_city::{CityGraph, GraphOverrides, file};

/// A street, a square, a block and a house for the edits to find.
const GRAPH: &str = "(name: \"T\", anchor: (lat: 50, lon: 14), nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (90, 0))],
    links: [(id: 5, from: 1, to: 2, kind: Street(Lane), name: \"Karlova\")],
    squares: [(id: 6, outline: [(0, 10), (20, 10), (20, 30)])],
    blocks: [(id: 7, outline: [(30, 10), (60, 10), (60, 30)])],
    buildings: [(id: 8, outline: [(31, 11), (40, 11), (40, 20)])])";

fuzz_target!(|bytes: &[u8]| {
    let Ok(overrides) = file::parse_bytes::<GraphOverrides>(bytes, "fuzz") else { return };
    let _ = overrides.validate();
    let mut graph: CityGraph = file::parse(GRAPH, "graph").expect("written here");
    let _ = overrides.apply(&mut graph);
    let _ = graph.validate();
});
