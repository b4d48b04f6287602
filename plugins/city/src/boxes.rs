use core::iter::FromIterator;

use crate::bounds::{Bounds, do_meet, joined};

/// As many boxes that follow each other are found together.
const BLOCK: usize = 32;

/// A list of boxes in plan. Those that follow each other should lie near each other: then the ones at a place are found without looking at
/// all, for a box about every 32 of them tells which may be there (a hierarchy of bounding volumes of two levels). An R-tree was rejected:
/// it orders its boxes anew, while these are named by their places in the list, and are in the order of Morton codes already.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Boxes {
    boxes: Vec<Bounds>,
    /// Each around so many of them.
    blocks: Vec<Bounds>,
}

impl Boxes {
    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.boxes.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.boxes.is_empty()
    }

    /// The box with a number.
    #[must_use]
    pub fn get(&self, number: u32) -> Option<Bounds> {
        self.boxes.get(number as usize).copied()
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = Bounds> {
        self.boxes.iter().copied()
    }

    /// Numbers of those that have a place in common with another box, be it on the border; ascending.
    pub fn meeting(&self, other: Bounds) -> impl Iterator<Item = u32> {
        let blocks = self.blocks.iter().zip(self.boxes.chunks(BLOCK)).zip((0..).step_by(BLOCK));
        let blocks = blocks.filter(move |((block, _), _)| do_meet(**block, other));
        let boxes = blocks.flat_map(|((_, boxes), first)| (first..).zip(boxes));
        boxes.filter(move |(_, bounds)| do_meet(**bounds, other)).map(|(number, _)| number)
    }
}

impl FromIterator<Bounds> for Boxes {
    fn from_iter<I: IntoIterator<Item = Bounds>>(boxes: I) -> Self {
        let boxes: Vec<Bounds> = boxes.into_iter().collect();
        let blocks = boxes.chunks(BLOCK).filter_map(|boxes| boxes.iter().copied().reduce(joined)).collect();
        Self { boxes, blocks }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::GridPos;

    proptest! {
        #[test]
        fn those_at_a_place_are_found_as_if_all_were_looked_at(
            boxes in prop::collection::vec((-90..90i32, -90..90i32, 0..40i32, 0..40i32), 0..200),
            (x, y, reach) in (-100..100i32, -100..100i32, 0..50i32),
        ) {
            let boxes = || boxes.iter().map(|&(x, y, w, h)| (GridPos(x, y), GridPos(x + w, y + h)));
            let other = (GridPos(x, y), GridPos(x + reach, y + reach));
            let is_apart = |(lo, hi): Bounds| hi.0 < x || hi.1 < y || x + reach < lo.0 || y + reach < lo.1;
            let all: Vec<u32> = (0..).zip(boxes()).filter(|(_, bounds)| !is_apart(*bounds)).map(|(number, _)| number).collect();
            let list: Boxes = boxes().collect();
            prop_assert_eq!(list.meeting(other).collect::<Vec<_>>(), all);
            prop_assert_eq!(list.meeting((GridPos(i32::MIN, i32::MIN), GridPos(i32::MAX, i32::MAX))).count(), list.len());
        }
    }
}
