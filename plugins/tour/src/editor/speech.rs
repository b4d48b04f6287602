//! Words of a tour in its own language and in others.

use std::collections::BTreeMap;

use bevy_egui::egui::{TextEdit, Ui};
use veduta_ui::Surface;

use super::bench::Bench;

/// Names of languages in themselves.
fn language_name(code: &str) -> &str {
    match code {
        "en" => "English",
        "cs" => "Čeština",
        "it" => "Italiano",
        other => other,
    }
}

/// The words and their translations: into the languages that the interface speaks, and those that are there already. One that is emptied
/// goes.
pub(super) fn show(
    ui: &mut Ui,
    bench: &Bench<'_>,
    name: &str,
    own: &mut String,
    translations: &mut BTreeMap<String, String>,
    is_long: bool,
) {
    let field = |ui: &mut Ui, name: String, text: &mut String| {
        let label = ui.label(bench.look.words(name, 0.9, bench.look.faint(Surface::Paper)));
        let edit = if is_long { TextEdit::multiline(text).desired_rows(3) } else { TextEdit::singleline(text) };
        ui.add(edit.id_salt(label.id).desired_width(f32::INFINITY)).labelled_by(label.id);
    };
    field(ui, bench.say(name), own);
    let mut codes: Vec<String> = bench.words.languages().map(str::to_owned).chain(translations.keys().cloned()).collect();
    codes.sort_unstable();
    codes.dedup();
    for code in codes {
        let before = translations.get(&code).cloned().unwrap_or_default();
        let mut text = before.clone();
        ui.push_id(&code, |ui| field(ui, language_name(&code).to_owned(), &mut text));
        if text.is_empty() && !before.is_empty() {
            translations.remove(&code);
        } else if text != before {
            translations.insert(code, text);
        }
    }
}
