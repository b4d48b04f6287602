//! Nodes and links of a fabric: what is a street, without loose ends and what cannot be reached.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use veduta_city::{Id, Link, LinkKind, Node, StreetClass, Surfacing};

use super::fabric::{Fabric, Role, Spot, Use, WayId};

/// Edges that are streets, and the faces they leave to be built on.
#[derive(Debug, Default)]
pub(super) struct Streets {
    /// Lesser vertex first.
    edges: BTreeMap<(Spot, Spot), WayId>,
}

/// A link and what it was laid as.
#[derive(Debug)]
pub(super) struct Laid {
    pub link: Link,
    pub way: WayId,
    pub ends: [Spot; 2],
}

/// Vertices this close to the line between their neighbours are left out; metres.
const STRAIGHT_M: f64 = 0.05;

impl Streets {
    /// All streets but those that end nowhere (unless they lead out of the town) and those that cannot be reached from the rest.
    pub fn of(fabric: &Fabric) -> Self {
        let is_street = |way: WayId| matches!(fabric.ways.get(way).map(|w| w.role), Some(Role::Street(_) | Role::Bridge(_)));
        let edges = fabric.all_edges().filter(|&(_, _, way)| is_street(way)).map(|(a, b, way)| ((a, b), way)).collect();
        let mut streets = Self { edges };
        streets.trim(fabric);
        streets.keep_reachable(fabric);
        streets
    }

    pub fn has(&self, a: Spot, b: Spot) -> bool {
        self.edges.contains_key(&(a.min(b), a.max(b)))
    }

    fn around(&self) -> BTreeMap<Spot, Vec<Spot>> {
        let mut around: BTreeMap<Spot, Vec<Spot>> = BTreeMap::new();
        for &(a, b) in self.edges.keys() {
            around.entry(a).or_default().push(b);
            around.entry(b).or_default().push(a);
        }
        around
    }

    /// Takes off loose ends that are neither on a square nor the end of a road out of the town.
    fn trim(&mut self, fabric: &Fabric) {
        let on_square = square_spots(fabric);
        let mut around = self.around();
        let mut loose: Vec<Spot> = around.iter().filter(|(_, n)| n.len() == 1).map(|(&s, _)| s).collect();
        while let Some(end) = loose.pop() {
            let Some(&[next]) = around.get(&end).map(Vec::as_slice) else { continue };
            let is_road_out = fabric.way(end, next).is_some_and(|w| w.is_main)
                && fabric.neighbours(end).iter().any(|&n| fabric.way(end, n).is_some_and(|w| w.role == Role::Edge));
            if on_square.contains_key(&end) || is_road_out {
                continue;
            }
            around.remove(&end);
            self.edges.remove(&(end.min(next), end.max(next)));
            if let Some(list) = around.get_mut(&next) {
                list.retain(|&n| n != end);
                if list.len() == 1 {
                    loose.push(next);
                }
            }
        }
    }

    /// Keeps the largest piece; streets that end on one square are joined by it.
    fn keep_reachable(&mut self, fabric: &Fabric) {
        let on_square = square_spots(fabric);
        let around = self.around();
        let mut of_square: BTreeMap<usize, Vec<Spot>> = BTreeMap::new();
        for (&spot, faces) in &on_square {
            faces.iter().for_each(|&face| of_square.entry(face).or_default().push(spot));
        }
        let mut seen: BTreeSet<Spot> = BTreeSet::new();
        let mut best: BTreeSet<Spot> = BTreeSet::new();
        for &start in around.keys() {
            if seen.contains(&start) {
                continue;
            }
            let (mut piece, mut open) = (BTreeSet::from([start]), vec![start]);
            while let Some(spot) = open.pop() {
                let across = on_square.get(&spot).into_iter().flatten().filter_map(|face| of_square.get(face)).flatten();
                for &next in around.get(&spot).into_iter().flatten().chain(across) {
                    if piece.insert(next) {
                        open.push(next);
                    }
                }
            }
            seen.extend(&piece);
            if piece.len() > best.len() {
                best = piece;
            }
        }
        self.edges.retain(|(a, _), _| best.contains(a));
    }

