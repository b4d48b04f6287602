//! The editor of tours: records walks, takes views, arranges steps, and hands tours to whoever keeps files.
//!
//! ```text
//!  Recorder ─ steps ─┐                       ┌─► TourPlayer: preview, path on the map
//!  the eye ─ views ──┼─► TourEdit ─ sketch ──┤
//!  windows ─ acts ───┘      │                └─► list, timeline, fields, marks in the picture
//!                           └─ SaveTour ──► whoever owns files ──► TourSaved
//! ```

mod act;
mod ask;
mod bench;
mod draw;
mod fields;
mod file;
mod keys;
mod label;
mod list;
mod marks;
mod prepare;
mod record;
mod speech;
mod spots;
#[cfg(test)]
mod tests;
mod timeline;
mod transport;

use std::sync::Arc;

use bevy::prelude::*;
use bevy_egui::EguiPrimaryContextPass;
use veduta_city::{Tour, TourText, Viewpoint, file::SyntaxError};
use veduta_controls::ControlsSystems;
use veduta_ecs::{CityClock, InterfaceSystems, VedutaSystems};
use veduta_route::{Approach, Sketch, TourEdit};
use veduta_ui::UiSystems;

use crate::streets::Streets;
use ask::{Question, Then};

pub use file::{SaveHow, SaveTour, TourSaved};
pub use record::Recorder;

/// What to do with the editor.
#[derive(Message, Debug, Clone, PartialEq, Eq)]
pub enum EditorCommand {
    /// Open it: with the tour that is open, else with a new one.
    Open,
    /// Open it, or close it.
    Toggle,
    /// Begin a new tour.
    New,
    /// Begin to record the visitor's walk, or end it: it becomes steps after those that are selected.
    Record,
    /// Put the present view after the selected step.
    AddView,
    /// Close it, after asking about what is not saved.
    Close,
    /// Somebody wants to end the program: [`EditorLeft`] follows at once, or after the visitor was asked about what is not saved.
    Leave,
}

/// Nothing is left to save: the program may end.
#[derive(Message, Debug, Clone, Copy, PartialEq, Eq)]
pub struct EditorLeft;

/// How the editor begins and saves tours. Live.
#[derive(Resource, Debug, Clone, PartialEq, Eq, Default)]
pub struct EditorSettings {
    /// What new tours name as their city, as [`Tour::city`] has it.
    pub city: String,
    /// Whether somebody reads [`SaveTour`] and answers it.
    pub can_save: bool,
    /// Whether what is copied comes to the clipboard: `bevy_egui` has the feature `manage_clipboard`.
    pub can_copy: bool,
}

/// The editor of tours. It costs nothing while it is closed.
#[derive(Resource, Default)]
pub struct TourEditor {
    is_open: bool,
    document: Option<Document>,
    streets: Option<Arc<Streets>>,
    /// What the visitor is asked.
    question: Option<Question>,
    /// What is done once the tour is saved.
    then: Option<Then>,
    clipboard: String,
    /// How views are come to.
    approach: Approach,
    time: timeline::TimeView,
    notice: String,
    /// The step that was scrolled to in the list.
    listed: Option<usize>,
}

/// A tour under edit.
struct Document {
    edit: TourEdit,
    /// The path by which it was opened or saved.
    path: Option<String>,
    sketch: Arc<Sketch>,
    /// The version of the edit that the sketch is of.
    sketched: Option<u64>,
    /// Its file's text, where that has been changed by somebody else.
    on_disk: Option<String>,
}

impl Document {
    fn new(edit: TourEdit, path: Option<String>) -> Self {
        Self { edit, path, sketch: Arc::default(), sketched: None, on_disk: None }
    }

    fn parse(text: &str, path: &str) -> Result<Self, SyntaxError> {
        Ok(Self::new(TourEdit::open(TourText::parse(text, path)?), Some(path.to_owned())))
    }
}

impl TourEditor {
    /// Whether it is open.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.is_open
    }

    /// The tour under edit.
    #[must_use]
    pub fn tour(&self) -> Option<&Tour> {
        self.document.as_ref().map(|document| document.edit.tour())
    }

    /// Its text.
    #[must_use]
    pub fn text(&self) -> Option<&str> {
        self.document.as_ref().map(|document| document.edit.text())
    }

    /// Whether something would be lost if it were closed without saving.
    #[must_use]
    pub fn is_unsaved(&self) -> bool {
        self.document.as_ref().is_some_and(|document| document.edit.is_unsaved())
    }

    fn begin(&mut self, settings: &EditorSettings, title: String, clock: &CityClock) {
        let tour = Tour {
            title,
            city: settings.city.clone(),
            speed: 1.4,
            eye_m: Viewpoint::default_eye_m(),
            fov_deg: 55.0,
            hour: (clock.hour * 10.0).round() / 10.0,
            day: clock.day,
            ..Tour::default()
        };
        // An hour that is no number has no text; nothing else can go wrong.
        if let Ok(edit) = TourEdit::begin(&tour) {
            self.document = Some(Document::new(edit, None));
        }
    }
}

/// Registers the editor; its windows too where there are any.
pub(crate) fn build(app: &mut App) {
    app.init_resource::<TourEditor>()
        .init_resource::<EditorSettings>()
        .init_resource::<Recorder>()
        .init_resource::<prepare::Jobs>()
        .add_message::<EditorCommand>()
        .add_message::<EditorLeft>()
        .add_message::<SaveTour>()
        .add_message::<TourSaved>()
        .add_systems(
            Update,
            (act::command, file::answer, file::watch.run_if(is_open), prepare::ask_streets, prepare::run.run_if(is_busy))
                .chain()
                .after(crate::ready::compile_tour)
                .before(crate::play::play)
                .in_set(VedutaSystems::Steer),
        )
        .add_systems(Update, record::note.after(VedutaSystems::Steer).run_if(record::is_on));
}

/// Its windows and keys.
pub(crate) fn build_windows(app: &mut App) {
    let before_keys = keys::rest.run_if(is_open).after(InterfaceSystems::Watch).before(ControlsSystems::Sense);
    app.add_systems(Update, keys::read)
        .add_systems(PreUpdate, before_keys)
        .add_systems(EguiPrimaryContextPass, draw::draw_recorder.run_if(record::is_on).in_set(UiSystems::Draw))
        .add_systems(EguiPrimaryContextPass, (draw::dock, draw::draw.run_if(is_open)).chain().before(UiSystems::Draw));
}

fn is_open(editor: Res<TourEditor>) -> bool {
    editor.is_open
}

fn is_busy(editor: Res<TourEditor>, jobs: Res<prepare::Jobs>) -> bool {
    editor.is_open || jobs.is_busy()
}
