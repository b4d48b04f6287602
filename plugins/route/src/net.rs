//! The network of streets: what joins what, and the nearest point on it.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use rstar::{
    AABB, RTree,
    primitives::{GeomWithData, Line},
};
use veduta_city::{GridPos, Id, PlanStreet, PlanTerrain, StreetClass, metres};

/// Ends of lines that lie this near to another line are joined to it, in metres.
pub const JOIN_M: f64 = 0.5;

/// A straight piece of a street between two nodes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Segment {
    pub from: u32,
    pub to: u32,
    pub street: u32,
}

/// What the network keeps of a street.
#[derive(Debug, Clone, Copy)]
struct Street {
    index: usize,
    id: Id,
    half_width_m: f64,
    layer: i8,
}

/// The nearest point on a street.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// The point, plan metres.
    pub plan_pos: DVec2,
    /// How far it lies from the position asked for, in metres.
    pub distance_m: f64,
    /// The street's index in the slice that the network was made from.
    pub street: usize,
    /// The street's id.
    pub id: Id,
    /// Half the street's width, in metres.
    pub half_width_m: f64,
    /// Index of the segment.
    pub(crate) segment: u32,
}

pub(crate) type Entry = GeomWithData<Line<[f64; 2]>, u32>;

/// Walkable network from street centre lines: nodes and straight segments, with an index by place.
///
/// Lines are joined where they share a vertex exactly (lines of different layers only if one of them ends there), and where
/// the end of one lies within [`JOIN_M`] of another. Lines that cross without a common vertex are not joined: one of them
/// is a bridge.
#[derive(Debug, Clone)]
pub struct StreetNet {
    /// What its streets lie on.
    pub(crate) terrain: PlanTerrain,
    pub(crate) nodes: Vec<DVec2>,
    pub(crate) segments: Vec<Segment>,
    streets: Vec<Street>,
    /// Neighbours of node `i`: `neighbours[first[i]..first[i + 1]]`, with the distance in metres.
    first: Vec<u32>,
    neighbours: Vec<(u32, f64)>,
    /// Connected piece of the network, by node.
    pub(crate) piece: Vec<u32>,
    /// Metres of street of each connected piece.
    piece_m: Vec<f64>,
    /// The piece with most street.
    pub(crate) main_piece: u32,
    pub(crate) tree: RTree<Entry>,
    /// Nodes at which a street ends and no other goes on.
    pub(crate) dead_ends: RTree<GeomWithData<[f64; 2], u32>>,
    /// Straight pieces of stairs that nothing leads over.
    pub(crate) barred: RTree<Line<[f64; 2]>>,
}

impl StreetNet {
    /// A network of the walkable streets among those given; others, and lines of fewer than two different vertices, are
    /// left out.
    #[must_use]
    pub fn new(streets: &[PlanStreet]) -> Self {
        Self::of(streets, |_| true)
    }

    /// The same without stairs: for wheelchairs and prams. Nothing leads along them, and no line across free space over them.
    #[must_use]
    pub fn without_steps(streets: &[PlanStreet]) -> Self {
        let is_stair = |street: &PlanStreet| street.class == StreetClass::Steps;
        let stairs = streets.iter().filter(|street| street.walkable && is_stair(street));
        let pieces = stairs.flat_map(|street| street.line.windows(2)).map(|w| {
            let [a, b] = [w[0], w[1]].map(|pos| pos.to_metres().to_array());
            Line::new(a, b)
        });
        Self { barred: RTree::bulk_load(pieces.collect()), ..Self::of(streets, |street| !is_stair(street)) }
    }

    fn of(streets: &[PlanStreet], is_used: impl Fn(&PlanStreet) -> bool) -> Self {
        let mut draft = Draft::default();
        let ends = End::collect(streets);
        for (index, street) in streets.iter().enumerate().filter(|(_, s)| s.walkable && is_used(s)) {
            draft.add(index, street, &ends);
        }
        draft.join_ends();
        draft.finish()
    }

    /// Whether the straight line between two positions leads over stairs that are barred.
    pub(crate) fn is_barred(&self, a: DVec2, b: DVec2) -> bool {
        let (low, high) = (a.min(b), a.max(b));
        let near = self.barred.locate_in_envelope_intersecting(&AABB::from_corners(low.to_array(), high.to_array()));
        near.into_iter().any(|stair| crosses([a, b], [stair.from, stair.to].map(DVec2::from)))
    }

    /// The same on the ground of a city, so that who walks there looks up and down at what stands higher and lower.
    #[must_use]
    pub fn on(self, terrain: &PlanTerrain) -> Self {
        Self { terrain: terrain.clone(), ..self }
    }

