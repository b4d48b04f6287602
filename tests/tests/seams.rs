//! Levels of façades change without a seam: every pixel of a wall belongs to one level, and nobody sees a change.

use std::cmp::Ordering;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use bevy::asset::RenderAssetUsages;
use bevy::math::DVec2;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::pbr::DistanceFog;
use bevy::prelude::*;
use image::RgbImage;
use nv_flip::{FlipImageRgb8, FlipPool};
use veduta::ecs::{ATTRIBUTE_RELIEF, Cell, CellMesh, CellMeshKind, LevelFade};
use veduta::facade::FadeSettings;
use veduta::prelude::*;
use veduta::sky::SkyMaterial;
use veduta_city::{Level, Tile, Viewpoint};
use veduta_game::profile::Profile;
use veduta_game::studio::{Size, Studio};
use veduta_tests::sample_city;

/// One renderer at a time: two cores share it.
static RENDERER: Mutex<()> = Mutex::new(());

const SIZE: Size = Size { width: 320, height: 180 };

fn studio(profile: Profile) -> Studio {
    Studio::open(&sample_city().display().to_string(), SIZE, profile).unwrap_or_else(|e| panic!("{e}"))
}

fn shoot(studio: &mut Studio) -> RgbImage {
    let picture = studio.shoot().unwrap_or_else(|e| panic!("{e}"));
    image::DynamicImage::ImageRgba8(picture).to_rgb8()
}

/// The levels of which there are meshes.
const MESHES: [Level; 3] = [Level::One, Level::Two, Level::Four];
const BACKGROUND: [u8; 3] = [255, 0, 255];

/// A row of fronts along −z, six metres to the left of who stands at the origin and looks north, with nothing behind it.
fn row() -> Mesh {
    const WIDTH_M: f32 = 6.0;
    let (mut positions, mut centres, mut indices) = (vec![], vec![], vec![]);
    for i in 0..40 {
        let (near, far) = (-(i as f32) * WIDTH_M, -(i as f32 + 1.0) * WIDTH_M);
        let first = positions.len() as u32;
        positions.extend([[-6.0, -3.0, near], [-6.0, -3.0, far], [-6.0, 12.0, far], [-6.0, 12.0, near]]);
        centres.extend([[-6.0, (near + far) / 2.0]; 4]);
        indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
    }
    let all = positions.len();
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[1.0, 0.0, 0.0]; all])
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, vec![[0.0, 0.0]; all])
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_1, centres)
        .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, vec![[0.5, 0.5, 0.4, Tile::Plaster.index() as f32]; all])
        .with_inserted_indices(Indices::U32(indices))
}

/// Which pixels the meshes of some levels cover.
fn covered(studio: &mut Studio, levels: &[Level]) -> Vec<bool> {
    let world = studio.world();
    let mut meshes = world.query::<(&CellMesh, &mut Visibility)>();
    for (mesh, mut visibility) in meshes.iter_mut(world) {
        let is_shown = mesh.cell == ROW && mesh.kind.level().is_some_and(|level| levels.contains(&level));
        *visibility = if is_shown { Visibility::Inherited } else { Visibility::Hidden };
    }
    shoot(studio).pixels().map(|pixel| pixel.0 != BACKGROUND).collect()
}

/// A cell that no city has.
const ROW: u32 = u32::MAX;

