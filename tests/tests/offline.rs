//! A pause, a line that is down, and asking again at once when it is back.

use std::collections::BTreeMap;
use std::time::Duration;

use bevy::ecs::system::RunSystemOnce;
use bevy::math::DVec2;
use bevy::prelude::*;
use veduta::ecs::StandingCells;
use veduta::prelude::*;
use veduta::streaming::{Fetching, Link, Reconnect, Streamed, StreamingStats, Wanted, What};
use veduta_city::{Level, Levels};
use veduta_tests::{quiet_app, sample_city, update_until};

/// Updates in a second of the app's time.
const HZ: u32 = 10;
const DOWN: Link = Link { latency_s: 0.0, bytes_s: f64::INFINITY, loss: 0.0, is_down: true };
/// A place far from the start.
const ELSEWHERE: DVec2 = DVec2::new(300.0, -27.0);

fn app() -> App {
    quiet_app(&sample_city().display().to_string(), Fetching::Inline, Duration::from_secs(1) / HZ)
}

fn stats(app: &App) -> StreamingStats {
    *app.world().resource::<StreamingStats>()
}

fn standing(app: &App) -> BTreeMap<u32, Levels> {
    app.world().resource::<StandingCells>().iter().map(|(cell, levels, _)| (cell, levels)).collect()
}

fn all_stands(world: &World) -> bool {
    let (wanted, standing) = (world.resource::<Wanted>(), world.resource::<StandingCells>());
    !wanted.order.is_empty() && wanted.order.iter().all(|&(cell, level)| standing.levels(cell).has(level))
}

/// An app with a viewer at the start, and nothing more to come.
fn settled() -> (App, Entity) {
    let mut app = app();
    update_until(&mut app, 100, "the city is open", |world| world.contains_resource::<City>());
    let start = app.world().resource::<City>().start;
    let viewer = app.world_mut().spawn((Viewer, Eye::at(start), Transform::default())).id();
    let (mut quiet, mut before) = (0, 0);
    update_until(&mut app, 2_000, "all that is wanted is here", |world| {
        let requests = world.resource::<StreamingStats>().requests;
        quiet = if requests == before && all_stands(world) { quiet + 1 } else { 0 };
        before = requests;
        quiet > 2 * HZ
    });
    (app, viewer)
}

fn put(app: &mut App, viewer: Entity, plan_pos: DVec2) {
    app.world_mut().get_mut::<Eye>(viewer).expect("spawned").plan_pos = plan_pos;
}

fn pause(app: &mut App, paused: bool) {
    app.world_mut().resource_mut::<StreamingSettings>().paused = paused;
}

fn wait_s(app: &mut App, seconds: u32) {
    (0..seconds * HZ).for_each(|_| app.update());
}

/// That of what stood before, all that is still wanted stands.
fn stays(before: &BTreeMap<u32, Levels>, app: &App) {
    let (now, wanted) = (app.world().resource::<StandingCells>(), &app.world().resource::<Wanted>().order);
    let of_use = || wanted.iter().filter(|(cell, level)| before.get(cell).is_some_and(|levels| levels.has(*level)));
    assert!(of_use().count() > 0, "some of what stood is of use still");
    let gone: Vec<_> = of_use().filter(|(cell, level)| !now.levels(*cell).has(*level)).collect();
    assert!(gone.is_empty(), "{gone:?} are gone");
}

#[test]
fn while_paused_nothing_is_asked_for_and_what_stands_stays() {
    let (mut app, viewer) = settled();
    let (before, asked) = (standing(&app), stats(&app).requests);
    pause(&mut app, true);
    put(&mut app, viewer, ELSEWHERE);
    wait_s(&mut app, 5);
    assert!(!all_stands(app.world()), "more is wanted");
    assert_eq!((standing(&app), stats(&app).requests), (before, asked));
    // Back again: what is wanted here outlasts any pause.
    let start = app.world().resource::<City>().start.pos;
    put(&mut app, viewer, start);
    let before = standing(&app);
    wait_s(&mut app, 60);
    stays(&before, &app);
    put(&mut app, viewer, ELSEWHERE);
    wait_s(&mut app, 60);
    assert_eq!(stats(&app).requests, asked);
    pause(&mut app, false);
    update_until(&mut app, 500, "after the pause all of it comes", |world| all_stands(world));
    assert!(stats(&app).requests > asked);
}

