// Which level of a façade a pixel belongs to. The prepass and the main pass ask the same question of the same numbers.
#define_import_path veduta_facade::levels

struct Facade {
    near_level: vec4<f32>,
    // What is drawn: walls (0), cards of trees (1), which their tiles do not fill, bodies of trees (2) or fittings (3), of which there is nothing finer.
    far_kind: vec4<f32>,
    zenith_wet: vec4<f32>,
    horizon_night: vec4<f32>,
    fill: array<vec4<f32>, 3>,
}

// Half the angle between the directions of a tree's cards, and half of that over which neighbours take turns; radians.
const HALF_TURN: f32 = 0.3926991;
const HALF_BAND: f32 = 0.04;
// How far up the normals of upright cards look at most, and that of the card from above at least.
const UPRIGHT: f32 = 0.3;
const LEVEL: f32 = 0.9;
// Sines of the eye's elevation between which slanting cards take over from upright ones, and the one from above from them.
const SLANTING: vec2<f32> = vec2<f32>(0.44, 0.56);
const FROM_ABOVE: vec2<f32> = vec2<f32>(0.82, 0.91);

// Whether a card is the one of its tree to be seen from a direction: at every threshold it is one of them.
fn is_turned_to(normal: vec3<f32>, to_eye: vec3<f32>, threshold: f32) -> bool {
    let slanting = smoothstep(SLANTING.x, SLANTING.y, to_eye.y);
    let above = smoothstep(FROM_ABOVE.x, FROM_ABOVE.y, to_eye.y);
    let n = normalize(normal);
    if abs(n.y) > LEVEL { return threshold < above; }
    let is_upright = abs(n.y) < UPRIGHT;
    if is_upright && threshold < slanting { return false; }
    if !is_upright && (threshold >= slanting || threshold < above) { return false; }
    // Slanting cards look up.
    let front = n.xz * select(sign(n.y), sign(dot(n.xz, to_eye.xz)), is_upright);
    let angle = atan2(front.x * to_eye.z - front.y * to_eye.x, dot(front, to_eye.xz));
    let share = clamp((HALF_TURN + HALF_BAND - abs(angle)) / (2.0 * HALF_BAND), 0.0, 1.0);
    // One has the lower thresholds, its neighbour the others.
    if angle > 0.0 { return threshold < share; }
    return threshold >= 1.0 - share;
}

// Whether a card that covers so much of a pixel is drawn there: interleaved gradient noise (Jimenez 2014) thins out twigs and rims.
fn is_drawn(cover: f32, pixel: vec2<f32>) -> bool {
    let grain = fract(52.9829189 * fract(dot(floor(pixel), vec2<f32>(0.06711056, 0.00583715))));
    return cover > 0.2 + 0.6 * grain;
}

// Threshold of the 8×8 Bayer pattern at a pixel, in (0, 1): bits of x and x^y interleaved, most significant last.
fn bayer(pixel: vec2<u32>) -> f32 {
    let x = pixel.x & 7u;
    let y = (pixel.x ^ pixel.y) & 7u;
    let v = ((x & 4u) >> 2u) | ((y & 4u) >> 1u) | ((x & 2u) << 1u) | ((y & 2u) << 2u) | ((x & 1u) << 4u) | ((y & 1u) << 5u);
    // `y` carries the heavier bit of each pair.
    return (f32(v) + 0.5) / 64.0;
}

// How far each level has faded in, from the mesh's tag: two bits for level 1, ten for each of the others.
fn fades(tag: u32) -> vec4<f32> {
    let finer = vec3<f32>(f32((tag >> 2u) & 1023u), f32((tag >> 12u) & 1023u), f32(tag >> 22u)) / 1023.0;
    return vec4<f32>(f32(tag & 3u) / 3.0, finer);
}

// Share of a level's fade, and of its band of distances, in which it takes the place of the one before, looking the same: walls come plain and
// flat. In the rest openings show and relief rises.
const ALIKE_FADE: f32 = 0.2;
const ALIKE_BAND: f32 = 0.2;

