//! The second half of compiling: acts are set in time.

use std::collections::BTreeMap;

use glam::{DVec2, swizzles::Vec3Swizzles};
use veduta_city::{Ease, PlanTerrain, Step, Tour};

use crate::{
    FreeLine, Gazetteer, Pose, StepKind, StepProblem, StreetNet, TourError,
    bounds::{Bounds, DAY, EYE, FOV, HOUR, SECONDS, WALK_SPEED, WET},
    error::{LONGEST_TOUR_S, MOST_STEPS},
    follow,
    pace::{Haste, Pace},
    plot::{Act, Leg, Plotter, TrackLeg},
    pose::{Facing, smoothstep},
    script::{Ambience, Caption, Chapter, Mark, Narration, PICTURES, RECORDINGS, Script, Spoken, TourPicture, beside},
    timeline::{Draft, Gaze, Run, Timeline},
    track::Key,
};

/// When a step plays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepSpan {
    /// Seconds from the tour's start.
    pub start_s: f64,
    /// Seconds from the tour's start; captions and changes of hour and field of view overlap with what follows.
    pub end_s: f64,
    /// Index into the tour's steps, from 0.
    pub index: usize,
    /// What the step does.
    pub kind: StepKind,
    /// Whether the visitor walks.
    pub is_walk: bool,
}

/// A tour as poses over time.
#[derive(Debug, Clone)]
pub struct CompiledTour {
    title: Spoken,
    pub(crate) timeline: Timeline,
    fov: Dial,
    hour: Dial,
    /// How wet it is, if the tour says so at all.
    wet: Option<Dial>,
    day: u16,
    fades: Vec<Fade>,
    pub(crate) script: Script,
    /// What the eye follows, by the step that names it.
    pub(crate) subjects: BTreeMap<usize, String>,
    spans: Vec<StepSpan>,
}

/// A number that is set, and turned from one value to another.
#[derive(Debug, Clone)]
struct Dial {
    first: f64,
    turns: Vec<DialTurn>,
}

#[derive(Debug, Clone, Copy)]
struct DialTurn {
    start_s: f64,
    span_s: f64,
    from: f64,
    to: f64,
}

impl Dial {
    fn at(&self, t: f64) -> f64 {
        let index = self.turns.partition_point(|turn| turn.start_s <= t);
        let Some(turn) = index.checked_sub(1).and_then(|i| self.turns.get(i)) else { return self.first };
        let share = if turn.span_s > 0.0 { smoothstep((t - turn.start_s) / turn.span_s) } else { 1.0 };
        turn.from + (turn.to - turn.from) * share
    }

    fn turn(&mut self, start_s: f64, span_s: f64, to: f64) {
        let from = self.at(start_s);
        self.turns.push(DialTurn { start_s, span_s, from, to });
    }
}

/// Growing darkness, or light.
#[derive(Debug, Clone, Copy)]
struct Fade {
    start_s: f64,
    end_s: f64,
    is_dark_after: bool,
}

/// Half the time for which it stays dark at a cut, in seconds.
const DARK_S: f64 = 0.05;

/// Compiles a tour; walks keep to the streets.
///
/// # Errors
/// [`TourError`] names the step that cannot be played, why, and what to do.
pub fn compile(tour: &Tour, net: &StreetNet, places: &Gazetteer) -> Result<CompiledTour, TourError> {
    compile_plotter(&Plotter { tour, net, places, free: None })
}

/// Compiles a tour; `free` tells whether a straight line between two plan positions is free of walls. Walks then cross
/// squares ([`StreetNet::way_with`]), and end before places that cannot be stood on.
///
/// # Errors
/// [`TourError`] names the step that cannot be played, why, and what to do.
pub fn compile_with(tour: &Tour, net: &StreetNet, places: &Gazetteer, free: FreeLine<'_>) -> Result<CompiledTour, TourError> {
    compile_plotter(&Plotter { tour, net, places, free: Some(free) })
}

