//! The container: streams of vertex data, materials as they are needed, and the header.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::io::Cursor;

use gltf_json::accessor::{ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Stride, Target, View};
use gltf_json::image::MimeType;
use gltf_json::material::{PbrMetallicRoughness, StrengthFactor};
use gltf_json::mesh::{Primitive, Semantic};
use gltf_json::scene::UnitQuaternion;
use gltf_json::texture::{Info, Sampler};
use gltf_json::validation::{Checked::Valid, USize64};
use gltf_json::{Accessor, Asset, Buffer, Image, Index, Material, Root, Scene, Texture};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use serde_json::{Value, json};
use veduta_city::Tile;
use veduta_growth::mesh::MeshData;
use veduta_texture::{paint_tile, paintable_size};

use super::ExportError;

pub(super) type Mesh = Index<gltf_json::Mesh>;
pub(super) type NodeIndex = Index<gltf_json::Node>;

/// The streams of vertex data, each a view of the buffer, with bytes a vertex.
const STREAMS: [(Semantic, Type, ComponentType, usize); 4] = [
    (Semantic::Positions, Type::Vec3, ComponentType::F32, 12),
    (Semantic::Normals, Type::Vec3, ComponentType::F32, 12),
    (Semantic::TexCoords(0), Type::Vec2, ComponentType::F32, 8),
    (Semantic::Colors(0), Type::Vec4, ComponentType::U16, 8),
];
/// The view of the indices follows.
const INDICES: usize = STREAMS.len();

/// A node to be added.
#[derive(Default)]
pub(super) struct Node<'a> {
    pub name: &'a str,
    pub mesh: Option<Mesh>,
    pub children: Vec<NodeIndex>,
    /// Where it stands, and its heading in degrees clockwise from north.
    pub place: Option<([f32; 3], f32)>,
    /// An object of what else is to be known of it.
    pub extras: Value,
}

/// Where the textures of a file are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Textures {
    /// In it.
    Within,
    /// In a folder beside it, which several files share.
    Beside,
}

/// Paints tiles, each once.
pub(super) struct Painter {
    texture_px: u32,
    seed: u64,
    textures: Textures,
    /// As PNG, by tile.
    painted: BTreeMap<usize, Vec<u8>>,
}

impl Painter {
    pub(super) fn new(texture_px: u32, seed: u64, textures: Textures) -> Self {
        Self { texture_px: paintable_size(texture_px), seed, textures, painted: BTreeMap::new() }
    }

    fn paint(&mut self, tile: usize) -> Result<&[u8], ExportError> {
        let place = match self.painted.entry(tile) {
            Entry::Occupied(known) => return Ok(known.into_mut()),
            Entry::Vacant(place) => place,
        };
        let (colours, _) = paint_tile(kind(tile), self.texture_px, self.seed);
        let pixels: Vec<u8> = colours.iter().flat_map(|c| [c[0], c[1], c[2]]).collect();
        let mut png = Cursor::new(Vec::new());
        PngEncoder::new(&mut png).write_image(&pixels, self.texture_px, self.texture_px, ExtendedColorType::Rgb8)?;
        Ok(place.insert(png.into_inner()))
    }

    /// What was painted, with the paths by which files name it.
    pub(super) fn painted(&self) -> impl Iterator<Item = (String, &[u8])> {
        self.painted.iter().map(|(&tile, png)| (path(tile), png.as_slice()))
    }
}

fn kind(tile: usize) -> Tile {
    Tile::all().nth(tile).unwrap_or(Tile::Plaster)
}

/// `textures/bay_window.png`
fn path(tile: usize) -> String {
    let name = format!("{:?}", kind(tile)).to_lowercase().replace(['(', ')'], "_");
    format!("textures/{}.png", name.trim_matches('_'))
}

/// A binary glTF that is being filled.
pub(super) struct Glb<'a> {
    root: Root,
    streams: [Vec<u8>; INDICES + 1],
    images: Vec<Vec<u8>>,
    /// By tile.
    materials: BTreeMap<usize, Index<Material>>,
    painter: &'a mut Painter,
}

impl<'a> Glb<'a> {
    pub(super) fn new(painter: &'a mut Painter) -> Self {
        let (streams, images) = (Default::default(), Vec::new());
        Self { root: Root::default(), streams, images, materials: BTreeMap::new(), painter }
    }

