use std::path::{Path, PathBuf};

use veduta_city::file;
use veduta_survey::Date;
use veduta_survey::raster::Picture;

use crate::raster_map::RasterMap;
use crate::vector_map::{VectorMap, is_layer_name, looks_like_layer};
use crate::{BakeError, cells_overrides_beside};

/// Something that can be baked.
#[derive(Debug, Clone, PartialEq)]
pub struct Input {
    /// The file itself (for a scene folder: its graph; for a vector map what was named, or its first layer).
    pub path: PathBuf,
    /// What it is.
    pub kind: InputKind,
    /// The layers of a vector map, and how they are to be read; of nothing else.
    pub vector: Option<VectorMap>,
    /// How a raster map is to be read; of nothing else.
    pub raster: Option<RasterMap>,
    /// What is known of the ground; of no plan, which has its own.
    pub heights: Heights,
}

/// Files of elevations, each of one of the formats of [`ElevationGrid`](veduta_survey::ElevationGrid). The `.prj` beside a file is read
/// with it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Heights {
    /// Of the bare ground.
    pub terrain: Option<PathBuf>,
    /// With roofs and trees: buildings without a height get the one that it shows.
    pub surface: Option<PathBuf>,
}

/// What an input is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum InputKind {
    /// An OpenStreetMap extract.
    Osm,
    /// A vector map: GeoJSON, Shapefiles, a `.map.ron` or a folder with any of them.
    Vector,
    /// A picture of a street map.
    Raster,
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
        if name.ends_with(".map.ron") {
            return Ok(Self::vector(path, VectorMap::of_map_file(path)?));
        }
        let kind = if name.ends_with(".graph.ron") {
            InputKind::Graph
        } else if name.ends_with(".plan.ron") {
            InputKind::Plan
        } else if name.ends_with(".words.ron") {
            InputKind::Words
        } else {
            let head = head(path).map_err(read)?;
            match () {
                () if veduta_survey::looks_like_osm(&head) => InputKind::Osm,
                () if looks_like_layer(&head) => return Ok(Self::vector(path, VectorMap::of_layers([path.to_owned()]))),
                () if Picture::looks_like_picture(&head) => {
                    let raster = Some(RasterMap::default());
                    return Ok(Self {
                        path: path.to_owned(),
                        kind: InputKind::Raster,
                        vector: None,
                        raster,
                        heights: Heights::default(),
                    });
                }
                () => return Err(BakeError::UnknownKind(path.to_owned())),
            }
        };
        Ok(Self { path: path.to_owned(), kind, vector: None, raster: None, heights: Heights::default() })
    }

    fn vector(path: &Path, map: VectorMap) -> Self {
        Self { path: path.to_owned(), kind: InputKind::Vector, vector: Some(map), raster: None, heights: Heights::default() }
    }

    /// What several paths are: one of them by itself, more of them the layers of one vector map.
    ///
    /// # Errors
    /// As [`Input::of`]; and if one of several is no layer.
    pub fn of_all(paths: &[PathBuf]) -> Result<Self, BakeError> {
        let (first, more) = match paths {
            [] => return Err(BakeError::UnknownKind(PathBuf::new())),
            [only] => return Self::of(only),
            [first, more @ ..] => (first, more),
        };
        let mut input = Self::of(first)?;
        for path in core::iter::once(first).chain(more) {
            let layers = Self::of(path)?.vector.map(|map| map.layers).filter(|layers| layers.len() == 1 && layers[0].path == *path);
            let detail = "several inputs are the layers of one map: each must be GeoJSON or the .shp of a Shapefile".to_owned();
            let layers = layers.ok_or(BakeError::Option { path: path.clone(), detail })?;
            if let Some(map) = input.vector.as_mut().filter(|_| path != first) {
                map.layers.extend(layers);
            }
        }
        Ok(input)
    }

    /// Reads which attributes of a vector map mean what.
    ///
    /// # Errors
    /// If this is no vector map, or the file cannot be read or has a mistake.
    pub fn read_mapping(&mut self, path: &Path) -> Result<(), BakeError> {
        let mapping = file::read(path)?;
        self.vector_mut("a mapping of attributes")?.mapping = mapping;
        Ok(())
    }

    /// Says when a vector map is to be shown.
    ///
    /// # Errors
    /// If this is no vector map.
    pub fn set_date(&mut self, date: Date) -> Result<(), BakeError> {
        self.vector_mut("a date")?.date = Some(date);
        Ok(())
    }

    /// How this raster map is to be read.
    ///
    /// # Errors
    /// If this is no raster map.
    pub fn raster_mut(&mut self) -> Result<&mut RasterMap, BakeError> {
        let detail = "a legend, a scale and colours are for pictures of maps, which this is not".to_owned();
        let path = self.path.clone();
        self.raster.as_mut().ok_or(BakeError::Option { path, detail })
    }

    fn vector_mut(&mut self, what: &str) -> Result<&mut VectorMap, BakeError> {
        let detail = format!("{what} is for vector maps (GeoJSON, Shapefiles), which this is not");
        let path = self.path.clone();
        self.vector.as_mut().ok_or(BakeError::Option { path, detail })
    }

    /// Every file that is read for it, without the graph's overrides ([`overrides_beside`](crate::overrides_beside)): what a cache must look at.
    #[must_use]
    pub fn files(&self) -> Vec<PathBuf> {
        let own = [self.path.clone(), cells_overrides_beside(&self.path)].into_iter().filter(|path| path.is_file());
        let mut files: Vec<PathBuf> = own.chain(self.vector.iter().flat_map(VectorMap::files)).collect();
        files.extend(self.raster.iter().flat_map(|map| map.files(&self.path)));
        files.sort();
        files.dedup();
        files
    }

    /// The whole content of a map.
    pub(crate) fn content(&self) -> Result<Vec<u8>, BakeError> {
        content(&self.path)
    }
}

