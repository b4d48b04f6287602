//! Models from binary glTF files.
//!
//! ```text
//!  X.glb ─► File ─► node ─► Triangles ─┬─► Design, for growth
//!                                      └─► MeshData, for export
//! ```
//! A material of the texture workshop's is known by its name, as [`crate::export_glb`] writes it; any other is seen as plaster in its colour.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

use glam::{Affine3A, Mat4, Vec3};
use gltf::Semantic;
use gltf::accessor::{DataType, Dimensions};
use gltf::mesh::Mode;
use veduta_city::monument::{Content, Material, Model, ModelVertex, Piece};
use veduta_city::{Design, GRID_PER_METRE, GraphOverrides, ModelFile, Rgb, Tile};
use veduta_growth::mesh::MeshData;

use crate::BakeError;
use crate::scene::below;

/// Largest file that is read.
const MOST_BYTES: u64 = 1 << 30;
/// Most triangles of one model.
const MOST_TRIANGLES: usize = 200_000;
/// Most materials of a design.
const MOST_MATERIALS: usize = 256;
/// Ratios of a design are in these.
const RATIO: f32 = 1024.0;

/// Why a model was not read, in a clause.
pub(crate) type Fault = String;

/// A binary glTF file.
pub(crate) struct File {
    gltf: gltf::Document,
    blob: Vec<u8>,
}

/// A node, with what is known of it and what is below it.
pub(crate) struct Found {
    pub(crate) name: String,
    /// Of `extras`: its kind and id as export writes them.
    pub(crate) kind: String,
    pub(crate) id: Option<u64>,
    mesh: Option<usize>,
    place: Affine3A,
    /// Where in the list the nodes below it end.
    pub(crate) end: usize,
}

/// What a node comes to, in the file's own axes; metres.
#[derive(Default)]
pub(crate) struct Triangles {
    pub(crate) mesh: MeshData,
    /// Materials of a name that is none of the workshop's.
    pub(crate) strange: BTreeMap<String, usize>,
}

impl File {
    pub(crate) fn read(path: &Path) -> Result<Self, Fault> {
        let bytes = std::fs::metadata(path).map_err(|error| error.to_string())?.len();
        if bytes > MOST_BYTES {
            return Err(format!("{bytes} bytes are more than the {MOST_BYTES} that a model may have"));
        }
        let content = std::fs::read(path).map_err(|error| error.to_string())?;
        Self::parse(&content)
    }

    pub(crate) fn parse(content: &[u8]) -> Result<Self, Fault> {
        if !content.starts_with(b"glTF") {
            return Err("not a binary glTF file: export the model as .glb".to_owned());
        }
        let told = |error: gltf::Error| format!("glTF: {error}");
        let gltf::Glb { json, bin, .. } = gltf::Glb::from_slice(content).map_err(told)?;
        let root = gltf::json::Root::from_slice(&json).map_err(|error| told(error.into()))?;
        // What checks the description takes these for granted.
        let of_meshes = root.meshes.iter().flat_map(|mesh| &mesh.primitives).flat_map(|primitive| primitive.attributes.values());
        if of_meshes.map(gltf::json::Index::value).any(|accessor| accessor >= root.accessors.len()) {
            return Err("glTF: a mesh has vertices that are not there".to_owned());
        }
        let gltf = gltf::Document::from_json(root).map_err(told)?;
        if gltf.buffers().any(|buffer| matches!(buffer.source(), gltf::buffer::Source::Uri(_))) {
            return Err("it keeps vertices in other files: export the model as one .glb".to_owned());
        }
        let blob = bin.map(Cow::into_owned).unwrap_or_default();
        // The reader takes what the description says for granted.
        let is_there = |view: gltf::buffer::View<'_>| view.offset().checked_add(view.length()).is_some_and(|end| end <= blob.len());
        if gltf.views().all(is_there) && gltf.accessors().all(|accessor| fits(&accessor)) {
            Ok(Self { gltf, blob })
        } else {
            Err("its vertices reach beyond its end: export the model again".to_owned())
        }
    }

