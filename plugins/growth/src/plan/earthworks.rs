//! Embankments: how far the ground is raised so that bridges clear the ways under them.
//!
//! Maps tell that a way leads over another, not how high, and models of the ground are often too coarse to show what leads up to a bridge;
//! a level city has none. Each bridge is given the height that what passes below needs: by its own camber, as far as its length allows,
//! and by its ends, from which the ways lead down as steeply as their kind may.

use std::collections::{BTreeMap, BinaryHeap, HashMap};

use glam::DVec2;
use veduta_city::{CityGraph, GridPolygon, GridPos, Id, Link, LinkKind, StreetClass, Terrain};

use super::band::{band_of, pieces, stations};
use super::bridges::{Chain, chains};
use super::index::Index;
use super::streets::{length_m, width_at_m};

/// Room above what passes below, metres: railways, streets with carriageways, and other ways.
const CLEAR_M: [f64; 3] = [5.4, 4.6, 2.8];
/// From the carriageway of a bridge to its underside, metres: of those with carriageways or rails, and of others.
const DECK_M: [f64; 2] = [1.1, 0.6];
/// Steepest that ways lead up to bridges, a metre for each metre: railways, motorways, other streets, steps.
const GRADE: [f64; 4] = [0.025, 0.05, 0.07, 0.5];
/// Bridges rise by so many times that at their ends, and less and less from there.
const CAMBER: f64 = 1.5;
/// Ways that pass below lead up from there no more steeply.
const STEEPEST: f64 = 0.16;
/// Nearer to a node that they share two links do not cross, metres.
const AT_NODE_M: f64 = 1.0;
/// Less is not worth the work, and nothing is raised by more; metres.
const LEAST_M: f64 = 0.3;
const MOST_M: f64 = 40.0;
/// Breadth of the strips in which crossings are sought, metres.
const STRIP_M: f64 = 0.1;

/// How far ways are raised above the ground.
#[derive(Default)]
pub(super) struct Earthworks {
    /// Of nodes.
    nodes: HashMap<Id, f64>,
    /// Links that are raised somewhere.
    links: HashMap<usize, Raised>,
    /// How much higher the bridge that a link is part of is in its middle than a straight line between its ends.
    cambers: HashMap<usize, f64>,
    /// Where the ground is raised.
    bands: Option<Index<()>>,
}

/// A raised link.
struct Raised {
    length_m: f64,
    grade: f64,
    /// Along it, metres, and how far it is raised there, in order: at its ends, and not where it passes below.
    fixed: Vec<(f64, f64)>,
}

impl Raised {
    fn at(&self, s: f64) -> f64 {
        let i = self.fixed.partition_point(|(at, _)| *at <= s).clamp(1, self.fixed.len() - 1);
        let ((from, low), (to, high)) = (self.fixed[i - 1], self.fixed[i]);
        let grade = self.grade.max((high - low).abs() / (to - from).max(1e-9));
        (low - grade * (s - from)).max(high - grade * (to - s)).max(0.0)
    }
}

/// Where a way crosses another in plan.
struct Crossing {
    /// Along the upper, metres.
    upper_m: f64,
    lower: usize,
    /// Along the lower, metres.
    lower_m: f64,
    pos: DVec2,
}

impl Earthworks {
    pub fn of(graph: &CityGraph) -> Self {
        let mut chains = chains(graph, |link| link.layer > 0);
        if chains.is_empty() {
            return Self::default();
        }
        chains.sort_by_key(|chain| chain.links.iter().map(|&(link, ..)| graph.links[link].layer).max());
        let map = Map::of(graph);
        let mut works = Self::default();
        let mut below: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
        let crossings: Vec<Vec<Crossing>> = chains.iter().map(|chain| map.crossings(chain)).collect();
        for crossing in crossings.iter().flatten().filter(|crossing| graph.links[crossing.lower].layer == 0) {
            below.entry(crossing.lower).or_default().push(crossing.lower_m);
        }
        for (chain, crossings) in chains.iter().zip(&crossings) {
            works.lift(&map, (chain, crossings), &below);
        }
        works.finish(&map, &below);
        works
    }

