//! Veduta: a city you can walk through, as Bevy plugins.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use veduta::prelude::*;
//!
//! fn main() {
//!     App::new()
//!         .add_plugins((DefaultPlugins, VedutaPlugins))
//!         .insert_resource(OpenCity("old_prague.city".into()))
//!         .add_systems(Startup, |mut commands: Commands| { commands.spawn((Camera3d::default(), Walker)); })
//!         .run();
//! }
//! ```
//! `OpenCity` takes a directory baked by `veduta-bake`, or the URL of one on any web server.
//!
//! | plugin | what it adds | alone |
//! |---|---|---|
//! | [`streaming`] | cells that come and go around the viewer | tells you what to spawn |
//! | [`buildings`] | meshes of houses, ground and objects | from cells of your own |
//! | [`facade`] | levels of detail without a seam | on meshes of your own |
//! | [`tour`] | guided tours in RON | in any scene |
//! | [`minimap`] | minimap and full map | of any plan |
//! | [`walker`] | walking, flying, jumping | in any cells |
//! | [`sky`] | sun, sky, fog, night | anywhere |
//! | [`guide`] | places and their information, search, being led | in any scene |
//! | [`life`] | what moves: flags, smoke, water, birds, clocks | in any scene |
//! | [`sound`] | what is heard | in any scene |
//! | [`controls`] | keys, mouse, gamepad and touch, by name | anywhere |
//! | [`ui`] | how windows look, for a game's own | anywhere |
//!
//! # Limits
//! One open city at a time.
//!
//! # Rejected
//! Cargo features for every plugin: leave a plugin out of the group instead.

use bevy::app::{PluginGroup, PluginGroupBuilder};

pub use veduta_buildings as buildings;
pub use veduta_city as city;
pub use veduta_controls as controls;
pub use veduta_ecs as ecs;
pub use veduta_facade as facade;
pub use veduta_guide as guide;
pub use veduta_life as life;
pub use veduta_minimap as minimap;
pub use veduta_sky as sky;
pub use veduta_sound as sound;
pub use veduta_streaming as streaming;
pub use veduta_tour as tour;
pub use veduta_ui as ui;
pub use veduta_walker as walker;

/// All of Veduta, for a game with a window.
#[derive(Debug, Clone, Copy, Default)]
pub struct VedutaPlugins;

impl PluginGroup for VedutaPlugins {
    fn build(self) -> PluginGroupBuilder {
        PluginGroupBuilder::start::<Self>()
            .add(ecs::EcsPlugin)
            .add(streaming::StreamingPlugin::default())
            .add(buildings::BuildingsPlugin::default())
            .add(facade::FacadePlugin::default())
            .add(sky::SkyPlugin)
            .add(walker::WalkerPlugin::default())
            .add(tour::TourPlugin::default())
            .add(minimap::MinimapPlugin)
            .add(guide::GuidePlugin::default())
            .add(life::LifePlugin)
            .add(sound::SoundPlugin)
    }
}

/// Veduta without anything that draws or reads input: for servers, tests and tools.
#[derive(Debug, Clone, Copy, Default)]
pub struct VedutaMinimalPlugins;

impl PluginGroup for VedutaMinimalPlugins {
    fn build(self) -> PluginGroupBuilder {
        PluginGroupBuilder::start::<Self>()
            .add(ecs::EcsPlugin)
            .add(streaming::StreamingPlugin::default())
            .add(tour::TourPlugin { interface: false })
            .add(guide::GuidePlugin { interface: false })
    }
}

/// What most games need.
pub mod prelude {
    pub use crate::buildings::BuildingsPlugin;
    pub use crate::ecs::{
        CellEntered, CellReady, CellReleased, CellStands, City, CityClock, CityFailed, CityOpened, Eye, Footing, Ground, JumpTo,
        OpenCity, Steering, VedutaSystems, Viewer, Weather,
    };
    pub use crate::facade::{FacadePlugin, LevelDistances};
    pub use crate::guide::GuidePlugin;
    pub use crate::life::{LifePlugin, LifeSettings};
    pub use crate::minimap::{MinimapPlugin, MinimapSettings};
    pub use crate::sky::SkyPlugin;
    pub use crate::streaming::{StreamingPlugin, StreamingSettings};
    pub use crate::tour::{TourCommand, TourEnded, TourPlayer, TourPlugin};
    pub use crate::walker::{Walker, WalkerPlugin, WalkerSettings};
    pub use crate::{VedutaMinimalPlugins, VedutaPlugins};
}
