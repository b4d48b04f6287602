// Sky dome: gradient, glow and disc of the sun, clouds on a plane, stars.
#import bevy_pbr::{forward_io::VertexOutput, mesh_view_bindings::view}
#ifdef TONEMAP_IN_SHADER
#import bevy_core_pipeline::tonemapping::tone_mapping
#endif

struct Sky {
    zenith: vec4<f32>,
    horizon: vec4<f32>,
    sun: vec4<f32>,
    key: vec4<f32>,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<uniform> sky: Sky;

fn hash(p: vec2<f32>) -> f32 {
    var q = fract(vec3<f32>(p.xyx) * 0.1031);
    q += dot(q, q.yzx + 33.33);
    return fract((q.x + q.y) * q.z);
}

fn noise(p: vec2<f32>) -> f32 {
    let i = floor(p);
    let f = fract(p);
    let u = f * f * (3.0 - 2.0 * f);
    return mix(mix(hash(i), hash(i + vec2(1.0, 0.0)), u.x), mix(hash(i + vec2(0.0, 1.0)), hash(i + vec2(1.0, 1.0)), u.x), u.y);
}

fn clouds(p: vec2<f32>) -> f32 {
    var sum = 0.0;
    var amplitude = 0.5;
    var q = p;
    for (var i = 0; i < 5; i++) {
        sum += amplitude * noise(q);
        q = mat2x2<f32>(1.6, 1.2, -1.2, 1.6) * q + vec2(3.1, 1.7);
        amplitude *= 0.5;
    }
    return sum;
}

// What lamps and windows send up to low clouds, beside the dome's colours.
const CITY_GLOW: vec3<f32> = vec3<f32>(0.090, 0.058, 0.034);

// Radius of the moon, radians: four times its true quarter of a degree.
const MOON: f32 = 0.018;

// The moon's disc with its seas, shaded as a gibbous one, and the glow about it.
fn moon(dir: vec3<f32>, to_moon: vec3<f32>) -> vec3<f32> {
    let right = normalize(cross(vec3(0.0, 1.0, 0.0), to_moon));
    let at = vec2(dot(dir, right), dot(dir, cross(to_moon, right))) / MOON;
    let away = length(at);
    let glow = select(0.0, 0.12 * exp(-away * 0.35) + 0.03 * exp(-away * 0.06), dot(dir, to_moon) > 0.0);
    if away > 1.0 || dot(dir, to_moon) < 0.0 { return sky.key.rgb * glow; }
    let disc = 1.0 - smoothstep(0.94, 1.0, away);
    let rise = sqrt(max(1.0 - dot(at, at), 0.0));
    let lit = smoothstep(-0.05, 0.25, dot(vec3(at, rise), normalize(vec3(0.75, 0.25, 0.6))));
    let seas = smoothstep(0.42, 0.66, clouds(at * 1.6 + 4.0));
    return sky.key.rgb * glow + vec3(1.0, 0.96, 0.86) * disc * lit * (1.7 - 0.75 * seas);
}

@fragment
fn fragment(in: VertexOutput) -> @location(0) vec4<f32> {
    let dir = normalize(in.world_position.xyz - view.world_position.xyz);
    let up = max(dir.y, 0.0);
    let toward = max(dot(dir, sky.sun.xyz), 0.0);
    var colour = mix(sky.horizon.rgb, sky.zenith.rgb, pow(up, 0.45));
    // The horizon towards the sun is warmer and brighter than the one behind.
    let low = pow(1.0 - up, 6.0);
    colour += sky.key.rgb * (0.30 * pow(toward, 6.0) * low + 0.10 * pow(toward, 24.0));
    let day = 1.0 - sky.horizon.w;
    // Where the key light of the night comes from.
    let to_moon = normalize(vec3(-sky.sun.x, 0.8, -sky.sun.z));
    let toward_moon = max(dot(dir, to_moon), 0.0);
    // Clouds drift on a plane overhead, thinner towards the horizon.
    if dir.y > 0.01 {
        let plane = dir.xz / (dir.y + 0.12) * 1.3 + vec2(sky.sun.w, sky.sun.w * 0.4);
        let body = clouds(plane);
        let cover = smoothstep(1.0 - sky.key.w - 0.12, 1.0 - sky.key.w + 0.22, body) * smoothstep(0.02, 0.22, dir.y);
        let shade = clouds(plane + sky.sun.xz * 0.18);
        let lit = clamp(0.5 + (body - shade) * 2.2, 0.0, 1.0);
        let by_day = mix(mix(sky.zenith.rgb, sky.horizon.rgb, 0.55), sky.horizon.rgb * 0.45 + sky.key.rgb * 0.75, lit);
        // At night clouds are darker than the sky, but for what the city sends up to them and the moon lends their edges.
        let by_night = 0.7 * sky.zenith.rgb + CITY_GLOW * low + sky.key.rgb * (0.02 * lit + 0.10 * pow(toward_moon, 12.0));
        let cloud = mix(by_night, by_day, day);
        colour = mix(colour, cloud, cover * 0.82);
        // Stars between the clouds at night.
        let grid = floor(dir.xz / (dir.y + 0.3) * 220.0);
        let star = step(0.9975, hash(grid)) * hash(grid + 7.0);
        colour += vec3(star * 0.5 * smoothstep(0.7, 1.0, sky.horizon.w) * (1.0 - cover) * up);
        // The moon, as much too large as the sun; thin cloud passes before it.
        if sky.horizon.w > 0.0 { colour += moon(dir, to_moon) * sky.horizon.w * (1.0 - 0.75 * cover); }
    }
    // The sun's disc, four times its true half degree so that it reads at small sizes.
    colour += sky.key.rgb * smoothstep(0.99965, 0.9998, dot(dir, sky.sun.xyz)) * 12.0 * day;
    // Below the horizon: haze.
    colour = mix(colour, sky.horizon.rgb * 0.8, smoothstep(0.0, -0.08, dir.y));
    var out = vec4<f32>(colour * sky.zenith.w * view.exposure, 1.0);
#ifdef TONEMAP_IN_SHADER
    out = tone_mapping(out, view.color_grading);
#endif
    return out;
}
