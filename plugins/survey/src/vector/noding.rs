//! Joins lines where they meet: files of lines, unlike OpenStreetMap, do not say which of them have a vertex in common.
//!
//! Lines of one system (streets, rails, water) and one level are joined where they cross; ends are joined to lines and ends
//! that lie within a snapping distance, vertices to lines that pass through them. Bridges and tunnels have another level than
//! the ground, and join it by their ends alone; motorways join other streets by ramps and ends alone.

use std::collections::BTreeMap;

use glam::DVec2;
use rstar::primitives::{GeomWithData, Line as TreeLine};
use rstar::{AABB, RTree};
use veduta_city::{Anchor, Id, LinkKind, Severity};

use super::tagging::{is_motorway, passes_motorways};
use crate::lines::line_of;
use crate::log::Log;
use crate::network::{System, system_of};
use crate::osm::{OsmData, Tags, way_id};
use crate::shapes::use_of;

/// A vertex this near to a line lies on it, in metres: files keep a decimetre to a centimetre of a degree.
const ON_LINE_M: f64 = 0.02;

/// A way that becomes links.
struct Strand {
    number: i64,
    system: System,
    layer: i8,
    is_motorway: bool,
    passes_motorways: bool,
    nodes: Vec<i64>,
    at: Vec<DVec2>,
}

impl Strand {
    fn of(number: i64, kind: LinkKind, layer: i8, tags: &Tags, nodes: &[i64], data: &OsmData, anchor: Anchor) -> Self {
        let there = || nodes.iter().filter_map(|n| data.nodes.get(n).map(|node| (*n, anchor.plan_from_geo(node.lat, node.lon))));
        Self {
            number,
            system: system_of(kind),
            layer,
            is_motorway: is_motorway(tags),
            passes_motorways: passes_motorways(kind, tags),
            nodes: there().map(|(n, _)| n).collect(),
            at: there().map(|(_, p)| p).collect(),
        }
    }

    fn ends(&self) -> [Option<(i64, DVec2)>; 2] {
        let pair = |i: usize| self.nodes.get(i).copied().zip(self.at.get(i).copied());
        [pair(0), pair(self.nodes.len().wrapping_sub(1))]
    }

    fn is_end(&self, node: i64) -> bool {
        self.nodes.first() == Some(&node) || self.nodes.last() == Some(&node)
    }

    fn piece(&self, k: usize) -> Option<Piece> {
        Some(Piece { nodes: [*self.nodes.get(k)?, *self.nodes.get(k + 1)?], at: [*self.at.get(k)?, *self.at.get(k + 1)?] })
    }

    /// Whether two lines that cross in plan meet there.
    fn meets(&self, other: &Self) -> bool {
        let is_passed = (self.is_motorway && other.passes_motorways) || (other.is_motorway && self.passes_motorways);
        self.system == other.system && self.layer == other.layer && !is_passed
    }
}

/// A straight piece of a strand.
#[derive(Clone, Copy)]
struct Piece {
    nodes: [i64; 2],
    at: [DVec2; 2],
}

impl Piece {
    /// The nearest point to a position: how far along, 0 to 1, and how far away.
    fn nearest(&self, p: DVec2) -> (f64, f64) {
        let d = self.at[1] - self.at[0];
        let t = ((p - self.at[0]).dot(d) / d.length_squared().max(1e-12)).clamp(0.0, 1.0);
        (t, self.at[0].lerp(self.at[1], t).distance(p))
    }

    /// The end nearest to a position, if it is within reach.
    fn end_near(&self, p: DVec2, reach_m: f64) -> Option<i64> {
        let [a, b] = self.at.map(|q| q.distance(p));
        if a.min(b) > reach_m {
            return None;
        }
        Some(if a <= b { self.nodes[0] } else { self.nodes[1] })
    }

    /// Where another crosses, as fractions of both.
    fn crossing(&self, other: &Self) -> Option<(f64, f64)> {
        let (d, e, between) = (self.at[1] - self.at[0], other.at[1] - other.at[0], other.at[0] - self.at[0]);
        let cross = d.perp_dot(e);
        if cross.abs() <= 1e-9 * d.length() * e.length() {
            return None;
        }
        let (t, u) = (between.perp_dot(e) / cross, between.perp_dot(d) / cross);
        ((0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&u)).then_some((t, u))
    }
}

