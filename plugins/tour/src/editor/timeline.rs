//! The line of time: a block for every step as wide as its seconds, to be moved, made longer and shorter, and gone to.

use bevy_egui::egui::{
    Align2, CursorIcon, Id, Painter, Rect, Sense, Shape, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, WidgetType, pos2,
};
use veduta_city::Step;
use veduta_route::{StepKind, is_aside, stretched};
use veduta_ui::Surface;

use super::act::Act;
use super::bench::{Acts, Bench, colour};
use super::label;

/// Which part of a tour is shown, and what is being dragged.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct TimeView {
    /// How many times as large as all of the tour in the window; 0 as 1.
    zoom: f32,
    from_s: f64,
    drag: Option<Drag>,
}

#[derive(Debug, Clone, PartialEq)]
enum Drag {
    /// A step to another place.
    Move(usize),
    /// A step's end; how it was when the drag began, and by how much the pointer has gone, seconds.
    Stretch { index: usize, step: Step, was_s: f64, by_s: f64, scale: f32 },
}

/// How seconds lie on the screen.
#[derive(Clone, Copy)]
struct Scale {
    rect: Rect,
    from_s: f64,
    /// Points a second.
    scale: f32,
}

impl Scale {
    fn x(&self, t_s: f64) -> f32 {
        self.rect.left() + ((t_s - self.from_s) as f32) * self.scale
    }

    fn time(&self, x: f32) -> f64 {
        self.from_s + f64::from((x - self.rect.left()) / self.scale)
    }
}

/// The most that can be shown larger.
const MOST_ZOOM: f32 = 200.0;
/// Rows, in heights of running text: chapters, movements, captions, what changes in the city, all else. Hours and fields of view often
/// change at a time.
const ROWS: [f32; 5] = [1.3, 2.0, 1.2, 1.2, 1.2];
const GAP: f32 = 0.2;

/// Height of the line in heights of running text.
pub(super) const HEIGHT: f32 = ROWS[0] + ROWS[1] + ROWS[2] + ROWS[3] + ROWS[4] + 4.0 * GAP;

/// Draws the line.
pub(super) fn show(ui: &mut Ui, bench: &Bench<'_>, view: &mut TimeView, acts: &mut Acts) {
    let text = bench.look.text;
    let (rect, response) = ui.allocate_exact_size(Vec2::new(ui.available_width(), text * HEIGHT), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::slider(true, bench.t_s, bench.say("tour-time")));
    let whole_s = bench.whole_s().max(1.0);
    let scale = zoomed(ui, &response, rect, whole_s, view);
    let painter = ui.painter().with_clip_rect(rect);
    painter.rect_filled(rect, 3.0, ui.visuals().extreme_bg_color);
    if let (true, Some(at)) = (response.clicked() || response.dragged(), response.interact_pointer_pos()) {
        acts.push(Act::Seek(scale.time(at.x).clamp(0.0, whole_s)));
    }
    for (index, step) in bench.edit.tour().steps.iter().enumerate() {
        block(ui, &painter, bench, &scale, view, index, step, acts);
    }
    if let Some(Drag::Move(_)) = view.drag
        && let Some(at) = ui.ctx().pointer_interact_pos()
    {
        let x = scale.x(seam_s(bench, target(bench, scale.time(at.x))));
        painter.vline(x, rect.y_range(), Stroke::new(text * 0.18, bench.look.accent(Surface::Paper)));
    }
    let now = scale.x(bench.t_s);
    painter.vline(now, rect.y_range(), Stroke::new(text * 0.1, bench.look.ink(Surface::Paper)));
    let tip = vec![pos2(now - text * 0.35, rect.top()), pos2(now + text * 0.35, rect.top()), pos2(now, rect.top() + text * 0.5)];
    painter.add(Shape::convex_polygon(tip, bench.look.ink(Surface::Paper), Stroke::NONE));
    if ui.input(|input| input.pointer.any_released()) {
        view.drag = None;
    }
}

