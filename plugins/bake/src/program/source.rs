//! What is read from, as the commands that read maps have it.

use std::path::{Path, PathBuf};

use veduta_bake::{Heights, Input};
use veduta_survey::raster::SCALES_M;
use veduta_survey::{Crs, Date, KnownPoint};

use super::Failure;

/// A map, graph, plan or scene folder, and how a vector map is read.
#[derive(clap::Args)]
pub(crate) struct Source {
    /// What to read: a map (a picture, OpenStreetMap extract, GeoJSON, Shapefile, .map.ron), words, graph, plan or scene
    /// folder; several GeoJSON files or Shapefiles are the layers of one map.
    #[arg(required = true)]
    input: Vec<PathBuf>,
    /// Which attributes of a vector map mean what (RON).
    #[arg(long, value_name = "FILE")]
    mapping: Option<PathBuf>,
    /// What the colours of a picture stand for (RON or JSON); guessed if not given and no X.legend.ron lies beside it.
    #[arg(long, value_name = "FILE")]
    legend: Option<PathBuf>,
    /// Size of a picture's pixels in metres; as a world file, GeoTIFF tags or the legend say if not given, else guessed by the
    /// width of its streets.
    #[arg(long, value_name = "METRES", value_parser = scale)]
    metres_per_pixel: Option<f64>,
    /// A point of a picture whose place is known, given twice: column,row=latitude,longitude, as in 120,340=50.0870,14.4210.
    #[arg(long = "known-point", value_name = "POINT", num_args = 1, conflicts_with = "metres_per_pixel")]
    known_points: Vec<KnownPoint>,
    /// Coordinate system of a picture's world file: a code, as in EPSG:5514, or WKT; as a .prj beside it says if not given.
    #[arg(long, value_parser = crs, conflicts_with_all = ["metres_per_pixel", "known_points"])]
    crs: Option<Crs>,
    /// Write what is found on a picture, step by step, as pictures into this folder: X.classes.png, X.streets.png and
    /// X.skeleton.png.
    #[arg(long, value_name = "DIR")]
    stages: Option<PathBuf>,
    /// Go on from one of these pictures, mended in a paint program.
    #[arg(long, value_name = "STAGE.png")]
    from: Option<PathBuf>,
    /// Reduce a picture to so many colours before its legend is guessed.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=64))]
    colours: Option<u16>,
    /// Read the margin of a scanned sheet too: what lies outside of its neatline, the frame that its map ends at.
    #[arg(long)]
    keep_margin: bool,
    /// When to show a vector map whose features have dates: 1876, 1876-05 or 1876-05-12.
    #[arg(long)]
    date: Option<Date>,
    /// Terrain model, the city's bare ground: ESRI ASCII grid, SRTM .hgt or GeoTIFF, also in .zip or .gz; a .prj beside it tells its
    /// coordinate system where it does not do so itself.
    #[arg(long, value_name = "FILE")]
    terrain: Option<PathBuf>,
    /// Surface model (with roofs) that gives buildings without a height theirs; formats as for --terrain.
    #[arg(long, value_name = "FILE")]
    surface: Option<PathBuf>,
}

/// A size of pixels that a street map can have.
fn scale(text: &str) -> Result<f64, String> {
    let metres: f64 = text.parse().map_err(|_| format!("`{text}` is no number"))?;
    if SCALES_M.contains(&metres) {
        Ok(metres)
    } else {
        Err(format!("a street map has between {} and {} metres a pixel", SCALES_M.start(), SCALES_M.end()))
    }
}

fn crs(text: &str) -> Result<Crs, String> {
    Crs::from_text(text).map_err(|error| error.to_string())
}

impl Source {
    /// The input, if it is a single one.
    pub(crate) fn only(&self) -> Option<&Path> {
        match &self.input[..] {
            [path] => Some(path),
            _ => None,
        }
    }

    /// The input with all that was said of it.
    pub(crate) fn input(&self) -> Result<Input, Failure> {
        let mut input = Input::of_all(&self.input)?;
        if let Some(path) = &self.mapping {
            input.read_mapping(path)?;
        }
        if let Some(date) = &self.date {
            input.set_date(date.clone())?;
        }
        let known_points = match self.known_points[..] {
            [] => None,
            [a, b] => Some([a, b]),
            _ => return Err("a picture is placed by two known points: give --known-point twice".into()),
        };
        let is_placed = known_points.is_some() || self.metres_per_pixel.is_some() || self.crs.is_some();
        let by_stages = self.stages.is_some() || self.from.is_some();
        if is_placed || by_stages || self.keep_margin || self.legend.is_some() || self.colours.is_some() {
            let raster = input.raster_mut()?;
            raster.legend.clone_from(&self.legend);
            raster.metres_per_pixel = self.metres_per_pixel;
            raster.known_points = known_points;
            raster.crs = self.crs;
            raster.stages.clone_from(&self.stages);
            raster.from.clone_from(&self.from);
            raster.colours = self.colours.map(usize::from);
            raster.keeps_margin = self.keep_margin;
        }
        input.heights = Heights { terrain: self.terrain.clone(), surface: self.surface.clone() };
        Ok(input)
    }

    /// The first path: what results are named after.
    pub(crate) fn path(&self) -> &Path {
        self.input.first().map_or(Path::new(""), PathBuf::as_path)
    }
}
