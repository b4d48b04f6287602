//! Rings and lines: each vertex told once, then named.
//!
//! Houses in a row share corners with each other and with the ground they stand on, and walk along the shared edge in the
//! opposite direction, so most names are "the one that came before this one there", and most of the others are of vertices near by. A new
//! vertex is told as its difference from a guess: the vertex before; from the third vertex of a ring on a right angle or straight on; from
//! the fourth a parallelogram; part of the way along an edge that is known. Telling and finding are one function, so that they cannot
//! disagree.

use std::collections::HashMap;

use veduta_city::{GridPolygon, GridPos, GridRing, MAP_STEP, PLAN_STEP};

use super::models::{Models, Node};
use super::range::Bits;

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
    /// Those for the next vertex of a ring: at a right angle to the last edge, as far as closes a parallelogram; straight on; and along
    /// the edges that lead from the last vertex to those beside it.
    fn of(ring: &[GridPos], last: GridPos, beside: [Option<GridPos>; 3]) -> [Self; GUESSES] {
        let none = GridPos(0, 0);
        let across = |b: GridPos, c: GridPos| {
            let edge = sub(c, b);
            GridPos(edge.1.wrapping_neg(), edge.0)
        };
        let [right, straight] = match *ring {
            [.., a, b, c] => {
                [Self { from: c, across: across(b, c), off: sub(a, b) }, Self { from: c, across: sub(c, b), off: none }]
            }
            [a, b] => [across(a, b), sub(b, a)].map(|across| Self { from: b, across, off: none }),
            _ => [Self { from: last, across: none, off: none }; 2],
        };
        let [a, b, c] = beside.map(|beside| Self { from: last, across: beside.map_or(none, |to| sub(to, last)), off: none });
        [right, straight, a, b, c]
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

/// How a line goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step {
    /// It has no more vertices.
    End,
    /// The one that came before the last one in the line that it was last part of, in the line before that; the one after it.
    Beside(u8),
    /// A new one, by a guess.
    New(u8, (i32, i32)),
    /// The one of those told lately to which so many lie nearer.
    Near(u32),
    /// Any, by its number.
    Far(u32),
}

/// Symbols of steps; and in place of the step before the first.
const END: u32 = 0;
const BESIDE: u32 = 1;
const NEW: u32 = 4;
const NEAR: u32 = 5;
const FAR: u32 = 6;
const START: u32 = 7;

impl Step {
    const fn symbol(self) -> u32 {
        match self {
            Self::End => END,
            Self::Beside(n) => BESIDE + n as u32,
            Self::New(..) => NEW,
            Self::Near(_) => NEAR,
            Self::Far(_) => FAR,
        }
    }
}

/// Lines to be told after a structure, each in a section of its like.
#[derive(Debug, Default)]
pub(crate) struct Outlines(Vec<(u8, Outline)>);

/// Steps of the grid that positions are told in: as many as all of them are multiples of.
const UNITS: [i32; 3] = [MAP_STEP, PLAN_STEP, 1];

#[derive(Debug)]
enum Outline {
    /// Whoever reads knows it already.
    Known(GridPolygon),
    Point(GridPos),
    Line(GridRing),
    Polygon(GridPolygon),
}

impl Outlines {
    /// A polygon that whoever reads knows already.
    pub(crate) fn know(&mut self, polygon: &GridPolygon) {
        self.0.push((0, Outline::Known(polygon.clone())));
    }

    pub(crate) fn point(&mut self, section: u8, pos: GridPos) {
        self.0.push((section, Outline::Point(pos)));
    }

    pub(crate) fn line(&mut self, section: u8, line: &[GridPos]) {
        self.0.push((section, Outline::Line(line.to_vec())));
    }

    pub(crate) fn polygon(&mut self, section: u8, polygon: &GridPolygon) {
        self.0.push((section, Outline::Polygon(polygon.clone())));
    }

    fn positions(&self) -> impl Iterator<Item = GridPos> {
        self.0.iter().flat_map(|(_, outline)| {
            let (point, line, polygon) = match outline {
                Outline::Point(pos) => (Some(*pos), None, None),
                Outline::Line(line) => (None, Some(line), None),
                Outline::Known(polygon) | Outline::Polygon(polygon) => (None, None, Some(polygon)),
            };
            let rings = polygon.into_iter().flat_map(GridPolygon::rings).chain(line);
            point.into_iter().chain(rings.flatten().copied())
        })
    }

