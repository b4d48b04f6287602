use bevy::math::DVec2;
use veduta_city::{GridPolygon, GridPos, Overview, SurfaceKind};

/// What nobody walks through: houses and water.
pub(crate) struct Obstacles<'a>(Vec<Obstacle<'a>>);

struct Obstacle<'a> {
    low: DVec2,
    high: DVec2,
    outline: &'a GridPolygon,
}

/// So near to a wall nobody walks along it, metres.
const BESIDE_M: f64 = 0.4;

impl<'a> Obstacles<'a> {
    /// Those of a part of a city.
    pub fn of(overview: &'a Overview) -> Self {
        let water = overview.ground.iter().filter(|patch| patch.surface == SurfaceKind::Water).map(|patch| &patch.outline);
        let houses = overview.houses.iter().map(|house| &house.outline);
        let obstacle = |outline: &'a GridPolygon| {
            let corners = || outline.outer.iter().map(|p| p.to_metres());
            let low = corners().fold(DVec2::INFINITY, DVec2::min) - BESIDE_M;
            let high = corners().fold(DVec2::NEG_INFINITY, DVec2::max) + BESIDE_M;
            Obstacle { low, high, outline }
        };
        Self(houses.chain(water).map(obstacle).collect())
    }

    /// Whether a straight line touches none of them.
    pub fn leave_free(&self, a: DVec2, b: DVec2) -> bool {
        let (low, high) = (a.min(b), a.max(b));
        let near = self.0.iter().filter(|one| one.low.cmple(high).all() && low.cmple(one.high).all());
        let mut lines = near.map(|one| one.outline);
        !lines.any(|outline| outline.contains(GridPos::from_metres(a.midpoint(b))) || crosses(outline, a, b))
    }
}

/// Whether a line crosses an outline, or passes closer to one of its corners than anybody would.
fn crosses(outline: &GridPolygon, a: DVec2, b: DVec2) -> bool {
    let way = b - a;
    outline.rings().any(|ring| {
        (0..ring.len()).any(|n| {
            let (p, q) = (ring[n].to_metres(), ring[(n + 1) % ring.len()].to_metres());
            let along = ((p - a).dot(way) / way.length_squared().max(1e-9)).clamp(0.0, 1.0);
            // Who stands beside a wall may walk away from it.
            let is_inner = (0.02..=0.98).contains(&along);
            if is_inner && (a + way * along).distance(p) < BESIDE_M {
                return true;
            }
            let edge = q - p;
            let across = way.perp_dot(edge);
            if across.abs() < 1e-12 {
                return false;
            }
            let (t, u) = ((p - a).perp_dot(edge) / across, (p - a).perp_dot(way) / across);
            (0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&u)
        })
    })
}

#[cfg(test)]
mod tests {
    use veduta_city::{GroundPatch, Massing};

    use super::*;

    fn rectangle(x: i32, y: i32, half: (i32, i32)) -> GridPolygon {
        let corner = |a: i32, b: i32| GridPos((x + a * half.0) * 1024, (y + b * half.1) * 1024);
        GridPolygon::simple(vec![corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)])
    }

    #[test]
    fn houses_and_water_stand_in_the_way_and_paving_does_not() {
        let patch = |surface, outline| GroundPatch { surface, outline, z: 0, course: None };
        let overview = Overview {
            houses: vec![Massing::block(rectangle(20, 0, (5, 5)), 9 * 1024)],
            ground: vec![
                patch(SurfaceKind::Water, rectangle(0, 40, (30, 5))),
                patch(SurfaceKind::Cobbles, rectangle(0, 0, (60, 60))),
            ],
            ..Overview::default()
        };
        let obstacles = Obstacles::of(&overview);
        let free = |a: (f64, f64), b: (f64, f64)| obstacles.leave_free(a.into(), b.into());
        assert!(free((0.0, 0.0), (10.0, 0.0)) && free((0.0, 10.0), (40.0, 10.0)));
        assert!(!free((0.0, 0.0), (40.0, 0.0)), "through the house");
        assert!(!free((0.0, 5.2), (40.0, 5.2)), "along its wall, too near to a corner");
        assert!(!free((0.0, 20.0), (0.0, 60.0)), "through the water");
        assert!(!free((18.0, 0.0), (22.0, 0.0)), "inside");
        assert!(free((0.0, 0.0), (0.0, 30.0)));
    }
}
