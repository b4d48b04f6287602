//! What carries the ways that leave the ground: spans between piers.

use core::ops::Range;

use glam::DVec2;
use rayon::prelude::*;
use veduta_city::{
    CityGraph, GridPolygon, GridPos, Link, LinkKind, MarkingKind, PlanTerrain, SpanForm, SpanMarking, SpanStation, StreetClass,
    SurfaceKind, WaySpan, metres,
};

use super::band::{pieces, stations};
use super::bridges::{Bridges, Stretch, Way};
use super::index::Index;
use super::markings::{GAUGE_M, LINE_M, lane_lines, tracks};
use super::streets::{length_m, link_surface, pavement_m, width_at_m, width_m};
use crate::mesh::bridge::{CROWN_M, KERB_M};

/// How far above the ground that it leads over on the way's own ground it begins, metres: posts of a terrain are as exact as that.
const LIFT_M: f64 = 0.02;
/// From the water to where arches spring, metres.
const SPRINGING_M: f64 = 0.35;
/// Arches rise at least so much, metres; and span so many times that, at least and at most so far.
const LEAST_RISE_M: f64 = 0.7;
const FLATTEST: f64 = 4.5;
const ARCH_M: (f64, f64) = (8.0, 22.0);
/// Widest span of a girder, metres.
const GIRDER_M: f64 = 24.0;
/// Ways narrower than this are carried by girders, metres.
const NARROWEST_ARCHED_M: f64 = 3.5;
/// Share of a bridge over water, at least, that is of stone.
const WET: f64 = 0.3;
/// Cross-sections are so far apart at most; and those nearer to one another than the second are one; metres.
const STATION_M: (f64, f64) = (6.0, 0.25);
/// Piers go so far into the ground, metres.
const FOOTING_M: f64 = 0.8;
/// Where bridges meet in the air each goes on so far, which closes the gaps between them; metres.
const MEET_M: f64 = 1.2;
/// Piers stand no closer, unless that is as wide as a bridge may span, and are moved so far to a bend; metres.
const LEAST_SPAN_M: f64 = 6.0;
const AT_BEND_M: f64 = 1.0;
/// What stands at the sides of a way reaches so far beyond them, metres; and no corner between two stations may be smaller.
const BEYOND_M: f64 = 0.8;
const LEAST_M2: f64 = 0.05;
/// Bridges no farther apart than this, and at heights that differ less than the second, are one; metres.
const JOINED_M: f64 = 0.5;
const STEP_M: f64 = 0.6;
/// It is looked so closely whether another lies beside a bridge, where that changes is found by so many halvings, and no part of a span is
/// shorter; metres.
const LOOK_M: f64 = 1.0;
const HALVINGS: u32 = 6;
const LEAST_RUN_M: f64 = 0.8;
/// Mitres at bends reach at most so many times as far as on a straight line.
const LONGEST_MITRE: f64 = 1.5;

/// The spans of all bridges, way by way. Their ends are as high as the ground there.
pub(super) fn spans(graph: &CityGraph, bridges: &Bridges, terrain: &PlanTerrain) -> Vec<WaySpan> {
    if bridges.ways.is_empty() {
        return Vec::new();
    }
    let builder = Builder { graph, terrain, below: carriageways(graph) };
    let own = |(w, way): (usize, &Way)| {
        let stretches = way.stretches.iter().filter(|stretch| !stretch.is_carried);
        stretches.flat_map(|stretch| builder.stretch(way, stretch)).map(|span| (w, span)).collect::<Vec<_>>()
    };
    let spans: Vec<(usize, WaySpan)> = bridges.ways.par_iter().enumerate().flat_map_iter(own).collect();
    let mut spans = join(&spans);
    lay_trams(graph, &mut spans, |_, layer| layer >= 0);
    spans
}

