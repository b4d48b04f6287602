use glam::DVec2;
use veduta_city::{BoreEnd, CellShell, GridPos, ObjectShell, SpanForm, SpanStation, SurfaceKind, WaySpan, metres};

use super::arcade;
use super::bridge::{Deck, KERB_M};
use super::drape::Drape;
use super::footing::stands;
use super::ground::LevelEdges;
use super::object::radius_m;
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

/// Banks that a bridge lies no higher above stop nobody, and end so far below their tops; metres.
const LOW_BRIDGE_M: f64 = 1.5;
const STEP_M: f64 = 0.3;

/// What stops and carries a walker: only the walls that this cell lists.
#[must_use]
pub fn collision(shell: &CellShell) -> Collision {
    let ground = GroundHeights::new(shell);
    let drape = Drape::of(shell);
    let mut walls = Trimesh::default();
    house_walls(shell, &ground, &drape, &mut walls);
    for (from, to) in &shell.blind {
        if let Some(edge) = Edge::new(from.to_metres(), to.to_metres()) {
            // The portal's own cell lies on its left: the ground before the other side of the edge.
            let inner = Edge { out: -edge.out, ..edge };
            let (low, high) = shell.terrain.range_along(edge.a, edge.b);
            let foot = ground.before(&inner).unwrap_or(low);
            walls.upright(&edge, low.min(foot) - FOOTING_M, high.max(foot) + WALL_M);
        }
    }
    banks(shell, &ground, &drape, &mut walls);
    let mut floor = walkable(shell, &drape);
    for span in shell.spans.iter().take(shell.drawn_spans as usize) {
        way(span, &drape, &mut walls, &mut floor);
    }
    arcades(shell, &mut walls, &mut floor);
    Collision { walls, ground: floor, objects: shell.objects.iter().map(pillar).collect() }
}

impl Trimesh {
    fn upright(&mut self, edge: &Edge, low: f64, high: f64) {
        let base = self.positions.len() as u32;
        let corners = [(edge.a, low), (edge.b, low), (edge.b, high), (edge.a, high)];
        self.positions.extend(corners.map(|(p, y)| engine(p, y).as_vec3().to_array()));
        self.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
    }
}

/// Piers and paving of arcades.
fn arcades(shell: &CellShell, walls: &mut Trimesh, floor: &mut Trimesh) {
    for walk in shell.houses.iter().flat_map(|house| &house.volumes).flat_map(arcade::walks) {
        for (edge, high) in walk.pier_sides() {
            walls.upright(&edge, walk.floor - FOOTING_M, high);
        }
        if let Some(corners) = walk.paving() {
            let base = floor.positions.len() as u32;
            floor.positions.extend(corners.map(|p| p.as_vec3().to_array()));
            floor.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
        }
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
                let (low, high) = (surface.min(beside) - FOOTING_M, surface.max(beside));
                for (from, to, bridge) in below_bridges(&edge, shell) {
                    let Some(part) = Edge::new(edge.at(from), edge.at(to)) else { continue };
                    let top = match bridge {
                        Some(z) if z < high + LOW_BRIDGE_M => high - STEP_M,
                        Some(z) => (z - LOW_BRIDGE_M / 2.0).min(high + WALL_M),
                        None => high + WALL_M,
                    };
                    walls.upright(&part, low, top);
                }
            }
            first += ring.len();
        }
    }
}

/// The parts of a bank from one share of it to another, each with how high the bridge over it is, if there is one; metres.
fn below_bridges(edge: &Edge, shell: &CellShell) -> Vec<(f64, f64, Option<f64>)> {
    let mut below: Vec<(f64, f64, f64)> = Vec::new();
    let bridges = shell.spans.iter().filter(|span| !span.is_bore() && !span.is_ramp());
    for pair in bridges.flat_map(|span| span.stations.windows(2)) {
        let corners = [pair[0].right, pair[1].right, pair[1].left, pair[0].left].map(GridPos::to_metres);
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for (i, &p) in corners.iter().enumerate() {
            let way = corners[(i + 1) % 4] - p;
            let [a, b] = [edge.a, edge.b].map(|end| way.perp_dot(end - p));
            match (a >= 0.0, b >= 0.0) {
                (true, true) => {}
                (false, false) => to = -1.0,
                (false, true) => from = from.max(a / (a - b)),
                (true, false) => to = to.min(a / (a - b)),
            }
        }
        if to > from {
            below.push((from, to, metres(pair[0].z).min(metres(pair[1].z))));
        }
    }
    below.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut parts, mut gone) = (Vec::new(), 0.0);
    for (from, to, z) in below {
        if from > gone {
            parts.push((gone, from, None));
        }
        if to > gone {
            parts.push((from.max(gone), to, Some(z)));
            gone = to;
        }
    }
    if gone < 1.0 {
        parts.push((gone, 1.0, None));
    }
    parts
}

