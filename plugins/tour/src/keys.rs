use bevy::prelude::*;

use crate::{TourCommand, TourPlayer};

/// T, comma and full stop, brackets.
pub(crate) fn read_keys(keys: Res<ButtonInput<KeyCode>>, player: Res<TourPlayer>, mut commands: MessageWriter<TourCommand>) {
    if keys.just_pressed(KeyCode::KeyT) {
        commands.write(TourCommand::Toggle);
    }
    let skip = f64::from(keys.just_pressed(KeyCode::Period)) - f64::from(keys.just_pressed(KeyCode::Comma));
    if skip != 0.0 {
        commands.write(TourCommand::Seek(player.time_s() + 10.0 * skip));
    }
    let faster = f64::from(keys.just_pressed(KeyCode::BracketRight)) - f64::from(keys.just_pressed(KeyCode::BracketLeft));
    if faster != 0.0 {
        commands.write(TourCommand::Speed(player.speed() * 2_f64.powf(faster * 0.5)));
    }
}
