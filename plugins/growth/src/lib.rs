//! City graph to plan, and plan to meshes.

pub mod mesh;
pub mod plan;
