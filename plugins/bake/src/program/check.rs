use std::path::{Path, PathBuf};

use anstream::{eprintln, println};
use glam::DVec2;
use veduta_city::{
    CellsOverrides, CityGraph, CityPlan, GraphOverrides, Guide, Life, Monuments, Soundscape, StyleDraft, Views, file,
};
use veduta_growth::plan::{Repetition, Stock, repetition};
use veduta_survey::CityWords;

use super::Failure;
use super::beside::recording_beside;
use super::tour_check::check_tour;
use super::town::{Towns, check_guide, check_life};

/// Checks every file and names every mistake; fails if there is one.
/// `steps` asks for the seconds of each step of a tour.
pub(crate) fn check(files: &[PathBuf], steps: bool) -> Result<(), Failure> {
    let mut bad = 0;
    let mut towns = Towns::default();
    for path in files {
        let checked = if path.to_string_lossy().ends_with(".tour.ron") {
            let report = check_tour(path, &mut towns, steps);
            report.notes.iter().for_each(|note| eprintln!("{note}"));
            if report.mistakes.is_empty() { Ok(report.words) } else { Err(report.mistakes) }
        } else {
            check_one(path, &mut towns)
        };
        match checked {
            Ok(words) => println!("{}: {words}", path.display()),
            Err(mistakes) => {
                bad += 1;
                mistakes.iter().for_each(|m| eprintln!("{m}"));
            }
        }
    }
    if bad == 0 { Ok(()) } else { Err(format!("{bad} of {} files have mistakes", files.len()).into()) }
}

fn check_one(path: &Path, towns: &mut Towns) -> Result<String, Vec<String>> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let one = |e: file::FileError| vec![e.to_string()];
    if name.ends_with(".cells.overrides.ron") {
        let overrides: CellsOverrides = file::read(path).map_err(one)?;
        return told(path, overrides.validate(), format!("{} edits of cells", overrides.edits.len()));
    }
    if name.ends_with(".overrides.ron") {
        let overrides: GraphOverrides = file::read(path).map_err(one)?;
        let counts = [
            overrides.edits.len(),
            overrides.styles.len(),
            overrides.monuments.len(),
            overrides.furniture.len(),
            overrides.models.len(),
            overrides.facades.len(),
        ];
        let words = format!(
            "{} edits, {} styles, {} monuments, {} furniture rules, {} models, {} façades",
            counts[0], counts[1], counts[2], counts[3], counts[4], counts[5]
        );
        let edits = overrides.validate().into_iter().map(|e| e.to_string());
        let stock = Stock::new()
            .with(&overrides.styles, overrides.monuments.clone(), overrides.furniture.clone())
            .err()
            .unwrap_or_default();
        let models = veduta_bake::read_models(&overrides, path).err().unwrap_or_default();
        let facades = veduta_bake::read_facades(&overrides, path).err().unwrap_or_default();
        let edits = edits.chain(models.iter().chain(&facades).map(ToString::to_string));
        return told(path, edits.chain(stock.iter().map(ToString::to_string)).collect(), words);
    }
    if name.ends_with(".facade.ron") {
        let facade = veduta_bake::read_facade(path, DVec2::ZERO).map_err(|error| vec![error.to_string()])?;
        let (small, large) = (facade.painted.textures.len(), facade.pictures.iter().map(|picture| picture.0.len()).sum::<usize>());
        return Ok(format!("façade “{}”, {small} small textures, {} pictures of {large} B", facade.name, facade.pictures.len()));
    }
    if name.ends_with(".words.ron") {
        let city: CityWords = file::read(path).map_err(one)?;
        let words = format!("“{}”, {} districts", city.name, city.districts.len());
        return told(path, city.validate(), words);
    }
    if name.ends_with(".graph.ron") {
        let mut graph: CityGraph = file::read(path).map_err(one)?;
        graph.fill_ids();
        let words = format!("{} links, {} blocks, {} buildings", graph.links.len(), graph.blocks.len(), graph.buildings.len());
        return told(path, graph.validate(), words);
    }
    if name.ends_with(".plan.ron") {
        let plan: CityPlan = file::read(path).map_err(one)?;
        return told(path, plan.styles.validate(), format!("{} houses{}", plan.houses.len(), repeated(&plan)));
    }
    if name.ends_with(".guide.ron") {
        let guide: Guide = file::read(path).map_err(one)?;
        return check_guide(path, &guide, towns);
    }
    if name.ends_with(".life.ron") {
        let life: Life = file::read(path).map_err(one)?;
        return check_life(path, &life, towns);
    }
    if name.ends_with(".sound.ron") {
        let sounds: Soundscape = file::read(path).map_err(one)?;
        let files = sounds.files();
        let recordings = files.iter().filter_map(|file| recording_beside(path, file).err());
        let words = format!("{} sources, {} cues, {} recordings", sounds.sources.len(), sounds.cues.len(), files.len());
        return told(path, sounds.validate().into_iter().chain(recordings).collect(), words);
    }
    if name.ends_with(".views.ron") {
        let views: Views = file::read(path).map_err(one)?;
        return told(path, views.validate(), format!("{} stills, {} houses", views.stills.len(), views.houses.len()));
    }
    if let Some(read) = as_monuments(path) {
        let monuments = read.map_err(one)?;
        let words = format!("{} monuments", monuments.0.len());
        return told(path, Stock::new().with(&[], monuments.0, Vec::new()).err().unwrap_or_default(), words);
    }
    if let Some(read) = as_style(path, &name) {
        let draft = read.map_err(one)?;
        let words = format!("style `{}`", draft.name);
        return told(path, Stock::new().with(&[draft], Vec::new(), Vec::new()).err().unwrap_or_default(), words);
    }
    Err(vec![format!(
        "{}: not a file of ours; it should end in .graph.ron, .overrides.ron, .facade.ron, .plan.ron, .words.ron, .style.ron, .monuments.ron, .tour.ron, .guide.ron, .life.ron, .sound.ron or .views.ron, or lie \
         in a folder `styles` or `monuments`",
        path.display()
    )])
}

