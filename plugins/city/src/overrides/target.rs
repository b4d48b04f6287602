//! Finding the thing that an edit is about, by id and by place.

use std::collections::HashMap;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::ring_edges;
use crate::{CityGraph, GridPolygon, GridPos, Id, Link};

/// What an edit is about: kind by the edit, id if it is known, and the place where the thing was when it was written.
///
/// A thing is found by its id if it has it still and lies within 5 m of the place. Ids that are hashes of a place change when a
/// new survey moves the thing, so otherwise it is the nearest thing of the kind within 5 m of the place, unless another lies
/// almost as near (within 1.5 m): then neither is touched, and the edit is reported. A place off the end of a link is not on it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// Id; [`Id::NONE`] to go by place alone.
    #[serde(default)]
    pub id: Id,
    /// Plan metres: the node itself, anywhere on a link, anywhere in an area. Best far from other things of the kind.
    pub at: DVec2,
}

impl Target {
    /// Which of some areas of a kind is meant, and what is worth telling of it.
    ///
    /// # Errors
    /// Why none is, in a clause.
    pub fn area<'a>(
        &self,
        what: &str,
        areas: impl IntoIterator<Item = (Id, &'a GridPolygon)>,
    ) -> Result<(usize, Option<String>), String> {
        let key = |(id, area): (Id, &GridPolygon)| {
            // Of those far away, the distance of the one with the id is told.
            let is_asked = self.id.is_given() && id == self.id;
            (id, if is_asked || is_about(area, self.at) { distance_to_area(area, self.at) } else { f64::INFINITY })
        };
        let keys: Vec<(Id, f64)> = areas.into_iter().map(key).collect();
        find(what, &keys, self, |key| *key)
    }
}

/// How far a thing may have moved and still be found by place; metres.
pub(super) const REACH_M: f64 = 5.0;
/// A second thing must lie farther off than the first by this much, or it might be the one meant; metres. A survey that wobbles
/// by less cannot make one thing pass for another.
const APART_M: f64 = 1.5;
/// What lies no farther from a line lies on it; metres.
const ON_LINE_M: f64 = 0.1;
/// The top bit of ids that are hashes of a place.
const HASHED: u64 = 1 << 63;

/// Why a thing was not found, in a clause, or which it is and what is worth telling of it.
pub(super) type Found = Result<(usize, Option<String>), String>;

/// The thing of a kind that a target means. `key` gives the id of a thing and its distance from the target's place.
pub(super) fn find<T>(what: &str, things: &[T], target: &Target, key: impl Fn(&T) -> (Id, f64)) -> Found {
    let keys: Vec<(Id, f64)> = things.iter().map(key).collect();
    if let Some(i) = keys.iter().position(|k| target.id.is_given() && k.0 == target.id) {
        let away = keys.get(i).map_or(0.0, |k| k.1);
        if away <= REACH_M {
            return Ok((i, None));
        }
        // A hash of a place says no more than the place does; a source's own id says more.
        if target.id.0 & HASHED != 0 {
            return Err(format!("the {what} of that id is {away:.1} m away from that place: correct the id or the place"));
        }
        return Ok((i, Some(format!("the {what} of that id is {away:.1} m away from that place now"))));
    }
    let mut near: Vec<(usize, f64)> = keys.iter().map(|k| k.1).enumerate().filter(|k| k.1 <= REACH_M + APART_M).collect();
    near.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    match near.as_slice() {
        [(i, away), rest @ ..] if *away <= REACH_M => match rest.first() {
            Some((other, second)) if second - away < APART_M => {
                let ids = [i, other].map(|i| keys.get(*i).map(|k| k.0).unwrap_or_default());
                Err(format!(
                    "two {what}s lie there, {} and {}, {away:.1} m and {second:.1} m away: give the id, or a place nearer to one",
                    ids[0], ids[1]
                ))
            }
            _ => Ok((*i, None)),
        },
        _ => Err(format!("nothing of that id, and no {what} within {REACH_M} m of that place")),
    }
}

/// The node that a target means.
pub(super) fn find_node(graph: &CityGraph, target: &Target) -> Found {
    find("node", &graph.nodes, target, |n| (n.id, n.pos.distance(target.at)))
}

/// The link that a target means.
pub(super) fn find_link(graph: &CityGraph, target: &Target) -> Found {
    let at = graph.node_positions();
    find("link", &graph.links, target, |link| (link.id, distance_beside(&line_of(graph, link, &at), target.at)))
}

/// The whole line of a link; empty if one of its nodes is not there.
pub(super) fn line_of(graph: &CityGraph, link: &Link, at: &HashMap<Id, DVec2>) -> Vec<DVec2> {
    graph.polyline(link, at).unwrap_or_default()
}

/// Distance from a line that a place lies on or beside; infinite where it lies rather off the line's end than beside it, so that
/// a link that is gone does not pass its edit on to those that met it.
fn distance_beside(line: &[DVec2], p: DVec2) -> f64 {
    let length = |e: &[DVec2]| e[0].distance(e[1]);
    let whole: f64 = line.windows(2).map(length).sum();
    let (mut gone, mut best, mut end) = (0.0, f64::INFINITY, 0.0);
    for e in line.windows(2) {
        let t = foot(e[0], e[1], p);
        let away = p.distance(e[0].lerp(e[1], t));
        if away < best {
            let along = gone + t * length(e);
            (best, end) = (away, along.min(whole - along));
        }
        gone += length(e);
    }
    if best <= end + ON_LINE_M { best } else { f64::INFINITY }
}

