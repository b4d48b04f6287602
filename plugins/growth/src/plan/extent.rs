//! The edge of the modelled city.

use glam::DVec2;
use veduta_city::{BlockKind, CityGraph, Finding, GridPolygon, GridPos, Id, LinkKind, Severity};

/// Farthest half-side of an extent, metres.
const FARTHEST_M: f64 = 40_000.0;
/// Widest ground kept about the outermost thing, metres.
const WIDEST_MARGIN_M: f64 = 2_000.0;

/// An axis-aligned rectangle on the grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Extent {
    /// Least corner.
    pub lo: GridPos,
    /// Greatest corner.
    pub hi: GridPos,
}

impl Extent {
    /// As a polygon, counter-clockwise.
    pub fn polygon(&self) -> GridPolygon {
        let (lo, hi) = (self.lo, self.hi);
        GridPolygon::simple(vec![lo, GridPos(hi.0, lo.1), hi, GridPos(lo.0, hi.1)])
    }

    /// Whether a position lies in it.
    pub fn holds(&self, p: GridPos) -> bool {
        self.lo.0 <= p.0 && p.0 <= self.hi.0 && self.lo.1 <= p.1 && p.1 <= self.hi.1
    }

    /// Its middle, metres.
    pub fn middle(&self) -> DVec2 {
        (self.lo.to_metres() + self.hi.to_metres()) / 2.0
    }
}

/// Bounds of everything that lies near the city's bulk, plus the graph's margin. The bulk is the middle eight tenths, along
/// each axis, of houses, squares, built blocks and street vertices; what lies more than ¾ of its span and 250 m beyond is an
/// outlier (a railway that leaves the map, a coast), is reported, and will be cut at the edge.
pub(super) fn extent(graph: &CityGraph, findings: &mut Vec<Finding>) -> Extent {
    let points = Points::of(graph);
    let margin =
        if graph.margin_m.is_finite() { graph.margin_m.clamp(0.0, WIDEST_MARGIN_M) } else { CityGraph::default_margin_m() };
    if margin != graph.margin_m {
        let message = format!("a margin of {} m is not within 0 to {WIDEST_MARGIN_M} m: {margin} m is taken", graph.margin_m);
        findings.push(Finding::new(Severity::Repaired, Id::NONE, None, message));
    }
    let bulk = if points.bulk.is_empty() { &points.all } else { &points.bulk };
    let fence = fence(bulk);
    let near = |p: &&DVec2| (fence.0.x..=fence.1.x).contains(&p.x) && (fence.0.y..=fence.1.y).contains(&p.y);
    let kept: Vec<DVec2> = points.all.iter().filter(near).copied().collect();
    let outliers = points.all.len() - kept.len();
    if outliers > 0 {
        let message = format!("{outliers} vertices lie far from the rest of the city: what they belong to is cut at its edge");
        findings.push(Finding::new(Severity::Dropped, Id::NONE, points.all.iter().find(|p| !near(p)).copied(), message));
    }
    let (lo, hi) = kept.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
    let (lo, hi) = if kept.is_empty() { (DVec2::ZERO, DVec2::ZERO) } else { (lo, hi) };
    // A city of one point still gets ground to stand on.
    let margin = margin.max(if (hi - lo).min_element() < 1.0 { 1.0 } else { 0.0 });
    Extent { lo: GridPos::on_plan(lo - margin), hi: GridPos::on_plan(hi + margin) }
}

/// Vertices of a graph.
struct Points {
    /// Houses, squares, built blocks, streets: what makes a city.
    bulk: Vec<DVec2>,
    /// Everything.
    all: Vec<DVec2>,
}

impl Points {
    fn of(graph: &CityGraph) -> Self {
        let at = graph.node_positions();
        let mut bulk: Vec<DVec2> = graph.buildings.iter().flat_map(|b| &b.outline).copied().collect();
        bulk.extend(graph.squares.iter().flat_map(|s| &s.outline));
        bulk.extend(graph.blocks.iter().filter(|b| b.kind == BlockKind::Built).flat_map(|b| &b.outline));
        let mut rest: Vec<DVec2> = graph.objects.iter().map(|o| o.pos).collect();
        rest.extend(graph.blocks.iter().filter(|b| b.kind != BlockKind::Built).flat_map(|b| &b.outline));
        for link in &graph.links {
            let line = graph.polyline(link, &at).unwrap_or_default();
            if matches!(link.kind, LinkKind::Street(_)) { bulk.extend(line) } else { rest.extend(line) }
        }
        Self { all: bulk.iter().chain(&rest).copied().collect(), bulk }
    }
}

fn fence(bulk: &[DVec2]) -> (DVec2, DVec2) {
    let axis = |pick: fn(&DVec2) -> f64| {
        let mut values: Vec<f64> = bulk.iter().map(pick).collect();
        let last = values.len().saturating_sub(1);
        let mut at = |share: f64| {
            let place = (last as f64 * share) as usize;
            if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(place, f64::total_cmp).1 }
        };
        let (low, high, middle) = (at(0.1), at(0.9), at(0.5));
        let reach = 0.75 * (high - low) + 250.0;
        ((low - reach).max(middle - FARTHEST_M), (high + reach).min(middle + FARTHEST_M))
    };
    let (x, y) = (axis(|p| p.x), axis(|p| p.y));
    (DVec2::new(x.0, y.0), DVec2::new(x.1, y.1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use veduta_city::Square;

    fn square(x: f64, y: f64) -> Square {
        let outline = [(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)].map(|(a, b)| DVec2::new(x + a, y + b)).to_vec();
        Square { id: Id::NONE, name: String::new(), outline, holes: Vec::new(), surfacing: Default::default() }
    }

    #[test]
    fn the_margin_lies_about_the_outermost_thing() {
        let graph = CityGraph { squares: vec![square(0.0, 0.0), square(100.0, 50.0)], margin_m: 10.0, ..Default::default() };
        let e = extent(&graph, &mut Vec::new());
        assert_eq!((e.lo, e.hi), (GridPos(-10_240, -10_240), GridPos(130 * 1024, 80 * 1024)));
    }

    #[test]
    fn one_far_thing_does_not_stretch_the_city() {
        let mut squares: Vec<Square> = (0..20).map(|i| square(f64::from(i) * 30.0, 0.0)).collect();
        squares.push(square(900_000.0, 0.0));
        let mut findings = Vec::new();
        let e = extent(&CityGraph { squares, margin_m: 10.0, ..Default::default() }, &mut findings);
        assert!(e.hi.to_metres().x < 700.0, "{e:?}");
        assert_eq!(findings.len(), 1);
    }

    #[test]
    fn nothing_still_has_ground() {
        let mut findings = Vec::new();
        let e = extent(&CityGraph { margin_m: f64::NAN, ..Default::default() }, &mut findings);
        assert!(e.polygon().area_m2() > 3_000.0, "the default margin on every side");
        assert_eq!(findings.len(), 1, "and the bad margin is told");
    }
}
