//! Bands of ground along links: one outline a link, with a vertex on each side of a slight bend and of a change of width, and
//! an arc about a sharp bend. It may wind twice about the inside of a sharp bend.

use core::f64::consts::FRAC_PI_6;

use glam::DVec2;
use veduta_city::{GridPolygon, GridPos, Link};

/// Points nearer than this to one another are one; metres.
pub(super) const LEAST_PIECE_M: f64 = 1e-6;
/// Bends up to this angle get a vertex on each side, if the pieces are long enough for it.
const MITRED: f64 = 50.0 * core::f64::consts::PI / 180.0;
/// … and their width changes by less than so much a metre on each side: mitres move where it is measured.
const STEEPEST_TAPER: f64 = 0.1;
/// Share of a piece's length by which a vertex on the inside of a bend may lie ahead of the bend.
const MOST_AHEAD: f64 = 0.45;

/// The band along stations: an outline that runs counter-clockwise, also where it crosses itself. `half_m`: its half-width at a
/// share of the line's length. `None` if it has no length.
pub(super) fn band(stations: &[Station], half_m: impl Fn(f64) -> f64) -> Option<GridPolygon> {
    let mut line: Vec<&Station> = stations.iter().collect();
    line.dedup_by(|b, a| a.pos.distance(b.pos) <= LEAST_PIECE_M);
    let way = |pair: &[&Station]| (pair[1].pos - pair[0].pos).try_normalize();
    let ways: Vec<DVec2> = line.windows(2).filter_map(way).collect();
    let (Some(&start), Some(&end)) = (line.first(), line.last()) else { return None };
    let (first, last) = (ways.first()?, ways.last()?);
    let (mut left, mut right) = (Vec::new(), Vec::new());
    let side = |station: &Station, way: DVec2| way.perp() * half_m(station.share);
    left.push(start.pos + side(start, *first));
    right.push(start.pos - side(start, *first));
    for (i, both) in ways.windows(2).enumerate() {
        let (here, half) = (line[i + 1], half_m(line[i + 1].share));
        let turn = libm::atan2(both[0].perp_dot(both[1]), both[0].dot(both[1]));
        let pieces = [line[i], line[i + 2]].map(|other| (here.pos.distance(other.pos), half_m(other.share)));
        let shorter = pieces[0].0.min(pieces[1].0);
        let is_even = pieces.iter().all(|(length, other)| (other - half).abs() <= STEEPEST_TAPER * length);
        if is_even && turn.abs() <= MITRED && half * libm::tan(turn.abs() / 2.0) <= MOST_AHEAD * shorter {
            let to_left = (both[0] + both[1]).perp() * (half / (1.0 + both[0].dot(both[1])));
            left.push(here.pos + to_left);
            right.push(here.pos - to_left);
            continue;
        }
        // About the outside an arc; on the inside by the bend itself, as each piece's own outline would run.
        let (inside, outside, sign) = if turn > 0.0 { (&mut left, &mut right, 1.0) } else { (&mut right, &mut left, -1.0) };
        inside.extend([here.pos + side(here, both[0]) * sign, here.pos, here.pos + side(here, both[1]) * sign]);
        let from = side(here, both[0]) * -sign;
        outside.extend(arc(here.pos, (libm::atan2(from.y, from.x), turn), [half; 2]));
    }
    left.push(end.pos + side(end, *last));
    right.push(end.pos - side(end, *last));
    let mut ring: Vec<GridPos> = right.into_iter().chain(left.into_iter().rev()).map(GridPos::on_plan).collect();
    ring.dedup();
    Some(GridPolygon::simple(ring))
}

/// Points of an arc about a centre, from an angle by a turn, both in radians; its radius goes from one to another.
pub(super) fn arc(centre: DVec2, (from, turn): (f64, f64), radii_m: [f64; 2]) -> impl Iterator<Item = DVec2> {
    let steps = libm::ceil(turn.abs() / FRAC_PI_6 - 1e-9).max(1.0) as u32;
    (0..=steps).map(move |i| {
        let share = f64::from(i) / f64::from(steps);
        let angle = from + turn * share;
        let radius = radii_m[0] + (radii_m[1] - radii_m[0]) * share;
        centre + DVec2::new(libm::cos(angle), libm::sin(angle)) * radius
    })
}

/// A point of a link's line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Station {
    pos: DVec2,
    /// Of the line's length, how much lies before it.
    share: f64,
}

/// The vertices of a link's line, and the places between them at which its width is given.
pub(super) fn stations(line: &[DVec2], link: &Link) -> Vec<Station> {
    let length: f64 = line.windows(2).map(|e| e[0].distance(e[1])).sum();
    let mut gone = 0.0;
    let mut out: Vec<Station> = line.first().map(|&pos| Station { pos, share: 0.0 }).into_iter().collect();
    for e in line.windows(2) {
        let (from, to) = (gone / length.max(1e-9), (gone + e[0].distance(e[1])) / length.max(1e-9));
        let between = link.profile.iter().map(|entry| entry.share).filter(|share| from < *share && *share < to);
        let at = |share: f64| Station { pos: e[0].lerp(e[1], (share - from) / (to - from)), share };
        out.extend(between.map(at));
        out.push(Station { pos: e[1], share: to });
        gone += e[0].distance(e[1]);
    }
    out
}

