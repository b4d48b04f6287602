//! Raster maps: a picture, its legend and its scale.

use std::path::{Path, PathBuf};

use veduta_city::file::FileError;
use veduta_city::{CityGraph, Finding, Id, Severity};
use veduta_survey::raster::{
    Legend, Picture, PictureLimits, RasterSettings, Stage, Stages, guess_legend, scale_by_streets, survey_raster_by_stages,
};
use veduta_survey::{Crs, CrsError, Georeference, KnownPoint, SurveyError};

use crate::BakeError;
use crate::input::content;

/// How a raster map is to be read.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RasterMap {
    /// What its colours stand for, RON or JSON; `X.legend.ron` or `X.legend.json` beside the picture if not given and there,
    /// guessed otherwise.
    pub legend: Option<PathBuf>,
    /// Size of a pixel. If it is not given, nor known points, a world file beside the picture tells it, or the picture's own
    /// tags (GeoTIFF), or the legend; and the width of ordinary streets if none of these does.
    pub metres_per_pixel: Option<f64>,
    /// Two points of the picture whose place is known.
    pub known_points: Option<[KnownPoint; 2]>,
    /// The coordinate system of a world file, or of tags that name none; what a `.prj` beside the picture says if not given.
    pub crs: Option<Crs>,
    /// A folder in which the [stages](Stage) of reading are written as pictures, `X.streets.png` and the like.
    pub stages: Option<PathBuf>,
    /// A stage that was written, and mended in a paint program: it is taken as it is.
    pub from: Option<PathBuf>,
    /// To how few colours the map is reduced before its legend is guessed; its own most frequent ones if not given.
    pub colours: Option<usize>,
    /// Whether the margin of a scanned sheet is read too; else nothing outside of its neatline is.
    pub keeps_margin: bool,
}

/// A raster map as read.
#[derive(Debug, Clone)]
pub struct RasterSurvey {
    /// The city graph.
    pub graph: CityGraph,
    /// What was dropped, repaired or guessed.
    pub findings: Vec<Finding>,
    /// The legend it was read with, as a file for a person to correct.
    pub legend_ron: String,
    /// Whether that was guessed.
    pub is_guessed: bool,
    /// Extent in metres, east and north of plan (0, 0), of a picture of which only the scale is known.
    pub extent_m: Option<[f64; 2]>,
}

impl RasterMap {
    /// Reads the picture at a path. `done` is told the name of each step as it ends, `decode` first.
    ///
    /// # Errors
    /// If the picture or its legend cannot be read, or it shows no street.
    pub fn survey(&self, path: &Path, done: &mut dyn FnMut(&'static str)) -> Result<RasterSurvey, BakeError> {
        let bytes = content(path)?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let picture = Picture::decode(&bytes, &path.to_string_lossy(), &PictureLimits::default())?;
        done("decode");
        let mut findings = Vec::new();
        let (mut legend, is_guessed) = match self.legend_file(path) {
            Some(file) => (read_legend(&file)?, false),
            None => {
                let (legend, found) = guess_legend(&picture, self.colours);
                findings.extend(found);
                done("legend");
                (legend, true)
            }
        };
        let mut of_scale = None;
        let size = (picture.width as u32, picture.height as u32);
        let georeference = match self.place(path, &bytes, size)? {
            Some(place) => {
                legend.metres_per_pixel = Some(place.metres_per_pixel());
                place
            }
            None => {
                legend.metres_per_pixel = self.metres_per_pixel.or(legend.metres_per_pixel);
                let metres = match legend.metres_per_pixel {
                    Some(metres) => metres,
                    None => {
                        let (metres, finding) = guessed_scale(&picture, &legend, &name)?;
                        of_scale = Some(finding);
                        done("scale");
                        metres
                    }
                };
                Georeference::from_metres_per_pixel(&name, size, metres)?
            }
        };
        let legend_ron = legend.to_ron_with(&findings);
        findings.extend(of_scale);
        let metres = georeference.metres_per_pixel();
        let extent_m = (!georeference.is_placed()).then(|| [picture.width, picture.height].map(|n| n as f64 * metres));
        let settings = RasterSettings { georeference, threads: 1, keeps_margin: self.keeps_margin };
        let given = self.from.as_deref().map(read_stage).transpose()?;
        let mut failed = None;
        let mut write = |stage: Stage, picture: &Picture| {
            let name = path.with_extension(format!("{stage}.png"));
            let file = self.stages.iter().zip(name.file_name()).map(|(folder, name)| folder.join(name));
            failed = failed.take().or_else(|| file.map(|file| write_stage(picture, &file)).find_map(Result::err));
        };
        let mut stages = Stages { given: given.as_ref().map(|(stage, picture)| (*stage, picture)), ..Stages::default() };
        if self.stages.is_some() {
            stages.show = Some(&mut write);
        }
        let survey = survey_raster_by_stages(&picture, &legend, &settings, &name, &mut stages, done)?;
        if let Some(error) = failed {
            return Err(error);
        }
        findings.extend(survey.findings);
        Ok(RasterSurvey { graph: survey.graph, findings, legend_ron, is_guessed, extent_m })
    }

    /// Where the picture lies, if that is said; not where its scale was given alone.
    fn place(&self, path: &Path, bytes: &[u8], size: (u32, u32)) -> Result<Option<Georeference>, BakeError> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if let Some(points) = self.known_points {
            return Ok(Some(Georeference::from_known_points(&name, size, points)?));
        }
        if self.metres_per_pixel.is_some() {
            return Ok(None);
        }
        let tags = |crs: Option<&Crs>| Georeference::from_geotiff(&name, bytes, crs);
        let is_tiff = [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|magic| bytes.starts_with(*magic));
        // Tags that name their own coordinate system need nothing beside them.
        if is_tiff
            && self.crs.is_none()
            && let Ok(Some(place)) = tags(None)
        {
            return Ok(Some(place));
        }
        let world = world_file(path);
        if world.is_none() && !is_tiff {
            return match self.crs {
                Some(crs) => {
                    let detail = format!(
                        "{crs} is said to be its coordinate system, but no world file beside it says where in that it lies"
                    );
                    Err(SurveyError::Unplaced { name: name.to_string(), detail }.into())
                }
                None => Ok(None),
            };
        }
        let crs = match (self.crs, beside(path, &["prj"])) {
            (None, Some(prj)) => Some(crs_in(&prj)?),
            (given, _) => given,
        };
        if let Some(world) = world {
            let Some(crs) = crs else {
                let detail = format!(
                    "{} tells its place, but not in which coordinate system: say --crs, as in --crs EPSG:5514, or --metres-per-pixel to leave its place out",
                    world.display()
                );
                return Err(SurveyError::Unplaced { name: name.to_string(), detail }.into());
            };
            return Ok(Some(Georeference::from_world_file(&world.to_string_lossy(), size, &text(&world)?, &crs)?));
        }
        Ok(tags(crs.as_ref())?)
    }

