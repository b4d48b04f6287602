use bevy::asset::io::Reader;
use bevy::asset::{AssetLoader, LoadContext};
use bevy::prelude::*;
use veduta_city::{Tour, file};

/// A tour, read from `*.tour.ron`.
#[derive(Asset, TypePath, Debug, Clone)]
pub struct TourAsset {
    /// The tour.
    pub tour: Tour,
    /// Its text, with a person's comments.
    pub text: String,
}

/// A tour that could not be read.
#[derive(Debug, thiserror::Error)]
pub enum TourLoadError {
    /// The file could not be read.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// There is a mistake in it.
    #[error("{0}")]
    Syntax(#[from] file::SyntaxError),
}

/// Reads tours.
#[derive(Default, TypePath)]
pub(crate) struct TourLoader;

impl AssetLoader for TourLoader {
    type Asset = TourAsset;
    type Settings = ();
    type Error = TourLoadError;

    async fn load(&self, reader: &mut dyn Reader, _: &(), context: &mut LoadContext<'_>) -> Result<TourAsset, TourLoadError> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        let tour = file::parse_bytes(&bytes, &context.path().to_string())?;
        // What could be parsed is text.
        Ok(TourAsset { tour, text: String::from_utf8_lossy(&bytes).into_owned() })
    }

    fn extensions(&self) -> &[&str] {
        &["tour.ron"]
    }
}
