use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use veduta_city::GridPos;

/// The plan position that the engine's origin stands for. The one place where plan and world meet:
/// plan x east, y north, z up; world x east, y up, z south.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WorldOrigin {
    /// Plan position of the world's (0, 0, 0).
    pub plan: GridPos,
}

impl WorldOrigin {
    /// World position of a plan position (metres) and an elevation (metres).
    #[must_use]
    pub fn world_from_plan(&self, plan_pos: DVec2, z_m: f64) -> Vec3 {
        let p = plan_pos - self.plan_metres();
        DVec3::new(p.x, z_m, -p.y).as_vec3()
    }

    /// Plan position (metres) and elevation (metres) of a world position.
    #[must_use]
    pub fn plan_from_world(&self, world: Vec3) -> (DVec2, f64) {
        let w = world.as_dvec3();
        (self.plan_metres() + DVec2::new(w.x, -w.z), w.y)
    }

    /// World position of a point of the plan's grid at the city's zero.
    #[must_use]
    pub fn world_from_grid(&self, pos: GridPos) -> Vec3 {
        let p = pos.to_metres();
        self.world_from_plan(DVec2::new(p.x, p.y), 0.0)
    }

    /// Rotation of something that looks along a heading (degrees clockwise from north) and a pitch (degrees, up positive).
    #[must_use]
    pub fn rotation(heading_deg: f64, pitch_deg: f64) -> Quat {
        Quat::from_euler(EulerRot::YXZ, -heading_deg.to_radians() as f32, pitch_deg.to_radians() as f32, 0.0)
    }

    fn plan_metres(&self) -> DVec2 {
        let p = self.plan.to_metres();
        DVec2::new(p.x, p.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn north_is_minus_z_and_heading_90_looks_east() {
        let origin = WorldOrigin { plan: GridPos(1024, 2048) };
        let world = origin.world_from_plan(DVec2::new(1.0, 12.0), 3.0);
        assert!((world - Vec3::new(0.0, 3.0, -10.0)).length() < 1e-6, "{world}");
        let east = WorldOrigin::rotation(90.0, 0.0) * Vec3::NEG_Z;
        assert!((east - Vec3::X).length() < 1e-6, "{east}");
        let up = WorldOrigin::rotation(0.0, 90.0) * Vec3::NEG_Z;
        assert!((up - Vec3::Y).length() < 1e-6, "{up}");
    }

    #[test]
    fn far_from_the_anchor_the_eye_keeps_its_millimetres() {
        let origin = WorldOrigin { plan: GridPos::from_metres(bevy::math::DVec2::new(500_000.0, -500_000.0)) };
        let plan = DVec2::new(500_012.345, -499_990.001);
        let (back, z) = origin.plan_from_world(origin.world_from_plan(plan, 1.65));
        assert!((back - plan).length() < 1e-3 && (z - 1.65).abs() < 1e-6);
    }
}
