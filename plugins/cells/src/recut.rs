//! A partition made again after its plan has changed here and there, with what is seen looked for only where that may have changed.

use std::collections::HashMap;

use rayon::prelude::*;
use veduta_city::{CellOverride, CityPlan, GridPolygon};

use crate::far::Square;
use crate::guests::Guest;
use crate::partition::{Partition, PartitionSettings, cut, see};
use crate::rooms::{Room, rooms};
use crate::visible::{Crossing, Rest, Search, Surroundings, settled};

/// A partition that remembers what was found from each cell, to be made again of a plan that differs from the one before.
///
/// ```
/// use veduta_cells::{PartitionSettings, Recut, partition};
/// use veduta_city::{CityPlan, GridPolygon, GridPos, GroundPatch, SurfaceKind};
///
/// let square = |m: i32| {
///     let side = m * 1024;
///     GridPolygon::simple(vec![GridPos(0, 0), GridPos(side, 0), GridPos(side, side), GridPos(0, side)])
/// };
/// let plan = |m: i32| CityPlan {
///     extent: square(m),
///     ground: vec![GroundPatch { surface: SurfaceKind::Cobbles, outline: square(m), z: 0, course: None }],
///     ..CityPlan::default()
/// };
/// let settings = PartitionSettings::default();
/// let mut recut = Recut::new(&plan(100), &[], &settings);
/// let searched = recut.update(&plan(100), &[]);
/// assert_eq!(searched, 0, "nothing has changed");
/// recut.update(&plan(120), &[]);
/// assert_eq!(*recut.partition(), partition(&plan(120), &[], &settings));
/// ```
///
/// # Method
/// Free space is triangulated and cut as a whole: that takes half of the time, and its triangles depend on each other. What is seen
/// from a cell follows from the rooms that it looks into, their portals and what stands at their borders, and from nothing else; so a cell
/// of which all that is as it was, but for numbers, has seen what it would see. Squares farther away are asked for anew where they have
/// changed, in the directions that were kept.
///
/// # Limits
/// It keeps more in memory than the cells: the directions in which lines leave the sight of each portal.
#[derive(Debug)]
pub struct Recut {
    settings: PartitionSettings,
    made: Partition,
    known: Option<Known>,
}

/// What is known of cells besides themselves.
struct Known {
    about: Surroundings,
    /// Rooms that each cell looks into, before it was asked whether they look back.
    seen: Vec<Vec<u32>>,
    rest: Vec<Rest>,
}

impl core::fmt::Debug for Known {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Known").field("cells", &self.seen.len()).finish_non_exhaustive()
    }
}

impl Recut {
    /// Makes a partition, as [`partition`](crate::partition) does.
    #[must_use]
    pub fn new(plan: &CityPlan, edits: &[CellOverride], settings: &PartitionSettings) -> Self {
        let mut recut = Self { settings: settings.clone(), made: Partition::default(), known: None };
        recut.update(plan, edits);
        recut
    }

    /// The partition.
    #[must_use]
    pub const fn partition(&self) -> &Partition {
        &self.made
    }

    /// Makes the partition again of another plan: the same as [`partition`](crate::partition) would make of it. Tells from how many cells
    /// it was looked anew.
    pub fn update(&mut self, plan: &CityPlan, edits: &[CellOverride]) -> usize {
        let mut findings = Vec::new();
        let mut cells = cut(plan, edits, &self.settings, &mut findings);
        if cells.cells.is_empty() {
            (self.made, self.known) = (Partition { cells, findings }, None);
            return 0;
        }
        let here = rooms(&cells);
        let about = Surroundings::new(plan, &cells, &here);
        let mut found = vec![None; cells.cells.len()];
        if let Some(known) = &self.known {
            let was = rooms(&self.made.cells);
            carry(&Carrying::new((known, &was), (&about, &here)), known, &about, &self.settings, &mut found);
        }
        let open: Vec<u32> = (0..).zip(&found).filter(|(_, found)| found.is_none()).map(|(cell, _)| cell).collect();
        let look = |search: &mut Search<'_>, &cell: &u32| search.seen_from(cell);
        let looked: Vec<_> = open.par_iter().map_init(|| Search::new(&about, &self.settings, true), look).collect();
        let count = open.len();
        open.into_iter().zip(looked).for_each(|(cell, looked)| found[cell as usize] = Some(looked));
        let (seen, rest): (Vec<Vec<u32>>, Vec<Rest>) = found.into_iter().map(Option::unwrap_or_default).unzip();
        let (told, notes) = settled(&here, &about.squares.all, (seen.clone(), rest.clone()));
        drop(here);
        findings.extend(notes);
        see(plan, &mut cells, told, &self.settings);
        self.made = Partition { cells, findings };
        self.known = Some(Known { about, seen, rest });
        count
    }
}

