// demo scene
// What    Draws a scene: paint (reflectance and surface, 2x2 samples per pixel), depth, then light. Composed after this file:
//         scene_samples.wgsl and scene_light.wgsl, then scene_boxes.wgsl or scene_mesh.wgsl, the surfaces.
//         With shadow of smoke, the light of each light with shadow is kept apart, and a last pass adds what comes through
//         the smoke: only this pass is drawn while only the smoke moves. Objects in front at outlines are lit apart.
// Reads   scene and lights (uniforms), the panorama; the passes after paint also read paint and depth at 2x2 samples per
//         pixel.
// Writes  paint, depth buffer and linear view depth, scene color (linear HDR).
// Blend   none.
// Space   world space, metres, y up. shading.rs implements the same functions on the CPU.

#import "lib/lighting.wgsl"
#import "lib/depth.wgsl"

struct Scene {
    clip_from_world: mat4x4f,
    eye: vec3f,
    box_count: u32,
    zenith: vec3f,
    light_count: u32,
    horizon: vec3f,
    // Factor on the panorama; 0: there is none.
    sky_strength: f32,
    ground: vec3f,
    // Metres per unit of a mesh.
    mesh_scale: f32,
    // Vectors at view depth 1: camera_rays.rs.
    ray_forward: vec3f,
    // Height of a pixel at view depth 1.
    pixel_size: f32,
    ray_right: vec3f,
    // Rotation of the panorama.
    sky_cosine: f32,
    ray_up: vec3f,
    sky_sine: f32,
    // Of the host's depth buffer, as in lib/depth.wgsl.
    depth_coefficients: vec4f,
    // Indices of the lights whose light is kept apart; 4294967295 for none.
    apart: vec4u,
    // Ambient light by the normal: sky_light.rs of haze_author.
    ambient: array<vec4f, 9>,
}

@group(0) @binding(0) var<uniform> scene: Scene;
@group(0) @binding(2) var<uniform> lights: array<Light, 128>;
@group(0) @binding(4) var sky_image: texture_2d<f32>;
@group(0) @binding(5) var sky_sampler: sampler;

const PI: f32 = 3.14159265;
const SUN_DISTANCE: f32 = 60.0;
const LIGHT_GAP: f32 = 0.02;

// Turns a direction of the world into one of the panorama.
fn to_sky(v: vec3f) -> vec3f {
    return vec3f(v.x * scene.sky_cosine + v.z * scene.sky_sine, v.y, v.z * scene.sky_cosine - v.x * scene.sky_sine);
}

// Place of a direction in the panorama, 0 to 1 from its upper left corner.
fn sky_uv(d: vec3f) -> vec2f {
    return vec2f(atan2(d.x, -d.z) / (2.0 * PI) + 0.5, acos(clamp(d.y, -1.0, 1.0)) / PI);
}

fn sky(direction: vec3f) -> vec3f {
    if scene.sky_strength > 0.0 {
        let uv = sky_uv(to_sky(direction));
        return textureSampleLevel(sky_image, sky_sampler, uv, 0.0).rgb * scene.sky_strength;
    }
    let up = saturate(direction.y);
    return mix(scene.horizon, scene.zenith, 1.0 - pow(1.0 - up, 3.0));
}

// Ambient light that a white matte surface shows.
fn ambient_light(normal: vec3f) -> vec3f {
    let n = to_sky(normal);
    var sum = scene.ambient[0].rgb + scene.ambient[1].rgb * n.y + scene.ambient[2].rgb * n.z + scene.ambient[3].rgb * n.x;
    sum += scene.ambient[4].rgb * (n.x * n.y) + scene.ambient[5].rgb * (n.y * n.z);
    sum += scene.ambient[6].rgb * (3.0 * n.y * n.y - 1.0) + scene.ambient[7].rgb * (n.x * n.z);
    sum += scene.ambient[8].rgb * (n.z * n.z - n.x * n.x);
    return max(sum, vec3f(0.0));
}

// Light, with that of up to three lights apart.
struct Lit {
    rest: vec3f,
    apart: array<vec3f, 3>,
}

fn lit_by(light: vec3f) -> Lit {
    return Lit(light, array<vec3f, 3>());
}

fn total(lit: Lit) -> vec3f {
    return lit.rest + lit.apart[0] + lit.apart[1] + lit.apart[2];
}

// Adds the light of the light with this index.
fn add_light(lit: Lit, index: u32, light: vec3f) -> Lit {
    let is_apart = scene.apart == vec4u(index);
    var sum = lit;
    sum.rest += select(light, vec3f(0.0), any(is_apart));
    sum.apart[0] += select(vec3f(0.0), light, is_apart.x);
    sum.apart[1] += select(vec3f(0.0), light, is_apart.y);
    sum.apart[2] += select(vec3f(0.0), light, is_apart.z);
    return sum;
}

// Corner of a triangle that covers the image.
fn fullscreen_corner(index: u32) -> vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@vertex
fn fullscreen_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return fullscreen_corner(index);
}

// Returns the vector from the eye to view depth 1. `uv` is 0..1, from the image's upper left corner.
fn ray_at_unit_depth(uv: vec2f) -> vec3f {
    return scene.ray_forward + scene.ray_right * (uv.x * 2.0 - 1.0) + scene.ray_up * (1.0 - uv.y * 2.0);
}
