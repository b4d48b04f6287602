//! Renders without a display, frame by frame: the same bytes each time on the same machine.

use core::str::FromStr;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use bevy::app::PluginsState;
use bevy::audio::AudioPlugin;
use bevy::camera::{RenderTarget, ShadowLodOrigin};
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::{TextureFormat, TextureUsages};
use bevy::render::renderer::RenderAdapterInfo;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::time::TimeUpdateStrategy;
use bevy::window::ExitCondition;
use bevy::winit::WinitPlugin;
use image::RgbaImage;
use veduta::buildings::{BuildSettings, Building, BuildingsPlugin};
use veduta::city::Life;
use veduta::ecs::{Awaited, StandingCells};
use veduta::facade::{FacadePlugin, Painting};
use veduta::life::{CityLife, LifeKinds, LifePlugin, LifeSettings};
use veduta::prelude::*;
use veduta::sound::{SoundPlugin, SoundTrack};
use veduta::streaming::{Fetching, RetryTime, Wanted};
use veduta::tour::{StripSettings, TourState};

use crate::camera::camera;
use crate::profile::Profile;
use crate::{Failure, soundtrack, tours};

/// Width and height in pixels, written `1280x720`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
}

impl FromStr for Size {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('x').and_then(|(w, h)| Some((w.trim().parse().ok()?, h.trim().parse().ok()?)));
        match parts {
            Some((width, height)) if (16..=8192).contains(&width) && (16..=8192).contains(&height) => Ok(Self { width, height }),
            _ => Err(format!("`{text}` is no size: write WIDTHxHEIGHT, each from 16 to 8192, as in 1280x720")),
        }
    }
}

/// Frames rendered until the shaders of a first picture are surely compiled and its textures uploaded.
const WARM_UP: usize = 4;
/// Longest wait for a city to open, or for anything more of what is in sight to stand.
const PATIENCE: Duration = Duration::from_secs(12);
/// Updates in which a picture must have come back from the renderer.
const EXPOSURE: usize = 4_000;

type Captured = Arc<Mutex<Option<RgbaImage>>>;

/// The engine without windows, in which time stands; each update draws at once.
pub(crate) fn darkroom() -> App {
    darkroom_beside(None)
}

/// The same; files of a folder can be read as `tours://`.
fn darkroom_beside(folder: Option<&Path>) -> App {
    let mut app = App::new();
    if let Some(folder) = folder {
        tours::add_source(&mut app, folder);
    }
    app.add_plugins(
        DefaultPlugins
            .set(WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() })
            .set(RenderPlugin { synchronous_pipeline_compilation: true, ..default() })
            .set(AssetPlugin { watch_for_changes_override: Some(false), ..default() })
            .set(bevy::log::LogPlugin { filter: "warn,wgpu=error,naga=warn,bevy_render=error".into(), ..default() })
            .disable::<WinitPlugin>()
            .disable::<AudioPlugin>()
            .disable::<PipelinedRenderingPlugin>(),
    )
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO))
    .insert_resource(Time::<Virtual>::from_max_delta(Duration::from_secs(3_600)));
    app
}

/// What a camera draws on.
pub(crate) fn film(app: &mut App, size: Size) -> Handle<Image> {
    let mut image = Image::new_target_texture(size.width, size.height, TextureFormat::Rgba8UnormSrgb, None);
    image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    app.world_mut().resource_mut::<Assets<Image>>().add(image)
}

/// Waits for plugins that ask the system for something, and ends the making of an app.
pub(crate) fn finish(app: &mut App) {
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();
}

/// A camera in a city, without a display.
pub struct Studio {
    app: App,
    target: Handle<Image>,
    viewer: Entity,
    captured: Captured,
    given_up: Missing,
}

/// What is wanted of a city and could not be had.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Missing {
    /// Cells that do not stand at some level.
    pub cells: BTreeSet<u32>,
    /// Regions of the index: nobody knows what is missing there.
    pub regions: BTreeSet<u32>,
    /// Regions whose overview has not come: maps and districts.
    pub overviews: BTreeSet<u32>,
}

impl Missing {
    fn sets(&self) -> [(&'static str, &BTreeSet<u32>); 3] {
        [("cells", &self.cells), ("regions of the index", &self.regions), ("overviews of regions", &self.overviews)]
    }

    /// How much it is.
    #[must_use]
    pub fn count(&self) -> usize {
        self.sets().iter().map(|(_, set)| set.len()).sum()
    }

    /// Whether there is all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.count() == 0
    }

    fn is_within(&self, other: &Self) -> bool {
        self.sets().iter().zip(other.sets()).all(|((_, own), (_, others))| own.is_subset(others))
    }

