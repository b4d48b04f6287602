//! The line and its faults, figures and plots.

use core::ops::RangeInclusive;

use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{Align2, Id, ScrollArea, Slider, Ui, Vec2, Window};
use veduta::buildings::BuildStats;
use veduta::controls::KeyNames;
use veduta::ecs::{DistrictMemory, Interface, Words};
use veduta::facade::{AutoLevels, LevelReach};
use veduta::prelude::*;
use veduta::streaming::{Link, Pace, Reconnect, Streamed, StreamingStats};
use veduta::ui::{Look, Surface, Symbol, symbol_button};

use super::plots::{self, Plotted};
use super::told::{bytes, made};
use super::{Expert, INK, MARGIN, frame, look};
use crate::hud::controls::ExpertOpen;

/// A slider's end that stands for no limit, bytes a second.
const UNLIMITED: f64 = 10_000_000.0;
/// Breadth of the panel, heights of its text.
const BROAD: f32 = 26.0;

pub(super) fn draw(
    mut contexts: EguiContexts,
    time: Res<Time>,
    (words, interface, keys): (Res<Words>, Res<Interface>, Res<KeyNames>),
    (stats, plotted, pace, streamed): (Res<StreamingStats>, Res<Plotted>, Res<Pace>, Streamed<'_>),
    (afar, build): (Res<DistrictMemory>, Res<BuildStats>),
    mut expert: ResMut<Expert>,
    (mut link, mut settings): (ResMut<Link>, ResMut<StreamingSettings>),
    mut reconnect: MessageWriter<Reconnect>,
    (mut commands, auto, mut reach): (Commands, Option<Res<AutoLevels>>, ResMut<LevelReach>),
) -> Result {
    let context = contexts.ctx_mut()?;
    let look = look(&interface, context);
    let title = words.say("expert-title");
    let window = Window::new(title.clone()).id(Id::new("veduta expert"));
    let window = window.frame(frame(&look)).title_bar(false).resizable(false);
    let high = context.content_rect().height() - look.text * 3.5;
    // Settings count as changed when they are written to.
    let (mut own, mut is_paused) = (*link, settings.paused);
    let (mut is_auto, mut percent) = (auto.is_some(), reach.0 * 100.0);
    let (mut closes, mut asks, mut is_aloft) = (false, false, expert.is_aloft);
    window.anchor(Align2::RIGHT_TOP, Vec2::new(-MARGIN, MARGIN) * look.text).show(context, |ui| {
        look.dress(ui, Surface::Dusk);
        ui.set_width(look.text * BROAD);
        ScrollArea::vertical().max_height(high).min_scrolled_height(high).show(ui, |ui| {
            closes = head(ui, &look, &words, title, keys.first::<ExpertOpen>());
            let told =
                streamed.index().map_or((0, 0, 0), |index| (index.regions_here_count(), index.regions.len(), index.cell_count()));
            figures(ui, &words, &stats, told, pace.bytes_s());
            memory(ui, &words, &stats, *afar, settings.memory_cap_bytes);
            ui.label(made(&words, stats.bytes_received.iter().sum(), &build));
            asks = line(ui, &words, &mut own, &mut is_paused);
            aloft(ui, &words, &mut is_aloft);
            levels(ui, &words, auto.as_deref().copied().unwrap_or_default(), &mut is_auto, &mut percent);
            plots::show(ui, &look, &words, &plotted, time.elapsed_secs_f64());
        });
    });
    if closes {
        expert.is_shown = false;
    }
    if is_aloft != expert.is_aloft {
        expert.is_aloft = is_aloft;
    }
    if asks {
        reconnect.write(Reconnect);
    }
    link.set_if_neq(own);
    if is_paused != settings.paused {
        settings.paused = is_paused;
    }
    match (is_auto, auto.is_some()) {
        (true, false) => commands.init_resource::<AutoLevels>(),
        (false, true) => commands.remove_resource::<AutoLevels>(),
        (false, false) if percent != reach.0 * 100.0 => reach.0 = percent / 100.0,
        _ => {}
    }
    Ok(())
}

/// The panel's head; whether to close it.
fn head(ui: &mut Ui, look: &Look, words: &Words, title: String, key: &str) -> bool {
    let row = ui.horizontal(|ui| {
        ui.label(look.words(title, 1.25, INK));
        symbol_button(ui, look, Surface::Dusk, Symbol::Close, false, &words.say("bar-close"), key).clicked()
    });
    row.inner
}

/// What is loaded and has come. Of regions so many are told of, of so many, with so many cells.
fn figures(ui: &mut Ui, words: &Words, stats: &StreamingStats, (told, regions, cells): (usize, usize, u32), bytes_s: Option<f64>) {
    ui.label(words.say_with(
        "expert-cells",
        &[("loaded", stats.cells.into()), ("all", cells.into()), ("told", told.into()), ("regions", regions.into())],
    ));
    ui.label(words.say_with(
        "expert-figures",
        &[
            ("content", bytes(words, stats.bytes_loaded).into()),
            ("received", bytes(words, stats.bytes_all).into()),
            ("requests", stats.requests.into()),
            ("flying", stats.in_flight.into()),
            ("failed", stats.failures.into()),
        ],
    ));
    ui.label(match bytes_s {
        Some(bytes_s) => words.say_with("expert-pace", &[("bytes", bytes(words, bytes_s as u64).into())]),
        None => words.say("expert-pace-unknown"),
    });
}

/// Memory of cells and of the city from afar, of so much that they may take.
fn memory(ui: &mut Ui, words: &Words, stats: &StreamingStats, afar: DistrictMemory, cap: u64) {
    let told = [("cells", stats.bytes_in_memory), ("afar", afar.bytes), ("cap", cap)];
    ui.label(words.say_with("expert-memory", &told.map(|(name, size)| (name, bytes(words, size).into()))));
}

/// Sliders of the simulated line; whether to ask again.
fn line(ui: &mut Ui, words: &Words, link: &mut Link, is_paused: &mut bool) -> bool {
    let mut pace = link.bytes_s.min(UNLIMITED);
    ui.add(number(words, &mut link.latency_s, 0.0..=3.0).text(words.say("expert-latency")));
    let told =
        |n: f64, _: RangeInclusive<usize>| if n >= UNLIMITED { words.say("expert-no-limit") } else { bytes(words, n as u64) };
    let slider = Slider::new(&mut pace, 1_000.0..=UNLIMITED).logarithmic(true).custom_formatter(told);
    ui.add(slider.text(words.say("expert-bandwidth")));
    ui.add(number(words, &mut link.loss, 0.0..=0.9).text(words.say("expert-loss")));
    link.bytes_s = if pace >= UNLIMITED { f64::INFINITY } else { pace };
    ui.horizontal(|ui| {
        ui.checkbox(&mut link.is_down, words.say("expert-down"));
        ui.checkbox(is_paused, words.say("expert-pause"));
    });
    ui.button(words.say("expert-ask")).clicked()
}

/// Whether the camera is above the walk.
fn aloft(ui: &mut Ui, words: &Words, is_aloft: &mut bool) {
    ui.checkbox(is_aloft, words.say("expert-aloft"));
}

/// A slider of a number that is read and written as the language does.
fn number<'a>(words: &'a Words, value: &'a mut f64, range: RangeInclusive<f64>) -> Slider<'a> {
    Slider::new(value, range)
        .custom_formatter(move |n, _| words.number(n, 2))
        .custom_parser(|text| text.trim().replace(',', ".").parse().ok())
}

/// How far levels of detail reach: as frames allow, or by hand.
fn levels(ui: &mut Ui, words: &Words, auto: AutoLevels, is_auto: &mut bool, percent: &mut f32) {
    let slider = Slider::new(percent, 0.0..=100.0).fixed_decimals(0).suffix(" %").text(words.say("expert-reach"));
    ui.add_enabled(!*is_auto, slider);
    let frames = auto.frame_s.recip().round() as u32;
    ui.checkbox(is_auto, words.say_with("expert-reach-auto", &[("frames", frames.into())]));
}

#[cfg(test)]
mod tests {
    use bevy_egui::egui::accesskit::Role;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use super::super::tongues;
    use super::*;

    /// What was chosen on the panel.
    #[derive(Default)]
    struct Chosen {
        link: Link,
        is_paused: bool,
        is_aloft: bool,
        is_auto: bool,
        percent: f32,
        asks: bool,
        closes: bool,
    }

    fn show(ui: &mut Ui, look: &Look, words: &Words, chosen: &mut Chosen) {
        look.dress(ui, Surface::Dusk);
        chosen.closes |= head(ui, look, words, words.say("expert-title"), "F2");
        figures(ui, words, &StreamingStats::default(), (1, 2, 3), Some(5_000.0));
        figures(ui, words, &StreamingStats::default(), (1, 2, 3), None);
        memory(ui, words, &StreamingStats::default(), DistrictMemory::default(), 9);
        chosen.asks |= line(ui, words, &mut chosen.link, &mut chosen.is_paused);
        aloft(ui, words, &mut chosen.is_aloft);
        levels(ui, words, AutoLevels::default(), &mut chosen.is_auto, &mut chosen.percent);
    }

    #[test]
    fn every_control_has_a_name_in_every_language_and_does_what_it_says() {
        let look = Look { text: 12.0, high_contrast: false, reduced_motion: true };
        for words in tongues() {
            let mut harness = Harness::builder()
                .with_size(Vec2::new(600.0, 700.0))
                .build_ui_state(|ui, chosen: &mut Chosen| show(ui, &look, &words, chosen), Chosen::default());
            harness.run();
            for name in ["expert-latency", "expert-bandwidth", "expert-loss", "expert-reach"] {
                harness.get_by_role_and_label(Role::Slider, &words.say(name));
            }
            let auto = words.say_with("expert-reach-auto", &[("frames", 50.into())]);
            for name in [words.say("expert-down"), words.say("expert-pause"), words.say("expert-aloft"), auto] {
                harness.get_by_role_and_label(Role::CheckBox, &name).click();
                harness.run();
            }
            for name in ["expert-ask", "bar-close"] {
                harness.get_by_label(&words.say(name)).click();
                harness.run();
            }
            let Chosen { link, is_paused, is_aloft, is_auto, asks, closes, .. } = harness.state();
            assert!(link.is_down && *is_paused && *is_aloft && *is_auto && *asks && *closes, "{}", words.language());
            assert!(harness.query_all_by_label_contains("expert-").next().is_none(), "{}", words.language());
        }
    }
}
