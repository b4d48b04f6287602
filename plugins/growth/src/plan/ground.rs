//! The ground partition: layers laid on one another, tile by tile, so that nothing overlaps and no gap is left.

use std::collections::BTreeMap;

use rayon::prelude::*;
use veduta_city::{BorderEdge, GridPolygon, GridPos, GroundPatch, SurfaceKind, connected_faces};

use super::extent::Extent;
use super::index::Index;
use super::streets::Layer;
use super::{boolean, outline};

/// Side of a tile, grid steps (64 m). Patches are cut along tiles so that no patch has thousands of vertices.
const TILE: i32 = 64 * 1024;
/// Most tiles; in larger cities tiles grow.
const MOST_TILES: i64 = 1 << 14;
/// Pieces smaller than this (corners that a seam cuts off, leavings of the grid) join a neighbour; square metres.
const DUST_M2: f64 = 0.05;

/// The partition of the extent by the layers; what no layer covers is yard. Patches come tile by tile, south to north and west
/// to east, in order of priority.
pub(super) fn partition(extent: &Extent, layers: &[Layer]) -> Vec<GroundPatch> {
    let tiles = Tiles::new(extent);
    let mut bins: Vec<Vec<(u32, u32)>> = vec![Vec::new(); tiles.count()];
    for (l, layer) in layers.iter().enumerate() {
        for (s, shape) in layer.shapes.iter().enumerate() {
            tiles.touched(shape).for_each(|tile| bins[tile].push((l as u32, s as u32)));
        }
    }
    let of_tile = |(tile, bin): (usize, &Vec<(u32, u32)>)| partition_tile(tiles.rectangle(tile), layers, bin);
    let parts: Vec<Vec<GroundPatch>> = bins.par_iter().enumerate().map(of_tile).collect();
    parts.into_iter().flatten().collect()
}

fn partition_tile(tile: GridPolygon, layers: &[Layer], bin: &[(u32, u32)]) -> Vec<GroundPatch> {
    let (mut patches, mut dust) = (Vec::new(), Vec::new());
    let mut keep = |surface, z, found: Vec<GridPolygon>| {
        for outline in found {
            let to = if outline.area_m2() < DUST_M2 { &mut dust } else { &mut patches };
            to.push(GroundPatch { surface, outline, z });
        }
    };
    let mut rest = vec![tile];
    for here in bin.chunk_by(|a, b| a.0 == b.0) {
        let Some(layer) = here.first().and_then(|&(l, _)| layers.get(l as usize)) else { continue };
        let clip = boolean::rings(here.iter().filter_map(|&(_, s)| layer.shapes.get(s as usize)));
        let (inside, outside) = boolean::split(&boolean::rings(&rest), &clip);
        keep(layer.surface, layer.z(), inside);
        rest = outside;
        if rest.is_empty() {
            break;
        }
    }
    keep(SurfaceKind::Yard, 0, rest);
    dust.into_iter().for_each(|piece| sweep_up(piece, &mut patches));
    patches
}

/// Joins a tiny piece to the patch with which it shares the longest border; one that shares none stands alone.
fn sweep_up(dust: GroundPatch, patches: &mut Vec<GroundPatch>) {
    let Some((lo, hi)) = dust.outline.bounds() else { return };
    let is_near =
        |p: &GroundPatch| p.outline.bounds().is_some_and(|(l, h)| l.0 <= hi.0 && lo.0 <= h.0 && l.1 <= hi.1 && lo.1 <= h.1);
    let joined = |(i, patch): (usize, &GroundPatch)| {
        let whole = <[GridPolygon; 1]>::try_from(boolean::union(&boolean::rings([&patch.outline, &dust.outline])));
        let [whole] = whole.ok()?;
        Some((outline::perimeter_m(&patch.outline) - outline::perimeter_m(&whole), i, whole))
    };
    let near = patches.iter().enumerate().filter(|(_, p)| is_near(p));
    match near.filter_map(joined).max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1))) {
        Some((_, i, whole)) => patches[i].outline = whole,
        None => patches.push(dust),
    }
}

