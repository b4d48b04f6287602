use std::collections::HashMap;

use glam::DVec2;
use veduta_city::{CellShell, Course, GridPos, GroundPatch, Rgb, SurfaceKind, Tile, metres};

use super::data::{MeshData, Paint};
use super::drape::Drape;
use super::footing::footings;
use super::outline::{Triangulator, centre_of, engine, middle, rings, wall_edge};

/// Depth of a kerb's face below the top of its patch where nothing lower is known of, and the most a bank goes down; metres.
const KERB_M: f64 = 0.15;
const BANK_M: f64 = 6.0;

/// The cell's ground, facing up, with upright faces at the kerbs and banks of patches that stand above others, and under the walls of
/// houses on slopes. Texture coordinates run along the patches' courses, and go on across cells.
#[must_use]
pub fn ground(shell: &CellShell) -> MeshData {
    let mut mesh = MeshData::default();
    let mut triangulator = Triangulator::default();
    let lowest = shell.ground.iter().map(|patch| patch.z).min().unwrap_or(0);
    let level = LevelEdges::new(&shell.ground);
    let drape = Drape::of(shell);
    let offset = DVec2::new(remainder(shell.origin.0), remainder(shell.origin.1));
    // What is laid once is bent by the ground, not broken: its faces share their vertices.
    let mut known: HashMap<[u64; 2], u32> = HashMap::new();
    for patch in shell.ground.iter().filter(|patch| patch.surface != SurfaceKind::Opening) {
        let tile = Tile::Ground(patch.surface);
        let paint = Paint::new(centre_of(middle(&patch.outline)), Rgb(255, 255, 255), tile);
        let lift = metres(patch.z);
        let course = patch.course.and_then(|course| shell.courses.get(course as usize));
        known.clear();
        triangulator.each(&rings(&patch.outline), |_, places| {
            drape.pieces(&places, |piece| {
                let mut vertex = |p: DVec2| {
                    *known.entry(p.to_array().map(f64::to_bits)).or_insert_with(|| {
                        // Along its course, or by the compass; v runs to the right.
                        let laid = course.and_then(|course| course.place(p)).unwrap_or(p + offset);
                        let uv = DVec2::new(laid.x, -laid.y) / paint.size_m();
                        mesh.vertex(drape.above(p, lift), drape.normal(p), uv, paint)
                    })
                };
                let corners: Vec<u32> = piece.iter().map(|&p| vertex(p)).collect();
                let fan = corners.windows(2).skip(1).flat_map(|pair| [corners[0], pair[0], pair[1]]);
                mesh.indices.extend(fan);
            });
        });
        if patch.z > lowest || (patch.z > 0 && patch.surface != SurfaceKind::Water) {
            let below = metres(patch.z) - metres(lowest);
            kerb(patch, &level, below.clamp(KERB_M, BANK_M), &drape, &mut mesh);
        }
    }
    mesh.append(&footings(shell));
    mesh
}

/// What of a cell's origin is no whole number of repeats: texture coordinates fit between cells and stay small.
pub(super) fn remainder(origin: i32) -> f64 {
    metres(origin.rem_euclid(Course::REPEAT))
}

fn kerb(patch: &GroundPatch, level: &LevelEdges, depth: f64, drape: &Drape<'_>, mesh: &mut MeshData) {
    let paint = Paint::new(centre_of(middle(&patch.outline)), Rgb(0xB9, 0xB4, 0xA8), Tile::Stone);
    let top = metres(patch.z);
    let mut first = 0;
    for ring in patch.outline.rings() {
        for i in 0..ring.len() {
            let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
            if level.has_neighbour(a, b, patch.z) {
                continue;
            }
            let Some(edge) = wall_edge(&patch.outline, first + i) else { continue };
            let low = top - depth;
            for pair in drape.way(edge.a, edge.b).windows(2) {
                let face = [(pair[0], low), (pair[1], low), (pair[1], top), (pair[0], top)];
                // The stone runs along the kerb, however steep.
                mesh.polygon_as(&face.map(|(p, lift)| drape.above(p, lift)), &face.map(|(p, lift)| engine(p, lift)), paint);
            }
        }
        first += ring.len();
    }
}

/// Edges of all patches, to find those that two patches share whole.
pub(super) struct LevelEdges(Vec<(GridPos, GridPos, i32)>);

