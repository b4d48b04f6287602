//! Files that belong to a city and travel with it: what is told of its places, what lies beyond it, and its tours.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use veduta_city::{Finding, Guide, Id, Severity, Soundscape, Tour, file};
use veduta_store::{CityWriter, StoreError};

use crate::scene::{Astray, below, stem_of};

/// Endings of files that belong to the city of the same stem beside them.
const OF_STEM: [&str; 4] = [".backdrop.png", ".guide.ron", ".life.ron", ".sound.ron"];

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
        for name in core::iter::once(name).chain(named_by(&path)) {
            let path = match below(folder, &name) {
                // `check` tells of it.
                Err(Astray::Path) => continue,
                _ if !taken.insert(name.clone()) => continue,
                Err(astray) => {
                    told(&folder.join(&name), astray.to_string());
                    continue;
                }
                Ok(path) => path,
            };
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
            ("a.backdrop.png", String::new()),
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
        assert_eq!(names, ["a.backdrop.png", "a.guide.ron", "one.tour.ron"]);
    }

    #[cfg(unix)]
    #[test]
    fn what_lies_behind_a_link_out_of_the_folder_stays_at_home() {
        use std::os::unix::fs::symlink;
        let dir = std::env::temp_dir().join(format!("veduta-companions-links-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&dir);
        std::fs::create_dir_all(dir.join("town/pictures")).expect("room");
        let put = |name: &str, text: &str| std::fs::write(dir.join(name), text).expect("room");
        put("secret.png", "a secret");
        put("town/pictures/own.png", "a picture");
        put("town/a.graph.ron", "");
        put("town/pictures/a space.png", "a picture");
        let named = ["a space", "own", "out", "within"].map(|name| format!("(file: \"pictures/{name}.png\", credit: {{}})"));
        put("town/a.guide.ron", &format!("(places: [(name: \"P\", pictures: [{}])])", named.join(", ")));
        symlink(dir.join("secret.png"), dir.join("town/pictures/out.png")).expect("a link");
        symlink("own.png", dir.join("town/pictures/within.png")).expect("a link");
        symlink(dir.join("secret.png"), dir.join("town/a.life.ron")).expect("a link");
        let baked = dir.join("a.city");
        let (plan, none) = (veduta_city::CityPlan::default(), veduta_city::Cells::default());
        let mut writer = CityWriter::new(&baked, &plan).expect("begun");
        writer.cells(&plan, &none, &|cell| panic!("there is no cell {cell}")).expect("written");
        let findings = bring(&dir.join("town/a.graph.ron"), &mut writer).expect("written");
        let told: Vec<&str> = findings.iter().map(|finding| finding.message.as_str()).collect();
        assert!(told.len() == 3 && told[1..].iter().all(|one| one.contains("leads out of the folder")), "{told:?}");
        assert!(told[0].contains("a space.png") && told[0].contains("only letters"), "{told:?}");
        assert!(told[1].contains("out.png") && told[2].contains("a.life.ron"), "{told:?}");
        writer.finish(none).expect("written");
        let reader = veduta_store::DirReader::new(&baked).expect("a city");
        let index = veduta_store::read_index(&reader).expect("an index");
        let brought: Vec<&str> = index.files.iter().map(|file| file.path.as_str()).collect();
        std::fs::remove_dir_all(&dir).expect("was made");
        assert_eq!(brought, ["a.guide.ron", "pictures/own.png", "pictures/within.png"]);
    }
}
