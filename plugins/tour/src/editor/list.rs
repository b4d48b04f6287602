//! The list of a tour's chapters and steps.

use bevy_egui::egui::style::ScrollAnimation;
use bevy_egui::egui::{Align2, Key, Rect, Response, ScrollArea, Sense, StrokeKind, Ui, Vec2, WidgetInfo, WidgetType, pos2};
use veduta_city::Step;
use veduta_route::StepKind;
use veduta_ui::{Surface, Symbol, symbol_button};

use super::act::Act;
use super::bench::{Acts, Bench, colour, kind_name};
use super::label;

/// Kinds that can be added, besides the view itself.
const ADDED: [StepKind; 12] = [
    StepKind::Chapter,
    StepKind::Say,
    StepKind::Narrate,
    StepKind::Sound,
    StepKind::Picture,
    StepKind::Look,
    StepKind::Wait,
    StepKind::Time,
    StepKind::Rain,
    StepKind::Fov,
    StepKind::Mark,
    StepKind::Cut,
];

/// Title, what can be done with the whole, and the list. `listed` is the step that is kept in sight.
pub(super) fn show(ui: &mut Ui, bench: &Bench<'_>, listed: &mut Option<usize>, acts: &mut Acts) {
    head(ui, bench, acts);
    tools(ui, bench, acts);
    let selected = bench.edit.selected();
    let scrolls = *listed != Some(selected.start);
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = bench.look.text * 0.1;
        for (index, step) in bench.edit.tour().steps.iter().enumerate() {
            let response = row(ui, bench, index, step);
            if response.clicked() {
                let extends = ui.input(|input| input.modifiers.shift) && !selected.is_empty();
                acts.push(if extends {
                    Act::Select(selected.start.min(index)..selected.end.max(index + 1))
                } else {
                    Act::Visit(index..index + 1)
                });
            }
            if scrolls && index == selected.start && !selected.is_empty() {
                let glide = if bench.look.reduced_motion { ScrollAnimation::none() } else { ui.style().scroll_animation };
                response.scroll_to_me_animation(None, glide);
                *listed = Some(index);
            }
            // Arrows go from row to row.
            if response.has_focus() {
                let go =
                    ui.input(|input| (input.key_pressed(Key::ArrowDown), input.key_pressed(Key::ArrowUp), input.modifiers.alt));
                let next = match go {
                    (true, _, false) => Some(index + 1),
                    (_, true, false) => index.checked_sub(1),
                    _ => None,
                };
                if let Some(next) = next.filter(|next| *next < bench.edit.tour().steps.len()) {
                    acts.push(Act::Visit(next..next + 1));
                }
            }
        }
        if bench.edit.tour().steps.is_empty() {
            ui.add_space(bench.look.text * 0.5);
            ui.label(bench.look.words(bench.say("editor-empty"), 1.0, bench.look.faint(Surface::Paper)));
        }
    });
}

/// The tour's title, which selects the tour itself, and a cross.
fn head(ui: &mut Ui, bench: &Bench<'_>, acts: &mut Acts) {
    let (look, surface) = (&bench.look, Surface::Paper);
    ui.horizontal(|ui| {
        let tour = bench.edit.tour();
        let unsaved = if bench.edit.is_unsaved() { "• " } else { "" };
        let title = look.words(format!("{unsaved}{}", tour.title), 1.15, look.ink(surface));
        let width = ui.available_width() - look.text * 2.6;
        let is_selected = bench.edit.selected().is_empty();
        let response = ui.add_sized([width, look.text * 1.9], bevy_egui::egui::Button::selectable(is_selected, title).truncate());
        let name = bench.say("editor-whole");
        response.widget_info(|| WidgetInfo::selected(WidgetType::SelectableLabel, true, is_selected, &name));
        if response.on_hover_text(name).clicked() {
            acts.push(Act::Select(0..0));
        }
        if symbol_button(ui, look, surface, Symbol::Close, false, &bench.say("editor-close"), "E").clicked() {
            acts.push(Act::Close);
        }
    });
}

/// Saving, undoing, and two menus.
fn tools(ui: &mut Ui, bench: &Bench<'_>, acts: &mut Acts) {
    let (look, surface) = (&bench.look, Surface::Paper);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = look.text * 0.2;
        let (can_undo, can_redo) = bench.edit.can();
        let mut tool = |ui: &mut Ui, is_enabled, symbol, name: &str, keys: &str, act| {
            ui.add_enabled_ui(is_enabled, |ui| {
                if symbol_button(ui, look, surface, symbol, false, &bench.say(name), keys).clicked() {
                    acts.push(act);
                }
            });
        };
        if bench.can_save {
            tool(ui, bench.edit.is_unsaved(), Symbol::Save, "editor-save", "Ctrl S", Act::Save);
        }
        tool(ui, can_undo, Symbol::Undo, "editor-undo", "Ctrl Z", Act::Undo);
        tool(ui, can_redo, Symbol::Redo, "editor-redo", "Ctrl Shift Z", Act::Redo);
        ui.menu_button(bench.say("editor-add"), |ui| add_menu(ui, bench, acts));
        ui.menu_button(bench.say("editor-edit"), |ui| edit_menu(ui, bench, acts));
    });
}

