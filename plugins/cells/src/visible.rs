//! Visible sets: which cells a straight line from somewhere in a cell can reach through portals.

use std::collections::VecDeque;

use rayon::prelude::*;
use smallvec::SmallVec;
use veduta_city::{Cells, CityPlan, Finding, GridPos, Id, PortalSide, Severity};

use crate::directions::Directions;
use crate::far::{Square, Squares, squares};
use crate::guests::{Guest, Guests};
use crate::lines::{Frame, LineSets, Lines};
use crate::partition::PartitionSettings;
use crate::rooms::{Mouth, Room, mouths, rooms};

/// After how many merges at one portal all lines through it are let pass.
const MOST_MERGES: u8 = 24;
/// After how many growths of the directions at one portal all directions are let pass.
const MOST_GROWTHS: u8 = 4;

/// What is seen from the cells of a partition.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Seen {
    /// What [`crate::partition`] notes as [`Cells::visible`], but for what is seen through tunnels.
    pub sets: Vec<Vec<u32>>,
    /// What it notes as [`Cells::far`].
    pub far: Vec<Vec<u32>>,
}

/// What is seen from every cell of a partition, and what is to be said of it. Sound in plan: no cell is missing of which something can be
/// seen along a straight line that crosses no house, in the sets within the settings' sight and beyond it in the squares that are told as
/// far away. The same for any number of threads.
///
/// # Panics
/// If portals name cells that are not there, which [`crate::check`] tells.
#[must_use]
pub fn visible_sets(plan: &CityPlan, cells: &Cells, settings: &PartitionSettings) -> (Seen, Vec<Finding>) {
    let rooms = rooms(cells);
    let about = Surroundings::new(plan, cells, &rooms);
    let found = (0..cells.cells.len() as u32)
        .into_par_iter()
        .map_init(|| Search::new(&about, settings, false), |search, cell| search.seen_from(cell))
        .unzip();
    settled(&rooms, &about.squares.all, found)
}

/// What is seen from every cell, of what was found from each: the rooms that it looks into, and the rest.
pub(crate) fn settled(
    rooms: &[Room<'_>],
    squares: &[Square],
    (mut seen, mut rest): (Vec<Vec<u32>>, Vec<Rest>),
) -> (Seen, Vec<Finding>) {
    let mut findings = Vec::new();
    let cells_of = |far: Vec<u32>| far.into_iter().map(|square| squares[square as usize].cell).collect();
    let far = rest.iter_mut().map(|rest| cells_of(core::mem::take(&mut rest.far))).collect();
    let coarse = rest.iter().filter(|rest| rest.is_coarse).count();
    if coarse > 0 {
        let message = format!(
            "{coarse} of {} cells lie on ground so open that what is seen from them was told by direction alone; \
             their visible sets may hold more than can be seen",
            seen.len()
        );
        findings.push(Finding::new(Severity::Note, Id::NONE, None, message));
    }
    // Of the cells that are looked into those stay that see each other, which drops much of what merging has added on one side. In place,
    // because all sets together are much: whoever is dropped from a set does not see its owner, and so never asks it.
    for a in 0..seen.len() {
        let mut set = core::mem::take(&mut seen[a]);
        set.retain(|&b| b as usize == a || seen.get(b as usize).is_none_or(|seen| seen.binary_search(&(a as u32)).is_ok()));
        seen[a] = set;
    }
    for (set, rest) in seen.iter_mut().zip(rest) {
        let beside = rest.beside.into_iter().filter(|(room, _)| set.binary_search(room).is_ok()).map(|(_, owner)| owner);
        let owners: Vec<u32> = set.iter().map(|&room| rooms[room as usize].owner).chain(beside).collect();
        *set = owners;
        set.sort_unstable();
        set.dedup();
        set.shrink_to_fit();
    }
    (Seen { sets: seen, far }, findings)
}

/// What a search found besides the cells that are looked into.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Rest {
    /// Squares that are seen beyond the sight, ascending.
    pub(crate) far: Vec<u32>,
    /// Whether the coarse search was needed.
    pub(crate) is_coarse: bool,
    /// A room that is looked into, and another cell to which something in it belongs, ascending.
    pub(crate) beside: Vec<(u32, u32)>,
    /// Directions of the lines that leave the sight, by the first portals; only if they are kept.
    pub(crate) leaving: Vec<(Frame, Vec<Directions>)>,
}

/// What searches go through.
pub(crate) struct Surroundings {
    pub(crate) web: Web,
    pub(crate) guests: Guests,
    pub(crate) squares: Squares,
}

