//! The faces of a tile's snapped edges, and which layer covers each.

use rustc_hash::FxHashSet;
use veduta_city::{BorderEdge, GRID_PER_METRE, GridPos, PLAN_STEP, connected_faces};

use super::{Piece, Segment, Tile, Turns, hot, turn};
use crate::plan::groups::Groups;

/// An edge between two hot points, the lesser first, and whether it runs so (1) for a layer or back (-1).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Turn {
    u: u32,
    v: u32,
    /// [`SIDE`]: a side of the tile.
    layer: u32,
    by: i16,
}

/// Steps of the plan in a metre.
const STEPS_A_METRE: f64 = (GRID_PER_METRE / PLAN_STEP) as f64;

/// In place of a layer.
const SIDE: u32 = u32::MAX;
/// Covers below all layers: none, and what lies outside of the tile.
const NONE: u32 = u32::MAX - 1;
const OUTSIDE: u32 = u32::MAX;

/// Segments of a tile on their ways by hot points.
pub(super) struct Ways<'a> {
    tile: Tile,
    hot: &'a [GridPos],
    turns: Vec<Turn>,
    southern: Vec<(u32, i32)>,
    northern: Vec<(u32, i32)>,
    way: Vec<u32>,
}

/// What a tile knows of the edges that leave its western side.
#[derive(Debug, Default)]
pub(super) struct Sides {
    /// How often each layer's edges run eastward from it, less westward to it, but for those along the other sides.
    pub inner: Turns,
    /// Segments that run from its south-western corner along the southern side (1) or to it (-1), and the same for the north.
    pub southern: Vec<(u32, i32)>,
    pub northern: Vec<(u32, i32)>,
}

impl<'a> Ways<'a> {
    pub(super) fn new(tile: Tile, hot: &'a [GridPos]) -> Self {
        let mut turns = Vec::with_capacity(4 * hot.len());
        let side = |on: &dyn Fn(GridPos) -> bool, turns: &mut Vec<Turn>| {
            let mut before = None;
            for (i, _) in hot.iter().enumerate().filter(|&(_, &p)| on(p)) {
                turns.extend(before.map(|u| Turn { u, v: i as u32, layer: SIDE, by: 0 }));
                before = Some(i as u32);
            }
        };
        side(&|p| p.0 == tile.lo.0, &mut turns);
        side(&|p| p.0 == tile.hi.0, &mut turns);
        side(&|p| p.1 == tile.lo.1, &mut turns);
        side(&|p| p.1 == tile.hi.1, &mut turns);
        Self { tile, hot, turns, southern: Vec::new(), northern: Vec::new(), way: Vec::new() }
    }

    /// Adds a segment.
    pub(super) fn add(&mut self, number: u32, segment: &Segment) {
        let mut way = core::mem::take(&mut self.way);
        hot::way(segment, self.hot, &mut way);
        way.windows(2).for_each(|pair| self.step(number, segment.layer, pair[0], pair[1]));
        self.way = way;
    }

    fn step(&mut self, number: u32, layer: u32, from: u32, to: u32) {
        let (u, v, by) = if from < to { (from, to, 1) } else { (to, from, -1) };
        self.turns.push(Turn { u, v, layer, by });
        let (a, b) = (self.hot[u as usize], self.hot[v as usize]);
        if a.0 == self.tile.lo.0 && a.1 == b.1 {
            if a.1 == self.tile.lo.1 {
                self.southern.push((number, i32::from(by)));
            } else if a.1 == self.tile.hi.1 {
                self.northern.push((number, i32::from(by)));
            }
        }
    }
}

#[derive(Debug, Clone, Copy)]
struct Edge {
    u: u32,
    v: u32,
    /// Whether it is a part of the tile's side.
    is_side: bool,
    /// Of `Faces::turns`: those of the edge.
    turns: (u32, u32),
}

/// The faces of a tile. Each edge has two halves: 2e runs from its lesser end to the greater, 2e + 1 back; a loop of halves
/// keeps its face on the left.
pub(super) struct Faces<'a> {
    tile: Tile,
    hot: &'a [GridPos],
    edges: Vec<Edge>,
    /// Layer and how often it winds more on an edge's left than on its right.
    turns: Vec<(u32, i32)>,
    /// The half after each half.
    next: Vec<u32>,
    /// The loop of each half.
    loops: Vec<u32>,
    /// A half of each loop.
    begins: Vec<u32>,
    /// Pairs of loops that go round the same face.
    joined: Vec<(u32, u32)>,
    /// The layer that covers the face of each loop, in the end.
    covers: Vec<u32>,
}

