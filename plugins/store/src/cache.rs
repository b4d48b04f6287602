use std::collections::{BTreeMap, HashMap};
use std::fs::{self, File, FileTimes};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

use crate::blob::name_of;
use crate::disk::Disk;
use crate::reader::check_path;
use crate::write::lay_whole;
use crate::{Fresh, ReadError, Reader};

/// A reader that keeps what it has read in a directory, so that a return costs nothing. Blobs are named by their content: one that is
/// there and answers to its name is not asked for again, whichever city it belongs to. The index is asked for every time, but travels
/// only if it has changed; where the server cannot be reached, the one from last time is as good as its blobs.
///
/// Over the cap, what was not used for longest goes. What cannot be written is read all the same, and counted. Several programs may
/// share a directory.
pub struct CacheReader {
    inner: Arc<dyn Reader>,
    dir: PathBuf,
    cap_bytes: u64,
    /// `None` until it is first needed: then the directory is looked through.
    shelf: Mutex<Option<Shelf>>,
    counts: Mutex<CacheStats>,
}

/// What a [`CacheReader`] has done so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CacheStats {
    /// Blobs that were there, and indices that had not changed or stood in for a server that could not be reached.
    pub hits: u64,
    /// Files that were read from where the city lies.
    pub misses: u64,
    /// Files that did not answer to their names, and were thrown away.
    pub damaged: u64,
    /// Files that went because of the cap.
    pub evicted: u64,
    /// Files that could not be written.
    pub unwritten: u64,
    /// Bytes of blobs that are kept.
    pub bytes: u64,
}

/// What lies in the directory.
#[derive(Default)]
struct Shelf {
    /// Blobs by name: size, and when last used.
    blobs: HashMap<String, (u64, u64)>,
    /// Their names by when they were last used.
    by_use: BTreeMap<u64, String>,
    bytes: u64,
    uses: u64,
}

impl Shelf {
    /// What earlier runs left, by the times of the files.
    fn of(dir: &Path) -> Self {
        let mut found = Vec::new();
        for folder in fs::read_dir(dir.join("blobs")).into_iter().flatten().flatten() {
            for file in fs::read_dir(folder.path()).into_iter().flatten().flatten() {
                let (path, about) = (file.path(), file.metadata());
                let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
                if let (Some(name), Ok(about), true) = (stem, about, path.extension().is_some_and(|extension| extension == "bin")) {
                    found.push((about.modified().unwrap_or(SystemTime::UNIX_EPOCH), name, about.len()));
                }
            }
        }
        found.sort();
        let mut shelf = Self::default();
        found.into_iter().for_each(|(_, name, size)| shelf.put(name, size));
        shelf
    }

    fn put(&mut self, name: String, size: u64) {
        self.take(&name);
        self.uses += 1;
        self.by_use.insert(self.uses, name.clone());
        self.blobs.insert(name, (size, self.uses));
        self.bytes += size;
    }

    fn take(&mut self, name: &str) {
        if let Some((size, used)) = self.blobs.remove(name) {
            self.by_use.remove(&used);
            self.bytes -= size;
        }
    }

    /// What was not used for longest.
    fn oldest(&self) -> Option<String> {
        self.by_use.first_key_value().map(|(_, name)| name.clone())
    }
}

impl CacheReader {
    /// Keeps what another reader reads in a directory, which is made when there is something to keep; of blobs no more than a cap, in
    /// bytes.
    #[must_use]
    pub fn new(inner: Arc<dyn Reader>, dir: impl Into<PathBuf>, cap_bytes: u64) -> Self {
        Self { inner, dir: dir.into(), cap_bytes, shelf: Mutex::default(), counts: Mutex::default() }
    }

    /// What it has done so far.
    #[must_use]
    pub fn stats(&self) -> CacheStats {
        let bytes = self.shelf(|shelf| shelf.bytes);
        CacheStats { bytes, ..*self.counts.lock().unwrap_or_else(PoisonError::into_inner) }
    }

    fn shelf<T>(&self, what: impl FnOnce(&mut Shelf) -> T) -> T {
        let mut shelf = self.shelf.lock().unwrap_or_else(PoisonError::into_inner);
        what(shelf.get_or_insert_with(|| Shelf::of(&self.dir)))
    }

    fn count(&self, what: fn(&mut CacheStats) -> &mut u64) {
        *what(&mut self.counts.lock().unwrap_or_else(PoisonError::into_inner)) += 1;
    }

    fn blob_file(&self, name: &str) -> PathBuf {
        self.dir.join("blobs").join(name.get(..2).unwrap_or_default()).join(format!("{name}.bin"))
    }

