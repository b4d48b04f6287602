use bevy::camera::Exposure;
use bevy::light::{
    CascadeShadowConfig, CascadeShadowConfigBuilder, DirectionalLightShadowMap, EnvironmentMapLight, GlobalAmbientLight,
};
use bevy::pbr::{DistanceFog, FogFalloff};
use bevy::prelude::*;
use veduta_ecs::{City, CityClock, Daylight, Eye, Viewer};

use crate::Light;

/// What of the light costs time. Live.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Resource)]
pub struct SkySettings {
    /// Whether the sun casts shadows.
    pub shadows: bool,
    /// Farthest shadow for an eye in the street, metres; from above shadows reach up to five times as far.
    pub shadow_m: f32,
    /// Shadow cascades, 1 to 4.
    pub cascades: usize,
    /// Edge of a shadow map, texels.
    pub shadow_map: usize,
    /// Distance at which things have all but vanished in haze, metres.
    pub visibility_m: f32,
    /// Latitude where no city is open, degrees.
    pub lat_deg: f64,
}

impl Default for SkySettings {
    fn default() -> Self {
        Self { shadows: true, shadow_m: 220.0, cascades: 3, shadow_map: 2048, visibility_m: 4_500.0, lat_deg: 50.0 }
    }
}

/// The sun, or the moon at night.
#[derive(Component, Debug, Clone, Copy, Default)]
pub struct KeyLight;

/// Lets the clock run.
pub(crate) fn run_clock(time: Res<Time>, mut clock: ResMut<CityClock>) {
    if clock.pace != 0.0 {
        let hour = clock.hour + clock.pace * time.delta_secs_f64() / 3600.0;
        clock.hour = hour.rem_euclid(24.0);
    }
}

/// Finds the light of this moment.
pub(crate) fn find_light(
    clock: Res<CityClock>,
    city: Option<Res<City>>,
    settings: Res<SkySettings>,
    mut light: ResMut<Light>,
    mut told: ResMut<Daylight>,
) {
    let lat_deg = city.map_or(settings.lat_deg, |city| city.anchor.lat);
    light.set_if_neq(Light::at(lat_deg, *clock));
    let p = light.palette;
    let fill = fill_of(&p).map(|colour| colour * p.fill);
    told.set_if_neq(Daylight { zenith: p.zenith * p.sky, horizon: p.horizon * p.sky, fill, night: p.night });
}

/// What lights surfaces that look up, level and down, in shares of the fill. What faces up sees the whole sky. A wall sees other walls: a
/// third of the sky's strength, and warm.
fn fill_of(p: &crate::Palette) -> [Vec3; 3] {
    [p.zenith.lerp(p.horizon, 0.7) * 1.5, p.horizon.lerp(p.bounce, 0.55) * 0.62, p.bounce * 0.8]
}

/// Hangs the key light.
pub(crate) fn hang_lights(mut commands: Commands, settings: Res<SkySettings>) {
    commands.insert_resource(DirectionalLightShadowMap { size: settings.shadow_map });
    commands.insert_resource(GlobalAmbientLight::NONE);
    commands.spawn((
        KeyLight,
        DirectionalLight { shadow_maps_enabled: settings.shadows, ..DirectionalLight::default() },
        cascades(&settings, 1.0),
    ));
}

/// Shadows that reach as far as the settings say, times a stretch.
fn cascades(settings: &SkySettings, stretch: f32) -> CascadeShadowConfig {
    let reach_m = settings.shadow_m * stretch;
    let builder = CascadeShadowConfigBuilder {
        num_cascades: settings.cascades.clamp(1, 4),
        minimum_distance: 0.2,
        maximum_distance: reach_m,
        first_cascade_far_bound: reach_m / 10.0,
        ..CascadeShadowConfigBuilder::default()
    };
    builder.build()
}

/// Height of the eye at which shadows begin to reach farther, and the most they do so.
const STRETCH_FROM_M: f32 = 15.0;
const MOST_STRETCH: f32 = 5.0;

/// Who looks from above sees farther: shadows reach on with the eye's height, in steps too small to be seen.
pub(crate) fn stretch_shadows(
    settings: Res<SkySettings>,
    viewers: Query<&Eye, With<Viewer>>,
    mut keys: Query<&mut CascadeShadowConfig, With<KeyLight>>,
    mut last: Local<f32>,
) {
    let height = viewers.iter().map(|eye| eye.eye_m as f32).fold(0.0, f32::max);
    let stretch = ((height / STRETCH_FROM_M).clamp(1.0, MOST_STRETCH) * 32.0).round() / 32.0;
    if stretch.to_bits() == last.to_bits() && !settings.is_changed() {
        return;
    }
    *last = stretch;
    for mut key in &mut keys {
        *key = cascades(&settings, stretch);
    }
}

fn colour(linear: Vec3) -> Color {
    Color::linear_rgb(linear.x, linear.y, linear.z)
}

/// Aims and colours the key light.
pub(crate) fn aim_lights(
    light: Res<Light>,
    settings: Res<SkySettings>,
    mut keys: Query<(&mut DirectionalLight, &mut Transform), With<KeyLight>>,
) {
    if !light.is_changed() && !settings.is_changed() {
        return;
    }
    // At night the moon stands opposite, not too low to shine into the streets.
    let sun = light.sun.direction();
    let from = if sun.y > -0.02 { sun.with_y(sun.y.max(0.03)) } else { Vec3::new(-sun.x, 0.8, -sun.z) };
    for (mut key, mut transform) in &mut keys {
        key.color = colour(light.palette.key);
        key.illuminance = light.palette.key_lux;
        key.shadow_maps_enabled = settings.shadows;
        *transform = Transform::default().looking_to(-from.normalize(), Vec3::Y);
    }
}

/// Gives every viewer fill, haze and exposure.
pub(crate) fn dress_viewers(
    mut commands: Commands,
    light: Res<Light>,
    settings: Res<SkySettings>,
    mut images: ResMut<Assets<Image>>,
    viewers: Query<(Entity, Option<&EnvironmentMapLight>), (With<Viewer>, With<Camera3d>)>,
    new: Query<(), (With<Viewer>, Added<Camera3d>)>,
    mut last: Local<Option<crate::Palette>>,
) {
    if !light.is_changed() && !settings.is_changed() && new.is_empty() {
        return;
    }
    let p = light.palette;
    // The fill's cube map is made anew only when its colours have visibly moved.
    let stale =
        last.is_none_or(|l| (l.zenith - p.zenith).abs().max_element() > 0.01 || (l.horizon - p.horizon).abs().max_element() > 0.02);
    for (viewer, fill) in &viewers {
        let mut viewer = commands.entity(viewer);
        viewer.insert(Exposure { ev100: p.ev100 }).insert(DistanceFog {
            color: colour(p.horizon * 0.8 * p.sky * Exposure { ev100: p.ev100 }.exposure()),
            directional_light_color: colour(p.key * 0.25),
            directional_light_exponent: 18.0,
            falloff: FogFalloff::from_visibility_squared(settings.visibility_m),
        });
        match fill {
            Some(map) if !stale => {
                viewer.insert(EnvironmentMapLight { intensity: p.fill, ..map.clone() });
            }
            _ => {
                let [above, level, below] = fill_of(&p).map(colour);
                let mut map = EnvironmentMapLight::hemispherical_gradient(&mut images, above, level, below);
                map.intensity = p.fill;
                viewer.insert(map);
            }
        }
    }
    if stale {
        *last = Some(p);
    }
}
