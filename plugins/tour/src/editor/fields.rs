//! The fields of what is selected: of a step, or of the tour itself.

use core::ops::RangeInclusive;

use bevy_egui::egui::{ComboBox, DragValue, Grid, ScrollArea, TextEdit, Ui};
use veduta_city::{Ease, Step, TourSetting, Where};
use veduta_route::StepKind;
use veduta_ui::Surface;

use super::act::Act;
use super::bench::{Acts, Bench, kind_name};
use super::{label, speech, spots};

/// A number's bounds, how fast it is dragged, and its unit.
pub(super) struct Measure {
    pub range: RangeInclusive<f64>,
    pub speed: f64,
    pub unit: &'static str,
}

const SECONDS: Measure = Measure { range: 0.0..=21_600.0, speed: 0.1, unit: "unit-s" };
const WALKS: Measure = Measure { range: 0.1..=10.0, speed: 0.02, unit: "unit-m-s" };
const FLIES: Measure = Measure { range: 0.1..=200.0, speed: 0.1, unit: "unit-m-s" };
const EYES: Measure = Measure { range: 0.2..=2000.0, speed: 0.02, unit: "unit-m" };
const VIEWS: Measure = Measure { range: 5.0..=140.0, speed: 0.5, unit: "unit-deg" };
const HOURS: Measure = Measure { range: 0.0..=24.0, speed: 0.05, unit: "unit-h" };
const DAYS: Measure = Measure { range: 1.0..=366.0, speed: 1.0, unit: "" };
const WET: Measure = Measure { range: 0.0..=1.0, speed: 0.01, unit: "" };

/// Shows the fields.
pub(super) fn show(ui: &mut Ui, bench: &Bench<'_>, acts: &mut Acts) {
    let (look, surface) = (&bench.look, Surface::Paper);
    let selected = bench.edit.selected();
    let title = match bench.step().and_then(|index| bench.edit.tour().steps.get(index)) {
        Some(step) => {
            let n = (selected.start as u32 + 1).into();
            bench.words.say_with("editor-step", &[("n", n), ("what", bench.say(kind_name(StepKind::of(step))).into())])
        }
        None if selected.is_empty() => bench.say("editor-whole"),
        None => bench.words.say_with("editor-selected", &[("n", (selected.len() as u32).into())]),
    };
    ui.label(look.words(title, 1.15, look.ink(surface)));
    if let Some(mistake) = bench.mistake(bench.step()).filter(|_| selected.len() <= 1) {
        ui.label(look.words(format!("⚠ {mistake}"), 0.95, look.accent(surface)));
    }
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| match bench.step() {
        Some(index) => {
            let Some(step) = bench.edit.tour().steps.get(index) else { return };
            let mut next = step.clone();
            ui.push_id(index, |ui| step_fields(ui, bench, &mut next));
            if next != *step {
                acts.push(Act::Replace(index, next));
            }
        }
        None if selected.is_empty() => tour_fields(ui, bench, acts),
        None => {}
    });
}

fn grid(ui: &mut Ui, bench: &Bench<'_>, fields: impl FnOnce(&mut Ui)) {
    let gap = [bench.look.text * 0.6, bench.look.text * 0.3];
    Grid::new("fields").num_columns(2).spacing(gap).show(ui, fields);
}

fn tour_fields(ui: &mut Ui, bench: &Bench<'_>, acts: &mut Acts) {
    let tour = bench.edit.tour();
    let mut next = tour.clone();
    speech::show(ui, bench, "field-title", &mut next.title, &mut next.translations, false);
    grid(ui, bench, |ui| {
        text(ui, bench, "field-city", &mut next.city);
        number(ui, bench, "field-speed", &mut next.speed, &WALKS);
        number(ui, bench, "field-eye", &mut next.eye_m, &EYES);
        number(ui, bench, "field-fov", &mut next.fov_deg, &VIEWS);
        hour(ui, bench, &mut next.hour);
        let mut day = f64::from(next.day);
        number(ui, bench, "field-day", &mut day, &DAYS);
        next.day = day.round().clamp(0.0, 366.0) as u16;
    });
    let settings = [
        (next.title != tour.title).then(|| TourSetting::Title(next.title.clone())),
        (next.translations != tour.translations).then(|| TourSetting::Translations(next.translations.clone())),
        (next.city != tour.city).then(|| TourSetting::City(next.city.clone())),
        (next.speed != tour.speed).then_some(TourSetting::Speed(next.speed)),
        (next.eye_m != tour.eye_m).then_some(TourSetting::EyeM(next.eye_m)),
        (next.fov_deg != tour.fov_deg).then_some(TourSetting::FovDeg(next.fov_deg)),
        (next.hour != tour.hour).then_some(TourSetting::Hour(next.hour)),
        (next.day != tour.day).then_some(TourSetting::Day(next.day)),
    ];
    acts.extend(settings.into_iter().flatten().map(Act::Set));
}

