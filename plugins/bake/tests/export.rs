//! Exported models hold what the plan holds, and are sound binary glTF.

use std::collections::BTreeMap;
use std::path::Path;

use gltf_json::accessor::{ComponentType, GenericComponentType};
use gltf_json::mesh::Semantic;
use gltf_json::validation::{Checked::Valid, Validate};
use gltf_json::{Accessor, Index, Root};
use veduta_bake::{BakeSettings, ExportError, ExportSettings, Input, cut, export_cells, export_glb, plan};
use veduta_city::{CellShell, CityPlan, FacadeSheet, HouseShell, ObjectKind, PlacedMonument, PlanObject, VolumeShell, WallKind};
use veduta_growth::mesh;

fn planned(path: &str) -> CityPlan {
    let input = Input::of(Path::new(path)).unwrap_or_else(|e| panic!("{e}"));
    plan(&input, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}")).plan
}

/// Description and buffer of a binary glTF file.
fn opened(glb: &[u8]) -> (Root, &[u8]) {
    let word = |at: usize| u32::from_le_bytes([glb[at], glb[at + 1], glb[at + 2], glb[at + 3]]) as usize;
    assert_eq!((&glb[..4], word(4), word(8)), (&b"glTF"[..], 2, glb.len()));
    let json = word(12);
    assert_eq!((&glb[16..20], json % 4), (&b"JSON"[..], 0));
    let root = Root::from_slice(&glb[20..20 + json]).unwrap_or_else(|e| panic!("{e}"));
    let buffer = &glb[28 + json..];
    assert_eq!((&glb[24 + json..28 + json], word(20 + json)), (&b"BIN\0"[..], buffer.len()));
    (root, buffer)
}

/// The bytes of an accessor, element by element.
fn elements<'a>(root: &'a Root, buffer: &'a [u8], accessor: Index<Accessor>) -> impl Iterator<Item = &'a [u8]> {
    let accessor = &root.accessors[accessor.value()];
    let view = &root.buffer_views[accessor.buffer_view.expect("no accessor is sparse").value()];
    let Valid(type_) = accessor.type_ else { panic!("no type") };
    let Valid(GenericComponentType(component)) = accessor.component_type else { panic!("no component") };
    let size = type_.multiplicity() * component.size();
    assert_eq!(view.byte_stride.map_or(size, |stride| stride.0), size, "tightly packed");
    let view_begin = view.byte_offset.unwrap_or_default().0 as usize;
    let begin = accessor.byte_offset.unwrap_or_default().0 as usize;
    let end = begin + size * accessor.count.0 as usize;
    assert!(end <= view.byte_length.0 as usize && begin.is_multiple_of(component.size()) && view_begin.is_multiple_of(4));
    buffer[view_begin + begin..view_begin + end].chunks_exact(size)
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}

/// What a node is, by its extras.
fn kind(node: &gltf_json::Node) -> Option<String> {
    serde_json::from_str::<serde_json::Value>(node.extras.as_ref()?.get()).ok()?["kind"].as_str().map(str::to_owned)
}

#[test]
fn an_export_is_sound_and_whole() {
    for scene in ["tests/places/lane/lane.graph.ron", "tests/places/crossroads/crossroads.osm"] {
        let plan = planned(scene);
        let glb = export_glb(&plan, &ExportSettings { texture_px: 32 }).unwrap_or_else(|e| panic!("{e}"));
        let (root, buffer) = opened(&glb);
        let mut mistakes = Vec::new();
        root.validate(&root, gltf_json::Path::new, &mut |path, error| mistakes.push(format!("{}: {error}", path())));
        assert!(mistakes.is_empty(), "{mistakes:?}");
        for primitive in root.meshes.iter().flat_map(|mesh| &mesh.primitives) {
            let positions = primitive.attributes[&Valid(Semantic::Positions)];
            let count = root.accessors[positions.value()].count.0;
            assert!(primitive.attributes.values().all(|a| root.accessors[a.value()].count.0 == count));
            let mut bounds = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
            for p in elements(&root, buffer, positions).map(floats) {
                bounds[0] = [0, 1, 2].map(|i| bounds[0][i].min(p[i]));
                bounds[1] = [0, 1, 2].map(|i| bounds[1][i].max(p[i]));
            }
            let accessor = &root.accessors[positions.value()];
            let told = |value: &Option<serde_json::Value>| -> Vec<f32> {
                let numbers = value.iter().filter_map(serde_json::Value::as_array).flatten();
                numbers.filter_map(serde_json::Value::as_f64).map(|v| v as f32).collect()
            };
            assert_eq!([told(&accessor.min), told(&accessor.max)], bounds.map(Vec::from));
            let normals = primitive.attributes[&Valid(Semantic::Normals)];
            for n in elements(&root, buffer, normals).map(floats) {
                assert!((n.iter().map(|c| c * c).sum::<f32>() - 1.0).abs() < 1e-5);
            }
            let indices = primitive.indices.expect("indexed");
            let Valid(GenericComponentType(ComponentType::U32)) = root.accessors[indices.value()].component_type else { panic!() };
            let most = elements(&root, buffer, indices).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).max();
            assert!(most.is_some_and(|most| u64::from(most) < count));
        }
        for image in &root.images {
            let view = &root.buffer_views[image.buffer_view.expect("within the file").value()];
            let begin = view.byte_offset.unwrap_or_default().0 as usize;
            assert!(buffer[begin..].starts_with(b"\x89PNG"), "{:?}", image.name);
        }

        let count = |of: &str| root.nodes.iter().filter(|node| kind(node).as_deref() == Some(of)).count();
        let walls = || plan.houses.iter().flat_map(|house| &house.volumes).flat_map(|volume| &volume.walls);
        assert_eq!(count("house"), plan.houses.len());
        assert_eq!(count("facade"), walls().filter(|wall| wall.kind == WallKind::Street).count());
        let objects = root.nodes.iter().filter(|node| node.translation.is_some()).count();
        assert_eq!(objects, plan.objects.len());
        let child = |name: &str| root.nodes.iter().find(|node| node.name.as_deref() == Some(name)).expect(name);
        assert_eq!(child("houses").children.as_ref().map(Vec::len), Some(plan.houses.len()));
        // Every node hangs from the scene, once.
        let mut parents = vec![0; root.nodes.len()];
        root.nodes.iter().flat_map(|node| node.children.iter().flatten()).for_each(|child| parents[child.value()] += 1);
        root.scenes[0].nodes.iter().for_each(|node| parents[node.value()] += 1);
        assert!(parents.iter().all(|&n| n == 1), "{scene}: {parents:?}");
    }
}

