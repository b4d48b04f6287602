//! Cities on slopes: ground without a gap, walls that reach into it, doors that can be gone through.

mod ground_proof;
mod synthetic;

use glam::DVec2;
use ground_proof::{prove_partition, prove_slope};
use proptest::prelude::*;
use veduta_city::{CellShell, CityGraph, CityPlan, HouseShell, Opening, Terrain, VolumeShell, WallKind, metres};
use veduta_growth::mesh::{self, MeshData};
use veduta_growth::plan::{Stock, grow};

static STOCK: std::sync::LazyLock<Stock> = std::sync::LazyLock::new(Stock::new);

/// A made-up city of blocks with and without given houses, on hills of a height, their tops so far apart.
fn hilly(seed: u64, height_m: f64, apart_m: f64) -> CityGraph {
    let mut graph = synthetic::city(3, seed);
    let half = graph.buildings.len() / 2;
    graph.buildings.truncate(half);
    let (step_m, columns) = (7.0, 70);
    let origin = DVec2::splat(-100.0);
    let height = |i: u32| {
        let p = (origin + DVec2::new(f64::from(i % columns), f64::from(i / columns)) * step_m) / apart_m * core::f64::consts::TAU;
        height_m * (1.0 + libm::sin(p.x) * libm::cos(p.y * 0.8 + 1.0)) / 2.0
    };
    graph.terrain = Some(Terrain { origin, step_m, columns, heights_m: (0..columns * columns).map(height).collect() });
    graph
}

fn grown(graph: &CityGraph) -> CityPlan {
    grow(graph, &STOCK).unwrap_or_else(|e| panic!("{e}")).plan
}

/// Whether an upright mesh covers a place of an edge at a height.
fn is_covered(mesh: &MeshData, p: DVec2, y: f64) -> bool {
    mesh.indices.chunks_exact(3).any(|t| {
        let [a, b, c] = [t[0], t[1], t[2]].map(|i| glam::Vec3::from(mesh.positions[i as usize]).as_dvec3());
        let q = glam::DVec3::new(p.x, y, -p.y);
        let normal = (b - a).cross(c - a);
        let side = |a: glam::DVec3, b: glam::DVec3| (b - a).cross(q - a).dot(normal) > -1e-3 * normal.length();
        normal.dot(q - a).abs() < 2e-3 * normal.length() && side(a, b) && side(b, c) && side(c, a)
    })
}

/// No gap under a wall: from its foot down to the ground before it there is stone.
fn prove_walls(plan: &CityPlan) {
    for house in &plan.houses {
        let volumes = house.volumes.iter().map(|v| VolumeShell::of(v, (0..v.walls.len() as u16).collect(), true)).collect();
        let told = HouseShell { style: house.style, floor: house.floor, volumes, is_monument: false };
        let footings = mesh::footings(&CellShell { terrain: plan.terrain.clone(), houses: vec![told], ..CellShell::default() });
        footings.validate().unwrap_or_else(|e| panic!("{e}"));
        for volume in house.volumes.iter().filter(|volume| volume.bottom - house.floor < 512) {
            for (a, b) in volume.footprint.edges() {
                for share in [0.02, 0.27, 0.5, 0.77, 0.98] {
                    let p = a.to_metres().lerp(b.to_metres(), share);
                    let (ground, foot) = (plan.terrain.height_m(p), metres(volume.bottom));
                    let mut y = foot - 0.01;
                    while y > ground - 0.1 {
                        assert!(is_covered(&footings, p, y), "a gap at {p}, {y}: ground {ground}, foot {foot}");
                        y -= 0.15;
                    }
                }
            }
        }
    }
}

/// Ground before every door above its threshold, lowest and highest; metres.
fn doors(plan: &CityPlan) -> Vec<(f64, f64)> {
    let mut out = Vec::new();
    for volume in plan.houses.iter().flat_map(|house| &house.volumes) {
        for (wall, (a, b)) in volume.walls.iter().zip(volume.footprint.edges()) {
            let Some(bay) = wall.ground_floor.door_bay.filter(|_| wall.ground_floor.door != Opening::Blank) else { continue };
            let at = |i: f64| a.to_metres().lerp(b.to_metres(), (f64::from(bay) + i) / f64::from(wall.bays));
            let (low, high) = plan.terrain.range_along(at(0.3), at(0.7));
            out.push((low - metres(volume.bottom), high - metres(volume.bottom)));
        }
    }
    out
}

