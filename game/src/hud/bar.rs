use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{Align2, Area, Id, Order, Ui, Vec2};
use veduta::controls::KeyNames;
use veduta::ecs::{Docks, Interface, Words};
use veduta::guide::SearchBox;
use veduta::guide::controls::SearchOpen;
use veduta::minimap::MapView;
use veduta::minimap::controls::MapOpen;
use veduta::prelude::*;
use veduta::streaming::Reconnect;
use veduta::tour::controls::{TourEdit, TourPause, TourRecord};
use veduta::tour::{EditorCommand, Recorder, TourEditor, TourState};
use veduta::ui::{Look, Surface, Symbol, symbol_button};
use veduta::walker::Intent;
use veduta::walker::controls::{EyeHigher, EyeLower, ViewNarrow, ViewNatural, ViewWide};

use super::Open;
use super::controls::{HelpOpen, SettingsOpen};
use crate::settings::Settings;
use crate::walk::FirstTour;

/// The bar of symbols along the lower edge.
#[derive(Resource, Debug, Clone, Copy, PartialEq)]
pub(super) struct Bar {
    /// For how long nobody has come near it, seconds.
    idle_s: f32,
    /// How much of it is to be seen, 0 to 1.
    shown: f32,
}

impl Default for Bar {
    fn default() -> Self {
        Self { idle_s: 0.0, shown: 1.0 }
    }
}

/// What was pressed on the bar and moves the walker.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Pressed {
    fov: Option<usize>,
    raise_m: f64,
}

/// What the bar shows as chosen.
#[derive(Debug, Clone, Copy, Default)]
struct State {
    /// Which of the fields of view.
    fov: usize,
    tour: TourState,
    map: bool,
    search: bool,
    open: Open,
    /// Whether there is a tour to take.
    has_tour: bool,
    /// Whether the visitor's walk is being recorded, and a tour edited.
    recording: bool,
    editing: bool,
    /// Whether the city comes over the web.
    is_remote: bool,
}

/// A press on the bar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Press {
    Fov(usize),
    Lower,
    Higher,
    Tour,
    Record,
    Edit,
    Map,
    Search,
    Settings,
    Reconnect,
    Help,
}

/// Without the pointer near it the bar stays so long, seconds, and then takes so long to go.
const STAYS_S: f32 = 6.0;
const FADES_S: f32 = 0.5;
/// A press raises or lowers the eyes by so much, metres.
const RAISE_M: f64 = 0.2;
/// The pointer is near the bar in this share of the window.
const NEAR: f32 = 0.2;