impl Surroundings {
    pub(crate) fn new(plan: &CityPlan, cells: &Cells, rooms: &[Room<'_>]) -> Self {
        let ways = || (Web::new(cells, rooms), Squares::new(squares(plan, cells)));
        let (guests, (web, squares)) = rayon::join(|| Guests::new(plan, cells, rooms), ways);
        Self { web, guests, squares }
    }
}

/// A way from room to room.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Crossing {
    pub(crate) left: GridPos,
    pub(crate) right: GridPos,
    pub(crate) into: u32,
}

/// All crossings, those out of one room side by side, since that is how they are looked at.
pub(crate) struct Web {
    crossings: Vec<Crossing>,
    /// The first crossing out of each room, and the end.
    first: Vec<u32>,
}

impl Web {
    fn new(cells: &Cells, rooms: &[Room<'_>]) -> Self {
        let mut ways: Vec<(u32, Crossing)> = Vec::with_capacity(2 * cells.portals.len());
        for portal in &cells.portals {
            // Who leaves the cell on the portal's left has its second end on the left hand.
            let (a, b) = portal.ends;
            if let PortalSide::Cell(right) = portal.beyond {
                ways.push((portal.cell, Crossing { left: b, right: a, into: right }));
                ways.push((right, Crossing { left: a, right: b, into: portal.cell }));
            }
        }
        for Mouth { ends: (a, b), cell, room } in mouths(cells, rooms) {
            ways.push((cell, Crossing { left: b, right: a, into: room }));
            ways.push((room, Crossing { left: a, right: b, into: cell }));
        }
        ways.sort_by_key(|(from, _)| *from);
        let first = |cell: u32| ways.partition_point(|(from, _)| *from < cell) as u32;
        Self { first: (0..=rooms.len() as u32).map(first).collect(), crossings: ways.into_iter().map(|(_, way)| way).collect() }
    }

    /// The crossings out of a room, side by side.
    pub(crate) fn ways_out(&self, room: u32) -> &[Crossing] {
        let out = self.out(room);
        &self.crossings[out.start as usize..out.end as usize]
    }

    /// The numbers of the crossings out of a room.
    fn out(&self, room: u32) -> core::ops::Range<u32> {
        self.first[room as usize]..self.first[room as usize + 1]
    }
}

/// The lines known to reach one crossing.
#[derive(Default)]
struct Reached {
    sets: SmallVec<[Lines; 2]>,
    merges: u8,
}

/// The directions known to reach one crossing.
#[derive(Clone, Copy)]
struct Coarse {
    growths: u8,
    /// Those of all lines that cross both the first crossing and this one; `None` if there are none.
    all: Option<Directions>,
    known: Option<Directions>,
}

/// Where a crossing lies in the frame of the first one.
#[derive(Clone, Copy)]
struct Ahead {
    left: (f64, f64),
    right: (f64, f64),
    is_in_sight: bool,
}

/// What is known of one crossing of those that are followed from one first crossing.
struct Known {
    crossing: u32,
    /// Where it lies.
    ahead: Ahead,
    reached: Reached,
    coarse: Option<Coarse>,
}

/// What is known of the crossings about a first one: a sparse set (Briggs and Torczon, *An efficient representation for sparse sets*,
/// 1993), because a city has many crossings and few in sight of each other.
struct About {
    known: Vec<Known>,
    /// Where each crossing may stand in `known`.
    slots: Vec<u32>,
}

impl About {
    fn new(crossings: usize) -> Self {
        Self { known: Vec::new(), slots: vec![0; crossings] }
    }

    /// Where what is known of a crossing stands in `known`, `ahead` telling where it lies when it is first asked for.
    fn of(&mut self, crossing: u32, ahead: impl FnOnce() -> Ahead) -> usize {
        let mut slot = self.slots[crossing as usize] as usize;
        if self.known.get(slot).is_none_or(|known| known.crossing != crossing) {
            slot = self.known.len();
            self.slots[crossing as usize] = slot as u32;
            self.known.push(Known { crossing, ahead: ahead(), reached: Reached::default(), coarse: None });
        }
        slot
    }
}

/// Lines were followed for more steps than the settings allow.
struct TooMany;

/// Looks from one cell after another.
pub(crate) struct Search<'a> {
    web: &'a Web,
    guests: &'a Guests,
    most_sets: usize,
    most_steps: usize,
    sight_m: f64,
    far_m: f64,
    about: About,
    sets: LineSets,
    is_seen: Vec<bool>,
    /// Directions of the lines through one first crossing that leave the sight.
    leaving: Vec<Directions>,
    /// The same of all first crossings of the cell, if they are kept.
    kept: Vec<(Frame, Vec<Directions>)>,
    keeps: bool,
    squares: &'a Squares,
    is_far: Vec<bool>,
    /// Groups of guests of which some are seen, by room, and whether each is.
    met: Vec<(u32, u32)>,
    is_met: Vec<bool>,
}