    /// Puts all into bits; how many values they are.
    pub(super) fn tell<B: Bits>(&self, bits: &mut B, models: &mut Models<B::Slot>) -> u64 {
        let fits = |unit: &i32| self.positions().all(|pos| pos.0 % unit == 0 && pos.1 % unit == 0);
        let unit = UNITS.iter().position(fits).unwrap_or(UNITS.len() - 1);
        let mut vertices = Vertices::new(bits, models, unit as u32);
        let mut values = 1;
        for (section, outline) in &self.0 {
            let section = section_of(models, *section);
            let mut line = |bits: &mut B, models: &mut Models<B::Slot>, line: &[GridPos], is_point| {
                values += 1 + line.len() as u64;
                vertices.line(bits, models, section, Some(line), is_point, u64::MAX);
            };
            match outline {
                Outline::Known(polygon) => vertices.know(polygon),
                Outline::Point(pos) => line(bits, models, &[*pos], true),
                Outline::Line(told) => line(bits, models, told, false),
                Outline::Polygon(polygon) => {
                    Vertices::holes(bits, models, section, polygon.holes.len() as u64);
                    polygon.rings().for_each(|ring| line(bits, models, ring, false));
                    values += 1;
                }
            }
        }
        values
    }
}

/// Columns of outlines stand beside those of the structure.
const BESIDE_FIELDS: usize = 40;

/// The columns of a section, of which the first tells the unit.
pub(super) fn section_of<S: Clone + Default>(models: &mut Models<S>, section: u8) -> Node {
    models.child(0, BESIDE_FIELDS + 1 + usize::from(section))
}

/// Of a vertex, in the order in which they are told; the greatest: of none. (An `Option` would take twice the memory.)
type Number = u32;
const NONE: Number = Number::MAX;

/// The vertices told so far, and between which others each stood.
#[derive(Debug, Clone)]
pub(crate) struct Vertices {
    vertices: Vec<GridPos>,
    /// Of each, in the lines that it was last and last but one part of: which came before it, and which after.
    beside: Vec<[Number; 3]>,
    /// Their numbers.
    numbers: HashMap<GridPos, Number>,
    /// Steps of the grid that positions are told in.
    unit: i32,
    /// The last one told.
    last: Number,
}

/// So many vertices are told lately: looking for the near ones costs time.
const LATELY: u32 = 512;

/// Columns of a section: how many holes; how lines go on after so many vertices, and points; who is near, and who far; which guess, and how
/// far off it is.
const HOLES: usize = 0;
const STEPS: usize = 1;
const RANKS: usize = STEPS + 6;
const NUMBERS: usize = RANKS + 1;
const GUESS: usize = NUMBERS + 1;
const OFF: usize = GUESS + 1;
/// How many guesses there are.
const GUESSES: usize = 5;

impl Default for Vertices {
    fn default() -> Self {
        Self { vertices: Vec::new(), beside: Vec::new(), numbers: HashMap::new(), unit: 1, last: NONE }
    }
}

impl Vertices {
    /// None yet; tells or finds in which unit they will be told.
    pub(super) fn new<B: Bits>(bits: &mut B, models: &mut Models<B::Slot>, unit: u32) -> Self {
        let node = models.child(0, BESIDE_FIELDS);
        let unit = models.symbol(bits, node, 0, unit);
        Self { unit: UNITS.get(unit as usize).copied().unwrap_or(1), ..Self::default() }
    }

    /// A position in steps of the grid by one in our unit, and back.
    fn out(&self, pos: GridPos) -> GridPos {
        GridPos(pos.0.wrapping_mul(self.unit), pos.1.wrapping_mul(self.unit))
    }

    fn within(&self, pos: GridPos) -> GridPos {
        GridPos(pos.0.wrapping_div(self.unit), pos.1.wrapping_div(self.unit))
    }

    /// Where a vertex lies, if it was told.
    fn told(&self, number: Number) -> Option<GridPos> {
        self.vertices.get(number as usize).copied()
    }

    /// Where the last one lies; to begin with, the origin.
    fn last_pos(&self) -> GridPos {
        self.told(self.last).unwrap_or(GridPos(0, 0))
    }

    fn add(&mut self, pos: GridPos, beside: [Number; 3]) -> Number {
        let number = self.vertices.len() as Number;
        self.vertices.push(pos);
        self.beside.push(beside);
        self.numbers.insert(pos, number);
        number
    }

    /// Those that may follow the last one, likeliest first.
    fn followers(&self) -> [Number; 3] {
        self.beside.get(self.last as usize).copied().unwrap_or([NONE; 3])
    }

