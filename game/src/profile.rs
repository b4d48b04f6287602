//! Quality profiles.

use bevy::anti_alias::fxaa::Fxaa;
use bevy::anti_alias::smaa::Smaa;
use bevy::core_pipeline::prepass::DepthPrepass;
use bevy::pbr::{ScreenSpaceAmbientOcclusion, ScreenSpaceAmbientOcclusionQualityLevel as Quality};
use bevy::prelude::*;
use bevy::render::render_resource::WgpuAdapterInfo;
use bevy::render::renderer::RenderAdapterInfo;
use veduta::buildings::BuildSettings;
use veduta::facade::{Shading, TileFormat, TileQuality};
use veduta::life::{LifeKinds, LifeSettings};
use veduta::prelude::*;

use crate::settings::Settings;

/// How much the picture may cost.
#[derive(Resource, clap::ValueEnum, serde::Serialize, serde::Deserialize, Debug, Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    /// Software rendering, weak laptops.
    Low,
    /// Integrated graphics; films on a software renderer.
    Medium,
    /// A graphics card.
    High,
    /// A strong graphics card.
    Ultra,
}

impl Profile {
    /// The profile for an adapter.
    #[must_use]
    pub fn for_adapter(info: &WgpuAdapterInfo) -> Self {
        match format!("{:?}", info.device_type).as_str() {
            "DiscreteGpu" => Self::High,
            "IntegratedGpu" | "VirtualGpu" => Self::Medium,
            _ => Self::Low,
        }
    }

    /// How finely tiles are painted and sampled.
    #[must_use]
    pub const fn tiles(self) -> TileQuality {
        let (texels, anisotropy) = match self {
            Self::Low => (128, 1),
            Self::Medium => (256, 1),
            Self::High => (512, 8),
            Self::Ultra => (512, 16),
        };
        TileQuality { texels, anisotropy, format: TileFormat::Fitting }
    }

    /// Sky and shadows.
    #[must_use]
    pub fn sky(self) -> veduta::sky::SkySettings {
        let (shadows, shadow_m, cascades, shadow_map) = match self {
            Self::Low => (false, 80.0, 1, 1024),
            Self::Medium => (true, 200.0, 2, 2048),
            Self::High => (true, 300.0, 4, 2048),
            Self::Ultra => (true, 500.0, 4, 4096),
        };
        veduta::sky::SkySettings { shadows, shadow_m, cascades, shadow_map, ..default() }
    }

    /// Level distances.
    #[must_use]
    pub fn levels(self) -> LevelDistances {
        let mut distances = LevelDistances::uniform(match self {
            Self::Low => 160.0,
            Self::Medium => 240.0,
            Self::High => 360.0,
            Self::Ultra => 500.0,
        });
        // Levels 3 and 4 are shading and vertices, of which a processor that draws has none to spare.
        if self == Self::Low {
            distances.near[1..].fill(0.0);
            distances.far[1..].fill(0.0);
        }
        distances
    }

    /// How surfaces are lit.
    #[must_use]
    pub fn shading(self) -> Shading {
        if self == Self::Low { Shading::Plain } else { Shading::Physical }
    }

    /// What is loaded.
    #[must_use]
    pub fn streaming(self) -> StreamingSettings {
        let [level_2_m, level_3_m] = [0, 1].map(|band| f64::from(self.levels().far[band]) + StreamingSettings::LEAD_M);
        // Where level 3 is forbidden its pictures are not asked for.
        let finest = if self.levels().far[1] > 0.0 { 4 } else { 2 };
        StreamingSettings { level_2_m, level_3_m, finest, ..default() }
    }

    /// What is built.
    #[must_use]
    pub fn buildings(self) -> BuildSettings {
        BuildSettings { relief_m: f64::from(self.levels().far[2]), ..default() }
    }

    /// What lives, and what it may cost.
    #[must_use]
    pub fn life(self) -> LifeSettings {
        let plain_light = self == Self::Low;
        let of = |reach, most_pigeons, most_drops, most_fires, most_vertices| LifeSettings {
            reach,
            most_pigeons,
            most_drops,
            most_fires,
            most_vertices,
            plain_light,
            ..default()
        };
        match self {
            // What is seen through costs a processor that draws each pixel once more.
            Self::Low => LifeSettings { kinds: LifeKinds { smoke: false, ..LifeKinds::ALL }, ..of(0.6, 18, 0, 0, 12_000) },
            Self::Medium => of(0.85, 60, 120, 16, 40_000),
            Self::High => of(1.0, 90, 220, 28, 80_000),
            Self::Ultra => of(1.3, 160, 400, 60, 200_000),
        }
    }

    /// Inserts what the profile sets, and sees to cameras.
    pub fn apply(self, app: &mut App) {
        self.insert(app.world_mut());
        app.add_systems(Update, dress_cameras);
    }

    /// Inserts what the profile sets.
    fn insert(self, world: &mut World) {
        world.insert_resource(self);
        world.insert_resource(self.sky());
        world.insert_resource(self.levels());
        world.insert_resource(self.shading());
        world.insert_resource(self.streaming());
        world.insert_resource(self.buildings());
        world.insert_resource(self.life());
    }
}

/// Shade where things meet: at the feet of walls, under eaves, in reveals. Where there are no compute shaders there is none.
fn contact_shade(quality_level: Quality) -> ScreenSpaceAmbientOcclusion {
    ScreenSpaceAmbientOcclusion { quality_level, ..default() }
}

/// Gives cameras the profile's anti-aliasing, and a depth prepass: each pixel is shaded once however many houses stand behind one another.
fn dress_cameras(mut commands: Commands, profile: Res<Profile>, cameras: Query<(Entity, Ref<Camera3d>)>) {
    for (entity, camera) in &cameras {
        if !(camera.is_added() || profile.is_changed()) {
            continue;
        }
        let mut camera = commands.entity(entity);
        camera.remove::<(Fxaa, Smaa, ScreenSpaceAmbientOcclusion)>().insert(DepthPrepass);
        match *profile {
            Profile::Low => camera.insert((Msaa::Off, Fxaa::default())),
            Profile::Medium => camera.insert((Msaa::Off, Smaa::default(), contact_shade(Quality::Low))),
            Profile::High | Profile::Ultra => camera.insert((Msaa::Off, Smaa::default(), contact_shade(Quality::High))),
        };
    }
}

/// The profile that fits the graphics adapter.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Fitting(pub Profile);

/// Sky and light of a profile that was changed during the walk. How finely tiles are painted stays as it was at the start.
pub(crate) fn follow(profile: Res<Profile>, mut commands: Commands) {
    if profile.is_changed() && !profile.is_added() {
        commands.insert_resource(profile.sky());
        commands.insert_resource(profile.shading());
    }
}

/// Looks at the adapter, and takes the profile that fits it where the visitor has chosen none.
pub(crate) fn adapt(adapter: Option<Res<RenderAdapterInfo>>, settings: Res<Settings>, mut commands: Commands) {
    let fitting = adapter.as_ref().map_or(Profile::Low, |adapter| Profile::for_adapter(&adapter.0));
    let profile = settings.profile.unwrap_or(fitting);
    if let Some(adapter) = adapter {
        info!("{}: profile {profile:?}", adapter.name);
    }
    commands.insert_resource(Fitting(fitting));
    commands.insert_resource(profile.tiles());
    commands.queue(move |world: &mut World| profile.insert(world));
}
