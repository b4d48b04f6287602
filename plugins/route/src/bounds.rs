//! Between which bounds a tour's numbers lie, and where in it they stand.

use veduta_city::{LookAt, Step, Tour, Where};

use crate::{Range, StepProblem, error::LONGEST_TOUR_S};

/// Furthest coordinate of a tour, in metres: the plan's grid ends there.
pub(crate) const FURTHEST_M: f64 = 2_097_000.0;

/// What a number is, with its unit, and between what it must lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// What the number is, with its unit.
    pub what: &'static str,
    /// Least that it may be.
    pub least: f64,
    /// Most that it may be.
    pub most: f64,
}

const fn bounds(what: &'static str, least: f64, most: f64) -> Bounds {
    Bounds { what, least, most }
}

pub(crate) const WALK_SPEED: Bounds = bounds("the speed in metres a second", 0.1, 10.0);
pub(crate) const FLIGHT_SPEED: Bounds = bounds("the speed in metres a second", 0.1, 200.0);
pub(crate) const EYE: Bounds = bounds("the eye height in metres", 0.2, 2000.0);
pub(crate) const FOV: Bounds = bounds("the field of view in degrees", 5.0, 140.0);
pub(crate) const HOUR: Bounds = bounds("the hour", 0.0, 24.0);
pub(crate) const DAY: Bounds = bounds("the day of the year", 1.0, 366.0);
pub(crate) const WET: Bounds = bounds("the wetness", 0.0, 1.0);
pub(crate) const SECONDS: Bounds = bounds("the time in seconds", 0.0, LONGEST_TOUR_S);
pub(crate) const TURN_SECONDS: Bounds = bounds("the time in seconds", 0.0, 3600.0);
pub(crate) const FADE_SECONDS: Bounds = bounds("the fade's length in seconds", 0.0, 60.0);
pub(crate) const KEY_SECONDS: Bounds = bounds("a key's time in seconds", 0.0, LONGEST_TOUR_S);
pub(crate) const COORDINATE: Bounds = bounds("a coordinate in metres", -FURTHEST_M, FURTHEST_M);
pub(crate) const HEIGHT: Bounds = bounds("a height in metres", 0.2, 5000.0);
pub(crate) const SPOT_HEIGHT: Bounds = bounds("the spot's height in metres", -500.0, 5000.0);
pub(crate) const HEADING: Bounds = bounds("the heading in degrees", -36_000.0, 36_000.0);
pub(crate) const PITCH: Bounds = bounds("the pitch in degrees", -90.0, 90.0);

impl Bounds {
    /// A number that lies between them.
    ///
    /// # Errors
    /// [`Range`] if it does not.
    pub fn range(self, value: f64) -> Result<f64, Range> {
        let Self { what, least, most } = self;
        // False also for what is not a number.
        if (least..=most).contains(&value) { Ok(value) } else { Err(Range { what, value, least, most }) }
    }

    pub(crate) fn check(self, value: f64) -> Result<f64, StepProblem> {
        self.range(value).map_err(StepProblem::Range)
    }

    /// A number that lies between them and does no harm to what comes after.
    pub(crate) const fn harmless(self) -> f64 {
        const AS_ONE_WALKS: f64 = 1.65;
        if self.least <= 0.0 { 0.0 } else { AS_ONE_WALKS.clamp(self.least, self.most) }
    }
}

