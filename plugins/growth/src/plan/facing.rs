//! What every edge of every footprint faces: neighbours, streets, yards.

use glam::DVec2;
use rayon::prelude::*;
use veduta_city::{GridPolygon, GridPos, SurfaceKind};

use super::bounds::{Bounds, about, do_meet, grown, joined};
use super::ground::Ground;
use super::houses::{Body, Draft};
use super::index::{Cells, Gathering, Index};
use super::outline;

/// Walls closer than this, side by side, are party walls; metres.
const PARTY_M: f64 = 0.3;
/// Houses closer than this are neighbours; metres.
const NEAR_M: f64 = 3.0;
/// How far before a wall a street is still faced; metres.
const REACH_M: f64 = 15.0;
/// Bodies that hang higher than this do not stand in the way of people; metres.
pub(super) const HEADROOM_M: f64 = 2.5;

/// A body: index of its house, index within the house.
pub(super) type BodyRef = (usize, usize);

/// One edge of a footprint and what it faces.
#[derive(Debug, Clone)]
pub(super) struct Edge {
    pub a: DVec2,
    pub b: DVec2,
    /// Bodies along it and the share of its length that each covers, by body.
    pub party: Vec<(BodyRef, f64)>,
    /// Whether a street, square, park or water lies before it.
    pub is_public: bool,
}

impl Edge {
    /// Length, metres.
    pub fn length_m(&self) -> f64 {
        self.a.distance(self.b)
    }

    /// Unit vector out of the house.
    pub fn outward(&self) -> DVec2 {
        -(self.b - self.a).normalize_or_zero().perp()
    }
}

/// What all the houses face.
pub(super) struct Facing {
    /// Edges by house, body, edge; edges in the order of the outer ring, then of the holes.
    pub edges: Vec<Vec<Vec<Edge>>>,
    /// Houses within 3 m of each house, ascending.
    pub neighbours: Vec<Vec<usize>>,
}

/// The edges of all footprints, and which run where.
struct Edges {
    all: Vec<(BodyRef, GridPos, GridPos)>,
    cells: Cells,
}

impl Edges {
    fn of(drafts: &[Draft]) -> Self {
        let bodies: Vec<(BodyRef, &GridPolygon)> = bodies_of(drafts).map(|(at, body)| (at, &body.footprint)).collect();
        let edges = |&(at, footprint): &(BodyRef, &'_ GridPolygon)| footprint.edges().map(move |(p, q)| (at, p, q)).collect();
        let all: Vec<(BodyRef, GridPos, GridPos)> = bodies.par_iter().flat_map_iter::<_, Vec<_>>(edges).collect();
        let boxes = all.iter().map(|&(_, p, q)| about(p, q));
        let Some(bounds) = boxes.reduce(joined) else { return Self { all, cells: Cells::default() } };
        let gathering = Gathering::new(bounds, drafts.len());
        let cells = gathering.each(&all, |own, &(_, p, q), i| own.edge(p, q, i as u32)).sorted();
        Self { all, cells }
    }
}

/// An index of the bodies that stand on the ground, for questions about places.
pub(super) fn bodies(drafts: &[Draft]) -> Index<(BodyRef, f64)> {
    Index::new(bodies_of(drafts).map(|(at, body)| (body.footprint.clone(), (at, body.bottom_m))).collect())
}

/// All bodies of all houses.
fn bodies_of(drafts: &[Draft]) -> impl Iterator<Item = (BodyRef, &Body)> {
    drafts.iter().enumerate().flat_map(|(h, draft)| draft.bodies.iter().enumerate().map(move |(b, body)| ((h, b), body)))
}

/// Looks out of every wall.
pub(super) fn facing(drafts: &[Draft], standing: &Index<(BodyRef, f64)>, ground: &Ground) -> Facing {
    let walls = Edges::of(drafts);
    let of_house = |(h, draft): (usize, &Draft)| {
        let mut view = View { drafts, walls: &walls, standing, ground, around: Vec::new(), spans: Vec::new(), near: Vec::new() };
        let mut of_body = |b: usize| -> Vec<Edge> {
            let footprint = &draft.bodies[b].footprint;
            view.look_around((h, b), footprint);
            footprint.edges().map(|(a, c)| view.edge((h, b), a, c)).collect()
        };
        let edges: Vec<Vec<Edge>> = (0..draft.bodies.len()).map(&mut of_body).collect();
        view.near.sort_unstable();
        (edges, view.near)
    };
    let (edges, neighbours) = drafts.par_iter().enumerate().map(of_house).unzip();
    Facing { edges, neighbours }
}

/// What can be seen from a house's walls.
struct View<'a> {
    drafts: &'a [Draft],
    walls: &'a Edges,
    standing: &'a Index<(BodyRef, f64)>,
    ground: &'a Ground,
    /// Edges of others about the body that is looked at.
    around: Vec<(BodyRef, GridPos, GridPos)>,
    /// The parts of it that others run along.
    spans: Vec<(BodyRef, f64, f64)>,
    /// Houses near any of them, each once.
    near: Vec<usize>,
}

