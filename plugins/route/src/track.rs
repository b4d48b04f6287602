//! A movement by key frames: piecewise cubics in time, whose slopes at the keys are harmonic means of those beside them (Fritsch and
//! Butland 1984). They never go beyond two keys between these, stand still between equal ones, and have no jump in speed.

use glam::{DVec3, DVec4};

use crate::{
    StepProblem,
    bounds::{COORDINATE, HEADING, HEIGHT, KEY_SECONDS, PITCH},
    error::MOST_KEYS,
    pose::{Facing, turn_deg},
};

/// Where the eye is and looks at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Key {
    /// Seconds from the begin.
    pub seconds: f64,
    /// Plan metres and metres above the ground.
    pub at: DVec3,
    pub facing: Facing,
}

/// Reads a step's keys, `start_s` after the first step's begin; says when the last one is.
pub(crate) fn read(keys: &[(f64, f64, f64, f64, f64, f64)], start_s: f64, into: &mut Vec<Key>) -> Result<f64, StepProblem> {
    if keys.is_empty() {
        return Err(StepProblem::NoKeys);
    }
    if keys.len() > MOST_KEYS {
        return Err(StepProblem::TooManyKeys(keys.len()));
    }
    let mut last = 0.0;
    for (i, &(seconds, x, y, height, heading, pitch)) in keys.iter().enumerate() {
        KEY_SECONDS.check(seconds)?;
        if seconds <= last {
            return Err(StepProblem::KeysOutOfOrder { key: i + 1, seconds });
        }
        last = seconds;
        COORDINATE.check(x)?;
        COORDINATE.check(y)?;
        HEIGHT.check(height)?;
        let heading = HEADING.check(heading)?;
        let facing = Facing { heading, pitch: PITCH.check(pitch)? };
        into.push(Key { seconds: start_s + seconds, at: DVec3::new(x, y, height), facing });
    }
    Ok(start_s + last)
}

/// A curve through keys.
#[derive(Debug, Clone)]
pub(crate) struct Track {
    /// Headings are counted on, so that each turn is the shorter way.
    keys: Vec<Key>,
    /// Slopes at the keys, a second: of the heading, and of position and pitch.
    slopes: Vec<(f64, DVec4)>,
}

impl Track {
    /// The curve through at least one key.
    pub fn new(keys: impl Iterator<Item = Key>) -> Self {
        let mut counted: Vec<Key> = Vec::new();
        for mut key in keys {
            if let Some(last) = counted.last() {
                key.facing.heading = last.facing.heading + turn_deg(last.facing.heading, key.facing.heading);
            }
            counted.push(key);
        }
        let slope = |a: &Key, b: &Key| {
            let seconds = b.seconds - a.seconds;
            ((b.facing.heading - a.facing.heading) / seconds, (rest(b) - rest(a)) / seconds, seconds)
        };
        let spans: Vec<(f64, DVec4, f64)> = counted.windows(2).map(|pair| slope(&pair[0], &pair[1])).collect();
        let mut slopes = vec![(0.0, DVec4::ZERO)];
        for pair in spans.windows(2) {
            let ((turn_a, move_a, a_s), (turn_b, move_b, b_s)) = (pair[0], pair[1]);
            let mean = |a: f64, b: f64| harmonic((a, a_s), (b, b_s));
            let moving =
                DVec4::new(mean(move_a.x, move_b.x), mean(move_a.y, move_b.y), mean(move_a.z, move_b.z), mean(move_a.w, move_b.w));
            slopes.push((mean(turn_a, turn_b), moving));
        }
        slopes.resize(counted.len(), (0.0, DVec4::ZERO));
        Self { keys: counted, slopes }
    }

    pub fn keys(&self) -> &[Key] {
        &self.keys
    }

    pub fn duration_s(&self) -> f64 {
        self.keys.last().map_or(0.0, |key| key.seconds)
    }

