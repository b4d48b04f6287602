//! Polygons in plan metres: outer ring counter-clockwise, holes clockwise, simple, no vertex repeated.

use geo::bool_ops::FillRule;
use geo::{BooleanOps, Coord, LineString, MultiPolygon};
use glam::DVec2;
use veduta_city::Ring;
pub(crate) use veduta_city::ring_edges as edges;

/// Vertices closer than this are one, in metres.
const WELD_M: f64 = 1e-3;
/// Rings of less area are dropped, in square metres.
pub(crate) const LEAST_M2: f64 = 1.0;

/// An outline with holes.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Polygon {
    pub outer: Ring,
    pub holes: Vec<Ring>,
}

impl Polygon {
    pub(crate) fn area_m2(&self) -> f64 {
        signed_area(&self.outer) + self.holes.iter().map(|h| signed_area(h)).sum::<f64>()
    }

    /// Even–odd rule over all rings.
    pub(crate) fn contains(&self, p: DVec2) -> bool {
        core::iter::once(&self.outer).chain(&self.holes).filter(|r| ring_contains(r, p)).count() % 2 == 1
    }

    /// Least and greatest corner.
    pub(crate) fn bounds(&self) -> (DVec2, DVec2) {
        let none = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        self.outer.iter().fold(none, |(low, high), &p| (low.min(p), high.max(p)))
    }

    /// A position well inside: the centroid if it lies inside, otherwise the middle of the longest chord of a few.
    pub(crate) fn inner_pos(&self) -> DVec2 {
        let centroid = centroid(&self.outer);
        if self.contains(centroid) {
            return centroid;
        }
        let (low, high) = self.bounds();
        let best = (1..16)
            .filter_map(|i| self.widest_chord(low.y + (high.y - low.y) * f64::from(i) / 16.0))
            .max_by(|a, b| (a.1 - a.0).x.total_cmp(&(b.1 - b.0).x));
        best.map_or(centroid, |(a, b)| (a + b) / 2.0)
    }

    /// The longest piece of a level line inside.
    fn widest_chord(&self, y: f64) -> Option<(DVec2, DVec2)> {
        let mut xs: Vec<f64> = core::iter::once(&self.outer)
            .chain(&self.holes)
            .flat_map(|ring| edges(ring))
            .filter(|(a, b)| (a.y > y) != (b.y > y))
            .map(|(a, b)| a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x))
            .collect();
        xs.sort_by(f64::total_cmp);
        let chords = xs.as_chunks::<2>().0.iter().map(|&[a, b]| (DVec2::new(a, y), DVec2::new(b, y)));
        chords.max_by(|a, b| (a.1 - a.0).x.total_cmp(&(b.1 - b.0).x))
    }
}

/// Positive if counter-clockwise.
pub(crate) fn signed_area(ring: &[DVec2]) -> f64 {
    let Some(&origin) = ring.first() else { return 0.0 };
    edges(ring).map(|(a, b)| (a - origin).perp_dot(b - origin)).sum::<f64>() / 2.0
}

pub(crate) fn perimeter_m(ring: &[DVec2]) -> f64 {
    edges(ring).map(|(a, b)| a.distance(b)).sum()
}

/// Centroid of a ring's area; the mean of its vertices if it has none.
pub(crate) fn centroid(ring: &[DVec2]) -> DVec2 {
    let Some(&origin) = ring.first() else { return DVec2::ZERO };
    let (mut sum, mut twice) = (DVec2::ZERO, 0.0);
    for (a, b) in edges(ring) {
        let (a, b) = (a - origin, b - origin);
        let cross = a.perp_dot(b);
        twice += cross;
        sum += (a + b) * cross;
    }
    if twice.abs() < 1e-9 {
        return ring.iter().copied().sum::<DVec2>() / ring.len() as f64;
    }
    origin + sum / (3.0 * twice)
}

fn ring_contains(ring: &[DVec2], p: DVec2) -> bool {
    let crosses = |&(a, b): &(DVec2, DVec2)| (a.y > p.y) != (b.y > p.y) && ((b - a).perp_dot(p - a) > 0.0) == (b.y > a.y);
    edges(ring).filter(crosses).count() % 2 == 1
}

