use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_city::{GridPos, Level, bounds, metres};
use veduta_ecs::{
    Awaited, Cell, CellContent, CellMemory, CellMesh, CellReady, CellReleased, City, CityFailed, CityOpened, Eye, LevelFade,
    OpenCity, Overviews, Rim, StandingCells, Viewer, WorldOrigin,
};
use veduta_store::{CityIndex, Client, ClientEvent, Packet, StoreError, What, sheet_fits};

use crate::fetch::Store;
use crate::files::CityFiles;
use crate::journal::{Event, Journal, Reason};
use crate::link::Link;
use crate::memory::Sizes;
use crate::pace::Pace;
use crate::{StreamingSettings, Wanted};

/// Figures of streaming, for diagnostics and films.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StreamingStats {
    /// Bytes of packets received, by level.
    pub bytes_received: [u64; 4],
    /// Bytes of packets that are loaded, as sent.
    pub bytes_loaded: u64,
    /// Bytes of memory of the cells that are loaded: their packets, and what is made of them, measured or expected. The cap holds it.
    pub bytes_in_memory: u64,
    /// Requests under way.
    pub in_flight: usize,
    /// Requests made.
    pub requests: u64,
    /// Bytes of all that was received: index, regions, overview, packets.
    pub bytes_all: u64,
    /// Requests that failed.
    pub failures: u64,
    /// Cells that have an entity.
    pub cells: usize,
}

/// Seconds added to the app's time when failed requests wait to be tried again. Who stops the app's time, as films do, moves
/// this on instead.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Default)]
pub struct RetryTime(
    /// Seconds.
    pub f64,
);

/// Entity, last time wanted and bytes of every loaded cell.
#[derive(Resource, Default)]
pub(crate) struct LoadedCells {
    cells: BTreeMap<u32, LoadedCell>,
    /// When it is to be looked through again for what may go.
    sweep_s: f64,
    /// The plan of what is wanted, overviews included, that was there in the last frame.
    plan: u64,
}

impl LoadedCells {
    /// The finest level of a cell that is loaded.
    pub fn level(&self, cell: u32) -> Option<Level> {
        self.cells.get(&cell)?.levels.last().map(|last| last.level)
    }

    /// Bytes of memory of all.
    fn memory(&self) -> u64 {
        self.cells.values().map(LoadedCell::memory).sum()
    }

    /// A level of a cell, if it is loaded.
    pub fn level_mut(&mut self, cell: u32, level: Level) -> Option<&mut LoadedLevel> {
        self.cells.get_mut(&cell)?.levels.iter_mut().find(|here| here.level == level)
    }
}

/// Cells that nobody wants are looked for so often, seconds; at once where memory runs over.
const SWEEP_S: f64 = 0.25;
/// A frame that has planned has done enough: so long, in seconds, it is left to the next one that has not.
const SWEEP_WAITS_S: f64 = 0.25;
/// So many of them go in a frame.
const RELEASED_A_FRAME: usize = 4;

struct LoadedCell {
    entity: Entity,
    /// The levels that are here, coarsest first: each after the one before it.
    levels: Vec<LoadedLevel>,
}

/// A level of a cell that is here.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LoadedLevel {
    level: Level,
    /// Bytes of its packet, as sent.
    pub(crate) sent: u64,
    /// Bytes of memory of its packet and what is made of it.
    pub(crate) memory: u64,
    wanted_at_s: f64,
}

impl LoadedCell {
    /// The coarsest of its levels that nobody has wanted since then, with all finer ones; [`Level::One`] takes the cell with it.
    fn idle_since(&self, then_s: f64) -> Option<Level> {
        let idle = self.levels.iter().rev().take_while(|level| level.wanted_at_s < then_s);
        idle.last().map(|level| level.level)
    }

    fn memory(&self) -> u64 {
        self.levels.iter().map(|level| level.memory).sum()
    }
}

