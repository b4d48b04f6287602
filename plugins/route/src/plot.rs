//! The first half of compiling: names become positions, and movements become paths, all still without time.

use glam::{DVec2, DVec3, swizzles::Vec3Swizzles};
use veduta_city::{Ease, LookAt, Place, Step, Tour, Viewpoint, Where};

use crate::{
    FreeLine, Gazetteer, RouteError, StepKind, StepProblem, StreetNet, TourError,
    bounds::{COORDINATE, EYE, FADE_SECONDS, FLIGHT_SPEED, HEADING, HEIGHT, PITCH, SECONDS, SPOT_HEIGHT, TURN_SECONDS, WALK_SPEED},
    error::{LONGEST_LEG_M, MOST_STEPS, WALK_EYE_M},
    flight::fly,
    path::{Mark, Path, round_corners},
    pose::Facing,
    sketch::is_aside,
    timeline::Gaze,
    track::{self, Key},
    way,
};

/// A step or a run of joined steps, with everything known but time.
pub(crate) enum Act {
    /// Stands somewhere else.
    Place {
        step: usize,
        at: DVec3,
        gaze: Gaze,
        /// The direction if nothing lies ahead.
        otherwise: Option<Facing>,
        fade_s: f64,
    },
    /// Walks or flies without a stop between the legs.
    Move { kind: StepKind, legs: Vec<Leg>, paths: Vec<Path> },
    /// Moves by the keys of one or more steps.
    Track { legs: Vec<TrackLeg>, keys: Vec<Key> },
    /// Turns.
    Turn { step: usize, gaze: Gaze, seconds: f64 },
    /// Stays.
    Wait { step: usize, seconds: f64 },
    /// What takes no time of its own: the step itself is read again.
    Aside { step: usize },
}

/// One step of a movement.
pub(crate) struct Leg {
    pub step: usize,
    pub speed: f64,
    pub gaze: Gaze,
    pub ease: Ease,
    /// Steps without time of their own that come just before it.
    pub asides: Vec<usize>,
}

/// One step of a track.
pub(crate) struct TrackLeg {
    pub step: usize,
    /// When it begins and ends, seconds from the first one's begin.
    pub start_s: f64,
    pub end_s: f64,
    /// Steps without time of their own that come just before it.
    pub asides: Vec<usize>,
}

/// What steps are read with.
pub(crate) struct Plotter<'a> {
    pub tour: &'a Tour,
    pub net: &'a StreetNet,
    pub places: &'a Gazetteer,
    pub free: Option<FreeLine<'a>>,
}

type Checked<T> = Result<T, StepProblem>;

/// A spot looked up.
struct Spot<'a> {
    pos: DVec2,
    place: Option<&'a Place>,
}

impl Spot<'_> {
    fn view(&self) -> Option<Viewpoint> {
        self.place.and_then(|p| p.view)
    }
}

impl<'a> Plotter<'a> {
    /// All acts of the tour, in order.
    pub fn plot(&self) -> Result<Vec<Act>, TourError> {
        let mut acts = Vec::new();
        let mut here: Option<DVec3> = None;
        let mut step = 0;
        while step < self.tour.steps.len() {
            let (act, next) = self.act(step, here)?;
            match &act {
                Act::Place { at, .. } => here = Some(*at),
                Act::Track { keys, .. } => here = keys.last().map(|key| key.at).or(here),
                Act::Move { paths, .. } => here = paths.last().map(|p| p.at(p.length())).or(here),
                _ => {}
            }
            acts.push(act);
            step = next;
        }
        Ok(acts)
    }

