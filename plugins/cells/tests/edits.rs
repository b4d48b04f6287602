//! A person's edits to cells: two joined, one cut, one named.

mod common;

use std::collections::HashSet;

use common::{at, cast_rays, patch, plan, rect, turned};
use glam::DVec2;
use proptest::prelude::*;
use veduta_cells::{Partition, PartitionSettings, cell_shells, check, partition};
use veduta_city::{
    CellOverride, CellsOverrides, CityPlan, GridPolygon, GridPos, Id, PlanStreet, Portal, PortalSide, Severity, SurfaceKind, file,
};

fn edits(text: &str) -> Vec<CellOverride> {
    let overrides: CellsOverrides = file::parse(&format!("(edits: [{text}])"), "t").unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(overrides.validate(), []);
    overrides.edits
}

fn cut(plan: &CityPlan, text: &str) -> Partition {
    let made = partition(plan, &edits(text), &PartitionSettings::default());
    assert_eq!(check(plan, &made.cells), [], "{text}");
    made
}

fn cell_at(made: &Partition, x: f64, y: f64) -> u32 {
    made.cells.locate(at(x, y)).expect("a cell is there")
}

/// A street of 200 m between two rows of houses; a tower narrows it in its middle to a gate of 3 m.
fn gate() -> CityPlan {
    let rows = (0..10).flat_map(|i| {
        let x = f64::from(i) * 20.0;
        [rect(x, 0.0, x + 20.0, 20.0), rect(x, 30.0, x + 20.0, 50.0)]
    });
    let tower = [rect(97.0, 20.0, 103.0, 23.5), rect(97.0, 26.5, 103.0, 30.0)];
    let mut plan = plan(rect(0.0, 0.0, 200.0, 50.0), rows.chain(tower));
    let line = vec![at(0.0, 25.0), at(200.0, 25.0)];
    let width = GridPos::steps(10.0);
    plan.streets = vec![PlanStreet { id: Id(1), name: "Gate Street".into(), line, width, walkable: true, ..PlanStreet::default() }];
    plan
}

#[test]
fn a_join_takes_the_portal_away() {
    let plan = gate();
    let before = cut(&plan, "");
    let (west, next) = (cell_at(&before, 5.0, 25.0), cell_at(&before, 85.0, 25.0));
    let is_between = |p: &Portal| p.beyond == PortalSide::Cell(west.max(next)) && p.cell == west.min(next);
    let between: Vec<_> = before.cells.portals.iter().filter(|p| is_between(p)).collect();
    assert!(west != next && !between.is_empty(), "they are neighbours");
    let made = cut(&plan, "Join(target: (at: (5, 25)), with: (at: (85, 25)))");
    assert_eq!(made.findings, []);
    assert_eq!(made.cells.cells.len(), before.cells.cells.len() - 1);
    assert_eq!(cell_at(&made, 5.0, 25.0), cell_at(&made, 85.0, 25.0));
    assert_eq!(made.cells.portals.len(), before.cells.portals.len() - between.len());
    assert!(made.cells.portals.iter().all(|portal| between.iter().all(|gone| gone.ends != portal.ends)));
    // Once more they are one.
    let twice = cut(&plan, "Join(target: (at: (5, 25)), with: (at: (85, 25))), Join(target: (at: (5, 25)), with: (at: (85, 25)))");
    assert_eq!(
        twice.findings.iter().map(|f| f.message.as_str()).collect::<Vec<_>>(),
        ["edit 2 of the cells (Join): both places lie in one cell"]
    );
    assert_eq!(twice.cells, made.cells);
}

#[test]
fn a_cut_leaves_a_portal_along_its_line_and_other_cells_as_they_were() {
    let plan = gate();
    let before = cut(&plan, "");
    // Roughly drawn: it goes to the corners of the tower.
    let line = "Cut(from: (96.8, 23.4), to: (97.1, 26.8))";
    let made = cut(&plan, line);
    assert_eq!(made.findings, []);
    let expected = [at(97.0, 23.5), at(97.0, 26.5)];
    let gate = made.cells.portals.iter().find(|p| expected.contains(&p.ends.0) && expected.contains(&p.ends.1));
    assert!(gate.is_some_and(|gate| gate.other(gate.cell).is_some()), "{:?}", made.cells.portals);
    let outlines = |made: &Partition| made.cells.cells.iter().map(|cell| cell.outline.clone()).collect::<HashSet<_>>();
    let is_cut = cell_at(&before, 96.0, 25.0) == cell_at(&before, 98.0, 25.0);
    assert!(outlines(&before).difference(&outlines(&made)).count() <= usize::from(is_cut));
    let again = cut(&plan, &format!("{line}, {line}"));
    assert!(
        again.findings.len() == 1 && again.findings[0].message.contains("a portal lies along that line already"),
        "{:?}",
        again.findings
    );
    assert_eq!(again.cells, made.cells);
    // Elsewhere, between long walls without corners.
    let made = cut(&plan, "Cut(from: (24.37, 19.9), to: (29.41, 30.3))");
    assert_eq!((made.findings.len(), made.cells.cells.len()), (0, before.cells.cells.len() + 1));
    let is_on = |p: GridPos| (p.to_metres().x - (24.37 + (p.to_metres().y - 19.9) / 10.4 * 5.04)).abs() < 0.03;
    assert!(made.cells.portals.iter().any(|p| p.other(p.cell).is_some() && is_on(p.ends.0) && is_on(p.ends.1)));
}

