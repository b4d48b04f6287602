//! Meshes of a cell, made from its packets on the walker's machine.
//!
//! ```text
//!  CellShell ──► ground, bridges, roofs, … ──────► MeshData     CellShell ──► collision
//!  CellShell + FacadeSheet ──► level2, level4 ───► MeshData     (walls that somebody painted: painted)
//!  Overview ──► districts: CellShells ──► afar ──► MeshData
//! ```
//!
//! Every function is pure and looks at one cell alone. Positions are metres in the engine's axes local to the cell: x east,
//! y up, z south; in plan relative to [`CellShell::origin`](veduta_city::CellShell), in height to the city's zero. What lies on the
//! ground is cut where its terrain bends.
//!
//! A roof is a parameter `t` over the footprint, 0 at the eaves and 1 at the ridge, bent by a profile (straight, broken,
//! round): [`RoofForm`] decides it once a volume, and the roof's faces as well as the gables above the walls follow it, so
//! that they meet. Hips come from the footprint's straight skeleton ([`crate::skeleton`]); where it has none, the roof is flat.
//!
//! ```
//! use veduta_city::{CellShell, GridPolygon, GridPos, GroundPatch, SurfaceKind};
//! use veduta_growth::mesh;
//! let square = vec![GridPos(0, 0), GridPos(4096, 0), GridPos(4096, 4096), GridPos(0, 4096)];
//! let patch = GroundPatch { surface: SurfaceKind::Cobbles, outline: GridPolygon::simple(square), z: 0, course: None };
//! let shell = CellShell { ground: vec![patch], ..Default::default() };
//! let ground = mesh::ground(&shell);
//! assert_eq!(ground.triangle_count(), 2);
//! ground.validate().unwrap();
//! ```
//!
//! # Limits
//! Storeys that do not add up to the wall's height are stretched to it. A gabled roof on a footprint with courtyards, or one
//! that fills less than three quarters of its extent, is built hipped.
//!
//! # Rejected
//! Distance fields for hips (parabolic creases at inner corners), and sharing vertices between faces (every face has its own
//! normal, tile and façade anyway).

mod afar;
mod arcade;
pub(crate) mod bridge;
mod collision;
mod data;
mod drape;
mod footing;
mod form;
mod gable;
mod ground;
mod hip;
mod lathe;
mod marking;
mod monument;
mod moulding;
mod object;
mod ornament;
mod outline;
mod painted;
mod relief;
mod roof;
mod roof_detail;
mod shape;
pub(crate) mod tunnel;
mod wall;

#[cfg(test)]
mod proof;

pub use afar::{afar, districts};
pub use bridge::spans;
pub use collision::{Collision, Pillar, Trimesh, collision};
pub use data::{MeshData, MeshError};
pub use footing::footings;
pub use form::RoofForm;
pub use ground::ground;
pub use marking::markings;
pub use monument::{MonumentDetail, monument, monument_bounds, monuments};
pub use moulding::mouldings;
pub(crate) use object::radius_m;
pub use object::{lantern, objects, tree_cards, trees};
pub use painted::{PANE, PANES_APART, PANES_TOLD, painted};
pub use relief::level4;
pub use roof::{roof_bodies, roof_coverings, roof_details, roofs};
pub use roof_detail::chimney_tops;
pub use wall::{facades, level1, level2};
