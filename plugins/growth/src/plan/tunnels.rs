//! Ways below the ground: how deep they lie, where they come out, and the ramps that lead down to them.
//!
//! Maps tell which links lie below the ground, not how deep. A tunnel keeps under everything that stands above it, comes out where its map
//! says, or farther in where a hillside or a short street leaves no room before it, and its ramps begin as near as their grade allows.

use std::collections::{HashMap, HashSet};

use glam::DVec2;
use veduta_city::{
    BoreEnd, CityGraph, Finding, GridPolygon, GridPos, Id, Link, LinkKind, PlanTerrain, Severity, SpanForm, StreetClass, WaySpan,
    metres,
};

use super::band::{self, stations};
use super::bridges::{Bridges, Stretch, Way};
use super::chains::{Chain, chains, is_way, meet};
use super::extent::Extent;
use super::facing::{self, Bodies};
use super::houses::Draft;
use super::index::Index;
use super::profile::{Floor, Sample, floor, ramps};
use super::spans::{bends, laid_out, lay_trams, places, span, station};
use super::streets::width_at_m;
use super::water::Waters;
use crate::mesh::tunnel::WALL_M;

/// From the way to the crown of its vault, metres: railways, streets with carriageways, and other ways.
const CROWN_M: [f64; 3] = [5.8, 5.0, 2.9];
/// From there to the ground at least, metres: foundations are as deep.
const COVER_M: f64 = 1.2;
/// Steepest that ways lead down, a metre for each metre: railways, motorways, other carriageways, other ways, steps; and so many times that
/// where there is no room.
const GRADE: [f64; 5] = [0.03, 0.06, 0.1, 0.14, 0.6];
const STEEPER: f64 = 1.5;
/// Ramps begin no farther from the tunnel than this, metres.
const REACH_M: f64 = 160.0;
/// Ramps do not bend at nodes by more than the angle with this cosine, as ways lie so far from there; metres.
const STRAIGHT: f64 = 0.5;
const AHEAD_M: f64 = 6.0;
/// Directions at bends are those so far on each side; metres.
const AT_BEND_M: f64 = 1e-4;
/// The ground is looked at so often along a way; metres.
const STEP_M: f64 = 1.0;
/// Spans are no longer than this; metres.
const SPAN_M: f64 = 24.0;
/// How far the ground goes on over the upper end of a ramp, metres.
const OVERLAP_M: f64 = 0.05;
/// A way's sides have so much room beyond its walls, metres.
const ROOM_M: f64 = 0.2;

/// The tunnels of a city.
#[derive(Default)]
pub(super) struct Tunnels {
    pub ways: Vec<Way>,
    pub spans: Vec<WaySpan>,
    /// Where the ground is open above ramps.
    pub openings: Vec<GridPolygon>,
    /// Links of the ways.
    links: HashSet<usize>,
}

/// What tunnels are dug under.
pub(super) struct Ground<'a> {
    pub graph: &'a CityGraph,
    pub terrain: &'a PlanTerrain,
    pub waters: &'a Waters,
    pub bridges: &'a Bridges,
    pub given: &'a [Draft],
    pub extent: &'a Extent,
}

impl Tunnels {
    /// All that can be laid; of the others a finding tells why not.
    pub fn of(ground: &Ground<'_>, findings: &mut Vec<Finding>) -> Self {
        let graph = ground.graph;
        let mut tunnels = Self::default();
        let chains = chains(graph, |link| link.layer < 0);
        if !chains.is_empty() {
            let digger = Digger::of(ground);
            for chain in &chains {
                if let Err(why) = digger.dig(chain, &mut tunnels) {
                    let link = chain.links.first().map(|&(link, _)| &graph.links[link]);
                    let what = if link.is_some_and(|link| matches!(link.kind, LinkKind::Railway { .. })) {
                        "railway tunnel"
                    } else {
                        "tunnel"
                    };
                    let message = format!("{what}: not laid, for {why}");
                    let id = link.map_or(Id::NONE, |link| link.id);
                    findings.push(Finding::new(Severity::Dropped, id, chain.line.first().copied(), message));
                }
            }
        }
        lay_trams(graph, &mut tunnels.spans, |span, layer| layer < 0 || (layer == 0 && span.is_ramp()));
        let mut buried = graph.links.iter().filter(|link| link.layer < 0).peekable();
        let at = if buried.peek().is_some() { graph.node_positions() } else { HashMap::new() };
        for link in buried {
            let what = match link.kind {
                LinkKind::Watercourse => "covered watercourse",
                LinkKind::Railway { tram: true } if !tunnels.carry(&graph.polyline(link, &at).unwrap_or_default()) => "tram tunnel",
                _ => continue,
            };
            let message = format!("{what}: not laid, for it lies below the ground");
            findings.push(Finding::new(Severity::Dropped, link.id, at.get(&link.from).copied(), message));
        }
        tunnels
    }

