//! What moves in a city: water in its fountains, flags, smoke, pigeons that fly up, signs that swing, clocks that show the hour and figures
//! that pass when it strikes, bells.
//!
//! ```text
//!  X.life.ron ──► CityLife ─┐                         ┌─► shaders (cloth, water, smoke, wings: by time alone)
//!  City, cells that stand ──┴─► population ──► stage ─┤
//!  Eye, LifeSettings ─────────────────────────┘       └─► flocks, hands, signs, figures ◄── CityClock, Weather, Eye
//!  CityClock ──► bells ──► Cue (a sound plugin plays it)
//! ```
//!
//! Everything is a function of time and of what was drawn for it by its id: nothing runs that could run differently at another frame rate, so
//! films repeat exactly. Flocks decide on a grid of ticks, between which a viewer is taken to have gone straight.
//!
//! # Use
//! 1. Add the plugin. A city lives by rule then: pigeons on its squares, water in its fountains, smoke on winter evenings.
//! 2. Write `town.life.ron` beside the city ([`Life`](veduta_city::Life)); `veduta-bake check town.life.ron` finds mistakes.
//! 3. Ask for it with [`OpenLife`], or insert a [`CityLife`].
//!
//! ```no_run
//! use bevy::prelude::*;
//! use veduta_life::{LifePlugin, OpenLife};
//!
//! App::new()
//!     .add_plugins((DefaultPlugins, LifePlugin))
//!     .add_systems(Startup, |mut open: MessageWriter<OpenLife>| {
//!         open.write(OpenLife("town.life.ron".into()));
//!     })
//!     .run();
//! ```
//! What is seen of what a file tells has a [`Subject`](veduta_ecs::Subject) of its name, for tours that follow it with the eye: of a flock its middle.
//!
//! What it may cost is told by [`LifeSettings`], in vertices, birds and fires. It works in any scene with a
//! [`Viewer`](veduta_ecs::Viewer): `cargo run -p veduta-life --example life_alone`.
//!
//! # Limits
//! Pigeons do not see houses on the way: a flock wheels about the middle of its ground, over what stands there. Smoke and drops take no
//! shadows. Flags do not feel the walls that they hang before. A clock that stands (`pace: 0`) strikes only when it is set to an hour.
//!
//! # Rejected
//! Particles on the processor, or in compute shaders: the first cost every frame, the second are not in WebGL2. Boids: what a flock does would
//! depend on the frames that were shown; arcs that are planned once look alike from the ground. An entity for each bird: a flock is one mesh,
//! whose birds are placed by numbers in a uniform. Bells rung by a timer: they would not agree with the clock's hands.

mod act;
mod asset;
mod bird;
mod craft;
mod dial;
mod flock;
mod material;
mod pigeon;
mod population;
mod ring;
mod sculpt;
mod settings;
mod smoke;
mod spots;
mod stage;
mod strike;
mod water;
mod wind;

use bevy::prelude::*;
use veduta_ecs::VedutaSystems;

pub use act::WINGS;
pub use asset::{CityLife, LifeAsset, LifeLoadError, OpenLife};
pub use material::{LifeUniform, MistMaterial, SolidExtension, SolidKey, SolidMaterial, Told};
pub use settings::{LifeKinds, LifeSettings};
pub use stage::Living;
pub use wind::Wind;

/// Lets a city live.
#[derive(Debug, Clone, Copy, Default)]
pub struct LifePlugin;

/// What a frame of life consists of, within [`VedutaSystems::Show`].
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LifeSystems {
    /// Who lives where is found out.
    Settle,
    /// The clock is looked at, and bells are struck.
    Strike,
    /// It is chosen who is seen.
    Choose,
    /// They move.
    Act,
}

impl Plugin for LifePlugin {
    fn build(&self, app: &mut App) {
        veduta_ecs::ensure(app);
        app.init_resource::<LifeSettings>()
            .init_resource::<CityLife>()
            .init_resource::<population::Population>()
            .init_resource::<ring::Belfry>()
            .register_type::<LifeSettings>()
            .add_message::<OpenLife>()
            .configure_sets(
                Update,
                (LifeSystems::Settle, LifeSystems::Strike, LifeSystems::Choose, LifeSystems::Act)
                    .chain()
                    .in_set(VedutaSystems::Show),
            )
            .add_systems(Update, (population::settle.in_set(LifeSystems::Settle), ring::strike.in_set(LifeSystems::Strike)));
        // Files come by the asset server; without one a game gives its life as a value.
        if app.world().contains_resource::<AssetServer>() {
            app.init_asset::<LifeAsset>()
                .init_asset_loader::<asset::LifeLoader>()
                .add_systems(Update, (asset::open, asset::take).chain().before(LifeSystems::Settle));
        }
        let is_drawn = app.is_plugin_added::<bevy::pbr::PbrPlugin>();
        if is_drawn {
            material::build(app);
        } else if app.world().contains_resource::<Assets<Mesh>>() {
            // Without a renderer everything still goes its way, so that it can be tested and measured.
            app.init_asset::<SolidMaterial>().init_asset::<MistMaterial>();
        } else {
            return;
        }
        app.init_resource::<stage::Stage>().init_resource::<stage::LifeMaterials>().add_systems(
            Update,
            (
                (stage::tell_light, stage::choose, smoke::kindle).chain().in_set(LifeSystems::Choose),
                (act::fly, act::turn_hands, act::swing, act::pass_figures).in_set(LifeSystems::Act),
            ),
        );
    }
}
