//! How two polygons lie to one another, as far as it can be told without computing what they share. Where it cannot, a
//! boolean operation must tell.

use glam::DVec2;
use veduta_city::{GridPolygon, GridPos};

use super::bounds::{about, do_meet};
use super::outline::edges;

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

/// How near to a border rounding to the grid leads: grid steps.
const NEAR: f64 = 0.75;

/// Whether a simple polygon surely lies within another but for less than an area: where the border of the other comes into it,
/// it keeps so near to its own that no more can be outside.
pub(super) fn is_within(polygon: &GridPolygon, other: &GridPolygon, tolerance_m2: f64) -> bool {
    let steps = 1.0 / GridPos(1, 0).to_metres().x;
    let Some((low, high)) = polygon.bounds() else { return false };
    if !polygon.holes.is_empty() {
        return false;
    }
    let local = |p: GridPos| (p - low).to_metres() * steps;
    let own: Vec<Edge> = edges(&polygon.outer).map(|(a, b)| Edge::new(local(a), local(b))).collect();
    let mut borders: Vec<(DVec2, DVec2)> = Vec::new();
    let mut add = |p: GridPos, q: GridPos| {
        if do_meet(about(p, q), (low, high)) {
            borders.push((local(p), local(q)));
        }
    };
    for ring in other.rings() {
        ring.windows(2).for_each(|ends| add(ends[0], ends[1]));
        ring.first().zip(ring.last()).into_iter().for_each(|(&first, &last)| add(last, first));
    }
    // Most are convex: where no border comes into the core, that is inside or outside as a whole, and the rest is but a rim.
    let perimeter: f64 = own.iter().map(|edge| edge.length).sum();
    if perimeter * NEAR < tolerance_m2 * steps * steps && is_convex(&polygon.outer) {
        let middle = own.iter().map(|edge| edge.from).sum::<DVec2>() / own.len() as f64;
        // So deep that its position on the grid, which is up to √2 steps off, lies in the core as well.
        if core_depth(&own, middle) > 1.5 && !borders.iter().any(|&border| meets_core(&own, border)) {
            return other.contains(low + GridPos(middle.x as i32, middle.y as i32));
        }
    }
    let borders: Vec<Edge> = borders.into_iter().map(|(from, to)| Edge::new(from, to)).collect();
    let is_on_border = |p: DVec2| borders.iter().any(|border| border.is_near(p));
    if !polygon.outer.iter().all(|&p| is_on_border(local(p)) || other.contains(p)) {
        return false;
    }
    // What is outside lies beside the pieces of the border that run along its own, and no farther from them than these.
    let most = tolerance_m2 * steps * steps / NEAR;
    let (mut shares, mut sum) = (Vec::new(), 0.0);
    let is_kept_to = |border: &Edge| {
        // The pieces of the border between the edges that it crosses: each is inside or outside of the polygon as a whole.
        shares.clear();
        shares.extend([0.0, 1.0]);
        shares.extend(own.iter().filter_map(|edge| crossing(border, edge)));
        shares.sort_unstable_by(f64::total_cmp);
        shares.windows(2).all(|piece| {
            let [from, to] = [piece[0], piece[1]].map(|share| border.from.lerp(border.to, share));
            if !contains(&own, (from + to) / 2.0) {
                return true;
            }
            // Distance to an edge is convex: what is near at both ends is near between.
            sum += from.distance(to);
            sum < most && own.iter().any(|edge| edge.is_near(from) && edge.is_near(to))
        })
    };
    borders.iter().all(is_kept_to) && inner_point(&polygon.outer).is_some_and(|p| other.contains(p))
}

/// An edge, grid steps.
struct Edge {
    from: DVec2,
    to: DVec2,
    /// Unit vector from one to the other.
    way: DVec2,
    length: f64,
}

impl Edge {
    fn new(from: DVec2, to: DVec2) -> Self {
        let length = from.distance(to);
        Self { from, to, way: if length > 0.0 { (to - from) / length } else { DVec2::ZERO }, length }
    }

    /// Whether a position is as near as rounding leads.
    fn is_near(&self, p: DVec2) -> bool {
        let off = p - self.from;
        (off - self.way * off.dot(self.way).clamp(0.0, self.length)).length_squared() <= NEAR * NEAR
    }

    /// How much farther to its left than rounding leads a position lies.
    fn depth_of(&self, p: DVec2) -> f64 {
        self.way.perp_dot(p - self.from) - NEAR
    }
}

/// How far a position lies within the core of a convex ring, what is farther than rounding leads from all of its edges; less than
/// nothing outside.
fn core_depth(ring: &[Edge], p: DVec2) -> f64 {
    ring.iter().map(|edge| edge.depth_of(p)).fold(f64::INFINITY, f64::min)
}

/// Whether an edge may come into the core of a convex ring. (Cyrus and Beck, *Generalized two- and three-dimensional clipping*,
/// Computers & Graphics 3, 1978.)
fn meets_core(ring: &[Edge], (p, q): (DVec2, DVec2)) -> bool {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for edge in ring {
        let (before, after) = (edge.depth_of(p), edge.depth_of(q));
        match (before < 0.0, after < 0.0) {
            (true, true) => return false,
            (true, false) => from = from.max(before / (before - after)),
            (false, true) => to = to.min(before / (before - after)),
            (false, false) => {}
        }
    }
    from <= to
}

