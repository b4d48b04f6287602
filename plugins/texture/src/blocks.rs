use block_compression::CompressionVariant;
use block_compression::encode::compress_rgba8;

use crate::Layer;

/// Texels along a block.
const SIDE: usize = 4;

/// A tile with its mips in blocks of 4 × 4 texels, BC3: a quarter of the bytes. Mips are laid out like a [`Layer`]'s, each rounded up to
/// whole blocks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LayerBlocks {
    /// Blocks of the colour, sRGB.
    pub colour: Vec<u8>,
    /// Blocks of the normal picture, linear.
    pub normal: Vec<u8>,
}

impl Layer {
    /// The tile as desktop GPUs read it, and browsers on them (`TEXTURE_COMPRESSION_BC`).
    #[must_use]
    pub fn in_blocks(&self) -> LayerBlocks {
        LayerBlocks { colour: in_blocks(&self.colour, self.size), normal: in_blocks(&self.normal, self.size) }
    }
}

/// Blocks of a mip chain of opaque pictures, BC1: half as many bytes.
pub(crate) fn opaque(chain: &[u8], size: u32) -> Vec<u8> {
    encode(CompressionVariant::BC1, chain, size)
}

fn in_blocks(chain: &[u8], size: u32) -> Vec<u8> {
    encode(CompressionVariant::BC3, chain, size)
}

/// Blocks of a mip chain of RGBA8 that begins with `size` × `size` texels, a power of two.
fn encode(variant: CompressionVariant, chain: &[u8], size: u32) -> Vec<u8> {
    let (mut blocks, mut rest, mut side) = (Vec::with_capacity(chain.len() / 4 + 32), chain, size as usize);
    while side > 0 {
        let (mip, smaller) = rest.split_at(side * side * 4);
        rest = smaller;
        let padded;
        let (mip, edge) = if side < SIDE {
            padded = repeated(mip, side);
            (&*padded, SIDE as u32)
        } else {
            (mip, side as u32)
        };
        let start = blocks.len();
        blocks.resize(start + variant.blocks_byte_size(edge, edge), 0);
        compress_rgba8(variant, mip, &mut blocks[start..], edge, edge, edge * 4);
        side /= 2;
    }
    blocks
}

/// A block of a mip that is smaller than one.
fn repeated(mip: &[u8], side: usize) -> Vec<u8> {
    let texel = |i: usize| {
        let (row, column) = (i / SIDE % side, i % SIDE % side);
        &mip[(row * side + column) * 4..][..4]
    };
    (0..SIDE * SIDE).flat_map(texel).copied().collect()
}
