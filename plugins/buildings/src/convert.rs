use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use veduta_ecs::ATTRIBUTE_RELIEF;
use veduta_growth::mesh::MeshData;

/// Bytes of a mesh's vertices and indices.
pub(crate) fn bytes_of(mesh: &Mesh) -> u64 {
    let indices = mesh.indices().map_or(0, |indices| indices.len() * if matches!(indices, Indices::U16(_)) { 2 } else { 4 });
    (mesh.get_vertex_buffer_size() + indices) as u64
}

/// The engine's mesh of plain vertex data, for the GPU alone.
pub(crate) fn mesh_from(data: MeshData) -> Mesh {
    let mesh = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::RENDER_WORLD)
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, data.positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, data.normals)
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, data.uvs)
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_1, data.centres)
        .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, data.colours)
        .with_inserted_indices(Indices::U32(data.indices));
    if data.reliefs.is_empty() { mesh } else { mesh.with_inserted_attribute(ATTRIBUTE_RELIEF, data.reliefs) }
}
