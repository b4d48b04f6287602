//! Shortest ways along the network (A*; Hart, Nilsson and Raphael 1968), and where a walker leaves it.

use std::collections::BinaryHeap;

use glam::DVec2;

use crate::net::{Foot, StreetNet, nearest_on};

/// Tells whether the straight line between two plan positions is free: nothing in it that a walker could run into.
pub type FreeLine<'a> = &'a dyn Fn(DVec2, DVec2) -> bool;

/// Two positions this near are joined by a straight line, in metres.
pub const STRAIGHT_M: f64 = 15.0;
/// Longest straight line across free space, in metres.
pub const CROSSING_M: f64 = 120.0;
/// A straight line across free space is taken where the way along streets is more than so many times as long.
pub const DETOUR: f64 = 1.6;
/// Paths of no more metres that are joined to no other belong to a garden, a yard, a platform: one gets out of it beside them.
/// An islet with as few paths, as near to a bank, is taken for one.
const ENCLOSED_M: f64 = 600.0;
/// Furthest that a position may lie from any street, in metres.
pub const OFF_STREET_M: f64 = 500.0;

/// Why there is no way.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum RouteError {
    /// A coordinate is not a number, or infinite.
    #[error("a position is not finite")]
    NotFinite,
    /// The network is empty.
    #[error("the city has no streets to walk along; at most {STRAIGHT_M} m can be walked without")]
    NoStreets,
    /// A position lies far from all streets.
    #[error("({:.1}, {:.1}) lies outside of the city: {distance_m:.0} m from the nearest street, and nobody walks more than {OFF_STREET_M} m off them", plan_pos.x, plan_pos.y)]
    OffStreets {
        /// The position, plan metres.
        plan_pos: DVec2,
        /// Its distance from the nearest street, in metres.
        distance_m: f64,
    },
    /// The streets near the one position do not lead to those near the other.
    #[error("no street leads from ({:.1}, {:.1}) to ({:.1}, {:.1})", from.x, from.y, to.x, to.y)]
    NotConnected {
        /// From here, plan metres.
        from: DVec2,
        /// To here, plan metres.
        to: DVec2,
    },
}

/// A node on the edge of the search; the greatest is the cheapest.
#[derive(PartialEq)]
struct Open {
    estimate: f64,
    cost: f64,
    node: u32,
}

impl Eq for Open {}
impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<core::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Open {
    fn cmp(&self, other: &Self) -> core::cmp::Ordering {
        other.estimate.total_cmp(&self.estimate).then(other.node.cmp(&self.node))
    }
}

impl StreetNet {
    /// The shortest way along streets, plan metres: the first position is `from`, the last `to`. Both may lie beside the
    /// street; they are joined to its nearest point. Within [`STRAIGHT_M`] the way is a straight line.
    ///
    /// # Errors
    /// [`RouteError`] if a position is not finite or far from all streets, or the streets do not connect.
    pub fn way(&self, from: DVec2, to: DVec2) -> Result<Vec<DVec2>, RouteError> {
        self.way_with(from, to, None)
    }

    /// As [`StreetNet::way`]; where a test for free space is given, ends of streets are also joined across free space of up
    /// to [`CROSSING_M`] (a square has no centre lines), detours of more than [`DETOUR`] are cut short in the same way, and
    /// nothing goes straight that is not free, if there is another way.
    ///
    /// # Errors
    /// As [`StreetNet::way`].
    pub fn way_with(&self, from: DVec2, to: DVec2, free: Option<FreeLine<'_>>) -> Result<Vec<DVec2>, RouteError> {
        if !(from.is_finite() && to.is_finite()) {
            return Err(RouteError::NotFinite);
        }
        let over_no_stairs = |a: DVec2, b: DVec2| !self.is_barred(a, b) && free.is_none_or(|free| free(a, b));
        let free: Option<FreeLine<'_>> = if self.barred.size() > 0 && free.is_some() { Some(&over_no_stairs) } else { free };
        let distance = from.distance(to);
        let is_free = || distance < 0.05 || free.is_none_or(|free| free(from, to));
        if distance <= STRAIGHT_M && is_free() {
            return Ok(vec![from, to]);
        }
        let crossable = || free.is_some() && distance <= CROSSING_M && is_free();
        match self.along_streets(from, to, free) {
            Ok(way) if length(&way) > DETOUR * distance && crossable() => Ok(vec![from, to]),
            Ok(way) => Ok(match free {
                Some(free) => cut_short(&way, free),
                None => way,
            }),
            Err(_) if crossable() => Ok(vec![from, to]),
            // Not free, but there is nothing better.
            Err(_) if distance <= STRAIGHT_M => Ok(vec![from, to]),
            Err(error) => Err(error),
        }
    }

