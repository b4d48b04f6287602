//! Connected parts of a bitmap, found by its runs of pixels.

use glam::IVec2;
use pulp::{Arch, NullaryFnOnce};

use super::bitmap::{Bitmap, ones};
use super::outline::Corners;

/// Pixels side by side in a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Run {
    pub y: i32,
    /// Its first pixel, and the one after its last.
    pub from: i32,
    pub to: i32,
    /// Number of the part that it belongs to.
    pub part: u32,
}

/// A connected part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Part {
    /// The corners of its extent: pixels from `low` to before `high`.
    pub low: IVec2,
    pub high: IVec2,
    pub area_px: i64,
}

/// The connected parts of a bitmap.
#[derive(Debug, Clone, Default)]
pub(crate) struct Parts {
    /// Row by row, from the left.
    pub runs: Vec<Run>,
    /// In the order of their first runs.
    pub parts: Vec<Part>,
}

impl Parts {
    /// The parts of what is set.
    pub fn of(bitmap: &Bitmap, corners: Corners) -> Self {
        let mut runs: Vec<Run> = Vec::with_capacity(Arch::new().dispatch(RunsIn(bitmap)));
        // Runs are numbered as they are found: as one above that they touch, or anew. For each number, a lower one of the
        // same part, or itself.
        let mut lower: Vec<u32> = Vec::new();
        let touch = i32::from(corners == Corners::Join);
        let mut above = 0..0;
        for y in 0..bitmap.height() {
            let start = runs.len();
            add_runs(bitmap, y, &mut runs);
            let (before, row) = runs.split_at_mut(start);
            let before = &before[above];
            let mut first = 0;
            for run in row {
                while before.get(first).is_some_and(|other| other.to + touch <= run.from) {
                    first += 1;
                }
                let mut touched = before[first..].iter().take_while(|other| other.from < run.to + touch);
                run.part = touched.next().map_or(lower.len() as u32, |other| other.part);
                for other in touched.filter(|other| other.part != run.part) {
                    join(&mut lower, run.part, other.part);
                }
                if run.part as usize == lower.len() {
                    lower.push(run.part);
                }
            }
            above = start..runs.len();
        }
        // Numbers without gaps. A lower number has its own already.
        let mut parts: Vec<Part> = Vec::new();
        for number in 0..lower.len() {
            lower[number] = if lower[number] as usize == number {
                parts.push(Part { low: IVec2::MAX, high: IVec2::MIN, area_px: 0 });
                parts.len() as u32 - 1
            } else {
                lower[lower[number] as usize]
            };
        }
        for run in &mut runs {
            run.part = lower[run.part as usize];
            let part = &mut parts[run.part as usize];
            part.low = part.low.min(IVec2::new(run.from, run.y));
            part.high = part.high.max(IVec2::new(run.to, run.y + 1));
            part.area_px += i64::from(run.to - run.from);
        }
        Self { runs, parts }
    }

    /// Some of the parts only.
    pub fn only(&self, is_wanted: impl FnMut(&Part) -> bool) -> Self {
        let wanted: Vec<bool> = self.parts.iter().map(is_wanted).collect();
        let mut kept = 0;
        let number = |&is_kept: &bool| {
            kept += u32::from(is_kept);
            is_kept.then(|| kept - 1)
        };
        let numbers: Vec<Option<u32>> = wanted.iter().map(number).collect();
        let parts = self.parts.iter().zip(&wanted).filter(|(_, is_kept)| **is_kept).map(|(part, _)| *part).collect();
        let runs = self.runs.iter().filter_map(|run| Some(Run { part: numbers[run.part as usize]?, ..*run })).collect();
        Self { runs, parts }
    }

    /// For each part, how many pixels of each of some bitmaps lie above, below and beside its runs, so far from them at most.
    pub fn touched<const N: usize>(&self, bitmaps: [&Bitmap; N], reach: usize) -> Vec<[usize; N]> {
        let mut touched = vec![[0; N]; self.parts.len()];
        for run in &self.runs {
            for (bitmap, count) in bitmaps.iter().zip(&mut touched[run.part as usize]) {
                let (width, height) = (bitmap.width(), bitmap.height() as i32);
                let (from, to) = (run.from as usize, run.to as usize);
                *count += bitmap.count_between(run.y as usize, from.saturating_sub(reach), from);
                *count += bitmap.count_between(run.y as usize, to, (to + reach).min(width));
                for y in (run.y - reach as i32).max(0)..(run.y + reach as i32 + 1).min(height) {
                    *count += bitmap.count_between(y as usize, from, to);
                }
            }
        }
        touched
    }

