use glam::DVec2;
use veduta_city::{CellShell, PlanObject, SurfaceKind, metres};

use super::drape::Drape;
use super::footing::stands;
use super::ground::LevelEdges;
use super::object::scale_of;
use super::outline::{Edge, GroundHeights, Triangulator, engine, rings, wall_edge};

/// A triangle mesh without looks. Metres in the engine's axes, local to the cell.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trimesh {
    /// Corners.
    pub positions: Vec<[f32; 3]>,
    /// Triangles as indices of corners.
    pub triangles: Vec<[u32; 3]>,
}

/// An upright cylinder that stands for an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pillar {
    /// Middle of its foot, metres.
    pub foot: [f32; 3],
    /// Metres.
    pub radius_m: f32,
    /// Metres.
    pub height_m: f32,
}

/// What a walker in the cell stands on and is stopped by.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Collision {
    /// Upright faces: house walls that reach down to head height, blind portals, banks of water.
    pub walls: Trimesh,
    /// Walkable ground, counter-clockwise seen from above.
    pub ground: Trimesh,
    /// Standing objects.
    pub objects: Vec<Pillar>,
}

/// A volume that begins higher than this above the ground lets people pass below; metres.
const HEADROOM_M: f64 = 2.2;
/// Height above the ground that every wall has at least, and its depth below; metres.
const WALL_M: f64 = 6.0;
const FOOTING_M: f64 = 1.0;

/// What stops and carries a walker: only the walls that this cell lists.
#[must_use]
pub fn collision(shell: &CellShell) -> Collision {
    let ground = GroundHeights::new(shell);
    let drape = Drape::of(shell);
    let mut walls = Trimesh::default();
    house_walls(shell, &ground, &drape, &mut walls);
    for portal in &shell.blind {
        if let Some(edge) = Edge::new(portal.ends.0.to_metres(), portal.ends.1.to_metres()) {
            // The portal's own cell lies on its left: the ground before the other side of the edge.
            let inner = Edge { out: -edge.out, ..edge };
            let (low, high) = shell.terrain.range_along(edge.a, edge.b);
            let foot = ground.before(&inner).unwrap_or(low);
            walls.upright(&edge, low.min(foot) - FOOTING_M, high.max(foot) + WALL_M);
        }
    }
    banks(shell, &ground, &drape, &mut walls);
    Collision { walls, ground: walkable(shell, &drape), objects: shell.objects.iter().map(pillar).collect() }
}

impl Trimesh {
    fn upright(&mut self, edge: &Edge, low: f64, high: f64) {
        let base = self.positions.len() as u32;
        let corners = [(edge.a, low), (edge.b, low), (edge.b, high), (edge.a, high)];
        self.positions.extend(corners.map(|(p, y)| engine(p, y).as_vec3().to_array()));
        self.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
    }
}

fn house_walls(shell: &CellShell, ground: &GroundHeights<'_>, drape: &Drape<'_>, walls: &mut Trimesh) {
    for (house, volume) in shell.houses.iter().flat_map(|house| house.volumes.iter().map(move |volume| (house, volume))) {
        let (bottom, eaves) = (metres(volume.bottom), metres(volume.eaves));
        for &wall in &volume.walls {
            let Some(edge) = wall_edge(&volume.footprint, wall.into()) else { continue };
            let foot = ground.before(&edge).unwrap_or(bottom);
            if stands(house, volume) || bottom < foot + HEADROOM_M {
                let low = drape.lowest(edge.a, edge.b);
                walls.upright(&edge, bottom.min(foot).min(low) - FOOTING_M, eaves.max(foot + WALL_M));
            }
        }
    }
}

/// Edges of water that no other water shares.
fn banks(shell: &CellShell, ground: &GroundHeights<'_>, drape: &Drape<'_>, walls: &mut Trimesh) {
    let water = || shell.ground.iter().filter(|patch| patch.surface == SurfaceKind::Water);
    let shared = LevelEdges::new(water());
    for patch in water() {
        let mut first = 0;
        for ring in patch.outline.rings() {
            for i in 0..ring.len() {
                let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
                let Some(edge) = wall_edge(&patch.outline, first + i).filter(|_| !shared.has_neighbour(a, b, i32::MIN)) else {
                    continue;
                };
                let surface = drape.lowest(edge.a, edge.b) + metres(patch.z);
                let beside = ground.before(&edge).unwrap_or(surface);
                walls.upright(&edge, surface.min(beside) - FOOTING_M, surface.max(beside) + WALL_M);
            }
            first += ring.len();
        }
    }
}

