use glam::{DVec2, DVec3};
use veduta_city::{Rgb, Tile, metres};

/// Plain vertex data of a triangle mesh. The vertex vectors have one length; triangles are counter-clockwise seen from
/// outside. Faces that meet in an edge have vertices of their own; those that ground bends into share them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeshData {
    /// Metres: x east, y up, z south; plan relative to the cell's origin, height to the city's zero.
    pub positions: Vec<[f32; 3]>,
    /// Unit normals.
    pub normals: Vec<[f32; 3]>,
    /// In repeats of the tile, v downwards. On façades one repeat is one bay of one storey: the whole part of (u, −v) counts
    /// bays and storeys, so that a shader may tell windows apart.
    pub uvs: Vec<[f32; 2]>,
    /// Middle (x, z) of the façade or house that the vertex belongs to: exactly the same in every level's mesh of it.
    pub centres: Vec<[f32; 2]>,
    /// Linear red, green, blue that the tile is multiplied by, and the tile's layer ([`Tile::index`]); what that is off a whole number
    /// tells where the house's floor is, above the city's zero in [`MeshData::FLOORS_M`].
    pub colours: Vec<[f32; 4]>,
    /// Of walls in relief the normal of the wall (x, z), and how far before it the vertex lies, metres: what it is flattened by. Zero of
    /// what is never flattened; empty where nothing is.
    pub reliefs: Vec<[f32; 3]>,
    /// Three for each triangle.
    pub indices: Vec<u32>,
}

/// Why a mesh could not be made, or is not one.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MeshError {
    /// A level-2 packet that does not belong to the level-1 packet.
    #[error("the façade sheet tells {sheet} walls, but the shell lists {shell}: the two packets are not of one cell")]
    SheetLength {
        /// Walls of the shell.
        shell: usize,
        /// Walls of the sheet.
        sheet: usize,
    },
    /// Vertex vectors of different lengths.
    #[error("the mesh has {positions} positions but another number of {what}")]
    Ragged {
        /// Number of positions.
        positions: usize,
        /// The vector that differs.
        what: &'static str,
    },
    /// A number that is not finite.
    #[error("vertex {vertex} of the mesh has {what} that are not finite")]
    NotFinite {
        /// Which vertex.
        vertex: usize,
        /// Which vector.
        what: &'static str,
    },
    /// A normal whose length is not 1.
    #[error("vertex {0} of the mesh has a normal that is not of length 1")]
    Normal(usize),
    /// Indices that are not whole triangles of vertices.
    #[error("index {at} of the mesh is {index}, beyond its {vertices} vertices or not part of a triangle")]
    Index {
        /// Place among the indices.
        at: usize,
        /// The index.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
}

impl MeshData {
    /// A house's floor is told as this share of so many metres: see [`MeshData::colours`].
    pub const FLOORS_M: f64 = 1024.0;

    /// Whether there is nothing to draw.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }

