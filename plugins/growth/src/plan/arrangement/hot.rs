//! Snap rounding after Hobby (*Practical segment intersection with finite precision output*, 1999): a grid point is hot if a
//! segment ends there or two of them cross in its pixel, and every segment goes by the hot points whose pixels it passes. Then
//! no two of them cross, and all of it is integers. A pixel has its western and southern side, and of its corners the
//! south-western one.

use veduta_city::GridPos;

use super::{Segment, Tile};

/// Coordinates relative to a position. Extents span less than 2²⁷ steps, so that products of two differences fit well.
fn to(from: GridPos, p: GridPos) -> (i64, i64) {
    (i64::from(p.0) - i64::from(from.0), i64::from(p.1) - i64::from(from.1))
}

const fn cross(a: (i64, i64), b: (i64, i64)) -> i64 {
    a.0 * b.1 - a.1 * b.0
}

/// `num / den` to the nearest whole number, halves up.
fn nearest(num: i128, den: i128) -> i32 {
    (2 * num + den).div_euclid(2 * den) as i32
}

/// Hot points of a tile: ends of segments, crossings of segments with each other and with the tile's western and southern
/// sides, its corners. Sorted, none twice.
pub(super) fn hot_points(tile: &Tile, segments: &[Segment], bin: &[u32]) -> Vec<GridPos> {
    let mut order: Vec<&Segment> = bin.iter().filter_map(|&s| segments.get(s as usize)).collect();
    order.sort_unstable_by_key(|s| s.a.0.min(s.b.0));
    let mut hot = tile.corners().to_vec();
    for (i, s) in order.iter().enumerate() {
        hot.extend([s.a, s.b]);
        hot.extend(crossing_x(s, tile.lo.0));
        hot.extend(crossing_y(s, tile.lo.1));
        let east = s.a.0.max(s.b.0);
        let near = order[i + 1..].iter().take_while(|other| other.a.0.min(other.b.0) <= east);
        hot.extend(near.filter_map(|other| crossing(s, other)));
    }
    hot.retain(|&p| tile.holds(p));
    hot.sort_unstable();
    hot.dedup();
    hot
}

/// Where two segments cross within both, on the grid. Ends that lie on the other segment are hot by themselves.
fn crossing(s: &Segment, t: &Segment) -> Option<GridPos> {
    let (low, high) = (s.a.1.min(s.b.1), s.a.1.max(s.b.1));
    if t.a.1.max(t.b.1) < low || t.a.1.min(t.b.1) > high {
        return None;
    }
    let (along, other) = (to(s.a, s.b), to(t.a, t.b));
    let (at_a, at_b) = (cross(along, to(s.a, t.a)), cross(along, to(s.a, t.b)));
    if at_a.signum() * at_b.signum() >= 0 {
        return None;
    }
    let (num, beyond) = (cross(to(s.a, t.a), other), cross(to(s.b, t.a), other));
    if num.signum() * beyond.signum() >= 0 {
        return None;
    }
    let (num, den) = (num * cross(along, other).signum(), cross(along, other).abs());
    let axis =
        |from: i32, along: i64| nearest(i128::from(from) * i128::from(den) + i128::from(along) * i128::from(num), i128::from(den));
    Some(GridPos(axis(s.a.0, along.0), axis(s.a.1, along.1)))
}

/// Where a segment crosses an upright line.
fn crossing_x(s: &Segment, x: i32) -> Option<GridPos> {
    (s.a.0.min(s.b.0) < x && x < s.a.0.max(s.b.0)).then(|| at_x(s.a, s.b, x))
}

/// Where a line that is not upright is at an abscissa.
pub(super) fn at_x(a: GridPos, b: GridPos, x: i32) -> GridPos {
    let [ax, ay, bx, by] = [a.0, a.1, b.0, b.1].map(i128::from);
    let (run, rise) = if ax < bx { (bx - ax, by - ay) } else { (ax - bx, ay - by) };
    GridPos(x, nearest(ay * run + rise * (i128::from(x) - ax), run))
}

