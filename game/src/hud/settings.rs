use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{self, Align2, Area, ComboBox, DragValue, Grid, Id, Order, ScrollArea, Slider, Ui};
use veduta::controls::{Capture, ControlList, Controls, KeyCaps, KeyNames};
use veduta::ecs::{Interface, Words};
use veduta::ui::{Look, Surface, Symbol, symbol_button};

use super::controls::SettingsOpen;
use super::keys::{self, Part, Shown};
use super::{Open, above_the_bar};
use crate::profile::Profile;
use crate::settings::{MINIMAP_SHARE, Settings, TEXT_SIZE, VOLUME};

pub(super) fn draw(
    mut contexts: EguiContexts,
    (words, interface): (Res<Words>, Res<Interface>),
    (list, caps, names): (Res<ControlList>, Res<KeyCaps>, Res<KeyNames>),
    (mut controls, mut capture, mut part): (ResMut<Controls>, ResMut<Capture>, ResMut<Part>),
    mut open: ResMut<Open>,
    mut settings: ResMut<Settings>,
) -> Result {
    if !open.settings {
        if capture.is_waiting() {
            capture.leave();
        }
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    let look = Look::of(&interface, context);
    let (mut next, mut next_part, key) = (settings.clone(), *part, names.first::<SettingsOpen>());
    let area = Area::new(Id::new("veduta settings")).anchor(Align2::CENTER_CENTER, above_the_bar(context)).order(Order::Foreground);
    let shown = Shown { list: &list, controls: &controls, caps: &caps, waiting: capture.place() };
    let mut press = None;
    let closes = area.show(context, |ui| {
        let body = |ui: &mut Ui| {
            let closes = head(ui, &look, &words, key, &mut next_part);
            match *part {
                Part::General => show(ui, &look, &words, &mut next),
                Part::Keys => press = keys::show(ui, &look, &words, shown),
            }
            closes
        };
        look.frame(Surface::Paper).show(ui, body).inner
    });
    let closes = closes.inner;
    settings.set_if_neq(next);
    part.set_if_neq(next_part);
    if let Some(press) = press {
        press.act(&list, &mut controls, &mut capture);
    }
    if closes {
        open.settings = false;
    }
    Ok(())
}

/// Names of languages in themselves.
fn language_name(code: &str) -> &str {
    match code {
        "en" => "English",
        "cs" => "Čeština",
        "it" => "Italiano",
        other => other,
    }
}

const PROFILES: [(Profile, &str); 4] = [
    (Profile::Low, "quality-low"),
    (Profile::Medium, "quality-medium"),
    (Profile::High, "quality-high"),
    (Profile::Ultra, "quality-ultra"),
];
const LEVELS: [&str; 4] = ["settings-level-1", "settings-level-2", "settings-level-3", "settings-level-4"];

/// The head of the window: its parts, and whether to close it.
fn head(ui: &mut Ui, look: &Look, words: &Words, key: &str, part: &mut Part) -> bool {
    let surface = Surface::Paper;
    look.dress(ui, surface);
    let row = ui.horizontal(|ui| {
        ui.label(look.words(words.say("settings-title"), 1.25, look.ink(surface)));
        ui.add_space(look.text);
        keys::choose(ui, look, words, part);
        ui.add_space(look.text);
        symbol_button(ui, look, surface, Symbol::Close, false, &words.say("bar-close"), key).clicked()
    });
    row.inner
}

/// The window of settings.
fn show(ui: &mut Ui, look: &Look, words: &Words, settings: &mut Settings) {
    let surface = Surface::Paper;
    look.dress(ui, surface);
    let height = ui.ctx().content_rect().height() * 0.66;
    ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
        Grid::new("settings").num_columns(2).spacing([look.text * 1.5, look.text * 0.35]).show(ui, |ui| {
            language(ui, words, settings);
            quality(ui, words, settings);
            optional(ui, &words.say("settings-hold"), &mut settings.hold_fps, 60, 10..=240);
            optional(ui, &words.say("settings-limit"), &mut settings.kilobytes_s, 200, 5..=20_000);
            slider(ui, &words.say("settings-text"), &mut settings.text_size, TEXT_SIZE);
            check(ui, &words.say("settings-contrast"), &mut settings.high_contrast);
            check(ui, &words.say("settings-motion"), &mut settings.reduced_motion);
            check(ui, &words.say("settings-minimap"), &mut settings.minimap);
            slider(ui, &words.say("settings-minimap-size"), &mut settings.minimap_share, MINIMAP_SHARE);
            let before = (settings.minimap_left, settings.minimap_top, settings.place_right);
            check(ui, &words.say("settings-minimap-left"), &mut settings.minimap_left);
            check(ui, &words.say("settings-minimap-top"), &mut settings.minimap_top);
            check(ui, &words.say("settings-north"), &mut settings.north_up);
            check(ui, &words.say("settings-colour-blind"), &mut settings.colour_blind_safe);
            check(ui, &words.say("settings-map-names"), &mut settings.map_names);
            check(ui, &words.say("settings-map-symbols"), &mut settings.map_symbols);
            check(ui, &words.say("settings-map-views"), &mut settings.map_views);
            check(ui, &words.say("settings-map-landmarks"), &mut settings.map_landmarks);
            check(ui, &words.say("settings-map-route"), &mut settings.map_route);
            check(ui, &words.say("settings-map-trail"), &mut settings.map_trail);
            check(ui, &words.say("settings-map-tour"), &mut settings.map_tour);
            check(ui, &words.say("settings-without-steps"), &mut settings.without_steps);
            check(ui, &words.say("settings-panel"), &mut settings.place_panel);
            check(ui, &words.say("settings-panel-right"), &mut settings.place_right);
            make_room(before, settings);
            check(ui, &words.say("settings-captions"), &mut settings.captions);
            check(ui, &words.say("settings-life"), &mut settings.life);
            sound(ui, words, settings);
            check(ui, &words.say("settings-bar"), &mut settings.bar_stays);
        });
    });
    ui.label(look.words(words.say("settings-tiles"), 0.85, look.faint(surface)));
    if ui.button(words.say("settings-reset")).clicked() {
        *settings = Settings { knows_the_way: settings.knows_the_way, ..Settings::default() };
    }
}