// How far the bands of levels 2 to 4 have been crossed, from 0 at their far ends to 1 at their near ones.
fn nearness(facade: Facade, distance: f32) -> vec3<f32> {
    let near = facade.near_level.xyz;
    let far = max(facade.far_kind.xyz, near + vec3<f32>(0.001));
    let allowed = step(vec3<f32>(0.001), facade.far_kind.xyz);
    return allowed * clamp((far - vec3<f32>(distance)) / (far - near), vec3<f32>(0.0), vec3<f32>(1.0));
}

// What is left of a fade and a band once the levels have changed places.
fn unveiled(fade: f32, nearness: f32) -> f32 {
    let faded = clamp((fade - ALIKE_FADE) / (1.0 - ALIKE_FADE), 0.0, 1.0);
    return faded * clamp((nearness - ALIKE_BAND) / (1.0 - ALIKE_BAND), 0.0, 1.0);
}

// How much of a façade's openings shows: 0 where level 2 takes over, plain as level 1, to 1.
fn opening_share(facade: Facade, distance: f32, tag: u32) -> f32 {
    return unveiled(fades(tag).y, nearness(facade, distance).x);
}

// How much of level 3 shows: it comes with the openings.
fn weathering_share(facade: Facade, distance: f32, tag: u32) -> f32 {
    return nearness(facade, distance).y * unveiled(fades(tag).y, 1.0);
}

// How much of its picture a painted façade shows: it comes as it arrives.
fn picture_share(facade: Facade, distance: f32, tag: u32) -> f32 {
    return nearness(facade, distance).y * fades(tag).z;
}

// How far the relief of a façade has risen: 0 where level 4 takes over, flat as what was there before, to 1.
fn relief_scale(facade: Facade, distance: f32, tag: u32) -> f32 {
    return unveiled(fades(tag).w, nearness(facade, distance).z);
}

// Where a vertex lies whose relief has risen so far, in its mesh. A relief is the normal of its wall (x, z), and how far before it the vertex lies.
fn risen(position: vec3<f32>, relief: vec3<f32>, scale: f32) -> vec3<f32> {
    return position - vec3<f32>(relief.x, 0.0, relief.y) * relief.z * (1.0 - scale);
}

// Its normal: the wall's as long as it is flat. What belongs to no wall keeps its own.
fn risen_normal(normal: vec3<f32>, relief: vec3<f32>, scale: f32) -> vec3<f32> {
    let wall = vec3<f32>(relief.x, 0.0, relief.y);
    if dot(wall, wall) == 0.0 { return normal; }
    return normalize(mix(wall, normal, scale));
}

// Reach of each level at a distance: level n keeps a pixel where reach(n + 1) <= threshold < reach(n). Walls of the next level look alike when
// they come, and do so at once; trees, whose cards and bodies differ, take all of the fade and of the band.
fn reaches(facade: Facade, distance: f32, fade: vec4<f32>) -> vec4<f32> {
    let close = nearness(facade, distance);
    let is_wall = facade.far_kind.w == 0.0;
    // Fittings are there from the first.
    let come = select(fade, vec4<f32>(1.0), facade.far_kind.w == 3.0);
    let faded = select(come, min(fade / ALIKE_FADE, vec4<f32>(1.0)), is_wall);
    let crossed = select(close, min(close / ALIKE_BAND, vec3<f32>(1.0)), is_wall);
    let four = faded.w * crossed.z;
    let two = max(four, faded.y * crossed.x);
    // Level 3 is shading on the others' meshes.
    return vec4<f32>(max(two, fade.x), two, four, four);
}

// Whether this material's level keeps a pixel of a façade at a distance from the eye. What has no levels keeps all.
fn keeps(facade: Facade, pixel: vec2<f32>, distance: f32, tag: u32) -> bool {
    let level = i32(facade.near_level.w);
    if level == 0 { return true; }
    let reach = reaches(facade, distance, fades(tag));
    let threshold = bayer(vec2<u32>(pixel));
    var finer = 0.0;
    if level < 4 && facade.far_kind.w < 2.0 { finer = reach[level]; }
    return threshold < reach[level - 1] && threshold >= finer;
}
