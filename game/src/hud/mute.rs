use bevy::prelude::*;
use veduta::ecs::Words;

use super::notes::Notes;
use crate::settings::Settings;

/// U: no sound, and sound again; a note tells which, for who hears nothing does not know why.
pub(super) fn read_key(
    time: Res<Time<Real>>,
    keys: Res<ButtonInput<KeyCode>>,
    words: Res<Words>,
    mut settings: ResMut<Settings>,
    mut notes: ResMut<Notes>,
) {
    if keys.just_pressed(KeyCode::KeyU) {
        settings.muted = !settings.muted;
        let told = if settings.muted { "sound-off" } else { "sound-on" };
        notes.add(words.say(told), false, time.elapsed_secs_f64());
    }
}
