//! Where crossroads really are, and which are one.
//!
//! Thinning bends the lines of streets towards one another where they meet, and makes two crossroads of one that is not
//! quite square. So a crossroads is put where the streets that lead to it would meet if they went on as they come; and
//! two joined by a very short street are one if those places lie closer together than the streets are wide.

use std::collections::VecDeque;

use glam::DVec2;

use super::bitmap::Bitmap;
use super::measure::clearance;
use super::sketch::{Sketch, SketchStreet};

/// What of a street, as it comes to a node, shows where it would go on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Arm {
    /// A point on it.
    pub through: DVec2,
    /// Its direction, of length 1.
    pub along: DVec2,
    /// How far from the node its straight stretch begins, pixels.
    pub from: f64,
}

/// Crossroads closer together than this many widths of the streets around are one …
const ONE_WIDTHS: f64 = 1.15;
/// … and so are those closer than this many metres.
const ONE_M: f64 = 9.0;

/// Places are known to about a quarter of that limit only, and few crossroads lie just below it.
const CLEARLY: f64 = 0.75;
/// A street shows where it goes by a straight stretch of so many pixels.
const LEAST_STRAIGHT_PX: f64 = 6.0;

/// Of a street's length, as much may at each end be what its skeleton swerves.
const MOST_SWERVE: f64 = 0.45;

/// Puts crossroads where their streets meet, and makes one of those that are one. `mpp`: metres a pixel.
pub(crate) fn settle(sketch: &mut Sketch, paved: &Bitmap, mpp: f64) {
    let at = sketch.ends();
    let lengths: Vec<f64> = sketch.streets.iter().map(SketchStreet::length).collect();
    let swerves: Vec<[f64; 2]> =
        sketch.streets.iter().map(|s| [swerve(s, 0, sketch, paved), swerve(s, 1, sketch, paved)]).collect();
    let arm_of = |i: usize, end: usize| arm(&sketch.streets[i], end, swerves[i][end], lengths[i], sketch);
    let arms: Vec<[Option<Arm>; 2]> = (0..sketch.streets.len()).map(|i| [arm_of(i, 0), arm_of(i, 1)]).collect();
    // Too short to show where they go: all of their line is bent by what meets at their ends.
    let is_short = |i: usize| {
        let [a, b] = sketch.streets[i].ends;
        at[a].len() > 2 && at[b].len() > 2 && lengths[i] < swerves[i][0] + swerves[i][1] + LEAST_STRAIGHT_PX
    };
    let short: Vec<bool> = (0..sketch.streets.len()).map(is_short).collect();
    let place = |node: usize| -> DVec2 {
        let long = |&(i, end): &(usize, usize)| arms[i][end].filter(|_| !short[i]);
        meeting(sketch.nodes[node].pos, sketch.nodes[node].radius, at[node].iter().filter_map(long))
    };
    let places: Vec<DVec2> =
        (0..sketch.nodes.len()).map(|n| if at[n].len() > 2 { place(n) } else { sketch.nodes[n].pos }).collect();

    let mut groups = Groups::new(sketch.nodes.len());
    let mut order: Vec<(f64, usize)> = (0..sketch.streets.len())
        .filter(|&i| sketch.streets[i].ends.iter().all(|&n| at[n].len() > 2))
        .map(|i| {
            let [a, b] = sketch.streets[i].ends;
            (places[a].distance(places[b]), i)
        })
        .collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut gone = vec![false; sketch.streets.len()];
    for (apart, i) in order {
        let [a, b] = sketch.streets[i].ends;
        let around = at[a].iter().chain(&at[b]).filter(|(j, _)| *j != i && !short[*j]);
        let width = around.map(|&(j, _)| 2.0 * sketch.streets[j].half).fold(0.0, f64::max);
        let mut limit = (ONE_WIDTHS * width).max(ONE_M / mpp);
        let to_blind = |n: usize| at[n].iter().any(|&(j, end)| at[sketch.streets[j].ends[1 - end]].len() == 1);
        if to_blind(a) || to_blind(b) {
            // A passage opens on a street where it likes, however near to the next.
            limit *= 0.5;
        }
        if apart < CLEARLY * limit && groups.join(a, b, &places, 1.3 * limit) {
            gone[i] = true;
        }
    }
    for (i, gone) in gone.iter_mut().enumerate() {
        let [a, b] = sketch.streets[i].ends;
        let within = groups.of(a) == groups.of(b) && (a != b || sketch.nodes[a].square.is_none());
        *gone |= within && at[a].len() > 2 && lengths[i] < 4.0 * sketch.nodes[a].radius.max(sketch.nodes[b].radius);
    }
    let new_places: Vec<DVec2> = (0..sketch.nodes.len())
        .map(|n| {
            let members = groups.members(n);
            if members.len() < 2 {
                return places[n];
            }
            let middle = members.iter().map(|&m| places[m]).sum::<DVec2>() / members.len() as f64;
            let radius = members.iter().map(|&m| sketch.nodes[m].radius).fold(0.0, f64::max);
            let long = members.iter().flat_map(|&m| &at[m]).filter(|(i, _)| !gone[*i]);
            meeting(middle, radius, long.filter_map(|&(i, end)| arms[i][end].filter(|_| !short[i])))
        })
        .collect();
    for (node, pos) in sketch.nodes.iter_mut().zip(&new_places) {
        node.pos = *pos;
    }
    for (i, street) in sketch.streets.iter_mut().enumerate() {
        for (end, swerve) in swerves[i].into_iter().enumerate() {
            let old = street.ends[end];
            let new = groups.of(old);
            street.ends[end] = new;
            if at[old].len() > 2 {
                street.tie(end, sketch.nodes[new].pos, swerve.min(MOST_SWERVE * lengths[i]));
            }
        }
    }
    let mut i = 0;
    sketch.streets.retain(|_| {
        i += 1;
        !gone[i - 1]
    });
    sketch.drop_lone_nodes();
}

