//! What was downloaded over the walk: all of it by time and by kind, and what came in each cell on the way.

use bevy::prelude::*;
use bevy_egui::egui::{self, Align2, Pos2, Rect, Sense, Vec2};
use veduta::ecs::Words;
use veduta::streaming::{BytesByKind, Downloads, Journal};
use veduta::ui::Look;

use super::told::{by_cell, downloaded, of_kind};
use super::{FAINT, HERE, INK, OPEN, PENDING};

/// What the journal has told so far.
#[derive(Resource, Default)]
pub(crate) struct Plotted {
    downloads: Downloads,
    /// So many entries there had been.
    noted: u64,
}

/// Kinds of what comes: index, regions, houses and maps; then levels 1 to 3. Level 4 is made of them and sends nothing.
const INKS: [egui::Color32; 4] = [FAINT, OPEN, PENDING, HERE];

/// Most steps and cells that are kept.
const MOST: usize = 4_000;
/// Cells that are shown: the last ones.
const CELLS: usize = 60;

/// Reads on in the journal.
pub(super) fn follow(journal: Res<Journal>, mut plotted: ResMut<Plotted>) {
    if plotted.noted == journal.noted() {
        return;
    }
    if plotted.noted > journal.noted() {
        *plotted = Plotted::default();
    }
    let new = (journal.noted() - plotted.noted).min(journal.entries().len() as u64) as usize;
    let Plotted { downloads, noted } = &mut *plotted;
    journal.entries().skip(journal.entries().len() - new).for_each(|entry| downloads.take(entry));
    downloads.thin(MOST);
    *noted = journal.noted();
}

pub(super) fn show(ui: &mut egui::Ui, look: &Look, words: &Words, plotted: &Plotted, now_s: f64) {
    let downloads = &plotted.downloads;
    let size = Vec2::new(ui.available_width(), look.text * 4.0);
    // The rest is for what is written above.
    let high = look.text * 2.8;
    let began_s = downloads.sums().first().map_or(now_s, |first| first.0);
    let total = downloads.sum();
    let (area, painter) = ui.allocate_painter(size, Sense::hover());
    // A column for each point of the screen: what had come by then.
    for column in 0..size.x as u32 {
        let s = began_s + (now_s - began_s) * f64::from(column + 1) / f64::from(size.x);
        let foot = area.rect.left_bottom() + Vec2::new(column as f32, 0.0);
        pile(&painter, foot, 1.0, high / total.sum().max(1) as f32, downloads.by(s));
    }
    let label = downloaded(words, total.sum(), now_s - began_s);
    painter.text(area.rect.left_top(), Align2::LEFT_TOP, label, look.font(0.9), INK);
    ui.horizontal_wrapped(|ui| {
        for (kind, (bytes, ink)) in total.0.into_iter().zip(INKS).enumerate() {
            ui.label(look.words(of_kind(words, kind, bytes), 0.9, ink));
        }
    });

    let (area, painter) = ui.allocate_painter(size, Sense::hover());
    let stays = downloads.stays();
    let shown = &stays[stays.len().saturating_sub(CELLS)..];
    let most = shown.iter().map(|stay| stay.bytes.sum()).max().unwrap_or(0).max(1);
    let broad = size.x / CELLS as f32;
    for (n, stay) in shown.iter().enumerate() {
        let foot = area.rect.left_bottom() + Vec2::new(n as f32 * broad, 0.0);
        let line = Rect::from_min_size(foot - Vec2::new(0.0, 1.0), Vec2::new(broad - 1.0, 1.0));
        painter.rect_filled(line, 0.0, FAINT);
        pile(&painter, foot, broad - 1.0, high / most as f32, stay.bytes);
    }
    let label = by_cell(words, shown.len(), most);
    painter.text(area.rect.left_top(), Align2::LEFT_TOP, label, look.font(0.9), FAINT);
}

/// A column of one kind upon another, each so high by the byte.
fn pile(painter: &egui::Painter, mut foot: Pos2, broad: f32, high: f32, bytes: BytesByKind) {
    for (bytes, ink) in bytes.0.into_iter().zip(INKS).filter(|&(bytes, _)| bytes > 0) {
        let up = bytes as f32 * high;
        painter.rect_filled(Rect::from_min_max(foot - Vec2::new(0.0, up), foot + Vec2::new(broad, 0.0)), 0.0, ink);
        foot.y -= up;
    }
}

#[cfg(test)]
mod tests {
    use bevy::ecs::system::RunSystemOnce;
    use veduta::streaming::{Event, What};

    use super::*;

    /// A world whose journal keeps so few entries that most are gone when they are read.
    fn world() -> World {
        let mut world = World::new();
        world.insert_resource(Journal::keeping(4));
        world.init_resource::<Plotted>();
        world
    }

    /// Notes what comes in so many seconds, 100 bytes in each.
    fn walk(world: &mut World, seconds: core::ops::Range<u32>) {
        for s in seconds {
            world.resource_mut::<Journal>().note(s.into(), Event::Arrived { what: What::Region(s), bytes: 100 });
        }
        world.run_system_once(follow).expect("it follows");
    }

    fn sum(world: &World) -> u64 {
        world.resource::<Plotted>().downloads.sum().sum()
    }

    #[test]
    fn a_journal_is_read_on_and_no_entry_twice() {
        let mut world = world();
        walk(&mut world, 0..3);
        assert_eq!(sum(&world), 300);
        walk(&mut world, 3..3);
        assert_eq!(sum(&world), 300, "nothing is new");
        walk(&mut world, 3..7);
        assert_eq!(sum(&world), 700, "what the journal has dropped was read before");
        walk(&mut world, 7..20);
        assert_eq!(sum(&world), 1_100, "of more than it keeps the last are read");
    }

    #[test]
    fn a_new_journal_is_plotted_alone() {
        let mut world = world();
        walk(&mut world, 0..4);
        world.insert_resource(Journal::keeping(4));
        walk(&mut world, 0..2);
        assert_eq!(sum(&world), 200);
    }
}
