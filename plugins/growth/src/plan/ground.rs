//! The ground partition: layers laid on one another so that nothing overlaps and no gap is left.

use rayon::prelude::*;
use veduta_city::{BorderEdge, GridPolygon, GridPos, GroundPatch, SurfaceKind, connected_faces, ring_edges};

use super::arrangement::arrange;
use super::extent::Extent;
use super::groups::Groups;
use super::index::Index;
use super::inradius::inradius_m;
use super::lots::NARROWEST_SITE_M;
use super::streets::Layer;
use super::{outline, relation};

/// Pieces smaller than this join a neighbour; square metres.
const DUST_M2: f64 = 0.05;

/// The partition of the extent by the layers; what no layer covers is yard. Patches come tile by tile, south to north and west
/// to east, in order of priority.
pub(super) fn partition(extent: &Extent, layers: &[Layer]) -> Vec<GroundPatch> {
    let pieces = arrange(extent, layers, DUST_M2).into_iter();
    let patch = |piece: super::arrangement::Piece| {
        let layer = piece.layer.and_then(|layer| layers.get(layer as usize));
        let (surface, z) = layer.map_or((SurfaceKind::Yard, 0), |layer| (layer.surface, layer.z));
        GroundPatch { surface, outline: piece.outline, z, course: layer.and_then(|layer| layer.course) }
    };
    pieces.map(patch).collect()
}

/// Paves the yards that are mere verges: too narrow to be built on, within the extent, without a given house on them. Maps draw
/// carriageways and footways as lines, and what is left between them is a part of the street.
pub(super) fn pave_verges<T: Sync>(ground: &mut [GroundPatch], extent: &Extent, houses: &Index<T, &GridPolygon>) {
    let is_yard = |patch: &GroundPatch| patch.surface == SurfaceKind::Yard;
    let mut edges: Vec<(GridPos, GridPos, bool, u32)> = Vec::new();
    for (patch, i) in ground.iter().zip(0..).filter(|(patch, _)| is_yard(patch)) {
        edges.extend(patch.outline.edges().map(|(a, b)| (a.min(b), a.max(b), a < b, i)));
    }
    edges.sort_unstable();
    let mut regions = Groups::new(ground.len());
    let mut borders: Vec<(u32, BorderEdge)> = Vec::new();
    for same in edges.chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)) {
        match *same {
            [(.., i), (.., j)] => regions.join(i, j),
            [(a, b, is_forward, i), ..] => borders.push((i, if is_forward { (a, b) } else { (b, a) })),
            [] => {}
        }
    }
    borders.iter_mut().for_each(|border| border.0 = regions.of(border.0));
    borders.sort_unstable();
    let is_outer = |&(_, (a, b)): &(u32, BorderEdge)| {
        a.0 == b.0 && (a.0 == extent.lo.0 || a.0 == extent.hi.0) || a.1 == b.1 && (a.1 == extent.lo.1 || a.1 == extent.hi.1)
    };
    let by_region: Vec<&[(u32, BorderEdge)]> = borders.chunk_by(|a, b| a.0 == b.0).collect();
    let is_verge = |border: &&[(u32, BorderEdge)]| {
        if border.iter().any(is_outer) {
            return false;
        }
        let whole = connected_faces(border.iter().map(|edge| edge.1).collect(), false);
        whole.iter().all(|yard| is_narrow(yard) && houses.near(yard, 0.0).iter().all(|(house, _)| !relation::may_meet(house, yard)))
    };
    let verges: Vec<u32> = by_region.par_iter().filter(|border| is_verge(border)).map(|border| border[0].0).collect();
    for (i, patch) in ground.iter_mut().enumerate().filter(|(_, patch)| is_yard(patch)) {
        if verges.binary_search(&regions.of(i as u32)).is_ok() {
            patch.surface = SurfaceKind::Mosaic;
        }
    }
}

/// Whether no house would be built on a yard.
fn is_narrow(yard: &GridPolygon) -> bool {
    // The radius of the largest disc within is at least area by perimeter.
    2.0 * yard.area_m2() < NARROWEST_SITE_M * outline::perimeter_m(yard)
        && 2.0 * inradius_m(yard, NARROWEST_SITE_M) < NARROWEST_SITE_M
}

/// The yards of a partition as whole polygons, without the tiles' seams.
pub(super) fn yards(ground: &[GroundPatch]) -> Vec<GridPolygon> {
    let rings = ground.iter().filter(|p| p.surface == SurfaceKind::Yard).flat_map(|p| p.outline.rings());
    // Where a patch joins the next, the same edge runs once each way.
    let mut edges: Vec<(GridPos, GridPos, bool)> =
        rings.flat_map(|ring| ring_edges(ring)).map(|(a, b)| if a < b { (a, b, true) } else { (b, a, false) }).collect();
    edges.sort_unstable();
    let lone = edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).filter(|same| same.len() == 1);
    let border = |&(a, b, is_forward): &(GridPos, GridPos, bool)| -> BorderEdge { if is_forward { (a, b) } else { (b, a) } };
    connected_faces(lone.flatten().map(border).collect(), false)
}