    fn add(&mut self, other: &Self) {
        self.cells.extend(&other.cells);
        self.regions.extend(&other.regions);
        self.overviews.extend(&other.overviews);
    }
}

impl core::fmt::Display for Missing {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let sets = self.sets().into_iter().filter(|(_, set)| !set.is_empty());
        let told: Vec<String> = sets.map(|(what, set)| format!("{what} {set:?}")).collect();
        f.write_str(&told.join(", "))
    }
}

impl Studio {
    /// Opens a city (directory or URL) for pictures of a size.
    ///
    /// # Errors
    /// If there is no adapter to render with, or the city does not open.
    pub fn open(city: &str, size: Size, profile: Profile) -> Result<Self, Failure> {
        Self::open_with(city, size, profile, |_| ())
    }

    /// The same; the engine is prepared before it begins.
    pub(crate) fn open_with(city: &str, size: Size, profile: Profile, prepare: impl FnOnce(&mut App)) -> Result<Self, Failure> {
        Self::make(city, size, profile, None, prepare)
    }

    /// The same for a film with sound: files beside its tour are read as `tours://`, and what is heard is kept.
    pub(crate) fn open_with_sound(city: &str, size: Size, profile: Profile, folder: &Path) -> Result<Self, Failure> {
        Self::make(city, size, profile, Some(folder), |_| ())
    }

    fn make(
        city: &str,
        size: Size,
        profile: Profile,
        folder: Option<&Path>,
        prepare: impl FnOnce(&mut App),
    ) -> Result<Self, Failure> {
        let mut app = darkroom_beside(folder);
        profile.apply(&mut app);
        app.add_plugins((
            veduta::ecs::EcsPlugin,
            StreamingPlugin { fetching: Fetching::Inline },
            BuildingsPlugin { building: Building::Inline },
            FacadePlugin { tiles: profile.tiles(), painting: Painting::Inline },
            SkyPlugin,
            TourPlugin::default(),
            LifePlugin,
        ))
        // Whoever takes the picture says whether anything lives.
        .insert_resource(LifeSettings { kinds: LifeKinds::NONE, ..profile.life() })
        .insert_resource(BuildSettings { vertices_a_frame: usize::MAX, in_the_making: 64, ..profile.buildings() })
        .insert_resource(OpenCity(city.to_owned()));
        if folder.is_some() {
            app.insert_resource(SoundTrack::new(soundtrack::RATE_HZ)).add_plugins(SoundPlugin);
        }
        let target = film(&mut app, size);
        // What a visitor presses is no part of a picture.
        app.world_mut().resource_mut::<StripSettings>().visible = false;
        let mut settings = app.world_mut().resource_mut::<StreamingSettings>();
        (settings.packets_a_frame, settings.finer_within_s) = (usize::MAX, f64::INFINITY);
        let viewer = app.world_mut().spawn((camera(), RenderTarget::Image(target.clone().into()), Viewer, ShadowLodOrigin)).id();
        finish(&mut app);
        prepare(&mut app);
        let mut studio = Self { app, target, viewer, captured: Captured::default(), given_up: Missing::default() };
        studio.look(false);
        studio.await_city(city)?;
        Ok(studio)
    }

    fn await_city(&mut self, city: &str) -> Result<(), Failure> {
        let (began, mut why) = (Instant::now(), String::new());
        while began.elapsed() < PATIENCE {
            self.update_waiting(true);
            if self.app.world().get_resource::<City>().is_some_and(|c| c.overviews.iter().next().is_some()) {
                return Ok(());
            }
            let failures = self.app.world().resource::<Messages<CityFailed>>();
            for failure in failures.iter_current_update_messages() {
                why.clone_from(&failure.message);
                if !failure.will_retry {
                    return Err(why.into());
                }
            }
        }
        Err(format!("{city}: the city did not open in {} s: {why}", PATIENCE.as_secs()).into())
    }

    /// Waits until the tour that was given can be played, or cannot: its streets come from the city.
    pub fn await_tour(&mut self) {
        let began = Instant::now();
        while began.elapsed() < PATIENCE && self.app.world().resource::<TourPlayer>().state() == TourState::Waiting {
            self.update_waiting(true);
        }
    }

    /// An update in which the app's time stands, but that of requests to be tried again goes on.
    fn update_waiting(&mut self, idle: bool) {
        let began = Instant::now();
        self.app.update();
        if idle {
            std::thread::sleep(Duration::from_millis(1));
        }
        self.app.world_mut().resource_mut::<RetryTime>().0 += began.elapsed().as_secs_f64();
    }

    /// Lets the city live, as a profile allows.
    pub fn enliven(&mut self, life: Life, profile: Profile) {
        self.app.insert_resource(CityLife::of(life)).insert_resource(profile.life());
    }

