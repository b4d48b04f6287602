//! The command line.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::film::FilmOrder;
use crate::profile::Profile;
use crate::shot::{At, ShotOrder};
use crate::studio::Size;
use crate::{Failure, bench, cities, film, shot, walk};

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
        /// Tour to begin with.
        #[arg(long)]
        tour: Option<PathBuf>,
    },
    /// Film a tour without a display, frame by frame.
    Film {
        /// The tour; it names its city.
        tour: PathBuf,
        /// Directory for PNG frames, or a file: .mp4 (needs ffmpeg) or .png (animated).
        #[arg(long)]
        out: Option<PathBuf>,
        /// Width x height in pixels.
        #[arg(long, default_value = "1280x720")]
        size: Size,
        /// Frames a second.
        #[arg(long, default_value_t = 24)]
        fps: u32,
        /// Quality.
        #[arg(long, default_value = "medium")]
        profile: Profile,
        /// Film only from this second …
        #[arg(long, default_value_t = 0.0)]
        from: f64,
        /// … to this one.
        #[arg(long)]
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
        #[arg(long, default_value_t = 10.0)]
        hour: f64,
        /// Vertical field of view, degrees.
        #[arg(long, default_value_t = 55.0)]
        fov: f64,
        /// Quality.
        #[arg(long, default_value = "medium")]
        profile: Profile,
    },
    /// Measure; prints figures as lines of JSON.
    Bench {
        /// What to measure.
        what: bench::Bench,
        /// City directory, map or scene folder; the sample city if not given.
        city: Option<String>,
    },
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
        None if walk::has_display() => walk::walk(&cities::open(None)?, None, None),
        None => film::film(&FilmOrder::sample()?),
        Some(Command::Walk { city, profile, tour }) => {
            if !walk::has_display() {
                return Err("no display to walk on; `veduta film TOUR --out film.mp4` needs none".into());
            }
            walk::walk(&cities::open(city.as_deref())?, profile, tour.as_deref())
        }
        Some(Command::Film { tour, out, size, fps, profile, from, to, json }) => {
            let out = out.unwrap_or_else(|| film::default_out(&tour));
            film::film(&FilmOrder { tour, out, size, fps, profile, from_s: from, to_s: to, json })
        }
        Some(Command::Shot { city, at, out, size, hour, fov, profile }) => {
            shot::shot(&ShotOrder { city: cities::open(city.as_deref())?, at, out, size, hour, fov_deg: fov, profile })
        }
        Some(Command::Bench { what, city }) => bench::bench(what, city.as_deref()),
    }
}
