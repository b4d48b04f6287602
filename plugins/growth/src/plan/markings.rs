//! What is painted on carriageways, and the rails of trams and railways.
//!
//! Where a street's kerbs come clear of its neighbours' at a crossroads, a zebra crossing may lie; behind it the stop line of those
//! that wait for a main street; between both ends the lines along it. Lines are cut into pieces of whole repeats of their dashes,
//! so that each belongs to a cell and the dashes still go on.

use core::ops::Range;

use glam::DVec2;
use rustc_hash::FxHashMap;
use veduta_city::{CityGraph, GridPos, Id, Link, LinkKind, Marking, MarkingKind, StreetClass, SurfaceKind};

use super::bridges::Bridges;
use super::network::{Junction, Network, STOP_M, Street, TWO_LANES_M, ZEBRA_M};
use super::objects::Site;
use super::streets::{along, length_m, width_m};

/// Lines are cut into pieces this long: whole repeats of [`veduta_city::Marking::DASH_M`]; metres.
const PIECE_M: f64 = 3.0 * (Marking::DASH_M + Marking::GAP_M);
/// Breadth of lines along a street, metres.
pub(super) const LINE_M: f64 = 0.125;
/// Carriageways from this width on have four lanes, metres.
const FOUR_LANES_M: f64 = 12.4;
/// Lines shorter than this are left out; metres.
const LEAST_M: f64 = 3.0;
/// Gauge of rails, and distance between the middles of tracks side by side; metres.
pub(super) const GAUGE_M: f64 = 1.435;
const TRACK_M: f64 = 4.0;
/// Most tracks of one railway.
const MOST_TRACKS: f64 = 12.0;
/// What lies under a railway is looked at in steps of this length, metres.
const CROSSING_STEP_M: f64 = 1.5;

/// All markings, in the order of links.
pub(super) fn markings(graph: &CityGraph, network: &Network<'_>, bridges: &Bridges, site: &Site<'_>) -> Vec<Marking> {
    let numbers: FxHashMap<Id, usize> = graph.links.iter().enumerate().map(|(i, link)| (link.id, i)).collect();
    let on_ground = |link: &Link| numbers.get(&link.id).map_or_else(Vec::new, |&i| bridges.on_ground(i));
    let mut marks = Marks { site, out: Vec::new() };
    network.junctions.iter().for_each(|junction| crossing(junction, &network.streets, &mut marks));
    network.streets.iter().for_each(|street| lines(street, &on_ground(street.link), &mut marks));
    let at = graph.node_positions();
    for link in graph.links.iter().filter(|link| link.layer >= 0) {
        let LinkKind::Railway { tram } = link.kind else { continue };
        let line = graph.polyline(link, &at).unwrap_or_default();
        if tram {
            for range in marks.off_bridges(&line) {
                marks.pieces(MarkingKind::Rails, &line, range, 0.0, GAUGE_M);
            }
            continue;
        }
        let parts = on_ground(link);
        tracks(width_m(link)).for_each(|left| marks.railway(&line, &parts, left));
    }
    marks.out
}