/// Takes what has arrived, within the frame's budget, and asks for what is wanted.
pub(crate) fn deliver(world: &mut World) {
    let Some(mut store) = world.remove_resource::<Store>() else {
        world.remove_resource::<LoadedCells>();
        return;
    };
    if store.client.index().is_none() {
        // Freshly opened: nothing of an earlier city stays on the books.
        world.insert_resource(LoadedCells::default());
        world.insert_resource(StreamingStats::default());
        world.insert_resource(Pace::default());
        world.insert_resource(Sizes::default());
    }
    let now_s = world.resource::<Time>().elapsed_secs_f64() + world.resource::<RetryTime>().0;
    (store.now_s, store.link) = (now_s, *world.resource::<Link>());
    let wanted = world.resource::<Wanted>();
    if store.told != Some(wanted.generation) {
        store.told = Some(wanted.generation);
        store.client.want(wanted.missing.iter().copied());
        let (first, later) = wanted.regions.split_at(wanted.regions_in_sight);
        store.client.want_regions(first.iter().copied(), later.iter().copied());
        let cancelled = store.cancel_unwanted();
        for what in cancelled {
            note(world, Event::Cancelled { what });
        }
    }
    store.client.want_files(world.get_resource::<CityFiles>().into_iter().flat_map(CityFiles::wanted));
    // Maps can wait until what is in sight stands.
    let is_planned = store.client.index().is_some() && store.told.is_some_and(|generation| generation > 0);
    let due = if is_planned && world.resource::<Awaited>().cells == 0 { &*world.resource::<Wanted>().overviews } else { &[] };
    store.client.want_overviews(due.iter().copied());
    let settings = *world.resource::<StreamingSettings>();
    let (mut taken, before) = (0, store.client.stats().bytes);
    loop {
        while !settings.paused
            && let Some(request) = store.client.next_request(now_s)
        {
            let (what, bytes) = (request.what, request.blob.map_or(0, |blob| blob.bytes.into()));
            let why = if let What::Packet { cell, .. } = what { world.resource::<Wanted>().why(cell) } else { None };
            note(world, Event::Asked { what, bytes, why });
            store.ask(request);
        }
        // One answer is taken however large it is.
        if taken >= settings.packets_a_frame.max(1) || (taken > 0 && store.client.stats().bytes - before >= settings.bytes_a_frame)
        {
            break;
        }
        let Some((id, result)) = store.answer() else { break };
        let before = store.client.stats().bytes;
        for event in store.client.deliver(id, result, now_s) {
            let bytes = store.client.stats().bytes - before;
            on_event(world, &mut store, event, bytes);
        }
        taken += 1;
    }
    give_up_overviews(world, &store.client, now_s);
    forget_idle(world, &mut store.client);
    let stats = store.client.stats();
    let was_waiting = world.resource::<StreamingStats>().in_flight > 0;
    world.resource_mut::<Pace>().pass(now_s, was_waiting, stats.bytes - before);
    let mut figures = world.resource_mut::<StreamingStats>();
    figures.in_flight = stats.in_flight;
    figures.failures = stats.failures;
    figures.requests = stats.requests;
    figures.bytes_all = stats.bytes;
    world.insert_resource(store);
}

/// So many regions that nothing was planned with stay, and as many again as are in use; of more the farthest goes, one a frame. The same of
/// parts of the overview.
const IDLE_REGIONS: usize = 16;

