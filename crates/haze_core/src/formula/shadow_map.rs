//! Lookup of a host's shadow map.

use glam::{Vec3, Vec4};

/// Maximum number of layers of a shadow map: the faces of a cube.
pub const MAX_SHADOW_LAYERS: usize = 6;

/// Place of a point in a layer of a shadow map: position from the upper left corner, 0 to 1, and depth; and 1 in w, or 0 if
/// the point is outside of the layer. `clip`: the point in the layer's clip space.
pub fn shadow_map_position(clip: Vec4) -> Vec4 {
    let ndc = clip.truncate() / clip.w.max(1.0e-6);
    let is_inside = clip.w > 1.0e-6 && ndc.abs().max_element() <= 1.0 && ndc.z >= 0.0;
    Vec3::new(ndc.x * 0.5 + 0.5, 0.5 - ndc.y * 0.5, ndc.z).extend(if is_inside { 1.0 } else { 0.0 })
}

/// 1 if light reaches a point with this depth, 0 if the map has a surface before it. `reversed`: the map stores the near
/// plane as 1.
pub fn shadow_map_visibility(depth: f32, stored: f32, bias: f32, reversed: bool) -> f32 {
    let is_lit = if reversed { depth >= stored - bias } else { depth <= stored + bias };
    if is_lit { 1.0 } else { 0.0 }
}
