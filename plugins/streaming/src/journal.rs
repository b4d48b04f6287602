use core::fmt;
use std::collections::{BTreeMap, VecDeque};

use bevy::prelude::*;
use serde::{Deserialize, Serialize};
use veduta_city::Level;
use veduta_store::What;

use crate::Why;

/// What streaming did, in order: crossings, requests, arrivals, failures, what was let go and why. The last
/// [`Journal::keep`] entries are kept; [`Journal::write_to`] writes all of them to a file, a line of RON each.
#[derive(Resource, Debug)]
pub struct Journal {
    /// Most entries that are kept here.
    pub keep: usize,
    entries: VecDeque<Entry>,
    noted: u64,
    #[cfg(not(target_arch = "wasm32"))]
    file: Option<JournalFile>,
}

/// A thread that writes entries to a file; all that it was given is there when this is gone.
#[cfg(not(target_arch = "wasm32"))]
#[derive(Debug)]
struct JournalFile {
    entries: Option<std::sync::mpsc::Sender<Entry>>,
    writer: Option<std::thread::JoinHandle<()>>,
}

#[cfg(not(target_arch = "wasm32"))]
impl Drop for JournalFile {
    fn drop(&mut self) {
        self.entries = None;
        // A writer that panicked has said so.
        let _ = self.writer.take().map(std::thread::JoinHandle::join);
    }
}

impl Default for Journal {
    fn default() -> Self {
        Self {
            keep: 10_000,
            entries: VecDeque::new(),
            noted: 0,
            #[cfg(not(target_arch = "wasm32"))]
            file: None,
        }
    }
}

/// A line of a [`Journal`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// The app's time, seconds.
    pub at_s: f64,
    /// What happened.
    pub event: Event,
}

/// What happened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Event {
    /// A city was opened: all of another is gone.
    Opened {
        /// Where it lies.
        place: String,
    },
    /// A viewer is in another cell.
    Entered {
        /// Which viewer.
        viewer: u64,
        /// Which cell; `None` outside of every cell.
        cell: Option<u32>,
    },
    /// Something was asked for.
    Asked {
        /// What.
        what: What,
        /// Bytes that are to come; 0 if nobody knows.
        bytes: u64,
        /// Why a cell is wanted.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        why: Option<Why>,
    },
    /// It came.
    Arrived {
        /// What.
        what: What,
        /// Bytes that came.
        bytes: u64,
    },
    /// It did not come.
    Failed {
        /// What.
        what: What,
        /// In words.
        error: String,
        /// Seconds until it is tried again; `None` if never.
        again_in_s: Option<f64>,
    },
    /// It is no longer wanted, and had not been sent for yet.
    Cancelled {
        /// What.
        what: What,
    },
    /// A cell was let go of, or its finer levels were.
    Released {
        /// Which cell.
        cell: u32,
        /// The first level that is gone.
        from: Level,
        /// Why.
        why: Reason,
    },
}

/// Why a cell was let go of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Reason {
    /// Nobody has wanted it for a while.
    Idle,
    /// Memory ran over.
    OverTheCap,
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Idle => "unwanted",
            Self::OverTheCap => "over the cap",
        })
    }
}

/// A line that is none of a journal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JournalError {
    /// Which line, from 1.
    pub line: usize,
    /// What is wrong with it.
    pub message: String,
}

impl fmt::Display for JournalError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {} is no line of a journal: {}", self.line, self.message)
    }
}

impl core::error::Error for JournalError {}

impl Journal {
    /// An empty journal that keeps so many entries.
    #[must_use]
    pub fn keeping(keep: usize) -> Self {
        Self { keep, ..Self::default() }
    }

    /// The entries that are kept, oldest first.
    pub fn entries(&self) -> impl DoubleEndedIterator<Item = &Entry> + ExactSizeIterator {
        self.entries.iter()
    }

    /// How many entries there have been.
    #[must_use]
    pub const fn noted(&self) -> u64 {
        self.noted
    }

    /// Notes what happened.
    pub fn note(&mut self, at_s: f64, event: Event) {
        let entry = Entry { at_s, event };
        #[cfg(not(target_arch = "wasm32"))]
        if let Some(file) = &self.file
            && file.entries.as_ref().is_none_or(|entries| entries.send(entry.clone()).is_err())
        {
            warn!("the journal's file cannot be written any more");
            self.file = None;
        }
        self.noted += 1;
        self.entries.push_back(entry);
        let excess = self.entries.len().saturating_sub(self.keep);
        self.entries.drain(..excess);
    }

    /// From now on writes every entry to a file, which is made anew; on a thread of its own.
    ///
    /// # Errors
    /// If the file cannot be made.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn write_to(&mut self, path: &std::path::Path) -> std::io::Result<()> {
        use std::io::Write;
        let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
        let (send, entries) = std::sync::mpsc::channel::<Entry>();
        let writer = std::thread::spawn(move || {
            while let Ok(entry) = entries.recv() {
                // As many as have gathered, then all of them to the disk.
                let more: Vec<Entry> = entries.try_iter().collect();
                let is_written = [entry].iter().chain(&more).try_for_each(|entry| writeln!(file, "{}", line(entry)));
                if is_written.and_then(|()| file.flush()).is_err() {
                    return;
                }
            }
        });
        self.file = Some(JournalFile { entries: Some(send), writer: Some(writer) });
        Ok(())
    }
}

