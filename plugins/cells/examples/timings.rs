//! Times each stage on a synthetic town: `cargo run --release -p veduta-cells --example timings [town|suburb] [SIDE]`, or on a
//! plan of your own: `… --example timings X.plan.ron`.

#[path = "../tests/common/mod.rs"]
mod common;

use std::time::Instant;

use veduta_cells::{PartitionSettings, cell_shells, check, facade_sheets, partition};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let kind = arguments.next().unwrap_or_default();
    let side = arguments.next().and_then(|n| n.parse().ok());
    let plan = match kind.as_str() {
        path if path.ends_with(".plan.ron") => match veduta_city::file::read(path.as_ref()) {
            Ok(plan) => plan,
            Err(error) => return eprintln!("{error}"),
        },
        "suburb" => common::suburb(side.unwrap_or(54)),
        _ => common::town(side.unwrap_or(16)),
    };
    let start = Instant::now();
    let made = partition(&plan, &[], &PartitionSettings::default());
    let cells = &made.cells;
    let partition_s = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let shells = cell_shells(&plan, cells);
    let shells_s = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let sheets = facade_sheets(&plan, cells);
    let sheets_s = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let errors = check(&plan, cells);
    let check_s = start.elapsed().as_secs_f64();
    let areas: Vec<f64> = cells.cells.iter().map(|cell| cell.outline.area_m2()).collect();
    let seen: usize = cells.visible.iter().map(Vec::len).sum();
    let count = cells.cells.len().max(1);
    println!("houses            {}", plan.houses.len());
    println!("cells             {} ({:.0} m² on average)", cells.cells.len(), areas.iter().sum::<f64>() / count as f64);
    println!("portals           {}", cells.portals.len());
    println!("visible           {:.1} cells on average", seen as f64 / count as f64);
    println!("most visible      {}", cells.visible.iter().map(Vec::len).max().unwrap_or(0));
    println!("ground pieces     {}", shells.iter().map(|shell| shell.ground.len()).sum::<usize>());
    println!("walls             {}", sheets.iter().map(|sheet| sheet.walls.len()).sum::<usize>());
    println!("partition         {partition_s:.3} s");
    println!("shells            {shells_s:.3} s");
    println!("sheets            {sheets_s:.3} s");
    println!("check             {check_s:.3} s, {} errors", errors.len());
    for line in errors.iter().map(ToString::to_string).chain(made.findings.iter().map(ToString::to_string)).take(20) {
        println!("  {line}");
    }
}