    /// All nodes of its scene, each followed by those below it.
    pub(crate) fn nodes(&self) -> Vec<Found> {
        let scene = self.gltf.default_scene().or_else(|| self.gltf.scenes().next());
        let mut left: Vec<(gltf::Node<'_>, Affine3A, Option<usize>)> =
            scene.into_iter().flat_map(|scene| scene.nodes()).map(|node| (node, Affine3A::IDENTITY, None)).collect();
        left.reverse();
        let (mut found, count): (Vec<Found>, usize) = (Vec::new(), self.gltf.nodes().len());
        let mut above: Vec<Option<usize>> = Vec::new();
        while let Some((node, frame, parent)) = left.pop().filter(|_| found.len() < count) {
            let place = frame * Affine3A::from_mat4(Mat4::from_cols_array_2d(&node.transform().matrix()));
            let below: Vec<gltf::Node<'_>> = node.children().collect();
            left.extend(below.into_iter().rev().map(|child| (child, place, Some(found.len()))));
            let extras: serde_json::Value =
                node.extras().as_ref().and_then(|raw| serde_json::from_str(raw.get()).ok()).unwrap_or_default();
            let text = |key: &str| extras.get(key).and_then(serde_json::Value::as_str).unwrap_or_default();
            found.push(Found {
                name: node.name().unwrap_or_default().to_owned(),
                kind: text("kind").to_owned(),
                id: text("id").parse().ok(),
                mesh: node.mesh().map(|mesh| mesh.index()),
                place,
                end: found.len() + 1,
            });
            above.push(parent);
        }
        for i in (0..found.len()).rev() {
            if let Some(parent) = above[i] {
                found[parent].end = found[parent].end.max(found[i].end);
            }
        }
        found
    }

    /// What some nodes come to.
    pub(crate) fn triangles(&self, nodes: &[Found]) -> Result<Triangles, Fault> {
        let mut out = Triangles::default();
        let meshes: Vec<gltf::Mesh<'_>> = self.gltf.meshes().collect();
        for (mesh, place) in nodes.iter().filter_map(|node| Some((meshes.get(node.mesh?)?, node.place))) {
            for primitive in mesh.primitives() {
                self.add(&primitive, place, &mut out)?;
                if out.mesh.indices.len() > 3 * MOST_TRIANGLES {
                    return Err(format!("it has more than {MOST_TRIANGLES} triangles: model it with fewer"));
                }
            }
        }
        Ok(out)
    }

    fn add(&self, primitive: &gltf::Primitive<'_>, place: Affine3A, out: &mut Triangles) -> Result<(), Fault> {
        if primitive.mode() != Mode::Triangles {
            return Ok(());
        }
        if !is_readable(primitive) {
            return Err("its vertices are told in a way that glTF does not have: export the model again".to_owned());
        }
        let reader = primitive.reader(|buffer| (buffer.index() == 0).then_some(self.blob.as_slice()));
        let positions: Vec<Vec3> =
            reader.read_positions().into_iter().flatten().map(|p| place.transform_point3(p.into())).collect();
        let index: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..positions.len() as u32).collect(),
        };
        if index.iter().any(|&i| i as usize >= positions.len()) || !positions.iter().all(|p| p.is_finite()) {
            return Err("a triangle of it has corners that are nowhere".to_owned());
        }
        let mirrored = place.matrix3.determinant() < 0.0;
        let turned = place.matrix3.inverse().transpose();
        let normals: Option<Vec<Vec3>> = reader.read_normals().map(|all| all.map(|n| turned * Vec3::from(n)).collect());
        let uvs: Option<Vec<[f32; 2]>> = reader.read_tex_coords(0).map(|all| all.into_f32().collect());
        let colours: Option<Vec<[f32; 4]>> = reader.read_colors(0).map(|all| all.into_rgba_f32().collect());
        let material = primitive.material();
        let [r, g, b, _] = material.pbr_metallic_roughness().base_color_factor();
        let tile = tile_of(material.name().unwrap_or_default());
        if tile.is_none() {
            *out.strange.entry(material.name().unwrap_or("(none)").to_owned()).or_default() += index.len() / 3;
        }
        let layer = tile.unwrap_or(Tile::Plaster).index() as f32;
        for triangle in index.chunks_exact(3) {
            let [a, b_, c] = [triangle[0], triangle[1], triangle[2]].map(|i| positions[i as usize]);
            let flat = (b_ - a).cross(c - a);
            if flat.length_squared() < 1e-14 {
                continue;
            }
            let flat = if mirrored { -flat } else { flat }.normalize();
            let corners = if mirrored { [triangle[0], triangle[2], triangle[1]] } else { [triangle[0], triangle[1], triangle[2]] };
            for i in corners.map(|i| i as usize) {
                let mesh = &mut out.mesh;
                mesh.indices.push(mesh.positions.len() as u32);
                mesh.positions.push(positions[i].to_array());
                let normal = normals.as_ref().and_then(|all| all.get(i)).map_or(flat, |n| n.try_normalize().unwrap_or(flat));
                mesh.normals.push(normal.to_array());
                mesh.uvs.push(uvs.as_ref().and_then(|all| all.get(i).copied()).unwrap_or([0.0; 2]));
                mesh.centres.push([0.0; 2]);
                let [cr, cg, cb, _] = colours.as_ref().and_then(|all| all.get(i).copied()).unwrap_or([1.0; 4]);
                mesh.colours.push([r * cr, g * cg, b * cb, layer]);
            }
        }
        Ok(())
    }
}

