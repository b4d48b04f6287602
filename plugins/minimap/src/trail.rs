use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_ecs::{Eye, Viewer};

/// Where the visitor has been, plan metres: a line for each stretch between leaps.
#[derive(Resource, Debug, Clone, PartialEq, Default)]
pub struct Trail(
    /// The latest last.
    pub Vec<Vec<DVec2>>,
);

/// A trail has a point about every so many metres; who is farther away all at once has leapt.
const STEP_M: f64 = 3.0;
const LEAP_M: f64 = 25.0;
/// No more points are kept than these; the oldest go.
const MOST: usize = 6_000;

impl Trail {
    fn pass(&mut self, here: DVec2) {
        match self.0.last().and_then(|line| line.last()).map(|last| last.distance(here)) {
            Some(gone) if gone < STEP_M => return,
            Some(gone) if gone < LEAP_M => {}
            _ => self.0.push(Vec::new()),
        }
        if let Some(line) = self.0.last_mut() {
            line.push(here);
        }
        if self.0.iter().map(Vec::len).sum::<usize>() > MOST {
            let oldest = &mut self.0[0];
            oldest.drain(..oldest.len().min(MOST / 10));
            if oldest.is_empty() {
                self.0.remove(0);
            }
        }
    }
}

/// Notes where the visitor is.
pub(crate) fn note(viewers: Query<&Eye, With<Viewer>>, mut trail: ResMut<Trail>) {
    if let Some(eye) = viewers.iter().next().filter(|eye| eye.fade < 0.5) {
        trail.bypass_change_detection().pass(eye.plan_pos);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trail_has_a_point_every_few_metres_and_a_gap_at_a_leap() {
        let mut trail = Trail::default();
        (0..100).for_each(|n| trail.pass(DVec2::new(f64::from(n), 0.0)));
        assert_eq!((trail.0.len(), trail.0[0].len()), (1, 34));
        trail.pass(DVec2::new(900.0, 0.0));
        trail.pass(DVec2::new(904.0, 0.0));
        assert_eq!(trail.0.iter().map(Vec::len).collect::<Vec<_>>(), [34, 2]);
    }

    #[test]
    fn it_never_grows_beyond_its_bound() {
        let mut trail = Trail::default();
        for n in 0..40_000 {
            trail.pass(DVec2::new(f64::from(n) * 4.0, if n % 500 == 0 { 1e4 } else { 0.0 }));
            assert!(trail.0.iter().map(Vec::len).sum::<usize>() <= MOST);
        }
        assert!(trail.0.iter().all(|line| !line.is_empty()));
    }
}
