//! A plan as binary glTF 2.0, for modellers and other engines.
//!
//! ```text
//!  city ─┬─ ground
//!        ├─ houses ─── a house ─┬─ façade 0, façade 1, …   (its street walls)
//!        │                      ├─ walls                   (all others)
//!        │                      └─ roof                    (or the monument in place of all these)
//!        └─ objects ── Lamp 17, Tree 18, …
//! ```
//! Metres, y up, x east, z south. Every house and object has its id, kind and names in `extras`; materials are the tiles of the
//! texture workshop, multiplied by the colour of each vertex.
//!
//! # Limits
//! The game's material leaves glass and timber of a tile as they are and colours its plaster alone; glTF's multiplies all.
//! In the game no two trees are alike; here those of one height share four shapes.
//! What is within 4 GiB fits into one file; more is told as an error.

mod glb;

use std::collections::{BTreeMap, HashMap};

use serde_json::{Value, json};
use veduta_cells::Contents;
use veduta_city::{
    Cell, CellShell, Cells, CityPlan, Design, FacadeSheet, GridPos, House, HouseShell, ObjectKind, ObjectShell, PlacedMonument,
    PlanObject, Season, Volume, VolumeShell, WallKind,
};
use veduta_growth::mesh::{self, MeshData, MeshError, MonumentDetail};

use glb::{Glb, Node, Painter, Textures};

/// How a plan is exported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExportSettings {
    /// Pixels a side of each texture: a power of two, 16 to 1024.
    pub texture_px: u32,
}

impl Default for ExportSettings {
    fn default() -> Self {
        Self { texture_px: 256 }
    }
}

