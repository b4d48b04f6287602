// Depth of a façade's pixels, each in the one level that it belongs to.
#import bevy_pbr::{mesh_functions, mesh_view_bindings::view, prepass_bindings, prepass_io::VertexOutput}
#ifdef PREPASS_FRAGMENT
#import bevy_pbr::prepass_io::FragmentOutput
#endif
#import veduta_facade::levels::{Facade, bayer, fades, is_drawn, is_turned_to, keeps}

@group(#{MATERIAL_BIND_GROUP}) @binding(100) var<uniform> facade: Facade;
@group(#{MATERIAL_BIND_GROUP}) @binding(102) var tile_sampler: sampler;
@group(#{MATERIAL_BIND_GROUP}) @binding(103) var normal_tiles: texture_2d_array<f32>;

fn drop_other_levels(in: VertexOutput) {
    let tag = mesh_functions::get_tag(in.instance_index);
#ifdef CARDS
    let normal = cross(dpdx(in.world_position.xyz), dpdy(in.world_position.xyz));
    let cover = textureSample(normal_tiles, tile_sampler, in.uv, i32(in.color.a + 0.5)).a;
    if !is_drawn(cover, in.position.xy) { discard; }
#ifdef VIEW_PROJECTION_ORTHOGRAPHIC
    // The sun's views are orthographic. Cards cast no shadows where bodies do, and of those that cross one another the one does that looks
    // towards the sun.
    if fades(tag).y > 0.5 || !is_turned_to(normal, normalize(view.world_from_view[2].xyz), 0.5) { discard; }
#endif
#endif
#ifdef SHARED
#ifndef VIEW_PROJECTION_ORTHOGRAPHIC
    // Level 1 casts whole shadows, whatever the eye sees of it.
    let model = mesh_functions::get_world_from_local(in.instance_index);
    let centre = (model * vec4<f32>(in.uv_b.x, 0.0, in.uv_b.y, 1.0)).xz;
    if !keeps(facade, in.position.xy, distance(centre, view.world_position.xz), tag) { discard; }
#ifdef CARDS
    let to_eye = normalize(view.world_position - vec3<f32>(centre.x, in.world_position.y, centre.y));
    if !is_turned_to(normal, to_eye, bayer(vec2<u32>(in.position.xy))) { discard; }
#endif
#endif
#endif
}

#ifdef PREPASS_FRAGMENT
@fragment
fn fragment(in: VertexOutput) -> FragmentOutput {
    drop_other_levels(in);
    var out: FragmentOutput;
#ifdef NORMAL_PREPASS
    out.normal = vec4(in.world_normal * 0.5 + vec3(0.5), 1.0);
#endif
#ifdef UNCLIPPED_DEPTH_ORTHO_EMULATION
    out.frag_depth = in.unclipped_depth;
#endif
#ifdef MOTION_VECTOR_PREPASS
    let now = view.unjittered_clip_from_world * in.world_position;
    let before = prepass_bindings::previous_view_uniforms.clip_from_world * in.previous_world_position;
    out.motion_vector = (now.xy / now.w - before.xy / before.w) * vec2(0.5, -0.5);
#endif
    return out;
}
#else
@fragment
fn fragment(in: VertexOutput) {
    drop_other_levels(in);
}
#endif
