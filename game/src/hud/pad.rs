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

#[cfg(test)]
mod tests {
    use super::*;

    fn app(device: Device) -> App {
        let mut app = App::new();
        app.init_resource::<Open>().init_resource::<Capture>().init_resource::<Interface>().insert_resource(LastDevice(device));
        app.add_message::<EguiInputEvent>().add_systems(Update, steer);
        app.world_mut().spawn(PrimaryEguiContext);
        app.world_mut().spawn(Gamepad::default());
        app
    }

    /// The keys that a window hears of in a frame in which a button is pressed.
    fn heard(app: &mut App, button: Option<Button>) -> Vec<Key> {
        let mut pads = app.world_mut().query::<&mut Gamepad>();
        let mut pad = pads.single_mut(app.world_mut()).expect("one gamepad");
        pad.digital_mut().reset_all();
        button.into_iter().for_each(|button| pad.digital_mut().press(button));
        app.update();
        let mut events = app.world_mut().resource_mut::<Messages<EguiInputEvent>>();
        let pressed = events.drain().filter_map(|input| match input.event {
            Event::Key { key, pressed: true, .. } => Some(key),
            _ => None,
        });
        pressed.collect()
    }

    #[test]
    fn a_gamepad_goes_through_an_open_window_and_leaves_a_closed_one_alone() {
        let mut app = app(Device::Pad);
        assert_eq!(heard(&mut app, Some(Button::DPadDown)), [], "nothing is open");
        app.world_mut().resource_mut::<Open>().settings = true;
        assert_eq!(heard(&mut app, None), [Key::Tab], "something is chosen at once");
        assert_eq!(heard(&mut app, Some(Button::South)), [], "nothing is chosen that could be pressed");
        assert_eq!(heard(&mut app, Some(Button::DPadDown)), [Key::Tab]);
        app.world_mut().resource_mut::<Interface>().is_typing = true;
        for (button, key) in [
            (Button::DPadUp, Key::ArrowUp),
            (Button::DPadDown, Key::ArrowDown),
            (Button::DPadLeft, Key::ArrowLeft),
            (Button::DPadRight, Key::ArrowRight),
            (Button::South, Key::Enter),
            (Button::East, Key::Escape),
        ] {
            assert_eq!(heard(&mut app, Some(button)), [key], "{button:?}");
        }
        assert_eq!(heard(&mut app, Some(Button::West)), []);
    }

    #[test]
    fn a_keyboard_chooses_for_itself() {
        let mut app = app(Device::Keys);
        app.world_mut().resource_mut::<Open>().help = true;
        assert_eq!(heard(&mut app, Some(Button::DPadDown)), []);
    }
}
