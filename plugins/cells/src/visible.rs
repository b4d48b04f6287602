//! Visible sets: which cells a straight line from somewhere in a cell can reach through portals.

use std::collections::VecDeque;

use rayon::prelude::*;
use veduta_city::{Cells, Finding, GridPos, Id, PortalSide, Severity};

use crate::directions::Directions;
use crate::lines::{Frame, Lines};
use crate::partition::PartitionSettings;

/// After how many merges at one portal all lines through it are let pass.
const MOST_MERGES: u8 = 24;
/// After how many growths of the directions at one portal all directions are let pass.
const MOST_GROWTHS: u8 = 4;

/// Visible set of every cell. Sound: no cell that can be seen within the settings' sight is missing (within the plan's one floor).
/// A cell is kept only if each sees the other, which drops much of what merging has added on one side.
pub(crate) fn visible_sets(cells: &Cells, settings: &PartitionSettings, findings: &mut Vec<Finding>) -> Vec<Vec<u32>> {
    let web = Web::new(cells);
    let seen: Vec<(Vec<u32>, bool)> = (0..cells.cells.len() as u32)
        .into_par_iter()
        .map_init(|| Search::new(&web, settings), |search, cell| search.seen_from(cell))
        .collect();
    let coarse = seen.iter().filter(|(_, is_coarse)| *is_coarse).count();
    if coarse > 0 {
        let message = format!(
            "{coarse} of {} cells lie on ground so open that what is seen from them was told by direction alone; \
             their visible sets may hold more than can be seen",
            cells.cells.len()
        );
        findings.push(Finding::new(Severity::Note, Id::NONE, None, message));
    }
    let sees = |from: u32, to: u32| seen[from as usize].0.binary_search(&to).is_ok();
    (0..).zip(&seen).map(|(a, (set, _))| set.iter().copied().filter(|&b| sees(b, a)).collect()).collect()
}

/// A way through a portal.
#[derive(Clone, Copy)]
struct Crossing {
    left: GridPos,
    right: GridPos,
    into: u32,
}

/// All crossings, those out of one cell side by side, since that is how they are looked at.
struct Web {
    crossings: Vec<Crossing>,
    /// The first crossing out of each cell, and the end.
    first: Vec<u32>,
}

impl Web {
    fn new(cells: &Cells) -> Self {
        let mut ways: Vec<(u32, Crossing)> = Vec::with_capacity(2 * cells.portals.len());
        for portal in &cells.portals {
            // Who leaves the cell on the portal's left has its second end on the left hand.
            let (a, b) = portal.ends;
            if let PortalSide::Cell(right) = portal.beyond {
                ways.push((portal.cell, Crossing { left: b, right: a, into: right }));
                ways.push((right, Crossing { left: a, right: b, into: portal.cell }));
            }
        }
        ways.sort_by_key(|(from, _)| *from);
        let first = |cell: u32| ways.partition_point(|(from, _)| *from < cell) as u32;
        Self {
            first: (0..=cells.cells.len() as u32).map(first).collect(),
            crossings: ways.into_iter().map(|(_, way)| way).collect(),
        }
    }

    /// The crossings out of a cell.
    fn out(&self, cell: u32) -> core::ops::Range<u32> {
        self.first[cell as usize]..self.first[cell as usize + 1]
    }
}

/// The lines known to reach one crossing.
#[derive(Default)]
struct Reached {
    sets: Vec<Lines>,
    merges: u8,
}

/// The directions known to reach one crossing, in one round.
#[derive(Clone, Copy, Default)]
struct Coarse {
    round: u32,
    growths: u8,
    /// Those of all lines that cross both the first crossing and this one; `None` if there are none, or it is out of sight.
    all: Option<Directions>,
    known: Option<Directions>,
}

/// Where a crossing lies in the frame of the first one.
#[derive(Clone, Copy)]
struct Ahead {
    left: (f64, f64),
    right: (f64, f64),
}

/// Lines were followed for more steps than the settings allow.
struct TooMany;

struct Search<'a> {
    web: &'a Web,
    most_sets: usize,
    most_steps: usize,
    sight_m: f64,
    reached: Vec<Reached>,
    touched: Vec<u32>,
    is_seen: Vec<bool>,
    /// For each crossing the round for which it was placed, and where it lies if it is in sight and ahead.
    placed: Vec<(u32, Option<Ahead>)>,
    coarse: Vec<Coarse>,
    /// Counts the first crossings.
    round: u32,
}

impl<'a> Search<'a> {
    fn new(web: &'a Web, settings: &PartitionSettings) -> Self {
        Self {
            web,
            most_sets: settings.line_sets.max(1),
            most_steps: settings.sight_steps,
            sight_m: settings.sight_m,
            reached: web.crossings.iter().map(|_| Reached::default()).collect(),
            touched: Vec::new(),
            is_seen: vec![false; web.first.len()],
            coarse: vec![Coarse::default(); web.crossings.len()],
            placed: vec![(0, None); web.crossings.len()],
            round: 0,
        }
    }

