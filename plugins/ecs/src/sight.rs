use bevy::ecs::system::SystemParam;
use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use veduta_city::{GridPos, Massing, metres};

use crate::{Around, City, Ground};

/// What a line of sight meets first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight<'a> {
    /// Where, plan metres and elevation.
    pub at: DVec3,
    /// How far along the line: a multiple of its direction.
    pub along: f64,
    /// The house whose wall or roof is met; without one, it is the ground.
    pub house: Option<&'a Massing>,
}

/// Lines of sight among the houses and over the ground of the open city, as far as its overview is here.
#[derive(SystemParam)]
pub struct Sights<'w> {
    city: Option<Res<'w, City>>,
    ground: Ground<'w>,
}

/// No house reaches so far from its outline's first corner, metres.
const HOUSE_M: f64 = 60.0;

impl Sights<'_> {
    fn houses(&self, around: DVec2, reach_m: f64) -> impl Iterator<Item = &Massing> {
        let near = Around { middle: around, radius_m: reach_m };
        let is_near = move |house: &&Massing| {
            house.outline.outer.first().is_some_and(|p| p.to_metres().distance_squared(around) < (reach_m + HOUSE_M).powi(2))
        };
        let overviews = self.city.as_ref().map(|city| &city.overviews);
        overviews.into_iter().flat_map(move |all| all.near(near)).flat_map(|part| &part.houses).filter(is_near)
    }

    /// What a line meets first, no farther than it reaches in metres of plan. It begins at an elevation, over ground that is about so high.
    #[must_use]
    pub fn along(&self, from: DVec3, way: DVec3, reach_m: f64, near_m: f64) -> Option<Sight<'_>> {
        meet(self.houses(from.truncate(), reach_m), from, way, reach_m, |pos| self.ground.at(pos, near_m))
    }

    /// Whether no house is at a place, nor within so many metres beside it, east, north, west or south; above a roof nothing is.
    #[must_use]
    pub fn is_free(&self, at: DVec3, beside_m: f64) -> bool {
        let (pos, ground_m) = (at.truncate(), self.ground.at(at.truncate(), at.z));
        let beside =
            [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y].map(|way| GridPos::from_metres(pos + way * beside_m));
        let is_in = |house: &Massing| at.z < ground_m + metres(house.height) && beside.iter().any(|&p| house.outline.contains(p));
        !self.houses(pos, beside_m).any(is_in)
    }

    /// From where on, and up to where, a line is free that begins at a house of its own or nowhere: how far along it. The line may lead out of its
    /// own house, told by [`house_key`], and back into it; it ends before any other, and before the ground. No further than it reaches.
    #[must_use]
    pub fn room(&self, from: DVec3, way: DVec3, reach_m: f64, own: Option<GridPos>) -> (f64, f64) {
        let (here, ground_m) = (GridPos::from_metres(from.truncate()), self.ground.at(from.truncate(), from.z));
        let is_own = |house: &Massing| own.is_some() && own == house_key(house);
        let houses = || self.houses(from.truncate(), reach_m);
        if houses().any(|h| !is_own(h) && h.outline.contains(here) && from.z < ground_m + metres(h.height)) || from.z < ground_m {
            return (0.0, 0.0);
        }
        let least =
            houses().filter(|house| is_own(house)).filter_map(|house| leaves(house, from, way, ground_m)).fold(0.0, f64::max);
        let others = houses().filter(|house| !is_own(house));
        let met = meet(others, from, way, reach_m, |pos| self.ground.at(pos, from.z));
        (least, met.map_or(reach_m, |met| met.along.min(reach_m)))
    }
}

/// What tells a house from all others: its outline's first corner.
#[must_use]
pub fn house_key(house: &Massing) -> Option<GridPos> {
    house.outline.outer.first().copied()
}

/// Where a line is out of a house for good: how far along it. `None` where it never is within.
fn leaves(house: &Massing, from: DVec3, way: DVec3, ground_m: f64) -> Option<f64> {
    let (a, d) = (from.truncate(), way.truncate());
    let top_m = ground_m + metres(house.height);
    let edges = house.outline.rings().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
    let walls = edges.filter_map(|(p, q)| {
        let (p, edge) = (p.to_metres(), q.to_metres() - p.to_metres());
        let across = d.perp_dot(edge);
        let (t, u) = ((p - a).perp_dot(edge) / across, (p - a).perp_dot(d) / across);
        (t > 0.0 && (0.0..=1.0).contains(&u) && from.z + way.z * t <= top_m).then_some(t)
    });
    let roof = (top_m - from.z) / way.z;
    let is_roof = roof > 0.0 && roof.is_finite() && house.outline.contains(GridPos::from_metres(a + d * roof));
    walls.chain(is_roof.then_some(roof)).max_by(f64::total_cmp)
}

/// Where a line of sight meets the wall or the roof of a house: how far along it.
fn meets(house: &Massing, from: DVec3, way: DVec3, ground_m: f64) -> Option<f64> {
    let (a, d) = (from.truncate(), way.truncate());
    let top_m = ground_m + metres(house.height);
    let height_at = |t: f64| from.z + way.z * t;
    let mut first: Option<f64> = None;
    for ring in house.outline.rings() {
        for (n, p) in ring.iter().enumerate() {
            let (p, q) = (p.to_metres(), ring[(n + 1) % ring.len()].to_metres());
            let edge = q - p;
            let across = d.perp_dot(edge);
            if across.abs() < 1e-12 {
                continue;
            }
            let (t, u) = ((p - a).perp_dot(edge) / across, (p - a).perp_dot(d) / across);
            if t > 0.0 && (0.0..=1.0).contains(&u) && height_at(t) <= top_m && first.is_none_or(|first| t < first) {
                first = Some(t);
            }
        }
    }
    // From above, through the roof.
    if way.z < 0.0 {
        let t = (top_m - from.z) / way.z;
        if t > 0.0 && first.is_none_or(|first| t < first) && house.outline.contains(GridPos::from_metres(a + d * t)) {
            first = Some(t);
        }
    }
    first
}

