//! Growing and shrinking by discs.

use glam::{DVec2, USizeVec2};
use pulp::{Arch, NullaryFnOnce};

use super::bitmap::Bitmap;

/// Words that are swept together, so that all passes' results stay near the processor.
const WORDS: usize = 8192;
/// Pixels a side of what is swept together where only some places are asked for.
const TILE_PX: usize = 384;

/// A change of what is set by a disc (by an octagon, which is near enough to one).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sweep {
    /// Adds what lies within so many pixels of what is set.
    Grow(usize),
    /// Leaves what lies more than so many pixels inside of what is set. Beyond the border all is taken to be set.
    Shrink(usize),
}

impl Sweep {
    fn steps(self) -> usize {
        match self {
            Self::Grow(steps) | Self::Shrink(steps) => steps,
        }
    }
}

/// What lies within so many pixels of what is set.
#[must_use]
pub(crate) fn grown(bitmap: &Bitmap, steps: usize) -> Bitmap {
    swept(bitmap, &[Sweep::Grow(steps)])
}

/// What lies more than so many pixels inside of what is set.
#[must_use]
pub(crate) fn shrunk(bitmap: &Bitmap, steps: usize) -> Bitmap {
    swept(bitmap, &[Sweep::Shrink(steps)])
}

/// What sweeps make, one after another.
#[must_use]
pub(crate) fn swept(bitmap: &Bitmap, sweeps: &[Sweep]) -> Bitmap {
    let (width, height) = (bitmap.width(), bitmap.height());
    let reach: usize = sweeps.iter().map(|sweep| sweep.steps()).sum();
    let rows = (WORDS / bitmap.stride()).max(2 * reach).max(1);
    let mut result = Bitmap::new(width, height);
    for top in (0..height).step_by(rows) {
        let (from, to, end) = (top.saturating_sub(reach), (top + rows + reach).min(height), (top + rows).min(height));
        let mut band = Bitmap::new(width, to - from);
        band.copy_rows(bitmap, from..to, 0);
        sweep(&mut band, sweeps);
        result.copy_rows(&band, top - from..end - from, top);
    }
    result
}

/// What sweeps make of some pixels, one after another; nothing elsewhere. Sooner than [`swept`] where these are few.
#[must_use]
pub(crate) fn swept_at(pixels: &Bitmap, bitmap: &Bitmap, sweeps: &[Sweep]) -> Bitmap {
    let (width, height) = (bitmap.width(), bitmap.height());
    let reach: usize = sweeps.iter().map(|sweep| sweep.steps()).sum();
    // Words are taken as they are.
    let beside = reach.next_multiple_of(64);
    let mut result = Bitmap::new(width, height);
    for left in (0..width).step_by(TILE_PX) {
        let is_asked = |y: &usize| pixels.has_between(*y as i32, left as i32, (left + TILE_PX) as i32);
        let mut rows = (0..height).filter(is_asked).peekable();
        while let Some(top) = rows.next() {
            // Rows that are asked for and so near one another that what tells of them overlaps; no more than a tile's.
            let mut end = top + 1;
            while let Some(row) = rows.next_if(|&row| row <= end + 2 * reach && row < top + TILE_PX) {
                end = row + 1;
            }
            let (low, high) = ((left.saturating_sub(beside), top.saturating_sub(reach)), (left + TILE_PX + beside, end + reach));
            let (high_x, high_y) = (high.0.min(width), high.1.min(height));
            let corner = USizeVec2::from(low).as_ivec2();
            let mut tile = Bitmap::from_window(bitmap, corner, high_x - low.0, high_y - low.1);
            sweep(&mut tile, sweeps);
            let to = USizeVec2::new(left, top).as_ivec2();
            result.add_from(&tile, to - corner, to, USizeVec2::new(TILE_PX, end - top).as_ivec2());
        }
    }
    result.keep(pixels);
    result
}

/// Sweeps all of a bitmap.
fn sweep(bitmap: &mut Bitmap, sweeps: &[Sweep]) {
    let mut next = Bitmap::new(bitmap.width(), bitmap.height());
    // To shrink what is set is to grow what is not.
    let mut is_inverted = false;
    for &sweep in sweeps {
        if is_inverted != matches!(sweep, Sweep::Shrink(_)) {
            bitmap.invert();
            is_inverted = !is_inverted;
        }
        for (way, by) in passes(sweep.steps()) {
            Arch::new().dispatch(Pass { bitmap, way, by, result: &mut next });
            core::mem::swap(bitmap, &mut next);
        }
    }
    if is_inverted {
        bitmap.invert();
    }
}

