//! What a visitor can press, by name: controls with the keys, mouse, gamepad and touch that they are bound to, which a visitor can change.
//!
//! ```text
//!  control! { … } ──add_control──► ControlList ──┐
//!  settings file ──read──► Controls (changes) ───┴─► bindings of bevy_enhanced_input
//!                              ▲                                 │
//!  next key ──Capture──────────┘      keys, mouse, pads ─────────┤
//!                                     sticks, wheel, letters, ───┘
//!                                     fingers ─► Touching, Tap        └──► Presses ──► walker, tour, map, guide, yours
//!  Controls, LastDevice, KeyCaps, Words ──► KeyNames ──► help, hints, tooltips
//!  Escape ──► Layers: one press closes one thing
//! ```
//!
//! # Use
//! Declare what can be done, add it to the list, read it:
//! ```
//! use bevy::input::InputPlugin;
//! use bevy::prelude::*;
//! use veduta_controls::{Always, ControlsAppExt, Input, Presses, control};
//!
//! // 1. Its name in files, and what it is bound to at first.
//! control! {
//!     /// Rings the bell.
//!     pub RingBell: Always = "bell.ring", [Input::key(KeyCode::KeyB), Input::Pad(GamepadButton::South)];
//! }
//!
//! #[derive(Resource, Default)]
//! struct Rung(u32);
//!
//! // 3. What it does.
//! fn ring(presses: Presses, mut rung: ResMut<Rung>) {
//!     rung.0 += u32::from(presses.begins::<RingBell>());
//! }
//!
//! let mut app = App::new();
//! // 2. It stands on the list, with all others.
//! app.add_plugins((MinimalPlugins, InputPlugin)).init_resource::<Rung>().add_control::<RingBell>().add_systems(Update, ring);
//! // `App::run` does this by itself.
//! app.finish();
//! app.update();
//! app.world_mut().resource_mut::<ButtonInput<KeyCode>>().press(KeyCode::KeyB);
//! app.update();
//! assert_eq!(app.world().resource::<Rung>().0, 1);
//! ```
//! What it does is told to visitors by the message `control-bell-ring` in your own [`Words`]. Observers of
//! [`bevy_enhanced_input`] work as well: `On<Start<RingBell>>`.
//!
//! A visitor's changes are the resource [`Controls`]: change it, and bindings follow. [`Controls::written`] and [`Controls::read`] are for
//! files, [`Controls::others`] tells of what an input does besides, [`Capture`] waits for the next input.
//!
//! # When controls are heard
//! Each control has a [`Scope`], a context of [`bevy_enhanced_input`]. Keys rest while somebody types
//! ([`Interface::is_typing`](veduta_ecs::Interface)), and go on resting until all are let go; the mouse rests over windows
//! ([`PointersTaken`](veduta_ecs::PointersTaken)); all rests while [`Capture`] waits. `Shift+F` is not `F` too, where it is bound in the
//! same scope or one that is heard sooner.
//!
//! # Limits
//! One visitor: all gamepads do the same. Scopes and controls are added before the app runs. Keys are bound by place or by what they write; what
//! they have written on them is learned when they are pressed, and shown as on an American keyboard till then. Buttons of gamepads
//! are named as most have them, whoever made this one. While somebody types, other contexts of `bevy_enhanced_input` hear no keys
//! either: its [`ActionSources`](bevy_enhanced_input::prelude::ActionSources) are set here.
//!
//! # Rejected
//! Reading `ButtonInput` in each plugin (no list to show, nothing to change), leafwing-input-manager (one enum of actions a game, where
//! plugins of strangers need each their own), half axes as modifiers on a gamepad's axes (a dead zone an axis draws a stick
//! towards the axes; sticks are felt whole here), bindings of numbers or of the engine's own types in files (nobody writes those by hand).

mod capture;
mod controls;
mod declare;
mod device;
mod input;
mod layers;
mod list;
mod names;
mod presses;
mod sense;
#[cfg(test)]
mod testing;
mod touch;

