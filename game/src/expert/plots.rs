//! What was downloaded over the walk: all of it by time and by level, and what each cell cost as it was entered.

use bevy::prelude::*;
use bevy_egui::egui::{self, Align2, Rect, Sense, Vec2};
use veduta::ecs::{CellEntered, CityOpened, Words};
use veduta::streaming::StreamingStats;
use veduta::ui::Look;

use super::told::{by_cell, downloaded, of_kind};
use super::{FAINT, HERE, INK, OPEN, PENDING};

/// Bytes over the walk.
#[derive(Resource, Default)]
pub(crate) struct Downloads {
    /// When, and how many bytes of each kind had come by then.
    all: Vec<(f64, [u64; KINDS])>,
    /// Bytes that came while a viewer was in each cell on the way.
    cells: Vec<u64>,
}

/// Kinds of what comes: index, regions, houses and maps; then levels 1 to 3.
const KINDS: usize = 4;
/// Their colours.
const INKS: [egui::Color32; KINDS] = [FAINT, OPEN, PENDING, HERE];

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
    let [one, two, three, _] = stats.bytes_received;
    let now = [stats.bytes_all.saturating_sub(one + two + three), one, two, three];
    let sum = |kinds: &[u64; KINDS]| kinds.iter().sum::<u64>();
    let came = sum(&now).saturating_sub(downloads.all.last().map_or(0, |last| sum(&last.1)));
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
    let last = downloads.all.last().map_or([0; KINDS], |last| last.1);
    let total: u64 = last.iter().sum();
    let (area, painter) = ui.allocate_painter(size, Sense::hover());
    // A column for each point of the screen: what had come by then, one kind upon another.
    for column in 0..size.x as u32 {
        let s = began_s + (now_s - began_s) * f64::from(column + 1) / f64::from(size.x);
        let known = downloads.all.partition_point(|&(at_s, _)| at_s <= s);
        let Some(&(_, kinds)) = known.checked_sub(1).and_then(|known| downloads.all.get(known)) else { continue };
        let mut foot = area.rect.left_bottom() + Vec2::new(column as f32, 0.0);
        for (bytes, ink) in kinds.into_iter().zip(INKS) {
            let up = (bytes as f32 / total.max(1) as f32) * high;
            painter.rect_filled(Rect::from_min_max(foot - Vec2::new(0.0, up), foot + Vec2::new(1.0, 0.0)), 0.0, ink);
            foot.y -= up;
        }
    }
    let label = downloaded(words, total, now_s - began_s);
    painter.text(area.rect.left_top(), Align2::LEFT_TOP, label, look.font(0.9), INK);
    ui.horizontal_wrapped(|ui| {
        for (kind, (bytes, ink)) in last.into_iter().zip(INKS).enumerate() {
            ui.label(look.words(of_kind(words, kind, bytes), 0.9, ink));
        }
    });

    let (area, painter) = ui.allocate_painter(size, Sense::hover());
    let shown = 60.min(downloads.cells.len());
    let of_last = &downloads.cells[downloads.cells.len() - shown..];
    let most = of_last.iter().copied().max().unwrap_or(0).max(1);
    let broad = size.x / 60.0;
    for (n, &cell) in of_last.iter().enumerate() {
        let high = (cell as f32 / most as f32) * high;
        let left = area.rect.left_bottom() + Vec2::new(n as f32 * broad, -high);
        painter.rect_filled(Rect::from_min_size(left, Vec2::new(broad - 1.0, high.max(1.0))), 0.0, PENDING);
    }
    let label = by_cell(words, shown, most);
    painter.text(area.rect.left_top(), Align2::LEFT_TOP, label, look.font(0.9), FAINT);
}
