//! How much memory loaded cells take: what is made of them, measured where it stands, expected where it does not yet.

use std::collections::BTreeMap;

use bevy::prelude::*;
use veduta_city::Level;
use veduta_ecs::{Cell, CellMemory, DistrictMemory};

use crate::deliver::LoadedCells;
use crate::{StreamingSettings, StreamingStats, Wanted};

/// How much memory levels of cells take, as far as that is known.
#[derive(Resource, Debug, Clone, PartialEq, Default)]
pub(crate) struct Sizes {
    known: BTreeMap<u32, KnownSizes>,
    /// Of each level, all that was measured: bytes of memory, and of packets as sent.
    measured: [(f64, f64); 4],
}

/// Bytes of memory that were made of a cell, by [`Level::index`], as far as they were measured.
pub(crate) type KnownSizes = [Option<u64>; 4];

/// Bytes of memory that a byte sent becomes, by level, where none was measured: as in the sample city.
const USUAL: [f64; 4] = [1_000.0, 5_000.0, 150.0, 0.0];
/// As much as so many bytes sent that weighs.
const WEIGHT: f64 = 1_000.0;
/// Sizes of so many cells are kept, those of cells that are gone too: who comes back is not to be surprised by them again.
const MOST_KNOWN: usize = 1 << 14;

impl Sizes {
    /// Bytes of memory of a level of a cell that is sent as so many, with its packet.
    pub(crate) fn of(&self, cell: u32, level: Level, sent: u64) -> u64 {
        self.expected(&self.known(cell), level, sent)
    }

    /// What is known of a cell.
    pub(crate) fn known(&self, cell: u32) -> KnownSizes {
        self.known.get(&cell).copied().unwrap_or_default()
    }

    /// Bytes of memory of a level, of whose cell so much is known, that is sent as so many, with its packet.
    pub(crate) fn expected(&self, known: &KnownSizes, level: Level, sent: u64) -> u64 {
        let (memory, bytes) = self.measured[level.index()];
        let share = (memory + USUAL[level.index()] * WEIGHT) / (bytes + WEIGHT);
        // What stands in a cell, such as a church, takes as much again at level 2, whatever its walls take.
        let least = if level == Level::Two { known[Level::One.index()].unwrap_or_default() } else { 0 };
        known[level.index()].unwrap_or(least.max((sent as f64 * share) as u64)) + sent
    }

    fn note(&mut self, cell: u32, level: Level, sent: u64, made: u64) {
        if self.known.len() >= MOST_KNOWN {
            self.known.clear();
        }
        if self.known.entry(cell).or_default()[level.index()].replace(made).is_none() {
            let (memory, bytes) = &mut self.measured[level.index()];
            (*memory, *bytes) = (*memory + made as f64, *bytes + sent as f64);
        }
    }
}

/// Takes down what was made of cells since the last frame. Where that is more than was to be expected of what is wanted, it is planned anew: by
/// what is known now the farthest is left out.
pub(crate) fn measure(
    made: Query<(&Cell, &CellMemory), Changed<CellMemory>>,
    (settings, afar): (Res<StreamingSettings>, Res<DistrictMemory>),
    loaded: Option<ResMut<LoadedCells>>,
    mut sizes: ResMut<Sizes>,
    mut stats: ResMut<StreamingStats>,
    mut wanted: ResMut<Wanted>,
) {
    let Some(mut loaded) = loaded else { return };
    for (&Cell(cell), memory) in &made {
        // Relief is made of what level 2 is made of, and goes with it.
        let [one, two, three, four] = memory.0;
        for (level, made) in [(Level::One, one), (Level::Two, two + four), (Level::Three, three)] {
            let Some(entry) = loaded.level_mut(cell, level).filter(|_| made > 0) else { continue };
            sizes.note(cell, level, entry.sent, made);
            stats.bytes_in_memory = stats.bytes_in_memory + made + entry.sent - entry.memory;
            entry.memory = made + entry.sent;
        }
    }
    if stats.bytes_in_memory > settings.cap_of_cells(*afar) {
        wanted.bypass_change_detection().plan_anew();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_never_made_is_expected_to_be_like_what_was() {
        let mut sizes = Sizes::default();
        assert_eq!(sizes.of(1, Level::One, 100), 100_100, "as usual, and its packet");
        sizes.note(1, Level::One, 1_000_000, 30_000_000);
        assert_eq!(sizes.of(1, Level::One, 1_000_000), 31_000_000);
        assert_eq!(sizes.of(2, Level::One, 1_000) / 100, 319, "thirty times as much, and its packet");
        assert_eq!(sizes.of(2, Level::Two, 100), 500_100);
        (0..40_000).for_each(|cell| sizes.note(cell, Level::Two, 1, 1));
        assert!(sizes.known.len() <= MOST_KNOWN);
    }
}
