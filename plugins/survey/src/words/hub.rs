//! The main square, the streets that lead from it to gates and bridges, and the rings about it.

use core::f64::consts::TAU;

use glam::DVec2;
use veduta_city::Id;
use veduta_city::draw::Draw;

use super::fabric::{End, Fabric, FaceId, Role, Spot, Use, WayId, crossings};
use super::fit::Fit;
use super::grain::curve;
use super::shape::Shape;
use super::turn;

/// What a street out of the main square leads to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Exit {
    pub spot: Spot,
    /// Whether it is a gate, and no bridge.
    pub is_gate: bool,
}

/// How the main streets are laid.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mains {
    /// What they are.
    pub role: Role,
    pub width_m: f64,
    /// How crooked, 0 to 1.
    pub crooked: f64,
    /// Main streets keep this far from other lines, metres.
    pub clear_m: f64,
}

impl Mains {
    fn fit(&self) -> Fit {
        Fit {
            width_m: self.width_m,
            clear_m: self.clear_m,
            least_m2: 700.0,
            least_width_m: 15.0,
            least_angle: 0.6,
            gap_m: self.width_m + 8.0,
        }
    }
}

/// Gates about evenly round the border, away from a river's mouths.
pub(super) fn gates(fabric: &mut Fabric, shape: &Shape, count: u32, mouths: &[Spot], seed: u64) -> Vec<Exit> {
    let draw = Draw::new(seed, Id(4), "words: gates");
    let first = draw.between("first", 0.0, TAU);
    let (mouths, mut taken): (Vec<DVec2>, Vec<DVec2>) = (mouths.iter().map(|&m| fabric.pos(m)).collect(), Vec::new());
    let mut out = Vec::new();
    for n in 0..count {
        let turned = first + TAU * (f64::from(n) + draw.part(u64::from(n)).between("turn", -0.2, 0.2)) / f64::from(count);
        let dir = turn(DVec2::X, turned);
        let pos = dir * shape.radius_m(dir);
        let apart = |others: &[DVec2], m: f64| others.iter().all(|o| o.distance(pos) > m);
        let radius = shape.radius_m(dir);
        if !apart(&mouths, (radius * 0.16).max(34.0)) || !apart(&taken, 40.0) {
            continue;
        }
        if let Some(spot) = on_border(fabric, pos) {
            taken.push(fabric.pos(spot));
            out.push(Exit { spot, is_gate: true });
        }
    }
    out
}

/// A vertex of the border near a point on it.
fn on_border(fabric: &mut Fabric, pos: DVec2) -> Option<Spot> {
    let lands = (0..fabric.faces.len()).filter(|&f| fabric.faces[f].use_ == Use::Land);
    let (face, edge, _) = lands
        .flat_map(|face| {
            let outline = fabric.outline(face);
            (0..outline.len()).map(move |i| (face, i, super::fit::distance_to(pos, outline[i], outline[(i + 1) % outline.len()])))
        })
        .min_by(|a, b| a.2.total_cmp(&b.2))?;
    let end = fabric.end_near(face, edge, pos, 12.0)?;
    Some(fabric.place(end))
}

/// The main square about a hub in a face, with these corners (counter-clockwise, relative to the hub), with streets to every exit that can be reached. Gives back the square's face and the
/// exits reached; `None` if no two exits can be joined by way of a square.
pub(super) fn open_square(
    fabric: &mut Fabric,
    hub: DVec2,
    corners: &[DVec2],
    exits: &[Exit],
    mains: &Mains,
    seed: u64,
) -> Option<(FaceId, Vec<Exit>)> {
    let face = face_at(fabric, hub)?;
    let own: Vec<Exit> = exits.iter().copied().filter(|e| fabric.ring(face).contains(&e.spot)).collect();
    let vertices = square_vertices(fabric, hub, corners, &own, mains);
    let front = fabric.add_way(Role::Front, 0.0, false);
    let draw = Draw::new(seed, Id(5), "words: mains");
    let (square, first) = first_through(fabric, face, hub, &vertices, front, mains, draw)?;
    let ring = fabric.ring(square).to_vec();
    let mut reached: Vec<Exit> = first.to_vec();
    for (exit, pos) in vertices.iter().filter_map(|v| Some((v.exit?, v.pos))) {
        if reached.iter().any(|r| r.spot == exit.spot) {
            continue;
        }
        let Some(door) = ring.iter().copied().find(|&s| fabric.pos(s).distance(pos) < 0.5) else { continue };
        if join(fabric, door, exit.spot, hub, mains, draw.part(u64::from(exit.spot))).is_some() {
            reached.push(exit);
        }
    }
    Some((square, reached))
}

