use bevy_egui::egui::{Align2, Area, Button, Context, Id, Order, Ui, Vec2, WidgetInfo, WidgetType};
use veduta_ecs::Words;
use veduta_ui::{Look, Surface};

use crate::{MapFormat, MinimapSettings};

/// Switches of the large map's layers, and what saves it; which format was chosen.
pub(crate) fn map_panel(context: &Context, look: &Look, words: &Words, settings: &mut MinimapSettings) -> Option<MapFormat> {
    let away = look.text * 0.9;
    let area =
        Area::new(Id::new("veduta map layers")).anchor(Align2::RIGHT_TOP, Vec2::new(-away, away * 4.5)).order(Order::Tooltip);
    area.show(context, |ui| look.frame(Surface::Paper).show(ui, |ui| panel(ui, look, words, settings)).inner).inner
}

/// The panel itself.
pub(crate) fn panel(ui: &mut Ui, look: &Look, words: &Words, settings: &mut MinimapSettings) -> Option<MapFormat> {
    look.dress(ui, Surface::Paper);
    let layers = [
        ("map-layer-names", &mut settings.names),
        ("map-layer-places", &mut settings.symbols),
        ("map-layer-views", &mut settings.views),
        ("map-layer-landmarks", &mut settings.landmarks),
        ("map-layer-route", &mut settings.route),
        ("map-layer-tour", &mut settings.tour),
        ("map-layer-trail", &mut settings.trail),
        ("map-colour-blind", &mut settings.colour_blind_safe),
    ];
    for (message, is_on) in layers {
        ui.checkbox(is_on, words.say(message));
    }
    let mut chosen = None;
    ui.horizontal(|ui| {
        ui.label(words.say("map-save"));
        for (format, told, message) in [(MapFormat::Svg, "SVG", "map-save-svg"), (MapFormat::Png, "PNG", "map-save-png")] {
            let name = words.say(message);
            let button = ui.add(Button::new(told));
            button.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, &name));
            if button.on_hover_text(name).clicked() {
                chosen = Some(format);
            }
        }
    });
    chosen
}

#[cfg(test)]
mod tests {
    use bevy_egui::egui::accesskit::Role;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use super::*;

    #[test]
    fn every_layer_is_switched_and_both_formats_are_asked_for_by_name() {
        let mut words = Words::default();
        crate::WORDS.iter().for_each(|(code, file)| words.add(code, file).expect("no mistakes"));
        let look = Look { text: 14.0, high_contrast: false, reduced_motion: true };
        let draw = |ui: &mut Ui, (settings, asked): &mut (MinimapSettings, Vec<MapFormat>)| {
            asked.extend(panel(ui, &look, &words, settings));
        };
        let mut harness =
            Harness::builder().with_size(Vec2::new(500.0, 500.0)).build_ui_state(draw, (MinimapSettings::default(), Vec::new()));
        harness.run();
        let names = ["Names", "Sights and houses", "Views", "Landmarks as pictures", "The way", "The tour", "Where you have been"];
        for name in names.into_iter().chain(["Colours told apart by everybody"]) {
            harness.get_by_role_and_label(Role::CheckBox, name).click();
            harness.run();
        }
        for name in ["Save the map as SVG", "Save the map as PNG"] {
            harness.get_by_role_and_label(Role::Button, name).click();
            harness.run();
        }
        let (settings, asked) = harness.state();
        let layers = veduta_cartography::Layers { trees: true, ..veduta_cartography::Layers::NONE };
        assert_eq!((settings.layers(), settings.colour_blind_safe), (layers, true));
        assert_eq!(asked[..], [MapFormat::Svg, MapFormat::Png]);
    }
}
