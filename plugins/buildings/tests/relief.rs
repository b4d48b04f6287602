//! Relief is made where a viewer is near, of what level 2 is made of, and goes with it.

use std::sync::Arc;

use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_buildings::{BuildSettings, Building, BuildingsPlugin};
use veduta_city::{
    CellShell, FacadeSheet, Gable, GridPolygon, GridPos, GroundFloor, HouseShell, Level, Opening, PlanRoof, Rgb, RoofShape, Storey,
    VolumeShell, Wall, WallKind,
};
use veduta_ecs::{
    ATTRIBUTE_RELIEF, Cell, CellContent, CellMesh, CellMeshKind, CellReady, Eye, LevelFade, MaterialsProvided, StandingCells,
    Viewer,
};

const M: i32 = 1024;

fn rectangle(low: (i32, i32), high: (i32, i32)) -> GridPolygon {
    let corners = [(low.0, low.1), (high.0, low.1), (high.0, high.1), (low.0, high.1)];
    GridPolygon::simple(corners.map(|(x, y)| GridPos(x * M, y * M)).to_vec())
}

/// A street with one house of one front.
fn street() -> (CellShell, FacadeSheet) {
    let volume = VolumeShell {
        footprint: rectangle((0, 0), (9, 12)),
        bottom: 0,
        eaves: 7 * M,
        colour: Rgb(0xD9, 0xB3, 0x6C),
        trim: Rgb(0xEF, 0xE3, 0xC8),
        roof: PlanRoof { shape: RoofShape::Gabled, height: 4 * M, direction: 90, colour: Rgb(0xA2, 0x4B, 0x33) },
        gable: Gable::Plain,
        has_roof: true,
        walls: vec![0],
        arcades: Vec::new(),
    };
    let house = HouseShell { style: 0, floor: 0, volumes: vec![volume], is_monument: false };
    let storey = Storey { height: 7 * M / 2, opening: Opening::FramedWindow };
    let front =
        Wall { kind: WallKind::Street, bays: 3, storeys: vec![storey; 2], ground_floor: GroundFloor::default(), ornament: None };
    let shell = CellShell { outline: rectangle((0, -10), (40, 0)), houses: vec![house], ..CellShell::default() };
    (shell, FacadeSheet::of(vec![front]))
}

fn app(building: Building, relief_m: f64) -> (App, Entity, Entity) {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), BuildingsPlugin { building })).init_asset::<Mesh>();
    app.insert_resource(MaterialsProvided { are_made: true, reads_blocks: false })
        .insert_resource(BuildSettings { relief_m, ..BuildSettings::default() });
    let (shell, sheet) = street();
    let content = CellContent { shell: Arc::new(shell), sheet: Some(Arc::new(sheet)), pictures: None };
    let entity = app.world_mut().spawn((Cell(0), content, LevelFade::default())).id();
    let viewer = app.world_mut().spawn((Viewer, Eye { plan_pos: DVec2::new(4.0, -5.0), ..Eye::default() })).id();
    for level in [Level::One, Level::Two] {
        app.world_mut().write_message(CellReady { entity, cell: 0, level });
    }
    (app, entity, viewer)
}

/// Meshes of walls in relief, and how far the vertices of the first reach behind and before the wall.
fn reliefs(app: &mut App) -> (usize, [f32; 2]) {
    let mut query = app.world_mut().query::<(&CellMesh, &Mesh3d)>();
    let meshes = app.world().resource::<Assets<Mesh>>();
    let found: Vec<_> = query.iter(app.world()).filter(|(mesh, _)| mesh.kind == CellMeshKind::Walls(Level::Four)).collect();
    let reach = found.first().map_or([0.0; 2], |(_, mesh)| {
        let mesh = meshes.get(&mesh.0).expect("a mesh");
        let values = mesh.attribute(ATTRIBUTE_RELIEF).and_then(|values| values.as_float3()).expect("it tells its relief");
        values.iter().fold([0.0, 0.0], |[low, high], r| [f32::min(low, r[2]), f32::max(high, r[2])])
    });
    (found.len(), reach)
}

fn has_relief(app: &App) -> bool {
    app.world().resource::<StandingCells>().levels(0).has(Level::Four)
}

#[test]
fn it_comes_with_a_viewer_and_goes_with_it() {
    let (mut app, entity, viewer) = app(Building::Inline, 24.0);
    (0..3).for_each(|_| app.update());
    let (count, [behind, before]) = reliefs(&mut app);
    assert!(count == 1 && behind < -0.15 && before > 0.05, "{count} {behind} {before}");
    assert!(has_relief(&app));

    app.world_mut().get_mut::<LevelFade>(entity).expect("spawned").0[3] = 1.0;
    let move_to = |app: &mut App, y: f64| app.world_mut().get_mut::<Eye>(viewer).expect("spawned").plan_pos.y = y;
    move_to(&mut app, -60.0);
    (0..3).for_each(|_| app.update());
    assert_eq!(reliefs(&mut app).0, 1, "a little farther off it is kept");
    move_to(&mut app, -90.0);
    (0..3).for_each(|_| app.update());
    assert_eq!((reliefs(&mut app).0, has_relief(&app)), (0, false));
    assert_eq!(app.world().get::<LevelFade>(entity).expect("spawned").0[3], 0.0);
    move_to(&mut app, -20.0);
    (0..3).for_each(|_| app.update());
    assert_eq!(reliefs(&mut app).0, 1, "it comes back");
}

#[test]
fn it_goes_with_level_2() {
    let (mut app, entity, _) = app(Building::Inline, 24.0);
    (0..3).for_each(|_| app.update());
    app.world_mut().get_mut::<CellContent>(entity).expect("spawned").sheet = None;
    app.world_mut().resource_mut::<StandingCells>().remove_level(0, Level::Two);
    (0..3).for_each(|_| app.update());
    assert_eq!((reliefs(&mut app).0, has_relief(&app)), (0, false));
}

#[test]
fn it_is_made_once_and_not_at_all_where_it_is_not_asked_for() {
    let (mut app, ..) = app(Building::Pool, 24.0);
    for _ in 0..2_000 {
        app.update();
        std::thread::sleep(core::time::Duration::from_millis(1));
        if has_relief(&app) {
            break;
        }
    }
    (0..20).for_each(|_| app.update());
    assert_eq!(reliefs(&mut app).0, 1);

    let (mut none, ..) = self::app(Building::Inline, 0.0);
    (0..5).for_each(|_| none.update());
    assert_eq!((reliefs(&mut none).0, none.world().resource::<StandingCells>().levels(0).has(Level::Two)), (0, true));
}