    /// Where the camera stands and looks.
    pub fn set_eye(&mut self, eye: Eye) {
        if let Some(mut current) = self.app.world_mut().get_mut::<Eye>(self.viewer) {
            *current = eye;
        }
    }

    /// Where the camera stands and looks now.
    #[must_use]
    pub fn eye(&self) -> Eye {
        self.app.world().get::<Eye>(self.viewer).copied().unwrap_or_default()
    }

    /// Name of the renderer, and whether it is the processor.
    #[must_use]
    pub fn renderer(&self) -> (String, bool) {
        let Some(adapter) = self.app.world().get_resource::<RenderAdapterInfo>() else { return ("none".to_owned(), true) };
        (adapter.name.clone(), format!("{:?}", adapter.device_type) == "Cpu")
    }

    /// The world, for what a command sets beside the camera.
    pub fn world(&mut self) -> &mut World {
        self.app.world_mut()
    }

    /// What has been heard since it was last asked, interleaved stereo; nothing where it is not kept.
    pub(crate) fn heard(&mut self) -> Vec<f32> {
        self.app.world_mut().get_resource_mut::<SoundTrack>().map(|mut track| track.take()).unwrap_or_default()
    }

    /// Lets time pass.
    pub fn advance(&mut self, time: Duration) {
        // Whoever films has waited for all that comes.
        self.app.insert_resource(Awaited::default());
        self.app.insert_resource(TimeUpdateStrategy::ManualDuration(time));
        self.app.update();
        self.app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    }

    /// What is wanted and has not come.
    #[must_use]
    pub fn missing(&self) -> Missing {
        let world = self.app.world();
        let (standing, wanted) = (world.resource::<StandingCells>(), world.resource::<Wanted>());
        let lacks = |&&(cell, level): &&(u32, veduta::city::Level)| !standing.levels(cell).has(level);
        // An empty one stands in for one that cannot be had.
        let overview = |part: u32| world.get_resource::<City>()?.overviews.get(part).filter(|it| !it.districts.is_empty());
        let is_here = |part: u32| overview(part).is_some();
        Missing {
            cells: wanted.order.iter().filter(lacks).map(|&(cell, _)| cell).collect(),
            regions: wanted.regions.iter().copied().collect(),
            overviews: wanted.overviews.iter().copied().filter(|&part| !is_here(part)).collect(),
        }
    }

    /// Waits, without letting the app's time pass, until all that is wanted stands; gives back what does not even then. What
    /// was waited for in vain once is not waited for again.
    pub fn settle(&mut self) -> Missing {
        // Where the camera was put meanwhile, nothing is planned yet.
        self.update_waiting(false);
        let mut came = Instant::now();
        let mut before = usize::MAX;
        while came.elapsed() < PATIENCE {
            let missing = self.missing();
            if missing.is_within(&self.given_up) {
                return missing;
            }
            let left = missing.count();
            let idle = left == before;
            if !idle {
                (came, before) = (Instant::now(), left);
            }
            self.update_waiting(idle);
        }
        let missing = self.missing();
        self.given_up.add(&missing);
        missing
    }

    /// Lets time pass and draws, for nobody.
    pub(crate) fn walk(&mut self, time: Duration) {
        self.look(true);
        self.advance(time);
        self.look(false);
    }

    /// Draws this moment, for nobody.
    pub(crate) fn draw(&mut self) {
        self.look(true);
        self.app.update();
        self.look(false);
    }

    /// Renders until nothing changes any more: for the first picture.
    pub fn warm_up(&mut self) {
        self.look(true);
        for _ in 0..WARM_UP {
            self.app.update();
        }
        self.look(false);
    }

    /// Whether updates draw: only those do that end in a picture.
    fn look(&mut self, open: bool) {
        if let Some(mut camera) = self.app.world_mut().get_mut::<Camera>(self.viewer) {
            camera.is_active = open;
        }
    }

    /// Takes the picture of this moment.
    ///
    /// # Errors
    /// If the renderer gives no picture.
    pub fn shoot(&mut self) -> Result<RgbaImage, Failure> {
        let captured = Arc::clone(&self.captured);
        self.app.world_mut().spawn(Screenshot::image(self.target.clone())).observe(move |shot: On<ScreenshotCaptured>| {
            let picture = shot.image.clone().try_into_dynamic().map(|p| p.to_rgba8()).ok();
            *captured.lock().unwrap_or_else(PoisonError::into_inner) = picture;
        });
        self.look(true);
        for _ in 0..EXPOSURE {
            self.app.update();
            self.look(false);
            if let Some(picture) = self.captured.lock().unwrap_or_else(PoisonError::into_inner).take() {
                return Ok(picture);
            }
        }
        Err("the renderer gave no picture; is a Vulkan driver installed (Debian: mesa-vulkan-drivers)?".into())
    }
}
