//! A tour that is being edited: what is selected, what was done and can be undone, what of it is in its file.

use core::ops::Range;

use veduta_city::{LookAt, Step, Tour, TourEditError, TourSetting, TourText, Where};

use crate::{Pose, StepKind, WALK_EYE_M};

/// So many edits can be undone.
const MOST_UNDONE: usize = 200;

/// A tour's text under edit. Every edit can be undone, and comments in the text stay.
///
/// ```
/// use veduta_city::{Step, TourText};
/// use veduta_route::TourEdit;
///
/// let text = "(title: \"A walk\", city: \"x\", steps: [\n  // Here.\n  Start(at: At(0, 0)),\n])";
/// let mut edit = TourEdit::open(TourText::parse(text, "a.tour.ron")?);
/// edit.select(0..1);
/// edit.insert(&[Step::Wait { seconds: 2.0 }])?;
/// assert!(edit.is_unsaved() && edit.selected() == (1..2) && edit.text().contains("// Here."));
/// edit.undo();
/// assert_eq!((edit.text(), edit.selected()), (text, 0..1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct TourEdit {
    now: State,
    undone: Vec<State>,
    redone: Vec<State>,
    /// The text as it is in the file; none if it is in none.
    kept: Option<String>,
    /// What the last edit was about: the next about the same is one with it.
    about: Option<About>,
    version: u64,
}

#[derive(Debug, Clone, PartialEq)]
struct State {
    text: TourText,
    selected: Range<usize>,
}

/// What an edit is about that may go on over many frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum About {
    Step(usize),
    Setting(&'static str),
}

impl TourEdit {
    /// Edits a tour as it stands in its file.
    #[must_use]
    pub fn open(text: TourText) -> Self {
        let kept = Some(text.text().to_owned());
        let selected = if text.tour().steps.is_empty() { 0..0 } else { 0..1 };
        Self { now: State { text, selected }, undone: Vec::new(), redone: Vec::new(), kept, about: None, version: 0 }
    }

    /// Edits a tour that is in no file yet.
    ///
    /// # Errors
    /// [`TourEditError::Unwritable`] if a number in it is none.
    pub fn begin(tour: &Tour) -> Result<Self, TourEditError> {
        Ok(Self { kept: None, ..Self::open(TourText::new(tour)?) })
    }

    /// The tour.
    #[must_use]
    pub const fn tour(&self) -> &Tour {
        self.now.text.tour()
    }

    /// Its text.
    #[must_use]
    pub fn text(&self) -> &str {
        self.now.text.text()
    }

    /// A number that changes with every edit, undone ones too.
    #[must_use]
    pub const fn version(&self) -> u64 {
        self.version
    }

    /// Whether it differs from what is in its file; a tour in no file does as soon as it has a step.
    #[must_use]
    pub fn is_unsaved(&self) -> bool {
        self.kept.as_deref().map_or(!self.tour().steps.is_empty(), |kept| kept != self.text())
    }

    /// The text as it was last read from or written to its file.
    #[must_use]
    pub fn kept(&self) -> Option<&str> {
        self.kept.as_deref()
    }

    /// The file has this text now.
    pub fn keep(&mut self, text: String) {
        self.kept = Some(text);
    }

    /// Indices of the selected steps; an empty range selects the tour itself.
    #[must_use]
    pub fn selected(&self) -> Range<usize> {
        self.now.selected.clone()
    }

    /// Selects steps; what lies beyond the last is left out.
    pub fn select(&mut self, steps: Range<usize>) {
        let count = self.tour().steps.len();
        let selected = steps.start.min(count)..steps.end.min(count);
        if selected != self.now.selected {
            self.seal();
            self.now.selected = selected;
        }
    }

    /// What is edited from now on is undone by itself.
    pub fn seal(&mut self) {
        self.about = None;
    }

    /// Changes one of the tour's own settings. Changes of the same one that follow are undone together, until [`TourEdit::seal`].
    ///
    /// # Errors
    /// [`TourEditError`]; nothing is changed then.
    pub fn set(&mut self, setting: TourSetting) -> Result<(), TourEditError> {
        let about = About::Setting(name(&setting));
        self.edit(Some(about), |now| now.text.set(setting))
    }