fn compile_plotter(plotter: &Plotter<'_>) -> Result<CompiledTour, TourError> {
    let (tour, terrain) = (plotter.tour, &plotter.net.terrain);
    if tour.steps.len() > MOST_STEPS {
        return Err(TourError::TooManySteps(tour.steps.len()));
    }
    let setting = |bounds: Bounds, value| bounds.range(value).map_err(TourError::Setting);
    setting(WALK_SPEED, tour.speed)?;
    setting(EYE, tour.eye_m)?;
    setting(FOV, tour.fov_deg)?;
    setting(HOUR, tour.hour)?;
    setting(DAY, f64::from(tour.day))?;
    let acts = plotter.plot()?;
    let Some((at, facing)) = acts.iter().enumerate().find_map(|(i, act)| opening(act, &acts[i + 1..], terrain)) else {
        return Err(TourError::Empty);
    };
    let mut score = Score {
        tour,
        draft: Draft::new(at, facing, terrain),
        fov: Dial { first: tour.fov_deg, turns: Vec::new() },
        hour: Dial { first: tour.hour, turns: Vec::new() },
        wet: None,
        fades: Vec::new(),
        script: Script::default(),
        spans: Vec::new(),
        end_s: 0.0,
        has_started: false,
    };
    for (i, act) in acts.iter().enumerate() {
        score.play(act, &acts[i + 1..])?;
    }
    Ok(score.finish())
}

/// Position and direction where a place is taken, if the act is one; the view ahead needs what follows.
fn opening(act: &Act, following: &[Act], terrain: &PlanTerrain) -> Option<(glam::DVec3, Facing)> {
    let Act::Place { at, gaze, otherwise, .. } = act else { return None };
    let facing = match gaze {
        Gaze::Ahead => direction_ahead(following).or(*otherwise).unwrap_or_default(),
        gaze => gaze.from(*at, Facing::default(), terrain),
    };
    Some((*at, facing))
}

/// The direction in which the next movement of the same shot sets off.
fn direction_ahead(following: &[Act]) -> Option<Facing> {
    for act in following {
        match act {
            Act::Place { .. } => return None,
            Act::Move { kind, legs, paths } => {
                let speed = legs.first().map_or(1.0, |l| l.speed);
                return paths.first().map(|p| view_along(p, *kind, speed));
            }
            _ => {}
        }
    }
    None
}

fn view_along(path: &crate::path::Path, kind: StepKind, speed: f64) -> Facing {
    let facing = Facing::along(path.ahead(0.0, reach_m(kind, speed)), Facing::default());
    let pitch = if kind == StepKind::Walk { 0.0 } else { (0.6 * facing.pitch).clamp(-35.0, 35.0) };
    Facing { pitch, ..facing }
}

/// How far ahead the eye looks along a path.
fn reach_m(kind: StepKind, speed: f64) -> f64 {
    if kind == StepKind::Walk { 4.0 } else { (1.5 * speed).max(4.0) }
}

/// A tour being set in time.
struct Score<'a> {
    tour: &'a Tour,
    draft: Draft<'a>,
    fov: Dial,
    hour: Dial,
    wet: Option<Dial>,
    fades: Vec<Fade>,
    script: Script,
    spans: Vec<StepSpan>,
    /// When everything that overlaps has ended.
    end_s: f64,
    has_started: bool,
}

