use bevy::camera::primitives::Aabb;
use bevy::prelude::*;
use veduta_city::Level;
use veduta_ecs::{CellMesh, CellMeshKind, LevelFade};

use crate::material::CityMaterials;
use crate::{CityMaterial, LevelDistances, LevelReach};

/// How many of its pixels a mesh keeps, over all its façades.
#[derive(Component, Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Share {
    /// It begins nearer than any camera is, or finer levels have taken its place everywhere.
    None,
    /// Façade by façade, pixel by pixel, as the shader decides.
    Some,
    /// No other level has any.
    All,
}

/// Finds the share of every mesh from its bounds: a few comparisons for each cell's level, none for a façade.
pub(crate) fn find_shares(
    mut commands: Commands,
    (distances, reach): (Res<LevelDistances>, Res<LevelReach>),
    cameras: Query<(&Camera, &GlobalTransform, &Projection), With<Camera3d>>,
    lights: Query<&DirectionalLight>,
    cells: Query<&LevelFade>,
    mut meshes: Query<(Entity, &CellMesh, &Aabb, &GlobalTransform, &ChildOf, Option<&mut Share>)>,
) {
    let distances = distances.within(*reach);
    // Where none is active, those count that may be so the next moment.
    let is_any_active = cameras.iter().any(|(camera, ..)| camera.is_active);
    let counted = || cameras.iter().filter(|(camera, ..)| camera.is_active || !is_any_active);
    // From where an orthographic camera measures distances is its own affair.
    if counted().next().is_none() || counted().any(|(.., projection)| !matches!(projection, Projection::Perspective(_))) {
        meshes.iter_mut().filter_map(|mesh| mesh.5).for_each(|mut share| _ = share.set_if_neq(Share::Some));
        return;
    }
    let eyes: Vec<Vec2> = counted().map(|(_, place, _)| place.translation().xz()).collect();
    let are_shadows_cast = lights.iter().any(|light| light.shadow_maps_enabled);
    for (entity, mesh, bounds, place, cell, share) in &mut meshes {
        let level = match mesh.kind {
            CellMeshKind::Walls(level) | CellMeshKind::Painted(level) | CellMeshKind::Trees(level) => level,
            CellMeshKind::Fittings => Level::Two,
            CellMeshKind::Base | CellMeshKind::District => continue,
        };
        let Ok(fade) = cells.get(cell.parent()) else { continue };
        let reach = Reach::of(&eyes, bounds, place);
        let own = match mesh.kind {
            CellMeshKind::Fittings => reach.share(level, &distances, &LevelFade([1.0; 4])),
            _ if level == Level::One => Share::All,
            _ => reach.share(level, &distances, fade),
        };
        // Level 3 has no meshes of its own, and there is nothing finer than trees' bodies and fittings.
        let finer = match mesh.kind {
            CellMeshKind::Walls(Level::One) => {
                reach.share(Level::Two, &distances, fade).max(reach.share(Level::Four, &distances, fade))
            }
            CellMeshKind::Trees(Level::One) => reach.share(Level::Two, &distances, fade),
            CellMeshKind::Walls(Level::Two) | CellMeshKind::Painted(Level::Two) => reach.share(Level::Four, &distances, fade),
            _ => Share::None,
        };
        let found = match (own, finer) {
            // Bodies of trees cast shadows in place of their cards, however far they are.
            (Share::None, _) if mesh.kind == CellMeshKind::Trees(Level::Two) && are_shadows_cast && fade.0[1] > 0.0 => Share::Some,
            (Share::None, _) => Share::None,
            // The walls of level 1 cast the shadows of all.
            (_, Share::All) if level == Level::One && are_shadows_cast => Share::Some,
            (_, Share::All) => Share::None,
            (Share::All, Share::None) => Share::All,
            _ => Share::Some,
        };
        match share {
            Some(mut share) => _ = share.set_if_neq(found),
            // Shared at first, so that its shader is asked for before it is needed.
            None => _ = commands.entity(entity).insert(Share::Some),
        }
    }
}

/// Hides meshes without a pixel, and draws those that have them all without asking for each.
pub(crate) fn heed_shares(
    in_use: Option<Res<CityMaterials>>,
    mut meshes: Query<
        (&CellMesh, &Share, &ChildOf, &mut Visibility, Option<&mut MeshMaterial3d<CityMaterial>>),
        Or<(Changed<Share>, Added<MeshMaterial3d<CityMaterial>>)>,
    >,
) {
    for (mesh, &share, cell, mut visibility, material) in &mut meshes {
        visibility.set_if_neq(if share == Share::None { Visibility::Hidden } else { Visibility::Inherited });
        if let (Some(in_use), Some(mut material)) = (&in_use, material) {
            let wanted = in_use.of(mesh.kind, cell.parent(), share == Share::All);
            if let Some(wanted) = wanted.filter(|wanted| material.0 != **wanted) {
                material.0 = wanted.clone();
            }
        }
    }
}

/// Centres of façades and monuments may lie so far outside of the bounds of what is drawn of them, metres.
const MARGIN_M: f32 = 4.0;

/// How far bounds are from eyes, as the shader measures: in plan.
#[derive(Debug, Clone, Copy)]
struct Reach {
    nearest_m: f32,
    farthest_m: f32,
}

