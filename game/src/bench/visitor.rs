//! `veduta bench visitor`: what a visitor's interface costs the main thread, and how long search and ways take.

use std::path::Path;

use bevy::camera::CameraPlugin;
use bevy::input::InputPlugin;
use bevy::prelude::*;
use bevy::window::{PrimaryWindow, WindowPlugin};
use cpu_time::ThreadTime;
use veduta::city::{Guide, Id, Overview, Tour, draw::Draw, file};
use veduta::guide::{CityGuide, Directory, Offers};
use veduta::minimap::MapView;
use veduta::prelude::*;
use veduta::sound::SoundSettings;
use veduta::streaming::Link;
use veduta::walker::{Intent, Jump};
use veduta_route::StreetNet;
use veduta_store::{DirReader, read_index, read_overview};

use super::{Walk, Way, line, median, stream, workplace};
use crate::hud::{HudPlugin, StillsFolder};
use crate::profile::{Fitting, Profile};
use crate::settings::{Orders, Settings, SettingsPlugin};
use crate::{Failure, cities, expert};

/// Walks are repeated so often, in turn with walks without the interface.
const REPEAT: usize = 3;
/// So many names are searched, and so many ways sought.
const NAMES: usize = 100_000;
const QUESTIONS: usize = 300;
/// From a town's middle to its edge, metres.
const WHOLE_M: f32 = 2_000.0;

/// Measures and prints.
///
/// # Errors
/// If a city cannot be baked or walked.
pub(super) fn visitor(scene: &Path) -> Result<(), Failure> {
    let dir = workplace("visitor")?;
    let tour: Tour = file::read(&cities::sample_scene().join("royal_route.tour.ron"))?;
    let sample = dir.join("sample.city");
    veduta_bake::bake(scene, &sample, &veduta_bake::BakeSettings::default(), &mut |_| ())?;
    let (town, run, houses) = stream::fast_run(&dir, &tour)?;
    let mut costs = Vec::new();
    for (name, city, tour) in [("sample", &sample, &tour), ("town", &town, &run)] {
        let mut extra = Vec::new();
        for _ in 0..REPEAT {
            let mut bare = Walk::run(city, tour, Way::Streamed)?;
            let mut visited = Walk::run(city, tour, Way::Visited)?;
            extra.push(median(&mut visited.frames) - median(&mut bare.frames));
        }
        let cost = median(&mut extra) / 1e3;
        line(&format!("{name}_interface_ms"), cost, "ms");
        costs.push(cost);
    }
    line("sample_life_ms", extra_ms(&sample, &tour, Way::Lived)?, "ms");
    line("town_whole_map_ms", extra_ms(&town, &run, Way::Mapped)?, "ms");
    line("town_houses", houses as f64, "1");
    line("interface_ratio", costs[1] / costs[0], "1");
    search();
    ways(&town)?;
    std::fs::remove_dir_all(&dir)?;
    Ok(())
}

/// What a way costs the main thread in a frame of a tour beyond streaming, milliseconds.
fn extra_ms(city: &Path, tour: &Tour, way: Way) -> Result<f64, Failure> {
    let mut extra = Vec::new();
    for _ in 0..REPEAT {
        let mut bare = Walk::run(city, tour, Way::Streamed)?;
        let mut more = Walk::run(city, tour, way)?;
        extra.push(median(&mut more.frames) - median(&mut bare.frames));
    }
    Ok(median(&mut extra) / 1e3)
}

/// All that lives in the sample city, as on a graphics card.
pub(super) fn add_life(app: &mut App) {
    let life = cities::life_in(&cities::sample_scene()).unwrap_or_default();
    app.add_plugins(veduta::life::LifePlugin)
        .insert_resource(veduta::life::CityLife::of(life))
        .insert_resource(Profile::High.life());
}

/// Everything that is drawn over the picture, and the keys.
pub(super) fn add_interface(app: &mut App) {
    let (settings, file) = Settings::read_from(None, Orders::default());
    app.add_plugins((
        WindowPlugin { exit_condition: bevy::window::ExitCondition::DontExit, ..default() },
        InputPlugin,
        CameraPlugin,
    ))
    .init_asset::<Image>()
    .init_asset::<bevy::shader::Shader>()
    .init_asset::<bevy::mesh::skinning::SkinnedMeshInverseBindposes>()
    // What walking, sound and life cost is not the interface's.
    .init_resource::<SoundSettings>()
    .init_resource::<LifeSettings>()
    .init_resource::<Intent>()
    .init_resource::<Jump>()
    .init_resource::<WalkerSettings>()
    .init_resource::<Link>()
    .insert_resource(Profile::Medium)
    .insert_resource(Fitting(Profile::Medium))
    .insert_resource(Settings { knows_the_way: true, bar_stays: true, ..settings })
    .insert_resource(file)
    .insert_resource(StillsFolder::usual())
    .add_plugins((
        TourPlugin::default(),
        MinimapPlugin,
        GuidePlugin::default(),
        SettingsPlugin,
        HudPlugin,
        expert::ExpertPlugin,
    ));
    let guide: Result<Guide, _> = file::read(&cities::sample_scene().join("old_prague.guide.ron"));
    app.insert_resource(guide.map_or_else(|_| CityGuide::default(), CityGuide::of));
}