    pub fn is_none(&self) -> bool {
        self.nodes.is_empty() && self.cambers.is_empty()
    }

    /// How far a node is raised, metres.
    pub fn node_m(&self, node: Id) -> f64 {
        self.nodes.get(&node).copied().unwrap_or(0.0)
    }

    /// How far a link on the ground is raised at a share of its length, metres.
    pub fn link_m(&self, link: usize, share: f64) -> f64 {
        self.links.get(&link).map_or(0.0, |raised| raised.at(share * raised.length_m))
    }

    /// How much higher the bridge that a link is part of has to be in its middle than a straight line between its ends, metres.
    pub fn camber_m(&self, link: usize) -> f64 {
        self.cambers.get(&link).copied().unwrap_or(0.0)
    }

    /// Whether a place lies on a raised way.
    pub fn are_at(&self, p: DVec2) -> bool {
        self.bands.as_ref().is_some_and(|bands| bands.at(GridPos::from_metres(p)).next().is_some())
    }

    /// Lifts a bridge over what passes below, and the ways to it.
    fn lift(&mut self, map: &Map<'_>, (chain, crossings): (&Chain, &[Crossing]), below: &BTreeMap<usize, Vec<f64>>) {
        let Some(ends) = chain.ends(map.graph) else { return };
        let first = &map.graph.links[chain.links[0].0];
        let whole = length_m(&chain.line);
        let ground = ends.map(|node| map.at.get(&node).map_or(0.0, |p| map.ground_m(*p)) + self.node_m(node));
        let short = |crossing: &Crossing| {
            let lower = &map.graph.links[crossing.lower];
            let floor = map.ground_m(crossing.pos) + self.over_m(map, crossing);
            let line = ground[0] + (ground[1] - ground[0]) * crossing.upper_m / whole.max(1e-9);
            floor + clear_m(lower) + deck_m(first) - line
        };
        let short: Vec<(f64, f64)> =
            crossings.iter().map(|crossing| (crossing.upper_m / whole.max(1e-9), short(crossing))).collect();
        if short.iter().all(|(_, short)| *short < LEAST_M) {
            return;
        }
        // A parabola's ends slope by four times its rise over its span. No more of it than is missing: what is near the ends is left to them.
        let missing = short.iter().map(|(_, short)| *short).fold(0.0, f64::max);
        let most = missing.min(CAMBER * grade(first) * whole / 4.0);
        let needed = |(share, short): &(f64, f64)| short / (4.0 * share * (1.0 - share)).max(0.25);
        let camber = short.iter().map(needed).fold(0.0, f64::max).min(most);
        let lift = short.iter().map(|(share, short)| short - camber * 4.0 * share * (1.0 - share)).fold(0.0, f64::max).min(MOST_M);
        self.cambers.extend(chain.links.iter().map(|&(link, ..)| (link, camber)));
        if lift > 0.0 {
            self.spread(map, ends.map(|node| (node, self.node_m(node) + lift)), below);
        }
    }

    /// How far what passes below is itself raised.
    fn over_m(&self, map: &Map<'_>, crossing: &Crossing) -> f64 {
        let lower = &map.graph.links[crossing.lower];
        if lower.layer == 0 {
            return 0.0;
        }
        let share = (crossing.lower_m / map.length_m(crossing.lower).max(1e-9)).clamp(0.0, 1.0);
        let (from, to) = (self.node_m(lower.from), self.node_m(lower.to));
        from + (to - from) * share + self.camber_m(crossing.lower)
    }

