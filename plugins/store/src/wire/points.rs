//! Vertices: each told once, then named by how far its number lies from that of the vertex before.
//!
//! Houses in a row share corners with each other and with the ground they stand on, and walk along the shared edge in the
//! opposite direction, so most names are the number one lower. A new vertex is told as its difference from a guess: the
//! vertex before, or from the fourth vertex of a ring on the corner that would close a parallelogram.

use std::collections::HashMap;

use serde::{Deserialize, Serialize};
use veduta_city::{GridPolygon, GridPos, GridRing};

use super::{Malformed, columns::Pull};

/// Columns of rings and lines.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Points {
    /// For a polygon: number of holes, then of vertices of each ring; for a line: number of vertices.
    counts: Vec<u32>,
    /// 0: a new vertex; else one more than the zig-zagged step from the number of the vertex before.
    names: Vec<u32>,
    east: Vec<i32>,
    north: Vec<i32>,
}

const fn add(a: GridPos, b: GridPos) -> GridPos {
    GridPos(a.0.wrapping_add(b.0), a.1.wrapping_add(b.1))
}

const fn sub(a: GridPos, b: GridPos) -> GridPos {
    GridPos(a.0.wrapping_sub(b.0), a.1.wrapping_sub(b.1))
}

/// Where the next vertex of a ring is guessed to lie, by those already told.
fn guess(ring: &[GridPos], last: GridPos) -> GridPos {
    match *ring {
        [.., a, b, c] => add(c, sub(a, b)),
        _ => last,
    }
}

/// Fills [`Points`].
#[derive(Default)]
pub(crate) struct PointWriter {
    out: Points,
    known: HashMap<GridPos, u32>,
    last: (GridPos, i64),
}

impl PointWriter {
    /// A vertex by itself.
    pub(crate) fn point(&mut self, pos: GridPos) {
        self.vertex(pos, self.last.0);
    }

    /// A line or ring.
    pub(crate) fn line(&mut self, line: &[GridPos]) {
        self.out.counts.push(line.len() as u32);
        for (i, &pos) in line.iter().enumerate() {
            let guessed = guess(line.get(..i).unwrap_or_default(), self.last.0);
            self.vertex(pos, guessed);
        }
    }

    /// A polygon.
    pub(crate) fn polygon(&mut self, polygon: &GridPolygon) {
        self.out.counts.push(polygon.holes.len() as u32);
        polygon.rings().for_each(|ring| self.line(ring));
    }

    pub(crate) fn finish(self) -> Points {
        self.out
    }

    fn vertex(&mut self, pos: GridPos, guessed: GridPos) {
        let number = match self.known.get(&pos) {
            Some(&number) => {
                let step = i64::from(number) - self.last.1;
                self.out.names.push(((step << 1) ^ (step >> 63)) as u32 + 1);
                i64::from(number)
            }
            None => {
                let off = sub(pos, guessed);
                self.out.names.push(0);
                self.out.east.push(off.0);
                self.out.north.push(off.1);
                let number = self.known.len() as u32;
                self.known.insert(pos, number);
                i64::from(number)
            }
        };
        self.last = (pos, number);
    }
}

impl Points {
    pub(crate) fn pull(self) -> PullPoints {
        PullPoints {
            counts: Pull::new("rings", self.counts),
            names: Pull::new("vertices", self.names),
            east: Pull::new("vertices' eastings", self.east),
            north: Pull::new("vertices' northings", self.north),
            known: Vec::new(),
            last: (GridPos(0, 0), 0),
        }
    }
}

/// Takes rings and lines off [`Points`].
pub(crate) struct PullPoints {
    counts: Pull<u32>,
    names: Pull<u32>,
    east: Pull<i32>,
    north: Pull<i32>,
    known: Vec<GridPos>,
    last: (GridPos, i64),
}

impl PullPoints {
    pub(crate) fn point(&mut self) -> Result<GridPos, Malformed> {
        self.vertex(self.last.0)
    }

