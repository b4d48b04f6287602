use std::borrow::Cow;
use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use veduta_city::{CellShell, Cells, CityPlan, FacadeSheet};

use crate::compose::{self, CellParts, Division, invalid};
use crate::disk::Disk;
use crate::file::check_files;
use crate::{BlobRef, CellEntry, CityFile, CityIndex, CityStats, INDEX_NAME, StoreError, encode_file};

/// Writes a city into a directory: whole or not at all.
///
/// A directory that does not exist is built beside its place and moved there in one step. One that holds a city already, or
/// nothing, is brought up to date: missing blobs first, then the index in one step, then blobs that nothing names any more
/// are removed; whoever reads it meanwhile sees the old city or the new one, and what an interrupted run leaves is taken up
/// by the next. `shells` and `sheets` are by cell; painted walls, which have pictures, are for a [`CityWriter`]. The same arguments give
/// the same bytes.
///
/// # Errors
/// [`StoreError::Invalid`] if the arguments contradict each other; [`StoreError::Occupied`] if something else is in the
/// directory; [`StoreError::Write`] if the disk fails. What stood there still stands then.
pub fn write_city(
    dir: &Path,
    plan: &CityPlan,
    cells: &Cells,
    shells: &[CellShell],
    sheets: &[FacadeSheet],
) -> Result<CityStats, StoreError> {
    let count = cells.cells.len();
    for (name, found) in [("shells", shells.len()), ("sheets", sheets.len())] {
        if found != count {
            return Err(invalid(format!("there are {count} cells but {found} {name}")));
        }
    }
    let mut writer = CityWriter::new(dir, plan)?;
    let parts = |cell| CellParts {
        shell: Cow::Borrowed(&shells[cell]),
        sheet: Cow::Borrowed(&sheets[cell]),
        pictures: Vec::new(),
        ground: None,
    };
    writer.cells(plan, cells, &parts)?;
    writer.finish(cells.clone())
}

/// Writes a city piece by piece, as [`write_city`] does at once, so that no more of it need be in memory than is written just now: what
/// leads to all cells, then the cells, then, when the plan is no longer needed, the index. Dropped before it is finished, it
/// leaves what stood there as it was.
pub struct CityWriter {
    dir: PathBuf,
    files: Files,
    index: CityIndex,
    entries: Vec<CellEntry>,
    /// Of each region.
    overviews: Vec<BlobRef>,
    houses: Vec<Option<BlobRef>>,
    stats: CityStats,
}

impl CityWriter {
    /// Begins with what a plan tells of the city as a whole: styles are written.
    ///
    /// # Errors
    /// As [`write_city`].
    pub fn new(dir: &Path, plan: &CityPlan) -> Result<Self, StoreError> {
        Self::on(Disk::default(), dir, plan)
    }

    fn on(disk: Disk, dir: &Path, plan: &CityPlan) -> Result<Self, StoreError> {
        let files = Files::new(disk, dir)?;
        let mut stats = CityStats::default();
        let index = compose::head(plan, &mut stats, &|blob, stored| files.add(blob, stored))?;
        Ok(Self { dir: dir.to_owned(), files, index, entries: Vec::new(), overviews: Vec::new(), houses: Vec::new(), stats })
    }

    /// Writes the packets of all cells, the houses and the overviews of their regions. `contents` makes the parts of each when they are
    /// wanted, on several threads: of shells and sheets no more are in memory at once than there are threads, the ground of all until the
    /// overviews are written.
    ///
    /// # Errors
    /// As [`write_city`].
    pub fn cells<'a>(
        &mut self,
        plan: &CityPlan,
        cells: &Cells,
        contents: &(dyn Fn(usize) -> CellParts<'a> + Sync),
    ) -> Result<(), StoreError> {
        let files = &self.files;
        let sink = |blob: &BlobRef, stored: &[u8]| files.add(blob, stored);
        let division = Division::new(plan, &cells.cells, &mut self.stats, &sink)?;
        let (entries, ground) = compose::entries((plan, &division), cells, contents, &mut self.stats, &sink)?;
        self.overviews = compose::overviews((plan, &division), cells, (&entries, &ground), &mut self.stats, &sink)?;
        self.houses = division.blobs();
        self.entries = entries;
        Ok(())
    }

    /// Writes a file that is to travel with the city, by the path under which others name it.
    ///
    /// # Errors
    /// [`StoreError::Invalid`] if the path could lead elsewhere or was given before, or there are too many; [`StoreError::TooLarge`]; else as [`write_city`].
    pub fn file(&mut self, path: &str, content: &[u8]) -> Result<(), StoreError> {
        let stored = encode_file(content)?;
        let file = CityFile { path: path.to_owned(), blob: BlobRef::of(&stored) };
        let files = &mut self.index.files;
        let at = files.partition_point(|other| other.path.as_str() < path);
        files.insert(at, file);
        if let Err(reason) = check_files(files) {
            // One that is refused is in nobody else's way.
            files.remove(at);
            return Err(invalid(reason));
        }
        self.stats.bytes_files += stored.len() as u64;
        self.files.add(&BlobRef::of(&stored), &stored)
    }

