//! A very long walk: what comes goes again, and nothing is left behind.

use std::time::Duration;

use bevy::prelude::*;
use veduta::ecs::{Cell, CellMesh, StandingCells};
use veduta::prelude::*;
use veduta::streaming::{CurrentCell, Fetching, Journal, StreamingStats, Wanted};
use veduta_city::{GridPos, Level, draw::Draw};
use veduta_store::{DirReader, read_index};
use veduta_tests::{in_memory, inner_point, quiet_app, sample_city, update_until};

/// Crossings of the whole walk, and how many of them until everything has been seen that caches keep.
const CROSSINGS: u64 = 10_000;
const WARM_UP: u64 = 2_000;
/// Seconds of walking from portal to portal: 45 m at an easy pace.
const WALK_S: f64 = 32.0;

/// What an app holds.
#[derive(Debug, PartialEq, Eq)]
struct Held {
    entities: u32,
    cells: usize,
    meshes: usize,
    mesh_assets: usize,
    in_flight: usize,
}

fn held(app: &mut App) -> Held {
    Held {
        entities: app.world().entities().count_spawned(),
        cells: app.world_mut().query::<&Cell>().iter(app.world()).count(),
        meshes: app.world_mut().query::<&CellMesh>().iter(app.world()).count(),
        mesh_assets: app.world().resource::<Assets<Mesh>>().len(),
        in_flight: app.world().resource::<StreamingStats>().in_flight,
    }
}

/// Bytes of memory that the process holds; `None` where nobody tells.
fn resident() -> Option<u64> {
    let told = std::fs::read_to_string("/proc/self/statm").ok()?;
    Some(told.split(' ').nth(1)?.parse::<u64>().ok()? * 4096)
}

/// Stays at the start until nothing comes or goes any more.
fn rest(app: &mut App, viewer: Entity) -> Held {
    let start = app.world().resource::<City>().start;
    *app.world_mut().get_mut::<Eye>(viewer).expect("spawned") = Eye::at(start);
    update_until(app, 500, "all stands", |world| {
        let (wanted, standing) = (world.resource::<Wanted>(), world.resource::<StandingCells>());
        !wanted.order.is_empty() && wanted.order.iter().all(|&(cell, level)| standing.levels(cell).has(level))
    });
    for _ in 0..60 {
        app.update();
    }
    held(app)
}

#[test]
fn ten_thousand_crossings_leave_nothing_behind() {
    let index = read_index(&DirReader::new(sample_city()).expect("a city")).expect("whole");
    let step = Duration::from_secs_f64(WALK_S / 3.0);
    let mut app = quiet_app(&sample_city().display().to_string(), Fetching::Inline, step);
    // Small enough to be met on the way.
    let cap = 120 << 20;
    app.world_mut().resource_mut::<StreamingSettings>().memory_cap_bytes = cap;
    app.world_mut().resource_mut::<Journal>().keep = 1_000;
    update_until(&mut app, 500, "the city is open", |world| world.contains_resource::<City>());
    let start = app.world().resource::<City>().start;
    let viewer = app.world_mut().spawn((Viewer, Eye::at(start), Transform::default())).id();
    rest(&mut app, viewer);

    let (mut warm, mut cell, mut most, mut holes) = (None, index.locate(GridPos::from_metres(start.pos)).expect("a cell"), 0, 0);
    let mut baseline = None;
    for crossing in 0..CROSSINGS {
        let beyond: Vec<u32> = index.portals(cell).filter_map(|portal| portal.other(cell)).collect();
        cell = *Draw::new(5, veduta_city::Id(crossing), "way").pick("portal", &beyond).expect("no cell is alone");
        app.world_mut().get_mut::<Eye>(viewer).expect("spawned").plan_pos = inner_point(&index.cell(cell).expect("told").outline);
        for _ in 0..3 {
            app.update();
            most = most.max(in_memory(&app));
        }
        assert_eq!(app.world().get::<CurrentCell>(viewer).and_then(|current| current.0), Some(cell), "crossing {crossing}");
        let (wanted, standing) = (app.world().resource::<Wanted>(), app.world().resource::<StandingCells>());
        let left_out = |cell: &u32| !wanted.wants_level(*cell, Level::One);
        holes += wanted.in_sight.iter().filter(|cell| !left_out(cell) && !standing.levels(**cell).has(Level::One)).count();
        if crossing == WARM_UP {
            baseline = Some(rest(&mut app, viewer));
            app.world_mut().get_mut::<Eye>(viewer).expect("spawned").plan_pos =
                inner_point(&index.cell(cell).expect("told").outline);
            warm = resident();
        }
    }
    assert_eq!(holes, 0, "cells in sight that did not stand three frames after a crossing");
    assert!(most <= cap + cap / 20, "{most} bytes were loaded of {cap} allowed");
    assert!(most > cap / 2, "the cap was not met: {most} bytes of {cap}");
    let hours = (CROSSINGS - WARM_UP) as f64 * WALK_S / 3600.0;
    if let (Some(warm), Some(now)) = (warm, resident()) {
        let slope = (now as f64 - warm as f64) / 1e6 / hours;
        println!("{slope:.3} MB an hour over {hours:.0} hours of walking");
        // What the allocator keeps for itself must not hide a leak of a cell a crossing: that would be 30 MB an hour.
        assert!(slope <= 1.0, "memory grows by {slope} MB an hour");
        assert!(now.saturating_sub(warm) < 16 << 20, "{} bytes more than at first", now - warm);
    }
    assert_eq!(Some(rest(&mut app, viewer)), baseline);
}
