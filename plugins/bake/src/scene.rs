use std::path::{Component, Path, PathBuf};

/// Why a file that another names by its path is not read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Astray {
    /// The path does not lead down.
    #[error("a file is named by a path that leads down from the folder of the file that names it")]
    Path,
    /// The path leads down by its letters, and out through a link.
    #[error("it is, or lies behind, a link that leads out of the folder of the file that names it: copy the file there")]
    Link,
}

/// The place of a file that another names by its path from its own folder. Nothing outside of that folder is named so, be it by the path or
/// through links; those that stay within it are followed. A file that is not there has a place, too: whoever reads it is told.
///
/// # Errors
/// If the path, or a link on its way, leads elsewhere.
pub fn below(folder: &Path, name: &str) -> Result<PathBuf, Astray> {
    let path = Path::new(name);
    let leads_down = !name.is_empty() && path.components().all(|part| matches!(part, Component::Normal(_)));
    if !leads_down {
        return Err(Astray::Path);
    }
    let place = folder.join(path);
    // The folder of a bare name is empty.
    let root = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let Ok(real_root) = root.canonicalize() else { return Ok(place) };
    // Of what is not there, what would hold it.
    let real = root.join(path).ancestors().find_map(|at| at.canonicalize().ok());
    if real.is_none_or(|real| real.starts_with(real_root)) { Ok(place) } else { Err(Astray::Link) }
}

/// Endings of graphs and maps.
const ENDINGS: [&str; 20] = [
    ".graph.ron",
    ".map.ron",
    ".words.ron",
    ".geojson",
    ".geojsonl",
    ".geojsonseq",
    ".shp",
    ".osm.pbf",
    ".osm.gz",
    ".osm.bz2",
    ".osm",
    ".pbf",
    ".png",
    ".jpg",
    ".jpeg",
    ".tif",
    ".tiff",
    ".webp",
    ".json.gz",
    ".json",
];

/// What a graph or map is called without its ending: `X` of `X.graph.ron`, `X.osm.pbf` and the like.
pub(crate) fn stem_of(input: &Path) -> String {
    let name = input.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let lower = name.to_lowercase();
    ENDINGS.iter().find(|e| lower.ends_with(*e)).map_or_else(|| name.clone(), |e| name[..name.len() - e.len()].to_owned())
}

/// The overrides file that belongs to a graph or map: `X.graph.overrides.ron` beside `X.graph.ron`, `X.osm.pbf` and the like.
#[must_use]
pub fn overrides_beside(input: &Path) -> PathBuf {
    input.with_file_name(format!("{}.graph.overrides.ron", stem_of(input)))
}

/// The overrides file of the cells of a graph, plan or map: `X.cells.overrides.ron` beside `X.graph.ron`, `X.plan.ron`, `X.osm.pbf` and the like.
#[must_use]
pub fn cells_overrides_beside(input: &Path) -> PathBuf {
    let stem = stem_of(input);
    input.with_file_name(format!("{}.cells.overrides.ron", stem.strip_suffix(".plan.ron").unwrap_or(&stem)))
}

#[cfg(test)]
#[path = "../../store/tests/escapes/mod.rs"]
mod escapes;

#[cfg(test)]
mod tests {
    use super::*;

    fn temp(name: &str) -> PathBuf {
        let dir = std::env::temp_dir().join(format!("veduta-scene-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&dir);
        std::fs::create_dir_all(dir.join("town/blobs/ab")).expect("room");
        dir
    }

    #[test]
    fn ten_thousand_paths_name_nothing_outside_of_a_folder() {
        let dir = temp("paths");
        for outside in ["secret.txt", "city.veduta", "etc/passwd", "blobs/secret.txt"] {
            let place = dir.join(outside);
            std::fs::create_dir_all(place.parent().expect("within")).expect("room");
            std::fs::write(place, "a secret").expect("room");
        }
        let (folder, corpus) = (dir.join("town"), escapes::corpus());
        std::fs::write(folder.join("blobs/secret.txt"), "no secret").expect("room");
        assert!(corpus.len() > 10_000, "{} paths", corpus.len());
        let (mut refused, mut found) = (0, 0);
        for path in &corpus {
            match below(&folder, path) {
                Err(_) => refused += 1,
                Ok(place) => {
                    found += usize::from(std::fs::read(&place).is_ok_and(|content| {
                        assert_eq!(content, b"no secret", "{path:?}");
                        true
                    }));
                }
            }
            // What is written in files for walkers is held to more, for it is read on any system.
            let parts = || path.split('/').filter(|part| !part.is_empty());
            let climbs = parts().any(|part| part == "..") || path.starts_with('/') || path.contains(['\\', ':', '\0']);
            assert!(!(climbs && veduta_city::is_beside(path)), "{path:?}");
            assert!(!veduta_city::is_beside(path) || below(&folder, path).is_ok(), "{path:?}");
        }
        std::fs::remove_dir_all(&dir).expect("was made");
        assert!(refused > corpus.len() / 4, "{refused} of {} were refused", corpus.len());
        assert!(found > 0, "some of them lead to the file within");
    }

    #[cfg(unix)]
    #[test]
    fn links_that_lead_out_of_a_folder_are_refused_and_those_within_it_are_followed() {
        use std::os::unix::fs::symlink;
        let dir = temp("links");
        let folder = dir.join("town");
        std::fs::write(dir.join("secret.txt"), "a secret").expect("room");
        std::fs::write(folder.join("own.txt"), "no secret").expect("room");
        symlink(dir.join("secret.txt"), folder.join("file.txt")).expect("a link");
        symlink("../secret.txt", folder.join("relative.txt")).expect("a link");
        symlink("..", folder.join("up")).expect("a link");
        symlink("own.txt", folder.join("within.txt")).expect("a link");
        symlink("nothing", folder.join("dangling.txt")).expect("a link");
        // Beside the folder, and called like it.
        std::fs::create_dir(dir.join("town2")).expect("room");
        symlink(dir.join("town2"), folder.join("next")).expect("a link");
        for astray in ["file.txt", "relative.txt", "up/secret.txt", "up/missing.txt", "up", "next"] {
            assert_eq!(below(&folder, astray), Err(Astray::Link), "{astray}");
        }
        for within in ["own.txt", "within.txt", "dangling.txt", "missing.txt", "none/missing.txt"] {
            assert_eq!(below(&folder, within), Ok(folder.join(within)), "{within}");
        }
        // A folder may itself lie behind a link.
        symlink(&folder, dir.join("linked")).expect("a link");
        assert!(below(&dir.join("linked"), "own.txt").is_ok());
        assert_eq!(below(&dir.join("linked"), "file.txt"), Err(Astray::Link));
        std::fs::remove_dir_all(&dir).expect("was made");
    }

    #[test]
    fn overrides_lie_beside_their_map() {
        assert_eq!(overrides_beside(Path::new("a/town.graph.ron")), Path::new("a/town.graph.overrides.ron"));
        assert_eq!(overrides_beside(Path::new("a/town.osm.pbf")), Path::new("a/town.graph.overrides.ron"));
        for name in ["a/town.graph.ron", "a/town.plan.ron", "a/town.osm.pbf"] {
            assert_eq!(cells_overrides_beside(Path::new(name)), Path::new("a/town.cells.overrides.ron"));
        }
        assert_eq!(overrides_beside(Path::new("Žižkov.OSM")), Path::new("Žižkov.graph.overrides.ron"));
    }
}
