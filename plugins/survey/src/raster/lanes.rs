//! 512 pixels of a row at a time: the widest register there is, or as many narrower ones as make it up.
//!
//! Everything is inlined, so that what is compiled for a kind of processor (`pulp`) is compiled for it as a whole.

use core::ops::{BitAnd, BitAndAssign, BitOr, BitOrAssign, BitXor, Not};

use super::bitmap::CHUNK;

/// The words of a chunk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(align(64))]
pub(crate) struct Lanes(pub [u64; CHUNK]);

/// The words of a chunk, with the one before and the one after.
pub(crate) type Beside = [u64; CHUNK + 2];

/// A chunk of a row that is given between its blank words.
#[inline(always)]
pub(crate) fn beside(padded: &[u64], chunk: usize) -> &Beside {
    let from = chunk * CHUNK;
    match padded[from..from + CHUNK + 2].try_into() {
        Ok(words) => words,
        Err(_) => unreachable!("a slice of that many words is an array of them"),
    }
}

impl Lanes {
    pub const NONE: Self = Self([0; CHUNK]);
    pub const ALL: Self = Self([u64::MAX; CHUNK]);

    /// A chunk of a row, given without the blank words.
    #[inline(always)]
    pub fn of(row: &[u64], chunk: usize) -> Self {
        let row = &row[chunk * CHUNK..][..CHUNK];
        Self::each(|k| row[k])
    }

    /// Writes a chunk of a row, given without the blank words.
    #[inline(always)]
    pub fn write(self, row: &mut [u64], chunk: usize) {
        // Word by word: a call that copies a slice is not compiled for this kind of processor.
        for (word, own) in row[chunk * CHUNK..][..CHUNK].iter_mut().zip(self.0) {
            *word = own;
        }
    }

    /// The pixels themselves.
    #[inline(always)]
    pub fn here(words: &Beside) -> Self {
        Self::each(|k| words[k + 1])
    }

    /// For each pixel the one `n` (1 to 63) to its left.
    #[inline(always)]
    pub fn west(words: &Beside, n: u32) -> Self {
        Self::each(|k| words[k + 1] << n | words[k] >> (64 - n))
    }

    /// For each pixel the one `n` (1 to 63) to its right.
    #[inline(always)]
    pub fn east(words: &Beside, n: u32) -> Self {
        Self::each(|k| words[k + 1] >> n | words[k + 2] << (64 - n))
    }

    /// Each pixel moved by one to the right (`by` 1), to the left (-1) or not at all (0), between the words before and after.
    /// Which of these is not asked but reckoned: where it is hard to foretell, asking takes longer.
    #[inline(always)]
    pub fn moved(self, by: i32, before: u64, after: u64) -> Self {
        let (right, left) = (u64::from(by > 0), u64::from(by < 0));
        Self::each(|k| {
            let west = if k > 0 { self.0[k - 1] } else { before };
            let east = if k + 1 < CHUNK { self.0[k + 1] } else { after };
            self.0[k] << right >> left | west >> 63 & right | east << 63 & left << 63
        })
    }

    /// Whether any pixel is set.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.0.iter().fold(0, |all, word| all | word) != 0
    }

    #[inline(always)]
    fn each(f: impl Fn(usize) -> u64) -> Self {
        let mut lanes = [0; CHUNK];
        for (k, word) in lanes.iter_mut().enumerate() {
            *word = f(k);
        }
        Self(lanes)
    }
}

impl BitAnd for Lanes {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self::each(|k| self.0[k] & other.0[k])
    }
}

impl BitOr for Lanes {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self::each(|k| self.0[k] | other.0[k])
    }
}

impl BitXor for Lanes {
    type Output = Self;

    #[inline(always)]
    fn bitxor(self, other: Self) -> Self {
        Self::each(|k| self.0[k] ^ other.0[k])
    }
}

impl Not for Lanes {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self::each(|k| !self.0[k])
    }
}

impl BitAndAssign for Lanes {
    #[inline(always)]
    fn bitand_assign(&mut self, other: Self) {
        *self = *self & other;
    }
}