fn forget_idle(world: &mut World, client: &mut Client) {
    let wanted = world.resource::<Wanted>();
    let Some(index) = client.index() else { return };
    let is_too_many = |here: usize, in_use: usize| here > IDLE_REGIONS + 2 * in_use;
    // What is to come needs its region, which is not done with until then.
    let city = world.get_resource::<City>();
    let is_to_come = |part: &u32| wanted.overviews.contains(part) && city.is_some_and(|city| city.overviews.get(*part).is_none());
    let region = is_too_many(index.regions_here_count(), wanted.used.len()).then(|| {
        let here = index.regions_here().map(|(number, _)| number);
        farthest(index, here.filter(|number| !wanted.used.contains(number) && !is_to_come(number)), wanted)
    });
    let part = city.and_then(|city| {
        let here = || city.overviews.iter().map(|(part, _)| part);
        let idle = here().filter(|part| !wanted.overviews.contains(part));
        is_too_many(here().count(), wanted.overviews.len()).then(|| farthest(index, idle, wanted))?
    });
    if let Some(number) = region.flatten() {
        client.forget_region(number);
    }
    if let (Some(part), Some(mut city)) = (part, world.get_resource_mut::<City>()) {
        client.forget_overview(part);
        city.overviews.put(part, None);
    }
}

/// The region that is farthest from the part of the overview that is wanted first, which is about a viewer.
fn farthest(index: &CityIndex, idle: impl Iterator<Item = u32>, wanted: &Wanted) -> Option<u32> {
    let middle = |number: u32| {
        let (lo, hi) = index.regions.get(number as usize).map_or_else(Default::default, |region| region.bounds);
        (lo.to_metres() + hi.to_metres()) / 2.0
    };
    let here = wanted.overviews.first().map_or_else(Default::default, |&part| middle(part));
    idle.max_by(|&a, &b| middle(a).distance_squared(here).total_cmp(&middle(b).distance_squared(here)))
}

/// Who waits for a part of the overview that cannot be had goes on without it.
fn give_up_overviews(world: &mut World, client: &Client, now_s: f64) {
    let wanted = &world.resource::<Wanted>().overviews;
    let lost: Vec<u32> = wanted.iter().copied().filter(|&part| client.gave_up_overview(part, now_s)).collect();
    let Some(mut city) = world.get_resource_mut::<City>() else { return };
    for part in lost {
        if city.overviews.get(part).is_none() {
            city.overviews.put(part, Some(Arc::default()));
        }
    }
}

fn note(world: &mut World, event: Event) {
    let at_s = world.resource::<Time>().elapsed_secs_f64();
    world.resource_mut::<Journal>().note(at_s, event);
}

/// Takes what came of a request, and how many bytes came.
fn on_event(world: &mut World, store: &mut Store, event: ClientEvent, bytes: u64) {
    match event {
        ClientEvent::RegionReady(number) => {
            note(world, Event::Arrived { what: What::Region(number), bytes });
            world.resource_mut::<Wanted>().plan_anew();
        }
        ClientEvent::Opened => {
            note(world, Event::Arrived { what: What::Index, bytes });
            if let Some(index) = store.client.index() {
                open(world, index);
            }
        }
        ClientEvent::Ready(what) => note(world, Event::Arrived { what, bytes }),
        ClientEvent::OverviewReady { region, overview } => {
            note(world, Event::Arrived { what: What::Overview(region), bytes });
            if let Some(mut city) = world.get_resource_mut::<City>() {
                city.overviews.put(region, Some(overview));
            }
        }
        ClientEvent::FileReady { number, content } => {
            note(world, Event::Arrived { what: What::File(number), bytes });
            store.client.forget_file(number);
            if let Some(mut files) = world.get_resource_mut::<CityFiles>() {
                files.bring(number, &content);
            }
        }
        ClientEvent::Arrived { cell, level, packet } => arrive(world, store, cell, level, packet),
        ClientEvent::Failed { what, error, again_in_s } => {
            let message = match again_in_s {
                Some(s) => format!("{what}: {error}; trying again in {s:.1} s"),
                None => format!("{what}: {error}"),
            };
            warn!("{message}");
            let message = outage(world, &error).unwrap_or(message);
            if let (What::File(number), None, Some(mut files)) = (what, again_in_s, world.get_resource_mut::<CityFiles>()) {
                files.fail(number, &error);
            }
            note(world, Event::Failed { what, error: error.to_string(), again_in_s });
            world.write_message(CityFailed { message, will_retry: again_in_s.is_some() });
        }
    }
}

