//! Straight skeleton of a polygon with holes: all edges move inwards at 1 m a unit of time; what their corners trace are the
//! hips, valleys and ridges of a roof of one pitch.
//!
//! Events are found by looking at all edges and inner corners each time: O(n³) in all, for outlines of tens of vertices. The
//! result is proved by its faces: each closes, and together they have the footprint's area.

use glam::{DVec2, DVec3};

use super::outline::{Edge, area};

/// A corner of the moving outline.
struct Corner {
    /// Where it was at time `born`.
    pos: DVec2,
    born: f64,
    velocity: DVec2,
    node: usize,
    /// Edges before and after it.
    edges: (usize, usize),
    /// Corners before and after it.
    prev: usize,
    next: usize,
    is_alive: bool,
    is_inner: bool,
    /// Its edges lie on each other, face to face: it has no speed, but zips up.
    is_zip: bool,
}

impl Corner {
    fn at(&self, time: f64) -> DVec2 {
        self.pos + self.velocity * (time - self.born)
    }
}

/// A hip, valley or ridge between two nodes and the faces of two edges.
struct Arc {
    nodes: (usize, usize),
    faces: (usize, usize),
}

enum Event {
    /// The edge after a corner has shrunk to nothing.
    Shrunk(usize),
    /// An inner corner (first) has met the edge after another corner (second).
    Met(usize, usize),
}

/// Two nodes nearer than this in place and time are one; metres.
const SAME_M: f64 = 1e-5;

pub(super) struct Skeleton {
    edges: Vec<Edge>,
    corners: Vec<Corner>,
    /// Place and time.
    nodes: Vec<DVec3>,
    arcs: Vec<Arc>,
    /// First node of each edge, second node of each edge.
    ends: Vec<(usize, usize)>,
}

impl Skeleton {
    /// The outline before it moves; `None` for edges without length.
    pub(super) fn new(rings: &[Vec<DVec2>]) -> Option<Self> {
        let mut it = Self { edges: Vec::new(), corners: Vec::new(), nodes: Vec::new(), arcs: Vec::new(), ends: Vec::new() };
        for ring in rings {
            let (first, n) = (it.edges.len(), ring.len());
            for i in 0..n {
                it.edges.push(Edge::new(ring[i], ring[(i + 1) % n])?);
                it.nodes.push(ring[i].extend(0.0));
                it.ends.push((first + i, first + (i + 1) % n));
            }
            for i in 0..n {
                let (before, after) = (first + (i + n - 1) % n, first + (i + 1) % n);
                it.add_corner(first + i, 0.0, (before, first + i), before, after);
            }
        }
        Some(it)
    }

    /// When the first event happens, and the outline that has moved for a time before it.
    pub(super) fn first_event(&self) -> Option<f64> {
        self.next_event(0.0).map(|(time, _)| time)
    }

