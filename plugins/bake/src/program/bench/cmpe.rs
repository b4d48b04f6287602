//! The largest case of *Urban procedural modeling for real-time rendering* (CMPE, Carrozzino and others, 2009, its table of
//! times): a map of 4096 × 4096 pixels, about 3,170 straight links, about 770,000 triangles. Here it is a drawn map of that
//! size, cut to so many links about its middle; the graph is grown, and its ground and houses are meshed, so many of these
//! in full detail, the others as volumes, that there are as many triangles.

use std::collections::HashSet;
use std::path::Path;

use glam::DVec2;
use rayon::prelude::*;
use veduta_bake::{Input, survey};
use veduta_city::{BlockKind, CellShell, CityGraph, CityPlan, FacadeSheet, House, HouseShell, Id, VolumeShell};
use veduta_growth::mesh::{self, MeshError};
use veduta_growth::plan::{Stock, grow};

use super::figures::Kind;
use super::growth::{best, triangles};
use super::programs::{Map, Programs};
use crate::program::Failure;

/// Straight pieces of streets.
const LINKS: usize = 3_170;
const TRIANGLES: usize = 770_000;
/// Houses, or patches of ground, that are meshed together.
const AT_ONCE: usize = 64;

/// What was measured.
pub(super) struct CmpeCase {
    /// From the graph to all meshes.
    pub seconds: f64,
    pub links: usize,
    pub houses: usize,
    pub triangles: usize,
}

/// Draws the map, reads it, and measures the best of some runs.
///
/// # Errors
/// If the map cannot be drawn, read or grown.
pub(super) fn cmpe_case(
    (python, peers, work): (&Path, &Path, &Path),
    seed: u32,
    stock: &Stock,
    repeat: usize,
) -> Result<CmpeCase, Failure> {
    let map = Map { style: "old", seed, size: 4096, kind: Kind::Plain };
    let folder = Programs::new(python, peers, work)?.folder(&map)?;
    let mut input = Input::of(&folder.join("map.png"))?;
    input.raster_mut()?.legend = Some(folder.join("legend.json"));
    let graph = cut(survey(&input)?.0);
    let plan = grow(&graph, stock)?.plan;
    let detailed = detailed(&plan)?;
    let (seconds, made) = best(repeat, || -> Result<usize, Failure> { Ok(meshes(&grow(&graph, stock)?.plan, detailed)?) });
    Ok(CmpeCase { seconds, links: pieces(&graph), houses: plan.houses.len(), triangles: made? })
}

/// Straight pieces of a graph's links.
fn pieces(graph: &CityGraph) -> usize {
    graph.links.iter().map(|link| link.via.len() + 1).sum()
}

/// The graph about its middle: so many straight pieces, and the blocks and squares as far out.
fn cut(mut graph: CityGraph) -> CityGraph {
    let at = graph.node_positions();
    let middle = at.values().sum::<DVec2>() / at.len().max(1) as f64;
    let farthest = |line: &[DVec2]| line.iter().map(|p| p.distance(middle)).fold(0.0, f64::max);
    let mut links: Vec<(f64, usize)> =
        graph.links.iter().enumerate().map(|(i, link)| (farthest(&graph.polyline(link, &at).unwrap_or_default()), i)).collect();
    links.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut count, mut reach) = (0, 0.0);
    let mut kept = HashSet::new();
    for (distance, i) in links {
        if count >= LINKS {
            break;
        }
        count += graph.links[i].via.len() + 1;
        reach = distance;
        kept.insert(graph.links[i].id);
    }
    graph.links.retain(|link| kept.contains(&link.id));
    let ends: HashSet<Id> = graph.links.iter().flat_map(|link| [link.from, link.to]).collect();
    graph.nodes.retain(|node| ends.contains(&node.id));
    graph.squares.retain(|square| farthest(&square.outline) <= reach);
    graph.blocks.retain(|block| block.kind != BlockKind::Water && farthest(&block.outline) <= reach);
    graph
}

/// How many houses are to be built in full detail.
fn detailed(plan: &CityPlan) -> Result<usize, MeshError> {
    let (mut low, mut high) = (0, plan.houses.len());
    while low < high {
        let middle = (low + high).div_ceil(2);
        if meshes(plan, middle)? > TRIANGLES { high = middle - 1 } else { low = middle }
    }
    Ok(low)
}

/// Meshes a plan's ground and houses, the first of these in full detail; the number of triangles.
fn meshes(plan: &CityPlan, detailed: usize) -> Result<usize, MeshError> {
    let (full, plain) = plan.houses.split_at(detailed);
    let full = full.par_chunks(AT_ONCE).map(|houses| {
        let (shell, sheet) = (shell(houses), FacadeSheet::of(walls(houses)));
        Ok(triangles(&[mesh::level2(&shell, &sheet)?, mesh::roofs(&shell)]))
    });
    let plain = plain.par_chunks(AT_ONCE).map(|houses| {
        let shell = shell(houses);
        triangles(&[mesh::level1(&shell), mesh::roof_coverings(&shell)])
    });
    let ground = plan.ground.par_chunks(AT_ONCE).map(|patches| {
        let shell = CellShell { ground: patches.to_vec(), ..CellShell::default() };
        triangles(&[mesh::ground(&shell)])
    });
    let full: usize = full.sum::<Result<usize, MeshError>>()?;
    Ok(full + plain.sum::<usize>() + ground.sum::<usize>())
}

/// Houses with all their walls and roofs.
fn shell(houses: &[House]) -> CellShell {
    let house = |house: &House| {
        let volumes = house.volumes.iter().map(|volume| VolumeShell::of(volume, (0..volume.walls.len() as u16).collect(), true));
        HouseShell { style: house.style, floor: house.floor, volumes: volumes.collect(), is_monument: false }
    };
    CellShell { houses: houses.iter().map(house).collect(), ..CellShell::default() }
}

fn walls(houses: &[House]) -> Vec<veduta_city::Wall> {
    houses.iter().flat_map(|house| &house.volumes).flat_map(|volume| volume.walls.iter().cloned()).collect()
}
