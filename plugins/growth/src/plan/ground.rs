//! The ground partition: layers laid on one another so that nothing overlaps and no gap is left.

use veduta_city::{BorderEdge, GridPolygon, GridPos, GroundPatch, SurfaceKind, connected_faces, ring_edges};

use super::arrangement::arrange;
use super::extent::Extent;
use super::index::Index;
use super::streets::Layer;

/// Pieces smaller than this join a neighbour; square metres.
const DUST_M2: f64 = 0.05;

/// The partition of the extent by the layers; what no layer covers is yard. Patches come tile by tile, south to north and west
/// to east, in order of priority.
pub(super) fn partition(extent: &Extent, layers: &[Layer]) -> Vec<GroundPatch> {
    let pieces = arrange(extent, layers, DUST_M2).into_iter();
    let patch = |piece: super::arrangement::Piece| {
        let layer = piece.layer.and_then(|layer| layers.get(usize::from(layer)));
        let (surface, z) = layer.map_or((SurfaceKind::Yard, 0), |layer| (layer.surface, layer.z()));
        GroundPatch { surface, outline: piece.outline, z }
    };
    pieces.map(patch).collect()
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
pub(super) type Ground = Index<(SurfaceKind, i32)>;

/// An index of the ground's patches.
pub(super) fn index(patches: &[GroundPatch]) -> Ground {
    Index::new(patches.iter().map(|p| (p.outline.clone(), (p.surface, p.z))).collect())
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
