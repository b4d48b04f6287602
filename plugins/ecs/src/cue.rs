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
