//! Very long walks: what comes goes again, and nothing is left behind.

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use bevy::math::DVec2;
use bevy::prelude::*;
use veduta::buildings::{BuildStats, Building};
use veduta::ecs::{Cell, CellMesh, OpenCells, StandingCells};
use veduta::prelude::*;
use veduta::streaming::{CurrentCell, Fetching, Journal, StreamingStats, Wanted};
use veduta_city::{GridPos, Id, Level, draw::Draw};
use veduta_store::{CityIndex, DirReader, read_index};
use veduta_tests::{in_memory, inner_point, quiet_app_building, sample_city, update_until};

/// Seconds of walking from portal to portal: 45 m at an easy pace.
const WALK_S: f64 = 32.0;
/// Small enough to be met on the way.
const CAP: u64 = 120 << 20;
/// Whoever has seen nothing come or go in so many updates is at rest.
const REST: usize = 60;

/// One walk after the other: the memory of the process is to be that of one.
static ALONE: Mutex<()> = Mutex::new(());

/// What an app holds.
#[derive(Debug, PartialEq, Eq)]
struct Held {
    entities: u32,
    cells: usize,
    meshes: usize,
    mesh_assets: usize,
    in_flight: usize,
    in_the_making: usize,
}

/// Bytes of memory that the process holds; `None` where nobody tells.
fn resident() -> Option<u64> {
    let told = std::fs::read_to_string("/proc/self/statm").ok()?;
    Some(told.split(' ').nth(1)?.parse::<u64>().ok()? * 4096)
}

/// A walk from cell to cell, and what was seen on it.
struct Walk {
    app: App,
    viewer: Entity,
    index: CityIndex,
    cell: u32,
    /// Most bytes of memory that the city took.
    most: u64,
    /// Cells in sight that did not stand.
    holes: usize,
}

impl Walk {
    fn begin(fetching: Fetching, building: Building, step: Duration) -> Self {
        let index = read_index(&DirReader::new(sample_city()).expect("a city")).expect("whole");
        let mut app = quiet_app_building(&sample_city().display().to_string(), fetching, building, step);
        app.world_mut().resource_mut::<StreamingSettings>().memory_cap_bytes = CAP;
        app.world_mut().resource_mut::<Journal>().keep = 1_000;
        update_until(&mut app, 500, "the city is open", |world| world.contains_resource::<City>());
        let start = app.world().resource::<City>().start;
        let viewer = app.world_mut().spawn((Viewer, Eye::at(start), Transform::default())).id();
        let cell = index.locate(GridPos::from_metres(start.pos)).expect("a cell");
        let mut walk = Self { app, viewer, index, cell, most: 0, holes: 0 };
        walk.rest();
        walk
    }

    fn held(&mut self) -> Held {
        let mut cells = self.app.world_mut().query::<&Cell>();
        let mut meshes = self.app.world_mut().query::<&CellMesh>();
        let world = self.app.world();
        Held {
            entities: world.entities().count_spawned(),
            cells: cells.iter(world).count(),
            meshes: meshes.iter(world).count(),
            mesh_assets: world.resource::<Assets<Mesh>>().len(),
            in_flight: world.resource::<StreamingStats>().in_flight,
            in_the_making: world.resource::<BuildStats>().in_the_making,
        }
    }

    fn all_stands(&self) -> bool {
        let (wanted, standing) = (self.app.world().resource::<Wanted>(), self.app.world().resource::<StandingCells>());
        !wanted.order.is_empty() && wanted.order.iter().all(|&(cell, level)| standing.levels(cell).has(level))
    }

    fn update(&mut self) {
        self.app.update();
        self.most = self.most.max(in_memory(&self.app));
    }

    fn put(&mut self, plan_pos: DVec2) {
        self.app.world_mut().get_mut::<Eye>(self.viewer).expect("spawned").plan_pos = plan_pos;
    }

    /// A cell beyond one of the portals.
    fn next(&self, crossing: u64) -> u32 {
        let beyond: Vec<u32> = self.index.portals(self.cell).filter_map(|portal| portal.other(self.cell)).collect();
        *Draw::new(5, Id(crossing), "way").pick("portal", &beyond).expect("no cell is alone")
    }

    fn enter(&mut self, cell: u32) {
        self.cell = cell;
        self.put(inner_point(&self.index.cell(cell).expect("told").outline));
    }