/// A vertex of the square to be, and the exit that a street leads to from it.
#[derive(Debug, Clone, Copy)]
struct Vertex {
    pos: DVec2,
    exit: Option<Exit>,
}

/// Vertices of a square, counter-clockwise from the first: its corners, and where the streets to the exits leave. A street near
/// a corner leaves at the corner.
fn square_vertices(fabric: &Fabric, hub: DVec2, corners: &[DVec2], exits: &[Exit], mains: &Mains) -> Vec<Vertex> {
    let turned = |p: DVec2| libm::atan2(p.y, p.x).rem_euclid(TAU);
    let mut vertices: Vec<(f64, Vertex)> =
        corners.iter().map(|&c| (turned(c), Vertex { pos: super::fabric::rounded(hub + c), exit: None })).collect();
    let corner: Vec<DVec2> = vertices.iter().map(|v| v.1.pos).collect();
    let mut taken: Vec<DVec2> = Vec::new();
    for &exit in exits {
        let dir = (fabric.pos(exit.spot) - hub).normalize_or(DVec2::X);
        let hit = crossings(&corner, hub, dir).into_iter().map(|c| c.1).find(|c| (*c - hub).dot(dir) > 0.0);
        let Some(pos) = hit.map(super::fabric::rounded) else { continue };
        let room = mains.width_m + 7.0;
        let nearest = vertices.iter_mut().min_by(|a, b| a.1.pos.distance(pos).total_cmp(&b.1.pos.distance(pos)));
        let corner = nearest.map(|v| &mut v.1).filter(|v| v.pos.distance(pos) < room);
        let door = corner.as_ref().map_or(pos, |v| v.pos);
        if taken.iter().any(|t: &DVec2| t.distance(door) < room) {
            continue;
        }
        taken.push(door);
        match corner {
            Some(vertex) => vertex.exit = Some(exit),
            None => vertices.push((turned(pos - hub), Vertex { pos, exit: Some(exit) })),
        }
    }
    vertices.sort_by(|a, b| a.0.total_cmp(&b.0));
    vertices.into_iter().map(|v| v.1).collect()
}

/// Lays the street from one exit by way of the square to another, and the square with it.
fn first_through(
    fabric: &mut Fabric,
    face: FaceId,
    hub: DVec2,
    vertices: &[Vertex],
    front: WayId,
    mains: &Mains,
    draw: Draw,
) -> Option<(FaceId, [Exit; 2])> {
    let with_exit: Vec<(usize, Exit)> = vertices.iter().enumerate().filter_map(|(i, v)| Some((i, v.exit?))).collect();
    let mut pairs: Vec<((usize, Exit), (usize, Exit), f64)> = Vec::new();
    for (n, &a) in with_exit.iter().enumerate() {
        for &b in with_exit.iter().skip(n + 1) {
            let dir = |i: usize| (vertices[i].pos - hub).normalize_or_zero();
            pairs.push((a, b, dir(a.0).dot(dir(b.0))));
        }
    }
    // The most nearly opposite first.
    pairs.sort_by(|a, b| a.2.total_cmp(&b.2));
    for ((i, a), (j, b), _) in pairs {
        let n = vertices.len();
        let half = |from: usize, to: usize| -> Vec<DVec2> {
            (0..=(to + n - from) % n).filter_map(|k| vertices.get((from + k) % n).map(|v| v.pos)).collect()
        };
        let (near, mut far) = (half(i, j), half(j, i));
        far.reverse();
        let main = fabric.add_way(mains.role, mains.width_m, true);
        let other = fabric.add_way(mains.role, mains.width_m, true);
        let come = street(fabric, vertices[i].pos, a.spot, hub, mains, draw.part(u64::from(a.spot)));
        let go = street(fabric, vertices[j].pos, b.spot, hub, mains, draw.part(u64::from(b.spot)));
        let mut line: Vec<(DVec2, WayId)> = come.iter().rev().map(|&p| (p, main)).collect();
        line.push((vertices[i].pos, main));
        line.extend(near.iter().skip(1).map(|&p| (p, front)));
        line.extend(go.iter().map(|&p| (p, other)));
        let points: Vec<DVec2> = line.iter().map(|l| l.0).collect();
        if fabric.division(face, End::At(a.spot), &points, End::At(b.spot), &mains.fit()).is_none() {
            continue;
        }
        fabric.split(face, a.spot, &line, b.spot, other)?;
        let at = |fabric: &Fabric, p: DVec2| fabric.ring(face).iter().copied().find(|&s| fabric.pos(s).distance(p) < 1e-6);
        let (from, to) = (at(fabric, vertices[i].pos)?, at(fabric, vertices[j].pos)?);
        let inner: Vec<(DVec2, WayId)> = far.get(1..far.len() - 1)?.iter().map(|&p| (p, front)).collect();
        let square = fabric.split(face, from, &inner, to, front)?;
        fabric.faces.get_mut(square)?.use_ = Use::Square;
        return Some((square, [a, b]));
    }
    None
}

