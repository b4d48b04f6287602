//! A walk along the streets from where somebody stands to a stand elsewhere.

use glam::{DVec2, swizzles::Vec3Swizzles};

use crate::{
    FreeLine, Pose, RouteError, StreetNet,
    compile::hour_on,
    pace::{Haste, Pace},
    path::{Mark, round_corners},
    pose::smoothstep,
    timeline::{Draft, Gaze, Run, SETTLE_S, Timeline},
    way,
};

/// A walk as poses over time: by the shortest way along streets and across squares, round corners, looking ahead, and in the end turned
/// to what is to be looked at.
///
/// ```
/// use veduta_city::{GridPos, Id, PlanStreet};
/// use veduta_route::{Pose, StreetNet, Walk};
///
/// let line = [(0.0, 0.0), (90.0, 0.0)].map(|p: (f64, f64)| GridPos::from_metres(p.into()));
/// let street = PlanStreet { id: Id(1), name: "Celetná".into(), line: line.into(), width: 6 * 1024, walkable: true, ..PlanStreet::default() };
/// let net = StreetNet::new(&[street]);
/// let here = Pose { plan_pos: (5.0, 0.0).into(), eye_m: 1.65, ..Pose::default() };
/// let there = Pose { plan_pos: (85.0, 0.0).into(), heading_deg: 180.0, ..here };
/// let walk = Walk::new(&net, here, there, 1.6, None)?;
/// assert!((walk.length_m() - 80.0).abs() < 0.1 && (45.0..60.0).contains(&walk.duration_s()));
/// assert!((walk.pose(walk.duration_s()).heading_deg - 180.0).abs() < 0.1);
/// # Ok::<(), veduta_route::RouteError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Walk {
    from: Pose,
    to: Pose,
    timeline: Timeline,
    end_s: f64,
    way: Vec<DVec2>,
}

/// From nearer than this nobody sets out, metres.
pub(crate) const HERE_M: f64 = 0.3;

impl Walk {
    /// The walk between two poses at a speed in metres a second; straight only where `free` says that nothing stands in the way.
    ///
    /// # Errors
    /// As [`StreetNet::way`]: if no street leads there, or an end is far from all.
    pub fn new(net: &StreetNet, from: Pose, to: Pose, speed: f64, free: Option<FreeLine<'_>>) -> Result<Self, RouteError> {
        if !(from.is_finite() && to.is_finite() && speed.is_finite()) {
            return Err(RouteError::NotFinite);
        }
        let mut draft = Draft::new(from.at(), from.facing(), &net.terrain);
        draft.stand(SETTLE_S);
        let mut way = vec![from.plan_pos];
        if from.at().distance(to.at()) > HERE_M {
            way = net.way_with(from.plan_pos, to.plan_pos, free)?;
            let marks: Vec<Mark> = way.iter().map(|p| Mark { at: p.extend(from.eye_m), leg: 0 }).collect();
            for path in round_corners(&marks, free) {
                let pace = Pace::new(&path, |_| speed.clamp(0.1, 10.0), Haste { up: 1.2, down: 1.2, side: 3.0 });
                let run = Run { path, pace, reach_m: 4.0, is_walk: true };
                draft.set_off(&run, Gaze::Ahead);
                draft.facing = run.facing(run.path.length(), draft.facing);
                draft.run(run);
            }
        } else {
            draft.here = to.at();
        }
        draft.turn(Gaze::Direction(to.facing()), 0.0);
        let end_s = draft.now_s;
        // The eye comes to rest a little later.
        let timeline = draft.finish(end_s);
        Ok(Self { from, to, end_s: timeline.end_s(), timeline, way })
    }

    /// How long it takes, seconds.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.end_s
    }

    /// The way along the ground.
    #[must_use]
    pub fn way(&self) -> &[DVec2] {
        &self.way
    }

    /// Length of the way, metres.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        way::length(&self.way)
    }

    /// The pose so many seconds into the walk; clamps.
    #[must_use]
    pub fn pose(&self, dt_s: f64) -> Pose {
        let dt = if dt_s > 0.0 { dt_s.min(self.end_s) } else { 0.0 };
        let share = if self.end_s > 0.0 { smoothstep(dt / self.end_s) } else { 1.0 };
        let (at, facing) = (self.timeline.at(dt), self.timeline.facing(dt));
        let between = |a: f64, b: f64| a + (b - a) * share;
        let (from, to) = (&self.from, &self.to);
        // What is left to the spot after a walk that was not worth taking.
        let left = to.plan_pos - self.timeline.at(self.end_s).xy();
        Pose {
            plan_pos: at.xy() + left * share,
            eye_m: between(from.eye_m, to.eye_m),
            heading_deg: facing.heading,
            pitch_deg: facing.pitch,
            fov_deg: between(from.fov_deg, to.fov_deg),
            hour: between(from.hour, hour_on(from.hour, to.hour)).rem_euclid(24.0),
            fade: between(from.fade, to.fade),
        }
    }

    /// Metres still to go at a position of the walk: from the nearest point of its way on.
    #[must_use]
    pub fn left_m(&self, plan_pos: DVec2) -> f64 {
        way::left_m(&self.way, plan_pos)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::grid_town;

    fn pose(x: f64, y: f64, heading_deg: f64) -> Pose {
        Pose { plan_pos: DVec2::new(x, y), eye_m: 1.65, heading_deg, ..Pose::default() }
    }

    #[test]
    fn a_walk_begins_and_ends_as_asked_and_never_jumps() {
        let net = StreetNet::new(&grid_town(4, 50.0));
        let (from, to) = (pose(0.0, 20.0, 300.0), pose(100.0, 130.0, 45.0));
        let walk = Walk::new(&net, from, to, 1.6, None).expect("the town is connected");
        assert!((walk.length_m() - 210.0).abs() < 1e-9);
        let end = walk.pose(walk.duration_s());
        assert!(end.plan_pos.distance(to.plan_pos) < 0.01 && (end.heading_deg - 45.0).abs() < 0.1, "{end:?}");
        let (mut last, mut left) = (walk.pose(0.0), walk.length_m());
        assert!(last.plan_pos.distance(from.plan_pos) < 0.01 && (last.heading_deg - 300.0).abs() < 0.1, "{last:?}");
        for frame in 1..=(walk.duration_s() * 60.0) as u32 {
            let pose = walk.pose(f64::from(frame) / 60.0);
            assert!(pose.plan_pos.distance(last.plan_pos) < 1.8 / 60.0, "frame {frame}");
            let still = walk.left_m(pose.plan_pos);
            assert!(still <= left + 0.5, "frame {frame}: {still} m left after {left} m");
            (last, left) = (pose, still);
        }
        assert!(left < 1.0, "{left}");
    }

    #[test]
    fn who_is_there_already_only_turns() {
        let net = StreetNet::new(&[]);
        let walk = Walk::new(&net, pose(1.0, 1.0, 0.0), pose(1.1, 1.0, 90.0), 1.6, None).expect("no street is needed");
        assert!(walk.duration_s() < 5.0 && (walk.pose(9.0).heading_deg - 90.0).abs() < 0.1);
        let nowhere = Walk::new(&net, pose(0.0, 0.0, 0.0), pose(500.0, 0.0, 0.0), 1.6, None);
        assert_eq!(nowhere.map(|w| w.duration_s()), Err(RouteError::NoStreets));
    }
}
