use bevy_egui::egui::{
    self, Color32, Painter, Pos2, Rect, Response, Sense, Shape, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, WidgetType,
};

use crate::{Look, Surface};

/// A small picture that stands for an action.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symbol {
    /// A field of view, narrow to wide: 0, 1, 2.
    FieldOfView(u8),
    /// Eyes higher.
    Higher,
    /// Eyes lower.
    Lower,
    /// A flag: a tour.
    Tour,
    /// Go on.
    Play,
    /// Stand still.
    Pause,
    /// A folded map.
    Map,
    /// A magnifying glass.
    Search,
    /// Sliders: settings.
    Settings,
    /// Two arrows in a circle: connect anew.
    Reconnect,
    /// A question mark.
    Help,
    /// A cross.
    Close,
    /// Footsteps: walk there.
    Walk,
    /// An arrow that leaps: go there at once.
    Jump,
    /// A dot: record.
    Record,
    /// A square: end what is being recorded.
    Stop,
    /// A pencil.
    Edit,
    /// An arrow back.
    Undo,
    /// An arrow onward.
    Redo,
    /// An arrow into a tray.
    Save,
    /// A plus.
    Add,
}

/// A button with a symbol, and what screen readers and the pointer's tooltip say of it. `is_on` marks what is chosen or open.
pub fn symbol_button(ui: &mut Ui, look: &Look, surface: Surface, symbol: Symbol, is_on: bool, name: &str, keys: &str) -> Response {
    let edge = look.text * 1.9;
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(edge), Sense::click());
    response.widget_info(|| WidgetInfo::selected(WidgetType::Button, ui.is_enabled(), is_on, name));
    let visuals = ui.style().interact(&response);
    if response.hovered() || response.has_focus() || is_on {
        ui.painter().rect(rect, 5.0, visuals.weak_bg_fill, visuals.bg_stroke, StrokeKind::Inside);
    }
    let ink = if is_on { look.accent(surface) } else { look.ink(surface) };
    let ink = if ui.is_enabled() { ink } else { ink.gamma_multiply(0.4) };
    draw(ui.painter(), rect.shrink(edge * 0.22), symbol, ink);
    response.on_hover_ui(|ui| {
        look.dress(ui, surface);
        ui.horizontal(|ui| {
            ui.label(name);
            if !keys.is_empty() {
                ui.label(look.words(keys, 0.9, look.accent(surface)));
            }
        });
    })
}

