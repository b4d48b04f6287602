//! What the guide can be asked for: its controls.

use bevy::prelude::*;
use veduta_controls::{Always, ControlsAppExt, Input, Layers, Presses, control};
use veduta_ecs::Words;

use crate::SearchBox;

control! {
    /// Opens the search box.
    pub SearchOpen: Always = "search.open", [Input::Letter('/'), Input::key(KeyCode::NumpadDivide)];
}

/// Adds the guide's controls to the list, without anything that they do.
pub fn add_controls(app: &mut App) {
    Words::bring(app, &crate::WORDS);
    app.add_control::<SearchOpen>();
}

pub(crate) fn read_keys(presses: Presses<'_, '_>, mut layers: ResMut<Layers>, mut search: ResMut<SearchBox>) {
    if !search.open && presses.begins::<SearchOpen>() {
        search.start();
    }
    if layers.closes_page("search", search.open) {
        search.open = false;
    }
}
