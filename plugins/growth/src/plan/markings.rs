//! What is painted on carriageways, and tram rails.
//!
//! Where a street's kerbs come clear of its neighbours' at a crossroads, a zebra crossing may lie; behind it the stop line of those
//! that wait for a main street; between both ends the lines along it. Lines are cut into pieces of whole repeats of their dashes,
//! so that each belongs to a cell and the dashes still go on.

use std::collections::BTreeMap;

use glam::DVec2;
use veduta_city::draw::Draw;
use veduta_city::{CityGraph, GridPos, Id, Link, LinkKind, Marking, MarkingKind, StreetClass, SurfaceKind, Surfacing};

use super::crossroads::{Arm, gaps};
use super::objects::Site;
use super::streets::{length_m, pavement_m, width_at_m, width_m};

/// Lines are cut into pieces this long: whole repeats of [`veduta_city::Marking::DASH_M`]; metres.
const PIECE_M: f64 = 3.0 * (Marking::DASH_M + Marking::GAP_M);
/// Breadth of lines along a street, and of stop lines; metres.
const LINE_M: f64 = 0.125;
const STOP_M: f64 = 0.4;
/// Length of a zebra's stripes, and its distance from the corner of the kerbs; metres.
const ZEBRA_M: f64 = 3.4;
const ZEBRA_SETBACK_M: f64 = 0.8;
/// A stop line's distance from the zebra, or from the corner where there is none; metres.
const STOP_SETBACK_M: f64 = 1.2;
/// Carriageways between these widths have zebras, those from the second on two lanes, from the third on four; metres.
const ZEBRAS: core::ops::Range<f64> = 4.0..17.0;
const TWO_LANES_M: f64 = 5.6;
const FOUR_LANES_M: f64 = 12.4;
/// Lines shorter than this are left out; metres.
const LEAST_M: f64 = 3.0;
/// Gauge of tram rails, metres.
const GAUGE_M: f64 = 1.435;
/// Share of the crossings of plain streets that have zebras.
const QUIET_ZEBRAS: f64 = 0.2;

/// A street with a carriageway, as markings see it.
struct Street<'a> {
    link: &'a Link,
    class: StreetClass,
    line: Vec<DVec2>,
    length_m: f64,
}

impl Street<'_> {
    /// Half the carriageway's width at a share of the street's length.
    fn half_m(&self, share: f64) -> f64 {
        width_at_m(self.link, share) / 2.0 - pavement_m(self.class, width_m(self.link))
    }

    /// The place at a distance from one end, so far to the left of the way from there.
    fn at(&self, from_start: bool, s_m: f64, left_m: f64) -> Option<DVec2> {
        let (p, way) = match from_start {
            true => super::streets::along(&self.line, s_m)?,
            false => super::streets::along(&self.line, self.length_m - s_m).map(|(p, way)| (p, -way))?,
        };
        Some(p + way.perp() * left_m)
    }
}

/// An end of a street at a node.
#[derive(Clone, Copy)]
struct End {
    street: usize,
    is_start: bool,
}

/// All markings, in the order of links.
pub(super) fn markings(graph: &CityGraph, site: &Site<'_>) -> Vec<Marking> {
    let at = graph.node_positions();
    let street = |link: &'_ Link| -> Option<(StreetClass, Vec<DVec2>)> {
        let LinkKind::Street(class) = link.kind else { return None };
        let is_marked = class.has_carriageway() && link.layer >= 0 && link.surfacing.is_none_or(|s| s == Surfacing::Asphalt);
        let mut line = graph.polyline(link, &at).filter(|_| is_marked)?;
        line.dedup_by(|a, b| a.distance(*b) < 1e-6);
        (line.len() > 1).then_some((class, line))
    };
    let streets: Vec<Street<'_>> = graph
        .links
        .iter()
        .filter_map(|link| {
            let (class, line) = street(link)?;
            Some(Street { link, class, length_m: length_m(&line), line })
        })
        .collect();
    let mut nodes: BTreeMap<Id, Vec<Arm<End>>> = BTreeMap::new();
    for (i, street) in streets.iter().enumerate() {
        let ends = [(street.link.from, true), (street.link.to, false)];
        for (node, is_start) in ends {
            let (end, share) = (End { street: i, is_start }, if is_start { 0.0 } else { 1.0 });
            let mut forth = street.line.iter().copied();
            let mut back = street.line.iter().rev().copied();
            let line: &mut dyn Iterator<Item = DVec2> = if is_start { &mut forth } else { &mut back };
            nodes.entry(node).or_default().extend(Arm::new(line, street.half_m(share), 0.0, end));
        }
    }
    let mut marks = Marks { site, out: Vec::new() };
    // Length along each street, from its start and from its end, that crossroads leave without lines; metres.
    let mut taken = vec![[0.0; 2]; streets.len()];
    for (node, mut arms) in nodes {
        crossing(graph.seed, node, &mut arms, &streets, &mut taken, &mut marks);
    }
    for (street, &taken) in streets.iter().zip(&taken) {
        lines(street, taken, &mut marks);
    }
    for link in graph.links.iter().filter(|link| link.kind == LinkKind::Railway { tram: true } && link.layer >= 0) {
        let line = graph.polyline(link, &at).unwrap_or_default();
        marks.pieces(MarkingKind::Rails, &line, 0.0..length_m(&line), 0.0, GAUGE_M);
    }
    marks.out
}

