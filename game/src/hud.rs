use std::collections::VecDeque;

use bevy::prelude::*;
use bevy_egui::egui::{Align2, Area, Color32, CornerRadius, FontId, Frame, Id, Margin, Order, RichText, Vec2};
use bevy_egui::{EguiContexts, EguiPrimaryContextPass};
use veduta::prelude::*;
use veduta::streaming::StreamingStats;

use crate::expert::Expert;

/// Help, and what has gone wrong.
pub(crate) struct HudPlugin;

impl Plugin for HudPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(Hud { help: true, ..default() })
            .add_systems(Update, keep)
            .add_systems(EguiPrimaryContextPass, (draw_help, draw_messages));
    }
}

#[derive(Resource, Default)]
struct Hud {
    help: bool,
    messages: VecDeque<(String, f64)>,
}

/// Seconds that a message stays.
const STAY_S: f64 = 8.0;

const HELP: [(&str, &str); 14] = [
    ("W A S D", "walk"),
    ("right mouse button", "look around (or arrow left, right)"),
    ("Shift", "run"),
    ("F", "fly; Space and C rise and sink"),
    ("1 2 3", "field of view"),
    ("PageUp PageDown", "eye height"),
    ("T", "tour: begin, pause, go on"),
    (", .   [ ]", "tour: back, ahead; slower, faster"),
    ("M", "map; click to go there"),
    ("N   + −", "map: north up; zoom"),
    ("H   J", "hour of the day: earlier, later"),
    ("K", "the next season"),
    ("F1", "this help"),
    ("F2", "how the city streams: cells, line, journal"),
];

/// A quarter of a year, days.
const DAYS_A_SEASON: u16 = 92;

fn keep(
    time: Res<Time>,
    keys: Res<ButtonInput<KeyCode>>,
    mut hud: ResMut<Hud>,
    mut clock: ResMut<CityClock>,
    mut failures: MessageReader<CityFailed>,
    stats: Res<StreamingStats>,
) {
    let now = time.elapsed_secs_f64();
    if keys.just_pressed(KeyCode::F1) {
        hud.help = !hud.help;
    }
    // The first steps are what the help is for; then it goes.
    if hud.help && keys.any_just_pressed([KeyCode::KeyW, KeyCode::ArrowUp, KeyCode::KeyT]) && stats.cells > 0 {
        hud.help = false;
    }
    let turn = f64::from(keys.pressed(KeyCode::KeyJ)) - f64::from(keys.pressed(KeyCode::KeyH));
    if turn != 0.0 {
        clock.hour = (clock.hour + turn * time.delta_secs_f64() * 1.5).rem_euclid(24.0);
    }
    if keys.just_pressed(KeyCode::KeyK) {
        clock.day = (clock.day + DAYS_A_SEASON - 1) % 366 + 1;
    }
    for failure in failures.read() {
        if !hud.messages.iter().any(|(text, _)| *text == failure.message) {
            hud.messages.push_back((failure.message.clone(), now));
        }
    }
    hud.messages.retain(|(_, at)| now - at < STAY_S);
    while hud.messages.len() > 4 {
        hud.messages.pop_front();
    }
}

fn paper() -> Frame {
    let fill = Color32::from_rgba_unmultiplied(24, 20, 16, 200);
    Frame::new().fill(fill).corner_radius(CornerRadius::same(6)).inner_margin(Margin::symmetric(16, 12))
}

fn draw_help(mut contexts: EguiContexts, hud: Res<Hud>) -> Result {
    let context = contexts.ctx_mut()?;
    let screen = context.content_rect();
    let size = (screen.height() * 0.024).max(11.0);
    let ink = Color32::from_rgb(0xF6, 0xEF, 0xE0);
    if !hud.help {
        return Ok(());
    }
    Area::new(Id::new("veduta help")).anchor(Align2::CENTER_CENTER, Vec2::ZERO).order(Order::Foreground).interactable(false).show(
        context,
        |ui| {
            paper().show(ui, |ui| {
                bevy_egui::egui::Grid::new("keys").num_columns(2).spacing([size * 1.2, size * 0.3]).show(ui, |ui| {
                    for (key, what) in HELP {
                        ui.label(RichText::new(key).font(FontId::monospace(size)).color(Color32::from_rgb(0xE8, 0xC9, 0x8A)));
                        ui.label(RichText::new(what).font(FontId::proportional(size)).color(ink));
                        ui.end_row();
                    }
                });
            });
        },
    );
    Ok(())
}

fn draw_messages(mut contexts: EguiContexts, hud: Res<Hud>, expert: Res<Expert>) -> Result {
    // An expert reads them in the journal.
    if hud.messages.is_empty() || expert.is_shown {
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    let screen = context.content_rect();
    let size = (screen.height() * 0.02).max(11.0);
    Area::new(Id::new("veduta messages"))
        .anchor(Align2::RIGHT_TOP, Vec2::new(-size, size))
        .order(Order::Foreground)
        .interactable(false)
        .show(context, |ui| {
            ui.set_max_width(screen.width() * 0.4);
            paper().show(ui, |ui| {
                for (text, _) in &hud.messages {
                    ui.label(RichText::new(text).font(FontId::proportional(size)).color(Color32::from_rgb(0xF2, 0xC0, 0x9A)));
                }
            });
        });
    Ok(())
}
