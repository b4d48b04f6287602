use std::collections::{BTreeMap, BTreeSet};

use bevy::math::DVec2;
use bevy::prelude::*;
use serde::{Deserialize, Serialize};
use veduta_city::bounds::{self, Bounds};
use veduta_city::{GridPos, Level, Portal, metres};
use veduta_ecs::{Awaited, DistrictMemory, Eye, Itinerary, OpenCells, StandingCells, Stop, Viewer};
use veduta_store::CityIndex;

use crate::deliver::LoadedCells;
use crate::fetch::Store;
use crate::memory::Sizes;
use crate::motion::Motion;
use crate::pace::Pace;
use crate::{CurrentCell, StreamingSettings, StreamingStats};

/// What the viewers need now, most urgent first.
#[derive(Resource, Debug, Clone, Default)]
pub struct Wanted {
    /// Cells and levels in order of urgency.
    pub order: Vec<(u32, Level)>,
    /// Cells in sight of a viewer: these must stand at level 1 for a picture without holes.
    pub in_sight: Vec<u32>,
    /// Regions of the index that are to tell of cells and have not come, most urgent first.
    pub regions: Vec<u32>,
    /// So many of them, the first, are to tell where a viewer is and what is in sight: nobody knows yet what is to be seen.
    pub regions_in_sight: usize,
    /// Why each cell is wanted.
    why: BTreeMap<u32, Why>,
    /// All regions whose cells the list was planned with.
    pub(crate) used: BTreeSet<u32>,
    /// Regions whose overviews are wanted, most urgent first.
    pub overviews: Vec<u32>,
    /// The order again, to be asked whether it has something.
    set: BTreeSet<(u32, Level)>,
    /// Counts the plans made for this city.
    pub(crate) generation: u64,
    /// What the list was last planned for; `None` if more is told by now.
    planned_for: Option<PlannedFor>,
}

/// What a plan was made for.
#[derive(Debug, Clone, PartialEq, Eq)]
struct PlannedFor {
    /// Cells and positions of viewers, and of where they will be, coarsely.
    standpoints: Vec<(Option<u32>, IVec4)>,
    /// So many bytes of finer levels were to be asked for at most, and were.
    finer_bytes: u64,
    asked_bytes: u64,
    /// Bytes that had come by then, if more is wanted than that.
    left_out_at: Option<u64>,
}

impl PlannedFor {
    /// Whether the plan still serves: nobody has gone far, the pace is about the same, and it has work to do or never will.
    fn serves(&self, standpoints: &[(Option<u32>, IVec4)], finer_bytes: u64, stats: &StreamingStats) -> bool {
        let keeps_pace = match self.left_out_at {
            None => self.asked_bytes <= finer_bytes,
            Some(_) => self.finer_bytes / 2 <= finer_bytes && finer_bytes / 2 <= self.finer_bytes,
        };
        let is_done = stats.in_flight == 0 && self.left_out_at.is_some_and(|bytes| bytes != stats.bytes_all);
        self.standpoints == standpoints && keeps_pace && !is_done
    }
}

impl Wanted {
    /// Whether a level of a cell is wanted at all.
    #[must_use]
    pub fn wants(&self, cell: u32) -> bool {
        self.set.range((cell, Level::One)..).next().is_some_and(|&(c, _)| c == cell)
    }

    /// Why a cell is wanted; `None` if it is not. The memory cap may leave it out all the same.
    #[must_use]
    pub fn why(&self, cell: u32) -> Option<Why> {
        self.why.get(&cell).copied()
    }

    /// Has the list planned anew: more is told of the city, or less.
    pub(crate) fn plan_anew(&mut self) {
        self.planned_for = None;
    }

    /// Whether this level of a cell is wanted.
    #[must_use]
    pub fn wants_level(&self, cell: u32, level: Level) -> bool {
        self.set.contains(&(cell, level))
    }
}

