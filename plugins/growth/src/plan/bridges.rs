//! Which streets and railways leave the ground, where, and how high they lie there.
//!
//! Links that go on in one another make a way. It leaves the ground where that falls away under all of its breadth: over water that
//! lies deep enough below its banks, and, where a map says that there is a bridge, over valleys and what it is raised over.

use core::ops::Range;
use std::collections::{BTreeMap, HashMap, HashSet};

use glam::DVec2;
use veduta_city::{CityGraph, GridPos, Id, Link, LinkKind, Terrain};

use super::chains::{Chain, chains, is_street, is_way, line_of};
use super::earthworks::Earthworks;
use super::streets::{along, length_m, width_at_m};
use super::water::Waters;

/// Nearer to the end of a way than this is on it; lengths are as exact as that, metres.
const WITHIN_M: f64 = 1e-6;
/// A way leaves the ground only where that lies so far below; metres.
pub(super) const CLEAR_M: f64 = 0.75;
/// … and over at least so much of its length.
pub(super) const LEAST_M: f64 = 4.0;
/// Where bridges meet so high, there is no ground under them; metres.
const ALOFT_M: f64 = 2.5;
/// The ground is looked at so often along a way.
const STEP_M: f64 = 0.5;
/// Where water is sought that no map says is bridged.
const SOUNDING_M: f64 = 2.0;
/// The ground beside water is that so far from it.
const BANK_M: f64 = 2.0;
/// Bridges rise towards their middle by this share of their length, and at most so much; metres.
const CAMBER: (f64, f64) = (0.018, 1.6);
/// Bridges bend by less than the angle with this cosine.
const SHARP: f64 = 0.6;
/// A stretch lies on another's bridge where that is so at steps of the first, metres, for the second of its length.
const SAMPLE_M: f64 = 1.0;
const CARRIED: f64 = 0.6;
/// … and goes along with it: cosine of the angle between them.
const ALONG: f64 = 0.9;
/// … in the middle about as high: bridges rise by up to that; metres.
const STEP_UP_M: f64 = 1.8;
/// What stands beside a way reaches so far, and a bridge begins so far beyond a sharp bend; metres.
const BESIDE_M: f64 = 0.8;
const PAST_BEND_M: f64 = 0.5;
/// The ground goes on under the ends of a bridge: as far as that it is level across, on a terrain with its posts.
const OVERLAP_M: f64 = 0.5;
const OVERLAP_ON_TERRAIN_M: f64 = 6.0;

/// A way along links that go on in one another, and where it is off the ground.
pub(super) struct Way {
    /// Indices of the graph's links, whether each is gone along backwards, and where on the way it begins, metres.
    pub links: Vec<(usize, bool, f64)>,
    pub line: Vec<DVec2>,
    pub length_m: f64,
    pub stretches: Vec<Stretch>,
    /// Of a way that a map says is a bridge from end to end.
    deck: Option<Profile>,
}

/// Heights along a bridge.
struct Profile {
    length_m: f64,
    /// Metres above the city's zero.
    ends_m: (f64, f64),
    /// How much higher it is in the middle than a straight line between them.
    camber_m: f64,
    /// Whether its ends are in the air, where other bridges begin.
    is_aloft: [bool; 2],
}

impl Profile {
    fn height_m(&self, s: f64) -> f64 {
        let share = (s / self.length_m.max(1e-9)).clamp(0.0, 1.0);
        self.ends_m.0 + (self.ends_m.1 - self.ends_m.0) * share + self.camber_m * 4.0 * share * (1.0 - share)
    }
}

/// A part of a way that is off the ground.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stretch {
    /// Along the way, metres.
    pub range: Range<f64>,
    /// Heights of its ends above the city's zero, metres.
    pub ends_m: (f64, f64),
    /// How much higher it is in the middle than a straight line between them.
    pub camber_m: f64,
    /// Highest ground or water below, above the city's zero.
    pub below_m: f64,
    /// Share of it that leads over water.
    pub water: f64,
    /// Whether a wider way's bridge carries it.
    pub is_carried: bool,
    /// How far the ground goes on under its ends; not at all under those that are in the air.
    overlap_m: [f64; 2],
}

