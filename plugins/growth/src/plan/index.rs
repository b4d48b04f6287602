//! What lies at a position of the ground, and what lies near: shapes drawn into square cells.
//!
//! A cell lists the shapes that its ground touches, each with whether it covers the whole cell, so that most questions are
//! answered without looking at an outline. Shapes of a city are about as large as one another and lie close together, which
//! suits cells better than trees of boxes: an R-tree (`rstar`) in their place makes looking out of all walls three times as
//! slow.

use core::borrow::Borrow;

use rayon::prelude::*;
use veduta_city::{GridPolygon, GridPos};

use veduta_city::bounds::{Bounds, do_meet, grown, joined};

/// Least side of a cell as a power of two of grid steps: 8 m.
const LEAST_SHIFT: u32 = 13;
/// Cells there may be for each shape, …
const CELLS_A_SHAPE: i64 = 64;
/// … but always so many.
const LEAST_CELLS: i64 = 1 << 14;

/// Things whose notes are made together, one after the other.
const AT_ONCE: usize = 256;

/// Square cells over a part of the ground, and what was noted in each.
#[derive(Debug, Default)]
pub(super) struct Cells {
    low: GridPos,
    shift: u32,
    columns: i64,
    rows: i64,
    /// Where each cell's notes begin, and where the last one's end.
    starts: Vec<u32>,
    notes: Vec<u32>,
}

/// Notes for cells that are being gathered.
pub(super) struct Gathering {
    cells: Cells,
    /// Cell and note.
    noted: Vec<(u32, u32)>,
}

impl Gathering {
    /// For so many shapes within bounds.
    pub fn new((low, high): (GridPos, GridPos), shapes: usize) -> Self {
        let extent = |from: i32, to: i32, shift: u32| ((i64::from(to) - i64::from(from)) >> shift) + 1;
        let most = (CELLS_A_SHAPE * shapes as i64).max(LEAST_CELLS);
        let count = |shift: u32| (extent(low.0, high.0, shift), extent(low.1, high.1, shift));
        let shift = (LEAST_SHIFT..32).find(|&shift| count(shift).0 * count(shift).1 <= most).unwrap_or(31);
        Self::of_side(low, shift, count(shift))
    }

    /// For cells of a given side (a power of two of grid steps), columns and rows.
    pub fn of_side(low: GridPos, shift: u32, (columns, rows): (i64, i64)) -> Self {
        Self { cells: Cells { low, shift, columns, rows, ..Cells::default() }, noted: Vec::new() }
    }

    /// Notes something in all cells that an edge touches.
    pub fn edge(&mut self, a: GridPos, b: GridPos, note: u32) {
        let (low, high) = if a.1 <= b.1 { (a, b) } else { (b, a) };
        let [first, last] = [low, high].map(|p| self.cells.row(p.1));
        let side = |row: i64| i64::from(self.cells.low.1) + (row << self.cells.shift);
        // Where the edge comes into a row and where it leaves it, as the whole steps about both. What lies beyond the first and the last row
        // belongs to them.
        let ends = [low, high].map(|p| (i64::from(p.0), i64::from(p.0)));
        let mut from = ends[0];
        for row in first..=last {
            let to = if row == last { ends[1] } else { across(low, high, side(row + 1)) };
            let columns = [from.0.min(to.0), from.1.max(to.1)].map(|x| self.cells.column(x));
            for column in columns[0]..=columns[1] {
                self.noted.push(((row * self.cells.columns + column) as u32, note));
            }
            from = to;
        }
    }

    /// Notes something for each of many things; the notes are in their order.
    pub fn each<S: Sync>(mut self, things: &[S], note: impl Fn(&mut Self, &S, usize) + Sync) -> Self {
        let of_part = |(part, things): (usize, &[S])| {
            let mut own = Self { cells: self.cells.frame(), noted: Vec::new() };
            things.iter().enumerate().for_each(|(i, thing)| note(&mut own, thing, part * AT_ONCE + i));
            own.noted
        };
        let parts: Vec<Vec<(u32, u32)>> = things.par_chunks(AT_ONCE).enumerate().map(of_part).collect();
        self.noted.reserve(parts.iter().map(Vec::len).sum());
        parts.into_iter().for_each(|part| self.noted.extend(part));
        self
    }

