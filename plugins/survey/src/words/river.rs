//! The river: two quays from border to border with water between them, and bridges over it.

use core::f64::consts::{PI, TAU};

use glam::DVec2;
use veduta_city::draw::Draw;
use veduta_city::{Id, Ring, StreetClass};

use super::description::{Passes, River};
use super::fabric::{End, Fabric, FaceId, Role, Spot, Use, WayId, crossings};
use super::shape::Shape;

/// A river as it lies in the town.
#[derive(Debug, Clone)]
pub(super) struct Channel {
    /// Its middle, from beyond the border to beyond the border, downstream.
    pub middle: Vec<DVec2>,
    pub width_m: f64,
    /// Distance from its middle to the middle of a quay, metres.
    pub quay_at_m: f64,
    /// Where the quays end on the border.
    pub mouths: Vec<Spot>,
}

/// A bridge in the fabric.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bridge {
    pub ends: [Spot; 2],
    pub way: WayId,
}

/// Room between bridges, and between a bridge and the border; metres.
const BRIDGE_GAP_M: f64 = 45.0;

impl Channel {
    /// Where the words want it; `quay_m` is the width of the streets along it, `widest_m` that of the widest of
    /// the town.
    pub fn new(river: &River, shape: &Shape, quay_m: f64, widest_m: f64, seed: u64) -> Self {
        let draw = Draw::new(seed, Id(3), "words: river");
        let heading = river.heading_deg.map_or_else(|| draw.between("heading", 0.0, TAU), f64::to_radians);
        // Headings run clockwise from north.
        let flow = DVec2::new(libm::sin(heading), libm::cos(heading));
        let radius = shape.radius_m(flow.perp()).min(shape.radius_m(-flow.perp())).min(shape.radius_m(flow));
        let wave = 4.0 * radius / f64::from(river.bends.max(1));
        let tightest = 1.6 * (river.width_m + quay_m).max(widest_m);
        let sway = if river.bends == 0 { 0.0 } else { (0.1 * radius).min(wave * wave / (TAU * TAU * tightest)) };
        let share = match river.passes {
            Passes::Centre => draw.between("share", 0.04, 0.14),
            Passes::Beside => draw.between("share", 0.36, 0.46),
            Passes::Edge => draw.between("share", 0.6, 0.66),
        };
        let away =
            (share * radius).min(0.74 * radius - river.width_m / 2.0 - sway) * if draw.chance("side", 0.5) { 1.0 } else { -1.0 };
        let phase = draw.between("phase", 0.0, TAU);
        let reach = shape.reach_m() + 60.0;
        let count = libm::ceil(2.0 * reach / (radius / 30.0).clamp(8.0, 30.0)) as usize;
        let at = |i: usize| {
            let s = reach * (2.0 * i as f64 / count as f64 - 1.0);
            flow * s + flow.perp() * (away + sway * libm::sin(TAU * s / wave + phase))
        };
        // Streets that end on either quay, face to face, keep apart.
        let quay_at_m = (river.width_m / 2.0 + quay_m / 2.0).max(0.55 * widest_m);
        Self { middle: (0..=count).map(at).collect(), width_m: river.width_m, quay_at_m, mouths: Vec::new() }
    }

    /// A line beside the middle, so far to its left.
    pub fn beside(&self, left_m: f64) -> Vec<DVec2> {
        let n = self.middle.len();
        let at = |i: usize| self.middle.get(i).copied().unwrap_or_default();
        (0..n)
            .map(|i| {
                let along = at((i + 1).min(n - 1)) - at(i.saturating_sub(1));
                at(i) + along.perp().normalize_or_zero() * left_m
            })
            .collect()
    }

    /// The water, as far as it is drawn.
    pub fn water(&self) -> Ring {
        let mut ring = self.beside(-self.width_m / 2.0);
        ring.extend(self.beside(self.width_m / 2.0).into_iter().rev());
        ring
    }

    /// Distance of a spot from the middle of the water, metres.
    pub fn distance_m(&self, p: DVec2) -> f64 {
        self.middle.windows(2).map(|w| super::fit::distance_to(p, w[0], w[1])).fold(f64::INFINITY, f64::min)
    }