    /// Adds a node. Without mesh and children it is an empty place.
    pub(super) fn node(&mut self, node: Node<'_>) -> Result<NodeIndex, ExportError> {
        let extras = if node.extras.is_null() { None } else { Some(serde_json::value::to_raw_value(&node.extras)?) };
        let turn = |heading: f32| {
            let half = -heading.to_radians() / 2.0;
            UnitQuaternion([0.0, half.sin(), 0.0, half.cos()])
        };
        Ok(self.root.push(gltf_json::Node {
            name: Some(node.name.to_owned()),
            mesh: node.mesh,
            children: (!node.children.is_empty()).then_some(node.children),
            translation: node.place.map(|place| place.0),
            rotation: node.place.map(|place| turn(place.1)),
            extras,
            ..Default::default()
        }))
    }

    /// A node of nothing but a mesh; `None` if there is nothing to draw.
    pub(super) fn leaf(&mut self, name: &str, mesh: &MeshData) -> Result<Option<NodeIndex>, ExportError> {
        let Some(mesh) = self.mesh(mesh)? else { return Ok(None) };
        self.node(Node { name, mesh: Some(mesh), ..Node::default() }).map(Some)
    }

    /// Adds a mesh, a primitive for each tile; `None` if there is nothing to draw.
    pub(super) fn mesh(&mut self, mesh: &MeshData) -> Result<Option<Mesh>, ExportError> {
        let tile_of =
            |t: &[u32]| t.first().and_then(|&i| mesh.colours.get(i as usize)).map_or(0, |colour| (colour[3] + 0.5) as usize);
        let mut tiles: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
        for t in mesh.indices.chunks_exact(3) {
            tiles.entry(tile_of(t)).or_default().extend(t);
        }
        if tiles.is_empty() {
            return Ok(None);
        }
        let attributes = self.vertices(mesh);
        let mut primitives = Vec::with_capacity(tiles.len());
        for (tile, indices) in tiles {
            let begin = self.streams[INDICES].len();
            self.streams[INDICES].extend(indices.iter().flat_map(|i| i.to_le_bytes()));
            let indices = self.accessor(INDICES, begin, indices.len(), Type::Scalar, ComponentType::U32);
            let material = self.material(tile)?;
            primitives.push(Primitive {
                attributes: attributes.clone(),
                indices: Some(indices),
                material: Some(material),
                mode: Valid(gltf_json::mesh::Mode::Triangles),
                extensions: None,
                extras: None,
                targets: None,
            });
        }
        let mesh = gltf_json::Mesh { primitives, weights: None, name: None, extensions: None, extras: None };
        Ok(Some(self.root.push(mesh)))
    }

    fn vertices(&mut self, mesh: &MeshData) -> BTreeMap<gltf_json::validation::Checked<Semantic>, Index<Accessor>> {
        let begins: Vec<usize> = self.streams.iter().map(Vec::len).collect();
        let [positions, normals, uvs, colours, _] = &mut self.streams;
        positions.extend(mesh.positions.iter().flatten().flat_map(|v| v.to_le_bytes()));
        // Of unit length to the last bit that counts: validators ask for it.
        let unit = |n: &[f32; 3]| glam::Vec3::from(*n).as_dvec3().normalize_or(glam::DVec3::Y).as_vec3().to_array();
        normals.extend(mesh.normals.iter().map(unit).flat_map(|n| n.map(f32::to_le_bytes)).flatten());
        uvs.extend(mesh.uvs.iter().flatten().flat_map(|v| v.to_le_bytes()));
        let part = |v: f32| (v.clamp(0.0, 1.0) * f32::from(u16::MAX)).round() as u16;
        let colour = |c: &[f32; 4]| [part(c[0]), part(c[1]), part(c[2]), u16::MAX].map(u16::to_le_bytes);
        colours.extend(mesh.colours.iter().flat_map(colour).flatten());
        let count = mesh.positions.len();
        let mut attributes = BTreeMap::new();
        for (stream, (semantic, type_, component, _)) in STREAMS.into_iter().enumerate() {
            let accessor = self.accessor(stream, begins[stream], count, type_, component);
            if stream == 0 {
                let bound = |pick: fn(f32, f32) -> f32, start: f32| {
                    mesh.positions.iter().fold([start; 3], |most, p| [0, 1, 2].map(|axis| pick(most[axis], p[axis])))
                };
                let accessor = &mut self.root.accessors[accessor.value()];
                accessor.min = Some(json!(bound(f32::min, f32::INFINITY)));
                accessor.max = Some(json!(bound(f32::max, f32::NEG_INFINITY)));
            }
            attributes.insert(Valid(semantic), accessor);
        }
        attributes
    }

    fn accessor(&mut self, stream: usize, begin: usize, count: usize, type_: Type, component: ComponentType) -> Index<Accessor> {
        self.root.push(Accessor {
            buffer_view: Some(Index::new(stream as u32)),
            byte_offset: (begin > 0).then_some(USize64(begin as u64)),
            count: USize64(count as u64),
            component_type: Valid(GenericComponentType(component)),
            type_: Valid(type_),
            normalized: component == ComponentType::U16,
            min: None,
            max: None,
            name: None,
            sparse: None,
            extensions: None,
            extras: None,
        })
    }

