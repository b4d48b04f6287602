use glam::{DVec2, DVec3};

use super::outline::{Edge, Triangulator, is_convex};
use super::skeleton::{self, Skeleton};

/// Convex pieces of a roof: corners as (x, y, t), t affine over each piece, 0 at the eaves and 1 at the ridge.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Pieces {
    corners: Vec<DVec3>,
    ends: Vec<usize>,
    /// Share of the roof's height that t = 1 stands at.
    pub(super) reach: f64,
}

impl Pieces {
    pub(super) fn clear(&mut self) {
        self.corners.clear();
        self.ends.clear();
        self.reach = 1.0;
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

/// Most corners of a footprint whose skeleton is looked for.
const MOST_CORNERS: usize = 240;

/// Slopes of one pitch on every side.
pub(super) fn hip(rings: &[Vec<DVec2>], pieces: &mut Pieces, height: f64, triangulator: &mut Triangulator) {
    let Some(outer) = rings.first() else { return };
    if rings.len() == 1 && outer.len() <= 32 && is_convex(outer) && convex_hip(outer, pieces) {
        return;
    }
    let corners: usize = rings.iter().map(Vec::len).sum();
    let faces = if corners <= MOST_CORNERS { skeleton::faces(rings) } else { None };
    match faces {
        Some(faces) => add_faces(&faces, pieces, triangulator),
        None => cut_hip(rings, pieces, height, triangulator),
    }
}

/// Every side's plane where it is the lowest: exact for convex outlines.
fn convex_hip(ring: &[DVec2], pieces: &mut Pieces) -> bool {
    let n = ring.len();
    let edges: Option<Vec<Edge>> = (0..n).map(|i| Edge::new(ring[i], ring[(i + 1) % n])).collect();
    let Some(edges) = edges else { return false };
    let first = pieces.corners.len();
    let (mut face, mut cut) = (Vec::with_capacity(n + 4), Vec::with_capacity(n + 4));
    for (i, edge) in edges.iter().enumerate() {
        face.clear();
        face.extend(ring.iter().map(|p| p.extend(-edge.out.dot(*p - edge.a))));
        for (_, other) in edges.iter().enumerate().filter(|&(j, _)| j != i) {
            clip(&face, &mut cut, |p| p.z + other.out.dot(p.truncate() - other.a));
            core::mem::swap(&mut face, &mut cut);
        }
        face.dedup_by(|a, b| a.distance_squared(*b) < 1e-12);
        pieces.push(face.iter().copied());
    }
    let top = pieces.corners.iter().skip(first).map(|p| p.z).fold(0.0, f64::max);
    if top < 1e-3 {
        pieces.clear();
        return false;
    }
    pieces.corners.iter_mut().skip(first).for_each(|p| p.z = (p.z / top).clamp(0.0, 1.0));
    true
}

fn add_faces(faces: &[Vec<DVec3>], pieces: &mut Pieces, triangulator: &mut Triangulator) {
    let top = faces.iter().flatten().map(|p| p.z).fold(1e-9, f64::max);
    let mut flat = [Vec::new()];
    for face in faces {
        flat[0].clear();
        flat[0].extend(face.iter().map(|p| p.truncate()));
        triangulator.each(&flat, |index, places| {
            let t = |k: usize| face.get(index[k]).map_or(0.0, |p| p.z / top);
            pieces.push([0, 1, 2].map(|k| places[k].extend(t(k))));
        });
    }
}

/// Steepest slope of a hip that is cut off flat: 60°.
const STEEPEST: f64 = 1.732_050_807_568_877_2;

/// Slopes up to shortly before two of them would meet for the first time, and a level top.
fn cut_hip(rings: &[Vec<DVec2>], pieces: &mut Pieces, height: f64, triangulator: &mut Triangulator) {
    let inset = Skeleton::new(rings).and_then(|s| s.first_event().map(|t| (0.95 * t, s)));
    let Some((run, skeleton)) = inset.filter(|(run, _)| *run > 0.05) else {
        triangulator.each(rings, |_, places| pieces.push(places.map(|p| p.extend(0.0))));
        return;
    };
    pieces.reach = (run * STEEPEST / height.max(1e-6)).min(1.0);
    let mut moved = skeleton.moved(run);
    let top: Vec<Vec<DVec2>> = rings.iter().map(|ring| moved.by_ref().take(ring.len()).collect()).collect();
    for (low, high) in rings.iter().zip(&top) {
        for i in 0..low.len() {
            let j = (i + 1) % low.len();
            pieces.push([low[i].extend(0.0), low[j].extend(0.0), high[j].extend(1.0), high[i].extend(1.0)]);
        }
    }
    triangulator.each(&top, |_, places| pieces.push(places.map(|p| p.extend(1.0))));
}

/// The rings drawn inwards by a distance; `None` where they would meet or turn over.
pub(super) fn inset(rings: &[Vec<DVec2>], distance: f64) -> Option<Vec<Vec<DVec2>>> {
    let skeleton = Skeleton::new(rings)?;
    if skeleton.first_event()? < 1.5 * distance {
        return None;
    }
    let mut moved = skeleton.moved(distance);
    Some(rings.iter().map(|ring| moved.by_ref().take(ring.len()).collect()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_hip_is_a_pyramid() {
        let square = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)].map(DVec2::from).to_vec();
        let mut pieces = Pieces::default();
        hip(&[square], &mut pieces, 3.0, &mut Triangulator::default());
        assert_eq!(pieces.iter().map(<[_]>::len).collect::<Vec<_>>(), [3; 4]);
        assert!((pieces.at(DVec2::splat(1.0)).unwrap() - 0.5).abs() < 1e-9);
        assert_eq!(pieces.at(DVec2::splat(5.0)), None);
    }

    #[test]
    fn a_cut_hip_covers_its_footprint_and_is_not_too_steep() {
        let l = [(0.0, 0.0), (10.0, 0.0), (10.0, 4.0), (4.0, 4.0), (4.0, 9.0), (0.0, 9.0)].map(DVec2::from).to_vec();
        let mut pieces = Pieces { reach: 1.0, ..Default::default() };
        cut_hip(&[l], &mut pieces, 5.0, &mut Triangulator::default());
        let flat = |piece: &[DVec3]| piece.iter().map(|p| p.truncate()).collect::<Vec<_>>();
        let sum: f64 = pieces.iter().map(|piece| super::super::outline::area(&flat(piece))).sum();
        assert!((sum - 60.0).abs() < 1e-6, "{sum}");
        assert!(pieces.reach < 1.0 && pieces.reach * 5.0 > 2.0, "{}", pieces.reach);
    }
}