#[test]
fn a_cut_through_several_cells_parts_each_and_what_was_cut_can_be_joined() {
    // A square whose cells are all open to each other.
    let plan = plan(rect(0.0, 0.0, 120.0, 120.0), []);
    let before = cut(&plan, "");
    let line = "Cut(from: (-0.5, 31.7), to: (120.5, 77.1))";
    let made = cut(&plan, line);
    assert_eq!(made.findings, []);
    assert!(made.cells.cells.len() > before.cells.cells.len() + 1, "it leads through several: {}", made.cells.cells.len());
    let (from, along) = (DVec2::new(-0.5, 31.7), DVec2::new(121.0, 45.4).normalize());
    let off_m = |p: GridPos| along.perp_dot(p.to_metres() - from).abs();
    let portals = made.cells.portals.iter().filter(|p| !p.is_blind() && off_m(p.ends.0) < 0.6 && off_m(p.ends.1) < 0.6);
    let length_m: f64 = portals.map(|p| p.ends.0.to_metres().distance(p.ends.1.to_metres())).sum();
    assert!((length_m - 128.2).abs() < 1.0, "portals along all of the line: {length_m} m");
    // A piece of the one side is joined with what it was cut from.
    let (a, b) = ((60.0, 50.0), (60.0, 59.0));
    let told = |cells: &Partition| cell_at(cells, a.0, a.1) == cell_at(cells, b.0, b.1);
    assert!(!told(&made));
    let joined = cut(&plan, &format!("{line}, Join(target: (at: {a:?}), with: (at: {b:?}))"));
    assert!(told(&joined) && joined.findings.is_empty(), "{:?}", joined.findings);
    assert_eq!(cut(&plan, &format!("Join(target: (at: {a:?}), with: (at: {b:?}))")).findings.len(), 1, "they were one before");
}

#[test]
fn a_name_stays_through_joins_and_cuts() {
    let plan = gate();
    let before = cut(&plan, "");
    let id = before.cells.cells[cell_at(&before, 5.0, 25.0) as usize].id;
    assert!(before.cells.cells.iter().all(|cell| cell.name == "Gate Street"));
    let text = format!("Name(target: (id: {}, at: (5, 25)), name: \"Before the Gate\")", id.0);
    let name = |made: &Partition, x: f64| made.cells.cells[cell_at(made, x, 25.0) as usize].name.clone();
    let made = cut(&plan, &text);
    assert_eq!((name(&made, 5.0).as_str(), name(&made, 150.0).as_str()), ("Before the Gate", "Gate Street"));
    let made =
        cut(&plan, &format!("{text}, Cut(from: (20, 20), to: (20, 30)), Join(target: (at: (85, 25)), with: (at: (30, 25)))"));
    assert_eq!(made.findings, []);
    assert_eq!((name(&made, 5.0).as_str(), name(&made, 85.0).as_str()), ("Before the Gate", "Before the Gate"));
    let made = cut(&plan, "Name(target: (at: (5, 25)), name: \"\")");
    assert_eq!(name(&made, 5.0), "");
}

