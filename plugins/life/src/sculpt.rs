use bevy::asset::RenderAssetUsages;
use bevy::math::{Vec2, Vec3};
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use veduta_city::Rgb;

/// Builds a mesh whose every vertex has a normal, two pairs of texture coordinates and a colour. What these are for, the shaders say.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sculpt {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    uvs_b: Vec<[f32; 2]>,
    colours: Vec<[f32; 4]>,
    indices: Vec<u32>,
}

/// What a vertex has.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Point {
    pub at: Vec3,
    pub normal: Vec3,
    pub uv: Vec2,
    pub uv_b: Vec2,
    pub colour: Vec4,
}

/// How something stiff is painted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Paint {
    pub colour: Rgb,
    /// How much it gleams like metal, 0 to 1.
    pub shine: f32,
    /// How much of the floodlight it takes at night, 0 to 1.
    pub lit: f32,
}

impl Paint {
    pub(crate) const fn plain(colour: Rgb) -> Self {
        Self { colour, shine: 0.0, lit: 0.0 }
    }

    /// A point that is painted so.
    pub(crate) fn at(self, at: Vec3, normal: Vec3) -> Point {
        let [r, g, b] = self.colour.to_linear();
        Point { at, normal, uv: Vec2::new(0.0, self.shine), uv_b: Vec2::ZERO, colour: Vec4::new(r, g, b, self.lit) }
    }
}

impl Sculpt {
    /// How many vertices there are.
    pub(crate) fn vertices(&self) -> usize {
        self.positions.len()
    }

    pub(crate) fn point(&mut self, point: Point) -> u32 {
        let index = self.positions.len() as u32;
        self.positions.push(point.at.to_array());
        self.normals.push(point.normal.to_array());
        self.uvs.push(point.uv.to_array());
        self.uvs_b.push(point.uv_b.to_array());
        self.colours.push(point.colour.to_array());
        index
    }

    /// Four points counter-clockwise as two triangles.
    pub(crate) fn quad(&mut self, points: [Point; 4]) {
        let [a, b, c, d] = points.map(|point| self.point(point));
        self.indices.extend([a, b, c, a, c, d]);
    }

    /// A grid of points, `columns` to a row, counter-clockwise as seen where columns run to the right and rows up.
    pub(crate) fn grid(&mut self, columns: usize, points: impl IntoIterator<Item = Point>) {
        let first = self.positions.len() as u32;
        let count = points.into_iter().map(|point| self.point(point)).count();
        let wide = columns as u32;
        for row in 0..(count / columns.max(1)).saturating_sub(1) as u32 {
            for column in 0..wide.saturating_sub(1) {
                let a = first + row * wide + column;
                self.indices.extend([a, a + 1, a + wide + 1, a, a + wide + 1, a + wide]);
            }
        }
    }

    /// A flat face: corners counter-clockwise as seen from where its normal points.
    pub(crate) fn face(&mut self, corners: &[Vec3], paint: Paint) {
        let Some((&first, rest)) = corners.split_first() else { return };
        let normal = rest.windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum::<Vec3>().normalize_or(Vec3::Y);
        let all: Vec<u32> = corners.iter().map(|&at| self.point(paint.at(at, normal))).collect();
        for pair in all[1..].windows(2) {
            self.indices.extend([all[0], pair[0], pair[1]]);
        }
    }

    /// A box about a middle, by three half edges.
    pub(crate) fn block(&mut self, middle: Vec3, [x, y, z]: [Vec3; 3], paint: Paint) {
        for (out, a, b) in [(x, y, z), (y, z, x), (z, x, y), (-x, z, y), (-y, x, z), (-z, y, x)] {
            self.face(&[middle + out - a - b, middle + out + a - b, middle + out + a + b, middle + out - a + b], paint);
        }
    }

    /// A body turned about the way from one place to another: pairs of the share of that way and a radius.
    pub(crate) fn turned(&mut self, from: Vec3, to: Vec3, sides: usize, profile: &[(f32, f32)], paint: Paint) {
        let way = to - from;
        let axis = way.normalize_or(Vec3::Y);
        let right = axis.any_orthonormal_vector();
        let back = axis.cross(right);
        let slope = |n: usize| {
            let (a, b) = (profile[n.saturating_sub(1)], profile[(n + 1).min(profile.len() - 1)]);
            Vec2::new((b.0 - a.0) * way.length(), b.1 - a.1).normalize_or(Vec2::X)
        };
        let points = (0..profile.len()).flat_map(|n| {
            let ((share, radius), slope) = (profile[n], slope(n));
            (0..=sides).map(move |side| {
                let (sin, cos) = (core::f32::consts::TAU * side as f32 / sides as f32).sin_cos();
                let out = right * cos + back * sin;
                paint.at(from + way * share + out * radius, (out * slope.x - axis * slope.y).normalize_or(out))
            })
        });
        let points: Vec<Point> = points.collect();
        self.grid(sides + 1, points);
    }

    /// The mesh.
    pub(crate) fn mesh(self) -> Mesh {
        Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::RENDER_WORLD)
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, self.positions)
            .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, self.normals)
            .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, self.uvs)
            .with_inserted_attribute(Mesh::ATTRIBUTE_UV_1, self.uvs_b)
            .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, self.colours)
            .with_inserted_indices(Indices::U32(self.indices))
    }

    #[cfg(test)]
    pub(crate) fn points(&self) -> impl Iterator<Item = (Vec3, Vec3)> {
        self.positions.iter().zip(&self.normals).map(|(at, normal)| (Vec3::from_array(*at), Vec3::from_array(*normal)))
    }

    #[cfg(test)]
    pub(crate) fn triangles(&self) -> impl Iterator<Item = [Vec3; 3]> {
        self.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]].map(|n| Vec3::from_array(self.positions[n as usize])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_face_outwards() {
        let mut sculpt = Sculpt::default();
        let paint = Paint::plain(Rgb(200, 200, 200));
        sculpt.block(Vec3::new(1.0, 2.0, 3.0), [Vec3::X * 0.5, Vec3::Y, Vec3::Z * 2.0], paint);
        assert_eq!(sculpt.vertices(), 24);
        for (at, normal) in sculpt.points() {
            assert!((at - Vec3::new(1.0, 2.0, 3.0)).dot(normal) > 0.0);
        }
        let mut column = Sculpt::default();
        column.turned(Vec3::ZERO, Vec3::Y * 2.0, 12, &[(0.0, 0.3), (0.5, 0.3), (1.0, 0.3)], paint);
        for (at, normal) in column.points() {
            assert!(at.with_y(0.0).dot(normal) > 0.25 && normal.y.abs() < 1e-4, "{at} {normal}");
        }
        for [a, b, c] in column.triangles() {
            let normal = (b - a).cross(c - a);
            assert!(normal.dot(((a + b + c) / 3.0).with_y(0.0)) > 0.0, "{a} {b} {c}");
        }
    }
}
