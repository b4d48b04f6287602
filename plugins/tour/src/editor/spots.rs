//! Fields of spots, directions and points.

use bevy_egui::egui::{ComboBox, TextEdit, Ui};
use veduta_city::{LookAt, Where};
use veduta_ui::Surface;

use super::bench::Bench;
use super::fields::{Measure, drag};

const PLAN: Measure = Measure { range: -2_000_000.0..=2_000_000.0, speed: 0.2, unit: "unit-m" };
const HEIGHT: Measure = Measure { range: -500.0..=5_000.0, speed: 0.2, unit: "unit-m" };
const HEADING: Measure = Measure { range: -360.0..=360.0, speed: 1.0, unit: "unit-deg" };
const PITCH: Measure = Measure { range: -90.0..=90.0, speed: 1.0, unit: "unit-deg" };
const OVER: Measure = Measure { range: 0.2..=5_000.0, speed: 0.1, unit: "unit-m" };

/// So many names are offered.
const OFFERED: usize = 5;

/// Where the visitor is, as a spot.
pub(super) fn here(bench: &Bench<'_>) -> Where {
    let tenth = |n: f64| (n * 10.0).round() / 10.0;
    Where::At(tenth(bench.here.plan_pos.x), tenth(bench.here.plan_pos.y))
}

/// A spot: a place's name, completed while it is typed, or plan metres.
pub(super) fn place(ui: &mut Ui, bench: &Bench<'_>, name: &str, at: &mut Where) {
    ui.push_id(name, |ui| {
        ui.horizontal(|ui| {
            let label = ui.label(bench.say(name));
            let is_place = matches!(at, Where::Place(_));
            let shown = bench.say(if is_place { "where-place" } else { "where-point" });
            let mut wants_place = is_place;
            let chosen = ComboBox::from_id_salt("where").selected_text(shown).show_ui(ui, |ui| {
                ui.selectable_value(&mut wants_place, true, bench.say("where-place"));
                ui.selectable_value(&mut wants_place, false, bench.say("where-point"));
            });
            chosen.response.labelled_by(label.id);
            if wants_place != is_place {
                *at = other(bench, at);
            }
            if ui.button(bench.say("where-here")).on_hover_text(bench.say("where-here-hint")).clicked() {
                *at = here(bench);
            }
        });
        match at {
            Where::Place(typed) => named(ui, bench, typed),
            Where::At(x, y) => {
                ui.horizontal(|ui| {
                    coordinate(ui, bench, "where-x", x, &PLAN);
                    coordinate(ui, bench, "where-y", y, &PLAN);
                });
            }
        }
    });
}

fn coordinate(ui: &mut Ui, bench: &Bench<'_>, name: &str, value: &mut f64, measure: &Measure) {
    let label = ui.label(bench.look.words(bench.say(name), 0.9, bench.look.faint(Surface::Paper)));
    drag(ui, bench, value, measure).labelled_by(label.id);
}

/// The same told the other way: a point by the name of what is nearest, a place by where one stands for it.
fn other(bench: &Bench<'_>, at: &Where) -> Where {
    let places = bench.streets.map(|streets| &streets.places);
    match at {
        Where::At(x, y) => {
            let near = places.and_then(|places| places.nearest((*x, *y).into(), f64::INFINITY));
            Where::Place(near.map_or_else(String::new, |(name, _)| name.to_owned()))
        }
        Where::Place(name) => match places.and_then(|places| places.find(name)) {
            Some(place) => {
                let stand = place.view.map_or(place.pos, |view| view.pos);
                Where::At((stand.x * 10.0).round() / 10.0, (stand.y * 10.0).round() / 10.0)
            }
            None => here(bench),
        },
    }
}

/// A name, and below it those that may be meant.
fn named(ui: &mut Ui, bench: &Bench<'_>, typed: &mut String) {
    ui.horizontal(|ui| {
        let label = ui.label(bench.look.words(bench.say("where-name"), 0.9, bench.look.faint(Surface::Paper)));
        let field = TextEdit::singleline(typed).id_salt("name").desired_width(ui.available_width());
        ui.add(field.hint_text(bench.say("where-hint"))).labelled_by(label.id);
    });
    let Some(streets) = bench.streets else { return };
    if streets.places.find(typed).is_some() {
        return;
    }
    for hit in streets.finder().find(typed, Some(bench.here.plan_pos), OFFERED) {
        let Some(name) = streets.finder().named().get(hit.index).and_then(|named| named.names.first()) else { continue };
        if ui.selectable_label(false, name).clicked() {
            typed.clone_from(name);
        }
    }
}

/// Which of the three gazes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Gaze {
    Ahead,
    Spot,
    Heading,
}

