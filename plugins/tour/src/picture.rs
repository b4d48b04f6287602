use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{Align2, Area, Id, Image, Label, Order, TextWrapMode, TextureHandle, Ui, Vec2};
use veduta_ecs::{Interface, Words};
use veduta_ui::{Look, Pictures, Surface};

use crate::{TourPlayer, TourState};

/// How far in the panel is: pictures come and go softly.
#[derive(Resource, Default)]
pub(crate) struct Shown {
    share: f32,
    last: Option<(TextureHandle, String)>,
}

/// Seconds in which a picture comes and goes.
const FADE_S: f32 = 0.4;
/// Most of the screen's width and height that a picture takes.
const SHARE: Vec2 = Vec2::new(0.34, 0.46);

/// Draws the tour's picture of this moment at the right, out of the way of captions and map.
pub(crate) fn draw_picture(
    mut contexts: EguiContexts,
    time: Res<Time<Real>>,
    player: Res<TourPlayer>,
    (words, interface): (Res<Words>, Res<Interface>),
    mut pictures: Pictures,
    mut shown: ResMut<Shown>,
) -> Result {
    let is_on = matches!(player.state(), TourState::Playing | TourState::Paused);
    let moment = player.tour().filter(|_| is_on).and_then(|tour| tour.picture(player.time_s()));
    if moment.is_none() && shown.share <= 0.0 {
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    let look = Look::of(&interface, context);
    let mut goal = 0.0;
    if let Some(picture) = moment
        && let Some(texture) = pictures.get(context, &player.beside(&picture.file))
    {
        goal = 1.0;
        shown.last = Some((texture, picture.caption.within(words.language()).to_owned()));
    }
    let step = if look.reduced_motion { 1.0 } else { time.delta_secs() / FADE_S };
    shown.share += (goal - shown.share).clamp(-step, step);
    let Some((texture, caption)) = shown.last.as_ref().filter(|_| shown.share > 0.0) else { return Ok(()) };
    let screen = context.content_rect();
    let area = Area::new(Id::new("veduta tour picture")).order(Order::Middle).interactable(false);
    area.anchor(Align2::RIGHT_CENTER, Vec2::new(-screen.width() * 0.03, 0.0)).show(context, |ui| {
        ui.set_opacity(shown.share);
        look.frame(Surface::Dusk).show(ui, |ui| show(ui, &look, texture, caption, screen.size() * SHARE));
    });
    Ok(())
}

/// A picture and what it shows, within so much room.
fn show(ui: &mut Ui, look: &Look, texture: &TextureHandle, caption: &str, room: Vec2) {
    let image = Image::new(texture).fit_to_original_size(1.0).max_size(room).maintain_aspect_ratio(true);
    let size = image.calc_size(room, Some(texture.size_vec2()));
    ui.set_max_width(size.x);
    let added = ui.add(if caption.is_empty() { image } else { image.alt_text(caption) });
    if !caption.is_empty() {
        ui.set_max_width(added.rect.width());
        ui.add(Label::new(look.words(caption, 0.9, look.ink(Surface::Dusk))).wrap_mode(TextWrapMode::Wrap));
    }
}

#[cfg(test)]
mod tests {
    use bevy_egui::egui::{Color32, ColorImage, TextureOptions};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use super::*;

    #[test]
    fn a_picture_keeps_its_form_within_the_room_and_its_words_below() {
        let look = Look { text: 14.0, high_contrast: false, reduced_motion: true };
        let mut harness = Harness::builder().with_size(Vec2::new(600.0, 600.0)).build_ui(|ui| {
            let image = ColorImage::filled([400, 100], Color32::RED);
            let texture = ui.ctx().load_texture("test", image, TextureOptions::LINEAR);
            show(ui, &look, &texture, "The square in 1895", Vec2::new(200.0, 300.0));
        });
        harness.run();
        let found: Vec<_> = harness.get_all_by_label("The square in 1895").map(|node| node.rect()).collect();
        assert_eq!(found.len(), 2, "the picture says what it shows, and so do the words");
        let picture = found.iter().max_by(|a, b| a.height().total_cmp(&b.height())).expect("two");
        assert!((picture.width() - 200.0).abs() < 1.0 && (picture.height() - 50.0).abs() < 1.0, "{picture:?}");
    }
}
