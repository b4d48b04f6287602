//! What can be wrong with a tour, in words that name the step and the fix.

use core::fmt;

use veduta_city::Step;

use crate::RouteError;

/// Longest tour, in seconds; the view may take some seconds more to come to rest.
pub const LONGEST_TOUR_S: f64 = 6.0 * 3600.0;
/// Longest leg, in metres.
pub const LONGEST_LEG_M: f64 = 100_000.0;
/// Most steps of a tour, and most points of a flight.
pub const MOST_STEPS: usize = 10_000;
/// Most keys of a track.
pub const MOST_KEYS: usize = 100_000;

/// What a step does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum StepKind {
    /// Stands somewhere at once.
    Start,
    /// Walks.
    Walk,
    /// Flies.
    Fly,
    /// Moves by key frames.
    Track,
    /// Turns on the spot.
    Look,
    /// Stays.
    Wait,
    /// Shows a caption.
    Say,
    /// Plays a recording that tells something.
    Narrate,
    /// Lets something be heard beneath all else.
    Sound,
    /// Shows a picture.
    Picture,
    /// Begins a chapter.
    Chapter,
    /// Tells the game of a moment.
    Mark,
    /// Changes the weather.
    Rain,
    /// Changes the field of view.
    Fov,
    /// Changes the hour.
    Time,
    /// Stands somewhere else, behind a fade.
    Cut,
}

impl StepKind {
    /// What a step does.
    #[must_use]
    pub const fn of(step: &Step) -> Self {
        match step {
            Step::Start { .. } => Self::Start,
            Step::Walk { .. } => Self::Walk,
            Step::Fly { .. } => Self::Fly,
            Step::Track { .. } => Self::Track,
            Step::Look { .. } => Self::Look,
            Step::Wait { .. } => Self::Wait,
            Step::Say { .. } => Self::Say,
            Step::Narrate { .. } => Self::Narrate,
            Step::Sound { .. } => Self::Sound,
            Step::Picture { .. } => Self::Picture,
            Step::Chapter { .. } => Self::Chapter,
            Step::Mark { .. } => Self::Mark,
            Step::Rain { .. } => Self::Rain,
            Step::Fov { .. } => Self::Fov,
            Step::Time { .. } => Self::Time,
            Step::Cut { .. } => Self::Cut,
        }
    }
}

impl fmt::Display for StepKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self, f)
    }
}

/// A tour that cannot be played.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TourError {
    /// There is nothing in it.
    #[error("the tour has no steps; let it begin with `Start(at: ...)`")]
    Empty,
    /// There is too much in it.
    #[error("the tour has {0} steps, more than {MOST_STEPS}; split it")]
    TooManySteps(usize),
    /// One of the tour's own settings.
    #[error("the tour's {words}", words = own(.0))]
    Setting(Range),
    /// A step.
    #[error("step {step} ({kind}): {problem}")]
    Step {
        /// The step's number, from 1.
        step: usize,
        /// What the step does.
        kind: StepKind,
        /// What is wrong with it.
        problem: StepProblem,
    },
}

impl TourError {
    /// Number of the step concerned, from 1, if it is about one.
    #[must_use]
    pub const fn step(&self) -> Option<usize> {
        match self {
            Self::Step { step, .. } => Some(*step),
            _ => None,
        }
    }
}

impl TourError {
    /// The same about the step of another number, from 1.
    pub(crate) fn at_step(self, number: usize) -> Self {
        match self {
            Self::Step { kind, problem, .. } => Self::Step { step: number, kind, problem },
            other => other,
        }
    }
}

/// A number that lies outside what it may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// What the number is, with its unit.
    pub what: &'static str,
    /// The number given.
    pub value: f64,
    /// Least that it may be.
    pub least: f64,
    /// Most that it may be.
    pub most: f64,
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, value, least, most } = *self;
        let value_is_plain = !value.is_finite() || (value.abs() < 1e9 && (value == 0.0 || value.abs() > 1e-6));
        write!(f, "{what} is ")?;
        if value_is_plain { write!(f, "{value}") } else { write!(f, "{value:e}") }?;
        write!(f, "; it must lie between {least} and {most}")
    }
}

/// What is wrong with a step.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StepProblem {
    /// The tour has not stood anywhere before.
    #[error("the tour stands nowhere yet; put `Start(at: ...)` before this step")]
    NoStart,
    /// No place has this name.
    #[error("there is no place named {name:?}{meant}", meant = did_you_mean(near))]
    UnknownPlace {
        /// The name.
        name: String,
        /// Names that are alike.
        near: Vec<String>,
    },
    /// A number is not a number, or too small or large.
    #[error("{0}")]
    Range(Range),
    /// There is no way.
    #[error("{0}; {out}", out = way_out(.0))]
    NoWay(#[from] RouteError),
    /// A flight without points.
    #[error("a flight goes through at least one point; give `through: [(x, y, height)]`")]
    NoPoints,
    /// A flight of too many points.
    #[error("the flight goes through {0} points, more than {MOST_STEPS}; split it")]
    TooManyPoints(usize),
    /// A track without keys.
    #[error("a track has at least one key; give `keys: [(seconds, x, y, height, heading, pitch)]`")]
    NoKeys,
    /// A track of too many keys.
    #[error("the track has {0} keys, more than {MOST_KEYS}; split it")]
    TooManyKeys(usize),
    /// Keys that are not in the order of time.
    #[error("key {key} of the track comes at {seconds} s, not after the one before; put them in the order of time")]
    KeysOutOfOrder {
        /// The key's number, from 1.
        key: usize,
        /// Its time.
        seconds: f64,
    },
    /// A walk from high above the ground.
    #[error("the walk would begin {eye_m} m above the ground; fly down to at most {WALK_EYE_M} m first, or use `Cut(to: ...)`")]
    FromAbove {
        /// Eye height in metres.
        eye_m: f64,
    },
    /// A leg that is too long.
    #[error("the leg is {:.1} km long, more than {} km", length_m / 1000.0, LONGEST_LEG_M / 1000.0)]
    TooLong {
        /// Its length in metres.
        length_m: f64,
    },
    /// A file that cannot be what the step needs, by its name.
    #[error("`{}` must be the path of a file in or below the tour's folder that ends in {endings}", file.escape_debug())]
    File {
        /// The path given.
        file: String,
        /// How it may end.
        endings: &'static str,
    },
    /// The tour lasts too long.
    #[error("the tour would last longer than {} hours here; go faster or make it shorter", LONGEST_TOUR_S / 3600.0)]
    TooLate,
}

/// Greatest eye height from which a walk may begin, in metres.
pub const WALK_EYE_M: f64 = 4.0;

/// A number's words after whose it is.
fn own(range: &Range) -> String {
    let words = range.to_string();
    words.strip_prefix("the ").map_or_else(|| words.clone(), str::to_owned)
}

/// What to do where there is no way.
const fn way_out(error: &RouteError) -> &'static str {
    match error {
        RouteError::OffStreets { .. } => "choose a spot nearer to the streets, fly, or use `Cut(to: ...)`",
        _ => "add `via` spots, fly, or use `Cut(to: ...)`",
    }
}

fn did_you_mean(near: &[String]) -> String {
    match near {
        [] => String::new(),
        [one] => format!("; did you mean {one:?}?"),
        [most @ .., last] => {
            let most: Vec<String> = most.iter().map(|name| format!("{name:?}")).collect();
            format!("; did you mean {} or {last:?}?", most.join(", "))
        }
    }
}
