//! Monuments: designs as meshes.
//!
//! A design's pieces are walked with a frame each; every shape is made of flat and smooth faces in its own frame (x right, y away
//! from who looks at its front, z up) and laid into the mesh through a [`Mason`].

mod cover;
mod path;
mod plate;
mod round;
mod sweep;
mod vault;

use core::ops::Range;

use glam::{DAffine3, DMat3, DVec2, DVec3};
use veduta_city::monument::{Axis, Content, Design, Head, Material, Model, Piece, Repeat, Shape};
use veduta_city::{CellShell, Level, PlacedMonument, Tile, metres};

use super::data::{MeshData, Paint, newell};
use super::outline::{Triangulator, centre_of, engine};
use super::roof::Roofer;
use path::RATIO;

/// How finely monuments are made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MonumentDetail {
    /// How far chords may stay off their arcs, metres.
    pub within_m: f64,
    /// Shapes are left out that are thinner than this in two directions, metres.
    pub least_m: f64,
    /// Whether openings have reveals, and walls backs.
    pub has_reveals: bool,
}

impl MonumentDetail {
    /// For the outline level: what is seen from afar.
    pub const COARSE: Self = Self { within_m: 0.12, least_m: 0.45, has_reveals: false };
    /// For level 2, which is seen from a street's width on.
    pub const MIDDLE: Self = Self { within_m: 0.03, least_m: 0.05, has_reveals: true };
    /// For level 4, from near by.
    pub const FINE: Self = Self { within_m: 0.008, least_m: 0.0, has_reveals: true };

    /// What is made for a level.
    #[must_use]
    pub const fn of(level: Level) -> Self {
        match level {
            Level::One => Self::COARSE,
            Level::Two | Level::Three => Self::MIDDLE,
            Level::Four => Self::FINE,
        }
    }
}

/// All monuments that a cell draws. Centres are where the outermost parts have their origins: a church's near tower shows finer than
/// its far one.
#[must_use]
pub fn monuments(shell: &CellShell, detail: MonumentDetail) -> MeshData {
    let mut mesh = MeshData::default();
    for placed in &shell.monuments {
        if let Some(design) = shell.designs.get(usize::from(placed.design)) {
            monument(design, placed, detail, &mut mesh);
        }
    }
    for object in &shell.objects {
        let Some((number, design)) = object.monument.and_then(|d| Some((d, shell.designs.get(usize::from(d))?))) else { continue };
        let placed = PlacedMonument { design: number, pos: object.pos, z: object.z, heading: object.heading % 360 * 100 };
        monument(design, &placed, detail, &mut mesh);
    }
    mesh
}

/// Least and greatest corner of a design in its own frame (x right, y away from who looks at its front, z up); metres.
#[must_use]
pub fn monument_bounds(design: &Design) -> (DVec3, DVec3) {
    let mut mesh = MeshData::default();
    let placed = PlacedMonument { design: 0, pos: veduta_city::GridPos(0, 0), z: 0, heading: 18_000 };
    monument(design, &placed, MonumentDetail::FINE, &mut mesh);
    let own = |p: &[f32; 3]| DVec3::new(f64::from(p[0]), -f64::from(p[2]), f64::from(p[1]));
    let corners = mesh.positions.iter().map(own);
    corners.fold((DVec3::ZERO, DVec3::ZERO), |(low, high), p| (low.min(p), high.max(p)))
}

/// Adds one monument to a mesh.
pub fn monument(design: &Design, placed: &PlacedMonument, detail: MonumentDetail, mesh: &mut MeshData) {
    let plan = placed.pos.to_metres();
    let heading = (f64::from(placed.heading) / 100.0).to_radians();
    let front = DVec2::new(libm::sin(heading), libm::cos(heading));
    // Right as seen by who looks at the front.
    let axes = DMat3::from_cols(engine(front.perp(), 0.0), engine(-front, 0.0), DVec3::Y);
    let foot = metres(placed.z);
    let frame = DAffine3::from_mat3_translation(axes, engine(plan, foot));
    let first = mesh.positions.len();
    let mut mason = Mason {
        mesh,
        materials: &design.materials,
        detail,
        centre: centre_of(plan),
        foot,
        frame,
        paint: Paint::new([0.0; 2], veduta_city::Rgb::default(), Tile::Stone),
        roofer: Roofer::default(),
        triangulator: Triangulator::default(),
    };
    mason.pieces(design, 0..design.pieces.len(), frame);
    mesh.stand(first, placed.z);
}