    /// Number of triangles.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.indices.len() / 3
    }

    /// Adds another mesh.
    pub fn append(&mut self, other: &Self) {
        let base = self.positions.len() as u32;
        self.positions.extend_from_slice(&other.positions);
        self.normals.extend_from_slice(&other.normals);
        self.uvs.extend_from_slice(&other.uvs);
        self.centres.extend_from_slice(&other.centres);
        self.colours.extend_from_slice(&other.colours);
        if !self.reliefs.is_empty() || !other.reliefs.is_empty() {
            self.reliefs.resize(base as usize, [0.0; 3]);
            self.reliefs.extend_from_slice(&other.reliefs);
            self.reliefs.resize(self.positions.len(), [0.0; 3]);
        }
        self.indices.extend(other.indices.iter().map(|i| i + base));
    }

    /// Checks that the vectors fit together, all numbers are finite, normals have unit length and indices exist.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub fn validate(&self) -> Result<(), MeshError> {
        let positions = self.positions.len();
        let lengths = [
            ("normals", self.normals.len()),
            ("uvs", self.uvs.len()),
            ("centres", self.centres.len()),
            ("colours", self.colours.len()),
        ];
        if let Some((what, _)) = lengths.into_iter().find(|&(_, n)| n != positions) {
            return Err(MeshError::Ragged { positions, what });
        }
        if !self.reliefs.is_empty() && self.reliefs.len() != positions {
            return Err(MeshError::Ragged { positions, what: "reliefs" });
        }
        all_finite("reliefs", &self.reliefs)?;
        all_finite("positions", &self.positions)?;
        all_finite("normals", &self.normals)?;
        all_finite("uvs", &self.uvs)?;
        all_finite("centres", &self.centres)?;
        all_finite("colours", &self.colours)?;
        let unit = |n: &[f32; 3]| (n.iter().map(|c| c * c).sum::<f32>() - 1.0).abs() < 1e-3;
        if let Some(vertex) = self.normals.iter().position(|n| !unit(n)) {
            return Err(MeshError::Normal(vertex));
        }
        let whole = self.indices.len() / 3 * 3;
        let bad = self.indices.iter().enumerate().find(|&(at, &i)| i as usize >= positions || at >= whole);
        bad.map_or(Ok(()), |(at, &index)| Err(MeshError::Index { at, index, vertices: positions }))
    }

    /// Tells of the vertices from `first` on how high the ground floor of their house lies: see [`MeshData::colours`].
    pub(super) fn stand(&mut self, first: usize, floor: i32) {
        if floor != 0 {
            let share = (metres(floor) / Self::FLOORS_M).clamp(-0.49, 0.49) as f32;
            self.colours[first..].iter_mut().for_each(|colour| colour[3] += share);
        }
    }

    /// Room for this many more quads.
    pub(super) fn reserve_quads(&mut self, quads: usize) {
        self.positions.reserve(quads * 4);
        self.normals.reserve(quads * 4);
        self.uvs.reserve(quads * 4);
        self.centres.reserve(quads * 4);
        self.colours.reserve(quads * 4);
        self.indices.reserve(quads * 6);
    }

    /// Adds a vertex and tells its index.
    pub(super) fn vertex(&mut self, position: DVec3, normal: [f32; 3], uv: DVec2, paint: Paint) -> u32 {
        let index = self.positions.len() as u32;
        self.positions.push(position.as_vec3().to_array());
        self.normals.push(normal);
        self.uvs.push(uv.as_vec2().to_array());
        self.centres.push(paint.centre);
        self.colours.push(paint.colour);
        index
    }

    /// Adds a quad, corners counter-clockwise seen from outside.
    pub(super) fn quad(&mut self, corners: [DVec3; 4], normal: [f32; 3], uvs: [DVec2; 4], paint: Paint) {
        let base = self.positions.len() as u32;
        self.positions.extend(corners.map(|p| p.as_vec3().to_array()));
        self.normals.extend([normal; 4]);
        self.uvs.extend(uvs.map(|uv| uv.as_vec2().to_array()));
        self.centres.extend([paint.centre; 4]);
        self.colours.extend([paint.colour; 4]);
        self.indices.extend([base, base + 1, base + 2, base, base + 2, base + 3]);
    }

    /// Adds a flat convex polygon, counter-clockwise seen from outside, with texture coordinates in metres over the tile's
    /// size that run level and uphill. Nothing if it has no area.
    pub(super) fn polygon(&mut self, corners: &[DVec3], paint: Paint) {
        self.polygon_as(corners, corners, paint);
    }

    /// The same with texture coordinates as if its corners were elsewhere.
    pub(super) fn polygon_as(&mut self, corners: &[DVec3], charted: &[DVec3], paint: Paint) {
        let Some((normal, chart)) = newell_sum(corners).and_then(|sum| Chart::across(sum, paint.tile)) else { return };
        let base = self.positions.len() as u32;
        self.positions.extend(corners.iter().map(|p| p.as_vec3().to_array()));
        self.normals.extend(corners.iter().map(|_| normal.as_vec3().to_array()));
        self.uvs.extend(charted.iter().map(|&p| chart.uv(p).as_vec2().to_array()));
        self.centres.extend(corners.iter().map(|_| paint.centre));
        self.colours.extend(corners.iter().map(|_| paint.colour));
        for i in 1..corners.len() as u32 - 1 {
            self.indices.extend([base, base + i, base + i + 1]);
        }
    }
}

fn all_finite<const N: usize>(what: &'static str, of: &[[f32; N]]) -> Result<(), MeshError> {
    match of.iter().position(|v| !v.iter().all(|c| c.is_finite())) {
        Some(vertex) => Err(MeshError::NotFinite { vertex, what }),
        None => Ok(()),
    }
}

/// Unit normal of a polygon by Newell's sum; `None` if it has (next to) no area.
pub(super) fn newell(corners: &[DVec3]) -> Option<DVec3> {
    let sum = newell_sum(corners)?;
    let length = sum.length();
    (length > NO_AREA).then(|| sum * length.recip())
}

