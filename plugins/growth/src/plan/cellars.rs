//! Storeys below the ground floor of houses on steep slopes, where the ground before their lower walls falls away.

use rayon::prelude::*;
use veduta_city::{Gable, GroundFloor, House, Opening, PlanRoof, PlanTerrain, RoofShape, Storey, Volume, Wall, WallKind, metres};

use super::walls::{DOORSTEP, SILL_M};

/// Lowest and highest storey of a cellar, grid steps.
const STOREY: (i32, i32) = (2_660, 3_700);
/// A storey of which this share would show above the ground is built.
const LEAST_SHARE: f64 = 0.8;
/// Most storeys of cellars; below them there is a footing.
const MOST: i32 = 8;

/// Builds cellars under the houses that need them.
pub(super) fn build(houses: &mut [House], terrain: &PlanTerrain) {
    if terrain.is_level() {
        return;
    }
    houses.par_iter_mut().filter(|house| house.monument.is_none()).for_each(|house| {
        let floor = house.floor;
        let on_ground = house.volumes.iter().filter(|volume| volume.bottom.saturating_sub(floor) <= DOORSTEP);
        let cellars: Vec<Volume> = on_ground.filter_map(|volume| cellar(volume, terrain)).collect();
        if let Some(lowest) = cellars.iter().map(|cellar| cellar.bottom).min() {
            house.floor = lowest;
            house.volumes.extend(cellars);
        }
    });
}

/// The cellar under a volume, if the ground before its open walls is a storey lower than its foot.
fn cellar(above: &Volume, terrain: &PlanTerrain) -> Option<Volume> {
    let edges = || above.walls.iter().zip(above.footprint.edges().map(|(a, b)| (a.to_metres(), b.to_metres())));
    let open = edges().filter(|(wall, _)| wall.kind != WallKind::Party);
    let lowest = open.map(|(_, (a, b))| terrain.range_along(a, b).0).fold(f64::INFINITY, f64::min);
    let depth = metres(above.bottom) - lowest;
    let upper =
        above.walls.iter().filter_map(|wall| wall.storeys.get(1).or(wall.storeys.first())).map(|storey| storey.height).max()?;
    let height = upper.clamp(STOREY.0, STOREY.1);
    let count = (libm::floor(depth / metres(height) + 1.0 - LEAST_SHARE) as i32).clamp(0, MOST);
    if count == 0 || !depth.is_finite() {
        return None;
    }
    let bottom = above.bottom.saturating_sub(count * height);
    let walls = edges().map(|(wall, (a, b))| {
        let ground = |share: f64| terrain.height_m(a.lerp(b, share)) - metres(bottom);
        cellar_wall(wall, terrain.range_along(a, b).1 - metres(bottom), ground, (count, height))
    });
    Some(Volume {
        footprint: above.footprint.clone(),
        bottom,
        eaves: above.bottom,
        colour: above.colour,
        trim: above.trim,
        roof: PlanRoof { shape: RoofShape::Flat, height: PlanRoof::NONE, direction: 0, colour: above.roof.colour },
        gable: Gable::Plain,
        walls: walls.collect(),
        arcades: Vec::new(),
    })
}

/// A wall of a cellar under another: windows under its windows, where they are not in the ground. `highest_m` and `ground_m` (by the
/// share of the wall's length) are above the cellar's foot.
fn cellar_wall(above: &Wall, highest_m: f64, ground_m: impl Fn(f64) -> f64, (count, height): (i32, i32)) -> Wall {
    let window = above.storeys.get(1).or(above.storeys.first()).map_or(Opening::Blank, |storey| match storey.opening {
        Opening::Blank | Opening::Slit | Opening::Belfry | Opening::Clock => Opening::Blank,
        _ => Opening::Window,
    });
    if above.kind == WallKind::Party || above.bays == 0 || window == Opening::Blank {
        return Wall { kind: above.kind, ..Wall::default() };
    }
    let clears = |storey: i32, ground_m: f64| ground_m <= metres(storey * height) + SILL_M;
    let at = |bay: u8, of_bay: f64| ground_m((f64::from(bay) + of_bay) / f64::from(above.bays));
    let is_blank = |bay: &u8| [0.2, 0.8].into_iter().any(|of_bay| !clears(0, at(*bay, of_bay)));
    let blank = (0..above.bays.min(32)).filter(is_blank).fold(0, |bits, bay| bits | 1 << bay);
    let opening = |storey: i32| {
        let is_open = if storey == 0 { above.bays <= 32 || clears(0, highest_m) } else { clears(storey, highest_m) };
        if is_open { window } else { Opening::Blank }
    };
    let storeys = (0..count).map(|storey| Storey { height, opening: opening(storey) }).collect();
    let ground_floor = GroundFloor { blank, ..GroundFloor::default() };
    Wall { kind: above.kind, bays: above.bays, storeys, ground_floor, ornament: None }
}
