//! The program itself, on a place drawn by hand: exit codes, messages, and that nothing is ever written half.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use veduta_store::{DirReader, read_index};

fn place(file: &str) -> PathBuf {
    Path::new("tests/places").join(file)
}

/// A folder of its own that is removed in the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("veduta-bake-program-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        Self(path)
    }

    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).unwrap_or_else(|e| panic!("{e}"));
        let mut names: Vec<String> =
            entries.map(|e| e.unwrap_or_else(|e| panic!("{e}")).file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn run(arguments: &[&dyn AsRef<std::ffi::OsStr>]) -> (i32, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_veduta-bake"));
    arguments.iter().for_each(|a| {
        command.arg(a.as_ref());
    });
    let Output { status, stdout, stderr } = command.output().unwrap_or_else(|e| panic!("{e}"));
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    (status.code().unwrap_or(-1), text(stdout), text(stderr))
}

#[test]
fn it_ends_in_order_when_nobody_reads_what_it_prints() {
    let (reader, writer) = std::io::pipe().unwrap_or_else(|e| panic!("{e}"));
    drop(reader);
    let folder = Folder::new("pipe");
    let mut survey = Command::new(env!("CARGO_BIN_EXE_veduta-bake"));
    survey.arg("survey").arg(place("crossroads/crossroads.osm")).arg("-o").arg(folder.0.join("a.graph.ron"));
    let writer = [writer.try_clone().unwrap_or_else(|e| panic!("{e}")), writer];
    let [out, err] = writer.map(Stdio::from);
    let status = survey.stdout(out).stderr(err).status().unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(status.code(), Some(0));
    assert_eq!(folder.names(), ["a.graph.ron"]);
}

#[test]
fn a_map_bakes_and_can_be_looked_into() {
    let folder = Folder::new("bake");
    let city = folder.0.join("a.city");
    let (code, out, err) = run(&[&"bake", &place("crossroads/crossroads.osm"), &"-o", &city]);
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("11 houses"), "{out}");
    assert!(err.contains("dropped: 1\n") && err.contains("way/33 at (60, 60)"), "what was dropped is told: {err}");
    let (code, out, err) = run(&[&"inspect", &city]);
    assert_eq!((code, err.as_str()), (0, ""));
    assert!(out.contains("11 houses"), "{out}");
    assert_eq!(folder.names(), ["a.city"]);

    let (code, out, err) = run(&[&"bake", &place("lane/lane.graph.ron"), &"-o", &city, &"--json"]);
    assert_eq!((code, err.as_str()), (0, ""), "a city is replaced by another");
    let figures: serde_json::Value = serde_json::from_str(&out).unwrap_or_else(|e| panic!("{e}: {out}"));
    assert!(figures["stats"]["houses"].as_u64() > Some(20) && figures["seconds"]["cut"].is_number(), "{figures}");
}

#[test]
fn a_damaged_packet_is_found() {
    let folder = Folder::new("damage");
    let city = folder.0.join("a.city");
    assert_eq!(run(&[&"bake", &place("crossroads/crossroads.osm"), &"-o", &city, &"--quiet"]).0, 0);
    let reader = DirReader::new(&city).unwrap_or_else(|e| panic!("{e}"));
    let index = read_index(&reader).unwrap_or_else(|e| panic!("{e}"));
    let packet = index.cells().find_map(|(_, cell)| cell.packets[0]).unwrap_or_else(|| panic!("there are packets"));
    let blob = city.join(packet.path());
    std::fs::remove_file(blob).unwrap_or_else(|e| panic!("{e}"));
    let (code, out, err) = run(&[&"inspect", &city]);
    assert_eq!(code, 1, "{out}");
    assert!(err.contains("bake the city again"), "{err}");
}

/// Overpass's answer for one street and one house.
const OVERPASS: &str = r#"{"version": 0.6, "generator": "by hand", "elements": [
  {"type": "node", "id": 1, "lat": 50.0, "lon": 14.0}, {"type": "node", "id": 2, "lat": 50.0, "lon": 14.001},
  {"type": "node", "id": 3, "lat": 50.0001, "lon": 14.0002}, {"type": "node", "id": 4, "lat": 50.0001, "lon": 14.0004},
  {"type": "node", "id": 5, "lat": 50.0002, "lon": 14.0004}, {"type": "node", "id": 6, "lat": 50.0002, "lon": 14.0002},
  {"type": "way", "id": 7, "nodes": [1, 2], "tags": {"highway": "residential", "name": "Short Street"}},
  {"type": "way", "id": 8, "nodes": [3, 4, 5, 6, 3], "tags": {"building": "yes"}}
]}"#;

