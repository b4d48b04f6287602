//! Thinning after Zhang and Suen ("A fast parallel algorithm for thinning digital patterns", 1984), 64 pixels at a time.
//!
//! ```text
//!  bands of rows ─► step 1 ─► step 2 ─► step 1 … until neither takes anything
//!  (one a thread)   marks of a word = one expression of the 8 words of its neighbours; chunks are skipped in
//!                   which, and beside which, nothing has changed in the last two steps
//! ```
//!
//! The picture's outermost pixels count as neighbours and are never taken, as in OpenCV's `ximgproc.thinning`, whose
//! result this equals pixel by pixel.

use pulp::{Arch, NullaryFnOnce};

use super::bitmap::{Bitmap, CHUNK, CHUNK_PX};
use super::lanes::{Lanes, Three, beside, eight, full_add};

/// The skeleton of a bitmap, on so many threads (at least one), with the same result for any number.
///
/// # Panics
/// If the bitmap is wider than 32,768 pixels.
#[must_use]
pub fn thinned(bitmap: &Bitmap, threads: usize) -> Bitmap {
    thin_on(bitmap, threads, Arch::new())
}

/// As [`thinned`], without the wide registers of newer processors: for measuring what they bring.
#[must_use]
pub fn thinned_portably(bitmap: &Bitmap, threads: usize) -> Bitmap {
    thin_on(bitmap, threads, Arch::Scalar)
}

fn thin_on(bitmap: &Bitmap, threads: usize, arch: Arch) -> Bitmap {
    assert!(bitmap.chunks() <= 64, "{bitmap:?} is too wide to be thinned");
    if bitmap.width() < 3 || bitmap.height() < 3 {
        return bitmap.clone();
    }
    let inner = bitmap.height() - 2;
    let threads = threads.clamp(1, inner.div_ceil(64));
    let mut bands: Vec<Band> =
        (0..threads).map(|i| Band::of(bitmap, 1 + inner * i / threads, 1 + inner * (i + 1) / threads)).collect();
    let mut quiet = 0;
    for step in [Step::First, Step::Second].into_iter().cycle() {
        let taken = if let [band] = &mut bands[..] {
            band.advance(step, arch)
        } else {
            rayon::scope(|scope| {
                for band in &mut bands {
                    scope.spawn(move |_| band.taken = band.advance(step, arch));
                }
            });
            share_borders(&mut bands);
            bands.iter().any(|band| band.taken)
        };
        quiet = if taken { 0 } else { quiet + 1 };
        if quiet == 2 {
            break;
        }
    }
    let mut result = Bitmap::new(bitmap.width(), bitmap.height());
    for y in [0, bitmap.height() - 1] {
        result.copy_rows(bitmap, y..y + 1, y);
    }
    let stride = result.stride();
    for band in bands {
        let from = 1 + band.first * stride;
        result.words_mut()[from..from + band.rows * stride].copy_from_slice(&band.words[1 + stride..][..band.rows * stride]);
    }
    result
}

/// The two steps of an iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step {
    First,
    Second,
}

/// One step of a band, compiled once for each kind of processor.
struct Sweep<'a> {
    band: &'a mut Band,
    step: Step,
}

impl NullaryFnOnce for Sweep<'_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        match self.step {
            Step::First => self.band.sweep::<true>(),
            Step::Second => self.band.sweep::<false>(),
        }
    }
}

/// Rows that one thread thins, with a copy of the row above and the row below.
struct Band {
    /// Number of its first row in the picture.
    first: usize,
    /// How many rows it has, without the copies.
    rows: usize,
    /// Words from row to row.
    stride: usize,
    /// As a bitmap's.
    words: Vec<u64>,
    /// For each step, and each row from the copy above: the chunks in which it last took something, a bit each.
    changed: [Vec<u64>; 2],
    /// A row's pixels that may be taken: all but the first and the last.
    loose: Vec<Lanes>,
    /// Marks of two rows: of the one before, and of the one at hand.
    marks: [Vec<Lanes>; 2],
    /// Whether its last step took anything.
    taken: bool,
}

