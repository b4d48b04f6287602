//! The line and its faults, figures and plots; the journal.

use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{self, Align2, CornerRadius, FontId, Margin, RichText, ScrollArea, Slider, Vec2, Window};
use veduta::controls::KeyNames;
use veduta::facade::{AutoLevels, LevelReach};
use veduta::prelude::*;
use veduta::streaming::{Event, Journal, Link, Pace, Reconnect, Streamed, StreamingStats};

use super::plots::{Downloads, bytes, show};
use super::{Expert, FAINT, INK, PAPER, PENDING, SHUT};
use crate::hud::controls::ExpertOpen;

pub(super) fn frame() -> egui::Frame {
    egui::Frame::new().fill(PAPER).corner_radius(CornerRadius::same(6)).inner_margin(Margin::symmetric(12, 10))
}

/// A slider's end that stands for no limit, bytes a second.
const UNLIMITED: f64 = 10_000_000.0;
/// Lines of the journal that are shown.
const LINES: usize = 200;

pub(super) fn draw(
    mut contexts: EguiContexts,
    time: Res<Time>,
    mut expert: ResMut<Expert>,
    mut link: ResMut<Link>,
    mut settings: ResMut<StreamingSettings>,
    mut reconnect: MessageWriter<Reconnect>,
    stats: Res<StreamingStats>,
    downloads: Res<Downloads>,
    pace: Res<Pace>,
    streamed: Streamed<'_>,
    (mut commands, auto, mut reach, keys): (Commands, Option<Res<AutoLevels>>, ResMut<LevelReach>, Res<KeyNames>),
) -> Result {
    let context = contexts.ctx_mut()?;
    let window = Window::new("Streaming").frame(frame()).title_bar(false).resizable(false).default_width(330.0);
    window.anchor(Align2::RIGHT_TOP, Vec2::new(-10.0, 10.0)).show(context, |ui| {
        ui.set_width(330.0);
        ui.style_mut().visuals.override_text_color = Some(INK);
        ui.style_mut().override_font_id = Some(FontId::proportional(12.0));
        ui.horizontal(|ui| {
            ui.label(RichText::new("Streaming").size(15.0));
            if ui.button(format!("hide ({})", keys.first::<ExpertOpen>())).clicked() {
                expert.is_shown = false;
            }
        });
        let told =
            streamed.index().map_or((0, 0, 0), |index| (index.regions_here().count(), index.regions.len(), index.cell_count()));
        ui.label(format!("{} cells of {} loaded, {} of {} regions told of", stats.cells, told.2, told.0, told.1));
        ui.label(format!(
            "{} in content, {} received, {} requests, {} on their way, {} failed",
            bytes(stats.bytes_loaded),
            bytes(stats.bytes_all),
            stats.requests,
            stats.in_flight,
            stats.failures
        ));
        ui.label(match pace.bytes_s() {
            Some(bytes_s) => format!("{} a second come when something is awaited", bytes(bytes_s as u64)),
            None => "nothing was awaited long enough to tell the line's pace".to_owned(),
        });
        line(ui, &mut link, &mut settings, &mut reconnect);
        levels(ui, &mut commands, auto.as_deref(), &mut reach);
        show(ui, &downloads, time.elapsed_secs_f64());
    });
    Ok(())
}

/// The journal's last lines, between the place's name and the plan of cells.
pub(super) fn draw_journal(mut contexts: EguiContexts, journal: Res<Journal>) -> Result {
    let context = contexts.ctx_mut()?;
    let screen = context.content_rect();
    let window = Window::new("Journal").frame(frame()).title_bar(false).resizable(false);
    window.anchor(Align2::LEFT_TOP, Vec2::new(10.0, screen.height() * 0.11)).show(context, |ui| {
        let broad = (screen.height() * 0.44).clamp(160.0, 720.0);
        ui.set_width(broad);
        ui.label(RichText::new("Journal").color(FAINT).size(12.0));
        ScrollArea::vertical().max_height(screen.height() * 0.3).stick_to_bottom(true).show(ui, |ui| {
            ui.set_width(broad - 8.0);
            let skipped = journal.entries().len().saturating_sub(LINES);
            for entry in journal.entries().skip(skipped) {
                let (text, colour) = words(&entry.event);
                ui.label(RichText::new(format!("{:8.2}  {text}", entry.at_s)).monospace().size(10.0).color(colour));
            }
        });
    });
    Ok(())
}

