//! Paints all tiles and writes pictures: every tile on its wall, mock façades, surfaces laid two by two, a few tiles close up,
//! cards of trees cut out.
//!
//! ```text
//! cargo run --release -p veduta-texture --example contact_sheet [FOLDER] [SIZE] [SEED]
//! ```

use std::path::PathBuf;

use image::{Rgb as Pixel, RgbImage};
use veduta_city::{Opening, Rgb, SurfaceKind, Tile};
use veduta_texture::{MODULATION_UNIT, TileArray, paint_tiles, unpacked};

/// Where the light comes from in these pictures: right, up, out of the wall.
const SUN: [f32; 3] = [-0.45, 0.55, 0.70];

fn encode(linear: f32) -> u8 {
    let c = linear.clamp(0.0, 1.0);
    let s = if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
    (s * 255.0 + 0.5) as u8
}

/// What the shader would show of a texel: albedo and, if `lit`, the light on its normal.
fn shown(tile: Tile, colour: &[u8], normal: &[u8], wall: Rgb, lit: bool) -> Pixel<u8> {
    let [r, g, b] = Rgb(colour[0], colour[1], colour[2]).to_linear();
    let (share, wall) = (f32::from(colour[3]) / 255.0, wall.to_linear());
    let (n, _) = unpacked(tile, [normal[0], normal[1], normal[2], normal[3]]);
    let facing = (n[0] * SUN[0] + n[1] * SUN[1] + n[2] * SUN[2]).max(0.0);
    let light = if lit { 0.3 + 0.75 * facing / SUN[2] * 0.95 } else { 1.0 };
    Pixel([0, 1, 2].map(|i| {
        let c = [r, g, b][i];
        encode((c * (1.0 - share) + c / MODULATION_UNIT * wall[i] * share) * light)
    }))
}

/// Lays a tile over a rectangle of the picture, `repeat` times each way.
fn lay(
    picture: &mut RgbImage,
    (left, top): (u32, u32),
    (width, height): (u32, u32),
    tiles: &TileArray,
    tile: Tile,
    wall: Rgb,
    lit: bool,
    repeat: u32,
) {
    // The mip whose texels are nearest to the picture's pixels.
    let mip = (0..tiles.mips).rev().find(|m| (tiles.size >> m) * repeat >= width.min(height)).unwrap_or(0);
    let side = tiles.size >> mip;
    let layer = tile.index() as u32;
    let (Some(colour), Some(normal)) = (tiles.colour_of(layer, mip), tiles.normal_of(layer, mip)) else { return };
    for y in 0..height {
        for x in 0..width {
            let at = (((y * side * repeat / height) % side) * side + (x * side * repeat / width) % side) as usize * 4;
            picture.put_pixel(left + x, top + y, shown(tile, &colour[at..at + 4], &normal[at..at + 4], wall, lit));
        }
    }
}

fn wall_of(tile: Tile) -> Rgb {
    match tile {
        Tile::RoofTile => Rgb(0xA2, 0x4B, 0x33),
        Tile::Slate => Rgb(0x4A, 0x4F, 0x55),
        Tile::Metal => Rgb(0x6F, 0x9B, 0x86),
        Tile::Stone | Tile::Carved => Rgb(0xB7, 0x9F, 0x79),
        Tile::Glass => Rgb(0x5C, 0x6E, 0x7A),
        Tile::Wood => Rgb(0x7A, 0x5A, 0x3C),
        Tile::Leaves => Rgb(0x5E, 0x7A, 0x3E),
        _ => Rgb(0xD9, 0xB3, 0x6C),
    }
}

fn sheet(tiles: &TileArray) -> RgbImage {
    let (columns, side, gap) = (8, 256, 6);
    let rows = (Tile::COUNT as u32).div_ceil(columns);
    let mut picture = RgbImage::from_pixel(columns * (side + gap), rows * (side + gap), Pixel([60, 60, 62]));
    for (i, tile) in Tile::all().enumerate() {
        let at = ((i as u32 % columns) * (side + gap), (i as u32 / columns) * (side + gap));
        lay(&mut picture, at, (side, side), tiles, tile, wall_of(tile), false, 1);
    }
    picture
}

/// Five bays by four storeys, twice: flat, and lit from the upper left.
fn facade(tiles: &TileArray, bay: u32, wall: Rgb) -> RgbImage {
    use Opening::{AtticWindow, CorniceWindow, FramedWindow, PedimentWindow, Portal, Shop, Window};
    let storeys = [
        ([AtticWindow; 5], 2.2),
        ([FramedWindow; 5], 3.3),
        ([CorniceWindow, CorniceWindow, PedimentWindow, CorniceWindow, CorniceWindow], 3.8),
        ([Shop, Shop, Portal, Window, Window], 4.2),
    ];
    let metre = bay as f32 / 2.8;
    let height: f32 = storeys.iter().map(|s| s.1 * metre).sum();
    let ground = (1.6 * metre) as u32;
    let mut picture = RgbImage::new(bay * 10, height as u32 + ground);
    for (pass, lit) in [(0, false), (1, true)] {
        let mut top = 0.0;
        for (openings, storey_m) in storeys {
            let bottom = top + storey_m * metre;
            for (i, opening) in openings.into_iter().enumerate() {
                let at = (bay * (5 * pass + i as u32), top as u32);
                lay(&mut picture, at, (bay, bottom as u32 - top as u32), tiles, Tile::of_opening(opening), wall, lit, 1);
            }
            top = bottom;
        }
        for i in 0..5 {
            let at = (bay * (5 * pass) + i * bay, height as u32);
            lay(&mut picture, at, (bay, ground), tiles, Tile::Ground(SurfaceKind::Cobbles), wall, lit, 1);
        }
    }
    picture
}

