use std::collections::VecDeque;

use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{Align2, Area, Id, Order, Vec2};
use veduta::controls::KeyNames;
use veduta::ecs::{Docks, Interface, Words, WordsValue};
use veduta::guide::controls::SearchOpen;
use veduta::guide::{CityGuide, PanelSettings, WalkEnded};
use veduta::prelude::*;
use veduta::tour::controls::TourPause;
use veduta::ui::{Look, Surface};
use veduta::walker::Intent;
use veduta::walker::controls::{Fly, WalkForward};

use super::controls::HelpOpen;
use crate::expert::Expert;
use crate::settings::{DroppedKeys, Settings};

/// Short notes at the top right: what has gone wrong, what has ended, what helps who is stuck.
#[derive(Resource, Default)]
pub(super) struct Notes {
    shown: VecDeque<Note>,
    stuck: Stuck,
}

struct Note {
    text: String,
    /// Whether it tells of something that failed: an expert reads that in the journal.
    is_failure: bool,
    since_s: f64,
}

/// Seconds that a note stays, and how many there are at most.
const STAY_S: f64 = 8.0;
const MOST: usize = 4;

impl Notes {
    pub fn add(&mut self, text: String, is_failure: bool, now_s: f64) {
        match self.shown.iter_mut().find(|note| note.text == text) {
            // What goes on stays.
            Some(note) => note.since_s = note.since_s.max(now_s),
            None => self.shown.push_back(Note { text, is_failure, since_s: now_s }),
        }
        while self.shown.len() > MOST {
            self.shown.pop_front();
        }
    }

    /// Adds a note that is shown only after a moment.
    pub fn add_later(&mut self, text: String, now_s: f64) {
        self.add(text, false, now_s + LATER_S);
    }
}

/// Notes that come a little later do so after so many seconds.
const LATER_S: f64 = 1.5;

/// Gathers what is to be noted.
pub(super) fn gather(
    time: Res<Time<Real>>,
    (words, guide, keys): (Res<Words>, Res<CityGuide>, Res<KeyNames>),
    mut failures: MessageReader<CityFailed>,
    mut tours: MessageReader<TourEnded>,
    mut walks: MessageReader<WalkEnded>,
    mut dropped: ResMut<DroppedKeys>,
    mut notes: ResMut<Notes>,
) {
    let now_s = time.elapsed_secs_f64();
    if !dropped.0.is_empty() {
        for what in core::mem::take(&mut dropped.0) {
            notes.add(words.say_with("keys-dropped", &[("what", what.into())]), true, now_s);
        }
    }
    for failure in failures.read() {
        notes.add(failure.message.clone(), true, now_s);
    }
    if tours.read().any(|tour| tour.finished) {
        notes.add(told(&words, &keys, "tour-ended"), false, now_s);
    }
    for walk in walks.read().filter(|walk| walk.arrived && !walk.name.is_empty()) {
        let name = guide.name(&walk.name, &words).to_owned();
        notes.add(words.say_with("walk-arrived", &[("name", name.into())]), false, now_s);
    }
    if notes.shown.iter().any(|note| now_s - note.since_s >= STAY_S) {
        notes.shown.retain(|note| now_s - note.since_s < STAY_S);
    }
}

/// A note with the keys as they are bound now.
fn told(words: &Words, keys: &KeyNames, message: &str) -> String {
    let values: [(&str, WordsValue); 5] = [
        ("walk", keys.said::<WalkForward>(words).into()),
        ("fly", keys.said::<Fly>(words).into()),
        ("find", keys.said::<SearchOpen>(words).into()),
        ("tour", keys.said::<TourPause>(words).into()),
        ("help", keys.said::<HelpOpen>(words).into()),
    ];
    words.say_with(message, &values)
}

/// Whether somebody walks and does not get on, or does nothing at all.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Stuck {
    from: DVec2,
    walks_s: f64,
    idle_s: f64,
}

/// Who walks so long, seconds, and gets no farther than this, metres, is stuck; who does nothing for so long at the beginning is at a loss.
const STUCK_S: f64 = 3.5;
const STUCK_M: f64 = 0.6;
const IDLE_S: f64 = 30.0;

impl Stuck {
    /// A hint that helps, after a frame.
    fn pass(&mut self, eye: &Eye, intent: &Intent, seconds: f64, knows_the_way: bool) -> Option<&'static str> {
        let walks = intent.go != DVec3::ZERO;
        if !walks || self.from.distance(eye.plan_pos) > STUCK_M {
            (self.from, self.walks_s) = (eye.plan_pos, 0.0);
        } else {
            self.walks_s += seconds;
        }
        self.idle_s = if intent.is_moving() || !knows_the_way { 0.0 } else { self.idle_s + seconds };
        if self.walks_s >= STUCK_S {
            self.walks_s = 0.0;
            return Some("hint-stuck");
        }
        // Once, not every half a minute: whoever looks at a square for long is not at a loss.
        if (IDLE_S..IDLE_S + seconds).contains(&self.idle_s) {
            return Some("hint-idle");
        }
        None
    }
}