/// Draws a symbol into a square.
fn draw(painter: &Painter, square: Rect, symbol: Symbol, ink: Color32) {
    let at = |x: f32, y: f32| square.min + square.size() * Vec2::new(x, y);
    let stroke = Stroke::new(square.width() * 0.11, ink);
    let line = |points: &[(f32, f32)]| {
        painter.add(Shape::line(points.iter().map(|&(x, y)| at(x, y)).collect(), stroke));
    };
    let solid = |points: &[(f32, f32)]| {
        painter.add(Shape::convex_polygon(points.iter().map(|&(x, y)| at(x, y)).collect(), ink, Stroke::NONE));
    };
    let wide = square.width();
    match symbol {
        Symbol::FieldOfView(n) => {
            let half = [0.16, 0.32, 0.5][usize::from(n.min(2))];
            line(&[(0.5 - half, 0.05), (0.5, 0.95), (0.5 + half, 0.05)]);
            painter.circle_filled(at(0.5, 0.95), wide * 0.09, ink);
        }
        Symbol::Higher | Symbol::Lower => {
            eye(painter, Rect::from_min_max(at(0.0, 0.38), at(0.62, 0.84)), ink, stroke);
            let (tip, foot) = if symbol == Symbol::Higher { (0.1, 0.95) } else { (0.95, 0.1) };
            let barb = tip + (foot - tip) * 0.3;
            line(&[(0.86, foot), (0.86, tip)]);
            line(&[(0.72, barb), (0.86, tip), (1.0, barb)]);
        }
        Symbol::Tour => {
            line(&[(0.2, 1.0), (0.2, 0.02)]);
            solid(&[(0.2, 0.05), (0.95, 0.3), (0.2, 0.55)]);
        }
        Symbol::Play => solid(&[(0.18, 0.05), (0.95, 0.5), (0.18, 0.95)]),
        Symbol::Pause => {
            solid(&[(0.18, 0.08), (0.4, 0.08), (0.4, 0.92), (0.18, 0.92)]);
            solid(&[(0.6, 0.08), (0.82, 0.08), (0.82, 0.92), (0.6, 0.92)]);
        }
        Symbol::Map => {
            line(&[
                (0.0, 0.2),
                (0.33, 0.05),
                (0.67, 0.2),
                (1.0, 0.05),
                (1.0, 0.8),
                (0.67, 0.95),
                (0.33, 0.8),
                (0.0, 0.95),
                (0.0, 0.2),
            ]);
            line(&[(0.33, 0.05), (0.33, 0.8)]);
            line(&[(0.67, 0.2), (0.67, 0.95)]);
        }
        Symbol::Search => {
            painter.circle_stroke(at(0.42, 0.42), wide * 0.34, stroke);
            line(&[(0.67, 0.67), (1.0, 1.0)]);
        }
        Symbol::Settings => {
            for (y, x) in [(0.15, 0.7), (0.5, 0.3), (0.85, 0.6)] {
                line(&[(0.0, y), (1.0, y)]);
                painter.circle_filled(at(x, y), wide * 0.13, ink);
            }
        }
        Symbol::Reconnect => {
            arc(painter, at(0.5, 0.5), wide * 0.4, 0.15..0.85, stroke);
            arc(painter, at(0.5, 0.5), wide * 0.4, 1.15..1.85, stroke);
            solid(&[(0.0, 0.5), (0.24, 0.5), (0.08, 0.26)]);
            solid(&[(1.0, 0.5), (0.76, 0.5), (0.92, 0.74)]);
        }
        Symbol::Help => {
            arc(painter, at(0.5, 0.3), wide * 0.27, 1.0..2.4, stroke);
            line(&[(0.58, 0.56), (0.5, 0.64), (0.5, 0.74)]);
            painter.circle_filled(at(0.5, 0.93), wide * 0.08, ink);
        }
        Symbol::Close => {
            line(&[(0.1, 0.1), (0.9, 0.9)]);
            line(&[(0.9, 0.1), (0.1, 0.9)]);
        }
        Symbol::Walk => {
            painter.circle_filled(at(0.55, 0.1), wide * 0.1, ink);
            line(&[(0.52, 0.25), (0.48, 0.6), (0.28, 0.98)]);
            line(&[(0.48, 0.6), (0.68, 0.75), (0.74, 0.98)]);
            line(&[(0.22, 0.5), (0.5, 0.3), (0.8, 0.5)]);
        }
        Symbol::Record => drop(painter.circle_filled(at(0.5, 0.5), wide * 0.42, ink)),
        Symbol::Stop => solid(&[(0.12, 0.12), (0.88, 0.12), (0.88, 0.88), (0.12, 0.88)]),
        Symbol::Edit => {
            line(&[(0.3, 0.92), (0.08, 0.92), (0.12, 0.68), (0.72, 0.08), (0.92, 0.28), (0.3, 0.92)]);
            line(&[(0.56, 0.24), (0.76, 0.44)]);
        }
        Symbol::Undo | Symbol::Redo => {
            let side = |x: f32| if symbol == Symbol::Undo { x } else { 1.0 - x };
            line(
                &[0.1, 0.65, 0.88, 0.88, 0.65, 0.3]
                    .map(side)
                    .into_iter()
                    .zip([0.35, 0.35, 0.5, 0.75, 0.9, 0.9])
                    .collect::<Vec<_>>(),
            );
            line(&[(side(0.38), 0.05), (side(0.1), 0.35), (side(0.38), 0.65)]);
        }
        Symbol::Save => {
            line(&[(0.5, 0.0), (0.5, 0.6)]);
            line(&[(0.24, 0.36), (0.5, 0.62), (0.76, 0.36)]);
            line(&[(0.05, 0.6), (0.05, 0.95), (0.95, 0.95), (0.95, 0.6)]);
        }
        Symbol::Add => {
            line(&[(0.5, 0.05), (0.5, 0.95)]);
            line(&[(0.05, 0.5), (0.95, 0.5)]);
        }
        Symbol::Jump => {
            arc(painter, at(0.45, 0.75), wide * 0.4, 1.0..1.85, stroke);
            solid(&[(1.0, 0.45), (0.98, 0.85), (0.66, 0.66)]);
        }
    }
}

fn eye(painter: &Painter, rect: Rect, ink: Color32, stroke: Stroke) {
    let (left, right, middle) = (rect.left_center(), rect.right_center(), rect.center());
    let lid = |y: f32| -> Vec<Pos2> {
        (0..=8)
            .map(|n| n as f32 / 8.0)
            .map(|t| left.lerp(right, t) + Vec2::new(0.0, (y - middle.y) * 4.0 * t * (1.0 - t)))
            .collect()
    };
    painter.add(Shape::line(lid(rect.top()), stroke));
    painter.add(Shape::line(lid(rect.bottom()), stroke));
    painter.circle_filled(middle, rect.height() * 0.26, ink);
}

/// Part of a circle, in half turns from the right, clockwise.
fn arc(painter: &Painter, middle: Pos2, radius: f32, halves: core::ops::Range<f32>, stroke: Stroke) {
    let angle = |n: u8| (halves.start + (halves.end - halves.start) * f32::from(n) / 16.0) * core::f32::consts::PI;
    let points = (0..=16).map(|n| middle + egui::Vec2::angled(angle(n)) * radius);
    painter.add(Shape::line(points.collect(), stroke));
}

#[cfg(test)]
mod tests {
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use super::*;

    #[test]
    fn a_symbol_has_a_name_and_can_be_pressed() {
        let look = Look { text: 16.0, high_contrast: false, reduced_motion: false };
        let mut harness = Harness::new_ui_state(
            |ui, pressed: &mut u32| {
                if symbol_button(ui, &look, Surface::Dusk, Symbol::Map, false, "Map", "M").clicked() {
                    *pressed += 1;
                }
            },
            0,
        );
        harness.get_by_label("Map").click();
        harness.run();
        assert_eq!(*harness.state(), 1);
    }
}
