//! Where pigeons may stand: on open, paved ground, off walls and whatever stands on it.

use bevy::math::DVec2;
use veduta_city::draw::Draw;
use veduta_city::{GridPos, Id, Overview};
use veduta_ecs::{Around, City, Ground, StandingCells};

use crate::bird::Spot;

/// Places that are tried, and that are kept at most.
const TRIED: u64 = 260;
const KEPT: usize = 120;
/// Nearest that a bird comes to walls, and to the edge of what stands about, metres.
const OFF_WALLS_M: f64 = 1.6;
const OFF_THINGS_M: f64 = 1.1;

/// Free places about a middle, each drawn by the flock's id. Where nothing is known of a city all ground is free.
pub(crate) fn spots(
    id: Id,
    middle: DVec2,
    radius_m: f64,
    city: Option<&City>,
    standing: &StandingCells,
    ground: &Ground<'_>,
) -> Vec<Spot> {
    let around = Around { middle, radius_m: radius_m + 5.0 };
    let parts: Vec<&Overview> = city.into_iter().flat_map(|city| city.overviews.near(around)).map(AsRef::as_ref).collect();
    let things = things_about(standing, around);
    let draw = Draw::new(0, id, "spots");
    let place = |n: u64| {
        let of = draw.part(n);
        let (sin, cos) = of.between("angle", 0.0, core::f64::consts::TAU).sin_cos();
        middle + DVec2::new(cos, sin) * radius_m * of.unit("far").sqrt()
    };
    let is_free = |at: &DVec2| {
        let corners = [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y].map(|way| *at + way * OFF_WALLS_M);
        is_open(&parts, *at)
            && corners.iter().all(|&corner| is_open(&parts, corner))
            && things.iter().all(|(thing, radius)| thing.distance(*at) > radius + OFF_THINGS_M)
    };
    let spot = |at: DVec2| {
        let z = |p: DVec2| ground.at(p, f64::INFINITY);
        let here = z(at);
        let slope = DVec2::new(z(at + DVec2::X * 0.8) - here, z(at + DVec2::Y * 0.8) - here) / 0.8;
        Spot { pos: at.extend(here), slope }
    };
    (0..TRIED).map(place).filter(is_free).take(KEPT).map(spot).filter(|spot| spot.slope.length() < 0.4).collect()
}

/// Whether a place lies on public paving and in no house.
fn is_open(parts: &[&Overview], at: DVec2) -> bool {
    if parts.iter().all(|part| part.ground.is_empty()) {
        return true;
    }
    let pos = GridPos::from_metres(at);
    let is_paved =
        parts.iter().any(|part| part.ground.iter().any(|patch| patch.surface.is_public() && patch.outline.contains(pos)));
    is_paved && !parts.iter().any(|part| part.houses.iter().any(|house| house.outline.contains(pos)))
}

/// What stands about, and how much ground it takes: by the cells that stand.
fn things_about(standing: &StandingCells, around: Around) -> Vec<(DVec2, f64)> {
    let objects = standing.iter().flat_map(|(_, _, shell)| shell.objects.iter().map(move |object| (shell.origin, object)));
    let things = objects.map(|(origin, object)| {
        let usual = object.kind.radius_m();
        // What is higher is wider.
        let size = (veduta_city::metres(object.height) / 3.0).clamp(1.0, 3.0);
        ((origin + object.pos).to_metres(), usual * size)
    });
    things.filter(|(at, _)| at.distance(around.middle) < around.radius_m).collect()
}

#[cfg(test)]
mod tests {
    use bevy::ecs::system::RunSystemOnce;
    use bevy::prelude::*;
    use veduta_city::{GridPolygon, GroundPatch, Massing, SurfaceKind};
    use veduta_ecs::{EcsPlugin, Overviews};

    use super::*;

    fn rectangle(x: (i32, i32), y: (i32, i32)) -> GridPolygon {
        let at = |x: i32, y: i32| GridPos(x * 1024, y * 1024);
        GridPolygon::simple(vec![at(x.0, y.0), at(x.1, y.0), at(x.1, y.1), at(x.0, y.1)])
    }

    #[test]
    fn pigeons_stand_on_paving_off_walls_and_lawns() {
        let patch = |surface, outline| GroundPatch { surface, outline, z: 0, course: None };
        let overview = Overview {
            ground: vec![
                patch(SurfaceKind::Cobbles, rectangle((-20, 5), (-20, 20))),
                patch(SurfaceKind::Grass, rectangle((5, 20), (-20, 20))),
            ],
            houses: vec![Massing::block(rectangle((-8, -2), (-8, -2)), 9 * 1024)],
            ..Overview::default()
        };
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, EcsPlugin));
        app.insert_resource(City { overviews: Overviews::whole(overview), ..City::default() });
        let found = app.world_mut().run_system_once(|city: Res<City>, standing: Res<StandingCells>, ground: Ground| {
            let known = spots(Id(3), DVec2::ZERO, 18.0, Some(&city), &standing, &ground);
            (known, spots(Id(3), DVec2::ZERO, 18.0, None, &standing, &ground))
        });
        let (known, unknown) = found.expect("all it needs is there");
        assert!(known.len() > 40 && unknown.len() == KEPT, "{} {}", known.len(), unknown.len());
        for spot in known {
            let (x, y) = (spot.pos.x, spot.pos.y);
            assert!(x < 5.0 - OFF_WALLS_M + 1e-6, "{x} {y} is no lawn");
            // Before walls, and in front of them; about corners they may come a little nearer.
            let (house, near) = (-8.0..=-2.0, -8.0 - OFF_WALLS_M..=-2.0 + OFF_WALLS_M);
            let is_before = house.contains(&x) && near.contains(&y) || house.contains(&y) && near.contains(&x);
            assert!(!is_before, "{x} {y} is too near to a wall");
        }
    }
}
