// Lookups of a host's shadow maps, of a block of lights.

#import "lib/shadow_map.wgsl"

struct ShadowMap {
    clip_from_grid: array<mat4x4f, 6>,
    // Number of layers; 0 for a light without map.
    layers: u32,
    // 1 if the map stores the near plane as 1.
    reversed: u32,
    // Depth by which a surface must be before a point to hide it.
    bias: f32,
    padding: f32,
}

struct ShadowVisibility {
    maps: array<ShadowMap, 3>,
    // Number of cells along each axis.
    size: vec3f,
    // First cell of the block along z.
    first_cell: u32,
}

@group(0) @binding(0) var<uniform> visibility: ShadowVisibility;
@group(0) @binding(1) var map_0: texture_2d_array<f32>;
@group(0) @binding(2) var map_1: texture_2d_array<f32>;
@group(0) @binding(3) var map_2: texture_2d_array<f32>;

// Depth of a map at a position, 0 to 1 from the upper left corner.
fn load_map(light: u32, position: vec2f, layer: u32) -> f32 {
    switch light {
        case 0u: { return textureLoad(map_0, map_texel(position, textureDimensions(map_0)), layer, 0).r; }
        case 1u: { return textureLoad(map_1, map_texel(position, textureDimensions(map_1)), layer, 0).r; }
        default: { return textureLoad(map_2, map_texel(position, textureDimensions(map_2)), layer, 0).r; }
    }
}

fn map_texel(position: vec2f, size: vec2u) -> vec2u {
    return min(vec2u(position * vec2f(size)), size - 1u);
}

// 1 if a light reaches a point past the scene. Points outside of all layers are lit.
fn is_visible(light: u32, place: vec3f) -> f32 {
    for (var layer = 0u; layer < min(visibility.maps[light].layers, MAX_SHADOW_LAYERS); layer++) {
        let at = shadow_map_place(visibility.maps[light].clip_from_grid[layer] * vec4f(place, 1.0));
        if at.w > 0.5 {
            let stored = load_map(light, at.xy, layer);
            let map = &visibility.maps[light];
            return shadow_map_visibility(at.z, stored, (*map).bias, (*map).reversed == 1u);
        }
    }
    return 1.0;
}
