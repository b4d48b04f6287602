//! Where ways cross one another in plan without meeting.

use std::collections::HashMap;

use glam::DVec2;
use veduta_city::{CityGraph, GridPolygon, Id, Link, LinkKind, Terrain};

use super::band::band_of;
use super::chains::{Chain, is_way};
use super::index::Index;
use super::streets::length_m;

/// Nearer to a node that they share two links do not cross, metres.
const AT_NODE_M: f64 = 1.0;
/// Breadth of the strips in which crossings are sought, metres.
const STRIP_M: f64 = 0.1;

/// Where a way crosses another in plan.
pub(super) struct Crossing {
    /// Along the upper, metres.
    pub upper_m: f64,
    /// Index of the lower link.
    pub lower: usize,
    /// Along the lower, metres.
    pub lower_m: f64,
    pub pos: DVec2,
}

/// The streets and railways of a graph that are not under the ground, ready for questions about what crosses them and where they lead.
pub(super) struct Map<'a> {
    pub graph: &'a CityGraph,
    terrain: Option<&'a Terrain>,
    at: HashMap<Id, DVec2>,
    /// Of all links, metres.
    lengths: Vec<f64>,
    /// Ways at nodes, and the nodes at their other ends.
    around: HashMap<Id, Vec<(usize, Id)>>,
    /// Straight pieces of ways and trams: the link, how far along it they begin, metres, and their ends.
    pieces: Index<(usize, f64, DVec2, DVec2)>,
}

impl<'a> Map<'a> {
    pub fn of(graph: &'a CityGraph) -> Self {
        let at = graph.node_positions();
        let mut around: HashMap<Id, Vec<(usize, Id)>> = HashMap::new();
        let (mut lengths, mut pieces) = (Vec::new(), Vec::new());
        for (i, link) in graph.links.iter().enumerate() {
            let line = graph.polyline(link, &at).unwrap_or_default();
            lengths.push(length_m(&line));
            if link.layer < 0 || link.kind == LinkKind::Watercourse {
                continue;
            }
            if is_way(link) {
                around.entry(link.from).or_default().push((i, link.to));
                around.entry(link.to).or_default().push((i, link.from));
            }
            let mut gone = 0.0;
            for pair in line.windows(2) {
                let (a, b) = (pair[0], pair[1]);
                pieces.extend(strip(a, b).map(|strip| (strip, (i, gone, a, b))));
                gone += a.distance(b);
            }
        }
        Self { graph, terrain: graph.terrain.as_ref(), at, lengths, around, pieces: Index::new(pieces) }
    }

    /// Height of the ground above the city's zero, metres.
    pub fn ground_m(&self, p: DVec2) -> f64 {
        self.terrain.map_or(0.0, |terrain| terrain.height_m(p))
    }

    /// Streets and railways on the ground and above, without trams.
    pub fn ways(&self) -> impl Iterator<Item = (usize, &'a Link)> {
        self.graph.links.iter().enumerate().filter(|(_, link)| is_way(link) && link.layer >= 0)
    }

    pub fn line(&self, link: usize) -> Vec<DVec2> {
        self.graph.links.get(link).and_then(|link| self.graph.polyline(link, &self.at)).unwrap_or_default()
    }

    pub fn length_m(&self, link: usize) -> f64 {
        self.lengths.get(link).copied().unwrap_or(0.0)
    }

    /// The ways at a node, and the nodes at their other ends.
    pub fn around(&self, node: Id) -> &[(usize, Id)] {
        self.around.get(&node).map_or(&[], Vec::as_slice)
    }

    /// Where a chain leads over ways and trams on lower layers, but for those under the ground.
    pub fn crossings(&self, chain: &Chain) -> Vec<Crossing> {
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
                    let is_at = |node: Id| self.at.get(&node).is_some_and(|p| p.distance(pos) < AT_NODE_M);
                    let is_shared = |node: Id| [other.from, other.to].contains(&node) && is_at(node);
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
