use bevy::input::gamepad::GamepadButton as Pad;
use bevy::prelude::*;
use veduta::controls::{Always, ControlsAppExt, Input, Layers, ModKeys, Presses, control};
use veduta::ecs::Words;
use veduta::prelude::*;
use veduta::tour::EditorCommand;

use super::Open;
use super::notes::Notes;
use crate::settings::Settings;

control! {
    /// Opens the page of all controls, and closes it.
    pub(crate) HelpOpen: Always = "help.open", [Input::key(KeyCode::F1), Input::Pad(Pad::DPadDown)];
    /// Opens the settings, and closes them.
    pub(crate) SettingsOpen: Always = "settings.open", [Input::key(KeyCode::F3), Input::Pad(Pad::Start)];
    /// Shows how the city streams.
    pub(crate) ExpertOpen: Always = "expert.open", [Input::key(KeyCode::F2)];
    /// Takes a still.
    pub(crate) TakeStill: Always = "still.take", [Input::key(KeyCode::F12)];
    /// Turns the city's clock back.
    pub(crate) HourEarlier: Always = "hour.earlier", [Input::key(KeyCode::KeyH)];
    /// Turns it on.
    pub(crate) HourLater: Always = "hour.later", [Input::key(KeyCode::KeyJ)];
    /// Goes on to the next season.
    pub(crate) SeasonNext: Always = "season.next", [Input::key(KeyCode::KeyK)];
    /// Silences the city, and lets it be heard again.
    pub(crate) Mute: Always = "sound.mute", [Input::key(KeyCode::KeyU)];
    /// Ends the program.
    pub(crate) Quit: Always = "quit", [Input::ctrl(KeyCode::KeyQ), Input::Key(KeyCode::KeyQ, ModKeys::SUPER)];
}

/// Adds the program's own controls to the list.
pub(super) fn add_controls(app: &mut App) {
    app.add_control::<HelpOpen>()
        .add_control::<SettingsOpen>()
        .add_control::<ExpertOpen>()
        .add_control::<TakeStill>()
        .add_control::<HourEarlier>()
        .add_control::<HourLater>()
        .add_control::<SeasonNext>()
        .add_control::<Mute>()
        .add_control::<Quit>();
}

/// A quarter of a year, days.
const DAYS_A_SEASON: u16 = 92;
/// Hours of the city that go by in a second while its clock is turned.
const HOURS_A_SECOND: f64 = 1.5;

/// Help, settings, the end, and the hour and season of the city.
pub(super) fn read_keys(
    time: Res<Time>,
    presses: Presses<'_, '_>,
    mut layers: ResMut<Layers>,
    mut open: ResMut<Open>,
    mut clock: ResMut<CityClock>,
    mut editor: MessageWriter<EditorCommand>,
) {
    if presses.begins::<Quit>() {
        info!("visit: leaves");
        // Which asks about what is not saved.
        editor.write(EditorCommand::Leave);
    }
    let mut next = *open;
    next.help ^= presses.begins::<HelpOpen>();
    next.settings ^= presses.begins::<SettingsOpen>();
    next.help &= !layers.closes_page("help", next.help);
    next.settings &= !layers.closes_page("settings", next.settings);
    open.set_if_neq(next);
    let turn = presses.axis::<HourEarlier, HourLater>();
    if turn != 0.0 {
        clock.hour = (clock.hour + turn * time.delta_secs_f64() * HOURS_A_SECOND).rem_euclid(24.0);
    }
    if presses.begins::<SeasonNext>() {
        clock.day = (clock.day + DAYS_A_SEASON - 1) % 366 + 1;
    }
}

/// No sound, and sound again; a note tells which, for who hears nothing does not know why.
pub(super) fn mute(
    time: Res<Time<Real>>,
    presses: Presses<'_, '_>,
    words: Res<Words>,
    mut settings: ResMut<Settings>,
    mut notes: ResMut<Notes>,
) {
    if presses.begins::<Mute>() {
        settings.muted = !settings.muted;
        let told = if settings.muted { "sound-off" } else { "sound-on" };
        notes.add(words.say(told), false, time.elapsed_secs_f64());
    }
}

