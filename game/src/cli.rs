//! The command line.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anstream::eprintln;
use clap::{Parser, Subcommand};
use veduta::city::{Tour, file};

use crate::film::FilmOrder;
use crate::gallery::{GalleryOrder, Sheet};
use crate::hud::TourFiles;
use crate::journal::JournalOrder;
use crate::profile::Profile;
use crate::shot::{At, ShotOrder};
use crate::studio::Size;
use crate::walk::{FirstTour, WalkOrder};
use crate::{Failure, bench, cities, film, gallery, journal, shot, walk};

/// Walk through cities.
#[derive(Parser, Debug)]
#[command(name = "veduta", version)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand, Debug)]
enum Command {
    /// Walk through a city in a window.
    Walk {
        /// City directory, URL, map, graph or scene folder; the sample city if not given. A map is baked first.
        city: Option<String>,
        /// Quality; picked from the graphics adapter if not given.
        #[arg(long)]
        profile: Option<Profile>,
        /// Let façades' levels of detail reach only as far as so many frames a second allow.
        #[arg(long, value_name = "FRAMES", value_parser = clap::value_parser!(u16).range(5..=500))]
        hold_fps: Option<u16>,
        /// Language of the interface; the one that was chosen last, else the system's, if not given.
        #[arg(long, value_name = "CODE", value_parser = ["en", "cs", "it"])]
        language: Option<String>,
        /// Width x height of the window in pixels.
        #[arg(long, default_value = "1280x720")]
        size: Size,
        /// Where stills go that are taken with F12; the folder for pictures if not given.
        #[arg(long, value_name = "DIR")]
        stills: Option<PathBuf>,
        /// Tour to begin with.
        #[arg(long)]
        tour: Option<PathBuf>,
        /// Write down all that streaming does, a line of RON for each event.
        #[arg(long, value_name = "FILE")]
        journal: Option<PathBuf>,
    },
    /// Film a tour without a display, frame by frame.
    Film {
        /// The tour; it names its city.
        tour: PathBuf,
        /// Directory for PNG frames, or a file: .mp4 (needs ffmpeg) or .png (animated, at most 480 pixels wide and 12 frames a
        /// second); out/NAME.mp4 or .png if not given.
        #[arg(long)]
        out: Option<PathBuf>,
        /// Width x height in pixels.
        #[arg(long, default_value = "1280x720")]
        size: Size,
        /// Frames a second.
        #[arg(long, default_value_t = 24, value_parser = clap::value_parser!(u32).range(1..=240))]
        fps: u32,
        /// Quality.
        #[arg(long, default_value = "medium")]
        profile: Profile,
        /// Film only from this second …
        #[arg(long, default_value_t = 0.0, value_parser = seconds)]
        from: f64,
        /// … to this one.
        #[arg(long, value_parser = seconds)]
        to: Option<f64>,
        /// Print one line of JSON for each frame.
        #[arg(long)]
        json: bool,
    },
    /// Take one picture without a display.
    Shot {
        /// City directory, URL, map, graph or scene folder; the sample city if not given.
        city: Option<String>,
        /// Stand and direction: "x,y,eye,heading,pitch" in plan metres and degrees; the city's start if not given.
        #[arg(long, allow_hyphen_values = true)]
        at: Option<At>,
        /// The picture (PNG).
        #[arg(long)]
        out: PathBuf,
        /// Width x height in pixels.
        #[arg(long, default_value = "1280x720")]
        size: Size,
        /// Hour of the day.
        #[arg(long, default_value_t = 10.0, value_parser = |text: &str| within(text, 0.0, 24.0))]
        hour: f64,
        /// Day of the year: the sun's height and the season.
        #[arg(long, default_value_t = 160, value_parser = clap::value_parser!(u16).range(1..=366))]
        day: u16,
        /// How wet the streets are, 0 (dry) to 1 (puddles).
        #[arg(long, default_value_t = 0.0, value_parser = |text: &str| within(text, 0.0, 1.0))]
        wet: f64,
        /// Vertical field of view, degrees.
        #[arg(long, default_value_t = 55.0, value_parser = |text: &str| within(text, 5.0, 150.0))]
        fov: f64,
        /// Quality.
        #[arg(long, default_value = "medium")]
        profile: Profile,
    },
    /// Take the stills of a city's views, and draw contact sheets of its houses at every level of detail and of every style, roof, monument,
    /// crossing and kind of furniture.
    Gallery {
        /// The stands of views and levels: a .views.ron, which names its city; those of the sample city if not given.
        views: Option<PathBuf>,
        /// Where the pictures go.
        #[arg(long)]
        out: PathBuf,
        /// Which sheet; may be given several times; all if not given.
        #[arg(long = "sheet")]
        sheets: Vec<Sheet>,
        /// Only what has this in its name; no sheet is put together then.
        #[arg(long, value_name = "PART")]
        only: Option<String>,
        /// Width x height of one picture in pixels; 1920x1080 of views and 480x400 of all else if not given.
        #[arg(long)]
        size: Option<Size>,
        /// Quality.
        #[arg(long, default_value = "medium")]
        profile: Profile,
    },
    /// Tell what a walk downloaded that was recorded with `walk --journal`: by level, and in each cell on the way.
    Journal {
        /// The journal.
        journal: PathBuf,
        /// Draw it, too: two plots (SVG), over time and by cells.
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
    /// Measure; prints figures as lines of JSON.
    Bench {
        /// What to measure.
        what: bench::Bench,
        /// City directory, map or scene folder; the sample city if not given.
        city: Option<String>,
        /// Print all figures of `stream` as one object of JSON.
        #[arg(long)]
        json: bool,
        /// Width x height of the frames of `frames`.
        #[arg(long, default_value = "640x360")]
        size: Size,
    },
}

/// Walks in the city that is named, else in the tour's, else in the sample with the sample tour on T. Tours, the guide and what lives are those
/// beside the tour, else beside the city.
fn walk(city: Option<&str>, tour: Option<PathBuf>, order: WalkOrder) -> Result<(), Failure> {
    let scene = tour.as_deref().map_or_else(|| cities::scene_of(city), cities::folder_of);
    let first = match (city, tour) {
        (_, Some(path)) => Some(FirstTour { path, at_once: true }),
        (None, None) => Some(FirstTour { path: cities::sample_scene().join("royal_route.tour.ron"), at_once: false }),
        (Some(_), None) => {
            let tours = TourFiles::in_folder(&scene).0.into_iter();
            tours.map(|(path, _)| FirstTour { path, at_once: false }).next()
        }
    };
    let tour_city = new_tours_city(city, &scene, first.as_ref());
    let city = match (city, &first) {
        (None, Some(FirstTour { path, at_once: true })) => cities::of_tour(&file::read::<Tour>(path)?, path)?,
        _ => cities::open(city)?,
    };
    walk::walk(&WalkOrder { city, first, scene, tour_city, ..order })
}

/// What new tours name as their city: the city that was named, beside which they lie; for a folder, what the first of its tours names.
fn new_tours_city(city: Option<&str>, scene: &Path, first: Option<&FirstTour>) -> String {
    let of_first = || first.and_then(|first| file::read::<Tour>(&first.path).ok()).map(|tour| tour.city);
    match city {
        Some(city) if city.contains("://") => city.to_owned(),
        Some(city) if Path::new(city) != scene => Path::new(city).file_name().unwrap_or_default().to_string_lossy().into_owned(),
        _ => of_first().unwrap_or_default(),
    }
}

/// A number within bounds, for a command line.
fn within(text: &str, least: f64, most: f64) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|n: &f64| (least..=most).contains(n));
    number.ok_or_else(|| format!("`{text}` is no number from {least} to {most}"))
}

