//! Playing, recording, taking views; and what there is to say.

use bevy_egui::egui::Ui;
use veduta_route::Approach;
use veduta_ui::{Surface, Symbol, symbol_button};

use super::act::Act;
use super::bench::{Acts, Bench};
use super::label;

const APPROACHES: [(Approach, &str); 3] =
    [(Approach::Walk, "approach-walk"), (Approach::Fly, "approach-fly"), (Approach::Cut, "approach-cut")];

/// The row over the line of time.
pub(super) fn show(ui: &mut Ui, bench: &Bench<'_>, acts: &mut Acts) {
    let (look, surface) = (&bench.look, Surface::Paper);
    ui.horizontal(|ui| {
        let (symbol, name) = if bench.is_playing { (Symbol::Pause, "tour-pause") } else { (Symbol::Play, "editor-play") };
        if symbol_button(ui, look, surface, symbol, false, &bench.say(name), "T").clicked() {
            acts.push(Act::Play);
        }
        ui.label(look.words(format!("{} / {}", label::time(bench.t_s), label::time(bench.whole_s())), 0.95, look.ink(surface)));
        ui.separator();
        let (symbol, name) =
            if bench.is_recording { (Symbol::Stop, "editor-record-end") } else { (Symbol::Record, "editor-record") };
        if symbol_button(ui, look, surface, symbol, bench.is_recording, &bench.say(name), "R").clicked() {
            acts.push(Act::Record);
        }
        ui.separator();
        let add = bevy_egui::egui::Button::new(bench.say("editor-add-view"));
        if ui.add(add).on_hover_text("V").clicked() {
            acts.push(Act::AddView);
        }
        for (approach, name) in APPROACHES {
            if ui.selectable_label(bench.approach == approach, bench.say(name)).clicked() {
                acts.push(Act::Approach(approach));
            }
        }
        ui.separator();
        told(ui, bench, acts);
    });
}

/// What was changed elsewhere, what is wrong, what was done last.
fn told(ui: &mut Ui, bench: &Bench<'_>, acts: &mut Acts) {
    let (look, surface) = (&bench.look, Surface::Paper);
    if bench.is_changed_elsewhere {
        ui.label(look.words(bench.say("editor-changed"), 0.95, look.accent(surface)));
        for (name, act) in [("editor-take-other", Act::TakeOther), ("editor-keep-mine", Act::KeepMine)] {
            if ui.button(bench.say(name)).clicked() {
                acts.push(act);
            }
        }
        return;
    }
    let mistakes = bench.sketch.mistakes.len();
    if mistakes > 0 {
        let text = bench.words.say_with("editor-mistakes", &[("n", (mistakes as u32).into())]);
        let first = bench.sketch.mistakes.iter().find_map(|(step, _)| *step);
        if ui.button(look.words(text, 0.95, look.accent(surface))).clicked() {
            acts.push(Act::Select(first.map_or(0..0, |step| step..step + 1)));
        }
    }
    if !bench.notice.is_empty() {
        let notice = bevy_egui::egui::Label::new(look.words(bench.notice, 0.95, look.faint(surface))).truncate();
        ui.add(notice).on_hover_text(bench.notice);
    }
}
