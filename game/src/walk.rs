//! `veduta walk`: the window.

use std::path::{Path, PathBuf};

use bevy::asset::io::AssetSourceBuilder;
use bevy::prelude::*;
use veduta::facade::{AutoLevels, FacadePlugin};
use veduta::prelude::*;
use veduta::streaming::{Journal, StreamingCache};

use crate::camera::camera;
use crate::profile::Profile;
use crate::{Failure, cities, expert, hud, profile};

/// Whether there is a display to open a window on.
#[must_use]
pub fn has_display() -> bool {
    if !cfg!(all(unix, not(target_os = "macos"))) {
        return true;
    }
    ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"].iter().any(|name| std::env::var_os(name).is_some_and(|v| !v.is_empty()))
}

/// Opens a window in a city, and stays until it is closed.
///
/// # Errors
/// If the journal's file cannot be made, or the program ends with a failure.
pub fn walk(
    city: &str,
    chosen: Option<Profile>,
    hold_fps: Option<u16>,
    first: Option<&FirstTour>,
    journal: Option<&Path>,
) -> Result<(), Failure> {
    let beside = first.and_then(|f| f.path.parent()).filter(|p| !p.as_os_str().is_empty());
    let tours = beside.unwrap_or(Path::new(".")).to_owned();
    let tours = std::path::absolute(&tours).unwrap_or(tours);
    let mut app = App::new();
    app.register_asset_source("tours", AssetSourceBuilder::platform_default(&tours.display().to_string(), None));
    app.add_plugins(
        DefaultPlugins
            .set(WindowPlugin {
                primary_window: Some(Window { title: "Veduta".into(), resolution: (1280, 720).into(), ..default() }),
                ..default()
            })
            .set(AssetPlugin {
                file_path: cities::project_root().join("assets").display().to_string(),
                watch_for_changes_override: Some(true),
                ..default()
            })
            .set(bevy::log::LogPlugin {
                filter: "info,wgpu=error,naga=warn,bevy_render=warn,bevy_asset::server=off".into(),
                ..default()
            }),
    );
    let start = chosen.unwrap_or(Profile::Low);
    start.apply(&mut app);
    app.add_plugins((
        veduta::ecs::EcsPlugin,
        StreamingPlugin::default(),
        BuildingsPlugin::default(),
        FacadePlugin { tiles: start.tiles(), ..default() },
        SkyPlugin,
        WalkerPlugin::default(),
        TourPlugin::default(),
        MinimapPlugin,
        GuidePlugin::default(),
        hud::HudPlugin,
        expert::ExpertPlugin,
    ))
    .insert_resource(ClearColor(Color::BLACK))
    .insert_resource(OpenCity(city.to_owned()))
    .insert_resource(StreamingCache { dir: Some(cities::streamed_dir()), ..default() })
    .add_systems(Startup, spawn_walker);
    if let Some(frames) = hold_fps {
        app.insert_resource(AutoLevels { frame_s: 1.0 / f64::from(frames), ..default() });
    }
    if let Some(path) = journal {
        let told = app.world_mut().resource_mut::<Journal>().write_to(path);
        told.map_err(|error| format!("{}: {error}", path.display()))?;
    }
    if let Some(first) = first {
        app.insert_resource(first.clone()).add_systems(Update, offer_tour);
    }
    if chosen.is_none() {
        app.add_systems(Startup, profile::adapt.before(spawn_walker));
    }
    match app.run() {
        AppExit::Success => Ok(()),
        AppExit::Error(code) => Err(format!("ended with code {code}").into()),
    }
}

fn spawn_walker(mut commands: Commands) {
    commands.spawn((camera(), Walker, Eye { fade: 1.0, ..default() }));
}

/// The tour that T begins with.
#[derive(Resource, Debug, Clone)]
pub struct FirstTour {
    /// Its file.
    pub path: PathBuf,
    /// Whether it begins by itself.
    pub at_once: bool,
}

/// Opens the first tour once the city is open: at once if it was asked for, else when T is pressed.
fn offer_tour(
    mut opened: MessageReader<CityOpened>,
    keys: Res<ButtonInput<KeyCode>>,
    first: Res<FirstTour>,
    player: Res<TourPlayer>,
    mut tour: MessageWriter<TourCommand>,
) {
    let begins = opened.read().last().is_some() && first.at_once;
    let idle = player.state() == veduta::tour::TourState::Idle;
    if begins || (idle && keys.just_pressed(KeyCode::KeyT)) {
        let name = first.path.file_name().unwrap_or_default().to_string_lossy();
        tour.write(TourCommand::Open(format!("tours://{name}")));
    }
}