#[test]
fn a_city_on_hills_has_no_gaps_and_no_buried_doors() {
    // Slopes of up to 8, 16 and 31 %.
    for (seed, height_m, apart_m, along_door_m) in [(1, 8.0, 320.0, 0.15), (2, 12.0, 240.0, 0.3), (3, 20.0, 200.0, 0.6)] {
        let graph = hilly(seed, height_m, apart_m);
        let plan = grown(&graph);
        assert!(plan.houses.len() > 100 && !plan.terrain.is_level());
        prove_partition(&plan);
        prove_slope(&plan);
        prove_walls(&plan);
        let doors = doors(&plan);
        let (lowest, highest) = doors.iter().fold((0.0_f64, 0.0_f64), |(l, h), d| (l.min(d.0), h.max(d.1)));
        println!("{height_m} m: {} doors of {} houses, ground from {lowest:.2} to {highest:.2} m", doors.len(), plan.houses.len());
        assert!(highest < 0.05, "a door is {highest} m in the ground");
        // What is left is the slope along the door itself.
        let hanging = doors.iter().filter(|(low, _)| *low < -along_door_m).count();
        assert!(hanging * 50 <= doors.len() && doors.len() * 10 >= plan.houses.len() * 9, "{hanging} hang of {}", doors.len());
        assert_eq!(grown(&graph), plan);
    }
}

#[test]
fn where_the_ground_falls_away_there_are_storeys_below_the_door_and_no_window_is_in_the_ground() {
    let plan = grown(&hilly(3, 20.0, 200.0));
    let mut cellars = 0;
    for house in &plan.houses {
        let lowest = house.volumes.iter().map(|volume| volume.bottom).min();
        assert_eq!(lowest, Some(house.floor));
        for volume in house.volumes.iter().filter(|volume| volume.bottom - house.floor < 512 || !volume.roof.is_there()) {
            cellars += usize::from(!volume.roof.is_there());
            let stands_on = |above: &&veduta_city::Volume| above.bottom == volume.eaves && above.footprint == volume.footprint;
            assert!(volume.roof.is_there() || house.volumes.iter().any(|above| stands_on(&above)), "{house:?}");
            for (wall, (a, b)) in volume.walls.iter().zip(volume.footprint.edges()) {
                let mut base = volume.bottom;
                for (s, storey) in wall.storeys.iter().enumerate().take_while(|(s, _)| *s == 0 || !volume.roof.is_there()) {
                    for bay in (0..wall.bays.min(32)).filter(|&bay| Some(bay) != wall.ground_floor.door_bay) {
                        let share = (f64::from(bay) + 0.5) / f64::from(wall.bays);
                        let ground = plan.terrain.height_m(a.to_metres().lerp(b.to_metres(), share)) - metres(base);
                        let opening = wall.opening(s, bay);
                        assert!(opening == Opening::Blank || ground < 0.95, "{opening:?} {ground} m in the ground");
                    }
                    base += storey.height;
                }
            }
        }
        // No wall shows more than a storey of bare stone.
        let standing = house.volumes.iter().filter(|volume| volume.bottom - house.floor < 512);
        for (wall, (a, b)) in standing.flat_map(|volume| volume.walls.iter().zip(volume.footprint.edges())) {
            let low = plan.terrain.range_along(a.to_metres(), b.to_metres()).0;
            let bare = metres(house.floor) - low;
            assert!(wall.kind == WallKind::Party || bare < 3.7, "{bare} m of bare stone");
        }
    }
    assert!(cellars > 5, "{cellars} cellars");
}

#[test]
fn what_stands_on_a_slope_touches_it() {
    let plan = grown(&hilly(4, 12.0, 240.0));
    assert!(plan.objects.len() > 40);
    for object in &plan.objects {
        let (foot, ground) = (metres(object.z), plan.terrain.height_m(object.pos.to_metres()));
        assert!((ground - 1.5..ground + 0.13).contains(&foot), "{object:?} on {ground}");
    }
    let shell = CellShell { terrain: plan.terrain.clone(), markings: plan.markings.clone(), ..CellShell::default() };
    let paint = mesh::markings(&shell);
    paint.validate().unwrap_or_else(|e| panic!("{e}"));
    assert!(paint.triangle_count() > 100);
    for (p, n) in paint.positions.iter().zip(&paint.normals).filter(|(_, n)| n[1] > 0.5) {
        let ground = plan.terrain.height_m(DVec2::new(f64::from(p[0]), -f64::from(p[2])));
        assert!((ground + 0.005..ground + 0.2).contains(&f64::from(p[1])), "{p:?} {n:?} over {ground}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn the_ground_is_whole_on_any_hills(seed in any::<u64>(), height_m in 0.5..60.0_f64, apart_m in 60.0..600.0_f64) {
        let plan = grown(&hilly(seed, height_m, apart_m));
        prove_partition(&plan);
        prove_slope(&plan);
    }
}
