use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use bevy_rapier3d::prelude::{
    CharacterAutostep, CharacterLength, Collider, KinematicCharacterController, KinematicCharacterControllerOutput, RigidBody,
};
use veduta_city::GridPos;
use veduta_ecs::{Eye, Footing, Ground, Interface, OpenCells, Sights, Steering, Viewer, WorldOrigin};

use crate::glide::Glide;
use crate::orbit::{InCity, Orbit};
use crate::{Intent, Jump, SolidCells, WalkerSettings};

/// A viewer that the visitor's controls move.
#[derive(Component, Debug, Clone, Copy, Default)]
#[require(Viewer, Gait)]
pub struct Walker;

/// How the walker moves just now.
#[derive(Component, Debug, Clone, Copy, PartialEq, Default)]
pub struct Gait {
    /// Whether it flies.
    pub flying: bool,
    /// Velocity over ground: right-handed plan x, y and up; metres a second.
    pub velocity: DVec3,
    /// Field of view it turns to, vertical degrees; 0 before the first choice.
    fov_goal_deg: f64,
    /// Eye height above the ground to come back to after flying.
    eye_goal_m: f64,
    /// Going round a point.
    orbit: Option<Orbit>,
    /// On the way down to a street.
    glide: Option<Glide>,
}

impl Gait {
    /// Whether it goes round a point of the city.
    #[must_use]
    pub fn is_examining(&self) -> bool {
        self.orbit.is_some()
    }

    /// Whether it is on the way down to a street.
    #[must_use]
    pub fn is_landing(&self) -> bool {
        self.glide.is_some()
    }

    #[cfg(test)]
    pub(crate) fn examine_for_test(&mut self) {
        self.orbit = Some(Orbit::about_for_test());
    }

    /// Whether its feet are off the ground.
    fn is_carried(&self) -> bool {
        self.flying || self.orbit.is_some() || self.glide.is_some()
    }
}

/// The walker's body: a capsule, moved by rapier's character controller.
#[derive(Component, Debug, Clone, Copy, PartialEq, Eq)]
pub struct WalkerBody {
    /// The viewer whose body it is.
    pub of: Entity,
}

/// Height of the capsule, metres: a person's shoulders fit through a door.
const HEIGHT_M: f32 = 1.7;
/// Gap that the controller keeps to everything, metres.
const SKIN_M: f32 = 0.02;
/// Pavements lie so high above the terrain, and whoever is deeper than this under it has fallen through; metres.
const KERB_M: f64 = 0.13;
const FALLEN_M: f64 = 1.0;
/// Farther than this from its eye, a body is put there instead of walked: someone else has moved the eye.
const APART_M: f64 = 1.0;

/// Height of the capsule's middle over the ground.
fn middle_m() -> f32 {
    HEIGHT_M / 2.0 + SKIN_M
}

/// Gives every new walker a body.
pub(crate) fn give_bodies(
    mut commands: Commands,
    settings: Res<WalkerSettings>,
    origin: Res<WorldOrigin>,
    new: Query<(Entity, &Eye), Added<Walker>>,
) {
    for (viewer, eye) in &new {
        let half = HEIGHT_M / 2.0 - settings.radius_m;
        commands.spawn((
            WalkerBody { of: viewer },
            RigidBody::KinematicPositionBased,
            Collider::capsule_y(half, settings.radius_m),
            Transform::from_translation(origin.world_from_plan(eye.plan_pos, eye.ground_m) + Vec3::Y * middle_m()),
            KinematicCharacterController {
                offset: CharacterLength::Absolute(SKIN_M),
                autostep: Some(CharacterAutostep {
                    max_height: CharacterLength::Absolute(settings.step_m),
                    min_width: CharacterLength::Absolute(settings.radius_m * 0.5),
                    include_dynamic_bodies: false,
                }),
                snap_to_ground: Some(CharacterLength::Absolute(settings.step_m)),
                ..KinematicCharacterController::default()
            },
        ));
    }
}

