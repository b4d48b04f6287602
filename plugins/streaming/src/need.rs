//! What viewers need of a city, and how urgently.

use std::collections::{BTreeMap, BTreeSet};

use bevy::math::DVec2;
use veduta_city::bounds::{self, Bounds};
use veduta_city::{GridPos, Level, Portal, metres};
use veduta_ecs::{Eye, Stop};
use veduta_store::{CellEntry, CityIndex};

use crate::motion::Motion;
use crate::{StreamingSettings, Why};

/// A cell that is wanted, and how urgently: rank (0 in sight, 1 in sight from where a viewer may be next), then seconds, then metres.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Need<'a> {
    pub cell: u32,
    pub entry: &'a CellEntry,
    pub rank: u8,
    /// Seconds until it may come into sight; 0 if it is.
    pub in_s: f64,
    pub distance_m: f64,
    pub why: Why,
}

impl Need<'_> {
    /// The finest level that is of use so far away.
    pub fn finest(&self, settings: &StreamingSettings) -> Level {
        match self.distance_m {
            near if near <= settings.level_3_m => Level::Four,
            far if far <= settings.level_2_m => Level::Two,
            _ => Level::One,
        }
    }
}

/// What viewers need of a city, as far as it is told.
pub(crate) struct Needs<'a> {
    index: &'a CityIndex,
    settings: &'a StreamingSettings,
    /// By region, what is needed of each of its cells.
    cells: BTreeMap<u32, Vec<Option<Need<'a>>>>,
    /// Regions that were asked about cells.
    pub used: BTreeSet<u32>,
    /// Those of them that have not come, by rank, in the order in which they were asked.
    pub missing: [Vec<u32>; 2],
}

/// Cells of the skyline are in sight; a region that has not told of its own keeps nobody in the dark.
const SKYLINE_RANK: u8 = 1;
/// As so many cells a region's skyline counts, at most: in a quarter of tall houses others are asked for theirs, too.
const SKYLINE_A_REGION: u32 = 8;

impl<'a> Needs<'a> {
    pub fn new(index: &'a CityIndex, settings: &'a StreamingSettings) -> Self {
        Self { index, settings, cells: BTreeMap::new(), used: BTreeSet::new(), missing: [Vec::new(), Vec::new()] }
    }