/// The minimap and what stands near never stand in one corner: that which was not moved goes to the other side.
fn make_room((left, top, right): (bool, bool, bool), settings: &mut Settings) {
    if !settings.minimap_top || settings.minimap_left == settings.place_right {
        return;
    }
    if (left, top) != (settings.minimap_left, settings.minimap_top) {
        settings.place_right = settings.minimap_left;
    } else if right != settings.place_right {
        settings.minimap_left = settings.place_right;
    }
}

fn language(ui: &mut Ui, words: &Words, settings: &mut Settings) {
    let label = ui.label(words.say("settings-language"));
    let system = words.say("settings-language-system");
    let shown = settings.language.as_deref().map_or(system.as_str(), language_name).to_owned();
    let chosen = ComboBox::from_id_salt("language").selected_text(shown).show_ui(ui, |ui| {
        ui.selectable_value(&mut settings.language, None, &system);
        for code in words.languages() {
            ui.selectable_value(&mut settings.language, Some(code.to_owned()), language_name(code));
        }
    });
    chosen.response.labelled_by(label.id);
    ui.end_row();
}

fn quality(ui: &mut Ui, words: &Words, settings: &mut Settings) {
    let label = ui.label(words.say("settings-quality"));
    let fitting = words.say("settings-quality-fitting");
    let name =
        |profile: Profile| PROFILES.iter().find(|(p, _)| *p == profile).map_or_else(String::new, |(_, name)| words.say(name));
    let chosen =
        ComboBox::from_id_salt("quality").selected_text(settings.profile.map_or(fitting.clone(), name)).show_ui(ui, |ui| {
            ui.selectable_value(&mut settings.profile, None, &fitting);
            for (profile, name) in PROFILES {
                ui.selectable_value(&mut settings.profile, Some(profile), words.say(name));
            }
        });
    chosen.response.labelled_by(label.id);
    ui.end_row();
    let label = ui.label(words.say("settings-level"));
    let shown = LEVELS.get(usize::from(settings.finest).wrapping_sub(1)).map_or_else(String::new, |name| words.say(name));
    let chosen = ComboBox::from_id_salt("level").selected_text(shown).show_ui(ui, |ui| {
        for (level, name) in (1..).zip(LEVELS) {
            ui.selectable_value(&mut settings.finest, level, words.say(name));
        }
    });
    chosen.response.labelled_by(label.id);
    ui.end_row();
}

/// How loud things are.
fn sound(ui: &mut Ui, words: &Words, settings: &mut Settings) {
    check(ui, &words.say("settings-mute"), &mut settings.muted);
    slider(ui, &words.say("settings-volume"), &mut settings.volume, VOLUME);
    slider(ui, &words.say("settings-volume-city"), &mut settings.volume_city, VOLUME);
    slider(ui, &words.say("settings-volume-steps"), &mut settings.volume_steps, VOLUME);
    slider(ui, &words.say("settings-volume-bells"), &mut settings.volume_bells, VOLUME);
    slider(ui, &words.say("settings-volume-narration"), &mut settings.volume_narration, VOLUME);
    check(ui, &words.say("settings-silent-behind"), &mut settings.silent_behind);
}

