//! The editor's keys.

use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{self, Key, KeyboardShortcut, Modifiers};
use veduta_controls::Presses;
use veduta_ecs::Interface;

use super::EditorCommand;
use super::act::Act;
use crate::controls::{TourEdit, TourRecord, TourView};

/// Obeys the controls of the editor.
pub(super) fn read(presses: Presses<'_, '_>, mut commands: MessageWriter<EditorCommand>) {
    let asked = [
        (presses.begins::<TourRecord>(), EditorCommand::Record),
        (presses.begins::<TourEdit>(), EditorCommand::Toggle),
        (presses.begins::<TourView>(), EditorCommand::AddView),
    ];
    commands.write_batch(asked.into_iter().filter(|(begins, _)| *begins).map(|(_, command)| command));
}

/// Keys that are pressed with a command key, and whether they mean letters where somebody types.
static SHORTCUTS: [(Modifiers, Key, bool, Act); 12] = [
    (Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::S, false, Act::SaveAs),
    (Modifiers::COMMAND, Key::S, false, Act::Save),
    (Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z, true, Act::Redo),
    (Modifiers::COMMAND, Key::Z, true, Act::Undo),
    (Modifiers::COMMAND, Key::Y, true, Act::Redo),
    (Modifiers::COMMAND, Key::X, true, Act::Cut),
    (Modifiers::COMMAND, Key::C, true, Act::Copy),
    (Modifiers::COMMAND, Key::V, true, Act::Paste),
    (Modifiers::COMMAND, Key::D, true, Act::Duplicate),
    (Modifiers::NONE, Key::Delete, true, Act::Remove),
    (Modifiers::ALT, Key::ArrowUp, true, Act::MoveBefore(0)),
    (Modifiers::ALT, Key::ArrowDown, true, Act::MoveBefore(1)),
];

/// What was asked for by a key, with the steps that are selected; moves are by one.
pub(super) fn shortcut(context: &egui::Context, selected: &core::ops::Range<usize>) -> Option<Act> {
    let is_writing = context.text_edit_focused();
    let pressed = SHORTCUTS.iter().find(|(modifiers, key, is_letter, _)| {
        let shortcut = KeyboardShortcut::new(*modifiers, *key);
        !(*is_letter && is_writing) && context.input_mut(|input| input.consume_shortcut(&shortcut))
    });
    Some(match pressed?.3.clone() {
        Act::MoveBefore(0) => Act::MoveBefore(selected.start.checked_sub(1)?),
        Act::MoveBefore(_) => Act::MoveBefore(selected.end + 1),
        act => act,
    })
}

/// Keys that are pressed with a command key move nobody.
pub(super) fn rest(mut contexts: EguiContexts, mut interface: ResMut<Interface>) {
    let Ok(context) = contexts.ctx_mut() else { return };
    let is_command = context.input(|input| {
        input.modifiers.command && SHORTCUTS.iter().any(|(_, key, ..)| input.key_down(*key) || input.key_pressed(*key))
            || input.modifiers.alt && (input.key_down(Key::ArrowUp) || input.key_down(Key::ArrowDown))
    });
    if is_command && !interface.is_typing {
        interface.is_typing = true;
    }
}