/// What is told alike of all that fails because nobody answers.
fn outage(world: &World, error: &StoreError) -> Option<String> {
    let place = &world.get_resource::<OpenCity>()?.0;
    let is_outage = matches!(error, StoreError::Read(error) if error.is_outage());
    is_outage.then(|| format!("{place} cannot be reached: what is here stays, and the rest follows when it can"))
}

fn open(world: &mut World, index: &CityIndex) {
    // The floating origin begins on a whole metre at the start, so that positions there are exact.
    let plan = GridPos(GridPos::steps(index.start.pos.x.round()), GridPos::steps(index.start.pos.y.round()));
    *world.resource_mut::<WorldOrigin>() = WorldOrigin { plan };
    let files: Vec<String> = index.files.iter().map(|file| file.path.clone()).collect();
    let can_load = world.contains_resource::<CityFiles>();
    if !can_load && !files.is_empty() {
        info_once!("what is told of {} travels with it: add CityAssetsPlugin before DefaultPlugins to have it loaded", index.name);
    }
    let files = if can_load { files } else { Vec::new() };
    world.insert_resource(City {
        name: index.name.clone(),
        attribution: index.attribution.clone(),
        anchor: index.anchor,
        start: index.start,
        extent: index.extent.clone(),
        rim: Rim::of(index.regions.iter().filter(|region| region.cells > 0).map(|region| (region.bounds, metres(region.top)))),
        overviews: Overviews::awaited(index.regions.iter().map(|region| region.bounds)),
        files,
    });
    info!("{}: {} cells", index.name, index.cell_count());
    world.write_message(CityOpened);
}

fn arrive(world: &mut World, store: &mut Store, cell: u32, level: Level, packet: Packet) {
    let now_s = world.resource::<Time>().elapsed_secs_f64();
    let blob = store.client.index().and_then(|index| index.cell(cell)?.packet(level));
    let bytes = blob.map_or(0, |blob| u64::from(blob.bytes));
    let origin = *world.resource::<WorldOrigin>();
    let known = world.resource::<LoadedCells>().cells.get(&cell);
    let next = known.map_or(0, |loaded| loaded.levels.len());
    if level.index() != next {
        // It is here already; or its cell, or a level before it, was released meanwhile: whoever wants it asks anew, in order.
        if level.index() > next {
            store.client.forget(cell, level);
        }
        return;
    }
    let entity = match (packet, known.map(|loaded| loaded.entity)) {
        (Packet::Shell(shell), None) => {
            let at = Transform::from_translation(origin.world_from_grid(shell.origin));
            let content = CellContent { shell: Arc::from(shell), sheet: None, pictures: None };
            world.spawn((Cell(cell), content, LevelFade::default(), at)).id()
        }
        (Packet::Facades(sheet), Some(entity)) => {
            let Some(mut content) = world.get_mut::<CellContent>(entity) else { return };
            if !sheet_fits(&content.shell, &sheet) {
                let message = format!("cell {cell}: its level 2 does not fit its level 1; bake the city again");
                error!("{message}");
                store.client.reject(cell, level);
                world.write_message(CityFailed { message, will_retry: false });
                return;
            }
            content.sheet = Some(Arc::new(sheet));
            entity
        }
        (Packet::Pictures(pictures), Some(entity)) => {
            let Some(mut content) = world.get_mut::<CellContent>(entity) else { return };
            content.pictures = Some(pictures.into());
            entity
        }
        // A packet of another kind than its level's is not decoded.
        _ => return,
    };
    let memory = world.resource::<Sizes>().of(cell, level, bytes);
    let mut loaded = world.resource_mut::<LoadedCells>();
    let entry = loaded.cells.entry(cell).or_insert(LoadedCell { entity, levels: Vec::new() });
    entry.levels.push(LoadedLevel { level, sent: bytes, memory, wanted_at_s: now_s });
    note(world, Event::Arrived { what: What::Packet { cell, level }, bytes });
    let mut stats = world.resource_mut::<StreamingStats>();
    stats.bytes_received[level.index()] += bytes;
    stats.bytes_loaded += bytes;
    stats.bytes_in_memory += memory;
    world.write_message(CellReady { entity, cell, level });
}

