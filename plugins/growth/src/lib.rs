//! City graph to plan, and plan to meshes.
//!
//! [`plan`] makes every choice that looks at neighbours: street surfaces, lots, houses, roofs, walls and their openings,
//! objects and places, on the grid, the same bytes for any number of threads. Start with [`plan::grow`] and
//! [`plan::Stock`]. [`skeleton`] finds straight skeletons, of which roofs are made.

pub mod mesh;
pub mod plan;
pub mod skeleton;
