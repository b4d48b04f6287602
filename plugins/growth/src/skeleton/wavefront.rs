//! The moving edges and what happens to them.

use core::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use glam::{DVec2, DVec3};
use veduta_city::Id;
use veduta_city::draw::Draw;

use super::Skeleton;

/// What is nearer than this is at the same place, metres.
pub(super) const SAME_M: f64 = 1e-6;
/// A corner that runs into an edge may pass its end by so much, metres.
const TOUCH_M: f64 = 1e-7;
/// Edges that shrink to nothing go before corners that run into edges at the same time.
const AFTER: f64 = 1e-9;
/// No number.
const NONE: u32 = u32::MAX;

/// The edges' lines, in columns.
#[derive(Debug, Default)]
pub(super) struct Lines {
    /// Unit vector inwards.
    nx: Vec<f64>,
    ny: Vec<f64>,
    /// Distance of the line from the origin, along that.
    offset: Vec<f64>,
    /// Number of the corner at which the edge ends.
    pub to: Vec<u32>,
}

impl Lines {
    pub fn len(&self) -> usize {
        self.nx.len()
    }

    pub fn inwards(&self, edge: u32) -> DVec2 {
        DVec2::new(self.nx[edge as usize], self.ny[edge as usize])
    }

    pub fn along(&self, edge: u32) -> DVec2 {
        -self.inwards(edge).perp()
    }

    /// How far a place is inside of an edge's line.
    pub fn inside(&self, edge: u32, pos: DVec2) -> f64 {
        self.inwards(edge).dot(pos) - self.offset[edge as usize]
    }
}

/// A corner of the wavefront: where two edges meet.
#[derive(Debug, Clone, Copy)]
struct Corner {
    /// Where it was when it was born.
    pos: DVec2,
    born: f64,
    velocity: DVec2,
    /// The node that its arc begins at.
    node: u32,
    /// Edges before and after it.
    before: u32,
    after: u32,
    /// Corners before and after it.
    prev: u32,
    next: u32,
    /// Another corner after which the same edge comes.
    same_edge: u32,
    kind: Kind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Outer,
    /// It may run into an edge.
    Inner,
    /// Its edges lie on one another, face to face: it does not move, but zips up.
    Zip,
    /// Its arc has ended.
    Done,
}

impl Corner {
    fn at(&self, time: f64) -> DVec2 {
        self.pos + self.velocity * (time - self.born)
    }
}

/// Something that may happen; ordered by time.
#[derive(Debug, Clone, Copy)]
struct Event {
    time: f64,
    corner: u32,
    what: What,
}

#[derive(Debug, Clone, Copy)]
enum What {
    /// The edge between the corner and this next one shrinks to nothing.
    Shrinks(u32),
    /// The inner corner runs into this edge.
    Meets(u32),
}

impl Event {
    fn key(&self) -> f64 {
        match self.what {
            What::Shrinks(_) => self.time,
            What::Meets(_) => self.time + AFTER,
        }
    }
}

impl PartialEq for Event {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Event {}

impl PartialOrd for Event {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Event {
    fn cmp(&self, other: &Self) -> Ordering {
        self.key().total_cmp(&other.key()).then(self.corner.cmp(&other.corner))
    }
}

/// Half of an arc: one of the two faces that it lies between, and the way that face runs along it.
#[derive(Debug, Clone, Copy)]
struct Half {
    face: u32,
    from: u32,
    to: u32,
}

#[derive(Debug, Default)]
pub(super) struct Wavefront {
    pub lines: Lines,
    pub skeleton: Skeleton,
    corners: Vec<Corner>,
    /// For each edge, a corner before it, and by that all others.
    on_edge: Vec<u32>,
    events: BinaryHeap<Reverse<Event>>,
    halves: Vec<Half>,
    /// When each edge would be met by the corner that asks.
    meetings: Vec<f64>,
    firsts: Vec<u32>,
    sorted: Vec<Half>,
    now: f64,
}

impl Wavefront {
    /// Moves the edges of rings inwards until nothing is left, each corner moved by up to so much first, and says whether the
    /// faces have come together.
    pub fn shrink(&mut self, points: &[DVec2], ends: &[u32], jitter: Jitter) -> bool {
        self.begin(points, ends, jitter);
        let mut left = 16 * points.len() + 16;
        while let Some(Reverse(event)) = self.events.pop() {
            let corner = &self.corners[event.corner as usize];
            if corner.kind == Kind::Done {
                continue;
            }
            match event.what {
                What::Shrinks(next) if corner.next == next => {
                    self.now = self.now.max(event.time);
                    self.close(event.corner);
                }
                What::Shrinks(_) => continue,
                What::Meets(edge) => {
                    let time = self.now.max(event.time);
                    match self.segment(event.corner, edge, time) {
                        Some(before) => {
                            self.now = time;
                            self.split(event.corner, before);
                        }
                        None => self.look_ahead(event.corner, Some((event.time, edge))),
                    }
                }
            }
            left -= 1;
            if left == 0 {
                return false;
            }
        }
        self.corners.iter().all(|corner| corner.kind == Kind::Done) && self.gather_faces()
    }