/// Puts a body under its eye where something else has moved the eye: a tour, a jump, a flight.
pub(crate) fn take_over(
    origin: Res<WorldOrigin>,
    steering: Res<Steering>,
    jump: Res<Jump>,
    ground: Ground<'_>,
    mut walkers: Query<(&Eye, &Gait, &mut Footing), With<Walker>>,
    mut bodies: Query<(&WalkerBody, &mut Transform, &mut KinematicCharacterController)>,
) {
    for (body, mut transform, mut controller) in &mut bodies {
        let Ok((eye, gait, mut footing)) = walkers.get_mut(body.of) else { continue };
        let (at, z_m) = origin.plan_from_world(transform.translation);
        let ground_m = ground.at(eye.plan_pos, eye.ground_m);
        let has_fallen = z_m - f64::from(middle_m()) < ground_m - FALLEN_M;
        let carried = *steering != Steering::Visitor || gait.is_carried() || jump.is_under_way();
        // Round a point and on the way down elevations are exact: they do not rise and sink with the ground.
        let own = !carried || gait.orbit.is_some() || gait.glide.is_some();
        footing.set_if_neq(if own { Footing::Own } else { Footing::Terrain });
        if carried || has_fallen || at.distance(eye.plan_pos) > APART_M {
            let foot_m = eye.ground_m.max(ground_m + KERB_M);
            let place = origin.world_from_plan(eye.plan_pos, foot_m) + Vec3::Y * (middle_m() + 0.01);
            transform.set_if_neq(Transform::from_translation(place));
            controller.translation = None;
        }
    }
}

/// What the controller made of the last stride becomes the eye's place, unless it leads where nothing stands.
pub(crate) fn settle(
    time: Res<Time>,
    origin: Res<WorldOrigin>,
    steering: Res<Steering>,
    jump: Res<Jump>,
    solid: Res<SolidCells>,
    open: Res<OpenCells>,
    mut walkers: Query<(&mut Eye, &mut Gait), With<Walker>>,
    mut bodies: Query<(&WalkerBody, &mut Transform, Option<&KinematicCharacterControllerOutput>)>,
) {
    for (body, mut transform, output) in &mut bodies {
        let Ok((mut eye, mut gait)) = walkers.get_mut(body.of) else { continue };
        if *steering != Steering::Visitor || gait.is_carried() || jump.is_under_way() {
            continue;
        }
        let (at, z_m) = origin.plan_from_world(transform.translation);
        let foot_m = z_m - f64::from(middle_m());
        let was_inside = solid.hold(grid(eye.plan_pos));
        let from = solid.at(grid(eye.plan_pos));
        let leads_to = |to: DVec2| {
            let is_open = from.zip(solid.at(grid(to))).is_none_or(|(from, to)| open.lead(from, to));
            is_open && solid.hold(grid(to))
        };
        if was_inside && !leads_to(at) {
            // A shut portal, the city's edge, or a corner cut too fine: slide along one axis, else stay.
            let slid = [DVec2::new(at.x, eye.plan_pos.y), DVec2::new(eye.plan_pos.x, at.y)];
            let stay = slid.into_iter().find(|p| leads_to(*p)).unwrap_or(eye.plan_pos);
            transform.translation = origin.world_from_plan(stay, z_m);
            gait.velocity *= 0.5;
            eye.plan_pos = stay;
        } else {
            eye.plan_pos = at;
        }
        // Steps and kerbs are climbed in one stride by the body and smoothly by the eye.
        let follow = 1.0 - (-14.0 * time.delta_secs_f64()).exp();
        eye.ground_m += (foot_m - eye.ground_m) * follow;
        if output.is_some_and(|o| o.grounded) {
            gait.velocity.z = 0.0;
        }
    }
}

fn grid(plan_pos: DVec2) -> GridPos {
    GridPos(GridPos::steps(plan_pos.x), GridPos::steps(plan_pos.y))
}

