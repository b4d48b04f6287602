//! Outlines as they come from people and maps, made into valid polygons on the grid.

use glam::DVec2;
pub(super) use veduta_city::ring_edges as edges;
use veduta_city::{GridPolygon, GridPos, Ring};

use super::{boolean, relation};

/// Vertices this close to the line between their neighbours are left out of walls; metres.
const STRAIGHT_M: f64 = 0.02;

/// Twice the signed area of a ring in grid steps squared.
pub(super) fn twice_area(ring: &[GridPos]) -> i64 {
    ring.first().map_or(0, |&o| edges(ring).map(|(a, b)| o.cross(a, b)).sum())
}

/// The ring on the grid, counter-clockwise, without repeated vertices.
fn snapped(ring: &[DVec2]) -> Vec<GridPos> {
    let mut out: Vec<GridPos> = ring.iter().map(|&p| GridPos::on_plan(p)).collect();
    out.dedup();
    while out.len() > 1 && out.first() == out.last() {
        out.pop();
    }
    if twice_area(&out) < 0 {
        out.reverse();
    }
    out
}

/// The valid polygons that an outline with holes covers: on the grid, each simple, in a fixed order; none if it has no area.
/// A ring that crosses itself falls into pieces, a hole that leaves its outline is cut.
pub(super) fn polygons(outline: &[DVec2], holes: &[Ring]) -> Vec<GridPolygon> {
    let outer = snapped(outline);
    let holes: Vec<Vec<GridPos>> = holes.iter().map(|h| snapped(h)).filter(|h| h.len() >= 3).collect();
    let clip: Vec<&[GridPos]> = holes.iter().map(Vec::as_slice).collect();
    boolean::difference(&[&outer], &clip)
}

/// Leaves out vertices that bend a wall by less than 2 cm, so that every edge is one wall, and tips thinner than that. Where nothing would be left the
/// ring stays as it is.
pub(super) fn straightened(polygon: &GridPolygon) -> Vec<GridPolygon> {
    let outer = straight_ring(&polygon.outer);
    let holes: Vec<Vec<GridPos>> = polygon.holes.iter().map(|h| straight_ring(h)).collect();
    if outer.len() == polygon.outer.len() && holes.iter().map(Vec::len).eq(polygon.holes.iter().map(Vec::len)) {
        return vec![polygon.clone()];
    }
    if holes.is_empty() && is_plain(&outer) {
        return vec![GridPolygon::simple(outer)];
    }
    let subject: Vec<&[GridPos]> = core::iter::once(&outer).chain(&holes).map(Vec::as_slice).collect();
    boolean::union(&subject)
}

/// Most edges of a ring whose edges are compared with one another; a boolean operation is faster for more.
const MOST_COMPARED: usize = 24;

/// Whether a ring of few edges surely is a valid outline as it stands: it runs counter-clockwise, and no two edges touch but at the
/// corner that they share.
fn is_plain(ring: &[GridPos]) -> bool {
    let n = ring.len();
    if !(3..=MOST_COMPARED).contains(&n) || twice_area(ring) <= 0 {
        return false;
    }
    let edge = |i: usize| (ring[i], ring[(i + 1) % n]);
    let is_bent = |i: usize| edge(i).0.cross(edge(i).1, edge((i + 1) % n).1) != 0;
    let touches = |i: usize| (i + 2..n).any(|j| (j + 1) % n != i && relation::do_touch(edge(i), edge(j)));
    (0..n).all(|i| is_bent(i) && !touches(i))
}

/// Whether no two edges of a ring cross. Exact; for rings of few edges.
pub(super) fn is_simple(ring: &[GridPos]) -> bool {
    let side = |a: GridPos, b: GridPos, p: GridPos| a.cross(b, p).signum();
    let cross = |(a, b): (GridPos, GridPos), (c, d): (GridPos, GridPos)| {
        side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0
    };
    edges(ring).enumerate().all(|(i, e)| !edges(ring).skip(i + 1).any(|f| cross(e, f)))
}

