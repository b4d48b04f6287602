//! A city's meshes, and what a ray meets of them.

use core::ops::Range;

use bvh::aabb::{Aabb, Bounded};
use bvh::bounding_hierarchy::{BHShape, BoundingHierarchy};
use bvh::bvh::{Bvh, BvhNode};
use bvh::ray::Ray;
use glam::{DVec3, Vec3};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use veduta_city::{CellShell, Season};
use veduta_growth::mesh::{self, MeshData, MonumentDetail};

/// What stands in a city, as rays meet it. East, up and south of the anchor, metres.
pub(super) struct Scene {
    /// What hides what lies behind: ground, walls, roofs, spans, monuments.
    solid: Faces,
    /// What is seen but hides nothing for certain: trees and furniture.
    loose: Faces,
    /// Faces of each cell, solid ones first.
    by_cell: Vec<(Range<usize>, Range<usize>)>,
}

/// Where a ray meets something.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hit {
    /// Metres from the eye.
    pub(super) distance_m: f64,
    /// The cell that the face is drawn with.
    pub(super) cell: u32,
    /// Whether it hides nothing for certain.
    pub(super) is_loose: bool,
}

impl Scene {
    /// Of all cells' packets of level 1.
    pub(super) fn new(shells: &[CellShell]) -> Self {
        let parts: Vec<[Vec<Face>; 2]> = (0..).zip(shells).collect::<Vec<_>>().into_par_iter().map(faces).collect();
        let (mut solid, mut loose, mut by_cell) = (Vec::new(), Vec::new(), Vec::new());
        for [firm, soft] in parts {
            by_cell.push((solid.len()..solid.len() + firm.len(), loose.len()..loose.len() + soft.len()));
            solid.extend(firm);
            loose.extend(soft);
        }
        Self { solid: Faces::new(solid), loose: Faces::new(loose), by_cell }
    }

    /// Number of triangles.
    pub(super) fn len(&self) -> usize {
        self.solid.faces.len() + self.loose.faces.len()
    }

    /// Whether nothing solid stands between two places.
    pub(super) fn is_open(&self, from: DVec3, to: DVec3) -> bool {
        self.solid.nearest(from, to - from).is_none_or(|hit| hit.distance_m >= from.distance(to))
    }

    /// What a ray meets: what is loose, once a cell, then the solid thing that it ends at, if any.
    pub(super) fn look(&self, eye: DVec3, direction: DVec3, seen: &mut Vec<Hit>) {
        let end = self.solid.nearest(eye, direction);
        seen.clear();
        self.loose.all(eye, direction, end.map_or(f64::INFINITY, |hit| hit.distance_m), seen);
        seen.extend(end);
    }

    /// A place on something of a cell: of the `n`th face modulo their number, at two shares in [0, 1).
    pub(super) fn place_on(&self, cell: u32, n: usize, (u, v): (f64, f64)) -> Option<DVec3> {
        let (solid, loose) = &self.by_cell[cell as usize];
        let n = n.checked_rem(solid.len() + loose.len())?;
        let face = match n.checked_sub(solid.len()) {
            None => &self.solid.faces[solid.start + n],
            Some(n) => &self.loose.faces[loose.start + n],
        };
        let [a, b, c] = face.corners;
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        Some(a + u * (b - a) + v * (c - a))
    }
}

/// Triangles of a cell: those that hide, and those that do not.
fn faces((cell, shell): (u32, &CellShell)) -> [Vec<Face>; 2] {
    let mut solid = mesh::ground(shell);
    let monuments = mesh::monuments(shell, MonumentDetail::COARSE);
    for more in [mesh::footings(shell), mesh::spans(shell), mesh::roofs(shell), mesh::level1(shell), monuments] {
        solid.append(&more);
    }
    let mut loose = mesh::objects(shell);
    loose.append(&mesh::trees(shell, Season::Summer));
    let at = shell.origin.to_metres();
    let at = DVec3::new(at.x, 0.0, -at.y);
    let of = |mesh: &MeshData| {
        let corner = |i: u32| Vec3::from(mesh.positions[i as usize]).as_dvec3() + at;
        mesh.indices.chunks_exact(3).map(|t| Face { corners: [corner(t[0]), corner(t[1]), corner(t[2])], cell, node: 0 }).collect()
    };
    [of(&solid), of(&loose)]
}

