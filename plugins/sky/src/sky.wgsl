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
    // How much the backdrop rises with every metre to it, by direction: first to the north, then clockwise.
    backdrop: array<vec4<f32>, 8>,
    // x: height of the picture of what lies beyond the city, radians; 0 without one.
    picture: vec4<f32>,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<uniform> sky: Sky;
@group(#{MATERIAL_BIND_GROUP}) @binding(1) var beyond: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(2) var beyond_sampler: sampler;

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

// How many houses in a row stand round the horizon, and how many windows each of their storeys has.
const ROOFS: f32 = 300.0;
const WINDOWS: f32 = 5.0;

fn slope(direction: i32) -> f32 {
    let n = (direction + 32) % 32;
    return sky.backdrop[n / 4][n % 4];
}

// Outline of a row of roofs: the share of the backdrop's height that it has at a place in the row.
fn roofs(along: f32, seed: f32) -> f32 {
    let n = floor(along);
    let from_middle = abs(2.0 * fract(along) - 1.0);
    let house = vec2(n, seed);
    let eaves = 0.26 + 0.14 * hash(house);
    let kind = hash(house + 3.7);
    // Ridges along the row, gables, and now and then a tower.
    if kind > 0.98 { return eaves + (0.3 + 0.4 * hash(house + 9.1)) * clamp(2.0 - 6.0 * from_middle, 0.0, 1.0); }
    if kind > 0.7 { return eaves + 0.14 * (1.0 - from_middle); }
    return eaves + 0.11 * min(5.0 * (1.0 - from_middle), 1.0);
}

// What lies beyond the city's edge: hills, a row of roofs before them, and one more before that, the nearer the darker. `rise` is how much
// the direction rises with every metre, `pixel` by how much it changes from one pixel to the next.
fn backdrop(dir: vec3<f32>, rise: f32, pixel: f32, behind: vec3<f32>, day: f32) -> vec3<f32> {
    let turn = fract(atan2(dir.x, -dir.z) / 6.2831853);
    if sky.picture.x > 0.0 {
        let up = atan(rise) / sky.picture.x;
        let seen = textureSampleLevel(beyond, beyond_sampler, vec2(turn, clamp(1.0 - up, 0.002, 0.998)), 0.0);
        let lit = seen.rgb * mix(sky.zenith.rgb * 0.3 + sky.key.rgb * 0.05, sky.horizon.rgb * 0.4 + sky.key.rgb * 0.6, day);
        return mix(behind, lit, seen.a * step(up, 1.0));
    }
    let at = turn * 32.0;
    let high = mix(slope(i32(floor(at))), slope(i32(floor(at)) + 1), smoothstep(0.0, 1.0, fract(at)));
    if high <= 0.0 || rise > high * 1.5 { return behind; }
    let flat = normalize(vec2(dir.x, dir.z));
    let hills = high * (0.10 + 0.85 * noise(flat * 3.0 + 11.0) + 0.06 * noise(flat * 31.0));
    let back = high * roofs(turn * ROOFS * 1.4, 1.0) * (0.75 + 0.5 * noise(flat * 9.0));
    let front = high * 0.8 * roofs(turn * ROOFS, 2.0) * (0.6 + 0.7 * noise(flat * 13.0 + 5.0));
    // In haze, and against it.
    let haze = sky.horizon.rgb;
    let dark = mix(sky.zenith.rgb * 0.22, haze * vec3(0.50, 0.53, 0.60), day);
    var colour = behind;
    colour = mix(colour, mix(dark, haze, 0.68), 1.0 - smoothstep(-pixel, pixel, rise - hills));
    colour = mix(colour, mix(dark, haze, 0.42), 1.0 - smoothstep(-pixel, pixel, rise - back));
    colour = mix(colour, mix(dark, haze, 0.15), 1.0 - smoothstep(-pixel, pixel, rise - front));
    // Some windows are lit at night.
    let pane = vec2(turn * ROOFS * WINDOWS, rise / (high * 0.055));
    let inside = abs(fract(pane) - 0.5);
    let is_lit = step(0.92, hash(floor(pane))) * step(max(inside.x, inside.y), 0.3) * step(rise, front * 0.8) * step(0.0, rise);
    colour += vec3(0.30, 0.19, 0.08) * is_lit * smoothstep(0.35, 0.9, 1.0 - day);
    // Whoever looks over it from above sees haze there, not a line.
    return mix(behind, colour, smoothstep(0.006, 0.035, high));
}

@fragment
fn fragment(in: VertexOutput) -> @location(0) vec4<f32> {
    let dir = normalize(in.world_position.xyz - view.world_position.xyz);
    let up = max(dir.y, 0.0);
    let rise = dir.y / max(length(dir.xz), 1e-4);
    let pixel = max(fwidth(rise) * 0.7, 1e-5);
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
    if rise > -0.08 && rise < max(0.4, tan(min(sky.picture.x, 1.5))) { colour = mix(backdrop(dir, rise, pixel, colour, day), colour, smoothstep(0.0, -0.08, rise)); }
    var out = vec4<f32>(colour * sky.zenith.w * view.exposure, 1.0);
#ifdef TONEMAP_IN_SHADER
    out = tone_mapping(out, view.color_grading);
#endif
    return out;
}
