// What the viewport shows: skinned meshes, loose triangles, the ground without an end, the sky. Metres, relative to the
// frame's origin; linear light.

struct Scene {
    clip_from_world: mat4x4f,
    light_from_world: mat4x4f,
    eye: vec4f,          // w: m, from how far on the ground fades
    key: vec4f,          // towards the lamp; w: m, a texel of the shadow
    right: vec4f,        // across half the picture; w: how dark a shadow is
    up: vec4f,
    ahead: vec4f,        // w: m, the height of the flat ground
    sky_low: vec4f,
    sky_high: vec4f,
    tile_light: vec4f,
    tile_dark: vec4f,
    shadow_tint: vec4f,
    ambient_low: vec4f,
    ambient_high: vec4f,
    lamp: vec4f,
    reach: vec4f,        // (x, z) from and to where shadows fall on the flat ground
    foot: vec4f,         // where the character stands; w: 1 where ground that hides it is cut away
    shadow: vec4f,       // a metre in the shadow's map, and in its depth
}

// Shadows that are soft where what throws them is far.
override soft: bool = true;

struct Draw {
    color: vec4f,
    tint: vec4f,         // w: how much of it
    first: vec4u,        // its first matrix
}

const MATRICES_A_ROW = 128u;
const TILE = 0.25;

@group(0) @binding(0) var<uniform> scene: Scene;
@group(0) @binding(1) var matrices: texture_2d<f32>;
@group(0) @binding(2) var<uniform> draw: Draw;
@group(1) @binding(0) var skin: texture_2d<f32>;
@group(1) @binding(1) var skin_sampler: sampler;
@group(2) @binding(0) var shadow_map: texture_depth_2d;
@group(2) @binding(1) var shadow_sampler: sampler_comparison;

struct Varied {
    @invariant @builtin(position) clip: vec4f,
    @location(0) place: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) own: vec3f,     // in the mesh's own axes
    @location(4) color: vec4f,
}

struct Posed {
    place: vec3f,
    normal: vec3f,
}

fn posed(at: vec3f, normal: vec3f, joints: vec4u, weights: vec4f) -> Posed {
    var sum = mat3x4f();
    for (var corner = 0u; corner < 4u; corner++) {
        if weights[corner] > 0.0 {
            let index = draw.first.x + joints[corner];
            let texel = vec2u((index % MATRICES_A_ROW) * 3u, index / MATRICES_A_ROW);
            let rows = mat3x4f(
                textureLoad(matrices, texel, 0),
                textureLoad(matrices, texel + vec2u(1u, 0u), 0),
                textureLoad(matrices, texel + vec2u(2u, 0u), 0),
            );
            sum += rows * weights[corner];
        }
    }
    sum *= 1.0 / max(dot(weights, vec4f(1.0)), 1e-6);
    return Posed(vec4f(at, 1.0) * sum, vec4f(normal, 0.0) * sum);
}

@vertex
fn skinned(
    @location(0) at: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) joints: vec4u,
    @location(4) weights: vec4f,
) -> Varied {
    let posed = posed(at, normal, joints, weights);
    return Varied(scene.clip_from_world * vec4f(posed.place, 1.0), posed.place, posed.normal, uv, at, draw.color);
}

@vertex
fn skinned_shadow(
    @location(0) at: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) joints: vec4u,
    @location(4) weights: vec4f,
) -> @builtin(position) vec4f {
    return scene.light_from_world * vec4f(posed(at, normal, joints, weights).place, 1.0);
}

@vertex
fn loose(@location(0) at: vec3f, @location(1) normal: vec3f, @location(2) color: vec4f) -> Varied {
    return Varied(scene.clip_from_world * vec4f(at, 1.0), at, normal, vec2f(), at, color);
}

@vertex
fn loose_shadow(@location(0) at: vec3f) -> @builtin(position) vec4f {
    return scene.light_from_world * vec4f(at, 1.0);
}

