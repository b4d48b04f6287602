use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::render::view::ColorGrading;
use veduta_city::Viewpoint;

use crate::{Footing, WorldOrigin};

/// A camera that sees the city: streaming loads what it needs, its [`Eye`] says where it is.
#[derive(Component, Reflect, Debug, Default, Clone, Copy)]
#[reflect(Component)]
#[require(Eye, Footing, Itinerary)]
pub struct Viewer;

/// Where a viewer stands and looks, in plan space. The one interface through which cameras are moved: the walker, tours,
/// films and tests write it; `EcsPlugin` turns it into `Transform` and field of view.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Component)]
pub struct Eye {
    /// Plan metres.
    pub plan_pos: DVec2,
    /// Elevation of the ground under the eye, metres: set by `EcsPlugin`, but for a viewer with [`Footing::Own`].
    pub ground_m: f64,
    /// Metres above the ground.
    pub eye_m: f64,
    /// Degrees clockwise from north.
    pub heading_deg: f64,
    /// Degrees, up is positive.
    pub pitch_deg: f64,
    /// Vertical field of view, degrees.
    pub fov_deg: f64,
    /// 0 clear … 1 dark.
    pub fade: f64,
}

impl Default for Eye {
    fn default() -> Self {
        Self {
            plan_pos: DVec2::ZERO,
            ground_m: 0.0,
            eye_m: Viewpoint::default_eye_m(),
            heading_deg: 0.0,
            pitch_deg: 0.0,
            fov_deg: 55.0,
            fade: 0.0,
        }
    }
}

impl Eye {
    /// An eye at a viewpoint, with the default field of view.
    #[must_use]
    pub fn at(view: Viewpoint) -> Self {
        Self {
            plan_pos: DVec2::new(view.pos.x, view.pos.y),
            eye_m: view.eye_m,
            heading_deg: view.heading_deg,
            pitch_deg: view.pitch_deg,
            ..Self::default()
        }
    }

    /// Elevation of the eye itself, metres.
    #[must_use]
    pub fn z_m(&self) -> f64 {
        self.ground_m + self.eye_m
    }
}

/// Where a viewer will be: what is seen from there can be loaded beforehand, also where no way leads through a portal. Kept by whoever
/// knows, as tours do.
#[derive(Component, Debug, Clone, PartialEq, Default)]
pub struct Itinerary(
    /// Soonest first. Who leads the viewer tells where he is about to be, and waits there for what has not come ([`Awaited`](crate::Awaited)).
    pub Vec<Stop>,
);

impl Itinerary {
    /// So many seconds ahead those tell who know. The first is where they wait for what has not come: so near that no cell lies between.
    pub const AHEAD_S: [f64; 5] = [0.5, 3.0, 7.0, 12.0, 20.0];
}

/// A place on an [`Itinerary`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Seconds from now.
    pub in_s: f64,
    /// Plan metres.
    pub plan_pos: DVec2,
    /// Metres above the ground.
    pub eye_m: f64,
}

/// Lifts a viewer's camera above its [`Eye`], to look down on where that is with north at the top. The eye goes on as before: what is
/// loaded is what it needs, and is to be seen from above.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Component)]
pub struct BirdsEye {
    /// Metres above the eye.
    pub height_m: f64,
}

impl BirdsEye {
    /// Degrees; steep enough that streets are seen between their houses.
    const PITCH_DEG: f64 = -65.0;

    /// Where the camera of an eye stands, plan metres and elevation.
    fn stand(self, eye: &Eye) -> (DVec2, f64) {
        let back_m = self.height_m / (-Self::PITCH_DEG).to_radians().tan();
        (eye.plan_pos - DVec2::new(0.0, back_m), eye.z_m() + self.height_m)
    }
}

/// Who moves the viewer's eye.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Steering {
    /// The visitor: keys, mouse, gamepad.
    #[default]
    Visitor,
    /// A tour or film: the visitor's controls rest, and touching them hands over.
    Guided,
    /// The guide, on the way to where the visitor asked to be led; touching the controls hands over too.
    Led,
}

/// Puts every eye on screen.
pub(crate) fn apply_eyes(
    origin: Res<WorldOrigin>,
    mut viewers: Query<(&Eye, Option<&BirdsEye>, &mut Transform, Option<&mut Projection>, Option<&mut ColorGrading>), With<Viewer>>,
) {
    for (eye, above, mut transform, projection, grading) in &mut viewers {
        let (plan_pos, z_m) = above.map_or((eye.plan_pos, eye.z_m()), |above| above.stand(eye));
        let (heading_deg, pitch_deg) = above.map_or((eye.heading_deg, eye.pitch_deg), |_| (0.0, BirdsEye::PITCH_DEG));
        let next = Transform::from_translation(origin.world_from_plan(plan_pos, z_m))
            .with_rotation(WorldOrigin::rotation(heading_deg, pitch_deg));
        transform.set_if_neq(next);
        let fov = (eye.fov_deg as f32).to_radians().clamp(0.05, 2.8);
        if let Some(mut projection) = projection
            && matches!(&*projection, Projection::Perspective(p) if (p.fov - fov).abs() > 1e-6)
            && let Projection::Perspective(p) = &mut *projection
        {
            p.fov = fov;
        }
        // A fade is exposure that closes: it darkens sky and city alike, on screen and in films.
        let stops = (1.0 - eye.fade.clamp(0.0, 1.0)).max(1e-4).log2() as f32;
        if let Some(mut grading) = grading
            && (grading.global.exposure - stops).abs() > 1e-4
        {
            grading.global.exposure = stops;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::EcsPlugin;

    #[test]
    fn an_eye_moves_its_camera() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, EcsPlugin));
        let eye = Eye { plan_pos: DVec2::new(3.0, 4.0), ground_m: 1.0, fov_deg: 40.0, ..Eye::default() };
        let viewer = app.world_mut().spawn((Viewer, Footing::Own, eye, Transform::default(), Projection::default())).id();
        app.update();
        let entity = app.world().entity(viewer);
        let at = entity.get::<Transform>().expect("spawned above").translation;
        assert!((at - Vec3::new(3.0, 2.65, -4.0)).length() < 1e-5, "{at}");
        let Some(Projection::Perspective(p)) = entity.get::<Projection>() else { panic!("spawned above") };
        assert!((p.fov - 40_f32.to_radians()).abs() < 1e-5);
    }

    #[test]
    fn a_birds_eye_looks_at_its_eye_from_above() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, EcsPlugin));
        let eye = Eye { plan_pos: DVec2::new(3.0, 4.0), ground_m: 1.0, heading_deg: 77.0, ..Eye::default() };
        let viewer = app.world_mut().spawn((Viewer, Footing::Own, eye, Transform::default(), BirdsEye { height_m: 200.0 })).id();
        app.update();
        let transform = *app.world().get::<Transform>(viewer).expect("spawned above");
        assert!((transform.translation.y - (1.0 + 1.65 + 200.0)).abs() < 1e-3, "{transform:?}");
        let to_eye = Vec3::new(3.0, 2.65, -4.0) - transform.translation;
        assert!(transform.forward().dot(to_eye.normalize()) > 0.99999, "{transform:?}");
        assert_eq!(*app.world().get::<Eye>(viewer).expect("spawned above"), eye, "the eye stays where it is");
        app.world_mut().entity_mut(viewer).remove::<BirdsEye>();
        app.update();
        let at = app.world().get::<Transform>(viewer).expect("spawned above").translation;
        assert!((at - Vec3::new(3.0, 2.65, -4.0)).length() < 1e-5, "{at}");
    }
}