impl LevelEdges {
    pub(super) fn new<'a>(patches: impl IntoIterator<Item = &'a GroundPatch>) -> Self {
        let mut edges = Vec::new();
        for patch in patches {
            for ring in patch.outline.rings() {
                edges.extend((0..ring.len()).map(|i| (ring[i], ring[(i + 1) % ring.len()], patch.z)));
            }
        }
        edges.sort_unstable();
        Self(edges)
    }

    /// Whether a patch at least as high lies on the right of an edge.
    pub(super) fn has_neighbour(&self, a: GridPos, b: GridPos, z: i32) -> bool {
        let next = self.0.partition_point(|&edge| edge < (b, a, z));
        self.0.get(next).is_some_and(|edge| (edge.0, edge.1) == (b, a))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use veduta_city::{GridPolygon, PlanTerrain};

    use super::*;

    fn patch(x: i32, z: i32, surface: SurfaceKind) -> GroundPatch {
        let corners = [(x, 0), (x + 4, 0), (x + 4, 4), (x, 4)];
        let outline = GridPolygon::simple(corners.into_iter().map(|(x, y)| GridPos(x * 1024, y * 1024)).collect());
        GroundPatch { surface, outline, z, course: None }
    }

    #[test]
    fn only_the_higher_patch_has_a_kerb_and_not_where_another_joins_it() {
        let (road, pavement) = (patch(0, 0, SurfaceKind::Cobbles), patch(4, 123, SurfaceKind::Mosaic));
        let more = patch(8, 123, SurfaceKind::Flagstones);
        let shell = CellShell { ground: vec![road, pavement, more], ..Default::default() };
        let mesh = ground(&shell);
        mesh.validate().unwrap();
        assert_eq!(mesh.triangle_count(), 3 * 2 + 6 * 2, "three of the four sides of each raised patch");
        let stone = Tile::Stone.index() as f32;
        let low = mesh.positions.iter().zip(&mesh.colours).filter(|(_, c)| c[3] == stone).map(|(p, _)| p[1]).fold(9.0, f32::min);
        assert!((low - (123.0 / 1024.0 - 0.15)).abs() < 1e-6, "{low}");
    }

    #[test]
    fn paving_follows_its_course_also_from_cell_to_cell() {
        let line = [(-20, -20), (0, 0), (30, 20)].map(|(x, y)| GridPos(x * 1024, y * 1024)).to_vec();
        let whole = Course { line, from: 0 };
        let of = |x: i32, course: Option<Course>| {
            let ground = vec![GroundPatch { course: course.is_some().then_some(0), ..patch(x, 0, SurfaceKind::Flagstones) }];
            ground_mesh(CellShell { ground, courses: course.into_iter().collect(), ..Default::default() })
        };
        let (laid, by_compass) = (of(0, Some(whole.clone())), of(0, None));
        assert_ne!(laid.uvs, by_compass.uvs);
        let size = Paint::new([0.0; 2], Rgb::default(), Tile::Ground(SurfaceKind::Flagstones)).size_m();
        for (p, uv) in laid.positions.iter().zip(&laid.uvs) {
            let want = whole.place(DVec2::new(f64::from(p[0]), f64::from(-p[2]))).expect("it has length");
            assert!((f64::from(uv[0]) * size.x - want.x).abs() < 1e-4 && (f64::from(uv[1]) * size.y + want.y).abs() < 1e-4);
        }
        // The next cell knows a part of it, and goes on where this one ends.
        let next = of(4, Some(whole.part(1, 1)));
        let repeat = f64::from(Course::REPEAT) / 1024.0 / size.x;
        let mut shared = 0;
        for (p, uv) in laid.positions.iter().zip(&laid.uvs) {
            for (q, other) in next.positions.iter().zip(&next.uvs).filter(|(q, _)| *q == p) {
                let apart = f64::from(uv[0] - other[0]).rem_euclid(repeat);
                assert!(apart.min(repeat - apart) < 1e-3 && (uv[1] - other[1]).abs() < 1e-4, "{p:?} {q:?}: {uv:?} {other:?}");
                shared += 1;
            }
        }
        assert!(shared > 1, "they share an edge");
    }

    fn ground_mesh(shell: CellShell) -> MeshData {
        let mesh = ground(&shell);
        mesh.validate().unwrap();
        mesh
    }

    #[test]
    fn texture_goes_on_across_cells() {
        let surfaces = [SurfaceKind::Cobbles, SurfaceKind::Asphalt, SurfaceKind::Water];
        for surface in surfaces {
            let here = CellShell { ground: vec![patch(4, 0, surface)], ..Default::default() };
            let origin = GridPos(4 * 1024 - 48 * 1024, 160 * 1024);
            let there = CellShell { origin, ground: vec![patch(48, 0, surface)], ..Default::default() };
            let (a, b) = (ground(&here), ground(&there));
            for (p, q) in a.uvs.iter().zip(&b.uvs) {
                let apart = (p[0] - q[0]).rem_euclid(1.0);
                assert!(apart.min(1.0 - apart) < 1e-4, "{surface:?}: {p:?} {q:?}");
            }
        }
    }

    #[test]
    fn faces_of_a_patch_that_the_ground_bends_share_their_vertices() {
        let heights = (0..25).map(|i| 1024 * (i * i % 7)).collect();
        let terrain = PlanTerrain { origin: GridPos(0, 0), step: 1024, columns: 5, heights };
        let shell = CellShell { ground: vec![patch(0, 0, SurfaceKind::Gravel)], terrain, ..Default::default() };
        let mesh = ground(&shell);
        mesh.validate().unwrap();
        let places: BTreeSet<[u32; 3]> = mesh.positions.iter().map(|p| p.map(f32::to_bits)).collect();
        assert_eq!((places.len(), mesh.triangle_count()), (mesh.positions.len(), 2 * 4 * 4));
        assert_eq!(mesh.positions.len(), 5 * 5);
    }
}
