use serde::{Deserialize, Serialize};

/// Triangles as somebody modelled them, in place of a shape.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// Its corners.
    pub vertices: Vec<ModelVertex>,
    /// Indices of corners, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// A corner of a [`Model`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelVertex {
    /// Right, back, up; grid steps.
    pub at: [i32; 3],
    /// Out of the face, in the same axes; of any length but 0.
    pub normal: [i8; 3],
    /// In repeats of the tile, v downwards; 1/1024.
    pub uv: [i32; 2],
}

impl Model {
    /// Most corners of one.
    pub const MOST_VERTICES: usize = 1 << 17;

    /// Whether its triangles are made of its corners, its numbers are within `farthest`, and its normals point anywhere.
    pub(super) fn is_whole(&self, farthest: u32) -> bool {
        let is_near = |n: &i32| n.unsigned_abs() <= farthest;
        let is_sound = |v: &ModelVertex| v.at.iter().chain(&v.uv).all(is_near) && v.normal != [0; 3];
        let exists = |i: &u32| (*i as usize) < self.vertices.len();
        self.vertices.len() <= Self::MOST_VERTICES
            && self.vertices.iter().all(is_sound)
            && self.triangles.iter().flatten().all(exists)
    }
}