    /// Sorts the notes by cell; within one they are in the order in which they were made, none twice.
    pub fn sorted(self) -> Cells {
        let Self { mut cells, noted } = self;
        let mut starts = vec![0_u32; (cells.columns * cells.rows) as usize + 1];
        noted.iter().for_each(|&(cell, _)| starts[cell as usize + 1] += 1);
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut notes = vec![0; noted.len()];
        for (cell, note) in noted {
            let at = &mut next[cell as usize];
            notes[*at as usize] = note;
            *at += 1;
        }
        (cells.starts, cells.notes) = (starts, notes);
        cells
    }
}

/// Where an edge that goes up is at a height: the whole steps about it.
fn across(low: GridPos, high: GridPos, y: i64) -> (i64, i64) {
    let (rise, run) = (i64::from(high.1) - i64::from(low.1), i64::from(high.0) - i64::from(low.0));
    if rise == 0 {
        let (a, b) = (i64::from(low.0), i64::from(high.0));
        return (a.min(b), a.max(b));
    }
    let up = y - i64::from(low.1);
    // Division in 128 bits takes ten times as long, and nothing but edges across half the plane needs it.
    let (whole, is_between) = match run.checked_mul(up) {
        Some(way) => (way.div_euclid(rise), way.rem_euclid(rise) > 0),
        None => {
            let (way, rise) = (i128::from(run) * i128::from(up), i128::from(rise));
            (way.div_euclid(rise) as i64, way.rem_euclid(rise) > 0)
        }
    };
    let least = i64::from(low.0) + whole;
    (least, least + i64::from(is_between))
}

impl Cells {
    /// The same cells without a note.
    const fn frame(&self) -> Self {
        Self { low: self.low, shift: self.shift, columns: self.columns, rows: self.rows, starts: Vec::new(), notes: Vec::new() }
    }

    fn row(&self, y: i32) -> i64 {
        ((i64::from(y) - i64::from(self.low.1)) >> self.shift).clamp(0, self.rows - 1)
    }

    fn column(&self, x: i64) -> i64 {
        ((x - i64::from(self.low.0)) >> self.shift).clamp(0, self.columns - 1)
    }

    /// What was noted in a cell, counted row by row.
    pub fn of_cell(&self, cell: i64) -> &[u32] {
        let at = |i: usize| self.starts.get(i).map_or(0, |&start| start as usize);
        &self.notes[at(cell as usize)..at(cell as usize + 1)]
    }

    /// The cell of a position, counted row by row; `None` outside of all cells.
    fn cell(&self, pos: GridPos) -> Option<i64> {
        let (x, y) = (i64::from(pos.0) - i64::from(self.low.0), i64::from(pos.1) - i64::from(self.low.1));
        let (column, row) = (x >> self.shift, y >> self.shift);
        let is_there = column >= 0 && row >= 0 && column < self.columns && row < self.rows;
        is_there.then_some(row * self.columns + column)
    }

    /// What was noted in the cell of a position; nothing outside of all cells.
    pub fn at(&self, pos: GridPos) -> &[u32] {
        self.cell(pos).map_or(&[], |cell| self.of_cell(cell))
    }

    /// What was noted in the cells that a box touches, as `key` has it: ascending, each once.
    fn within(&self, (low, high): Bounds, key: impl Fn(u32) -> Option<u32>, found: &mut Vec<u32>) {
        found.clear();
        if self.starts.is_empty() {
            return;
        }
        let columns = self.column(i64::from(low.0))..=self.column(i64::from(high.0));
        for row in self.row(low.1)..=self.row(high.1) {
            let [from, to] =
                [*columns.start(), *columns.end() + 1].map(|column| self.starts[(row * self.columns + column) as usize]);
            found.extend(self.notes[from as usize..to as usize].iter().filter_map(|&note| key(note)));
        }
        found.sort_unstable();
        found.dedup();
    }
}

