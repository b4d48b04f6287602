//! Outlines of what is set in a bitmap, along the cracks between pixels.

use glam::{DVec2, IVec2};
use pulp::{Arch, NullaryFnOnce};

use super::SIDE_PX;
use super::bitmap::{Bitmap, ones};
use super::clean::MARGIN;

/// How pixels that touch by a corner only are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Corners {
    /// They belong together.
    Join,
    /// They do not.
    Part,
}

/// A closed line along pixel edges, in pixels from the picture's upper left corner, y down.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Outline {
    /// Its corners. What is set lies to the left as one goes, seen with y down.
    pub corners: Vec<IVec2>,
    /// Pixels inside; negative for the outline of a hole.
    pub area_px: i64,
}

impl Outline {
    /// Whether it goes around what is not set.
    pub fn is_hole(&self) -> bool {
        self.area_px < 0
    }

    /// Its lowest and highest corner coordinates.
    pub fn extent(&self) -> (IVec2, IVec2) {
        self.corners.iter().fold((IVec2::MAX, IVec2::MIN), |(low, high), &c| (low.min(c), high.max(c)))
    }

    /// Made larger, and moved.
    pub fn scaled(&self, scale: i32, by: i32) -> Self {
        let corners = self.corners.iter().map(|&c| c * scale + by).collect();
        Self { corners, area_px: self.area_px * i64::from(scale) * i64::from(scale) }
    }

    /// Moved.
    pub fn moved(&self, by: IVec2) -> Self {
        Self { corners: self.corners.iter().map(|&c| c + by).collect(), area_px: self.area_px }
    }

    /// The stretches of pixels inside, in some rows: each a row, its first pixel and the one after its last.
    pub fn spans(&self, mut is_wanted: impl FnMut(i32) -> bool) -> Vec<(i32, i32, i32)> {
        // Each vertical edge toggles the pixels to its right.
        let mut edges: Vec<(i32, i32)> = Vec::new();
        for (i, &a) in self.corners.iter().enumerate() {
            let b = self.corners[(i + 1) % self.corners.len()];
            if a.x == b.x {
                edges.extend((a.y.min(b.y)..a.y.max(b.y)).filter(|&y| is_wanted(y)).map(|y| (y, a.x)));
            }
        }
        edges.sort_unstable();
        edges.chunks_exact(2).map(|pair| (pair[0].0, pair[0].1, pair[1].1)).collect()
    }

    /// Whether it goes around a point.
    pub fn encloses(&self, at: DVec2) -> bool {
        let mut inside = false;
        for (i, a) in self.corners.iter().enumerate() {
            let b = self.corners[(i + 1) % self.corners.len()];
            if a.x == b.x && f64::from(a.x) > at.x && (f64::from(a.y) > at.y) != (f64::from(b.y) > at.y) {
                inside = !inside;
            }
        }
        inside
    }

    /// The middle of a pixel that is set and touches it.
    fn pixel_beside(&self) -> Option<DVec2> {
        let edge = self.corners.iter().zip(self.corners.iter().cycle().skip(1)).find(|(a, b)| a.x == b.x)?;
        // What is set lies to the left: to the east of an edge that runs down.
        let aside = if edge.1.y > edge.0.y { 0.5 } else { -0.5 };
        Some(DVec2::new(f64::from(edge.0.x) + aside, f64::from(edge.0.y.min(edge.1.y)) + 0.5))
    }

    /// Sets or clears all pixels inside of it and of the picture.
    pub fn paint(&self, bitmap: &mut Bitmap, on: bool) {
        let (width, height) = (bitmap.width() as i32, bitmap.height() as i32);
        for (y, from, to) in self.spans(|y| y >= 0 && y < height) {
            let (from, to) = (from.clamp(0, width), to.clamp(0, width));
            bitmap.set_between(y as usize, from as usize, to as usize, on);
        }
    }
}

/// The outlines of a bitmap, in the order of their uppermost, leftmost edges.
#[must_use]
pub(crate) fn outlines(bitmap: &Bitmap, corners: Corners) -> Vec<Outline> {
    let mut done = Bitmap::new(bitmap.width(), bitmap.height());
    let mut result = Vec::new();
    for y in 0..bitmap.height() {
        let row = bitmap.padded(y);
        for k in 0..row.len() - 2 {
            // Pixels whose left neighbour is not set.
            let left_edges = row[k + 1] & !(row[k + 1] << 1 | row[k] >> 63);
            for bit in ones(left_edges) {
                let x = k * 64 + bit;
                if !done.get(x as isize, y as isize) {
                    result.push(follow(bitmap, &mut done, IVec2::new(x as i32, y as i32), corners));
                }
            }
        }
    }
    result
}

