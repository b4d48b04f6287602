use std::collections::BTreeSet;

use glam::DVec2;

use super::ElevationGrid;

/// So far beyond the grid's border a position still counts as inside: rounding must not lose what lies on it. Cells.
pub(super) const BORDER: f64 = 1e-6;
/// Farthest that a hole is filled from, in cells and in metres.
const REACH_CELLS: i64 = 64;
const REACH_M: f64 = 1000.0;
/// Farthest that data on one side alone is carried on into nothing, cells.
const CARRY_CELLS: i64 = 2;
/// Directions in which a hole looks for data: (column, row), anticlockwise from the east.
const DIRECTIONS: [(i64, i64); 16] = [
    (2, 0),
    (2, -1),
    (2, -2),
    (1, -2),
    (0, -2),
    (-1, -2),
    (-2, -2),
    (-2, -1),
    (-2, 0),
    (-2, 1),
    (-2, 2),
    (-1, 2),
    (0, 2),
    (1, 2),
    (2, 2),
    (2, 1),
];

/// What a grid says of a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Sample {
    /// An elevation from cells with data.
    Height(f64),
    /// An elevation for which a cell without data, or one that was taken out, had to be filled from around it.
    Filled(f64),
    /// In a hole too large to be filled.
    Hole,
    /// Beyond the grid.
    Outside,
}

impl Sample {
    pub(super) fn height_m(self) -> Option<f64> {
        match self {
            Self::Height(m) | Self::Filled(m) => Some(m),
            Self::Hole | Self::Outside => None,
        }
    }
}

/// Reads between the cells of a grid, taking some of them for holes.
pub(super) struct Sampler<'a> {
    grid: &'a ElevationGrid,
    taken_out: BTreeSet<(i64, i64)>,
    reach: i64,
}

impl<'a> Sampler<'a> {
    pub(super) fn new(grid: &'a ElevationGrid) -> Self {
        Self::without(grid, BTreeSet::new())
    }

    /// Takes some cells (column, row) for holes.
    pub(super) fn without(grid: &'a ElevationGrid, taken_out: BTreeSet<(i64, i64)>) -> Self {
        let reach = ((REACH_M / grid.cell_m) as i64).clamp(1, REACH_CELLS);
        Self { grid, taken_out, reach }
    }

    fn cell(&self, column: i64, row: i64) -> Option<f64> {
        let height = self.grid.cell(column, row)?;
        (!self.taken_out.contains(&(column, row))).then_some(height)
    }

    /// The elevation at a pixel position, bilinear between the middles of cells.
    pub(super) fn at(&self, pixel: DVec2) -> Sample {
        if !self.grid.holds(pixel) {
            return Sample::Outside;
        }
        let last = DVec2::new(f64::from(self.grid.columns), f64::from(self.grid.rows)) - 1.0;
        let pos = (pixel - 0.5).clamp(DVec2::ZERO, last);
        let (low, share) = (pos.floor(), pos - pos.floor());
        let (column, row) = (low.x as i64, low.y as i64);
        let corners = [
            (0, 0, (1.0 - share.x) * (1.0 - share.y)),
            (1, 0, share.x * (1.0 - share.y)),
            (0, 1, (1.0 - share.x) * share.y),
            (1, 1, share.x * share.y),
        ];
        let (mut sum, mut is_filled) = (0.0, false);
        for (dx, dy, weight) in corners.into_iter().filter(|c| c.2 > 0.0) {
            let known = self.cell(column + dx, row + dy);
            is_filled |= known.is_none();
            let Some(height) = known.or_else(|| self.fill(column + dx, row + dy)) else { return Sample::Hole };
            sum += weight * height;
        }
        if is_filled { Sample::Filled(sum) } else { Sample::Height(sum) }
    }

    /// What a hole's cell would hold: the mean of what is seen around it, weighted by nearness squared. `None` if there is
    /// nothing within reach, or only on one side and not close by.
    fn fill(&self, column: i64, row: i64) -> Option<f64> {
        let seen = DIRECTIONS.map(|direction| self.look((column, row), direction));
        // Directions one after the other that see nothing: half of them are a side.
        let longest = (0..16).map(|i| (0..16).take_while(|j| seen[(i + j) % 16].is_none()).count()).max()?;
        let nearest = seen.iter().flatten().map(|s| s.0).fold(f64::INFINITY, f64::min);
        if longest > 7 && nearest > CARRY_CELLS as f64 * core::f64::consts::SQRT_2 {
            return None;
        }
        let weight = |far: f64| 1.0 / (far * far);
        let (sum, weights) = seen.iter().flatten().fold((0.0, 0.0), |(s, w), &(far, h)| (s + weight(far) * h, w + weight(far)));
        (weights > 0.0).then(|| sum / weights)
    }

    /// Distance in cells and height of the first cell with data in a direction.
    fn look(&self, (column, row): (i64, i64), (dx, dy): (i64, i64)) -> Option<(f64, f64)> {
        for step in 1..=2 * self.reach {
            // Half steps: the directions in between are two cells long.
            let (x, y) = (dx * step, dy * step);
            if x % 2 != 0 || y % 2 != 0 {
                continue;
            }
            let (x, y) = (x / 2, y / 2);
            if x.abs().max(y.abs()) > self.reach {
                break;
            }
            if let Some(height) = self.cell(column + x, row + y) {
                return Some((libm::sqrt((x * x + y * y) as f64), height));
            }
        }
        None
    }
}
