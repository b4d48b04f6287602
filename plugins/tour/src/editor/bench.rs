//! What the editor's windows show.

use bevy_egui::egui::Color32;
use veduta_ecs::{PlaceNames, Words};
use veduta_route::{Approach, Pose, Sketch, StepKind, TourEdit, TourError};
use veduta_ui::Look;

use super::act::Act;
use crate::streets::Streets;

/// All that the windows know of a frame.
#[derive(Clone, Copy)]
pub(super) struct Bench<'a> {
    pub look: Look,
    pub words: &'a Words,
    pub names: &'a PlaceNames,
    pub edit: &'a TourEdit,
    pub sketch: &'a Sketch,
    pub streets: Option<&'a Streets>,
    /// Where the visitor is.
    pub here: Pose,
    /// Second of the tour that is shown.
    pub t_s: f64,
    pub is_playing: bool,
    pub is_recording: bool,
    pub approach: Approach,
    pub notice: &'a str,
    pub can_save: bool,
    pub can_copy: bool,
    /// Whether somebody else has changed the file.
    pub is_changed_elsewhere: bool,
}

impl Bench<'_> {
    /// A message.
    pub fn say(&self, message: &str) -> String {
        self.words.say(message)
    }

    /// When a step plays, seconds: from and to.
    pub fn span(&self, step: usize) -> Option<(f64, f64)> {
        let span = self.sketch.tour.as_ref()?.steps().iter().find(|span| span.index == step)?;
        Some((span.start_s, span.end_s))
    }

    /// Length of the tour, seconds.
    pub fn whole_s(&self) -> f64 {
        self.sketch.tour.as_ref().map_or(0.0, veduta_route::CompiledTour::duration_s)
    }

    /// What is wrong with a step, or with the tour as a whole.
    pub fn mistake(&self, step: Option<usize>) -> Option<String> {
        let (_, error) = self.sketch.mistakes.iter().find(|(index, _)| *index == step)?;
        Some(match error {
            TourError::Step { problem, .. } => problem.to_string(),
            other => other.to_string(),
        })
    }

    /// The one step that is selected.
    pub fn step(&self) -> Option<usize> {
        let selected = self.edit.selected();
        (selected.len() == 1).then_some(selected.start)
    }
}

/// What was done in the windows.
pub(super) type Acts = Vec<Act>;

/// Colour of a step's block by its kind; white letters can be read on all of them.
pub(super) const fn colour(kind: StepKind) -> Color32 {
    match kind {
        StepKind::Start | StepKind::Cut => Color32::from_rgb(0x5B, 0x53, 0x4A),
        StepKind::Walk => Color32::from_rgb(0x3F, 0x6B, 0x46),
        StepKind::Fly | StepKind::Track => Color32::from_rgb(0x2F, 0x62, 0x8E),
        StepKind::Look => Color32::from_rgb(0x7A, 0x4F, 0x86),
        StepKind::Wait => Color32::from_rgb(0x6F, 0x67, 0x5C),
        StepKind::Say | StepKind::Narrate | StepKind::Sound | StepKind::Picture => Color32::from_rgb(0x8A, 0x5A, 0x1E),
        StepKind::Chapter | StepKind::Mark => Color32::from_rgb(0x9C, 0x3B, 0x2E),
        StepKind::Rain | StepKind::Fov | StepKind::Time => Color32::from_rgb(0x2C, 0x6C, 0x70),
    }
}

/// Message that names a kind of steps.
pub(super) const fn kind_name(kind: StepKind) -> &'static str {
    match kind {
        StepKind::Start => "step-start",
        StepKind::Walk => "step-walk",
        StepKind::Fly => "step-fly",
        StepKind::Track => "step-track",
        StepKind::Look => "step-look",
        StepKind::Wait => "step-wait",
        StepKind::Say => "step-say",
        StepKind::Narrate => "step-narrate",
        StepKind::Sound => "step-sound",
        StepKind::Picture => "step-picture",
        StepKind::Chapter => "step-chapter",
        StepKind::Mark => "step-mark",
        StepKind::Rain => "step-rain",
        StepKind::Fov => "step-fov",
        StepKind::Time => "step-time",
        StepKind::Cut => "step-cut",
    }
}