/// Lets go of cells and finer levels that nobody has wanted for a while, and of the farthest ones where memory runs over.
pub(crate) fn release_cells(world: &mut World, eyes: &mut QueryState<&Eye, With<Viewer>>) {
    let Some(mut store) = world.remove_resource::<Store>() else { return };
    let Some(mut loaded) = world.remove_resource::<LoadedCells>() else {
        world.insert_resource(store);
        return;
    };
    let now_s = world.resource::<Time>().elapsed_secs_f64();
    let settings = *world.resource::<StreamingSettings>();
    let plan = world.resource::<Wanted>().generation;
    let cap = settings.cap_of_cells(*world.resource());
    let runs_over = world.resource::<StreamingStats>().bytes_in_memory > cap;
    let has_planned = core::mem::replace(&mut loaded.plan, plan) != plan;
    let due_s = loaded.sweep_s + if has_planned { SWEEP_WAITS_S } else { 0.0 };
    if !runs_over && now_s < due_s {
        world.insert_resource(loaded);
        world.insert_resource(store);
        return;
    }
    loaded.sweep_s = now_s + SWEEP_S;
    let eyes: Vec<DVec2> = eyes.iter(world).map(|eye| eye.plan_pos).collect();
    world.resource_scope(|world, wanted: Mut<'_, Wanted>| {
        for (&cell, entry) in &mut loaded.cells {
            let finest = wanted.finest(cell);
            let levels = entry.levels.iter_mut().take_while(|level| finest >= Some(level.level));
            levels.for_each(|level| level.wanted_at_s = now_s);
        }
        let mut idle: Vec<(u32, Level)> =
            loaded.cells.iter().filter_map(|(&cell, entry)| Some((cell, entry.idle_since(now_s - settings.keep_s)?))).collect();
        if idle.len() > RELEASED_A_FRAME {
            idle.truncate(RELEASED_A_FRAME);
            loaded.sweep_s = now_s;
        }
        for (cell, from) in idle {
            release(world, &mut store, &mut loaded, (cell, from), Reason::Idle);
        }
        let away_m = |cell: u32| {
            let entry = store.client.index().and_then(|index| index.cell(cell));
            entry.map_or(f64::INFINITY, |entry| {
                eyes.iter().map(|&eye| bounds::distance_m(entry.bounds, eye)).fold(f64::INFINITY, f64::min)
            })
        };
        let over = over_the_cap(&loaded, &wanted, cap, &away_m);
        for (cell, from) in over {
            release(world, &mut store, &mut loaded, (cell, from), Reason::OverTheCap);
        }
        let mut stats = world.resource_mut::<StreamingStats>();
        stats.bytes_loaded = loaded.cells.values().flat_map(|cell| &cell.levels).map(|level| level.sent).sum();
        stats.bytes_in_memory = loaded.memory();
        stats.cells = loaded.cells.len();
    });
    world.insert_resource(loaded);
    world.insert_resource(store);
}

/// Lets go of a level of a cell with all finer ones; with [`Level::One`] the cell goes.
fn release(world: &mut World, store: &mut Store, loaded: &mut LoadedCells, (cell, from): (u32, Level), why: Reason) {
    let Some(entry) = loaded.cells.get_mut(&cell) else { return };
    note(world, Event::Released { cell, from, why });
    while let Some(last) = entry.levels.pop_if(|last| last.level >= from) {
        store.client.forget(cell, last.level);
        if from > Level::One {
            forget_level(world, cell, entry.entity, last.level);
        }
    }
    if from == Level::One {
        world.despawn(entry.entity);
        loaded.cells.remove(&cell);
        world.resource_mut::<StandingCells>().remove(cell);
        world.write_message(CellReleased { cell });
    }
}

