//! What stands out: the church by the main square, the town wall with its towers, the railway, wells and fountains.

use glam::DVec2;
use veduta_city::draw::Draw;
use veduta_city::{Building, BuildingPart, Id, Link, LinkKind, Node, ObjectKind, Ring, RoofShape, RoofTags, StandingObject};

use super::fabric::{Fabric, Role, rounded};
use super::grounds::lie_of;
use super::layout::Town;
use super::{network, turn};
use crate::polygon::{Polygon, signed_area};

/// Height and thickness of a town wall, and the clear ground between it and the lane inside; metres.
const WALL_M: (f64, f64, f64) = (7.5, 2.2, 2.0);
/// Side of a tower, and the distance between towers; metres.
const TOWER_M: (f64, f64) = (7.0, 62.0);
/// Clear ground between the railway and the town, metres.
const RAILWAY_AWAY_M: f64 = 75.0;

fn building(name: &str, style: &str, outline: Ring) -> Building {
    Building {
        id: Id::NONE,
        name: name.to_owned(),
        number: String::new(),
        style: style.to_owned(),
        outline,
        holes: Vec::new(),
        min_height_m: 0.0,
        height_m: None,
        levels: None,
        roof: RoofTags::default(),
        colour: None,
        parts: Vec::new(),
        monument: None,
    }
}

/// A rectangle about a middle: half its length along a direction, and half its width.
fn oblong(middle: DVec2, along: DVec2, half: DVec2) -> Ring {
    let side = along.perp();
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(x, y)| rounded(middle + along * (half.x * x) + side * (half.y * y)))
        .to_vec()
}

/// A church of nave, chancel and west tower as large as its ground allows, its altar towards the east as nearly as it may be.
pub(super) fn church(ground: &[DVec2], name: &str, seed: u64) -> Option<Building> {
    let polygon = Polygon { outer: ground.to_vec(), holes: Vec::new() };
    let (long, length) = lie_of(ground);
    let eastward = if long.x < 0.0 { -long } else { long };
    let middle = polygon.inner_pos();
    let fits = |ring: &Ring| ring.iter().all(|&p| polygon.contains(p)) && clear_m(ring, ground) > 3.0;
    for scale in [0.62, 0.54, 0.46, 0.4, 0.34] {
        let half = DVec2::new(0.5 * scale * length.min(74.0), 0.21 * scale * length.min(74.0));
        for tilt in [0.0, 0.2, -0.2, 0.4, -0.4, core::f64::consts::FRAC_PI_2] {
            let east = turn(eastward, tilt);
            if half.x > 9.0 && fits(&oblong(middle, east, half)) {
                return Some(church_at(middle, east, half, name, seed));
            }
        }
    }
    None
}

fn clear_m(ring: &Ring, outline: &[DVec2]) -> f64 {
    let edges = || crate::polygon::edges(outline);
    ring.iter().flat_map(|&p| edges().map(move |(a, b)| super::fit::distance_to(p, a, b))).fold(f64::INFINITY, f64::min)
}

fn church_at(middle: DVec2, east: DVec2, half: DVec2, name: &str, seed: u64) -> Building {
    let draw = Draw::new(seed, Id(9), "words: church");
    let height = (half.y * 2.4).clamp(11.0, 26.0);
    let tower = (half.y * 0.8).clamp(3.2, 5.5);
    let part = |outline: Ring, height_m: f64, shape: RoofShape, roof_m: f64| BuildingPart {
        id: Id::NONE,
        outline,
        holes: Vec::new(),
        min_height_m: 0.0,
        height_m: Some(height_m),
        levels: None,
        roof: RoofTags { shape: Some(shape), height_m: Some(roof_m), ..RoofTags::default() },
        colour: None,
        opening: None,
    };
    let west_end = middle - east * half.x;
    let nave_from = west_end + east * (2.0 * tower);
    let nave_half = DVec2::new(half.x * 0.68 - tower, half.y);
    let nave_middle = nave_from + east * nave_half.x;
    let chancel_from = nave_middle + east * nave_half.x;
    let chancel_half = DVec2::new((middle + east * half.x - chancel_from).dot(east) / 2.0, half.y * 0.66);
    let mut church = building(name, "church", oblong(middle, east, half));
    church.parts = vec![
        part(oblong(nave_middle, east, nave_half), height, RoofShape::Gabled, height * 0.42),
        part(oblong(chancel_from + east * chancel_half.x, east, chancel_half), height * 0.82, RoofShape::Hipped, height * 0.32),
        part(
            oblong(west_end + east * tower, east, DVec2::splat(tower)),
            height * draw.between("tower", 1.8, 2.3),
            RoofShape::Pyramidal,
            height * draw.between("spire", 0.5, 0.9),
        ),
    ];
    church
}

