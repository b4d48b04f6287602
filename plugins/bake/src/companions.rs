//! Files that belong to a city and travel with it: what is told of its places, and its tours.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use veduta_city::{Finding, Guide, Id, Severity, Soundscape, Tour, file};
use veduta_store::{CityWriter, StoreError};

use crate::scene::{below, stem_of};

/// Endings of files that belong to the city of the same stem beside them.
const OF_STEM: [&str; 3] = [".guide.ron", ".life.ron", ".sound.ron"];

/// Gives a city that is being written the files that lie beside its input: those of its stem (`X.guide.ron` beside `X.graph.ron`), tours that name
/// it, and the pictures and recordings that these name. What cannot be taken along is told.
///
/// # Errors
/// If the disk fails.
pub(crate) fn bring(input: &Path, writer: &mut CityWriter) -> Result<Vec<Finding>, StoreError> {
    let mut findings = Vec::new();
    let mut told = |path: &Path, why: String| {
        let message = format!("{} does not travel with the city: {why}", path.display());
        findings.push(Finding::new(Severity::Dropped, Id::NONE, None, message));
    };
    let folder = folder_of(input);
    let mut taken = BTreeSet::new();
    for path in beside(input) {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let named = named_by(&path).into_iter().filter_map(|file| Some((below(folder, &file)?, file)));
        for (path, name) in core::iter::once((path, name)).chain(named) {
            if !taken.insert(name.clone()) {
                continue;
            }
            match std::fs::read(&path) {
                Err(error) => told(&path, error.to_string()),
                Ok(content) => match writer.file(&name, &content) {
                    Err(error @ StoreError::Write { .. }) => return Err(error),
                    Err(error) => told(&path, error.to_string()),
                    Ok(()) => {}
                },
            }
        }
    }
    Ok(findings)
}

/// The files beside an input that belong to it, in the order of their names.
fn beside(input: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder_of(input)) else { return Vec::new() };
    let stem = stem_of(input);
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.sort();
    files.retain(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let is_of_stem = name.strip_prefix(&stem).is_some_and(|ending| OF_STEM.contains(&ending));
        path.is_file() && (is_of_stem || (name.ends_with(".tour.ron") && is_for(path, input)))
    });
    files
}

fn folder_of(input: &Path) -> &Path {
    input.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."))
}

/// Pictures and recordings that a file names by their paths from its folder. What cannot be read names nothing: `check` tells of its mistakes.
fn named_by(path: &Path) -> BTreeSet<String> {
    let name = path.to_string_lossy();
    let own = |files: BTreeSet<&str>| files.into_iter().map(str::to_owned).collect();
    if name.ends_with(".guide.ron") {
        file::read(path).map(|guide: Guide| own(guide.files())).unwrap_or_default()
    } else if name.ends_with(".sound.ron") {
        file::read(path).map(|sounds: Soundscape| own(sounds.files())).unwrap_or_default()
    } else if name.ends_with(".tour.ron") {
        file::read(path).map(|tour: Tour| own(tour.files())).unwrap_or_default()
    } else {
        BTreeSet::new()
    }
}

/// Whether a tour leads through the city that is made of an input. A tour that cannot be read is none: `check` tells of its mistakes.
fn is_for(tour: &Path, input: &Path) -> bool {
    let Ok(read) = file::read::<Tour>(tour) else { return false };
    let names = tour.with_file_name(&read.city).canonicalize();
    names.is_ok_and(|named| input.canonicalize().is_ok_and(|input| input == named))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_of_its_stem_and_tours_that_name_it_belong_to_a_city() {
        let dir = std::env::temp_dir().join(format!("veduta-companions-{}", std::process::id()));
        std::fs::create_dir_all(&dir).expect("room");
        let tour = |city: &str| format!("(title: \"T\", city: \"{city}\", steps: [Wait(seconds: 1)])");
        let files = [
            ("a.graph.ron", String::new()),
            ("a.guide.ron", String::new()),
            ("a.graph.overrides.ron", String::new()),
            ("ab.guide.ron", String::new()),
            ("b.graph.ron", String::new()),
            ("one.tour.ron", tour("a.graph.ron")),
            ("other.tour.ron", tour("b.graph.ron")),
            ("broken.tour.ron", "(".to_owned()),
        ];
        for (name, text) in &files {
            std::fs::write(dir.join(name), text).expect("room");
        }
        let found = beside(&dir.join("a.graph.ron"));
        let names: Vec<_> = found.iter().filter_map(|path| path.file_name()).collect();
        std::fs::remove_dir_all(&dir).expect("was made");
        assert_eq!(names, ["a.guide.ron", "one.tour.ron"]);
    }
}