#[test]
fn cells_hold_every_house_and_object_once_and_share_their_textures() {
    let plan = planned("tests/places/riverside/riverside.graph.ron");
    let (cells, _) = cut(&plan, &[], &BakeSettings::default());
    let mut files: BTreeMap<String, Vec<u8>> = BTreeMap::new();
    let mut write = |path: &str, bytes: &[u8]| -> Result<(), ExportError> {
        assert!(files.insert(path.to_owned(), bytes.to_vec()).is_none(), "{path} is written twice");
        Ok(())
    };
    export_cells(&plan, &cells, &ExportSettings { texture_px: 16 }, &mut write).unwrap_or_else(|e| panic!("{e}"));
    let list: serde_json::Value = serde_json::from_slice(&files["cells.json"]).unwrap_or_else(|e| panic!("{e}"));
    let list = list["cells"].as_array().expect("a list of cells");
    assert_eq!((list.len(), list.len()), (cells.cells.len(), files.keys().filter(|path| path.ends_with(".glb")).count()));
    let (mut ids, mut images): (Vec<String>, Vec<String>) = Default::default();
    for entry in list {
        let (root, _) = opened(&files[entry["file"].as_str().expect("a path")]);
        let mut mistakes = Vec::new();
        root.validate(&root, gltf_json::Path::new, &mut |path, error| mistakes.push(format!("{}: {error}", path())));
        assert!(mistakes.is_empty(), "{mistakes:?}");
        images.extend(root.images.iter().map(|image| image.uri.clone().expect("beside the file")));
        for node in root.nodes.iter().filter(|node| !matches!(kind(node).as_deref(), None | Some("cell" | "facade"))) {
            let extras: serde_json::Value = serde_json::from_str(node.extras.as_ref().expect("a kind").get()).expect("JSON");
            ids.push(extras["id"].as_str().expect("an id").to_owned());
        }
    }
    let mut want: Vec<String> = plan.houses.iter().map(|house| house.id.0.to_string()).collect();
    want.extend(plan.objects.iter().map(|object| object.id.0.to_string()));
    ids.sort();
    want.sort();
    assert_eq!(ids, want);
    images.sort();
    images.dedup();
    assert_eq!(images, files.keys().filter(|path| path.ends_with(".png")).cloned().collect::<Vec<_>>());
    assert!(images.len() > 5 && images.iter().all(|path| files[path].starts_with(b"\x89PNG")), "{images:?}");
}

#[test]
fn an_object_stands_where_it_stands_in_the_game() {
    let plan = planned("tests/places/crossroads/crossroads.osm");
    let glb = export_glb(&plan, &ExportSettings { texture_px: 16 }).unwrap_or_else(|e| panic!("{e}"));
    let (root, _) = opened(&glb);
    let nodes = root.nodes.iter().filter(|node| node.translation.is_some());
    for (node, object) in nodes.zip(&plan.objects) {
        let heading = f64::from(object.heading).to_radians();
        let turn = node.rotation.expect("with a translation").0;
        let [x, y, z] = glam::Quat::from_array(turn).mul_vec3(glam::Vec3::NEG_Z).to_array();
        let front = [heading.sin() as f32, 0.0, -heading.cos() as f32];
        assert!([x, y, z].iter().zip(front).all(|(a, b)| (a - b).abs() < 1e-5), "{:?} looks to {front:?}", node.name);
        let pos = object.pos.to_metres();
        assert_eq!(node.translation, Some([pos.x as f32, veduta_city::metres(object.z) as f32, -pos.y as f32]));
    }
    assert!(!plan.objects.is_empty());
}

