//! The expert's view: how the city streams, as it does so. The plan of cells with what is loaded and in sight, the line with its faults
//! to set, what was downloaded over the walk, the journal; and in the street itself blue stones for what is on its way and
//! proximity walls in the portals: a click on one walks through.

mod layout;
mod panel;
mod plots;
mod walls;

use bevy::prelude::*;
use bevy_egui::{EguiPrimaryContextPass, egui::Color32};
use veduta::city::Level;
use veduta::controls::{Layers, Presses};
use veduta::guide::PickSettings;
use veduta::walker::WalkerSystems;

use crate::hud::controls::ExpertOpen;

/// The expert's view.
pub(crate) struct ExpertPlugin;

/// Whether it is shown, and what was chosen in it.
#[derive(Resource)]
pub(crate) struct Expert {
    pub is_shown: bool,
    /// Metres from the middle of the plan of cells to its edge.
    pub reach_m: f32,
    /// A place on the plan that was clicked, plan metres.
    pub leap: Option<bevy::math::DVec2>,
}

impl Plugin for ExpertPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(Expert { is_shown: false, reach_m: 220.0, leap: None })
            .init_resource::<plots::Downloads>()
            .init_resource::<walls::WalkThrough>()
            .add_systems(Update, (toggle, plots::record))
            .add_systems(Update, walls::walk_through.after(WalkerSystems::Input).before(WalkerSystems::Move))
            .add_systems(Update, (walls::draw, walls::click).run_if(is_shown))
            .add_systems(EguiPrimaryContextPass, (panel::draw, panel::draw_journal, layout::draw).chain().run_if(is_shown));
    }
}

fn is_shown(expert: Res<Expert>) -> bool {
    expert.is_shown
}

fn toggle(presses: Presses<'_, '_>, mut layers: ResMut<Layers>, mut expert: ResMut<Expert>, mut pick: ResMut<PickSettings>) {
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