    /// Links between the vertices where streets meet, end or change.
    pub fn links(&self, fabric: &Fabric, is_old: bool) -> Vec<Laid> {
        let around = self.around();
        let on_square = square_spots(fabric);
        let way = |a: Spot, b: Spot| self.edges.get(&(a.min(b), a.max(b))).copied();
        let is_node = |spot: Spot| match around.get(&spot).map(Vec::as_slice) {
            Some(&[a, b]) => way(spot, a) != way(spot, b) || on_square.contains_key(&spot),
            _ => true,
        };
        let mut done: BTreeSet<(Spot, Spot)> = BTreeSet::new();
        let mut out = Vec::new();
        let nodes = around.keys().copied().filter(|&s| is_node(s));
        // Rings without a node begin anywhere.
        let starts: Vec<Spot> = nodes.chain(around.keys().copied()).collect();
        for start in starts {
            for &first in around.get(&start).into_iter().flatten() {
                if done.contains(&(start.min(first), start.max(first))) {
                    continue;
                }
                let (mut line, mut at) = (vec![start], first);
                done.insert((start.min(first), start.max(first)));
                line.push(first);
                while !is_node(at) && at != start {
                    let before = line.get(line.len() - 2).copied();
                    let Some(&next) = around.get(&at).into_iter().flatten().find(|&&n| Some(n) != before) else { break };
                    done.insert((at.min(next), at.max(next)));
                    line.push(next);
                    at = next;
                }
                let Some(way) = way(start, first) else { continue };
                if line.first() == line.last() {
                    let rest = line.split_off(line.len() / 2);
                    let mut second: Vec<Spot> = line.last().copied().into_iter().collect();
                    second.extend(rest);
                    out.extend(laid(fabric, &second, way, is_old));
                }
                out.extend(laid(fabric, &line, way, is_old));
            }
        }
        out
    }
}

fn laid(fabric: &Fabric, line: &[Spot], way: WayId, is_old: bool) -> Option<Laid> {
    let (&from, &to) = (line.first()?, line.last()?);
    let kept = fabric.ways.get(way)?;
    let (class, layer) = match kept.role {
        Role::Street(class) => (class, 0),
        Role::Bridge(class) => (class, 1),
        Role::Front | Role::Edge => return None,
    };
    let points: Vec<DVec2> = line.iter().map(|&s| fabric.pos(s)).collect();
    let surfacing = (is_old && class.has_carriageway()).then_some(Surfacing::Cobbles);
    let link = Link {
        id: Id::NONE,
        from: node_id(fabric.pos(from)),
        to: node_id(fabric.pos(to)),
        via: bends(&points),
        kind: LinkKind::Street(class),
        width_m: kept.width_m,
        profile: Vec::new(),
        name: String::new(),
        layer,
        surfacing,
    };
    (from != to).then_some(Laid { link, way, ends: [from, to] })
}

/// Inner points of a line at which it bends.
fn bends(points: &[DVec2]) -> Vec<DVec2> {
    let mut kept: Vec<DVec2> = points.first().copied().into_iter().collect();
    for pair in points.windows(2).skip(1) {
        let &[p, next] = pair else { continue };
        let before = kept.last().copied().unwrap_or(p);
        if super::fit::distance_to(p, before, next) > STRAIGHT_M {
            kept.push(p);
        }
    }
    kept.split_off(1.min(kept.len()))
}

/// Id of the node at a spot: by its place, so that it stays when other parts of the words change.
pub(super) fn node_id(pos: DVec2) -> Id {
    Id::from_place("node", pos)
}

/// Nodes at the ends of links.
pub(super) fn nodes(fabric: &Fabric, links: &[Laid]) -> Vec<Node> {
    let spots: BTreeSet<Spot> = links.iter().flat_map(|l| l.ends).collect();
    spots.into_iter().map(|s| Node { id: node_id(fabric.pos(s)), pos: fabric.pos(s), z: 0.0 }).collect()
}

/// Vertices of squares, and the squares they belong to.
pub(super) fn square_spots(fabric: &Fabric) -> BTreeMap<Spot, Vec<usize>> {
    let mut spots: BTreeMap<Spot, Vec<usize>> = BTreeMap::new();
    for (i, face) in fabric.faces.iter().enumerate().filter(|(_, f)| f.use_ == Use::Square) {
        face.ring.iter().for_each(|&s| spots.entry(s).or_default().push(i));
    }
    spots
}

/// The class of a way, if it is a street.
pub(super) fn class_of(fabric: &Fabric, way: WayId) -> Option<StreetClass> {
    match fabric.ways.get(way)?.role {
        Role::Street(class) | Role::Bridge(class) => Some(class),
        Role::Front | Role::Edge => None,
    }
}
