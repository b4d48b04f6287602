use std::collections::{HashMap, HashSet};

use glam::DVec2;
use veduta_city::{CityGraph, Finding, Id, Severity};

use super::ElevationGrid;
use super::posts::posts;
use super::sample::Sample;
use super::spread::spread;
use crate::log::Log;

/// Lays a city on a terrain model: [`CityGraph::terrain`] gets the ground under and around the city, and every node its
/// elevation `z`, in hundredths of a metre above the city's zero.
///
/// The posts of the terrain stand as far apart as the model's cells, but at least 4 m and at most 32 m (farther in cities of
/// more than four million posts). Where the model tells nothing they take the heights around.
///
/// The zero is the lowest elevation of a node on the ground, rounded down to a whole metre above the sea; it is kept in
/// [`CityGraph::zero_m`], so that `zero_m + z` is the elevation in the terrain model. Draping again, on the same or another
/// model, starts anew.
///
/// Nodes all of whose links run on another layer (in the middle of a bridge, in a tunnel) do not follow the ground: they rise
/// evenly between the ends. So do nodes outside of the grid or in a large hole of it, which are reported. Cells that stand out
/// of their surroundings as no ground does are reported, and passed over.
///
/// If no node lies in the grid, nothing is changed and the only finding says so; [`ElevationGrid::check_covers`] makes an
/// error of it.
pub fn drape(graph: &mut CityGraph, terrain: &ElevationGrid) -> Vec<Finding> {
    if let Err(error) = terrain.check_covers(graph) {
        return vec![Finding::new(Severity::Dropped, Id::NONE, None, format!("{error}: elevations stay as they were"))];
    }
    let (sampler, told) = terrain.without_spikes(graph);
    let mut log = Log::default();
    told.into_iter().for_each(|f| log.push(f));
    let aloft = nodes_off_the_ground(graph);
    let mut heights: Vec<Option<f64>> = Vec::with_capacity(graph.nodes.len());
    for node in &graph.nodes {
        let pixel = terrain.pixel_from_plan(graph.anchor, node.pos);
        let sample = pixel.map_or(Sample::Outside, |p| sampler.at(p));
        let is_aloft = aloft.contains(&node.id);
        if let Some(message) = lack(sample, terrain.name()).filter(|_| !is_aloft) {
            let severity = if sample.height_m().is_some() { Severity::Note } else { Severity::Repaired };
            log.tally(severity, node.id, Some(node.pos), message);
        }
        heights.push(sample.height_m().filter(|_| !is_aloft));
    }
    let lowest = heights.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    if !lowest.is_finite() {
        let message = format!("no node stands on ground that {} knows: elevations stay as they were", terrain.name());
        log.dropped(Id::NONE, Some(DVec2::ZERO), message);
        return log.finish();
    }
    spread(graph, &mut heights);
    graph.zero_m = lowest.floor();
    let zero = graph.zero_m;
    for (node, height) in graph.nodes.iter_mut().zip(heights) {
        node.z = height.map_or(0.0, |h| libm::round((h - zero) * 100.0) / 100.0);
    }
    graph.terrain = posts(graph, terrain, &sampler, zero).map(|(ground, lacking)| {
        if lacking > 0 {
            let name = terrain.name();
            let message = format!("{lacking} posts of the ground lie where {name} tells nothing: they take the heights around");
            log.note(Id::NONE, None, message);
        }
        ground
    });
    log.finish()
}

/// What is missing at a node.
fn lack(sample: Sample, name: &str) -> Option<String> {
    match sample {
        Sample::Height(_) => None,
        Sample::Filled(_) => Some(format!("nodes lie in holes of {name}, which were filled from around them")),
        Sample::Hole => Some(format!("nodes lie in a large hole of {name}: their elevation is guessed from the nodes around")),
        Sample::Outside => Some(format!("nodes lie outside of {name}: their elevation is guessed from the nodes around")),
    }
}

/// Nodes where links end, and all of them on bridges or in tunnels.
fn nodes_off_the_ground(graph: &CityGraph) -> HashSet<Id> {
    let mut is_aloft: HashMap<Id, bool> = HashMap::new();
    for link in &graph.links {
        for end in [link.from, link.to] {
            *is_aloft.entry(end).or_insert(true) &= link.layer != 0;
        }
    }
    is_aloft.into_iter().filter(|(_, aloft)| *aloft).map(|(id, _)| id).collect()
}