/// For each outline of a hole, the number of the outline of that which has this hole, if it is among the given ones.
pub(crate) fn holders(outers: &[Outline], holes: &[Outline]) -> Vec<Option<usize>> {
    if holes.is_empty() {
        return Vec::new();
    }
    let extents: Vec<(DVec2, DVec2)> = outers.iter().map(|o| o.extent()).map(|(l, h)| (l.as_dvec2(), h.as_dvec2())).collect();
    let holder = |hole: &Outline| {
        let at = hole.pixel_beside()?;
        let about = extents.iter().enumerate().filter(|(_, (low, high))| at.cmpgt(*low).all() && at.cmplt(*high).all());
        // Of those around one another the innermost.
        about.map(|(i, _)| i).filter(|&i| outers[i].encloses(at)).min_by_key(|&i| outers[i].area_px)
    };
    holes.iter().map(holder).collect()
}

/// Steps along pixel edges: down, right, up, left, so that the next is a turn to the left.
const AHEAD: [IVec2; 4] = [IVec2::Y, IVec2::X, IVec2::NEG_Y, IVec2::NEG_X];
/// For each way, the pixels ahead of its end on the left and on the right, from the corner there.
const SIDES: [[IVec2; 2]; 4] = [
    [IVec2::new(0, 0), IVec2::new(-1, 0)],
    [IVec2::new(0, -1), IVec2::new(0, 0)],
    [IVec2::new(-1, -1), IVec2::new(0, -1)],
    [IVec2::new(-1, 0), IVec2::new(-1, -1)],
];

/// Follows an outline from the top of a pixel's left edge, downwards.
fn follow(bitmap: &Bitmap, done: &mut Bitmap, start: IVec2, connect: Corners) -> Outline {
    let (mut at, mut way) = (start, 0);
    let (mut corners, mut area) = (Vec::new(), 0i64);
    loop {
        // One edge.
        if way == 0 {
            done.set(at.x as usize, at.y as usize, true);
        }
        area -= i64::from(AHEAD[way].y) * i64::from(at.x);
        at += AHEAD[way];
        let [left, right] = SIDES[way];
        let left_ahead = bitmap.get_near(at.x + left.x, at.y + left.y);
        let right_ahead = bitmap.get_near(at.x + right.x, at.y + right.y);
        // To the right, straight on, or to the left.
        let turn = match connect {
            Corners::Join if right_ahead => 3,
            Corners::Part if left_ahead && right_ahead => 3,
            _ if left_ahead => 0,
            _ => 1,
        };
        if turn != 0 {
            corners.push(at);
            way = (way + turn) % 4;
        }
        if at == start && way == 0 {
            return Outline { corners, area_px: area };
        }
    }
}

impl Outline {
    /// A ring that stays within `tolerance` of the outline, with as few of its corners as one pass can find. Fewer than three
    /// remain of one thinner than that.
    #[must_use]
    pub fn simplified(&self, tolerance: f64) -> Vec<DVec2> {
        // Begin at two far corners, so that the beginning does not matter much.
        let Some(&first) = self.corners.first() else { return Vec::new() };
        let far = |from: IVec2| {
            let farther = |best: (usize, i32), (i, p): (usize, &IVec2)| {
                let d = p.distance_squared(from);
                if d > best.1 { (i, d) } else { best }
            };
            self.corners.iter().enumerate().fold((0, -1), farther).0
        };
        let a = far(first);
        let b = far(self.corners[a]);
        if a == b {
            return vec![first.as_dvec2()];
        }
        let mut ring = self.corners.clone();
        ring.rotate_left(a.min(b));
        ring.push(ring[0]);
        let (one, other) = (&ring[..=a.abs_diff(b)], &ring[a.abs_diff(b)..]);
        let mut result = Vec::new();
        for side in [one, other] {
            let keep = Arch::new().dispatch(KeptCorners { corners: side, tolerance });
            let last = side.len() - 1;
            result.extend(side[..last].iter().zip(keep).filter(|(_, keep)| *keep).map(|(p, _)| p.as_dvec2()));
        }
        result
    }
}

/// A line with the same ends that stays within `tolerance` of the given one (Ramer, Douglas and Peucker).
#[must_use]
pub(crate) fn simplified(line: &[DVec2], tolerance: f64) -> Vec<DVec2> {
    let keep = Arch::new().dispatch(KeptPoints { line, tolerance });
    line.iter().zip(keep).filter(|(_, keep)| *keep).map(|(p, _)| *p).collect()
}

