use glam::{DVec2, DVec3};
use veduta_city::{CellShell, Tile, VolumeShell, metres};

use super::data::{MeshData, Paint};
use super::form::{Affine, Form, Ridge, RoofForm};
use super::hip::{Pieces, clip, hip};
use super::lathe::lathe;
use super::outline::{Rings, Triangulator, centre_of, contains, draw_at, engine, middle, rings, wall_edge};
use super::roof_detail;
use crate::skeleton::Skeletons;

/// How far above the cell's lowest ground a volume must begin for its underside to be seen; metres.
const HANGING_M: f64 = 1.5;

/// Most houses' roofs are drawn with no more quads than this, all of them and their coverings alone.
const ROOF_QUADS: usize = 48;
const COVERING_QUADS: usize = 9;

/// Roofs of the volumes that this cell draws: coverings, overhanging eaves, parapets, chimneys, dormers, and the undersides of
/// volumes that hang in the air. Centres are the middles of the volumes' footprints.
#[must_use]
pub fn roofs(shell: &CellShell) -> MeshData {
    made(shell, ROOF_QUADS, true, true)
}

/// Of those [`roofs`] what is seen from afar: coverings, and the undersides of volumes that hang in the air.
#[must_use]
pub fn roof_bodies(shell: &CellShell) -> MeshData {
    made(shell, COVERING_QUADS, true, false)
}

/// The rest of them: overhanging eaves, parapets, chimneys, dormers.
#[must_use]
pub fn roof_details(shell: &CellShell) -> MeshData {
    made(shell, ROOF_QUADS, false, true)
}

fn made(shell: &CellShell, quads: usize, has_bodies: bool, has_details: bool) -> MeshData {
    let mut mesh = MeshData::default();
    mesh.reserve_quads(shell.houses.len() * quads);
    let mut roofer = Roofer::default();
    for house in shell.houses.iter().filter(|house| !house.is_monument) {
        for volume in house.volumes.iter().filter(|v| v.has_roof) {
            let first = mesh.positions.len();
            let Some(form) = roofer.start(volume) else { continue };
            let indices = mesh.indices.len();
            // Details follow the pieces that the covering is cut into.
            roofer.cover(&form, &mut mesh);
            if !has_bodies {
                cut_back(&mut mesh, first, indices);
            } else if metres(volume.bottom) > metres(house.floor) + HANGING_M {
                roofer.underside(volume, &mut mesh);
            }
            if has_details {
                let corner = volume.footprint.outer.first().copied().unwrap_or_default();
                roof_detail::details(draw_at(shell, corner, "roof"), &form, &mut roofer, &mut mesh);
            }
            mesh.stand(first, house.floor);
        }
    }
    mesh
}

/// The roofs' coverings alone: within the footprints, from the eaves to at most the roof's height.
#[must_use]
pub fn roof_coverings(shell: &CellShell) -> MeshData {
    let mut mesh = MeshData::default();
    mesh.reserve_quads(shell.houses.len() * COVERING_QUADS);
    let mut roofer = Roofer::default();
    let houses = shell.houses.iter().filter(|house| !house.is_monument);
    for volume in houses.flat_map(|house| &house.volumes).filter(|v| v.has_roof) {
        if let Some(form) = roofer.start(volume) {
            roofer.cover(&form, &mut mesh);
        }
    }
    mesh
}

/// Makes roofs; keeps its memory between them.
#[derive(Default)]
pub(super) struct Roofer {
    pub(super) rings: Rings,
    pub(super) pieces: Pieces,
    pub(super) triangulator: Triangulator,
    pub(super) skeletons: Skeletons,
    pub(super) along: Vec<(f64, f64)>,
    buffers: [Vec<DVec3>; 3],
}

/// What a roof's covering is drawn with.
pub(super) fn covering(volume: &VolumeShell) -> Paint {
    let tile = Tile::of_roof(volume.roof.shape, volume.roof.colour);
    Paint::new(centre_of(middle(&volume.footprint)), volume.roof.colour, tile)
}

