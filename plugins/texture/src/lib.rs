//! The texture workshop: procedural materials and small facade textures.
