// What is seen in glass: the sky and the houses across the street mirrored, and the room behind.
#define_import_path veduta_facade::glass

#import veduta_facade::surface::{hash, noise}

// Luminance of a lamplit wall at night, candela per square metre.
const LAMPLIT: vec3<f32> = vec3<f32>(11.0, 7.0, 3.6);

// Luminance of the sky at an elevation's sine, and what houses across the street hide of it; `w` of the horizon: night, 0 to 1.
fn mirrored(toward: vec3<f32>, zenith: vec3<f32>, horizon_night: vec4<f32>) -> vec3<f32> {
    let horizon = horizon_night.xyz;
    let sky = mix(horizon, zenith, pow(max(toward.y, 0.0), 0.45));
    // Roofs across the way end at some 30°, unevenly.
    let bearing = normalize(toward.xz + vec2<f32>(1e-5, 0.0));
    let roofs = 0.34 + 0.16 * noise(bearing * 5.0 + 20.0) + 0.06 * noise(bearing * 23.0 + 70.0);
    let walls = horizon * vec3<f32>(0.22, 0.19, 0.16) + horizon_night.w * LAMPLIT * exp(-3.0 * max(toward.y, 0.0));
    let houses = walls * (0.8 + 0.4 * noise(bearing * 9.0 + vec2<f32>(40.0, toward.y * 6.0)));
    return mix(houses, sky, smoothstep(roofs - 0.03, roofs + 0.03, toward.y));
}

// Share of light that glass mirrors, by the cosine of the angle it is seen under.
fn fresnel(cosine: f32) -> f32 {
    return 0.06 + 0.94 * pow(1.0 - clamp(cosine, 0.0, 1.0), 5.0);
}

struct Room {
    // What is seen of it, as albedo.
    albedo: vec3<f32>,
    // How much daylight or lamplight falls there, 0 to 1.
    light: f32,
}

// The room behind a window: a box one bay wide, one storey high and `deep` bays deep. `at` is the place in the bay, v downwards; `look` the
// way the eye looks in bays right, storeys down and bays inward; `seed` the room's own.
fn room(at: vec2<f32>, look: vec3<f32>, seed: f32) -> Room {
    let deep = 1.1 + 0.7 * fract(seed * 7.31);
    let inward = max(look.z, 0.05);
    let ahead = vec3<f32>(
        select(at.x / max(-look.x, 1e-4), (1.0 - at.x) / max(look.x, 1e-4), look.x > 0.0),
        select(at.y / max(-look.y, 1e-4), (1.0 - at.y) / max(look.y, 1e-4), look.y > 0.0),
        deep / inward,
    );
    let far = min(ahead.x, min(ahead.y, ahead.z));
    let hit = vec3<f32>(at, 0.0) + look * far;
    let paper = mix(vec3<f32>(0.42, 0.34, 0.24), vec3<f32>(0.30, 0.36, 0.34), fract(seed * 3.17))
        * mix(vec3<f32>(1.0), vec3<f32>(1.15, 0.85, 0.75), step(0.7, fract(seed * 11.9)));
    var out: Room;
    out.light = 1.0 / (1.0 + 2.2 * hit.z);
    if far == ahead.z {
        // A picture or a dark cupboard on the wall at the back.
        let frame = abs(hit.xy - vec2<f32>(0.25 + 0.5 * fract(seed * 5.3), 0.42)) - vec2<f32>(0.13, 0.1);
        let cupboard = abs(hit.xy - vec2<f32>(0.2 + 0.6 * fract(seed * 2.9), 0.74)) - vec2<f32>(0.16, 0.27);
        out.albedo = paper;
        out.albedo = mix(out.albedo, vec3<f32>(0.16, 0.10, 0.06), step(max(cupboard.x, cupboard.y), 0.0));
        out.albedo = mix(out.albedo, vec3<f32>(0.35, 0.3, 0.18), step(max(frame.x, frame.y), 0.0));
    } else if far == ahead.y {
        out.albedo = select(vec3<f32>(0.62, 0.58, 0.5), vec3<f32>(0.24, 0.16, 0.10), look.y > 0.0);
    } else {
        out.albedo = paper * 0.8;
    }
    return out;
}
