//! Controls for tests.

use std::time::Duration;

use bevy::input::keyboard::{Key, KeyboardInput, NativeKey};
use bevy::input::mouse::MouseButtonInput;
use bevy::input::{ButtonState, InputPlugin};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;

use crate::{Always, ControlList, ControlsAppExt, Input, Scope, Stick, Way, control};

#[derive(Component, Default)]
pub(crate) struct OnFoot;

impl Scope for OnFoot {
    const NAME: &'static str = "foot";
}

#[derive(Component, Default)]
pub(crate) struct InAir;

impl Scope for InAir {
    const NAME: &'static str = "air";
    const NEVER_WITH: &'static [&'static str] = &["foot"];
}

control! {
    pub(crate) Forward: Always = "walk.forward", [Input::key(KeyCode::KeyW), Input::Stick(Stick::Left, Way::Up)], curve: 2.0;
    pub(crate) Run: Always = "walk.run", [Input::key(KeyCode::KeyR)], key_share: 0.5;
    pub(crate) Bow: OnFoot = "walk.bow", [Input::key(KeyCode::KeyB)];
    pub(crate) Dive: InAir = "fly.dive", [Input::key(KeyCode::KeyB)];
    pub(crate) Find: Always = "find", [Input::Letter('/')];
    pub(crate) Shine: Always = "shine", [Input::key(KeyCode::F9)];
    pub(crate) End: Always = "end", [Input::ctrl(KeyCode::KeyQ)];
}

/// Whether somebody flies.
#[derive(Resource, Default)]
pub(crate) struct Flies(pub bool);

fn declare(app: &mut App) {
    app.init_resource::<Flies>()
        .add_scope::<OnFoot, _>(|flies: Res<Flies>| !flies.0)
        .add_scope::<InAir, _>(|flies: Res<Flies>| flies.0)
        .add_control::<Forward>()
        .add_control::<Run>()
        .add_control::<Bow>()
        .add_control::<Dive>()
        .add_control::<Find>()
        .add_control::<Shine>()
        .add_control::<End>();
}

/// Keys of a keyboard and buttons of a mouse go down, or up: what the engine is told by the system.
pub(crate) fn turn(app: &mut App, keys: &[KeyCode], buttons: &[MouseButton], state: ButtonState) {
    let window = Entity::PLACEHOLDER;
    for &key_code in keys {
        let logical_key = Key::Unidentified(NativeKey::Unidentified);
        app.world_mut().write_message(KeyboardInput { key_code, logical_key, state, text: None, repeat: false, window });
    }
    for &button in buttons {
        app.world_mut().write_message(MouseButtonInput { button, state, window });
    }
    app.update();
}

/// The list of controls.
pub(crate) fn list() -> ControlList {
    let mut app = App::new();
    declare(&mut app);
    app.world_mut().remove_resource::<ControlList>().expect("declared")
}

/// An app with these controls, whose frames take a tenth of a second.
pub(crate) fn app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, InputPlugin)).insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(100)));
    declare(&mut app);
    app.finish();
    app.cleanup();
    app.update();
    app
}
