//! From a skeleton to a graph: places where its lines meet or end, and the lines between.

use std::collections::HashMap;

use glam::DVec2;

use super::bitmap::{Bitmap, CHUNK, ones};

/// A skeleton as a graph.
#[derive(Debug, Clone, Default)]
pub(crate) struct Traced {
    /// Middles of the places where lines meet or end, in pixels from the picture's upper left corner, y down.
    pub nodes: Vec<DVec2>,
    /// Lines.
    pub lines: Vec<TracedLine>,
}

/// A line of a skeleton.
#[derive(Debug, Clone)]
pub(crate) struct TracedLine {
    /// Nodes at its ends.
    pub ends: [usize; 2],
    /// The first node, the middles of the line's pixels, and the last node.
    pub path: Vec<DVec2>,
}

/// Traces a skeleton. Pixels with one neighbour are ends; pixels with three or more are, with those they touch, places
/// where lines meet; a closed line that nothing meets becomes a node and a line from it to itself.
#[must_use]
pub(crate) fn traced(skeleton: &Bitmap) -> Traced {
    let skeleton = slimmed(skeleton);
    let special = special_pixels(&skeleton);
    let mut tracer = Tracer {
        places: Bitmap::new(skeleton.width(), skeleton.height()),
        rest: skeleton,
        node_of: HashMap::default(),
        path: Vec::new(),
        traced: Traced::default(),
    };
    let places = tracer.nodes(&special);
    tracer.rest.remove(&tracer.places);
    for (node, pixels) in places.iter().enumerate() {
        for &(x, y) in pixels {
            tracer.leave(node, x, y);
        }
    }
    tracer.closed_lines();
    tracer.traced
}

/// Steps to the eight neighbours, in the order of [`Bitmap::around`].
const STEPS: [(isize, isize); 8] = [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1)];

struct Tracer {
    /// The pixels of nodes, and the node of each.
    places: Bitmap,
    node_of: HashMap<(u32, u32), u32, BuildPlace>,
    /// The skeleton's other pixels, as far as they are not on a line yet.
    rest: Bitmap,
    /// The line that is being followed.
    path: Vec<DVec2>,
    traced: Traced,
}

/// Pixel numbers spread well by one multiplication; nothing is ever read in the map's order.
type BuildPlace = core::hash::BuildHasherDefault<PlaceHasher>;

#[derive(Default)]
struct PlaceHasher(u64);

impl core::hash::Hasher for PlaceHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.write_u32(u32::from(byte));
        }
    }

    fn write_u32(&mut self, n: u32) {
        self.0 = (self.0.rotate_left(20) ^ u64::from(n)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    }
}

impl Tracer {
    /// Finds the nodes: for each its pixels.
    fn nodes(&mut self, special: &Bitmap) -> Vec<Vec<(usize, usize)>> {
        let mut places = Vec::new();
        for (x, y) in special.pixels() {
            if self.node_of.contains_key(&(x as u32, y as u32)) {
                continue;
            }
            let node = places.len() as u32;
            self.node_of.insert((x as u32, y as u32), node);
            let mut pixels = vec![(x, y)];
            let mut i = 0;
            while i < pixels.len() {
                let (x, y) = pixels[i];
                for next in neighbours(special.around(x, y), x, y) {
                    if let std::collections::hash_map::Entry::Vacant(entry) = self.node_of.entry((next.0 as u32, next.1 as u32)) {
                        entry.insert(node);
                        pixels.push(next);
                    }
                }
                i += 1;
            }
            for &(x, y) in &pixels {
                self.places.set(x, y, true);
            }
            let sum: DVec2 = pixels.iter().map(|&p| middle(p)).sum();
            self.traced.nodes.push(sum / pixels.len() as f64);
            places.push(pixels);
        }
        places
    }

    /// Follows the lines that leave a node at one of its pixels.
    fn leave(&mut self, node: usize, x: usize, y: usize) {
        for next in neighbours(self.rest.around(x, y), x, y) {
            // Another line may have returned by it.
            if self.rest.get(next.0 as isize, next.1 as isize) {
                let end = self.follow(node, (x, y), next);
                // A line that touches its own node twice at its only pixel leads nowhere.
                if self.path.len() > 2 || end != node {
                    self.add(node, end);
                }
            }
        }
    }

    /// Takes the pixels of a line from one on, away from another of a node. The node that they lead to: the same if
    /// none.
    fn follow(&mut self, node: usize, from: (usize, usize), first: (usize, usize)) -> usize {
        let (mut before, mut at) = (from, first);
        self.path.clear();
        self.path.push(self.traced.nodes[node]);
        loop {
            self.rest.set(at.0, at.1, false);
            self.path.push(middle(at));
            let Some(next) = neighbours(self.rest.around(at.0, at.1), at.0, at.1).next() else { break };
            (before, at) = (at, next);
        }
        let mut beside = neighbours(self.places.around(at.0, at.1), at.0, at.1);
        let end = beside.find(|&place| place != before).and_then(|(x, y)| self.node_of.get(&(x as u32, y as u32)));
        end.map_or(node, |&end| end as usize)
    }

    /// The line that was followed is one.
    fn add(&mut self, from: usize, to: usize) {
        self.path.push(self.traced.nodes[to]);
        self.traced.lines.push(TracedLine { ends: [from, to], path: self.path.to_vec() });
    }

