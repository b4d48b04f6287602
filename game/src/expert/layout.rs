//! The plan of cells about the viewer.

use std::collections::BTreeSet;

use bevy::math::DVec2;
use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{self, Align2, Color32, Id, Pos2, Sense, Shape, Stroke, Vec2, Window};
use veduta::city::GridPos;
use veduta::city::bounds::{self, Bounds};
use veduta::ecs::{Interface, OpenCells, Words};
use veduta::prelude::*;
use veduta::streaming::{CurrentCell, Streamed, Wanted};
use veduta::ui::Look;
use veduta_store::What;

use super::told::{across, cell_told};
use super::{EDGE, Expert, FAINT, HERE, INK, MARGIN, OPEN, PAPER, PENDING, SHUT, fill, frame, look, side};

/// From plan metres to the window's points.
struct View {
    middle: DVec2,
    at: Pos2,
    scale: f32,
}

impl View {
    fn point(&self, pos: GridPos) -> Pos2 {
        let p = (pos.to_metres() - self.middle).as_vec2() * self.scale;
        self.at + Vec2::new(p.x, -p.y)
    }

    fn plan(&self, at: Pos2) -> DVec2 {
        let p = (at - self.at) / self.scale;
        self.middle + DVec2::new(f64::from(p.x), -f64::from(p.y))
    }
}

pub(super) fn draw(
    mut contexts: EguiContexts,
    (words, interface): (Res<Words>, Res<Interface>),
    mut expert: ResMut<Expert>,
    streamed: Streamed<'_>,
    wanted: Res<Wanted>,
    open: Res<OpenCells>,
    viewers: Query<(&Eye, Option<&CurrentCell>), With<Viewer>>,
) -> Result {
    let context = contexts.ctx_mut()?;
    let Some(index) = streamed.index() else { return Ok(()) };
    let (look, side) = (look(&interface, context), side(context.content_rect()));
    let window = Window::new(words.say("expert-plan")).id(Id::new("veduta expert plan"));
    let window = window.frame(frame(&look)).title_bar(false).resizable(false);
    window.anchor(Align2::LEFT_BOTTOM, Vec2::new(MARGIN, -MARGIN) * look.text).show(context, |ui| {
        let (area, painter) = ui.allocate_painter(Vec2::splat(side), Sense::click());
        if let Some(scrolled) = area.hovered().then(|| ui.input(|input| input.smooth_scroll_delta.y)) {
            expert.reach_m = (expert.reach_m * (-scrolled * 0.004).exp()).clamp(40.0, 1_500.0);
        }
        let Some((eye, current)) = viewers.iter().next() else { return };
        let here = current.and_then(|current| current.0);
        let view = View { middle: eye.plan_pos, at: area.rect.center(), scale: side / 2.0 / expert.reach_m };
        let pending: Vec<u32> =
            streamed.pending().filter_map(|what| if let What::Packet { cell, .. } = what { Some(cell) } else { None }).collect();
        let reach = f64::from(expert.reach_m) * core::f64::consts::SQRT_2;
        let is_near = |of: Bounds| bounds::distance_m(of, eye.plan_pos) < reach;
        let in_sight: BTreeSet<u32> = wanted.in_sight.iter().copied().collect();
        for (cell, entry) in index.cells().filter(|(_, entry)| is_near(entry.bounds)) {
            let is_in_sight = in_sight.contains(&cell);
            let ring: Vec<Pos2> = entry.outline.outer.iter().map(|&pos| view.point(pos)).collect();
            let colour = if Some(cell) == here { HERE } else { fill(streamed.level(cell), is_in_sight) };
            paint(&painter, &entry.outline, &view, colour);
            painter.add(Shape::closed_line(ring, Stroke::new(look.text * 0.04, Color32::from_black_alpha(120))));
            if pending.contains(&cell) {
                let middle = view.point(GridPos::from_metres(entry.outline.centroid()));
                painter.circle_filled(middle, look.text * 0.3, PENDING);
            }
        }
        for (_, region) in index.regions_here() {
            for portal in &region.portals {
                let sides = [Some(portal.cell), portal.other(portal.cell)];
                let colour = match here {
                    _ if portal.is_blind() => EDGE,
                    Some(here) if sides.contains(&Some(here)) => {
                        let beyond = portal.other(here).unwrap_or(here);
                        if open.lead(here, beyond) { OPEN } else { SHUT }
                    }
                    _ => continue,
                };
                let stroke = Stroke::new(look.text * 0.15, colour);
                painter.line_segment([view.point(portal.ends.0), view.point(portal.ends.1)], stroke);
            }
        }
        draw_viewer(&painter, &view, eye, look.text);
        let told = area.hover_pos().map(|at| view.plan(at)).and_then(|pos| index.locate(GridPos::from_metres(pos)));
        if let Some((cell, entry)) = told.and_then(|cell| Some((cell, index.cell(cell)?))) {
            let text = cell_told(&words, cell, &entry.name, entry.houses, streamed.level(cell), wanted.why(cell));
            foot(&painter, &look, area.rect, text, INK);
        } else {
            foot(&painter, &look, area.rect, across(&words, 2.0 * expert.reach_m), FAINT);
        }
        if let Some(to) = area.clicked().then(|| area.interact_pointer_pos()).flatten().map(|at| view.plan(at)) {
            expert.leap = Some(to);
        }
    });
    Ok(())
}

/// A line at the foot of the plan, on paper of its own.
fn foot(painter: &egui::Painter, look: &Look, area: egui::Rect, text: String, colour: Color32) {
    let edge = look.text * 0.3;
    let words = painter.layout(text, look.font(1.0), colour, area.width() - 2.0 * edge);
    let above = Vec2::new(0.0, words.size().y + 2.0 * edge);
    let paper = egui::Rect::from_min_max(area.left_bottom() - above, area.right_bottom());
    painter.rect_filled(paper, 0.0, PAPER);
    painter.galley(paper.min + Vec2::splat(edge), words, colour);
}

/// Fills a cell, which need not be convex.
fn paint(painter: &egui::Painter, outline: &veduta::city::GridPolygon, view: &View, colour: Color32) {
    let (mut points, mut holes) = (Vec::new(), Vec::new());
    for ring in outline.rings() {
        if !points.is_empty() {
            holes.push(points.len() as u32);
        }
        points.extend(ring.iter().map(|&pos| view.point(pos)));
    }
    let mut triangles: Vec<u32> = Vec::new();
    earcut::Earcut::new().earcut(points.iter().map(|p| [p.x, p.y]), &holes, &mut triangles);
    let mut mesh = egui::Mesh::default();
    points.into_iter().for_each(|point| mesh.colored_vertex(point, colour));
    triangles.chunks_exact(3).for_each(|t| mesh.add_triangle(t[0], t[1], t[2]));
    painter.add(Shape::mesh(mesh));
}

/// An arrow where the viewer is, about as high as text.
fn draw_viewer(painter: &egui::Painter, view: &View, eye: &Eye, text: f32) {
    let heading = eye.heading_deg.to_radians() as f32;
    let ahead = Vec2::new(heading.sin(), -heading.cos()) * text;
    let aside = Vec2::new(-ahead.y, ahead.x);
    let at = view.at;
    let (back, aside) = (at - ahead * 0.37, aside * 0.37);
    let arrow = [at + ahead * 0.67, back + aside, at - ahead * 0.15, back - aside];
    painter.add(Shape::convex_polygon(vec![arrow[0], arrow[1], arrow[2]], INK, Stroke::NONE));
    painter.add(Shape::convex_polygon(vec![arrow[0], arrow[2], arrow[3]], INK, Stroke::NONE));
}