impl<'a> Faces<'a> {
    pub(super) fn new(ways: Ways<'a>) -> (Self, Sides) {
        let Ways { tile, hot, mut turns, southern, northern, .. } = ways;
        turns.sort_unstable_by_key(|turn| (u64::from(turn.u) << 32 | u64::from(turn.v), turn.layer));
        let mut faces = Faces {
            tile,
            hot,
            edges: Vec::new(),
            turns: Vec::new(),
            next: Vec::new(),
            loops: Vec::new(),
            begins: Vec::new(),
            joined: Vec::new(),
            covers: Vec::new(),
        };
        let mut inner = Turns::new();
        for same in turns.chunk_by(|a, b| (a.u, a.v) == (b.u, b.v)) {
            let first = faces.turns.len() as u32;
            for layer in same.chunk_by(|a, b| a.layer == b.layer) {
                let by: i32 = layer.iter().map(|turn| i32::from(turn.by)).sum();
                if by != 0 {
                    faces.turns.push((layer[0].layer, by));
                }
            }
            let is_side = same.iter().any(|turn| turn.layer == SIDE);
            let end = faces.turns.len() as u32;
            if end > first || is_side {
                let (u, v) = (same[0].u, same[0].v);
                if !is_side && faces.at(u).0 == tile.lo.0 {
                    faces.turns[first as usize..].iter().for_each(|&(layer, by)| turn(&mut inner, layer, by));
                }
                faces.edges.push(Edge { u, v, is_side, turns: (first, end) });
            }
        }
        faces.walk();
        (faces, Sides { inner, southern, northern })
    }

    fn at(&self, i: u32) -> GridPos {
        self.hot[i as usize]
    }

    fn start(&self, half: u32) -> u32 {
        let edge = &self.edges[half as usize / 2];
        if half.is_multiple_of(2) { edge.u } else { edge.v }
    }

    fn ends(&self, half: u32) -> (GridPos, GridPos) {
        (self.at(self.start(half)), self.at(self.start(half ^ 1)))
    }

    /// Finds the loops, and which of them go round the same face.
    fn walk(&mut self) {
        let stars = self.stars();
        let halves = 2 * self.edges.len();
        self.next = vec![0; halves];
        for star in stars.iter() {
            for (i, &half) in star.iter().enumerate() {
                // Arriving on the other half, one leaves by the next clockwise.
                self.next[half as usize ^ 1] = star[(i + star.len() - 1) % star.len()];
            }
        }
        self.loops = vec![u32::MAX; halves];
        for first in 0..halves as u32 {
            let mut half = first;
            while self.loops[half as usize] == u32::MAX {
                self.loops[half as usize] = self.begins.len() as u32;
                half = self.next[half as usize];
            }
            if self.loops[first as usize] as usize == self.begins.len() {
                self.begins.push(first);
            }
        }
        self.joined = self.islands(&stars);
    }

    /// The halves that begin at each hot point, counter-clockwise from south, to which none runs: eastward halves come first,
    /// for their end is after their start.
    fn stars(&self) -> Stars {
        let halves = 2 * self.edges.len() as u32;
        let mut stars = Stars { starts: vec![0; self.hot.len() + 1], halves: vec![0; halves as usize] };
        (0..halves).for_each(|half| stars.starts[self.start(half) as usize + 1] += 1);
        for i in 1..stars.starts.len() {
            stars.starts[i] += stars.starts[i - 1];
        }
        let mut next = stars.starts.clone();
        for half in 0..halves {
            let at = &mut next[self.start(half) as usize];
            stars.halves[*at as usize] = half;
            *at += 1;
        }
        for (i, &o) in self.hot.iter().enumerate() {
            let star = &mut stars.halves[stars.starts[i] as usize..stars.starts[i + 1] as usize];
            star.sort_unstable_by(|&g, &h| {
                let (a, b) = (self.at(self.start(g ^ 1)), self.at(self.start(h ^ 1)));
                (a < o).cmp(&(b < o)).then_with(|| 0.cmp(&o.cross(a, b)))
            });
        }
        stars
    }

