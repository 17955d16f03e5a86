// Shadow of smoke in a host's shader: the bindings of Renderer::scene_shadow_bind_group(), and the function that reads them. The group
// is a host's choice: scene_shadow_wgsl() replaces its number.

#import "lib/ramp.wgsl"
#import "lib/scene_shadow.wgsl"

const HAZE_SHADOWED_LIGHTS: u32 = 15u;

struct SceneShadow {
    // Corner of the density grid, world space.
    origin: vec3f,
    cells_per_metre: f32,
    // Extent of the smoke along each axis, in cells.
    extent: vec3f,
    // Mix of full light and shadow. 0: no smoke casts shadow.
    strength: f32,
    // The lights with shadow, in cells: position, and 0 in w; or the direction to the light, and 1 in w.
    lights: array<vec4f, HAZE_SHADOWED_LIGHTS>,
    // Their indices in FrameInput::lights; 4294967295 for none.
    indices: array<vec4u, 4>,
}

@group(3) @binding(0) var<uniform> haze_scene_shadow: SceneShadow;
@group(3) @binding(1) var haze_optical_depths: texture_3d<f32>;
@group(3) @binding(2) var haze_shadow_ramp: texture_2d<f32>;
@group(3) @binding(3) var haze_linear_sampler: sampler;

// Fraction of a light that reaches a point through the smoke, linear RGB: multiply the light's diffuse and specular parts.
// `light`: index in FrameInput::lights. 1 for lights without shadow, and where there is no smoke in front of the light.
fn haze_transmittance(world_position: vec3f, light: u32) -> vec3f {
    var slot = 0u;
    while slot < HAZE_SHADOWED_LIGHTS && haze_scene_shadow.indices[slot / 4u][slot % 4u] != light {
        slot++;
    }
    if slot == HAZE_SHADOWED_LIGHTS || haze_scene_shadow.strength <= 0.0 {
        return vec3f(1.0);
    }
    let extent = haze_scene_shadow.extent;
    let position = (world_position - haze_scene_shadow.origin) * haze_scene_shadow.cells_per_metre;
    let entry = grid_entry(haze_scene_shadow.lights[slot], position, extent);
    if entry.w < 0.5 {
        return vec3f(1.0);
    }
    // Three lights in each block of the volume, behind each other along z.
    let texels = vec3f(textureDimensions(haze_optical_depths));
    let position_in_block = clamp(entry.xyz, vec3f(0.5), extent);
    let at = (position_in_block + vec3f(0.0, 0.0, f32(slot / 3u) * texels.x)) / texels;
    let optical_depth = textureSampleLevel(haze_optical_depths, haze_linear_sampler, at, 0.0)[slot % 3u];
    let coordinate = vec2f(saturate(1.0 - exp2(-optical_depth)), 1.0);
    let painted = sample_ramp_2d(haze_shadow_ramp, haze_linear_sampler, coordinate);
    return mix(vec3f(1.0), transmitted_light(optical_depth, painted), haze_scene_shadow.strength);
}
