//! City graph to plan, and plan to meshes.
