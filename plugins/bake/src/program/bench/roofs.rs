//! `bench roofs`: straight skeletons and hipped roofs beside SFCGAL's, on the same footprints; how many footprints have none.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Instant;

use clap::Args;
use glam::DVec2;
use rayon::prelude::*;
use veduta_bake::{BakeSettings, Input, plan};
use veduta_city::{GridPos, RoofShape, Volume};
use veduta_growth::mesh::roof_coverings;
use veduta_growth::skeleton::{Rings, Skeletons, drawn_footprint};

use super::figure::{Figure, print};
use super::footprints::{Footprints, GrowthPeer};
use crate::program::Failure;

/// What to measure, and with what beside.
#[derive(Args)]
pub(crate) struct RoofsBench {
    /// Maps whose houses' footprints are tried too, each map by itself.
    #[arg(value_name = "MAP")]
    maps: Vec<PathBuf>,
    #[command(flatten)]
    peer: GrowthPeer,
    /// Numbers that footprints of all kinds are drawn from; about one in eighty gives none.
    #[arg(long, default_value_t = 1_020_000)]
    drawn: u64,
    /// Print a line of JSON a figure.
    #[arg(long)]
    json: bool,
}

/// Measures, tries and prints.
///
/// # Errors
/// If the peer cannot be run, a map cannot be read, or a skeleton does not cover its footprint.
pub(crate) fn roofs(bench: &RoofsBench) -> Result<(), Failure> {
    let footprints = bench.peer.measured()?.unwrap_or_else(own_footprints);
    let mut figures = Vec::new();
    let mut skeletons = Skeletons::default();
    let mut find_all = |all: &[Vec<DVec2>]| {
        for ring in all {
            std::hint::black_box(skeletons.find([ring.as_slice()]).is_ok());
        }
    };
    let few = &footprints.few;
    let rate = per_second(few.len(), || find_all(few));
    figures.push(Figure::new("roofs_per_s_n12", rate, "1/s").beside("SFCGAL", footprints.peer("sfcgal_straight_skeletons")));
    for star in &footprints.stars {
        let corners = star.len();
        let peer = footprints.peer(&format!("sfcgal_straight_skeleton_n{corners}"));
        let rate = per_second(1, || find_all(core::slice::from_ref(star)));
        figures.push(Figure::new(format!("roofs_per_s_n{corners}"), rate, "1/s").beside("SFCGAL", peer));
    }
    let shell = footprints.houses(RoofShape::Hipped, 5 * 1024);
    let rate = per_second(few.len(), || drop(std::hint::black_box(roof_coverings(&shell))));
    figures.push(Figure::new("hipped_roofs_per_s", rate, "1/s").beside("SFCGAL", footprints.peer("sfcgal_hipped_roofs")));

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
    print(&figures, bench.json)?;
    if wrong > 0 { Err(format!("{wrong} skeletons do not cover their footprints once").into()) } else { Ok(()) }
}

/// Drawn footprints of at most 12 corners, and stars with as many corners as the peer's.
fn own_footprints() -> Footprints {
    let is_small = |ring: &Vec<DVec2>| ring.len() <= 12;
    let simple = (0..).filter_map(drawn_footprint).filter(|rings| rings.len() == 1).flatten();
    let few = simple.filter(is_small).take(2000).collect();
    let star = |corners: u32| {
        let at = |i: u32| {
            let reach = 100.0 + 20.0 * (f64::from(i) * 0.618_034).fract();
            DVec2::from_angle(f64::from(i) * core::f64::consts::TAU / f64::from(corners)) * reach
        };
        (0..corners).map(at).collect()
    };
    Footprints { few, stars: [50, 100, 200, 400].map(star).into(), ..Footprints::default() }
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
