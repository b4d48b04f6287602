use bevy::prelude::*;
use bevy_enhanced_input::prelude::InputAction;

use crate::Input;

/// When a control is heard: a context, and a heading in the list that a visitor sees.
///
/// A scope is a component of [`bevy_enhanced_input`]'s kind of context; [`ControlsAppExt::add_scope`](crate::ControlsAppExt::add_scope)
/// says when it is active. Its heading is the Fluent message `scope-` followed by its name.
pub trait Scope: Component + Default {
    /// Its name in lists and messages: lower-case letters.
    const NAME: &'static str;
    /// Names of scopes that are never active together with it: one input may do a thing in each. It is enough that one of two says so.
    const NEVER_WITH: &'static [&'static str] = &[];
    /// Scopes of a higher number are heard first.
    const PRIORITY: usize = 0;
}

/// Always active.
#[derive(Component, Debug, Clone, Copy, Default)]
pub struct Always;

impl Scope for Always {
    const NAME: &'static str = "always";
    const PRIORITY: usize = 10;
}

/// Something that a visitor can do: an action of [`bevy_enhanced_input`] with a name. How much of it is wanted is told from 0 to 1.
///
/// What it does is said by the Fluent message `control-` followed by its name, with hyphens for the points in it. Controls are
/// declared with [`control!`](crate::control!).
pub trait Control: InputAction<Output = f32> {
    /// When it is heard.
    type Scope: Scope;
    /// Its name in files: words in lower case with points between, such as `walk.forward`.
    const NAME: &'static str;
    /// What it is bound to at first.
    const DEFAULTS: &'static [Input];
    /// How much of it a key or a button of the mouse gives.
    const KEY_SHARE: f32 = 1.0;
    /// Exponent of the response to a stick: over 1, small pushes are finer.
    const CURVE: f32 = 1.0;
}

/// Name of the message that says what a control does.
#[must_use]
pub fn message_of(control: &str) -> String {
    format!("control-{}", control.replace('.', "-"))
}

/// Declares controls: documentation, type, scope, name and what they are bound to at first.
///
/// ```
/// use bevy::prelude::*;
/// use veduta_controls::{Always, Control, Input, control};
///
/// control! {
///     /// Rings the bell.
///     pub RingBell: Always = "bell.ring", [Input::key(KeyCode::KeyB), Input::Pad(GamepadButton::South)];
///     /// Turns the wheel.
///     pub TurnWheel: Always = "wheel.turn", [Input::key(KeyCode::KeyR)], key_share: 0.5, curve: 2.0;
/// }
/// assert_eq!((RingBell::NAME, TurnWheel::KEY_SHARE), ("bell.ring", 0.5));
/// ```
#[macro_export]
macro_rules! control {
    ($($(#[$doc:meta])* $vis:vis $name:ident: $scope:ty = $says:literal, [$($input:expr),* $(,)?]
        $(, key_share: $share:expr)? $(, curve: $curve:expr)?;)+) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy)]
        $vis struct $name;

        impl $crate::InputAction for $name {
            type Output = f32;
        }

        impl $crate::Control for $name {
            type Scope = $scope;
            const NAME: &'static str = $says;
            const DEFAULTS: &'static [$crate::Input] = &[$($input),*];
            $(const KEY_SHARE: f32 = $share;)?
            $(const CURVE: f32 = $curve;)?
        }
    )+};
}
