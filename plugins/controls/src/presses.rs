use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_enhanced_input::prelude::{ActionEvents, ActionValue};

use crate::{Control, ControlList, Scope};

/// What the visitor presses in this frame, by control.
///
/// The same can be had from [`bevy_enhanced_input`]: by observers of its events, such as `On<Start<C>>`, and from `Action<C>`.
#[derive(SystemParam)]
pub struct Presses<'w, 's> {
    list: Res<'w, ControlList>,
    actions: Query<'w, 's, (&'static ActionValue, &'static ActionEvents)>,
}

impl Presses<'_, '_> {
    fn action<C: Control>(&self) -> Option<(&ActionValue, &ActionEvents)> {
        self.actions.get(self.list.action_of::<C>()?).ok()
    }

    /// How much of it is wanted: 0 to 1, and more of a wheel that turns fast.
    #[must_use]
    pub fn amount<C: Control>(&self) -> f64 {
        self.action::<C>().map_or(0.0, |(value, _)| f64::from(value.as_axis1d()))
    }

    /// What of two controls is wanted, the one against the other.
    #[must_use]
    pub fn axis<Minus: Control, Plus: Control>(&self) -> f64 {
        self.amount::<Plus>() - self.amount::<Minus>()
    }

    /// Whether controls of a scope are heard now.
    #[must_use]
    pub fn is_heard<S: Scope>(&self) -> bool {
        self.list.is_active(S::NAME)
    }

    /// Whether it is pressed.
    #[must_use]
    pub fn is_down<C: Control>(&self) -> bool {
        self.action::<C>().is_some_and(|(value, _)| value.as_bool())
    }

    /// Whether it has been pressed in this frame, after having been let go.
    #[must_use]
    pub fn begins<C: Control>(&self) -> bool {
        self.action::<C>().is_some_and(|(_, events)| events.contains(ActionEvents::START))
    }
}

#[cfg(test)]
mod tests {
    use bevy::input::ButtonState;
    use bevy::input::gamepad::{Gamepad, GamepadAxis, RawGamepadAxisChangedEvent, RawGamepadEvent};
    use bevy::input::keyboard::{Key, KeyboardInput, NativeKey};
    use bevy_enhanced_input::prelude::ActionMock;
    use bevy_enhanced_input::prelude::TriggerState;
    use veduta_ecs::Interface;

    use super::*;
    use crate::testing::{Bow, Dive, End, Find, Flies, Forward, Run, Shine, app};
    use crate::{Controls, Device, Input, LastDevice};

    fn read<C: Control>(app: &mut App) -> (f64, bool) {
        let read = |presses: Presses<'_, '_>| (presses.amount::<C>(), presses.begins::<C>());
        app.world_mut().run_system_cached(read).expect("it runs")
    }

    fn press(app: &mut App, key: KeyCode) {
        app.world_mut().resource_mut::<ButtonInput<KeyCode>>().press(key);
        app.update();
    }

    fn release(app: &mut App, key: KeyCode) {
        app.world_mut().resource_mut::<ButtonInput<KeyCode>>().release(key);
        app.update();
    }

    #[test]
    fn a_key_is_told_as_long_as_it_is_down_and_begins_once() {
        let mut app = app();
        press(&mut app, KeyCode::KeyR);
        assert_eq!(read::<Run>(&mut app), (0.5, true), "a key gives its share");
        app.update();
        assert_eq!(read::<Run>(&mut app), (0.5, false));
        release(&mut app, KeyCode::KeyR);
        assert_eq!(read::<Run>(&mut app), (0.0, false));
    }