impl SketchStreet {
    /// Ends its line at a new place of a node, without what of it lies within `trim` of the old.
    fn tie(&mut self, end: usize, place: DVec2, trim: f64) {
        if end == 1 {
            self.line.reverse();
        }
        let old = self.line[0];
        let keep =
            self.line.iter().position(|p| p.distance(old) >= trim && p.distance(place) >= 1.0).unwrap_or(self.line.len() - 1);
        self.line.drain(..keep);
        self.line.insert(0, place);
        if end == 1 {
            self.line.reverse();
        }
    }
}

/// How a street so long comes to the node at one of its ends.
fn arm(street: &SketchStreet, end: usize, swerve: f64, length: f64, sketch: &Sketch) -> Option<Arm> {
    let far = sketch.nodes[street.ends[1 - end]];
    let from = (swerve + 0.5 * street.half).min(0.5 * length);
    let to = (from + (3.0 * street.half).max(10.0)).min(length - (1.15 * far.radius).min(0.3 * length)).max(from + 3.0);
    let (mut gone, mut before) = (0.0, sketch.nodes[street.ends[end]].pos);
    let mut points: Vec<DVec2> = Vec::new();
    for point in street.seen_from(end) {
        gone += before.distance(point);
        before = point;
        if gone > to {
            break;
        }
        if gone >= from {
            points.push(point);
        }
    }
    line_through(&points, from)
}

impl Arm {
    /// How far the farthest of some points is from its line.
    pub fn farthest(&self, points: &[DVec2]) -> f64 {
        points.iter().map(|p| self.along.perp_dot(*p - self.through).abs()).fold(0.0, f64::max)
    }
}

/// How far along a street from a node its skeleton is bent by what else meets there: until the room about it no longer
/// narrows.
fn swerve(street: &SketchStreet, end: usize, sketch: &Sketch, paved: &Bitmap) -> f64 {
    let node = sketch.nodes[street.ends[end]];
    let (mut gone, mut before) = (0.0, node.pos);
    // Room at places ahead, the nearest first: a place is judged once those within two radii ahead of it are known.
    let mut rooms: VecDeque<(f64, f64)> = VecDeque::new();
    let is_narrow = |rooms: &VecDeque<(f64, f64)>| {
        let least = rooms.iter().map(|(_, room)| *room).fold(f64::MAX, f64::min);
        rooms.front().filter(|(_, room)| *room < 1.08 * least + 0.5).map(|(at, _)| at + 1.0)
    };
    let (ahead, reach) = (2.0 * node.radius, 8.0 * node.radius + 20.0);
    for (i, point) in street.seen_from(end).enumerate() {
        gone += before.distance(point);
        before = point;
        if gone > reach {
            break;
        }
        if gone < 0.7 * node.radius || i % 2 == 1 {
            continue;
        }
        rooms.push_back((gone, clearance(paved, point, node.radius + 2.0)));
        while rooms.front().is_some_and(|(at, _)| at + ahead <= gone) {
            if let Some(at) = is_narrow(&rooms) {
                return at;
            }
            rooms.pop_front();
        }
    }
    while !rooms.is_empty() {
        if let Some(at) = is_narrow(&rooms) {
            return at;
        }
        rooms.pop_front();
    }
    gone
}