/// Sliders of the simulated line.
fn line(
    ui: &mut egui::Ui,
    link: &mut ResMut<Link>,
    settings: &mut ResMut<StreamingSettings>,
    reconnect: &mut MessageWriter<Reconnect>,
) {
    let mut own = **link;
    // Settings count as changed when they are written to.
    let mut paused = settings.paused;
    let mut pace = own.bytes_s.min(UNLIMITED);
    ui.add(Slider::new(&mut own.latency_s, 0.0..=3.0).text("latency, s"));
    let words = |n: f64, _: core::ops::RangeInclusive<usize>| if n >= UNLIMITED { "no limit".to_owned() } else { bytes(n as u64) };
    ui.add(Slider::new(&mut pace, 1_000.0..=UNLIMITED).logarithmic(true).custom_formatter(words).text("a second"));
    ui.add(Slider::new(&mut own.loss, 0.0..=0.9).text("lost"));
    own.bytes_s = if pace >= UNLIMITED { f64::INFINITY } else { pace };
    ui.horizontal(|ui| {
        ui.checkbox(&mut own.is_down, "server gone");
        ui.checkbox(&mut paused, "pause");
        if ui.button("ask again now").clicked() {
            reconnect.write(Reconnect);
        }
    });
    link.set_if_neq(own);
    if paused != settings.paused {
        settings.paused = paused;
    }
}

/// How far levels of detail reach: as frames allow, or by hand.
fn levels(ui: &mut egui::Ui, commands: &mut Commands, auto: Option<&AutoLevels>, reach: &mut ResMut<LevelReach>) {
    let mut is_auto = auto.is_some();
    let mut share = reach.0 * 100.0;
    let frames = auto.copied().unwrap_or_default().frame_s.recip();
    let slider = Slider::new(&mut share, 0.0..=100.0).fixed_decimals(0).suffix(" %").text("reach of levels");
    ui.add_enabled(!is_auto, slider);
    ui.checkbox(&mut is_auto, format!("reach as far as {frames:.0} frames a second allow"));
    match (is_auto, auto) {
        (true, None) => commands.init_resource::<AutoLevels>(),
        (false, Some(_)) => commands.remove_resource::<AutoLevels>(),
        (true, Some(_)) => {}
        (false, None) if share != reach.0 * 100.0 => reach.0 = share / 100.0,
        (false, None) => {}
    }
}

/// A line of the journal in words.
fn words(event: &Event) -> (String, egui::Color32) {
    match event {
        Event::Opened { place } => (format!("opened {place}"), INK),
        Event::Entered { cell: Some(cell), .. } => (format!("entered cell {cell}"), INK),
        Event::Entered { cell: None, .. } => ("left all cells".to_owned(), INK),
        Event::Asked { what, bytes: size, .. } => (format!("asked for {what}, {}", bytes(*size)), FAINT),
        Event::Arrived { what, bytes: size } => (format!("arrived {what}, {}", bytes(*size)), PENDING),
        Event::Failed { what, again_in_s: Some(s), .. } => (format!("failed {what}, again in {s:.1} s"), SHUT),
        Event::Failed { what, again_in_s: None, .. } => (format!("failed {what} for good"), SHUT),
        Event::Cancelled { what } => (format!("taken back {what}"), FAINT),
        Event::Released { cell, from, why } => (format!("released cell {cell} from {from}, {why}"), FAINT),
    }
}