/// Zebras and stop lines of a node.
fn crossing(junction: &Junction, streets: &[Street<'_>], marks: &mut Marks<'_, '_>) {
    for arm in &junction.arms {
        let (end, street) = (arm.end, &streets[arm.end.street]);
        if let Some(zebra) = arm.zebra_m {
            let side = |left: f64| street.at(end.is_start, zebra + ZEBRA_M / 2.0, left * (arm.half_m - 0.25));
            if let (Some(a), Some(b)) = (side(1.0), side(-1.0)) {
                marks.add(MarkingKind::Zebra, &[a, b], ZEBRA_M);
            }
        }
        if let Some(stop) = arm.stop_m {
            // Who comes keeps to the right: on the left of the way out.
            let side = |left: f64| street.at(end.is_start, stop, left);
            if let (Some(a), Some(b)) = (side(0.1), side(arm.half_m - 0.25)) {
                marks.add(MarkingKind::Line, &[a, b], STOP_M);
            }
        }
    }
}

/// Lines along a street, but where crossroads leave none, and bridges, which have their own. `on_ground`: shares of its length.
fn lines(street: &Street<'_>, on_ground: &[Range<f64>], marks: &mut Marks<'_, '_>) {
    let (from, to) = (street.taken_m[0], street.length_m - street.taken_m[1]);
    let half = (0..=8).map(|i| street.half_m(f64::from(i) / 8.0)).fold(f64::INFINITY, f64::min);
    if to - from < LEAST_M {
        return;
    }
    for part in on_ground {
        let range = from.max(part.start * street.length_m)..to.min(part.end * street.length_m);
        for (kind, left_m) in lane_lines(street.class, half) {
            marks.pieces(kind, &street.line, range.clone(), left_m, LINE_M);
        }
    }
}

/// The lines along a carriageway half so wide, and how far to the left of its middle each is; metres.
pub(super) fn lane_lines(class: StreetClass, half: f64) -> Vec<(MarkingKind, f64)> {
    use MarkingKind::{Dashes, Line};
    match class {
        _ if 2.0 * half < TWO_LANES_M => Vec::new(),
        StreetClass::Motorway => vec![(Line, 0.5 - half), (Line, half - 0.5), (Dashes, 0.0)],
        StreetClass::Main if 2.0 * half >= FOUR_LANES_M => {
            vec![(Line, -0.15), (Line, 0.15), (Dashes, -half / 2.0), (Dashes, half / 2.0)]
        }
        StreetClass::Main => vec![(Dashes, 0.0)],
        _ => Vec::new(),
    }
}

/// How far to the left of a railway's middle each of its tracks is, by its width; metres.
pub(super) fn tracks(width_m: f64) -> impl Iterator<Item = f64> {
    let count = (width_m / TRACK_M).floor().clamp(1.0, MOST_TRACKS);
    (0..count as u32).map(move |i| (f64::from(i) - (count - 1.0) / 2.0) * TRACK_M)
}

struct Marks<'a, 'b> {
    site: &'a Site<'b>,
    out: Vec<Marking>,
}

impl Marks<'_, '_> {
    /// Adds a railway's track to the left of a line: on sleepers where ballast lies, even with the paving where a street crosses.
    fn railway(&mut self, line: &[DVec2], on_ground: &[Range<f64>], left_m: f64) {
        let length = length_m(line);
        let kind = |s: f64| {
            on_ground.iter().find(|part| part.contains(&(s / length)))?;
            let (p, way) = along(line, s.min(length))?;
            let (surface, z) = self.site.surface(p + way.perp() * left_m)?;
            match surface {
                SurfaceKind::Ballast => Some((MarkingKind::Track, z)),
                _ => surface.is_public().then_some((MarkingKind::Rails, z)),
            }
        };
        // Told by steps; runs of one kind are laid piece by piece.
        let count = (length / CROSSING_STEP_M).ceil().max(1.0);
        let kinds: Vec<Option<(MarkingKind, i32)>> = (0..count as usize).map(|i| kind((i as f64 + 0.5) * length / count)).collect();
        let mut first = 0;
        for run in kinds.chunk_by(|a, b| a == b) {
            let range = first as f64 * length / count..(first + run.len()) as f64 * length / count;
            first += run.len();
            if let Some((kind, z)) = run[0] {
                pieces(range).for_each(|(from, to)| self.put(kind, &beside(line, from, to, left_m), GAUGE_M, z));
            }
        }
    }

    /// Adds a marking if all of it lies on a carriageway.
    fn add(&mut self, kind: MarkingKind, line: &[DVec2], width_m: f64) {
        let is_on = |p: DVec2| {
            self.site
                .surface(p)
                .is_some_and(|(surface, z)| z == 0 && (surface == SurfaceKind::Asphalt || kind == MarkingKind::Rails))
        };
        let middles = line.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0);
        if !line.iter().copied().chain(middles).all(is_on) {
            return;
        }
        self.put(kind, line, width_m, 0);
    }

    fn put(&mut self, kind: MarkingKind, line: &[DVec2], width_m: f64, z: i32) {
        let mut points: Vec<GridPos> = line.iter().map(|&p| GridPos::on_plan(p)).collect();
        points.dedup();
        if points.len() > 1 {
            self.out.push(Marking { kind, line: points, width: GridPos::steps(width_m).max(1), z });
        }
    }

    /// Adds a line to the left of another, over some of its length, piece by piece.
    fn pieces(&mut self, kind: MarkingKind, line: &[DVec2], range: Range<f64>, left_m: f64, width_m: f64) {
        pieces(range).for_each(|(from, to)| self.add(kind, &beside(line, from, to, left_m), width_m));
    }

    /// The parts of a line that lie on no bridge, from one place along it to another.
    fn off_bridges(&self, line: &[DVec2]) -> Vec<Range<f64>> {
        let range = 0.0..length_m(line);
        if self.site.decks.is_none() {
            return vec![range];
        }
        let count = ((range.end - range.start) / CROSSING_STEP_M).ceil().max(1.0) as usize;
        let place = |i: usize| range.start + (range.end - range.start) * i as f64 / count as f64;
        let is_on_bridge = |i: usize| {
            let here = [place(i), place(i + 1)].map(|s| along(line, s).is_some_and(|(p, _)| self.site.deck(p).is_some()));
            here[0] || here[1]
        };
        let steps: Vec<bool> = (0..count).map(is_on_bridge).collect();
        let (mut first, mut out) = (0, Vec::new());
        for run in steps.chunk_by(|a, b| a == b) {
            let range = place(first)..place(first + run.len());
            first += run.len();
            out.extend((!run[0]).then_some(range));
        }
        out
    }
}

