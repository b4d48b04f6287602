//! What stands in a cell from the first, and when.

use std::sync::Arc;

use bevy::prelude::*;
use veduta_buildings::{Building, BuildingsPlugin};
use veduta_city::{CellShell, GridPos, Level, ObjectKind, ObjectShell};
use veduta_ecs::{Cell, CellContent, CellMesh, CellMeshKind, CellReady, MaterialsProvided, StandingCells};

/// A cell with a lamp and no façade, ordered but not made.
fn ordered() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), BuildingsPlugin { building: Building::Inline })).init_asset::<Mesh>();
    let lamp = ObjectShell { kind: ObjectKind::Lamp, pos: GridPos(0, 0), z: 0, heading: 0, height: 4 * 1024, monument: None };
    let shell = CellShell { objects: vec![lamp], ..CellShell::default() };
    let entity = app.world_mut().spawn((Cell(0), CellContent { shell: Arc::new(shell), sheet: None, pictures: None })).id();
    app.world_mut().write_message(CellReady { entity, cell: 0, level: Level::One });
    app
}

fn kinds(app: &mut App) -> Vec<CellMeshKind> {
    app.world_mut().query::<&CellMesh>().iter(app.world()).map(|mesh| mesh.kind).collect()
}

#[test]
fn a_cell_without_a_facade_has_its_lamps() {
    let mut app = ordered();
    app.update();
    assert_eq!(kinds(&mut app), [CellMeshKind::Fittings]);
}

#[test]
fn nothing_stands_before_its_materials_are_made() {
    let mut app = ordered();
    app.insert_resource(MaterialsProvided { are_made: false, reads_blocks: false });
    for _ in 0..3 {
        app.update();
    }
    assert_eq!((kinds(&mut app), app.world().resource::<StandingCells>().len()), (vec![], 0));
    app.insert_resource(MaterialsProvided { are_made: true, reads_blocks: false });
    app.update();
    assert_eq!((kinds(&mut app), app.world().resource::<StandingCells>().len()), (vec![CellMeshKind::Fittings], 1));
}