/// Where a segment crosses a level line.
fn crossing_y(s: &Segment, y: i32) -> Option<GridPos> {
    let turned = |p: GridPos| GridPos(p.1, p.0);
    let s = Segment { a: turned(s.a), b: turned(s.b), layer: s.layer };
    crossing_x(&s, y).map(turned)
}

/// The hot points of a tile by which a segment goes, from its start to its end; indices. None lies within a piece of the way: a
/// point between two whose pixels the segment passes has its own pixel between them.
pub(super) fn way(s: &Segment, hot: &[GridPos], way: &mut Vec<u32>) {
    way.clear();
    let (west, east) = (s.a.0.min(s.b.0), s.a.0.max(s.b.0));
    let (south, north) = (s.a.1.min(s.b.1), s.a.1.max(s.b.1));
    let (dx, dy) = to(s.a, s.b);
    let reach = dx.abs() + dy.abs();
    let first = hot.partition_point(|p| p.0 < west);
    for (i, &p) in hot.iter().enumerate().skip(first) {
        if p.0 > east {
            break;
        }
        // A segment between grid points that passes the pixel of a third has that within its bounds.
        if p.1 < south || p.1 > north {
            continue;
        }
        let aside = 2 * cross((dx, dy), to(s.a, p));
        if aside.abs() < reach || (aside == dx - dy && aside.abs() == reach) {
            way.push(i as u32);
        }
    }
    let along = |i: u32| hot.get(i as usize).map_or(0, |&p| dx * to(s.a, p).0 + dy * to(s.a, p).1);
    way.sort_unstable_by_key(|&i| along(i));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn segment(a: (i32, i32), b: (i32, i32)) -> Segment {
        Segment { a: GridPos(a.0, a.1), b: GridPos(b.0, b.1), layer: 0 }
    }

    #[test]
    fn segments_cross_only_within_both() {
        let s = segment((0, 0), (10, 4));
        assert_eq!(crossing(&s, &segment((5, -3), (5, 9))), Some(GridPos(5, 2)));
        assert_eq!(crossing(&s, &segment((5, 9), (5, -3))), Some(GridPos(5, 2)));
        assert_eq!(crossing(&s, &segment((2, -3), (2, 9))), Some(GridPos(2, 1)), "0.8 is nearest to 1");
        assert_eq!(crossing(&s, &segment((5, 2), (5, 9))), None, "an end is hot by itself");
        assert_eq!(crossing(&s, &segment((20, 8), (30, 12))), None, "collinear");
        assert_eq!(crossing(&s, &segment((11, -3), (11, 9))), None);
        assert_eq!(crossing(&s, &segment((0, 5), (10, 5))), None);
    }

    fn passes(s: &Segment, p: GridPos) -> bool {
        let mut found = Vec::new();
        way(s, &[p], &mut found);
        !found.is_empty()
    }

    #[test]
    fn a_pixel_has_two_sides_and_one_corner() {
        let p = GridPos(5, 5);
        assert!(passes(&segment((0, 5), (9, 5)), p));
        assert!(passes(&segment((4, 5), (5, 4)), GridPos(5, 5)), "through the south-western corner");
        assert!(!passes(&segment((5, 6), (6, 5)), GridPos(5, 5)), "through the north-eastern corner");
        assert!(!passes(&segment((4, 5), (5, 6)), GridPos(4, 6)), "through the south-eastern corner");
        assert!(!passes(&segment((0, 5), (4, 5)), p), "it ends before");
        assert!(!passes(&segment((0, 6), (9, 6)), p));
    }

    #[test]
    fn a_way_goes_by_what_lies_on_it() {
        let hot = [GridPos(0, 0), GridPos(3, 1), GridPos(4, 4), GridPos(6, 2), GridPos(9, 3)];
        let mut found = Vec::new();
        way(&segment((9, 3), (0, 0)), &hot, &mut found);
        assert_eq!(found, [4, 3, 1, 0]);
    }
}
