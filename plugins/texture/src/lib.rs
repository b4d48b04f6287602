//! The texture workshop: paints every [`Tile`] from a seed, so that a city needs no picture files.
//!
//! ```text
//!  Tile, seed ──► canvas (metres; colour, relief, roughness) ──► colour + alpha  ─┐
//!                 shapes as signed distances                 └─► normal + rough. ─┴─► mips ──► Layer ──► blocks (BC3)
//! ```
//!
//! # Use
//! 1. Paint all tiles once with [`paint_tiles`], or one by one on many threads with a [`Workshop`], off the main thread.
//! 2. Give [`TileArray::colour`] (sRGB) and [`TileArray::normal`] (linear) to two array textures of [`TileArray::layers`]
//!    layers and [`TileArray::mips`] levels.
//! 3. Sample layer [`Tile::index`] and compute the albedo, all in linear light, as
//!    `mix(c.rgb, c.rgb / MODULATION_UNIT * vertex_colour, c.a)`.
//!
//! ```
//! use veduta_city::{Opening, Tile};
//! let tiles = veduta_texture::paint_tiles(32, 7);
//! assert_eq!((tiles.layers, tiles.mips), (Tile::COUNT as u32, 6));
//! let window = Tile::Bay(Opening::FramedWindow).index() as u32;
//! assert_eq!(tiles.colour_of(window, 0).map(<[u8]>::len), Some(32 * 32 * 4));
//! ```
//!
//! # What the bytes mean
//! | picture | r g b | a |
//! |---|---|---|
//! | colour | sRGB. Where a = 1: modulation of the wall's colour, [`MODULATION_UNIT`] (linear 0.5, byte [`NEUTRAL_BYTE`]) leaves it unchanged. Where a = 0: the albedo itself. Between: the mixture above | share of the wall's colour, linear |
//!
//! The normal picture holds a tangent-space normal, x right, y up in the image, z out of the wall and never behind it, so that x and y
//! tell it: 128 is 0, 255 is 1.
//!
//! | normal | r | g, b | a |
//! |---|---|---|---|
//! | of surfaces | perceptual roughness | y | x |
//! | of cards ([`Tile::is_card`]) | x | y | share of the pixel that they cover |
//!
//! So blocks ([`Layer::in_blocks`]), in which alpha is told apart from the rest, keep what is seen most.
//!
//! Glass, timber, stone and ground stand in their own colours; plaster and roof coverings are tinted; mouldings lie between:
//! the wall's colour drawn towards a warm white. Bays are painted with the shade of reveals, cornices and sills, light
//! from the upper left, for as long as nothing casts it in truth; their openings' depth shows in the normals only as far as
//! a picture can. Every bay has the same plaster at its border, so that neighbours join. Openings of a ground floor (doors,
//! portals, gates, shops, arcades) stand on the tile's lower edge.
//!
//! # Why it looks the same from afar
//! Mips are averaged over what the shader makes of a texel, `own + tint × wall`, which is linear in both parts; a texel's
//! alpha is then the tinted part's share of luminance. A window's dark glass therefore does not bleach the wall around it, as an
//! average of alpha would. Slopes that averaging takes from the normals come back as roughness. Cards are averaged by what they cover,
//! and their trunks stay as broad as a pixel.
//!
//! # Limits
//! There are blocks for desktops; what reads none of them (phones in a browser) is given plain texels.
//! Sizes are powers of two from 32 to 1024; others are rounded to the nearest such. Bilinear filtering between a tinted and an
//! untinted texel is right only to first order; the error stays within one texel. One tile of a kind: variety comes from the
//! vertex colours.
//!
//! # Rejected
//! Photographs (licences, megabytes, one light for ever); a noise crate (none tiles with anisotropic periods and promises the
//! same bits on every platform); painting on the GPU (baking and tests have none).

mod bay;
mod bc1;
mod blocks;
mod canvas;
mod card;
mod door;
mod glass;
mod hole;
mod letter;
mod mips;
mod moulding;
mod noise;
mod painted;
mod paving;
mod roof;
mod soil;
mod stone;
mod street;
mod timber;
mod tower;
mod window;

use veduta_city::draw::Draw;
use veduta_city::{Id, Opening, SurfaceKind, Tile};

