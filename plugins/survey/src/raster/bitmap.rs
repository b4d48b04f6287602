use core::fmt;

use glam::{DVec2, IVec2};
use pulp::{Arch, NullaryFnOnce};

use super::lanes::ThreeRows;

/// Words a chunk: 512 pixels, the widest register there is.
pub(crate) const CHUNK: usize = 8;
/// Pixels a chunk.
pub(crate) const CHUNK_PX: usize = CHUNK * 64;

/// A picture of one bit a pixel, 64 pixels a word, the leftmost in the lowest bit.
///
/// Rows are padded to whole chunks of 512 pixels, and a blank word stands between them, so that a word's left and right
/// neighbours can be read without a question. Pixels outside of the picture are not set.
#[derive(Clone, PartialEq, Eq)]
pub struct Bitmap {
    width: usize,
    height: usize,
    /// Words from one row to the next: those of its chunks and the blank one after them.
    stride: usize,
    /// A blank word, then the rows.
    words: Vec<u64>,
}

/// How many bits of some words are set.
struct Count<'a>(&'a [u64]);

impl NullaryFnOnce for Count<'_> {
    type Output = usize;

    #[inline(always)]
    fn call(self) -> usize {
        let mut count = 0;
        for word in self.0 {
            count += u64::from(word.count_ones());
        }
        count as usize
    }
}

