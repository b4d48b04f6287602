//! Plots: parcels of a cadastre.
//!
//! A city graph has no lots. What plots tell beside houses and streets is where the ground of houses ends and the street
//! begins: plots that lie wall to wall make up a block, drawn to its building line.

use glam::DVec2;
use rstar::primitives::Line as TreeLine;
use rstar::{PointDistance, RTree};
use veduta_city::{Building, Id};

use crate::buildings::{Index, footprint_of};
use crate::faces::{Face, Piece};
use crate::log::Log;
use crate::polygon::{Polygon, edges, union};
use crate::shapes::{Area, Use};

/// A block's border lies on a street whose middle is this near, in metres.
const REACH_M: f64 = 20.0;
/// Distance between samples along a border, in metres.
const SAMPLE_M: f64 = 2.0;
/// A plot with this many metres of a street's middle inside it is the street's own.
const STREET_INSIDE_M: f64 = 12.0;

/// The blocks that a map's plots make up; tells how many of them hold no house.
pub(crate) fn blocks(areas: &[Area<'_>], buildings: &[Building], streets: &[Piece], log: &mut Log) -> Vec<Face> {
    let plots: Vec<&Polygon> = areas.iter().filter(|a| a.use_ == Use::Plot).flat_map(|a| &a.polygons).collect();
    if plots.is_empty() {
        return Vec::new();
    }
    let own = of_streets(&plots, streets);
    let ground: Vec<&Polygon> = plots.iter().zip(&own).filter(|(_, is_street)| !**is_street).map(|(p, _)| *p).collect();
    let empty = ground.len() - with_house(&ground, buildings);
    let message = format!(
        "{} plots: {} are streets, {empty} hold no house. A city graph has no lots: plots that touch are taken together as blocks",
        plots.len(),
        plots.len() - ground.len(),
    );
    log.note(Id::NONE, None, message);
    let lines = streets.iter().filter(|p| p.is_street).map(|p| TreeLine::new(p.from.to_array(), p.to.to_array()));
    let tree = RTree::bulk_load(lines.collect());
    let block = |polygon: Polygon| Face { street_share: street_share(&polygon.outer, &tree), polygon };
    union(ground).into_iter().map(block).collect()
}

/// Share of an outline that lies on streets.
fn street_share(outline: &[DVec2], streets: &RTree<TreeLine<[f64; 2]>>) -> f64 {
    let (mut near, mut all) = (0_usize, 0_usize);
    for (a, b) in edges(outline) {
        let samples = ((a.distance(b) / SAMPLE_M).ceil() as usize).clamp(1, 10_000);
        for k in 0..samples {
            let at = a.lerp(b, (k as f64 + 0.5) / samples as f64).to_array();
            let nearest = streets.nearest_neighbor(&at);
            near += usize::from(nearest.is_some_and(|line| line.distance_2(&at) <= REACH_M * REACH_M));
            all += 1;
        }
    }
    near as f64 / all.max(1) as f64
}

/// Which plots streets run through.
fn of_streets(plots: &[&Polygon], streets: &[Piece]) -> Vec<bool> {
    let index = Index::new(plots.iter().copied());
    let mut inside_m = vec![0.0; plots.len()];
    for piece in streets.iter().filter(|p| p.is_street) {
        let length = piece.from.distance(piece.to);
        // A sample a metre is enough to tell a street from a corner that one cuts.
        let samples = (length.ceil() as usize).clamp(1, 10_000);
        for k in 0..samples {
            let at = piece.from.lerp(piece.to, (k as f64 + 0.5) / samples as f64);
            for i in index.near(at, at) {
                if plots.get(i).is_some_and(|p| p.contains(at)) {
                    inside_m[i] += length / samples as f64;
                }
            }
        }
    }
    inside_m.into_iter().map(|m| m >= STREET_INSIDE_M).collect()
}

/// How many plots have a house's middle on them.
fn with_house(plots: &[&Polygon], buildings: &[Building]) -> usize {
    let index = Index::new(plots.iter().copied());
    let mut has = vec![false; plots.len()];
    for pos in buildings.iter().map(|b| footprint_of(b).inner_pos()) {
        for i in index.near(pos, pos) {
            if plots.get(i).is_some_and(|p| p.contains(pos)) {
                has[i] = true;
            }
        }
    }
    has.into_iter().filter(|&h| h).count()
}