    /// Puts the rings' own corners back where they are, and the others beside them: all was done about the first of them.
    pub fn put_back(&mut self, points: &[DVec2]) {
        for (node, point) in self.skeleton.nodes.iter_mut().zip(points) {
            *node = point.extend(0.0);
        }
        let origin = points[0];
        for node in &mut self.skeleton.nodes[points.len()..] {
            *node += origin.extend(0.0);
        }
    }

    /// Lays the edges' lines, and nodes at their corners.
    pub(super) fn lay(&mut self, points: &[DVec2], ends: &[u32], jitter: Option<Jitter>) {
        let Self { lines, skeleton, .. } = self;
        for column in [&mut lines.nx, &mut lines.ny, &mut lines.offset] {
            column.clear();
        }
        lines.to.clear();
        skeleton.nodes.clear();
        let origin = points[0];
        let moved = |i: usize| (points[i] - origin + jitter.map_or(DVec2::ZERO, |jitter| jitter.of(i))).extend(0.0);
        skeleton.nodes.extend((0..points.len()).map(moved));
        let mut first = 0;
        for &end in ends {
            let end = end as usize;
            for i in first..end {
                let to = if i + 1 == end { first } else { i + 1 };
                let (a, b) = (skeleton.nodes[i].truncate(), skeleton.nodes[to].truncate());
                let inwards = (b - a).perp() / (b - a).length();
                lines.nx.push(inwards.x);
                lines.ny.push(inwards.y);
                lines.offset.push(inwards.dot(a));
                lines.to.push(to as u32);
            }
            first = end;
        }
    }

    fn begin(&mut self, points: &[DVec2], ends: &[u32], jitter: Jitter) {
        self.lay(points, ends, Some(jitter).filter(|jitter| jitter.by > 0.0));
        self.corners.clear();
        self.events.clear();
        self.halves.clear();
        self.on_edge.clear();
        self.on_edge.resize(points.len(), NONE);
        self.now = 0.0;
        let mut first = 0;
        for &end in ends {
            let end = end as usize;
            for i in first..end {
                let before = if i == first { end - 1 } else { i - 1 };
                let next = self.lines.to[i];
                self.add_corner(i as u32, before as u32, i as u32, before as u32, next);
            }
            first = end;
        }
        for i in 0..self.corners.len() as u32 {
            self.watch_edge(i);
            self.look_ahead(i, None);
        }
    }

    /// A new corner at a node, between two edges and two corners.
    fn add_corner(&mut self, node: u32, before: u32, after: u32, prev: u32, next: u32) -> u32 {
        let (a, b) = (self.lines.inwards(before), self.lines.inwards(after));
        let opening = 1.0 + a.dot(b);
        let (kind, velocity) = if opening < 1e-12 {
            (Kind::Zip, DVec2::ZERO)
        } else {
            let kind = if a.perp_dot(b) < -1e-9 { Kind::Inner } else { Kind::Outer };
            (kind, (a + b) / opening)
        };
        let number = self.corners.len() as u32;
        let same_edge = core::mem::replace(&mut self.on_edge[after as usize], number);
        let pos = self.skeleton.nodes[node as usize].truncate();
        self.corners.push(Corner { pos, born: self.now, velocity, node, before, after, prev, next, same_edge, kind });
        number
    }

