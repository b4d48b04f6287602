//! Filters that look at a pixel's neighbours, 64 pixels at a time by adding bits in slices.

use pulp::{Arch, NullaryFnOnce};

use super::bitmap::{Bitmap, CHUNK};

/// The pixels with at least 13 of the 25 around them (themselves among these) set: the median of 5 × 5.
#[must_use]
pub(crate) fn median5(bitmap: &Bitmap) -> Bitmap {
    Arch::new().dispatch(Median5(bitmap))
}

/// The pixels that are set or touch, by side or corner, one that is.
#[must_use]
pub(crate) fn dilated(bitmap: &Bitmap) -> Bitmap {
    let inside = frame(bitmap);
    Arch::new().dispatch(Near { bitmap, at_least: 1, inside })
}

/// The pixels with at least so many (1 to 4) of the nine around them (themselves among these) set.
#[must_use]
pub(crate) fn crowded(bitmap: &Bitmap, at_least: u32) -> Bitmap {
    let inside = frame(bitmap);
    Arch::new().dispatch(Near { bitmap, at_least, inside })
}

/// Decides `unknown` pixels by the known ones around them, the nearest first: those with more `set` than unset known
/// neighbours become set, the others not. What nothing known surrounds stays unset.
#[must_use]
pub(crate) fn filled(set: &Bitmap, unknown: &Bitmap) -> Bitmap {
    let mut filling = Filling::of(set, unknown);
    let arch = Arch::new();
    while arch.dispatch(&mut filling) {}
    filling.set
}

/// The words of a row in which there may be pixels, the last one's bits in use only.
fn frame(bitmap: &Bitmap) -> Vec<u64> {
    let mut row = vec![0; bitmap.stride()];
    let used = bitmap.width().div_ceil(64);
    row[..used].fill(u64::MAX);
    if let Some(word) = row[..used].last_mut() {
        *word = bitmap.last_word();
    }
    row
}

/// Sum of two bits and a carry: (sum, carry).
#[inline(always)]
fn full_add(a: u64, b: u64, c: u64) -> (u64, u64) {
    (a ^ b ^ c, (a & b) | (c & (a ^ b)))
}

struct Median5<'a>(&'a Bitmap);

/// A row's sums of five pixels side by side, three bits each.
#[derive(Clone)]
struct Fives([Vec<u64>; 3]);

impl Fives {
    fn new(stride: usize) -> Self {
        Self([vec![0; stride], vec![0; stride], vec![0; stride]])
    }

    /// Sums a row, given with the blank words beside it.
    #[inline(always)]
    fn sum(&mut self, row: &[u64]) {
        let [ones, twos, fours] = &mut self.0;
        let n = row.len() - 1;
        for (k, ((one, two), four)) in ones[..n].iter_mut().zip(&mut twos[..n]).zip(&mut fours[..n]).enumerate().take(n - 1) {
            let (before, at, after) = (row[k], row[k + 1], row[k + 2]);
            let (w1, w2) = (at << 1 | before >> 63, at << 2 | before >> 62);
            let (e1, e2) = (at >> 1 | after << 63, at >> 2 | after << 62);
            let (s, c) = full_add(w1, at, e1);
            let (sum, d) = full_add(s, w2, e2);
            (*one, *two, *four) = (sum, c ^ d, c & d);
        }
    }

    fn clear(&mut self) {
        self.0.iter_mut().for_each(|slice| slice.fill(0));
    }
}

impl NullaryFnOnce for Median5<'_> {
    type Output = Bitmap;

    #[inline(always)]
    fn call(self) -> Bitmap {
        let bitmap = self.0;
        let (height, stride) = (bitmap.height(), bitmap.stride());
        let mut result = Bitmap::new(bitmap.width(), height);
        let inside = frame(bitmap);
        let mut sums = vec![Fives::new(stride); 5];
        for (y, sum) in sums.iter_mut().enumerate().take(height.min(2)) {
            sum.sum(bitmap.padded(y));
        }
        for y in 0..height {
            match y + 2 {
                next if next < height => sums[next % 5].sum(bitmap.padded(next)),
                next => sums[next % 5].clear(),
            }
            let [a, b, c, d, e] = &sums[..] else { continue };
            let to = result.row_mut(y);
            let n = to.len();
            for k in 0..n {
                let at = |row: &Fives| [row.0[0][k], row.0[1][k], row.0[2][k]];
                to[k] = most(at(a), at(b), at(c), at(d), at(e)) & inside[k];
            }
        }
        result
    }
}

