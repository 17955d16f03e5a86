// Camera. Mirrors ViewUniform in crates/haze_core/src/formula/uniforms.rs.

struct View {
    view_from_world: mat4x4f,
    clip_from_view: mat4x4f,
    // See view_depth_from_ndc_depth().
    depth_coefficients: vec4f,
    // View-space xy = (ndc · ray_scale + ray_offset) · depth (perspective) or · 1 (orthographic).
    ray_scale: vec2f,
    ray_offset: vec2f,
    // Pixels.
    size: vec2f,
    // First pixel of the view in the host's color target and depth.
    origin: vec2f,
    // Metres. An infinite far plane is SKY_VIEW_DEPTH.
    near: f32,
    far: f32,
    // 1 for orthographic views, 0 for perspective.
    orthographic: f32,
    // Added to the host's linear depth. Not 0 for an orthographic view that begins behind the viewer.
    depth_offset: f32,
}

// NDC (y up) of a pixel position (y down).
fn ndc_from_pixel(pixel: vec2f, size: vec2f) -> vec2f {
    return vec2f(pixel.x / size.x * 2.0 - 1.0, 1.0 - pixel.y / size.y * 2.0);
}

fn pixel_from_ndc(ndc: vec2f, size: vec2f) -> vec2f {
    return vec2f(ndc.x * 0.5 + 0.5, 0.5 - ndc.y * 0.5) * size;
}

// View-space point at a view depth on the ray through `ray` = ndc · ray_scale + ray_offset.
fn view_position(ray: vec2f, view_depth: f32, orthographic: f32) -> vec3f {
    return vec3f(ray * mix(view_depth, 1.0, orthographic), -view_depth);
}

// Pixels per metre at a view depth. `height` is that of the view in pixels, `ray_scale` the y of View's.
fn pixels_per_metre(height: f32, ray_scale: f32, view_depth: f32, orthographic: f32) -> f32 {
    return 0.5 * height / ray_scale * mix(1.0 / view_depth, 1.0, orthographic);
}
