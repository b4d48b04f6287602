//! Links that go on in one another: ways along which one may leave the ground.

use std::collections::HashMap;

use glam::DVec2;
use veduta_city::{CityGraph, Id, Link, LinkKind};

/// Links that go on in one another.
pub(super) struct Chain {
    /// Indices of the graph's links, and whether each is gone along backwards.
    pub links: Vec<(usize, bool)>,
    pub line: Vec<DVec2>,
}

/// Whether a link is a street or railway, trams aside, which lie in streets.
pub(super) const fn is_way(link: &Link) -> bool {
    matches!(link.kind, LinkKind::Street(_) | LinkKind::Railway { tram: false })
}

/// Indices of the links of streets and railways at each node.
pub(super) fn meet(graph: &CityGraph) -> HashMap<Id, Vec<usize>> {
    let mut meet: HashMap<Id, Vec<usize>> = HashMap::new();
    for (i, link) in graph.links.iter().enumerate().filter(|(_, link)| is_way(link)) {
        meet.entry(link.from).or_default().push(i);
        meet.entry(link.to).or_default().push(i);
    }
    meet
}

/// Whether a link is a street.
pub(super) const fn is_street(link: &Link) -> bool {
    matches!(link.kind, LinkKind::Street(_))
}

/// Links that are wanted, those that go on in one another together. They do where no other street or railway meets them.
pub(super) fn chains(graph: &CityGraph, is_wanted: impl Fn(&Link) -> bool) -> Vec<Chain> {
    let links = &graph.links;
    let wanted: Vec<usize> = (0..links.len()).filter(|&i| is_way(&links[i]) && is_wanted(&links[i])).collect();
    if wanted.is_empty() {
        return Vec::new();
    }
    let meet = meet(graph);
    let next = |link: usize, node: Id| -> Option<usize> {
        let [a, b] = meet.get(&node)?[..] else { return None };
        let other = if a == link { b } else { a };
        let alike =
            is_street(&links[link]) == is_street(&links[other]) && links[link].layer.signum() == links[other].layer.signum();
        (a != b && alike && wanted.binary_search(&other).is_ok()).then_some(other)
    };
    let at = graph.node_positions();
    let mut taken = vec![false; links.len()];
    let mut chains = Vec::new();
    // First from their ends on; what is left goes round.
    let is_end = |&i: &usize| next(i, links[i].from).is_none() || next(i, links[i].to).is_none();
    for &first in wanted.iter().filter(|i| is_end(i)).chain(&wanted) {
        if taken[first] {
            continue;
        }
        let is_back = next(first, links[first].from).is_some() && next(first, links[first].to).is_none();
        let (mut chain, mut here, mut back) = (Vec::new(), first, is_back);
        loop {
            taken[here] = true;
            chain.push((here, back));
            let node = if back { links[here].from } else { links[here].to };
            let Some(other) = next(here, node).filter(|&other| !taken[other]) else { break };
            (here, back) = (other, links[other].to == node);
        }
        chains.extend(Chain::of(graph, &at, chain));
    }
    chains
}

impl Chain {
    /// `None` if it has no length.
    pub fn of(graph: &CityGraph, at: &HashMap<Id, DVec2>, links: Vec<(usize, bool)>) -> Option<Self> {
        let mut line = Vec::<DVec2>::new();
        for &(link, is_back) in &links {
            let Some(mut part) = line_of(graph, at, &graph.links[link]) else { continue };
            if is_back {
                part.reverse();
            }
            line.extend(&part[usize::from(!line.is_empty())..]);
        }
        (line.len() > 1).then_some(Self { links, line })
    }

    /// The nodes at which it begins and ends.
    pub fn ends(&self, graph: &CityGraph) -> Option<[Id; 2]> {
        let (&(first, is_first_back), &(last, is_last_back)) = (self.links.first()?, self.links.last()?);
        let node = |link: usize, is_from: bool| {
            let link = &graph.links[link];
            if is_from { link.from } else { link.to }
        };
        Some([node(first, !is_first_back), node(last, is_last_back)])
    }
}

/// A link's line, if it has a length.
pub(super) fn line_of(graph: &CityGraph, at: &HashMap<Id, DVec2>, link: &Link) -> Option<Vec<DVec2>> {
    let mut line = graph.polyline(link, at)?;
    line.dedup_by(|a, b| a.distance(*b) < 1e-6);
    (line.len() > 1).then_some(line)
}
