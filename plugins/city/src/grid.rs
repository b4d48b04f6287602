use core::ops::{Add, Sub};

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::bounds::{self, Bounds};

/// Steps of the plan's grid in a metre.
pub const GRID_PER_METRE: i32 = 1024;

/// Grid steps that positions in the outlines of a plan are multiples of: 1/64 m. What is told of them is told in these.
pub const PLAN_STEP: i32 = GRID_PER_METRE / 64;

/// Metres of a length on the grid.
#[must_use]
pub fn metres(steps: i32) -> f64 {
    f64::from(steps) / f64::from(GRID_PER_METRE)
}

/// A plan position on the grid of 1/1024 m: x east, y north.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize)]
pub struct GridPos(
    /// Steps east.
    pub i32,
    /// Steps north.
    pub i32,
);

impl GridPos {
    /// The position that an offset leads to; goes on at the grid's other end instead of failing.
    #[must_use]
    pub const fn wrapping_add(self, off: Self) -> Self {
        Self(self.0.wrapping_add(off.0), self.1.wrapping_add(off.1))
    }

    /// The offset that leads here from another position; as [`GridPos::wrapping_add`].
    #[must_use]
    pub const fn wrapping_sub(self, from: Self) -> Self {
        Self(self.0.wrapping_sub(from.0), self.1.wrapping_sub(from.1))
    }

    /// The nearest grid position to a plan position in metres; saturates at the grid's end.
    #[must_use]
    pub fn from_metres(plan_pos: DVec2) -> Self {
        Self(Self::steps(plan_pos.x), Self::steps(plan_pos.y))
    }

    /// The nearest position that outlines of plans may have to a plan position in metres, in multiples of [`PLAN_STEP`]; saturates.
    #[must_use]
    pub fn on_plan(plan_pos: DVec2) -> Self {
        Self::from_metres(plan_pos).rounded(PLAN_STEP)
    }

    /// Whether outlines of plans may have it.
    #[must_use]
    pub const fn is_on_plan(self) -> bool {
        self.0 % PLAN_STEP == 0 && self.1 % PLAN_STEP == 0
    }

    /// Grid steps in which what is made of some positions is to be rounded, so that what is on the plan stays on it: [`PLAN_STEP`] if all
    /// are, else 1.
    #[must_use]
    pub fn common_step<'a>(positions: impl IntoIterator<Item = &'a Self>) -> i32 {
        if positions.into_iter().all(|pos| pos.is_on_plan()) { PLAN_STEP } else { 1 }
    }

    /// A length in metres as steps of the grid, rounded; saturates.
    #[must_use]
    pub fn steps(length_m: f64) -> i32 {
        let steps = length_m * f64::from(GRID_PER_METRE);
        // Halves away from zero; what is left of a number after its whole part is exact.
        let whole = steps as i64;
        let rest = steps - whole as f64;
        let away = i64::from(rest >= 0.5) - i64::from(rest <= -0.5);
        whole.saturating_add(away).clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32
    }

    /// The nearest position of a coarser grid, whose steps are so many of this one's; saturates.
    #[must_use]
    pub fn rounded(self, step: i32) -> Self {
        let round = |n: i32| n.saturating_add(step / 2).div_euclid(step.max(1)).saturating_mul(step.max(1));
        Self(round(self.0), round(self.1))
    }

    /// Plan position in metres.
    #[must_use]
    pub fn to_metres(self) -> DVec2 {
        DVec2::new(metres(self.0), metres(self.1))
    }

    /// Twice the signed area of the triangle (self, b, c) in grid steps squared: positive if it turns left. Exact where no two of
    /// the three are farther apart than half the grid; saturates beyond.
    #[must_use]
    pub fn cross(self, b: Self, c: Self) -> i64 {
        let (ux, uy) = (i64::from(b.0) - i64::from(self.0), i64::from(b.1) - i64::from(self.1));
        let (vx, vy) = (i64::from(c.0) - i64::from(self.0), i64::from(c.1) - i64::from(self.1));
        ux.saturating_mul(vy).saturating_sub(uy.saturating_mul(vx))
    }

    /// The position between two, each coordinate rounded towards zero.
    #[must_use]
    pub fn midpoint(self, other: Self) -> Self {
        Self(self.0.midpoint(other.0), self.1.midpoint(other.1))
    }

    /// Its Morton code: the bits of both coordinates interleaved, north above east, beginning with the sign. In the order of their
    /// codes, positions that share a square of a quadtree over the whole grid follow one another.
    #[must_use]
    pub fn morton(self) -> u64 {
        let spread = |coordinate: i32| {
            let mut bits = u64::from(coordinate.cast_unsigned() ^ 1 << 31);
            for (shift, mask) in MORTON_STEPS {
                bits = (bits | bits << shift) & mask;
            }
            bits
        };
        spread(self.0) | spread(self.1) << 1
    }

    /// Bits of a Morton code that tell where in a [square](GridPos::square) of 128 m a position lies.
    pub const SQUARE_BITS: u32 = 2 * (7 + GRID_PER_METRE.ilog2());

    /// Which square of 128 m it lies in, in the order of their Morton codes: what is seen from far away is told by these, and regions of a
    /// stored city are no smaller.
    #[must_use]
    pub fn square(self) -> u64 {
        self.morton() >> Self::SQUARE_BITS
    }
}