/// A box, and all that comes near it.
fn reach(bounds: Bounds) -> Bounds {
    grown(bounds, GridPos::steps(NEAR_M) + 1)
}

impl View<'_> {
    /// Finds the edges of others near a body.
    fn look_around(&mut self, me: BodyRef, footprint: &GridPolygon) {
        self.around.clear();
        let Some(bounds) = footprint.bounds().map(reach) else { return };
        let mut found = Vec::new();
        self.walls.cells.within(bounds.0, bounds.1, |note| note, &mut found);
        let edges = found.into_iter().map(|number| self.walls.all[number as usize]);
        self.around.extend(edges.filter(|&(body, p, q)| body != me && do_meet(about(p, q), bounds)));
    }

    fn edge(&mut self, me: BodyRef, a: GridPos, b: GridPos) -> Edge {
        let bounds = reach(about(a, b));
        let (grid_a, grid_b, mut twin) = (a, b, None);
        let (a, b) = (a.to_metres(), b.to_metres());
        self.spans.clear();
        for &(body, p, q) in &self.around {
            if !do_meet(about(p, q), bounds) {
                continue;
            }
            if (p, q) == (grid_b, grid_a) {
                twin = Some(body);
            }
            let (p, q) = (p.to_metres(), q.to_metres());
            if body.0 != me.0 && !self.near.contains(&body.0) && gap_m(a, b, p, q) <= NEAR_M {
                self.near.push(body.0);
            }
            if let Some((from, to)) = covered(a, b, p, q) {
                self.spans.push((body, from, to));
            }
        }
        self.spans.sort_unstable_by(|x, y| x.0.cmp(&y.0).then(x.1.total_cmp(&y.1)));
        let mut party: Vec<(BodyRef, f64)> =
            self.spans.chunk_by(|x, y| x.0 == y.0).map(|of_body| (of_body[0].0, share(of_body))).collect();
        let edge = Edge { a, b, party: Vec::new(), is_public: false };
        // All that is before a party wall is the neighbour whose wall it is too.
        if twin
            .is_some_and(|(house, body)| matches!(&self.drafts[house].bodies[..], [one] if body == 0 && one.bottom_m < HEADROOM_M))
        {
            party.retain(|&(_, share)| share > 0.05);
            return Edge { party, ..edge };
        }
        let out = edge.outward();
        for t in [0.17, 0.5, 0.83] {
            let before = GridPos::from_metres(a.lerp(b, t) + out * 0.1);
            for &(body, _) in self.standing.at(before).filter(|(body, _)| *body != me) {
                let at = party.partition_point(|(other, _)| *other < body);
                if party.get(at).is_none_or(|(other, _)| *other != body) {
                    party.insert(at, (body, 0.0));
                }
                let known = &mut party[at].1;
                *known += if *known < 0.99 { 1.0 / 3.0 } else { 0.0 };
            }
        }
        party.iter_mut().for_each(|(_, share)| *share = share.min(1.0));
        party.retain(|&(_, share)| share > 0.05);
        Edge { is_public: is_public(&edge, self.standing, self.ground), party, ..edge }
    }
}