/// Turns the head and takes the next stride.
pub(crate) fn stride(
    time: Res<Time>,
    settings: Res<WalkerSettings>,
    steering: Res<Steering>,
    jump: Res<Jump>,
    intent: Res<Intent>,
    (solid, interface): (Res<SolidCells>, Res<Interface>),
    (ground, sights): (Ground<'_>, Sights<'_>),
    mut walkers: Query<(Entity, &mut Eye, &mut Gait), With<Walker>>,
    mut bodies: Query<(&WalkerBody, &mut KinematicCharacterController)>,
) {
    // Where frames are slow, strides are long: walls stop them all the same.
    let dt = time.delta_secs_f64().min(0.25);
    for (viewer, mut eye, mut gait) in &mut walkers {
        if *steering != Steering::Visitor {
            gait.velocity = DVec3::ZERO;
            gait.flying = eye.eye_m > settings.eye_m.1 + 0.5;
            (gait.orbit, gait.glide) = (None, None);
            continue;
        }
        if matches!(*jump, Jump::Waiting { .. }) {
            (gait.orbit, gait.glide) = (None, None);
        }
        choose_view(&mut eye, &mut gait, &intent, &settings, dt);
        let city = InCity { sights: &sights, ground: &ground };
        change_gait(&mut eye, &mut gait, &intent, &solid, &city, interface.reduced_motion);
        if let Some(mut orbit) = gait.orbit {
            orbit.turn(&intent, &city);
            let (at, heading_deg, pitch_deg) = orbit.glide(dt, interface.reduced_motion, &city);
            (eye.heading_deg, eye.pitch_deg) = (heading_deg, pitch_deg);
            hang(&mut eye, at, &ground);
            gait.orbit = Some(orbit);
            continue;
        }
        if let Some(mut glide) = gait.glide {
            let (at, pitch_deg, has_arrived) = glide.pass(dt);
            eye.pitch_deg = pitch_deg;
            hang(&mut eye, at, &ground);
            gait.glide = Some(glide).filter(|_| !has_arrived);
            continue;
        }
        turn_head(&mut eye, &mut gait, &intent, &settings, dt);
        if jump.is_under_way() {
            gait.velocity = DVec3::ZERO;
            continue;
        }
        let pace = if gait.flying {
            settings.fly_m_s * if intent.run { 4.0 } else { 1.0 }
        } else if intent.run {
            settings.run_m_s
        } else {
            settings.walk_m_s
        };
        let heading = eye.heading_deg.to_radians();
        let (ahead, right) = (DVec2::new(heading.sin(), heading.cos()), DVec2::new(heading.cos(), -heading.sin()));
        let wish = (ahead * intent.go.y + right * intent.go.x).clamp_length_max(1.0) * pace;
        let ease = 1.0 - (-9.0 * dt).exp();
        let planar = gait.velocity.truncate();
        let planar = planar + (wish - planar) * ease;
        gait.velocity = planar.extend(gait.velocity.z);
        if gait.flying {
            let rise = (intent.go.z + intent.go.y * eye.pitch_deg.to_radians().sin()) * pace;
            gait.velocity.z += (rise - gait.velocity.z) * ease;
            let step = gait.velocity * dt;
            // A flight goes straight on over hills and valleys.
            let (was_m, eye_m, near_m) = (ground.about(eye.plan_pos, eye.ground_m, eye.eye_m), eye.eye_m, eye.ground_m);
            eye.plan_pos += step.truncate();
            eye.eye_m = (eye.eye_m + step.z + was_m - ground.about(eye.plan_pos, near_m, eye_m)).max(1.0);
            continue;
        }
        // Without a floor there is no falling: the cell has not arrived.
        let falls = solid.hold(grid(eye.plan_pos));
        gait.velocity.z = if falls { (gait.velocity.z - 9.81 * dt).max(-20.0) } else { 0.0 };
        let step = gait.velocity * dt;
        for (_, mut controller) in bodies.iter_mut().filter(|(body, _)| body.of == viewer) {
            controller.translation = Some(Vec3::new(step.x as f32, step.z as f32, -step.y as f32));
        }
    }
}

/// Puts an eye at an elevation, whatever the ground does.
fn hang(eye: &mut Eye, at: DVec3, ground: &Ground<'_>) {
    eye.plan_pos = at.truncate();
    eye.ground_m = ground.at(eye.plan_pos, at.z - 1.65);
    eye.eye_m = at.z - eye.ground_m;
}

