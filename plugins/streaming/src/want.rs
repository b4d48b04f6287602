//! What viewers want, planned from where they are.

use std::collections::BTreeSet;

use bevy::math::DVec2;
use bevy::prelude::*;
use serde::{Deserialize, Serialize};
use veduta_city::{GridPos, Level};
use veduta_ecs::{Awaited, DistrictMemory, Eye, Itinerary, OpenCells, StandingCells, Stop, Viewer};
use veduta_store::CityIndex;

use crate::deliver::LoadedCells;
use crate::fetch::Store;
use crate::memory::Sizes;
use crate::motion::Motion;
use crate::need::Needs;
use crate::pace::Pace;
use crate::rank::{Ranked, Room};
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
    /// What is wished of each cell, ascending.
    wishes: Vec<Wish>,
    /// What of the order was not here when it was planned.
    pub(crate) missing: Vec<(u32, Level)>,
    /// All regions whose cells the list was planned with.
    pub(crate) used: BTreeSet<u32>,
    /// Regions whose overviews are wanted, most urgent first.
    pub overviews: Vec<u32>,
    /// Counts the plans made for this city.
    pub(crate) generation: u64,
    /// What the list was last planned for; `None` if more is told by now.
    planned_for: Option<PlannedFor>,
}

/// Why a cell is wanted, and how much of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wish {
    pub cell: u32,
    pub why: Why,
    /// The finest of its levels that is wanted, after all before it; `None` if there is no room for any.
    pub finest: Option<Level>,
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
        self.finest(cell).is_some()
    }

    /// Why a cell is wanted; `None` if it is not. The memory cap may leave it out all the same.
    #[must_use]
    pub fn why(&self, cell: u32) -> Option<Why> {
        Some(self.wish(cell)?.why)
    }

    /// The finest level of a cell that is wanted, after all before it.
    #[must_use]
    pub fn finest(&self, cell: u32) -> Option<Level> {
        self.wish(cell)?.finest
    }

    fn wish(&self, cell: u32) -> Option<&Wish> {
        let at = self.wishes.binary_search_by_key(&cell, |wish| wish.cell).ok()?;
        self.wishes.get(at)
    }

    /// Has the list planned anew: more is told of the city, or less.
    pub(crate) fn plan_anew(&mut self) {
        self.planned_for = None;
    }

    /// Whether this level of a cell is wanted.
    #[must_use]
    pub fn wants_level(&self, cell: u32, level: Level) -> bool {
        self.finest(cell) >= Some(level)
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

/// Counts what is in sight, or would be from where a viewer is led next, and does not stand.
pub(crate) fn count_awaited(
    store: Option<Res<Store>>,
    settings: Res<StreamingSettings>,
    mut wanted: ResMut<Wanted>,
    standing: Res<StandingCells>,
    led: Query<Ref<Itinerary>, With<Viewer>>,
    mut awaited: ResMut<Awaited>,
) {
    let is_settled = !wanted.is_changed() && !standing.is_changed() && *awaited == Awaited::default();
    if is_settled && !led.iter().any(|itinerary| itinerary.is_changed()) {
        return;
    }
    let index = store.as_ref().and_then(|store| store.client.index());
    let (Some(store), Some(index)) = (store.as_ref(), index) else {
        awaited.set_if_neq(Awaited::default());
        return;
    };
    let lacking = Lacking { store, index, wanted: &wanted, standing: &standing };
    let cells = if is_settled { 0 } else { lacking.in_sight() };
    let firsts = led.iter().filter_map(|itinerary| itinerary.0.first().copied());
    let (mut ahead, mut is_planned) = (0, true);
    for stop in firsts.filter(|stop| stop.eye_m < settings.flying_from_m) {
        let (lacks, knows_all) = lacking.from(GridPos::from_metres(stop.plan_pos));
        (ahead, is_planned) = (ahead + lacks, is_planned && knows_all);
    }
    awaited.set_if_neq(Awaited { cells, ahead });
    if !is_planned {
        // He is led to where none of the stops lay when it was planned last.
        wanted.plan_anew();
    }
}

/// What does not stand, and may yet.
struct Lacking<'a> {
    store: &'a Store,
    index: &'a CityIndex,
    wanted: &'a Wanted,
    standing: &'a StandingCells,
}

