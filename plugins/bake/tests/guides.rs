//! What visitors find: the sample city's guide, and ways between its places.

use std::path::{Path, PathBuf};
use std::process::Command;

use veduta_bake::{BakeSettings, Input, plan};
use veduta_city::{CityPlan, Guide, file};
use veduta_route::{StreetNet, unreached};

fn sample() -> CityPlan {
    let input = Input::of(Path::new("../../scenes/old_prague")).unwrap_or_else(|e| panic!("{e}"));
    plan(&input, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}")).plan
}

fn check(file: &Path) -> (bool, String) {
    let out = Command::new(env!("CARGO_BIN_EXE_veduta-bake")).arg("check").arg(file).output().expect("the program runs");
    (out.status.success(), format!("{}{}", String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr)))
}

#[test]
fn every_place_of_the_sample_city_is_told_of_in_three_languages() {
    let guide: Guide = file::read(Path::new("../../scenes/old_prague/old_prague.guide.ron")).unwrap_or_else(|e| panic!("{e}"));
    let plan = sample();
    // Houses that the map only names have nothing to tell.
    let told_of = plan.places.iter().filter(|place| !place.text.is_empty());
    assert!(told_of.clone().count() >= 40);
    for place in told_of {
        let told = guide.of(&place.name).unwrap_or_else(|| panic!("nothing is told of {}", place.name));
        for language in ["en", "cs", "it"] {
            let text = told.text.get(language).unwrap_or_else(|| panic!("{} is not told of in {language}", place.name));
            assert!(text.split_whitespace().count() >= 5, "{}: {text}", place.name);
        }
    }
    let (is_good, told) = check(Path::new("../../scenes/old_prague/old_prague.guide.ron"));
    assert!(is_good && told.contains("103 places in 3 languages"), "{told}");
}

#[test]
fn a_guides_mistakes_are_told_with_what_may_be_meant() {
    let folder = std::env::temp_dir().join(format!("veduta-guides-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("room");
    let guide = folder.join("town.guide.ron");
    let city = std::path::absolute(PathBuf::from("../../scenes/old_prague/old_prague.graph.ron")).expect("a path");
    let text = format!(
        "(city: {:?}, places: [(name: \"Powder Towr\"), (name: \"Celetná\", links: [\"javascript:x\"])])",
        city.display().to_string()
    );
    std::fs::write(&guide, text).expect("room");
    let (is_good, told) = check(&guide);
    assert!(
        !is_good && told.contains("no place “Powder Towr”: is it “Powder Tower”") && told.contains("must begin with https://"),
        "{told}"
    );
    std::fs::write(&guide, "(\n  places: [\n    (nam: \"x\"),\n  ],\n)").expect("room");
    let (is_good, told) = check(&guide);
    assert!(!is_good && told.contains("town.guide.ron:3:"), "{told}");
    let _ = std::fs::remove_dir_all(folder);
}

#[test]
fn every_place_can_be_walked_to_from_every_other() {
    let plan = sample();
    let net = StreetNet::new(&plan.streets);
    let apart: Vec<&str> = unreached(&net, &plan.places).iter().map(|one| one.place.name.as_str()).collect();
    assert_eq!(apart, Vec::<&str>::new());
    let stands: Vec<_> = plan.places.iter().map(|place| place.view.map_or(place.pos, |view| view.pos)).collect();
    for (n, &from) in stands.iter().enumerate() {
        for (m, &to) in stands.iter().enumerate() {
            let way = net.way(from, to).unwrap_or_else(|e| panic!("{} to {}: {e}", plan.places[n].name, plan.places[m].name));
            assert!(way.first() == Some(&from) && way.last() == Some(&to));
        }
    }
}