impl Bitmap {
    /// A bitmap with no pixel set.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Self {
        let stride = width.div_ceil(CHUNK_PX) * CHUNK + 1;
        Self { width, height, stride, words: vec![0; 1 + stride * height] }
    }

    /// A bitmap with the pixels set for which `is_set(x, y)` holds.
    #[must_use]
    pub fn from_fn(width: usize, height: usize, mut is_set: impl FnMut(usize, usize) -> bool) -> Self {
        let mut bitmap = Self::new(width, height);
        for y in 0..height {
            for x in 0..width {
                if is_set(x, y) {
                    bitmap.set(x, y, true);
                }
            }
        }
        bitmap
    }

    /// Pixels a row.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Whether a pixel is set; pixels outside are not.
    #[must_use]
    #[inline]
    pub fn get(&self, x: isize, y: isize) -> bool {
        let inside = x >= 0 && y >= 0 && (x as usize) < self.width && (y as usize) < self.height;
        inside && self.words[self.index(x as usize, y as usize)] >> (x as usize % 64) & 1 == 1
    }

    /// Whether the pixel that a point lies in is set; pixels outside are not.
    #[inline]
    pub(crate) fn get_at(&self, p: DVec2) -> bool {
        let (x, y) = pixel_of(p);
        self.get(x, y)
    }

    /// As [`get`](Self::get), sooner, for pixels that are at most one pixel outside.
    #[inline]
    pub(crate) fn get_near(&self, x: i32, y: i32) -> bool {
        // The blank words beside the rows answer for what is left and right of them, and there is nothing above and below.
        let word = (y as isize * self.stride as isize + 1 + (x >> 6) as isize) as usize;
        self.words.get(word).is_some_and(|word| word >> (x & 63) & 1 == 1)
    }

    /// Sets or clears a pixel inside of the picture.
    ///
    /// # Panics
    /// If it is outside.
    #[inline]
    pub fn set(&mut self, x: usize, y: usize, on: bool) {
        assert!(x < self.width && y < self.height, "pixel ({x}, {y}) is outside of {self:?}");
        let i = self.index(x, y);
        let bit = 1 << (x % 64);
        if on { self.words[i] |= bit } else { self.words[i] &= !bit }
    }

    /// Whether no pixel is set.
    #[must_use]
    pub fn is_blank(&self) -> bool {
        self.words.iter().all(|&word| word == 0)
    }

    /// How many pixels are set.
    #[must_use]
    pub fn count(&self) -> usize {
        Arch::new().dispatch(Count(&self.words))
    }

    #[inline]
    fn index(&self, x: usize, y: usize) -> usize {
        1 + y * self.stride + x / 64
    }

    /// Words from one row to the next.
    pub(crate) fn stride(&self) -> usize {
        self.stride
    }

    /// Chunks a row.
    pub(crate) fn chunks(&self) -> usize {
        self.stride / CHUNK
    }

    /// A row's words between the blank ones beside it: `stride + 1` words.
    #[inline]
    pub(crate) fn padded(&self, y: usize) -> &[u64] {
        &self.words[y * self.stride..(y + 1) * self.stride + 1]
    }

    /// A row's words.
    #[inline]
    pub(crate) fn row(&self, y: usize) -> &[u64] {
        &self.words[y * self.stride + 1..(y + 1) * self.stride]
    }

    /// A row's words; pixels beyond the width must stay clear.
    #[inline]
    pub(crate) fn row_mut(&mut self, y: usize) -> &mut [u64] {
        &mut self.words[y * self.stride + 1..(y + 1) * self.stride]
    }

    /// A row, and those above and below; what lies outside is `blank`, which is as long as a padded row.
    #[inline(always)]
    pub(crate) fn around_row<'a>(&'a self, y: usize, blank: &'a [u64]) -> ThreeRows<'a> {
        let above = if y > 0 { self.padded(y - 1) } else { blank };
        let below = if y + 1 < self.height { self.padded(y + 1) } else { blank };
        ThreeRows { above, at: self.padded(y), below }
    }

    /// All words, blank ones included.
    pub(crate) fn words(&self) -> &[u64] {
        &self.words
    }

    /// All words, blank ones included, which must stay blank.
    pub(crate) fn words_mut(&mut self) -> &mut [u64] {
        &mut self.words
    }

    /// Sets every pixel for which `f(own, other)` has a bit, word by word.
    #[inline]
    fn combine(&mut self, other: &Self, f: impl Fn(u64, u64) -> u64) {
        assert!(self.width == other.width && self.height == other.height, "{self:?} and {other:?} differ in size");
        for (a, &b) in self.words.iter_mut().zip(&other.words) {
            *a = f(*a, b);
        }
    }

    /// Adds the pixels of another bitmap of the same size.
    pub fn add(&mut self, other: &Self) {
        self.combine(other, |a, b| a | b);
    }

    /// Keeps only the pixels that another bitmap of the same size has too.
    pub fn keep(&mut self, other: &Self) {
        self.combine(other, |a, b| a & b);
    }

    /// Takes out the pixels of another bitmap of the same size.
    pub fn remove(&mut self, other: &Self) {
        self.combine(other, |a, b| a & !b);
    }

    /// The pixels that another bitmap of the same size does not have.
    #[must_use]
    pub(crate) fn without(&self, other: &Self) -> Self {
        assert!(self.width == other.width && self.height == other.height, "{self:?} and {other:?} differ in size");
        let words = self.words.iter().zip(&other.words).map(|(a, b)| a & !b).collect();
        Self { words, ..*self }
    }

    /// The pixels that are not set.
    #[must_use]
    pub fn inverted(&self) -> Self {
        self.neither(self)
    }

    /// The pixels that neither this bitmap nor another of the same size has.
    #[must_use]
    pub(crate) fn neither(&self, other: &Self) -> Self {
        assert!(self.width == other.width && self.height == other.height, "{self:?} and {other:?} differ in size");
        let (used, last) = (self.width.div_ceil(64), self.last_word());
        let mut words: Vec<u64> = self.words.iter().zip(&other.words).map(|(a, b)| !(a | b)).collect();
        words[0] = 0;
        for row in words[1..].chunks_exact_mut(self.stride) {
            row[used..].fill(0);
            if let Some(word) = row[..used].last_mut() {
                *word &= last;
            }
        }
        Self { words, ..*self }
    }

    /// Sets the pixels that are not set, and clears the others.
    pub(crate) fn invert(&mut self) {
        let (inside, stride) = (self.inside(), self.stride);
        for row in self.words[1..].chunks_exact_mut(stride) {
            for (word, inside) in row.iter_mut().zip(&inside) {
                *word ^= inside;
            }
        }
    }

    /// A row of which every pixel is set.
    pub(crate) fn inside(&self) -> Vec<u64> {
        let mut row = vec![0; self.stride];
        let used = self.width.div_ceil(64);
        row[..used].fill(u64::MAX);
        if let Some(word) = row[..used].last_mut() {
            *word = self.last_word();
        }
        row
    }

    /// The bits in use of a row's last used word.
    pub(crate) fn last_word(&self) -> u64 {
        match self.width % 64 {
            0 => u64::MAX,
            n => (1 << n) - 1,
        }
    }

    /// The three pixels (x-1, y), (x, y), (x+1, y), in this order from the lowest bit.
    #[inline]
    fn three_pixels(&self, x: usize, y: usize) -> u64 {
        let at = y * self.stride + 1;
        let (word, bit) = (at + x / 64, x % 64);
        match bit {
            0 => (self.words[word] << 1 | self.words[word - 1] >> 63) & 7,
            63 => (self.words[word] >> 62 | self.words[word + 1] << 2) & 7,
            bit => self.words[word] >> (bit - 1) & 7,
        }
    }

    /// The eight pixels around one, clockwise from the pixel above it in the lowest bit.
    #[inline]
    pub(crate) fn around(&self, x: usize, y: usize) -> u8 {
        let above = if y > 0 { self.three_pixels(x, y - 1) } else { 0 };
        let at = self.three_pixels(x, y);
        let below = if y + 1 < self.height { self.three_pixels(x, y + 1) } else { 0 };
        let n_ne = above >> 1; // bit 0: north, bit 1: north-east
        let s_sw = (below >> 1 & 1) | (below & 1) << 1; // south, south-west
        ((n_ne & 3) | (at >> 2) << 2 | (below >> 2) << 3 | s_sw << 4 | (at & 1) << 6 | (above & 1) << 7) as u8
    }

    /// The places of all set pixels, row by row from the left.
    pub fn pixels(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        (0..self.height).flat_map(move |y| {
            self.row(y).iter().enumerate().flat_map(move |(i, &word)| ones(word).map(move |bit| (i * 64 + bit, y)))
        })
    }

    /// The picture with `margin` (a multiple of 64) more pixels on every side, as its border pixels have it.
    pub(crate) fn with_margin(&self, margin: usize) -> Self {
        debug_assert!(margin.is_multiple_of(64));
        let mut wide = Self::new(self.width + 2 * margin, self.height + 2 * margin);
        if self.width == 0 || self.height == 0 {
            return wide;
        }
        let (pad, used, bit) = (margin / 64, self.width.div_ceil(64), self.width % 64);
        for y in 0..self.height {
            let (first, last) = (self.get(0, y as isize), self.get(self.width as isize - 1, y as isize));
            let from = self.row(y);
            let to = wide.row_mut(y + margin);
            to[..pad].fill(if first { u64::MAX } else { 0 });
            to[pad..pad + used].copy_from_slice(&from[..used]);
            if last {
                if bit > 0 {
                    to[pad + used - 1] |= u64::MAX << bit;
                }
                to[pad + used..][..pad].fill(u64::MAX);
                if bit > 0 {
                    to[pad + used + pad - 1] &= (1 << bit) - 1;
                }
            }
        }
        for y in 0..margin {
            let stride = wide.stride;
            let (top, bottom) = (margin, margin + self.height - 1);
            wide.words.copy_within(1 + top * stride..(top + 1) * stride, 1 + y * stride);
            wide.words.copy_within(1 + bottom * stride..(bottom + 1) * stride, 1 + (bottom + 1 + y) * stride);
        }
        wide
    }

    /// The picture with rows and columns exchanged.
    #[must_use]
    pub(crate) fn transposed(&self) -> Self {
        let mut result = Self::new(self.height, self.width);
        let mut block = [0u64; 64];
        for top in (0..self.height).step_by(64) {
            let rows = (self.height - top).min(64);
            for k in 0..self.width.div_ceil(64) {
                block[rows..].fill(0);
                let mut any = 0;
                for (i, word) in block[..rows].iter_mut().enumerate() {
                    *word = self.row(top + i)[k];
                    any |= *word;
                }
                if any == 0 {
                    continue;
                }
                transpose(&mut block);
                for (i, &word) in block.iter().enumerate().take((self.width - k * 64).min(64)) {
                    result.row_mut(k * 64 + i)[top / 64] = word;
                }
            }
        }
        result
    }

    /// How many pixels are set in a stretch of a row.
    pub(crate) fn count_between(&self, y: usize, from: usize, to: usize) -> usize {
        let row = self.row(y);
        stretch(from, to).map(|(k, mask)| (row[k] & mask).count_ones() as usize).sum()
    }

    /// Whether all pixels of a stretch of a row are set; those outside of the picture are not.
    #[inline]
    pub(crate) fn is_full(&self, y: isize, from: isize, to: isize) -> bool {
        if y < 0 || y as usize >= self.height || from < 0 || to > self.width as isize {
            return false;
        }
        let row = self.row(y as usize);
        stretch(from as usize, to as usize).all(|(k, mask)| row[k] & mask == mask)
    }

    /// Whether any pixel of a stretch of a row is set, as far as it lies inside of the picture.
    pub(crate) fn has_between(&self, y: i32, from: i32, to: i32) -> bool {
        if y < 0 || y as usize >= self.height || to <= 0 {
            return false;
        }
        let row = self.row(y as usize);
        stretch(from.max(0) as usize, (to as usize).min(self.width)).any(|(k, mask)| row[k] & mask != 0)
    }

    /// Sets or clears a stretch of a row.
    pub(crate) fn set_between(&mut self, y: usize, from: usize, to: usize, on: bool) {
        assert!(y < self.height && to <= self.width, "pixels {from} to {to} of row {y} are outside of {self:?}");
        let row = self.row_mut(y);
        for (k, mask) in stretch(from, to) {
            if on { row[k] |= mask } else { row[k] &= !mask }
        }
    }

    /// A window of another picture; what lies outside of that is not set.
    pub(crate) fn from_window(of: &Self, corner: IVec2, width: usize, height: usize) -> Self {
        let mut window = Self::new(width, height);
        window.add_from(of, corner, IVec2::ZERO, IVec2::new(width as i32, height as i32));
        window
    }

    /// Adds a part of another picture: what lies there from one corner on is added from another corner on. Pixels outside
    /// of either picture count for nothing.
    pub(crate) fn add_from(&mut self, other: &Self, from: IVec2, to: IVec2, size: IVec2) {
        // Only what lies inside of both.
        let low = (-from).max(-to).max(IVec2::ZERO);
        let extent = |of: &Self| IVec2::new(of.width as i32, of.height as i32);
        let high = (extent(other) - from).min(extent(self) - to).min(size);
        if low.cmpge(high).any() {
            return;
        }
        let (from, to) = ((from + low).as_usizevec2(), (to + low).as_usizevec2());
        let (width, height) = ((high.x - low.x) as usize, (high.y - low.y) as usize);
        let (here, there) = (self.index(to.x, to.y), other.index(from.x, from.y));
        if from.x.is_multiple_of(64) && to.x.is_multiple_of(64) && width.is_multiple_of(64) {
            for row in 0..height {
                let (here, there) = (here + row * self.stride, there + row * other.stride);
                for (here, there) in self.words[here..][..width / 64].iter_mut().zip(&other.words[there..]) {
                    *here |= there;
                }
            }
            return;
        }
        // The pixel there that comes into the lowest bit of the first word here, counted from the word before.
        let first = 64 + from.x % 64 - to.x % 64;
        let (there, bit) = (there + first / 64 - 1, first % 64);
        // Word by word down the rows: most of what is taken is narrow.
        for (k, mask) in stretch(to.x % 64, to.x % 64 + width) {
            let (mut here, mut there) = (here + k, there + k);
            for _ in 0..height {
                // Shifted out by two steps where it is by 64; there is no word after the last.
                let (low, high) = (other.words[there] >> bit, other.words.get(there + 1).map_or(0, |next| next << 1 << (63 - bit)));
                self.words[here] |= (low | high) & mask;
                (here, there) = (here + self.stride, there + other.stride);
            }
        }
    }

    /// Takes rows of another picture of the same width, from row `to` on.
    pub(crate) fn copy_rows(&mut self, other: &Self, rows: core::ops::Range<usize>, to: usize) {
        let n = rows.len() * self.stride;
        self.words[1 + to * self.stride..][..n].copy_from_slice(&other.words[1 + rows.start * other.stride..][..n]);
    }

    /// The picture without `margin` (a multiple of 64) pixels on every side.
    pub(crate) fn without_margin(&self, margin: usize) -> Self {
        debug_assert!(margin.is_multiple_of(64));
        let mut inner = Self::new(self.width - 2 * margin, self.height - 2 * margin);
        let (used, last) = (inner.width.div_ceil(64), inner.last_word());
        for y in 0..inner.height {
            let from = &self.row(y + margin)[margin / 64..][..used];
            let to = &mut inner.row_mut(y)[..used];
            to.copy_from_slice(from);
            if let Some(word) = to.last_mut() {
                *word &= last;
            }
        }
        inner
    }
}

