//! Ways to nodes and links: clipped to the extent, split wherever ways of one kind share a node.

use std::collections::{BTreeMap, HashMap};

use glam::DVec2;
use veduta_city::{Id, Link, LinkKind, Node, Severity};

use crate::extent::Extent;
use crate::lines::{Bounding, Line, line_of};
use crate::log::Log;
use crate::osm::{OsmData, Way, way_id};
use crate::shapes::{place_of, use_of};

/// Vertices closer than this are one, in metres.
const WELD_M: f64 = 0.01;

/// Nodes and links of a city, and for every link how it bounds blocks.
#[derive(Debug, Default)]
pub(crate) struct Network {
    pub nodes: Vec<Node>,
    pub links: Vec<Link>,
    pub bounds: Vec<Bounding>,
}

/// A vertex of a way: a node of the file, or the point where the way leaves the extent.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Vertex {
    node: Option<i64>,
    pos: DVec2,
}

/// Streets meet streets, rails rails, and water water; a level crossing splits neither.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum System {
    Street,
    Railway,
    Water,
}

pub(crate) fn system_of(kind: LinkKind) -> System {
    match kind {
        LinkKind::Street(_) => System::Street,
        LinkKind::Railway { .. } => System::Railway,
        LinkKind::Watercourse => System::Water,
    }
}

/// Builds the network of a file.
pub(crate) fn network(data: &OsmData, extent: &Extent, log: &mut Log) -> Network {
    let mut lines: Vec<(i64, &Way, Line)> = Vec::new();
    for (&number, way) in &data.ways {
        // Closed ways that are areas (squares, river banks) are no lines.
        if way.tags.is_empty() || (way.is_closed() && use_of(&way.tags).is_some()) {
            continue;
        }
        if let Some(line) = line_of(&way.tags, way_id(number), log) {
            lines.push((number, way, line));
        }
    }
    let mut uses: HashMap<(System, i64), u32> = HashMap::new();
    for (_, way, line) in &lines {
        for pair in way.nodes.windows(2) {
            // Each time a way passes through a node; a closed way's ends count twice, as they should not split it alone.
            if let [a, b] = pair
                && a != b
            {
                *uses.entry((system_of(line.kind), *a)).or_default() += 1;
                *uses.entry((system_of(line.kind), *b)).or_default() += 1;
            }
        }
    }
    let mut builder = Builder::default();
    for (number, way, line) in &lines {
        let id = way_id(*number);
        let runs = runs(way, data, extent, id, log);
        if runs.is_empty() {
            // Ways that lost vertices are told one by one.
            if way.nodes.iter().all(|n| data.nodes.contains_key(n)) {
                log.tally(Severity::Dropped, id, place_of(way, data, extent), "ways lie outside the extent or have no length");
            }
            continue;
        }
        let mut own = Some(id);
        for run in runs {
            // Inside a way each pass counts two: more than that is another pass or another way's end.
            let splits = |v: &Vertex| v.node.is_some_and(|n| uses.get(&(system_of(line.kind), n)).is_some_and(|&u| u > 2));
            for piece in split(&run, splits) {
                builder.add(&piece, line, own.take().unwrap_or(Id::NONE), log);
            }
        }
    }
    builder.network()
}

/// The pieces of a way that lie in the extent and whose nodes the file holds.
fn runs(way: &Way, data: &OsmData, extent: &Extent, id: Id, log: &mut Log) -> Vec<Vec<Vertex>> {
    let (mut runs, mut run, mut missing, mut is_clipped) = (Vec::new(), Vec::<Vertex>::new(), 0_usize, false);
    let mut before: Option<Vertex> = None;
    for &number in &way.nodes {
        let Some(node) = data.nodes.get(&number) else {
            missing += 1;
            before = None;
            runs.push(core::mem::take(&mut run));
            continue;
        };
        let here = Vertex { node: Some(number), pos: extent.plan_pos(node) };
        if let Some(last) = before
            && let Some((enter, leave)) = clip(last.pos, here.pos, extent)
        {
            is_clipped |= enter > 0.0 || leave < 1.0;
            let at = |t: f64| Vertex { node: None, pos: last.pos.lerp(here.pos, t) };
            if run.is_empty() || enter > 0.0 {
                runs.push(core::mem::take(&mut run));
                run.push(if enter > 0.0 { at(enter) } else { last });
            }
            run.push(if leave < 1.0 { at(leave) } else { here });
            if leave < 1.0 {
                runs.push(core::mem::take(&mut run));
            }
        } else if before.is_some() {
            is_clipped = true;
            runs.push(core::mem::take(&mut run));
        }
        before = Some(here);
    }
    runs.push(run);
    for run in &mut runs {
        weld(run);
    }
    runs.retain(|r| r.len() >= 2);
    if missing > 0 && !runs.is_empty() {
        let message = format!("{missing} of {} vertices are not in the file: the pieces that are there are kept", way.nodes.len());
        log.repaired(id, place_of(way, data, extent), message);
    } else if missing > 0 {
        log.dropped(id, place_of(way, data, extent), format!("{missing} of {} vertices are not in the file", way.nodes.len()));
    } else if is_clipped && !runs.is_empty() {
        log.tally(Severity::Repaired, id, place_of(way, data, extent), "ways are cut off at the extent's border");
    }
    runs
}

