//! What lies under a label, told by looking along straight lines.
//!
//! Names are printed along streets, and often hide all of a narrow one. A hidden pixel is street if on some straight line
//! through it one comes, both ways, from hidden pixels only to street: along the street at a name's two ends one does,
//! across it one comes to houses.

use pulp::{Arch, NullaryFnOnce};

use super::bitmap::{Bitmap, CHUNK};

/// Directions of looking that are steeper than a diagonal; as many again are not.
const DIRECTIONS: i32 = 32;

/// The `hidden` pixels that are street.
#[must_use]
pub(crate) fn seen_as_street(street: &Bitmap, hidden: &Bitmap) -> Bitmap {
    let mut known = street.clone();
    known.remove(hidden);
    let mut result = Arch::new().dispatch(Looking { street: &known, hidden });
    let (known, hidden) = (known.transposed(), hidden.transposed());
    result.add(&Arch::new().dispatch(Looking { street: &known, hidden: &hidden }).transposed());
    result
}

/// Looking along all directions steeper than a diagonal.
struct Looking<'a> {
    street: &'a Bitmap,
    hidden: &'a Bitmap,
}

/// The two lines of sight that meet in a pixel may differ by so many directions: streets bend.
const BEND: usize = 3;

impl NullaryFnOnce for Looking<'_> {
    type Output = Bitmap;

    #[inline(always)]
    fn call(self) -> Bitmap {
        let (hidden, height) = (self.hidden, self.hidden.height());
        let mut result = Bitmap::new(hidden.width(), height);
        let chunks: Vec<u64> = (0..height).map(|y| used_chunks(hidden.row(y))).collect();
        let (mut from_above, mut from_below) = (Vec::new(), Vec::new());
        for direction in 0..DIRECTIONS {
            // The tangent of evenly spaced angles from -45° to 45°.
            let angle =
                (f64::from(direction) + 0.5 - f64::from(DIRECTIONS) / 2.0) / f64::from(DIRECTIONS) * core::f64::consts::FRAC_PI_2;
            let slope = libm::tan(angle);
            let column = |y: usize| libm::floor(slope * y as f64 + 0.5) as i64;
            let (mut down, mut up) = (Bitmap::new(hidden.width(), height), Bitmap::new(hidden.width(), height));
            for (y, &chunks) in chunks.iter().enumerate().skip(1) {
                self.look(y, y - 1, column(y) - column(y - 1), chunks, &mut down);
            }
            for (y, &chunks) in chunks.iter().enumerate().rev().skip(1) {
                self.look(y, y + 1, column(y) - column(y + 1), chunks, &mut up);
            }
            from_above.push(down);
            from_below.push(up);
            let n = from_above.len() - 1;
            for other in n.saturating_sub(BEND)..=n {
                meet(&mut result, &from_above[n], &from_below[other], &chunks);
                meet(&mut result, &from_above[other], &from_below[n], &chunks);
            }
        }
        result
    }
}

/// Adds what two bitmaps share.
#[inline(always)]
fn meet(result: &mut Bitmap, a: &Bitmap, b: &Bitmap, chunks: &[u64]) {
    for (y, &chunks) in chunks.iter().enumerate() {
        let (to, a, b) = (result.row_mut(y), a.row(y), b.row(y));
        let mut rest = chunks;
        while rest != 0 {
            let chunk = rest.trailing_zeros() as usize * CHUNK;
            rest &= rest - 1;
            for k in chunk..chunk + CHUNK {
                to[k] |= a[k] & b[k];
            }
        }
    }
}

impl Looking<'_> {
    /// Which hidden pixels of row `y` are reached from the row `before`, shifted by so many pixels to the right.
    #[inline(always)]
    fn look(&self, y: usize, before: usize, shift: i64, mut rest: u64, reached: &mut Bitmap) {
        let (street, hidden) = (self.street.padded(before), self.hidden.row(y));
        let (old, to) = reached.padded_and_row(before, y);
        while rest != 0 {
            let chunk = rest.trailing_zeros() as usize * CHUNK;
            rest &= rest - 1;
            for k in chunk..chunk + CHUNK {
                let at = |k: usize| old[k] | street[k];
                let come = match shift {
                    0 => at(k + 1),
                    1 => at(k + 1) << 1 | at(k) >> 63,
                    _ => at(k + 1) >> 1 | at(k + 2) << 63,
                };
                to[k] = come & hidden[k];
            }
        }
    }
}

/// The chunks of a row with anything set, a bit each.
fn used_chunks(row: &[u64]) -> u64 {
    let any = |chunk: &[u64]| u64::from(chunk.iter().any(|&w| w != 0));
    row.chunks_exact(CHUNK).enumerate().fold(0, |all, (i, chunk)| all | any(chunk) << i)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_hides_a_street_is_looked_through_and_one_on_a_block_is_not() {
        for slope in [0.0, 0.3, 0.9, 1.7, -0.6] {
            // A street of 8 pixels, and a word of 18 × 90 on it; another word on the block beside it.
            let along = glam::DVec2::new(1.0, slope).normalize();
            let place = |x: usize, y: usize| {
                let p = glam::DVec2::new(x as f64 - 150.0, y as f64 - 150.0);
                (along.dot(p), along.perp_dot(p))
            };
            let street = Bitmap::from_fn(300, 300, |x, y| place(x, y).1.abs() < 4.0);
            let words = Bitmap::from_fn(300, 300, |x, y| {
                let (t, s) = place(x, y);
                t.abs() < 45.0 && (s.abs() < 9.0 || (s - 40.0).abs() < 9.0)
            });
            let mut visible = street.clone();
            visible.remove(&words);
            let mut found = seen_as_street(&visible, &words);
            found.add(&visible);
            let mut lost = street.clone();
            lost.remove(&found);
            assert!(lost.count() < 60, "{} pixels lost at slope {slope}", lost.count());
            // As far as a street might have bent, and not a pixel of the other word.
            let farthest = found.pixels().map(|(x, y)| place(x, y).1.abs()).fold(0.0, f64::max);
            assert!(farthest < 4.0 + 4.0, "street seen {farthest} pixels from its middle at slope {slope}");
        }
    }
}