/// Lays the tracks of trams on spans that they lead along, if they are on a layer that belongs to the span.
pub(super) fn lay_trams(graph: &CityGraph, spans: &mut [WaySpan], is_on: impl Fn(&WaySpan, i8) -> bool + Sync) {
    if spans.is_empty() {
        return;
    }
    let at = graph.node_positions();
    let trams = graph.links.iter().filter(|link| link.kind == LinkKind::Railway { tram: true });
    let trams: Vec<(i8, Vec<DVec2>)> = trams.filter_map(|link| Some((link.layer, graph.polyline(link, &at)?))).collect();
    spans.par_iter_mut().for_each(|span| {
        let own = trams.iter().filter(|(layer, _)| is_on(span, *layer));
        let rails: Vec<SpanMarking> = own.filter_map(|(_, tram)| laid(tram, span)).collect();
        span.markings.extend(rails);
    });
}

/// Leaves out parapets and pavements where another way's bridge lies beside a bridge or comes into it, and lets each reach as far as the
/// other. Girders are cut where that begins and ceases; arches are joined as a whole.
fn join(spans: &[(usize, WaySpan)]) -> Vec<WaySpan> {
    let decks = Decks::new(spans.iter().enumerate().map(|(i, (_, span))| (i, span)));
    let is_beside = |way: usize, station: &SpanStation, side: f64| {
        let p = station.at(side * (station.half_m() + JOINED_M));
        let mut others = decks.0.at(GridPos::from_metres(p)).filter(|(i, _)| spans[*i].0 != way);
        others.any(|(_, other)| other.height_m(p).is_some_and(|z| (z - metres(station.z)).abs() < STEP_M))
    };
    let parts = spans.par_iter().flat_map_iter(|(way, span)| {
        let beside = |at: f64| [1.0, -1.0].map(|side| is_beside(*way, &station_at(span, at), side));
        let runs = runs(span, beside);
        let last = runs.len() - 1;
        let part = |(i, run): (usize, &Run)| {
            let piers = (span.piers.0.filter(|_| i == 0), span.piers.1.filter(|_| i == last));
            let stations = if runs.len() == 1 { span.stations.clone() } else { stations_of(span, &run.range) };
            (WaySpan { stations, piers, ..span.clone() }, run.joined)
        };
        runs.iter().enumerate().map(part).collect::<Vec<_>>()
    });
    let (mut spans, joined): (Vec<WaySpan>, Vec<[bool; 2]>) = parts.unzip();
    // A station that two spans share is as wide for both.
    let meet = |i: usize| match spans.get(i..i + 2) {
        Some([a, b]) => a.stations.last() == b.stations.first(),
        _ => false,
    };
    let next = |i: usize| if meet(i) { joined[i + 1] } else { joined[i] };
    let before = |i: usize| i.checked_sub(1).filter(|&i| meet(i)).map_or(joined[i], |before| joined[before]);
    let ends: Vec<[[bool; 2]; 2]> =
        (0..spans.len()).map(|i| [before(i), next(i)].map(|other| [joined[i][0] && other[0], joined[i][1] && other[1]])).collect();
    for ((span, [left, right]), ends) in spans.iter_mut().zip(joined).zip(ends) {
        span.parapets = (!left, !right);
        span.pavements = (if left { 0 } else { span.pavements.0 }, if right { 0 } else { span.pavements.1 });
        let last = span.stations.len() - 1;
        for (i, station) in span.stations.iter_mut().enumerate() {
            let [left, right] = if i == 0 {
                ends[0]
            } else if i == last {
                ends[1]
            } else {
                [left, right]
            };
            let half = station.half_m();
            let (to_left, to_right) = (station.at(half + JOINED_M), station.at(-half - JOINED_M));
            station.left = if left { GridPos::from_metres(to_left) } else { station.left };
            station.right = if right { GridPos::from_metres(to_right) } else { station.right };
        }
    }
    spans
}

