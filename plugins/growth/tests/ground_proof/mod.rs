//! What must hold for the ground of any plan, and for its mesh.
#![allow(dead_code, reason = "each test uses its own part")]

use std::collections::{BTreeSet, HashMap};

use veduta_city::{CellShell, CityPlan, GridPolygon, GridPos, GroundPatch, SurfaceKind, metres, ring_edges};
use veduta_growth::mesh::{self, MeshData};

fn twice_area(polygon: &GridPolygon, o: GridPos) -> i64 {
    polygon.edges().map(|(a, b)| o.cross(a, b)).sum()
}

/// Nothing overlaps, and nothing is left open: every edge of a patch runs once, and once the other way but for the city's edge;
/// the areas make up the extent to the square of a grid step.
pub fn prove_partition(plan: &CityPlan) {
    let (lo, hi) = plan.extent.bounds().expect("it has an extent");
    let mut edges: HashMap<(GridPos, GridPos), u32> = HashMap::new();
    for edge in plan.ground.iter().flat_map(|patch| patch.outline.rings()).flat_map(|ring| ring_edges(ring)) {
        *edges.entry(edge).or_default() += 1;
    }
    for (&(a, b), &count) in &edges {
        let is_outer = a.0 == b.0 && (a.0 == lo.0 || a.0 == hi.0) || a.1 == b.1 && (a.1 == lo.1 || a.1 == hi.1);
        assert!(count == 1 && (is_outer || edges.contains_key(&(b, a))), "{a:?} {b:?} runs {count} times, and not back");
    }
    let areas = plan.ground.iter().map(|patch| twice_area(&patch.outline, lo));
    assert!(areas.clone().all(|area| area > 0));
    assert_eq!(areas.sum::<i64>(), twice_area(&plan.extent, lo));
}

/// The ground, as if it were closed above the ramps of tunnels.
fn ground(plan: &CityPlan) -> Vec<GroundPatch> {
    let closed = |patch: &GroundPatch| match patch.surface {
        SurfaceKind::Opening => GroundPatch { surface: SurfaceKind::Yard, ..patch.clone() },
        _ => patch.clone(),
    };
    plan.ground.iter().map(closed).collect()
}

/// The mesh of the ground: every triangle that is not a kerb's faces up, together they cover the extent, their edges meet whole
/// edges of others at the same height, and where the ground steps down a face closes the step.
pub fn prove_mesh(plan: &CityPlan) {
    let shell = CellShell { ground: ground(plan), ..CellShell::default() };
    let mesh: MeshData = mesh::ground(&shell);
    mesh.validate().unwrap_or_else(|e| panic!("{e}"));
    let place = |i: u32| mesh.positions[i as usize].map(f32::to_bits);
    let mut flat: HashMap<([u32; 3], [u32; 3]), u32> = HashMap::new();
    let mut faces: HashMap<([u32; 3], [u32; 3]), u32> = HashMap::new();
    let mut area = 0.0;
    for t in mesh.indices.chunks_exact(3) {
        let [a, b, c] = [t[0], t[1], t[2]].map(|i| glam::Vec3::from(mesh.positions[i as usize]).as_dvec3());
        let normal = (b - a).cross(c - a);
        let is_flat = a.y == b.y && b.y == c.y;
        assert!(!is_flat || normal.y > 0.0, "a triangle faces down");
        if is_flat {
            area += normal.y / 2.0;
        }
        for (i, j) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            *(if is_flat { &mut flat } else { &mut faces }).entry((place(i), place(j))).or_default() += 1;
        }
    }
    let heights: BTreeSet<u32> = plan.ground.iter().map(|patch| (metres(patch.z) as f32).to_bits()).collect();
    let whole = plan.extent.area_m2();
    assert!((area - whole).abs() < 1e-3 * whole.sqrt() + 1e-6 * whole, "{area} m² of {whole} m²");
    let bounds = plan.extent.bounds().expect("it has an extent");
    let (lo, hi) = (bounds.0.to_metres(), bounds.1.to_metres());
    let is_at = |v: f32, side: f64| (f64::from(v) - side).abs() < 1e-3;
    for &(p, q) in flat.keys() {
        let [a, b] = [p, q].map(|p| p.map(f32::from_bits));
        let is_outer = is_at(a[0], lo.x) && is_at(b[0], lo.x)
            || is_at(a[0], hi.x) && is_at(b[0], hi.x)
            || is_at(-a[2], lo.y) && is_at(-b[2], lo.y)
            || is_at(-a[2], hi.y) && is_at(-b[2], hi.y);
        let beyond = heights.iter().find(|&&y| flat.contains_key(&([q[0], y, q[2]], [p[0], y, p[2]])));
        assert!(is_outer || beyond.is_some(), "the ground is open at {a:?} {b:?}");
        let is_upper = beyond.is_some_and(|&y| f32::from_bits(y) < a[1]);
        assert!(!is_upper || faces.contains_key(&(q, p)), "no kerb closes the step at {a:?} {b:?}");
    }
}