#[test]
fn broken_input_leaves_what_stood_there() {
    let folder = Folder::new("broken");
    let city = folder.0.join("a.city");
    let map = folder.0.join("answer.json");
    let write = |bytes: &[u8]| std::fs::write(&map, bytes).unwrap_or_else(|e| panic!("{e}"));
    let xml = std::fs::read(place("crossroads/crossroads.osm")).unwrap_or_else(|e| panic!("{e}"));
    let cuts = |bytes: &[u8]| [0, 1, bytes.len() / 7, bytes.len() / 2, bytes.len() - 3].map(|n| bytes[..n].to_vec());
    let broken: Vec<Vec<u8>> = cuts(OVERPASS.as_bytes()).into_iter().chain(cuts(&xml)).collect();

    for bytes in &broken {
        write(bytes);
        let (code, out, err) = run(&[&"bake", &map, &"-o", &city]);
        assert_eq!(code, 1, "{} bytes: {out}", bytes.len());
        assert!(err.contains("answer.json"), "the message names the file: {err}");
        assert_eq!(folder.names(), ["answer.json"], "nothing is left");
    }
    write(OVERPASS.as_bytes());
    assert_eq!(run(&[&"bake", &map, &"-o", &city]).0, 0);
    let (_, before, _) = run(&[&"inspect", &city, &"--json"]);
    for bytes in &broken {
        write(bytes);
        assert_eq!(run(&[&"bake", &map, &"-o", &city]).0, 1);
        assert_eq!(run(&[&"inspect", &city, &"--json"]).1, before, "the city stands as it stood");
    }
    assert_eq!(folder.names(), ["a.city", "answer.json"]);
}

#[test]
fn wrong_usage_and_missing_files_have_their_exit_codes() {
    let folder = Folder::new("usage");
    let city = folder.0.join("a.city");
    assert_eq!(run(&[&"bake"]).0, 2);
    assert_eq!(run(&[&"roast", &city]).0, 2);
    for missing in ["no.osm.pbf", "no.graph.ron"] {
        let (code, _, err) = run(&[&"bake", &folder.0.join(missing), &"-o", &city]);
        assert_eq!(code, 1);
        assert!(err.contains(missing), "{err}");
    }
    let (code, _, err) = run(&[&"bake", &place("lane/lane.graph.ron"), &"-o", &place("lane")]);
    assert_eq!(code, 1, "a folder with something else in it is not written to");
    assert!(err.contains("lane"), "{err}");
    assert!(folder.names().is_empty());
}

