//! Yards widened under the houses about them, where no ground is seen.
//!
//! A yard borders on each corner of every house about it, and most of those are told with other cells. Under the houses its outline may run
//! as it likes, with less than half the vertices.

use rstar::{
    AABB, RTree,
    primitives::{GeomWithData, Rectangle},
};
use veduta_city::{CityPlan, GRID_PER_METRE, GridPolygon, GridPos, GridRing, House, PLAN_STEP, Volume};

use crate::overlay::{Bounds, Edge, Keep, combine, edges, turned_rings};
use crate::patches::corner;

/// Volumes that hide the ground they stand on, by their bounds.
pub(crate) struct Hidden<'a> {
    volumes: RTree<GeomWithData<Rectangle<[f64; 2]>, &'a Volume>>,
}

impl<'a> Hidden<'a> {
    pub(crate) fn new(plan: &'a CityPlan) -> Self {
        let volumes = plan.houses.iter().flat_map(hiding).filter_map(|volume| {
            let (lo, hi) = volume.footprint.bounds()?;
            Some(GeomWithData::new(Rectangle::from_corners(corner(lo), corner(hi)), volume))
        });
        Self { volumes: RTree::bulk_load(volumes.collect()) }
    }

    /// A polygon of fewer vertices that covers a yard and, besides, only ground that nobody sees.
    pub(crate) fn widened(&self, yard: &GridPolygon) -> GridPolygon {
        let Some((lo, hi)) = yard.bounds() else { return yard.clone() };
        let near = self.volumes.locate_in_envelope_intersecting(&AABB::from_corners(corner(lo), corner(hi)));
        let houses = near.flat_map(|found| turned_rings(&found.data.footprint));
        widened(yard, houses.collect())
    }
}

/// Volumes of a house that stand on the ground and hide it. Monuments need not fill their footprints, and arcades are walked in.
fn hiding(house: &House) -> impl Iterator<Item = &Volume> {
    let foot = house.volumes.iter().map(|volume| volume.bottom).min().unwrap_or(0);
    let volumes = house.volumes.iter().filter(|_| house.monument.is_none());
    volumes.filter(move |volume| volume.bottom.saturating_sub(foot) < GRID_PER_METRE / 4 && volume.arcades.is_empty())
}

fn widened(yard: &GridPolygon, mut houses: Vec<GridRing>) -> GridPolygon {
    // In one order, whatever that of the index.
    houses.sort_unstable();
    let whole: Vec<GridRing> = combine(Keep::First, turned_rings(yard).chain(houses), [], false)
        .into_iter()
        .flat_map(|polygon| core::iter::once(polygon.outer).chain(polygon.holes))
        .filter_map(without_gaps)
        .collect();
    let limits: Vec<Edge> = whole.iter().flat_map(|ring| edges(ring)).collect();
    // Houses that stand within it are passed under, unless they hide nothing.
    let is_limited = |hole: &GridRing| {
        let turned: GridRing = hole.iter().rev().copied().collect();
        !combine(Keep::FirstAlone, [turned], whole.iter().cloned(), false).is_empty()
    };
    let mut all = turned_rings(yard);
    let mut rings: Vec<GridRing> = all.next().into_iter().collect();
    rings.extend(all.filter(is_limited));
    let (Some(lo), Some(hi)) = (corner_of(&whole, i32::min), corner_of(&whole, i32::max)) else { return yard.clone() };
    for ring in 0..rings.len() {
        while let Some(fewer) = with_one_less(&rings, ring, (&limits, (lo, hi))) {
            rings[ring] = fewer;
        }
    }
    let mut rings = rings.into_iter();
    GridPolygon { outer: rings.next().unwrap_or_default(), holes: rings.collect() }
}

/// The corner of all rings that lies farthest one way.
fn corner_of(rings: &[GridRing], far: fn(i32, i32) -> i32) -> Option<GridPos> {
    rings.iter().flatten().copied().reduce(|a, b| GridPos(far(a.0, b.0), far(a.1, b.1)))
}

/// A ring, its inside on the left, with the gaps outside of it closed that are narrower than a step of plans: houses in a row do not always meet.
/// None if nothing is left of it.
fn without_gaps(mut ring: GridRing) -> Option<GridRing> {
    let is_gap = |[a, b, c]: [GridPos; 3]| {
        let longest =
            [(a, b), (b, c), (c, a)].map(|(p, q)| (q.to_metres() - p.to_metres()).length()).into_iter().fold(0.0, f64::max);
        let across = -a.cross(b, c);
        across >= 0 && across as f64 <= f64::from(PLAN_STEP) * f64::from(GRID_PER_METRE) * longest
    };
    let mut i = 0;
    let mut tried = 0;
    while tried < ring.len() && ring.len() > 2 {
        let n = ring.len();
        if is_gap([ring[(i + n - 1) % n], ring[i % n], ring[(i + 1) % n]]) {
            ring.remove(i % n);
            (i, tried) = (i + n - 2, 0);
        } else {
            (i, tried) = (i + 1, tried + 1);
        }
        i %= ring.len();
    }
    (ring.len() > 2).then_some(ring)
}

