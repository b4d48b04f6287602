//! What the editor asks before something would be lost.

use bevy_egui::egui::{Key, Ui};
use veduta_ecs::Words;
use veduta_ui::{Look, Surface};

/// What happens when the tour under edit goes away.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Then {
    /// The editor closes.
    Close,
    /// The program ends.
    Leave,
    /// A new tour is begun.
    New,
    /// Another is opened.
    Open(String),
}

/// A question.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Question {
    /// The tour is not saved; what would come then.
    Unsaved(Then),
    /// Its file has another text now.
    Changed(String),
    /// A new tour's file is there already.
    Taken(String),
}

/// An answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Answer {
    /// Save first; or write over what is there.
    Save,
    /// Lose it; or take what is in the file.
    Drop,
    /// Take another name.
    Beside,
    /// Do nothing of the kind.
    Stay,
}

/// Asks; an answer, or nothing yet.
pub(super) fn show(ui: &mut Ui, look: &Look, words: &Words, question: &Question, can_save: bool) -> Option<Answer> {
    let surface = Surface::Paper;
    look.dress(ui, surface);
    ui.set_max_width(look.text * 30.0);
    let (message, detail) = match question {
        Question::Unsaved(_) => ("editor-ask-unsaved", ""),
        Question::Changed(_) => ("editor-ask-changed", ""),
        Question::Taken(path) => ("editor-ask-taken", path.as_str()),
    };
    ui.label(look.words(words.say(message), 1.15, look.ink(surface)));
    if !detail.is_empty() {
        ui.label(look.words(detail, 1.0, look.accent(surface)));
    }
    let answers: &[(&str, Answer)] = match question {
        Question::Unsaved(_) if can_save => &[("editor-save", Answer::Save), ("editor-drop", Answer::Drop)],
        Question::Unsaved(_) => &[("editor-drop", Answer::Drop)],
        Question::Changed(_) => &[("editor-overwrite", Answer::Save), ("editor-take-other", Answer::Drop)],
        Question::Taken(_) => &[("editor-beside", Answer::Beside), ("editor-overwrite", Answer::Save)],
    };
    let mut answer = None;
    ui.horizontal_wrapped(|ui| {
        for &(message, is) in answers.iter().chain(&[("editor-stay", Answer::Stay)]) {
            if ui.button(words.say(message)).clicked() {
                answer = Some(is);
            }
        }
    });
    if ui.input(|input| input.key_pressed(Key::Escape)) {
        answer = Some(Answer::Stay);
    }
    answer
}