#[test]
fn a_monument_is_not_taken_for_a_statue_of_its_kind() {
    let mut plan = planned("tests/places/crossroads/crossroads.osm");
    let stock = veduta_bake::Stock::new().monuments;
    plan.designs = vec![stock.design("obelisk", &BTreeMap::new()).unwrap_or_else(|e| panic!("{e}"))];
    let statue = PlanObject { kind: ObjectKind::Statue, height: 3072, ..plan.objects[0].clone() };
    let placed = PlacedMonument { design: 0, pos: statue.pos, z: statue.z, heading: 0 };
    plan.objects = vec![statue.clone(), PlanObject { monument: Some(placed.design), ..statue.clone() }, statue];
    let glb = export_glb(&plan, &ExportSettings { texture_px: 16 }).unwrap_or_else(|e| panic!("{e}"));
    let (root, _) = opened(&glb);
    let meshes: Vec<_> = root.nodes.iter().filter(|node| node.translation.is_some()).map(|node| node.mesh).collect();
    assert_eq!(meshes.len(), 3);
    assert!(meshes[0].is_some() && meshes[0] == meshes[2] && meshes[0] != meshes[1] && meshes[1].is_some());
}

#[test]
fn a_house_has_the_walls_and_roofs_that_its_cell_has() {
    let plan = planned("tests/places/lane/lane.graph.ron");
    let glb = export_glb(&plan, &ExportSettings { texture_px: 16 }).unwrap_or_else(|e| panic!("{e}"));
    let (root, _) = opened(&glb);
    let nodes = root.nodes.iter().filter(|node| kind(node).as_deref() == Some("house"));
    for (house, node) in plan.houses.iter().zip(nodes) {
        let volumes = house.volumes.iter().map(|volume| VolumeShell::of(volume, (0..volume.walls.len() as u16).collect(), true));
        let shell = HouseShell { style: house.style, floor: house.floor, volumes: volumes.collect(), is_monument: false };
        let shell = CellShell { ground: plan.ground.clone(), houses: vec![shell], ..CellShell::default() };
        let sheet = FacadeSheet::of(house.volumes.iter().flat_map(|volume| volume.walls.iter().cloned()).collect());
        let walls = mesh::level2(&shell, &sheet).unwrap_or_else(|e| panic!("{e}"));
        let want = walls.triangle_count() + mesh::roofs(&shell).triangle_count();
        let meshes = node.children.iter().flatten().filter_map(|child| root.nodes[child.value()].mesh);
        let indices = meshes.flat_map(|mesh| &root.meshes[mesh.value()].primitives).filter_map(|primitive| primitive.indices);
        let found: u64 = indices.map(|i| root.accessors[i.value()].count.0 / 3).sum();
        assert_eq!(found, want as u64, "{:?}", node.name);
    }
}

#[test]
fn an_empty_plan_is_a_scene_without_a_buffer() {
    let glb = export_glb(&CityPlan::default(), &ExportSettings::default()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(glb.len() as u64, 20 + u64::from(u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]])));
    let root = Root::from_slice(&glb[20..]).unwrap_or_else(|e| panic!("{e}"));
    assert!(root.buffers.is_empty() && root.buffer_views.is_empty() && root.nodes.len() == 3);
}

#[test]
fn paving_is_laid_as_in_the_city() {
    let plan = planned("tests/places/lane/lane.graph.ron");
    let glb = export_glb(&plan, &ExportSettings { texture_px: 16 }).unwrap_or_else(|e| panic!("{e}"));
    let (root, buffer) = opened(&glb);
    let ground = root.nodes.iter().find(|node| node.name.as_deref() == Some("ground")).and_then(|node| node.mesh).expect("ground");
    let own = |semantic: Semantic| -> Vec<Vec<f32>> {
        let accessor = root.meshes[ground.value()].primitives[0].attributes[&Valid(semantic)];
        elements(&root, buffer, accessor).map(floats).collect()
    };
    let (terrain, ground) = (plan.terrain.clone(), plan.ground.clone());
    let laid =
        |courses| mesh::ground(&CellShell { terrain: terrain.clone(), ground: ground.clone(), courses, ..CellShell::default() });
    let (along, by_compass) = (laid(plan.courses.clone()), laid(Vec::new()));
    assert_ne!(along.uvs, by_compass.uvs, "the lane does not run east");
    let exported = own(Semantic::TexCoords(0));
    assert!(along.uvs.iter().zip(&exported).all(|(uv, found)| uv[..] == found[..]) && exported.len() >= along.uvs.len());
}