use bevy::input::InputSystems;
use bevy::input::keyboard::KeyboardInput;
use bevy::input::touch::TouchInput;
use bevy::prelude::*;
use bevy_enhanced_input::prelude::{EnhancedInputPlugin, EnhancedInputSystems};
use veduta_ecs::{InterfaceSystems, Words};

pub use bevy_enhanced_input;
pub use bevy_enhanced_input::prelude::{InputAction, ModKeys};
pub use capture::{Capture, Place};
pub use controls::{Conflict, ControlFinding, Controls, WrittenControls};
pub use declare::{Always, Control, Scope, message_of};
pub use device::LastDevice;
pub use input::{Device, Input, InputError, Stick, Way};
pub use layers::{CloseTop, Layers};
pub use list::{ControlList, ControlsAppExt, Listed};
pub use names::{KeyCaps, KeyNames, label};
pub use presses::Presses;
pub use sense::StickSettings;
pub use touch::{Tap, Touching};

/// Hears what a visitor presses. Every plugin with controls adds it if it is missing.
#[derive(Debug, Default, Clone, Copy)]
pub struct ControlsPlugin;

/// What the interface says, by language.
const WORDS: [(&str, &str); 3] =
    [("en", include_str!("../words/en.ftl")), ("cs", include_str!("../words/cs.ftl")), ("it", include_str!("../words/it.ftl"))];

/// The order of a frame's controls, in [`PreUpdate`].
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ControlsSystems {
    /// Scopes become active or not.
    Scopes,
    /// Devices are felt, and what rests is told.
    Sense,
    /// Actions are evaluated; from then on [`Presses`] tells of this frame.
    Hear,
}

impl Plugin for ControlsPlugin {
    fn build(&self, app: &mut App) {
        veduta_ecs::ensure(app);
        if !app.is_plugin_added::<EnhancedInputPlugin>() {
            app.add_plugins(EnhancedInputPlugin);
        }
        Words::bring(app, &WORDS);
        app.init_resource::<ControlList>()
            .init_resource::<Controls>()
            .init_resource::<sense::Sensed>()
            .init_resource::<sense::Tapped>()
            .init_resource::<StickSettings>()
            .init_resource::<touch::Touching>()
            .init_resource::<Capture>()
            .init_resource::<LastDevice>()
            .init_resource::<Layers>()
            .init_resource::<KeyCaps>()
            .init_resource::<KeyNames>()
            .register_type::<StickSettings>()
            .add_message::<Tap>()
            .add_message::<KeyboardInput>()
            .add_message::<TouchInput>()
            .configure_sets(
                PreUpdate,
                (
                    (ControlsSystems::Scopes, ControlsSystems::Sense)
                        .chain()
                        .after(InputSystems)
                        .after(InterfaceSystems::Watch)
                        .before(EnhancedInputSystems::Prepare),
                    ControlsSystems::Hear.after(EnhancedInputSystems::Apply),
                ),
            )
            .add_systems(PreStartup, list::spawn)
            .add_systems(
                PreUpdate,
                (
                    capture::take,
                    list::bind.run_if(resource_changed::<Controls>.or_else(resource_changed::<ControlList>)),
                    sense::rest,
                    sense::hear_letters.run_if(resource_exists::<ButtonInput<KeyCode>>),
                    touch::feel,
                    sense::sense,
                    device::notice,
                    sense::hold_taps,
                )
                    .chain()
                    .in_set(ControlsSystems::Sense),
            )
            .add_systems(PreUpdate, (sense::release_taps, layers::close_top, names::tell).chain().in_set(ControlsSystems::Hear));
        app.add_scope::<Always, _>(|| true).add_control::<CloseTop>();
    }

    fn is_unique(&self) -> bool {
        true
    }
}

/// Adds the controls unless another plugin has done so.
pub fn ensure(app: &mut App) {
    // Within the plugin's own building its list is there already.
    if !app.is_plugin_added::<ControlsPlugin>() && !app.world().contains_resource::<ControlList>() {
        app.add_plugins(ControlsPlugin);
    }
}