    /// A line has been told.
    fn close(&mut self, line: &[Number]) {
        for (&a, &b) in line.iter().zip(line.iter().cycle().skip(1)) {
            self.beside[a as usize][2] = b;
            let [before, earlier, _] = &mut self.beside[b as usize];
            *earlier = core::mem::replace(before, a);
        }
    }

    /// A polygon that whoever reads knows already.
    pub(crate) fn know(&mut self, polygon: &GridPolygon) {
        for ring in polygon.rings() {
            let numbers: Vec<Number> = ring.iter().map(|&pos| self.number(self.within(pos))).collect();
            self.close(&numbers);
        }
        self.last = polygon.outer.first().map_or(NONE, |&pos| self.number(self.within(pos)));
    }

    fn number(&mut self, pos: GridPos) -> Number {
        let number = self.numbers.get(&pos).copied();
        number.unwrap_or_else(|| self.add(pos, [NONE; 3]))
    }

    fn guesses(&self, before: &[GridPos]) -> [Guess; GUESSES] {
        Guess::of(before, self.last_pos(), self.followers().map(|follower| self.told(follower)))
    }

    /// How the line goes on to a vertex.
    fn step_to(&self, pos: GridPos, before: &[GridPos]) -> Step {
        let Some(&number) = self.numbers.get(&pos) else {
            let told = self.guesses(before).map(|guess| guess.tell(pos));
            let digits = |n: i32| i32::BITS - n.unsigned_abs().leading_zeros();
            // About the bits that it takes: any but the first guess is a surprise, and so is what lies off its line.
            let cost = |&n: &usize| {
                let (main, aside) = (digits(told[n].0), digits(told[n].1));
                main + aside + 2 * aside.min(3) + if n == 0 { 0 } else { 2 }
            };
            let n = (0..GUESSES).min_by_key(cost).unwrap_or_default();
            return Step::New(n as u8, told[n]);
        };
        let beside = self.followers().iter().position(|&follower| follower == number);
        match (beside, self.rank_of(number)) {
            (Some(n), _) => Step::Beside(n as u8),
            (None, Some(rank)) => Step::Near(rank),
            (None, None) => Step::Far(number),
        }
    }

    /// How far from the last vertex another lies, and its number.
    fn distance(&self, number: Number) -> (u64, Number) {
        let (a, b) = (self.last_pos(), self.told(number).unwrap_or(GridPos(0, 0)));
        (u64::from(a.0.abs_diff(b.0)) + u64::from(a.1.abs_diff(b.1)), number)
    }

    /// The vertices told lately but those that have other names, by number.
    fn lately(&self) -> impl Iterator<Item = Number> {
        let (followers, count) = (self.followers(), self.vertices.len() as Number);
        let has_name = move |n: Number| n == self.last || followers.contains(&n);
        (count.saturating_sub(LATELY)..count).filter(move |&n| !has_name(n))
    }

    /// How many vertices told lately lie nearer to the last one.
    fn rank_of(&self, number: Number) -> Option<u32> {
        let key = self.distance(number);
        let is_late = number + LATELY >= self.vertices.len() as Number && number != self.last;
        is_late.then(|| self.lately().filter(|&n| self.distance(n) < key).count() as u32)
    }

    fn ranked(&self, rank: u32) -> Option<Number> {
        let mut all: Vec<(u64, Number)> = self.lately().map(|n| self.distance(n)).collect();
        let rank = rank as usize;
        (rank < all.len()).then(|| all.select_nth_unstable(rank).1.1)
    }

    /// What is known of how a line goes on: the step before, and whether those that came before and after the last vertex elsewhere are
    /// there, or are the line's first.
    fn context(&self, first: Option<Number>, before: u32) -> usize {
        let [before_it, _, after_it] = self.followers().map(|follower| match follower {
            NONE => 0,
            follower if Some(follower) == first => 1,
            _ => 2,
        });
        (before as usize * 3 + before_it) * 3 + after_it
    }