pub use blocks::LayerBlocks;
use canvas::Canvas;
use card::{Card, Leaf};
use mips::Encoder;
pub use painted::{
    CutError, CutFacade, MOST_FLATS_BYTES, PICTURE_SIDE, PICTURE_STORED_CAP, PictureError, PictureLayer, Pixels, compose,
    cut_facade, decode_picture, keep_flats, put_together,
};

/// The modulation that leaves the wall's colour unchanged, in linear light: a stored modulation `m` is `m / 2`, so that it can
/// brighten as well as darken.
pub const MODULATION_UNIT: f32 = 0.5;

/// The sRGB byte of [`MODULATION_UNIT`].
pub const NEUTRAL_BYTE: u8 = 188;

/// Smallest and largest side of a tile in pixels.
pub const SIZES: core::ops::RangeInclusive<u32> = 32..=1024;

/// All tiles with their mip chains, ready for two array textures.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TileArray {
    /// Side of a tile in pixels at mip 0.
    pub size: u32,
    /// Number of tiles, [`Tile::COUNT`]; tile `t` is layer `t.index()`.
    pub layers: u32,
    /// Number of mip levels, down to one pixel.
    pub mips: u32,
    /// RGBA8, rgb in sRGB, alpha linear. Layer by layer, within a layer mip by mip, within a mip row by row from the top
    /// (wgpu's `TextureDataOrder::LayerMajor`).
    pub colour: Vec<u8>,
    /// RGBA8 linear: tangent normal, and roughness or the cover of cards; see [`unpacked`]. Laid out like `colour`.
    pub normal: Vec<u8>,
}

impl TileArray {
    /// Bytes of one layer with its mips, in each of the two pictures.
    #[must_use]
    pub fn layer_bytes(&self) -> usize {
        (0..self.mips).map(|mip| self.mip_bytes(mip)).sum()
    }

    /// Colour of one layer at one mip; `None` beyond the last.
    #[must_use]
    pub fn colour_of(&self, layer: u32, mip: u32) -> Option<&[u8]> {
        self.colour.get(self.range(layer, mip)?)
    }

    /// Normal and roughness (or cover) of one layer at one mip; `None` beyond the last.
    #[must_use]
    pub fn normal_of(&self, layer: u32, mip: u32) -> Option<&[u8]> {
        self.normal.get(self.range(layer, mip)?)
    }

    fn mip_bytes(&self, mip: u32) -> usize {
        let side = (self.size >> mip).max(1) as usize;
        side * side * 4
    }

    fn range(&self, layer: u32, mip: u32) -> Option<core::ops::Range<usize>> {
        if layer >= self.layers || mip >= self.mips {
            return None;
        }
        let start = layer as usize * self.layer_bytes() + (0..mip).map(|m| self.mip_bytes(m)).sum::<usize>();
        Some(start..start + self.mip_bytes(mip))
    }
}

/// The nearest side that can be painted: a power of two within [`SIZES`].
#[must_use]
pub fn paintable_size(size: u32) -> u32 {
    let size = size.clamp(*SIZES.start(), *SIZES.end());
    let above = size.next_power_of_two();
    if above - size > size - above / 2 { above / 2 } else { above }
}

/// Paints all tiles at `size` × `size` pixels (see [`paintable_size`]) with full mip chains. The same seed gives the same
/// bytes.
#[must_use]
pub fn paint_tiles(size: u32, seed: u64) -> TileArray {
    let workshop = Workshop::new(size, seed);
    let layers: Vec<Layer> = Tile::all().map(|tile| workshop.paint(tile)).collect();
    let chain = |of: fn(&Layer) -> &Vec<u8>| layers.iter().flat_map(of).copied().collect();
    TileArray {
        size: workshop.size,
        layers: Tile::COUNT as u32,
        mips: workshop.mips(),
        colour: chain(|layer| &layer.colour),
        normal: chain(|layer| &layer.normal),
    }
}

/// Colour and normal (with roughness, or cover) of one tile at mip 0, row by row from the top; pixels as in [`TileArray`].
#[must_use]
pub fn paint_tile(tile: Tile, size: u32, seed: u64) -> (Vec<[u8; 4]>, Vec<[u8; 4]>) {
    let workshop = Workshop::new(size, seed);
    let encoder = &workshop.encoder;
    match workshop.draw(tile) {
        Drawing::Card(card) => card.mips[0].iter().map(|dot| dot.bytes(encoder).into()).unzip(),
        Drawing::Canvas(canvas) => {
            let colours = canvas.texels.iter().map(|t| encoder.colour(t)).collect();
            (colours, mips::facets(&canvas).iter().map(mips::Facet::bytes).collect())
        }
    }
}

