//! Pictures that panels show: read and decoded within limits, off the main thread where there are threads.

mod decode;

use std::collections::BTreeMap;

use bevy::asset::io::Reader;
use bevy::asset::{AssetLoadError, AssetLoadFailedEvent, AssetLoader, LoadContext};
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_egui::egui::{self, ColorImage, TextureHandle, TextureOptions};
use veduta_ecs::CityFailed;

pub use decode::{LARGEST_BYTES, MOST_PIXELS, PictureError};

/// A picture, read from `*.png`, `*.jpg`, `*.jpeg` or `*.webp`, no larger than [`PictureAsset::WIDEST`].
#[derive(Asset, TypePath, Clone)]
pub struct PictureAsset {
    image: ColorImage,
}

impl PictureAsset {
    /// What is wider or higher is shrunk to this, pixels: every graphics card takes it.
    pub const WIDEST: usize = 1_600;

    /// A picture from the bytes of a file.
    ///
    /// # Errors
    /// [`PictureError`] if it is too large, of another kind, or broken.
    pub fn decode(bytes: &[u8]) -> Result<Self, PictureError> {
        Ok(Self { image: decode::decode(bytes, Self::WIDEST)? })
    }

    /// Width and height, pixels.
    #[must_use]
    pub const fn size(&self) -> [usize; 2] {
        self.image.size
    }
}

/// A picture's file that could not be had.
#[derive(Debug, thiserror::Error)]
pub enum PictureLoadError {
    /// The file could not be read.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// It cannot be shown.
    #[error("{path}: {error}")]
    Picture {
        /// The file.
        path: String,
        /// What is wrong with it.
        error: PictureError,
    },
}

/// Reads pictures.
#[derive(Default, TypePath)]
pub(crate) struct PictureLoader;

impl AssetLoader for PictureLoader {
    type Asset = PictureAsset;
    type Settings = ();
    type Error = PictureLoadError;

    async fn load(&self, reader: &mut dyn Reader, _: &(), context: &mut LoadContext<'_>) -> Result<PictureAsset, PictureLoadError> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        let path = || context.path().to_string();
        PictureAsset::decode(&bytes).map_err(|error| PictureLoadError::Picture { path: path(), error })
    }

    fn extensions(&self) -> &[&str] {
        &["png", "jpg", "jpeg", "webp"]
    }
}

/// Pictures that were shown of late.
#[derive(Resource, Default)]
pub(crate) struct Shelf {
    kept: BTreeMap<String, Kept>,
    /// Grows with every picture that is asked for.
    now: u64,
}

struct Kept {
    handle: Handle<PictureAsset>,
    texture: Option<TextureHandle>,
    has_failed: bool,
    last: u64,
}

/// So many pictures stay at hand.
const MOST_KEPT: usize = 12;

/// Pictures for panels, by their paths: a panel asks for one in every frame in which it shows it.
#[derive(SystemParam)]
pub struct Pictures<'w> {
    server: Option<Res<'w, AssetServer>>,
    assets: Option<Res<'w, Assets<PictureAsset>>>,
    shelf: ResMut<'w, Shelf>,
}

impl Pictures<'_> {
    /// A picture by a path of the asset server, once it is here. One that cannot be had is told of once and stays away.
    pub fn get(&mut self, context: &egui::Context, path: &str) -> Option<TextureHandle> {
        let (server, assets) = (self.server.as_ref()?, self.assets.as_ref()?);
        let shelf = &mut *self.shelf;
        shelf.now += 1;
        let kept = shelf.kept.entry(path.to_owned()).or_insert_with(|| Kept {
            handle: server.load(path.to_owned()),
            texture: None,
            has_failed: false,
            last: 0,
        });
        kept.last = shelf.now;
        if kept.texture.is_none()
            && let Some(asset) = assets.get(&kept.handle)
        {
            kept.texture =
                Some(context.load_texture(format!("veduta picture {path}"), asset.image.clone(), TextureOptions::LINEAR));
        }
        let found = kept.texture.clone();
        if shelf.kept.len() > MOST_KEPT {
            let oldest = shelf.kept.iter().filter(|(_, kept)| !kept.has_failed).min_by_key(|(_, kept)| kept.last);
            if let Some(oldest) = oldest.map(|(path, _)| path.clone()) {
                shelf.kept.remove(&oldest);
            }
        }
        found
    }

    /// Whether a picture that was asked for cannot be had.
    #[must_use]
    pub fn has_failed(&self, path: &str) -> bool {
        self.shelf.kept.get(path).is_some_and(|kept| kept.has_failed)
    }
}

/// Tells of pictures that cannot be had.
pub(crate) fn tell_failures(
    mut failed: MessageReader<AssetLoadFailedEvent<PictureAsset>>,
    mut shelf: ResMut<Shelf>,
    mut told: MessageWriter<CityFailed>,
) {
    for failure in failed.read() {
        let Some(kept) = shelf.kept.values_mut().find(|kept| kept.handle.id() == failure.id && !kept.has_failed) else { continue };
        kept.has_failed = true;
        let message = match &failure.error {
            AssetLoadError::AssetLoaderError(error) => error.error().to_string(),
            error => error.to_string(),
        };
        let message = format!("{message}; all else goes on without the picture");
        warn!("{message}");
        told.write(CityFailed { message, will_retry: false });
    }
}