type Box2 = GeomWithData<TreeLine<[f64; 2]>, (usize, usize)>;

/// Joins the lines of a file. Ends are moved by up to `snap_m` metres.
pub(super) fn join(data: &mut OsmData, snap_m: f64, log: &mut Log) {
    let Some(anchor) = data.anchor.or_else(|| data.nodes.values().next().map(|n| Anchor { lat: n.lat, lon: n.lon })) else {
        return;
    };
    let strands = strands(data, anchor);
    let tree = tree(&strands);
    let mut joints =
        Joints { data, anchor, same: BTreeMap::new(), cuts: BTreeMap::new(), made: BTreeMap::new(), crossings: 0, snapped: 0 };
    for (s, strand) in strands.iter().enumerate() {
        joints.snap_ends(strand, s, &strands, &tree, snap_m);
        joints.touch(strand, s, &strands, &tree);
        joints.cross(strand, s, &strands, &tree, snap_m);
    }
    let Joints { same, cuts, crossings, snapped, .. } = joints;
    for (s, strand) in strands.iter().enumerate() {
        let nodes = rewoven(strand, cuts.get(&s).map(Vec::as_slice).unwrap_or_default(), &same);
        if let Some(way) = data.ways.get_mut(&strand.number) {
            way.nodes = nodes;
        }
    }
    let passed = lift_motorways(data, &strands);
    if crossings > 0 {
        let message = format!("{crossings} crossings of lines without a common vertex were made crossroads");
        log.tally(Severity::Note, Id::NONE, None, message);
    }
    if snapped > 0 {
        log.tally(Severity::Note, Id::NONE, None, format!("{snapped} ends were joined to lines within {snap_m} m"));
    }
    if passed > 0 {
        let message = format!("{passed} vertices that motorways share with streets below or above them were parted");
        log.tally(Severity::Note, Id::NONE, None, message);
    }
}

fn strands(data: &OsmData, anchor: Anchor) -> Vec<Strand> {
    let mut out = Vec::new();
    for (&number, way) in &data.ways {
        if way.tags.is_empty() || (way.is_closed() && use_of(&way.tags).is_some()) {
            continue;
        }
        // What is worth telling of a line is told when the network is made.
        if let Some(line) = line_of(&way.tags, way_id(number), &mut Log::default()) {
            out.push(Strand::of(number, line.kind, line.layer, &way.tags, &way.nodes, data, anchor));
        }
    }
    out
}

fn tree(strands: &[Strand]) -> RTree<Box2> {
    let pieces = strands.iter().enumerate().flat_map(|(s, strand)| {
        strand.at.windows(2).enumerate().map(move |(k, w)| {
            let line = TreeLine::new(w[0].to_array(), w[1].to_array());
            GeomWithData::new(line, (s, k))
        })
    });
    RTree::bulk_load(pieces.collect())
}

/// Pieces whose boxes meet that of two points, widened; in order.
fn near(tree: &RTree<Box2>, a: DVec2, b: DVec2, reach_m: f64) -> Vec<(usize, usize)> {
    let (low, high) = (a.min(b) - reach_m, a.max(b) + reach_m);
    let search = AABB::from_corners(low.to_array(), high.to_array());
    let mut found: Vec<(usize, usize)> = tree.locate_in_envelope_intersecting(&search).map(|g| g.data).collect();
    found.sort_unstable();
    found
}

/// What is found to meet, before anything is changed.
struct Joints<'a> {
    data: &'a mut OsmData,
    anchor: Anchor,
    /// Nodes that are one: each to one that stands for it, perhaps over several steps.
    same: BTreeMap<i64, i64>,
    /// For strands by index: piece, how far along it, and the node to go through.
    cuts: BTreeMap<usize, Vec<(usize, f64, i64)>>,
    /// Nodes that were made, by cells as wide as the snapping distance.
    made: BTreeMap<(i64, i64), Vec<(i64, DVec2)>>,
    crossings: usize,
    snapped: usize,
}

