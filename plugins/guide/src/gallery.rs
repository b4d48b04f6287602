use bevy_egui::egui::{Image, Label, TextWrapMode, TextureHandle, Ui, Vec2};
use veduta_city::GuidePlace;
use veduta_ecs::Words;
use veduta_ui::{Look, Pictures, Surface};

use crate::CityGuide;

/// A picture of a place, as it is shown.
pub(crate) enum Shown {
    /// It is here.
    Here { texture: TextureHandle, caption: String, credit: String },
    /// It lies on the web: whoever wants to see it is asked first.
    Away { address: String, caption: String, credit: String },
}

/// The pictures of a place that can be shown now; those that are on their way come later.
pub(crate) fn of_place(
    told: Option<&GuidePlace>,
    guide: &CityGuide,
    words: &Words,
    pictures: &mut Pictures,
    context: &bevy_egui::egui::Context,
) -> Vec<Shown> {
    let languages = words.preferred();
    let shown = |picture: &veduta_city::GuidePicture| {
        let caption = picture.caption_in(&languages).to_owned();
        let credit = picture.credit_in(&languages).to_owned();
        if picture.is_on_the_web() {
            return Some(Shown::Away { address: picture.file.clone(), caption, credit });
        }
        let texture = pictures.get(context, &guide.beside(&picture.file))?;
        Some(Shown::Here { texture, caption, credit })
    };
    told.into_iter().flat_map(|told| &told.pictures).filter_map(shown).collect()
}

/// A picture with what it shows and whose it is, as wide as there is room.
pub(crate) fn show(ui: &mut Ui, look: &Look, words: &Words, shown: &Shown) {
    let surface = Surface::Paper;
    let wrapped = |ui: &mut Ui, text: &str, size: f32, ink| {
        if !text.is_empty() {
            ui.add(Label::new(look.words(text, size, ink)).wrap_mode(TextWrapMode::Wrap));
        }
    };
    match shown {
        Shown::Here { texture, caption, credit } => {
            let room = Vec2::new(ui.available_width(), look.text * 14.0);
            let alt = if caption.is_empty() { credit } else { caption };
            ui.add(Image::new(texture).fit_to_original_size(1.0).max_size(room).maintain_aspect_ratio(true).alt_text(alt));
            wrapped(ui, caption, 0.9, look.ink(surface));
            wrapped(ui, credit, 0.75, look.faint(surface));
        }
        Shown::Away { address, caption, credit } => {
            let site = address.split("://").nth(1).unwrap_or(address).split('/').next().unwrap_or_default();
            let what = if caption.is_empty() { site } else { caption };
            let told = [("what", what.to_owned().into()), ("site", site.to_owned().into())];
            ui.hyperlink_to(words.say_with("place-picture", &told), address);
            wrapped(ui, credit, 0.75, look.faint(surface));
        }
    }
    ui.add_space(look.text * 0.4);
}

#[cfg(test)]
mod tests {
    use bevy_egui::egui::{Color32, ColorImage, OutputCommand, TextureOptions};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use super::*;

    fn words() -> Words {
        let mut words = Words::default();
        crate::WORDS.iter().for_each(|(code, messages)| words.add(code, messages).expect("no mistakes"));
        words
    }

    #[test]
    fn a_picture_says_what_it_shows_and_whose_it_is() {
        let (look, words) = (Look { text: 14.0, high_contrast: false, reduced_motion: true }, words());
        let harness = Harness::new_ui(|ui| {
            let texture = ui.ctx().load_texture("test", ColorImage::filled([40, 20], Color32::RED), TextureOptions::LINEAR);
            let shown = Shown::Here { texture, caption: "The tower".into(), credit: "Somebody, CC BY 4.0".into() };
            show(ui, &look, &words, &shown);
        });
        assert_eq!(harness.get_all_by_label("The tower").count(), 2, "to eyes and to screen readers");
        harness.get_by_label("Somebody, CC BY 4.0");
    }

    #[test]
    fn a_picture_on_the_web_is_not_fetched_but_asked_about() {
        let (look, words) = (Look { text: 14.0, high_contrast: false, reduced_motion: true }, words());
        let mut harness = Harness::new_ui(|ui| {
            let address = "https://example.org/tower.jpg".to_owned();
            show(ui, &look, &words, &Shown::Away { address, caption: String::new(), credit: "Somebody".into() });
        });
        harness.get_by_label_contains("example.org").click();
        let mut opened = Vec::new();
        for _ in 0..3 {
            harness.step();
            let commands = &harness.output().platform_output.commands;
            opened.extend(commands.iter().filter_map(|command| match command {
                OutputCommand::OpenUrl(link) => Some(link.url.clone()),
                _ => None,
            }));
        }
        assert_eq!(opened, ["https://example.org/tower.jpg"]);
    }
}