/// Which of `n` points in a line are kept. `farthest` tells of those between two the one that is farthest off the straight
/// line from the one to the other, and the square of how far.
#[inline(always)]
fn kept(n: usize, tolerance: f64, farthest: impl Fn(usize, usize) -> (f64, usize)) -> Vec<bool> {
    let mut keep = vec![false; n];
    if n < 3 {
        keep.fill(true);
        return keep;
    }
    (keep[0], keep[n - 1]) = (true, true);
    let mut stack = vec![(0, n - 1)];
    while let Some((from, to)) = stack.pop() {
        let (off2, worst) = farthest(from, to);
        if off2 > tolerance * tolerance {
            keep[worst] = true;
            stack.extend([(from, worst), (worst, to)]);
        }
    }
    keep
}

/// Which points of a line are kept.
struct KeptPoints<'a> {
    line: &'a [DVec2],
    tolerance: f64,
}

impl NullaryFnOnce for KeptPoints<'_> {
    type Output = Vec<bool>;

    #[inline(always)]
    fn call(self) -> Vec<bool> {
        let line = self.line;
        kept(line.len(), self.tolerance, |from, to| {
            let (start, along) = (line[from], line[to] - line[from]);
            let (between, length2) = (&line[from + 1..to], along.length_squared());
            if length2 == 0.0 {
                let (off2, i) = farthest(between, |p| p.distance_squared(start));
                return (off2, from + 1 + i);
            }
            let (off, i) = farthest(between, |p| along.perp_dot(p - start).abs());
            (off * off / length2, from + 1 + i)
        })
    }
}

/// Which corners of a part of an outline are kept, in whole numbers: twice the area of the largest picture is one.
struct KeptCorners<'a> {
    corners: &'a [IVec2],
    tolerance: f64,
}

impl NullaryFnOnce for KeptCorners<'_> {
    type Output = Vec<bool>;

    #[inline(always)]
    fn call(self) -> Vec<bool> {
        const { assert!(2 * (SIDE_PX + 2 * MARGIN).pow(2) <= i32::MAX as usize) };
        let corners = self.corners;
        kept(corners.len(), self.tolerance, |from, to| {
            let (start, along) = (corners[from], corners[to] - corners[from]);
            // The two are never one corner: the first two are not, and what is off their line is neither.
            let (off, i) = farthest(&corners[from + 1..to], |p| (along.x * (p.y - start.y) - along.y * (p.x - start.x)).abs());
            (f64::from(off) * f64::from(off) / along.as_dvec2().length_squared(), from + 1 + i)
        })
    }
}

