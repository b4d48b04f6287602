//! Embankments: how far the ground is raised so that bridges clear the ways under them.
//!
//! Maps tell that a way leads over another, not how high, and models of the ground are often too coarse to show what leads up to a bridge;
//! a level city has none. Each bridge is given the height that what passes below needs: by its own camber, as far as its length allows,
//! and by its ends, from which the ways lead down as steeply as their kind may.

use core::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap, HashMap, HashSet};

use glam::DVec2;
use veduta_city::{CityGraph, GridPos, Id, Link, LinkKind, StreetClass};

use super::band::{band, part, stations};
use super::bridges::{LEAST_M, aloft};
use super::chains::{Chain, chains};
use super::crossings::{Crossing, Map};
use super::index::Index;
use super::outline::distance_to_edge;
use super::streets::{along, length_m, width_at_m};

/// Room above what passes below, metres: railways, streets with carriageways, and other ways.
const CLEAR_M: [f64; 3] = [5.4, 4.6, 2.8];
/// From the carriageway of a bridge to its underside, metres: of those with carriageways or rails, and of others.
const DECK_M: [f64; 2] = [1.1, 0.6];
/// Steepest that ways lead up to bridges, a metre for each metre: railways, motorways, other streets, steps.
const GRADE: [f64; 4] = [0.025, 0.05, 0.07, 0.5];
/// Bridges rise by so many times that at their ends, and less and less from there.
const CAMBER: f64 = 1.5;
/// Nodes near what passes below are raised by so much for each metre to it at most, but for the ends of bridges.
const STEEPEST: f64 = 0.16;
/// … and that is looked for so far, metres.
const FAR_M: f64 = 120.0;
/// Less is not worth the work, and nothing is raised by more; metres.
const LEAST_RISE_M: f64 = 0.3;
const MOST_M: f64 = 30.0;
/// Where the ground under a bridge is higher than a straight line between its ends by more, no map means that the bridge leads over it.
const MOST_ABOVE_M: f64 = 3.0;
/// Bridges that end nearer to what they cross than this have no room for an abutment, metres.
const ABUTMENT_M: f64 = 1.0;
/// What they cross is looked at so far from there, metres.
const NEAR_M: f64 = 12.0;
/// Bridges over bridges over … are raised one after another, in so many rounds.
const ROUNDS: usize = 4;
/// Where trams lie on raised streets is told in pieces of this length, metres.
const PIECE_M: f64 = 8.0;

/// How far ways are raised above the ground.
#[derive(Default)]
pub(super) struct Earthworks {
    /// Of nodes.
    nodes: HashMap<Id, f64>,
    /// Links that are raised somewhere.
    links: HashMap<usize, Raised>,
    /// Links that are parts of bridges: which, whether they are gone along backwards, and where they begin along it, metres.
    of_link: HashMap<usize, (usize, bool, f64)>,
    decks: Vec<Deck>,
    /// Where streets on the ground are raised.
    bands: Option<Index<()>>,
}

/// A link that is raised.
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

/// What a map says is a bridge.
struct Deck {
    ends: [Id; 2],
    /// Height of the ground at its ends above the city's zero, metres.
    ground_m: [f64; 2],
    length_m: f64,
    /// How much higher it is in its middle than a straight line between its ends, and how much it may be, metres.
    camber_m: f64,
    most_m: f64,
    /// From its top to its underside, metres.
    thick_m: f64,
    crossings: Vec<Crossing>,
}

impl Deck {
    fn of(map: &Map<'_>, chain: &Chain, aloft: &HashSet<Id>) -> Option<Self> {
        let links = || chain.links.iter().filter_map(|&(link, _)| map.graph.links.get(link));
        let length_m = length_m(&chain.line);
        let ends = chain.ends(map.graph)?;
        let ground_m = [map.ground_m(*chain.line.first()?), map.ground_m(*chain.line.last()?)];
        // Steps on a bridge are stairs beside it more often than its slope.
        let grade = links().map(|link| grade(link).min(GRADE[2])).fold(GRADE[2], f64::min);
        let most_m = CAMBER * grade * length_m / 4.0;
        let thick_m = links().map(deck_m).fold(0.0, f64::max);
        let is_meant = |crossing: &Crossing| {
            let line = between(ground_m, crossing.upper_m / length_m);
            let lower = &map.graph.links[crossing.lower];
            let half_m = width_at_m(lower, crossing.lower_m / map.length_m(crossing.lower).max(1e-9)) / 2.0;
            // Where bridges part in the air there is no abutment. What passes below may lead to one farther on.
            let line_below = near(&map.line(crossing.lower), crossing.lower_m, half_m + NEAR_M);
            let far = |end: DVec2| {
                let pieces = line_below.windows(2).map(|pair| distance_to_edge(end, pair[0], pair[1]));
                pieces.fold(f64::INFINITY, f64::min)
            };
            let on_land = [chain.line.first(), chain.line.last()].into_iter().zip(ends).filter(|(_, node)| !aloft.contains(node));
            let from_ends_m = on_land.filter_map(|(p, _)| Some(far(*p?))).fold(f64::INFINITY, f64::min);
            from_ends_m > half_m + ABUTMENT_M && map.ground_m(crossing.pos) < line + MOST_ABOVE_M
        };
        let mut crossings = if length_m > LEAST_M { map.crossings(chain) } else { Vec::new() };
        // A way that winds over itself rises as its ends do, and never clears itself.
        crossings.retain(|crossing| is_meant(crossing) && chain.links.iter().all(|&(link, _)| link != crossing.lower));
        Some(Self { ends, ground_m, length_m, camber_m: 0.0, most_m, thick_m, crossings })
    }
}

