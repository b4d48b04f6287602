//! Which cell a position lies in, and which is nearest.

use std::sync::OnceLock;

use rstar::{
    PointDistance, RTree,
    primitives::{GeomWithData, Line},
};
use veduta_city::{Cell, GridPos};

use crate::overlay::Bounds;

/// Finds cells by place.
pub(crate) struct Locator<'a> {
    cells: &'a [Cell],
    /// Bounds of each cell.
    bounds: Vec<Option<Bounds>>,
    /// Least corner of the buckets.
    origin: GridPos,
    /// Side of a bucket, grid steps.
    side: i64,
    columns: i64,
    rows: i64,
    /// Cells whose bounds touch each bucket, row by row, ascending.
    buckets: Vec<Vec<u32>>,
    /// The cells' edges, once something asks for what is nearest.
    edges: OnceLock<RTree<GeomWithData<Line<[f64; 2]>, u32>>>,
}

/// Side of a bucket where the city is small enough, grid steps: 32 m.
const SIDE: i64 = 32 * 1024;
/// Most buckets along one axis.
const MOST: i64 = 1000;

impl<'a> Locator<'a> {
    pub(crate) fn new(cells: &'a [Cell]) -> Self {
        let bounds: Vec<Option<Bounds>> = cells.iter().map(|cell| cell.outline.bounds()).collect();
        let all = bounds
            .iter()
            .flatten()
            .copied()
            .reduce(|(lo, hi), (l, h)| (GridPos(lo.0.min(l.0), lo.1.min(l.1)), GridPos(hi.0.max(h.0), hi.1.max(h.1))));
        let (origin, end) = all.unwrap_or_default();
        let (width, height) = (i64::from(end.0) - i64::from(origin.0), i64::from(end.1) - i64::from(origin.1));
        let side = SIDE.max(width.max(height) / MOST + 1);
        let (columns, rows) = (width / side + 1, height / side + 1);
        let mut locator = Self { cells, bounds, origin, side, columns, rows, buckets: Vec::new(), edges: OnceLock::new() };
        locator.fill();
        locator
    }

    fn fill(&mut self) {
        self.buckets = vec![Vec::new(); (self.columns * self.rows) as usize];
        for (i, bounds) in (0..).zip(&self.bounds) {
            let Some((lo, hi)) = *bounds else { continue };
            let ((x0, y0), (x1, y1)) = (self.bucket(lo), self.bucket(hi));
            for y in y0..=y1 {
                for x in x0..=x1 {
                    self.buckets[(y * self.columns + x) as usize].push(i);
                }
            }
        }
    }

    /// Column and row; outside of the buckets for positions outside of all cells.
    fn bucket(&self, pos: GridPos) -> (i64, i64) {
        let at = |v: i32, from: i32| (i64::from(v) - i64::from(from)).div_euclid(self.side);
        (at(pos.0, self.origin.0), at(pos.1, self.origin.1))
    }

    /// The cell in which a position lies.
    pub(crate) fn find(&self, pos: GridPos) -> Option<u32> {
        let (x, y) = self.bucket(pos);
        if x < 0 || y < 0 || x >= self.columns || y >= self.rows {
            return None;
        }
        let bucket = &self.buckets[(y * self.columns + x) as usize];
        bucket.iter().copied().find(|&i| {
            let is_near =
                self.bounds[i as usize].is_some_and(|(lo, hi)| lo.0 <= pos.0 && pos.0 <= hi.0 && lo.1 <= pos.1 && pos.1 <= hi.1);
            is_near && self.cells[i as usize].outline.contains(pos)
        })
    }

    fn edges(&self) -> &RTree<GeomWithData<Line<[f64; 2]>, u32>> {
        self.edges.get_or_init(|| {
            let edge = |i, (a, b)| GeomWithData::new(Line::new(float(a), float(b)), i);
            let edges = (0..).zip(self.cells).flat_map(|(i, cell)| cell.outline.edges().map(move |ends| edge(i, ends)));
            RTree::bulk_load(edges.collect())
        })
    }

    /// The cell whose border is nearest, the first of several, and the distance squared in grid steps squared; `None` if there
    /// are no cells.
    pub(crate) fn nearest(&self, pos: GridPos) -> Option<(u32, f64)> {
        let mut nearest = self.edges().nearest_neighbor_iter(&float(pos)).map(|edge| (edge.data, edge.distance_2(&float(pos))));
        let (first, distance_2) = nearest.next()?;
        let cell = nearest.take_while(|&(_, d)| d <= distance_2).map(|(cell, _)| cell).fold(first, u32::min);
        Some((cell, distance_2))
    }

    /// The cell in which a position lies, or else the nearest; `None` if there are no cells.
    pub(crate) fn find_or_nearest(&self, pos: GridPos) -> Option<u32> {
        self.find(pos).or_else(|| self.nearest(pos).map(|(cell, _)| cell))
    }
}

fn float(p: GridPos) -> [f64; 2] {
    [f64::from(p.0), f64::from(p.1)]
}
