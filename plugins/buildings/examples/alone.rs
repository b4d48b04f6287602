//! Buildings alone: one cell of one's own, with a house, a lamp and the ground, given as plain values.
//!
//! `cargo run -p veduta-buildings --example buildings_alone`

use std::sync::Arc;

use bevy::prelude::*;
use veduta_buildings::BuildingsPlugin;
use veduta_city::{
    CellShell, Gable, GridPolygon, GridPos, GroundPatch, HouseShell, Level, ObjectKind, ObjectShell, PlanRoof, Rgb, RoofShape,
    SurfaceKind, VolumeShell,
};
use veduta_ecs::{Cell, CellContent, CellReady, LevelFade};

fn main() -> AppExit {
    let mut app = App::new();
    app.add_plugins((DefaultPlugins, BuildingsPlugin::default()))
        .add_systems(Startup, (give_cell, light_and_camera))
        .add_systems(Update, circle);
    app.run()
}

/// Spawns a cell with its content and says that it is ready: the plugin makes and spawns its meshes.
fn give_cell(mut commands: Commands, mut ready: MessageWriter<CellReady>) {
    let content = CellContent { shell: Arc::new(yard()), sheet: None, pictures: None };
    let entity = commands.spawn((Cell(0), content, LevelFade::default())).id();
    ready.write(CellReady { entity, cell: 0, level: Level::One });
}

/// A rectangle by two corners in metres.
fn rectangle(low: [i32; 2], high: [i32; 2]) -> GridPolygon {
    let corner = |x: i32, y: i32| GridPos(x * 1024, y * 1024);
    GridPolygon::simple(vec![corner(low[0], low[1]), corner(high[0], low[1]), corner(high[0], high[1]), corner(low[0], high[1])])
}

/// A cobbled yard of 40 m with a house of 12 by 9 m and a lamp.
fn yard() -> CellShell {
    let outline = rectangle([-20, -20], [20, 20]);
    let roof = PlanRoof { shape: RoofShape::Hipped, height: 5 * 1024, direction: 90, colour: Rgb(0xA2, 0x4B, 0x33) };
    let volume = VolumeShell {
        footprint: rectangle([-6, 0], [6, 9]),
        bottom: 0,
        eaves: 9 * 1024,
        colour: Rgb(0xEA, 0xD7, 0xA0),
        trim: Rgb(0xF1, 0xED, 0xE2),
        roof,
        gable: Gable::Plain,
        has_roof: true,
        walls: vec![0, 1, 2, 3],
        arcades: Vec::new(),
    };
    let lamp = ObjectShell { kind: ObjectKind::Lamp, pos: GridPos(8192, -4096), z: 0, heading: 0, height: 4096, monument: None };
    CellShell {
        ground: vec![GroundPatch { surface: SurfaceKind::Cobbles, outline: outline.clone(), z: 0, course: None }],
        outline,
        houses: vec![HouseShell { style: 0, floor: 0, volumes: vec![volume], is_monument: false }],
        objects: vec![lamp],
        ..CellShell::default()
    }
}

fn light_and_camera(mut commands: Commands) {
    let sun = DirectionalLight { illuminance: 8_000.0, ..default() };
    commands.spawn((sun, Transform::from_xyz(8.0, 10.0, 5.0).looking_at(Vec3::ZERO, Vec3::Y)));
    commands.spawn((Camera3d::default(), Transform::default()));
}

fn circle(time: Res<Time>, mut cameras: Query<&mut Transform, With<Camera3d>>) {
    let (sin, cos) = (time.elapsed_secs() * 0.3).sin_cos();
    for mut camera in &mut cameras {
        *camera = Transform::from_xyz(28.0 * sin, 12.0, 28.0 * cos).looking_at(Vec3::new(0.0, 4.0, -4.0), Vec3::Y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use veduta_buildings::Building;
    use veduta_ecs::{CellMesh, StandingCells};

    #[test]
    fn the_cell_stands_with_walls_and_base() {
        let mut app = App::new();
        let buildings = BuildingsPlugin { building: Building::Inline };
        app.add_plugins((MinimalPlugins, AssetPlugin::default(), buildings)).init_asset::<Mesh>();
        app.add_systems(Startup, give_cell);
        for _ in 0..3 {
            app.update();
        }
        assert!(app.world().resource::<StandingCells>().levels(0).has(Level::One));
        assert_eq!(app.world_mut().query::<(&CellMesh, &Mesh3d)>().iter(app.world()).count(), 3, "walls; fittings; all else");
    }
}