/// The wall along the border, with towers; open at gates and where the river passes.
pub(super) fn wall(town: &Town) -> Vec<Building> {
    let fabric = &town.fabric;
    let mut border: Ring = town.shape.border();
    if signed_area(&border) < 0.0 {
        border.reverse();
    }
    let lane_m = fabric.ways.first().map_or(0.0, |w| w.width_m);
    let inner = lane_m / 2.0 + WALL_M.2;
    let line = Stations::new(&border);
    // Openings as stretches of the border.
    let mut open: Vec<(f64, f64)> = Vec::new();
    for gate in &town.gates {
        let s = line.nearest(fabric.pos(gate.spot));
        open.push((s - 9.0, s + 9.0));
    }
    if let Some(channel) = &town.channel {
        let step = 3.0;
        let count = (line.length_m / step) as usize;
        let wet = |s: f64| channel.distance_m(line.at(s).0) < channel.quay_at_m + 7.0;
        open.extend((0..count).map(|i| i as f64 * step).filter(|&s| wet(s)).map(|s| (s - step, s + step)));
    }
    let mut out = Vec::new();
    for (from, to) in line.stretches(&open) {
        let pieces = libm::round((to - from) / TOWER_M.1).max(1.0);
        let step = (to - from) / pieces;
        for piece in 0..pieces as usize {
            let (a, b) = (from + step * piece as f64, from + step * (piece + 1) as f64);
            out.extend(tower(&line, a, inner));
            out.extend(curtain(&line, a + TOWER_M.0 / 2.0, b - TOWER_M.0 / 2.0, inner));
        }
        out.extend(tower(&line, to, inner));
    }
    out
}

fn tower(line: &Stations, s: f64, inner_m: f64) -> Option<Building> {
    let (p, out) = line.at(s);
    let middle = p + out * (inner_m + TOWER_M.0 / 2.0 - 0.6);
    let mut tower = building("", "tower", oblong(middle, out.perp(), DVec2::splat(TOWER_M.0 / 2.0)));
    tower.height_m = Some(16.5);
    tower.levels = Some(2.0);
    tower.roof = RoofTags { shape: Some(RoofShape::Pyramidal), height_m: Some(5.0), ..RoofTags::default() };
    (signed_area(&tower.outline) > 1.0).then_some(tower)
}

/// The wall between two towers.
fn curtain(line: &Stations, from: f64, to: f64, inner_m: f64) -> Option<Building> {
    if to - from < 4.0 {
        return None;
    }
    let count = libm::ceil((to - from) / 30.0).max(1.0) as usize;
    let at = |i: usize| line.at(from + (to - from) * i as f64 / count as f64);
    let side = |away: f64| (0..=count).map(move |i| rounded(at(i).0 + at(i).1 * away));
    // Counter-clockwise: outside along the border, inside back.
    let mut outline: Ring = side(inner_m + WALL_M.1).collect();
    outline.extend(side(inner_m).rev());
    let mut wall = building("Town wall", "monument", outline);
    wall.height_m = Some(WALL_M.0);
    wall.roof.shape = Some(RoofShape::Flat);
    (crate::polygon::is_simple(&wall.outline) && signed_area(&wall.outline) > 1.0).then_some(wall)
}

/// A closed line with distances along it.
struct Stations {
    ring: Ring,
    /// Distance of each vertex from the first, metres.
    at_m: Vec<f64>,
    length_m: f64,
}

impl Stations {
    fn new(ring: &Ring) -> Self {
        let (mut sum, mut at_m) = (0.0, Vec::with_capacity(ring.len()));
        for (a, b) in crate::polygon::edges(ring) {
            at_m.push(sum);
            sum += a.distance(b);
        }
        Self { ring: ring.clone(), at_m, length_m: sum }
    }

    /// Position and outward direction at a distance along the line; the direction turns evenly between vertices.
    fn at(&self, s: f64) -> (DVec2, DVec2) {
        let n = self.ring.len().max(1);
        let s = s.rem_euclid(self.length_m.max(1e-9));
        let i = self.at_m.partition_point(|&m| m <= s).saturating_sub(1);
        let vertex = |i: usize| self.ring.get(i % n).copied().unwrap_or_default();
        let out = |i: usize| -(vertex(i + 1) - vertex(i + n - 1)).perp().normalize_or_zero();
        let piece = vertex(i).distance(vertex(i + 1)).max(1e-9);
        let t = ((s - self.at_m.get(i).copied().unwrap_or(0.0)) / piece).clamp(0.0, 1.0);
        (vertex(i).lerp(vertex(i + 1), t), out(i).lerp(out(i + 1), t).normalize_or_zero())
    }

