//! Tests that cross crates: what they share.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Duration;

use bevy::asset::AssetPlugin;
use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use veduta::buildings::{Building, BuildingsPlugin};
use veduta::ecs::{CellMemory, DistrictMemory};
use veduta::prelude::*;
use veduta::streaming::{Fetching, StreamingStats};
use veduta::walker::{Jump, SolidCells};
use veduta_bake::{BakeSettings, Input, bake, plan};
use veduta_city::{CityPlan, GridPolygon, GridPos};

/// The project's folder. Tests run in their package's; a path from build time may be that of another clone that was built in the
/// same target directory.
#[must_use]
pub fn root() -> PathBuf {
    std::path::absolute("..").unwrap_or_else(|_| PathBuf::from(".."))
}

/// The sample city's scene folder.
#[must_use]
pub fn scene() -> PathBuf {
    root().join("scenes/old_prague")
}

/// A folder of this test run's own, removed and made anew.
///
/// # Panics
/// If the folder cannot be made.
#[must_use]
pub fn workplace(name: &str) -> PathBuf {
    let dir = std::env::temp_dir().join(format!("veduta-tests-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&dir);
    std::fs::create_dir_all(&dir).unwrap_or_else(|e| panic!("{}: {e}", dir.display()));
    dir
}

/// The sample city, baked once a run.
///
/// # Panics
/// If it cannot be baked.
#[must_use]
pub fn sample_city() -> &'static Path {
    static CITY: OnceLock<PathBuf> = OnceLock::new();
    CITY.get_or_init(|| {
        let city = workplace("sample").join("old_prague.city");
        bake(&scene(), &city, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
        city
    })
}

/// A hillside with three streets, baked once a run.
///
/// # Panics
/// If it cannot be baked.
#[must_use]
pub fn hillside_city() -> &'static Path {
    static CITY: OnceLock<PathBuf> = OnceLock::new();
    CITY.get_or_init(|| {
        let (graph, city) = (hillside_graph(), workplace("hillside").join("hillside.city"));
        bake(&graph, &city, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
        city
    })
}

/// A riverside with four bridges, baked once a run.
///
/// # Panics
/// If it cannot be baked.
#[must_use]
pub fn riverside_city() -> &'static Path {
    static CITY: OnceLock<PathBuf> = OnceLock::new();
    CITY.get_or_init(|| {
        let city = workplace("riverside").join("riverside.city");
        bake(&riverside_graph(), &city, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
        city
    })
}

/// The riverside's graph.
#[must_use]
pub fn riverside_graph() -> PathBuf {
    root().join("plugins/bake/tests/places/riverside/riverside.graph.ron")
}

/// The hillside's graph.
#[must_use]
pub fn hillside_graph() -> PathBuf {
    root().join("plugins/bake/tests/places/hillside/hillside.graph.ron")
}

/// The sample city's plan, grown once a run.
///
/// # Panics
/// If it cannot be grown.
#[must_use]
pub fn sample_plan() -> &'static CityPlan {
    static PLAN: OnceLock<CityPlan> = OnceLock::new();
    PLAN.get_or_init(|| {
        let input = Input::of(&scene()).unwrap_or_else(|e| panic!("{e}"));
        plan(&input, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}")).plan
    })
}

/// An app with all of streaming and building, nothing drawn, time by hand: `step` a frame. Meshes are made at once.
pub fn quiet_app(city: &str, fetching: Fetching, step: Duration) -> App {
    quiet_app_building(city, fetching, Building::Inline, step)
}

/// The same; meshes are made where one says.
pub fn quiet_app_building(city: &str, fetching: Fetching, building: Building, step: Duration) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), TransformPlugin))
        .init_asset::<Mesh>()
        .add_plugins((veduta::ecs::EcsPlugin, StreamingPlugin { fetching }, BuildingsPlugin { building }))
        .insert_resource(TimeUpdateStrategy::ManualDuration(step))
        .insert_resource(OpenCity(city.to_owned()));
    app
}

/// A walker that has arrived at the start of a city, time by hand: 33 ms a frame.
///
/// # Panics
/// If it does not arrive.
pub fn walker_in(city: &Path) -> (App, Entity) {
    let mut app = quiet_app(&city.display().to_string(), Fetching::Inline, Duration::from_millis(33));
    app.add_plugins(WalkerPlugin { input: false });
    let walker = app.world_mut().spawn((Walker, Transform::default())).id();
    app.finish();
    app.cleanup();
    update_until(&mut app, 3_000, "the walker has arrived", |world| {
        !world.resource::<SolidCells>().is_empty() && *world.resource::<Jump>() == Jump::None
    });
    (app, walker)
}

/// Bytes of memory of the city, by what was made of it: not as streaming counts them.
///
/// # Panics
/// If the app has no streaming.
#[must_use]
pub fn in_memory(app: &App) -> u64 {
    let mut memory = app.world().try_query::<&CellMemory>().expect("cells are known");
    let made: u64 = memory.iter(app.world()).flat_map(|memory| memory.0).sum();
    made + app.world().resource::<StreamingStats>().bytes_loaded + app.world().resource::<DistrictMemory>().bytes
}

/// A place well within a cell's outline, plan metres.
#[must_use]
pub fn inner_point(outline: &GridPolygon) -> DVec2 {
    let is_inside = |p: &DVec2| outline.contains(GridPos::from_metres(*p));
    let ring: Vec<DVec2> = outline.outer.iter().map(|p| p.to_metres()).collect();
    let corner = |n: usize| (ring[n] + ring[(n + 1) % ring.len()] * 2.0 + ring[(n + 2) % ring.len()]) / 4.0;
    let middle = outline.centroid();
    core::iter::once(middle).chain((0..ring.len()).map(corner)).find(is_inside).unwrap_or(middle)
}

/// Updates until a condition holds.
///
/// # Panics
/// If it does not hold after `updates`.
pub fn update_until(app: &mut App, updates: usize, what: &str, mut holds: impl FnMut(&mut World) -> bool) {
    for _ in 0..updates {
        app.update();
        if holds(app.world_mut()) {
            return;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    panic!("after {updates} updates still not: {what}");
}