/// The ring without repeated vertices and without the spikes and straight runs that they leave.
fn welded(ring: &[DVec2]) -> Ring {
    let mut out: Ring = Vec::with_capacity(ring.len());
    for &p in ring {
        if out.last().is_none_or(|&last| last.distance(p) > WELD_M) {
            out.push(p);
        }
    }
    while out.len() > 1 && out.first().zip(out.last()).is_some_and(|(a, b)| a.distance(*b) <= WELD_M) {
        out.pop();
    }
    out
}

/// Whether a ring neither crosses nor touches itself.
pub(crate) fn is_simple(ring: &[DVec2]) -> bool {
    let n = ring.len();
    // A spike folds back on the edge before it.
    let is_spike = |((a, b), (_, c)): ((DVec2, DVec2), (DVec2, DVec2))| {
        let (u, v) = (b - a, c - b);
        u.perp_dot(v).abs() <= 1e-9 * u.length() * v.length() && u.dot(v) < 0.0
    };
    if n < 3 || edges(ring).zip(edges(ring).skip(1).chain(edges(ring).take(1))).any(is_spike) {
        return false;
    }
    // Each edge meets those that begin, from left to right, before it ends.
    let mut sorted: Vec<(usize, DVec2, DVec2)> = edges(ring).enumerate().map(|(i, (a, b))| (i, a, b)).collect();
    sorted.sort_unstable_by(|(_, a, b), (_, c, d)| a.x.min(b.x).total_cmp(&c.x.min(d.x)));
    for (k, &(i, a, b)) in sorted.iter().enumerate() {
        let (low, high) = (a.min(b), a.max(b));
        for &(j, c, d) in sorted[k + 1..].iter().take_while(|(_, c, d)| c.x.min(d.x) <= high.x) {
            let is_neighbour = i.abs_diff(j) == 1 || i.abs_diff(j) == n - 1;
            if !is_neighbour && c.y.max(d.y) >= low.y && c.y.min(d.y) <= high.y && touch(a, b, c, d) {
                return false;
            }
        }
    }
    true
}

/// Whether two segments share a point.
fn touch(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    let (s1, s2, s3, s4) = (side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b));
    s1 * s2 <= 0.0 && s3 * s4 <= 0.0 && !(s1 == 0.0 && s2 == 0.0 && s3 == 0.0 && s4 == 0.0 && !overlap(a, b, c, d))
}

fn overlap(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    a.max(b).cmpge(c.min(d)).all() && c.max(d).cmpge(a.min(b)).all()
}

/// The polygons that rings enclose by the even–odd rule, whatever their direction and however they cross; the second value
/// says whether they were taken as they are.
pub(crate) fn even_odd(rings: &[Ring]) -> (Vec<Polygon>, bool) {
    let welded: Vec<Ring> = rings.iter().map(|r| welded(r)).filter(|r| r.len() >= 3).collect();
    if let [ring] = welded.as_slice()
        && is_simple(ring)
    {
        return (tidy(vec![Polygon { outer: ring.clone(), holes: Vec::new() }]), true);
    }
    let is_untouched = welded.iter().all(|r| is_simple(r)) && welded.len() == rings.len();
    let all = MultiPolygon(welded.iter().map(|r| geo::Polygon::new(line(r), Vec::new())).collect());
    (polygons(&all.union(&MultiPolygon(Vec::new()))), is_untouched)
}

/// Everything covered by at least one of the polygons.
pub(crate) fn union<'a>(all: impl IntoIterator<Item = &'a Polygon>) -> Vec<Polygon> {
    let all: Vec<geo::Polygon> = all.into_iter().map(to_geo).collect();
    polygons(&geo::unary_union(&all))
}

/// What two sets share.
pub(crate) fn intersection<'a>(a: impl IntoIterator<Item = &'a Polygon>, b: impl IntoIterator<Item = &'a Polygon>) -> Vec<Polygon> {
    polygons(&many(a).intersection_with_fill_rule(&many(b), FillRule::NonZero))
}

/// The first set without the second.
pub(crate) fn difference<'a>(a: impl IntoIterator<Item = &'a Polygon>, b: impl IntoIterator<Item = &'a Polygon>) -> Vec<Polygon> {
    polygons(&many(a).difference_with_fill_rule(&many(b), FillRule::NonZero))
}