/// The wheel shows more or less about the pointer, across it goes along.
fn zoomed(ui: &Ui, response: &bevy_egui::egui::Response, rect: Rect, whole_s: f64, view: &mut TimeView) -> Scale {
    let fit = rect.width() / whole_s as f32;
    let mut scale = Scale { rect, from_s: view.from_s, scale: fit * view.zoom.max(1.0) };
    if let Some(Drag::Stretch { scale: held, .. }) = &view.drag {
        // What is dragged keeps to the pointer, however long the tour becomes.
        scale.scale = *held;
        return scale;
    }
    let is_over = response.contains_pointer() || ui.rect_contains_pointer(rect);
    let wheel = if is_over { ui.input(|input| input.smooth_scroll_delta()) } else { Vec2::ZERO };
    if wheel.y != 0.0
        && let Some(at) = ui.ctx().pointer_latest_pos()
    {
        let under_s = scale.time(at.x);
        view.zoom = (view.zoom.max(1.0) * (wheel.y / 200.0).exp()).clamp(1.0, MOST_ZOOM);
        scale.scale = fit * view.zoom;
        view.from_s = under_s - f64::from((at.x - rect.left()) / scale.scale);
    }
    view.from_s -= f64::from(wheel.x / scale.scale);
    let shown_s = f64::from(rect.width() / scale.scale);
    view.from_s = view.from_s.clamp(0.0, (whole_s - shown_s).max(0.0));
    Scale { from_s: view.from_s, ..scale }
}

/// Where a step's block is.
fn block_rect(bench: &Bench<'_>, scale: &Scale, index: usize, step: &Step) -> Option<Rect> {
    let (from, to) = bench.span(index)?;
    let text = bench.look.text;
    let row = match StepKind::of(step) {
        StepKind::Chapter => 0,
        StepKind::Say | StepKind::Narrate | StepKind::Picture => 2,
        StepKind::Time | StepKind::Rain | StepKind::Sound => 3,
        _ if is_aside(step) => 4,
        _ => 1,
    };
    let top = scale.rect.top() + text * (ROWS[..row].iter().sum::<f32>() + GAP * row as f32);
    let least = if row == 0 {
        text * 5.0
    } else if row == 1 {
        3.0
    } else {
        text * 0.5
    };
    let (left, right) = (scale.x(from), scale.x(to));
    Some(Rect::from_min_max(pos2(left, top), pos2(right.max(left + least), top + text * ROWS[row])))
}

fn block(
    ui: &mut Ui,
    painter: &Painter,
    bench: &Bench<'_>,
    scale: &Scale,
    view: &mut TimeView,
    index: usize,
    step: &Step,
    acts: &mut Acts,
) {
    let Some(rect) = block_rect(bench, scale, index, step).filter(|rect| rect.intersects(scale.rect)) else { return };
    let shown = rect.intersect(scale.rect);
    let response = ui.interact(shown, Id::new("tour block").with(index), Sense::click_and_drag());
    let (from_s, to_s) = bench.span(index).unwrap_or_default();
    let what = label::of(bench, step);
    let seconds = bench.words.number(to_s - from_s, 1);
    let name = bench.words.say_with("editor-block", &[("n", (index as u32 + 1).into()), ("seconds", seconds.into())]);
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, &name));
    let is_selected = bench.edit.selected().contains(&index);
    paint(painter, bench, rect, StepKind::of(step), &what, is_selected || response.has_focus());
    if response.clicked() {
        acts.push(Act::Visit(index..index + 1));
    }
    if response.drag_started() {
        if !is_selected {
            acts.push(Act::Select(index..index + 1));
        }
        view.drag = Some(Drag::Move(index));
    }
    if response.drag_stopped()
        && view.drag == Some(Drag::Move(index))
        && let Some(at) = response.interact_pointer_pos()
    {
        acts.push(Act::MoveBefore(target(bench, scale.time(at.x))));
    }
    edge(ui, bench, scale, view, (index, step), shown, acts);
    response.on_hover_text(format!("{what}\n{} – {}", label::time(from_s), label::time(to_s)));
}

