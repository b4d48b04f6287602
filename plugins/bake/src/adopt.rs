//! Houses that were changed in a 3D modeller, taken back as overrides.
//!
//! ```text
//!  map ─► plan ─► its houses as they are exported ─┐
//!  edited.glb ─► nodes of houses ──────────────────┴─ differ? ─► X.models/house_ID.glb + edits in X.graph.overrides.ron
//! ```

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};

use glam::{DVec2, Vec3};
use veduta_city::{CityPlan, GraphOverride, GraphOverrides, GridPos, House, ModelFile, MonumentTag, StandIn, Target, file, metres};
use veduta_growth::mesh::MeshData;

use crate::export::{export_model, house_name, house_parts};
use crate::model;
use crate::{BakeError, BakeSettings, ExportSettings, Input, overrides_beside, plan};

/// What was taken back.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Adopted {
    /// The overrides that now tell of it.
    pub overrides: PathBuf,
    /// Houses that had changed: name, and the file of the model.
    pub changed: Vec<(String, PathBuf)>,
    /// How many had not.
    pub unchanged: usize,
    /// What is to be told besides.
    pub notes: Vec<String>,
}

/// Corners nearer than this are one; metres.
const NEAR_M: f32 = 0.004;
/// Pixels a side of the textures in a model: for whoever opens it again, the city paints its own.
const TEXTURE_PX: u32 = 64;
/// Share by which the surface of a tile may differ.
const SAME_AREA: f64 = 2e-3;
/// How much a tile's colour may differ, in linear light.
const SAME_COLOUR: f64 = 0.01;

/// Takes back the houses of an exported city that were changed in a modeller: a model for each of them into `X.models/` beside the map's
/// overrides, and an edit that puts it in the house's place. Houses are known by the `id` in their nodes' extras or, where the modeller left
/// those out, by a name that no other has. Houses that are not in the file stay as they are.
///
/// # Errors
/// If the map or the model cannot be read, the overrides cannot be added to, or a file cannot be written.
pub fn adopt(input: &Input, edited: &Path, settings: &BakeSettings) -> Result<Adopted, BakeError> {
    let planned = plan(input, settings, &mut |_| ())?.plan;
    let fault = |reason| BakeError::Model { path: edited.to_owned(), reason };
    let source = model::File::read(edited).map_err(fault)?;
    let nodes = source.nodes();
    let known = Known::of(&planned);
    let overrides = overrides_beside(&input.path);
    let mut adopted = Adopted { overrides: overrides.clone(), changed: Vec::new(), unchanged: 0, notes: Vec::new() };
    let (mut changed, mut seen) = (Vec::new(), HashSet::new());
    for (i, node) in nodes.iter().enumerate() {
        let Some(h) = known.house(node) else { continue };
        let house = &planned.houses[h];
        if !seen.insert(h) {
            adopted.notes.push(format!("`{}` is there twice: the first one counts", node.name));
            continue;
        }
        let found = source.triangles(&nodes[i..node.end]).map_err(|reason| fault(format!("`{}`: {reason}", node.name)))?;
        let mut own = MeshData::default();
        for (_, part, _) in house_parts(&planned, house).map_err(|error| fault(error.to_string()))? {
            own.append(&part);
        }
        if found.mesh.is_empty() {
            adopted.notes.push(format!("`{}` has no triangles: to take a house out, write RemoveBuilding", node.name));
        } else if is_same(&own, &found.mesh) {
            adopted.unchanged += 1;
        } else {
            for (material, count) in &found.strange {
                let name = &node.name;
                adopted
                    .notes
                    .push(format!("`{name}`: {count} triangles of material `{material}` are seen as plaster in its colour"));
            }
            changed.push((house_name(house), local(found.mesh, house), stand_in(house)));
        }
    }
    if seen.is_empty() {
        return Err(fault(
            "no node of it is a house of this map: export the city with this version, and keep the names of its nodes".to_owned(),
        ));
    }
    write(&overrides, changed, &mut adopted)?;
    Ok(adopted)
}

