//! Laws that hold for any plan: houses thrown at random.

mod common;

use std::collections::BTreeSet;

use common::{at, cast_rays, is_blocked, plan, rect, turned};
use glam::{DVec2, IVec2};
use proptest::prelude::*;
use veduta_cells::{PartitionSettings, cell_shells, check, partition};
use veduta_city::{Arcade, Cells, CityPlan, GridPolygon, GridPos, GroundPatch, SurfaceKind};

/// Side of the random plans, metres.
const SIDE: i32 = 120;

fn small_cells() -> PartitionSettings {
    PartitionSettings { max_area_m2: 600.0, max_diameter_m: 40.0, min_area_m2: 30.0, ..PartitionSettings::default() }
}

/// Houses on whole metres: least corner and size.
fn upright() -> impl Strategy<Value = Vec<(IVec2, IVec2)>> {
    let house = (0..SIDE, 0..SIDE, 3..40_i32, 3..40_i32).prop_map(|(x, y, w, h)| (IVec2::new(x, y), IVec2::new(w, h)));
    proptest::collection::vec(house, 1..25)
}

fn upright_plan(houses: &[(IVec2, IVec2)]) -> CityPlan {
    let footprints = houses.iter().map(|(p, s)| rect(p.x.into(), p.y.into(), (p.x + s.x).into(), (p.y + s.y).into()));
    plan(rect(0.0, 0.0, SIDE.into(), SIDE.into()), footprints)
}

/// Houses of any direction: centre, size, angle.
fn slanted() -> impl Strategy<Value = Vec<GridPolygon>> {
    let house = (0.0..f64::from(SIDE), 0.0..f64::from(SIDE), 3.0..30.0_f64, 3.0..30.0_f64, 0.0..1.6_f64)
        .prop_map(|(x, y, w, h, angle)| turned(DVec2::new(x, y), DVec2::new(w, h), angle));
    proptest::collection::vec(house, 1..20)
}

/// Pieces of at least 200 squares of a metre that hang together, by flooding a raster: area, and a square of each.
fn flooded(houses: &[(IVec2, IVec2)]) -> Vec<(usize, IVec2)> {
    let n = SIDE as usize;
    let mut is_free = vec![true; n * n];
    for (p, s) in houses {
        for y in p.y..(p.y + s.y).min(SIDE) {
            for x in p.x..(p.x + s.x).min(SIDE) {
                is_free[y as usize * n + x as usize] = false;
            }
        }
    }
    let mut pieces = Vec::new();
    for start in 0..n * n {
        let mut stack = vec![start];
        let mut area = 0;
        while let Some(i) = stack.pop() {
            if !core::mem::replace(&mut is_free[i], false) {
                continue;
            }
            area += 1;
            let (x, y) = (i % n, i / n);
            let near = [(x > 0, i.wrapping_sub(1)), (x + 1 < n, i + 1), (y > 0, i.wrapping_sub(n)), (y + 1 < n, i + n)];
            stack.extend(near.into_iter().filter(|n| n.0).map(|n| n.1));
        }
        if area >= 200 {
            pieces.push((area, IVec2::new((start % n) as i32, (start / n) as i32)));
        }
    }
    pieces
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    #[test]
    fn cells_tile_the_reachable_free_space(houses in upright()) {
        let plan = upright_plan(&houses);
        let made = partition(&plan, &[], &small_cells());
        prop_assert_eq!(check(&plan, &made.cells), []);
        let pieces = flooded(&houses);
        // Without any piece that is large enough, the largest is kept.
        prop_assume!(!pieces.is_empty());
        let truth: usize = pieces.iter().map(|p| p.0).sum();
        let area: f64 = made.cells.cells.iter().map(|cell| cell.outline.area_m2()).sum();
        prop_assert!((area - truth as f64).abs() <= 1e-6 * truth as f64, "{} of {}", area, truth);
        for (_, square) in pieces {
            prop_assert!(made.cells.locate(at(f64::from(square.x) + 0.5, f64::from(square.y) + 0.5)).is_some());
        }
    }

    #[test]
    fn what_a_ray_reaches_is_visible(
        houses in slanted(),
        starts in proptest::collection::vec((1.0..119.0_f64, 1.0..119.0_f64, 0.0..6.2_f64), 150),
    ) {
        let plan = plan(rect(0.0, 0.0, SIDE.into(), SIDE.into()), houses);
        let made = partition(&plan, &[], &small_cells());
        prop_assert_eq!(check(&plan, &made.cells), []);
        cast_rays(&plan, &made.cells, &starts)?;
        // Few sets of lines to tell apart: merging must lose nothing.
        let merged = partition(&plan, &[], &PartitionSettings { line_sets: 1, ..small_cells() });
        cast_rays(&plan, &merged.cells, &starts)?;
    }

    #[test]
    fn ground_is_told_once_wherever_no_house_stands(houses in upright()) {
        let plan = upright_plan(&houses);
        let made = partition(&plan, &[], &small_cells());
        prop_assume!(!made.cells.cells.is_empty());
        let told: f64 = cell_shells(&plan, &made.cells).iter().flat_map(|s| &s.ground).map(|g| g.outline.area_m2()).sum();
        let is_built = |x: i32, y: i32| houses.iter().any(|(p, s)| p.x <= x && x < p.x + s.x && p.y <= y && y < p.y + s.y);
        let bare = (0..SIDE * SIDE).filter(|i| !is_built(i % SIDE, i / SIDE)).count() as f64;
        prop_assert!((told - bare).abs() < 1e-6 * bare, "{} of {}", told, bare);
    }
}

