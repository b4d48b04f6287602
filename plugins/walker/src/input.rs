use bevy::input::gamepad::{Gamepad, GamepadAxis, GamepadButton};
use bevy::input::mouse::AccumulatedMouseMotion;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy::window::{CursorGrabMode, CursorOptions, PrimaryWindow};
use veduta_ecs::{Interface, Steering};

use crate::{WalkerSettings, WalkerSystems};

/// What the visitor wants of this frame. Written by keys, mouse and gamepad, or by whoever plays visitor.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Default)]
pub struct Intent {
    /// Right, forward, up: each −1 to 1.
    pub go: DVec3,
    /// Degrees to turn right this frame.
    pub turn_deg: f64,
    /// Degrees to look up this frame.
    pub tilt_deg: f64,
    /// Whether to hurry.
    pub run: bool,
    /// Whether to change between walking and flying.
    pub toggle_fly: bool,
    /// Field of view to take, as index of `WalkerSettings::fovs_deg`.
    pub fov: Option<usize>,
    /// Metres to raise the eye this frame.
    pub raise_m: f64,
}

impl Intent {
    /// Whether the visitor has touched anything that moves.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        self.go != DVec3::ZERO || self.turn_deg != 0.0 || self.tilt_deg != 0.0 || self.toggle_fly
    }
}

/// Whether the mouse is held by the view; let go while an interface uses it.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MouseHeld(
    /// Held.
    pub bool,
);

pub(crate) fn build(app: &mut App) {
    app.init_resource::<MouseHeld>().add_systems(Update, (hold_mouse, read_input, hand_over).chain().in_set(WalkerSystems::Input));
}

/// The right button holds the mouse as long as it is pressed; Esc lets it go too.
fn hold_mouse(
    buttons: Res<ButtonInput<MouseButton>>,
    keys: Res<ButtonInput<KeyCode>>,
    mut held: ResMut<MouseHeld>,
    mut cursors: Query<&mut CursorOptions, With<PrimaryWindow>>,
) {
    if buttons.just_pressed(MouseButton::Right) {
        held.0 = true;
    }
    if keys.just_pressed(KeyCode::Escape) || buttons.just_released(MouseButton::Right) {
        held.0 = false;
    }
    if !held.is_changed() {
        return;
    }
    for mut cursor in &mut cursors {
        cursor.visible = !held.0;
        cursor.grab_mode = if held.0 { CursorGrabMode::Locked } else { CursorGrabMode::None };
    }
}

fn axis(keys: &ButtonInput<KeyCode>, minus: &[KeyCode], plus: &[KeyCode]) -> f64 {
    f64::from(keys.any_pressed(plus.iter().copied())) - f64::from(keys.any_pressed(minus.iter().copied()))
}

fn read_input(
    time: Res<Time>,
    settings: Res<WalkerSettings>,
    keys: Res<ButtonInput<KeyCode>>,
    motion: Res<AccumulatedMouseMotion>,
    held: Res<MouseHeld>,
    gamepads: Query<&Gamepad>,
    interface: Res<Interface>,
    mut last_fov: Local<Option<usize>>,
    mut intent: ResMut<Intent>,
) {
    use KeyCode as K;
    // Where somebody types, keys are letters.
    let resting = ButtonInput::default();
    let keys = if interface.is_typing { &resting } else { &*keys };
    let dt = time.delta_secs_f64();
    let mut next = Intent {
        go: DVec3::new(
            axis(keys, &[K::KeyA], &[K::KeyD]),
            axis(keys, &[K::KeyS, K::ArrowDown], &[K::KeyW, K::ArrowUp]),
            axis(keys, &[K::KeyC], &[K::Space]),
        ),
        turn_deg: axis(keys, &[K::ArrowLeft], &[K::ArrowRight]) * 70.0 * dt,
        run: keys.any_pressed([K::ShiftLeft, K::ShiftRight]),
        toggle_fly: keys.just_pressed(K::KeyF),
        fov: [K::Digit1, K::Digit2, K::Digit3].iter().position(|&key| keys.just_pressed(key)),
        raise_m: axis(keys, &[K::PageDown], &[K::PageUp]) * 0.8 * dt,
        ..Intent::default()
    };
    if held.0 {
        next.turn_deg += f64::from(motion.delta.x) * settings.mouse_deg;
        next.tilt_deg -= f64::from(motion.delta.y) * settings.mouse_deg;
    }
    for pad in &gamepads {
        let stick = |a| f64::from(pad.get(a).unwrap_or(0.0));
        next.go += DVec3::new(stick(GamepadAxis::LeftStickX), stick(GamepadAxis::LeftStickY), 0.0);
        next.go.z += f64::from(pad.get(GamepadButton::RightTrigger2).unwrap_or(0.0))
            - f64::from(pad.get(GamepadButton::LeftTrigger2).unwrap_or(0.0));
        next.turn_deg += stick(GamepadAxis::RightStickX) * settings.stick_deg_s * dt;
        next.tilt_deg += stick(GamepadAxis::RightStickY) * settings.stick_deg_s * 0.6 * dt;
        next.run |= pad.pressed(GamepadButton::LeftThumb);
        next.toggle_fly |= pad.just_pressed(GamepadButton::North);
        next.raise_m += (f64::from(pad.pressed(GamepadButton::DPadRight)) - f64::from(pad.pressed(GamepadButton::DPadLeft))) * dt;
        if pad.just_pressed(GamepadButton::DPadUp) {
            // The middle one is where a walk begins.
            next.fov = Some((last_fov.unwrap_or(1) + 1) % settings.fovs_deg.len());
        }
    }
    *last_fov = next.fov.or(*last_fov);
    next.go = next.go.clamp(DVec3::NEG_ONE, DVec3::ONE);
    intent.set_if_neq(next);
}

