use std::collections::BTreeMap;
use std::path::Path;

use anstream::println;
use veduta_bake::{BakeError, BakeSettings, ExportSettings, cut, export_cells, export_glb, export_monuments};
use veduta_city::{CellOverride, CityPlan, House, Monument, file};
use veduta_growth::plan::Stock;

use super::Failure;
use super::report::report;

/// A parameter as it is given: `height=20`.
pub(crate) fn parameter(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or_else(|| format!("`{text}` is not NAME=NUMBER"))?;
    let value = value.trim().parse().map_err(|_| format!("`{value}` is no number"))?;
    Ok((name.trim().to_owned(), value))
}

pub(crate) fn city(plan: &CityPlan, settings: &ExportSettings, output: &Path) -> Result<(), Failure> {
    let glb = export_glb(plan, settings)?;
    file::write_bytes(&glb, output)?;
    let counts = (plan.houses.len(), plan.objects.len());
    println!("{}: {} houses, {} objects, {} bytes", output.display(), counts.0, counts.1, glb.len());
    Ok(())
}

/// A plan of some houses alone, by their names or ids; the whole one where none are named.
pub(crate) fn only(mut plan: CityPlan, names: &[String]) -> Result<CityPlan, Failure> {
    if names.is_empty() {
        return Ok(plan);
    }
    let is_meant =
        |house: &House, name: &String| house.name == *name || house.id.0.to_string() == *name || house.id.to_string() == *name;
    if let Some(name) = names.iter().find(|name| !plan.houses.iter().any(|house| is_meant(house, name))) {
        return Err(format!("no house has the name or id `{name}`: `export` of the whole city tells both with every house").into());
    }
    plan.houses.retain(|house| names.iter().any(|name| is_meant(house, name)));
    (plan.ground, plan.markings, plan.spans, plan.objects) = Default::default();
    Ok(plan)
}

/// A model for each cell, into a folder that holds nothing else.
pub(crate) fn cells(
    plan: &CityPlan,
    edits: &[CellOverride],
    settings: &ExportSettings,
    output: &Path,
    quiet: bool,
) -> Result<(), Failure> {
    let is_free = || Ok::<_, std::io::Error>(!output.exists() || std::fs::read_dir(output)?.next().is_none());
    if !is_free().map_err(|error| format!("{}: {error}", output.display()))? {
        return Err(format!("{}: there are files in it; name a new folder", output.display()).into());
    }
    let (cells, findings) = cut(plan, edits, &BakeSettings::default());
    report(&findings, quiet, false);
    let (mut files, mut bytes) = (0, 0);
    let mut write = |path: &str, content: &[u8]| -> Result<(), Failure> {
        (files, bytes) = (files + 1, bytes + content.len());
        let path = output.join(path);
        let folder = path.parent().unwrap_or(output);
        std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        Ok(file::write_bytes(content, &path)?)
    };
    export_cells(plan, &cells, settings, &mut write)?;
    println!("{}: {} cells, {} houses, {files} files, {bytes} bytes", output.display(), cells.cells.len(), plan.houses.len());
    Ok(())
}

/// Monuments of a file, which may use the stock's.
pub(crate) fn monuments(
    (path, read): (&Path, &[Monument]),
    one: Option<&str>,
    with: Vec<(String, f64)>,
    settings: &ExportSettings,
    output: &Path,
) -> Result<(), Failure> {
    let stock = Stock::new().with(&[], read.to_vec(), Vec::new());
    let stock = stock.map_err(|errors| BakeError::Stock { path: path.to_path_buf(), errors })?.monuments;

    let with: BTreeMap<String, f64> = with.into_iter().collect();
    let designs = match one {
        Some(name) => vec![stock.design(name, &with)?],
        None if with.is_empty() => read.iter().map(|m| stock.design(&m.name, &with)).collect::<Result<_, _>>()?,
        None => return Err("--with needs --monument: whose parameters are they?".into()),
    };
    let glb = export_monuments(&designs, settings)?;
    file::write_bytes(&glb, output)?;
    println!("{}: {} monuments, {} bytes", output.display(), designs.len(), glb.len());
    Ok(())
}
