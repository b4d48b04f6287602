//! Squares, parks and waters; and the blocks that streets enclose, for growth to fill where no houses are given.

use std::collections::{BTreeMap, HashMap};

use glam::DVec2;
use veduta_city::{Block, BlockKind, Building, Id, LinkKind, Severity, Square, StreetClass};

use crate::buildings::{Index, footprint_of};
use crate::faces::{Face, Piece, faces};
use crate::lines::{Bounding, surfacing};
use crate::log::Log;
use crate::network::Network;
use crate::plots;
use crate::polygon::{Polygon, intersection, perimeter_m};
use crate::shapes::{Area, Use};

/// Faces below this are slivers between carriageways, above it no building ground of a town; square metres.
const LEAST_BLOCK_M2: f64 = 150.0;
const LARGEST_BLOCK_M2: f64 = 60_000.0;
/// Faces thinner than this are strips between two lanes of one street; metres.
const LEAST_WIDTH_M: f64 = 8.0;
/// A face with more of its ground built on than this has its houses already.
const BUILT_SHARE: f64 = 0.1;
/// A face with more of its ground under water, in a park or on a square than this is no building ground.
const FREE_SHARE: f64 = 0.5;
/// A face needs this much of its border on streets rather than paths.
const STREET_SHARE: f64 = 0.4;
/// Where this share of all faces have houses, a map shows all houses: its empty faces are empty in truth.
const COMPLETE_SHARE: f64 = 0.45;