    /// The nearest point on any street that is not below the ground; `None` if there is none or the position is not finite.
    #[must_use]
    pub fn nearest(&self, plan_pos: DVec2) -> Option<Foot> {
        self.feet_by_distance(plan_pos).next()
    }

    /// Whether there is nothing to walk along.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.segments.is_empty()
    }

    /// The nearest point of every segment that is not below the ground, nearest segment first.
    pub(crate) fn feet_by_distance(&self, plan_pos: DVec2) -> impl Iterator<Item = Foot> + '_ {
        // An index asked for a place that is no number has no order to give.
        let asked = if plan_pos.is_finite() { Some([plan_pos.x, plan_pos.y]) } else { None };
        asked
            .into_iter()
            .flat_map(move |p| self.tree.nearest_neighbor_iter(&p))
            .filter_map(move |entry| self.foot_on(entry.data, plan_pos))
    }

    fn foot_on(&self, segment: u32, plan_pos: DVec2) -> Option<Foot> {
        let Segment { from, to, street } = *self.segments.get(segment as usize)?;
        let (a, b) = (self.node(from), self.node(to));
        let (point, _) = nearest_on(a, b, plan_pos);
        // One walks through tunnels, but gets in by their ends alone.
        let street = self.streets.get(street as usize).filter(|street| street.layer >= 0)?;
        Some(Foot {
            plan_pos: point,
            distance_m: point.distance(plan_pos),
            street: street.index,
            id: street.id,
            half_width_m: street.half_width_m,
            segment,
        })
    }

    /// Position of a node; the network's own indices are always good.
    pub(crate) fn node(&self, index: u32) -> DVec2 {
        self.nodes.get(index as usize).copied().unwrap_or(DVec2::ZERO)
    }

    /// Neighbours of a node and how far they are, in metres.
    pub(crate) fn neighbours(&self, node: u32) -> &[(u32, f64)] {
        let node = node as usize;
        match (self.first.get(node), self.first.get(node + 1)) {
            (Some(&from), Some(&to)) => self.neighbours.get(from as usize..to as usize).unwrap_or(&[]),
            _ => &[],
        }
    }

    /// The connected piece of the network that a segment belongs to.
    pub(crate) fn piece_of(&self, segment: u32) -> Option<u32> {
        let segment = self.segments.get(segment as usize)?;
        self.piece.get(segment.from as usize).copied()
    }

    /// Metres of street of a connected piece.
    pub(crate) fn length_of_piece(&self, piece: u32) -> f64 {
        self.piece_m.get(piece as usize).copied().unwrap_or(0.0)
    }
}

