//! Gable walls that rise above their roofs.

use glam::{DVec2, DVec3};
use veduta_city::{Gable, Opening, Tile};

use super::data::{MeshData, Paint};
use super::outline::{Edge, Triangulator, engine};

/// Thickness of a gable wall, metres.
const THICK_M: f64 = 0.42;
/// How far a gable's steps stand above the roof at least, and its copings over its faces; metres.
const CLEAR_M: f64 = 0.3;
const COPING_M: f64 = 0.09;
const COPING_HEIGHT_M: f64 = 0.16;
/// Size of the bay of a window in a gable, how high over the eaves it begins, and how far it stands before the wall; metres.
const WINDOW_M: (f64, f64) = (1.7, 1.9);
const WINDOW_FOOT_M: f64 = 0.5;
const PROUD_M: f64 = 0.012;
/// Height of a step as near as the gable divides, metres.
const STEP_M: f64 = 1.25;

/// Half an outline from the eaves to the middle: share of half the width, share of the height of a plain gable. Every point lies
/// above the roof, which rises in a straight line.
const VOLUTE: [(f64, f64); 19] = [
    (0.0, 0.0),
    (0.0, 0.15),
    (0.09, 0.15),
    (0.12, 0.27),
    (0.17, 0.37),
    (0.24, 0.44),
    (0.3, 0.47),
    (0.3, 0.53),
    (0.37, 0.53),
    (0.4, 0.66),
    (0.45, 0.76),
    (0.52, 0.82),
    (0.6, 0.85),
    (0.6, 0.92),
    (0.68, 0.92),
    (0.74, 1.06),
    (0.82, 1.15),
    (0.91, 1.2),
    (1.0, 1.22),
];

/// Whether a wall that meets its roof along some points has a gable that this module shapes.
pub(super) fn is_shaped(gable: Gable, along: &[(f64, f64)]) -> bool {
    gable != Gable::Plain && along.len() == 3 && along[0].1 < 0.05 && along[2].1 < 0.05 && along[1].1 > 1.2
}

/// The gable above a wall: front, back and copings, and windows of the attic if wanted. `along`: where the roof meets it, as shares of
/// its length and metres above the eaves.
pub(super) fn gable(
    shape: Gable,
    edge: &Edge,
    eaves: f64,
    along: &[(f64, f64)],
    [plaster, trim]: [Paint; 2],
    has_windows: bool,
    mesh: &mut MeshData,
) {
    let (middle, height) = (along[1].0 * edge.length, along[1].1);
    let half = half(shape, height, middle.min(edge.length - middle));
    let left = half.iter().map(|&(share, h)| DVec2::new(middle * share, h));
    let right = half.iter().rev().map(|&(share, h)| DVec2::new(edge.length - (edge.length - middle) * share, h));
    let mut line: Vec<DVec2> = left.chain(right).collect();
    line.dedup_by(|a, b| a.distance_squared(*b) < 1e-8);
    let at = |p: DVec2, behind: f64| engine(edge.a + edge.along * p.x - edge.out * behind, eaves + p.y);
    // Counter-clockwise seen from the front: along the eaves, then back over the top.
    let ring: Vec<DVec2> = core::iter::once(line[0]).chain(line.iter().skip(1).rev().copied()).collect();
    let mut triangulator = Triangulator::default();
    triangulator.each(&[ring], |_, [a, b, c]| {
        let face = |corners: [DVec2; 3], behind: f64, mesh: &mut MeshData| {
            mesh.polygon(&corners.map(|p| at(p, behind)), plaster);
        };
        face([a, b, c], 0.0, mesh);
        face([a, c, b], THICK_M, mesh);
    });
    for pair in line.windows(2) {
        coping(pair, &at, trim, mesh);
    }
    if has_windows {
        let paint = plaster.with_tile(Tile::Bay(Opening::AtticWindow));
        for (row, foot) in [WINDOW_FOOT_M, WINDOW_FOOT_M + WINDOW_M.1 + 0.5].into_iter().enumerate() {
            // As wide as the roof is at the windows' heads.
            let room = edge.length * (1.0 - (foot + WINDOW_M.1) / height) - 0.8;
            let count = (room / (WINDOW_M.0 + 0.5)).floor().clamp(0.0, 3.0 - row as f64);
            for i in 0..count as u32 {
                let x = middle + (f64::from(i) - (count - 1.0) / 2.0) * (WINDOW_M.0 + 0.5);
                let (low, high) = (DVec2::new(x - WINDOW_M.0 / 2.0, foot), DVec2::new(x + WINDOW_M.0 / 2.0, foot + WINDOW_M.1));
                let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)].map(|p| at(p, -PROUD_M));
                let uvs = [(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)].map(|(u, v)| DVec2::new(u, v));
                mesh.quad(corners, edge.normal(), uvs, paint);
            }
        }
    }
}