/// A length in pieces, of which the last takes a rest that would be too short for itself.
fn pieces(range: Range<f64>) -> impl Iterator<Item = (f64, f64)> {
    let mut start = range.start;
    core::iter::from_fn(move || {
        let from = start;
        start = if range.end - from < PIECE_M + LEAST_M { range.end } else { from + PIECE_M };
        (from < range.end).then_some((from, start))
    })
}

/// A line from one arc length to another, moved to the left; its bends are mitred.
fn beside(line: &[DVec2], from_m: f64, to_m: f64, left_m: f64) -> Vec<DVec2> {
    let mut out = Vec::new();
    let mut gone = 0.0;
    let ways: Vec<DVec2> = line.windows(2).map(|e| (e[1] - e[0]).normalize_or_zero()).collect();
    for (i, e) in line.windows(2).enumerate() {
        let (length, left) = (e[0].distance(e[1]), ways[i].perp() * left_m);
        let (start, end) = (gone, gone + length);
        if end > from_m && start < to_m {
            if out.is_empty() {
                out.push(e[0].lerp(e[1], ((from_m - start) / length).max(0.0)) + left);
            }
            if end >= to_m {
                out.push(e[0].lerp(e[1], (to_m - start) / length) + left);
                break;
            }
            let next = ways.get(i + 1).copied().unwrap_or(ways[i]);
            let mitre = (ways[i] + next).perp() / (1.0 + ways[i].dot(next)).max(0.3);
            out.push(e[1] + mitre * left_m);
        }
        gone = end;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{Stock, grow};

    fn grown(links: &str) -> Vec<Marking> {
        let text = format!(
            "(name: \"T\", anchor: (lat: 50, lon: 14), seed: 3,
              nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (120, 0)), (id: 3, pos: (-120, 0)), (id: 4, pos: (0, 120)), (id: 5, pos: (5, -120))],
              links: [{links}])"
        );
        let graph: CityGraph = veduta_city::file::parse(&text, "t").unwrap_or_else(|e| panic!("{e}"));
        grow(&graph, &Stock::new()).unwrap_or_else(|e| panic!("{e}")).plan.markings
    }

    fn count(of: &[Marking], kind: MarkingKind) -> usize {
        of.iter().filter(|m| m.kind == kind).count()
    }

    #[test]
    fn a_main_street_has_zebras_and_those_that_meet_it_stop() {
        let cross = "(from: 1, to: 2, kind: Street(Main)), (from: 3, to: 1, kind: Street(Main)),
            (from: 1, to: 4, kind: Street(Street)), (from: 5, to: 1, kind: Street(Street))";
        let all = grown(cross);
        assert_eq!(count(&all, MarkingKind::Zebra), 4);
        let stops: Vec<&Marking> = all.iter().filter(|m| m.kind == MarkingKind::Line && m.width > 300).collect();
        assert_eq!(stops.len(), 2);
        // Who comes from the north keeps to the west side, who comes from the south to the east side.
        for stop in stops {
            let middle = (stop.line[0].to_metres() + stop.line[1].to_metres()) / 2.0;
            assert!((middle.y > 0.0) == (middle.x < 0.0), "{middle}");
        }
        assert!(count(&all, MarkingKind::Dashes) >= 6, "centre lines along the main street");
        for m in all.iter().filter(|m| m.kind == MarkingKind::Dashes) {
            assert!(m.line.iter().all(|p| p.to_metres().length() > 8.0), "no line within the crossroads: {m:?}");
        }
    }

    #[test]
    fn setts_are_not_painted_and_trams_have_rails_anywhere() {
        let old =
            "(from: 1, to: 2, kind: Street(Main), surfacing: Cobbles), (from: 3, to: 1, kind: Street(Main), surfacing: Cobbles),
            (from: 1, to: 4, kind: Street(Lane))";
        assert_eq!(grown(old), []);
        let all = grown(&format!("{old}, (from: 3, to: 2, kind: Railway(tram: true))"));
        assert_eq!(count(&all, MarkingKind::Rails), 9);
        assert_eq!(all.len(), 9);
        let length: f64 = all.iter().map(|m| m.line[0].to_metres().distance(m.line[1].to_metres())).sum();
        assert!((length - 240.0).abs() < 0.01, "{length}");
    }

    #[test]
    fn rails_have_no_gap_at_any_length() {
        for length in [1.0, 2.0, 5.0, 26.0, 27.0, 28.0, 29.0, 30.0, 31.0, 55.5, 60.0] {
            let text = format!(
                "(name: \"T\", anchor: (lat: 50, lon: 14), nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: ({length}, 0)), (id: 3, pos: (0, 80))],
                  links: [(from: 1, to: 2, kind: Railway(tram: true)), (from: 1, to: 3, kind: Street(Lane))])"
            );
            let graph: CityGraph = veduta_city::file::parse(&text, "t").unwrap_or_else(|e| panic!("{e}"));
            let all = grow(&graph, &Stock::new()).unwrap_or_else(|e| panic!("{e}")).plan.markings;
            let mut pieces: Vec<(f64, f64)> =
                all.iter().map(|m| (m.line[0].to_metres().x, m.line[m.line.len() - 1].to_metres().x)).collect();
            pieces.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            assert!(pieces.windows(2).all(|pair| (pair[0].1 - pair[1].0).abs() < 1e-9), "{length} m: {pieces:?}");
            let (from, to) = (pieces.first().map(|p| p.0), pieces.last().map(|p| p.1));
            assert!(from == Some(0.0) && to.is_some_and(|to| (to - length).abs() < 0.002), "{length} m: {pieces:?}");
        }
    }

    #[test]
    fn a_railway_lies_on_sleepers_and_crosses_streets_even_with_them() {
        let link = "(from: 3, to: 2, kind: Railway(tram: false), width_m: 8), (from: 5, to: 4, kind: Street(Street))";
        let all = grown(link);
        let length = |kind: MarkingKind, z: Option<i32>| -> f64 {
            let of = all.iter().filter(|m| m.kind == kind && z.is_none_or(|z| m.z == z));
            of.map(|m| m.line[0].to_metres().distance(m.line[m.line.len() - 1].to_metres())).sum()
        };
        // Two tracks of 240 m; the street is 10 m wide, four of them pavements.
        let (on_sleepers, even) = (length(MarkingKind::Track, None), length(MarkingKind::Rails, None));
        assert!((on_sleepers + even - 480.0).abs() < 0.1, "{on_sleepers} {even}");
        assert!((even - 20.0).abs() < 4.0 && length(MarkingKind::Rails, Some(123)) > 4.0, "{even}");
        let tracks: std::collections::BTreeSet<i64> =
            all.iter().filter(|m| m.kind == MarkingKind::Track).map(|m| (m.line[0].to_metres().y * 10.0).round() as i64).collect();
        assert_eq!(tracks.into_iter().collect::<Vec<_>>(), [-20, 20]);
        assert!(all.iter().all(|m| m.kind != MarkingKind::Track || m.line.iter().all(|p| (p.to_metres().x - 2.5).abs() > 4.0)));
    }

    #[test]
    fn a_line_beside_a_bent_one_keeps_its_distance() {
        let line = [DVec2::ZERO, DVec2::X * 30.0, DVec2::new(50.0, 20.0)];
        let left = beside(&line, 10.0, 40.0, 2.0);
        assert_eq!(left.len(), 3);
        assert!((left[0] - DVec2::new(10.0, 2.0)).length() < 1e-9);
        let (a, way) = (DVec2::X * 30.0, DVec2::new(1.0, 1.0).normalize());
        for p in [left[1], left[2]] {
            assert!(((p - a).perp_dot(way) + 2.0).abs() < 1e-9, "{p}");
        }
    }
}
