//! What is read from, as the commands that read maps have it.

use std::path::{Path, PathBuf};

use veduta_bake::Input;
use veduta_survey::Date;

use super::Failure;

/// A map, graph, plan or scene folder, and how a vector map is read.
#[derive(clap::Args)]
pub(crate) struct Source {
    /// What to read: a map (OpenStreetMap extract, GeoJSON, Shapefile, .map.ron), graph, plan or scene folder; several
    /// GeoJSON files or Shapefiles are the layers of one map.
    #[arg(required = true)]
    input: Vec<PathBuf>,
    /// Which attributes of a vector map mean what (RON).
    #[arg(long, value_name = "FILE")]
    mapping: Option<PathBuf>,
    /// When to show a vector map whose features have dates: 1876, 1876-05 or 1876-05-12.
    #[arg(long)]
    date: Option<Date>,
}

impl Source {
    /// The input with all that was said of it.
    pub(crate) fn input(&self) -> Result<Input, Failure> {
        let mut input = Input::of_all(&self.input)?;
        if let Some(path) = &self.mapping {
            input.read_mapping(path)?;
        }
        if let Some(date) = &self.date {
            input.set_date(date.clone())?;
        }
        Ok(input)
    }

    /// The first path: what results are named after.
    pub(crate) fn path(&self) -> &Path {
        self.input.first().map_or(Path::new(""), PathBuf::as_path)
    }
}
