use bevy::asset::RenderAssetUsages;
use bevy::light::{NotShadowCaster, NotShadowReceiver};
use bevy::math::DVec2;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use veduta_ecs::{Eye, Ground, Route, Viewer, WorldOrigin};

/// The line on the ground along which somebody is led.
#[derive(Component, Debug, Clone, Copy, Default)]
pub(crate) struct Trail;

/// Arrowheads lie so far from one another and so high above the ground, metres: above kerbs.
const APART_M: f64 = 2.5;
const ABOVE_M: f64 = 0.17;
/// Half the width of an arrowhead, how far its wings lie back, and how thick it is; metres.
const WING_M: f64 = 0.4;
const BACK_M: f64 = 0.35;
const THICK_M: f64 = 0.22;
/// No more than so many are drawn, from the visitor on.
const MOST: usize = 400;

/// Positions along a way, evenly apart, with its direction there.
fn steps(way: &[DVec2]) -> Vec<(DVec2, DVec2)> {
    let (mut steps, mut left) = (Vec::new(), APART_M);
    for pair in way.windows(2) {
        let (span, direction) = (pair[0].distance(pair[1]), (pair[1] - pair[0]).normalize_or_zero());
        let mut along = left;
        while along < span && steps.len() < MOST {
            steps.push((pair[0] + direction * along, direction));
            along += APART_M;
        }
        left = along - span;
    }
    steps
}

/// An arrowhead's corners about its tip: the left half, then the right one.
fn arrowhead(direction: DVec2) -> [DVec2; 6] {
    let left = direction.perp() * WING_M;
    let (back, thick) = (direction * -BACK_M, direction * -THICK_M);
    [DVec2::ZERO, left + back, left + back + thick, thick, -left + back, -left + back + thick]
}

const TRIANGLES: [u32; 12] = [0, 1, 2, 0, 2, 3, 0, 3, 5, 0, 5, 4];

/// Lays the line when there is a new way, and takes it up when there is none.
pub(crate) fn lay(
    route: Res<Route>,
    origin: Res<WorldOrigin>,
    ground: Ground<'_>,
    viewers: Query<&Eye, With<Viewer>>,
    trails: Query<Entity, With<Trail>>,
    mut laid: Local<Vec<DVec2>>,
    mut commands: Commands,
    meshes: Option<ResMut<Assets<Mesh>>>,
    materials: Option<ResMut<Assets<StandardMaterial>>>,
) {
    if *laid == route.way {
        return;
    }
    laid.clone_from(&route.way);
    trails.iter().for_each(|trail| commands.entity(trail).despawn());
    let (Some(mut meshes), Some(mut materials)) = (meshes, materials) else { return };
    let mut near_m = viewers.iter().next().map_or(0.0, |eye| eye.ground_m);
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for (at, direction) in steps(&route.way) {
        near_m = ground.at(at, near_m);
        let first = positions.len() as u32;
        positions.extend(arrowhead(direction).map(|corner| origin.world_from_plan(at + corner, near_m + ABOVE_M).to_array()));
        indices.extend(TRIANGLES.map(|n| first + n));
    }
    if positions.is_empty() {
        return;
    }
    let mut mesh = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::RENDER_WORLD);
    mesh.insert_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, 1.0, 0.0]; positions.len()]);
    mesh.insert_attribute(Mesh::ATTRIBUTE_POSITION, positions);
    mesh.insert_indices(Indices::U32(indices));
    let material = StandardMaterial {
        base_color: Color::srgba(0.16, 0.47, 0.75, 0.85),
        unlit: true,
        alpha_mode: AlphaMode::Blend,
        cull_mode: None,
        ..default()
    };
    commands.spawn((Trail, Mesh3d(meshes.add(mesh)), MeshMaterial3d(materials.add(material)), NotShadowCaster, NotShadowReceiver));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrowheads_lie_evenly_round_corners() {
        let way = [(0.0, 0.0), (6.0, 0.0), (6.0, 6.0)].map(DVec2::from);
        let steps = steps(&way);
        assert_eq!(steps.len(), 4);
        let along = |p: DVec2| p.x + p.y;
        assert!(steps.windows(2).all(|w| (along(w[1].0) - along(w[0].0) - APART_M).abs() < 1e-9), "{steps:?}");
        assert_eq!((steps[0].1, steps[3].1), (DVec2::X, DVec2::Y));
        assert!(super::steps(&[]).is_empty() && super::steps(&way[..1]).is_empty());
    }

    #[test]
    fn an_arrowhead_points_ahead() {
        let corners = arrowhead(DVec2::X);
        assert!(corners.iter().all(|corner| corner.x <= 0.0), "{corners:?}");
        assert!(corners[1].y > 0.3 && corners[4].y < -0.3);
    }

    #[test]
    fn the_line_comes_and_goes_with_the_way() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, veduta_ecs::EcsPlugin))
            .insert_resource(Assets::<Mesh>::default())
            .insert_resource(Assets::<StandardMaterial>::default())
            .add_systems(Update, lay);
        let trails = |app: &mut App| {
            app.update();
            app.world_mut().query::<&Trail>().iter(app.world()).count()
        };
        assert_eq!(trails(&mut app), 0);
        app.world_mut().resource_mut::<Route>().way = vec![DVec2::ZERO, DVec2::new(20.0, 0.0)];
        assert_eq!(trails(&mut app), 1);
        app.world_mut().resource_mut::<Route>().way.push(DVec2::new(20.0, 20.0));
        assert_eq!(trails(&mut app), 1);
        app.insert_resource(Route::default());
        assert_eq!(trails(&mut app), 0);
    }
}
