use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use bevy::math::DVec3;
use bevy::prelude::*;
use veduta_city::{Bed, Heard, Season, Sound, SoundSource};
use veduta_ecs::{Around, City, CityClock, Eye, Ground, StandingCells, Viewer, Weather};
use veduta_synth::{ChannelId, Levels, Order, voice};

use crate::asset::{CitySounds, RecordingAsset};
use crate::mix::{bed_gain, source_levels, towards};
use crate::output::{Output, SoundTrack};
use crate::settings::{Fader, SoundSettings};
use crate::surroundings::Surroundings;
use crate::{Listener, walls};

/// Seconds from one look about to the next.
const LOOK_EVERY_S: f64 = 0.3;
/// Seconds in which what is heard of a place comes two thirds of the way.
const SETTLE_S: f32 = 0.7;
/// Channels below this are closed, and opened again above twice of it.
const INAUDIBLE: f32 = 4e-4;
/// Farther houses do not come between ear and source.
const FARTHEST_WALLS_M: f64 = 700.0;
/// A fountain that the file of sounds describes is not heard twice, metres.
const SAME_M: f64 = 8.0;

/// A source in its place.
#[derive(Debug, Clone)]
struct Placed {
    plan_pos: DVec3,
    radius_m: f64,
    level_db: f64,
    when: Heard,
    sound: Sound,
    /// Houses between it and the ear, as last looked.
    houses: u32,
}

/// What sounds for ever, by its channel.
#[derive(Debug)]
struct Playing {
    levels: Levels,
    wanted: Levels,
    is_open: bool,
}

/// What the listener hears of the place.
#[derive(Resource, Default)]
pub(crate) struct Hearing {
    listener: Option<Listener>,
    sources: Vec<Placed>,
    beds: Vec<Bed>,
    looked_s: f64,
    playing: BTreeMap<ChannelId, Playing>,
}

impl Hearing {
    /// The listener, once there is one.
    pub fn listener(&self) -> Option<&Listener> {
        self.listener.as_ref()
    }
}

/// Channels of beds, and of sources, by their highest bits.
const BEDS: u64 = 1 << 60;
const SOURCES: u64 = 2 << 60;

/// Finds out where the listener is: at once what moves with the head, now and then what lies about.
pub(crate) fn listen(
    time: Res<Time>,
    viewers: Query<&Eye, With<Viewer>>,
    (clock, weather): (Res<CityClock>, Res<Weather>),
    (city, standing, ground): (Option<Res<City>>, Res<StandingCells>, Ground),
    sounds: Res<CitySounds>,
    mut hearing: ResMut<Hearing>,
) {
    let Some(eye) = viewers.iter().next() else {
        hearing.listener = None;
        return;
    };
    let hearing = &mut *hearing;
    let now_s = time.elapsed_secs_f64();
    let lat_deg = city.as_ref().map_or(50.0, |city| city.anchor.lat);
    let has_jumped = hearing.listener.as_ref().is_none_or(|before| before.plan_pos.truncate().distance(eye.plan_pos) > 20.0);
    let is_new = sounds.is_changed();
    let looks = is_new || has_jumped || now_s >= hearing.looked_s + LOOK_EVERY_S || now_s < hearing.looked_s;
    let surroundings = match &hearing.listener {
        Some(before) if !looks => before.surroundings.clone(),
        _ => Surroundings::of(eye.plan_pos, standing.iter().map(|(_, _, shell)| &**shell)),
    };
    let listener = Listener {
        plan_pos: eye.plan_pos.extend(eye.z_m()),
        eye_m: eye.eye_m,
        heading_deg: eye.heading_deg,
        hour: clock.hour,
        season: Season::at(lat_deg, clock.day),
        weather: *weather,
        surroundings,
    };
    if looks {
        hearing.looked_s = now_s;
        hearing.sources = place(&sounds, &listener, &ground);
        for source in &mut hearing.sources {
            source.houses = houses_between(city.as_deref(), &listener, source.plan_pos);
        }
    }
    if is_new {
        hearing.beds = sounds.sounds().all_beds();
        // What was heard of other sounds fades out.
        hearing.playing.values_mut().for_each(|playing| playing.wanted = Levels::SILENT);
    }
    hearing.listener = Some(listener);
}

/// How many houses stand between.
pub(crate) fn houses_between(city: Option<&City>, listener: &Listener, plan_pos: DVec3) -> u32 {
    let (from, to) = (listener.plan_pos, plan_pos);
    let Some(city) = city.filter(|_| from.distance(to) < FARTHEST_WALLS_M) else { return 0 };
    let around = Around { middle: from.midpoint(to).truncate(), radius_m: from.distance(to) / 2.0 };
    city.overviews.near(around).map(|part| walls::between(part, from, to)).sum::<u32>().min(walls::MOST)
}