/// Squares of the file.
pub(crate) fn squares(areas: &[Area<'_>], log: &mut Log) -> Vec<Square> {
    let mut out: Vec<Square> = Vec::new();
    for area in areas.iter().filter(|a| a.use_ == Use::Square) {
        let pos = area.inner_pos();
        let layer = area.tags.get("layer").and_then(crate::length::number).unwrap_or(0.0);
        if layer < 0.0 || area.tags.has("indoor") || area.tags.has("tunnel") {
            log.tally(Severity::Dropped, area.id, Some(pos), "squares under the ground or inside buildings are left out");
            continue;
        }
        let surfacing = surfacing(area.tags, area.id, log).unwrap_or_default();
        for (i, polygon) in area.polygons.iter().enumerate() {
            if let Some(same) = out.iter_mut().find(|s| s.outline == polygon.outer) {
                if same.name.is_empty() {
                    same.name = area.tags.text("name");
                }
                log.dropped(area.id, Some(pos), format!("a square has the very outline of {}", same.id));
                continue;
            }
            out.push(Square {
                id: if i == 0 { area.id } else { Id::NONE },
                name: area.tags.text("name"),
                outline: polygon.outer.clone(),
                holes: polygon.holes.clone(),
                surfacing,
            });
        }
    }
    out
}

/// Parks and waters of the file.
pub(crate) fn greens_and_waters(areas: &[Area<'_>], log: &mut Log) -> Vec<Block> {
    let mut out: Vec<Block> = Vec::new();
    for area in areas {
        let kind = match area.use_ {
            Use::Water => BlockKind::Water,
            Use::Park => BlockKind::Park,
            _ => continue,
        };
        if area.tags.has("tunnel") || area.tags.get("layer").and_then(crate::length::number).is_some_and(|l| l < 0.0) {
            log.tally(Severity::Dropped, area.id, Some(area.inner_pos()), "waters and greens under the ground are left out");
            continue;
        }
        for (i, polygon) in area.polygons.iter().enumerate() {
            if out.iter().any(|b| b.kind == kind && b.outline == polygon.outer) {
                log.tally(
                    Severity::Dropped,
                    area.id,
                    Some(polygon.inner_pos()),
                    "waters or greens have the very outline of another",
                );
                continue;
            }
            let id = if i == 0 { area.id } else { Id::NONE };
            out.push(block(id, kind, area.tags.text("name"), polygon));
        }
    }
    out
}

pub(crate) fn block(id: Id, kind: BlockKind, name: String, polygon: &Polygon) -> Block {
    Block { id, kind, name, district: String::new(), outline: polygon.outer.clone(), holes: polygon.holes.clone() }
}

/// Blocks to be built on: those that the map draws; otherwise what plots that lie wall to wall, or else streets enclose, with
/// neither houses nor water, park or square on them. Rings of what streets enclose run along the middle of the streets; growth
/// takes the streets' own width off.
pub(crate) fn built_blocks(
    network: &Network,
    buildings: &[Building],
    areas: &[Area<'_>],
    sea: &[Block],
    log: &mut Log,
) -> Vec<Block> {
    let drawn = drawn_blocks(areas);
    if !drawn.is_empty() {
        return drawn;
    }
    let streets = pieces(network);
    let of_plots = plots::blocks(areas, buildings, &streets, log);
    let mut candidates = faces(&streets);
    if !of_plots.is_empty() {
        // Where plots lie, they tell what is ground of houses and what is not.
        let index = Index::new(of_plots.iter().map(|f| &f.polygon));
        candidates.retain(|Face { polygon: face, .. }| {
            let (low, high) = face.bounds();
            let near = index.near(low, high).into_iter().filter_map(|i| of_plots.get(i)).map(|f| &f.polygon);
            let shared: f64 = intersection([face], near).iter().map(Polygon::area_m2).sum();
            shared < BUILT_SHARE * face.area_m2()
        });
        candidates.extend(of_plots);
    }
    candidates.retain(|f| is_block(&f.polygon) && f.street_share >= STREET_SHARE);
    let candidates: Vec<Polygon> = candidates.into_iter().map(|f| f.polygon).collect();
    let built = built_shares(&candidates, buildings);
    let with_houses = built.iter().filter(|&&share| share >= BUILT_SHARE).count();
    let total = candidates.len();
    if with_houses as f64 > COMPLETE_SHARE * total as f64 {
        return Vec::new();
    }
    let mut free: Vec<Polygon> = areas
        .iter()
        .filter(|a| matches!(a.use_, Use::Water | Use::Park | Use::Square | Use::Open))
        .flat_map(|a| a.polygons.iter().cloned())
        .collect();
    free.extend(sea.iter().map(|b| Polygon { outer: b.outline.clone(), holes: b.holes.clone() }));
    let index = Index::new(free.iter());
    let mut out = Vec::new();
    for (face, built) in candidates.iter().zip(&built) {
        let (low, high) = face.bounds();
        let near: Vec<&Polygon> = index.near(low, high).into_iter().filter_map(|i| free.get(i)).collect();
        let is_free = !near.is_empty() && {
            let covered: f64 =
                intersection([face], crate::polygon::union(near.iter().copied()).iter()).iter().map(Polygon::area_m2).sum();
            covered > FREE_SHARE * face.area_m2()
        };
        if *built < BUILT_SHARE && !is_free {
            out.push(block(Id::NONE, BlockKind::Built, String::new(), face));
        }
    }
    if !out.is_empty() {
        log.note(
            Id::NONE,
            None,
            format!("{} of {total} blocks between streets have no houses in the file: houses will be grown there", out.len()),
        );
    }
    out
}

/// Blocks that the map itself draws as built.
fn drawn_blocks(areas: &[Area<'_>]) -> Vec<Block> {
    let mut out = Vec::new();
    for area in areas.iter().filter(|a| a.use_ == Use::Block) {
        for (i, polygon) in area.polygons.iter().enumerate() {
            let id = if i == 0 { area.id } else { Id::NONE };
            out.push(block(id, BlockKind::Built, area.tags.text("name"), polygon));
        }
    }
    out
}

/// Straight pieces of the links that bound blocks.
fn pieces(network: &Network) -> Vec<Piece> {
    let at: HashMap<Id, DVec2> = network.nodes.iter().map(|n| (n.id, n.pos)).collect();
    let mut out = Vec::new();
    for (link, bounds) in network.links.iter().zip(&network.bounds) {
        // Houses stand around a roundabout, not in it.
        let is_roundabout = *bounds == Bounding::Roundabout;
        if *bounds == Bounding::Nothing {
            continue;
        }
        let is_street = matches!(link.kind, LinkKind::Street(class) if class < StreetClass::Path) && !is_roundabout;
        if let (Some(&from), Some(&to)) = (at.get(&link.from), at.get(&link.to)) {
            let line: Vec<DVec2> = core::iter::once(from).chain(link.via.iter().copied()).chain([to]).collect();
            out.extend(line.windows(2).map(|w| Piece { from: w[0], to: w[1], is_street }));
        }
    }
    out
}

/// Whether a face has a block's size and is no strip: twice its area over its perimeter is the width of a long strip.
fn is_block(polygon: &Polygon) -> bool {
    let (area, around) = (polygon.area_m2(), perimeter_m(&polygon.outer));
    (LEAST_BLOCK_M2..=LARGEST_BLOCK_M2).contains(&area) && 2.0 * area / around.max(1.0) >= LEAST_WIDTH_M
}

/// Share of each face that is built on; a building counts for the face that its middle lies in.
fn built_shares(candidates: &[Polygon], buildings: &[Building]) -> Vec<f64> {
    let index = Index::new(candidates.iter());
    let mut built: BTreeMap<usize, f64> = BTreeMap::new();
    for footprint in buildings.iter().map(footprint_of) {
        let pos = footprint.inner_pos();
        let home = index.near(pos, pos).into_iter().find(|&i| candidates.get(i).is_some_and(|f| f.contains(pos)));
        if let Some(i) = home {
            *built.entry(i).or_default() += footprint.area_m2();
        }
    }
    let share = |(i, f): (usize, &Polygon)| built.get(&i).copied().unwrap_or(0.0) / f.area_m2();
    candidates.iter().enumerate().map(share).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strip(width: f64, length: f64) -> Polygon {
        let outer = vec![DVec2::ZERO, DVec2::new(length, 0.0), DVec2::new(length, width), DVec2::new(0.0, width)];
        Polygon { outer, holes: Vec::new() }
    }

    #[test]
    fn strips_slivers_and_fields_are_no_blocks() {
        assert!(is_block(&strip(40.0, 60.0)));
        assert!(is_block(&strip(12.0, 30.0)));
        assert!(!is_block(&strip(7.0, 200.0)), "between two carriageways");
        assert!(!is_block(&strip(10.0, 12.0)), "a traffic island");
        assert!(!is_block(&strip(300.0, 300.0)), "a field");
    }
}