/// A part of a span between two places on it, told by stations, on both sides of which it is the same: whether another lies beside its left
/// and its right.
struct Run {
    range: Range<f64>,
    joined: [bool; 2],
}

/// The runs of a span; of one that is not to be cut, one, which is as most of it is.
fn runs(span: &WaySpan, beside: impl Fn(f64) -> [bool; 2]) -> Vec<Run> {
    let end = (span.stations.len() - 1) as f64;
    let segment = |(i, pair): (usize, &[SpanStation])| {
        let count = (pair[0].at(0.0).distance(pair[1].at(0.0)) / LOOK_M).ceil().max(1.0);
        (0..count as u32).map(move |k| i as f64 + (f64::from(k) + 0.5) / count)
    };
    let looks: Vec<f64> = span.stations.windows(2).enumerate().flat_map(segment).collect();
    let seen: Vec<(f64, [bool; 2])> = looks.into_iter().map(|at| (at, beside(at))).collect();
    if span.form != SpanForm::Girder {
        let is_most = |side: usize| 2 * seen.iter().filter(|(_, joined)| joined[side]).count() > seen.len();
        return vec![Run { range: 0.0..end, joined: [is_most(0), is_most(1)] }];
    }
    let mut runs: Vec<Run> = Vec::new();
    for same in seen.chunk_by(|a, b| a.1 == b.1) {
        let ((first, joined), from) = (same[0], runs.last().map_or(0.0, |run| run.range.end));
        // Where it changes, found by halves.
        let (mut low, mut high) = (from, first);
        for _ in 0..if from > 0.0 { HALVINGS } else { 0 } {
            let middle = f64::midpoint(low, high);
            if beside(middle) == joined { high = middle } else { low = middle }
        }
        let from = if from > 0.0 { high } else { 0.0 };
        if let Some(before) = runs.last_mut() {
            before.range.end = from;
        }
        runs.push(Run { range: from..same[same.len() - 1].0, joined });
    }
    if let Some(last) = runs.last_mut() {
        last.range.end = end;
    }
    // What is too short to be seen goes with what comes before it, or after it at the start.
    let is_short =
        |range: &Range<f64>| station_at(span, range.start).at(0.0).distance(station_at(span, range.end).at(0.0)) < LEAST_RUN_M;
    let mut kept: Vec<Run> = Vec::new();
    for run in runs {
        match kept.last_mut() {
            Some(before) if before.joined == run.joined || is_short(&run.range) => before.range.end = run.range.end,
            Some(before) if is_short(&before.range) => *before = Run { range: before.range.start..run.range.end, ..run },
            _ => kept.push(run),
        }
    }
    kept
}

/// The cross-section of a span between two of its stations.
fn station_at(span: &WaySpan, at: f64) -> SpanStation {
    let i = (at.max(0.0) as usize).min(span.stations.len() - 2);
    let (a, b, share) = (span.stations[i], span.stations[i + 1], at - i as f64);
    let between = |p: GridPos, q: GridPos| GridPos::from_metres(p.to_metres().lerp(q.to_metres(), share));
    let z = libm::round(f64::from(a.z) + (f64::from(b.z) - f64::from(a.z)) * share) as i32;
    SpanStation { left: between(a.left, b.left), right: between(a.right, b.right), z }
}

/// The stations of a part of a span, its ends among them.
fn stations_of(span: &WaySpan, range: &Range<f64>) -> Vec<SpanStation> {
    let (first, last) = (station_at(span, range.start), station_at(span, range.end));
    let is_apart = |station: &&SpanStation| [first, last].iter().all(|end| end.at(0.0).distance(station.at(0.0)) > STATION_M.1);
    let inner = (0..).zip(&span.stations).filter(|(i, _)| range.start < f64::from(*i) && f64::from(*i) < range.end);
    let inner = inner.map(|(_, station)| station).filter(is_apart);
    core::iter::once(first).chain(inner.copied()).chain([last]).collect()
}

