//! Vertices: each told once, then named.
//!
//! Houses in a row share corners with each other and with the ground they stand on, and walk along the shared edge in the
//! opposite direction, so most names are "the one that came before this one there". A new vertex is told as its difference from a
//! guess: the vertex before; from the third vertex of a ring on a right angle or straight on; from the fourth a parallelogram.

use std::collections::HashMap;

use serde::{Deserialize, Serialize};
use veduta_city::{GridPolygon, GridPos, GridRing};

use super::{Malformed, columns::Pull};

/// Columns of rings and lines.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Points {
    /// For a polygon: number of holes, then of vertices of each ring; for a line: number of vertices.
    counts: Vec<u32>,
    /// 0: a new vertex, by its first guess; 1: by its second; 2: the one that came before the last one in the line that it was last part
    /// of, 3: in the line before that; 4: the one after it; else five more than the zig-zagged step from the last one's number.
    names: Vec<u32>,
    /// How each new vertex lies to its guess.
    off: Vec<(i32, i32)>,
}

const fn add(a: GridPos, b: GridPos) -> GridPos {
    GridPos(a.0.wrapping_add(b.0), a.1.wrapping_add(b.1))
}

const fn sub(a: GridPos, b: GridPos) -> GridPos {
    GridPos(a.0.wrapping_sub(b.0), a.1.wrapping_sub(b.1))
}

/// Where the next vertex of a ring is guessed to lie, by those already told.
#[derive(Debug, Clone, Copy)]
struct Guess {
    from: GridPos,
    /// The way there.
    across: GridPos,
    /// How far away.
    off: GridPos,
}

impl Guess {
    /// At a right angle to the last edge, as far as closes a parallelogram; and straight on.
    fn of(ring: &[GridPos], last: GridPos) -> [Self; 2] {
        let none = GridPos(0, 0);
        let across = |b: GridPos, c: GridPos| {
            let edge = sub(c, b);
            GridPos(edge.1.wrapping_neg(), edge.0)
        };
        match *ring {
            [.., a, b, c] => {
                [Self { from: c, across: across(b, c), off: sub(a, b) }, Self { from: c, across: sub(c, b), off: none }]
            }
            [a, b] => [across(a, b), sub(b, a)].map(|across| Self { from: b, across, off: none }),
            _ => [Self { from: last, across: none, off: none }; 2],
        }
    }

    /// Whether the right angle leads north or south rather than east or west.
    fn is_upright(self) -> bool {
        self.across.1.unsigned_abs() > self.across.0.unsigned_abs()
    }

    /// How far aside the right angle leads for so many steps in its main direction.
    fn aside(self, steps: i32) -> i32 {
        let (main, aside) = if self.is_upright() { (self.across.1, self.across.0) } else { (self.across.0, self.across.1) };
        let product = i64::from(steps) * i64::from(aside);
        match i64::from(main) {
            0 => 0,
            main => ((2 * product + main.abs()).div_euclid(2 * main.abs()) * main.signum()) as i32,
        }
    }

    /// How a vertex is told: steps in the main direction beyond those guessed, and beside the right angle.
    fn tell(self, pos: GridPos) -> (i32, i32) {
        let (off, turn) = (sub(pos, self.from), |p: GridPos| if self.is_upright() { (p.1, p.0) } else { (p.0, p.1) });
        let ((main, aside), guessed) = (turn(off), turn(self.off).0);
        (main.wrapping_sub(guessed), aside.wrapping_sub(self.aside(main)))
    }

    fn find(self, (main, aside): (i32, i32)) -> GridPos {
        let main = main.wrapping_add(if self.is_upright() { self.off.1 } else { self.off.0 });
        let aside = aside.wrapping_add(self.aside(main));
        add(self.from, if self.is_upright() { GridPos(aside, main) } else { GridPos(main, aside) })
    }
}

