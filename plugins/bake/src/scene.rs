use std::path::{Component, Path, PathBuf};

/// The place of a file that another names by its path from its own folder; `None` unless that leads down.
pub(crate) fn below(folder: &Path, name: &str) -> Option<PathBuf> {
    let path = Path::new(name);
    let leads_down = !name.is_empty() && path.components().all(|part| matches!(part, Component::Normal(_)));
    leads_down.then(|| folder.join(path))
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
mod tests {
    use super::*;

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