    /// The connected pieces of the network that somebody at a position may step onto.
    pub(crate) fn pieces_at(&self, plan_pos: DVec2) -> Result<Vec<u32>, RouteError> {
        if self.is_empty() {
            return Err(RouteError::NoStreets);
        }
        Ok(self.feet(plan_pos, None)?.into_iter().map(|access| access.piece).collect())
    }

    fn along_streets(&self, from: DVec2, to: DVec2, free: Option<FreeLine<'_>>) -> Result<Vec<DVec2>, RouteError> {
        if self.is_empty() {
            return Err(RouteError::NoStreets);
        }
        let (here, there) = (self.feet(from, free)?, self.feet(to, free)?);
        let Some((a, b)) = best_pair(&here, &there, free.is_some()) else {
            return Err(RouteError::NotConnected { from, to });
        };
        let along = self.search(&a.foot, &b.foot, free).ok_or(RouteError::NotConnected { from, to })?;
        let mut way = vec![from];
        way.extend(along);
        way.push(to);
        way.dedup_by(|b, a| b.distance(*a) < 1e-3);
        if let (Some(last), true) = (way.last_mut(), from != to) {
            *last = to;
        }
        if way.len() == 1 {
            way.push(to);
        }
        merge_in(&mut way, &a.foot, free);
        way.reverse();
        merge_in(&mut way, &b.foot, free);
        way.reverse();
        Ok(way)
    }

    /// Where a walker at `p` may step onto the network: the nearest point of each connected piece close by, those that can
    /// be reached in a straight line first.
    fn feet(&self, p: DVec2, free: Option<FreeLine<'_>>) -> Result<Vec<Access>, RouteError> {
        const LOOKED_AT: usize = 64;
        const FURTHER_M: f64 = 40.0;
        let mut found: Vec<Access> = Vec::new();
        for foot in self.feet_by_distance(p).take(LOOKED_AT) {
            let nearest = found.first().map_or(foot.distance_m, |a| a.foot.distance_m);
            if nearest > OFF_STREET_M {
                return Err(RouteError::OffStreets { plan_pos: p, distance_m: nearest });
            }
            if foot.distance_m > nearest + FURTHER_M {
                break;
            }
            let Some(piece) = self.piece_of(foot.segment) else { continue };
            let known = found.iter().position(|a| a.piece == piece);
            if known.is_some_and(|k| found[k].is_free) {
                continue;
            }
            let is_free = foot.distance_m < 0.05 || free.is_none_or(|free| free(p, foot.plan_pos));
            match known {
                Some(k) if is_free => found[k] = Access { foot, piece, is_free },
                Some(_) => {}
                None => found.push(Access { foot, piece, is_free }),
            }
        }
        // Where stairs are barred, what is cut off may lie above them.
        let is_enclosed = |access: &Access| self.length_of_piece(access.piece) < ENCLOSED_M;
        if self.barred.size() == 0 && found.iter().all(is_enclosed) {
            found.extend(self.way_out(p, free));
        }
        Ok(found)
    }

    /// The nearest point of the network's main piece, for who stands in a garden or yard whose paths lead nowhere: the map does not tell
    /// its gate.
    fn way_out(&self, p: DVec2, free: Option<FreeLine<'_>>) -> Option<Access> {
        let near = self.feet_by_distance(p).take_while(|foot| foot.distance_m <= CROSSING_M);
        let foot = near.into_iter().find(|foot| self.piece_of(foot.segment) == Some(self.main_piece))?;
        let is_free = free.is_none_or(|free| free(p, foot.plan_pos));
        Some(Access { foot, piece: self.main_piece, is_free })
    }

