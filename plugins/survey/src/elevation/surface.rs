use glam::{DMat2, DVec2};
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use veduta_city::{Anchor, Building, CityGraph, Finding, HIGHEST_M, Id, Severity};

use super::ElevationGrid;
use super::sample::Sampler;
use super::spikes::{median, quantile};
use crate::buildings::footprint_of;
use crate::georeference::Affine;
use crate::log::Log;
use crate::polygon::Polygon;

/// The share of a roof's cells that lie below its height: chimneys, masts and the tops of trees that lean over it are above.
const ROOF_SHARE: f64 = 0.9;
/// The share of the cells around a house that lie below its ground where trees and cars stand there, as is told by the middle
/// one lying so much higher, metres; otherwise the middle one is the ground, which slopes.
const GROUND_SHARE: f64 = 0.2;
const OVERGROWN_M: f64 = 1.5;
/// So far around a house its ground is looked for where there is no terrain model, metres.
const RING_M: f64 = 8.0;
/// A roof, or a ring of ground, of fewer cells tells nothing.
const LEAST_CELLS: usize = 4;
/// Of larger roofs only so many cells are looked at, evenly spread.
const MOST_CELLS: f64 = 10_000.0;
/// Nothing lower stands as a house, metres.
const LOWEST_M: f64 = 2.0;

/// Gives buildings without a height the one that a surface model shows: the height below which nine tenths of the roof lie,
/// above the ground under the house, in tenths of a metre. Parts of a building without a height get theirs alike; heights that
/// are given stay.
///
/// The ground is `terrain`'s (its median under the house), or without one what the surface model itself shows next to the
/// house between its neighbours. Houses of fewer than four cells, outside of the surface model, or where it shows less than
/// 2 m, are left to growth and reported.
pub fn heights_from_surface(graph: &mut CityGraph, surface: &ElevationGrid, terrain: Option<&ElevationGrid>) -> Vec<Finding> {
    let mut log = Log::default();
    if let Err(error) = surface.check_covers(graph) {
        log.dropped(Id::NONE, None, format!("{error}: heights stay as they were"));
        return log.finish();
    }
    let terrain = terrain.map(|t| (t, t.without_spikes(graph).0));
    let survey = Survey { anchor: graph.anchor, surface, terrain, houses: index(&graph.buildings) };
    let mut buildings = core::mem::take(&mut graph.buildings);
    for building in &mut buildings {
        survey.measure(building, &mut log);
    }
    graph.buildings = buildings;
    log.finish()
}

type Houses = RTree<GeomWithData<Rectangle<[f64; 2]>, Polygon>>;

fn index(buildings: &[Building]) -> Houses {
    let entry = |b: &Building| {
        let footprint = footprint_of(b);
        let (low, high) = footprint.bounds();
        GeomWithData::new(Rectangle::from_corners(low.to_array(), high.to_array()), footprint)
    };
    RTree::bulk_load(buildings.iter().filter(|b| b.outline.len() > 2).map(entry).collect())
}

struct Survey<'a> {
    anchor: Anchor,
    surface: &'a ElevationGrid,
    terrain: Option<(&'a ElevationGrid, Sampler<'a>)>,
    houses: Houses,
}

