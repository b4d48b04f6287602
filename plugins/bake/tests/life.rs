//! What lives in the sample city: the file beside it, held against the city itself.

use std::path::{Path, PathBuf};
use std::process::Command;

use glam::DVec2;
use veduta_bake::{BakeSettings, Input, plan};
use veduta_city::{GridPos, Life, LifeKind, file};

const SAMPLE: &str = "../../scenes/old_prague/old_prague.life.ron";

fn check(file: &Path) -> (bool, String) {
    let out = Command::new(env!("CARGO_BIN_EXE_veduta-bake")).arg("check").arg(file).output().expect("the program runs");
    (out.status.success(), format!("{}{}", String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr)))
}

#[test]
fn the_sample_citys_file_is_right_and_its_things_stand_where_they_can() {
    let (is_good, told) = check(Path::new(SAMPLE));
    assert!(is_good && told.contains("living things"), "{told}");
    let life: Life = file::read(Path::new(SAMPLE)).unwrap_or_else(|e| panic!("{e}"));
    let input = Input::of(Path::new("../../scenes/old_prague")).unwrap_or_else(|e| panic!("{e}"));
    let plan = plan(&input, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}")).plan;
    let in_house = |at: DVec2| {
        let pos = GridPos::from_metres(at);
        plan.houses.iter().flat_map(|house| &house.volumes).any(|volume| volume.footprint.contains(pos))
    };
    for thing in &life.things {
        let find = |name: &str| plan.places.iter().find(|place| place.name == name).map(|place| place.pos);
        let at = thing.plan_pos(find).unwrap_or_else(|| panic!("{}", thing.name));
        let heading = thing.heading_deg.to_radians();
        let front = DVec2::new(heading.sin(), heading.cos());
        match thing.kind {
            LifeKind::Flock { .. } | LifeKind::Fountain { .. } => assert!(!in_house(at), "{} is in a house", thing.name),
            // Arms and poles reach out of a wall.
            LifeKind::Sign { .. } => {
                assert!(in_house(at - front * 0.4) && !in_house(at + front * 0.4), "{} hangs on no wall", thing.name);
            }
            LifeKind::Flag { tilt_deg, .. } if tilt_deg > 0.0 => {
                assert!(in_house(at - front * 0.6) && !in_house(at + front * 0.6), "{} hangs on no wall", thing.name);
            }
            LifeKind::Clock { .. } => assert!(in_house(at - front * 2.0), "{} hangs on no wall", thing.name),
            _ => {}
        }
    }
}

#[test]
fn mistakes_are_told_with_what_may_be_meant() {
    let folder = std::env::temp_dir().join(format!("veduta-lives-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("room");
    let path = folder.join("town.life.ron");
    let city = std::path::absolute(PathBuf::from("../../scenes/old_prague/old_prague.graph.ron")).expect("a path");
    let city = city.display().to_string();
    let text = format!("(city: {city:?}, things: [(name: \"c\", at: Place(\"Old Town Hal\"), kind: Clock(radius_m: 99))])");
    std::fs::write(&path, text).expect("room");
    let (is_good, told) = check(&path);
    assert!(!is_good, "{told}");
    assert!(told.contains("clock “c”: the map has no place “Old Town Hal”: is it “Old Town Hall”"), "{told}");
    assert!(told.contains("clock “c”: radius_m is 99; give 0.05 to 20"), "{told}");
    std::fs::write(&path, "(\n  things: [\n    (name: \"c\", at: At(0, 0), kind: Clok(radius_m: 1)),\n  ],\n)").expect("room");
    let (is_good, told) = check(&path);
    assert!(!is_good && told.contains("town.life.ron:3:") && told.contains("Clock"), "{told}");
    let _ = std::fs::remove_dir_all(folder);
}
