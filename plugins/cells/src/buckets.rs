//! Boxes by place: a lattice of buckets, each with the boxes that touch it.

use core::ops::RangeInclusive;

use veduta_city::GridPos;
use veduta_city::bounds::{do_meet, joined};

use crate::overlay::Bounds;

/// Side of a bucket, as a power of two of grid steps, if boxes lie close together: 32 m.
const SIDE: u32 = 15;
/// Buckets there may be beyond eight a box, and as many entries in them.
const MOST: i64 = 1 << 16;

/// Finds boxes by place.
pub(crate) struct Buckets {
    boxes: Vec<Option<Bounds>>,
    /// Least corner of the buckets.
    origin: GridPos,
    /// Side of a bucket, as a power of two of grid steps.
    side: u32,
    columns: i64,
    rows: i64,
    /// Boxes in the buckets, row by row, ascending in each.
    entries: Vec<u32>,
    /// The first entry of each bucket, and the end.
    first: Vec<u32>,
}

impl Buckets {
    /// Those of some boxes, which are told by their numbers; `None` is nowhere.
    pub(crate) fn new(boxes: Vec<Option<Bounds>>) -> Self {
        let (origin, end) = boxes.iter().copied().flatten().reduce(joined).unwrap_or_default();
        let (width, height) = (i64::from(end.0) - i64::from(origin.0), i64::from(end.1) - i64::from(origin.1));
        let most = 8 * boxes.len() as i64 + MOST;
        let mut buckets = Self { boxes, origin, side: SIDE, columns: 0, rows: 0, entries: Vec::new(), first: Vec::new() };
        // Larger ones where boxes lie far apart, or are so large that they touch many.
        loop {
            (buckets.columns, buckets.rows) = ((width >> buckets.side) + 1, (height >> buckets.side) + 1);
            let touched = |about: &Bounds| {
                let (x, y) = buckets.touched(*about);
                (x.end() - x.start() + 1) * (y.end() - y.start() + 1)
            };
            let entries: i64 = buckets.boxes.iter().flatten().map(touched).sum();
            if (buckets.columns * buckets.rows).max(entries) <= most {
                break;
            }
            buckets.side += 1;
        }
        buckets.fill();
        buckets
    }

    /// Counts the entries of each bucket, then sets each into its place.
    fn fill(&mut self) {
        let mut next = vec![0; (self.columns * self.rows) as usize + 1];
        let each = |told: &mut dyn FnMut(usize, u32)| {
            for (n, about) in (0..).zip(&self.boxes) {
                let Some(about) = *about else { continue };
                let (x, y) = self.touched(about);
                for row in y {
                    x.clone().for_each(|column| told((row * self.columns + column) as usize, n));
                }
            }
        };
        each(&mut |bucket, _| next[bucket + 1] += 1);
        for bucket in 1..next.len() {
            next[bucket] += next[bucket - 1];
        }
        let first = next.clone();
        let mut entries = vec![0; next[next.len() - 1] as usize];
        each(&mut |bucket, n| {
            entries[next[bucket] as usize] = n;
            next[bucket] += 1;
        });
        (self.first, self.entries) = (first, entries);
    }

    /// Columns and rows that a box touches, of those that there are.
    fn touched(&self, (lo, hi): Bounds) -> (RangeInclusive<i64>, RangeInclusive<i64>) {
        let at = |v: i32, from: i32| (i64::from(v) - i64::from(from)) >> self.side;
        let within = |lo: i32, hi: i32, from: i32, count: i64| at(lo, from).max(0)..=at(hi, from).min(count - 1);
        (within(lo.0, hi.0, self.origin.0, self.columns), within(lo.1, hi.1, self.origin.1, self.rows))
    }

    /// Numbers of the boxes that meet another one, each once.
    pub(crate) fn meeting(&self, about: Bounds) -> impl Iterator<Item = u32> {
        let (x, y) = self.touched(about);
        let (west, south) = (*x.start(), *y.start());
        y.flat_map(move |row| x.clone().map(move |column| (column, row))).flat_map(move |(column, row)| {
            let bucket = (row * self.columns + column) as usize;
            let entries = &self.entries[self.first[bucket] as usize..self.first[bucket + 1] as usize];
            entries.iter().copied().filter(move |&n| {
                self.boxes[n as usize].is_some_and(|other| {
                    // Of the buckets that both touch, the first counts.
                    let is_first = || {
                        let (x, y) = self.touched(other);
                        (*x.start()).max(west) == column && (*y.start()).max(south) == row
                    };
                    do_meet(other, about) && is_first()
                })
            })
        })
    }

    /// Numbers of the boxes that hold a position, ascending.
    pub(crate) fn holding(&self, pos: GridPos) -> impl Iterator<Item = u32> {
        self.meeting((pos, pos))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use veduta_city::bounds::about;

    use super::*;

    fn place(most: i32) -> impl Strategy<Value = GridPos> {
        (-most..most, -most..most).prop_map(|(x, y)| GridPos(x, y))
    }

    fn boxes(most: i32) -> impl Strategy<Value = Vec<Option<Bounds>>> {
        let one = (place(most), place(most)).prop_map(|(p, q)| about(p, q));
        proptest::collection::vec(proptest::option::weighted(0.9, one), 0..20)
    }

    proptest! {
        #[test]
        fn boxes_are_found_that_meet_and_no_other(
            (boxes, (far, near, size)) in (11..30_u32).prop_flat_map(|n| (boxes(1 << n), (place(i32::MAX), place(1 << n), 0..1 << n))),
        ) {
            let buckets = Buckets::new(boxes.clone());
            for other in [about(far, near), about(near, GridPos(near.0 + size, near.1)), (near, near)] {
                let mut found: Vec<u32> = buckets.meeting(other).collect();
                found.sort_unstable();
                let all = (0..).zip(&boxes).filter(|(_, it)| it.is_some_and(|it| do_meet(it, other))).map(|(n, _)| n);
                prop_assert_eq!(found, all.collect::<Vec<u32>>());
            }
        }
    }

    #[test]
    fn a_city_a_thousand_kilometres_wide_and_boxes_over_all_of_it_take_few_buckets() {
        let at = |x: i32| GridPos(x * 1024, x * 1024);
        let buckets = Buckets::new((0..1_000).map(|n| Some((at(n * 900), at(n * 900 + 10)))).collect());
        assert!(buckets.first.len() < 100_000);
        let buckets = Buckets::new(vec![Some((at(0), at(100_000))); 1_000]);
        assert!(buckets.entries.len() < 100_000);
        assert_eq!(buckets.holding(at(50_000)).count(), 1_000);
    }
}
