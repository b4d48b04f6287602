//! Plugin: what is heard of a city.

use bevy::prelude::*;

/// Lets a city be heard.
#[derive(Debug, Clone, Copy, Default)]
pub struct SoundPlugin;

impl Plugin for SoundPlugin {
    fn build(&self, app: &mut App) {
        veduta_ecs::ensure(app);
    }
}