/// Whether what tells of a primitive's corners is of the types that glTF has for it.
fn is_readable(primitive: &gltf::Primitive<'_>) -> bool {
    let is_sound = |(semantic, accessor): (Semantic, gltf::Accessor<'_>)| {
        let (data, shape) = (accessor.data_type(), accessor.dimensions());
        let is_share = matches!(data, DataType::F32 | DataType::U8 | DataType::U16);
        match semantic {
            Semantic::Positions | Semantic::Normals => (data, shape) == (DataType::F32, Dimensions::Vec3),
            Semantic::TexCoords(0) => is_share && shape == Dimensions::Vec2,
            Semantic::Colors(0) => is_share && matches!(shape, Dimensions::Vec3 | Dimensions::Vec4),
            _ => true,
        }
    };
    let is_index = |accessor: gltf::Accessor<'_>| {
        matches!(accessor.data_type(), DataType::U8 | DataType::U16 | DataType::U32) && accessor.dimensions() == Dimensions::Scalar
    };
    primitive.attributes().all(is_sound) && primitive.indices().is_none_or(is_index)
}

/// Whether an accessor lies within its view; one that is told by differences does not.
fn fits(accessor: &gltf::Accessor<'_>) -> bool {
    let Some(view) = accessor.view().filter(|_| accessor.sparse().is_none()) else { return false };
    let stride = view.stride().unwrap_or(accessor.size());
    if stride < accessor.size() {
        return false;
    }
    let last = accessor.count().checked_sub(1).and_then(|n| n.checked_mul(stride));
    last.and_then(|last| last.checked_add(accessor.offset())?.checked_add(accessor.size())).is_some_and(|end| end <= view.length())
}

/// The tile that a material's name means: `Plaster`, `Bay(Window)`, and `Plaster.001` as modellers number them.
fn tile_of(name: &str) -> Option<Tile> {
    let name = match name.rsplit_once('.') {
        Some((stem, number)) if number.chars().all(|c| c.is_ascii_digit()) => stem,
        _ => name,
    };
    Tile::all().find(|tile| !tile.is_card() && format!("{tile:?}") == name)
}

/// A mesh as a design: a piece for each material and each part of it that hangs together. Its front looks to +z.
pub(crate) fn design(name: &str, mesh: &MeshData) -> Result<Design, Fault> {
    let mut design = Design { name: name.to_owned(), ..Design::default() };
    let mut groups: BTreeMap<Material, Vec<&[u32]>> = BTreeMap::new();
    for triangle in mesh.indices.chunks_exact(3) {
        groups.entry(material(mesh, triangle)).or_default().push(triangle);
    }
    if groups.len() > MOST_MATERIALS {
        return Err(format!("it has {} colours and materials, more than {MOST_MATERIALS}: paint it with fewer", groups.len()));
    }
    for (paint, (material, triangles)) in (0..).zip(groups) {
        design.materials.push(material);
        for part in parts(mesh, &triangles) {
            let mut model = Model::default();
            for triangle in part {
                let first = model.vertices.len() as u32;
                model.vertices.extend(triangle.iter().map(|&i| vertex(mesh, i as usize)));
                model.triangles.push([first, first + 1, first + 2]);
            }
            shared(&mut model);
            let content = Content::Model(model);
            let (turn, scale) = ([0; 3], [RATIO as i32; 3]);
            design.pieces.push(Piece { at: [0; 3], turn, scale, mirror: None, repeat: None, paint, infill: None, content });
        }
    }
    design.check().map_err(|error| error.to_string())?;
    Ok(design)
}

