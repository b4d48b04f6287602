use bevy::input::mouse::AccumulatedMouseMotion;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy::window::{CursorGrabMode, CursorOptions, PrimaryWindow};
use veduta_controls::{Layers, Presses, Touching};
use veduta_ecs::Steering;

use crate::controls::{
    Examine, ExamineDrag, Examining, EyeHigher, EyeLower, Farther, Fly, LookDown, LookHold, LookLeft, LookRight, LookUp, Nearer,
    Rise, Run, Sink, StepLeft, StepRight, ViewNarrow, ViewNatural, ViewNext, ViewWide, WalkBack, WalkForward,
};
use crate::{WalkerSettings, WalkerSystems, add_controls};

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
    /// How much wider to make the field of view this frame: the logarithm of a factor.
    pub widen: f64,
    /// Metres to raise the eye this frame.
    pub raise_m: f64,
    /// Whether to change between examining what the eye looks at, and walking.
    pub toggle_examine: bool,
    /// How much nearer to come this frame to what is examined: the logarithm of a factor.
    pub near: f64,
}

impl Intent {
    /// Whether the visitor has touched anything that moves.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        self.go != DVec3::ZERO || self.turn_deg != 0.0 || self.tilt_deg != 0.0 || self.toggle_fly || self.toggle_examine
    }
}

/// Whether the mouse is held by the view; let go while an interface uses it.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MouseHeld(
    /// Held.
    pub bool,
);

pub(crate) fn build(app: &mut App) {
    add_controls(app);
    app.init_resource::<MouseHeld>()
        .init_resource::<AccumulatedMouseMotion>()
        .add_systems(Update, (hold_mouse, read_input, hand_over).chain().in_set(WalkerSystems::Input));
}

/// The mouse is held as long as its control is; whoever closes things lets it go too.
fn hold_mouse(
    presses: Presses<'_, '_>,
    mut layers: ResMut<Layers>,
    mut held: ResMut<MouseHeld>,
    mut cursors: Query<&mut CursorOptions, With<PrimaryWindow>>,
) {
    let holds = if presses.begins::<LookHold>() { true } else { held.0 && presses.is_down::<LookHold>() };
    let closes = layers.closes("look", holds);
    held.set_if_neq(MouseHeld(holds && !closes));
    if !held.is_changed() {
        return;
    }
    for mut cursor in &mut cursors {
        cursor.visible = !held.0;
        cursor.grab_mode = if held.0 { CursorGrabMode::Locked } else { CursorGrabMode::None };
    }
}

fn read_input(
    time: Res<Time>,
    settings: Res<WalkerSettings>,
    presses: Presses<'_, '_>,
    motion: Res<AccumulatedMouseMotion>,
    (held, touching): (Res<MouseHeld>, Res<Touching>),
    mut last_fov: Local<Option<usize>>,
    mut intent: ResMut<Intent>,
) {
    let dt = time.delta_secs_f64();
    let is_examining = presses.is_heard::<Examining>();
    let mut next = Intent {
        go: DVec3::new(
            presses.axis::<StepLeft, StepRight>(),
            presses.axis::<WalkBack, WalkForward>(),
            presses.axis::<Sink, Rise>(),
        ),
        turn_deg: presses.axis::<LookLeft, LookRight>() * settings.stick_deg_s * dt,
        tilt_deg: presses.axis::<LookDown, LookUp>() * settings.stick_deg_s * 0.6 * dt,
        run: presses.is_down::<Run>(),
        toggle_fly: presses.begins::<Fly>(),
        toggle_examine: presses.begins::<Examine>(),
        near: presses.axis::<Farther, Nearer>() * NEARS_HZ * dt,
        fov: [presses.begins::<ViewNarrow>(), presses.begins::<ViewNatural>(), presses.begins::<ViewWide>()]
            .iter()
            .position(|begins| *begins),
        raise_m: presses.axis::<EyeLower, EyeHigher>() * 0.9 * dt,
        ..Intent::default()
    };
    let dragged = if held.0 || presses.is_down::<ExamineDrag>() { motion.delta } else { Vec2::ZERO } + touching.look_px;
    next.turn_deg += f64::from(dragged.x) * settings.mouse_deg;
    next.tilt_deg -= f64::from(dragged.y) * settings.mouse_deg;
    if touching.pinch > 0.0 {
        // Fingers that spread enlarge: nearer, or a narrower view.
        let spread = f64::from(touching.pinch).ln();
        *(if is_examining { &mut next.near } else { &mut next.widen }) += if is_examining { spread } else { -spread };
    }
    if presses.begins::<ViewNext>() {
        // The middle one is where a walk begins.
        next.fov = Some((last_fov.unwrap_or(1) + 1) % settings.fovs_deg.len());
    }
    *last_fov = next.fov.or(*last_fov);
    next.go = next.go.clamp(DVec3::NEG_ONE, DVec3::ONE);
    intent.set_if_neq(next);
}