/// Polygons of a set may overlap: holes run against their outlines, so that what is covered at all winds other than to nought.
fn many<'a>(all: impl IntoIterator<Item = &'a Polygon>) -> MultiPolygon {
    MultiPolygon(all.into_iter().map(to_geo).collect())
}

fn line(ring: &[DVec2]) -> LineString {
    ring.iter().chain(ring.first()).map(|p| Coord { x: p.x, y: p.y }).collect()
}

fn to_geo(polygon: &Polygon) -> geo::Polygon {
    geo::Polygon::new(line(&polygon.outer), polygon.holes.iter().map(|h| line(h)).collect())
}

fn polygons(all: &MultiPolygon) -> Vec<Polygon> {
    let ring = |line: &LineString| -> Ring { line.coords().map(|c| DVec2::new(c.x, c.y)).collect() };
    tidy(all.iter().map(|p| Polygon { outer: ring(p.exterior()), holes: p.interiors().iter().map(ring).collect() }).collect())
}

/// Welds, orients and drops what is too small, in a fixed order: by the least vertex.
fn tidy(all: Vec<Polygon>) -> Vec<Polygon> {
    let mut out = Vec::with_capacity(all.len());
    for polygon in all {
        let outer = turned(welded(&polygon.outer), true);
        if outer.len() < 3 || signed_area(&outer) < LEAST_M2 {
            continue;
        }
        let mut holes: Vec<Ring> = polygon.holes.iter().map(|h| turned(welded(h), false)).collect();
        holes.retain(|h| h.len() >= 3 && signed_area(h) <= -LEAST_M2);
        out.push(Polygon { outer, holes });
    }
    out.sort_by(|a, b| least(&a.outer).total_cmp(&least(&b.outer)));
    out
}

/// Order of polygons: from west to east.
fn least(ring: &[DVec2]) -> f64 {
    ring.iter().map(|p| p.x).fold(f64::INFINITY, f64::min)
}