// 0..1, how much of a disc in the shadow's map is nearer to the lamp than `depth`.
fn covered(uv: vec2f, depth: f32, radius: f32, taps: u32) -> f32 {
    var lit = 0.0;
    for (var tap = 0u; tap < taps; tap++) {
        let turn = f32(tap) * 2.39996;
        let out = radius * sqrt((f32(tap) + 0.5) / f32(taps));
        let at = uv + out * vec2f(cos(turn), sin(turn));
        lit += textureSampleCompareLevel(shadow_map, shadow_sampler, at, depth);
    }
    return 1.0 - lit / f32(taps);
}

// The same with one look where shadows are not soft: for surfaces, whose own shading hides the steps.
fn shaded_body(place: vec3f, normal: vec3f) -> f32 {
    if soft {
        return shaded(place, normal);
    }
    let clip = scene.light_from_world * vec4f(place + normal * scene.key.w * 2.0, 1.0);
    let uv = clip.xy * vec2f(0.5, -0.5) + 0.5;
    return 1.0 - textureSampleCompareLevel(shadow_map, shadow_sampler, uv, min(clip.z, 1.0) - 0.004 * scene.shadow.y);
}

// 0..1, how much of the lamp is hidden from a place. What throws the shadow is taken in three slices by its distance, each
// blurred by a width of its own, so that a foot on the ground is sharp and the head is not.
fn shaded(place: vec3f, normal: vec3f) -> f32 {
    let facing = clamp(dot(normal, scene.key.xyz), 0.0, 1.0);
    let off = place + normal * scene.key.w * (1.0 + 2.0 * (1.0 - facing));
    let clip = scene.light_from_world * vec4f(off, 1.0);
    let uv = clip.xy * vec2f(0.5, -0.5) + 0.5;
    let inside = all(abs(clip.xyz - vec3f(0.0, 0.0, 0.5)) < vec3f(1.0, 1.0, 0.5));
    if !inside {
        return 0.0;
    }
    let metre = scene.shadow.x;
    let depth = clip.z - 0.003 * scene.shadow.y;
    let edge = 1.0 - smoothstep(0.85, 1.0, max(abs(clip.x), abs(clip.y)));
    if !soft {
        let texel = 0.9 / f32(textureDimensions(shadow_map).x);
        var lit = textureSampleCompareLevel(shadow_map, shadow_sampler, uv + texel * vec2f(-1.0, -0.4), depth);
        lit += textureSampleCompareLevel(shadow_map, shadow_sampler, uv + texel * vec2f(0.4, -1.0), depth);
        lit += textureSampleCompareLevel(shadow_map, shadow_sampler, uv + texel * vec2f(1.0, 0.4), depth);
        lit += textureSampleCompareLevel(shadow_map, shadow_sampler, uv + texel * vec2f(-0.4, 1.0), depth);
        return (1.0 - lit * 0.25) * edge;
    }
    let middle = depth - 0.22 * scene.shadow.y;
    let far = depth - 0.75 * scene.shadow.y;
    let near_dark = covered(uv, depth, 0.006 * metre, 6u) - covered(uv, middle, 0.006 * metre, 6u);
    let middle_dark = covered(uv, middle, 0.018 * metre, 10u) - covered(uv, far, 0.018 * metre, 10u);
    let far_dark = covered(uv, far, 0.038 * metre, 24u);
    return clamp(near_dark + 0.94 * middle_dark + 0.86 * far_dark, 0.0, 1.0) * edge;
}

// 0..1, how much ground there hides the character from the eye.
fn hides(place: vec3f) -> f32 {
    let sight = scene.eye.xyz - scene.foot.xyz;
    let off = place - scene.foot.xyz;
    let level = max(length(sight.xz), 1e-3);
    let near = dot(off.xz, sight.xz / level) - 0.45;
    if scene.foot.w == 0.0 || near <= 0.0 {
        return 0.0;
    }
    // What is beside the way from the eye to the legs hides nothing.
    let along = dot(off.xz, sight.xz / level);
    let aside = length(off.xz - along * sight.xz / level) / max(1.0 - along / level, 0.02);
    let beside = smoothstep(0.45, 0.75, aside);
    return smoothstep(0.0, 0.12, off.y - 0.02 - near * sight.y / level) * (1.0 - beside);
}

