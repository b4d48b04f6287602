//! Cities described in words, from the description to the plan.

use std::path::{Path, PathBuf};

use veduta_bake::{BakeSettings, Input, InputKind, bake, overrides_beside, plan};
use veduta_cells::{CellsError, PartitionSettings, check, partition};
use veduta_city::{Cells, CityPlan, GridPolygon, GridPos, House, Id, Severity, Volume};

fn sample() -> PathBuf {
    PathBuf::from("../../scenes/words/brookwick.words.ron")
}

#[test]
fn the_sample_town_bakes_without_loss() {
    let out = std::env::temp_dir().join(format!("veduta-words-{}", std::process::id()));
    let baked = bake(&sample(), &out, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
    std::fs::remove_dir_all(&out).expect("just written");
    assert!(baked.findings.iter().all(|f| f.severity != Severity::Dropped), "{:?}", baked.findings);
}

#[test]
fn every_plan_grows_without_loss() {
    let folder = std::env::temp_dir().join(format!("veduta-plans-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let plans = ["Medieval()", "Radial()", "Grid()", "Mixed()", "Mixed(outside: Suburb)"];
    for (seed, words) in plans.iter().enumerate() {
        let path = folder.join(format!("{seed}.words.ron"));
        let text = format!(
            "(name: \"T\", seed: {seed}, size_m: 600, plan: {words}, squares: 2, river: (width_m: 20, bridges: 2), railway: true)"
        );
        std::fs::write(&path, text).expect("the folder is there");
        let input = Input::of(&path).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(input.kind, InputKind::Words);
        let planned = plan(&input, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
        let lost: Vec<_> = planned.findings.iter().filter(|f| f.severity == Severity::Dropped).collect();
        assert!(lost.len() * 50 < planned.plan.houses.len(), "{words}: {} houses, {lost:?}", planned.plan.houses.len());
        assert!(planned.plan.houses.len() > 200, "{words}: {} houses", planned.plan.houses.len());
        assert!(planned.plan.start.pos.length() < 300.0, "{words}: a visit begins in the town");
        println!("{words}: {} houses, {} findings", planned.plan.houses.len(), planned.findings.len());
        planned.findings.iter().take(4).for_each(|f| println!("  {f}"));
    }
    std::fs::remove_dir_all(&folder).expect("just written");
}

/// 34,000 edges of cells and free space: enough for the engine of overlays to take its way for many.
#[test]
fn cells_of_a_large_town_reach_into_no_house() {
    let path = std::env::temp_dir().join(format!("veduta-large-{}.words.ron", std::process::id()));
    std::fs::write(&path, "(name: \"T\", seed: 11, size_m: 1500, plan: Medieval(), squares: 30)").expect("a file");
    let input = Input::of(&path).unwrap_or_else(|e| panic!("{e}"));
    let mut town = plan(&input, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}")).plan;
    std::fs::remove_file(&path).expect("just written");
    // What is seen is not looked at.
    let settings = PartitionSettings { sight_m: 1.0, far_m: 1.0, ..PartitionSettings::default() };
    let cells = partition(&town, &[], &settings).cells;
    let edges: usize = cells.cells.iter().flat_map(|cell| cell.outline.rings()).map(Vec::len).sum();
    assert!(edges > 15_000, "{edges} edges of cells");
    assert_eq!(check(&town, &cells), []);
    // A post of 0.016 m² in a cell is told.
    let at = cells.cells.iter().map(|cell| (cell, cell.outline.middle())).find(|(cell, at)| cell.outline.contains(*at));
    let (x, y) = at.map(|(_, at)| (at.0 / 16 * 16, at.1 / 16 * 16)).expect("most cells hold their middle");
    let corners = [(0, 0), (128, 0), (128, 128), (0, 128)].map(|(dx, dy)| GridPos(x + dx, y + dy));
    let post = Volume { footprint: GridPolygon::simple(corners.to_vec()), ..town.houses[0].volumes[0].clone() };
    town.houses.push(House { id: Id(1), volumes: vec![post], monument: None, ..town.houses[0].clone() });
    let reach = |plan: &CityPlan, cells: &Cells| {
        check(plan, cells).into_iter().find_map(|error| if let CellsError::NotFree { m2 } = error { Some(m2) } else { None })
    };
    assert_eq!(reach(&town, &cells), Some(1.0 / 64.0));
}

#[test]
fn a_mistake_in_the_words_names_the_field() {
    let path = std::env::temp_dir().join(format!("veduta-bad-{}.words.ron", std::process::id()));
    std::fs::write(&path, "(name: \"T\", size_m: 40, plan: Grid())").expect("a file");
    let input = Input::of(&path).unwrap_or_else(|e| panic!("{e}"));
    let error = plan(&input, &BakeSettings::default(), &mut |_| ()).expect_err("too small").to_string();
    std::fs::remove_file(&path).expect("just written");
    assert!(error.contains("`size_m` is 40.0; it must lie between 200 and 4000"), "{error}");
    assert!(overrides_beside(Path::new("a/b.words.ron")).ends_with("b.graph.overrides.ron"));
}
