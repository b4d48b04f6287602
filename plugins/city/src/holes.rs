//! Which face each of many holes belongs to.

use crate::ring_edges;
use crate::{GridPolygon, GridPos, GridRing};

/// Most strips that edges are sorted into.
const MOST_STRIPS: usize = 4096;

/// An edge that runs eastward or westward, with what it belongs to.
#[derive(Clone, Copy)]
struct Edge {
    west: GridPos,
    east: GridPos,
    /// Whether the area lies above it.
    is_floor: bool,
    ring: Ring,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Ring {
    /// The border of a face, outer ring or hole that is known to be its own.
    Face(u32),
    /// One of the holes in question.
    Hole(u32),
}

/// Gives each hole to the face around it; holes outside of all faces are left out. Looks straight down from each hole's
/// westernmost vertex: what is met first is the border of the face sought, or a hole in it that has been given already.
pub(crate) fn adopt_all(faces: &mut [GridPolygon], holes: Vec<GridRing>) {
    if holes.is_empty() || faces.is_empty() {
        return;
    }
    // From west to east; of those with a common tip, the lower ones first.
    let with_tip = |hole: GridRing| tip(&hole).map(|(tip, lower)| (tip, lower, hole));
    let mut holes: Vec<(GridPos, GridPos, GridRing)> = holes.into_iter().filter_map(with_tip).collect();
    holes.sort_by(|a, b| a.0.cmp(&b.0).then_with(|| 0.cmp(&turn(a.0, a.1, b.1))));
    let strips = Strips::new(faces, &holes);
    let mut home: Vec<Option<usize>> = Vec::with_capacity(holes.len());
    for (h, &(tip, lower, _)) in (0..).zip(&holes) {
        let below = strips.below(tip, lower, Ring::Hole(h));
        home.push(below.filter(|edge| edge.is_floor).and_then(|edge| match edge.ring {
            Ring::Face(face) => Some(face as usize),
            Ring::Hole(other) => home.get(other as usize).copied().flatten(),
        }));
    }
    for ((_, _, hole), home) in holes.into_iter().zip(home) {
        if let Some(face) = home.and_then(|f| faces.get_mut(f)) {
            face.holes.push(hole);
        }
    }
}

/// A ring's westernmost vertex, the southernmost of these, and of the two beside it the one to which the lower edge runs.
fn tip(ring: &GridRing) -> Option<(GridPos, GridPos)> {
    let (at, &tip) = ring.iter().enumerate().min_by_key(|(_, p)| **p)?;
    let (before, after) = (ring[(at + ring.len() - 1) % ring.len()], ring[(at + 1) % ring.len()]);
    Some((tip, if turn(tip, before, after) > 0 { before } else { after }))
}

/// Edges by the vertical strips that they cross.
struct Strips {
    west: i64,
    width: i64,
    edges: Vec<Edge>,
    /// Where each strip's entries begin, and where the last one's end.
    starts: Vec<u32>,
    /// Numbers of edges, strip by strip.
    entries: Vec<u32>,
}

impl Strips {
    fn new(faces: &[GridPolygon], holes: &[(GridPos, GridPos, GridRing)]) -> Self {
        let rings = faces.iter().flat_map(GridPolygon::rings).chain(holes.iter().map(|hole| &hole.2));
        let mut edges: Vec<Edge> = Vec::with_capacity(rings.map(Vec::len).sum());
        let mut add = |ring: &GridRing, of: Ring| {
            for (a, b) in ring_edges(ring).filter(|(a, b)| a.0 != b.0) {
                let is_floor = a.0 < b.0;
                let (west, east) = if is_floor { (a, b) } else { (b, a) };
                edges.push(Edge { west, east, is_floor, ring: of });
            }
        };
        for (f, face) in (0..).zip(faces) {
            face.rings().for_each(|ring| add(ring, Ring::Face(f)));
        }
        for (h, (_, _, hole)) in (0..).zip(holes) {
            add(hole, Ring::Hole(h));
        }
        let west = edges.iter().map(|e| i64::from(e.west.0)).min().unwrap_or(0);
        let east = edges.iter().map(|e| i64::from(e.east.0)).max().unwrap_or(0);
        let count = (edges.len() / 8 + 1).min(MOST_STRIPS);
        let width = (east - west) / count as i64 + 1;
        let strip = |x: i32| ((i64::from(x) - west) / width) as usize;
        let crossed = |edge: &Edge| strip(edge.west.0)..=strip(edge.east.0);
        let mut starts = vec![0_u32; count + 1];
        edges.iter().flat_map(crossed).for_each(|strip| starts[strip + 1] += 1);
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut entries = vec![0; starts[count] as usize];
        let mut next = starts.clone();
        for (number, strip) in (0..).zip(&edges).flat_map(|(number, edge)| crossed(edge).map(move |strip| (number, strip))) {
            entries[next[strip] as usize] = number;
            next[strip] += 1;
        }
        Self { west, width, edges, starts, entries }
    }

    /// The first edge that is not of a ring straight below its westernmost vertex, just east of it; `lower` ends the ring's
    /// lower edge there, for others may begin at the same vertex and run below that.
    fn below(&self, tip: GridPos, lower: GridPos, but: Ring) -> Option<Edge> {
        let strip = usize::try_from((i64::from(tip.0) - self.west) / self.width).ok()?;
        let [from, to] = [*self.starts.get(strip)?, *self.starts.get(strip + 1)?];
        let strip = self.entries.get(from as usize..to as usize)?.iter().map(|&number| &self.edges[number as usize]);
        let is_below = |e: &Edge| side(e, tip) > 0 || (e.west == tip && turn(tip, lower, e.east) < 0);
        let under = |e: &&Edge| e.ring != but && e.west.0 <= tip.0 && tip.0 < e.east.0 && is_below(e);
        strip.filter(under).copied().reduce(|best, e| if is_higher(&e, &best, tip.0) { e } else { best })
    }
}

/// Positive where a position lies above an edge.
fn side(edge: &Edge, p: GridPos) -> i128 {
    turn(edge.west, edge.east, p)
}

/// Positive where one turns left from the way from `o` to `a` to the way to `b`.
fn turn(o: GridPos, a: GridPos, b: GridPos) -> i128 {
    let d = |a: i32, b: i32| i128::from(b) - i128::from(a);
    d(o.0, a.0) * d(o.1, b.1) - d(o.1, a.1) * d(o.0, b.0)
}

/// Whether an edge runs above another just east of an abscissa that both cross.
fn is_higher(edge: &Edge, other: &Edge, x: i32) -> bool {
    let run = |e: &Edge| (i128::from(e.east.0) - i128::from(e.west.0), i128::from(e.east.1) - i128::from(e.west.1));
    let ((dx, dy), (ox, oy)) = (run(edge), run(other));
    // Heights as fractions of their runs: y = (west.1 · dx + dy · (x − west.0)) / dx.
    let height = |e: &Edge, dx: i128, dy: i128| i128::from(e.west.1) * dx + dy * (i128::from(x) - i128::from(e.west.0));
    let (here, there) = (height(edge, dx, dy) * ox, height(other, ox, oy) * dx);
    here > there || (here == there && dy * ox > oy * dx)
}
