use bevy::prelude::*;
use veduta_city::Sound;
use veduta_ecs::{City, Cue};
use veduta_synth::{ChannelId, Levels, Order, voice};

use crate::asset::{CitySounds, RecordingAsset};
use crate::hearing::{Hearing, houses_between};
use crate::mix::{delay_s, heard_from};
use crate::output::{Output, SoundTrack};
use crate::settings::{Fader, SoundSettings};

/// Channels of what is heard once, by their highest bits.
pub(crate) const ONCE: u64 = 3 << 60;

/// Quieter ones are not heard at all, and take no channel.
const INAUDIBLE: f32 = 3e-4;
/// More cues in a frame than this are a mistake, or a stampede.
const MOST_A_FRAME: usize = 12;

/// Sounds what happens, from where it happens and as late as sound travels.
pub(crate) fn sound(
    mut cues: MessageReader<Cue>,
    settings: Res<SoundSettings>,
    (sounds, recordings): (Res<CitySounds>, Option<Res<Assets<RecordingAsset>>>),
    (city, track): (Option<Res<City>>, Option<Res<SoundTrack>>),
    hearing: Res<Hearing>,
    mut output: ResMut<Output>,
    mut count: Local<u64>,
    mut unknown: Local<std::collections::BTreeSet<String>>,
) {
    let Some(listener) = hearing.listener() else {
        cues.clear();
        return;
    };
    let rate_hz = output.rate_hz(track.as_deref());
    for cue in cues.read().take(MOST_A_FRAME) {
        let Some(told) = sounds.sounds().cue(&cue.sound) else {
            if unknown.insert(cue.sound.clone()) {
                warn!("nobody knows what `{}` sounds like: name it among the `cues` of the city's .sound.ron", cue.sound);
            }
            continue;
        };
        let level_db = told.level_db + f64::from(cue.gain_db);
        let houses = houses_between(city.as_deref(), listener, cue.plan_pos);
        let levels = heard_from(cue.plan_pos, told.radius_m, level_db, houses, listener);
        let levels = Levels { gain: levels.gain * settings.fader(Fader::of_cue(&cue.sound)), ..levels };
        if levels.gain.is_nan() || levels.gain < INAUDIBLE {
            continue;
        }
        *count += 1;
        let made = match &told.sound {
            Sound::File(path) => sounds.recording(path, recordings.as_deref()).map(|it| it.voice(rate_hz, false)),
            made => voice(made, seed(&cue.sound, *count), rate_hz),
        };
        let Some(voice) = made else { continue };
        let delay_s = delay_s(cue.plan_pos, listener);
        output.order(Order::Start { id: ChannelId(ONCE | *count), voice, levels, delay_s, is_once: true });
    }
    cues.clear();
}

/// A bell is the same bell at every stroke; no two steps or flights are alike.
fn seed(name: &str, count: u64) -> u64 {
    if Fader::of_cue(name) == Fader::Bells {
        name.bytes().fold(7, |seed, byte| seed.wrapping_mul(131).wrapping_add(byte.into()))
    } else {
        count
    }
}
