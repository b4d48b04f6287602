//! The street network while it is read: nodes and streets in pixels, y down.

use glam::DVec2;

use super::bitmap::Bitmap;
use super::measure::{clearance, is_clear, median, ray};
use super::profile::range;
use super::trace::{Traced, TracedLine};

/// Nodes and streets.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sketch {
    pub nodes: Vec<SketchNode>,
    pub streets: Vec<SketchStreet>,
}

/// An end of streets.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SketchNode {
    pub pos: DVec2,
    /// Radius of the largest disc of street about it.
    pub radius: f64,
    /// The square on whose border it lies.
    pub square: Option<usize>,
}

/// A street between two nodes.
#[derive(Debug, Clone, Default)]
pub(crate) struct SketchStreet {
    pub ends: [usize; 2],
    /// From the first node to the last, both included.
    pub line: Vec<DVec2>,
    /// Half its width.
    pub half: f64,
    /// The least and the greatest half width along it, single places aside.
    pub range: [f64; 2],
}

impl SketchStreet {
    pub fn length(&self) -> f64 {
        length(&self.line)
    }

    /// Its line as seen from one end.
    pub fn seen_from(&self, end: usize) -> impl Iterator<Item = DVec2> + Clone + '_ {
        let n = self.line.len();
        (0..n).map(move |i| if end == 0 { self.line[i] } else { self.line[n - 1 - i] })
    }
}

/// Length of a line.
pub(crate) fn length(line: &[DVec2]) -> f64 {
    line.windows(2).map(|w| w[0].distance(w[1])).sum()
}

/// Widest half street that is measured, pixels.
const REACH: f64 = 400.0;

impl Sketch {
    /// A sketch of a traced skeleton, with widths measured in the streets it is the skeleton of.
    pub fn of(traced: Traced, paved: &Bitmap) -> Self {
        let nodes: Vec<SketchNode> =
            traced.nodes.iter().map(|&pos| SketchNode { pos, radius: clearance(paved, pos, REACH), square: None }).collect();
        let street = |line: TracedLine| SketchStreet { ends: line.ends, line: line.path, half: 0.0, range: [0.0; 2] };
        let streets = traced.lines.into_iter().map(street).collect();
        Self { nodes, streets }
    }

    /// The streets that end at each node, with the end; one that returns is there twice.
    pub fn ends(&self) -> Vec<Vec<(usize, usize)>> {
        let mut at = vec![Vec::new(); self.nodes.len()];
        for (i, street) in self.streets.iter().enumerate() {
            at[street.ends[0]].push((i, 0));
            at[street.ends[1]].push((i, 1));
        }
        at
    }

    /// How many streets end at each node.
    pub fn degrees(&self) -> Vec<usize> {
        let mut degrees = vec![0; self.nodes.len()];
        for street in &self.streets {
            degrees[street.ends[0]] += 1;
            degrees[street.ends[1]] += 1;
        }
        degrees
    }

    /// Measures every street's width square to its line.
    pub fn measure(&mut self, paved: &Bitmap) {
        for street in &mut self.streets {
            let nodes = street.ends.map(|n| self.nodes[n].radius);
            (street.half, street.range) = half_width(&street.line, nodes, paved);
        }
    }

