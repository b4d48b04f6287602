use block_compression::CompressionVariant;
use block_compression::encode::compress_rgba8;

use crate::{Layer, bc1};

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
    let mut blocks = Vec::with_capacity(chain.len() / 8 + 32);
    for_each_mip(chain, size, |mip, side| {
        let texels = mip.as_chunks::<4>().0;
        let count = side * side / (SIDE * SIDE);
        for first in (0..count).step_by(bc1::AT_ONCE) {
            let mut four = [[0; SIDE * SIDE]; bc1::AT_ONCE];
            for (n, block) in (first..count).zip(&mut four) {
                let corner = n / (side / SIDE) * SIDE * side + n % (side / SIDE) * SIDE;
                for (row, line) in block.chunks_exact_mut(SIDE).zip(texels[corner..].chunks(side)) {
                    row.iter_mut().zip(line).for_each(|(bits, &texel)| *bits = u32::from_le_bytes(texel));
                }
            }
            blocks.extend(bc1::blocks(&four).iter().take(count - first).flatten());
        }
    });
    blocks
}

fn in_blocks(chain: &[u8], size: u32) -> Vec<u8> {
    let mut blocks = Vec::with_capacity(chain.len() / 4 + 32);
    for_each_mip(chain, size, |mip, side| {
        let (start, side) = (blocks.len(), side as u32);
        blocks.resize(start + CompressionVariant::BC3.blocks_byte_size(side, side), 0);
        compress_rgba8(CompressionVariant::BC3, mip, &mut blocks[start..], side, side, side * 4);
    });
    blocks
}

/// The mips of a chain of RGBA8 that begins with `size` × `size` texels, a power of two, each with its side; those that are smaller than a
/// block repeated.
fn for_each_mip(chain: &[u8], size: u32, mut of: impl FnMut(&[u8], usize)) {
    let (mut rest, mut side) = (chain, size as usize);
    while side > 0 {
        let (mip, smaller) = rest.split_at(side * side * 4);
        rest = smaller;
        if side < SIDE {
            of(&repeated(mip, side), SIDE)
        } else {
            of(mip, side)
        }
        side /= 2;
    }
}

/// A block of a mip that is smaller than one.
fn repeated(mip: &[u8], side: usize) -> Vec<u8> {
    let texel = |i: usize| {
        let (row, column) = (i / SIDE % side, i % SIDE % side);
        &mip[(row * side + column) * 4..][..4]
    };
    (0..SIDE * SIDE).flat_map(texel).copied().collect()
}
