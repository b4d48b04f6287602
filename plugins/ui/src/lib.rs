//! How interfaces look: paper, ink and symbols that plugins with windows share, and links that are opened only after asking.
//!
//! ```text
//!  Interface (ecs) ──► Look ──► what tour, minimap, guide and games draw
//!  fields with a cursor, lists that hang open ──► Interface::is_typing ──► keys rest
//!  pointers over windows ──► PointersTaken ──► they mean nothing in the city
//!  pictures by their paths ──► Pictures (decoded within limits) ──► panels
//!  links that are clicked ──► AskLink ──► "open this page?" ──► browser
//! ```
//!
//! Panels are functions of what they show: they take an [`egui::Ui`], a [`Look`] and values, and return what was
//! chosen. So each can be driven in a test without an engine, and every control has a name that screen readers say.
//!
//! # Limits
//! One window.
//!
//! # Rejected
//! The engine's own interface nodes: no fields to type into, and no names for screen readers that tests could ask for.

mod ask;
mod look;
mod picture;
mod symbol;

use bevy::input::touch::Touches;
use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use bevy_egui::{EguiContexts, EguiPlugin, EguiPreUpdateSet, EguiPrimaryContextPass, egui};
use veduta_ecs::{Interface, InterfaceSystems, PointersTaken, Words};

pub use ask::{AskLink, ask_panel};
pub use look::{Look, Surface};
pub use picture::{LARGEST_BYTES, MOST_PIXELS, PictureAsset, PictureError, PictureLoadError, Pictures};
pub use symbol::{Symbol, symbol_button};

/// Shared parts of interfaces. Every plugin that draws one adds it if it is missing.
#[derive(Debug, Default, Clone, Copy)]
pub struct UiPlugin;

impl Plugin for UiPlugin {
    fn build(&self, app: &mut App) {
        veduta_ecs::ensure(app);
        if !app.is_plugin_added::<EguiPlugin>() {
            app.add_plugins(EguiPlugin::default());
        }
        Words::bring(
            app,
            &[
                ("en", include_str!("../words/en.ftl")),
                ("cs", include_str!("../words/cs.ftl")),
                ("it", include_str!("../words/it.ftl")),
            ],
        );
        app.init_resource::<AskLink>()
            .init_resource::<picture::Shelf>()
            .add_systems(
                PreUpdate,
                (watch_typing, watch_pointers).after(EguiPreUpdateSet::ProcessInput).in_set(InterfaceSystems::Watch),
            )
            .add_systems(EguiPrimaryContextPass, ask::ask.in_set(UiSystems::Ask))
            .configure_sets(EguiPrimaryContextPass, (UiSystems::Draw, UiSystems::Ask).chain());
    }

    fn finish(&self, app: &mut App) {
        if app.world().contains_resource::<AssetServer>() {
            app.init_asset::<PictureAsset>()
                .register_asset_loader(picture::PictureLoader)
                .add_systems(Update, picture::tell_failures);
        }
    }

    fn is_unique(&self) -> bool {
        true
    }
}

/// Order of a frame's interfaces, within [`EguiPrimaryContextPass`].
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum UiSystems {
    /// Panels are drawn.
    Draw,
    /// Links that were clicked are asked about.
    Ask,
}

/// Adds the shared parts unless another plugin has done so.
pub fn ensure(app: &mut App) {
    if !app.is_plugin_added::<UiPlugin>() {
        app.add_plugins(UiPlugin);
    }
}

/// Keys belong to the interface while a field has the cursor, a control is chosen by the keyboard, or a list hangs open.
fn watch_typing(mut contexts: EguiContexts, mut interface: ResMut<Interface>, mut was_typing: Local<bool>) {
    let Ok(context) = contexts.ctx_mut() else { return };
    let types = context.egui_wants_keyboard_input() || egui::Popup::is_any_open(context);
    // The Escape that leaves a field is the field's own.
    let leaves = *was_typing && context.input(|input| input.key_pressed(egui::Key::Escape));
    *was_typing = types;
    let is_typing = types || leaves;
    if interface.is_typing != is_typing {
        interface.is_typing = is_typing;
    }
}

/// Pointers belong to the interface that are over something of it, or have begun there. Where they are, the window says: the interface itself
/// hears of it only when it is drawn, after what has been clicked in the city.
fn watch_pointers(
    mut contexts: EguiContexts,
    windows: Query<&Window, With<PrimaryWindow>>,
    touches: Option<Res<Touches>>,
    mut taken: ResMut<PointersTaken>,
) {
    let Ok(context) = contexts.ctx_mut() else { return };
    let is_over = |at: Vec2| {
        let at = at / context.zoom_factor();
        context.layer_id_at(egui::pos2(at.x, at.y)).is_some_and(|layer| layer.order != egui::Order::Background)
    };
    let cursor = windows.single().ok().and_then(Window::cursor_position);
    let mouse = context.egui_is_using_pointer() || cursor.is_some_and(is_over);
    let mut fingers = taken.touches.clone();
    if let Some(touches) = touches {
        fingers.extend(touches.iter_just_pressed().filter(|touch| is_over(touch.position())).map(|touch| touch.id()));
        // A finger that is lifted is known until its last word has been heard.
        fingers.retain(|id| touches.get_pressed(*id).is_some() || touches.just_released(*id) || touches.just_canceled(*id));
    }
    taken.set_if_neq(PointersTaken { mouse, touches: fingers });
}

#[cfg(test)]
mod tests {
    use bevy_egui::{EguiContext, EguiUserTextures, PrimaryEguiContext};

    use super::*;

    #[test]
    fn a_pointer_is_taken_in_the_very_frame_in_which_it_comes_over_a_window() {
        let mut app = App::new();
        app.add_plugins(MinimalPlugins)
            .init_resource::<EguiUserTextures>()
            .init_resource::<PointersTaken>()
            .add_systems(Update, watch_pointers);
        let window = app.world_mut().spawn((Window::default(), PrimaryWindow)).id();
        let mut own = EguiContext::default();
        let context = own.get_mut().clone();
        app.world_mut().spawn((own, PrimaryEguiContext));
        let draw = |zoom: f32| {
            context.set_zoom_factor(zoom);
            for _ in 0..3 {
                let mut drawn = context.run_ui(egui::RawInput::default(), |ui| {
                    let area = egui::Area::new(egui::Id::new("a panel")).fixed_pos((100.0, 100.0));
                    area.show(ui.ctx(), |ui| ui.allocate_space(egui::vec2(200.0, 50.0)));
                });
                drawn.textures_delta.clear();
            }
        };
        let mut is_taken = |at: Option<Vec2>| {
            app.world_mut().get_mut::<Window>(window).expect("spawned").set_cursor_position(at);
            app.update();
            app.world().resource::<PointersTaken>().mouse
        };
        draw(1.0);
        assert!(!is_taken(Some(Vec2::new(50.0, 120.0))));
        assert!(is_taken(Some(Vec2::new(150.0, 120.0))));
        assert!(!is_taken(None), "it has left the window");
        draw(2.0);
        assert!(!is_taken(Some(Vec2::new(150.0, 120.0))));
        assert!(is_taken(Some(Vec2::new(590.0, 290.0))), "what is drawn twice as large");
    }
}
