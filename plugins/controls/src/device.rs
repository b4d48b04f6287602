use bevy::input::gamepad::{Gamepad, GamepadAxis};
use bevy::input::touch::TouchInput;
use bevy::prelude::*;

use crate::{Device, StickSettings};

/// What the visitor used last: keys are named on what is in his hand.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LastDevice(
    /// The device.
    pub Device,
);

pub(crate) fn notice(
    keys: Option<Res<ButtonInput<KeyCode>>>,
    buttons: Option<Res<ButtonInput<MouseButton>>>,
    mut touches: MessageReader<TouchInput>,
    gamepads: Query<&Gamepad>,
    sticks: Res<StickSettings>,
    mut last: ResMut<LastDevice>,
) {
    let is_pushed = |pad: &Gamepad| {
        let push = |x, y| Vec2::new(pad.get(x).unwrap_or(0.0), pad.get(y).unwrap_or(0.0));
        sticks.felt(push(GamepadAxis::LeftStickX, GamepadAxis::LeftStickY)) != Vec2::ZERO
            || sticks.felt(push(GamepadAxis::RightStickX, GamepadAxis::RightStickY)) != Vec2::ZERO
    };
    let has_typed = keys.is_some_and(|keys| keys.get_just_pressed().len() > 0)
        || buttons.is_some_and(|buttons| buttons.get_just_pressed().len() > 0);
    let device = if gamepads.iter().any(|pad| pad.get_just_pressed().next().is_some() || is_pushed(pad)) {
        Device::Pad
    } else if touches.read().count() > 0 {
        Device::Touch
    } else if has_typed || (last.0 == Device::Pad && gamepads.is_empty()) {
        // Who has pulled the plug of his gamepad is told of keys again.
        Device::Keys
    } else {
        return;
    };
    last.set_if_neq(LastDevice(device));
}
