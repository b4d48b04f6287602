// Smoke, water and the shade under birds: little pictures that are moved by time alone.
#import bevy_pbr::{
    forward_io::{VertexOutput, FragmentOutput},
    mesh_functions,
    mesh_view_bindings::{globals, lights, view},
    pbr_functions::main_pass_post_lighting_processing,
    pbr_types::{STANDARD_MATERIAL_FLAGS_FOG_ENABLED_BIT, pbr_input_new},
    view_transformations::position_world_to_clip,
}
#import veduta_life::motion::{Life, wind_speed}

@group(#{MATERIAL_BIND_GROUP}) @binding(100) var<uniform> life: Life;
// Chimneys (place, strength), or birds as `motion` has them.
@group(#{MATERIAL_BIND_GROUP}) @binding(101) var<uniform> sources: array<vec4<f32>, 192>;

struct Vertex {
    @builtin(instance_index) instance_index: u32,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) uv_b: vec2<f32>,
    @location(5) color: vec4<f32>,
}

// What a picture is of.
const PUFF: f32 = 0.0;
const THREAD: f32 = 1.0;
const DROP: f32 = 2.0;
const RING: f32 = 3.0;
const SHADE: f32 = 4.0;

const GRAVITY: f32 = 9.81;
// How long smoke is seen, seconds; how fast it rises at first and grows, metres a second; how much of the wind it takes.
const PUFF_S: f32 = 18.0;
const PUFF_RISE: f32 = 1.75;
const PUFF_GROWTH: f32 = 0.20;
const PUFF_WIND: f32 = 0.42;

fn hash(p: vec2<f32>) -> f32 {
    var q = fract(vec3<f32>(p.xyx) * 0.1031);
    q += dot(q, q.yzx + 33.33);
    return fract((q.x + q.y) * q.z);
}

fn noise(p: vec2<f32>) -> f32 {
    let i = floor(p);
    let f = fract(p);
    let u = f * f * (3.0 - 2.0 * f);
    return mix(
        mix(hash(i), hash(i + vec2<f32>(1.0, 0.0)), u.x),
        mix(hash(i + vec2<f32>(0.0, 1.0)), hash(i + vec2<f32>(1.0, 1.0)), u.x),
        u.y,
    );
}

@vertex
fn vertex(vertex: Vertex) -> VertexOutput {
    var out: VertexOutput;
    let model = mesh_functions::get_world_from_local(vertex.instance_index);
    let kind = vertex.uv_b.x;
    let time = globals.time;
    let right = view.world_from_view[0].xyz;
    let up = view.world_from_view[1].xyz;
    var place = (model * vec4<f32>(vertex.position, 1.0)).xyz;
    var opacity = 1.0;
    var along = 0.0;
    if kind == PUFF {
        let source = sources[u32(vertex.normal.x + 0.5)];
        let seed = vertex.normal.z;
        let life_share = fract(time / PUFF_S + vertex.normal.y);
        let age = life_share * PUFF_S;
        let speed = wind_speed(life, source.xyz, time - 0.5 * age);
        // It leaves upwards and is taken by the wind, wavering.
        let taken = age - 1.6 * (1.0 - exp(-age / 1.6));
        let rise = PUFF_RISE * (6.0 * (1.0 - exp(-age / 6.0)) + 0.25 * age) / (1.0 + 0.10 * life.wind.z);
        let waver = vec3<f32>(sin(0.7 * age + 40.0 * seed), 0.4 * sin(0.5 * age + 70.0 * seed), cos(0.6 * age + 90.0 * seed));
        let size = 0.34 + PUFF_GROWTH * age * (0.8 + 0.4 * seed);
        place = (model * vec4<f32>(source.xyz, 1.0)).xyz
            + vec3<f32>(life.wind.x, 0.0, life.wind.y) * (PUFF_WIND * speed * taken)
            + vec3<f32>(0.0, rise, 0.0) + waver * (0.07 * age * 0.6);
        let spin = 6.28 * seed + (seed - 0.5) * 0.5 * age;
        let corner = vec2<f32>(vertex.uv.x * cos(spin) - vertex.uv.y * sin(spin), vertex.uv.x * sin(spin) + vertex.uv.y * cos(spin));
        place += (right * corner.x + up * corner.y) * size * step(0.001, source.w);
        opacity = 0.80 * source.w * smoothstep(0.0, 0.05, life_share) * pow(1.0 - life_share, 1.5) * pow(0.4 / size + 0.12, 0.5);
        along = life_share;
    } else if kind == THREAD {
        let flight = vertex.uv_b.y;
        let age = vertex.uv.y * flight;
        let speed = (model * vec4<f32>(vertex.normal - vec3<f32>(0.0, GRAVITY * age, 0.0), 0.0)).xyz;
        place = (model * vec4<f32>(vertex.position + vertex.normal * age - vec3<f32>(0.0, 0.5 * GRAVITY * age * age, 0.0), 1.0)).xyz;
        let to_eye = view.world_position - place;
        // Water draws together as it gathers speed, and scatters before it lands.
        let width = vertex.color.r * (0.8 + 0.5 * vertex.uv.y + 1.6 * pow(vertex.uv.y, 4.0));
        place += normalize(cross(speed, to_eye) + vec3<f32>(1e-5, 0.0, 0.0)) * vertex.uv.x * width;
        opacity = 0.62 - 0.3 * vertex.uv.y;
        along = age;
    } else if kind == DROP {
        let flight = vertex.uv_b.y;
        let turns = time / flight + vertex.color.g;
        let age = fract(turns) * flight;
        // Each flight of a drop is thrown a little otherwise.
        let toss = vec2<f32>(vertex.color.b * 57.0, floor(turns));
        let stray = vec3<f32>(hash(toss), hash(toss + 3.3), hash(toss + 7.7)) - 0.5;
        let thrown = vertex.normal * (1.0 + 0.14 * stray.y) + stray * (0.22 + 0.1 * length(vertex.normal));
        let speed = (model * vec4<f32>(thrown - vec3<f32>(0.0, GRAVITY * age, 0.0), 0.0)).xyz;
        place = (model * vec4<f32>(vertex.position + thrown * age - vec3<f32>(0.0, 0.5 * GRAVITY * age * age, 0.0), 1.0)).xyz;
        let to_eye = normalize(view.world_position - place);
        let way = normalize(speed + vec3<f32>(0.0, -1e-4, 0.0));
        let side = normalize(cross(way, to_eye) + vec3<f32>(1e-5, 0.0, 0.0));
        let size = vertex.color.r * (0.7 + 0.6 * hash(toss + 11.0));
        place += side * vertex.uv.x * size + way * vertex.uv.y * size * (1.0 + 0.28 * length(speed));
        opacity = 0.75 * smoothstep(0.0, 0.06, age) * (1.0 - smoothstep(flight * 0.93, flight, age));
        along = hash(toss + 19.0);
    } else if kind == RING {
        let turns = time / vertex.color.b + vertex.color.g;
        let share = fract(turns);
        let toss = vec2<f32>(vertex.color.g * 91.0, floor(turns));
        let stray = vec2<f32>(hash(toss), hash(toss + 5.1)) - 0.5;
        let radius = vertex.color.r * (0.15 + 0.85 * sqrt(share));
        place += vec3<f32>(vertex.uv.x * radius + stray.x * vertex.color.r, 0.0, vertex.uv.y * radius + stray.y * vertex.color.r);
        opacity = 0.5 * (1.0 - share) * (1.0 - share);
        along = share;
    } else {
        let n = u32(vertex.normal.x + 0.5) * 3u;
        let pose = sources[n];
        // In the air there is none: what lies below is not known here.
        let spread = sources[n + 1u].z;
        let s = sin(pose.w);
        let c = cos(pose.w);
        let q = vec2<f32>(vertex.uv.x * 0.13, vertex.uv.y * 0.21 - 0.02);
        place = (model * vec4<f32>(pose.xyz, 1.0)).xyz + vec3<f32>(c * q.x + s * q.y, 0.012, s * q.x - c * q.y) * (1.0 - spread);
        opacity = 0.7 * (1.0 - spread);
    }
    out.world_position = vec4<f32>(place, 1.0);
    out.position = position_world_to_clip(place);
    out.world_normal = vertex.normal;
    out.uv = vertex.uv;
    out.uv_b = vec2<f32>(kind, along);
    out.color = vec4<f32>(vertex.color.rgb, opacity);
    return out;
}

@fragment
fn fragment(in: VertexOutput) -> FragmentOutput {
    // What is the same at all corners of a triangle may still be a little off between them.
    let kind = round(in.uv_b.x);
    let night = life.fill[0].w;
    let to_eye = normalize(view.world_position - in.world_position.xyz);
    let off = length(in.uv);
    var light = 0.5 * (life.fill[0].xyz + life.fill[1].xyz) + night * 9.0 * vec3<f32>(1.0, 0.72, 0.44);
    var toward = 0.0;
    var key = vec3<f32>(0.0);
    if lights.n_directional_lights > 0u {
        let sun = &lights.directional_lights[0];
        key = (*sun).color.rgb / 3.14159;
        toward = max(dot(-to_eye, (*sun).direction_to_light), 0.0);
    }
    var alpha = in.color.a;
    var radiance = vec3<f32>(0.0);
    if kind == PUFF {
        // Soft in the middle, torn at the rim; brighter against the light.
        let torn = noise(in.uv * 2.3 + vec2<f32>(in.world_normal.z * 51.0, in.uv_b.y * 2.0));
        alpha *= 1.0 - smoothstep(0.15, 1.0, off + 0.35 * (torn - 0.5));
        radiance = 0.78 * light + key * (0.30 + 0.35 * toward * toward);
    } else if kind == THREAD {
        // Waves run down with the water, and break it into drops.
        let runs = in.uv_b.y * 11.0 - globals.time * 11.0 + in.color.g * 31.0;
        let broken = noise(vec2<f32>(in.uv.x * 1.2 + in.color.g * 17.0, runs));
        let share = in.uv.y;
        alpha *= (1.0 - smoothstep(0.3, 1.0, abs(in.uv.x))) * mix(1.0, smoothstep(0.3, 0.75, broken), smoothstep(0.15, 0.9, share));
        let glint = pow(broken, 6.0);
        radiance = 0.55 * light + 0.45 * mix(life.horizon.xyz, life.zenith.xyz, broken) + key * (0.10 + 2.2 * glint + 1.5 * pow(toward, 8.0));
    } else if kind == DROP {
        alpha *= 1.0 - smoothstep(0.2, 1.0, off);
        let glint = step(0.82, in.uv_b.y);
        radiance = 0.7 * light + 0.5 * life.horizon.xyz + key * (0.15 + 2.4 * glint + 1.5 * pow(toward, 8.0));
    } else if kind == RING {
        let rim = smoothstep(0.62, 0.85, off) * (1.0 - smoothstep(0.88, 1.0, off));
        let foam = (1.0 - smoothstep(0.0, 0.55, off)) * 0.5 * (1.0 - in.uv_b.y);
        alpha *= max(rim, foam);
        radiance = 0.6 * light + 0.5 * life.horizon.xyz + 0.15 * key;
    } else {
        alpha *= 1.0 - smoothstep(0.1, 1.0, off);
    }
    var out: FragmentOutput;
    var pbr_input = pbr_input_new();
    pbr_input.frag_coord = in.position;
    pbr_input.world_position = in.world_position;
    pbr_input.material.flags |= STANDARD_MATERIAL_FLAGS_FOG_ENABLED_BIT;
    out.color = main_pass_post_lighting_processing(pbr_input, vec4<f32>(radiance * view.exposure, clamp(alpha, 0.0, 1.0)));
    return out;
}