/// A ring, its inside on the left, with one vertex less: the way that adds least to what it holds, and nothing beyond the limits or what the
/// rings hold already. None if there is none.
fn with_one_less(rings: &[GridRing], which: usize, (limits, (lo, hi)): (&[Edge], Bounds)) -> Option<GridRing> {
    let ring = &rings[which];
    let count = ring.len();
    if count < 4 {
        return None;
    }
    let mut ways: Vec<(i64, usize, Option<GridPos>)> = Vec::new();
    for i in 0..count {
        let [a, b, c, d] = core::array::from_fn(|n| ring[(i + n) % count]);
        if a.cross(b, c) <= 0 {
            ways.push((-a.cross(b, c), i, None));
        }
        let is_within = |x: &GridPos| lo.0 <= x.0 && x.0 <= hi.0 && lo.1 <= x.1 && x.1 <= hi.1;
        if let Some(x) = meeting(a, b, c, d).filter(is_within) {
            ways.push((added([a, b, c, d], x).iter().map(|[p, q, r]| p.cross(*q, *r)).sum(), i, Some(x)));
        }
    }
    ways.sort_unstable();
    let is_clear = |[p, q, r]: [GridPos; 3]| {
        let borders = limits.iter().copied().chain(rings.iter().flat_map(|ring| edges(ring)));
        p.cross(q, r) == 0 || (!borders.into_iter().any(|edge| enters(edge, [p, q, r])) && holds_middle(limits, [p, q, r]))
    };
    let found = ways.into_iter().find(|&(_, i, x)| {
        let [a, b, c, d] = core::array::from_fn(|n| ring[(i + n) % count]);
        match x {
            None => is_clear([a, c, b]),
            Some(x) => added([a, b, c, d], x).into_iter().all(is_clear),
        }
    });
    let (_, i, x) = found?;
    let mut fewer: GridRing = (0..count).map(|n| ring[(i + n) % count]).collect();
    match x {
        None => _ = fewer.remove(1),
        Some(x) => _ = fewer.splice(1..3, [x]),
    }
    Some(fewer)
}

/// What a ring gains that goes from `a` to `d` by way of `x` rather than of `b` and `c`, as triangles that run counter-clockwise.
const fn added([a, b, c, d]: [GridPos; 4], x: GridPos) -> [[GridPos; 3]; 3] {
    [[a, x, b], [b, x, c], [c, x, d]]
}

/// Where the edges before and after another one meet beyond it, to steps of the plan: both ends of the edge between lie on the left of the
/// way by there, or on it.
fn meeting(a: GridPos, b: GridPos, c: GridPos, d: GridPos) -> Option<GridPos> {
    // How far off the place may be for its steps, each way.
    const OFF: i32 = 2;
    let [from, to, at] = [b.to_metres() - a.to_metres(), c.to_metres() - d.to_metres(), b.to_metres()];
    let turn = from.perp_dot(to);
    if turn <= 0.0 || a.cross(b, c) <= 0 || b.cross(c, d) <= 0 {
        return None;
    }
    let along = (c.to_metres() - at).perp_dot(to) / turn;
    let x = (along > 0.0).then(|| GridPos::from_metres(at + from * along).rounded(PLAN_STEP))?;
    let steps = (-OFF..=OFF).flat_map(|i| (-OFF..=OFF).map(move |j| GridPos(i * PLAN_STEP, j * PLAN_STEP)));
    let around = steps.map(|step| x.wrapping_add(step));
    let holds = |x: &GridPos| added([a, b, c, d], *x).iter().all(|[p, q, r]| p.cross(*q, *r) >= 0);
    let adds = |x: &GridPos| added([a, b, c, d], *x).iter().map(|[p, q, r]| p.cross(*q, *r)).sum::<i64>();
    around.filter(holds).min_by_key(|x| (adds(x), *x))
}

/// Whether the middle of a triangle lies within the limits, which do not pass through it.
fn holds_middle(limits: &[Edge], triangle: [GridPos; 3]) -> bool {
    // Three times as large as it is, from the middle.
    let sum = |of: fn(GridPos) -> i32| triangle.iter().map(|&p| i128::from(of(p))).sum::<i128>();
    let middle = (sum(|p| p.0), sum(|p| p.1));
    let off = |p: GridPos| (3 * i128::from(p.0) - middle.0, 3 * i128::from(p.1) - middle.1);
    let crosses = |&&(a, b): &&Edge| {
        let (a, b) = (off(a), off(b));
        // Those that pass the middle on its right.
        (a.1 > 0) != (b.1 > 0) && (a.0 * b.1 - a.1 * b.0 > 0) == (b.1 > a.1)
    };
    limits.iter().filter(crosses).count() % 2 == 1
}