/// Least distance between two edges that do not cross, metres.
fn gap_m(a: DVec2, b: DVec2, p: DVec2, q: DVec2) -> f64 {
    let d = outline::distance_to_edge;
    d(a, p, q).min(d(b, p, q)).min(d(p, a, b)).min(d(q, a, b))
}

/// The part of a–b, as parameters 0 to 1, that p–q runs along; `None` if it does not.
fn covered(a: DVec2, b: DVec2, p: DVec2, q: DVec2) -> Option<(f64, f64)> {
    let (way, other) = (b - a, q - p);
    let (dot, squares) = (way.dot(other), way.length_squared() * other.length_squared());
    // Side by side means opposite directions within about 10°.
    if dot >= 0.0 || dot * dot < 0.985 * 0.985 * squares {
        return None;
    }
    let length = way.length();
    let u = way / length;
    let (dp, dq) = ((p - a).perp_dot(u), (q - a).perp_dot(u));
    if dp.abs().min(dq.abs()) > PARTY_M || (dp + dq).abs() / 2.0 > 2.0 * PARTY_M {
        return None;
    }
    let (s, t) = ((q - a).dot(u) / length, (p - a).dot(u) / length);
    let (s, t) = (s.clamp(0.0, 1.0), t.clamp(0.0, 1.0));
    (t > s).then_some((s, t))
}

/// Length of the union of a body's spans, which are in order of where they begin.
fn share(spans: &[(BodyRef, f64, f64)]) -> f64 {
    let (mut sum, mut end) = (0.0, 0.0_f64);
    for &(_, s, t) in spans {
        sum += (t - s.max(end)).max(0.0);
        end = end.max(t);
    }
    sum
}

/// Whether most of an edge looks at public ground before it looks at a house.
fn is_public(edge: &Edge, standing: &Index<(BodyRef, f64)>, ground: &Ground) -> bool {
    let out = edge.outward();
    let sees = |t: f64| sees_public(edge.a.lerp(edge.b, t), out, standing, ground);
    let middle = sees(0.5);
    if edge.length_m() < 6.0 {
        return middle;
    }
    // Two of three decide.
    if sees(0.2) == middle { middle } else { sees(0.8) }
}

fn sees_public(from: DVec2, out: DVec2, standing: &Index<(BodyRef, f64)>, ground: &Ground) -> bool {
    let mut step = 0.3;
    while step <= REACH_M {
        let pos = GridPos::from_metres(from + out * step);
        if standing.at(pos).any(|(_, bottom)| *bottom < HEADROOM_M) {
            return false;
        }
        if ground.at(pos).next().is_some_and(|(surface, _)| is_faced(*surface)) {
            return true;
        }
        step += if step < 1.0 { 0.7 } else { 1.0 };
    }
    false
}

/// Whether a surface makes a façade of a wall that looks at it.
const fn is_faced(surface: SurfaceKind) -> bool {
    !matches!(surface, SurfaceKind::Yard | SurfaceKind::Ballast)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_back_to_back_are_covered_and_others_are_not() {
        let (a, b) = (DVec2::ZERO, DVec2::new(10.0, 0.0));
        let run = |p: (f64, f64), q: (f64, f64)| covered(a, b, DVec2::new(p.0, p.1), DVec2::new(q.0, q.1));
        assert_eq!(run((5.0, 0.0), (-3.0, 0.0)), Some((0.0, 0.5)));
        assert_eq!(run((5.0, -0.2), (0.0, -0.2)), Some((0.0, 0.5)), "a gap of 20 cm");
        assert_eq!(run((5.0, -2.0), (0.0, -2.0)), None, "an alley");
        assert_eq!(run((0.0, 0.0), (5.0, 0.0)), None, "the same side");
        assert_eq!(run((5.0, 0.0), (5.0, 5.0)), None, "across");
    }

    #[test]
    fn overlapping_spans_count_once() {
        let spans = [(0.0, 0.2), (0.1, 0.6), (0.5, 0.8)].map(|(from, to)| ((0, 0), from, to));
        assert!((share(&spans) - 0.8).abs() < 1e-12);
    }
}