/// Drops vertices that repeat the one before; ends that are nodes stay.
fn weld(run: &mut Vec<Vertex>) {
    let last = run.last().copied();
    run.dedup_by(|b, a| a.pos.distance(b.pos) < WELD_M);
    if let (Some(kept), Some(last)) = (run.last_mut(), last)
        && kept.pos.distance(last.pos) < WELD_M
        && last.node.is_some()
    {
        *kept = last;
    }
}

/// The part of a segment inside the extent, as fractions of it (Liang and Barsky 1984); `None` if there is none.
pub(crate) fn clip(a: DVec2, b: DVec2, extent: &Extent) -> Option<(f64, f64)> {
    let (d, mut enter, mut leave) = (b - a, 0.0_f64, 1.0_f64);
    let sides = [(-d.x, a.x - extent.low.x), (d.x, extent.high.x - a.x), (-d.y, a.y - extent.low.y), (d.y, extent.high.y - a.y)];
    for (p, q) in sides {
        if p == 0.0 {
            if q < 0.0 {
                return None;
            }
        } else if p < 0.0 {
            enter = enter.max(q / p);
        } else {
            leave = leave.min(q / p);
        }
    }
    (enter < leave).then_some((enter, leave))
}

/// Cuts a run at the vertices where it meets others; a ring that meets none is cut in two.
fn split(run: &[Vertex], splits: impl Fn(&Vertex) -> bool) -> Vec<Vec<Vertex>> {
    let mut pieces = Vec::new();
    let mut piece: Vec<Vertex> = Vec::new();
    for (i, vertex) in run.iter().enumerate() {
        piece.push(*vertex);
        if i > 0 && i + 1 < run.len() && splits(vertex) {
            pieces.push(core::mem::replace(&mut piece, vec![*vertex]));
        }
    }
    pieces.push(piece);
    let mut out = Vec::with_capacity(pieces.len());
    for mut piece in pieces {
        let is_ring = piece.len() > 3 && piece.first().zip(piece.last()).is_some_and(|(a, b)| a.node.is_some() && a.node == b.node);
        if is_ring {
            let rest = piece.split_off(piece.len() / 2);
            let mut second: Vec<Vertex> = piece.last().copied().into_iter().collect();
            second.extend(rest);
            out.push(piece);
            out.push(second);
        } else {
            out.push(piece);
        }
    }
    out
}

#[derive(Default)]
struct Builder {
    nodes: BTreeMap<Id, DVec2>,
    links: Vec<(Link, Bounding)>,
}

impl Builder {
    fn node(&mut self, vertex: &Vertex) -> Id {
        let id = vertex.node.map_or_else(|| Id::from_place("edge", vertex.pos), |n| Id::from_source(1, n as u64));
        self.nodes.entry(id).or_insert(vertex.pos);
        id
    }

    fn add(&mut self, piece: &[Vertex], line: &Line, id: Id, log: &mut Log) {
        let (Some(first), Some(last)) = (piece.first(), piece.last()) else { return };
        let length_m: f64 = piece.windows(2).map(|w| w[0].pos.distance(w[1].pos)).sum();
        let (from, to) = (self.node(first), self.node(last));
        if from == to || length_m < WELD_M {
            log.tally(Severity::Dropped, id, Some(first.pos), "pieces of ways begin and end at one point");
            return;
        }
        let via = piece.get(1..piece.len() - 1).unwrap_or_default().iter().map(|v| v.pos).collect();
        let link = Link {
            id,
            from,
            to,
            via,
            kind: line.kind,
            width_m: line.width_m,
            profile: Vec::new(),
            name: line.name.clone(),
            layer: line.layer,
            surfacing: line.surfacing,
        };
        self.links.push((link, line.bounding));
    }

