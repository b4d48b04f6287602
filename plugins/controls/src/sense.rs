use std::collections::BTreeMap;

use bevy::input::gamepad::{Gamepad, GamepadAxis};
use bevy::input::keyboard::{Key, KeyboardInput};
use bevy::input::mouse::{AccumulatedMouseScroll, MouseScrollUnit};
use bevy::prelude::*;
use bevy_enhanced_input::prelude::{ActionSources, ActionValue, CustomInput, CustomInputs, ModKeys};
use veduta_ecs::{Interface, PointersTaken};

use crate::capture::Capture;
use crate::touch::Touching;
use crate::{ControlList, Input, KeyCaps, Stick, Way};

/// How sticks are felt. Live.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Resource)]
pub struct StickSettings {
    /// Pushed no farther than this, a stick is at rest: a share of its whole way, in any direction.
    pub dead: f32,
    /// Pushed as far as this, it is pushed the whole way.
    pub full: f32,
}

impl Default for StickSettings {
    fn default() -> Self {
        Self { dead: 0.15, full: 0.95 }
    }
}

impl StickSettings {
    /// A push beyond the dead zone, 0 to 1 in its own direction: a radial dead zone keeps the direction, where one an axis would
    /// draw it towards the axes.
    #[must_use]
    pub fn felt(&self, push: Vec2) -> Vec2 {
        let length = push.length();
        if !length.is_finite() || length <= self.dead {
            return Vec2::ZERO;
        }
        push / length * ((length - self.dead) / (self.full - self.dead).max(1e-3)).min(1.0)
    }
}

/// Inputs that are made of others here, and handed to the actions as custom inputs.
#[derive(Resource, Default)]
pub(crate) struct Sensed {
    ids: Vec<(Input, CustomInput)>,
    /// What keys that are down wrote when they were pressed.
    letters: BTreeMap<KeyCode, char>,
}

impl Sensed {
    /// The custom input that stands for an input.
    pub fn id(&mut self, input: Input, custom: &mut CustomInputs) -> CustomInput {
        if let Some((_, id)) = self.ids.iter().find(|(known, _)| *known == input) {
            return *id;
        }
        let id = custom.register_input();
        self.ids.push((input, id));
        id
    }
}

/// The letters of keys that go down; those that go up are forgotten.
pub(crate) fn hear_letters(
    mut typed: MessageReader<KeyboardInput>,
    keys: Res<ButtonInput<KeyCode>>,
    mut sensed: ResMut<Sensed>,
    mut caps: ResMut<KeyCaps>,
) {
    for key in typed.read().filter(|key| key.state.is_pressed()) {
        let Key::Character(written) = &key.logical_key else { continue };
        let mut letters = written.chars();
        let (Some(letter), None) = (letters.next(), letters.next()) else { continue };
        sensed.letters.entry(key.key_code).or_insert(letter);
        if ModKeys::pressed(&keys).is_empty() && !caps.has(key.key_code, letter) {
            caps.learn(key.key_code, letter);
        }
    }
    sensed.letters.retain(|key, _| keys.pressed(*key) || keys.just_pressed(*key));
}

/// A line of the wheel does as much as a key that is held for so long, seconds: whatever the frame rate.
const LINE_S: f32 = 0.12;

