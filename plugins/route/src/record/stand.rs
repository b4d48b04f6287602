//! Who stands looks about, or waits.

use veduta_city::Step;

use super::{Sample, apart_deg, facing_of, heading, simplified, tenth};
use crate::pose::Facing;

/// Turns of the head are told to within so many degrees, and from so many on.
const TOLD_DEG: f64 = 8.0;
const LEAST_TURN_DEG: f64 = 4.0;
/// Waits from so long on are told, seconds.
const LEAST_WAIT_S: f64 = 0.3;

/// Adds the turns and waits of a stand; `facing` is where the tour looks before and after.
pub(super) fn tell(samples: &[Sample], facing: &mut Facing, steps: &mut Vec<Step>) {
    let off = |a: usize, b: usize, i: usize| {
        let (a, b, s) = (&samples[a], &samples[b], &samples[i]);
        let share = (s.t_s - a.t_s) / (b.t_s - a.t_s).max(1e-9);
        let between = |a: f64, b: f64| a + (b - a) * share;
        let on_the_line =
            Facing { heading: between(a.facing.heading, b.facing.heading), pitch: between(a.facing.pitch, b.facing.pitch) };
        // Whole turns count here.
        (on_the_line.heading - s.facing.heading).abs().max((on_the_line.pitch - s.facing.pitch).abs())
    };
    let mut waited_s = 0.0;
    let wait = |waited_s: &mut f64, steps: &mut Vec<Step>| {
        if *waited_s >= LEAST_WAIT_S {
            steps.push(Step::Wait { seconds: tenth(*waited_s) });
        }
        *waited_s = 0.0;
    };
    for pair in simplified(samples.len(), TOLD_DEG, off).windows(2) {
        let (a, b) = (&samples[pair[0]], &samples[pair[1]]);
        let seconds = b.t_s - a.t_s;
        if apart_deg(*facing, b.facing) < LEAST_TURN_DEG {
            waited_s += seconds;
            continue;
        }
        wait(&mut waited_s, steps);
        let at = heading(b.facing);
        *facing = facing_of(&at);
        steps.push(Step::Look { at, seconds: tenth(seconds.max(0.1)) });
    }
    wait(&mut waited_s, steps);
}