fn walkable(shell: &CellShell, drape: &Drape<'_>) -> Trimesh {
    let mut mesh = Trimesh::default();
    let mut triangulator = Triangulator::default();
    for patch in shell.ground.iter().filter(|patch| patch.surface.is_walkable()) {
        let rings = rings(&patch.outline);
        let lift = metres(patch.z);
        let corner = |&p: &DVec2| drape.above(p, lift).as_vec3().to_array();
        if drape.is_level() {
            let base = mesh.positions.len() as u32;
            mesh.positions.extend(rings.iter().flatten().map(corner));
            triangulator.each(&rings, |index, _| mesh.triangles.push(index.map(|i| base + i as u32)));
            continue;
        }
        triangulator.each(&rings, |_, triangle| {
            drape.pieces(&triangle, |piece| {
                let base = mesh.positions.len() as u32;
                mesh.positions.extend(piece.iter().map(corner));
                mesh.triangles.extend((1..piece.len() as u32 - 1).map(|i| [base, base + i, base + i + 1]));
            });
        });
    }
    mesh
}

fn pillar(object: &PlanObject) -> Pillar {
    Pillar {
        foot: engine(object.pos.to_metres(), metres(object.z)).as_vec3().to_array(),
        radius_m: (object.kind.radius_m() * scale_of(object)) as f32,
        height_m: metres(object.height).max(0.3) as f32,
    }
}

#[cfg(test)]
mod tests {
    use veduta_city::{Gable, GridPolygon, GridPos, GroundPatch, HouseShell, Id, PlanRoof, Portal, PortalSide, Rgb, VolumeShell};

    use super::*;

    fn square(x: i32, side: i32) -> GridPolygon {
        let corners = [(x, 0), (x + side, 0), (x + side, side), (x, side)];
        GridPolygon::simple(corners.into_iter().map(|(x, y)| GridPos(x * 1024, y * 1024)).collect())
    }

    fn house(bottom: i32) -> HouseShell {
        let roof = PlanRoof { shape: Default::default(), height: 1024, direction: 0, colour: Rgb::default() };
        let (colour, trim) = (Rgb::default(), Rgb::default());
        let volume = VolumeShell {
            footprint: square(10, 5),
            bottom,
            eaves: 4096,
            colour,
            trim,
            roof,
            gable: Gable::Plain,
            has_roof: true,
            walls: vec![3],
        };
        HouseShell { id: Id(1), style: 0, floor: 0, volumes: vec![volume], is_monument: false }
    }

    fn ground(surface: SurfaceKind, x: i32) -> GroundPatch {
        GroundPatch { surface, outline: square(x, 5), z: 0 }
    }

    #[test]
    fn a_passage_stays_open_and_a_wall_is_shut() {
        let walls = |bottom| {
            let shell =
                CellShell { houses: vec![house(bottom)], ground: vec![ground(SurfaceKind::Cobbles, 5)], ..Default::default() };
            collision(&shell).walls
        };
        assert_eq!(walls(3 * 1024).triangles.len(), 0);
        let shut = walls(0);
        assert_eq!(shut.triangles.len(), 2);
        assert!(shut.positions.iter().all(|p| p[0] == 10.0), "only the west wall is listed");
        assert!(shut.positions.iter().any(|p| p[1] >= 6.0) && shut.positions.iter().any(|p| p[1] < 0.0));
    }

    #[test]
    fn water_is_fenced_but_for_where_it_goes_on() {
        let patches = vec![ground(SurfaceKind::Water, 0), ground(SurfaceKind::Water, 5), ground(SurfaceKind::Grass, 10)];
        let c = collision(&CellShell { ground: patches, ..Default::default() });
        assert_eq!(c.walls.triangles.len(), 6 * 2);
        assert_eq!(c.ground.triangles.len(), 2, "only grass carries");
        let up = c.ground.triangles.iter().all(|t| {
            let [a, b, c] = t.map(|i| glam::Vec3::from_array(c.ground.positions[i as usize]));
            (b - a).cross(c - a).y > 0.0
        });
        assert!(up);
    }

    #[test]
    fn a_blind_portal_stops() {
        let blind = Portal { ends: (GridPos(0, 0), GridPos(0, 4096)), cell: 0, beyond: PortalSide::Edge };
        let c = collision(&CellShell { blind: vec![blind], ..Default::default() });
        assert_eq!(c.walls.triangles.len(), 2);
    }
}