    /// Foresees when the edge after a corner shrinks to nothing.
    fn watch_edge(&mut self, corner: u32) {
        let a = &self.corners[corner as usize];
        let b = &self.corners[a.next as usize];
        let along = self.lines.along(a.after);
        let closing = (a.velocity - b.velocity).dot(along);
        if closing > 1e-12 {
            let length = (b.at(self.now) - a.at(self.now)).dot(along).max(0.0);
            let what = What::Shrinks(a.next);
            self.events.push(Reverse(Event { time: self.now + length / closing, corner, what }));
        }
    }

    /// Foresees which edge's line an inner corner meets next, after one that it has found nothing at.
    fn look_ahead(&mut self, corner: u32, after: Option<(f64, u32)>) {
        let c = self.corners[corner as usize];
        if c.kind != Kind::Inner {
            return;
        }
        let Lines { nx, ny, offset, .. } = &self.lines;
        let (pos, velocity, born) = (c.pos, c.velocity, c.born);
        self.meetings.clear();
        self.meetings.extend(nx.iter().zip(ny).zip(offset).map(|((nx, ny), offset)| {
            let distance = nx * pos.x + ny * pos.y - offset - born;
            let closing = 1.0 - (nx * velocity.x + ny * velocity.y);
            let time = born + distance.max(0.0) / closing;
            if distance > -SAME_M && closing > 1e-9 { time } else { f64::INFINITY }
        }));
        let (mut best, mut found) = (f64::INFINITY, NONE);
        for (edge, &time) in self.meetings.iter().enumerate() {
            if time < best {
                let edge = edge as u32;
                let is_new = after.is_none_or(|(last, number)| time > last || time == last && edge > number);
                if is_new && edge != c.before && edge != c.after {
                    (best, found) = (time, edge);
                }
            }
        }
        if found != NONE {
            self.events.push(Reverse(Event { time: best, corner, what: What::Meets(found) }));
        }
    }

    /// The corner before the stretch of an edge that an inner corner is at, if any is there still.
    fn segment(&self, inner: u32, edge: u32, time: f64) -> Option<u32> {
        let place = self.corners[inner as usize].at(time);
        let along = self.lines.along(edge);
        let mut best: Option<(f64, u32)> = None;
        let mut number = self.on_edge[edge as usize];
        while number != NONE {
            let a = &self.corners[number as usize];
            if a.kind != Kind::Done && number != inner && a.next != inner {
                let b = &self.corners[a.next as usize];
                let room = (place - a.at(time)).dot(along).min((b.at(time) - place).dot(along));
                if room > -TOUCH_M && best.is_none_or(|(most, _)| room > most) {
                    best = Some((room, number));
                }
            }
            number = a.same_edge;
        }
        best.map(|(_, number)| number)
    }

    /// A node at a place, now; one that is there already, if there is.
    fn node(&mut self, pos: DVec2) -> u32 {
        let nodes = &mut self.skeleton.nodes;
        let now = self.now;
        let recent = nodes.iter().enumerate().skip(self.lines.len()).rev().take_while(|(_, node)| node.z > now - SAME_M);
        for (i, node) in recent {
            if node.truncate().distance_squared(pos) < SAME_M * SAME_M {
                return i as u32;
            }
        }
        nodes.push(pos.extend(now));
        nodes.len() as u32 - 1
    }

    fn add_arc(&mut self, from: u32, to: u32, before: u32, after: u32) {
        if from != to {
            self.halves.push(Half { face: before, from, to });
            self.halves.push(Half { face: after, from: to, to: from });
        }
    }

    /// Ends a corner's arc at a node.
    fn finish(&mut self, corner: u32, node: u32) {
        let Corner { node: from, before, after, .. } = self.corners[corner as usize];
        self.add_arc(from, node, before, after);
        self.corners[corner as usize].kind = Kind::Done;
    }

    /// A new corner in the place of those between two others.
    fn join(&mut self, node: u32, before: u32, after: u32, prev: u32, next: u32) {
        let corner = self.add_corner(node, before, after, prev, next);
        self.corners[prev as usize].next = corner;
        self.corners[next as usize].prev = corner;
        self.settle(corner);
    }

    /// The edge after a corner has shrunk to nothing.
    fn close(&mut self, a: u32) {
        let first = self.corners[a as usize];
        let (b, second) = (first.next, self.corners[first.next as usize]);
        // The slower of the two is where it is more surely.
        let pos = if first.velocity.length_squared() < second.velocity.length_squared() { first } else { second }.at(self.now);
        let node = self.node(pos);
        self.finish(a, node);
        self.finish(b, node);
        if first.prev != b {
            self.join(node, first.before, second.after, first.prev, second.next);
        }
    }

