//! Visible sets: which cells a straight line from somewhere in a cell can reach through portals.

use std::collections::VecDeque;

use rayon::prelude::*;
use veduta_city::{Cells, GridPos, PortalSide};

use crate::lines::{Frame, Lines};
use crate::partition::PartitionSettings;

/// After how many merges at one portal all lines through it are let pass.
const MOST_MERGES: u8 = 24;

/// Visible set of every cell. Sound: no cell that can be seen is missing (within the plan's one floor). A cell is kept only if each
/// sees the other, which drops much of what merging has added on one side.
pub(crate) fn visible_sets(cells: &Cells, settings: &PartitionSettings) -> Vec<Vec<u32>> {
    let web = Web::new(cells);
    let seen: Vec<Vec<u32>> = (0..cells.cells.len() as u32)
        .into_par_iter()
        .map_init(|| Search::new(&web, settings.line_sets), |search, cell| search.seen_from(cell))
        .collect();
    let sees = |from: u32, to: u32| seen[from as usize].binary_search(&to).is_ok();
    (0..).zip(&seen).map(|(a, set)| set.iter().copied().filter(|&b| sees(b, a)).collect()).collect()
}

/// A way through a portal.
struct Crossing {
    left: GridPos,
    right: GridPos,
    into: u32,
}

/// The crossings out of each cell.
struct Web {
    crossings: Vec<Crossing>,
    out: Vec<Vec<u32>>,
}

impl Web {
    fn new(cells: &Cells) -> Self {
        let mut web = Self { crossings: Vec::new(), out: vec![Vec::new(); cells.cells.len()] };
        for portal in &cells.portals {
            // Who leaves the cell on the portal's left has its second end on the left hand.
            let (a, b) = portal.ends;
            if let PortalSide::Cell(right) = portal.beyond {
                web.add(portal.cell, Crossing { left: b, right: a, into: right });
                web.add(right, Crossing { left: a, right: b, into: portal.cell });
            }
        }
        web
    }

    fn add(&mut self, from: u32, crossing: Crossing) {
        self.out[from as usize].push(self.crossings.len() as u32);
        self.crossings.push(crossing);
    }
}

/// The lines known to reach one crossing.
#[derive(Default)]
struct Reached {
    sets: Vec<Lines>,
    merges: u8,
}

struct Search<'a> {
    web: &'a Web,
    most_sets: usize,
    reached: Vec<Reached>,
    touched: Vec<u32>,
    is_seen: Vec<bool>,
}

impl<'a> Search<'a> {
    fn new(web: &'a Web, most_sets: usize) -> Self {
        let reached = web.crossings.iter().map(|_| Reached::default()).collect();
        Self { web, most_sets: most_sets.max(1), reached, touched: Vec::new(), is_seen: vec![false; web.out.len()] }
    }

    /// Cells seen from a cell, ascending.
    fn seen_from(&mut self, cell: u32) -> Vec<u32> {
        let mut seen = vec![cell];
        self.is_seen[cell as usize] = true;
        for &first in &self.web.out[cell as usize] {
            self.follow(cell, first, &mut seen);
        }
        for &cell in &seen {
            self.is_seen[cell as usize] = false;
        }
        seen.sort_unstable();
        seen
    }

    /// Follows all lines that leave a cell by one crossing. A line that comes back into a cell need not be followed there: it
    /// reaches whatever comes after by the shorter way, without the loop.
    fn follow(&mut self, source: u32, first: u32, seen: &mut Vec<u32>) {
        let web = self.web;
        let start = &web.crossings[first as usize];
        let Some(frame) = Frame::new(start.left, start.right) else { return };
        let mut queue = VecDeque::from([(first, source, Lines::all(&frame))]);
        while let Some((crossing, from, lines)) = queue.pop_front() {
            let here = web.crossings[crossing as usize].into;
            if !core::mem::replace(&mut self.is_seen[here as usize], true) {
                seen.push(here);
            }
            for &next in &web.out[here as usize] {
                let Crossing { left, right, into } = web.crossings[next as usize];
                if into == from || into == source {
                    continue;
                }
                let ends = (frame.local(left), frame.local(right));
                if let Some(lines) = lines.through(ends.0, ends.1)
                    && let Some(lines) = self.add(next, lines, || Lines::all(&frame).through(ends.0, ends.1))
                {
                    queue.push_back((next, here, lines));
                }
            }
        }
        for crossing in self.touched.drain(..) {
            self.reached[crossing as usize] = Reached::default();
        }
    }

    /// Notes lines that reach a crossing; returns the set to follow from there, if it is new. A few sets are told apart, further
    /// ones are merged, and in the end all lines are let pass: work stays bounded and nothing is lost.
    fn add(&mut self, crossing: u32, lines: Lines, all: impl Fn() -> Option<Lines>) -> Option<Lines> {
        let reached = &mut self.reached[crossing as usize];
        if reached.sets.iter().any(|set| set.contains(&lines)) {
            return None;
        }
        if reached.sets.is_empty() {
            self.touched.push(crossing);
        }
        let mut lines = lines;
        if reached.sets.len() >= self.most_sets {
            reached.merges = reached.merges.saturating_add(1);
            lines = if reached.merges > MOST_MERGES { all()? } else { merged(&reached.sets, &lines) };
        }
        reached.sets.retain(|set| !lines.contains(set));
        reached.sets.push(lines.clone());
        Some(lines)
    }
}

/// The hull of some lines with the set that grows least by it.
fn merged(sets: &[Lines], lines: &Lines) -> Lines {
    let hulls = sets.iter().map(|set| (set, set.hull(lines)));
    let least = hulls.map(|(set, hull)| (hull.measure() - set.measure(), hull)).min_by(|a, b| a.0.total_cmp(&b.0));
    least.map_or_else(|| lines.clone(), |(_, hull)| hull)
}
