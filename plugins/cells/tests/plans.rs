//! Cells of plans made by hand.

mod common;

use std::collections::BTreeSet;

use common::{at, house, patch, plan, rect, volume, with_hole};
use glam::DVec2;
use veduta_cells::{CellsError, Partition, PartitionSettings, cell_shells, check, facade_sheets, partition};
use veduta_city::{
    CityPlan, Design, GridPolygon, GridPos, House, Id, Place, PlaceKind, PlacedMonument, PlanStreet, PlanTerrain, Severity,
    SurfaceKind, Volume, WallKind,
};

fn cut(plan: &CityPlan) -> Partition {
    let partition = partition(plan, &[], &PartitionSettings::default());
    assert_eq!(check(plan, &partition.cells), [], "what partition makes passes the check");
    partition
}

fn area_m2(partition: &Partition) -> f64 {
    partition.cells.cells.iter().map(|cell| cell.outline.area_m2()).sum()
}

#[test]
fn one_street_between_two_rows_is_a_chain_of_cells_that_all_see_each_other() {
    let rows = (0..10).flat_map(|i| {
        let x = f64::from(i) * 20.0;
        [rect(x, 0.0, x + 20.0, 20.0), rect(x, 30.0, x + 20.0, 50.0)]
    });
    let made = cut(&plan(rect(0.0, 0.0, 200.0, 50.0), rows));
    assert_eq!(made.findings, []);
    assert!((area_m2(&made) - 2000.0).abs() < 1e-9);
    let cells = &made.cells;
    assert!((3..=6).contains(&cells.cells.len()), "200 m in cells of at most 70 m: {}", cells.cells.len());
    for seen in &cells.visible {
        assert_eq!(seen.len(), cells.cells.len(), "a straight street hides nothing");
    }
    let blind: Vec<_> = cells.portals.iter().filter(|p| p.is_blind()).collect();
    assert_eq!(blind.len(), 2, "the street ends twice");
    assert!(blind.iter().all(|p| p.ends.0.0 == p.ends.1.0 && (p.ends.0.1 - p.ends.1.1).abs() == GridPos::steps(10.0)), "{blind:?}");
    assert_eq!(cells.cells.iter().map(|cell| cell.walls.len()).sum::<usize>(), 80);
}

#[test]
fn a_crossroads_has_narrow_portals() {
    let blocks =
        [rect(0.0, 0.0, 45.0, 45.0), rect(55.0, 0.0, 100.0, 45.0), rect(0.0, 55.0, 45.0, 100.0), rect(55.0, 55.0, 100.0, 100.0)];
    let made = cut(&plan(rect(0.0, 0.0, 100.0, 100.0), blocks));
    assert!(made.cells.cells.len() >= 3, "a cross is not convex: {}", made.cells.cells.len());
    for portal in made.cells.portals.iter().filter(|p| !p.is_blind()) {
        let length_m = (portal.ends.1.to_metres() - portal.ends.0.to_metres()).length();
        assert!(length_m < 20.0, "{length_m} m between the corners of streets of 10 m");
    }
}

#[test]
fn a_house_in_a_square_is_a_hole_in_no_more_than_the_cells_around_it() {
    let made = cut(&plan(rect(0.0, 0.0, 60.0, 60.0), [rect(25.0, 25.0, 35.0, 35.0)]));
    assert!((area_m2(&made) - 3500.0).abs() < 1e-9);
    let cells = &made.cells;
    let owners: BTreeSet<usize> = (0..cells.cells.len()).filter(|&i| !cells.cells[i].walls.is_empty()).collect();
    assert!(!owners.is_empty());
    assert_eq!(cells.cells.iter().map(|cell| cell.walls.len()).sum::<usize>(), 4);
}

#[test]
fn a_house_within_one_cell_is_its_hole() {
    let settings = PartitionSettings { max_area_m2: 10_000.0, max_diameter_m: 200.0, ..PartitionSettings::default() };
    let plan = plan(rect(0.0, 0.0, 60.0, 60.0), [rect(25.0, 25.0, 35.0, 35.0)]);
    let cells = partition(&plan, &[], &settings).cells;
    assert_eq!(check(&plan, &cells), []);
    assert_eq!(cells.cells.len(), 1);
    assert_eq!(cells.cells[0].outline.holes.len(), 1);
    assert_eq!(cells.cells[0].walls.len(), 4);
}