/// All that sounds from a spot: what the file tells, and what stands about and sounds by its kind.
fn place(sounds: &CitySounds, listener: &Listener, ground: &Ground) -> Vec<Placed> {
    let placed = |source: &SoundSource, plan_pos: DVec3| Placed {
        plan_pos,
        radius_m: source.radius_m,
        level_db: source.level_db,
        when: source.when.clone(),
        sound: source.sound.clone(),
        houses: 0,
    };
    let told = sounds.sounds().sources.iter().filter(|source| {
        // Beyond what is ever heard of it.
        let distance_m = source.pos.distance(listener.plan_pos.truncate());
        distance_m < source.radius_m * 10_f64.powf((source.level_db + 60.0) / 20.0)
    });
    let mut all: Vec<Placed> =
        told.map(|source| placed(source, source.pos.extend(ground.at(source.pos, source.height_m) + source.height_m))).collect();
    for &(kind, at) in &listener.surroundings.objects {
        let Some(source) = SoundSource::of_object(kind) else { continue };
        if all.iter().all(|other| other.plan_pos.distance(at) > SAME_M) {
            all.push(placed(&source, at + DVec3::Z * source.height_m));
        }
    }
    all
}

/// The same number for the same place and sound, whatever else there is.
fn channel(of: u64, sound: &Sound, at: DVec3, side: u64) -> ChannelId {
    let mut hasher = DefaultHasher::new();
    format!("{sound:?}").hash(&mut hasher);
    ((at * 8.0).round().to_array().map(|x| x as i64), side).hash(&mut hasher);
    ChannelId(of | hasher.finish() >> 4)
}

/// Beds come from both sides: each side is a voice of its own.
const SIDES: [(u64, f32); 2] = [(0, -0.75), (1, 0.75)];

/// Opens, sets and closes the channels of what sounds for ever.
pub(crate) fn mix(
    time: Res<Time>,
    settings: Res<SoundSettings>,
    sounds: Res<CitySounds>,
    recordings: Option<Res<Assets<RecordingAsset>>>,
    track: Option<Res<SoundTrack>>,
    viewers: Query<&Eye, With<Viewer>>,
    mut hearing: ResMut<Hearing>,
    mut output: ResMut<Output>,
) {
    let hearing = &mut *hearing;
    let mut wanted: BTreeMap<ChannelId, (Levels, &Sound)> = BTreeMap::new();
    if let Some(listener) = &hearing.listener {
        // Where it is dark, because one is put elsewhere, it is also quiet.
        let clear = viewers.iter().next().map_or(1.0, |eye| 1.0 - 0.8 * eye.fade.clamp(0.0, 1.0) as f32);
        let fader = settings.fader(Fader::Ambience) * clear;
        for (n, bed) in hearing.beds.iter().enumerate() {
            let gain = bed_gain(bed, listener) * fader;
            for (side, pan) in SIDES {
                // Beds of one sound in several places are channels of their own.
                let id = channel(BEDS, &bed.sound, DVec3::new(n as f64, 0.0, 0.0), side);
                wanted.insert(id, (Levels { gain, pan, cutoff_hz: 20_000.0 }, &bed.sound));
            }
        }
        for source in &hearing.sources {
            let place = (source.plan_pos, source.radius_m, source.level_db);
            let levels = source_levels(place, &source.when, source.houses, listener);
            let id = channel(SOURCES, &source.sound, source.plan_pos, 0);
            wanted.insert(id, (Levels { gain: levels.gain * fader, ..levels }, &source.sound));
        }
    }
    for (id, playing) in &mut hearing.playing {
        playing.wanted = wanted.get(id).map_or(Levels { gain: 0.0, ..playing.wanted }, |wanted| wanted.0);
    }
    let rate_hz = output.rate_hz(track.as_deref());
    for (id, (levels, sound)) in wanted {
        if hearing.playing.contains_key(&id) || levels.gain < 2.0 * INAUDIBLE {
            continue;
        }
        let voice = match sound {
            Sound::File(path) => sounds.recording(path, recordings.as_deref()).map(|it| it.voice(rate_hz, true)),
            made => voice(made, id.0, rate_hz),
        };
        // Recordings that have not come are tried again in the next frame.
        let Some(voice) = voice else { continue };
        let silent = Levels { gain: 0.0, ..levels };
        output.order(Order::Start { id, voice, levels: silent, delay_s: 0.0, is_once: false });
        hearing.playing.insert(id, Playing { levels: silent, wanted: levels, is_open: true });
    }
    for (&id, playing) in &mut hearing.playing {
        let next = towards(playing.levels, playing.wanted, time.delta_secs(), SETTLE_S);
        if next != playing.levels {
            playing.levels = next;
            output.order(Order::Set(id, next));
        }
        playing.is_open = next.gain > INAUDIBLE || playing.wanted.gain > INAUDIBLE;
        if !playing.is_open {
            output.order(Order::Stop(id));
        }
    }
    hearing.playing.retain(|_, playing| playing.is_open);
}
