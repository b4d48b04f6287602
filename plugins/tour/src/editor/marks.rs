//! The views of a tour, as marks in the picture that can be clicked.

use bevy::math::DVec2;
use bevy::prelude::*;
use bevy_egui::egui::{self, Align2, Color32, Id, Order, Pos2, Sense, Shape, Stroke, Ui, Vec2 as EguiVec2, WidgetInfo, WidgetType};
use veduta_ecs::{Eye, Ground, WorldOrigin};
use veduta_route::{Pose, StepKind, turn_deg};

use super::act::Act;
use super::bench::{Acts, Bench, colour};

/// Marks farther off than this are not drawn; the nearer, the larger; metres.
const SEEN_M: f64 = 160.0;
/// Nearer to the eye than this one stands in a mark, metres.
const INSIDE_M: f64 = 1.5;
/// Views alike are one mark: metres and degrees.
const ALIKE_M: f64 = 0.7;
const ALIKE_DEG: f64 = 12.0;
/// A mark's arrow ends so far from it, metres.
const ARROW_M: f64 = 1.2;

/// A mark on the screen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mark {
    pub step: usize,
    pub at: Pos2,
    pub tip: Pos2,
    pub away_m: f64,
}

/// The marks in sight, nearest last.
pub(super) fn in_sight(
    views: &[(usize, Pose)],
    eye: &Eye,
    (camera, transform): (&Camera, &GlobalTransform),
    origin: &WorldOrigin,
    ground: &Ground<'_>,
) -> Vec<Mark> {
    let mut kept: Vec<(usize, Pose)> = Vec::new();
    for &(step, pose) in views {
        let is_alike = |(_, other): &(usize, Pose)| {
            other.plan_pos.distance(pose.plan_pos) < ALIKE_M && turn_deg(other.heading_deg, pose.heading_deg).abs() < ALIKE_DEG
        };
        if !kept.last().is_some_and(is_alike) {
            kept.push((step, pose));
        }
    }
    let mut marks: Vec<Mark> = kept
        .into_iter()
        .filter_map(|(step, pose)| {
            let ground_m = ground.at(pose.plan_pos, eye.z_m());
            let from_eye = (pose.plan_pos - eye.plan_pos).extend(ground_m + pose.eye_m - eye.z_m());
            let away_m = from_eye.length();
            if !(INSIDE_M..SEEN_M).contains(&away_m) {
                return None;
            }
            let (heading, pitch) = (pose.heading_deg.to_radians(), pose.pitch_deg.to_radians());
            let ahead = DVec2::new(heading.sin(), heading.cos()) * pitch.cos() * ARROW_M;
            let project = |plan_pos: DVec2, z_m: f64| {
                let at = camera.world_to_viewport(transform, origin.world_from_plan(plan_pos, z_m)).ok()?;
                Some(Pos2::new(at.x, at.y))
            };
            let z_m = ground_m + pose.eye_m;
            let at = project(pose.plan_pos, z_m)?;
            let tip = project(pose.plan_pos + ahead, z_m + pitch.sin() * ARROW_M).unwrap_or(at);
            Some(Mark { step, at, tip, away_m })
        })
        .collect();
    marks.sort_by(|a, b| b.away_m.total_cmp(&a.away_m));
    marks
}

/// Draws the marks; one that is clicked is selected.
pub(super) fn draw(context: &egui::Context, bench: &Bench<'_>, free: egui::Rect, marks: &[Mark], acts: &mut Acts) {
    for mark in marks.iter().filter(|mark| free.contains(mark.at)) {
        let size = bench.look.text * (1.1 - 0.6 * (mark.away_m / SEEN_M) as f32);
        let area = egui::Area::new(Id::new("tour mark").with(mark.step)).order(Order::Middle);
        let corner = mark.at - EguiVec2::splat(size);
        area.fixed_pos(corner).constrain(false).show(context, |ui| one(ui, bench, mark, size, acts));
    }
}

fn one(ui: &mut Ui, bench: &Bench<'_>, mark: &Mark, size: f32, acts: &mut Acts) {
    let (_, response) = ui.allocate_exact_size(EguiVec2::splat(size * 2.0), Sense::click());
    let number = (mark.step as u32 + 1).into();
    let name = bench.words.say_with("editor-mark", &[("n", number)]);
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, &name));
    let Some(step) = bench.edit.tour().steps.get(mark.step) else { return };
    let fill = colour(StepKind::of(step));
    let is_selected = bench.edit.selected().contains(&mark.step);
    let edge = if is_selected || response.hovered() { Color32::WHITE } else { Color32::from_white_alpha(150) };
    let painter = ui.ctx().layer_painter(ui.layer_id());
    let direction = mark.tip - mark.at;
    let length = direction.length();
    // Who looks at or from the eye is a ring only.
    if length > size * 0.1 {
        let way = direction / length;
        let side = EguiVec2::new(-way.y, way.x);
        let tip = mark.at + way * (size * 0.6 + length.min(size * 1.6));
        let foot = mark.at + way * size * 0.5;
        let arrow = vec![tip, foot + side * size * 0.45, foot - side * size * 0.45];
        painter.add(Shape::convex_polygon(arrow, fill, Stroke::new(1.5, edge)));
    }
    painter.circle(mark.at, size * 0.7, fill, Stroke::new(if is_selected { 2.5 } else { 1.5 }, edge));
    let text = format!("{}", mark.step + 1);
    painter.text(mark.at, Align2::CENTER_CENTER, text, egui::FontId::proportional(size * 0.75), Color32::WHITE);
    if response.on_hover_text(super::label::of(bench, step)).clicked() {
        acts.push(Act::Select(mark.step..mark.step + 1));
    }
}