/// Where a pass looks for what is set, beside the pixel itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    /// To the left and to the right.
    Across,
    /// Up and down.
    Down,
    /// All four.
    Both,
}

/// The passes that grow by an octagon: a diamond, and a square of which it cuts the corners off. Each looks farther, by
/// what the ones before have closed already, and never so far that what it finds would have had to leave the picture.
fn passes(steps: usize) -> Vec<(Way, usize)> {
    let square = (steps as f64 * (core::f64::consts::SQRT_2 - 1.0)) as usize;
    let mut passes = Vec::new();
    let mut add = |way, goal: usize, most: fn(usize) -> usize| {
        let mut reached = 0;
        while reached < goal {
            let by = most(reached).min(goal - reached).min(63);
            passes.push((way, by));
            reached += by;
        }
    };
    add(Way::Both, steps - square, |reached| reached / 2 + 1);
    add(Way::Across, square, |reached| reached + 1);
    add(Way::Down, square, |reached| reached + 1);
    passes
}

/// Sets the pixels whose middles are within `half` of a stretch.
pub(crate) fn band(bitmap: &mut Bitmap, a: DVec2, b: DVec2, half: f64) {
    let (low, high) = (a.y.min(b.y) - half, a.y.max(b.y) + half);
    let aside = (b - a).normalize_or_zero().perp() * half;
    let corners = [a + aside, b + aside, b - aside, a - aside];
    let pixel = |at: f64, most: usize| (at - 0.5).ceil().clamp(0.0, most as f64) as usize;
    for y in pixel(low, bitmap.height())..pixel(high, bitmap.height()) {
        let at = y as f64 + 0.5;
        // Discs about the ends, and a rectangle between them: all of it hangs together in a row.
        let (mut from, mut to) = (f64::MAX, f64::MIN);
        for end in [a, b] {
            let across = half * half - (end.y - at) * (end.y - at);
            if across > 0.0 {
                (from, to) = (from.min(end.x - across.sqrt()), to.max(end.x + across.sqrt()));
            }
        }
        for (i, p) in corners.iter().enumerate() {
            let q = corners[(i + 1) % 4];
            if (p.y > at) != (q.y > at) {
                let x = p.x + (q.x - p.x) * (at - p.y) / (q.y - p.y);
                (from, to) = (from.min(x), to.max(x));
            }
        }
        bitmap.set_between(y, pixel(from, bitmap.width()), pixel(to, bitmap.width()), true);
    }
}

/// What is set, or has something set so many pixels away.
struct Pass<'a> {
    bitmap: &'a Bitmap,
    way: Way,
    by: usize,
    result: &'a mut Bitmap,
}

impl NullaryFnOnce for Pass<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        match self.way {
            Way::Across => self.pass::<true, false>(),
            Way::Down => self.pass::<false, true>(),
            Way::Both => self.pass::<true, true>(),
        }
    }
}

impl Pass<'_> {
    /// All rows are taken as one: the blank words between them keep them apart, and are cleared again.
    #[inline(always)]
    fn pass<const ACROSS: bool, const DOWN: bool>(self) {
        let Self { bitmap, by, result, .. } = self;
        let (from, to) = (bitmap.words(), result.words_mut());
        let n = from.len();
        if ACROSS {
            let (inner, shift, back) = (n.saturating_sub(2), by as u32, 64 - by as u32);
            let (west, here, east) = (&from[..inner], &from[1..][..inner], &from[2.min(n)..][..inner]);
            let to = &mut to[1..][..inner];
            for i in 0..inner {
                to[i] = here[i] | here[i] << shift | west[i] >> back | here[i] >> shift | east[i] << back;
            }
        } else {
            to.copy_from_slice(from);
        }
        let down = by * bitmap.stride();
        if DOWN && down < n {
            add(&mut to[down..], &from[..n - down]);
            add(&mut to[..n - down], &from[down..]);
        }
        if ACROSS {
            let (used, last) = (bitmap.width().div_ceil(64), bitmap.last_word());
            for row in to[1..].chunks_exact_mut(bitmap.stride()) {
                row[used..].fill(0);
                if let Some(word) = row[..used].last_mut() {
                    *word &= last;
                }
            }
        }
    }
}

