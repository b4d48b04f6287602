use bevy_egui::egui::{Button, RichText, ScrollArea, Ui, WidgetInfo, WidgetType};
use veduta::controls::{Always, Capture, ControlList, Controls, KeyCaps, Listed, Place, Scope, label, message_of};
use veduta::ecs::Words;
use veduta::ui::{Look, Surface, Symbol, symbol_button};

/// What the window of keys shows.
#[derive(Clone, Copy)]
pub(super) struct Shown<'a> {
    pub list: &'a ControlList,
    pub controls: &'a Controls,
    pub caps: &'a KeyCaps,
    /// Where the next input that is pressed goes.
    pub waiting: Option<Place>,
}

/// What was pressed in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Press {
    /// Wait for an input.
    Wait(Place),
    /// Bind a control as at first.
    Reset(&'static str),
    /// Bind all as at first.
    ResetAll,
}

impl Press {
    /// Does what was pressed.
    pub fn act(self, list: &ControlList, controls: &mut Controls, capture: &mut Capture) {
        match self {
            Self::Wait(place) => capture.wait(place),
            Self::Reset(name) => list.get(name).into_iter().for_each(|control| controls.reset(control)),
            Self::ResetAll => controls.reset_all(),
        }
    }
}

/// The list of controls by when they are heard, each with what it is bound to.
pub(super) fn show(ui: &mut Ui, look: &Look, words: &Words, shown: Shown<'_>) -> Option<Press> {
    let surface = Surface::Paper;
    let mut press = None;
    let hint = if shown.waiting.is_some() { "keys-waits" } else { "keys-hint" };
    let ink = if shown.waiting.is_some() { look.accent(surface) } else { look.faint(surface) };
    ui.label(look.words(words.say(hint), 0.95, ink));
    // What is pressed now is an input, and nothing of the window.
    ui.add_enabled_ui(shown.waiting.is_none(), |ui| {
        let height = ui.ctx().content_rect().height() * 0.62;
        ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
            // Walking first, and last what is the same everywhere.
            let (always, sometimes): (Vec<&str>, Vec<&str>) = shown.list.scopes().partition(|scope| *scope == Always::NAME);
            for scope in sometimes.into_iter().chain(always) {
                ui.add_space(look.text * 0.4);
                ui.label(look.words(words.say(&format!("scope-{scope}")), 1.05, look.accent(surface)));
                for control in shown.list.iter().filter(|control| control.scope == scope) {
                    press = row(ui, look, words, shown, control).or(press);
                }
            }
        });
        if ui.button(words.say("keys-reset-all")).clicked() {
            press = Some(Press::ResetAll);
        }
    });
    press
}

/// Width of what controls do, and of what they are bound to, in heights of letters.
const WIDE: (f32, f32) = (18.0, 28.0);

/// A control: what it does, its inputs, what else they do, and a way back.
fn row(ui: &mut Ui, look: &Look, words: &Words, shown: Shown<'_>, control: &Listed) -> Option<Press> {
    let what = words.say(&message_of(control.name));
    let share = (ui.ctx().content_rect().width() * 0.9 / (look.text * (WIDE.0 + WIDE.1))).min(1.0);
    let (left, right) = (look.text * WIDE.0 * share, look.text * WIDE.1 * share);
    let columns = ui.horizontal_top(|ui| {
        ui.vertical(|ui| {
            ui.set_width(left);
            ui.add_space(look.text * 0.15);
            ui.label(&what);
        });
        let inputs = ui.vertical(|ui| {
            ui.set_width(right);
            ui.horizontal_wrapped(|ui| inputs(ui, look, words, shown, (control, &what))).inner
        });
        inputs.inner
    });
    columns.inner
}

/// The inputs of a control, told by what it does.
fn inputs(ui: &mut Ui, look: &Look, words: &Words, shown: Shown<'_>, (control, what): (&Listed, &String)) -> Option<Press> {
    let surface = Surface::Paper;
    let mut press = None;
    let bound = shown.controls.bound(control);
    ui.spacing_mut().item_spacing.x = look.text * 0.3;
    for nth in 0..=bound.len() {
        let place = Place { control: control.name, nth };
        let (text, name) = match bound.get(nth) {
            Some(input) => {
                let input = label(*input, words, shown.caps);
                (input.clone(), say(words, "keys-change", &[("what", what), ("input", &input)]))
            }
            None => ("+".to_owned(), say(words, "keys-add", &[("what", what)])),
        };
        let is_waiting = shown.waiting == Some(place);
        let text = if is_waiting { words.say("keys-press") } else { text };
        let ink = if is_waiting { look.accent(surface) } else { look.ink(surface) };
        let button = ui.add(Button::new(look.words(text, 0.95, ink)));
        button.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, &name));
        if button.clicked() {
            // The key that is pressed next is not meant for the button.
            button.surrender_focus();
            press = Some(Press::Wait(place));
        }
    }
    if shown.controls.is_changed_from_first(control) {
        let name = say(words, "keys-reset", &[("what", what)]);
        if symbol_button(ui, look, surface, Symbol::Reconnect, false, &name, "").clicked() {
            press = Some(Press::Reset(control.name));
        }
    }
    for told in conflicts(words, shown, control) {
        ui.label(look.words(told, 0.85, look.accent(surface)).strong());
    }
    press
}