fn straight_ring(ring: &[GridPos]) -> Vec<GridPos> {
    let mut out = ring.to_vec();
    let mut i = 0;
    while out.len() > 3 && i < out.len() {
        let (a, p, b) = (out[(i + out.len() - 1) % out.len()], out[i], out[(i + 1) % out.len()]);
        let is_tip = || (p - a).to_metres().dot((b - p).to_metres()) < 0.0 && bend_m(a, b, p).min(bend_m(p, a, b)) < STRAIGHT_M;
        if bend_m(a, p, b) < STRAIGHT_M || is_tip() {
            out.remove(i);
            i = i.saturating_sub(1);
        } else {
            i += 1;
        }
    }
    out
}

/// Distance of `p` from the edge a–b, metres.
fn bend_m(a: GridPos, p: GridPos, b: GridPos) -> f64 {
    distance_to_edge((p - a).to_metres(), DVec2::ZERO, (b - a).to_metres())
}

/// Distance from a position to an edge, metres.
pub(super) fn distance_to_edge(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let t = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-12)).clamp(0.0, 1.0);
    p.distance(a + (b - a) * t)
}

/// Length of all rings, metres.
pub(super) fn perimeter_m(polygon: &GridPolygon) -> f64 {
    polygon.edges().map(|(a, b)| (b - a).to_metres().length()).sum()
}

/// A rectangle about a footprint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Box2 {
    /// Unit vector along the longer side.
    pub along: DVec2,
    /// Longer side, metres.
    pub length_m: f64,
    /// Shorter side, metres.
    pub width_m: f64,
}

/// Extent of a ring along a direction (a unit vector) and across it, metres.
pub(super) fn extent_along(ring: &[GridPos], along: DVec2) -> (f64, f64) {
    extent_of(&from_first(ring), along)
}

/// The corners of a ring from the first on, metres.
fn from_first(ring: &[GridPos]) -> Vec<DVec2> {
    let base = ring.first().map_or(DVec2::ZERO, |p| p.to_metres());
    ring.iter().map(|p| p.to_metres() - base).collect()
}

fn extent_of(corners: &[DVec2], along: DVec2) -> (f64, f64) {
    let (mut lo, mut hi) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for p in corners {
        let at = DVec2::new(p.dot(along), p.dot(along.perp()));
        // Comparisons are one instruction each, which `min` and `max` are not.
        (lo.x, hi.x) = (if at.x < lo.x { at.x } else { lo.x }, if at.x > hi.x { at.x } else { hi.x });
        (lo.y, hi.y) = (if at.y < lo.y { at.y } else { lo.y }, if at.y > hi.y { at.y } else { hi.y });
    }
    let size = hi - lo;
    (size.x.max(0.0), size.y.max(0.0))
}

