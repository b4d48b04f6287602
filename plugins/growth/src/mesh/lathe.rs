use glam::{DVec2, DVec3};
use veduta_city::RoofShape;

use super::data::{MeshData, Paint};
use super::form::{RoofForm, centroid};
use super::outline::engine;

/// Rings of a roof from the eaves up: share of the footprint's radius, share of the height.
type Rings = &'static [(f64, f64)];

const POINT: Rings = &[(1.0, 0.0), (0.0, 1.0)];
/// A quarter circle in steps of 15°.
const DOME: Rings = &[
    (1.0, 0.0),
    (0.965_925_826_3, 0.258_819_045_1),
    (0.866_025_403_8, 0.5),
    (core::f64::consts::FRAC_1_SQRT_2, core::f64::consts::FRAC_1_SQRT_2),
    (0.5, 0.866_025_403_8),
    (0.258_819_045_1, 0.965_925_826_3),
    (0.0, 1.0),
];
/// Bulb on a drum that is narrower than the tower, so that nothing hangs over its walls.
const ONION: Rings = &[
    (1.0, 0.0),
    (0.78, 0.03),
    (0.92, 0.1),
    (1.0, 0.2),
    (0.97, 0.31),
    (0.84, 0.42),
    (0.6, 0.53),
    (0.34, 0.62),
    (0.17, 0.72),
    (0.07, 0.85),
    (0.0, 1.0),
];

/// From this many corners on a footprint stands for a circle, and its roof is shaded round.
const ROUND_FROM: usize = 8;

/// Rings drawn towards the footprint's centroid, which must see every corner.
pub(super) fn lathe(form: &RoofForm<'_>, ring: &[DVec2], mesh: &mut MeshData, paint: Paint) {
    let rings = match form.volume.roof.shape {
        RoofShape::Dome => DOME,
        RoofShape::Onion => ONION,
        _ => POINT,
    };
    let axis = centroid(form.volume);
    let is_round = ring.len() >= ROUND_FROM && form.volume.roof.shape != RoofShape::Pyramidal;
    let place = |p: DVec2, (share, h): (f64, f64)| engine(axis + (p - axis) * share, form.eaves + form.height * h);
    let mut around = 0.0;
    for (i, &a) in ring.iter().enumerate() {
        let b = ring[(i + 1) % ring.len()];
        let width = (b - a).length();
        for (k, pair) in rings.windows(2).enumerate() {
            let (low, high) = (pair[0], pair[1]);
            let mut corners = [place(a, low), place(b, low), place(b, high), place(a, high)];
            let count = if high.0 > 0.0 { 4 } else { 3 };
            if !is_round {
                mesh.polygon(&corners[..count], paint);
                continue;
            }
            let normal = |p: DVec2, of: usize| round_normal(rings, of, p - axis, form.height);
            let normals = [normal(a, k), normal(b, k), normal(b, k + 1), normal(a, k + 1)];
            if count == 3 {
                corners[2] = engine(axis, form.eaves + form.height);
            }
            let down = |h: f64| (1.0 - h) * form.height / paint.size_m().y;
            let across = |at: f64| at / paint.size_m().x;
            let uvs = [(around, low.1), (around + width, low.1), (around + width, high.1), (around, high.1)];
            let mut index = [0; 4];
            for j in 0..count {
                index[j] = mesh.vertex(corners[j], normals[j], DVec2::new(across(uvs[j].0), down(uvs[j].1)), paint);
            }
            mesh.indices.extend([index[0], index[1], index[2]]);
            if count == 4 {
                mesh.indices.extend([index[0], index[2], index[3]]);
            }
        }
        around += width;
    }
}

/// Normal at a ring over a corner: the mean of the bands below and above it, as if the roof were turned about its axis.
fn round_normal(rings: Rings, of: usize, spoke: DVec2, height: f64) -> [f32; 3] {
    let radius = spoke.length().max(1e-6);
    let band = |k: usize| {
        rings
            .get(k..k + 2)
            .map_or(DVec2::ZERO, |w| DVec2::new((w[1].1 - w[0].1) * height, (w[0].0 - w[1].0) * radius).normalize_or_zero())
    };
    // A cone's point has the slope of its side; a drum's edge is sharp.
    let sum = if of == 0 || rings.len() == 2 { band(0) } else { band(of - 1) + band(of) };
    let profile = sum.normalize_or(DVec2::Y);
    let out = spoke / radius * profile.x;
    DVec3::new(out.x, profile.y, -out.y).normalize_or(DVec3::Y).as_vec3().to_array()
}
