// Walls whose relief rises as one comes near. Everything else stands where its mesh says.
#import bevy_pbr::{forward_io::VertexOutput, mesh_functions, mesh_view_bindings::view, view_transformations::position_world_to_clip}
#import veduta_facade::levels::{Facade, relief_scale, risen, risen_normal}

@group(#{MATERIAL_BIND_GROUP}) @binding(100) var<uniform> facade: Facade;

struct Vertex {
    @builtin(instance_index) instance_index: u32,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) uv_b: vec2<f32>,
    @location(5) color: vec4<f32>,
#ifdef VERTEX_RELIEF
    // Normal of the wall (x, z), and how far before it the vertex lies.
    @location(8) relief: vec3<f32>,
#endif
}

@vertex
fn vertex(vertex: Vertex) -> VertexOutput {
    var out: VertexOutput;
    let model = mesh_functions::get_world_from_local(vertex.instance_index);
    var normal = vertex.normal;
    out.world_position = model * vec4<f32>(vertex.position, 1.0);
    var place = out.world_position;
#ifdef VERTEX_RELIEF
    let centre = (model * vec4<f32>(vertex.uv_b.x, 0.0, vertex.uv_b.y, 1.0)).xz;
    let tag = mesh_functions::get_tag(vertex.instance_index);
    let scale = relief_scale(facade, distance(centre, view.world_position.xz), tag);
    place = model * vec4<f32>(risen(vertex.position, vertex.relief, scale), 1.0);
    // Shading takes it for flat: what the sun casts on the wall is cast on panes and sills, and no wall shades its own windows.
    out.world_position = model * vec4<f32>(risen(vertex.position, vertex.relief, 0.0), 1.0);
    normal = risen_normal(normal, vertex.relief, scale);
#endif
    out.position = position_world_to_clip(place.xyz);
    out.world_normal = mesh_functions::mesh_normal_local_to_world(normal, vertex.instance_index);
    out.uv = vertex.uv;
    out.uv_b = vertex.uv_b;
    out.color = vertex.color;
#ifdef VERTEX_OUTPUT_INSTANCE_INDEX
    out.instance_index = vertex.instance_index;
#endif
    return out;
}