/// What a texel of a tile's normal picture tells: the tangent-space normal, and the roughness or, of cards, the cover.
#[must_use]
pub fn unpacked(tile: Tile, [r, g, _, a]: [u8; 4]) -> ([f32; 3], f32) {
    let (x, other) = if tile.is_card() { (r, a) } else { (a, r) };
    let signed = |byte: u8| (f32::from(byte) - 128.0) / 127.0;
    let (x, y) = (signed(x), signed(g));
    ([x, y, (1.0 - x * x - y * y).max(0.0).sqrt()], f32::from(other) / 255.0)
}

/// One tile with its mip chain: a layer of the two array textures.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Layer {
    /// Side in pixels at mip 0.
    pub size: u32,
    /// As [`TileArray::colour`].
    pub colour: Vec<u8>,
    /// As [`TileArray::normal`].
    pub normal: Vec<u8>,
}

/// What tiles of one size and seed have in common. Paints them one by one, so that threads can share the work.
pub struct Workshop {
    size: u32,
    seed: u64,
    encoder: Encoder,
    /// The wall of all bays.
    wall: Canvas,
    /// The leaves of all cards.
    leaf: Leaf,
}

/// A tile before it is written.
enum Drawing {
    Canvas(Canvas),
    Card(Card),
}

impl Workshop {
    /// A workshop for tiles of `size` × `size` pixels (see [`paintable_size`]).
    #[must_use]
    pub fn new(size: u32, seed: u64) -> Self {
        let size = paintable_size(size);
        let leaf = Leaf::new(Draw::new(seed, Id(Tile::Leaves.index() as u64), "card"));
        Self { size, seed, encoder: Encoder::new(), wall: bay::bay_wall(size, seed), leaf }
    }

    /// Side of its tiles in pixels.
    #[must_use]
    pub fn size(&self) -> u32 {
        self.size
    }

    /// Number of mip levels of its tiles, down to one pixel.
    #[must_use]
    pub fn mips(&self) -> u32 {
        self.size.ilog2() + 1
    }

    /// Paints a tile with its mips.
    #[must_use]
    pub fn paint(&self, tile: Tile) -> Layer {
        let mut layer = Layer { size: self.size, colour: Vec::new(), normal: Vec::new() };
        let mut add = |colour: [u8; 4], normal: [u8; 4]| {
            layer.colour.extend(colour);
            layer.normal.extend(normal);
        };
        match self.draw(tile) {
            Drawing::Card(card) => card.mips.iter().flatten().for_each(|dot| {
                let [colour, normal] = dot.bytes(&self.encoder);
                add(colour, normal);
            }),
            Drawing::Canvas(canvas) => {
                let (mut side, mut facets, mut texels) = (self.size as usize, mips::facets(&canvas), canvas.texels);
                loop {
                    texels.iter().zip(&facets).for_each(|(texel, facet)| add(self.encoder.colour(texel), facet.bytes()));
                    if side == 1 {
                        break;
                    }
                    texels = mips::halve(side, &texels, mips::mean_texel);
                    facets = mips::halve(side, &facets, mips::mean_facet);
                    side /= 2;
                }
            }
        }
        layer
    }

    fn draw(&self, tile: Tile) -> Drawing {
        let (size, size_m) = (self.size, tile.size_m());
        let draw = Draw::new(self.seed, Id(tile.index() as u64), "texture");
        Drawing::Canvas(match tile {
            Tile::Plaster | Tile::Bay(Opening::Blank) => bay::bare_plaster(size, size_m, draw),
            Tile::Bay(_) | Tile::Shop(_) => {
                let mut canvas = self.wall.clone();
                let opening = tile.opening().unwrap_or_default();
                match tile.shop() {
                    Some(shop) => street::shop(&mut canvas, draw, shop),
                    None => draw_opening(&mut canvas, opening, draw),
                }
                bay::join(&mut canvas, &self.wall, stands_on_foot(opening));
                canvas
            }
            Tile::RoofTile => roof::clay_tiles(size, size_m, draw),
            Tile::Slate => roof::slates(size, size_m, draw),
            Tile::Metal => roof::sheet_metal(size, size_m, draw),
            Tile::Ground(surface) => draw_ground(surface, size, size_m, draw),
            Tile::Stone => stone::ashlar(size, size_m, draw),
            Tile::Wood => timber::planks(size, size_m, draw),
            Tile::Leaves => soil::leaves(size, size_m, draw),
            Tile::Carved => stone::carved(size, size_m, draw),
            Tile::Glass => glass::leaded(size, size_m, draw),
            Tile::Lantern => glass::opal(size, size_m, draw),
            Tile::LeafyTree(kind) | Tile::BareTree(kind) => {
                // A tree is one tree in leaf and bare.
                let draw = Draw::new(self.seed, Id(Tile::LeafyTree(kind).index() as u64), "card");
                return Drawing::Card(Card::of_tree(kind, matches!(tile, Tile::BareTree(_)), size, draw, &self.leaf));
            }
        })
    }
}