impl Score<'_> {
    fn fail(&self, step: usize, problem: StepProblem) -> TourError {
        TourError::Step { step: step + 1, kind: self.kind(step), problem }
    }

    fn kind(&self, step: usize) -> StepKind {
        self.tour.steps.get(step).map_or(StepKind::Wait, StepKind::of)
    }

    fn play(&mut self, act: &Act, following: &[Act]) -> Result<(), TourError> {
        let start_s = self.draft.now_s;
        let step = match act {
            Act::Place { step, gaze, fade_s, .. } => {
                if let Some((at, facing)) = opening(act, following, self.draft.terrain) {
                    self.place(at, facing, *gaze, *fade_s);
                }
                *step
            }
            Act::Move { kind, legs, paths } => return self.movement(*kind, legs, paths),
            Act::Track { legs, keys } => return self.track(legs, keys),
            Act::Turn { step, gaze, seconds } => {
                let gaze = match gaze {
                    Gaze::Ahead => direction_ahead(following).map_or(Gaze::Hold, Gaze::Direction),
                    gaze => *gaze,
                };
                self.draft.settle_after_track();
                self.draft.turn(gaze, *seconds);
                *step
            }
            Act::Wait { step, seconds } => {
                self.draft.stand(*seconds);
                *step
            }
            Act::Aside { step } => return self.aside(*step, start_s),
        };
        self.span(step, start_s, self.draft.now_s)
    }

    fn span(&mut self, step: usize, start_s: f64, end_s: f64) -> Result<(), TourError> {
        if is_too_late(end_s) {
            return Err(self.fail(step, StepProblem::TooLate));
        }
        let kind = self.kind(step);
        self.spans.push(StepSpan { start_s, end_s, index: step, kind, is_walk: kind == StepKind::Walk });
        self.end_s = self.end_s.max(end_s);
        Ok(())
    }

    fn place(&mut self, at: glam::DVec3, facing: Facing, gaze: Gaze, fade_s: f64) {
        if self.has_started {
            let half = fade_s / 2.0;
            let start_s = self.draft.now_s;
            self.draft.stand(half);
            let cut_s = self.draft.now_s;
            self.fades.push(Fade { start_s, end_s: cut_s - DARK_S, is_dark_after: true });
            self.fades.push(Fade { start_s: cut_s + DARK_S, end_s: cut_s + half, is_dark_after: false });
            self.draft.place(at, facing);
            self.draft.stand(half);
        } else {
            self.fades.push(Fade { start_s: DARK_S, end_s: fade_s, is_dark_after: false });
            self.draft.stand(fade_s);
            self.has_started = true;
        }
        if let Gaze::Spot { .. } = gaze {
            self.draft.cue(self.draft.now_s, gaze, 0.0);
        }
    }

    /// Plays the legs of a movement; between paths the visitor turns round.
    fn movement(&mut self, kind: StepKind, legs: &[Leg], paths: &[crate::path::Path]) -> Result<(), TourError> {
        self.draft.settle_after_track();
        let start_s = self.draft.now_s;
        let mut starts: Vec<Option<f64>> = vec![None; legs.len()];
        let gaze_of = |leg: u32| legs.get(leg as usize).map_or(Gaze::Ahead, |l| l.gaze);
        let speed_of = |leg: u32| legs.get(leg as usize).map_or(1.0, |l| l.speed);
        for (i, path) in paths.iter().enumerate() {
            let Some(first) = path.knots().first().map(|k| k.leg) else { continue };
            if let Some(start) = starts.get_mut(first as usize) {
                start.get_or_insert(self.draft.now_s);
            }
            let haste = haste(kind, speed_of(first), i > 0 || starts_gently(legs), i + 1 < paths.len() || stops_gently(legs));
            let pace = Pace::new(path, speed_of, haste);
            let run = Run { path: path.clone(), pace, reach_m: reach_m(kind, speed_of(first)), is_walk: kind == StepKind::Walk };
            if is_too_late(self.draft.now_s + run.pace.duration_s()) {
                let step = legs.get(first as usize).map_or(0, |l| l.step);
                return Err(self.fail(step, StepProblem::TooLate));
            }
            self.draft.set_off(&run, gaze_of(first));
            let run_s = self.draft.now_s;
            let mut last = first;
            for knot in path.knots() {
                if knot.leg != last {
                    last = knot.leg;
                    let at_s = run_s + run.pace.when(knot.s);
                    self.draft.cue(at_s, gaze_of(last), 0.0);
                    if let Some(start) = starts.get_mut(last as usize) {
                        start.get_or_insert(at_s);
                    }
                }
            }
            self.draft.facing = match gaze_of(last) {
                Gaze::Ahead => run.facing(path.length(), self.draft.facing),
                gaze => gaze.from(path.at(path.length()), self.draft.facing, self.draft.terrain),
            };
            self.draft.run(run);
        }
        match legs.last().map_or(Gaze::Hold, |l| l.gaze) {
            Gaze::Ahead => self.draft.cue(self.draft.now_s, Gaze::Hold, 0.0),
            gaze => self.draft.cue(self.draft.now_s, gaze, 0.0),
        }
        self.leg_spans(legs, &starts, start_s)
    }

    /// Plays the legs of a track, from rest to rest.
    fn track(&mut self, legs: &[TrackLeg], keys: &[Key]) -> Result<(), TourError> {
        self.draft.settle();
        let start_s = self.draft.now_s;
        if let Some(late) = legs.iter().find(|leg| is_too_late(start_s + leg.end_s)) {
            return Err(self.fail(late.step, StepProblem::TooLate));
        }
        self.draft.track(keys);
        for leg in legs {
            for &aside in &leg.asides {
                self.aside(aside, start_s + leg.start_s)?;
            }
            self.span(leg.step, start_s + leg.start_s, start_s + leg.end_s)?;
        }
        Ok(())
    }

    fn leg_spans(&mut self, legs: &[Leg], starts: &[Option<f64>], start_s: f64) -> Result<(), TourError> {
        let end_s = self.draft.now_s;
        // A leg to where one stands already takes no time: it begins when the next one does.
        let mut begins = vec![end_s; legs.len() + 1];
        for i in (0..legs.len()).rev() {
            begins[i] = starts.get(i).copied().flatten().unwrap_or(begins[i + 1]);
        }
        begins[0] = start_s;
        for (leg, times) in legs.iter().zip(begins.windows(2)) {
            for &aside in &leg.asides {
                self.aside(aside, times[0])?;
            }
            self.span(leg.step, times[0], times[1])?;
        }
        Ok(())
    }

    /// A step that goes on beside those that follow.
    fn aside(&mut self, step: usize, start_s: f64) -> Result<(), TourError> {
        let time = |seconds| SECONDS.check(seconds);
        let seconds = match self.tour.steps.get(step) {
            Some(Step::Say { text, translations, seconds }) => {
                let longest = translations.values().chain([text]).map(|text| reading_s(text)).fold(0.0, f64::max);
                let seconds = time(seconds.unwrap_or(longest)).map_err(|p| self.fail(step, p))?;
                let text = Spoken::new(text, translations);
                self.script.captions.push(Caption { start_s, end_s: start_s + seconds, text });
                seconds
            }
            Some(Step::Narrate { file, files, text, translations, seconds }) => {
                for file in files.values().chain([file]) {
                    beside(file, RECORDINGS).map_err(|p| self.fail(step, p))?;
                }
                let longest = translations.values().chain([text]).map(|text| reading_s(text)).fold(0.0, f64::max);
                let seconds = time(seconds.unwrap_or(longest)).map_err(|p| self.fail(step, p))?;
                self.script.narrations.push(Narration::new(start_s, file, files));
                let text = Spoken::new(text, translations);
                self.script.captions.push(Caption { start_s, end_s: start_s + seconds, text });
                seconds
            }
            Some(Step::Sound { file }) => {
                file.as_ref().map_or(Ok(()), |file| beside(file, RECORDINGS)).map_err(|p| self.fail(step, p))?;
                self.script.ambiences.push(Ambience { at_s: start_s, file: file.clone() });
                0.0
            }
            Some(Step::Picture { file, caption, translations, seconds }) => {
                beside(file, PICTURES).map_err(|p| self.fail(step, p))?;
                let seconds = time(*seconds).map_err(|p| self.fail(step, p))?;
                let (end_s, caption) = (start_s + seconds, Spoken::new(caption, translations));
                self.script.pictures.push(TourPicture { start_s, end_s, file: file.clone(), caption });
                seconds
            }
            Some(Step::Chapter { title, translations }) => {
                self.script.chapters.push(Chapter { start_s, title: Spoken::new(title, translations) });
                0.0
            }
            Some(Step::Mark { name }) => {
                self.script.marks.push(Mark { at_s: start_s, name: name.clone() });
                0.0
            }
            Some(Step::Rain { wet, seconds }) => {
                let wet = WET.check(*wet).map_err(|p| self.fail(step, p))?;
                let seconds = time(*seconds).map_err(|p| self.fail(step, p))?;
                self.wet.get_or_insert(Dial { first: 0.0, turns: Vec::new() }).turn(start_s, seconds, wet);
                seconds
            }
            Some(Step::Fov { deg, seconds }) => {
                let deg = FOV.check(*deg).map_err(|p| self.fail(step, p))?;
                let seconds = time(*seconds).map_err(|p| self.fail(step, p))?;
                self.fov.turn(start_s, seconds, deg);
                seconds
            }
            Some(Step::Time { hour, seconds }) => {
                let hour = HOUR.check(*hour).map_err(|p| self.fail(step, p))?;
                let seconds = time(*seconds).map_err(|p| self.fail(step, p))?;
                let now = self.hour.at(start_s);
                self.hour.turn(start_s, seconds, hour_on(now, hour));
                seconds
            }
            _ => 0.0,
        };
        self.span(step, start_s, start_s + seconds)
    }

    fn finish(self) -> CompiledTour {
        CompiledTour {
            title: Spoken::new(&self.tour.title, &self.tour.translations),
            timeline: self.draft.finish(self.end_s),
            fov: self.fov,
            hour: self.hour,
            wet: self.wet,
            day: self.tour.day,
            fades: self.fades,
            script: self.script,
            subjects: follow::subjects(&self.tour.steps),
            spans: self.spans,
        }
    }
}

