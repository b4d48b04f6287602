use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{Align2, Area, Grid, Id, Order, ScrollArea, Ui};
use veduta::controls::KeyNames;
use veduta::ecs::{Interface, Words};
use veduta::ui::{Look, Surface, Symbol, symbol_button};

use super::controls::HelpOpen;
use super::first::FirstMinute;
use super::{Open, above_the_bar};
use crate::settings::Settings;

/// Controls, and what they do together.
const CONTROLS: [(&[&str], &str); 26] = [
    (&["walk.forward", "walk.left", "walk.back", "walk.right"], "help-walk"),
    (&["look.hold", "look.left", "look.right"], "help-look"),
    (&["walk.run"], "help-run"),
    (&["walk.fly", "fly.rise", "fly.sink"], "help-fly"),
    (&["walk.examine"], "help-examine"),
    (&["view.narrow", "view.natural", "view.wide"], "help-view"),
    (&["view.next"], "help-view-next"),
    (&["eye.lower", "eye.higher"], "help-eye"),
    (&["search.open"], "help-search"),
    (&["map.open"], "help-map"),
    (&["map.north", "map.nearer", "map.wider"], "help-map-up"),
    (&["tour.pause"], "help-tour"),
    (&["tour.back", "tour.ahead"], "help-tour-time"),
    (&["tour.next"], "help-tour-next"),
    (&["tour.slower", "tour.faster"], "help-tour-speed"),
    (&["tour.record"], "help-record"),
    (&["tour.edit", "tour.view"], "help-editor"),
    (&["hour.earlier", "hour.later"], "help-hour"),
    (&["season.next"], "help-season"),
    (&["sound.mute"], "help-mute"),
    (&["still.take"], "help-still"),
    (&["settings.open"], "help-settings"),
    (&["help.open"], "help-help"),
    (&["expert.open"], "help-expert"),
    (&["window.close"], "help-close"),
    (&["quit"], "help-quit"),
];

/// What was pressed on the page.
enum Press {
    Close,
    Again,
}

pub(super) fn draw(
    mut contexts: EguiContexts,
    (words, interface, keys): (Res<Words>, Res<Interface>, Res<KeyNames>),
    mut open: ResMut<Open>,
    mut first: ResMut<FirstMinute>,
    mut settings: ResMut<Settings>,
) -> Result {
    if !open.help {
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    let look = Look::of(&interface, context);
    let area = Area::new(Id::new("veduta help")).anchor(Align2::CENTER_CENTER, above_the_bar(context)).order(Order::Foreground);
    // Opaque: a map may lie beneath it.
    let frame = look.frame(Surface::Dusk).fill(look.ground(Surface::Dusk).to_opaque());
    let press = area.show(context, |ui| frame.show(ui, |ui| show(ui, &look, &words, &keys)).inner).inner;
    if press.is_some() {
        open.help = false;
    }
    if matches!(press, Some(Press::Again)) {
        *first = FirstMinute::default();
        settings.knows_the_way = false;
    }
    Ok(())
}

/// The page of all controls.
fn show(ui: &mut Ui, look: &Look, words: &Words, keys: &KeyNames) -> Option<Press> {
    let surface = Surface::Dusk;
    look.dress(ui, surface);
    let mut press = None;
    ui.horizontal(|ui| {
        ui.label(look.words(words.say("help-title"), 1.25, look.ink(surface)));
        if symbol_button(ui, look, surface, Symbol::Close, false, &words.say("bar-close"), keys.first::<HelpOpen>()).clicked() {
            press = Some(Press::Close);
        }
    });
    let screen = ui.ctx().content_rect();
    ui.set_width((look.text * 46.0).min(screen.width() * 0.9));
    let height = screen.height() * 0.7;
    ScrollArea::vertical()
        .auto_shrink([false, true])
        .max_height(height)
        .min_scrolled_height(height)
        .show(ui, |ui| table(ui, look, words, keys));
    if ui.button(words.say("help-again")).clicked() {
        press = Some(Press::Again);
    }
    press
}

/// Keys, and what they do.
fn table(ui: &mut Ui, look: &Look, words: &Words, keys: &KeyNames) {
    let surface = Surface::Dusk;
    Grid::new("keys").num_columns(2).spacing([look.text * 1.2, look.text * 0.25]).show(ui, |ui| {
        // What is bound to nothing is not told of.
        for (of, what) in CONTROLS.iter().map(|(of, what)| (keys.firsts(of), what)).filter(|(of, _)| !of.is_empty()) {
            ui.label(look.words(of, 0.95, look.accent(surface)));
            ui.label(words.say(what));
            ui.end_row();
        }
    });
}

#[cfg(test)]
mod tests {
    use bevy_egui::egui::Vec2;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;
    use veduta::controls::{ControlList, Controls, Device, Input, KeyCaps};

    use super::*;

    fn words(language: &str, app: &mut App) {
        app.world_mut().resource_mut::<Words>().speak(language);
    }

    fn harness<'a>(words: &'a Words, keys: &'a KeyNames) -> Harness<'a, bool> {
        let look = Look { text: 14.0, high_contrast: false, reduced_motion: true };
        Harness::builder()
            .with_size(Vec2::new(900.0, 1000.0))
            .build_ui_state(move |ui, again: &mut bool| *again |= matches!(show(ui, &look, words, keys), Some(Press::Again)), false)
    }

    #[test]
    fn the_page_tells_every_control_and_begins_the_first_minute_again() {
        let mut app = super::super::controls::app();
        words("cs", &mut app);
        let list = app.world().resource::<ControlList>();
        for (of, what) in CONTROLS {
            assert!(of.iter().all(|name| list.get(name).is_some()), "{what}: {of:?}");
        }
        let words = app.world().resource::<Words>();
        let keys = KeyNames::tell(list, &Controls::default(), Device::Keys, words, &KeyCaps::default());
        let mut harness = harness(words, &keys);
        harness.run();
        for (of, what) in CONTROLS.iter().filter(|(of, _)| *of != ["view.next"]) {
            harness.get_by_label(&words.say(what));
            harness.get_by_label(&keys.firsts(of));
        }
        harness.get_by_label("W A S D");
        assert!(harness.query_by_label(&words.say("help-view-next")).is_none(), "a keyboard has no key for that");
        harness.get_by_label(&words.say("help-again")).click();
        harness.run();
        assert!(*harness.state());
    }

    #[test]
    fn the_page_tells_what_keys_are_now_and_what_is_in_the_hand() {
        let app = super::super::controls::app();
        let (list, words) = (app.world().resource::<ControlList>(), app.world().resource::<Words>());
        let mut controls = Controls::default();
        controls.put(list.get("map.open").expect("listed"), 0, Input::key(KeyCode::KeyB));
        let tell = |device| KeyNames::tell(list, &controls, device, words, &KeyCaps::default());
        let (keys, pad) = (tell(Device::Keys), tell(Device::Pad));
        let mut page = harness(words, &keys);
        page.run();
        page.get_by_label("B");
        assert!(page.query_by_label("M").is_none());
        let mut page = harness(words, &pad);
        page.run();
        page.get_by_label("left stick ⬆ ⬅ ⬇ ➡");
        page.get_by_label("Pad View");
        page.get_by_label(&words.say("help-view-next"));
    }
}