/// A tour's own settings by the fields that they stand in, but for the day, each with its bounds.
pub fn settings(tour: &mut Tour) -> [(&'static str, Bounds, &mut f64); 4] {
    [
        ("speed", WALK_SPEED, &mut tour.speed),
        ("eye_m", EYE, &mut tour.eye_m),
        ("fov_deg", FOV, &mut tour.fov_deg),
        ("hour", HOUR, &mut tour.hour),
    ]
}

/// The numbers of a step, each with its bounds and the part of the step that it stands in, as
/// [`TourText::mistake_at`](veduta_city::TourText::mistake_at) takes it.
pub fn numbers(step: &mut Step) -> Vec<(String, Bounds, &mut f64)> {
    let mut all: Vec<(String, Bounds, &mut f64)> = Vec::new();
    match step {
        Step::Start { at, eye_m, look } => {
            of_spot("at", at, &mut all);
            all.extend(eye_m.iter_mut().map(|eye_m| ("eye_m".to_owned(), EYE, eye_m)));
            of_gaze("look", look, &mut all);
        }
        Step::Cut { to, eye_m, look, seconds } => {
            of_spot("to", to, &mut all);
            all.extend(eye_m.iter_mut().map(|eye_m| ("eye_m".to_owned(), EYE, eye_m)));
            of_gaze("look", look, &mut all);
            all.push(("seconds".to_owned(), FADE_SECONDS, seconds));
        }
        Step::Walk { to, via, speed, look, .. } => {
            of_spot("to", to, &mut all);
            via.iter_mut().enumerate().for_each(|(i, spot)| of_spot(&format!("via.{i}"), spot, &mut all));
            all.extend(speed.iter_mut().map(|speed| ("speed".to_owned(), WALK_SPEED, speed)));
            of_gaze("look", look, &mut all);
        }
        Step::Fly { through, speed, look, .. } => {
            for (i, (x, y, height)) in through.iter_mut().enumerate() {
                let numbers = [(COORDINATE, x), (COORDINATE, y), (HEIGHT, height)];
                all.extend(numbers.into_iter().enumerate().map(|(j, (bounds, value))| (format!("through.{i}.{j}"), bounds, value)));
            }
            all.push(("speed".to_owned(), FLIGHT_SPEED, speed));
            of_gaze("look", look, &mut all);
        }
        Step::Track { keys } => {
            for (i, (seconds, x, y, height, heading, pitch)) in keys.iter_mut().enumerate() {
                let place = [(KEY_SECONDS, seconds), (COORDINATE, x), (COORDINATE, y), (HEIGHT, height)];
                let numbers = place.into_iter().chain([(HEADING, heading), (PITCH, pitch)]).enumerate();
                all.extend(numbers.map(|(j, (bounds, value))| (format!("keys.{i}.{j}"), bounds, value)));
            }
        }
        Step::Look { at, seconds } => {
            of_gaze("at", at, &mut all);
            all.push(("seconds".to_owned(), TURN_SECONDS, seconds));
        }
        Step::Wait { seconds } | Step::Picture { seconds, .. } => all.push(("seconds".to_owned(), SECONDS, seconds)),
        Step::Say { seconds, .. } | Step::Narrate { seconds, .. } => {
            all.extend(seconds.iter_mut().map(|seconds| ("seconds".to_owned(), SECONDS, seconds)));
        }
        Step::Rain { wet: value, seconds } => all.extend(turned("wet", WET, value, seconds)),
        Step::Fov { deg: value, seconds } => all.extend(turned("deg", FOV, value, seconds)),
        Step::Time { hour: value, seconds } => all.extend(turned("hour", HOUR, value, seconds)),
        Step::Sound { .. } | Step::Chapter { .. } | Step::Mark { .. } => {}
    }
    all
}

fn turned<'a>(part: &str, bounds: Bounds, value: &'a mut f64, seconds: &'a mut f64) -> [(String, Bounds, &'a mut f64); 2] {
    [(part.to_owned(), bounds, value), ("seconds".to_owned(), SECONDS, seconds)]
}

fn of_spot<'a>(part: &str, spot: &'a mut Where, all: &mut Vec<(String, Bounds, &'a mut f64)>) {
    if let Where::At(x, y) = spot {
        all.extend([(format!("{part}.0"), COORDINATE, x), (format!("{part}.1"), COORDINATE, y)]);
    }
}

fn of_gaze<'a>(part: &str, look: &'a mut LookAt, all: &mut Vec<(String, Bounds, &'a mut f64)>) {
    match look {
        LookAt::Ahead => {}
        LookAt::Spot { at, height_m, follow: _ } => {
            of_spot(&format!("{part}.at"), at, all);
            all.push((format!("{part}.height_m"), SPOT_HEIGHT, height_m));
        }
        LookAt::Heading { deg, pitch_deg } => {
            all.extend([(format!("{part}.deg"), HEADING, deg), (format!("{part}.pitch_deg"), PITCH, pitch_deg)]);
        }
    }
}

/// The spots that a step names, each with the part of the step that it is.
pub fn spots(step: &Step) -> Vec<(String, &Where)> {
    fn gaze<'a>(part: &str, look: &'a LookAt) -> Option<(String, &'a Where)> {
        match look {
            LookAt::Spot { at, .. } => Some((format!("{part}.at"), at)),
            _ => None,
        }
    }
    match step {
        Step::Start { at, look, .. } => [("at".to_owned(), at)].into_iter().chain(gaze("look", look)).collect(),
        Step::Cut { to, look, .. } => [("to".to_owned(), to)].into_iter().chain(gaze("look", look)).collect(),
        Step::Walk { to, via, look, .. } => {
            let via = via.iter().enumerate().map(|(i, spot)| (format!("via.{i}"), spot));
            [("to".to_owned(), to)].into_iter().chain(via).chain(gaze("look", look)).collect()
        }
        Step::Fly { look, .. } => gaze("look", look).into_iter().collect(),
        Step::Look { at, .. } => gaze("at", at).into_iter().collect(),
        _ => Vec::new(),
    }
}