/// The part of a line that is so near to a place along it.
fn near(line: &[DVec2], at_m: f64, reach_m: f64) -> Vec<DVec2> {
    let whole = length_m(line);
    let (from, to) = ((at_m - reach_m).max(0.0), (at_m + reach_m).min(whole));
    let mut gone = 0.0;
    let mut inside = Vec::new();
    for pair in line.windows(2) {
        gone += pair[0].distance(pair[1]);
        inside.extend((from < gone && gone < to).then_some(pair[1]));
    }
    let end = |s: f64| along(line, s.clamp(0.0, (whole - 1e-6).max(0.0))).map(|(p, _)| p);
    end(from).into_iter().chain(inside).chain(end(to)).collect()
}

fn between([from, to]: [f64; 2], share: f64) -> f64 {
    from + (to - from) * share
}

/// Share of its rise that a parabola has at a share of its length.
fn parabola(share: f64) -> f64 {
    4.0 * share * (1.0 - share)
}

impl Earthworks {
    pub fn of(graph: &CityGraph) -> Self {
        let chains = chains(graph, |link| link.layer > 0);
        if chains.is_empty() {
            return Self::default();
        }
        let (map, aloft) = (Map::of(graph), aloft(graph));
        let mut works = Self::default();
        for chain in &chains {
            let Some(deck) = Deck::of(&map, chain, &aloft) else { continue };
            let mut gone = 0.0;
            for &(link, is_back) in &chain.links {
                works.of_link.insert(link, (works.decks.len(), is_back, gone));
                gone += map.length_m(link);
            }
            works.decks.push(deck);
        }
        let mut below: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
        for crossing in works.decks.iter().flat_map(|deck| &deck.crossings) {
            if graph.links[crossing.lower].layer == 0 {
                below.entry(crossing.lower).or_default().push(crossing.lower_m);
            }
        }
        let limits = limits(&map, &below);
        // What is lifted first may lift what something else leads over.
        for _ in 0..ROUNDS {
            let lifted = (0..works.decks.len()).filter(|&deck| works.lift(&map, deck, (&below, &limits))).count();
            if lifted == 0 {
                break;
            }
        }
        works.finish(&map, &below);
        works
    }

    pub fn is_none(&self) -> bool {
        self.nodes.is_empty() && self.decks.iter().all(|deck| deck.camber_m <= 0.0)
    }

    /// How far a node is raised, metres.
    pub fn node_m(&self, node: Id) -> f64 {
        self.nodes.get(&node).copied().unwrap_or(0.0)
    }

    /// How far a link is raised at a share of its length, metres, if it lies on the ground.
    pub fn link_m(&self, link: usize, share: f64) -> f64 {
        self.links.get(&link).map_or(0.0, |raised| raised.at(share * raised.length_m))
    }

    /// How much higher the bridge that a link is part of has to be in its middle than a straight line between its ends, metres.
    pub fn camber_m(&self, link: usize) -> f64 {
        self.of_link.get(&link).map_or(0.0, |&(deck, ..)| self.decks[deck].camber_m)
    }

    /// Whether a place lies on a raised street.
    pub fn are_at(&self, p: DVec2) -> bool {
        self.bands.as_ref().is_some_and(|bands| bands.at(GridPos::from_metres(p)).next().is_some())
    }

    /// Heights of the ends of a bridge above the city's zero, metres.
    fn ends_m(&self, deck: &Deck) -> [f64; 2] {
        [0, 1].map(|end| deck.ground_m[end] + self.node_m(deck.ends[end]))
    }

