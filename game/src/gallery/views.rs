use std::path::{Path, PathBuf};

use anstream::println;
use image::RgbaImage;
use indicatif::ProgressBar;
use veduta::buildings::BuildSettings;
use veduta::facade::FadeSettings;
use veduta::prelude::*;
use veduta_city::{Still, Viewpoint, Views, file};

use super::{COLUMNS, GalleryOrder, contact_sheet, save};
use crate::studio::{Size, Studio};
use crate::{Failure, cities};

/// Size of a still where none is given.
const STILL: Size = Size { width: 1920, height: 1080 };
/// Size of a picture of a house.
const HOUSE: Size = Size { width: 480, height: 400 };
/// Its vertical field of view: all of a front from across the street.
const HOUSE_FOV_DEG: f64 = 72.0;
/// Farther than any façade from who stands before it, metres.
const ALL_M: f32 = 1_000.0;
/// How far walls stand in relief, metres: farther than those of one street.
const RELIEF_M: f32 = 60.0;

/// Reads the views of a city.
///
/// # Errors
/// If the file cannot be read or is not right.
pub(super) fn read(path: &Path) -> Result<Views, Failure> {
    let views: Views = file::read(path)?;
    let wrong = views.validate();
    if wrong.is_empty() { Ok(views) } else { Err(format!("{}: {}", path.display(), wrong.join("; ")).into()) }
}

/// Takes the stills: `OUT/views/NAME.png`.
pub(super) fn stills(views: &Views, path: &Path, order: &GalleryOrder) -> Result<(), Failure> {
    let is_asked = |still: &&Still| order.only.as_ref().is_none_or(|part| still.name.contains(part.as_str()));
    let stills: Vec<&Still> = views.stills.iter().filter(is_asked).collect();
    let folder = folder(order, "views")?;
    let mut studio = studio(views, path, order.size.unwrap_or(STILL), order)?;
    let bar = ProgressBar::new(stills.len() as u64);
    for still in stills {
        let mut clock = studio.world().resource_mut::<CityClock>();
        (clock.hour, clock.day) = (still.hour, still.day);
        studio.world().resource_mut::<Weather>().wet = still.wet as f32;
        let picture = take(&mut studio, &still.name, still.at, still.fov_deg)?;
        save(&picture, &folder.join(format!("{}.png", still.name)))?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    println!("{}", folder.display());
    Ok(())
}

/// Takes pictures of houses with the levels up to each: a column for each house, and a row for each level.
pub(super) fn levels(views: &Views, path: &Path, order: &GalleryOrder) -> Result<(), Failure> {
    let folder = folder(order, "levels")?;
    let size = order.size.unwrap_or(HOUSE);
    let mut studio = studio(views, path, size, order)?;
    // Whatever the profile builds, all levels are to be seen.
    studio.world().resource_mut::<BuildSettings>().relief_m = f64::from(RELIEF_M);
    let bar = ProgressBar::new(4 * views.houses.len() as u64);
    let mut pictures: Vec<Vec<RgbaImage>> = vec![Vec::new(); 4];
    for (house, &at) in views.houses.iter().enumerate() {
        for (finer, row) in pictures.iter_mut().enumerate() {
            let far = core::array::from_fn(|level| if level < finer { ALL_M } else { 0.0 });
            *studio.world().resource_mut::<LevelDistances>() = LevelDistances { near: far.map(|f| f * 0.75), far };
            let name = format!("{:02}_level_{}", house + 1, finer + 1);
            if order.only.as_ref().is_some_and(|part| !name.contains(part.as_str())) {
                continue;
            }
            let picture = take(&mut studio, &name, at, HOUSE_FOV_DEG)?;
            save(&picture, &folder.join(format!("{name}.png")))?;
            row.push(picture);
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    if order.only.is_some() {
        return Ok(());
    }
    let whole = order.out.join("levels.png");
    // As many houses side by side as a sheet has columns, their levels above one another.
    let columns = COLUMNS as usize;
    let bands = (0..views.houses.len()).step_by(columns);
    let mut sheet = Vec::new();
    for band in bands {
        for row in &pictures {
            let empty = || RgbaImage::new(size.width, size.height);
            sheet.extend((band..band + columns).map(|i| row.get(i).cloned().unwrap_or_else(empty)));
        }
    }
    save(&contact_sheet(&sheet, size), &whole)?;
    println!("{}: {} houses", whole.display(), views.houses.len());
    Ok(())
}

fn folder(order: &GalleryOrder, name: &str) -> Result<PathBuf, Failure> {
    let folder = order.out.join(name);
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    Ok(folder)
}

fn studio(views: &Views, path: &Path, size: Size, order: &GalleryOrder) -> Result<Studio, Failure> {
    let city = cities::named(&views.city, path)?;
    let mut studio = Studio::open(&city, size, order.profile)?;
    studio.world().resource_mut::<FadeSettings>().seconds = 0.0;
    Ok(studio)
}

fn take(studio: &mut Studio, name: &str, at: Viewpoint, fov_deg: f64) -> Result<RgbaImage, Failure> {
    studio.set_eye(Eye { fov_deg, ..Eye::at(at) });
    studio.advance(core::time::Duration::ZERO);
    let missing = studio.settle();
    if !missing.is_empty() {
        return Err(format!("{name}: {missing} are in sight but could not be loaded").into());
    }
    studio.warm_up();
    studio.shoot()
}
