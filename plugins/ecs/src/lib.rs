//! What the plugins of Veduta share: components, messages, resources, system sets and the one module that converts between
//! plan and engine coordinates. Almost no systems: only those that put the ground under an [`Eye`], and the eye on screen.
//!
//! ```text
//!  tour ─┐                        ┌─► streaming ──CellReady──► buildings ──CellMesh──► facade
//!  walker┼──► Eye ──► Transform   │       (follows every Viewer)
//!  film ─┘      └─────────────────┘
//! ```
//!
//! Everything that moves the camera writes an [`Eye`] in plan space; [`EcsPlugin`] turns it into the engine's transform.
//! Plugins never import each other; each works alone in another Bevy project with this crate beside it.
//!
//! # Rejected
//! A shadow world beside the ECS (two truths drift apart) and plan coordinates as `f32` transforms (they jitter a few
//! kilometres from the anchor; the [`WorldOrigin`] is set where a city begins).

mod cell;
mod clock;
mod cue;
mod daylight;
mod eye;
mod ground;
mod interface;
mod overview;
mod place;
mod rim;
mod sets;
mod sight;
mod space;
mod subject;
mod words;

use bevy::prelude::*;

pub use cell::{
    ATTRIBUTE_RELIEF, Awaited, Cell, CellContent, CellEntered, CellMemory, CellMesh, CellMeshKind, CellPictures, CellReady,
    CellReleased, CellStands, DistrictMemory, LevelFade, MaterialsProvided, OpenCells, StandingCells,
};
pub use clock::CityClock;
pub use cue::{Accompany, Cue, Part};
pub use daylight::{Daylight, Weather};
pub use eye::{BirdsEye, Eye, Itinerary, Steering, Stop, Viewer};
pub use ground::{Footing, Ground};
pub use interface::{Docks, Interface, PlaceNames, PointersTaken, Route, ShowOnMap, TourPath, WalkTo, keys_are_free};
pub use overview::{Around, OverviewWants, Overviews};
pub use place::{CITY_SOURCE, City, CityFailed, CityOpened, JumpTo, OpenCity, own_file};
pub use rim::Rim;
pub use sets::{InterfaceSystems, VedutaSystems};
pub use sight::{Sight, Sights, house_key};
pub use space::WorldOrigin;
pub use subject::Subject;
pub use words::{Words, WordsError, WordsValue};

/// Registers what the plugins share. Every plugin of Veduta adds it if it is missing.
#[derive(Debug, Default, Clone, Copy)]
pub struct EcsPlugin;

impl Plugin for EcsPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<WorldOrigin>()
            .init_resource::<StandingCells>()
            .init_resource::<DistrictMemory>()
            .init_resource::<Awaited>()
            .init_resource::<OpenCells>()
            .init_resource::<OverviewWants>()
            .init_resource::<Steering>()
            .init_resource::<CityClock>()
            .init_resource::<Interface>()
            .init_resource::<PointersTaken>()
            .init_resource::<Docks>()
            .init_resource::<Route>()
            .init_resource::<PlaceNames>()
            .init_resource::<TourPath>()
            .init_resource::<Words>()
            .init_resource::<Weather>()
            .init_resource::<Daylight>()
            .register_type::<Eye>()
            .register_type::<Viewer>()
            .register_type::<BirdsEye>()
            .register_type::<Footing>()
            .register_type::<Subject>()
            .register_type::<LevelFade>()
            .register_type::<CityClock>()
            .register_type::<Interface>()
            .register_type::<Weather>()
            .register_type::<Daylight>()
            .add_message::<CellEntered>()
            .add_message::<CellReady>()
            .add_message::<CellStands>()
            .add_message::<CellReleased>()
            .add_message::<CityOpened>()
            .add_message::<CityFailed>()
            .add_message::<JumpTo>()
            .add_message::<WalkTo>()
            .add_message::<ShowOnMap>()
            .add_message::<Cue>()
            .add_message::<Accompany>()
            .configure_sets(
                Update,
                (VedutaSystems::Steer, VedutaSystems::Stream, VedutaSystems::Build, VedutaSystems::Show).chain(),
            )
            .add_systems(Update, (ground::follow_ground, eye::apply_eyes).chain().in_set(VedutaSystems::Show));
    }

    fn is_unique(&self) -> bool {
        true
    }
}

/// Adds the shared plugin unless another plugin has done so.
pub fn ensure(app: &mut App) {
    if !app.is_plugin_added::<EcsPlugin>() {
        app.add_plugins(EcsPlugin);
    }
}