    /// Lays the quays into a fabric of one face; `None` where the river misses the town.
    pub fn lay(&mut self, fabric: &mut Fabric, quay: WayId) -> Option<()> {
        let border = fabric.outline(0);
        let lines = [self.beside(self.quay_at_m), self.beside(-self.quay_at_m)];
        let [left, right] = lines.each_ref().map(|line| within(line, &border));
        let (left, right) = (left?, right?);
        let rest = cut(fabric, 0, &left, quay, &mut self.mouths)?;
        cut(fabric, rest, &right, quay, &mut self.mouths)?;
        fabric.faces.get_mut(rest)?.use_ = Use::Water;
        Some(())
    }
}

/// The stretch of a line about its middle that lies within a border.
fn within(line: &[DVec2], border: &[DVec2]) -> Option<Vec<DVec2>> {
    let is_inside = |p: DVec2| crossings(border, p, DVec2::X).iter().filter(|c| c.1.x > p.x).count() % 2 == 1;
    let inside: Vec<bool> = line.iter().map(|&p| is_inside(p)).collect();
    let start = (0..line.len()).filter(|&i| inside[i]).min_by_key(|&i| i.abs_diff(line.len() / 2))?;
    let first = (0..start).rev().take_while(|&i| inside[i]).last().unwrap_or(start);
    let last = (start..line.len()).take_while(|&i| inside[i]).last()?;
    let (before, after) = (line.get(first.checked_sub(1)?)?, line.get(last + 1)?);
    let exit = |from: DVec2, to: DVec2| {
        let hits = crossings(border, from, to - from);
        hits.into_iter()
            .map(|c| c.1)
            .filter(|c| (*c - from).dot(to - from) > 0.0)
            .min_by(|a, b| a.distance(from).total_cmp(&b.distance(from)))
    };
    let mut out = vec![exit(*line.get(first)?, *before)?];
    out.extend(line.get(first..=last)?);
    out.push(exit(*line.get(last)?, *after)?);
    Some(out)
}

/// Cuts a face along a line whose ends lie on its border.
fn cut(fabric: &mut Fabric, face: FaceId, line: &[DVec2], way: WayId, mouths: &mut Vec<Spot>) -> Option<FaceId> {
    let (&first, &last) = (line.first()?, line.last()?);
    let inner: Vec<(DVec2, WayId)> = line
        .get(1..line.len() - 1)?
        .iter()
        .filter(|p| p.distance(first) > 4.0 && p.distance(last) > 4.0)
        .map(|&p| (p, way))
        .collect();
    let mut end = |p: DVec2| {
        let outline = fabric.outline(face);
        let nearest = (0..outline.len()).min_by(|&i, &j| {
            let d = |i: usize| super::fit::distance_to(p, outline[i], outline[(i + 1) % outline.len()]);
            d(i).total_cmp(&d(j))
        })?;
        let end = fabric.end_near(face, nearest, p, 0.5)?;
        let spot = fabric.place(end);
        mouths.push(spot);
        Some(spot)
    };
    let (from, to) = (end(first)?, end(last)?);
    fabric.split(face, from, &inner, to, way)
}

/// Bridges at the lines given, best first, as many as are wanted and have room.
pub(super) fn bridges(
    fabric: &mut Fabric,
    channel: &Channel,
    lines: &[(DVec2, DVec2)],
    wanted: usize,
    (class, width_m): (StreetClass, f64),
) -> Vec<Bridge> {
    let mut built: Vec<Bridge> = Vec::new();
    let gap = BRIDGE_GAP_M.max(width_m * 3.0);
    for &(through, dir) in lines {
        if built.len() >= wanted {
            break;
        }
        let mouths_far = channel.mouths.iter().all(|&m| fabric.pos(m).distance(through) > channel.quay_at_m + 20.0);
        let others_far = built.iter().all(|b| (fabric.pos(b.ends[0]) + fabric.pos(b.ends[1])).distance(through * 2.0) > 2.0 * gap);
        if mouths_far && others_far {
            built.extend(bridge(fabric, channel, through, dir, (class, width_m)));
        }
    }
    built
}

