use bevy::input::gamepad::{Gamepad, GamepadButton as Button};
use bevy::prelude::*;
use bevy_egui::PrimaryEguiContext;
use bevy_egui::egui::{Event, Key, Modifiers};
use bevy_egui::input::EguiInputEvent;
use veduta::controls::{Capture, Device, LastDevice};
use veduta::ecs::Interface;

use super::Open;

/// In a window the gamepad's cross goes from one thing to the next, or along a slider; A presses it, and B leaves it.
pub(super) fn steer(
    (open, capture, last, interface): (Res<Open>, Res<Capture>, Res<LastDevice>, Res<Interface>),
    gamepads: Query<&Gamepad>,
    contexts: Query<Entity, With<PrimaryEguiContext>>,
    mut was_open: Local<bool>,
    mut events: MessageWriter<EguiInputEvent>,
) {
    let is_open = open.help || open.settings;
    let has_opened = is_open && !core::mem::replace(&mut *was_open, is_open);
    if !is_open || capture.is_waiting() || last.0 != Device::Pad {
        return;
    }
    let Some(context) = contexts.iter().next() else { return };
    let keys = gamepads.iter().flat_map(|pad| pad.get_just_pressed()).filter_map(|button| key(*button, interface.is_typing));
    // Something is chosen as soon as the window is there.
    for key in keys.chain(has_opened.then_some(Key::Tab)) {
        for pressed in [true, false] {
            let event = Event::Key { key, physical_key: None, pressed, repeat: false, modifiers: Modifiers::NONE };
            events.write(EguiInputEvent { context, event });
        }
    }
}

/// The key of a keyboard that does what a button means, whether something is chosen already or not.
fn key(button: Button, has_chosen: bool) -> Option<Key> {
    Some(match (button, has_chosen) {
        (Button::DPadUp | Button::DPadDown | Button::DPadLeft | Button::DPadRight, false) => Key::Tab,
        (Button::DPadUp, true) => Key::ArrowUp,
        (Button::DPadDown, true) => Key::ArrowDown,
        (Button::DPadLeft, true) => Key::ArrowLeft,
        (Button::DPadRight, true) => Key::ArrowRight,
        (Button::South, true) => Key::Enter,
        (Button::East, true) => Key::Escape,
        _ => return None,
    })
}
