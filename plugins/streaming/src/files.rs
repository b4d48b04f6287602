//! Files that travel with the open city, for the asset server: `city://old_prague.guide.ron`.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use async_channel::{Receiver, Sender, bounded};
use bevy::asset::io::{AssetReader, AssetReaderError, AssetSourceBuilder, PathStream, Reader, VecReader};
use bevy::prelude::*;
use veduta_ecs::CITY_SOURCE;
use veduta_store::StoreError;

use crate::fetch::Store;

/// Lets the asset server load what travels with the open city, wherever that lies: `city://` and the file's path, as
/// [`City::files`](veduta_ecs::City::files) tells it. Must be added before Bevy's `AssetPlugin`, and so before `DefaultPlugins`.
#[derive(Debug, Clone, Copy, Default)]
pub struct CityAssetsPlugin;

impl Plugin for CityAssetsPlugin {
    fn build(&self, app: &mut App) {
        let counter = Counter::default();
        let for_readers = counter.clone();
        app.insert_resource(CityFiles { counter, waiting: BTreeMap::new() })
            .register_asset_source(CITY_SOURCE, AssetSourceBuilder::new(move || Box::new(CityAssets(for_readers.clone()))));
    }
}

type Answer = Result<Arc<[u8]>, AssetReaderError>;

/// Where readers leave what they ask for.
#[derive(Clone, Default)]
struct Counter(Arc<Mutex<Vec<(PathBuf, Sender<Answer>)>>>);

impl Counter {
    fn ask(&self, path: &Path) -> Receiver<Answer> {
        let (sender, answer) = bounded(1);
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push((path.to_owned(), sender));
        answer
    }

    fn take(&self) -> Vec<(PathBuf, Sender<Answer>)> {
        core::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Reads what the client brings.
struct CityAssets(Counter);

impl AssetReader for CityAssets {
    async fn read<'a>(&'a self, path: &'a Path) -> Result<impl Reader + 'a, AssetReaderError> {
        match self.0.ask(path).recv().await {
            Ok(answer) => answer.map(|content| VecReader::new(content.to_vec())),
            Err(_) => Err(AssetReaderError::Io(Arc::new(io::Error::other("the city was closed before the file came")))),
        }
    }

    async fn read_meta<'a>(&'a self, path: &'a Path) -> Result<impl Reader + 'a, AssetReaderError> {
        Err::<VecReader, _>(AssetReaderError::NotFound(path.to_owned()))
    }

    async fn read_directory<'a>(&'a self, path: &'a Path) -> Result<Box<PathStream>, AssetReaderError> {
        Err(AssetReaderError::NotFound(path.to_owned()))
    }

    async fn is_directory<'a>(&'a self, _: &'a Path) -> Result<bool, AssetReaderError> {
        Ok(false)
    }
}

/// What is asked for of the open city's files.
#[derive(Resource)]
pub(crate) struct CityFiles {
    counter: Counter,
    /// Who waits for a file, by its number in the index.
    waiting: BTreeMap<u32, Vec<Sender<Answer>>>,
}

impl CityFiles {
    /// Files that have not come.
    pub fn wanted(&self) -> impl Iterator<Item = u32> {
        self.waiting.keys().copied()
    }

    /// Gives a file to all who wait for it.
    pub fn bring(&mut self, number: u32, content: &Arc<[u8]>) {
        self.answer(number, &|| Ok(Arc::clone(content)));
    }

    /// Tells all who wait for a file that it cannot be had.
    pub fn fail(&mut self, number: u32, error: &StoreError) {
        self.answer(number, &|| Err(AssetReaderError::Io(Arc::new(io::Error::other(error.to_string())))));
    }

    /// Tells all who wait that the city is closed.
    pub fn close(&mut self) {
        self.waiting.clear();
    }

    fn answer(&mut self, number: u32, answer: &dyn Fn() -> Answer) {
        for sender in self.waiting.remove(&number).into_iter().flatten() {
            // Who dropped the asset meanwhile does not wait any more.
            let _ = sender.try_send(answer());
        }
    }
}

/// Notes what is asked for. While no index is here all wait; where no city is asked for nothing can come.
pub(crate) fn take_asks(store: Option<Res<Store>>, files: Option<ResMut<CityFiles>>) {
    let Some(mut files) = files else { return };
    let Some(store) = store else {
        let closed = files.counter.take();
        closed.into_iter().for_each(|(path, sender)| drop(sender.try_send(Err(AssetReaderError::NotFound(path)))));
        return;
    };
    let Some(index) = store.client.index() else { return };
    for (path, sender) in files.counter.take() {
        // The index has slashes, whatever the system writes.
        let name = path.iter().map(|part| part.to_string_lossy()).collect::<Vec<_>>().join("/");
        match index.files.binary_search_by(|file| file.path.as_str().cmp(&name)) {
            Ok(number) => files.waiting.entry(number as u32).or_default().push(sender),
            Err(_) => drop(sender.try_send(Err(AssetReaderError::NotFound(path)))),
        }
    }
}