/// Whether a time is beyond the longest tour, or not a number.
fn is_too_late(t: f64) -> bool {
    t.is_nan() || t > LONGEST_TOUR_S
}

/// The hour to turn to, counted on from `now` so that the clock goes forward, or back by less than half a day.
pub(crate) fn hour_on(now: f64, hour: f64) -> f64 {
    let forward = hour - now.rem_euclid(24.0);
    now + if forward < -12.0 { forward + 24.0 } else { forward }
}

/// How long a caption stays if it does not say: time to read it twice over, and to notice it; seconds.
#[must_use]
pub fn reading_s(text: &str) -> f64 {
    let letters = text.chars().take(100_000).count() as f64;
    if letters > 0.0 { (1.5 + letters / 14.0).max(2.5) } else { 0.0 }
}

fn starts_gently(legs: &[Leg]) -> bool {
    legs.first().is_none_or(|l| matches!(l.ease, Ease::InOut | Ease::In))
}

fn stops_gently(legs: &[Leg]) -> bool {
    legs.last().is_none_or(|l| matches!(l.ease, Ease::InOut | Ease::Out))
}

/// Accelerations: a walker's, or a flight's, which grow with its speed.
fn haste(kind: StepKind, speed: f64, starts_gently: bool, stops_gently: bool) -> Haste {
    let (gentle, brisk, side) = match kind {
        StepKind::Walk => (1.2, 3.0, 3.0),
        _ => ((speed / 2.5).clamp(1.2, 5.0), (speed / 1.25).clamp(3.0, 10.0), 6.0),
    };
    Haste { up: if starts_gently { gentle } else { brisk }, down: if stops_gently { gentle } else { brisk }, side }
}