/// Why a cell is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Why {
    /// It is seen from the cell in which a viewer is.
    Seen {
        /// That cell.
        from: u32,
    },
    /// It is seen from a cell into which a viewer may walk next, or which lies on a tour's way.
    Ahead {
        /// That cell.
        from: u32,
    },
    /// It is near a place above the roofs, or outside of every cell, to which a tour leads.
    OnTheWay,
    /// It rises above the roofs.
    Skyline,
    /// It is near a viewer who is above the roofs or outside of every cell.
    Near,
}

/// Counts what is in sight and does not stand.
pub(crate) fn count_awaited(
    store: Option<Res<Store>>,
    wanted: Res<Wanted>,
    standing: Res<StandingCells>,
    mut awaited: ResMut<Awaited>,
) {
    if !wanted.is_changed() && !standing.is_changed() && awaited.cells == 0 {
        return;
    }
    let is_told_of = |&&region: &&u32| store.as_ref().is_some_and(|store| !store.gave_up_region(region));
    let regions = wanted.regions.iter().take(wanted.regions_in_sight).filter(is_told_of).count();
    let gave_up = |cell| store.as_ref().is_some_and(|store| store.gave_up(cell));
    // What the memory cap leaves out will not come.
    let is_awaited =
        |&&cell: &&u32| wanted.wants_level(cell, Level::One) && !standing.levels(cell).has(Level::One) && !gave_up(cell);
    let cells = wanted.in_sight.iter().filter(is_awaited).count();
    awaited.set_if_neq(Awaited { cells: cells + regions });
}

/// How urgently a cell is wanted: rank (0 in sight, 1 in sight from where a viewer may be next), then seconds, then metres.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Need {
    rank: u8,
    /// Seconds until it may come into sight; 0 if it is.
    in_s: f64,
    distance_m: f64,
    finest: Level,
    why: Why,
}

/// What viewers need of a city, as far as it is told.
struct Needs<'a> {
    index: &'a CityIndex,
    settings: &'a StreamingSettings,
    cells: BTreeMap<u32, Need>,
    /// Regions that were asked about cells.
    used: BTreeSet<u32>,
    /// Those of them that have not come, by rank, in the order in which they were asked.
    missing: [Vec<u32>; 2],
}

/// Cells of the skyline are in sight; a region that has not told of its own keeps nobody in the dark.
const SKYLINE_RANK: u8 = 1;
/// As so many cells a region's skyline counts, at most: in a quarter of tall houses others are asked for theirs, too.
const SKYLINE_A_REGION: u32 = 8;

