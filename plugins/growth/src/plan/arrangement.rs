//! The arrangement of layers of shapes: a partition of the extent in which every piece of ground belongs to the highest layer
//! that covers it, with the same vertices on both sides of every border, so that nothing overlaps and no gap is left.
//!
//! All edges are snapped to the steps of the plan together (`hot`), then walked around face by face (`faces`). The extent is
//! cut into square tiles, so that no piece has thousands of vertices and tiles can be worked at side by side: their sides
//! are edges of the arrangement, and what is hot on them is hot for the tiles on both sides.
//!
//! Rejected: a boolean operation a layer (`i_overlay`): no faster, and what a lower layer's edges do to the border between two
//! higher ones is unknown to these, so that vertices lie on the edges of neighbours and the mesh shows cracks.

mod faces;
mod hot;

use rayon::prelude::*;
use rustc_hash::FxHashSet;
use veduta_city::{GridPolygon, GridPos, PLAN_STEP, ring_edges};

use super::extent::Extent;
use super::index::{Cells, Gathering};
use super::streets::Layer;
use faces::{Faces, Sides};

/// Side of a tile as a power of two of the plan's steps: 64 m.
const TILE_SHIFT: u32 = 12;
/// Most tiles; in larger cities tiles grow.
const MOST_TILES: i64 = 1 << 14;

/// A directed edge of a shape, which lies on its left if the shape runs counter-clockwise.
#[derive(Debug, Clone, Copy)]
struct Segment {
    a: GridPos,
    b: GridPos,
    layer: u32,
}

/// Layers, and how often each winds about something or turns at an edge: ascending, none of them 0.
type Turns = Vec<(u32, i32)>;

/// Adds to how often a layer turns.
fn turn(turns: &mut Turns, layer: u32, by: i32) {
    match turns.binary_search_by_key(&layer, |turn| turn.0) {
        Ok(i) if turns[i].1 == -by => {
            turns.remove(i);
        }
        Ok(i) => turns[i].1 += by,
        Err(i) if by != 0 => turns.insert(i, (layer, by)),
        Err(_) => {}
    }
}

/// A part of the extent.
#[derive(Debug, Clone, Copy)]
struct Tile {
    lo: GridPos,
    hi: GridPos,
}

impl Tile {
    /// Whether a position lies in it or on its sides.
    fn holds(&self, p: GridPos) -> bool {
        Extent { lo: self.lo, hi: self.hi }.holds(p)
    }

    fn corners(&self) -> [GridPos; 4] {
        [self.lo, GridPos(self.lo.0, self.hi.1), GridPos(self.hi.0, self.lo.1), self.hi]
    }

    /// Whether a position in the tile lies on its sides.
    fn is_side(&self, p: GridPos) -> bool {
        p.0 == self.lo.0 || p.0 == self.hi.0 || p.1 == self.lo.1 || p.1 == self.hi.1
    }
}

/// A piece of ground.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Piece {
    /// The layer that covers it; `None` if there is none.
    pub layer: Option<u32>,
    /// Its outline, which lies in one tile. There is a vertex wherever a border ends on it.
    pub outline: GridPolygon,
}

