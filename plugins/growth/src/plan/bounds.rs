//! Boxes along the axes, as their least and greatest corners.

use veduta_city::GridPos;

/// Least and greatest corner.
pub(super) type Bounds = (GridPos, GridPos);

/// The box about two corners.
pub(super) fn about(p: GridPos, q: GridPos) -> Bounds {
    (GridPos(p.0.min(q.0), p.1.min(q.1)), GridPos(p.0.max(q.0), p.1.max(q.1)))
}

/// The box about two boxes.
pub(super) fn joined(a: Bounds, b: Bounds) -> Bounds {
    (about(a.0, b.0).0, about(a.1, b.1).1)
}

/// A box and so much ground about it, grid steps.
pub(super) fn grown((low, high): Bounds, by: i32) -> Bounds {
    (GridPos(low.0.saturating_sub(by), low.1.saturating_sub(by)), GridPos(high.0.saturating_add(by), high.1.saturating_add(by)))
}

/// Whether two boxes have a point in common.
pub(super) fn do_meet((a, b): Bounds, (c, d): Bounds) -> bool {
    a.0 <= d.0 && c.0 <= b.0 && a.1 <= d.1 && c.1 <= b.1
}