    /// Whether a tram's middle lies in one of the tunnels.
    fn carry(&self, tram: &[DVec2]) -> bool {
        let Some((middle, _)) = super::streets::middle_of(tram) else { return false };
        self.spans.iter().any(|span| span.height_m(middle).is_some())
    }
}

/// How a tunnel goes on beyond an end of what the map says lies below the ground.
enum Mouth {
    /// Streets on the ground: those that it alone goes on in, away from it.
    Ground(Vec<(usize, bool)>),
    /// Nothing.
    Wall,
}

struct Digger<'a> {
    ground: &'a Ground<'a>,
    houses: Bodies<'a>,
    /// Ways on the ground, with the numbers of their links.
    ways: Index<usize>,
    at: HashMap<Id, DVec2>,
    /// Numbers of the links of ways at each node.
    meet: HashMap<Id, Vec<usize>>,
}

/// What a way carries, by which it is known whether another goes on in it.
const fn traffic(link: &Link) -> u8 {
    match link.kind {
        LinkKind::Street(StreetClass::Path | StreetClass::Steps) => 0,
        LinkKind::Street(_) => 1,
        LinkKind::Railway { .. } | LinkKind::Watercourse => 2,
    }
}

impl<'a> Digger<'a> {
    fn of(ground: &'a Ground<'a>) -> Self {
        let graph = ground.graph;
        let at = graph.node_positions();
        let on_ground = graph.links.iter().enumerate().filter(|(_, link)| is_way(link) && link.layer >= 0);
        let bands = on_ground.flat_map(|(i, link)| {
            let stations = stations(&graph.polyline(link, &at).unwrap_or_default(), link);
            let parts: Vec<_> = ground.bridges.on_ground(i).into_iter().map(|part| band::part(&stations, part)).collect();
            parts
                .into_iter()
                .flat_map(move |part| band::pieces(&part, |share| width_at_m(link, share) / 2.0))
                .map(move |band| (band, i))
        });
        let ways = Index::new(bands.collect());
        Self { ground, houses: facing::bodies(ground.given), ways, at, meet: meet(graph) }
    }

