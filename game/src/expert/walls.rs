//! In the street: blue stones for what is on its way, walls in the portals; a click on one walks through.

use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use bevy_egui::EguiContexts;
use bevy_egui::egui::Color32;
use veduta::city::Viewpoint;
use veduta::ecs::{Ground, JumpTo, OpenCells, WorldOrigin};
use veduta::prelude::*;
use veduta::streaming::{CurrentCell, Streamed};
use veduta::walker::{Gait, Intent};
use veduta_store::What;

use super::{EDGE, Expert, OPEN, PENDING, SHUT};

/// Height of a wall, and between its lines; metres.
const HIGH_M: f64 = 2.6;
const APART_M: f64 = 1.3;
/// Half the edge of a stone, metres.
const STONE_M: f32 = 0.35;
/// So far beyond a portal one has walked through it, metres.
const BEYOND_M: f64 = 1.2;
/// A way through that takes longer is given up, seconds.
const PATIENCE_S: f64 = 20.0;

/// Where a click on a wall leads, and for how long one has been on the way.
#[derive(Resource, Default)]
pub(crate) struct WalkThrough(Option<(DVec2, f64)>);

pub(super) fn colour(colour: Color32, alpha: f32) -> Color {
    Color::srgba_u8(colour.r(), colour.g(), colour.b(), (alpha * 255.0) as u8)
}

pub(super) fn draw(
    mut gizmos: Gizmos<'_, '_>,
    streamed: Streamed<'_>,
    open: Res<OpenCells>,
    origin: Res<WorldOrigin>,
    ground: Ground<'_>,
    viewers: Query<(&Eye, Option<&CurrentCell>), With<Viewer>>,
) {
    let Some(index) = streamed.index() else { return };
    let Some((eye, current)) = viewers.iter().next() else { return };
    let z_at = |pos: DVec2| ground.at(pos, eye.ground_m);
    let pending = streamed.pending().filter_map(|what| if let What::Packet { cell, .. } = what { index.cell(cell) } else { None });
    for entry in pending {
        let middle = entry.outline.centroid();
        let at = origin.world_from_plan(middle, z_at(middle)) + Vec3::Y * STONE_M;
        gizmos.cube(Transform::from_translation(at).with_scale(Vec3::splat(2.0 * STONE_M)), colour(PENDING, 1.0));
        gizmos.line(at, at + Vec3::Y * 30.0, colour(PENDING, 0.4));
    }
    let Some(here) = current.and_then(|current| current.0) else { return };
    for portal in index.portals(here) {
        let ink = match portal.other(here) {
            None => EDGE,
            Some(beyond) if open.lead(here, beyond) => OPEN,
            Some(_) => SHUT,
        };
        let (a, b) = (portal.ends.0.to_metres(), portal.ends.1.to_metres());
        let corner = |pos: DVec2, high_m: f64| origin.world_from_plan(pos, z_at(pos) + high_m);
        let (low, high) = (0.05, HIGH_M);
        gizmos.lineloop([corner(a, low), corner(b, low), corner(b, high), corner(a, high)], colour(ink, 0.9));
        let bars = (a.distance(b) / APART_M).ceil().max(1.0);
        for n in 1..bars as u32 {
            let pos = a.lerp(b, f64::from(n) / bars);
            gizmos.line(corner(pos, low), corner(pos, high), colour(ink, 0.35));
        }
    }
}