    /// Files beside the picture that are read with it.
    pub(crate) fn files(&self, path: &Path) -> Vec<PathBuf> {
        let place = [world_file(path), beside(path, &["prj"])];
        self.legend_file(path).into_iter().chain(place.into_iter().flatten()).chain(self.from.clone()).collect()
    }

    /// Its legend's file: the one given, or one beside the picture.
    fn legend_file(&self, path: &Path) -> Option<PathBuf> {
        self.legend.clone().or_else(|| beside(path, &["legend.ron", "legend.json"]))
    }
}

/// The world file beside a picture: of its own ending's first and last letter and a w, of its ending and a w, or `.wld`.
fn world_file(path: &Path) -> Option<PathBuf> {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let short: String = ending.chars().take(1).chain(ending.chars().last()).chain(['w']).collect();
    let candidates = [short, format!("{ending}w"), "wld".to_owned()];
    let either: Vec<String> = candidates.iter().flat_map(|ending| [ending.clone(), ending.to_uppercase()]).collect();
    beside(path, &either.iter().map(String::as_str).collect::<Vec<_>>())
}

/// The first file beside a picture, of its name and one of some endings.
fn beside(path: &Path, endings: &[&str]) -> Option<PathBuf> {
    endings.iter().map(|ending| path.with_extension(ending)).find(|file| file.is_file())
}

/// The metres a pixel by which the streets are as wide as streets are, with a finding that says so.
fn guessed_scale(picture: &Picture, legend: &Legend, name: &str) -> Result<(f64, Finding), BakeError> {
    let metres = scale_by_streets(picture, legend).ok_or_else(|| {
        let holds = "no street by which to guess its scale".to_owned();
        SurveyError::Empty { name: name.to_owned(), holds, findings: String::new() }
    })?;
    let message = format!(
        "the map's scale is not known: {metres:.2} metres a pixel make its streets as wide as streets are; say --metres-per-pixel if they are not"
    );
    Ok((metres, Finding::new(Severity::Note, Id::NONE, None, message)))
}

/// A stage that was written before.
fn read_stage(path: &Path) -> Result<(Stage, Picture), BakeError> {
    let name = path.to_string_lossy();
    let Some(stage) = Stage::of_file(&path.file_name().unwrap_or_default().to_string_lossy()) else {
        let detail =
            "its name does not say which stage it is: stages are named map.classes.png, map.streets.png and map.skeleton.png";
        return Err(BakeError::Option { path: path.to_owned(), detail: detail.to_owned() });
    };
    Ok((stage, Picture::decode(&content(path)?, &name, &PictureLimits::default())?))
}

fn write_stage(picture: &Picture, path: &Path) -> Result<(), BakeError> {
    let failed = |source| BakeError::File(FileError::Io { path: path.to_owned(), source });
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(failed)?;
    }
    let file = std::fs::File::create(path).map_err(failed)?;
    picture.write_png(std::io::BufWriter::new(file)).map_err(failed)
}

fn read_legend(path: &Path) -> Result<Legend, BakeError> {
    Ok(Legend::parse(&text(path)?, &path.to_string_lossy())?)
}

fn crs_in(path: &Path) -> Result<Crs, BakeError> {
    let unplaced = |error: CrsError| SurveyError::Unplaced { name: path.to_string_lossy().into_owned(), detail: error.to_string() };
    Ok(Crs::from_text(&text(path)?).map_err(unplaced)?)
}

fn text(path: &Path) -> Result<String, BakeError> {
    std::fs::read_to_string(path).map_err(|source| BakeError::Read { path: path.to_owned(), source })
}
