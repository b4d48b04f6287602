//! Long lines along the sides of a picture, that wander as paper does.

use core::ops::Range;

use crate::raster::bitmap::Bitmap;
use crate::raster::picture::Picture;

/// Parts of a side by which a line is followed, …
pub(super) const BANDS: usize = 64;
/// … and pixels that it may turn aside from one to the next.
const TURN: usize = 2;
/// Pixels outside of a line that are free, from the first to the last.
const FREE: [usize; 2] = [4, 6];
/// A line is at most so thick, pixels; what is thicker is the map itself.
const THICK: usize = 24;

/// A side of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Right,
    Top,
    Bottom,
}

impl Side {
    pub const ALL: [Self; 4] = [Self::Left, Self::Right, Self::Top, Self::Bottom];

    /// How long it is, and how many pixels there are inward from it.
    pub fn size(self, width: usize, height: usize) -> [usize; 2] {
        if matches!(self, Self::Left | Self::Right) { [height, width] } else { [width, height] }
    }

    /// The column and row of a place along it and inward from it.
    fn pixel(self, along: usize, inward: usize, width: usize, height: usize) -> (usize, usize) {
        match self {
            Self::Left => (inward, along),
            Self::Right => (width - 1 - inward, along),
            Self::Top => (along, inward),
            Self::Bottom => (along, height - 1 - inward),
        }
    }

    /// Whether a place along it and inward from it is marked.
    fn is_marked(self, marks: &Bitmap, along: usize, inward: usize) -> bool {
        let (x, y) = self.pixel(along, inward, marks.width(), marks.height());
        marks.get(x as isize, y as isize)
    }
}

/// A line along a side of a picture.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Line {
    pub side: Side,
    /// How far inward its outer edge lies, and whether it is there, at each pixel along the side.
    pub inward: Vec<usize>,
    pub is_there: Vec<bool>,
}

impl Line {
    /// The share of it that is there.
    pub fn there(&self, range: Range<usize>) -> f64 {
        let to = range.end.min(self.is_there.len());
        let part = &self.is_there[range.start.min(to)..to];
        part.iter().filter(|&&is| is).count() as f64 / part.len().max(1) as f64
    }

    /// How thick it mostly is, with the pixel that it may lie aside; pixels.
    pub fn thickness(&self, marks: &Bitmap, range: Range<usize>) -> usize {
        let depth = self.side.size(marks.width(), marks.height())[1];
        let of = |along: usize| {
            let is_mark = |inward: &usize| self.side.is_marked(marks, along, *inward);
            let outer = (self.inward[along].saturating_sub(1)..depth).take(3).find(is_mark)?;
            let past = (outer..depth.min(outer + THICK)).find(|inward| !is_mark(inward))?;
            Some(past.saturating_sub(self.inward[along]))
        };
        let mut all: Vec<usize> = range.filter(|&along| self.is_there[along]).filter_map(of).collect();
        all.sort_unstable();
        // Four in five: nothing of the line is to be left.
        all.get(all.len() * 4 / 5).map_or(1, |thick| thick + 1)
    }

    /// Paints it over with what lies beside it.
    pub fn erase(&self, thick: usize, range: Range<usize>, picture: &mut Picture) {
        let (width, height) = (picture.width, picture.height);
        let depth = self.side.size(width, height)[1];
        for along in range {
            let [from, to] = [self.inward[along].saturating_sub(2), (self.inward[along] + thick + 2).min(depth)];
            for inward in from..to {
                // The near half from outside, the far half from inside; what crosses the line meets in its middle.
                let source = if 2 * inward < from + to { from.saturating_sub(2) } else { (to + 1).min(depth - 1) };
                let [(x, y), (sx, sy)] = [inward, source].map(|inward| self.side.pixel(along, inward, width, height));
                let colour = picture.at(sx, sy).unwrap_or_default();
                picture.pixels[3 * (y * width + x)..][..3].copy_from_slice(&colour);
            }
        }
    }
}

