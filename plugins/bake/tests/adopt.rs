//! Houses that a modeller changed come back as overrides; what was not changed does not.

use std::path::Path;

use gltf_json::Root;
use gltf_json::mesh::Semantic;
use gltf_json::validation::Checked::Valid;
use veduta_bake::{Adopted, BakeError, BakeSettings, ExportSettings, Input, Planned, adopt, export_glb, plan};
use veduta_city::{CityPlan, House};

#[path = "shared/folder.rs"]
mod folder;
use folder::Folder;

const LANE: &str = include_str!("places/lane/lane.graph.ron");
const HILLSIDE: &str = include_str!("places/hillside/hillside.graph.ron");

fn planned(path: &Path) -> Result<Planned, BakeError> {
    plan(&Input::of(path)?, &BakeSettings::default(), &mut |_| ())
}

fn exported(plan: &CityPlan) -> Vec<u8> {
    export_glb(plan, &ExportSettings { texture_px: 16 }).unwrap_or_else(|e| panic!("{e}"))
}

fn adopted(map: &Path, model: &Path) -> Adopted {
    adopt(&Input::of(map).unwrap_or_else(|e| panic!("{e}")), model, &BakeSettings::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// A file's description and buffer.
fn opened(glb: &[u8]) -> (Root, Vec<u8>) {
    let json = u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize;
    (Root::from_slice(&glb[20..20 + json]).unwrap_or_else(|e| panic!("{e}")), glb[28 + json..].to_vec())
}

fn closed(root: &Root, buffer: &[u8]) -> Vec<u8> {
    let mut json = root.to_vec().unwrap_or_else(|e| panic!("{e}"));
    json.resize(json.len().next_multiple_of(4), b' ');
    let word = |n: usize| (n as u32).to_le_bytes();
    let mut glb = [&b"glTF"[..], &word(2), &word(28 + json.len() + buffer.len()), &word(json.len()), b"JSON", &json].concat();
    glb.extend([&word(buffer.len())[..], b"BIN\0", buffer].concat());
    glb
}

/// Moves the corners of a house's roof up.
fn with_roof_raised(glb: &[u8], house: &str, by_m: f32) -> Vec<u8> {
    let (root, mut buffer) = opened(glb);
    let node = root.nodes.iter().find(|node| node.name.as_deref() == Some(house)).expect("the house is there");
    let below = node.children.iter().flatten().map(|child| &root.nodes[child.value()]);
    let roof = below.into_iter().find(|node| node.name.as_deref() == Some("roof")).expect("it has a roof");
    let mesh = &root.meshes[roof.mesh.expect("with faces").value()];
    let mut raised = std::collections::BTreeSet::new();
    for primitive in &mesh.primitives {
        let accessor = &root.accessors[primitive.attributes[&Valid(Semantic::Positions)].value()];
        if !raised.insert(accessor.byte_offset.unwrap_or_default().0) {
            continue;
        }
        let view = &root.buffer_views[accessor.buffer_view.expect("a view").value()];
        let first = (view.byte_offset.unwrap_or_default().0 + accessor.byte_offset.unwrap_or_default().0) as usize;
        for i in 0..accessor.count.0 as usize {
            let at = first + 12 * i + 4;
            let y = f32::from_le_bytes([buffer[at], buffer[at + 1], buffer[at + 2], buffer[at + 3]]);
            buffer[at..at + 4].copy_from_slice(&(y + by_m).to_le_bytes());
        }
    }
    closed(&root, &buffer)
}

fn house<'a>(plan: &'a CityPlan, name: &str) -> &'a House {
    plan.houses.iter().find(|house| house.name == name).expect("there is such a house")
}

#[test]
fn what_nobody_touched_stays() {
    for (name, text) in [("lane", LANE), ("hillside", HILLSIDE)] {
        let folder = Folder::new(&format!("adopt-same-{name}"));
        let map = folder.write(&format!("{name}.graph.ron"), text);
        let plan = planned(&map).unwrap_or_else(|e| panic!("{e}")).plan;
        let model = folder.0.join("city.glb");
        std::fs::write(&model, exported(&plan)).expect("written");
        let adopted = adopted(&map, &model);
        assert_eq!((adopted.changed.len(), adopted.unchanged, adopted.notes), (0, plan.houses.len(), Vec::new()));
        assert!(!adopted.overrides.exists() && !folder.0.join(format!("{name}.models")).exists(), "nothing is written");
    }
}