fn step_fields(ui: &mut Ui, bench: &Bench<'_>, step: &mut Step) {
    match step {
        Step::Start { at, eye_m, look } => {
            spots::place(ui, bench, "field-at", at);
            grid(ui, bench, |ui| optional(ui, bench, "field-eye", eye_m, bench.here.eye_m, &EYES));
            spots::gaze(ui, bench, look);
        }
        Step::Cut { to, eye_m, look, seconds } => {
            spots::place(ui, bench, "field-to", to);
            grid(ui, bench, |ui| {
                optional(ui, bench, "field-eye", eye_m, bench.here.eye_m, &EYES);
                number(ui, bench, "field-seconds", seconds, &SECONDS);
            });
            spots::gaze(ui, bench, look);
        }
        Step::Walk { to, via, speed, look, ease } => {
            spots::place(ui, bench, "field-to", to);
            vias(ui, bench, via);
            grid(ui, bench, |ui| {
                optional(ui, bench, "field-speed", speed, bench.edit.tour().speed, &WALKS);
                easing(ui, bench, ease);
            });
            spots::gaze(ui, bench, look);
        }
        Step::Fly { through, speed, look, ease } => {
            grid(ui, bench, |ui| {
                number(ui, bench, "field-speed", speed, &FLIES);
                easing(ui, bench, ease);
            });
            spots::gaze(ui, bench, look);
            spots::points(ui, bench, through);
        }
        // What was recorded elsewhere is mended there; its length is its edge on the line of time.
        Step::Track { keys } => _ = ui.label(label::key_frames(bench, keys.len())),
        Step::Look { at, seconds } => {
            spots::gaze(ui, bench, at);
            grid(ui, bench, |ui| number(ui, bench, "field-seconds", seconds, &SECONDS));
        }
        Step::Wait { seconds } => grid(ui, bench, |ui| number(ui, bench, "field-seconds", seconds, &SECONDS)),
        Step::Say { text, translations, seconds } => {
            speech::show(ui, bench, "field-text", text, translations, true);
            grid(ui, bench, |ui| optional(ui, bench, "field-seconds", seconds, 5.0, &SECONDS));
        }
        Step::Narrate { file, files, text: words, translations, seconds } => {
            speech::show(ui, bench, "field-recording", file, files, false);
            ui.push_id("words", |ui| speech::show(ui, bench, "field-text", words, translations, true));
            grid(ui, bench, |ui| optional(ui, bench, "field-seconds", seconds, 5.0, &SECONDS));
        }
        Step::Sound { file } => {
            let mut name = file.clone().unwrap_or_default();
            grid(ui, bench, |ui| text(ui, bench, "field-recording", &mut name));
            if name != file.clone().unwrap_or_default() {
                *file = (!name.is_empty()).then_some(name);
            }
        }
        Step::Picture { file, caption, translations, seconds } => {
            grid(ui, bench, |ui| {
                text(ui, bench, "field-picture", file);
                number(ui, bench, "field-seconds", seconds, &SECONDS);
            });
            speech::show(ui, bench, "field-caption", caption, translations, false);
        }
        Step::Chapter { title, translations } => speech::show(ui, bench, "field-title", title, translations, false),
        Step::Mark { name } => grid(ui, bench, |ui| text(ui, bench, "field-name", name)),
        Step::Rain { wet, seconds } => grid(ui, bench, |ui| {
            number(ui, bench, "field-wet", wet, &WET);
            number(ui, bench, "field-seconds", seconds, &SECONDS);
        }),
        Step::Fov { deg, seconds } => grid(ui, bench, |ui| {
            number(ui, bench, "field-fov", deg, &VIEWS);
            number(ui, bench, "field-seconds", seconds, &SECONDS);
        }),
        Step::Time { hour: at, seconds } => grid(ui, bench, |ui| {
            hour(ui, bench, at);
            number(ui, bench, "field-seconds", seconds, &SECONDS);
        }),
    }
}