/// Inner points of a main street from a door of the square outwards to an exit.
fn street(fabric: &Fabric, door: DVec2, exit: Spot, hub: DVec2, mains: &Mains, draw: Draw) -> Vec<DVec2> {
    let end = fabric.pos(exit);
    let length = door.distance(end);
    let out = (door - hub).normalize_or_zero();
    let side = (end - door).perp() * mains.crooked;
    let (a, b) = (draw.between("near", -0.2, 0.2), draw.between("far", -0.2, 0.2));
    if mains.crooked <= 0.0 {
        return Vec::new();
    }
    curve([door, door + (out * 0.5 * length + (end - door) * 0.5) * 0.35 + side * a, end.lerp(door, 0.35) + side * b, end], 14.0)
}

/// Lays a main street from a vertex to an exit through the face that both lie on; crooked if there is room, else straight.
pub(super) fn join(fabric: &mut Fabric, door: Spot, exit: Spot, hub: DVec2, mains: &Mains, draw: Draw) -> Option<FaceId> {
    let crooked = street(fabric, fabric.pos(door), exit, hub, mains, draw);
    for inner in [crooked, Vec::new()] {
        let lands = (0..fabric.faces.len())
            .filter(|&f| fabric.faces[f].use_ == Use::Land && fabric.ring(f).contains(&door) && fabric.ring(f).contains(&exit));
        let fits = |&f: &FaceId| fabric.division(f, End::At(door), &inner, End::At(exit), &mains.fit()).is_some();
        let found: Option<FaceId> = lands.filter(fits).min();
        if let Some(face) = found {
            let way = fabric.add_way(mains.role, mains.width_m, true);
            let inner: Vec<(DVec2, WayId)> = inner.iter().map(|&p| (p, way)).collect();
            return fabric.split(face, door, &inner, exit, way);
        }
    }
    None
}

/// Streets from bridges to gates in faces that have no square. Gives back the gates reached.
pub(super) fn join_far_gates(fabric: &mut Fabric, exits: &[Exit], mains: &Mains, seed: u64) -> Vec<Exit> {
    let mut reached = Vec::new();
    for gate in exits.iter().filter(|e| e.is_gate) {
        let mut heads: Vec<&Exit> = exits.iter().filter(|e| !e.is_gate).collect();
        heads.sort_by(|a, b| {
            let d = |e: &Exit| fabric.pos(e.spot).distance(fabric.pos(gate.spot));
            d(a).total_cmp(&d(b))
        });
        for head in heads {
            let draw = Draw::new(seed, Id(u64::from(gate.spot)), "words: far mains");
            let back = fabric.pos(head.spot) * 2.0 - fabric.pos(gate.spot);
            if join(fabric, head.spot, gate.spot, back, mains, draw).is_some() {
                reached.push(*gate);
                break;
            }
        }
    }
    reached
}

