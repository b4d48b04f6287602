//! The few places of a picture where something is to be done, side by side in a small picture.
//!
//! Labels cover little of a map, and lie far apart. What is done to them pixel by pixel, over and over, is done in a
//! picture that holds nothing else.

use glam::IVec2;

use super::bitmap::{Bitmap, CHUNK_PX};
use super::outline::Corners;
use super::parts::{Part, Parts};

/// Pixels of the picture that a patch shows beside the pixels it is about, on every side.
const BESIDE: i32 = 1;
/// Pixels a row of the small picture, if no patch is wider, and rows that are worked at together: little enough for all
/// that is done there to stay near the processor.
const SHEET_PX: i32 = CHUNK_PX as i32;

/// The connected parts of a bitmap (by corners too), and where in a small picture each has its place.
pub(crate) struct Patches {
    parts: Parts,
    /// For each part, its place.
    places: Vec<Place>,
    /// Size of the small picture.
    size: IVec2,
    /// The rows of it that begin a sheet.
    sheets: Vec<i32>,
}

/// Upper left corners in the picture and in the small one, and size of what is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Place {
    from: IVec2,
    to: IVec2,
    size: IVec2,
}

impl Patches {
    /// Patches of what is set, but for parts beside which nothing of `known` is.
    pub fn of(bitmap: &Bitmap, known: &Bitmap) -> Self {
        Self::among(&Parts::of(bitmap, Corners::Join), known)
    }

    /// As [`of`](Self::of), with the connected parts (by corners too) of what is set in a bitmap of the size of `known`.
    pub fn among(parts: &Parts, known: &Bitmap) -> Self {
        let parts = parts.only(|part| {
            let (low, high) = (part.low - BESIDE, part.high + BESIDE);
            (low.y..high.y).any(|y| known.has_between(y, low.x, high.x))
        });
        let place = |part: &Part| Place { from: part.low - BESIDE, to: IVec2::ZERO, size: part.high - part.low + 2 * BESIDE };
        let mut places: Vec<Place> = parts.parts.iter().map(place).collect();
        let whole = IVec2::new(known.width() as i32, known.height() as i32);
        let area = |size: IVec2| i64::from(size.x) * i64::from(size.y);
        if places.iter().map(|place| area(place.size)).sum::<i64>() > area(whole) {
            // Parts that wind about one another would be shown many times: they are left where they are.
            places.fill(Place { from: IVec2::ZERO, to: IVec2::ZERO, size: whole });
            return Self { parts, places, size: whole, sheets: vec![0] };
        }
        // Rows of patches of about the same height, the highest first.
        let mut order: Vec<usize> = (0..places.len()).collect();
        order.sort_by_key(|&i| core::cmp::Reverse(places[i].size.y));
        let width = places.iter().map(|p| p.size.x).fold(SHEET_PX, i32::max);
        let (mut at, mut height, mut sheets) = (IVec2::ZERO, 0, vec![0]);
        for i in order {
            let place = &mut places[i];
            if at.x + place.size.x > width {
                at = IVec2::new(0, at.y + height);
                height = 0;
                let sheet = sheets[sheets.len() - 1];
                if at.y + place.size.y > sheet + SHEET_PX {
                    sheets.push(at.y);
                }
            }
            place.to = at;
            at.x += place.size.x;
            height = height.max(place.size.y);
        }
        Self { parts, places, size: IVec2::new(width, at.y + height), sheets }
    }

    /// Makes a small picture of others, a sheet at a time: patches are never cut by a sheet's border.
    pub fn sheet_by_sheet<const N: usize>(&self, of: [&Bitmap; N], mut make: impl FnMut([Bitmap; N]) -> Bitmap) -> Bitmap {
        let mut made = self.blank();
        for (i, &from) in self.sheets.iter().enumerate() {
            let to = self.sheets.get(i + 1).copied().unwrap_or(self.size.y);
            let (from, to) = (from as usize, to as usize);
            let sheets = of.map(|bitmap| {
                let mut sheet = Bitmap::new(bitmap.width(), to - from);
                sheet.copy_rows(bitmap, from..to, 0);
                sheet
            });
            made.copy_rows(&make(sheets), 0..to - from, from);
        }
        made
    }

    /// The parts themselves, in the small picture.
    pub fn parts(&self) -> Bitmap {
        let mut parts = self.blank();
        for run in &self.parts.runs {
            let place = self.places[run.part as usize];
            let by = place.to - place.from;
            parts.set_between((run.y + by.y) as usize, (run.from + by.x) as usize, (run.to + by.x) as usize, true);
        }
        parts
    }