/// Whether an opening stands on the lower edge of its bay.
fn stands_on_foot(opening: Opening) -> bool {
    matches!(opening, Opening::Arcade | Opening::Door | Opening::Gate | Opening::Portal | Opening::Shop)
}

fn draw_opening(canvas: &mut Canvas, opening: Opening, draw: Draw) {
    match opening {
        Opening::Blank | Opening::Shop => {}
        Opening::Window => window::plain(canvas, draw),
        Opening::FramedWindow => window::framed(canvas, draw),
        Opening::CorniceWindow => window::corniced(canvas, draw),
        Opening::PedimentWindow => window::pedimented(canvas, draw),
        Opening::ArchedWindow => window::arched(canvas, draw),
        Opening::LancetWindow => tower::lancet(canvas, draw),
        Opening::AtticWindow => window::attic(canvas, draw),
        Opening::WideWindow => window::wide(canvas, draw),
        Opening::Slit => tower::slit(canvas, draw),
        Opening::Portal => door::portal(canvas, draw),
        Opening::Door => door::door(canvas, draw),
        Opening::Arcade => street::arcade(canvas, draw),
        Opening::Gate => door::gate(canvas, draw),
        Opening::Clock => tower::clock(canvas, draw),
        Opening::Belfry => tower::belfry(canvas, draw),
    }
}

fn draw_ground(surface: SurfaceKind, size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    match surface {
        SurfaceKind::Asphalt => paving::asphalt(size, size_m, draw),
        SurfaceKind::Cobbles => paving::setts(size, size_m, draw),
        SurfaceKind::Mosaic => paving::mosaic(size, size_m, draw),
        SurfaceKind::Flagstones => paving::flagstones(size, size_m, draw),
        SurfaceKind::Gravel => soil::gravel(size, size_m, draw),
        SurfaceKind::Grass => soil::grass(size, size_m, draw),
        SurfaceKind::Yard | SurfaceKind::Opening => soil::yard(size, size_m, draw),
        SurfaceKind::Water => soil::water(size, size_m, draw),
        SurfaceKind::Ballast => soil::ballast(size, size_m, draw),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Height of a bay's picture before the wall, metres.
    fn proud(canvas: &Canvas, (x, y): (f64, f64)) -> f32 {
        let (width, height) = veduta_city::opening::BAY_M;
        let texel = |share: f64| ((share * canvas.size as f64) as usize).min(canvas.size - 1);
        canvas.texels[texel(1.0 - y / height) * canvas.size + texel(x / width)].height
    }

    #[test]
    fn what_is_painted_deep_or_proud_is_so_in_relief() {
        let workshop = Workshop::new(256, 1);
        for tile in Tile::all() {
            let (Some(opening), Drawing::Canvas(canvas)) = (tile.opening(), workshop.draw(tile)) else { continue };
            let Some(recess) = opening.recess() else { continue };
            // Beside mullions and between panes' bars.
            let inside = recess.low.lerp(recess.high, 0.31);
            assert!(proud(&canvas, inside.into()) < -0.01, "{opening:?} is not deep at {inside}");
            for slab in opening.slabs() {
                let n = slab.outline.len() as f64;
                let middle = slab.outline.iter().fold((0.0, 0.0), |sum, p| (sum.0 + p.0 / n, sum.1 + p.1 / n));
                assert!(proud(&canvas, middle) > 0.005, "{opening:?} does not stand out at {middle:?}");
            }
        }
    }
}
