//! Meshes of a cell from its packets.