/// Adds the underside of a cross vault, in a frame of its own: x and y along its sides, z up from its springing.
pub(super) fn cross_vault(frame: DAffine3, size: [f64; 2], rise: f64, paint: Paint, mesh: &mut MeshData) {
    let mut mason = Mason {
        mesh,
        materials: &[],
        detail: MonumentDetail { within_m: 0.03, ..MonumentDetail::FINE },
        centre: paint.centre,
        foot: frame.translation.y,
        frame,
        paint,
        roofer: Roofer::default(),
        triangulator: Triangulator::default(),
    };
    mason.vault(size, rise, Head::Round, true);
}

/// Lays the faces of one shape after another.
struct Mason<'a> {
    mesh: &'a mut MeshData,
    materials: &'a [Material],
    detail: MonumentDetail,
    centre: [f32; 2],
    /// Height of the monument's foot: what lies on it faces nobody.
    foot: f64,
    /// Of the shape in the making, into the mesh's axes.
    frame: DAffine3,
    paint: Paint,
    roofer: Roofer,
    triangulator: Triangulator,
}

/// Faces as high above the foot as this, and facing down, lie on the ground; metres.
const ON_GROUND_M: f64 = 0.02;

impl Mason<'_> {
    fn pieces(&mut self, design: &Design, range: Range<usize>, within: DAffine3) {
        let is_whole = range.len() == design.pieces.len();
        for (piece, content, inner) in design.level(range) {
            let own = placement(piece);
            let mirrored = match piece.mirror {
                None => None,
                Some(Axis::X) => Some(DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0))),
                Some(Axis::Y) => Some(DAffine3::from_scale(DVec3::new(1.0, -1.0, 1.0))),
            };
            for copy in copies(piece.repeat) {
                let placed = within * copy;
                let sides = [Some(placed * own), mirrored.map(|mirror| placed * mirror * own)];
                for frame in sides.into_iter().flatten() {
                    if is_whole {
                        let DVec3 { x, z, .. } = frame.translation;
                        self.centre = [x as f32, z as f32];
                    }
                    self.piece(design, (piece, content), inner.clone(), frame);
                }
            }
        }
    }

    fn piece(&mut self, design: &Design, (piece, content): (&Piece, &Content), inner: Range<usize>, frame: DAffine3) {
        let before = (self.mesh.positions.len(), self.mesh.indices.len());
        self.frame = frame;
        self.paint = self.painted(Some(piece.paint));
        match content {
            Content::Group(_) => return self.pieces(design, inner, frame),
            Content::Shape(shape) => self.shape(shape, piece.infill),
            Content::Model(model) => self.model(model),
            Content::Again(_) => {}
        }
        if self.detail.least_m > 0.0 && self.is_slight(before.0) {
            super::roof::cut_back(self.mesh, before.0, before.1);
        }
    }

    fn painted(&self, material: Option<u8>) -> Paint {
        let found = material.and_then(|m| self.materials.get(usize::from(m)));
        let Material { colour, tile } =
            found.copied().unwrap_or(Material { colour: veduta_city::Rgb::default(), tile: Tile::Stone });
        Paint::new(self.centre, colour, tile)
    }

    fn shape(&mut self, shape: &Shape<i32>, infill: Option<u8>) {
        let infill = infill.map(|m| self.painted(Some(m)));
        match shape {
            Shape::Box { size } => self.cuboid(size.map(metres)),
            Shape::Cylinder { radius, height, top, sides } => {
                let (radius, height) = (metres(*radius), metres(*height));
                self.turned(&[DVec2::new(radius, 0.0), DVec2::new(top.map_or(radius, metres), height)], *sides);
            }
            Shape::Cone { radius, height, sides } => {
                self.turned(&[DVec2::new(metres(*radius), 0.0), DVec2::new(0.0, metres(*height))], *sides);
            }
            Shape::Sphere { radius } => self.sphere(metres(*radius)),
            Shape::Lathe { profile, sides } => {
                let profile = path::line(profile, false, self.detail.within_m);
                self.turned(&profile, *sides);
            }
            Shape::Extrusion { outline, holes, height } => self.extrusion(outline, holes, metres(*height)),
            Shape::Panel { outline, holes, depth, reveal } => {
                let depth = metres(*depth);
                self.panel(outline, holes, depth, reveal.map_or(depth / 2.0, metres), infill);
            }
            Shape::Sweep { section, along, closed } => self.sweep(section, along, *closed),
            Shape::Tube { path, sides } => self.tube(path, *sides),
            Shape::Vault { size, rise, head, cross } => self.vault(size.map(metres), metres(*rise), *head, *cross),
            Shape::Roof { outline, shape, height, direction_deg } => {
                self.cover(outline, *shape, *height, direction_deg.unwrap_or(0), infill);
            }
        }
    }

    /// What somebody modelled. Triangles of corners that are not there are left out.
    fn model(&mut self, model: &Model) {
        let first = self.mesh.positions.len() as u32;
        for vertex in &model.vertices {
            let uv = DVec2::from(vertex.uv.map(|n| f64::from(n) / RATIO)) * self.paint.size_m();
            self.vertex(DVec3::from(vertex.at.map(metres)), DVec3::from(vertex.normal.map(f64::from)), uv);
        }
        let count = model.vertices.len() as u32;
        for triangle in model.triangles.iter().filter(|triangle| triangle.iter().all(|&i| i < count)) {
            self.triangle(triangle.map(|i| first + i));
        }
    }

    /// Whether what was laid from a vertex on is thin in two directions.
    fn is_slight(&self, from: usize) -> bool {
        let mut bounds = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let inverse = self.frame.matrix3.inverse();
        let scale = DVec3::new(self.frame.x_axis.length(), self.frame.y_axis.length(), self.frame.z_axis.length());
        for p in &self.mesh.positions[from..] {
            let p = inverse * glam::Vec3::from_array(*p).as_dvec3() * scale;
            bounds = (bounds.0.min(p), bounds.1.max(p));
        }
        let mut sizes = (bounds.1 - bounds.0).to_array();
        sizes.sort_by(f64::total_cmp);
        sizes[1] < self.detail.least_m
    }

    /// Whether the frame turns left hands into right ones.
    fn is_mirrored(&self) -> bool {
        self.frame.matrix3.determinant() < 0.0
    }

    /// A flat convex face by its corners in the shape's frame, counter-clockwise seen from outside.
    fn face(&mut self, corners: &[DVec3]) {
        self.face_of(corners, self.paint);
    }

    fn face_of(&mut self, corners: &[DVec3], paint: Paint) {
        let mut placed: Vec<DVec3> = corners.iter().map(|&p| self.frame.transform_point3(p)).collect();
        if self.is_mirrored() {
            placed.reverse();
        }
        if !self.is_on_ground(&placed) {
            self.mesh.polygon(&placed, paint);
        }
    }

    fn is_on_ground(&self, placed: &[DVec3]) -> bool {
        placed.iter().all(|p| p.y < self.foot + ON_GROUND_M) && newell(placed).is_some_and(|normal| normal.y < -0.9)
    }

    /// A flat face whose texture is stretched from 0 to 1 over a rectangle of its plane; `uvs` for each corner.
    fn stretched(&mut self, corners: [DVec3; 3], uvs: [DVec2; 3], paint: Paint) {
        let placed = corners.map(|p| self.frame.transform_point3(p));
        let Some(normal) = newell(&placed) else { return };
        let normal = if self.is_mirrored() { -normal } else { normal };
        let index = [0, 1, 2].map(|i| self.mesh.vertex(placed[i], normal.as_vec3().to_array(), uvs[i], paint));
        self.triangle(index);
    }

    fn triangle(&mut self, [a, b, c]: [u32; 3]) {
        self.mesh.indices.extend(if self.is_mirrored() { [a, c, b] } else { [a, b, c] });
    }

    /// A vertex of a smooth face; `uv` in metres.
    fn vertex(&mut self, p: DVec3, normal: DVec3, uv: DVec2) -> u32 {
        let normal = self.frame.matrix3.inverse().transpose() * normal;
        let uv = uv / self.paint.size_m();
        self.mesh.vertex(self.frame.transform_point3(p), normal.normalize_or(DVec3::Y).as_vec3().to_array(), uv, self.paint)
    }

    /// A grid of smooth vertices, `columns` wide: quads between neighbours, counter-clockwise with columns to the right and
    /// rows upwards. Quads that have no area are left out.
    fn mend(&mut self, columns: usize, index: &[u32]) {
        let rows = index.len() / columns.max(1);
        for row in 1..rows {
            for column in 1..columns {
                let at = |r: usize, c: usize| index[r * columns + c];
                let quad = [at(row - 1, column - 1), at(row - 1, column), at(row, column), at(row, column - 1)];
                for t in [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]] {
                    let [a, b, c] = t.map(|i| glam::Vec3::from_array(self.mesh.positions[i as usize]));
                    if (b - a).cross(c - a).length_squared() > 1e-14 {
                        self.triangle(t);
                    }
                }
            }
        }
    }

    /// A box over the middle of its foot.
    fn cuboid(&mut self, [width, depth, height]: [f64; 3]) {
        let (x, y) = (width / 2.0, depth / 2.0);
        let foot = [DVec2::new(-x, -y), DVec2::new(x, -y), DVec2::new(x, y), DVec2::new(-x, y)];
        for (i, &a) in foot.iter().enumerate() {
            let b = foot[(i + 1) % 4];
            self.face(&[a.extend(0.0), b.extend(0.0), b.extend(height), a.extend(height)]);
        }
        self.face(&foot.map(|p| p.extend(height)));
        self.face(&[0, 3, 2, 1].map(|i| foot[i].extend(0.0)));
    }
}