/// Sums of normals shorter than this are of polygons without area.
const NO_AREA: f64 = 1e-9;

/// A normal of a polygon, as long as twice its area; `None` of no corner.
fn newell_sum(corners: &[DVec3]) -> Option<DVec3> {
    let first = *corners.first()?;
    Some(corners.windows(2).map(|w| (w[0] - first).cross(w[1] - first)).sum())
}

/// What a face is drawn with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Paint {
    pub(super) centre: [f32; 2],
    pub(super) colour: [f32; 4],
    pub(super) tile: Tile,
}

impl Paint {
    pub(super) fn new(centre: [f32; 2], colour: Rgb, tile: Tile) -> Self {
        let [r, g, b] = colour.to_linear();
        Self { centre, colour: [r, g, b, tile.index() as f32], tile }
    }

    /// The same colour and tile at another place.
    pub(super) fn at(self, centre: [f32; 2]) -> Self {
        Self { centre, ..self }
    }

    /// The same place and colour with another tile.
    pub(super) fn with_tile(self, tile: Tile) -> Self {
        let [r, g, b, _] = self.colour;
        Self { colour: [r, g, b, tile.index() as f32], tile, ..self }
    }

    /// Width and height of a repeat in metres.
    pub(super) fn size_m(self) -> DVec2 {
        let (width, height) = self.tile.size_m();
        DVec2::new(f64::from(width), f64::from(height))
    }
}

/// Texture axes of a plane: u level, v downhill.
struct Chart {
    u: DVec3,
    v: DVec3,
}

impl Chart {
    /// The axes across a normal of any length, and the unit normal; `None` if it has (next to) no length.
    fn across(normal: DVec3, tile: Tile) -> Option<(DVec3, Self)> {
        let level = DVec3::new(normal.z, 0.0, -normal.x);
        // One root does not wait for the other.
        let (length, run) = (normal.length(), level.length());
        if length <= NO_AREA {
            return None;
        }
        let normal = normal * length.recip();
        let u = if run > 1e-3 * length { level * run.recip() } else { DVec3::X };
        let (width, height) = tile.size_m();
        let [across, down] = [width, height].map(|size| f64::from(size).recip());
        Some((normal, Self { u: u * across, v: u.cross(normal) * down }))
    }

    fn uv(&self, p: DVec3) -> DVec2 {
        DVec2::new(self.u.dot(p), self.v.dot(p))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> MeshData {
        let mut mesh = MeshData::default();
        let paint = Paint::new([0.0; 2], Rgb(255, 255, 255), Tile::Plaster);
        mesh.polygon(&[DVec3::ZERO, DVec3::X, DVec3::Y], paint);
        mesh
    }

    #[test]
    fn a_polygon_faces_the_side_it_turns_left_on() {
        let mesh = triangle();
        assert_eq!(mesh.validate(), Ok(()));
        assert_eq!(mesh.normals, [[0.0, 0.0, 1.0]; 3]);
        assert!(mesh.uvs[2][1] < mesh.uvs[0][1], "v runs downwards");
        assert!(mesh.uvs[1][0] > mesh.uvs[0][0], "u runs to the right");
    }

    #[test]
    fn appended_indices_move_along() {
        let mut mesh = triangle();
        mesh.append(&triangle());
        assert_eq!((mesh.triangle_count(), mesh.validate()), (2, Ok(())));
        assert_eq!(mesh.indices, [0, 1, 2, 3, 4, 5]);
    }

    #[test]
    fn validation_finds_each_fault() {
        let fault = |spoil: fn(&mut MeshData)| {
            let mut mesh = triangle();
            spoil(&mut mesh);
            mesh.validate().unwrap_err()
        };
        assert_eq!(fault(|m| m.uvs.truncate(1)), MeshError::Ragged { positions: 3, what: "uvs" });
        assert_eq!(fault(|m| m.positions[1][0] = f32::NAN), MeshError::NotFinite { vertex: 1, what: "positions" });
        assert_eq!(fault(|m| m.normals[2] = [0.5; 3]), MeshError::Normal(2));
        assert_eq!(fault(|m| m.indices[0] = 3), MeshError::Index { at: 0, index: 3, vertices: 3 });
        assert_eq!(fault(|m| m.indices.truncate(2)), MeshError::Index { at: 0, index: 0, vertices: 3 });
    }
}