/// Houses by what nodes tell of them.
struct Known {
    ids: HashMap<u64, usize>,
    /// `None`: several have it.
    names: HashMap<String, Option<usize>>,
}

impl Known {
    fn of(plan: &CityPlan) -> Self {
        let ids = plan.houses.iter().enumerate().map(|(h, house)| (house.id.0, h)).collect();
        let mut names: HashMap<String, Option<usize>> = HashMap::new();
        for (h, house) in plan.houses.iter().enumerate() {
            names.entry(house_name(house)).and_modify(|known| *known = None).or_insert(Some(h));
        }
        Self { ids, names }
    }

    fn house(&self, node: &model::Found) -> Option<usize> {
        match node.id {
            Some(id) if node.kind == "house" => self.ids.get(&id).copied(),
            Some(_) => None,
            None => self.names.get(&node.name).copied().flatten(),
        }
    }
}

/// Where a house's model has its origin.
fn place(house: &House) -> DVec2 {
    let footprint = house.volumes.first().map(|volume| &volume.footprint);
    let corners = || footprint.iter().flat_map(|polygon| &polygon.outer).map(|p| p.to_metres());
    let middle = footprint.map_or(DVec2::ZERO, |polygon| polygon.centroid());
    let is_in = |p: &DVec2| footprint.is_some_and(|polygon| polygon.contains(GridPos::from_metres(*p)));
    let inside = core::iter::once(middle).chain(corners().map(|corner| corner.lerp(middle, 0.1))).find(is_in).unwrap_or(middle);
    (inside * 100.0).round() / 100.0
}

fn stand_in(house: &House) -> StandIn {
    let at = place(house);
    let name = format!("house_{}", house.id.0);
    let monument = MonumentTag { name, pos: Some(at), heading_deg: 180.0, with: BTreeMap::new() };
    StandIn { target: Target { id: house.id, at }, monument }
}

/// A mesh of the city's axes about its house's place and floor.
fn local(mut mesh: MeshData, house: &House) -> MeshData {
    let (at, floor) = (place(house), house.volumes.iter().map(|volume| volume.bottom).min().unwrap_or(0));
    let origin = [at.x, metres(floor), -at.y];
    for p in &mut mesh.positions {
        *p = core::array::from_fn(|axis| (f64::from(p[axis]) - origin[axis]) as f32);
    }
    mesh
}

/// Whether two meshes look the same: each corner of one is one of the other, and so are surface and colour of every tile.
fn is_same(a: &MeshData, b: &MeshData) -> bool {
    let (tiles_a, tiles_b) = (tiles(a), tiles(b));
    let alike = |(x, y): (&Tiled, &Tiled)| {
        let colour = |t: &Tiled, c: usize| t.light[c] / t.area.max(1e-9);
        (x.area - y.area).abs() <= SAME_AREA * x.area.max(1.0) && (0..3).all(|c| (colour(x, c) - colour(y, c)).abs() < SAME_COLOUR)
    };
    tiles_a.keys().eq(tiles_b.keys()) && tiles_a.values().zip(tiles_b.values()).all(alike) && is_within(a, b) && is_within(b, a)
}

/// Surface of a tile, and its colour times that.
#[derive(Default)]
struct Tiled {
    area: f64,
    light: [f64; 3],
}

fn tiles(mesh: &MeshData) -> BTreeMap<i64, Tiled> {
    let mut tiles: BTreeMap<i64, Tiled> = BTreeMap::new();
    for t in mesh.indices.chunks_exact(3) {
        let [a, b, c] = [t[0], t[1], t[2]].map(|i| Vec3::from(mesh.positions[i as usize]));
        let area = f64::from((b - a).cross(c - a).length()) / 2.0;
        let layer = mesh.colours[t[0] as usize][3].round() as i64;
        // A triangle without area is there for nobody.
        if area > 1e-7 {
            let tiled = tiles.entry(layer).or_default();
            tiled.area += area;
            for channel in 0..3 {
                tiled.light[channel] += area * t.iter().map(|&i| f64::from(mesh.colours[i as usize][channel])).sum::<f64>() / 3.0;
            }
        }
    }
    tiles
}

