//! Cities described in words, from the description to the plan.

use std::path::{Path, PathBuf};

use veduta_bake::{BakeSettings, Input, InputKind, bake, overrides_beside, plan};
use veduta_city::Severity;

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
