//! Convex hulls on the grid.

use veduta_city::GridPos;

use crate::overlay::ring_area_2;

/// A convex polygon, counter-clockwise, without collinear vertices.
#[derive(Debug, Clone, Default)]
pub(crate) struct Hull {
    pub(crate) corners: Vec<GridPos>,
    /// Twice the area, grid steps squared.
    pub(crate) area_2: i64,
    /// Greatest distance between two corners squared, grid steps squared.
    pub(crate) diameter_2: i64,
}

impl Hull {
    /// Andrew's monotone chain.
    pub(crate) fn of(mut points: Vec<GridPos>) -> Self {
        points.sort_unstable();
        points.dedup();
        let mut corners: Vec<GridPos> = Vec::with_capacity(points.len() + 1);
        for round in 0..2 {
            let start = corners.len();
            for &p in &points {
                while corners.len() >= start + 2 && corners[corners.len() - 2].cross(corners[corners.len() - 1], p) <= 0 {
                    corners.pop();
                }
                corners.push(p);
            }
            corners.pop();
            if round == 0 {
                points.reverse();
            }
        }
        let area_2 = ring_area_2(&corners);
        let diameter_2 = corners.iter().enumerate().flat_map(|(i, &a)| corners[..i].iter().map(move |&b| distance_2(a, b))).max();
        Self { area_2, diameter_2: diameter_2.unwrap_or(0), corners }
    }

    /// The hull of two.
    pub(crate) fn with(&self, other: &Self) -> Self {
        Self::of(self.corners.iter().chain(&other.corners).copied().collect())
    }
}

/// Distance squared in grid steps squared.
pub(crate) fn distance_2(a: GridPos, b: GridPos) -> i64 {
    let (x, y) = (i64::from(a.0) - i64::from(b.0), i64::from(a.1) - i64::from(b.1));
    x * x + y * y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_is_convex_and_keeps_no_vertex_on_a_side() {
        let hull = Hull::of(vec![GridPos(0, 0), GridPos(5, 0), GridPos(10, 0), GridPos(10, 10), GridPos(0, 10), GridPos(4, 6)]);
        assert_eq!(hull.corners, [GridPos(0, 0), GridPos(10, 0), GridPos(10, 10), GridPos(0, 10)]);
        assert_eq!((hull.area_2, hull.diameter_2), (200, 200));
    }
}