    /// Writes the index, with what the cells tell of themselves, of what is seen from them and of the portals between them: the city is
    /// there. Cells must be in the order of the Morton codes of the middles of their outlines.
    ///
    /// # Errors
    /// As [`write_city`].
    pub fn finish(mut self, cells: Cells) -> Result<CityStats, StoreError> {
        let files = &self.files;
        let sink = |blob: &BlobRef, stored: &[u8]| files.add(blob, stored);
        let stored = compose::index(self.index, self.entries, (&self.overviews, &self.houses), cells, &mut self.stats, &sink)?;
        self.files.put(&self.files.site.join(INDEX_NAME), &stored)?;
        if self.files.is_new {
            self.files.disk.rename(&self.files.site, &self.dir).map_err(failed("move into place", &self.dir))?;
        }
        let (named, added) = self.files.keep();
        (self.stats.blobs, self.stats.blobs_written) = (named.len() as u64, added);
        self.stats.blobs_removed = self.files.sweep(&self.dir, &named)?;
        Ok(self.stats)
    }
}

/// The blobs of a city that is being written. Those that it brought go again if it is dropped before it is finished.
struct Files {
    disk: Disk,
    /// Where they are written: a directory that nobody reads yet, or the city's own.
    site: PathBuf,
    is_new: bool,
    written: Mutex<Written>,
    is_finished: bool,
}

#[derive(Default)]
struct Written {
    /// All that the city names.
    named: HashSet<BlobRef>,
    /// Those that were not there.
    added: Vec<BlobRef>,
    /// How many were there, but damaged.
    mended: u64,
}

impl Files {
    fn new(disk: Disk, dir: &Path) -> Result<Self, StoreError> {
        let occupied = || StoreError::Occupied(dir.to_owned());
        let is_new = !dir.exists();
        let site = match is_new {
            // What an interrupted run left behind goes.
            true => dir.with_file_name(format!(".{}.part", dir.file_name().ok_or_else(occupied)?.to_string_lossy())),
            false if is_ours(dir)? => dir.to_owned(),
            false => return Err(occupied()),
        };
        if is_new {
            disk.remove_all(&site).map_err(failed("remove", &site))?;
        }
        Ok(Self { disk, site, is_new, written: Mutex::default(), is_finished: false })
    }

    /// Writes a blob, once, unless it is there.
    fn add(&self, blob: &BlobRef, stored: &[u8]) -> Result<(), StoreError> {
        let written = || self.written.lock().unwrap_or_else(PoisonError::into_inner);
        if !written().named.insert(*blob) {
            return Ok(());
        }
        let path = self.site.join(blob.path());
        // A blob of that name with other bytes was damaged on the disk.
        let was_there = !self.is_new && path.exists();
        if was_there && fs::read(&path).ok().as_deref() == Some(stored) {
            return Ok(());
        }
        if self.is_new {
            self.disk.lay(&path, stored, false).map_err(failed("write", &path))?;
        } else {
            self.put(&path, stored)?;
        }
        let mut written = written();
        if was_there {
            written.mended += 1
        } else {
            written.added.push(*blob)
        }
        Ok(())
    }

    /// Keeps all. Returns what the city names, and how many of them were written.
    fn keep(&mut self) -> (HashSet<BlobRef>, u64) {
        self.is_finished = true;
        let written = core::mem::take(self.written.get_mut().unwrap_or_else(PoisonError::into_inner));
        (written.named, written.added.len() as u64 + written.mended)
    }

    /// Writes a file so that it is there whole or not at all.
    fn put(&self, path: &Path, bytes: &[u8]) -> Result<(), StoreError> {
        lay_whole(&self.disk, path, &path.with_extension("part"), bytes).map_err(failed("write", path))
    }

    /// Removes blobs that nothing names, and what interrupted runs left of some. Other files are left alone.
    fn sweep(&self, dir: &Path, named: &HashSet<BlobRef>) -> Result<u64, StoreError> {
        let named: HashSet<PathBuf> = named.iter().map(|blob| dir.join(blob.path())).collect();
        let mut removed = 0;
        for folder in entries(&dir.join("blobs"))? {
            if !folder.is_dir() || folder.is_symlink() {
                continue;
            }
            for file in entries(&folder)? {
                if is_blob(&file) && !file.is_dir() && !named.contains(&file) {
                    self.disk.remove_file(&file).map_err(failed("remove", &file))?;
                    removed += 1;
                }
            }
            if entries(&folder)?.is_empty() {
                self.disk.remove_dir(&folder).map_err(failed("remove", &folder))?;
            }
        }
        Ok(removed)
    }
}

impl Drop for Files {
    fn drop(&mut self) {
        if self.is_finished {
            return;
        }
        // Whatever led here is the error to tell.
        if self.is_new {
            let _ = self.disk.remove_all(&self.site);
            return;
        }
        let written = self.written.get_mut().unwrap_or_else(PoisonError::into_inner);
        for path in written.added.iter().map(|blob| self.site.join(blob.path())) {
            let _ = self.disk.remove_file(&path);
            // Folders that hold others stay.
            let _ = path.parent().map(|folder| self.disk.remove_dir(folder));
        }
    }
}