impl BitOrAssign for Lanes {
    #[inline(always)]
    fn bitor_assign(&mut self, other: Self) {
        *self = *self | other;
    }
}

/// Bits side by side: of a word, or of a chunk of words.
pub(crate) trait Bits:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + BitXor<Output = Self> + Not<Output = Self>
{
}

impl Bits for Lanes {}

impl Bits for u64 {}

/// Sum of two bits and a carry: (sum, carry).
#[inline(always)]
pub(crate) fn full_add<B: Bits>(a: B, b: B, c: B) -> (B, B) {
    (a ^ b ^ c, (a & b) | (c & (a ^ b)))
}

/// How many of eight bits are set, as a sum of four bits.
#[inline(always)]
pub(crate) fn eight<B: Bits>(ring: [B; 8]) -> [B; 4] {
    let (s1, c1) = full_add(ring[0], ring[1], ring[2]);
    let (s2, c2) = full_add(ring[3], ring[4], ring[5]);
    let (s3, c3) = full_add(s1, s2, ring[6]);
    let (b0, c4) = (s3 ^ ring[7], s3 & ring[7]);
    let (t, d1) = full_add(c1, c2, c3);
    let (b1, d2) = (t ^ c4, t & c4);
    [b0, b1, d1 ^ d2, d1 & d2]
}

/// A row, and those above and below, each between its blank words.
#[derive(Clone, Copy)]
pub(crate) struct ThreeRows<'a> {
    pub above: &'a [u64],
    pub at: &'a [u64],
    pub below: &'a [u64],
}

impl<'a> ThreeRows<'a> {
    #[inline(always)]
    pub fn chunk(self, chunk: usize) -> Three<'a> {
        Three { above: beside(self.above, chunk), at: beside(self.at, chunk), below: beside(self.below, chunk) }
    }
}

/// A chunk of a row, and of those above and below.
#[derive(Clone, Copy)]
pub(crate) struct Three<'a> {
    pub above: &'a Beside,
    pub at: &'a Beside,
    pub below: &'a Beside,
}

impl Three<'_> {
    /// The eight neighbours of one word's pixels, clockwise from those above.
    #[inline(always)]
    pub fn ring_of(self, word: usize) -> [u64; 8] {
        let Self { above, at, below } = self;
        let west = |row: &Beside| row[word + 1] << 1 | row[word] >> 63;
        let east = |row: &Beside| row[word + 1] >> 1 | row[word + 2] << 63;
        [above[word + 1], east(above), east(at), east(below), below[word + 1], west(below), west(at), west(above)]
    }

    /// The eight neighbours, clockwise from the one above.
    #[inline(always)]
    pub fn ring(self) -> [Lanes; 8] {
        let Self { above, at, below } = self;
        [
            Lanes::here(above),
            Lanes::east(above, 1),
            Lanes::east(at, 1),
            Lanes::east(below, 1),
            Lanes::here(below),
            Lanes::west(below, 1),
            Lanes::west(at, 1),
            Lanes::west(above, 1),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn lanes_are_moved_a_pixel_to_either_side(words in prop::array::uniform8(any::<u64>()), before: u64, after: u64, by in -1i32..=1) {
            let all: Vec<u64> = [before].into_iter().chain(words).chain([after]).collect();
            let bit = |i: i32| all[i as usize / 64] >> (i % 64) & 1;
            let moved = Lanes(words).moved(by, before, after);
            for i in 0..512i32 {
                prop_assert_eq!(moved.0[i as usize / 64] >> (i % 64) & 1, bit(64 + i - by), "bit {} moved by {}", i, by);
            }
        }

        #[test]
        fn eight_bits_are_counted(ring in prop::array::uniform8(any::<u64>())) {
            let sum = eight(ring);
            prop_assert_eq!(eight(ring.map(|word| Lanes([word; CHUNK]))).map(|lanes| lanes.0[3]), sum);
            for i in 0..64 {
                let count = ring.iter().filter(|word| **word >> i & 1 == 1).count() as u64;
                let told = (0..4).map(|k| (sum[k] >> i & 1) << k).sum::<u64>();
                prop_assert_eq!(told, count);
            }
        }
    }
}