/// Where piers may not stand: streets and railways on the ground.
fn carriageways(graph: &CityGraph) -> Index<()> {
    let at = graph.node_positions();
    let on_ground = graph.links.iter().filter(|link| link.layer == 0 && link.kind != LinkKind::Watercourse);
    let bands = on_ground.flat_map(|link| {
        let line = graph.polyline(link, &at).unwrap_or_default();
        pieces(&stations(&line, link), |share| width_at_m(link, share) / 2.0)
    });
    Index::new(bands.map(|band| (band, ())).collect())
}

/// A tram track on a span, if it goes all along it.
fn laid(tram: &[DVec2], span: &WaySpan) -> Option<SpanMarking> {
    let (first, last) = (span.stations.first()?, span.stations.last()?);
    let left = |station: &SpanStation| {
        let (a, b) = (station.left.to_metres(), station.right.to_metres());
        let across = (a - b).try_normalize()?;
        tram.windows(2).find_map(|pair| {
            let way = pair[1] - pair[0];
            let turn = way.perp_dot(across);
            let (s, t) = ((b - pair[0]).perp_dot(across) / turn, (b - pair[0]).perp_dot(way) / turn);
            let is_met = (0.0..=1.0).contains(&s) && (0.0..=a.distance(b)).contains(&t);
            (turn.abs() > 1e-9 && is_met).then(|| GridPos::steps(t - a.distance(b) / 2.0))
        })
    };
    Some(SpanMarking { kind: MarkingKind::Rails, left: (left(first)?, left(last)?), width: GridPos::steps(GAUGE_M) })
}

struct Builder<'a> {
    graph: &'a CityGraph,
    terrain: &'a PlanTerrain,
    below: Index<()>,
}

impl Builder<'_> {
    fn stretch(&self, way: &Way, stretch: &Stretch) -> Vec<WaySpan> {
        let Range { start, end } = stretch.range.clone();
        let Some(link) = way.link_at(stretch.middle()).and_then(|(link, _)| self.graph.links.get(link)) else {
            return Vec::new();
        };
        let ground = |s: f64| way.at(s).map_or(0.0, |(p, _)| self.terrain.height_m(p));
        // What the ground is off at its ends is made up for along it.
        let is_aloft = stretch.is_aloft();
        let off = [(start, is_aloft[0]), (end, is_aloft[1])]
            .map(|(s, is_aloft)| if is_aloft { 0.0 } else { ground(s) + LIFT_M - stretch.height_m(s) });
        let height = |s: f64| stretch.height_m(s) + off[0] + (off[1] - off[0]) * (s - start) / (end - start);
        let springing = stretch.below_m + SPRINGING_M;
        let rise = height(start).min(height(end)) - CROWN_M - springing;
        let is_arched = matches!(link.kind, LinkKind::Street(class) if class != StreetClass::Motorway)
            && width_m(link) >= NARROWEST_ARCHED_M
            && rise >= LEAST_RISE_M
            && stretch.water >= WET;
        let (form, widest) = match is_arched {
            true => (SpanForm::Arches, (rise * FLATTEST).clamp(ARCH_M.0, ARCH_M.1)),
            false => (SpanForm::Girder, GIRDER_M),
        };
        let bends = bends(&way.line);
        let mut cuts = self.cuts(way, &stretch.range, widest);
        // Piers next to bends stand under them.
        let inner = 1..cuts.len() - 1;
        for cut in &mut cuts[inner] {
            *cut = bends.iter().copied().find(|&s| start < s && s < end && (s - *cut).abs() < AT_BEND_M).unwrap_or(*cut);
        }
        let places = cuts.windows(2).flat_map(|pair| places(pair[0]..pair[1], &bends).skip(usize::from(pair[0] > start)));
        let mut stations = laid_out(places.filter_map(|s| Some((s, station(self.graph, way, s, height(s))?))), &bends);
        let last = stations.len().saturating_sub(1);
        for (i, s, by) in
            [(0, start, -MEET_M), (last, end, MEET_M)].into_iter().zip(is_aloft).filter_map(|(at, is)| is.then_some(at))
        {
            let (Some((_, along)), Some((_, station))) = (way.at(s), stations.get_mut(i)) else { continue };
            let moved = |p: GridPos| GridPos::from_metres(p.to_metres() + along * by);
            (station.left, station.right) = (moved(station.left), moved(station.right));
        }
        let on_land = [(0, is_aloft[0]), (last, is_aloft[1])];
        let pier = |i: usize| {
            let is_on_land = on_land.iter().any(|&(end, is_aloft)| i == end && !is_aloft);
            let (p, _) = way.at(stations[i].0).filter(|_| !is_on_land)?;
            Some(GridPos::steps(self.terrain.height_m(p).min(stretch.below_m) - FOOTING_M))
        };
        let cuts: Vec<usize> = (0..stations.len()).filter(|&i| cuts.contains(&stations[i].0)).collect();
        let part = |pair: &[usize]| WaySpan {
            springing: GridPos::steps(springing),
            piers: (pier(pair[0]), pier(pair[1])),
            ..span(link, form, &stations[pair[0]..=pair[1]])
        };
        cuts.windows(2).map(part).collect()
    }

    /// Where the piers of a stretch stand, its ends among them: as few as can be, and out of the way of what is below.
    fn cuts(&self, way: &Way, range: &Range<f64>, widest: f64) -> Vec<f64> {
        let length = range.end - range.start;
        let least = (length / widest).ceil().max(1.0) as u32;
        let cut = |i: u32, count: u32| range.start + length * f64::from(i) / f64::from(count);
        let blocked = |count: u32| {
            let piers = (1..count).filter_map(|i| way.at(cut(i, count)));
            piers.filter(|(p, _)| self.below.at(GridPos::from_metres(*p)).next().is_some()).count()
        };
        let most = ((length / LEAST_SPAN_M) as u32).clamp(least, least + 3);
        let count = (least..=most).min_by_key(|&count| (blocked(count), count)).unwrap_or(least);
        (0..=count).map(|i| cut(i, count)).collect()
    }
}

