//! `veduta walk`: the window.

use std::path::PathBuf;

use bevy::prelude::*;
use veduta::facade::FacadePlugin;
use veduta::guide::OpenGuide;
use veduta::life::{LifePlugin, OpenLife};
use veduta::prelude::*;
use veduta::sky::Backdrop;
use veduta::sound::{OpenSounds, SoundPlugin};
use veduta::streaming::{CityAssetsPlugin, Journal, StreamingCache};

use crate::camera::camera;
use crate::profile::Profile;
use crate::settings::{Orders, Settings, SettingsPlugin};
use crate::studio::Size;
use crate::{Failure, cities, expert, hud, profile, tours};

/// Whether there is a display to open a window on.
#[must_use]
pub fn has_display() -> bool {
    if !cfg!(all(unix, not(target_os = "macos"))) {
        return true;
    }
    ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"].iter().any(|name| std::env::var_os(name).is_some_and(|v| !v.is_empty()))
}

/// A walk that was asked for.
#[derive(Debug, Clone, Default)]
pub struct WalkOrder {
    /// What streaming opens.
    pub city: String,
    /// Quality, if it was told.
    pub profile: Option<Profile>,
    /// Frames a second that levels of detail make room for.
    pub hold_fps: Option<u16>,
    /// Code of the language, if it was told.
    pub language: Option<String>,
    /// The tour that T begins with.
    pub first: Option<FirstTour>,
    /// Folder of tours, the guide and what lives.
    pub scene: PathBuf,
    /// What new tours name as their city.
    pub tour_city: String,
    /// Size of the window; 1280 × 720 if it was not told.
    pub size: Option<Size>,
    /// Where stills go, if it was told.
    pub stills: Option<PathBuf>,
    /// File of the journal.
    pub journal: Option<PathBuf>,
}

/// Opens a window in a city, and stays until it is closed.
///
/// # Errors
/// If the journal's file cannot be made, or the program ends with a failure.
pub fn walk(order: &WalkOrder) -> Result<(), Failure> {
    let scene = std::path::absolute(&order.scene).unwrap_or_else(|_| order.scene.clone());
    let size = order.size.map_or((1280, 720), |size| (size.width, size.height));
    let mut app = App::new();
    tours::add_source(&mut app, &scene);
    app.add_plugins(CityAssetsPlugin).add_plugins(
        DefaultPlugins
            .set(WindowPlugin {
                primary_window: Some(Window { title: "Veduta".into(), resolution: size.into(), ..default() }),
                // What is not saved is asked about first.
                close_when_requested: false,
                ..default()
            })
            .set(AssetPlugin {
                file_path: cities::project_root().join("assets").display().to_string(),
                watch_for_changes_override: Some(true),
                ..default()
            })
            .set(bevy::log::LogPlugin {
                filter: "info,wgpu=error,naga=warn,bevy_render=warn,bevy_asset::server=off,egui_extras=error".into(),
                ..default()
            }),
    );
    let orders = Orders { language: order.language.clone(), profile: order.profile, hold_fps: order.hold_fps };
    let (settings, file) = Settings::read(orders);
    let start = settings.profile.unwrap_or(Profile::Low);
    start.apply(&mut app);
    app.insert_resource(settings).insert_resource(file);
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
        LifePlugin,
        SoundPlugin,
        SettingsPlugin,
        hud::HudPlugin,
        expert::ExpertPlugin,
        tours::ToursPlugin { folder: scene.clone(), city: order.tour_city.clone() },
    ))
    // The sun goes on, and so do the city's clocks and bells.
    .insert_resource(CityClock { pace: 1.0, ..default() })
    .insert_resource(ClearColor(Color::BLACK))
    .insert_resource(OpenCity(order.city.clone()))
    .insert_resource(StreamingCache { dir: Some(cities::streamed_dir()), ..default() })
    .insert_resource(order.stills.clone().map_or_else(hud::StillsFolder::usual, hud::StillsFolder))
    .insert_resource(hud::TourFiles::in_folder(&scene))
    .add_systems(PreStartup, profile::adapt)
    .add_systems(Startup, spawn_walker);
    if let Some(path) = &order.journal {
        let told = app.world_mut().resource_mut::<Journal>().write_to(path);
        told.map_err(|error| format!("{}: {error}", path.display()))?;
    }
    if let Some(first) = &order.first {
        app.insert_resource(first.clone());
    }
    app.add_systems(Update, offer_tour.run_if(resource_exists::<FirstTour>));
    if let Some(guide) = cities::file_in(&scene, ".guide.ron") {
        app.world_mut().write_message(OpenGuide(format!("tours://{guide}")));
    }
    if let Some(life) = cities::file_in(&scene, ".life.ron") {
        app.world_mut().write_message(OpenLife(format!("tours://{life}")));
    }
    if let Some(sounds) = cities::file_in(&scene, ".sound.ron") {
        app.world_mut().write_message(OpenSounds(format!("tours://{sounds}")));
    }
    if let Some(picture) = cities::file_in(&scene, ".backdrop.png") {
        let picture = app.world().resource::<AssetServer>().load(format!("tours://{picture}"));
        app.insert_resource(Backdrop::Picture(picture));
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

/// Opens the first tour once the city is open: at once if it was asked for, else when a tour is asked for and there is none.
fn offer_tour(
    mut opened: MessageReader<CityOpened>,
    mut asked: MessageReader<TourCommand>,
    first: Res<FirstTour>,
    player: Res<TourPlayer>,
    mut has_begun: Local<bool>,
    mut commands: Commands,
) {
    let begins = opened.read().count() > 0 && first.at_once && !core::mem::replace(&mut *has_begun, true);
    let idle = player.state() == veduta::tour::TourState::Idle;
    let toggled = asked.read().any(|command| *command == TourCommand::Toggle);
    if begins || (idle && toggled) {
        commands.write_message(TourCommand::Open(hud::asset_path(&first.path)));
    }
}
