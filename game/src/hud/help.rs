use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{Align2, Area, Grid, Id, Order, Ui, Vec2};
use veduta::ecs::{Interface, Words};
use veduta::ui::{Look, Surface, Symbol, symbol_button};

use super::Open;
use super::first::FirstMinute;
use crate::settings::Settings;

/// Keys, by their names or by a message that tells them, and what they do.
const CONTROLS: [(&str, &str); 20] = [
    ("W A S D", "help-walk"),
    ("key-mouse", "help-look"),
    ("Shift", "help-run"),
    ("F · key-space", "help-fly"),
    ("1 2 3", "help-view"),
    ("PageUp PageDown", "help-eye"),
    ("/", "help-search"),
    ("M", "help-map"),
    ("N · + −", "help-map-up"),
    ("T", "help-tour"),
    (", .", "help-tour-time"),
    ("[ ]", "help-tour-speed"),
    ("H J", "help-hour"),
    ("K", "help-season"),
    ("U", "help-mute"),
    ("F12", "help-still"),
    ("F3", "help-settings"),
    ("F1", "help-help"),
    ("F2", "help-expert"),
    ("Ctrl Q", "help-quit"),
];

/// What was pressed on the page.
enum Press {
    Close,
    Again,
}

pub(super) fn draw(
    mut contexts: EguiContexts,
    (words, interface): (Res<Words>, Res<Interface>),
    mut open: ResMut<Open>,
    mut first: ResMut<FirstMinute>,
    mut settings: ResMut<Settings>,
) -> Result {
    if !open.help {
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    let look = Look::of(&interface, context);
    let area = Area::new(Id::new("veduta help")).anchor(Align2::CENTER_CENTER, Vec2::ZERO).order(Order::Foreground);
    let press = area.show(context, |ui| look.frame(Surface::Dusk).show(ui, |ui| show(ui, &look, &words)).inner).inner;
    if press.is_some() {
        open.help = false;
    }
    if matches!(press, Some(Press::Again)) {
        *first = FirstMinute::default();
        settings.knows_the_way = false;
    }
    Ok(())
}

/// Keys as they are written, in the visitor's language where they have names.
fn keys(words: &Words, keys: &str) -> String {
    keys.split(" · ")
        .map(|part| if part.starts_with("key-") { words.say(part) } else { part.to_owned() })
        .collect::<Vec<_>>()
        .join(" · ")
}

/// The page of all controls.
fn show(ui: &mut Ui, look: &Look, words: &Words) -> Option<Press> {
    let surface = Surface::Dusk;
    look.dress(ui, surface);
    let mut press = None;
    ui.horizontal(|ui| {
        ui.label(look.words(words.say("help-title"), 1.25, look.ink(surface)));
        if symbol_button(ui, look, surface, Symbol::Close, false, &words.say("bar-close"), "F1").clicked() {
            press = Some(Press::Close);
        }
    });
    Grid::new("keys").num_columns(2).spacing([look.text * 1.2, look.text * 0.25]).show(ui, |ui| {
        for (of, what) in CONTROLS {
            ui.label(look.words(keys(words, of), 0.95, look.accent(surface)));
            ui.label(words.say(what));
            ui.end_row();
        }
    });
    if ui.button(words.say("help-again")).clicked() {
        press = Some(Press::Again);
    }
    press
}

#[cfg(test)]
mod tests {
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use super::*;

    #[test]
    fn the_page_tells_every_control_and_begins_the_first_minute_again() {
        let look = Look { text: 14.0, high_contrast: false, reduced_motion: true };
        let mut words = Words::default();
        super::super::WORDS.iter().for_each(|(code, file)| words.add(code, file).expect("no mistakes"));
        words.speak("cs");
        let mut harness = Harness::builder()
            .with_size(Vec2::new(900.0, 700.0))
            .build_ui_state(|ui, again: &mut bool| *again |= matches!(show(ui, &look, &words), Some(Press::Again)), false);
        harness.run();
        for (of, what) in CONTROLS {
            harness.get_by_label(&words.say(what));
            harness.get_by_label(&keys(&words, of));
        }
        harness.get_by_label(&words.say("help-again")).click();
        harness.run();
        assert!(*harness.state());
    }
}
