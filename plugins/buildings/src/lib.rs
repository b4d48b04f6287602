//! Spawns the procedural buildings, ground and standing objects of arriving cells.
//!
//! ```text
//!  CellReady ──► task pool: packets → MeshData → Mesh ──► spawn within the frame's budget ──► CellStands
//!  City.overviews ──► task pool: districts → Mesh ──► spawn ──► shown where the cell does not stand
//! ```
//!
//! Packets carry plans, not meshes: walls, roofs and ground are made on the walker's machine, off the main thread, and
//! spawned as one mesh of walls and one of monuments per cell and level. Fittings (chimneys, dormers, eaves, standing objects) are a mesh
//! too, which materials show from near by. Trees are meshes of their own, cards at level 1 and bodies at level 2 (bodies at level 1 where no plugin
//! provides materials), made for the season that the clock and the city's latitude tell; when it turns, they are made anew and take
//! the place of those that stood. Where a plugin provides materials, nothing stands before these are made.
//!
//! What maps know of a city is enough to draw it from afar: of each part of the [`City`](veduta_ecs::City)'s overview that is here, the
//! cells are drawn as districts (ground, houses under plain roofs, bridges) as long as they do not stand themselves. So there is a city
//! below who flies, and behind what rises over the roofs.
//!
//! Walls near a viewer stand in relief (level 4): windows and doors behind the wall, sills, surrounds and hoods before it, made of the same
//! packets as level 2. The mesh tells by how much each vertex lies off its wall ([`ATTRIBUTE_RELIEF`](veduta_ecs::ATTRIBUTE_RELIEF)), so that a
//! material can let it rise.
//!
//! Walls that somebody painted are a mesh of their own, with an array texture for each cell that has some: put together of small textures at
//! level 2, decoded from pictures at level 3, on the task pool.
//!
//! # Use
//! ```no_run
//! use bevy::prelude::*;
//! use veduta_buildings::BuildingsPlugin;
//!
//! App::new().add_plugins((DefaultPlugins, BuildingsPlugin::default())).run();
//! ```
//! Give it cells: `veduta-streaming` does, or spawn entities with [`Cell`](veduta_ecs::Cell) and
//! [`CellContent`](veduta_ecs::CellContent) and send [`CellReady`](veduta_ecs::CellReady) yourself. Without the façade plugin
//! meshes get plain materials in their own colours.
//!
//! # Limits
//! A cell's level is uploaded in one piece; cells are small enough (70 m) for that to stay under a millisecond.
//!
//! # Rejected
//! One entity per house (Bevy pays per entity, every frame).

mod build;
mod convert;
mod district;
mod pictures;
mod relief;
mod season;

use bevy::prelude::*;
use veduta_ecs::{MaterialsProvided, VedutaSystems};

pub use build::{BuildSettings, BuildStats, Building};
pub use season::CitySeason;

/// Makes meshes of arriving cells.
#[derive(Debug, Clone, Copy, Default)]
pub struct BuildingsPlugin {
    /// Where meshes are made.
    pub building: Building,
}

impl Plugin for BuildingsPlugin {
    fn build(&self, app: &mut App) {
        veduta_ecs::ensure(app);
        app.insert_resource(self.building)
            .init_resource::<BuildSettings>()
            .register_type::<BuildSettings>()
            .init_resource::<BuildStats>()
            .init_resource::<CitySeason>()
            .init_resource::<build::Queue>()
            .init_resource::<district::Districts>()
            .add_systems(
                Update,
                (
                    season::find_season,
                    build::turn_season,
                    relief::order,
                    pictures::forget,
                    build::start,
                    build::finish.run_if(not(materials_are_awaited)),
                )
                    .chain()
                    .in_set(VedutaSystems::Build),
            )
            .add_systems(
                Update,
                (district::start, district::let_go, district::finish.run_if(not(materials_are_awaited)), district::show)
                    .chain()
                    .after(build::finish)
                    .in_set(VedutaSystems::Build),
            )
            .add_systems(Update, build::show_finest.in_set(VedutaSystems::Show).run_if(not(resource_exists::<MaterialsProvided>)));
    }
}

/// Whether materials will be provided, but are not made yet.
fn materials_are_awaited(provided: Option<Res<MaterialsProvided>>) -> bool {
    provided.is_some_and(|provided| !provided.are_made)
}