    /// Makes a step another one. Changes of the same one that follow are undone together, until [`TourEdit::seal`].
    ///
    /// # Errors
    /// [`TourEditError`]; nothing is changed then.
    pub fn replace(&mut self, index: usize, step: &Step) -> Result<(), TourEditError> {
        if self.tour().steps.get(index) == Some(step) {
            return Ok(());
        }
        self.edit(Some(About::Step(index)), |now| now.text.replace(index, step))
    }

    /// Puts steps after those that are selected and selects them; with none selected, after all.
    ///
    /// # Errors
    /// [`TourEditError`]; nothing is changed then.
    pub fn insert(&mut self, steps: &[Step]) -> Result<(), TourEditError> {
        let index = self.after();
        self.edit(None, |now| {
            now.text.insert(index, steps)?;
            now.selected = index..index + steps.len();
            Ok(())
        })
    }

    fn after(&self) -> usize {
        if self.now.selected.is_empty() { self.tour().steps.len() } else { self.now.selected.end }
    }

    /// The selected steps as text with their comments, to be pasted.
    #[must_use]
    pub fn copy(&self) -> String {
        let mut text = self.now.text.clone();
        self.selected().filter_map(|_| text.remove(self.now.selected.start).ok()).collect()
    }

    /// Takes the selected steps out; the one that follows is selected.
    ///
    /// # Errors
    /// [`TourEditError`]; nothing is changed then.
    pub fn remove(&mut self) -> Result<(), TourEditError> {
        if self.now.selected.is_empty() {
            return Ok(());
        }
        self.edit(None, |now| {
            for _ in now.selected.clone() {
                now.text.remove(now.selected.start)?;
            }
            let count = now.text.tour().steps.len();
            let next = now.selected.start.min(count.saturating_sub(1));
            now.selected = next..(next + 1).min(count);
            Ok(())
        })
    }

    /// Puts steps given as text after those that are selected, and selects them.
    ///
    /// # Errors
    /// [`TourEditError::Unwritable`] where the text is no steps; nothing is changed then.
    pub fn paste(&mut self, text: &str) -> Result<(), TourEditError> {
        let index = self.after();
        let count = self.tour().steps.len();
        self.edit(None, |now| {
            now.text.insert_text(index, text)?;
            now.selected = index..index + (now.text.tour().steps.len() - count);
            Ok(())
        })
    }

    /// Puts copies of the selected steps after them.
    ///
    /// # Errors
    /// [`TourEditError`]; nothing is changed then.
    pub fn duplicate(&mut self) -> Result<(), TourEditError> {
        let copy = self.copy();
        if copy.is_empty() { Ok(()) } else { self.paste(&copy) }
    }

    /// Takes the selected steps elsewhere, so that the first of them then comes before the step that was at `before`, or after all.
    ///
    /// # Errors
    /// [`TourEditError`]; nothing is changed then.
    pub fn move_before(&mut self, before: usize) -> Result<(), TourEditError> {
        let Range { start, end } = self.selected();
        if start == end || (start..=end).contains(&before) || before > self.tour().steps.len() {
            return Ok(());
        }
        self.edit(None, |now| {
            for i in 0..end - start {
                let (from, to) = if before > end { (start, before - 1) } else { (start + i, before + i) };
                now.text.move_step(from, to)?;
            }
            let start = if before > end { before - (end - start) } else { before };
            now.selected = start..start + now.selected.len();
            Ok(())
        })
    }

    /// Takes the last edit back; whether there was one.
    pub fn undo(&mut self) -> bool {
        let Some(before) = self.undone.pop() else { return false };
        self.redone.push(core::mem::replace(&mut self.now, before));
        self.turn()
    }

    /// Does again what was undone last; whether there was something.
    pub fn redo(&mut self) -> bool {
        let Some(after) = self.redone.pop() else { return false };
        self.undone.push(core::mem::replace(&mut self.now, after));
        self.turn()
    }

    /// Whether there is something to take back, and to do again.
    #[must_use]
    pub fn can(&self) -> (bool, bool) {
        (!self.undone.is_empty(), !self.redone.is_empty())
    }

    fn turn(&mut self) -> bool {
        self.seal();
        self.version += 1;
        true
    }

