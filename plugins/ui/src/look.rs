use bevy_egui::egui::{self, Color32, CornerRadius, FontId, Frame, Margin, RichText, Stroke, TextStyle};
use veduta_ecs::{Docks, Interface};

/// Sizes and colours of one frame's interface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Height of running text, points.
    pub text: f32,
    /// Whether contrast is as high as can be.
    pub high_contrast: bool,
    /// Whether nothing slides or glides.
    pub reduced_motion: bool,
}

/// What something is written on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Surface {
    /// Light, for reading.
    Paper,
    /// Dark, for what lies over the picture and should not draw the eye.
    Dusk,
}

/// Height of running text as a share of the window's height, at size 1.
const TEXT: f32 = 0.022;

impl Look {
    /// The look for a window.
    #[must_use]
    pub fn of(interface: &Interface, context: &egui::Context) -> Self {
        let size = interface.size.clamp(0.5, 3.0);
        let text = (context.content_rect().height() * TEXT).max(11.0) * size;
        Self { text, high_contrast: interface.high_contrast, reduced_motion: interface.reduced_motion }
    }

    /// What docks leave of a window.
    #[must_use]
    pub fn free(docks: &Docks, context: &egui::Context) -> egui::Rect {
        let mut rect = context.content_rect();
        rect.min.x += docks.left;
        rect.max.x = (rect.max.x - docks.right).max(rect.min.x);
        rect.max.y = (rect.max.y - docks.bottom).max(rect.min.y);
        rect
    }

    /// Colour of what is written on a surface.
    #[must_use]
    pub const fn ink(&self, surface: Surface) -> Color32 {
        match (surface, self.high_contrast) {
            (Surface::Paper, false) => Color32::from_rgb(0x3A, 0x31, 0x27),
            (Surface::Paper, true) => Color32::BLACK,
            (Surface::Dusk, false) => Color32::from_rgb(0xF6, 0xEF, 0xE0),
            (Surface::Dusk, true) => Color32::WHITE,
        }
    }

    /// Colour of what matters less.
    #[must_use]
    pub const fn faint(&self, surface: Surface) -> Color32 {
        match (surface, self.high_contrast) {
            (Surface::Paper, false) => Color32::from_rgb(0x75, 0x68, 0x58),
            (Surface::Dusk, false) => Color32::from_rgb(0xC4, 0xB8, 0xA4),
            (_, true) => self.ink(surface),
        }
    }

    /// Colour of what is chosen or can be clicked.
    #[must_use]
    pub const fn accent(&self, surface: Surface) -> Color32 {
        match (surface, self.high_contrast) {
            (Surface::Paper, false) => Color32::from_rgb(0x9C, 0x3B, 0x2E),
            (Surface::Paper, true) => Color32::from_rgb(0x00, 0x00, 0xC8),
            (Surface::Dusk, false) => Color32::from_rgb(0xE8, 0xC9, 0x8A),
            (Surface::Dusk, true) => Color32::from_rgb(0xFF, 0xE0, 0x00),
        }
    }

    /// The surface itself.
    #[must_use]
    pub const fn ground(&self, surface: Surface) -> Color32 {
        match (surface, self.high_contrast) {
            (Surface::Paper, false) => Color32::from_rgb(0xF4, 0xEE, 0xE1),
            (Surface::Paper, true) => Color32::WHITE,
            (Surface::Dusk, false) => Color32::from_rgba_premultiplied(0x16, 0x12, 0x0F, 0xE8),
            (Surface::Dusk, true) => Color32::BLACK,
        }
    }

    /// A sheet of a surface, with room about what stands on it.
    pub fn frame(&self, surface: Surface) -> Frame {
        let margin = |share: f32| (self.text * share).round().clamp(0.0, 127.0) as i8;
        let edge = if self.high_contrast { Stroke::new(2.0, self.ink(surface)) } else { Stroke::NONE };
        Frame::new()
            .fill(self.ground(surface))
            .stroke(edge)
            .corner_radius(CornerRadius::same(6))
            .inner_margin(Margin::symmetric(margin(0.9), margin(0.6)))
    }