    #[test]
    fn a_tap_within_a_frame_is_heard_once() {
        let mut app = app();
        let window = Entity::PLACEHOLDER;
        for state in [ButtonState::Pressed, ButtonState::Released] {
            let logical_key = Key::Character("r".into());
            let key_code = KeyCode::KeyR;
            app.world_mut().write_message(KeyboardInput { key_code, logical_key, state, text: None, repeat: false, window });
        }
        app.update();
        assert_eq!(read::<Run>(&mut app), (0.5, true));
        assert!(!app.world().resource::<ButtonInput<KeyCode>>().pressed(KeyCode::KeyR), "to all others it is up");
        app.update();
        assert_eq!(read::<Run>(&mut app), (0.0, false));
    }

    #[test]
    fn a_modifier_counts_that_is_let_go_of_in_the_frame_of_its_key() {
        let mut app = app();
        let send = |app: &mut App, key_code, state| {
            let logical_key = Key::Unidentified(NativeKey::Unidentified);
            let window = Entity::PLACEHOLDER;
            app.world_mut().write_message(KeyboardInput { key_code, logical_key, state, text: None, repeat: false, window });
        };
        send(&mut app, KeyCode::ControlLeft, ButtonState::Pressed);
        app.update();
        assert!(!read::<End>(&mut app).1);
        // The next frame is long.
        send(&mut app, KeyCode::KeyQ, ButtonState::Pressed);
        send(&mut app, KeyCode::ControlLeft, ButtonState::Released);
        send(&mut app, KeyCode::KeyQ, ButtonState::Released);
        app.update();
        assert!(read::<End>(&mut app).1);
        let keys = app.world().resource::<ButtonInput<KeyCode>>();
        assert!(keys.get_pressed().next().is_none() && !keys.just_pressed(KeyCode::ControlLeft), "to all others it is up");
        app.update();
        assert!(!read::<End>(&mut app).1);
        // Let go of before the key goes down, it is no part of it.
        send(&mut app, KeyCode::ControlLeft, ButtonState::Pressed);
        app.update();
        send(&mut app, KeyCode::ControlLeft, ButtonState::Released);
        send(&mut app, KeyCode::KeyQ, ButtonState::Pressed);
        app.update();
        assert!(!read::<End>(&mut app).1);
    }

    #[test]
    fn one_key_does_what_its_scope_says() {
        let mut app = app();
        press(&mut app, KeyCode::KeyB);
        assert_eq!((read::<Bow>(&mut app).0, read::<Dive>(&mut app).0), (1.0, 0.0));
        app.world_mut().resource_mut::<Flies>().0 = true;
        app.update();
        app.update();
        assert_eq!((read::<Bow>(&mut app).0, read::<Dive>(&mut app).0), (0.0, 0.0), "it is still down from before");
        release(&mut app, KeyCode::KeyB);
        press(&mut app, KeyCode::KeyB);
        assert_eq!((read::<Bow>(&mut app).0, read::<Dive>(&mut app).0), (0.0, 1.0));
    }

    #[test]
    fn keys_rest_while_somebody_types_and_until_they_are_let_go() {
        let mut app = app();
        app.world_mut().resource_mut::<Interface>().is_typing = true;
        press(&mut app, KeyCode::KeyW);
        assert_eq!(read::<Forward>(&mut app), (0.0, false));
        app.world_mut().resource_mut::<Interface>().is_typing = false;
        app.update();
        assert_eq!(read::<Forward>(&mut app), (0.0, false), "the last letter is still down");
        app.world_mut().resource_mut::<Interface>().is_typing = true;
        release(&mut app, KeyCode::KeyW);
        press(&mut app, KeyCode::F9);
        assert_eq!(read::<Shine>(&mut app), (1.0, true), "which writes nothing");
        release(&mut app, KeyCode::F9);
        app.world_mut().resource_mut::<Interface>().is_typing = false;
        app.update();
        release(&mut app, KeyCode::KeyW);
        press(&mut app, KeyCode::KeyW);
        assert_eq!(read::<Forward>(&mut app), (1.0, true));
    }