impl<'a> Search<'a> {
    /// `keeps` tells whether directions that leave the sight are kept.
    pub(crate) fn new(about: &'a Surroundings, settings: &PartitionSettings, keeps: bool) -> Self {
        let Surroundings { web, guests, squares } = about;
        Self {
            web,
            guests,
            most_sets: settings.line_sets.max(1),
            most_steps: settings.sight_steps,
            sight_m: settings.sight_m,
            far_m: settings.far_m,
            about: About::new(web.crossings.len()),
            sets: LineSets::default(),
            is_seen: vec![false; web.first.len()],
            leaving: Vec::new(),
            kept: Vec::new(),
            keeps,
            squares,
            is_far: vec![false; squares.all.len()],
            met: Vec::new(),
            is_met: vec![false; guests.count()],
        }
    }

    /// Rooms looked into from a cell, ascending, and the rest that was found.
    pub(crate) fn seen_from(&mut self, cell: u32) -> (Vec<u32>, Rest) {
        let (mut seen, mut far) = (vec![cell], Vec::new());
        self.see_guests(cell, |_, _| true);
        let mut is_coarse = false;
        self.is_seen[cell as usize] = true;
        for first in self.web.out(cell) {
            let start = &self.web.crossings[first as usize];
            let Some(frame) = Frame::new(start.left, start.right) else { continue };
            self.about.known.clear();
            self.sets.clear();
            // What one crossing leaves open, all others of the cell may as well.
            is_coarse = is_coarse || self.follow(cell, first, &frame, &mut seen).is_err();
            if is_coarse {
                self.follow_directions(cell, first, &frame, &mut seen);
            }
            self.look_far(&frame, &mut far);
        }
        if is_coarse {
            seen.iter().for_each(|&cell| self.see_guests(cell, |_, _| true));
        }
        far.iter().for_each(|&square| self.is_far[square as usize] = false);
        for &cell in &seen {
            self.is_seen[cell as usize] = false;
        }
        far.sort_unstable();
        far.shrink_to_fit();
        seen.sort_unstable();
        seen.shrink_to_fit();
        let mut beside: Vec<(u32, u32)> = Vec::new();
        for (room, group) in self.met.drain(..) {
            self.is_met[group as usize] = false;
            beside.push((room, self.guests.group(group)[0].owner));
        }
        beside.sort_unstable();
        beside.shrink_to_fit();
        (seen, Rest { far, is_coarse, beside, leaving: core::mem::take(&mut self.kept) })
    }

    /// Notes what in a room belongs to other cells, as far as it is reached.
    fn see_guests(&mut self, room: u32, mut is_reached: impl FnMut(&mut LineSets, &Guest) -> bool) {
        let guests = self.guests;
        for group in guests.of(room) {
            if !self.is_met[group as usize] && guests.group(group).iter().any(|guest| is_reached(&mut self.sets, guest)) {
                self.is_met[group as usize] = true;
                self.met.push((room, group));
            }
        }
    }