/// Where one edge crosses another, as a share of its own way.
fn crossing(of: &Edge, other: &Edge) -> Option<f64> {
    let (way, edge) = (of.to - of.from, other.to - other.from);
    // Both ends well on one side: most are.
    let [a, b] = [other.from, other.to].map(|end| of.way.perp_dot(end - of.from));
    if a.min(b) > 0.1 || a.max(b) < -0.1 {
        return None;
    }
    let cross = way.perp_dot(edge);
    let share = (other.from - of.from).perp_dot(edge) / cross;
    let along = (other.from - of.from).perp_dot(way) / cross;
    (cross != 0.0 && (0.0..=1.0).contains(&share) && (-1e-9..=1.0 + 1e-9).contains(&along)).then_some(share)
}

/// Whether a position lies in a ring, given by its edges.
fn contains(ring: &[Edge], p: DVec2) -> bool {
    let crosses = |edge: &&Edge| {
        let (a, b) = (edge.from, edge.to);
        (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
    };
    ring.iter().filter(crosses).count() % 2 == 1
}

/// Some position inside a simple ring: the mean of its vertices, or that of three which follow one another.
fn inner_point(ring: &[GridPos]) -> Option<GridPos> {
    let mean = |of: &[GridPos]| {
        let axis = |axis: fn(&GridPos) -> i32| (of.iter().map(|p| i64::from(axis(p))).sum::<i64>() / of.len() as i64) as i32;
        GridPos(axis(|p| p.0), axis(|p| p.1))
    };
    let n = ring.len();
    let of_three = (0..n).map(|i| mean(&[ring[i], ring[(i + 1) % n], ring[(i + 2) % n]]));
    let whole = GridPolygon::simple(ring.to_vec());
    (n > 2).then(|| mean(ring)).into_iter().chain(of_three).find(|&p| whole.contains(p))
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

        #[test]
        fn what_is_told_to_be_within_is(
            (x, y, w, h) in (-9..9_i32, -9..9_i32, 1..9_i32, 1..9_i32),
            dent in (0..9_i32, 0..9_i32),
            site in proptest::collection::vec((-12..12_i32, -12..12_i32, -3..4_i32), 3..8),
        ) {
            // Corners that are often in line, but for a few grid steps; lots with a bend in their front or back.
            let dent = (x + dent.0 % w, y + dent.1 % h);
            let lot = [(x, y), (x + w, y), (x + w, y + h), dent];
            let lot = GridPolygon::simple(lot.map(|(x, y)| GridPos(x * 1024, y * 1024)).to_vec());
            let site = GridPolygon::simple(site.into_iter().map(|(x, y, off)| GridPos(x * 1024 + off, y * 1024 - off)).collect());
            for lot in boolean::union(&rings(&lot)) {
                for site in boolean::union(&rings(&site)) {
                    let outside = area_m2(&boolean::difference(&rings(&lot), &rings(&site)));
                    prop_assert!(!is_within(&lot, &site, 0.05) || outside < 0.05, "{outside} m² are outside");
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

    #[test]
    fn a_lot_on_the_building_line_is_within_though_rounded_beyond_it() {
        let grid = |p: DVec2| GridPos::from_metres(p);
        let corners = [(0.0, 0.0), (30.0, -4.0), (61.37, 7.91), (50.0, 60.0), (-5.0, 40.0)].map(DVec2::from);
        let site = GridPolygon::simple(corners.map(grid).to_vec());
        for i in 0..40 {
            for (from, to) in [(corners[0], corners[1]), (corners[2], corners[3]), (corners[4], corners[0])] {
                let along = (to - from).normalize();
                let lot = |depth: f64| {
                    let front = [1.0, 10.3].map(|at| from + along * (at + 0.35 * f64::from(i)));
                    let back = front.map(|p| p + along.perp() * depth);
                    GridPolygon::simple([front[0], front[1], back[1], back[0]].map(grid).to_vec())
                };
                assert!(is_within(&lot(11.0), &site, 0.05), "{i} {from}");
                assert!(!is_within(&lot(-11.0), &site, 0.05) && !is_within(&lot(91.0), &site, 0.05), "{i} {from}");
            }
            // About a corner that bends inwards.
            let court = GridPolygon::simple(
                [(0.0, 0.0), (40.0, 0.0), (40.0, 40.0), (20.3, 21.7 + 0.1 * f64::from(i)), (0.0, 40.0)]
                    .map(|p| grid(p.into()))
                    .to_vec(),
            );
            let bend = court.outer[3].to_metres();
            let lot = [
                bend + DVec2::new(-4.0, 0.0).rotate(DVec2::from_angle(-0.73)),
                bend,
                bend + DVec2::new(0.0, -9.0),
                bend - DVec2::new(4.0, 9.0),
            ];
            let lot = GridPolygon::simple(lot.map(grid).to_vec());
            assert_eq!(is_within(&lot, &court, 0.05), area_m2(&boolean::difference(&rings(&lot), &rings(&court))) < 0.01, "{i}");
        }
    }
}
