use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_city::Footfall;
use veduta_ecs::{City, Eye, Viewer};
use veduta_synth::{ChannelId, Levels, Order, voice};

use crate::asset::CitySounds;
use crate::cues::ONCE;
use crate::hearing::Hearing;
use crate::mix::factor;
use crate::output::{Output, SoundTrack};
use crate::settings::{Fader, SoundSettings};

/// Whoever's eye is higher flies, metres.
const HIGHEST_EYE_M: f64 = 3.2;
/// Faster ones are put somewhere else, metres a second.
const FASTEST_M_S: f64 = 12.0;
/// Slower ones shuffle without a sound, metres a second.
const SLOWEST_M_S: f64 = 0.25;

/// The walker's gait, as it is heard.
#[derive(Resource, Debug, Default, Clone, PartialEq)]
pub(crate) struct Stride {
    last: Option<DVec2>,
    /// Since the foot came down that came down last.
    gone_m: f64,
    /// Mean speed of late, metres a second.
    speed_m_s: f64,
    count: u64,
}

impl Stride {
    /// The eye is there after so many seconds; tells whether a foot comes down.
    fn walk_to(&mut self, plan_pos: DVec2, seconds: f64) -> bool {
        let Some(last) = self.last.replace(plan_pos).filter(|_| seconds > 0.0) else { return false };
        let moved_m = last.distance(plan_pos);
        let speed_m_s = moved_m / seconds;
        if speed_m_s > FASTEST_M_S {
            *self = Self { last: Some(plan_pos), count: self.count, ..Self::default() };
            return false;
        }
        self.speed_m_s += (speed_m_s - self.speed_m_s) * (1.0 - (-seconds / 0.15).exp());
        if self.speed_m_s < SLOWEST_M_S {
            // Whoever sets out puts a foot down soon.
            self.gone_m = length_m(0.0) / 2.0;
            return false;
        }
        self.gone_m += moved_m;
        let length_m = length_m(self.speed_m_s);
        if self.gone_m < length_m {
            return false;
        }
        self.gone_m = (self.gone_m - length_m).min(length_m);
        self.count += 1;
        true
    }
}

/// Length of a step at a speed: 0.72 m of a stroller, 1.4 m of a runner.
fn length_m(speed_m_s: f64) -> f64 {
    (0.5 + 0.17 * speed_m_s).min(1.45)
}

/// Lets the walker's steps be heard.
pub(crate) fn tread(
    time: Res<Time>,
    viewers: Query<&Eye, With<Viewer>>,
    settings: Res<SoundSettings>,
    (sounds, city, track): (Res<CitySounds>, Option<Res<City>>, Option<Res<SoundTrack>>),
    hearing: Res<Hearing>,
    mut stride: ResMut<Stride>,
    mut output: ResMut<Output>,
) {
    let Some(eye) = viewers.iter().next().filter(|eye| eye.eye_m < HIGHEST_EYE_M && eye.fade < 0.5) else {
        stride.last = None;
        return;
    };
    if !stride.walk_to(eye.plan_pos, time.delta_secs_f64()) || city.is_none() {
        return;
    }
    let Some(listener) = hearing.listener() else { return };
    // On bridges there is water below, and stone.
    let on = listener.surroundings.footfall.unwrap_or(Footfall::Flagstone);
    let Some(cue) = sounds.sounds().cue(on.cue()) else { return };
    let fader = settings.fader(Fader::Steps);
    if fader <= 0.0 {
        return;
    }
    let rate_hz = output.rate_hz(track.as_deref());
    let Some(voice) = voice(&cue.sound, stride.count, rate_hz) else { return };
    // Runners tread harder.
    let hard_db = (2.5 * (stride.speed_m_s - 1.4)).clamp(-2.0, 5.0);
    let levels = Levels {
        gain: factor(cue.level_db + hard_db) as f32 * fader,
        pan: if stride.count.is_multiple_of(2) { -0.15 } else { 0.15 },
        cutoff_hz: 12_000.0,
    };
    let id = ChannelId(ONCE | 1 << 59 | stride.count);
    output.order(Order::Start { id, voice, levels, delay_s: 0.0, is_once: true });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps of a minute at a speed and a frame rate.
    fn steps(speed_m_s: f64, fps: f64) -> usize {
        let mut stride = Stride::default();
        let frames = (60.0 * fps) as usize;
        (0..frames).filter(|&n| stride.walk_to(DVec2::new(n as f64 * speed_m_s / fps, 0.0), 1.0 / fps)).count()
    }

    #[test]
    fn steps_keep_the_pace_of_people_at_any_frame_rate() {
        for fps in [15.0, 60.0, 144.0] {
            let (stroll, walk, run) = (steps(1.0, fps), steps(1.9, fps), steps(6.0, fps));
            assert!(
                (80..100).contains(&stroll) && (125..150).contains(&walk) && (225..260).contains(&run),
                "{stroll} {walk} {run}"
            );
        }
    }

    #[test]
    fn who_stands_or_is_put_elsewhere_takes_no_step() {
        assert_eq!((steps(0.0, 60.0), steps(0.1, 60.0)), (0, 0));
        let mut stride = Stride::default();
        assert!(!stride.walk_to(DVec2::ZERO, 0.1) && !stride.walk_to(DVec2::new(500.0, 0.0), 0.1));
        assert!(!stride.walk_to(DVec2::new(500.0, 0.0), 0.0), "where no time passes nobody walks");
    }
}