impl Joints<'_> {
    fn unite(&mut self, a: i64, b: i64) {
        let (a, b) = (stands_for(&self.same, a), stands_for(&self.same, b));
        if a != b {
            self.same.insert(a.max(b), a.min(b));
        }
    }

    fn cut(&mut self, strand: usize, piece: usize, t: f64, node: i64) {
        self.cuts.entry(strand).or_default().push((piece, t, node));
    }

    /// Joins both ends of a strand to whatever other strands lie within reach.
    fn snap_ends(&mut self, strand: &Strand, s: usize, strands: &[Strand], tree: &RTree<Box2>, snap_m: f64) {
        for (node, p) in strand.ends().into_iter().flatten() {
            // The nearest piece of each strand; none of those that go through the node already.
            let mut nearest: BTreeMap<usize, Option<(f64, usize)>> = BTreeMap::new();
            for (o, k) in near(tree, p, p, snap_m) {
                let Some((other, piece)) = strands.get(o).and_then(|other| Some((other, other.piece(k)?))) else { continue };
                if o == s || other.system != strand.system {
                    continue;
                }
                let away = piece.nearest(p).1;
                let best = nearest.entry(o).or_insert(Some((f64::INFINITY, k)));
                if piece.nodes.contains(&node) {
                    *best = None;
                } else if best.is_some_and(|(d, _)| away < d) {
                    *best = Some((away, k));
                }
            }
            for (o, found) in nearest {
                let Some((_, k)) = found.filter(|(away, _)| *away <= snap_m) else { continue };
                let Some((other, piece)) = strands.get(o).and_then(|other| Some((other, other.piece(k)?))) else { continue };
                match piece.end_near(p, snap_m) {
                    Some(end) if other.is_end(end) || other.meets(strand) => {
                        self.snapped += 1;
                        self.unite(node, end);
                    }
                    None if other.meets(strand) => {
                        self.snapped += 1;
                        self.cut(o, k, piece.nearest(p).0, node);
                    }
                    _ => {}
                }
            }
        }
    }

    /// Leads other strands through the inner vertices of this one that lie on them.
    fn touch(&mut self, strand: &Strand, s: usize, strands: &[Strand], tree: &RTree<Box2>) {
        let inner = 1..strand.nodes.len().saturating_sub(1);
        for (&node, &p) in inner.filter_map(|i| strand.nodes.get(i).zip(strand.at.get(i))) {
            for (o, k) in near(tree, p, p, ON_LINE_M) {
                let Some((other, piece)) = strands.get(o).and_then(|other| Some((other, other.piece(k)?))) else { continue };
                if o == s || !other.meets(strand) || piece.nodes.contains(&node) {
                    continue;
                }
                let (t, away) = piece.nearest(p);
                if away <= ON_LINE_M {
                    match piece.end_near(p, ON_LINE_M) {
                        Some(end) => self.unite(node, end),
                        None => self.cut(o, k, t, node),
                    }
                }
            }
        }
    }

    /// Makes nodes where a strand crosses others, or itself, in the middle of pieces; each pair once.
    fn cross(&mut self, strand: &Strand, s: usize, strands: &[Strand], tree: &RTree<Box2>, snap_m: f64) {
        for (k, w) in strand.at.windows(2).enumerate() {
            let Some(piece) = strand.piece(k) else { continue };
            for (o, l) in near(tree, w[0], w[1], 0.0) {
                if (o, l) <= (s, k) {
                    continue;
                }
                let Some((other, across)) = strands.get(o).and_then(|other| Some((other, other.piece(l)?))) else { continue };
                let is_joined = across.nodes.iter().any(|n| piece.nodes.contains(n));
                if is_joined || !strand.meets(other) {
                    continue;
                }
                if let Some((t, u)) = piece.crossing(&across) {
                    self.meet((s, k, t, piece), (o, l, u, across), snap_m);
                }
            }
        }
    }

    /// Joins two pieces that cross: by a vertex that is near, by a new node otherwise.
    fn meet(&mut self, (s, k, t, piece): (usize, usize, f64, Piece), (o, l, u, across): (usize, usize, f64, Piece), snap_m: f64) {
        let p = piece.at[0].lerp(piece.at[1], t);
        match (piece.end_near(p, snap_m), across.end_near(p, snap_m)) {
            (Some(a), Some(b)) => self.unite(a, b),
            (Some(a), None) => self.cut(o, l, u, a),
            (None, Some(b)) => self.cut(s, k, t, b),
            (None, None) => {
                if let Some(node) = self.node_at(p, snap_m) {
                    self.cut(s, k, t, node);
                    self.cut(o, l, u, node);
                }
            }
        }
    }
}

