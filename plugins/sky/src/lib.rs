//! Sun, sky, fog and night.
//!
//! ```text
//!  CityClock, City.anchor ──► sun (altitude, azimuth) ──► palette ──► key light, sky dome, fill, fog, exposure
//!                                                              └────► Daylight ──► lamps; other plugins' materials
//! ```
//!
//! The sun stands where it stands in the city's latitude at that day and hour. One palette of light is drawn from its
//! altitude, so that sky, fog, fill and exposure always agree. The sky is a dome with a gradient, the sun's glow and a
//! layer of clouds: cheap enough for software rendering, and within WebGL2. Beyond the city's edge roofs and hills stand in haze, as high
//! as the city's own rise there, or a picture of what lies there ([`Backdrop`]), so that a street that ends does not end in nothing.
//!
//! # Use
//! ```no_run
//! use bevy::prelude::*;
//! use veduta_sky::SkyPlugin;
//!
//! App::new()
//!     .add_plugins((DefaultPlugins, SkyPlugin))
//!     .insert_resource(veduta_ecs::CityClock { day: 172, hour: 18.5, pace: 60.0 })
//!     .run();
//! ```
//!
//! At night the lanterns nearest to the viewers light what is about them ([`LampSettings`]); all others only glow. What other plugins need to know
//! of the light they read from [`Daylight`](veduta_ecs::Daylight); clouds and wetness are told by [`Weather`](veduta_ecs::Weather).
//!
//! # Limits
//! No moon phases; clear to fair weather. Lamps cast no shadows.
//!
//! # Rejected
//! Bevy's atmosphere for every profile: it needs compute shaders, which WebGL2 lacks, and costs most of a frame on a
//! software renderer.

mod backdrop;
mod dome;
mod lamps;
mod light;
mod palette;
mod sun;

use bevy::prelude::*;
use veduta_ecs::{CityClock, VedutaSystems};

pub use backdrop::Backdrop;
pub use dome::SkyMaterial;
pub use lamps::LampSettings;
pub use light::{KeyLight, SkySettings};
pub use palette::Palette;
pub use sun::{SunPosition, sun_position};

/// Lights the city by date, hour and place.
#[derive(Debug, Clone, Copy, Default)]
pub struct SkyPlugin;

/// The light of this moment.
#[derive(Resource, Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Where the sun stands.
    pub sun: SunPosition,
    /// Colours and strengths.
    pub palette: Palette,
}

impl Plugin for SkyPlugin {
    fn build(&self, app: &mut App) {
        veduta_ecs::ensure(app);
        app.init_resource::<SkySettings>()
            .init_resource::<LampSettings>()
            .register_type::<SkySettings>()
            .register_type::<LampSettings>()
            .insert_resource(Light::at(50.0, CityClock::default()))
            .add_systems(Update, (light::run_clock, light::find_light).chain().in_set(VedutaSystems::Show));
        if app.is_plugin_added::<bevy::pbr::PbrPlugin>() {
            dome::build(app);
            app.add_systems(Startup, light::hang_lights).add_systems(
                Update,
                (light::aim_lights, light::stretch_shadows, light::dress_viewers, lamps::light_lamps)
                    .chain()
                    .after(light::find_light)
                    .in_set(VedutaSystems::Show),
            );
        }
    }
}

impl Light {
    /// The light at a latitude (degrees) and a time.
    #[must_use]
    pub fn at(lat_deg: f64, clock: CityClock) -> Self {
        let sun = sun_position(lat_deg, clock.day, clock.hour);
        Self { sun, palette: Palette::for_altitude(sun.altitude_deg) }
    }
}