/// The vertices told so far, and between which others each stood.
#[derive(Default)]
struct Known {
    vertices: Vec<GridPos>,
    /// Of each, in the lines that it was last and last but one part of: which came before it, and which after.
    beside: Vec<[Option<u32>; 3]>,
    /// The last one told.
    last: Option<u32>,
}

/// The first names, of new vertices, and of those beside the last.
const FRESH: u32 = 2;
const BESIDE: u32 = 3;

impl Known {
    fn pos(&self) -> GridPos {
        self.last.and_then(|last| self.vertices.get(last as usize)).copied().unwrap_or(GridPos(0, 0))
    }

    fn add(&mut self, pos: GridPos) -> u32 {
        self.vertices.push(pos);
        self.beside.push([None; 3]);
        self.vertices.len() as u32 - 1
    }

    /// Those that may follow the last one, likeliest first.
    fn followers(&self) -> [Option<u32>; BESIDE as usize] {
        self.last.and_then(|last| self.beside.get(last as usize)).copied().unwrap_or_default()
    }

    fn name(&self, number: u32) -> u32 {
        if let Some(n) = self.followers().iter().position(|&follower| follower == Some(number)) {
            return FRESH + n as u32;
        }
        let step = i64::from(number) - i64::from(self.last.unwrap_or_default());
        ((step << 1) ^ (step >> 63)) as u32 + FRESH + BESIDE
    }

    fn named(&self, name: u32) -> Option<u32> {
        if let Some(&follower) = self.followers().get(name.checked_sub(FRESH)? as usize) {
            return follower;
        }
        let folded = name - FRESH - BESIDE;
        let step = i64::from(folded >> 1) ^ -i64::from(folded & 1);
        u32::try_from(i64::from(self.last.unwrap_or_default()) + step).ok()
    }

    /// A line has been told.
    fn close(&mut self, line: &[u32]) {
        for (&a, &b) in line.iter().zip(line.iter().cycle().skip(1)) {
            self.beside[a as usize][2] = Some(b);
            let [before, earlier, _] = &mut self.beside[b as usize];
            *earlier = before.replace(a);
        }
    }
}

/// Fills [`Points`].
#[derive(Default)]
pub(crate) struct PointWriter {
    out: Points,
    numbers: HashMap<GridPos, u32>,
    known: Known,
}

impl PointWriter {
    /// A vertex by itself.
    pub(crate) fn point(&mut self, pos: GridPos) {
        self.vertex(pos, &[]);
    }

    /// A line or ring.
    pub(crate) fn line(&mut self, line: &[GridPos]) {
        self.out.counts.push(line.len() as u32);
        let numbers: Vec<u32> =
            line.iter().enumerate().map(|(i, &pos)| self.vertex(pos, line.get(..i).unwrap_or_default())).collect();
        self.known.close(&numbers);
    }

    /// A polygon.
    pub(crate) fn polygon(&mut self, polygon: &GridPolygon) {
        self.out.counts.push(polygon.holes.len() as u32);
        polygon.rings().for_each(|ring| self.line(ring));
    }

    /// What was told since the last time; what follows may name its vertices.
    pub(crate) fn finish(&mut self) -> Points {
        core::mem::take(&mut self.out)
    }

    /// Vertices of a polygon that whoever reads knows already.
    pub(crate) fn know(&mut self, polygon: &GridPolygon) {
        self.polygon(polygon);
        self.out = Points::default();
    }

    fn vertex(&mut self, pos: GridPos, before: &[GridPos]) -> u32 {
        let number = match self.numbers.get(&pos) {
            Some(&number) => {
                self.out.names.push(self.known.name(number));
                number
            }
            None => {
                let told = Guess::of(before, self.known.pos()).map(|guess| guess.tell(pos));
                let size = |(main, aside): (i32, i32)| main.unsigned_abs().leading_zeros() + aside.unsigned_abs().leading_zeros();
                let n = usize::from(size(told[1]) > size(told[0]) + 2);
                self.out.names.push(n as u32);
                self.out.off.push(told[n]);
                let number = self.known.add(pos);
                self.numbers.insert(pos, number);
                number
            }
        };
        self.known.last = Some(number);
        number
    }
}

