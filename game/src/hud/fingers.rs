use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{Color32, Id, LayerId, Order, Stroke, pos2};
use veduta::controls::Touching;

/// Radius of the ring, and of what lies under the finger; points.
const RING: f32 = 64.0;
const KNOB: f32 = 26.0;

/// Draws the stick that a finger makes.
pub(super) fn draw(mut contexts: EguiContexts, touching: Res<Touching>) -> Result {
    let Some((from, at)) = touching.stick_at else { return Ok(()) };
    let painter = contexts.ctx_mut()?.layer_painter(LayerId::new(Order::Background, Id::new("veduta stick")));
    let at = from + (at - from).clamp_length_max(RING);
    let (ring, knob) = (Color32::from_white_alpha(110), Color32::from_white_alpha(150));
    painter.circle(pos2(from.x, from.y), RING, Color32::from_black_alpha(40), Stroke::new(2.0, ring));
    painter.circle_filled(pos2(at.x, at.y), KNOB, knob);
    Ok(())
}
