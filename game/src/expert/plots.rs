//! What was downloaded over the walk: all of it by time, and what each cell cost as it was entered.

use bevy::prelude::*;
use bevy_egui::egui::{self, Align2, Pos2, Rect, Sense, Stroke, Vec2};
use veduta::ecs::{CellEntered, CityOpened, Words};
use veduta::streaming::StreamingStats;
use veduta::ui::Look;

use super::told::{by_cell, downloaded};
use super::{FAINT, INK, OPEN, PENDING};

/// Bytes over the walk.
#[derive(Resource, Default)]
pub(crate) struct Downloads {
    /// When, and how many bytes by then.
    all: Vec<(f64, u64)>,
    /// Bytes that came while a viewer was in each cell on the way.
    cells: Vec<u64>,
}

/// Most values that are kept.
const MOST: usize = 4_000;

/// Takes down what has come.
pub(super) fn record(
    time: Res<Time>,
    stats: Res<StreamingStats>,
    mut opened: MessageReader<CityOpened>,
    mut entered: MessageReader<CellEntered>,
    mut downloads: ResMut<Downloads>,
) {
    if opened.read().count() > 0 {
        *downloads = Downloads::default();
    }
    let now = stats.bytes_all;
    let came = now.saturating_sub(downloads.all.last().map_or(0, |last| last.1));
    for _ in entered.read() {
        downloads.cells.push(0);
    }
    if came > 0 {
        downloads.all.push((time.elapsed_secs_f64(), now));
        if let Some(cell) = downloads.cells.last_mut() {
            *cell += came;
        }
    }
    // The earliest halves of a long walk are thinned out.
    if downloads.all.len() > MOST {
        let half = MOST / 2;
        let thin: Vec<_> = downloads.all.iter().take(half).step_by(2).copied().collect();
        downloads.all.splice(..half, thin);
    }
    let excess = downloads.cells.len().saturating_sub(MOST);
    downloads.cells.drain(..excess);
}

pub(super) fn show(ui: &mut egui::Ui, look: &Look, words: &Words, downloads: &Downloads, now_s: f64) {
    let size = Vec2::new(ui.available_width(), look.text * 4.0);
    // The rest is for what is written above.
    let high = look.text * 2.8;
    let began_s = downloads.all.first().map_or(now_s, |first| first.0);
    let total = downloads.all.last().map_or(0, |last| last.1);
    let (area, painter) = ui.allocate_painter(size, Sense::hover());
    let at = |s: f64, bytes: u64| {
        let x = ((s - began_s) / (now_s - began_s).max(1e-6)) as f32;
        area.rect.left_bottom() + Vec2::new(x * size.x, -(bytes as f32 / total.max(1) as f32) * high)
    };
    // Steps: between two arrivals nothing came.
    let mut line: Vec<Pos2> = Vec::new();
    for &(s, bytes) in &downloads.all {
        line.extend(line.last().map(|last| Pos2::new(at(s, bytes).x, last.y)));
        line.push(at(s, bytes));
    }
    line.extend(line.last().map(|last| Pos2::new(area.rect.right(), last.y)));
    painter.add(egui::Shape::line(line, Stroke::new(look.text * 0.11, OPEN)));
    let label = downloaded(words, total, now_s - began_s);
    painter.text(area.rect.left_top(), Align2::LEFT_TOP, label, look.font(0.9), INK);

    let (area, painter) = ui.allocate_painter(size, Sense::hover());
    let shown = 60.min(downloads.cells.len());
    let last = &downloads.cells[downloads.cells.len() - shown..];
    let most = last.iter().copied().max().unwrap_or(0).max(1);
    let broad = size.x / 60.0;
    for (n, &cell) in last.iter().enumerate() {
        let high = (cell as f32 / most as f32) * high;
        let left = area.rect.left_bottom() + Vec2::new(n as f32 * broad, -high);
        painter.rect_filled(Rect::from_min_size(left, Vec2::new(broad - 1.0, high.max(1.0))), 0.0, PENDING);
    }
    let label = by_cell(words, shown, most);
    painter.text(area.rect.left_top(), Align2::LEFT_TOP, label, look.font(0.9), FAINT);
}
