use bevy::asset::embedded_asset;
use bevy::mesh::MeshVertexBufferLayoutRef;
use bevy::pbr::{
    ExtendedMaterial, MaterialExtension, MaterialExtensionKey, MaterialExtensionPipeline, MaterialPipeline, MaterialPipelineKey,
};
use bevy::prelude::*;
use bevy::render::render_resource::{AsBindGroup, RenderPipelineDescriptor, ShaderType, SpecializedMeshPipelineError};
use bevy::shader::{ShaderRef, load_shader_library};
use veduta_city::Life;
use veduta_ecs::{Daylight, Weather};

use crate::wind::Wind;

/// Four numbers each that a mesh's parts are moved by: three for every bird, one for every chimney.
pub(crate) const NUMBERS: usize = 3 * Life::MOST_PIGEONS as usize;

/// Light and wind, as the shaders read them.
#[derive(ShaderType, Debug, Clone, Copy, PartialEq, Default)]
pub struct LifeUniform {
    fill: [Vec4; 3],
    wind: Vec4,
    zenith: Vec4,
    horizon: Vec4,
}

impl LifeUniform {
    /// The light and wind of a moment.
    pub(crate) fn of(light: &Daylight, weather: &Weather) -> Self {
        let wind = Wind::of(weather);
        let fill = light.fill.map(|colour| colour.extend(light.night));
        let to = Vec2::new(wind.toward.x as f32, -wind.toward.y as f32);
        let wind = Vec4::new(to.x, to.y, wind.mean_m_s as f32, 0.0);
        Self { fill, wind, zenith: light.zenith.extend(0.0), horizon: light.horizon.extend(0.0) }
    }

    /// Whether the difference can be seen: a change costs every material a new bind group.
    pub(crate) fn differs(&self, other: &Self) -> bool {
        let bright = self.fill[0].truncate().max_element().max(1.0);
        let off = |a: Vec4, b: Vec4, unit: f32| (a - b).truncate().abs().max_element() > 0.01 * unit || (a.w - b.w).abs() > 0.01;
        self.fill.iter().zip(&other.fill).any(|(a, b)| off(*a, *b, bright))
            || off(self.wind, other.wind, 1.0)
            || off(self.zenith, other.zenith, bright)
            || off(self.horizon, other.horizon, bright)
    }
}

/// What the shaders are told of each part of a mesh.
#[derive(ShaderType, Debug, Clone, Copy, PartialEq)]
pub struct Told {
    /// Numbers, as the mesh's parts count them.
    pub(crate) numbers: [Vec4; NUMBERS],
}

impl Default for Told {
    fn default() -> Self {
        Self { numbers: [Vec4::ZERO; NUMBERS] }
    }
}

/// The material of birds, flags, signs, dials and figures.
pub type SolidMaterial = ExtendedMaterial<StandardMaterial, SolidExtension>;

/// Moves what is solid, and lights it as the city is lit.
#[derive(Asset, TypePath, AsBindGroup, Debug, Clone, Default)]
#[bind_group_data(SolidKey)]
pub struct SolidExtension {
    #[uniform(100)]
    pub(crate) life: LifeUniform,
    #[uniform(101)]
    pub(crate) told: Told,
    pub(crate) is_birds: bool,
    pub(crate) is_plain: bool,
}

/// Which shader a material takes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SolidKey {
    is_birds: bool,
    is_plain: bool,
}

impl From<&SolidExtension> for SolidKey {
    fn from(extension: &SolidExtension) -> Self {
        Self { is_birds: extension.is_birds, is_plain: extension.is_plain }
    }
}

/// Where the shader of shadows expects normals, along which cloth and birds are moved.
const NORMAL_LOCATION: u32 = 8;

impl MaterialExtension for SolidExtension {
    fn vertex_shader() -> ShaderRef {
        "embedded://veduta_life/shaders/solid.wgsl".into()
    }

    fn fragment_shader() -> ShaderRef {
        "embedded://veduta_life/shaders/solid.wgsl".into()
    }

    fn prepass_vertex_shader() -> ShaderRef {
        "embedded://veduta_life/shaders/solid_shadow.wgsl".into()
    }

    // Little things in motion: no pixel is worth drawing twice.
    fn enable_prepass() -> bool {
        false
    }