// 0..1 by the place of a pixel among sixteen, so that what is left out of a surface is spread evenly.
fn dither(pixel: vec2f) -> f32 {
    let at = vec2u(pixel) & vec2u(3u);
    let mixed = at.x ^ at.y;
    let index = ((mixed & 1u) << 3u) | ((at.y & 1u) << 2u) | (mixed & 2u) | ((at.y & 2u) >> 1u);
    return (f32(index) + 0.5) / 16.0;
}

// Hemisphere, key light, a little sheen and rim: as the contact sheets have it, with a lamp of its own place.
fn lit(albedo: vec3f, normal: vec3f, toward: vec3f, dark: f32) -> vec3f {
    let key = scene.key.xyz;
    let ambient = mix(scene.ambient_low.rgb, scene.ambient_high.rgb, 0.5 + 0.5 * normal.y);
    let diffuse = max((dot(normal, key) + 0.18) / 1.18, 0.0) * (1.0 - 0.85 * dark);
    let head = max(dot(normal, toward), 0.0) * 0.16;
    let mirrored = max(dot(normal, normalize(key + toward)), 0.0);
    let third = mirrored * mirrored * mirrored;
    let sixth = third * third;
    let shine = sixth * sixth * sixth * sixth * 0.07 * (1.0 - dark);
    let away = 1.0 - max(dot(normal, toward), 0.0);
    let rim = away * away * away * away * 0.05;
    return albedo * (ambient + scene.lamp.rgb * diffuse + head) + shine + rim;
}

fn checker(at: f32, width: f32) -> f32 {
    let wide = max(width, 1e-4);
    let phases = fract(vec2f(at + wide * 0.5, at - wide * 0.5) / (2.0 * TILE));
    let integral = TILE * (1.0 - abs(2.0 * phases - 1.0));
    return clamp((integral.x - integral.y) / wide, -1.0, 1.0);
}

fn line(at: f32, width: f32) -> f32 {
    let thick = 0.016;
    let wide = max(width, 1e-4);
    let off = abs(at - round(at));
    let low = max(off - wide * 0.5, -thick * 0.5);
    let high = min(off + wide * 0.5, thick * 0.5);
    return clamp((high - low) / wide, 0.0, 1.0);
}

fn squares(at: vec2f, covers: vec2f) -> vec3f {
    let square = checker(at.x, covers.x) * checker(at.y, covers.y);
    let color = mix(scene.tile_dark.rgb, scene.tile_light.rgb, 0.5 + 0.5 * square);
    return color * (1.0 - 0.20 * max(line(at.x, covers.x), line(at.y, covers.y)));
}

// One entry for each kind of surface: a processor that plays a graphics card runs both sides of every question.
fn facing(normal: vec3f, front: bool) -> vec3f {
    return normalize(normal) * select(-1.0, 1.0, front);
}

@fragment
fn surface(in: Varied, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let toward = normalize(scene.eye.xyz - in.place);
    let normal = facing(in.normal, front);
    return vec4f(lit(in.color.rgb, normal, toward, shaded_body(in.place, normal)), 1.0);
}

fn textured(in: Varied, front: bool, texel: vec3f) -> vec4f {
    let toward = normalize(scene.eye.xyz - in.place);
    let normal = facing(in.normal, front);
    return vec4f(lit(in.color.rgb * texel, normal, toward, shaded_body(in.place, normal)), 1.0);
}

@fragment
fn surface_textured(in: Varied, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    return textured(in, front, textureSample(skin, skin_sampler, in.uv).rgb);
}

// A picture with holes. What may be discarded has its depth known late: the others go without.
@fragment
fn surface_holed(in: Varied, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let texel = textureSample(skin, skin_sampler, in.uv);
    if texel.a < 0.4 {
        discard;
    }
    return textured(in, front, texel.rgb);
}

@fragment
fn surface_ghost(in: Varied, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let texel = textureSample(skin, skin_sampler, in.uv);
    if texel.a < 0.4 {
        discard;
    }
    let toward = normalize(scene.eye.xyz - in.place);
    let normal = facing(in.normal, front);
    let edge = 1.0 - abs(dot(normal, toward));
    let color = lit(mix(in.color.rgb * texel.rgb, draw.tint.rgb, draw.tint.w), normal, toward, 0.0);
    return vec4f(color, 0.32 + 0.45 * edge * edge);
}

