//! Whatever happens on the way to a city: no hole, nothing that was not verified, never more than the cap, and soon whole again.
//! Time is by hand and the line is simulated, so that a minute without a server takes no minute and repeats exactly.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use bevy::math::DVec2;
use bevy::prelude::*;
use veduta::ecs::{Awaited, CellContent, OpenCells, StandingCells};
use veduta::prelude::*;
use veduta::streaming::{
    CityReader, CurrentCell, Fetching, Journal, Link, StreamingStats, Wanted, read_journal, replay, write_journal,
};
use veduta_city::{CellShell, Level};
use veduta_store::{CityIndex, DirReader, Fresh, INDEX_NAME, Packet, ReadError, Reader, decode_packet, read_index};
use veduta_tests::{in_memory, inner_point, quiet_app, sample_city, update_until};

/// What a server does to what it is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Fault {
    None,
    /// Each is cut in half.
    Cut,
    /// One byte of each is another.
    WrongBytes,
    /// There is more than there should be.
    TooLong,
    /// It says that there is no such file.
    NotFound,
    /// It fails.
    Error500,
    /// It answers for another file.
    Swapped,
}

/// Reads the sample city as a server with faults would hand it out.
struct Faulty {
    inner: DirReader,
    fault: Arc<Mutex<Fault>>,
    count: AtomicU32,
}

impl Reader for Faulty {
    fn read(&self, path: &str, limit: u64) -> Result<Vec<u8>, ReadError> {
        let mut bytes = self.inner.read(path, limit)?;
        let (place, path_told) = (self.describe(), path.to_owned());
        let n = self.count.fetch_add(1, Ordering::SeqCst) as usize;
        match *self.fault.lock().expect("no panic") {
            Fault::None => {}
            Fault::Cut => bytes.truncate(bytes.len() / 2),
            Fault::WrongBytes => {
                let at = n * 131 % bytes.len();
                bytes[at] ^= 1 << (n % 8);
            }
            Fault::TooLong => return Err(ReadError::TooLarge { place, path: path_told, limit }),
            Fault::NotFound => return Err(ReadError::NotFound { place, path: path_told }),
            Fault::Error500 => return Err(ReadError::Status { place, path: path_told, status: 500 }),
            Fault::Swapped => return self.inner.read(INDEX_NAME, u64::MAX),
        }
        Ok(bytes)
    }

    fn read_if_changed(&self, path: &str, limit: u64, _tag: Option<&str>) -> Result<Fresh, ReadError> {
        self.read(path, limit).map(|bytes| Fresh::Changed { bytes, tag: None })
    }

    fn describe(&self) -> String {
        "a faulty server".to_owned()
    }
}

/// A visitor who only goes where it is open, and looks about for what is wrong.
struct Visit {
    app: App,
    viewer: Entity,
    fault: Arc<Mutex<Fault>>,
    index: CityIndex,
    /// What every cell is in truth.
    truth: BTreeMap<u32, CellShell>,
    /// In the dark: after a jump, until all in sight stands.
    is_dark: bool,
    now_s: f64,
    cap: u64,
}

const STEP_S: f64 = 0.05;
/// A good line.
const WELL: Link = Link { latency_s: 0.05, bytes_s: 200_000.0, loss: 0.0, is_down: false };

