use bevy::input::gamepad::Gamepad;
use bevy::prelude::*;
use bevy_enhanced_input::prelude::ModKeys;

use crate::sense::{StickSettings, sticks};
use crate::{ControlList, Controls, Input, Stick};

/// The next input that is pressed becomes a control's: Escape leaves it as it was, Delete takes it away.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Capture {
    waiting: Option<Place>,
}

/// Where an input is put: the n-th of a control.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// Name of the control.
    pub control: &'static str,
    /// Which of its inputs, from 0; one beyond the last adds another.
    pub nth: usize,
}

impl Capture {
    /// Waits for an input.
    pub fn wait(&mut self, place: Place) {
        self.waiting = Some(place);
    }

    /// Waits no longer.
    pub fn leave(&mut self) {
        self.waiting = None;
    }

    /// Whether an input is waited for: controls rest then.
    #[must_use]
    pub fn is_waiting(&self) -> bool {
        self.waiting.is_some()
    }

    /// What is waited for.
    #[must_use]
    pub fn place(&self) -> Option<Place> {
        self.waiting
    }
}

/// What was pressed.
enum Pressed {
    Input(Input),
    Leave,
    Clear,
}

/// A stick pushed farther than this, of 1, is meant.
const PUSHED: f32 = 0.7;

/// Takes what is pressed, if it is waited for.
pub(crate) fn take(
    keys: Option<Res<ButtonInput<KeyCode>>>,
    buttons: Option<Res<ButtonInput<MouseButton>>>,
    gamepads: Query<&Gamepad>,
    settings: Res<StickSettings>,
    list: Res<ControlList>,
    mut is_fresh: Local<bool>,
    mut capture: ResMut<Capture>,
    mut controls: ResMut<Controls>,
) {
    // What asked for it, a click or a key, has been pressed in the frame before.
    let Some(place) = capture.waiting else {
        *is_fresh = true;
        return;
    };
    if core::mem::take(&mut *is_fresh) {
        return;
    }
    let typed = keys.as_deref().and_then(key);
    let clicked = || {
        let held = keys.as_deref().map_or(ModKeys::empty(), ModKeys::pressed);
        buttons.as_deref()?.get_just_pressed().next().map(|button| Pressed::Input(Input::Mouse(*button, held)))
    };
    let pushed = || gamepads.iter().find_map(|pad| pad_input(pad, &settings)).map(Pressed::Input);
    let Some(pressed) = typed.or_else(clicked).or_else(pushed) else { return };
    capture.waiting = None;
    let Some(control) = list.get(place.control) else { return };
    match pressed {
        Pressed::Leave => {}
        Pressed::Clear => controls.take(control, place.nth),
        Pressed::Input(input) => controls.put(control, place.nth, input),
    }
}

/// A key with those that are held; one of these alone when it is let go.
fn key(keys: &ButtonInput<KeyCode>) -> Option<Pressed> {
    let is_held_with_others = |key: &KeyCode| !ModKeys::from(*key).is_empty();
    let mods = ModKeys::pressed(keys);
    if let Some(&key) = keys.get_just_pressed().find(|key| !is_held_with_others(key)) {
        return Some(match key {
            KeyCode::Escape if mods.is_empty() => Pressed::Leave,
            KeyCode::Delete if mods.is_empty() => Pressed::Clear,
            key => Pressed::Input(Input::Key(key, mods)),
        });
    }
    let alone = keys.get_just_released().find(|key| is_held_with_others(key));
    alone.filter(|_| keys.get_pressed().len() == 0).map(|&key| Pressed::Input(Input::key(key)))
}

fn pad_input(pad: &Gamepad, settings: &StickSettings) -> Option<Input> {
    let button = pad.get_just_pressed().next().map(|button| Input::Pad(*button));
    let pushed = |(stick, way): (Stick, crate::Way)| {
        let push = if stick == Stick::Left { pad.left_stick() } else { pad.right_stick() };
        (way.share(settings.felt(push)) > PUSHED).then_some(Input::Stick(stick, way))
    };
    button.or_else(|| sticks().find_map(pushed))
}