@fragment
fn surface_ground(in: Varied, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let tile = squares(in.own.xz, fwidth(in.own.xz));
    if !front || dither(in.clip.xy) < 0.86 * hides(in.place) {
        discard;
    }
    let toward = normalize(scene.eye.xyz - in.place);
    let normal = normalize(in.normal);
    let upright = clamp((normal.y - 0.2) * 10.0, 0.0, 1.0);
    let above = vec3f(0.0, 1.0, 0.0);
    let level = lit(vec3f(1.0), above, above, 0.0);
    let color = mix(scene.tile_dark.rgb * 0.8, tile, upright) * lit(vec3f(1.0), normal, toward, 0.0) / level;
    return vec4f(mix(color, scene.shadow_tint.rgb, shaded(in.place, normal) * scene.right.w), 1.0);
}

// Triangles that do not say which side is out.
@fragment
fn surface_loose(in: Varied) -> @location(0) vec4f {
    let toward = normalize(scene.eye.xyz - in.place);
    let normal = normalize(in.normal);
    let outward = normal * select(-1.0, 1.0, dot(normal, toward) > 0.0);
    return vec4f(lit(in.color.rgb, outward, toward, shaded_body(in.place, outward)), in.color.a);
}

@fragment
fn flat_color(in: Varied) -> @location(0) vec4f {
    return in.color;
}

// Six corners where shadows fall, then a ring around them of four sides.
@vertex
fn ground(@builtin(vertex_index) index: u32) -> Varied {
    let quad = array(vec2u(0u, 0u), vec2u(1u, 0u), vec2u(2u, 0u), vec2u(0u, 0u), vec2u(2u, 0u), vec2u(3u, 0u));
    let ring = array(vec2u(0u, 0u), vec2u(1u, 0u), vec2u(1u, 1u), vec2u(0u, 0u), vec2u(1u, 1u), vec2u(0u, 1u));
    var corner = quad[index % 6u];
    if index >= 6u {
        corner = ring[index % 6u];
        corner.x += index / 6u - 1u;
    }
    let high = vec2f(f32(((corner.x + 1u) >> 1u) & 1u), f32((corner.x >> 1u) & 1u));
    let reach = mix(scene.reach.xy, scene.reach.zw, high);
    let at = select(reach, scene.eye.xz + (high * 2.0 - 1.0) * 600.0, corner.y == 1u);
    let place = vec3f(at.x, scene.ahead.w, at.y);
    return Varied(scene.clip_from_world * vec4f(place, 1.0), place, vec3f(0.0, 1.0, 0.0), vec2f(), place, vec4f(1.0));
}

fn hazed(color: vec3f, place: vec3f) -> vec4f {
    let away = distance(place, scene.eye.xyz);
    let fade = 1.0 - exp(-max(away - scene.eye.w, 0.0) / (2.0 * scene.eye.w + 4.0));
    return vec4f(mix(color, scene.sky_low.rgb, fade), 1.0);
}

@fragment
fn ground_color(in: Varied) -> @location(0) vec4f {
    let color = squares(in.place.xz, fwidth(in.place.xz));
    let dark = shaded(in.place, vec3f(0.0, 1.0, 0.0));
    return hazed(mix(color, scene.shadow_tint.rgb, dark * scene.right.w), in.place);
}

// Where no shadow falls.
@fragment
fn ground_bare(in: Varied) -> @location(0) vec4f {
    return hazed(squares(in.place.xz, fwidth(in.place.xz)), in.place);
}

struct Sky {
    @builtin(position) clip: vec4f,
    @location(0) ray: vec3f,
}

@vertex
fn sky(@builtin(vertex_index) index: u32) -> Sky {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u)) * 2.0 - 1.0;
    let ray = scene.ahead.xyz + scene.right.xyz * corner.x + scene.up.xyz * corner.y;
    return Sky(vec4f(corner, 1.0, 1.0), ray);
}

@fragment
fn sky_color(in: Sky) -> @location(0) vec4f {
    let height = clamp(normalize(in.ray).y / 0.45, 0.0, 1.0);
    return vec4f(mix(scene.sky_low.rgb, scene.sky_high.rgb, height), 1.0);
}