impl Band {
    fn of(bitmap: &Bitmap, first: usize, end: usize) -> Self {
        let (stride, rows, right) = (bitmap.stride(), end - first, bitmap.width() - 1);
        let from = (first - 1) * stride;
        let all = u64::MAX >> (64 - bitmap.chunks());
        let blank = vec![Lanes::NONE; bitmap.chunks()];
        let mut loose = vec![Lanes::ALL; bitmap.chunks()];
        for fixed in [0, right] {
            loose[fixed / CHUNK_PX].0[fixed / 64 % CHUNK] &= !(1 << (fixed % 64));
        }
        Self {
            first,
            rows,
            stride,
            words: bitmap.words()[from..from + (rows + 2) * stride + 1].to_vec(),
            changed: [vec![all; rows + 2], vec![all; rows + 2]],
            loose,
            marks: [blank.clone(), blank],
            taken: false,
        }
    }

    /// Takes one step and says whether anything was taken.
    fn advance(&mut self, step: Step, arch: Arch) -> bool {
        arch.dispatch(Sweep { band: self, step })
    }

    #[inline(always)]
    fn sweep<const FIRST: bool>(&mut self) -> bool {
        let now = usize::from(!FIRST);
        let (mut before, mut taken, mut any) = (self.changed[0][0] | self.changed[1][0], 0, 0);
        for i in 1..=self.rows {
            let at = self.changed[0][i] | self.changed[1][i];
            let around = before | at | self.changed[0][i + 1] | self.changed[1][i + 1];
            before = at;
            let active = around | around << 1 | around >> 1;
            let found = if around == 0 { 0 } else { self.mark::<FIRST>(i, active) };
            // What is marked in a row is taken only after the next row has been marked.
            self.take(i - 1, taken, 1 - i % 2);
            self.changed[now][i] = found;
            taken = found;
            any |= found;
        }
        self.take(self.rows, taken, self.rows % 2);
        any != 0
    }

    /// Marks what goes of a row's active chunks; gives the chunks with marks.
    #[inline(always)]
    fn mark<const FIRST: bool>(&mut self, i: usize, active: u64) -> u64 {
        let (stride, marks) = (self.stride, &mut self.marks[i % 2]);
        let mut rest = active & (u64::MAX >> (64 - stride / CHUNK));
        let mut found = 0;
        while rest != 0 {
            let chunk = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let row = |i: usize| beside(&self.words[i * stride..], chunk);
            let three = Three { above: row(i - 1), at: row(i), below: row(i + 1) };
            // Word by word, with so much to do for each that this stays a loop: such a loop is made one of wide registers.
            let (loose, mut gone, mut any) = (self.loose[chunk].0, Lanes::NONE, 0);
            for (word, gone) in gone.0.iter_mut().enumerate() {
                *gone = marked::<FIRST>(three.at[word + 1], three.ring_of(word)) & loose[word];
                any |= *gone;
            }
            marks[chunk] = gone;
            found |= u64::from(any != 0) << chunk;
        }
        found
    }

    /// Takes the marked pixels of some chunks of a row.
    #[inline(always)]
    fn take(&mut self, i: usize, mut chunks: u64, marks: usize) {
        while chunks != 0 {
            let chunk = chunks.trailing_zeros() as usize;
            chunks &= chunks - 1;
            let row = &mut self.words[1 + i * self.stride..];
            (Lanes::of(row, chunk) & !self.marks[marks][chunk]).write(row, chunk);
        }
    }
}

