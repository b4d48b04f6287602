//! Tours in a folder: read as `tours://`, with what lies beside them; kept when they are edited, whole or not at all, and nothing of
//! anybody else's is written over unasked.

use std::path::{Path, PathBuf};

use bevy::asset::io::AssetSourceBuilder;
use bevy::prelude::*;
use bevy::tasks::{IoTaskPool, Task, futures::check_ready};
use bevy::window::WindowCloseRequested;
use veduta::city::{file, is_beside};
use veduta::tour::{EditorCommand, EditorLeft, EditorSettings, SaveHow, SaveTour, TourSaved};
use veduta_route::plain_name;

use crate::hud::TourFiles;

/// Keeps tours in a folder, and asks about what is not saved before the program ends.
pub(crate) struct ToursPlugin {
    /// Where tours lie.
    pub folder: PathBuf,
    /// What new tours name as their city.
    pub city: String,
}

/// Lets the asset server read what lies in a folder: `tours://` and the file's path. Must come before Bevy's `AssetPlugin`, and so before
/// `DefaultPlugins`; that refuses paths which lead out of the folder.
pub fn add_source(app: &mut App, folder: &Path) {
    let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
    app.register_asset_source("tours", AssetSourceBuilder::platform_default(&folder.display().to_string(), None));
}

/// Where tours lie.
#[derive(Resource, Debug, Clone)]
struct ToursFolder(PathBuf);

/// What is being written.
#[derive(Resource, Default)]
struct Saving(Vec<Task<(String, TourSaved)>>);

impl Plugin for ToursPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(ToursFolder(self.folder.clone()))
            .insert_resource(EditorSettings { city: self.city.clone(), can_save: true, can_copy: false })
            .init_resource::<Saving>()
            .add_systems(Update, (save, tell, ask_to_leave, leave));
    }
}

/// Files of tours end so.
const ENDING: &str = ".tour.ron";

/// By which path the asset server opens a tour.
fn asset_path(file_name: &str) -> String {
    format!("tours://{file_name}")
}

fn save(mut orders: MessageReader<SaveTour>, folder: Res<ToursFolder>, mut saving: ResMut<Saving>) {
    for order in orders.read() {
        let (order, folder) = (order.clone(), folder.0.clone());
        saving.0.push(IoTaskPool::get().spawn(async move { (order.title.clone(), keep(&folder, &order)) }));
    }
}

/// Tells how it went, and puts new tours on the list.
fn tell(mut saving: ResMut<Saving>, folder: Res<ToursFolder>, mut tours: ResMut<TourFiles>, mut saved: MessageWriter<TourSaved>) {
    if saving.0.is_empty() {
        return;
    }
    saving.0.retain_mut(|task| {
        let Some((title, answer)) = check_ready(task) else { return true };
        if let TourSaved::Done { path, .. } = &answer {
            let path = folder.0.join(path.trim_start_matches("tours://"));
            info!("visit: saved {}", path.display());
            tours.0.retain(|(other, _)| *other != path);
            tours.0.push((path, title));
            tours.0.sort();
        }
        saved.write(answer);
        false
    });
}

/// Writes a tour as ordered, or says why not.
fn keep(folder: &Path, order: &SaveTour) -> TourSaved {
    let named = |n: u32| {
        let plain = plain_name(&order.title);
        let stem = if plain.is_empty() { "tour" } else { &plain };
        if n < 2 { format!("{stem}{ENDING}") } else { format!("{stem}_{n}{ENDING}") }
    };
    let file_name = match (&order.path, &order.how) {
        (Some(path), _) => path.rsplit('/').next().unwrap_or_default().to_owned(),
        (None, SaveHow::Beside) => (1..).map(named).find(|name| !folder.join(name).exists()).unwrap_or_else(|| named(1)),
        (None, _) => named(1),
    };
    let failed = |message: String| TourSaved::Failed { message };
    // Of slashes other systems have more, and other files of the folder are no tours.
    if !is_beside(&file_name) || !file_name.ends_with(ENDING) {
        return failed(format!("`{file_name}`: a tour is kept under a plain name that ends in `{ENDING}`"));
    }
    let path = folder.join(&file_name);
    match &order.how {
        SaveHow::Over(expected) => match std::fs::read(&path) {
            Ok(bytes) if bytes != expected.as_bytes() => {
                return TourSaved::Changed { text: String::from_utf8_lossy(&bytes).into_owned() };
            }
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => return failed(format!("{}: {error}", path.display())),
            _ => {}
        },
        SaveHow::New if path.exists() => return TourSaved::Taken { path: asset_path(&file_name) },
        SaveHow::New | SaveHow::Beside | SaveHow::Replace => {}
    }
    match file::write_text(&order.text, &path) {
        Ok(()) => TourSaved::Done { path: asset_path(&file_name), text: order.text.clone() },
        Err(error) => failed(error.to_string()),
    }
}

/// The window's cross asks first.
fn ask_to_leave(mut closed: MessageReader<WindowCloseRequested>, mut commands: MessageWriter<EditorCommand>) {
    if closed.read().count() > 0 {
        commands.write(EditorCommand::Leave);
    }
}