    /// What another bitmap of the same size shows there and beside, in the small picture.
    pub fn shown(&self, of: &Bitmap) -> Bitmap {
        let mut shown = self.blank();
        for place in self.shown_places() {
            shown.add_from(of, place.from, place.to, place.size);
        }
        shown
    }

    /// Adds to the picture what the small one, where it shows nothing but parts, has.
    pub fn put_back(&self, small: &Bitmap, to: &mut Bitmap) {
        for place in self.shown_places() {
            to.add_from(small, place.to, place.from, place.size);
        }
    }

    /// The places, each once.
    fn shown_places(&self) -> &[Place] {
        let is_whole = self.places.first().is_some_and(|first| self.places.last() == Some(first));
        if is_whole { &self.places[..1] } else { &self.places }
    }

    fn blank(&self) -> Bitmap {
        Bitmap::new(self.size.x as usize, self.size.y as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::filter::dilated;
    use proptest::prelude::*;

    fn full(of: &Bitmap) -> Bitmap {
        Bitmap::from_fn(of.width(), of.height(), |_, _| true)
    }

    #[test]
    fn parts_with_nothing_beside_them_are_left_out() {
        let mask = Bitmap::from_fn(300, 60, |x, y| (10..20).contains(&y) && (x % 100) < 20);
        let other = Bitmap::from_fn(300, 60, |x, y| (x, y) == (120, 20));
        let mut back = Bitmap::new(300, 60);
        let patches = Patches::of(&mask, &other);
        patches.put_back(&patches.parts(), &mut back);
        assert_eq!(back, Bitmap::from_fn(300, 60, |x, y| (10..20).contains(&y) && (100..120).contains(&x)));
    }

    proptest! {
        #[test]
        fn what_is_put_back_is_what_was_taken(width in 1usize..700, height in 1usize..80, cell in 2usize..9, seed: u64, density in 1u64..9) {
            let noise = |cell: usize, density: u64| Bitmap::from_fn(width, height, |x, y| {
                let n = ((x / cell) as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ ((y / cell) as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F) ^ seed;
                (n ^ n >> 29).wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 60 < density
            });
            let (mask, other) = (noise(cell, density), noise(1, 8));
            let patches = Patches::of(&mask, &full(&mask));
            let parts = patches.parts();
            let mut back = Bitmap::new(width, height);
            patches.put_back(&parts, &mut back);
            prop_assert_eq!(&back, &mask);
            // What lies beside each pixel of a part is shown beside it.
            let mut shown = patches.shown(&other);
            for run in &patches.parts.runs {
                let place = patches.places[run.part as usize];
                for (x, y) in (run.from..run.to).flat_map(|x| (0..9).map(move |i| (x + i % 3 - 1, run.y + i / 3 - 1))) {
                    let there = IVec2::new(x, y) + place.to - place.from;
                    let is_shown = shown.get(there.x as isize, there.y as isize);
                    prop_assert_eq!(is_shown, other.get(x as isize, y as isize), "({}, {})", x, y);
                }
            }
            shown.keep(&parts);
            let mut back = Bitmap::new(width, height);
            patches.put_back(&shown, &mut back);
            let mut expected = other.clone();
            expected.keep(&mask);
            prop_assert_eq!(&back, &expected);
        }
    }

    #[test]
    fn sheets_make_what_the_whole_makes() {
        // Bars of many heights, one of them higher than a sheet, each with its own surroundings.
        let (width, height) = (900, 1400);
        let bars = Bitmap::from_fn(width, height, |x, y| x % 9 < 2 && y % 437 < 100 + x / 3 || (5..7).contains(&x) && y > 20);
        let other = Bitmap::from_fn(width, height, |x, y| (x * 31 + y * 17 + x * y) % 11 < 2);
        let patches = Patches::of(&bars, &full(&bars));
        assert!(patches.sheets.len() > 1, "{:?} {}", patches.sheets, patches.size);
        let mut made = patches.sheet_by_sheet([&patches.shown(&other)], |[sheet]| dilated(&sheet));
        made.keep(&patches.parts());
        let mut back = Bitmap::new(width, height);
        patches.put_back(&made, &mut back);
        let mut expected = dilated(&other);
        expected.keep(&bars);
        assert_eq!(back, expected);
    }

    #[test]
    fn parts_that_wind_about_one_another_take_no_more_room_than_the_picture() {
        let rings = Bitmap::from_fn(200, 200, |x, y| (x.min(199 - x).min(y).min(199 - y)) % 3 == 0);
        let patches = Patches::of(&rings, &full(&rings));
        assert_eq!(patches.size, IVec2::new(200, 200));
        assert_eq!(patches.parts(), rings);
    }
}