/// Who holds a key comes nearer, or goes off, by e in a second.
const NEARS_HZ: f64 = 1.0;

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
    use bevy::input::gamepad::{
        Gamepad, GamepadAxis, GamepadButton, RawGamepadAxisChangedEvent, RawGamepadButtonChangedEvent, RawGamepadEvent,
    };
    use bevy::input::mouse::MouseMotion;
    use bevy::input::touch::{TouchInput, TouchPhase};
    use bevy::time::TimeUpdateStrategy;
    use veduta_ecs::Interface;

    use super::*;
    use crate::Walker;

    fn app() -> App {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, InputPlugin))
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(100)))
            .init_resource::<WalkerSettings>()
            .init_resource::<Intent>()
            .init_resource::<Steering>();
        build(&mut app);
        app.finish();
        app.cleanup();
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
        push(&mut app, GamepadButton::North, 1.0);
        assert!(intent(&mut app).toggle_fly);
        push(&mut app, GamepadButton::RightThumb, 1.0);
        assert!(intent(&mut app).toggle_examine);
        app.world_mut().despawn(pad);
        assert_eq!(intent(&mut app), Intent::default(), "its plug was pulled");
    }

    #[test]
    fn the_right_button_holds_the_mouse_until_it_or_escape_is_pressed() {
        let mut app = app();
        let drag = |app: &mut App| {
            app.world_mut().write_message(MouseMotion { delta: Vec2::new(10.0, 5.0) });
            intent(app)
        };
        assert_eq!(drag(&mut app), Intent::default(), "a mouse that is not held looks nowhere");
        app.world_mut().resource_mut::<ButtonInput<MouseButton>>().press(MouseButton::Right);
        let wish = drag(&mut app);
        assert!((wish.turn_deg - 1.2).abs() < 1e-9 && (wish.tilt_deg + 0.6).abs() < 1e-9, "{wish:?}");
        app.world_mut().resource_mut::<ButtonInput<KeyCode>>().press(KeyCode::Escape);
        app.update();
        assert_eq!(drag(&mut app), Intent::default(), "let go by Escape");
    }

    #[test]
    fn fingers_walk_look_and_widen_the_view() {
        let mut app = app();
        let send = |app: &mut App, id, phase, x, y| {
            let window = Entity::PLACEHOLDER;
            app.world_mut().write_message(TouchInput { phase, position: Vec2::new(x, y), window, force: None, id });
        };
        send(&mut app, 1, TouchPhase::Started, 100.0, 500.0);
        send(&mut app, 1, TouchPhase::Moved, 100.0, 436.0);
        send(&mut app, 2, TouchPhase::Started, 900.0, 300.0);
        send(&mut app, 2, TouchPhase::Moved, 920.0, 300.0);
        send(&mut app, 2, TouchPhase::Moved, 930.0, 300.0);
        let wish = intent(&mut app);
        assert!((wish.go.y - 1.0).abs() < 1e-6 && (wish.turn_deg - 1.2).abs() < 1e-6, "{wish:?}");
        send(&mut app, 3, TouchPhase::Started, 1030.0, 300.0);
        app.update();
        send(&mut app, 3, TouchPhase::Moved, 1130.0, 300.0);
        let wish = intent(&mut app);
        assert!((wish.widen + 2_f64.ln()).abs() < 1e-5 && wish.turn_deg == 0.0, "{wish:?}");
    }

    #[test]
    fn examining_has_keys_of_its_own() {
        let mut app = app();
        let walker = app.world_mut().spawn(Walker).id();
        app.update();
        app.world_mut().resource_mut::<ButtonInput<KeyCode>>().press(KeyCode::KeyW);
        let wish = intent(&mut app);
        assert_eq!((wish.go.y, wish.near), (1.0, 0.0));
        app.world_mut().resource_mut::<ButtonInput<KeyCode>>().release(KeyCode::KeyW);
        app.world_mut().get_mut::<crate::Gait>(walker).expect("a walker has one").examine_for_test();
        app.update();
        app.world_mut().resource_mut::<ButtonInput<KeyCode>>().press(KeyCode::KeyW);
        let wish = intent(&mut app);
        assert_eq!((wish.go.y, wish.near), (0.0, 0.1));
    }
}
