//! `veduta gallery`: stills of a city from fixed stands, houses at every level of detail, and contact sheets of all that growth can build,
//! each specimen by itself.

mod specimens;
mod views;

use std::path::{Path, PathBuf};

use anstream::println;
use bevy::math::DVec2;
use clap::ValueEnum;
use image::{RgbaImage, imageops};
use indicatif::ProgressBar;
use veduta::facade::FadeSettings;
use veduta::prelude::*;
use veduta_bake::Stock;
use veduta_city::{FurnitureRule, GraphOverrides, file};

use crate::profile::Profile;
use crate::studio::{Size, Studio};
use crate::{Failure, cities};

pub use specimens::specimens;

/// What a contact sheet shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Sheet {
    /// The stills of a city's views.
    Views,
    /// Houses of a city at every level of detail.
    Levels,
    /// A street of every style.
    Styles,
    /// Every shape of roof, on plain and on odd footprints.
    Roofs,
    /// Every monument, and what they are put together from.
    Monuments,
    /// Crossings of three to eight arms.
    Crossings,
    /// Lamps, benches, trees and whatever else stands in streets.
    Furniture,
}

impl Sheet {
    /// Those of specimens.
    pub const SPECIMENS: [Self; 5] = [Self::Styles, Self::Roofs, Self::Monuments, Self::Crossings, Self::Furniture];
}

/// A thing to be looked at, and from where.
#[derive(Debug, Clone, PartialEq)]
pub struct Specimen {
    /// Name of its picture.
    pub name: String,
    /// Plan metres.
    pub plan_pos: DVec2,
    /// Metres above the ground.
    pub eye_m: f64,
    /// Degrees clockwise from north.
    pub heading_deg: f64,
    /// Degrees, up is positive.
    pub pitch_deg: f64,
}

/// What to show, and how.
#[derive(Debug, Clone)]
pub struct GalleryOrder {
    /// Where the pictures go: SHEET.png and SHEET/NAME.png.
    pub out: PathBuf,
    /// The stands of views and levels: a `.views.ron`; those of the sample city if not given.
    pub views: Option<PathBuf>,
    /// Which sheets; all if none is named.
    pub sheets: Vec<Sheet>,
    /// Only specimens with this in their names.
    pub only: Option<String>,
    /// Size of one picture; 1920x1080 of views and 480x400 of all else if not given.
    pub size: Option<Size>,
    /// Quality.
    pub profile: Profile,
}

/// Size of a specimen's picture where none is given.
const SPECIMEN: Size = Size { width: 480, height: 400 };
/// Pictures side by side on a sheet.
const COLUMNS: u32 = 5;
/// Pixels between them.
const GAP: u32 = 6;

/// Takes the pictures and puts them on sheets.
///
/// # Errors
/// If a specimen cannot be grown or drawn, or a file not be written.
pub fn gallery(order: &GalleryOrder) -> Result<(), Failure> {
    let sheets = if order.sheets.is_empty() { Sheet::value_variants() } else { &order.sheets };
    let stands = order.views.clone().unwrap_or_else(|| cities::sample_scene().join("old_prague.views.ron"));
    for &sheet in sheets {
        match sheet {
            Sheet::Views => views::stills(&views::read(&stands)?, &stands, order)?,
            Sheet::Levels => views::levels(&views::read(&stands)?, &stands, order)?,
            specimens => sheet_of(specimens, order)?,
        }
    }
    Ok(())
}

/// The contact sheet of specimens.
fn sheet_of(sheet: Sheet, order: &GalleryOrder) -> Result<(), Failure> {
    let size = order.size.unwrap_or(SPECIMEN);
    let name = sheet.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned());
    let (graph, mut specimens) = specimens(sheet)?;
    specimens.retain(|specimen| order.only.as_ref().is_none_or(|part| specimen.name.contains(part.as_str())));
    let folder = order.out.join(&name);
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let path = order.out.join(format!("{name}.graph.ron"));
    file::write(&graph, &path)?;
    file::write(&bare(sheet), &order.out.join(format!("{name}.graph.overrides.ron")))?;
    let pictures = take(&path, &specimens, &folder, size, order)?;
    if order.only.is_none() {
        let whole = order.out.join(format!("{name}.png"));
        save(&contact_sheet(&pictures, size), &whole)?;
        println!("{}: {} pictures", whole.display(), pictures.len());
    }
    Ok(())
}

/// Nothing stands in the way of a specimen; crossings have their lights and signs.
fn bare(sheet: Sheet) -> GraphOverrides {
    let rules = Stock::new().furniture.into_iter().filter(|_| sheet != Sheet::Crossings);
    let furniture = rules.map(|rule| FurnitureRule { put: Vec::new(), ..rule }).collect();
    GraphOverrides { furniture, ..GraphOverrides::default() }
}

fn take(graph: &Path, specimens: &[Specimen], folder: &Path, size: Size, order: &GalleryOrder) -> Result<Vec<RgbaImage>, Failure> {
    let city = cities::open(Some(&graph.display().to_string()))?;
    let mut studio = Studio::open(&city, size, order.profile)?;
    studio.world().resource_mut::<CityClock>().hour = 10.0;
    studio.world().resource_mut::<FadeSettings>().seconds = 0.0;
    let bar = ProgressBar::new(specimens.len() as u64);
    let mut pictures = Vec::with_capacity(specimens.len());
    for specimen in specimens {
        let Specimen { plan_pos, eye_m, heading_deg, pitch_deg, .. } = *specimen;
        studio.set_eye(Eye { plan_pos, eye_m, heading_deg, pitch_deg, fov_deg: 40.0, ..Eye::default() });
        studio.advance(core::time::Duration::ZERO);
        let missing = studio.settle();
        if !missing.is_empty() {
            return Err(format!("{}: {missing} are in sight but could not be loaded", specimen.name).into());
        }
        if pictures.is_empty() {
            studio.warm_up();
        }
        let picture = studio.shoot()?;
        save(&picture, &folder.join(format!("{}.png", specimen.name)))?;
        pictures.push(picture);
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(pictures)
}

fn save(picture: &RgbaImage, path: &Path) -> Result<(), Failure> {
    picture.save(path).map_err(|e| format!("{}: {e}", path.display()).into())
}

fn contact_sheet(pictures: &[RgbaImage], size: Size) -> RgbaImage {
    let rows = (pictures.len() as u32).div_ceil(COLUMNS).max(1);
    let (width, height) = (size.width + GAP, size.height + GAP);
    let mut sheet = RgbaImage::from_pixel(COLUMNS * width + GAP, rows * height + GAP, image::Rgba([44, 44, 46, 255]));
    for (i, picture) in (0..).zip(pictures) {
        let (column, row): (u32, u32) = (i % COLUMNS, i / COLUMNS);
        imageops::replace(&mut sheet, picture, (GAP + column * width).into(), (GAP + row * height).into());
    }
    sheet
}