    /// The halves of a loop.
    fn each_of_loop(&self, first: u32) -> impl Iterator<Item = u32> + '_ {
        core::iter::successors(Some(first), move |&half| Some(self.next[half as usize]).filter(|&half| half != first))
    }

    /// The outer loop of each part that hangs together, but for the one with the tile's sides, and a loop of the face about it.
    fn islands(&self, stars: &Stars) -> Vec<(u32, u32)> {
        let mut islands = Vec::new();
        let mut parts = Groups::new(self.hot.len());
        self.edges.iter().for_each(|edge| parts.join(edge.u, edge.v));
        let home = parts.of(0);
        let mut is_seen = vec![false; self.hot.len()];
        is_seen[home as usize] = true;
        for (least, star) in (0..).zip(stars.iter()) {
            // All halves at the least vertex of a part run east of it or up: west and south of it lies what is about the part.
            let Some(&last) = star.last() else { continue };
            let part = parts.of(least);
            if core::mem::replace(&mut is_seen[part as usize], true) {
                continue;
            }
            if let Some(edge) = self.edge_below(self.at(least)) {
                islands.push((self.loops[last as usize], self.loops[2 * edge]));
            }
        }
        islands
    }

    /// The first edge that one meets when going down from a position.
    fn edge_below(&self, p: GridPos) -> Option<usize> {
        let is_below = |edge: &Edge| {
            let (a, b) = (self.at(edge.u), self.at(edge.v));
            a.0 <= p.0 && p.0 < b.0 && a.cross(b, p) > 0
        };
        let is_higher = |e: &Edge, f: &Edge| {
            let ((a, b), (c, d)) = ((self.at(e.u), self.at(e.v)), (self.at(f.u), self.at(f.v)));
            // Edges do not cross: the one that begins later decides, by its start or, if the other goes by it, its end.
            if a.0 >= c.0 && c.cross(d, a) != 0 {
                c.cross(d, a) > 0
            } else if c.0 >= a.0 && a.cross(b, c) != 0 {
                a.cross(b, c) < 0
            } else {
                a.cross(d, b) > 0
            }
        };
        let below = self.edges.iter().enumerate().filter(|(_, edge)| is_below(edge));
        below.reduce(|best, other| if is_higher(other.1, best.1) { other } else { best }).map(|(e, _)| e)
    }

    /// Finds the layer that covers each face from how often the layers wind about the one by the south-western corner; then
    /// gives small ones to their neighbours.
    pub(super) fn label(&mut self, below: Turns, kinds: &[u32], dust_m2: f64) {
        let count = self.begins.len();
        self.covers = vec![OUTSIDE; count];
        let mut islands: Vec<Vec<u32>> = vec![Vec::new(); count];
        for &(a, b) in &self.joined {
            islands[a as usize].push(b);
            islands[b as usize].push(a);
        }
        let Some(corner) = self.edges.iter().position(|e| e.is_side && e.u == 0 && self.at(e.v).0 == self.tile.lo.0) else {
            return;
        };
        let first = self.loops[2 * corner + 1];
        // What winds about the ground north of the corner's edges winds about this face.
        let mut base = below;
        for edge in self.edges.iter().filter(|e| !e.is_side && e.u == 0) {
            self.turns_of(edge).iter().for_each(|&(layer, by)| turn(&mut base, layer, by));
        }
        // Of all layers few come into the tile.
        let mut here: Vec<u32> = self.turns.iter().chain(&base).map(|turn| turn.0).collect();
        here.sort_unstable();
        here.dedup();
        let own_number = |layer: u32| here.binary_search(&layer).unwrap_or(0);
        let layers = here.len();
        let mut winding: Vec<i32> = vec![0; count * layers];
        base.iter().for_each(|&(layer, by)| winding[first as usize * layers + own_number(layer)] = by);
        let mut is_reached = vec![false; count];
        is_reached[first as usize] = true;
        let mut open = vec![first];
        while let Some(at) = open.pop() {
            let own = at as usize * layers;
            let top = winding[own..own + layers].iter().position(|&w| w != 0);
            self.covers[at as usize] = top.map_or(NONE, |top| here[top]);
            for half in self.each_of_loop(self.begins[at as usize]) {
                let edge = &self.edges[half as usize / 2];
                let there = self.loops[half as usize ^ 1];
                if edge.is_side || core::mem::replace(&mut is_reached[there as usize], true) {
                    continue;
                }
                winding.copy_within(own..own + layers, there as usize * layers);
                let sign = if half.is_multiple_of(2) { -1 } else { 1 };
                for &(layer, by) in self.turns_of(edge) {
                    winding[there as usize * layers + own_number(layer)] += sign * by;
                }
                open.push(there);
            }
            for &there in &islands[at as usize] {
                if !core::mem::replace(&mut is_reached[there as usize], true) {
                    winding.copy_within(own..own + layers, there as usize * layers);
                    open.push(there);
                }
            }
        }
        self.sweep(kinds, libm::round(dust_m2 * 2.0 * STEPS_A_METRE * STEPS_A_METRE) as i64);
    }

    fn turns_of(&self, edge: &Edge) -> &[(u32, i32)] {
        &self.turns[edge.turns.0 as usize..edge.turns.1 as usize]
    }

    /// Covers on the left and on the right of an edge.
    fn covers_of(&self, edge: usize) -> [u32; 2] {
        [2 * edge, 2 * edge + 1].map(|half| self.covers[self.loops[half] as usize])
    }

    /// Gives regions of one cover that are smaller than a size to neighbours: first to those of one kind, and what is still small then to the
    /// one with the longest common border.
    fn sweep(&mut self, kinds: &[u32], least_twice: i64) {
        self.sweep_alike(kinds, least_twice);
        let (mut regions, twice) = self.regions();
        let borders = self.borders(&mut regions, &twice, least_twice);
        let is_dust = |region: u32| twice[region as usize] < least_twice;
        let mut given: Vec<(u32, u32)> = Vec::new();
        for region in borders.chunk_by(|a, b| a.0 == b.0) {
            // To what is not dust itself, if it can be.
            let best =
                lengths(region).max_by(|a, b| (!is_dust(a.0)).cmp(&!is_dust(b.0)).then(a.1.total_cmp(&b.1)).then(b.0.cmp(&a.0)));
            given.extend(best.map(|(other, _)| (region[0].0, self.covers[other as usize])));
        }
        self.give(&mut regions, &given);
    }

    /// The same among those of one kind: where several small ones meet, they become one with the largest of them.
    fn sweep_alike(&mut self, kinds: &[u32], least_twice: i64) {
        let (mut regions, twice) = self.regions();
        let borders = self.borders(&mut regions, &twice, least_twice);
        let kind = |region: u32| kinds.get(self.covers[region as usize] as usize);
        let mut alike = Groups::new(self.begins.len());
        for region in borders.chunk_by(|a, b| a.0 == b.0) {
            let of_kind = lengths(region).filter(|&(other, _)| kind(other).is_some() && kind(other) == kind(region[0].0));
            let best = of_kind.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
            if let Some((other, _)) = best {
                alike.join(region[0].0, other);
            }
        }
        let mut small: Vec<(u32, u32)> = borders.iter().map(|border| border.0).map(|region| (alike.of(region), region)).collect();
        small.extend(borders.iter().map(|border| (alike.of(border.1), border.1)));
        small.sort_unstable();
        small.dedup();
        let mut given: Vec<(u32, u32)> = Vec::new();
        for group in small.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() > 1) {
            let largest = group.iter().max_by_key(|(_, region)| (twice[*region as usize], core::cmp::Reverse(*region)));
            given.extend(largest.into_iter().flat_map(|&(_, largest)| {
                group
                    .iter()
                    .map(move |&(_, region)| (region, largest))
                    .map(|(region, largest)| (region, self.covers[largest as usize]))
            }));
        }
        given.sort_unstable();
        self.give(&mut regions, &given);
    }

    /// Faces of one cover that hang together, and twice the area of each.
    fn regions(&self) -> (Groups, Vec<i64>) {
        let mut regions = Groups::new(self.begins.len());
        self.joined.iter().for_each(|&(a, b)| regions.join(a, b));
        for e in 0..self.edges.len() {
            let [left, right] = self.covers_of(e);
            if left == right {
                regions.join(self.loops[2 * e], self.loops[2 * e + 1]);
            }
        }
        let mut twice = vec![0_i64; self.begins.len()];
        for half in 0..self.next.len() as u32 {
            let (a, b) = self.ends(half);
            twice[regions.of(self.loops[half as usize]) as usize] += self.tile.lo.cross(a, b);
        }
        (regions, twice)
    }

    /// What small regions border on, edge by edge, by region; metres.
    fn borders(&self, regions: &mut Groups, twice: &[i64], least_twice: i64) -> Vec<(u32, u32, f64)> {
        let is_dust = |region: u32| self.covers[region as usize] != OUTSIDE && twice[region as usize] < least_twice;
        let mut borders: Vec<(u32, u32, f64)> = Vec::new();
        for e in 0..self.edges.len() {
            let both = [2 * e, 2 * e + 1].map(|half| regions.of(self.loops[half]));
            if both[0] != both[1] {
                let (a, b) = (self.at(self.edges[e].u), self.at(self.edges[e].v));
                let length = a.to_metres().distance(b.to_metres());
                for [own, other] in [both, [both[1], both[0]]] {
                    if is_dust(own) && self.covers[other as usize] != OUTSIDE {
                        borders.push((own, other, length));
                    }
                }
            }
        }
        borders.sort_by_key(|border| (border.0, border.1));
        borders
    }

    /// Gives regions other covers; ascending.
    fn give(&mut self, regions: &mut Groups, given: &[(u32, u32)]) {
        if given.is_empty() {
            return;
        }
        for number in 0..self.covers.len() {
            let region = regions.of(number as u32);
            if let Ok(i) = given.binary_search_by_key(&region, |g| g.0) {
                self.covers[number] = given[i].1;
            }
        }
    }

    /// Vertices on the tile's sides where a border within the tile ends.
    pub(super) fn ends_on_sides(&self) -> impl Iterator<Item = GridPos> + '_ {
        let borders = (0..self.edges.len()).filter(|&e| !self.edges[e].is_side && self.covers_of(e)[0] != self.covers_of(e)[1]);
        let ends = borders.flat_map(|e| [self.edges[e].u, self.edges[e].v]);
        ends.map(|v| self.at(v)).filter(|&p| self.tile.is_side(p))
    }

    /// The pieces of the tile, by layer. `ends`: vertices on sides that are to stay, those of neighbours among them.
    pub(super) fn pieces(&self, ends: &FxHashSet<GridPos>) -> Vec<Piece> {
        let mut borders: Vec<(u32, BorderEdge)> = Vec::new();
        // The ends of the borders at a vertex, as far as two.
        let mut meeting: Vec<(u8, [u32; 2])> = vec![(0, [0; 2]); self.hot.len()];
        for (e, edge) in self.edges.iter().enumerate() {
            let [left, right] = self.covers_of(e);
            if left == right {
                continue;
            }
            let (a, b) = (self.at(edge.u), self.at(edge.v));
            borders.extend([(left, (a, b)), (right, (b, a))].into_iter().filter(|border| border.0 != OUTSIDE));
            for (v, other) in [(edge.u, edge.v), (edge.v, edge.u)] {
                let (count, others) = &mut meeting[v as usize];
                if let Some(slot) = others.get_mut(usize::from(*count)) {
                    *slot = other;
                }
                *count = count.saturating_add(1);
            }
        }
        let is_idle = |p: GridPos| {
            let Ok(v) = self.hot.binary_search(&p) else { return false };
            let (count, [a, b]) = meeting[v];
            count == 2 && p.cross(self.at(a), self.at(b)) == 0 && !(self.tile.is_side(p) && ends.contains(&p))
        };
        borders.sort_by_key(|border| border.0);
        let mut pieces = Vec::new();
        for same in borders.chunk_by(|a, b| a.0 == b.0) {
            let layer = (same[0].0 < NONE).then_some(same[0].0);
            for mut outline in connected_faces(same.iter().map(|border| border.1).collect(), true) {
                outline.outer.retain(|&p| !is_idle(p));
                outline.holes.iter_mut().for_each(|hole| hole.retain(|&p| !is_idle(p)));
                outline.outer.shrink_to_fit();
                pieces.push(Piece { layer, outline });
            }
        }
        pieces
    }
}

/// The lengths of a region's borders with each neighbour.
fn lengths(region: &[(u32, u32, f64)]) -> impl Iterator<Item = (u32, f64)> {
    region.chunk_by(|a, b| a.1 == b.1).map(|same| (same[0].1, same.iter().map(|border| border.2).sum()))
}

/// For each hot point, the halves that begin there.
struct Stars {
    /// Of `halves`: where those of each point begin, and where the last one's end.
    starts: Vec<u32>,
    halves: Vec<u32>,
}

impl Stars {
    fn iter(&self) -> impl Iterator<Item = &[u32]> {
        self.starts.windows(2).map(|pair| &self.halves[pair[0] as usize..pair[1] as usize])
    }
}
