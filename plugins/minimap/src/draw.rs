use bevy::math::DVec2;
use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{
    self, Align2, Color32, Context, FontId, Id, Order, Painter, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, Vec2 as EguiVec2,
};
use veduta_city::Viewpoint;
use veduta_ecs::{City, Eye, JumpTo, Viewer};

use crate::MinimapSettings;
use crate::label;
use crate::tiles::{MapTiles, PAPER};
use crate::view::{MapView, Projection, zoomed};

/// Draws the map in the corner, or the large one.
pub(crate) fn draw_map(
    mut contexts: EguiContexts,
    city: Option<Res<City>>,
    tiles: Res<MapTiles>,
    viewers: Query<&Eye, With<Viewer>>,
    mut settings: ResMut<MinimapSettings>,
    mut view: ResMut<MapView>,
    mut jumps: MessageWriter<JumpTo>,
) -> Result {
    let (Some(city), Some(eye)) = (city, viewers.iter().next()) else { return Ok(()) };
    if !settings.visible && !view.open {
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    if view.open {
        large_map(context, &city, &tiles, eye, &mut view, &mut jumps);
    } else {
        corner_map(context, &city, &tiles, eye, &mut settings, &mut view);
    }
    Ok(())
}

fn corner_map(context: &Context, city: &City, tiles: &MapTiles, eye: &Eye, settings: &mut MinimapSettings, view: &mut MapView) {
    let screen = context.content_rect();
    let edge = (screen.height() * settings.share).clamp(120.0, 900.0);
    let margin = edge * 0.06;
    let corner = screen.right_bottom() - EguiVec2::splat(edge + margin);
    egui::Area::new(Id::new("veduta minimap")).fixed_pos(corner).order(Order::Middle).show(context, |ui| {
        let (rect, response) = ui.allocate_exact_size(EguiVec2::splat(edge), Sense::click());
        if response.hovered() {
            let wheel = ui.input(|i| i.smooth_scroll_delta().y);
            settings.radius_m = zoomed(settings.radius_m, (-wheel / 300.0).exp());
        }
        if response.on_hover_text("Click for the large map (M)").clicked() {
            view.open = true;
            view.middle = None;
            view.radius_m = view.radius_m.max(settings.radius_m * 2.0);
        }
        let up = if settings.north_up { 0.0 } else { eye.heading_deg };
        let map = Projection::new(rect, eye.plan_pos, settings.radius_m, up);
        paint(&ui.painter().with_clip_rect(rect), &map, city, tiles, eye, edge / 18.0);
        ui.painter().rect_stroke(rect, 4.0, Stroke::new(2.0, Color32::from_rgb(0x6B, 0x5D, 0x4B)), StrokeKind::Middle);
    });
}

fn large_map(context: &Context, city: &City, tiles: &MapTiles, eye: &Eye, view: &mut MapView, jumps: &mut MessageWriter<JumpTo>) {
    let screen = context.content_rect();
    egui::Area::new(Id::new("veduta map")).fixed_pos(screen.min).order(Order::Foreground).show(context, |ui| {
        let (rect, response) = ui.allocate_exact_size(screen.size(), Sense::click_and_drag());
        let map = Projection::new(rect, view.middle.unwrap_or(eye.plan_pos), view.radius_m, 0.0);
        if response.dragged() {
            let d = response.drag_delta() / map.scale;
            view.middle = Some(map.middle() - DVec2::new(f64::from(d.x), f64::from(-d.y)));
        }
        let wheel = ui.input(|i| i.smooth_scroll_delta().y);
        if wheel != 0.0 {
            view.radius_m = zoomed(view.radius_m, (-wheel / 300.0).exp());
        }
        paint(ui.painter(), &map, city, tiles, eye, (screen.height() / 45.0).clamp(12.0, 48.0));
        title(ui.painter(), rect, &city.name, &city.attribution);
        if response.clicked()
            && let Some(at) = response.interact_pointer_pos()
        {
            jumps.write(JumpTo(target(city, map.plan(at), f64::from(14.0 / map.scale), eye)));
            view.open = false;
        }
    });
}

/// Where a click leads: to the place under it, else to the nearest street, else right there.
fn target(city: &City, at: DVec2, reach_m: f64, eye: &Eye) -> Viewpoint {
    let near = city.overviews.places().map(|p| (DVec2::new(p.pos.x, p.pos.y).distance(at), p)).min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((d, place)) = near
        && d <= reach_m
        && let Some(view) = place.view
    {
        return view;
    }
    let spot = nearest_on_street(city, at).filter(|p| p.distance(at) < 40.0).unwrap_or(at);
    Viewpoint { pos: [spot.x, spot.y].into(), heading_deg: eye.heading_deg, ..Viewpoint::default() }
}

fn nearest_on_street(city: &City, at: DVec2) -> Option<DVec2> {
    let streets = city.overviews.iter().flat_map(|(_, overview)| &overview.streets).filter(|s| s.walkable);
    let pieces = streets.flat_map(|s| s.line.windows(2).map(|w| [w[0], w[1]].map(|p| p.to_metres())));
    pieces
        .map(|[a, b]| {
            let (a, b) = (DVec2::new(a.x, a.y), DVec2::new(b.x, b.y));
            let t = ((at - a).dot(b - a) / (b - a).length_squared().max(1e-9)).clamp(0.0, 1.0);
            a.lerp(b, t)
        })
        .min_by(|a, b| a.distance_squared(at).total_cmp(&b.distance_squared(at)))
}

fn title(painter: &Painter, rect: Rect, name: &str, attribution: &str) {
    let ink = Color32::from_rgb(0x4A, 0x40, 0x35);
    let size = (rect.height() / 26.0).clamp(18.0, 80.0);
    painter.text(rect.left_top() + EguiVec2::splat(size * 0.6), Align2::LEFT_TOP, name, FontId::proportional(size), ink);
    let hint = "click: go there · drag, wheel: move, zoom · M: back";
    painter.text(
        rect.left_bottom() + EguiVec2::new(size * 0.6, -size * 0.5),
        Align2::LEFT_BOTTOM,
        hint,
        FontId::proportional(size * 0.5),
        ink,
    );
    painter.text(
        rect.right_bottom() - EguiVec2::splat(size * 0.5),
        Align2::RIGHT_BOTTOM,
        attribution,
        FontId::proportional(size * 0.4),
        ink,
    );
}

fn paint(painter: &Painter, map: &Projection, city: &City, tiles: &MapTiles, eye: &Eye, text: f32) {
    painter.rect_filled(map.rect, 4.0, PAPER);
    for tile in tiles.near(map.middle().as_vec2(), map.reach_m()) {
        let vertices = tile.points.iter().zip(&tile.colours).map(|(&[x, y], &color)| egui::epaint::Vertex {
            pos: map.screen(DVec2::new(f64::from(x), f64::from(y))),
            uv: egui::epaint::WHITE_UV,
            color,
        });
        let mesh = egui::Mesh { vertices: vertices.collect(), indices: tile.indices.clone(), ..egui::Mesh::default() };
        painter.add(Shape::mesh(mesh));
    }
    label::write(painter, map, &city.overviews, text);
    marker(painter, map, eye, text);
    compass(painter, map, text);
}

/// The walker: a dot with a cone of view.
fn marker(painter: &Painter, map: &Projection, eye: &Eye, size: f32) {
    let at = map.screen(eye.plan_pos);
    let ahead = eye.heading_deg.to_radians() as f32 - map.up;
    let half = (eye.fov_deg.to_radians() as f32 * 0.75).min(1.2);
    let ray = |angle: f32| at + EguiVec2::new(angle.sin(), -angle.cos()) * size * 2.6;
    let cone: Vec<Pos2> = core::iter::once(at).chain((0..=8).map(|i| ray(ahead - half + half * i as f32 / 4.0))).collect();
    painter.add(Shape::convex_polygon(cone, Color32::from_rgba_unmultiplied(0xB0, 0x3A, 0x2E, 70), Stroke::NONE));
    painter.circle(at, size * 0.42, Color32::from_rgb(0xB0, 0x3A, 0x2E), Stroke::new(size * 0.12, Color32::WHITE));
}

fn compass(painter: &Painter, map: &Projection, size: f32) {
    let at = map.rect.left_top() + EguiVec2::splat(size * 1.4);
    let (sin, cos) = map.up.sin_cos();
    let north = EguiVec2::new(-sin, -cos);
    let side = EguiVec2::new(-north.y, north.x);
    let tip = |along: f32, across: f32| at + north * size * along + side * size * across;
    painter.circle_filled(at, size * 1.05, Color32::from_rgba_unmultiplied(0xFB, 0xF8, 0xF1, 200));
    let red = Color32::from_rgb(0xB0, 0x3A, 0x2E);
    painter.add(Shape::convex_polygon(vec![tip(0.9, 0.0), tip(0.0, 0.3), tip(0.0, -0.3)], red, Stroke::NONE));
    let grey = Color32::from_rgb(0x8C, 0x86, 0x7C);
    painter.add(Shape::convex_polygon(vec![tip(-0.9, 0.0), tip(0.0, -0.3), tip(0.0, 0.3)], grey, Stroke::NONE));
}
