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

// Depth of a texel of a map. Texels outside are those of its border.
fn load_map(light: u32, texel: vec2i, layer: u32) -> f32 {
    switch light {
        case 0u: { return textureLoad(map_0, inside_map(texel, textureDimensions(map_0)), layer, 0).r; }
        case 1u: { return textureLoad(map_1, inside_map(texel, textureDimensions(map_1)), layer, 0).r; }
        default: { return textureLoad(map_2, inside_map(texel, textureDimensions(map_2)), layer, 0).r; }
    }
}

fn inside_map(texel: vec2i, size: vec2u) -> vec2i {
    return clamp(texel, vec2i(0), vec2i(size) - 1);
}

fn map_size(light: u32) -> vec2u {
    switch light {
        case 0u: { return textureDimensions(map_0); }
        case 1u: { return textureDimensions(map_1); }
        default: { return textureDimensions(map_2); }
    }
}

// Fraction of a light that reaches a point past the scene, between the four nearest texels. Points outside of all layers are
// lit.
fn map_visibility(light: u32, position: vec3f) -> f32 {
    for (var layer = 0u; layer < min(visibility.maps[light].layers, MAX_SHADOW_LAYERS); layer++) {
        let at = shadow_map_position(visibility.maps[light].clip_from_grid[layer] * vec4f(position, 1.0));
        if at.w > 0.5 {
            let map = &visibility.maps[light];
            let corner = at.xy * vec2f(map_size(light)) - 0.5;
            let base = vec2i(floor(corner));
            var lit: vec4f;
            for (var i = 0; i < 4; i++) {
                let stored = load_map(light, base + vec2i(i & 1, i >> 1u), layer);
                lit[i] = shadow_map_visibility(at.z, stored, (*map).bias, (*map).reversed == 1u);
            }
            let fraction = fract(corner);
            let rows = mix(lit.xz, lit.yw, fraction.x);
            return mix(rows.x, rows.y, fraction.y);
        }
    }
    return 1.0;
}

// Fraction of each light that reaches an octant of a cell. `octant`: 2 per cell along each axis.
fn octant_visibility(octant: vec3u) -> vec3f {
    let position = vec3f(octant) * 0.5 + 0.25;
    return vec3f(map_visibility(0u, position), map_visibility(1u, position), map_visibility(2u, position));
}
