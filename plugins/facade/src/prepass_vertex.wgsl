// Where the relief of walls stands, for depth and normals: as in the main pass.
#import bevy_pbr::{mesh_functions, mesh_view_bindings::view, prepass_bindings, prepass_io::VertexOutput, view_transformations::position_world_to_clip}
#ifdef VERTEX_RELIEF
#import veduta_facade::levels::{Facade, relief_scale, risen, risen_normal}

@group(#{MATERIAL_BIND_GROUP}) @binding(100) var<uniform> facade: Facade;
#endif

struct Vertex {
    @builtin(instance_index) instance_index: u32,
    @location(0) position: vec3<f32>,
#ifdef VERTEX_UVS_A
    @location(1) uv: vec2<f32>,
#endif
#ifdef VERTEX_UVS_B
    @location(2) uv_b: vec2<f32>,
#endif
#ifdef NORMAL_PREPASS_OR_DEFERRED_PREPASS
    @location(3) normal: vec3<f32>,
#endif
#ifdef VERTEX_COLORS
    @location(7) color: vec4<f32>,
#endif
#ifdef VERTEX_RELIEF
    @location(8) relief: vec3<f32>,
#endif
}

@vertex
fn vertex(vertex: Vertex) -> VertexOutput {
    var out: VertexOutput;
    let model = mesh_functions::get_world_from_local(vertex.instance_index);
    var local = vertex.position;
#ifdef NORMAL_PREPASS_OR_DEFERRED_PREPASS
    var normal = vertex.normal;
#endif
#ifdef VERTEX_RELIEF
    let centre = (model * vec4<f32>(vertex.uv_b.x, 0.0, vertex.uv_b.y, 1.0)).xz;
    let tag = mesh_functions::get_tag(vertex.instance_index);
    let scale = relief_scale(facade, distance(centre, view.world_position.xz), tag);
    local = risen(vertex.position, vertex.relief, scale);
#ifdef NORMAL_PREPASS_OR_DEFERRED_PREPASS
    normal = risen_normal(normal, vertex.relief, scale);
#endif
#endif
    out.world_position = model * vec4<f32>(local, 1.0);
    out.position = position_world_to_clip(out.world_position.xyz);
#ifdef UNCLIPPED_DEPTH_ORTHO_EMULATION
    out.unclipped_depth = out.position.z;
    out.position.z = min(out.position.z, 1.0);
#endif
#ifdef VERTEX_UVS_A
    out.uv = vertex.uv;
#endif
#ifdef VERTEX_UVS_B
    out.uv_b = vertex.uv_b;
#endif
#ifdef NORMAL_PREPASS_OR_DEFERRED_PREPASS
    out.world_normal = mesh_functions::mesh_normal_local_to_world(normal, vertex.instance_index);
#endif
#ifdef VERTEX_COLORS
    out.color = vertex.color;
#endif
#ifdef MOTION_VECTOR_PREPASS
    let before = mesh_functions::get_previous_world_from_local(vertex.instance_index);
    out.previous_world_position = before * vec4<f32>(local, 1.0);
#endif
#ifdef VERTEX_OUTPUT_INSTANCE_INDEX
    out.instance_index = vertex.instance_index;
#endif
    return out;
}
