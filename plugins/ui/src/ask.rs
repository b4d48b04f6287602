use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{self, Align2, Area, Id, Key, Order, OutputCommand, Ui, Vec2};
use veduta_ecs::{Interface, Words};

use crate::{Look, Surface};

/// A page on the web that was asked for, until the visitor has said yes or no.
#[derive(Resource, Debug, Clone, PartialEq, Eq, Default)]
pub struct AskLink(
    /// Its address.
    pub Option<String>,
);

/// Whether an address leads to the web, and nowhere else.
fn is_of_the_web(address: &str) -> bool {
    let rest = address.strip_prefix("https://").or_else(|| address.strip_prefix("http://"));
    rest.is_some_and(|rest| !rest.is_empty()) && !address.chars().any(|c| c.is_whitespace() || c.is_control())
}

/// Stops links on their way out, asks, and lets through what was agreed to. What does not lead to the web is never opened.
pub(crate) fn ask(mut contexts: EguiContexts, interface: Res<Interface>, words: Res<Words>, mut asked: ResMut<AskLink>) -> Result {
    let context = contexts.ctx_mut()?;
    let mut clicked = None;
    context.output_mut(|output| {
        output.commands.retain(|command| match command {
            OutputCommand::OpenUrl(link) => {
                clicked = Some(link.url.clone());
                false
            }
            _ => true,
        });
    });
    if let Some(address) = clicked.filter(|address| is_of_the_web(address)) {
        asked.0 = Some(address);
    }
    let Some(address) = asked.0.clone() else { return Ok(()) };
    let look = Look::of(&interface, context);
    let answer = Area::new(Id::new("veduta ask link"))
        .anchor(Align2::CENTER_CENTER, Vec2::ZERO)
        .order(Order::Foreground)
        .show(context, |ui| look.frame(Surface::Paper).show(ui, |ui| ask_panel(ui, &look, &words, &address)).inner);
    match answer.inner {
        Some(true) if is_of_the_web(&address) => {
            context.open_url(egui::OpenUrl::new_tab(address));
            asked.0 = None;
        }
        Some(_) => asked.0 = None,
        None => {}
    }
    Ok(())
}

/// Asks whether to open a page: yes or no, or nothing yet.
pub fn ask_panel(ui: &mut Ui, look: &Look, words: &Words, address: &str) -> Option<bool> {
    look.dress(ui, Surface::Paper);
    ui.set_max_width(look.text * 34.0);
    ui.label(look.words(words.say("link-ask"), 1.15, look.ink(Surface::Paper)));
    ui.label(look.words(address, 1.0, look.accent(Surface::Paper)));
    let mut answer = None;
    ui.horizontal(|ui| {
        let yes = ui.button(words.say("link-open"));
        let no = ui.button(words.say("link-stay"));
        if yes.clicked() {
            answer = Some(true);
        }
        if no.clicked() || ui.input(|input| input.key_pressed(Key::Escape)) {
            answer = Some(false);
        }
    });
    answer
}

#[cfg(test)]
mod tests {
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use super::*;

    #[test]
    fn only_the_web_is_asked_about() {
        for address in ["https://example.org", "http://example.org/x?y=1"] {
            assert!(is_of_the_web(address), "{address}");
        }
        for address in
            ["file:///etc/passwd", "javascript:alert(1)", "https://", "mailto:a@b.c", "https://a b", "HTTPS://example.org", ""]
        {
            assert!(!is_of_the_web(address), "{address}");
        }
    }

    #[test]
    fn yes_no_and_escape_answer() {
        let look = Look { text: 16.0, high_contrast: false, reduced_motion: false };
        let mut words = Words::default();
        words.add("en", include_str!("../words/en.ftl")).expect("no mistakes");
        let mut harness = Harness::new_ui_state(
            |ui, answer: &mut Option<bool>| *answer = ask_panel(ui, &look, &words, "https://example.org").or(*answer),
            None,
        );
        harness.run();
        assert_eq!(*harness.state(), None);
        harness.get_by_label("Open").click();
        harness.run();
        assert_eq!(harness.state_mut().take(), Some(true));
        harness.get_by_label("Stay here").click();
        harness.run();
        assert_eq!(harness.state_mut().take(), Some(false));
        harness.key_press(Key::Escape);
        harness.run();
        assert_eq!(*harness.state(), Some(false));
    }
}
