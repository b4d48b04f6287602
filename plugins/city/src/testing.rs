//! What tests of the model make graphs of.

use glam::DVec2;

use crate::{Id, Link, LinkKind, Node, StreetClass};

/// A lane between two nodes.
pub(crate) fn lane(from: u64, to: u64) -> Link {
    Link {
        id: Id::NONE,
        from: Id(from),
        to: Id(to),
        via: Vec::new(),
        kind: LinkKind::Street(StreetClass::Lane),
        width_m: 0.0,
        profile: Vec::new(),
        name: String::new(),
        layer: 0,
        surfacing: None,
    }
}

/// A node at a place.
pub(crate) fn node(id: u64, x: f64, y: f64) -> Node {
    Node { id: Id(id), pos: DVec2::new(x, y), z: 0.0 }
}
