use veduta_city::Level;
use veduta_store::What;

use crate::journal::{Entry, Event};

/// What came over a walk, told from its [`Journal`](crate::Journal): by time, by kind, and by the cells it led through. What a
/// [cache](crate::StreamingCache) had counts like what came from afar.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Downloads {
    sums: Vec<(f64, BytesByKind)>,
    stays: Vec<Stay>,
}

/// Bytes by kind: all but packets (index, regions, houses, maps, files), then packets of each level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BytesByKind(
    /// The rest, then levels 1 to 4.
    pub [u64; 1 + Level::ALL.len()],
);

/// A walk's time in one cell. The first stay is that before any cell was entered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stay {
    /// Which cell; `None` outside of every cell.
    pub cell: Option<u32>,
    /// When it was entered, seconds.
    pub at_s: f64,
    /// What came before the next one was.
    pub bytes: BytesByKind,
}

impl BytesByKind {
    /// The kind of something: 0 for all but packets, else the packet's level.
    #[must_use]
    pub const fn kind(what: What) -> usize {
        match what {
            What::Packet { level, .. } => level as usize,
            What::Index | What::Leaf(_) | What::Region(_) | What::Overview(_) | What::Houses(_) | What::File(_) => 0,
        }
    }

    /// Bytes of all kinds.
    #[must_use]
    pub fn sum(&self) -> u64 {
        self.0.iter().sum()
    }
}

impl Downloads {
    /// Takes the next entry of a journal. A city that is opened begins anew.
    pub fn take(&mut self, entry: &Entry) {
        match entry.event {
            Event::Opened { .. } => {
                let before = Stay { cell: None, at_s: entry.at_s, bytes: BytesByKind::default() };
                *self = Self { sums: vec![(entry.at_s, BytesByKind::default())], stays: vec![before] };
            }
            Event::Entered { cell, .. } => self.stays.push(Stay { cell, at_s: entry.at_s, bytes: BytesByKind::default() }),
            Event::Arrived { what, bytes } => {
                let kind = BytesByKind::kind(what);
                let mut sum = self.sum();
                sum.0[kind] += bytes;
                // All of a frame is one step.
                match self.sums.last_mut() {
                    Some((at_s, last)) if *at_s == entry.at_s => *last = sum,
                    _ => self.sums.push((entry.at_s, sum)),
                }
                if let Some(stay) = self.stays.last_mut() {
                    stay.bytes.0[kind] += bytes;
                }
            }
            Event::Asked { .. } | Event::Failed { .. } | Event::Cancelled { .. } | Event::Released { .. } => {}
        }
    }

    /// Keeps no more than so many steps and stays: every other step of the earlier half is left out, and the earliest stays.
    pub fn thin(&mut self, most: usize) {
        if self.sums.len() > most {
            let half = self.sums.len() / 2;
            let thin: Vec<_> = self.sums[..half].iter().step_by(2).copied().collect();
            self.sums.splice(..half, thin);
        }
        let excess = self.stays.len().saturating_sub(most);
        self.stays.drain(..excess);
    }

    /// When something came, seconds, and what had come by then; oldest first.
    #[must_use]
    pub fn sums(&self) -> &[(f64, BytesByKind)] {
        &self.sums
    }

    /// What had come by then.
    #[must_use]
    pub fn by(&self, at_s: f64) -> BytesByKind {
        let known = self.sums.partition_point(|&(then_s, _)| then_s <= at_s);
        known.checked_sub(1).map_or_else(BytesByKind::default, |last| self.sums[last].1)
    }

    /// All that came.
    #[must_use]
    pub fn sum(&self) -> BytesByKind {
        self.sums.last().map_or_else(BytesByKind::default, |last| last.1)
    }

    /// The cells on the way, in the order they were entered; one that was entered twice is there twice.
    #[must_use]
    pub fn stays(&self) -> &[Stay] {
        &self.stays
    }
}

