// How living things move: birds by poses that the processor tells, cloth by the wind. The main pass and the shadows ask the same.
#define_import_path veduta_life::motion

struct Life {
    // Luminance of what surfaces see that look up, level and down, candela per square metre; `fill[0].w`: 0 by day, 1 at night.
    fill: array<vec4<f32>, 3>,
    // `x`, `y`: where the wind blows to (world x, z); `z`: its mean speed, metres a second.
    wind: vec4<f32>,
    // Of the sky overhead and at the horizon.
    zenith: vec4<f32>,
    horizon: vec4<f32>,
}

struct Moved {
    place: vec3<f32>,
    normal: vec3<f32>,
}

// Swells of the wind: radians a second, and shares of its mean.
const GUSTS: array<vec2<f32>, 4> = array<vec2<f32>, 4>(
    vec2<f32>(0.41, 0.34), vec2<f32>(0.97, 0.24), vec2<f32>(2.13, 0.15), vec2<f32>(4.71, 0.08),
);

// Speed of the wind at a place and time.
fn wind_speed(life: Life, place: vec3<f32>, time: f32) -> f32 {
    let late = time - dot(life.wind.xy, place.xz) / max(life.wind.z, 1.0);
    var gusts = 1.0;
    gusts += GUSTS[0].y * sin(GUSTS[0].x * late);
    gusts += GUSTS[1].y * sin(GUSTS[1].x * late);
    gusts += GUSTS[2].y * sin(GUSTS[2].x * late);
    gusts += GUSTS[3].y * sin(GUSTS[3].x * late);
    return max(life.wind.z * gusts, 0.0);
}

// How steeply cloth hangs from its pole in a wind, radians below level, and how long its waves are, metres.
const LIMP: f32 = 1.45;
const TAUT: f32 = 0.10;
const TAUT_M_S: f32 = 8.0;
const WAVE_M: f32 = 0.95;

fn cloth_at(life: Life, top: vec3<f32>, pole: vec3<f32>, size: vec2<f32>, uv: vec2<f32>, time: f32, phase: f32) -> vec3<f32> {
    let speed = wind_speed(life, top, time);
    let taut = smoothstep(0.0, TAUT_M_S, speed);
    let droop = mix(LIMP, TAUT, sqrt(taut));
    let fly = normalize(vec3<f32>(life.wind.x * cos(droop), -sin(droop), life.wind.y * cos(droop)));
    let out = normalize(cross(fly, pole) + vec3<f32>(1e-4, 0.0, 0.0));
    let along = uv.x * size.x;
    // Waves run from the pole to the free end, faster in more wind; the pole's edge is held.
    let run = 6.2831853 * (along / WAVE_M - (0.55 + 0.11 * speed) * time) + phase;
    let swing = size.x * (0.035 + 0.055 * taut) * sqrt(uv.x) * uv.x;
    let wave = swing * (sin(run + 0.9 * uv.y) + 0.4 * sin(1.9 * run - 1.7 * uv.y + phase));
    // Folds shorten it, and its lower corner hangs back.
    let sag = vec3<f32>(0.0, -0.10 * (1.0 - taut) * along * uv.y, 0.0);
    return top - pole * (size.y * uv.y) + fly * (along * (0.985 - 0.06 * (1.0 - taut))) + out * wave + sag;
}

// A point of a flag, of which `uv` tells how far it is from the pole and from its top.
fn cloth(life: Life, top: vec3<f32>, pole: vec3<f32>, size: vec2<f32>, uv: vec2<f32>, time: f32, phase: f32) -> Moved {
    let here = cloth_at(life, top, pole, size, uv, time, phase);
    let across = cloth_at(life, top, pole, size, uv + vec2<f32>(0.02, 0.0), time, phase) - here;
    let down = cloth_at(life, top, pole, size, uv + vec2<f32>(0.0, 0.02), time, phase) - here;
    return Moved(here, normalize(cross(down, across)));
}

// A pigeon's parts.
const BODY: f32 = 0.0;
const RIGHT_WING: f32 = 1.0;
const LEFT_WING: f32 = 2.0;
const RIGHT_LEG: f32 = 3.0;
const LEFT_LEG: f32 = 4.0;
// Where its neck bends, how far when it pecks; where its hips and shoulders are.
const NECK: vec2<f32> = vec2<f32>(0.125, 0.062);
const BOW: f32 = 1.85;
const HIP: vec3<f32> = vec3<f32>(0.0, 0.070, 0.0);
const SHOULDER: vec2<f32> = vec2<f32>(0.040, 0.140);