/// Polygons, or references to some, that can be asked what lies at a position.
pub(super) struct Index<T, P = GridPolygon> {
    /// Of each polygon twice its number, and one more where it covers the whole cell.
    cells: Cells,
    things: Vec<Thing<T, P>>,
}

/// Some of an index's cells.
pub(super) struct CellSet {
    frame: Cells,
    holds: Vec<bool>,
}

impl CellSet {
    /// Whether a position lies in one of them.
    pub fn has(&self, pos: GridPos) -> bool {
        self.frame.cell(pos).is_some_and(|cell| self.holds[cell as usize])
    }
}

/// A polygon with something attached.
struct Thing<T, P> {
    polygon: P,
    bounds: Bounds,
    of: T,
}

impl<T, P: Borrow<GridPolygon>> Thing<T, P> {
    fn new((polygon, of): (P, T)) -> Self {
        Self { bounds: polygon.borrow().bounds().unwrap_or(NOWHERE), polygon, of }
    }
}

impl<T: Sync, P: Borrow<GridPolygon> + Sync> Index<T, P> {
    /// An index over polygons with something attached.
    pub fn new(things: Vec<(P, T)>) -> Self {
        let things: Vec<Thing<T, P>> = things.into_iter().map(Thing::new).collect();
        let all = things.iter().map(|thing| thing.bounds).filter(|&bounds| bounds != NOWHERE);
        let Some(bounds) = all.reduce(joined) else { return Self { cells: Cells::default(), things } };
        let gathering = Gathering::new(bounds, things.len());
        let gathering = gathering.each(&things, |own, thing, i| draw(own, thing.polygon.borrow(), 2 * i as u32));
        Self { cells: gathering.sorted(), things }
    }

    /// An index over the polygons that lie in cells, in their order, with something else attached.
    pub fn over(cells: Cells, things: Vec<(P, T)>) -> Self {
        debug_assert!(cells.notes.iter().all(|&note| (note as usize / 2) < things.len()));
        Self { cells, things: things.into_iter().map(Thing::new).collect() }
    }

    /// Where the polygons are, for another index over them.
    pub fn into_cells(self) -> Cells {
        self.cells
    }

    pub const fn is_empty(&self) -> bool {
        self.things.is_empty()
    }

    /// All that contain a position, in order of insertion.
    pub fn at(&self, pos: GridPos) -> impl Iterator<Item = &T> {
        self.of_kind_at(pos, |_| true)
    }

    /// All of a kind that contain a position, in order of insertion: outlines of others are not looked at.
    pub fn of_kind_at(&self, pos: GridPos, is_of: impl Fn(&T) -> bool) -> impl Iterator<Item = &T> {
        let touching = self.cells.at(pos).iter().map(|note| (&self.things[*note as usize / 2], note % 2 == 1));
        let holds = move |(thing, is_covered): &(&Thing<T, P>, bool)| {
            is_of(&thing.of) && (*is_covered || do_meet((pos, pos), thing.bounds) && thing.polygon.borrow().contains(pos))
        };
        touching.filter(holds).map(|(thing, _)| &thing.of)
    }

    /// The cells that something of a kind touches.
    pub fn cells_of(&self, is_of: impl Fn(&T) -> bool + Sync) -> CellSet {
        let is_of: Vec<bool> = self.things.iter().map(|thing| is_of(&thing.of)).collect();
        let count = (self.cells.columns * self.cells.rows) as usize;
        let holds = |cell: usize| self.cells.of_cell(cell as i64).iter().any(|note| is_of[*note as usize / 2]);
        CellSet { frame: self.cells.frame(), holds: (0..count).into_par_iter().with_min_len(1 << 12).map(holds).collect() }
    }

