//! Covered walks under houses whose ground floors are arcades.
//!
//! The volume of such a house becomes two: one over all of its footprint that hangs over the walk, and a ground floor whose fronts
//! stand back. What hangs is a passage for whoever cuts cells, and what stands back is a wall like others.

use glam::DVec2;
use rayon::prelude::*;
use veduta_city::{
    Arcade, GRID_PER_METRE, GridPolygon, GridPos, GroundFloor, House, Opening, Ornament, PLAN_STEP, PlanRoof, PlanTerrain,
    RoofShape, Volume, Wall, WallKind, metres, ring_edges,
};

use super::boolean;
use super::ground::Ground;
use super::walls::{DOORSTEP, Standing};

/// Depth of a walk, wall included; least ground floor that is left behind it; metres.
const DEPTH_M: f64 = 3.6;
const LEAST_ROOM_M: f64 = 3.5;
/// Shorter fronts and lower ground floors have painted arches; metres.
const LEAST_FRONT_M: f64 = 4.6;
const LEAST_HEIGHT_M: f64 = 3.1;
/// Corners of a front with a walk, degrees.
const CORNER_DEG: core::ops::RangeInclusive<f64> = 60.0..=120.0;
/// Distances between piers; metres.
const PITCH_M: core::ops::RangeInclusive<f64> = 2.4..=4.4;
const WISHED_PITCH_M: f64 = 3.2;
/// The paving lies so far above the highest ground before it, at most so far above the lowest, and so far above or below the floor of the
/// house; metres.
const RISE_M: f64 = 0.03;
const MOST_STEP_M: f64 = 0.32;
const MOST_OFF_FLOOR_M: f64 = 0.35;
/// Ground before a front without another house.
const CLEAR_M: [f64; 4] = [1.0, 3.0, 5.0, 7.0];
/// Where the ground before a front is looked at, metres out of it.
const BEFORE_M: f64 = 0.4;

/// Opens the walks. In narrow streets houses that would have one have windows.
pub(super) fn open(houses: &mut [House], (ground, standing): (&Ground<'_>, &Standing), terrain: &PlanTerrain) {
    houses.par_iter_mut().filter(|house| house.monument.is_none()).for_each(|house| {
        let floor = house.floor;
        for v in 0..house.volumes.len() {
            keep_to_broad_streets(&mut house.volumes[v], standing);
            let volume = &house.volumes[v];
            if volume.bottom.saturating_sub(floor) > DOORSTEP || !volume.walls.iter().any(is_arcaded) {
                continue;
            }
            let others: Vec<&GridPolygon> =
                house.volumes.iter().enumerate().filter(|(other, _)| *other != v).map(|(_, other)| &other.footprint).collect();
            if let Some((above, below)) = Plot::new(volume, &others, ground, terrain).and_then(|plot| plot.parts()) {
                house.volumes[v] = above;
                house.volumes.push(below);
            }
        }
    });
}

/// Whether a wall stands on arches by its style.
fn is_arcaded(wall: &Wall) -> bool {
    let [ground, _, ..] = wall.storeys[..] else { return false };
    wall.kind == WallKind::Street && ground.opening == Opening::Arcade && metres(ground.height) >= LEAST_HEIGHT_M
}

/// Puts windows in place of the arches that other houses stand close before.
fn keep_to_broad_streets(volume: &mut Volume, standing: &Standing) {
    for (wall, (a, b)) in volume.walls.iter_mut().zip(volume.footprint.edges()) {
        let Some(storey) = wall.storeys.first_mut().filter(|storey| storey.opening == Opening::Arcade) else { continue };
        let (a, b) = (a.to_metres(), b.to_metres());
        let out = -(b - a).normalize_or_zero().perp();
        let is_free = |p: DVec2| standing.at(GridPos::from_metres(p)).next().is_none();
        let is_clear = |share: f64| CLEAR_M.into_iter().all(|far| is_free(a.lerp(b, share) + out * far));
        if ![0.1, 0.5, 0.9].into_iter().all(is_clear) {
            storey.opening = Opening::Window;
        }
    }
}

/// A volume whose walks are being laid out.
struct Plot<'a> {
    volume: &'a Volume,
    corners: Vec<DVec2>,
    /// By how much each edge of the outline stands back below.
    back: Vec<f64>,
    /// Height of the ground floor, grid steps.
    storey: i32,
    /// Height of the paving, grid steps.
    floor: i32,
}

