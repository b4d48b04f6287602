//! Draws the windows and does what was done in them.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{self, Align2, Area, Frame, Id, Order, Rect, Stroke, Ui, Vec2 as EguiVec2};
use veduta_ecs::{CityClock, Docks, Eye, Ground, Interface, PlaceNames, Steering, Viewer, Words, WorldOrigin};
use veduta_ui::{Look, Surface, Symbol, symbol_button};

use super::act::Act;
use super::ask::{self, Answer, Question};
use super::bench::{Acts, Bench};
use super::file::{SaveHow, SaveTour};
use super::record::Recorder;
use super::{EditorCommand, EditorSettings, TourEditor, fields, keys, list, marks, timeline, transport};
use crate::play::pose_of;
use crate::{TourPlayer, TourState};

/// Widths of the docks beside the picture, in heights of running text.
const LEFT: f32 = 18.0;
const RIGHT: f32 = 19.0;

/// Tells others what room the editor leaves.
pub(super) fn dock(
    mut contexts: EguiContexts,
    (editor, interface): (Res<TourEditor>, Res<Interface>),
    mut docks: ResMut<Docks>,
) -> Result {
    if !editor.is_open {
        docks.set_if_neq(Docks::default());
        return Ok(());
    }
    let look = Look::of(&interface, contexts.ctx_mut()?);
    docks.set_if_neq(Docks { left: look.text * LEFT, right: look.text * RIGHT, bottom: look.text * (timeline::HEIGHT + 3.6) });
    Ok(())
}

/// What marks in the picture are drawn with.
#[derive(SystemParam)]
pub(super) struct Picture<'w, 's> {
    viewers: Query<'w, 's, (&'static Eye, Option<&'static Camera>, Option<&'static GlobalTransform>), With<Viewer>>,
    origin: Res<'w, WorldOrigin>,
    ground: Ground<'w>,
}

/// What windows say, and how.
#[derive(SystemParam)]
pub(super) struct Manner<'w> {
    words: Res<'w, Words>,
    names: Res<'w, PlaceNames>,
    interface: Res<'w, Interface>,
    settings: Res<'w, EditorSettings>,
    docks: Res<'w, Docks>,
}

pub(super) fn draw(
    mut contexts: EguiContexts,
    picture: Picture<'_, '_>,
    manner: Manner<'_>,
    (recorder, clock): (Res<Recorder>, Res<CityClock>),
    (mut editor, mut player, mut steering): (ResMut<TourEditor>, ResMut<TourPlayer>, ResMut<Steering>),
    mut commands: MessageWriter<EditorCommand>,
    mut saves: MessageWriter<SaveTour>,
) -> Result {
    let context = contexts.ctx_mut()?;
    let Some((eye, camera, transform)) = picture.viewers.iter().next() else { return Ok(()) };
    let here = pose_of(eye, clock.hour);
    let editor = &mut *editor;
    let look = Look::of(&manner.interface, context);
    if let Some(question) = &editor.question {
        let answer = ask_window(context, &look, &manner.words, question, manner.settings.can_save);
        if let Some(answer) = answer {
            editor.answered(answer, &mut saves);
        }
    }
    let mut acts = Acts::new();
    let Some(document) = &editor.document else {
        waiting(context, &look, &manner, player.error(), &mut acts);
        if !acts.is_empty() {
            commands.write(EditorCommand::Close);
        }
        return Ok(());
    };
    let bench = Bench {
        look,
        words: &manner.words,
        names: &manner.names,
        edit: &document.edit,
        sketch: &document.sketch,
        streets: editor.streets.as_deref(),
        here,
        t_s: player.time_s(),
        is_playing: matches!(player.state(), TourState::Playing | TourState::Returning),
        is_recording: recorder.is_on(),
        approach: editor.approach,
        notice: &editor.notice,
        can_save: manner.settings.can_save,
        can_copy: manner.settings.can_copy,
        is_changed_elsewhere: document.on_disk.is_some(),
    };
    if let (Some(camera), Some(transform), false) = (camera, transform, bench.is_playing) {
        let marks = marks::in_sight(&document.sketch.views, eye, (camera, transform), &picture.origin, &picture.ground);
        marks::draw(context, &bench, Look::free(&manner.docks, context), &marks, &mut acts);
    }
    windows(context, &bench, &manner.docks, &mut editor.time, &mut editor.listed, &mut acts);
    acts.extend(keys::shortcut(context, &document.edit.selected()));
    let is_idle = !context.text_edit_focused() && !context.input(|input| input.pointer.any_down());
    if acts.is_empty() && is_idle {
        editor.edit(&Act::Seal, &here);
    }
    for act in acts {
        if !editor.edit(&act, &here) {
            do_beyond(act, editor, (&mut *player, &mut *steering), eye, context, &mut commands, &mut saves);
        }
    }
    Ok(())
}

