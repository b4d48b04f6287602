//! Plugin: what moves in a city.

use bevy::prelude::*;

/// Lets a city move.
#[derive(Debug, Clone, Copy, Default)]
pub struct LifePlugin;

impl Plugin for LifePlugin {
    fn build(&self, app: &mut App) {
        veduta_ecs::ensure(app);
    }
}