/// Two streets joined by a lane at their western end; a row of houses between them.
fn two_streets() -> CityPlan {
    let rows = [rect(0.0, 0.0, 200.0, 10.0), rect(10.0, 20.0, 200.0, 40.0), rect(0.0, 50.0, 200.0, 60.0)];
    plan(rect(0.0, 0.0, 200.0, 60.0), rows)
}

#[test]
fn streets_behind_houses_do_not_see_each_other() {
    let made = cut(&two_streets());
    let (south, north) = (made.cells.locate(at(195.0, 15.0)).unwrap(), made.cells.locate(at(195.0, 45.0)).unwrap());
    assert_ne!(south, north);
    let seen = &made.cells.visible[south as usize];
    assert!(!seen.contains(&north), "{seen:?}");
    let middle = made.cells.locate(at(120.0, 45.0)).unwrap();
    assert!(!seen.contains(&middle), "nor its middle: {seen:?}");
}

#[test]
fn who_sees_a_wall_sees_the_cell_that_it_is_drawn_with() {
    let made = cut(&two_streets());
    // The row between the streets has its first façade, and so its roof, on the southern one.
    let cells = &made.cells;
    let roof = (0..).zip(&cells.cells).find(|(_, cell)| cell.houses.contains(&1)).map(|(c, _)| c).unwrap();
    let north = cells.locate(at(120.0, 45.0)).unwrap();
    assert!(cells.cells[roof as usize].outline.outer.iter().all(|p| p.to_metres().y < 21.0), "a southern cell");
    assert!(cells.visible[north as usize].contains(&roof), "{:?}", cells.visible[north as usize]);
}

/// Two streets with a row of houses between them, in the middle of which is a yard with a slit to either street.
fn yard_between_streets(slit_m: f64) -> CityPlan {
    let x = 100.0 + slit_m;
    let halves = [
        vec![
            at(0.0, 20.0),
            at(100.0, 20.0),
            at(100.0, 26.0),
            at(90.0, 26.0),
            at(90.0, 34.0),
            at(100.0, 34.0),
            at(100.0, 40.0),
            at(0.0, 40.0),
        ],
        vec![
            at(x, 20.0),
            at(200.0, 20.0),
            at(200.0, 40.0),
            at(x, 40.0),
            at(x, 34.0),
            at(110.0, 34.0),
            at(110.0, 26.0),
            at(x, 26.0),
        ],
    ];
    let rows = [rect(0.0, 0.0, 200.0, 10.0), rect(0.0, 50.0, 200.0, 60.0)];
    plan(rect(0.0, 0.0, 200.0, 60.0), rows.into_iter().chain(halves.map(GridPolygon::simple)))
}

#[test]
fn one_looks_through_slits_and_yards_where_one_does_not_walk() {
    let made = cut(&yard_between_streets(0.4));
    assert_eq!(made.cells.locate(at(100.0, 30.0)), None, "nobody walks into the yard");
    let cell = |x: f64, y: f64| made.cells.locate(at(x, y)).unwrap();
    let (south, north) = (cell(100.2, 12.0), cell(100.2, 48.0));
    assert!(made.cells.visible[south as usize].contains(&north), "{:?}", made.cells.visible[south as usize]);
    let far = cell(10.0, 12.0);
    assert!(
        !made.cells.visible[far as usize].contains(&cell(10.0, 48.0)),
        "not round corners: {:?}",
        made.cells.visible[far as usize]
    );
    // Without the slits nothing is seen.
    let closed = cut(&yard_between_streets(0.0));
    let cell = |x: f64, y: f64| closed.cells.locate(at(x, y)).unwrap();
    assert!(!closed.cells.visible[cell(100.2, 12.0) as usize].contains(&cell(100.2, 48.0)));
}