    /// A* from foot to foot; both are in the answer.
    fn search(&self, from: &Foot, to: &Foot, free: Option<FreeLine<'_>>) -> Option<Vec<DVec2>> {
        if from.segment == to.segment {
            return Some(vec![from.plan_pos, to.plan_pos]);
        }
        let (start, goal) = (*self.segments.get(from.segment as usize)?, *self.segments.get(to.segment as usize)?);
        let to_go = |node: u32| self.node(node).distance(to.plan_pos);
        let mut cost = vec![f64::INFINITY; self.nodes.len()];
        let mut came_from = vec![u32::MAX; self.nodes.len()];
        let mut open = BinaryHeap::new();
        for node in [start.from, start.to] {
            let c = self.node(node).distance(from.plan_pos);
            cost[node as usize] = c;
            open.push(Open { estimate: c + to_go(node), cost: c, node });
        }
        let mut best: Option<(f64, u32)> = None;
        while let Some(Open { estimate, cost: c, node }) = open.pop() {
            if best.is_some_and(|(b, _)| b <= estimate) {
                break;
            }
            if c > cost[node as usize] {
                continue;
            }
            if node == goal.from || node == goal.to {
                let total = c + to_go(node);
                if best.is_none_or(|(b, _)| total < b) {
                    best = Some((total, node));
                }
            }
            let hops = free.map(|free| self.hops(node, free)).unwrap_or_default();
            for &(next, step) in self.neighbours(node).iter().chain(&hops) {
                if c + step < cost[next as usize] {
                    cost[next as usize] = c + step;
                    came_from[next as usize] = node;
                    open.push(Open { estimate: c + step + to_go(next), cost: c + step, node: next });
                }
            }
        }
        let mut way = vec![to.plan_pos];
        let mut node = best?.1;
        while node != u32::MAX {
            way.push(self.node(node));
            node = came_from[node as usize];
        }
        way.push(from.plan_pos);
        way.reverse();
        Some(way)
    }

    /// From a street's end across free space to other streets' ends.
    fn hops(&self, node: u32, free: FreeLine<'_>) -> Vec<(u32, f64)> {
        if self.neighbours(node).len() != 1 {
            return Vec::new();
        }
        let here = self.node(node);
        let near = self.dead_ends.locate_within_distance(here.to_array(), CROSSING_M * CROSSING_M);
        let mut hops: Vec<(u32, f64)> = near
            .filter(|e| e.data != node && free(here, self.node(e.data)))
            .map(|e| (e.data, here.distance(self.node(e.data))))
            .collect();
        hops.sort_by_key(|h| h.0);
        hops
    }
}

/// A point where a walker steps onto the network.
struct Access {
    foot: Foot,
    piece: u32,
    is_free: bool,
}

impl Access {
    fn cost(&self) -> f64 {
        self.foot.distance_m + if self.is_free { 0.0 } else { STRAIGHT_M }
    }
}

/// The nearest two feet on the same piece of the network; any two if pieces may be joined across free space.
fn best_pair<'a>(here: &'a [Access], there: &'a [Access], may_cross: bool) -> Option<(&'a Access, &'a Access)> {
    let pairs = here.iter().flat_map(|a| there.iter().map(move |b| (a, b)));
    let same = pairs.filter(|(a, b)| a.piece == b.piece);
    let best = same.min_by(|x, y| (x.0.cost() + x.1.cost()).total_cmp(&(y.0.cost() + y.1.cost())));
    best.or_else(|| if may_cross { here.first().zip(there.first()) } else { None })
}

/// Length of a polyline in metres.
pub(crate) fn length(way: &[DVec2]) -> f64 {
    way.windows(2).map(|w| w[0].distance(w[1])).sum()
}

/// Metres of a polyline from its point nearest to a position on; of points alike the last.
pub(crate) fn left_m(way: &[DVec2], plan_pos: DVec2) -> f64 {
    let (mut nearest, mut left_m, mut after_m) = (f64::INFINITY, 0.0, 0.0);
    for w in way.windows(2).rev() {
        let (point, _) = nearest_on(w[0], w[1], plan_pos);
        let away = point.distance(plan_pos);
        if away < nearest {
            (nearest, left_m) = (away, after_m + point.distance(w[1]));
        }
        after_m += w[0].distance(w[1]);
    }
    left_m
}

