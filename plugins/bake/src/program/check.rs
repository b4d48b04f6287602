use std::path::{Path, PathBuf};

use veduta_city::{CityGraph, CityPlan, GraphOverrides, Styles, Tour, file};

use super::Failure;

/// Checks every file and names every mistake; fails if there is one.
pub(crate) fn check(files: &[PathBuf]) -> Result<(), Failure> {
    let mut bad = 0;
    for path in files {
        match check_one(path) {
            Ok(words) => println!("{}: {words}", path.display()),
            Err(mistakes) => {
                bad += 1;
                mistakes.iter().for_each(|m| eprintln!("{m}"));
            }
        }
    }
    if bad == 0 { Ok(()) } else { Err(format!("{bad} of {} files have mistakes", files.len()).into()) }
}

fn check_one(path: &Path) -> Result<String, Vec<String>> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let one = |e: file::FileError| vec![e.to_string()];
    if name.ends_with(".overrides.ron") {
        let overrides: GraphOverrides = file::read(path).map_err(one)?;
        let edits = overrides.validate().into_iter().map(|e| e.to_string());
        let mistakes: Vec<String> =
            edits.chain(Styles(overrides.styles.clone()).validate().iter().map(ToString::to_string)).collect();
        return told(path, mistakes, format!("{} edits, {} styles", overrides.edits.len(), overrides.styles.len()));
    }
    if name.ends_with(".graph.ron") {
        let mut graph: CityGraph = file::read(path).map_err(one)?;
        graph.fill_ids();
        let words = format!("{} links, {} blocks, {} buildings", graph.links.len(), graph.blocks.len(), graph.buildings.len());
        return told(path, graph.validate(), words);
    }
    if name.ends_with(".plan.ron") {
        let plan: CityPlan = file::read(path).map_err(one)?;
        return told(path, plan.styles.validate(), format!("{} houses", plan.houses.len()));
    }
    if name.ends_with(".tour.ron") {
        let tour: Tour = file::read(path).map_err(one)?;
        return Ok(format!("“{}”, {} steps", tour.title, tour.steps.len()));
    }
    if name.ends_with(".style.ron") {
        let style: veduta_city::Style = file::read(path).map_err(one)?;
        return told(path, Styles(vec![style]).validate(), "a style".to_owned());
    }
    Err(vec![format!(
        "{}: not a file of ours; it should end in .graph.ron, .overrides.ron, .plan.ron, .style.ron or .tour.ron",
        path.display()
    )])
}

fn told<E: core::fmt::Display>(path: &Path, mistakes: Vec<E>, words: String) -> Result<String, Vec<String>> {
    if mistakes.is_empty() { Ok(words) } else { Err(mistakes.iter().map(|m| format!("{}: {m}", path.display())).collect()) }
}
