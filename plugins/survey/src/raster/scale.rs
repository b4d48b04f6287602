//! Bitmaps made smaller and larger.

use super::bitmap::Bitmap;

impl Bitmap {
    /// The picture at a quarter of its size: a pixel is set if at least five of its sixteen are.
    #[must_use]
    pub(crate) fn quartered(&self) -> Self {
        const LOW: u64 = 0x0F0F_0F0F_0F0F_0F0F;
        let mut small = Self::new(self.width().div_ceil(4), self.height().div_ceil(4));
        for y in 0..small.height() {
            let rows = 4 * y..(4 * y + 4).min(self.height());
            for k in 0..self.width().div_ceil(64) {
                // Counts of the word's sixteen fours, in bytes: those in even places and those in odd ones.
                let (mut even, mut odd) = (0, 0);
                for row in rows.clone() {
                    let pairs = |x: u64| x - (x >> 1 & 0x5555_5555_5555_5555);
                    let fours = |x: u64| (x & 0x3333_3333_3333_3333) + (x >> 2 & 0x3333_3333_3333_3333);
                    let counts = fours(pairs(self.row(row)[k]));
                    even += counts & LOW;
                    odd += counts >> 4 & LOW;
                }
                // A count of five or more reaches 16 with eleven more.
                let enough = |counts: u64| (counts + 0x0B0B_0B0B_0B0B_0B0B) >> 4 & 0x0101_0101_0101_0101;
                let sixteen = low_pairs(enough(even) | enough(odd) << 1);
                small.row_mut(y)[k / 4] |= sixteen << (k % 4 * 16);
            }
        }
        small
    }

    /// The picture at half of its size: a pixel is set if any of its four is.
    #[must_use]
    pub(crate) fn halved(&self) -> Self {
        let mut small = Self::new(self.width().div_ceil(2), self.height().div_ceil(2));
        for y in 0..self.height() {
            let (to, from) = (small.row_mut(y / 2), self.row(y));
            for (k, &word) in from[..self.width().div_ceil(64)].iter().enumerate() {
                to[k / 2] |= even_bits(word | word >> 1) << (k % 2 * 32);
            }
        }
        small
    }

    /// The picture at twice its size, cut to the size given.
    #[must_use]
    pub(crate) fn doubled(&self, width: usize, height: usize) -> Self {
        debug_assert!(width.div_ceil(2) == self.width() && height.div_ceil(2) == self.height());
        let mut large = Self::new(width, height);
        let (used, last) = (width.div_ceil(64), large.last_word());
        for y in 0..height {
            let (to, from) = (&mut large.row_mut(y)[..used], self.row(y / 2));
            for (k, word) in to.iter_mut().enumerate() {
                let half = spread(from[k / 2] >> (k % 2 * 32));
                *word = half | half << 1;
            }
            if let Some(word) = to.last_mut() {
                *word &= last;
            }
        }
        large
    }
}

/// The bits in even places, side by side.
fn even_bits(x: u64) -> u64 {
    let x = x & 0x5555_5555_5555_5555;
    let x = (x | x >> 1) & 0x3333_3333_3333_3333;
    let x = (x | x >> 2) & 0x0F0F_0F0F_0F0F_0F0F;
    let x = (x | x >> 4) & 0x00FF_00FF_00FF_00FF;
    let x = (x | x >> 8) & 0x0000_FFFF_0000_FFFF;
    (x | x >> 16) & 0xFFFF_FFFF
}

/// The lower half of the bits, in even places.
fn spread(x: u64) -> u64 {
    let x = x & 0xFFFF_FFFF;
    let x = (x | x << 16) & 0x0000_FFFF_0000_FFFF;
    let x = (x | x << 8) & 0x00FF_00FF_00FF_00FF;
    let x = (x | x << 4) & 0x0F0F_0F0F_0F0F_0F0F;
    let x = (x | x << 2) & 0x3333_3333_3333_3333;
    (x | x << 1) & 0x5555_5555_5555_5555
}

/// The two lowest bits of each of a word's bytes, side by side.
fn low_pairs(x: u64) -> u64 {
    let x = (x | x >> 6) & 0x000F_000F_000F_000F;
    let x = (x | x >> 12) & 0x0000_00FF_0000_00FF;
    (x | x >> 24) & 0xFFFF
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_of_the_picture_shows_what_five_of_sixteen_pixels_are() {
        for (width, height) in [(64, 8), (130, 9), (517, 6), (3, 3)] {
            let bitmap = Bitmap::from_fn(width, height, |x, y| (x * 31 + y * 17 + x * y) % 7 < 2);
            let full = Bitmap::from_fn(width, height, |_, _| true);
            for bitmap in [bitmap, full] {
                let small = bitmap.quartered();
                assert_eq!((small.width(), small.height()), (width.div_ceil(4), height.div_ceil(4)));
                for (x, y) in (0..small.width()).flat_map(|x| (0..small.height()).map(move |y| (x, y))) {
                    let all = (0..16).map(|i| (4 * x + i % 4, 4 * y + i / 4));
                    let set = all.filter(|&(x, y)| bitmap.get(x as isize, y as isize)).count();
                    assert_eq!(small.get(x as isize, y as isize), set >= 5, "({x}, {y}) of {bitmap:?}");
                }
                assert_eq!(small.count(), small.pixels().filter(|&(x, _)| x < small.width()).count());
            }
        }
    }

    #[test]
    fn half_of_a_picture_shows_what_any_of_four_pixels_is_and_twice_of_it_each_four_times() {
        for (width, height) in [(1, 1), (64, 8), (65, 9), (130, 3), (517, 6), (1024, 2)] {
            let bitmap = Bitmap::from_fn(width, height, |x, y| (x * 31 + y * 17 + x * y) % 11 < 2);
            let small = bitmap.halved();
            let any = |x: usize, y: usize| (0..4).any(|i| bitmap.get((2 * x + i % 2) as isize, (2 * y + i / 2) as isize));
            assert_eq!(small, Bitmap::from_fn(width.div_ceil(2), height.div_ceil(2), any), "{bitmap:?}");
            let large = Bitmap::from_fn(width, height, |x, y| small.get(x as isize / 2, y as isize / 2));
            assert_eq!(small.doubled(width, height), large, "{bitmap:?}");
        }
    }
}