/// What stayed what it was, from one partition to the next.
struct Carrying {
    /// What became of each room: the one of the same outline, and of the same cell.
    room: Vec<Option<u32>>,
    /// Whether its ways out and its guests stayed, too.
    stayed: Vec<bool>,
    /// What became of each square.
    square: Vec<Option<u32>>,
    /// Squares that are none of those before.
    new_squares: Vec<u32>,
}

impl Carrying {
    fn new((known, was): (&Known, &[Room<'_>]), (about, here): (&Surroundings, &[Room<'_>])) -> Self {
        let place: HashMap<&GridPolygon, u32> = here.iter().zip(0..).map(|(room, n)| (room.outline, n)).collect();
        let mut room: Vec<Option<u32>> = Vec::with_capacity(was.len());
        for (old, n) in was.iter().zip(0_u32..) {
            let new = place.get(old.outline).copied();
            // A cell belongs to itself, and so comes before its yards.
            let owner = |new: u32| here[new as usize].owner;
            let belongs =
                |&new: &u32| if n == old.owner { owner(new) == new } else { room[old.owner as usize] == Some(owner(new)) };
            let new = new.filter(belongs);
            room.push(new);
        }
        let mut is_kept = vec![false; here.len()];
        room.iter().flatten().for_each(|&new| is_kept[new as usize] = true);
        let leads_alike = |old: u32, new: u32| match room[old as usize] {
            Some(kept) => kept == new,
            None => !is_kept[new as usize],
        };
        let stayed = |(old, new): (u32, Option<u32>)| {
            let Some(new) = new else { return false };
            let (ways, now) = (known.about.web.ways_out(old), about.web.ways_out(new));
            let (guests, guests_now) = (known.about.guests.within(old), about.guests.within(new));
            let is_way = |(a, b): (&Crossing, &Crossing)| (a.left, a.right) == (b.left, b.right) && leads_alike(a.into, b.into);
            let is_guest =
                |(a, b): (&Guest, &Guest)| (a.left, a.right) == (b.left, b.right) && room[a.owner as usize] == Some(b.owner);
            ways.len() == now.len()
                && guests.len() == guests_now.len()
                && ways.iter().zip(now).all(is_way)
                && guests.iter().zip(guests_now).all(is_guest)
        };
        let stayed = (0..).zip(room.iter().copied()).map(stayed).collect();
        let of_cell: HashMap<u32, u32> = about.squares.all.iter().zip(0..).map(|(square, n)| (square.cell, n)).collect();
        let square = |old: &Square| {
            let new = *of_cell.get(&room[old.cell as usize]?)?;
            (about.squares.all[new as usize].bounds == old.bounds).then_some(new)
        };
        let square: Vec<Option<u32>> = known.about.squares.all.iter().map(square).collect();
        let mut is_old = vec![false; about.squares.all.len()];
        square.iter().flatten().for_each(|&new| is_old[new as usize] = true);
        let new_squares = (0..).zip(is_old).filter(|(_, is_old)| !is_old).map(|(n, _)| n).collect();
        Self { room, stayed, square, new_squares }
    }
}

/// Notes what is found from each cell whose surroundings stayed as they were.
fn carry(
    carrying: &Carrying,
    known: &Known,
    about: &Surroundings,
    settings: &PartitionSettings,
    found: &mut [Option<(Vec<u32>, Rest)>],
) {
    let range = (settings.sight_m, settings.far_m);
    let carried = |((n, seen), rest): ((u32, &Vec<u32>), &Rest)| {
        let cell = carrying.room[n as usize]?;
        if !seen.iter().all(|&room| carrying.stayed[room as usize]) {
            return None;
        }
        let mut seen: Vec<u32> = seen.iter().filter_map(|&room| carrying.room[room as usize]).collect();
        seen.sort_unstable();
        let beside =
            rest.beside.iter().filter_map(|&(room, owner)| Some((carrying.room[room as usize]?, carrying.room[owner as usize]?)));
        let mut beside: Vec<(u32, u32)> = beside.collect();
        beside.sort_unstable();
        let is_far = |&&n: &&u32| {
            let square = &about.squares.all[n as usize];
            rest.leaving.iter().any(|(frame, leaving)| square.is_reached(frame, leaving, range))
        };
        let mut far: Vec<u32> = rest.far.iter().filter_map(|&square| carrying.square[square as usize]).collect();
        far.extend(carrying.new_squares.iter().filter(is_far));
        far.sort_unstable();
        Some((cell, (seen, Rest { far, is_coarse: rest.is_coarse, beside, leaving: rest.leaving.clone() })))
    };
    let all: Vec<_> = (0..).zip(&known.seen).zip(&known.rest).collect();
    let carried: Vec<_> = all.into_par_iter().filter_map(carried).collect();
    carried.into_iter().for_each(|(cell, what)| found[cell as usize] = Some(what));
}
