//! What is kept of a city: a return costs nothing, what is damaged comes anew, and the cap holds.

mod sample;

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use sample::{TempDir, city, files};
use veduta_store::*;

/// A server in memory, whose files have marks, and which may be away.
#[derive(Default)]
struct Source {
    files: Mutex<BTreeMap<String, Vec<u8>>>,
    away: Mutex<Option<ReadError>>,
    bytes: AtomicU64,
    asked: AtomicU64,
}

impl Source {
    fn put(&self, path: &str, bytes: &[u8]) {
        self.files.lock().expect("no panic").insert(path.to_owned(), bytes.to_vec());
    }

    /// Puts a blob where its content says, and tells where.
    fn blob(&self, bytes: &[u8]) -> String {
        let path = BlobRef::of(bytes).path();
        self.put(&path, bytes);
        path
    }

    /// Bytes that travelled since last asked.
    fn travelled(&self) -> u64 {
        self.bytes.swap(0, Ordering::SeqCst)
    }
}

/// What is cached is not `Source` itself: tests keep a hand on it.
struct Line(Arc<Source>);

impl Reader for Line {
    fn read(&self, path: &str, limit: u64) -> Result<Vec<u8>, ReadError> {
        match self.read_if_changed(path, limit, None)? {
            Fresh::Changed { bytes, .. } => Ok(bytes),
            Fresh::Same => panic!("nothing was said to be known"),
        }
    }

    fn read_if_changed(&self, path: &str, _limit: u64, tag: Option<&str>) -> Result<Fresh, ReadError> {
        self.0.asked.fetch_add(1, Ordering::SeqCst);
        if let Some(error) = &*self.0.away.lock().expect("no panic") {
            return Err(error.clone());
        }
        let missing = || ReadError::NotFound { place: self.describe(), path: path.to_owned() };
        let bytes = self.0.files.lock().expect("no panic").get(path).cloned().ok_or_else(missing)?;
        let own = format!("\"{}\"", BlobRef::of(&bytes).name());
        if tag == Some(own.as_str()) {
            return Ok(Fresh::Same);
        }
        self.0.bytes.fetch_add(bytes.len() as u64, Ordering::SeqCst);
        Ok(Fresh::Changed { bytes, tag: Some(own) })
    }

    fn describe(&self) -> String {
        "memory://town".to_owned()
    }
}

fn gone() -> ReadError {
    ReadError::Failed { place: "memory://town".to_owned(), path: "x".to_owned(), message: "connection refused".to_owned() }
}

fn cached(source: &Arc<Source>, dir: &TempDir, cap: u64) -> CacheReader {
    CacheReader::new(Arc::new(Line(Arc::clone(source))), &dir.0, cap)
}

#[test]
fn a_second_visit_costs_nothing_but_the_question_whether_the_index_changed() {
    let (dir, baked) = (TempDir::new("cache"), TempDir::new("baked"));
    city(3, 4).write(&baked.0).expect("written");
    let source = Arc::new(Source::default());
    let all = files(&baked.0);
    for (path, bytes) in &all {
        source.put(&path.strip_prefix(&baked.0).expect("below").to_string_lossy(), bytes);
    }
    let walk = || {
        let reader = cached(&source, &dir, 1 << 20);
        let mut client = Client::new(ClientSettings::default());
        client.want((0..3).flat_map(|cell| [(cell, veduta_city::Level::One), (cell, veduta_city::Level::Two)]));
        client.want_overviews([0]);
        while let Some(request) = client.next_request(0.0) {
            let answer = request.fetch(&reader);
            assert!(answer.is_ok(), "{answer:?}");
            client.deliver(request.id, answer, 0.0);
        }
        assert!(client.has(2, veduta_city::Level::Two));
        (source.travelled(), reader.stats())
    };
    let (first, stats) = walk();
    assert_eq!(first, all.values().map(|bytes| bytes.len() as u64).sum::<u64>());
    assert_eq!((stats.hits, stats.misses, stats.unwritten), (0, 10, 0));
    let (second, stats) = walk();
    assert_eq!((second, stats.hits, stats.misses), (0, 10, 0));
    // One house is painted anew: its packet, the region that names it and the index travel again, and nothing else.
    let mut painted = city(3, 4);
    painted.shells[1].houses[0].volumes[0].colour = veduta_city::Rgb(9, 9, 9);
    painted.write(&baked.0).expect("written");
    let changed: Vec<_> = files(&baked.0).into_iter().filter(|(path, bytes)| all.get(path) != Some(bytes)).collect();
    for (path, bytes) in &changed {
        source.put(&path.strip_prefix(&baked.0).expect("below").to_string_lossy(), bytes);
    }
    let (third, stats) = walk();
    assert_eq!((changed.len(), third), (3, changed.iter().map(|(_, bytes)| bytes.len() as u64).sum::<u64>()));
    assert_eq!((stats.hits, stats.misses), (7, 3));
}