const GAZES: [(Gaze, &str); 3] = [(Gaze::Ahead, "look-ahead"), (Gaze::Spot, "look-spot"), (Gaze::Heading, "look-heading")];

/// Where the eye turns.
pub(super) fn gaze(ui: &mut Ui, bench: &Bench<'_>, look: &mut LookAt) {
    let is = match look {
        LookAt::Ahead => Gaze::Ahead,
        LookAt::Spot { .. } => Gaze::Spot,
        LookAt::Heading { .. } => Gaze::Heading,
    };
    let mut wanted = is;
    ui.horizontal(|ui| {
        let label = ui.label(bench.say("field-look"));
        let shown = GAZES.iter().find(|(gaze, _)| *gaze == is).map_or_else(String::new, |(_, name)| bench.say(name));
        let chosen = ComboBox::from_id_salt("gaze").selected_text(shown).show_ui(ui, |ui| {
            for (gaze, name) in GAZES {
                ui.selectable_value(&mut wanted, gaze, bench.say(name));
            }
        });
        chosen.response.labelled_by(label.id);
        if ui.button(bench.say("look-mine")).on_hover_text(bench.say("look-mine-hint")).clicked() {
            *look = mine(bench);
            wanted = Gaze::Heading;
        }
    });
    if wanted != is && !(wanted == Gaze::Heading && matches!(look, LookAt::Heading { .. })) {
        *look = match wanted {
            Gaze::Ahead => LookAt::Ahead,
            Gaze::Spot => LookAt::Spot { at: other(bench, &here(bench)), height_m: 2.0, follow: None },
            Gaze::Heading => mine(bench),
        };
    }
    match look {
        LookAt::Ahead => {}
        LookAt::Spot { at, height_m, follow } => {
            place(ui, bench, "look-at", at);
            ui.horizontal(|ui| coordinate(ui, bench, "look-height", height_m, &HEIGHT));
            ui.horizontal(|ui| {
                let mut name = follow.clone().unwrap_or_default();
                let label = ui.label(bench.say("look-follow"));
                let field = TextEdit::singleline(&mut name).desired_width(bench.look.text * 10.0);
                ui.add(field).labelled_by(label.id).on_hover_text(bench.say("look-follow-hint"));
                *follow = (!name.is_empty()).then_some(name);
            });
        }
        LookAt::Heading { deg, pitch_deg } => {
            ui.horizontal(|ui| {
                coordinate(ui, bench, "look-deg", deg, &HEADING);
                coordinate(ui, bench, "look-pitch", pitch_deg, &PITCH);
            });
        }
    }
}

/// As the visitor looks.
fn mine(bench: &Bench<'_>) -> LookAt {
    let deg = bench.here.heading_deg.rem_euclid(360.0).round().rem_euclid(360.0);
    LookAt::Heading { deg, pitch_deg: bench.here.pitch_deg.round() }
}

/// The points of a flight.
pub(super) fn points(ui: &mut Ui, bench: &Bench<'_>, through: &mut Vec<(f64, f64, f64)>) {
    ui.label(bench.say("field-through"));
    let mut gone = None;
    for (n, (x, y, height)) in through.iter_mut().enumerate() {
        ui.push_id(("point", n), |ui| {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = bench.look.text * 0.2;
                let number = bench.look.words(format!("{}", n + 1), 0.85, bench.look.faint(Surface::Paper));
                ui.label(number);
                for (value, name, measure) in [(x, "where-x", &PLAN), (y, "where-y", &PLAN), (height, "look-height", &OVER)] {
                    let name =
                        bench.words.say_with("field-point", &[("n", (n as u32 + 1).into()), ("what", bench.say(name).into())]);
                    let value_now = *value;
                    let response = drag(ui, bench, value, measure);
                    response.widget_info(|| bevy_egui::egui::WidgetInfo::slider(true, value_now, &name));
                    response.on_hover_text(name);
                }
                let name = bench.words.say_with("field-remove-point", &[("n", (n as u32 + 1).into())]);
                let response = ui.small_button("×");
                response.widget_info(|| bevy_egui::egui::WidgetInfo::labeled(bevy_egui::egui::WidgetType::Button, true, &name));
                if response.on_hover_text(name).clicked() {
                    gone = Some(n);
                }
            });
        });
    }
    if let Some(n) = gone {
        through.remove(n);
    }
    if ui.button(bench.say("field-add-point")).clicked() {
        let tenth = |n: f64| (n * 10.0).round() / 10.0;
        let here = bench.here;
        through.push((tenth(here.plan_pos.x), tenth(here.plan_pos.y), ((here.eye_m * 100.0).round() / 100.0).max(0.2)));
    }
}
