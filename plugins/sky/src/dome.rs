use bevy::asset::embedded_asset;
use bevy::camera::visibility::NoFrustumCulling;
use bevy::light::{NotShadowCaster, NotShadowReceiver};
use bevy::prelude::*;
use bevy::render::render_resource::{AsBindGroup, ShaderType};
use bevy::shader::ShaderRef;
use veduta_ecs::{City, Eye, VedutaSystems, Viewer, Weather};

use crate::Light;
use crate::backdrop::{self, Backdrop, OwnPicture, Slopes};

/// What the dome's shader reads.
#[derive(ShaderType, Debug, Clone, Copy, Default, PartialEq)]
struct SkyUniform {
    /// Linear colour; `w`: radiance.
    zenith: Vec4,
    /// Linear colour; `w`: night, 0 to 1.
    horizon: Vec4,
    /// Direction to the sun; `w`: drift of the clouds.
    sun: Vec4,
    /// Linear colour of the sun; `w`: cover of clouds, 0 to 1.
    key: Vec4,
    /// What rises beyond the city's edge, where there is no picture of it.
    backdrop: Slopes,
    /// `x`: height of the picture of what lies beyond, radians; 0 without one.
    picture: Vec4,
}

/// The sky: gradient, glow of the sun, clouds, stars; and above the horizon what lies beyond the city.
#[derive(Asset, TypePath, AsBindGroup, Debug, Clone)]
pub struct SkyMaterial {
    #[uniform(0)]
    uniform: SkyUniform,
    #[texture(1)]
    #[sampler(2)]
    picture: Option<Handle<Image>>,
}

impl Material for SkyMaterial {
    fn fragment_shader() -> ShaderRef {
        "embedded://veduta_sky/sky.wgsl".into()
    }
    fn enable_prepass() -> bool {
        false
    }
    fn enable_shadows() -> bool {
        false
    }
}

/// The dome that surrounds the viewers.
#[derive(Component)]
struct Dome;

/// Radius in metres: within every camera's far plane, beyond every house.
const RADIUS_M: f32 = 4_000.0;

pub(crate) fn build(app: &mut App) {
    embedded_asset!(app, "sky.wgsl");
    app.add_plugins(MaterialPlugin::<SkyMaterial>::default())
        .init_resource::<Backdrop>()
        .init_resource::<OwnPicture>()
        .add_systems(Startup, raise)
        .add_systems(Update, (backdrop::open, tint).chain().in_set(VedutaSystems::Show))
        .add_systems(Update, follow.in_set(VedutaSystems::Show));
}

fn raise(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<SkyMaterial>>) {
    let inside_out = Sphere::new(RADIUS_M).mesh().uv(32, 18).with_inverted_winding();
    let Ok(mesh) = inside_out else { return };
    commands.spawn((
        Dome,
        Mesh3d(meshes.add(mesh)),
        MeshMaterial3d(materials.add(SkyMaterial { uniform: SkyUniform::default(), picture: None })),
        NotShadowCaster,
        NotShadowReceiver,
        NoFrustumCulling,
    ));
}

fn tint(
    light: Res<Light>,
    weather: Res<Weather>,
    time: Res<Time>,
    (wished, own, images): (Res<Backdrop>, Res<OwnPicture>, Res<Assets<Image>>),
    city: Option<Res<City>>,
    viewers: Query<&Eye, With<Viewer>>,
    mut materials: ResMut<Assets<SkyMaterial>>,
    dome: Query<&MeshMaterial3d<SkyMaterial>, With<Dome>>,
) {
    let picture = backdrop::picture(&wished, &own, &images);
    let eye = viewers.iter().next().filter(|_| *wished == Backdrop::OfCity && picture.is_none());
    let slopes = city.zip(eye).map_or_else(Slopes::default, |(city, eye)| backdrop::slopes(&city, eye));
    for handle in &dome {
        let p = light.palette;
        let uniform = SkyUniform {
            zenith: p.zenith.extend(p.sky),
            horizon: p.horizon.extend(p.night),
            sun: light.sun.direction().extend((time.elapsed_secs() * 0.5).floor() * 0.004),
            key: p.key.extend(weather.clouds.clamp(0.0, 1.0)),
            backdrop: slopes,
            picture: Vec4::X * picture.map_or(0.0, |(_, high)| high),
        };
        let picture = picture.map(|(handle, _)| handle.clone());
        if materials.get(handle).is_some_and(|m| m.uniform != uniform || m.picture != picture)
            && let Some(mut material) = materials.get_mut(handle)
        {
            (material.uniform, material.picture) = (uniform, picture);
        }
    }
}

fn follow(viewers: Query<&Transform, (With<Viewer>, Without<Dome>)>, mut dome: Query<&mut Transform, With<Dome>>) {
    let Some(viewer) = viewers.iter().next() else { return };
    for mut transform in &mut dome {
        transform.set_if_neq(Transform::from_translation(viewer.translation));
    }
}