/// A line of a journal, without its end.
fn line(entry: &Entry) -> String {
    // Only maps with odd keys and numbers that are none fail; the app's time is one.
    ron::to_string(entry).unwrap_or_else(|error| unreachable!("{entry:?}: {error}"))
}

/// Entries as a journal's file has them.
#[must_use]
pub fn write_journal<'a>(entries: impl IntoIterator<Item = &'a Entry>) -> String {
    entries.into_iter().map(|entry| line(entry) + "\n").collect()
}

/// The entries of a journal's file.
///
/// # Errors
/// At the first line that is none.
pub fn read_journal(text: &str) -> Result<Vec<Entry>, JournalError> {
    let entry =
        |(i, line): (usize, &str)| ron::from_str(line).map_err(|error| JournalError { line: i + 1, message: error.to_string() });
    text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()).map(entry).collect()
}

/// The cells and levels that are loaded after all that a journal tells, from the opening of the city on.
#[must_use]
pub fn replay<'a>(entries: impl IntoIterator<Item = &'a Entry>) -> BTreeMap<u32, Vec<Level>> {
    let mut loaded: BTreeMap<u32, Vec<Level>> = BTreeMap::new();
    for entry in entries {
        match entry.event {
            Event::Opened { .. } => loaded.clear(),
            Event::Arrived { what: What::Packet { cell, level }, .. } => loaded.entry(cell).or_default().push(level),
            Event::Released { cell, from, .. } => {
                if let Some(levels) = loaded.get_mut(&cell) {
                    levels.retain(|level| *level < from);
                    if levels.is_empty() {
                        loaded.remove(&cell);
                    }
                }
            }
            _ => {}
        }
    }
    loaded
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> Vec<Entry> {
        let packet = |cell, level| What::Packet { cell, level };
        let events = [
            Event::Opened { place: "http://h/\"x\"\n.city".to_owned() },
            Event::Entered { viewer: 7, cell: Some(3) },
            Event::Entered { viewer: 7, cell: None },
            Event::Asked { what: What::Index, bytes: 0, why: None },
            Event::Asked { what: packet(3, Level::One), bytes: 900, why: Some(Why::Seen { from: 4 }) },
            Event::Arrived { what: packet(3, Level::One), bytes: 900 },
            Event::Arrived { what: packet(3, Level::Two), bytes: 90 },
            Event::Arrived { what: packet(5, Level::One), bytes: 9 },
            Event::Failed { what: What::Region(2), error: "it is gone".to_owned(), again_in_s: Some(0.5) },
            Event::Cancelled { what: packet(9, Level::One) },
            Event::Released { cell: 3, from: Level::Two, why: Reason::OverTheCap },
            Event::Released { cell: 5, from: Level::One, why: Reason::Idle },
            Event::Arrived { what: What::Overview(3), bytes: 5 },
        ];
        events.into_iter().enumerate().map(|(i, event)| Entry { at_s: i as f64 / 3.0, event }).collect()
    }

    #[test]
    fn a_journal_survives_its_file() {
        let text = write_journal(&all());
        assert_eq!(text.lines().count(), all().len(), "a line each: {text}");
        assert_eq!(read_journal(&text), Ok(all()));
        let error = read_journal(&text.replace("Overview", "Overwiev")).expect_err("a mistake");
        assert!(error.line == 13 && error.to_string().contains("Overwiev"), "{error}");
    }

    #[test]
    fn a_journal_is_replayed_to_what_is_loaded() {
        assert_eq!(replay(&all()), BTreeMap::from([(3, vec![Level::One])]));
        assert_eq!(replay(&all()[..8]), BTreeMap::from([(3, vec![Level::One, Level::Two]), (5, vec![Level::One])]));
        let twice: Vec<Entry> = all().into_iter().chain([all()[0].clone()]).collect();
        assert_eq!(replay(&twice), BTreeMap::new(), "another city is open");
    }

    #[test]
    fn no_more_is_kept_than_may_be() {
        let mut journal = Journal { keep: 5, ..Journal::default() };
        all().into_iter().for_each(|entry| journal.note(entry.at_s, entry.event));
        assert_eq!((journal.entries().cloned().collect::<Vec<_>>(), journal.noted()), (all()[8..].to_vec(), 13));
    }

    #[cfg(not(target_arch = "wasm32"))]
    #[test]
    fn a_file_takes_every_entry() {
        let path = std::env::temp_dir().join(format!("veduta-journal-{}.ron", std::process::id()));
        let mut journal = Journal { keep: 1, ..Journal::default() };
        journal.write_to(&path).expect("a file");
        all().into_iter().for_each(|entry| journal.note(entry.at_s, entry.event));
        drop(journal);
        assert_eq!(read_journal(&std::fs::read_to_string(&path).expect("written")), Ok(all()));
        std::fs::remove_file(&path).expect("our own");
        assert!(Journal::default().write_to(std::path::Path::new("/nowhere/at/all")).is_err());
    }
}
