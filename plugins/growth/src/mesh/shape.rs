//! Bodies that details and objects are put together from.

use glam::{DVec2, DVec3};
use veduta_city::draw::Draw;

use super::data::{MeshData, Paint};
use super::outline::engine;

/// An upright box in plan.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    pub(super) middle: DVec2,
    /// Unit vector of its first side.
    pub(super) along: DVec2,
    /// Half the lengths of its sides, metres.
    pub(super) half: DVec2,
}

impl Block {
    /// Counter-clockwise.
    pub(super) fn corners(&self) -> [DVec2; 4] {
        let (x, y) = (self.along * self.half.x, self.along.perp() * self.half.y);
        [self.middle - x - y, self.middle + x - y, self.middle + x + y, self.middle - x + y]
    }

    pub(super) fn walls(&self, mesh: &mut MeshData, low: f64, high: f64, paint: Paint) {
        let corners = self.corners();
        for i in 0..4 {
            let (a, b) = (corners[i], corners[(i + 1) % 4]);
            mesh.polygon(&[engine(a, low), engine(b, low), engine(b, high), engine(a, high)], paint);
        }
    }

    pub(super) fn cap(&self, mesh: &mut MeshData, y: f64, paint: Paint) {
        mesh.polygon(&self.corners().map(|p| engine(p, y)), paint);
    }

    pub(super) fn floor(&self, mesh: &mut MeshData, y: f64, paint: Paint) {
        let [a, b, c, d] = self.corners();
        mesh.polygon(&[a, d, c, b].map(|p| engine(p, y)), paint);
    }
}

/// Builds one object in its own frame: x to its right, y up, z to its front, in metres of its nominal size.
pub(super) struct Sculptor<'a> {
    pub(super) mesh: &'a mut MeshData,
    /// Its foot in the engine's axes.
    pub(super) foot: DVec3,
    /// Unit vector to its front, in plan.
    pub(super) front: DVec2,
    pub(super) scale: f64,
}

impl Sculptor<'_> {
    fn plan(&self, x: f64, z: f64) -> DVec2 {
        let right = -self.front.perp();
        DVec2::new(self.foot.x, -self.foot.z) + (right * x + self.front * z) * self.scale
    }

    fn y(&self, y: f64) -> f64 {
        self.foot.y + y * self.scale
    }

    fn at(&self, p: DVec3) -> DVec3 {
        engine(self.plan(p.x, p.z), self.y(p.y))
    }

    /// A box of half widths (x, z) about (x, z) from a height to another.
    pub(super) fn block(&mut self, middle: (f64, f64), half: (f64, f64), heights: (f64, f64), paint: Paint) {
        let along = -self.front.perp();
        let block = Block { middle: self.plan(middle.0, middle.1), along, half: DVec2::new(half.0, half.1) * self.scale };
        let (low, high) = (self.y(heights.0), self.y(heights.1));
        block.walls(self.mesh, low, high, paint);
        block.cap(self.mesh, high, paint);
        if heights.0 > 0.05 {
            block.floor(self.mesh, low, paint);
        }
    }

    /// A quad by its corners, counter-clockwise seen from outside.
    pub(super) fn face(&mut self, corners: &[DVec3], paint: Paint) {
        let placed: Vec<DVec3> = corners.iter().map(|&p| self.at(p)).collect();
        self.mesh.polygon(&placed, paint);
    }

    /// A body turned about an upright axis at (x, z): rings of (radius, height) from the lowest up, smooth around unless it
    /// has no more than 4 sides. Radii 0 are points.
    pub(super) fn turned(&mut self, axis: (f64, f64), sides: usize, rings: &[(f64, f64)], paint: Paint) {
        // Counter-clockwise seen from above; half a step off, so that a flat side looks to the front.
        let spokes: Vec<DVec2> = (0..=sides)
            .map(|i| {
                let angle = -core::f64::consts::TAU * (i as f64 + 0.5) / sides as f64;
                DVec2::new(libm::sin(angle), libm::cos(angle))
            })
            .collect();
        let place = |s: DVec2, (r, y): (f64, f64)| DVec3::new(axis.0 + s.x * r, y, axis.1 + s.y * r);
        for pair in rings.windows(2) {
            let (low, high) = (pair[0], pair[1]);
            for side in spokes.windows(2) {
                let (a, b) = (side[0], side[1]);
                let corners = [place(a, low), place(b, low), place(b, high), place(a, high)];
                let tilt = DVec2::new(high.1 - low.1, low.0 - high.0).normalize_or(DVec2::Y);
                let flat = (a + b).normalize_or_zero();
                let normal = |s: DVec2| {
                    let s = if sides <= 4 { flat } else { s };
                    DVec3::new(s.x * tilt.x, tilt.y, s.y * tilt.x)
                };
                self.smooth(&corners, [normal(a), normal(b), normal(b), normal(a)], low.0 > 0.0, high.0 > 0.0, paint);
            }
        }
        if let Some(&top) = rings.last().filter(|ring| ring.0 > 0.0) {
            let cap: Vec<DVec3> = spokes.iter().take(sides).map(|&s| place(s, top)).collect();
            self.face(&cap, paint);
        }
    }

    /// A bough: three-sided, round to the light, from one place to another, with its radii at both.
    pub(super) fn limb(&mut self, from: DVec3, to: DVec3, radii: (f64, f64), paint: Paint) {
        let Some(way) = (to - from).try_normalize() else { return };
        let x = way.cross(if way.y.abs() < 0.9 { DVec3::Y } else { DVec3::X }).normalize();
        let z = x.cross(way);
        let spokes = [0, 1, 2, 3].map(|i| {
            let angle = -core::f64::consts::TAU * f64::from(i) / 3.0;
            x * libm::sin(angle) + z * libm::cos(angle)
        });
        for side in spokes.windows(2) {
            let (a, b) = (side[0], side[1]);
            let corners = [from + a * radii.0, from + b * radii.0, to + b * radii.1, to + a * radii.1];
            self.smooth(&corners, [a, b, b, a], radii.0 > 0.0, radii.1 > 0.0, paint);
        }
    }

    /// A quad with a normal for each corner, or a triangle where its lower or upper side is a point.
    fn smooth(&mut self, corners: &[DVec3; 4], normals: [DVec3; 4], has_low: bool, has_high: bool, paint: Paint) {
        let Some(flat) = super::data::newell(&corners.map(|p| self.at(p))) else { return };
        let level = DVec3::Y.cross(flat);
        let u = if level.length() > 1e-3 { level.normalize() } else { DVec3::X };
        let v = u.cross(flat);
        let mut index = [0; 4];
        for i in 0..4 {
            let place = self.at(corners[i]);
            let normal = engine(self.plan(normals[i].x, normals[i].z) - self.plan(0.0, 0.0), normals[i].y * self.scale);
            let uv = DVec2::new(u.dot(place), v.dot(place)) / paint.size_m();
            index[i] = self.mesh.vertex(place, normal.normalize_or(DVec3::Y).as_vec3().to_array(), uv, paint);
        }
        if has_low {
            self.mesh.indices.extend([index[0], index[1], index[2]]);
        }
        if has_high {
            self.mesh.indices.extend([index[0], index[2], index[3]]);
        }
    }

    /// A lump of foliage or a head: a ball with an uneven skin.
    pub(super) fn blob(&mut self, ball: &Ball, middle: DVec3, radii: DVec3, rough: f64, draw: Draw, paint: Paint) {
        let skin = |(i, &p): (usize, &DVec3)| {
            let swell = 1.0 + rough * (2.0 * draw.part(i as u64).unit("skin") - 1.0);
            let normal = self.at(p / radii) - self.at(DVec3::ZERO);
            (self.at(middle + p * radii * swell), normal.normalize_or(DVec3::Y))
        };
        let points: Vec<(DVec3, DVec3)> = ball.points.iter().enumerate().map(skin).collect();
        // The texture is laid on each face from the axis that it looks along most, so that none is drawn out.
        let mut laid = vec![[None; 3]; points.len()];
        for &[a, b, c] in &ball.triangles {
            let [p, q, r] = [a, b, c].map(|i| points[i as usize].0);
            let facing = (q - p).cross(r - p).abs();
            let axis = match facing {
                DVec3 { x, y, z } if x > y.max(z) => 0,
                DVec3 { y, z, .. } if y > z => 1,
                _ => 2,
            };
            // The object's frame (right, up, front) is left-handed.
            for i in [a, c, b] {
                let (place, normal) = points[i as usize];
                let uv = [DVec2::new(place.z, place.y), DVec2::new(place.x, place.z), DVec2::new(place.x, place.y)][axis];
                let vertex = laid[i as usize][axis]
                    .get_or_insert_with(|| self.mesh.vertex(place, normal.as_vec3().to_array(), uv / paint.size_m(), paint));
                self.mesh.indices.push(*vertex);
            }
        }
    }
}

