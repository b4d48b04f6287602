//! Trees are made anew when the season turns.

use std::sync::Arc;

use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use veduta_buildings::{Building, BuildingsPlugin, CitySeason};
use veduta_city::{CellShell, FacadeSheet, GridPos, Level, ObjectKind, ObjectShell, Season, Tile};
use veduta_ecs::{Cell, CellContent, CellMesh, CellMeshKind, CellReady, CellStands, CityClock, MaterialsProvided};

fn tree() -> CellShell {
    let tree = ObjectShell { kind: ObjectKind::Tree, pos: GridPos(0, 0), z: 0, heading: 0, height: 9 * 1024, monument: None };
    CellShell { objects: vec![tree], ..CellShell::default() }
}

/// Vertices of each mesh of trees that stands, at level 1.
fn trees(app: &mut App) -> Vec<usize> {
    trees_at(app, Level::One)
}

fn trees_at(app: &mut App, level: Level) -> Vec<usize> {
    let mut query = app.world_mut().query::<(&CellMesh, &Mesh3d)>();
    let meshes = app.world().resource::<Assets<Mesh>>();
    let trees = query.iter(app.world()).filter(|(mesh, _)| mesh.kind == CellMeshKind::Trees(level));
    trees.map(|(_, mesh)| meshes.get(&mesh.0).expect("a mesh").count_vertices()).collect()
}

/// A cell with a tree, ordered but not made.
fn ordered(building: Building) -> (App, Entity) {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), BuildingsPlugin { building })).init_asset::<Mesh>();
    let content = CellContent { shell: Arc::new(tree()), sheet: None, pictures: None };
    let entity = app.world_mut().spawn((Cell(0), content)).id();
    app.world_mut().write_message(CellReady { entity, cell: 0, level: Level::One });
    (app, entity)
}

#[test]
fn trees_turn_with_the_clock() {
    let (mut app, _) = ordered(Building::Inline);
    app.update();
    let summer = trees(&mut app);
    assert_eq!((summer.len(), app.world().resource::<CitySeason>().0), (1, Season::Summer));

    app.world_mut().resource_mut::<CityClock>().day = 20;
    app.update();
    let winter = trees(&mut app);
    assert_eq!((winter.len(), app.world().resource::<CitySeason>().0), (1, Season::Winter), "one mesh takes the other's place");
    assert_ne!(summer, winter, "a bare tree is not one in leaf");
    let told = app.world().resource::<Messages<CellStands>>().len();
    assert_eq!(told, 1, "it came to stand a frame ago, and not again in this one");

    app.world_mut().resource_mut::<CityClock>().day = 160;
    app.update();
    assert_eq!(trees(&mut app), summer);
}

#[test]
fn a_cell_that_goes_while_it_turns_leaves_nothing() {
    let (mut app, entity) = ordered(Building::Pool);
    for _ in 0..2000 {
        app.update();
        std::thread::sleep(core::time::Duration::from_millis(1));
        if !trees(&mut app).is_empty() {
            break;
        }
    }
    assert_eq!(trees(&mut app).len(), 1);
    app.world_mut().resource_mut::<CityClock>().day = 20;
    app.update();
    app.world_mut().entity_mut(entity).despawn();
    for _ in 0..50 {
        app.update();
        std::thread::sleep(core::time::Duration::from_millis(1));
    }
    assert_eq!(trees(&mut app), [0; 0]);
}

#[test]
fn where_there_are_tiles_trees_are_cards_from_afar_and_bodies_near_by() {
    let (mut plain, _) = ordered(Building::Inline);
    plain.update();
    let bodies = trees(&mut plain);
    let (mut app, entity) = ordered(Building::Inline);
    app.insert_resource(MaterialsProvided { are_made: true, reads_blocks: false });
    app.update();
    assert_eq!(
        (trees_at(&mut app, Level::One), trees_at(&mut app, Level::Two)),
        (vec![68], vec![]),
        "two cards in each of eight directions, and one from above"
    );

    app.world_mut().get_mut::<CellContent>(entity).expect("it stands").sheet = Some(Arc::new(FacadeSheet::default()));
    app.world_mut().write_message(CellReady { entity, cell: 0, level: Level::Two });
    app.update();
    assert_eq!((trees_at(&mut app, Level::One), trees_at(&mut app, Level::Two)), (vec![68], bodies.clone()));

    app.world_mut().resource_mut::<CityClock>().day = 20;
    app.update();
    let bare = trees_at(&mut app, Level::Two);
    assert_eq!((trees_at(&mut app, Level::One), bare.len()), (vec![68], 1), "each takes the other's place");
    assert_ne!(bare, bodies);
    let mut cards = app.world_mut().query::<(&CellMesh, &Mesh3d)>();
    let (_, cards) = cards.iter(app.world()).find(|(mesh, _)| mesh.kind == CellMeshKind::Trees(Level::One)).expect("it stands");
    let cards = app.world().resource::<Assets<Mesh>>().get(&cards.0).expect("a mesh");
    let Some(VertexAttributeValues::Float32x4(colours)) = cards.attribute(Mesh::ATTRIBUTE_COLOR) else { panic!("no layers") };
    let bare = Tile::BareTree(ObjectKind::Tree).index() as f32;
    assert!(colours.iter().all(|colour| colour[3] == bare), "cards bear no leaves either");
}