fn turned(mut ring: Ring, is_counter_clockwise: bool) -> Ring {
    if (signed_area(&ring) > 0.0) != is_counter_clockwise {
        ring.reverse();
    }
    ring
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn ring(points: &[(f64, f64)]) -> Ring {
        points.iter().map(|&(x, y)| DVec2::new(x, y)).collect()
    }

    fn square(x: f64, y: f64, side: f64) -> Ring {
        ring(&[(x, y), (x + side, y), (x + side, y + side), (x, y + side)])
    }

    #[test]
    fn a_clockwise_ring_is_turned_and_its_closing_vertex_dropped() {
        let mut clockwise = square(0.0, 0.0, 4.0);
        clockwise.reverse();
        clockwise.push(clockwise[0]);
        let (polygons, is_untouched) = even_odd(&[clockwise]);
        assert!(is_untouched);
        assert_eq!((polygons[0].outer.len(), polygons[0].area_m2()), (4, 16.0));
    }

    #[test]
    fn a_bow_tie_becomes_two_triangles() {
        let (polygons, is_untouched) = even_odd(&[ring(&[(0.0, 0.0), (4.0, 4.0), (4.0, 0.0), (0.0, 4.0)])]);
        assert!(!is_untouched);
        assert_eq!(polygons.len(), 2);
        assert!((polygons.iter().map(Polygon::area_m2).sum::<f64>() - 8.0).abs() < 1e-6);
    }

    #[test]
    fn a_spike_is_cut_off() {
        let (polygons, is_untouched) = even_odd(&[ring(&[(0.0, 0.0), (4.0, 0.0), (9.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)])]);
        assert!(!is_untouched);
        assert!((polygons[0].area_m2() - 16.0).abs() < 1e-6 && polygons[0].outer.len() == 4, "{polygons:?}");
    }

    #[test]
    fn a_ring_in_a_ring_is_a_hole_and_a_third_an_island() {
        let (polygons, _) = even_odd(&[square(0.0, 0.0, 9.0), square(1.0, 1.0, 7.0), square(3.0, 3.0, 2.0)]);
        assert_eq!(polygons.iter().map(|p| p.holes.len()).collect::<Vec<_>>(), [1, 0]);
        assert!((polygons[0].area_m2() - 32.0).abs() < 1e-6);
        assert!(signed_area(&polygons[0].holes[0]) < 0.0);
    }

    #[test]
    fn a_set_that_overlaps_itself_covers_what_any_of_it_covers() {
        let polygon = |x, side| Polygon { outer: square(x, 0.0, side), holes: Vec::new() };
        let (whole, parts) = ([polygon(0.0, 10.0)], [polygon(0.0, 10.0), polygon(2.0, 6.0)]);
        assert_eq!(difference(&whole, &parts), []);
        let shared: f64 = intersection(&whole, &parts).iter().map(Polygon::area_m2).sum();
        assert!((shared - 100.0).abs() < 1e-6, "{shared}");
    }

    #[test]
    fn the_inner_position_of_a_horseshoe_lies_inside() {
        let shoe = ring(&[(0.0, 0.0), (10.0, 0.0), (10.0, 9.0), (9.0, 9.0), (9.0, 1.0), (1.0, 1.0), (1.0, 9.0), (0.0, 9.0)]);
        let polygon = Polygon { outer: shoe, holes: Vec::new() };
        assert!(polygon.contains(polygon.inner_pos()), "{}", polygon.inner_pos());
    }

    proptest! {
        #[test]
        fn any_ring_gives_simple_oriented_polygons(points in prop::collection::vec((-50_i32..50, -50_i32..50), 3..24)) {
            let jagged: Ring = points.iter().map(|&(x, y)| DVec2::new(f64::from(x), f64::from(y))).collect();
            let (polygons, _) = even_odd(&[jagged]);
            for p in &polygons {
                prop_assert!(signed_area(&p.outer) >= LEAST_M2);
                prop_assert!(p.holes.iter().all(|h| signed_area(h) < 0.0));
                for r in core::iter::once(&p.outer).chain(&p.holes) {
                    prop_assert!(r.len() >= 3 && edges(r).all(|(a, b)| a.distance(b) > WELD_M));
                }
                prop_assert!(p.contains(p.inner_pos()));
            }
        }

        #[test]
        fn difference_and_intersection_add_up(x in 0.0_f64..20.0, y in 0.0_f64..20.0, side in 2.0_f64..12.0) {
            let a = [Polygon { outer: square(0.0, 0.0, 20.0), holes: Vec::new() }];
            let b = [Polygon { outer: square(x, y, side), holes: Vec::new() }];
            let area = |all: &[Polygon]| all.iter().map(Polygon::area_m2).sum::<f64>();
            let parts = area(&difference(&a, &b)) + area(&intersection(&a, &b));
            prop_assert!((parts - 400.0).abs() < 2.5, "{parts}");
        }
    }

    /// As [`is_simple`], by trying every edge with every other.
    fn is_simple_by_all_pairs(ring: &[DVec2]) -> bool {
        let (n, all) = (ring.len(), edges(ring).collect::<Vec<_>>());
        let is_spike = |i: usize| {
            let ((a, b), (_, c)) = (all[i], all[(i + 1) % n]);
            (b - a).perp_dot(c - b) == 0.0 && (b - a).dot(c - b) < 0.0
        };
        let meet = |i: usize, j: usize| touch(all[i].0, all[i].1, all[j].0, all[j].1);
        let are_apart = |i: usize, j: usize| j > i + 1 && !(i == 0 && j == n - 1);
        n >= 3 && !(0..n).any(|i| is_spike(i) || (0..n).any(|j| are_apart(i, j) && meet(i, j)))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]

        #[test]
        fn crossings_and_touches_are_all_found(points in prop::collection::vec((-6i32..6, -6i32..6), 0..12), is_starlike: bool) {
            let mut ring: Ring = points.into_iter().map(|(x, y)| DVec2::new(f64::from(x), f64::from(y))).collect();
            if is_starlike {
                // Rings that mostly are simple.
                ring.sort_by(|a, b| libm::atan2(a.y, a.x).total_cmp(&libm::atan2(b.y, b.x)));
            }
            prop_assert_eq!(is_simple(&ring), is_simple_by_all_pairs(&ring));
        }
    }
}
