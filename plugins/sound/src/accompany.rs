use std::collections::BTreeMap;

use bevy::asset::AssetLoadFailedEvent;
use bevy::prelude::*;
use veduta_ecs::{Accompany, CityFailed, Part};
use veduta_synth::{ChannelId, Levels, Order};

use crate::asset::{RecordingAsset, reason};
use crate::output::{Output, SoundTrack};
use crate::settings::{Fader, SoundSettings};

/// Channels of recordings that go with a visit.
const PARTS: u64 = 4 << 60;

/// As loud as recordings of speech are, their peaks stay below what the desk would have to turn down.
const NARRATION_DB: f32 = -1.0;
const AMBIENCE_DB: f32 = -8.0;

/// What goes with the visit.
#[derive(Resource, Default)]
pub(crate) struct Accompaniment {
    prepared: BTreeMap<String, Handle<RecordingAsset>>,
    playing: BTreeMap<Part, Playing>,
    is_held: bool,
    count: u64,
}

struct Playing {
    file: String,
    id: ChannelId,
    has_begun: bool,
    levels: Levels,
}

/// How a part is heard: from the front.
fn levels(part: Part, settings: &SoundSettings) -> Levels {
    let db = match part {
        Part::Narration => NARRATION_DB,
        Part::Ambience => AMBIENCE_DB,
    };
    // A voice in the middle has half its power on each side.
    let gain = core::f32::consts::SQRT_2 * 10_f32.powf(db / 20.0) * settings.fader(Fader::Narration);
    Levels { gain, pan: 0.0, cutoff_hz: 20_000.0 }
}

/// Does as whoever leads says.
pub(crate) fn play(
    mut asked: MessageReader<Accompany>,
    mut failed: MessageReader<AssetLoadFailedEvent<RecordingAsset>>,
    (server, recordings): (Res<AssetServer>, Res<Assets<RecordingAsset>>),
    (settings, track): (Res<SoundSettings>, Option<Res<SoundTrack>>),
    mut now: ResMut<Accompaniment>,
    mut output: ResMut<Output>,
    mut told: MessageWriter<CityFailed>,
) {
    let (now, output) = (&mut *now, &mut *output);
    for wish in asked.read() {
        obey(now, wish, &server, output);
    }
    for failure in failed.read() {
        let Some(file) = now.prepared.iter().find(|(_, handle)| handle.id() == failure.id).map(|(file, _)| file.clone()) else {
            continue;
        };
        now.playing.retain(|_, playing| playing.file != file);
        let message = format!("{}; the tour goes on without it", reason(&failure.error));
        warn!("{message}");
        told.write(CityFailed { message, will_retry: false });
    }
    // Files are read, and told of, where nobody listens too.
    let is_heard = track.is_some() || output.listens();
    let rate_hz = output.rate_hz(track.as_deref());
    for (&part, playing) in &mut now.playing {
        let wanted = levels(part, &settings);
        if playing.has_begun {
            if playing.levels != wanted {
                playing.levels = wanted;
                output.order(Order::Set(playing.id, wanted));
            }
            continue;
        }
        let recording = now.prepared.get(&playing.file).and_then(|handle| recordings.get(handle));
        if let Some(recording) = recording.filter(|_| is_heard && !now.is_held) {
            let voice = recording.0.voice(rate_hz, part == Part::Ambience);
            let is_once = part == Part::Narration;
            output.order(Order::Start { id: playing.id, voice, levels: wanted, delay_s: 0.0, is_once });
            (playing.has_begun, playing.levels) = (true, wanted);
        }
    }
}

fn obey(now: &mut Accompaniment, wish: &Accompany, server: &AssetServer, output: &mut Output) {
    let load = |now: &mut Accompaniment, file: &String| {
        now.prepared.entry(file.clone()).or_insert_with(|| server.load(file.clone()));
    };
    match wish {
        Accompany::Prepare(file) => load(now, file),
        Accompany::Play { file, part } => {
            load(now, file);
            // Whoever asks for something while a tour stands wants to hear it.
            now.is_held = false;
            now.count += 1;
            let id = ChannelId(PARTS | now.count);
            let playing = Playing { file: file.clone(), id, has_begun: false, levels: Levels::SILENT };
            if let Some(before) = now.playing.insert(*part, playing) {
                output.order(Order::Stop(before.id));
            }
        }
        Accompany::End(part) => {
            if let Some(before) = now.playing.remove(part) {
                output.order(Order::Stop(before.id));
            }
        }
        Accompany::Hold | Accompany::GoOn => {
            now.is_held = *wish == Accompany::Hold;
            now.playing.values().for_each(|playing| output.order(Order::Hold(playing.id, now.is_held)));
        }
        Accompany::Stop => {
            now.playing.values().for_each(|playing| output.order(Order::Stop(playing.id)));
            *now = Accompaniment { count: now.count, ..Accompaniment::default() };
        }
    }
}