    /// Where the eye is; clamps.
    pub fn at(&self, t: f64) -> DVec3 {
        self.sample(t).1.truncate()
    }

    /// Where it looks; clamps.
    pub fn facing(&self, t: f64) -> Facing {
        let (heading, rest) = self.sample(t);
        Facing { heading, pitch: rest.w.clamp(-90.0, 90.0) }
    }

    fn sample(&self, t: f64) -> (f64, DVec4) {
        let after = self.keys.partition_point(|key| key.seconds <= t).clamp(1, self.keys.len().max(2) - 1);
        let (Some(a), Some(b)) = (self.keys.get(after - 1), self.keys.get(after)) else {
            return self.keys.first().map_or((0.0, DVec4::ZERO), |key| (key.facing.heading, rest(key)));
        };
        let seconds = b.seconds - a.seconds;
        let x = ((t - a.seconds) / seconds).clamp(0.0, 1.0);
        let (y, z) = (x * x, x * x * x);
        let (to_a, to_b) = (2.0 * z - 3.0 * y + 1.0, 3.0 * y - 2.0 * z);
        let (slope_a, slope_b) = ((z - 2.0 * y + x) * seconds, (z - y) * seconds);
        let ((turn_a, move_a), (turn_b, move_b)) = (self.slopes[after - 1], self.slopes[after]);
        let heading = a.facing.heading * to_a + b.facing.heading * to_b + turn_a * slope_a + turn_b * slope_b;
        (heading, rest(a) * to_a + rest(b) * to_b + move_a * slope_a + move_b * slope_b)
    }
}

/// All of a key that has no way round: position and pitch.
fn rest(key: &Key) -> DVec4 {
    key.at.extend(key.facing.pitch)
}

/// The slope between two spans, of slope and length each: none where they lead different ways.
fn harmonic((a, a_s): (f64, f64), (b, b_s): (f64, f64)) -> f64 {
    if a * b <= 0.0 {
        return 0.0;
    }
    let (of_a, of_b) = (a_s + 2.0 * b_s, 2.0 * a_s + b_s);
    (of_a + of_b) / (of_a / a + of_b / b)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(seconds: f64, x: f64, heading: f64) -> Key {
        Key { seconds, at: DVec3::new(x, 0.0, 2.0), facing: Facing { heading, pitch: 0.0 } }
    }

    #[test]
    fn a_track_passes_its_keys_and_stands_between_equal_ones() {
        let keys = [key(0.0, 0.0, 350.0), key(2.0, 4.0, 10.0), key(3.0, 4.0, 10.0), key(5.0, -1.0, 200.0)];
        let track = Track::new(keys.into_iter());
        for key in keys {
            assert!((track.at(key.seconds).x - key.at.x).abs() < 1e-9);
            assert!(turn_deg(track.facing(key.seconds).heading, key.facing.heading).abs() < 1e-9);
        }
        assert!((0..=10).all(|i| track.at(2.0 + f64::from(i) / 10.0).x == 4.0), "it stands");
        assert!((0..=20).all(|i| (350.0..=370.0).contains(&track.facing(f64::from(i) / 10.0).heading)), "the shorter way round");
        assert_eq!((track.at(-1.0).x, track.at(9.0).x), (0.0, -1.0));
    }

    #[test]
    fn it_sets_off_and_comes_to_rest_gently_and_never_jumps_in_speed() {
        let track = Track::new((0..9).map(|i| key(f64::from(i), f64::from(i * i % 7), 30.0 * f64::from(i))));
        let speed = |t: f64| (track.at(t + 1e-4).x - track.at(t).x) / 1e-4;
        assert!(speed(0.0).abs() < 0.01 && speed(8.0 - 1e-4).abs() < 0.01);
        for i in 0..800 {
            let t = f64::from(i) / 100.0;
            assert!((speed(t + 1e-3) - speed(t)).abs() < 0.2, "at {t}");
        }
    }
}
