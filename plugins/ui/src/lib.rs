//! How interfaces look: paper, ink and symbols that plugins with windows share, and links that are opened only after asking.
//!
//! ```text
//!  Interface (ecs) ──► Look ──► what tour, minimap, guide and games draw
//!  fields with a cursor ──► Interface::is_typing ──► keys rest
//!  pictures by their paths ──► Pictures (decoded within limits) ──► panels
//!  links that are clicked ──► AskLink ──► "open this page?" ──► browser
//! ```
//!
//! Panels are functions of what they show: they take an [`egui::Ui`](bevy_egui::egui::Ui), a [`Look`] and values, and return what was
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

use bevy::prelude::*;
use bevy_egui::{EguiContexts, EguiPlugin, EguiPrimaryContextPass};
use veduta_ecs::{Interface, Words};

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
            .add_systems(PreUpdate, watch_typing.after(bevy_egui::EguiPreUpdateSet::BeginPass))
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

/// Keys belong to the interface while a field has the cursor or a control is chosen by the keyboard.
fn watch_typing(mut contexts: EguiContexts, mut interface: ResMut<Interface>) {
    let Ok(context) = contexts.ctx_mut() else { return };
    let is_typing = context.egui_wants_keyboard_input();
    if interface.is_typing != is_typing {
        interface.is_typing = is_typing;
    }
}
