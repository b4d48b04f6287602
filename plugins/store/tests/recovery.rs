//! A city over real sockets, through whatever happens on the way: what arrives is what was written, and soon after the end of any fault
//! all is there. Faults run beside each other, each with a line, a server, threads and a cache of its own.

mod line;
mod sample;

use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use line::{Fault, Line, serve_files};
use sample::{TempDir, city, files};
use veduta_city::Level::{One, Two};
use veduta_store::*;

const CELLS: u32 = 12;
/// So many files that are as hard to press as pictures, of so many bytes.
const PICTURES: u32 = 4;
const PICTURE: usize = 40_000;

/// A city with pictures in a folder.
fn write(dir: &TempDir) {
    let sample = city(CELLS as usize, 4);
    let mut writer = CityWriter::new(&dir.0, &sample.plan).expect("begun");
    writer.cells(&sample.plan, &sample.cells, &|cell| sample.parts(cell)).expect("written");
    for n in 0..PICTURES {
        let mut picture = vec![0; PICTURE];
        fill_with_noise(n, &mut picture);
        writer.file(&format!("pictures/{n}.jpg"), &picture).expect("written");
    }
    writer.finish(sample.cells.clone()).expect("written");
}

fn fill_with_noise(seed: u32, noise: &mut [u8]) {
    let mut state = 0x9E37_79B9_7F4A_7C15_u64 ^ u64::from(seed) << 32;
    for byte in noise {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        *byte = (state >> 32) as u8;
    }
}

/// What the whole of a city is, by what is asked for.
type Truth = BTreeMap<What, Payload>;

fn want_all(client: &mut Client) {
    client.want([One, Two].into_iter().flat_map(|level| (0..CELLS).map(move |cell| (cell, level))));
    client.want_overviews([0]);
    client.want_files(0..PICTURES);
}

fn truth(dir: &TempDir) -> Truth {
    let reader = DirReader::new(&dir.0).expect("a city");
    let mut client = Client::new(ClientSettings::default());
    want_all(&mut client);
    let mut truth = Truth::new();
    while let Some(request) = client.next_request(0.0) {
        let answer = request.fetch(&reader);
        truth.insert(request.what, answer.clone().expect("whole"));
        client.deliver(request.id, answer, 0.0);
    }
    truth
}

type Answers = Receiver<(RequestId, What, Result<Payload, StoreError>)>;

/// A walker's client with four threads that read for it.
struct Walk<'t> {
    client: Client,
    ask: std::sync::mpsc::Sender<Request>,
    answers: Answers,
    truth: &'t Truth,
    arrived: usize,
    failures: Vec<String>,
    began: Instant,
    cache: TempDir,
}

impl<'t> Walk<'t> {
    fn new(line: &Line, truth: &'t Truth) -> Self {
        let cache = TempDir::new("recovery-cache");
        let http = HttpReader::new(&line.place("")).expect("an address");
        let reader: Arc<dyn Reader> = Arc::new(CacheReader::new(Arc::new(http), &cache.0, 1 << 30));
        let ((ask, asked), (answer, answers)) = (channel::<Request>(), channel());
        let asked = Arc::new(Mutex::new(asked));
        for _ in 0..4 {
            let (reader, asked, answer) = (Arc::clone(&reader), Arc::clone(&asked), answer.clone());
            std::thread::spawn(move || {
                loop {
                    let Ok(request) = asked.lock().expect("no panic").recv() else { return };
                    let fetched = request.fetch(reader.as_ref());
                    if answer.send((request.id, request.what, fetched)).is_err() {
                        return;
                    }
                }
            });
        }
        let mut client = Client::new(ClientSettings::default());
        client.want_regions([0], []);
        Self { client, ask, answers, truth, arrived: 0, failures: Vec::new(), began: Instant::now(), cache }
    }

    fn is_whole(&self) -> bool {
        self.arrived == self.truth.len()
    }

    /// Asks and takes answers for a little while.
    fn step(&mut self) {
        let now_s = || self.began.elapsed().as_secs_f64();
        while let Some(request) = self.client.next_request(now_s()) {
            self.ask.send(request).expect("threads wait");
        }
        if let Ok((id, what, fetched)) = self.answers.recv_timeout(Duration::from_millis(10)) {
            if let Ok(payload) = &fetched {
                assert_eq!(Some(payload), self.truth.get(&what), "{what} is not what was written");
                self.arrived += 1;
            }
            for event in self.client.deliver(id, fetched, now_s()) {
                if let ClientEvent::Failed { error, again_in_s, what } = event {
                    assert!(again_in_s.is_some(), "{what} is given up: {error}");
                    self.failures.push(format!("{:.2} s: {what}: {error}", now_s()));
                }
            }
        }
    }

    /// Steps until something holds, for so many seconds at most; how long it took.
    fn until(&mut self, most_s: f64, holds: impl Fn(&Self) -> bool) -> f64 {
        let began = Instant::now();
        while !holds(self) {
            assert!(began.elapsed().as_secs_f64() < most_s, "{} of {}: {:#?}", self.arrived, self.truth.len(), self.failures);
            self.step();
        }
        began.elapsed().as_secs_f64()
    }

