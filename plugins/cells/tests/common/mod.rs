//! Plans made by hand for tests and timings.
#![allow(dead_code)] // Each test uses some of it.

use glam::DVec2;
use proptest::prelude::*;
use veduta_city::draw::Draw;
use veduta_city::{
    Cells, CityPlan, GridPolygon, GridPos, GridRing, GroundPatch, House, Id, PlanRoof, PlanStreet, Rgb, RoofShape, SurfaceKind,
    Volume, Wall, WallKind,
};

/// Grid position of metres.
pub fn at(x: f64, y: f64) -> GridPos {
    GridPos::from_metres(DVec2::new(x, y))
}

/// A rectangle in metres, counter-clockwise.
pub fn rect(x0: f64, y0: f64, x1: f64, y1: f64) -> GridPolygon {
    GridPolygon::simple(vec![at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1)])
}

/// A rectangle turned about its centre, metres and radians.
pub fn turned(centre: DVec2, size: DVec2, angle: f64) -> GridPolygon {
    let (sin, cos) = (libm::sin(angle), libm::cos(angle));
    let corner = |x: f64, y: f64| {
        let p = DVec2::new(size.x * x, size.y * y);
        GridPos::from_metres(centre + DVec2::new(p.x * cos - p.y * sin, p.x * sin + p.y * cos))
    };
    GridPolygon::simple(vec![corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)])
}

/// A polygon with a hole, both given as plain polygons.
pub fn with_hole(outer: GridPolygon, hole: &GridPolygon) -> GridPolygon {
    let mut hole: GridRing = hole.outer.clone();
    hole.reverse();
    GridPolygon { outer: outer.outer, holes: vec![hole] }
}

pub fn volume(footprint: GridPolygon, bottom_m: f64, eaves_m: f64) -> Volume {
    let n = footprint.rings().map(Vec::len).sum();
    let grey = Rgb(180, 180, 180);
    let wall = Wall { kind: WallKind::Street, bays: 2, ..Wall::default() };
    let roof = PlanRoof { shape: RoofShape::Flat, height: 0, direction: 0, colour: grey };
    let (bottom, eaves) = (GridPos::steps(bottom_m), GridPos::steps(eaves_m));
    let (colour, trim) = (grey, grey);
    Volume { footprint, bottom, eaves, colour, trim, roof, gable: Default::default(), walls: vec![wall; n], arcades: Vec::new() }
}

pub fn house(id: u64, footprint: GridPolygon) -> House {
    let volumes = vec![volume(footprint, 0.0, 12.0)];
    House { id: Id(id), name: String::new(), number: String::new(), style: 0, floor: 0, volumes, monument: None }
}

pub fn patch(surface: SurfaceKind, outline: GridPolygon) -> GroundPatch {
    GroundPatch { surface, outline, z: 0, course: None }
}

/// A plan with one public patch all over it.
pub fn plan(extent: GridPolygon, footprints: impl IntoIterator<Item = GridPolygon>) -> CityPlan {
    let ground = vec![patch(SurfaceKind::Cobbles, extent.clone())];
    let houses = (1..).zip(footprints).map(|(id, footprint)| house(id, footprint)).collect();
    CityPlan { name: "Test".into(), extent, ground, houses, ..CityPlan::default() }
}