    /// An inner corner has run into the edge after another one.
    fn split(&mut self, inner: u32, a: u32) {
        let Corner { before, after, prev, next, .. } = self.corners[inner as usize];
        let Corner { after: edge, next: b, .. } = self.corners[a as usize];
        let node = self.node(self.corners[inner as usize].at(self.now));
        self.finish(inner, node);
        // Both loops are closed before anything else happens to one.
        let first = self.add_corner(node, before, edge, prev, b);
        let second = self.add_corner(node, edge, after, a, next);
        self.corners[prev as usize].next = first;
        self.corners[b as usize].prev = first;
        self.corners[a as usize].next = second;
        self.corners[next as usize].prev = second;
        self.settle(first);
        self.settle(second);
    }

    /// Ends loops of two corners, zips up edges that lie on one another, and foresees what happens to what is left.
    fn settle(&mut self, corner: u32) {
        let Corner { prev, next, node, before, after, kind, pos, .. } = self.corners[corner as usize];
        if kind == Kind::Done {
            return;
        }
        if prev == next {
            let other = self.node(self.corners[prev as usize].at(self.now));
            self.finish(corner, other);
            self.finish(prev, other);
        } else if kind == Kind::Zip {
            let gap = |c: u32| self.corners[c as usize].at(self.now).distance_squared(pos);
            let is_back = gap(prev) <= gap(next);
            let nearer = self.corners[if is_back { prev } else { next } as usize];
            let other = self.node(nearer.at(self.now));
            self.add_arc(node, other, before, after);
            self.corners[corner as usize].kind = Kind::Done;
            if is_back {
                self.finish(prev, other);
                self.join(other, nearer.before, after, nearer.prev, next);
            } else {
                self.finish(next, other);
                self.join(other, before, nearer.after, prev, nearer.next);
            }
        } else {
            self.watch_edge(prev);
            self.watch_edge(corner);
            self.look_ahead(corner, None);
        }
    }

    /// Puts the arcs' halves together to faces; whether all come out closed.
    fn gather_faces(&mut self) -> bool {
        let Self { lines, skeleton, halves, firsts, sorted, .. } = self;
        let edges = lines.len();
        firsts.clear();
        firsts.resize(edges + 1, 0);
        for half in halves.iter() {
            firsts[half.face as usize + 1] += 1;
        }
        for i in 0..edges {
            firsts[i + 1] += firsts[i];
        }
        sorted.clear();
        sorted.resize(halves.len(), Half { face: 0, from: 0, to: 0 });
        for half in halves.iter().rev() {
            let last = &mut firsts[half.face as usize + 1];
            *last -= 1;
            sorted[*last as usize] = *half;
        }
        // Each number has moved to where its face begins.
        firsts.push(halves.len() as u32);
        skeleton.corners.clear();
        skeleton.ends.clear();
        for edge in 0..edges {
            let of_face = &mut sorted[firsts[edge + 1] as usize..firsts[edge + 2] as usize];
            let start = edge as u32;
            let mut here = lines.to[edge];
            skeleton.corners.extend([start, here]);
            let mut used = 0;
            while here != start {
                let Some(at) = of_face[used..].iter().position(|half| half.from == here) else { return false };
                of_face.swap(used, used + at);
                here = of_face[used].to;
                used += 1;
                skeleton.corners.push(here);
            }
            skeleton.corners.pop();
            skeleton.ends.push(skeleton.corners.len() as u32);
            if used < of_face.len() || used < 2 {
                return false;
            }
        }
        true
    }

    pub fn node_at(&self, node: u32) -> DVec3 {
        self.skeleton.nodes[node as usize]
    }
}

/// How far corners are moved before they begin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Jitter {
    /// At most so far, metres.
    pub by: f64,
    /// Which way, for each of its numbers another.
    pub number: usize,
}

impl Jitter {
    fn of(self, corner: usize) -> DVec2 {
        let draw = Draw::new(self.number as u64, Id(corner as u64), "jitter");
        DVec2::new(draw.between("x", -self.by, self.by), draw.between("y", -self.by, self.by))
    }
}