impl Lacking<'_> {
    fn is_cell(&self, cell: u32) -> bool {
        !self.standing.levels(cell).has(Level::One) && !self.store.gave_up(cell)
    }

    fn is_region(&self, region: u32) -> bool {
        self.index.region(region).is_none() && !self.store.gave_up_region(region)
    }

    /// How many cells that are in sight, and regions that are to tell of such. What the memory cap leaves out will not come.
    fn in_sight(&self) -> usize {
        let regions = self.wanted.regions.iter().take(self.wanted.regions_in_sight).filter(|&&region| self.is_region(region));
        let cells = self.wanted.in_sight.iter().filter(|&&cell| self.wanted.wants(cell) && self.is_cell(cell));
        regions.count() + cells.count()
    }

    /// The same of a place on the ground; and whether all of them have been planned for.
    fn from(&self, pos: GridPos) -> (usize, bool) {
        let (mut count, mut is_planned) = (0, true);
        for region in self.index.regions_at(pos).filter(|&region| self.is_region(region)) {
            count += 1;
            is_planned &= self.wanted.used.contains(&region);
        }
        let is_told = count == 0;
        let here = self.index.locate(pos).and_then(|cell| self.index.cell(cell));
        for &cell in here.map_or(&[][..], |entry| &entry.visible).iter().filter(|&&cell| self.is_cell(cell)) {
            let wish = self.wanted.wish(cell);
            count += usize::from(wish.is_none_or(|wish| wish.finest.is_some()));
            let is_asked =
                || self.index.region_of(cell).is_some_and(|region| self.is_region(region) && self.wanted.used.contains(&region));
            is_planned &= !is_told || wish.is_some() || is_asked();
        }
        (count, is_planned)
    }
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
    let mut needs = Needs::new(index, &settings);
    for (eye, current, itinerary, motion) in &viewers {
        needs.add(eye, current.and_then(|c| c.0), motion);
        let (stops, cells) = expected(eye, itinerary, motion, &settings);
        cells.iter().for_each(|&(cell, way_m)| needs.add_ahead(cell, way_m / motion.pace_m_s(), eye));
        stops.iter().for_each(|stop| needs.add_stop(stop, eye));
    }
    let room = Room {
        cap: settings.cap_of_cells(*afar),
        sizes: &sizes,
        finer_bytes,
        loaded: loaded.as_deref(),
        gave_up: &|cell, level| store.as_ref().is_some_and(|store| store.gave_up_level(cell, level)),
    };
    let Ranked { order, missing, in_sight, wishes, asked_bytes, is_any_left_out } = Ranked::of(needs.cells(), &settings, &room);
    let left_out_at = is_any_left_out.then_some(stats.bytes_all);
    let [mut regions, later] = needs.missing;
    let regions_in_sight = regions.len();
    regions.extend(later.into_iter().filter(|region| !regions.contains(region)).collect::<Vec<_>>());
    *wanted = Wanted {
        order,
        missing,
        in_sight,
        regions,
        regions_in_sight,
        wishes,
        used: needs.used,
        overviews: core::mem::take(&mut wanted.overviews),
        generation: wanted.generation + 1,
        planned_for: Some(PlannedFor { standpoints, finer_bytes, asked_bytes, left_out_at }),
    };
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
    let about = viewers.iter().filter_map(|current| current.0).flat_map(|cell| {
        let beyond = index.portals(cell).filter_map(move |portal| portal.other(cell));
        beyond.chain([cell])
    });
    let about: BTreeSet<u32> = about.collect();
    // What is open shuts only with a new plan, or where something falls; what could not be had and is tried again shuts nothing.
    if !wanted.is_changed() && !standing.is_changed() && open.cells.as_ref() == Some(&about) {
        return;
    }
    let is_open = |cell: &u32| index.cell(*cell).is_some_and(|entry| entry.visible.iter().all(stands));
    open.set_if_neq(OpenCells { cells: Some(about.into_iter().filter(is_open).collect()) });
}
