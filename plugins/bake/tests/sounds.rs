//! Files of sounds, and recordings and pictures that tours and guides name, are checked as their readers would.

use std::path::{Path, PathBuf};
use std::process::Command;

use veduta_city::{BlockKind, CityGraph, GridPolygon, GridPos, ObjectKind, Sound, Soundscape, file};

fn check(file: &Path) -> (bool, String) {
    let out = Command::new(env!("CARGO_BIN_EXE_veduta-bake")).arg("check").arg(file).output().expect("the program runs");
    (out.status.success(), format!("{}{}", String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr)))
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("veduta-sounds-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("room");
    folder
}

#[test]
fn the_sample_citys_sounds_are_good_and_come_from_where_they_belong() {
    let scene = Path::new("../../scenes/old_prague");
    let (is_good, told) = check(&scene.join("old_prague.sound.ron"));
    assert!(is_good && told.contains("6 sources, 8 cues"), "{told}");
    let sounds: Soundscape = file::read(&scene.join("old_prague.sound.ron")).unwrap_or_else(|e| panic!("{e}"));
    let graph: CityGraph = file::read(&scene.join("old_prague.graph.ron")).unwrap_or_else(|e| panic!("{e}"));
    let fountains: Vec<_> = graph.objects.iter().filter(|object| object.kind == ObjectKind::Fountain).collect();
    let water: Vec<GridPolygon> = graph
        .blocks
        .iter()
        .filter(|block| block.kind == BlockKind::Water)
        .map(|block| GridPolygon::simple(block.outline.iter().map(|&corner| GridPos::from_metres(corner)).collect()))
        .collect();
    for source in &sounds.sources {
        let is_at_a_fountain = fountains.iter().any(|fountain| fountain.pos.distance(source.pos) < 0.5);
        let is_on_water = water.iter().any(|outline| outline.contains(GridPos::from_metres(source.pos)));
        assert!(is_at_a_fountain != is_on_water, "“{}” lies at a fountain or on the river", source.name);
    }
    for bell in ["bell.tyn", "bell.town_hall", "bell.st_nicholas"] {
        assert!(sounds.cue(bell).is_some_and(|cue| matches!(cue.sound, Sound::Bell { .. })), "{bell}");
    }
}

#[test]
fn mistakes_in_sounds_are_told_with_their_place() {
    let folder = folder("mistakes");
    let sounds = folder.join("town.sound.ron");
    std::fs::write(&sounds, "(\n  sources: [\n    (nam: \"x\"),\n  ],\n)").expect("room");
    let (is_good, told) = check(&sounds);
    assert!(!is_good && told.contains("town.sound.ron:3:"), "{told}");
    std::fs::write(&sounds, r#"(cues: {"bell": (sound: File("none.ogg")), "horn": (sound: File("horn.ogg"))})"#).expect("room");
    std::fs::write(folder.join("horn.ogg"), b"no music").expect("room");
    let (is_good, told) = check(&sounds);
    assert!(!is_good && told.contains("none.ogg") && told.contains("`horn.ogg`: it is not Ogg Vorbis"), "{told}");
    let _ = std::fs::remove_dir_all(folder);
}

#[test]
fn tours_and_guides_name_only_what_is_there() {
    let folder = folder("beside");
    std::fs::copy("../synth/tests/tone.ogg", folder.join("tone.ogg")).expect("room");
    let tour = folder.join("a.tour.ron");
    let write = |steps: &str| {
        let text = format!("(title: \"A\", city: \"http://h/c\", steps: [Start(at: At(0, 0)), {steps}])");
        std::fs::write(&tour, text).expect("room");
    };
    write("Narrate(file: \"tone.ogg\", text: \"A tone.\"), Wait(seconds: 3)");
    let (is_good, told) = check(&tour);
    assert!(is_good, "{told}");
    write("Narrate(file: \"tone.ogg\", files: {\"cs\": \"ton.ogg\"}, text: \"A tone.\"), Picture(file: \"no.png\", seconds: 3)");
    let (is_good, told) = check(&tour);
    assert!(
        !is_good
            && told.contains("step 2 (Narrate): there is no file `ton.ogg`")
            && told.contains("step 3 (Picture): there is no file `no.png`"),
        "{told}"
    );
    let guide = folder.join("a.guide.ron");
    let place = "(name: \"A\", sound: \"no.ogg\", pictures: [(file: \"no.webp\", credit: {\"en\": \"own\"})])";
    std::fs::write(&guide, format!("(places: [{place}])")).expect("room");
    let (is_good, told) = check(&guide);
    assert!(!is_good && told.contains("no.ogg") && told.contains("no.webp"), "{told}");
    let _ = std::fs::remove_dir_all(folder);
}