fn write(path: &Path, text: &str) {
    std::fs::write(path, text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
}

#[test]
fn edits_are_applied_once_by_either_way() {
    let folder = Folder::new("edits");
    let map = folder.0.join("town.osm");
    std::fs::copy(place("crossroads/crossroads.osm"), &map).unwrap_or_else(|e| panic!("{e}"));
    write(
        &folder.0.join("town.graph.overrides.ron"),
        "(edits: [AddObject((kind: Bench, pos: (-200, 3), name: \"the only one\")),
                  AddBuilding((name: \"At the Edge\", outline: [(-240, 40), (-230, 40), (-230, 50), (-240, 50)]))])",
    );
    let (graph, plan) = (folder.0.join("town.graph.ron"), folder.0.join("town.plan.ron"));
    let straight = folder.0.join("straight.plan.ron");
    assert_eq!(run(&[&"grow", &map, &"-o", &straight]).0, 0);
    let (code, _, err) = run(&[&"survey", &map, &"-o", &graph]);
    assert_eq!(code, 0, "{err}");
    assert_eq!(run(&[&"grow", &graph, &"-o", &plan]).0, 0);
    let text = |path: &Path| std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    assert_eq!(text(&graph).matches("At the Edge").count(), 0, "edits stay in their own file");
    assert!(text(&plan).contains("At the Edge"));
    assert_eq!(text(&plan), text(&straight), "a stop between the steps changes nothing");
}

/// A street and a square of ground, `x` metres east of the anchor.
fn small_town(x: f64) -> String {
    format!(
        "(name: \"T\", anchor: (lat: 50, lon: 14), nodes: [(id: 1, pos: ({x}, 0)), (id: 2, pos: ({}, 0))],
          links: [(id: 9, from: 1, to: 2, kind: Street(Lane))],
          buildings: [(id: 4, outline: [({x}, 5), ({}, 5), ({}, 15), ({x}, 15)])])",
        x + 60.0,
        x + 12.0,
        x + 12.0
    )
}

#[test]
fn a_mistake_in_the_overrides_is_not_laid_at_the_graphs_door() {
    let folder = Folder::new("overrides");
    let (graph, overrides) = (folder.0.join("t.graph.ron"), folder.0.join("t.graph.overrides.ron"));
    write(&graph, &small_town(0.0));
    let wrong = [
        ("Width(target: (at: (9, 0)), width_m: NaN)", "edit 1 (Width)"),
        ("AddBuilding((outline: [(0, 0), (1, 0)]))", "edit 1 (AddBuilding)"),
        ("AddBuilding((id: 4, outline: [(40, 5), (50, 5), (50, 15)]))", "two buildings have the id 4"),
    ];
    for (edit, reason) in wrong {
        write(&overrides, &format!("(edits: [{edit}])"));
        let (code, _, err) = run(&[&"grow", &graph, &"-o", &folder.0.join("t.plan.ron")]);
        assert_eq!(code, 1);
        assert!(err.contains(&format!("{}: {reason}", overrides.display())), "{edit}: {err}");
        let (code, _, err) = run(&[&"check", &overrides]);
        assert_eq!(code == 1, reason.starts_with("edit"), "checked alone: {err}");
    }
}

#[test]
fn a_town_is_baked_up_to_the_farthest_place_and_not_beyond() {
    let folder = Folder::new("far");
    let (graph, city) = (folder.0.join("t.graph.ron"), folder.0.join("t.city"));
    for x in [899_900.0, -900_000.0] {
        write(&graph, &small_town(x));
        let (code, _, err) = run(&[&"bake", &graph, &"-o", &city]);
        assert_eq!(code, 0, "{x}: {err}");
        assert_eq!(run(&[&"inspect", &city]).0, 0);
    }
    for x in [900_001.0, 1_040_000.0, 2e6] {
        write(&graph, &small_town(x));
        let (code, _, err) = run(&[&"bake", &graph, &"-o", &city]);
        assert_eq!(code, 1);
        assert!(err.contains(&format!("t.graph.ron: node 1 lies at ({x}, 0)")), "{err}");
    }
}

#[test]
fn what_cannot_be_written_leaves_no_part() {
    let folder = Folder::new("part");
    let taken = folder.0.join("taken");
    std::fs::create_dir(&taken).unwrap_or_else(|e| panic!("{e}"));
    for command in ["survey", "grow", "map"] {
        let (code, _, err) = run(&[&command, &place("lane/lane.graph.ron"), &"-o", &taken]);
        assert_eq!(code, 1, "{command}");
        assert!(err.contains("taken"), "{command}: {err}");
        assert_eq!(folder.names(), ["taken"], "{command}");
    }
}

/// A baked city of the lane, with its index.
fn baked(folder: &Folder) -> (PathBuf, veduta_store::CityIndex) {
    let city = folder.0.join("a.city");
    assert_eq!(run(&[&"bake", &place("lane/lane.graph.ron"), &"-o", &city, &"--quiet"]).0, 0);
    let reader = veduta_store::DirReader::new(&city).unwrap_or_else(|e| panic!("{e}"));
    let index = veduta_store::read_index(&reader).unwrap_or_else(|e| panic!("{e}"));
    (city, index)
}

#[test]
fn a_map_is_drawn_as_it_is_wished_for() {
    let folder = Folder::new("map");
    let lane = place("lane/lane.graph.ron");
    let (city, _) = baked(&folder);
    let drawn = |source: &Path, name: &str, wishes: &[&'static str]| {
        let output = folder.0.join(name);
        let mut arguments: Vec<&dyn AsRef<std::ffi::OsStr>> = vec![&"map", &source, &"-o", &output, &"--quiet"];
        arguments.extend(wishes.iter().map(|wish| wish as &dyn AsRef<std::ffi::OsStr>));
        let (code, out, err) = run(&arguments);
        (code, out + &err, std::fs::read(&output).unwrap_or_default())
    };
    let (code, told, svg) = drawn(&lane, "a.svg", &["--paper", "A4", "--scale", "1:500", "--index", "--language", "cs"]);
    let svg = String::from_utf8(svg).unwrap_or_else(|e| panic!("{e}"));
    assert!(code == 0 && told.contains("1:500"), "{told}");
    assert!(svg.contains("1 : 500") && svg.contains("Ulice a místa"), "{svg}");
    let (code, told, png) = drawn(&city, "a.png", &["--paper", "254x127mm", "--dpi", "50", "--inks", "colour-blind"]);
    assert!(code == 0 && png.starts_with(b"\x89PNG"), "{told}");
    // Its header tells 500 by 250 pixels.
    assert_eq!(png.get(16..24), Some(&[0, 0, 1, 244, 0, 0, 0, 250][..]));
    for (name, wishes, code, said) in [
        ("b.svg", &["--layers", "names,moon"][..], 1, "no layer `moon`"),
        ("b.svg", &["--place", "Nowhere"], 1, "no place or street"),
        ("b.svg", &["--language", "tlh"], 1, "not written in `tlh`"),
        ("b.gif", &[], 1, ".svg or .png"),
        ("b.svg", &["--paper", "A9"], 2, "A0 to A5"),
        ("b.svg", &["--scale", "1:0"], 2, "give 100"),
        ("b.png", &["--paper", "A0", "--dpi", "1200"], 1, "fewer pixels"),
    ] {
        let (found, told, bytes) = drawn(&lane, name, wishes);
        assert!(found == code && told.contains(said) && bytes.is_empty(), "{wishes:?}: {found} {told}");
    }
}

#[test]
fn every_part_of_a_city_is_inspected() {
    let folder = Folder::new("parts");
    let (city, index) = baked(&folder);
    let styles = index.styles.unwrap_or_else(|| panic!("a baked city has styles"));
    let overview = index.region(0).unwrap_or_else(|| panic!("read whole")).overview;
    for (name, blob) in [("overview of region 0", overview), ("styles", styles)] {
        let path = city.join(blob.path());
        let bytes = std::fs::read(&path).unwrap_or_else(|e| panic!("{e}"));
        std::fs::remove_file(&path).unwrap_or_else(|e| panic!("{e}"));
        let (code, _, err) = run(&[&"inspect", &city]);
        assert_eq!(code, 1, "without its {name}");
        assert!(err.contains(&format!("{name}: `{}` is missing", blob.path())) && err.contains("one part is broken"), "{err}");
        std::fs::write(&path, bytes).unwrap_or_else(|e| panic!("{e}"));
    }
    assert_eq!(run(&[&"inspect", &city]).0, 0);

    // Two cells swap their façades.
    assert_eq!(index.regions.len(), 1);
    let mut region = veduta_store::Region::clone(index.region(0).unwrap_or_else(|| panic!("read whole")));
    let with_walls: Vec<usize> = (0..region.cells.len()).filter(|&i| region.cells[i].packets[1].is_some()).collect();
    let pair = with_walls.windows(2).find(|pair| region.cells[pair[0]].walls != region.cells[pair[1]].walls);
    let &[a, b] = pair.unwrap_or_else(|| panic!("two cells with different numbers of walls")) else { unreachable!("a pair") };
    let swapped = (region.cells[b].packets[1], region.cells[a].packets[1]);
    (region.cells[a].packets[1], region.cells[b].packets[1]) = swapped;
    let mut forged = index.clone();
    let stored = veduta_store::encode_region(&region, 0, &index.regions);
    let mut regions = index.regions.to_vec();
    regions[0].blob = Some(veduta_store::BlobRef::of(&stored));
    forged.regions = regions.into();
    let path = city.join(forged.regions[0].blob.expect("told").path());
    std::fs::create_dir_all(path.parent().unwrap_or(&city)).unwrap_or_else(|e| panic!("{e}"));
    std::fs::write(path, stored).unwrap_or_else(|e| panic!("{e}"));
    let bytes = veduta_store::encode_index(&forged);
    std::fs::write(city.join(veduta_store::INDEX_NAME), bytes).unwrap_or_else(|e| panic!("{e}"));
    let (code, _, err) = run(&[&"inspect", &city]);
    assert_eq!(code, 1);
    assert!(err.contains(&format!("cell {a}, level 2")) && err.contains("2 parts are broken"), "{err}");
}

#[test]
fn styles_are_told_by_their_folder_or_content() {
    let folder = Folder::new("styles");
    let assets = PathBuf::from("../../assets/styles");
    let (code, out, err) = run(&[&"check", &assets.join("modern.ron"), &assets.join("old_town.ron")]);
    assert_eq!((code, err.as_str()), (0, ""));
    assert!(out.contains("style `modern`") && out.contains("style `old_town`"), "{out}");
    let good = std::fs::read_to_string(assets.join("modern.ron")).unwrap_or_else(|e| panic!("{e}"));
    let here = folder.0.join("glass.ron");
    write(&here, &good);
    assert_eq!(run(&[&"check", &here]).0, 0, "by content");
    write(&here, &good.replace("(18.0, 30.0)", "(30.0, 18.0)"));
    let (code, _, err) = run(&[&"check", &here]);
    assert!(code == 1 && err.contains("glass.ron") && err.contains("frontage_m"), "{err}");
    write(&here, "(unknown: 3)");
    let (code, _, err) = run(&[&"check", &here]);
    assert!(code == 1 && err.contains("not a file of ours"), "{err}");
    std::fs::create_dir(folder.0.join("styles")).unwrap_or_else(|e| panic!("{e}"));
    let meant = folder.0.join("styles/glass.ron");
    write(&meant, &good.replace("shops:", "shop:"));
    let (code, _, err) = run(&[&"check", &meant]);
    assert!(code == 1 && err.contains("glass.ron:19:") && err.contains("`shop`"), "a mistake is shown in its place: {err}");
}

#[test]
fn tours_are_checked_against_the_city_beside_them() {
    let folder = Folder::new("tours");
    let (graph, tour) = (folder.0.join("t.graph.ron"), folder.0.join("t.tour.ron"));
    let check = |city: &str, rest: &str| {
        write(&tour, &format!("(title: \"T\", city: \"{city}\", {rest})"));
        run(&[&"check", &tour])
    };
    let walk = "steps: [Start(at: At(0, 0)), Walk(to: Place(\"The Wel\"))]";
    // No city is here yet.
    for city in ["t.graph.ron", "https://example.org/t.city"] {
        for speed in ["NaN", "-1.0", "1e300"] {
            let (code, _, err) = check(city, &format!("speed: {speed}, {walk}"));
            assert!(
                code == 1 && err.contains("t.tour.ron:1:") && err.contains(": the tour's speed in metres a second is"),
                "{city}, {speed}: {err}"
            );
        }
    }
    write(&graph, &small_town(0.0).replace("buildings:", "places: [(name: \"The Well\", pos: (50, 1))], buildings:"));
    for city in ["t.graph.ron", "t.city"] {
        let (code, _, err) = check(city, walk);
        assert_eq!(code, 1, "{city}");
        assert!(err.contains(": step 2 (Walk): there is no place named \"The Wel\"; did you mean \"The Well\"?"), "{err}");
        let (code, out, err) = check(city, &walk.replace("Wel", "Well"));
        assert!(code == 0 && out.contains("2 steps"), "{out}{err}");
    }
    let (code, _, err) = check("t.graph.ron", &format!("speed: NaN, {walk}"));
    assert!(code == 1 && err.contains(": the tour's speed in metres a second is NaN"), "{err}");
    let (code, out, _) = check("https://example.org/t.city", walk);
    assert!(code == 0 && out.contains("were not looked at"), "{out}");

    let city = folder.0.join("t.city");
    assert_eq!(run(&[&"bake", &graph, &"-o", &city, &"--quiet"]).0, 0);
    std::fs::remove_file(&graph).unwrap_or_else(|e| panic!("{e}"));
    let (code, _, err) = check("t.city", walk);
    assert!(code == 1 && err.contains("The Well"), "a baked city will do: {err}");
    assert_eq!(check("t.city", &walk.replace("Wel", "Well")).0, 0);
}