/// The whole content of a file that may be as large as a map.
pub(crate) fn content(path: &Path) -> Result<Vec<u8>, BakeError> {
    let read = |source| BakeError::Read { path: path.to_owned(), source };
    let bytes = std::fs::metadata(path).map_err(read)?.len();
    if bytes > LARGEST_MAP {
        return Err(BakeError::TooLarge { path: path.to_owned(), bytes, limit: LARGEST_MAP });
    }
    std::fs::read(path).map_err(read)
}

fn head(path: &Path) -> std::io::Result<Vec<u8>> {
    use std::io::Read;
    let mut head = Vec::new();
    std::fs::File::open(path)?.take(64 << 10).read_to_end(&mut head)?;
    Ok(head)
}

fn scene(dir: &Path) -> Result<Input, BakeError> {
    let read = |source| BakeError::Read { path: dir.to_owned(), source };
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(dir).map_err(read)? {
        paths.push(entry.map_err(read)?.path());
    }
    // The system lists files in any order.
    paths.sort();
    let named = |ending: &str| paths.iter().filter(|p| p.to_string_lossy().ends_with(ending)).cloned().collect::<Vec<_>>();
    let (graphs, maps) = (named(".graph.ron"), named(".map.ron"));
    match (graphs.as_slice(), maps.as_slice()) {
        ([path], _) => {
            Ok(Input { path: path.clone(), kind: InputKind::Graph, vector: None, raster: None, heights: Heights::default() })
        }
        ([], [path]) => Input::of(path),
        ([], []) => {
            let layers: Vec<PathBuf> = paths.into_iter().filter(|p| p.is_file() && is_layer_name(p)).collect();
            if layers.is_empty() {
                return Err(BakeError::Scene { path: dir.to_owned(), n: 0 });
            }
            Ok(Input::vector(dir, VectorMap::of_layers(layers)))
        }
        _ => Err(BakeError::Scene { path: dir.to_owned(), n: graphs.len() + maps.len() }),
    }
}