pub(super) fn draw(
    mut contexts: EguiContexts,
    time: Res<Time<Real>>,
    (words, interface, settings, keys): (Res<Words>, Res<Interface>, Res<Settings>, Res<KeyNames>),
    (city, walker, player, first): (Option<Res<OpenCity>>, Res<WalkerSettings>, Res<TourPlayer>, Option<Res<FirstTour>>),
    viewers: Query<&Eye, With<Viewer>>,
    (mut open, mut map, mut search): (ResMut<Open>, ResMut<MapView>, ResMut<SearchBox>),
    (mut bar, mut pressed): (ResMut<Bar>, ResMut<Pressed>),
    (recorder, editor, docks): (Res<Recorder>, Res<TourEditor>, Res<Docks>),
    (mut tour, mut edits): (MessageWriter<TourCommand>, MessageWriter<EditorCommand>),
    mut reconnect: MessageWriter<Reconnect>,
) -> Result {
    // The large map has the window to itself.
    if map.open {
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    let look = Look::of(&interface, context);
    let screen = context.content_rect();
    let is_near = context.pointer_latest_pos().is_some_and(|at| at.y > screen.bottom() - screen.height() * NEAR)
        && context.input(|input| input.pointer.time_since_last_movement() < STAYS_S);
    let stays = settings.bar_stays || !settings.knows_the_way || is_near || open.help || open.settings;
    bar.idle_s = if stays { 0.0 } else { bar.idle_s + time.delta_secs() };
    let goal = if bar.idle_s < STAYS_S { 1.0 } else { 0.0 };
    let step = if look.reduced_motion { 1.0 } else { time.delta_secs() / FADES_S };
    bar.shown += (goal - bar.shown).clamp(-step, step);
    if bar.shown <= 0.0 {
        return Ok(());
    }
    let fov_deg = viewers.iter().next().map_or(55.0, |eye| eye.fov_deg);
    let nearest = (0..walker.fovs_deg.len()).min_by(|&a, &b| {
        let off = |n: usize| (walker.fovs_deg[n] - fov_deg).abs();
        off(a).total_cmp(&off(b))
    });
    let state = State {
        fov: nearest.unwrap_or(1),
        tour: player.state(),
        map: map.open,
        search: search.open,
        open: *open,
        recording: recorder.is_on(),
        editing: editor.is_open(),
        has_tour: first.is_some() || player.state() != TourState::Idle,
        is_remote: city.is_some_and(|city| city.0.contains("://")),
    };
    let area = Area::new(Id::new("veduta bar"))
        .constrain_to(Look::free(&docks, context))
        .anchor(Align2::CENTER_BOTTOM, Vec2::new(0.0, -screen.height() * 0.02));
    let shown = bar.shown;
    let press = area.order(Order::Middle).show(context, |ui| {
        ui.set_opacity(shown);
        look.frame(Surface::Dusk).show(ui, |ui| show(ui, &look, (&words, &keys), &state)).inner
    });
    match press.inner {
        None => return Ok(()),
        Some(Press::Fov(n)) => pressed.fov = Some(n),
        Some(Press::Lower) => pressed.raise_m -= RAISE_M,
        Some(Press::Higher) => pressed.raise_m += RAISE_M,
        Some(Press::Tour) => drop(tour.write(TourCommand::Toggle)),
        Some(Press::Record) => drop(edits.write(EditorCommand::Record)),
        Some(Press::Edit) => drop(edits.write(EditorCommand::Toggle)),
        Some(Press::Map) => (map.open, map.radius_m) = (true, map.radius_m.max(320.0)),
        Some(Press::Search) if search.open => search.open = false,
        Some(Press::Search) => search.start(),
        Some(Press::Settings) => open.settings = !open.settings,
        Some(Press::Reconnect) => drop(reconnect.write(Reconnect)),
        Some(Press::Help) => open.help = !open.help,
    }
    Ok(())
}

/// The bar; what was pressed on it.
fn show(ui: &mut Ui, look: &Look, (words, keys): (&Words, &KeyNames), state: &State) -> Option<Press> {
    let surface = Surface::Dusk;
    look.dress(ui, surface);
    ui.spacing_mut().item_spacing.x = look.text * 0.15;
    let mut press = None;
    ui.horizontal(|ui| {
        let mut button = |ui: &mut Ui, symbol, is_on, name: &str, key: &str, what| {
            if symbol_button(ui, look, surface, symbol, is_on, &words.say(name), key).clicked() {
                press = Some(what);
            }
        };
        let views = [
            ("bar-narrow", keys.first::<ViewNarrow>()),
            ("bar-normal", keys.first::<ViewNatural>()),
            ("bar-wide", keys.first::<ViewWide>()),
        ];
        for (n, (name, key)) in views.into_iter().enumerate() {
            button(ui, Symbol::FieldOfView(n as u8), state.fov == n, name, key, Press::Fov(n));
        }
        ui.add_space(look.text * 0.6);
        button(ui, Symbol::Lower, false, "bar-lower", keys.first::<EyeLower>(), Press::Lower);
        button(ui, Symbol::Higher, false, "bar-higher", keys.first::<EyeHigher>(), Press::Higher);
        ui.add_space(look.text * 0.6);
        let (symbol, name) = match state.tour {
            TourState::Playing | TourState::Returning => (Symbol::Pause, "bar-pause"),
            TourState::Paused | TourState::Wandering => (Symbol::Play, "bar-resume"),
            TourState::Idle | TourState::Waiting => (Symbol::Tour, "bar-tour"),
        };
        if state.has_tour {
            button(ui, symbol, state.tour != TourState::Idle, name, keys.first::<TourPause>(), Press::Tour);
        }
        let (symbol, name) = if state.recording { (Symbol::Stop, "bar-record-end") } else { (Symbol::Record, "bar-record") };
        button(ui, symbol, state.recording, name, keys.first::<TourRecord>(), Press::Record);
        button(ui, Symbol::Edit, state.editing, "bar-edit", keys.first::<TourEdit>(), Press::Edit);
        ui.add_space(look.text * 0.6);
        button(ui, Symbol::Map, state.map, "bar-map", keys.first::<MapOpen>(), Press::Map);
        button(ui, Symbol::Search, state.search, "bar-search", keys.first::<SearchOpen>(), Press::Search);
        ui.add_space(look.text * 0.6);
        button(ui, Symbol::Settings, state.open.settings, "bar-settings", keys.first::<SettingsOpen>(), Press::Settings);
        if state.is_remote {
            button(ui, Symbol::Reconnect, false, "bar-reconnect", "", Press::Reconnect);
        }
        button(ui, Symbol::Help, state.open.help, "bar-help", keys.first::<HelpOpen>(), Press::Help);
    });
    press
}

/// Hands what was pressed to the walker.
pub(super) fn press(mut pressed: ResMut<Pressed>, mut intent: ResMut<Intent>) {
    if *pressed != Pressed::default() {
        intent.fov = pressed.fov.or(intent.fov);
        intent.raise_m += pressed.raise_m;
        *pressed = Pressed::default();
    }
}

#[cfg(test)]
mod tests {
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use super::*;

    #[test]
    fn every_symbol_can_be_pressed_by_its_name_in_every_language() {
        let look = Look { text: 16.0, high_contrast: false, reduced_motion: true };
        let mut words = Words::default();
        super::super::WORDS.iter().for_each(|(code, file)| words.add(code, file).expect("no mistakes"));
        for language in ["en", "cs", "it"] {
            words.speak(language);
            let state = State { is_remote: true, has_tour: true, ..State::default() };
            let mut harness = Harness::builder().with_size(Vec2::new(900.0, 100.0)).build_ui_state(
                |ui, pressed: &mut Vec<Press>| pressed.extend(show(ui, &look, (&words, &KeyNames::default()), &state)),
                Vec::new(),
            );
            for (name, press) in [
                ("bar-narrow", Press::Fov(0)),
                ("bar-normal", Press::Fov(1)),
                ("bar-wide", Press::Fov(2)),
                ("bar-lower", Press::Lower),
                ("bar-higher", Press::Higher),
                ("bar-tour", Press::Tour),
                ("bar-record", Press::Record),
                ("bar-edit", Press::Edit),
                ("bar-map", Press::Map),
                ("bar-search", Press::Search),
                ("bar-settings", Press::Settings),
                ("bar-reconnect", Press::Reconnect),
                ("bar-help", Press::Help),
            ] {
                harness.get_by_label(&words.say(name)).click();
                harness.run();
                assert_eq!(harness.state_mut().drain(..).collect::<Vec<_>>(), [press], "{language}: {name}");
            }
        }
    }
}