/// The pieces of the extent, to the steps of the plan, tile by tile, south to north and west to east, in each by layer. Pieces smaller than `dust_m2`
/// (corners that a tile's side cuts off, leavings of the grid) join the neighbour with whom they share the longest border, one that differs by its course alone before others.
pub(super) fn arrange(extent: &Extent, layers: &[Layer], dust_m2: f64) -> Vec<Piece> {
    let within = |p: GridPos| {
        let axis = |v: i32| v.saturating_add(PLAN_STEP / 2).div_euclid(PLAN_STEP);
        GridPos(axis(p.0), axis(p.1))
    };
    let extent = &Extent { lo: within(extent.lo), hi: within(extent.hi) };
    let segments = segments(extent, layers, within);
    let tiles = Tiles::new(extent);
    let bins = tiles.bins(&segments);
    let all: Vec<usize> = (0..tiles.count()).collect();
    let hot = all.par_iter().map(|&t| hot::hot_points(&tiles.tile(t), &segments, bins.of_cell(t as i64)));
    let hot = tiles.shared(hot.collect());
    let sides = all.par_iter().map(|&t| {
        let mut ways = faces::Ways::new(tiles.tile(t), &hot[t]);
        bins.of_cell(t as i64).iter().for_each(|&s| ways.add(s, &segments[s as usize]));
        Faces::new(ways)
    });
    let (mut faces, sides): (Vec<Faces<'_>>, Vec<Sides>) = sides.collect::<Vec<_>>().into_iter().unzip();
    let below = tiles.below(&sides, &segments);
    let kinds = kinds(layers);
    faces.par_iter_mut().zip(below).for_each(|(faces, below)| faces.label(below, &kinds, dust_m2));
    // A vertex on a side stays if a border ends there on either side of it.
    let ends: FxHashSet<GridPos> = faces.iter().flat_map(Faces::ends_on_sides).collect();
    let pieces = faces.par_iter().map(|faces| faces.pieces(&ends)).collect::<Vec<_>>().into_iter().flatten();
    let out = |p: GridPos| GridPos(p.0.saturating_mul(PLAN_STEP), p.1.saturating_mul(PLAN_STEP));
    pieces.map(|piece| Piece { outline: piece.outline.map(out), ..piece }).collect()
}

/// A number for each layer, which those have in common that differ by their course alone.
fn kinds(layers: &[Layer]) -> Vec<u32> {
    let mut kinds: Vec<u32> = Vec::with_capacity(layers.len());
    for (i, layer) in layers.iter().enumerate() {
        let is_alike = |other: &Layer| (other.rank, other.z, other.surface) == (layer.rank, layer.z, layer.surface);
        let before = i.checked_sub(1).filter(|&before| is_alike(&layers[before]));
        kinds.push(before.map_or(i as u32, |before| kinds[before]));
    }
    kinds
}

/// All edges within the extent, in steps of the plan.
fn segments(extent: &Extent, layers: &[Layer], within: impl Fn(GridPos) -> GridPos) -> Vec<Segment> {
    let rings = layers
        .iter()
        .zip(0_u32..)
        .flat_map(|(layer, number)| layer.shapes.iter().flat_map(GridPolygon::rings).map(move |ring| (number, ring.as_slice())));
    let mut out = Vec::new();
    for (layer, ring) in rings {
        let ring: Vec<GridPos> = ring.iter().map(|&p| within(p)).collect();
        let ring = ring.as_slice();
        let clipped = if ring.iter().all(|&p| extent.holds(p)) { None } else { Some(clipped(ring, extent)) };
        let edges = ring_edges(clipped.as_deref().unwrap_or(ring)).filter(|(a, b)| a != b);
        out.extend(edges.map(|(a, b)| Segment { a, b, layer }));
    }
    out
}

/// The part of a ring within the extent, after Sutherland and Hodgman: where it leaves and comes back it runs along the sides,
/// and winds about every position inside as often as before.
fn clipped(ring: &[GridPos], extent: &Extent) -> Vec<GridPos> {
    let turned = |ring: &[GridPos]| ring.iter().map(|p| GridPos(p.1, p.0)).collect::<Vec<_>>();
    let within_x = |ring: &[GridPos], lo: i32, hi: i32| {
        let ring = clipped_at(ring, lo, |x| x >= lo);
        clipped_at(&ring, hi, |x| x <= hi)
    };
    let ring = within_x(ring, extent.lo.0, extent.hi.0);
    turned(&within_x(&turned(&ring), extent.lo.1, extent.hi.1))
}

fn clipped_at(ring: &[GridPos], x: i32, is_kept: impl Fn(i32) -> bool) -> Vec<GridPos> {
    let mut out = Vec::with_capacity(ring.len());
    for (a, b) in ring_edges(ring) {
        if is_kept(a.0) {
            out.push(a);
        }
        if is_kept(a.0) != is_kept(b.0) {
            out.push(hot::at_x(a, b, x));
        }
    }
    out
}

/// The extent cut into tiles.
struct Tiles {
    extent: Extent,
    shift: u32,
    columns: i64,
    rows: i64,
}

impl Tiles {
    fn new(extent: &Extent) -> Self {
        let (w, h) = (i64::from(extent.hi.0) - i64::from(extent.lo.0), i64::from(extent.hi.1) - i64::from(extent.lo.1));
        // What does not fill a tile belongs to the last one.
        let count = |span: i64, shift: u32| (span >> shift).max(1);
        let fits = |&shift: &u32| count(w, shift) * count(h, shift) <= MOST_TILES;
        let shift = (TILE_SHIFT..31).find(fits).unwrap_or(31);
        Self { extent: *extent, shift, columns: count(w, shift), rows: count(h, shift) }
    }

    fn count(&self) -> usize {
        (self.columns * self.rows) as usize
    }

    fn tile(&self, tile: usize) -> Tile {
        let (column, row) = (tile as i64 % self.columns, tile as i64 / self.columns);
        let at = |lo: i32, hi: i32, i: i64, count: i64| if i == count { hi } else { lo + (i << self.shift) as i32 };
        let (lo, hi) = (self.extent.lo, self.extent.hi);
        let corner = |c, r| GridPos(at(lo.0, hi.0, c, self.columns), at(lo.1, hi.1, r, self.rows));
        Tile { lo: corner(column, row), hi: corner(column + 1, row + 1) }
    }

    /// The segments that each tile's ground touches.
    fn bins(&self, segments: &[Segment]) -> Cells {
        let bins = Gathering::of_side(self.extent.lo, self.shift, (self.columns, self.rows));
        bins.each(segments, |own, segment, i| own.edge(segment.a, segment.b, i as u32)).sorted()
    }

    /// Hot points of each tile with those of its neighbours that lie on its sides.
    fn shared(&self, hot: Vec<Vec<GridPos>>) -> Vec<Vec<GridPos>> {
        let with_neighbours = |t: usize| {
            let tile = self.tile(t);
            let mut own = hot[t].clone();
            let count = own.len();
            for neighbour in self.neighbours(t) {
                own.extend(hot[neighbour].iter().filter(|&&p| tile.holds(p)));
            }
            if own.len() > count {
                own.sort_unstable();
                own.dedup();
            }
            own
        };
        (0..hot.len()).into_par_iter().map(with_neighbours).collect()
    }

    fn neighbours(&self, tile: usize) -> impl Iterator<Item = usize> + use<> {
        let (columns, rows) = (self.columns, self.rows);
        let (column, row) = (tile as i64 % columns, tile as i64 / columns);
        let all = (-1..=1).flat_map(|r| (-1..=1).map(move |c| (c, r))).filter(|&at| at != (0, 0));
        let all = all.map(move |(c, r)| (column + c, row + r));
        all.filter(move |&(c, r)| (0..columns).contains(&c) && (0..rows).contains(&r)).map(move |(c, r)| (r * columns + c) as usize)
    }

    /// How often each layer winds about the ground just above the first edge of each tile's southern side, by the corner, below
    /// all other edges that leave it: as often as edges run eastward from the line of its western side down there, less those
    /// that run westward to it.
    fn below(&self, sides: &[Sides], segments: &[Segment]) -> Vec<Turns> {
        let mut below: Vec<Turns> = Vec::with_capacity(sides.len());
        for t in 0..sides.len() {
            let south = (t as i64 >= self.columns).then(|| t - self.columns as usize);
            let mut turns = south.map_or_else(Turns::new, |south| below[south].clone());
            if let Some(south) = south {
                sides[south].inner.iter().for_each(|&(layer, by)| turn(&mut turns, layer, by));
            }
            // Both tiles may know that a segment runs along the side between them.
            let mut along: Vec<(u32, i32)> = sides[t].southern.clone();
            along.extend(south.iter().flat_map(|&south| &sides[south].northern));
            along.sort_unstable();
            along.dedup();
            along.iter().for_each(|&(s, by)| turn(&mut turns, segments[s as usize].layer, by));
            below.push(turns);
        }
        below
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use proptest::prelude::*;
    use veduta_city::SurfaceKind;

    use super::*;
    use crate::plan::streets::Rank;

    const SIDE: i32 = 1 << TILE_SHIFT;

    /// In steps of the plan.
    fn pos(x: i32, y: i32) -> GridPos {
        GridPos(x * PLAN_STEP, y * PLAN_STEP)
    }

    fn in_steps(area: i64) -> i64 {
        area / i64::from(PLAN_STEP * PLAN_STEP)
    }

    fn twice_area(polygon: &GridPolygon) -> i64 {
        polygon.edges().map(|(a, b)| GridPos(0, 0).cross(a, b)).sum()
    }

    /// Every edge runs once each way but for those of the extent, and the areas make up the extent: nothing overlaps, and
    /// nothing is left open.
    fn prove_partition(extent: &Extent, pieces: &[Piece]) {
        let mut edges: HashMap<(GridPos, GridPos), i32> = HashMap::new();
        for (a, b) in pieces.iter().flat_map(|piece| piece.outline.rings()).flat_map(|ring| ring_edges(ring)) {
            *edges.entry((a, b)).or_default() += 1;
        }
        for (&(a, b), &count) in &edges {
            assert_eq!(count, 1, "{a:?} {b:?} runs so more than once");
            let is_border = |lo: i32, hi: i32, a: i32, b: i32| a == b && (a == lo || a == hi);
            let is_border = is_border(extent.lo.0, extent.hi.0, a.0, b.0) || is_border(extent.lo.1, extent.hi.1, a.1, b.1);
            assert!(is_border || edges.contains_key(&(b, a)), "nothing lies beyond {a:?} {b:?}");
        }
        assert!(pieces.iter().all(|piece| twice_area(&piece.outline) > 0));
        let area: i64 = pieces.iter().map(|piece| twice_area(&piece.outline)).sum();
        assert_eq!(area, twice_area(&extent.polygon()));
    }

    fn layers(shapes: &[Vec<Vec<GridPos>>]) -> Vec<Layer> {
        let layer = |rings: &Vec<Vec<GridPos>>| {
            Layer::new(Rank::Lane, SurfaceKind::Cobbles, rings.iter().cloned().map(GridPolygon::simple).collect())
        };
        shapes.iter().map(layer).collect()
    }

    /// How often rings wind about a position off their edges.
    fn winding(shapes: &[GridPolygon], p: (f64, f64)) -> i32 {
        let edges = shapes.iter().flat_map(GridPolygon::rings).flat_map(|ring| ring_edges(ring));
        let turn = |(a, b): (GridPos, GridPos)| {
            let [(ax, ay), (bx, by)] = [a, b].map(|q| (f64::from(q.0), f64::from(q.1)));
            let is_west = (ax <= p.0) != (bx <= p.0) && ay + (by - ay) * (p.0 - ax) / (bx - ax) < p.1;
            if is_west { if ax < bx { 1 } else { -1 } } else { 0 }
        };
        edges.map(turn).sum()
    }

    fn distance(shapes: &[GridPolygon], p: (f64, f64)) -> f64 {
        let p = glam::DVec2::new(p.0, p.1);
        let at = |q: GridPos| glam::DVec2::new(f64::from(q.0), f64::from(q.1));
        let edges = shapes.iter().flat_map(GridPolygon::rings).flat_map(|ring| ring_edges(ring));
        edges.map(|(a, b)| super::super::outline::distance_to_edge(p, at(a), at(b))).fold(f64::INFINITY, f64::min)
    }

    /// What is farther than rounding reaches from all edges belongs to the first layer that winds about it.
    fn check_covers(extent: &Extent, layers: &[Layer], pieces: &[Piece], at: impl Iterator<Item = (i32, i32)>) {
        let all: Vec<GridPolygon> = layers.iter().flat_map(|layer| layer.shapes.clone()).collect();
        for (x, y) in at {
            let p = (f64::from(x) + 0.25, f64::from(y) + 0.25);
            let p = (p.0 * f64::from(PLAN_STEP), p.1 * f64::from(PLAN_STEP));
            if !extent.holds(pos(x, y)) || distance(&all, p) < 3.0 * f64::from(PLAN_STEP) {
                continue;
            }
            let want = layers.iter().position(|layer| winding(&layer.shapes, p) != 0).map(|layer| layer as u32);
            let found: Vec<_> = pieces.iter().filter(|piece| winding(std::slice::from_ref(&piece.outline), p) != 0).collect();
            assert_eq!(found.len(), 1, "{p:?}");
            assert_eq!(found[0].layer, want, "{p:?}");
        }
    }

    #[test]
    fn an_island_takes_what_winds_about_it() {
        let ring = |lo: i32, hi: i32| vec![pos(lo, lo), pos(hi, lo), pos(hi, hi), pos(lo, hi)];
        let extent = Extent { lo: pos(0, 0), hi: pos(9_000, 9_000) };
        let layers = layers(&[vec![ring(2_000, 3_000), ring(2_200, 2_800).into_iter().rev().collect()], vec![ring(1_000, 4_000)]]);
        let pieces = arrange(&extent, &layers, 0.0);
        prove_partition(&extent, &pieces);
        let of = |layer: Option<u32>| {
            pieces.iter().filter(|p| p.layer == layer).map(|p| in_steps(twice_area(&p.outline)) / 2).sum::<i64>()
        };
        assert_eq!((of(Some(0)), of(Some(1))), (1_000_000 - 360_000, 9_000_000 - 640_000));
        assert_eq!(pieces.iter().filter(|p| p.layer == Some(1)).count(), 2, "about the ring, and within it");
    }

    #[test]
    fn dust_joins_a_neighbour_and_nothing_is_lost() {
        let extent = Extent { lo: pos(0, 0), hi: pos(SIDE, SIDE) };
        let layers = layers(&[vec![vec![pos(500, 500), pos(506, 500), pos(506, 506)]]]);
        let pieces = arrange(&extent, &layers, 0.05);
        prove_partition(&extent, &pieces);
        assert_eq!(pieces.len(), 1);
        assert_eq!(pieces[0].layer, None);
    }

    /// Positions about the sides of tiles and far from them, on a coarse raster so that much coincides.
    fn position() -> impl Strategy<Value = GridPos> {
        let axis = || prop_oneof![0..24_i32, (1..3_i32, -3..4_i32).prop_map(|(tile, step)| tile * SIDE + step), -500..9_500_i32];
        (axis(), axis()).prop_map(|(x, y)| pos(x, y))
    }

    fn shapes(position: impl Strategy<Value = GridPos> + Clone) -> impl Strategy<Value = Vec<Vec<Vec<GridPos>>>> {
        let ring = proptest::collection::vec(position, 3..7);
        proptest::collection::vec(proptest::collection::vec(ring, 0..4), 1..4)
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, cases: 600, ..ProptestConfig::default() })]

        #[test]
        fn any_shapes_make_a_partition(shapes in shapes(position().boxed())) {
            let extent = Extent { lo: GridPos(0, 0), hi: pos(2 * SIDE + 777, SIDE + 5) };
            let layers = layers(&shapes);
            let pieces = arrange(&extent, &layers, 0.0);
            prove_partition(&extent, &pieces);
            let raster = (0..24).flat_map(|i| (0..14).map(move |j| (i * 361 + 13, j * 312 + 7)));
            check_covers(&extent, &layers, &pieces, raster);
            prove_partition(&extent, &arrange(&extent, &layers, 0.05));
        }

        #[test]
        fn also_where_nearly_everything_touches(shapes in shapes((-2..13_i32, -2..13_i32).prop_map(|(x, y)| pos(x, y)).boxed())) {
            let extent = Extent { lo: GridPos(0, 0), hi: pos(11, 11) };
            let layers = layers(&shapes);
            prove_partition(&extent, &arrange(&extent, &layers, 0.0));
        }
    }
}
