//! Tours to and from Google Earth.

use std::path::{Component, Path, PathBuf};

use anstream::println;
use veduta_city::{TourText, file};
use veduta_route::{
    compile,
    kml::{KmlCity, from_kml, to_kml},
};

use super::{
    Failure,
    report::report_all,
    tour_check::first_mistake,
    town::{city_of, open},
};

/// What is done with a tour.
#[derive(clap::Subcommand)]
pub(crate) enum TourCommand {
    /// Read a tour that was made in Google Earth (KML) for a city.
    Import {
        /// The tour (.kml).
        kml: PathBuf,
        /// The city: a baked one, a map, graph, plan or scene folder.
        city: PathBuf,
        /// Where to write the tour (.tour.ron).
        #[arg(short, long)]
        output: PathBuf,
    },
    /// Write a tour as KML, for Google Earth. Chapters, marks and weather are not told in it.
    Export {
        /// The tour (.tour.ron); its city must lie where it says.
        tour: PathBuf,
        /// Where to write it (.kml).
        #[arg(short, long)]
        output: PathBuf,
        /// The code of the language that captions are written in, as in cs; the tour's own if not given.
        #[arg(long, value_name = "CODE", default_value = "")]
        language: String,
    },
}

/// Largest KML file that is read; bytes.
const LARGEST: u64 = 64 << 20;
/// So far beyond the city's last street its views may be, in metres.
const ROUND_ABOUT_M: f64 = 20_000.0;

pub(crate) fn tour(command: &TourCommand, quiet: bool) -> Result<(), Failure> {
    match command {
        TourCommand::Import { kml, city, output } => import(kml, city, output, quiet),
        TourCommand::Export { tour, output, language } => export(tour, output, language, quiet),
    }
}

fn import(kml: &Path, city: &Path, output: &Path, quiet: bool) -> Result<(), Failure> {
    let io = |error: std::io::Error| format!("{}: {error}", kml.display());
    if std::fs::metadata(kml).map_err(io)?.len() > LARGEST {
        return Err(format!("{}: more than {LARGEST} bytes: no tour is as long", kml.display()).into());
    }
    let bytes = std::fs::read(kml).map_err(io)?;
    let town = open(city).map_err(|error| format!("{}: {error}", city.display()))?;
    let name = named_from(output, city);
    let around = KmlCity {
        name: &name,
        anchor: town.anchor,
        zero_m: town.zero_m,
        terrain: &town.overview.terrain,
        reach_m: town.reach_m + ROUND_ABOUT_M,
    };
    let (tour, findings) = from_kml(&bytes, &kml.display().to_string(), around)?;
    report_all(&findings, &kml.display().to_string(), quiet);
    let text = TourText::new(&tour)?;
    let compiled = compile(&tour, &town.net, &town.places).map_err(|error| {
        first_mistake(&text, &town.net, &town.places, &output.display().to_string()).unwrap_or_else(|| error.to_string())
    })?;
    file::write_text(text.text(), output)?;
    println!("{}: “{}”, {} steps, {:.0} s", output.display(), tour.title, tour.steps.len(), compiled.duration_s());
    Ok(())
}

fn export(path: &Path, output: &Path, language: &str, quiet: bool) -> Result<(), Failure> {
    let text = TourText::read(path)?;
    let file = path.display().to_string();
    let Some(city) = city_of(path, &text.tour().city) else {
        let message =
            format!("its city `{}` is not here, and without it nobody knows where on Earth the tour is", text.tour().city);
        return Err(text.setting_mistake("city", &file, message).into());
    };
    let town = open(&city).map_err(|error| format!("{}: {error}", city.display()))?;
    let compiled = compile(text.tour(), &town.net, &town.places)
        .map_err(|error| first_mistake(&text, &town.net, &town.places, &file).unwrap_or_else(|| error.to_string()))?;
    let (kml, findings) = to_kml(&compiled, town.anchor, language);
    report_all(&findings, &file, quiet);
    file::write_text(&kml, output)?;
    println!("{}: “{}”, {:.0} s", output.display(), compiled.title_in(language), compiled.duration_s());
    Ok(())
}

/// A city's path as seen from a tour's file.
fn named_from(tour: &Path, city: &Path) -> String {
    let folder = tour.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let (Ok(folder), Ok(whole)) = (folder.canonicalize(), city.canonicalize()) else { return city.display().to_string() };
    let (from, to): (Vec<Component<'_>>, Vec<Component<'_>>) = (folder.components().collect(), whole.components().collect());
    let same = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    if same == 0 {
        return whole.display().to_string();
    }
    let up = from[same..].iter().map(|_| "..".to_owned());
    let parts: Vec<String> = up.chain(to[same..].iter().map(|part| part.as_os_str().to_string_lossy().into_owned())).collect();
    // As a tour's file writes it on every platform.
    if parts.is_empty() { ".".to_owned() } else { parts.join("/") }
}