/// The top of a gable along a piece of its outline: a slab that overhangs where it is no upright, else the wall's thickness.
fn coping(pair: &[DVec2], at: &impl Fn(DVec2, f64) -> DVec3, trim: Paint, mesh: &mut MeshData) {
    let (a, b) = (pair[0], pair[1]);
    let way = (b - a).normalize_or_zero();
    if way.x < 0.2 {
        mesh.polygon(&[at(a, THICK_M), at(a, 0.0), at(b, 0.0), at(b, THICK_M)], trim);
        return;
    }
    let (front, back) = (-COPING_M, THICK_M + COPING_M);
    let up = DVec2::new(-way.y, way.x) * COPING_HEIGHT_M;
    let reach = way * if way.y.abs() < 0.1 { COPING_M } else { 0.0 };
    let (a, b) = (a - reach, b + reach);
    let (c, d) = (b + up, a + up);
    mesh.polygon(&[at(a, front), at(b, front), at(c, front), at(d, front)], trim);
    mesh.polygon(&[at(b, back), at(a, back), at(d, back), at(c, back)], trim);
    mesh.polygon(&[at(d, front), at(c, front), at(c, back), at(d, back)], trim);
    mesh.polygon(&[at(a, back), at(b, back), at(b, front), at(a, front)], trim);
    mesh.polygon(&[at(a, back), at(a, front), at(d, front), at(d, back)], trim);
    mesh.polygon(&[at(b, front), at(b, back), at(c, back), at(c, front)], trim);
}

/// Half of a gable's outline: share of half the width, metres above the eaves.
fn half(shape: Gable, height: f64, half_m: f64) -> Vec<(f64, f64)> {
    match shape {
        Gable::Plain | Gable::Pediment => {
            let clear = CLEAR_M;
            vec![(0.0, 0.0), (0.0, clear), (1.0, height + clear)]
        }
        Gable::Volute => VOLUTE.iter().map(|&(share, h)| (share, h * height)).collect(),
        Gable::Stepped => {
            let steps = (height / STEP_M).round().clamp(3.0, 9.0);
            let mut out = vec![(0.0, 0.0)];
            for i in 0..steps as u32 {
                // Each step covers the roof up to its inner end; the last one is narrow and stands free.
                let (from, to) = (f64::from(i) / steps, f64::from(i + 1) / steps);
                let top = if to >= 1.0 { height + CLEAR_M.max(0.5 * STEP_M) } else { to * height + CLEAR_M };
                let narrower = if to >= 1.0 { (0.35 / half_m).min(0.3 / steps) } else { 0.0 };
                out.extend([(from + narrower, top), (to, top)]);
            }
            out
        }
    }
}

#[cfg(test)]
mod tests {
    use veduta_city::Rgb;

    use super::*;

    #[test]
    fn every_shape_stands_above_its_roof() {
        for shape in [Gable::Stepped, Gable::Volute, Gable::Pediment] {
            for (height, half_m) in [(2.0, 3.0), (4.5, 3.5), (9.0, 6.0)] {
                let half = half(shape, height, half_m);
                assert_eq!((half[0], half[half.len() - 1].0), ((0.0, 0.0), 1.0), "{shape:?}");
                for (i, pair) in half.windows(2).enumerate() {
                    assert!(pair[1].0 >= pair[0].0 - 1e-9, "{shape:?} {i}: it does not turn back");
                    for k in 0..=10 {
                        let t = f64::from(k) / 10.0;
                        let (share, h) = (pair[0].0 + (pair[1].0 - pair[0].0) * t, pair[0].1 + (pair[1].1 - pair[0].1) * t);
                        assert!(h >= share * height - 1e-9, "{shape:?}: the roof shows at {share}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_gable_is_a_sound_wall_with_a_front_and_a_back() {
        let edge = Edge::new(DVec2::ZERO, DVec2::new(7.0, 0.0)).expect("it has length");
        let paint = Paint::new([0.0; 2], Rgb(200, 180, 160), Tile::Plaster);
        for shape in [Gable::Stepped, Gable::Volute, Gable::Pediment] {
            let along = [(0.0, 0.0), (0.5, 4.5), (1.0, 0.0)];
            assert!(is_shaped(shape, &along) && !is_shaped(Gable::Plain, &along));
            let mut mesh = MeshData::default();
            gable(shape, &edge, 10.0, &along, [paint; 2], false, &mut mesh);
            let mut with_windows = MeshData::default();
            gable(shape, &edge, 10.0, &along, [paint; 2], true, &mut with_windows);
            let windows = with_windows.triangle_count() - mesh.triangle_count();
            assert_eq!(windows, 2, "{shape:?}: there is room for one");
            mesh.validate().unwrap_or_else(|e| panic!("{e}"));
            let front: f32 = facing(&mesh, [0.0, 0.0, 1.0]);
            let back: f32 = facing(&mesh, [0.0, 0.0, -1.0]);
            assert!(front > 15.7 && back > 15.7 && (front - back).abs() < 0.1, "{shape:?}: {front} m² and {back} m²");
            let low = mesh.positions.iter().map(|p| p[1]).fold(99.0, f32::min);
            assert!(low > 9.8, "{shape:?}: nothing hangs below the eaves");
        }
    }

    /// Area that looks a way, square metres.
    fn facing(mesh: &MeshData, way: [f32; 3]) -> f32 {
        let at = |i: u32| glam::Vec3::from_array(mesh.positions[i as usize]);
        let area = |t: &[u32]| (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])) / 2.0;
        mesh.indices.chunks_exact(3).map(area).filter(|a| a.normalize_or_zero().dot(way.into()) > 0.99).map(|a| a.length()).sum()
    }
}
