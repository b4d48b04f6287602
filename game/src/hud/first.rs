use bevy::math::DVec2;
use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{Align2, Area, Id, Order, ProgressBar, Ui, Vec2};
use veduta::controls::{Device, KeyNames, Layers};
use veduta::ecs::{Interface, Words, WordsValue};
use veduta::guide::SearchBox;
use veduta::guide::controls::SearchOpen;
use veduta::minimap::MapView;
use veduta::minimap::controls::MapOpen;
use veduta::prelude::*;
use veduta::tour::controls::TourPause;
use veduta::tour::{TourEditor, TourState};
use veduta::ui::{Look, Surface};
use veduta::walker::Intent;
use veduta::walker::controls::{LookHold, WalkForward};
use veduta_route::turn_deg;

use super::controls::HelpOpen;
use crate::settings::Settings;
use crate::walk::FirstTour;

/// The first minute: walking, looking, search, map and tour are learned by doing them.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct FirstMinute {
    step: usize,
    /// How much of the step is done, 0 to 1.
    done: f64,
    /// Where the eye was in the frame before, and where it looked.
    last: Option<(DVec2, f64)>,
    /// For how long its end has been shown, seconds.
    ended_s: f64,
}

const STEPS: [&str; 5] = ["first-walk", "first-look", "first-search", "first-map", "first-tour"];
/// So far one walks, metres, and turns, degrees, to have learned it.
const WALKS_M: f64 = 5.0;
const TURNS_DEG: f64 = 60.0;
/// The end is shown so long, seconds.
const ENDS_S: f64 = 5.0;
/// Farther in a frame nobody walks: a jump.
const LEAPS_M: f64 = 3.0;

impl FirstMinute {
    /// Which step, from 1.
    pub fn step(&self) -> usize {
        self.step + 1
    }

    fn is_over(&self) -> bool {
        self.step >= STEPS.len()
    }

    /// What was done in a frame.
    fn pass(&mut self, eye: &Eye, intent: &Intent, opened: [bool; 3]) {
        let (pos, heading) = self.last.unwrap_or((eye.plan_pos, eye.heading_deg));
        self.last = Some((eye.plan_pos, eye.heading_deg));
        let walked_m = pos.distance(eye.plan_pos);
        let turned_deg = turn_deg(heading, eye.heading_deg).abs();
        let [search, map, tour] = opened;
        self.done += match self.step {
            0 if intent.go != bevy::math::DVec3::ZERO && walked_m < LEAPS_M => walked_m / WALKS_M,
            1 if intent.turn_deg != 0.0 => turned_deg / TURNS_DEG,
            2 if search => 1.0,
            3 if map => 1.0,
            4 if tour => 1.0,
            _ => 0.0,
        };
        if self.done >= 1.0 {
            (self.step, self.done) = (self.step + 1, 0.0);
        }
    }
}

/// Whether a tour is to be seen.
fn is_busy(player: &TourPlayer) -> bool {
    matches!(player.state(), TourState::Playing | TourState::Waiting | TourState::Returning)
}

/// Watches what the visitor does.
pub(super) fn watch(
    time: Res<Time<Real>>,
    viewers: Query<&Eye, With<Viewer>>,
    intent: Res<Intent>,
    (search, map, player): (Res<SearchBox>, Res<MapView>, Res<TourPlayer>),
    tours: Option<Res<FirstTour>>,
    mut first: ResMut<FirstMinute>,
    mut settings: ResMut<Settings>,
) {
    if settings.knows_the_way {
        return;
    }
    if first.is_over() {
        // Its end is there to be read.
        if !is_busy(&player) {
            first.ended_s += time.delta_secs_f64();
        }
        if first.ended_s > ENDS_S {
            settings.knows_the_way = true;
        }
    } else if let Some(eye) = viewers.iter().next() {
        // Where there is no tour, none is to be taken.
        let tour = is_busy(&player) || (tours.is_none() && player.state() == TourState::Idle);
        let next = {
            let mut next = *first;
            next.pass(eye, &intent, [search.open, map.open, tour]);
            next
        };
        first.set_if_neq(next);
    }
}

