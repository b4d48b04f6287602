//! Cells from afar: there as long as they do not stand themselves.

use std::sync::Arc;
use std::time::{Duration, Instant};

use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_buildings::{Building, BuildingsPlugin};
use veduta_city::{CellShell, District, GridPolygon, GridPos, GroundPatch, Level, Massing, Overview, SurfaceKind};
use veduta_ecs::{CellMesh, CellMeshKind, City, DistrictMemory, Eye, Overviews, StandingCells, Viewer, WorldOrigin};

const M: i32 = 1024;

fn square(x: i32) -> GridPolygon {
    GridPolygon::simple([(x, 0), (x + 20, 0), (x + 20, 20), (x, 20)].map(|(x, y)| GridPos(x * M, y * M)).to_vec())
}

/// Ground and a house each of two cells.
fn part(cells: [u32; 2], x: i32) -> Overview {
    let patch = |x| GroundPatch { surface: SurfaceKind::Cobbles, outline: square(x), z: 0, course: None };
    Overview {
        ground: vec![patch(x), patch(x + 20)],
        houses: vec![Massing::block(square(x), 9 * M), Massing::block(square(x + 20), 9 * M)],
        districts: cells.map(|cell| District { cell, ground: 1, houses: 1, spans: 0 }).to_vec(),
        ..Overview::default()
    }
}

/// A city of two parts, 5 km apart, of which the near one has come.
fn app(building: Building) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), BuildingsPlugin { building })).init_asset::<Mesh>();
    let bounds = |x: i32| (GridPos(x * M, 0), GridPos((x + 40) * M, 20 * M));
    let mut overviews = Overviews::awaited([bounds(0), bounds(5_000)]);
    overviews.put(0, Some(Arc::new(part([3, 4], 0))));
    app.insert_resource(City { overviews, ..City::default() });
    app.world_mut().spawn((Viewer, Eye::default()));
    app
}

/// Cells whose districts are shown, and those whose are hidden.
fn districts(app: &mut App) -> [Vec<u32>; 2] {
    let mut query = app.world_mut().query::<(&CellMesh, &Visibility)>();
    let all = query.iter(app.world()).filter(|(mesh, _)| mesh.kind == CellMeshKind::District);
    let (mut shown, mut hidden) = (Vec::new(), Vec::new());
    all.for_each(
        |(mesh, visibility)| if *visibility == Visibility::Hidden { hidden.push(mesh.cell) } else { shown.push(mesh.cell) },
    );
    shown.sort_unstable();
    [shown, hidden]
}

#[test]
fn a_district_is_shown_as_long_as_its_cell_does_not_stand() {
    let mut app = app(Building::Inline);
    app.update();
    assert_eq!(districts(&mut app), [vec![3, 4], vec![]]);
    let shell = Arc::new(CellShell::default());
    app.world_mut().resource_mut::<StandingCells>().add(4, Level::One, &shell);
    app.update();
    assert_eq!(districts(&mut app), [vec![3], vec![4]], "at once, so that neither both nor none is seen");
    app.world_mut().resource_mut::<StandingCells>().remove(4);
    app.update();
    assert_eq!(districts(&mut app), [vec![3, 4], vec![]]);
    // One that stands before its district comes.
    app.world_mut().resource_mut::<StandingCells>().add(7, Level::One, &shell);
    app.world_mut().resource_mut::<City>().overviews.put(1, Some(Arc::new(part([7, 8], 5_000))));
    app.world_mut().query::<&mut Eye>().single_mut(app.world_mut()).expect("a viewer").plan_pos = DVec2::new(2_500.0, 0.0);
    app.update();
    assert_eq!(districts(&mut app), [vec![], vec![]], "both are far away");
    app.world_mut().query::<&mut Eye>().single_mut(app.world_mut()).expect("a viewer").plan_pos = DVec2::new(4_900.0, 0.0);
    app.update();
    assert_eq!(districts(&mut app), [vec![8], vec![7]]);
}

#[test]
fn districts_go_with_their_part_and_with_the_city() {
    let mut app = app(Building::Inline);
    app.update();
    app.world_mut().resource_mut::<City>().overviews.put(0, None);
    app.update();
    assert_eq!(districts(&mut app), [vec![], vec![]]);
    app.world_mut().resource_mut::<City>().overviews.put(0, Some(Arc::new(part([5, 6], 0))));
    app.update();
    assert_eq!(districts(&mut app), [vec![5, 6], vec![]]);
    app.world_mut().remove_resource::<City>();
    app.update();
    assert_eq!(districts(&mut app), [vec![], vec![]]);
}

#[test]
fn many_districts_go_a_slice_a_frame_and_count_until_they_are_gone() {
    const MANY: u32 = 600;
    let ground =
        (0..MANY as i32).map(|x| GroundPatch { surface: SurfaceKind::Cobbles, outline: square(20 * x), z: 0, course: None });
    let districts_of = (0..MANY).map(|cell| District { cell, ground: 1, houses: 0, spans: 0 });
    let whole = Overview { ground: ground.collect(), districts: districts_of.collect(), ..Overview::default() };
    let mut app = app(Building::Inline);
    app.world_mut().resource_mut::<City>().overviews.put(0, Some(Arc::new(whole)));
    (0..5).for_each(|_| app.update());
    let bytes = |app: &App| app.world().resource::<DistrictMemory>().bytes;
    assert_eq!(districts(&mut app)[0].len(), MANY as usize);
    let all = bytes(&app);
    app.world_mut().resource_mut::<City>().overviews.put(0, None);
    let (mut left, mut frames) = (MANY as usize, 0);
    while left > 0 {
        assert_eq!(bytes(&app), all, "{left} are left");
        app.update();
        let now = districts(&mut app)[0].len();
        assert!(now < left && left - now <= 128, "{left} to {now} in a frame");
        (left, frames) = (now, frames + 1);
    }
    assert!(frames > 4 && all > 0, "{frames} frames, {all} bytes");
    assert_eq!(bytes(&app), 0);
}

#[test]
fn districts_are_made_on_the_pool_and_lie_where_the_plan_says() {
    let mut app = app(Building::Pool);
    app.insert_resource(WorldOrigin { plan: GridPos(10 * M, 0) });
    let began = Instant::now();
    while districts(&mut app)[0].is_empty() && began.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(1));
        app.update();
    }
    assert_eq!(districts(&mut app)[0], [3, 4]);
    let mut query = app.world_mut().query::<(&CellMesh, &Transform)>();
    let mut places: Vec<(u32, Vec3)> = query.iter(app.world()).map(|(mesh, at)| (mesh.cell, at.translation)).collect();
    places.sort_by_key(|place| place.0);
    // The middles of their squares, (10, 10) and (30, 10), from the world's origin.
    assert_eq!(places, [(3, Vec3::new(0.0, 0.0, -10.0)), (4, Vec3::new(20.0, 0.0, -10.0))]);
}
