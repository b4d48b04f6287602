//! A person's edits to the cells that were cut: two joined, one cut along a line, one named.
//!
//! They come after the cut, so that they change no cell but those that they name.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use glam::DVec2;
use veduta_city::{CellOverride, Finding, GRID_PER_METRE, GridPolygon, GridPos, Id, Severity, Target};

use crate::chord::{CORNER_M, Landing, Side, Way, way_through};
use crate::merge::numbered;
use crate::outline::outlines;
use crate::overlay::Edge;
use crate::reach::only;
use crate::triangulate::{Triangle, triangulate_within};

/// Cells after a person's edits.
pub(crate) struct Edited {
    pub(crate) triangles: Vec<Triangle>,
    /// Cell of each triangle.
    pub(crate) label: Vec<u32>,
    /// Names that were given, by cell.
    pub(crate) names: Vec<Option<String>>,
}

/// Makes a person's edits to cells, in order. What cannot be done is left out, and told.
pub(crate) fn edited(
    edits: &[CellOverride],
    (triangles, label): (Vec<Triangle>, Vec<u32>),
    extent: &GridPolygon,
    findings: &mut Vec<Finding>,
) -> Edited {
    if edits.is_empty() {
        return Edited { triangles, label, names: Vec::new() };
    }
    let mut draft = Draft::new(triangles, label, extent);
    for (number, edit) in (1..).zip(edits) {
        let ((id, at), done) = match edit {
            CellOverride::Join { target, with } => ((target.id, target.at), draft.join(target, with)),
            CellOverride::Cut { from, to } => ((Id::NONE, *from), draft.cut(*from, *to)),
            CellOverride::Name { target, name } => ((target.id, target.at), draft.name(target, name)),
        };
        let (severity, messages) = match done {
            Ok(notes) => (Severity::Note, notes),
            Err(reason) => (Severity::Dropped, vec![reason]),
        };
        let tell = |m: String| Finding::new(severity, id, Some(at), format!("edit {number} of the cells ({}): {m}", edit.kind()));
        findings.extend(messages.into_iter().map(tell));
    }
    draft.finish()
}

/// What is worth telling of an edit that was made, or why it was not, in clauses.
type Outcome = Result<Vec<String>, String>;

/// The label of triangles that are no more.
const GONE: u32 = u32::MAX;
/// Pieces smaller than this are no cells, square metres.
const LEAST_M2: f64 = 1.0;

/// A cell while it is edited.
#[derive(Default)]
struct Shape {
    /// None: the cell is no more.
    triangles: Vec<u32>,
    outline: GridPolygon,
    name: Option<String>,
}

struct Draft<'a> {
    extent: &'a GridPolygon,
    triangles: Vec<Triangle>,
    label: Vec<u32>,
    shapes: Vec<Shape>,
}

/// A cell that is triangulated anew.
struct Anew {
    cell: u32,
    triangles: Vec<Triangle>,
    /// Piece of each.
    piece: Vec<u32>,
}

impl<'a> Draft<'a> {
    fn new(triangles: Vec<Triangle>, label: Vec<u32>, extent: &'a GridPolygon) -> Self {
        let (outlines, _) = outlines(&triangles, &label, extent);
        let mut shapes: Vec<Shape> = outlines.into_iter().map(|outline| Shape { outline, ..Shape::default() }).collect();
        for (t, &cell) in (0..).zip(&label) {
            shapes[cell as usize].triangles.push(t);
        }
        Self { extent, triangles, label, shapes }
    }

    /// The cells in their order, without what is no more.
    fn finish(self) -> Edited {
        let triangles = only(&self.triangles, |t| self.label[t] != GONE);
        let old: Vec<u32> = self.label.into_iter().filter(|&cell| cell != GONE).collect();
        let label = numbered(&triangles, &old);
        let count = label.iter().max().map_or(0, |&last| last as usize + 1);
        let mut names = vec![None; count];
        for (&old, &new) in old.iter().zip(&label) {
            if let Some(name) = &self.shapes[old as usize].name
                && names[new as usize].is_none()
            {
                names[new as usize] = Some(name.clone());
            }
        }
        Edited { triangles, label, names }
    }

    fn find(&self, target: &Target) -> Result<(u32, Option<String>), String> {
        let id =
            |shape: &Shape| if shape.triangles.is_empty() { Id::NONE } else { Id::from_place("cell", shape.outline.centroid()) };
        let (cell, note) = target.area("cell", self.shapes.iter().map(|shape| (id(shape), &shape.outline)))?;
        Ok((cell as u32, note))
    }