/// A walker who stands in the street beside its centre line walks on to it at a slant, not at a right angle. The way's first
/// two positions are the walker's and the foot.
fn merge_in(way: &mut [DVec2], foot: &Foot, free: Option<FreeLine<'_>>) {
    let [from, joint, next, ..] = way else { return };
    let aside = from.distance(*joint);
    if joint.distance(foot.plan_pos) > 1e-3 || aside < 0.3 || aside > foot.half_width_m {
        return;
    }
    let ahead = joint.distance(*next);
    let moved = *joint + (*next - *joint) / ahead * (2.5 * aside).min(0.8 * ahead);
    if moved.is_finite() && free.is_none_or(|free| free(*from, moved)) {
        *joint = moved;
    }
}

/// Replaces detours by straight lines across free space, the longest first from each point on.
fn cut_short(way: &[DVec2], free: FreeLine<'_>) -> Vec<DVec2> {
    const STRIDE_M: f64 = 8.0;
    const LEAST_M: f64 = 5.0;
    let points = divided(way, STRIDE_M);
    let mut result: Vec<DVec2> = way.first().copied().into_iter().collect();
    let keep = |result: &mut Vec<DVec2>, p: DVec2| {
        if result.last() != Some(&p) {
            result.push(p);
        }
    };
    let mut i = 0;
    while let (Some(&(here, walked, _)), Some(&(next, _, is_vertex))) = (points.get(i), points.get(i + 1)) {
        let near = points[i..].iter().take_while(|p| p.1 - walked <= 5.0 * CROSSING_M).count();
        let shortcut = (i + 2..i + near).rev().find(|&j| {
            let (there, by_then, _) = points[j];
            let straight = here.distance(there);
            let is_detour = by_then - walked > DETOUR * straight;
            is_detour && (LEAST_M..=CROSSING_M).contains(&straight) && free(here, there)
        });
        if let Some(j) = shortcut {
            keep(&mut result, here);
            keep(&mut result, points[j].0);
            i = j;
        } else {
            if is_vertex {
                keep(&mut result, next);
            }
            i += 1;
        }
    }
    result
}