impl Roofer {
    /// Looks at a volume; `None` if its footprint is no area.
    pub(super) fn start<'a>(&mut self, volume: &'a VolumeShell) -> Option<RoofForm<'a>> {
        self.rings = rings(&volume.footprint);
        self.pieces.clear();
        (!self.rings.is_empty()).then(|| RoofForm::new(volume))
    }

    pub(super) fn cover(&mut self, form: &RoofForm<'_>, mesh: &mut MeshData) {
        let before = (mesh.positions.len(), mesh.indices.len());
        let paint = covering(form.volume);
        match form.form {
            Form::Flat => self.flat(form, mesh, paint),
            Form::Lathe => lathe(form, &self.rings[0], mesh, paint),
            _ => {
                self.piece(form, mesh, paint);
                self.lay(form, mesh, paint);
            }
        }
        if matches!(form.form, Form::Hip | Form::Lathe) && !self.covers(mesh, before.1) {
            cut_back(mesh, before.0, before.1);
            self.pieces.clear();
            self.flat(form, mesh, paint);
        }
    }

    fn flat(&mut self, form: &RoofForm<'_>, mesh: &mut MeshData, paint: Paint) {
        self.triangulator.each(&self.rings, |_, places| mesh.polygon(&places.map(|p| engine(p, form.eaves)), paint));
    }

    fn underside(&mut self, volume: &VolumeShell, mesh: &mut MeshData) {
        let paint = Paint::new(centre_of(middle(&volume.footprint)), volume.colour, Tile::Plaster);
        let bottom = metres(volume.bottom);
        self.triangulator.each(&self.rings, |_, [a, b, c]| mesh.polygon(&[a, c, b].map(|p| engine(p, bottom)), paint));
    }

    /// Whether the covering from an index on covers the footprint once, to a hundredth.
    fn covers(&self, mesh: &MeshData, from: usize) -> bool {
        let whole: f64 = self.rings.iter().map(|ring| super::outline::area(ring)).sum();
        let at = |i: u32| mesh.positions.get(i as usize).map_or(DVec2::ZERO, |p| DVec2::new(f64::from(p[0]), -f64::from(p[2])));
        let triangles = mesh.indices[from..].chunks_exact(3);
        let sum: f64 = triangles.map(|t| (at(t[1]) - at(t[0])).perp_dot(at(t[2]) - at(t[0])) / 2.0).sum();
        (sum - whole).abs() < 0.01 * whole
    }

    /// Cuts the footprint into pieces by the roof's parameter.
    fn piece(&mut self, form: &RoofForm<'_>, mesh: &mut MeshData, paint: Paint) {
        match form.form {
            Form::Ridge(ridge) => ridge_pieces(form.volume, &ridge, &mut self.pieces),
            Form::Planes(planes, n) => self.plane_pieces(&planes[..n.min(4)]),
            Form::Saw(steps, n) => self.teeth(form, steps, n, mesh, paint),
            Form::Hip => hip(&self.rings, &mut self.pieces, &mut self.skeletons, &mut self.triangulator),
            Form::Flat | Form::Lathe => {}
        }
    }

    fn plane_pieces(&mut self, planes: &[Affine]) {
        let Self { rings, pieces, triangulator, buffers: [face, cut, _], .. } = self;
        triangulator.each(rings, |_, places| {
            for (i, plane) in planes.iter().enumerate() {
                face.clear();
                face.extend(places.map(|p| p.extend(plane.at(p))));
                for (_, other) in planes.iter().enumerate().filter(|&(j, _)| j != i) {
                    clip(face, cut, |p| plane.at(p.truncate()) - other.at(p.truncate()));
                    core::mem::swap(face, cut);
                }
                pieces.push(face.iter().map(|p| p.truncate().extend(p.z.clamp(0.0, 1.0))));
            }
        });
    }

    /// Pieces of a saw-tooth roof, and its upright faces, which are no part of the covering's parameter.
    fn teeth(&mut self, form: &RoofForm<'_>, steps: Affine, n: u32, mesh: &mut MeshData, paint: Paint) {
        let Self { rings, pieces, triangulator, buffers: [face, cut, whole], .. } = self;
        let up = steps.slope.normalize_or_zero() * 1e-3;
        triangulator.each(rings, |_, places| {
            whole.clear();
            whole.extend(places.map(|p| p.extend(steps.at(p))));
            for tooth in 0..n {
                let (low, high) = (f64::from(tooth), f64::from(tooth + 1));
                clip(whole, cut, |p| low - p.z);
                clip(cut, face, |p| p.z - high);
                pieces.push(face.iter().map(|p| p.truncate().extend((p.z - low).clamp(0.0, 1.0))));
                for (i, &a) in face.iter().enumerate() {
                    let b = face[(i + 1) % face.len()];
                    let is_ridge = (a.z - high).abs() < 1e-9 && (b.z - high).abs() < 1e-9;
                    if is_ridge && contains(rings, (a.truncate() + b.truncate()) / 2.0 + up) {
                        let at = |p: DVec3, h: f64| engine(p.truncate(), form.eaves + h);
                        mesh.polygon(&[at(a, 0.0), at(b, 0.0), at(b, form.height), at(a, form.height)], paint);
                    }
                }
            }
        });
    }

    /// Lays the covering over the pieces, cut where the profile breaks.
    fn lay(&mut self, form: &RoofForm<'_>, mesh: &mut MeshData, paint: Paint) {
        let raise = |p: DVec3| engine(p.truncate(), form.eaves + form.height * form.bend(p.z));
        let [band, cut, raised] = &mut self.buffers;
        for piece in self.pieces.iter() {
            if form.profile.len() == 2 {
                raised.clear();
                raised.extend(piece.iter().map(|&p| raise(p)));
                mesh.polygon(raised, paint);
                continue;
            }
            for step in form.profile.windows(2) {
                clip(piece, cut, |p| step[0].0 - p.z);
                clip(cut, band, |p| p.z - step[1].0);
                raised.clear();
                raised.extend(band.iter().map(|&p| raise(p)));
                if raised.len() >= 3 {
                    mesh.polygon(raised, paint);
                }
            }
        }
    }
}

