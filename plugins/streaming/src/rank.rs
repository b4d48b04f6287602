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

#[cfg(test)]
mod tests {
    use veduta_store::{BlobRef, CellEntry};

    use super::*;
    use crate::Why;

    /// A cell whose levels are sent as so many bytes each.
    fn entry(bytes: [Option<u32>; 4]) -> CellEntry {
        CellEntry { packets: bytes.map(|bytes| Some(BlobRef { bytes: bytes?, ..BlobRef::default() })), ..CellEntry::default() }
    }

    const SEEN: Why = Why::Seen { from: 0 };

    fn need(cell: u32, entry: &CellEntry, why: Why, in_s: f64, distance_m: f64) -> Need<'_> {
        Need { cell, entry, rank: u8::from(why != SEEN), in_s, distance_m, why }
    }

    fn ranked(needs: &[Need<'_>], cap: u64, finer_bytes: u64) -> Ranked {
        let (sizes, gave_up) = (Sizes::default(), |_, _| false);
        let room = Room { cap, sizes: &sizes, finer_bytes, loaded: None, gave_up: &gave_up };
        Ranked::of(needs.iter(), &StreamingSettings::default(), &room)
    }

    #[test]
    fn what_is_seen_comes_before_what_is_ahead_and_finer_levels_in_between() {
        let entry = entry([Some(10), Some(20), None, None]);
        let ahead = Why::Ahead { from: 1 };
        let needs = [
            need(1, &entry, ahead, 3.0, 5.0),
            need(2, &entry, SEEN, 0.0, 500.0),
            need(3, &entry, ahead, 30.0, 5.0),
            need(4, &entry, SEEN, 0.0, 20.0),
        ];
        let ranked = ranked(&needs, u64::MAX, u64::MAX);
        assert_eq!(ranked.order, [(4, Level::One), (2, Level::One), (1, Level::One), (4, Level::Two), (3, Level::One)]);
        assert_eq!((ranked.missing, ranked.in_sight), (ranked.order, vec![4, 2]), "nothing is here");
        let wishes: Vec<_> = ranked.wishes.iter().map(|wish| (wish.cell, wish.why, wish.finest)).collect();
        let (one, two) = (Some(Level::One), Some(Level::Two));
        assert_eq!(wishes, [(1, ahead, one), (2, SEEN, one), (3, ahead, one), (4, SEEN, two)], "in the order of their numbers");
    }

    #[test]
    fn no_level_comes_without_the_one_before_it() {
        let gap = entry([Some(10), None, Some(30), None]);
        let ranked = ranked(&[need(1, &gap, SEEN, 0.0, 1.0)], u64::MAX, u64::MAX);
        assert_eq!(ranked.order, [(1, Level::One)]);
    }

    #[test]
    fn the_farthest_is_left_out_where_memory_ends() {
        let entry = entry([Some(10), None, None, None]);
        let needs = [3.0, 2.0, 1.0].map(|m| need(m as u32, &entry, SEEN, 0.0, m));
        let one = Sizes::default().of(1, Level::One, 10);
        let ranked = ranked(&needs, 2 * one, u64::MAX);
        assert_eq!(ranked.order, [(1, Level::One), (2, Level::One)]);
        assert_eq!(ranked.in_sight, [1, 2, 3], "it is in sight all the same");
        assert_eq!(ranked.wishes[0].finest, None);
    }

    #[test]
    fn over_a_slow_line_the_first_finer_level_comes_alone() {
        let entry = entry([Some(10), Some(20), None, None]);
        let needs = [1, 2, 3].map(|cell| need(cell, &entry, SEEN, 0.0, f64::from(cell)));
        let finer = |ranked: &Ranked| ranked.order.iter().filter(|(_, level)| *level > Level::One).count();
        let slow = ranked(&needs, u64::MAX, 5);
        assert_eq!((finer(&slow), slow.asked_bytes, slow.is_any_left_out), (1, 20, true));
        let quick = ranked(&needs, u64::MAX, 60);
        assert_eq!((finer(&quick), quick.asked_bytes, quick.is_any_left_out), (3, 60, false));
    }
}
