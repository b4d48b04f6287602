//! The city model: what every other crate of Veduta speaks about.
//!
//! ```text
//!  CityGraph ──grow──► CityPlan ──partition──► Cells ──pack──► packets
//!  (metres)            (grid)                  (grid)          (grid, relative to a cell)
//! ```
//!
//! Values only: no engine, no threads, no clock. Reading and writing of files is confined to [`mod@file`].
//!
//! # Spaces
//! *Plan* coordinates are metres from the city's [`Anchor`]: x east, y north, z elevation. From the plan on they lie on a
//! grid of 1/1024 m ([`GridPos`]; outlines on every sixteenth step, [`PLAN_STEP`]), so that joints, ids and bytes are exact. *World* coordinates belong to the engine
//! (x east, y up, z south) and are made in `veduta-ecs` alone.
//!
//! # Limits
//! A city spans at most ±2,097 km from its anchor (the grid's 32 bits); the tangent plane stays within 1 cm of the
//! ellipsoid's distances to about 10 km from the anchor.
//!
//! # Rejected
//! Floating-point plan vertices (joints drift, ids differ between platforms) and a running random generator (nothing
//! could be grown anew alone; see [`draw`]).

mod anchor;
mod arcade;
pub mod bounds;
mod boxes;
mod cell;
mod colour;
mod course;
pub mod draw;
mod facade_draft;
mod faces;
pub mod file;
mod finding;
pub mod furniture;
mod graph;
mod graph_check;
mod grid;
mod guide;
mod holes;
mod hours;
mod id;
mod language;
mod life;
mod limits;
pub mod monument;
mod object;
pub mod opening;
mod ornament;
mod overrides;
mod overview;
mod packet;
mod painted;
mod place;
mod plan;
mod season;
mod sound;
mod soundscape;
mod span;
mod style;
mod terrain;
#[cfg(test)]
mod testing;
mod tile;
mod tour;
mod tour_text;
pub mod tree;
mod views;
mod width;

pub use anchor::Anchor;
pub use arcade::Arcade;
pub use boxes::Boxes;
pub use cell::{Cell, Cells, Portal, PortalSide};
pub use colour::{ParseColourError, Rgb};
pub use course::Course;
pub use facade_draft::{FacadeDraft, FacadeError, FacadeObject, FacadeObjectKind, ObjectHead, ObjectRepeat};
pub use faces::{BorderEdge, connected_faces};
pub use finding::{Finding, Severity};
pub use furniture::{Furnishing, FurnitureError, FurnitureRule};
pub use graph::{
    Block, BlockKind, Building, BuildingPart, CityGraph, Link, LinkKind, Node, NodeKind, Ring, RoofShape, RoofTags, Square,
    StandIn, StreetClass, Surfacing,
};
pub use graph_check::GraphError;
pub use grid::{GRID_PER_METRE, GridPolygon, GridPos, GridRing, PLAN_STEP, metres, ring_edges};
pub use guide::{Certainty, Guide, GuidePicture, GuidePlace};
pub use id::Id;
pub use language::{is_known_language, language_mistake};
pub use life::{Dial, Jet, Life, LifeKind, LifeRules, LivingThing, SignShape, Tells};
pub use limits::{FARTHEST_M, HIGHEST_M, MOST_LEVELS, WIDEST_M};
pub use monument::{Design, Monument, MonumentError, MonumentTag, Monuments, PlacedMonument};
pub use object::{ObjectKind, StandingObject};
pub use ornament::{Articulation, Balconies, BalconyPlaces, Niche, Oriel, Ornament, Parapet};
pub use overrides::{
    CellOverride, CellsOverrides, FacadeFile, GraphOverride, GraphOverrides, LinkEdit, ModelFile, OverrideError, Target,
};
pub use overview::{District, DistrictOf, HouseName, MAP_STEP, Massing, Overview, OverviewParts, on_map};
pub use packet::{CellShell, FacadeSheet, HouseShell, Level, Levels, ObjectShell, VolumeShell};
pub use painted::{PaintedFacade, PaintedObject, PaintedWall, PictureFile, PlacedFacade, PlanFacade, SmallTexture};
pub use place::{Place, PlaceKind, Viewpoint};
pub use plan::{
    CityPlan, GroundFloor, GroundPatch, House, Marking, MarkingKind, Opening, PlanObject, PlanRoof, PlanStreet, Storey,
    SurfaceKind, Volume, Wall, WallKind,
};
pub use season::Season;
pub use sound::{Footfall, Sound, is_beside};
pub use soundscape::{Bed, CueSound, Follows, Heard, Setting, SoundSource, Soundscape};
pub use span::{BoreEnd, SpanForm, SpanMarking, SpanStation, WaySpan};
pub use style::{Gable, Palette, Range, Stand, Style, StyleDraft, StyleError, Styles};
pub use terrain::{PlanTerrain, Terrain};
pub use tile::Tile;
pub use tour::{Ease, LookAt, Step, Tour, Where};
pub use tour_text::{TourEditError, TourSetting, TourText};
pub use views::{Still, Views};
pub use width::{ProfileError, WidthAt};