#[test]
fn a_changed_house_comes_back_and_can_be_changed_again() {
    let folder = Folder::new("adopt-changed");
    let map = folder.write("lane.graph.ron", LANE);
    let own =
        "// Mine.\n(\n  edits: [\n    // An inn now.\n    Building(target: (id: 31, at: (27, -8)), name: \"The Inn\"),\n  ],\n)\n";
    let beside = folder.write("lane.graph.overrides.ron", own);
    let before = planned(&map).unwrap_or_else(|e| panic!("{e}"));
    let model = folder.0.join("edited.glb");
    std::fs::write(&model, with_roof_raised(&exported(&before.plan), "The Inn", 2.5)).expect("written");

    let first = adopted(&map, &model);
    assert_eq!((first.changed.len(), first.unchanged), (1, before.plan.houses.len() - 1));
    assert_eq!(first.changed[0].0, "The Inn");
    let text = std::fs::read_to_string(&beside).expect("there");
    assert!(text.starts_with("// Mine.\n(\n") && text.contains("    // An inn now.\n    Building("), "{text}");
    let after = planned(&map).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(after.findings, before.findings);
    let (inn, was) = (house(&after.plan, "The Inn"), house(&before.plan, "The Inn"));
    assert_eq!((&inn.volumes, was.monument), (&was.volumes, None));
    let design = &after.plan.designs[usize::from(inn.monument.expect("a model stands there").design)];
    let high = |plan: &CityPlan| {
        let (root, buffer) = opened(&exported(plan));
        let nodes = root.nodes.iter().filter_map(|node| node.mesh).flat_map(|mesh| &root.meshes[mesh.value()].primitives);
        let highest = nodes.filter_map(|p| root.accessors[p.attributes[&Valid(Semantic::Positions)].value()].max.clone());
        assert!(!buffer.is_empty());
        highest.filter_map(|max| max.as_array().and_then(|max| max[1].as_f64())).fold(0.0, f64::max)
    };
    let (low, top) = (f64::from(was.volumes[0].top()) / 1024.0, veduta_bake::monument_bounds(design).1.z);
    assert!(top > low + 2.0 && high(&after.plan) >= top, "{top} m over {low} m");
    let others = |plan: &CityPlan| plan.houses.iter().filter(|house| house.name != "The Inn").cloned().collect::<Vec<_>>();
    assert!(others(&after.plan) == others(&before.plan), "the rest is as it was");

    // The same again is no change; another one is, and needs no other edit.
    let again = adopted(&map, &model);
    assert_eq!((again.changed.len(), again.unchanged), (0, before.plan.houses.len()));
    let name = design.name.clone();
    let own = exported(&after.plan);
    let (mut root, buffer) = opened(&own);
    for node in root.nodes.iter_mut().filter(|node| node.name.as_deref() == Some(name.as_str())) {
        node.scale = Some([1.0, 1.5, 1.0]);
    }
    std::fs::write(&model, closed(&root, &buffer)).expect("written");
    let second = adopted(&map, &model);
    assert_eq!(second.changed, first.changed);
    assert_eq!(std::fs::read_to_string(&beside).expect("there"), text);
    let last = planned(&map).unwrap_or_else(|e| panic!("{e}")).plan;
    let design = &last.designs[usize::from(house(&last, "The Inn").monument.expect("still").design)];
    assert!((veduta_bake::monument_bounds(design).1.z / top - 1.5).abs() < 0.01);
}

