//! Vector maps of one file, several, or a folder of them; and the `.map.ron` that names layers.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use veduta_city::file;
use veduta_survey::{Date, Kind, Layer, Mapping, Survey, survey_vector};

use crate::BakeError;
use crate::input::content;

/// The layers of a vector map and how they are to be read.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct VectorMap {
    /// The layers, in order.
    pub layers: Vec<LayerFile>,
    /// Which attributes mean what.
    pub mapping: Mapping,
    /// When the city is to be shown, where features have dates.
    pub date: Option<Date>,
}

/// A layer's file: GeoJSON, or the `.shp` of a Shapefile, whose `.dbf`, `.prj` and `.cpg` lie beside it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LayerFile {
    /// The file.
    pub path: PathBuf,
    /// What its features are where their attributes do not tell.
    pub holds: Option<Kind>,
}

/// A `.map.ron` file: a vector map of several layers, said once.
///
/// ```ron
/// (
///     layers: [
///         (file: "bubenec_buildings.geojson", holds: Building),
///         (file: "bubenec_streets.geojson"),
///     ],
///     mapping: (city: "Praha-Bubeneč", height: ["VYSKA_M"]),
///     date: "1876",
/// )
/// ```
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct MapFile {
    /// The layers; paths are relative to this file.
    layers: Vec<MapLayer>,
    /// Which attributes mean what.
    #[serde(default)]
    mapping: Mapping,
    /// When the city is to be shown.
    #[serde(default)]
    date: Option<String>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct MapLayer {
    file: PathBuf,
    #[serde(default)]
    holds: Option<Kind>,
}

/// Endings of files that are layers where a folder holds them.
const ENDINGS: [&str; 4] = [".geojson", ".geojsonl", ".geojsonseq", ".shp"];

/// Whether a file in a folder is a layer, by its name.
pub(crate) fn is_layer_name(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    ENDINGS.iter().any(|ending| name.ends_with(ending))
}

/// Whether the first bytes of a file are those of a layer.
pub(crate) fn looks_like_layer(head: &[u8]) -> bool {
    veduta_survey::looks_like_geojson(head) || veduta_survey::looks_like_shapefile(head)
}

impl VectorMap {
    /// A map of layers that say for themselves what they are.
    pub(crate) fn of_layers(paths: impl IntoIterator<Item = PathBuf>) -> Self {
        Self { layers: paths.into_iter().map(|path| LayerFile { path, holds: None }).collect(), ..Self::default() }
    }

    /// The map that a `.map.ron` file describes.
    pub(crate) fn of_map_file(path: &Path) -> Result<Self, BakeError> {
        let MapFile { layers, mapping, date } = file::read(path)?;
        let date = date.map(|d| d.parse::<Date>()).transpose();
        let date = date.map_err(|e| BakeError::Option { path: path.to_owned(), detail: format!("`date`: {e}") })?;
        if layers.is_empty() {
            let detail = "`layers` names no file: name the GeoJSON or Shapefiles of the map".to_owned();
            return Err(BakeError::Option { path: path.to_owned(), detail });
        }
        let beside = path.parent().unwrap_or(Path::new(""));
        let layers = layers.into_iter().map(|l| LayerFile { path: beside.join(l.file), holds: l.holds }).collect();
        Ok(Self { layers, mapping, date })
    }

    /// Every file that the map is read from, those beside Shapefiles too.
    pub(crate) fn files(&self) -> Vec<PathBuf> {
        let beside = |path: &Path| ["dbf", "prj", "cpg"].into_iter().filter_map(|e| sidecar(path, e)).collect::<Vec<_>>();
        self.layers.iter().flat_map(|l| core::iter::once(l.path.clone()).chain(beside(&l.path))).collect()
    }

    /// Surveys the map. `name` is that of the whole.
    pub(crate) fn survey(&self, name: &str) -> Result<Survey, BakeError> {
        let mut contents = Vec::with_capacity(self.layers.len());
        for LayerFile { path, .. } in &self.layers {
            let beside = |ending| sidecar(path, ending).map(|path| content(&path)).transpose();
            contents.push([Some(content(path)?), beside("dbf")?, beside("prj")?, beside("cpg")?]);
        }
        let names: Vec<String> =
            self.layers.iter().map(|l| l.path.file_name().unwrap_or_default().to_string_lossy().into_owned()).collect();
        let mut layers: Vec<Layer<'_>> = Vec::with_capacity(contents.len());
        for ((file, name), [bytes, dbf, prj, cpg]) in self.layers.iter().zip(&names).zip(&contents) {
            let (bytes, [dbf, prj, cpg]) = (bytes.as_deref().unwrap_or_default(), [dbf, prj, cpg].map(|b| b.as_deref()));
            layers.push(Layer { name, bytes, dbf, prj, cpg, holds: file.holds });
        }
        Ok(survey_vector(&layers, &self.mapping, self.date.as_ref(), name)?)
    }
}

/// The file of a Shapefile with another ending, in small or capital letters, if there is one beside a `.shp`.
fn sidecar(path: &Path, ending: &str) -> Option<PathBuf> {
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("shp")) {
        return None;
    }
    [ending.to_owned(), ending.to_uppercase()].into_iter().map(|e| path.with_extension(e)).find(|p| p.is_file())
}