/// Whether an edge passes through the inside of a triangle that runs counter-clockwise: no line parts them.
fn enters((a, b): Edge, triangle: [GridPos; 3]) -> bool {
    let sides = edges(&triangle);
    let is_beside = sides.into_iter().any(|(p, q)| p.cross(q, a) <= 0 && p.cross(q, b) <= 0);
    let off = triangle.map(|p| a.cross(b, p));
    !is_beside && off.iter().any(|&n| n > 0) && off.iter().any(|&n| n < 0)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::overlay::total_m2;

    fn ring(corners: &[(f64, f64)]) -> GridRing {
        corners.iter().map(|&(x, y)| GridPos::from_metres(glam::DVec2::new(x, y)).rounded(PLAN_STEP)).collect()
    }

    /// Houses in a row from one side of a block to the other, so deep.
    fn row(depths: &[f64], upside: bool) -> Vec<GridRing> {
        let house = |(i, &depth): (usize, &f64)| {
            let (x, far) = (8.0 * i as f64, if upside { 60.0 - depth } else { depth });
            let (lo, hi) = if upside { (far, 60.0) } else { (0.0, far) };
            ring(&[(x, lo), (x + 8.0, lo), (x + 8.0, hi), (x, hi)])
        };
        depths.iter().enumerate().map(house).collect()
    }

    fn m2(first: &[GridRing], second: &[GridRing], keep: Keep) -> f64 {
        total_m2(&combine(keep, first.to_vec(), second.to_vec(), false))
    }

    fn block(depths: &[(f64, f64)]) -> (Vec<GridRing>, Vec<GridPolygon>) {
        let (south, north): (Vec<f64>, Vec<f64>) = depths.iter().copied().unzip();
        let houses = [row(&south, false), row(&north, true)].concat();
        let width = 8.0 * depths.len() as f64;
        let ends = [ring(&[(-9.0, 0.0), (0.0, 0.0), (0.0, 60.0), (-9.0, 60.0)])];
        let ends = ends.into_iter().chain([ring(&[(width, 0.0), (width + 9.0, 0.0), (width + 9.0, 60.0), (width, 60.0)])]);
        let houses: Vec<GridRing> = houses.into_iter().chain(ends).collect();
        let yards =
            combine(Keep::FirstAlone, [ring(&[(0.0, 0.0), (width, 0.0), (width, 60.0), (0.0, 60.0)])], houses.clone(), false);
        (houses, yards)
    }

    proptest! {
        #[test]
        fn a_yard_is_covered_with_fewer_vertices_and_nothing_but_houses_besides(
            depths in proptest::collection::vec((6.0..24.0_f64, 6.0..24.0_f64), 1..12),
        ) {
            let (houses, yards) = block(&depths);
            prop_assert_eq!(yards.len(), 1);
            let made = widened(&yards[0], houses.clone());
            let (before, after): (Vec<GridRing>, Vec<GridRing>) = (turned_rings(&yards[0]).collect(), turned_rings(&made).collect());
            prop_assert_eq!(m2(&before, &after, Keep::FirstAlone), 0.0);
            prop_assert_eq!(m2(&after, &[before, houses].concat(), Keep::FirstAlone), 0.0);
            prop_assert!(made.outer.len() <= 4 + yards[0].outer.len() / 2, "{} of {}", made.outer.len(), yards[0].outer.len());
        }
    }

    #[test]
    fn a_yard_does_not_go_beyond_the_houses_about_it() {
        // An open corner, with a house on each side of it.
        let yard = GridPolygon::simple(ring(&[(0.0, 0.0), (20.0, 0.0), (20.0, 10.0), (10.0, 10.0), (10.0, 20.0), (0.0, 20.0)]));
        let houses = vec![
            ring(&[(20.0, 0.0), (30.0, 0.0), (30.0, 10.0), (20.0, 10.0)]),
            ring(&[(0.0, 20.0), (10.0, 20.0), (10.0, 30.0), (0.0, 30.0)]),
        ];
        assert_eq!(widened(&yard, houses), yard);
    }

    #[test]
    fn a_house_within_a_yard_is_passed_under_unless_its_ground_is_seen() {
        let (mut houses, _) = block(&[(10.0, 10.0); 5]);
        let lone = ring(&[(15.0, 25.0), (25.0, 25.0), (25.0, 35.0), (15.0, 35.0)]);
        let yard = |_: ()| {
            combine(Keep::FirstAlone, [ring(&[(0.0, 10.0), (40.0, 10.0), (40.0, 50.0), (0.0, 50.0)])], [lone.clone()], false)
        };
        assert_eq!(yard(())[0].holes.len(), 1);
        assert_eq!(widened(&yard(())[0], houses.clone()).holes.len(), 1, "it hides no ground");
        houses.push(lone.clone());
        assert_eq!(widened(&yard(())[0], houses), GridPolygon::simple(yard(())[0].outer.clone()));
    }
}