/// Whether every corner of a mesh lies at one of another.
fn is_within(mesh: &MeshData, other: &MeshData) -> bool {
    let cell = |p: Vec3| (p / NEAR_M).round().as_ivec3();
    let mut corners: HashMap<glam::IVec3, Vec<Vec3>> = HashMap::new();
    for &p in &other.positions {
        corners.entry(cell(p.into())).or_default().push(p.into());
    }
    let steps = || (-1..=1).flat_map(|x| (-1..=1).flat_map(move |y| (-1..=1).map(move |z| glam::IVec3::new(x, y, z))));
    let has_near = |p: Vec3| {
        steps().any(|step| corners.get(&(cell(p) + step)).is_some_and(|near| near.iter().any(|q| q.distance(p) <= NEAR_M)))
    };
    mesh.indices.iter().all(|&i| has_near(mesh.positions[i as usize].into()))
}

/// Writes the models, and then the edits that tell of those that were not known.
fn write(overrides: &Path, changed: Vec<(String, MeshData, StandIn)>, adopted: &mut Adopted) -> Result<(), BakeError> {
    let name = overrides.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let folder = format!("{}.models", name.strip_suffix(".graph.overrides.ron").unwrap_or(&name));
    let failed = |path: &Path, reason: String| BakeError::Model { path: path.to_owned(), reason };
    let (text, known): (String, GraphOverrides) = if overrides.exists() {
        let source = std::fs::read_to_string(overrides).map_err(|source| BakeError::Read { path: overrides.to_owned(), source })?;
        let known = file::read(overrides)?;
        (source, known)
    } else {
        ("(\n)\n".to_owned(), GraphOverrides::default())
    };
    let (mut new_text, mut expected) = (text.clone(), known);
    for (title, mesh, stand_in) in changed {
        let name = stand_in.monument.name.clone();
        let relative = format!("{folder}/{name}.glb");
        let path = overrides.with_file_name(&folder).join(format!("{name}.glb"));
        let bytes = export_model(&title, &mesh, &ExportSettings { texture_px: TEXTURE_PX })
            .map_err(|error| failed(&path, error.to_string()))?;
        std::fs::create_dir_all(overrides.with_file_name(&folder))
            .map_err(|source| BakeError::Read { path: path.clone(), source })?;
        file::write_bytes(&bytes, &path)?;
        adopted.changed.push((title, path));
        if !expected.models.iter().any(|model| model.name == name) {
            let model = ModelFile { name: name.clone(), file: relative, node: String::new() };
            new_text = add(&new_text, "models", &entry(&model)?);
            expected.models.insert(0, model);
        }
        let is_edit = |edit: &GraphOverride| matches!(edit, GraphOverride::House(known) if known.monument.name == name);
        if !expected.edits.iter().any(is_edit) {
            let edit = GraphOverride::House(stand_in);
            new_text = add(&new_text, "edits", &entry(&edit)?);
            expected.edits.insert(0, edit);
        }
    }
    if new_text != text {
        let is_right = file::parse::<GraphOverrides>(&new_text, &name).is_ok_and(|read| read == expected);
        if !is_right {
            return Err(failed(overrides, "could not be added to: give it the lists `models: []` and `edits: []`".to_owned()));
        }
        file::write_bytes(new_text.as_bytes(), overrides)?;
    }
    Ok(())
}

/// An entry of a list, on one line.
fn entry<T: serde::Serialize>(value: &T) -> Result<String, BakeError> {
    let told = |error: ron::Error| BakeError::Model { path: PathBuf::new(), reason: error.to_string() };
    let options = ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    options.to_string_pretty(value, ron::ser::PrettyConfig::new().depth_limit(0)).map_err(told)
}

