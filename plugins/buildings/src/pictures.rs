//! Pictures of painted façades, as textures: a layer for each section of a cell's painted walls.

use bevy::asset::RenderAssetUsages;
use bevy::image::{ImageAddressMode, ImageFilterMode, ImageSampler, ImageSamplerDescriptor};
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension};
use veduta_city::{FacadeSheet, PictureFile};
use veduta_ecs::{CellContent, CellPictures};
use veduta_texture::{PICTURE_SIDE, PictureError, PictureLayer, Pixels, compose, decode_picture, put_together};

/// What level 2 knows: small textures, put together. `None` of a cell that nobody painted.
pub(crate) fn coarse(sheet: &FacadeSheet, in_blocks: bool) -> Option<Image> {
    array(sections(sheet).iter().filter_map(PictureLayer::new), in_blocks)
}

/// What level 3 shows, and what is wrong with those façades that are not shown: they stay as they are at level 2.
pub(crate) fn fine(sheet: &FacadeSheet, pictures: &[PictureFile], in_blocks: bool) -> (Option<Image>, Vec<String>) {
    if pictures.len() != sheet.pictures() {
        let message = format!("it has {} pictures of {}: bake the city again", pictures.len(), sheet.pictures());
        return (None, vec![message]);
    }
    let (mut layers, mut errors, mut rest) = (Vec::new(), Vec::new(), pictures);
    for wall in &sheet.painted {
        let (own, others) = rest.split_at(wall.painted.pictures().min(rest.len()));
        rest = others;
        let decoded: Result<Vec<Pixels>, PictureError> = own.iter().map(|picture| decode_picture(&picture.0)).collect();
        let composed = decoded.map(|pictures| compose(&wall.painted, &pictures).unwrap_or_default());
        let sections = composed.unwrap_or_else(|error| {
            errors.push(format!("wall {}: {error}", wall.wall));
            put_together(&wall.painted).unwrap_or_default().iter().map(enlarged).collect()
        });
        layers.extend(sections.iter().filter_map(PictureLayer::new));
    }
    if errors.len() == sheet.painted.len() { (None, errors) } else { (array(layers.into_iter(), in_blocks), errors) }
}

fn sections(sheet: &FacadeSheet) -> Vec<Pixels> {
    sheet.painted.iter().filter_map(|wall| put_together(&wall.painted)).flatten().collect()
}

/// A coarse picture with as many texels as a fine one.
fn enlarged(coarse: &Pixels) -> Pixels {
    let times = (PICTURE_SIDE / coarse.width).max(1);
    let texel = |i: usize| coarse.texels[i / PICTURE_SIDE / times * coarse.width + i % PICTURE_SIDE / times];
    Pixels { width: PICTURE_SIDE, texels: (0..PICTURE_SIDE * PICTURE_SIDE).map(texel).collect() }
}

/// An array texture of layers of one size.
fn array(layers: impl Iterator<Item = PictureLayer>, in_blocks: bool) -> Option<Image> {
    let mut layers: Vec<PictureLayer> = layers.collect();
    // On GLES an array of one layer becomes a plain texture, and a square one of six a cube.
    while layers.len() == 1 || (!layers.is_empty() && layers.len().is_multiple_of(6)) {
        layers.push(layers[0].clone());
    }
    let first = layers.first()?;
    let (size, mips) = (first.size, first.mips());
    let format = if in_blocks { TextureFormat::Bc1RgbaUnormSrgb } else { TextureFormat::Rgba8UnormSrgb };
    let extent = Extent3d { width: size, height: size, depth_or_array_layers: layers.len() as u32 };
    let mut image = Image::new_uninit(extent, TextureDimension::D2, format, RenderAssetUsages::RENDER_WORLD);
    image.data = Some(layers.into_iter().flat_map(|layer| if in_blocks { layer.in_blocks() } else { layer.texels }).collect());
    image.texture_descriptor.mip_level_count = mips;
    image.texture_view_descriptor =
        Some(TextureViewDescriptor { dimension: Some(TextureViewDimension::D2Array), ..TextureViewDescriptor::default() });
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: ImageAddressMode::ClampToEdge,
        address_mode_v: ImageAddressMode::ClampToEdge,
        mag_filter: ImageFilterMode::Linear,
        min_filter: ImageFilterMode::Linear,
        mipmap_filter: ImageFilterMode::Linear,
        ..ImageSamplerDescriptor::linear()
    });
    Some(image)
}

/// Lets go of pictures whose level was taken away.
pub(crate) fn forget(mut commands: Commands, mut cells: Query<(Entity, &CellContent, &mut CellPictures), Changed<CellContent>>) {
    for (entity, content, mut pictures) in &mut cells {
        if content.sheet.is_none() {
            commands.entity(entity).remove::<CellPictures>();
        } else if content.pictures.is_none() && pictures.fine.is_some() {
            pictures.fine = None;
        }
    }
}