impl Stretch {
    /// One below the ground, which goes on over its ends so far.
    pub fn below(range: Range<f64>, ends_m: (f64, f64), overlap_m: [f64; 2]) -> Self {
        let below_m = ends_m.0.min(ends_m.1);
        Self { range, ends_m, camber_m: 0.0, below_m, water: 0.0, is_carried: false, overlap_m }
    }

    /// Height at a distance along the way, metres above the city's zero.
    pub fn height_m(&self, s: f64) -> f64 {
        let share = ((s - self.range.start) / (self.range.end - self.range.start)).clamp(0.0, 1.0);
        self.ends_m.0 + (self.ends_m.1 - self.ends_m.0) * share + self.camber_m * 4.0 * share * (1.0 - share)
    }

    /// How far along the way its middle is, metres.
    pub fn middle(&self) -> f64 {
        (self.range.start + self.range.end) / 2.0
    }

    /// Height of the way's ground at a distance along the way, which goes on under its ends and never above it.
    fn ground_m(&self, s: f64) -> f64 {
        let end_m = if s < self.middle() { self.ends_m.0 } else { self.ends_m.1 };
        self.height_m(s).min(end_m)
    }

    /// What of it has no ground of the way's under it.
    fn hollow(&self) -> Range<f64> {
        self.range.start + self.overlap_m[0]..self.range.end - self.overlap_m[1]
    }

    /// Whether its ends are in the air, where other bridges begin.
    pub fn is_aloft(&self) -> [bool; 2] {
        self.overlap_m.map(|overlap| overlap <= 0.0)
    }
}

impl Way {
    /// A way on the ground.
    pub fn of(graph: &CityGraph, at: &HashMap<Id, DVec2>, chain: Chain) -> Self {
        let mut gone = 0.0;
        let start = |&(link, is_back): &(usize, bool)| {
            let from = gone;
            gone += line_of(graph, at, &graph.links[link]).map_or(0.0, |line| length_m(&line));
            (link, is_back, from)
        };
        let links = chain.links.iter().map(start).collect();
        Self { length_m: length_m(&chain.line), links, line: chain.line, stretches: Vec::new(), deck: None }
    }

    /// Which link is at a distance along the way, and the share of that link's own length there.
    pub fn link_at(&self, s: f64) -> Option<(usize, f64)> {
        let i = self.links.partition_point(|(_, _, from)| *from <= s).checked_sub(1)?;
        let (link, is_back, from) = self.links[i];
        let to = self.links.get(i + 1).map_or(self.length_m, |next| next.2);
        let share = ((s - from) / (to - from).max(1e-9)).clamp(0.0, 1.0);
        Some((link, if is_back { 1.0 - share } else { share }))
    }

    /// The place at a distance along it, and the direction there: within its ends.
    pub fn at(&self, s: f64) -> Option<(DVec2, DVec2)> {
        along(&self.line, s.clamp(0.0, self.length_m - WITHIN_M))
    }

    /// Half its width at a distance along it, metres.
    pub fn half_m(&self, graph: &CityGraph, s: f64) -> f64 {
        self.link_at(s).and_then(|(link, share)| Some(width_at_m(graph.links.get(link)?, share) / 2.0)).unwrap_or_default()
    }

    /// Where the height of the way's ground is not that of the terrain, that height; metres above the city's zero.
    fn ground_m(&self, s: f64) -> Option<f64> {
        let stretch = self.stretches.iter().find(|stretch| stretch.range.contains(&s));
        stretch.map(|stretch| stretch.ground_m(s)).or_else(|| self.deck.as_ref().map(|deck| deck.height_m(s)))
    }
}

/// The ways that leave the ground somewhere.
#[derive(Default)]
pub(super) struct Bridges {
    pub ways: Vec<Way>,
    /// Of each link that belongs to one: which, whether backwards, and where it begins and ends on it.
    of_link: HashMap<usize, (usize, bool, Range<f64>)>,
}

impl Bridges {
    pub fn of(graph: &CityGraph, waters: &Waters, works: &Earthworks) -> Self {
        let site = Site { graph, at: graph.node_positions(), waters, works, terrain: graph.terrain.as_ref(), aloft: aloft(graph) };
        let mut bridges = Self::default();
        for chain in chains(graph, |link| site.may_fly(link)) {
            bridges.ways.extend(site.way(chain));
        }
        bridges.carry(graph);
        (0..bridges.ways.len()).for_each(|way| bridges.number(way));
        bridges
    }

