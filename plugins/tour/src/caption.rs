use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{Align2, Area, Id, Label, Order, TextWrapMode, Vec2};
use veduta_controls::{KeyNames, Layers};
use veduta_ecs::{Docks, Interface, Words};
use veduta_ui::{Look, Surface};

use crate::controls::TourPause;
use crate::{TourEditor, TourPlayer, TourState};

/// How captions look. Live.
#[derive(Resource, Debug, Clone, Copy, PartialEq)]
pub struct CaptionSettings {
    /// Whether they are shown.
    pub visible: bool,
    /// Height of the letters as a multiple of running text.
    pub size: f32,
}

impl Default for CaptionSettings {
    fn default() -> Self {
        Self { visible: true, size: 1.35 }
    }
}

/// Draws the caption of this moment, low in the middle, and what keeps a tour waiting.
pub(crate) fn draw_caption(
    mut contexts: EguiContexts,
    player: Res<TourPlayer>,
    settings: Res<CaptionSettings>,
    (words, keys): (Res<Words>, Res<KeyNames>),
    (interface, docks, layers): (Res<Interface>, Res<Docks>, Res<Layers>),
    editor: Res<TourEditor>,
) -> Result {
    // What has gone wrong is told without captions, too. It stays: whoever reads a page sees it afterwards.
    let error = player.error();
    if layers.has_page() || (!settings.visible && error.is_none()) {
        return Ok(());
    }
    let text = match (error, player.caption(words.language()), player.state()) {
        (Some(error), ..) => error.to_owned(),
        (None, Some(caption), _) => caption.to_owned(),
        // Who edits a tour comes and goes.
        (None, None, TourState::Waiting | TourState::Wandering) if editor.is_open() => return Ok(()),
        (None, None, TourState::Waiting) => words.say("tour-waiting"),
        (None, None, TourState::Wandering) => words.say_with("tour-wandering", &[("key", keys.said::<TourPause>(&words).into())]),
        _ => return Ok(()),
    };
    let context = contexts.ctx_mut()?;
    let look = Look::of(&interface, context);
    let screen = Look::free(&docks, context);
    // Above whatever lies along the lower edge.
    let offset = Vec2::new(0.0, -screen.height() * 0.03 - look.text * 3.4);
    let area = Area::new(Id::new("veduta caption")).constrain_to(screen).anchor(Align2::CENTER_BOTTOM, offset);
    area.order(Order::Middle).interactable(false).show(context, |ui| {
        ui.set_max_width(screen.width() * 0.55);
        look.frame(Surface::Dusk).show(ui, |ui| {
            let words = look.words(text, settings.size, look.ink(Surface::Dusk));
            ui.add(Label::new(words).wrap_mode(TextWrapMode::Wrap));
        });
    });
    Ok(())
}