/// Whether a directory holds a city, nothing, or no more than an interrupted run leaves.
fn is_ours(dir: &Path) -> Result<bool, StoreError> {
    if !dir.is_dir() {
        return Ok(false);
    }
    let is_left = |path: &PathBuf| path.file_name().is_some_and(|name| name == "blobs" || name == "city.part");
    Ok(dir.join(INDEX_NAME).is_file() || entries(dir)?.iter().all(is_left))
}

/// Turns an error of the system into ours.
fn failed(doing: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> StoreError {
    let path = path.to_owned();
    move |error| StoreError::Write { doing, path, message: error.to_string() }
}

/// Writes a file so that it is there whole or not at all, by way of another beside it.
pub(crate) fn lay_whole(disk: &Disk, path: &Path, part: &Path, bytes: &[u8]) -> std::io::Result<()> {
    // A blob that a power cut swallows is found by its checksum and written again; the index must be sound.
    let done = disk.lay(part, bytes, path.ends_with(INDEX_NAME)).and_then(|()| disk.rename(part, path));
    if done.is_err() {
        // Whatever led here is the error to tell.
        let _ = disk.remove_file(part);
    }
    done
}

/// Whether a file is named as a blob, or a part of one, is.
fn is_blob(file: &Path) -> bool {
    let stem = file.file_stem().map(|stem| stem.to_string_lossy()).unwrap_or_default();
    let is_hash = stem.len() == 2 * BlobRef::HASH_BYTES && stem.bytes().all(|b| b.is_ascii_hexdigit());
    is_hash && file.extension().is_some_and(|extension| extension == "bin" || extension == "part")
}

/// What is in a directory, in order; nothing if it does not exist.
fn entries(dir: &Path) -> Result<Vec<PathBuf>, StoreError> {
    let listing = match fs::read_dir(dir) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        listing => listing.map_err(failed("list", dir))?,
    };
    let all = listing.map(|entry| entry.map(|entry| entry.path())).collect::<Result<Vec<_>, _>>();
    let mut all = all.map_err(failed("list", dir))?;
    all.sort();
    Ok(all)
}

#[cfg(test)]
#[path = "../tests/sample/mod.rs"]
mod sample;

#[cfg(test)]
mod tests {
    use veduta_city::Level;

    use super::sample::{City, TempDir, city, files};
    use super::*;
    use crate::{DirReader, ReadError, Reader, decode_packet, read_index, read_overview};

    /// Writes a city on a disk that dies after so many steps; whether it did.
    fn write_dying(city: &City, dir: &Path, steps: i64) -> bool {
        let write = || -> Result<CityStats, StoreError> {
            let mut writer = CityWriter::on(Disk::dying_after(steps), dir, &city.plan)?;
            writer.cells(&city.plan, &city.cells, &|cell| city.parts(cell))?;
            writer.finish(city.cells.clone())
        };
        match write() {
            Ok(_) => false,
            Err(StoreError::Write { message, .. }) if message == "killed" => true,
            Err(error) => panic!("after {steps} steps: {error}"),
        }
    }

    /// How many houses a city shows that is read through and through; `None` if there is none.
    fn houses(dir: &Path) -> Option<usize> {
        let reader = match DirReader::new(dir) {
            Err(ReadError::NoDirectory(_) | ReadError::NoIndex(_)) => return None,
            reader => reader.expect("a directory"),
        };
        let index = read_index(&reader).expect("whole");
        let read = |blob: &BlobRef| reader.read(&blob.path(), blob.bytes.into()).expect("there");
        for (i, cell, level) in index.cells().flat_map(|(i, cell)| Level::ALL.map(|level| (i, cell, level))) {
            if let Some(blob) = cell.packet(level) {
                decode_packet(&read(blob), blob, level, index.packet_context(i)).expect("whole");
            }
        }
        Some(read_overview(&reader, &index).expect("whole").houses.len())
    }

    #[test]
    fn a_writer_that_is_killed_at_any_step_leaves_the_old_city_or_the_new_one() {
        let (old, new) = (city(3, 1), city(2, 2));
        let fresh = TempDir::new("fresh");
        new.write(&fresh.join("x")).expect("written");
        let expected: Vec<Vec<u8>> = files(&fresh.join("x")).into_values().collect();
        for is_over_old in [false, true] {
            let mut seen = std::collections::BTreeSet::new();
            for steps in 0.. {
                let temp = TempDir::new("killed");
                let dir = temp.join("x");
                if is_over_old {
                    old.write(&dir).expect("written");
                }
                let is_killed = write_dying(&new, &dir, steps);
                seen.insert(houses(&dir));
                // The next run takes up what is there, and leaves nothing over.
                new.write(&dir).expect("taken up");
                assert_eq!(houses(&dir), Some(8), "after {steps} steps");
                assert_eq!(files(&temp.0).into_values().collect::<Vec<_>>(), expected, "after {steps} steps");
                if !is_killed {
                    assert!(steps > 9, "only {steps} steps");
                    break;
                }
            }
            assert_eq!(seen, [is_over_old.then_some(6), Some(8)].into());
        }
    }
}
