//! Digests of the plans of this project's towns: the same on every platform.
//!
//! ```text
//!  x86-64:  main ─► digests, printed, a line each ─┐
//!  wasm32:  plan_digest(0), plan_digest(1), … ─────┴─► cargo verify wasm: equal
//! ```
//!
//! # Limits
//! `wasm32-unknown-unknown` has no standard output and no arguments: there the numbers come out of an exported function.
//!
//! # Rejected
//! `wasm32-wasip1`, which has both: it needs a C library beside Rust's, and distributions ship one that is too old.

use veduta_city::{CityGraph, file};
use veduta_growth::plan::{Stock, grow};

/// The towns, in RON: crossings and lots, slopes and cellars, rivers and bridges, tunnels, given houses and landmarks.
const TOWNS: [&str; 5] = [
    include_str!("../../../plugins/bake/tests/places/lane/lane.graph.ron"),
    include_str!("../../../plugins/bake/tests/places/hillside/hillside.graph.ron"),
    include_str!("../../../plugins/bake/tests/places/riverside/riverside.graph.ron"),
    include_str!("../towns/underpass.graph.ron"),
    include_str!("../../../scenes/old_prague/old_prague.graph.ron"),
];

/// The first eight bytes of the BLAKE3 of a town's plan as RON text; `None` after the last town.
///
/// # Errors
/// What is wrong with the town, which a person reads.
fn digest(town: usize) -> Option<Result<u64, Box<dyn std::error::Error>>> {
    let text = TOWNS.get(town)?;
    let digest = || {
        let graph: CityGraph = file::parse(text, "a town")?;
        let plan = file::to_text(&grow(&graph, &Stock::new())?.plan)?;
        let [a, b, c, d, e, f, g, h, ..] = *blake3::hash(plan.as_bytes()).as_bytes();
        Ok(u64::from_be_bytes([a, b, c, d, e, f, g, h]))
    };
    Some(digest())
}

/// The digest of a town for callers outside of Rust: 0 after the last. A town that cannot be grown traps.
#[expect(unsafe_code, reason = "a name to export it by; no other crate has this one")]
#[unsafe(no_mangle)]
pub extern "C" fn plan_digest(town: u32) -> u64 {
    match digest(town as usize) {
        Some(Ok(digest)) => digest,
        Some(Err(error)) => panic!("{error}"),
        None => 0,
    }
}

fn main() {
    for town in 0..TOWNS.len() {
        println!("{:016x}", plan_digest(town as u32));
    }
}