    /// Makes an edit whole, or not at all.
    fn edit(
        &mut self,
        about: Option<About>,
        edit: impl FnOnce(&mut State) -> Result<(), TourEditError>,
    ) -> Result<(), TourEditError> {
        let before = self.now.clone();
        if let Err(error) = edit(&mut self.now) {
            self.now = before;
            return Err(error);
        }
        let goes_on = about.is_some() && about == self.about;
        if !goes_on {
            self.undone.push(before);
            let surplus = self.undone.len().saturating_sub(MOST_UNDONE);
            self.undone.drain(..surplus);
        }
        self.redone.clear();
        self.about = about;
        self.version += 1;
        Ok(())
    }
}

/// Which setting it is.
const fn name(setting: &TourSetting) -> &'static str {
    match setting {
        TourSetting::Title(_) => "title",
        TourSetting::Translations(_) => "translations",
        TourSetting::City(_) => "city",
        TourSetting::Speed(_) => "speed",
        TourSetting::EyeM(_) => "eye_m",
        TourSetting::FovDeg(_) => "fov_deg",
        TourSetting::Hour(_) => "hour",
        TourSetting::Day(_) => "day",
    }
}

/// How a tour comes to a view.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Approach {
    /// On foot, along streets; through the air to what is higher than a walker.
    #[default]
    Walk,
    /// In a straight line through the air, or on in the curve of the flight before.
    Fly,
    /// Behind a fade.
    Cut,
}

/// The steps that lead to a view from wherever the tour stands before; the first of a tour begins there.
#[must_use]
pub fn steps_to_view(tour: &Tour, view: &Pose, by: Approach) -> Vec<Step> {
    let round = |n: f64, by: f64| libm::round(n * by) / by;
    let at = Where::At(round(view.plan_pos.x, 10.0), round(view.plan_pos.y, 10.0));
    let deg = libm::round(view.heading_deg.rem_euclid(360.0)).rem_euclid(360.0);
    let look = LookAt::Heading { deg, pitch_deg: libm::round(view.pitch_deg) };
    let height_m = round(view.eye_m, 100.0).max(0.2);
    let eye_m = ((height_m - tour.eye_m).abs() > 0.02).then_some(height_m);
    let is_aloft = view.eye_m > WALK_EYE_M;
    if !tour.steps.iter().any(|step| matches!(step, Step::Start { .. })) {
        return vec![Step::Start { at, eye_m, look }];
    }
    match by {
        Approach::Walk if !is_aloft => {
            let turn = Step::Look { at: look, seconds: TURN_S };
            vec![Step::Walk { to: at, via: Vec::new(), speed: None, look: LookAt::Ahead, ease: Default::default() }, turn]
        }
        Approach::Walk | Approach::Fly => {
            let before =
                tour.steps.iter().rev().find_map(|step| if let Step::Fly { speed, .. } = step { Some(*speed) } else { None });
            let (Where::At(x, y), speed) = (at, before.unwrap_or(FLIGHT_M_S)) else { return Vec::new() };
            vec![Step::Fly { through: vec![(x, y, height_m)], speed, look, ease: Default::default() }]
        }
        Approach::Cut => vec![Step::Cut { to: at, eye_m, look, seconds: CUT_S }],
    }
}

/// Steps that begin somewhere, as a recording does, made to go on from where a tour stands: by a cut, or from right there.
#[must_use]
pub fn joined(steps: Vec<Step>, stands: Option<&Pose>) -> Vec<Step> {
    const HERE_M: f64 = 1.0;
    let Some(stands) = stands else { return steps };
    let mut steps = steps.into_iter();
    let first = match steps.next() {
        Some(Step::Start { at, look, .. }) if at.plan_pos().is_some_and(|at| at.distance(stands.plan_pos) < HERE_M) => {
            Some(Step::Look { at: look, seconds: TURN_S })
        }
        Some(Step::Start { at, eye_m, look }) => Some(Step::Cut { to: at, eye_m, look, seconds: CUT_S }),
        first => first,
    };
    first.into_iter().chain(steps).collect()
}

/// Seconds of a turn to a view, metres a second of a flight to one, and seconds of a cut to one, where the tour has none to go by.
const TURN_S: f64 = 1.5;
const FLIGHT_M_S: f64 = 8.0;
const CUT_S: f64 = 1.6;

