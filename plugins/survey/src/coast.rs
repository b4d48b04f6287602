//! The sea: what lies right of `natural=coastline` (<https://wiki.openstreetmap.org/wiki/Tag:natural%3Dcoastline>).

use std::collections::BTreeMap;

use glam::DVec2;
use veduta_city::{Block, BlockKind, Id, Ring};

use crate::extent::Extent;
use crate::grounds::block;
use crate::log::Log;
use crate::osm::OsmData;
use crate::polygon::{Polygon, difference, even_odd, signed_area};

/// An end this near to the border was meant to reach it, in metres.
const SHORT_OF_BORDER_M: f64 = 300.0;

/// A line whose ends lie on the border of the extent, the sea to its left.
struct Shore {
    line: Vec<DVec2>,
    /// Metres along the border, counter-clockwise from the least corner.
    begins_at: f64,
    ends_at: f64,
}

/// Blocks of sea inside the extent.
pub(crate) fn sea(data: &OsmData, extent: &Extent, log: &mut Log) -> Vec<Block> {
    let chains = chains(data);
    let (mut shores, mut islands) = (Vec::new(), Vec::new());
    for chain in chains {
        let first = chain.first().copied();
        let is_closed = chain.len() > 3 && first == chain.last().copied();
        let runs = runs(&chain, data, extent);
        if let [line] = runs.as_slice()
            && is_closed
            && line.len() == chain.len()
            && line.iter().all(|p| extent.contains(*p))
        {
            islands.push(line.clone());
            continue;
        }
        for mut line in runs {
            let is_ring = is_closed && line.len() == chain.len();
            line.reverse();
            for mut piece in inside(&line, extent, is_ring) {
                reach_border(&mut piece, extent);
                match (border_place(piece.first(), extent), border_place(piece.last(), extent)) {
                    (Some(begins_at), Some(ends_at)) => shores.push(Shore { line: piece, begins_at, ends_at }),
                    _ => log.dropped(
                        Id::NONE,
                        piece.first().copied(),
                        "a coastline ends inside the extent: its sea cannot be told from land",
                    ),
                }
            }
        }
    }
    let mut waters = if shores.is_empty() { Vec::new() } else { closed_along_border(&shores, extent) };
    let (land, lakes): (Vec<Ring>, Vec<Ring>) = islands.into_iter().partition(|r| signed_area(r) > 0.0);
    if shores.is_empty() && !land.is_empty() {
        waters.push(Polygon { outer: extent.ring(), holes: Vec::new() });
    }
    let land: Vec<Polygon> = land.iter().flat_map(|r| even_odd(core::slice::from_ref(r)).0).collect();
    if !land.is_empty() {
        waters = difference(&waters, &land);
    }
    waters.extend(lakes.iter().flat_map(|r| even_odd(core::slice::from_ref(r)).0));
    waters.iter().map(|p| block(Id::NONE, BlockKind::Water, String::new(), p)).collect()
}

/// The pieces of a chain whose nodes the file holds.
fn runs(chain: &[i64], data: &OsmData, extent: &Extent) -> Vec<Vec<DVec2>> {
    let runs = chain.split(|id| !data.nodes.contains_key(id));
    let plan = |run: &[i64]| -> Vec<DVec2> { run.iter().filter_map(|id| data.nodes.get(id)).map(|n| extent.plan_pos(n)).collect() };
    runs.map(plan).filter(|line| line.len() > 1).collect()
}

/// Leads ends that stop short of the border (the next vertex is not in the file) straight to it.
fn reach_border(piece: &mut Vec<DVec2>, extent: &Extent) {
    let nearest = |p: DVec2| -> Option<DVec2> {
        let sides = [
            DVec2::new(extent.low.x, p.y),
            DVec2::new(extent.high.x, p.y),
            DVec2::new(p.x, extent.low.y),
            DVec2::new(p.x, extent.high.y),
        ];
        sides.into_iter().filter(|s| s.distance(p) <= SHORT_OF_BORDER_M).min_by(|a, b| a.distance(p).total_cmp(&b.distance(p)))
    };
    if let Some(p) = piece.first().copied().and_then(nearest) {
        piece.insert(0, p);
    }
    if let Some(p) = piece.last().copied().and_then(nearest) {
        piece.push(p);
    }
}