/// Zebras and stop lines of a node, and how far each of its streets is without lines.
fn crossing(seed: u64, node: Id, arms: &mut [Arm<End>], streets: &[Street<'_>], taken: &mut [[f64; 2]], marks: &mut Marks<'_, '_>) {
    if arms.len() < 3 {
        return;
    }
    let mut clear: BTreeMap<(usize, bool), f64> = BTreeMap::new();
    for (before, after, gap) in gaps(arms) {
        let (b, a) = corner_m(before, after, gap);
        for (end, at) in [(before.what, b), (after.what, a)] {
            let entry = clear.entry((end.street, end.is_start)).or_default();
            *entry = entry.max(at);
        }
    }
    let is_main = |end: End| matches!(streets[end.street].class, StreetClass::Main | StreetClass::Motorway);
    let mains = arms.iter().filter(|arm| is_main(arm.what)).count();
    let draw = Draw::new(seed, node, "crossing");
    let has_zebras = mains > 0 || draw.chance("zebras", QUIET_ZEBRAS);
    for arm in arms.iter() {
        let (end, street) = (arm.what, &streets[arm.what.street]);
        let mut at = clear.get(&(end.street, end.is_start)).copied().unwrap_or(0.0);
        let has_pavements = pavement_m(street.class, width_m(street.link)) > 0.0;
        let room = arm.straight_m.min(street.length_m * 0.5);
        let zebra = at + ZEBRA_SETBACK_M;
        if has_zebras && has_pavements && ZEBRAS.contains(&(2.0 * arm.half_m)) && zebra + ZEBRA_M < room {
            let middle = zebra + ZEBRA_M / 2.0;
            let side = |left: f64| street.at(end.is_start, middle, left * (arm.half_m - 0.25));
            if let (Some(a), Some(b)) = (side(1.0), side(-1.0)) {
                marks.add(MarkingKind::Zebra, &[a, b], ZEBRA_M);
                at = zebra + ZEBRA_M;
            }
        }
        let stop = at + STOP_SETBACK_M;
        if mains > 0 && !is_main(end) && arm.half_m * 2.0 >= TWO_LANES_M && stop + STOP_M < room {
            // Who comes keeps to the right: on the left of the way out.
            let side = |left: f64| street.at(end.is_start, stop, left);
            if let (Some(a), Some(b)) = (side(0.1), side(arm.half_m - 0.25)) {
                marks.add(MarkingKind::Line, &[a, b], STOP_M);
                at = stop + STOP_M;
            }
        }
        taken[end.street][usize::from(!end.is_start)] = at + 0.8;
    }
}

/// How far from the node the kerbs of two neighbouring arms meet, along each of them; metres.
fn corner_m<T>(before: &Arm<T>, after: &Arm<T>, gap: f64) -> (f64, f64) {
    let (sin, cos) = (libm::sin(gap), libm::cos(gap));
    if gap >= core::f64::consts::PI * 0.97 {
        return (0.0, 0.0);
    }
    let along = |mine: f64, other: f64| ((other + mine * cos) / sin.max(0.1)).max(0.0);
    // The rounding of the kerb begins a little before.
    let rounding = if gap > 0.35 { 2.0 } else { 0.0 };
    (along(before.half_m, after.half_m) + rounding, along(after.half_m, before.half_m) + rounding)
}

/// The lines along a street.
fn lines(street: &Street<'_>, taken: [f64; 2], marks: &mut Marks<'_, '_>) {
    let (from, to) = (taken[0], street.length_m - taken[1]);
    let half = (0..=8).map(|i| street.half_m(f64::from(i) / 8.0)).fold(f64::INFINITY, f64::min);
    let width = 2.0 * half;
    if to - from < LEAST_M || width < TWO_LANES_M {
        return;
    }
    let mut line = |kind, left_m| marks.pieces(kind, &street.line, from..to, left_m, LINE_M);
    match street.class {
        StreetClass::Motorway => {
            [-1.0, 1.0].into_iter().for_each(|side| line(MarkingKind::Line, side * (half - 0.5)));
            line(MarkingKind::Dashes, 0.0);
        }
        StreetClass::Main if width >= FOUR_LANES_M => {
            [-0.15, 0.15].into_iter().for_each(|left| line(MarkingKind::Line, left));
            [-half / 2.0, half / 2.0].into_iter().for_each(|left| line(MarkingKind::Dashes, left));
        }
        StreetClass::Main => line(MarkingKind::Dashes, 0.0),
        _ => {}
    }
}

struct Marks<'a, 'b> {
    site: &'a Site<'b>,
    out: Vec<Marking>,
}

impl Marks<'_, '_> {
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
        let mut points: Vec<GridPos> = line.iter().map(|&p| GridPos::from_metres(p)).collect();
        points.dedup();
        if points.len() > 1 {
            self.out.push(Marking { kind, line: points, width: GridPos::steps(width_m).max(1), z: 0 });
        }
    }

    /// Adds a line to the left of another, over some of its length, piece by piece.
    fn pieces(&mut self, kind: MarkingKind, line: &[DVec2], range: core::ops::Range<f64>, left_m: f64, width_m: f64) {
        let mut start = range.start;
        while start < range.end {
            // The last piece takes a rest that would be too short for itself.
            let end = if range.end - start < PIECE_M + LEAST_M { range.end } else { start + PIECE_M };
            self.add(kind, &beside(line, start, end, left_m), width_m);
            start = end;
        }
    }
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
