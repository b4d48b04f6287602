//! How deep below the streets water lies.

use veduta_city::{Block, BlockKind, CityGraph, GridPolygon, GridPos, LinkKind, Terrain, metres, ring_edges};

use super::Area;
use super::band::{pieces, stations};
use super::index::Index;
use super::streets::{width_at_m, width_m};

/// The broader water is, the deeper it lies: at least so broad, so deep, in metres. What is narrower lies as deep as the first.
const DEPTHS_M: [(f64, f64); 5] = [(0.0, 0.35), (12.0, 0.8), (24.0, 1.8), (45.0, 3.0), (90.0, 4.2)];
/// Terrain models with posts closer than so know banks, and water lies only so deep below them; metres.
const FINE_M: f64 = 8.0;
const FINE_DEPTH_M: f64 = 0.35;

/// How deep the waters of a city lie.
#[derive(Debug, Clone, Copy)]
pub(super) struct Depths {
    is_fine: bool,
}

impl Depths {
    pub fn of(terrain: Option<&Terrain>) -> Self {
        Self { is_fine: terrain.is_some_and(|terrain| terrain.step_m < FINE_M) }
    }

    /// Height above the terrain of water so broad, grid steps.
    fn z(self, width_m: f64) -> i32 {
        let depth = DEPTHS_M.iter().rev().find(|(least, _)| width_m >= *least).map_or(DEPTHS_M[0].1, |(_, depth)| *depth);
        -GridPos::steps(if self.is_fine { depth.min(FINE_DEPTH_M) } else { depth })
    }

    /// Height above the terrain of a watercourse along a link so broad, grid steps.
    pub fn of_course(self, width_m: f64) -> i32 {
        self.z(width_m)
    }

    /// Height above the terrain of the water of a block, grid steps: by its breadth, as a river's is told by area and banks.
    pub fn of_block(self, polygons: &[GridPolygon]) -> i32 {
        let area: f64 = polygons.iter().map(GridPolygon::area_m2).sum();
        let edges = polygons.iter().flat_map(GridPolygon::rings).flat_map(|ring| ring_edges(ring));
        let banks: f64 = edges.map(|(a, b)| a.to_metres().distance(b.to_metres())).sum();
        self.z(2.0 * area / banks.max(1.0))
    }
}

/// Where there is water, and how high above the terrain.
pub(super) struct Waters(Index<i32>);

impl Waters {
    pub fn of(graph: &CityGraph, areas: &[Area<'_>], depths: Depths) -> Self {
        let is_water = |block: &Block| block.kind == BlockKind::Water;
        let blocks = areas.iter().filter(|area| is_water(area.block)).flat_map(|area| {
            let z = depths.of_block(&area.polygons);
            area.polygons.iter().map(move |polygon| (polygon.clone(), z))
        });
        let at = graph.node_positions();
        let courses = graph.links.iter().filter(|link| link.kind == LinkKind::Watercourse && link.layer >= 0);
        let courses = courses.flat_map(|link| {
            let line = graph.polyline(link, &at).unwrap_or_default();
            let bands = pieces(&stations(&line, link), |share| width_at_m(link, share) / 2.0);
            bands.into_iter().map(|band| (band, depths.of_course(width_m(link))))
        });
        Self(Index::new(blocks.chain(courses).collect()))
    }

    pub fn is_none(&self) -> bool {
        self.0.is_empty()
    }

    /// How far the water at a place lies below the terrain, metres; `None` on land.
    pub fn depth_m(&self, pos: GridPos) -> Option<f64> {
        self.0.at(pos).min().map(|&z| -metres(z))
    }
}