/// Does what concerns more than the tour.
fn do_beyond(
    act: Act,
    editor: &mut TourEditor,
    (player, steering): (&mut TourPlayer, &mut Steering),
    eye: &Eye,
    context: &egui::Context,
    commands: &mut MessageWriter<EditorCommand>,
    saves: &mut MessageWriter<SaveTour>,
) {
    match act {
        Act::Visit(steps) => {
            if let Some(start_s) = editor.start_s(steps.start) {
                player.stand_at(start_s, Some(eye), steering);
            }
            editor.edit(&Act::Select(steps), &pose_of(eye, 0.0));
        }
        Act::Seek(t_s) => player.stand_at(t_s, Some(eye), steering),
        Act::Play if player.state() == TourState::Playing => player.state = TourState::Paused,
        Act::Play => {
            let selected = editor.document.as_ref().map_or(0..0, |document| document.edit.selected());
            // Paused within what is selected it goes on; else it begins there.
            let start_s = editor.start_s(selected.start).unwrap_or(0.0);
            let end_s = editor.start_s(selected.end).unwrap_or(f64::INFINITY);
            let goes_on = player.state() == TourState::Paused && (start_s..end_s).contains(&player.time_s());
            if !goes_on {
                player.stand_at(start_s, Some(eye), steering);
            }
            if player.state() == TourState::Paused {
                player.state = TourState::Playing;
            }
        }
        Act::Record => _ = commands.write(EditorCommand::Record),
        Act::Save if editor.document.as_ref().is_some_and(|document| document.on_disk.is_some()) => {
            let other = editor.document.as_ref().and_then(|document| document.on_disk.clone()).unwrap_or_default();
            editor.question = Some(Question::Changed(other));
        }
        Act::Save => editor.save(false, None, saves),
        Act::SaveAs => editor.save(true, Some(SaveHow::New), saves),
        Act::CopyText => context.copy_text(editor.text().unwrap_or_default().to_owned()),
        Act::TakeOther => {
            let other = editor.document.as_mut().and_then(|document| document.on_disk.take());
            editor.take_other(&other.unwrap_or_default());
        }
        Act::KeepMine => {
            if let Some(document) = &mut editor.document
                && let Some(other) = document.on_disk.take()
            {
                document.edit.keep(other);
            }
        }
        Act::Close => _ = commands.write(EditorCommand::Close),
        _ => {}
    }
}

impl TourEditor {
    /// Does what the visitor has answered.
    fn answered(&mut self, answer: Answer, saves: &mut MessageWriter<SaveTour>) {
        let Some(question) = self.question.take() else { return };
        match (question, answer) {
            (_, Answer::Stay) => {}
            (Question::Unsaved(then), Answer::Save) => {
                // What was asked for comes once it is saved.
                self.question = Some(Question::Unsaved(then));
                self.save(false, None, saves);
            }
            (Question::Unsaved(then), _) => self.then = Some(then),
            (Question::Changed(other), Answer::Save) => self.save(false, Some(SaveHow::Over(other)), saves),
            (Question::Changed(other), _) => self.take_other(&other),
            (Question::Taken(_), Answer::Beside) => self.save(true, Some(SaveHow::Beside), saves),
            (Question::Taken(_), _) => self.save(true, Some(SaveHow::Replace), saves),
        }
    }
}

fn ask_window(context: &egui::Context, look: &Look, words: &Words, question: &Question, can_save: bool) -> Option<Answer> {
    let area = Area::new(Id::new("veduta editor question")).anchor(Align2::CENTER_CENTER, EguiVec2::ZERO).order(Order::Foreground);
    area.show(context, |ui| look.frame(Surface::Paper).show(ui, |ui| ask::show(ui, look, words, question, can_save)).inner).inner
}

/// Says that the tour has not come yet, or why not.
fn waiting(context: &egui::Context, look: &Look, manner: &Manner<'_>, error: Option<&str>, acts: &mut Acts) {
    let area = Area::new(Id::new("veduta editor waits")).anchor(Align2::CENTER_BOTTOM, EguiVec2::new(0.0, -look.text * 4.0));
    area.show(context, |ui| {
        look.frame(Surface::Paper).show(ui, |ui| {
            look.dress(ui, Surface::Paper);
            ui.set_max_width(look.text * 36.0);
            ui.horizontal(|ui| {
                ui.label(error.map_or_else(|| manner.words.say("editor-waiting"), str::to_owned));
                let name = manner.words.say("editor-close");
                if symbol_button(ui, look, Surface::Paper, Symbol::Close, false, &name, "E").clicked() {
                    acts.push(Act::Close);
                }
            });
        });
    });
}

