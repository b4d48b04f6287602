//! Bands of ground along links: a quad a straight piece, a disc where pieces meet. A link whose width varies has more pieces,
//! and wider and narrower ends of them.

use std::collections::HashMap;

use glam::DVec2;
use veduta_city::{CityGraph, GridPolygon, GridPos, Id, Link};

/// Sides of the polygon that stands for a disc.
const DISC_SIDES: usize = 16;

/// Half-widths of the bands that end at each node, widest first.
#[derive(Debug, Default)]
pub(super) struct Ends(HashMap<Id, Vec<f64>>);

impl Ends {
    /// Notes that a band of these half-widths ends at the nodes of a link.
    pub fn add(&mut self, link: &Link, halves_m: [f64; 2]) {
        for (node, half_m) in [(link.from, halves_m[0]), (link.to, halves_m[1])] {
            let at = self.0.entry(node).or_default();
            let i = at.partition_point(|&h| h >= half_m);
            at.insert(i, half_m);
        }
    }

    /// Radius of the disc that rounds a band's end: the second widest band there, so that a broad street which ends at a lane
    /// does not bulge beyond the lane. `None` where nothing else ends.
    fn radius(&self, node: Id, half_m: f64) -> Option<f64> {
        self.0.get(&node).and_then(|at| at.get(1)).map(|&second| second.min(half_m))
    }
}

/// The band of a link: polygons without holes, counter-clockwise, that may overlap. `half_m`: its half-width at a share of the
/// line's length.
pub(super) fn band(
    graph: &CityGraph,
    at: &HashMap<Id, DVec2>,
    link: &Link,
    half_m: impl Fn(f64) -> f64,
    ends: &Ends,
) -> Vec<GridPolygon> {
    let Some(line) = graph.polyline(link, at) else { return Vec::new() };
    let stations = stations(&line, link);
    let mut out = pieces(&stations, &half_m);
    let inner = stations.iter().enumerate().take(stations.len().saturating_sub(1)).skip(1);
    out.extend(inner.filter(|(_, station)| station.is_bend).map(|(_, station)| disc(station.pos, half_m(station.share))));
    for (node, share, pos) in [(link.from, 0.0, line.first()), (link.to, 1.0, line.last())] {
        if let (Some(radius), Some(&pos)) = (ends.radius(node, half_m(share)), pos) {
            out.push(disc(pos, radius));
        }
    }
    out
}

/// A point of a link's line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Station {
    pos: DVec2,
    /// Of the line's length, how much lies before it.
    share: f64,
    /// Whether it is one of the line's own vertices.
    is_bend: bool,
}

/// The vertices of a link's line, and the places between them at which its width is given.
pub(super) fn stations(line: &[DVec2], link: &Link) -> Vec<Station> {
    let length: f64 = line.windows(2).map(|e| e[0].distance(e[1])).sum();
    let mut gone = 0.0;
    let mut out: Vec<Station> = line.first().map(|&pos| Station { pos, share: 0.0, is_bend: true }).into_iter().collect();
    for e in line.windows(2) {
        let (from, to) = (gone / length.max(1e-9), (gone + e[0].distance(e[1])) / length.max(1e-9));
        let between = link.profile.iter().map(|entry| entry.share).filter(|share| from < *share && *share < to);
        let at = |share: f64| Station { pos: e[0].lerp(e[1], (share - from) / (to - from)), share, is_bend: false };
        out.extend(between.map(at));
        out.push(Station { pos: e[1], share: to, is_bend: true });
        gone += e[0].distance(e[1]);
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
    let ring = [a - at_a, b - at_b, b + at_b, a + at_a].map(GridPos::from_metres).to_vec();
    Some(GridPolygon::simple(ring))
}

fn disc(centre: DVec2, radius_m: f64) -> GridPolygon {
    let corner = |i: usize| {
        let angle = core::f64::consts::TAU * i as f64 / DISC_SIDES as f64;
        GridPos::from_metres(centre + DVec2::new(libm::cos(angle), libm::sin(angle)) * radius_m)
    };
    GridPolygon::simple((0..DISC_SIDES).map(corner).collect())
}

#[cfg(test)]
mod tests {
    use veduta_city::WidthAt;

    use super::*;
    use crate::plan::boolean;

    fn graph() -> CityGraph {
        let text = "(name: \"T\", anchor: (lat: 0, lon: 0), nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (100, 0)), (id: 3, pos: (100, 80))],
            links: [(id: 1, from: 1, to: 2, kind: Street(Lane), width_m: 6), (id: 2, from: 2, to: 3, kind: Street(Main), width_m: 14)])";
        veduta_city::file::parse(text, "test").unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn bands_join_round_and_end_flat() {
        let graph = graph();
        let at = graph.node_positions();
        let mut ends = Ends::default();
        graph.links.iter().for_each(|l| ends.add(l, [l.width() / 2.0; 2]));
        let parts: Vec<GridPolygon> = graph.links.iter().flat_map(|l| band(&graph, &at, l, |_| l.width() / 2.0, &ends)).collect();
        assert!(parts.iter().all(|p| p.area_m2() > 0.0), "every part is counter-clockwise");
        let whole = boolean::union(&boolean::rings(&parts));
        assert_eq!(whole.len(), 1, "one street");
        let (lo, hi) = whole[0].bounds().expect("it has vertices");
        assert_eq!((lo.0, hi.1), (0, 80 * 1024), "dead ends are not rounded");
        assert!((lo.to_metres().y + 3.0).abs() < 0.01, "the broad street does not bulge below the lane: {lo:?}");
    }

    #[test]
    fn a_band_follows_the_profile() {
        let mut graph = graph();
        graph.links.truncate(1);
        let profile = [(0.25, 6.0), (0.5, 12.0), (1.0, 8.0)];
        graph.links[0].profile = profile.map(|(share, width_m)| WidthAt { share, width_m }).to_vec();
        let (at, link) = (graph.node_positions(), &graph.links[0]);
        let parts = band(&graph, &at, link, |share| link.width_at(share) / 2.0, &Ends::default());
        assert_eq!(parts.len(), 3, "a piece between every two of its widths, and no disc on a straight line");
        let whole = boolean::union(&boolean::rings(&parts));
        let want = 25.0 * 6.0 + 25.0 * 9.0 + 50.0 * 10.0;
        assert!((whole[0].area_m2() - want).abs() < 0.5, "{} m² for {want}", whole[0].area_m2());
    }
}