/// Seconds of a tour.
fn seconds(text: &str) -> Result<f64, String> {
    within(text, 0.0, 86_400.0)
}

/// Runs the program: 0 done, 1 failed with a message, 2 wrong usage.
#[must_use]
pub fn run() -> ExitCode {
    match command(Arguments::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("veduta: {error}");
            ExitCode::FAILURE
        }
    }
}

fn command(command: Option<Command>) -> Result<(), Failure> {
    match command {
        None if walk::has_display() => walk(None, None, WalkOrder::default()),
        None => film::film(&FilmOrder::sample()?),
        Some(Command::Walk { city, profile, hold_fps, language, size, stills, tour, journal }) => {
            if !walk::has_display() {
                return Err("no display to walk on; `veduta film TOUR --out film.mp4` needs none".into());
            }
            walk(
                city.as_deref(),
                tour,
                WalkOrder { profile, hold_fps, language, size: Some(size), stills, journal, ..WalkOrder::default() },
            )
        }
        Some(Command::Film { tour, out, size, fps, profile, from, to, json }) => {
            let out = out.unwrap_or_else(|| film::default_out(&tour));
            film::film(&FilmOrder { tour, out, size, fps, profile, from_s: from, to_s: to, json })
        }
        Some(Command::Shot { city, at, out, size, hour, day, wet, fov, profile }) => {
            let life = Some(cities::life_in(&cities::scene_of(city.as_deref()))?);
            let city = cities::open(city.as_deref())?;
            shot::shot(&ShotOrder { city, at, out, size, hour, day, wet, fov_deg: fov, profile, life })
        }
        Some(Command::Gallery { views, out, sheets, only, size, profile }) => {
            gallery::gallery(&GalleryOrder { out, views, sheets, only, size, profile })
        }
        Some(Command::Journal { journal, out }) => journal::journal(&JournalOrder { journal, out }),
        Some(Command::Bench { what, city, json, size }) => bench::bench(what, city.as_deref(), json, size),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nonsense_is_wrong_usage() {
        for wrong in [
            "film t.ron --from NaN",
            "film t.ron --from -1",
            "film t.ron --to inf",
            "film t.ron --fps 0",
            "film t.ron --size 0x0",
            "shot --out x.png --fov NaN",
            "shot --out x.png --fov 500",
            "shot --out x.png --hour 99",
            "shot --out x.png --day 0",
            "shot --out x.png --day 367",
            "shot --out x.png --at=1e300,0,1.65,0,0",
        ] {
            let words = core::iter::once("veduta").chain(wrong.split(' '));
            assert!(Arguments::try_parse_from(words).is_err(), "{wrong}");
        }
        let right = "veduta shot --out x.png --fov 40 --hour 24 --at -3,5,1.65,0,0";
        assert!(Arguments::try_parse_from(right.split(' ')).is_ok());
    }
}
