//! What can be done with the map: its controls.

use bevy::input::gamepad::GamepadButton as Pad;
use bevy::prelude::*;
use veduta_controls::{Always, ControlsAppExt, Input, Layers, Presses, control};
use veduta_ecs::Words;

use crate::MinimapSettings;
use crate::view::{MapView, zoomed};

control! {
    /// Opens the large map, and closes it.
    pub MapOpen: Always = "map.open", [Input::key(KeyCode::KeyM), Input::Pad(Pad::Select)];
    /// Turns the map north up, or heading up.
    pub MapNorth: Always = "map.north", [Input::key(KeyCode::KeyN)];
    /// Shows less of the map, larger.
    pub MapNearer: Always = "map.nearer", [Input::Letter('+'), Input::key(KeyCode::Equal), Input::key(KeyCode::NumpadAdd)];
    /// Shows more of the map, smaller.
    pub MapWider: Always = "map.wider", [Input::Letter('-'), Input::key(KeyCode::Minus), Input::key(KeyCode::NumpadSubtract)];
}

/// Adds the map's controls to the list, without anything that they do.
pub fn add_controls(app: &mut App) {
    Words::bring(app, &crate::WORDS);
    app.add_control::<MapOpen>().add_control::<MapNorth>().add_control::<MapNearer>().add_control::<MapWider>();
}

/// The large map among what is open.
pub(crate) const PAGE: &str = "map";

pub(crate) fn read_keys(
    presses: Presses<'_, '_>,
    mut layers: ResMut<Layers>,
    mut view: ResMut<MapView>,
    mut settings: ResMut<MinimapSettings>,
) {
    if presses.begins::<MapOpen>() {
        view.open = !view.open;
        (view.middle, view.marked) = (None, None);
        if view.radius_m == 0.0 {
            view.radius_m = 320.0;
        }
    }
    if layers.closes_page(PAGE, view.open) {
        view.open = false;
    }
    if presses.begins::<MapNorth>() {
        settings.north_up = !settings.north_up;
    }
    let factor = match (presses.begins::<MapNearer>(), presses.begins::<MapWider>()) {
        (true, false) => 0.8,
        (false, true) => 1.25,
        _ => return,
    };
    let radius = if view.open { &mut view.radius_m } else { &mut settings.radius_m };
    *radius = zoomed(*radius, factor);
}

#[cfg(test)]
mod tests {
    use bevy::input::ButtonState;
    use bevy::input::InputPlugin;
    use bevy::input::keyboard::{Key, KeyboardInput};

    use super::*;

    fn app() -> App {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, InputPlugin)).init_resource::<MapView>().init_resource::<MinimapSettings>();
        add_controls(&mut app);
        app.add_systems(Update, read_keys);
        app.finish();
        app.cleanup();
        app.update();
        app
    }

    fn press(app: &mut App, key_code: KeyCode, written: &str) {
        for state in [ButtonState::Pressed, ButtonState::Released] {
            let (logical_key, window) = (Key::Character(written.into()), Entity::PLACEHOLDER);
            app.world_mut().write_message(KeyboardInput { key_code, logical_key, state, text: None, repeat: false, window });
            app.update();
        }
    }

    #[test]
    fn plus_and_minus_zoom_wherever_they_lie() {
        let mut app = app();
        let radius_m = |app: &App| app.world().resource::<MinimapSettings>().radius_m;
        let first_m = radius_m(&app);
        // As on an American keyboard, on a German one, and by the block of numbers.
        for (key, written) in [(KeyCode::Equal, "="), (KeyCode::BracketRight, "+"), (KeyCode::NumpadAdd, "+")] {
            let before_m = radius_m(&app);
            press(&mut app, key, written);
            assert!((radius_m(&app) - before_m * 0.8).abs() < 1e-3, "{key:?}");
        }
        for (key, written) in [(KeyCode::Minus, "-"), (KeyCode::Slash, "-"), (KeyCode::NumpadSubtract, "-")] {
            press(&mut app, key, written);
        }
        assert!((radius_m(&app) - first_m).abs() < 1e-3);
    }

    #[test]
    fn the_map_opens_by_its_key_and_closes_by_escape() {
        let mut app = app();
        press(&mut app, KeyCode::KeyM, "m");
        assert_eq!(*app.world().resource::<MapView>(), MapView { open: true, radius_m: 320.0, ..MapView::default() });
        press(&mut app, KeyCode::Escape, "\u{1b}");
        assert!(!app.world().resource::<MapView>().open);
    }
}
