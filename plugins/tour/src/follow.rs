use bevy::ecs::system::SystemParam;
use bevy::math::DVec3;
use bevy::prelude::*;
use veduta_ecs::{Eye, Subject, WorldOrigin};
use veduta_route::{Follow, Pose};

use crate::{TourPlayer, TourState};

/// What moves about, for tours that follow it with the eye.
#[derive(SystemParam)]
pub(crate) struct Following<'w, 's> {
    subjects: Query<'w, 's, (&'static Subject, &'static GlobalTransform, Option<&'static InheritedVisibility>)>,
    origin: Res<'w, WorldOrigin>,
    follow: Local<'s, Follow>,
}

impl Following<'_, '_> {
    /// The pose with the view led to what the tour follows now; at once where the view has jumped in the dark.
    pub fn lead(&mut self, player: &TourPlayer, pose: Pose, eye: Option<&Eye>, is_cut: bool, seconds: f64) -> Pose {
        let is_on_tour = matches!(player.state(), TourState::Playing | TourState::Paused);
        let to = eye.filter(|_| is_on_tour).and_then(|eye| {
            let followed = player.tour()?.followed(player.time_s())?;
            let from = pose.plan_pos.extend(eye.ground_m + pose.eye_m);
            Some((self.nearest(followed.name, from)? - from, followed.share))
        });
        if is_cut { self.follow.leap(pose, to) } else { self.follow.lead(pose, to, seconds) }
    }

    /// Where the nearest of a name is that is not hidden: plan metres with the elevation.
    fn nearest(&self, name: &str, from: DVec3) -> Option<DVec3> {
        let of_name = self.subjects.iter().filter(|(subject, _, seen)| subject.0 == name && seen.is_none_or(|seen| seen.get()));
        let places = of_name.map(|(_, at, _)| {
            let (plan_pos, z_m) = self.origin.plan_from_world(at.translation());
            plan_pos.extend(z_m)
        });
        places.filter(|at| at.is_finite()).min_by(|a, b| a.distance_squared(from).total_cmp(&b.distance_squared(from)))
    }
}