#[test]
fn an_enclosed_courtyard_is_no_cell_but_its_ground_is_told() {
    let court = rect(40.0, 40.0, 60.0, 60.0);
    let block = with_hole(rect(20.0, 20.0, 80.0, 80.0), &court);
    let mut plan = plan(rect(0.0, 0.0, 100.0, 100.0), [block.clone()]);
    plan.ground = vec![
        patch(SurfaceKind::Cobbles, with_hole(rect(0.0, 0.0, 100.0, 100.0), &rect(20.0, 20.0, 80.0, 80.0))),
        patch(SurfaceKind::Yard, rect(20.0, 20.0, 80.0, 80.0)),
    ];
    let made = cut(&plan);
    assert_eq!(made.cells.locate(at(50.0, 50.0)), None);
    assert!((area_m2(&made) - 6400.0).abs() < 1e-9);
    // Courtyard walls go with the first façade: nothing is lost.
    assert_eq!(made.cells.cells.iter().map(|cell| cell.walls.len()).sum::<usize>(), 8);
    let shells = cell_shells(&plan, &made.cells);
    let yard_m2: f64 =
        shells.iter().flat_map(|s| &s.ground).filter(|g| g.surface == SurfaceKind::Yard).map(|g| g.outline.area_m2()).sum();
    assert!((yard_m2 - 400.0).abs() < 1e-6, "the courtyard alone, not what lies under the house: {yard_m2}");
}

#[test]
fn the_ground_under_a_monument_is_told_once() {
    let mut plan = plan(rect(0.0, 0.0, 100.0, 100.0), [rect(20.0, 20.0, 60.0, 60.0)]);
    // Two volumes over each other, and one that hangs.
    let mut volumes = plan.houses[0].volumes.clone();
    let hanging = Volume { bottom: 9 * 1024, footprint: rect(10.0, 10.0, 30.0, 30.0), ..volumes[0].clone() };
    volumes.extend([Volume { footprint: rect(40.0, 40.0, 70.0, 60.0), ..volumes[0].clone() }, hanging]);
    plan.houses[0].volumes = volumes;
    plan.designs = vec![Design::default()];
    let told_m2 = |plan: &CityPlan| -> f64 {
        let shells = cell_shells(plan, &cut(plan).cells);
        shells.iter().flat_map(|s| &s.ground).map(|g| g.outline.area_m2()).sum()
    };
    assert!((told_m2(&plan) - (10_000.0 - 1_800.0)).abs() < 1e-6, "{}", told_m2(&plan));
    plan.houses[0].monument = Some(PlacedMonument { design: 0, pos: at(40.0, 40.0), z: 0, heading: 0 });
    assert!((told_m2(&plan) - 10_000.0).abs() < 1e-6, "{}", told_m2(&plan));
}

#[test]
fn a_courtyard_behind_a_slit_is_no_cell_and_one_behind_an_alley_is() {
    // Two halves of a block around a courtyard of 20 m × 20 m, with a gap between them to the south.
    let halves = |gap_m: f64| {
        let (west, east) = (50.0 - gap_m / 2.0, 50.0 + gap_m / 2.0);
        let left = vec![
            at(20.0, 20.0),
            at(west, 20.0),
            at(west, 40.0),
            at(40.0, 40.0),
            at(40.0, 60.0),
            at(50.0, 60.0),
            at(50.0, 80.0),
            at(20.0, 80.0),
        ];
        let right = vec![
            at(50.0, 80.0),
            at(50.0, 60.0),
            at(60.0, 60.0),
            at(60.0, 40.0),
            at(east, 40.0),
            at(east, 20.0),
            at(80.0, 20.0),
            at(80.0, 80.0),
        ];
        let mut plan = plan(rect(0.0, 0.0, 100.0, 100.0), [left, right].map(GridPolygon::simple));
        plan.ground = vec![
            patch(SurfaceKind::Cobbles, with_hole(rect(0.0, 0.0, 100.0, 100.0), &rect(20.0, 20.0, 80.0, 80.0))),
            patch(SurfaceKind::Yard, rect(20.0, 20.0, 80.0, 80.0)),
        ];
        cut(&plan).cells
    };
    for gap_m in [0.002, 0.1, 0.5] {
        let cells = halves(gap_m);
        assert_eq!(cells.locate(at(50.0, 50.0)), None, "a gap of {gap_m} m is no way");
        assert!(gap_m < 0.1 || cells.locate(at(50.0, 30.0)).is_some(), "one looks into a gap of {gap_m} m");
    }
    assert!(halves(1.2).locate(at(50.0, 50.0)).is_some());
}