    /// Letters so many times as high as running text.
    #[must_use]
    pub fn font(&self, times: f32) -> FontId {
        FontId::proportional(self.text * times)
    }

    /// Words in such letters and a colour.
    #[must_use]
    pub fn words(&self, text: impl Into<String>, times: f32, colour: Color32) -> RichText {
        RichText::new(text).font(self.font(times)).color(colour)
    }

    /// Makes all that is drawn in `ui` from now on look as if written on a surface.
    pub fn dress(&self, ui: &mut egui::Ui, surface: Surface) {
        let (ink, ground, accent) = (self.ink(surface), self.ground(surface), self.accent(surface));
        let style = ui.style_mut();
        for (name, font) in &mut style.text_styles {
            *font = match name {
                TextStyle::Heading => self.font(1.35),
                TextStyle::Small => self.font(0.85),
                TextStyle::Monospace => FontId::monospace(self.text),
                _ => self.font(1.0),
            };
        }
        style.spacing.item_spacing = egui::vec2(self.text * 0.5, self.text * 0.35);
        style.spacing.button_padding = egui::vec2(self.text * 0.5, self.text * 0.25);
        style.spacing.interact_size.y = self.text * 1.5;
        style.spacing.slider_width = self.text * 9.0;
        style.spacing.icon_width = self.text * 0.95;
        style.spacing.icon_width_inner = self.text * 0.55;
        style.spacing.icon_spacing = self.text * 0.35;
        let visuals = &mut style.visuals;
        *visuals = if surface == Surface::Paper { egui::Visuals::light() } else { egui::Visuals::dark() };
        visuals.override_text_color = Some(ink);
        visuals.hyperlink_color = accent;
        visuals.window_fill = ground;
        visuals.panel_fill = ground;
        visuals.extreme_bg_color =
            ground.lerp_to_gamma(if surface == Surface::Paper { Color32::WHITE } else { Color32::BLACK }, 0.6);
        visuals.selection.bg_fill = accent.gamma_multiply(0.45);
        visuals.selection.stroke = Stroke::new(1.5, ink);
        let between = |share: f32| ground.to_opaque().lerp_to_gamma(ink, share);
        let widgets = &mut visuals.widgets;
        let parts = [
            (&mut widgets.noninteractive, 0.0, 0.25),
            (&mut widgets.inactive, 0.10, 0.35),
            (&mut widgets.hovered, 0.20, 0.6),
            (&mut widgets.active, 0.32, 0.9),
            (&mut widgets.open, 0.16, 0.5),
        ];
        for (widget, fill, edge) in parts {
            widget.bg_fill = between(fill);
            widget.weak_bg_fill = between(fill);
            widget.bg_stroke = Stroke::new(1.0, between(if self.high_contrast { 1.0 } else { edge }));
            widget.fg_stroke = Stroke::new(1.5, ink);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contrast of two colours, 1 to 21 (WCAG 2.2).
    fn contrast(a: Color32, b: Color32) -> f32 {
        let light = |c: Color32| {
            let [r, g, b, _] = egui::Rgba::from(c.to_opaque()).to_array();
            0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05
        };
        let (a, b) = (light(a), light(b));
        a.max(b) / a.min(b)
    }

    #[test]
    fn all_that_is_written_can_be_read() {
        for high_contrast in [false, true] {
            let look = Look { text: 16.0, high_contrast, reduced_motion: false };
            // WCAG asks for 4.5, and for 7 at its highest level.
            let least = if high_contrast { 7.0 } else { 4.5 };
            for surface in [Surface::Paper, Surface::Dusk] {
                let ground = look.ground(surface);
                for ink in [look.ink(surface), look.faint(surface), look.accent(surface)] {
                    let contrast = contrast(ink, ground);
                    assert!(contrast >= least, "{surface:?}, high contrast {high_contrast}: {contrast:.1}");
                }
            }
        }
    }
}
