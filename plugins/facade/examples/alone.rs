//! Façade levels alone, on meshes of one's own: a row of fronts whose windows come and go with the distance.
//!
//! `cargo run -p veduta-facade --example facade_alone`

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use veduta_city::{Level, Opening, Tile};
use veduta_ecs::{Cell, CellMesh, CellMeshKind, CellStands, LevelFade};
use veduta_facade::{FacadePlugin, LevelDistances};

fn main() -> AppExit {
    let mut app = App::new();
    app.add_plugins((DefaultPlugins, FacadePlugin::default()))
        .insert_resource(LevelDistances::uniform(60.0))
        .add_systems(Startup, (build_row, light_and_camera))
        .add_systems(Update, stroll);
    app.run()
}

/// One cell with walls of two levels; both stand at once.
fn build_row(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut stands: MessageWriter<CellStands>) {
    let row = commands.spawn((Cell(0), LevelFade::default())).id();
    for (level, tile) in [(Level::One, Tile::Plaster), (Level::Two, Tile::Bay(Opening::FramedWindow))] {
        let mesh = CellMesh { cell: 0, kind: CellMeshKind::Walls(level) };
        commands.spawn((mesh, Mesh3d(meshes.add(fronts(tile))), ChildOf(row)));
        stands.write(CellStands { entity: row, cell: 0, level });
    }
}

const FRONTS: usize = 30;
const WIDTH_M: f32 = 9.0;
const HEIGHT_M: f32 = 14.0;
const BAYS: f32 = 3.0;
const STOREYS: f32 = 4.0;

/// A row of fronts along −z that look east. The second UV set is each front's centre, the colour's alpha the tile's layer.
fn fronts(tile: Tile) -> Mesh {
    let (mut positions, mut uvs, mut centres, mut colours, mut indices) = (vec![], vec![], vec![], vec![], vec![]);
    for i in 0..FRONTS {
        let (near, far) = (-(i as f32) * WIDTH_M, -(i as f32 + 1.0) * WIDTH_M);
        let first = positions.len() as u32;
        positions.extend([[-6.0, 0.0, near], [-6.0, 0.0, far], [-6.0, HEIGHT_M, far], [-6.0, HEIGHT_M, near]]);
        uvs.extend([[0.0, STOREYS], [BAYS, STOREYS], [BAYS, 0.0], [0.0, 0.0]]);
        centres.extend([[-6.0, (near + far) / 2.0]; 4]);
        let warm = 0.35 + 0.1 * (i % 4) as f32;
        colours.extend([[0.7, 0.6, warm, tile.index() as f32]; 4]);
        indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
    }
    let normals = vec![[1.0, 0.0, 0.0]; positions.len()];
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_1, centres)
        .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colours)
        .with_inserted_indices(Indices::U32(indices))
}

fn light_and_camera(mut commands: Commands) {
    let sun = DirectionalLight { illuminance: 8_000.0, ..default() };
    commands.spawn((sun, Transform::from_xyz(8.0, 10.0, 5.0).looking_at(Vec3::ZERO, Vec3::Y)));
    commands.spawn((Camera3d::default(), Transform::default()));
}

/// Down the row and back.
fn stroll(time: Res<Time>, mut cameras: Query<&mut Transform, With<Camera3d>>) {
    let z = -60.0 + 70.0 * (time.elapsed_secs() * 0.15).cos();
    for mut camera in &mut cameras {
        *camera = Transform::from_xyz(2.0, 1.7, z).looking_at(Vec3::new(-6.0, 5.0, z - 25.0), Vec3::Y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_levels_fade_in() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, AssetPlugin::default(), FacadePlugin::default())).init_asset::<Mesh>();
        let step = std::time::Duration::from_millis(250);
        app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(step)).add_systems(Startup, build_row);
        for _ in 0..20 {
            app.update();
        }
        let fade = app.world_mut().query::<&LevelFade>().single(app.world()).expect("one cell was spawned");
        assert_eq!(fade.0, [1.0, 1.0, 0.0, 0.0]);
    }

    #[test]
    fn a_front_has_four_corners_and_one_centre() {
        let mesh = fronts(Tile::Plaster);
        assert_eq!(mesh.count_vertices(), 4 * FRONTS);
        assert_eq!(mesh.indices().map(Indices::len), Some(6 * FRONTS));
    }
}
