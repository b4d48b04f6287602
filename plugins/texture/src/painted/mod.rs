//! Façades given as pictures: cut when a city is baked, put together again on the walker's machine.
//!
//! ```text
//!  FacadeDraft, picture ──► cut ─┬─► PaintedFacade: colour, small textures of ≤ 16 colours, places        (levels 1 and 2)
//!                                └─► the wall of each section; an atlas of all that repeats, once ──► WebP  (level 3)
//!
//!  PaintedFacade ──► put_together ──► a coarse picture of each section ─┐
//!  WebP ──► decode_picture (limits first) ──► compose ──► a fine one ───┴─► PictureLayer ──► mips, blocks (BC1)
//! ```
//! What repeats is kept once, as a mean of how it looks where it is repeated: where it differs, let it be an object of its own.

mod atlas;
mod cut;
mod flats;
mod picture;
mod quantise;

use glam::DVec2;
use veduta_city::{PaintedFacade, Rgb};

use crate::blocks;
use crate::mips::{Light, halve, mean_light};

pub use atlas::compose;
use atlas::shown;
pub use cut::{CutError, CutFacade, cut_facade};
pub use picture::{MOST_FLATS_BYTES, PICTURE_SIDE, PICTURE_STORED_CAP, PictureError, decode_picture, keep_flats};

/// Texels along a coarse picture.
const COARSE_SIDE: usize = 128;

/// A picture, row by row from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pixels {
    /// Columns; not 0.
    pub width: usize,
    /// sRGB, `width` × [`Pixels::height`] of them.
    pub texels: Vec<Rgb>,
}

impl Pixels {
    /// A picture of red, green and blue bytes; `None` unless they fill whole rows.
    #[must_use]
    pub fn of_rgb(width: usize, bytes: &[u8]) -> Option<Self> {
        let is_whole = width > 0 && !bytes.is_empty() && bytes.len().is_multiple_of(3 * width);
        is_whole.then(|| Self { width, texels: bytes.as_chunks::<3>().0.iter().map(|&[r, g, b]| Rgb(r, g, b)).collect() })
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.texels.len() / self.width
    }

    /// All bytes: red, green, blue.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        self.texels.iter().flat_map(|&Rgb(r, g, b)| [r, g, b]).collect()
    }
}

/// A picture with its mips for a GPU: a layer of an array texture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PictureLayer {
    /// Texels along a side; a power of two.
    pub size: u32,
    /// RGBA8, rgb in sRGB, alpha 255; mip by mip, within a mip row by row from the top.
    pub texels: Vec<u8>,
}

impl PictureLayer {
    /// With mips averaged in linear light; `None` unless the picture is a square whose side is a power of two.
    #[must_use]
    pub fn new(picture: &Pixels) -> Option<Self> {
        let size = picture.width;
        if !size.is_power_of_two() || picture.height() != size {
            return None;
        }
        let mut texels: Vec<[u8; 4]> = Vec::with_capacity((4 * size * size - 1) / 3);
        let opaque = |Rgb(r, g, b): Rgb| [r, g, b, 255];
        texels.extend(picture.texels.iter().map(|&texel| opaque(texel)));
        let light = Light::tables();
        let (mut side, mut mip) = (size, Vec::<[u16; 3]>::new());
        while side > 1 {
            mip = if side == size {
                halve(side, &picture.texels, |[a, b, c, d]| {
                    mean_light([light.linear(a), light.linear(b), light.linear(c), light.linear(d)])
                })
            } else {
                halve(side, &mip, mean_light)
            };
            side /= 2;
            texels.extend(mip.iter().map(|&texel| opaque(light.srgb(texel))));
        }
        Some(Self { size: size as u32, texels: texels.into_flattened() })
    }

    /// Number of mip levels, down to one texel.
    #[must_use]
    pub fn mips(&self) -> u32 {
        self.size.ilog2() + 1
    }

    /// As desktop GPUs read it, and browsers on them: BC1, an eighth of the bytes.
    #[must_use]
    pub fn in_blocks(&self) -> Vec<u8> {
        blocks::opaque(&self.texels, self.size)
    }
}

/// The pictures of a façade's sections as level 2 knows them: small textures on a wall of one colour. `None` if it cannot be drawn.
#[must_use]
pub fn put_together(painted: &PaintedFacade) -> Option<Vec<Pixels>> {
    painted.check().ok()?;
    let texel = |shown: Option<(u8, DVec2)>| {
        let texture = painted.textures.get(usize::from(painted.objects.get(usize::from(shown?.0))?.texture))?;
        let at = shown?.1 * DVec2::new(texture.width.into(), texture.height() as f64);
        Some(texture.at(at.x as usize, at.y as usize))
    };
    let section = |of: Vec<Option<(u8, DVec2)>>| Pixels {
        width: COARSE_SIDE,
        texels: of.into_iter().map(|shown| texel(shown).unwrap_or(painted.colour)).collect(),
    };
    Some(shown(painted, COARSE_SIDE, |_| true).of.into_iter().map(section).collect())
}