/// The smallest rectangle about a ring that has a side along one of its edges.
pub(super) fn smallest_box(ring: &[GridPos]) -> Box2 {
    let mut best = Box2 { along: DVec2::X, length_m: 0.0, width_m: f64::INFINITY };
    let mut least = f64::INFINITY;
    let corners = from_first(ring);
    for (a, b) in edges(ring) {
        let Some(u) = (b - a).to_metres().try_normalize() else { continue };
        let (along, across) = extent_of(&corners, u);
        if along * across < least - 1e-6 {
            least = along * across;
            best = if along >= across {
                Box2 { along: u, length_m: along, width_m: across }
            } else {
                Box2 { along: u.perp(), length_m: across, width_m: along }
            };
        }
    }
    if least.is_infinite() { Box2 { width_m: 0.0, ..best } } else { best }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_with_a_spike_that_crosses_itself_is_not_simple() {
        let crossing = [(-1622, -5789), (5242, -6295), (91331, 0), (48397, -3155), (-825, 5021)].map(|(x, y)| GridPos(x, y));
        assert!(!is_simple(&crossing));
        let mut sound = crossing;
        sound[3].1 = -3000;
        assert!(is_simple(&sound) && is_simple(&crossing[..3]));
    }

    #[test]
    fn straight_walls_have_no_tips() {
        let ring =
            [(0, 0), (9000, 0), (9000, 9000), (4000, 9000), (4000, 30_000), (3990, 9000), (0, 9000)].map(|(x, y)| GridPos(x, y));
        let straight = straightened(&GridPolygon::simple(ring.to_vec()));
        assert_eq!(
            straight,
            [GridPolygon::simple([(0, 0), (9000, 0), (9000, 9000), (0, 9000)].map(|(x, y)| GridPos(x, y)).to_vec())]
        );
    }

    #[test]
    fn a_ring_that_touches_itself_is_not_plain() {
        let grid = |of: &[(i32, i32)]| of.iter().map(|&(x, y)| GridPos(x, y)).collect::<Vec<_>>();
        let square = [(0, 0), (100, 0), (100, 100), (0, 100)];
        assert!(is_plain(&grid(&square)) && is_plain(&grid(&[(0, 0), (100, 0), (50, 30), (100, 100), (0, 100)])));
        for ring in [
            // Clockwise; with a corner on another edge; with a spike; with a corner twice; bent nowhere.
            vec![(0, 0), (0, 100), (100, 100), (100, 0)],
            vec![(0, 0), (100, 0), (100, 100), (50, 0), (0, 100)],
            vec![(0, 0), (100, 0), (100, 100), (100, 200), (100, 100), (0, 100)],
            vec![(0, 0), (100, 0), (50, 50), (100, 100), (0, 100), (50, 50)],
            vec![(0, 0), (50, 0), (100, 0), (100, 100), (0, 100)],
        ] {
            assert!(!is_plain(&grid(&ring)), "{ring:?}");
        }
        let many: Vec<(i32, i32)> = (0..2000).map(|i| (i, i * i)).chain([(0, 5_000_000)]).collect();
        assert!(!is_plain(&grid(&many)), "too many to compare");
    }

    fn ring(of: &[(f64, f64)]) -> Ring {
        of.iter().map(|&(x, y)| DVec2::new(x, y)).collect()
    }

    #[test]
    fn a_bow_tie_falls_into_two_triangles() {
        let pieces = polygons(&ring(&[(0.0, 0.0), (10.0, 10.0), (10.0, 0.0), (0.0, 10.0)]), &[]);
        assert_eq!(pieces.len(), 2);
        assert!(pieces.iter().all(|p| (p.area_m2() - 25.0).abs() < 0.01), "{pieces:?}");
    }

    #[test]
    fn a_clockwise_ring_with_doubled_vertices_is_turned_and_cleaned() {
        let pieces = polygons(&ring(&[(0.0, 0.0), (0.0, 5.0), (0.0, 5.0), (5.0, 5.0), (5.0, 0.0), (2.0, 0.0), (0.0, 0.0)]), &[]);
        assert_eq!(pieces.len(), 1);
        assert_eq!((pieces[0].outer.len(), pieces[0].area_m2()), (4, 25.0));
    }

    #[test]
    fn a_ring_without_area_is_nothing() {
        assert!(polygons(&ring(&[(0.0, 0.0), (5.0, 0.0), (9.0, 0.0)]), &[]).is_empty());
        assert!(polygons(&[], &[]).is_empty());
    }

    #[test]
    fn a_slight_bend_is_one_wall() {
        let bent = polygons(&ring(&[(0.0, 0.0), (5.0, -0.01), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]), &[]);
        assert_eq!(straightened(&bent[0])[0].outer.len(), 4);
        let corner = polygons(&ring(&[(0.0, 0.0), (5.0, -0.5), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]), &[]);
        assert_eq!(straightened(&corner[0])[0].outer.len(), 5);
    }

    #[test]
    fn the_smallest_box_of_a_turned_rectangle_is_itself() {
        let (u, v) = (DVec2::new(0.8, 0.6), DVec2::new(-0.6, 0.8));
        let turned = [DVec2::ZERO, u * 20.0, u * 20.0 + v * 8.0, v * 8.0];
        let b = smallest_box(&polygons(&turned, &[])[0].outer);
        assert!((b.length_m - 20.0).abs() < 0.01 && (b.width_m - 8.0).abs() < 0.01, "{b:?}");
        assert!(b.along.dot(u).abs() > 0.999);
    }
}