/// The cross-section of a way at a distance along it.
pub(super) fn station(graph: &CityGraph, way: &Way, s: f64, height_m: f64) -> Option<SpanStation> {
    let (before, after) = (way.at(s - 1e-4)?, way.at(s + 1e-4)?);
    let (a, b) = (before.1, after.1);
    let mitre = (a + b).perp() / (1.0 + a.dot(b)).max(2.0 / (LONGEST_MITRE * LONGEST_MITRE));
    let (p, _) = way.at(s)?;
    let off = mitre * way.half_m(graph, s);
    let (left, right) = (GridPos::from_metres(p + off), GridPos::from_metres(p - off));
    Some(SpanStation { left, right, z: GridPos::steps(height_m) })
}

/// A span of a link's way, with what is painted on it.
pub(super) fn span(link: &Link, form: SpanForm, stations: &[(f64, SpanStation)]) -> WaySpan {
    WaySpan {
        id: link.id,
        form,
        surface: link_surface(link),
        pavements: (GridPos::steps(pavement_of(link)), GridPos::steps(pavement_of(link))),
        parapets: (true, true),
        stations: stations.iter().map(|(_, station)| *station).collect(),
        springing: 0,
        piers: (None, None),
        markings: markings(link),
    }
}

/// Those stations between which the way goes on: about sharp bends the inner ends of the others lie behind one another. The first and the
/// last stay.
pub(super) fn laid_out(stations: impl Iterator<Item = (f64, SpanStation)>, bends: &[f64]) -> Vec<(f64, SpanStation)> {
    let goes_on = |a: &SpanStation, b: &SpanStation| {
        let ends = |station: &SpanStation| [-1.0, 1.0].map(|side| station.at(side * (station.half_m() + BEYOND_M)));
        let ([a_right, a_left], [b_right, b_left]) = (ends(a), ends(b));
        let ring = [a_right, b_right, b_left, a_left];
        (0..4).all(|i| (ring[(i + 1) % 4] - ring[i]).perp_dot(ring[(i + 2) % 4] - ring[i]) > LEAST_M2)
    };
    let stations: Vec<(f64, SpanStation)> = stations.collect();
    let mut kept: Vec<(f64, SpanStation)> = Vec::new();
    for &next in &stations {
        // What lies too near before a bend goes, and what lies too near behind it.
        let fits = kept.iter().rposition(|(_, station)| goes_on(station, &next.1)).map(|i| i + 1);
        if fits.unwrap_or(0) == kept.len() || (bends.contains(&next.0) && fits.is_some()) {
            kept.truncate(fits.unwrap_or(0));
            kept.push(next);
        }
    }
    let Some(&last) = stations.last() else { return kept };
    while kept.len() > 1 && kept[kept.len() - 1].0 < last.0 {
        kept.pop();
        if goes_on(&kept[kept.len() - 1].1, &last.1) {
            kept.push(last);
        }
    }
    // Better a deck with a fold than none.
    if kept.len() > 1 { kept } else { stations }
}

