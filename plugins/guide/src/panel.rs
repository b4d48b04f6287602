use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{Align2, Area, Id as EguiId, Order, ScrollArea, Ui, Vec2};
use egui_commonmark::{CommonMarkCache, CommonMarkViewer};
use veduta_city::{Certainty, GuidePlace, Place};
use veduta_controls::Layers;
use veduta_ecs::{Accompany, Docks, Interface, Part, Words};
use veduta_ui::{Look, Pictures, Surface, Symbol, symbol_button};

use crate::gallery::{self, Shown};
use crate::{CityGuide, NearPlace};

/// How the panel looks. Live.
#[derive(Resource, Debug, Clone, Copy, PartialEq)]
pub struct PanelSettings {
    /// Whether it is shown.
    pub visible: bool,
    /// Whether a place's whole text is shown, not its name alone.
    pub unfolded: bool,
    /// Whether it stands at the right.
    pub right: bool,
}

impl Default for PanelSettings {
    fn default() -> Self {
        Self { visible: true, unfolded: true, right: false }
    }
}

/// What the panel keeps from frame to frame.
#[derive(Resource, Default)]
pub(crate) struct PanelState {
    cache: CommonMarkCache,
    /// How far it has come in, 0 to 1.
    shown: f32,
    last: Option<Place>,
    /// What is listened to, as a path of the asset server.
    listens: Option<String>,
}

/// What is told of a place, in the visitor's language.
struct Told<'a> {
    name: &'a str,
    text: &'a str,
    period: &'a str,
    certainty: Option<Certainty>,
    hours: &'a str,
    links: &'a [String],
    /// Whether there is something to listen to, and whether it is listened to.
    sound: Option<bool>,
}

impl<'a> Told<'a> {
    fn of(place: &'a Place, told: Option<&'a GuidePlace>, words: &Words) -> Self {
        Self {
            name: told.map_or(&place.name, |told| told.name_in(words.language())),
            text: told.and_then(|told| told.text_in(&words.preferred())).unwrap_or(&place.text),
            period: told.map_or("", |told| &told.period),
            certainty: told.and_then(|told| told.certainty),
            hours: told.map_or("", |told| &told.hours),
            links: told.map_or(&[], |told| &told.links),
            sound: told.filter(|told| !told.sound.is_empty()).map(|_| false),
        }
    }
}

/// Seconds in which the panel comes and goes.
const FADE_S: f32 = 0.25;

