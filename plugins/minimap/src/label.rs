use std::collections::BTreeMap;

use bevy::math::DVec2;
use bevy_egui::egui::epaint::TextShape;
use bevy_egui::egui::{Color32, FontId, Painter, Pos2, Rect, Vec2};
use veduta_city::{Place, PlaceKind};
use veduta_ecs::{Overviews, PlaceNames};

use crate::view::Projection;

/// A name and where it would like to stand.
struct Label {
    text: String,
    at: Pos2,
    /// Radians, never upside down.
    angle: f32,
    size: f32,
    rank: u8,
    /// Points of street that carry it; names longer than their street are left out.
    room: f32,
}

const INK: Color32 = Color32::from_rgb(0x4A, 0x40, 0x35);
const HALO: Color32 = Color32::from_rgba_premultiplied(0xF2, 0xEE, 0xE6, 0xF2);

/// Writes the names of streets along them, and of places beside them, without overlap.
pub(crate) fn write(painter: &Painter, map: &Projection, overviews: &Overviews, names: &PlaceNames, size: f32, symbols: bool) {
    let mut labels = place_labels(map, overviews, names, size, symbols);
    labels.extend(street_labels(map, overviews, size));
    labels.sort_by(|a, b| a.rank.cmp(&b.rank).then_with(|| a.text.cmp(&b.text)));
    let mut taken: Vec<Rect> = Vec::new();
    let mut has_symbols = !symbols;
    for label in labels.into_iter().take(60) {
        // Marks give way to the names of squares, and all other names to marks.
        if label.rank > 0 && !has_symbols {
            has_symbols = true;
            crate::symbol::draw_all(painter, map, overviews, size, &mut taken);
        }
        let galley = painter.layout_no_wrap(label.text, FontId::proportional(label.size), INK);
        let half = galley.size() / 2.0;
        if galley.size().x > label.room {
            continue;
        }
        let (sin, cos) = label.angle.sin_cos();
        let extent = Vec2::new(half.x * cos.abs() + half.y * sin.abs(), half.x * sin.abs() + half.y * cos.abs());
        let rect = Rect::from_center_size(label.at, extent * 2.0).expand(2.0);
        if !map.rect.contains_rect(rect) || taken.iter().any(|t| t.intersects(rect)) {
            continue;
        }
        taken.push(rect);
        let corner = label.at - Vec2::new(half.x * cos - half.y * sin, half.x * sin + half.y * cos);
        for n in 0..12 {
            let offset = Vec2::angled(n as f32 * core::f32::consts::TAU / 12.0) * (size * 0.14).max(1.2);
            let halo = TextShape::new(corner + offset, galley.clone(), HALO).with_angle(label.angle).with_override_text_color(HALO);
            painter.add(halo);
        }
        painter.add(TextShape::new(corner, galley, INK).with_angle(label.angle));
    }
    if !has_symbols {
        crate::symbol::draw_all(painter, map, overviews, size, &mut taken);
    }
}

fn place_labels(map: &Projection, overviews: &Overviews, names: &PlaceNames, size: f32, symbols: bool) -> Vec<Label> {
    let shown = |place: &&Place| !matches!(place.kind, PlaceKind::Street | PlaceKind::Viewpoint);
    let near = |place: &&Place| map.rect.contains(map.screen(DVec2::new(place.pos.x, place.pos.y)));
    overviews
        .places()
        .filter(shown)
        .filter(near)
        .map(|place| {
            let rank = match place.kind {
                PlaceKind::Square => 0,
                PlaceKind::Monument => 1,
                _ => 3,
            };
            // A name stands below the mark of its place.
            let below = if symbols && rank > 0 { size * 1.3 } else { 0.0 };
            let at = map.screen(DVec2::new(place.pos.x, place.pos.y)) + Vec2::new(0.0, below);
            Label {
                text: names.of(&place.name).to_owned(),
                at,
                angle: 0.0,
                size: size * if rank == 0 { 1.1 } else { 0.95 },
                rank,
                room: f32::INFINITY,
            }
        })
        .filter(|label| label.rank < 3 || map.scale > 1.2)
        .collect()
}

/// One label a street name: on its longest straight piece in view.
fn street_labels(map: &Projection, overviews: &Overviews, size: f32) -> Vec<Label> {
    let mut best: BTreeMap<&str, (f32, Pos2, Pos2)> = BTreeMap::new();
    for street in overviews.iter().flat_map(|(_, overview)| &overview.streets).filter(|s| !s.name.is_empty()) {
        for pair in street.line.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|p| {
                let m = p.to_metres();
                map.screen(DVec2::new(m.x, m.y))
            });
            let middle = a + (b - a) / 2.0;
            let length = (b - a).length();
            if map.rect.contains(middle) && best.get(street.name.as_str()).is_none_or(|(l, ..)| *l < length) {
                best.insert(&street.name, (length, a, b));
            }
        }
    }
    best.into_iter()
        .map(|(name, (room, a, b))| {
            let d = if b.x >= a.x { b - a } else { a - b };
            let angle = d.y.atan2(d.x);
            Label { text: name.to_owned(), at: a + (b - a) / 2.0, angle, size: size * 0.9, rank: 2, room: room * 1.25 }
        })
        .collect()
}