/// Where a line bends, metres along it.
pub(super) fn bends(line: &[DVec2]) -> Vec<f64> {
    (1..line.len().saturating_sub(1)).map(|i| length_m(&line[..=i])).collect()
}

/// Where the cross-sections of a span are: at its ends, at the line's bends, and between.
pub(super) fn places(range: Range<f64>, bends: &[f64]) -> impl Iterator<Item = f64> {
    let near = |s: f64, t: f64| (s - t).abs() < STATION_M.1;
    let inside =
        bends.iter().copied().filter(move |&s| range.start < s && s < range.end && !near(s, range.start) && !near(s, range.end));
    let mut out = vec![range.start];
    for s in inside.chain([range.end]) {
        let from = out[out.len() - 1];
        if s < range.end && near(s, from) {
            continue;
        }
        let count = ((s - from) / STATION_M.0).ceil().max(1.0) as u32;
        out.extend((1..count).map(|i| from + (s - from) * f64::from(i) / f64::from(count)));
        out.push(s);
    }
    out.into_iter()
}

fn pavement_of(link: &Link) -> f64 {
    match link.kind {
        LinkKind::Street(class) => pavement_m(class, width_m(link)),
        _ => 0.0,
    }
}

/// Lines of lanes, and a railway's tracks.
fn markings(link: &Link) -> Vec<SpanMarking> {
    let marking = |kind, left_m: f64, width_m: f64| {
        let left = GridPos::steps(left_m);
        SpanMarking { kind, left: (left, left), width: GridPos::steps(width_m).max(1) }
    };
    match link.kind {
        LinkKind::Street(class) if class.has_carriageway() && link_surface(link) == SurfaceKind::Asphalt => {
            let half = width_m(link) / 2.0 - pavement_m(class, width_m(link));
            lane_lines(class, half).into_iter().map(|(kind, left)| marking(kind, left, LINE_M)).collect()
        }
        LinkKind::Railway { tram: false } => tracks(width_m(link)).map(|left| marking(MarkingKind::Track, left, GAUGE_M)).collect(),
        _ => Vec::new(),
    }
}

/// Where bridges and ramps are: for questions about places.
pub(super) struct Decks<'a>(Index<(usize, &'a WaySpan)>);

