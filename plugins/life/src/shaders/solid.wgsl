// Birds, flags, signs, dials and figures: moved by `motion`, lit as the city is.
#import bevy_pbr::{
    pbr_fragment::pbr_input_from_standard_material,
    pbr_functions::{apply_pbr_lighting, main_pass_post_lighting_processing},
    pbr_types::{STANDARD_MATERIAL_FLAGS_FOG_ENABLED_BIT, pbr_input_new},
    forward_io::{VertexOutput, FragmentOutput},
    mesh_functions,
    mesh_view_bindings::{globals, lights, view},
    view_transformations::position_world_to_clip,
}
#import veduta_life::motion::{Life, Moved, bird, cloth, wind_speed}

@group(#{MATERIAL_BIND_GROUP}) @binding(100) var<uniform> life: Life;
#ifdef BIRDS
@group(#{MATERIAL_BIND_GROUP}) @binding(101) var<uniform> poses: array<vec4<f32>, 192>;
#endif

struct Vertex {
    @builtin(instance_index) instance_index: u32,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) uv_b: vec2<f32>,
    @location(5) color: vec4<f32>,
}

// What floodlights and lamps send onto what is lit at night, lux, and the share of all else.
const FLOODLIGHT: f32 = 170.0;
const STREET_GLOW: f32 = 60.0;

@vertex
fn vertex(vertex: Vertex) -> VertexOutput {
    var out: VertexOutput;
    let model = mesh_functions::get_world_from_local(vertex.instance_index);
    var place = (model * vec4<f32>(vertex.position, 1.0)).xyz;
    var normal = mesh_functions::mesh_normal_local_to_world(vertex.normal, vertex.instance_index);
    var color = vertex.color;
#ifdef BIRDS
    let n = u32(vertex.uv_b.x + 0.5) * 3u;
    let c = poses[n + 2u];
    let moved = bird(poses[n], poses[n + 1u], c, vertex.position, vertex.normal, vertex.uv, vertex.uv_b.y);
    place = (model * vec4<f32>(moved.place, 1.0)).xyz;
    normal = moved.normal;
    // Most are blue, some chequered dark, few red or pied.
    let is_plumage = vertex.color.a;
    color = vec4<f32>(plumage(vertex.color.rgb, c.w, is_plumage), c.w);
#else
    if vertex.uv_b.x > 0.0 {
        let moved = cloth(life, place, normal, vertex.uv_b, vertex.uv, globals.time, vertex.color.a * 6.2831853);
        place = moved.place;
        normal = moved.normal;
        color.a = 0.0;
    }
#endif
    out.world_position = vec4<f32>(place, 1.0);
    out.position = position_world_to_clip(place);
    out.world_normal = normal;
    out.uv = vertex.uv;
    out.uv_b = vertex.uv_b;
#ifdef BIRDS
    // The fragments know how far wings are spread, in place of the bird's number.
    out.uv_b.x = poses[n + 1u].z;
#endif
    out.color = color;
#ifdef VERTEX_OUTPUT_INSTANCE_INDEX
    out.instance_index = vertex.instance_index;
#endif
    return out;
}

fn plumage(colour: vec3<f32>, hue: f32, is_plumage: f32) -> vec3<f32> {
    let light = dot(colour, vec3<f32>(0.333));
    var own = colour;
    if hue > 0.93 { own = mix(colour, vec3<f32>(0.72), 0.7); }
    else if hue > 0.84 { own = vec3<f32>(0.30, 0.14, 0.09) * (0.4 + 2.2 * light); }
    else if hue > 0.60 { own = colour * vec3<f32>(0.50, 0.50, 0.54); }
    own *= 0.9 + 0.22 * fract(hue * 37.0);
    return mix(colour, own, is_plumage);
}

@fragment
fn fragment(in: VertexOutput, @builtin(front_facing) is_front: bool) -> FragmentOutput {
    var n = normalize(in.world_normal);
    let to_eye = normalize(view.world_position - in.world_position.xyz);
    if dot(n, to_eye) < 0.0 { n = -n; }
    var albedo = in.color.rgb;
    var roughness = 0.85;
    var shine = 0.0;
    var through = 0.0;
#ifdef BIRDS
    let hue = in.color.a;
    // What is the same at all corners of a triangle may still be a little off between them.
    let part = round(in.uv_b.y);
    if part == 1.0 || part == 2.0 {
        // Two dark bars across a blue bird's wing, folded aslant; dark tips.
        let across = mix(0.92 * in.uv.x + 0.26 * in.uv.y, in.uv.y, in.uv_b.x);
        let bars = 2.0 - smoothstep(0.025, 0.045, abs(across - 0.53)) - smoothstep(0.03, 0.05, abs(across - 0.76));
        let chequer = step(0.6, hue) * step(hue, 0.84) * step(0.55, fract(across * 9.0 + floor(in.uv.y * 5.0) * 0.5));
        let inner = 1.0 - mix(smoothstep(0.75, 0.95, in.uv.x), smoothstep(0.55, 0.75, in.uv.x), in.uv_b.x);
        let dark = clamp(bars * step(hue, 0.6) * inner * smoothstep(0.08, 0.2, in.uv.y) + 0.6 * chequer, 0.0, 1.0);
        albedo *= 1.0 - 0.78 * dark;
        albedo *= 1.0 - 0.66 * smoothstep(0.66, 0.92, in.uv.x) * step(hue, 0.93);
        // Feathers.
        albedo *= 0.93 + 0.07 * cos(in.uv.y * 60.0);
    } else if part == 0.0 {
        // The neck gleams green and purple as it turns.
        let neck = smoothstep(0.12, 0.4, in.uv.x) * (1.0 - smoothstep(0.7, 0.98, in.uv.x)) * step(hue, 0.93);
        let turn = 0.5 + 0.5 * sin(9.0 * dot(n, to_eye) + 3.0 * n.y);
        albedo = mix(albedo, mix(vec3<f32>(0.035, 0.17, 0.11), vec3<f32>(0.16, 0.06, 0.18), turn), 0.75 * neck);
        roughness = mix(roughness, 0.4, neck);
    }
#else
    if in.uv_b.x > 0.0 {
        through = 0.45;
        // Threads, and the hem.
        let hem = min(min(in.uv.x * in.uv_b.x, (1.0 - in.uv.x) * in.uv_b.x), min(in.uv.y, 1.0 - in.uv.y) * in.uv_b.y);
        albedo *= mix(0.86, 1.0, smoothstep(0.015, 0.03, hem));
    } else {
        shine = in.uv.y;
        roughness = mix(0.85, 0.35, shine);
    }
#endif
    let night = life.fill[0].w;
    // What is lit at night is told by alpha; all else stands in the lamps' glow.
#ifdef BIRDS
    let lamps = STREET_GLOW * 0.5;
#else
    let lamps = STREET_GLOW * 0.4 + FLOODLIGHT * select(0.0, in.color.a, in.uv_b.x <= 0.0);
#endif
    var emissive = night * lamps / 3.14159 * albedo * vec3<f32>(1.0, 0.72, 0.44);

    var out: FragmentOutput;
    var key_through = vec3<f32>(0.0);
    if through > 0.0 && lights.n_directional_lights > 0u {
        let key = &lights.directional_lights[0];
        let back = max(-dot(n, (*key).direction_to_light), 0.0);
        key_through = albedo * albedo * through * back / 3.14159 * (*key).color.rgb;
    }
#ifdef PLAIN_LIGHT
    let level_fill = life.fill[1].xyz;
    let fill = mix(level_fill, select(life.fill[2].xyz, life.fill[0].xyz, n.y > 0.0), n.y * n.y);
    var radiance = albedo * fill + emissive + key_through;
    if lights.n_directional_lights > 0u {
        let key = &lights.directional_lights[0];
        radiance += albedo / 3.14159 * (*key).color.rgb * max(dot(n, (*key).direction_to_light), 0.0);
        // Gilding.
        let between = normalize((*key).direction_to_light + to_eye);
        radiance += shine * albedo * (*key).color.rgb * 0.6 * pow(max(dot(n, between), 0.0), 24.0);
    }
    var pbr_input = pbr_input_new();
    pbr_input.frag_coord = in.position;
    pbr_input.world_position = in.world_position;
    pbr_input.material.flags |= STANDARD_MATERIAL_FLAGS_FOG_ENABLED_BIT;
    out.color = vec4<f32>(radiance * view.exposure, 1.0);
#else
    var pbr_input = pbr_input_from_standard_material(in, is_front);
    pbr_input.material.base_color = vec4<f32>(albedo, 1.0);
    pbr_input.material.perceptual_roughness = roughness;
    pbr_input.material.metallic = 0.3 * shine;
    pbr_input.material.emissive = vec4<f32>(emissive + key_through, 1.0);
    pbr_input.world_normal = n;
    pbr_input.N = n;
    out.color = apply_pbr_lighting(pbr_input);
#endif
    out.color = main_pass_post_lighting_processing(pbr_input, out.color);
    return out;
}