    pub(crate) fn line(&mut self) -> Result<GridRing, Malformed> {
        let count = self.counts.take()? as usize;
        if count > self.names.left() {
            return Err(Malformed::Reason("a ring has more vertices than are left"));
        }
        let mut line = Vec::with_capacity(count);
        for _ in 0..count {
            let guessed = guess(&line, self.last.0);
            line.push(self.vertex(guessed)?);
        }
        Ok(line)
    }

    pub(crate) fn polygon(&mut self) -> Result<GridPolygon, Malformed> {
        let holes = self.counts.take()? as usize;
        if holes > self.counts.left() {
            return Err(Malformed::Reason("a polygon has more holes than rings are left"));
        }
        let outer = self.line()?;
        Ok(GridPolygon { outer, holes: (0..holes).map(|_| self.line()).collect::<Result<_, _>>()? })
    }

    pub(crate) fn finish(&self) -> Result<(), Malformed> {
        self.counts.finish()?;
        self.names.finish()?;
        self.east.finish()?;
        self.north.finish()
    }

    fn vertex(&mut self, guessed: GridPos) -> Result<GridPos, Malformed> {
        let (pos, number) = match self.names.take()?.checked_sub(1) {
            None => {
                let pos = add(guessed, GridPos(self.east.take()?, self.north.take()?));
                self.known.push(pos);
                (pos, self.known.len() as i64 - 1)
            }
            Some(folded) => {
                let step = i64::from(folded >> 1) ^ -i64::from(folded & 1);
                let number = self.last.1.wrapping_add(step);
                let pos = usize::try_from(number).ok().and_then(|n| self.known.get(n));
                (*pos.ok_or(Malformed::Reason("a vertex is named that was never told"))?, number)
            }
        };
        self.last = (pos, number);
        Ok(pos)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn any_ring() -> impl Strategy<Value = GridRing> {
        let near = (-40..40_i32, -40..40_i32).prop_map(|(x, y)| GridPos(x, y));
        let far = (any::<i32>(), any::<i32>()).prop_map(|(x, y)| GridPos(x, y));
        prop::collection::vec(prop_oneof![4 => near, 1 => far], 0..9)
    }

    proptest! {
        #[test]
        fn rings_survive(polygons in prop::collection::vec((any_ring(), prop::collection::vec(any_ring(), 0..3)), 0..8)) {
            let polygons: Vec<_> = polygons.into_iter().map(|(outer, holes)| GridPolygon { outer, holes }).collect();
            let mut writer = PointWriter::default();
            polygons.iter().for_each(|polygon| writer.polygon(polygon));
            let mut pull = writer.finish().pull();
            for polygon in &polygons {
                prop_assert_eq!(&pull.polygon(), &Ok(polygon.clone()));
            }
            prop_assert_eq!(pull.finish(), Ok(()));
        }
    }

    #[test]
    fn the_neighbours_edge_costs_no_coordinates() {
        let mut writer = PointWriter::default();
        writer.line(&[GridPos(0, 0), GridPos(9, 0), GridPos(9, 9), GridPos(0, 9)]);
        assert_eq!(writer.out.east, [0, 9, 0, 0], "the fourth corner of a rectangle is guessed");
        writer.line(&[GridPos(9, 9), GridPos(9, 0), GridPos(20, 0)]);
        assert_eq!(writer.out.east.len(), 5, "one new vertex");
        assert_eq!(writer.out.names, [0, 0, 0, 0, 2, 2, 0], "each known one is the one before the last");
    }

    #[test]
    fn a_vertex_never_told_is_an_error() {
        for name in [1, 2, 3, u32::MAX] {
            let points = Points { counts: vec![1], names: vec![name], ..Points::default() };
            assert_eq!(points.pull().line(), Err(Malformed::Reason("a vertex is named that was never told")), "{name}");
        }
        let points = Points { counts: vec![u32::MAX], ..Points::default() };
        assert!(points.pull().line().is_err());
        let points = Points { counts: vec![u32::MAX, 0], ..Points::default() };
        assert!(points.pull().polygon().is_err());
    }
}