    /// The runs of the parts of less than so many pixels.
    pub fn smaller_than(&self, least_px: i64) -> impl Iterator<Item = &Run> {
        self.runs.iter().filter(move |run| self.parts[run.part as usize].area_px < least_px)
    }
}

/// How many runs a bitmap has.
struct RunsIn<'a>(&'a Bitmap);

impl NullaryFnOnce for RunsIn<'_> {
    type Output = usize;

    #[inline(always)]
    fn call(self) -> usize {
        let words = self.0.words();
        let mut runs = 0;
        // Words before a row, and between rows, are blank.
        for i in 1..words.len() {
            runs += u64::from((words[i] & !(words[i] << 1 | words[i - 1] >> 63)).count_ones());
        }
        runs as usize
    }
}

/// Adds a row's runs.
fn add_runs(bitmap: &Bitmap, y: usize, runs: &mut Vec<Run>) {
    let row = bitmap.padded(y);
    let mut open = 0;
    for k in 0..row.len() - 1 {
        // Where what is set begins or ends; the blank word at the end ends all.
        let changes = row[k + 1] ^ (row[k + 1] << 1 | row[k] >> 63);
        for bit in ones(changes) {
            let x = (k * 64 + bit) as i32;
            if row[k + 1] >> bit & 1 == 1 {
                open = x;
            } else {
                runs.push(Run { y: y as i32, from: open, to: x, part: 0 });
            }
        }
    }
}

/// Makes one of the parts of two numbers.
fn join(lower: &mut [u32], a: u32, b: u32) {
    let (a, b) = (lowest(lower, a), lowest(lower, b));
    lower[a.max(b) as usize] = a.min(b);
}

/// The lowest number of a number's part.
fn lowest(lower: &mut [u32], mut number: u32) -> u32 {
    while lower[number as usize] != number {
        let next = lower[lower[number as usize] as usize];
        lower[number as usize] = next;
        number = next;
    }
    number
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::outline::outlines;
    use proptest::prelude::*;

    #[test]
    fn parts_that_are_not_wanted_go_with_their_runs() {
        // A bar, a speck, a ring about a speck.
        let ring = |x: usize, y: usize| x.abs_diff(30).max(y.abs_diff(10)) == 6;
        let is_set = |x: usize, y: usize| y == 2 && x < 20 || (x, y) == (10, 8) || ring(x, y) || (x, y) == (30, 10);
        let parts = Parts::of(&Bitmap::from_fn(50, 20, is_set), Corners::Join);
        assert_eq!(parts.parts.iter().map(|part| part.area_px).collect::<Vec<_>>(), [20, 48, 1, 1]);
        assert_eq!(parts.smaller_than(20).map(|run| (run.from, run.y)).collect::<Vec<_>>(), [(10, 8), (30, 10)]);
        let parts = parts.only(|part| part.area_px != 20);
        assert_eq!(parts.parts.iter().map(|part| part.area_px).collect::<Vec<_>>(), [48, 1, 1]);
        let mut areas = [0; 3];
        for run in &parts.runs {
            areas[run.part as usize] += run.to - run.from;
        }
        assert_eq!(areas, [48, 1, 1]);
    }

    proptest! {
        #[test]
        fn parts_are_what_outlines_go_around(width in 1usize..600, height in 1usize..40, density in 1u64..16, cell in 1usize..4, seed: u64) {
            let bitmap = Bitmap::from_fn(width, height, |x, y| {
                let n = ((x / cell) as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ ((y / cell) as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F) ^ seed;
                (n ^ n >> 29).wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 60 < density
            });
            for corners in [Corners::Join, Corners::Part] {
                let found = Parts::of(&bitmap, corners);
                let mut extents: Vec<_> = found.parts.iter().map(|part| (part.low.to_array(), part.high.to_array())).collect();
                let around = outlines(&bitmap, corners);
                let mut expected: Vec<_> = around.iter().filter(|o| !o.is_hole()).map(|o| o.extent()).map(|(low, high)| (low.to_array(), high.to_array())).collect();
                extents.sort_unstable();
                expected.sort_unstable();
                prop_assert_eq!(extents, expected);
                let mut painted = Bitmap::new(width, height);
                let mut areas = vec![0; found.parts.len()];
                for run in &found.runs {
                    painted.set_between(run.y as usize, run.from as usize, run.to as usize, true);
                    areas[run.part as usize] += i64::from(run.to - run.from);
                }
                prop_assert_eq!(&painted, &bitmap);
                prop_assert_eq!(areas, found.parts.iter().map(|part| part.area_px).collect::<Vec<_>>());
            }
        }
    }
}