    fn name(&mut self, target: &Target, name: &str) -> Outcome {
        let (cell, note) = self.find(target)?;
        self.shapes[cell as usize].name = Some(name.to_owned());
        Ok(note.into_iter().collect())
    }

    fn join(&mut self, target: &Target, with: &Target) -> Outcome {
        let (first, note) = self.find(target)?;
        let (second, of_second) = self.find(with).map_err(|reason| format!("`with`: {reason}"))?;
        if first == second {
            return Err("both places lie in one cell".to_owned());
        }
        let leads_over = |&t: &u32| self.triangles[t as usize].beyond.iter().flatten().any(|&n| self.label[n as usize] == second);
        if !self.shapes[first as usize].triangles.iter().any(leads_over) {
            return Err("no portal leads from the one cell to the other: join it first with what lies between".to_owned());
        }
        let Shape { triangles, name, .. } = core::mem::take(&mut self.shapes[second as usize]);
        triangles.iter().for_each(|&t| self.label[t as usize] = first);
        let shape = &mut self.shapes[first as usize];
        shape.triangles.extend(triangles);
        shape.name = shape.name.take().or(name);
        self.trace(first);
        Ok(note.into_iter().chain(of_second).collect())
    }

    /// Traces the outline of a cell whose triangles have changed.
    fn trace(&mut self, cell: u32) {
        let own: Vec<Triangle> = self.shapes[cell as usize].triangles.iter().map(|&t| self.triangles[t as usize]).collect();
        let number: HashMap<u32, u32> = self.shapes[cell as usize].triangles.iter().copied().zip(0..).collect();
        let beyond = |t: Option<u32>| t.and_then(|t| number.get(&t).copied());
        let own: Vec<Triangle> = own.iter().map(|t| Triangle { beyond: t.beyond.map(beyond), ..*t }).collect();
        let (mut outline, _) = outlines(&own, &vec![0; own.len()], self.extent);
        self.shapes[cell as usize].outline = outline.pop().unwrap_or_default();
    }

    /// The border of a cell, with what lies beyond each edge.
    fn border(&self, cell: u32) -> impl Iterator<Item = (Edge, Option<u32>)> {
        self.shapes[cell as usize].triangles.iter().flat_map(move |&t| {
            let triangle = &self.triangles[t as usize];
            let edges = (0..3).map(move |i| (triangle.edge(i), triangle.beyond[i]));
            edges.filter(move |(_, beyond)| beyond.is_none_or(|n| self.label[n as usize] != cell))
        })
    }

    fn cut(&mut self, from: DVec2, to: DVec2) -> Outcome {
        let ways: Vec<(u32, Way)> = match [from, to].map(|end| self.corner_near(end)) {
            [Some(a), Some(b)] if a == b => return Err("both ends are meant for one corner".to_owned()),
            [Some(a), Some(b)] if self.is_portal(a, b) => return Err("a portal lies along that line already".to_owned()),
            [Some(a), Some(b)] => self.way_between(a, b).map_or_else(|| self.ways(a.to_metres(), b.to_metres()), |way| vec![way]),
            [a, b] => self.ways(a.map_or(from, GridPos::to_metres), b.map_or(to, GridPos::to_metres)),
        };
        let mut notes: Vec<String> = ways.iter().filter_map(|(_, way)| way.ends_at).map(ends_within).collect();
        let chords: BTreeMap<u32, Vec<Edge>> = ways
            .iter()
            .filter(|(_, way)| !way.chords.is_empty())
            .map(|(cell, way)| (*cell, way.chords.iter().map(|&[enter, leave]| (enter.at, leave.at)).collect()))
            .collect();
        if chords.is_empty() {
            return Err(notes.pop().unwrap_or_else(|| "the line leads through no cell".to_owned()));
        }
        let landings = ways.iter().flat_map(|(_, way)| way.chords.iter().flatten());
        let parted: BTreeMap<Edge, GridPos> = landings.filter_map(|landing| Some((landing.parts?, landing.at))).collect();
        let mut anew: Vec<Anew> = Vec::new();
        for cell in self.touched(&chords, &parted) {
            let made = self.anew(cell, chords.get(&cell).map_or(&[], Vec::as_slice), &parted);
            anew.push(made.ok_or("the line passes too close by a corner of a wall: lead it to the corner, or farther from it")?);
        }
        let least_2 = (2.0 * LEAST_M2 * f64::from(GRID_PER_METRE * GRID_PER_METRE)) as i64;
        if anew.iter().any(|made| made.areas_2().len() > 1 && made.areas_2().iter().any(|&area_2| area_2 < least_2)) {
            return Err(format!("a piece of less than {LEAST_M2} m² would come of it: lead the line farther from the wall"));
        }
        let whole = |made: &&Anew| chords.contains_key(&made.cell) && made.areas_2().len() < 2;
        let unparted = anew.iter().filter(whole).count();
        if unparted == chords.len() {
            return Err("the line parts no cell: one can walk around it".to_owned());
        }
        if unparted > 0 {
            notes.push(format!("{unparted} of {} cells that the line leads through are not parted by it", chords.len()));
        }
        self.put(anew);
        Ok(notes)
    }

