use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use veduta_city::{CellShell, Cells, CityPlan, FacadeSheet};

use crate::compose::{Composed, compose, invalid};
use crate::{CityStats, INDEX_NAME, StoreError};

/// Writes a city into a directory: whole or not at all.
///
/// A directory that does not exist is built beside its place and moved there in one step. One that holds a city already, or
/// nothing, is brought up to date: missing blobs first, then the index in one step, then blobs that nothing names any more
/// are removed; whoever reads it meanwhile sees the old city or the new one, and what an interrupted run leaves is taken up
/// by the next. `shells` and `sheets` are by cell. The same arguments give the same bytes.
///
/// # Errors
/// [`StoreError::Invalid`] if the arguments contradict each other, before anything is touched; [`StoreError::Occupied`] if
/// something else is in the directory; [`StoreError::Write`] if the disk fails.
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
    write_city_with(dir, plan, cells, &|cell| (Cow::Borrowed(&shells[cell]), Cow::Borrowed(&sheets[cell])))
}

/// The same with shell and sheet of each cell made when they are wanted, on several threads: no more of them are in memory at once than
/// there are threads.
///
/// # Errors
/// As [`write_city`].
pub fn write_city_with<'a>(
    dir: &Path,
    plan: &CityPlan,
    cells: &Cells,
    contents: &(dyn Fn(usize) -> (Cow<'a, CellShell>, Cow<'a, FacadeSheet>) + Sync),
) -> Result<CityStats, StoreError> {
    let composed = compose(plan, cells, contents)?;
    let mut stats = composed.stats;
    if !dir.exists() {
        create(dir, &composed)?;
        stats.blobs_written = stats.blobs;
    } else if is_ours(dir)? {
        (stats.blobs_written, stats.blobs_removed) = replace(dir, &composed)?;
    } else {
        return Err(StoreError::Occupied(dir.to_owned()));
    }
    Ok(stats)
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

/// Builds a city beside its place and moves it there.
fn create(dir: &Path, composed: &Composed) -> Result<(), StoreError> {
    let Some(name) = dir.file_name() else { return Err(StoreError::Occupied(dir.to_owned())) };
    let part = dir.with_file_name(format!(".{}.part", name.to_string_lossy()));
    // What an interrupted run left behind.
    remove_all(&part)?;
    let built = fill(&part, composed).and_then(|()| fs::rename(&part, dir).map_err(failed("move into place", dir)));
    if built.is_err() {
        // The first error is the one to tell.
        let _ = remove_all(&part);
    }
    built
}

fn remove_all(dir: &Path) -> Result<(), StoreError> {
    match fs::remove_dir_all(dir) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(failed("remove", dir)(error)),
        _ => Ok(()),
    }
}

/// Fills a directory that nobody reads yet.
fn fill(dir: &Path, composed: &Composed) -> Result<(), StoreError> {
    fs::create_dir_all(dir).map_err(failed("create", dir))?;
    let mut folder = PathBuf::new();
    for (path, bytes) in &composed.blobs {
        let path = dir.join(path);
        if let Some(parent) = path.parent().filter(|parent| *parent != folder) {
            fs::create_dir_all(parent).map_err(failed("create", parent))?;
            folder = parent.to_owned();
        }
        fs::write(&path, bytes).map_err(failed("write", &path))?;
    }
    put(&dir.join(INDEX_NAME), &composed.index)
}

/// Writes a file so that it is there whole or not at all.
fn put(path: &Path, bytes: &[u8]) -> Result<(), StoreError> {
    if let Some(parent) = path.parent() {
        fs::create_dir_all(parent).map_err(failed("create", parent))?;
    }
    let part = path.with_extension("part");
    let write = || {
        let mut file = fs::File::create(&part)?;
        file.write_all(bytes)?;
        // A blob that a power cut swallows is found by its checksum and written again; the index must be sound.
        if path.ends_with(INDEX_NAME) {
            file.sync_all()?;
        }
        drop(file);
        fs::rename(&part, path)
    };
    write().map_err(failed("write", path))
}

/// Brings a city up to date. Returns how many blobs were written and removed.
fn replace(dir: &Path, composed: &Composed) -> Result<(u64, u64), StoreError> {
    let mut written = 0;
    for (path, bytes) in &composed.blobs {
        let path = dir.join(path);
        // A blob of that name with other bytes was damaged on the disk.
        if fs::read(&path).ok().as_deref() != Some(bytes.as_slice()) {
            put(&path, bytes)?;
            written += 1;
        }
    }
    put(&dir.join(INDEX_NAME), &composed.index)?;
    Ok((written, sweep(dir, &composed.blobs)?))
}

/// Removes blobs that nothing names, and what interrupted runs left of some. Other files are left alone.
fn sweep(dir: &Path, named: &BTreeMap<String, Vec<u8>>) -> Result<u64, StoreError> {
    let mut removed = 0;
    for folder in entries(&dir.join("blobs"))? {
        if !folder.is_dir() || folder.is_symlink() {
            continue;
        }
        for file in entries(&folder)? {
            let relative = file.strip_prefix(dir).unwrap_or(&file).iter().map(|part| part.to_string_lossy()).collect::<Vec<_>>();
            if is_blob(&file) && !file.is_dir() && !named.contains_key(&relative.join("/")) {
                fs::remove_file(&file).map_err(failed("remove", &file))?;
                removed += 1;
            }
        }
        if entries(&folder)?.is_empty() {
            fs::remove_dir(&folder).map_err(failed("remove", &folder))?;
        }
    }
    Ok(removed)
}

/// Whether a file is named as a blob, or a part of one, is.
fn is_blob(file: &Path) -> bool {
    let stem = file.file_stem().map(|stem| stem.to_string_lossy()).unwrap_or_default();
    let is_hash = stem.len() == 64 && stem.bytes().all(|b| b.is_ascii_hexdigit());
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