/// The yards of a partition as whole polygons, without the tiles' seams.
pub(super) fn yards(ground: &[GroundPatch]) -> Vec<GridPolygon> {
    let mut borders: Vec<BorderEdge> = Vec::new();
    // Edges along an axis, by axis and line: where two run against each other, they are a seam.
    let mut level: BTreeMap<(bool, i32), Vec<(i32, i32)>> = BTreeMap::new();
    let rings = ground.iter().filter(|p| p.surface == SurfaceKind::Yard).flat_map(|p| p.outline.rings());
    for (a, b) in rings.flat_map(|ring| outline::edges(ring)) {
        if a.0 == b.0 {
            level.entry((true, a.0)).or_default().push((a.1, b.1));
        } else if a.1 == b.1 {
            level.entry((false, a.1)).or_default().push((a.0, b.0));
        } else {
            borders.push((a, b));
        }
    }
    for ((is_upright, line), runs) in level {
        let at = |v: i32| if is_upright { GridPos(line, v) } else { GridPos(v, line) };
        borders.extend(unopposed(&runs).into_iter().map(|(from, to)| (at(from), at(to))));
    }
    connected_faces(borders, false)
}

/// The pieces of runs along a line that no run in the other direction covers.
fn unopposed(runs: &[(i32, i32)]) -> Vec<(i32, i32)> {
    let mut turns: BTreeMap<i32, i32> = BTreeMap::new();
    for &(from, to) in runs {
        // What runs backward closes before it opens.
        *turns.entry(from).or_default() += 1;
        *turns.entry(to).or_default() -= 1;
    }
    let mut open = 0;
    let mut pieces = Vec::new();
    let mut before: Option<i32> = None;
    for (v, turn) in turns {
        if let Some(from) = before.filter(|_| open != 0) {
            pieces.push(if open > 0 { (from, v) } else { (v, from) });
        }
        open += turn;
        before = Some(v);
    }
    pieces
}

/// The extent cut into tiles.
struct Tiles {
    extent: Extent,
    side: i64,
    columns: i64,
    rows: i64,
}

impl Tiles {
    fn new(extent: &Extent) -> Self {
        let (w, h) = (i64::from(extent.hi.0) - i64::from(extent.lo.0), i64::from(extent.hi.1) - i64::from(extent.lo.1));
        let mut side = i64::from(TILE);
        let count = |extent: i64, side: i64| ((extent + side - 1) / side).max(1);
        while count(w, side) * count(h, side) > MOST_TILES {
            side *= 2;
        }
        Self { extent: *extent, side, columns: count(w, side), rows: count(h, side) }
    }

    fn count(&self) -> usize {
        (self.columns * self.rows) as usize
    }

    fn rectangle(&self, tile: usize) -> GridPolygon {
        let (column, row) = (tile as i64 % self.columns, tile as i64 / self.columns);
        let at = |lo: i32, hi: i32, i: i64| (i64::from(lo) + i * self.side).min(i64::from(hi)) as i32;
        let (lo, hi) = (self.extent.lo, self.extent.hi);
        let corner = |c, r| GridPos(at(lo.0, hi.0, c), at(lo.1, hi.1, r));
        Extent { lo: corner(column, row), hi: corner(column + 1, row + 1) }.polygon()
    }

    /// Tiles that the bounds of a shape touch.
    fn touched(&self, shape: &GridPolygon) -> impl Iterator<Item = usize> + use<> {
        let (lo, hi) = (self.extent.lo, self.extent.hi);
        let range = |a: i32, b: i32, base: i32, end: i32, n: i64| {
            if b < base || a > end {
                return 0..0;
            }
            let cell = |v: i32| ((i64::from(v) - i64::from(base)) / self.side).clamp(0, n - 1);
            cell(a)..cell(b) + 1
        };
        let (columns, rows) = shape
            .bounds()
            .map_or((0..0, 0..0), |(a, b)| (range(a.0, b.0, lo.0, hi.0, self.columns), range(a.1, b.1, lo.1, hi.1, self.rows)));
        let width = self.columns;
        rows.flat_map(move |row| columns.clone().map(move |column| (row * width + column) as usize))
    }
}

/// What lies where on the ground.
pub(super) type Ground = Index<(SurfaceKind, i32)>;

