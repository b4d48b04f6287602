//! `veduta bench frames`: how fast each profile draws on the adapter at hand.

use std::path::Path;
use std::time::{Duration, Instant};

use anstream::eprintln;
use veduta::city::{Tour, file};
use veduta::prelude::*;
use veduta_bake::{BakeSettings, bake};

use super::{line, workplace};
use crate::profile::Profile;
use crate::studio::{Size, Studio};
use crate::{Failure, cities};

/// Drawn at least, and as many more as a fast adapter draws within so many seconds, from this moment of the tour on, in such steps.
const FRAMES: u32 = 60;
const MOST_FRAMES: u32 = 600;
const LEAST_S: f64 = 5.0;
const FROM_S: f64 = 4.0;
const STEP: Duration = Duration::from_millis(100);

/// Measures and prints.
///
/// # Errors
/// If the city cannot be baked or there is nothing to draw with.
pub(super) fn frames(scene: &Path, size: Size) -> Result<(), Failure> {
    let dir = workplace("frames")?;
    let city = dir.join("sample.city");
    bake(scene, &city, &BakeSettings::default(), &mut |_| ())?;
    let tour: Tour = file::read(&cities::sample_scene().join("royal_route.tour.ron"))?;
    for profile in [Profile::Low, Profile::Medium, Profile::High, Profile::Ultra] {
        let mut studio = Studio::open(&city.display().to_string(), size, profile)?;
        if profile == Profile::Low {
            eprintln!("{}, {}x{}", studio.renderer().0, size.width, size.height);
        }
        studio.world().write_message(TourCommand::Give(Box::new(tour.clone())));
        studio.advance(Duration::ZERO);
        studio.await_tour();
        studio.world().write_message(TourCommand::Seek(FROM_S));
        studio.advance(Duration::ZERO);
        let missing = studio.settle();
        if !missing.is_empty() {
            return Err(format!("{}: not all of the city came: {missing}", city.display()).into());
        }
        studio.warm_up();
        // A picture waits for all that was drawn before.
        studio.shoot()?;
        let began = Instant::now();
        let mut frames = 0;
        while frames < FRAMES || frames < MOST_FRAMES && began.elapsed().as_secs_f64() < LEAST_S {
            studio.walk(STEP);
            frames += 1;
        }
        studio.shoot()?;
        let a_frame = began.elapsed().as_secs_f64() / f64::from(frames + 1);
        line(&format!("{}_frames_a_second", format!("{profile:?}").to_lowercase()), 1.0 / a_frame, "1/s");
    }
    std::fs::remove_dir_all(&dir)?;
    Ok(())
}
