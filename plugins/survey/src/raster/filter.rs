//! Filters that look at a pixel's neighbours, 64 pixels at a time by adding bits in slices.

use pulp::{Arch, NullaryFnOnce};

use super::bitmap::Bitmap;
use super::lanes::{Beside, Lanes, beside, eight, full_add};
use super::outline::Corners;
use super::parts::Parts;
use super::patches::Patches;

/// The pixels with at least 13 of the 25 around them (themselves among these) set: the median of 5 × 5.
#[must_use]
pub(crate) fn median5(bitmap: &Bitmap) -> Bitmap {
    Arch::new().dispatch(Median5(bitmap))
}

/// The pixels that are set or touch, by side or corner, one that is.
#[must_use]
pub(crate) fn dilated(bitmap: &Bitmap) -> Bitmap {
    Arch::new().dispatch(Dilated::<1>(bitmap))
}

/// What [`dilated`] makes of what it has made.
#[must_use]
pub(crate) fn dilated_twice(bitmap: &Bitmap) -> Bitmap {
    Arch::new().dispatch(Dilated::<2>(bitmap))
}

/// The pixels with at least four of the nine around them (themselves among these) set.
#[must_use]
pub(crate) fn crowded(bitmap: &Bitmap) -> Bitmap {
    Arch::new().dispatch(Crowded(bitmap))
}

/// Decides `unknown` pixels by the known ones around them, the nearest first: those with more `set` than unset known
/// neighbours become set, the others not. What nothing known surrounds stays unset.
#[must_use]
pub(crate) fn filled(set: &Bitmap, unknown: &Bitmap) -> Bitmap {
    filled_among(set, unknown, &Parts::of(unknown, Corners::Join))
}

/// As [`filled`], with the connected parts (by corners too) of what is `unknown`.
#[must_use]
pub(crate) fn filled_among(set: &Bitmap, unknown: &Bitmap, parts: &Parts) -> Bitmap {
    let mut known = set.without(unknown);
    let patches = Patches::among(parts, &known);
    let unset = set.neither(unknown);
    let of = [&patches.shown(&known), &patches.shown(&unset), &patches.parts()];
    let decided = patches.sheet_by_sheet(of, |[set, unset, parts]| {
        let mut filling = Filling::of(set, unset, parts);
        while Arch::new().dispatch(&mut filling) {}
        filling.set.keep(&filling.parts);
        filling.set
    });
    patches.put_back(&decided, &mut known);
    known
}

struct Median5<'a>(&'a Bitmap);

/// Sums of five pixels side by side, three bits each.
type Five = [Lanes; 3];

#[inline(always)]
fn five(words: &Beside) -> Five {
    let (s, c) = full_add(Lanes::west(words, 1), Lanes::here(words), Lanes::east(words, 1));
    let (sum, d) = full_add(s, Lanes::west(words, 2), Lanes::east(words, 2));
    [sum, c ^ d, c & d]
}

impl NullaryFnOnce for Median5<'_> {
    type Output = Bitmap;

    #[inline(always)]
    fn call(self) -> Bitmap {
        let bitmap = self.0;
        let (height, chunks) = (bitmap.height(), bitmap.chunks());
        let mut result = Bitmap::new(bitmap.width(), height);
        let inside = bitmap.inside();
        // Sums of the row, of the two above and of the two below, in turn.
        let mut sums = vec![[[Lanes::NONE; 3]; 5]; chunks];
        for y in 0..height + 2 {
            for (chunk, sums) in sums.iter_mut().enumerate() {
                sums[y % 5] = if y < height { five(beside(bitmap.padded(y), chunk)) } else { [Lanes::NONE; 3] };
                if y >= 2 {
                    let [a, b, c, d, e] = *sums;
                    (most(a, b, c, d, e) & Lanes::of(&inside, chunk)).write(result.row_mut(y - 2), chunk);
                }
            }
        }
        result
    }
}

/// Whether five numbers of three bits add up to 13 or more.
#[inline(always)]
fn most(a: Five, b: Five, c: Five, d: Five, e: Five) -> Lanes {
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

/// The pixels with one set at most so many rows and columns away.
struct Dilated<'a, const REACH: usize>(&'a Bitmap);

impl<const REACH: usize> NullaryFnOnce for Dilated<'_, REACH> {
    type Output = Bitmap;

    #[inline(always)]
    fn call(self) -> Bitmap {
        const { assert!(REACH <= 2, "five rows are kept") };
        let bitmap = self.0;
        let (height, chunks) = (bitmap.height(), bitmap.chunks());
        let mut result = Bitmap::new(bitmap.width(), height);
        let inside = bitmap.inside();
        let mut wide = vec![[Lanes::NONE; 5]; chunks];
        for y in 0..height + REACH {
            for (chunk, wide) in wide.iter_mut().enumerate() {
                let here = &mut wide[y % (2 * REACH + 1)];
                *here = Lanes::NONE;
                if y < height {
                    let words = beside(bitmap.padded(y), chunk);
                    *here = Lanes::here(words);
                    for n in 1..=REACH as u32 {
                        *here |= Lanes::west(words, n) | Lanes::east(words, n);
                    }
                }
                if y >= REACH {
                    let [a, b, c, d, e] = *wide;
                    ((a | b | c | d | e) & Lanes::of(&inside, chunk)).write(result.row_mut(y - REACH), chunk);
                }
            }
        }
        result
    }
}

