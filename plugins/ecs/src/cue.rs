use bevy::math::DVec3;
use bevy::prelude::*;

/// Something that is heard once, from where it happens: a bell that is struck, pigeons that fly up. Whoever moves things writes it, whoever
/// makes sounds reads it.
#[derive(Message, Debug, Clone, PartialEq)]
pub struct Cue {
    /// Name of the sound, as files of sounds have it.
    pub sound: String,
    /// Plan metres, with the elevation.
    pub plan_pos: DVec3,
    /// Decibels above how the sound is described.
    pub gain_db: f32,
}

/// A recording that goes with a visit without coming from anywhere: what a tour tells, or music. Whoever leads writes it, whoever makes sounds
/// plays it, one of a [`Part`] at a time. Files are paths of the asset server, in Ogg Vorbis.
#[derive(Message, Debug, Clone, PartialEq, Eq)]
pub enum Accompany {
    /// It will be played soon: it may be read beforehand.
    Prepare(String),
    /// Plays it from its start, in place of what is played of that part.
    Play {
        /// The recording.
        file: String,
        /// What it is to the visit.
        part: Part,
    },
    /// Ends what is played of a part.
    End(Part),
    /// Stands still, silent.
    Hold,
    /// Goes on where it stood still.
    GoOn,
    /// Ends all, and forgets what was prepared.
    Stop,
}

/// What a recording is to a visit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Part {
    /// It tells something, once.
    Narration,
    /// It is heard beneath all else, over and over.
    Ambience,
}
