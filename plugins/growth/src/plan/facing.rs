//! What every edge of every footprint faces: neighbours, streets, yards.

use glam::DVec2;
use rayon::prelude::*;
use veduta_city::{GridPolygon, GridPos, SurfaceKind};

use super::ground::Ground;
use super::houses::{Body, Draft};
use super::index::{CellSet, Cells, Index};
use super::outline;
use veduta_city::bounds::{Bounds, about, do_meet, grown};

/// Walls closer than this, side by side, are party walls; metres.
const PARTY_M: f64 = 0.3;
/// Houses closer than this are neighbours; metres.
const NEAR_M: f64 = 3.0;
/// Where it is looked at what lies before a wall: as far as a street is still faced; metres.
const STEPS_M: [f64; 16] = [0.3, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];
/// Bodies that hang higher than this do not stand in the way of people; metres.
pub(super) const HEADROOM_M: f64 = 2.5;

/// A body: index of its house, index within the house.
pub(super) type BodyRef = (usize, usize);

/// One edge of a footprint and what it faces.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge<'a> {
    ends: (GridPos, GridPos),
    /// Whether a street, square, park or water lies before it.
    pub is_public: bool,
    /// Bodies along it, by body.
    pub parties: &'a [Party],
}

/// A body along an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Party {
    house: u32,
    body: u32,
    /// Share of the edge's length that it covers.
    pub share: f64,
}

impl Party {
    pub const fn body(&self) -> BodyRef {
        (self.house as usize, self.body as usize)
    }
}

impl Edge<'_> {
    pub fn a(&self) -> DVec2 {
        self.ends.0.to_metres()
    }

    pub fn b(&self) -> DVec2 {
        self.ends.1.to_metres()
    }

    /// Length, metres.
    pub fn length_m(&self) -> f64 {
        self.a().distance(self.b())
    }
}

/// Unit vector out of the house at its edge a–b.
fn outward(a: DVec2, b: DVec2) -> DVec2 {
    -(b - a).normalize_or_zero().perp()
}

/// What an edge faces, without what its footprint and the edge before it tell.
#[derive(Debug, Clone, Copy)]
struct Outlook {
    is_public: bool,
    /// Where its parties end among all: they follow those of the edge before.
    parties_end: u32,
}

/// What all the houses face: lists of a house, or of a body, one after another.
#[derive(Default)]
pub(super) struct Facing {
    /// In the order of houses, bodies, their outer rings, then of the holes.
    outlooks: Vec<Outlook>,
    parties: Vec<Party>,
    neighbours: Vec<u32>,
    /// Where the edges of each body end, …
    body_ends: Vec<u32>,
    /// … and the bodies and neighbours of each house.
    house_ends: Vec<(u32, u32)>,
}

impl Facing {
    /// Edges of a body, which has this footprint.
    pub fn of_body<'a>(&'a self, (house, body): BodyRef, footprint: &GridPolygon) -> impl Iterator<Item = Edge<'a>> {
        let first = self.before(house).0 as usize + body;
        let from = first.checked_sub(1).map_or(0, |before| self.body_ends[before] as usize);
        let outlooks = &self.outlooks[from..self.body_ends[first] as usize];
        let mut start = from.checked_sub(1).map_or(0, |before| self.outlooks[before].parties_end);
        outlooks.iter().zip(footprint.edges()).map(move |(&Outlook { is_public, parties_end }, ends)| {
            let parties = &self.parties[start as usize..parties_end as usize];
            start = parties_end;
            Edge { ends, is_public, parties }
        })
    }

    /// Edges of a house, body by body.
    pub fn of_house<'a>(&'a self, house: usize, draft: &'a Draft) -> impl Iterator<Item = Edge<'a>> {
        draft.bodies.iter().enumerate().flat_map(move |(body, of)| self.of_body((house, body), &of.footprint))
    }

    /// Houses within 3 m of a house, ascending.
    pub fn neighbours(&self, house: usize) -> impl Iterator<Item = usize> {
        let range = self.before(house).1 as usize..self.house_ends[house].1 as usize;
        self.neighbours[range].iter().map(|&near| near as usize)
    }

    fn before(&self, house: usize) -> (u32, u32) {
        house.checked_sub(1).map_or((0, 0), |before| self.house_ends[before])
    }

    /// Adds what the houses after its own face.
    fn append(&mut self, next: Self) {
        let [edges, parties, bodies, neighbours] =
            [self.outlooks.len(), self.parties.len(), self.body_ends.len(), self.neighbours.len()].map(|n| n as u32);
        let moved = |outlook: Outlook| Outlook { parties_end: outlook.parties_end + parties, ..outlook };
        self.outlooks.extend(next.outlooks.into_iter().map(moved));
        self.parties.extend(next.parties);
        self.neighbours.extend(next.neighbours);
        self.body_ends.extend(next.body_ends.into_iter().map(|end| end + edges));
        self.house_ends.extend(next.house_ends.into_iter().map(|(body, near)| (body + bodies, near + neighbours)));
    }
}