    /// Cells seen from a cell, ascending, and whether the coarse search was needed.
    fn seen_from(&mut self, cell: u32) -> (Vec<u32>, bool) {
        let mut seen = vec![cell];
        let mut is_coarse = false;
        self.is_seen[cell as usize] = true;
        for first in self.web.out(cell) {
            let start = &self.web.crossings[first as usize];
            let Some(frame) = Frame::new(start.left, start.right) else { continue };
            self.round += 1;
            // What one crossing leaves open, all others of the cell may as well.
            is_coarse = is_coarse || self.follow(cell, first, &frame, &mut seen).is_err();
            if is_coarse {
                self.follow_directions(cell, first, &frame, &mut seen);
            }
        }
        for &cell in &seen {
            self.is_seen[cell as usize] = false;
        }
        seen.sort_unstable();
        (seen, is_coarse)
    }

    /// Follows all lines that leave a cell by one crossing. A line that comes back into a cell need not be followed there: it
    /// reaches whatever comes after by the shorter way, without the loop.
    fn follow(&mut self, source: u32, first: u32, frame: &Frame, seen: &mut Vec<u32>) -> Result<(), TooMany> {
        let web = self.web;
        let mut queue = VecDeque::from([(first, source, Lines::all(frame))]);
        let mut steps = 0;
        while let Some((crossing, from, lines)) = queue.pop_front() {
            let here = web.crossings[crossing as usize].into;
            self.see(here, seen);
            if steps > self.most_steps {
                self.forget();
                return Err(TooMany);
            }
            for next in web.out(here) {
                let Some(Ahead { left, right, .. }) = self.onward(frame, next, from, source) else { continue };
                steps += 1;
                if let Some(lines) = lines.through(left, right)
                    && let Some(lines) = self.add(next, lines, || Lines::all(frame).through(left, right))
                {
                    queue.push_back((next, here, lines));
                }
            }
        }
        self.forget();
        Ok(())
    }

    /// As [`Self::follow`], but keeps one interval of directions a crossing, which grows a few times at most.
    fn follow_directions(&mut self, source: u32, first: u32, frame: &Frame, seen: &mut Vec<u32>) {
        let web = self.web;
        let mut queue = VecDeque::from([(first, source, Directions::ALL)]);
        while let Some((crossing, from, slopes)) = queue.pop_front() {
            let here = web.crossings[crossing as usize].into;
            self.see(here, seen);
            // What has grown since is followed from its own place in the queue.
            let state = self.coarse[crossing as usize];
            if crossing != first && state.round == self.round && state.known.is_some_and(|now| now != slopes) {
                continue;
            }
            for next in web.out(here) {
                let into = web.crossings[next as usize].into;
                if into == from || into == source {
                    continue;
                }
                if let Some(slopes) = self.add_directions(next, slopes, frame) {
                    queue.push_back((next, here, slopes));
                }
            }
        }
    }

    fn see(&mut self, cell: u32, seen: &mut Vec<u32>) {
        if !core::mem::replace(&mut self.is_seen[cell as usize], true) {
            seen.push(cell);
        }
    }

    /// Where a crossing lies in the frame of the first, if it leads on and lies within sight.
    fn onward(&mut self, frame: &Frame, crossing: u32, from: u32, source: u32) -> Option<Ahead> {
        let Crossing { left, right, into } = self.web.crossings[crossing as usize];
        if into == from || into == source {
            return None;
        }
        let (round, placed) = self.placed[crossing as usize];
        if round == self.round {
            return placed;
        }
        let placed = self.place(frame, left, right);
        self.placed[crossing as usize] = (self.round, placed);
        placed
    }

    fn place(&self, frame: &Frame, left: GridPos, right: GridPos) -> Option<Ahead> {
        let (left, right) = (frame.local(left), frame.local(right));
        let middle = (0.5 * (left.0 + right.0), 0.5 * (left.1 + right.1 - frame.width_m()));
        let reach_m = self.sight_m + 0.5 * (frame.width_m() + libm::hypot(left.0 - right.0, left.1 - right.1));
        let is_in_sight = middle.0 * middle.0 + middle.1 * middle.1 <= reach_m * reach_m;
        is_in_sight.then_some(Ahead { left, right })
    }

    fn forget(&mut self) {
        for crossing in self.touched.drain(..) {
            self.reached[crossing as usize] = Reached::default();
        }
    }

    /// Notes directions that reach a crossing; returns those to follow from there, if any are new.
    fn add_directions(&mut self, crossing: u32, slopes: Directions, frame: &Frame) -> Option<Directions> {
        if self.coarse[crossing as usize].round != self.round {
            let Crossing { left, right, .. } = self.web.crossings[crossing as usize];
            let all = self.place(frame, left, right).and_then(|ahead| Directions::between(frame, ahead.left, ahead.right));
            self.coarse[crossing as usize] = Coarse { round: self.round, growths: 0, all, known: None };
        }
        let state = &mut self.coarse[crossing as usize];
        let all = state.all?;
        let slopes = slopes.both(all)?;
        let slopes = match state.known {
            Some(known) if known.contains(slopes) => return None,
            Some(_) if state.growths >= MOST_GROWTHS => all,
            Some(known) => {
                state.growths += 1;
                known.hull(slopes)
            }
            None => slopes,
        };
        state.known = Some(slopes);
        Some(slopes)
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
