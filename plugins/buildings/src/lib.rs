//! Plugin: spawns the procedural buildings and ground of arriving cells.