    /// Tells a line, or finds one of at most so many vertices, in a section; `None` if a vertex is named that was never told, or it has
    /// more. A point is a line of one vertex without an end.
    pub(crate) fn line<B: Bits>(
        &mut self,
        bits: &mut B,
        models: &mut Models<B::Slot>,
        section: Node,
        told: Option<&[GridPos]>,
        is_point: bool,
        most: u64,
    ) -> Option<GridRing> {
        let (mut line, mut numbers) = (GridRing::new(), Vec::new());
        let mut symbol = START;
        loop {
            let next = told.and_then(|told| told.get(line.len()));
            let step = next.map_or(Step::End, |&pos| self.step_to(self.within(pos), &line));
            let after = if is_point { 5 } else { line.len().min(4) };
            let node = models.child(section, STEPS + after);
            symbol = models.symbol(bits, node, self.context(numbers.first().copied(), symbol), step.symbol());
            let number = match symbol {
                END => break,
                BESIDE..NEW => self.followers()[(symbol - BESIDE) as usize],
                NEW => self.fresh(bits, models, section, step, &line)?,
                NEAR => self.ranked(Self::name(bits, models, (section, RANKS), step)?)?,
                _ => Self::name(bits, models, (section, NUMBERS), step)?,
            };
            line.push(self.told(number)?);
            numbers.push(number);
            self.last = number;
            if is_point {
                break;
            }
            // Beyond the end of the bytes nothing is told that memory should be taken for.
            if line.len() as u64 > most || bits.is_beyond() {
                return None;
            }
        }
        if !is_point {
            self.close(&numbers);
        }
        Some(line.into_iter().map(|pos| self.out(pos)).collect())
    }

    /// Tells or finds a vertex that is new.
    fn fresh<B: Bits>(
        &mut self,
        bits: &mut B,
        models: &mut Models<B::Slot>,
        section: Node,
        step: Step,
        line: &[GridPos],
    ) -> Option<Number> {
        let (guess, off) = if let Step::New(guess, off) = step { (guess, off) } else { (0, (0, 0)) };
        let node = models.child(section, GUESS);
        let followers = self.followers();
        let beside = (0..3).fold(0, |flags, n| flags | usize::from(followers[n] != NONE) << n);
        let guess = models.symbol(bits, node, line.len().min(3) * 8 + beside, guess.into()) as usize;
        let kind = match (line.len(), guess) {
            (told, 0..2) if told < 2 => told,
            (2, 0..2) => 2 + guess,
            (_, 0..2) => 4 + guess,
            _ => 6,
        };
        models.new_row();
        let [main, aside] = [(0, off.0), (1, off.1)].map(|(n, off)| {
            let node = models.child(section, OFF + 2 * kind + n);
            models.signed(bits, node, off.into()) as i32
        });
        let pos = self.guesses(line).get(guess)?.find((main, aside));
        // On an edge that is known it lies between its ends.
        let between = match guess.checked_sub(2).map(|n| followers[n]) {
            Some(follower) if aside == 0 && follower != NONE => [follower, NONE, self.last],
            _ => [NONE; 3],
        };
        Some(self.add(pos, between))
    }

    /// Tells or finds what a vertex is called.
    fn name<B: Bits>(bits: &mut B, models: &mut Models<B::Slot>, (section, column): (Node, usize), step: Step) -> Option<u32> {
        let told = if let Step::Near(n) | Step::Far(n) = step { n } else { 0 };
        models.new_row();
        let node = models.child(section, column);
        u32::try_from(models.unsigned(bits, node, told.into())).ok()
    }

    /// Tells or finds how many holes a polygon has.
    pub(crate) fn holes<B: Bits>(bits: &mut B, models: &mut Models<B::Slot>, section: Node, told: u64) -> u64 {
        let node = models.child(section, HOLES);
        models.new_row();
        models.unsigned(bits, node, told)
    }
}

#[cfg(test)]
mod tests {
    use proptest::collection::vec;
    use proptest::prelude::*;

    use super::super::{Prior, Unread, press, unpress_with};
    use super::*;
    use crate::StoreError;

    /// Outlines after a number, as bytes; and read back.
    fn stored(outlines: &Outlines) -> Vec<u8> {
        let mut out = Vec::new();
        press(&7_u8, Some(outlines), Prior::None, &mut out);
        out
    }

    fn read<O>(stored: &[u8], make: impl FnOnce(&mut super::super::Source<'_, '_>) -> Result<O, Unread>) -> Result<O, StoreError> {
        unpress_with("lines", stored, Prior::None, 1 << 20, |_: u8, source| make(source))
    }

    fn any_ring(unit: i32) -> impl Strategy<Value = GridRing> {
        let near = (-40..40_i32, -40..40_i32).prop_map(move |(x, y)| GridPos(x * unit, y * unit));
        let far = (any::<i32>(), any::<i32>()).prop_map(move |(x, y)| GridPos(x / unit * unit, y / unit * unit));
        vec(prop_oneof![4 => near, 1 => far], 0..9)
    }

