use std::path::{Path, PathBuf};

use crate::BakeError;

/// Something that can be baked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Input {
    /// The file itself (for a scene folder: its graph).
    pub path: PathBuf,
    /// What it is.
    pub kind: InputKind,
}

/// What an input is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum InputKind {
    /// An OpenStreetMap extract.
    Osm,
    /// A city graph in RON.
    Graph,
    /// A city plan in RON.
    Plan,
    /// A city described in words, in RON.
    Words,
}

/// Largest map that is read, bytes.
const LARGEST_MAP: u64 = 2 << 30;

impl Input {
    /// What a path is: by name for the project's own files, by content for maps.
    ///
    /// # Errors
    /// If the path cannot be read, or is nothing that can be baked.
    pub fn of(path: &Path) -> Result<Self, BakeError> {
        let read = |source| BakeError::Read { path: path.to_owned(), source };
        let meta = std::fs::metadata(path).map_err(read)?;
        if meta.is_dir() {
            return scene(path);
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        let kind = if name.ends_with(".graph.ron") {
            InputKind::Graph
        } else if name.ends_with(".plan.ron") {
            InputKind::Plan
        } else if name.ends_with(".words.ron") {
            InputKind::Words
        } else if veduta_survey::looks_like_osm(&head(path).map_err(read)?) {
            InputKind::Osm
        } else {
            return Err(BakeError::UnknownKind(path.to_owned()));
        };
        Ok(Self { path: path.to_owned(), kind })
    }

    /// The whole content of a map.
    pub(crate) fn content(&self) -> Result<Vec<u8>, BakeError> {
        let read = |source| BakeError::Read { path: self.path.clone(), source };
        let bytes = std::fs::metadata(&self.path).map_err(read)?.len();
        if bytes > LARGEST_MAP {
            return Err(BakeError::TooLarge { path: self.path.clone(), bytes, limit: LARGEST_MAP });
        }
        std::fs::read(&self.path).map_err(read)
    }
}

fn head(path: &Path) -> std::io::Result<Vec<u8>> {
    use std::io::Read;
    let mut head = Vec::new();
    std::fs::File::open(path)?.take(64 << 10).read_to_end(&mut head)?;
    Ok(head)
}

fn scene(dir: &Path) -> Result<Input, BakeError> {
    let read = |source| BakeError::Read { path: dir.to_owned(), source };
    let mut graphs = Vec::new();
    for entry in std::fs::read_dir(dir).map_err(read)? {
        let path = entry.map_err(read)?.path();
        if path.to_string_lossy().ends_with(".graph.ron") {
            graphs.push(path);
        }
    }
    match <[PathBuf; 1]>::try_from(graphs) {
        Ok([path]) => Ok(Input { path, kind: InputKind::Graph }),
        Err(graphs) => Err(BakeError::Scene { path: dir.to_owned(), n: graphs.len() }),
    }
}