/// The colour of a triangle's middle, and its tile.
fn material(mesh: &MeshData, triangle: &[u32]) -> Material {
    let corners = || triangle.iter().map(|&i| mesh.colours[i as usize]);
    let channel = |c: usize| corners().map(|colour| colour[c]).sum::<f32>() / 3.0;
    let layer = corners().next().map_or(0.0, |colour| colour[3]);
    let tile = Tile::all().nth(layer.round().max(0.0) as usize).unwrap_or(Tile::Plaster);
    Material { colour: Rgb::from_linear([channel(0), channel(1), channel(2)]), tile }
}

fn vertex(mesh: &MeshData, i: usize) -> ModelVertex {
    let ([x, y, z], [nx, ny, nz], [u, v]) = (mesh.positions[i], mesh.normals[i], mesh.uvs[i]);
    let steps = |metres: f32| (metres * GRID_PER_METRE as f32).round() as i32;
    let normal = [nx, -nz, ny].map(|n| (n * 127.0).round().clamp(-127.0, 127.0) as i8);
    ModelVertex { at: [steps(x), steps(-z), steps(y)], normal, uv: [u, v].map(|n| (n * RATIO).round() as i32) }
}

/// Lets triangles share their equal corners.
fn shared(model: &mut Model) {
    let mut known = std::collections::HashMap::new();
    let mut vertices = Vec::new();
    let all = core::mem::take(&mut model.vertices);
    let mut place = |i: u32| {
        let vertex = all[i as usize];
        *known.entry(vertex).or_insert_with(|| {
            vertices.push(vertex);
            vertices.len() as u32 - 1
        })
    };
    model.triangles.iter_mut().for_each(|triangle| *triangle = triangle.map(&mut place));
    model.vertices = vertices;
}

/// Triangles grouped by what hangs together at common corners, in the order of their first.
fn parts<'a>(mesh: &MeshData, triangles: &[&'a [u32]]) -> Vec<Vec<&'a [u32]>> {
    let mut numbers: BTreeMap<[i32; 3], usize> = BTreeMap::new();
    let mut parent: Vec<usize> = Vec::new();
    let mut corner = |i: u32| {
        let next = numbers.len();
        let number = *numbers.entry(vertex(mesh, i as usize).at).or_insert(next);
        if number == parent.len() {
            parent.push(number);
        }
        number
    };
    let corners: Vec<[usize; 3]> = triangles.iter().map(|t| [corner(t[0]), corner(t[1]), corner(t[2])]).collect();
    fn root(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    for [a, b, c] in &corners {
        for other in [b, c] {
            let (a, other) = (root(&mut parent, *a), root(&mut parent, *other));
            let (low, high) = (a.min(other), a.max(other));
            parent[high] = low;
        }
    }
    let mut parts: BTreeMap<usize, Vec<&[u32]>> = BTreeMap::new();
    for (triangle, [a, ..]) in triangles.iter().zip(&corners) {
        parts.entry(root(&mut parent, *a)).or_default().push(triangle);
    }
    parts.into_values().collect()
}

/// The designs of the models that overrides name, and what is to be told of them. `path`: of the overrides.
///
/// # Errors
/// Everything that is wrong with any of them.
pub fn read_models(overrides: &GraphOverrides, path: &Path) -> Result<(Vec<Design>, Vec<String>), Vec<BakeError>> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let (mut designs, mut notes, mut errors): (Vec<Design>, Vec<String>, Vec<BakeError>) = Default::default();
    for (i, model) in overrides.models.iter().enumerate() {
        let made = if overrides.models[..i].iter().any(|other| other.name == model.name) {
            Err(format!("two models are called `{}`", model.name))
        } else {
            read(model, folder)
        };
        match made {
            Ok((design, told)) => {
                designs.push(design);
                notes.extend(told);
            }
            Err(reason) => errors.push(BakeError::Model { path: folder.join(&model.file), reason }),
        }
    }
    if errors.is_empty() { Ok((designs, notes)) } else { Err(errors) }
}

/// The design of a model that overrides name, and what is to be told of it. `folder`: that of the overrides.
fn read(model: &ModelFile, folder: &Path) -> Result<(Design, Vec<String>), Fault> {
    if model.name.is_empty() {
        return Err("a model needs a name".to_owned());
    }
    let path = below(folder, &model.file).map_err(|astray| astray.to_string())?;
    let file = File::read(&path)?;
    let nodes = file.nodes();
    let own = match model.node.as_str() {
        "" => &nodes[..],
        name => {
            let i = nodes.iter().position(|node| node.name == name).ok_or_else(|| format!("no node of it is called `{name}`"))?;
            &nodes[i..nodes[i].end]
        }
    };
    let made = file.triangles(own)?;
    if made.mesh.is_empty() {
        return Err("there are no triangles in it".to_owned());
    }
    let told = made.strange.iter().map(|(name, count)| {
        format!(
            "model `{}`: {count} triangles of material `{name}` are seen as plaster in its colour, for Veduta has no such",
            model.name
        )
    });
    Ok((design(&model.name, &made.mesh)?, told.collect()))
}

