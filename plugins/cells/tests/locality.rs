//! How far a change of a plan reaches, and that a partition made again of a changed plan is what it would be if it were made anew.

mod common;

use std::collections::HashSet;

use common::{at, house, suburb, town, turned};
use glam::DVec2;
use proptest::prelude::*;
use veduta_cells::{Partition, PartitionSettings, Recut, partition};
use veduta_city::draw::Draw;
use veduta_city::{CellOverride, CityPlan, GridPolygon, GridPos, Id, Target};

/// A change of one house, or of a whole block.
#[derive(Debug, Clone, Copy)]
enum Change {
    Remove(usize),
    Grow(usize),
    Raise(usize),
    Add(f64, f64),
    RemoveBlock(usize),
}

/// The changed plan, and the footprints of what was changed.
fn changed(plan: &CityPlan, change: Change) -> (CityPlan, Vec<GridPolygon>) {
    let mut plan = plan.clone();
    let count = plan.houses.len();
    let footprint = |plan: &CityPlan, n: usize| plan.houses[n].volumes[0].footprint.clone();
    let at_house = match change {
        Change::Remove(n) | Change::Grow(n) | Change::Raise(n) | Change::RemoveBlock(n) => n % count,
        Change::Add(..) => 0,
    };
    let mut touched = vec![footprint(&plan, at_house)];
    match change {
        Change::Remove(_) => drop(plan.houses.remove(at_house)),
        Change::Grow(_) => {
            let outline = &mut plan.houses[at_house].volumes[0].footprint;
            let middle = outline.middle();
            *outline = outline.map(|p| GridPos(p.0 + (p.0 - middle.0) / 8, p.1 + (p.1 - middle.1) / 8));
            touched.push(outline.clone());
        }
        Change::Raise(_) => plan.houses[at_house].volumes[0].eaves += 4_096,
        Change::Add(x, y) => {
            touched = vec![turned(DVec2::new(x, y), DVec2::new(5.0, 4.0), 0.4)];
            plan.houses.push(house(9_999, touched[0].clone()));
        }
        Change::RemoveBlock(_) => {
            let middle = touched[0].middle().to_metres();
            let is_near = |footprint: &GridPolygon| footprint.middle().to_metres().distance(middle) < 40.0;
            touched = plan.houses.iter().map(|house| house.volumes[0].footprint.clone()).filter(is_near).collect();
            plan.houses.retain(|house| !is_near(&house.volumes[0].footprint));
        }
    }
    (plan, touched)
}

/// How far from what was changed the farthest cell lies whose outline, id or name is not what it was, metres.
fn reach_m(before: &Partition, after: &Partition, touched: &[GridPolygon]) -> f64 {
    let told = |made: &Partition| -> HashSet<(GridPolygon, Id, String)> {
        made.cells.cells.iter().map(|cell| (cell.outline.clone(), cell.id, cell.name.clone())).collect()
    };
    let (before, after) = (told(before), told(after));
    let off_m = |p: &GridPos| {
        let corners = touched.iter().flat_map(|polygon| &polygon.outer);
        corners.map(|corner| corner.to_metres().distance(p.to_metres())).fold(f64::INFINITY, f64::min)
    };
    let nearest = |(outline, ..): &(GridPolygon, Id, String)| outline.outer.iter().map(off_m).fold(f64::INFINITY, f64::min);
    before.symmetric_difference(&after).map(nearest).fold(0.0, f64::max)
}

/// Whether something lies across the city's edge, or nearly so.
fn is_at_edge(plan: &CityPlan, touched: &[GridPolygon]) -> bool {
    let corners: Vec<DVec2> = touched.iter().flat_map(|polygon| &polygon.outer).map(|p| p.to_metres()).collect();
    plan.extent.edges().any(|(a, b)| {
        let (a, b) = (a.to_metres(), b.to_metres());
        let left_m = |p: &DVec2| (b - a).normalize().perp_dot(*p - a);
        corners.iter().any(|p| left_m(p) < 2.0)
    })
}

