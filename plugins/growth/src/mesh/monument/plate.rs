use glam::{DVec2, DVec3};
use veduta_city::monument::{Hole, PathPoint};

use super::Mason;
use super::path::plate;
use crate::mesh::data::Paint;
use crate::mesh::outline::Rings;

/// Edges that bend by less than this are drawn round; cosine.
const SMOOTH: f64 = 0.88;

/// Where a plate's plane lies in the shape's frame: x, y of the plane, and how far behind its front.
#[derive(Clone, Copy)]
enum Plane {
    /// In plan, its front upwards at a height.
    Level(f64),
    /// In elevation, its front towards the viewer.
    Upright,
}

impl Plane {
    fn at(self, p: DVec2, behind: f64) -> DVec3 {
        match self {
            Self::Level(height) => p.extend(height - behind),
            Self::Upright => DVec3::new(p.x, behind, p.y),
        }
    }

    fn way(self, p: DVec2) -> DVec3 {
        self.at(p, 0.0) - self.at(DVec2::ZERO, 0.0)
    }
}

impl Mason<'_> {
    /// An outline in plan, drawn upwards.
    pub(super) fn extrusion(&mut self, outline: &[PathPoint<i32>], holes: &[Hole<i32>], height: f64) {
        for rings in plate(outline, holes, self.detail.within_m).solid {
            self.plate(&rings, Plane::Level(height), height);
        }
    }

    /// An outline in elevation, with openings.
    pub(super) fn panel(
        &mut self,
        outline: &[PathPoint<i32>],
        holes: &[Hole<i32>],
        depth: f64,
        reveal: f64,
        infill: Option<Paint>,
    ) {
        let plate = plate(outline, holes, self.detail.within_m);
        for rings in &plate.solid {
            self.plate(rings, Plane::Upright, depth);
        }
        if let Some(infill) = infill {
            let behind = if self.detail.has_reveals { reveal.min(depth) } else { 0.0 };
            for rings in &plate.open {
                self.cap(rings, |p| Plane::Upright.at(p, behind), infill);
            }
        }
    }

    /// Front, back and sides of a plate.
    fn plate(&mut self, rings: &Rings, plane: Plane, depth: f64) {
        if rings.is_empty() {
            return;
        }
        self.cap(rings, |p| plane.at(p, 0.0), self.paint);
        let holes_to = if self.detail.has_reveals { rings.len() } else { 1 };
        for ring in &rings[..holes_to] {
            self.sides(ring, plane, depth);
        }
        if self.detail.has_reveals {
            let back: Rings = rings.clone();
            self.flipped_cap(&back, |p| plane.at(p, depth));
        }
    }

    /// A flat face of any outline. Tiles that show a whole bay are stretched over it, others run on.
    fn cap(&mut self, rings: &Rings, at: impl Fn(DVec2) -> DVec3, paint: Paint) {
        let bounds = rings.iter().flatten().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |b, &p| (b.0.min(p), b.1.max(p)));
        let size = (bounds.1 - bounds.0).max(DVec2::splat(1e-6));
        let mut triangulator = core::mem::take(&mut self.triangulator);
        triangulator.each(rings, |_, places| {
            if paint.tile.opening().is_some() {
                let uv = |p: DVec2| DVec2::new(p.x - bounds.0.x, bounds.1.y - p.y) / size;
                self.stretched(places.map(&at), places.map(uv), paint);
            } else {
                self.face_of(&places.map(&at), paint);
            }
        });
        self.triangulator = triangulator;
    }

    fn flipped_cap(&mut self, rings: &Rings, at: impl Fn(DVec2) -> DVec3) {
        let mut triangulator = core::mem::take(&mut self.triangulator);
        triangulator.each(rings, |_, [a, b, c]| self.face(&[a, c, b].map(&at)));
        self.triangulator = triangulator;
    }

    /// The narrow sides of a plate along one of its rings, round where it bends little.
    fn sides(&mut self, ring: &[DVec2], plane: Plane, depth: f64) {
        let n = ring.len();
        let way = |i: usize| (ring[(i + 1) % n] - ring[i % n]).normalize_or_zero();
        let out = |w: DVec2| DVec2::new(w.y, -w.x);
        let mut along = 0.0;
        for i in 0..n {
            let (a, b, mine) = (ring[i], ring[(i + 1) % n], way(i));
            let length = a.distance(b);
            let meet = |other: DVec2| if other.dot(mine) > SMOOTH { (other + mine).normalize_or(mine) } else { mine };
            let normals = [meet(way(i + n - 1)), meet(way(i + 1))].map(|w| plane.way(out(w)));
            let corners = [plane.at(a, depth), plane.at(b, depth), plane.at(b, 0.0), plane.at(a, 0.0)];
            if normals[0].dot(normals[1]) > 1.0 - 1e-9 {
                self.face(&corners);
            } else {
                let uvs = [(along, 0.0), (along + length, 0.0), (along + length, -depth), (along, -depth)];
                let index = [0, 1, 3, 2].map(|k| {
                    let (u, v) = uvs[k];
                    self.vertex(corners[k], normals[usize::from(k == 1 || k == 2)], DVec2::new(u, v))
                });
                self.mend(2, &index);
            }
            along += length;
        }
    }
}
