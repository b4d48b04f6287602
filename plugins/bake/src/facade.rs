//! Façades given as pictures, from the files that overrides name.

use std::path::{Path, PathBuf};

use glam::DVec2;
use rayon::prelude::*;
use veduta_city::{FacadeDraft, FacadeFile, GraphOverrides, GridPos, PictureFile, PlacedFacade, file};
use veduta_survey::raster::{Picture, PictureLimits};
use veduta_texture::{CutFacade, MOST_FLATS_BYTES, PICTURE_SIDE, PICTURE_STORED_CAP, Pixels, cut_facade, keep_flats};

use crate::BakeError;
use crate::scene::{Astray, below};

/// What a façade's picture may take: 8,192 pixels a side.
const LIMITS: PictureLimits = PictureLimits { side_px: 8_192, bytes: 1 << 30 };

/// The façades that overrides name, cut. `path`: of the overrides.
///
/// # Errors
/// Everything that is wrong with any of them.
pub fn read_facades(overrides: &GraphOverrides, path: &Path) -> Result<Vec<PlacedFacade>, Vec<BakeError>> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let read = |FacadeFile { file, at }: &FacadeFile| {
        let path = below(folder, file).map_err(|astray| fault(&folder.join(file), &astray.to_string()))?;
        read_facade(&path, *at)
    };
    let read: Vec<Result<PlacedFacade, BakeError>> = overrides.facades.par_iter().map(read).collect();
    let (mut facades, mut errors) = (Vec::new(), Vec::new());
    for facade in read {
        match facade {
            Ok(facade) => facades.push(facade),
            Err(error) => errors.push(error),
        }
    }
    if errors.is_empty() { Ok(facades) } else { Err(errors) }
}

/// A façade of a file, cut, for a place.
///
/// # Errors
/// If the file or its picture cannot be read, or the one does not cut the other.
pub fn read_facade(path: &Path, at: DVec2) -> Result<PlacedFacade, BakeError> {
    let draft: FacadeDraft = file::read(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let told = |astray: Astray| fault(path, &format!("the picture {:?}: {astray}", draft.picture));
    let picture = below(folder, &draft.picture).map_err(told)?;
    let bytes = std::fs::read(&picture).map_err(|source| BakeError::Read { path: picture.clone(), source })?;
    let name = picture.display().to_string();
    let Picture { width, pixels, .. } = Picture::decode(&bytes, &name, &LIMITS).map_err(|error| fault(path, &error.to_string()))?;
    let pixels = Pixels::of_rgb(width, &pixels).ok_or_else(|| fault(&picture, "it has no pixels"))?;
    let CutFacade { painted, pictures } = cut_facade(&draft, &pixels).map_err(|error| fault(path, &error.to_string()))?;
    let pictures = encode(&pictures, SECTION_BYTES * usize::from(painted.sections));
    let pictures = pictures.ok_or_else(|| fault(path, "its pictures do not become small enough at any quality"))?;
    Ok(PlacedFacade { name: draft.name.clone(), at, eaves: GridPos::steps(draft.eaves_m()), painted, pictures })
}

/// Efforts of the encoder, of 0 to 6.
const QUICK: i32 = 3;
const THOROUGH: i32 = 6;

/// The encoder's coarsest and finest quality, in quarters.
const COARSEST: u16 = 4;
const FINEST: u16 = 400;
/// No more quarters than this are gained by effort.
const GAIN: u16 = 40;

/// Most bytes of all pictures of a façade for each of its sections.
const SECTION_BYTES: usize = 20_000;

/// Pictures as they travel, as fine as so many bytes allow. `None` if even the coarsest are more.
fn encode(pictures: &[Pixels], most_bytes: usize) -> Option<Vec<PictureFile>> {
    let most_bytes = most_bytes.checked_sub(pictures.len() * MOST_FLATS_BYTES)?;
    let stored = |quarters: u16, effort: i32| -> Option<Vec<Vec<u8>>> {
        let mut config = webp::WebPConfig::new().ok()?;
        config.quality = f32::from(quarters) / 4.0;
        config.method = effort;
        config.use_sharp_yuv = 1;
        let encode = |picture: &Pixels| {
            let (bytes, side) = (picture.bytes(), PICTURE_SIDE as u32);
            let stored = webp::Encoder::from_rgb(&bytes, side, side).encode_advanced(&config).ok()?;
            (stored.len() + MOST_FLATS_BYTES <= PICTURE_STORED_CAP).then(|| stored.to_vec())
        };
        let files: Vec<Vec<u8>> = pictures.iter().map(encode).collect::<Option<_>>()?;
        (files.iter().map(Vec::len).sum::<usize>() <= most_bytes).then_some(files)
    };
    // The finest that fits, from one that does to one that may not.
    let sought = |(mut best, mut low): (Vec<Vec<u8>>, u16), mut high: u16, effort: i32| {
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            match stored(middle, effort) {
                Some(files) => (best, low) = (files, middle),
                None => high = middle,
            }
        }
        (best, low)
    };
    // With more effort a little finer ones fit, too.
    let coarsest = (stored(COARSEST, QUICK)?, COARSEST);
    let (quick, quarters) = sought(coarsest, FINEST + 1, QUICK);
    let (files, _) = sought((quick, quarters.saturating_sub(1)), (quarters + GAIN).min(FINEST + 1), THOROUGH);
    files.into_iter().zip(pictures).map(|(file, picture)| keep_flats(file, picture).ok().map(PictureFile)).collect()
}

/// Files that overrides name: of models, façades and their pictures, as far as they are there. `path`: of the overrides.
#[must_use]
pub fn files_of_overrides(overrides: &GraphOverrides, path: &Path) -> Vec<PathBuf> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let named = overrides.models.iter().map(|model| &model.file).chain(overrides.facades.iter().map(|facade| &facade.file));
    let mut files: Vec<PathBuf> = named.filter_map(|name| below(folder, name).ok()).collect();
    let pictures = files.iter().filter_map(|file| {
        let draft: FacadeDraft = file::read(file).ok()?;
        below(file.parent().unwrap_or(Path::new("")), &draft.picture).ok()
    });
    let pictures: Vec<PathBuf> = pictures.collect();
    files.extend(pictures);
    files.retain(|file| file.is_file());
    files
}

fn fault(path: &Path, reason: &str) -> BakeError {
    BakeError::Facade { path: path.to_owned(), reason: reason.to_owned() }
}