#[inline(always)]
fn add(to: &mut [u64], from: &[u64]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to |= from;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn growing_reaches_every_border() {
        for width in [1, 63, 64, 65, 512, 513, 1024] {
            let full = Bitmap::from_fn(width, 3, |_, _| true);
            assert_eq!(grown(&full, 2), full, "width {width}");
            assert_eq!(shrunk(&full, 2), full, "width {width}");
        }
    }

    proptest! {
        #[test]
        fn a_band_is_what_lies_near_a_stretch(a in (-20.0..120.0f64, -20.0..70.0f64), b in (-20.0..120.0f64, -20.0..70.0f64), half in 0.1..30.0f64) {
            let (a, b) = (DVec2::from(a), DVec2::from(b));
            let mut bitmap = Bitmap::new(100, 50);
            band(&mut bitmap, a, b, half);
            for (x, y) in (0..100).flat_map(|x| (0..50).map(move |y| (x, y))) {
                let p = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let t = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-12)).clamp(0.0, 1.0);
                let off = p.distance(a + (b - a) * t) - half;
                prop_assert!(off.abs() < 1e-6 || bitmap.get(x as isize, y as isize) == (off < 0.0), "{} at {}", off, p);
            }
        }

        #[test]
        fn growing_is_what_single_steps_make(width in 1usize..150, height in 1usize..50, steps in 0usize..40, seed: u64) {
            let bitmap = Bitmap::from_fn(width, height, |x, y| {
                let n = (x as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ (y as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F) ^ seed;
                (n ^ n >> 29).wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 55 == 0
            });
            let mut expected = bitmap.clone();
            for i in 0..steps {
                let has_corners = ((i + 1) as f64 * (core::f64::consts::SQRT_2 - 1.0)) as usize > (i as f64 * (core::f64::consts::SQRT_2 - 1.0)) as usize;
                let old = expected.clone();
                expected = Bitmap::from_fn(width, height, |x, y| {
                    let sides = 0b0101_0101 | if has_corners { 0b1010_1010 } else { 0 };
                    old.get(x as isize, y as isize) || old.around(x, y) & sides != 0
                });
            }
            prop_assert_eq!(grown(&bitmap, steps), expected);
        }

        #[test]
        fn sweeps_are_the_same_together_one_by_one_and_where_they_are_asked_for(
            width in 1usize..1000, height in 1usize..900, cell in 1usize..40, sweeps in prop::collection::vec((0usize..12, any::<bool>()), 0..4), seed: u64,
        ) {
            let bitmap = Bitmap::from_fn(width, height, |x, y| {
                let n = ((x / cell) as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ ((y / cell) as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F) ^ seed;
                (n ^ n >> 29).wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 63 == 0
            });
            let sweeps: Vec<Sweep> = sweeps.into_iter().map(|(steps, grows)| if grows { Sweep::Grow(steps) } else { Sweep::Shrink(steps) }).collect();
            let expected = sweeps.iter().fold(bitmap.clone(), |now, sweep| match *sweep {
                Sweep::Grow(steps) => grown(&now, steps),
                Sweep::Shrink(steps) => grown(&now.inverted(), steps).inverted(),
            });
            prop_assert_eq!(&swept(&bitmap, &sweeps), &expected);
            let pixels = Bitmap::from_fn(width, height, |x, y| (x / 50 + y / 50) % 5 == 0 && (x * y) % 3 == 0);
            let mut there = expected;
            there.keep(&pixels);
            prop_assert_eq!(swept_at(&pixels, &bitmap, &sweeps), there);
        }
    }

    #[test]
    fn a_point_grows_to_nearly_a_disc() {
        let mut point = Bitmap::new(141, 141);
        point.set(70, 70, true);
        for radius in [3usize, 10, 30] {
            let disc = grown(&point, radius);
            for (x, y) in disc.pixels() {
                let d = ((x as f64 - 70.0).powi(2) + (y as f64 - 70.0).powi(2)).sqrt();
                assert!(d <= 1.1 * radius as f64 + 1.0, "({x}, {y}) is too far for {radius}");
            }
            assert!(disc.count() as f64 > 0.95 * core::f64::consts::PI * (radius * radius) as f64);
            assert_eq!(shrunk(&disc, radius).count(), 1, "shrinking undoes growing of a point");
        }
    }
}