impl Needs<'_> {
    /// Whether a region is here to tell of cells of a rank.
    fn has(&mut self, region: u32, rank: u8) -> bool {
        self.used.insert(region);
        let is_here = self.index.region(region).is_some();
        if !is_here && !self.missing[usize::from(rank)].contains(&region) {
            self.missing[usize::from(rank)].push(region);
        }
        is_here
    }

    fn need(&mut self, cell: u32, why: Why, in_s: f64, eye: &Eye) {
        let rank = rank(why);
        let Some(region) = self.index.region_of(cell) else { return };
        if !self.has(region, rank) {
            return;
        }
        let Some(entry) = self.index.cell(cell) else { return };
        let distance_m = bounds::distance_m(entry.bounds, eye.plan_pos);
        let finest = match distance_m {
            near if near <= self.settings.level_3_m => Level::Four,
            far if far <= self.settings.level_2_m => Level::Two,
            _ => Level::One,
        };
        let new = Need { rank, in_s, distance_m, finest, why };
        let nearer = |old: &mut Need| {
            *old = Need {
                rank: old.rank.min(rank),
                in_s: old.in_s.min(in_s),
                distance_m: old.distance_m.min(distance_m),
                finest: old.finest.max(finest),
                why: if rank < old.rank { why } else { old.why },
            };
        };
        self.cells.entry(cell).and_modify(nearer).or_insert(new);
    }

    /// Adds what one viewer needs.
    fn add(&mut self, eye: &Eye, cell: Option<u32>, motion: &Motion) {
        let (index, settings) = (self.index, self.settings);
        if cell.is_none() {
            let pos = GridPos::from_metres(eye.plan_pos);
            index.regions_at(pos).for_each(|region| _ = self.has(region, 0));
        }
        let is_flying = eye.eye_m >= settings.flying_from_m;
        if let Some(cell) = cell
            && !is_flying
        {
            for &seen in visible(index, cell) {
                self.need(seen, Why::Seen { from: cell }, 0.0, eye);
            }
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
        for cell in largest_first(cells).take(settings.skyline_cells as usize) {
            self.need(cell, Why::Skyline, 0.0, eye);
        }
    }

    /// Adds what is seen from a cell into which a viewer may come.
    fn add_ahead(&mut self, from: u32, in_s: f64, eye: &Eye) {
        for &seen in visible(self.index, from) {
            self.need(seen, Why::Ahead { from }, in_s, eye);
        }
    }

    /// Adds what is seen from where a viewer will be.
    fn add_stop(&mut self, stop: &Stop, eye: &Eye) {
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
            for (cell, entry) in region.numbers().zip(page) {
                if bounds::distance_m(entry.bounds, plan_pos) <= around_m {
                    self.need(cell, why, in_s, eye);
                }
            }
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

/// Where a viewer will be, and cells that he will come into, each with the metres to it: as an itinerary tells, else as he moves.
fn expected<'a>(
    eye: &Eye,
    itinerary: &Itinerary,
    motion: &'a Motion,
    settings: &StreamingSettings,
) -> (Vec<Stop>, &'a [(u32, f64)]) {
    if !itinerary.0.is_empty() {
        return (itinerary.0.clone(), &[]);
    }
    if eye.eye_m < settings.flying_from_m {
        return (Vec::new(), &motion.ahead);
    }
    (motion.is_moving().then(|| motion.stop(eye)).into_iter().collect(), &[])
}

/// Plans anew when a viewer has changed cell or moved eight metres or up or down as much, when other cells lie ahead of him, when more of the
/// city is told, when the line has become slower than what is asked for, or can bring what was left out.
pub(crate) fn plan_wanted(
    store: Option<Res<Store>>,
    settings: Res<StreamingSettings>,
    viewers: Query<(&Eye, Option<&CurrentCell>, &Itinerary, &Motion), With<Viewer>>,
    (pace, stats, loaded): (Res<Pace>, Res<StreamingStats>, Option<Res<LoadedCells>>),
    (sizes, afar): (Res<Sizes>, Res<DistrictMemory>),
    mut wanted: ResMut<Wanted>,
) {
    let Some(index) = store.as_ref().and_then(|store| store.client.index()) else { return };
    let coarse = |plan_pos: DVec2, ground_m: f64, eye_m: f64| {
        let p = (plan_pos / 8.0).floor();
        IVec4::new(p.x as i32, p.y as i32, (ground_m / 8.0).round() as i32, (eye_m / 8.0) as i32)
    };
    let standpoints: Vec<(Option<u32>, IVec4)> = viewers
        .iter()
        .flat_map(|(eye, current, itinerary, motion)| {
            let here = (current.and_then(|c| c.0), coarse(eye.plan_pos, eye.ground_m, eye.eye_m));
            let (stops, cells) = expected(eye, itinerary, motion, &settings);
            let stops = stops.into_iter().map(|stop| (None, coarse(stop.plan_pos, 0.0, stop.eye_m)));
            let cells = cells.iter().map(|&(cell, _)| (Some(cell), IVec4::ZERO));
            core::iter::once(here).chain(stops).chain(cells).collect::<Vec<_>>()
        })
        .collect();
    let finer_bytes = pace.bytes_within(settings.finer_within_s);
    let serves = wanted.planned_for.as_ref().is_some_and(|planned| planned.serves(&standpoints, finer_bytes, &stats));
    if serves && !settings.is_changed() {
        return;
    }
    let mut needs =
        Needs { index, settings: &settings, cells: BTreeMap::new(), used: BTreeSet::new(), missing: [Vec::new(), Vec::new()] };
    for (eye, current, itinerary, motion) in &viewers {
        needs.add(eye, current.and_then(|c| c.0), motion);
        let (stops, cells) = expected(eye, itinerary, motion, &settings);
        cells.iter().for_each(|&(cell, way_m)| needs.add_ahead(cell, way_m / motion.pace_m_s(), eye));
        stops.iter().for_each(|stop| needs.add_stop(stop, eye));
    }
    // What is here, or will not come, costs the line nothing.
    let is_free = |cell: u32, level: Level| {
        let is_loaded = loaded.as_ref().and_then(|loaded| loaded.level(cell)) >= Some(level);
        is_loaded || store.as_ref().is_some_and(|store| store.gave_up_level(cell, level))
    };
    let cap = (settings.cap_of_cells(*afar), &*sizes);
    let Ranked { order, in_sight, asked_bytes, is_any_left_out } =
        ranked(index, &needs.cells, settings.finest, cap, (finer_bytes, &is_free));
    let left_out_at = is_any_left_out.then_some(stats.bytes_all);
    let [mut regions, later] = needs.missing;
    let regions_in_sight = regions.len();
    regions.extend(later.into_iter().filter(|region| !regions.contains(region)).collect::<Vec<_>>());
    *wanted = Wanted {
        set: order.iter().copied().collect(),
        order,
        in_sight,
        regions,
        regions_in_sight,
        why: needs.cells.iter().map(|(&cell, need)| (cell, need.why)).collect(),
        used: needs.used,
        overviews: core::mem::take(&mut wanted.overviews),
        generation: wanted.generation + 1,
        planned_for: Some(PlannedFor { standpoints, finer_bytes, asked_bytes, left_out_at }),
    };
}

/// Cells seen from one; none as long as its region has not come.
fn visible(index: &CityIndex, cell: u32) -> &[u32] {
    index.cell(cell).map_or(&[], |entry| &entry.visible)
}

/// Metres from a viewer to a portal; those behind the back, or that are gone away from, count as so many times as far.
fn way_m(portal: &Portal, eye: &Eye, motion: &Motion) -> f64 {
    const BEHIND: f64 = 2.0;
    let (a, b) = (portal.ends.0.to_metres(), portal.ends.1.to_metres());
    let along = ((eye.plan_pos - a).dot(b - a) / (b - a).length_squared().max(1e-9)).clamp(0.0, 1.0);
    let way = a.lerp(b, along) - eye.plan_pos;
    way.length() * if way.dot(motion.direction(eye)) >= 0.0 { 1.0 } else { BEHIND }
}

/// Opens the cells about viewers from which nothing would be missing.
pub(crate) fn open_cells(
    store: Option<Res<Store>>,
    wanted: Res<Wanted>,
    standing: Res<StandingCells>,
    viewers: Query<&CurrentCell, With<Viewer>>,
    mut open: ResMut<OpenCells>,
) {
    let Some((store, index)) = store.as_ref().and_then(|store| Some((store, store.client.index()?))) else {
        open.set_if_neq(OpenCells { cells: Some(BTreeSet::new()) });
        return;
    };
    let stands = |&cell: &u32| {
        // What the memory cap leaves out will not come.
        standing.levels(cell).has(Level::One)
            || store.gave_up(cell)
            || (index.cell(cell).is_some() && !wanted.wants_level(cell, Level::One))
    };
    let is_open = |cell: &u32| index.cell(*cell).is_some_and(|entry| entry.visible.iter().all(stands));
    let about = viewers.iter().filter_map(|current| current.0).flat_map(|cell| {
        let beyond = index.portals(cell).filter_map(move |portal| portal.other(cell));
        beyond.chain([cell])
    });
    let about: BTreeSet<u32> = about.collect();
    open.set_if_neq(OpenCells { cells: Some(about.into_iter().filter(is_open).collect()) });
}

/// What may be seen so soon comes before the finer levels of what is in sight; seconds.
const NEXT_S: f64 = 14.0;

/// What is wanted, in order.
struct Ranked {
    order: Vec<(u32, Level)>,
    in_sight: Vec<u32>,
    /// Bytes of finer levels among it that are to come over the line.
    asked_bytes: u64,
    /// Whether finer levels are wanted that the line is too slow for.
    is_any_left_out: bool,
}

/// Level 1 of all that is in sight, then of what is in sight from beyond a near portal, then the finer levels, then level 1 of what is
/// farther ahead; nearest first, as far as the memory cap goes: what comes last is the first to be left out. Of finer levels that
/// are not free, no more than so many bytes, but the first.
fn ranked(
    index: &CityIndex,
    needs: &BTreeMap<u32, Need>,
    finest: u8,
    (cap, sizes): (u64, &Sizes),
    (finer_bytes, is_free): (u64, &dyn Fn(u32, Level) -> bool),
) -> Ranked {
    let mut cells: Vec<(u32, Need)> = needs.iter().map(|(&cell, &need)| (cell, need)).collect();
    cells.sort_by(|a, b| {
        a.1.rank
            .cmp(&b.1.rank)
            .then(a.1.in_s.total_cmp(&b.1.in_s))
            .then(a.1.distance_m.total_cmp(&b.1.distance_m))
            .then(a.0.cmp(&b.0))
    });
    let bytes = |cell: u32, level: Level| index.cell(cell).and_then(|entry| entry.packet(level)).map(|blob| u64::from(blob.bytes));
    let (mut order, mut sum, mut reached) = (Vec::new(), 0, BTreeMap::<u32, Level>::new());
    let (mut asked_bytes, mut is_any_left_out) = (0, false);
    let mut take = |cell: u32, level: Level| {
        // A finer level without the one before it is of no use.
        let is_next = reached.get(&cell).map_or(0, |last| last.index() + 1) == level.index();
        let Some(sent) = bytes(cell, level).filter(|_| is_next) else { return };
        let memory = sizes.of(cell, level, sent);
        if sum + memory > cap {
            return;
        }
        let costs = if level == Level::One || is_free(cell, level) { 0 } else { sent };
        // However slow the line, the first comes in the end.
        if costs > 0 && asked_bytes > 0 && asked_bytes + costs > finer_bytes {
            is_any_left_out = true;
            return;
        }
        asked_bytes += costs;
        sum += memory;
        reached.insert(cell, level);
        order.push((cell, level));
    };
    let of_rank = |rank: u8| cells.iter().filter(move |(_, need)| need.rank == rank);
    of_rank(0).for_each(|&(cell, _)| take(cell, Level::One));
    // Whoever is about to walk on must not stand before a shut door.
    of_rank(1).filter(|(_, need)| need.in_s <= NEXT_S).for_each(|&(cell, _)| take(cell, Level::One));
    for level in [Level::Two, Level::Three, Level::Four] {
        let is_allowed = |need: &Need| level <= need.finest && level as u8 <= finest;
        of_rank(0).filter(|(_, need)| is_allowed(need)).for_each(|&(cell, _)| take(cell, level));
    }
    of_rank(1).filter(|(_, need)| need.in_s > NEXT_S).for_each(|&(cell, _)| take(cell, Level::One));
    let in_sight = cells.iter().filter(|(_, need)| need.rank == 0).map(|(cell, _)| *cell).collect();
    Ranked { order, in_sight, asked_bytes, is_any_left_out }
}