/// The face of land around a point.
pub(super) fn face_at(fabric: &Fabric, p: DVec2) -> Option<FaceId> {
    (0..fabric.faces.len()).find(|&f| {
        let hits = crossings(&fabric.outline(f), p, DVec2::X);
        fabric.faces[f].use_ == Use::Land && hits.iter().filter(|c| c.1.x > p.x).count() % 2 == 1
    })
}

/// Lays a ring street where the share of the way from the middle to the border has a value, through every face of land that it
/// crosses.
pub(super) fn ring_street(fabric: &mut Fabric, shape: &Shape, share: f64, way: WayId, fit: &Fit) {
    let mut face = 0;
    // Each arc laid makes one face more, which is looked at in its turn.
    while face < fabric.faces.len() {
        let is_land = fabric.faces[face].use_ == Use::Land;
        if !(is_land && ring_arc(fabric, face, shape, share, way, fit).is_some()) {
            face += 1;
        }
    }
}

fn ring_arc(fabric: &mut Fabric, face: FaceId, shape: &Shape, share: f64, way: WayId, fit: &Fit) -> Option<FaceId> {
    let outline = fabric.outline(face);
    let n = outline.len();
    let mut cuts: Vec<(f64, usize, DVec2)> = Vec::new();
    for i in 0..n {
        let (a, b) = (outline[i], outline[(i + 1) % n]);
        let (fa, fb) = (shape.share(a) - share, shape.share(b) - share);
        if (fa > 0.0) != (fb > 0.0) {
            let p = a.lerp(b, fa / (fa - fb));
            cuts.push((libm::atan2(p.y, p.x).rem_euclid(TAU), i, p));
        }
    }
    cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (k, &(from, i, p)) in cuts.iter().enumerate() {
        let (to, j, q) = cuts[(k + 1) % cuts.len()];
        let sweep = (to - from).rem_euclid(TAU);
        let at = |t: f64| {
            let dir = turn(DVec2::X, from + sweep * t);
            dir * (shape.radius_m(dir) * share)
        };
        if i == j || sweep <= 0.0 || face_at(fabric, at(0.5)) != Some(face) {
            continue;
        }
        let (start, end) = (fabric.end_near(face, i, p, fit.gap_m)?, fabric.end_near(face, j, q, fit.gap_m)?);
        let (a, b) = (fabric.end_pos(start), fabric.end_pos(end));
        let count = libm::round(sweep * p.length() / 14.0).clamp(2.0, 90.0) as usize;
        let inner: Vec<DVec2> =
            (1..count).map(|s| at(s as f64 / count as f64)).filter(|c| c.distance(a) > 12.0 && c.distance(b) > 12.0).collect();
        if fabric.division(face, start, &inner, end, fit).is_none() {
            continue;
        }
        let (from, to) = (fabric.place(start), fabric.place(end));
        let inner: Vec<(DVec2, WayId)> = inner.into_iter().map(|p| (p, way)).collect();
        return fabric.split(face, from, &inner, to, way);
    }
    None
}

/// Corners of a market: a crooked oblong.
pub(super) fn market(radius_m: f64, seed: u64) -> Vec<DVec2> {
    let draw = Draw::new(seed, Id(6), "words: market");
    let axis = turn(DVec2::X, draw.between("axis", 0.0, TAU));
    let longer = draw.between("longer", 1.1, 1.6);
    let corner = |i: u64, (x, y): (f64, f64)| {
        let draw = draw.part(i);
        let out = DVec2::new(x * longer, y) * (0.72 * radius_m * draw.between("out", 0.82, 1.12));
        turn(axis, draw.between("askew", -0.08, 0.08)) * out.x + axis.perp() * out.y
    };
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].into_iter().zip(0..).map(|(c, i)| corner(i, c)).collect()
}

/// Corners of a round place.
pub(super) fn round_place(radius_m: f64) -> Vec<DVec2> {
    (0..16).map(|i| turn(DVec2::X, TAU * f64::from(i) / 16.0) * radius_m).collect()
}