impl Reach {
    /// Of the nearest and of the farthest eye.
    fn of(eyes: &[Vec2], bounds: &Aabb, place: &GlobalTransform) -> Self {
        let middle = place.transform_point(bounds.center.into()).xz();
        let half = Vec3::from(bounds.half_extents).xz().length() + MARGIN_M;
        let away = eyes.iter().map(|eye| eye.distance(middle));
        let (nearest, farthest) = away.fold((f32::INFINITY, 0.0_f32), |(near, far), away| (near.min(away), far.max(away)));
        Self { nearest_m: nearest - half, farthest_m: farthest + half }
    }

    /// What a level finer than 1 has of all that lies within the bounds, before still finer ones take of it.
    fn share(self, level: Level, distances: &LevelDistances, fade: &LevelFade) -> Share {
        let band = level.index() - 1;
        let (near, far, fade) = (distances.near[band], distances.far[band], fade.0[level.index()]);
        if far <= 0.0 || fade <= 0.0 || self.nearest_m > far {
            Share::None
        } else if fade >= 1.0 && self.farthest_m < near {
            Share::All
        } else {
            Share::Some
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use veduta_ecs::Cell;

    /// The shares of a cell's walls of levels 1, 2 and 4 about a point so far from the eye.
    fn shares(away_m: f32, fade: [f32; 4], are_shadows_cast: bool) -> [Share; 3] {
        shares_of([Level::One, Level::Two, Level::Four].map(CellMeshKind::Walls), away_m, fade, are_shadows_cast)
    }

    fn shares_of<const N: usize>(kinds: [CellMeshKind; N], away_m: f32, fade: [f32; 4], are_shadows_cast: bool) -> [Share; N] {
        let mut app = App::new();
        app.init_resource::<LevelReach>().insert_resource(LevelDistances { near: [80.0, 40.0, 14.0], far: [110.0, 55.0, 18.0] });
        app.add_systems(Update, (find_shares, heed_shares).chain());
        let world = app.world_mut();
        world.spawn((Camera3d::default(), GlobalTransform::from(Transform::from_xyz(away_m, 40.0, 0.0))));
        world.spawn(DirectionalLight { shadow_maps_enabled: are_shadows_cast, ..default() });
        let cell = world.spawn((Cell(0), LevelFade(fade))).id();
        let bounds = Aabb::from_min_max(Vec3::new(-3.0, 0.0, -4.0), Vec3::new(3.0, 15.0, 4.0));
        let meshes = kinds.map(|kind| {
            let mesh = CellMesh { cell: 0, kind };
            world.spawn((mesh, bounds, GlobalTransform::IDENTITY, Visibility::default(), ChildOf(cell))).id()
        });
        // At first they share pixels.
        app.update();
        assert!(meshes.iter().all(|&mesh| app.world().get::<Share>(mesh) == Some(&Share::Some)));
        app.update();
        meshes.map(|mesh| {
            let found = app.world().get::<Share>(mesh).copied();
            let is_hidden = app.world().get::<Visibility>(mesh) == Some(&Visibility::Hidden);
            assert_eq!(is_hidden, found == Some(Share::None), "what has no pixels is hidden");
            found.expect("every mesh has a share")
        })
    }

    #[test]
    fn levels_have_pixels_where_their_bounds_reach_into_their_bands() {
        use Share::{All, None, Some};
        let all = [1.0; 4];
        assert_eq!(shares(300.0, all, false), [All, None, None]);
        assert_eq!(shares(114.0, all, false), [Some, Some, None], "its bounds reach into the band");
        assert_eq!(shares(100.0, all, false), [Some, Some, None]);
        assert_eq!(shares(60.0, all, false), [None, All, None]);
        assert_eq!(shares(20.0, all, false), [None, Some, Some]);
        assert_eq!(shares(3.0, all, false), [None, None, All]);
    }

    #[test]
    fn a_level_that_still_fades_in_takes_not_all() {
        use Share::{All, None, Some};
        assert_eq!(shares(60.0, [1.0, 0.99, 0.0, 0.0], false), [Some, Some, None]);
        assert_eq!(shares(60.0, [1.0, 0.0, 0.0, 0.0], false), [All, None, None], "and none before it begins");
        assert_eq!(shares(3.0, [1.0, 1.0, 0.0, 0.5], false), [None, Some, Some]);
    }

    #[test]
    fn walls_of_level_1_stay_where_they_cast_shadows() {
        use Share::{All, None, Some};
        assert_eq!(shares(60.0, [1.0; 4], true), [Some, All, None]);
        assert_eq!(shares(3.0, [1.0; 4], true), [Some, None, All]);
    }
    #[test]
    fn bodies_of_trees_stay_where_they_cast_shadows_and_their_cards_do_not() {
        use Share::{All, None, Some};
        let trees = [Level::One, Level::Two].map(CellMeshKind::Trees);
        assert_eq!(shares_of(trees, 300.0, [1.0; 4], false), [All, None]);
        assert_eq!(shares_of(trees, 300.0, [1.0; 4], true), [All, Some], "they have no pixel, but a shadow");
        assert_eq!(shares_of(trees, 300.0, [1.0, 0.0, 0.0, 0.0], true), [All, None], "and none before they come");
    }
    #[test]
    fn fittings_ask_for_no_level() {
        let fittings = |away_m: f32| shares_of([CellMeshKind::Fittings], away_m, [1.0, 0.0, 0.0, 0.0], true);
        assert_eq!([300.0, 100.0, 60.0].map(fittings), [[Share::None], [Share::Some], [Share::All]]);
    }
}
