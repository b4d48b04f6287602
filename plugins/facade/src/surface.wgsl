// What weather and years leave on surfaces, in metres where tiles repeat in centimetres, and different on every house.
#define_import_path veduta_facade::surface

// What a texel of the normal picture tells: the normal, and how rough it is; of cards, how much they cover.
fn unpacked(texel: vec4<f32>, is_card: bool) -> vec4<f32> {
    let parts = select(texel.agr, texel.rga, is_card);
    let xy = parts.xy * 2.0 - 1.0;
    return vec4<f32>(xy, sqrt(max(1.0 - dot(xy, xy), 0.0)), parts.z);
}

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

// Three octaves, 0 to 1.
fn clouds(p: vec2<f32>) -> f32 {
    return 0.55 * noise(p) + 0.30 * noise(p * 2.3 + 11.0) + 0.15 * noise(p * 5.1 + 23.0);
}

// What is left of all this where level 3 is forbidden.
fn plain_wear(at: vec3<f32>, up: f32) -> f32 {
    let across = select(vec2<f32>(at.x + at.z, at.y * 0.7) * 0.33, at.xz * 0.13, abs(up) > 0.9);
    return 0.86 + 0.2 * noise(across);
}

// How wall paint has aged at a place: `along` and `height` in metres, the height above the house's floor; `seed` is the façade's own.
// `near` is how much of the finer marks is seen, 0 to 1.
fn wall_paint(along: f32, height: f32, seed: f32, near: f32) -> vec3<f32> {
    let at = vec2<f32>(along, height) + seed * vec2<f32>(517.0, 131.0);
    // Mottled in patches as wide as a man, lighter where the last coat took better.
    let mottle = clouds(at * vec2<f32>(0.55, 0.42));
    var tone = vec3<f32>(0.90 + 0.2 * mottle);
    // Rain washes long streaks, and leaves more of them low on the wall.
    let streak = noise(vec2<f32>(at.x * 2.7, at.y * 0.16)) * noise(vec2<f32>(at.x * 7.9, at.y * 0.3 + 5.0));
    tone *= 1.0 - (0.10 + 0.16 * near) * smoothstep(0.25, 0.75, streak);
    // Splashes and rising damp at the foot, with a wavering edge.
    let edge = 0.35 + 0.65 * noise(vec2<f32>(at.x * 0.8, 3.0)) + 0.2 * noise(at * 3.1);
    let damp = 1.0 - smoothstep(edge * 0.35, edge, height);
    tone *= mix(vec3<f32>(1.0), vec3<f32>(0.70, 0.66, 0.60), damp);
    // Repairs in another paint.
    let repair = noise(at * vec2<f32>(0.21, 0.33) + 40.0);
    tone *= mix(vec3<f32>(1.0), vec3<f32>(1.05, 1.045, 1.02), near * smoothstep(0.70, 0.715, repair));
    // Hairlines.
    let crack = abs(noise(at * 0.9 + 1.7 * noise(at * 2.2)) - 0.5);
    tone *= 1.0 - 0.28 * near * (1.0 - smoothstep(0.0, 0.008, crack)) * smoothstep(0.45, 0.7, noise(at * 0.31 + 9.0));
    return tone;
}

// How a roof's covering has aged: soot and lichen, more on the lower courses.
fn roof_cover(at: vec3<f32>, seed: f32, near: f32) -> vec3<f32> {
    let p = at.xz + vec2<f32>(at.y * 0.7, 0.0) + seed * 211.0;
    let soot = clouds(p * 0.35);
    let lichen = smoothstep(0.58, 0.78, clouds(p * 0.9 + 31.0));
    let house = 0.86 + 0.26 * seed;
    let tone = vec3<f32>(house * (0.78 + 0.4 * soot));
    return tone * mix(vec3<f32>(1.0), vec3<f32>(0.86, 0.95, 0.78), 0.55 * lichen * (0.4 + 0.6 * near));
}

// A row of flagstones among setts.
struct SlabRow {
    // Where its picture is read, and how that moves from pixel to pixel.
    uv: vec2<f32>,
    uv_across: vec2<f32>,
    uv_down: vec2<f32>,
    // How much of the pixel is flagstones.
    share: f32,
    // Whether it runs across the course, not along it.
    is_across: bool,
}

// Metres that a tile of setts is wide, and one of flagstones; how broad a row of them is, and how far apart rows are: a part of what courses
// repeat after.
const SETTS_M: f32 = 1.6;
const FLAGSTONES_M: f32 = 3.2;
const ROW_M: f32 = 0.5333;
const FIELD_M: f32 = 8.0;
// Where in the picture of flagstones the middle of a row lies.
const ROW_FROM_M: f32 = 0.48;

// How much of a pixel `wide` metres wide lies in a row whose middle is `off` metres away.
fn row_share(off: f32, wide: f32) -> f32 {
    let w = clamp(wide, 1e-4, FIELD_M);
    return max(min(off + 0.5 * ROW_M, 0.5 * w) - max(off - 0.5 * ROW_M, -0.5 * w), 0.0) / w;
}

// Rows along and across a course, of setts' texture coordinates.
fn slab_row(uv: vec2<f32>, uv_across: vec2<f32>, uv_down: vec2<f32>) -> SlabRow {
    let at = uv * SETTS_M;
    let off = at - FIELD_M * floor(at / FIELD_M + 0.5);
    let wide = (abs(uv_across) + abs(uv_down)) * SETTS_M;
    let shares = vec2<f32>(row_share(off.x, wide.x), row_share(off.y, wide.y));
    let scale = SETTS_M / FLAGSTONES_M;
    var row: SlabRow;
    row.share = max(shares.x, shares.y);
    row.is_across = shares.x > shares.y;
    // A row of its picture fills it.
    row.uv = vec2<f32>(at.x, off.y + ROW_FROM_M) / FLAGSTONES_M;
    row.uv_across = uv_across * scale;
    row.uv_down = uv_down * scale;
    if row.is_across {
        row.uv = vec2<f32>(at.y, off.x + ROW_FROM_M) / FLAGSTONES_M;
        row.uv_across = row.uv_across.yx;
        row.uv_down = row.uv_down.yx;
    }
    return row;
}

// How ground is trodden and stained.
fn ground_wear(at: vec2<f32>, near: f32) -> vec3<f32> {
    let broad = noise(at * 0.055);
    let paths = clouds(at * 0.17);
    let stains = smoothstep(0.62, 0.8, clouds(at * 0.63 + 7.0));
    let tone = 0.80 + 0.16 * broad + 0.22 * paths;
    return vec3<f32>(tone) * mix(vec3<f32>(1.0), vec3<f32>(0.80, 0.79, 0.77), stains * (0.5 + 0.5 * near));
}

// How much of a puddle stands at a place of level ground, 0 to 1.
fn puddle(at: vec2<f32>, wet: f32) -> f32 {
    let hollow = 0.7 * noise(at * 0.21 + 3.0) + 0.3 * noise(at * 0.83 + 17.0);
    return smoothstep(1.02 - 0.45 * wet, 1.10 - 0.45 * wet, hollow + 0.35 * wet) * step(0.01, wet);
}