// Turns (y, z) forwards and down.
fn bowed(p: vec2<f32>, angle: f32) -> vec2<f32> {
    let s = sin(angle);
    let c = cos(angle);
    return vec2<f32>(p.x * c - p.y * s, p.y * c + p.x * s);
}

// A point of a spread wing by its span and chord, raised by an angle.
fn wing(span_chord: vec2<f32>, side: f32, raised: f32) -> Moved {
    let s = span_chord.x;
    let chord = mix(0.15, 0.035, s * s);
    let lead = 0.055 + 0.035 * sin(2.6 * s) - 0.085 * s * s;
    let length = 0.29 * s;
    // The hand beats further than the arm.
    let angle = raised * (0.55 + 0.45 * s);
    let camber = 0.018 * sin(3.1416 * span_chord.y) * (1.0 - 0.5 * s);
    let normal = vec3<f32>(-side * sin(angle), cos(angle), 0.0);
    let place = vec3<f32>(side * (SHOULDER.x + length * cos(angle)), SHOULDER.y + length * sin(angle), lead - chord * span_chord.y);
    return Moved(place + normal * camber, normal);
}

// A point of a bird, by three numbers of four each: place and heading; pitch, roll, spread, beat; stride, peck, nod and hue. Body: x to its
// right, y up, z to its beak.
fn bird(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, folded: vec3<f32>, folded_normal: vec3<f32>, uv: vec2<f32>, part: f32) -> Moved {
    var p = folded;
    var n = folded_normal;
    let spread = b.z;
    if part == BODY {
        // `uv.x` is how much a point belongs to the head.
        let bow = uv.x * BOW * c.y;
        let q = bowed(p.yz - NECK, bow);
        p = vec3<f32>(p.x, q + NECK);
        p.z += uv.x * 0.014 * c.z * (1.0 - c.y);
        let m = bowed(n.yz, bow);
        n = vec3<f32>(n.x, m);
    } else if part < RIGHT_LEG {
        let side = select(-1.0, 1.0, part == RIGHT_WING);
        let open = wing(uv, side, b.w);
        p = mix(p, open.place, spread);
        n = normalize(mix(n, open.normal, spread));
    } else {
        let side = select(-1.0, 1.0, part == RIGHT_LEG);
        let below = (HIP.y - p.y) / HIP.y;
        p.z -= side * 0.028 * c.x * below;
        p.y += 0.010 * max(-side * c.x, 0.0) * below * (1.0 - abs(c.x));
        // In the air legs are drawn up.
        p = mix(p, vec3<f32>(p.x * 0.7, HIP.y + 0.01 - 0.012 * below, p.z - 0.035 * below), smoothstep(0.3, 0.9, spread));
    }
    // Legs stay on the ground while the body leans.
    if part < RIGHT_LEG || spread > 0.01 {
        let tilt = select(b.x, b.x * spread, part >= RIGHT_LEG);
        let s = sin(tilt);
        let k = cos(tilt);
        let q = p - HIP;
        p = HIP + vec3<f32>(q.x, q.y * k + q.z * s, q.z * k - q.y * s);
        n = vec3<f32>(n.x, n.y * k + n.z * s, n.z * k - n.y * s);
        let sr = sin(b.y);
        let kr = cos(b.y);
        p = vec3<f32>(p.x * kr + (p.y - HIP.y) * sr, HIP.y + (p.y - HIP.y) * kr - p.x * sr, p.z);
        n = vec3<f32>(n.x * kr + n.y * sr, n.y * kr - n.x * sr, n.z);
    }
    let sh = sin(a.w);
    let ch = cos(a.w);
    let right = vec3<f32>(ch, 0.0, sh);
    let ahead = vec3<f32>(sh, 0.0, -ch);
    let up = vec3<f32>(0.0, 1.0, 0.0);
    return Moved(a.xyz + right * p.x + up * p.y + ahead * p.z, normalize(right * n.x + up * n.y + ahead * n.z));
}
