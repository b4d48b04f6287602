//! Where the eye is and looks.

use glam::{DVec2, DVec3, swizzles::Vec3Swizzles};

/// The camera at a moment of a tour.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// Plan metres.
    pub plan_pos: DVec2,
    /// Eye height above the ground there, metres.
    pub eye_m: f64,
    /// Degrees clockwise from north, 0 to 360.
    pub heading_deg: f64,
    /// Degrees, up is positive, -90 to 90.
    pub pitch_deg: f64,
    /// Vertical field of view in degrees.
    pub fov_deg: f64,
    /// Hour of the day, 0 to 24.
    pub hour: f64,
    /// 0: clear, 1: dark.
    pub fade: f64,
}

impl Pose {
    pub(crate) fn is_finite(&self) -> bool {
        let numbers = [self.eye_m, self.heading_deg, self.pitch_deg, self.fov_deg, self.hour, self.fade];
        self.plan_pos.is_finite() && numbers.iter().all(|n| n.is_finite())
    }

    pub(crate) fn at(&self) -> DVec3 {
        self.plan_pos.extend(self.eye_m)
    }

    pub(crate) fn facing(&self) -> Facing {
        Facing { heading: self.heading_deg, pitch: self.pitch_deg }
    }
}

/// A direction of view in degrees; headings may go beyond a full turn.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Facing {
    pub heading: f64,
    pub pitch: f64,
}

impl Facing {
    /// Along a vector of plan east, north and up; straight up and down keep the heading of `now`, and no length keeps all.
    pub fn along(d: DVec3, now: Self) -> Self {
        let flat = d.xy().length();
        if flat < 0.05 {
            return if d.z.abs() < 0.05 { now } else { Self { pitch: 90.0 * d.z.signum(), ..now } };
        }
        Self { heading: libm::atan2(d.x, d.y).to_degrees(), pitch: libm::atan2(d.z, flat).to_degrees() }
    }
}

impl Facing {
    /// A share of the way to another direction, whose heading is counted on from this one's.
    pub fn towards(self, to: Self, share: f64) -> Self {
        let between = |a: f64, b: f64| a + (b - a) * share;
        Self { heading: between(self.heading, to.heading), pitch: between(self.pitch, to.pitch) }
    }
}

/// The turn from one heading to another the shorter way, degrees, over -180 to 180.
#[must_use]
pub fn turn_deg(from: f64, to: f64) -> f64 {
    180.0 - (180.0 - (to - from)).rem_euclid(360.0)
}

/// From 0 to 1 with no speed at either end.
pub(crate) fn smoothstep(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_take_the_shorter_way_and_half_turns_go_right() {
        for (from, to, turn) in
            [(10.0, 350.0, -20.0), (350.0, 10.0, 20.0), (0.0, 180.0, 180.0), (180.0, 0.0, 180.0), (725.0, 0.0, -5.0)]
        {
            assert_eq!(turn_deg(from, to), turn, "{from} to {to}");
        }
    }

    #[test]
    fn facing_is_clockwise_from_north() {
        let east = Facing::along(DVec3::new(2.0, 0.0, 2.0), Facing::default());
        assert_eq!((east.heading, east.pitch), (90.0, 45.0));
        let up = Facing::along(DVec3::new(0.0, 0.0, 2.0), east);
        assert_eq!((up.heading, up.pitch), (90.0, 90.0));
        assert_eq!(Facing::along(DVec3::ZERO, east), east);
    }
}
