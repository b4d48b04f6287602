//! What lies under a label, told by looking along straight lines.
//!
//! Names are printed along streets, and often hide all of a narrow one. A hidden pixel is street if on some straight line
//! through it one comes, both ways, from hidden pixels only to street: along the street at a name's two ends one does,
//! across it one comes to houses.

use pulp::{Arch, NullaryFnOnce};

use super::bitmap::Bitmap;
use super::lanes::{Lanes, beside};
use super::patches::Patches;

/// Directions of looking that are steeper than a diagonal; as many again are not.
const DIRECTIONS: usize = 24;

/// The `hidden` pixels that are street.
#[must_use]
pub(crate) fn seen_as_street(street: &Bitmap, hidden: &Bitmap) -> Bitmap {
    let mut known = street.clone();
    known.remove(hidden);
    let patches = Patches::of(hidden, &known);
    let seen = patches.sheet_by_sheet([&patches.shown(&known), &patches.parts()], |[street, hidden]| {
        let mut seen = Arch::new().dispatch(Looking { street: &street, hidden: &hidden });
        let (street, hidden) = (street.transposed(), hidden.transposed());
        seen.add(&Arch::new().dispatch(Looking { street: &street, hidden: &hidden }).transposed());
        seen
    });
    let mut result = Bitmap::new(street.width(), street.height());
    patches.put_back(&seen, &mut result);
    result
}

/// Looking along all directions steeper than a diagonal.
struct Looking<'a> {
    street: &'a Bitmap,
    hidden: &'a Bitmap,
}

/// The two lines of sight that meet in a pixel may differ by so many directions: streets bend.
const BEND: usize = 2;

impl NullaryFnOnce for Looking<'_> {
    type Output = Bitmap;

    #[inline(always)]
    fn call(self) -> Bitmap {
        let (width, height) = (self.hidden.width(), self.hidden.height());
        let mut result = Bitmap::new(width, height);
        // What is reached from above and from below, of the last few directions.
        let mut reached = [(); BEND + 1].map(|()| [Bitmap::new(width, height), Bitmap::new(width, height)]);
        let mut aside = vec![0; height];
        for direction in 0..DIRECTIONS {
            // The tangent of evenly spaced angles from -45° to 45°.
            let angle = ((direction as f64 + 0.5) / DIRECTIONS as f64 - 0.5) * core::f64::consts::FRAC_PI_2;
            let slope = libm::tan(angle);
            for (y, aside) in aside.iter_mut().enumerate() {
                *aside = libm::floor(slope * y as f64 + 0.5) as i32;
            }
            reached.rotate_right(1);
            let [down, up] = &mut reached[0];
            self.look(0..height, &aside, down);
            self.look((0..height).rev(), &aside, up);
            meet(&mut result, &reached);
        }
        result
    }
}

/// Adds what the latest direction from one side shares with any from the other.
#[inline(always)]
fn meet(result: &mut Bitmap, reached: &[[Bitmap; 2]; BEND + 1]) {
    let to = result.words_mut();
    let n = to.len();
    let [[down, up], [down1, up1], [down2, up2]] = reached;
    let [down, up, down1, up1, down2, up2] = [down, up, down1, up1, down2, up2].map(|bitmap| &bitmap.words()[..n]);
    for i in 0..n {
        to[i] |= (down[i] & (up[i] | up1[i] | up2[i])) | (up[i] & (down1[i] | down2[i]));
    }
}

impl Looking<'_> {
    /// Goes from row to row, and so far `aside` in each: which hidden pixels are reached from street over hidden ones.
    #[inline(always)]
    fn look(&self, rows: impl Iterator<Item = usize>, aside: &[i32], reached: &mut Bitmap) {
        // What can be gone on from, in the row before and in this one.
        let mut before = vec![0; self.hidden.stride() + 1];
        let mut here = before.clone();
        let mut was_aside = None;
        for y in rows {
            let shift = aside[y] - was_aside.unwrap_or(aside[y]);
            was_aside = Some(aside[y]);
            let (hidden, street, reached) = (self.hidden.row(y), self.street.row(y), reached.row_mut(y));
            for chunk in 0..self.hidden.chunks() {
                let from = beside(&before, chunk);
                let come = match shift {
                    0 => Lanes::here(from),
                    1 => Lanes::west(from, 1),
                    _ => Lanes::east(from, 1),
                };
                let come = come & Lanes::of(hidden, chunk);
                come.write(reached, chunk);
                (come | Lanes::of(street, chunk)).write(&mut here[1..], chunk);
            }
            core::mem::swap(&mut before, &mut here);
        }
    }
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