    fn fails(&self, step: usize) -> impl Fn(StepProblem) -> TourError + '_ {
        move |problem| {
            let kind = self.tour.steps.get(step).map_or(StepKind::Wait, StepKind::of);
            TourError::Step { step: step + 1, kind, problem }
        }
    }

    /// The act that begins with a step, and the step after it.
    fn act(&self, step: usize, here: Option<DVec3>) -> Result<(Act, usize), TourError> {
        let fails = self.fails(step);
        let stands = || here.ok_or(StepProblem::NoStart).map_err(&fails);
        let act = match &self.tour.steps[step] {
            Step::Start { at, eye_m, look } => {
                let fade_s = if here.is_some() { FADE_S } else { FADE_S / 2.0 };
                self.place(step, at, *eye_m, look, fade_s).map_err(fails)?
            }
            Step::Cut { to, eye_m, look, seconds } => {
                stands()?;
                let fade_s = FADE_SECONDS.check(*seconds).map_err(&fails)?;
                self.place(step, to, *eye_m, look, fade_s.max(SHORTEST_FADE_S)).map_err(fails)?
            }
            Step::Walk { .. } | Step::Fly { .. } => return self.movement(step, stands()?),
            Step::Track { .. } => {
                stands()?;
                return self.track(step);
            }
            Step::Look { at, seconds } => {
                stands()?;
                let seconds = TURN_SECONDS.check(*seconds).map_err(&fails)?;
                Act::Turn { step, gaze: self.gaze(step, at).map_err(fails)?, seconds }
            }
            Step::Wait { seconds } => {
                stands()?;
                Act::Wait { step, seconds: SECONDS.check(*seconds).map_err(fails)? }
            }
            Step::Say { .. }
            | Step::Narrate { .. }
            | Step::Sound { .. }
            | Step::Picture { .. }
            | Step::Chapter { .. }
            | Step::Mark { .. }
            | Step::Rain { .. }
            | Step::Fov { .. }
            | Step::Time { .. } => Act::Aside { step },
        };
        Ok((act, step + 1))
    }

    fn place(&self, step: usize, at: &Where, eye_m: Option<f64>, look: &LookAt, fade_s: f64) -> Checked<Act> {
        let spot = self.spot(at)?;
        let eye = eye_m.or_else(|| spot.view().map(|v| v.eye_m)).unwrap_or(self.tour.eye_m);
        let eye = EYE.check(eye)?;
        let gaze = self.gaze(step, look)?;
        let otherwise = spot.view().map(|v| Facing { heading: v.heading_deg, pitch: v.pitch_deg });
        let otherwise = otherwise.filter(|f| f.heading.is_finite() && f.pitch.abs() <= 90.0);
        Ok(Act::Place { step, at: self.stand(&spot)?.extend(eye), gaze, otherwise, fade_s })
    }

    /// The position behind a name or a pair of numbers.
    fn spot(&self, at: &Where) -> Checked<Spot<'a>> {
        let spot = match at {
            Where::At(x, y) => Spot { pos: DVec2::new(*x, *y), place: None },
            Where::Place(name) => {
                let unknown = || StepProblem::UnknownPlace {
                    name: name.chars().take(80).collect(),
                    near: self.places.suggest(name).into_iter().map(str::to_owned).collect(),
                };
                let place = self.places.find(name).ok_or_else(unknown)?;
                Spot { pos: place.pos, place: Some(place) }
            }
        };
        let stand = spot.view().map_or(spot.pos, |v| v.pos);
        for value in [spot.pos.x, spot.pos.y, stand.x, stand.y] {
            COORDINATE.check(value)?;
        }
        Ok(spot)
    }

    /// Where to stand at a spot: at the stand that was chosen for the place, or at the spot itself. A place that is not free
    /// (a house, a monument) is approached from the nearest street as far as it goes.
    fn stand(&self, spot: &Spot<'_>) -> Checked<DVec2> {
        const OFF_WALL_M: f64 = 1.0;
        if let Some(view) = spot.view() {
            return Ok(view.pos);
        }
        let (Some(free), Some(_), Some(foot)) = (self.free, spot.place, self.net.nearest(spot.pos)) else { return Ok(spot.pos) };
        if foot.distance_m < 0.05 || foot.distance_m > way::OFF_STREET_M || free(foot.plan_pos, spot.pos) {
            return Ok(spot.pos);
        }
        let (mut near, mut far) = (0.0, 1.0);
        for _ in 0..20 {
            let middle = (near + far) / 2.0;
            if free(foot.plan_pos, foot.plan_pos.lerp(spot.pos, middle)) { near = middle } else { far = middle }
        }
        Ok(foot.plan_pos.lerp(spot.pos, (near - OFF_WALL_M / foot.distance_m).max(0.0)))
    }

    fn gaze(&self, step: usize, look: &LookAt) -> Checked<Gaze> {
        Ok(match look {
            LookAt::Ahead => Gaze::Ahead,
            LookAt::Heading { deg, pitch_deg } => {
                let heading = HEADING.check(*deg)?;
                Gaze::Direction(Facing { heading, pitch: PITCH.check(*pitch_deg)? })
            }
            LookAt::Spot { at, height_m, follow } => {
                let height = SPOT_HEIGHT.check(*height_m)?;
                Gaze::Spot { at: self.spot(at)?.pos.extend(height), follow: follow.is_some().then_some(step) }
            }
        })
    }

    /// This step and all of its kind that follow, apart from those that take no time.
    fn movement(&self, first: usize, here: DVec3) -> Result<(Act, usize), TourError> {
        let kind = StepKind::of(&self.tour.steps[first]);
        if kind == StepKind::Walk && here.z > WALK_EYE_M {
            return Err(self.fails(first)(StepProblem::FromAbove { eye_m: here.z }));
        }
        let mut marks = vec![Mark { at: here, leg: 0 }];
        let mut legs: Vec<Leg> = Vec::new();
        let mut asides = Vec::new();
        let mut next = first;
        for (step, s) in self.tour.steps.iter().enumerate().skip(first) {
            match s {
                s if is_aside(s) => asides.push(step),
                s if StepKind::of(s) == kind => {
                    let mut leg = self.leg(step, legs.len() as u32, &mut marks).map_err(self.fails(step))?;
                    leg.asides = core::mem::take(&mut asides);
                    legs.push(leg);
                    next = step + 1;
                }
                _ => break,
            }
        }
        let paths = if kind == StepKind::Walk { round_corners(&marks, self.free) } else { fly(&marks) };
        Ok((Act::Move { kind, legs, paths }, next))
    }

    /// This track and all that follow, apart from steps that take no time.
    fn track(&self, first: usize) -> Result<(Act, usize), TourError> {
        let (mut legs, mut keys) = (Vec::<TrackLeg>::new(), Vec::new());
        let (mut asides, mut next) = (Vec::new(), first);
        for (step, s) in self.tour.steps.iter().enumerate().skip(first) {
            match s {
                Step::Track { keys: own } => {
                    let start_s = legs.last().map_or(0.0, |leg| leg.end_s);
                    let end_s = track::read(own, start_s, &mut keys).map_err(self.fails(step))?;
                    legs.push(TrackLeg { step, start_s, end_s, asides: core::mem::take(&mut asides) });
                    next = step + 1;
                }
                s if is_aside(s) => asides.push(step),
                _ => break,
            }
        }
        Ok((Act::Track { legs, keys }, next))
    }

    /// Reads one leg and adds where it goes.
    fn leg(&self, step: usize, leg: u32, marks: &mut Vec<Mark>) -> Checked<Leg> {
        let before = marks.len().saturating_sub(1);
        let (speed, look, ease) = match &self.tour.steps[step] {
            Step::Walk { to, via, speed, look, ease } => {
                let speed = WALK_SPEED.check(speed.unwrap_or(self.tour.speed))?;
                if via.len() > MOST_STEPS {
                    return Err(StepProblem::TooManyPoints(via.len()));
                }
                for spot in via.iter().chain([to]) {
                    self.walk_to(spot, leg, marks)?;
                }
                (speed, look, *ease)
            }
            Step::Fly { through, speed, look, ease } => {
                let speed = FLIGHT_SPEED.check(*speed)?;
                if through.is_empty() {
                    return Err(StepProblem::NoPoints);
                }
                if through.len() > MOST_STEPS {
                    return Err(StepProblem::TooManyPoints(through.len()));
                }
                for &(x, y, height) in through {
                    COORDINATE.check(x)?;
                    COORDINATE.check(y)?;
                    HEIGHT.check(height)?;
                    marks.push(Mark { at: DVec3::new(x, y, height), leg });
                }
                (speed, look, *ease)
            }
            _ => return Err(StepProblem::NoStart),
        };
        let length_m: f64 = marks[before..].windows(2).map(|w| w[0].at.distance(w[1].at)).sum();
        if length_m > LONGEST_LEG_M {
            return Err(StepProblem::TooLong { length_m });
        }
        Ok(Leg { step, speed, gaze: self.gaze(step, look)?, ease, asides: Vec::new() })
    }

    fn walk_to(&self, to: &Where, leg: u32, marks: &mut Vec<Mark>) -> Checked<()> {
        let Some(from) = marks.last().map(|m| m.at) else { return Err(StepProblem::NoStart) };
        let stand = self.stand(&self.spot(to)?)?;
        if from.xy().distance(stand) > LONGEST_LEG_M {
            return Err(StepProblem::TooLong { length_m: from.xy().distance(stand) });
        }
        let way = self.net.way_with(from.xy(), stand, self.free).map_err(|error: RouteError| StepProblem::NoWay(error))?;
        marks.extend(way.iter().skip(1).map(|p| Mark { at: p.extend(from.z), leg }));
        Ok(())
    }
}

/// Fade of a `Start`, out and in together, in seconds.
const FADE_S: f64 = 1.6;
/// Shortest fade, in seconds: a frame must find it dark.
const SHORTEST_FADE_S: f64 = 0.4;