#[test]
fn what_is_damaged_on_the_disk_comes_anew() {
    let (dir, source) = (TempDir::new("cache"), Arc::new(Source::default()));
    let path = source.blob(b"a street");
    let reader = cached(&source, &dir, 1 << 20);
    assert_eq!(reader.read(&path, 8).as_deref(), Ok(&b"a street"[..]));
    let (file, whole) = files(&dir.0).into_iter().next().expect("it is kept");
    for wrong in [&b"a streeT"[..], b"a stree", b"", b"a street and more than that"] {
        source.travelled();
        std::fs::write(&file, wrong).expect("our own");
        assert_eq!(reader.read(&path, 8).as_deref(), Ok(&b"a street"[..]), "{wrong:?}");
        assert_eq!(source.travelled(), 8);
        assert_eq!(std::fs::read(&file).ok(), Some(whole.clone()), "it is kept anew");
    }
    assert_eq!(reader.stats().damaged, 4);
    std::fs::remove_file(&file).expect("our own");
    assert_eq!(reader.read(&path, 8).as_deref(), Ok(&b"a street"[..]));
}

#[test]
fn what_does_not_answer_to_its_name_is_not_kept() {
    let (dir, source) = (TempDir::new("cache"), Arc::new(Source::default()));
    let path = source.blob(b"a street");
    source.put(&path, b"a web page");
    let reader = cached(&source, &dir, 1 << 20);
    assert_eq!(reader.read(&path, 100).as_deref(), Ok(&b"a web page"[..]), "whoever asked for it finds out");
    assert!(files(&dir.0).is_empty());
    source.put(&path, b"a street");
    assert_eq!(reader.read(&path, 100).as_deref(), Ok(&b"a street"[..]));
    assert_eq!(files(&dir.0).len(), 1);
}

#[test]
fn the_cap_holds_and_what_was_not_used_for_longest_goes() {
    let (dir, source) = (TempDir::new("cache"), Arc::new(Source::default()));
    let paths: Vec<String> = (0..10_u8).map(|n| source.blob(&[n; 100])).collect();
    let reader = cached(&source, &dir, 450);
    let read = |reader: &CacheReader, n: usize| assert_eq!(reader.read(&paths[n], 100), Ok(vec![n as u8; 100]));
    (0..4).for_each(|n| read(&reader, n));
    read(&reader, 0);
    read(&reader, 4);
    let kept = |dir: &TempDir| files(&dir.0).values().map(|bytes| bytes[0]).collect::<std::collections::BTreeSet<u8>>();
    assert_eq!(kept(&dir), [0, 2, 3, 4].into(), "1 was not used for longest");
    assert_eq!((reader.stats().bytes, reader.stats().evicted), (400, 1));
    // The next run knows what the files' times tell.
    drop(reader);
    let reader = cached(&source, &dir, 450);
    source.travelled();
    read(&reader, 2);
    assert_eq!(source.travelled(), 0);
    read(&reader, 5);
    assert_eq!(kept(&dir).len(), 4);
    assert!(kept(&dir).contains(&2) && kept(&dir).contains(&5));
    // What is larger than everything that may be kept is only read.
    let large = source.blob(&[77; 451]);
    assert_eq!(reader.read(&large, 451).map(|bytes| bytes.len()), Ok(451));
    assert_eq!(kept(&dir).len(), 4);
    for n in 0..10 {
        read(&reader, n);
        assert!(files(&dir.0).values().map(Vec::len).sum::<usize>() <= 450);
    }
}

#[test]
fn the_last_index_stands_in_for_a_server_that_is_away_but_not_for_a_city_that_is() {
    let (dir, source) = (TempDir::new("cache"), Arc::new(Source::default()));
    let path = "notes.veduta";
    source.put(path, b"first");
    let reader = cached(&source, &dir, 1 << 20);
    let read = || reader.read(path, 100);
    assert_eq!(read().as_deref(), Ok(&b"first"[..]));
    *source.away.lock().expect("no panic") = Some(gone());
    assert_eq!(read().as_deref(), Ok(&b"first"[..]));
    *source.away.lock().expect("no panic") = Some(ReadError::Status { place: "x".to_owned(), path: "x".to_owned(), status: 503 });
    assert_eq!(read().as_deref(), Ok(&b"first"[..]));
    *source.away.lock().expect("no panic") = None;
    source.put(path, b"second");
    assert_eq!(read().as_deref(), Ok(&b"second"[..]));
    source.travelled();
    assert_eq!((read().as_deref(), source.travelled()), (Ok(&b"second"[..]), 0));
    source.files.lock().expect("no panic").clear();
    assert!(matches!(read(), Err(ReadError::NotFound { .. })), "the server says that there is no city any more");
    // What was never read is not made up.
    *source.away.lock().expect("no panic") = Some(gone());
    assert_eq!(reader.read("other.veduta", 100), Err(gone()));
}