    fn any_polygon() -> impl Strategy<Value = GridPolygon> {
        prop::sample::select(&UNITS[..])
            .prop_flat_map(|unit| (any_ring(unit), vec(any_ring(unit), 0..3)))
            .prop_map(|(outer, holes)| GridPolygon { outer, holes })
    }

    proptest! {
        #[test]
        fn polygons_lines_and_points_survive(polygons in vec((any_polygon(), any::<bool>()), 0..8)) {
            let mut outlines = Outlines::default();
            for (polygon, is_known) in &polygons {
                if *is_known {
                    outlines.know(polygon);
                }
                outlines.polygon(0, polygon);
                outlines.line(1, &polygon.outer);
                polygon.outer.iter().for_each(|&pos| outlines.point(2, pos));
            }
            let back = read(&stored(&outlines), |source| {
                let all = polygons.iter().map(|(told, is_known)| {
                    if *is_known {
                        source.know(told);
                    }
                    let (polygon, line) = (source.polygon(0)?, source.line(1)?);
                    let points = (0..line.len()).map(|_| source.point(2)).collect::<Result<Vec<_>, _>>()?;
                    Ok((polygon, line, points))
                });
                all.collect::<Result<Vec<_>, Unread>>()
            });
            let told: Vec<_> = polygons.iter().map(|(p, _)| (p.clone(), p.outer.clone(), p.outer.clone())).collect();
            prop_assert_eq!(back, Ok(told));
        }
    }

    fn ring(corners: &[(i32, i32)]) -> GridRing {
        corners.iter().map(|&(x, y)| GridPos(x * 1024, y * 1024)).collect()
    }

    #[test]
    fn what_is_known_and_the_neighbours_edge_cost_next_to_nothing() {
        let house = |x: i32| GridPolygon::simple(ring(&[(x, 0), (x + 9, 0), (x + 9, 12), (x, 12)]));
        let row = |known: bool| {
            let mut outlines = Outlines::default();
            for i in 0..40 {
                if known {
                    outlines.know(&house(9 * i));
                }
                outlines.polygon(0, &house(9 * i));
            }
            stored(&outlines).len()
        };
        let (told, known) = (row(false), row(true));
        assert!(told < 48 && known < 48, "{told} B for 40 houses in a row, {known} B where all of it is known");
    }

    #[test]
    fn what_lies_on_the_plan_is_told_in_its_steps() {
        let jagged = |unit: i32| -> GridRing { (0..60).map(|i| GridPos(i * 37 % 101 * unit, i * 53 % 97 * unit)).collect() };
        let told = UNITS.map(|unit| {
            let mut outlines = Outlines::default();
            outlines.line(0, &jagged(unit));
            stored(&outlines).len()
        });
        assert!(told[0] == told[1] && told[1] == told[2], "{told:?}");
    }

    #[test]
    fn a_vertex_told_long_ago_is_still_found() {
        let mut outlines = Outlines::default();
        let far: GridRing = (0..2 * LATELY as i32).map(|i| GridPos(i * i % 7919, i * 61 % 6007)).collect();
        outlines.line(0, &far);
        outlines.line(0, &[far[3], far[1], far[4]]);
        let back = read(&stored(&outlines), |source| Ok((source.line(0)?, source.line(0)?)));
        assert_eq!(back, Ok((far.clone(), vec![far[3], far[1], far[4]])));
    }

    #[test]
    fn what_was_never_told_is_an_error() {
        let mut outlines = Outlines::default();
        outlines.line(0, &ring(&[(0, 0), (9, 0), (9, 9)]));
        outlines.line(0, &ring(&[(9, 9), (0, 0)]));
        // Whoever knows fewer vertices than the writer finds some named that are not there.
        let mut more = Outlines::default();
        more.know(&GridPolygon::simple(ring(&[(50, 50), (70, 50), (70, 70), (50, 70)])));
        more.line(0, &ring(&[(70, 70), (50, 50)]));
        let error = read(&stored(&more), |source| source.line(0)).expect_err("refused");
        assert!(error.to_string().contains("names a vertex that was never told"), "{error}");
        let error = read(&stored(&outlines), |source| source.line(0)).expect_err("refused");
        assert!(matches!(error, StoreError::Malformed { .. }), "what follows must be read: {error}");
        for cut in 0..stored(&outlines).len() {
            assert!(read(&stored(&outlines)[..cut], |source| Ok((source.line(0)?, source.line(0)?))).is_err(), "{cut}");
        }
    }
}
