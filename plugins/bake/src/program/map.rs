//! `veduta-bake map`: a city's map for print.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anstream::{eprintln, println};
use glam::DVec2;
use veduta_cartography::{Colours, DENOMINATORS, Detail, Layers, MapWords, Order, Paper, Ways, draw, to_png, to_svg};
use veduta_city::{GridPolygon, Guide, Overview, Place, Tour, file};
use veduta_route::{Gazetteer, StreetNet, compile, fold};
use veduta_store::{DirReader, INDEX_NAME, read_index, read_overview};

use super::source::Source;
use super::{Failure, planned};

/// How a map is wished for.
#[derive(clap::Args)]
pub(crate) struct Wishes {
    /// Paper: A0 to A5, turned as it fits best, or its sides, as in 400x300mm.
    #[arg(long, default_value = "A3")]
    paper: Paper,
    /// Scale, as in 1:2500; the largest round one at which the city fits if not given.
    #[arg(long, value_parser = denominator)]
    scale: Option<f64>,
    /// What lies in the middle, in plan metres: "120,-40".
    #[arg(long, value_name = "X,Y", value_parser = position, allow_hyphen_values = true, conflicts_with = "place")]
    centre: Option<DVec2>,
    /// What lies in the middle: a place or street by its name.
    #[arg(long, value_name = "NAME")]
    place: Option<String>,
    /// Heading that points up, degrees clockwise from north.
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, value_parser = turn, allow_hyphen_values = true)]
    turn: f64,
    /// Language of the margin, and of names where a guide (X.guide.ron) tells them.
    #[arg(long, default_value = "en")]
    language: String,
    /// A guide that tells names in other languages; the one beside the map if not given.
    #[arg(long, value_name = "FILE")]
    guide: Option<PathBuf>,
    /// What is shown, of names, places, views, landmarks, trees, route, tour and trail; all if not given.
    #[arg(long, value_delimiter = ',', value_name = "LAYER,…")]
    layers: Option<Vec<String>>,
    /// Draw the way between two places or positions.
    #[arg(long, num_args = 2, value_names = ["FROM", "TO"], allow_hyphen_values = true)]
    route: Option<Vec<String>>,
    /// Lead that way without stairs.
    #[arg(long, requires = "route")]
    without_steps: bool,
    /// Draw where a tour leads.
    #[arg(long, value_name = "FILE")]
    tour: Option<PathBuf>,
    /// Inks: paper, contrast or colour-blind.
    #[arg(long, default_value = "paper", value_parser = inks)]
    inks: Colours,
    /// Pixels an inch of a PNG.
    #[arg(long, default_value_t = 300.0, value_parser = dpi)]
    dpi: f64,
    /// Lay a grid over the map, and an index of names beside it.
    #[arg(long)]
    index: bool,
    /// What stands above the map; the city's name if not given.
    #[arg(long)]
    title: Option<String>,
    /// A date or other words for the margin; none is taken from a clock.
    #[arg(long, value_name = "WORDS")]
    dated: Option<String>,
}

fn number(text: &str, least: f64, most: f64) -> Result<f64, String> {
    let value: f64 = text.trim().parse().map_err(|_| format!("`{text}` is no number"))?;
    if (least..=most).contains(&value) { Ok(value) } else { Err(format!("give {least} to {most}")) }
}

fn denominator(text: &str) -> Result<f64, String> {
    number(text.trim().strip_prefix("1:").unwrap_or(text), *DENOMINATORS.start(), *DENOMINATORS.end())
}

fn position(text: &str) -> Result<DVec2, String> {
    let (x, y) = text.split_once(',').ok_or_else(|| format!("`{text}` is no position: write \"120,-40\""))?;
    Ok(DVec2::new(number(x, -2e6, 2e6)?, number(y, -2e6, 2e6)?))
}

fn turn(text: &str) -> Result<f64, String> {
    number(text, -360.0, 360.0)
}

fn dpi(text: &str) -> Result<f64, String> {
    number(text, 20.0, 1_200.0)
}

fn inks(text: &str) -> Result<Colours, String> {
    match text {
        "paper" => Ok(Colours::Paper),
        "contrast" => Ok(Colours::Contrast),
        "colour-blind" => Ok(Colours::ColourBlind),
        _ => Err("give paper, contrast or colour-blind".to_owned()),
    }
}

/// What is drawn of a city.
struct Subject {
    name: String,
    credit: String,
    extent: GridPolygon,
    overview: Overview,
    detail: Detail,
}

