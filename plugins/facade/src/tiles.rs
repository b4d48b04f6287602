use std::sync::Arc;

use bevy::asset::RenderAssetUsages;
use bevy::image::{ImageAddressMode, ImageFilterMode, ImageSampler, ImageSamplerDescriptor};
use bevy::prelude::*;
use bevy::render::render_resource::{
    Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension, WgpuFeatures,
};
use bevy::render::renderer::{RenderAdapterInfo, RenderDevice};
use bevy::tasks::{AsyncComputeTaskPool, Task, block_on, futures::check_ready};
use veduta_city::Tile;
use veduta_ecs::MaterialsProvided;
use veduta_texture::Workshop;

/// How finely tiles are painted and sampled. Read when painting begins and, for anisotropy, when it ends.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq)]
pub struct TileQuality {
    /// Edge of a tile in texels: a power of two from 32 to 1024.
    pub texels: u32,
    /// Anisotropic samples, 1 to 16. Software renderers pay dearly for more than one.
    pub anisotropy: u16,
    /// What the GPU is given.
    pub format: TileFormat,
}

impl Default for TileQuality {
    fn default() -> Self {
        Self { texels: 256, anisotropy: 4, format: TileFormat::default() }
    }
}

/// What the GPU is given of a tile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TileFormat {
    /// Blocks, but plain texels where it cannot read blocks, and where there is none: a processor undoes blocks for every pixel anew.
    #[default]
    Fitting,
    /// Plain texels, 8 bytes each in both pictures.
    Texels,
    /// Blocks, 2 bytes a texel, wherever they can be read.
    Blocks,
}

/// Where tiles are painted.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Painting {
    /// On the task pool; cells are awaited meanwhile.
    #[default]
    Pool,
    /// Before the first frame: for tests and films. Not for browsers, which may not wait.
    Inline,
}

/// Seed of the stock tiles: one workshop for every city, so that the same tiles are painted everywhere.
const WORKSHOP_SEED: u64 = 1;

/// Both pictures of all tiles, as the GPU is given them.
pub(crate) struct Painted {
    size: u32,
    mips: u32,
    in_blocks: bool,
    colour: Vec<u8>,
    normal: Vec<u8>,
}

/// The pictures in the making.
#[derive(Resource)]
pub(crate) struct Easel(Task<Painted>);

/// Begins to paint, a tile at a time.
pub(crate) fn set_up(
    mut commands: Commands,
    quality: Res<TileQuality>,
    device: Option<Res<RenderDevice>>,
    adapter: Option<Res<RenderAdapterInfo>>,
    mut provided: ResMut<MaterialsProvided>,
) {
    let can_read = device.is_some_and(|device| device.features().contains(WgpuFeatures::TEXTURE_COMPRESSION_BC));
    let is_processor = adapter.is_some_and(|adapter| format!("{:?}", adapter.device_type) == "Cpu");
    let in_blocks = match quality.format {
        TileFormat::Fitting => can_read && !is_processor,
        TileFormat::Texels => false,
        TileFormat::Blocks => can_read,
    };
    provided.reads_blocks = in_blocks;
    let texels = quality.texels;
    let pool = AsyncComputeTaskPool::get();
    commands.insert_resource(Easel(pool.spawn(async move {
        let workshop = Arc::new(Workshop::new(texels, WORKSHOP_SEED));
        let (size, mips) = (workshop.size(), workshop.mips());
        let tasks: Vec<Task<_>> = Tile::all()
            .map(|tile| {
                let workshop = Arc::clone(&workshop);
                pool.spawn(async move {
                    let layer = workshop.paint(tile);
                    if in_blocks {
                        let blocks = layer.in_blocks();
                        return (blocks.colour, blocks.normal);
                    }
                    (layer.colour, layer.normal)
                })
            })
            .collect();
        let mut painted = Painted { size, mips, in_blocks, colour: Vec::new(), normal: Vec::new() };
        for task in tasks {
            let (colour, normal) = task.await;
            painted.colour.extend(colour);
            painted.normal.extend(normal);
        }
        painted
    })));
}

/// Takes the pictures off the easel when they are ready.
pub(crate) fn take(easel: &mut Easel, painting: Painting) -> Option<Painted> {
    match painting {
        Painting::Pool => check_ready(&mut easel.0),
        Painting::Inline => Some(block_on(&mut easel.0)),
    }
}

impl Painted {
    /// The two array textures: colour, and normals.
    pub(crate) fn images(self, anisotropy: u16) -> [Image; 2] {
        let (colour, normal) = if self.in_blocks {
            (TextureFormat::Bc3RgbaUnormSrgb, TextureFormat::Bc3RgbaUnorm)
        } else {
            (TextureFormat::Rgba8UnormSrgb, TextureFormat::Rgba8Unorm)
        };
        let extent = Extent3d { width: self.size, height: self.size, depth_or_array_layers: Tile::COUNT as u32 };
        let array = |data: Vec<u8>, format| {
            let mut image = Image::new_uninit(extent, TextureDimension::D2, format, RenderAssetUsages::RENDER_WORLD);
            image.data = Some(data);
            image.texture_descriptor.mip_level_count = self.mips;
            image.texture_view_descriptor =
                Some(TextureViewDescriptor { dimension: Some(TextureViewDimension::D2Array), ..TextureViewDescriptor::default() });
            image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
                address_mode_u: ImageAddressMode::Repeat,
                address_mode_v: ImageAddressMode::Repeat,
                mag_filter: ImageFilterMode::Linear,
                min_filter: ImageFilterMode::Linear,
                mipmap_filter: ImageFilterMode::Linear,
                anisotropy_clamp: anisotropy.clamp(1, 16),
                ..ImageSamplerDescriptor::linear()
            });
            image
        };
        [array(self.colour, colour), array(self.normal, normal)]
    }
}
