use bevy::prelude::*;

/// The order of a frame, in `Update`.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum VedutaSystems {
    /// Input, tours and films write eyes.
    Steer,
    /// Cells are followed, asked for, delivered and released.
    Stream,
    /// Meshes of arrived cells are made and spawned.
    Build,
    /// Eyes become transforms; materials, sky and interface follow.
    Show,
}

/// What happens to interfaces before a frame's systems, in `PreUpdate`.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum InterfaceSystems {
    /// It is seen what keys and pointers belong to them: [`Interface::is_typing`](crate::Interface::is_typing),
    /// [`PointersTaken`](crate::PointersTaken).
    Watch,
}