    fn network(self) -> Network {
        let used: std::collections::BTreeSet<Id> = self.links.iter().flat_map(|(l, _)| [l.from, l.to]).collect();
        let nodes = self.nodes.into_iter().filter(|(id, _)| used.contains(id)).map(|(id, pos)| Node { id, pos, z: 0.0 }).collect();
        let (links, bounds) = self.links.into_iter().unzip();
        Network { nodes, links, bounds }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::osm::{Bounds, Tags};

    /// A cross of two streets over nodes 1–5, 3 in the middle, with side streets as given.
    fn data(ways: &[(i64, &[i64], &[(&str, &str)])]) -> OsmData {
        let mut data = OsmData::default();
        for (id, lat, lon) in
            [(1, 0.0, -0.001), (2, 0.0, -0.0005), (3, 0.0, 0.0), (4, 0.0, 0.001), (5, 0.001, 0.0), (6, -0.001, 0.0)]
        {
            data.add_node(id, lat, lon, Tags::default());
        }
        data.add_node(7, 0.0, 0.1, Tags::default());
        data.bounds = Some(Bounds { south: -0.0015, west: -0.0015, north: 0.0015, east: 0.0015 });
        for &(id, nodes, tags) in ways {
            data.ways.insert(id, Way { nodes: nodes.to_vec(), tags: tags.iter().copied().collect() });
        }
        data
    }

    fn built(data: &OsmData) -> (Network, Vec<veduta_city::Finding>) {
        let mut log = Log::default();
        let extent = Extent::of(data, &mut log).unwrap();
        (network(data, &extent, &mut log), log.finish())
    }

    const LANE: &[(&str, &str)] = &[("highway", "pedestrian"), ("name", "Lane")];

    #[test]
    fn streets_are_split_where_they_share_a_node_and_only_there() {
        let data = data(&[(10, &[1, 2, 3, 4], LANE), (11, &[5, 3, 6], LANE)]);
        let (net, findings) = built(&data);
        assert_eq!((net.links.len(), net.nodes.len()), (4, 5), "{findings:?}");
        assert_eq!(net.links[0].id, Id::from_source(2, 10));
        assert_eq!((net.links[0].via.len(), net.links[1].id), (1, Id::NONE));
    }

    #[test]
    fn an_end_in_the_middle_of_another_street_splits_it() {
        let (net, _) = built(&data(&[(10, &[1, 2, 3, 4], LANE), (11, &[5, 3], LANE)]));
        assert_eq!(net.links.len(), 3);
    }

    #[test]
    fn two_streets_end_to_end_are_not_split_further() {
        let (net, _) = built(&data(&[(10, &[1, 2, 3], LANE), (11, &[3, 4], LANE)]));
        assert_eq!(net.links.len(), 2);
    }

    #[test]
    fn a_level_crossing_splits_neither() {
        let (net, _) = built(&data(&[(10, &[1, 3, 4], LANE), (11, &[5, 3, 6], &[("railway", "tram")])]));
        assert_eq!(net.links.len(), 2);
    }

    #[test]
    fn a_roundabout_alone_becomes_two_links() {
        let (net, _) = built(&data(&[(10, &[1, 5, 4, 6, 1], LANE)]));
        assert_eq!(net.links.len(), 2);
        assert!(net.links.iter().all(|l| l.from != l.to));
        let (net, _) = built(&data(&[(10, &[1, 5, 4, 6, 1], LANE), (11, &[5, 3], LANE), (12, &[6, 3], LANE)]));
        assert_eq!(net.links.len(), 5, "three pieces of the ring, since its beginning is a node too, and two spokes");
    }

    #[test]
    fn missing_vertices_leave_the_pieces_that_are_there() {
        let (net, findings) = built(&data(&[(10, &[1, 2, 99, 3, 4], LANE)]));
        assert_eq!(net.links.len(), 2);
        assert!(findings.iter().any(|f| f.severity == Severity::Repaired && f.message.contains("1 of 5 vertices")), "{findings:?}");
    }

    #[test]
    fn a_ferry_road_is_cut_at_the_border() {
        let (net, findings) = built(&data(&[(10, &[3, 4, 7], LANE)]));
        let far = net.nodes.iter().map(|n| n.pos.x).fold(0.0, f64::max);
        assert!((far - (0.0015 * 111_319.5 + 50.0)).abs() < 0.1, "{far}");
        assert!(findings.iter().any(|f| f.message.contains("cut off at the extent's border")), "{findings:?}");
    }
}