#[test]
fn each_pixel_of_a_wall_belongs_to_one_level() {
    let _alone = RENDERER.lock().unwrap_or_else(PoisonError::into_inner);
    // The low profile smooths no edges but by its filter, which goes.
    let mut studio = studio(Profile::Low);
    studio.set_eye(Eye::at(Viewpoint { pos: DVec2::new(0.0, 5_000.0), ..Viewpoint::default() }));
    studio.advance(Duration::ZERO);
    studio.settle();
    let world = studio.world();
    world.insert_resource(ClearColor(Color::srgb_u8(BACKGROUND[0], BACKGROUND[1], BACKGROUND[2])));
    let sky: Vec<Entity> = world.query_filtered::<Entity, With<MeshMaterial3d<SkyMaterial>>>().iter(world).collect();
    for dome in sky {
        world.despawn(dome);
    }
    let (camera, at) = world
        .query_filtered::<(Entity, &GlobalTransform), With<Viewer>>()
        .single(world)
        .map(|(e, t)| (e, t.translation()))
        .expect("a viewer");
    world.entity_mut(camera).remove::<(bevy::anti_alias::fxaa::Fxaa, DistanceFog)>();
    *world.resource_mut::<LevelDistances>() = LevelDistances { near: [90.0, 45.0, 20.0], far: [140.0, 60.0, 40.0] };
    let cell = world.spawn((Cell(ROW), LevelFade([1.0; 4]), Transform::from_translation(at), Visibility::Inherited)).id();
    for level in MESHES {
        let mut mesh = row();
        if level == Level::Four {
            mesh.insert_attribute(ATTRIBUTE_RELIEF, vec![[1.0, 0.0, 0.0]; mesh.count_vertices()]);
        }
        let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
        world.spawn((CellMesh { cell: ROW, kind: CellMeshKind::Walls(level) }, Mesh3d(mesh), ChildOf(cell)));
    }
    studio.advance(Duration::ZERO);
    studio.warm_up();
    let fades = [
        [1.0, 1.0, 0.0, 1.0],
        [1.0, 1.0, 0.0, 0.0],
        [1.0, 0.4, 0.0, 0.0],
        [1.0, 1.0, 0.0, 0.1],
        [1.0, 0.7, 0.0, 0.2],
        [1.0, 0.0, 0.0, 0.0],
        // Pictures of painted façades, which lie on the meshes of the other levels.
        [1.0, 1.0, 1.0, 1.0],
        [1.0, 1.0, 0.5, 0.3],
        [1.0, 1.0, 1.0, 0.0],
    ];
    for fade in fades {
        studio.world().entity_mut(cell).insert(LevelFade(fade));
        studio.advance(Duration::ZERO);
        let all = covered(&mut studio, &MESHES);
        let each: Vec<Vec<bool>> = MESHES.iter().map(|&level| covered(&mut studio, &[level])).collect();
        let shown: Vec<usize> = each.iter().map(|mask| mask.iter().filter(|is| **is).count()).collect();
        println!("fades {fade:?}: {} pixels of wall, of each level {shown:?}", all.iter().filter(|is| **is).count());
        // The wall fills the left half, but for sky above its far end.
        assert!(all.iter().filter(|is| **is).count() > 10_000);
        for (level, shown) in MESHES.iter().zip(&shown) {
            assert_eq!(*shown > 0, fade[level.index()] > 0.0, "{level} with fades {fade:?}");
        }
        for (pixel, &is_wall) in all.iter().enumerate() {
            let levels = each.iter().filter(|mask| mask[pixel]).count();
            assert_eq!(levels, usize::from(is_wall), "pixel {pixel} with fades {fade:?}");
        }
    }
}

/// How levels change.
#[derive(Clone, Copy, PartialEq)]
enum Change {
    Soft,
    Hard,
    Never,
}

/// Frames a second.
const RATE: f64 = 60.0;

/// A studio in Celetná, looking along its fronts, in which levels change so.
fn street(change: Change) -> Studio {
    let mut studio = studio(Profile::Medium);
    let world = studio.world();
    world.resource_mut::<FadeSettings>().seconds = 0.0;
    let soft = Profile::Medium.levels();
    *world.resource_mut::<LevelDistances>() = match change {
        Change::Soft | Change::Hard => soft,
        Change::Never => LevelDistances { near: [900.0; 3], far: [1_000.0; 3] },
    };
    world.resource_mut::<veduta::buildings::BuildSettings>().relief_m = 120.0;
    stand(&mut studio, 0.0);
    studio.warm_up();
    studio
}