/// What else the inputs of a control do at the same time, in words.
fn conflicts(words: &Words, shown: Shown<'_>, control: &Listed) -> Vec<String> {
    let told = |input| {
        let others = shown.controls.others(shown.list, control, input);
        let others: Vec<String> = others.into_iter().map(|name| words.say(&message_of(name))).collect();
        let input = label(input, words, shown.caps);
        (!others.is_empty()).then(|| say(words, "keys-conflict", &[("input", &input), ("others", &others.join(", "))]))
    };
    shown.controls.bound(control).iter().filter_map(|input| told(*input)).collect()
}

fn say(words: &Words, message: &str, values: &[(&str, &String)]) -> String {
    let values: Vec<_> = values.iter().map(|(name, value)| (*name, (*value).clone().into())).collect();
    words.say_with(message, &values)
}

/// Parts of the settings' window.
#[derive(bevy::prelude::Resource, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Part {
    /// All but keys.
    #[default]
    General,
    /// Keys.
    Keys,
}

/// The heads of both parts: one of them is chosen.
pub(super) fn choose(ui: &mut Ui, look: &Look, words: &Words, part: &mut Part) {
    for (choice, name) in [(Part::General, "settings-general"), (Part::Keys, "settings-keys")] {
        let text: RichText = look.words(words.say(name), 1.0, look.ink(Surface::Paper));
        ui.selectable_value(part, choice, text);
    }
}

#[cfg(test)]
mod tests {
    use bevy::prelude::*;
    use bevy_egui::egui::{Vec2, accesskit::Role};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;
    use veduta::controls::Input;

    use super::*;

    struct Bench {
        controls: Controls,
        capture: Capture,
    }

    fn harness(app: &App) -> Harness<'_, Bench> {
        let look = Look { text: 14.0, high_contrast: false, reduced_motion: true };
        let list = app.world().resource::<ControlList>();
        let words = app.world().resource::<Words>();
        let bench = Bench { controls: Controls::default(), capture: Capture::default() };
        Harness::builder().with_size(Vec2::new(1100.0, 4000.0)).build_ui_state(
            move |ui, bench: &mut Bench| {
                let shown = Shown { list, controls: &bench.controls, caps: &KeyCaps::default(), waiting: bench.capture.place() };
                if let Some(press) = show(ui, &look, words, shown) {
                    press.act(list, &mut bench.controls, &mut bench.capture);
                }
            },
            bench,
        )
    }

    #[test]
    fn every_input_of_every_control_can_be_chosen_by_name() {
        let app = super::super::controls::app();
        let list = app.world().resource::<ControlList>();
        let words = app.world().resource::<Words>();
        let mut harness = harness(&app);
        harness.run();
        for control in list.iter() {
            let what = words.say(&message_of(control.name));
            for (nth, input) in control.defaults.iter().enumerate() {
                let input = label(*input, words, &KeyCaps::default());
                let name = say(words, "keys-change", &[("what", &what), ("input", &input)]);
                harness.get_by_role_and_label(Role::Button, &name).click();
                harness.run();
                assert_eq!(harness.state_mut().capture.place(), Some(Place { control: control.name, nth }), "{name}");
                harness.state_mut().capture.leave();
                harness.run();
            }
        }
    }

    #[test]
    fn conflicts_are_told_with_names_and_taken_back() {
        let app = super::super::controls::app();
        let list = app.world().resource::<ControlList>();
        let mut harness = harness(&app);
        harness.run();
        assert!(harness.query_by_label_contains("also").is_none(), "at first there is none");
        let run = list.get("walk.run").expect("listed");
        harness.state_mut().controls.put(run, 0, Input::key(KeyCode::KeyT));
        harness.run();
        harness.get_by_label("T is also: tour: begin, pause, go on");
        harness.get_by_label("T is also: run");
        harness.get_by_label("As at first: run").click();
        harness.run();
        assert_eq!(harness.state().controls, Controls::default());
        harness.state_mut().controls.set(run, vec![]);
        harness.run();
        harness.get_by_label("Another input: run").click();
        harness.run();
        assert_eq!(harness.state().capture.place(), Some(Place { control: "walk.run", nth: 0 }));
        harness.get_by_label_contains("Esc leaves it");
        harness.get_by_label("All as at first").click();
        harness.run();
        assert_ne!(harness.state().controls, Controls::default(), "a click is an input now");
        harness.state_mut().capture.leave();
        harness.run();
        harness.get_by_label("All as at first").click();
        harness.run();
        assert_eq!(harness.state().controls, Controls::default());
    }
}
