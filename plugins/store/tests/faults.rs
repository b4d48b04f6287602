//! Every read made to fail in turn, every byte of a city flipped: what was written arrives, or an error names what did not.

mod escapes;
mod sample;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use escapes::{corpus, is_plain};
use sample::{TempDir, city, files, large};
use veduta_city::Level;
use veduta_store::*;

/// Reads elsewhere, but for one read, which fails.
struct OneFails {
    inner: Arc<dyn Reader>,
    count: AtomicUsize,
    failing: usize,
    how: fn(&str) -> ReadError,
}

impl Reader for OneFails {
    fn read(&self, path: &str, limit: u64) -> Result<Vec<u8>, ReadError> {
        if self.count.fetch_add(1, Ordering::SeqCst) == self.failing { Err((self.how)(path)) } else { self.inner.read(path, limit) }
    }

    fn describe(&self) -> String {
        "a line".to_owned()
    }
}

const CELLS: usize = 5;

/// Everything that a client reads of a city until so much has arrived, by what it asked for.
fn walk(mut client: Client, count: usize, reader: &dyn Reader) -> (Vec<(What, String)>, ClientStats, f64) {
    let (mut arrived, mut now_s) = (Vec::new(), 0.0);
    while arrived.len() < count && now_s < 30.0 {
        while let Some(request) = client.next_request(now_s) {
            let answer = request.fetch(reader);
            for event in client.deliver(request.id, answer, now_s) {
                match event {
                    ClientEvent::Failed { again_in_s, error, .. } => assert!(again_in_s.is_some(), "{error}"),
                    event => arrived.push((request.what, format!("{event:?}"))),
                }
            }
        }
        now_s += 0.05;
    }
    arrived.sort();
    (arrived, client.stats(), now_s)
}

/// Makes each of a walk's reads fail in turn, in each way: all arrives all the same, and soon.
fn survives(what: &str, client: impl Fn() -> Client, count: usize, inner: Arc<dyn Reader>) {
    let told: [fn(&str) -> ReadError; 4] = [
        |path| ReadError::Failed { place: "a line".to_owned(), path: path.to_owned(), message: "cut".to_owned() },
        |path| ReadError::NoAnswer { place: "a line".to_owned(), path: path.to_owned(), message: "refused".to_owned() },
        |path| ReadError::NotFound { place: "a line".to_owned(), path: path.to_owned() },
        |path| ReadError::Status { place: "a line".to_owned(), path: path.to_owned(), status: 500 },
    ];
    let reader = |failing, how| OneFails { inner: Arc::clone(&inner), count: AtomicUsize::new(0), failing, how };
    let (whole, stats, _) = walk(client(), count, &reader(usize::MAX, told[0]));
    assert_eq!((whole.len(), stats.failures), (count, 0), "{what}");
    for failing in 0..count {
        for how in told {
            let (arrived, stats, took_s) = walk(client(), count, &reader(failing, how));
            assert_eq!((&arrived, stats.failures), (&whole, 1), "{what}: read {failing}");
            assert!(took_s < 1.0, "{what}: read {failing} took {took_s} s to be made good");
        }
    }
}

#[test]
fn any_one_read_may_fail() {
    let temp = TempDir::new("fails");
    city(CELLS, 2).write_whole(&temp.0).expect("written");
    let client = || {
        let mut client = Client::new(ClientSettings::default());
        client.want((0..CELLS as u32).flat_map(|cell| [Level::One, Level::Two, Level::Three].map(|level| (cell, level))));
        client.want_overviews([0]);
        client.want_files([0]);
        client
    };
    // Index, region, houses, overview, file; levels.
    survives("a city", client, 5 + 3 * CELLS, Arc::new(DirReader::new(&temp.0).expect("a city")));
}

/// What leads to the last region of a large city, by path.
struct Large(BTreeMap<String, Vec<u8>>);

impl Large {
    fn new() -> Self {
        let (index, leaf, page) = large();
        let blobs = [page, leaf].map(|stored| (BlobRef::of(&stored).path(), stored));
        Self(blobs.into_iter().chain([(INDEX_NAME.to_owned(), encode_index(&index))]).collect())
    }
}

impl Reader for Large {
    fn read(&self, path: &str, _: u64) -> Result<Vec<u8>, ReadError> {
        let missing = || ReadError::NotFound { place: self.describe(), path: path.to_owned() };
        self.0.get(path).cloned().ok_or_else(missing)
    }

    fn describe(&self) -> String {
        "a large city".to_owned()
    }
}

#[test]
fn any_one_read_of_what_leads_to_a_region_may_fail() {
    let client = || {
        let mut client = Client::new(ClientSettings::default());
        client.want_regions([64], []);
        client
    };
    survives("a large city", client, 3, Arc::new(Large::new()));
}

