//! How two polygons lie to one another, as far as it can be told without computing what they share. Where it cannot, a
//! boolean operation must tell.

use veduta_city::{GridPolygon, GridPos};

use super::outline::edges;
use veduta_city::bounds::{about, do_meet};

/// Whether one of a ring's edges has all of the ring on its left and all of another on its right: most houses side by side are
/// told apart by that alone.
pub(super) fn is_apart(ring: &[GridPos], other: &[GridPos]) -> bool {
    edges(ring).any(|(a, b)| a != b && other.iter().all(|&p| a.cross(b, p) <= 0) && ring.iter().all(|&p| a.cross(b, p) >= 0))
}

/// Whether a simple ring that runs counter-clockwise bends to the left at every corner.
pub(super) fn is_convex(ring: &[GridPos]) -> bool {
    let n = ring.len();
    (0..n).all(|i| ring[i].cross(ring[(i + 1) % n], ring[(i + 2) % n]) >= 0)
}

/// Whether two polygons may have more in common than nothing: their borders touch, or one is in the other.
pub(super) fn may_meet(a: &GridPolygon, b: &GridPolygon) -> bool {
    let first = |of: &GridPolygon| of.outer.first().copied().unwrap_or_default();
    if a.contains(first(b)) || b.contains(first(a)) {
        return true;
    }
    let Some(bounds) = b.bounds() else { return false };
    let is_near = |&(p, q): &(GridPos, GridPos)| do_meet(about(p, q), bounds);
    a.edges().filter(is_near).any(|edge| b.edges().any(|other| do_touch(edge, other)))
}

/// Whether two closed line segments have a point in common.
pub(super) fn do_touch((a, b): (GridPos, GridPos), (c, d): (GridPos, GridPos)) -> bool {
    let side = |a: GridPos, b: GridPos, p: GridPos| a.cross(b, p).signum();
    do_meet(about(a, b), about(c, d)) && side(a, b, c) * side(a, b, d) <= 0 && side(c, d, a) * side(c, d, b) <= 0
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::plan::boolean;

    fn rings(polygon: &GridPolygon) -> Vec<&[GridPos]> {
        boolean::rings([polygon])
    }

    fn area_m2(of: &[GridPolygon]) -> f64 {
        of.iter().map(GridPolygon::area_m2).sum()
    }

    fn rectangle(x: i32, y: i32, w: i32, h: i32) -> GridPolygon {
        GridPolygon::simple([(x, y), (x + w, y), (x + w, y + h), (x, y + h)].map(|(x, y)| GridPos(x * 1024, y * 1024)).to_vec())
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, cases: 1024, ..ProptestConfig::default() })]

        #[test]
        fn what_is_told_apart_has_nothing_in_common(
            a in proptest::collection::vec((-20..20_i32, -20..20_i32), 3..6),
            b in proptest::collection::vec((-20..20_i32, -20..20_i32), 3..6),
        ) {
            // Few places, so that edges often run along one another; the first ring as it comes, also one that crosses itself.
            let [a, b] = [a, b].map(|ring| GridPolygon::simple(ring.into_iter().map(|(x, y)| GridPos(x * 512, y * 512)).collect()));
            let area = area_m2(&boolean::intersection(&rings(&a), &rings(&b)));
            prop_assert!(area == 0.0 || !is_apart(&a.outer, &b.outer) && !is_apart(&b.outer, &a.outer), "{area}");
            for b in boolean::union(&rings(&b)) {
                for a in boolean::union(&rings(&a)) {
                    let area = area_m2(&boolean::intersection(&rings(&a), &rings(&b)));
                    prop_assert!(area == 0.0 || may_meet(&a, &b), "{area}");
                }
            }
        }
    }

    #[test]
    fn houses_side_by_side_are_apart_and_may_meet() {
        let (a, b) = (rectangle(0, 0, 10, 10), rectangle(10, 3, 5, 20));
        assert!(is_apart(&a.outer, &b.outer) && is_apart(&b.outer, &a.outer) && may_meet(&a, &b));
        assert!(!is_apart(&a.outer, &rectangle(9, 3, 5, 20).outer));
        assert!(
            !may_meet(&a, &rectangle(11, 3, 5, 20)) && may_meet(&a, &rectangle(2, 2, 3, 3)) && may_meet(&rectangle(2, 2, 3, 3), &a)
        );
        let frame = GridPolygon { outer: rectangle(-9, -9, 40, 40).outer, holes: vec![rectangle(-2, -2, 20, 20).outer] };
        assert!(!may_meet(&a, &frame), "it stands in the court");
    }
}