/// Each step doubles the gaps between the bits of a number, from halves of 16 bits to single ones.
const MORTON_STEPS: [(u32, u64); 5] = [
    (16, 0x0000_FFFF_0000_FFFF),
    (8, 0x00FF_00FF_00FF_00FF),
    (4, 0x0F0F_0F0F_0F0F_0F0F),
    (2, 0x3333_3333_3333_3333),
    (1, 0x5555_5555_5555_5555),
];

impl Add for GridPos {
    type Output = Self;
    fn add(self, rhs: Self) -> Self {
        Self(self.0 + rhs.0, self.1 + rhs.1)
    }
}

impl Sub for GridPos {
    type Output = Self;
    fn sub(self, rhs: Self) -> Self {
        Self(self.0 - rhs.0, self.1 - rhs.1)
    }
}

/// A closed ring: the last vertex joins the first and is not repeated.
pub type GridRing = Vec<GridPos>;

/// A polygon on the grid: outer ring counter-clockwise, holes clockwise.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GridPolygon {
    /// Outer ring, counter-clockwise.
    pub outer: GridRing,
    /// Holes, clockwise.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub holes: Vec<GridRing>,
}

impl GridPolygon {
    /// The polygon of what becomes of each vertex.
    #[must_use]
    pub fn map(&self, mut to: impl FnMut(GridPos) -> GridPos) -> Self {
        let mut ring = |ring: &GridRing| ring.iter().map(|&pos| to(pos)).collect();
        Self { outer: ring(&self.outer), holes: self.holes.iter().map(&mut ring).collect() }
    }

    /// A polygon without holes.
    #[must_use]
    pub fn simple(outer: GridRing) -> Self {
        Self { outer, holes: Vec::new() }
    }

    /// The outer ring, then the holes.
    pub fn rings(&self) -> impl Iterator<Item = &GridRing> {
        core::iter::once(&self.outer).chain(&self.holes)
    }

    /// The edges of all rings, in order.
    pub fn edges(&self) -> impl Iterator<Item = (GridPos, GridPos)> + '_ {
        self.rings().flat_map(|ring| ring_edges(ring))
    }

    /// Area in square metres, holes taken off.
    #[must_use]
    pub fn area_m2(&self) -> f64 {
        let twice: f64 = self.rings().map(|ring| ring_area_2(ring) as f64).sum();
        twice / 2.0 / f64::from(GRID_PER_METRE) / f64::from(GRID_PER_METRE)
    }

    /// Whether a position lies inside (even–odd rule; a position on the border may count either way).
    #[must_use]
    pub fn contains(&self, p: GridPos) -> bool {
        self.holes.iter().fold(ring_contains(&self.outer, p), |inside, hole| inside != ring_contains(hole, p))
    }

    /// Least and greatest corner of the outer ring; `None` if it is empty.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        bounds::around(&self.outer)
    }

    /// The middle of the box about all its rings; (0, 0) if it is empty.
    #[must_use]
    pub fn middle(&self) -> GridPos {
        bounds::around(self.rings().flatten()).map_or(GridPos(0, 0), |(lo, hi)| lo.midpoint(hi))
    }

    /// Centroid of the outer ring in metres; the mean of its vertices if it has no area.
    #[must_use]
    pub fn centroid(&self) -> DVec2 {
        let Some(&origin) = self.outer.first() else { return DVec2::ZERO };
        let base = origin.to_metres();
        let (mut sum, mut twice) = (DVec2::ZERO, 0.0);
        for (a, b) in ring_edges(&self.outer) {
            let (a, b) = (a.to_metres() - base, b.to_metres() - base);
            let cross = a.perp_dot(b);
            twice += cross;
            sum += (a + b) * cross;
        }
        if twice.abs() < 1e-9 {
            return self.outer.iter().map(|p| p.to_metres()).sum::<DVec2>() / self.outer.len() as f64;
        }
        base + sum / (3.0 * twice)
    }
}

/// The edges of a closed ring, in order: each vertex with the next one, the last with the first.
pub fn ring_edges<P: Copy>(ring: &[P]) -> impl Iterator<Item = (P, P)> + Clone + '_ {
    // By index: zipping with a cycle takes several times as long.
    (0..ring.len()).map(move |i| (ring[i], ring[if i + 1 < ring.len() { i + 1 } else { 0 }]))
}