/// Touching the controls takes the eye from whoever leads it.
fn hand_over(intent: Res<Intent>, mut steering: ResMut<Steering>) {
    if *steering != Steering::Visitor && intent.is_moving() {
        *steering = Steering::Visitor;
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use bevy::input::InputPlugin;
    use bevy::input::gamepad::{RawGamepadAxisChangedEvent, RawGamepadButtonChangedEvent, RawGamepadEvent};
    use bevy::time::TimeUpdateStrategy;

    use super::*;

    fn app() -> App {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, InputPlugin))
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(100)))
            .init_resource::<WalkerSettings>()
            .init_resource::<Intent>()
            .init_resource::<Steering>()
            .init_resource::<Interface>();
        build(&mut app);
        app.update();
        app
    }

    fn intent(app: &mut App) -> Intent {
        app.update();
        *app.world().resource::<Intent>()
    }

    #[test]
    fn keys_walk_turn_and_take_the_eye_from_a_tour() {
        let mut app = app();
        *app.world_mut().resource_mut::<Steering>() = Steering::Guided;
        assert_eq!(intent(&mut app), Intent::default());
        assert_eq!(*app.world().resource::<Steering>(), Steering::Guided);
        let mut keys = app.world_mut().resource_mut::<ButtonInput<KeyCode>>();
        for key in [KeyCode::KeyW, KeyCode::KeyD, KeyCode::ShiftLeft, KeyCode::ArrowRight] {
            keys.press(key);
        }
        let wish = intent(&mut app);
        assert_eq!(wish.go, DVec3::new(1.0, 1.0, 0.0));
        assert!(wish.run && (wish.turn_deg - 7.0).abs() < 1e-6, "{wish:?}");
        assert_eq!(*app.world().resource::<Steering>(), Steering::Visitor);
        app.world_mut().resource_mut::<Interface>().is_typing = true;
        assert_eq!(intent(&mut app), Intent::default(), "letters move nobody");
    }

    #[test]
    fn a_gamepad_walks_looks_runs_and_changes_the_view() {
        let mut app = app();
        let pad = app.world_mut().spawn(Gamepad::default()).id();
        let turn = |app: &mut App, axis, value| {
            let event = RawGamepadAxisChangedEvent { gamepad: pad, axis, value };
            app.world_mut().write_message(RawGamepadEvent::Axis(event));
        };
        let push = |app: &mut App, button, value| {
            let event = RawGamepadButtonChangedEvent { gamepad: pad, button, value };
            app.world_mut().write_message(RawGamepadEvent::Button(event));
        };
        turn(&mut app, GamepadAxis::LeftStickY, 0.5);
        turn(&mut app, GamepadAxis::RightStickX, -1.0);
        push(&mut app, GamepadButton::LeftThumb, 1.0);
        let wish = intent(&mut app);
        assert!(wish.go.y > 0.4 && wish.go.y < 0.6 && wish.go.x == 0.0, "{wish:?}");
        assert!(wish.run && (wish.turn_deg + 12.0).abs() < 0.1, "{wish:?}");
        let mut seen = Vec::new();
        for _ in 0..3 {
            push(&mut app, GamepadButton::DPadUp, 1.0);
            seen.push(intent(&mut app).fov);
            push(&mut app, GamepadButton::DPadUp, 0.0);
            assert_eq!(intent(&mut app).fov, None, "only when it is pressed");
        }
        assert_eq!(seen, [Some(2), Some(0), Some(1)], "one view after another");
    }
}