/// A window that nothing is drawn into, and its camera.
pub(super) fn open_window(app: &mut App, viewer: Entity) {
    let mut windows = app.world_mut().query_filtered::<&mut Window, With<PrimaryWindow>>();
    if let Ok(mut window) = windows.single_mut(app.world_mut()) {
        window.resolution = (1280, 720).into();
    }
    app.world_mut().entity_mut(viewer).insert(Camera3d::default());
}

/// The large map, zoomed out until a town is seen whole.
pub(super) fn open_map(app: &mut App) {
    app.insert_resource(MapView { open: true, radius_m: WHOLE_M, ..default() });
}

/// A word of some syllables.
fn word(draw: &Draw, n: usize) -> String {
    const SYLLABLES: [&str; 20] = [
        "ka", "ro", "vi", "te", "mo", "lu", "na", "pe", "sta", "dra", "hor", "bil", "cer", "zel", "kra", "pod", "nad", "ry", "ta",
        "nov",
    ];
    let count = 2 + (draw.unit(&format!("length {n}")) * 3.0) as usize;
    (0..count).map(|k| SYLLABLES[(draw.unit(&format!("{n} {k}")) * 20.0) as usize % 20]).collect()
}

/// Finds slips, beginnings and whole names among many.
fn search() {
    let name = |n: usize| {
        let draw = Draw::new(7, Id(n as u64), "name");
        let words = 1 + (draw.unit("words") * 3.0) as usize;
        (0..words).map(|k| word(&draw, k)).collect::<Vec<_>>().join(" ")
    };
    let names: Vec<String> = (0..NAMES).map(name).collect();
    let places =
        names.iter().enumerate().map(|(n, name)| veduta::city::Place { id: Id(n as u64), name: name.clone(), ..default() });
    let overview = Overview { places: places.collect(), ..default() };
    let directory = Directory::of([&overview], &Guide::default(), &Offers::default());
    let mut times: Vec<f64> = (0..QUESTIONS)
        .map(|k| {
            let name = &names[k * (NAMES / QUESTIONS)];
            let letters: Vec<char> = name.chars().collect();
            let mut typed = match k % 4 {
                0 => letters,
                1 => letters[..letters.len().min(3)].to_vec(),
                2 => letters[..letters.len() - 2].to_vec(),
                _ => letters,
            };
            if k % 4 == 3 {
                let middle = typed.len() / 2;
                typed.swap(middle, middle - 1);
            }
            let typed: String = typed.into_iter().collect();
            let began = ThreadTime::now();
            std::hint::black_box(directory.find(&typed, default(), 8));
            began.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    line("search_names", directory.len() as f64, "1");
    line("search_median_ms", median(&mut times), "ms");
    line("search_worst_ms", times.last().copied().unwrap_or(0.0), "ms");
}

/// Ways between far places of a town.
fn ways(town: &Path) -> Result<(), Failure> {
    let reader = DirReader::new(town)?;
    let overview = read_overview(&reader, &read_index(&reader)?)?;
    let began = ThreadTime::now();
    let net = StreetNet::new(&overview.streets);
    line("street_net_ms", began.elapsed().as_secs_f64() * 1e3, "ms");
    let streets: Vec<_> = overview.streets.iter().filter(|street| street.walkable).collect();
    let at = |n: usize| streets[n % streets.len()].line[0].to_metres();
    let mut found = 0;
    let mut times: Vec<f64> = (0..QUESTIONS)
        .map(|k| {
            let (from, to) = (at(k * 7_919), at(k * 104_729 + streets.len() / 2));
            let began = ThreadTime::now();
            found += usize::from(net.way(from, to).is_ok());
            began.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    line("ways_found_share", found as f64 / QUESTIONS as f64, "1");
    line("way_median_ms", median(&mut times), "ms");
    line("way_worst_ms", times.last().copied().unwrap_or(0.0), "ms");
    Ok(())
}
