//! The largest disc in a polygon: squares are searched in the order of how large a disc could at most lie about a place in them,
//! and cut into four, until none can be much better than what was found.
//!
//! # Sources
//! The search is that of `polylabel` (Agafonkin, 2016), after Garcia-Castellanos and Lombardo, *Poles of inaccessibility* (2007).

use core::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec2;
use veduta_city::GridPolygon;

use super::outline;

/// The radius is told to this share of itself.
const SHARE: f64 = 0.05;
/// Most squares along the bounds of a polygon at the start.
const MOST_ALONG: f64 = 16.0;

/// Discs smaller than this are none, metres.
const LEAST_M: f64 = 0.01;

/// A square that is searched.
#[derive(Debug, Clone, Copy)]
struct Square {
    middle: DVec2,
    half: f64,
    /// No disc about a place in the square is larger.
    most: f64,
    /// The edge nearest to the middle.
    nearest: usize,
}

impl Ord for Square {
    fn cmp(&self, other: &Self) -> Ordering {
        self.most.total_cmp(&other.most)
    }
}

impl PartialOrd for Square {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Square {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Square {}

/// Radius of the largest disc within, at most 5 % less, or of one that is large enough; metres.
pub(super) fn inradius_m(polygon: &GridPolygon, enough_m: f64) -> f64 {
    largest_disc(polygon, enough_m).map_or(0.0, |(_, radius)| radius)
}

/// Middle and radius of that disc, plan metres; `None` where there is none.
pub(super) fn largest_disc(polygon: &GridPolygon, enough_m: f64) -> Option<(DVec2, f64)> {
    let (low, high) = polygon.bounds()?;
    let edges: Vec<Edge> = polygon
        .rings()
        .flat_map(|ring| outline::edges(ring))
        .map(|(a, b)| Edge::new((a - low).to_metres(), (b - low).to_metres()))
        .collect();
    let size = (high - low).to_metres();
    let side = size.min_element().max(size.max_element() / MOST_ALONG);
    if side <= 0.0 {
        return None;
    }
    let mut best = (DVec2::ZERO, 0.0_f64);
    let mut squares = BinaryHeap::new();
    let search = |(middle, half): (DVec2, f64), likely: usize, best: &mut (DVec2, f64), squares: &mut BinaryHeap<Square>| {
        let beyond = half * core::f64::consts::SQRT_2;
        // Smaller discs are not the best, and so much smaller ones that there is none worth a search about a place in the square.
        let least = best.1.min(best.1 * (1.0 + SHARE) - beyond);
        let Some((radius, nearest)) = signed_distance(&edges, middle, least, likely) else { return };
        if radius > best.1 {
            *best = (middle, radius);
        }
        let most = radius + beyond;
        if most > best.1 * (1.0 + SHARE) {
            squares.push(Square { middle, half, most, nearest });
        }
    };
    let count = (size / side).ceil().max(DVec2::ONE);
    for row in 0..count.y as u32 {
        for column in 0..count.x as u32 {
            let middle = size * (DVec2::new(f64::from(column), f64::from(row)) + 0.5) / count;
            search((middle, side / 2.0), 0, &mut best, &mut squares);
        }
    }
    while let Some(square) = squares.pop() {
        if square.most <= (best.1 * (1.0 + SHARE)).max(LEAST_M) || best.1 >= enough_m {
            break;
        }
        let half = square.half / 2.0;
        for quarter in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            search((square.middle + DVec2::from(quarter) * half, half), square.nearest, &mut best, &mut squares);
        }
    }
    (best.1 > 0.0).then(|| (low.to_metres() + best.0, best.1))
}

/// An edge of a polygon, metres.
struct Edge {
    from: DVec2,
    way: DVec2,
    /// 1 / its length squared; 0 for one of no length.
    inverse: f64,
}

impl Edge {
    fn new(from: DVec2, to: DVec2) -> Self {
        let way = to - from;
        let squared = way.length_squared();
        Self { from, way, inverse: if squared > 0.0 { 1.0 / squared } else { 0.0 } }
    }