/// Whether five numbers of three bits add up to 13 or more.
#[inline(always)]
fn most(a: [u64; 3], b: [u64; 3], c: [u64; 3], d: [u64; 3], e: [u64; 3]) -> u64 {
    // Carry-save: three numbers at a time become two.
    let (s0, k1) = full_add(a[0], b[0], c[0]);
    let (s1, k2) = full_add(a[1], b[1], c[1]);
    let (s2, k3) = full_add(a[2], b[2], c[2]);
    let (t0, l1) = full_add(s0, d[0], e[0]);
    let (t1, l2) = full_add(s1, d[1], e[1]);
    let (t2, l3) = full_add(s2, d[2], e[2]);
    let (u1, m2) = full_add(t1, k1, l1);
    let (u2, m3) = full_add(t2, k2, l2);
    let (v2, n3) = (u2 ^ m2, u2 & m2);
    let (w3, n4) = full_add(k3, l3, m3);
    let (w3, o4) = (w3 ^ n3, w3 & n3);
    let sixteen = n4 | o4;
    sixteen | (w3 & v2 & (u1 | t0))
}

struct Near<'a> {
    bitmap: &'a Bitmap,
    at_least: u32,
    inside: Vec<u64>,
}

impl NullaryFnOnce for Near<'_> {
    type Output = Bitmap;

    #[inline(always)]
    fn call(self) -> Bitmap {
        let (bitmap, height) = (self.bitmap, self.bitmap.height());
        let mut result = Bitmap::new(bitmap.width(), height);
        let blank = vec![0; bitmap.stride() + 1];
        for y in 0..height {
            let above = if y > 0 { bitmap.padded(y - 1) } else { &blank };
            let below = if y + 1 < height { bitmap.padded(y + 1) } else { &blank };
            let rows = [above, bitmap.padded(y), below];
            let to = result.row_mut(y);
            for k in 0..to.len() {
                // Saturating counts in unary: seen[n] where more than n are set.
                let mut seen = [0u64; 4];
                for row in rows {
                    for bit in [row[k + 1] << 1 | row[k] >> 63, row[k + 1], row[k + 1] >> 1 | row[k + 2] << 63] {
                        seen[3] |= seen[2] & bit;
                        seen[2] |= seen[1] & bit;
                        seen[1] |= seen[0] & bit;
                        seen[0] |= bit;
                    }
                }
                to[k] = seen[self.at_least as usize - 1] & self.inside[k];
            }
        }
        result
    }
}

struct Filling {
    set: Bitmap,
    unset: Bitmap,
    /// For each row, whether it may still have undecided pixels.
    open: Vec<bool>,
    inside: Vec<u64>,
}

impl Filling {
    fn of(set: &Bitmap, unknown: &Bitmap) -> Self {
        let mut known = set.clone();
        known.remove(unknown);
        let mut unset = set.inverted();
        unset.remove(unknown);
        let open = (0..set.height()).map(|y| unknown.row(y).iter().any(|&w| w != 0)).collect();
        Self { inside: frame(set), set: known, unset, open }
    }
}

/// Numbers of eight bits, as a sum of four bits.
#[inline(always)]
fn eight(ring: [u64; 8]) -> [u64; 4] {
    let (s1, c1) = full_add(ring[0], ring[1], ring[2]);
    let (s2, c2) = full_add(ring[3], ring[4], ring[5]);
    let (s3, c3) = full_add(s1, s2, ring[6]);
    let (b0, c4) = (s3 ^ ring[7], s3 & ring[7]);
    let (t, d1) = full_add(c1, c2, c3);
    let (b1, d2) = (t ^ c4, t & c4);
    [b0, b1, d1 ^ d2, d1 & d2]
}

/// Where one number is greater than another.
#[inline(always)]
fn greater(a: [u64; 4], b: [u64; 4]) -> u64 {
    let (mut more, mut same) = (0, u64::MAX);
    for i in (0..4).rev() {
        more |= same & a[i] & !b[i];
        same &= !(a[i] ^ b[i]);
    }
    more
}

impl NullaryFnOnce for &mut Filling {
    type Output = bool;