/// All controls of the game, for tests.
#[cfg(test)]
pub(super) fn app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, bevy::input::InputPlugin));
    veduta::walker::add_controls(&mut app);
    veduta::tour::add_controls(&mut app);
    veduta::minimap::add_controls(&mut app);
    veduta::guide::add_controls(&mut app);
    add_controls(&mut app);
    veduta::ecs::Words::bring(&mut app, &super::WORDS);
    app
}

#[cfg(test)]
mod tests {
    use veduta::controls::{ControlList, Controls, message_of};

    use super::*;

    #[test]
    fn no_input_does_two_things_at_first() {
        let app = app();
        let list = app.world().resource::<ControlList>();
        assert!(list.iter().count() > 40, "{}", list.iter().count());
        assert_eq!(Controls::default().conflicts(list), []);
    }

    #[test]
    fn every_control_and_scope_is_told_in_every_language() {
        let app = app();
        let (list, words) = (app.world().resource::<ControlList>(), app.world().resource::<Words>());
        let scopes = list.scopes().map(|scope| format!("scope-{scope}"));
        let messages: Vec<String> = list.iter().map(|control| message_of(control.name)).chain(scopes).collect();
        for language in ["en", "cs", "it"] {
            let lacking: Vec<&String> = messages.iter().filter(|message| !words.has(language, message)).collect();
            assert_eq!(lacking, Vec::<&String>::new(), "{language}");
        }
    }

    #[test]
    fn what_a_visitor_needs_is_on_a_gamepad_too() {
        let app = app();
        let list = app.world().resource::<ControlList>();
        for name in [
            "walk.forward",
            "walk.back",
            "walk.left",
            "walk.right",
            "walk.run",
            "walk.fly",
            "walk.examine",
            "look.left",
            "look.right",
            "look.up",
            "look.down",
            "view.next",
            "eye.lower",
            "eye.higher",
            "fly.rise",
            "fly.sink",
            "examine.nearer",
            "examine.farther",
            "tour.pause",
            "tour.next",
            "tour.back",
            "tour.ahead",
            "map.open",
            "help.open",
            "settings.open",
            "window.close",
        ] {
            let control = list.get(name).unwrap_or_else(|| panic!("{name} is on the list"));
            assert!(control.defaults.iter().any(|input| input.device() == veduta::controls::Device::Pad), "{name}");
        }
    }

    #[test]
    fn escape_closes_one_window_at_a_time_and_hours_turn() {
        let mut app = app();
        app.init_resource::<Open>().init_resource::<CityClock>().add_message::<EditorCommand>().add_systems(Update, read_keys);
        app.finish();
        app.update();
        let press = |app: &mut App, key: KeyCode| {
            app.world_mut().resource_mut::<ButtonInput<KeyCode>>().press(key);
            app.update();
            app.world_mut().resource_mut::<ButtonInput<KeyCode>>().release(key);
            app.update();
            *app.world().resource::<Open>()
        };
        assert_eq!(press(&mut app, KeyCode::F1), Open { help: true, settings: false });
        assert_eq!(press(&mut app, KeyCode::F3), Open { help: true, settings: true });
        assert_eq!(press(&mut app, KeyCode::Escape), Open { help: true, settings: false }, "what was opened last");
        assert_eq!(press(&mut app, KeyCode::Escape), Open::default());
        let day = app.world().resource::<CityClock>().day;
        press(&mut app, KeyCode::KeyK);
        assert_ne!(app.world().resource::<CityClock>().day, day);
        press(&mut app, KeyCode::KeyQ);
        assert_eq!(app.world().resource::<Messages<EditorCommand>>().len(), 0, "Q alone ends nothing");
        app.world_mut().resource_mut::<ButtonInput<KeyCode>>().press(KeyCode::ControlLeft);
        press(&mut app, KeyCode::KeyQ);
        assert_eq!(app.world().resource::<Messages<EditorCommand>>().len(), 1);
    }
}