impl Joints<'_> {
    /// A node for a crossing: one that was made within the snapping distance, so that three lines through almost one point
    /// meet in one, or a new one.
    fn node_at(&mut self, p: DVec2, snap_m: f64) -> Option<i64> {
        let cell = (p / snap_m.max(ON_LINE_M)).floor();
        let (x, y) = (cell.x as i64, cell.y as i64);
        let around = (x - 1..=x + 1).flat_map(|x| (y - 1..=y + 1).map(move |y| (x, y)));
        let made = around.filter_map(|c| self.made.get(&c)).flatten();
        let near = made.map(|&(node, q)| (q.distance(p), node)).filter(|(away, _)| *away <= snap_m);
        if let Some((_, node)) = near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))) {
            return Some(node);
        }
        let (lat, lon) = self.anchor.geo_from_plan(p);
        let node = self.data.node_at(lat, lon)?;
        self.made.entry((x, y)).or_default().push((node, p));
        self.crossings += 1;
        Some(node)
    }
}

/// The node that stands for another.
fn stands_for(same: &BTreeMap<i64, i64>, mut node: i64) -> i64 {
    // Every step leads to a lesser number.
    while let Some(&next) = same.get(&node) {
        node = next;
    }
    node
}

/// The nodes of a strand with its cuts.
fn rewoven(strand: &Strand, cuts: &[(usize, f64, i64)], same: &BTreeMap<i64, i64>) -> Vec<i64> {
    let mut cuts = cuts.to_vec();
    cuts.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
    let mut cuts = cuts.into_iter().peekable();
    let mut out: Vec<i64> = Vec::with_capacity(strand.nodes.len() + cuts.len());
    for (k, &node) in strand.nodes.iter().enumerate() {
        out.push(stands_for(same, node));
        while let Some((_, _, node)) = cuts.next_if(|c| c.0 == k) {
            out.push(stands_for(same, node));
        }
    }
    out.dedup();
    out
}

