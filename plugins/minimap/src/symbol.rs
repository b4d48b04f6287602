use bevy::math::DVec2;
use bevy_egui::egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, Vec2};
use veduta_city::PlaceKind;
use veduta_ecs::Overviews;

use crate::view::Projection;

const INK: Color32 = Color32::from_rgb(0x7A, 0x2F, 0x25);
const HOUSE: Color32 = Color32::from_rgb(0x6B, 0x5D, 0x4B);
const VIEW: Color32 = Color32::from_rgb(0x2F, 0x6D, 0x9E);
const PAPER: Color32 = Color32::from_rgb(0xFB, 0xF8, 0xF1);

/// Points a metre from which on houses and views are marked too: further out there is no room.
const NEAR: f32 = 1.2;

/// Marks sights, houses with a name and views, where nothing else stands; what they take up is taken then.
pub(crate) fn draw_all(painter: &Painter, map: &Projection, overviews: &Overviews, size: f32, taken: &mut Vec<Rect>) {
    for place in overviews.places() {
        let is_shown = match place.kind {
            PlaceKind::Monument => true,
            PlaceKind::House | PlaceKind::Shop | PlaceKind::Viewpoint => map.scale > NEAR,
            PlaceKind::Square | PlaceKind::Street | PlaceKind::Other => false,
        };
        let at = map.screen(DVec2::new(place.pos.x, place.pos.y));
        let rect = Rect::from_center_size(at, Vec2::splat(size * 1.1));
        if !is_shown || !map.rect.contains_rect(rect) || taken.iter().any(|other| other.intersects(rect)) {
            continue;
        }
        draw(painter, at, place.kind, size);
        taken.push(rect);
    }
}

fn draw(painter: &Painter, at: Pos2, kind: PlaceKind, size: f32) {
    let half = size * 0.42;
    let p = |x: f32, y: f32| at + Vec2::new(x, y) * half;
    let edge = Stroke::new(size * 0.09, PAPER);
    match kind {
        // A tower with a pointed roof.
        PlaceKind::Monument => {
            let outline = vec![p(0.0, -1.3), p(0.55, -0.3), p(0.55, 1.0), p(-0.55, 1.0), p(-0.55, -0.3)];
            painter.add(Shape::convex_polygon(outline, INK, edge));
        }
        // An eye's cone.
        PlaceKind::Viewpoint => {
            painter.add(Shape::convex_polygon(vec![p(0.0, 0.8), p(-0.9, -0.8), p(0.9, -0.8)], VIEW, edge));
        }
        // A gable.
        _ => {
            painter.add(Shape::convex_polygon(
                vec![p(0.0, -0.9), p(0.8, -0.1), p(0.8, 0.8), p(-0.8, 0.8), p(-0.8, -0.1)],
                HOUSE,
                edge,
            ));
        }
    }
}
