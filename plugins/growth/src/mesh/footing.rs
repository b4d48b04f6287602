use veduta_city::{CellShell, HouseShell, Tile, VolumeShell, metres};

use super::data::{MeshData, Paint};
use super::drape::Drape;
use super::outline::{GroundHeights, Triangulator, centre_of, engine, middle, rings, wall_edge};

/// Footings reach so far below the ground, metres.
const BELOW_M: f64 = 0.3;
/// How dark the stone is against the wall.
const SHADE: f64 = 0.72;
/// A volume whose foot is higher above the house's floor than this does not stand on the ground; metres.
const STANDING_M: f64 = 0.5;

/// Whether a volume stands on the ground.
pub(super) fn stands(house: &HouseShell, volume: &VolumeShell) -> bool {
    metres(volume.bottom) - metres(house.floor) <= STANDING_M
}

/// The stone under the walls of houses on slopes or by water whose foot is above that: from there down into it. Part of [`ground`](super::ground).
#[must_use]
pub fn footings(shell: &CellShell) -> MeshData {
    let (mut mesh, drape) = (MeshData::default(), Drape::of(shell));
    if drape.is_level() && shell.ground.iter().all(|patch| patch.z >= 0) {
        return mesh;
    }
    let ground = GroundHeights::new(shell);
    let mut triangulator = Triangulator::default();
    for house in &shell.houses {
        let first = mesh.positions.len();
        for volume in house.volumes.iter().filter(|volume| stands(house, volume)) {
            let top = metres(volume.bottom);
            if house.is_monument && volume.has_roof && !drape.is_level() {
                // A monument need not fill its footprint.
                let paint = Paint::new(centre_of(middle(&volume.footprint)), volume.colour.scaled(SHADE), Tile::Stone);
                triangulator.each(&rings(&volume.footprint), |_, corners| mesh.polygon(&corners.map(|p| engine(p, top)), paint));
            }
            for &wall in &volume.walls {
                let Some(edge) = wall_edge(&volume.footprint, wall.into()) else { continue };
                let paint = Paint::new(centre_of(edge.at(0.5)), volume.colour.scaled(SHADE), Tile::Stone);
                // Water before a wall lies deeper than the terrain.
                let below = ground.patch_before(&edge).map_or(0.0, |z| metres(z).min(0.0)) - BELOW_M;
                if drape.is_level() && below == -BELOW_M {
                    continue;
                }
                for pair in drape.way(edge.a, edge.b).windows(2) {
                    let low = [drape.y(pair[0]) + below, drape.y(pair[1]) + below].map(|y| y.min(top));
                    if low[0] < top || low[1] < top {
                        let [a, b] = [pair[0], pair[1]];
                        mesh.polygon(&[engine(a, low[0]), engine(b, low[1]), engine(b, top), engine(a, top)], paint);
                    }
                }
            }
        }
        mesh.stand(first, house.floor);
    }
    mesh
}