/// A file read as monuments, if it is meant to be one of them by its name or folder.
pub(super) fn as_monuments(path: &Path) -> Option<Result<Monuments, file::FileError>> {
    let name = path.file_name()?.to_string_lossy();
    let is_meant = name.ends_with(".monuments.ron") || name.ends_with(".ron") && folder(path).is_some_and(|f| f == "monuments");
    is_meant.then(|| file::read(path))
}

/// Name of the folder that a file lies in.
fn folder(path: &Path) -> Option<std::ffi::OsString> {
    // What has no folder in its path lies in the present one.
    path.canonicalize().ok().and_then(|path| Some(path.parent()?.file_name()?.to_owned()))
}

/// A file read as a style, if it is meant to be one: by its name, its folder, or because it can be read as one.
fn as_style(path: &Path, name: &str) -> Option<Result<StyleDraft, file::FileError>> {
    if !name.ends_with(".ron") {
        return None;
    }
    let is_meant = name.ends_with(".style.ron") || folder(path).is_some_and(|folder| folder == "styles");
    let read = file::read(path);
    (is_meant || read.is_ok()).then_some(read)
}

fn told<E: core::fmt::Display>(path: &Path, mistakes: Vec<E>, words: String) -> Result<String, Vec<String>> {
    if mistakes.is_empty() { Ok(words) } else { Err(mistakes.iter().map(|m| format!("{}: {m}", path.display())).collect()) }
}

/// How much fronts along streets repeat one another, in words.
fn repeated(plan: &CityPlan) -> String {
    let Repetition { fronts, mean, dullest, doubles } = repetition(plan);
    if fronts == 0 {
        return String::new();
    }
    let dullest = dullest.map_or_else(String::new, |(street, mean)| format!(" ({:.0} % in {street})", mean * 100.0));
    let doubles = match &doubles[..] {
        [] => "no doubles".to_owned(),
        [(a, b), ..] => format!("{} doubles, as {a} and {b}", doubles.len()),
    };
    format!("; {fronts} street fronts, each {:.0} % like the likest that is seen with it{dullest}, {doubles}", mean * 100.0)
}
