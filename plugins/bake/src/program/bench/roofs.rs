//! `bench roofs`: straight skeletons and hipped roofs beside SFCGAL's, on the same footprints; how many footprints have none.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Instant;

use anstream::println;
use clap::Args;
use glam::DVec2;
use rayon::prelude::*;
use serde::Deserialize;
use veduta_bake::{BakeSettings, Input, plan};
use veduta_city::{CellShell, GridPolygon, GridPos, HouseShell, Id, PlanRoof, Rgb, RoofShape, Volume, VolumeShell};
use veduta_growth::mesh::roof_coverings;
use veduta_growth::skeleton::{Rings, Skeletons, drawn_footprint};

use super::figure::{Figure, PeerFigure};
use super::programs::run;
use crate::program::Failure;

/// What to measure, and with what beside.
#[derive(Args)]
pub(crate) struct RoofsBench {
    /// Maps whose houses' footprints are tried too, each map by itself.
    #[arg(value_name = "MAP")]
    maps: Vec<PathBuf>,
    /// Folder of peer_growth.py, which writes the footprints and measures the peer; drawn ones are taken if it is not given.
    #[arg(long, value_name = "DIR")]
    peers: Option<PathBuf>,
    /// Python with what its first lines name.
    #[arg(long, value_name = "PROGRAM", default_value = "python3")]
    python: PathBuf,
    /// Seed of the peer's footprints.
    #[arg(long, default_value_t = 1)]
    seed: u32,
    /// Drawn footprints that are tried, of all kinds.
    #[arg(long, default_value_t = 1_000_000)]
    drawn: u64,
    /// Print a line of JSON a figure.
    #[arg(long)]
    json: bool,
    /// Where the peer's footprints are kept.
    #[arg(long, value_name = "DIR", default_value = "target/bench-roofs")]
    work: PathBuf,
}

/// The peer's file of footprints.
#[derive(Deserialize)]
pub(super) struct Footprints {
    pub footprints: Vec<Vec<[f64; 2]>>,
    /// By their number of corners.
    stars: BTreeMap<String, Vec<[f64; 2]>>,
}

/// Measures, tries and prints.
///
/// # Errors
/// If the peer cannot be run, a map cannot be read, or a skeleton does not cover its footprint.
pub(crate) fn roofs(bench: &RoofsBench) -> Result<(), Failure> {
    let (few, stars, peer) = match &bench.peers {
        Some(peers) => with_peer(bench, peers)?,
        None => own_footprints(),
    };
    let value_of = |name: &str| peer.iter().find(|figure| figure.name == name).map(|figure| figure.value);
    let mut figures = Vec::new();
    let mut skeletons = Skeletons::default();
    let mut find_all = |all: &[Rings]| {
        for rings in all {
            std::hint::black_box(skeletons.find(rings.iter().map(Vec::as_slice)).is_ok());
        }
    };
    let rate = per_second(few.len(), || find_all(&few));
    figures.push(Figure::new("roofs_per_s_n12", rate, "1/s").beside("SFCGAL", value_of("sfcgal_straight_skeletons")));
    for star in stars {
        let corners = star[0].len();
        let peer = value_of(&format!("sfcgal_straight_skeleton_n{corners}"));
        let rate = per_second(1, || find_all(core::slice::from_ref(&star)));
        figures.push(Figure::new(format!("roofs_per_s_n{corners}"), rate, "1/s").beside("SFCGAL", peer));
    }
    let shell = hipped(&few);
    let rate = per_second(few.len(), || drop(std::hint::black_box(roof_coverings(&shell))));
    figures.push(Figure::new("hipped_roofs_per_s", rate, "1/s").beside("SFCGAL", value_of("sfcgal_hipped_roofs")));

    let drawn = tried((0..bench.drawn).into_par_iter().filter_map(drawn_footprint));
    figures.extend(drawn.figures("drawn_footprints"));
    let mut wrong = drawn.wrong;
    for map in &bench.maps {
        let plan = plan(&Input::of(map)?, &BakeSettings::default(), &mut |_| ())?.plan;
        let ring = |ring: &Vec<GridPos>| ring.iter().map(|p| p.to_metres()).collect();
        let rings = |volume: &Volume| volume.footprint.rings().map(ring).collect::<Rings>();
        let footprints: Vec<Rings> = plan.houses.iter().flat_map(|house| &house.volumes).map(rings).collect();
        let tried = tried(footprints.into_par_iter());
        wrong += tried.wrong;
        let name = map.file_stem().unwrap_or_default().to_string_lossy();
        figures.extend(tried.figures(&format!("{name}_footprints")));
    }
    if !bench.json {
        println!("{}", Figure::HEAD);
    }
    for figure in &figures {
        if bench.json { println!("{}", serde_json::to_string(figure)?) } else { println!("{figure}") }
    }
    if wrong > 0 { Err(format!("{wrong} skeletons do not cover their footprints once").into()) } else { Ok(()) }
}

type Measured = (Vec<Rings>, Vec<Rings>, Vec<PeerFigure>);