    /// Lifts a bridge over what passes below, and the ways to it; whether it had to be.
    fn lift(&mut self, map: &Map<'_>, number: usize, (below, limits): (&BTreeMap<usize, Vec<f64>>, &HashMap<Id, f64>)) -> bool {
        let deck = &self.decks[number];
        let ends_m = self.ends_m(deck);
        let needed = |crossing: &Crossing| {
            let share = crossing.upper_m / deck.length_m;
            let clear = clear_m(&map.graph.links[crossing.lower]) + deck.thick_m;
            (share, self.below_m(map, crossing) + clear - between(ends_m, share))
        };
        let needed: Vec<(f64, f64)> = deck.crossings.iter().map(needed).collect();
        let missing = |camber: f64| needed.iter().map(|(share, short)| short - camber * parabola(*share)).fold(0.0, f64::max);
        if missing(deck.camber_m) < LEAST_RISE_M {
            return false;
        }
        // No more camber than is missing without: what is near the ends is left to them.
        let most = deck.most_m.min(missing(0.0));
        let by_camber = needed.iter().map(|(share, short)| short / parabola(*share).max(0.25)).fold(0.0, f64::max);
        let camber = deck.camber_m.max(by_camber.min(most));
        let lift = missing(camber);
        let ends = deck.ends.map(|node| (node, (self.node_m(node) + lift).min(MOST_M)));
        self.decks[number].camber_m = camber;
        self.spread(map, ends, (below, limits));
        true
    }

    /// Height above the city's zero of what a bridge leads over, metres.
    fn below_m(&self, map: &Map<'_>, crossing: &Crossing) -> f64 {
        let Some(&(deck, is_back, from)) = self.of_link.get(&crossing.lower) else { return map.ground_m(crossing.pos) };
        let deck = &self.decks[deck];
        let along = if is_back { map.length_m(crossing.lower) - crossing.lower_m } else { crossing.lower_m };
        let share = ((from + along) / deck.length_m).clamp(0.0, 1.0);
        let height =
            between(self.ends_m(deck), share) + deck.camber_m.max(super::bridges::camber_m(deck.length_m)) * parabola(share);
        height.max(map.ground_m(crossing.pos))
    }

    /// Raises nodes, and those about them as much as the ways between them ask for.
    fn spread(&mut self, map: &Map<'_>, from: [(Id, f64); 2], (below, limits): (&BTreeMap<usize, Vec<f64>>, &HashMap<Id, f64>)) {
        let mut heap: BinaryHeap<(Millimetres, Id)> = from.into_iter().map(|(node, rise)| (Millimetres::of(rise), node)).collect();
        while let Some((rise, node)) = heap.pop() {
            let rise = rise.to_metres();
            if rise <= self.node_m(node) + 1e-3 {
                continue;
            }
            self.nodes.insert(node, rise);
            for &(link, other) in map.around(node).iter().filter(|(link, _)| !below.contains_key(link)) {
                let limit = limits.get(&other).map_or(f64::INFINITY, |far| far * STEEPEST);
                let there = (rise - grade(&map.graph.links[link]) * map.length_m(link)).min(limit);
                if there > LEAST_RISE_M && there > self.node_m(other) {
                    heap.push((Millimetres::of(there), other));
                }
            }
        }
    }

    fn finish(&mut self, map: &Map<'_>, below: &BTreeMap<usize, Vec<f64>>) {
        let mut bands = Vec::new();
        for (i, link) in map.ways() {
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
            let raised = Raised { length_m, grade: grade(link), fixed };
            if link.layer == 0 && matches!(link.kind, LinkKind::Street(_)) {
                let stations = stations(&map.line(i), link);
                let count = (length_m / PIECE_M).ceil().max(1.0) as u32;
                let share = |k: u32| f64::from(k) / f64::from(count);
                let is_raised = |k: &u32| raised.at(share(*k) * length_m) > 0.0 || raised.at(share(k + 1) * length_m) > 0.0;
                let pieces = (0..count).filter(is_raised).map(|k| part(&stations, share(k)..share(k + 1)));
                bands.extend(pieces.filter_map(|piece| band(&piece, |share| width_at_m(link, share) / 2.0)));
            }
            self.links.insert(i, raised);
        }
        self.bands = Some(Index::new(bands.into_iter().map(|band| (band, ())).collect()));
    }
}

/// How far it is along the ways from nodes to what a bridge leads over, metres, where that is near.
fn limits(map: &Map<'_>, below: &BTreeMap<usize, Vec<f64>>) -> HashMap<Id, f64> {
    let mut heap: BinaryHeap<Reverse<(Millimetres, Id)>> = BinaryHeap::new();
    for (&link, places) in below {
        let (Link { from, to, .. }, length) = (&map.graph.links[link], map.length_m(link));
        for s in places {
            heap.extend([(*s, *from), (length - s, *to)].map(|(far, node)| Reverse((Millimetres::of(far), node))));
        }
    }
    let mut out = HashMap::new();
    while let Some(Reverse((far, node))) = heap.pop() {
        let far = far.to_metres();
        if far > FAR_M || out.contains_key(&node) {
            continue;
        }
        out.insert(node, far);
        heap.extend(map.around(node).iter().map(|&(link, other)| Reverse((Millimetres::of(far + map.length_m(link)), other))));
    }
    out
}

/// A height or distance that can be put in order.
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