#[test]
fn a_passage_under_a_hanging_volume_opens_the_courtyard() {
    let parts = |bottom_m| {
        let mut house = house(1, rect(20.0, 20.0, 45.0, 40.0));
        house.volumes.push(volume(rect(55.0, 20.0, 80.0, 40.0), 0.0, 12.0));
        house.volumes.push(volume(rect(20.0, 60.0, 80.0, 80.0), 0.0, 12.0));
        house.volumes.push(volume(rect(20.0, 40.0, 40.0, 60.0), 0.0, 12.0));
        house.volumes.push(volume(rect(60.0, 40.0, 80.0, 60.0), 0.0, 12.0));
        house.volumes.push(volume(rect(45.0, 20.0, 55.0, 40.0), bottom_m, 12.0));
        CityPlan { houses: vec![house], ..plan(rect(0.0, 0.0, 100.0, 100.0), []) }
    };
    let passage = (at(50.0, 30.0), at(50.0, 50.0));
    let high = cut(&parts(3.5)).cells;
    assert!(high.locate(passage.0).is_some() && high.locate(passage.1).is_some());
    let low = cut(&parts(1.5)).cells;
    assert!(low.locate(passage.0).is_none(), "1.5 m is no passage");
}

#[test]
fn party_walls_and_the_roof_go_with_the_first_facade() {
    let mut plan = plan(rect(0.0, 0.0, 60.0, 40.0), [rect(0.0, 0.0, 30.0, 20.0), rect(30.0, 0.0, 60.0, 20.0)]);
    for house in &mut plan.houses {
        for kind in [0, 1, 3] {
            house.volumes[0].walls[kind].kind = WallKind::Party;
        }
    }
    let made = cut(&plan);
    for (h, _) in plan.houses.iter().enumerate() {
        let owner = |wall: u16| made.cells.cells.iter().position(|cell| cell.walls.contains(&(h as u32, 0, wall)));
        let facade = owner(2);
        assert!((0..4).all(|w| owner(w) == facade), "house {h}");
        assert!(made.cells.cells[facade.unwrap()].houses.contains(&(h as u32)));
    }
}

#[test]
fn shells_and_sheets_list_the_same_walls_in_the_same_order() {
    let mut plan = two_streets();
    for (h, house) in plan.houses.iter_mut().enumerate() {
        for (w, wall) in house.volumes[0].walls.iter_mut().enumerate() {
            wall.bays = (10 * h + w) as u8;
        }
    }
    let made = cut(&plan);
    let (shells, sheets) = (cell_shells(&plan, &made.cells), facade_sheets(&plan, &made.cells));
    for ((cell, shell), sheet) in made.cells.cells.iter().zip(&shells).zip(&sheets) {
        let stands_at = |house: &House, corner: GridPos| house.volumes[0].footprint.outer[0] == corner;
        let house_of = |corner: GridPos| plan.houses.iter().position(|house| stands_at(house, corner)).unwrap();
        let listed = shell.houses.iter().flat_map(|house| {
            let h = house_of(house.volumes[0].footprint.outer[0] + shell.origin);
            house.volumes.iter().flat_map(move |volume| volume.walls.iter().map(move |w| (10 * h) as u8 + *w as u8))
        });
        assert_eq!(listed.collect::<Vec<_>>(), sheet.walls.iter().map(|wall| wall.bays).collect::<Vec<_>>());
        assert_eq!((shell.origin.0 % 1024, shell.origin.1 % 1024), (0, 0), "origins lie on whole metres");
        assert_eq!(shell.outline.outer[0] + shell.origin, cell.outline.outer[0]);
        assert_eq!(shell.blind.len(), cell.portals.iter().filter(|&&p| made.cells.portals[p as usize].is_blind()).count());
    }
    let roofs = shells.iter().flat_map(|s| &s.houses).filter(|h| h.volumes.iter().any(|v| v.has_roof)).count();
    assert_eq!(roofs, plan.houses.len(), "each roof once");
}