    fn closed_lines(&mut self) {
        let starts = self.rest.clone();
        for (x, y) in starts.pixels() {
            let around = self.rest.around(x, y);
            if !self.rest.get(x as isize, y as isize) || around.count_ones() != 2 {
                continue;
            }
            let node = self.traced.nodes.len();
            self.traced.nodes.push(middle((x, y)));
            self.rest.set(x, y, false);
            let Some(next) = neighbours(around, x, y).next() else { continue };
            self.follow(node, (x, y), next);
            self.add(node, node);
        }
    }
}

/// A skeleton without the steps that thinning leaves on slanting lines: without the pixels in the corner of two others
/// whose neighbours hang together without them.
fn slimmed(skeleton: &Bitmap) -> Bitmap {
    let mut slim = skeleton.clone();
    let blank = vec![0; skeleton.stride() + 1];
    for y in 0..skeleton.height() {
        let above = if y > 0 { skeleton.padded(y - 1) } else { &blank };
        let below = if y + 1 < skeleton.height() { skeleton.padded(y + 1) } else { &blank };
        let at = skeleton.padded(y);
        for k in 0..at.len() - 2 {
            let (west, east) = (at[k + 1] << 1 | at[k] >> 63, at[k + 1] >> 1 | at[k + 2] << 63);
            for bit in ones(at[k + 1] & (above[k + 1] | below[k + 1]) & (west | east)) {
                let x = k * 64 + bit;
                if SPARE[usize::from(slim.around(x, y))] {
                    slim.set(x, y, false);
                }
            }
        }
    }
    slim
}

/// [`is_spare`] for every way that pixels can lie around one.
static SPARE: [bool; 256] = {
    let mut spare = [false; 256];
    let mut around = 0;
    while around < 256 {
        spare[around] = is_spare(around);
        around += 1;
    }
    spare
};

/// Whether a pixel with these around it lies in the corner of two of them, and all of them hang together without it.
const fn is_spare(around: usize) -> bool {
    let (mut is_corner, mut parts, mut side) = (false, 0, 0);
    while side < 8 {
        let [at, next, after] = [around >> side & 1 == 1, around >> (side + 1) & 1 == 1, around >> ((side + 2) % 8) & 1 == 1];
        is_corner |= at && after;
        parts += (!at && (next || after)) as u32;
        side += 2;
    }
    is_corner && parts == 1
}

fn middle((x, y): (usize, usize)) -> DVec2 {
    DVec2::new(x as f64 + 0.5, y as f64 + 0.5)
}

/// The places of the set neighbours of a pixel.
fn neighbours(around: u8, x: usize, y: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..8usize).filter(move |i| around >> i & 1 == 1).map(move |i| {
        let (dx, dy) = STEPS[i];
        ((x as isize + dx) as usize, (y as isize + dy) as usize)
    })
}

/// The pixels of a skeleton that do not have just two neighbours; without lone ones.
fn special_pixels(skeleton: &Bitmap) -> Bitmap {
    let (height, stride) = (skeleton.height(), skeleton.stride());
    let mut result = Bitmap::new(skeleton.width(), height);
    let blank = vec![0; stride + 1];
    for y in 0..height {
        let above = if y > 0 { skeleton.padded(y - 1) } else { &blank };
        let below = if y + 1 < height { skeleton.padded(y + 1) } else { &blank };
        let at = skeleton.padded(y);
        let to = result.row_mut(y);
        for chunk in 0..stride / CHUNK {
            for k in chunk * CHUNK..(chunk + 1) * CHUNK {
                if at[k + 1] == 0 {
                    continue;
                }
                let (mut one, mut two, mut three) = (0u64, 0u64, 0u64);
                let west = |row: &[u64]| row[k + 1] << 1 | row[k] >> 63;
                let east = |row: &[u64]| row[k + 1] >> 1 | row[k + 2] << 63;
                for bit in [west(above), above[k + 1], east(above), west(at), east(at), west(below), below[k + 1], east(below)] {
                    three |= two & bit;
                    two |= one & bit;
                    one |= bit;
                }
                to[k] = at[k + 1] & one & (!two | three);
            }
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(rows: &[&str]) -> Bitmap {
        Bitmap::from_fn(rows[0].len(), rows.len(), |x, y| rows[y].as_bytes()[x] == b'#')
    }

    #[test]
    fn a_t_has_three_ends_and_a_crossroads() {
        let t = traced(&drawn(&["........", ".#####..", "...#....", "...#....", "...#....", "........"]));
        assert_eq!(t.nodes.len(), 4);
        assert_eq!(t.lines.len(), 3);
        assert!(t.lines.iter().all(|line| line.ends[0] != line.ends[1]));
    }

    #[test]
    fn a_ring_is_a_line_from_a_node_to_itself() {
        let ring = traced(&drawn(&["......", "..##..", ".#..#.", ".#..#.", "..##..", "......"]));
        assert_eq!(ring.nodes.len(), 1);
        assert_eq!(ring.lines.len(), 1);
        assert_eq!(ring.lines[0].path.len(), 1 + 7 + 1);
    }

    #[test]
    fn no_pixel_of_a_line_is_lost() {
        let eight = drawn(&[".........", "..##.##..", ".#..#..#.", ".#..#..#.", "..##.##..", "....#....", "....#...."]);
        let t = traced(&eight);
        let slim = slimmed(&eight);
        let of_lines: usize = t.lines.iter().map(|l| l.path.len() - 2).sum();
        assert_eq!(of_lines + special_pixels(&slim).count(), slim.count());
    }

    #[test]
    fn a_slanting_line_with_steps_is_one_line() {
        let steps = Bitmap::from_fn(60, 60, |x, y| (10..50).contains(&x) && (x == y || x == y + 1));
        let t = traced(&steps);
        assert_eq!((t.nodes.len(), t.lines.len()), (2, 1));
    }
}