    #[test]
    fn sticks_are_felt_beyond_their_dead_zone_by_a_curve_and_may_be_pulled_out() {
        let mut app = app();
        let pad = app.world_mut().spawn(Gamepad::default()).id();
        let push = |app: &mut App, value| {
            let event = RawGamepadAxisChangedEvent { gamepad: pad, axis: GamepadAxis::LeftStickY, value };
            app.world_mut().write_message(RawGamepadEvent::Axis(event));
            app.update();
        };
        push(&mut app, 0.12);
        assert_eq!(read::<Forward>(&mut app).0, 0.0);
        push(&mut app, 0.55);
        assert!((read::<Forward>(&mut app).0 - 0.25).abs() < 1e-3, "half the way, by the square: {:?}", read::<Forward>(&mut app));
        assert_eq!(app.world().resource::<LastDevice>().0, Device::Pad);
        push(&mut app, -1.0);
        assert_eq!(read::<Forward>(&mut app).0, 0.0);
        push(&mut app, 1.0);
        assert_eq!(read::<Forward>(&mut app).0, 1.0);
        app.world_mut().despawn(pad);
        app.update();
        assert_eq!(read::<Forward>(&mut app).0, 0.0);
        assert_eq!(app.world().resource::<LastDevice>().0, Device::Keys);
    }

    #[test]
    fn letters_are_found_wherever_they_lie_unless_their_place_is_bound() {
        let mut app = app();
        let write = |app: &mut App, key_code: KeyCode, state| {
            let logical_key = Key::Character("/".into());
            let window = Entity::PLACEHOLDER;
            app.world_mut().write_message(KeyboardInput { key_code, logical_key, state, text: None, repeat: false, window });
            app.update();
        };
        write(&mut app, KeyCode::Digit7, ButtonState::Pressed);
        assert_eq!(read::<Find>(&mut app), (1.0, true));
        write(&mut app, KeyCode::Digit7, ButtonState::Released);
        assert_eq!(read::<Find>(&mut app), (0.0, false));
        write(&mut app, KeyCode::KeyR, ButtonState::Pressed);
        assert_eq!((read::<Find>(&mut app).0, read::<Run>(&mut app).0), (0.0, 0.5), "its place is for running");
    }

    #[test]
    fn what_is_changed_is_heard_at_once_and_held_keys_are_no_others() {
        let mut app = app();
        let set = |app: &mut App, inputs: Vec<Input>| {
            let listed = app.world().resource::<crate::ControlList>().get(Forward::NAME).expect("listed").clone();
            app.world_mut().resource_mut::<Controls>().set(&listed, inputs);
            app.update();
        };
        set(&mut app, vec!["Shift+R".parse().expect("an input")]);
        app.world_mut().resource_mut::<ButtonInput<KeyCode>>().press(KeyCode::ShiftLeft);
        press(&mut app, KeyCode::KeyR);
        assert_eq!((read::<Forward>(&mut app).0, read::<Run>(&mut app).0), (1.0, 0.0), "Shift+R is not R");
        release(&mut app, KeyCode::ShiftLeft);
        assert_eq!((read::<Forward>(&mut app).0, read::<Run>(&mut app).0), (0.0, 0.5));
        set(&mut app, vec![]);
        release(&mut app, KeyCode::KeyR);
        app.world_mut().resource_mut::<ButtonInput<KeyCode>>().press(KeyCode::ShiftLeft);
        press(&mut app, KeyCode::KeyR);
        assert_eq!((read::<Forward>(&mut app).0, read::<Run>(&mut app).0), (0.0, 0.5));
    }

    #[test]
    fn tests_of_games_can_press_a_control_without_a_key() {
        let mut app = app();
        let action = app.world().resource::<ControlList>().action_of::<Run>().expect("spawned");
        app.world_mut().entity_mut(action).insert(ActionMock::once(TriggerState::Fired, 1.0));
        app.update();
        assert_eq!(read::<Run>(&mut app), (1.0, true));
    }
}