pub(super) fn cut_back(mesh: &mut MeshData, vertices: usize, indices: usize) {
    mesh.positions.truncate(vertices);
    mesh.normals.truncate(vertices);
    mesh.uvs.truncate(vertices);
    mesh.centres.truncate(vertices);
    mesh.colours.truncate(vertices);
    mesh.indices.truncate(indices);
}

/// The two sides of a level ridge, and the hips at its ends if it has any.
fn ridge_pieces(volume: &VolumeShell, ridge: &Ridge, pieces: &mut Pieces) {
    let footprint = &volume.footprint;
    let n = footprint.outer.len();
    let [Some(far), Some(near)] = ridge.gables.map(|g| wall_edge(footprint, g)) else { return };
    let meets = [far.at(ridge.shares[0]), near.at(ridge.shares[1])];
    let inwards = (meets[1] - meets[0]).normalize_or_zero() * ridge.hip_run;
    let tops = [(meets[0] + inwards).extend(1.0), (meets[1] - inwards).extend(1.0)];
    // The far gable is crossed from the right side to the left, the near one back to the right.
    let gables = [(far, near, 0), (near, far, 1)];
    let t = ridge.gable_top();
    for (from, to, end) in gables {
        // One side: from the end of gable `end` along the eaves to the start of the other.
        let other = 1 - end;
        let eaves = (1..=n).map(|k| (ridge.gables[end] + k) % n);
        let last = ridge.gables[other];
        let mut upper = Vec::with_capacity(4);
        if t < 1.0 {
            upper.push(from.b.lerp(meets[end], t).extend(t));
        }
        upper.extend([tops[end], tops[other]]);
        if t < 1.0 {
            upper.push(to.a.lerp(meets[other], t).extend(t));
        }
        let mut lower: Vec<DVec3> = Vec::with_capacity(n);
        for i in eaves {
            lower.push(footprint.outer.get(i).map_or(DVec2::ZERO, |p| p.to_metres()).extend(0.0));
            if i == last {
                break;
            }
        }
        let along = if end == 0 { -ridge.along } else { ridge.along };
        zip(&lower, &upper, along, pieces);
        if t < 1.0 {
            pieces.push([from.a.lerp(meets[end], t).extend(t), from.b.lerp(meets[end], t).extend(t), tops[end]]);
        }
    }
}

/// Triangles between two lines of points that run the same way; the upper one lies on the left.
fn zip(lower: &[DVec3], upper: &[DVec3], along: DVec2, pieces: &mut Pieces) {
    let (mut i, mut j) = (0, 0);
    while let (Some(&a), Some(&b)) = (lower.get(i), upper.get(j)) {
        let way = |p: Option<&DVec3>, q: DVec3| p.map(|p| (p.truncate() + q.truncate()).dot(along));
        match (way(lower.get(i + 1), a), way(upper.get(j + 1), b)) {
            (Some(l), u) if u.is_none_or(|u| l <= u) => {
                pieces.push([a, lower[i + 1], b]);
                i += 1;
            }
            (_, Some(_)) => {
                pieces.push([a, upper[j + 1], b]);
                j += 1;
            }
            _ => break,
        }
    }
}