    /// Adds ways that leave the ground, of links that belong to none yet.
    pub fn add(&mut self, ways: Vec<Way>) {
        let first = self.ways.len();
        self.ways.extend(ways);
        (first..self.ways.len()).for_each(|way| self.number(way));
    }

    fn number(&mut self, number: usize) {
        let way = &self.ways[number];
        for (i, &(link, is_back, from)) in way.links.iter().enumerate() {
            let to = way.links.get(i + 1).map_or(way.length_m, |next| next.2);
            self.of_link.insert(link, (number, is_back, from..to));
        }
    }

    /// Whether a link belongs to a way that leaves the ground.
    pub fn has(&self, link: usize) -> bool {
        self.of_link.contains_key(&link)
    }

    /// Finds which stretches lie on the bridges of wider ways, as footways do beside carriageways. What of such a stretch does not is
    /// left to the ground.
    fn carry(&mut self, graph: &CityGraph) {
        let mut order: Vec<(usize, usize)> =
            (0..self.ways.len()).flat_map(|w| (0..self.ways[w].stretches.len()).map(move |i| (w, i))).collect();
        let width = |&(w, i): &(usize, usize)| self.ways[w].half_m(graph, self.ways[w].stretches[i].middle());
        order.sort_by(|a, b| width(b).total_cmp(&width(a)));
        let mut own: Vec<(usize, Deck)> = Vec::new();
        let mut carried: BTreeMap<(usize, usize), Vec<Range<f64>>> = BTreeMap::new();
        for (w, i) in order {
            let (way, stretch) = (&self.ways[w], &self.ways[w].stretches[i]);
            let range = &stretch.range;
            let height_m = stretch.height_m(stretch.middle());
            let is_level_with = |deck: &Deck| (deck.height_m - height_m).abs() < STEP_UP_M;
            let count = ((range.end - range.start) / SAMPLE_M).ceil().max(1.0) as usize;
            let place = |k: usize| range.start + (range.end - range.start) * k as f64 / count as f64;
            let is_carried =
                |(p, along)| own.iter().any(|(other, deck)| *other != w && is_level_with(deck) && deck.carries(p, along));
            let is_on = |k: usize| way.at(place(k)).is_some_and(is_carried);
            let on: Vec<bool> = (0..=count).map(is_on).collect();
            let share = on.iter().filter(|on| **on).count() as f64 / on.len() as f64;
            if share < CARRIED {
                let halves = (0..=8).map(|k| way.half_m(graph, range.start + (range.end - range.start) * f64::from(k) / 8.0));
                own.push((w, Deck::of(way, stretch, height_m, halves.fold(f64::INFINITY, f64::min) + BESIDE_M)));
                continue;
            }
            let mut first = 0;
            for run in on.chunk_by(|a, b| a == b) {
                let part = place(first)..place(first + run.len() - 1);
                first += run.len();
                if run[0] && part.end > part.start {
                    carried.entry((w, i)).or_default().push(part);
                }
            }
        }
        for (w, way) in self.ways.iter_mut().enumerate() {
            let parts = |(i, stretch): (usize, Stretch)| match carried.get(&(w, i)) {
                None => vec![stretch],
                Some(parts) => {
                    let part = |range: &Range<f64>| {
                        let ends_m = (stretch.height_m(range.start), stretch.height_m(range.end));
                        Stretch {
                            range: range.clone(),
                            ends_m,
                            camber_m: 0.0,
                            is_carried: true,
                            overlap_m: [0.0; 2],
                            ..stretch.clone()
                        }
                    };
                    parts.iter().map(part).collect()
                }
            };
            way.stretches = core::mem::take(&mut way.stretches).into_iter().enumerate().flat_map(parts).collect();
        }
    }