#[test]
fn cells_are_named_after_square_or_street() {
    let mut plan = two_streets();
    let street = |y: f64, name: &str| PlanStreet {
        id: Id(1),
        name: name.into(),
        line: vec![at(0.0, y), at(200.0, y)],
        width: GridPos::steps(10.0),
        walkable: true,
        ..PlanStreet::default()
    };
    plan.streets = vec![street(15.0, "South Street"), street(45.0, "North Street")];
    let square = |name: &str, x, y, radius_m| Place {
        name: name.into(),
        kind: PlaceKind::Square,
        pos: DVec2::new(x, y),
        radius_m,
        ..Place::default()
    };
    plan.places = vec![
        square("Nowhere", f64::NAN, 15.0, 500.0),
        square("Fifty", 50.0, 15.0, 35.0),
        Place { kind: PlaceKind::Shop, ..square("The Two Streets", 60.0, 15.0, 500.0) },
        square("Eighty", 80.0, 15.0, 35.0),
    ];
    let made = cut(&plan);
    let mut met = BTreeSet::new();
    for cell in &made.cells.cells {
        let at = cell.outline.centroid();
        let away = |x: f64| at.distance(DVec2::new(x, 15.0));
        let named = match (away(50.0), away(80.0)) {
            (fifty, eighty) if fifty <= eighty.min(35.0) => "Fifty",
            (_, eighty) if eighty <= 35.0 => "Eighty",
            _ if at.y <= 30.0 => "South Street",
            _ => "North Street",
        };
        assert_eq!(cell.name, named, "{at}");
        met.insert(named);
    }
    assert_eq!(met.len(), 4, "{met:?}");
}

#[test]
fn towers_make_the_skyline() {
    let mut plan =
        plan(rect(0.0, 0.0, 300.0, 300.0), (0..5).map(|i| rect(f64::from(i) * 60.0, 0.0, f64::from(i) * 60.0 + 20.0, 20.0)));
    assert!(cut(&plan).cells.skyline.is_empty(), "roofs of one height have no skyline");
    plan.houses[0].volumes.push(volume(rect(8.0, 8.0, 12.0, 12.0), 12.0, 60.0));
    let made = cut(&plan);
    let roof = made.cells.cells.iter().position(|cell| cell.houses.contains(&0)).unwrap() as u32;
    assert!(made.cells.skyline.contains(&roof), "{:?}", made.cells.skyline);
    // However many there are, and however broad.
    plan.houses[2].volumes[0] = volume(rect(120.0, 0.0, 140.0, 20.0), 0.0, 26.0);
    let made = cut(&plan);
    for house in [0, 2] {
        let carries = |&number: &u32| made.cells.cells[number as usize].houses.contains(&house);
        assert!(made.cells.skyline.iter().any(carries), "house {house}: {:?}", made.cells.skyline);
    }
}

#[test]
fn a_hill_is_seen_over_low_roofs_and_not_over_high_ones() {
    // A street, shut by a house all across it, that leads up a hill in the end.
    let across = rect(200.0, 0.0, 212.0, 40.0);
    let heights = |rise_m: f64| {
        let height_m = |column: i32| rise_m * ((f64::from(column) * 50.0 - 800.0) / 400.0).clamp(0.0, 1.0);
        (0..2 * 25).map(|n| GridPos::steps(height_m(n % 25))).collect::<Vec<i32>>()
    };
    let seen_from_the_west = |eaves_m: f64, rise_m: f64| {
        let mut plan = plan(rect(0.0, 0.0, 1_200.0, 40.0), [across.clone()]);
        plan.houses[0].volumes[0] = volume(across.clone(), 0.0, eaves_m);
        plan.terrain = PlanTerrain { origin: at(0.0, 0.0), step: GridPos::steps(50.0), columns: 25, heights: heights(rise_m) };
        let cells = cut(&plan).cells;
        let x_m = |cell: &u32| cells.cells[*cell as usize].outline.centroid().x;
        let west = cells.far.iter().zip(0..).filter(|(_, cell)| x_m(cell) < 190.0).flat_map(|(far, _)| far);
        west.map(x_m).fold(0.0, f64::max)
    };
    assert!(seen_from_the_west(4.0, 80.0) > 900.0, "{}", seen_from_the_west(4.0, 80.0));
    for (eaves_m, rise_m) in [(4.0, 0.0), (90.0, 80.0)] {
        let seen = seen_from_the_west(eaves_m, rise_m);
        assert!(seen < 0.5, "under eaves at {eaves_m} m, of a hill of {rise_m} m: {seen}");
    }
}

#[test]
fn floors_span_the_heights_of_the_ground() {
    let mut plan = plan(rect(0.0, 0.0, 40.0, 20.0), []);
    let mut pavement = patch(SurfaceKind::Mosaic, rect(0.0, 10.0, 40.0, 20.0));
    pavement.z = 154;
    plan.ground = vec![patch(SurfaceKind::Asphalt, rect(0.0, 0.0, 40.0, 10.0)), pavement];
    assert_eq!(cut(&plan).cells.cells[0].floor, (0, 154));
}

