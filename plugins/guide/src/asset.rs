use bevy::asset::io::Reader;
use bevy::asset::{AssetLoader, LoadContext};
use bevy::prelude::*;
use veduta_city::{Guide, GuidePlace, file};
use veduta_ecs::{City, CityFailed, CityOpened, Words, own_file};

/// A guide, read from `*.guide.ron`.
#[derive(Asset, TypePath, Debug, Clone)]
pub struct GuideAsset(
    /// The guide.
    pub Guide,
);

/// Asks for the guide of the open city: a path of the asset server, such as `old_prague.guide.ron`.
#[derive(Message, Debug, Clone, PartialEq, Eq)]
pub struct OpenGuide(
    /// The path.
    pub String,
);

/// A guide that could not be read.
#[derive(Debug, thiserror::Error)]
pub enum GuideLoadError {
    /// The file could not be read.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// There is a mistake in it.
    #[error("{0}")]
    Syntax(#[from] file::SyntaxError),
}

/// Reads guides.
#[derive(Default, TypePath)]
pub(crate) struct GuideLoader;

impl AssetLoader for GuideLoader {
    type Asset = GuideAsset;
    type Settings = ();
    type Error = GuideLoadError;

    async fn load(&self, reader: &mut dyn Reader, _: &(), context: &mut LoadContext<'_>) -> Result<GuideAsset, GuideLoadError> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        Ok(GuideAsset(file::parse_bytes(&bytes, &context.path().to_string())?))
    }

    fn extensions(&self) -> &[&str] {
        &["guide.ron"]
    }
}

/// What is told of the open city's places. A game may write its own.
#[derive(Resource, Debug, Default)]
pub struct CityGuide {
    guide: Guide,
    handle: Option<Handle<GuideAsset>>,
    version: u64,
}

impl CityGuide {
    /// A guide given as a value.
    #[must_use]
    pub fn of(guide: Guide) -> Self {
        Self { guide, handle: None, version: 1 }
    }

    /// The guide.
    #[must_use]
    pub fn guide(&self) -> &Guide {
        &self.guide
    }

    /// Grows whenever another guide is told.
    #[must_use]
    pub fn version(&self) -> u64 {
        self.version
    }

    /// A path of the asset server for a file beside the guide's. A guide that was given as a value lies among the assets.
    #[must_use]
    pub fn beside(&self, file: &str) -> String {
        let guide = self.handle.as_ref().and_then(Handle::path);
        let path = guide.and_then(|guide| guide.resolve_embed_str(file).ok());
        path.map_or_else(|| file.to_owned(), |path| path.to_string())
    }

    /// What is told of a place of the map.
    #[must_use]
    pub fn place(&self, name: &str) -> Option<&GuidePlace> {
        self.guide.of(name)
    }

    /// A place's name in the visitor's language.
    #[must_use]
    pub fn name<'a>(&'a self, name: &'a str, words: &Words) -> &'a str {
        self.place(name).map_or(name, |told| told.name_in(words.language()))
    }
}

/// Asks for guides: for those that a city brings where it opens, unless others were asked for.
pub(crate) fn open(
    mut asked: MessageReader<OpenGuide>,
    mut opened: MessageReader<CityOpened>,
    city: Option<Res<City>>,
    assets: Res<AssetServer>,
    mut guide: ResMut<CityGuide>,
) {
    let has_opened = opened.read().count() > 0;
    if let Some(OpenGuide(path)) = asked.read().last() {
        guide.handle = Some(assets.load(path.clone()));
    } else if has_opened
        && (guide.version == 0 || guide.handle.is_some())
        && let Some(path) = city.and_then(|city| own_file(&city, ".guide.ron", guide.handle.as_ref()))
    {
        // Another city's file may have had the same name.
        assets.reload(path.clone());
        guide.handle = Some(assets.load(path));
    }
}

/// Takes guides that have come or changed, and tells of those that could not be read: the last good version stays.
pub(crate) fn take(
    mut events: MessageReader<AssetEvent<GuideAsset>>,
    mut failed: MessageReader<bevy::asset::AssetLoadFailedEvent<GuideAsset>>,
    assets: Res<Assets<GuideAsset>>,
    mut guide: ResMut<CityGuide>,
    mut told: MessageWriter<CityFailed>,
) {
    let asked = guide.handle.as_ref().map(Handle::id);
    for event in events.read() {
        if let AssetEvent::Added { id } | AssetEvent::Modified { id } = event
            && asked == Some(*id)
            && let Some(asset) = assets.get(*id)
        {
            for mistake in asset.0.validate() {
                told.write(CityFailed { message: format!("the guide: {mistake}"), will_retry: false });
            }
            guide.guide = asset.0.clone();
            guide.version += 1;
        }
    }
    for failure in failed.read().filter(|failure| asked == Some(failure.id)) {
        let message = match &failure.error {
            bevy::asset::AssetLoadError::AssetLoaderError(error) => error.error().to_string(),
            error => error.to_string(),
        };
        error!("{message}");
        told.write(CityFailed { message, will_retry: false });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_guide_with_a_mistake_is_told_with_its_line_and_the_last_good_one_stays() {
        let dir = std::env::temp_dir().join(format!("veduta-guide-{}", std::process::id()));
        std::fs::create_dir_all(&dir).expect("a folder of our own");
        std::fs::write(dir.join("good.guide.ron"), r#"(places: [(name: "A", names: {"cs": "Á"})])"#).expect("room");
        std::fs::write(dir.join("bad.guide.ron"), "(\n  places: [\n    (nam: \"A\"),\n  ],\n)").expect("room");
        let mut app = App::new();
        let assets = AssetPlugin { file_path: dir.display().to_string(), ..default() };
        app.add_plugins((MinimalPlugins, assets, crate::GuidePlugin { interface: false }));
        let until = |app: &mut App, holds: &dyn Fn(&mut App) -> bool| {
            (0..2_000).any(|_| {
                app.update();
                std::thread::sleep(std::time::Duration::from_millis(1));
                holds(app)
            })
        };
        app.world_mut().write_message(OpenGuide("good.guide.ron".into()));
        assert!(until(&mut app, &|app| app.world().resource::<CityGuide>().place("A").is_some()));
        app.world_mut().write_message(OpenGuide("bad.guide.ron".into()));
        let told = |app: &mut App| app.world_mut().resource_mut::<Messages<CityFailed>>().drain().map(|f| f.message).last();
        let mut message = None;
        assert!((0..2_000).any(|_| {
            app.update();
            std::thread::sleep(std::time::Duration::from_millis(1));
            message = told(&mut app);
            message.is_some()
        }));
        assert!(message.as_ref().is_some_and(|m| m.contains("bad.guide.ron:3")), "{message:?}");
        assert!(app.world().resource::<CityGuide>().place("A").is_some());
        let _ = std::fs::remove_dir_all(dir);
    }
}
