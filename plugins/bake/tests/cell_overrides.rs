//! A person's edits to cells, in a file beside the map.

#[path = "shared/folder.rs"]
mod folder;

use std::path::Path;
use std::process::Command;

use folder::Folder;
use veduta_bake::{BakeError, BakeSettings, Input, bake, cell_edits, cut, plan};
use veduta_city::{Cells, CellsOverrides, GridPos, Severity, file};
use veduta_store::{DirReader, read_index};

const LANE: &str = "tests/places/lane/lane.graph.ron";

/// Cells of the lane as they are cut by themselves, and two neighbours of them with a place in each.
fn lane() -> (Cells, [(u32, GridPos); 2]) {
    let input = Input::of(Path::new(LANE)).unwrap_or_else(|e| panic!("{e}"));
    let plan = plan(&input, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}")).plan;
    let (cells, _) = cut(&plan, &[], &BakeSettings::default());
    let within = |cell: u32| {
        let outline = &cells.cells[cell as usize].outline;
        let (lo, hi) = outline.bounds().expect("an outline");
        let margin = GridPos(2 * 1024, 2 * 1024);
        let places =
            (0..40).flat_map(|x| (0..40).map(move |y| GridPos(lo.0 + (hi.0 - lo.0) / 40 * x, lo.1 + (hi.1 - lo.1) / 40 * y)));
        let corners =
            |p: GridPos| [p + margin, p - margin, GridPos(p.0 + margin.0, p.1 - margin.1), GridPos(p.0 - margin.0, p.1 + margin.1)];
        places.into_iter().find(|&p| outline.contains(p) && corners(p).into_iter().all(|corner| outline.contains(corner)))
    };
    let pair = cells.portals.iter().find_map(|portal| {
        let other = portal.other(portal.cell)?;
        Some([(portal.cell, within(portal.cell)?), (other, within(other)?)])
    });
    let pair = pair.expect("two wide cells with a portal between them");
    (cells, pair)
}

#[test]
fn a_bake_makes_the_edits_and_tells_of_those_that_it_cannot() {
    let (cells, [a, b]) = lane();
    let place = |(_, pos): (u32, GridPos)| format!("(at: ({:?}, {:?}))", pos.to_metres().x, pos.to_metres().y);
    let folder = Folder::new("cell-edits");
    std::fs::copy(LANE, folder.0.join("lane.graph.ron")).expect("a copy");
    let text = format!(
        "(edits: [Join(target: {}, with: {}), Name(target: {}, name: \"Two in one\"), Name(target: (at: (9000, 0)), name: \"Nowhere\")])",
        place(a),
        place(b),
        place(b)
    );
    let file = folder.write("lane.cells.overrides.ron", &text);
    let input = Input::of(&folder.0.join("lane.graph.ron")).unwrap_or_else(|e| panic!("{e}"));
    assert!(input.files().contains(&file), "a cache looks at it");
    let city = folder.0.join("lane.city");
    let baked = bake(&input.path, &city, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
    let of_cells = |message: &str| message.contains("of the cells");
    let told: Vec<_> = baked.findings.iter().filter(|finding| of_cells(&finding.message)).collect();
    assert!(
        told.len() == 1 && told[0].severity == Severity::Dropped && told[0].message.starts_with("edit 3 of the cells (Name): "),
        "{told:?}"
    );
    let index = read_index(&DirReader::new(&city).unwrap_or_else(|e| panic!("{e}"))).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(index.cells().count(), cells.cells.len() - 1);
    assert!(!city.join("lane.cells.overrides.ron").exists(), "it stays where it is");
    // The same beside the plan that was grown of it.
    assert_eq!(cell_edits(&folder.0.join("lane.plan.ron")).expect("no mistake").len(), 3);
}

#[test]
fn a_mistake_ends_the_bake_before_it_begins_and_is_told_by_check() {
    let folder = Folder::new("cell-mistakes");
    std::fs::copy(LANE, folder.0.join("lane.graph.ron")).expect("a copy");
    let path = folder.write("lane.cells.overrides.ron", "(edits: [Cut(from: (1, 1), to: (1, 1))])");
    let error =
        bake(&folder.0.join("lane.graph.ron"), &folder.0.join("lane.city"), &BakeSettings::default(), &mut |_| panic!("it began"));
    let error = error.expect_err("a mistake");
    assert!(
        matches!(error, BakeError::Overrides { .. }) && error.to_string().contains("lane.cells.overrides.ron: edit 1 (Cut): "),
        "{error}"
    );
    let check = |path: &Path| {
        let done = Command::new(env!("CARGO_BIN_EXE_veduta-bake")).arg("check").arg(path).output().expect("the program runs");
        (done.status.code(), String::from_utf8_lossy(&[done.stdout, done.stderr].concat()).into_owned())
    };
    let (code, told) = check(&path);
    assert!(code == Some(1) && told.contains("edit 1 (Cut): the line from (1.0, 1.0)"), "{told}");
    let good = folder.write("good.cells.overrides.ron", "(edits: [Cut(from: (1, 1), to: (9, 1))])");
    let (code, told) = check(&good);
    assert!(code == Some(0) && told.contains("1 edits of cells"), "{told}");
}

#[test]
fn what_the_readme_shows_can_be_read() {
    let readme = std::fs::read_to_string("../../README.md").expect("there is a README");
    let (_, rest) = readme.split_once("```ron\n( // town.cells.overrides.ron").expect("the README shows one");
    let text = format!("( //{}", rest.split_once("```").expect("it ends").0);
    let overrides: CellsOverrides = file::parse(&text, "README.md").unwrap_or_else(|e| panic!("{e}"));
    assert!(overrides.edits.len() == 3 && overrides.validate().is_empty());
}
