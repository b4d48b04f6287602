// Where living things stand, for their shadows: as in the main pass.
#import bevy_pbr::{mesh_functions, mesh_view_bindings::view, prepass_io::VertexOutput, view_transformations::position_world_to_clip}
#import bevy_render::globals::Globals
#import veduta_life::motion::{Life, Moved, bird, cloth}

@group(0) @binding(1) var<uniform> globals: Globals;
@group(#{MATERIAL_BIND_GROUP}) @binding(100) var<uniform> life: Life;
#ifdef BIRDS
@group(#{MATERIAL_BIND_GROUP}) @binding(101) var<uniform> poses: array<vec4<f32>, 192>;
#endif

struct Vertex {
    @builtin(instance_index) instance_index: u32,
    @location(0) position: vec3<f32>,
    @location(1) uv: vec2<f32>,
    @location(2) uv_b: vec2<f32>,
    // Cloth and birds are moved along theirs.
    @location(8) normal: vec3<f32>,
    @location(7) color: vec4<f32>,
}

@vertex
fn vertex(vertex: Vertex) -> VertexOutput {
    var out: VertexOutput;
    let model = mesh_functions::get_world_from_local(vertex.instance_index);
    var place = (model * vec4<f32>(vertex.position, 1.0)).xyz;
#ifdef BIRDS
    let n = u32(vertex.uv_b.x + 0.5) * 3u;
    let moved = bird(poses[n], poses[n + 1u], poses[n + 2u], vertex.position, vertex.normal, vertex.uv, vertex.uv_b.y);
    // A little smaller, or feathers would shade what they lie on.
    place = (model * vec4<f32>(moved.place - moved.normal * select(0.0, 0.012, vertex.uv_b.y < 2.5), 1.0)).xyz;
#else
    if vertex.uv_b.x > 0.0 {
        let pole = mesh_functions::mesh_normal_local_to_world(vertex.normal, vertex.instance_index);
        place = cloth(life, place, pole, vertex.uv_b, vertex.uv, globals.time, vertex.color.a * 6.2831853).place;
    }
#endif
    out.world_position = vec4<f32>(place, 1.0);
    out.position = position_world_to_clip(place);
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
#ifdef VERTEX_COLORS
    out.color = vertex.color;
#endif
#ifdef NORMAL_PREPASS_OR_DEFERRED_PREPASS
    out.world_normal = vertex.normal;
#endif
#ifdef MOTION_VECTOR_PREPASS
    out.previous_world_position = out.world_position;
#endif
#ifdef VERTEX_OUTPUT_INSTANCE_INDEX
    out.instance_index = vertex.instance_index;
#endif
    return out;
}