#[test]
fn edits_that_find_nothing_are_told_with_number_and_kind() {
    let plan = gate();
    let text = "Name(target: (at: (500, 500)), name: \"x\"),
        Join(target: (at: (5, 25)), with: (at: (190, 25))),
        Join(target: (at: (5, 25)), with: (at: (5, -90))),
        Cut(from: (30, 20), to: (30, 26)),
        Cut(from: (300, 20), to: (300, 30)),
        Cut(from: (30, 20.1), to: (50, 20.1)),
        Name(target: (id: 9223372036854775813, at: (5, 25)), name: \"found by its place\")";
    let made = partition(&plan, &edits(text), &PartitionSettings::default());
    let told: Vec<String> = made.findings.iter().map(ToString::to_string).collect();
    let expected = [
        "edit 1 of the cells (Name): nothing of that id, and no cell within 5 m of that place",
        "edit 2 of the cells (Join): no portal leads from the one cell to the other: join it first with what lies between",
        "edit 3 of the cells (Join): `with`: nothing of that id, and no cell within 5 m of that place",
        "edit 4 of the cells (Cut): the line ends within a cell, at (30.0, 26.0), and does not part it: draw it from wall to wall",
        "edit 5 of the cells (Cut): the line leads through no cell",
    ];
    assert_eq!(told.len(), 6, "{told:#?}");
    for (told, expected) in told.iter().zip(expected) {
        assert!(told.starts_with("dropped: ") && told.ends_with(expected), "{told}");
    }
    assert!(told[5].contains("edit 6 of the cells (Cut)"), "{told:?}");
    let unedited = cut(&plan, "");
    let named = cell_at(&made, 5.0, 25.0) as usize;
    assert_eq!(made.cells.cells[named].name, "found by its place");
    assert_eq!(made.cells.portals, unedited.cells.portals, "nothing else was done");
    assert_eq!(made.cells.visible, unedited.cells.visible);
}

#[test]
fn a_line_to_an_island_parts_nothing_and_two_do() {
    // A square of one cell about a house.
    let settings = PartitionSettings { max_area_m2: 10_000.0, max_diameter_m: 200.0, ..PartitionSettings::default() };
    let plan = plan(rect(0.0, 0.0, 60.0, 60.0), [rect(25.0, 25.0, 35.0, 35.0)]);
    let made = |text: &str| partition(&plan, &edits(text), &settings);
    let one = made("Cut(from: (0, 30), to: (26, 30))");
    assert!(one.findings.len() == 1 && one.findings[0].message.contains("the line parts no cell"), "{:?}", one.findings);
    let through = made("Cut(from: (0, 30), to: (60, 30))");
    assert_eq!((through.findings.len(), through.cells.cells.len()), (0, 2));
    assert_eq!(check(&plan, &through.cells), []);
    assert_eq!(through.cells.portals.iter().filter(|p| !p.is_blind()).count(), 2);
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let plan = common::town(3);
    let edits = edits(
        "Cut(from: (60, 150), to: (160, 150)), Join(target: (at: (70, 75)), with: (at: (71, 100))), Cut(from: (70, -20), to: (75, 240))",
    );
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| partition(&plan, &edits, &PartitionSettings::default()))
    };
    let one = on(1);
    assert!(one == on(2) && one == on(7));
    assert_eq!(check(&plan, &one.cells), []);
}

/// Side of the random plans, metres.
const SIDE: f64 = 120.0;

fn houses() -> impl Strategy<Value = Vec<GridPolygon>> {
    let house = (0.0..SIDE, 0.0..SIDE, 3.0..30.0_f64, 3.0..30.0_f64, 0.0..1.6_f64)
        .prop_map(|(x, y, w, h, angle)| turned(DVec2::new(x, y), DVec2::new(w, h), angle));
    proptest::collection::vec(house, 1..15)
}

/// Edits anywhere: most joins meet no neighbours, and many lines end in the midst of a cell.
fn any_edits() -> impl Strategy<Value = Vec<CellOverride>> {
    let place = || (-5.0..SIDE + 5.0, -5.0..SIDE + 5.0).prop_map(|(x, y)| DVec2::new(x, y));
    let edit = (0..3_u8, place(), place()).prop_map(|(kind, a, b)| {
        let target = |at| veduta_city::Target { id: Id::NONE, at };
        match kind {
            0 => CellOverride::Join { target: target(a), with: target(a + (b - a).normalize_or_zero() * 15.0) },
            1 => CellOverride::Cut { from: a, to: b },
            // All across.
            _ => CellOverride::Cut { from: DVec2::new(-1.0, a.y), to: DVec2::new(SIDE + 1.0, b.y) },
        }
    });
    proptest::collection::vec(edit, 1..8)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    #[test]
    fn whatever_is_edited_cells_tile_the_free_space_and_see_what_rays_reach(
        houses in houses(), edits in any_edits(),
        starts in proptest::collection::vec((1.0..119.0_f64, 1.0..119.0_f64, 0.0..6.2_f64), 60),
    ) {
        let mut plan = plan(rect(0.0, 0.0, SIDE, SIDE), houses);
        plan.ground.push(patch(SurfaceKind::Grass, rect(0.0, 0.0, 30.0, 30.0)));
        let settings = PartitionSettings { max_area_m2: 600.0, max_diameter_m: 40.0, min_area_m2: 30.0, ..PartitionSettings::default() };
        let before = partition(&plan, &[], &settings);
        let made = partition(&plan, &edits, &settings);
        prop_assert_eq!(check(&plan, &made.cells), []);
        let m2 = |made: &Partition| made.cells.cells.iter().map(|cell| cell.outline.area_m2()).sum::<f64>();
        prop_assert!((m2(&made) - m2(&before)).abs() < 2.0, "{} m² were {} m²", m2(&made), m2(&before));
        prop_assert!(cell_shells(&plan, &made.cells).len() == made.cells.cells.len());
        cast_rays(&plan, &made.cells, &starts)?;
        // Each edit does something, or is told.
        let dropped = made.findings.iter().filter(|f| f.severity == Severity::Dropped && f.message.contains("of the cells")).count();
        prop_assert!(dropped < edits.len() || made.cells == before.cells);
        prop_assert!(dropped == edits.len() || made.cells.portals != before.cells.portals);
    }
}