/// The band along a line, as wide everywhere.
pub(super) fn band_of(line: &[DVec2], half_m: f64) -> Option<GridPolygon> {
    let stations: Vec<Station> = line.iter().map(|&pos| Station { pos, share: 0.0 }).collect();
    band(&stations, |_| half_m)
}

/// The part of stations between two shares of their line's length.
pub(super) fn part(stations: &[Station], shares: core::ops::Range<f64>) -> Vec<Station> {
    let mut out: Vec<Station> = Vec::new();
    for pair in stations.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let (from, to) = (a.share.max(shares.start), b.share.min(shares.end));
        if from < to {
            let at = |share: f64| Station { pos: a.pos.lerp(b.pos, (share - a.share) / (b.share - a.share)), share };
            if out.is_empty() {
                out.push(at(from));
            }
            out.push(if to == b.share { b } else { at(to) });
        }
    }
    out
}

/// The straight pieces between stations, as wide as `half_m` says for their shares.
pub(super) fn pieces(stations: &[Station], half_m: impl Fn(f64) -> f64) -> Vec<GridPolygon> {
    stations.windows(2).filter_map(|s| tapered([s[0].pos, s[1].pos], [half_m(s[0].share), half_m(s[1].share)])).collect()
}

/// The rectangle about a straight piece; `None` if it has no length.
pub(super) fn quad(a: DVec2, b: DVec2, half_m: f64) -> Option<GridPolygon> {
    tapered([a, b], [half_m; 2])
}

/// The same of a piece whose half-width goes from one to another.
fn tapered([a, b]: [DVec2; 2], halves_m: [f64; 2]) -> Option<GridPolygon> {
    let [at_a, at_b] = halves_m.map(|half_m| (b - a).try_normalize().map(|along| along.perp() * half_m));
    let (at_a, at_b) = (at_a?, at_b?);
    let ring = [a - at_a, b - at_b, b + at_b, a + at_a].map(GridPos::on_plan).to_vec();
    Some(GridPolygon::simple(ring))
}

#[cfg(test)]
mod tests {
    use veduta_city::{CityGraph, WidthAt};

    use super::*;
    use crate::plan::boolean;

    fn graph() -> CityGraph {
        let text = "(name: \"T\", anchor: (lat: 0, lon: 0), nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (100, 0)), (id: 3, pos: (100, 80))],
            links: [(id: 1, from: 1, to: 2, kind: Street(Lane), width_m: 6), (id: 2, from: 2, to: 3, kind: Street(Main), width_m: 14)])";
        veduta_city::file::parse(text, "test").unwrap_or_else(|e| panic!("{e}"))
    }

    fn bend(degrees: f64, half_m: f64) -> GridPolygon {
        let line = [DVec2::ZERO, DVec2::X * 30.0, DVec2::X * 30.0 + DVec2::from_angle(degrees.to_radians()) * 30.0];
        let stations: Vec<Station> = line.iter().zip([0.0, 0.5, 1.0]).map(|(&pos, share)| Station { pos, share }).collect();
        band(&stations, |_| half_m).expect("it has length")
    }

    #[test]
    fn a_band_covers_its_pieces_at_any_bend() {
        for degrees in (-180..=180).step_by(9).map(f64::from) {
            let shape = bend(degrees, 4.0);
            let covered = boolean::union(&boolean::rings([&shape]));
            let area: f64 = covered.iter().map(GridPolygon::area_m2).sum();
            let turn = degrees.to_radians().abs();
            // Two rectangles and the wedge about the bend, less what they have in common.
            let common = if degrees.abs() > 164.0 { None } else { Some(16.0 * (turn / 2.0).tan()) };
            let most = 2.0 * 240.0 + if degrees.abs() <= 50.0 { common.unwrap_or(0.0) } else { 8.0 * turn };
            assert!(covered.len() == 1 && covered[0].holes.is_empty(), "{degrees}");
            if let Some(common) = common {
                // Its corners lie on the plan.
                assert!((most - common - area).abs() < 0.06 * 8.0 * turn + 0.4, "{degrees}: {area} of {most} less {common}");
            }
            let along = DVec2::from_angle(degrees.to_radians());
            for (x, y) in [(2.0, 3.9), (15.0, -3.9), (26.0, 3.9), (29.0, 0.1), (29.0, -3.9)] {
                let second = DVec2::X * 30.0 + along * x + along.perp() * y;
                for p in [DVec2::new(x, y), second] {
                    assert!(covered[0].contains(GridPos::from_metres(p)), "{degrees}: {p}");
                }
            }
        }
        assert_eq!(bend(20.0, 4.0).outer.len(), 6, "a slight bend is one vertex a side");
    }

    #[test]
    fn a_band_follows_the_profile() {
        let mut graph = graph();
        graph.links.truncate(1);
        let profile = [(0.25, 6.0), (0.5, 12.0), (1.0, 8.0)];
        graph.links[0].profile = profile.map(|(share, width_m)| WidthAt { share, width_m }).to_vec();
        let (at, link) = (graph.node_positions(), &graph.links[0]);
        let line = graph.polyline(link, &at).expect("its nodes are there");
        let shape = band(&stations(&line, link), |share| link.width_at(share) / 2.0).expect("it has length");
        let want = 25.0 * 6.0 + 25.0 * 9.0 + 50.0 * 10.0;
        assert!((shape.area_m2() - want).abs() < 0.5, "{} m² for {want}", shape.area_m2());
    }
}
