//! The bird's eye: the camera above the walk, and what is loaded about it, drawn over the houses.

use std::collections::BTreeSet;

use bevy::math::DVec2;
use bevy::prelude::*;
use veduta::city::bounds;
use veduta::ecs::{BirdsEye, Ground, WorldOrigin};
use veduta::prelude::*;
use veduta::streaming::{CurrentCell, Streamed, Wanted};

use super::{Expert, HERE, INK, fill, walls::colour};

/// Height of the camera, in reaches of the plan of cells: both show about as much.
const HIGH: f64 = 1.4;
/// Outlines are drawn so much smaller that those of neighbours are told apart.
const INNER: f64 = 0.94;
/// Length of the arrow that shows the walk's way, as a share of the camera's height.
const ARROW: f64 = 0.05;

/// Lifts the camera, or sets it down; from above, lines are seen through houses.
pub(super) fn lift(
    mut commands: Commands,
    expert: Res<Expert>,
    viewers: Query<(Entity, Option<&BirdsEye>), With<Viewer>>,
    gizmos: Option<ResMut<GizmoConfigStore>>,
) {
    let wished = (expert.is_shown && expert.is_aloft).then(|| BirdsEye { height_m: f64::from(expert.reach_m) * HIGH });
    let mut has_moved = false;
    for (viewer, present) in &viewers {
        match wished {
            Some(wished) if present != Some(&wished) => drop(commands.entity(viewer).insert(wished)),
            None if present.is_some() => drop(commands.entity(viewer).remove::<BirdsEye>()),
            _ => continue,
        }
        has_moved = true;
    }
    // Where nothing is drawn there are no lines.
    if let Some(mut gizmos) = gizmos.filter(|_| has_moved) {
        let config = gizmos.config_mut::<DefaultGizmoConfigGroup>().0;
        (config.depth_bias, config.line.width) = if wished.is_some() { (-1.0, 3.0) } else { (0.0, 2.0) };
    }
}

/// Draws the cells that are loaded, in the colours of the plan, and where the walk is.
pub(super) fn draw(
    mut gizmos: Gizmos<'_, '_>,
    streamed: Streamed<'_>,
    wanted: Res<Wanted>,
    origin: Res<WorldOrigin>,
    ground: Ground<'_>,
    viewers: Query<(&Eye, Option<&CurrentCell>, &BirdsEye), With<Viewer>>,
) {
    let Some(index) = streamed.index() else { return };
    let in_sight: BTreeSet<u32> = wanted.in_sight.iter().copied().collect();
    for (eye, current, above) in &viewers {
        let here = current.and_then(|current| current.0);
        let is_near = |of| bounds::distance_m(of, eye.plan_pos) < 2.0 * above.height_m;
        for (cell, entry) in index.cells().filter(|(_, entry)| is_near(entry.bounds)) {
            let Some(level) = streamed.level(cell) else { continue };
            let ink = if Some(cell) == here { HERE } else { fill(Some(level), in_sight.contains(&cell)) };
            let middle = entry.outline.centroid();
            let z = ground.at(middle, eye.ground_m);
            for ring in entry.outline.rings() {
                let ring = ring.iter().map(|pos| origin.world_from_plan(middle.lerp(pos.to_metres(), INNER), z));
                gizmos.lineloop(ring, colour(ink, 1.0));
            }
        }
        let at = |ahead_m: f64| {
            let (sin, cos) = eye.heading_deg.to_radians().sin_cos();
            origin.world_from_plan(eye.plan_pos + DVec2::new(sin, cos) * ahead_m, eye.z_m())
        };
        let long_m = above.height_m * ARROW;
        gizmos.arrow(at(-long_m), at(long_m), colour(INK, 1.0)).with_tip_length(long_m as f32 * 0.7);
    }
}