fn check(ui: &mut Ui, name: &str, value: &mut bool) {
    ui.checkbox(value, name);
    ui.end_row();
}

fn slider(ui: &mut Ui, name: &str, value: &mut f32, (least, most): (f32, f32)) {
    let label = ui.label(name);
    ui.add(Slider::new(value, least..=most).max_decimals(2)).labelled_by(label.id);
    ui.end_row();
}

/// A number that may be left open.
fn optional<N: egui::emath::Numeric>(
    ui: &mut Ui,
    name: &str,
    value: &mut Option<N>,
    usual: N,
    range: core::ops::RangeInclusive<N>,
) {
    let mut is_set = value.is_some();
    let checkbox = ui.checkbox(&mut is_set, name);
    if checkbox.changed() {
        *value = is_set.then_some(usual);
    }
    if let Some(number) = value {
        ui.add(DragValue::new(number).range(range).clamp_existing_to_range(false)).labelled_by(checkbox.id);
    }
    ui.end_row();
}

#[cfg(test)]
mod tests {
    use bevy_egui::egui::Vec2;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use super::*;

    fn words() -> Words {
        let mut words = Words::default();
        super::super::WORDS.iter().for_each(|(code, file)| words.add(code, file).expect("no mistakes"));
        words
    }

    #[test]
    fn every_setting_has_a_name_and_does_what_it_says() {
        let (look, words) = (Look { text: 14.0, high_contrast: false, reduced_motion: true }, words());
        let mut harness = Harness::builder()
            .with_size(Vec2::new(900.0, 1600.0))
            .build_ui_state(|ui, settings: &mut Settings| show(ui, &look, &words, settings), Settings::default());
        harness.run();
        let choose = |harness: &mut Harness<'_, Settings>, box_name: &str, choice: &str| {
            harness.get_by_role_and_label(egui::accesskit::Role::ComboBox, box_name).click();
            harness.run();
            harness.get_by_label(choice).click();
            harness.run();
        };
        choose(&mut harness, "Language", "Čeština");
        choose(&mut harness, "Quality", "high");
        choose(&mut harness, "Façades, highest level of detail", "2, windows and doors");
        for name in [
            "High contrast",
            "Less motion",
            "Minimap",
            "Minimap at the left",
            "Minimap at the top",
            "North up",
            "Map: colours told apart by everybody",
            "Map: names",
            "Map: sights and houses",
            "Map: views",
            "Map: landmarks as pictures",
            "Map: the way",
            "Map: where you have been",
            "Map: where the tour leads",
            "Ways without stairs",
            "What stands near",
            "Captions of tours",
            "Life: pigeons, flags, water, clocks",
            "Mute",
            "Silent while the window is not in front",
            "The bar stays",
        ] {
            harness.get_by_role_and_label(egui::accesskit::Role::CheckBox, name).click();
            harness.run();
        }
        for name in ["Keep so many frames a second", "Limit streaming to, kB a second"] {
            harness.get_by_role_and_label(egui::accesskit::Role::CheckBox, name).click();
            harness.run();
        }
        let chosen = Settings {
            language: Some("cs".into()),
            profile: Some(Profile::High),
            finest: 2,
            hold_fps: Some(60),
            kilobytes_s: Some(200),
            high_contrast: true,
            reduced_motion: true,
            minimap: false,
            minimap_left: true,
            minimap_top: true,
            // Which makes room for it.
            place_right: true,
            north_up: true,
            colour_blind_safe: true,
            map_names: false,
            map_symbols: false,
            map_views: false,
            map_landmarks: false,
            map_route: false,
            map_trail: false,
            map_tour: false,
            without_steps: true,
            place_panel: false,
            captions: false,
            life: false,
            muted: true,
            silent_behind: false,
            bar_stays: true,
            ..Settings::default()
        };
        assert_eq!(*harness.state(), chosen);
        harness.get_by_role_and_label(egui::accesskit::Role::CheckBox, "What stands near at the right").click();
        harness.run();
        assert_eq!(*harness.state(), Settings { place_right: false, minimap_left: false, ..chosen }, "the minimap makes room");
        harness.get_by_label("As at first").click();
        harness.run();
        assert_eq!(*harness.state(), Settings::default());
    }
}