    /// What lies beyond an end of what lies below the ground.
    fn mouth(&self, node: Id, inner: usize, dug: &HashSet<usize>) -> Result<Mouth, &'static str> {
        let links = &self.ground.graph.links;
        let others: Vec<usize> = self.meet.get(&node).into_iter().flatten().copied().filter(|&link| link != inner).collect();
        if others.iter().any(|&link| links[link].layer < 0) {
            return Err("it meets others below the ground");
        }
        if others.is_empty() {
            return Ok(Mouth::Wall);
        }
        let goes_on = |from: usize, to: usize, node: Id| {
            let is_straight = self.leave(from, node).dot(self.leave(to, node)) < -STRAIGHT;
            let is_free = !dug.contains(&to) && !self.ground.bridges.has(to);
            links[to].layer == 0 && traffic(&links[from]) == traffic(&links[to]) && is_straight && is_free
        };
        let (mut out, mut here, mut at, mut gone) = (Vec::new(), inner, node, 0.0);
        while gone < REACH_M {
            let next: Vec<usize> = self.meet.get(&at).into_iter().flatten().copied().filter(|&link| link != here).collect();
            let [next] = next[..] else { break };
            if !goes_on(here, next, at) || out.iter().any(|&(link, _)| link == next) {
                break;
            }
            let is_back = links[next].from != at;
            at = if is_back { links[next].from } else { links[next].to };
            gone += self.ground.graph.polyline(&links[next], &self.at).map_or(0.0, |line| super::streets::length_m(&line));
            out.push((next, is_back));
            here = next;
        }
        Ok(Mouth::Ground(out))
    }

    /// The direction in which a way leaves a node.
    fn leave(&self, link: usize, node: Id) -> DVec2 {
        let link = &self.ground.graph.links[link];
        let mut line = self.ground.graph.polyline(link, &self.at).unwrap_or_default();
        if link.from != node {
            line.reverse();
        }
        super::streets::along(&line, AHEAD_M.min(super::streets::length_m(&line) / 2.0))
            .map_or(DVec2::ZERO, |(p, _)| (p - line[0]).normalize_or_zero())
    }

    /// Lays a tunnel along a chain of links.
    fn dig(&self, chain: &Chain, tunnels: &mut Tunnels) -> Result<(), &'static str> {
        let graph = self.ground.graph;
        let (Some(ends), Some(&(first, _)), Some(&(last, _))) = (chain.ends(graph), chain.links.first(), chain.links.last()) else {
            return Err("it has no length");
        };
        let dug = &tunnels.links;
        let mouths = [self.mouth(ends[0], first, dug)?, self.mouth(ends[1], last, dug)?];
        if mouths.iter().all(|mouth| matches!(mouth, Mouth::Wall)) || ends[0] == ends[1] {
            return Err("all of it lies below the ground");
        }
        let outer = |mouth: &Mouth| match mouth {
            Mouth::Ground(links) => links.clone(),
            Mouth::Wall => Vec::new(),
        };
        let before: Vec<(usize, bool)> = outer(&mouths[0]).into_iter().rev().map(|(link, is_back)| (link, !is_back)).collect();
        let after = outer(&mouths[1]);
        let (from, to) = (before.len(), before.len() + chain.links.len());
        let links = before.into_iter().chain(chain.links.iter().copied()).chain(after).collect();
        let whole = Chain::of(graph, &self.at, links).ok_or("it has no length")?;
        let way = Way::of(graph, &self.at, whole);
        let begin = |i: usize| way.links.get(i).map_or(way.length_m, |link| link.2);
        let mapped = begin(from)..begin(to);
        let depth_m = self.crown_m(chain) + COVER_M;
        let is_wall = [0, 1].map(|end| matches!(mouths[end], Mouth::Wall));
        let mut samples = self.samples(&way);
        let dive = |samples: &[Sample]| {
            let ramps = ramps(samples, &mapped, is_wall, depth_m)?;
            Ok::<_, &'static str>((ramps, floor(samples, ramps, is_wall, depth_m)?))
        };
        let (ramps, floor) = dive(&samples).or_else(|_| {
            samples.iter_mut().for_each(|sample| sample.climb_m *= STEEPER);
            dive(&samples)
        })?;
        if self.meets(&way, &floor, depth_m, tunnels) {
            return Err("another lies too near below or above");
        }
        let laid = self.lay(&way, &floor, (ramps.map(|ramp| samples[ramp.mouth].s), is_wall), self.crown_m(chain))?;
        let [start, end] = floor.ends();
        let overlap_m = is_wall.map(|is| if is { 0.0 } else { OVERLAP_M });
        let (mut part, from) = self.part(&way, start.0.min(mapped.start)..end.0.max(mapped.end)).ok_or("it has no length")?;
        part.stretches.push(Stretch::below(start.0 - from..end.0 - from, (start.1, end.1), overlap_m));
        tunnels.openings.extend(laid.iter().enumerate().filter(|(_, span)| span.is_ramp()).flat_map(|(i, span)| {
            let longer_m = |next: Option<&WaySpan>| match next {
                None => -OVERLAP_M,
                Some(next) if next.is_ramp() => 0.0,
                Some(_) => WALL_M / 2.0,
            };
            opening(span, [longer_m(i.checked_sub(1).map(|i| &laid[i])), longer_m(laid.get(i + 1))])
        }));
        tunnels.spans.extend(laid);
        tunnels.links.extend(part.links.iter().map(|&(link, ..)| link));
        tunnels.ways.push(part);
        Ok(())
    }

    /// The links of a way that a stretch of it touches, as a way, and where that begins on it, metres.
    fn part(&self, way: &Way, range: core::ops::Range<f64>) -> Option<(Way, f64)> {
        let end = |i: usize| way.links.get(i + 1).map_or(way.length_m, |next| next.2);
        let touched = (0..way.links.len()).filter(|&i| way.links[i].2 < range.end && range.start < end(i));
        let touched: Vec<&(usize, bool, f64)> = touched.map(|i| &way.links[i]).collect();
        let links = touched.iter().map(|(link, is_back, _)| (*link, *is_back)).collect();
        Some((Way::of(self.ground.graph, &self.at, Chain::of(self.ground.graph, &self.at, links)?), touched.first()?.2))
    }

    fn crown_m(&self, chain: &Chain) -> f64 {
        let links = chain.links.iter().map(|&(link, _)| &self.ground.graph.links[link]);
        let crown = |link: &Link| match link.kind {
            LinkKind::Railway { .. } => CROWN_M[0],
            LinkKind::Street(class) if class.has_carriageway() || class == StreetClass::Service => CROWN_M[1],
            _ => CROWN_M[2],
        };
        links.map(crown).fold(0.0, f64::max)
    }

    fn samples(&self, way: &Way) -> Vec<Sample> {
        let graph = self.ground.graph;
        let own: HashSet<usize> = way.links.iter().map(|&(link, ..)| link).collect();
        let count = (way.length_m / STEP_M).ceil().max(2.0) as u32;
        let step = way.length_m / f64::from(count);
        let mut climb_m = 0.0;
        let sample = |i: u32| {
            let s = step * f64::from(i);
            let (p, along) = way.at(s)?;
            let half = way.half_m(graph, s);
            let room = half + WALL_M + ROOM_M;
            let across = |share: f64, reach: f64| p + along.perp() * (reach * share);
            let is_blocked = [-1.0, -0.5, 0.0, 0.5, 1.0].into_iter().any(|share| {
                let pos = GridPos::from_metres(across(share, room));
                !self.ground.extent.holds(pos)
                    || self.ways.at(pos).any(|link| !own.contains(link))
                    || self.houses.at(pos).next().is_some()
                    || self.ground.waters.depth_m(pos).is_some()
            });
            let below =
                |q: DVec2| self.ground.terrain.height_m(q) - self.ground.waters.depth_m(GridPos::from_metres(q)).unwrap_or(0.0);
            let low_m =
                [-1.0, -0.5, 0.0, 0.5, 1.0].into_iter().map(|share| below(across(share, half))).fold(f64::INFINITY, f64::min);
            let here = climb_m;
            climb_m += step * way.link_at(s).map_or(GRADE[0], |(link, _)| grade(&graph.links[link]));
            Some(Sample { s, ground_m: self.ground.terrain.height_m(p), low_m, climb_m: here, is_blocked })
        };
        (0..=count).filter_map(sample).collect()
    }

    /// Whether another tunnel lies so near above or below that there is no room.
    fn meets(&self, way: &Way, floor: &Floor, depth_m: f64, tunnels: &Tunnels) -> bool {
        let [start, end] = floor.ends();
        let count = ((end.0 - start.0) / STEP_M).ceil().max(1.0) as u32;
        let places: Vec<(f64, DVec2, DVec2)> = (0..=count)
            .filter_map(|i| {
                let s = start.0 + (end.0 - start.0) * f64::from(i) / f64::from(count);
                let (p, along) = way.at(s)?;
                Some((floor.at(s), p, along.perp() * (way.half_m(self.ground.graph, s) + WALL_M)))
            })
            .collect();
        let about = |points: &mut dyn Iterator<Item = DVec2>| {
            points.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
        };
        let (low, high) = about(&mut places.iter().flat_map(|&(_, p, side)| [p - side, p + side]));
        let is_near = |span: &&WaySpan| {
            let (l, h) = about(&mut span.stations.iter().flat_map(|station| [station.left, station.right]).map(GridPos::to_metres));
            l.cmple(high).all() && low.cmple(h).all()
        };
        // Whatever lies lower keeps so far under the other.
        let is_over = |span: &WaySpan, (z, p, side): (f64, DVec2, DVec2), other_m: f64| {
            let count = (side.length() / STEP_M).ceil().max(1.0);
            let across = (-(count as i32)..=count as i32).map(|i| p + side * (f64::from(i) / count));
            across
                .into_iter()
                .filter_map(|p| span.height_m(p))
                .any(|other| if z < other { other - z < depth_m } else { z - other < other_m })
        };
        let is_met = |span: &WaySpan| {
            let SpanForm::Bore { crown, .. } = span.form else {
                return places.iter().any(|place| is_over(span, *place, f64::INFINITY));
            };
            places.iter().any(|place| is_over(span, *place, metres(crown) + COVER_M))
        };
        tunnels.spans.iter().filter(is_near).any(is_met)
    }

    fn lay(
        &self,
        way: &Way,
        floor: &Floor,
        (mouths, is_wall): ([f64; 2], [bool; 2]),
        crown_m: f64,
    ) -> Result<Vec<WaySpan>, &'static str> {
        let [start, end] = floor.ends().map(|end| end.0);
        let bends = bends(&way.line);
        let mut cuts = vec![start];
        for to in [mouths[0], mouths[1], end] {
            let from = cuts[cuts.len() - 1];
            let count = ((to - from) / SPAN_M).ceil() as u32;
            cuts.extend((1..=count).map(|i| if i == count { to } else { from + (to - from) * f64::from(i) / f64::from(count) }));
        }
        let mut kinks: Vec<f64> = bends.iter().copied().chain(floor.0.iter().map(|kink| kink.0)).collect();
        kinks.sort_by(f64::total_cmp);
        let all = cuts.windows(2).flat_map(|pair| places(pair[0]..pair[1], &kinks).skip(usize::from(pair[0] > start)));
        let all: Vec<_> = all.filter_map(|s| Some((s, station(self.ground.graph, way, s, floor.at(s))?))).collect();
        let stations = laid_out(all.iter().copied(), &bends);
        // Ramps follow their streets from side to side.
        let is_open = |s: f64| (start..mouths[0]).contains(&s) || (mouths[1]..end).contains(&s);
        let is_cut = all.iter().any(|place| is_open(place.0) && !stations.contains(place));
        let is_sharp = |s: f64| Some(way.at(s - AT_BEND_M)?.1.dot(way.at(s + AT_BEND_M)?.1) < STRAIGHT);
        if is_cut || bends.iter().any(|&s| is_open(s) && is_sharp(s) == Some(true)) {
            return Err("it bends too sharply before it is covered");
        }
        let kept: Vec<usize> = (0..stations.len()).filter(|&i| cuts.contains(&stations[i].0)).collect();
        let is_kept = |s: f64| kept.iter().any(|&i| stations[i].0 == s);
        if ![start, mouths[0], mouths[1], end].into_iter().all(is_kept) {
            return Err("it bends too sharply where it is covered");
        }
        let laid = |pair: &[usize]| {
            let (from, to) = (stations[pair[0]].0, stations[pair[1]].0);
            let (link, _) = way.link_at((from + to) / 2.0)?;
            let is_bore = mouths[0] <= from && to <= mouths[1];
            let end = |s: f64, mouth: usize| match s == mouths[mouth] {
                false => BoreEnd::Bore,
                true if is_wall[mouth] => BoreEnd::Wall,
                true => BoreEnd::Portal,
            };
            let form = match is_bore {
                true => SpanForm::Bore { crown: GridPos::steps(crown_m), ends: (end(from, 0), end(to, 1)) },
                false => SpanForm::Ramp,
            };
            Some(span(&self.ground.graph.links[link], form, &stations[pair[0]..=pair[1]]))
        };
        Ok(kept.windows(2).filter_map(laid).collect())
    }
}

