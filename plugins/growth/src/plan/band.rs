//! Bands of ground along links: a quad a straight piece, a disc where pieces meet.

use std::collections::HashMap;

use glam::DVec2;
use veduta_city::{CityGraph, GridPolygon, GridPos, Id, Link};

/// Sides of the polygon that stands for a disc.
const DISC_SIDES: usize = 16;

/// Half-widths of the bands that end at each node, widest first.
#[derive(Debug, Default)]
pub(super) struct Ends(HashMap<Id, Vec<f64>>);

impl Ends {
    /// Notes that a band of this half-width ends at both nodes of a link.
    pub fn add(&mut self, link: &Link, half_m: f64) {
        for node in [link.from, link.to] {
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

/// The band of a link: polygons without holes, counter-clockwise, that may overlap.
pub(super) fn band(graph: &CityGraph, at: &HashMap<Id, DVec2>, link: &Link, half_m: f64, ends: &Ends) -> Vec<GridPolygon> {
    let Some(line) = graph.polyline(link, at) else { return Vec::new() };
    let mut out: Vec<GridPolygon> = line.windows(2).filter_map(|e| quad(e[0], e[1], half_m)).collect();
    if line.len() > 2 {
        out.extend(line[1..line.len() - 1].iter().map(|&p| disc(p, half_m)));
    }
    for (node, pos) in [(link.from, line.first()), (link.to, line.last())] {
        if let (Some(radius), Some(&pos)) = (ends.radius(node, half_m), pos) {
            out.push(disc(pos, radius));
        }
    }
    out
}

/// The rectangle about a straight piece; `None` if it has no length.
pub(super) fn quad(a: DVec2, b: DVec2, half_m: f64) -> Option<GridPolygon> {
    let side = (b - a).try_normalize()?.perp() * half_m;
    let ring = [a - side, b - side, b + side, a + side].map(GridPos::from_metres).to_vec();
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
        graph.links.iter().for_each(|l| ends.add(l, l.width() / 2.0));
        let parts: Vec<GridPolygon> = graph.links.iter().flat_map(|l| band(&graph, &at, l, l.width() / 2.0, &ends)).collect();
        assert!(parts.iter().all(|p| p.area_m2() > 0.0), "every part is counter-clockwise");
        let whole = boolean::union(&boolean::rings(&parts));
        assert_eq!(whole.len(), 1, "one street");
        let (lo, hi) = whole[0].bounds().expect("it has vertices");
        assert_eq!((lo.0, hi.1), (0, 80 * 1024), "dead ends are not rounded");
        assert!((lo.to_metres().y + 3.0).abs() < 0.01, "the broad street does not bulge below the lane: {lo:?}");
    }
}