impl<'a> Plot<'a> {
    /// `None` if no front has room for a walk.
    fn new(volume: &'a Volume, others: &[&GridPolygon], ground: &Ground<'_>, terrain: &PlanTerrain) -> Option<Self> {
        let n = volume.footprint.outer.len();
        if !volume.footprint.holes.is_empty() || volume.walls.len() != n {
            return None;
        }
        let corners: Vec<DVec2> = volume.footprint.outer.iter().map(|p| p.to_metres()).collect();
        let storey = volume.walls.iter().find(|wall| is_arcaded(wall))?.storeys.first()?.height;
        let mut plot = Self { volume, corners, back: vec![0.0; n], storey, floor: 0 };
        let has_storey = |wall: &Wall| wall.storeys.is_empty() || wall.storeys.len() > 1 && wall.storeys[0].height == storey;
        if !volume.walls.iter().all(has_storey) {
            return None;
        }
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for i in 0..n {
            let Some((l, h)) = plot.before(i, ground, terrain).filter(|_| is_arcaded(&volume.walls[i]) && plot.has_room(i)) else {
                continue;
            };
            let (l, h) = (low.min(l), high.max(h));
            let is_even = h + RISE_M - l <= MOST_STEP_M && (h + RISE_M - metres(volume.bottom)).abs() <= MOST_OFF_FLOOR_M;
            if is_even && others.iter().all(|other| boolean::overlap_m2(&plot.strip(i), other) < 0.05) {
                (low, high) = (l, h);
                plot.back[i] = DEPTH_M;
            }
        }
        plot.floor = GridPos::steps(high + RISE_M);
        plot.back.iter().any(|back| *back > 0.0).then_some(plot)
    }

    fn before_and_after(&self, i: usize) -> (usize, usize) {
        let n = self.corners.len();
        ((i + n - 1) % n, (i + 1) % n)
    }

    fn length(&self, i: usize) -> f64 {
        self.corners[i].distance(self.corners[self.before_and_after(i).1])
    }

    fn along(&self, i: usize) -> DVec2 {
        (self.corners[self.before_and_after(i).1] - self.corners[i]).normalize_or(DVec2::X)
    }

    /// Sine of the angle at a corner of the outline; `None` if it is too sharp or too blunt.
    fn sine(&self, corner: usize) -> Option<f64> {
        let (into, out) = (self.along(self.before_and_after(corner).0), self.along(corner));
        let turn = libm::atan2(into.perp_dot(out), into.dot(out)).to_degrees();
        CORNER_DEG.contains(&(180.0 - turn)).then(|| into.perp_dot(out))
    }

    /// The ground that a walk along an edge would take.
    fn strip(&self, i: usize) -> GridPolygon {
        let (before, after) = self.before_and_after(i);
        let [a, b] = [self.corners[i], self.corners[after]];
        let far = |corner: usize, way: DVec2| way * (DEPTH_M / self.sine(corner).unwrap_or(1.0));
        let ring = [a, b, b + far(after, self.along(after)), a - far(i, self.along(before))];
        GridPolygon::simple(ring.map(GridPos::on_plan).to_vec())
    }