/// The mesh of ground on a slope: whatever is not upright faces up, together it covers the extent, every edge is shared from corner to
/// corner, and where one side lies higher a kerb closes the step.
pub fn prove_slope(plan: &CityPlan) {
    let shell = CellShell { ground: ground(plan), terrain: plan.terrain.clone(), ..CellShell::default() };
    let mesh: MeshData = mesh::ground(&shell);
    mesh.validate().unwrap_or_else(|e| panic!("{e}"));
    let position = |i: u32| mesh.positions[i as usize];
    let place = |i: u32| [position(i)[0].to_bits(), position(i)[2].to_bits()];
    let mut ground: HashMap<([u32; 2], [u32; 2]), (f32, f32)> = HashMap::new();
    let mut kerbs: BTreeSet<([u32; 2], [u32; 2])> = BTreeSet::new();
    let mut area = 0.0;
    for t in mesh.indices.chunks_exact(3) {
        let [a, b, c] = [t[0], t[1], t[2]].map(|i| glam::Vec3::from(position(i)).as_dvec3());
        let is_ground = mesh.normals[t[0] as usize][1] > 0.2;
        if is_ground {
            let up = (b - a).cross(c - a).y;
            assert!(up > -1e-4, "a triangle faces down at {a}");
            area += up / 2.0;
        }
        for (i, j) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            if is_ground {
                ground.insert((place(i), place(j)), (position(i)[1], position(j)[1]));
            } else if place(i) != place(j) {
                kerbs.insert((place(i), place(j)));
            }
        }
    }
    let whole = plan.extent.area_m2();
    assert!((area - whole).abs() < 1e-3 * whole.sqrt() + 1e-6 * whole, "{area} m² of {whole} m²");
    let (lo, hi) = plan.extent.bounds().map(|(lo, hi)| (lo.to_metres(), hi.to_metres())).expect("it has an extent");
    let is_on = |p: [u32; 2], axis: usize, side: f64| (f64::from(f32::from_bits(p[axis])) - side).abs() < 1e-3;
    let sides = [(0, lo.x), (0, hi.x), (1, -lo.y), (1, -hi.y)];
    for (&(p, q), &(y, z)) in &ground {
        let is_outer = sides.iter().any(|&(axis, side)| is_on(p, axis, side) && is_on(q, axis, side));
        let at = p.map(f32::from_bits);
        let Some(&(beyond_q, beyond_p)) = ground.get(&(q, p)) else {
            assert!(is_outer, "the ground is open at {at:?}");
            continue;
        };
        let (step, other) = (y - beyond_p, z - beyond_q);
        assert!((step - other).abs() < 2e-4, "a step of {step} m becomes one of {other} m at {at:?}");
        assert!(step < 1e-3 || kerbs.contains(&(p, q)) || kerbs.contains(&(q, p)), "no kerb closes the step at {at:?}");
    }
}
