//! What lies over the picture: the bar, help, the first minute, hints, settings, and what has gone wrong.

mod atlas;
mod bar;
pub(crate) mod controls;
mod diary;
mod fingers;
mod first;
mod help;
mod keys;
mod notes;
mod offers;
mod pad;
mod settings;

use bevy::input::InputSystems;
use bevy::prelude::*;
use bevy_egui::egui::{Context, Vec2};
use bevy_egui::{EguiPreUpdateSet, EguiPrimaryContextPass};
use veduta::ecs::Words;
use veduta::ui::UiSystems;
use veduta::walker::WalkerSystems;

pub(crate) use diary::StillsFolder;
pub(crate) use offers::{TourFiles, asset_path};

/// What lies over the picture.
pub(crate) struct HudPlugin;

/// Which windows are open.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Open {
    pub help: bool,
    pub settings: bool,
}

/// Pages lie in the middle of what the bar leaves.
fn above_the_bar(context: &Context) -> Vec2 {
    Vec2::new(0.0, -context.content_rect().height() * 0.04)
}

/// What the interface says, by language.
pub(crate) const WORDS: [(&str, &str); 3] =
    [("en", include_str!("../words/en.ftl")), ("cs", include_str!("../words/cs.ftl")), ("it", include_str!("../words/it.ftl"))];

impl Plugin for HudPlugin {
    fn build(&self, app: &mut App) {
        veduta::ui::ensure(app);
        Words::bring(app, &WORDS);
        controls::add_controls(app);
        app.init_resource::<Open>()
            .init_resource::<keys::Part>()
            .init_resource::<bar::Bar>()
            .init_resource::<bar::Pressed>()
            .init_resource::<first::FirstMinute>()
            .init_resource::<notes::Notes>()
            .init_resource::<TourFiles>()
            .init_resource::<crate::settings::DroppedKeys>()
            .add_systems(PreUpdate, pad::steer.after(InputSystems).before(EguiPreUpdateSet::ProcessInput))
            .add_systems(
                Update,
                (
                    controls::read_keys,
                    notes::gather,
                    notes::watch,
                    first::watch,
                    offers::meet,
                    offers::offer,
                    offers::take,
                    controls::mute,
                ),
            )
            .init_resource::<atlas::Saving>()
            .add_message::<veduta::minimap::ExportMap>()
            .add_systems(Update, (diary::take_still, diary::tell, atlas::save_maps))
            .add_systems(Update, bar::press.after(WalkerSystems::Input).before(WalkerSystems::Move))
            .add_systems(
                EguiPrimaryContextPass,
                (fingers::draw, bar::draw, first::draw, notes::draw, help::draw, settings::draw).chain().in_set(UiSystems::Draw),
            );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The names of messages in a file.
    fn messages(file: &str) -> Vec<&str> {
        let is_name = |line: &&str| line.starts_with(|c: char| c.is_ascii_lowercase());
        file.lines().filter(is_name).filter_map(|line| line.split_once(" =").map(|(name, _)| name)).collect()
    }

    #[test]
    fn every_language_says_everything() {
        let mut words = Words::default();
        WORDS.iter().for_each(|(language, file)| words.add(language, file).unwrap_or_else(|mistake| panic!("{mistake}")));
        let all = messages(WORDS[0].1);
        assert!(all.len() > 80, "{}", all.len());
        for (language, file) in WORDS {
            assert_eq!(messages(file), all, "{language}: the same messages in the same order");
            assert!(all.iter().all(|message| words.has(language, message)), "{language}");
        }
    }
}
