//! What is heard of a city: beds of a place, hour, season and weather, fountains and rivers, bells, the walker's steps, narration.
//!
//! ```text
//!  *.sound.ron ──asset──► CitySounds ─┐
//!  StandingCells ─► Surroundings ─────┤                     ┌─► bevy_audio (a stream of our own)
//!  Eye, CityClock, Weather ───────────┼─► mix ─► orders ─► Desk
//!  Cue, Accompany, the walker's way ──┘                     └─► SoundTrack (beside a film)
//! ```
//! All of it is one stream: the [`Desk`](veduta_synth::Desk) of `veduta-synth` mixes on the audio device's own thread, and is told
//! levels through a channel that nobody waits at.
//!
//! # Use
//! ```no_run
//! use bevy::prelude::*;
//! use veduta_ecs::Cue;
//! use veduta_sound::{OpenSounds, SoundPlugin, SoundSettings};
//!
//! App::new()
//!     .add_plugins((DefaultPlugins, SoundPlugin))
//!     .insert_resource(SoundSettings { steps: 0.0, ..default() })
//!     .add_systems(Startup, |mut sounds: MessageWriter<OpenSounds>, mut cues: MessageWriter<Cue>| {
//!         sounds.write(OpenSounds("old_prague.sound.ron".into()));
//!         cues.write(Cue { sound: "bell.tyn".into(), plan_pos: Vec3::new(80.0, 5.0, 50.0).as_dvec3(), gain_db: 0.0 });
//!     })
//!     .run();
//! ```
//! Without a file of sounds a city sounds as its plan tells: squares murmur, parks sing, fountains splash, rivers flow, and steps
//! follow the ground. It needs the engine's `AudioPlugin` (`DefaultPlugins` has it, with the feature `bevy_audio`), and says so
//! once where that is missing. Where there is no audio device all goes on in silence.
//!
//! # Limits
//! What is behind houses is told by straight lines over their ridges: nothing is heard around corners or by echoes.
//!
//! # Rejected
//! A sink of the engine for each sound: none can be dulled, placed or begun late, and nobody keeps their sum from clipping.
//! Occlusion by the visible sets: bells are heard from squares that do not see their towers.

mod accompany;
mod asset;
mod cues;
mod hearing;
mod mix;
mod output;
mod settings;
mod steps;
mod surroundings;
mod walls;

use bevy::audio::{AddAudioSource, AudioPlugin};
use bevy::prelude::*;
use veduta_ecs::VedutaSystems;

pub use asset::{CitySounds, OpenSounds, RecordingAsset, RecordingLoadError, SoundsAsset, SoundsLoadError};
pub use mix::{Listener, SPEED_OF_SOUND_M_S, bed_gain, delay_s, heard_from};
pub use output::SoundTrack;
pub use settings::SoundSettings;
pub use surroundings::Surroundings;

/// Lets a city be heard.
#[derive(Debug, Clone, Copy, Default)]
pub struct SoundPlugin;

/// The order of a frame of sound, within [`VedutaSystems::Show`].
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SoundSystems {
    /// Where the listener is, and what is there.
    Listen,
    /// What is heard of it.
    Mix,
    /// Orders go to the desk.
    Send,
}

impl Plugin for SoundPlugin {
    fn build(&self, app: &mut App) {
        veduta_ecs::ensure(app);
        app.init_resource::<SoundSettings>()
            .init_resource::<CitySounds>()
            .init_resource::<output::Output>()
            .init_resource::<hearing::Hearing>()
            .init_resource::<steps::Stride>()
            .init_resource::<accompany::Accompaniment>()
            .register_type::<SoundSettings>()
            .add_message::<OpenSounds>()
            .configure_sets(
                Update,
                (SoundSystems::Listen, SoundSystems::Mix, SoundSystems::Send).chain().in_set(VedutaSystems::Show),
            )
            .add_systems(Update, hearing::listen.run_if(output::is_heard).in_set(SoundSystems::Listen))
            .add_systems(
                Update,
                (hearing::mix, cues::sound, steps::tread).chain().run_if(output::is_heard).in_set(SoundSystems::Mix),
            )
            .add_systems(Update, (output::turn_up, output::send, output::look_for_device).chain().in_set(SoundSystems::Send));
    }

    fn finish(&self, app: &mut App) {
        // Whoever has assets can read files of sounds; who adds the engine's plugins after this one is served too.
        if app.world().contains_resource::<AssetServer>() {
            app.init_asset::<SoundsAsset>()
                .init_asset::<RecordingAsset>()
                .register_asset_loader(asset::SoundsLoader)
                .register_asset_loader(asset::RecordingLoader)
                .add_systems(Update, (asset::open, asset::take).chain().before(SoundSystems::Listen))
                .add_systems(Update, accompany::play.in_set(SoundSystems::Mix));
        }
        if app.is_plugin_added::<AudioPlugin>() {
            app.add_audio_source::<output::CityStream>();
            app.add_systems(Startup, output::connect);
        } else if !app.world().contains_resource::<SoundTrack>() {
            warn!(
                "the city is silent: add `AudioPlugin` of the engine's feature `bevy_audio` (`DefaultPlugins` has it), or a `SoundTrack`"
            );
        }
    }
}