    /// One layer; whether anything was decided.
    #[inline(always)]
    fn call(self) -> bool {
        let (height, stride) = (self.set.height(), self.set.stride());
        let blank = vec![0; stride + 1];
        let mut any = false;
        // What is decided in a row is written when the next has been looked at.
        let (mut pending, mut now) = ((0, vec![0; stride], vec![0; stride], false), (vec![0; stride], vec![0; stride]));
        for y in 0..=height {
            let mut decided = false;
            let is_open = y < height && self.open[y];
            if is_open {
                let mut left = false;
                for chunk in 0..stride / CHUNK {
                    let from = chunk * CHUNK;
                    let unknown: u64 = (from..from + CHUNK)
                        .map(|k| self.inside[k] & !(self.set.row(y)[k] | self.unset.row(y)[k]))
                        .fold(0, |a, b| a | b);
                    now.0[from..from + CHUNK].fill(0);
                    now.1[from..from + CHUNK].fill(0);
                    if unknown == 0 {
                        continue;
                    }
                    left = true;
                    for k in from..from + CHUNK {
                        let ring = |of: &Bitmap| {
                            let above = if y > 0 { of.padded(y - 1) } else { &blank[..] };
                            let below = if y + 1 < height { of.padded(y + 1) } else { &blank[..] };
                            let at = of.padded(y);
                            let west = |r: &[u64]| r[k + 1] << 1 | r[k] >> 63;
                            let east = |r: &[u64]| r[k + 1] >> 1 | r[k + 2] << 63;
                            let sides = [west(above), above[k + 1], east(above), west(at)];
                            eight([sides[0], sides[1], sides[2], sides[3], east(at), west(below), below[k + 1], east(below)])
                        };
                        let open = self.inside[k] & !(self.set.row(y)[k] | self.unset.row(y)[k]);
                        let (yes, no) = (ring(&self.set), ring(&self.unset));
                        let seen = open & (yes[0] | yes[1] | yes[2] | yes[3] | no[0] | no[1] | no[2] | no[3]);
                        let more = greater(yes, no);
                        now.0[k] = seen & more;
                        now.1[k] = seen & !more;
                        decided |= seen != 0;
                    }
                }
                self.open[y] = left;
            }
            if pending.3 {
                let (row, yes, no, _) = &pending;
                for (to, from) in self.set.row_mut(*row).iter_mut().zip(yes) {
                    *to |= from;
                }
                for (to, from) in self.unset.row_mut(*row).iter_mut().zip(no) {
                    *to |= from;
                }
            }
            core::mem::swap(&mut pending.1, &mut now.0);
            core::mem::swap(&mut pending.2, &mut now.1);
            pending.0 = y;
            pending.3 = decided;
            any |= decided;
        }
        any
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn noise(width: usize, height: usize, density: u64, seed: u64) -> Bitmap {
        Bitmap::from_fn(width, height, |x, y| {
            let n = (x as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ (y as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F) ^ seed;
            (n ^ n >> 29).wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 60 < density
        })
    }

    fn set_within(bitmap: &Bitmap, x: usize, y: usize, reach: isize) -> usize {
        let steps = || -reach..=reach;
        steps()
            .flat_map(|dy| steps().map(move |dx| (dx, dy)))
            .filter(|(dx, dy)| bitmap.get(x as isize + dx, y as isize + dy))
            .count()
    }

    proptest! {
        #[test]
        fn filters_count_as_a_person_would(width in prop_oneof![1usize..200, Just(512), Just(1024), 505usize..520], height in 1usize..12, density in 1u64..16, seed: u64) {
            let bitmap = noise(width, height, density, seed);
            let (median, near, three) = (median5(&bitmap), dilated(&bitmap), crowded(&bitmap, 3));
            for y in 0..height {
                for x in 0..width {
                    let (px, py) = (x as isize, y as isize);
                    prop_assert_eq!(median.get(px, py), set_within(&bitmap, x, y, 2) >= 13, "median at {}, {}", x, y);
                    prop_assert_eq!(near.get(px, py), set_within(&bitmap, x, y, 1) >= 1);
                    prop_assert_eq!(three.get(px, py), set_within(&bitmap, x, y, 1) >= 3);
                }
            }
            prop_assert_eq!(median.pixels().filter(|&(x, _)| x >= width).count(), 0);
        }

        #[test]
        fn filling_leaves_what_is_known_and_decides_the_rest(width in prop_oneof![1usize..150, Just(512), 505usize..520], height in 1usize..20, seed: u64) {
            let (set, unknown) = (noise(width, height, 8, seed), noise(width / 7 + 1, height, 5, !seed));
            let unknown = Bitmap::from_fn(width, height, |x, y| unknown.get((x / 7) as isize, y as isize));
            let filled = filled(&set, &unknown);
            for (x, y) in (0..width).flat_map(|x| (0..height).map(move |y| (x as isize, y as isize))) {
                prop_assert!(unknown.get(x, y) || filled.get(x, y) == set.get(x, y), "a known pixel changed");
            }
        }
    }

    #[test]
    fn a_letter_on_a_street_becomes_street_and_one_beside_it_does_not() {
        let street = Bitmap::from_fn(100, 60, |_, y| (20..40).contains(&y));
        let mut seen = street.clone();
        let letters = Bitmap::from_fn(100, 60, |x, y| {
            ((30..36).contains(&x) && (24..36).contains(&y)) || ((60..66).contains(&x) && (44..56).contains(&y))
        });
        seen.remove(&letters);
        assert_eq!(filled(&seen, &letters), street);
    }
}