    /// Takes out branches that hardly leave the street they start from: what thinning makes of bumps and corners.
    pub fn prune(&mut self) {
        let mut degrees = self.degrees();
        let is_branch = |street: &SketchStreet| street.ends.iter().any(|&n| degrees[n] == 1);
        let branches = self.streets.iter().enumerate().filter(|(_, street)| is_branch(street));
        let mut order: Vec<(f64, usize)> = branches.map(|(i, street)| (street.length(), i)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut gone = vec![false; self.streets.len()];
        for (length, i) in order {
            let [a, b] = self.streets[i].ends;
            for (tip, root) in [(a, b), (b, a)] {
                if degrees[tip] == 1
                    && self.nodes[tip].square.is_none()
                    && degrees[root] > 2
                    && length < SPUR_RADII * self.nodes[root].radius + 2.0
                {
                    degrees[tip] -= 1;
                    degrees[root] -= 1;
                    gone[i] = true;
                    break;
                }
            }
        }
        let mut i = 0;
        self.streets.retain(|_| {
            i += 1;
            !gone[i - 1]
        });
    }

    /// Joins streets that meet alone; nodes at which nothing ends any more are dropped.
    pub fn join_chains(&mut self) {
        let at = self.ends();
        let is_chain = |n: usize, sketch: &Self| at[n].len() == 2 && at[n][0].0 != at[n][1].0 && sketch.nodes[n].square.is_none();
        let mut done = vec![false; self.streets.len()];
        let mut joined = Vec::new();
        let start_at_ends = (0..self.streets.len()).flat_map(|i| [(i, 0), (i, 1)]);
        let starts: Vec<(usize, usize)> =
            start_at_ends.clone().filter(|&(i, end)| !is_chain(self.streets[i].ends[end], self)).chain(start_at_ends).collect();
        for (first, end) in starts {
            if done[first] {
                continue;
            }
            let (mut i, mut end) = (first, end);
            if self.streets[i].ends.iter().all(|&n| !is_chain(n, self)) {
                done[i] = true;
                joined.push(core::mem::take(&mut self.streets[i]));
                continue;
            }
            let begin = self.streets[first].ends[end];
            let (mut line, mut weight, mut half, mut range) = (vec![self.nodes[begin].pos], 0.0, 0.0, [f64::MAX, f64::MIN]);
            loop {
                done[i] = true;
                let street = &self.streets[i];
                line.extend(street.seen_from(end).skip(1));
                let length = street.length().max(1e-9);
                (weight, half) = (weight + length, half + street.half * length);
                range = [range[0].min(street.range[0]), range[1].max(street.range[1])];
                let next = street.ends[1 - end];
                let onward = at[next].iter().copied().find(|&(j, _)| j != i && !done[j]);
                match onward.filter(|_| is_chain(next, self)) {
                    Some((j, e)) => (i, end) = (j, e),
                    None => {
                        joined.push(SketchStreet { ends: [begin, next], line, half: half / weight, range });
                        break;
                    }
                }
            }
        }
        self.streets = joined;
        self.drop_lone_nodes();
    }

    /// Drops nodes at which nothing ends.
    pub fn drop_lone_nodes(&mut self) {
        let degrees = self.degrees();
        let mut number = vec![0; self.nodes.len()];
        let mut kept = Vec::new();
        for (i, node) in self.nodes.iter().enumerate() {
            number[i] = kept.len();
            if degrees[i] > 0 {
                kept.push(*node);
            }
        }
        self.nodes = kept;
        for street in &mut self.streets {
            street.ends = street.ends.map(|n| number[n]);
        }
    }
}

/// A branch shorter than this many radii of the street it leaves is no blind alley.
const SPUR_RADII: f64 = 1.6;
/// Pixels between places where a width is measured.
const STATION_PX: usize = 3;
/// Half widths that differ by less are alike, pixels.
const LIKE_PX: f64 = 0.6;
/// Pixels ahead and back that tell a line's direction.
const CHORD_PX: usize = 6;

/// Half the width of a street, in pixels: the median over its length, away from the nodes (whose radii are given); and its
/// range.
fn half_width(line: &[DVec2], radii: [f64; 2], paved: &Bitmap) -> (f64, [f64; 2]) {
    let n = line.len();
    let margin = |radius: f64| ((1.2 * radius) as usize + 1).min(n * 3 / 8);
    let (from, to) = (margin(radii[0]), n - margin(radii[1]));
    let stations = || (from..to.max(from + 1)).step_by(STATION_PX);
    // Where the way across is much longer than there is room, it leads into another street.
    // A way as long as one that was found to lead across is taken to do so too.
    let mut good = f64::NAN;
    let is_across = |i: usize, half: f64| half < 1.0 || is_clear(paved, line[i], (half - 1.0) / 1.25);
    let mut halves = Vec::new();
    for i in stations() {
        let Some(half) = half_at(line, i, paved) else { continue };
        let is_like = (half - good).abs() < LIKE_PX;
        if is_like || is_across(i, half) {
            if !is_like {
                good = half;
            }
            halves.push(half);
        }
    }
    let room = || stations().map(|i| clearance(paved, line[i], REACH)).fold(f64::MAX, f64::min);
    let range = range(&halves);
    let half = median(&mut halves).unwrap_or_else(room);
    (half, range.unwrap_or([half; 2]))
}

/// Half the width across a line at one of its points.
fn half_at(line: &[DVec2], i: usize, paved: &Bitmap) -> Option<f64> {
    let (back, ahead) = (line[i.saturating_sub(CHORD_PX)], line[(i + CHORD_PX).min(line.len() - 1)]);
    let normal = (ahead - back).try_normalize()?.perp();
    let at = line[i];
    Some((ray(paved, at, normal, REACH) + ray(paved, at, -normal, REACH)) / 2.0)
}