    /// The parts of a link that lie on the ground, as shares of its length. Where it is a bridge the ground goes on for a little.
    pub fn on_ground(&self, link: usize) -> Vec<Range<f64>> {
        let Some((way, is_back, range)) = self.of_link.get(&link) else { return vec![0.0..1.0] };
        let length = (range.end - range.start).max(1e-9);
        let (mut parts, mut from) = (Vec::new(), range.start);
        for hollow in self.ways[*way].stretches.iter().map(Stretch::hollow) {
            if hollow.end > range.start && hollow.start < range.end {
                parts.push(from..hollow.start);
                from = hollow.end;
            }
        }
        parts.push(from..range.end);
        parts.retain(|part| part.end - part.start > 1e-6);
        let share = |s: f64| ((s - range.start) / length).clamp(0.0, 1.0);
        let turned = |part: Range<f64>| {
            let (from, to) = (share(part.start), share(part.end));
            if *is_back { 1.0 - to..1.0 - from } else { from..to }
        };
        let mut parts: Vec<Range<f64>> = parts.into_iter().map(turned).collect();
        if *is_back {
            parts.reverse();
        }
        parts
    }

    /// Where the ground of a link at a share of its length is not as high as the terrain, how high; metres above the city's zero.
    pub fn ground_m(&self, link: usize, share: f64) -> Option<f64> {
        let (way, is_back, range) = self.of_link.get(&link)?;
        let share = if *is_back { 1.0 - share } else { share };
        self.ways[*way].ground_m(range.start + (range.end - range.start) * share)
    }

    /// Whether a link is part of what a map says is a bridge, and leaves the ground somewhere.
    pub fn is_bridge(&self, link: usize) -> bool {
        self.of_link.get(&link).is_some_and(|(way, ..)| self.ways[*way].deck.is_some())
    }

    /// Of a link's ground at a share of its length that lies under a bridge's end: whether it is there for that alone, not where the bridge
    /// goes on from a part of it that is near the ground. `None` elsewhere.
    pub fn is_under_end(&self, link: usize, share: f64) -> Option<bool> {
        let (way, is_back, range) = self.of_link.get(&link)?;
        let way = &self.ways[*way];
        way.deck.as_ref()?;
        let share = if *is_back { 1.0 - share } else { share };
        let s = range.start + (range.end - range.start) * share;
        let stretch = way.stretches.iter().find(|stretch| stretch.range.contains(&s))?;
        let nearest_m = if s < stretch.middle() { stretch.range.start } else { way.length_m - stretch.range.end };
        Some(nearest_m < WITHIN_M)
    }
}

/// The plan of a bridge: what lies so near to its middle line.
struct Deck {
    /// How high it is in its middle, metres above the city's zero.
    height_m: f64,
    line: Vec<DVec2>,
    low: DVec2,
    high: DVec2,
    reach_m: f64,
}

impl Deck {
    fn of(way: &Way, Stretch { range, .. }: &Stretch, height_m: f64, reach_m: f64) -> Self {
        let ends = [range.start, range.end].map(|s| way.at(s).map(|(p, _)| p));
        let is_inside = |s: f64| range.start + 1e-3 < s && s < range.end - 1e-3;
        let inside = (1..way.line.len()).filter(|&i| is_inside(length_m(&way.line[..=i]))).map(|i| way.line[i]);
        let line: Vec<DVec2> = ends[0].into_iter().chain(inside).chain(ends[1]).collect();
        let (low, high) = line.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
        Self { height_m, line, low: low - reach_m, high: high + reach_m, reach_m }
    }

    /// Whether a place lies on it, beside its line, not beyond its ends, and a way goes along with it there.
    fn carries(&self, p: DVec2, along: DVec2) -> bool {
        let last = self.line.len().saturating_sub(2);
        let is_beside = |(i, pair): (usize, &[DVec2])| {
            let way = pair[1] - pair[0];
            let share = (p - pair[0]).dot(way) / way.length_squared().max(1e-12);
            let is_beyond = (i == 0 && share < 0.0) || (i == last && share > 1.0);
            let is_along = way.dot(along).abs() > ALONG * way.length();
            is_along && !is_beyond && p.distance(pair[0] + way * share.clamp(0.0, 1.0)) < self.reach_m
        };
        self.low.cmple(p).all() && p.cmple(self.high).all() && self.line.windows(2).enumerate().any(is_beside)
    }
}

