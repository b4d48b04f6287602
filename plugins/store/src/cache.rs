use std::collections::{BTreeMap, HashMap};
use std::fs::{self, File, FileTimes};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

use crate::blob::name_of;
use crate::disk::Disk;
use crate::index::is_whole;
use crate::reader::check_path;
use crate::write::lay_whole;
use crate::{Fresh, INDEX_NAME, ReadError, Reader};

/// A reader that keeps what it has read in a directory, so that a return costs nothing. Blobs are named by their content: one that is
/// there and answers to its name is not asked for again, whichever city it belongs to. The index is asked for every time, but travels
/// only if it has changed; where the server cannot be reached, the one from last time is as good as its blobs.
///
/// Over the cap, what was not used for longest goes. What cannot be written is read all the same, and counted. Several programs may
/// share a directory; each holds to its cap by what it knows of.
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
    /// What earlier runs left, by the times of the files. What they left half written goes.
    fn of(dir: &Path) -> Self {
        sweep_parts(&dir.join("named"));
        let mut found = Vec::new();
        for folder in fs::read_dir(dir.join("blobs")).into_iter().flatten().flatten() {
            sweep_parts(&folder.path());
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

/// Removes files of a folder that somebody began to write and has not ended for an hour.
fn sweep_parts(folder: &Path) {
    for file in fs::read_dir(folder).into_iter().flatten().flatten() {
        let is_part = file.path().extension().is_some_and(|extension| extension == "part");
        let age = file.metadata().and_then(|about| about.modified()).ok().and_then(|time| time.elapsed().ok());
        if is_part && age.is_some_and(|age| age.as_secs() > 3_600) {
            let _ = fs::remove_file(file.path());
        }
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

    /// Where a file of this city is kept that is not named by its content.
    fn named_file(&self, path: &str) -> PathBuf {
        let name = name_of(format!("{}\n{path}", self.inner.describe()).as_bytes());
        self.dir.join("named").join(name).with_extension("kept")
    }

    /// A blob that is kept and answers to its name, whoever has put it there.
    fn kept(&self, name: &str, limit: u64) -> Option<Vec<u8>> {
        let file = self.blob_file(name);
        let bytes = fs::read(&file).ok()?;
        if name_of(&bytes) != name {
            self.count(|counts| &mut counts.damaged);
            self.shelf(|shelf| {
                shelf.take(name);
                let _ = fs::remove_file(&file);
            });
            return None;
        }
        let size = bytes.len() as u64;
        if size > limit {
            return None;
        }
        self.put(name, size);
        // For the order in the next run; without it, the file counts as used when it was written.
        let times = FileTimes::new().set_modified(SystemTime::now());
        let _ = File::options().append(true).open(&file).and_then(|file| file.set_times(times));
        Some(bytes)
    }

    /// Keeps a blob, unless it is not what it is called or larger than all that may be kept.
    fn keep(&self, name: &str, bytes: &[u8]) {
        let size = bytes.len() as u64;
        if size <= self.cap_bytes && name_of(bytes) == name && self.write(&self.blob_file(name), bytes) {
            self.put(name, size);
        }
    }

    /// Notes that a blob was used, and lets go of what was not for longest, as far as the cap asks for it.
    fn put(&self, name: &str, size: u64) {
        let evicted = self.shelf(|shelf| {
            shelf.put(name.to_owned(), size);
            let mut evicted = 0;
            while shelf.bytes > self.cap_bytes
                && let Some(oldest) = shelf.oldest()
            {
                shelf.take(&oldest);
                let _ = fs::remove_file(self.blob_file(&oldest));
                evicted += 1;
            }
            evicted
        });
        self.counts.lock().unwrap_or_else(PoisonError::into_inner).evicted += evicted;
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
        let file = self.named_file(path);
        let kept = fs::read(&file).ok().and_then(|stored| {
            let named = Named::of(&stored);
            if named.is_none() {
                self.count(|counts| &mut counts.damaged);
                let _ = fs::remove_file(&file);
            }
            named.filter(|named| named.bytes.len() as u64 <= limit)
        });
        let tag = kept.as_ref().and_then(|named| named.tag.as_deref());
        match (self.inner.read_if_changed(path, limit, tag), kept) {
            (Ok(Fresh::Changed { bytes, tag }), _) => {
                self.count(|counts| &mut counts.misses);
                // A page that some gate on the way answers with must not take the place of a city.
                if path != INDEX_NAME || is_whole(&bytes) {
                    self.write(&file, &Named { tag, bytes: bytes.clone() }.stored());
                }
                Ok(bytes)
            }
            (Ok(Fresh::Same), Some(named)) => {
                self.count(|counts| &mut counts.hits);
                Ok(named.bytes)
            }
            (Ok(Fresh::Same), None) => self.inner.read(path, limit),
            (Err(error), Some(named)) if error.is_unreachable() => {
                self.count(|counts| &mut counts.hits);
                Ok(named.bytes)
            }
            (Err(error), _) => Err(error),
        }
    }
}

/// A file that may change, as it is kept: a checksum of the rest, how long the mark is, the mark, the bytes.
struct Named {
    /// The mark by which its server knows it.
    tag: Option<String>,
    bytes: Vec<u8>,
}

impl Named {
    fn of(stored: &[u8]) -> Option<Self> {
        let (sum, rest) = stored.split_first_chunk::<32>()?;
        if blake3::hash(rest).as_bytes() != sum {
            return None;
        }
        let (length, rest) = rest.split_first_chunk::<4>()?;
        let (tag, bytes) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
        let tag = (!tag.is_empty()).then(|| String::from_utf8_lossy(tag).into_owned());
        Some(Self { tag, bytes: bytes.to_vec() })
    }

    fn stored(&self) -> Vec<u8> {
        let tag = self.tag.as_deref().unwrap_or_default().as_bytes();
        let length = u32::try_from(tag.len()).unwrap_or(0);
        let rest = [&length.to_le_bytes()[..], &tag[..length as usize], &self.bytes].concat();
        [&blake3::hash(&rest).as_bytes()[..], &rest].concat()
    }
}

/// Name of the blob that lies at a path: its file's, without the end.
fn blob_name(path: &str) -> Option<&str> {
    let (folder, name) = path.strip_prefix("blobs/")?.strip_suffix(".bin")?.split_once('/')?;
    let is_name =
        name.len() == 2 * crate::BlobRef::HASH_BYTES && name.bytes().all(|b| b.is_ascii_digit() || (b'a'..=b'f').contains(&b));
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