/// An icosahedron with every face cut in four: 42 points, 80 triangles.
pub(super) struct Ball {
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl Ball {
    pub(super) fn new() -> Self {
        const G: f64 = 1.618_033_988_749_895;
        let corners = [
            (-1.0, G, 0.0),
            (1.0, G, 0.0),
            (-1.0, -G, 0.0),
            (1.0, -G, 0.0),
            (0.0, -1.0, G),
            (0.0, 1.0, G),
            (0.0, -1.0, -G),
            (0.0, 1.0, -G),
            (G, 0.0, -1.0),
            (G, 0.0, 1.0),
            (-G, 0.0, -1.0),
            (-G, 0.0, 1.0),
        ];
        const FACES: [[u32; 3]; 20] = [
            [0, 11, 5],
            [0, 5, 1],
            [0, 1, 7],
            [0, 7, 10],
            [0, 10, 11],
            [1, 5, 9],
            [5, 11, 4],
            [11, 10, 2],
            [10, 7, 6],
            [7, 1, 8],
            [3, 9, 4],
            [3, 4, 2],
            [3, 2, 6],
            [3, 6, 8],
            [3, 8, 9],
            [4, 9, 5],
            [2, 4, 11],
            [6, 2, 10],
            [8, 6, 7],
            [9, 8, 1],
        ];
        let mut ball = Self { points: corners.map(|c| DVec3::from(c).normalize()).to_vec(), triangles: Vec::with_capacity(80) };
        let mut halves: Vec<((u32, u32), u32)> = Vec::with_capacity(30);
        for [a, b, c] in FACES {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| ball.half(p, q, &mut halves));
            ball.triangles.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        ball
    }

    fn half(&mut self, p: u32, q: u32, halves: &mut Vec<((u32, u32), u32)>) -> u32 {
        let key = (p.min(q), p.max(q));
        if let Some((_, found)) = halves.iter().find(|(k, _)| *k == key) {
            return *found;
        }
        let index = self.points.len() as u32;
        self.points.push((self.points[p as usize] + self.points[q as usize]).normalize());
        halves.push((key, index));
        index
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_is_closed_and_faces_outwards() {
        let ball = Ball::new();
        assert_eq!((ball.points.len(), ball.triangles.len()), (42, 80));
        for t in &ball.triangles {
            let [a, b, c] = t.map(|i| ball.points[i as usize]);
            assert!((b - a).cross(c - a).dot(a) > 0.0);
        }
    }
}
