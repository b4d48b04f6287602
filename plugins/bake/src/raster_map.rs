//! Raster maps: a picture, its legend and its scale.

use std::path::{Path, PathBuf};

use veduta_city::{CityGraph, Finding, Id, Severity};
use veduta_survey::SurveyError;
use veduta_survey::raster::{Legend, Picture, PictureLimits, RasterSettings, guess_legend, scale_by_streets, survey_raster};

use crate::BakeError;
use crate::input::content;

/// How a raster map is to be read.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RasterMap {
    /// What its colours stand for, RON or JSON; `X.legend.ron` or `X.legend.json` beside the picture if not given and there,
    /// guessed otherwise.
    pub legend: Option<PathBuf>,
    /// Size of a pixel; the legend's if not given, and by the width of ordinary streets if that has none.
    pub metres_per_pixel: Option<f64>,
    /// To how few colours the map is reduced before its legend is guessed; its own most frequent ones if not given.
    pub colours: Option<usize>,
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
    /// Extent in metres, east and north.
    pub extent_m: [f64; 2],
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
        let (legend, is_guessed) = match self.legend_file(path) {
            Some(file) => (read_legend(&file)?, false),
            None => {
                let (legend, found) = guess_legend(&picture, self.colours);
                findings.extend(found);
                done("legend");
                (legend, true)
            }
        };
        let legend_ron = legend.to_ron_with(&findings);
        let metres_per_pixel = match self.metres_per_pixel.or(legend.metres_per_pixel) {
            Some(metres) => metres,
            None => {
                let metres = scale_by_streets(&picture, &legend).ok_or_else(|| {
                    let holds = "no street by which to guess its scale".to_owned();
                    SurveyError::Empty { name: name.to_string(), holds, findings: String::new() }
                })?;
                let message = format!(
                    "the map's scale is not known: {metres:.2} metres a pixel make its streets as wide as streets are; say --metres-per-pixel if they are not"
                );
                findings.push(Finding::new(Severity::Note, Id::NONE, None, message));
                done("scale");
                metres
            }
        };
        let settings = RasterSettings { metres_per_pixel, threads: 1 };
        let survey = survey_raster(&picture, &legend, &settings, &name, done)?;
        findings.extend(survey.findings);
        let extent_m = [picture.width, picture.height].map(|n| n as f64 * metres_per_pixel);
        Ok(RasterSurvey { graph: survey.graph, findings, legend_ron, is_guessed, extent_m })
    }

    /// Its legend's file: the one given, or one beside the picture.
    pub(crate) fn legend_file(&self, path: &Path) -> Option<PathBuf> {
        let beside = |ending: &str| path.with_extension(ending);
        let candidates = [beside("legend.ron"), beside("legend.json")];
        self.legend.clone().or_else(|| candidates.into_iter().find(|file| file.is_file()))
    }
}

fn read_legend(path: &Path) -> Result<Legend, BakeError> {
    let text = std::fs::read_to_string(path).map_err(|source| BakeError::Read { path: path.to_owned(), source })?;
    Ok(Legend::parse(&text, &path.to_string_lossy())?)
}
