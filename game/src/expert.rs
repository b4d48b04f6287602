//! The expert's view: how the city streams, as it does so. The plan of cells with what is loaded and in sight, the line with its faults
//! to set, what was downloaded over the walk, the journal; and in the street itself blue stones for what is on its way and
//! proximity walls in the portals: a click on one walks through. All of it can be looked at from above.

mod aloft;
mod journal;
mod layout;
mod panel;
mod plots;
mod told;
mod walls;

use bevy::prelude::*;
use bevy_egui::EguiPrimaryContextPass;
use bevy_egui::egui::{self, Color32, CornerRadius, Frame, Margin};
use veduta::city::Level;
use veduta::controls::{Layers, Presses};
use veduta::ecs::{Interface, VedutaSystems};
use veduta::guide::PickSettings;
use veduta::minimap::MapView;
use veduta::ui::Look;

use crate::hud::controls::ExpertOpen;

/// The expert's view.
pub(crate) struct ExpertPlugin;

/// Whether it is shown, and what was chosen in it.
#[derive(Resource)]
pub(crate) struct Expert {
    pub is_shown: bool,
    /// Whether the camera is above the walk.
    pub is_aloft: bool,
    /// Metres from the middle of the plan of cells to its edge.
    pub reach_m: f32,
    /// A place on the plan that was clicked, plan metres.
    pub leap: Option<bevy::math::DVec2>,
}

impl Plugin for ExpertPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(Expert { is_shown: false, is_aloft: false, reach_m: 220.0, leap: None })
            .init_resource::<plots::Plotted>()
            .add_systems(Update, (toggle, plots::follow))
            .add_systems(Update, aloft::lift.before(VedutaSystems::Show))
            .add_systems(Update, (walls::draw, aloft::draw).run_if(is_shown))
            .add_systems(EguiPrimaryContextPass, (panel::draw, journal::draw, layout::draw).chain().run_if(is_shown));
        walls::add_clicks(app);
    }
}

fn is_shown(expert: Res<Expert>) -> bool {
    expert.is_shown
}

fn toggle(
    presses: Presses<'_, '_>,
    mut layers: ResMut<Layers>,
    mut expert: ResMut<Expert>,
    mut pick: ResMut<PickSettings>,
    mut map: ResMut<MapView>,
) {
    if presses.begins::<ExpertOpen>() {
        expert.is_shown = !expert.is_shown;
    }
    if layers.closes_page("expert", expert.is_shown) {
        expert.is_shown = false;
    }
    // A click goes through walls then, and nowhere else.
    if pick.leads == expert.is_shown {
        pick.leads = !expert.is_shown;
    }
    // The plan of cells is a map, too, and its figures lie over the small one.
    if map.is_covered != expert.is_shown {
        map.is_covered = expert.is_shown;
    }
}

/// Text of the view as a share of running text elsewhere: there is much of it.
const TEXT: f32 = 0.85;
/// From the window's edge to a panel, heights of text.
const MARGIN: f32 = 0.75;

/// The view's look.
fn look(interface: &Interface, context: &egui::Context) -> Look {
    let look = Look::of(interface, context);
    Look { text: look.text * TEXT, ..look }
}

/// A panel's paper.
fn frame(look: &Look) -> Frame {
    let margin = |share: f32| (look.text * share).round().clamp(0.0, 127.0) as i8;
    Frame::new().fill(PAPER).corner_radius(CornerRadius::same(6)).inner_margin(Margin::symmetric(margin(0.9), margin(0.75)))
}

/// Edge of the plan of cells, and breadth of the journal above it.
fn side(screen: egui::Rect) -> f32 {
    (screen.height() * 0.44).min(screen.width() * 0.45).max(160.0)
}

/// Colours of the view: ink on dark paper, and what each thing is.
const INK: Color32 = Color32::from_rgb(0xF6, 0xEF, 0xE0);
const FAINT: Color32 = Color32::from_rgb(0x8C, 0x86, 0x7C);
const PAPER: Color32 = Color32::from_rgba_premultiplied(20, 17, 14, 225);
const PENDING: Color32 = Color32::from_rgb(0x4A, 0x9A, 0xFF);
const OPEN: Color32 = Color32::from_rgb(0x6C, 0xC8, 0x7A);
const SHUT: Color32 = Color32::from_rgb(0xE0, 0x6A, 0x5A);
const EDGE: Color32 = Color32::from_rgb(0x6A, 0x66, 0x60);
const HERE: Color32 = Color32::from_rgb(0xFF, 0xD8, 0x6B);

/// Fill of a cell on the plan.
const fn fill(level: Option<Level>, is_in_sight: bool) -> Color32 {
    match (level, is_in_sight) {
        (None, false) => Color32::from_rgb(0x2C, 0x2A, 0x28),
        (None, true) => Color32::from_rgb(0x5A, 0x2E, 0x2A),
        (Some(Level::One), false) => Color32::from_rgb(0x4A, 0x4E, 0x48),
        (Some(Level::One), true) => Color32::from_rgb(0x6E, 0x86, 0x62),
        (Some(_), false) => Color32::from_rgb(0x5C, 0x56, 0x46),
        (Some(_), true) => Color32::from_rgb(0xB8, 0x9A, 0x5E),
    }
}

/// Words of each language without the others: what one lacks is said by the name of its message.
#[cfg(test)]
fn tongues() -> impl Iterator<Item = veduta::ecs::Words> {
    crate::hud::WORDS.into_iter().map(|(language, file)| {
        let mut words = veduta::ecs::Words::default();
        words.add(language, file).expect("no mistakes");
        words.speak(language);
        words
    })
}