impl fmt::Debug for Bitmap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "bitmap of {} × {} pixels", self.width, self.height)
    }
}

/// The words of a row that hold the pixels from one to before another, and which of their bits these are.
fn stretch(from: usize, to: usize) -> impl Iterator<Item = (usize, u64)> {
    let below = |n: usize| if n >= 64 { u64::MAX } else { (1 << n) - 1 };
    let words = if from < to { from / 64..to.div_ceil(64) } else { 0..0 };
    words.map(move |k| (k, below(to - k * 64) & !below(from.saturating_sub(k * 64))))
}

/// The pixel that a point lies in.
#[inline]
pub(crate) fn pixel_of(p: DVec2) -> (isize, isize) {
    // As `floor`, which is a call where the processor is not known to have an instruction for it.
    let below = |v: f64| v as isize - isize::from(v < (v as isize) as f64);
    (below(p.x), below(p.y))
}

/// Exchanges rows and columns of 64 × 64 bits, by exchanging ever smaller quarters.
fn transpose(block: &mut [u64; 64]) {
    let (mut half, mut mask) = (32, 0x0000_0000_FFFF_FFFFu64);
    while half > 0 {
        let mut i = 0;
        while i < 64 {
            let t = (block[i] >> half ^ block[i + half]) & mask;
            block[i] ^= t << half;
            block[i + half] ^= t;
            i = (i + half + 1) & !half;
        }
        half /= 2;
        mask ^= mask << half;
    }
}