    /// Raises nodes, and those about them as much as the ways between them ask for.
    fn spread(&mut self, map: &Map<'_>, from: [(Id, f64); 2], below: &BTreeMap<usize, Vec<f64>>) {
        let mut heap: BinaryHeap<(Millimetres, Id)> = from.into_iter().map(|(node, rise)| (Millimetres::of(rise), node)).collect();
        while let Some((rise, node)) = heap.pop() {
            let rise = rise.to_metres();
            if rise <= self.node_m(node) + 1e-3 {
                continue;
            }
            self.nodes.insert(node, rise);
            for &(link, other) in map.around.get(&node).into_iter().flatten() {
                let length = map.length_m(link);
                if !below.contains_key(&link) {
                    let near = map.nearest_below_m(other, below);
                    let there = (rise - grade(&map.graph.links[link]) * length).min(near * STEEPEST);
                    if there > LEAST_M && there > self.node_m(other) {
                        heap.push((Millimetres::of(there), other));
                    }
                }
            }
        }
    }

    fn finish(&mut self, map: &Map<'_>, below: &BTreeMap<usize, Vec<f64>>) {
        let graph = map.graph;
        let mut bands = Vec::new();
        for (i, link) in graph.links.iter().enumerate().filter(|(_, link)| link.layer >= 0 && is_way(link)) {
            let (from, to) = (self.node_m(link.from), self.node_m(link.to));
            if from <= 0.0 && to <= 0.0 {
                continue;
            }
            let length_m = map.length_m(i);
            let mut fixed: Vec<(f64, f64)> = below.get(&i).into_iter().flatten().map(|&s| (s, 0.0)).collect();
            fixed.retain(|(s, _)| 0.0 < *s && *s < length_m);
            fixed.sort_by(|a, b| a.0.total_cmp(&b.0));
            fixed.insert(0, (0.0, from));
            fixed.push((length_m, to));
            self.links.insert(i, Raised { length_m, grade: grade(link), fixed });
            let line = map.line(i);
            bands.extend(pieces(&stations(&line, link), |share| width_at_m(link, share) / 2.0));
        }
        self.bands = Some(Index::new(bands.into_iter().map(|band| (band, ())).collect()));
    }
}

/// A height that can be put in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Millimetres(i32);

impl Millimetres {
    fn of(metres: f64) -> Self {
        Self(libm::round(metres * 1000.0) as i32)
    }

    fn to_metres(self) -> f64 {
        f64::from(self.0) / 1000.0
    }
}

const fn is_way(link: &Link) -> bool {
    matches!(link.kind, LinkKind::Street(_) | LinkKind::Railway { tram: false })
}

fn grade(link: &Link) -> f64 {
    match link.kind {
        LinkKind::Railway { .. } => GRADE[0],
        LinkKind::Street(StreetClass::Motorway) => GRADE[1],
        LinkKind::Street(StreetClass::Steps) => GRADE[3],
        LinkKind::Street(_) | LinkKind::Watercourse => GRADE[2],
    }
}

fn clear_m(below: &Link) -> f64 {
    match below.kind {
        LinkKind::Railway { tram: false } => CLEAR_M[0],
        LinkKind::Street(class) if !class.has_carriageway() => CLEAR_M[2],
        _ => CLEAR_M[1],
    }
}

fn deck_m(link: &Link) -> f64 {
    match link.kind {
        LinkKind::Street(class) if !class.has_carriageway() => DECK_M[1],
        _ => DECK_M[0],
    }
}

/// A graph, ready for questions about ways that cross.
struct Map<'a> {
    graph: &'a CityGraph,
    terrain: Option<&'a Terrain>,
    at: HashMap<Id, DVec2>,
    /// Ways at nodes, and the nodes at their other ends.
    around: HashMap<Id, Vec<(usize, Id)>>,
    /// Straight pieces of links: the link, and how far along it they begin, metres.
    pieces: Index<(usize, f64, DVec2, DVec2)>,
}