/// Puts the eye so many metres along the street.
fn stand(studio: &mut Studio, along_m: f64) {
    let pos = DVec2::new(330.0 - along_m, -22.0);
    studio.set_eye(Eye::at(Viewpoint { pos, heading_deg: 283.0, pitch_deg: 6.0, ..Viewpoint::default() }));
    studio.advance(Duration::ZERO);
    let missing = studio.settle();
    assert!(missing.is_empty(), "{missing}");
}

/// Pairs of frames, each one frame apart.
type Pairs = Vec<[RgbImage; 2]>;

/// At a walk of four metres a second.
fn approach(change: Change) -> Pairs {
    let mut studio = street(change);
    let mut at = |time: f64| {
        stand(&mut studio, 4.0 * time);
        shoot(&mut studio)
    };
    (0..10).map(|pair| f64::from(pair) * 0.4).map(|time| [at(time), at(time + 1.0 / RATE)]).collect()
}

/// A level of all cells arrives at once, after a tenth of a second, before an eye that stands still.
fn arrival(studio: &mut Studio, level: Level, change: Change) -> Pairs {
    let fade_s = if change == Change::Soft { f64::from(FadeSettings::default().seconds) } else { 1e-9 };
    let mut at = |time: f64| {
        let share = if change == Change::Never { 0.0 } else { ((time - 0.1) / fade_s).clamp(0.0, 1.0) as f32 };
        let world = studio.world();
        let fades = Level::ALL.map(|other| match other.cmp(&level) {
            Ordering::Less => 1.0,
            Ordering::Equal => share,
            Ordering::Greater => 0.0,
        });
        world.query_filtered::<&mut LevelFade, With<Cell>>().iter_mut(world).for_each(|mut now| now.0 = fades);
        studio.advance(Duration::ZERO);
        shoot(studio)
    };
    // All of the fade, in steps of a twentieth of it; where there is none, the moment of the change.
    let span = if change == Change::Soft { fade_s / 20.0 } else { 0.1 / 20.0 };
    (0..20).map(|pair| 0.1 - 0.5 / RATE + span * f64::from(pair)).map(|time| [at(time), at(time + 1.0 / RATE)]).collect()
}

/// FLIP of each pair of frames, the mean over the picture.
fn flips(pairs: &Pairs) -> Vec<f32> {
    let image = |frame: &RgbImage| FlipImageRgb8::with_data(frame.width(), frame.height(), frame);
    let flip = |[a, b]: &[RgbImage; 2]| {
        FlipPool::from_image(&nv_flip::flip(image(a), image(b), nv_flip::DEFAULT_PIXELS_PER_DEGREE)).mean()
    };
    pairs.iter().map(flip).collect()
}

/// What changes of level add to each pair, ascending.
fn added(changing: &Pairs, never: &Pairs) -> Vec<f32> {
    let mut added: Vec<f32> = flips(changing).iter().zip(flips(never)).map(|(with, without)| with - without).collect();
    added.sort_by(f32::total_cmp);
    added
}

#[test]
fn levels_change_unseen() {
    let _alone = RENDERER.lock().unwrap_or_else(PoisonError::into_inner);
    let [near, away] = [Change::Soft, Change::Never].map(approach);
    let p95 = |sorted: &[f32]| sorted[(sorted.len() * 95).div_ceil(100) - 1];
    let approach = p95(&added(&near, &away));
    println!("FLIP that changes of level add, 95th percentile: approach {approach:.4}");
    assert!(approach <= 0.01);
    let mut studio = street(Change::Soft);
    for level in [Level::Two, Level::Four] {
        let [soft, hard, never] = [Change::Soft, Change::Hard, Change::Never].map(|change| arrival(&mut studio, level, change));
        let (soft, hard) = (added(&soft, &never), added(&hard, &never));
        let (p95, most, at_once) = (p95(&soft), soft[soft.len() - 1], hard[hard.len() - 1]);
        println!("{level} arrives: {p95:.4}, most {most:.4}, at once {at_once:.4}");
        assert!(p95 <= 0.01 && 5.0 * most <= at_once, "{level}: {soft:?}, at once {hard:?}");
    }
}
