//! How high the ground floors of houses lie.

use glam::DVec2;
use rayon::prelude::*;
use veduta_city::{GridPos, PlanTerrain};

use super::facing::{Edge, Facing};
use super::houses::Draft;
use super::walls::DOORSTEP;

/// Streets may rise so far above a ground floor along the house's front, metres: below its windows.
const DEEPEST_M: f64 = 0.7;

/// Most that a house is raised or sunk for the sake of its door, metres.
const MOST_M: f64 = 2.0;
/// Where a door is in its bay.
const DOOR: (f64, f64) = (0.25, 0.75);

/// About where the floor of every house will be, grid steps above the city's zero: the ground before the middle of its longest front
/// to a street, or higher where the street would otherwise rise to the windows. Its door decides in the end: see [`threshold`].
pub(super) fn floors(drafts: &[Draft], facing: &Facing, terrain: &PlanTerrain) -> Vec<i32> {
    if terrain.is_level() {
        return vec![0; drafts.len()];
    }
    let floor = |(house, draft): (usize, &Draft)| {
        let on_ground = draft.bodies.iter().enumerate().filter(|(_, body)| GridPos::steps(body.bottom_m) <= DOORSTEP);
        let mut all: Vec<Edge> = on_ground.flat_map(|(b, body)| facing.of_body((house, b), &body.footprint)).collect();
        if all.is_empty() {
            // A house that hangs: what it hangs over.
            all = facing.of_house(house, draft).collect();
        }
        let fronts: Vec<Edge> = all.iter().copied().filter(|edge| edge.is_public).collect();
        let fronts = if fronts.is_empty() { all } else { fronts };
        let longest = fronts.iter().max_by(|e, f| e.length_m().total_cmp(&f.length_m()));
        let Some(door) = longest.map(|edge| terrain.height_m((edge.a() + edge.b()) / 2.0)) else { return 0 };
        let highest = longest.map_or(door, |edge| terrain.range_along(edge.a(), edge.b()).1);
        GridPos::steps(door.max(highest - DEEPEST_M))
    };
    drafts.par_iter().enumerate().map(floor).collect()
}

/// How much a floor has to rise (or sink) so that no ground before a door lies above its threshold; grid steps.
pub(super) fn threshold((_, highest_m): (f64, f64)) -> i32 {
    GridPos::steps(highest_m.clamp(-MOST_M, MOST_M))
}

/// Lowest and highest ground before a bay of a wall, above a floor; metres.
pub(super) fn before_bay(terrain: &PlanTerrain, floor_m: f64, (a, b): (DVec2, DVec2), bay: u8, bays: u8) -> (f64, f64) {
    let at = |i: f64| a.lerp(b, i / f64::from(bays.max(1)));
    let (low, high) = terrain.range_along(at(f64::from(bay) + DOOR.0), at(f64::from(bay) + DOOR.1));
    (low - floor_m, high - floor_m)
}
