//! What stands is made anew when the season turns.

use std::sync::Arc;

use bevy::prelude::*;
use veduta_buildings::{Building, BuildingsPlugin, CitySeason};
use veduta_city::{CellShell, GridPos, Id, Level, ObjectKind, PlanObject, Season};
use veduta_ecs::{Cell, CellContent, CellMesh, CellMeshKind, CellReady, CellStands, CityClock};

fn tree() -> CellShell {
    let tree =
        PlanObject { id: Id(2), kind: ObjectKind::Tree, pos: GridPos(0, 0), z: 0, heading: 0, height: 9 * 1024, monument: None };
    CellShell { objects: vec![tree], ..CellShell::default() }
}

/// Vertices of each base that stands.
fn bases(app: &mut App) -> Vec<usize> {
    let mut query = app.world_mut().query::<(&CellMesh, &Mesh3d)>();
    let meshes = app.world().resource::<Assets<Mesh>>();
    let bases = query.iter(app.world()).filter(|(mesh, _)| mesh.kind == CellMeshKind::Base);
    bases.map(|(_, mesh)| meshes.get(&mesh.0).expect("a mesh").count_vertices()).collect()
}

/// A cell with a tree, ordered but not made.
fn ordered(building: Building) -> (App, Entity) {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), BuildingsPlugin { building })).init_asset::<Mesh>();
    let content = CellContent { shell: Arc::new(tree()), sheet: None };
    let entity = app.world_mut().spawn((Cell(0), content)).id();
    app.world_mut().write_message(CellReady { entity, cell: 0, level: Level::One });
    (app, entity)
}

#[test]
fn trees_turn_with_the_clock() {
    let (mut app, _) = ordered(Building::Inline);
    app.update();
    let summer = bases(&mut app);
    assert_eq!((summer.len(), app.world().resource::<CitySeason>().0), (1, Season::Summer));

    app.world_mut().resource_mut::<CityClock>().day = 20;
    app.update();
    let winter = bases(&mut app);
    assert_eq!((winter.len(), app.world().resource::<CitySeason>().0), (1, Season::Winter), "one base takes the other's place");
    assert_ne!(summer, winter, "a bare tree is not one in leaf");
    let told = app.world().resource::<Messages<CellStands>>().len();
    assert_eq!(told, 1, "it came to stand a frame ago, and not again in this one");

    app.world_mut().resource_mut::<CityClock>().day = 160;
    app.update();
    assert_eq!(bases(&mut app), summer);
}

#[test]
fn a_cell_that_goes_while_it_turns_leaves_nothing() {
    let (mut app, entity) = ordered(Building::Pool);
    for _ in 0..2000 {
        app.update();
        std::thread::sleep(core::time::Duration::from_millis(1));
        if !bases(&mut app).is_empty() {
            break;
        }
    }
    assert_eq!(bases(&mut app).len(), 1);
    app.world_mut().resource_mut::<CityClock>().day = 20;
    app.update();
    app.world_mut().entity_mut(entity).despawn();
    for _ in 0..50 {
        app.update();
        std::thread::sleep(core::time::Duration::from_millis(1));
    }
    assert_eq!(bases(&mut app), [0; 0]);
}