    /// All cells that are needed, ascending.
    pub fn cells(&self) -> impl Iterator<Item = &Need<'a>> {
        self.cells.values().flatten().flatten()
    }

    /// Whether a region is here to tell of cells of a rank.
    fn has(&mut self, region: u32, rank: u8) -> bool {
        self.used.insert(region);
        let is_here = self.index.region(region).is_some();
        if !is_here && !self.missing[usize::from(rank)].contains(&region) {
            self.missing[usize::from(rank)].push(region);
        }
        is_here
    }

    /// Adds cells that are needed for the same reason; of a region's, one after another, they are found quickest.
    fn need(&mut self, cells: impl IntoIterator<Item = u32>, why: Why, in_s: f64, eye: &Eye) {
        let (index, rank) = (self.index, rank(why));
        let mut cells = cells.into_iter().peekable();
        while let Some(&first) = cells.peek() {
            let Some(number) = index.region_of(first) else {
                cells.next();
                continue;
            };
            self.has(number, rank);
            let numbers = index.regions[number as usize].numbers();
            let page = index.region(number).map_or(&[][..], |region| &region.cells);
            let needs = self.cells.entry(number).or_insert_with(|| vec![None; page.len()]);
            while let Some(cell) = cells.next_if(|cell| numbers.contains(cell)) {
                let place = (cell - numbers.start) as usize;
                let (Some(entry), Some(need)) = (page.get(place), needs.get_mut(place)) else { continue };
                let distance_m = bounds::distance_m(entry.bounds, eye.plan_pos);
                let old = need.unwrap_or(Need { cell, entry, rank, in_s, distance_m, why });
                *need = Some(Need {
                    rank: old.rank.min(rank),
                    in_s: old.in_s.min(in_s),
                    distance_m: old.distance_m.min(distance_m),
                    why: if rank < old.rank { why } else { old.why },
                    ..old
                });
            }
        }
    }

    /// Adds what one viewer needs.
    pub fn add(&mut self, eye: &Eye, cell: Option<u32>, motion: &Motion) {
        let (index, settings) = (self.index, self.settings);
        if cell.is_none() {
            let pos = GridPos::from_metres(eye.plan_pos);
            index.regions_at(pos).for_each(|region| _ = self.has(region, 0));
        }
        let is_flying = eye.eye_m >= settings.flying_from_m;
        if let Some(cell) = cell
            && !is_flying
        {
            self.need(visible(index, cell), Why::Seen { from: cell }, 0.0, eye);
            // Cells open when all that is seen from them stands: the one that is reached soonest first.
            let next = index.portals(cell).filter_map(|portal| Some((portal.other(cell)?, way_m(portal, eye, motion))));
            let mut ahead: Vec<(u32, f64)> = next.collect();
            ahead.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
            for (next, way_m) in ahead {
                self.add_ahead(next, way_m / motion.pace_m_s(), eye);
            }
        }
        // Above the roofs, or in a place that no cell covers: what is near, whatever stands between.
        if is_flying || cell.is_none() {
            self.near(eye.plan_pos, Why::Near, 0.0, eye);
        }
        self.add_skyline(eye);
    }

    /// Adds what rises above the roofs, as far as it looks tallest.
    fn add_skyline(&mut self, eye: &Eye) {
        let (index, settings) = (self.index, self.settings);
        let rise = |top: i32, bounds: Bounds| {
            let is_within = bounds::distance_m(bounds, eye.plan_pos) <= settings.skyline_m;
            is_within.then(|| rise_per_m(top, bounds, (eye.plan_pos, eye.ground_m)))
        };
        let about = index.regions_about(GridPos::from_metres(eye.plan_pos), GridPos::steps(settings.skyline_m));
        let with_skyline = about.filter(|(_, region)| region.skyline > 0);
        let regions = largest_first(with_skyline.filter_map(|(number, region)| Some((rise(region.top, region.bounds)?, number))));
        let (mut left, mut cells) = (settings.skyline_cells, Vec::new());
        for number in regions {
            if left == 0 {
                break;
            }
            left = left.saturating_sub(index.regions[number as usize].skyline.min(SKYLINE_A_REGION));
            if self.has(number, SKYLINE_RANK) {
                cells.extend(index.region(number).map_or(&[][..], |page| &page.skyline));
            }
        }
        let cells = cells.into_iter().filter_map(|cell| {
            let entry = index.cell(cell)?;
            Some((rise(entry.top, entry.bounds)?, cell))
        });
        self.need(largest_first(cells).take(settings.skyline_cells as usize), Why::Skyline, 0.0, eye);
    }

    /// Adds what is seen from a cell into which a viewer may come.
    pub fn add_ahead(&mut self, from: u32, in_s: f64, eye: &Eye) {
        self.need(visible(self.index, from), Why::Ahead { from }, in_s, eye);
    }

    /// Adds what is seen from where a viewer will be.
    pub fn add_stop(&mut self, stop: &Stop, eye: &Eye) {
        let (index, settings) = (self.index, self.settings);
        let pos = GridPos::from_metres(stop.plan_pos);
        if index.regions_at(pos).filter(|&region| !self.has(region, 1)).count() > 0 {
            return;
        }
        match index.locate(pos).filter(|_| stop.eye_m < settings.flying_from_m) {
            Some(from) => self.add_ahead(from, stop.in_s, eye),
            None => self.near(stop.plan_pos, Why::OnTheWay, stop.in_s, eye),
        }
    }

    /// Adds all that shows level 2 about a place, whatever stands between: beyond, the overview's districts tell as much.
    fn near(&mut self, plan_pos: DVec2, why: Why, in_s: f64, eye: &Eye) {
        let (index, around_m) = (self.index, self.settings.level_2_m);
        for (number, region) in index.regions_about(GridPos::from_metres(plan_pos), GridPos::steps(around_m)) {
            if bounds::distance_m(region.bounds, plan_pos) > around_m || !self.has(number, rank(why)) {
                continue;
            }
            let page = index.region(number).map_or(&[][..], |page| &page.cells);
            let is_near = |(_, entry): &(u32, &CellEntry)| bounds::distance_m(entry.bounds, plan_pos) <= around_m;
            self.need(region.numbers().zip(page).filter(is_near).map(|(cell, _)| cell), why, in_s, eye);
        }
    }
}

/// How tall what rises so high within some bounds looks from a place on the ground, at most: by how much it rises with every metre to it.
pub(crate) fn rise_per_m(top: i32, bounds: Bounds, (plan_pos, ground_m): (DVec2, f64)) -> f64 {
    (metres(top) - ground_m).max(1.0) / bounds::distance_m(bounds, plan_pos).max(1.0)
}

/// Numbers in order of a size of what they name; of what is alike the first.
pub(crate) fn largest_first(sizes: impl Iterator<Item = (f64, u32)>) -> impl Iterator<Item = u32> {
    let mut sizes: Vec<(f64, u32)> = sizes.collect();
    sizes.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    sizes.into_iter().map(|(_, number)| number)
}

/// 0 for what is in sight, 1 for what may come into it.
fn rank(why: Why) -> u8 {
    u8::from(matches!(why, Why::Ahead { .. } | Why::OnTheWay))
}

/// Cells seen from one; none as long as its region has not come.
fn visible(index: &CityIndex, cell: u32) -> impl Iterator<Item = u32> {
    index.cell(cell).map_or(&[][..], |entry| &entry.visible).iter().copied()
}

/// Metres from a viewer to a portal; those behind the back, or that are gone away from, count as so many times as far.
fn way_m(portal: &Portal, eye: &Eye, motion: &Motion) -> f64 {
    const BEHIND: f64 = 2.0;
    let (a, b) = (portal.ends.0.to_metres(), portal.ends.1.to_metres());
    let along = ((eye.plan_pos - a).dot(b - a) / (b - a).length_squared().max(1e-9)).clamp(0.0, 1.0);
    let way = a.lerp(b, along) - eye.plan_pos;
    way.length() * if way.dot(motion.direction(eye)) >= 0.0 { 1.0 } else { BEHIND }
}