/// The field of view turns to what was chosen.
fn choose_view(eye: &mut Eye, gait: &mut Gait, intent: &Intent, settings: &WalkerSettings, dt: f64) {
    if let Some(fov) = intent.fov.and_then(|i| settings.fovs_deg.get(i)) {
        gait.fov_goal_deg = *fov;
    }
    if intent.widen != 0.0 {
        let from = if gait.fov_goal_deg > 0.0 { gait.fov_goal_deg } else { eye.fov_deg };
        let [least, .., most] = settings.fovs_deg;
        gait.fov_goal_deg = (from * intent.widen.exp()).clamp(least.min(most), most.max(least));
    }
    if gait.fov_goal_deg > 0.0 {
        eye.fov_deg += (gait.fov_goal_deg - eye.fov_deg) * (1.0 - (-8.0 * dt).exp());
    }
}

/// Walks, flies, or goes round a point, as was asked for.
fn change_gait(eye: &mut Eye, gait: &mut Gait, intent: &Intent, solid: &SolidCells, city: &InCity<'_, '_>, at_once: bool) {
    let was_examining = gait.orbit.is_some();
    if intent.toggle_fly {
        gait.velocity = DVec3::ZERO;
        // From a point that was examined one flies on.
        gait.flying = was_examining || !gait.flying;
        let has_hung = was_examining || gait.glide.is_some();
        (gait.orbit, gait.glide) = (None, None);
        if gait.flying && has_hung {
            steady(eye, city.ground);
        }
    } else if intent.toggle_examine && was_examining {
        (gait.orbit, gait.flying) = (None, false);
    } else if intent.toggle_examine {
        gait.glide = None;
        gait.orbit = Orbit::begin(eye, city);
        gait.flying &= gait.orbit.is_none();
        gait.velocity = DVec3::ZERO;
        return;
    } else {
        return;
    }
    if !gait.flying {
        gait.glide = land(eye, gait, solid, city, at_once);
    }
}

/// The way down to walkable ground: right here, or in the nearest street for whoever is above a roof or a yard. `None` where he stands already.
fn land(eye: &Eye, gait: &Gait, solid: &SolidCells, city: &InCity<'_, '_>, at_once: bool) -> Option<Glide> {
    let here = grid(eye.plan_pos);
    let to = if solid.hold(here) { eye.plan_pos } else { solid.nearest(here).map_or(eye.plan_pos, GridPos::to_metres) };
    let foot_m = city.ground.at(to, if to == eye.plan_pos { eye.ground_m } else { f64::INFINITY });
    let z_m = foot_m + if gait.eye_goal_m > 0.0 { gait.eye_goal_m } else { Eye::default().eye_m };
    let from = eye.plan_pos.extend(eye.z_m());
    (from.distance(to.extend(z_m)) > 0.05).then(|| Glide::new(from, eye.pitch_deg, to, z_m, at_once))
}

/// Takes the ground that a flight rises and sinks with under an eye that has hung at an exact elevation.
fn steady(eye: &mut Eye, ground: &Ground<'_>) {
    let z_m = eye.z_m();
    for _ in 0..2 {
        eye.ground_m = ground.about(eye.plan_pos, eye.ground_m, eye.eye_m);
        eye.eye_m = z_m - eye.ground_m;
    }
}

/// Heading, pitch, eye height.
fn turn_head(eye: &mut Eye, gait: &mut Gait, intent: &Intent, settings: &WalkerSettings, dt: f64) {
    eye.heading_deg = (eye.heading_deg + intent.turn_deg).rem_euclid(360.0);
    eye.pitch_deg = (eye.pitch_deg + intent.tilt_deg).clamp(-85.0, 85.0);
    let (low, high) = settings.eye_m;
    if gait.eye_goal_m == 0.0 {
        gait.eye_goal_m = eye.eye_m.clamp(low, high);
    }
    if !gait.flying {
        gait.eye_goal_m = (gait.eye_goal_m + intent.raise_m).clamp(low, high);
        eye.eye_m += (gait.eye_goal_m - eye.eye_m) * (1.0 - (-6.0 * dt).exp());
    }
}
