//! The journal's last lines, between the place's name and the plan of cells.

use std::collections::VecDeque;

use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{Align2, Color32, FontId, Id, RichText, ScrollArea, Vec2, Window};
use veduta::ecs::{Interface, Words};
use veduta::streaming::{Entry, Event, Journal};
use veduta::ui::Surface;

use super::told::happened;
use super::{FAINT, INK, MARGIN, PENDING, SHUT, frame, look, side};

/// Lines that are shown.
const LINES: usize = 200;

/// The lines as they were said: each is said once.
#[derive(Default)]
pub(super) struct Said {
    language: String,
    /// So many entries there had been.
    noted: u64,
    lines: VecDeque<(String, Color32)>,
}

impl Said {
    /// Says what is new; all of it in another language.
    fn follow(&mut self, journal: &Journal, words: &Words) {
        if self.language != words.language() || self.noted > journal.noted() {
            *self = Self { language: words.language().to_owned(), ..Self::default() };
        }
        let new = (journal.noted() - self.noted).min(LINES as u64) as usize;
        let skipped = journal.entries().len().saturating_sub(new);
        self.lines.extend(journal.entries().skip(skipped).map(|entry| line(words, entry)));
        let excess = self.lines.len().saturating_sub(LINES);
        self.lines.drain(..excess);
        self.noted = journal.noted();
    }
}

pub(super) fn draw(
    mut contexts: EguiContexts,
    (words, interface): (Res<Words>, Res<Interface>),
    journal: Res<Journal>,
    mut said: Local<Said>,
) -> Result {
    let context = contexts.ctx_mut()?;
    let look = look(&interface, context);
    let screen = context.content_rect();
    said.follow(&journal, &words);
    let title = words.say("expert-journal");
    let window = Window::new(title.clone()).id(Id::new("veduta expert journal"));
    let window = window.frame(frame(&look)).title_bar(false).resizable(false);
    let corner = Vec2::new(look.text * MARGIN, screen.height() * 0.11);
    window.anchor(Align2::LEFT_TOP, corner).show(context, |ui| {
        look.dress(ui, Surface::Dusk);
        ui.spacing_mut().item_spacing.y = look.text * 0.2;
        let broad = side(screen);
        ui.set_width(broad);
        ui.label(look.words(title, 1.0, FAINT));
        // As much as the plan of cells leaves.
        let high = (screen.height() * 0.45 - look.text * 7.0).max(screen.height() * 0.1);
        ScrollArea::vertical().max_height(high).min_scrolled_height(high).stick_to_bottom(true).show(ui, |ui| {
            ui.set_width(broad - look.text * 0.6);
            for (text, colour) in &said.lines {
                ui.label(RichText::new(text).font(FontId::monospace(look.text * 0.8)).color(*colour));
            }
        });
    });
    Ok(())
}

/// A line, and its colour.
fn line(words: &Words, entry: &Entry) -> (String, Color32) {
    let colour = match entry.event {
        Event::Opened { .. } | Event::Entered { .. } => INK,
        Event::Asked { .. } | Event::Cancelled { .. } | Event::Released { .. } => FAINT,
        Event::Arrived { .. } => PENDING,
        Event::Failed { .. } => SHUT,
    };
    (format!("{:>8}  {}", words.number(entry.at_s, 2), happened(words, &entry.event)), colour)
}

#[cfg(test)]
mod tests {
    use super::super::tongues;
    use super::*;

    #[test]
    fn lines_follow_the_journal_and_the_language() {
        let note = |journal: &mut Journal, cell: u32| journal.note(1.5, Event::Entered { viewer: 7, cell: Some(cell) });
        let (mut said, mut journal) = (Said::default(), Journal::default());
        let tongues: Vec<Words> = tongues().collect();
        let mut told = |journal: &Journal, words: &Words| {
            said.follow(journal, words);
            said.lines.iter().map(|(text, _)| text.trim().to_owned()).collect::<Vec<_>>()
        };
        note(&mut journal, 3);
        assert_eq!(told(&journal, &tongues[0]), ["1.50  entered cell 3"]);
        note(&mut journal, 4);
        assert_eq!(told(&journal, &tongues[0]), ["1.50  entered cell 3", "1.50  entered cell 4"], "each once");
        assert_eq!(told(&journal, &tongues[1]), ["1,50  vstup do buňky 3", "1,50  vstup do buňky 4"]);
        (0..300).for_each(|cell| note(&mut journal, cell));
        let last = told(&journal, &tongues[1]);
        assert_eq!((last.len(), last[LINES - 1].as_str()), (LINES, "1,50  vstup do buňky 299"));
        assert_eq!(told(&Journal::default(), &tongues[1]), Vec::<String>::new(), "a journal of its own");
    }
}
