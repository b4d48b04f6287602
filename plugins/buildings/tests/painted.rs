//! Walls that somebody painted: their meshes, their pictures, and pictures that are none.

use std::sync::Arc;

use bevy::prelude::*;
use veduta_buildings::{Building, BuildingsPlugin};
use veduta_city::{
    CellShell, FacadeSheet, Gable, GridPolygon, GridPos, HouseShell, Level, PaintedFacade, PaintedWall, PictureFile, PlanRoof, Rgb,
    RoofShape, VolumeShell, Wall, WallKind,
};
use veduta_ecs::{Cell, CellContent, CellMesh, CellMeshKind, CellPictures, CellReady, MaterialsProvided, StandingCells};
use veduta_texture::PICTURE_SIDE;

/// A house of which two walls are painted.
fn content() -> CellContent {
    let m = 1024;
    let footprint = GridPolygon::simple(vec![GridPos(0, 0), GridPos(20 * m, 0), GridPos(20 * m, 9 * m), GridPos(0, 9 * m)]);
    let volume = VolumeShell {
        footprint,
        bottom: 0,
        eaves: 12 * m,
        colour: Rgb(9, 9, 9),
        trim: Rgb(9, 9, 9),
        roof: PlanRoof { shape: RoofShape::Hipped, height: 4 * m, direction: 90, colour: Rgb(9, 9, 9) },
        gable: Gable::Plain,
        has_roof: true,
        walls: vec![0, 1],
        arcades: Vec::new(),
    };
    let house = HouseShell { style: 0, floor: 0, volumes: vec![volume], is_monument: false };
    let painted = |width: i32| PaintedFacade {
        size: (width * m, 12 * m),
        sections: 1,
        colour: Rgb(200, 100, 50),
        ..PaintedFacade::default()
    };
    let wall = Wall { kind: WallKind::Street, ..Wall::default() };
    let painted = vec![PaintedWall { wall: 0, painted: painted(20) }, PaintedWall { wall: 1, painted: painted(9) }];
    let sheet = FacadeSheet { walls: vec![wall; 2], painted };
    let shell = CellShell { houses: vec![house], ..CellShell::default() };
    CellContent { shell: Arc::new(shell), sheet: Some(Arc::new(sheet)), pictures: None }
}

/// A picture of one colour, as bakers write them.
fn picture() -> PictureFile {
    let side = PICTURE_SIDE as u32;
    PictureFile(webp::Encoder::from_rgb(&[10, 200, 30].repeat(PICTURE_SIDE * PICTURE_SIDE), side, side).encode(50.0).to_vec())
}

/// The cell at level 3 with such pictures: its entity, and the app.
fn standing(pictures: Vec<PictureFile>) -> (App, Entity) {
    arrived(pictures, true)
}

/// The same, whose levels arrive in frames of their own or in one.
fn arrived(pictures: Vec<PictureFile>, apart: bool) -> (App, Entity) {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), BuildingsPlugin { building: Building::Inline }));
    app.init_asset::<Mesh>().init_asset::<Image>();
    app.insert_resource(MaterialsProvided { are_made: true, reads_blocks: true });
    let content = CellContent { pictures: Some(pictures.into()), ..content() };
    let entity = app.world_mut().spawn((Cell(0), content)).id();
    for level in [Level::One, Level::Two, Level::Three] {
        app.world_mut().write_message(CellReady { entity, cell: 0, level });
        if apart {
            app.update();
        }
    }
    app.update();
    (app, entity)
}

#[test]
fn a_painted_wall_has_a_mesh_of_its_own_and_a_layer_for_each_section() {
    stands_with_layers(true);
    stands_with_layers(false);
}

fn stands_with_layers(apart: bool) {
    let (mut app, entity) = arrived(vec![picture(), picture()], apart);
    let mut kinds: Vec<CellMeshKind> = app.world_mut().query::<&CellMesh>().iter(app.world()).map(|mesh| mesh.kind).collect();
    kinds.sort_unstable();
    assert!(kinds.contains(&CellMeshKind::Painted(Level::Two)), "{kinds:?}");
    assert!(app.world().resource::<StandingCells>().levels(0).has(Level::Three));
    let pictures = app.world().get::<CellPictures>(entity).expect("it is painted").clone();
    let images = app.world().resource::<Assets<Image>>();
    let layers = |handle: &Handle<Image>| {
        let size = images.get(handle).expect("it is there").texture_descriptor.size;
        (size.width, size.height, size.depth_or_array_layers)
    };
    let fine = pictures.fine.expect("its pictures have come");
    assert_eq!((layers(&pictures.coarse), layers(&fine)), ((128, 128, 2), (512, 512, 2)));
    let texels = 512 * 512 * 2 * 4;
    let bytes = images.get(&fine).and_then(|image| image.data.as_ref()).map_or(0, Vec::len);
    assert!(bytes * 4 < texels, "{bytes} B in blocks with mips, {texels} B without either");
}

#[test]
fn pictures_that_are_none_leave_the_wall_at_level_2() {
    let bad = || PictureFile(vec![0xFF; 5_000]);
    for pictures in [vec![bad(), bad()], vec![picture()], vec![]] {
        let (app, entity) = standing(pictures);
        assert!(!app.world().resource::<StandingCells>().levels(0).has(Level::Three));
        assert!(app.world().get::<CellPictures>(entity).is_some_and(|pictures| pictures.fine.is_none()));
    }
    let (app, entity) = standing(vec![bad(), picture()]);
    assert!(app.world().resource::<StandingCells>().levels(0).has(Level::Three), "the other wall has its picture");
    assert!(app.world().get::<CellPictures>(entity).is_some_and(|pictures| pictures.fine.is_some()));
}

#[test]
fn pictures_go_with_their_level() {
    let (mut app, entity) = standing(vec![picture(), picture()]);
    app.world_mut().get_mut::<CellContent>(entity).expect("spawned above").pictures = None;
    app.update();
    assert!(app.world().get::<CellPictures>(entity).is_some_and(|pictures| pictures.fine.is_none()));
    app.world_mut().get_mut::<CellContent>(entity).expect("spawned above").sheet = None;
    app.update();
    assert_eq!(app.world().get::<CellPictures>(entity), None);
}
