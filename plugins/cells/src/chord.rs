//! Where a line that a person drew leads through a cell.

use glam::DVec2;
use veduta_city::GridPos;

use crate::hull::distance_2;
use crate::overlay::Edge;

/// A line that meets the border no farther from a corner goes to that corner, metres.
pub(crate) const CORNER_M: f64 = 0.5;
/// So far before a wall a line may end that is meant to reach it, and so far beyond it one may end that is not, metres.
const SHORT_M: f64 = 1.0;
/// A line that is in a cell for no longer than this has only touched it, metres.
const TOUCH_M: f64 = 0.25;

/// An edge of a cell's border, with the cell on its left.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Side {
    pub(crate) ends: Edge,
    pub(crate) is_wall: bool,
}

/// Where a line meets a cell's border.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Landing {
    pub(crate) at: GridPos,
    /// The edge, least end first, that it parts; `None` at a corner.
    pub(crate) parts: Option<Edge>,
}

/// What of a line lies in a cell.
#[derive(Debug, Default)]
pub(crate) struct Way {
    /// From border to border.
    pub(crate) chords: Vec<[Landing; 2]>,
    /// An end of the line in the midst of the cell.
    pub(crate) ends_at: Option<DVec2>,
}

/// Where a line leads through the cell that some sides enclose.
pub(crate) fn way_through(from: DVec2, to: DVec2, sides: &[Side]) -> Way {
    let length_m = libm::sqrt(from.distance_squared(to));
    let along = (to - from) / length_m;
    let mut met: Vec<(f64, Landing)> = sides.iter().filter_map(|side| meeting(from, along, side)).collect();
    met.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.at.cmp(&b.1.at)));
    let mut way = Way::default();
    for pair in met.chunks_exact(2) {
        let ((enter_m, enter), (leave_m, leave)) = (pair[0], pair[1]);
        let within_m = leave_m.min(length_m) - enter_m.max(0.0);
        let is_whole = enter_m >= -SHORT_M && leave_m <= length_m + SHORT_M;
        if is_whole && within_m > TOUCH_M && enter.at != leave.at {
            way.chords.push([enter, leave]);
        } else if !is_whole && within_m > SHORT_M {
            way.ends_at = Some(if enter_m < -SHORT_M { from } else { to });
        }
    }
    way
}

/// How far along a line it meets a side, and where there; alike from both sides of it.
fn meeting(from: DVec2, along: DVec2, side: &Side) -> Option<(f64, Landing)> {
    let (low, high) = (side.ends.0.min(side.ends.1), side.ends.0.max(side.ends.1));
    let (p, q) = (low.to_metres() - from, high.to_metres() - from);
    let (p_off, q_off) = (along.perp_dot(p), along.perp_dot(q));
    if (p_off > 0.0) == (q_off > 0.0) {
        return None;
    }
    let meets = p + (q - p) * (p_off / (p_off - q_off));
    let corner = if meets.distance_squared(p) <= meets.distance_squared(q) { (p, low) } else { (q, high) };
    let at = if meets.distance_squared(corner.0) <= CORNER_M * CORNER_M { corner.1 } else { new_corner(from + meets, side) };
    let is_corner = at == low || at == high;
    Some((along.dot(meets), Landing { at, parts: (!is_corner).then_some((low, high)) }))
}

/// A position for a corner on a side: as near to it as the steps of plans allow, in a wall rather than before it.
fn new_corner(meets: DVec2, side: &Side) -> GridPos {
    let (a, b) = side.ends;
    let step = GridPos::common_step([&a, &b]);
    let meets = GridPos::from_metres(meets);
    if !side.is_wall {
        return meets.rounded(step);
    }
    let floor = |n: i32| n.div_euclid(step) * step;
    let (x, y) = (floor(meets.0), floor(meets.1));
    let around = [GridPos(x, y), GridPos(x + step, y), GridPos(x, y + step), GridPos(x + step, y + step)];
    let within = around.into_iter().filter(|&p| a.cross(b, p) <= 0);
    within.max_by_key(|&p| (a.cross(b, p), core::cmp::Reverse(distance_2(p, meets)), p)).unwrap_or(a)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64) -> GridPos {
        GridPos::from_metres(DVec2::new(x, y))
    }

    /// A cell of 10 m × 4 m whose shorter sides are portals.
    fn sides() -> Vec<Side> {
        let corners = [at(0.0, 0.0), at(10.0, 0.0), at(10.0, 4.0), at(0.0, 4.0)];
        (0..4).map(|i| Side { ends: (corners[i], corners[(i + 1) % 4]), is_wall: i % 2 == 0 }).collect()
    }

    fn chords(from: (f64, f64), to: (f64, f64)) -> Vec<[GridPos; 2]> {
        let way = way_through(DVec2::from(from), DVec2::from(to), &sides());
        way.chords.iter().map(|chord| chord.map(|end| end.at)).collect()
    }

    #[test]
    fn a_line_goes_from_wall_to_wall_and_to_a_corner_that_is_near() {
        assert_eq!(chords((3.0, -1.0), (3.0, 5.0)), [[at(3.0, 0.0), at(3.0, 4.0)]]);
        assert_eq!(chords((3.0, 0.6), (3.0, 3.5)), [[at(3.0, 0.0), at(3.0, 4.0)]], "it may end a little before the walls");
        assert_eq!(chords((0.2, -0.1), (9.8, 4.1)), [[at(0.0, 0.0), at(10.0, 4.0)]]);
        assert_eq!(chords((3.0, 5.0), (9.0, 5.0)), [] as [[GridPos; 2]; 0]);
    }

    #[test]
    fn a_line_that_ends_in_the_cell_is_told() {
        let way = way_through(DVec2::new(3.0, -1.0), DVec2::new(3.0, 2.0), &sides());
        assert!(way.chords.is_empty() && way.ends_at == Some(DVec2::new(3.0, 2.0)), "{way:?}");
        let way = way_through(DVec2::new(-5.0, 2.0), DVec2::new(0.7, 2.0), &sides());
        assert!(way.chords.is_empty() && way.ends_at.is_none(), "it was meant to end at the portal: {way:?}");
    }

    #[test]
    fn both_cells_beside_a_portal_are_cut_at_one_place() {
        let ends = (at(1.3, 7.1), at(9.2, 11.9));
        let one = Side { ends, is_wall: false };
        let other = Side { ends: (ends.1, ends.0), ..one };
        let (from, along) = (DVec2::new(4.0, 0.0), DVec2::new(0.1, 1.0).normalize());
        let (a, b) = (meeting(from, along, &one), meeting(from, along, &other));
        assert!(a.is_some() && a == b, "{a:?} {b:?}");
    }
}
