use bevy::math::{DVec2, DVec3};

/// The way down to a street: the eye glides over what lies between, and stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Glide {
    from: DVec3,
    from_pitch_deg: f64,
    to: DVec3,
    gone_s: f64,
    whole_s: f64,
}

/// Shortest and longest, seconds; metres a second between.
const TAKES_S: (f64, f64) = (0.35, 1.8);
const PACE_M_S: f64 = 22.0;
/// The way over is done in the first part of the time, the way down in the last: a share of it each.
const PART: f64 = 0.65;
/// Whoever stands looks along the street, and no steeper than this, degrees.
const LEVEL_DEG: f64 = 12.0;

/// From 0 to 1 without a jerk at either end.
fn smooth(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

impl Glide {
    /// From an eye to a spot and the elevation of an eye there. At once, where nothing is to glide.
    pub fn new(from: DVec3, from_pitch_deg: f64, to: DVec2, to_z_m: f64, at_once: bool) -> Self {
        let to = to.extend(to_z_m);
        let whole_s = if at_once { 0.0 } else { (from.distance(to) / PACE_M_S).clamp(TAKES_S.0, TAKES_S.1) };
        Self { from, from_pitch_deg, to, gone_s: 0.0, whole_s }
    }

    /// Where the eye is after so many seconds more, its pitch, and whether it has arrived.
    pub fn pass(&mut self, seconds: f64) -> (DVec3, f64, bool) {
        self.gone_s += seconds;
        let t = if self.whole_s > 0.0 { self.gone_s / self.whole_s } else { 1.0 };
        let (over, down) = (smooth(t / PART), smooth((t - (1.0 - PART)) / PART));
        let at = self.from.truncate().lerp(self.to.truncate(), over).extend(self.from.z + (self.to.z - self.from.z) * down);
        let at = if t >= 1.0 { self.to } else { at };
        let level_deg = self.from_pitch_deg.clamp(-LEVEL_DEG, LEVEL_DEG);
        (at, self.from_pitch_deg + (level_deg - self.from_pitch_deg) * smooth(t), t >= 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_over_before_it_goes_down_and_never_leaps() {
        let from = DVec3::new(0.0, 0.0, 40.0);
        let mut glide = Glide::new(from, -60.0, DVec2::new(12.0, 0.0), 1.65, false);
        let (mut before, mut frames) = (from, 0);
        loop {
            let (at, pitch_deg, has_arrived) = glide.pass(1.0 / 60.0);
            assert!(at.distance(before) < 2.5, "{at} after {before}");
            assert!(at.x > 5.0 || at.z > 35.0, "it goes down only beside the roof: {at}");
            before = at;
            frames += 1;
            if has_arrived {
                assert_eq!((at, pitch_deg), (DVec3::new(12.0, 0.0, 1.65), -LEVEL_DEG));
                break;
            }
        }
        assert!((80..140).contains(&frames), "{frames}");
    }

    #[test]
    fn without_motion_it_is_there_at_once() {
        let mut glide = Glide::new(DVec3::new(0.0, 0.0, 40.0), 3.0, DVec2::X, 1.65, true);
        assert_eq!(glide.pass(0.016), (DVec3::new(1.0, 0.0, 1.65), 3.0, true));
    }
}
