//! `bench growth`: how fast a city graph becomes a plan, and a plan's cells meshes.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use anstream::println;
use clap::Args;
use glam::DVec2;
use rayon::prelude::*;
use veduta_bake::{BakeSettings, Input, cut, survey};
use veduta_cells::{cell_shells, facade_sheets};
use veduta_city::{
    CellShell, CityGraph, FacadeSheet, GridPolygon, GridPos, HouseShell, Id, PlanRoof, Rgb, RoofShape, VolumeShell, file,
};
use veduta_growth::mesh::{self, MeshData};
use veduta_growth::plan::{Growth, grow, stock_styles};

use super::figure::{Figure, PeerFigure};
use super::programs::run;
use super::roofs::Footprints;
use crate::program::Failure;

/// What to measure, and with what beside.
#[derive(Args)]
pub(crate) struct GrowthBench {
    /// A map, graph or words to grow; a town described in words if not given.
    #[arg(value_name = "MAP")]
    map: Option<PathBuf>,
    /// Folder of peer_growth.py, which writes footprints and measures the peer's prisms on them.
    #[arg(long, value_name = "DIR")]
    peers: Option<PathBuf>,
    /// Python with what its first lines name.
    #[arg(long, value_name = "PROGRAM", default_value = "python3")]
    python: PathBuf,
    /// Seed of the peer's footprints.
    #[arg(long, default_value_t = 1)]
    seed: u32,
    /// How often each is done; the best counts.
    #[arg(long, default_value_t = 3)]
    repeat: usize,
    /// Print a line of JSON a figure.
    #[arg(long)]
    json: bool,
    /// Where the peer's footprints are kept.
    #[arg(long, value_name = "DIR", default_value = "target/bench-growth")]
    work: PathBuf,
}

/// The town that is grown if none is given: two kilometres across, old in the middle.
const TOWN: &str = r#"(
    name: "Bench", seed: 4, size_m: 2000, plan: Mixed(), density: 0.8,
    districts: [
        (name: "Old Town", style: "old_town", share: 0.3, at: Centre),
        (name: "New Town", style: "tenement", share: 0.7, at: Edge),
    ],
    squares: 5, parks: 0.05,
)"#;

/// Measures and prints.
///
/// # Errors
/// If the peer cannot be run, or the map not be read or grown.
pub(crate) fn growth(bench: &GrowthBench) -> Result<(), Failure> {
    let graph = graph(bench.map.as_deref())?;
    let styles = stock_styles();
    let (seconds, grown) = best(bench.repeat, || grow(&graph, &styles));
    let Growth { plan, .. } = grown?;
    let houses = plan.houses.len() as f64;
    let mut figures = vec![Figure::new("planned_buildings_per_s", houses / seconds, "1/s")];

    let (cells, _) = cut(&plan, &BakeSettings::default());
    let parts: Vec<(CellShell, FacadeSheet)> = cell_shells(&plan, &cells).into_iter().zip(facade_sheets(&plan, &cells)).collect();
    let near = |(shell, sheet): &(CellShell, FacadeSheet)| {
        let level2 = mesh::facades(shell, sheet)?;
        Ok::<_, mesh::MeshError>(triangles(&[mesh::level1(shell), mesh::roofs(shell), level2]))
    };
    let (seconds, made) = best(bench.repeat, || parts.par_iter().map(near).sum::<Result<usize, _>>());
    made?;
    figures.push(Figure::new("buildings_per_s", houses / seconds, "1/s"));
    let full = |(shell, sheet): &(CellShell, FacadeSheet)| {
        let walls = mesh::level2(shell, sheet)?;
        Ok::<_, mesh::MeshError>(triangles(&[walls, mesh::roofs(shell), mesh::ground(shell), mesh::objects(shell)]))
    };
    let (seconds, made) = best(bench.repeat, || parts.par_iter().map(full).sum::<Result<usize, _>>());
    figures.push(Figure::new("triangles_per_s", made? as f64 / seconds, "1/s"));

    if let Some(peers) = &bench.peers {
        figures.push(prisms(bench, peers)?);
    }
    if !bench.json {
        println!("{}", Figure::HEAD);
    }
    for figure in &figures {
        if bench.json { println!("{}", serde_json::to_string(figure)?) } else { println!("{figure}") }
    }
    Ok(())
}

fn graph(map: Option<&Path>) -> Result<CityGraph, Failure> {
    match map {
        Some(path) => Ok(survey(&Input::of(path)?)?.0),
        None => Ok(veduta_survey::survey_words(&file::parse(TOWN, "town")?)?.graph),
    }
}

/// The seconds of the best of some runs, and what the last one made.
fn best<T>(repeat: usize, mut run: impl FnMut() -> T) -> (f64, T) {
    let mut time = || {
        let began = Instant::now();
        let made = run();
        (began.elapsed().as_secs_f64(), made)
    };
    let first = time();
    (1..repeat).fold(first, |(least, _), _| {
        let (seconds, made) = time();
        (least.min(seconds), made)
    })
}

fn triangles(meshes: &[MeshData]) -> usize {
    meshes.iter().map(MeshData::triangle_count).sum()
}

/// Prisms of the peer's footprints, closed above and below, beside trimesh's.
fn prisms(bench: &GrowthBench, peers: &Path) -> Result<Figure, Failure> {
    fs::create_dir_all(&bench.work)?;
    let file = bench.work.join("footprints.json");
    let mut peer = Command::new(&bench.python);
    peer.arg(peers.join("peer_growth.py")).args(["--seed", &bench.seed.to_string()]).arg("--write").arg(&file);
    let theirs: Vec<PeerFigure> = run(peer)?.lines().map(serde_json::from_str).collect::<Result<_, _>>()?;
    let read: Footprints = serde_json::from_str(&fs::read_to_string(&file)?)?;
    let house = |(i, ring): (usize, &Vec<[f64; 2]>)| {
        let outer: Vec<GridPos> = ring.iter().map(|&p| GridPos::from_metres(DVec2::from(p))).collect();
        let walls = (0..outer.len() as u16).collect();
        let roof = PlanRoof { shape: RoofShape::Flat, height: 0, direction: 0, colour: Rgb(0xA2, 0x4B, 0x33) };
        let [colour, trim] = [Rgb(0xD9, 0xB3, 0x6C), Rgb(0xEF, 0xE3, 0xC8)];
        let footprint = GridPolygon::simple(outer);
        let volume = VolumeShell { footprint, bottom: 0, eaves: 12 * 1024, colour, trim, roof, has_roof: true, walls };
        HouseShell { id: Id(i as u64), style: 0, volumes: vec![volume] }
    };
    let houses: Vec<HouseShell> = read.footprints.iter().enumerate().map(house).collect();
    let shell = CellShell { houses, ..CellShell::default() };
    let (seconds, _) = best(20 * bench.repeat, || triangles(&[mesh::level1(&shell), mesh::roof_coverings(&shell)]));
    let trimesh = theirs.iter().find(|figure| figure.name == "trimesh_prisms").map(|figure| figure.value);
    Ok(Figure::new("prisms_per_s", shell.houses.len() as f64 / seconds, "1/s").beside("trimesh", trimesh))
}