    /// The material of a tile, painted when it is first asked for.
    fn material(&mut self, tile: usize) -> Result<Index<Material>, ExportError> {
        if let Some(&known) = self.materials.get(&tile) {
            return Ok(known);
        }
        let name = format!("{:?}", kind(tile));
        let is_within = self.painter.textures == Textures::Within;
        let png = self.painter.paint(tile)?;
        let view = Index::new((INDICES + 1 + self.images.len()) as u32);
        if is_within {
            self.images.push(png.to_vec());
        }
        if self.root.samplers.is_empty() {
            self.root.push(Sampler::default());
        }
        let image = self.root.push(Image {
            buffer_view: is_within.then_some(view),
            mime_type: Some(MimeType("image/png".to_owned())),
            name: Some(name.clone()),
            uri: (!is_within).then(|| path(tile)),
            extensions: None,
            extras: None,
        });
        let texture =
            self.root.push(Texture { name: None, sampler: Some(Index::new(0)), source: image, extensions: None, extras: None });
        let info = Info { index: texture, tex_coord: 0, extensions: None, extras: None };
        let material = self.root.push(Material {
            name: Some(name),
            pbr_metallic_roughness: PbrMetallicRoughness {
                base_color_texture: Some(info),
                metallic_factor: StrengthFactor(0.0),
                roughness_factor: StrengthFactor(0.9),
                ..Default::default()
            },
            ..Default::default()
        });
        self.materials.insert(tile, material);
        Ok(material)
    }

    /// The file, with one node as its scene.
    pub(super) fn finish(mut self, scene: NodeIndex, copyright: &str) -> Result<Vec<u8>, ExportError> {
        let strides = STREAMS.iter().map(|stream| Some(stream.3)).chain([None]);
        let vertex = Some(Valid(Target::ArrayBuffer));
        let targets = core::iter::repeat_n(vertex, INDICES).chain([Some(Valid(Target::ElementArrayBuffer))]);
        let streams = self.streams.into_iter().zip(strides.zip(targets));
        let images = self.images.into_iter().map(|image| (image, (None, None)));
        let mut parts: Vec<Vec<u8>> = Vec::new();
        let mut length = 0;
        // A description without meshes has no buffer.
        let has_buffer = !self.root.meshes.is_empty();
        for (mut bytes, (stride, target)) in streams.chain(images).filter(|_| has_buffer) {
            self.root.buffer_views.push(View {
                buffer: Index::new(0),
                byte_length: USize64(bytes.len() as u64),
                byte_offset: (length > 0).then_some(USize64(length)),
                byte_stride: stride.map(Stride),
                name: None,
                target,
                extensions: None,
                extras: None,
            });
            bytes.resize(bytes.len().next_multiple_of(4), 0);
            length += bytes.len() as u64;
            parts.push(bytes);
        }
        if has_buffer {
            self.root.buffers.push(Buffer { byte_length: USize64(length), name: None, uri: None, extensions: None, extras: None });
        }
        let first = self.root.push(Scene { nodes: vec![scene], name: None, extensions: None, extras: None });
        self.root.scene = Some(first);
        self.root.asset = Asset {
            copyright: (!copyright.is_empty()).then(|| copyright.to_owned()),
            generator: Some(format!("veduta-bake {}", env!("CARGO_PKG_VERSION"))),
            ..Asset::default()
        };
        container(self.root.to_vec()?, length, parts)
    }
}

/// Header, description and, if there is one, the buffer of so many bytes.
fn container(mut json: Vec<u8>, buffer: u64, parts: Vec<Vec<u8>>) -> Result<Vec<u8>, ExportError> {
    json.resize(json.len().next_multiple_of(4), b' ');
    let whole = 12 + 8 + json.len() as u64 + if buffer > 0 { 8 + buffer } else { 0 };
    let length = u32::try_from(whole).map_err(|_| ExportError::TooLarge(whole))?;
    let mut out = Vec::with_capacity(length as usize);
    out.extend(b"glTF");
    out.extend(2_u32.to_le_bytes());
    out.extend(length.to_le_bytes());
    out.extend((json.len() as u32).to_le_bytes());
    out.extend(b"JSON");
    out.extend(json);
    if buffer > 0 {
        out.extend((buffer as u32).to_le_bytes());
        out.extend(b"BIN\0");
        parts.into_iter().for_each(|part| out.extend(part));
    }
    Ok(out)
}