/// A new step of a kind that is no movement, for a visitor who is here now.
#[must_use]
pub fn new_step(kind: StepKind, tour: &Tour, here: &Pose) -> Step {
    let spoken = Default::default;
    match kind {
        // Tracks are recorded elsewhere: by hand one flies.
        StepKind::Start | StepKind::Walk | StepKind::Fly | StepKind::Track | StepKind::Cut => {
            let by = match kind {
                StepKind::Fly | StepKind::Track => Approach::Fly,
                StepKind::Cut => Approach::Cut,
                _ => Approach::Walk,
            };
            // The first step leads there; what turns to the view in the end is a step of its own.
            steps_to_view(tour, here, by).swap_remove(0)
        }
        StepKind::Look => {
            let deg = libm::round(here.heading_deg.rem_euclid(360.0)).rem_euclid(360.0);
            Step::Look { at: LookAt::Heading { deg, pitch_deg: libm::round(here.pitch_deg) }, seconds: 2.0 }
        }
        StepKind::Wait => Step::Wait { seconds: 2.0 },
        StepKind::Say => Step::Say { text: String::new(), translations: spoken(), seconds: None },
        StepKind::Narrate => {
            Step::Narrate { file: String::new(), files: spoken(), text: String::new(), translations: spoken(), seconds: None }
        }
        StepKind::Sound => Step::Sound { file: None },
        StepKind::Picture => Step::Picture { file: String::new(), caption: String::new(), translations: spoken(), seconds: 6.0 },
        StepKind::Chapter => Step::Chapter { title: String::new(), translations: spoken() },
        StepKind::Mark => Step::Mark { name: String::new() },
        StepKind::Rain => Step::Rain { wet: 1.0, seconds: 5.0 },
        StepKind::Fov => Step::Fov { deg: libm::round(here.fov_deg), seconds: 2.0 },
        StepKind::Time => Step::Time { hour: libm::round(here.hour * 10.0) / 10.0, seconds: 5.0 },
    }
}