/// What sticks, wheel, fingers and letters amount to in this frame.
pub(crate) fn sense(
    (list, sensed, settings): (Res<ControlList>, Res<Sensed>, Res<StickSettings>),
    time: Res<Time<Real>>,
    scroll: Option<Res<AccumulatedMouseScroll>>,
    touching: Res<Touching>,
    gamepads: Query<&Gamepad>,
    sources: Res<ActionSources>,
    mut custom: ResMut<CustomInputs>,
) {
    let pushed = |stick: Stick| {
        let (x, y) = match stick {
            Stick::Left => (GamepadAxis::LeftStickX, GamepadAxis::LeftStickY),
            Stick::Right => (GamepadAxis::RightStickX, GamepadAxis::RightStickY),
        };
        let felt = gamepads.iter().map(|pad| settings.felt(Vec2::new(pad.get(x).unwrap_or(0.0), pad.get(y).unwrap_or(0.0))));
        felt.sum::<Vec2>().clamp_length_max(1.0)
    };
    let turned = scroll.filter(|_| sources.mouse_wheel).map_or(Vec2::ZERO, |scroll| match scroll.unit {
        MouseScrollUnit::Line => scroll.delta,
        MouseScrollUnit::Pixel => scroll.delta / MouseScrollUnit::SCROLL_UNIT_CONVERSION_FACTOR,
    });
    for &(input, id) in &sensed.ids {
        let amount = match input {
            Input::Pad(button) if sources.gamepad_button => {
                let pressed = |pad: &Gamepad| pad.get(button).unwrap_or(0.0).max(f32::from(pad.just_pressed(button)));
                gamepads.iter().map(pressed).fold(0.0, f32::max)
            }
            Input::Stick(stick, way) if sources.gamepad_axis => way.share(pushed(stick)),
            Input::Wheel(way) => way.share(turned) * LINE_S / time.delta_secs().max(1e-3),
            Input::TouchStick(way) => way.share(touching.stick),
            Input::Letter(letter) if sources.keyboard => {
                let mut keys = sensed.letters.iter().filter(|(_, written)| **written == letter);
                f32::from(keys.any(|(key, _)| !is_bound(&list, *key)))
            }
            _ => 0.0,
        };
        custom.insert(id, ActionValue::Axis1D(amount));
    }
}

/// Whether the place of a key does something in its own right now.
fn is_bound(list: &ControlList, key: KeyCode) -> bool {
    let input = Input::key(key);
    list.iter().any(|control| list.is_active(control.scope) && control.bound.as_ref().is_some_and(|bound| bound.contains(&input)))
}

/// Keys and buttons that went down and up again within this frame: where frames are long, a tap is short.
#[derive(Resource, Default)]
pub(crate) struct Tapped {
    keys: Vec<KeyCode>,
    /// Modifiers that were let go of in this frame after a key had gone down: of `Ctrl+Q`, Control may have been down for long.
    modifiers: Vec<KeyCode>,
    buttons: Vec<MouseButton>,
}

/// Holds what was tapped until it has been heard: actions ask what is down, and would miss it.
pub(crate) fn hold_taps(
    mut typed: MessageReader<KeyboardInput>,
    mut keys: Option<ResMut<ButtonInput<KeyCode>>>,
    mut buttons: Option<ResMut<ButtonInput<MouseButton>>>,
    mut tapped: ResMut<Tapped>,
) {
    let Tapped { keys: short, modifiers, .. } = &mut *tapped;
    modifiers.clear();
    let mut has_pressed = false;
    for key in typed.read() {
        if !ModKeys::from(key.key_code).is_empty() {
            if has_pressed && !key.state.is_pressed() {
                modifiers.push(key.key_code);
            }
        } else {
            has_pressed |= key.state.is_pressed() && !key.repeat;
        }
    }
    if let Some(keys) = &mut keys {
        let keys = keys.bypass_change_detection();
        *short = keys.get_just_pressed().filter(|key| !keys.pressed(**key)).copied().collect();
        modifiers.retain(|key| !keys.pressed(*key) && !short.contains(key));
        short.iter().chain(&*modifiers).for_each(|key| keys.press(*key));
    }
    if let Some(buttons) = &mut buttons {
        let short = buttons.get_just_pressed().filter(|button| !buttons.pressed(**button)).copied();
        tapped.buttons = short.collect();
        tapped.buttons.iter().for_each(|button| buttons.bypass_change_detection().press(*button));
    }
}

