//! Paths by which someone might try to get out of a folder, through the asset server: nothing is read but what lies within.

use std::path::{Path, PathBuf};

use bevy::asset::io::Reader;
use bevy::asset::{AssetLoader, AssetPath, AssetPlugin, LoadContext, LoadState, UnapprovedPathMode};
use bevy::prelude::*;
use veduta::ecs::{City, OpenCity};
use veduta::streaming::{CityAssetsPlugin, Fetching, StreamingPlugin};
use veduta_game::tours;
use veduta_store::CityWriter;
use veduta_tests::{update_until, workplace};

#[path = "../../plugins/store/tests/escapes/mod.rs"]
mod escapes;
#[path = "../../plugins/store/tests/sample/mod.rs"]
mod sample;

/// A file's bytes.
#[derive(Asset, TypePath)]
struct Bytes(Vec<u8>);

/// Takes files of any ending.
#[derive(Default, TypePath)]
struct BytesLoader;

impl AssetLoader for BytesLoader {
    type Asset = Bytes;
    type Settings = ();
    type Error = std::io::Error;

    async fn load(&self, reader: &mut dyn Reader, _: &(), _: &mut LoadContext<'_>) -> Result<Bytes, std::io::Error> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        Ok(Bytes(bytes))
    }
}

const SECRET: &[u8] = b"a secret";
const OWN: &[u8] = b"no secret";
/// What lies within, and has the names of what does not.
const WITHIN: [&str; 2] = ["notes/secret.txt", "blobs/ab/secret.txt"];

fn write(path: &Path, content: &[u8]) {
    std::fs::create_dir_all(path.parent().expect("it lies in a folder")).expect("room");
    std::fs::write(path, content).expect("room");
}

/// The path of a folder, with a secret wherever the corpus leads from it.
fn folder_among_secrets(name: &str) -> PathBuf {
    let top = workplace(name);
    for above in ["", "a", "a/b"] {
        for target in ["etc/passwd", "city.veduta", "secret.txt", "windows/win.ini", "proc/self/environ"] {
            write(&top.join(above).join(target), SECRET);
        }
    }
    top.join("a/b/folder")
}

/// What came of the corpus.
struct Answered {
    /// With what was read.
    loaded: Vec<(String, Vec<u8>)>,
    failed: usize,
    /// Not even asked for.
    refused: usize,
}

/// Loads every path of the corpus from a source.
fn load_all(app: &mut App, source: &str) -> Answered {
    let server = app.world().resource::<AssetServer>().clone();
    let handle = |path: &String| server.load::<Bytes>(AssetPath::try_parse(&format!("{source}://{path}")).expect("a path"));
    let mut waiting: Vec<(Handle<Bytes>, String)> = escapes::corpus().into_iter().map(|path| (handle(&path), path)).collect();
    let asked = waiting.len();
    assert!(asked > 10_000, "{asked} paths");
    // Whoever is refused gets the handle that stands for nothing.
    waiting.retain(|(handle, _)| handle.is_strong());
    let refused = asked - waiting.len();
    let (mut loaded, mut failed) = (Vec::new(), 0);
    update_until(app, 20_000, "every path is answered", |world| {
        waiting.retain(|(handle, path)| match server.load_state(handle) {
            LoadState::Failed(_) => {
                failed += 1;
                false
            }
            LoadState::Loaded => {
                let bytes = world.resource::<Assets<Bytes>>().get(handle).expect("it is loaded");
                loaded.push((path.clone(), bytes.0.clone()));
                false
            }
            LoadState::Loading | LoadState::NotLoaded => true,
        });
        waiting.is_empty()
    });
    Answered { loaded, failed, refused }
}

/// That nothing but what lies within was read.
fn holds(answered: &Answered, folder: &Path) {
    for (path, bytes) in &answered.loaded {
        assert_eq!(bytes, OWN, "{path:?}: {:?}", String::from_utf8_lossy(bytes));
    }
    let Answered { loaded, failed, refused } = answered;
    let leads_out = |path: &&String| std::fs::read(folder.join(path)).is_ok_and(|bytes| bytes == SECRET);
    let out = escapes::corpus().iter().filter(leads_out).count();
    println!("{} read, {failed} not found, {refused} refused; {out} of them lead to a secret", loaded.len());
    assert!(out > 100, "{out} paths lead to a secret");
    for within in WITHIN {
        assert!(loaded.iter().any(|(path, _)| Path::new(path) == Path::new(within)), "{within} is to be had");
    }
}

#[test]
fn beside_tours_nothing_is_read_that_lies_elsewhere() {
    let folder = folder_among_secrets("escapes-tours");
    WITHIN.iter().for_each(|path| write(&folder.join(path), OWN));
    let mut app = App::new();
    tours::add_source(&mut app, &folder);
    app.add_plugins((MinimalPlugins, AssetPlugin::default())).init_asset::<Bytes>().init_asset_loader::<BytesLoader>();
    let answered = load_all(&mut app, "tours");
    holds(&answered, &folder);
    assert!(answered.refused > 0);
}

#[test]
fn of_a_city_nothing_is_read_that_does_not_travel_with_it() {
    let folder = folder_among_secrets("escapes-city");
    let city = sample::city(2, 1);
    let mut writer = CityWriter::new(&folder, &city.plan).expect("room");
    writer.cells(&city.plan, &city.cells, &|cell| city.parts(cell)).expect("a city");
    WITHIN.iter().for_each(|path| writer.file(path, OWN).expect("a plain path"));
    writer.finish(city.cells.clone()).expect("a city");
    // In its folder, but not of it.
    WITHIN.iter().for_each(|path| write(&folder.join(path), SECRET));
    let mut app = App::new();
    // The source holds by itself, though the server lets all through.
    let assets = AssetPlugin { unapproved_path_mode: UnapprovedPathMode::Allow, ..default() };
    app.add_plugins(CityAssetsPlugin)
        .add_plugins((MinimalPlugins, assets, StreamingPlugin { fetching: Fetching::Threads(1) }))
        .init_asset::<Bytes>()
        .init_asset_loader::<BytesLoader>()
        .insert_resource(OpenCity(folder.display().to_string()));
    update_until(&mut app, 5_000, "the city is open", |world| world.contains_resource::<City>());
    let answered = load_all(&mut app, "city");
    holds(&answered, &folder);
    assert_eq!(answered.refused, 0, "all of them came as far as the source");
}