    /// The rings' corners after a time no later than the first event.
    pub(super) fn moved(&self, time: f64) -> impl Iterator<Item = DVec2> + '_ {
        self.ends.iter().filter_map(move |&(start, _)| self.corners.get(start)).map(move |corner| corner.at(time))
    }

    /// Moves the edges until nothing is left and gives each edge's face as (x, y, time) counter-clockwise; `None` if it came
    /// out wrong.
    pub(super) fn faces(mut self) -> Option<Vec<Vec<DVec3>>> {
        let mut now = 0.0;
        let mut left = 8 * self.edges.len() + 16;
        while let Some((time, event)) = self.next_event(now) {
            now = time.max(now);
            left = left.checked_sub(1)?;
            match event {
                Event::Shrunk(a) => self.shrink(a, now),
                Event::Met(inner, a) => self.split(inner, a, now),
            }
        }
        if self.corners.iter().any(|c| c.is_alive) {
            return None;
        }
        (0..self.edges.len()).map(|edge| self.trace(edge)).collect()
    }

    fn add_corner(&mut self, node: usize, born: f64, edges: (usize, usize), prev: usize, next: usize) -> usize {
        let (before, after) = (&self.edges[edges.0], &self.edges[edges.1]);
        let opening = 1.0 + before.out.dot(after.out);
        let is_zip = opening < 1e-9;
        self.corners.push(Corner {
            pos: self.nodes[node].truncate(),
            born,
            velocity: if is_zip { DVec2::ZERO } else { -(before.out + after.out) / opening },
            node,
            edges,
            prev,
            next,
            is_alive: true,
            is_inner: before.along.perp_dot(after.along) < -1e-9,
            is_zip,
        });
        self.corners.len() - 1
    }

    fn node(&mut self, pos: DVec2, time: f64) -> usize {
        let place = pos.extend(time);
        let near = self.nodes.iter().position(|n| n.distance_squared(place) < SAME_M * SAME_M);
        near.unwrap_or_else(|| {
            self.nodes.push(place);
            self.nodes.len() - 1
        })
    }

    fn arc(&mut self, a: usize, b: usize, faces: (usize, usize)) {
        if a != b {
            self.arcs.push(Arc { nodes: (a, b), faces });
        }
    }

    fn next_event(&self, now: f64) -> Option<(f64, Event)> {
        let mut best: Option<(f64, Event)> = None;
        let mut offer = |time: f64, event: Event| {
            if time.is_finite() && time >= now - 1e-7 && best.as_ref().is_none_or(|(t, _)| time < t - 1e-9) {
                best = Some((time, event));
            }
        };
        let alive = || self.corners.iter().enumerate().filter(|(_, c)| c.is_alive);
        for (i, a) in alive() {
            let b = &self.corners[a.next];
            let along = self.edges[a.edges.1].along;
            let closing = (a.velocity - b.velocity).dot(along);
            if closing > 1e-9 {
                offer(now + (b.at(now) - a.at(now)).dot(along).max(0.0) / closing, Event::Shrunk(i));
            }
        }
        for (i, inner) in alive().filter(|(_, c)| c.is_inner) {
            for (j, a) in alive().filter(|&(j, a)| j != i && a.next != i) {
                if let Some(time) = self.meeting(inner, a, now) {
                    offer(time, Event::Met(i, j));
                }
            }
        }
        best
    }

    /// When an inner corner meets the edge after another corner.
    fn meeting(&self, inner: &Corner, a: &Corner, now: f64) -> Option<f64> {
        let edge = &self.edges[a.edges.1];
        // Distance in front of the moving edge, and how fast it shrinks.
        let distance = -edge.out.dot(inner.at(now) - edge.a) - now;
        let closing = 1.0 + edge.out.dot(inner.velocity);
        if distance < -SAME_M || closing < 1e-9 {
            return None;
        }
        let time = now + distance.max(0.0) / closing;
        let (place, from, to) = (inner.at(time), a.at(time), self.corners[a.next].at(time));
        let (past, length) = ((place - from).dot(edge.along), (to - from).dot(edge.along));
        (past > -SAME_M && past < length + SAME_M).then_some(time)
    }

    fn kill(&mut self, corner: usize) {
        self.corners[corner].is_alive = false;
    }

    /// Ends a corner's trace at a node.
    fn finish(&mut self, corner: usize, node: usize) {
        let (from, faces) = (self.corners[corner].node, self.corners[corner].edges);
        self.arc(from, node, faces);
        self.kill(corner);
    }

    /// A new corner in the place of one or more between `prev` and `next`.
    fn join(&mut self, node: usize, now: f64, edges: (usize, usize), prev: usize, next: usize) {
        let corner = self.add_corner(node, now, edges, prev, next);
        self.corners[prev].next = corner;
        self.corners[next].prev = corner;
        self.settle(corner, now);
    }

    fn shrink(&mut self, a: usize, now: f64) {
        let b = self.corners[a].next;
        let node = self.node(self.corners[a].at(now), now);
        let (prev, next) = (self.corners[a].prev, self.corners[b].next);
        let edges = (self.corners[a].edges.0, self.corners[b].edges.1);
        self.finish(a, node);
        self.finish(b, node);
        if prev != b {
            self.join(node, now, edges, prev, next);
        }
    }

    fn split(&mut self, inner: usize, a: usize, now: f64) {
        let node = self.node(self.corners[inner].at(now), now);
        let (b, edge) = (self.corners[a].next, self.corners[a].edges.1);
        let Corner { edges: (before, after), prev, next, .. } = self.corners[inner];
        self.finish(inner, node);
        // Both halves are linked before either settles.
        let first = self.add_corner(node, now, (before, edge), prev, b);
        let second = self.add_corner(node, now, (edge, after), a, next);
        self.corners[prev].next = first;
        self.corners[b].prev = first;
        self.corners[a].next = second;
        self.corners[next].prev = second;
        self.settle(first, now);
        self.settle(second, now);
    }

    /// Closes a loop of two corners; zips up edges that lie on each other.
    fn settle(&mut self, corner: usize, now: f64) {
        let Corner { prev, next, node, edges, is_zip, .. } = self.corners[corner];
        if prev == next {
            let other = self.node(self.corners[prev].at(now), now);
            self.arc(node, other, edges);
            self.kill(corner);
            self.finish(prev, other);
        } else if is_zip {
            let here = self.nodes[node].truncate();
            let gap = |c: usize| (self.corners[c].at(now) - here).length_squared();
            let is_back = gap(prev) <= gap(next);
            let nearer = if is_back { prev } else { next };
            let other = self.node(self.corners[nearer].at(now), now);
            self.arc(node, other, edges);
            self.kill(corner);
            let Corner { edges: (before, after), prev: far_prev, next: far_next, .. } = self.corners[nearer];
            self.finish(nearer, other);
            if is_back {
                self.join(other, now, (before, edges.1), far_prev, next);
            } else {
                self.join(other, now, (edges.0, after), prev, far_next);
            }
        }
    }

    /// The face of an edge: along the edge, then over the arcs that bound it back to its start.
    fn trace(&self, edge: usize) -> Option<Vec<DVec3>> {
        let (start, mut here) = self.ends[edge];
        let mut left: Vec<&Arc> = self.arcs.iter().filter(|a| a.faces.0 == edge || a.faces.1 == edge).collect();
        let mut face = vec![self.nodes[start], self.nodes[here]];
        while here != start {
            let at = left.iter().position(|a| a.nodes.0 == here || a.nodes.1 == here)?;
            let (a, b) = left.swap_remove(at).nodes;
            here = if a == here { b } else { a };
            face.push(self.nodes[here]);
        }
        face.pop();
        (face.len() >= 3 && left.is_empty()).then_some(face)
    }
}