impl CompiledTour {
    /// Length of the tour in seconds.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.timeline.end_s()
    }

    /// The tour's title, in its own language.
    #[must_use]
    pub fn title(&self) -> &str {
        self.title.own()
    }

    /// The tour's title in a language, told by its code.
    #[must_use]
    pub fn title_in(&self, language: &str) -> &str {
        self.title.within(language)
    }

    /// Its chapters, in order.
    #[must_use]
    pub fn chapters(&self) -> &[Chapter] {
        &self.script.chapters
    }

    /// The chapter of a moment, by its index; `None` before the first.
    #[must_use]
    pub fn chapter(&self, t_s: f64) -> Option<usize> {
        self.script.chapters.partition_point(|chapter| chapter.start_s <= t_s).checked_sub(1)
    }

    /// The moments to tell a game of, after one time and up to another; seconds.
    #[must_use]
    pub fn marks(&self, after_s: f64, until_s: f64) -> &[Mark] {
        self.script.marks(after_s, until_s)
    }

    /// How wet the streets are, 0 to 1; `None` where the tour leaves the weather as it is.
    #[must_use]
    pub fn wet(&self, t_s: f64) -> Option<f64> {
        self.wet.as_ref().map(|wet| wet.at(self.clamped(t_s)))
    }

    /// Day of the year, 1 to 366.
    #[must_use]
    pub const fn day(&self) -> u16 {
        self.day
    }

    /// When each step plays, by the steps' order within joined movements; one entry a step.
    #[must_use]
    pub fn steps(&self) -> &[StepSpan] {
        &self.spans
    }

    /// Tells steps by the indices that they have elsewhere.
    pub(crate) fn renumber(&mut self, indices: &[usize]) {
        for span in &mut self.spans {
            span.index = indices.get(span.index).copied().unwrap_or(span.index);
        }
    }

    /// The pose at a moment in seconds; before the start and after the end the first and last.
    #[must_use]
    pub fn pose(&self, t_s: f64) -> Pose {
        let t = self.clamped(t_s);
        let (at, facing) = (self.timeline.at(t), self.timeline.facing(t));
        Pose {
            plan_pos: at.xy(),
            eye_m: at.z,
            heading_deg: facing.heading,
            pitch_deg: facing.pitch,
            fov_deg: self.fov.at(t),
            hour: self.hour.at(t).rem_euclid(24.0),
            fade: self.fade(t),
        }
    }

    fn clamped(&self, t_s: f64) -> f64 {
        // Also what is not a number.
        if t_s > 0.0 { t_s.min(self.duration_s()) } else { 0.0 }
    }

    fn fade(&self, t: f64) -> f64 {
        let index = self.fades.partition_point(|f| f.start_s <= t);
        let Some(fade) = index.checked_sub(1).and_then(|i| self.fades.get(i)) else { return 1.0 };
        let share = smoothstep((t - fade.start_s) / (fade.end_s - fade.start_s));
        if fade.is_dark_after { share } else { 1.0 - share }
    }

    /// The caption at a moment, in the tour's own language; `None` outside the tour.
    #[must_use]
    pub fn caption(&self, t_s: f64) -> Option<&str> {
        self.script.caption(t_s).map(Spoken::own)
    }

    /// The caption at a moment in a language, told by its code; `None` outside the tour.
    #[must_use]
    pub fn caption_in(&self, t_s: f64, language: &str) -> Option<&str> {
        self.script.caption(t_s).map(|text| text.within(language))
    }

    /// The ways gone over ground, plan metres: one for each part of the tour between cuts.
    #[must_use]
    pub fn paths(&self) -> Vec<Vec<DVec2>> {
        self.timeline.ways()
    }

    /// The whole way over ground, plan metres; cuts are straight lines in it.
    #[must_use]
    pub fn path(&self) -> Vec<DVec2> {
        self.paths().concat()
    }
}
