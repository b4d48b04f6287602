//! The ground under a city as posts on a grid of its own.

use glam::DVec2;
use veduta_city::{CityGraph, Terrain};

use super::ElevationGrid;
use super::sample::Sampler;

/// Distance of posts, metres: that of the model's cells within these.
const STEP_M: core::ops::RangeInclusive<f64> = 4.0..=32.0;
/// Most posts: of a larger city they stand farther apart.
const MOST_POSTS: f64 = 4_000_000.0;
/// Posts reach so far beyond the city and its margin, metres.
const BEYOND_M: f64 = 40.0;
/// No wider margin is built, metres.
const WIDEST_MARGIN_M: f64 = 2_000.0;

/// Posts under a city and around it, heights in hundredths of a metre above `zero_m`; where the model tells none, those of the posts
/// around. And how many of those that are in the city's midst the model does not tell. `None` if it tells none at all.
pub(super) fn posts(graph: &CityGraph, model: &ElevationGrid, sampler: &Sampler<'_>, zero_m: f64) -> Option<(Terrain, usize)> {
    let city = bounds(graph)?;
    let more = graph.margin_m.clamp(0.0, WIDEST_MARGIN_M) + BEYOND_M;
    let (low, high) = (city.0 - more, city.1 + more);
    let size = high - low;
    let coarsest = libm::sqrt(size.element_product() / MOST_POSTS).ceil();
    let step_m = libm::round(model.cell_m.clamp(*STEP_M.start(), *STEP_M.end())).max(coarsest);
    let origin = (low / step_m).floor() * step_m;
    let count = ((high - origin) / step_m).ceil() + 1.0;
    let (columns, rows) = (count.x as usize, count.y as usize);
    let pos = |i: usize| origin + DVec2::new((i % columns) as f64, (i / columns) as f64) * step_m;
    let height = |i: usize| {
        let metres = model.pixel_from_plan(graph.anchor, pos(i)).and_then(|pixel| sampler.at(pixel).height_m());
        metres.map(|m| libm::round((m - zero_m) * 100.0) / 100.0)
    };
    let mut heights: Vec<Option<f64>> = (0..columns * rows).map(height).collect();
    if heights.iter().all(Option::is_none) {
        return None;
    }
    let is_amidst = |i: usize| city.0.cmple(pos(i)).all() && pos(i).cmple(city.1).all();
    let lacking = (0..heights.len()).filter(|&i| heights[i].is_none() && is_amidst(i)).count();
    fill(&mut heights, columns);
    let heights_m = heights.into_iter().map(Option::unwrap_or_default).collect();
    Some((Terrain { origin, step_m, columns: columns as u32, heights_m }, lacking))
}

/// The box about everything in a graph.
fn bounds(graph: &CityGraph) -> Option<(DVec2, DVec2)> {
    let nodes = graph.nodes.iter().map(|node| node.pos);
    let lines = graph.links.iter().flat_map(|link| &link.via).copied();
    let houses = graph.buildings.iter().flat_map(|building| &building.outline).copied();
    let blocks = graph.blocks.iter().flat_map(|block| &block.outline).copied();
    let squares = graph.squares.iter().flat_map(|square| &square.outline).copied();
    let all = nodes.chain(lines).chain(houses).chain(blocks).chain(squares);
    let (low, high) = all.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    low.cmple(high).all().then_some((low, high))
}

/// Gives posts without a height the mean of the neighbours that have one, from the known ones outwards.
fn fill(heights: &mut [Option<f64>], columns: usize) {
    let rows = heights.len() / columns;
    let neighbours = |i: usize| {
        let (x, y) = ((i % columns) as i64, (i / columns) as i64);
        let around = [(-1, 0), (1, 0), (0, -1), (0, 1)].map(|(dx, dy)| (x + dx, y + dy)).into_iter();
        let is_inside = move |&(x, y): &(i64, i64)| (0..columns as i64).contains(&x) && (0..rows as i64).contains(&y);
        around.filter(is_inside).map(move |(x, y)| y as usize * columns + x as usize)
    };
    let has_known = |heights: &[Option<f64>], i: usize| neighbours(i).any(|n| heights[n].is_some());
    let mut front: Vec<usize> = (0..heights.len()).filter(|&i| heights[i].is_none() && has_known(heights, i)).collect();
    while !front.is_empty() {
        let mean = |&i: &usize| {
            let known: Vec<f64> = neighbours(i).filter_map(|n| heights[n]).collect();
            (i, libm::round(known.iter().sum::<f64>() / known.len() as f64 * 100.0) / 100.0)
        };
        let found: Vec<(usize, f64)> = front.iter().map(mean).collect();
        found.iter().for_each(|&(i, height)| heights[i] = Some(height));
        front = found.iter().flat_map(|&(i, _)| neighbours(i)).filter(|&n| heights[n].is_none()).collect();
        front.sort_unstable();
        front.dedup();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_takes_the_heights_around_it() {
        let mut heights = vec![None; 15];
        (heights[0], heights[14]) = (Some(1.0), Some(5.0));
        fill(&mut heights, 5);
        let heights: Vec<f64> = heights.into_iter().flatten().collect();
        assert_eq!((heights.len(), heights[1], heights[5], heights[13]), (15, 1.0, 1.0, 5.0));
        assert!(heights.iter().all(|h| (1.0..=5.0).contains(h)));
    }
}