    /// Follows all lines that leave a cell by one crossing. A line that comes back into a cell need not be followed there: it
    /// reaches whatever comes after by the shorter way, without the loop.
    fn follow(&mut self, source: u32, first: u32, frame: &Frame, seen: &mut Vec<u32>) -> Result<(), TooMany> {
        let web = self.web;
        let mut queue = VecDeque::from([(first, source, self.sets.all(frame))]);
        let mut steps = 0;
        while let Some((crossing, from, lines)) = queue.pop_front() {
            let here = web.crossings[crossing as usize].into;
            self.see(here, seen);
            if steps > self.most_steps {
                return Err(TooMany);
            }
            self.see_guests(here, |sets, guest| sets.meet(lines, frame.local(guest.left), frame.local(guest.right)));
            for next in web.out(here) {
                let Some(slot) = self.onward(frame, next, from, source) else { continue };
                let Ahead { left, right, is_in_sight } = self.about.known[slot].ahead;
                steps += usize::from(is_in_sight);
                let Some(lines) = self.sets.through(lines, left, right) else { continue };
                if !is_in_sight {
                    self.leaving.push(Directions::within(self.sets.slopes(lines)));
                } else if let Some(lines) = self.add(frame, slot, lines) {
                    queue.push_back((next, here, lines));
                }
            }
        }
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
            let slot = self.known(frame, crossing);
            let coarse = self.about.known[slot].coarse;
            if crossing != first && coarse.and_then(|coarse| coarse.known).is_some_and(|now| now != slopes) {
                continue;
            }
            for next in web.out(here) {
                let Some(slot) = self.onward(frame, next, from, source) else { continue };
                let Ahead { left, right, is_in_sight } = self.about.known[slot].ahead;
                if !is_in_sight {
                    self.leaving.extend(Directions::between(frame, left, right).and_then(|across| across.both(slopes)));
                } else if let Some(slopes) = self.add_directions(frame, slot, slopes) {
                    queue.push_back((next, here, slopes));
                }
            }
        }
    }

    /// Notes the squares that lines which have left the sight may reach.
    fn look_far(&mut self, frame: &Frame, far: &mut Vec<u32>) {
        if self.leaving.is_empty() || self.far_m <= self.sight_m {
            self.leaving.clear();
            return;
        }
        self.leaving.sort_by(Directions::order);
        self.leaving.dedup_by(|next, last| {
            let joins = last.both(*next).is_some();
            if joins {
                *last = last.hull(*next);
            }
            joins
        });
        let range = (self.sight_m, self.far_m);
        far.extend(self.squares.reached(frame, &self.leaving, range, &self.is_far));
        far.iter().for_each(|&n| self.is_far[n as usize] = true);
        if self.keeps {
            self.kept.push((*frame, core::mem::take(&mut self.leaving)));
        }
        self.leaving.clear();
    }

    fn see(&mut self, cell: u32, seen: &mut Vec<u32>) {
        if !core::mem::replace(&mut self.is_seen[cell as usize], true) {
            seen.push(cell);
        }
    }

    /// Where what is known of a crossing stands, if it leads on.
    fn onward(&mut self, frame: &Frame, crossing: u32, from: u32, source: u32) -> Option<usize> {
        let into = self.web.crossings[crossing as usize].into;
        (into != from && into != source).then(|| self.known(frame, crossing))
    }

    /// Where what is known of a crossing stands.
    fn known(&mut self, frame: &Frame, crossing: u32) -> usize {
        let (web, sight_m) = (self.web, self.sight_m);
        self.about.of(crossing, || {
            let Crossing { left, right, .. } = web.crossings[crossing as usize];
            let (left, right) = (frame.local(left), frame.local(right));
            let middle = (0.5 * (left.0 + right.0), 0.5 * (left.1 + right.1 - frame.width_m()));
            let length_m = |(x, y): (f64, f64)| libm::sqrt(x * x + y * y);
            let off_m = length_m(middle) - 0.5 * (frame.width_m() + length_m((left.0 - right.0, left.1 - right.1)));
            Ahead { left, right, is_in_sight: off_m <= sight_m }
        })
    }

    /// Notes directions that reach a crossing; returns those to follow from there, if any are new.
    fn add_directions(&mut self, frame: &Frame, slot: usize, slopes: Directions) -> Option<Directions> {
        let known = &mut self.about.known[slot];
        let ahead = known.ahead;
        let coarse = known.coarse.get_or_insert_with(|| Coarse {
            growths: 0,
            all: Directions::between(frame, ahead.left, ahead.right),
            known: None,
        });
        let all = coarse.all?;
        let slopes = slopes.both(all)?;
        let slopes = match coarse.known {
            Some(known) if known.contains(slopes) => return None,
            Some(_) if coarse.growths >= MOST_GROWTHS => all,
            Some(known) => {
                coarse.growths += 1;
                known.hull(slopes)
            }
            None => slopes,
        };
        coarse.known = Some(slopes);
        Some(slopes)
    }

    /// Notes lines that reach a crossing; returns the set to follow from there, if it is new. A few sets are told apart, further
    /// ones are merged, and in the end all lines are let pass: work stays bounded and nothing is lost.
    fn add(&mut self, frame: &Frame, slot: usize, mut lines: Lines) -> Option<Lines> {
        let (sets, Known { ahead, reached, .. }) = (&mut self.sets, &mut self.about.known[slot]);
        if reached.sets.iter().any(|&set| sets.contains(set, lines)) {
            return None;
        }
        if reached.sets.len() >= self.most_sets {
            reached.merges = reached.merges.saturating_add(1);
            lines = if reached.merges > MOST_MERGES {
                let all = sets.all(frame);
                sets.through(all, ahead.left, ahead.right)?
            } else {
                merged(sets, &reached.sets, lines)
            };
        }
        reached.sets.retain(|set| !sets.contains(lines, *set));
        reached.sets.push(lines);
        Some(lines)
    }
}

/// The hull of some lines with the set that grows least by it.
fn merged(sets: &mut LineSets, known: &[Lines], lines: Lines) -> Lines {
    let hulls = known.iter().map(|&set| {
        let hull = sets.hull(set, lines);
        (sets.measure(hull) - sets.measure(set), hull)
    });
    hulls.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(lines, |(_, hull)| hull)
}
