use std::path::PathBuf;

use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, save_to_disk};
use veduta::controls::Presses;
use veduta::ecs::{Route, Words};
use veduta::guide::{PlaceEntered, WalkEnded};
use veduta::prelude::*;
use veduta::tour::TourState;
use veduta::walker::Jump;

use super::controls::TakeStill;
use super::first::FirstMinute;
use super::notes::Notes;
use crate::profile::Profile;
use crate::settings::Settings;

/// Where stills go that the visitor takes.
#[derive(Resource, Debug, Clone)]
pub(crate) struct StillsFolder(pub PathBuf);

impl StillsFolder {
    /// The user's folder for pictures, else one in the working directory.
    pub fn usual() -> Self {
        let var = |name| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
        let pictures = var("XDG_PICTURES_DIR").or_else(|| {
            let pictures = var("HOME").or_else(|| var("USERPROFILE"))?.join("Pictures");
            pictures.is_dir().then_some(pictures)
        });
        Self(pictures.map_or_else(|| PathBuf::from("out"), |pictures| pictures.join("veduta")))
    }

    /// The next name of a still that is not taken.
    fn next(&self) -> PathBuf {
        self.next_named("veduta", "png")
    }

    /// The next name with a beginning and an ending that is not taken.
    pub fn next_named(&self, begins: &str, ends: &str) -> PathBuf {
        let name = |n: u32| self.0.join(format!("{begins}_{n:04}.{ends}"));
        (1..).map(name).find(|path| !path.exists()).unwrap_or_else(|| name(0))
    }
}

/// Takes a still of all that is to be seen.
pub(super) fn take_still(
    presses: Presses<'_, '_>,
    time: Res<Time<Real>>,
    words: Res<Words>,
    folder: Res<StillsFolder>,
    mut notes: ResMut<Notes>,
    mut commands: Commands,
) {
    if !presses.begins::<TakeStill>() {
        return;
    }
    let path = folder.next();
    if let Err(error) = std::fs::create_dir_all(&folder.0) {
        notes.add(format!("{}: {error}", folder.0.display()), true, time.elapsed_secs_f64());
        return;
    }
    info!("visit: still {}", path.display());
    let told = path.display().to_string();
    commands.spawn(Screenshot::primary_window()).observe(save_to_disk(path));
    // Told after the picture is taken, so that it is not in it.
    notes.add_later(words.say_with("still-taken", &[("path", told.into())]), time.elapsed_secs_f64());
}

/// Writes the course of the visit into the log: for reports of what went wrong, and for tests that visit.
pub(super) fn tell(
    (words, profile, player, route, jump): (Res<Words>, Res<Profile>, Res<TourPlayer>, Res<Route>, Res<Jump>),
    (first, settings): (Res<FirstMinute>, Res<Settings>),
    mut entered: MessageReader<PlaceEntered>,
    mut walks: MessageReader<WalkEnded>,
    mut last: Local<Told>,
) {
    if last.language != words.language() {
        words.language().clone_into(&mut last.language);
        info!("visit: language {}", last.language);
    }
    if last.profile != Some(*profile) {
        last.profile = Some(*profile);
        info!("visit: quality {:?}", *profile);
    }
    if last.tour != player.state() {
        last.tour = player.state();
        info!("visit: tour {:?}", last.tour);
    }
    if last.led != route.name {
        route.name.clone_into(&mut last.led);
        if !last.led.is_empty() {
            info!("visit: led to {}", last.led);
        }
    }
    let step = if settings.knows_the_way { 0 } else { first.step() };
    if last.step != step {
        last.step = step;
        info!("visit: first minute {step}");
    }
    // A visit begins with a jump, but maybe not in the frame that the city is opened in. Who is led from the first step arrives when he is let go.
    if last.opening == Opening::Closed && *jump != Jump::None {
        last.opening = Opening::Jumping;
    } else if last.opening == Opening::Jumping && *jump == Jump::None {
        last.opening = Opening::Arrived;
        info!("visit: arrived");
    }
    for walk in walks.read() {
        info!("visit: {} {}", if walk.arrived { "arrived at" } else { "turned from the way to" }, walk.name);
    }
    for place in entered.read() {
        info!("visit: at {}", place.name);
    }
}

/// What was told last.
#[derive(Default)]
pub(super) struct Told {
    language: String,
    profile: Option<Profile>,
    tour: TourState,
    led: String,
    opening: Opening,
    step: usize,
}

/// How far a visitor is on the way into the city.
#[derive(Default, PartialEq)]
enum Opening {
    #[default]
    Closed,
    Jumping,
    Arrived,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_still_is_written_over() {
        let dir = std::env::temp_dir().join(format!("veduta-stills-{}", std::process::id()));
        std::fs::create_dir_all(&dir).expect("a folder of our own");
        let folder = StillsFolder(dir.clone());
        assert!(folder.next().ends_with("veduta_0001.png"));
        std::fs::write(folder.next(), "x").expect("room");
        assert!(folder.next().ends_with("veduta_0002.png"));
        let _ = std::fs::remove_dir_all(dir);
    }
}
