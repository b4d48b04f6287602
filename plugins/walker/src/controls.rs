//! What a walker can do: its controls, and when they are heard.

use bevy::input::gamepad::GamepadButton as Pad;
use bevy::prelude::*;
use veduta_controls::{Always, ControlsAppExt, Input, Scope, Stick, Way, control};
use veduta_ecs::Words;

use crate::{Gait, Walker};

/// On foot and in the air.
#[derive(Component, Debug, Clone, Copy, Default)]
pub struct Moving;

impl Scope for Moving {
    const NAME: &'static str = "moving";
    const NEVER_WITH: &'static [&'static str] = &["examining"];
}

/// On foot.
#[derive(Component, Debug, Clone, Copy, Default)]
pub struct OnFoot;

impl Scope for OnFoot {
    const NAME: &'static str = "foot";
    const NEVER_WITH: &'static [&'static str] = &["air", "examining"];
}

/// In the air.
#[derive(Component, Debug, Clone, Copy, Default)]
pub struct InAir;

impl Scope for InAir {
    const NAME: &'static str = "air";
    const NEVER_WITH: &'static [&'static str] = &["examining"];
}

/// Going round a point of the city.
#[derive(Component, Debug, Clone, Copy, Default)]
pub struct Examining;

impl Scope for Examining {
    const NAME: &'static str = "examining";
}

/// What a key gives of the speed at which a stick turns the head.
const KEY_TURNS: f32 = 70.0 / 120.0;

control! {
    /// Walks, or flies, ahead.
    pub WalkForward: Moving = "walk.forward", [
        Input::key(KeyCode::KeyW), Input::key(KeyCode::ArrowUp), Input::Stick(Stick::Left, Way::Up), Input::TouchStick(Way::Up),
    ];
    /// Walks, or flies, back.
    pub WalkBack: Moving = "walk.back", [
        Input::key(KeyCode::KeyS), Input::key(KeyCode::ArrowDown), Input::Stick(Stick::Left, Way::Down), Input::TouchStick(Way::Down),
    ];
    /// Steps left.
    pub StepLeft: Moving = "walk.left", [
        Input::key(KeyCode::KeyA), Input::Stick(Stick::Left, Way::Left), Input::TouchStick(Way::Left),
    ];
    /// Steps right.
    pub StepRight: Moving = "walk.right", [
        Input::key(KeyCode::KeyD), Input::Stick(Stick::Left, Way::Right), Input::TouchStick(Way::Right),
    ];
    /// Hurries as long as it is held.
    pub Run: Moving = "walk.run", [Input::key(KeyCode::ShiftLeft), Input::key(KeyCode::ShiftRight), Input::Pad(Pad::LeftThumb)];
    /// Flies, and lands.
    pub Fly: Always = "walk.fly", [Input::key(KeyCode::KeyF), Input::Pad(Pad::North)];
    /// Goes round what the eye looks at, and walks on.
    pub Examine: Always = "walk.examine", [Input::key(KeyCode::KeyO), Input::Pad(Pad::RightThumb)];
    /// Looks around by the mouse as long as it is held.
    pub LookHold: Always = "look.hold", [Input::mouse(MouseButton::Right)];
    /// Turns left.
    pub LookLeft: Always = "look.left", [Input::key(KeyCode::ArrowLeft), Input::Stick(Stick::Right, Way::Left)],
        key_share: KEY_TURNS, curve: 1.7;
    /// Turns right.
    pub LookRight: Always = "look.right", [Input::key(KeyCode::ArrowRight), Input::Stick(Stick::Right, Way::Right)],
        key_share: KEY_TURNS, curve: 1.7;
    /// Looks up.
    pub LookUp: Always = "look.up", [Input::Stick(Stick::Right, Way::Up)], key_share: KEY_TURNS, curve: 1.7;
    /// Looks down.
    pub LookDown: Always = "look.down", [Input::Stick(Stick::Right, Way::Down)], key_share: KEY_TURNS, curve: 1.7;
    /// Takes the first field of view.
    pub ViewNarrow: Always = "view.narrow", [Input::key(KeyCode::Digit1)];
    /// Takes the second.
    pub ViewNatural: Always = "view.natural", [Input::key(KeyCode::Digit2)];
    /// Takes the third.
    pub ViewWide: Always = "view.wide", [Input::key(KeyCode::Digit3)];
    /// Takes the one after that which was taken last.
    pub ViewNext: Always = "view.next", [Input::Pad(Pad::DPadUp)];
    /// Lowers the eyes.
    pub EyeLower: OnFoot = "eye.lower", [Input::key(KeyCode::PageDown), Input::Pad(Pad::DPadLeft)];
    /// Raises the eyes.
    pub EyeHigher: OnFoot = "eye.higher", [Input::key(KeyCode::PageUp), Input::Pad(Pad::DPadRight)];
    /// Rises.
    pub Rise: InAir = "fly.rise", [Input::key(KeyCode::Space), Input::Pad(Pad::RightTrigger2)];
    /// Sinks.
    pub Sink: InAir = "fly.sink", [Input::key(KeyCode::KeyC), Input::Pad(Pad::LeftTrigger2)];
    /// Turns what is examined by the mouse as long as it is held.
    pub ExamineDrag: Examining = "examine.drag", [Input::mouse(MouseButton::Left)];
    /// Comes nearer.
    pub Nearer: Examining = "examine.nearer", [
        Input::Wheel(Way::Up), Input::key(KeyCode::KeyW), Input::key(KeyCode::ArrowUp), Input::Stick(Stick::Left, Way::Up),
        Input::TouchStick(Way::Up),
    ];
    /// Goes farther off.
    pub Farther: Examining = "examine.farther", [
        Input::Wheel(Way::Down), Input::key(KeyCode::KeyS), Input::key(KeyCode::ArrowDown), Input::Stick(Stick::Left, Way::Down),
        Input::TouchStick(Way::Down),
    ];
}