impl Visit {
    /// A visit that has arrived at the start.
    fn begin() -> Self {
        let inner = DirReader::new(sample_city()).expect("a city");
        let index = read_index(&inner).expect("whole");
        let packet = |cell: u32, blob: &veduta_store::BlobRef| {
            let stored = inner.read(&blob.path(), blob.bytes.into()).expect("there");
            match decode_packet(&stored, blob, Level::One, index.packet_context(cell)).expect("whole") {
                Packet::Shell(shell) => *shell,
                packet => panic!("level 1, not {packet:?}"),
            }
        };
        let truth = index.cells().map(|(cell, entry)| (cell, packet(cell, entry.packet(Level::One).expect("level 1")))).collect();
        let fault = Arc::new(Mutex::new(Fault::None));
        let reader = Faulty { inner, fault: Arc::clone(&fault), count: AtomicU32::new(0) };
        let mut app = quiet_app("faulty.city", Fetching::Inline, Duration::from_secs_f64(STEP_S));
        app.insert_resource(CityReader(Arc::new(reader)));
        app.insert_resource(WELL);
        // Small enough to be met on the way.
        let cap = 120 << 20;
        app.world_mut().resource_mut::<StreamingSettings>().memory_cap_bytes = cap;
        update_until(&mut app, 200, "the city is open", |world| world.contains_resource::<City>());
        let start = app.world().resource::<City>().start;
        let viewer = app.world_mut().spawn((Viewer, Eye::at(start), Transform::default())).id();
        let mut visit = Self { app, viewer, fault, index, truth, is_dark: true, now_s: 0.0, cap };
        visit.until(30.0, "the start is whole", |visit| !visit.is_dark);
        visit
    }

    fn set(&mut self, fault: Fault, link: Link) {
        *self.fault.lock().expect("no panic") = fault;
        self.app.insert_resource(link);
    }

    fn cell(&self) -> Option<u32> {
        self.app.world().get::<CurrentCell>(self.viewer).and_then(|current| current.0)
    }

    fn put(&mut self, plan_pos: DVec2) {
        self.app.world_mut().get_mut::<Eye>(self.viewer).expect("spawned").plan_pos = plan_pos;
    }

    /// A frame, after which nothing may be wrong.
    fn step(&mut self) {
        self.app.update();
        self.now_s += STEP_S;
        let world = self.app.world();
        let (wanted, standing) = (world.resource::<Wanted>(), world.resource::<StandingCells>());
        let missing: Vec<u32> = wanted.in_sight.iter().copied().filter(|&cell| !standing.levels(cell).has(Level::One)).collect();
        if self.is_dark {
            self.is_dark = world.resource::<Awaited>().cells > 0 || wanted.in_sight.is_empty();
        }
        assert!(self.is_dark || missing.is_empty(), "at {:.2} s, cells {missing:?} are holes", self.now_s);
        let loaded = in_memory(&self.app);
        assert!(loaded <= self.cap, "{loaded} bytes are loaded of {}", self.cap);
        for (cell, _, shell) in standing.iter() {
            assert_eq!(Some(&**shell), self.truth.get(&cell), "cell {cell} is not what was written");
        }
    }

    /// Steps until something holds, for so many seconds at most; how long it took.
    fn until(&mut self, most_s: f64, what: &str, mut holds: impl FnMut(&Self) -> bool) -> f64 {
        let began_s = self.now_s;
        while !holds(self) {
            assert!(self.now_s - began_s < most_s, "after {most_s} s still not: {what}");
            self.step();
        }
        self.now_s - began_s
    }

    /// Walks into the cell beyond a portal if it is open; whether it was.
    fn try_door(&mut self) -> bool {
        let Some(here) = self.cell().filter(|_| !self.is_dark) else { return false };
        let open = self.app.world().resource::<OpenCells>().clone();
        let n = (self.now_s * 1000.0) as usize;
        let beyond: Vec<u32> = self.index.portals(here).filter_map(|portal| portal.other(here)).collect();
        let doors: Vec<u32> = beyond.iter().copied().filter(|&next| open.lead(here, next)).collect();
        let Some(&next) = doors.get(n % doors.len().max(1)) else { return false };
        let inside = inner_point(&self.index.cell(next).expect("told").outline);
        self.put(inside);
        true
    }
}

