//! `veduta film`: a tour, frame by frame.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anstream::{eprintln, println};
use indicatif::{ProgressBar, ProgressStyle};
use veduta::city::{Tour, file};
use veduta::facade::FadeSettings;
use veduta::prelude::*;
use veduta::sound::OpenSounds;

use crate::encode::Encoder;
use crate::profile::Profile;
use crate::soundtrack::TrackFile;
use crate::studio::{Size, Studio};
use crate::{Failure, cities, encode};

/// How often progress is told where there is no terminal.
const TELL_EVERY: Duration = Duration::from_secs(20);

/// What film to make.
#[derive(Debug, Clone)]
pub struct FilmOrder {
    /// The tour's file.
    pub tour: PathBuf,
    /// Directory, `.mp4` or `.png`.
    pub out: PathBuf,
    /// Size of a frame.
    pub size: Size,
    /// Frames a second.
    pub fps: u32,
    /// Quality.
    pub profile: Profile,
    /// First second of the tour.
    pub from_s: f64,
    /// Last second; the tour's end if not given.
    pub to_s: Option<f64>,
    /// Whether to print one line of JSON for each frame.
    pub json: bool,
}

impl FilmOrder {
    /// The sample tour, small enough for a software renderer.
    ///
    /// # Errors
    /// If the sample tour is not there.
    pub fn sample() -> Result<Self, Failure> {
        let tour = cities::sample_scene().join("royal_route.tour.ron");
        if !tour.is_file() {
            return Err(format!("{}: the sample tour is not there; run from the project's folder", tour.display()).into());
        }
        let size = Size { width: 480, height: 270 };
        Ok(Self { out: default_out(&tour), tour, size, fps: 12, profile: Profile::Medium, from_s: 0.0, to_s: None, json: false })
    }
}

/// `out/NAME.mp4` for a tour `NAME.tour.ron`; a directory of frames' film is asked for by `--out`.
#[must_use]
pub fn default_out(tour: &Path) -> PathBuf {
    let name = tour.file_name().unwrap_or_default().to_string_lossy().replace(".tour.ron", "");
    Path::new("out").join(format!("{name}.{}", if encode::has_ffmpeg() { "mp4" } else { "png" }))
}

/// Films a tour and says where the film is.
///
/// # Errors
/// If the tour has mistakes, its city does not open, a frame misses cells, or the film cannot be written.
pub fn film(order: &FilmOrder) -> Result<(), Failure> {
    let tour: Tour = file::read(&order.tour)?;
    let city = cities::of_tour(&tour, &order.tour)?;
    if let Some(parent) = order.out.parent().filter(|p| !p.as_os_str().is_empty()) {
        std::fs::create_dir_all(parent).map_err(|e| format!("{}: {e}", parent.display()))?;
    }
    let folder = cities::folder_of(&order.tour);
    let life = cities::life_in(&folder)?;
    let mut studio = Studio::open_with_sound(&city, order.size, order.profile, &folder)?;
    studio.enliven(life, order.profile);
    if let Some(sounds) = cities::file_in(&folder, ".sound.ron") {
        studio.world().write_message(OpenSounds(format!("tours://{sounds}")));
    }
    let duration_s = begin(&mut studio, order)?;
    let to_s = order.to_s.unwrap_or(duration_s).min(duration_s);
    if !(order.from_s >= 0.0 && order.from_s < to_s) {
        let (tour, from_s) = (order.tour.display(), order.from_s);
        return Err(format!("{tour}: nothing to film from second {from_s} to {to_s}; the tour is {duration_s:.1} s long").into());
    }
    let frames = ((to_s - order.from_s) * f64::from(order.fps)).floor().max(1.0) as u32;
    let mut encoder = Encoder::open(&order.out, order.size, order.fps, frames)?;
    let mut track = TrackFile::beside(&order.out)?;
    let bar = if order.json { ProgressBar::hidden() } else { ProgressBar::new(u64::from(frames)) };
    if let Ok(style) = ProgressStyle::with_template("filming {bar:32} {pos}/{len} frames, {eta} to go; {msg}") {
        bar.set_style(style);
    }
    let step = Duration::from_secs_f64(1.0 / f64::from(order.fps.max(1)));
    let (mut holes, mut told) = (0, Instant::now());
    for n in 0..frames {
        if n > 0 {
            studio.advance(step);
            track.add(&studio.heard())?;
        }
        let missing = studio.settle();
        if !missing.is_empty() {
            holes += 1;
            eprintln!("frame {n}: missing {missing}");
        }
        encoder.add(n, &studio.shoot()?)?;
        bar.inc(1);
        // Where no bar can be drawn, a line now and then tells that it goes on.
        if bar.is_hidden() && told.elapsed() > TELL_EVERY {
            told = Instant::now();
            eprintln!("filming: {} of {frames} frames, {holes} with missing cells", n + 1);
        }
        bar.set_message(format!("{holes} frames with missing cells"));
        if order.json {
            let eye = studio.eye();
            println!(
                "{}",
                serde_json::json!({ "frame": n, "missing": missing.cells, "x": eye.plan_pos.x, "y": eye.plan_pos.y, "eye_m": eye.eye_m,
                    "heading_deg": eye.heading_deg, "pitch_deg": eye.pitch_deg, "fade": eye.fade })
            );
        }
    }
    bar.finish_and_clear();
    // As long as the last frame is shown.
    studio.advance(step);
    track.add(&studio.heard())?;
    let path = encoder.finish()?;
    if let Some(track) = track.finish(&path)? {
        println!("{}: its sound", track.display());
    }
    println!("{}: {frames} frames, {holes} with missing cells", path.display());
    if holes == 0 { Ok(()) } else { Err(format!("{holes} of {frames} frames miss cells").into()) }
}

/// Starts the tour, stands at its first moment, and warms up there. Gives its length in seconds.
fn begin(studio: &mut Studio, order: &FilmOrder) -> Result<f64, Failure> {
    // The first picture has no before: its levels stand at once. Those that come into sight later fade in.
    let fading = core::mem::replace(&mut studio.world().resource_mut::<FadeSettings>().seconds, 0.0);
    let name = order.tour.file_name().unwrap_or_default().to_string_lossy();
    studio.world().write_message(TourCommand::Open(format!("tours://{name}")));
    studio.advance(Duration::ZERO);
    studio.await_tour();
    let player = studio.world().resource::<TourPlayer>();
    let Some(duration_s) = player.tour().map(|t| t.duration_s()) else {
        let why = player.error().unwrap_or("the tour did not start");
        return Err(format!("{}: {why}", order.tour.display()).into());
    };
    if order.from_s > 0.0 {
        studio.world().write_message(TourCommand::Seek(order.from_s));
    }
    studio.advance(Duration::ZERO);
    studio.settle();
    studio.warm_up();
    // What was heard of the first look about is not of the film.
    studio.heard();
    studio.world().resource_mut::<FadeSettings>().seconds = fading;
    Ok(duration_s)
}