    /// The corner of a wall that an end of a line is meant for.
    fn corner_near(&self, end: DVec2) -> Option<GridPos> {
        let reach = DVec2::splat(CORNER_M);
        let (low, high) = (GridPos::from_metres(end - reach), GridPos::from_metres(end + reach));
        let walls = self.cells_about(low, high).flat_map(|cell| self.border(cell)).filter(|(_, beyond)| beyond.is_none());
        let corners = walls.flat_map(|((a, b), _)| [a, b]).map(|corner| (corner.to_metres().distance_squared(end), corner));
        let nearest = corners.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        nearest.filter(|&(distance_2, _)| distance_2 <= CORNER_M * CORNER_M).map(|(_, corner)| corner)
    }

    /// Whether one cell ends along a line and another begins.
    fn is_portal(&self, a: GridPos, b: GridPos) -> bool {
        let mut borders = self.cells_about(a.min(b), a.max(b)).flat_map(|cell| self.border(cell));
        borders.any(|(edge, beyond)| beyond.is_some() && sorted(edge) == sorted((a, b)))
    }

    /// The cell across which one looks from one corner of it to another, along a wall too.
    fn way_between(&self, a: GridPos, b: GridPos) -> Option<(u32, Way)> {
        let sees = |cell: &u32| {
            let sides: Vec<Edge> = self.border(*cell).map(|(edge, _)| edge).collect();
            let apart = |p: GridPos, q: GridPos, r: GridPos, s: GridPos| p.cross(q, r).signum() * p.cross(q, s).signum();
            let crosses = |&(p, q): &Edge| apart(a, b, p, q) < 0 && apart(p, q, a, b) < 0;
            let has = |corner: GridPos| sides.iter().any(|side| side.0 == corner);
            has(a) && has(b) && self.shapes[*cell as usize].outline.contains(a.midpoint(b)) && !sides.iter().any(crosses)
        };
        let cell = self.cells_about(a.min(b), a.max(b)).find(sees)?;
        let chords = vec![[a, b].map(|at| Landing { at, parts: None })];
        Some((cell, Way { chords, ends_at: None }))
    }

    /// The cells whose bounds touch a box.
    fn cells_about(&self, a: GridPos, b: GridPos) -> impl Iterator<Item = u32> {
        let (low, high) = (GridPos(a.0.min(b.0), a.1.min(b.1)), GridPos(a.0.max(b.0), a.1.max(b.1)));
        let is_about = move |shape: &Shape| {
            shape.outline.bounds().is_some_and(|(lo, hi)| lo.0 <= high.0 && low.0 <= hi.0 && lo.1 <= high.1 && low.1 <= hi.1)
        };
        (0..).zip(&self.shapes).filter(move |(_, shape)| is_about(shape)).map(|(cell, _)| cell)
    }

    /// The cells that a line meets, and where it leads through each.
    fn ways(&self, from: DVec2, to: DVec2) -> Vec<(u32, Way)> {
        let way = |cell: u32| {
            let sides: Vec<Side> = self.border(cell).map(|(ends, beyond)| Side { ends, is_wall: beyond.is_none() }).collect();
            (cell, way_through(from, to, &sides))
        };
        self.cells_about(GridPos::from_metres(from), GridPos::from_metres(to)).map(way).collect()
    }

    /// The cells through which a line leads, and those that get a corner by it.
    fn touched(&self, chords: &BTreeMap<u32, Vec<Edge>>, parted: &BTreeMap<Edge, GridPos>) -> BTreeSet<u32> {
        let mut touched: BTreeSet<u32> = chords.keys().copied().collect();
        for &cell in chords.keys() {
            let beyond = self.border(cell).filter(|(edge, _)| parted.contains_key(&sorted(*edge)));
            touched.extend(beyond.filter_map(|(_, beyond)| Some(self.label[beyond? as usize])));
        }
        touched
    }

