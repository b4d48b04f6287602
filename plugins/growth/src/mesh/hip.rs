use glam::{DVec2, DVec3};

use super::outline::{Triangulator, is_convex};
use crate::skeleton::{Skeleton, Skeletons};

/// Convex pieces of a roof: corners as (x, y, t), t affine over each piece, 0 at the eaves and 1 at the ridge.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Pieces {
    corners: Vec<DVec3>,
    ends: Vec<usize>,
}

impl Pieces {
    pub(super) fn clear(&mut self) {
        self.corners.clear();
        self.ends.clear();
    }

    pub(super) fn push(&mut self, corners: impl IntoIterator<Item = DVec3>) {
        let before = self.corners.len();
        self.corners.extend(corners);
        if self.corners.len() - before < 3 {
            self.corners.truncate(before);
        } else {
            self.ends.push(self.corners.len());
        }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &[DVec3]> {
        let starts = core::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).filter_map(|(start, &end)| self.corners.get(start..end))
    }

    /// Parameter over a plan position; `None` beyond the roof.
    pub(super) fn at(&self, p: DVec2) -> Option<f64> {
        let is_in = |piece: &&[DVec3]| {
            let n = piece.len();
            (0..n).all(|i| {
                let (a, b) = (piece[i].truncate(), piece[(i + 1) % n].truncate());
                (b - a).perp_dot(p - a) >= -1e-9
            })
        };
        let piece = self.iter().find(is_in)?;
        let (a, b, c) = (piece[0], piece[1], *piece.last()?);
        let normal = (b - a).cross(c - a);
        (normal.z.abs() > 1e-9).then(|| a.z - normal.truncate().dot(p - a.truncate()) / normal.z)
    }
}

/// The part of a convex polygon on which a function of its corners is at most 0.
pub(super) fn clip(from: &[DVec3], to: &mut Vec<DVec3>, over: impl Fn(DVec3) -> f64) {
    to.clear();
    for (i, &a) in from.iter().enumerate() {
        let b = from[(i + 1) % from.len()];
        let (fa, fb) = (over(a), over(b));
        if fa <= 0.0 {
            to.push(a);
        }
        if (fa < 0.0 && fb > 0.0) || (fa > 0.0 && fb < 0.0) {
            to.push(a.lerp(b, fa / (fa - fb)));
        }
    }
}

/// Most corners of a footprint that gets slopes: as many take some hundredths of a second.
const MOST_CORNERS: usize = 2000;

/// Slopes of one pitch on every side; level where the footprint has no skeleton.
pub(super) fn hip(rings: &[Vec<DVec2>], pieces: &mut Pieces, skeletons: &mut Skeletons, triangulator: &mut Triangulator) {
    match skeleton(rings, skeletons) {
        Some(skeleton) => add_faces(skeleton, pieces, triangulator),
        None => triangulator.each(rings, |_, places| pieces.push(places.map(|p| p.extend(0.0)))),
    }
}

fn skeleton<'s>(rings: &[Vec<DVec2>], skeletons: &'s mut Skeletons) -> Option<&'s Skeleton> {
    let corners: usize = rings.iter().map(Vec::len).sum();
    (corners <= MOST_CORNERS).then(|| skeletons.find(rings.iter().map(Vec::as_slice)).ok()).flatten()
}

fn add_faces(skeleton: &Skeleton, pieces: &mut Pieces, triangulator: &mut Triangulator) {
    let (nodes, top) = (skeleton.nodes(), skeleton.depth());
    let corner = |node: u32| nodes.get(node as usize).map_or(DVec3::ZERO, |p| p.truncate().extend(p.z / top));
    let mut flat = [Vec::new()];
    for face in skeleton.faces() {
        flat[0].clear();
        flat[0].extend(face.iter().map(|&node| corner(node).truncate()));
        if is_convex(&flat[0]) {
            pieces.push(face.iter().map(|&node| corner(node)));
        } else {
            triangulator.each(&flat, |index, _| pieces.push(index.map(|i| face.get(i).map_or(DVec3::ZERO, |&node| corner(node)))));
        }
    }
}

/// The rings drawn inwards by a distance; `None` where they would meet or turn over.
pub(super) fn inset(rings: &[Vec<DVec2>], distance: f64, skeletons: &mut Skeletons) -> Option<Vec<Vec<DVec2>>> {
    let skeleton = skeleton(rings, skeletons).filter(|skeleton| skeleton.first_event() > 1.5 * distance)?;
    // A face ends with the arc of the corner that its edge begins at.
    let mut moved = skeleton.faces().filter_map(|face| {
        let [from, to] = [face.first()?, face.last()?].map(|&node| skeleton.nodes().get(node as usize));
        Some(from?.lerp(*to?, distance / to?.z).truncate())
    });
    Some(rings.iter().map(|ring| moved.by_ref().take(ring.len()).collect()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_hip_is_a_pyramid() {
        let square = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)].map(DVec2::from).to_vec();
        let mut pieces = Pieces::default();
        hip(&[square], &mut pieces, &mut Skeletons::default(), &mut Triangulator::default());
        assert_eq!(pieces.iter().map(<[_]>::len).collect::<Vec<_>>(), [3; 4]);
        assert!((pieces.at(DVec2::splat(1.0)).unwrap() - 0.5).abs() < 1e-9);
        assert_eq!(pieces.at(DVec2::splat(5.0)), None);
    }

    #[test]
    fn rings_drawn_inwards_keep_their_distance() {
        let outer = [(0.0, 0.0), (12.0, 0.0), (12.0, 5.0), (5.0, 5.0), (5.0, 9.0), (0.0, 9.0)].map(DVec2::from).to_vec();
        let inner = inset(core::slice::from_ref(&outer), 0.5, &mut Skeletons::default()).unwrap();
        let expected = [(0.5, 0.5), (11.5, 0.5), (11.5, 4.5), (4.5, 4.5), (4.5, 8.5), (0.5, 8.5)].map(DVec2::from);
        assert!(inner[0].iter().zip(expected).all(|(a, b)| a.distance(b) < 1e-9), "{inner:?}");
        assert_eq!(inset(&[outer], 2.0, &mut Skeletons::default()), None);
    }
}
