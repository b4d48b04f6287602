//! Finds cities: opens baked ones, bakes maps first.

use std::path::{Path, PathBuf};

use anstream::eprintln;
use indicatif::{ProgressBar, ProgressStyle};
use veduta_bake::{BakeSettings, Input, InputKind, Stage, bake, files_of_overrides, overrides_beside};
use veduta_city::{GraphOverrides, Life, Tour, file};
use veduta_store::{FORMAT_VERSION, INDEX_NAME};

use crate::Failure;

/// The sample city's scene folder.
#[must_use]
pub fn sample_scene() -> PathBuf {
    project_root().join("scenes/old_prague")
}

/// The project's folder: the working directory or the nearest above it that has the sample scene, else where the program was
/// built.
#[must_use]
pub fn project_root() -> PathBuf {
    let here = std::env::current_dir().unwrap_or_default();
    let above = here.ancestors().find(|folder| folder.join("scenes/old_prague").is_dir());
    above.map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new(".")).to_owned(), Path::to_owned)
}

/// The file of a kind that lies in a folder: the first by name.
#[must_use]
pub fn file_in(folder: &Path, ending: &str) -> Option<String> {
    let files =
        std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.file_name().to_string_lossy().into_owned());
    files.filter(|name| name.ends_with(ending)).min()
}

/// What lives in the city of a folder: what is told there; what lives by rule where nothing is.
///
/// # Errors
/// If the file cannot be read, or there are mistakes in it.
pub fn life_in(folder: &Path) -> Result<Life, Failure> {
    let Some(name) = file_in(folder, ".life.ron") else { return Ok(Life::default()) };
    let path = folder.join(name);
    let life: Life = file::read(&path)?;
    match life.validate().first() {
        Some(mistake) => Err(format!("{}: {mistake}", path.display()).into()),
        None => Ok(life),
    }
}

/// The folder in which tours of a city lie, its guide and what lives in it.
#[must_use]
pub fn scene_of(city: Option<&str>) -> PathBuf {
    match city {
        None => sample_scene(),
        Some(city) if city.contains("://") => PathBuf::from("."),
        // A folder that is no baked city is a scene itself.
        Some(city) if Path::new(city).is_dir() && !Path::new(city).join(INDEX_NAME).is_file() => PathBuf::from(city),
        Some(city) => folder_of(Path::new(city)),
    }
}

/// The folder that a file lies in.
#[must_use]
pub fn folder_of(path: &Path) -> PathBuf {
    path.parent().filter(|p| !p.as_os_str().is_empty()).map_or_else(|| PathBuf::from("."), Path::to_owned)
}

/// What streaming can open: a URL or the directory of a baked city. Maps, graphs and scenes are baked into the user's
/// cache, once for each content.
///
/// # Errors
/// If there is nothing to open, or the map cannot be baked.
pub fn open(city: Option<&str>) -> Result<String, Failure> {
    let Some(city) = city else { return open_path(&sample_scene()) };
    if city.starts_with("http://") || city.starts_with("https://") {
        return Ok(city.to_owned());
    }
    if city.contains("://") {
        return Err(format!("{city}: cities come from folders, http:// and https://").into());
    }
    open_path(Path::new(city))
}

/// The city that a tour names: beside the tour's file, or a URL.
///
/// # Errors
/// As [`open`]; or if the tour names none.
pub fn of_tour(tour: &Tour, path: &Path) -> Result<String, Failure> {
    named(&tour.city, path)
}

/// The city that a file names: beside the file, or a URL.
///
/// # Errors
/// As [`open`]; or if it names none.
pub fn named(city: &str, path: &Path) -> Result<String, Failure> {
    if city.is_empty() {
        return Err(format!("{}: it names no city: write city: \"town.city\"", path.display()).into());
    }
    if city.contains("://") {
        return open(Some(city));
    }
    let city = path.parent().unwrap_or(Path::new("")).join(city);
    open_path(&city).map_err(|e| format!("{}: its city: {e}", path.display()).into())
}

fn open_path(path: &Path) -> Result<String, Failure> {
    if path.join(INDEX_NAME).is_file() {
        return Ok(path.display().to_string());
    }
    let input = Input::of(path)?;
    let baked = cached(&input)?;
    if !baked.join(INDEX_NAME).is_file() {
        bake_with_bar(&input.path, &baked)?;
    }
    Ok(baked.display().to_string())
}

/// Where the city of an input lies in the cache: named by its content, that of its overrides and what they name, and the versions that made it.
fn cached(input: &Input) -> Result<PathBuf, Failure> {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&FORMAT_VERSION.to_le_bytes());
    hasher.update(&veduta_bake::GROWTH_VERSION.to_le_bytes());
    hasher.update(&veduta_bake::PARTITION_VERSION.to_le_bytes());
    hasher.update(env!("CARGO_PKG_VERSION").as_bytes());
    let read = |path: &Path| std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()));
    for file in input.files() {
        hasher.update(&read(&file)?);
    }
    let overrides = overrides_beside(&input.path);
    if input.kind != InputKind::Plan && overrides.exists() {
        hasher.update(&read(&overrides)?);
        // What is wrong with them is told when they are baked.
        let edits: GraphOverrides = file::read(&overrides).unwrap_or_default();
        for file in files_of_overrides(&edits, &overrides) {
            hasher.update(&read(&file)?);
        }
    }
    let stem = input.path.file_name().unwrap_or_default().to_string_lossy();
    let stem = stem.split('.').next().unwrap_or("city");
    let name = format!("{stem}-{}.city", &hasher.finalize().to_hex()[..16]);
    Ok(cache_dir().join("cities").join(name))
}

fn cache_dir() -> PathBuf {
    let var = |name| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    let base = var("XDG_CACHE_HOME")
        .or_else(|| var("LOCALAPPDATA"))
        .or_else(|| var("HOME").map(|home| home.join(".cache")))
        .unwrap_or_else(std::env::temp_dir);
    base.join("veduta")
}

/// Where what web servers sent is kept.
#[must_use]
pub fn streamed_dir() -> PathBuf {
    cache_dir().join("streamed")
}

fn bake_with_bar(input: &Path, out: &Path) -> Result<(), Failure> {
    let bar = ProgressBar::new(Stage::ALL.len() as u64);
    if let Ok(style) = ProgressStyle::with_template("baking {prefix}: {bar:24} {msg} ({elapsed})") {
        bar.set_style(style);
    }
    bar.set_prefix(input.file_name().unwrap_or_default().to_string_lossy().into_owned());
    if let Some(parent) = out.parent() {
        std::fs::create_dir_all(parent).map_err(|e| format!("{}: {e}", parent.display()))?;
    }
    let mut done = 0;
    let baked = bake(input, out, &BakeSettings::default(), &mut |stage| {
        bar.set_position(done);
        bar.set_message(stage.to_string());
        done += 1;
    });
    bar.finish_and_clear();
    let baked = baked?;
    if !baked.findings.is_empty() {
        eprintln!("{} findings; `veduta-bake bake {} --findings` lists them", baked.findings.len(), input.display());
    }
    Ok(())
}
