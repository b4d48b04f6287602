//! In which order cells and levels come, and which of them there is room for.

use veduta_city::Level;

use crate::StreamingSettings;
use crate::deliver::LoadedCells;
use crate::memory::{KnownSizes, Sizes};
use crate::need::Need;
use crate::want::Wish;

/// What may be seen so soon comes before the finer levels of what is in sight; seconds.
const NEXT_S: f64 = 14.0;

/// What there is room for, and what is here.
pub(crate) struct Room<'a> {
    /// Most bytes of memory.
    pub cap: u64,
    pub sizes: &'a Sizes,
    /// Most bytes of finer levels that are to come over the line, but the first of them.
    pub finer_bytes: u64,
    pub loaded: Option<&'a LoadedCells>,
    /// Whether a level of a cell cannot be had.
    pub gave_up: &'a dyn Fn(u32, Level) -> bool,
}

/// What is wanted, in order.
#[derive(Default)]
pub(crate) struct Ranked {
    pub order: Vec<(u32, Level)>,
    /// What is not here of it.
    pub missing: Vec<(u32, Level)>,
    pub in_sight: Vec<u32>,
    /// What is wished of each cell, ascending.
    pub wishes: Vec<Wish>,
    /// Bytes of finer levels among it that are to come over the line.
    pub asked_bytes: u64,
    /// Whether finer levels are wanted that the line is too slow for.
    pub is_any_left_out: bool,
}

/// A cell, what is known of it, and how much of it is taken so far.
struct Candidate<'a> {
    need: &'a Need<'a>,
    known: KnownSizes,
    loaded: Option<Level>,
    taken: Option<Level>,
}

impl Ranked {
    /// Level 1 of all that is in sight, then of what is in sight from beyond a near portal, then the finer levels, then level 1 of what is
    /// farther ahead; nearest first, as far as there is room: what comes last is the first to be left out. The cells come ascending.
    pub fn of<'a>(needs: impl Iterator<Item = &'a Need<'a>>, settings: &StreamingSettings, room: &Room<'_>) -> Self {
        let candidate = |need: &'a Need<'a>| Candidate {
            need,
            known: room.sizes.known(need.cell),
            loaded: room.loaded.and_then(|loaded| loaded.level(need.cell)),
            taken: None,
        };
        let mut cells: Vec<Candidate<'_>> = needs.map(candidate).collect();
        let mut by_urgency: Vec<usize> = (0..cells.len()).collect();
        by_urgency.sort_unstable_by(|&a, &b| {
            let (a, b) = (cells[a].need, cells[b].need);
            let rank = a.rank.cmp(&b.rank).then(a.in_s.total_cmp(&b.in_s));
            rank.then(a.distance_m.total_cmp(&b.distance_m)).then(a.cell.cmp(&b.cell))
        });
        let (seen, ahead) = by_urgency.split_at(by_urgency.partition_point(|&n| cells[n].need.rank == 0));
        // Whoever is about to walk on must not stand before a shut door.
        let (next, later) = ahead.split_at(ahead.partition_point(|&n| cells[n].need.in_s <= NEXT_S));
        let (mut ranked, mut memory) = (Self::default(), 0);
        for &n in seen.iter().chain(next) {
            ranked.take(&mut cells[n], Level::One, &mut memory, room);
        }
        for level in [Level::Two, Level::Three, Level::Four].into_iter().filter(|&level| level as u8 <= settings.finest) {
            for &n in seen {
                if level <= cells[n].need.finest(settings) {
                    ranked.take(&mut cells[n], level, &mut memory, room);
                }
            }
        }
        for &n in later {
            ranked.take(&mut cells[n], Level::One, &mut memory, room);
        }
        ranked.in_sight = seen.iter().map(|&n| cells[n].need.cell).collect();
        ranked.wishes = cells.iter().map(|of| Wish { cell: of.need.cell, why: of.need.why, finest: of.taken }).collect();
        ranked
    }

    /// Takes a level of a cell, if there is room for it.
    fn take(&mut self, cell: &mut Candidate<'_>, level: Level, memory: &mut u64, room: &Room<'_>) {
        // A finer level without the one before it is of no use.
        let is_next = cell.taken.map_or(0, |last| last.index() + 1) == level.index();
        let Some(sent) = cell.need.entry.packet(level).map(|blob| u64::from(blob.bytes)).filter(|_| is_next) else { return };
        let takes = room.sizes.expected(&cell.known, level, sent);
        if *memory + takes > room.cap {
            return;
        }
        let (number, is_here) = (cell.need.cell, cell.loaded >= Some(level));
        // What is here, or will not come, costs the line nothing.
        let costs = if level == Level::One || is_here || (room.gave_up)(number, level) { 0 } else { sent };
        // However slow the line, the first comes in the end.
        if costs > 0 && self.asked_bytes > 0 && self.asked_bytes + costs > room.finer_bytes {
            self.is_any_left_out = true;
            return;
        }
        self.asked_bytes += costs;
        *memory += takes;
        cell.taken = Some(level);
        self.order.push((number, level));
        if !is_here {
            self.missing.push((number, level));
        }
    }
}