/// A click in the street on a wall that is open.
pub(super) fn click(
    mut contexts: EguiContexts,
    buttons: Res<ButtonInput<MouseButton>>,
    windows: Query<&Window, With<PrimaryWindow>>,
    cameras: Query<(&Camera, &GlobalTransform)>,
    streamed: Streamed<'_>,
    origin: Res<WorldOrigin>,
    viewers: Query<(&Eye, Option<&CurrentCell>), With<Viewer>>,
    mut expert: ResMut<Expert>,
    mut jumps: MessageWriter<JumpTo>,
    mut through: ResMut<WalkThrough>,
) -> Result {
    if let (Some(pos), Some((eye, _))) = (expert.leap.take(), viewers.iter().next()) {
        jumps.write(JumpTo(Viewpoint { pos, heading_deg: eye.heading_deg, ..Viewpoint::default() }));
    }
    if !buttons.just_pressed(MouseButton::Left) || contexts.ctx_mut()?.egui_wants_pointer_input() {
        return Ok(());
    }
    let (Some(index), Ok(window), Some((eye, current))) = (streamed.index(), windows.single(), viewers.iter().next()) else {
        return Ok(());
    };
    let Some(here) = current.and_then(|current| current.0) else { return Ok(()) };
    let ray = window
        .cursor_position()
        .and_then(|at| cameras.iter().find_map(|(camera, transform)| camera.viewport_to_world(transform, at).ok()));
    let Some(ray) = ray else { return Ok(()) };
    let (from, _) = origin.plan_from_world(ray.origin);
    let (to, _) = origin.plan_from_world(ray.origin + *ray.direction);
    let hits = index.portals(here).filter(|portal| !portal.is_blind()).filter_map(|portal| {
        let (a, b) = (portal.ends.0.to_metres(), portal.ends.1.to_metres());
        let (way, along) = meet(from, to - from, a, b - a)?;
        let height_m = f64::from(ray.origin.y + ray.direction.y * way as f32) - eye.ground_m;
        // The cell lies to the left of the way from end to end if it is the portal's own.
        let out = if portal.cell == here { -(b - a).perp() } else { (b - a).perp() };
        let target = a.lerp(b, along.clamp(0.1, 0.9)) + out.normalize_or_zero() * BEYOND_M;
        (-0.5..HIGH_M + 0.5).contains(&height_m).then_some((way, target))
    });
    if let Some((_, target)) = hits.min_by(|a, b| a.0.total_cmp(&b.0)) {
        through.0 = Some((target, 0.0));
    }
    Ok(())
}

/// Where a ray meets a stretch: how far along the ray, and what share of the stretch.
fn meet(from: DVec2, way: DVec2, a: DVec2, edge: DVec2) -> Option<(f64, f64)> {
    let across = way.perp_dot(edge);
    if across.abs() < 1e-9 {
        return None;
    }
    let (t, u) = ((a - from).perp_dot(edge) / across, (a - from).perp_dot(way) / across);
    (t > 0.0 && (0.0..=1.0).contains(&u)).then_some((t, u))
}

/// Walks on through a wall that was clicked, until the visitor moves or is through.
pub(super) fn walk_through(
    time: Res<Time>,
    mut through: ResMut<WalkThrough>,
    mut intent: ResMut<Intent>,
    mut viewers: Query<(&mut Eye, &Gait), (With<Viewer>, With<Walker>)>,
) {
    let Some((target, for_s)) = through.0 else { return };
    let Some((mut eye, gait)) = viewers.iter_mut().next() else { return };
    if gait.is_examining() || gait.is_landing() {
        // Whoever goes round a point comes down to the street first.
        intent.toggle_examine |= gait.is_examining();
        return;
    }
    let way = target - eye.plan_pos;
    if intent.is_moving() || way.length() < 0.3 || for_s > PATIENCE_S {
        through.0 = None;
        return;
    }
    through.0 = Some((target, for_s + time.delta_secs_f64()));
    let heading = way.x.atan2(way.y).to_degrees();
    let turn = (heading - eye.heading_deg + 540.0).rem_euclid(360.0) - 180.0;
    eye.heading_deg += turn * (1.0 - (-6.0 * time.delta_secs_f64()).exp());
    if turn.abs() < 30.0 {
        intent.go.y = 1.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_meets_what_lies_before_it() {
        let (a, edge) = (DVec2::new(10.0, -5.0), DVec2::new(0.0, 10.0));
        assert_eq!(meet(DVec2::ZERO, DVec2::X, a, edge), Some((10.0, 0.5)));
        assert_eq!(meet(DVec2::ZERO, -DVec2::X, a, edge), None, "it lies behind");
        assert_eq!(meet(DVec2::new(0.0, 6.0), DVec2::X, a, edge), None, "beside");
        assert_eq!(meet(DVec2::ZERO, DVec2::Y, a, edge), None, "along");
    }
}
