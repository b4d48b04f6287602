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
        row[chunk * CHUNK..][..CHUNK].copy_from_slice(&self.0);
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

/// Sum of two bits and a carry: (sum, carry).
#[inline(always)]
pub(crate) fn full_add(a: Lanes, b: Lanes, c: Lanes) -> (Lanes, Lanes) {
    (a ^ b ^ c, (a & b) | (c & (a ^ b)))
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