fn paint(painter: &Painter, bench: &Bench<'_>, rect: Rect, kind: StepKind, what: &str, is_marked: bool) {
    let text = bench.look.text;
    let inner = rect.shrink2(Vec2::new(0.5, 0.0));
    painter.rect_filled(inner, 3.0, colour(kind));
    if is_marked {
        painter.rect_stroke(inner, 3.0, Stroke::new(2.0, bench.look.ink(Surface::Paper)), StrokeKind::Inside);
    }
    if rect.width() > text * 1.5 {
        let inside = painter.with_clip_rect(inner.shrink2(Vec2::new(text * 0.2, 0.0)).intersect(painter.clip_rect()));
        // The kind has told itself by its colour where there is no room for it.
        let told = if rect.width() < text * 8.0 { what.split_once(" · ").map_or(what, |(kind, _)| kind) } else { what };
        let at = pos2(rect.left().max(painter.clip_rect().left()) + text * 0.35, rect.center().y);
        inside.text(at, Align2::LEFT_CENTER, told, bench.look.font(0.85), bevy_egui::egui::Color32::WHITE);
    }
}

/// The right edge of a block, where it has a length of its own.
fn edge(
    ui: &Ui,
    bench: &Bench<'_>,
    scale: &Scale,
    view: &mut TimeView,
    (index, step): (usize, &Step),
    shown: Rect,
    acts: &mut Acts,
) {
    let wide = bench.look.text * 0.45;
    let is_held = matches!(&view.drag, Some(Drag::Stretch { index: held, .. }) if *held == index);
    let (from_s, to_s) = bench.span(index).unwrap_or_default();
    let has_length = stretched(step, 1.0, 1.0, 1.0).is_some();
    if !is_held && (!has_length || shown.width() < wide * 2.5) {
        return;
    }
    let rect = Rect::from_min_max(pos2(shown.right() - wide, shown.top()), shown.max);
    let response = ui.interact(rect, Id::new("tour edge").with(index), Sense::drag());
    let name = bench.words.say_with("editor-edge", &[("n", (index as u32 + 1).into())]);
    response.widget_info(|| WidgetInfo::slider(true, to_s - from_s, &name));
    if response.hovered() || is_held {
        ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    if response.drag_started() {
        view.drag = Some(Drag::Stretch { index, step: step.clone(), was_s: to_s - from_s, by_s: 0.0, scale: scale.scale });
    }
    if let Some(Drag::Stretch { index: held, step, was_s, by_s, .. }) = &mut view.drag
        && *held == index
        && response.dragged()
    {
        *by_s += f64::from(response.drag_delta().x / scale.scale);
        if let Some(next) = stretched(step, bench.edit.tour().speed, *was_s, (*was_s + *by_s).max(0.1)) {
            acts.push(Act::Replace(index, next));
        }
    }
    if response.drag_stopped() {
        acts.push(Act::Seal);
    }
}

/// The step before which something comes that is let go at a second: the first whose middle lies after it.
fn target(bench: &Bench<'_>, t_s: f64) -> usize {
    let steps = &bench.edit.tour().steps;
    let after = steps
        .iter()
        .enumerate()
        .filter(|(_, step)| !is_aside(step))
        .find(|(index, _)| bench.span(*index).is_some_and(|(from, to)| f64::midpoint(from, to) > t_s));
    after.map_or(steps.len(), |(index, _)| index)
}

/// The second at which a step begins, or the last one ends.
fn seam_s(bench: &Bench<'_>, index: usize) -> f64 {
    bench.span(index).map_or_else(|| bench.whole_s(), |(from, _)| from)
}
