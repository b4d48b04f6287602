//! Grows a made-up city of 11 × 11 blocks (about 1 km², 260 links, 3,000 houses) and says what came out and how long it took.
//!
//! `cargo run -p veduta-growth --release --example grow_city [BLOCKS]`

#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

use std::time::Instant;

use veduta_growth::plan::{Stock, grow};

fn main() {
    let n = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(11);
    let graph = synthetic::city(n, 7);
    let began = Instant::now();
    match grow(&graph, &Stock::new()) {
        Ok(growth) => {
            let took = began.elapsed();
            let (plan, links) = (growth.plan, graph.links.len());
            let walls: usize = plan.houses.iter().flat_map(|h| &h.volumes).map(|v| v.walls.len()).sum();
            println!("{links} links, {} given houses: {:.3} s", graph.buildings.len(), took.as_secs_f64());
            println!("{} houses, {walls} walls, {} patches, {} objects", plan.houses.len(), plan.ground.len(), plan.objects.len());
            growth.findings.iter().take(20).for_each(|f| println!("{f}"));
        }
        Err(error) => println!("{error}"),
    }
}