/// A strip of a picture along one of its sides.
pub(super) struct Strip {
    side: Side,
    /// How far inward it begins, and how many pixels outside of it are looked at.
    first: usize,
    lead: usize,
    /// Whether each pixel along and inward is marked, those outside first.
    marked: Vec<Vec<bool>>,
    /// For each band and place inward, how many pixels are the outer edge of something.
    edges: Vec<Vec<u32>>,
}

impl Strip {
    /// Of a part of the ways inward from a side.
    pub fn of(marks: &Bitmap, side: Side, inward: Range<usize>) -> Self {
        let [length, depth] = side.size(marks.width(), marks.height());
        let lead = FREE[1].min(inward.start);
        let seen = inward.start - lead..depth.min(inward.end + 1);
        let is_mark = |along: usize| seen.clone().map(move |inward| side.is_marked(marks, along, inward)).collect();
        let marked: Vec<Vec<bool>> = (0..length).map(is_mark).collect();
        let mut edges = vec![vec![0_u32; inward.len()]; BANDS];
        for (along, row) in marked.iter().enumerate() {
            for (at, count) in edges[along * BANDS / length].iter_mut().enumerate() {
                *count += u32::from(is_edge(row, at + lead));
            }
        }
        Self { side, first: inward.start, lead, marked, edges }
    }

    /// The line of which most is there.
    pub fn clearest(&self) -> Line {
        self.line(&clearest(&self.edges))
    }

    /// So many lines, the clearest first, none of them twice.
    pub fn lines(mut self, count: usize) -> Vec<Line> {
        let next = |_| {
            let path = clearest(&self.edges);
            for (band, &at) in self.edges.iter_mut().zip(&path) {
                let to = band.len().min(at + THICK / 4);
                band[at.saturating_sub(THICK / 4)..to].fill(0);
            }
            self.line(&path)
        };
        (0..count).map(next).collect()
    }

    /// The line along a path that is given for each band.
    fn line(&self, path: &[usize]) -> Line {
        let length = self.marked.len();
        let at: Vec<usize> = (0..length).map(|along| between(path, along as f64 / length as f64)).collect();
        let is_there = self.marked.iter().zip(&at).map(|(row, &at)| is_edge(row, at + self.lead)).collect();
        Line { side: self.side, inward: at.iter().map(|at| at + self.first).collect(), is_there }
    }
}

/// Whether the outer edge of something is here or a pixel aside.
fn is_edge(row: &[bool], at: usize) -> bool {
    let is_any = |range: Range<usize>| row[range].iter().any(|&is| is);
    is_any(at.saturating_sub(1)..row.len().min(at + 2)) && !is_any(at.saturating_sub(FREE[1])..at.saturating_sub(FREE[0] - 1))
}

/// How far inward a path that is given in the middle of each band lies at a share of the way.
fn between(path: &[usize], share: f64) -> usize {
    let at = (share * BANDS as f64 - 0.5).clamp(0.0, (BANDS - 1) as f64);
    let (before, t) = (at as usize, at.fract());
    let [a, b] = [path[before], path[(before + 1).min(BANDS - 1)]].map(|inward| inward as f64);
    (a + (b - a) * t + 0.5) as usize
}

/// Of all paths through the bands, the one with the most in it.
fn clearest(bands: &[Vec<u32>]) -> Vec<usize> {
    let reach = bands[0].len();
    let around = |at: usize| at.saturating_sub(TURN)..(at + TURN + 1).min(reach);
    // Most that a path up to here has.
    let mut most: Vec<Vec<u32>> = Vec::with_capacity(bands.len());
    for band in bands {
        let before = |at: usize| most.last().and_then(|row| row[around(at)].iter().copied().max()).unwrap_or(0);
        let row = band.iter().enumerate().map(|(at, count)| count + before(at)).collect();
        most.push(row);
    }
    let mut path = vec![0; bands.len()];
    let mut range = 0..reach;
    for (place, row) in path.iter_mut().zip(&most).rev() {
        let middle = (range.start + range.end) / 2;
        *place = range.max_by_key(|&at| (row[at], core::cmp::Reverse(at.abs_diff(middle)))).unwrap_or(0);
        range = around(*place);
    }
    path
}
