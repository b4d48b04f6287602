//! Recording the visitor's walk.

use bevy::prelude::*;
use veduta_ecs::{CityClock, Eye, Steering, Viewer};
use veduta_route::Recording;

use super::EditorCommand;
use crate::play::pose_of;

/// Records where the visitor goes and looks.
#[derive(Resource, Debug, Clone, Default)]
pub struct Recorder {
    recording: Option<Recording>,
    since_s: f64,
    now_s: f64,
}

impl Recorder {
    /// Whether it records.
    #[must_use]
    pub fn is_on(&self) -> bool {
        self.recording.is_some()
    }

    /// For how long it has recorded, seconds.
    #[must_use]
    pub fn elapsed_s(&self) -> f64 {
        (self.now_s - self.since_s).max(0.0)
    }

    /// How far the visitor has gone since, metres.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.recording.as_ref().map_or(0.0, Recording::length_m)
    }

    pub(super) fn begin(&mut self, now_s: f64) {
        *self = Self { recording: Some(Recording::default()), since_s: now_s, now_s };
    }

    pub(super) fn end(&mut self) -> Recording {
        self.recording.take().unwrap_or_default()
    }
}

pub(super) fn is_on(recorder: Res<Recorder>) -> bool {
    recorder.is_on()
}

/// Notes where the visitor is, as long as no tour has the eye. What is too long to record ends.
pub(super) fn note(
    time: Res<Time>,
    clock: Res<CityClock>,
    steering: Res<Steering>,
    viewers: Query<&Eye, With<Viewer>>,
    mut recorder: ResMut<Recorder>,
    mut commands: MessageWriter<EditorCommand>,
) {
    let recorder = &mut *recorder;
    let (Some(recording), Some(eye)) = (&mut recorder.recording, viewers.iter().next()) else { return };
    recorder.now_s = time.elapsed_secs_f64();
    if *steering != Steering::Guided {
        recording.note(recorder.now_s, &pose_of(eye, clock.hour));
    }
    if recording.duration_s() > veduta_route::LONGEST_RECORDING_S {
        commands.write(EditorCommand::Record);
    }
}