/// What controls do, by language.
pub(crate) const WORDS: [(&str, &str); 3] =
    [("en", include_str!("../words/en.ftl")), ("cs", include_str!("../words/cs.ftl")), ("it", include_str!("../words/it.ftl"))];

/// Adds the walker's controls to the list, without anything that they do.
pub fn add_controls(app: &mut App) {
    Words::bring(app, &WORDS);
    app.add_scope::<Moving, _>(|gaits: Gaits<'_, '_>| gaits.iter().all(|gait| !gait.is_examining()))
        .add_scope::<OnFoot, _>(|gaits: Gaits<'_, '_>| gaits.iter().all(|gait| !gait.is_examining() && !gait.flying))
        .add_scope::<InAir, _>(|gaits: Gaits<'_, '_>| gaits.iter().any(|gait| gait.flying && !gait.is_examining()))
        .add_scope::<Examining, _>(|gaits: Gaits<'_, '_>| gaits.iter().any(Gait::is_examining));
    app.add_control::<WalkForward>()
        .add_control::<WalkBack>()
        .add_control::<StepLeft>()
        .add_control::<StepRight>()
        .add_control::<Run>()
        .add_control::<Fly>()
        .add_control::<Examine>()
        .add_control::<LookHold>()
        .add_control::<LookLeft>()
        .add_control::<LookRight>()
        .add_control::<LookUp>()
        .add_control::<LookDown>()
        .add_control::<ViewNarrow>()
        .add_control::<ViewNatural>()
        .add_control::<ViewWide>()
        .add_control::<ViewNext>()
        .add_control::<EyeLower>()
        .add_control::<EyeHigher>()
        .add_control::<Rise>()
        .add_control::<Sink>()
        .add_control::<ExamineDrag>()
        .add_control::<Nearer>()
        .add_control::<Farther>();
}

type Gaits<'w, 's> = Query<'w, 's, &'static Gait, With<Walker>>;