/// Watches for who is stuck.
pub(super) fn watch(
    time: Res<Time<Real>>,
    (words, keys): (Res<Words>, Res<KeyNames>),
    steering: Res<Steering>,
    settings: Res<Settings>,
    intent: Res<Intent>,
    viewers: Query<&Eye, With<Viewer>>,
    mut notes: ResMut<Notes>,
) {
    let Some(eye) = viewers.iter().next().filter(|_| *steering == Steering::Visitor) else { return };
    let hint = notes.bypass_change_detection().stuck.pass(eye, &intent, time.delta_secs_f64().min(0.25), settings.knows_the_way);
    if let Some(hint) = hint {
        notes.add(told(&words, &keys, hint), false, time.elapsed_secs_f64());
    }
}

pub(super) fn draw(
    mut contexts: EguiContexts,
    time: Res<Time<Real>>,
    (interface, docks): (Res<Interface>, Res<Docks>),
    (map, place): (Res<MinimapSettings>, Res<PanelSettings>),
    notes: Res<Notes>,
    expert: Res<Expert>,
) -> Result {
    let now_s = time.elapsed_secs_f64();
    let shown = || notes.shown.iter().filter(|note| note.since_s <= now_s && !(note.is_failure && expert.is_shown));
    if shown().next().is_none() {
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    let look = Look::of(&interface, context);
    let surface = Surface::Dusk;
    // At the right, unless something stands there.
    let is_taken = (map.visible && map.top && !map.left) || (place.visible && place.right);
    let (corner, aside) = if is_taken { (Align2::LEFT_TOP, look.text) } else { (Align2::RIGHT_TOP, -look.text) };
    let area = Area::new(Id::new("veduta notes")).anchor(corner, Vec2::new(aside, look.text));
    area.constrain_to(Look::free(&docks, context)).order(Order::Foreground).interactable(false).show(context, |ui| {
        ui.set_max_width(context_width(ui) * 0.26);
        look.frame(surface).show(ui, |ui| {
            for note in shown() {
                let ink = if note.is_failure { look.accent(surface) } else { look.ink(surface) };
                ui.label(look.words(&note.text, 1.0, ink));
            }
        });
    });
    Ok(())
}

fn context_width(ui: &bevy_egui::egui::Ui) -> f32 {
    ui.ctx().content_rect().width()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_walks_against_a_wall_is_helped_and_who_gets_on_is_not() {
        let mut stuck = Stuck::default();
        let (mut eye, walks) = (Eye::default(), Intent { go: DVec3::Y, ..Intent::default() });
        let hints = |stuck: &mut Stuck, eye: &mut Eye, step_m: f64| {
            (0..100)
                .filter_map(|_| {
                    eye.plan_pos.y += step_m;
                    stuck.pass(eye, &walks, 0.05, true)
                })
                .count()
        };
        assert_eq!(hints(&mut stuck, &mut eye, 0.05), 0, "a metre a second");
        assert_eq!(hints(&mut stuck, &mut eye, 0.0), 1, "five seconds at a wall");
    }

    #[test]
    fn who_does_nothing_is_told_once_what_there_is() {
        let (mut stuck, eye) = (Stuck::default(), Eye::default());
        let hints = (0..4_000).filter_map(|_| stuck.pass(&eye, &Intent::default(), 0.05, true));
        assert_eq!(hints.collect::<Vec<_>>(), ["hint-idle"]);
        let mut stuck = Stuck::default();
        assert!(
            (0..4_000).all(|_| stuck.pass(&eye, &Intent::default(), 0.05, false).is_none()),
            "the first minute tells it already"
        );
    }

    #[test]
    fn a_note_is_shown_once_and_the_oldest_goes() {
        let mut notes = Notes::default();
        for n in 0..6 {
            notes.add(format!("note {}", n / 2 * 2), true, 0.0);
            notes.add(format!("more {n}"), false, 0.0);
        }
        assert_eq!(notes.shown.len(), MOST);
        notes.add("more 5".to_owned(), false, 7.0);
        let last = notes.shown.iter().filter(|note| note.text == "more 5").map(|note| note.since_s);
        assert_eq!(last.collect::<Vec<_>>(), [7.0], "what goes on stays");
        assert_eq!(notes.shown.back().map(|n| n.text.as_str()), Some("more 5"));
    }
}