pub(super) fn distance_to_edge(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    p.distance(a.lerp(b, foot(a, b, p)))
}

/// Where the nearest point of an edge lies, as a share of it.
pub(super) fn foot(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    ((p - a).dot(b - a) / (b - a).length_squared().max(1e-12)).clamp(0.0, 1.0)
}

/// 0 inside, else the distance to the border.
pub(super) fn distance_to_ring(ring: &[DVec2], p: DVec2) -> f64 {
    if is_inside(ring, p) { 0.0 } else { distance_to_border(ring, p) }
}

pub(super) fn distance_to_border(ring: &[DVec2], p: DVec2) -> f64 {
    ring_edges(ring).map(|(a, b)| distance_to_edge(a, b, p)).fold(f64::INFINITY, f64::min)
}

pub(super) fn is_inside(ring: &[DVec2], p: DVec2) -> bool {
    let crosses = |&(a, b): &(DVec2, DVec2)| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y);
    ring_edges(ring).filter(crosses).count() % 2 == 1
}

/// Whether an area may be near enough to a place to be found by it.
fn is_about(area: &GridPolygon, p: DVec2) -> bool {
    area.bounds().is_some_and(|(lo, hi)| {
        let (lo, hi) = (lo.to_metres() - (REACH_M + APART_M), hi.to_metres() + (REACH_M + APART_M));
        p.cmpge(lo).all() && p.cmple(hi).all()
    })
}

/// 0 inside, else the distance to the nearest border.
fn distance_to_area(area: &GridPolygon, p: DVec2) -> f64 {
    if area.contains(GridPos::from_metres(p)) {
        return 0.0;
    }
    area.edges().map(|(a, b)| distance_to_edge(a.to_metres(), b.to_metres(), p)).fold(f64::INFINITY, f64::min)
}

/// Whether two pieces cross in the inside of both.
pub(super) fn cross((a, b): (DVec2, DVec2), (c, d): (DVec2, DVec2)) -> bool {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Node;

    fn nodes(all: &[(u64, f64)]) -> CityGraph {
        let node = |&(id, x): &(u64, f64)| Node { id: Id(id), pos: DVec2::new(x, 0.0), z: 0.0 };
        CityGraph { nodes: all.iter().map(node).collect(), ..CityGraph::default() }
    }

    fn target(id: u64, x: f64) -> Target {
        Target { id: Id(id), at: DVec2::new(x, 0.0) }
    }

    #[test]
    fn an_id_counts_where_its_thing_is_near() {
        let graph = nodes(&[(5, 0.0), (6, 2.0)]);
        assert_eq!(find_node(&graph, &target(5, 1.5)), Ok((0, None)), "though another is nearer");
    }

    #[test]
    fn an_id_far_from_its_place_is_told_and_a_hash_is_not_followed() {
        let graph = nodes(&[(5, 0.0), (7 | HASHED, 60.0)]);
        let (i, told) = find_node(&graph, &target(5, 30.0)).expect("a source's own id");
        assert!(i == 0 && told.is_some_and(|t| t.contains("30.0 m away")));
        assert!(find_node(&graph, &target(7 | HASHED, 30.0)).is_err_and(|e| e.contains("correct the id or the place")));
    }

    #[test]
    fn a_place_off_a_links_end_is_not_on_it() {
        let line = [DVec2::ZERO, DVec2::new(20.0, 0.0), DVec2::new(20.0, 20.0)];
        for (x, y, away) in
            [(10.0, 2.0, 2.0), (0.0, 0.05, 0.05), (19.0, 3.0, 1.0), (-2.0, 0.0, f64::INFINITY), (0.4, 3.0, f64::INFINITY)]
        {
            assert_eq!(distance_beside(&line, DVec2::new(x, y)), away, "({x}, {y})");
        }
    }

    #[test]
    fn an_area_is_found_from_within_and_from_near_by() {
        let square = |x: i32| {
            let (lo, hi) = (x * 1024, (x + 20) * 1024);
            GridPolygon::simple(vec![GridPos(lo, 0), GridPos(hi, 0), GridPos(hi, 20_480), GridPos(lo, 20_480)])
        };
        let areas = [square(0), square(20), square(90)];
        let find = |id: u64, x: f64| {
            let target = Target { id: Id(id), at: DVec2::new(x, 10.0) };
            target.area("cell", areas.iter().enumerate().map(|(i, area)| (Id(i as u64 + 5), area)))
        };
        assert_eq!((find(0, 10.0), find(0, 87.0), find(0, -4.5)), (Ok((0, None)), Ok((2, None)), Ok((0, None))));
        assert!(find(0, 19.0).is_err_and(|e| e.contains("two cells lie there")), "either may be meant");
        assert_eq!(find(5, 19.0), Ok((0, None)));
        assert!(find(0, 60.0).is_err_and(|e| e.contains("no cell within 5 m")));
        assert!(find(7, 10.0).is_ok_and(|(i, note)| i == 2 && note.is_some_and(|n| n.contains("80.0 m away"))));
    }

    #[test]
    fn of_two_that_might_be_meant_neither_is() {
        let graph = nodes(&[(5, 0.0), (6, 3.0)]);
        assert!(find_node(&graph, &target(9, 1.4)).is_err_and(|e| e.contains("5 and 6, 1.4 m and 1.6 m away")));
        assert_eq!(find_node(&graph, &target(9, 0.7)), Ok((0, None)));
        assert!(find_node(&graph, &target(9, 9.0)).is_err_and(|e| e.contains("no node within 5 m")));
    }
}