#[derive(Debug, Clone, Copy)]
struct Face {
    corners: [DVec3; 3],
    cell: u32,
    node: usize,
}

impl Bounded<f64, 3> for Face {
    fn aabb(&self) -> Aabb<f64, 3> {
        let [a, b, c] = self.corners;
        // A ray within the plane of a flat box would miss it.
        let (low, high) = (a.min(b).min(c) - DVec3::splat(THICKNESS_M), a.max(b).max(c) + DVec3::splat(THICKNESS_M));
        Aabb::with_bounds(point(low), point(high))
    }
}

/// Boxes of faces are larger than these by so much, metres.
const THICKNESS_M: f64 = 1e-6;

impl BHShape<f64, 3> for Face {
    fn set_bh_node_index(&mut self, node: usize) {
        self.node = node;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

impl Face {
    /// How many times a direction leads from an eye to the face. Faces that share an edge leave no gap between them: for both it is
    /// the same product with the opposite sign that tells the sides of the edge (as Woop, Benthin and Wald, *Watertight
    /// ray/triangle intersection*, 2013, do in another frame).
    fn meets(&self, eye: DVec3, direction: DVec3) -> Option<f64> {
        let [a, b, c] = self.corners.map(|corner| corner - eye);
        let side = |a: DVec3, b: DVec3| direction.dot(a.cross(b));
        let sides = [side(b, c), side(c, a), side(a, b)];
        if sides.iter().any(|&s| s < 0.0) && sides.iter().any(|&s| s > 0.0) {
            return None;
        }
        let sum: f64 = sides.iter().sum();
        let times = (sides[0] * a + sides[1] * b + sides[2] * c).dot(direction) / (sum * direction.length_squared());
        (sum != 0.0 && times > 0.0).then_some(times)
    }
}

/// Faces in a hierarchy of boxes.
struct Faces {
    faces: Vec<Face>,
    tree: Bvh<f64, 3>,
}

impl Faces {
    fn new(mut faces: Vec<Face>) -> Self {
        let tree = Bvh::build_par(&mut faces);
        Self { faces, tree }
    }

    /// The first face that a ray meets.
    fn nearest(&self, eye: DVec3, direction: DVec3) -> Option<Hit> {
        let mut best: Option<(f64, u32)> = None;
        self.visit(eye, direction, |times, cell| {
            if best.is_none_or(|(best, _)| times < best) {
                best = Some((times, cell));
            }
            best.map_or(f64::INFINITY, |(best, _)| best)
        });
        best.map(|(times, cell)| Hit { distance_m: times * direction.length(), cell, is_loose: false })
    }

    /// A face of each cell that a ray meets within a distance.
    fn all(&self, eye: DVec3, direction: DVec3, within_m: f64, seen: &mut Vec<Hit>) {
        let length_m = direction.length();
        let most = within_m / length_m;
        self.visit(eye, direction, |times, cell| {
            if times < most && seen.iter().all(|hit| hit.cell != cell) {
                seen.push(Hit { distance_m: times * length_m, cell, is_loose: true });
            }
            most
        });
    }

    /// Shows all faces that a ray meets; what `see` returns, in directions, is how far on it goes.
    fn visit(&self, eye: DVec3, direction: DVec3, mut see: impl FnMut(f64, u32) -> f64) {
        if self.faces.is_empty() {
            return;
        }
        // The crate makes directions of length one; the boxes' entries are metres, then.
        let (ray, length_m) = (Ray::new(point(eye), Vector3::new(direction.x, direction.y, direction.z)), direction.length());
        let mut most = f64::INFINITY;
        let mut open = vec![(0, 0.0)];
        while let Some((node, entry_m)) = open.pop() {
            if entry_m > most * length_m {
                continue;
            }
            match &self.tree.nodes[node] {
                BvhNode::Leaf { shape_index, .. } => {
                    let face = &self.faces[*shape_index];
                    if let Some(times) = face.meets(eye, direction) {
                        most = see(times, face.cell);
                    }
                }
                BvhNode::Node { child_l_index, child_l_aabb, child_r_index, child_r_aabb, .. } => {
                    let entry = |aabb| ray.intersection_slice_for_aabb(aabb).map(|(entry, _)| entry);
                    let (left, right) = (entry(child_l_aabb), entry(child_r_aabb));
                    let mut both = [(*child_l_index, left), (*child_r_index, right)];
                    // The nearer one comes off last, and so is looked at first.
                    both.sort_by(|a, b| b.1.partial_cmp(&a.1).unwrap_or(core::cmp::Ordering::Equal));
                    open.extend(both.into_iter().filter_map(|(child, entry)| Some((child, entry?))));
                }
            }
        }
    }
}

fn point(p: DVec3) -> Point3<f64> {
    Point3::new(p.x, p.y, p.z)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use veduta_city::{Gable, GridPolygon, GridPos, GroundPatch, HouseShell, PlanRoof, Rgb, RoofShape, SurfaceKind, VolumeShell};

    use super::*;

    /// A cell with ground of 60 m by 60 m and a house of 10 m by 10 m and 9 m in its middle.
    fn shell(origin: GridPos) -> CellShell {
        let square = |low: i32, high: i32| {
            GridPolygon::simple([(low, low), (high, low), (high, high), (low, high)].map(|(x, y)| GridPos(x, y)).to_vec())
        };
        let ground = GroundPatch { surface: SurfaceKind::Grass, outline: square(0, 60 * 1024), z: 0, course: None };
        let volume = VolumeShell {
            footprint: square(25 * 1024, 35 * 1024),
            bottom: 0,
            eaves: 9 * 1024,
            colour: Rgb(200, 180, 120),
            trim: Rgb(220, 220, 200),
            roof: PlanRoof { shape: RoofShape::Flat, height: 0, direction: 0, colour: Rgb(90, 90, 90) },
            gable: Gable::Plain,
            has_roof: true,
            walls: vec![0, 1, 2, 3],
            arcades: Vec::new(),
        };
        let house = HouseShell { style: 0, floor: 0, volumes: vec![volume], is_monument: false };
        CellShell { origin, ground: vec![ground], houses: vec![house], ..CellShell::default() }
    }

    #[test]
    fn a_ray_ends_at_the_first_wall_and_the_cell_behind_is_hidden() {
        let scene = Scene::new(&[shell(GridPos(0, 0)), shell(GridPos(60 * 1024, 0))]);
        let look = |eye: DVec3, to: DVec3| {
            let mut seen = Vec::new();
            scene.look(eye, to - eye, &mut seen);
            seen.pop()
        };
        let hit = look(DVec3::new(5.0, 1.6, -30.0), DVec3::new(90.0, 1.6, -30.0)).expect("a wall");
        assert_eq!((hit.cell, (hit.distance_m * 1e4).round()), (0, 20.0 * 1e4));
        let hit = look(DVec3::new(5.0, 1.6, -5.0), DVec3::new(95.0, 1.6, -28.0)).expect("a wall");
        assert_eq!(hit.cell, 1, "past the house");
        assert_eq!(look(DVec3::new(5.0, 1.6, -30.0), DVec3::new(90.0, 60.0, -30.0)), None, "the sky");
        assert!(!scene.is_open(DVec3::new(5.0, 1.6, -30.0), DVec3::new(30.0, 1.6, -30.0)));
        assert!(scene.is_open(DVec3::new(5.0, 1.6, -30.0), DVec3::new(24.9, 1.6, -30.0)));
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2_000, failure_persistence: None, ..ProptestConfig::default() })]

        /// From above, all rays end on the ground or the house: none slips through between two triangles.
        #[test]
        fn nothing_slips_through(x in 1..59_000_i32, y in 1..59_000_i32, dx in 1..59_000_i32, dy in 1..59_000_i32) {
            let scene = Scene::new(&[shell(GridPos(0, 0))]);
            let at = |x: i32, y: i32, z: f64| DVec3::new(f64::from(x) / 1000.0, z, -f64::from(y) / 1000.0);
            let (eye, to) = (at(x, y, 40.0), at(dx, dy, 0.0));
            let mut seen = Vec::new();
            scene.look(eye, to - eye, &mut seen);
            prop_assert!(seen.last().is_some_and(|hit| hit.distance_m <= eye.distance(to) + 1e-6));
            // To a corner or along an edge, too.
            let corner = DVec3::new(25.0, 9.0, -25.0);
            scene.look(eye, corner - eye, &mut seen);
            prop_assert!(!seen.is_empty());
        }
    }
}