/// The three docks.
pub(super) fn windows(
    context: &egui::Context,
    bench: &Bench<'_>,
    docks: &Docks,
    time: &mut timeline::TimeView,
    listed: &mut Option<usize>,
    acts: &mut Acts,
) {
    let screen = context.content_rect();
    let free = Look::free(docks, context);
    let left = Rect::from_min_max(screen.min, egui::pos2(free.left(), free.bottom()));
    let right = Rect::from_min_max(egui::pos2(free.right(), screen.top()), egui::pos2(screen.right(), free.bottom()));
    let bottom = Rect::from_min_max(egui::pos2(screen.left(), free.bottom()), screen.max);
    sheet(context, bench, "veduta editor list", left, |ui| list::show(ui, bench, listed, acts));
    sheet(context, bench, "veduta editor fields", right, |ui| fields::show(ui, bench, acts));
    sheet(context, bench, "veduta editor time", bottom, |ui| {
        transport::show(ui, bench, acts);
        timeline::show(ui, bench, time, acts);
    });
}

/// A sheet of paper that fills a part of the window.
fn sheet(context: &egui::Context, bench: &Bench<'_>, id: &str, rect: Rect, show: impl FnOnce(&mut Ui)) {
    let look = &bench.look;
    Area::new(Id::new(id)).fixed_pos(rect.min).order(Order::Middle).show(context, |ui| {
        let margin = (look.text * 0.5).round() as i8;
        let edge = ui.visuals().window_stroke;
        let stroke = if look.high_contrast { Stroke::new(2.0, look.ink(Surface::Paper)) } else { edge };
        let frame = Frame::new().fill(look.ground(Surface::Paper)).stroke(stroke).inner_margin(margin);
        frame.show(ui, |ui| {
            let inner = rect.size() - EguiVec2::splat(2.0 * f32::from(margin) + 2.0 * stroke.width);
            ui.set_min_size(inner);
            ui.set_max_size(inner);
            look.dress(ui, Surface::Paper);
            show(ui);
        });
    });
}

/// Tells that the visitor's walk is being recorded, and ends it.
pub(super) fn draw_recorder(
    mut contexts: EguiContexts,
    (recorder, editor, player): (Res<Recorder>, Res<TourEditor>, Res<TourPlayer>),
    (words, interface, docks): (Res<Words>, Res<Interface>, Res<Docks>),
    mut commands: MessageWriter<EditorCommand>,
) -> Result {
    let context = contexts.ctx_mut()?;
    let look = Look::of(&interface, context);
    let area = Area::new(Id::new("veduta recorder")).order(Order::Middle).constrain_to(Look::free(&docks, context));
    // Below the strip of a tour, if there is one.
    let strip = if player.state() == TourState::Idle { 0.0 } else { look.text * 5.2 };
    let offset = if editor.is_open { look.text * 0.6 } else { context.content_rect().height() * 0.03 + strip };
    let ends = area
        .anchor(Align2::CENTER_TOP, EguiVec2::new(0.0, offset))
        .show(context, |ui| look.frame(Surface::Dusk).show(ui, |ui| show_recorder(ui, &look, &words, &recorder)).inner);
    if ends.inner {
        commands.write(EditorCommand::Record);
    }
    Ok(())
}

/// The line of the recorder; whether to end it.
pub(super) fn show_recorder(ui: &mut Ui, look: &Look, words: &Words, recorder: &Recorder) -> bool {
    let surface = Surface::Dusk;
    look.dress(ui, surface);
    ui.horizontal(|ui| {
        let (dot, _) = ui.allocate_exact_size(EguiVec2::splat(look.text), egui::Sense::hover());
        ui.painter().circle_filled(dot.center(), look.text * 0.4, egui::Color32::from_rgb(0xE0, 0x4A, 0x3A));
        let seconds = recorder.elapsed_s() as u32;
        let time = format!("{}:{:02}", seconds / 60, seconds % 60);
        let metres = recorder.length_m().round() as u32;
        let told = words.say_with("recorder-told", &[("time", time.into()), ("metres", metres.into())]);
        ui.label(look.words(told, 1.0, look.ink(surface)));
        symbol_button(ui, look, surface, Symbol::Stop, false, &words.say("editor-record-end"), "R").clicked()
    })
    .inner
}