/// Gives motorways nodes of their own where they share a vertex with streets that only pass there: files that keep the plane
/// whole, such as TIGER/Line, have vertices where lines cross on different levels. Tells how many.
fn lift_motorways(data: &mut OsmData, strands: &[Strand]) -> usize {
    #[derive(Default)]
    struct Uses {
        motorway: bool,
        passing: bool,
        joining: bool,
    }
    let mut uses: BTreeMap<i64, Uses> = BTreeMap::new();
    for strand in strands.iter().filter(|s| s.system == System::Street) {
        let nodes = data.ways.get(&strand.number).map(|w| w.nodes.as_slice()).unwrap_or_default();
        for (i, &node) in nodes.iter().enumerate() {
            let uses = uses.entry(node).or_default();
            let is_end = i == 0 || i + 1 == nodes.len();
            uses.motorway |= strand.is_motorway;
            uses.passing |= strand.passes_motorways && !is_end;
            uses.joining |= !strand.is_motorway && (is_end || !strand.passes_motorways);
        }
    }
    let mut lifted: BTreeMap<i64, i64> = BTreeMap::new();
    for (&node, _) in uses.iter().filter(|(_, u)| u.motorway && u.passing && !u.joining) {
        let Some(place) = data.nodes.get(&node).cloned() else { continue };
        let mut number = node.wrapping_add(1);
        while data.nodes.contains_key(&number) {
            number = number.wrapping_add(1);
        }
        data.nodes.insert(number, place);
        lifted.insert(node, number);
    }
    for strand in strands.iter().filter(|s| s.is_motorway) {
        if let Some(way) = data.ways.get_mut(&strand.number) {
            way.nodes.iter_mut().for_each(|n| *n = lifted.get(n).copied().unwrap_or(*n));
        }
    }
    lifted.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::osm::Way;
    use proptest::prelude::*;

    /// Ways in metres around 0° N, 0° E.
    fn data(ways: &[(&[(f64, f64)], &[(&str, &str)])]) -> OsmData {
        let anchor = Anchor::default();
        let mut data = OsmData { anchor: Some(anchor), ..OsmData::default() };
        for (i, (line, tags)) in ways.iter().enumerate() {
            let geo = |&(x, y): &(f64, f64)| anchor.geo_from_plan(DVec2::new(x, y));
            let nodes = line.iter().map(geo).filter_map(|(lat, lon)| data.node_at(lat, lon)).collect();
            data.ways.insert(i as i64 + 1, Way { nodes, tags: tags.iter().copied().collect() });
        }
        data
    }

    /// Nodes that two ways have in common after joining, for every pair.
    fn common(ways: &[(&[(f64, f64)], &[(&str, &str)])]) -> Vec<usize> {
        let mut data = data(ways);
        join(&mut data, 0.25, &mut Log::default());
        let nodes: Vec<&[i64]> = data.ways.values().map(|w| w.nodes.as_slice()).collect();
        let mut out = Vec::new();
        for i in 0..nodes.len() {
            for j in i + 1..nodes.len() {
                out.push(nodes[i].iter().filter(|n| nodes[j].contains(n)).count());
            }
        }
        out
    }

    const STREET: &[(&str, &str)] = &[("highway", "residential")];
    const BRIDGE: &[(&str, &str)] = &[("highway", "residential"), ("bridge", "yes")];
    const RAIL: &[(&str, &str)] = &[("railway", "rail")];
    const MOTORWAY: &[(&str, &str)] = &[("highway", "motorway")];
    const RAMP: &[(&str, &str)] = &[("highway", "motorway_link")];
    const EAST: &[(f64, f64)] = &[(-50.0, 0.0), (50.0, 0.0)];
    const NORTH: &[(f64, f64)] = &[(0.0, -50.0), (0.0, 50.0)];
    const NORTH_WITH_VERTEX: &[(f64, f64)] = &[(0.0, -50.0), (0.0, 0.0), (0.0, 50.0)];

    #[test]
    fn streets_that_cross_meet() {
        assert_eq!(common(&[(EAST, STREET), (NORTH, STREET)]), [1]);
        assert_eq!(common(&[(EAST, STREET), (NORTH_WITH_VERTEX, STREET)]), [1], "one has a vertex there");
        let near = &[(-50.0, 0.1), (0.1, 0.1), (50.0, 0.0)];
        assert_eq!(common(&[(near, STREET), (NORTH_WITH_VERTEX, STREET)]), [1], "both have, not quite the same");
    }

    #[test]
    fn bridges_rails_and_motorways_pass() {
        assert_eq!(common(&[(EAST, STREET), (NORTH, BRIDGE)]), [0]);
        assert_eq!(common(&[(EAST, STREET), (NORTH, RAIL)]), [0]);
        assert_eq!(common(&[(EAST, STREET), (NORTH, MOTORWAY)]), [0]);
        assert_eq!(common(&[(EAST, RAMP), (NORTH, MOTORWAY)]), [1]);
        let east = &[(-50.0, 0.0), (0.0, 0.0), (50.0, 0.0)];
        assert_eq!(common(&[(east, STREET), (NORTH_WITH_VERTEX, MOTORWAY)]), [0], "though the file has a vertex there");
        let end = &[(-50.0, 0.0), (0.0, 0.0)];
        assert_eq!(common(&[(end, STREET), (NORTH_WITH_VERTEX, MOTORWAY)]), [1], "a street that ends there is its beginning");
        let bridge = &[(0.0, -50.0), (0.0, 0.05)];
        assert_eq!(common(&[(EAST, STREET), (bridge, BRIDGE)]), [0], "a bridge's end above a street");
        let approach = &[(0.0, 0.1), (0.0, 50.0)];
        assert_eq!(common(&[(approach, STREET), (bridge, BRIDGE)]), [1], "a bridge's end at a street's end");
    }

    #[test]
    fn ends_that_fall_short_or_reach_over_are_joined() {
        for y in [0.2, -0.2, 0.0] {
            let side = [(0.0, 50.0), (0.0, y)];
            assert_eq!(common(&[(EAST, STREET), (&side, STREET)]), [1], "{y}");
        }
        assert_eq!(common(&[(EAST, STREET), (&[(0.0, 50.0), (0.0, 0.4)], STREET)]), [0], "too far");
        assert_eq!(common(&[(EAST, STREET), (&[(50.1, 0.1), (90.0, 0.0)], STREET)]), [1], "end to end");
    }

    #[test]
    fn a_line_that_crosses_itself_meets_itself() {
        let mut data = data(&[(&[(-50.0, 0.0), (50.0, 0.0), (0.0, 50.0), (0.0, -50.0)], STREET)]);
        join(&mut data, 0.25, &mut Log::default());
        let nodes = &data.ways[&1].nodes;
        assert_eq!((nodes.len(), nodes[1]), (6, nodes[4]));
    }

    #[test]
    fn three_lines_through_almost_one_point_meet_in_one() {
        let ways: [(&[(f64, f64)], &[(&str, &str)]); 3] =
            [(EAST, STREET), (NORTH, STREET), (&[(-50.0, -49.9), (50.0, 50.0)], STREET)];
        let mut data = data(&ways);
        join(&mut data, 0.25, &mut Log::default());
        let middles: Vec<i64> = data.ways.values().map(|w| w.nodes[1]).collect();
        assert!(middles.iter().all(|n| *n == middles[0]) && data.ways.values().all(|w| w.nodes.len() == 3), "{:?}", data.ways);
    }

    /// Plan positions of a way's nodes.
    fn line(data: &OsmData, number: i64) -> Vec<DVec2> {
        let node = |n: &i64| {
            let node = &data.nodes[n];
            Anchor::default().plan_from_geo(node.lat, node.lon)
        };
        data.ways[&number].nodes.iter().map(node).collect()
    }

    proptest! {
        #[test]
        fn lines_that_cross_share_a_node_there(
            lines in prop::collection::vec(prop::collection::vec((-20_i32..20, -20_i32..20), 2..6), 1..8),
        ) {
            let lines: Vec<Vec<(f64, f64)>> =
                lines.iter().map(|l| l.iter().map(|&(x, y)| (f64::from(x) * 2.5, f64::from(y) * 2.5)).collect()).collect();
            let ways: Vec<(&[(f64, f64)], &[(&str, &str)])> = lines.iter().map(|l| (l.as_slice(), STREET)).collect();
            let mut data = data(&ways);
            join(&mut data, 0.25, &mut Log::default());
            for (i, first) in lines.iter().enumerate() {
                let number = i as i64 + 1;
                let at = line(&data, number);
                for &(x, y) in first {
                    prop_assert!(at.iter().any(|q| q.distance(DVec2::new(x, y)) < 1.0), "vertices stay where they were");
                }
                for other in number + 1..=lines.len() as i64 {
                    let across = line(&data, other);
                    let common: Vec<DVec2> = at.iter().filter(|p| across.contains(p)).copied().collect();
                    for v in at.windows(2) {
                        for w in across.windows(2) {
                            let piece = Piece { nodes: [0, 1], at: [v[0], v[1]] };
                            if let Some((t, _)) = piece.crossing(&Piece { nodes: [2, 3], at: [w[0], w[1]] }) {
                                let p = v[0].lerp(v[1], t);
                                prop_assert!(common.iter().any(|q| q.distance(p) < 2.0), "they cross at {p} without a node");
                            }
                        }
                    }
                }
            }
        }
    }
}