/// Ways of the coast joined end to beginning; their direction carries meaning and is kept.
fn chains(data: &OsmData) -> Vec<Vec<i64>> {
    let mut by_start: BTreeMap<i64, Vec<i64>> = BTreeMap::new();
    for way in data.ways.values().filter(|w| w.tags.is("natural", "coastline") && w.nodes.len() > 1) {
        if let Some(&first) = way.nodes.first() {
            by_start.insert(first, way.nodes.clone());
        }
    }
    let ends: std::collections::BTreeSet<i64> = by_start.values().filter_map(|n| n.last().copied()).collect();
    // Chains begin where nothing ends; what is left after them are rings.
    let mut order: Vec<i64> = by_start.keys().copied().collect();
    order.sort_by_key(|s| (ends.contains(s), *s));
    let mut out = Vec::new();
    for start in order {
        let Some(mut chain) = by_start.remove(&start) else { continue };
        while let Some(next) = chain.last().and_then(|last| by_start.remove(last)) {
            chain.extend(next.into_iter().skip(1));
        }
        out.push(chain);
    }
    out
}

/// The pieces of a line that lie in the extent, their ends on its border where they leave it.
fn inside(line: &[DVec2], extent: &Extent, is_closed: bool) -> Vec<Vec<DVec2>> {
    let (mut out, mut piece): (Vec<Vec<DVec2>>, Vec<DVec2>) = (Vec::new(), Vec::new());
    for pair in line.windows(2) {
        let &[a, b] = pair else { continue };
        match crate::network::clip(a, b, extent) {
            Some((enter, leave)) => {
                if piece.is_empty() {
                    piece.push(a.lerp(b, enter));
                }
                piece.push(a.lerp(b, leave));
                if leave < 1.0 {
                    out.push(core::mem::take(&mut piece));
                }
            }
            None => {
                if piece.len() > 1 {
                    out.push(core::mem::take(&mut piece));
                }
            }
        }
    }
    if piece.len() > 1 {
        out.push(piece);
    }
    // A ring that begins inside is one piece across its beginning.
    if is_closed
        && out.len() > 1
        && line.first().is_some_and(|p| extent.contains(*p))
        && let Some(mut last) = out.pop()
        && let Some(first) = out.first_mut()
    {
        last.extend(first.iter().skip(1));
        *first = last;
    }
    out
}

/// Metres along the border to a point on it; `None` inside.
fn border_place(p: Option<&DVec2>, extent: &Extent) -> Option<f64> {
    const NEAR_M: f64 = 1e-3;
    let p = *p?;
    let (size, from) = (extent.high - extent.low, p - extent.low);
    if from.y.abs() < NEAR_M {
        Some(from.x)
    } else if (size.x - from.x).abs() < NEAR_M {
        Some(size.x + from.y)
    } else if (size.y - from.y).abs() < NEAR_M {
        Some(size.x + size.y + (size.x - from.x))
    } else if from.x.abs() < NEAR_M {
        Some(2.0 * size.x + size.y + (size.y - from.y))
    } else {
        None
    }
}

