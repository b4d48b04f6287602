//! What lies under a label, told by looking along straight lines.
//!
//! Names are printed along streets, and often hide all of a narrow one. A hidden pixel is street if on some straight line
//! through it one comes, both ways, from hidden pixels only to street: along the street at a name's two ends one does,
//! across it one comes to houses.

use pulp::{Arch, NullaryFnOnce};

use super::bitmap::{Bitmap, CHUNK};
use super::lanes::Lanes;
use super::patches::Patches;

/// Directions of looking that are steeper than a diagonal; as many again are not.
const DIRECTIONS: usize = 24;

/// The `hidden` pixels that are street.
#[must_use]
pub(crate) fn seen_as_street(street: &Bitmap, hidden: &Bitmap) -> Bitmap {
    let known = street.without(hidden);
    let patches = Patches::of(hidden, &known);
    let seen = patches.sheet_by_sheet([&patches.shown(&known), &patches.parts()], |[street, hidden]| {
        let mut seen = Looking::at(&street, &hidden);
        seen.add(&Looking::at(&street.transposed(), &hidden.transposed()).transposed());
        seen
    });
    let mut result = Bitmap::new(street.width(), street.height());
    patches.put_back(&seen, &mut result);
    result
}

/// Looking along all directions steeper than a diagonal; chunks row by row.
struct Looking {
    street: Vec<Lanes>,
    hidden: Vec<Lanes>,
    /// Chunks a row.
    chunks: usize,
}

impl Looking {
    /// The hidden pixels that are street, found from what is seen.
    fn at(street: &Bitmap, hidden: &Bitmap) -> Bitmap {
        let lanes = |bitmap: &Bitmap| {
            let rows = (0..bitmap.height()).map(|y| bitmap.row(y));
            rows.flat_map(|row| (0..row.len() / CHUNK).map(|chunk| Lanes::of(row, chunk))).collect()
        };
        let looking = Self { street: lanes(street), hidden: lanes(hidden), chunks: hidden.chunks() };
        let seen = Arch::new().dispatch(&looking);
        let mut result = Bitmap::new(hidden.width(), hidden.height());
        for (y, row) in seen.chunks_exact(hidden.chunks().max(1)).enumerate() {
            row.iter().enumerate().for_each(|(chunk, lanes)| lanes.write(result.row_mut(y), chunk));
        }
        result
    }
}

/// The two lines of sight that meet in a pixel may differ by so many directions: streets bend.
const BEND: usize = 2;

impl NullaryFnOnce for &Looking {
    type Output = Vec<Lanes>;

    #[inline(always)]
    fn call(self) -> Vec<Lanes> {
        let blank = vec![Lanes::NONE; self.hidden.len()];
        // What is reached from above and from below, of the last few directions.
        let mut reached: [[Vec<Lanes>; 2]; BEND + 1] = Default::default();
        reached.as_flattened_mut().fill(blank.clone());
        let mut result = blank;
        let mut aside = vec![0; self.hidden.len().checked_div(self.chunks).unwrap_or(0)];
        for direction in 0..DIRECTIONS {
            // The tangent of evenly spaced angles from -45° to 45°.
            let angle = ((direction as f64 + 0.5) / DIRECTIONS as f64 - 0.5) * core::f64::consts::FRAC_PI_2;
            let slope = libm::tan(angle);
            for (y, aside) in aside.iter_mut().enumerate() {
                *aside = libm::floor(slope * y as f64 + 0.5) as i32;
            }
            reached.rotate_right(1);
            let [down, up] = &mut reached[0];
            self.look(&aside, down, up);
            meet(&mut result, &reached);
        }
        result
    }
}

/// Adds what the latest direction from one side shares with any from the other.
#[inline(always)]
fn meet(result: &mut [Lanes], reached: &[[Vec<Lanes>; 2]; BEND + 1]) {
    let n = result.len();
    let [[down, up], [down1, up1], [down2, up2]] = reached;
    let [down, up, down1, up1, down2, up2] = [&down[..n], &up[..n], &down1[..n], &up1[..n], &down2[..n], &up2[..n]];
    for i in 0..n {
        result[i] |= (down[i] & (up[i] | up1[i] | up2[i])) | (up[i] & (down1[i] | down2[i]));
    }
}

impl Looking {
    /// Goes down from row to row, and so far `aside` in each, and up: which hidden pixels are reached from street over hidden
    /// ones, one way and the other. Both ways are gone together: neither waits for the other's last row.
    #[inline(always)]
    fn look(&self, aside: &[i32], down: &mut [Lanes], up: &mut [Lanes]) {
        let (mut from_above, mut from_below) = (vec![Lanes::NONE; self.chunks], vec![Lanes::NONE; self.chunks]);
        let rows = aside.len();
        let (mut above, mut below) = (0, rows.saturating_sub(1));
        for row in 0..rows {
            let mirrored = rows - 1 - row;
            self.go(row, aside[row] - aside[above], &mut from_above, down);
            self.go(mirrored, aside[mirrored] - aside[below], &mut from_below, up);
            (above, below) = (row, mirrored);
        }
    }

    /// Goes on to a row, by so many pixels to the right, `from` what can be gone on from in the one before.
    #[inline(always)]
    fn go(&self, row: usize, by: i32, from: &mut [Lanes], reached: &mut [Lanes]) {
        let mut before = 0;
        for chunk in 0..from.len() {
            let i = row * self.chunks + chunk;
            let after = from.get(chunk + 1).map_or(0, |after| after.0[0]);
            let here = from[chunk];
            let come = here.moved(by, before, after) & self.hidden[i];
            before = here.0[CHUNK - 1];
            reached[i] = come;
            from[chunk] = come | self.street[i];
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

    #[test]
    fn a_name_wider_than_a_chunk_is_looked_through_as_any_other() {
        // A bar of 700 pixels, slanting over the border between chunks, across a street; and its mirror image.
        for slope in [-0.9, 0.0, 0.9] {
            let middle = |y: usize| 620.0 + slope * (y as f64 - 40.0);
            let street = Bitmap::from_fn(1200, 80, |x, y| (x as f64 - middle(y)).abs() < 6.0);
            let name = Bitmap::from_fn(1200, 80, |x, y| (200..900).contains(&x) && (30..50).contains(&y));
            let found = seen_as_street(&street.without(&name), &name);
            let mut hidden = street.clone();
            hidden.keep(&name);
            assert!(hidden.without(&found).count() * 10 < hidden.count(), "most of it is seen at slope {slope}");
            let farthest = found.pixels().map(|(x, y)| (x as f64 - middle(y)).abs()).fold(0.0, f64::max);
            assert!(farthest < 12.0, "street seen {farthest} pixels from its middle at slope {slope}");
        }
    }
}