    fn specialize(
        _: &MaterialExtensionPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        layout: &MeshVertexBufferLayoutRef,
        key: MaterialExtensionKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        let SolidKey { is_birds, is_plain } = key.bind_group_data;
        let normals = layout.0.get_layout(&[Mesh::ATTRIBUTE_NORMAL.at_shader_location(NORMAL_LOCATION)])?;
        if let Some(buffer) = descriptor.vertex.buffers.first_mut() {
            buffer.attributes.extend(normals.attributes);
        }
        if is_birds {
            descriptor.vertex.shader_defs.push("BIRDS".into());
        }
        if let Some(fragment) = &mut descriptor.fragment {
            let defs = [(is_birds, "BIRDS"), (is_plain, "PLAIN_LIGHT")];
            fragment.shader_defs.extend(defs.into_iter().filter(|def| def.0).map(|def| def.1.into()));
        }
        Ok(())
    }
}

/// The material of smoke, water, and the shade under birds.
#[derive(Asset, TypePath, AsBindGroup, Debug, Clone, Default)]
pub struct MistMaterial {
    #[uniform(100)]
    pub(crate) life: LifeUniform,
    #[uniform(101)]
    pub(crate) told: Told,
}

impl Material for MistMaterial {
    fn vertex_shader() -> ShaderRef {
        "embedded://veduta_life/shaders/mist.wgsl".into()
    }

    fn fragment_shader() -> ShaderRef {
        "embedded://veduta_life/shaders/mist.wgsl".into()
    }

    fn alpha_mode(&self) -> AlphaMode {
        AlphaMode::Blend
    }

    fn enable_prepass() -> bool {
        false
    }

    fn enable_shadows() -> bool {
        false
    }

    fn specialize(
        _: &MaterialPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        _: &MeshVertexBufferLayoutRef,
        _: MaterialPipelineKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        // Its pictures turn to the eye, or lie on the ground and are seen from both sides.
        descriptor.primitive.cull_mode = None;
        Ok(())
    }
}

/// A solid material: of birds, or of what stands or hangs.
pub(crate) fn solid(life: LifeUniform, is_birds: bool, is_plain: bool) -> SolidMaterial {
    SolidMaterial {
        base: StandardMaterial { double_sided: true, cull_mode: None, reflectance: 0.3, ..default() },
        extension: SolidExtension { life, told: Told::default(), is_birds, is_plain },
    }
}

pub(crate) fn build(app: &mut App) {
    load_shader_library!(app, "shaders/motion.wgsl");
    embedded_asset!(app, "shaders/solid.wgsl");
    embedded_asset!(app, "shaders/solid_shadow.wgsl");
    embedded_asset!(app, "shaders/mist.wgsl");
    app.add_plugins((MaterialPlugin::<SolidMaterial>::default(), MaterialPlugin::<MistMaterial>::default()));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wind::GUSTS;

    const MOTION: &str = include_str!("shaders/motion.wgsl");

    #[test]
    fn shaders_and_processor_know_the_same_wind_and_count_alike() {
        let swells = GUSTS.map(|(rate, share)| format!("vec2<f32>({rate}, {share})"));
        assert!(swells.iter().all(|swell| MOTION.contains(swell.as_str())), "{swells:?}");
        for shader in
            [include_str!("shaders/solid.wgsl"), include_str!("shaders/solid_shadow.wgsl"), include_str!("shaders/mist.wgsl")]
        {
            assert!(shader.contains(&format!("array<vec4<f32>, {NUMBERS}>")));
        }
    }

    #[test]
    fn what_is_told_fits_into_the_smallest_uniform_of_webgl() {
        let bytes = |size: core::num::NonZeroU64| size.get();
        assert!(bytes(Told::min_size()) + bytes(LifeUniform::min_size()) < 16_384);
    }

    #[test]
    fn only_what_is_seen_is_told_anew() {
        let (light, weather) = (Daylight::default(), Weather::default());
        let now = LifeUniform::of(&light, &weather);
        assert!(!now.differs(&now));
        assert!(!now.differs(&LifeUniform::of(&Daylight { zenith: light.zenith * 1.0001, ..light }, &weather)));
        assert!(now.differs(&LifeUniform::of(&Daylight { night: 0.5, ..light }, &weather)));
        assert!(now.differs(&LifeUniform::of(&light, &Weather { wind_m_s: 9.0, ..weather })));
    }
}