    fn squared_distance(&self, p: DVec2) -> f64 {
        let off = p - self.from;
        let along = (off.dot(self.way) * self.inverse).clamp(0.0, 1.0);
        (off - self.way * along).length_squared()
    }
}

/// Distance from the border of a polygon, negative outside, and the nearest edge; `None` as soon as the distance is known to be less than
/// another. An edge that is likely to be near is looked at first.
fn signed_distance(edges: &[Edge], p: DVec2, least_m: f64, likely: usize) -> Option<(f64, usize)> {
    let (mut least, mut nearest, mut is_inside) = (f64::INFINITY, 0, false);
    let too_near = least_m.max(0.0) * least_m.max(0.0);
    if edges[likely].squared_distance(p) < too_near {
        return None;
    }
    for (i, edge) in edges.iter().enumerate() {
        let squared = edge.squared_distance(p);
        if squared < least {
            (least, nearest) = (squared, i);
            if least < too_near {
                return None;
            }
        }
        let off = p - edge.from;
        let (is_below, reaches_above) = (off.y < 0.0, off.y < edge.way.y);
        is_inside ^= is_below != reaches_above && (edge.way.perp_dot(off) > 0.0) == reaches_above;
    }
    Some((if is_inside { least.sqrt() } else { -least.sqrt() }, nearest))
}

#[cfg(test)]
mod tests {
    use veduta_city::draw::Draw;
    use veduta_city::{GridPos, Id};

    use super::*;

    fn polygon(outer: &[(f64, f64)], hole: &[(f64, f64)]) -> GridPolygon {
        let ring = |of: &[(f64, f64)]| of.iter().map(|&(x, y)| GridPos::from_metres(DVec2::new(x, y))).collect();
        GridPolygon { outer: ring(outer), holes: if hole.is_empty() { Vec::new() } else { vec![ring(hole)] } }
    }

    #[test]
    fn known_shapes_have_their_radius() {
        let square = |side: f64| [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)];
        let ell = [(0.0, 0.0), (30.0, 0.0), (30.0, 10.0), (10.0, 10.0), (10.0, 30.0), (0.0, 30.0)];
        for (polygon, radius) in [
            (polygon(&[(0.0, 0.0), (60.0, 0.0), (60.0, 30.0), (0.0, 30.0)], &[]), 15.0),
            (polygon(&[(0.0, 0.0), (400.0, 300.0), (397.0, 304.0), (-3.0, 4.0)], &[]), 2.5),
            // Of a disc in the corner, which the corner across touches: √2 (10 − r) = r.
            (polygon(&ell, &[]), 20.0 / (2.0 + core::f64::consts::SQRT_2)),
            (polygon(&[(0.0, 0.0), (3.0, 0.0), (0.0, 4.0)], &[]), 1.0),
            (
                polygon(&square(30.0), &[(10.0, 10.0), (10.0, 20.0), (20.0, 20.0), (20.0, 10.0)]),
                20.0 / (2.0 + core::f64::consts::SQRT_2),
            ),
        ] {
            let found = inradius_m(&polygon, f64::INFINITY);
            assert!(found <= radius * 1.001 && found > radius * 0.95, "{found} for {radius}");
            let enough = inradius_m(&polygon, 0.5 * radius);
            assert!(enough <= radius * 1.001 && enough >= 0.5 * radius, "{enough} for half of {radius}");
        }
    }

    #[test]
    fn no_place_lies_much_deeper_than_the_disc_that_is_found() {
        for seed in 0..200_u64 {
            let draw = Draw::new(seed, Id(1), "star");
            let corner = |i: u64| DVec2::from_angle(0.5 * i as f64) * draw.part(i).between("radius", 3.0, 40.0);
            let star: Vec<GridPos> = (0..12).map(|i| GridPos::from_metres(corner(i))).collect();
            let polygon = GridPolygon::simple(star);
            let edges: Vec<Edge> = polygon.edges().map(|(a, b)| Edge::new(a.to_metres(), b.to_metres())).collect();
            let depth = |p: DVec2| signed_distance(&edges, p, f64::NEG_INFINITY, 0).map_or(0.0, |(depth, _)| depth);
            let (middle, radius) = largest_disc(&polygon, f64::INFINITY).expect("it has area");
            assert!((depth(middle) - radius).abs() < 1e-6, "seed {seed}");
            let places = (-40..=40).flat_map(|x| (-40..=40).map(move |y| DVec2::new(f64::from(x), f64::from(y))));
            let deepest = places.map(depth).fold(0.0, f64::max);
            assert!(deepest <= radius * (1.0 + SHARE) + 1e-6, "seed {seed}: {deepest} m beside {radius} m");
        }
    }

    #[test]
    fn what_has_no_area_has_no_radius() {
        assert_eq!(inradius_m(&GridPolygon::default(), 9.0), 0.0);
        assert_eq!(inradius_m(&polygon(&[(0.0, 0.0), (5.0, 0.0)], &[]), 9.0), 0.0);
        assert!(inradius_m(&polygon(&[(0.0, 0.0), (500.0, 0.1), (1000.0, 0.0)], &[]), 9.0) < 0.06);
    }
}