    /// What is kept answers to its name: nothing that was not verified is shown on the next visit either.
    fn check_kept(&self) {
        for (path, bytes) in files(&self.cache.0) {
            if path.extension().is_some_and(|extension| extension == "bin") {
                assert_eq!(path.file_stem().map(|name| name.to_string_lossy().into_owned()), Some(BlobRef::of(&bytes).name()));
            }
        }
    }
}

/// A walk that has just opened the city when a fault begins, which lasts so long; and how long after its end all is there.
fn survives(dir: &TempDir, truth: &Truth, fault: Fault, fault_s: f64) -> (f64, usize) {
    let line = Line::to(serve_files(files(&dir.0), &dir.0));
    let open = || {
        let mut walk = Walk::new(&line, truth);
        walk.until(10.0, |walk| walk.client.index().is_some_and(|index| index.region(0).is_some()));
        want_all(&mut walk.client);
        walk
    };
    let mut walk = open();
    line.set(fault);
    let began = Instant::now();
    while began.elapsed().as_secs_f64() < fault_s {
        walk.step();
        // What came in spite of it has nothing to recover: another walker is on the way when it ends.
        if walk.is_whole() && fault_s - began.elapsed().as_secs_f64() > 1.0 {
            line.set(Fault::None);
            walk = open();
            line.set(fault);
        }
    }
    line.set(Fault::None);
    let took_s = walk.until(5.0, Walk::is_whole);
    walk.check_kept();
    (took_s, walk.failures.len())
}

#[test]
fn soon_after_any_fault_all_is_there_and_nothing_else_ever_was() {
    let dir = TempDir::new("recovery");
    write(&dir);
    let truth = truth(&dir);
    assert_eq!(truth.len(), 4 + 2 * CELLS as usize + PICTURES as usize);
    // Faults end in the middle of what they did: one that lasts a little longer meets other tries.
    let faults = [
        (Fault::Lost(3), 3.0),
        (Fault::Late(Duration::from_secs(2)), 3.0),
        (Fault::Cut, 3.0),
        (Fault::Short, 3.0),
        (Fault::WrongBytes, 3.0),
        (Fault::Status(404), 4.0),
        (Fault::Status(500), 4.0),
        (Fault::Drip(20), 3.0),
        (Fault::Gone, 4.0),
        (Fault::Gone, 12.0),
        (Fault::Hole, 0.2),
        (Fault::Hole, 2.8),
        (Fault::Hole, 6.0),
        (Fault::Hole, 9.3),
    ];
    std::thread::scope(|scope| {
        let (dir, truth) = (&dir, &truth);
        let runs = faults.map(|(fault, fault_s)| (fault, fault_s, scope.spawn(move || survives(dir, truth, fault, fault_s))));
        for (fault, fault_s, run) in runs {
            let (took_s, failures) = run.join().unwrap_or_else(|_| panic!("{fault:?} for {fault_s} s"));
            println!("{fault:?} for {fault_s} s: {failures} failures, all there {took_s:.2} s after its end");
            let is_met = failures > 0 || matches!(fault, Fault::Late(_));
            assert!(is_met, "{fault:?} was never met");
        }
    });
}

/// 300 ms there and back and 20,000 bytes a second, which eight requests at a time share.
#[test]
fn a_slow_line_is_never_cut_off() {
    let dir = TempDir::new("slow");
    write(&dir);
    let truth = truth(&dir);
    let line = Line::to(serve_files(files(&dir.0), &dir.0));
    line.set(Fault::Slow(Duration::from_millis(300), 20_000));
    let mut walk = Walk::new(&line, &truth);
    want_all(&mut walk.client);
    let took_s = walk.until(60.0, Walk::is_whole);
    let (bytes, _) = line.counted();
    assert_eq!(walk.failures, Vec::<String>::new());
    let stored: u64 = files(&dir.0).values().map(|bytes| bytes.len() as u64).sum();
    assert_eq!(bytes, stored, "each once");
    println!("{bytes} bytes in {took_s:.1} s");
}

#[test]
fn a_second_visit_over_a_line_costs_no_byte_of_content() {
    let dir = TempDir::new("again");
    write(&dir);
    let truth = truth(&dir);
    let line = Line::to(serve_files(files(&dir.0), &dir.0));
    let mut first = Walk::new(&line, &truth);
    want_all(&mut first.client);
    first.until(20.0, Walk::is_whole);
    let stored: u64 = files(&dir.0).values().map(|bytes| bytes.len() as u64).sum();
    assert_eq!(line.counted(), (stored, [(200, truth.len() as u64)].into()));
    let http = HttpReader::new(&line.place("")).expect("an address");
    let reader = CacheReader::new(Arc::new(http), &first.cache.0, 1 << 30);
    let mut client = Client::new(ClientSettings::default());
    want_all(&mut client);
    let mut arrived = 0;
    while let Some(request) = client.next_request(0.0) {
        let answer = request.fetch(&reader);
        assert_eq!(answer.as_ref().ok(), truth.get(&request.what), "{}", request.what);
        client.deliver(request.id, answer, 0.0);
        arrived += 1;
    }
    assert_eq!(arrived, truth.len());
    assert_eq!(line.counted(), (0, [(304, 1)].into()), "only whether the index has changed is asked");
}