fn leave(mut left: MessageReader<EditorLeft>, mut exits: MessageWriter<AppExit>) {
    if left.read().count() > 0 {
        exits.write(AppExit::Success);
    }
}

#[cfg(test)]
#[path = "../../plugins/store/tests/escapes/mod.rs"]
mod escapes;

#[cfg(test)]
mod tests {
    use super::*;

    /// Every file below a folder.
    fn files(folder: &Path) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(folder).expect("it is there").flatten().map(|entry| entry.path());
        entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
    }

    #[test]
    fn whatever_a_tour_is_called_it_is_kept_in_its_folder() {
        let dir = std::env::temp_dir().join(format!("veduta-tours-paths-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&dir);
        let folder = dir.join("above/town");
        // Folders to which paths of the corpus lead.
        for other in ["etc", "blobs/ab", "above/etc", "above/blobs/ab", "above/town/etc", "above/town/blobs/ab"] {
            std::fs::create_dir_all(dir.join(other)).expect("room");
        }
        let others = ["secret.txt.tour.ron", "above/secret.txt.tour.ron", "above/town/old.life.ron"].map(|path| dir.join(path));
        others.iter().for_each(|path| std::fs::write(path, "a secret").expect("room"));
        let order = |path: Option<String>, title: &str, how| SaveTour { path, title: title.into(), text: "a tour".into(), how };
        let mut kept = 0;
        for path in escapes::corpus() {
            let orders = [
                order(None, &path, SaveHow::New),
                order(Some(format!("tours://{path}")), "", SaveHow::New),
                order(Some(format!("tours://{path}{ENDING}")), "", SaveHow::New),
                order(Some(format!("{path}{ENDING}")), "", SaveHow::Over("what it was".into())),
            ];
            for order in orders {
                match keep(&folder, &order) {
                    TourSaved::Done { path, .. } | TourSaved::Taken { path } => {
                        let name = path.strip_prefix("tours://").expect("it tells where");
                        assert!(is_beside(name) && !name.contains('/') && folder.join(name).is_file(), "{order:?}: {path}");
                        kept += 1;
                    }
                    TourSaved::Changed { text } => assert_eq!(text, "a tour", "{order:?}"),
                    TourSaved::Failed { .. } => {}
                }
            }
        }
        let over = keep(&folder, &order(Some("tours://old.life.ron".into()), "", SaveHow::Replace));
        assert!(matches!(over, TourSaved::Failed { .. }), "what is no tour is not written over");
        assert!(kept > 10_000, "{kept} were kept");
        for file in files(&dir) {
            let is_tour = file.parent() == Some(&folder) && file.to_string_lossy().ends_with(ENDING);
            assert!(is_tour || others.contains(&file), "{}", file.display());
        }
        assert!(others.iter().all(|path| std::fs::read(path).is_ok_and(|content| content == b"a secret")));
        let _ = std::fs::remove_dir_all(dir);
    }

    #[test]
    fn nothing_is_written_over_unasked() {
        let folder = std::env::temp_dir().join(format!("veduta-tours-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder of our own");
        let order = |path: Option<&str>, text: &str, how| SaveTour {
            path: path.map(str::to_owned),
            title: "Královská cesta!".into(),
            text: text.into(),
            how,
        };
        let done = |name: &str, text: &str| TourSaved::Done { path: format!("tours://{name}"), text: text.into() };
        let name = "kralovska_cesta.tour.ron";
        let read = |name: &str| std::fs::read_to_string(folder.join(name)).expect("it was written");
        assert_eq!(keep(&folder, &order(None, "a", SaveHow::New)), done(name, "a"));
        assert_eq!(keep(&folder, &order(None, "b", SaveHow::New)), TourSaved::Taken { path: format!("tours://{name}") });
        assert_eq!(read(name), "a");
        assert_eq!(keep(&folder, &order(None, "b", SaveHow::Beside)), done("kralovska_cesta_2.tour.ron", "b"));
        let path = format!("tours://{name}");
        assert_eq!(keep(&folder, &order(Some(&path), "c", SaveHow::Over("a".into()))), done(name, "c"));
        let changed = keep(&folder, &order(Some(&path), "d", SaveHow::Over("a".into())));
        assert_eq!((changed, read(name)), (TourSaved::Changed { text: "c".into() }, "c".into()));
        assert_eq!(keep(&folder, &order(None, "e", SaveHow::Replace)), done(name, "e"));
        let outside = keep(&folder, &order(Some("tours://../../other.tour.ron"), "f", SaveHow::Replace));
        assert_eq!(outside, done("other.tour.ron", "f"), "tours stay in their folder");
        assert!(!folder.join("..").join("..").join("other.tour.ron").exists());
        let nowhere = folder.join("nowhere");
        assert!(matches!(keep(&nowhere, &order(None, "g", SaveHow::New)), TourSaved::Failed { .. }));
        let is_tour = |entry: std::fs::DirEntry| entry.file_name().to_string_lossy().ends_with(ENDING);
        assert!(std::fs::read_dir(&folder).expect("it is there").flatten().all(is_tour), "nothing is left half written");
        let _ = std::fs::remove_dir_all(folder);
    }
}