struct Crowded<'a>(&'a Bitmap);

impl NullaryFnOnce for Crowded<'_> {
    type Output = Bitmap;

    #[inline(always)]
    fn call(self) -> Bitmap {
        let (bitmap, height) = (self.0, self.0.height());
        let mut result = Bitmap::new(bitmap.width(), height);
        let inside = bitmap.inside();
        let blank = vec![0; bitmap.stride() + 1];
        for y in 0..height {
            let (rows, to) = (bitmap.around_row(y, &blank), result.row_mut(y));
            for chunk in 0..bitmap.chunks() {
                let three = rows.chunk(chunk);
                let [one, two, four, eight] = eight(three.ring());
                let four_of_nine = four | eight | (one & two & Lanes::here(three.at));
                (four_of_nine & Lanes::of(&inside, chunk)).write(to, chunk);
            }
        }
        result
    }
}

struct Filling {
    set: Bitmap,
    unset: Bitmap,
    /// What was to be decided.
    parts: Bitmap,
    /// What of it is not yet.
    rest: Bitmap,
    /// For each row, whether that may be anything.
    open: Vec<bool>,
    blank: Vec<u64>,
}

impl Filling {
    fn of(set: Bitmap, unset: Bitmap, parts: Bitmap) -> Self {
        let blank = vec![0; set.stride() + 1];
        Self { set, unset, open: vec![true; parts.height()], rest: parts.clone(), parts, blank }
    }
}

/// Where one number is greater than another.
#[inline(always)]
fn greater(a: [Lanes; 4], b: [Lanes; 4]) -> Lanes {
    let (mut more, mut same) = (Lanes::NONE, Lanes::ALL);
    for i in (0..4).rev() {
        more |= same & a[i] & !b[i];
        same &= !(a[i] ^ b[i]);
    }
    more
}

/// What is decided in a row, written when the next has been looked at.
struct Decided {
    row: usize,
    any: bool,
    set: Vec<u64>,
    unset: Vec<u64>,
}

impl NullaryFnOnce for &mut Filling {
    type Output = bool;

    /// One layer; whether anything was decided.
    #[inline(always)]
    fn call(self) -> bool {
        let (height, stride) = (self.set.height(), self.set.stride());
        let mut any = false;
        let new = || Decided { row: 0, any: false, set: vec![0; stride], unset: vec![0; stride] };
        let (mut pending, mut now) = (new(), new());
        for y in 0..=height {
            (now.row, now.any) = (y, false);
            if y < height && self.open[y] {
                self.decide(y, &mut now);
            }
            if pending.any {
                let y = pending.row;
                add_words(self.set.row_mut(y), &pending.set);
                add_words(self.unset.row_mut(y), &pending.unset);
                for (rest, (set, unset)) in self.rest.row_mut(y).iter_mut().zip(pending.set.iter().zip(&pending.unset)) {
                    *rest &= !(set | unset);
                }
                any = true;
            }
            core::mem::swap(&mut pending, &mut now);
        }
        any
    }
}

#[inline(always)]
fn add_words(to: &mut [u64], more: &[u64]) {
    for (to, more) in to.iter_mut().zip(more) {
        *to |= more;
    }
}

impl Filling {
    /// Decides the pixels of a row that have a known neighbour.
    #[inline(always)]
    fn decide(&mut self, y: usize, now: &mut Decided) {
        let (mut left, mut any) = (false, Lanes::NONE);
        let (set_rows, unset_rows) = (self.set.around_row(y, &self.blank), self.unset.around_row(y, &self.blank));
        for chunk in 0..self.set.chunks() {
            let rest = Lanes::of(self.rest.row(y), chunk);
            let (mut set, mut unset) = (Lanes::NONE, Lanes::NONE);
            if rest.any() {
                left = true;
                let yes = eight(set_rows.chunk(chunk).ring());
                let no = eight(unset_rows.chunk(chunk).ring());
                let seen = rest & (yes[0] | yes[1] | yes[2] | yes[3] | no[0] | no[1] | no[2] | no[3]);
                let more = greater(yes, no);
                (set, unset) = (seen & more, seen & !more);
                any |= seen;
            }
            set.write(&mut now.set, chunk);
            unset.write(&mut now.unset, chunk);
        }
        self.open[y] = left;
        now.any = any.any();
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
            let (median, near, nearer, some) = (median5(&bitmap), dilated_twice(&bitmap), dilated(&bitmap), crowded(&bitmap));
            for y in 0..height {
                for x in 0..width {
                    let (px, py) = (x as isize, y as isize);
                    prop_assert_eq!(median.get(px, py), set_within(&bitmap, x, y, 2) >= 13, "median at {}, {}", x, y);
                    prop_assert_eq!(near.get(px, py), set_within(&bitmap, x, y, 2) >= 1);
                    prop_assert_eq!(nearer.get(px, py), set_within(&bitmap, x, y, 1) >= 1);
                    prop_assert_eq!(some.get(px, py), set_within(&bitmap, x, y, 1) >= 4);
                }
            }
            for bitmap in [median, near, nearer, some] {
                prop_assert_eq!(bitmap.pixels().filter(|&(x, _)| x >= width).count(), 0);
            }
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