/// The line nearest to some points: that through their middle along which they spread most.
pub(crate) fn line_through(points: &[DVec2], from: f64) -> Option<Arm> {
    if points.len() < 3 {
        return None;
    }
    let middle = points.iter().copied().sum::<DVec2>() / points.len() as f64;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for p in points {
        let d = *p - middle;
        (xx, xy, yy) = (xx + d.x * d.x, xy + d.x * d.y, yy + d.y * d.y);
    }
    let angle = 0.5 * libm::atan2(2.0 * xy, xx - yy);
    Some(Arm { through: middle, along: DVec2::new(libm::cos(angle), libm::sin(angle)), from })
}

/// The point nearest to all arms, and, where they leave that open, to a first guess; never farther than 1.6 radii from it.
fn meeting(guess: DVec2, radius: f64, arms: impl Iterator<Item = Arm> + Clone) -> DVec2 {
    /// Two arms at an angle of 30° just fix a point.
    const SURE: f64 = 0.08;
    // Normal equations of the distances to the arms.
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    let mut right = DVec2::ZERO;
    // What has to be carried on far is known less.
    let trust = |arm: &Arm| 1.0 / ((arm.from + 3.0) * (arm.from + 3.0));
    let most = arms.clone().map(|arm| trust(&arm)).fold(0.0, f64::max);
    for arm in arms {
        let (normal, weight) = (arm.along.perp(), trust(&arm) / most);
        let off = normal.dot(arm.through - guess);
        xx += weight * normal.x * normal.x;
        xy += weight * normal.x * normal.y;
        yy += weight * normal.y * normal.y;
        right += normal * (weight * off);
    }
    // Along the directions in which the arms say little, the guess stands.
    let angle = 0.5 * libm::atan2(2.0 * xy, xx - yy);
    let axis = DVec2::new(libm::cos(angle), libm::sin(angle));
    let mut step = DVec2::ZERO;
    for axis in [axis, axis.perp()] {
        let weight = xx * axis.x * axis.x + 2.0 * xy * axis.x * axis.y + yy * axis.y * axis.y;
        if weight > SURE {
            step += axis * (right.dot(axis) / weight);
        }
    }
    guess + step.clamp_length_max(1.6 * radius + 2.0)
}

/// Nodes that are one.
struct Groups {
    root: Vec<usize>,
    members: Vec<Vec<usize>>,
}

impl Groups {
    fn new(n: usize) -> Self {
        Self { root: (0..n).collect(), members: (0..n).map(|i| vec![i]).collect() }
    }

    fn of(&self, node: usize) -> usize {
        self.root[node]
    }

    fn members(&self, node: usize) -> &[usize] {
        &self.members[self.root[node]]
    }

    /// Makes one of two groups, if all of it then lies within `extent`. Whether they are one now.
    fn join(&mut self, a: usize, b: usize, places: &[DVec2], extent: f64) -> bool {
        let (a, b) = (self.root[a].min(self.root[b]), self.root[a].max(self.root[b]));
        if a == b {
            return true;
        }
        let all = || self.members[a].iter().chain(&self.members[b]).map(|&m| places[m]);
        let (low, high) = all().fold((DVec2::MAX, DVec2::MIN), |(low, high), p| (low.min(p), high.max(p)));
        if (high - low).max_element() >= extent {
            return false;
        }
        let moved = core::mem::take(&mut self.members[b]);
        for &m in &moved {
            self.root[m] = a;
        }
        self.members[a].extend(moved);
        true
    }
}