    /// All whose border may come into a box, in order of insertion. `found`: room for their numbers.
    pub fn bordering<'a>(&'a self, bounds: Bounds, found: &'a mut Vec<u32>) -> impl Iterator<Item = (&'a GridPolygon, &'a T)> {
        self.cells.within(bounds, |note| (note % 2 == 0).then_some(note / 2), found);
        let things = found.iter().map(|&i| &self.things[i as usize]);
        things.filter(move |thing| do_meet(thing.bounds, bounds)).map(|thing| (thing.polygon.borrow(), &thing.of))
    }

    /// All that may come within a distance of the bounds of a polygon, in order of insertion: none of which the bounds do not.
    pub fn near(&self, polygon: &GridPolygon, reach_m: f64) -> Vec<(&GridPolygon, &T)> {
        let Some(bounds) = polygon.bounds() else { return Vec::new() };
        let bounds = grown(bounds, GridPos::steps(reach_m));
        let mut found = Vec::new();
        self.cells.within(bounds, |note| Some(note / 2), &mut found);
        let things = found.into_iter().map(|i| &self.things[i as usize]);
        things.filter(|thing| do_meet(thing.bounds, bounds)).map(|thing| (thing.polygon.borrow(), &thing.of)).collect()
    }
}

/// Bounds of what has none.
const NOWHERE: Bounds = (GridPos(i32::MAX, i32::MAX), GridPos(i32::MIN, i32::MIN));