    /// Waits until one may walk into a cell.
    fn wait_for_door(&mut self, next: u32) {
        for _ in 0..5_000 {
            if self.app.world().resource::<OpenCells>().lead(self.cell, next) {
                return;
            }
            std::thread::sleep(Duration::from_millis(1));
            self.update();
        }
        panic!("from cell {} nobody is let into cell {next}", self.cell);
    }

    fn count_holes(&mut self) {
        let (wanted, standing) = (self.app.world().resource::<Wanted>(), self.app.world().resource::<StandingCells>());
        // What the cap leaves out is not wanted.
        let is_hole = |cell: &&u32| wanted.wants_level(**cell, Level::One) && !standing.levels(**cell).has(Level::One);
        self.holes += wanted.in_sight.iter().filter(is_hole).count();
    }

    fn is_there(&self) -> bool {
        self.app.world().get::<CurrentCell>(self.viewer).is_some_and(|current| current.0 == Some(self.cell))
    }

    /// Stays at the start until nothing comes or goes any more, and returns to where the walk was.
    fn rest(&mut self) -> Held {
        let (was, start) = (self.cell, self.app.world().resource::<City>().start);
        *self.app.world_mut().get_mut::<Eye>(self.viewer).expect("spawned") = Eye::at(start);
        let (mut held, mut quiet) = (self.held(), 0);
        for _ in 0..10_000 {
            std::thread::sleep(Duration::from_millis(1));
            self.update();
            let now = self.held();
            let is_quiet = now == held && now.in_flight == 0 && now.in_the_making == 0 && self.all_stands();
            quiet = if is_quiet { quiet + 1 } else { 0 };
            held = now;
            if quiet == REST {
                self.enter(was);
                return held;
            }
        }
        panic!("it does not come to rest: {held:?}");
    }

    /// What must hold after every walk.
    fn left_nothing_behind(&self, last: &Held, baseline: Option<&Held>) {
        assert_eq!(self.holes, 0, "cells in sight that did not stand after a crossing");
        assert!(self.most <= CAP + CAP / 20, "{} bytes were loaded of {CAP} allowed", self.most);
        assert!(self.most > CAP / 2, "the cap was not met: {} bytes of {CAP}", self.most);
        assert_eq!(Some(last), baseline);
    }
}

#[test]
fn ten_thousand_crossings_leave_nothing_behind() {
    /// All of them, and how many until everything has been seen that caches keep.
    const CROSSINGS: u64 = 10_000;
    const WARM_UP: u64 = 2_000;
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut walk = Walk::begin(Fetching::Inline, Building::Inline, Duration::from_secs_f64(WALK_S / 3.0));
    let (mut warm, mut baseline) = (None, None);
    for crossing in 0..CROSSINGS {
        let next = walk.next(crossing);
        walk.enter(next);
        (0..3).for_each(|_| walk.update());
        assert!(walk.is_there(), "crossing {crossing}");
        walk.count_holes();
        if crossing == WARM_UP {
            baseline = Some(walk.rest());
            warm = resident();
        }
    }
    let last = walk.rest();
    let hours = (CROSSINGS - WARM_UP) as f64 * WALK_S / 3600.0;
    if let (Some(warm), Some(now)) = (warm, resident()) {
        let slope = (now as f64 - warm as f64) / 1e6 / hours;
        println!("{slope:.3} MB an hour over {hours:.0} hours of walking");
        // What the allocator keeps for itself must not hide a leak of a cell a crossing: that would be 30 MB an hour.
        assert!(slope <= 1.0, "memory grows by {slope} MB an hour");
        assert!(now.saturating_sub(warm) < 16 << 20, "{} bytes more than at first", now - warm);
    }
    walk.left_nothing_behind(&last, baseline.as_ref());
}

#[test]
fn nor_do_crossings_with_threads() {
    const CROSSINGS: u64 = 800;
    const WARM_UP: u64 = 200;
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut walk = Walk::begin(Fetching::Threads(4), Building::Pool, Duration::from_secs(1));
    let mut baseline = None;
    for crossing in 0..CROSSINGS {
        let next = walk.next(crossing);
        walk.wait_for_door(next);
        walk.enter(next);
        // Whoever waited sees no hole, from the first frame on.
        for _ in 0..3 {
            walk.update();
            walk.count_holes();
        }
        assert!(walk.is_there(), "crossing {crossing}");
        if crossing == WARM_UP {
            baseline = Some(walk.rest());
        }
    }
    let last = walk.rest();
    walk.left_nothing_behind(&last, baseline.as_ref());
}