/// Where a piece stands in what it is part of.
fn placement(piece: &Piece) -> DAffine3 {
    let [tilt, roll, turn] = piece.turn.map(|hundredths| (f64::from(hundredths) / 100.0).to_radians());
    let (s, c) = (libm::sin, libm::cos);
    // Its top (z) leans back (y).
    let tilt = DMat3::from_cols(DVec3::X, DVec3::new(0.0, c(tilt), -s(tilt)), DVec3::new(0.0, s(tilt), c(tilt)));
    // Its top (z) leans to the right (x).
    let roll = DMat3::from_cols(DVec3::new(c(roll), 0.0, -s(roll)), DVec3::Y, DVec3::new(s(roll), 0.0, c(roll)));
    // Clockwise from above: y turns to x.
    let turn = DMat3::from_cols(DVec3::new(c(turn), -s(turn), 0.0), DVec3::new(s(turn), c(turn), 0.0), DVec3::Z);
    let scale = DMat3::from_diagonal(DVec3::from(piece.scale.map(|ratio| f64::from(ratio) / RATIO)));
    DAffine3::from_mat3_translation(turn * tilt * roll * scale, DVec3::from(piece.at.map(metres)))
}

/// Where the copies of a piece stand.
fn copies(repeat: Option<Repeat<i32>>) -> impl Iterator<Item = DAffine3> {
    let count = repeat.as_ref().map_or(1, |repeat| (*repeat.count()).max(0));
    (0..count).map(move |i| match repeat {
        None => DAffine3::IDENTITY,
        Some(Repeat::Row { count, step, centred }) => {
            let before = if centred { f64::from(count - 1) / 2.0 } else { 0.0 };
            DAffine3::from_translation(DVec3::from(step.map(metres)) * (f64::from(i) - before))
        }
        Some(Repeat::Around { count, arc_deg, rise }) => {
            let arc = arc_deg.map_or(360.0, |hundredths| f64::from(hundredths) / 100.0).to_radians();
            let angle = arc * f64::from(i) / f64::from(count);
            let (s, c) = (libm::sin(angle), libm::cos(angle));
            let turn = DMat3::from_cols(DVec3::new(c, -s, 0.0), DVec3::new(s, c, 0.0), DVec3::Z);
            DAffine3::from_mat3_translation(turn, DVec3::Z * (metres(rise.unwrap_or(0)) * f64::from(i)))
        }
    })
}

#[cfg(test)]
mod tests;