/// Draws a map and writes it.
pub(crate) fn map(source: &Source, output: &Path, wishes: &Wishes, quiet: bool) -> Result<(), Failure> {
    let is_png = match output.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("svg") => false,
        Some("png") => true,
        _ => return Err(format!("{}: a map is written as .svg or .png", output.display()).into()),
    };
    let words = MapWords::of(&wishes.language)?;
    let layers = layers(wishes.layers.as_deref())?;
    let subject = subject(source, quiet)?;
    let town = Town::of(&subject.overview, wishes.without_steps);
    let middle = match &wishes.place {
        Some(name) => Some(town.find(name)?),
        None => wishes.centre,
    };
    let ways = ways(wishes, &town)?;
    let names = written(source, wishes)?;
    let drawn = draw(&Order {
        overview: &subject.overview,
        detail: &subject.detail,
        extent: Some(&subject.extent).filter(|extent| extent.outer.len() > 2),
        title: wishes.title.as_deref().unwrap_or(&subject.name),
        credit: &subject.credit,
        date: wishes.dated.as_deref(),
        paper: wishes.paper,
        denominator: wishes.scale,
        middle,
        up_deg: wishes.turn,
        layers,
        colours: wishes.inks,
        has_index: wishes.index,
        ways: &ways,
        words: &words,
        written: &|name| names.get(name).map_or_else(|| name.to_owned(), String::clone),
        sorted_by: &fold,
    })?;
    match is_png {
        true => file::write_bytes(&to_png(&drawn.drawing, wishes.dpi)?, output)?,
        false => file::write_text(&to_svg(&drawn.drawing), output)?,
    }
    if !quiet {
        if drawn.left_out > 0 {
            eprintln!("{} names of the index have no room: give larger paper", drawn.left_out);
        }
        if !drawn.lacking.is_empty() && is_png {
            let letters: String = drawn.lacking.iter().collect();
            eprintln!("the font lacks these letters, which are left out: {letters}; an SVG has them as text");
        }
    }
    let size = drawn.drawing.size_mm;
    println!("{}: {} × {} mm, 1:{}, {} names", output.display(), size.x, size.y, drawn.denominator, drawn.layout.names.len());
    Ok(())
}

fn layers(asked: Option<&[String]>) -> Result<Layers, Failure> {
    let Some(asked) = asked else { return Ok(Layers::ALL) };
    let mut layers = Layers::NONE;
    for called in asked.iter().map(|called| called.trim()).filter(|called| !called.is_empty()) {
        match layers.of(called) {
            Some(layer) => *layer = true,
            None => return Err(format!("there is no layer `{called}`; there are: {}", Layers::CALLED.join(", ")).into()),
        }
    }
    Ok(layers)
}

fn subject(source: &Source, quiet: bool) -> Result<Subject, Failure> {
    match source.only().filter(|path| path.join(INDEX_NAME).is_file()) {
        Some(city) => {
            let reader = DirReader::new(city)?;
            let index = read_index(&reader)?;
            let overview = read_overview(&reader, &index)?;
            Ok(Subject {
                name: index.name,
                credit: index.attribution,
                extent: index.extent,
                overview,
                // Packets tell of trees and arcades, too much to be read for a map.
                detail: Detail::default(),
            })
        }
        None => {
            let plan = planned(source, None, quiet)?.plan;
            let (overview, detail) = (Overview::of(&plan), Detail::of(&plan));
            Ok(Subject { name: plan.name, credit: plan.attribution, extent: plan.extent, overview, detail })
        }
    }
}

/// What is found in a city by name, and its streets.
struct Town {
    places: Gazetteer,
    streets: Vec<(String, DVec2)>,
    net: StreetNet,
    whole: StreetNet,
}

impl Town {
    fn of(overview: &Overview, without_steps: bool) -> Self {
        let named = overview.streets.iter().filter(|street| !street.name.is_empty());
        let streets = named.filter_map(|street| Some((fold(&street.name), street.line.get(street.line.len() / 2)?.to_metres())));
        let whole = StreetNet::new(&overview.streets).on(&overview.terrain);
        let net = if without_steps { StreetNet::without_steps(&overview.streets) } else { whole.clone() };
        Self { places: Gazetteer::new(&overview.places), streets: streets.collect(), net, whole }
    }

    /// Where to stand at a place, in the middle of a street, or at a position.
    fn find(&self, told: &str) -> Result<DVec2, Failure> {
        if let Ok(plan_pos) = position(told) {
            return Ok(plan_pos);
        }
        let street = || self.streets.iter().find(|(name, _)| *name == fold(told)).map(|(_, pos)| *pos);
        let stand = |place: &Place| place.view.map_or(place.pos, |view| view.pos);
        let found = self.places.find(told).map(stand).or_else(street);
        found.ok_or_else(|| {
            let alike = self.places.suggest(told).iter().map(|name| format!("“{name}”")).collect::<Vec<_>>().join(" or ");
            let hint = if alike.is_empty() { String::new() } else { format!("; is it {alike}?") };
            format!("there is no place or street “{told}”{hint}").into()
        })
    }
}

fn ways(wishes: &Wishes, town: &Town) -> Result<Ways, Failure> {
    let mut ways = Ways::default();
    if let Some([from, to]) = wishes.route.as_deref() {
        ways.led.push(town.net.way(town.find(from)?, town.find(to)?)?);
    }
    if let Some(path) = &wishes.tour {
        let tour: Tour = file::read(path)?;
        let compiled = compile(&tour, &town.whole, &town.places).map_err(|error| format!("{}: {error}", path.display()))?;
        ways.tour = compiled.paths();
    }
    Ok(ways)
}

/// Names in the map's language, as a guide tells them.
fn written(source: &Source, wishes: &Wishes) -> Result<BTreeMap<String, String>, Failure> {
    let beside = || {
        let path = source.only()?;
        let folder = if path.is_dir() { path } else { path.parent()? };
        let mut guides: Vec<PathBuf> = std::fs::read_dir(folder).ok()?.flatten().map(|entry| entry.path()).collect();
        guides.retain(|path| path.to_string_lossy().ends_with(".guide.ron"));
        guides.sort();
        guides.into_iter().next()
    };
    let Some(path) = wishes.guide.clone().or_else(beside) else { return Ok(BTreeMap::new()) };
    let guide: Guide = file::read(&path)?;
    let told = guide.places.iter().map(|place| (place.name.clone(), place.name_in(&wishes.language).to_owned()));
    Ok(told.collect())
}