    fn nearest(&self, p: DVec2) -> f64 {
        let count = (self.length_m / 2.0).max(1.0) as usize;
        let at = |i: usize| self.length_m * i as f64 / count as f64;
        let nearest = (0..count).min_by(|&i, &j| self.at(at(i)).0.distance(p).total_cmp(&self.at(at(j)).0.distance(p)));
        at(nearest.unwrap_or(0))
    }

    /// What openings leave, each longer than a tower.
    fn stretches(&self, open: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let length = self.length_m;
        let mut open: Vec<(f64, f64)> = open
            .iter()
            .map(|&(a, b)| {
                let from = a.rem_euclid(length.max(1e-9));
                (from, from + (b - a))
            })
            .collect();
        open.sort_by(|a, b| a.0.total_cmp(&b.0));
        let Some(&(first, _)) = open.first() else { return vec![(0.0, length)] };
        let (mut out, mut at) = (Vec::new(), first);
        for (from, to) in open {
            if from - at > 2.0 * TOWER_M.0 {
                out.push((at, from));
            }
            at = at.max(to);
        }
        if first + length - at > 2.0 * TOWER_M.0 {
            out.push((at, first + length));
        }
        out
    }
}

/// A railway past the town, along the river's flow if there is one, on the other side of the town; and where its station is.
pub(super) fn railway(town: &Town, seed: u64) -> (Link, [Node; 2], DVec2) {
    let draw = Draw::new(seed, Id(10), "words: railway");
    let flow = town.channel.as_ref().and_then(|c| Some((*c.middle.last()? - *c.middle.first()?).normalize_or(DVec2::X)));
    let along = flow.unwrap_or_else(|| turn(DVec2::X, draw.between("heading", 0.0, core::f64::consts::TAU)));
    let mut away = along.perp();
    if let Some(channel) = &town.channel {
        let mean = channel.middle.iter().copied().sum::<DVec2>() / channel.middle.len().max(1) as f64;
        if mean.dot(away) > 0.0 {
            away = -away;
        }
    }
    let reach = town.shape.border().iter().map(|p| p.dot(away)).fold(0.0, f64::max);
    let half = town.shape.reach_m();
    let bend = draw.between("bend", 0.02, 0.08) * half;
    let at = |t: f64| rounded(along * (half * t) + away * (reach + RAILWAY_AWAY_M + bend * t * t));
    let ends = [at(-1.0), at(1.0)];
    let link = Link {
        id: Id::NONE,
        from: network::node_id(ends[0]),
        to: network::node_id(ends[1]),
        via: (-7..=7).map(|i| at(f64::from(i) / 8.0)).collect(),
        kind: LinkKind::Railway { tram: false },
        width_m: 9.0,
        profile: Vec::new(),
        name: "Railway".to_owned(),
        layer: 0,
        surfacing: None,
    };
    (link, ends.map(|pos| Node { id: network::node_id(pos), pos, z: 0.0 }), at(0.0))
}

/// A fountain or statue in the middle of a square, a well in an old one.
pub(super) fn centrepiece(outline: &Ring, n: usize, is_old: bool) -> StandingObject {
    let pos = rounded(Polygon { outer: outline.clone(), holes: Vec::new() }.inner_pos());
    let kind = match (n, is_old) {
        (0, _) => ObjectKind::Fountain,
        (_, true) => ObjectKind::Well,
        _ => ObjectKind::Statue,
    };
    StandingObject { id: Id::NONE, kind, pos, heading_deg: 0.0, height_m: 0.0, name: String::new(), monument: String::new() }
}

/// Roads that lead on from the gates of a closed town: a piece outside each.
pub(super) fn roads_out(town: &Town) -> Vec<(Link, Node)> {
    let fabric: &Fabric = &town.fabric;
    let length = (0.05 * town.shape.reach_m()).clamp(24.0, 55.0);
    let road = |spot: u32| {
        let pos = fabric.pos(spot);
        let main = fabric.neighbours(spot).iter().filter_map(|&n| fabric.way(spot, n)).find(|w| w.is_main)?;
        let Role::Street(class) = main.role else { return None };
        let end = rounded(pos + pos.normalize_or(DVec2::X) * length);
        let link = Link {
            id: Id::NONE,
            from: network::node_id(pos),
            to: network::node_id(end),
            via: Vec::new(),
            kind: LinkKind::Street(class),
            width_m: main.width_m,
            profile: Vec::new(),
            name: String::new(),
            layer: 0,
            surfacing: None,
        };
        Some((link, Node { id: network::node_id(end), pos: end, z: 0.0 }))
    };
    town.gates.iter().filter_map(|g| road(g.spot)).collect()
}
