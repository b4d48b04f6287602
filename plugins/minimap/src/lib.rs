//! Minimap HUD and full map.
//!
//! ```text
//!  City.overviews ──as they come──► tiles of triangles ──each frame──► those in view, turned and scaled ──► egui
//!        └────────► Named ──lay_out, now and then, beside the frame──► names, signs, pictures ──each frame──► egui
//! ```
//!
//! The map is drawn from the city's own vectors: streets, squares, houses, parks, water, with names. The walker's place and
//! heading are live, and so are the way that he is led, where he has been and where the open tour leads. A click on the large map jumps to the
//! place or street under it, and with Shift asks for a walk there ([`WalkTo`](veduta_ecs::WalkTo)).
//!
//! # Use
//! ```no_run
//! use bevy::prelude::*;
//! use veduta_minimap::MinimapPlugin;
//!
//! App::new().add_plugins((DefaultPlugins, MinimapPlugin)).run();
//! ```
//! It shows the [`City`](veduta_ecs::City) resource's overview around the first [`Viewer`](veduta_ecs::Viewer); in a game without
//! streaming, insert a `City` of your own.
//!
//! Its [`controls`], whose keys a visitor may change ([`veduta_controls`]); at first they are:
//!
//! | control | keyboard and mouse | gamepad | touch |
//! |---|---|---|---|
//! | large map | M | view | a tap on the map |
//! | be there, walk there (large map) | click, Shift+click | | a tap |
//! | be put down where you let go (large map) | drag yourself | | |
//! | north up or heading up | N | | |
//! | zoom | +, − or wheel | | two fingers |
//!
//! The large map has switches for its layers, and asks for itself to be saved ([`ExportMap`]): whoever may write files does so.
//!
//! # Limits
//! Names are laid out beside the frame, when the scale, the turn or the part shown has changed by a step; till then those of before
//! are shown.
//!
//! # Rejected
//! A second camera from above (draws the whole city twice, and roofs hide the streets' names).

pub mod controls;
mod draw;
mod export;
mod names;
mod panel;
mod tiles;
mod trail;
mod view;

use bevy::prelude::*;
use bevy_egui::EguiPrimaryContextPass;
use veduta_cartography::Layers;
use veduta_ui::UiSystems;

pub use controls::add_controls;
pub use export::{ExportMap, MapFormat};
pub use names::MapNames;
pub use tiles::MapTiles;
pub use trail::Trail;
pub use view::MapView;

/// Draws the map.
#[derive(Debug, Clone, Copy, Default)]
pub struct MinimapPlugin;

/// How the minimap looks. Live.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Resource)]
pub struct MinimapSettings {
    /// Whether it is shown at all.
    pub visible: bool,
    /// Edge of the map in the corner as a share of the window's height.
    pub share: f32,
    /// Metres from the middle to the edge of the map in the corner.
    pub radius_m: f32,
    /// Whether that corner is a left one, and whether an upper one.
    pub left: bool,
    /// See [`MinimapSettings::left`].
    pub top: bool,
    /// Whether north stays up; else the walker's heading does.
    pub north_up: bool,
    /// Whether streets, squares, water and parks are named.
    pub names: bool,
    /// Whether sights and houses with a name are marked.
    pub symbols: bool,
    /// Whether spots with a view are marked.
    pub views: bool,
    /// Whether landmarks are drawn as small pictures.
    pub landmarks: bool,
    /// Whether the way is shown that the visitor is led.
    pub route: bool,
    /// Whether it is shown where the visitor has been.
    pub trail: bool,
    /// Whether it is shown where the open tour leads.
    pub tour: bool,
    /// Whether the inks are told apart with any two kinds of cones. High contrast goes before.
    pub colour_blind_safe: bool,
}

impl MinimapSettings {
    /// The layers that are shown.
    #[must_use]
    pub const fn layers(&self) -> Layers {
        let &Self { names, symbols, views, landmarks, route, trail, tour, .. } = self;
        Layers { names, places: symbols, views, landmarks, trees: true, route, tour, trail }
    }
}

impl Default for MinimapSettings {
    fn default() -> Self {
        Self {
            visible: true,
            share: 0.3,
            radius_m: 110.0,
            left: false,
            top: false,
            north_up: false,
            names: true,
            symbols: true,
            views: true,
            landmarks: true,
            route: true,
            trail: true,
            tour: true,
            colour_blind_safe: false,
        }
    }
}

/// What the interface says, by language.
const WORDS: [(&str, &str); 3] =
    [("en", include_str!("../words/en.ftl")), ("cs", include_str!("../words/cs.ftl")), ("it", include_str!("../words/it.ftl"))];

impl Plugin for MinimapPlugin {
    fn build(&self, app: &mut App) {
        veduta_ecs::ensure(app);
        veduta_ui::ensure(app);
        controls::add_controls(app);
        app.init_resource::<MinimapSettings>()
            .init_resource::<MapTiles>()
            .init_resource::<MapNames>()
            .add_message::<ExportMap>()
            .init_resource::<MapView>()
            .init_resource::<Trail>()
            .register_type::<MinimapSettings>()
            .add_systems(
                Update,
                (tiles::ask_for_overview, tiles::cut_tiles, names::gather, controls::read_keys, view::show_asked, trail::note),
            )
            .add_systems(EguiPrimaryContextPass, draw::draw_map.in_set(UiSystems::Draw));
    }
}