fn add_menu(ui: &mut Ui, bench: &Bench<'_>, acts: &mut Acts) {
    bench.look.dress(ui, Surface::Paper);
    for kind in ADDED {
        if ui.button(bench.say(kind_name(kind))).clicked() {
            acts.push(Act::Add(kind));
        }
    }
}

fn edit_menu(ui: &mut Ui, bench: &Bench<'_>, acts: &mut Acts) {
    bench.look.dress(ui, Surface::Paper);
    let selected = bench.edit.selected();
    let count = bench.edit.tour().steps.len();
    let has = !selected.is_empty();
    let up = selected.start.checked_sub(1).filter(|_| has);
    let down = (has && selected.end < count).then_some(selected.end + 1);
    let mut item = |ui: &mut Ui, is_enabled, name: &str, keys: &str, act: Option<Act>| {
        let button = bevy_egui::egui::Button::new(bench.say(name)).shortcut_text(keys);
        if ui.add_enabled(is_enabled, button).clicked() {
            acts.extend(act);
        }
    };
    item(ui, up.is_some(), "editor-up", "Alt ⬆", up.map(Act::MoveBefore));
    item(ui, down.is_some(), "editor-down", "Alt ⬇", down.map(Act::MoveBefore));
    ui.separator();
    item(ui, has, "editor-cut", "Ctrl X", Some(Act::Cut));
    item(ui, has, "editor-copy", "Ctrl C", Some(Act::Copy));
    item(ui, true, "editor-paste", "Ctrl V", Some(Act::Paste));
    item(ui, has, "editor-duplicate", "Ctrl D", Some(Act::Duplicate));
    item(ui, has, "editor-remove", "Delete", Some(Act::Remove));
    if bench.can_save || bench.can_copy {
        ui.separator();
    }
    if bench.can_save {
        item(ui, true, "editor-save-as", "Ctrl Shift S", Some(Act::SaveAs));
    }
    if bench.can_copy {
        item(ui, true, "editor-copy-text", "", Some(Act::CopyText));
    }
}

/// A step: its kind's colour, what it does, and for how long. Steps stand in under their chapters.
fn row(ui: &mut Ui, bench: &Bench<'_>, index: usize, step: &Step) -> Response {
    let (look, surface) = (&bench.look, Surface::Paper);
    let kind = StepKind::of(step);
    let is_chapter = kind == StepKind::Chapter;
    let height = look.text * if is_chapter { 1.8 } else { 1.5 };
    let (rect, response) = ui.allocate_exact_size(Vec2::new(ui.available_width(), height), Sense::click());
    let mistake = bench.mistake(Some(index));
    let is_selected = bench.edit.selected().contains(&index);
    let text = label::of(bench, step);
    let seconds = bench.span(index).map(|(from, to)| to - from).filter(|seconds| *seconds > 0.0);
    let told = seconds.map_or_else(String::new, |seconds| format!("{} {}", bench.words.number(seconds, 1), bench.say("unit-s")));
    let name = bench.words.say_with("editor-step", &[("n", (index as u32 + 1).into()), ("what", text.clone().into())]);
    response.widget_info(|| WidgetInfo::selected(WidgetType::SelectableLabel, true, is_selected, &name));
    if !ui.is_rect_visible(rect) {
        return response;
    }
    let visuals = ui.style().interact_selectable(&response, is_selected);
    if is_selected || response.hovered() || response.has_focus() {
        let fill = if is_selected { ui.visuals().selection.bg_fill } else { visuals.weak_bg_fill };
        let edge = if response.has_focus() { visuals.bg_stroke } else { bevy_egui::egui::Stroke::NONE };
        ui.painter().rect(rect, 3.0, fill, edge, StrokeKind::Inside);
    }
    let is_now = bench.span(index).is_some_and(|(from, to)| bench.is_playing && (from..to).contains(&bench.t_s));
    let indent = look.text * if is_chapter { 0.2 } else { 0.8 };
    let bar = Rect::from_min_size(rect.min + Vec2::new(indent, height * 0.2), Vec2::new(look.text * 0.35, height * 0.6));
    ui.painter().rect_filled(bar, 2.0, colour(kind));
    if is_now {
        ui.painter().rect_filled(Rect::from_min_size(rect.min, Vec2::new(look.text * 0.2, height)), 0.0, look.accent(surface));
    }
    let right = rect.right() - look.text * 0.3;
    let faint = look.faint(surface);
    let used = ui.painter().text(pos2(right, rect.center().y), Align2::RIGHT_CENTER, told, look.font(0.85), faint).width();
    let ink = if mistake.is_some() { look.accent(surface) } else { look.ink(surface) };
    let text = if mistake.is_some() { format!("⚠ {text}") } else { text };
    let space =
        Rect::from_min_max(pos2(bar.right() + look.text * 0.4, rect.top()), pos2(right - used - look.text * 0.4, rect.bottom()));
    let size = if is_chapter { 1.1 } else { 0.95 };
    let inside = ui.painter().with_clip_rect(space.intersect(ui.clip_rect()));
    inside.text(space.left_center(), Align2::LEFT_CENTER, text, look.font(size), ink);
    match mistake {
        Some(mistake) => response.on_hover_text(mistake),
        None => response,
    }
}