pub(super) fn draw(
    mut contexts: EguiContexts,
    (words, interface, keys, layers): (Res<Words>, Res<Interface>, Res<KeyNames>, Res<Layers>),
    (player, steering): (Res<TourPlayer>, Res<Steering>),
    (first, editor): (Res<FirstMinute>, Res<TourEditor>),
    mut settings: ResMut<Settings>,
) -> Result {
    // Who is led does not learn, and what a tour shows lies where the card does.
    let is_led = *steering == Steering::Led || is_busy(&player) || editor.is_open();
    if settings.knows_the_way || is_led || layers.has_page() {
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    let look = Look::of(&interface, context);
    // Below the strip of a tour and the line of a walk.
    let offset = Vec2::new(0.0, context.content_rect().height() * 0.03 + look.text * 5.0);
    let area = Area::new(Id::new("veduta first minute")).anchor(Align2::CENTER_TOP, offset).order(Order::Middle);
    let skips =
        area.show(context, |ui| look.frame(Surface::Paper).show(ui, |ui| show(ui, &look, (&words, &keys), &first)).inner).inner;
    if skips {
        settings.knows_the_way = true;
    }
    Ok(())
}

/// What a step tells to do, with the keys as they are bound, on the device that is in the hand.
fn told(words: &Words, keys: &KeyNames, step: &str) -> String {
    let on = |device: &str| format!("{step}-{device}");
    let message = match (step, keys.device()) {
        ("first-walk" | "first-look", Device::Touch) => on("touch"),
        ("first-walk" | "first-look", Device::Pad) => on("pad"),
        _ => step.to_owned(),
    };
    let values: [(&str, WordsValue); 6] = [
        ("walk", keys.all::<WalkForward>().into()),
        ("look", keys.said::<LookHold>(words).into()),
        ("find", keys.said::<SearchOpen>(words).into()),
        ("map", keys.said::<MapOpen>(words).into()),
        ("tour", keys.said::<TourPause>(words).into()),
        ("help", keys.said::<HelpOpen>(words).into()),
    ];
    words.say_with(&message, &values)
}

/// The card of a step; whether to skip the rest.
fn show(ui: &mut Ui, look: &Look, (words, keys): (&Words, &KeyNames), first: &FirstMinute) -> bool {
    let surface = Surface::Paper;
    look.dress(ui, surface);
    ui.set_max_width(look.text * 28.0);
    let all = STEPS.len() as u32;
    let Some(step) = STEPS.get(first.step) else {
        ui.label(look.words(told(words, keys, "first-done"), 1.15, look.ink(surface)));
        return false;
    };
    ui.horizontal(|ui| {
        ui.label(look.words(words.say("first-title"), 0.9, look.faint(surface)));
        let count = words.say_with("first-step", &[("n", (first.step as u32 + 1).into()), ("all", all.into())]);
        ui.label(look.words(count, 0.9, look.faint(surface)));
    });
    ui.label(look.words(told(words, keys, step), 1.15, look.ink(surface)));
    ui.horizontal(|ui| {
        let share = (first.step as f32 + first.done.clamp(0.0, 1.0) as f32) / all as f32;
        let bar =
            ProgressBar::new(share).desired_width(look.text * 20.0).desired_height(look.text * 0.5).fill(look.accent(surface));
        ui.add(bar);
        ui.button(words.say("first-skip")).clicked()
    })
    .inner
}

#[cfg(test)]
mod tests {
    use bevy::math::DVec3;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;
    use veduta::controls::{ControlList, Controls, KeyCaps};

    use super::*;

    fn keys(device: Device) -> KeyNames {
        let app = super::super::controls::app();
        let (list, words) = (app.world().resource::<ControlList>(), app.world().resource::<Words>());
        KeyNames::tell(list, &Controls::default(), device, words, &KeyCaps::default())
    }

    #[test]
    fn steps_are_told_for_what_is_in_the_hand() {
        let mut words = Words::default();
        super::super::WORDS.iter().for_each(|(code, file)| words.add(code, file).expect("no mistakes"));
        for language in ["en", "cs", "it"] {
            words.speak(language);
            let told = |device| STEPS.map(|step| told(&words, &keys(device), step)).join(" ");
            assert!(told(Device::Keys).contains("W · ⬆") && told(Device::Keys).contains('/'), "{}", told(Device::Keys));
            assert!(told(Device::Pad).contains("left stick ⬆") && told(Device::Pad).contains("Pad X"), "{}", told(Device::Pad));
            assert!(!told(Device::Touch).contains("W · ⬆") && !told(Device::Touch).contains("mouse"), "{}", told(Device::Touch));
        }
    }

    #[test]
    fn each_step_is_learned_by_doing_it() {
        let mut first = FirstMinute::default();
        let mut eye = Eye::default();
        let walks = Intent { go: DVec3::Y, ..Intent::default() };
        let turns = Intent { turn_deg: 3.0, ..Intent::default() };
        for _ in 0..60 {
            eye.plan_pos.x += 0.2;
            first.pass(&eye, &Intent::default(), [true, true, true]);
        }
        assert_eq!(first.step, 0, "who is carried has not walked");
        eye.plan_pos.x += 400.0;
        first.pass(&eye, &walks, [false; 3]);
        assert_eq!(first.step, 0, "nor who has leapt");
        for _ in 0..30 {
            eye.plan_pos.x += 0.2;
            first.pass(&eye, &walks, [false; 3]);
        }
        assert_eq!(first.step, 1);
        for _ in 0..40 {
            eye.heading_deg = (eye.heading_deg + 3.0).rem_euclid(360.0);
            first.pass(&eye, &turns, [false; 3]);
        }
        assert_eq!(first.step, 2);
        for opened in [[true, false, false], [false, true, false], [false, false, true]] {
            first.pass(&eye, &turns, opened);
        }
        assert!(first.is_over());
    }

    #[test]
    fn the_card_can_be_skipped() {
        let look = Look { text: 16.0, high_contrast: false, reduced_motion: true };
        let mut words = Words::default();
        super::super::WORDS.iter().for_each(|(code, file)| words.add(code, file).expect("no mistakes"));
        let first = FirstMinute { step: 2, ..FirstMinute::default() };
        let keys = keys(Device::Keys);
        let mut harness = Harness::new_ui_state(|ui, skips: &mut bool| *skips |= show(ui, &look, (&words, &keys), &first), false);
        harness.get_by_label("3 of 5");
        harness.get_by_label_contains("Press / and type");
        harness.get_by_label("Skip").click();
        harness.run();
        assert!(*harness.state());
    }
}