/// What lies where on the ground.
pub(super) type Ground<'a> = Index<(SurfaceKind, i32), &'a GridPolygon>;

/// An index of the ground's patches.
pub(super) fn index(patches: &[GroundPatch]) -> Ground<'_> {
    Index::new(patches.iter().map(|p| (&p.outline, (p.surface, p.z))).collect())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::plan::boolean;
    use crate::plan::streets::Rank;

    fn rectangle(x: i32, y: i32, w: i32, h: i32) -> GridPolygon {
        Extent { lo: GridPos(x * 1024, y * 1024), hi: GridPos((x + w) * 1024, (y + h) * 1024) }.polygon()
    }

    #[test]
    fn higher_layers_win_and_yards_fill_the_rest() {
        let extent = Extent { lo: GridPos(0, 0), hi: GridPos(200 * 1024, 100 * 1024) };
        let layers = [
            Layer::new(Rank::Pavement, SurfaceKind::Mosaic, vec![rectangle(-10, 40, 400, 10)]),
            Layer::new(Rank::Park, SurfaceKind::Grass, vec![rectangle(50, 0, 50, 100), rectangle(60, 0, 50, 100)]),
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
    fn verges_are_paved_and_yards_are_not() {
        let extent = Extent { lo: GridPos(0, 0), hi: GridPos(300 * 1024, 200 * 1024) };
        // Two strips of 4 m beside a street, over the sides of tiles, a house on one of them; a yard of 20 m with a strip of 40 m
        // by 2 m; the land about it all.
        let (street, beside) = (rectangle(10, 100, 280, 10), [rectangle(10, 94, 280, 2), rectangle(10, 114, 280, 2)]);
        let (ends, yard) = ([rectangle(8, 94, 2, 22), rectangle(290, 94, 2, 22)], rectangle(40, 40, 20, 20));
        let shapes = [street].into_iter().chain(beside).chain(ends).collect();
        let strip = rectangle(60, 50, 60, 2);
        let yard = boolean::union(&boolean::rings([&yard, &strip])).remove(0);
        let frame = GridPolygon { holes: vec![yard.outer.iter().rev().copied().collect()], ..rectangle(30, 30, 100, 40) };
        let layers =
            [Layer::new(Rank::Lane, SurfaceKind::Cobbles, shapes), Layer::new(Rank::Path, SurfaceKind::Gravel, vec![frame])];
        let mut ground = partition(&extent, &layers);
        pave_verges(&mut ground, &extent, &Index::new(vec![(&rectangle(100, 111, 3, 2), ())]));
        let paved: Vec<&GroundPatch> = ground.iter().filter(|p| p.surface == SurfaceKind::Mosaic).collect();
        assert!((paved.iter().map(|p| p.outline.area_m2()).sum::<f64>() - 280.0 * 4.0).abs() < 1e-6);
        assert!(paved.iter().all(|p| p.outline.bounds().is_some_and(|(lo, hi)| lo.1 >= 96 * 1024 && hi.1 <= 100 * 1024)));
    }

    #[test]
    fn yards_are_whole_across_tiles() {
        let extent = Extent { lo: GridPos(0, 0), hi: GridPos(300 * 1024, 300 * 1024) };
        let lane = |x: i32, y: i32, w: i32, h: i32| rectangle(x, y, w, h);
        let slanted =
            GridPolygon::simple([(-10, 100), (-10, 90), (310, 187), (310, 197)].map(|(x, y)| GridPos(x * 1024, y * 1024)).to_vec());
        let shapes = vec![lane(-10, 20, 400, 5), lane(20, -10, 5, 400), lane(270, -10, 4, 400), slanted, lane(128, 230, 64, 34)];
        let layers = [Layer::new(Rank::Lane, SurfaceKind::Cobbles, shapes)];
        let whole = boolean::difference(&boolean::rings([&extent.polygon()]), &boolean::rings(&layers[0].shapes));
        let area = |of: &[GridPolygon]| {
            let mut areas: Vec<f64> = of.iter().map(GridPolygon::area_m2).collect();
            areas.sort_by(f64::total_cmp);
            areas
        };
        let yards = yards(&partition(&extent, &layers));
        // A slanted edge is bent by half a step of the plan where it crosses a seam.
        let (found, want) = (area(&yards), area(&whole));
        assert!(found.len() == want.len() && found.iter().zip(&want).all(|(a, b)| (a - b).abs() < 0.6), "{found:?} {want:?}");
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
            let layers = [Layer::new(Rank::Lane, SurfaceKind::Cobbles, quads.iter().map(shape).collect())];
            let patches = partition(&extent, &layers);
            let ground = index(&patches);
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