/// Notes a polygon in the cells that it touches: `note` where its border runs, one more where it covers all.
fn draw(gathering: &mut Gathering, polygon: &GridPolygon, note: u32) {
    let first = gathering.noted.len();
    for (a, b) in polygon.edges() {
        gathering.edge(a, b, note);
    }
    let border = &mut gathering.noted[first..];
    border.sort_unstable();
    let mut kept = 0;
    for i in 0..border.len() {
        if kept == 0 || border[i] != border[kept - 1] {
            border[kept] = border[i];
            kept += 1;
        }
    }
    gathering.noted.truncate(first + kept);
    // Between two cells of a row that the border touches, all cells are inside, or none.
    let (columns, shift, low) = (gathering.cells.columns, gathering.cells.shift, gathering.cells.low);
    for i in first + 1..first + kept {
        let [before, after] = [gathering.noted[i - 1].0, gathering.noted[i].0];
        let (row, column) = (i64::from(before) / columns, i64::from(before) % columns + 1);
        if after == before + 1 || i64::from(after) / columns != row {
            continue;
        }
        let corner = |base: i32, cell: i64| (i64::from(base) + (cell << shift)) as i32;
        if polygon.contains(GridPos(corner(low.0, column), corner(low.1, row))) {
            gathering.noted.extend((before + 1..after).map(|cell| (cell, note + 1)));
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn ring(corners: &[(i32, i32)], at: (i32, i32)) -> Vec<GridPos> {
        corners.iter().map(|&(x, y)| GridPos(at.0 + x * 97, at.1 + y * 97)).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, cases: 128, ..ProptestConfig::default() })]

        #[test]
        fn what_lies_at_a_position_is_what_contains_it(
            shapes in proptest::collection::vec(
                (proptest::collection::vec((-300..300_i32, -300..300_i32), 1..9), (-200_000..200_000_i32, -200_000..200_000_i32)), 0..20),
            asked in proptest::collection::vec((-260_000..260_000_i32, -260_000..260_000_i32), 60),
        ) {
            // Rings as they come, which cross themselves; also points and lines.
            let things: Vec<_> = shapes.iter().enumerate().map(|(i, (corners, at))| (GridPolygon::simple(ring(corners, *at)), i)).collect();
            let index = Index::new(things.clone());
            let corners = things.iter().flat_map(|(polygon, _)| polygon.outer.clone());
            for pos in asked.into_iter().map(|(x, y)| GridPos(x, y)).chain(corners) {
                let found: Vec<usize> = index.at(pos).copied().collect();
                let want: Vec<usize> = things.iter().filter(|(polygon, _)| polygon.contains(pos)).map(|(_, i)| *i).collect();
                prop_assert_eq!(found, want, "{:?}", pos);
            }
        }

        #[test]
        fn nothing_that_comes_near_is_missed(
            quads in proptest::collection::vec((-90..90_i32, -90..90_i32, 1..30_i32, 1..30_i32), 0..30),
            (x, y, w, h, reach) in (-90..90_i32, -90..90_i32, 1..30_i32, 1..30_i32, 0..20_i32),
        ) {
            let quad = |x: i32, y: i32, w: i32, h: i32| {
                GridPolygon::simple([(x, y), (x + w, y), (x + w, y + h), (x, y + h)].map(|(x, y)| GridPos(x * 1024, y * 1024)).to_vec())
            };
            let things: Vec<_> = quads.iter().enumerate().map(|(i, &(x, y, w, h))| (quad(x, y, w, h), i)).collect();
            let index = Index::new(things);
            let found: Vec<usize> = index.near(&quad(x, y, w, h), f64::from(reach)).into_iter().map(|(_, i)| *i).collect();
            // Bounds of rectangles are the rectangles.
            let is_near = |&(a, b, c, d): &(i32, i32, i32, i32)| {
                a <= x + w + reach && x - reach <= a + c && b <= y + h + reach && y - reach <= b + d
            };
            let want: Vec<usize> = quads.iter().enumerate().filter(|(_, quad)| is_near(quad)).map(|(i, _)| i).collect();
            prop_assert_eq!(found, want);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, cases: 128, ..ProptestConfig::default() })]

        #[test]
        fn no_border_in_a_box_is_missed(
            shapes in proptest::collection::vec(
                (proptest::collection::vec((-900..900_i32, -900..900_i32), 1..9), (-200_000..200_000_i32, -200_000..200_000_i32)), 0..20),
            (x, y, w, h) in (-260_000..260_000_i32, -260_000..260_000_i32, 0..60_000_i32, 0..60_000_i32),
        ) {
            let things: Vec<_> = shapes.iter().enumerate().map(|(i, (corners, at))| (GridPolygon::simple(ring(corners, *at)), i)).collect();
            let index = Index::new(things.clone());
            let bounds = (GridPos(x, y), GridPos(x + w, y + h));
            let mut room = Vec::new();
            let found: Vec<usize> = index.bordering(bounds, &mut room).map(|(_, i)| *i).collect();
            prop_assert!(found.is_sorted());
            for (polygon, i) in &things {
                let comes_in = polygon.edges().any(|(a, b)| {
                    let place = |k: i64, from: i32, to: i32| (i64::from(from) + (i64::from(to) - i64::from(from)) * k / 64) as i32;
                    (0..=64).map(|k| GridPos(place(k, a.0, b.0), place(k, a.1, b.1))).any(|p| do_meet((p, p), bounds))
                });
                prop_assert!(!comes_in || found.contains(i), "{i} is missed");
            }
        }
    }

    #[test]
    fn a_large_shape_is_known_without_its_outline() {
        let square = |side: i32| GridPolygon::simple(ring(&[(0, 0), (side, 0), (side, side), (0, side)], (0, 0)));
        let index = Index::new(vec![(square(4000), ())]);
        let is_covered = |pos: GridPos| index.cells.at(pos).iter().map(|note| note % 2 == 1).collect::<Vec<_>>();
        assert_eq!((is_covered(GridPos(200_000, 200_000)), is_covered(GridPos(5, 200_000))), (vec![true], vec![false]));
        assert_eq!(index.at(GridPos(-1, 200_000)).count() + index.at(GridPos(i32::MAX, i32::MIN)).count(), 0);
    }
}