/// Rings of sea: along a shore, then counter-clockwise along the border to where the next shore begins.
fn closed_along_border(shores: &[Shore], extent: &Extent) -> Vec<Polygon> {
    let size = extent.high - extent.low;
    let around = 2.0 * (size.x + size.y);
    let corners: Vec<(f64, DVec2)> = [size.x, size.x + size.y, 2.0 * size.x + size.y, around]
        .into_iter()
        .zip(extent.ring().into_iter().cycle().skip(1))
        .collect();
    let ahead = |from: f64, to: f64| (to - from).rem_euclid(around);
    let mut used = vec![false; shores.len()];
    let mut rings: Vec<Ring> = Vec::new();
    for start in 0..shores.len() {
        let (mut ring, mut at) = (Ring::new(), start);
        while let Some(shore) = shores.get(at).filter(|_| !used.get(at).copied().unwrap_or(true)) {
            used[at] = true;
            ring.extend(&shore.line);
            let Some(next) = (0..shores.len()).min_by(|&i, &j| {
                let away = |k: usize| shores.get(k).map_or(f64::INFINITY, |s| ahead(shore.ends_at, s.begins_at));
                away(i).total_cmp(&away(j))
            }) else {
                break;
            };
            let reach = shores.get(next).map_or(0.0, |s| ahead(shore.ends_at, s.begins_at));
            let mut passed: Vec<(f64, DVec2)> =
                corners.iter().map(|&(place, p)| (ahead(shore.ends_at, place), p)).filter(|(d, _)| *d < reach).collect();
            passed.sort_by(|a, b| a.0.total_cmp(&b.0));
            ring.extend(passed.into_iter().map(|(_, p)| p));
            at = next;
        }
        if ring.len() >= 3 {
            rings.push(ring);
        }
    }
    rings.iter().flat_map(|r| even_odd(core::slice::from_ref(r)).0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::osm::{Bounds, Tags, Way};

    /// Corners of a coast in hundredths of a degree around (0, 0); the extent reaches to ±1 and 50 m more.
    fn seas(coasts: &[&[(f64, f64)]]) -> (f64, f64) {
        let mut data =
            OsmData { bounds: Some(Bounds { south: -0.01, west: -0.01, north: 0.01, east: 0.01 }), ..OsmData::default() };
        for (w, coast) in coasts.iter().enumerate() {
            let mut nodes = Vec::new();
            for (i, &(x, y)) in coast.iter().enumerate() {
                let same = coast.iter().position(|&c| c == (x, y)).unwrap_or(i);
                let id = (w * 100 + same) as i64;
                data.add_node(id, y / 100.0, x / 100.0, Tags::default());
                nodes.push(id);
            }
            data.ways.insert(w as i64, Way { nodes, tags: [("natural", "coastline")].into_iter().collect() });
        }
        let mut log = Log::default();
        let extent = Extent::of(&data, &mut log).unwrap();
        let blocks = sea(&data, &extent, &mut log);
        let area: f64 = blocks.iter().map(|b| signed_area(&b.outline) + b.holes.iter().map(|h| signed_area(h)).sum::<f64>()).sum();
        (area, signed_area(&extent.ring()))
    }

    #[test]
    fn the_sea_lies_right_of_the_coast() {
        // Northwards along x = 0.5: the east is sea.
        let (sea, all) = seas(&[&[(0.5, -0.0), (0.5, 0.1)]]);
        assert_eq!(sea, 0.0, "it does not reach the border");
        let (short, _) = seas(&[&[(0.5, -0.95), (0.5, 0.95)]]);
        assert!((short / all - 0.261).abs() < 0.01, "ends near the border are led to it: {}", short / all);
        let (sea, _) = seas(&[&[(0.5, -3.0), (0.5, 0.0), (0.5, 0.1), (0.5, 0.9), (0.5, 3.0)]]);
        assert!((sea / all - 0.261).abs() < 0.01, "{}", sea / all);
        let (sea, _) = seas(&[&[(0.5, 3.0), (0.5, 0.9), (0.5, 0.1), (0.5, 0.0), (0.5, -3.0)]]);
        assert!((sea / all - 0.739).abs() < 0.01, "{}", sea / all);
    }

    #[test]
    fn an_island_is_no_sea() {
        let (sea, all) = seas(&[&[(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5)]]);
        let land = 1113.2 * 1105.74;
        assert!(((all - sea) / land - 1.0).abs() < 0.01, "{} {land}", all - sea);
    }

    #[test]
    fn a_strait_has_two_coasts() {
        let east: &[(f64, f64)] = &[(0.5, 3.0), (0.5, 0.5), (0.5, 0.0), (0.5, -3.0)];
        let west: &[(f64, f64)] = &[(-0.5, -3.0), (-0.5, 0.0), (-0.5, 0.5), (-0.5, 3.0)];
        let (sea, all) = seas(&[east, west]);
        assert!((sea / all - 0.4785).abs() < 0.01, "{}", sea / all);
    }
}
