//! Small towns for tests.

use veduta_city::{GridPos, Id, PlanStreet};

/// A walkable street, 6 m wide.
pub(crate) fn street(line: &[(f64, f64)]) -> PlanStreet {
    let line = line.iter().map(|&p| GridPos::from_metres(p.into())).collect();
    PlanStreet { id: Id(7), name: "Street".to_owned(), line, width: 6 * 1024, walkable: true, ..PlanStreet::default() }
}

/// A town of `n` streets each way.
pub(crate) fn grid_town(n: u32, block_m: f64) -> Vec<PlanStreet> {
    let along = |i: u32, swap: bool| {
        let vertex = |j: u32| {
            let (a, b) = (f64::from(j) * block_m, f64::from(i) * block_m);
            if swap { (b, a) } else { (a, b) }
        };
        street(&(0..n).map(vertex).collect::<Vec<_>>())
    };
    (0..n).flat_map(|i| [along(i, false), along(i, true)]).collect()
}
