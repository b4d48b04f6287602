//! Boxes along the axes, as their least and greatest corners.

use glam::DVec2;

use crate::GridPos;

/// Least and greatest corner of a box.
pub type Bounds = (GridPos, GridPos);

/// The box about two corners.
#[must_use]
pub fn about(p: GridPos, q: GridPos) -> Bounds {
    (GridPos(p.0.min(q.0), p.1.min(q.1)), GridPos(p.0.max(q.0), p.1.max(q.1)))
}

/// The box about two boxes.
#[must_use]
pub fn joined(a: Bounds, b: Bounds) -> Bounds {
    (about(a.0, b.0).0, about(a.1, b.1).1)
}

/// The box about some positions; `None` if there are none.
#[must_use]
pub fn around<'a>(positions: impl IntoIterator<Item = &'a GridPos>) -> Option<Bounds> {
    positions.into_iter().map(|&pos| (pos, pos)).reduce(joined)
}

/// A box and so much ground about it, grid steps; saturates.
#[must_use]
pub fn grown((lo, hi): Bounds, by: i32) -> Bounds {
    (GridPos(lo.0.saturating_sub(by), lo.1.saturating_sub(by)), GridPos(hi.0.saturating_add(by), hi.1.saturating_add(by)))
}

/// Whether two boxes have a place in common, be it on the border.
#[must_use]
pub fn do_meet((lo, hi): Bounds, (low, high): Bounds) -> bool {
    lo.0 <= high.0 && low.0 <= hi.0 && lo.1 <= high.1 && low.1 <= hi.1
}

/// Whether a position lies in a box, be it on the border.
#[must_use]
pub fn holds(bounds: Bounds, pos: GridPos) -> bool {
    do_meet(bounds, (pos, pos))
}

/// Distance of a plan position from a box, metres; 0 inside.
#[must_use]
pub fn distance_m((lo, hi): Bounds, plan_pos: DVec2) -> f64 {
    plan_pos.distance(plan_pos.max(lo.to_metres()).min(hi.to_metres()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_holds_its_border_and_is_as_far_as_its_nearest_place() {
        let bounds = about(GridPos(2048, 0), GridPos(0, 1024));
        assert_eq!(bounds, (GridPos(0, 0), GridPos(2048, 1024)));
        assert!(holds(bounds, GridPos(2048, 512)) && !holds(bounds, GridPos(2049, 512)));
        assert_eq!(distance_m(bounds, DVec2::new(1.0, 0.5)), 0.0);
        assert_eq!(distance_m(bounds, DVec2::new(5.0, 5.0)), 5.0, "3 m east, 4 m north");
        assert_eq!(grown(bounds, i32::MAX).1, GridPos(i32::MAX, i32::MAX));
        assert_eq!(around(&[GridPos(3, 1), GridPos(1, 4), GridPos(2, 2)]), Some((GridPos(1, 1), GridPos(3, 4))));
        assert_eq!(around(&[]), None);
    }
}