/// The way's vertices with more between them, each with its distance along the way and whether it is one of the way's own.
fn divided(way: &[DVec2], stride_m: f64) -> Vec<(DVec2, f64, bool)> {
    let mut walked = 0.0;
    let mut points: Vec<(DVec2, f64, bool)> = way.first().map(|&p| (p, 0.0, true)).into_iter().collect();
    for w in way.windows(2) {
        let span = w[0].distance(w[1]);
        let parts = libm::ceil(span / stride_m).clamp(1.0, 1e6);
        for part in 1..=parts as u32 {
            let along = f64::from(part) / parts;
            let is_vertex = along == 1.0;
            points.push((if is_vertex { w[1] } else { w[0].lerp(w[1], along) }, walked + span * along, is_vertex));
        }
        walked += span;
    }
    points
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use veduta_city::{PlanStreet, StreetClass};

    use super::*;
    use crate::samples::{grid_town, street};

    const OPEN: FreeLine<'static> = &|_, _| true;

    #[test]
    fn the_way_follows_streets_and_is_the_shortest() {
        let net = StreetNet::new(&grid_town(4, 50.0));
        let way = net.way(DVec2::new(0.0, 20.0), DVec2::new(100.0, 130.0)).expect("the town is connected");
        assert_eq!(way.first(), Some(&DVec2::new(0.0, 20.0)));
        assert_eq!(way.last(), Some(&DVec2::new(100.0, 130.0)));
        assert!((length(&way) - 210.0).abs() < 1e-9, "as the crow walks in a grid: {}", length(&way));
    }

    #[test]
    fn who_stands_beside_the_street_steps_onto_it() {
        let net = StreetNet::new(&[street(&[(0.0, 0.0), (100.0, 0.0)])]);
        let way = net.way(DVec2::new(10.0, 9.0), DVec2::new(90.0, -9.0)).expect("one street");
        assert_eq!(way, [(10.0, 9.0), (10.0, 0.0), (90.0, 0.0), (90.0, -9.0)].map(DVec2::from));
        let inside = net.way(DVec2::new(10.0, 2.0), DVec2::new(90.0, 0.0)).expect("one street");
        assert_eq!(inside[1], DVec2::new(15.0, 0.0), "within the street's width at a slant");
    }

    #[test]
    fn near_positions_need_no_street() {
        let net = StreetNet::new(&[]);
        let (a, b) = (DVec2::ZERO, DVec2::new(10.0, 10.0));
        assert_eq!(net.way(a, b), Ok(vec![a, b]));
        assert_eq!(net.way(a, 2.0 * b), Err(RouteError::NoStreets));
    }

    #[test]
    fn who_stands_in_a_closed_garden_gets_out_of_it_but_not_off_an_island() {
        let garden = |x: f64, long_m: f64| street(&[(x, 0.0), (x, long_m)]);
        let (inside, outside) = (DVec2::new(0.0, 5.0), DVec2::new(400.0, 90.0));
        for (gap_m, long_m, leads) in [(80.0, 300.0, true), (80.0, 700.0, false), (150.0, 300.0, false)] {
            let net = StreetNet::new(&[garden(0.0, long_m), street(&[(gap_m, 5.0), (400.0, 5.0), (400.0, 900.0)])]);
            let way = net.way(inside, outside);
            assert_eq!(way.is_ok(), leads, "{gap_m} m away, {long_m} m of paths: {way:?}");
            assert_eq!(net.way(outside, inside).is_ok(), leads, "and in again");
            assert!(way.is_err() || way.is_ok_and(|way| way[1] == DVec2::new(gap_m, 5.0)));
        }
    }

    #[test]
    fn streets_apart_do_not_connect_unless_the_square_between_is_free() {
        let net = StreetNet::new(&[street(&[(-100.0, 0.0), (0.0, 0.0)]), street(&[(60.0, 30.0), (160.0, 30.0)])]);
        let (from, to) = (DVec2::new(-90.0, 0.0), DVec2::new(150.0, 30.0));
        assert_eq!(net.way(from, to), Err(RouteError::NotConnected { from, to }));
        let across = net.way_with(from, to, Some(OPEN)).expect("the square is free");
        assert_eq!(across, [(-90.0, 0.0), (0.0, 0.0), (60.0, 30.0), (150.0, 30.0)].map(DVec2::from));
        assert_eq!(net.way_with(from, to, Some(&|_, _| false)), Err(RouteError::NotConnected { from, to }));
    }

    #[test]
    fn a_detour_round_a_free_square_is_cut_short_inside_the_way() {
        let lines = [(-100.0, 0.0), (0.0, 0.0), (0.0, 60.0), (60.0, 60.0), (60.0, 0.0), (160.0, 0.0)];
        let net = StreetNet::new(&[street(&lines)]);
        let (from, to) = (DVec2::new(-100.0, 0.0), DVec2::new(160.0, 0.0));
        assert_eq!(net.way(from, to).map(|w| length(&w)), Ok(380.0));
        let short = net.way_with(from, to, Some(OPEN)).expect("one street");
        assert!(length(&short) < 290.0, "{short:?}");
        let walled =
            |a: DVec2, b: DVec2| (a.y == b.y && a.y > 55.0) || a.x == b.x || (a.y == 0.0 && b.y == 0.0 && a.x.max(b.x) <= 0.0);
        assert_eq!(net.way_with(from, to, Some(&walled)).map(|w| length(&w)), Ok(380.0), "a built block stays");
    }

    #[test]
    fn a_court_that_leads_nowhere_does_not_catch_the_walker() {
        let net = StreetNet::new(&[street(&[(0.0, 0.0), (200.0, 0.0)]), street(&[(45.0, 8.0), (55.0, 8.0)])]);
        let way = net.way(DVec2::new(50.0, 7.0), DVec2::new(180.0, 0.0)).expect("the main street is near");
        assert_eq!(way[1], DVec2::new(50.0, 0.0));
    }

    #[test]
    fn without_steps_the_way_goes_round_or_is_not_there() {
        let stairs = PlanStreet { class: StreetClass::Steps, ..street(&[(0.0, 0.0), (0.0, 60.0)]) };
        let round = street(&[(0.0, 0.0), (200.0, 0.0), (200.0, 60.0), (0.0, 60.0)]);
        let (below, above) = (DVec2::new(0.0, -1.0), DVec2::new(0.0, 61.0));
        let long =
            |streets: &[PlanStreet], free| StreetNet::without_steps(streets).way_with(below, above, free).map(|w| length(&w));
        let town = [stairs.clone(), round];
        assert_eq!(StreetNet::new(&town).way(below, above).map(|w| length(&w)), Ok(62.0));
        assert!(long(&town, None).expect("round the block") > 450.0);
        let apart = [stairs, street(&[(0.0, 0.0), (-90.0, 0.0)]), street(&[(0.0, 60.0), (-90.0, 60.0)])];
        assert!(matches!(long(&apart, None), Err(RouteError::NotConnected { .. })));
    }

    #[test]
    fn no_short_cut_leads_over_stairs() {
        let stairs = PlanStreet { class: StreetClass::Steps, ..street(&[(-30.0, 20.0), (30.0, 20.0)]) };
        let court = street(&[(0.0, 0.0), (60.0, 0.0), (60.0, 40.0), (0.0, 40.0)]);
        let (below, above) = (DVec2::ZERO, DVec2::new(0.0, 40.0));
        let town = [stairs, court];
        let with = StreetNet::new(&town).way_with(below, above, Some(OPEN)).expect("across the court");
        assert_eq!(length(&with), 40.0);
        let without = StreetNet::without_steps(&town).way_with(below, above, Some(OPEN)).expect("round the stairs");
        assert!(
            length(&without) > 70.0 && without.windows(2).all(|w| w[0].y == w[1].y || w[0].x > 30.0 || w[1].x > 30.0),
            "{without:?}"
        );
    }

    #[test]
    fn errors_say_what_is_wrong() {
        let net = StreetNet::new(&grid_town(2, 50.0));
        assert_eq!(net.way(DVec2::NAN, DVec2::ZERO), Err(RouteError::NotFinite));
        let far = net.way(DVec2::new(0.0, 9000.0), DVec2::ZERO).expect_err("far off").to_string();
        assert!(far.contains("8950 m from the nearest street"), "{far}");
    }

    proptest! {
        #[test]
        fn every_way_in_a_grid_town_is_as_long_as_its_blocks_demand(
            (ax, ay, bx, by) in (0u32..=6, 0u32..=6, 0u32..=6, 0u32..=6),
        ) {
            let net = StreetNet::new(&grid_town(7, 40.0));
            let at = |x: u32, y: u32| DVec2::new(f64::from(x), f64::from(y)) * 40.0;
            let (a, b) = (at(ax, ay), at(bx, by));
            let way = net.way(a, b).map_err(|e| TestCaseError::fail(e.to_string()))?;
            let blocks = (b - a).abs();
            prop_assert!((length(&way) - (blocks.x + blocks.y)).abs() < 1e-6);
            prop_assert_eq!((way[0], way[way.len() - 1]), (a, b));
        }

        #[test]
        fn ways_between_any_two_positions_stay_whole(
            (ax, ay, bx, by) in (-30.0..300.0, -30.0..300.0, -30.0..300.0f64, -30.0..300.0f64), open in any::<bool>(),
        ) {
            let net = StreetNet::new(&grid_town(7, 40.0));
            let (a, b) = (DVec2::new(ax, ay), DVec2::new(bx, by));
            let way = net.way_with(a, b, Some(&|_, _| open)).map_err(|e| TestCaseError::fail(e.to_string()))?;
            prop_assert_eq!((way[0], way[way.len() - 1]), (a, b));
            prop_assert!(length(&way) >= a.distance(b) - 1e-6);
            prop_assert!(way.windows(2).all(|w| w[0] != w[1]));
        }
    }
}
