//! What visitors type, and what they mean: `search/old_prague.tsv` was written before the ranking was tuned.

use std::path::Path;

use veduta_city::{CityGraph, Guide, file};
use veduta_route::{Finder, Named};

/// Of all queries at least this share finds first what is meant.
const FOUND_FIRST: f64 = 0.95;

fn scene(name: &str) -> std::path::PathBuf {
    Path::new("../../scenes/old_prague").join(name)
}

#[test]
fn what_is_meant_comes_first() {
    let graph: CityGraph = file::read(&scene("old_prague.graph.ron")).expect("the sample city's graph");
    let guide: Guide = file::read(&scene("old_prague.guide.ron")).expect("the sample city's guide");
    let mut named: Vec<Named> = graph.places.iter().map(|place| Named::place(place, guide.of(&place.name))).collect();
    for link in graph.links.iter().filter(|link| !link.name.is_empty()) {
        let at = graph.nodes.iter().find(|node| node.id == link.from).map_or_else(Default::default, |node| node.pos);
        if !named.iter().any(|known| known.names[0] == link.name) {
            named.push(Named::street(&link.name, at));
        }
    }
    let finder = Finder::new(named);
    let queries = include_str!("search/old_prague.tsv").lines().skip(1);
    let (mut all, mut missed) = (0, Vec::new());
    for line in queries {
        let (query, meant) = line.split_once('\t').expect("two columns");
        let hits = finder.find(query, None, 5);
        let found: Vec<&str> = hits.iter().map(|hit| finder.named()[hit.index].names[0].as_str()).collect();
        all += 1;
        if !found.first().is_some_and(|first| meant.split('|').any(|meant| meant == *first)) {
            missed.push(format!("{query}: {meant}, found {found:?}"));
        }
    }
    let share = 1.0 - missed.len() as f64 / f64::from(all);
    println!("{all} queries, {:.1} % find first what is meant; others:\n{}", share * 100.0, missed.join("\n"));
    assert!(all == 300 && share >= FOUND_FIRST, "{all} queries, {share:.3} found first:\n{}", missed.join("\n"));
}
