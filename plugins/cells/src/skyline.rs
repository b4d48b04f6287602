//! The skyline: cells with what rises above the roofs.

use std::collections::BTreeSet;

use veduta_city::{Cells, CityPlan, GridPos, House, Volume, metres};

/// How far above the median roof the skyline begins, metres.
const ABOVE_MEDIAN_M: f64 = 10.0;
/// Least height of what belongs to the skyline, foot to top, metres.
const LEAST_HEIGHT_M: f64 = 24.0;
/// A tower is at least this many times as high as the side of a square of its footprint's area.
const TOWER_SLENDERNESS: f64 = 2.0;
/// Share of the cells that may be in the skyline without a tower.
const MOST_CELLS: f64 = 0.05;

/// Height of a volume above the lowest floor of its house: on slopes, too, a tower is what rises above its neighbours.
fn top(house: &House, volume: &Volume) -> i32 {
    volume.top().saturating_sub(house.floor)
}

/// Cells that carry walls or roofs of the tallest volumes, ascending: all towers, and the tallest of the others as far as their
/// share of the cells goes.
pub(crate) fn skyline(plan: &CityPlan, cells: &Cells) -> Vec<u32> {
    let mut tops: Vec<i32> =
        plan.houses.iter().filter_map(|house| house.volumes.iter().map(|volume| top(house, volume)).max()).collect();
    tops.sort_unstable();
    let Some(&median) = tops.get(tops.len() / 2) else { return Vec::new() };
    let threshold = median.saturating_add(GridPos::steps(ABOVE_MEDIAN_M));
    // Tallest first.
    let mut tall: Vec<(core::cmp::Reverse<i32>, u32, u16)> = Vec::new();
    for (h, house) in (0..).zip(&plan.houses) {
        let foot = house.volumes.iter().map(|v| v.bottom).min().unwrap_or(0);
        for (v, volume) in (0..=u16::MAX).zip(&house.volumes) {
            let height = top(house, volume);
            if height > threshold && metres(volume.top().saturating_sub(foot)) > LEAST_HEIGHT_M {
                tall.push((core::cmp::Reverse(height), h, v));
            }
        }
    }
    tall.sort_unstable();
    let carriers = Carriers::new(cells, &tall.iter().map(|&(_, h, _)| h).collect());
    let most = ((cells.cells.len() as f64 * MOST_CELLS) as usize).max(1);
    let mut skyline = BTreeSet::new();
    for (_, h, v) in tall {
        let Some(volume) = plan.houses.get(h as usize).and_then(|house| house.volumes.get(usize::from(v))) else { continue };
        if skyline.len() < most || is_tower(volume) {
            skyline.extend(carriers.of(h, v));
        }
    }
    skyline.into_iter().collect()
}

fn is_tower(volume: &Volume) -> bool {
    let height_m = metres(volume.top().saturating_sub(volume.bottom));
    height_m > TOWER_SLENDERNESS * libm::sqrt(volume.footprint.area_m2().abs())
}

/// (house, volume) → cells, sorted; roofs as volume `None`; of a few houses.
struct Carriers(BTreeSet<(u32, Option<u16>, u32)>);

impl Carriers {
    fn new(cells: &Cells, houses: &BTreeSet<u32>) -> Self {
        let mut all = BTreeSet::new();
        for (i, cell) in (0..).zip(&cells.cells) {
            all.extend(cell.walls.iter().filter(|wall| houses.contains(&wall.0)).map(|&(h, v, _)| (h, Some(v), i)));
            all.extend(cell.houses.iter().filter(|house| houses.contains(house)).map(|&h| (h, None, i)));
        }
        Self(all)
    }

    /// Cells with a wall of the volume or the house's roof.
    fn of(&self, house: u32, volume: u16) -> impl Iterator<Item = u32> + '_ {
        [None, Some(volume)].into_iter().flat_map(move |v| self.0.range((house, v, 0)..=(house, v, u32::MAX)).map(|entry| entry.2))
    }
}