fn change() -> impl Strategy<Value = Change> {
    prop_oneof![
        any::<usize>().prop_map(Change::Remove),
        any::<usize>().prop_map(Change::Grow),
        any::<usize>().prop_map(Change::Raise),
        (-20.0..330.0, -20.0..330.0).prop_map(|(x, y)| Change::Add(x, y)),
        any::<usize>().prop_map(Change::RemoveBlock),
    ]
}

#[test]
fn a_change_of_a_house_or_a_block_reaches_no_farther_than_its_neighbourhood() {
    for (name, plan, extent_m) in [("town", town(9), 675.0), ("suburb", suburb(24), 600.0)] {
        // What is seen is not looked at here.
        let settings = PartitionSettings { sight_m: 30.0, far_m: 30.0, ..PartitionSettings::default() };
        let before = partition(&plan, &[], &settings);
        let mut reaches: Vec<f64> = Vec::new();
        for n in 0..100_u64 {
            let draw = Draw::new(11, Id(n + 1), "change");
            let house = (draw.unit("house") * plan.houses.len() as f64) as usize;
            let change = match n % 5 {
                0 => Change::Remove(house),
                1 => Change::Grow(house),
                2 => Change::Raise(house),
                3 => Change::Add(draw.between("x", 0.0, extent_m), draw.between("y", 0.0, extent_m)),
                _ => Change::RemoveBlock(house),
            };
            let (plan, touched) = changed(&plan, change);
            // The sides of the city's edge are cut in equal pieces, which move all along one that is built upon.
            if is_at_edge(&plan, &touched) {
                continue;
            }
            reaches.push(reach_m(&before, &partition(&plan, &[], &settings), &touched));
        }
        reaches.sort_by(f64::total_cmp);
        println!("{name}: {} cells; the farthest reaches are {:.0?} m", before.cells.cells.len(), &reaches[reaches.len() - 5..]);
        assert!(reaches.len() > 80, "most are within the city: {}", reaches.len());
        assert!(reaches.last().is_some_and(|&most| most < 200.0), "{name}: {reaches:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(24) })]

    #[test]
    fn a_partition_made_again_is_what_it_would_be_anew(changes in proptest::collection::vec(change(), 1..4), is_suburb in any::<bool>(), is_edited in any::<bool>()) {
        let mut plan = if is_suburb { suburb(9) } else { town(4) };
        let settings = PartitionSettings { sight_m: 120.0, ..PartitionSettings::default() };
        let line = [CellOverride::Cut { from: DVec2::new(-40.0, 71.3), to: DVec2::new(340.0, 68.0) }];
        let edits = if is_edited { &line[..] } else { &[] };
        let mut recut = Recut::new(&plan, edits, &settings);
        prop_assert!(*recut.partition() == partition(&plan, edits, &settings));
        for change in changes {
            plan = changed(&plan, change).0;
            let searched = recut.update(&plan, edits);
            prop_assert!(*recut.partition() == partition(&plan, edits, &settings), "{:?}, {} cells searched", change, searched);
            prop_assert_eq!(recut.update(&plan, edits), 0);
        }
    }
}

#[test]
fn few_cells_are_looked_from_again_after_a_small_change() {
    let plan = town(14);
    let settings = PartitionSettings::default();
    let mut recut = Recut::new(&plan, &[], &settings);
    let count = recut.partition().cells.cells.len();
    let (plan, _) = changed(&plan, Change::Grow(plan.houses.len() / 2));
    let searched = recut.update(&plan, &[]);
    println!("{searched} of {count} cells were looked from again");
    assert!(*recut.partition() == partition(&plan, &[], &settings));
    assert!(0 < searched && 3 * searched < count, "{searched} of {count}");
    let edits = [CellOverride::Name { target: Target { id: Id::NONE, at: at(70.0, 75.0).to_metres() }, name: "x".into() }];
    assert_eq!(recut.update(&plan, &edits), 0, "a name is not seen");
    assert!(*recut.partition() == partition(&plan, &edits, &settings));
}