/// The pixels that a step takes: those with two to six neighbours, all in one run around them, where the step's two triples
/// of side neighbours are not full.
#[inline(always)]
fn marked<const FIRST: bool>(here: u64, ring: [u64; 8]) -> u64 {
    let [n, ne, e, se, s, sw, w, nw] = ring;
    let rises = [rise(n, ne, e), rise(e, se, s), rise(s, sw, w), rise(w, nw, n)];
    let (odd, two_of_three) = full_add(rises[0], rises[1], rises[2]);
    let one_run = (odd ^ rises[3]) & !two_of_three;
    let [ones, twos, fours, _] = eight(ring);
    let two_to_six = (twos | fours) & !(ones & twos & fours);
    let full = if FIRST { e & s & (n | w) } else { n & w & (e | s) };
    here & one_run & two_to_six & !full
}

/// Whether what is set begins at the second of three places side by side, or at the third: it cannot at both.
#[inline(always)]
fn rise(a: u64, b: u64, c: u64) -> u64 {
    (!a & b) | (!b & c)
}

/// Gives every band its neighbours' border rows, and what changed there.
fn share_borders(bands: &mut [Band]) {
    for i in 1..bands.len() {
        let (upper, lower) = bands.split_at_mut(i);
        let (Some(upper), Some(lower)) = (upper.last_mut(), lower.first_mut()) else { continue };
        let stride = upper.stride;
        let (last, halo) = (1 + upper.rows * stride, 1 + (upper.rows + 1) * stride);
        lower.words[1..stride].copy_from_slice(&upper.words[last..last + stride - 1]);
        upper.words[halo..halo + stride - 1].copy_from_slice(&lower.words[1 + stride..2 * stride]);
        for step in 0..2 {
            lower.changed[step][0] = upper.changed[step][upper.rows];
            upper.changed[step][upper.rows + 1] = lower.changed[step][1];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The method as its paper has it, a pixel at a time.
    fn by_the_book(bitmap: &Bitmap) -> Bitmap {
        let (mut picture, (w, h)) = (bitmap.clone(), (bitmap.width(), bitmap.height()));
        loop {
            let before = picture.clone();
            for first in [true, false] {
                let old = picture.clone();
                for y in 1..h.saturating_sub(1) {
                    for x in 1..w.saturating_sub(1) {
                        let p = |i: u32| old.around(x, y) >> (i - 2) & 1 == 1;
                        let set = old.around(x, y).count_ones();
                        let rises = (2..=9).filter(|&i| !p(i) && p(if i == 9 { 2 } else { i + 1 })).count();
                        let full = if first {
                            (p(2) && p(4) && p(6)) || (p(4) && p(6) && p(8))
                        } else {
                            (p(2) && p(4) && p(8)) || (p(2) && p(6) && p(8))
                        };
                        if (2..=6).contains(&set) && rises == 1 && !full {
                            picture.set(x, y, false);
                        }
                    }
                }
            }
            if picture == before {
                return picture;
            }
        }
    }

    #[test]
    fn a_bar_becomes_a_line() {
        let bar = Bitmap::from_fn(40, 15, |x, y| (5..35).contains(&x) && (5..10).contains(&y));
        let line = thinned(&bar, 1);
        assert!(line.pixels().all(|(_, y)| y == 7), "its pixels lie in the middle row");
        assert!(line.count() >= 24, "it keeps its length but for its half width at each end");
    }

    proptest! {
        #[test]
        fn equals_the_book_on_any_bitmap_and_any_threads(
            width in 1usize..600, height in 1usize..220, density in 1u64..8, grain in 1usize..9, seed: u64,
        ) {
            let draw = |x: usize, y: usize| {
                let n = ((x / grain) as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ ((y / grain) as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F) ^ seed;
                (n ^ n >> 31).wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 61 < density
            };
            let bitmap = Bitmap::from_fn(width, height, draw);
            let skeleton = thinned(&bitmap, 1);
            prop_assert_eq!(&skeleton, &by_the_book(&bitmap));
            prop_assert_eq!(&skeleton, &thinned(&bitmap, 3));
            prop_assert_eq!(&skeleton, &thinned_portably(&bitmap, 2));
        }
    }
}