impl Points {
    pub(crate) fn pull(self) -> PullPoints {
        PullPoints {
            counts: Pull::new("rings", self.counts),
            names: Pull::new("vertices", self.names),
            off: Pull::new("new vertices", self.off),
            known: Known::default(),
        }
    }
}

/// Takes rings and lines off [`Points`].
pub(crate) struct PullPoints {
    counts: Pull<u32>,
    names: Pull<u32>,
    off: Pull<(i32, i32)>,
    known: Known,
}

impl PullPoints {
    pub(crate) fn point(&mut self) -> Result<GridPos, Malformed> {
        self.vertex(&[]).map(|(pos, _)| pos)
    }

    pub(crate) fn line(&mut self) -> Result<GridRing, Malformed> {
        let count = self.counts.take()? as usize;
        if count > self.names.left() {
            return Err(Malformed::Reason("a ring has more vertices than are left"));
        }
        let (mut line, mut numbers) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for _ in 0..count {
            let (pos, number) = self.vertex(&line)?;
            line.push(pos);
            numbers.push(number);
        }
        self.known.close(&numbers);
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
        self.off.finish()
    }

    /// Goes on with what was told next, of which all before must be used up.
    pub(crate) fn go_on(&mut self, points: Points) -> Result<(), Malformed> {
        self.finish()?;
        let next = points.pull();
        (self.counts, self.names, self.off) = (next.counts, next.names, next.off);
        Ok(())
    }

    /// Vertices of a polygon that are known already.
    pub(crate) fn know(&mut self, polygon: &GridPolygon) {
        let mut writer = PointWriter::default();
        writer.know(polygon);
        self.known = writer.known;
    }

    fn vertex(&mut self, before: &[GridPos]) -> Result<(GridPos, u32), Malformed> {
        let number = match self.names.take()? {
            fresh if fresh < FRESH => {
                let guess = Guess::of(before, self.known.pos())[fresh as usize];
                self.known.add(guess.find(self.off.take()?))
            }
            name => {
                let named = self.known.named(name).filter(|&number| (number as usize) < self.known.vertices.len());
                named.ok_or(Malformed::Reason("a vertex is named that was never told"))?
            }
        };
        self.known.last = Some(number);
        Ok((self.known.pos(), number))
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
        assert_eq!(
            writer.out.off,
            [(0, 0), (9, 0), (9, 0), (0, 0)],
            "right angles, and the fourth corner of a rectangle, are guessed"
        );
        writer.line(&[GridPos(9, 9), GridPos(9, 0), GridPos(20, 0)]);
        assert_eq!(writer.out.off.len(), 5, "one new vertex");
        assert_eq!(writer.out.names, [0, 0, 0, 0, FRESH, FRESH, 0], "those that came before the last");
        writer.line(&[GridPos(20, 0), GridPos(30, 0)]);
        assert_eq!((writer.out.names[8], writer.out.off[5]), (0, (10, 0)), "a line begins anywhere");
        writer.line(&[GridPos(0, 50), GridPos(700, 150), GridPos(1400, 250)]);
        assert_eq!((writer.out.names[11], writer.out.off[8]), (1, (700, 0)), "straight on");
    }

    #[test]
    fn a_vertex_never_told_is_an_error() {
        for name in [2, 3, 4, 5, 6, u32::MAX] {
            let points = Points { counts: vec![1], names: vec![name], ..Points::default() };
            assert_eq!(points.pull().line(), Err(Malformed::Reason("a vertex is named that was never told")), "{name}");
        }
        let points = Points { counts: vec![u32::MAX], ..Points::default() };
        assert!(points.pull().line().is_err());
        let points = Points { counts: vec![u32::MAX, 0], ..Points::default() };
        assert!(points.pull().polygon().is_err());
    }
}
