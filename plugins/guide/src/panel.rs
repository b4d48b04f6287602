use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{Align2, Area, Color32, CornerRadius, FontId, Frame, Id, Margin, Order, RichText, Vec2};

use crate::NearPlace;

/// How the panel looks. Live.
#[derive(Resource, Debug, Clone, Copy, PartialEq)]
pub struct PanelSettings {
    /// Whether it is shown.
    pub visible: bool,
    /// Height of the letters as a share of the window's height.
    pub share: f32,
}

impl Default for PanelSettings {
    fn default() -> Self {
        Self { visible: true, share: 0.024 }
    }
}

/// Name and text of the place, at the top left.
pub(crate) fn draw_panel(mut contexts: EguiContexts, near: Res<NearPlace>, settings: Res<PanelSettings>) -> Result {
    let Some(place) = near.0.as_ref().filter(|_| settings.visible) else { return Ok(()) };
    let context = contexts.ctx_mut()?;
    let screen = context.content_rect();
    let size = (screen.height() * settings.share).max(11.0);
    Area::new(Id::new("veduta place"))
        .anchor(Align2::LEFT_TOP, Vec2::splat(screen.height() * 0.03))
        .order(Order::Middle)
        .interactable(false)
        .show(context, |ui| {
            ui.set_max_width((screen.width() * 0.3).max(220.0));
            let paper = Color32::from_rgba_unmultiplied(0xF4, 0xEE, 0xE1, 225);
            Frame::new().fill(paper).corner_radius(CornerRadius::same(6)).inner_margin(Margin::symmetric(14, 10)).show(ui, |ui| {
                let ink = Color32::from_rgb(0x3A, 0x31, 0x27);
                ui.label(RichText::new(&place.name).font(FontId::proportional(size * 1.35)).color(ink));
                if !place.text.is_empty() {
                    ui.label(RichText::new(&place.text).font(FontId::proportional(size)).color(ink));
                }
            });
        });
    Ok(())
}
