// Tiles, level switching per façade, and surface relief by normals, on top of Bevy's standard material.
#import bevy_pbr::{
    pbr_fragment::pbr_input_from_standard_material,
    pbr_functions::{apply_pbr_lighting, main_pass_post_lighting_processing},
    forward_io::{VertexOutput, FragmentOutput},
    mesh_functions,
    mesh_view_bindings::view,
}

struct Facade {
    near_level: vec4<f32>,
    far_lit: vec4<f32>,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(100) var<uniform> facade: Facade;
@group(#{MATERIAL_BIND_GROUP}) @binding(101) var colour_tiles: texture_2d_array<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(102) var tile_sampler: sampler;
@group(#{MATERIAL_BIND_GROUP}) @binding(103) var normal_tiles: texture_2d_array<f32>;

// Threshold of the 8×8 Bayer pattern at a pixel, in (0, 1): bits of x and x^y interleaved, most significant last.
fn bayer(pixel: vec2<u32>) -> f32 {
    let x = pixel.x & 7u;
    let y = (pixel.x ^ pixel.y) & 7u;
    let v = ((x & 4u) >> 2u) | ((y & 4u) >> 1u) | ((x & 2u) << 1u) | ((y & 2u) << 2u) | ((x & 1u) << 4u) | ((y & 1u) << 5u);
    // `y` carries the heavier bit of each pair.
    return (f32(v) + 0.5) / 64.0;
}

// How far each level has faded in, from the mesh's tag.
fn fades(tag: u32) -> vec4<f32> {
    return vec4<f32>(f32(tag & 255u), f32((tag >> 8u) & 255u), f32((tag >> 16u) & 255u), f32(tag >> 24u)) / 255.0;
}

// Reach of each level at a distance: level n keeps a pixel where reach(n + 1) <= threshold < reach(n).
fn reaches(distance: f32, fade: vec4<f32>) -> vec4<f32> {
    let near = facade.near_level.xyz;
    let far = max(facade.far_lit.xyz, near + vec3<f32>(0.001));
    let allowed = step(vec3<f32>(0.001), facade.far_lit.xyz);
    let close = allowed * clamp((far - vec3<f32>(distance)) / (far - near), vec3<f32>(0.0), vec3<f32>(1.0));
    let four = fade.w * close.z;
    let three = max(four, fade.z * close.y);
    let two = max(three, fade.y * close.x);
    return vec4<f32>(max(two, fade.x), two, three, four);
}

fn hash(p: vec2<f32>) -> f32 {
    let q = fract(p * vec2<f32>(0.1031, 0.1030));
    let r = dot(q, q.yx + 33.33);
    return fract((q.x + r) * (q.y + r) * 57.31);
}

@fragment
fn fragment(in: VertexOutput, @builtin(front_facing) is_front: bool) -> FragmentOutput {
    let level = i32(facade.near_level.w);
    let model = mesh_functions::get_world_from_local(in.instance_index);
    let centre = (model * vec4<f32>(in.uv_b.x, 0.0, in.uv_b.y, 1.0)).xz;
    if level > 0 {
        let reach = reaches(distance(centre, view.world_position.xz), fades(mesh_functions::get_tag(in.instance_index)));
        let threshold = bayer(vec2<u32>(in.position.xy));
        var finer = 0.0;
        if level < 4 { finer = reach[level]; }
        if threshold >= reach[level - 1] || threshold < finer { discard; }
    }

    let layer = i32(in.color.a + 0.5);
    let tile = textureSample(colour_tiles, tile_sampler, in.uv, layer);
    let relief = textureSample(normal_tiles, tile_sampler, in.uv, layer);
    // Where alpha is 1 the tile modulates the vertex colour about one half; where it is 0 it stands as it is.
    let albedo = mix(tile.rgb, 2.0 * tile.rgb * in.color.rgb, tile.a);

    var pbr_input = pbr_input_from_standard_material(in, is_front);
    pbr_input.material.base_color = vec4<f32>(albedo, 1.0);
    pbr_input.material.perceptual_roughness = clamp(relief.a, 0.08, 1.0);

    let n = normalize(in.world_normal);
    var tangent = vec3<f32>(1.0, 0.0, 0.0);
    if abs(n.y) < 0.99 { tangent = normalize(cross(vec3<f32>(0.0, 1.0, 0.0), n)); }
    let bitangent = cross(n, tangent);
    let bump = relief.xyz * 2.0 - 1.0;
    pbr_input.N = normalize(tangent * bump.x + bitangent * bump.y + n * max(bump.z, 0.2));

    // Contact shade where walls meet the ground.
    let foot = smoothstep(-0.2, 1.6, in.world_position.y);
    let wall = 1.0 - abs(n.y);
    pbr_input.diffuse_occlusion *= vec3<f32>(mix(1.0, mix(0.55, 1.0, foot), wall));

    // Lit windows at night: glass is what is dark and smooth on a wall.
    if facade.far_lit.w > 0.0 && level > 1 && tile.a < 0.2 && relief.a < 0.3 {
        let bay = floor(in.uv) + floor(centre * 3.0) + vec2<f32>(floor(in.world_position.y / 3.3) * 7.0, 0.0);
        if hash(bay) < facade.far_lit.w {
            pbr_input.material.emissive = vec4<f32>(vec3<f32>(1.0, 0.66, 0.32) * 900.0, 1.0);
        }
    }

    var out: FragmentOutput;
    out.color = apply_pbr_lighting(pbr_input);
    out.color = main_pass_post_lighting_processing(pbr_input, out.color);
    return out;
}