    /// Whether a walk along an edge leaves room behind it and goes to its ends.
    fn has_room(&self, i: usize) -> bool {
        let (before, after) = self.before_and_after(i);
        let (Some(at_start), Some(at_end)) = (self.sine(i), self.sine(after)) else { return false };
        // Beside another walk, that one's depth is gone as well.
        let cut = |edge: usize, sine: f64| if self.back[edge] > 0.0 { DEPTH_M / sine } else { 0.0 };
        let room = |edge: usize, sine: f64, far: usize| {
            let gone = if self.back[far] > 0.0 { DEPTH_M } else { 0.0 };
            self.length(edge) >= (DEPTH_M + gone) / sine + LEAST_ROOM_M
        };
        let front = self.length(i) - cut(before, at_start) - cut(after, at_end);
        // Nothing else of the outline is near the walk.
        let (a, way, inward) = (self.corners[i], self.along(i), self.along(i).perp());
        let is_far = |corner: usize| {
            let p = self.corners[corner] - a;
            p.dot(inward) >= DEPTH_M + LEAST_ROOM_M - 1e-6 || p.dot(way) < -DEPTH_M || p.dot(way) > self.length(i) + DEPTH_M
        };
        front >= LEAST_FRONT_M
            && room(before, at_start, self.before_and_after(before).0)
            && room(after, at_end, self.before_and_after(after).1)
            && (0..self.corners.len()).all(|corner| corner == i || corner == after || is_far(corner))
    }

    /// Lowest and highest ground before an edge and under a walk there, metres; `None` where no street lies before it.
    fn before(&self, i: usize, ground: &Ground<'_>, terrain: &PlanTerrain) -> Option<(f64, f64)> {
        let (a, b) = (self.corners[i], self.corners[self.before_and_after(i).1]);
        let out = -self.along(i).perp();
        let at = |share: f64| {
            let p = a.lerp(b, share) + out * BEFORE_M;
            let (surface, z) = *ground.at(GridPos::from_metres(p)).next()?;
            surface.is_public().then(|| terrain.height_m(p) + metres(z))
        };
        let before: Vec<f64> = [0.05, 0.25, 0.5, 0.75, 0.95].into_iter().map(at).collect::<Option<_>>()?;
        let under = [0.5, 1.0].map(|part| terrain.range_along(a - out * (DEPTH_M * part), b - out * (DEPTH_M * part)).1);
        let low = before.iter().copied().fold(f64::INFINITY, f64::min);
        Some((low, before.into_iter().chain(under).fold(f64::NEG_INFINITY, f64::max)))
    }

    /// What hangs over the walks, and the ground floor behind them.
    fn parts(&self) -> Option<(Volume, Volume)> {
        let middle = self.volume.bottom.saturating_add(self.storey);
        let mut above = Volume { bottom: middle, arcades: self.arcades(), ..self.volume.clone() };
        above.walls.iter_mut().for_each(leave_ground_floor);
        let mut below = Volume { footprint: self.ground_floor()?, eaves: middle, ..self.volume.clone() };
        below.roof = PlanRoof { shape: RoofShape::Flat, height: PlanRoof::NONE, direction: 0, ..below.roof };
        for (wall, back) in below.walls.iter_mut().zip(&self.back) {
            wall.storeys.truncate(1);
            wall.ornament = None;
            if let Some(storey) = wall.storeys.first_mut().filter(|_| *back > 0.0) {
                storey.opening = Opening::Window;
            }
        }
        Some((above, below))
    }