struct Site<'a> {
    graph: &'a CityGraph,
    at: HashMap<Id, DVec2>,
    waters: &'a Waters,
    works: &'a Earthworks,
    terrain: Option<&'a Terrain>,
    /// Nodes at which bridges meet, and nothing on the ground.
    aloft: HashSet<Id>,
}

/// Nodes at which two or more bridges end, and nothing on the ground.
pub(super) fn aloft(graph: &CityGraph) -> HashSet<Id> {
    let mut ways: HashMap<Id, (u32, bool)> = HashMap::new();
    for link in graph.links.iter().filter(|link| link.layer > 0 && link.kind != LinkKind::Watercourse) {
        for node in [link.from, link.to] {
            ways.entry(node).or_insert((0, true)).0 += 1;
        }
    }
    if !ways.is_empty() {
        for link in graph.links.iter().filter(|link| link.layer <= 0) {
            for node in [link.from, link.to] {
                ways.entry(node).and_modify(|(_, is_aloft)| *is_aloft = false);
            }
        }
    }
    ways.into_iter().filter(|(_, (count, is_aloft))| *is_aloft && *count > 1).map(|(node, _)| node).collect()
}

/// How much higher a street's bridge of a length is in its middle than at its ends, metres.
pub(super) fn camber_m(length_m: f64) -> f64 {
    (length_m * CAMBER.0).min(CAMBER.1)
}