/// The text of a file with an entry more at the head of one of its lists; the rest stays as somebody wrote it.
fn add(text: &str, list: &str, entry: &str) -> String {
    let (mut depth, mut open, mut head) = (0, None, None);
    let mut rest = text.char_indices().peekable();
    let mut word = String::new();
    while let Some((i, c)) = rest.next() {
        match c {
            '/' if text[i..].starts_with("//") => while rest.next_if(|&(_, c)| c != '\n').is_some() {},
            '/' if text[i..].starts_with("/*") => {
                let end = text[i..].find("*/").map_or(text.len(), |n| i + n + 2);
                while rest.next_if(|&(at, _)| at < end).is_some() {}
            }
            '"' => {
                let mut is_escaped = false;
                for (_, c) in rest.by_ref() {
                    if c == '"' && !is_escaped {
                        break;
                    }
                    is_escaped = c == '\\' && !is_escaped;
                }
            }
            '(' | '[' | '{' => {
                if depth == 0 {
                    open = Some(i + c.len_utf8());
                } else if depth == 1 && c == '[' && word == list {
                    head = head.or(Some(i + 1));
                }
                depth += 1;
                word.clear();
            }
            ')' | ']' | '}' => depth -= 1,
            ',' => word.clear(),
            c if depth == 1 && (c.is_alphanumeric() || c == '_') => word.push(c),
            _ => {}
        }
    }
    match (head, open) {
        (Some(at), _) => format!("{}\n    {entry},{}", &text[..at], &text[at..]),
        (None, Some(at)) => format!("{}\n  {list}: [\n    {entry},\n  ],{}", &text[..at], &text[at..]),
        (None, None) => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_goes_to_the_head_of_its_list_and_the_rest_stays() {
        let cases = [
            ("(\n)\n", "(\n  edits: [\n    X,\n  ],\n)\n"),
            ("(edits: [A])", "(edits: [\n    X,A])"),
            (
                "// edits: [\n(\n  styles: [(name: \"edits: [\")], /* edits: [ */ edits: [\n    A, // why\n  ],\n)",
                "// edits: [\n(\n  styles: [(name: \"edits: [\")], /* edits: [ */ edits: [\n    X,\n    A, // why\n  ],\n)",
            ),
            ("(models: [(edits: [1])], edits: [])", "(models: [(edits: [1])], edits: [\n    X,])"),
            (r#"(styles: [(name: "a\"(")])"#, "(\n  edits: [\n    X,\n  ],styles: [(name: \"a\\\"(\")])"),
        ];
        for (text, want) in cases {
            assert_eq!(add(text, "edits", "X"), want);
        }
    }

    #[test]
    fn what_moved_was_repainted_or_went_is_not_the_same() {
        let mut mesh = MeshData::default();
        for (i, p) in [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 4.0, 0.0], [0.0, 4.0, 0.0]].into_iter().enumerate() {
            mesh.positions.push(p);
            mesh.normals.push([0.0, 0.0, 1.0]);
            mesh.uvs.push([i as f32, 0.0]);
            mesh.centres.push([0.0; 2]);
            mesh.colours.push([0.5, 0.4, 0.3, 2.0]);
        }
        mesh.indices = vec![0, 1, 2, 0, 2, 3];
        let turned = MeshData { indices: vec![2, 3, 0, 1, 2, 0], ..mesh.clone() };
        assert!(is_same(&mesh, &turned), "the order of triangles means nothing");
        let changed = |change: &dyn Fn(&mut MeshData)| {
            let mut other = mesh.clone();
            change(&mut other);
            is_same(&mesh, &other) || is_same(&other, &mesh)
        };
        assert!(changed(&|m| m.positions[0][0] += 0.002), "what a file's numbers lose means nothing");
        assert!(!changed(&|m| m.positions[2][1] += 0.02));
        assert!(!changed(&|m| m.colours.iter_mut().for_each(|c| c[1] = 0.45)));
        assert!(!changed(&|m| m.colours.iter_mut().for_each(|c| c[3] = 3.0)));
        assert!(!changed(&|m| m.indices.truncate(3)));
        assert!(!changed(&|m| m.indices.extend([0, 1, 2])));
    }
}