#[test]
fn bad_plans_end_in_findings() {
    let empty = partition(&CityPlan::default(), &[], &PartitionSettings::default());
    assert!(empty.cells.cells.is_empty() && empty.findings.iter().any(|f| f.severity == Severity::Dropped));
    let vast = rect(-1_000_000.0, -1_000_000.0, 1_000_000.0, 1_000_000.0);
    assert!(!partition(&plan(vast, []), &[], &PartitionSettings::default()).findings.is_empty());

    // Degenerate, crossed, far and missing footprints.
    let bow = GridPolygon::simple(vec![at(10.0, 10.0), at(30.0, 30.0), at(30.0, 10.0), at(10.0, 30.0)]);
    let line = GridPolygon::simple(vec![at(1.0, 1.0), at(2.0, 2.0)]);
    let far = GridPolygon::simple(vec![GridPos(i32::MAX, i32::MAX), GridPos(i32::MIN, 0), GridPos(0, i32::MIN)]);
    let mut plan = plan(rect(0.0, 0.0, 60.0, 60.0), [bow, line, far, GridPolygon::default()]);
    plan.houses.push(House { volumes: Vec::new(), ..house(9, rect(0.0, 0.0, 1.0, 1.0)) });
    let made = partition(&plan, &[], &PartitionSettings::default());
    assert!(made.findings.iter().filter(|f| f.severity == Severity::Dropped).count() >= 4, "{:?}", made.findings);
    assert!(!made.cells.cells.is_empty());
    let _ = (cell_shells(&plan, &made.cells), facade_sheets(&plan, &made.cells));

    let grass = CityPlan { ground: vec![patch(SurfaceKind::Grass, rect(0.0, 0.0, 60.0, 60.0))], ..plan };
    let made = partition(&grass, &[], &PartitionSettings::default());
    assert!(!made.cells.cells.is_empty(), "a city without streets still walks");
    assert!(made.findings.iter().any(|f| f.severity == Severity::Repaired));
}

#[test]
fn check_names_what_was_broken() {
    let plan = two_streets();
    let good = cut(&plan).cells;
    let broken = |damage: fn(&mut veduta_city::Cells)| {
        let mut cells = good.clone();
        damage(&mut cells);
        check(&plan, &cells)
    };
    let wall_lost = broken(|c| c.cells.iter_mut().for_each(|cell| cell.walls.retain(|w| *w != (1, 0, 2))));
    assert!(
        matches!(wall_lost.as_slice(), [CellsError::NotOnce { what: "wall", index, cells: 0 }] if index == "1/0/2"),
        "{wall_lost:?}"
    );
    assert!(broken(|c| c.cells[0].outline.outer.reverse()).iter().any(|e| matches!(e, CellsError::Ring { ring: 0, .. })));
    assert!(broken(|c| c.cells[1].outline = c.cells[0].outline.clone()).iter().any(|e| matches!(e, CellsError::Overlap { .. })));
    assert!(broken(|c| c.portals[0].ends.0.0 += 5).iter().any(|e| matches!(e, CellsError::PortalOffOutline { portal: 0, .. })));
    assert!(broken(|c| c.visible[0].clear()).iter().any(|e| matches!(e, CellsError::NotSeen { lacks: 0, .. })));
    assert!(broken(|c| c.cells[1].id = c.cells[0].id).iter().any(|e| matches!(e, CellsError::DuplicateId { .. })));
    let mut swollen = plan.clone();
    swollen.houses[1].volumes[0].footprint = rect(10.0, 18.0, 200.0, 40.0);
    assert!(matches!(check(&swollen, &good).as_slice(), [CellsError::NotFree { m2 }] if (m2 - 380.0).abs() < 1e-6));
    assert!(broken(|c| c.far[0] = vec![99_999]).iter().any(|e| matches!(e, CellsError::Unknown { what: "cell far away", .. })));
    assert!(broken(|c| c.far[0] = vec![1, 0]).iter().any(|e| matches!(e, CellsError::Unsorted { what: "cells far away", .. })));
    assert!(broken(|c| drop(c.far.pop())).iter().any(|e| matches!(e, CellsError::VisibleCount { what: "cells far away", .. })));
    assert!(broken(|c| c.skyline = vec![99_999]).iter().any(|e| matches!(e, CellsError::Unknown { .. })));
}