    /// The outline with the fronts set back.
    fn ground_floor(&self) -> Option<GridPolygon> {
        let n = self.corners.len();
        let corner = |i: usize| {
            let before = self.before_and_after(i).0;
            let backs = [self.back[before], self.back[i]];
            if backs == [0.0, 0.0] {
                return Some(self.volume.footprint.outer[i]);
            }
            // Where the lines of both edges meet, each set back.
            let (into, out) = (self.along(before), self.along(i));
            let sine = self.sine(i)?;
            let exact = self.corners[i] + (out * backs[0] - into * backs[1]) / sine;
            // On the outer side of an edge that is not set back: beside a neighbour no slit is left.
            let outside = |p: GridPos| {
                let by = |edge: usize| -self.along(edge).perp().dot(p.to_metres() - self.corners[edge]);
                // (Which zero is the lesser one, platforms do not agree on.)
                let within = [before, i].into_iter().filter(|&edge| self.back[edge] == 0.0).map(by).filter(|by| *by < 0.0);
                within.fold(0.0, f64::min)
            };
            let p = exact * f64::from(GRID_PER_METRE / PLAN_STEP);
            let (x, y) = (libm::floor(p.x) as i32, libm::floor(p.y) as i32);
            let near = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| GridPos((x + dx) * PLAN_STEP, (y + dy) * PLAN_STEP));
            near.into_iter().max_by(|p, q| outside(*p).total_cmp(&outside(*q)))
        };
        let ring: Vec<GridPos> = (0..n).map(corner).collect::<Option<_>>()?;
        let runs_on = |(i, (a, b)): (usize, (GridPos, GridPos))| {
            let way = b.to_metres() - a.to_metres();
            way.dot(self.along(i)) > 0.5
        };
        let is_whole = ring_edges(&ring).enumerate().all(runs_on);
        is_whole.then(|| GridPolygon::simple(ring))
    }

    fn arcades(&self) -> Vec<Arcade> {
        let (mut out, depth, steps) = (Vec::new(), GridPos::steps(DEPTH_M), GridPos::steps);
        let fronts = (0..self.corners.len()).filter(|&i| self.back[i] > 0.0);
        for i in fronts {
            let (before, after) = self.before_and_after(i);
            let cut = |corner: usize| DEPTH_M / self.sine(corner).unwrap_or(1.0);
            let (length, mut from, mut to) = (self.length(i), 0.0, self.length(i));
            let mut add = |wall: usize, span: (f64, f64), arches: u8, depth: i32| {
                out.push(Arcade { wall: wall as u16, span: (steps(span.0), steps(span.1)), arches, floor: self.floor, depth });
            };
            // The corner between two walks belongs to the one that ends there; a walk's open end has an arch of its own.
            if self.back[before] > 0.0 {
                from = cut(i);
                add(i, (0.0, from), 1, 0);
            } else if self.volume.walls[before].kind != WallKind::Party {
                add(before, (self.length(before) - cut(i), self.length(before)), 1, 0);
            }
            if self.back[after] > 0.0 {
                to = length - cut(after);
                add(i, (to, length), 1, depth);
            } else if self.volume.walls[after].kind != WallKind::Party {
                add(after, (0.0, cut(after)), 1, 0);
            }
            add(i, (from, to), arches(to - from, self.volume.walls[i].bays), depth);
        }
        out.sort_unstable_by_key(|arcade| (arcade.wall, arcade.span));
        out
    }
}

/// One arch a bay or for two, if that gives them a breadth for walking through.
fn arches(length_m: f64, bays: u8) -> u8 {
    let fits = |n: &u8| *n > 0 && PITCH_M.contains(&(length_m / f64::from(*n)));
    let by_bays = [bays, if bays.is_multiple_of(2) { bays / 2 } else { 0 }];
    by_bays.into_iter().find(fits).unwrap_or_else(|| libm::round(length_m / WISHED_PITCH_M).clamp(1.0, 250.0) as u8)
}

/// Takes the ground floor off a wall.
fn leave_ground_floor(wall: &mut Wall) {
    if !wall.storeys.is_empty() {
        wall.storeys.remove(0);
    }
    wall.ground_floor = GroundFloor::default();
    if let Some(ornament) = &mut wall.ornament {
        let down = |storey: u8| storey.saturating_sub(1);
        let Ornament { oriel, balconies, niche, .. } = &mut **ornament;
        if let Some(oriel) = oriel {
            oriel.storeys = (down(oriel.storeys.0), down(oriel.storeys.1));
        }
        if let Some(balconies) = balconies {
            balconies.storeys = (down(balconies.storeys.0), down(balconies.storeys.1));
        }
        if let Some(niche) = niche {
            niche.storey = down(niche.storey);
        }
    }
}