fn bridge(
    fabric: &mut Fabric,
    channel: &Channel,
    through: DVec2,
    dir: DVec2,
    (class, width_m): (StreetClass, f64),
) -> Option<Bridge> {
    let waters: Vec<FaceId> = (0..fabric.faces.len()).filter(|&f| fabric.faces[f].use_ == Use::Water).collect();
    let most_m = 2.0 * channel.quay_at_m * 1.45;
    for face in waters {
        for [a, b] in crossings(&fabric.outline(face), through, dir).as_chunks::<2>().0 {
            let is_here = (a.1 - through).dot(b.1 - through) <= 0.0 && a.1.distance(b.1) <= most_m;
            if !is_here {
                continue;
            }
            let (from, to) = (fabric.end_near(face, a.0, a.1, 4.0)?, fabric.end_near(face, b.0, b.1, 4.0)?);
            let is_free = |end: End| match end {
                End::At(spot) => fabric.neighbours(spot).len() == 2,
                End::On(..) => true,
            };
            if !is_free(from) || !is_free(to) {
                return None;
            }
            let ends = [fabric.place(from), fabric.place(to)];
            let way = fabric.add_way(Role::Bridge(class), width_m, false);
            fabric.split(face, ends[0], &[], ends[1], way)?;
            return Some(Bridge { ends, way });
        }
    }
    None
}

/// Lines square to the river: the one nearest to `hub` first, then where rings (shares of the radius) come to it, then others at
/// even distances.
pub(super) fn crossings_of(channel: &Channel, shape: &Shape, hub: DVec2, count: usize, rings: &[f64]) -> Vec<(DVec2, DVec2)> {
    let in_town: Vec<usize> = (1..channel.middle.len() - 1).filter(|&i| shape.share(channel.middle[i]) < 0.9).collect();
    let Some(&nearest) =
        in_town.iter().min_by(|&&i, &&j| channel.middle[i].distance(hub).total_cmp(&channel.middle[j].distance(hub)))
    else {
        return Vec::new();
    };
    // Finer than asked for, so that a spot without room has a neighbour.
    let step = (in_town.len() / (count * 2 + 1)).max(1);
    let line = |i: usize| {
        let along = channel.middle[i + 1] - channel.middle[i - 1];
        (channel.middle[i], along.perp().normalize_or_zero())
    };
    let mut order: Vec<usize> = in_town.iter().copied().filter(|&i| i.abs_diff(nearest) % step == 0).collect();
    order.sort_by_key(|&i| (i.abs_diff(nearest) / step % 2, i.abs_diff(nearest), i));
    let on_ring = in_town.iter().copied().filter(|&i| {
        let share = |i: usize| shape.share(channel.middle[i]);
        rings.iter().any(|r| (share(i) > *r) != (share(i + 1) > *r))
    });
    let first = order.first().copied();
    first.into_iter().chain(on_ring).chain(order).map(line).collect()
}

/// Whether two directions are within 45° of a right angle to one another.
pub(super) fn is_square_on(channel: &Channel, through: DVec2, dir: DVec2) -> bool {
    let nearest = (1..channel.middle.len()).min_by(|&i, &j| {
        let d = |i: usize| super::fit::distance_to(through, channel.middle[i - 1], channel.middle[i]);
        d(i).total_cmp(&d(j))
    });
    nearest.is_some_and(|i| {
        let along = channel.middle[i] - channel.middle[i - 1];
        along.dot(dir).abs() < libm::cos(PI / 4.0) * along.length() * dir.length()
    })
}

/// Places where a line meets the middle of the water.
pub(super) fn fords(channel: &Channel, through: DVec2, dir: DVec2) -> Vec<DVec2> {
    let side = |p: DVec2| dir.perp_dot(p - through);
    let pieces = channel.middle.windows(2).filter(|w| (side(w[0]) > 0.0) != (side(w[1]) > 0.0));
    pieces.map(|w| w[0].lerp(w[1], side(w[0]) / (side(w[0]) - side(w[1])))).collect()
}