/// The faces of a hip roof as (x, y, distance from the eaves); `None` where the skeleton could not be found.
pub(super) fn faces(rings: &[Vec<DVec2>]) -> Option<Vec<Vec<DVec3>>> {
    let faces = Skeleton::new(rings)?.faces()?;
    let whole: f64 = rings.iter().map(|ring| area(ring)).sum();
    let mut sum = 0.0;
    let mut flat = Vec::new();
    for face in &faces {
        flat.clear();
        flat.extend(face.iter().map(|p| p.truncate()));
        let part = area(&flat);
        if part < -1e-6 {
            return None;
        }
        sum += part;
    }
    ((sum - whole).abs() < 1e-4 * whole).then_some(faces)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(points: &[(f64, f64)]) -> Vec<DVec2> {
        points.iter().map(|&p| p.into()).collect()
    }

    fn top(faces: &[Vec<DVec3>]) -> f64 {
        faces.iter().flatten().map(|p| p.z).fold(0.0, f64::max)
    }

    #[test]
    fn a_rectangle_has_a_ridge_of_length_less_width() {
        let faces = faces(&[ring(&[(0.0, 0.0), (10.0, 0.0), (10.0, 4.0), (0.0, 4.0)])]).unwrap();
        assert_eq!(faces.iter().map(Vec::len).collect::<Vec<_>>(), [4, 3, 4, 3]);
        assert!((top(&faces) - 2.0).abs() < 1e-9);
        assert!(faces[0].iter().any(|p| p.distance(DVec3::new(8.0, 2.0, 2.0)) < 1e-9));
    }

    #[test]
    fn corners_that_turn_inwards_make_valleys() {
        let wings: [&[(f64, f64)]; 4] = [
            &[(0.0, 0.0), (10.0, 0.0), (10.0, 4.0), (5.0, 4.0), (5.0, 9.0), (0.0, 9.0)],
            &[(0.0, 0.0), (12.0, 0.0), (12.0, 9.0), (8.0, 9.0), (8.0, 4.0), (4.0, 4.0), (4.0, 9.0), (0.0, 9.0)],
            &[(0.0, 0.0), (12.0, 0.0), (12.0, 4.0), (8.0, 4.0), (8.0, 9.0), (4.0, 9.0), (4.0, 4.0), (0.0, 4.0)],
            &[
                (1.0, 0.0),
                (2.0, 0.0),
                (2.0, 1.0),
                (3.0, 1.0),
                (3.0, 2.0),
                (2.0, 2.0),
                (2.0, 3.0),
                (1.0, 3.0),
                (1.0, 2.0),
                (0.0, 2.0),
                (0.0, 1.0),
                (1.0, 1.0),
            ],
        ];
        for (i, wing) in wings.into_iter().enumerate() {
            assert!(faces(&[ring(wing)]).is_some(), "outline {i}");
        }
    }

    #[test]
    fn a_courtyard_has_a_ridge_around_it() {
        let outer = ring(&[(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)]);
        let court = ring(&[(6.0, 6.0), (6.0, 13.0), (14.0, 13.0), (14.0, 6.0)]);
        let faces = faces(&[outer, court]).unwrap();
        assert_eq!(faces.len(), 8);
        assert!((top(&faces) - 3.5).abs() < 0.2, "{}", top(&faces));
    }

    #[test]
    fn an_outline_that_crosses_itself_is_refused() {
        assert!(faces(&[ring(&[(0.0, 0.0), (4.0, 4.0), (4.0, 0.0), (0.0, 5.0)])]).is_none());
    }
}
