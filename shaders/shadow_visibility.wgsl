// shadow_visibility
// Looks up a host's shadow maps at the cells of the density grid: the share of each cell that a light reaches past the scene.
//
// Reads   shadow maps of the lights of a block.
// Writes  visibility of the lights, in a block of the volume.
// Space   Cells of the grid; clip space of the lights.

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
@group(0) @binding(1) var map_0: texture_depth_2d_array;
@group(0) @binding(2) var map_1: texture_depth_2d_array;
@group(0) @binding(3) var map_2: texture_depth_2d_array;
@group(0) @binding(4) var volume: texture_storage_3d<rgba16float, write>;

// Depth of a map at a position, 0 to 1 from the upper left corner.
fn load_map(light: u32, position: vec2f, layer: u32) -> f32 {
    switch light {
        case 0u: { return textureLoad(map_0, map_texel(position, textureDimensions(map_0)), layer, 0); }
        case 1u: { return textureLoad(map_1, map_texel(position, textureDimensions(map_1)), layer, 0); }
        default: { return textureLoad(map_2, map_texel(position, textureDimensions(map_2)), layer, 0); }
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

@compute @workgroup_size(4, 4, 4)
fn look_up_cells(@builtin(global_invocation_id) cell: vec3u) {
    if any(cell >= vec3u(visibility.size)) {
        return;
    }
    // Eight places in the cell.
    var visible = vec3f(0.0);
    for (var corner = 0u; corner < 8u; corner++) {
        let offset = vec3f(vec3u(corner & 1u, (corner >> 1u) & 1u, corner >> 2u)) * 0.5 + 0.25;
        let place = vec3f(cell) + offset;
        visible += vec3f(is_visible(0u, place), is_visible(1u, place), is_visible(2u, place));
    }
    textureStore(volume, vec3u(cell.xy, cell.z + visibility.first_cell), vec4f(visible / 8.0, 0.0));
}
