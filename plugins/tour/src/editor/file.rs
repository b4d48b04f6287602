//! Saving: by whoever owns files, who is asked and answers by messages.

use bevy::prelude::*;
use veduta_ecs::Words;
use veduta_route::TourEdit;

use super::ask::{Question, Then};
use super::{Document, EditorLeft, EditorSettings, TourEditor};
use crate::{TourAsset, TourPlayer};

/// Asks whoever owns files to keep a tour; [`TourSaved`] answers.
#[derive(Message, Debug, Clone, PartialEq, Eq)]
pub struct SaveTour {
    /// The path by which it was opened or saved before; for a new tour `None`: a name is made of its title.
    pub path: Option<String>,
    /// The tour's title.
    pub title: String,
    /// The text to be written as it is.
    pub text: String,
    /// What to do with a file that is there.
    pub how: SaveHow,
}

/// What to do with a file that is there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SaveHow {
    /// Write over this text, and no other.
    Over(String),
    /// Write over nothing.
    New,
    /// Write over whatever is there.
    Replace,
    /// Leave it and take a name that is free.
    Beside,
}

/// How a [`SaveTour`] ended.
#[derive(Message, Debug, Clone, PartialEq, Eq)]
pub enum TourSaved {
    /// It is kept.
    Done {
        /// The path by which it can be opened.
        path: String,
        /// What was written.
        text: String,
    },
    /// The file has a text that was not expected; nothing was written.
    Changed {
        /// That text.
        text: String,
    },
    /// A new tour's file is there already; nothing was written.
    Taken {
        /// Its path.
        path: String,
    },
    /// It could not be written.
    Failed {
        /// Why, with the file.
        message: String,
    },
}

impl TourEditor {
    /// Asks for the tour to be saved.
    pub(super) fn save(&mut self, as_new: bool, how: Option<SaveHow>, saves: &mut MessageWriter<SaveTour>) {
        let Some(document) = &mut self.document else { return };
        document.edit.seal();
        let path = document.path.clone().filter(|_| !as_new);
        let usual = match (&path, document.edit.kept()) {
            (Some(_), Some(kept)) => SaveHow::Over(kept.to_owned()),
            _ => SaveHow::New,
        };
        let tour = document.edit.tour();
        saves.write(SaveTour { path, title: tour.title.clone(), text: document.edit.text().to_owned(), how: how.unwrap_or(usual) });
    }

    /// Does something for which the tour under edit goes away, after asking about what is not saved.
    pub(super) fn want(&mut self, then: Then) {
        self.then = None;
        if self.is_unsaved() { self.question = Some(Question::Unsaved(then)) } else { self.then = Some(then) }
    }
}

/// Takes the answer of whoever owns files, and does what had waited for it.
pub(super) fn answer(
    mut answers: MessageReader<TourSaved>,
    (mut editor, settings, words): (ResMut<TourEditor>, Res<EditorSettings>, Res<Words>),
    clock: Res<veduta_ecs::CityClock>,
    assets: Res<AssetServer>,
    mut player: ResMut<TourPlayer>,
    mut left: MessageWriter<EditorLeft>,
) {
    for answer in answers.read() {
        let editor = &mut *editor;
        let Some(document) = &mut editor.document else { continue };
        match answer {
            TourSaved::Done { path, text } => {
                document.edit.keep(text.clone());
                document.path = Some(path.clone());
                document.on_disk = None;
                editor.notice = words.say("editor-saved");
                // From now on its file is watched.
                player.handle = Some(assets.load(path.clone()));
                if let Some(Question::Unsaved(then)) = editor.question.take_if(|question| matches!(question, Question::Unsaved(_)))
                {
                    editor.then = Some(then);
                }
            }
            TourSaved::Changed { text } => editor.question = Some(Question::Changed(text.clone())),
            TourSaved::Taken { path } => editor.question = Some(Question::Taken(path.clone())),
            TourSaved::Failed { message } => {
                editor.notice.clone_from(message);
                editor.question = None;
            }
        }
    }
    if editor.then.is_some()
        && let Some(then) = editor.then.take()
    {
        match then {
            Then::Close => close(&mut editor, &mut player),
            Then::Leave => _ = left.write(EditorLeft),
            Then::New => {
                player.forget();
                editor.begin(&settings, words.say("editor-untitled"), &clock);
                player.is_edited = true;
            }
            Then::Open(path) => {
                player.forget();
                editor.document = None;
                player.handle = Some(assets.load(path));
            }
        }
    }
}

/// Closes the windows. The player keeps what was saved; what was not is forgotten.
fn close(editor: &mut TourEditor, player: &mut TourPlayer) {
    editor.is_open = false;
    player.is_edited = false;
    let Some(document) = editor.document.take() else { return };
    if document.edit.is_unsaved() {
        // Played again as it is kept, if it is.
        player.source = document.edit.kept().and_then(|kept| veduta_city::file::parse(kept, "").ok());
        if player.source.is_none() {
            player.forget();
        }
    }
}

/// Opens the text of the player's tour once it has come, and sees when it changes under the editor's hands.
pub(super) fn watch(
    mut events: MessageReader<AssetEvent<TourAsset>>,
    assets: Res<Assets<TourAsset>>,
    words: Res<Words>,
    mut player: ResMut<TourPlayer>,
    mut editor: ResMut<TourEditor>,
) {
    let Some(handle) = player.handle.clone() else {
        events.clear();
        return;
    };
    let is_new = editor.document.is_none();
    let has_changed = events.read().any(|event| matches!(event, AssetEvent::Modified { id } if *id == handle.id()));
    if !(is_new || has_changed) {
        return;
    }
    let (Some(asset), Some(path)) = (assets.get(&handle), handle.path()) else { return };
    let editor = &mut *editor;
    match &mut editor.document {
        Some(document) if document.edit.kept() == Some(asset.text.as_str()) || document.edit.text() == asset.text => {
            document.edit.keep(asset.text.clone());
            document.on_disk = None;
        }
        Some(document) if document.edit.is_unsaved() => document.on_disk = Some(asset.text.clone()),
        document => match Document::parse(&asset.text, &path.to_string()) {
            Ok(opened) => {
                *document = Some(opened);
                player.is_edited = true;
                editor.notice = if is_new { String::new() } else { words.say("editor-reloaded") };
            }
            Err(mistake) => editor.notice = mistake.to_string(),
        },
    }
}

impl TourEditor {
    /// Takes the text that somebody else has put into the file, in place of what is under edit.
    pub(super) fn take_other(&mut self, text: &str) {
        let Some(document) = &mut self.document else { return };
        match Document::parse(text, document.path.as_deref().unwrap_or_default()) {
            Ok(opened) => *document = opened,
            Err(mistake) => self.notice = mistake.to_string(),
        }
    }

    /// Edits a tour that was given as a value and is in no file.
    pub(super) fn adopt(&mut self, tour: &veduta_city::Tour) {
        if let Ok(edit) = TourEdit::begin(tour) {
            self.document = Some(Document::new(edit, None));
        }
    }
}
