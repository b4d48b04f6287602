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
        let mut reached = vec![[Bitmap::new(width, height), Bitmap::new(width, height)]; BEND + 1];
        for direction in 0..DIRECTIONS {
            // The tangent of evenly spaced angles from -45° to 45°.
            let angle = ((direction as f64 + 0.5) / DIRECTIONS as f64 - 0.5) * core::f64::consts::FRAC_PI_2;
            let slope = libm::tan(angle);
            let column = |y: usize| libm::floor(slope * y as f64 + 0.5) as i64;
            reached.rotate_right(1);
            let [down, up] = &mut reached[0];
            for y in 1..height {
                self.look(y, y - 1, column(y) - column(y - 1), down);
            }
            for y in (0..height.saturating_sub(1)).rev() {
                self.look(y, y + 1, column(y) - column(y + 1), up);
            }
            meet(&mut result, &reached);
        }
        result
    }
}

/// Adds what the latest direction from one side shares with any from the other.
#[inline(always)]
fn meet(result: &mut Bitmap, reached: &[[Bitmap; 2]]) {
    let [[down, up], earlier @ ..] = reached else { return };
    for y in 0..result.height() {
        let chunks = result.chunks();
        let (to, down, up) = (result.row_mut(y), down.row(y), up.row(y));
        for chunk in 0..chunks {
            let (down, up) = (Lanes::of(down, chunk), Lanes::of(up, chunk));
            let mut both = Lanes::of(to, chunk) | (down & up);
            for [other_down, other_up] in earlier {
                both |= (down & Lanes::of(other_up.row(y), chunk)) | (up & Lanes::of(other_down.row(y), chunk));
            }
            both.write(to, chunk);
        }
    }
}

impl Looking<'_> {
    /// Which hidden pixels of row `y` are reached from the row `before`, shifted by so many pixels to the right.
    #[inline(always)]
    fn look(&self, y: usize, before: usize, shift: i64, reached: &mut Bitmap) {
        for chunk in 0..self.hidden.chunks() {
            let (old, street) = (beside(reached.padded(before), chunk), beside(self.street.padded(before), chunk));
            let come = match shift {
                0 => Lanes::here(old) | Lanes::here(street),
                1 => Lanes::west(old, 1) | Lanes::west(street, 1),
                _ => Lanes::east(old, 1) | Lanes::east(street, 1),
            };
            (come & Lanes::of(self.hidden.row(y), chunk)).write(reached.row_mut(y), chunk);
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