#[test]
fn a_kept_index_that_is_damaged_comes_anew_and_a_gates_page_is_not_kept() {
    let (dir, baked) = (TempDir::new("cache"), TempDir::new("baked"));
    city(1, 1).write(&baked.0).expect("written");
    let index = std::fs::read(baked.join(INDEX_NAME)).expect("an index");
    let source = Arc::new(Source::default());
    source.put(INDEX_NAME, &index);
    let reader = cached(&source, &dir, 1 << 20);
    let read = || reader.read(INDEX_NAME, 1 << 20);
    assert_eq!(read().as_ref(), Ok(&index));
    let (file, whole) = files(&dir.0).into_iter().next().expect("it is kept");
    for n in [0, 1, whole.len() / 2, whole.len() - 1] {
        let mut wrong = whole.clone();
        wrong[n] ^= 4;
        for stored in [&whole[..n], &wrong] {
            std::fs::write(&file, stored).expect("our own");
            source.travelled();
            assert_eq!(read().as_ref(), Ok(&index), "byte {n}");
            assert_eq!(source.travelled(), index.len() as u64, "asked for whole");
        }
    }
    source.put(INDEX_NAME, b"<!DOCTYPE html> please log in");
    assert_ne!(read().as_ref(), Ok(&index));
    *source.away.lock().expect("no panic") = Some(gone());
    assert_eq!(read().as_ref(), Ok(&index), "the city stands in, not the page");
}

#[test]
fn what_another_program_has_kept_is_found() {
    let (dir, source) = (TempDir::new("cache"), Arc::new(Source::default()));
    let path = source.blob(b"a street");
    let (first, second) = (cached(&source, &dir, 1 << 20), cached(&source, &dir, 1 << 20));
    assert_eq!(second.stats().bytes, 0, "it has looked already");
    first.read(&path, 8).expect("there");
    source.travelled();
    assert_eq!(second.read(&path, 8).as_deref(), Ok(&b"a street"[..]));
    assert_eq!((source.travelled(), second.stats().hits, second.stats().bytes), (0, 1, 8));
    assert!(second.read(&path, 7).is_ok(), "whoever sends more than is allowed is the line's concern");
    assert_eq!(second.stats().damaged, 0);
}

#[test]
fn a_directory_that_cannot_be_written_hinders_nobody() {
    let (dir, source) = (TempDir::new("cache"), Arc::new(Source::default()));
    let path = source.blob(b"a street");
    source.put("notes.veduta", b"index");
    std::fs::write(dir.join("taken"), "a file").expect("our own");
    let reader = CacheReader::new(Arc::new(Line(Arc::clone(&source))), dir.join("taken"), 1 << 20);
    for _ in 0..2 {
        assert_eq!(reader.read(&path, 8).as_deref(), Ok(&b"a street"[..]));
        assert_eq!(reader.read("notes.veduta", 8).as_deref(), Ok(&b"index"[..]));
    }
    assert_eq!((reader.stats().hits, reader.stats().unwritten), (0, 4));
    assert_eq!(std::fs::read_to_string(dir.join("taken")).ok().as_deref(), Some("a file"));
}

#[test]
fn paths_that_lead_elsewhere_reach_neither_the_cache_nor_the_server() {
    let (dir, source) = (TempDir::new("cache"), Arc::new(Source::default()));
    let reader = cached(&source, &dir, 1 << 20);
    for path in ["../secret", "blobs/../../secret", "/etc/passwd", "blobs/ab/../../x.bin", ""] {
        assert!(matches!(reader.read(path, 100), Err(ReadError::Forbidden { .. })), "{path}");
    }
    assert_eq!((source.asked.load(Ordering::SeqCst), files(&dir.0).len()), (0, 0));
}

#[test]
fn many_threads_share_a_cache() {
    let (dir, source) = (TempDir::new("cache"), Arc::new(Source::default()));
    let paths: Vec<String> = (0..40_u8).map(|n| source.blob(&[n; 50])).collect();
    let reader = cached(&source, &dir, 1_000);
    std::thread::scope(|scope| {
        for thread in 0..8 {
            let (reader, paths) = (&reader, &paths);
            scope.spawn(move || {
                for round in 0..200 {
                    let n = (round * 7 + thread * 11) % 40;
                    assert_eq!(reader.read(&paths[n], 50), Ok(vec![n as u8; 50]));
                }
            });
        }
    });
    let stats = reader.stats();
    assert!(stats.bytes <= 1_000 && stats.hits + stats.misses == 1_600, "{stats:?}");
}