/// Spots on the way, each of which can go; a new one is where the visitor is.
fn vias(ui: &mut Ui, bench: &Bench<'_>, via: &mut Vec<Where>) {
    let mut gone = None;
    for (n, spot) in via.iter_mut().enumerate() {
        ui.push_id(("via", n), |ui| {
            spots::place(ui, bench, "field-via", spot);
            if ui.small_button(bench.say("field-remove")).clicked() {
                gone = Some(n);
            }
        });
    }
    if let Some(n) = gone {
        via.remove(n);
    }
    if ui.button(bench.say("field-add-via")).clicked() {
        via.push(spots::here(bench));
    }
}

fn easing(ui: &mut Ui, bench: &Bench<'_>, ease: &mut Ease) {
    const EASES: [(Ease, &str); 4] =
        [(Ease::InOut, "ease-in-out"), (Ease::In, "ease-in"), (Ease::Out, "ease-out"), (Ease::Linear, "ease-linear")];
    let label = ui.label(bench.say("field-ease"));
    let shown = EASES.iter().find(|(is, _)| is == ease).map_or_else(String::new, |(_, name)| bench.say(name));
    let chosen = ComboBox::from_id_salt("ease").selected_text(shown).show_ui(ui, |ui| {
        for (is, name) in EASES {
            ui.selectable_value(ease, is, bench.say(name));
        }
    });
    chosen.response.labelled_by(label.id);
    ui.end_row();
}

fn hour(ui: &mut Ui, bench: &Bench<'_>, value: &mut f64) {
    let label = ui.label(bench.say("field-hour"));
    ui.horizontal(|ui| {
        drag(ui, bench, value, &HOURS).labelled_by(label.id);
        ui.label(bench.look.words(label::clock(*value), 0.95, bench.look.faint(Surface::Paper)));
    });
    ui.end_row();
}

fn text(ui: &mut Ui, bench: &Bench<'_>, name: &str, value: &mut String) {
    let label = ui.label(bench.say(name));
    ui.add(TextEdit::singleline(value).desired_width(bench.look.text * 10.0)).labelled_by(label.id);
    ui.end_row();
}

/// A number with its name and unit.
pub(super) fn number(ui: &mut Ui, bench: &Bench<'_>, name: &str, value: &mut f64, measure: &Measure) {
    let label = ui.label(bench.say(name));
    drag(ui, bench, value, measure).labelled_by(label.id);
    ui.end_row();
}

/// A number to be dragged or typed. One that a person has put out of bounds stays until it is changed: it is told as a mistake.
pub(super) fn drag(ui: &mut Ui, bench: &Bench<'_>, value: &mut f64, measure: &Measure) -> bevy_egui::egui::Response {
    let unit = if measure.unit.is_empty() { String::new() } else { format!(" {}", bench.say(measure.unit)) };
    let field = DragValue::new(value).range(measure.range.clone()).clamp_existing_to_range(false).speed(measure.speed);
    ui.add(field.max_decimals(2).suffix(unit))
}

/// A number that may be left to what is usual.
fn optional(ui: &mut Ui, bench: &Bench<'_>, name: &str, value: &mut Option<f64>, usual: f64, measure: &Measure) {
    let mut is_set = value.is_some();
    let checkbox = ui.checkbox(&mut is_set, bench.say(name));
    if checkbox.changed() {
        *value = is_set.then_some((usual * 100.0).round() / 100.0);
    }
    match value {
        Some(number) => _ = drag(ui, bench, number, measure).labelled_by(checkbox.id),
        None => _ = ui.label(bench.look.words(bench.say("field-usual"), 0.95, bench.look.faint(Surface::Paper))),
    }
    ui.end_row();
}