/// Which cells, and which levels of others, must go for the cap to hold: what is wanted keeps within it by itself, so what stays only for a
/// possible return, the farthest first: whole cells before finer levels of those that are in sight.
fn over_the_cap(loaded: &LoadedCells, wanted: &Wanted, cap: u64, away_m: &dyn Fn(u32) -> f64) -> Vec<(u32, Level)> {
    let mut memory = loaded.memory();
    if memory <= cap {
        return Vec::new();
    }
    let (staying, idle): (Vec<_>, Vec<_>) = loaded.cells.iter().partition(|(cell, _)| wanted.wants(**cell));
    let mut going = Vec::new();
    for (cell, entry) in farthest_first(idle, away_m) {
        if memory > cap {
            memory -= entry.memory();
            going.push((cell, Level::One));
        }
    }
    for (cell, entry) in farthest_first(staying, away_m) {
        for here in entry.levels.iter().rev() {
            if memory <= cap || here.level == Level::One || wanted.wants_level(cell, here.level) {
                break;
            }
            memory -= here.memory;
            going.push((cell, here.level));
        }
    }
    going
}

/// Cells in order of their distance from who is nearest; of those as far away, the first.
fn farthest_first<'a>(
    cells: Vec<(&'a u32, &'a LoadedCell)>,
    away_m: &dyn Fn(u32) -> f64,
) -> impl Iterator<Item = (u32, &'a LoadedCell)> {
    let mut cells: Vec<(f64, u32, &LoadedCell)> = cells.into_iter().map(|(&cell, of)| (away_m(cell), cell, of)).collect();
    cells.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    cells.into_iter().map(|(_, cell, of)| (cell, of))
}

/// Takes a level's meshes, content and fade from a cell that goes on standing.
fn forget_level(world: &mut World, cell: u32, entity: Entity, level: Level) {
    let mut meshes = world.query::<(Entity, &CellMesh)>();
    let gone: Vec<Entity> = meshes
        .iter(world)
        .filter(|(_, mesh)| mesh.cell == cell && mesh.kind.level() == Some(level))
        .map(|(entity, _)| entity)
        .collect();
    for mesh in gone {
        world.despawn(mesh);
    }
    if let Some(mut content) = world.get_mut::<CellContent>(entity) {
        match level {
            Level::Two => content.sheet = None,
            Level::Three => content.pictures = None,
            Level::One | Level::Four => {}
        }
    }
    if let Some(mut fade) = world.get_mut::<LevelFade>(entity) {
        fade.0[level.index()] = 0.0;
    }
    if let Some(mut memory) = world.get_mut::<CellMemory>(entity) {
        memory.0[level.index()] = 0;
    }
    world.resource_mut::<StandingCells>().remove_level(cell, level);
}

#[cfg(test)]
mod tests {
    use super::*;
    use veduta_ecs::CellMeshKind::{Base, Fittings, Trees, Walls};

    #[test]
    fn a_level_goes_with_its_walls_and_trees() {
        let mut world = World::new();
        world.init_resource::<StandingCells>();
        let cell = world.spawn(Cell(3)).id();
        let kinds = [Base, Fittings, Walls(Level::One), Trees(Level::One), Walls(Level::Two), Trees(Level::Two)];
        for kind in kinds {
            world.spawn((CellMesh { cell: 3, kind }, ChildOf(cell)));
        }
        let other = world.spawn(CellMesh { cell: 4, kind: Trees(Level::Two) }).id();
        forget_level(&mut world, 3, cell, Level::Two);
        let mut meshes = world.query::<(Entity, &CellMesh)>();
        let left: Vec<_> = meshes.iter(&world).filter(|(entity, _)| *entity != other).map(|(_, mesh)| mesh.kind).collect();
        assert_eq!((left, world.get_entity(other).is_ok()), (kinds[..4].to_vec(), true));
    }
}