/// Bodies, each with how far its foot hangs above the ground, metres.
pub(super) type Bodies<'a> = Index<(BodyRef, f64), &'a GridPolygon>;

/// An index of all bodies, for questions about places.
pub(super) fn bodies(drafts: &[Draft]) -> Bodies<'_> {
    Index::new(bodies_of(drafts).map(|(at, body)| (&body.footprint, (at, body.bottom_m))).collect())
}

/// All bodies of all houses.
fn bodies_of(drafts: &[Draft]) -> impl Iterator<Item = (BodyRef, &Body)> {
    drafts.iter().enumerate().flat_map(|(h, draft)| draft.bodies.iter().enumerate().map(move |(b, body)| ((h, b), body)))
}

/// Houses that are looked out of one after the other.
const AT_ONCE: usize = 64;

/// Looks out of every wall. Also where the bodies stand, for an index of what is built on them.
pub(super) fn facing(drafts: &[Draft], ground: &Ground<'_>) -> (Facing, Cells) {
    let (standing, public) = rayon::join(|| bodies(drafts), || ground.cells_of(|(surface, _)| is_faced(*surface)));
    let before = Before { standing, ground, public };
    let of_some = |first: usize, some: &[Draft]| {
        let (around, spans, near) = (Vec::new(), Vec::new(), Vec::new());
        let seen = Facing::default();
        let mut view = View { drafts, before: &before, around, spans, near, seen, found: Vec::new() };
        some.iter().enumerate().for_each(|(i, draft)| view.house(first + i, draft));
        view.seen
    };
    let parts = drafts.par_chunks(AT_ONCE).enumerate().map(|(i, some)| of_some(i * AT_ONCE, some));
    let parts: Vec<Facing> = parts.collect();
    // What was seen is about to be there twice, and what was looked through need not be there still.
    let cells = before.into_cells();
    let sum = |count: fn(&Facing) -> usize| parts.iter().map(count).sum();
    let mut all = Facing {
        outlooks: Vec::with_capacity(sum(|part| part.outlooks.len())),
        parties: Vec::with_capacity(sum(|part| part.parties.len())),
        neighbours: Vec::with_capacity(sum(|part| part.neighbours.len())),
        body_ends: Vec::with_capacity(sum(|part| part.body_ends.len())),
        house_ends: Vec::with_capacity(drafts.len()),
    };
    parts.into_iter().for_each(|part| all.append(part));
    (all, cells)
}

/// What can be seen from a house's walls.
struct View<'a> {
    drafts: &'a [Draft],
    before: &'a Before<'a>,
    /// Edges of others about the body that is looked at.
    around: Vec<Near>,
    /// The parts of it that others run along.
    spans: Vec<(BodyRef, f64, f64)>,
    /// Houses near any of them, each once.
    near: Vec<usize>,
    /// Bodies that an index names.
    found: Vec<u32>,
    /// What was seen.
    seen: Facing,
}

/// An edge near a body.
struct Near {
    body: BodyRef,
    ends: (GridPos, GridPos),
    bounds: Bounds,
}

/// A box, and all that comes near it.
fn reach(bounds: Bounds) -> Bounds {
    grown(bounds, GridPos::steps(NEAR_M) + 1)
}

