//! The skyline: cells with what rises above the roofs.

use std::collections::BTreeSet;

use veduta_city::{Cell, Cells, CityPlan, GridPos, House, Volume, metres};

/// How far above the median roof the skyline begins, metres.
const ABOVE_MEDIAN_M: f64 = 10.0;
/// Least height of what belongs to the skyline, foot to top, metres.
const LEAST_HEIGHT_M: f64 = 24.0;

/// Height of a volume above the lowest floor of its house: on slopes, too, a tower is what rises above its neighbours.
fn top(house: &House, volume: &Volume) -> i32 {
    volume.top().saturating_sub(house.floor)
}

/// Cells that carry walls or roofs of tall volumes, ascending. All of them: each is seen from somewhere, over some low roof.
pub(crate) fn skyline(plan: &CityPlan, cells: &Cells) -> Vec<u32> {
    let mut tops: Vec<i32> =
        plan.houses.iter().filter_map(|house| house.volumes.iter().map(|volume| top(house, volume)).max()).collect();
    tops.sort_unstable();
    let Some(&median) = tops.get(tops.len() / 2) else { return Vec::new() };
    let threshold = median.saturating_add(GridPos::steps(ABOVE_MEDIAN_M));
    let (mut houses, mut volumes) = (BTreeSet::new(), BTreeSet::new());
    for (h, house) in (0..).zip(&plan.houses) {
        let foot = house.volumes.iter().map(|v| v.bottom).min().unwrap_or(0);
        for (v, volume) in (0..=u16::MAX).zip(&house.volumes) {
            if top(house, volume) > threshold && metres(volume.top().saturating_sub(foot)) > LEAST_HEIGHT_M {
                houses.insert(h);
                volumes.insert((h, v));
            }
        }
    }
    let carries = |cell: &Cell| {
        cell.houses.iter().any(|house| houses.contains(house)) || cell.walls.iter().any(|&(h, v, _)| volumes.contains(&(h, v)))
    };
    (0..).zip(&cells.cells).filter(|(_, cell)| carries(cell)).map(|(number, _)| number).collect()
}