#[test]
fn yards_are_covered_with_few_vertices_and_reach_beyond_their_houses_nowhere() {
    let mut plan = common::town(4);
    let made = partition(&plan, &[], &PartitionSettings::default());
    let told = |plan: &CityPlan| -> Vec<GroundPatch> {
        let shells = cell_shells(plan, &made.cells);
        let patches = shells.iter().flat_map(|shell| {
            shell.ground.iter().map(|patch| GroundPatch { outline: patch.outline.map(|p| p + shell.origin), ..patch.clone() })
        });
        patches.filter(|patch| patch.surface == SurfaceKind::Yard).collect()
    };
    let exact: Vec<GridPolygon> = made.cells.cells.iter().flat_map(|cell| cell.yards.clone()).collect();
    let wide = told(&plan);
    let vertices =
        |polygons: &mut dyn Iterator<Item = &GridPolygon>| polygons.flat_map(GridPolygon::rings).map(Vec::len).sum::<usize>();
    let count = (vertices(&mut wide.iter().map(|patch| &patch.outline)), vertices(&mut exact.iter()));
    assert!(2 * count.0 <= count.1, "{} of {} vertices", count.0, count.1);
    for i in 0..20_000 {
        let draw = veduta_city::draw::Draw::new(7, veduta_city::Id(i), "place");
        let pos = at(draw.between("x", -30.0, 320.0), draw.between("y", -30.0, 350.0));
        let is_yard = exact.iter().any(|yard| yard.contains(pos));
        let is_house = plan.houses.iter().any(|house| house.volumes[0].footprint.contains(pos));
        let is_told = wide.iter().any(|patch| patch.outline.contains(pos));
        assert!(is_told || !is_yard, "{pos:?} is in a yard that is not told");
        assert!(!is_told || is_yard || is_house, "{pos:?} is told as a yard and is none");
    }
    // Nothing is hidden in an arcade.
    for house in &mut plan.houses {
        house.volumes[0].arcades = vec![Arcade { wall: 0, span: (0, 9_000), arches: 3, floor: 150, depth: 3_700 }];
    }
    let m2 = |polygons: &mut dyn Iterator<Item = &GridPolygon>| polygons.map(GridPolygon::area_m2).sum::<f64>();
    let areas = (m2(&mut told(&plan).iter().map(|patch| &patch.outline)), m2(&mut exact.iter()));
    assert!((areas.0 - areas.1).abs() < 1e-3 * areas.1, "{areas:?}");
}

