//! What lies over the picture: the bar, help, the first minute, hints, settings, and what has gone wrong.

mod atlas;
mod bar;
mod diary;
mod first;
mod help;
mod notes;
mod offers;
mod settings;

use bevy::prelude::*;
use bevy_egui::EguiPrimaryContextPass;
use veduta::ecs::{Words, keys_are_free};
use veduta::prelude::*;
use veduta::ui::UiSystems;
use veduta::walker::WalkerSystems;

pub(crate) use diary::StillsFolder;
pub(crate) use offers::TourFiles;

/// What lies over the picture.
pub(crate) struct HudPlugin;

/// Which windows are open.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Open {
    pub help: bool,
    pub settings: bool,
}

/// What the interface says, by language.
const WORDS: [(&str, &str); 3] =
    [("en", include_str!("../words/en.ftl")), ("cs", include_str!("../words/cs.ftl")), ("it", include_str!("../words/it.ftl"))];

impl Plugin for HudPlugin {
    fn build(&self, app: &mut App) {
        veduta::ui::ensure(app);
        Words::bring(app, &WORDS);
        app.init_resource::<Open>()
            .init_resource::<bar::Bar>()
            .init_resource::<bar::Pressed>()
            .init_resource::<first::FirstMinute>()
            .init_resource::<notes::Notes>()
            .init_resource::<TourFiles>()
            .add_systems(
                Update,
                (read_keys.run_if(keys_are_free), notes::gather, notes::watch, first::watch, offers::offer, offers::take),
            )
            .init_resource::<atlas::Saving>()
            .add_message::<veduta::minimap::ExportMap>()
            .add_systems(Update, (diary::take_still, diary::tell, atlas::save_maps))
            .add_systems(Update, bar::press.after(WalkerSystems::Input).before(WalkerSystems::Move))
            .add_systems(
                EguiPrimaryContextPass,
                (bar::draw, first::draw, notes::draw, help::draw, settings::draw).chain().in_set(UiSystems::Draw),
            );
    }
}

/// A quarter of a year, days.
const DAYS_A_SEASON: u16 = 92;

/// F1, F3, Escape, Ctrl+Q, and the hour and season of the city.
fn read_keys(
    time: Res<Time>,
    keys: Res<ButtonInput<KeyCode>>,
    mut open: ResMut<Open>,
    mut clock: ResMut<CityClock>,
    mut exits: MessageWriter<AppExit>,
) {
    let command = [KeyCode::ControlLeft, KeyCode::ControlRight, KeyCode::SuperLeft, KeyCode::SuperRight];
    if keys.any_pressed(command) && keys.just_pressed(KeyCode::KeyQ) {
        exits.write(AppExit::Success);
    }
    if keys.just_pressed(KeyCode::F1) {
        open.help = !open.help;
    }
    if keys.just_pressed(KeyCode::F3) {
        open.settings = !open.settings;
    }
    if keys.just_pressed(KeyCode::Escape) && (open.help || open.settings) {
        *open = Open::default();
    }
    let turn = f64::from(keys.pressed(KeyCode::KeyJ)) - f64::from(keys.pressed(KeyCode::KeyH));
    if turn != 0.0 {
        clock.hour = (clock.hour + turn * time.delta_secs_f64() * 1.5).rem_euclid(24.0);
    }
    if keys.just_pressed(KeyCode::KeyK) {
        clock.day = (clock.day + DAYS_A_SEASON - 1) % 366 + 1;
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
