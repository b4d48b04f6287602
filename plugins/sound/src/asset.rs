use std::collections::BTreeMap;

use bevy::asset::io::Reader;
use bevy::asset::{AssetLoadError, AssetLoadFailedEvent, AssetLoader, LoadContext};
use bevy::prelude::*;
use veduta_city::{Soundscape, file};
use veduta_ecs::{City, CityFailed, CityOpened, own_file};
use veduta_synth::{Recording, RecordingError};

/// What a city sounds like, read from `*.sound.ron`.
#[derive(Asset, TypePath, Debug, Clone)]
pub struct SoundsAsset(
    /// The description.
    pub Soundscape,
);

/// A recording, read from `*.ogg`.
#[derive(Asset, TypePath, Clone)]
pub struct RecordingAsset(
    /// The recording.
    pub Recording,
);

/// Asks for the sounds of the open city: a path of the asset server, such as `old_prague.sound.ron`.
#[derive(Message, Debug, Clone, PartialEq, Eq)]
pub struct OpenSounds(
    /// The path.
    pub String,
);

/// A description of sounds that could not be read.
#[derive(Debug, thiserror::Error)]
pub enum SoundsLoadError {
    /// The file could not be read.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// There is a mistake in it.
    #[error("{0}")]
    Syntax(#[from] file::SyntaxError),
}

/// A recording that could not be read.
#[derive(Debug, thiserror::Error)]
pub enum RecordingLoadError {
    /// The file could not be read.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// It cannot be played.
    #[error("{path}: {error}")]
    Recording {
        /// The file.
        path: String,
        /// What is wrong with it.
        error: RecordingError,
    },
}

/// Reads descriptions of sounds.
#[derive(Default, TypePath)]
pub(crate) struct SoundsLoader;

impl AssetLoader for SoundsLoader {
    type Asset = SoundsAsset;
    type Settings = ();
    type Error = SoundsLoadError;

    async fn load(&self, reader: &mut dyn Reader, _: &(), context: &mut LoadContext<'_>) -> Result<SoundsAsset, SoundsLoadError> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        Ok(SoundsAsset(file::parse_bytes(&bytes, &context.path().to_string())?))
    }

    fn extensions(&self) -> &[&str] {
        &["sound.ron"]
    }
}

/// Reads recordings.
#[derive(Default, TypePath)]
pub(crate) struct RecordingLoader;

impl AssetLoader for RecordingLoader {
    type Asset = RecordingAsset;
    type Settings = ();
    type Error = RecordingLoadError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        _: &(),
        context: &mut LoadContext<'_>,
    ) -> Result<RecordingAsset, RecordingLoadError> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        let recording =
            Recording::new(bytes).map_err(|error| RecordingLoadError::Recording { path: context.path().to_string(), error })?;
        Ok(RecordingAsset(recording))
    }

    fn extensions(&self) -> &[&str] {
        &["ogg"]
    }
}

/// What the open city sounds like. A game may write its own.
#[derive(Resource, Debug, Default)]
pub struct CitySounds {
    sounds: Soundscape,
    handle: Option<Handle<SoundsAsset>>,
    recordings: BTreeMap<String, Handle<RecordingAsset>>,
}

impl CitySounds {
    /// Sounds given as a value.
    #[must_use]
    pub fn of(sounds: Soundscape) -> Self {
        Self { sounds, ..Self::default() }
    }

    /// The sounds.
    #[must_use]
    pub fn sounds(&self) -> &Soundscape {
        &self.sounds
    }

    /// A recording by its path beside the file of sounds, once it is here.
    pub(crate) fn recording<'a>(&self, path: &str, assets: Option<&'a Assets<RecordingAsset>>) -> Option<&'a Recording> {
        assets?.get(self.recordings.get(path)?).map(|asset| &asset.0)
    }
}

/// Asks for sounds: for those that a city brings where it opens, unless others were asked for.
pub(crate) fn open(
    mut asked: MessageReader<OpenSounds>,
    mut opened: MessageReader<CityOpened>,
    city: Option<Res<City>>,
    assets: Res<AssetServer>,
    mut sounds: ResMut<CitySounds>,
) {
    let has_opened = opened.read().count() > 0;
    if let Some(OpenSounds(path)) = asked.read().last() {
        sounds.handle = Some(assets.load(path.clone()));
    } else if has_opened
        && (sounds.sounds == Soundscape::default() || sounds.handle.is_some())
        && let Some(path) = city.and_then(|city| own_file(&city, ".sound.ron", sounds.handle.as_ref()))
    {
        // Another city's file may have had the same name.
        assets.reload(path.clone());
        sounds.handle = Some(assets.load(path));
    }
}

/// What an asset that could not be had says.
pub(crate) fn reason(error: &AssetLoadError) -> String {
    match error {
        AssetLoadError::AssetLoaderError(error) => error.error().to_string(),
        error => error.to_string(),
    }
}

/// Takes sounds that have come or changed, and tells of those that could not be read: the last good ones stay.
pub(crate) fn take(
    mut events: MessageReader<AssetEvent<SoundsAsset>>,
    mut failed: MessageReader<AssetLoadFailedEvent<SoundsAsset>>,
    mut lost: MessageReader<AssetLoadFailedEvent<RecordingAsset>>,
    (assets, server): (Res<Assets<SoundsAsset>>, Res<AssetServer>),
    mut sounds: ResMut<CitySounds>,
    mut told: MessageWriter<CityFailed>,
) {
    let asked = sounds.handle.as_ref().map(Handle::id);
    for event in events.read() {
        if let AssetEvent::Added { id } | AssetEvent::Modified { id } = event
            && asked == Some(*id)
            && let Some(asset) = assets.get(*id)
        {
            for mistake in asset.0.validate() {
                told.write(CityFailed { message: format!("the city's sounds: {mistake}"), will_retry: false });
            }
            let beside = sounds.handle.as_ref().and_then(|handle| handle.path().cloned());
            let path = |file: &str| beside.as_ref().and_then(|path| path.resolve_embed_str(file).ok());
            let load = |file: &&str| Some(((*file).to_owned(), server.load(path(file)?)));
            sounds.recordings = asset.0.files().iter().filter_map(load).collect();
            sounds.sounds = asset.0.clone();
        }
    }
    for failure in failed.read().filter(|failure| asked == Some(failure.id)) {
        let message = reason(&failure.error);
        error!("{message}");
        told.write(CityFailed { message, will_retry: false });
    }
    for failure in lost.read() {
        if sounds.recordings.values().any(|handle| handle.id() == failure.id) {
            let message = format!("{}; the city sounds on without it", reason(&failure.error));
            warn!("{message}");
            told.write(CityFailed { message, will_retry: false });
        }
    }
}