/// An index of the ground's patches.
pub(super) fn index(patches: &[GroundPatch]) -> Ground {
    Index::new(patches.iter().map(|p| (p.outline.clone(), (p.surface, p.z))).collect())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::plan::streets::Rank;

    fn rectangle(x: i32, y: i32, w: i32, h: i32) -> GridPolygon {
        Extent { lo: GridPos(x * 1024, y * 1024), hi: GridPos((x + w) * 1024, (y + h) * 1024) }.polygon()
    }

    #[test]
    fn higher_layers_win_and_yards_fill_the_rest() {
        let extent = Extent { lo: GridPos(0, 0), hi: GridPos(200 * 1024, 100 * 1024) };
        let layers = [
            Layer { rank: Rank::Pavement, surface: SurfaceKind::Mosaic, shapes: vec![rectangle(-10, 40, 400, 10)] },
            Layer {
                rank: Rank::Park,
                surface: SurfaceKind::Grass,
                shapes: vec![rectangle(50, 0, 50, 100), rectangle(60, 0, 50, 100)],
            },
        ];
        let patches = partition(&extent, &layers);
        let area = |surface| patches.iter().filter(|p| p.surface == surface).map(|p| p.outline.area_m2()).sum::<f64>();
        assert_eq!(area(SurfaceKind::Mosaic), 2000.0);
        assert_eq!(area(SurfaceKind::Grass), 60.0 * 90.0);
        assert_eq!(area(SurfaceKind::Yard), 20_000.0 - 2000.0 - 5400.0);
        let ground = index(&patches);
        assert!(ground.at(GridPos(70 * 1024, 45 * 1024)).eq([&(SurfaceKind::Mosaic, 123)]));
    }

    #[test]
    fn yards_are_whole_across_tiles() {
        let extent = Extent { lo: GridPos(0, 0), hi: GridPos(300 * 1024, 300 * 1024) };
        let lane = |x: i32, y: i32, w: i32, h: i32| rectangle(x, y, w, h);
        let slanted =
            GridPolygon::simple([(-10, 100), (-10, 90), (310, 187), (310, 197)].map(|(x, y)| GridPos(x * 1024, y * 1024)).to_vec());
        let shapes = vec![lane(-10, 20, 400, 5), lane(20, -10, 5, 400), lane(270, -10, 4, 400), slanted, lane(128, 230, 64, 34)];
        let layers = [Layer { rank: Rank::Lane, surface: SurfaceKind::Cobbles, shapes }];
        let whole = boolean::difference(&boolean::rings([&extent.polygon()]), &boolean::rings(&layers[0].shapes));
        let area = |of: &[GridPolygon]| {
            let mut areas: Vec<i64> = of.iter().map(|p| libm::round(p.area_m2() * 10.0) as i64).collect();
            areas.sort_unstable();
            areas
        };
        let yards = yards(&partition(&extent, &layers));
        assert_eq!(area(&yards), area(&whole));
        assert!(yards.iter().any(|y| y.holes.len() == 1), "the lone patch is a hole");
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, cases: 64, ..ProptestConfig::default() })]

        #[test]
        fn every_position_lies_on_one_patch_also_on_the_seams(
            quads in proptest::collection::vec((0..200_i32, 0..200_i32, 1..90_i32, 1..90_i32, -40..40_i32), 1..12),
        ) {
            let extent = Extent { lo: GridPos(0, 0), hi: GridPos(200 * 1024, 200 * 1024) };
            let shape = |&(x, y, w, h, skew): &(i32, i32, i32, i32, i32)| {
                GridPolygon::simple([(x, y), (x + w, y + skew), (x + w, y + skew + h), (x, y + h)].map(|(x, y)| GridPos(x * 1024, y * 1024)).to_vec())
            };
            let layers = [Layer { rank: Rank::Lane, surface: SurfaceKind::Cobbles, shapes: quads.iter().map(shape).collect() }];
            let ground = index(&partition(&extent, &layers));
            for i in 0..400 {
                for seam in [64, 128, 192] {
                    for p in [GridPos(seam * 1024, i * 512), GridPos(i * 512, seam * 1024)] {
                        prop_assert_eq!(ground.at(p).count(), 1, "{:?}", p);
                    }
                }
            }
        }
    }
}
