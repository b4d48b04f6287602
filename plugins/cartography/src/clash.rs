use std::collections::HashMap;

use glam::DVec2;

use crate::Area;

/// A turned rectangle on a drawing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slab {
    /// Its middle.
    pub middle: DVec2,
    /// Half its length along and across its direction.
    pub half: DVec2,
    /// Direction of its length; a unit.
    pub along: DVec2,
}

impl Slab {
    /// An upright one.
    #[must_use]
    pub fn upright(area: Area) -> Self {
        Self { middle: area.middle(), half: area.size() / 2.0, along: DVec2::X }
    }

    /// Its corners, in order.
    #[must_use]
    pub fn corners(&self) -> [DVec2; 4] {
        let (x, y) = (self.along * self.half.x, self.along.perp() * self.half.y);
        [self.middle - x - y, self.middle + x - y, self.middle + x + y, self.middle - x + y]
    }

    /// Whether two have a point in common (by the separating axis theorem).
    #[must_use]
    pub fn meets(&self, other: &Self) -> bool {
        let apart = other.middle - self.middle;
        let axes = [self.along, self.along.perp(), other.along, other.along.perp()];
        let reach =
            |slab: &Self, axis: DVec2| slab.half.x * slab.along.dot(axis).abs() + slab.half.y * slab.along.perp().dot(axis).abs();
        axes.into_iter().all(|axis| apart.dot(axis).abs() < reach(self, axis) + reach(other, axis))
    }

    fn bounds(&self) -> Area {
        let reach = (self.along * self.half.x).abs() + (self.along.perp() * self.half.y).abs();
        Area { min: self.middle - reach, max: self.middle + reach }
    }

    /// Whether it lies within a rectangle.
    #[must_use]
    pub fn is_within(&self, area: &Area) -> bool {
        let bounds = self.bounds();
        area.contains(bounds.min) && area.contains(bounds.max)
    }
}

/// What is taken of a drawing: found by squares of a grid.
#[derive(Debug, Clone)]
pub struct Taken {
    square: f64,
    slabs: Vec<Slab>,
    by_square: HashMap<(i32, i32), Vec<u32>>,
}

impl Taken {
    /// Nothing taken; what is taken will mostly be so large, in units.
    #[must_use]
    pub fn new(size: f64) -> Self {
        Self { square: size.max(1e-6), slabs: Vec::new(), by_square: HashMap::new() }
    }

    fn squares(&self, slab: &Slab) -> impl Iterator<Item = (i32, i32)> + use<> {
        let bounds = slab.bounds();
        let cell = |v: f64| libm::floor(v / self.square).clamp(-1e6, 1e6) as i32;
        let (x, y) = (cell(bounds.min.x)..=cell(bounds.max.x), cell(bounds.min.y)..=cell(bounds.max.y));
        x.flat_map(move |x| y.clone().map(move |y| (x, y)))
    }

    /// Whether all of these are free.
    #[must_use]
    pub fn leaves_free(&self, slabs: &[Slab]) -> bool {
        slabs.iter().all(|slab| {
            let mut near = self.squares(slab).filter_map(|square| self.by_square.get(&square)).flatten();
            !near.any(|&n| self.slabs[n as usize].meets(slab))
        })
    }

    /// Takes them.
    pub fn take(&mut self, slabs: &[Slab]) {
        for slab in slabs {
            let n = self.slabs.len() as u32;
            self.slabs.push(*slab);
            for square in self.squares(slab) {
                self.by_square.entry(square).or_default().push(n);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn slab(x: f64, y: f64, turn: f64) -> Slab {
        Slab { middle: DVec2::new(x, y), half: DVec2::new(4.0, 1.0), along: DVec2::from_angle(turn) }
    }

    #[test]
    fn slabs_that_cross_meet_and_those_beside_each_other_do_not() {
        assert!(slab(0.0, 0.0, 0.0).meets(&slab(0.0, 0.0, 1.57)));
        assert!(!slab(0.0, 0.0, 0.5).meets(&slab(0.0, 2.4, 0.5)), "in parallel");
        // Their boxes overlap, they do not.
        assert!(!slab(0.0, 0.0, 0.785).meets(&slab(3.0, -3.0, 0.785)));
    }

    proptest! {
        #[test]
        fn what_is_found_by_squares_is_what_is_found_by_looking_at_all(
            slabs in proptest::collection::vec((0.0..60.0, 0.0..60.0, 0.0..6.0f64), 1..40), at in (0.0..60.0, 0.0..60.0, 0.0..6.0f64),
        ) {
            let slabs: Vec<Slab> = slabs.into_iter().map(|(x, y, turn)| slab(x, y, turn)).collect();
            let asked = slab(at.0, at.1, at.2);
            let mut taken = Taken::new(7.0);
            taken.take(&slabs);
            prop_assert_eq!(taken.leaves_free(&[asked]), !slabs.iter().any(|s| s.meets(&asked)));
        }
    }
}