impl<'a> Decks<'a> {
    /// Of spans by their numbers, bores aside: what is in them is out of the way of what is above.
    pub fn new(spans: impl Iterator<Item = (usize, &'a WaySpan)>) -> Self {
        let pieces = spans
            .filter(|(_, span)| !span.is_bore())
            .flat_map(|(i, span)| span.stations.windows(2).map(move |pair| (piece(pair), (i, span))));
        Self(Index::new(pieces.collect()))
    }

    pub fn is_none(&self) -> bool {
        self.0.is_empty()
    }

    /// The bridge over a place, and how high it is there above the city's zero, metres.
    pub fn at(&self, p: DVec2) -> Option<(&'a WaySpan, f64)> {
        self.0.at(GridPos::from_metres(p)).find_map(|(_, span)| Some((*span, span.height_m(p)?)))
    }

    /// How high all bridges over a place are above the city's zero, metres.
    pub fn heights_at(&self, p: DVec2) -> impl Iterator<Item = f64> {
        self.0.at(GridPos::from_metres(p)).filter_map(move |(_, span)| span.height_m(p))
    }

    /// What lies on the bridge over a place, and how high above the city's zero, metres.
    pub fn surface(&self, p: DVec2) -> Option<(SurfaceKind, f64)> {
        let (span, height) = self.at(p)?;
        let pair = span.stations.windows(2).find(|pair| piece(pair).contains(GridPos::from_metres(p)))?;
        let distance = |a: GridPos, b: GridPos| super::outline::distance_to_edge(p, a.to_metres(), b.to_metres());
        let edges = [(pair[0].left, pair[1].left, span.pavements.0), (pair[0].right, pair[1].right, span.pavements.1)];
        let is_pavement = edges.into_iter().any(|(a, b, width)| distance(a, b) < metres(width));
        Some(if is_pavement { (SurfaceKind::Mosaic, height + KERB_M) } else { (span.surface, height) })
    }
}

fn piece(pair: &[SpanStation]) -> GridPolygon {
    GridPolygon::simple(vec![pair[0].right, pair[1].right, pair[1].left, pair[0].left])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn girders_are_cut_where_another_begins_and_ceases_to_lie_beside_them() {
        let station = |x_m: f64| SpanStation {
            left: GridPos::from_metres(DVec2::new(x_m, 3.0)),
            right: GridPos::from_metres(DVec2::new(x_m, -3.0)),
            z: 0,
        };
        let stations = vec![station(0.0), station(10.0), station(30.0)];
        let girder = WaySpan {
            id: veduta_city::Id(1),
            form: SpanForm::Girder,
            surface: SurfaceKind::Asphalt,
            pavements: (0, 0),
            parapets: (true, true),
            stations,
            springing: 0,
            piers: (None, None),
            markings: Vec::new(),
        };
        // Beside it, on its left, between two places along it.
        let cut = |span: &WaySpan, beside: &[Range<f64>]| -> Vec<(i64, bool)> {
            let at_m = |at: f64| station_at(span, at).at(0.0).x;
            let is_beside = |at: f64| [beside.iter().any(|range| range.contains(&at_m(at))), false];
            runs(span, is_beside).iter().map(|run| ((at_m(run.range.end) * 10.0).round() as i64, run.joined[0])).collect()
        };
        assert_eq!(cut(&girder, &[]), [(300, false)]);
        assert_eq!(cut(&girder, &[0.0..31.0]), [(300, true)]);
        assert_eq!(cut(&girder, &[4.0..17.0]), [(40, false), (170, true), (300, false)]);
        assert_eq!(cut(&girder, &[0.0..4.0]), [(40, true), (300, false)]);
        assert_eq!(cut(&girder, &[0.0..0.7]), [(300, false)], "too short at the start");
        assert_eq!(cut(&girder, &[29.4..31.0]), [(300, false)], "too short at the end");
        assert_eq!(cut(&girder, &[4.0..9.2, 9.8..14.0]), [(40, false), (140, true), (300, false)], "a gap too short to be seen");
        let arches = WaySpan { form: SpanForm::Arches, ..girder };
        assert_eq!(cut(&arches, &[0.0..16.0]), [(300, true)]);
        assert_eq!(cut(&arches, &[0.0..14.0]), [(300, false)]);
    }
}