/// Ten seconds of walking from cell to cell, then a fault for a while, walking on where it is open, then a jump in the middle of it;
/// then all is well again.
fn survives(fault: Fault, link: Link, fault_s: f64) {
    let mut visit = Visit::begin();
    let mut seen = BTreeSet::new();
    let walk = |visit: &mut Visit, for_s: f64, seen: &mut BTreeSet<u32>| {
        let until_s = visit.now_s + for_s;
        while visit.now_s < until_s {
            visit.try_door();
            (0..10).for_each(|_| visit.step());
            seen.extend(visit.cell());
        }
    };
    walk(&mut visit, 10.0, &mut seen);
    assert!(seen.len() > 5, "only {seen:?} were walked through");
    visit.set(fault, link);
    walk(&mut visit, fault_s / 2.0, &mut seen);
    // A jump to the far side of the city: dark until all of it stands, which may be only after the fault.
    let here = visit.app.world().get::<Eye>(visit.viewer).expect("spawned").plan_pos;
    let far = visit
        .index
        .cells()
        .map(|(_, cell)| inner_point(&cell.outline))
        .max_by(|a, b| a.distance(here).total_cmp(&b.distance(here)));
    visit.put(far.expect("cells"));
    visit.is_dark = true;
    walk(&mut visit, fault_s / 2.0, &mut seen);
    let fails = fault != Fault::None || link.loss > 0.0 || link.is_down;
    let failures = visit.app.world().resource::<StreamingStats>().failures;
    assert!(!fails || failures > 0, "the fault was never met");
    visit.set(Fault::None, WELL);
    let took_s = visit.until(5.0, "all is whole again", |visit| {
        let wanted = visit.app.world().resource::<Wanted>();
        let standing = visit.app.world().resource::<StandingCells>();
        !visit.is_dark
            && wanted.order.iter().filter(|(_, level)| *level == Level::One).all(|&(cell, _)| standing.levels(cell).has(Level::One))
    });
    let cell = visit.cell().expect("a cell");
    assert!(visit.app.world().resource::<OpenCells>().lead(u32::MAX, cell), "cell {cell}, jumped into, is open");
    println!("{fault:?}, {link:?}: whole again {took_s:.2} s after its end; {} cells walked", seen.len());
    walk(&mut visit, 5.0, &mut seen);

    // The journal tells what is loaded.
    let journal = visit.app.world().resource::<Journal>();
    assert_eq!(journal.entries().len() as u64, journal.noted(), "all of it is kept");
    let entries = read_journal(&write_journal(journal.entries())).expect("a journal");
    let told: BTreeMap<u32, Vec<Level>> = replay(&entries);
    let mut contents = visit.app.world_mut().query::<(&veduta::ecs::Cell, &CellContent)>();
    let loaded: BTreeMap<u32, Vec<Level>> = contents
        .iter(visit.app.world())
        .map(|(cell, content)| {
            let finer = [content.sheet.as_ref().map(|_| Level::Two), content.pictures.as_ref().map(|_| Level::Three)];
            (cell.0, [Level::One].into_iter().chain(finer.into_iter().flatten()).collect())
        })
        .collect();
    assert_eq!(told, loaded);
}

#[test]
fn a_third_of_all_answers_lost() {
    survives(Fault::None, Link { loss: 0.3, ..WELL }, 40.0);
}

#[test]
fn two_seconds_late() {
    survives(Fault::None, Link { latency_s: 2.0, ..WELL }, 40.0);
}

#[test]
fn a_slow_drip() {
    survives(Fault::None, Link { bytes_s: 500.0, ..WELL }, 40.0);
}

#[test]
fn a_server_that_is_gone_for_a_minute() {
    survives(Fault::None, Link { is_down: true, ..WELL }, 60.0);
}

/// Who waits before a shut portal, or in the dark after a jump, waits as long as it takes: beyond there would be nothing.
#[test]
fn a_server_that_is_gone_for_five_minutes() {
    survives(Fault::None, Link { is_down: true, ..WELL }, 300.0);
}

#[test]
fn cut_answers() {
    survives(Fault::Cut, WELL, 40.0);
}

#[test]
fn wrong_bytes() {
    survives(Fault::WrongBytes, WELL, 40.0);
}

#[test]
fn endless_answers() {
    survives(Fault::TooLong, WELL, 40.0);
}

#[test]
fn files_that_are_said_to_be_missing() {
    survives(Fault::NotFound, WELL, 40.0);
}

#[test]
fn a_server_that_fails() {
    survives(Fault::Error500, WELL, 40.0);
}

#[test]
fn answers_to_other_questions() {
    survives(Fault::Swapped, WELL, 40.0);
}
