//! Which cell a position lies in, and which is nearest.

use std::sync::OnceLock;

use rstar::{
    PointDistance, RTree,
    primitives::{GeomWithData, Line},
};
use veduta_city::{Cell, GridPos};

use crate::buckets::Buckets;
use crate::patches::corner;

/// Finds cells by place.
pub(crate) struct Locator<'a> {
    cells: &'a [Cell],
    buckets: Buckets,
    /// The cells' edges, once something asks for what is nearest.
    edges: OnceLock<RTree<GeomWithData<Line<[f64; 2]>, u32>>>,
}

impl<'a> Locator<'a> {
    pub(crate) fn new(cells: &'a [Cell]) -> Self {
        let buckets = Buckets::new(cells.iter().map(|cell| cell.outline.bounds()).collect());
        Self { cells, buckets, edges: OnceLock::new() }
    }

    /// The cell in which a position lies.
    pub(crate) fn find(&self, pos: GridPos) -> Option<u32> {
        self.buckets.holding(pos).find(|&cell| self.cells[cell as usize].outline.contains(pos))
    }

    fn edges(&self) -> &RTree<GeomWithData<Line<[f64; 2]>, u32>> {
        self.edges.get_or_init(|| {
            let edge = |i, (a, b)| GeomWithData::new(Line::new(corner(a), corner(b)), i);
            let edges = (0..).zip(self.cells).flat_map(|(i, cell)| cell.outline.edges().map(move |ends| edge(i, ends)));
            RTree::bulk_load(edges.collect())
        })
    }

    /// The cell whose border is nearest, the first of several, and the distance squared in grid steps squared; `None` if there
    /// are no cells.
    pub(crate) fn nearest(&self, pos: GridPos) -> Option<(u32, f64)> {
        let mut nearest = self.edges().nearest_neighbor_iter(&corner(pos)).map(|edge| (edge.data, edge.distance_2(&corner(pos))));
        let (first, distance_2) = nearest.next()?;
        let cell = nearest.take_while(|&(_, d)| d <= distance_2).map(|(cell, _)| cell).fold(first, u32::min);
        Some((cell, distance_2))
    }

    /// The cell in which a position lies, or else the nearest; `None` if there are no cells.
    pub(crate) fn find_or_nearest(&self, pos: GridPos) -> Option<u32> {
        self.find(pos).or_else(|| self.nearest(pos).map(|(cell, _)| cell))
    }
}