/// The peer's footprints and stars, and its figures.
fn with_peer(bench: &RoofsBench, peers: &Path) -> Result<Measured, Failure> {
    fs::create_dir_all(&bench.work)?;
    let file = bench.work.join("footprints.json");
    let mut peer = Command::new(&bench.python);
    peer.arg(peers.join("peer_growth.py")).args(["--seed", &bench.seed.to_string()]).arg("--write").arg(&file);
    let figures = run(peer)?.lines().map(serde_json::from_str).collect::<Result<_, _>>()?;
    let read: Footprints = serde_json::from_str(&fs::read_to_string(&file)?)?;
    let rings = |ring: Vec<[f64; 2]>| vec![ring.into_iter().map(DVec2::from).collect()];
    let mut stars: Vec<Rings> = read.stars.into_values().map(rings).collect();
    stars.sort_by_key(|star| star[0].len());
    Ok((read.footprints.into_iter().map(rings).collect(), stars, figures))
}

/// Drawn footprints of at most 12 corners, and stars with as many corners as the peer's.
fn own_footprints() -> Measured {
    let is_small = |rings: &Rings| rings.len() == 1 && rings[0].len() <= 12;
    let few = (0..).filter_map(drawn_footprint).filter(is_small).take(2000).collect();
    let star = |corners: u32| {
        let at = |i: u32| {
            let reach = 100.0 + 20.0 * (f64::from(i) * 0.618_034).fract();
            DVec2::from_angle(f64::from(i) * core::f64::consts::TAU / f64::from(corners)) * reach
        };
        vec![(0..corners).map(at).collect()]
    };
    (few, [50, 100, 200, 400].map(star).into(), Vec::new())
}

/// How many a second, in the best of runs that take half a second together.
fn per_second(count: usize, mut run: impl FnMut()) -> f64 {
    const SECONDS: f64 = 0.5;
    let (began, mut best) = (Instant::now(), f64::INFINITY);
    while best.is_infinite() || began.elapsed().as_secs_f64() < SECONDS {
        let from = Instant::now();
        run();
        best = best.min(from.elapsed().as_secs_f64());
    }
    count as f64 / best
}

/// A cell of houses with hipped roofs.
fn hipped(footprints: &[Rings]) -> CellShell {
    let house = |(i, rings): (usize, &Rings)| {
        let outer = rings[0].iter().map(|&p| GridPos::from_metres(p)).collect();
        let roof = PlanRoof { shape: RoofShape::Hipped, height: 5 * 1024, direction: 0, colour: Rgb(0xA2, 0x4B, 0x33) };
        let [colour, trim] = [Rgb(0xD9, 0xB3, 0x6C), Rgb(0xEF, 0xE3, 0xC8)];
        let footprint = GridPolygon::simple(outer);
        let volume = VolumeShell { footprint, bottom: 0, eaves: 12 * 1024, colour, trim, roof, has_roof: true, walls: Vec::new() };
        HouseShell { id: Id(i as u64), style: 0, volumes: vec![volume] }
    };
    CellShell { houses: footprints.iter().enumerate().map(house).collect(), ..CellShell::default() }
}

/// How it went with some footprints.
struct Tried {
    count: u64,
    /// Have no skeleton.
    missing: u64,
    /// Have one whose faces do not cover what they should.
    wrong: u64,
}

impl Tried {
    fn figures(&self, name: &str) -> [Figure; 3] {
        [("", self.count), ("_without_skeleton", self.missing), ("_wrong", self.wrong)]
            .map(|(what, count)| Figure::new(format!("{name}{what}"), count as f64, "1"))
    }
}

fn tried(footprints: impl ParallelIterator<Item = Rings>) -> Tried {
    let [count, missing, wrong] = [(); 3].map(|()| AtomicU64::new(0));
    footprints.for_each_init(Skeletons::default, |skeletons, rings| {
        count.fetch_add(1, Relaxed);
        match skeletons.find(rings.iter().map(Vec::as_slice)) {
            Err(_) => _ = missing.fetch_add(1, Relaxed),
            Ok(skeleton) => {
                let area = |ring: &[DVec2]| {
                    let cross = |i: usize| (ring[i] - ring[0]).perp_dot(ring[(i + 1) % ring.len()] - ring[0]);
                    (0..ring.len()).map(cross).sum::<f64>() / 2.0
                };
                let round: f64 = rings.iter().flat_map(|r| (0..r.len()).map(|i| r[i].distance(r[(i + 1) % r.len()]))).sum();
                let whole: f64 = rings.iter().map(|ring| area(ring)).sum();
                let at = |&node: &u32| skeleton.nodes()[node as usize].truncate();
                let parts: Vec<f64> = skeleton.faces().map(|f| area(&f.iter().map(at).collect::<Vec<_>>())).collect();
                // Corners may have been moved by half a millimetre.
                let off = 1e-3 * round;
                let is_right = parts.iter().all(|&part| part > -off) && (parts.iter().sum::<f64>() - whole).abs() < off;
                wrong.fetch_add(u64::from(!is_right), Relaxed);
            }
        }
    });
    Tried { count: count.into_inner(), missing: missing.into_inner(), wrong: wrong.into_inner() }
}