/// A step made to last longer or shorter: one that takes seconds takes so many more or fewer, a movement goes at another speed. `None` for
/// what has no length of its own.
#[must_use]
pub fn stretched(step: &Step, speed: f64, from_s: f64, to_s: f64) -> Option<Step> {
    let to_s = (to_s.max(0.0) * 10.0).round() / 10.0;
    let faster = |speed: f64, most: f64| {
        let speed = if to_s > 0.0 { speed * from_s / to_s } else { most };
        (speed * 100.0).round() / 100.0
    };
    let mut next = step.clone();
    match &mut next {
        Step::Wait { seconds } | Step::Look { seconds, .. } | Step::Cut { seconds, .. } => *seconds = to_s,
        Step::Rain { seconds, .. } | Step::Fov { seconds, .. } | Step::Time { seconds, .. } => *seconds = to_s,
        Step::Say { seconds, .. } | Step::Narrate { seconds, .. } => *seconds = Some(to_s),
        Step::Picture { seconds, .. } => *seconds = to_s,
        Step::Walk { speed: own, .. } => *own = Some(faster(own.unwrap_or(speed), 10.0).clamp(0.1, 10.0)),
        Step::Fly { speed, .. } => *speed = faster(*speed, 200.0).clamp(0.1, 200.0),
        Step::Track { keys } if from_s > 0.0 && to_s > 0.0 => keys.iter_mut().for_each(|key| key.0 *= to_s / from_s),
        Step::Track { .. } | Step::Start { .. } | Step::Chapter { .. } | Step::Mark { .. } | Step::Sound { .. } => return None,
    }
    Some(next)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "// A walk.\n(\n  title: \"A walk\", // its name\n  city: \"x\",\n  steps: [\n    // Here it begins.\n    \
                        Start(at: At(0, 0)),\n    Wait(seconds: 1), // a\n    Wait(seconds: 2), // b\n    Wait(seconds: 3), // c\n    \
                        Wait(seconds: 4), // d\n  ],\n)\n";

    fn edit() -> TourEdit {
        TourEdit::open(TourText::parse(TEXT, "a.tour.ron").expect("no mistakes"))
    }

    fn waits(edit: &TourEdit) -> Vec<f64> {
        edit.tour().steps.iter().filter_map(|step| if let Step::Wait { seconds } = step { Some(*seconds) } else { None }).collect()
    }

    #[test]
    fn steps_move_with_their_comments_whichever_way() {
        for (selected, before, order) in [
            (1..2, 5, [2.0, 3.0, 4.0, 1.0]),
            (1..3, 5, [3.0, 4.0, 1.0, 2.0]),
            (3..5, 1, [3.0, 4.0, 1.0, 2.0]),
            (2..4, 5, [1.0, 4.0, 2.0, 3.0]),
            (4..5, 2, [1.0, 4.0, 2.0, 3.0]),
            (2..3, 3, [1.0, 2.0, 3.0, 4.0]),
        ] {
            let mut edit = edit();
            edit.select(selected.clone());
            let taken = edit.tour().steps[selected.clone()].to_vec();
            edit.move_before(before).expect("there are such steps");
            assert_eq!(waits(&edit), order, "{selected:?} before {before}");
            assert_eq!(edit.tour().steps[edit.selected()], taken, "{selected:?} before {before}: what was selected is");
            for (n, letter) in [(1, "a"), (2, "b"), (3, "c"), (4, "d")] {
                assert!(edit.text().contains(&format!("Wait(seconds: {n}), // {letter}")), "{}", edit.text());
            }
            assert!(edit.text().starts_with("// A walk.\n") && edit.text().contains("// Here it begins."));
        }
    }

    #[test]
    fn every_edit_is_undone_and_done_again() {
        let mut edit = edit();
        let mut texts = vec![edit.text().to_owned()];
        let mut did = |edit: &mut TourEdit, made: Result<(), TourEditError>| {
            made.expect("it can be made");
            texts.push(edit.text().to_owned());
        };
        edit.select(1..3);
        let made = edit.duplicate();
        did(&mut edit, made);
        let made = edit.remove();
        did(&mut edit, made);
        let made = edit.set(TourSetting::Title("B".into()));
        did(&mut edit, made);
        let made = edit.move_before(0);
        did(&mut edit, made);
        let made = edit.insert(&[Step::Mark { name: "bells".into() }]);
        did(&mut edit, made);
        assert!(texts.windows(2).all(|pair| pair[0] != pair[1]), "each did something");
        for text in texts.iter().rev().skip(1) {
            assert!(edit.undo());
            assert_eq!(edit.text(), text);
        }
        assert!(!edit.undo() && edit.can() == (false, true) && !edit.is_unsaved());
        for text in texts.iter().skip(1) {
            assert!(edit.redo());
            assert_eq!(edit.text(), text);
        }
        assert!(!edit.redo() && edit.is_unsaved());
    }

    #[test]
    fn a_drag_is_undone_as_one() {
        let mut edit = edit();
        for tenths in 1..50 {
            edit.replace(2, &Step::Wait { seconds: f64::from(tenths) / 10.0 }).expect("there is such a step");
        }
        edit.seal();
        edit.replace(2, &Step::Wait { seconds: 9.0 }).expect("there is such a step");
        assert!(edit.undo());
        assert_eq!(waits(&edit), [1.0, 4.9, 3.0, 4.0]);
        assert!(edit.undo());
        assert_eq!((edit.text(), edit.can().0), (TEXT, false));
    }

    #[test]
    fn what_was_cut_can_be_pasted_and_what_is_no_steps_not() {
        let mut edit = edit();
        edit.select(1..3);
        let copy = edit.copy();
        assert!(copy.contains("Wait(seconds: 1), // a") && copy.contains("Wait(seconds: 2), // b"), "{copy}");
        edit.remove().expect("they are there");
        assert_eq!((waits(&edit), edit.selected()), (vec![3.0, 4.0], 1..2));
        edit.select(2..3);
        edit.paste(&copy).expect("it is steps");
        assert_eq!((waits(&edit), edit.selected()), (vec![3.0, 4.0, 1.0, 2.0], 3..5));
        let before = (edit.text().to_owned(), edit.version());
        assert!(edit.paste("Dear diary").is_err() && edit.paste("").is_err());
        assert_eq!((edit.text(), edit.version()), (before.0.as_str(), before.1));
    }

    #[test]
    fn a_new_tour_is_unsaved_once_it_has_a_step() {
        let tour = Tour { title: "New".into(), city: "x".into(), speed: 1.4, ..tour() };
        let mut edit = TourEdit::begin(&tour).expect("it can be written");
        assert!(!edit.is_unsaved() && edit.selected().is_empty());
        let view = Pose { plan_pos: (3.04, 4.0).into(), eye_m: 1.65, heading_deg: 359.8, fov_deg: 55.0, ..Pose::default() };
        for by in [Approach::Walk, Approach::Walk, Approach::Fly, Approach::Cut] {
            let steps = steps_to_view(edit.tour(), &view, by);
            edit.insert(&steps).expect("they can be written");
        }
        let kinds: Vec<StepKind> = edit.tour().steps.iter().map(StepKind::of).collect();
        assert_eq!(kinds, [StepKind::Start, StepKind::Walk, StepKind::Look, StepKind::Fly, StepKind::Cut]);
        assert_eq!(edit.tour().steps[0], Step::Start { at: Where::At(3.0, 4.0), eye_m: None, look: north() });
        assert!(edit.is_unsaved());
        edit.keep(edit.text().to_owned());
        assert!(!edit.is_unsaved());
    }

    fn north() -> LookAt {
        LookAt::Heading { deg: 0.0, pitch_deg: 0.0 }
    }

    fn tour() -> Tour {
        veduta_city::file::parse(TEXT, "a.tour.ron").map(|tour| Tour { steps: Vec::new(), ..tour }).expect("no mistakes")
    }

    #[test]
    fn a_recording_goes_on_from_where_the_tour_stands() {
        let steps = vec![Step::Start { at: Where::At(3.0, 4.0), eye_m: None, look: north() }, Step::Wait { seconds: 1.0 }];
        assert_eq!(joined(steps.clone(), None), steps);
        let near = Pose { plan_pos: (3.5, 4.0).into(), ..Pose::default() };
        assert!(matches!(joined(steps.clone(), Some(&near))[..], [Step::Look { .. }, Step::Wait { .. }]));
        let far = Pose { plan_pos: (9.0, 4.0).into(), ..Pose::default() };
        assert!(matches!(joined(steps, Some(&far))[..], [Step::Cut { .. }, Step::Wait { .. }]));
    }

    #[test]
    fn who_stands_high_is_flown_to() {
        let tour = Tour { steps: vec![Step::Start { at: Where::At(0.0, 0.0), eye_m: None, look: north() }], ..tour() };
        let view = Pose { plan_pos: (3.0, 4.0).into(), eye_m: 30.0, ..Pose::default() };
        let steps = steps_to_view(&tour, &view, Approach::Walk);
        assert!(matches!(&steps[..], [Step::Fly { through, .. }] if *through == [(3.0, 4.0, 30.0)]), "{steps:?}");
        let kinds =
            [StepKind::Walk, StepKind::Fly, StepKind::Cut, StepKind::Look, StepKind::Wait, StepKind::Say, StepKind::Chapter];
        for kind in kinds.into_iter().chain([StepKind::Mark, StepKind::Rain, StepKind::Fov, StepKind::Time]) {
            let low = Pose { eye_m: 1.65, ..view };
            assert_eq!(StepKind::of(&new_step(kind, &tour, &low)), kind);
        }
    }

    #[test]
    fn a_movement_made_longer_is_slower() {
        let walk =
            Step::Walk { to: Where::At(9.0, 0.0), via: Vec::new(), speed: None, look: LookAt::Ahead, ease: Default::default() };
        let Some(Step::Walk { speed, .. }) = stretched(&walk, 1.4, 10.0, 20.0) else { panic!("a walk has a length") };
        assert_eq!(speed, Some(0.7));
        let Some(Step::Walk { speed, .. }) = stretched(&walk, 1.4, 10.0, 0.0) else { panic!("a walk has a length") };
        assert_eq!(speed, Some(10.0), "as fast as may be");
        assert_eq!(stretched(&Step::Wait { seconds: 3.0 }, 1.4, 3.0, 4.26), Some(Step::Wait { seconds: 4.3 }));
        assert_eq!(stretched(&Step::Mark { name: "x".into() }, 1.4, 0.0, 4.0), None);
    }
}