#[test]
fn rays_through_a_town_find_only_visible_cells() {
    let plan = common::town(4);
    let made = partition(&plan, &[], &PartitionSettings::default());
    let starts: Vec<_> = (0..4000)
        .map(|i| {
            let draw = veduta_city::draw::Draw::new(3, veduta_city::Id(i), "ray");
            (draw.between("x", -30.0, 320.0), draw.between("y", -30.0, 350.0), draw.between("angle", 0.0, 6.3))
        })
        .collect();
    let pairs = cast_rays(&plan, &made.cells, &starts).unwrap();
    assert!(pairs > 10_000, "only {pairs} pairs tried");
}

#[test]
fn visible_sets_are_not_much_larger_than_what_rays_find() {
    let plan = common::town(3);
    let cells = partition(&plan, &[], &PartitionSettings::default()).cells;
    assert_eq!(check(&plan, &cells), []);
    let mut found: BTreeSet<(u32, u32)> = (0..cells.cells.len() as u32).map(|i| (i, i)).collect();
    for i in 0..20_000 {
        let draw = veduta_city::draw::Draw::new(4, veduta_city::Id(i), "ray");
        let p = DVec2::new(draw.between("x", -40.0, 250.0), draw.between("y", -40.0, 280.0));
        let angle = draw.between("angle", 0.0, 6.3);
        let way = DVec2::new(libm::cos(angle), libm::sin(angle));
        let mut along = BTreeSet::new();
        for step in 0..100 {
            let q = p + way * f64::from(step) * 3.0;
            if plan.houses.iter().any(|house| is_blocked(p, q, &house.volumes[0].footprint.outer)) {
                break;
            }
            along.extend(cells.locate(GridPos::from_metres(q)));
        }
        found.extend(along.iter().flat_map(|&a| along.iter().map(move |&b| (a, b))));
    }
    let told: usize = cells.visible.iter().map(Vec::len).sum();
    println!("{told} pairs told, {} found by rays", found.len());
    assert!(told < found.len() * 2, "{told} pairs told, {} found by rays", found.len());
}

#[test]
fn what_is_seen_beyond_the_sight_is_told_by_squares() {
    let plan = common::town(10);
    let square = |cells: &Cells, cell: u32| cells.cells[cell as usize].outline.middle().square();
    // No lines are merged: whatever is told is seen.
    let exact = PartitionSettings { line_sets: 10_000, sight_steps: 1_000_000, sight_m: 2_000.0, ..PartitionSettings::default() };
    let whole = partition(&plan, &[], &exact).cells;
    assert!(whole.far.iter().all(Vec::is_empty), "nothing is so far away");
    let cells = partition(&plan, &[], &PartitionSettings { sight_m: 80.0, ..exact.clone() }).cells;
    assert_eq!(check(&plan, &cells), []);
    assert_eq!(cells.cells, whole.cells);
    let (mut told, mut held) = (0, 0);
    let squares: BTreeSet<u64> = (0..cells.cells.len() as u32).map(|cell| square(&cells, cell)).collect();
    for (cell, seen) in (0..).zip(&whole.visible) {
        let far: BTreeSet<u64> = cells.far[cell].iter().map(|&other| square(&cells, other)).collect();
        assert_eq!(far.len(), cells.far[cell].len(), "one cell a square");
        for &other in seen.iter().filter(|other| cells.visible[cell].binary_search(other).is_err()) {
            assert!(far.contains(&square(&cells, other)), "cell {cell} sees {other}");
            told += 1;
        }
        held += far.len();
    }
    assert!(told > 500, "{told} pairs are farther away");
    let share = held as f64 / (cells.cells.len() * squares.len()) as f64;
    println!("{told} pairs are farther away, and a cell sees {share:.2} of all squares there");
    assert!(share < 0.6, "a cell sees {share} of all squares there");
    let none = partition(&plan, &[], &PartitionSettings { sight_m: 80.0, far_m: 80.0, ..exact }).cells;
    assert!(none.far.iter().all(Vec::is_empty), "nobody sees farther");
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let plan = common::town(5);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let made = partition(&plan, &[], &PartitionSettings::default());
            let shells = cell_shells(&plan, &made.cells);
            (made, shells)
        })
    };
    let one = on(1);
    assert!(one == on(2) && one == on(7));
}