    /// Where a file of this city is kept that is not named by its content, and the mark by which its server knows it.
    fn named_files(&self, path: &str) -> (PathBuf, PathBuf) {
        let name = name_of(format!("{}\n{path}", self.inner.describe()).as_bytes());
        let file = self.dir.join("named").join(&name);
        (file.with_extension("bin"), file.with_extension("tag"))
    }

    /// A blob that is kept and answers to its name.
    fn kept(&self, name: &str, limit: u64) -> Option<Vec<u8>> {
        let size = self.shelf(|shelf| shelf.blobs.get(name).map(|(size, _)| *size))?;
        let file = self.blob_file(name);
        let bytes = if size <= limit { fs::read(&file).ok() } else { None };
        match bytes {
            Some(bytes) if name_of(&bytes) == name => {
                self.shelf(|shelf| shelf.put(name.to_owned(), size));
                // For the order in the next run; without it, the file counts as used when it was written.
                let _ = File::options()
                    .append(true)
                    .open(&file)
                    .and_then(|f| f.set_times(FileTimes::new().set_modified(SystemTime::now())));
                Some(bytes)
            }
            _ => {
                self.count(|counts| &mut counts.damaged);
                self.shelf(|shelf| shelf.take(name));
                let _ = fs::remove_file(&file);
                None
            }
        }
    }

    /// Keeps a blob, unless it is not what it is called or larger than all that may be kept.
    fn keep(&self, name: &str, bytes: &[u8]) {
        let size = bytes.len() as u64;
        if size > self.cap_bytes || name_of(bytes) != name {
            return;
        }
        if !self.write(&self.blob_file(name), bytes) {
            return;
        }
        let leaving = self.shelf(|shelf| {
            shelf.put(name.to_owned(), size);
            let mut leaving = Vec::new();
            while shelf.bytes > self.cap_bytes
                && let Some(oldest) = shelf.oldest()
            {
                shelf.take(&oldest);
                leaving.push(oldest);
            }
            leaving
        });
        for name in leaving {
            self.count(|counts| &mut counts.evicted);
            let _ = fs::remove_file(self.blob_file(&name));
        }
    }

    fn write(&self, file: &Path, bytes: &[u8]) -> bool {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let part = format!("{}-{}.part", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let is_written = lay_whole(&Disk::default(), file, &file.with_extension(part), bytes).is_ok();
        if !is_written {
            self.count(|counts| &mut counts.unwritten);
        }
        is_written
    }

    /// A file that may change: asked for anew, with the mark of what is kept.
    fn read_named(&self, path: &str, limit: u64) -> Result<Vec<u8>, ReadError> {
        let (file, mark) = self.named_files(path);
        let kept = fs::read(&file).ok().filter(|bytes| bytes.len() as u64 <= limit);
        let tag = kept.as_ref().and_then(|_| fs::read_to_string(&mark).ok());
        match (self.inner.read_if_changed(path, limit, tag.as_deref()), kept) {
            (Ok(Fresh::Changed { bytes, tag }), _) => {
                self.count(|counts| &mut counts.misses);
                // A file without its mark is asked for whole; a mark without its file is none.
                let _ = fs::remove_file(&mark);
                if self.write(&file, &bytes)
                    && let Some(tag) = tag
                {
                    self.write(&mark, tag.as_bytes());
                }
                Ok(bytes)
            }
            (Ok(Fresh::Same), Some(bytes)) => {
                self.count(|counts| &mut counts.hits);
                Ok(bytes)
            }
            (Ok(Fresh::Same), None) => self.inner.read(path, limit),
            (Err(error), Some(bytes)) if error.is_unreachable() => {
                self.count(|counts| &mut counts.hits);
                Ok(bytes)
            }
            (Err(error), _) => Err(error),
        }
    }
}

/// Name of the blob that lies at a path: its file's, without the end.
fn blob_name(path: &str) -> Option<&str> {
    let (folder, name) = path.strip_prefix("blobs/")?.strip_suffix(".bin")?.split_once('/')?;
    let is_name = name.len() == 32 && name.bytes().all(|b| b.is_ascii_digit() || (b'a'..=b'f').contains(&b));
    (is_name && name.starts_with(folder)).then_some(name)
}

impl Reader for CacheReader {
    fn read(&self, path: &str, limit: u64) -> Result<Vec<u8>, ReadError> {
        check_path(path)?;
        let Some(name) = blob_name(path) else { return self.read_named(path, limit) };
        if let Some(bytes) = self.kept(name, limit) {
            self.count(|counts| &mut counts.hits);
            return Ok(bytes);
        }
        let bytes = self.inner.read(path, limit)?;
        self.count(|counts| &mut counts.misses);
        self.keep(name, &bytes);
        Ok(bytes)
    }

    fn describe(&self) -> String {
        self.inner.describe()
    }
}