#[cfg(test)]
mod tests {
    use bevy::input::ButtonState;
    use bevy::input::gamepad::{GamepadAxis, RawGamepadAxisChangedEvent, RawGamepadEvent};

    use super::*;
    use crate::testing::{Forward, app, turn};
    use crate::{Control, Presses};

    fn wait(app: &mut App, nth: usize) {
        app.world_mut().resource_mut::<Capture>().wait(Place { control: Forward::NAME, nth });
        app.update();
    }

    fn press(app: &mut App, keys: &[KeyCode]) {
        turn(app, keys, &[], ButtonState::Pressed);
        turn(app, keys, &[], ButtonState::Released);
    }

    fn bound(app: &App) -> Vec<String> {
        let list = app.world().resource::<ControlList>();
        let forward = list.get(Forward::NAME).expect("listed");
        app.world().resource::<Controls>().bound(forward).iter().map(ToString::to_string).collect()
    }

    fn forward(app: &mut App) -> f64 {
        let read = |presses: Presses<'_, '_>| presses.amount::<Forward>();
        app.world_mut().run_system_cached(read).expect("it runs")
    }

    #[test]
    fn the_next_key_becomes_the_controls_and_is_heard_from_then_on() {
        let mut app = app();
        wait(&mut app, 0);
        press(&mut app, &[KeyCode::ShiftLeft, KeyCode::KeyZ]);
        assert_eq!(bound(&app), ["Shift+KeyZ", "Pad LeftStick Up"]);
        assert!(!app.world().resource::<Capture>().is_waiting());
        turn(&mut app, &[KeyCode::KeyW], &[], ButtonState::Pressed);
        assert_eq!(forward(&mut app), 0.0, "what it was bound to is free");
        turn(&mut app, &[KeyCode::KeyW], &[], ButtonState::Released);
        turn(&mut app, &[KeyCode::ShiftRight, KeyCode::KeyZ], &[], ButtonState::Pressed);
        assert_eq!(forward(&mut app), 1.0);
    }

    #[test]
    fn escape_leaves_it_delete_clears_it_and_shift_alone_can_be_meant() {
        let mut app = app();
        wait(&mut app, 0);
        press(&mut app, &[KeyCode::Escape]);
        assert_eq!(bound(&app), ["KeyW", "Pad LeftStick Up"]);
        assert!(!app.world().resource::<Capture>().is_waiting());
        wait(&mut app, 2);
        press(&mut app, &[KeyCode::ShiftLeft]);
        assert_eq!(bound(&app), ["KeyW", "Pad LeftStick Up", "ShiftLeft"]);
        wait(&mut app, 1);
        press(&mut app, &[KeyCode::Delete]);
        assert_eq!(bound(&app), ["KeyW", "ShiftLeft"]);
    }

    #[test]
    fn nothing_is_done_while_an_input_is_waited_for() {
        let mut app = app();
        wait(&mut app, 0);
        turn(&mut app, &[KeyCode::KeyR], &[], ButtonState::Pressed);
        app.update();
        assert_eq!((bound(&app)[0].as_str(), forward(&mut app)), ("KeyR", 0.0), "the key that was chosen is still down");
        turn(&mut app, &[KeyCode::KeyR], &[], ButtonState::Released);
        turn(&mut app, &[KeyCode::KeyR], &[], ButtonState::Pressed);
        assert_eq!(forward(&mut app), 1.0);
    }

    #[test]
    fn mouse_and_gamepad_can_be_chosen() {
        let mut app = app();
        wait(&mut app, 0);
        turn(&mut app, &[], &[MouseButton::Back], ButtonState::Pressed);
        let pad = app.world_mut().spawn(Gamepad::default()).id();
        wait(&mut app, 1);
        let event = RawGamepadAxisChangedEvent { gamepad: pad, axis: GamepadAxis::RightStickX, value: -1.0 };
        app.world_mut().write_message(RawGamepadEvent::Axis(event));
        app.update();
        assert_eq!(bound(&app), ["Mouse Back", "Pad RightStick Left"]);
    }
}
