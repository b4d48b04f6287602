//! What is done to a tour, and to the editor.

use core::ops::Range;

use bevy::prelude::*;
use veduta_city::{Step, TourSetting};
use veduta_ecs::{CityClock, Eye, Steering, Viewer, Words};
use veduta_route::{Approach, Pose, StepKind, new_step, steps_to_view};

use super::ask::Then;
use super::prepare::Jobs;
use super::record::Recorder;
use super::{EditorCommand, EditorLeft, EditorSettings, TourEditor};
use crate::play::pose_of;
use crate::{TourCommand, TourPlayer, TourState};

/// What was done in a window.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Act {
    /// Selects steps; nothing selects the tour itself.
    Select(Range<usize>),
    /// Selects steps, and shows where the first begins.
    Visit(Range<usize>),
    /// Goes to a second.
    Seek(f64),
    Replace(usize, Step),
    Set(TourSetting),
    Add(StepKind),
    AddView,
    Approach(Approach),
    Remove,
    Duplicate,
    Cut,
    Copy,
    Paste,
    MoveBefore(usize),
    Undo,
    Redo,
    /// A drag or a field has been let go.
    Seal,
    /// Plays from the selected step, or pauses.
    Play,
    Record,
    Save,
    SaveAs,
    CopyText,
    /// Takes the file's text, changed by somebody else.
    TakeOther,
    /// Leaves it to be written over.
    KeepMine,
    Close,
}

impl TourEditor {
    /// Does what concerns the tour alone; whether that was all.
    pub(super) fn edit(&mut self, act: &Act, here: &Pose) -> bool {
        let Self { document: Some(document), clipboard, approach, notice, .. } = self else { return false };
        let edit = &mut document.edit;
        let made = match act {
            Act::Select(steps) => {
                edit.select(steps.clone());
                Ok(())
            }
            Act::Replace(index, step) => edit.replace(*index, step),
            Act::Set(setting) => edit.set(setting.clone()),
            Act::Add(kind) => edit.insert(&[new_step(*kind, edit.tour(), here)]),
            Act::AddView => edit.insert(&steps_to_view(edit.tour(), here, *approach)),
            Act::Approach(by) => {
                *approach = *by;
                Ok(())
            }
            Act::Remove => edit.remove(),
            Act::Duplicate => edit.duplicate(),
            Act::Cut => {
                *clipboard = edit.copy();
                edit.remove()
            }
            Act::Copy => {
                *clipboard = edit.copy();
                Ok(())
            }
            Act::Paste if clipboard.is_empty() => Ok(()),
            Act::Paste => edit.paste(clipboard),
            Act::MoveBefore(before) => edit.move_before(*before),
            Act::Undo | Act::Redo => {
                _ = if *act == Act::Undo { edit.undo() } else { edit.redo() };
                Ok(())
            }
            Act::Seal => {
                edit.seal();
                Ok(())
            }
            _ => return false,
        };
        match made {
            Ok(()) if matches!(act, Act::Select(_) | Act::Seal) => {}
            Ok(()) => notice.clear(),
            Err(error) => *notice = error.to_string(),
        }
        true
    }

    /// Second at which a step begins.
    pub(super) fn start_s(&self, step: usize) -> Option<f64> {
        let tour = self.document.as_ref()?.sketch.tour.as_ref()?;
        tour.steps().iter().find(|span| span.index == step).map(|span| span.start_s)
    }
}

/// Obeys commands.
pub(super) fn command(
    mut commands: MessageReader<EditorCommand>,
    mut tours: MessageReader<TourCommand>,
    (mut editor, mut recorder, mut jobs): (ResMut<TourEditor>, ResMut<Recorder>, ResMut<Jobs>),
    (settings, words, clock): (Res<EditorSettings>, Res<Words>, Res<CityClock>),
    time: Res<Time>,
    viewers: Query<&Eye, With<Viewer>>,
    (mut player, mut steering): (ResMut<TourPlayer>, ResMut<Steering>),
    mut left: MessageWriter<EditorLeft>,
) {
    for command in tours.read() {
        let Some(document) = editor.document.as_mut().filter(|_| !player.is_edited) else { continue };
        // What is under edit is shown, whatever else was asked for.
        document.sketched = None;
        match command {
            TourCommand::Open(path) => editor.want(Then::Open(path.clone())),
            TourCommand::Give(_) | TourCommand::Stop => {}
            _ => continue,
        }
        player.forget();
        player.is_edited = true;
    }
    let here = viewers.iter().next().map(|eye| pose_of(eye, clock.hour));
    for command in commands.read() {
        match command {
            EditorCommand::Open => open(&mut editor, &mut player, &settings, &words, &clock),
            EditorCommand::Toggle if editor.is_open => editor.want(Then::Close),
            EditorCommand::Toggle => open(&mut editor, &mut player, &settings, &words, &clock),
            EditorCommand::New => {
                editor.is_open = true;
                editor.want(Then::New);
            }
            EditorCommand::Record if recorder.is_on() => {
                let recording = recorder.end();
                if !recording.is_empty() {
                    if !editor.is_open {
                        editor.is_open = true;
                        editor.begin(&settings, words.say("editor-untitled"), &clock);
                        player.forget();
                        player.is_edited = true;
                    }
                    jobs.recorded = Some(recording);
                }
            }
            EditorCommand::Record => {
                recorder.begin(time.elapsed_secs_f64());
                // It is the visitor's own walk.
                if *steering == Steering::Guided {
                    *steering = Steering::Visitor;
                }
            }
            EditorCommand::AddView => {
                if let Some(here) = here.filter(|_| editor.is_open) {
                    editor.edit(&Act::AddView, &here);
                }
            }
            EditorCommand::Close if editor.is_open => editor.want(Then::Close),
            EditorCommand::Close => {}
            EditorCommand::Leave if editor.is_unsaved() => editor.want(Then::Leave),
            EditorCommand::Leave => _ = left.write(EditorLeft),
        }
    }
}

/// Opens the editor with the tour that is open: its file's text, once that is here; the value that was given; else a new one.
fn open(editor: &mut TourEditor, player: &mut TourPlayer, settings: &EditorSettings, words: &Words, clock: &CityClock) {
    if editor.is_open {
        return;
    }
    editor.is_open = true;
    editor.notice.clear();
    player.play_when_ready = false;
    if player.state() == TourState::Playing {
        player.state = TourState::Paused;
    }
    if player.handle.is_some() {
        return;
    }
    match player.given.take() {
        Some(tour) => editor.adopt(&tour),
        None => editor.begin(settings, words.say("editor-untitled"), clock),
    }
    player.is_edited = true;
}
