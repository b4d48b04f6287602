//! `bench cells`: how fast a plan is cut into cells and their visible sets are found, how both grow with the city, and what it takes to make them
//! again after a house has gone.

use std::path::PathBuf;

use clap::Args;
use veduta_bake::{BakeSettings, enlarged};
use veduta_cells::{Recut, partition, visible_sets};
use veduta_city::CityPlan;
use veduta_growth::plan::{Stock, grow};

use super::figure::{Figure, print};
use super::growth::{best, graph};
use crate::program::Failure;

/// What to measure.
#[derive(Args)]
pub(crate) struct CellsBench {
    /// A map, graph or words to cut; a town described in words if not given.
    #[arg(value_name = "MAP")]
    map: Option<PathBuf>,
    /// How many times over the city is laid side by side; each is measured.
    #[arg(long, value_delimiter = ',', default_value = "1,4,8")]
    copies: Vec<u32>,
    /// How often each is done; the best counts.
    #[arg(long, default_value_t = 3)]
    repeat: usize,
    /// Print a line of JSON a figure.
    #[arg(long)]
    json: bool,
}

/// Measures and prints.
///
/// # Errors
/// If the map cannot be read or grown.
pub(crate) fn cells(bench: &CellsBench) -> Result<(), Failure> {
    let graph = graph(bench.map.as_deref())?;
    let settings = BakeSettings::default().partition;
    let stock = Stock::new();
    let mut figures = Vec::new();
    for &copies in &bench.copies {
        let columns = (1..=copies.max(1)).rev().find(|&n| n * n <= copies && copies % n == 0).unwrap_or(1);
        let plan = grow(&enlarged(&graph, columns, copies.max(1) / columns), &stock)?.plan;
        let (partition_s, made) = best(bench.repeat, || partition(&plan, &[], &settings));
        let (visible_s, (seen, _)) = best(bench.repeat, || visible_sets(&plan, &made.cells, &settings));
        let sets = seen.sets;
        let count = sets.len().max(1) as f64;
        let seen: usize = sets.iter().map(Vec::len).sum();
        let name = |what: &str| format!("{what}_{copies}x");
        figures.push(Figure::new(name("cells"), sets.len() as f64, "1"));
        figures.push(Figure::new(name("seen_from_a_cell"), seen as f64 / count, "1"));
        figures.push(Figure::new(name("partition_ms"), 1e3 * partition_s, "ms"));
        figures.push(Figure::new(name("visible_sets_ms"), 1e3 * visible_s, "ms"));
        figures.push(Figure::new(name("visible_sets_us_per_cell"), 1e6 * visible_s / count, "us"));
        drop(made);
        let changed = without_a_house(&plan);
        let mut recut = Recut::new(&plan, &[], &settings);
        let (mut recut_s, mut looked) = (f64::INFINITY, 0);
        for _ in 0..bench.repeat.max(1) {
            let (seconds, count) = best(1, || recut.update(&changed, &[]));
            (recut_s, looked) = (recut_s.min(seconds), count);
            if *recut.partition() != partition(&changed, &[], &settings) {
                return Err("a partition made again is not what it is anew".into());
            }
            recut.update(&plan, &[]);
        }
        figures.push(Figure::new(name("recut_ms"), 1e3 * recut_s, "ms").beside("partition", Some(1e3 * partition_s)));
        figures.push(Figure::new(name("recut_looks_from_cells"), looked as f64, "1"));
    }
    print(&figures, bench.json)
}

/// A plan without the house nearest to the middle of it.
fn without_a_house(plan: &CityPlan) -> CityPlan {
    let mut plan = plan.clone();
    let middle = plan.extent.middle().to_metres();
    let off_2 = |n: &usize| {
        let volume = plan.houses[*n].volumes.first();
        volume.map_or(f64::INFINITY, |volume| volume.footprint.middle().to_metres().distance_squared(middle))
    };
    let nearest = (0..plan.houses.len()).min_by(|a, b| off_2(a).total_cmp(&off_2(b)));
    if let Some(nearest) = nearest {
        plan.houses.remove(nearest);
    }
    plan
}