/// Whether two straight pieces cross, ends apart.
fn crosses([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// The nearest point to `p` on the line from `a` to `b`, and how far along it lies, 0 to 1.
pub(crate) fn nearest_on(a: DVec2, b: DVec2, p: DVec2) -> (DVec2, f64) {
    let d = b - a;
    let along = if d.length_squared() > 0.0 { ((p - a).dot(d) / d.length_squared()).clamp(0.0, 1.0) } else { 0.0 };
    (a + d * along, along)
}

/// The positions at which some line ends.
struct End(BTreeSet<GridPos>);

impl End {
    fn collect(streets: &[PlanStreet]) -> Self {
        let walkable = streets.iter().filter(|s| s.walkable);
        Self(walkable.flat_map(|s| [s.line.first(), s.line.last()]).flatten().copied().collect())
    }
}

/// A network in the making.
#[derive(Default)]
struct Draft {
    nodes: Vec<DVec2>,
    /// By position, and layer where no line ends.
    node_at: BTreeMap<(GridPos, Option<i8>), u32>,
    segments: Vec<Segment>,
    streets: Vec<Street>,
    /// First and last node of each street.
    ends: Vec<(u32, i8)>,
    /// Joins that are no part of a street.
    bridges: Vec<(u32, u32)>,
}

impl Draft {
    fn add(&mut self, index: usize, street: &PlanStreet, ends: &End) {
        let mut line = Vec::with_capacity(street.line.len());
        for &pos in &street.line {
            let key = (pos, if ends.0.contains(&pos) { None } else { Some(street.layer) });
            let node = *self.node_at.entry(key).or_insert_with(|| {
                self.nodes.push(pos.to_metres());
                (self.nodes.len() - 1) as u32
            });
            if line.last() != Some(&node) {
                line.push(node);
            }
        }
        let (Some(&first), Some(&last)) = (line.first(), line.last()) else { return };
        if line.len() < 2 {
            return;
        }
        let number = self.streets.len() as u32;
        let half_width_m = metres(street.width.max(0)) / 2.0;
        self.streets.push(Street { index, id: street.id, half_width_m, layer: street.layer });
        self.segments.extend(line.windows(2).map(|w| Segment { from: w[0], to: w[1], street: number }));
        self.ends.extend([(first, street.layer), (last, street.layer)]);
    }

    fn at(&self, node: u32) -> DVec2 {
        self.nodes[node as usize]
    }

    fn tree(&self) -> RTree<Entry> {
        let entry = |(i, s): (usize, &Segment)| {
            GeomWithData::new(Line::new(self.at(s.from).to_array(), self.at(s.to).to_array()), i as u32)
        };
        RTree::bulk_load(self.segments.iter().enumerate().map(entry).collect())
    }

    /// Joins ends to what lies within [`JOIN_M`] of them: to a vertex if one does, otherwise to a new vertex in the segment.
    fn join_ends(&mut self) {
        let tree = self.tree();
        let mut cuts: BTreeMap<u32, Vec<(f64, u32)>> = BTreeMap::new();
        let ends: BTreeSet<(u32, i8)> = self.ends.iter().copied().collect();
        let end_nodes: BTreeSet<u32> = ends.iter().map(|e| e.0).collect();
        for &(end, layer) in &ends {
            let p = self.at(end);
            let mut near: Vec<u32> = tree.locate_within_distance(p.to_array(), JOIN_M * JOIN_M).map(|e| e.data).collect();
            near.sort_unstable();
            for index in near {
                let Segment { from, to, street } = self.segments[index as usize];
                if from == end || to == end {
                    continue;
                }
                let same_layer = self.streets[street as usize].layer == layer;
                let vertex = [from, to].into_iter().find(|&v| self.at(v).distance(p) <= JOIN_M);
                match vertex {
                    Some(vertex) if same_layer || end_nodes.contains(&vertex) => self.bridges.push((end, vertex)),
                    None if same_layer => {
                        let (_, along) = nearest_on(self.at(from), self.at(to), p);
                        cuts.entry(index).or_default().push((along, end));
                    }
                    _ => {}
                }
            }
        }
        for (index, cuts) in cuts {
            self.cut(index, cuts);
        }
    }

    /// Cuts a segment at places along it and joins each to its end.
    fn cut(&mut self, index: u32, mut cuts: Vec<(f64, u32)>) {
        cuts.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let Segment { from, to, street } = self.segments[index as usize];
        let (a, b) = (self.at(from), self.at(to));
        let mut last = from;
        for (along, end) in cuts {
            let node = self.nodes.len() as u32;
            self.nodes.push(a + (b - a) * along);
            if last == from {
                self.segments[index as usize].to = node;
            } else {
                self.segments.push(Segment { from: last, to: node, street });
            }
            self.bridges.push((node, end));
            last = node;
        }
        self.segments.push(Segment { from: last, to, street });
    }

    fn finish(self) -> StreetNet {
        let mut pairs: Vec<(u32, u32)> = Vec::with_capacity(2 * (self.segments.len() + self.bridges.len()));
        for (a, b) in self.segments.iter().map(|s| (s.from, s.to)).chain(self.bridges.iter().copied()) {
            pairs.extend([(a, b), (b, a)]);
        }
        pairs.sort_unstable();
        pairs.dedup();
        let mut first = vec![0u32; self.nodes.len() + 1];
        for &(a, _) in &pairs {
            first[a as usize + 1] += 1;
        }
        for i in 1..first.len() {
            first[i] += first[i - 1];
        }
        let neighbours = pairs.iter().map(|&(a, b)| (b, self.at(a).distance(self.at(b)))).collect();
        let dead = |&node: &u32| first[node as usize + 1] - first[node as usize] == 1;
        let dead_ends = (0..self.nodes.len() as u32).filter(dead).map(|n| GeomWithData::new(self.at(n).to_array(), n)).collect();
        let tree = self.tree();
        let piece = vec![u32::MAX; self.nodes.len()];
        let Self { nodes, segments, streets, .. } = self;
        let dead_ends = RTree::bulk_load(dead_ends);
        let (terrain, barred) = (PlanTerrain::default(), RTree::new());
        let (piece_m, main_piece) = (Vec::new(), 0);
        let mut net =
            StreetNet { terrain, nodes, segments, streets, first, neighbours, piece, piece_m, main_piece, tree, dead_ends, barred };
        net.find_pieces();
        net
    }
}

impl StreetNet {
    /// Numbers the connected pieces by a flood from each node in turn.
    fn find_pieces(&mut self) {
        let mut pieces = 0;
        for start in 0..self.nodes.len() as u32 {
            if self.piece[start as usize] != u32::MAX {
                continue;
            }
            let mut stack = vec![start];
            while let Some(node) = stack.pop() {
                if self.piece[node as usize] != u32::MAX {
                    continue;
                }
                self.piece[node as usize] = pieces;
                stack.extend(self.neighbours(node).iter().map(|n| n.0));
            }
            pieces += 1;
        }
        let mut metres = vec![0.0; pieces as usize];
        for segment in &self.segments {
            let [from, to] = [segment.from, segment.to].map(|node| self.node(node));
            metres[self.piece[segment.from as usize] as usize] += from.distance(to);
        }
        let longest = (0..pieces).max_by(|&a, &b| metres[a as usize].total_cmp(&metres[b as usize]).then(b.cmp(&a)));
        (self.main_piece, self.piece_m) = (longest.unwrap_or(0), metres);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::street;

    #[test]
    fn the_nearest_point_lies_on_the_nearest_street_and_names_it() {
        let net = StreetNet::new(&[street(&[(0.0, 0.0), (10.0, 0.0)]), street(&[(0.0, 8.0), (10.0, 8.0)])]);
        let foot = net.nearest(DVec2::new(3.0, 5.0)).expect("there are streets");
        assert_eq!((foot.plan_pos, foot.distance_m, foot.street), (DVec2::new(3.0, 8.0), 3.0, 1));
        assert_eq!(foot.half_width_m, 3.0);
    }

    #[test]
    fn nothing_is_near_where_there_is_no_street_or_no_place() {
        assert!(StreetNet::new(&[]).nearest(DVec2::ZERO).is_none());
        let mut closed = street(&[(0.0, 0.0), (10.0, 0.0)]);
        closed.walkable = false;
        assert!(StreetNet::new(&[closed]).is_empty(), "streets that nobody may walk along are left out");
        assert!(StreetNet::new(&[street(&[(1.0, 1.0), (1.0, 1.0)])]).is_empty(), "a line without length is left out");
        let net = StreetNet::new(&[street(&[(0.0, 0.0), (10.0, 0.0)])]);
        assert!(net.nearest(DVec2::new(f64::NAN, 0.0)).is_none());
    }

    #[test]
    fn an_end_beside_a_long_segment_is_joined_to_its_middle() {
        let net = StreetNet::new(&[street(&[(0.0, 0.0), (100.0, 0.0)]), street(&[(50.0, 0.4), (50.0, 60.0)])]);
        assert_eq!(net.piece.iter().max(), Some(&0), "one piece");
        let apart = StreetNet::new(&[street(&[(0.0, 0.0), (100.0, 0.0)]), street(&[(50.0, 0.6), (50.0, 60.0)])]);
        assert_eq!(apart.piece.iter().max(), Some(&1), "0.6 m is a gap");
    }

    #[test]
    fn two_ends_beside_one_segment_cut_it_twice_in_order() {
        let main = street(&[(0.0, 0.0), (100.0, 0.0)]);
        let net = StreetNet::new(&[main, street(&[(70.0, 0.25), (70.0, 60.0)]), street(&[(30.0, -0.25), (30.0, -60.0)])]);
        assert_eq!(net.piece.iter().max(), Some(&0));
        let mut along: Vec<f64> =
            net.segments.iter().filter(|s| s.street == 0).map(|s| net.node(s.to).x - net.node(s.from).x).collect();
        along.sort_by(f64::total_cmp);
        assert_eq!(along, [30.0, 30.0, 40.0]);
    }

    #[test]
    fn one_walks_through_tunnels_but_gets_in_by_their_ends_alone() {
        let part = |from: f64, to: f64, layer: i8| PlanStreet { layer, ..street(&[(from, 0.0), (to, 0.0)]) };
        let net = StreetNet::new(&[part(0.0, 40.0, 0), part(40.0, 80.0, -1), part(80.0, 120.0, 0)]);
        let p = DVec2::new(55.0, 5.0);
        let nearest = net.nearest(p).expect("streets are there");
        assert_eq!((nearest.plan_pos, nearest.street), (DVec2::new(40.0, 0.0), 0));
        assert!(net.feet_by_distance(p).all(|foot| foot.street != 1));
        let way = net.way(DVec2::new(10.0, 0.0), DVec2::new(110.0, 0.0)).expect("it is connected");
        assert!(way.iter().all(|p| p.y == 0.0));
    }

    #[test]
    fn a_bridge_joins_the_ground_at_its_ends_only() {
        let ground = street(&[(0.0, 0.0), (50.0, 0.0), (100.0, 0.0)]);
        let mut bridge = street(&[(50.0, 50.0), (50.0, 0.0), (50.0, -50.0)]);
        bridge.layer = 1;
        let crossing = StreetNet::new(&[ground.clone(), bridge.clone()]);
        assert_eq!(crossing.piece.iter().max(), Some(&1), "a vertex above another is no joint");
        let ramp = street(&[(50.0, -50.0), (0.0, 0.0)]);
        assert_eq!(StreetNet::new(&[ground, bridge, ramp]).piece.iter().max(), Some(&0));
    }
}