/// Surfaces laid two by two, lit, to show seams and normals.
fn surfaces(tiles: &TileArray) -> RgbImage {
    let list: Vec<Tile> = Tile::all().filter(|t| t.opening().is_none() && !t.is_card()).collect();
    let (columns, side, gap) = (4, 384, 6);
    let rows = (list.len() as u32).div_ceil(columns);
    let mut picture = RgbImage::from_pixel(columns * (side + gap), rows * (side + gap), Pixel([60, 60, 62]));
    for (i, &tile) in list.iter().enumerate() {
        let at = ((i as u32 % columns) * (side + gap), (i as u32 / columns) * (side + gap));
        lay(&mut picture, at, (side, side), tiles, tile, wall_of(tile), true, 2);
    }
    picture
}

/// Cards before the sky, lit and cut out: large, and as small as they are far away.
fn cards(tiles: &TileArray) -> RgbImage {
    let list: Vec<Tile> = Tile::all().filter(|tile| tile.is_card()).collect();
    let (columns, side) = (4, 384);
    let rows = (list.len() as u32).div_ceil(columns);
    let mut picture = RgbImage::from_pixel(columns * side * 3 / 2, rows * side, Pixel([168, 190, 212]));
    for (i, &tile) in list.iter().enumerate() {
        let (left, top) = ((i as u32 % columns) * side * 3 / 2, (i as u32 / columns) * side);
        let (mut at, mut drawn) = ((left, top), side);
        for mip in 0..tiles.mips.min(6) {
            let layer = tile.index() as u32;
            let (Some(colour), Some(normal)) = (tiles.colour_of(layer, mip), tiles.normal_of(layer, mip)) else { continue };
            let texels = tiles.size >> mip;
            for (x, y) in (0..drawn).flat_map(|y| (0..drawn).map(move |x| (x, y))) {
                let texel = ((y * texels / drawn) * texels + x * texels / drawn) as usize * 4;
                if normal[texel + 3] >= 128 {
                    let pixel = shown(tile, &colour[texel..texel + 4], &normal[texel..texel + 4], Rgb(0x6C, 0x86, 0x4A), true);
                    picture.put_pixel(at.0 + x, at.1 + y, pixel);
                }
            }
            at = if mip == 0 { (left + side, top) } else { (at.0, at.1 + drawn) };
            drawn /= 2;
        }
    }
    picture
}

/// A few tiles at their full size, lit, as one sees them from two metres.
fn close_ups(seed: u64) -> RgbImage {
    let side = 512;
    let tiles = paint_tiles(side, seed);
    let list = [
        Tile::Bay(Opening::PedimentWindow),
        Tile::Bay(Opening::Portal),
        Tile::Bay(Opening::LancetWindow),
        Tile::RoofTile,
        Tile::Ground(SurfaceKind::Cobbles),
        Tile::Bay(Opening::FramedWindow),
    ];
    let mut picture = RgbImage::new(side * 3, side * 2);
    for (i, tile) in list.into_iter().enumerate() {
        let at = (i as u32 % 3 * side, i as u32 / 3 * side);
        lay(&mut picture, at, (side, side), &tiles, tile, wall_of(tile), true, 1);
    }
    picture
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words = std::env::args().skip(1);
    let folder = PathBuf::from(words.next().unwrap_or_else(|| "target/contact_sheet".to_owned()));
    let size = words.next().map_or(Ok(256), |w| w.parse())?;
    let seed = words.next().map_or(Ok(7), |w| w.parse())?;
    std::fs::create_dir_all(&folder)?;
    for size in [128, 256, 512] {
        let started = std::time::Instant::now();
        let tiles = paint_tiles(size, seed);
        println!("{size} px: {:?}, {} bytes a picture", started.elapsed(), tiles.colour.len());
    }
    let tiles = paint_tiles(size, seed);
    let bay = size.min(256);
    sheet(&tiles).save(folder.join("sheet.png"))?;
    facade(&tiles, 128, Rgb(0xD9, 0xB3, 0x6C)).save(folder.join("facade_ochre.png"))?;
    facade(&tiles, bay, Rgb(0xBF, 0xCB, 0x9F)).save(folder.join("facade_pistachio.png"))?;
    close_ups(seed).save(folder.join("close_ups.png"))?;
    surfaces(&tiles).save(folder.join("surfaces.png"))?;
    cards(&tiles).save(folder.join("cards.png"))?;
    println!("pictures are in {}", folder.display());
    Ok(())
}
