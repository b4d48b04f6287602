//! Places and their information: what stands near the visitor, said when it matters.
//!
//! ```text
//!  City.overviews, Eye ──► near (with hysteresis) ──► PlaceEntered / PlaceLeft ──► panel
//! ```
//!
//! # Use
//! ```no_run
//! use bevy::prelude::*;
//! use veduta_guide::{GuidePlugin, PlaceEntered};
//!
//! App::new()
//!     .add_plugins((DefaultPlugins, GuidePlugin::default()))
//!     .add_systems(Update, |mut entered: MessageReader<PlaceEntered>| {
//!         for place in entered.read() { info!("{}", place.name); }
//!     })
//!     .run();
//! ```
//! It reads the [`City`](veduta_ecs::City) resource; in a game without streaming, insert one of your own with an overview that has places.
//!
//! # Limits
//! One place at a time: the one whose middle is nearest for its radius.
//!
//! # Rejected
//! Trigger volumes as entities: ten thousand places would cost every frame; here only the nearest are looked at.

mod near;
mod panel;

use bevy::prelude::*;
use bevy_egui::{EguiPlugin, EguiPrimaryContextPass};
use veduta_ecs::VedutaSystems;

pub use near::{NearPlace, PlaceEntered, PlaceLeft};
pub use panel::PanelSettings;

/// Tells what stands near the visitor.
#[derive(Debug, Clone, Copy)]
pub struct GuidePlugin {
    /// Whether the panel is drawn.
    pub interface: bool,
}

impl Default for GuidePlugin {
    fn default() -> Self {
        Self { interface: true }
    }
}

impl Plugin for GuidePlugin {
    fn build(&self, app: &mut App) {
        veduta_ecs::ensure(app);
        app.init_resource::<NearPlace>()
            .init_resource::<PanelSettings>()
            .add_message::<PlaceEntered>()
            .add_message::<PlaceLeft>()
            .add_systems(Update, near::find_near.in_set(VedutaSystems::Show));
        if self.interface {
            if !app.is_plugin_added::<EguiPlugin>() {
                app.add_plugins(EguiPlugin::default());
            }
            app.add_systems(EguiPrimaryContextPass, panel::draw_panel);
        }
    }
}