/// Where the ground is open above a ramp, which is longer by so much at its start and at its end; metres.
fn opening(ramp: &WaySpan, longer_m: [f64; 2]) -> Vec<GridPolygon> {
    let sides = |i: usize, by: f64| {
        let (here, next) = (&ramp.stations[i], &ramp.stations[if i == 0 { 1 } else { i - 1 }]);
        let off = (here.at(0.0) - next.at(0.0)).normalize_or_zero() * by;
        let half = here.half_m() + WALL_M / 2.0;
        [here.at(-half) + off, here.at(half) + off]
    };
    let last = ramp.stations.len() - 1;
    let at = |i: usize| match i {
        0 => sides(i, longer_m[0]),
        _ if i == last => sides(i, longer_m[1]),
        _ => sides(i, 0.0),
    };
    let piece = |i: usize| {
        let ([a, b], [c, d]) = (at(i - 1), at(i));
        GridPolygon::simple([a, c, d, b].map(GridPos::on_plan).to_vec())
    };
    (1..=last).map(piece).collect()
}

const fn grade(link: &Link) -> f64 {
    match link.kind {
        LinkKind::Railway { .. } | LinkKind::Watercourse => GRADE[0],
        LinkKind::Street(StreetClass::Motorway) => GRADE[1],
        LinkKind::Street(StreetClass::Steps) => GRADE[4],
        LinkKind::Street(class) if class.has_carriageway() => GRADE[2],
        LinkKind::Street(_) => GRADE[3],
    }
}