impl<'a> Map<'a> {
    fn of(graph: &'a CityGraph) -> Self {
        let at = graph.node_positions();
        let mut around: HashMap<Id, Vec<(usize, Id)>> = HashMap::new();
        let mut pieces = Vec::new();
        for (i, link) in graph.links.iter().enumerate().filter(|(_, l)| l.layer >= 0 && l.kind != LinkKind::Watercourse) {
            if is_way(link) {
                around.entry(link.from).or_default().push((i, link.to));
                around.entry(link.to).or_default().push((i, link.from));
            }
            let line = graph.polyline(link, &at).unwrap_or_default();
            let mut gone = 0.0;
            for pair in line.windows(2) {
                let (a, b) = (pair[0], pair[1]);
                pieces.extend(strip(a, b).map(|strip| (strip, (i, gone, a, b))));
                gone += a.distance(b);
            }
        }
        Self { graph, terrain: graph.terrain.as_ref(), at, around, pieces: Index::new(pieces) }
    }

    fn ground_m(&self, p: DVec2) -> f64 {
        self.terrain.map_or(0.0, |terrain| terrain.height_m(p))
    }

    fn line(&self, link: usize) -> Vec<DVec2> {
        self.graph.polyline(&self.graph.links[link], &self.at).unwrap_or_default()
    }

    fn length_m(&self, link: usize) -> f64 {
        length_m(&self.line(link))
    }

    /// How far along the ways at a node what crosses them above is, the nearest; metres.
    fn nearest_below_m(&self, node: Id, below: &BTreeMap<usize, Vec<f64>>) -> f64 {
        let ways = self.around.get(&node).into_iter().flatten();
        let from_node = |&(link, other): &(usize, Id)| {
            let is_from = self.graph.links[link].from == node && other != node;
            let length = self.length_m(link);
            let near = below.get(&link).into_iter().flatten().map(move |&s| if is_from { s } else { length - s });
            near.fold(f64::INFINITY, f64::min)
        };
        ways.map(from_node).fold(f64::INFINITY, f64::min)
    }

    /// Where a chain leads over ways on lower layers, but for those under the ground.
    fn crossings(&self, chain: &Chain) -> Vec<Crossing> {
        let links = &self.graph.links;
        let mut out = Vec::new();
        let mut gone = 0.0;
        for &(link, is_back) in &chain.links {
            let upper = &links[link];
            let mut line = self.line(link);
            if is_back {
                line.reverse();
            }
            for pair in line.windows(2) {
                let (a, b) = (pair[0], pair[1]);
                let near = strip(a, b).map(|strip| self.pieces.near(&strip, 0.0)).unwrap_or_default();
                for (_, &(lower, from_m, c, d)) in near {
                    let other = &links[lower];
                    if other.layer >= upper.layer {
                        continue;
                    }
                    let Some((s, t)) = met((a, b), (c, d)) else { continue };
                    let pos = a.lerp(b, s);
                    let is_shared = |node: Id| [other.from, other.to].contains(&node) && self.at[&node].distance(pos) < AT_NODE_M;
                    if !is_shared(upper.from) && !is_shared(upper.to) {
                        let (upper_m, lower_m) = (gone + s * a.distance(b), from_m + t * c.distance(d));
                        out.push(Crossing { upper_m, lower, lower_m, pos });
                    }
                }
                gone += a.distance(b);
            }
        }
        out
    }
}

/// A narrow strip along a straight line.
fn strip(a: DVec2, b: DVec2) -> Option<GridPolygon> {
    band_of(&[a, b], STRIP_M / 2.0)
}

/// Where two straight lines cross, as shares of their lengths.
fn met((a, b): (DVec2, DVec2), (c, d): (DVec2, DVec2)) -> Option<(f64, f64)> {
    let (way, other) = (b - a, d - c);
    let turn = way.perp_dot(other);
    let (s, t) = ((c - a).perp_dot(other) / turn, (c - a).perp_dot(way) / turn);
    (turn.abs() > 1e-9 && (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t)).then_some((s, t))
}