/// Lets go of what was held for being heard.
pub(crate) fn release_taps(
    mut keys: Option<ResMut<ButtonInput<KeyCode>>>,
    mut buttons: Option<ResMut<ButtonInput<MouseButton>>>,
    mut tapped: ResMut<Tapped>,
) {
    if let Some(keys) = &mut keys {
        let keys = keys.bypass_change_detection();
        tapped.keys.drain(..).for_each(|key| keys.release(key));
        for key in tapped.modifiers.drain(..) {
            keys.release(key);
            // It went down before this frame.
            keys.clear_just_pressed(key);
        }
    }
    if let Some(buttons) = &mut buttons {
        tapped.buttons.drain(..).for_each(|button| buttons.bypass_change_detection().release(button));
    }
}

/// What rests until it is let go of.
#[derive(Default)]
pub(crate) struct Resting {
    keys: bool,
    mouse: bool,
    pads: bool,
}

/// Whether a key means nothing to what is typed.
fn is_function_key(key: KeyCode) -> bool {
    use KeyCode::{F1, F2, F3, F4, F5, F6, F7, F8, F9, F10, F11, F12};
    [F1, F2, F3, F4, F5, F6, F7, F8, F9, F10, F11, F12].contains(&key)
}

/// Keys and pads rest while somebody types or has chosen something in a window, the mouse over windows, and everything while an input is
/// waited for: until all that was pressed meanwhile has been let go, so that a letter's end is no key's beginning. Function keys alone are
/// heard while somebody types, too.
pub(crate) fn rest(
    (interface, taken, capture): (Res<Interface>, Res<PointersTaken>, Res<Capture>),
    keys: Option<Res<ButtonInput<KeyCode>>>,
    buttons: Option<Res<ButtonInput<MouseButton>>>,
    gamepads: Query<&Gamepad>,
    mut resting: Local<Resting>,
    mut sources: ResMut<ActionSources>,
) {
    let mut down = keys.iter().flat_map(|keys| keys.get_pressed()).copied().peekable();
    let are_keys_down = down.peek().is_some();
    let writes = !are_keys_down || down.any(|key| !is_function_key(key));
    resting.keys = capture.is_waiting() || writes && (interface.is_typing || (resting.keys && are_keys_down));
    // What began over the city goes on over a window, and the other way round.
    let was_down = buttons.is_some_and(|buttons| buttons.get_pressed().any(|button| !buttons.just_pressed(*button)));
    resting.mouse = capture.is_waiting() || if was_down { resting.mouse } else { taken.mouse };
    let are_pads_down = gamepads.iter().any(|pad| pad.get_pressed().next().is_some());
    resting.pads = interface.is_typing || capture.is_waiting() || (resting.pads && are_pads_down);
    let next = ActionSources {
        keyboard: !resting.keys,
        mouse_buttons: !resting.mouse,
        mouse_motion: !resting.mouse,
        mouse_wheel: !(resting.mouse || taken.mouse),
        gamepad_button: !resting.pads,
        gamepad_axis: !resting.pads,
    };
    *sources = next;
}

/// All ways of both sticks.
pub(crate) fn sticks() -> impl Iterator<Item = (Stick, Way)> {
    [Stick::Left, Stick::Right].into_iter().flat_map(|stick| Way::ALL.map(|way| (stick, way)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stick_rests_in_the_middle_and_keeps_its_direction() {
        let settings = StickSettings::default();
        assert_eq!(settings.felt(Vec2::new(0.1, 0.1)), Vec2::ZERO);
        assert_eq!(settings.felt(Vec2::new(f32::NAN, 0.0)), Vec2::ZERO);
        let slant = settings.felt(Vec2::new(0.6, 0.12));
        assert!((slant.y / slant.x - 0.2).abs() < 1e-5, "small parts are not cut off: {slant}");
        assert!((settings.felt(Vec2::new(0.8, 0.8)).length() - 1.0).abs() < 1e-6, "corners of a square pad reach no farther");
        let just = settings.felt(Vec2::new(0.0, -0.16));
        assert!(just.y < 0.0 && just.y > -0.05, "it begins softly: {just}");
    }
}