#[test]
fn any_flipped_byte_of_a_city_is_an_error_that_names_the_file() {
    let temp = TempDir::new("flipped");
    city(4, 1).write_whole(&temp.0).expect("written");
    let read = || -> Result<(), StoreError> {
        let reader = DirReader::new(&temp.0)?;
        let index = read_index(&reader)?;
        let bytes = |blob: &BlobRef| reader.read(&blob.path(), blob.bytes.into());
        let told = |blob: &BlobRef, error: StoreError| error.in_file(reader.describe(), &blob.path());
        for (i, cell, level) in index.cells().flat_map(|(i, cell)| Level::ALL.map(|level| (i, cell, level))) {
            if let Some(blob) = cell.packet(level) {
                decode_packet(&bytes(blob)?, blob, level, index.packet_context(i)).map_err(|error| told(blob, error))?;
            }
        }
        for CityFile { blob, .. } in &index.files {
            decode_file(&bytes(blob)?, blob).map_err(|error| told(blob, error))?;
        }
        read_overview(&reader, &index)?;
        Ok(())
    };
    assert_eq!(read(), Ok(()));
    let mut flipped = 0;
    for (path, good) in files(&temp.0) {
        let name = path.strip_prefix(&temp.0).expect("below").to_string_lossy().into_owned();
        let mut bytes = good.clone();
        for i in 0..good.len() {
            bytes[i] ^= 1 << (i % 8);
            std::fs::write(&path, &bytes).expect("our own");
            let error = read().expect_err("a flipped byte").to_string();
            assert!(error.contains(&name), "byte {i} of {name}: {error}");
            bytes[i] = good[i];
            flipped += 1;
        }
        std::fs::write(&path, &good).expect("our own");
    }
    assert_eq!(read(), Ok(()));
    assert!(flipped > 1_000, "only {flipped} bytes");
}

#[test]
fn ten_thousand_paths_lead_out_of_no_reader() {
    let temp = TempDir::new("escape");
    city(1, 1).write(&temp.join("x.city")).expect("written");
    std::fs::write(temp.join("secret.txt"), "a secret").expect("our own");
    std::fs::write(temp.join("city.veduta"), "a secret").expect("our own");
    let dir = DirReader::new(temp.join("x.city")).expect("a city");
    let inside: Vec<Vec<u8>> = files(&temp.join("x.city")).into_values().collect();
    let cache = temp.join("cache");
    let cached = CacheReader::new(std::sync::Arc::new(dir.clone()), &cache, 1 << 20);
    // Nobody listens there: a path that got so far would be an error of the line.
    let http = HttpReader::new("http://127.0.0.1:9/x.city").expect("an address");
    let corpus = corpus();
    assert!(corpus.len() > 10_000, "{} paths", corpus.len());
    let (mut refused, before) = (0, files(&temp.0));
    for path in &corpus {
        for reader in [&dir as &dyn Reader, &cached] {
            match reader.read(path, 1 << 20) {
                Ok(bytes) => assert!(inside.contains(&bytes), "{path:?} leads to {bytes:?}"),
                Err(ReadError::Forbidden { .. }) => refused += 1,
                Err(ReadError::NotFound { .. } | ReadError::Failed { .. }) => {}
                Err(error) => panic!("{path:?}: {error}"),
            }
        }
        if !is_plain(path) {
            assert!(matches!(http.read(path, 1 << 20), Err(ReadError::Forbidden { .. })), "{path:?}");
        }
    }
    assert!(refused > corpus.len(), "{refused} of {} were refused", 2 * corpus.len());
    let after: Vec<_> = files(&temp.0).into_iter().filter(|(path, _)| !path.starts_with(&cache)).collect();
    assert_eq!(after, before.into_iter().collect::<Vec<_>>(), "nothing was written elsewhere");
}

/// Files of a city are named by whoever baked it: neither its index nor its writer takes a name that leads elsewhere.
#[test]
fn no_file_of_an_index_is_called_by_a_path_that_leads_elsewhere() {
    let temp = TempDir::new("names");
    let sample = city(1, 1);
    sample.write(&temp.join("x.city")).expect("written");
    let whole = read_index(&DirReader::new(temp.join("x.city")).expect("a city")).expect("an index");
    let mut writer = CityWriter::new(&temp.join("y.city"), &sample.plan).expect("begun");
    let mut taken = 0;
    for path in corpus() {
        let mut index = whole.clone();
        index.files = vec![CityFile { path: path.clone(), blob: BlobRef::of(b"a secret") }];
        match decode_index(&encode_index(&index)) {
            Ok(read) => {
                taken += 1;
                assert!(is_plain(&path) && read.files == index.files, "{path:?}");
            }
            Err(StoreError::Invalid { reason, .. }) => {
                assert!(!is_plain(&path) && reason.contains("no path within a city"), "{path:?}: {reason}");
                assert!(matches!(writer.file(&path, b"x"), Err(StoreError::Invalid { .. })), "{path:?}");
            }
            Err(error) => panic!("{path:?}: {error}"),
        }
    }
    assert!(taken > 0, "some of them are names within a folder");
    assert!(writer.file("notes/con", b"x").is_ok(), "a good name after so many bad ones");
}
