//! Straight skeletons of polygons with holes: the hips, valleys and ridges of a roof of one pitch over any footprint.
//!
//! All edges move inwards at the same speed; what their corners trace are the arcs of the skeleton, and what each edge sweeps
//! is its face, which is a plane slope of the roof.
//!
//! ```text
//!  rings ──► wavefront: corners in loops ──┬─ an edge shrinks to nothing ────────┬──► arcs, put together to a face an edge
//!                  ▲                       └─ an inner corner runs into an edge ─┤           │
//!                  └────────── changed by whatever comes first ──────────────────┘         proof ──► Skeleton
//!                                                                                            └─ fails: corners moved a hair,
//!                                                                                               and once more
//! ```
//!
//! ```
//! use glam::DVec2;
//! use veduta_growth::skeleton::Skeletons;
//!
//! // An L-shaped house with wings 4 m wide.
//! let house = [(0.0, 0.0), (10.0, 0.0), (10.0, 4.0), (4.0, 4.0), (4.0, 9.0), (0.0, 9.0)].map(DVec2::from);
//! let mut skeletons = Skeletons::default();
//! let skeleton = skeletons.find([&house[..]])?;
//! assert_eq!(skeleton.faces().len(), 6);
//! assert!((skeleton.depth() - 2.0).abs() < 1e-9, "its ridges are 2 m from the walls");
//! # Ok::<(), veduta_growth::skeleton::SkeletonError>(())
//! ```
//!
//! # Method
//! The skeleton is that of Aichholzer, Aurenhammer, Alberts and Gärtner (*A novel type of skeleton for polygons*, Journal of
//! Universal Computer Science 1, 1995), found by its events (Felkel and Obdržálek, *Straight skeleton implementation*, 1998).
//! It is done in floating point and proved afterwards: a result is what [`Skeleton`] says it is, or an error. Where many things
//! happen at once, as they do over squares and regular stars, what happens first is a question of the last digit, and the first
//! try may end in nothing; with every corner moved by a hundredth of a millimetre, to a side that its number decides, things
//! happen one after another. Of a million drawn footprints (wings, combs, stairs, stars, courtyards, steps of a millimetre)
//! all are found; `veduta-bake bench roofs` repeats it.
//!
//! An edge's event is found from its two corners, an inner corner's by looking at all edges: O(n²) for n corners, and little
//! of it up to some hundreds.
//!
//! # Rejected
//! Exact arithmetic, as CGAL has it: some hundred times slower. A kinetic triangulation (Palfrader, Held and Huber 2012): of use
//! from thousands of corners on. Raising the footprint's distance transform: creases at inner corners are round.

mod drawn;
mod proof;
mod quad;
mod wavefront;

use glam::{DVec2, DVec3};

pub use drawn::{Rings, drawn_footprint};
use wavefront::{Jitter, Wavefront};

/// How far corners are moved, metres, in one try after another.
const JITTERS_M: [f64; 6] = [0.0, 1e-5, 1e-5, 1e-4, 1e-4, 5e-4];

/// A straight skeleton that has been proved: its faces, one an edge, are simple and counter-clockwise, every arc lies between
/// two of them, and what they cover together is what the rings enclose, once. All corners of a face are as far from its edge's
/// line as their time says: to a hundredth of a millimetre, or to half of one where corners had to be moved.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Skeleton {
    nodes: Vec<DVec3>,
    corners: Vec<u32>,
    ends: Vec<u32>,
}

impl Skeleton {
    /// Where arcs meet, and at which time: x, y and distance from the edges, metres. The rings' own corners come first, in
    /// their order.
    #[must_use]
    pub fn nodes(&self) -> &[DVec3] {
        &self.nodes
    }

    /// The face of each edge, in the order of the rings' corners where edges begin: numbers of nodes, counter-clockwise from
    /// the edge's beginning and its end.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        (0..self.ends.len()).map(|i| {
            let from = if i == 0 { 0 } else { self.ends[i - 1] as usize };
            &self.corners[from..self.ends[i] as usize]
        })
    }

    /// The time at which something happens for the first time: until then all that is left of the rings has their corners.
    #[must_use]
    pub fn first_event(&self) -> f64 {
        self.nodes.iter().map(|node| node.z).filter(|&time| time > 0.0).fold(f64::INFINITY, f64::min)
    }

    /// The latest time: how far the middle of it all is from the edges, metres.
    #[must_use]
    pub fn depth(&self) -> f64 {
        self.nodes.iter().map(|node| node.z).fold(0.0, f64::max)
    }
}

/// Why there is no skeleton.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum SkeletonError {
    /// A ring has fewer than three corners, or two of them, one after another, at the same place.
    #[error("ring {ring} has fewer than three corners, or the one after corner {corner} is at the same place")]
    Degenerate {
        /// Number of the ring.
        ring: usize,
        /// Number of its corner.
        corner: usize,
    },
    /// None that passes the proof was found: rings cross or touch, or run the wrong way round.
    #[error("no skeleton was found: the rings cross or touch, or run the wrong way round")]
    NotFound,
}

/// Finds straight skeletons, one after another, in the same memory.
#[derive(Debug, Default)]
pub struct Skeletons {
    wavefront: Wavefront,
    rings: Vec<DVec2>,
    ends: Vec<u32>,
}

impl Skeletons {
    /// The skeleton of a polygon: its outer ring counter-clockwise, holes clockwise, none closed by repeating its first
    /// corner; metres.
    ///
    /// # Errors
    /// [`SkeletonError`] where the rings are no polygon.
    pub fn find<'r>(&mut self, rings: impl IntoIterator<Item = &'r [DVec2]>) -> Result<&Skeleton, SkeletonError> {
        self.rings.clear();
        self.ends.clear();
        for (number, ring) in rings.into_iter().enumerate() {
            let degenerate = |corner| Err(SkeletonError::Degenerate { ring: number, corner });
            if ring.len() < 3 {
                return degenerate(0);
            }
            if let Some(corner) = (0..ring.len()).find(|&i| ring[i] == ring[(i + 1) % ring.len()]) {
                return degenerate(corner);
            }
            self.rings.extend_from_slice(ring);
            self.ends.push(self.rings.len() as u32);
        }
        let has_points = !self.rings.is_empty() && self.rings.iter().all(|p| p.is_finite());
        let found = has_points
            && (self.is_plain_quad()
                || JITTERS_M.into_iter().enumerate().any(|(number, by)| {
                    let jitter = Jitter { by, number };
                    self.wavefront.shrink(&self.rings, &self.ends, jitter) && proof::holds(&self.wavefront, by)
                }));
        if !found {
            return Err(SkeletonError::NotFound);
        }
        self.wavefront.put_back(&self.rings);
        Ok(&self.wavefront.skeleton)
    }

    /// Whether the rings are a convex quadrilateral whose skeleton was found at once.
    fn is_plain_quad(&mut self) -> bool {
        let points: Result<&[DVec2; 4], _> = self.rings.as_slice().try_into();
        points.is_ok_and(|points| self.ends.len() == 1 && self.wavefront.shrink_quad(points)) && proof::holds(&self.wavefront, 0.0)
    }
}

#[cfg(test)]
mod tests;