/// Name and text of the place, at the top.
pub(crate) fn draw(
    mut contexts: EguiContexts,
    time: Res<Time<Real>>,
    near: Res<NearPlace>,
    guide: Res<CityGuide>,
    words: Res<Words>,
    (interface, docks, layers): (Res<Interface>, Res<Docks>, Res<Layers>),
    mut settings: ResMut<PanelSettings>,
    mut state: ResMut<PanelState>,
    mut pictures: Pictures,
    mut accompany: MessageWriter<Accompany>,
) -> Result {
    let state = &mut *state;
    // Who reads a page, or builds something with docks about him, reads nothing else.
    let is_free = !layers.has_page() && *docks == Docks::default();
    let goal = if settings.visible && is_free && near.0.is_some() { 1.0 } else { 0.0 };
    if goal == 0.0 && state.shown == 0.0 {
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    let look = Look::of(&interface, context);
    let step = if look.reduced_motion { 1.0 } else { time.delta_secs() / FADE_S };
    state.shown = glide(state.shown, goal, step);
    if let Some(place) = &near.0
        && state.last.as_ref().is_none_or(|last| last.id != place.id)
    {
        state.last = Some(place.clone());
    }
    let Some(place) = state.last.clone() else { return Ok(()) };
    let told_of = guide.place(&place.name);
    let sound = told_of.filter(|told| !told.sound.is_empty()).map(|told| guide.beside(&told.sound));
    // Who has gone on no longer listens.
    if state.listens.is_some() && (state.listens != sound || near.0.is_none()) {
        state.listens = None;
        accompany.write(Accompany::End(Part::Narration));
    }
    let mut told = Told::of(&place, told_of, &words);
    told.sound = sound.as_ref().map(|_| state.listens.is_some());
    let mut unfolded = settings.unfolded;
    let shown = if unfolded { gallery::of_place(told_of, &guide, &words, &mut pictures, context) } else { Vec::new() };
    let mut listens = state.listens.is_some();
    let screen = context.content_rect();
    let area = Area::new(EguiId::new("veduta place")).order(Order::Middle);
    let margin = screen.height() * 0.03;
    let (corner, aside) = if settings.right { (Align2::RIGHT_TOP, -margin) } else { (Align2::LEFT_TOP, margin) };
    area.anchor(corner, Vec2::new(aside, margin)).show(context, |ui| {
        ui.set_opacity(state.shown);
        look.frame(Surface::Paper).show(ui, |ui| {
            // As wide as the strip of a tour leaves it, in the middle of the upper edge.
            ui.set_max_width((look.text * 20.0).min(screen.width() * 0.4));
            ui.set_max_height(screen.height() * 0.55);
            show(ui, &look, &words, &told, &shown, &mut unfolded, &mut listens, &mut state.cache);
        });
    });
    if listens != state.listens.is_some() {
        state.listens = sound.filter(|_| listens);
        accompany.write(match &state.listens {
            Some(file) => Accompany::Play { file: file.clone(), part: Part::Narration },
            None => Accompany::End(Part::Narration),
        });
    }
    if unfolded != settings.unfolded {
        settings.unfolded = unfolded;
    }
    Ok(())
}

/// A value after a step towards its goal.
fn glide(value: f32, goal: f32, step: f32) -> f32 {
    value + (goal - value).clamp(-step, step)
}

/// The sheet of a place.
fn show(
    ui: &mut Ui,
    look: &Look,
    words: &Words,
    told: &Told<'_>,
    pictures: &[Shown],
    unfolded: &mut bool,
    listens: &mut bool,
    cache: &mut CommonMarkCache,
) {
    let surface = Surface::Paper;
    look.dress(ui, surface);
    ui.horizontal_top(|ui| {
        let room = (ui.available_width() - look.text * 2.6).max(look.text * 6.0);
        ui.vertical(|ui| {
            ui.set_width(room);
            ui.label(look.words(told.name, 1.3, look.ink(surface)));
            let about = [told.period, &certainty_in(words, told.certainty)].map(str::to_owned);
            let about: Vec<String> = about.into_iter().filter(|part| !part.is_empty()).collect();
            if !about.is_empty() {
                ui.label(look.words(about.join(" · "), 0.85, look.faint(surface)));
            }
        });
        let has_more = !told.text.is_empty() || !told.links.is_empty() || !pictures.is_empty() || told.sound.is_some();
        if has_more {
            let (symbol, name) = if *unfolded { (Symbol::Close, "place-fold") } else { (Symbol::Help, "place-unfold") };
            if symbol_button(ui, look, surface, symbol, false, &words.say(name), "").clicked() {
                *unfolded = !*unfolded;
            }
        }
    });
    if !*unfolded {
        return;
    }
    let room = ui.available_height();
    ScrollArea::vertical().max_height(room).min_scrolled_height(room).show(ui, |ui| {
        if let Some(plays) = told.sound
            && ui.button(words.say(if plays { "place-silence" } else { "place-listen" })).clicked()
        {
            *listens = !plays;
        }
        pictures.iter().for_each(|picture| gallery::show(ui, look, words, picture));
        CommonMarkViewer::new().show(ui, cache, told.text);
        if !told.hours.is_empty() {
            ui.label(words.say_with("place-hours", &[("hours", told.hours.to_owned().into())]));
        }
        for link in told.links {
            let site = link.split("://").nth(1).unwrap_or(link).split('/').next().unwrap_or_default();
            ui.hyperlink_to(words.say_with("place-link", &[("site", site.to_owned().into())]), link);
        }
    });
}

/// How far the model of a place can be trusted, in words.
fn certainty_in(words: &Words, certainty: Option<Certainty>) -> String {
    match certainty {
        Some(Certainty::Documented) => words.say("certainty-documented"),
        Some(Certainty::Typical) => words.say("certainty-typical"),
        Some(Certainty::Invented) => words.say("certainty-invented"),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use bevy_egui::egui::OutputCommand;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use super::*;

    fn words(language: &str) -> Words {
        let mut words = Words::default();
        crate::WORDS.iter().for_each(|(code, messages)| words.add(code, messages).expect("no mistakes"));
        words.speak(language);
        words
    }

    fn tower() -> (Place, GuidePlace) {
        let place = Place { name: "Powder Tower".into(), text: "Old text.".into(), ..Place::default() };
        let pairs = |pairs: &[(&str, &str)]| pairs.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        let told = GuidePlace {
            name: "Powder Tower".into(),
            names: pairs(&[("cs", "Prašná brána")]),
            text: pairs(&[("en", "A gate of **1475**."), ("cs", "Brána z roku 1475.")]),
            period: "1475".into(),
            certainty: Some(Certainty::Typical),
            links: vec!["https://example.org/tower".into()],
            ..GuidePlace::default()
        };
        (place, told)
    }

    #[test]
    fn what_is_shown_stays_shown_however_slow_the_frames() {
        for step in [0.01, 0.3, 1.0, 40.0] {
            let shown = (0..200).fold(0.0, |shown, _| glide(shown, 1.0, step));
            assert_eq!((shown, glide(shown, 1.0, step)), (1.0, 1.0));
            assert_eq!((0..200).fold(shown, |shown, _| glide(shown, 0.0, step)), 0.0);
        }
    }

    #[test]
    fn the_sheet_speaks_the_visitors_language() {
        let (place, told) = tower();
        let look = Look { text: 16.0, high_contrast: false, reduced_motion: true };
        for (language, name, text) in [
            ("en", "Powder Tower", "A gate of "),
            ("cs", "Prašná brána", "Brána z roku 1475."),
            ("it", "Powder Tower", "A gate of "),
        ] {
            let words = words(language);
            let mut cache = CommonMarkCache::default();
            let mut unfolded = true;
            let harness = Harness::new_ui(|ui| {
                let told = Told::of(&place, Some(&told), &words);
                show(ui, &look, &words, &told, &[], &mut unfolded, &mut false, &mut cache);
            });
            harness.get_by_label(name);
            harness.get_by_label_contains(text);
        }
        let told = Told::of(&place, None, &words("cs"));
        assert_eq!((told.name, told.text), ("Powder Tower", "Old text."), "without a guide, what the map says");
    }

    #[test]
    fn what_can_be_listened_to_is_played_and_ended() {
        let (place, told) = tower();
        let told = GuidePlace { sound: "bells.ogg".into(), ..told };
        let look = Look { text: 16.0, high_contrast: false, reduced_motion: true };
        let words = words("en");
        let mut cache = CommonMarkCache::default();
        let mut harness = Harness::new_ui_state(
            |ui, listens| {
                let told = Told { sound: Some(*listens), ..Told::of(&place, Some(&told), &words) };
                show(ui, &look, &words, &told, &[], &mut true, listens, &mut cache);
            },
            false,
        );
        harness.get_by_label(&words.say("place-listen")).click();
        harness.run();
        assert!(*harness.state());
        harness.get_by_label(&words.say("place-silence")).click();
        harness.run();
        assert!(!*harness.state());
    }

    #[test]
    fn it_folds_and_its_links_go_out_to_be_asked_about() {
        let (place, told) = tower();
        let look = Look { text: 16.0, high_contrast: true, reduced_motion: true };
        let words = words("en");
        let mut cache = CommonMarkCache::default();
        let mut harness = Harness::new_ui_state(
            |ui, unfolded| show(ui, &look, &words, &Told::of(&place, Some(&told), &words), &[], unfolded, &mut false, &mut cache),
            true,
        );
        harness.get_by_label_contains("example.org").click();
        let mut opened = Vec::new();
        for _ in 0..3 {
            harness.step();
            let commands = &harness.output().platform_output.commands;
            opened.extend(commands.iter().filter_map(|command| match command {
                OutputCommand::OpenUrl(link) => Some(link.url.clone()),
                _ => None,
            }));
        }
        assert_eq!(opened, ["https://example.org/tower"]);
        harness.get_by_label(&words.say("place-fold")).click();
        harness.run();
        assert!(!*harness.state() && harness.query_by_label_contains("example.org").is_none());
    }
}