    /// A cell with new corners on its border and lines through it; `None` where one of them cannot be.
    fn anew(&self, cell: u32, lines: &[Edge], parted: &BTreeMap<Edge, GridPos>) -> Option<Anew> {
        let pieces = |(edge, _): (Edge, Option<u32>)| match parted.get(&sorted(edge)) {
            Some(&at) => vec![(edge.0, at), (at, edge.1)],
            None => vec![edge],
        };
        let borders: Vec<Edge> = self.border(cell).flat_map(pieces).collect();
        let corners = self.shapes[cell as usize].triangles.iter().flat_map(|&t| self.triangles[t as usize].corners);
        let positions = corners.chain(borders.iter().map(|edge| edge.0)).collect();
        let (triangles, piece) = triangulate_within(positions, &borders, lines)?;
        let origin = borders.first()?.0;
        let enclosed_2: i64 = borders.iter().map(|&(a, b)| origin.cross(a, b)).sum();
        let filled_2: i64 = triangles.iter().map(Triangle::area_2).sum();
        (enclosed_2 == filled_2).then_some(Anew { cell, triangles, piece })
    }

    /// Puts cells that were triangulated anew in place of what they were; each piece is a cell with the old one's name.
    fn put(&mut self, anew: Vec<Anew>) {
        let touched: BTreeSet<u32> = anew.iter().map(|made| made.cell).collect();
        let mut outer: HashMap<Edge, u32> = HashMap::new();
        for &cell in &touched {
            let is_other = |&(_, n): &(Edge, u32)| !touched.contains(&self.label[n as usize]);
            outer.extend(self.border(cell).filter_map(|(edge, beyond)| Some((edge, beyond?))).filter(is_other));
        }
        let mut fresh: Vec<u32> = Vec::new();
        for Anew { cell, triangles, piece } in anew {
            let Shape { triangles: old, name, .. } = core::mem::take(&mut self.shapes[cell as usize]);
            old.iter().for_each(|&t| self.label[t as usize] = GONE);
            let (base, new) = (self.triangles.len() as u32, self.shapes.len() as u32);
            let count = piece.iter().max().map_or(0, |&last| last + 1);
            // The first piece is the old cell.
            let cell_of = |piece: u32| if piece == 0 { cell } else { new + piece - 1 };
            self.shapes.extend((1..count).map(|_| Shape::default()));
            for (triangle, &piece) in triangles.iter().zip(&piece) {
                let t = self.triangles.len() as u32;
                fresh.push(t);
                self.shapes[cell_of(piece) as usize].triangles.push(t);
                self.label.push(cell_of(piece));
                self.triangles.push(Triangle { beyond: triangle.beyond.map(|n| n.map(|n| n + base)), ..*triangle });
            }
            (0..count).for_each(|piece| self.shapes[cell_of(piece) as usize].name.clone_from(&name));
        }
        self.link(&fresh, &outer);
        let changed: BTreeSet<u32> = fresh.iter().map(|&t| self.label[t as usize]).collect();
        changed.into_iter().for_each(|cell| self.trace(cell));
    }

    /// Links new triangles with each other across the borders of cells, and with those that were beyond these.
    fn link(&mut self, fresh: &[u32], outer: &HashMap<Edge, u32>) {
        let sides = |triangles: &[Triangle], t: u32| (0..3).map(|i| (i, triangles[t as usize].edge(i))).collect::<Vec<_>>();
        let mut open: HashMap<Edge, u32> = HashMap::new();
        for &t in fresh {
            let of_border = sides(&self.triangles, t).into_iter().filter(|&(i, _)| self.triangles[t as usize].beyond[i].is_none());
            open.extend(of_border.map(|(_, edge)| (edge, t)));
        }
        for (&(a, b), &t) in &open {
            let beyond = open.get(&(b, a)).or_else(|| outer.get(&(a, b))).copied();
            for (i, edge) in sides(&self.triangles, t) {
                if edge == (a, b) {
                    self.triangles[t as usize].beyond[i] = beyond;
                }
            }
            let Some(n) = outer.get(&(a, b)).copied() else { continue };
            for (i, edge) in sides(&self.triangles, n) {
                if edge == (b, a) {
                    self.triangles[n as usize].beyond[i] = Some(t);
                }
            }
        }
    }
}

impl Anew {
    /// Twice the area of each piece, grid steps squared.
    fn areas_2(&self) -> Vec<i64> {
        let mut areas_2 = Vec::new();
        for (triangle, &piece) in self.triangles.iter().zip(&self.piece) {
            areas_2.resize(areas_2.len().max(piece as usize + 1), 0);
            areas_2[piece as usize] += triangle.area_2();
        }
        areas_2
    }
}

fn sorted((a, b): Edge) -> Edge {
    (a.min(b), a.max(b))
}

fn ends_within(end: DVec2) -> String {
    format!("the line ends within a cell, at ({:.1}, {:.1}), and does not part it: draw it from wall to wall", end.x, end.y)
}