#[cfg(test)]
mod tests {
    use veduta_city::{CityPlan, GridPolygon, GridPos};

    use super::*;
    use crate::{BakeSettings, ExportSettings, Input, export_glb, plan};

    fn one_house() -> Vec<u8> {
        let input = Input::of(Path::new("tests/places/lane/lane.graph.ron")).unwrap_or_else(|e| panic!("{e}"));
        let mut plan: CityPlan = plan(&input, &BakeSettings::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}")).plan;
        plan.houses.truncate(1);
        (plan.ground, plan.objects) = Default::default();
        export_glb(&plan, &ExportSettings { texture_px: 16 }).unwrap_or_else(|e| panic!("{e}"))
    }

    fn design_of(glb: &[u8]) -> Result<Design, Fault> {
        let file = File::parse(glb)?;
        design("it", &file.triangles(&file.nodes())?.mesh)
    }

    #[test]
    fn a_model_is_a_design_of_parts_that_hang_together() {
        let made = design_of(&one_house()).unwrap_or_else(|e| panic!("{e}"));
        made.check().unwrap_or_else(|e| panic!("{e}"));
        let of = |piece: &Piece| if let Content::Model(model) = &piece.content { model.clone() } else { Model::default() };
        let models: Vec<Model> = made.pieces.iter().map(of).collect();
        assert!(models.len() > 10 && models.iter().all(|model| !model.triangles.is_empty()), "{} parts", models.len());
        let corners = |model: &Model| model.triangles.iter().flatten().map(|&i| model.vertices[i as usize].at).collect::<Vec<_>>();
        for (i, model) in models.iter().enumerate() {
            // No two parts of one material share a corner.
            let own: std::collections::HashSet<[i32; 3]> = corners(model).into_iter().collect();
            let same = (i + 1..models.len()).filter(|&j| made.pieces[j].paint == made.pieces[i].paint);
            assert!(same.into_iter().all(|j| corners(&models[j]).iter().all(|at| !own.contains(at))));
        }
        let ring: Vec<GridPos> = models.iter().flat_map(&corners).map(|[x, y, _]| GridPos(x, y)).collect();
        assert!(GridPolygon::simple(ring).bounds().is_some_and(|(lo, hi)| hi.0 - lo.0 > 4096 && hi.1 - lo.1 > 4096));
    }

    #[test]
    fn names_of_materials_survive_a_modeller() {
        assert_eq!(tile_of("Plaster"), Some(Tile::Plaster));
        assert_eq!(tile_of("Bay(Window).002"), Some(Tile::Bay(veduta_city::Opening::Window)));
        assert_eq!((tile_of("Gold"), tile_of("plaster"), tile_of("Plaster.x")), (None, None, None));
    }

    #[test]
    fn damaged_models_are_refused_or_read_and_never_end_the_program() {
        let whole = one_house();
        let json = u32::from_le_bytes([whole[12], whole[13], whole[14], whole[15]]) as usize;
        let (mut refused, mut read) = (0, 0);
        let mut try_with = |bytes: &[u8]| match design_of(bytes) {
            Ok(_) => read += 1,
            Err(_) => refused += 1,
        };
        for i in 0..2_000 {
            let mut bytes = whole.clone();
            // Numbers of the description, and bytes anywhere.
            let at = 20 + (i * 7919) % json;
            let digit = (at..20 + json).find(|&at| bytes[at].is_ascii_digit());
            if let Some(at) = digit.filter(|_| i % 3 > 0) {
                bytes[at] = b'0' + ((bytes[at] - b'0') + 1 + (i % 8) as u8) % 10;
            } else {
                bytes[(i * 104_729) % whole.len()] ^= 1 << (i % 8);
            }
            try_with(&bytes);
        }
        for cut in (0..whole.len()).step_by(whole.len() / 100) {
            try_with(&whole[..cut]);
        }
        assert!(refused > 400 && read > 200, "{refused} refused, {read} read");
    }
}
