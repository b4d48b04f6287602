// Tiles, level switching per façade, and surface relief by normals, on top of Bevy's standard material.
#import bevy_pbr::{
    pbr_fragment::pbr_input_from_standard_material,
    pbr_functions::{apply_pbr_lighting, main_pass_post_lighting_processing},
    forward_io::{VertexOutput, FragmentOutput},
    mesh_functions,
    mesh_view_bindings::view,
}

#import veduta_facade::levels::{Facade, bayer, is_cut, is_drawn, is_turned_to, keeps}

@group(#{MATERIAL_BIND_GROUP}) @binding(100) var<uniform> facade: Facade;
@group(#{MATERIAL_BIND_GROUP}) @binding(101) var colour_tiles: texture_2d_array<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(102) var tile_sampler: sampler;
@group(#{MATERIAL_BIND_GROUP}) @binding(103) var normal_tiles: texture_2d_array<f32>;

fn hash(p: vec2<f32>) -> f32 {
    let q = fract(p * vec2<f32>(0.1031, 0.1030));
    let r = dot(q, q.yx + 33.33);
    return fract((q.x + r) * (q.y + r) * 57.31);
}

// Smooth noise, 0 to 1, by value at whole numbers.
fn noise(p: vec2<f32>) -> f32 {
    let i = floor(p);
    let f = smoothstep(vec2<f32>(0.0), vec2<f32>(1.0), p - i);
    let low = mix(hash(i), hash(i + vec2<f32>(1.0, 0.0)), f.x);
    let high = mix(hash(i + vec2<f32>(0.0, 1.0)), hash(i + vec2<f32>(1.0, 1.0)), f.x);
    return mix(low, high, f.y);
}

// Wear in metres, where tiles repeat in centimetres: walls mottled, ground trodden in paths and stained.
fn wear(at: vec3<f32>, up: f32) -> f32 {
    if abs(up) > 0.9 {
        return 0.84 + 0.20 * noise(at.xz * 0.13) + 0.10 * noise(at.xz * 0.61 + 7.0);
    }
    return 0.93 + 0.13 * noise(vec2<f32>(at.x + at.z, at.y * 0.7) * 0.33);
}

@fragment
fn fragment(in: VertexOutput, @builtin(front_facing) is_front: bool) -> FragmentOutput {
    let level = i32(facade.near_level.w);
    // All that looks at neighbouring pixels comes before any of them is dropped.
    let across = dpdx(in.world_position.xyz);
    let down = dpdy(in.world_position.xyz);
    let uv_across = dpdx(in.uv);
    let uv_down = dpdy(in.uv);
    let layer = i32(in.color.a + 0.5);
    let tile = textureSample(colour_tiles, tile_sampler, in.uv, layer);
    let relief = textureSample(normal_tiles, tile_sampler, in.uv, layer);
    let model = mesh_functions::get_world_from_local(in.instance_index);
    let centre = (model * vec4<f32>(in.uv_b.x, 0.0, in.uv_b.y, 1.0)).xz;
    let away = distance(centre, view.world_position.xz);
    if !keeps(facade, in.position.xy, away, mesh_functions::get_tag(in.instance_index)) { discard; }
    if is_cut(facade) {
        if !is_drawn(relief.a, in.position.xy) { discard; }
        let back = view.world_from_view[2].xyz;
        let from_tree = view.world_position - vec3<f32>(centre.x, in.world_position.y, centre.y);
        let to_eye = normalize(select(from_tree, back, view.clip_from_view[3].w == 1.0));
        if !is_turned_to(cross(across, down), to_eye, bayer(vec2<u32>(in.position.xy))) { discard; }
    }

    // What the layer is off a whole number tells the floor's height, in 1,024 m.
    let height = in.world_position.y - (in.color.a - f32(layer)) * 1024.0;
    // Where alpha is 1 the tile modulates the vertex colour about one half; where it is 0 it stands as it is.
    let albedo = mix(tile.rgb, 2.0 * tile.rgb * in.color.rgb, tile.a) * wear(in.world_position.xyz, in.world_normal.y);

    var pbr_input = pbr_input_from_standard_material(in, is_front);
    pbr_input.material.base_color = vec4<f32>(albedo, 1.0);
    // Of a card it is the cover that is told, and leaves are dull.
    pbr_input.material.perceptual_roughness = select(clamp(relief.a, 0.08, 1.0), 0.85, is_cut(facade));

    let n = normalize(in.world_normal);
    var tangent = vec3<f32>(1.0, 0.0, 0.0);
    if abs(n.y) < 0.9 {
        tangent = normalize(cross(vec3<f32>(0.0, 1.0, 0.0), n));
    } else {
        // Paving is laid in any direction: along u as it lies on the screen.
        let turned = (across * uv_down.y - down * uv_across.y) * sign(uv_across.x * uv_down.y - uv_across.y * uv_down.x);
        let along = turned - n * dot(n, turned);
        if dot(along, along) > 1e-20 { tangent = normalize(along); }
    }
    let bitangent = cross(n, tangent);
    let bump = relief.xyz * 2.0 - 1.0;
    pbr_input.N = normalize(tangent * bump.x + bitangent * bump.y + n * max(bump.z, 0.2));

    // Contact shade where walls meet the ground, and less sky the deeper a wall stands in its street.
    let foot = mix(0.55, 1.0, smoothstep(-0.2, 1.6, height)) * mix(0.7, 1.0, smoothstep(0.0, 14.0, height));
    let wall = 1.0 - abs(select(n.y, pbr_input.N.y, is_cut(facade)));
    pbr_input.diffuse_occlusion *= vec3<f32>(mix(1.0, foot, wall));

    // Lit windows at night: glass is what is dark and smooth on a wall.
    if facade.far_lit.w > 0.0 && level > 1 && tile.a < 0.2 && relief.a < 0.3 {
        let bay = floor(in.uv) + floor(centre * 3.0) + vec2<f32>(floor(height / 3.3) * 7.0, 0.0);
        if hash(bay) < facade.far_lit.w {
            pbr_input.material.emissive = vec4<f32>(vec3<f32>(1.0, 0.66, 0.32) * 900.0, 1.0);
        }
    }

    var out: FragmentOutput;
    out.color = apply_pbr_lighting(pbr_input);
    out.color = main_pass_post_lighting_processing(pbr_input, out.color);
    return out;
}