/// What a line of sight meets first among houses and the ground, whose height is asked for.
fn meet<'a>(
    houses: impl Iterator<Item = &'a Massing>,
    from: DVec3,
    way: DVec3,
    reach_m: f64,
    ground_at: impl Fn(DVec2) -> f64,
) -> Option<Sight<'a>> {
    let flat = way.truncate().length();
    let here_m = ground_at(from.truncate());
    let most = if flat > 1e-9 { reach_m / flat } else { f64::INFINITY };
    let walls = houses.filter_map(|house| meets(house, from, way, here_m).map(|t| (t, house)));
    let wall = walls.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(t, _)| *t <= most);
    let over = |t: f64| from.z + way.z * t - ground_at(from.truncate() + way.truncate() * t);
    let ground = first_below(most.min(reach_m / way.length().max(1e-9)), way.length(), over);
    let sight = |along: f64, house| Sight { at: from + way * along, along, house };
    match (wall, ground) {
        (Some((t, house)), ground) if ground.is_none_or(|ground| t <= ground) => Some(sight(t, Some(house))),
        (_, Some(ground)) => Some(sight(ground, None)),
        _ => None,
    }
}

/// Where a height over the ground, told along a line, first falls to nothing: in steps that grow with the distance, then by halves.
fn first_below(most: f64, pace: f64, over: impl Fn(f64) -> f64) -> Option<f64> {
    const HALVES: usize = 16;
    let mut t = 0.0;
    while t < most {
        let step = (0.5 + 0.04 * t * pace) / pace.max(1e-9);
        let next = (t + step).min(most);
        if over(next) <= 0.0 {
            let (mut above, mut below) = (t, next);
            for _ in 0..HALVES {
                let middle = (above + below) / 2.0;
                if over(middle) > 0.0 { above = middle } else { below = middle }
            }
            return Some(below);
        }
        t = next;
    }
    None
}

#[cfg(test)]
mod tests {
    use veduta_city::GridPolygon;

    use super::*;

    fn house(x: i32, y: i32, half: i32, height_m: i32) -> Massing {
        let corner = |a: i32, b: i32| GridPos((x + a * half) * 1024, (y + b * half) * 1024);
        Massing::block(GridPolygon::simple(vec![corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)]), height_m * 1024)
    }

    const EYE: DVec3 = DVec3::new(0.0, 0.0, 1.65);

    #[test]
    fn the_nearest_wall_roof_or_ground_is_met() {
        let town = [house(20, 0, 5, 10), house(40, 0, 5, 30)];
        let look = |way: DVec3| meet(town.iter(), EYE, way, 200.0, |_| 0.0);
        let met = look(DVec3::X).expect("a wall");
        assert_eq!((met.house, met.at, met.along), (Some(&town[0]), DVec3::new(15.0, 0.0, 1.65), 15.0));
        let met = look(DVec3::new(1.0, 0.0, 0.6)).expect("a wall");
        assert_eq!(met.house, Some(&town[1]), "over the first one's roof");
        assert_eq!(look(DVec3::new(1.0, 0.0, 3.0)), None, "the sky");
        assert_eq!(look(DVec3::NEG_X), None, "nothing as far as it reaches");
        let met = look(DVec3::new(0.0, 1.0, -0.165)).expect("the ground");
        assert!(met.house.is_none() && met.at.distance(DVec3::new(0.0, 10.0, 0.0)) < 0.01, "{met:?}");
        let above = DVec3::new(20.0, 0.0, 60.0);
        let down = meet(town.iter(), above, DVec3::NEG_Z, 200.0, |_| 0.0).expect("a roof");
        assert_eq!((down.house, down.at.z), (Some(&town[0]), 10.0), "its roof, from above");
    }

    #[test]
    fn a_line_leaves_its_house_by_the_far_wall_or_the_roof() {
        let block = house(20, 0, 5, 10);
        let leaves = |from: DVec3, way: DVec3| leaves(&block, from, way, 0.0);
        assert_eq!(leaves(DVec3::new(16.0, 0.0, 2.0), DVec3::X), Some(9.0), "from within");
        assert_eq!(leaves(DVec3::new(10.0, 0.0, 2.0), DVec3::X), Some(15.0), "through it");
        assert_eq!(leaves(DVec3::new(14.0, 0.0, 2.0), DVec3::NEG_X), None, "away from it");
        assert_eq!(leaves(DVec3::new(20.0, 0.0, 2.0), DVec3::Z), Some(8.0), "up");
        assert_eq!(leaves(DVec3::new(10.0, 0.0, 2.0), DVec3::new(1.0, 0.0, 1.0)), Some(8.0), "in by the wall and out by the roof");
    }

    #[test]
    fn on_a_slope_the_ground_is_where_it_is() {
        let slope = |pos: DVec2| pos.x * 0.1;
        let met = meet(core::iter::empty(), EYE, DVec3::new(1.0, 0.0, -0.1), 200.0, slope).expect("the ground");
        let over = met.at.z - slope(met.at.truncate());
        assert!(over.abs() < 0.01, "{over} m above it at {met:?}");
    }
}