#[test]
fn grown_houses_on_slopes_come_back_too_and_names_are_enough() {
    let folder = Folder::new("adopt-grown");
    let map = folder.write("hillside.graph.ron", HILLSIDE);
    let before = planned(&map).unwrap_or_else(|e| panic!("{e}")).plan;
    let grown = before.houses.iter().find(|house| house.name.is_empty() && house.floor > 2048).expect("a grown house on the slope");
    let (name, id) = (format!("house {}", grown.id), grown.id);
    let (mut root, buffer) = opened(&with_roof_raised(&exported(&before), &name, 1.0));
    root.nodes.iter_mut().for_each(|node| node.extras = None);
    let model = folder.0.join("edited.glb");
    std::fs::write(&model, closed(&root, &buffer)).expect("written");
    let adopted = adopted(&map, &model);
    assert_eq!(adopted.changed.iter().map(|house| house.0.clone()).collect::<Vec<_>>(), [name]);
    let after = planned(&map).unwrap_or_else(|e| panic!("{e}"));
    let house = after.plan.houses.iter().find(|house| house.id == id).expect("still there");
    let placed = house.monument.expect("a model");
    assert_eq!(placed.z, grown.volumes.iter().map(|volume| volume.bottom).min().expect("volumes"));
    let top = veduta_bake::monument_bounds(&after.plan.designs[usize::from(placed.design)]).1.z + f64::from(placed.z) / 1024.0;
    let was = grown.volumes.iter().map(veduta_city::Volume::top).max().expect("volumes");
    assert!((0.9..4.0).contains(&(top - f64::from(was) / 1024.0)), "{top}");
}

#[test]
fn what_cannot_be_taken_is_told() {
    let folder = Folder::new("adopt-faults");
    let map = folder.write("lane.graph.ron", LANE);
    let told = |models: &str| {
        folder.write("lane.graph.overrides.ron", &format!("(models: [{models}])"));
        planned(&map).err().map(|error| error.to_string()).unwrap_or_default()
    };
    assert!(told("(name: \"a\", file: \"none.glb\")").contains("none.glb: "), "{}", told("(name: \"a\", file: \"none.glb\")"));
    assert!(told("(name: \"a\", file: \"../out.glb\")").contains("leads down from the folder"));
    #[cfg(unix)]
    {
        let outside = Folder::new("adopt-outside");
        std::os::unix::fs::symlink(outside.write("model.glb", "glTF"), folder.0.join("link.glb")).expect("a link");
        let away = told("(name: \"a\", file: \"link.glb\")");
        assert!(
            away.contains("link.glb: ") && away.contains("leads out of the folder") && away.contains("copy the file"),
            "{away}"
        );
    }
    folder.write("text.glb", "{}");
    assert!(told("(name: \"a\", file: \"text.glb\")").contains("export the model as .glb"));
    let plan = planned(folder.write("other.graph.ron", LANE).as_path()).unwrap_or_else(|e| panic!("{e}")).plan;
    std::fs::write(folder.0.join("city.glb"), exported(&plan)).expect("written");
    assert!(told("(name: \"a\", file: \"city.glb\", node: \"nobody\")").contains("no node of it is called `nobody`"));
    assert!(
        told("(name: \"a\", file: \"city.glb\", node: \"The Kiln\"), (name: \"a\", file: \"city.glb\")").contains("two models")
    );
    assert_eq!(told("(name: \"a\", file: \"city.glb\", node: \"The Kiln\")"), "");
    folder.write(
        "lane.graph.overrides.ron",
        "(edits: [House((target: (at: (900, 0)), monument: (name: \"a\")))], models: [(name: \"a\", file: \"city.glb\", node: \"The Kiln\")])",
    );
    let findings = planned(&map).unwrap_or_else(|e| panic!("{e}")).findings;
    assert!(
        findings.iter().any(|f| f.message == "house: none of that id, and none at that place, to be seen as `a`"),
        "{findings:?}"
    );
    std::fs::remove_file(folder.0.join("lane.graph.overrides.ron")).expect("it was there");
    let (mut root, buffer) = opened(&exported(&plan));
    root.nodes.iter_mut().for_each(|node| (node.extras, node.name) = (None, None));
    let model = folder.0.join("nameless.glb");
    std::fs::write(&model, closed(&root, &buffer)).expect("written");
    let error = adopt(&Input::of(&map).expect("read"), &model, &BakeSettings::default()).expect_err("nobody is known").to_string();
    assert!(error.contains("keep the names of its nodes"), "{error}");
}