impl Site<'_> {
    fn ground_m(&self, p: DVec2) -> f64 {
        self.terrain.map_or(0.0, |terrain| terrain.height_m(p))
    }

    fn depth_m(&self, p: DVec2) -> Option<f64> {
        self.waters.depth_m(GridPos::from_metres(p))
    }

    fn may_fly(&self, link: &Link) -> bool {
        if !is_way(link) || link.layer < 0 || (link.layer == 0 && self.waters.is_none()) {
            return false;
        }
        let Some(line) = line_of(self.graph, &self.at, link) else { return false };
        let length = length_m(&line);
        let count = (length / SOUNDING_M).ceil().max(1.0) as u32;
        let sounding = |i: u32| along(&line, length * f64::from(i) / f64::from(count));
        link.layer > 0 || (0..=count).filter_map(sounding).any(|(p, _)| self.depth_m(p).is_some())
    }

    fn way(&self, chain: Chain) -> Option<Way> {
        let &(first, _) = chain.links.first()?;
        let length_m = length_m(&chain.line);
        let deck = (self.graph.links[first].layer > 0).then(|| {
            let ends = chain.ends(self.graph)?;
            let [from, to] = [(ends[0], chain.line.first()?), (ends[1], chain.line.last()?)]
                .map(|(node, &p)| self.ground_m(p) + self.works.node_m(node));
            let is_aloft = [(ends[0], from, chain.line.first()?), (ends[1], to, chain.line.last()?)]
                .map(|(node, height, &p)| self.aloft.contains(&node) && height - self.below_m(p) > ALOFT_M);
            Some(Profile { length_m, ends_m: (from, to), camber_m: self.works.camber_m(first), is_aloft })
        });
        let mut way = Way { deck: deck.flatten(), ..Way::of(self.graph, &self.at, chain) };
        way.stretches = self.stretches(&way);
        (!way.stretches.is_empty()).then_some(way)
    }

    /// Where a way is off the ground.
    fn stretches(&self, way: &Way) -> Vec<Stretch> {
        let count = (way.length_m / STEP_M).ceil().max(1.0) as usize;
        let place = |i: usize| way.length_m * i as f64 / count as f64;
        let across = |s: f64| {
            let (p, along) = way.at(s)?;
            let off = along.perp() * way.half_m(self.graph, s);
            Some([p - off, p, p + off])
        };
        let is_clear = |s: f64| {
            let Some(places) = across(s) else { return false };
            match &way.deck {
                None => places.iter().all(|&p| self.depth_m(p).is_some()),
                Some(deck) => places.iter().all(|&p| deck.height_m(s) - self.below_m(p) >= CLEAR_M),
            }
        };
        let clear: Vec<bool> = (0..=count).map(|i| is_clear(place(i))).collect();
        let mut first = 0;
        let mut out = Vec::new();
        for run in clear.chunk_by(|a, b| a == b) {
            let range = place(first)..place(first + run.len() - 1);
            first += run.len();
            let parts = if run[0] { self.clear_of_bends(way, range) } else { Vec::new() };
            for part in parts.into_iter().filter(|part| part.end - part.start >= LEAST_M) {
                out.extend(self.stretch(way, part, &across));
            }
        }
        out
    }

    /// The parts of a stretch without sharp bends, nor any so near their ends that the way's sides would cross there: those are left to
    /// the ground.
    fn clear_of_bends(&self, way: &Way, range: Range<f64>) -> Vec<Range<f64>> {
        let mut parts = vec![range];
        let mut gone = 0.0;
        for i in 1..way.line.len() - 1 {
            let (a, b, c) = (way.line[i - 1], way.line[i], way.line[i + 1]);
            gone += a.distance(b);
            let (before, after) = ((b - a).normalize_or_zero(), (c - b).normalize_or_zero());
            // Of half the angle.
            let tangent = before.perp_dot(after).abs() / (1.0 + before.dot(after)).max(0.2);
            let reach = (way.half_m(self.graph, gone) + BESIDE_M) * tangent + PAST_BEND_M;
            let (from, to) = (gone - reach, gone + reach);
            if before.dot(after) < SHARP {
                // The last part is the one that the bend may lie in.
                let last = parts.pop().unwrap_or_default();
                parts.extend([last.start..last.end.min(from), last.start.max(to)..last.end]);
                continue;
            }
            let Some(last) = parts.last_mut() else { break };
            if last.start < gone && from < last.start {
                last.start = gone + PAST_BEND_M;
            } else if gone < last.end && last.end < to {
                last.end = gone - PAST_BEND_M;
            }
        }
        parts
    }

    /// The ground or water at a place, metres above the city's zero.
    fn below_m(&self, p: DVec2) -> f64 {
        self.ground_m(p) - self.depth_m(p).unwrap_or(0.0)
    }

    fn stretch(&self, way: &Way, range: Range<f64>, across: &dyn Fn(f64) -> Option<[DVec2; 3]>) -> Option<Stretch> {
        let length = range.end - range.start;
        let bank = |s: f64| {
            let s = s.clamp(0.0, way.length_m);
            let raised = way.link_at(s).map_or(0.0, |(link, share)| self.works.link_m(link, share));
            across(s).map(|[_, p, _]| self.ground_m(p) + raised)
        };
        let ends_m = match &way.deck {
            Some(deck) => (deck.height_m(range.start), deck.height_m(range.end)),
            None => (bank(range.start - BANK_M)?, bank(range.end + BANK_M)?),
        };
        let count = (length / SOUNDING_M).ceil().max(2.0) as u32;
        let soundings = (0..=count).filter_map(|i| across(range.start + length * f64::from(i) / f64::from(count)));
        let (mut below_m, mut wet, mut all) = (f64::NEG_INFINITY, 0_u32, 0_u32);
        for p in soundings.flatten() {
            (below_m, wet, all) = (below_m.max(self.below_m(p)), wet + u32::from(self.depth_m(p).is_some()), all + 1);
        }
        // Of bridges it has been looked at everywhere.
        if way.deck.is_none() && ends_m.0.min(ends_m.1) - below_m < CLEAR_M {
            return None;
        }
        let is_street = way.links.first().and_then(|link| self.graph.links.get(link.0)).is_some_and(is_street);
        // A part of a parabola is one.
        let given = way.deck.as_ref().map_or(0.0, |deck| deck.camber_m * (length / way.length_m) * (length / way.length_m));
        let own = if is_street { camber_m(length) } else { 0.0 };
        let camber_m = own.max(given);
        let overlap_m = if self.terrain.is_some() || !self.works.is_none() { OVERLAP_ON_TERRAIN_M } else { OVERLAP_M };
        let water = f64::from(wet) / f64::from(all.max(1));
        let is_aloft = way.deck.as_ref().map_or([false; 2], |deck| deck.is_aloft);
        let is_end = [range.start < WITHIN_M, way.length_m - range.end < WITHIN_M];
        let overlap_m = [0, 1].map(|end| if is_aloft[end] && is_end[end] { 0.0 } else { overlap_m.min(length / 3.0) });
        Some(Stretch { range, ends_m, camber_m, below_m, water, is_carried: false, overlap_m })
    }
}