impl<'a> FromIterator<&'a Entry> for Downloads {
    fn from_iter<I: IntoIterator<Item = &'a Entry>>(entries: I) -> Self {
        let mut downloads = Self::default();
        entries.into_iter().for_each(|entry| downloads.take(entry));
        downloads
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(at_s: f64, event: Event) -> Entry {
        Entry { at_s, event }
    }

    fn packet(cell: u32, level: Level, bytes: u64) -> Event {
        Event::Arrived { what: What::Packet { cell, level }, bytes }
    }

    fn walk() -> Vec<Entry> {
        vec![
            at(1.0, Event::Opened { place: "a.city".to_owned() }),
            at(1.5, Event::Arrived { what: What::Index, bytes: 40 }),
            at(2.0, Event::Entered { viewer: 1, cell: Some(3) }),
            at(2.0, Event::Asked { what: What::Houses(0), bytes: 5, why: None }),
            at(2.5, Event::Arrived { what: What::Houses(0), bytes: 5 }),
            at(2.5, packet(3, Level::One, 100)),
            at(4.0, packet(3, Level::Two, 200)),
            at(5.0, Event::Entered { viewer: 1, cell: Some(4) }),
            at(6.0, packet(3, Level::Three, 300)),
            at(7.0, Event::Entered { viewer: 1, cell: None }),
        ]
    }

    #[test]
    fn what_came_is_told_by_time_and_kind() {
        let downloads: Downloads = walk().iter().collect();
        assert_eq!(downloads.sum(), BytesByKind([45, 100, 200, 300, 0]));
        assert_eq!(downloads.sum().sum(), 645);
        let by = |at_s| downloads.by(at_s).0;
        assert_eq!(by(0.9), [0; 5], "before it began");
        assert_eq!(by(1.5), [40, 0, 0, 0, 0]);
        assert_eq!(by(2.4), [40, 0, 0, 0, 0]);
        assert_eq!(by(2.5), [45, 100, 0, 0, 0]);
        assert_eq!(by(60.0), [45, 100, 200, 300, 0], "after it ended");
        assert_eq!(downloads.sums().len(), 5, "a step for each frame that brought something, and one for the beginning");
    }

    #[test]
    fn what_came_is_told_by_the_cells_on_the_way() {
        let downloads: Downloads = walk().iter().collect();
        let stays: Vec<_> = downloads.stays().iter().map(|stay| (stay.cell, stay.at_s, stay.bytes.0)).collect();
        let rest = |bytes| [bytes, 0, 0, 0, 0];
        assert_eq!(stays[0], (None, 1.0, rest(40)));
        assert_eq!(stays[1], (Some(3), 2.0, [5, 100, 200, 0, 0]));
        assert_eq!(stays[2], (Some(4), 5.0, [0, 0, 0, 300, 0]), "while there, whatever cell it is of");
        assert_eq!(stays[3], (None, 7.0, rest(0)));
        let sum: u64 = downloads.stays().iter().map(|stay| stay.bytes.sum()).sum();
        assert_eq!(sum, downloads.sum().sum(), "nothing is lost between cells");
    }

    #[test]
    fn another_city_begins_anew() {
        let again: Downloads = walk().iter().chain(&walk()).collect();
        assert_eq!(again, walk().iter().collect());
    }

    #[test]
    fn a_long_walk_is_thinned_out() {
        let mut downloads = Downloads::default();
        for n in 0..1_000_u32 {
            downloads.take(&at(f64::from(2 * n), Event::Entered { viewer: 1, cell: Some(n) }));
            downloads.take(&at(f64::from(2 * n + 1), packet(n, Level::One, 10)));
            downloads.thin(100);
            assert!(downloads.sums().len() <= 100 && downloads.stays().len() <= 100);
        }
        assert_eq!(downloads.sum().sum(), 10_000, "the sum stays");
        assert_eq!(downloads.stays().last().and_then(|stay| stay.cell), Some(999));
        assert!(downloads.sums().is_sorted_by(|a, b| a.0 < b.0 && a.1.sum() < b.1.sum()));
    }
}
