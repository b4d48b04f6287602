use std::path::{Path, PathBuf};

use veduta_city::{CityGraph, Finding};
use veduta_survey::{ElevationGrid, drape, heights_from_surface};

use crate::input::content;
use crate::{BakeError, Heights};

/// Gives a graph the ground of a terrain model, and its buildings the heights of a surface model, each where its file is given.
///
/// # Errors
/// If a file cannot be read, is no grid of elevations, or lies elsewhere than the city.
pub fn lay_on_ground(graph: &mut CityGraph, heights: &Heights) -> Result<Vec<Finding>, BakeError> {
    let read = |path: &Option<PathBuf>| path.as_ref().map(|path| grid(path, graph)).transpose();
    let (terrain, surface) = (read(&heights.terrain)?, read(&heights.surface)?);
    let mut findings = Vec::new();
    if let Some(terrain) = &terrain {
        findings.extend(drape(graph, terrain));
    }
    if let Some(surface) = &surface {
        findings.extend(heights_from_surface(graph, surface, terrain.as_ref()));
    }
    Ok(findings)
}

fn grid(path: &Path, graph: &CityGraph) -> Result<ElevationGrid, BakeError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let grid = ElevationGrid::read(&content(path)?, &name, prj_beside(path)?.as_deref())?;
    grid.check_covers(graph)?;
    Ok(grid)
}

/// The text of `x.prj` beside `x.asc`, `x.asc.gz` or `x.tif.zip`.
fn prj_beside(path: &Path) -> Result<Option<String>, BakeError> {
    let is_packed = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz") || e.eq_ignore_ascii_case("zip"));
    let plain = if is_packed { path.with_extension("") } else { path.to_owned() };
    let found = ["prj", "PRJ"].map(|ending| plain.with_extension(ending)).into_iter().find(|p| p.is_file());
    let text = found.map(|prj| content(&prj)).transpose()?;
    Ok(text.map(|bytes| String::from_utf8_lossy(&bytes).into_owned()))
}
