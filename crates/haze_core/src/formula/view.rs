//! Conversions between pixels, NDC and view space. WGSL: `shaders/lib/view.wgsl`.

use glam::{Vec2, Vec3};

/// NDC (y up) of a pixel position (y down).
pub fn ndc_from_pixel(pixel: Vec2, size: Vec2) -> Vec2 {
    let uv = pixel / size;
    Vec2::new(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0)
}

/// Pixel position (y down) of an NDC position (y up).
pub fn pixel_from_ndc(ndc: Vec2, size: Vec2) -> Vec2 {
    Vec2::new(ndc.x * 0.5 + 0.5, 0.5 - ndc.y * 0.5) * size
}

/// View-space point at a view depth on the ray through `ray` = ndc · ray_scale + ray_offset. `orthographic` is 0 or 1.
pub fn view_position(ray: Vec2, view_depth: f32, orthographic: f32) -> Vec3 {
    (ray * (view_depth + (1.0 - view_depth) * orthographic)).extend(-view_depth)
}

/// Pixels per metre at a view depth, for an image that is `height` pixels high. `ray_scale` is the y of the one in
/// [`view_position`].
pub fn pixels_per_metre(height: f32, ray_scale: f32, view_depth: f32, orthographic: f32) -> f32 {
    let of_perspective = 1.0 / view_depth;
    0.5 * height / ray_scale * (of_perspective + (1.0 - of_perspective) * orthographic)
}
