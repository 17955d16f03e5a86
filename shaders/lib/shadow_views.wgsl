// Debug views of shadow: the first three lights with shadow in red, green and blue.

#import "lib/lit_smoke.wgsl"

// Brightness of the borders between the cells of the grid.
const CELL_BORDER: f32 = 0.7;

// 1 for each channel whose light is there.
fn channels_with_light() -> vec3f {
    var found = vec3f(0.0);
    for (var i = 0u; i < system.light_count; i++) {
        found += channel_of_slot(lights[i].shadow_slot);
    }
    return min(found, vec3f(1.0));
}

// Fractions of the lights that come through smoke and past the scene. White without shadow.
fn fractions_of_lights(optical_depths: vec3f, visible: vec3f) -> vec3f {
    if OPTICAL_DEPTHS_SLOT == 0u {
        return vec3f(1.0);
    }
    return mix(vec3f(1.0), exp2(-optical_depths) * visible, channels_with_light());
}

// Brightness of a cell_position on a plane through the grid: darker along the borders of cells, but for those that are nearly
// parallel to the plane. `normal`: of the plane, any length. `pixel`: its size in cells.
fn cell_pattern(position: vec3f, normal: vec3f, pixel: f32) -> f32 {
    let inside = fract(position);
    let steep = abs(normal);
    let steepest = max(steep.x, max(steep.y, steep.z));
    let to_border = select(min(inside, 1.0 - inside), vec3f(1.0), steep == vec3f(steepest));
    let nearest = min(to_border.x, min(to_border.y, to_border.z));
    return mix(CELL_BORDER, 1.0, saturate(nearest / max(pixel, 1.0e-6)));
}

// Light in the grid on the plane of shading_position(), and 1 in w; or 0 outside of the grid.
fn slice_of_light(pixel: vec2f) -> vec4f {
    let position = shading_position(pixel);
    let cell_position = (system.grid_from_view * vec4f(position, 1.0)).xyz;
    if any(cell_position < vec3f(0.0)) || any(cell_position > system.grid_size) || OPTICAL_DEPTHS_SLOT == 0u {
        return vec4f(0.0);
    }
    var visible = vec3f(1.0);
    if system.visibility_block > 0.5 {
        visible = sample_volume(system.visibility_block, cell_position);
    }
    let pixels = pixels_per_metre(view.size.y, view.ray_scale.y, -position.z, view.orthographic);
    let fractions = fractions_of_lights(sample_volume(0.0, cell_position), visible);
    let normal = (system.grid_from_view * vec4f(0.0, 0.0, 1.0, 0.0)).xyz;
    return vec4f(fractions * cell_pattern(cell_position, normal, system.cells_per_metre / pixels), 1.0);
}