impl View<'_> {
    fn house(&mut self, house: usize, draft: &Draft) {
        self.near.clear();
        for (b, body) in draft.bodies.iter().enumerate() {
            self.look_around((house, b), &body.footprint);
            for (p, q) in body.footprint.edges() {
                let outlook = self.look_out((house, b), p, q);
                self.seen.outlooks.push(outlook);
            }
            self.seen.body_ends.push(self.seen.outlooks.len() as u32);
        }
        self.near.sort_unstable();
        self.seen.neighbours.extend(self.near.iter().map(|&near| near as u32));
        self.seen.house_ends.push((self.seen.body_ends.len() as u32, self.seen.neighbours.len() as u32));
    }

    /// Finds the edges of others near a body.
    fn look_around(&mut self, me: BodyRef, footprint: &GridPolygon) {
        self.around.clear();
        let Some(bounds) = footprint.bounds().map(reach) else { return };
        for (other, &(body, _)) in self.before.standing.bordering(bounds, &mut self.found).filter(|(_, (body, _))| *body != me) {
            let edges = other.edges().map(|ends| Near { body, ends, bounds: about(ends.0, ends.1) });
            self.around.extend(edges.filter(|near| do_meet(near.bounds, bounds)));
        }
    }

    /// Looks out of an edge of a body.
    fn look_out(&mut self, me: BodyRef, grid_a: GridPos, grid_b: GridPos) -> Outlook {
        let bounds = reach(about(grid_a, grid_b));
        let mut twin = None;
        let (a, b) = (grid_a.to_metres(), grid_b.to_metres());
        self.spans.clear();
        for &Near { body, ends: (p, q), .. } in self.around.iter().filter(|near| do_meet(near.bounds, bounds)) {
            if (p, q) == (grid_b, grid_a) {
                twin = Some(body);
            }
            let (p, q) = (p.to_metres(), q.to_metres());
            if body.0 != me.0 && !self.near.contains(&body.0) && is_near(a, b, p, q) {
                self.near.push(body.0);
            }
            if let Some((from, to)) = covered(a, b, p, q) {
                self.spans.push((body, from, to));
            }
        }
        self.spans.sort_unstable_by(|x, y| x.0.cmp(&y.0).then(x.1.total_cmp(&y.1)));
        let first = self.seen.parties.len();
        let party = |(house, body): BodyRef, share: f64| Party { house: house as u32, body: body as u32, share };
        let along = self.spans.chunk_by(|x, y| x.0 == y.0).map(|of_body| party(of_body[0].0, share(of_body)));
        self.seen.parties.extend(along);
        // All that is before a party wall is the neighbour whose wall it is too.
        let is_free_standing =
            |(house, body): BodyRef| matches!(&self.drafts[house].bodies[..], [one] if body == 0 && one.bottom_m < HEADROOM_M);
        let is_hidden = twin.is_some_and(is_free_standing);
        let out = outward(a, b);
        for t in [0.17, 0.5, 0.83].into_iter().filter(|_| !is_hidden) {
            let before = GridPos::from_metres(a.lerp(b, t) + out * 0.1);
            for &(body, _) in self.before.standing.of_kind_at(before, |(body, _)| *body != me) {
                let known = &self.seen.parties[first..];
                let at = first + known.partition_point(|other| other.body() < body);
                if self.seen.parties.get(at).is_none_or(|other| other.body() != body) {
                    self.seen.parties.insert(at, party(body, 0.0));
                }
                let known = &mut self.seen.parties[at].share;
                *known += if *known < 0.99 { 1.0 / 3.0 } else { 0.0 };
            }
        }
        let mut kept = first;
        for i in first..self.seen.parties.len() {
            let party = self.seen.parties[i];
            if party.share > 0.05 {
                self.seen.parties[kept] = Party { share: party.share.min(1.0), ..party };
                kept += 1;
            }
        }
        self.seen.parties.truncate(kept);
        let is_public = !is_hidden && self.before.is_public(a, b);
        Outlook { is_public, parties_end: kept as u32 }
    }
}

/// Whether two edges that do not cross come within 3 m of one another.
fn is_near(a: DVec2, b: DVec2, p: DVec2, q: DVec2) -> bool {
    [(a, p, q), (b, p, q), (p, a, b), (q, a, b)].into_iter().any(|(at, from, to)| outline::distance_to_edge(at, from, to) <= NEAR_M)
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

/// What lies and stands before walls.
struct Before<'a> {
    standing: Bodies<'a>,
    ground: &'a Ground<'a>,
    /// Where there may be public ground: most walls have none before them.
    public: CellSet,
}

impl Before<'_> {
    fn into_cells(self) -> Cells {
        self.standing.into_cells()
    }

    /// Whether most of an edge looks at public ground before it looks at a house.
    fn is_public(&self, a: DVec2, b: DVec2) -> bool {
        let out = outward(a, b);
        let sees = |t: f64| self.sees_public(a.lerp(b, t), out);
        let middle = sees(0.5);
        if a.distance(b) < 6.0 {
            return middle;
        }
        // Two of three decide.
        if sees(0.2) == middle { middle } else { sees(0.8) }
    }

    fn sees_public(&self, from: DVec2, out: DVec2) -> bool {
        let place = |step: f64| GridPos::from_metres(from + out * step);
        let first = place(STEPS_M[0]);
        let is_near = self.public.has(first);
        if is_near && let Some(is_public) = self.is_public_at(first) {
            return is_public;
        }
        let places = STEPS_M.map(place);
        let Some(last) = places.iter().rposition(|&pos| self.public.has(pos)) else { return false };
        places[usize::from(is_near)..=last].iter().find_map(|&pos| self.is_public_at(pos)).unwrap_or(false)
    }

    /// Whether public ground lies at a place; `None` where neither that nor a house is.
    fn is_public_at(&self, pos: GridPos) -> Option<bool> {
        if self.standing.of_kind_at(pos, |(_, bottom)| *bottom < HEADROOM_M).next().is_some() {
            return Some(false);
        }
        let is_public = || self.ground.of_kind_at(pos, |(surface, _)| is_faced(*surface)).next().is_some();
        (self.public.has(pos) && is_public()).then_some(true)
    }
}

/// Whether a surface makes a façade of a wall that looks at it.
const fn is_faced(surface: SurfaceKind) -> bool {
    !matches!(surface, SurfaceKind::Yard | SurfaceKind::Ballast | SurfaceKind::Opening)
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
