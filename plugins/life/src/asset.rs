use bevy::asset::io::Reader;
use bevy::asset::{AssetLoader, LoadContext};
use bevy::prelude::*;
use veduta_city::{Life, file};
use veduta_ecs::{City, CityFailed, CityOpened, own_file};

/// What lives in a city, read from `*.life.ron`.
#[derive(Asset, TypePath, Debug, Clone)]
pub struct LifeAsset(
    /// What lives.
    pub Life,
);

/// Asks for what is told of the open city's life: a path of the asset server, such as `old_prague.life.ron`.
#[derive(Message, Debug, Clone, PartialEq, Eq)]
pub struct OpenLife(
    /// The path.
    pub String,
);

/// What is told of a city's life and could not be read.
#[derive(Debug, thiserror::Error)]
pub enum LifeLoadError {
    /// The file could not be read.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// There is a mistake in it.
    #[error("{0}")]
    Syntax(#[from] file::SyntaxError),
}

/// Reads files of living things.
#[derive(Default, TypePath)]
pub(crate) struct LifeLoader;

impl AssetLoader for LifeLoader {
    type Asset = LifeAsset;
    type Settings = ();
    type Error = LifeLoadError;

    async fn load(&self, reader: &mut dyn Reader, _: &(), context: &mut LoadContext<'_>) -> Result<LifeAsset, LifeLoadError> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        Ok(LifeAsset(file::parse_bytes(&bytes, &context.path().to_string())?))
    }

    fn extensions(&self) -> &[&str] {
        &["life.ron"]
    }
}

/// What lives in the open city beside what lives by rule. A game may write its own.
#[derive(Resource, Debug, Default)]
pub struct CityLife {
    life: Life,
    handle: Option<Handle<LifeAsset>>,
}

impl CityLife {
    /// Living things given as a value.
    #[must_use]
    pub fn of(life: Life) -> Self {
        Self { life, handle: None }
    }

    /// What lives.
    #[must_use]
    pub fn life(&self) -> &Life {
        &self.life
    }
}

/// Asks for files: for those that a city brings where it opens, unless others were asked for.
pub(crate) fn open(
    mut asked: MessageReader<OpenLife>,
    mut opened: MessageReader<CityOpened>,
    city: Option<Res<City>>,
    assets: Res<AssetServer>,
    mut life: ResMut<CityLife>,
) {
    let has_opened = opened.read().count() > 0;
    if let Some(OpenLife(path)) = asked.read().last() {
        life.handle = Some(assets.load(path.clone()));
    } else if has_opened
        && (life.life == Life::default() || life.handle.is_some())
        && let Some(path) = city.and_then(|city| own_file(&city, ".life.ron", life.handle.as_ref()))
    {
        // Another city's file may have had the same name.
        assets.reload(path.clone());
        life.handle = Some(assets.load(path));
    }
}

/// Takes files that have come or changed, and tells of those that could not be read: the last good version lives on.
pub(crate) fn take(
    mut events: MessageReader<AssetEvent<LifeAsset>>,
    mut failed: MessageReader<bevy::asset::AssetLoadFailedEvent<LifeAsset>>,
    assets: Res<Assets<LifeAsset>>,
    mut life: ResMut<CityLife>,
    mut told: MessageWriter<CityFailed>,
) {
    let asked = life.handle.as_ref().map(Handle::id);
    for event in events.read() {
        if let AssetEvent::Added { id } | AssetEvent::Modified { id } = event
            && asked == Some(*id)
            && let Some(asset) = assets.get(*id)
        {
            let mistakes = asset.0.validate();
            for mistake in &mistakes {
                told.write(CityFailed { message: format!("the city's life: {mistake}"), will_retry: false });
            }
            // Numbers out of bounds are not let in.
            if mistakes.is_empty() {
                life.life = asset.0.clone();
            }
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
    fn a_mistake_is_told_with_its_line_and_the_last_good_file_lives_on() {
        let dir = std::env::temp_dir().join(format!("veduta-life-{}", std::process::id()));
        std::fs::create_dir_all(&dir).expect("a folder of our own");
        let sign = "kind: Sign(colour: \"#808080\", trim: \"#C0C0C0\")";
        std::fs::write(dir.join("good.life.ron"), format!("(things: [(name: \"A\", at: At(0, 0), {sign})])")).expect("room");
        std::fs::write(dir.join("bad.life.ron"), "(\n  things: [\n    (nam: \"A\"),\n  ],\n)").expect("room");
        std::fs::write(dir.join("wide.life.ron"), "(rules: (hearths: 7))").expect("room");
        let mut app = App::new();
        let assets = AssetPlugin { file_path: dir.display().to_string(), ..default() };
        app.add_plugins((MinimalPlugins, assets, crate::LifePlugin));
        let mut await_told = |path: &str, what: &str| {
            app.world_mut().write_message(OpenLife(path.into()));
            let mut told = Vec::new();
            let is_there = (0..2_000).any(|_| {
                app.update();
                std::thread::sleep(std::time::Duration::from_millis(1));
                told.extend(app.world_mut().resource_mut::<Messages<CityFailed>>().drain().map(|f| f.message));
                let lives = app.world().resource::<CityLife>().life().things.iter().any(|thing| thing.name == what);
                lives && what == "A" && path.starts_with("good") || told.iter().any(|message| message.contains(what))
            });
            assert!(is_there, "{path}: {told:?}");
            app.world().resource::<CityLife>().life().things.len()
        };
        assert_eq!(await_told("good.life.ron", "A"), 1);
        assert_eq!(await_told("bad.life.ron", "bad.life.ron:3"), 1);
        assert_eq!(await_told("wide.life.ron", "hearths is 7"), 1);
        let _ = std::fs::remove_dir_all(dir);
    }
}
