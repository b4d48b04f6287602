//! `bench growth`: how fast a city graph becomes a plan, and a plan's cells meshes.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use rayon::prelude::*;
use veduta_bake::{BakeSettings, Input, cut, survey};
use veduta_cells::{cell_shells, facade_sheets};
use veduta_city::{CellShell, CityGraph, FacadeSheet, RoofShape, Season, file};
use veduta_growth::mesh::{self, MeshData, MonumentDetail};
use veduta_growth::plan::{Growth, Stock, grow};

use super::cmpe::cmpe_case;
use super::figure::{Figure, print};
use super::footprints::GrowthPeer;
use crate::program::Failure;

/// What to measure, and with what beside.
#[derive(Args)]
pub(crate) struct GrowthBench {
    /// A map, graph or words to grow; a town described in words if not given.
    #[arg(value_name = "MAP")]
    map: Option<PathBuf>,
    #[command(flatten)]
    peer: GrowthPeer,
    /// How often each is done; the best counts.
    #[arg(long, default_value_t = 3)]
    repeat: usize,
    /// Print a line of JSON a figure.
    #[arg(long)]
    json: bool,
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
    let stock = Stock::new();
    let (seconds, grown) = best(bench.repeat, || grow(&graph, &stock));
    let Growth { plan, .. } = grown?;
    let houses = plan.houses.len() as f64;
    let mut figures = vec![Figure::new("planned_buildings_per_s", houses / seconds, "1/s")];

    let (cells, _) = cut(&plan, &[], &BakeSettings::default());
    let parts: Vec<(CellShell, FacadeSheet)> = cell_shells(&plan, &cells).into_iter().zip(facade_sheets(&plan, &cells)).collect();
    let near = |(shell, sheet): &(CellShell, FacadeSheet)| {
        let level2 = mesh::facades(shell, sheet)?;
        Ok::<_, mesh::MeshError>(triangles(&[
            mesh::level1(shell),
            mesh::roofs(shell),
            level2,
            mesh::monuments(shell, MonumentDetail::COARSE),
        ]))
    };
    let (seconds, made) = best(bench.repeat, || parts.par_iter().map(near).sum::<Result<usize, _>>());
    made?;
    figures.push(Figure::new("buildings_per_s", houses / seconds, "1/s"));
    let full = |(shell, sheet): &(CellShell, FacadeSheet)| {
        let mut walls = mesh::level2(shell, sheet)?;
        walls.append(&mesh::monuments(shell, MonumentDetail::MIDDLE));
        let trees = mesh::trees(shell, Season::Summer);
        Ok::<_, mesh::MeshError>(triangles(&[walls, mesh::roofs(shell), mesh::ground(shell), mesh::objects(shell), trees]))
    };
    let (seconds, made) = best(bench.repeat, || parts.par_iter().map(full).sum::<Result<usize, _>>());
    figures.push(Figure::new("triangles_per_s", made? as f64 / seconds, "1/s"));

    if let Some(footprints) = bench.peer.measured()? {
        let shell = footprints.houses(RoofShape::Flat, 0);
        let (seconds, _) = best(20 * bench.repeat, || triangles(&[mesh::level1(&shell), mesh::roof_coverings(&shell)]));
        let prisms = Figure::new("prisms_per_s", shell.houses.len() as f64 / seconds, "1/s");
        figures.push(prisms.beside("trimesh", footprints.peer("trimesh_prisms")));
    }
    if let Some((place, seed)) = bench.peer.maps() {
        let case = cmpe_case(place, seed, &stock, bench.repeat)?;
        figures.push(Figure::new("cmpe_4096_ms", 1e3 * case.seconds, "ms"));
        let counts = [("links", case.links), ("houses", case.houses), ("triangles", case.triangles)];
        figures.extend(counts.map(|(what, count)| Figure::new(format!("cmpe_4096_{what}"), count as f64, "1")));
    }
    print(&figures, bench.json)
}

pub(super) fn graph(map: Option<&Path>) -> Result<CityGraph, Failure> {
    match map {
        Some(path) => Ok(survey(&Input::of(path)?)?.0),
        None => Ok(veduta_survey::survey_words(&file::parse(TOWN, "town")?)?.graph),
    }
}

/// The seconds of the best of some runs, and what the last one made.
pub(super) fn best<T>(repeat: usize, mut run: impl FnMut() -> T) -> (f64, T) {
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

pub(super) fn triangles(meshes: &[MeshData]) -> usize {
    meshes.iter().map(MeshData::triangle_count).sum()
}
