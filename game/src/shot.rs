//! `veduta shot`: one picture.

use core::str::FromStr;
use std::path::PathBuf;

use anstream::println;
use bevy::math::DVec2;
use veduta::city::Life;
use veduta::facade::FadeSettings;
use veduta::prelude::*;

use crate::Failure;
use crate::profile::Profile;
use crate::studio::{Size, Studio};

/// Stand and direction: `x,y,eye,heading,pitch`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct At {
    /// Plan metres.
    pub plan_pos: DVec2,
    /// Metres above the ground.
    pub eye_m: f64,
    /// Degrees clockwise from north.
    pub heading_deg: f64,
    /// Degrees, up is positive.
    pub pitch_deg: f64,
}

impl FromStr for At {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Option<Vec<f64>> =
            text.split(',').map(|part| part.trim().parse().ok().filter(|n: &f64| n.is_finite())).collect();
        match numbers.as_deref() {
            Some(&[x, y, eye_m, heading_deg, pitch_deg]) if x.abs().max(y.abs()) < 2e6 && (0.0..1e4).contains(&eye_m) => {
                Ok(Self { plan_pos: DVec2::new(x, y), eye_m, heading_deg, pitch_deg })
            }
            _ => Err(format!(
                "`{text}` is no stand: write \"x,y,eye,heading,pitch\", five numbers in metres and degrees, as in \"12,-40,1.65,270,5\""
            )),
        }
    }
}

/// What picture to take.
#[derive(Debug, Clone)]
pub struct ShotOrder {
    /// City directory or URL.
    pub city: String,
    /// From where; the city's start if not given.
    pub at: Option<At>,
    /// The picture's file (PNG).
    pub out: PathBuf,
    /// Its size.
    pub size: Size,
    /// Hour of the day.
    pub hour: f64,
    /// Day of the year, 1 to 366.
    pub day: u16,
    /// How wet the streets are, 0 to 1.
    pub wet: f64,
    /// Vertical field of view, degrees.
    pub fov_deg: f64,
    /// Quality.
    pub profile: Profile,
    /// What lives in the city; `None` for nothing.
    pub life: Option<Life>,
}

/// A picture, and what drew it.
#[derive(Debug, Clone)]
pub struct Picture {
    /// The picture.
    pub image: image::RgbaImage,
    /// Name of the renderer.
    pub renderer: String,
    /// Whether the processor drew it.
    pub is_software: bool,
}

/// Takes a picture and writes it.
///
/// # Errors
/// As [`picture`], or if the file cannot be written.
pub fn shot(order: &ShotOrder) -> Result<(), Failure> {
    if order.out.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("png")) {
        return Err(format!("{}: stills are written as .png", order.out.display()).into());
    }
    picture(order)?.image.save(&order.out).map_err(|e| format!("{}: {e}", order.out.display()))?;
    println!("{}", order.out.display());
    Ok(())
}

/// Takes a picture.
///
/// # Errors
/// If the city does not open or something in sight does not stand.
pub fn picture(order: &ShotOrder) -> Result<Picture, Failure> {
    let mut studio = Studio::open(&order.city, order.size, order.profile)?;
    let eye = match order.at {
        Some(At { plan_pos, eye_m, heading_deg, pitch_deg }) => Eye { plan_pos, eye_m, heading_deg, pitch_deg, ..Eye::default() },
        None => Eye::at(studio.world().resource::<City>().start),
    };
    studio.set_eye(Eye { fov_deg: order.fov_deg, ..eye });
    let mut clock = studio.world().resource_mut::<CityClock>();
    (clock.hour, clock.day) = (order.hour, order.day);
    studio.world().resource_mut::<Weather>().wet = order.wet as f32;
    // A picture has no before: levels stand at once.
    studio.world().resource_mut::<FadeSettings>().seconds = 0.0;
    studio.advance(core::time::Duration::ZERO);
    if let Some(life) = &order.life {
        studio.enliven(life.clone(), order.profile);
    }
    let missing = studio.settle();
    if !missing.is_empty() {
        return Err(format!("{}: {missing} are in sight but could not be loaded", order.city).into());
    }
    studio.warm_up();
    let image = studio.shoot()?;
    let (renderer, is_software) = studio.renderer();
    Ok(Picture { image, renderer, is_software })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stand_is_five_numbers() {
        let at: At = "12, -40.5,1.65,270,5".parse().expect("five numbers");
        assert_eq!((at.plan_pos.y, at.heading_deg), (-40.5, 270.0));
        for wrong in ["1,2,3,4", "1,2,3,4,x", "1,2,3,4,NaN", ""] {
            assert!(wrong.parse::<At>().is_err(), "{wrong}");
        }
    }
}
