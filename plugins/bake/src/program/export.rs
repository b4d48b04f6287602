use std::collections::BTreeMap;
use std::path::Path;

use anstream::println;
use veduta_bake::{BakeError, ExportSettings, export_glb, export_monuments};
use veduta_city::{CityPlan, Monument, file};
use veduta_growth::plan::Stock;

use super::Failure;

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