/// A town of perimeter blocks: `side` × `side` blocks of 12 houses around a yard, streets 8 to 14 m wide, all slightly turned, with
/// squares here and there. The ground is one public patch with a hole for each yard.
pub fn town(side: usize) -> CityPlan {
    let (block, lot, depth) = (64.0, 16.0, 13.0);
    let tilt = 0.12;
    let (sin, cos) = (libm::sin(tilt), libm::cos(tilt));
    let turn = |x: f64, y: f64| at(x * cos - y * sin, x * sin + y * cos);
    let quad =
        |x0: f64, y0: f64, x1: f64, y1: f64| GridPolygon::simple(vec![turn(x0, y0), turn(x1, y0), turn(x1, y1), turn(x0, y1)]);
    let mut footprints = Vec::new();
    let mut yards = Vec::new();
    let pitch = block + 11.0;
    for row in 0..side {
        for column in 0..side {
            let draw = Draw::new(5, Id((row * side + column) as u64 + 1), "block");
            if draw.chance("square", 0.06) {
                continue;
            }
            let x = column as f64 * pitch + draw.between("x", -1.5, 1.5);
            let y = row as f64 * pitch + draw.between("y", -1.5, 1.5);
            for i in 0..4 {
                // Fronts jut out by a few centimetres, as real ones do.
                let jut = draw.part(i).between("jut", 0.0, 0.4);
                let k = i as f64 * lot;
                footprints.push(quad(x + k, y - jut, x + k + lot, y + depth));
                footprints.push(quad(x + k, y + block - depth, x + k + lot, y + block + jut));
            }
            let middle = block - 2.0 * depth;
            for i in 0..2 {
                let k = y + depth + i as f64 * middle / 2.0;
                footprints.push(quad(x, k, x + depth, k + middle / 2.0));
                footprints.push(quad(x + block - depth, k, x + block, k + middle / 2.0));
            }
            yards.push(quad(x + depth, y + depth, x + block - depth, y + block - depth));
        }
    }
    let end = side as f64 * pitch;
    let extent = quad(-30.0, -30.0, end + 20.0, end + 20.0);
    let mut plan = plan(extent.clone(), footprints);
    let mut streets = extent;
    streets.holes = yards.iter().map(|yard| yard.outer.iter().rev().copied().collect()).collect();
    plan.ground = vec![patch(SurfaceKind::Cobbles, streets)];
    plan.ground.extend(yards.into_iter().map(|yard| patch(SurfaceKind::Yard, yard)));
    for i in 0..side {
        let y = i as f64 * pitch + block + 5.5;
        let street = |name: String, line: Vec<GridPos>| {
            let width = GridPos::steps(11.0);
            PlanStreet { id: Id(i as u64 + 1), name, line, width, walkable: true, ..PlanStreet::default() }
        };
        plan.streets.push(street(format!("Row {i}"), vec![turn(-30.0, y), turn(end, y)]));
        plan.streets.push(street(format!("Column {i}"), vec![turn(y, -30.0), turn(y, end)]));
    }
    plan
}

/// Detached houses on open ground, `side` × `side` of them, every 25 m, each turned its own way: one sees far between them.
pub fn suburb(side: usize) -> CityPlan {
    let footprints = (0..side * side).map(|i| {
        let draw = Draw::new(9, Id(i as u64 + 1), "house");
        let grid = DVec2::new((i % side) as f64, (i / side) as f64) * 25.0;
        let centre = grid + DVec2::new(draw.between("x", -4.0, 4.0), draw.between("y", -4.0, 4.0));
        turned(centre, DVec2::new(draw.between("w", 8.0, 14.0), draw.between("d", 8.0, 12.0)), draw.between("angle", 0.0, 1.6))
    });
    let end = side as f64 * 25.0;
    plan(rect(-30.0, -30.0, end, end), footprints)
}

/// Whether a segment passes through the inside of a convex footprint (Cyrus and Beck), by more than a hair.
pub fn is_blocked(p: DVec2, q: DVec2, footprint: &GridRing) -> bool {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    let way = q - p;
    for i in 0..footprint.len() {
        let (a, b) = (footprint[i].to_metres(), footprint[(i + 1) % footprint.len()].to_metres());
        let inward = (b - a).perp().normalize();
        let (from, speed) = ((p - a).dot(inward), way.dot(inward));
        if speed.abs() < 1e-12 {
            if from <= 0.0 {
                return false;
            }
        } else if speed > 0.0 {
            enter = enter.max(-from / speed);
        } else {
            leave = leave.min(-from / speed);
        }
    }
    (leave - enter) * way.length() > 1e-3
}

/// Casts rays through free space and asserts that all cells along each see the first. Returns how many pairs were tried.
pub fn cast_rays(plan: &CityPlan, cells: &Cells, starts: &[(f64, f64, f64)]) -> Result<usize, TestCaseError> {
    let mut pairs = 0;
    for &(x, y, angle) in starts {
        let p = DVec2::new(x, y);
        let Some(first) = cells.locate(GridPos::from_metres(p)) else { continue };
        let way = DVec2::new(libm::cos(angle), libm::sin(angle));
        for i in 1..80 {
            let q = p + way * f64::from(i) * 2.0;
            if plan.houses.iter().any(|house| is_blocked(p, q, &house.volumes[0].footprint.outer)) {
                break;
            }
            if let Some(reached) = cells.locate(GridPos::from_metres(q)) {
                pairs += 1;
                let sees = cells.visible[first as usize].contains(&reached);
                prop_assert!(sees, "{p} in cell {first} sees {q} in cell {reached}, but the visible set lacks it");
                prop_assert!(cells.visible[reached as usize].contains(&first), "seeing is mutual");
            }
        }
    }
    Ok(pairs)
}