impl Survey<'_> {
    fn measure(&self, building: &mut Building, log: &mut Log) {
        let footprint = footprint_of(building);
        let wants_own = building.parts.is_empty() && building.height_m.is_none();
        if !wants_own && !building.parts.iter().any(|p| p.height_m.is_none()) {
            return;
        }
        let (id, place) = (building.id, Some(footprint.inner_pos()));
        let Some(ground) = self.ground(&footprint) else {
            let message = format!("houses stand where no ground is known beside {}: they keep no height", self.surface.name());
            return log.tally(Severity::Note, id, place, message);
        };
        if wants_own {
            building.height_m = self.height(&footprint, ground, building.min_height_m, (id, place), log);
        }
        // Of a building with parts, a height of its own holds for those without one; what is measured is better.
        for part in building.parts.iter_mut().filter(|p| p.height_m.is_none()) {
            let outline = Polygon { outer: part.outline.clone(), holes: part.holes.clone() };
            part.height_m = self.height(&outline, ground, part.min_height_m, (part.id, Some(outline.inner_pos())), log);
        }
    }

    fn height(
        &self,
        footprint: &Polygon,
        ground: f64,
        bottom_m: f64,
        (id, place): (Id, Option<DVec2>),
        log: &mut Log,
    ) -> Option<f64> {
        let name = self.surface.name();
        let mut roof = self.cells(footprint, 0.0, |p| footprint.contains(p));
        if roof.len() < LEAST_CELLS {
            let message = format!("houses have fewer than {LEAST_CELLS} cells of {name} inside them: they keep no height");
            log.tally(Severity::Note, id, place, message);
            return None;
        }
        let height = quantile(&mut roof, ROOF_SHARE)? - ground;
        if height < LOWEST_M.max(bottom_m + 1.0) {
            let message = format!("{name} shows nothing as high as a house where houses stand: they keep no height");
            log.tally(Severity::Note, id, place, message);
            return None;
        }
        if height > HIGHEST_M {
            let message = format!("{name} shows {height:.0} m above the ground, higher than any house: it keeps no height");
            log.note(id, place, message);
            return None;
        }
        log.tally(Severity::Note, id, place, format!("houses without a height got the one that {name} shows"));
        Some(libm::round(height * 10.0) / 10.0)
    }

    /// Elevation of the ground under a house.
    fn ground(&self, footprint: &Polygon) -> Option<f64> {
        if let Some((terrain, sampler)) = &self.terrain {
            let at = |p: DVec2| terrain.pixel_from_plan(self.anchor, p).and_then(|pixel| sampler.at(pixel).height_m());
            let corners = footprint.outer.iter().copied().chain([footprint.inner_pos()]);
            let known = median(&mut corners.filter_map(at).collect::<Vec<f64>>());
            if known.is_some() {
                return known;
            }
        }
        let mut ring = self.cells(footprint, RING_M, |p| self.is_free(p));
        if ring.len() < LEAST_CELLS {
            return None;
        }
        let (low, middle) = (quantile(&mut ring, GROUND_SHARE)?, median(&mut ring)?);
        Some(if middle - low < OVERGROWN_M { middle } else { low })
    }

    /// Whether no house stands at a position.
    fn is_free(&self, plan_pos: DVec2) -> bool {
        let around = AABB::from_point(plan_pos.to_array());
        !self.houses.locate_in_envelope_intersecting(&around).any(|house| house.data.contains(plan_pos))
    }

    /// Values of the cells whose middle lies in the box around a footprint, widened, and where the rule says so.
    fn cells(&self, footprint: &Polygon, wider_m: f64, is_wanted: impl Fn(DVec2) -> bool) -> Vec<f64> {
        let (low, high) = footprint.bounds();
        let (low, high) = (low - wider_m, high + wider_m);
        let Some(way) = self.way_around((low + high) / 2.0) else { return Vec::new() };
        let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)].map(|p| way.pixel(p));
        let first = corners.iter().copied().fold(DVec2::INFINITY, DVec2::min).floor();
        let last = corners.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max).ceil();
        let size = DVec2::new(f64::from(self.surface.columns), f64::from(self.surface.rows));
        let (first, last) = (first.max(DVec2::ZERO), last.min(size));
        if !first.cmplt(last).all() {
            return Vec::new();
        }
        let stride = libm::sqrt((last - first).element_product() / MOST_CELLS).ceil().max(1.0) as usize;
        let range = |from: f64, to: f64| (from as i64..to as i64).step_by(stride);
        let middles = range(first.y, last.y).flat_map(|row| range(first.x, last.x).map(move |column| (column, row)));
        let is_in = |&(column, row): &(i64, i64)| is_wanted(way.pos(DVec2::new(column as f64, row as f64) + 0.5));
        middles.filter(is_in).filter_map(|(column, row)| self.surface.cell(column, row)).collect()
    }

    /// From pixels to plan metres, straight, as it is around a position.
    fn way_around(&self, plan_pos: DVec2) -> Option<Affine> {
        const FAR_M: f64 = 10.0;
        let pixel = |p: DVec2| self.surface.pixel_from_plan(self.anchor, p);
        let middle = pixel(plan_pos)?;
        let (east, north) = (pixel(plan_pos + DVec2::X * FAR_M)? - middle, pixel(plan_pos + DVec2::Y * FAR_M)? - middle);
        let step = DMat2::from_cols(east, north).inverse() * FAR_M;
        let way = Affine { origin: plan_pos - step * middle, step };
        way.is_sound().then_some(way)
    }
}