#[test]
fn what_is_on_its_way_when_a_pause_begins_arrives() {
    let (mut app, viewer) = settled();
    app.insert_resource(Link { latency_s: 2.0, ..Link::default() });
    put(&mut app, viewer, ELSEWHERE);
    let pending = |app: &mut App| {
        let pending = app.world_mut().run_system_once(|streamed: Streamed<'_>| streamed.pending().collect::<Vec<What>>());
        pending.expect("it runs")
    };
    app.update();
    let (coming, asked) = (pending(&mut app), stats(&app).requests);
    assert!(!coming.is_empty());
    pause(&mut app, true);
    wait_s(&mut app, 4);
    assert_eq!((pending(&mut app), stats(&app).requests), (Vec::new(), asked));
    let now = app.world().resource::<StandingCells>();
    for what in coming {
        let What::Packet { cell, level } = what else { panic!("{what:?}: cells in sight come first") };
        assert!(now.levels(cell).has(level), "cell {cell}, {level}");
    }
}

#[test]
fn a_city_that_is_opened_in_a_pause_opens_after_it() {
    let mut app = app();
    pause(&mut app, true);
    wait_s(&mut app, 5);
    assert_eq!((stats(&app).requests, app.world().contains_resource::<City>()), (0, false));
    pause(&mut app, false);
    update_until(&mut app, 10, "the city is open", |world| world.contains_resource::<City>());
}

#[test]
fn with_the_line_down_what_stands_stays_and_all_comes_when_it_is_back() {
    let (mut app, viewer) = settled();
    let before = standing(&app);
    app.insert_resource(DOWN);
    // Whoever stays lacks nothing.
    wait_s(&mut app, 90);
    assert_eq!((standing(&app), stats(&app).failures), (before.clone(), 0));
    // Whoever goes on does: longer than is waited for anything.
    let start = app.world().resource::<City>().start.pos;
    put(&mut app, viewer, start + DVec2::new(-60.0, -30.0));
    let mut told = app.world().resource::<Messages<CityFailed>>().get_cursor();
    let mut tries = Vec::new();
    for _ in 0..90 * HZ {
        app.update();
        tries.extend(told.read(app.world().resource::<Messages<CityFailed>>()).cloned());
        stays(&before, &app);
    }
    assert!(!all_stands(app.world()), "more is wanted");
    assert_eq!(tries.len() as u64, stats(&app).failures, "each failure is told");
    assert!(!tries.is_empty() && tries.iter().all(|failed| failed.will_retry));
    assert!(tries.iter().all(|failed| failed.message == tries[0].message), "a visitor reads it once: {}", tries[0].message);
    app.insert_resource(Link::default());
    update_until(&mut app, 10 * HZ as usize, "all of it comes by itself", |world| all_stands(world));
}

/// Waits with the line down until nothing has been asked for in half a second.
fn fall_silent(app: &mut App) {
    let (mut quiet, mut before) = (0, 0);
    update_until(app, 1_000, "all that failed waits", |world| {
        let now = *world.resource::<StreamingStats>();
        quiet = if now.requests == before && now.failures > 0 { quiet + 1 } else { 0 };
        before = now.requests;
        quiet > HZ / 2
    });
}

/// Updates until something is asked for, when the line is back.
fn asks_after(app: &mut App, reconnects: bool) -> u32 {
    app.insert_resource(Link::default());
    if reconnects {
        app.world_mut().write_message(Reconnect);
    }
    let before = stats(app).requests;
    let mut updates = 0;
    while stats(app).requests == before {
        assert!(updates < 100, "nothing is asked for any more");
        app.update();
        updates += 1;
    }
    updates
}

#[test]
fn whoever_reconnects_does_not_wait() {
    let without_a_line = || {
        let (mut app, viewer) = settled();
        app.insert_resource(DOWN);
        put(&mut app, viewer, ELSEWHERE);
        // Until each wait is as long as waits become.
        wait_s(&mut app, 20);
        fall_silent(&mut app);
        app
    };
    let mut app = without_a_line();
    let by_itself = asks_after(&mut app, false);
    assert!(by_itself > HZ / 2, "{by_itself} updates");
    let mut app = without_a_line();
    // In vain as long as the line is down, and no harm.
    let failures = stats(&app).failures;
    app.world_mut().write_message(Reconnect);
    app.update();
    assert!(stats(&app).failures > failures);
    fall_silent(&mut app);
    assert_eq!(asks_after(&mut app, true), 1);
    update_until(&mut app, 2 * HZ as usize, "all in sight stands at once", |world| {
        let (wanted, standing) = (world.resource::<Wanted>(), world.resource::<StandingCells>());
        wanted.in_sight.iter().all(|&cell| standing.levels(cell).has(Level::One))
    });
}

#[test]
fn a_city_without_a_line_opens_when_one_reconnects() {
    let without_a_line = || {
        let mut app = app();
        app.insert_resource(DOWN);
        wait_s(&mut app, 20);
        fall_silent(&mut app);
        app
    };
    assert!(asks_after(&mut without_a_line(), false) > 1);
    let mut app = without_a_line();
    assert_eq!(asks_after(&mut app, true), 1);
    assert!(app.world().contains_resource::<City>(), "it opens at once");
}
