// Tiles, level switching per façade, weathering, glass and relief by normals, on top of Bevy's standard material.
#import bevy_pbr::{
    pbr_fragment::pbr_input_from_standard_material,
    pbr_functions::{apply_pbr_lighting, main_pass_post_lighting_processing},
    pbr_types::{STANDARD_MATERIAL_FLAGS_FOG_ENABLED_BIT, pbr_input_new},
    forward_io::{VertexOutput, FragmentOutput},
    mesh_functions,
    mesh_view_bindings::{globals, lights, view},
}

#import veduta_facade::levels::{Facade, bayer, is_drawn, is_turned_to, keeps, opening_share, picture_share, weathering_share}
#import veduta_facade::surface::{ground_wear, hash, noise, plain_wear, puddle, roof_cover, slab_row, unpacked, wall_paint}
#import veduta_facade::glass::{fresnel, mirrored, room}

@group(#{MATERIAL_BIND_GROUP}) @binding(100) var<uniform> facade: Facade;
@group(#{MATERIAL_BIND_GROUP}) @binding(101) var colour_tiles: texture_2d_array<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(102) var tile_sampler: sampler;
@group(#{MATERIAL_BIND_GROUP}) @binding(103) var normal_tiles: texture_2d_array<f32>;

// Layers that are more than paint: bays of windows and doors, ground with its water, stone, foliage, lanterns.
const FIRST_BAY: i32 = 1;
const LAST_WINDOW: i32 = 8;
const LAST_BAY: i32 = 16;
const SHOP: i32 = 12;
const FIRST_GROUND: i32 = 20;
const LAST_GROUND: i32 = 28;
const SETTS: i32 = 21;
const FLAGSTONES: i32 = 23;
const WATER: i32 = 27;
const STONE: i32 = 29;
const LEAVES: i32 = 31;
const CARVED: i32 = 32;
const LANTERN: i32 = 34;
const FIRST_TRADE: i32 = 47;

// Slabs among setts are of greyer stone than those of pavements.
const SLAB_TINT: vec3<f32> = vec3<f32>(0.96, 1.02, 1.12);

// Luminance of a lit lantern and of a room by its lamp, candela per square metre.
const LANTERN_GLOW: f32 = 1800.0;
const ROOM_GLOW: f32 = 420.0;
// Share of rooms whose lamps burn at night.
const LIT_WINDOWS: f32 = 0.34;
// What all lamps of the city together, near and far, send onto streets and the feet of houses, lux.
const STREET_GLOW: f32 = 60.0;
// What floodlights send onto stone, lux.
const FLOODLIGHT: f32 = 110.0;

#ifdef PAINTED
// As meshes tell panes: from where on texture coordinates do, how far apart those of one and the next are, and how dark glass is.
const PANE: f32 = 4.0;
const PANES_APART: f32 = 2.0;
const DARK_GLASS: f32 = 0.12;
#endif

#ifdef CARDS
const IS_CUT: bool = true;
#else
const IS_CUT: bool = false;
#endif

@fragment
fn fragment(in: VertexOutput, @builtin(front_facing) is_front: bool) -> FragmentOutput {
    let level = i32(facade.near_level.w);
    let layer = i32(in.color.a + 0.5);
    // All that looks at neighbouring pixels comes before any of them is dropped.
    let across = dpdx(in.world_position.xyz);
    let down = dpdy(in.world_position.xyz);
    let uv_across = dpdx(in.uv);
    let uv_down = dpdy(in.uv);
#ifdef PAINTED
    let is_water = false;
    let section = floor(in.uv.x);
    let is_pane = in.uv.y > PANE - 1.0;
    let pane_number = select(0.0, floor((in.uv.y - PANE + 0.5) / PANES_APART), is_pane);
    let place = vec2<f32>(in.uv.x - section, in.uv.y - select(0.0, PANE + pane_number * PANES_APART, is_pane));
    let picture = layer + i32(section);
    let fine = textureSampleGrad(colour_tiles, tile_sampler, place, picture, uv_across, uv_down);
    let coarse = textureSampleGrad(normal_tiles, tile_sampler, place, picture, uv_across, uv_down);
    let drift = vec2<f32>(0.0);
#else
    let is_water = layer == WATER;
    let drift = select(vec2<f32>(0.0), vec2<f32>(0.021, 0.013) * globals.time, is_water);
    var tile = textureSample(colour_tiles, tile_sampler, in.uv + drift, layer);
    var relief = unpacked(textureSample(normal_tiles, tile_sampler, in.uv + drift, layer), IS_CUT);
#ifdef COMPOSED
    if layer == SETTS {
        // Rows of flagstones part setts into fields: along the middle of a street, and across it.
        let row = slab_row(in.uv, uv_across, uv_down);
        if row.share > 0.0 {
            let slab = textureSampleGrad(colour_tiles, tile_sampler, row.uv, FLAGSTONES, row.uv_across, row.uv_down);
            let slab_relief = textureSampleGrad(normal_tiles, tile_sampler, row.uv, FLAGSTONES, row.uv_across, row.uv_down);
            let worked = unpacked(slab_relief, false);
            tile = mix(tile, vec4<f32>(slab.rgb * SLAB_TINT, slab.a), row.share);
            relief = mix(relief, select(worked, vec4<f32>(worked.yxzw), row.is_across), row.share);
        }
    }
#endif
#endif
    let model = mesh_functions::get_world_from_local(in.instance_index);
    let centre = (model * vec4<f32>(in.uv_b.x, 0.0, in.uv_b.y, 1.0)).xz;
    let away = distance(centre, view.world_position.xz);
    let tag = mesh_functions::get_tag(in.instance_index);
#ifdef SHARED
    if !keeps(facade, in.position.xy, away, tag) { discard; }
#endif
#ifdef CARDS
    if !is_drawn(relief.a, in.position.xy) { discard; }
    let back = view.world_from_view[2].xyz;
    let from_tree = view.world_position - vec3<f32>(centre.x, in.world_position.y, centre.y);
    let tree_to_eye = normalize(select(from_tree, back, view.clip_from_view[3].w == 1.0));
    if !is_turned_to(cross(across, down), tree_to_eye, bayer(vec2<u32>(in.position.xy))) { discard; }
#endif

#ifdef PAINTED
    let tile = vec4<f32>(mix(coarse.rgb, fine.rgb, picture_share(facade, away, tag)), 0.0);
    // At night lamps shine through curtains, too.
    let is_glazed = is_pane && tile.b > 0.6 * tile.r;
    let is_dark = is_glazed && dot(tile.rgb, vec3<f32>(0.3333)) < mix(DARK_GLASS, 0.4, facade.horizon_night.w);
    let relief = vec4<f32>(0.0, 0.0, 1.0, select(0.85, 0.1, is_dark));
#endif

    // What the layer is off a whole number tells the floor's height, in 1,024 m.
    let height = in.world_position.y - (in.color.a - f32(layer)) * 1024.0;
    let wet = facade.zenith_wet.w;
    let night = facade.horizon_night.w;
    let at = in.world_position.xyz;
    let to_eye = normalize(view.world_position - at);
    // Level 3 is composed here: how much of it is seen at this distance. What has no levels has it near the eye. Where it is forbidden nothing
    // of it is there to be paid for: a processor that draws does both sides of every choice.
#ifdef COMPOSED
    let of_level = select(0.0, weathering_share(facade, away, tag), level > 1);
    let near = select(of_level, 1.0 - smoothstep(15.0, 60.0, distance(at, view.world_position)), level == 0);
#endif

    let n = normalize(in.world_normal);
    let is_level = abs(n.y) > 0.9;
#ifdef PAINTED
    let is_ground = false;
    let is_plant = false;
    let is_bay = true;
#else
    let is_ground = is_level && layer >= FIRST_GROUND && layer <= LAST_GROUND;
    let is_bay = (layer >= FIRST_BAY && layer <= LAST_BAY || layer >= FIRST_TRADE) && level > 1;
    let is_plant = facade.far_kind.w == 1.0 || facade.far_kind.w == 2.0 || layer == LEAVES;
#endif
    var tangent = vec3<f32>(1.0, 0.0, 0.0);
    if !is_level {
        tangent = normalize(cross(vec3<f32>(0.0, 1.0, 0.0), n));
    } else {
        // Paving is laid in any direction: along u as it lies on the screen.
        let turned = (across * uv_down.y - down * uv_across.y) * sign(uv_across.x * uv_down.y - uv_across.y * uv_down.x);
        let along = turned - n * dot(n, turned);
        if dot(along, along) > 1e-20 { tangent = normalize(along); }
    }
    let bitangent = cross(n, tangent);

    // Where alpha is 1 the tile modulates the vertex colour about one half; where it is 0 it stands as it is.
    var albedo = mix(tile.rgb, 2.0 * tile.rgb * in.color.rgb, tile.a);
    var roughness = select(clamp(relief.a, 0.08, 1.0), 0.85, IS_CUT);
    var bump = relief.xyz;
    // Openings come out of a plain wall.
    let opened = select(1.0, opening_share(facade, away, tag), is_bay);
    if opened < 1.0 {
        // By cube roots, which are nearer to what eyes see than light is: dark panes do not come all at the end.
        let third = vec3<f32>(1.0 / 3.0);
        let seen = mix(pow(in.color.rgb, third), pow(albedo, third), opened);
        albedo = seen * seen * seen;
    }
    bump = mix(vec3<f32>(0.0, 0.0, 1.0), bump, opened);
    roughness = mix(0.9, roughness, opened);
    var emissive = vec3<f32>(0.0);
    var mirrors = select(0.0, 1.0, is_water);
    let seed = hash(floor(centre * 4.0 + 0.127));
    if is_water {
#ifdef COMPOSED
        // The swell of water runs another way than its ripples.
        let swell = textureSampleGrad(
            normal_tiles, tile_sampler, in.uv.yx * 0.43 - drift.yx * 0.7, layer, uv_across.yx * 0.43, uv_down.yx * 0.43,
        );
        bump = normalize(vec3<f32>(0.5 * bump.xy + 0.5 * unpacked(swell, false).xy, 1.0));
#endif
        roughness = 0.08;
    }
#ifdef COMPOSED
    else if is_plant {
        albedo *= plain_wear(at, n.y);
    } else if is_ground {
        albedo *= ground_wear(at.xz, near);
    } else if n.y > 0.25 {
        albedo *= roof_cover(at, seed, near);
    } else {
        let paint = wall_paint(dot(at, tangent), height, seed, near);
#ifdef PAINTED
        // Glass is wiped, and frames are painted anew.
        albedo *= mix(vec3<f32>(1.0), paint, mix(1.0, 0.8 * (1.0 - 0.7 * f32(is_pane)), opened));
#else
        albedo *= mix(mix(vec3<f32>(1.0), paint, 0.45), paint, mix(1.0, tile.a, opened));
#endif
    }
#else
    else {
        albedo *= plain_wear(at, n.y);
    }
#endif
    if wet > 0.0 && n.y > 0.25 && !is_water && !is_plant {
        // A film of water darkens and shines; on the ground it stands in hollows, and is level.
#ifdef COMPOSED
        let pool = select(0.0, puddle(at.xz, wet), is_ground);
#else
        let pool = 0.0;
#endif
        albedo *= mix(1.0, 0.5, wet * mix(0.75, 1.0, pool));
        roughness = mix(roughness, mix(0.42, 0.10, pool), wet);
        bump = mix(bump, vec3<f32>(0.0, 0.0, 1.0), pool);
        mirrors = select(0.0, wet * mix(0.12, 0.9, pool), is_ground);
    }
    let bumped = normalize(tangent * bump.x + bitangent * bump.y + n * max(bump.z, 0.2));

    let is_glass = is_bay && tile.a < 0.25 && relief.a < 0.3;
    if is_glass {
        // Centres lie on a grid: a little off it, so that all pixels of a house agree.
#ifdef PAINTED
        let bay = vec2<f32>(pane_number, 0.0) + floor(centre * 3.0 + 0.127);
        let is_shop = false;
#else
        let bay = floor(in.uv) + floor(centre * 3.0 + 0.127);
        let is_shop = layer == SHOP || layer >= FIRST_TRADE;
#endif
        let own = hash(bay);
        let lit = night * select(0.0, 1.0, own < select(LIT_WINDOWS, 0.8, is_shop));
        let lamp = mix(vec3<f32>(1.0, 0.60, 0.26), vec3<f32>(1.0, 0.76, 0.48), fract(own * 17.0));
        var veil = 1.0;
#ifdef COMPOSED
        // Roughness tells cloth from clear glass.
        let cloth = smoothstep(0.13, 0.2, relief.a);
#ifdef PAINTED
        // What lies behind it is painted.
#else
        if near > 0.0 && !is_shop {
            // Bays a metre, by how the texture lies on the wall.
            let per_m = vec2<f32>(
                length(vec2<f32>(uv_across.x, uv_down.x)) / max(length(vec2<f32>(dot(across, tangent), dot(down, tangent))), 1e-6),
                length(vec2<f32>(uv_across.y, uv_down.y)) / max(length(vec2<f32>(across.y, down.y)), 1e-6),
            );
            let look = vec3<f32>(-dot(to_eye, tangent) * per_m.x, to_eye.y * per_m.y, dot(to_eye, n) * per_m.x);
            let behind = room(fract(in.uv), look, own);
            let day = behind.albedo * behind.light * 0.30;
            let clear = near * (1.0 - cloth);
            albedo = mix(albedo, day + 0.12 * albedo, clear * opened);
            emissive += lit * lamp * ROOM_GLOW * (0.35 + 0.65 * behind.light) * behind.albedo * 1.6 * clear;
        }
        veil = mix(1.0 - near, 1.0, max(cloth, select(0.0, 1.0, is_shop)));
#endif
        // Every pane hangs a little askew.
        let pane = floor(vec2<f32>(fract(in.uv.x) * 6.0, fract(in.uv.y) * 7.0)) + bay * 5.0;
        let askew = (vec2<f32>(hash(pane), hash(pane + 3.7)) - 0.5) * 0.05;
        let face = normalize(n + tangent * (askew.x + 0.3 * bump.x) + bitangent * (askew.y + 0.3 * bump.y));
        let toward = reflect(-to_eye, face);
        var share = fresnel(dot(face, to_eye)) * (1.0 - 0.6 * cloth);
#ifdef PAINTED
        // Its mirror is painted, too: what is left comes and goes with how dark it is.
        share *= 0.5 * (1.0 - smoothstep(0.3, 1.0, dot(tile.rgb, vec3<f32>(0.3333)) / DARK_GLASS));
#endif
        emissive += share * mirrored(toward, facade.zenith_wet.xyz, facade.horizon_night);
#endif
        // From afar, and through cloth, a lit window is an even glow.
        emissive += lit * lamp * ROOM_GLOW * mix(0.45, 2.2 * dot(tile.rgb, vec3<f32>(0.33)), 0.5) * veil;
        emissive *= opened;
        roughness = max(roughness, 0.2);
    } else if mirrors > 0.0 {
        let toward = reflect(-to_eye, bumped);
        let share = mirrors * fresnel(dot(bumped, to_eye));
        let upward = vec3<f32>(toward.x, abs(toward.y), toward.z);
#ifdef COMPOSED
        emissive += share * mirrored(upward, facade.zenith_wet.xyz, facade.horizon_night);
#else
        emissive += share * mix(facade.horizon_night.xyz, facade.zenith_wet.xyz, sqrt(upward.y));
#endif
    }
#ifndef PAINTED
    else if is_bay && night > 0.0 && layer <= LAST_WINDOW {
        // From afar panes, bars and wall run together in a pixel, and a lit window is its share of that.
        let run_together = smoothstep(0.03, 0.12, max(length(uv_across), length(uv_down)));
        let own = hash(floor(in.uv) + floor(centre * 3.0 + 0.127));
        let lit = night * select(0.0, 1.0, own < LIT_WINDOWS) * run_together * opened;
        let lamp = mix(vec3<f32>(1.0, 0.60, 0.26), vec3<f32>(1.0, 0.76, 0.48), fract(own * 17.0));
        emissive += lit * lamp * ROOM_GLOW * 0.3 * (1.0 - tile.a);
    } else if layer == LANTERN {
        emissive += night * LANTERN_GLOW * vec3<f32>(1.0, 0.70, 0.36) * albedo;
    }

    if night > 0.0 && !is_level && (layer == STONE || layer == CARVED) {
        // Towers and monuments are lit from below.
        emissive += night * FLOODLIGHT / 3.14159 * exp(-max(height, 0.0) / 45.0) * (1.0 - 0.5 * abs(n.y)) * albedo * vec3<f32>(1.0, 0.78, 0.50);
    }
#endif
    if night > 0.0 && !is_water {
        let glass = select(0.0, opened, is_glass);
        let lamplit = (1.0 - glass) * select(exp(-max(height, 0.0) / 5.0), 0.55, is_ground) * (0.6 + 0.8 * noise(at.xz * 0.045));
        emissive += night * STREET_GLOW / 3.14159 * lamplit * albedo * vec3<f32>(1.0, 0.62, 0.30);
    }

    // Contact shade where walls meet the ground, and less sky the deeper a wall stands in its street.
    let foot = mix(0.45, 1.0, smoothstep(-0.2, 1.4, height)) * mix(0.62, 1.0, smoothstep(0.0, 15.0, height));
    let open_sky = mix(1.0, foot, 1.0 - abs(select(n.y, bumped.y, IS_CUT)));

    var out: FragmentOutput;
#ifdef PLAIN_LIGHT
    let level_fill = facade.fill[1].xyz;
    let fill = mix(level_fill, select(facade.fill[2].xyz, facade.fill[0].xyz, bumped.y > 0.0), bumped.y * bumped.y);
    var radiance = albedo * fill * open_sky + emissive;
    if lights.n_directional_lights > 0u {
        let key = &lights.directional_lights[0];
        radiance += albedo / 3.14159 * (*key).color.rgb * max(dot(bumped, (*key).direction_to_light), 0.0);
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
    pbr_input.material.emissive = vec4<f32>(emissive, 1.0);
    pbr_input.N = bumped;
    pbr_input.diffuse_occlusion *= vec3<f32>(open_sky);
#ifdef COMPOSED
    // What composed glass mirrors has been told.
    if is_glass { pbr_input.specular_occlusion *= 1.0 - opened; }
#endif
    out.color = apply_pbr_lighting(pbr_input);
#endif
    out.color = main_pass_post_lighting_processing(pbr_input, out.color);
    return out;
}