/// Why a plan was not exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// A house's mesh could not be made.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The file would be larger than glTF's 4 GiB.
    #[error("{0} bytes do not fit into one binary glTF file: export a smaller area")]
    TooLarge(u64),
    /// A texture could not be encoded.
    #[error("texture: {0}")]
    Texture(#[from] image::ImageError),
    /// The description could not be written.
    #[error("glTF: {0}")]
    Json(#[from] serde_json::Error),
}

/// A plan as the bytes of a `.glb` file.
///
/// # Errors
/// [`ExportError`]; none for a plan that growth made and that fits into 4 GiB.
pub fn export_glb(plan: &CityPlan, settings: &ExportSettings) -> Result<Vec<u8>, ExportError> {
    let mut painter = Painter::new(settings.texture_px, plan.seed, Textures::Within);
    let mut glb = Glb::new(&mut painter);
    let (terrain, ground) = (plan.terrain.clone(), plan.ground.clone());
    let (spans, drawn_spans) = (plan.spans.clone(), plan.spans.len() as u32);
    let (courses, markings) = (plan.courses.clone(), plan.markings.clone());
    let shell = CellShell { terrain, ground, courses, markings, spans, drawn_spans, ..CellShell::default() };
    let mut streets = mesh::ground(&shell);
    streets.append(&mesh::markings(&shell));
    let ground = glb.leaf("ground", &streets)?;
    let spans = glb.leaf("spans", &mesh::spans(&shell))?;
    let mut houses = Vec::with_capacity(plan.houses.len());
    for house in &plan.houses {
        houses.push(export_house(&mut glb, plan, house)?);
    }
    let houses = glb.node(Node { name: "houses", children: houses, ..Node::default() })?;
    let mut shapes = Shapes::new();
    let mut objects = Vec::with_capacity(plan.objects.len());
    for object in &plan.objects {
        objects.extend(export_object(&mut glb, &mut shapes, &plan.designs, object)?);
    }
    let objects = glb.node(Node { name: "objects", children: objects, ..Node::default() })?;
    let children = ground.into_iter().chain(spans).chain([houses, objects]).collect();
    let city = glb.node(Node { name: &plan.name, children, extras: about(plan), ..Node::default() })?;
    glb.finish(city, &plan.attribution)
}

/// What is to be known of a city.
fn about(plan: &CityPlan) -> Value {
    json!({
        "kind": "city",
        "latitude": plan.anchor.lat,
        "longitude": plan.anchor.lon,
        "attribution": plan.attribution,
        "seed": plan.seed.to_string(),
    })
}

/// The cells of a plan as a `.glb` file each, all in the coordinates of the city, with the textures that they share in a folder beside
/// them, and a `cells.json` that tells the least and greatest x and z of each one's ground. A house is in the file of the cell that carries
/// its roof. Files are handed out one by one, by their paths.
///
/// # Errors
/// [`ExportError`], or what `write` fails with, wrapped in it.
pub fn export_cells<E: From<ExportError>>(
    plan: &CityPlan,
    cells: &Cells,
    settings: &ExportSettings,
    write: &mut dyn FnMut(&str, &[u8]) -> Result<(), E>,
) -> Result<(), E> {
    let contents = Contents::new(plan, cells);
    let mut painter = Painter::new(settings.texture_px, plan.seed, Textures::Beside);
    let mut list = Vec::with_capacity(cells.cells.len());
    for (i, cell) in cells.cells.iter().enumerate() {
        let (glb, bounds) = export_cell(plan, cell, contents.shell(i), &mut painter)?;
        let file = format!("{}.glb", cell.id);
        write(&file, &glb)?;
        list.push(json!({
            "file": file, "id": cell.id.0.to_string(), "name": cell.name, "houses": cell.houses.len(), "low": bounds.0, "high": bounds.1,
        }));
    }
    for (path, png) in painter.painted() {
        write(&path, png)?;
    }
    let about = json!({ "city": about(plan), "name": plan.name, "cells": list });
    let text = serde_json::to_vec_pretty(&about).map_err(ExportError::from)?;
    write("cells.json", &text)
}

/// A cell's file, and least and greatest x and z of its outline.
fn export_cell(
    plan: &CityPlan,
    cell: &Cell,
    mut shell: CellShell,
    painter: &mut Painter,
) -> Result<(Vec<u8>, ([f64; 2], [f64; 2])), ExportError> {
    let mut glb = Glb::new(painter);
    let at = shell.origin.to_metres();
    let place = Some(([at.x as f32, 0.0, -at.y as f32], 0.0));
    let mut children = Vec::new();
    // Houses bring their footings.
    shell.houses.clear();
    let mut streets = mesh::ground(&shell);
    streets.append(&mesh::markings(&shell));
    for (name, made) in [("ground", streets), ("spans", mesh::spans(&shell))] {
        if let Some(mesh) = glb.mesh(&made)? {
            children.push(glb.node(Node { name, mesh: Some(mesh), place, ..Node::default() })?);
        }
    }
    let mut houses = Vec::with_capacity(cell.houses.len());
    for house in cell.houses.iter().filter_map(|&house| plan.houses.get(house as usize)) {
        houses.push(export_house(&mut glb, plan, house)?);
    }
    let (mut shapes, mut objects) = (Shapes::new(), Vec::with_capacity(cell.objects.len()));
    for object in cell.objects.iter().filter_map(|&object| plan.objects.get(object as usize)) {
        objects.extend(export_object(&mut glb, &mut shapes, &plan.designs, object)?);
    }
    for (name, group) in [("houses", houses), ("objects", objects)] {
        if !group.is_empty() {
            children.push(glb.node(Node { name, children: group, ..Node::default() })?);
        }
    }
    let extras = json!({ "kind": "cell", "id": cell.id.0.to_string() });
    let name = if cell.name.is_empty() { format!("cell {}", cell.id) } else { cell.name.clone() };
    let node = glb.node(Node { name: &name, children, extras, ..Node::default() })?;
    let (low, high) = cell.outline.bounds().unwrap_or_default();
    let (low, high) = (low.to_metres(), high.to_metres());
    Ok((glb.finish(node, &plan.attribution)?, ([low.x, -high.y], [high.x, -low.y])))
}

/// A mesh as the bytes of a `.glb` file with one node of a name.
pub(crate) fn export_model(name: &str, mesh: &MeshData, settings: &ExportSettings) -> Result<Vec<u8>, ExportError> {
    let mut painter = Painter::new(settings.texture_px, 0, Textures::Within);
    let mut glb = Glb::new(&mut painter);
    let mesh = glb.mesh(mesh)?;
    let node = glb.node(Node { name, mesh, extras: json!({ "kind": "model" }), ..Node::default() })?;
    glb.finish(node, "")
}

/// Monuments side by side, as the bytes of a `.glb` file.
///
/// # Errors
/// As [`export_glb`].
pub fn export_monuments(designs: &[Design], settings: &ExportSettings) -> Result<Vec<u8>, ExportError> {
    let mut painter = Painter::new(settings.texture_px, 0, Textures::Within);
    let mut glb = Glb::new(&mut painter);
    let (mut children, mut right) = (Vec::with_capacity(designs.len()), 0.0);
    for design in designs {
        let mut mesh = MeshData::default();
        let placed = PlacedMonument { design: 0, pos: GridPos(0, 0), z: 0, heading: 18_000 };
        mesh::monument(design, &placed, MonumentDetail::FINE, &mut mesh);
        let bounds = mesh.positions.iter().fold((0.0_f32, 0.0_f32), |(l, h), p| (l.min(p[0]), h.max(p[0])));
        let (mesh, extras) = (glb.mesh(&mesh)?, json!({ "kind": "monument" }));
        let place = (designs.len() > 1).then_some(([right - bounds.0, 0.0, 0.0], 0.0));
        children.push(glb.node(Node { name: &design.name, mesh, place, extras, ..Node::default() })?);
        right += bounds.1 - bounds.0 + 2.0;
    }
    let all = glb.node(Node { name: "monuments", children, ..Node::default() })?;
    glb.finish(all, "")
}

fn export_house(glb: &mut Glb<'_>, plan: &CityPlan, house: &House) -> Result<glb::NodeIndex, ExportError> {
    let mut parts = Vec::new();
    for (name, made, extras) in house_parts(plan, house)? {
        let mesh = glb.mesh(&made)?;
        parts.push(glb.node(Node { name: &name, mesh, extras, ..Node::default() })?);
    }
    let style = plan.styles.0.get(usize::from(house.style)).map_or("", |style| style.name.as_str());
    let extras = json!({ "kind": "house", "id": house.id.0.to_string(), "style": style, "number": house.number });
    glb.node(Node { name: &house_name(house), children: parts, extras, ..Node::default() })
}

/// What a house's node is called.
pub(crate) fn house_name(house: &House) -> String {
    match (house.name.as_str(), house.number.as_str()) {
        ("", "") => format!("house {}", house.id),
        ("", number) => format!("house no. {number}"),
        (name, _) => name.to_owned(),
    }
}

/// The parts of a house in the city's axes, each with its name and what is to be known of it.
pub(crate) fn house_parts(plan: &CityPlan, house: &House) -> Result<Vec<(String, MeshData, Value)>, ExportError> {
    let (mut parts, mut others, mut roofs) = (Vec::new(), MeshData::default(), MeshData::default());
    if let Some(monument) = &house.monument
        && let Some(design) = plan.designs.get(usize::from(monument.design))
    {
        let mut mesh = MeshData::default();
        mesh::monument(design, monument, MonumentDetail::FINE, &mut mesh);
        parts.push((design.name.clone(), mesh, Value::Null));
    }
    for volume in &house.volumes {
        let of_walls = |walls: Vec<u16>, has_roof: bool| shell(house, volume, walls, has_roof);
        let all: Vec<u16> = (0..volume.walls.len()).map_while(|i| u16::try_from(i).ok()).collect();
        if let Some(bounds) = volume.footprint.bounds().filter(|_| !plan.terrain.is_level()) {
            let terrain = plan.terrain.crop(bounds, GridPos(0, 0));
            others.append(&mesh::footings(&CellShell { terrain, ..of_walls(all.clone(), false) }));
        }
        if house.monument.is_some() {
            continue;
        }
        let sheet = FacadeSheet::of(volume.walls.iter().take(usize::from(u16::MAX) + 1).cloned().collect());
        let mut made = by_centre(&mesh::level2(&of_walls(all.clone(), false), &sheet)?);
        for (wall, i) in sheet.walls.iter().zip(0..) {
            let Some(centre) = mesh::level1(&of_walls(vec![i], false)).centres.first().copied() else { continue };
            let Some(of_wall) = made.remove(&centre.map(f32::to_bits)) else { continue };
            if wall.kind == WallKind::Street {
                let extras = json!({ "kind": "facade", "bays": wall.bays, "storeys": wall.storeys.len() });
                parts.push((format!("façade {}", parts.len()), of_wall, extras));
            } else {
                others.append(&of_wall);
            }
        }
        made.values().for_each(|rest| others.append(rest));
        roofs.append(&mesh::roofs(&of_walls(all, true)));
    }
    parts.extend([("walls", others), ("roof", roofs)].map(|(name, made)| (name.to_owned(), made, Value::Null)));
    parts.retain(|(_, made, _)| !made.is_empty());
    Ok(parts)
}

/// A mesh cut into those of its façades, which are known by their centres.
fn by_centre(mesh: &MeshData) -> BTreeMap<[u32; 2], MeshData> {
    let mut parts: BTreeMap<[u32; 2], MeshData> = BTreeMap::new();
    let mut places: HashMap<u32, u32> = HashMap::new();
    for t in mesh.indices.chunks_exact(3) {
        let part = parts.entry(mesh.centres[t[0] as usize].map(f32::to_bits)).or_default();
        for &i in t {
            let place = *places.entry(i).or_insert_with(|| {
                let i = i as usize;
                part.positions.push(mesh.positions[i]);
                part.normals.push(mesh.normals[i]);
                part.uvs.push(mesh.uvs[i]);
                part.centres.push(mesh.centres[i]);
                part.colours.push(mesh.colours[i]);
                part.positions.len() as u32 - 1
            });
            part.indices.push(place);
        }
    }
    parts
}

/// A cell of some walls of one volume, or of its roof.
fn shell(house: &House, volume: &Volume, walls: Vec<u16>, has_roof: bool) -> CellShell {
    let volume = VolumeShell::of(volume, walls, has_roof);
    let house = HouseShell { style: house.style, floor: house.floor, volumes: vec![volume], is_monument: false };
    CellShell { houses: vec![house], ..CellShell::default() }
}

/// Different objects of one kind and height: they share so many meshes.
const VARIANTS: u64 = 4;

/// Meshes of objects by kind, height and variant.
type Shapes = BTreeMap<(ObjectKind, i32, u64, Option<u16>), Option<glb::Mesh>>;

fn export_object(
    glb: &mut Glb<'_>,
    shapes: &mut Shapes,
    designs: &[Design],
    object: &PlanObject,
) -> Result<Option<glb::NodeIndex>, ExportError> {
    let design = object.monument.and_then(|design| designs.get(usize::from(design)));
    let key = (object.kind, object.height, object.id.0 % VARIANTS, object.monument);
    let mesh = match shapes.get(&key) {
        Some(&known) => known,
        None => {
            let at_origin = ObjectShell { pos: GridPos(0, 0), z: 0, heading: 0, ..ObjectShell::of(object) };
            let mut made = MeshData::default();
            match design {
                Some(design) => {
                    let placed = PlacedMonument { design: 0, pos: GridPos(0, 0), z: 0, heading: 0 };
                    mesh::monument(design, &placed, MonumentDetail::FINE, &mut made);
                }
                None => {
                    // What is random follows from where an object stands.
                    let origin = GridPos((object.id.0 % VARIANTS) as i32, 0);
                    let alone = CellShell { origin, objects: vec![at_origin], ..CellShell::default() };
                    made = mesh::objects(&alone);
                    made.append(&mesh::trees(&alone, Season::Summer));
                }
            }
            *shapes.entry(key).or_insert(glb.mesh(&made)?)
        }
    };
    if mesh.is_none() {
        return Ok(None);
    }
    let kind = format!("{:?}", object.kind);
    let pos = object.pos.to_metres();
    let place = Some(([pos.x as f32, veduta_city::metres(object.z) as f32, -pos.y as f32], f32::from(object.heading)));
    let extras = json!({ "kind": kind.to_lowercase(), "id": object.id.0.to_string() });
    let name = format!("{kind} {}", object.id);
    Ok(Some(glb.node(Node { name: &name, mesh, place, extras, ..Node::default() })?))
}