/// Of some points the first that is farthest off, and how far; 0 and the first if none is off at all.
#[inline(always)]
fn farthest<P: Copy, N: Copy + Default + PartialOrd>(points: &[P], off: impl Fn(P) -> N) -> (N, usize) {
    const TOGETHER: usize = 16;
    let mut worst = (N::default(), 0);
    let (together, rest) = points.as_chunks::<TOGETHER>();
    for (i, points) in together.iter().enumerate() {
        let mut offs = [N::default(); TOGETHER];
        for k in 0..TOGETHER {
            offs[k] = off(points[k]);
        }
        let mut most = worst.0;
        for &off in &offs {
            most = if off > most { off } else { most };
        }
        if most > worst.0 {
            for (k, &off) in offs.iter().enumerate() {
                if off > worst.0 {
                    worst = (off, i * TOGETHER + k);
                }
            }
        }
    }
    for (k, &p) in rest.iter().enumerate() {
        let off = off(p);
        if off > worst.0 {
            worst = (off, together.len() * TOGETHER + k);
        }
    }
    worst
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_ring_has_an_outline_and_a_hole() {
        let ring = Bitmap::from_fn(10, 10, |x, y| {
            (2..8).contains(&x) && (2..8).contains(&y) && !((4..6).contains(&x) && (4..6).contains(&y))
        });
        let found = outlines(&ring, Corners::Part);
        assert_eq!(found.iter().map(|o| o.area_px).collect::<Vec<_>>(), [36, -4]);
        assert_eq!(found[0].corners.len(), 4, "corners only");
    }

    #[test]
    fn pixels_that_touch_by_a_corner_join_or_part() {
        let two = Bitmap::from_fn(4, 4, |x, y| (x, y) == (1, 1) || (x, y) == (2, 2));
        assert_eq!(outlines(&two, Corners::Join).len(), 1);
        assert_eq!(outlines(&two, Corners::Part).len(), 2);
    }

    #[test]
    fn a_hole_belongs_to_what_lies_around_it() {
        // A ring in a ring, and a lone box beside them.
        let is_ring = |x: usize, y: usize, low: usize, high: usize| {
            let inside = |low: usize, high: usize| (low..high).contains(&x) && (low..high).contains(&y);
            inside(low, high) && !inside(low + 2, high - 2)
        };
        let rings =
            Bitmap::from_fn(40, 30, |x, y| is_ring(x, y, 2, 26) || is_ring(x, y, 8, 20) || (30..36).contains(&x) && y > 3 && y < 9);
        let (holes, outers): (Vec<_>, Vec<_>) = outlines(&rings, Corners::Part).into_iter().partition(Outline::is_hole);
        let held: Vec<_> = holders(&outers, &holes).into_iter().map(|i| i.map(|i| outers[i].area_px)).collect();
        assert_eq!((holes.iter().map(|h| h.area_px).collect::<Vec<_>>(), held), (vec![-400, -64], vec![Some(576), Some(144)]));
        assert_eq!(holders(&outers[1..], &holes[..1]), [None], "its own outline is not there");
    }

    /// Single pixels, of which so many sixteenths are set.
    fn blots(width: usize, height: usize, seed: u64, density: u64) -> Bitmap {
        Bitmap::from_fn(width, height, |x, y| {
            let n = (x as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ (y as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F) ^ seed;
            (n ^ n >> 29).wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 60 < density
        })
    }

    proptest! {
        #[test]
        fn outlines_enclose_what_is_set(width in 1usize..90, height in 1usize..30, density in 1u64..16, seed: u64) {
            let bitmap = blots(width, height, seed, density);
            for corners in [Corners::Join, Corners::Part] {
                let found = outlines(&bitmap, corners);
                prop_assert_eq!(found.iter().map(|o| o.area_px).sum::<i64>(), bitmap.count() as i64);
                let mut painted = Bitmap::new(width, height);
                // From the outside in: outlines come before the holes in them.
                let mut sorted: Vec<_> = found.iter().collect();
                sorted.sort_by_key(|o| core::cmp::Reverse(o.area_px.abs()));
                for outline in sorted {
                    outline.paint(&mut painted, !outline.is_hole());
                }
                prop_assert_eq!(&painted, &bitmap);
            }
        }

        #[test]
        fn a_simplified_line_stays_near(points in prop::collection::vec((-50.0..50.0f64, -50.0..50.0f64), 2..40), is_closed: bool, tolerance in 0.1..5.0f64) {
            let mut line: Vec<DVec2> = points.iter().map(|&(x, y)| DVec2::new(x, y)).collect();
            if is_closed {
                line.push(line[0]);
            }
            let simple = simplified(&line, tolerance);
            prop_assert_eq!(simple.first(), line.first());
            prop_assert_eq!(simple.last(), line.last());
            prop_assert!(simple.len() <= line.len());
            // What lies between two points that are kept is near the straight line through them.
            let mut rest = &line[..];
            for w in simple.windows(2) {
                let to = 1 + rest[1..].iter().position(|p| *p == w[1]).ok_or_else(|| TestCaseError::fail("a point that is none"))?;
                let normal = (w[1] - w[0]).normalize_or_zero().perp();
                prop_assert!(rest[..to].iter().all(|p| normal.dot(*p - w[0]).abs() <= tolerance + 1e-9));
                rest = &rest[to..];
            }
        }

        #[test]
        fn an_outline_is_simplified_as_a_line_is(width in 1usize..90, height in 1usize..60, seed: u64, tolerance in 0.1..3.0f64) {
            let bitmap = blots(width, height, seed, 11);
            for outline in outlines(&bitmap, Corners::Part) {
                let mut ring: Vec<DVec2> = outline.corners.iter().map(|c| c.as_dvec2()).collect();
                let far = |from: DVec2| {
                    let most = ring.iter().map(|p| p.distance_squared(from)).fold(0.0, f64::max);
                    ring.iter().position(|p| p.distance_squared(from) == most)
                };
                let missing = || TestCaseError::fail("a ring without corners");
                let a = far(ring[0]).ok_or_else(missing)?;
                let b = far(ring[a]).ok_or_else(missing)?;
                ring.rotate_left(a.min(b));
                ring.push(ring[0]);
                let mut expected = simplified(&ring[..=a.abs_diff(b)], tolerance);
                expected.pop();
                expected.extend(simplified(&ring[a.abs_diff(b)..], tolerance));
                expected.pop();
                prop_assert_eq!(outline.simplified(tolerance), expected);
            }
        }
    }
}