/// The numbers of a word's set bits, from the lowest.
#[inline]
pub(crate) fn ones(mut word: u64) -> impl Iterator<Item = usize> {
    core::iter::from_fn(move || {
        let bit = word.trailing_zeros() as usize;
        (word != 0).then(|| {
            word &= word - 1;
            bit
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_around_are_told_clockwise_from_above() {
        let around = [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1)];
        for x in [1usize, 62, 63, 64, 65, 127, 128, 511, 512] {
            for (i, (dx, dy)) in around.into_iter().enumerate() {
                let mut bitmap = Bitmap::new(600, 3);
                bitmap.set((x as isize + dx) as usize, (1 + dy) as usize, true);
                assert_eq!(bitmap.around(x, 1), 1 << i, "neighbour {i} of x = {x}");
            }
        }
    }

    #[test]
    fn a_margin_repeats_the_border_and_comes_off_again() {
        for width in [3, 64, 100, 512, 700] {
            let bitmap = Bitmap::from_fn(width, 5, |x, y| (x * 7 + y * 3) % 5 < 2);
            let wide = bitmap.with_margin(64);
            for y in 0..wide.height() {
                for x in 0..wide.width() {
                    let (px, py) = (x as isize - 64, y as isize - 64);
                    let inside = bitmap.get(px.clamp(0, width as isize - 1), py.clamp(0, 4));
                    assert_eq!(wide.get(x as isize, y as isize), inside, "({px}, {py}) of width {width}");
                }
            }
            assert_eq!(wide.without_margin(64), bitmap);
            assert_eq!(wide.count(), wide.pixels().count());
        }
    }

    #[test]
    fn rows_become_columns() {
        for (width, height) in [(1, 1), (64, 64), (70, 130), (513, 40)] {
            let bitmap = Bitmap::from_fn(width, height, |x, y| (x * 11 + y * y * 7) % 13 < 5);
            let turned = bitmap.transposed();
            assert_eq!(turned, Bitmap::from_fn(height, width, |x, y| bitmap.get(y as isize, x as isize)));
        }
    }

    #[test]
    fn a_window_shows_what_is_there_and_nothing_outside() {
        let bitmap = Bitmap::from_fn(150, 20, |x, y| (x * 5 + y * 3) % 7 < 3);
        for (left, top) in [(-70, -3), (0, 0), (13, 5), (64, 2), (100, 15)] {
            let window = Bitmap::from_window(&bitmap, IVec2::new(left as i32, top as i32), 90, 12);
            let is_same = |x: isize, y: isize| window.get(x, y) == bitmap.get(x + left, y + top);
            assert!((0..90).all(|x| (0..12).all(|y| is_same(x, y))), "window at ({left}, {top})");
            assert_eq!(window.count(), window.pixels().count());
        }
    }

    #[test]
    fn what_is_not_set_is_set_in_the_inverse_and_nothing_outside() {
        let bitmap = Bitmap::from_fn(70, 4, |x, y| x == y);
        assert_eq!(bitmap.inverted().count(), 70 * 4 - 4);
        assert_eq!(bitmap.inverted().inverted(), bitmap);
    }

    #[test]
    fn what_one_has_without_another_and_what_neither_has_are_told_pixel_by_pixel() {
        for width in [1, 63, 64, 65, 511, 512, 513] {
            let [a, b] = [5, 3].map(|n| Bitmap::from_fn(width, 7, |x, y| (x * n + y * y) % 7 < 3));
            let of = |is_set: fn(bool, bool) -> bool| {
                Bitmap::from_fn(width, 7, |x, y| is_set(a.get(x as isize, y as isize), b.get(x as isize, y as isize)))
            };
            assert_eq!(a.without(&b), of(|a, b| a && !b), "width {width}");
            assert_eq!(a.neither(&b), of(|a, b| !a && !b), "width {width}");
            let mut inverse = a.clone();
            inverse.invert();
            assert_eq!(inverse, a.inverted(), "width {width}");
        }
    }
}