/// A span's way between its parapets or walls, and what holds it.
fn way(span: &WaySpan, drape: &Drape<'_>, walls: &mut Trimesh, floor: &mut Trimesh) {
    let Some(deck) = Deck::new(span) else { return };
    let [on_left, on_right] = deck.pavements_m();
    for pair in span.stations.windows(2) {
        let [a, b] = [&pair[0], &pair[1]];
        let (ya, yb) = (metres(a.z), metres(b.z));
        // Lines by the end that they are measured from, and how far to the left of it they are.
        let lines = [(-1.0, 0.0), (-1.0, on_right), (1.0, -on_left), (1.0, 0.0)];
        for (pair, lift) in lines.windows(2).zip([KERB_M, 0.0, KERB_M]) {
            let (right, left) = (pair[0], pair[1]);
            if right == left {
                continue;
            }
            let place = |station: &SpanStation, (side, left): (f64, f64)| station.at(side * station.half_m() + left);
            let corners = [(a, right, ya), (b, right, yb), (b, left, yb), (a, left, ya)];
            let base = floor.positions.len() as u32;
            floor.positions.extend(corners.map(|(station, at, y)| engine(place(station, at), y + lift).as_vec3().to_array()));
            floor.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
        }
        for (from, to, is_guarded) in [(a.right, b.right, span.parapets.1), (b.left, a.left, span.parapets.0)] {
            let Some(edge) = Edge::new(from.to_metres(), to.to_metres()).filter(|_| is_guarded) else { continue };
            let top = match span.form {
                // Who walks above a bore walks on its roof.
                SpanForm::Bore { crown, .. } => ya.min(yb) + metres(crown),
                SpanForm::Ramp => ya.max(yb).max(drape.highest(edge.a, edge.b)) + WALL_M,
                SpanForm::Arches | SpanForm::Girder => ya.max(yb) + WALL_M,
            };
            walls.upright(&edge, ya.min(yb) - STEP_M, top);
        }
    }
    if let SpanForm::Bore { crown, ends } = span.form {
        let stations = [(span.stations.first(), ends.0), (span.stations.last(), ends.1)];
        for (station, end) in stations.into_iter().filter_map(|(station, end)| Some((station?, end))) {
            let Some(edge) = Edge::new(station.right.to_metres(), station.left.to_metres()) else { continue };
            let (y, top) = (metres(station.z), metres(station.z) + metres(crown));
            match end {
                BoreEnd::Bore => {}
                BoreEnd::Wall => walls.upright(&edge, y - STEP_M, top),
                BoreEnd::Portal => walls.upright(&edge, top, top.max(drape.highest(edge.a, edge.b)) + WALL_M),
            }
        }
    }
    let (Some(foot), Some(end)) = (span.piers.1, span.stations.last()) else { return };
    let top = match span.form {
        SpanForm::Arches => metres(span.springing),
        _ => metres(end.z) - HEADROOM_M,
    };
    if let Some(edge) = Edge::new(end.right.to_metres(), end.left.to_metres()) {
        walls.upright(&edge, metres(foot), top);
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

fn pillar(object: &ObjectShell) -> Pillar {
    Pillar {
        foot: engine(object.pos.to_metres(), metres(object.z)).as_vec3().to_array(),
        radius_m: radius_m(object) as f32,
        height_m: metres(object.height).max(0.3) as f32,
    }
}

#[cfg(test)]
mod tests {
    use veduta_city::{Arcade, Gable, GridPolygon, GridPos, GroundPatch, HouseShell, PlanRoof, Rgb, VolumeShell};

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
            arcades: Vec::new(),
        };
        HouseShell { style: 0, floor: 0, volumes: vec![volume], is_monument: false }
    }

    fn ground(surface: SurfaceKind, x: i32) -> GroundPatch {
        GroundPatch { surface, outline: square(x, 5), z: 0, course: None }
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
    fn arcades_carry_people_and_their_piers_stop_them() {
        let arcade = Arcade { wall: 3, span: (0, 5 * 1024), arches: 2, floor: 100, depth: 2048 };
        let mut house = house(4 * 1024);
        house.volumes[0].arcades = vec![arcade];
        let ground = vec![ground(SurfaceKind::Cobbles, 5)];
        let c = collision(&CellShell { houses: vec![house], ground, ..Default::default() });
        assert_eq!(c.walls.triangles.len(), 3 * 4 * 2, "three piers of four sides");
        let xs = c.walls.positions.iter().map(|p| p[0]);
        let thick = xs.clone().fold(f32::MIN, f32::max) - xs.fold(f32::MAX, f32::min);
        assert!((thick - 0.55).abs() < 1e-5, "nothing stands behind the piers: {thick}");
        assert_eq!(c.ground.triangles.len(), 2 + 2);
        assert!(c.ground.positions[4..].iter().all(|p| (p[1] - 100.0 / 1024.0).abs() < 1e-6 && (10.0..=12.0).contains(&p[0])));
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
    fn banks_above_a_bore_are_shut() {
        let station = |x: i32| SpanStation { left: GridPos(x, 4096), right: GridPos(x, 1024), z: -8 * 1024 };
        let bore = |form: SpanForm| WaySpan {
            id: veduta_city::Id(1),
            form,
            surface: SurfaceKind::Asphalt,
            pavements: (0, 0),
            parapets: (true, true),
            stations: vec![station(-4096), station(9 * 1024)],
            springing: 0,
            piers: (None, None),
            markings: Vec::new(),
        };
        let banks = |spans: Vec<WaySpan>| {
            let ground = vec![ground(SurfaceKind::Water, 0), ground(SurfaceKind::Grass, 5)];
            collision(&CellShell { ground, spans, ..Default::default() }).walls.positions
        };
        let below = bore(SpanForm::Bore { crown: 5 * 1024, ends: Default::default() });
        assert_eq!(banks(vec![below]), banks(Vec::new()));
        assert_ne!(banks(vec![bore(SpanForm::Girder)]), banks(Vec::new()), "a bridge opens them");
    }

    #[test]
    fn a_blind_portal_stops() {
        let c = collision(&CellShell { blind: vec![(GridPos(0, 0), GridPos(0, 4096))], ..Default::default() });
        assert_eq!(c.walls.triangles.len(), 2);
    }
}
