use std::collections::{BTreeMap, BTreeSet};

use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_city::{Level, metres};
use veduta_ecs::{Awaited, Eye, StandingCells, Viewer};
use veduta_store::{CellEntry, CityIndex};

use crate::fetch::Store;
use crate::{CurrentCell, StreamingSettings};

/// What the viewers need now, most urgent first.
#[derive(Resource, Debug, Clone, Default)]
pub struct Wanted {
    /// Cells and levels in order of urgency.
    pub order: Vec<(u32, Level)>,
    /// Cells in sight of a viewer: these must stand at level 1 for a picture without holes.
    pub in_sight: Vec<u32>,
    /// The order again, to be asked whether it has something.
    set: BTreeSet<(u32, Level)>,
    /// Counts the plans made for this city.
    pub(crate) generation: u64,
    /// What the list was last planned for: a viewer's cell and position, coarsely.
    planned_for: Vec<(Option<u32>, IVec3)>,
}

impl Wanted {
    /// Whether a level of a cell is wanted at all.
    #[must_use]
    pub fn wants(&self, cell: u32) -> bool {
        self.set.range((cell, Level::One)..).next().is_some_and(|&(c, _)| c == cell)
    }

    /// Whether this level of a cell is wanted.
    #[must_use]
    pub fn wants_level(&self, cell: u32, level: Level) -> bool {
        self.set.contains(&(cell, level))
    }
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
    let gave_up = |cell| store.as_ref().is_some_and(|store| store.client.gave_up(cell, Level::One));
    // Level 1 of what is in sight leads the order; what the memory cap leaves out is not in it.
    let lead = wanted.order.iter().take(wanted.in_sight.len()).filter(|&&(_, level)| level == Level::One);
    let cells = lead.filter(|&&(cell, _)| !standing.levels(cell).has(Level::One) && !gave_up(cell)).count();
    awaited.set_if_neq(Awaited { cells });
}

/// How urgently a cell is wanted: rank (0 in sight, 1 next to it), then metres.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Need {
    rank: u8,
    distance_m: f64,
    finest: Level,
}

/// Plans anew when a viewer has changed cell or moved eight metres.
pub(crate) fn plan_wanted(
    store: Option<Res<Store>>,
    settings: Res<StreamingSettings>,
    viewers: Query<(&Eye, Option<&CurrentCell>), With<Viewer>>,
    mut wanted: ResMut<Wanted>,
) {
    let Some(index) = store.as_ref().and_then(|store| store.client.index()) else { return };
    let standpoints: Vec<(Option<u32>, IVec3)> = viewers
        .iter()
        .map(|(eye, current)| {
            let p = (eye.plan_pos / 8.0).floor();
            (current.and_then(|c| c.0), IVec3::new(p.x as i32, p.y as i32, (eye.eye_m / 8.0) as i32))
        })
        .collect();
    if standpoints == wanted.planned_for && !settings.is_changed() {
        return;
    }
    let mut needs: BTreeMap<u32, Need> = BTreeMap::new();
    for (eye, current) in &viewers {
        add_needs(index, &settings, eye, current.and_then(|c| c.0), &mut needs);
    }
    let (order, in_sight) = ranked(index, &needs, &settings);
    let (set, generation) = (order.iter().copied().collect(), wanted.generation + 1);
    *wanted = Wanted { order, in_sight, set, generation, planned_for: standpoints };
}

fn add_needs(index: &CityIndex, settings: &StreamingSettings, eye: &Eye, cell: Option<u32>, needs: &mut BTreeMap<u32, Need>) {
    let mut need = |cell: u32, rank: u8| {
        let Some(entry) = index.cells.get(cell as usize) else { return };
        let distance_m = distance_to(entry, eye.plan_pos);
        let finest = if distance_m <= settings.level_2_m { Level::Four } else { Level::One };
        let new = Need { rank, distance_m, finest };
        needs
            .entry(cell)
            .and_modify(|old| {
                *old =
                    Need { rank: old.rank.min(rank), distance_m: old.distance_m.min(distance_m), finest: old.finest.max(finest) };
            })
            .or_insert(new);
    };
    let flying = eye.eye_m >= settings.flying_from_m;
    if let Some(cell) = cell
        && !flying
    {
        let visible = index.cells.get(cell as usize).map_or(&[][..], |c| &c.visible);
        for &seen in visible {
            need(seen, 0);
            let portals = index.cells.get(seen as usize).map_or(&[][..], |c| &c.portals);
            for beyond in portals.iter().filter_map(|&p| index.portals.get(p as usize)?.other(seen)) {
                need(beyond, 1);
            }
        }
    }
    // Above the roofs, or in a place that no cell covers: what is near, whatever stands between.
    let around_m = if flying {
        settings.flying_m
    } else if cell.is_none() {
        settings.level_2_m
    } else {
        0.0
    };
    if around_m > 0.0 {
        for (i, entry) in index.cells.iter().enumerate() {
            if distance_to(entry, eye.plan_pos) <= around_m {
                need(i as u32, 0);
            }
        }
    }
    for &tall in &index.skyline {
        if index.cells.get(tall as usize).is_some_and(|entry| distance_to(entry, eye.plan_pos) <= settings.skyline_m) {
            need(tall, 0);
        }
    }
}

/// Distance in metres from a plan position to the box of what is drawn with a cell; 0 inside.
fn distance_to(entry: &CellEntry, plan_pos: DVec2) -> f64 {
    let (lo, hi) = entry.bounds;
    let (lo, hi) = (DVec2::new(metres(lo.0), metres(lo.1)), DVec2::new(metres(hi.0), metres(hi.1)));
    plan_pos.distance(plan_pos.clamp(lo.min(hi), hi.max(lo)))
}

/// Level 1 of all that is in sight, then its finer levels, then level 1 of what lies next to it; nearest first, as far as
/// the memory cap goes: the furthest finer levels are the first to be left out.
fn ranked(index: &CityIndex, needs: &BTreeMap<u32, Need>, settings: &StreamingSettings) -> (Vec<(u32, Level)>, Vec<u32>) {
    let mut cells: Vec<(u32, Need)> = needs.iter().map(|(&cell, &need)| (cell, need)).collect();
    cells.sort_by(|a, b| a.1.rank.cmp(&b.1.rank).then(a.1.distance_m.total_cmp(&b.1.distance_m)).then(a.0.cmp(&b.0)));
    let bytes = |cell: u32, level: Level| {
        index.cells.get(cell as usize).and_then(|c| c.packets[level.index()].as_ref()).map(|blob| u64::from(blob.bytes))
    };
    let (mut order, mut sum, mut reached) = (Vec::new(), 0, BTreeMap::new());
    for rank in [0, 1] {
        for level in Level::ALL {
            for (cell, need) in cells.iter().filter(|(_, need)| need.rank == rank) {
                let allowed = level == Level::One || (rank == 0 && level <= need.finest && level as u8 <= settings.finest);
                let Some(size) = bytes(*cell, level).filter(|_| allowed) else { continue };
                // A finer level without the one before it is of no use.
                let stands =
                    level == Level::One || reached.get(cell).is_some_and(|&last: &Level| last.index() + 1 == level.index());
                if stands && sum + size <= settings.memory_cap_bytes {
                    sum += size;
                    reached.insert(*cell, level);
                    order.push((*cell, level));
                }
            }
        }
    }
    (order, cells.iter().filter(|(_, need)| need.rank == 0).map(|(cell, _)| *cell).collect())
}
