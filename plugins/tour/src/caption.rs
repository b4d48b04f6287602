use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{Align2, Area, Color32, CornerRadius, FontId, Frame, Id, Label, Margin, Order, RichText, TextWrapMode, Vec2};

use crate::{TourPlayer, TourState};

/// How captions look. Live.
#[derive(Resource, Debug, Clone, Copy, PartialEq)]
pub struct CaptionSettings {
    /// Whether they are shown.
    pub visible: bool,
    /// Height of the letters as a share of the window's height.
    pub share: f32,
}

impl Default for CaptionSettings {
    fn default() -> Self {
        Self { visible: true, share: 0.031 }
    }
}

/// Draws the caption of this moment, low in the middle, and what keeps a tour waiting.
pub(crate) fn draw_caption(mut contexts: EguiContexts, player: Res<TourPlayer>, settings: Res<CaptionSettings>) -> Result {
    if !settings.visible {
        return Ok(());
    }
    let text = match (player.error(), player.caption(), player.state()) {
        (Some(error), ..) => error,
        (None, Some(caption), _) => caption,
        (None, None, TourState::Waiting) => "The tour begins as soon as its streets have arrived …",
        (None, None, TourState::Wandering) => "You have left the tour. T takes you back.",
        _ => return Ok(()),
    };
    let context = contexts.ctx_mut()?;
    let screen = context.content_rect();
    let size = (screen.height() * settings.share).max(12.0);
    Area::new(Id::new("veduta caption"))
        .anchor(Align2::CENTER_BOTTOM, Vec2::new(0.0, -screen.height() * 0.06))
        .order(Order::Middle)
        .interactable(false)
        .show(context, |ui| {
            ui.set_max_width(screen.width() * 0.55);
            let fill = Color32::from_rgba_unmultiplied(24, 20, 16, 190);
            Frame::new().fill(fill).corner_radius(CornerRadius::same(6)).inner_margin(Margin::symmetric(14, 8)).show(ui, |ui| {
                let words = RichText::new(text).font(FontId::proportional(size)).color(Color32::from_rgb(0xF6, 0xEF, 0xE0));
                ui.add(Label::new(words).wrap_mode(TextWrapMode::Wrap));
            });
        });
    Ok(())
}