fn ring_area_2(ring: &[GridPos]) -> i64 {
    let Some(&origin) = ring.first() else { return 0 };
    ring_edges(ring).fold(0, |sum, (a, b)| sum.saturating_add(origin.cross(a, b)))
}

fn ring_contains(ring: &[GridPos], p: GridPos) -> bool {
    let Some(&last) = ring.last() else { return false };
    let (mut a, mut a_is_above, mut inside) = (last, last.1 > p.1, false);
    for &b in ring {
        let b_is_above = b.1 > p.1;
        if a_is_above != b_is_above {
            // Taken upwards whichever way the ring runs: of two rings that share an edge, one has the positions on it.
            let (low, high) = if b_is_above { (a, b) } else { (b, a) };
            inside ^= low.cross(high, p) > 0;
        }
        (a, a_is_above) = (b, b_is_above);
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(side: i32) -> GridRing {
        vec![GridPos(0, 0), GridPos(side, 0), GridPos(side, side), GridPos(0, side)]
    }

    #[test]
    fn morton_codes_follow_the_quadtree() {
        assert_eq!(GridPos(i32::MIN, i32::MIN).morton(), 0);
        assert_eq!(GridPos(i32::MAX, i32::MAX).morton(), u64::MAX);
        assert_eq!(GridPos(1, 0).morton() - GridPos(0, 0).morton(), 1, "east is the lower bit");
        assert_eq!(GridPos(0, 1).morton() - GridPos(0, 0).morton(), 2);
        let mut square = [(0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (3, 1), (0, 2), (-1, 0), (0, -1)].map(|(x, y)| GridPos(x, y));
        square.sort_by_key(|pos| pos.morton());
        let order = [(0, -1), (-1, 0), (0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (3, 1), (0, 2)].map(|(x, y)| GridPos(x, y));
        assert_eq!(square, order);
    }

    #[test]
    fn the_middle_counts_all_rings() {
        let polygon = GridPolygon { outer: square(10), holes: vec![vec![GridPos(-4, 2), GridPos(3, 3), GridPos(5, 31)]] };
        assert_eq!((polygon.middle(), GridPolygon::default().middle()), (GridPos(3, 15), GridPos(0, 0)));
    }

    #[test]
    fn lengths_are_rounded_to_the_nearest_step_and_saturate() {
        let mut draw = 1_u64;
        for i in 0..100_000_u64 {
            draw = draw.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(i | 1);
            let length = (draw >> 20) as f64 / (1_u64 << (draw % 44)) as f64 - f64::from(i as u32 % 5000);
            assert_eq!(GridPos::steps(length), libm::round(length * 1024.0) as i32, "{length}");
        }
        for half in -5..=5 {
            let length = (f64::from(half) + 0.5) / 1024.0;
            let [below, above] = [f64::from_bits(length.to_bits() - 1), f64::from_bits(length.to_bits() + 1)];
            for length in [below, length, above] {
                assert_eq!(GridPos::steps(length), libm::round(length * 1024.0) as i32, "{length}");
            }
        }
        let ends = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 2.097e6, -2.098e6, 0.0, -0.0];
        for length in ends {
            assert_eq!(GridPos::steps(length), libm::round(length * 1024.0) as i32, "{length}");
        }
    }

    #[test]
    fn area_of_a_frame_is_outer_less_hole() {
        let mut hole: GridRing = square(1024).into_iter().map(|p| p + GridPos(1024, 1024)).collect();
        hole.reverse();
        let frame = GridPolygon { outer: square(4096), holes: vec![hole] };
        assert_eq!(frame.area_m2(), 15.0);
        assert!(frame.contains(GridPos(512, 512)));
        assert!(!frame.contains(GridPos(1500, 1500)), "the hole is outside");
        assert!(!frame.contains(GridPos(-1, 5)));
    }

    #[test]
    fn a_position_on_a_shared_edge_lies_in_exactly_one_of_its_two_polygons() {
        let (a, b, c, d) = (GridPos(0, 0), GridPos(100, 0), GridPos(100, 100), GridPos(0, 100));
        let (below, above) = (GridPolygon::simple(vec![a, b, c]), GridPolygon::simple(vec![a, c, d]));
        for i in 1..100 {
            let p = GridPos(i, i);
            assert!(below.contains(p) != above.contains(p), "{p:?}");
        }
    }

    #[test]
    fn metres_survive_the_grid_to_half_a_step() {
        let p = DVec2::new(-123.456, 7890.123);
        assert!((GridPos::from_metres(p).to_metres() - p).abs().max_element() <= 0.5 / 1024.0);
    }

    #[test]
    fn centroid_of_a_far_square_is_its_middle() {
        let far: GridRing = square(2048).into_iter().map(|p| p + GridPos(1 << 30, -(1 << 30))).collect();
        let middle = GridPolygon::simple(far).centroid() - GridPos(1 << 30, -(1 << 30)).to_metres();
        assert!((middle - DVec2::ONE).length() < 1e-6, "{middle}");
    }
}
